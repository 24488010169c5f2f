"""The alternating Lerch series, the one series that the fretting problem sums.

    Phi_m(x; a) = sum over n >= 0 of (-1)^n x^n / (n + a)^m,        0 <= x <= 1,  a > 0,  m = 0, 1, 2, ...

Its terms without the sign are moments of a positive measure on [0, x], so the acceleration of Cohen, Rodriguez Villegas
and Zagier (Experimental Mathematics 9, 2000) shrinks the error by 3 + sqrt(8) a term, the same for every x, a and m.
"""

import functools
import math
from fractions import Fraction

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import DTypeLike

from plgwear_jax.special.elementary import working_digits

__all__ = ["alternating_lerch", "alternating_weights"]


def alternating_weights(digits: int | None, dtype: DTypeLike, spare: int = 0) -> tuple[float, ...]:
    """Weights, signs included, that make a finite sum of the terms of an alternating series to the digits asked for.

    `spare` digits are added where the sum of N terms is differentiated termwise or shifted: both cost N^2 in accuracy.
    """
    return _weights(working_digits(digits, dtype) + spare)


@functools.cache
def _weights(digits: int) -> tuple[float, ...]:
    terms = math.ceil((digits * math.log(10.0) + math.log(2.0)) / math.log(3.0 + math.sqrt(8.0)))
    # Chebyshev polynomials give whole numbers here, so exact arithmetic costs nothing at trace time.
    chebyshev = [1, 3]
    while len(chebyshev) <= terms:
        chebyshev.append(6 * chebyshev[-1] - chebyshev[-2])
    total = chebyshev[terms]
    coefficient, partial = Fraction(-1), Fraction(-total)
    weights: list[float] = []
    for n in range(terms):
        partial = coefficient - partial
        weights.append(float(partial / total))
        coefficient *= Fraction(2 * (n + terms) * (n - terms), (2 * n + 1) * (n + 1))
    return tuple(weights)


@functools.partial(jax.custom_jvp, nondiff_argnums=(2, 3))
def alternating_lerch(x: Array, a: Array, order: int = 1, digits: int | None = None) -> Array:
    """Phi_m(x; a) with m = `order` >= 0, for arrays 0 <= x <= 1 and a > 0, to the digits asked for.

    Differentiable to any order: each derivative is again such a series, so it converges as fast as the value.
    """
    if order == 0:
        return 1.0 / (1.0 + x)
    return _sum(x, a, order, alternating_weights(digits, x.dtype))


@functools.partial(jax.jit, static_argnums=(2, 3))
def _sum(x: Array, a: Array, order: int, weights: tuple[float, ...]) -> Array:
    # Horner's rule as a loop of fixed length: XLA compiles and runs it faster than the unrolled sum.
    last = len(weights) - 1
    table = jnp.asarray(weights, x.dtype)

    def step(i: Array, total: Array) -> Array:
        n = last - i
        return total * x + table[n] / (n.astype(x.dtype) + a) ** order

    return jax.lax.fori_loop(0, last + 1, step, jnp.zeros_like(x * a))


@alternating_lerch.defjvp
def _alternating_lerch_jvp(order: int, digits: int | None, primals, tangents):
    x, a = primals
    dx, da = tangents
    value = alternating_lerch(x, a, order, digits)
    if order == 0:
        return value, -dx * value * value
    # n x^(n-1)/(n+a)^m with n = (n+a) - a; the index is shifted by one, so that x never divides.
    by_x = a * alternating_lerch(x, a + 1.0, order, digits) - alternating_lerch(x, a + 1.0, order - 1, digits)
    by_a = -order * alternating_lerch(x, a, order + 1, digits)
    return value, by_x * dx + by_a * da
