"""Tricks that make XLA compile less and compute faster on processors, each with its reason.

None of them changes a value. XLA may compute an operation again in each of several kernels, except for a division,
which it computes once and stores. `lax.optimization_barrier` cannot replace those tricks that were measured (`apart`
between results, `together`, `kept_in_register`), since XLA removes it before it forms the last kernels.
`tests/startup/test_kernels.py` counts the kernels with and without each.
"""

import jax
import jax.numpy as jnp
from jax import Array

__all__ = ["apart", "kept_in_register", "stored", "together"]


def apart(copy: int, *values: Array) -> tuple[Array, ...]:
    """The same values, in a form that XLA cannot recognise as the same: all of them lie far above -10.

    XLA computes what several results of one program share in dozens of separate kernels, each with a pass through
    memory. With such copies each result is one kernel. `copy` makes copies differ from each other.
    """
    return tuple(jnp.where(value < -10.0 - copy, 0.0, value) for value in values)


def stored(value: Array, beside: Array) -> Array:
    """The value, computed once however often it is used, since XLA does not repeat a division."""
    return value / jnp.where(beside < -10.0, 2.0, 1.0)


def together(one: Array, other: Array, beside: Array) -> tuple[Array, Array]:
    """Both values, of one shape and both finite or both NaN, from one kernel that computes their common parts once.

    A kernel has a single result, so the two become the parts of one complex number; `one` is not negative.

    Absolute value and maximum change nothing. They are where LLVM stops to look: if a register holds just two
    numbers, as with SSE (and as wide are those of ARM), it asks whether both parts can be computed side by side, and
    walks through the formula once for each path from its end to its beginning. With a long formula of sums and products
    it had not ended after seven minutes.
    """
    lowest = other.dtype.type(jnp.finfo(other.dtype).min)
    both = stored(jax.lax.complex(jax.lax.abs(one), jax.lax.max(other, lowest)), beside)
    return jnp.real(both), jnp.imag(both)


def kept_in_register(ratio: Array) -> Array:
    """A quotient >= 0 that XLA keeps in a register where it is used more than once, instead of storing it in memory.

    XLA ends a kernel at a division that is used more than once, but not at the absolute value of one.
    """
    return abs(ratio)
