"""Where a stress is largest before any wear, and how large it is."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax.special.elementary import top_of

from .field import Pressed, Stress, body_of, field, of_each_traction


class Peak(NamedTuple):
    """The largest value of a stress in Pa, and where in m."""

    value: Array
    x: Array
    z: Array


# In units of a_0. Among the places are the edges of the contact, where the tension of a homogeneous half-space has its
# peak, and those of the stick area, where von Mises' stress of a power law may have its own.
_X = np.array([0.0, 0.3, 0.6, 0.85, 0.93, 0.96, 0.98, 1.0, 1.15, 1.5])
_Z = np.array([0.0, 3e-3, 0.015, 0.06, 0.15, 0.28, 0.4, 0.55, 0.75, 1.0, 1.4, 2.0, 3.0])
# On a power law the tension of a small k > 0 has its peak at about 0.5 k^2 below the edge.
_SHALLOW = np.append(np.geomspace(1e-10, 3e-4, 6), _Z)
_REACH, _CLOSER, _LEAST, _BESIDE = 0.17, 7.0, 1e-10, 0.01


class Wanted(NamedTuple):
    """What is the largest stress wanted of."""

    mises: Array  # 1 for von Mises' stress, 0 for the largest principal one
    least: Array  # depths in m between which it is
    most: Array

    def of(self, stress: Stress) -> Array:
        """The stress that is wanted."""
        return jnp.where(self.mises > 0.0, stress.mises, stress.principal)

    def ends(self, pressed: Pressed) -> Array:
        """Depths in units of a_0 that do not move with it: both sides of each interface, and last both ends."""
        dtype = pressed.force.dtype
        low = self.least / pressed.radius
        high = jnp.maximum(low, jnp.minimum(self.most, float(_Z[-1]) * pressed.radius) / pressed.radius)
        jumps = jnp.zeros(0, dtype) if pressed.table is None else pressed.table.start[1:]
        sides = jumps * (1.0 - 8.0 * jnp.finfo(dtype).eps), jumps
        return jnp.clip(jnp.concatenate([*sides, jnp.stack([low, high])]), low, high)


def highest(pressed: Pressed, wanted: Wanted) -> Peak:
    """The largest value in Pa, and its place in units of a_0: on a grid, then on finer ones around the best place."""
    body = body_of(pressed)
    ends = wanted.ends(pressed)
    first = jnp.append(jnp.asarray(_X, ends.dtype), pressed.stick)
    edges = _contact_edges(pressed)
    depths = jnp.asarray(_Z if pressed.k is None else _SHALLOW, ends.dtype)
    sideways, downwards = (jnp.linspace(-1.0, 1.0, each.size, dtype=ends.dtype) for each in (first, depths))

    def closer(_: int, state: tuple[Any, ...]) -> tuple[Any, ...]:
        xs, zs, step, _, *top = state
        # The top of a parabola is one more place, since a stress may also have a kink.
        xs, zs = (jnp.append(each, more) for each, more in zip((xs, zs), top, strict=True))
        zs = jnp.append(jnp.clip(zs, ends[-2], ends[-1]), ends)
        # At -x the traction along the motion does what it would do at x if it were reversed.
        by_pressure, by_traction = jnp.moveaxis(of_each_traction(pressed, body, False, xs, zs[:, None]), -1, 0)
        found = jnp.stack([wanted.of(Stress(*by_pressure + sign * by_traction)) for sign in (1.0, -1.0)])
        found = jnp.where(jnp.isnan(found), -jnp.inf, found)
        side, z_at, x_at = jnp.unravel_index(jnp.argmax(found), found.shape)
        x, z, found = xs[x_at], zs[z_at], found[side]
        peak = Peak(found[z_at, x_at], jnp.where(side == 0, x, -x), z)
        top = top_of(xs[:-1], found[z_at, :-1]), top_of(zs[: depths.size], found[: depths.size, x_at])
        # Nearer to the surface and to the edges by smaller steps.
        low = jnp.maximum(z, _LEAST)
        scale = jnp.stack([low + jnp.min(abs(abs(x) - edges)), low])
        step = jnp.arcsinh(jnp.minimum(_REACH / scale, step)) / _CLOSER
        next_x = x + scale[0] * jnp.sinh(_CLOSER * step[0] * sideways)
        next_z = low * jnp.exp(_CLOSER * step[1] * downwards)
        return next_x, next_z, step, peak, *top

    none = jnp.zeros_like(pressed.radius)
    step = jnp.full(2, jnp.inf, ends.dtype)
    begin = first, depths, step, Peak(none, none, none), none, none
    rounds = jnp.where(_unbounded(pressed, wanted), 0, pressed.fineness.rounds)
    return lax.fori_loop(0, rounds, closer, begin)[3]


def peak_at(pressed: Pressed, wanted: Wanted, x: Array, z: Array) -> Peak:
    """The value in Pa and the place in m, as functions of the contact, of a peak whose place in units of a_0 is known.

    It is there in units of a_0 as the slopes of the place go, but for depths that are ends, and beside an edge, where
    there may be a kink: it moves with that.
    """
    ends = wanted.ends(pressed)
    near = ends[jnp.argmin(abs(lax.stop_gradient(ends) - z))]
    z = jnp.where(lax.stop_gradient(near) == z, near, z)
    if pressed.k is not None:
        edges = _contact_edges(pressed)
        edge = edges[jnp.argmin(abs(abs(x) - lax.stop_gradient(edges)))]
        beside = abs(abs(x) - edge) < _BESIDE
        x += jnp.where(beside, jnp.sign(x), 0.0) * (edge - lax.stop_gradient(edge))
    return in_si(pressed, wanted, Peak(_value_at(pressed, wanted, jnp.stack([x, z])), x, z))


def _stress_at(pressed: Pressed, wanted: Wanted, place: Array) -> Array:
    return wanted.of(field(pressed, body_of(pressed), False, *jnp.unstack(place)))


@jax.custom_jvp
def _value_at(pressed: Pressed, wanted: Wanted, place: Array) -> Array:
    """The stress at the place, whose derivatives are those of a peak: the first is at the place, which moves then."""
    return _stress_at(pressed, wanted, place)


@_value_at.defjvp
def _value_at_jvp(primals, tangents):
    pressed, wanted, place = primals
    return jax.jvp(_stress_at, (pressed, wanted, place + _drifted(*primals)), tangents)


@jax.custom_jvp
def _drifted(pressed: Pressed, wanted: Wanted, place: Array) -> Array:
    """By how much the peak is elsewhere than the place that was found: not at all, but for its derivatives."""
    return jnp.zeros_like(place)


@_drifted.defjvp
def _drifted_jvp(primals, tangents):
    pressed, wanted, place = primals
    x, z = jnp.unstack(place)
    beside = jnp.any(abs(abs(x) - _contact_edges(pressed)) < _BESIDE)
    free = ~jnp.stack([beside, jnp.any(wanted.ends(pressed) == z)])
    slope = jax.grad(_stress_at, 2)
    matrix = jax.jacfwd(slope, 2)(*primals)
    along = jax.jvp(slope, primals, tangents)[1]
    matrix = jnp.where(free[:, None] & free, matrix, jnp.eye(2, dtype=place.dtype))
    return _drifted(*primals), -jnp.linalg.solve(matrix, jnp.where(free, along, 0.0))


def in_si(pressed: Pressed, wanted: Wanted, peak: Peak) -> Peak:
    """The peak with its place in m, at the surface where the modulus is infinite there."""
    value, x, z = peak
    unbounded = _unbounded(pressed, wanted)
    infinite = jnp.inf + 0.0 * pressed.radius  # NaN where an argument is outside
    value, z = jnp.where(unbounded, infinite, value), jnp.where(unbounded, 0.0, z)
    known = jnp.where(jnp.isnan(value), value, pressed.radius)
    return Peak(value, x * known, z * known)


def _unbounded(pressed: Pressed, wanted: Wanted) -> Array | bool:
    return False if pressed.k is None else (pressed.k < 0.0) & (wanted.least == 0.0)


def _contact_edges(pressed: Pressed) -> Array:
    """Of the contact and of the stick area, in units of a_0."""
    return jnp.stack([jnp.ones_like(pressed.stick), pressed.stick])
