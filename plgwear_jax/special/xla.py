"""What makes XLA for processors compile less and compute faster: each trick with its reason, and nothing else.

None of them changes a value. XLA knows which operations it may repeat in several kernels and which it must not: a
division it computes once and stores, all else it repeats. `lax.optimization_barrier`, which XLA removes before it forms
the last kernels, replaces none of those that were measured (`apart` between results, `together`, `kept_in_register`).
`tests/test_kernels.py` counts the kernels with and without each.
"""

import jax
import jax.numpy as jnp
from jax import Array

__all__ = ["apart", "kept_in_register", "stored", "together"]


def apart(copy: int, *values: Array) -> tuple[Array, ...]:
    """The same values, which XLA cannot know to be the same: all lie far above the bound.

    What several results of one program share, XLA computes in kernels of their own, dozens of them, with a pass through
    memory each. Set apart, each result is one kernel.
    """
    return tuple(jnp.where(value < -10.0 - copy, 0.0, value) for value in values)


def stored(value: Array, beside: Array) -> Array:
    """The value, which XLA computes once however often it is used, since it repeats no division."""
    return value / jnp.where(beside < -10.0, 2.0, 1.0)


def together(one: Array, other: Array, beside: Array) -> tuple[Array, Array]:
    """Both values, of one shape and both finite or both NaN, from one kernel that computes once what they share.

    A kernel has one result. Two are one as the parts of a complex number, which is stored as a whole.
    """
    both = stored(jax.lax.complex(one, other), beside)
    return jnp.real(both), jnp.imag(both)


def kept_in_register(ratio: Array) -> Array:
    """A quotient >= 0, which XLA neither stores in memory nor reads again where it is used more than once.

    At a division that is used more than once a kernel ends; at its absolute value it does not.
    """
    return abs(ratio)
