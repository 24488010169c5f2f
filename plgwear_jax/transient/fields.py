"""Worn depth, indenter shape, contact radius and pressure after n reduced cycles."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax import fretting
from plgwear_jax._punch import exponents
from plgwear_jax._startup.programs import program
from plgwear_jax.fretting.stick import slip
from plgwear_jax.special.arcsine import arc, arcsine_tail, fold
from plgwear_jax.special.elementary import clamp_keep_slope, sine_quotient
from plgwear_jax.transient.batch import run_numbers
from plgwear_jax.transient.curves import Moment, RunCurves, interpolated, moment_at

_DIGITS = 12  # digits of g and H, which are known in closed form


def _between(curves: RunCurves, run: np.ndarray, y: Array, power: float = 1.0) -> tuple[Array, Array, Array]:
    """(Index of a cell, index of the next cell, share of the way from the middle of the first to that of the next)."""
    middle = 0.5 * (curves.edges[:, 1:] + curves.edges[:, :-1])
    moment = moment_at(middle**power, run, y**power)
    return moment.first, moment.first + 1, jnp.clip(moment.part, 0.0, 1.0)


def place_in_ring(r: Array, c: Array, edge: Array) -> tuple[Array, Array]:
    """(Whether r lies in the ring from c to an outer edge, y = (r/c)^2 - 1 there and a harmless value elsewhere)."""
    inside = (r >= c) & (r < edge)
    near = jnp.where(inside, r, 0.5 * (c + edge))
    return inside, ((near - c) / c) * ((near + c) / c)


def depth_by(curves: RunCurves, run: np.ndarray, y: Array, n: Array, gap: Array, steady: Array) -> Array:
    """The worn depth h = g E/(1 + g E/H) at y after n. E grows without bound, so that h tends to exactly H."""
    one, other, part = _between(curves, run, y)
    moment = moment_at(curves.worn.time, run, n / curves.scales.unit[run])

    def level(cell: Array) -> Array:
        grown = jnp.expm1(interpolated(curves.worn, moment, run, cell))
        rest = jnp.maximum(1.0 - grown / curves.ratio[run, cell], 1e-6)
        return jnp.log1p(grown / rest)

    grown = jnp.expm1((1.0 - part) * level(one) + part * level(other))
    grown = grown * jnp.exp(jnp.minimum(curves.decay[run, 0] * moment.late, 60.0))  # no more, or it would overflow
    return steady * (gap * grown) / (steady + gap * grown + jnp.finfo(gap.dtype).tiny)


class Pressures(NamedTuple):
    """The pressures in the cells at one moment."""

    curves: RunCurves
    run: np.ndarray
    moment: Moment
    decay: Array  # factor by which pressures have fallen since the last step, over the unit of time

    def of(self, cell: Any) -> Array:
        """Pressure of the cell with this index at this moment."""
        return self._between_steps(cell, self.curves.worn.rate[self.run, self.moment.first, cell])

    def _between_steps(self, cell: Any, one: Array) -> Array:
        other = self.curves.worn.rate[self.run, self.moment.first + 1, cell]
        return (one + self.moment.part * (other - one)) * self.decay

    def _grown(self, cell: Any) -> Array:
        """Pressure of a cell at this moment, without the share of its pressure before any wear."""
        first = self.moment.first
        return self._between_steps(cell, jnp.where(first == 0, 0.0, self.curves.worn.rate[self.run, first, cell]))

    def at(self, y: Array, unworn: Array) -> Array:
        """Pressure at y at this moment, interpolated between cells; `unworn` is the known pressure before any wear."""
        one, other, part = _between(self.curves, self.run, y, 1.0 / 3.0)  # cell edges grow as the cube of their index
        # A sum, since subtracting the first pressures would leave rounding errors where the pressure is zero.
        ring = (1.0 - part) * self._grown(one) + part * self._grown(other)
        return ring + jnp.where(self.moment.first == 0, 1.0 - self.moment.part, 0.0) * unworn


def pressures_at(curves: RunCurves, run: np.ndarray, n: Array) -> Pressures:
    """The pressures in the cells after n reduced cycles."""
    unit = curves.scales.unit[run]
    moment = moment_at(curves.worn.time, run, n / unit)
    return Pressures(curves, run, moment, jnp.exp(-curves.decay[run, 0] * moment.late) / unit)


@program()
def depth_of(curves: RunCurves, r: Array, k: Array, phi: Array, n: Array) -> Array:
    """The worn depth at r after n reduced cycles, read from the runs of all k and phi."""
    run = run_numbers(k, phi)
    worn = phi > 0.0
    phi = jnp.where(worn, phi, 0.5)
    c = fretting.stick_radius(k, phi)
    inside, y = place_in_ring(r, c, c * jnp.sqrt(1.0 + curves.scales.width[run]))
    return jnp.where(inside & worn, depth_by(curves, run, y, n, *gap_and_depth(y, k, phi)), 0.0)


def gap_and_depth(y: Array, k: Array, phi: Array) -> tuple[Array, Array]:
    """(The gap g_0 beside the contact of the stick radius, the final worn depth) at y in the ring, for phi > 0."""
    s, q = exponents(k)
    c = fretting.stick_radius(k, phi)
    y, s, q, m = jnp.broadcast_arrays(y, s, q, slip(s, phi))
    at = arc(y, s, q, min(_DIGITS, int(jnp.finfo(y.dtype).precision)))
    height, unit = y * at.chord, 0.5 * c * c * at.share
    return unit * height, unit * jnp.maximum(m - height, 0.0)


@program()
def radius_of(curves: RunCurves, k: Array, phi: Array, n: Array) -> Array:
    """The contact radius over a_0 after n reduced cycles, read from the runs of all k and phi."""
    run = run_numbers(k, phi)
    moment = moment_at(curves.edge.time, run, n / curves.scales.unit[run])
    y = interpolated(curves.edge, moment, run)
    y = y + (curves.scales.width[run] - y) * -jnp.expm1(-curves.decay[run, 0] * moment.late)
    return clamp_keep_slope(1.0, jnp.where(phi > 0.0, jnp.sqrt(curves.scales.inner[run] * (1.0 + y)), 1.0))


@program()
def pressure_of(curves: RunCurves, r: Array, k: Array, phi: Array, n: Array) -> Array:
    """The pressure at r after n reduced cycles, read from the runs of all k and phi."""
    run = run_numbers(k, phi)
    worn = phi > 0.0
    amplitude = jnp.where(worn, phi, 0.5)
    s, q = exponents(k)
    c = fretting.stick_radius(k, amplitude)
    C, unworn = curves.scales.inner[run], fretting.initial_pressure(r, k)
    pressures = pressures_at(curves, run, n)
    slips, y = place_in_ring(r, c, c * jnp.sqrt(1.0 + curves.scales.width[run]))
    ring = pressures.at(y, unworn)

    # In the stick area three pressures add up: of the parabola, of the surface shape that the ring's pressures cause
    # inside c, and of a flat punch with the remaining load.
    under = r < c
    inner = jnp.where(under, r, 0.5 * c)
    z = ((c - inner) / c) * ((c + inner) / c)
    shape = jnp.broadcast_shapes(z.shape, ring.shape)
    z, s, q = (jnp.broadcast_to(x, shape) for x in (z, s, q))
    density = s * sine_quotient(s, q)

    def add(i: Array, state: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
        tail, power, left, rest = state
        load, outer = pressures.of(i), curves.edges[run, i + 1]
        next_tail, *_ = arcsine_tail(fold(outer / z), s, q, 8 if z.dtype == jnp.float64 else None)
        next_power = jnp.exp(q * jnp.log(outer))
        taken = density * (next_power - power) + s * s * curves.swept[run, i]
        return next_tail, next_power, left + load * (next_tail - tail), rest - load * taken

    zero = jnp.zeros_like(z)
    begin = zero, zero, zero, zero + s * amplitude / C
    _, _, left, rest = jax.lax.fori_loop(0, curves.swept.shape[-1], add, begin)
    log_z = jnp.log(z)
    smooth, singular = (1.0 + s) * (1.0 - amplitude) / C, jnp.maximum(rest, 0.0)
    punch = smooth * jnp.exp(s * log_z) + singular * jnp.exp(-q * log_z)
    under_indenter = jnp.where(under, punch + left, jnp.where(slips, ring, 0.0))
    return jnp.where(worn, under_indenter, unworn)
