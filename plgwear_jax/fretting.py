"""Fretting wear under partial slip: section 3 of the paper, without units.

A rigid parabolic indenter f_0 = r^2/(2R) is held by a normal force and shaken by a tangential one. Outside the stick
radius c it wears until it only just touches: the steady state. Radii are in units of the initial contact radius a_0,
heights in a_0^2/R, and phi = F_x/(mu F_N) is the amplitude.

Notation: s = (1+k)/2, q = (1-k)/2, y = (r/c)^2 - 1, sigma = sin(pi s)/pi, Q(y; s) the arcsine tail; Lambda = m/s with
m = phi/((1-phi)(1+s)) is (2/c^2) times the depth by which the punch of radius c goes deeper than its own parabola.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike, DTypeLike

from plgwear_jax._formula import AMPLITUDE, EXPONENT, RADIUS, apart, formula
from plgwear_jax._punch import exponents, fold_beside, punch_stress
from plgwear_jax.special.arcsine import Arc, arc, arcsine_body_moment, over_abscissa
from plgwear_jax.special.elementary import (
    exponentials,
    log_complement,
    quotient,
    reciprocal,
    sine_quotient,
    working_digits,
)

__all__ = [
    "edge_intensity",
    "initial_displacement",
    "initial_pressure",
    "penetration",
    "profile",
    "steady_displacement",
    "steady_pressure",
    "steady_traction",
    "stick_radius",
    "wear_depth",
    "wear_volume",
    "worn_radius",
]


def _slip(s: Array, phi: Array) -> Array:
    """m = phi/((1-phi)(1+s)) = s Lambda: the load that the worn ring has to carry, regular as s -> 0."""
    return quotient(phi, (1.0 - phi) * (1.0 + s))


# As phi changes at a fixed normal force, c shrinks and the force beyond that of the parabola, F_N - F_1(c), grows. The
# parabola's share of either cancels: a parabola deeper by a little is a flat punch more. What remains is that force
# times the change of a flat punch's field with its radius; the closed forms of d/dphi below, free of the cancellation,
# all carry the factor d(d_inf)/dphi = c^2 m/(2 (1+s) (1-phi)).


def _sinking(s: Array, phi: Array, digits: int | None) -> Array:
    """d(d_inf)/dphi, the rate at which the punch sinks in as the amplitude grows."""
    return 0.5 * _stick_power(s, phi, 2.0, digits) * _slip(s, phi) * reciprocal((1.0 + s) * (1.0 - phi))


# --- the stick radius ---------------------------------------------------------------------------------------------


@jax.custom_jvp
def _stick_radius(k: Array, phi: Array) -> Array:
    # Near the stick edge everything hangs on r - c, so c is wanted to an ulp or two, however small it is: the
    # logarithm and the quotient are carried with their rounding errors.
    complement = 1.0 - phi
    log_hi = log_complement(phi)
    # 1 - phi is exact from 1/2 on, and there the logarithm is long enough to need its second part.
    log_lo = jnp.where(phi >= 0.5, complement * jnp.exp(-log_hi) - 1.0, 0.0)
    grid = 2.0 ** (jnp.finfo(k.dtype).nmant // 2 - 4)  # head * divisor is then exact
    k_hi = jnp.round(k * grid) / grid
    divisor = 3.0 + k_hi
    quotient = log_hi / (3.0 + k)
    head = jnp.round(quotient * grid) / grid
    remainder = (log_hi - head * divisor) - (quotient - head) * divisor - quotient * (k - k_hi)
    correction = (remainder + log_lo) / (3.0 + k)
    radius = jnp.exp(quotient)
    return radius + radius * correction


@_stick_radius.defjvp
def _stick_radius_jvp(primals, tangents):
    (k, phi), (dk, dphi) = primals, tangents
    c = _stick_radius(k, phi)
    return c, -c / (3.0 + k) * (dphi / (1.0 - phi) + log_complement(phi) / (3.0 + k) * dk)


def _stick_power(s: Array, phi: Array, exponent: float, digits: int | None) -> Array:
    """c^exponent, Eq. (16), to the accuracy of a plain exponential."""
    return exponentials(0.5 * exponent * log_complement(phi, digits) * reciprocal(1.0 + s), digits)[0]


@formula(k=EXPONENT, phi=AMPLITUDE)
def stick_radius(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Stick radius c = b = (1-phi)^(1/(k+3)), Eqs. (16) and (23); the same in the initial and the steady state.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        c in units of a_0, broadcast over k and phi, in (0, 1]; 1 at phi = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    del digits
    return _stick_radius(jnp.asarray(k), jnp.asarray(phi))


# --- the worn ring ------------------------------------------------------------------------------------------------


# G(y) = s L(y) is the load of the ring that ends at y: its edge is the root of G(y) = m, Eq. (26) divided by c^2/(2s).


def _ring_starter(s: Array, q: Array, phi: Array) -> Array:
    """An approximation of the root of G(y) = m, off by 0.5 % at the worst.

    y = m (1+q + q^2 w (1 - (1-phi)^s)/s) is exact with w = 1 as phi -> 1, and with w = (1+q)/((1+s) (2+q)) to second
    order as phi -> 0; `tools/ring_starter.py` finds the way of w from one to the other.
    """
    few = 2
    lost = -exponentials(s * log_complement(phi, few), few)[1]
    v = 1.0 - jnp.abs(jnp.sqrt(1.0 - phi))
    a, b, c, d, e, f, g, h = _WAY
    way = v * ((a + b * s) + lost * (c + d * s) + v * ((e + f * s) + lost * (g + h * s)))
    narrow = (1.0 + q) * reciprocal((1.0 + s) * (2.0 + q))
    share = 1.0 + q + q * q * lost * reciprocal(s) * (narrow + (1.0 - narrow) * way)
    return phi * share / ((1.0 - phi) * (1.0 + s))


_WAY = (0.4291, 0.5202, -1.0660, 2.5157, 0.7306, -2.2103, 0.9381, -0.9564)
# Digits of y that the starter has, and that Halley's step makes of them.
_STARTER_DIGITS, _STEP_DIGITS = 2, 8


def _half(digits: int | None, dtype: DTypeLike) -> int:
    """The digits of y that a result needs in which the square of its error appears."""
    return max(_STARTER_DIGITS + 1, working_digits(digits, dtype) // 2)


@functools.partial(jax.custom_jvp, nondiff_argnums=(3, 4))
def _solve_ring(s: Array, q: Array, phi: Array, digits: int | None, wanted: int | None = None) -> Array:
    """y_inf, the outer edge of the worn ring, y = (a_inf/c)^2 - 1, for phi > 0, to the digits wanted of it or to all.

    Derivatives are always to `digits`.
    """
    wanted = wanted or working_digits(digits, s.dtype)
    y = _ring_starter(s, q, phi)
    # Each step is a kernel of its own, which divisions as the last operation and `apart` after them see to.
    if wanted > _STARTER_DIGITS:
        s, q, phi, y = apart(3, s, q, phi, y)
        y = _halley(y, _slip(s, phi), s, q, min(wanted, _STEP_DIGITS) - 1)
    if wanted > _STEP_DIGITS:
        s, q, phi, y = apart(4, s, q, phi, y)
        y = _halley(y, _slip(s, phi), s, q, digits)
    return y


def _halley(y: Array, m: Array, s: Array, q: Array, digits: int | None) -> Array:
    at = arc(y, s, q, digits)
    lack = _lack(y, at, m)
    denominator = at.slope * at.slope + 0.5 * at.bend * lack
    return (denominator + at.slope * lack) / (denominator * reciprocal(y))


def _lack(y: Array, at: Arc, m: Array) -> Array:
    """(m - G(y))/y, the load that a ring from 0 to y still lacks; over y, or squares would underflow."""
    return quotient(m, y) - at.chord


@_solve_ring.defjvp
def _ring_jvp(digits: int | None, wanted: int | None, primals, tangents):
    del wanted
    s, q, phi = primals
    y = _ring(s, q, phi, digits)
    # The implicit function: G_y dy + G_s ds + G_q dq = dm.
    _, dm = jax.jvp(_slip, (s, phi), (tangents[0], tangents[2]))
    at, by_shape = jax.jvp(lambda s, q: arc(y, s, q, digits), (s, q), tangents[:2])
    return y, (dm - y * by_shape.chord) * reciprocal(at.slope)


# Traced once for a value and its slopes.
_ring = jax.jit(_solve_ring, static_argnums=(3, 4))


def _worn(phi: Array) -> tuple[Array, Array]:
    """(There is a ring, phi with something harmless where there is none)."""
    worn = phi > 0.0
    return worn, jnp.where(worn, phi, 0.5)


@formula(k=EXPONENT, phi=AMPLITUDE)
def worn_radius(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Outer radius a_inf of the worn ring, where the worn profile meets the initial one, Eq. (26).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        a_inf in units of a_0, broadcast over k and phi, at least 1; 1 at phi = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    s, q = exponents(jnp.asarray(k))
    worn, phi = _worn(jnp.asarray(phi))
    radius = _stick_power(s, phi, 1.0, digits) * jnp.sqrt(1.0 + _ring(s, q, phi, digits))
    radius = jnp.where(worn, radius, 1.0)
    # Rounding must not put the ring inside the contact; the derivatives are left alone.
    return radius + jax.lax.stop_gradient(jnp.maximum(1.0 - radius, 0.0))


# --- the wear volume ----------------------------------------------------------------------------------------------


def _wear_volume(y: Array, s: Array, q: Array, phi: Array, digits: int | None, *, second: bool) -> Array:
    """Eq. (28) in closed form: (pi/2) c^4 times the integral from 0 to y_inf of (Q/s) (m - G) dy.

    y is near the ring's edge, where the integral is stationary: an error e of y leaves one of e^2 or, to `second`
    order, e^3. So do its derivatives at fixed y leave e or e^2.
    """
    at = arc(y, s, q, digits)
    lack, rest = _lack(y, at, _slip(s, phi)), at.area
    if second:
        rest = rest + 0.5 * at.share * y * lack * reciprocal(at.slope)
    return 0.5 * jnp.pi * _stick_power(s, phi, 4.0, digits) * (at.below + y * lack * rest)


def _wear_volume_by_k(k: Array, phi: Array, *, digits: int | None) -> Array:
    """dV/dk, at a fixed edge of the ring, in which the volume is stationary."""
    worn, phi = _worn(phi)
    y = _ring(*exponents(k), phi, digits, _half(digits, k.dtype))
    k, phi, y = apart(1, k, phi, y)

    def volume(k: Array) -> Array:
        return _wear_volume(y, *exponents(k), phi, digits, second=True)

    return jnp.where(worn, jax.jvp(volume, (k,), (jnp.ones_like(k),))[1], 0.0)


def _wear_volume_by_phi(k: Array, phi: Array, *, digits: int | None) -> Array:
    """dV/dphi = d(d_inf)/dphi pi c^2 times the integral from 0 to y_inf of (Q + sigma y^-s/s) dy."""
    worn, phi = _worn(phi)
    y = _ring(*exponents(k), phi, digits, _half(digits, k.dtype))
    k, phi, y = apart(2, k, phi, y)
    s, q = exponents(k)
    at = arc(y, s, q, digits)
    missing = _lack(y, at, _slip(s, phi)) * reciprocal(at.slope)  # from y to the ring's edge, over y
    integral = s * at.area + at.density + missing * (s * at.share * y + q * at.density)
    slope = jnp.pi * _stick_power(s, phi, 2.0, digits) * _sinking(s, phi, digits) * integral
    return jnp.where(worn, slope, 0.0)


@formula({"k": _wear_volume_by_k, "phi": _wear_volume_by_phi}, k=EXPONENT, phi=AMPLITUDE)
def wear_volume(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Volume worn off the indenter on the way to the steady state, Eq. (28) in closed form.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The volume in units of a_0^4/R, broadcast over k and phi; 0 at phi = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Example:
        >>> import jax
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.wear_volume(0.0, 0.5):.4f}")
        0.1322
        >>> slope = jax.grad(fretting.wear_volume)(0.0, 0.5)  # d/dk: a positive k wears less at this amplitude
        >>> print(slope < 0)
        True
    """
    k, (worn, phi) = jnp.asarray(k), _worn(jnp.asarray(phi))
    # For few digits a term more of Taylor's series is cheaper than a step: the starter's 5e-3 leaves 2e-8.
    few = working_digits(digits, k.dtype) <= 8
    y = _ring(*exponents(k), phi, digits, _STARTER_DIGITS if few else _half(digits, k.dtype))
    k, phi, y = apart(0, k, phi, y)
    return jnp.where(worn, _wear_volume(y, *exponents(k), phi, digits, second=few), 0.0)


