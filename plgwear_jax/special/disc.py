"""The displacement under and beside a uniformly pressed disc: the hypergeometric functions of Eq. (5).

    inside:   w = 2F1(-q, s; 1; t),                     t = r^2 <= 1,        s = (1+k)/2,  q = 1 - s
    outside:  w = q t^-s 2F1(s, s; 2; 1/t),             t >= 1

With x = 1/t - 1 inside and x = t - 1 outside, Pfaff's transformation turns all series into alternating ones. Away from
the edge (x >= 1) they run in 1/x:

    inside:   w = (1-t)^q (1 + q^2/x * sum of (-1/x)^n a_n),     a_n = (s)_n (2-s)_n / (n+1)!^2
    outside:  w = q x^-s sum of (-1/x)^n (n+1) a_n

and towards it (x <= 1) the connection formula reads, with cb(q) = Gamma(1+2q)/Gamma(1+q)^2,

    inside:   w = t^q/2 (cb(q) 2F1(-q, -q; 1-2q; -x) + cb(-q) x^2q 2F1(q, q; 1+2q; -x))
    outside:  w = 1/2 (cb(q) 2F1(-q, 1-q; 1-2q; -x) - cb(-q) x^2q 2F1(q, 1+q; 1+2q; -x))

Both terms have a pole at k = 0, where 1 - 2q = k vanishes; below they are cancelled against each other by hand.
"""

import functools
import math
from fractions import Fraction

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import DTypeLike

from plgwear_jax.special.elementary import exponential_quotient, finite_log, working_digits
from plgwear_jax.special.gamma import central_binomial_pair

__all__ = ["disc_displacement"]


def _alternating_weights(digits: int | None, dtype: DTypeLike, spare: int = 0) -> tuple[float, ...]:
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


def _away(inverse: Array, s: Array, outside: Array, weights: tuple[float, ...]) -> Array:
    """Sum of (-1/x)^n a_n inside, of (-1/x)^n (n+1) a_n outside, for 1/x <= 1."""
    shift = jnp.where(outside, 1.0, 2.0)
    product = s * (2.0 - s)
    table = jnp.asarray(weights, inverse.dtype)
    last = len(weights) - 1

    # A loop of fixed length, since its unrolled second derivatives take XLA minutes to compile.
    def step(i: Array, total: Array) -> Array:
        n = (last - i).astype(inverse.dtype)
        return table[last - i] + inverse * total * (n * (n + 2.0) + product) / ((n + 2.0) * (n + shift))

    return jax.lax.fori_loop(0, len(weights), step, jnp.zeros_like(inverse * s))


