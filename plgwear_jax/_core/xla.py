"""Tricks that make XLA compile less and compute faster on processors, each with its reason.

None of them changes a value. XLA may compute an operation again in each of several kernels, except for a division,
which it computes once and stores. `lax.optimization_barrier` cannot replace the tricks for which this was measured
(`separate_kernels` between results, `one_kernel`, `kept_in_register`), since XLA removes it before it forms the last
kernels. `tests/startup/test_kernels.py` counts the kernels with and without each trick.
"""

import jax.numpy as jnp
from jax import Array, lax


def separate_kernels(copy: int, *values: Array) -> tuple[Array, ...]:
    """Copies of the values, which XLA cannot recognise as equal to them, so that each result gets its own kernel.

    XLA computes the common parts of several results of one program in dozens of small kernels, each with a pass through
    memory. If each result has its own copies of the inputs, each result is one kernel. The values lie far above -10, so
    that the condition never holds; the number `copy` makes copies differ from each other.
    """
    return tuple(jnp.where(value < -10.0 - copy, 0.0, value) for value in values)


def materialised(value: Array) -> Array:
    """The value, computed once and stored however often it is used: divided by 1, since XLA does not repeat a division.

    The divisor depends on the value, so that XLA cannot simplify the division away. Of an array it is an array: by one
    number for all of them XLA would multiply with its reciprocal, and repeat that.
    """
    return value / jnp.where(value == -jnp.inf, 2.0, 1.0)


def one_kernel(one: Array, other: Array) -> tuple[Array, Array]:
    """Both values, of one shape and both finite or both NaN, from one kernel that computes their common parts once.

    A kernel has a single result, so the two values become the parts of one complex number; `one` is not negative.

    Absolute value and maximum change no value, but LLVM's search for vector instructions stops at them. If a register
    holds just two numbers, as with SSE and on ARM, LLVM checks whether both parts can be computed in one register, and
    follows every path through the formula from its end to its beginning. For a long formula of sums and products this
    search had not ended after seven minutes.
    """
    lowest = other.dtype.type(jnp.finfo(other.dtype).min)
    both = materialised(lax.complex(lax.abs(one), lax.max(other, lowest)))
    return jnp.real(both), jnp.imag(both)


def kept_in_register(ratio: Array) -> Array:
    """A quotient >= 0 that XLA keeps in a register where it is used more than once, instead of storing it in memory.

    XLA ends a kernel at a division that is used more than once, but not at the absolute value of one.
    """
    return abs(ratio)
