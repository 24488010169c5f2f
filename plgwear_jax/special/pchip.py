"""Functions that are a polynomial in each interval, such as cubics through points without overshoot (PCHIP)."""

import functools
from collections.abc import Sequence
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

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


def horner(coefficients: Sequence[Array], x: Array) -> Array:
    """The polynomial of x with these coefficients, the constant first."""
    return functools.reduce(lambda value, more: more + x * value, reversed(coefficients))


def _ratio(above: Array | float, below: Array) -> Array:
    return ratio_where(below != 0.0, above, below)


def _end(h: Array, beyond: Array, slope: Array, next_slope: Array) -> Array:
    """The slope at the end of a segment, from its last interval and the one before, if there is one."""
    three = _ratio((2.0 * h + beyond) * slope - h * next_slope, h + beyond)
    three = jnp.where(three * slope <= 0.0, 0.0, three)
    steep = (slope * next_slope < 0.0) & (abs(three) > 3.0 * abs(slope))
    return jnp.where(beyond > 0.0, jnp.where(steep, 3.0 * slope, three), slope)


def pchip(x: Array, y: Array) -> Piecewise:
    """Fritsch and Butland's interpolant without overshoot (PCHIP) of y at x, both of shape (n,).

    x increases; where it is given twice, y jumps.
    """
    h = jnp.diff(x)
    chord = _ratio(jnp.diff(y), h)
    before, after = jnp.append(0.0, h), jnp.append(h, 0.0)  # of each point
    left, right = jnp.append(0.0, chord), jnp.append(chord, 0.0)
    one, two = 2.0 * after + before, after + 2.0 * before
    alike = left * right > 0.0
    mean = _ratio((one + two) * jnp.where(alike, left * right, 0.0), one * right + two * left)
    # At both ends of each interval, by what lies beyond the other one where a segment ends there.
    beyond = jnp.stack([after[1:], before[:-1]])
    ends = _end(h, beyond, chord, jnp.stack([right[1:], left[:-1]]))
    inner = jnp.stack([before[:-1], after[1:]]) > 0.0
    begin, end = jnp.unstack(jnp.where(inner, jnp.stack([mean[:-1], mean[1:]]), ends))
    over = _ratio(1.0, h)
    bend, third = (3.0 * chord - 2.0 * begin - end) * over, (begin + end - 2.0 * chord) * over * over
    return Piecewise(x, jnp.stack([y, *(jnp.append(slope, 0.0) for slope in (begin, bend, third))]))
