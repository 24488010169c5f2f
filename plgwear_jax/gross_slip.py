"""Gross slip of a flat-ended cylindrical punch at fixed depth: section 2 of the paper, without units.

A rigid punch of radius a is pressed to the depth d and slides until wear has made its pressure uniform. The punch
wears, the half-space does not. Radii are in units of a, displacements in d, pressures in the mean initial pressure
F_N0/(pi a^2). s = (1+k)/2 and q = (1-k)/2.
"""

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import EXPONENT, NOT_NEGATIVE, ArrayLike
from plgwear_jax._core.formula import formula
from plgwear_jax.special.arcsine import arcsine_tail, fold_outside
from plgwear_jax.special.disc import disc_displacement
from plgwear_jax.special.elementary import exponents, punch_stress, sine_excess, sine_quotient
from plgwear_jax.special.gamma import catalan_deficit

__all__ = [
    "force_drop",
    "force_ratio",
    "initial_displacement",
    "initial_pressure",
    "steady_displacement",
    "steady_pressure",
    "volume_change",
]


@formula(r=NOT_NEGATIVE, k=EXPONENT)
def initial_pressure(r: ArrayLike, k: ArrayLike, *, digits: int | None = None) -> Array:
    """Pressure under the flat punch, p_0 = (1+k)/2 (1 - r^2)^((k-1)/2), Eq. (2) over Eq. (8); zero for r > 1.

    Args:
        r: Radius in units of a, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        p_0 in units of F_N0/(pi a^2), broadcast over r and k; infinite at r = 1.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import gross_slip
        >>> print(f"{gross_slip.initial_pressure(0.0, 0.0):.6f}")
        0.500000

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (2), with the factor a that is missing
        there.
    """
    s, q = exponents(k)
    return punch_stress(r, jnp.ones_like(s), s, q, smooth=jnp.zeros_like(s), singular=s)


@formula(r=NOT_NEGATIVE, k=EXPONENT)
def steady_pressure(r: ArrayLike, k: ArrayLike, *, digits: int | None = None) -> Array:
    """Uniform pressure under the worn punch, F_Ninf/F_N0 of Eq. (10) for r <= 1; zero outside.

    Args:
        r: Radius in units of a, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        p_inf in units of F_N0/(pi a^2), broadcast over r and k.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import gross_slip
        >>> print(f"{gross_slip.steady_pressure(0.5, 0.0):.6f}")  # pi/4
        0.785398

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (9), (10).
    """
    return jnp.where(jnp.asarray(r) <= 1.0, 1.0 / sine_quotient(*exponents(k), digits), 0.0)


@formula(r=NOT_NEGATIVE, k=EXPONENT)
def initial_displacement(r: ArrayLike, k: ArrayLike, *, digits: int | None = None) -> Array:
    """Displacement of the surface under and outside the flat punch, Eq. (3): 1, and 1 - Q(r^2 - 1; s) for r > 1.

    Args:
        r: Radius in units of a, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        w_0 in units of d, broadcast over r and k. At r = 1 the derivative is the one-sided one from inside, 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import gross_slip
        >>> print(f"{gross_slip.initial_displacement(2.0, 0.0):.6f}")  # 1/3
        0.333333

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (3), (4).
    """
    r = jnp.asarray(r)
    s, q = exponents(k)
    _, body, _ = arcsine_tail(fold_outside(r, jnp.ones_like(s)), s, q, digits)
    return jnp.where(r <= 1.0, 1.0, body)


@formula(r=NOT_NEGATIVE, k=EXPONENT)
def steady_displacement(r: ArrayLike, k: ArrayLike, *, digits: int | None = None) -> Array:
    """Displacement of the surface under and outside the worn punch, which is the shape of the worn punch, Eq. (5).

    Args:
        r: Radius in units of a, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        w_inf in units of d, broadcast over r and k; 1 at r = 0. At r = 1 the slope is infinite for k >= 0; the
        derivative in r returned there is the finite one at the neighbouring floating-point number.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import gross_slip
        >>> print(f"{gross_slip.steady_displacement(1.0, 0.0):.6f}")  # 2/pi
        0.636620

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (5).
    """
    s, q = exponents(k)
    return disc_displacement(jnp.asarray(r), s, q, digits)


@formula(k=EXPONENT)
def volume_change(k: ArrayLike, *, digits: int | None = None) -> Array:
    """Effective volume worn off the punch, Delta V/(pi a^2 d), Eq. (7); at most 15.5 %, at k = 0.169.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The volume in units of pi a^2 d, in the shape of k; accurate to all digits also towards its zeros at k = -1, 1.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import gross_slip
        >>> print(f"{gross_slip.volume_change(0.169):.3f}")
        0.155

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (7).
    """
    s, q = exponents(k)
    return catalan_deficit(q, s, digits)


@formula(k=EXPONENT)
def force_ratio(k: ArrayLike, *, digits: int | None = None) -> Array:
    """Steady over initial normal force at fixed depth, F_Ninf/F_N0 = pi (1-k^2)/(4 cos(k pi/2)), Eq. (10).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The ratio in the shape of k: pi/4 at k = 0, and 1 in the limits k -> -1 and k -> 1.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import gross_slip
        >>> print(f"{gross_slip.force_ratio(0.0):.6f}")  # pi/4
        0.785398

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (10).
    """
    return 1.0 / sine_quotient(*exponents(k), digits)


@formula(k=EXPONENT)
def force_drop(k: ArrayLike, *, digits: int | None = None) -> Array:
    """Share of the normal force that is lost by wear at fixed depth, 1 - F_Ninf/F_N0 of Eq. (10).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The share in the shape of k: 1 - pi/4 at k = 0, its largest value; accurate to all digits also towards its zeros
        at k = -1, 1.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import gross_slip
        >>> print(f"{gross_slip.force_drop(0.0):.6f}")
        0.214602

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: one minus Eq. (10).
    """
    s, q = exponents(k)
    excess = s * q * sine_excess(s, q, digits)
    return excess / (1.0 + excess)
