"""The alternating Lerch series, the one series that the fretting problem sums.

    Phi_m(x; a) = sum over n >= 0 of (-1)^n x^n / (n + a)^m,        0 <= x <= 1,  a > 0,  m = 0, 1, 2, ...

What is summed is its difference Phi_m(x; a) - Phi_m(x; a+1), since Phi_m(x; a) + x Phi_m(x; a+1) = 1/a^m then gives
both without a cancellation. Its terms without the sign are moments of a positive measure on [0, x], so the
acceleration of Cohen, Rodriguez Villegas and Zagier (Experimental Mathematics 9, 2000) shrinks the error by
3 + sqrt(8) a term, the same for every x, a and m.
"""

import functools
import math
from fractions import Fraction

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import DTypeLike

from plgwear_jax.special.elementary import working_digits

__all__ = ["alternating_lerch", "alternating_weights", "lerch_difference"]


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


def alternating_lerch(x: Array, a: Array, order: int = 1, digits: int | None = None) -> Array:
    """Phi_m(x; a) with m = `order`, for arrays 0 <= x <= 1 and a > 0, to the digits asked for."""
    return (1.0 / a**order + x * lerch_difference(x, a, order, digits)) / (1.0 + x)


@functools.partial(jax.custom_jvp, nondiff_argnums=(2, 3))
def lerch_difference(x: Array, a: Array, order: int = 1, digits: int | None = None) -> Array:
    """Phi_m(x; a) - Phi_m(x; a+1) with m = `order`, for arrays 0 <= x <= 1 and a > 0, to the digits asked for.

    Differentiable to any order: each derivative is again such a series, so it converges as fast as the value.
    """
    if order == 0:
        return jnp.zeros_like(x * a)
    return _sum(x, a, order, alternating_weights(digits, x.dtype))


@functools.partial(jax.jit, static_argnums=(2, 3))
def _sum(x: Array, a: Array, order: int, weights: tuple[float, ...]) -> Array:
    # Horner's rule as a loop of fixed length: XLA compiles and runs it faster than the unrolled sum.
    last = len(weights) - 1
    table = jnp.asarray(weights, x.dtype)

    def step(i: Array, total: Array) -> Array:
        n = last - i
        here = n.astype(x.dtype) + a
        # (n+a+1)^m - (n+a)^m over the product of both powers.
        growth = sum(math.comb(order, j) * here**j for j in range(order))
        return total * x + table[n] * growth / (here * (here + 1.0)) ** order

    return jax.lax.fori_loop(0, last + 1, step, jnp.zeros_like(x * a))


@lerch_difference.defjvp
def _lerch_difference_jvp(order: int, digits: int | None, primals, tangents):
    x, a = primals
    dx, da = tangents
    value = lerch_difference(x, a, order, digits)
    if order == 0:
        return value, value
    # n x^(n-1)/(n+a)^m with n = (n+a) - a; the index is shifted by one, so that x never divides.
    shifted = lerch_difference(x, a + 1.0, order, digits)
    beyond = (1.0 / (a + 1.0) ** order - shifted) / (1.0 + x)  # Phi_m(x; a+2)
    by_x = a * shifted - lerch_difference(x, a + 1.0, order - 1, digits) - beyond
    by_a = -order * lerch_difference(x, a, order + 1, digits)
    return value, by_x * dx + by_a * da