# --- displacements and profiles -------------------------------------------------------------------------------------


def _punch_displacement(r: Array, c: Array, m: Array, s: Array, q: Array, digits: int | None) -> Array:
    """Surface displacement of a punch of radius c with a parabolic tip, deeper by m than its own parabola.

    Eqs. (14), (18), (24): d - r^2/2 under the punch, d = c^2 (1+m)/(2s), and beside it
    c^2 ((d/c^2 - 1/2) (1 - Q) + sigma y^-s T_1(1/y)/2).
    """
    under = r <= c
    body, moment = arcsine_body_moment(fold_beside(r, c), s, q, digits)
    beside = 0.5 * ((q + m) / s * body + moment)
    # 1/s - (r/c)^2 = q/s + 1 - (r/c)^2, a difference of nearly equal numbers as k -> 1 and r -> c.
    within = jnp.where(under, r, 0.0)
    inside = 0.5 * ((q + m) / s + ((c - within) / c) * ((c + within) / c))
    return c * c * jnp.where(under, inside, beside)


def _punch_slope(r: Array, c: Array, m: Array, s: Array, q: Array, digits: int | None) -> Array:
    """d/dr of `_punch_displacement`: -r under the punch, and beside it r sigma y^-s (T_1(1/y)/y - (1+m)/(s (1+y))).

    Towards the edge, where those two cancel, it is -r (1 - Q + sigma y^-s (m - y)/(s (1+y))).
    """
    under = r <= c
    beside = fold_beside(r, c)
    body, moment = arcsine_body_moment(beside, s, q, digits)
    density = jnp.exp(jnp.where(beside.inner, -s, s) * beside.log_x)  # y^-s
    outer = jnp.where(under, 2.0 * c, r)
    flat = c * q * sine_quotient(s, q, digits) * density * (c / outer)
    near = flat * (jnp.where(beside.inner, beside.x, 0.0) - m) - outer * body
    far = outer * over_abscissa(moment, beside) - (1.0 + m) * flat
    return jnp.where(under, -r, jnp.where(beside.inner, near, far))


