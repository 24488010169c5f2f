"""Displacements, profiles and wear depths along the radius, Eqs. (11), (14), (24) and (25)."""

from typing import Any, NamedTuple

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, NOT_NEGATIVE, ArrayLike
from plgwear_jax._core.formula import formula
from plgwear_jax.special.arcsine import Arc, arc, arcsine_tail, fold_outside, over_abscissa
from plgwear_jax.special.elementary import exponents, sine_quotient, squares_apart

from .stick import sinking, slip, stick, stick_power


def _punch_displacement(r: Array, c: Array, m: Array, s: Array, q: Array, digits: int | None) -> Array:
    """Surface displacement of a punch of radius c with a parabolic tip, deeper by a share m than an unworn parabola.

    Eqs. (14), (18), (24): d - r^2/2 under the punch, d = c^2 (1+m)/(2s), and for r > c
    c^2 ((d/c^2 - 1/2) (1 - Q) + sigma y^-s T_1(1/y)/2).
    """
    under = r <= c
    _, body, moment = arcsine_tail(fold_outside(r, c), s, q, digits)
    outside = 0.5 * ((q + m) / s * body + moment)
    # 1/s - (r/c)^2, whose terms are nearly equal as k -> 1 and r -> c, is written as the sum q/s + (1 - (r/c)^2).
    within = jnp.where(under, r, 0.0)
    inside = 0.5 * ((q + m) / s + squares_apart(c, within, c))
    return c * c * jnp.where(under, inside, outside)


def _punch_slope(r: Array, c: Array, m: Array, s: Array, q: Array, digits: int | None) -> Array:
    """d/dr of `_punch_displacement`: -r under the punch; r sigma y^-s (T_1(1/y)/y - (1+m)/(s (1+y))) for r > c.

    Towards the edge, where both terms cancel, the code uses the equal -r (1 - Q + sigma y^-s (m - y)/(s (1+y))).
    """
    under = r <= c
    y = fold_outside(r, c)
    _, body, moment = arcsine_tail(y, s, q, digits)
    density = jnp.exp(jnp.where(y.inner, -s, s) * y.log_x)  # y^-s
    outer = jnp.where(under | (r == jnp.inf), 2.0 * c, r)
    flat = c * q * sine_quotient(s, q, digits) * density * (c / outer)
    near = flat * (jnp.where(y.inner, y.x, 0.0) - m) - outer * body
    far = outer * over_abscissa(moment, y) - (1.0 + m) * flat
    return jnp.where(under, -r, jnp.where(y.inner, near, far))


def _initial_punch(r: Array, k: Array) -> Any:
    """The arguments of a punch that is an unworn parabola."""
    return r, jnp.ones_like(k), jnp.zeros_like(k), *exponents(k)


@formula(
    slopes={"r": lambda *at, digits: _punch_slope(*_initial_punch(*at), digits=digits)}, r=NOT_NEGATIVE, k=EXPONENT
)
def initial_displacement(r: ArrayLike, k: ArrayLike, *, digits: int | None = None) -> Array:
    """Normal displacement w_0 of the surface before any wear: Eq. (14), and d_0 - r^2/2 for r <= 1.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        w_0 in units of a_0^2/R, broadcast over r and k. At r = 1 the derivative is the one-sided one from inside.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.initial_displacement(0.0, 0.0):.6f}")  # Hertz: a_0^2/R at the centre
        1.000000

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (14), (15).
    """
    return _punch_displacement(*_initial_punch(jnp.asarray(r), jnp.asarray(k)), digits=digits)


def _steady_displacement_by_phi(r: Array, k: Array, phi: Array, digits: int | None) -> Array:
    """dw_inf/dphi: d(d_inf)/dphi for r <= c, and -(1/y) sigma y^-s T_1(1/y) d(d_inf)/dphi for r > c."""
    s, q = exponents(k)
    c = stick(k, phi)
    y = fold_outside(r, c)
    *_, moment = arcsine_tail(y, s, q, digits)
    return sinking(s, phi, digits) * jnp.where(r <= c, 1.0, -over_abscissa(moment, y))


def _steady_punch(r: Array, k: Array, phi: Array) -> Any:
    """The arguments of the punch of the worn state."""
    s, q = exponents(k)
    return r, stick(k, phi), slip(s, phi), s, q


