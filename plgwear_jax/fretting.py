"""Fretting wear under partial slip: section 3 of the paper, without units.

A rigid parabolic indenter f_0 = r^2/(2R) is pressed by a constant normal force and loaded by an oscillating tangential
force. Outside the stick radius c it wears until it touches without pressure: the steady state. Radii are in units of
the initial contact radius a_0, heights in a_0^2/R, and phi = F_x/(mu F_N) is the relative amplitude of the force.

Notation: s = (1+k)/2, q = (1-k)/2, y = (r/c)^2 - 1, sigma = sin(pi s)/pi, Q(y; s) the arcsine tail; Lambda = m/s with
m = phi/((1-phi)(1+s)) is (2/c^2) times the depth by which the punch of radius c goes deeper than its own parabola.
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike, DTypeLike

from plgwear_jax._formula import AMPLITUDE, EXPONENT, RADIUS, Domain, formula
from plgwear_jax._punch import exponents, fold_beside, punch_stress
from plgwear_jax.special.arcsine import Arc, arc, arcsine_body_moment, over_abscissa
from plgwear_jax.special.elementary import (
    exponentials,
    log,
    log_complement,
    quotient,
    reciprocal,
    sine_quotient,
    working_digits,
)
from plgwear_jax.special.lean import lean, maximum, sqrt
from plgwear_jax.special.xla import apart, together

__all__ = [
    "deepest_wear",
    "edge_intensity",
    "edge_pressure",
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

DISTANCE = Domain("distance >= 0", lambda distance: distance >= 0.0)


@lean
def _slip(s: Array, phi: Array) -> Array:
    """m = phi/((1-phi)(1+s)) = s Lambda, finite as s -> 0."""
    return quotient(phi, (1.0 - phi) * (1.0 + s))


# The closed forms of d/dphi below subtract no nearly equal numbers. All contain d(d_inf)/dphi = c^2 m/(2 (1+s)(1-phi)):
# docs/theory.md, section "Derivatives with respect to the amplitude".


@lean
def _sinking(s: Array, phi: Array, digits: int | None) -> Array:
    """d(d_inf)/dphi, the change of the penetration with the amplitude."""
    return 0.5 * _stick_power(s, phi, 2.0, digits) * _slip(s, phi) * reciprocal((1.0 + s) * (1.0 - phi))


# --- the stick radius ---------------------------------------------------------------------------------------------


@jax.custom_jvp
def _stick_radius(k: Array, phi: Array) -> Array:
    # Near the stick edge results depend on r - c, so c is needed to an ulp or two, however small it is. Hence the
    # logarithm and the quotient are computed together with their rounding errors.
    complement = 1.0 - phi
    log_hi = log_complement(phi)
    # For phi >= 1/2, 1 - phi is exact, and the rounding error of its logarithm counts.
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


@lean
def _stick_power(s: Array, phi: Array, exponent: float, digits: int | None) -> Array:
    """c^exponent, Eq. (16), to the accuracy of a plain exponential."""
    return exponentials(0.5 * exponent * log_complement(phi, digits) * reciprocal(1.0 + s), digits)[0]


@formula(k=EXPONENT, phi=AMPLITUDE)
def stick_radius(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Stick radius c = b = (1-phi)^(1/(k+3)), Eqs. (16) and (23); the same in the initial and the steady state.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        c in units of a_0, broadcast over k and phi, in (0, 1]; 1 at phi = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    del digits
    return _stick_radius(jnp.asarray(k), jnp.asarray(phi))


# --- the worn ring ------------------------------------------------------------------------------------------------


# With G(y) = s L(y) the outer edge of the ring is the root of G(y) = m, which is Eq. (26) divided by c^2/(2s). The
# place of the deepest wear is a root of the same kind. Both are found from a fitted start by one or two Halley steps.


class _Rise(NamedTuple):
    """A function of y that rises from 0 to infinity."""

    chord: Array  # the function over y
    slope: Array
    bend: Array  # y times its second derivative


class _Root(NamedTuple):
    """An equation for a place y in the worn ring, rise(y) = load."""

    rise: Callable[[Array, Array, Array, int | None], _Rise | Arc]  # of (y, s, q, digits)
    load: Callable[[Array, Array, Array], Array]  # of (s, q, phi)
    starter: Callable[[Array, Array, Array], Array]
    digits: tuple[int, int]  # correct digits of y, from the starter and after one Halley step


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 4, 5))
def _solve(root: _Root, s: Array, q: Array, phi: Array, digits: int | None, wanted: int | None) -> Array:
    """y for phi > 0, to the digits wanted of it or, by default, to all.

    Derivatives are always to `digits`.
    """
    wanted = wanted or working_digits(digits, s.dtype)
    few, some = root.digits
    y = root.starter(s, q, phi)
    # Each step is a kernel of its own: its last operation is a division, and `apart` follows.
    if wanted > few:
        s, q, phi, y = apart(3, s, q, phi, y)
        y = _halley(y, root.load(s, q, phi), root.rise(y, s, q, min(wanted, some) - 1))
    if wanted > some:
        s, q, phi, y = apart(4, s, q, phi, y)
        y = _halley(y, root.load(s, q, phi), root.rise(y, s, q, digits))
    return y


@lean
def _halley(y: Array, load: Array, at: _Rise | Arc) -> Array:
    lack = _lack(y, load, at)
    denominator = at.slope * at.slope + 0.5 * at.bend * lack
    return (denominator + at.slope * lack) / (denominator * reciprocal(y))


@lean
def _lack(y: Array, load: Array, at: _Rise | Arc) -> Array:
    """(load - rise(y))/y; divided by y, since squares would underflow."""
    return quotient(load, y) - at.chord


@_solve.defjvp
def _solve_jvp(root: _Root, digits: int | None, wanted: int | None, primals, tangents):
    del wanted
    y = _place(root, *primals, digits, None)
    # The implicit function: rise_y dy + rise_s ds + rise_q dq = dload.
    _, dload = jax.jvp(root.load, primals, tangents)
    at, by_shape = jax.jvp(lambda s, q: root.rise(y, s, q, digits), primals[:2], tangents[:2])
    return y, (dload - y * by_shape.chord) * reciprocal(at.slope)


# Traced once for a value and its slopes.
_place = jax.jit(_solve, static_argnums=(0, 4, 5))


def _half(root: _Root, digits: int | None, dtype: DTypeLike) -> int:
    """The digits of y that a result needs in which the square of its error appears."""
    return max(root.digits[0] + 1, working_digits(digits, dtype) // 2)


@lean
def _ring_starter(s: Array, q: Array, phi: Array) -> Array:
    """An approximation of the root of G(y) = m, off by 0.5 % at the worst.

    y = m (1+q + q^2 w (1 - (1-phi)^s)/s) is exact with w = 1 as phi -> 1, and with w = (1+q)/((1+s) (2+q)) to second
    order as phi -> 0; `tools/ring_starter.py` fits w in between.
    """
    few = 2
    lost = -exponentials(s * log_complement(phi, few), few)[1]
    v = 1.0 - abs(sqrt(1.0 - phi))
    a, b, c, d, e, f, g, h = _WAY
    way = v * ((a + b * s) + lost * (c + d * s) + v * ((e + f * s) + lost * (g + h * s)))
    narrow = (1.0 + q) * reciprocal((1.0 + s) * (2.0 + q))
    share = 1.0 + q + q * q * lost * reciprocal(s) * (narrow + (1.0 - narrow) * way)
    return phi * share / ((1.0 - phi) * (1.0 + s))


_WAY = (0.4291, 0.5202, -1.0660, 2.5157, 0.7306, -2.2103, 0.9381, -0.9564)
_EDGE = _Root(arc, lambda s, q, phi: _slip(s, phi), _ring_starter, (2, 8))


def _ring(s: Array, q: Array, phi: Array, digits: int | None, wanted: int | None = None) -> Array:
    """y_inf for phi > 0: the outer edge of the worn ring, y = (a_inf/c)^2 - 1, to the digits wanted of it or to all."""
    return _place(_EDGE, s, q, phi, digits, wanted)


def _worn(phi: Array) -> tuple[Array, Array]:
    """(There is a ring, phi with something harmless where there is none)."""
    worn = phi > 0.0
    return worn, jnp.where(worn, phi, 0.5)


@formula({}, {}, ("k",), k=EXPONENT, phi=AMPLITUDE)
def worn_radius(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Outer radius a_inf of the worn ring, where the worn profile meets the initial one, Eq. (26).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
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
    # Rounding must not give a radius below 1; the derivatives are not changed.
    return radius + jax.lax.stop_gradient(jnp.maximum(1.0 - radius, 0.0))


# --- the wear volume ----------------------------------------------------------------------------------------------


@lean
def _wear_volume(y: Array, s: Array, q: Array, phi: Array, digits: int | None, *, second: bool) -> Array:
    """Eq. (28) in closed form: (pi/2) c^4 times the integral from 0 to y_inf of (Q/s) (m - G) dy.

    The integrand vanishes at y_inf. So an error e of y gives an error of order e^2 in the volume, or e^3 with the
    `second` order correction, and of order e or e^2 in its derivatives at fixed y.
    """
    at = arc(y, s, q, digits)
    lack, rest = _lack(y, _slip(s, phi), at), at.area
    if second:
        rest = rest + 0.5 * at.share * y * lack * reciprocal(at.slope)
    return 0.5 * jnp.pi * _stick_power(s, phi, 4.0, digits) * (at.below + y * lack * rest)


def _wear_volume_and_by_k(k: Array, phi: Array, *, digits: int | None) -> tuple[Array, Array]:
    """V and dV/dk, at a fixed edge of the ring, in which the volume is stationary."""
    worn, phi = _worn(phi)
    y = _ring(*exponents(k), phi, digits, _half(_EDGE, digits, k.dtype))
    k, phi, y = apart(1, k, phi, y)

    def volume(k: Array) -> Array:
        return _wear_volume(y, *exponents(k), phi, digits, second=True)

    value, slope = jax.jvp(volume, (k,), (jnp.ones_like(k),))
    value, slope = together(value, slope, k)
    return jnp.where(worn, value, 0.0), jnp.where(worn, slope, 0.0)


def _wear_volume_by_k(k: Array, phi: Array, *, digits: int | None) -> Array:
    """dV/dk, at a fixed edge of the ring, in which the volume is stationary."""
    worn, phi = _worn(phi)
    y = _ring(*exponents(k), phi, digits, _half(_EDGE, digits, k.dtype))
    k, phi, y = apart(1, k, phi, y)

    def volume(k: Array) -> Array:
        return _wear_volume(y, *exponents(k), phi, digits, second=True)

    return jnp.where(worn, jax.jvp(volume, (k,), (jnp.ones_like(k),))[1], 0.0)


def _wear_volume_by_phi(k: Array, phi: Array, *, digits: int | None) -> Array:
    """dV/dphi = d(d_inf)/dphi pi c^2 times the integral from 0 to y_inf of (Q + sigma y^-s/s) dy."""
    worn, phi = _worn(phi)
    y = _ring(*exponents(k), phi, digits, _half(_EDGE, digits, k.dtype))
    k, phi, y = apart(2, k, phi, y)
    s, q = exponents(k)
    at = arc(y, s, q, digits)
    missing = _lack(y, _slip(s, phi), at) * reciprocal(at.slope)  # from y to the ring's edge, over y
    integral = s * at.area + at.density + missing * (s * at.share * y + q * at.density)
    slope = jnp.pi * _stick_power(s, phi, 2.0, digits) * _sinking(s, phi, digits) * integral
    return jnp.where(worn, slope, 0.0)


@formula(
    {"k": _wear_volume_by_k, "phi": _wear_volume_by_phi},
    {"k": _wear_volume_and_by_k},
    k=EXPONENT,
    phi=AMPLITUDE,
)
def wear_volume(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Volume worn off the indenter on the way to the steady state, Eq. (28) in closed form.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
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
    # For few digits the second-order correction is cheaper than a Halley step: from the starter, off by 5e-3, it gets
    # a volume off by 2e-8.
    few = working_digits(digits, k.dtype) <= 8
    y = _ring(*exponents(k), phi, digits, _EDGE.digits[0] if few else _half(_EDGE, digits, k.dtype))
    k, phi, y = apart(0, k, phi, y)
    return jnp.where(worn, _wear_volume(y, *exponents(k), phi, digits, second=few), 0.0)


# --- the deepest wear -----------------------------------------------------------------------------------------------


# The depth (c^2/2) (Q/s) (m - G) has the slope (c^2/2) (Q'/s) (m - H) with H(y) = y (1 + s (1+y) S_0(y)). H rises with
# y, since y^q S_0 and y^s (1+y) do. So the deepest place is the only root of H = m. The code uses q H, finite at q = 0.


@lean
def _deepening(y: Array, at: Arc, s: Array, q: Array) -> _Rise:
    """q H, from the arc at y."""
    level = quotient(at.share, at.density)  # q S_0, which falls from 1
    far, whole = (1.0 + s) * y, 1.0 + y
    chord = q + s * whole * level
    slope = q * (1.0 + s) + s * level * (s + far)
    return _Rise(chord, slope, s * (s * level * (far - q) + q * (s + far) * reciprocal(whole)))


@lean
def _deepest_load(s: Array, q: Array, phi: Array) -> Array:
    # The maximum avoids underflow. It acts only where the depth underflows, or where it is the same for any y.
    return maximum(q * _slip(s, phi), 16.0 * float(jnp.finfo(phi.dtype).tiny))


@lean
def _deepest_starter(s: Array, q: Array, phi: Array) -> Array:
    """An approximation of the root of q H(y) = q m, off by 0.03 % at the worst.

    (1+q)/2 ((1 + 2 (1+s)/(1+q) q m)^(1/(1+s)) - 1) is exact as s -> 0, as q -> 0, and to second order as phi -> 0.
    Towards phi = 1 it is too large by up to 1.5 %; a factor fitted by `tools/deepest_starter.py` corrects this.
    """
    few = 3
    scale = 0.5 * (1.0 + q)
    load = _deepest_load(s, q, phi) * (1.0 + s) * reciprocal(scale)
    y = scale * exponentials(log_complement(-load, few) * reciprocal(1.0 + s), few)[1]
    a, b, c, d = _LATE
    way = y / (y + c + d * s)
    return y / (1.0 + s * s * q * (a + b * s) * way * way)


_LATE = (0.1228, -0.0323, 2.6795, -1.9895)
_DEEPEST = _Root(
    lambda y, s, q, digits: _deepening(y, arc(y, s, q, digits), s, q), _deepest_load, _deepest_starter, (3, 10)
)


@lean
def _deepest_wear(y: Array, s: Array, q: Array, phi: Array, digits: int | None, *, second: bool) -> Array:
    """The depth at y, near the deepest place, where its slope is 0: an error e of y gives one of order e^2 or e^3."""
    at = arc(y, s, q, digits)
    depth = y * at.share * _lack(y, _slip(s, phi), at)
    if second:
        rise = _deepening(y, at, s, q)
        lack = _lack(y, _deepest_load(s, q, phi), rise)
        depth = depth + 0.5 * y * at.density * lack * lack * reciprocal((1.0 + y) * rise.slope)
    return 0.5 * _stick_power(s, phi, 2.0, digits) * depth


def _deepest_wear_by_k(k: Array, phi: Array, *, digits: int | None) -> Array:
    """The derivative at a fixed place, in which the depth is stationary."""
    worn, phi = _worn(phi)
    y = _place(_DEEPEST, *exponents(k), phi, digits, _half(_DEEPEST, digits, k.dtype))
    k, phi, y = apart(1, k, phi, y)

    def depth(k: Array) -> Array:
        return _deepest_wear(y, *exponents(k), phi, digits, second=True)

    return jnp.where(worn, jax.jvp(depth, (k,), (jnp.ones_like(k),))[1], 0.0)


@functools.partial(jax.custom_jvp, nondiff_argnums=(3,))
def _share(y: Array, s: Array, q: Array, digits: int | None) -> Array:
    """Q/s with its slope in y in closed form: as q -> 0 the slope is small, but is multiplied by a large dy/dk."""
    return arc(y, s, q, digits).share


@_share.defjvp
def _share_jvp(digits: int | None, primals, tangents):
    y, s, q = primals
    at, by_shape = jax.jvp(lambda s, q: arc(y, s, q, digits), (s, q), tangents[1:])
    return at.share, by_shape.share + q * at.density * reciprocal(1.0 + y) * (tangents[0] * reciprocal(y))


def _deepest_wear_by_phi(k: Array, phi: Array, *, digits: int | None) -> Array:
    """d(d_inf)/dphi (Q + sigma y^-s/s) at the deepest place, where q m/y is q H/y."""
    worn, phi = _worn(phi)
    y = _place(_DEEPEST, *exponents(k), phi, digits, _half(_DEEPEST, digits, k.dtype))
    k, phi, y = apart(2, k, phi, y)
    s, q = exponents(k)
    at = arc(y, s, q, digits)
    rise = _deepening(y, at, s, q)
    # This is zero for every k, since y follows: its derivatives are rounding errors, and are left out.
    lack = jax.lax.stop_gradient(_lack(y, _deepest_load(s, q, phi), rise))
    missing = lack * reciprocal(rise.slope)  # from y to the place, over y
    flat = at.density * (rise.chord + lack) * (1.0 - s * missing * reciprocal(1.0 + y))
    rate = (s * _slip(s, phi) * _share(y, s, q, digits) + flat) * reciprocal((1.0 + s) * (1.0 - phi))
    return jnp.where(worn, 0.5 * _stick_power(s, phi, 2.0, digits) * rate, 0.0)


@formula({"k": _deepest_wear_by_k, "phi": _deepest_wear_by_phi}, k=EXPONENT, phi=AMPLITUDE)
def deepest_wear(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Largest depth worn off the indenter, the maximum over r of f_inf - f_0, from Eqs. (24) and (25).

    It grows with phi at every k.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The depth in units of a_0^2/R, broadcast over k and phi; 0 at phi = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    k, (worn, phi) = jnp.asarray(k), _worn(jnp.asarray(phi))
    # For few digits the second-order correction is cheaper than a Halley step: from the starter, off by 3e-4, it gets
    # a depth off by 1e-11.
    few = working_digits(digits, k.dtype) <= 11
    y = _place(_DEEPEST, *exponents(k), phi, digits, _DEEPEST.digits[0] if few else _half(_DEEPEST, digits, k.dtype))
    k, phi, y = apart(0, k, phi, y)
    return jnp.where(worn, _deepest_wear(y, *exponents(k), phi, digits, second=few), 0.0)


# --- displacements and profiles -------------------------------------------------------------------------------------


def _punch_displacement(r: Array, c: Array, m: Array, s: Array, q: Array, digits: int | None) -> Array:
    """Surface displacement of a punch of radius c with a parabolic tip, deeper by m than its own parabola.

    Eqs. (14), (18), (24): d - r^2/2 under the punch, d = c^2 (1+m)/(2s), and beside it
    c^2 ((d/c^2 - 1/2) (1 - Q) + sigma y^-s T_1(1/y)/2).
    """
    under = r <= c
    body, moment = arcsine_body_moment(fold_beside(r, c), s, q, digits)
    beside = 0.5 * ((q + m) / s * body + moment)
    # Instead of 1/s - (r/c)^2, nearly equal as k -> 1 and r -> c, the sum q/s + (1 - (r/c)^2).
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
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
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
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
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
    """Where a radius lies in the worn ring."""

    worn: Array  # it lies inside the ring
    c: Array
    at: Arc
    y: Array  # harmless outside the ring
    lift: Array  # m - G(y), positive in the ring


def _in_ring(r: Array, k: Array, phi: Array, digits: int | None) -> _Ring:
    s, q = exponents(k)
    c, m = _stick_radius(k, phi), _slip(s, phi)
    # No ring reaches further than y = m/s. Radii beyond twice that only have to give finite numbers.
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
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The depth in units of a_0^2/R, broadcast over all arguments: positive for c < r < a_inf and 0 elsewhere.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    return _worn_depth(jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), digits)


@formula({"phi": _worn_depth_by_phi}, r=RADIUS, k=EXPONENT, phi=AMPLITUDE)
def profile(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Shape f_inf of the worn indenter, Eq. (25): f_0 = r^2/2 outside the worn ring, d_inf - w_inf in it.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
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
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
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
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
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
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The factor of p_inf(c (1 - delta)) in units of F_N/(pi a_0^2), and of tau_inf in mu F_N/(pi a_0^2).

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    s, _ = exponents(jnp.asarray(k))
    phi = jnp.asarray(phi)
    return s * phi / _stick_power(s, phi, 2.0, digits)


class _Inside(NamedTuple):
    """The worn contact at a distance inside the stick edge, or at the centre if the distance is larger than c."""

    z: Array  # 1 - (r/c)^2
    radius: Array  # r/c
    over_c: Array  # 1/c
    singular: Array  # z^-q


def _inside_edge(distance: Array, s: Array, q: Array, phi: Array, digits: int | None) -> _Inside:
    c = _stick_power(s, phi, 1.0, digits)
    inner = (distance > 0.0) & (distance < c)  # callers treat distance = 0
    depth = jnp.where(inner, quotient(jnp.where(inner, distance, c), c), 1.0)
    z = depth * (2.0 - depth)
    return _Inside(z, 1.0 - depth, reciprocal(c), exponentials(-q * log(z, digits), digits)[0])


def _edge_pressure_by_distance(distance: Array, k: Array, phi: Array, *, digits: int | None) -> Array:
    """2 s (r/c) z^-q ((1+s) (1-phi) - q phi/z)/c^3."""
    s, q = exponents(k)
    z, radius, over_c, singular = _inside_edge(distance, s, q, phi, digits)
    slope = 2.0 * s * radius * singular * ((1.0 + s) * (1.0 - phi) - q * quotient(phi, z))
    return jnp.where(distance > 0.0, slope * over_c * over_c * over_c, 0.0)


def _edge_pressure_by_phi(distance: Array, k: Array, phi: Array, *, digits: int | None) -> Array:
    """s z^-q (r/c + m (s + q/(1 + r/c)))/c^2: nowhere negative."""
    s, q = exponents(k)
    _, radius, over_c, singular = _inside_edge(distance, s, q, phi, digits)
    rate = s * singular * (radius + _slip(s, phi) * (s + q * reciprocal(1.0 + radius)))
    return jnp.where(distance > 0.0, rate * over_c * over_c, 0.0)


@formula(
    {"distance": _edge_pressure_by_distance, "phi": _edge_pressure_by_phi},
    distance=DISTANCE,
    k=EXPONENT,
    phi=AMPLITUDE,
)
def edge_pressure(distance: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Pressure in the worn state at a distance inside the stick edge: Eq. (17) at r = c - distance.

    Singularities of different order, Eq. (20), are compared at the same distance, a critical one of the material. The
    pressure there grows with phi at every distance and k.

    Args:
        distance: c - r in units of a_0, distance >= 0; for distance >= c the pressure at the centre is returned.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        p_inf in units of F_N/(pi a_0^2), broadcast over all arguments; infinite at distance = 0 for phi > 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Example:
        >>> from plgwear_jax import fretting
        >>> for k in (-0.5, 0.5):  # lower on a compliant surface, at the same contact radius
        ...     print(f"{fretting.edge_pressure(0.001, k, 0.3):.2f}")
        9.74
        1.29
    """
    distance, k, phi = jnp.asarray(distance), jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    z, _, over_c, singular = _inside_edge(distance, s, q, phi, digits)
    pressure = singular * ((1.0 + s) * (1.0 - phi) * z + s * phi) * over_c * over_c
    return jnp.where(distance > 0.0, pressure, jnp.where(phi > 0.0, jnp.inf, 0.0))
