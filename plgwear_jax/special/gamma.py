"""Ratios of gamma functions that keep their digits at both ends of the range, k -> -1 and k -> 1, and at k = 0.

All use 1/Gamma, which has no poles, so a polynomial is enough. `tools/gamma_tables.py` computes the coefficients.
"""

import jax.numpy as jnp
from jax import Array

from .elementary import leading, polynomial, with_digits


def _numbers_in(text: str) -> tuple[float, ...]:
    """The numbers of a table."""
    return tuple(map(float, text.split()))


RECIPROCAL_GAMMA = _numbers_in("""
    1.0880652521310172 -0.3365827219549337 -0.5974661969538092 0.3945720971816067 0.013057454815528245
    -0.09260402232400153 0.032788800578591466 0.001303566285941461 -0.004340759443983572 0.0013067948806495876
    -3.7329355219321054e-05 -8.808139935049412e-05 2.839407249613359e-05 -2.762326491509074e-06 -7.73750426307755e-07
    3.3907062508560763e-07 -5.248517073080701e-08 -7.208638348371582e-10 2.127329820210776e-09 -4.725634130308998e-10
    3.974907024538722e-11 5.1769636856418525e-12 -2.2114708777288936e-12 3.3130095426534785e-13 -1.449899836794163e-14
    -4.619850788984456e-15 1.2139547907677023e-15 -1.389587045685903e-16 2.829303747329951e-18 1.9955253230129347e-18
    -4.067297364281385e-19 3.896703818485265e-20 -3.994947067199868e-22 -5.098018502596125e-22 9.030404603749279e-23
""")
_VOLUME_NUMERATOR = _numbers_in("""
    0.9070418210593493 -0.35086409916728 -0.15025282268535636 0.11022881102803173 -0.009876883713961605
    -0.009276683803262176 0.0032615138161075715 -0.0001340110161713675 -0.00017136006677081627 4.7418742935573656e-05
    -2.663411402287116e-06 -1.4017256710653635e-06 4.0018421116467867e-07 -3.6032875602597674e-08
    -4.935115424241288e-09 1.974447569356778e-09 -2.5244838160049674e-10 7.991359238532935e-13 5.32237281632474e-12
    -9.594830416775279e-13 6.652433761036391e-14 5.489977537317073e-15 -1.9901035605548215e-15 2.367633691657994e-16
    -8.687698230854851e-18 -1.870077438326651e-18 3.9349674599498237e-19 -3.551710392771123e-20 6.264667926494088e-22
    2.982493547518312e-22
""")
_EDGE_EVEN = _numbers_in("""
    0.7896784246475238 -0.10838579894907284 0.002276972044840774 2.4517827818169274e-05 -3.636101528425311e-07
    -1.9572946190036687e-09 -3.658747343879526e-12 -3.749010134157671e-15 -3.436992897509626e-18
    -1.0334853704538338e-20
""")
_EDGE_ODD = _numbers_in("""
    -0.2750413728719378 0.011011554107175203 -3.7862805570838766e-05 -7.272552922473851e-07 -2.0934518457126218e-09
    -2.7209042097685412e-12 -1.8065741266225628e-15 1.3531831989115495e-18 1.8393154421308706e-20
""")


@with_digits
def reciprocal_gamma(z: Array, digits: int | None) -> Array:
    """1/Gamma(1+z) for z in [-1/2, 2]."""
    return polynomial(RECIPROCAL_GAMMA, (z - 0.75) / 1.25, digits)


@with_digits
def reciprocal_gamma_pair(z: Array, square: Array, digits: int | None) -> tuple[Array, Array]:
    """(even, odd) with 1/Gamma(1 + z +- d) = even +- d odd, where d^2 = square.

    Division of the polynomial by (x - t)^2 - d^2, whose zeros are t +- d, leaves odd (x - t) + even. It needs no square
    root of `square`, so the pair stays differentiable at d = 0.
    """
    t = (z - 0.75) / 1.25
    square = square / 1.25**2
    twice, product = t + t, t * t - square
    odd, before = jnp.zeros_like(product), jnp.zeros_like(product)
    for coefficient in reversed(leading(RECIPROCAL_GAMMA, digits, t.dtype)):
        odd, before = twice * odd - product * before + coefficient, odd
    return odd - t * before, before / 1.25


def edge_pair(square: Array, ends: Array, digits: int | None) -> tuple[Array, Array, Array]:
    """(even, odd, poles) with 2^-q Gamma(1+2q)/Gamma(1+q)^2 = (even + h ends odd)/poles at q = 1/2 - h; abs(h) <= 1/2.

    `square` is h^2 and `ends` is 1/4 - h^2, to full relative accuracy also near its zeros, where the odd part vanishes.
    """
    x = 8.0 * square - 1.0
    poles = (1.0 - square) * (1.0 - 0.25 * square) * (1.0 - square * (1.0 / 9.0))
    return polynomial(_EDGE_EVEN, x, digits), ends * polynomial(_EDGE_ODD, x, digits), poles


@with_digits
def catalan_deficit(q: Array, s: Array, digits: int | None) -> Array:
    """1 - Gamma(1+2q)/(Gamma(1+q) Gamma(2+q)) with s = 1 - q in (0, 1), to all digits also near its zeros."""
    return q * s * polynomial(_VOLUME_NUMERATOR, q - s, digits) / ((1.0 + q) * reciprocal_gamma(2.0 * q, digits))