def _initial_displacement_by_r(r: Array, k: Array, *, digits: int | None) -> Array:
    s, q = exponents(k)
    return _punch_slope(r, jnp.ones_like(k), jnp.zeros_like(k), s, q, digits)


@formula({"r": _initial_displacement_by_r}, r=RADIUS, k=EXPONENT)
def initial_displacement(r: ArrayLike, k: ArrayLike, *, digits: int | None = None) -> Array:
    """Normal displacement w_0 of the surface before any wear: Eq. (14), and d_0 - r^2/2 for r <= 1.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        w_0 in units of a_0^2/R, broadcast over r and k. At r = 1 the derivative is that from inside.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    r, k = jnp.asarray(r), jnp.asarray(k)
    s, q = exponents(k)
    return _punch_displacement(r, jnp.ones_like(k), jnp.zeros_like(k), s, q, digits)


def _steady_displacement_by_phi(r: Array, k: Array, phi: Array, *, digits: int | None) -> Array:
    """dw_inf/dphi: that of d_inf under the punch, and -1/y sigma y^-s T_1(1/y) times it beside."""
    s, q = exponents(k)
    c = _stick_radius(k, phi)
    beside = fold_beside(r, c)
    _, moment = arcsine_body_moment(beside, s, q, digits)
    return _sinking(s, phi, digits) * jnp.where(r <= c, 1.0, -over_abscissa(moment, beside))


def _steady_displacement_by_r(r: Array, k: Array, phi: Array, *, digits: int | None) -> Array:
    s, q = exponents(k)
    return _punch_slope(r, _stick_radius(k, phi), _slip(s, phi), s, q, digits)


@formula(
    {"r": _steady_displacement_by_r, "phi": _steady_displacement_by_phi},
    r=RADIUS,
    k=EXPONENT,
    phi=AMPLITUDE,
)
def steady_displacement(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Normal displacement w_inf of the surface in the worn state: Eqs. (18), (24), and d_inf - r^2/2 for r <= c.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        w_inf in units of a_0^2/R, broadcast over all arguments. At r = c the derivative in r is that from inside.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    return _punch_displacement(r, _stick_radius(k, phi), _slip(s, phi), s, q, digits)


def _penetration_by_phi(k: Array, phi: Array, *, digits: int | None) -> Array:
    return _sinking(exponents(k)[0], phi, digits)


@formula({"phi": _penetration_by_phi}, k=EXPONENT, phi=AMPLITUDE)
def penetration(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Penetration depth d_inf in the steady state, Eqs. (11) and (25); at phi = 0 it is d_0 = 1/(k+1), Eq. (11).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        d_inf in units of a_0^2/R, broadcast over k and phi.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    s, _ = exponents(jnp.asarray(k))
    phi = jnp.asarray(phi)
    return 0.5 * _stick_power(s, phi, 2.0, digits) * (1.0 + _slip(s, phi)) / s


class _Ring(NamedTuple):
    """A radius as seen by the worn ring."""

    worn: Array  # it lies inside the ring
    c: Array
    at: Arc
    y: Array  # harmless outside the ring
    lift: Array  # m - G(y), positive inside


def _in_ring(r: Array, k: Array, phi: Array, digits: int | None) -> _Ring:
    s, q = exponents(k)
    c, m = _stick_radius(k, phi), _slip(s, phi)
    # No ring is wider than y = m/s; beyond twice that a radius is as good as any other.
    widest = 2.0 * c * jnp.sqrt(1.0 + m / s)
    inside = (r > c) & (r < widest)
    near = jnp.where(inside, r, widest)
    y = ((near - c) / c) * ((near + c) / c)
    at = arc(y, s, q, digits)
    lift = m - y * at.chord
    return _Ring(inside & (lift > 0.0), c, at, y, lift)


def _worn_depth(r: Array, k: Array, phi: Array, digits: int | None) -> Array:
    ring = _in_ring(r, k, phi, digits)
    return jnp.where(ring.worn, 0.5 * ring.c * ring.c * ring.at.share * ring.lift, 0.0)


def _worn_depth_by_phi(r: Array, k: Array, phi: Array, *, digits: int | None) -> Array:
    """d(f_inf)/dphi = d(d_inf)/dphi (Q + sigma y^-s/s) inside the ring."""
    s, q = exponents(k)
    ring = _in_ring(r, k, phi, digits)
    rate = s * ring.at.share + q * ring.at.density / jnp.where(ring.worn, ring.y, 1.0)
    return jnp.where(ring.worn, _sinking(s, phi, digits) * rate, 0.0)


@formula({"phi": _worn_depth_by_phi}, r=RADIUS, k=EXPONENT, phi=AMPLITUDE)
def wear_depth(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Depth worn off the indenter, f_inf - f_0 = c^2 Q (Lambda - L)/2, from Eqs. (24) and (25).

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The depth in units of a_0^2/R, broadcast over all arguments: positive for c < r < a_inf and 0 elsewhere.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    return _worn_depth(jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), digits)


@formula({"phi": _worn_depth_by_phi}, r=RADIUS, k=EXPONENT, phi=AMPLITUDE)
def profile(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Limiting shape f_inf of the worn indenter, Eq. (25): f_0 = r^2/2 outside the ring, d_inf - w_inf in it.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The height above the apex in units of a_0^2/R, broadcast over all arguments.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    r = jnp.asarray(r)
    return 0.5 * r * r + _worn_depth(r, jnp.asarray(k), jnp.asarray(phi), digits)


# --- stresses -------------------------------------------------------------------------------------------------------


@formula(r=RADIUS, k=EXPONENT)
def initial_pressure(r: ArrayLike, k: ArrayLike, *, digits: int | None = None) -> Array:
    """Pressure before any wear, p_0 = (k+3)/2 (1 - r^2)^((1+k)/2), Eq. (13); zero for r >= 1.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        p_0 in units of F_N/(pi a_0^2), broadcast over r and k.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    del digits
    k = jnp.asarray(k)
    s, q = exponents(k)
    return punch_stress(jnp.asarray(r), jnp.ones_like(k), s, q, smooth=1.0 + s, singular=jnp.zeros_like(k))


