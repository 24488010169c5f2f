"""The same code for arrays of NumPy, which compile nothing, and of JAX, for use in compiled programs."""

from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

__all__ = ["namespace", "select"]


def namespace(*arrays: Any) -> ModuleType:
    """`numpy` if all arrays (or numbers) are of NumPy, else `jax.numpy`."""
    return jnp if any(isinstance(array, jax.Array) for array in arrays) else np


def select(condition: Any, these: Any, those: Any) -> Any:
    """Leaf by leaf, these where the condition holds, along the first axes of each leaf, and those elsewhere."""
    xp = namespace(condition)

    def chosen(this: Any, that: Any) -> Any:
        return xp.where(xp.reshape(condition, condition.shape + (1,) * (this.ndim - condition.ndim)), this, that)

    return jax.tree.map(chosen, these, those)