def _towards(x: Array, log_x: Array, s: Array, q: Array, outside: Array, digits: int | None) -> Array:
    """The connection formula without its prefactor, 0 <= x <= 1, regular through k = 0.

    It is the sum of (-x)^n (C_n + E D_(n-1)) with e = 2q - 1 = -k and E = expm1(e log x)/e, where
    C_(n+1) = rho_n C_n + kappa_n D_(n-1), D_n = tau_n D_(n-1), and kappa_n is (tau_n - rho_n)/e without its e.
    """
    weights = _alternating_weights(digits, x.dtype, spare=3)
    e = q - s
    even, odd = central_binomial_pair(0.5, 0.5 * e, digits)
    odd = 0.5 * odd  # cb(q) = even + e odd, cb(s) = even - e odd
    c_0 = 0.5 * (even + e * odd)
    d_0 = jnp.where(outside, -0.25, 0.25) * s * (even - e * odd)
    c_1 = jnp.where(
        outside,
        0.25 * s * (even + (2.0 + e) * odd),
        -0.125 * ((3.0 + e) * even + (2.0 + e + e * e) * odd),
    )

    # The sum from n on is (-x)^n (p C_n + (E g + h) D_(n-1)), built from the last term down to n = 2.
    table = jnp.asarray(weights, x.dtype)
    last = len(weights) - 1
    one = jnp.where(outside, 1.0, 0.0)

    def step(i: Array, state: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        p, g, h = state
        n = (last - i).astype(x.dtype)
        m = n - 0.5
        norm, divisor = n * (n + 1.0 + e), (n + 1.0) * (n - e)
        tau = (m + 0.5 * e) * (m + 0.5 * e + one) / norm
        rho = (m - 0.5 * e) * (m - 0.5 * e + one) / divisor
        kappa = jnp.where(
            outside,
            n * (n - e) + (2.0 * n + 1.0) * s * q,
            m * (2.0 * m + 1.5 - e) - 0.5 * (m + 1.0) * e * e,
        ) / (norm * divisor)
        weight = table[last - i]
        return weight + x * p * rho, weight + x * g * tau, x * (p * kappa + h * tau)

    zero = jnp.zeros_like(x * s)
    p, g_2, h = jax.lax.fori_loop(0, last - 1, step, (zero, zero, zero))
    # n = 1, where n - e = 2s cancels.
    tau = jnp.where(outside, q * (1.0 + q), q * q) / (2.0 + e)
    rho = 0.25 * jnp.where(outside, 1.0 + s, s)
    kappa = jnp.where(outside, 0.25 * (2.0 + 3.0 * q), 0.625 + 0.375 * e) / (2.0 + e)
    p, g, h = weights[1] + x * p * rho, weights[1] + x * g_2 * tau, x * (p * kappa + h * tau)

    # At the edge itself the singular part vanishes; its slope, which may be infinite, is that of one rounding away.
    at_edge = x <= 0.0
    beside = x + jnp.finfo(x.dtype).eps
    slope = _singular_part(beside, jnp.log(beside), *jax.lax.stop_gradient((e, q)))
    away = _singular_part(jnp.where(at_edge, 1.0, x), jnp.where(at_edge, 0.0, log_x), e, q)
    singular = jnp.where(at_edge, slope - jax.lax.stop_gradient(slope), away)
    regular = c_0 + x * p * c_1 + (singular * g + x * h) * d_0

    # Outside, both halves of the formula meet as q -> 0, where w is of the order of q: their difference over q.
    small = q < 0.25
    q = jnp.where(small, q, 0.125)
    even, odd = central_binomial_pair(0.0, q, digits)
    power = jnp.exp(2.0 * q * log_x)
    difference = 2.0 * odd - 2.0 * (even - q * odd) * exponential_quotient(2.0 * q, log_x)
    difference = difference + x * (even - q * odd) * power * g_2 * (1.0 + q) / (1.0 + 2.0 * q)
    difference = difference - x * (even + q * odd) * p * (1.0 - q) / (1.0 - 2.0 * q)
    return jnp.where(outside & small, 0.5 * q * difference, regular)


def _singular_part(x: Array, log_x: Array, e: Array, q: Array) -> Array:
    """x E = (x^2q - x)/e, in the form whose derivatives do not cancel either."""
    apart = jnp.abs(e) > 0.5
    return jnp.where(
        apart,
        (jnp.exp(2.0 * q * log_x) - x) / jnp.where(apart, e, 1.0),
        x * exponential_quotient(jnp.where(apart, 0.0, e), log_x),
    )


@functools.partial(jax.jit, static_argnames="digits")
def disc_displacement(r: Array, s: Array, q: Array, digits: int | None = None) -> Array:
    """Displacement w(r)/w(0) of a uniformly pressed disc of unit radius, r >= 0, with s = 1 - q in (0, 1).

    At r = 1 the slope in r, infinite for q <= s, is replaced by that of one rounding away.
    """
    outside = r > 1.0
    beyond, within = jnp.where(outside, r, 2.0), jnp.where(outside, 0.5, r)
    away = jnp.where(outside, beyond > jnp.sqrt(2.0), within < jnp.sqrt(0.5))

    # x, by factors that neither the edge nor the limits r -> 0 and r -> infinity round off.
    inner, outer = jnp.where(away, 0.5, within), jnp.where(away, 2.0, beyond)
    minus = jnp.where(outside, outer - 1.0, (1.0 - inner) / inner)
    plus = jnp.where(outside, outer + 1.0, (1.0 + inner) / inner)
    near = _towards(
        jnp.where(away, 0.5, minus * plus),
        jnp.where(away, 0.0, finite_log(minus) + finite_log(plus)),
        s,
        q,
        outside,
        digits,
    )
    near = near * jnp.where(outside, 1.0, jnp.exp(2.0 * q * jnp.log(inner)))

    # 1/x and w away from the edge, the powers by their logarithms.
    inner, outer = jnp.where(away, within, 0.5), jnp.where(away, beyond, 2.0)
    inverse = jnp.where(
        outside,
        (1.0 / (outer - 1.0)) * (1.0 / (outer + 1.0)),
        (inner / (1.0 - inner)) * (inner / (1.0 + inner)),
    )
    series = _away(inverse, s, outside, _alternating_weights(digits, r.dtype, spare=3))
    log_power = jnp.where(
        outside,
        -s * (jnp.log(outer - 1.0) + jnp.log(outer + 1.0)),
        q * (jnp.log(1.0 - inner) + jnp.log(1.0 + inner)),
    )
    far = jnp.exp(log_power) * jnp.where(outside, q * series, 1.0 + q * q * inverse * series)
    return jnp.where(away, far, near)
