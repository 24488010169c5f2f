"""The displacement under and beside a uniformly pressed disc: the hypergeometric functions of Eq. (5).

    inside:   w = 2F1(-q, s; 1; t),                     t = r^2 <= 1,        s = (1+k)/2,  q = 1 - s
    outside:  w = q t^-s 2F1(s, s; 2; 1/t),             t >= 1

Away from the edge, where p_n is the product of 1 - q^2/m^2 over m = 1 ... n and x is (1-t)/t inside and t - 1 outside,

    inside:   w = (1-t)^q (1 + q^2/x * sum of (-1/x)^n p_n/(n+1)^2)
    outside:  w = q x^-s sum of (-1/x)^n p_n/(n+1)

Towards it, a quadratic transformation has one formula for both sides. With z = (1-t)/(1+t), y = z^2, h = k/2,

    w = (1+t)^-s (A X + (B y^-h (S X' - 2 Y') - A (S X - 2 Y))/k),      S = s (1-t)/2,      A = cb(q)/2^q,
    X = 1 - s q/4 * sum over n >= 1 of y^n p_n/(n (n+h)),    Y = -s q/4 * sum of y^n p_n/(n+h),

cb(q) = Gamma(1+2q)/Gamma(1+q)^2 and p_n the product of 1 - s q/(4 m (m+h)) over m = 1 ... n-1, where B, X' and Y' are
A, X and Y with -h for h. The difference over k is taken term by term: all pairs below are even + h odd.
"""

import functools
from fractions import Fraction

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import DTypeLike

from plgwear_jax.special.elementary import (
    exponential_moment,
    exponentials,
    log,
    quotient,
    reciprocal,
    working_digits,
)
from plgwear_jax.special.gamma import edge_pair

__all__ = ["disc_displacement"]

# t, or its inverse, where the two forms meet: there both take about as long.
_MEET = Fraction(1, 2)
# The sum away from the edge loses a digit to its derivatives; those towards it enter times s q y/4 or less.
_SPARE_AWAY, _SPARE_TOWARDS = 1, -2


@functools.cache
def _weights(reach: Fraction, digits: int) -> tuple[float, ...]:
    """Weights that make a finite sum of the powers of x, between 0 and `reach` < 1, equal 1/(1-x) to so many digits.

    They serve any sum of c_n x^n in which c_n is the n-th moment of a measure on [0, 1].
    """
    terms, chebyshev = 1, [Fraction(1), 1 - 2 / reach]
    while abs(chebyshev[-1]) < 10**digits:
        chebyshev.append(2 * chebyshev[1] * chebyshev[-1] - chebyshev[-2])
        terms += 1
    # The Chebyshev polynomial that oscillates between 0 and the reach is what they leave out, over its value at 1.
    coefficient, rest = Fraction(1), chebyshev[terms]
    weights: list[float] = []
    for n in range(terms):
        rest -= coefficient
        weights.append(float(rest / chebyshev[terms]))
        coefficient *= Fraction(2 * (n + terms) * (n - terms), (2 * n + 1) * (n + 1)) / reach
    return tuple(weights)


def _digits(digits: int | None, dtype: DTypeLike, spare: int) -> int:
    return working_digits(digits, dtype) + spare


# --- away from the edge ---------------------------------------------------------------------------------------------


def _away(x: Array, s: Array, q: Array, outside: Array, digits: int | None) -> Array:
    """w without the power before it, from x = 1/x of above."""
    weights = _weights(-_MEET / (1 - _MEET), _digits(digits, x.dtype, _SPARE_AWAY))
    qx = q * q * x
    # Two terms at a time, which halves the chain of dependent steps.
    terms = [jnp.where(outside, w / (n + 1), w / (n + 1) ** 2) for n, w in enumerate(weights)]
    ratios = [qx * (1.0 / n**2) - x for n in range(1, len(weights))]
    total = terms[-1]
    last = len(terms) - 1
    if last % 2:
        last -= 1
        total = terms[last] + ratios[last] * total
    for n in range(last - 2, -1, -2):
        total = (terms[n] + ratios[n] * terms[n + 1]) + (ratios[n] * ratios[n + 1]) * total
    return jnp.where(outside, q * total, 1.0 + qx * total)


# --- towards the edge -----------------------------------------------------------------------------------------------


def _sums(y: Array, kappa: Array, square: Array, digits: int | None) -> tuple[tuple[Array, Array], ...]:
    """Pairs u, v, d: the sums in X and Y are y u/d and y v/d, d is the product of 1 + h/n over their terms."""
    reach = ((1 - _MEET) / (1 + _MEET)) ** 2
    weights = _weights(reach, _digits(digits, y.dtype, _SPARE_TOWARDS))
    ky, sy = kappa * y, square * y
    d_even, d_odd = jnp.ones_like(square), jnp.zeros_like(square)
    u_even = u_odd = v_even = v_odd = jnp.zeros_like(ky)
    for n in range(len(weights), 0, -1):
        w = weights[n - 1] / n
        ratio, cross, back = y - ky * (1.0 / n**2), sy * (1.0 / n), y * (1.0 / n)
        u_even, u_odd = (
            ratio * u_even + (cross * u_odd + (w / n) * d_even),
            ratio * u_odd + (back * u_even + (w / n) * d_odd),
        )
        v_even, v_odd = ratio * v_even + (cross * v_odd + w * d_even), ratio * v_odd + (back * v_even + w * d_odd)
        d_even, d_odd = d_even + square * (1.0 / n) * d_odd, d_odd + d_even * (1.0 / n)
    return (u_even, u_odd), (v_even, v_odd), (d_even, d_odd)


