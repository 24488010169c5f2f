"""Gamma functions as ratios that stay exact at both ends of the exponent's range, k -> -1 and k -> 1, and at k = 0.

Everything is built on 1/Gamma, which is entire: a polynomial serves, and nothing has a pole to divide by.
`tools/gamma_tables.py` computes the tables.
"""

import functools

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.special.elementary import leading, polynomial

__all__ = ["catalan_deficit", "central_binomial_pair", "reciprocal_gamma", "reciprocal_gamma_pair"]

_RECIPROCAL_GAMMA = (
    1.0880652521310172,
    -0.3365827219549337,
    -0.5974661969538092,
    0.3945720971816067,
    0.013057454815528245,
    -0.09260402232400153,
    0.032788800578591466,
    0.001303566285941461,
    -0.004340759443983572,
    0.0013067948806495876,
    -3.7329355219321054e-05,
    -8.808139935049412e-05,
    2.839407249613359e-05,
    -2.762326491509074e-06,
    -7.73750426307755e-07,
    3.3907062508560763e-07,
    -5.248517073080701e-08,
    -7.208638348371582e-10,
    2.127329820210776e-09,
    -4.725634130308998e-10,
    3.974907024538722e-11,
    5.1769636856418525e-12,
    -2.2114708777288936e-12,
    3.3130095426534785e-13,
    -1.449899836794163e-14,
    -4.619850788984456e-15,
    1.2139547907677023e-15,
    -1.389587045685903e-16,
    2.829303747329951e-18,
    1.9955253230129347e-18,
    -4.067297364281385e-19,
    3.896703818485265e-20,
    -3.994947067199868e-22,
    -5.098018502596125e-22,
    9.030404603749279e-23,
)
_VOLUME_NUMERATOR = (
    0.9070418210593493,
    -0.35086409916728,
    -0.15025282268535636,
    0.11022881102803173,
    -0.009876883713961605,
    -0.009276683803262176,
    0.0032615138161075715,
    -0.0001340110161713675,
    -0.00017136006677081627,
    4.7418742935573656e-05,
    -2.663411402287116e-06,
    -1.4017256710653635e-06,
    4.0018421116467867e-07,
    -3.6032875602597674e-08,
    -4.935115424241288e-09,
    1.974447569356778e-09,
    -2.5244838160049674e-10,
    7.991359238532935e-13,
    5.32237281632474e-12,
    -9.594830416775279e-13,
    6.652433761036391e-14,
    5.489977537317073e-15,
    -1.9901035605548215e-15,
    2.367633691657994e-16,
    -8.687698230854851e-18,
    -1.870077438326651e-18,
    3.9349674599498237e-19,
    -3.551710392771123e-20,
    6.264667926494088e-22,
    2.982493547518312e-22,
)


@functools.partial(jax.jit, static_argnames="digits")
def reciprocal_gamma(z: Array, digits: int | None = None) -> Array:
    """1/Gamma(1+z) for z in [-1/2, 2]."""
    return polynomial(_RECIPROCAL_GAMMA, (z - 0.75) / 1.25, digits)


@functools.partial(jax.jit, static_argnames="digits")
def reciprocal_gamma_pair(z: Array, square: Array, digits: int | None = None) -> tuple[Array, Array]:
    """(even, odd) with 1/Gamma(1 + z +- d) = even +- d odd, where d^2 = square.

    Horner's rule on numbers even + d odd needs no square root of `square`, so the pair stays differentiable at d = 0.
    """
    t = (z - 0.75) / 1.25
    square = square / 1.25**2
    coefficients = leading(_RECIPROCAL_GAMMA, digits, t.dtype)
    even = jnp.full_like(t * square, coefficients[-1])
    odd = jnp.zeros_like(even)
    for coefficient in reversed(coefficients[:-1]):
        even, odd = even * t + odd * square + coefficient, even + odd * t
    return even, odd / 1.25


def central_binomial_pair(centre: float, d: Array, digits: int | None = None) -> tuple[Array, Array]:
    """(even, odd) with Gamma(1+2x)/Gamma(1+x)^2 = even +- d odd at x = centre +- d; -1/4 <= x <= 1."""
    square = d * d
    even, odd = reciprocal_gamma_pair(jnp.full_like(d, centre), square, digits)
    even_2, odd_2 = reciprocal_gamma_pair(jnp.full_like(d, 2.0 * centre), 4.0 * square, digits)
    odd_2 = 2.0 * odd_2
    norm = even_2 * even_2 - square * odd_2 * odd_2
    square_even, square_odd = even * even + square * odd * odd, 2.0 * even * odd
    return (
        (square_even * even_2 - square * square_odd * odd_2) / norm,
        (square_odd * even_2 - square_even * odd_2) / norm,
    )


@functools.partial(jax.jit, static_argnames="digits")
def catalan_deficit(q: Array, s: Array, digits: int | None = None) -> Array:
    """1 - Gamma(1+2q)/(Gamma(1+q) Gamma(2+q)) with s = 1 - q in (0, 1); its zeros at both ends keep all digits."""
    numerator = polynomial(_VOLUME_NUMERATOR, q - s, digits)
    return q * s * numerator / ((1.0 + q) * reciprocal_gamma(2.0 * q, digits))
