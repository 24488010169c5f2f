"""Depth, shape, contact radius and pressure after n reduced cycles."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting
from plgwear_jax._core.domains import AMPLITUDE, CYCLES, EXPONENT, RADIUS
from plgwear_jax._core.formula import ruled
from plgwear_jax._punch import exponents
from plgwear_jax._startup.programs import program
from plgwear_jax.fretting.stick import slip
from plgwear_jax.partial_slip import SOFTNESS
from plgwear_jax.special.arcsine import arc, arcsine_tail, fold
from plgwear_jax.special.elementary import at_least, sine_quotient
from plgwear_jax.transient.batch import numbers
from plgwear_jax.transient.course import Course, Moment, interpolated, moment_at
from plgwear_jax.transient.held_displacement import course_under

__all__ = [
    "beside",
    "contact_radius",
    "depth_by",
    "depth_of",
    "pressure",
    "pressure_of",
    "pressures_at",
    "profile",
    "radius_of",
    "stick_of",
    "wear_depth",
]

_DIGITS = 12  # of the closed depths


def _between(course: Course, run: np.ndarray, y: Array, power: float = 1.0) -> tuple[Array, Array, Array]:
    """(Number of a cell, number of the next, part of the way from the middle of one to that of the other)."""
    middle = 0.5 * (course.edges[:, 1:] + course.edges[:, :-1])
    moment = moment_at(middle**power, run, y**power)
    return moment.first, moment.first + 1, jnp.clip(moment.part, 0.0, 1.0)


def beside(r: Array, c: Array, edge: Array) -> tuple[Array, Array]:
    """(Whether r lies between c and an outer edge, y there and something harmless elsewhere)."""
    inside = (r >= c) & (r < edge)
    near = jnp.where(inside, r, 0.5 * (c + edge))
    return inside, ((near - c) / c) * ((near + c) / c)


def depth_by(course: Course, run: np.ndarray, y: Array, n: Array, gap: Array, steady: Array) -> Array:
    """The depth h = g E/(1 + g E/H) at y after n, with an E that grows without end: it ends at H itself."""
    one, other, part = _between(course, run, y)
    moment = moment_at(course.worn.time, run, n / course.scales.unit[run])

    def level(cell: Array) -> Array:
        grown = jnp.expm1(interpolated(course.worn, moment, run, cell))
        rest = jnp.maximum(1.0 - grown / course.ratio[run, cell], 1e-6)
        return jnp.log1p(grown / rest)

    grown = jnp.expm1((1.0 - part) * level(one) + part * level(other))
    grown = grown * jnp.exp(jnp.minimum(course.decay[run, 0] * moment.late, 60.0))  # no more, or it would overflow
    return steady * (gap * grown) / (steady + gap * grown + jnp.finfo(gap.dtype).tiny)


class Pressures(NamedTuple):
    """The pressures of the cells at some time."""

    course: Course
    run: np.ndarray
    moment: Moment
    decay: Array  # beyond the last step

    @property
    def steps(self) -> Array:
        """At the steps of all runs, in units of time."""
        return self.course.worn.rate if self.course.pressure is None else self.course.pressure

    def of(self, cell: Any) -> Array:
        """That of a cell, by its number."""
        return self._between_steps(cell, self.steps[self.run, self.moment.first, cell])

    def _between_steps(self, cell: Any, one: Array) -> Array:
        other = self.steps[self.run, self.moment.first + 1, cell]
        return (one + self.moment.part * (other - one)) * self.decay

    def _grown(self, cell: Any) -> Array:
        """As `of`, without what the cell begins with."""
        first = self.moment.first
        return self._between_steps(cell, jnp.where(first == 0, 0.0, self.steps[self.run, first, cell]))

    def at(self, y: Array, unworn: Array) -> Array:
        """That at y, between those of the cells; before any wear it is known."""
        one, other, part = _between(self.course, self.run, y, 1.0 / 3.0)  # cells grow as the cube of their number
        # A sum, as to take away what the cells begin with would leave rounding where the pressure is zero.
        ring = (1.0 - part) * self._grown(one) + part * self._grown(other)
        return ring + jnp.where(self.moment.first == 0, 1.0 - self.moment.part, 0.0) * unworn


def pressures_at(course: Course, run: np.ndarray, n: Array) -> Pressures:
    """The pressures of the cells after n."""
    unit = course.scales.unit[run]
    moment = moment_at(course.worn.time, run, n / unit)
    return Pressures(course, run, moment, jnp.exp(-course.decay[run, 0] * moment.late) / unit)


@program()
def depth_of(course: Course, r: Array, k: Array, phi: Array, n: Array) -> Array:
    """The depth at r after n by the runs of all k and phi."""
    run = numbers(k, phi)
    worn = phi > 0.0
    phi = jnp.where(worn, phi, 0.5)
    s, q = exponents(k)
    c = fretting.stick_radius(k, phi)
    inside, y = beside(r, c, c * jnp.sqrt(1.0 + course.scales.width[run]))
    y, s, q, m = jnp.broadcast_arrays(y, s, q, slip(s, phi))
    at = arc(y, s, q, min(_DIGITS, int(jnp.finfo(y.dtype).precision)))
    # H and g over (c^2/2) Q/s.
    height = y * at.chord
    depth = depth_by(course, run, y, n, height, jnp.maximum(m - height, 0.0))
    return jnp.where(inside & worn, 0.5 * c * c * at.share * depth, 0.0)


@ruled(r=RADIUS, k=EXPONENT, phi=AMPLITUDE, n=CYCLES, compliance=SOFTNESS)
def wear_depth(
    r: ArrayLike,
    k: ArrayLike,
    phi: ArrayLike,
    n: ArrayLike,
    *,
    control: str = "force",
    compliance: ArrayLike = 0.0,
    digits: int | None = None,
) -> Array:
    """Depth worn off the indenter at a radius in n reduced cycles.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        control: Whose amplitude is held, that of the "force" or of the "displacement"; phi is that before any wear.
        compliance: X of `partial_slip.displacement_amplitude` if the displacement is that of a rig, X >= 0.
        digits: As of `wear_volume`. Measured at 4 digits the volume under the depths is known to 2.2e-3 of the final
            one, at 5 to 3e-4. In a strip beside c that is thinner than a cell, depths are less accurate.

    Returns:
        The depth in units of a_0^2/R, broadcast over all arguments: it grows from 0 to `fretting.wear_depth`.

    Raises:
        ValueError: A concrete argument, or `digits`, is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi, n = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    course, phi = course_under(control, k, phi, jnp.asarray(compliance), digits)
    return depth_of(course, r, k, phi, n)


