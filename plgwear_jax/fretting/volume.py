"""The wear volume, Eq. (28)."""

import functools

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, ArrayLike
from plgwear_jax._core.formula import formula
from plgwear_jax.special.arcsine import arc
from plgwear_jax.special.elementary import exponents, reciprocal

from .ring import EDGE, place_in_ring, relative_residual, stationary, stationary_and_by_k
from .stick import sinking, slip, stick_power


def _wear_volume(y: Array, s: Array, q: Array, phi: Array, digits: int | None, *, second: bool) -> Array:
    """Eq. (28) in closed form: (pi/2) c^4 times the integral from 0 to y_inf of (Q/s) (m - G) dy.

    The integrand vanishes at y_inf. So an error e of y gives an error of order e^2 in the volume, or e^3 with the
    `second` order correction, and an error of order e or e^2 in its derivatives at constant y.
    """
    at = arc(y, s, q, digits)
    residual, area = relative_residual(y, slip(s, phi), at), at.area
    if second:
        area = area + 0.5 * at.share * y * residual * reciprocal(at.slope)
    return 0.5 * jnp.pi * stick_power(s, phi, 4.0, digits) * (at.below + y * residual * area)


def _wear_volume_by_phi(k: Array, phi: Array, digits: int | None) -> Array:
    """dV/dphi = d(d_inf)/dphi pi c^2 times the integral from 0 to y_inf of (Q + sigma y^-s/s) dy."""
    worn, k, phi, y = place_in_ring(EDGE, k, phi, digits, copy=2)
    s, q = exponents(k)
    at = arc(y, s, q, digits)
    correction = relative_residual(y, slip(s, phi), at) * reciprocal(at.slope)  # (y_inf - y)/y
    integral = s * at.area + at.density + correction * (s * at.share * y + q * at.density)
    slope = jnp.pi * stick_power(s, phi, 2.0, digits) * sinking(s, phi, digits) * integral
    return jnp.where(worn, slope, 0.0)


@formula(
    slopes={"phi": _wear_volume_by_phi},
    pairs={"k": functools.partial(stationary_and_by_k, EDGE, _wear_volume)},
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

    Examples:
        >>> import jax
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.wear_volume(0.0, 0.5):.4f}")
        0.1322
        >>> slope = jax.grad(fretting.wear_volume)(0.0, 0.5)  # d/dk: a positive k wears less at this amplitude
        >>> print(slope < 0)
        True

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (28); its closed form:
        `docs/explanation/theory.md`, "One special function".
    """
    # The starter has an error of 5e-3, which leaves one of 2e-8 in the volume.
    return stationary(EDGE, _wear_volume, k, phi, digits, few=8)
