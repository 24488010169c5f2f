"""The worn ring: its outer radius, Eq. (26), and the solver for places y in the ring."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, ArrayLike
from plgwear_jax._core.formula import formula
from plgwear_jax._core.xla import separate_kernels
from plgwear_jax.special.arcsine import Arc, arc
from plgwear_jax.special.elementary import (
    clamp_keep_slope,
    exponentials,
    exponents,
    log_complement,
    quotient,
    reciprocal,
    value_with_slope,
    working_digits,
)

from .stick import slip, stick_power

# With G(y) = s L(y), the outer edge of the ring is the root of G(y) = m, which is Eq. (26) divided by c^2/(2s). The
# place of the largest wear depth is a root of the same kind. Both take one or two Halley steps from a fitted start.


class Rise(NamedTuple):
    """A function of y that rises from 0 to infinity."""

    chord: Array  # the function over y
    slope: Array
    bend: Array  # y times its second derivative


class Root(NamedTuple):
    """An equation for a place y in the worn ring, rise(y) = load."""

    rise: Callable[[Array, Array, Array, int | None], Rise | Arc]  # of (y, s, q, digits)
    load: Callable[[Array, Array, Array], Array]  # of (s, q, phi)
    starter: Callable[[Array, Array, Array], Array]
    digits: tuple[int, int]  # correct digits of y, from the starter and after one Halley step


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 4, 5))
def _solve(root: Root, s: Array, q: Array, phi: Array, digits: int | None, root_digits: int | None) -> Array:
    """The root y for phi > 0, correct to `root_digits`, by default to `digits`; its derivatives always to `digits`."""
    root_digits = root_digits or working_digits(digits, s.dtype)
    few, some = root.digits
    y = root.starter(s, q, phi)
    # Each step is a kernel of its own: its last operation is a division, and `separate_kernels` follows.
    if root_digits > few:
        s, q, phi, y = separate_kernels(3, s, q, phi, y)
        y = _halley(y, root.load(s, q, phi), root.rise(y, s, q, min(root_digits, some) - 1))
    if root_digits > some:
        s, q, phi, y = separate_kernels(4, s, q, phi, y)
        y = _halley(y, root.load(s, q, phi), root.rise(y, s, q, digits))
    return y


def _halley(y: Array, load: Array, at: Rise | Arc) -> Array:
    residual = relative_residual(y, load, at)
    denominator = at.slope * at.slope + 0.5 * at.bend * residual
    return (denominator + at.slope * residual) / (denominator * reciprocal(y))


def relative_residual(y: Array, load: Array, at: Rise | Arc) -> Array:
    """(load - rise(y))/y; divided by y, since squares of load - rise(y) would underflow."""
    return quotient(load, y) - at.chord


@_solve.defjvp
def _solve_jvp(root: Root, digits: int | None, root_digits: int | None, primals, tangents):
    y = place_of(root, *primals, digits, None)
    # The differential of rise(y) = load: rise_y dy + rise_s ds + rise_q dq = dload.
    _, dload = jax.jvp(root.load, primals, tangents)
    at, by_shape = jax.jvp(lambda s, q: root.rise(y, s, q, digits), primals[:2], tangents[:2])
    return y, (dload - y * by_shape.chord) * reciprocal(at.slope)


# Under `jit`, so that it is traced once for a value and its slopes.
place_of = jax.jit(_solve, static_argnums=(0, 4, 5))


def _ring_starter(s: Array, q: Array, phi: Array) -> Array:
    """An approximation of the root of G(y) = m, off by 0.5 % at the worst.

    y = m (1+q + q^2 w (1 - (1-phi)^s)/s) is exact with w = 1 as phi -> 1, and with w = (1+q)/((1+s) (2+q)) to second
    order as phi -> 0; in between `tools/ring_starter.py` fits w.
    """
    few = 2
    lost = -exponentials(s * log_complement(phi, few), few)[1]
    v = 1.0 - abs(jnp.sqrt(1.0 - phi))
    a, b, c, d, e, f, g, h = _WAY
    way = v * ((a + b * s) + lost * (c + d * s) + v * ((e + f * s) + lost * (g + h * s)))
    narrow = (1.0 + q) * reciprocal((1.0 + s) * (2.0 + q))
    share = 1.0 + q + q * q * lost * reciprocal(s) * (narrow + (1.0 - narrow) * way)
    return phi * share / ((1.0 - phi) * (1.0 + s))


_WAY = (0.4291, 0.5202, -1.0660, 2.5157, 0.7306, -2.2103, 0.9381, -0.9564)
EDGE = Root(arc, lambda s, q, phi: slip(s, phi), _ring_starter, (2, 8))


def ring_edge(s: Array, q: Array, phi: Array, digits: int | None, root_digits: int | None = None) -> Array:
    """y_inf = (a_inf/c)^2 - 1 for phi > 0, the outer edge of the worn ring, correct to `root_digits` or to `digits`."""
    return place_of(EDGE, s, q, phi, digits, root_digits)


def _narrow(phi: Array) -> Array:
    """An amplitude at which 1/y is finite, where phi is smaller; the slopes at phi = 0 are those of narrow rings."""
    return clamp_keep_slope(8.0 * float(jnp.finfo(phi.dtype).tiny), phi)


def place_in_ring(
    root: Root, k: Array, phi: Array, digits: int | None, copy: int, few: bool = False
) -> tuple[Array, Array, Array, Array]:
    """(Whether there is a worn ring, k, phi, the place y), the last three for a kernel of their own.

    y has the digits that are enough for a result whose error is the square of the error of y, or for `few` those of the
    starter.
    """
    start = root.digits[0]
    root_digits = start if few else max(start + 1, working_digits(digits, k.dtype) // 2)
    worn, phi = phi > 0.0, _narrow(phi)
    y = place_of(root, *exponents(k), phi, digits, root_digits)
    return worn, *separate_kernels(copy, k, phi, y)  # pyright: ignore[reportReturnType]


# Volume and largest depth do not change with y at the place where they are read.


def stationary(root: Root, function: Callable[..., Array], k: Any, phi: Any, digits: int | None, few: int) -> Array:
    """What a function of (y, s, q, phi, digits, second) gives at the place y.

    Up to `few` digits its `second` order correction of a y from the starter is cheaper than a Halley step.
    """
    second = working_digits(digits, k.dtype) <= few
    worn, k, phi, y = place_in_ring(root, k, phi, digits, copy=0, few=second)
    return jnp.where(worn, function(y, *exponents(k), phi, digits, second=second), 0.0)


def stationary_and_by_k(
    root: Root, function: Callable[..., Array], k: Array, phi: Array, digits: int | None
) -> tuple[Array, Array]:
    """(The same, its derivative by k), at a constant y."""
    worn, k, phi, y = place_in_ring(root, k, phi, digits, copy=1)
    value, slope = value_with_slope(lambda k: function(y, *exponents(k), phi, digits, second=True), k)
    return jnp.where(worn, value, 0.0), jnp.where(worn, slope, 0.0)


@formula(joint=("k",), k=EXPONENT, phi=AMPLITUDE)
def worn_radius(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Outer radius a_inf of the worn ring, where the worn profile meets the initial one, Eq. (26).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        a_inf in units of a_0, broadcast over k and phi, at least 1; 1 at phi = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting
        >>> print(f"{fretting.worn_radius(0.3, 0.4):.6f}")
        1.068055

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (26).
    """
    s, q = exponents(k)
    phi = _narrow(jnp.asarray(phi))
    return clamp_keep_slope(1.0, stick_power(s, phi, 1.0, digits) * jnp.sqrt(1.0 + ring_edge(s, q, phi, digits)))
