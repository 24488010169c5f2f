"""Derivatives of whole tables by a few numbers."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.surfaces.effort import Effort

__all__ = ["by_numbers", "slopes"]


def slopes(function: Callable[[Array], Any], numbers: Array) -> Any:
    """The derivatives of its results by each of the numbers, shape (n,), along a first axis."""
    one = jnp.eye(numbers.size, dtype=numbers.dtype)
    return jax.vmap(lambda along: jax.jvp(function, (numbers,), (along,))[1])(one)


def by_numbers(function: Callable[[Effort, Array], Any]) -> Callable[[Effort, Array], Any]:
    """The function, differentiated in forward mode: reverse mode multiplies by tables, and compiles no more."""
    ruled = jax.custom_jvp(function, nondiff_argnums=(0,))

    def rule(effort: Effort, primals: Any, tangents: Any) -> tuple[Any, Any]:
        found = slopes(functools.partial(function, effort), primals[0])
        return ruled(effort, *primals), jax.tree.map(lambda by: jnp.tensordot(tangents[0], by, 1), found)

    ruled.defjvp(rule)
    return functools.wraps(function)(lambda effort, numbers: ruled(effort, numbers))
