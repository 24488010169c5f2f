"""The tail of the generalised arcsine law and its moments: the one special function of the fretting problem.

    Q(y; s) = sin(pi s)/pi * integral from 0 to y of v^-s/(1+v) dv = 1 - I_t(s, 1-s),      t = 1/(1+y)

Every incomplete beta function of Eqs. (3), (14), (18) and (24) is a combination of it and its moments. All forms below
are sums that neither cancel nor divide by zero for s in (0, 1), so automatic differentiation keeps their digits.
Both s and q = 1 - s are passed, since 1 - s would lose the digits of the smaller one.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.special.elementary import expm1, exponential_quotient, finite_log, sinc_deficit, sine_quotient
from plgwear_jax.special.lerch import alternating_lerch, lerch_difference

__all__ = ["Fold", "Moments", "arcsine_body_moment", "arcsine_moments", "arcsine_tail", "fold", "over_abscissa"]


class Fold(NamedTuple):
    """An abscissa y > 0 as x = min(y, 1/y): the argument in which every series here converges alike."""

    x: Array  # in [0, 1]
    log_x: Array
    inner: Array  # True where x is y, False where it is 1/y


def fold(y: Array) -> Fold:
    """Fold y >= 0 at y = 1."""
    inner = y <= 1.0
    x = jnp.where(inner, y, 1.0 / jnp.where(inner, 1.0, y))
    # From y itself: near y = 1 the rounding of 1/y would be all there is of its logarithm.
    return Fold(x, -jnp.abs(finite_log(y)), inner)


def over_abscissa(value: Array, y: Fold) -> Array:
    """value/y."""
    return jnp.where(y.inner, value / jnp.where(y.inner, y.x, 1.0), value * y.x)


class Moments(NamedTuple):
    """Combinations of S_j = y^-(j+q) * integral from 0 to y of v^(j-s)/(1+v) dv, finite at y = 0 and as q -> 0."""

    power: Array  # y^q
    qs_0: Array  # q S_0
    qs_1: Array  # q S_1
    qs_2: Array  # q S_2
    fall: Array  # q (S_0 - S_1)
    bend: Array  # q^2 y (S_1 - S_2)


class _Terms(NamedTuple):
    """What the tail and the displacements share."""

    p: Array  # q for y <= 1, s for y > 1
    quotient: Array  # sin(pi s)/(pi s q)
    power: Array  # x^p
    series: Array  # sin(pi s)/pi x^p Phi_1(x; 1+p)


def _terms(y: Fold, s: Array, q: Array, digits: int | None) -> _Terms:
    p = jnp.where(y.inner, q, s)
    quotient = sine_quotient(s, digits)
    power = jnp.exp(p * y.log_x)
    return _Terms(p, quotient, power, s * q * quotient * power * alternating_lerch(y.x, 1.0 + p, 1, digits))


def _tail(y: Fold, s: Array, q: Array, terms: _Terms, digits: int | None) -> tuple[Array, Array]:
    p, quotient, power, series = terms
    rest = y.x * series
    # Q(y; s) = 1 - Q(1/y; 1-s): what is small for y <= 1 is the other one for y > 1.
    near = jnp.where(y.inner, s, q) * quotient * power - rest
    far = -expm1(p * y.log_x) + p * p * sinc_deficit(p, digits) * power + rest
    return jnp.where(y.inner, near, far), jnp.where(y.inner, far, near)


@functools.partial(jax.jit, static_argnames="digits")
def arcsine_tail(y: Fold, s: Array, q: Array, digits: int | None = None) -> tuple[Array, Array]:
    """(Q, 1 - Q) at y, both to full relative accuracy, also where they are small."""
    return _tail(y, s, q, _terms(y, s, q, digits), digits)


@functools.partial(jax.jit, static_argnames="digits")
def arcsine_body_moment(y: Fold, s: Array, q: Array, digits: int | None = None) -> tuple[Array, Array]:
    """(1 - Q, sin(pi s)/pi y^-s T_1(1/y)), the two functions of a displacement beside the contact.

    T_1(x) = sum of (-1)^n x^n/(n+1+s); the second one is y times (sin(pi s)/(pi s) y^-s - (1 - Q)).
    """
    x, log_x, inner = y
    terms = _terms(y, s, q, digits)
    tail, body = _tail(y, s, q, terms, digits)
    # For s -> 0 both terms of the difference tend to one: then from Q and what they differ by from one.
    log_y = jnp.where(inner, log_x, 0.0)
    small = x * (tail + expm1(-s * log_y) - s * s * sinc_deficit(s, digits) * jnp.exp(-s * log_y))
    difference = jnp.where(s < 0.5, small, q * terms.quotient * terms.power - x * body)
    return body, jnp.where(inner, difference, terms.series)


@functools.partial(jax.jit, static_argnames="digits")
def arcsine_moments(y: Fold, s: Array, q: Array, digits: int | None = None) -> Moments:
    """The moments S_0, S_1, S_2 of the arcsine density at y, from one series and S_j + y S_(j+1) = 1/(j+q).

    The differences are as accurate as the moments: the wear volume is small in them where the ring is narrow.
    """
    x, log_x, inner = y
    power_x = jnp.where(x > 0.0, jnp.exp(jnp.where(inner, q, s) * log_x), 0.0)
    series = lerch_difference(x, 1.0 + jnp.where(inner, q, s), 1, digits)

    # y <= 1: the series is S_1 - S_2.
    bend = q * q * x * series
    s_2 = (1.0 / (1.0 + q) - series) / (1.0 + x)
    qs_1 = q * (s_2 + series)
    inside = Moments(power_x, 1.0 - x * qs_1, qs_1, q * s_2, 1.0 / (1.0 + q) - q * x * series, bend)

    # y > 1: q y^q S_0 = from_log + q x^(1+s) T_1, and the series is T_1 - T_2 with T_1 + x T_2 = 1/(1+s).
    power_x = jnp.where(inner, 1.0, power_x)
    safe_x = jnp.where(inner, 1.0, x)
    quotient = sine_quotient(s, digits)
    log_y = -jnp.where(inner, 0.0, log_x)
    from_log = (exponential_quotient(-s, log_y) + s * sinc_deficit(s, digits) * power_x) / quotient
    from_log = from_log / power_x  # everything below is over x^s = y^q/y
    t_1 = (1.0 / (1.0 + s) + safe_x * series) / (1.0 + safe_x)
    qs_0 = safe_x * (from_log + q * safe_x * t_1)
    fall = (safe_x + safe_x * safe_x) * from_log + safe_x * safe_x * (q / (1.0 + s) + q * safe_x * series) - safe_x
    qs_1 = qs_0 - fall
    qs_2 = safe_x * (q / (1.0 + q) - qs_1)
    bend = q * (1.0 / (1.0 + q) - fall)
    outside = Moments(power_x / safe_x, qs_0, qs_1, qs_2, fall, bend)
    return Moments(*(jnp.where(inner, a, b) for a, b in zip(inside, outside, strict=True)))
