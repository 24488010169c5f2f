"""Functions that are a polynomial in each interval, such as cubics through points without overshoot (PCHIP)."""

import functools
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from .elementary import clamped, ratio_where

_FEW_POINTS = 32  # that are compared faster one by one than by halving


class Piecewise(NamedTuple):
    """A polynomial in each interval, whose first coefficient is the value at its left end, and constant outside."""

    start: Array  # (n,), of each interval; the last one has no end
    coefficients: Array  # (powers, n)

    def interval(self, x: Array) -> Array:
        """The number of the interval, 0 also for what lies before the first one."""
        inner = self.start[1:]
        if inner.size > _FEW_POINTS:
            return jnp.searchsorted(inner, x, side="right").astype(np.uint32)  # JAX wraps other indices
        return jnp.sum(x[..., None] >= inner, -1, dtype=np.uint32)

    def at(self, x: Array) -> Array:
        """The value, constant outside."""
        begin, *powers = jnp.unstack(jnp.concatenate([self.start[None], self.coefficients])[:, self.interval(x)])
        return horner(powers, clamped(0.0, jnp.minimum(x, self.start[-1]) - begin))

    def between(self, x: Array, y: Array) -> Array:
        """The value in the middle between two places."""
        return self.at(0.5 * (x + y))


def horner(coefficients: Sequence[Any], x: Any) -> Any:
    """The polynomial of x with these coefficients, the constant first."""
    return functools.reduce(lambda value, more: more + x * value, reversed(coefficients))


def pchip(x: Array, y: Array) -> Piecewise:
    """Fritsch and Butland's interpolant without overshoot (PCHIP) of y at x, both of shape (n,).

    x increases; where it is given twice, y jumps.
    """
    # Shapes are (1, n-1), and (2, n-1) of both ends of each interval.
    length, rise = jnp.unstack(jnp.diff(jnp.stack([x, y])[:, None]))
    h = jnp.where(length > 0.0, length, 1.0)  # nobody reads what an interval without length has
    chord, none = rise / h, np.zeros((), h.dtype)
    # The intervals before and after each one; where a segment ends there is none, or one without length.
    around = lax.pad(jnp.stack([length, chord]), none, [(0, 0, 0), (0, 0, 0), (1, 1, 0)])
    beside = jnp.concatenate([around[..., :-2], around[..., 2:]], 1)
    (near, slope), (far, beyond) = jnp.unstack(beside), jnp.unstack(beside[:, ::-1])
    # The slopes at both ends of an interval: inside a segment a harmonic mean of the chords, or 0 at an extremum; at
    # its end by three points, or 0, or at most three chords, or that of the only interval.
    twice = 2.0 * h
    mean = (twice + near) * chord + (h + 2.0 * near) * slope
    mean = ratio_where(slope * chord > 0.0, 3.0 * (h + near) * slope * chord, mean)
    three, steep = ((twice + far) * chord - h * beyond) / (h + far), 3.0 * chord
    three = jnp.where(three * chord > 0.0, jnp.where(abs(three) < abs(steep), three, steep), 0.0)
    begin, end = jnp.split(jnp.where(near > 0.0, mean, jnp.where(far > 0.0, three, chord)), 2)
    bend, third = (steep - 2.0 * begin - end) / h, (begin + end - 2.0 * chord) / (h * h)
    slopes = lax.pad(jnp.concatenate([begin, bend, third]), none, [(0, 0, 0), (0, 1, 0)])
    return Piecewise(x, jnp.concatenate([y[None], slopes]))
