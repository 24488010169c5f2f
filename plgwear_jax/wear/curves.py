"""Quantities over time: where a time lies among those of a run, and what a curve has there."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax.special.elementary import clamped


class Curve(NamedTuple):
    """A quantity that never falls and its rate at increasing times; axes of contacts come first when it is read."""

    time: Array  # (steps + 1,)
    value: Array  # (steps + 1, ...)
    rate: Array

    tables = "time", "value", "rate"


def limited(curve: Curve) -> Curve:
    """The curve with rates limited so that no cubic between two times falls."""
    time, value, rate = curve
    length = jnp.diff(time)
    length = jnp.where(length > 0.0, length, jnp.inf)
    rise = jnp.diff(value, axis=0)
    # Without those that are unknown, whose derivatives by the times would be unknown everywhere.
    chord = jnp.where(rise > 0.0, rise, 0.0) / length.reshape(-1, *(1,) * (value.ndim - 1))
    before, after = jnp.concatenate([chord[:1], chord]), jnp.concatenate([chord, chord[-1:]])
    most = 3.0 * jnp.where(before < after, before, after)
    return Curve(time, value, clamped(0.0, jnp.where(rate < most, rate, most)))


def _rows(values: Array, axes: int) -> Array:
    """The values with the axes of the contacts as one, on which there is at least one."""
    rows = values.reshape(math.prod(values.shape[:axes]), *values.shape[axes:])
    return rows if len(rows) else jnp.zeros((1, *rows.shape[1:]), rows.dtype)


class Moment(NamedTuple):
    """Some times, each located between two times of its contact or beyond the last one."""

    axes: int  # of the contacts, with which all that is read begins
    contact: Any  # the number of the contact
    first: Array  # index of the time before
    part: Array  # share of the interval that has passed, 0 to 1
    length: Array  # length of the interval
    late: Array  # time since the last time of the contact

    def pick(self, values: Array, *at: Any) -> Array:
        """The entries of the contacts at these indices."""
        return _rows(values, self.axes)[self.contact, *at]

    def across(self, at: Callable[[Array], Array]) -> Array:
        """Linear interpolation of what a function gives for both ends."""
        begin = at(self.first)
        return begin + self.part * (at(self.first + 1) - begin)

    def between(self, values: Array, *at: Any) -> Array:
        """Linear interpolation of values at all times, and if given of one entry."""
        return self.across(lambda i: self.pick(values, i, *at))

    def on(self, curve: Curve, *at: Any) -> Array:
        """The curve, and if given one of its entries: the cubic through two values and rates."""
        i, j, x = (self.first, *at), (self.first + 1, *at), self.part
        begin = self.pick(curve.value, *i)
        rise = self.pick(curve.value, *j) - begin
        u, v = self.length * self.pick(curve.rate, *i), self.length * self.pick(curve.rate, *j)
        return begin + x * (u + x * (3.0 * rise - 2.0 * u - v + x * (u + v - 2.0 * rise)))


ROUNDINGS = 32.0  # by which sums of the cycles of blocks differ


def moment_at(times: Array, time: Array, within: bool = False) -> Moment:
    """Locate a time among the times of its contact. At one of them it is the end of the interval before.

    Args:
        times: Increasing, along a last axis behind those of the contacts.
        time: Broadcasts against the contacts.
        within: Whether the part is kept from 0 to 1 before the first time, and from roundings beside others.
    """
    axes = times.ndim - 1
    rows, number = _rows(times, axes), np.arange(math.prod(times.shape[:-1])).reshape(times.shape[:-1])
    # Where a block ends, whatever its cycles round to, it is the end of this block and not the beginning of the next.
    early = lax.stop_gradient(time) * (1.0 - ROUNDINGS * jnp.finfo(times.dtype).eps)
    before = jnp.sum(lax.stop_gradient(times) < early[..., None], -1)
    first = clamped(0, before - 1, times.shape[-1] - 2)
    begin, end = rows[number, first], rows[number, first + 1]
    # At the last time itself, where `jnp.minimum` would halve the slope, the slope is that of the curve.
    inside = jnp.where(time > times[..., -1], times[..., -1], time)
    length = jnp.where(end > begin, end - begin, 1.0)
    part = (inside - begin) / length
    return Moment(axes, number, first, jnp.clip(part, 0.0, 1.0) if within else part, length, time - inside)


def cells_around(edges: Array, place: Array, power: float = 1.0) -> Moment:
    """The cells between whose middles a place is; edges are along a last axis. Beyond all middles it is the nearest."""
    middle = 0.5 * (edges[..., 1:] + edges[..., :-1])
    return moment_at(middle**power, place**power, within=True)
