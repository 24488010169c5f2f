"""Surface displacement inside and outside a uniformly loaded disc: the hypergeometric functions of Eq. (5).

    inside:   w = 2F1(-q, s; 1; t),                     t = r^2 <= 1,        s = (1+k)/2,  q = 1 - s
    outside:  w = q t^-s 2F1(s, s; 2; 1/t),             t >= 1

Away from the edge, where p_n is the product of 1 - q^2/m^2 over m = 1 ... n and x is (1-t)/t inside and t - 1 outside,

    inside:   w = (1-t)^q (1 + q^2/x * sum of (-1/x)^n p_n/(n+1)^2)
    outside:  w = q x^-s sum of (-1/x)^n p_n/(n+1)

Near the edge, a quadratic transformation gives one formula for both sides. With z = (1-t)/(1+t), y = z^2, h = k/2,

    w = (1+t)^-s (A X + (B y^-h (S X' - 2 Y') - A (S X - 2 Y))/k),      S = s (1-t)/2,      A = cb(q)/2^q,
    X = 1 - s q/4 * sum over n >= 1 of y^n p_n/(n (n+h)),    Y = -s q/4 * sum of y^n p_n/(n+h),

cb(q) = Gamma(1+2q)/Gamma(1+q)^2 and p_n the product of 1 - s q/(4 m (m+h)) over m = 1 ... n-1, where B, X' and Y' are
A, X and Y with -h for h. The difference over k is taken term by term: each pair (even, odd) below means even + h odd.
"""

import functools
from fractions import Fraction

import jax.numpy as jnp
from jax import Array, lax

from .elementary import TINY, exponentials, growth, log, quotient, reciprocal, with_digits, working_digits
from .gamma import edge_pair

# t inside, or 1/t outside, where the formulas away from and near the edge meet; there they cost about the same.
_MEET = Fraction(1, 2)


@functools.cache
def _moment_weights(reach: Fraction, digits: int) -> tuple[float, ...]:
    """Weights w_n for which the finite sum of w_n x^n equals 1/(1-x) to so many digits, for x from 0 to `reach` < 1.

    Whenever c_n is the n-th moment of a measure on [0, 1], the finite sum of w_n c_n x^n then equals the infinite sum
    of c_n x^n to as many digits.
    """
    terms, chebyshev = 1, [Fraction(1), 1 - 2 / reach]
    while abs(chebyshev[-1]) < 10**digits:
        chebyshev.append(2 * chebyshev[1] * chebyshev[-1] - chebyshev[-2])
        terms += 1
    # The relative error is the Chebyshev polynomial of the interval from 0 to `reach`, divided by its value at 1.
    coefficient, rest = Fraction(1), chebyshev[terms]
    weights: list[float] = []
    for n in range(terms):
        rest -= coefficient
        weights.append(float(rest / chebyshev[terms]))
        coefficient *= Fraction(2 * (n + terms) * (n - terms), (2 * n + 1) * (n + 1)) / reach
    return tuple(weights)


# --- away from the edge ---------------------------------------------------------------------------------------------


def _alternating(x: Array, square: Array, outside: Array, digits: int | None) -> Array:
    # One digit more, since the derivatives lose one.
    weights = _moment_weights(-_MEET / (1 - _MEET), working_digits(digits, x.dtype) + 1)
    qx = square * x
    total = jnp.zeros_like(qx)
    for n in range(len(weights), 0, -1):
        total = jnp.where(outside, weights[n - 1] / n, weights[n - 1] / n**2) + (qx * (1.0 / n**2) - x) * total
    return total


# --- towards the edge -----------------------------------------------------------------------------------------------


def _pairs(y: Array, square: Array, digits: int | None) -> tuple[tuple[Array, Array], ...]:
    # Two digits less are enough, since both sums are multiplied by s q y/4 or less.
    weights = _moment_weights(((1 - _MEET) / (1 + _MEET)) ** 2, working_digits(digits, y.dtype) - 2)
    cross = square * y
    ky = 0.0625 * y - 0.25 * cross
    d_even, d_odd = jnp.ones_like(square), jnp.zeros_like(square)
    sums = [(jnp.zeros_like(cross), jnp.zeros_like(cross))] * 2
    for n in range(len(weights), 0, -1):
        w, ratio = weights[n - 1], n * y - (1.0 / n) * ky
        sums = [
            (ratio * even + (cross * odd + weight * d_even), ratio * odd + (y * even + weight * d_odd))
            for (even, odd), weight in zip(sums, (w / n, 2.0 * w), strict=True)
        ]
        d_even, d_odd = n * d_even + square * d_odd, n * d_odd + d_even
    return *sums, (d_even, d_odd)


