"""Elementary functions in forms that keep their digits where the textbook form cancels."""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax
from jax.typing import DTypeLike

from plgwear_jax._core.xla import kept_in_register

with_digits = functools.partial(jax.jit, static_argnames="digits")


def exponents(k: Any) -> tuple[Array, Array]:
    """(s, q) = ((1+k)/2, (1-k)/2), each to full relative accuracy also where it is small."""
    k = jnp.asarray(k)
    return 0.5 * (1.0 + k), 0.5 * (1.0 - k)


def in_dtype(dtype: DTypeLike, *values: Any) -> list[Array]:
    """The values as arrays of a dtype."""
    return [jnp.asarray(value, dtype) for value in values]


def namespace(*arrays: Any) -> Any:
    """`numpy` if all arrays (or numbers) are of NumPy, else `jax.numpy`."""
    return jnp if any(isinstance(array, Array) for array in arrays) else np


def working_digits(digits: int | None, dtype: DTypeLike) -> int:
    """The number of digits to which a sum is computed: one more than asked for, at most all that the dtype holds."""
    most = int(jnp.finfo(dtype).precision) + 2
    return most if digits is None else min(digits + 1, most)


def leading(coefficients: tuple[float, ...], digits: int | None, dtype: DTypeLike) -> tuple[float, ...]:
    """The first coefficients of a power series on abs(x) <= 1: enough for `digits` of its value and two derivatives."""
    allowed = 0.1 ** working_digits(digits, dtype)
    rest = 0.0
    for n in range(len(coefficients) - 1, 0, -1):
        rest += n * n * abs(coefficients[n])
        if rest > allowed:
            return coefficients[: n + 1]
    return coefficients[:1]


def polynomial(coefficients: tuple[float, ...], x: Array, digits: int | None = None) -> Array:
    """The sum of coefficients[n] x^n on abs(x) <= 1, by Estrin's rule, whose pairs a processor adds in parallel."""
    terms: list[Any] = list(leading(coefficients, digits, x.dtype))
    power = x
    while len(terms) > 1:
        paired = [terms[n] + power * terms[n + 1] for n in range(0, len(terms) - 1, 2)]
        terms = [*paired, *terms[2 * len(paired) :]]
        power = power * power
    return terms[0] + 0.0 * x if isinstance(terms[0], float) else terms[0]


# --- bounds ---------------------------------------------------------------------------------------------------------


def clamp_keep_slope(least: float | Array, value: Array) -> Array:
    """max(value, least) for a value that only rounding can bring below `least`, with the derivatives of the value.

    The slope of `jnp.maximum` would be half of it at the bound, and zero wherever rounding goes below the bound.
    """
    return value + lax.stop_gradient(jnp.maximum(least - value, 0.0))


def clamped(least: Any, value: Array, most: float = math.inf) -> Array:
    """The value between two numbers, as `jnp.clip`, whose derivatives are a large program: they are half at a bound."""
    return lax.clamp(value.dtype.type(least), value, value.dtype.type(most))


def crest(values: Array) -> Array:
    """The largest of values at even distances along the first axis, by the parabola through it and its neighbours."""
    most = jnp.argmax(values, 0)
    inner = clamped(1, most, values.shape[0] - 2)
    before, at, after = (jnp.take_along_axis(values, (inner + i)[None], 0)[0] for i in (-1, 0, 1))
    bend = before - 2.0 * at + after
    top = at - (after - before) ** 2 / (8.0 * jnp.where(bend < 0.0, bend, -1.0))
    return jnp.where((most == inner) & (bend < 0.0), top, jnp.max(values, 0))


def top_of(x: Array, values: Array) -> Array:
    """Where the parabola through the largest of values at increasing x, shape (n,), and both beside it has its top.

    It lies between these two; where places or values are no numbers or the same, it is the one in the middle.
    """
    before = clamped(0, jnp.argmax(values) - 1, x.size - 3)
    (a, b, c), (low, at, high) = (lax.dynamic_slice(each, (before,), (3,)) for each in (x, values))
    left, right = (at - low) / (b - a), (high - at) / (c - b)
    bend = (right - left) / (c - a)
    top = 0.5 * (a + b) - 0.5 * left / jnp.where(bend < 0.0, bend, -1.0)
    return jnp.where(jnp.isnan(top), b, jnp.clip(top, a, c))


def value_with_slope(function: Any, x: Array) -> tuple[Any, Any]:
    """A function of each element of x, and its slopes there."""
    return jax.jvp(function, (x,), (jnp.ones_like(x),))


def squares_apart(a: Array, b: Array, c: Array) -> Array:
    """(a^2 - b^2)/c^2, where the squares would cancel or overflow."""
    return ((a - b) / c) * ((a + b) / c)


# --- quotients ------------------------------------------------------------------------------------------------------


def ratio_where(some: Any, above: Any, below: Array, other: Any = 0.0) -> Array:
    """above/below where it is wanted, else the other value; derivatives are finite too where `below` is 0 there."""
    return jnp.where(some, above / jnp.where(some, below, 1.0), other)


