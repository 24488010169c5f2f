"""The stick radius, Eqs. (16) and (23), and the depth of the punch that is equivalent to the worn indenter."""

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, ArrayLike
from plgwear_jax._core.formula import formula
from plgwear_jax.special.elementary import exponentials, log_complement, moves_by, quotient, reciprocal


def slip(s: Array, phi: Array) -> Array:
    """m = phi/((1-phi)(1+s)) = s Lambda, finite as s -> 0."""
    return quotient(phi, (1.0 - phi) * (1.0 + s))


# All closed forms of derivatives by phi contain d(d_inf)/dphi = c^2 m/(2 (1+s)(1-phi)), and none subtracts nearly equal
# numbers: docs/explanation/theory.md, section "Derivatives with respect to the amplitude".


def sinking(s: Array, phi: Array, digits: int | None) -> Array:
    """d(d_inf)/dphi, the change of the indentation depth with the amplitude."""
    return 0.5 * stick_power(s, phi, 2.0, digits) * slip(s, phi) * reciprocal((1.0 + s) * (1.0 - phi))


@moves_by(lambda c, k, phi, dk, dphi: -c / (3.0 + k) * (dphi / (1.0 - phi) + log_complement(phi) / (3.0 + k) * dk))
def stick(k: Array, phi: Array) -> Array:
    """c = (1-phi)^(1/(k+3)), to an ulp or two."""
    # Near the stick-slip boundary results depend on r - c, so c is needed to an ulp or two, however small. Hence the
    # logarithm and the quotient are computed together with their rounding errors.
    complement = 1.0 - phi
    log_hi = log_complement(phi)
    # For phi >= 1/2, 1 - phi is exact, and log_lo is the rounding error of its logarithm; below it is negligible.
    log_lo = jnp.where(phi >= 0.5, complement * jnp.exp(-log_hi) - 1.0, 0.0)
    grid = 2.0 ** (jnp.finfo(k.dtype).nmant // 2 - 4)  # rounded to this grid, head * divisor is exact
    k_hi = jnp.round(k * grid) / grid
    divisor = 3.0 + k_hi
    quotient = log_hi / (3.0 + k)
    head = jnp.round(quotient * grid) / grid
    remainder = (log_hi - head * divisor) - (quotient - head) * divisor - quotient * (k - k_hi)
    correction = (remainder + log_lo) / (3.0 + k)
    radius = jnp.exp(quotient)
    return radius + radius * correction


def stick_power(s: Array, phi: Array, exponent: float, digits: int | None) -> Array:
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

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.stick_radius(0.0, 0.488):.6f}")  # (1 - 0.488)^(1/3)
        0.800000

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (16), (23). For k = 0: Cattaneo (1938);
        Mindlin, Journal of Applied Mechanics 16 (1949) 259.
    """
    return stick(jnp.asarray(k), jnp.asarray(phi))