def _steady_pressure_by_phi(r: Array, k: Array, phi: Array, *, digits: int | None) -> Array:
    """dp_inf/dphi = s phi (q + s z) z^(-q-1)/(c^2 (1+s) (1-phi)) for r < c, z = 1 - (r/c)^2."""
    del digits
    s, q = exponents(k)
    c = _stick_radius(k, phi)
    under = r < c
    inside = jnp.where(under, r, 0.0)
    z = ((c - inside) / c) * ((c + inside) / c)
    rate = s * _slip(s, phi) * (q + s * z) * jnp.exp(-q * jnp.log(z)) / (z * c * c)
    return jnp.where(under, rate, 0.0)


@formula({"phi": _steady_pressure_by_phi}, r=RADIUS, k=EXPONENT, phi=AMPLITUDE)
def steady_pressure(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Pressure in the worn state, Eq. (17) with b = c: singular at the stick edge, zero outside it.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        p_inf in units of F_N/(pi a_0^2), broadcast over all arguments; infinite at r = c for phi > 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    del digits
    k, phi = jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    # F_1(c)/F_N = c^(k+3) = 1 - phi, Eq. (12).
    return punch_stress(jnp.asarray(r), _stick_radius(k, phi), s, q, smooth=(1.0 + s) * (1.0 - phi), singular=s * phi)


@formula(r=RADIUS, k=EXPONENT, phi=AMPLITUDE)
def steady_traction(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Tangential traction in the worn state, Eq. (19) with b = c: singular at the stick edge, zero outside it.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        tau_inf in units of mu F_N/(pi a_0^2), broadcast over all arguments; infinite at r = c for phi > 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    del digits
    k, phi = jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    return punch_stress(jnp.asarray(r), _stick_radius(k, phi), s, q, smooth=jnp.zeros_like(phi), singular=s * phi)


@formula(k=EXPONENT, phi=AMPLITUDE)
def edge_intensity(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Strength of the stress singularity at the stick edge: the factor of (2 delta)^((k-1)/2) in Eqs. (20), (21).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The factor of p_inf(c (1 - delta)) in units of F_N/(pi a_0^2), and of tau_inf in mu F_N/(pi a_0^2).

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    s, _ = exponents(jnp.asarray(k))
    phi = jnp.asarray(phi)
    return s * phi / _stick_power(s, phi, 2.0, digits)