def power_where(some: Any, base: Array, exponent: Array) -> Array:
    """base^exponent where it is wanted, which is at positive numbers, else 0; derivatives are finite everywhere."""
    return jnp.where(some, jnp.exp(exponent * jnp.log(jnp.where(some, base, 1.0))), 0.0)


# Quotients are kept in registers instead of memory: this halves the time of all functions that use them.


def reciprocal(x: Array) -> Array:
    """1/x for x > 0."""
    return quotient(np.ones((), x.dtype), x)


def moves_by(change: Callable[..., Any], *static: int) -> Callable[[Callable[..., Any]], Any]:
    """Give a function a rule for derivatives: how it moves, from its value, its arguments and how these move."""

    def decorate(function: Callable[..., Any]) -> Any:
        ruled = jax.custom_jvp(function, nondiff_argnums=static)

        def rule(*given: Any) -> tuple[Any, Any]:
            *words, primals, tangents = given
            value = ruled(*primals, *words)
            return value, change(value, *primals, *tangents)

        ruled.defjvp(rule)
        return ruled

    return decorate


def _of_ratio(value: Array, _: Any, b: Array, da: Any, db: Array) -> Array:
    return _over(da - value * db, b)


@moves_by(_of_ratio)
def quotient(a: Any, b: Array) -> Array:
    """a/b for a >= 0, b > 0."""
    return kept_in_register(a / b)


@moves_by(_of_ratio)
def _over(a: Array, b: Array) -> Array:
    """a/b for b > 0, with derivatives by repeated division by b, since powers of b would underflow."""
    return a * reciprocal(b)


# --- logarithms and exponentials ------------------------------------------------------------------------------------

# On processors XLA calls the C library for each logarithm in float64 (4 ns); its log1p takes 33 ns and loses two digits
# near -0.41; neither becomes faster with fewer digits. The functions here take 1.5 ns or less, to an ulp or two.


def _exponent_and_mantissa(x: Any) -> tuple[Any, Any]:
    """(e, m) with x = 2^e m and m in [sqrt(1/2), sqrt(2)), for normal x > 0."""
    bits, mantissa = _layout(x.dtype)
    lowest = np.asarray(math.sqrt(0.5), x.dtype).view(bits)
    pattern = lax.bitcast_convert_type(x, bits)
    e = lax.shift_right_arithmetic(lax.sub(pattern, lowest), bits(mantissa))
    m = lax.bitcast_convert_type(lax.sub(pattern, lax.shift_left(e, bits(mantissa))), x.dtype)
    return lax.convert_element_type(lax.convert_element_type(e, np.int32), x.dtype), m


def _layout(dtype: DTypeLike) -> tuple[Any, int]:
    """(The integer type as wide as the dtype, the number of bits of its mantissa)."""
    return (np.int64, 52) if jnp.dtype(dtype) == jnp.float64 else (np.int32, 23)


# log(2) in two parts, the first one short enough for exact products with an exponent.
_LOG_2_HEAD = {np.dtype(t): float.fromhex(x) for t, x in (("float64", "0x1.62e42feep-1"), ("float32", "0x1.62e3p-1"))}
_LOG_2_REST = {dtype: math.log(2.0) - head + 2.3190468138462996e-17 for dtype, head in _LOG_2_HEAD.items()}
_ARTANH = tuple(2.0 / (2 * n + 1) for n in range(14))
_SQUARE = (math.sqrt(2.0) - 1.0) ** 4  # square of the largest argument z of artanh
_ARTANH_TAIL = tuple(c * _SQUARE**n for n, c in enumerate(_ARTANH[1:]))


def _log_of_parts(e: Array, excess: Array, digits: int | None) -> Array:
    """log(2^e (1 + excess)) by 2 artanh(z), z = excess/(2 + excess)."""
    z = excess * reciprocal(2.0 + excess)
    square = z * z
    tail = z * square * polynomial(_ARTANH_TAIL, square * (1.0 / _SQUARE), digits)
    return (tail + _LOG_2_REST[e.dtype] * e) + 2.0 * z + _LOG_2_HEAD[e.dtype] * e


@moves_by(lambda _, x, dx: _over(dx, x), 1)
def log(x: Array, digits: int | None = None) -> Array:
    """The natural logarithm of normal numbers x > 0."""
    e, m = _exponent_and_mantissa(x)
    return _log_of_parts(e, m - 1.0, digits)


@moves_by(lambda _, phi, dphi: _over(-dphi, 1.0 - phi), 1)
def log_complement(phi: Array, digits: int | None = None) -> Array:
    """log(1 - phi) for phi < 1, to full relative accuracy for small phi of either sign."""
    e, m = _exponent_and_mantissa(1.0 - phi)
    return _log_of_parts(e, jnp.where(abs(e) < 0.5, -phi, m - 1.0), digits)


_EXPONENTIAL = tuple((0.5 * math.log(2.0)) ** n / math.factorial(n + 2) for n in range(16))


