"""Pressures and tractions, Eqs. (13), (17), (19) and (20)."""

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, NOT_NEGATIVE, ArrayLike
from plgwear_jax._core.formula import formula
from plgwear_jax.special.elementary import (
    exponentials,
    exponents,
    log,
    log_beside_edge,
    punch_stress,
    quotient,
    reciprocal,
)

from .stick import slip, stick, stick_power

# --- stresses -------------------------------------------------------------------------------------------------------


def _initial_pressure_by_r(r: Array, k: Array, digits: int | None) -> Array:
    """dp_0/dr = -2 r s (1+s) (1 - r^2)^-q for r < 1, whose own slopes do not cancel towards k = 1."""
    s, q = exponents(k)
    under = r < 1.0
    rate = -2.0 * r * s * (1.0 + s) * jnp.exp(-q * log_beside_edge(jnp.where(under, r, 0.0), jnp.ones_like(s)))
    return jnp.where(under, rate, 0.0)


@formula(slopes={"r": _initial_pressure_by_r}, r=NOT_NEGATIVE, k=EXPONENT)
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

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.initial_pressure(0.0, 0.0):.6f}")  # Hertz: 3/2 of the mean pressure
        1.500000

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (13).
    """
    s, q = exponents(k)
    return punch_stress(r, jnp.ones_like(s), s, q, smooth=1.0 + s, singular=jnp.zeros_like(s))


def _steady_pressure_by_phi(r: Array, k: Array, phi: Array, digits: int | None) -> Array:
    """dp_inf/dphi = s phi (q + s z) z^(-q-1)/(c^2 (1+s) (1-phi)) for r < c, z = 1 - (r/c)^2."""
    s, q = exponents(k)
    c = stick(k, phi)
    under = r < c
    log_z = log_beside_edge(jnp.where(under, r, 0.0), c)
    rate = s * slip(s, phi) * (q * jnp.exp(-(1.0 + q) * log_z) + s * jnp.exp(-q * log_z)) / (c * c)
    return jnp.where(under, rate, 0.0)


@formula(slopes={"phi": _steady_pressure_by_phi}, r=NOT_NEGATIVE, k=EXPONENT, phi=AMPLITUDE)
def steady_pressure(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Pressure in the worn state, Eq. (17) with b = c: singular at the stick-slip boundary, zero outside it.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        p_inf in units of F_N/(pi a_0^2), broadcast over all arguments; infinite at r = c for phi > 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.steady_pressure(0.5, 0.3, 0.4):.6f}")
        1.439137

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (17).
    """
    k, phi = jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    # F_1(c)/F_N = c^(k+3) = 1 - phi, Eq. (12).
    return punch_stress(r, stick(k, phi), s, q, smooth=(1.0 + s) * (1.0 - phi), singular=s * phi)


@formula(r=NOT_NEGATIVE, k=EXPONENT, phi=AMPLITUDE)
def steady_traction(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Tangential traction in the worn state, Eq. (19) with b = c: singular at the stick-slip boundary, zero outside it.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        tau_inf in units of mu F_N/(pi a_0^2), broadcast over all arguments; infinite at r = c for phi > 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.steady_traction(0.5, 0.3, 0.4):.6f}")
        0.409970

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (19).
    """
    k, phi = jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    return punch_stress(r, stick(k, phi), s, q, smooth=jnp.zeros_like(phi), singular=s * phi)


@formula(k=EXPONENT, phi=AMPLITUDE)
def edge_intensity(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Factor of the singularity at the stick-slip boundary: that of (2 delta)^((k-1)/2) in Eqs. (20), (21).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The factor of p_inf(c (1 - delta)) in units of F_N/(pi a_0^2), and of tau_inf in mu F_N/(pi a_0^2).

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.edge_intensity(0.3, 0.4):.6f}")
        0.354346

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (20), (21).
    """
    s, _ = exponents(k)
    phi = jnp.asarray(phi)
    return s * phi / stick_power(s, phi, 2.0, digits)


def _inside_edge(distance: Array, s: Array, q: Array, phi: Array, digits: int | None) -> tuple[Array, ...]:
    """(1 - (r/c)^2, r/c, 1/c, z^-q) at a distance inside the stick-slip boundary, or at the centre if it is beyond."""
    c = stick_power(s, phi, 1.0, digits)
    inner = (distance > 0.0) & (distance < c)  # callers handle distance = 0
    depth = jnp.where(inner, quotient(jnp.where(inner, distance, c), c), 1.0)
    z = depth * (2.0 - depth)
    return z, 1.0 - depth, reciprocal(c), exponentials(-q * log(z, digits), digits)[0]


def _edge_pressure_by_distance(distance: Array, k: Array, phi: Array, digits: int | None) -> Array:
    """dp_inf/d(distance) = 2 s (r/c) z^-q ((1+s) (1-phi) - q phi/z)/c^3."""
    s, q = exponents(k)
    z, radius, over_c, singular = _inside_edge(distance, s, q, phi, digits)
    slope = 2.0 * s * radius * singular * ((1.0 + s) * (1.0 - phi) - q * quotient(phi, z))
    return jnp.where(distance > 0.0, slope * over_c * over_c * over_c, 0.0)


def _edge_pressure_by_phi(distance: Array, k: Array, phi: Array, digits: int | None) -> Array:
    """dp_inf/dphi = s z^-q (r/c + m (s + q/(1 + r/c)))/c^2, nowhere negative."""
    s, q = exponents(k)
    _, radius, over_c, singular = _inside_edge(distance, s, q, phi, digits)
    rate = s * singular * (radius + slip(s, phi) * (s + q * reciprocal(1.0 + radius)))
    return jnp.where(distance > 0.0, rate * over_c * over_c, 0.0)


@formula(
    slopes={"distance": _edge_pressure_by_distance, "phi": _edge_pressure_by_phi},
    distance=NOT_NEGATIVE,
    k=EXPONENT,
    phi=AMPLITUDE,
)
def edge_pressure(distance: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Pressure in the worn state at a distance inside the stick-slip boundary: Eq. (17) at r = c - distance.

    Singularities of different order, Eq. (20), are compared at the same distance, a critical distance of the material.
    The pressure there grows with phi at every distance and k.

    Args:
        distance: c - r in units of a_0, distance >= 0; for distance >= c the pressure at the centre is returned.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        p_inf in units of F_N/(pi a_0^2), broadcast over all arguments; infinite at distance = 0 for phi > 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> for k in (-0.5, 0.5):  # lower on a compliant surface, at the same contact radius
        ...     print(f"{fretting.edge_pressure(0.001, k, 0.3):.2f}")
        9.74
        1.29

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (17).
    """
    distance, k, phi = jnp.asarray(distance), jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    z, _, over_c, singular = _inside_edge(distance, s, q, phi, digits)
    pressure = singular * ((1.0 + s) * (1.0 - phi) * z + s * phi) * over_c * over_c
    return jnp.where(distance > 0.0, pressure, jnp.where(phi > 0.0, jnp.inf, 0.0))
