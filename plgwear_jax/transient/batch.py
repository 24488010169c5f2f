"""Many runs, one after the other, each with its derivatives in forward mode, computed with the values."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.special.sequential import sequential_forward_mode


def run_numbers(k: Array, phi: Array) -> np.ndarray:
    """The index of the run of each pair of k and phi, in their broadcast shape."""
    shape = jnp.broadcast_shapes(k.shape, phi.shape)
    return np.arange(int(np.prod(shape))).reshape(shape)


def runs(one: Callable[..., Any], *given: Array) -> Any:
    """`one` of each element of the broadcast arguments, such as each pair of k and phi, along a first axis."""
    shape = jnp.broadcast_shapes(*(x.shape for x in given))
    sets = tuple(jnp.broadcast_to(x, shape).ravel() for x in given)
    if not sets[0].size:
        sets = tuple(jnp.zeros((1,), x.dtype) for x in given)
    return jax.vmap(sequential_forward_mode(one))(*sets)
