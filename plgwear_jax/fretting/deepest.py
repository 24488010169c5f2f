"""The largest wear depth, and the place where it lies."""

import functools

import jax
import jax.numpy as jnp
from jax import Array, lax

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, ArrayLike
from plgwear_jax._core.formula import formula
from plgwear_jax.special.arcsine import Arc, arc
from plgwear_jax.special.elementary import exponentials, exponents, log_complement, quotient, reciprocal

from .ring import Rise, Root, place_in_ring, relative_residual, stationary, stationary_and_by_k
from .stick import slip, stick_power

# The depth (c^2/2) (Q/s) (m - G) has the slope (c^2/2) (Q'/s) (m - H) with H(y) = y (1 + s (1+y) S_0(y)). H rises with
# y, since y^q S_0 and y^s (1+y) rise. So the deepest place is the only root of H = m. The code uses q H, finite for
# q = 0.


def _deepening(y: Array, at: Arc, s: Array, q: Array) -> Rise:
    """q H, from the arc at y."""
    level = quotient(at.share, at.density)  # q S_0, which falls from 1
    far, whole = (1.0 + s) * y, 1.0 + y
    chord = q + s * whole * level
    slope = q * (1.0 + s) + s * level * (s + far)
    return Rise(chord, slope, s * (s * level * (far - q) + q * (s + far) * reciprocal(whole)))


def _deepest_load(s: Array, q: Array, phi: Array) -> Array:
    # The maximum avoids underflow. It acts only where the depth underflows, or does not depend on y.
    return jnp.maximum(q * slip(s, phi), 16.0 * jnp.finfo(phi.dtype).tiny)


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
_DEEPEST = Root(
    lambda y, s, q, digits: _deepening(y, arc(y, s, q, digits), s, q), _deepest_load, _deepest_starter, (3, 10)
)


def _depth_near_deepest(y: Array, s: Array, q: Array, phi: Array, digits: int | None, *, second: bool) -> Array:
    """The depth at y, near the deepest place. An error e of y gives a depth error of order e^2, e^3 with `second`."""
    at = arc(y, s, q, digits)
    # At the smallest amplitudes, where the maximum in `_deepest_load` acts, the difference is negative: depth 0.
    depth = y * at.share * jnp.maximum(relative_residual(y, slip(s, phi), at), 0.0)
    if second:
        rise = _deepening(y, at, s, q)
        residual = relative_residual(y, _deepest_load(s, q, phi), rise)
        depth = depth + 0.5 * y * at.density * residual * residual * reciprocal((1.0 + y) * rise.slope)
    return 0.5 * stick_power(s, phi, 2.0, digits) * depth


@functools.partial(jax.custom_jvp, nondiff_argnums=(3,))
def _tail_over_s(y: Array, s: Array, q: Array, digits: int | None) -> Array:
    """Q/s with its slope in y in closed form, since the slope, small as q -> 0, is multiplied by a large dy/dk."""
    return arc(y, s, q, digits).share


@_tail_over_s.defjvp
def _share_jvp(digits: int | None, primals, tangents):
    y, s, q = primals
    at, by_shape = jax.jvp(lambda s, q: arc(y, s, q, digits), (s, q), tangents[1:])
    return at.share, by_shape.share + q * at.density * reciprocal(1.0 + y) * (tangents[0] * reciprocal(y))


def _deepest_wear_by_phi(k: Array, phi: Array, digits: int | None) -> Array:
    """d(depth)/dphi = d(d_inf)/dphi (Q + sigma y^-s/s) at the deepest place, with q H/y for q m/y."""
    worn, k, phi, y = place_in_ring(_DEEPEST, k, phi, digits, copy=2)
    s, q = exponents(k)
    at = arc(y, s, q, digits)
    rise = _deepening(y, at, s, q)
    # At the root it is zero for every k: its derivatives would be rounding errors only.
    residual = lax.stop_gradient(relative_residual(y, _deepest_load(s, q, phi), rise))
    correction = residual * reciprocal(rise.slope)  # (root - y)/y
    flat = at.density * (rise.chord + residual) * (1.0 - s * correction * reciprocal(1.0 + y))
    rate = (s * slip(s, phi) * _tail_over_s(y, s, q, digits) + flat) * reciprocal((1.0 + s) * (1.0 - phi))
    return jnp.where(worn, 0.5 * stick_power(s, phi, 2.0, digits) * rate, 0.0)


@formula(
    slopes={
        "k": lambda *at, digits: stationary_and_by_k(_DEEPEST, _depth_near_deepest, *at, digits=digits)[1],
        "phi": _deepest_wear_by_phi,
    },
    k=EXPONENT,
    phi=AMPLITUDE,
)
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

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.deepest_wear(0.3, 0.4):.6f}")
        0.066861

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: the maximum of Eq. (25) less Eq. (24).
    """
    # The starter has an error of 3e-4, which leaves one of 1e-11 in the depth.
    return stationary(_DEEPEST, _depth_near_deepest, k, phi, digits, few=11)
