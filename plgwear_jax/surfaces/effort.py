"""How finely the contact is divided for a number of digits, and derivatives of its tables by a few numbers."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import whole
from plgwear_jax._core.startup.programs import along_each


class Effort(NamedTuple):
    """Sizes, none of them a traced number."""

    digits: int
    modes: int  # pressures of the contact
    spacing: float  # of the logarithms of wavenumbers
    nodes: int  # of an integral over the ring, or over what is inside


# Measured: docs/benchmarks/surfaces.txt.
EFFORTS = {
    2: Effort(2, 14, 0.25, 28),
    3: Effort(3, 24, 0.22, 40),
    4: Effort(4, 44, 0.2, 40),
    5: Effort(5, 56, 0.16, 56),
}


def effort_of(digits: int | None) -> Effort:
    """The effort for these digits; 4 by default."""
    known = whole("digits", 4 if digits is None else digits, 1, max(EFFORTS), " of numeric contacts")
    return EFFORTS[max(known, min(EFFORTS))]


def by_numbers(function: Callable[[Effort, Array], Any]) -> Callable[[Effort, Array], Any]:
    """The function, differentiated in forward mode: reverse mode multiplies by tables, and compiles no more."""
    ruled = jax.custom_jvp(function, nondiff_argnums=(0,))

    def rule(effort: Effort, primals: Any, tangents: Any) -> tuple[Any, Any]:
        (numbers,), (step,) = primals, tangents
        each = jnp.eye(numbers.size, dtype=numbers.dtype)
        _, found = along_each(functools.partial(function, effort), numbers, each)
        return ruled(effort, numbers), jax.tree.map(lambda by: jnp.tensordot(step, by, 1), found)

    ruled.defjvp(rule)
    return ruled