@formula(
    slopes={
        "r": lambda *at, digits: _punch_slope(*_steady_punch(*at), digits=digits),
        "phi": _steady_displacement_by_phi,
    },
    r=NOT_NEGATIVE,
    k=EXPONENT,
    phi=AMPLITUDE,
)
def steady_displacement(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Normal displacement w_inf of the surface in the worn state: Eqs. (18), (24), and d_inf - r^2/2 for r <= c.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        w_inf in units of a_0^2/R, broadcast over all arguments. At r = c the derivative in r is the one from inside.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.steady_displacement(1.0, 0.3, 0.4):.6f}")
        0.251553

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (24).
    """
    return _punch_displacement(*_steady_punch(jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi)), digits=digits)


@formula(slopes={"phi": lambda k, phi, digits: sinking(exponents(k)[0], phi, digits)}, k=EXPONENT, phi=AMPLITUDE)
def penetration(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Indentation depth d_inf in the steady state, Eqs. (11) and (25); at phi = 0 it is d_0 = 1/(k+1), Eq. (11).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        d_inf in units of a_0^2/R, broadcast over k and phi.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.penetration(0.3, 0.4):.6f}")
        0.792469

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (11) before wear, Eq. (25) in the steady
        state.
    """
    s, _ = exponents(k)
    phi = jnp.asarray(phi)
    return 0.5 * stick_power(s, phi, 2.0, digits) * (1.0 + slip(s, phi)) / s


def arc_between(
    r: Array, c: Array, end: Array | float, s: Array, q: Array, digits: int | None
) -> tuple[Array, Array, Arc]:
    """(Whether radii lie between c and an end, y = (r/c)^2 - 1 there and anything elsewhere, the arc up to y)."""
    inside = (r > c) & (r <= end)
    near = jnp.where(inside, r, 1.25 * c)
    y = squares_apart(near, c, c)
    return inside, y, arc(y, s, q, digits)


class _Ring(NamedTuple):
    """A radius, located in the worn ring."""

    worn: Array  # whether the radius lies inside the ring
    c: Array
    at: Arc
    y: Array  # a harmless value outside the ring
    lift: Array  # m - G(y), positive in the ring


def _ring_at(r: Array, k: Array, phi: Array, digits: int | None) -> _Ring:
    s, q = exponents(k)
    c, m = stick(k, phi), slip(s, phi)
    # No ring reaches further than y = m/s.
    inside, y, at = arc_between(r, c, 2.0 * c * jnp.sqrt(1.0 + m / s), s, q, digits)
    lift = m - y * at.chord
    return _Ring(inside & (lift > 0.0), c, at, y, lift)


def _worn_depth(r: Any, k: Any, phi: Any, digits: int | None) -> Array:
    ring = _ring_at(r, k, phi, digits)
    return jnp.where(ring.worn, 0.5 * ring.c * ring.c * ring.at.share * ring.lift, 0.0)


def _worn_depth_by_phi(r: Array, k: Array, phi: Array, digits: int | None) -> Array:
    """d(f_inf)/dphi = d(d_inf)/dphi (Q + sigma y^-s/s) inside the ring."""
    s, q = exponents(k)
    ring = _ring_at(r, k, phi, digits)
    rate = s * ring.at.share + q * ring.at.density / jnp.where(ring.worn, ring.y, 1.0)
    return jnp.where(ring.worn, sinking(s, phi, digits) * rate, 0.0)


@formula(slopes={"phi": _worn_depth_by_phi}, r=NOT_NEGATIVE, k=EXPONENT, phi=AMPLITUDE)
def wear_depth(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Depth worn off the indenter, f_inf - f_0 = c^2 Q (Lambda - L)/2, from Eqs. (24) and (25).

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The depth in units of a_0^2/R, broadcast over all arguments: positive for c < r < a_inf and 0 elsewhere.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.wear_depth(1.0, 0.3, 0.4):.6f}")
        0.040917

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (24), (25).
    """
    return _worn_depth(r, k, phi, digits)


@formula(slopes={"phi": _worn_depth_by_phi}, r=NOT_NEGATIVE, k=EXPONENT, phi=AMPLITUDE)
def profile(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Shape f_inf of the worn indenter, Eq. (25): d_inf - w_inf in the worn ring, f_0 = r^2/2 elsewhere.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The height above the apex in units of a_0^2/R, broadcast over all arguments.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.profile(0.5, 0.3, 0.4):.6f}")  # unworn where it sticks: r^2/2
        0.125000

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (25).
    """
    r = jnp.asarray(r)
    return 0.5 * r * r + _worn_depth(r, k, phi, digits)