def _towards(z: Array, log_z: Array, half: Array, s: Array, q: Array, outside: Array, digits: int | None) -> Array:
    """w (1+t)^s near the edge, from abs(z) and half = (1+t)/2."""
    k = s - q
    # At the edge itself the singular part is zero; its slope, possibly infinite, is taken at the neighbouring number.
    at_edge = z <= 0.0
    off_edge = z + jnp.where(at_edge, 0.5 * jnp.finfo(z.dtype).eps, 0.0)
    k_fixed, q_fixed = (jnp.where(at_edge, lax.stop_gradient(x), x) for x in (k, q))
    steep = k > 0.5
    power, less_one = exponentials(jnp.where(steep, 2.0 * q_fixed, -k_fixed) * log_z, digits)
    over = reciprocal(jnp.where(jnp.abs(k_fixed) < TINY, 1.0, jnp.abs(k_fixed)))
    sign = jnp.where(outside, -1.0, 1.0)
    lift = growth(jnp.where(steep, 0.0, less_one), over, jnp.where(steep, -0.25, -k_fixed), log_z)
    singular = sign * jnp.where(steep, (power - off_edge) * over, off_edge * lift)
    singular = jnp.where(at_edge, singular - lax.stop_gradient(singular), singular)  # (z^-k - 1) z/k
    z = sign * z

    h = 0.5 * k
    square, ends, y = h * h, q * s, z * z
    kappa = 0.25 * ends
    even, odd, poles = edge_pair(square, ends, digits)
    (u_even, u_odd), (v_even, v_odd), (d_even, d_odd) = _pairs(y, square, digits)
    norm = (d_even + h * d_odd) * (d_even - h * d_odd)
    # A poles norm/d, and S u - 2 v
    a_even, a_odd = even * d_even - square * odd * d_odd, odd * d_even - even * d_odd
    slope = s * z * half
    p_even, p_odd = slope * u_even - v_even, slope * u_odd - v_odd
    plus, minus = (a_even + h * a_odd) * (u_even + h * u_odd), (a_even - h * a_odd) * (p_even - h * p_odd)
    rest = y * (plus - (a_even * p_odd + a_odd * p_even)) + z * singular * minus
    a, b = even + h * odd, even - h * odd
    lead = a + s * half * (singular * b - z * odd)
    # Outside, w is of the order of q as q -> 0.
    small = (half * s * (k * odd - b * less_one) - q * a) * over
    lead = jnp.where(outside & steep, small, lead)
    return (lead * norm - kappa * rest) * reciprocal(norm * poles)


@with_digits
def disc_displacement(r: Array, s: Array, q: Array, digits: int | None) -> Array:
    """Displacement w(r)/w(0) of a uniformly loaded disc of unit radius, r >= 0, with s = 1 - q in (0, 1).

    At r = 1 the slope in r, infinite for q <= s, is replaced by the slope at the neighbouring floating-point number.
    """
    outside, within = r > 1.0, r < float(_MEET) ** 0.5
    away = within | (r > float(_MEET) ** -0.5)
    # Beyond r = 2^30 only the power t^-s still depends on r.
    bounded = jnp.minimum(r, 2.0**30)
    t = bounded * bounded
    difference = jnp.abs(1.0 - bounded) * (1.0 + bounded)
    # 1/x or abs(z)
    ratio = quotient(jnp.where(away, jnp.where(within, t, 1.0), difference), jnp.where(away, difference, 1.0 + t))
    off_edge = jnp.where(r == 1.0, ratio + 0.5 * jnp.finfo(r.dtype).eps, ratio)
    first = log(jnp.where(away, jnp.abs(1.0 - r), off_edge), digits)
    second = log(1.0 + jnp.where(away, r, t), digits)
    square = q * q
    far = _alternating(ratio, square, outside, digits)
    far = jnp.where(outside, q * far, 1.0 + square * ratio * far)
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
    return jnp.where(r == jnp.inf, 0.0, exponentials(exponent, digits)[0] * jnp.where(away, far, near))
