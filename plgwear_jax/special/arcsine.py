"""The tail of the generalised arcsine law, the special function of the fretting problem, and functions built on it.

    Q(y; s) = sin(pi s)/pi * integral from 0 to y of v^-s/(1+v) dv = 1 - I_t(s, 1-s),      t = 1/(1+y)

Every incomplete beta function of Eqs. (3), (14), (18) and (24) is a combination of it and its moments. With
S_j = y^-(j+q) * integral from 0 to y of v^(j-s)/(1+v) dv, which the fraction T of `lerch` gives as

    q S_0 = T/D,    S_1 = 1/D,    S_2 = (q + U)/((1+q) D),    D = T + q y,    S_2 - S_1^2/S_0 = U/((1+q) T),

all forms below for y up to the fold are sums with little cancellation and without division by zero, so that automatic
differentiation keeps their digits. For larger y the same forms give 1 - Q as a function of 1/y. All functions take both
s and q = 1 - s, since the subtraction would lose digits of the smaller one. omega stands for sin(pi s)/(pi s q).
"""

import math
from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from .elementary import (
    exponentials,
    growth,
    log,
    log_complement,
    quotient,
    reciprocal,
    sine_excess,
    squares_apart,
    with_digits,
)
from .lerch import fold_at, lerch_tail


class Fold(NamedTuple):
    """y > 0 as x = y or x = 1/y, so that x lies where the continued fraction converges fast."""

    x: Array  # in [0, fold]
    log_x: Array
    inner: Array  # True where x is y, False where it is 1/y


def fold(y: Array, digits: int | None = None) -> Fold:
    """Fold y > 0."""
    inner = y <= fold_at(y.dtype)
    x = jnp.where(inner, y, reciprocal(jnp.where(inner, 1.0, y)))
    # From y itself: near y = 1 the rounding error of 1/y would be as large as its logarithm.
    log_y = log(y, digits)
    return Fold(x, jnp.where(inner, log_y, -log_y), inner)


def fold_outside(r: Array, c: Array) -> Fold:
    """Fold y = (r/c)^2 - 1 of a radius r > c, computed from r - c, which keeps its digits at the edge and far away.

    For r <= c, under the punch, callers ignore the result; it is finite, since it is computed at a radius outside.
    """
    inner = r <= math.sqrt(1.0 + fold_at(r.dtype)) * c
    near = jnp.where(inner & (r > c), r, 1.25 * c)
    y = squares_apart(near, c, c)
    # For larger r from c/r and log(r), since products of derivatives must not overflow at a radius of 1e300.
    far = jnp.where(inner, 2.0 * c, r)
    inverse = c / far
    beyond = inverse * inverse
    log_beyond = 2.0 * (jnp.log(c) - jnp.log(far)) - log_complement(beyond)
    x = jnp.where(inner, y, beyond / (1.0 - beyond))
    return Fold(x, jnp.where(inner, jnp.log(y), log_beyond), inner)


def over_abscissa(value: Array, y: Fold) -> Array:
    """value/y."""
    return jnp.where(y.inner, value / jnp.where(y.inner, y.x, 1.0), value * y.x)


class _FoldedTerms(NamedTuple):
    """The terms common to all functions of y. The power is x^q for y up to the fold, and x^s for larger y."""

    n: Array  # denominator N of the fraction U
    m: Array  # N U
    t: Array  # N T
    d: Array  # N D
    power: Array
    less_one: Array  # power - 1
    omega: Array
    deficit: Array  # (1 - q omega)/s for y > the fold, (1 - s omega)/q for y <= the fold


def _folded_terms(y: Fold, s: Array, q: Array, digits: int | None) -> _FoldedTerms:
    p, other = jnp.where(y.inner, q, s), jnp.where(y.inner, s, q)
    m, n = lerch_tail(y.x, p, digits)
    t = (1.0 + p) * n + y.x * m
    excess = sine_excess(s, q, digits)
    power, less_one = exponentials(p * y.log_x, digits)
    omega = 1.0 + s * q * excess
    return _FoldedTerms(n, m, t, t + p * (y.x * n), power, less_one, omega, 1.0 - other * other * excess)


# --- the tail and the moment of a displacement ----------------------------------------------------------------------