@ruled(r=RADIUS, k=EXPONENT, phi=AMPLITUDE, n=CYCLES, compliance=SOFTNESS)
def profile(
    r: ArrayLike,
    k: ArrayLike,
    phi: ArrayLike,
    n: ArrayLike,
    *,
    control: str = "force",
    compliance: ArrayLike = 0.0,
    digits: int | None = None,
) -> Array:
    """Shape of the indenter after n reduced cycles: r^2/2 and the worn depth.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        control: Whose amplitude is held, that of the "force" or of the "displacement"; phi is that before any wear.
        compliance: X of `partial_slip.displacement_amplitude` if the displacement is that of a rig, X >= 0.
        digits: As of `wear_depth`.

    Returns:
        The height above the apex in units of a_0^2/R, broadcast over all arguments.

    Raises:
        ValueError: A concrete argument, or `digits`, is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi, n = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    course, phi = course_under(control, k, phi, jnp.asarray(compliance), digits)
    return 0.5 * r * r + depth_of(course, r, k, phi, n)


@program()
def radius_of(course: Course, k: Array, phi: Array, n: Array) -> Array:
    """The radius of the contact over a_0 after n by the runs of all k and phi."""
    run = numbers(k, phi)
    moment = moment_at(course.edge.time, run, n / course.scales.unit[run])
    y = interpolated(course.edge, moment, run)
    y = y + (course.scales.width[run] - y) * -jnp.expm1(-course.decay[run, 0] * moment.late)
    return at_least(1.0, jnp.where(phi > 0.0, jnp.sqrt(course.scales.inner[run] * (1.0 + y)), 1.0))


def stick_of(course: Course, phi: Array, n: Array) -> Array:
    """The stick radius over that before any wear, after n by the runs of all phi."""
    if course.stick is None:
        return jnp.ones_like(phi) + 0.0 * n
    run = numbers(phi, phi)
    moment = moment_at(course.volume.time, run, n / course.scales.unit[run])
    begin, end = course.stick[run, moment.first], course.stick[run, moment.first + 1]
    return jnp.where(phi > 0.0, jnp.sqrt(1.0 + begin + moment.part * (end - begin)), 1.0 + 0.0 * phi)


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES, compliance=SOFTNESS)
def contact_radius(
    k: ArrayLike,
    phi: ArrayLike,
    n: ArrayLike,
    *,
    control: str = "force",
    compliance: ArrayLike = 0.0,
    digits: int | None = None,
) -> Array:
    """Radius of the contact after n reduced cycles.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        control: Whose amplitude is held, that of the "force" or of the "displacement"; phi is that before any wear.
        compliance: X of `partial_slip.displacement_amplitude` if the displacement is that of a rig, X >= 0.
        digits: As of `wear_volume`. Measured at 4 digits the error is below 1.6e-3 of what the radius grows by
            in the end.

    Returns:
        The radius in units of a_0, broadcast over all arguments: it grows from 1 to `fretting.worn_radius`.

    Raises:
        ValueError: A concrete argument, or `digits`, is outside its range. Under `jit` the result is NaN there.
    """
    k, phi, n = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    course, phi = course_under(control, k, phi, jnp.asarray(compliance), digits)
    return radius_of(course, k, phi, n)


@program()
def pressure_of(course: Course, r: Array, k: Array, phi: Array, n: Array) -> Array:
    """The pressure at r after n by the runs of all k and phi."""
    run = numbers(k, phi)
    worn = phi > 0.0
    amplitude = jnp.where(worn, phi, 0.5)
    s, q = exponents(k)
    c = fretting.stick_radius(k, amplitude)
    C, unworn = course.scales.inner[run], fretting.initial_pressure(r, k)
    pressures = pressures_at(course, run, n)
    slips, y = beside(r, c, c * jnp.sqrt(1.0 + course.scales.width[run]))
    ring = pressures.at(y, unworn)

    # Where it sticks: the parabola's share, what the ring's pressures leave inwards, and a flat punch with the rest.
    under = r < c
    inner = jnp.where(under, r, 0.5 * c)
    z = ((c - inner) / c) * ((c + inner) / c)
    shape = jnp.broadcast_shapes(z.shape, ring.shape)
    z, s, q = (jnp.broadcast_to(x, shape) for x in (z, s, q))
    density = s * sine_quotient(s, q)

    def add(i: Array, state: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
        tail, power, left, rest = state
        load, outer = pressures.of(i), course.edges[run, i + 1]
        next_tail, _ = arcsine_tail(fold(outer / z), s, q, 8 if z.dtype == jnp.float64 else None)
        next_power = jnp.exp(q * jnp.log(outer))
        taken = density * (next_power - power) + s * s * course.swept[run, i]
        return next_tail, next_power, left + load * (next_tail - tail), rest - load * taken

    zero = jnp.zeros_like(z)
    begin = zero, zero, zero, zero + s * amplitude / C
    _, _, left, rest = jax.lax.fori_loop(0, course.swept.shape[-1], add, begin)
    log_z = jnp.log(z)
    smooth, singular = (1.0 + s) * (1.0 - amplitude) / C, jnp.maximum(rest, 0.0)
    punch = smooth * jnp.exp(s * log_z) + singular * jnp.exp(-q * log_z)
    under_indenter = jnp.where(under, punch + left, jnp.where(slips, ring, 0.0))
    return jnp.where(worn, under_indenter, unworn)


@ruled(r=RADIUS, k=EXPONENT, phi=AMPLITUDE, n=CYCLES, compliance=SOFTNESS)
def pressure(
    r: ArrayLike,
    k: ArrayLike,
    phi: ArrayLike,
    n: ArrayLike,
    *,
    control: str = "force",
    compliance: ArrayLike = 0.0,
    digits: int | None = None,
) -> Array:
    """Pressure at a radius after n reduced cycles, nowhere negative.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        control: Whose amplitude is held, that of the "force" or of the "displacement"; phi is that before any wear.
        compliance: X of `partial_slip.displacement_amplitude` if the displacement is that of a rig, X >= 0.
        digits: As of `wear_volume`. Measured at 4 digits the wear rate by the pressures and their gap, and by their
            energy, is that of the volume to 2e-2 of the first rate, mostly 6e-3, at 5 digits to 9e-3, mostly 1e-3.

    Returns:
        The pressure in units of F_N/(pi a_0^2), broadcast over all arguments; it ends as `fretting.steady_pressure`.

    Raises:
        ValueError: A concrete argument, or `digits`, is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi, n = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    course, phi = course_under(control, k, phi, jnp.asarray(compliance), digits)
    return pressure_of(course, r, k, phi, n)