@jax.custom_jvp
def _growth(less_one: Array, k: Array, log_z: Array) -> Array:
    """(z^-k - 1)/k, which is -log(z) at k = 0, from z^-k - 1; z < 1."""
    small = jnp.abs(k) < 1e-30
    return jnp.where(small, -log_z, jnp.abs(less_one / jnp.where(small, 1.0, k)))


@_growth.defjvp
def _growth_jvp(primals, tangents):
    less_one, k, log_z = primals
    _, dk, dlog_z = tangents
    by_k = log_z * log_z * exponential_moment(-k * log_z, 1)
    return _growth(*primals), by_k * dk - (1.0 + less_one) * dlog_z


def _towards(z: Array, log_z: Array, half: Array, s: Array, q: Array, outside: Array, digits: int | None) -> Array:
    """w without (1+t)^-s, from abs(z) and half = (1+t)/2."""
    k = s - q
    # At the edge itself the singular part vanishes; its slope, which may be infinite, is that of one rounding away.
    at_edge = z <= 0.0
    beside = z + jnp.where(at_edge, 0.5 * jnp.finfo(z.dtype).eps, 0.0)
    k_beside, q_beside = (jnp.where(at_edge, jax.lax.stop_gradient(x), x) for x in (k, q))
    steep = k > 0.5
    power, less_one = exponentials(jnp.where(steep, 2.0 * q_beside, -k_beside) * log_z, digits)
    sign = jnp.where(outside, -1.0, 1.0)
    growth = _growth(jnp.where(steep, 0.0, less_one), jnp.where(steep, 0.25, k_beside), log_z)
    singular = jnp.where(
        steep,
        sign * quotient(jnp.where(steep, power - beside, 1.0), jnp.where(steep, k_beside, 1.0)),
        sign * beside * growth,
    )
    singular = jnp.where(at_edge, singular - jax.lax.stop_gradient(singular), singular)  # (z^-k - 1) z/k
    z = sign * z

    h = 0.5 * k
    square, ends, y = h * h, q * s, z * z
    kappa = 0.25 * ends
    even, odd, poles = edge_pair(square, ends, digits)
    (u_even, u_odd), (v_even, v_odd), (d_even, d_odd) = _sums(y, kappa, square, digits)
    norm = d_even * d_even - square * d_odd * d_odd
    # A/d over poles and norm
    a_even, a_odd = even * d_even - square * odd * d_odd, odd * d_even - even * d_odd
    slope = s * z * half
    p_even, p_odd = slope * u_even - 2.0 * v_even, slope * u_odd - 2.0 * v_odd
    p_even, p_odd = a_even * p_even + square * (a_odd * p_odd), a_even * p_odd + a_odd * p_even
    a_u = a_even * u_even + square * (a_odd * u_odd) + h * (a_odd * u_even + a_even * u_odd)
    rest = y * (a_u - p_odd) + z * singular * (p_even - h * p_odd)
    a, b = even + h * odd, even - h * odd
    lead = a + s * half * (singular * b - z * odd)
    # Outside, w is of the order of q as q -> 0.
    small = (half * s * (k * odd - b * less_one) - q * a) * reciprocal(jnp.where(steep, k, 1.0))
    lead = jnp.where(outside & steep, small, lead)
    return (lead * norm - kappa * rest) * reciprocal(norm * poles)


@functools.partial(jax.jit, static_argnames="digits")
def disc_displacement(r: Array, s: Array, q: Array, digits: int | None = None) -> Array:
    """Displacement w(r)/w(0) of a uniformly pressed disc of unit radius, r >= 0, with s = 1 - q in (0, 1).

    At r = 1 the slope in r, infinite for q <= s, is replaced by that of one rounding away.
    """
    outside, within = r > 1.0, r < float(_MEET) ** 0.5
    away = within | (r > float(_MEET) ** -0.5)
    # Far out nothing but the power depends on r any more.
    bounded = jnp.minimum(r, 2.0**30)
    t, gap = bounded * bounded, jnp.abs(1.0 - r)
    difference = jnp.abs(1.0 - bounded) * (1.0 + bounded)
    # 1/x or abs(z)
    ratio = quotient(jnp.where(away, jnp.where(within, t, 1.0), difference), jnp.where(away, difference, 1.0 + t))
    beside = jnp.where(r == 1.0, ratio + 0.5 * jnp.finfo(r.dtype).eps, ratio)
    first = log(jnp.where(away, gap, beside), digits)
    second = log(1.0 + jnp.where(away, r, t), digits)
    far = _away(ratio, s, q, outside, digits)
    near = _towards(
        jnp.where(away, 0.125, ratio),
        jnp.where(away, -2.0, first),
        jnp.where(away, 1.0, 0.5 + 0.5 * t),
        s,
        q,
        outside,
        digits,
    )
    exponent = jnp.where(away, jnp.where(outside, -s, q) * (first + second), -s * second)
    return exponentials(exponent, digits)[0] * jnp.where(away, far, near)