@moves_by(lambda value, _, dx: (value[0] * dx, value[0] * dx), 1)
def exponentials(x: Array, digits: int | None) -> tuple[Array, Array]:
    """(exp(x), exp(x) - 1), both to full relative accuracy, as long as exp(x) is a normal number."""
    limits = jnp.finfo(x.dtype)
    n = lax.round(x * (1.0 / math.log(2.0)), lax.RoundingMethod.TO_NEAREST_EVEN)
    r = (x - _LOG_2_HEAD[x.dtype] * n) - _LOG_2_REST[x.dtype] * n
    less_one = r + r * r * polynomial(_EXPONENTIAL, r * (2.0 / math.log(2.0)), digits)
    bits, mantissa = _layout(x.dtype)
    bounded = lax.max(n, x.dtype.type(limits.minexp))
    biased = lax.sub(lax.convert_element_type(bounded, np.int32), np.int32(limits.minexp - 1))
    pattern = lax.shift_left(lax.convert_element_type(biased, bits), bits(mantissa))
    power = lax.bitcast_convert_type(pattern, x.dtype)
    scaled = power * less_one
    return power + scaled, scaled + (power - 1.0)


TINY = 1e-30
_GROWTH_SLOPE = tuple(1.0 / (math.factorial(n) * (n + 2)) for n in range(19))  # of the integral of u exp(u x), u < 1


def _growth_change(value, less_one, over, p, log_x, _, __, dp, dlog_x):
    exponent = p * log_x
    small = jnp.abs(exponent) < 1.0
    # -d/dp is log(x)^2 times the integral of u x^(p u) over u from 0 to 1.
    fall = log_x * log_x * polynomial(_GROWTH_SLOPE, jnp.where(small, exponent, 0.0))
    fall = jnp.where(small, fall, jnp.abs(log_x * (1.0 + less_one) + value) * over)
    return -fall * dp - (1.0 + less_one) * dlog_x


@moves_by(_growth_change)
def growth(less_one: Array, over: Array, p: Array, log_x: Array) -> Array:
    """(1 - x^p)/p for x < 1, which is -log(x) at p = 0, from x^p - 1 and 1/abs(p)."""
    return jnp.where(jnp.abs(p) < TINY, -log_x, jnp.abs(less_one) * over)


# --- sines ----------------------------------------------------------------------------------------------------------


def _tails(terms: Sequence[float]) -> tuple[float, ...]:
    """Coefficients of (sum of terms[n] z^n)/(1 - z), if the terms sum to zero: -(terms[n+1] + terms[n+2] + ...)."""
    return tuple(-math.fsum(terms[n + 1 :]) for n in range(len(terms) - 1))


_SINC = tuple((-1) ** j * math.pi ** (2 * j) / math.factorial(2 * j + 1) for j in range(32))
_SINC_QUOTIENT = _tails(_SINC)[:19]


@with_digits
def sinc_quotient(square: Array, digits: int | None) -> Array:
    """sin(pi x)/(pi x (1 - x^2)) as a function of x^2 = square in [0, 1]."""
    return polynomial(_SINC_QUOTIENT, square, digits)


_COSINE = tuple((-1) ** n * (0.5 * math.pi) ** (2 * n) / math.factorial(2 * n) for n in range(24))
_SINE_QUOTIENT = tuple(4.0 / math.pi * c for c in _tails(_COSINE))
_SINE_EXCESS = tuple(4.0 * c for c in _tails((_SINE_QUOTIENT[0] - 1.0, *_SINE_QUOTIENT[1:])))[:16]


def sine_excess(s: Array, q: Array, digits: int | None) -> Array:
    """(sin(pi s)/(pi s q) - 1)/(s q) for q = 1 - s in [0, 1]: between 1, at both ends, and 16/pi - 4."""
    return polynomial(_SINE_EXCESS, (q - s) * (q - s), digits)


def sine_quotient(s: Array, q: Array, digits: int | None = None) -> Array:
    """sin(pi s)/(pi s q) for q = 1 - s in [0, 1]: between 1, at both ends, and 4/pi."""
    return 1.0 + s * q * sine_excess(s, q, digits)


# --- stresses beside an edge ----------------------------------------------------------------------------------------


def log_beside_edge(r: Array, c: Array) -> Array:
    """log(1 - (r/c)^2) for r < c."""
    # Near the centre the slopes of 1 - r/c and 1 + r/c cancel, and 1 - (r/c)^2 rounds away what is less than 1.
    central = r < 0.5 * c
    near = log_complement(jnp.where(central, r / c, 0.0) ** 2)
    return jnp.where(central, near, jnp.log(jnp.where(central, 1.0, squares_apart(c, r, c))))


def punch_stress(r: Any, c: Array, s: Array, q: Array, *, smooth: Array, singular: Array) -> Array:
    """(smooth z^s + singular z^-q)/c^2 for r < c, z = 1 - (r/c)^2; zero outside, infinite at r = c if singular > 0."""
    under = r < c
    log_z = log_beside_edge(jnp.where(under, r, 0.0), c)
    stress = (smooth * jnp.exp(s * log_z) + singular * jnp.exp(-q * log_z)) / (c * c)
    return jnp.where(under, stress, jnp.where((r == c) & (singular > 0.0), jnp.inf, 0.0))
