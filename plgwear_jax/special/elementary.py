"""Elementary functions in forms that stay exact where the textbook form cancels."""

import functools
import math

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import DTypeLike

__all__ = [
    "expm1",
    "exponential_moment",
    "exponential_quotient",
    "finite_log",
    "leading",
    "log_complement",
    "polynomial",
    "sinc_deficit",
    "sinc_quotient",
    "sine_quotient",
    "working_digits",
]


def working_digits(digits: int | None, dtype: DTypeLike) -> int:
    """The digits a sum aims at: those asked for and one to spare, or what the dtype can hold at all."""
    most = int(jnp.finfo(dtype).precision) + 2
    return most if digits is None else min(digits + 1, most)


def leading(coefficients: tuple[float, ...], digits: int | None, dtype: DTypeLike) -> tuple[float, ...]:
    """The coefficients of a power series on abs(x) <= 1 that `digits` need, for two derivatives as well."""
    allowed = 0.1 ** working_digits(digits, dtype)
    rest = 0.0
    for n in range(len(coefficients) - 1, 0, -1):
        rest += n * n * abs(coefficients[n])
        if rest > allowed:
            return coefficients[: n + 1]
    return coefficients[:1]


def polynomial(coefficients: tuple[float, ...], x: Array, digits: int | None = None) -> Array:
    """Horner's rule for the sum of coefficients[n] x^n on abs(x) <= 1."""
    kept = leading(coefficients, digits, x.dtype)
    total = jnp.full_like(x, kept[-1])
    for coefficient in reversed(kept[:-1]):
        total = total * x + coefficient
    return total


def finite_log(x: Array) -> Array:
    """log(x) whose value and derivatives stay finite at x = 0, where every term it enters vanishes."""
    tiny = jnp.finfo(x.dtype).tiny
    normal = x > tiny
    return jnp.where(normal, jnp.log(jnp.where(normal, x, 1.0)), jnp.log(tiny).astype(x.dtype))


@jax.custom_jvp
def expm1(x: Array) -> Array:
    """exp(x) - 1, whose derivative is exp(x) to full relative accuracy also where x is very negative."""
    return jnp.expm1(x)


@expm1.defjvp
def _expm1_jvp(primals, tangents):
    (x,), (dx,) = primals, tangents
    return expm1(x), jnp.exp(x) * dx


_SINC = tuple((-1) ** j * math.pi ** (2 * j) / math.factorial(2 * j + 1) for j in range(32))
_SINC_DEFICIT = tuple(-c for c in _SINC[1:20])
# All terms sum to sin(pi) = 0, so a partial sum is minus its tail, which does not cancel.
_SINC_QUOTIENT = tuple(-math.fsum(_SINC[n + 1 :]) for n in range(19))


@functools.partial(jax.jit, static_argnames="digits")
def sinc_quotient(square: Array, digits: int | None = None) -> Array:
    """sin(pi x)/(pi x (1 - x^2)) as a function of x^2 = square in [0, 1]."""
    return polynomial(_SINC_QUOTIENT, square, digits)


def sine_quotient(s: Array, digits: int | None = None) -> Array:
    """sin(pi s)/(pi s (1-s)) for s in [0, 1]: between 1, at both ends, and 4/pi."""
    return (1.0 + s) * sinc_quotient(s * s, digits)


@functools.partial(jax.jit, static_argnames="digits")
def sinc_deficit(p: Array, digits: int | None = None) -> Array:
    """(1 - sin(pi p)/(pi p)) / p^2 for p in [0, 1]."""
    return polynomial(_SINC_DEFICIT, p * p, digits)


@jax.custom_jvp
def log_complement(phi: Array) -> Array:
    """log(1 - phi) for 0 <= phi < 1, to an ulp or two (XLA's log1p loses two digits near phi = 0.41)."""
    near = phi < 0.25
    z = jnp.where(near, phi / (2.0 - phi), 0.0)
    series = polynomial(tuple(1.0 / (2 * n + 1) for n in range(10)), z * z)
    return jnp.where(near, -2.0 * z * series, jnp.log(1.0 - phi))


@log_complement.defjvp
def _log_complement_jvp(primals, tangents):
    (phi,), (dphi,) = primals, tangents
    return log_complement(phi), -dphi / (1.0 - phi)


@functools.partial(jax.custom_jvp, nondiff_argnums=(1,))
def exponential_moment(x: Array, order: int = 0) -> Array:
    """Integral over tau in [0, 1] of tau^order exp(tau x); order 0 is expm1(x)/x. Entire in x."""
    small = jnp.abs(x) < 2.0
    safe = jnp.where(small, 2.0, x)
    if order == 0:
        nonzero = jnp.where(x == 0.0, 1.0, x)
        return jnp.where(x == 0.0, 1.0, jnp.expm1(nonzero) / nonzero)
    moment = jnp.expm1(safe) / safe
    for m in range(1, order + 1):
        moment = (jnp.exp(safe) - m * moment) / safe
    taylor = tuple(2.0**n / (math.factorial(n) * (n + order + 1)) for n in range(31))
    return jnp.where(small, polynomial(taylor, 0.5 * jnp.where(small, x, 0.0)), moment)


@exponential_moment.defjvp
def _exponential_moment_jvp(order: int, primals, tangents):
    (x,), (dx,) = primals, tangents
    return exponential_moment(x, order), exponential_moment(x, order + 1) * dx


@jax.custom_jvp
def exponential_quotient(e: Array, log: Array) -> Array:
    """expm1(e log)/e = (x^e - 1)/e for log = log(x), which is log(x) itself at e = 0. Entire in both."""
    return log * exponential_moment(e * log)


@exponential_quotient.defjvp
def _exponential_quotient_jvp(primals, tangents):
    (e, log), (de, dlog) = primals, tangents
    by_e = log * log * exponential_moment(e * log, 1)
    return exponential_quotient(e, log), by_e * de + jnp.exp(e * log) * dlog