@with_digits
def arcsine_tail(y: Fold, s: Array, q: Array, digits: int | None = None) -> tuple[Array, Array, Array]:
    """(Q, 1 - Q, sin(pi s)/pi y^-s T_1(1/y)) at y, the last two for the surface displacement outside a contact.

    Q and 1 - Q have full relative accuracy also where they tend to 0: Q as y -> 0, 1 - Q as y -> infinity.
    T_1(x) = sum of (-1)^n x^n/(n+1+s); the last one is y times (sin(pi s)/(pi s) y^-s - (1 - Q)).
    """
    # Infinitely far away powers, and what differentiates them, would be products of 0 and infinity.
    endless = ~y.inner & (y.log_x == -jnp.inf)
    x, log_x, inner = y = y._replace(log_x=jnp.where(endless, 0.0, y.log_x))
    p, other = jnp.where(inner, q, s), jnp.where(inner, s, q)
    n, _, t, d, power, less_one, omega, deficit = _folded_terms(y, s, q, digits)
    # Q(y; s) = 1 - Q(1/y; 1-s): for y up to the fold Q is small, for larger y 1 - Q is small.
    near = other * omega * power * quotient(t, d)
    rest = quotient(n, d)
    far = p * deficit + other * omega * (p * (x * power * rest) - less_one)
    tail, body = jnp.where(inner, near, far), jnp.where(inner, far, near)
    # As s -> 0 both terms of the difference tend to 1, so it is formed from their differences from 1.
    density, less_one = exponentials(-s * jnp.where(inner, log_x, 0.0), digits)
    deficit = 1.0 - q * q * sine_excess(s, q, digits)
    small = x * (tail + less_one - s * deficit * density)
    difference = jnp.where(s < 0.5, small, q * omega * power - x * body)
    moment = jnp.where(inner, difference, s * q * omega * power * rest)
    return tail, jnp.where(endless, 0.0, body), jnp.where(endless, 0.0, moment)


# --- the arc from 0 to y --------------------------------------------------------------------------------------------


class Arc(NamedTuple):
    """Q/s and G(v) = s v - q + 1/S_0(v), which rises from G(0) = 0, with derivatives and integrals from 0 to y.

    As y -> 0, `share` vanishes as y^q, `area` as y^(1+q) and `below` as y^(2+q).
    """

    chord: Array  # G(y)/y
    slope: Array  # G'(y)
    bend: Array  # y G''(y)
    share: Array  # Q/s
    area: Array  # integral of Q/s from 0 to y
    below: Array  # integral of (Q/s) (G(y) - G(v)) from 0 to y
    density: Array  # omega y^q = sin(pi s)/pi y^q/(s q)


@with_digits
def arc(y: Array, s: Array, q: Array, digits: int | None) -> Arc:
    """The arc from 0 to y > 0."""
    folded = fold(y, digits)
    x, _, inner = folded
    n, m, t, d, power, less_one, omega, deficit = _folded_terms(folded, s, q, digits)
    density = omega * jnp.where(inner, power, y * power)
    over_d, over_q = reciprocal(d), reciprocal(1.0 + q)

    # Q/s D for y > the fold
    lift = growth(less_one, reciprocal(s), s, jnp.where(inner, 0.0, folded.log_x))
    body = (deficit + q * omega * lift) * d + q * omega * power * (x * n)
    over = reciprocal(jnp.where(inner, t, body))
    inverse = jnp.where(inner, q * d, q * density * d) * over
    chord = s + q * jnp.where(inner, q * n, (density * d - body) * x) * over
    # u = 1/S_0 obeys the Riccati equation u' = u g with y g = q - u/(1+y).
    near = reciprocal(1.0 + x)
    lever = jnp.where(inner, near, x * near)  # 1/(1+y)
    rate = jnp.where(inner, q * (n + x * m) * over * near, (q - inverse * lever) * x)
    slope = s + inverse * rate
    bend = inverse * (rate * (y * rate - 1.0) - lever * inverse * (rate - lever))
    share = jnp.where(inner, density * t, body) * over_d

    narrow = density * y * (n + x * m) * over_d
    wide = (1.0 + y) * share - density
    area = jnp.where(inner, narrow, wide)

    narrow = density * (y * y) * over_q * (0.5 * s * (n + m * (q + x * (1.0 + q))) * over_d + q * q * m * over)
    wide = q + q * q * y * over_q - s * (y + 0.5 - 0.5 * q * y * over_q) - inverse
    wide = 0.5 * s * (1.0 + y) * (1.0 + y) * share + density * wide
    return Arc(chord, slope, bend, share, area, jnp.where(inner, narrow, wide), density)
