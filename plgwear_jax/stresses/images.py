"""Hankel integrals of axisymmetric tractions over exp(-q zeta), in closed form, and responses as sums of these.

A traction t(r) is a sum of (b^2 - r^2)^(n - 1/2), each up to its radius b: what lies in a strip across it, P(t) in
t^(q) = integral of P(t) cos(q t) dt, is then a sum of (b^2 - t^2)^n, a quadratic spline of t^2.
"""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax
from jax.custom_derivatives import SymbolicZero

# --- tractions --------------------------------------------------------------------------------------------------------


class Tractions(NamedTuple):
    """Sums of tractions with P(t) = (b^2 - t^2)^n where t < b."""

    near: int  # of the last radii, where n = 1; else it is 2
    b: Array  # (edges, radii)
    weight: Array  # (edges, radii, tractions)
    flat: Array | None  # of n = 0, (edges, tractions)


@functools.cache
def strips(radii: int, near: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(Radii b, 1 - t^2 where P is asked, what makes of P the weights of these and of n = 0), in units of the radius.

    P is the spline of least squares. It is linear between the last radii, where the weights of parabolas would be so
    large that roundings are felt.
    """
    grade = min(4.0, 10.4 / np.log(radii))  # so that both are dense at the edge
    left, below = ((np.arange(3 * radii) + 0.5) / (3 * radii)) ** grade, (np.arange(radii)[::-1] / radii) ** grade
    inside = left * (2.0 - left)  # left is 1 - t, and below 1 - b
    every = np.maximum(inside[:, None] - np.append(below * (2.0 - below), -1.0), 0.0)
    every[:, : radii - near] **= 2
    every[:, radii] = 1.0
    felt = left[:, None] ** 0.3  # of a pressure that is infinite at the edge
    fit = np.linalg.pinv(felt * every) * felt.T
    return 1.0 - below, inside, fit + (np.eye(radii + 1) - fit @ every) @ fit


def transforms(tractions: Tractions, zeta: Array, x: Array) -> Array:
    """The integrals of q t^(q) exp(-q zeta) J_i(q x) dq for i < 4, and those with another factor q.

    Args:
        tractions: The tractions, with their transforms t^(q), the integrals of t J_0(q r) r dr.
        zeta: Depths > 0, (places,).
        x: Distances from the axis, >= 0, (places,).

    Returns:
        An array of shape (2, 4, places, tractions).
    """
    near, b, weight, flat = tractions
    found = _of_bowls(near, b, weight, zeta, x)
    if flat is None:
        return found
    wave, rate, *_ = _waves(b[:, -1], zeta[:, None], x[:, None])
    return found + jnp.stack([-wave.imag, rate.imag])[:, :4] @ flat


def _waves(b: Array, zeta: Array, x: Array) -> tuple[Array, Array, Array, Array]:
    """(G_i = e^i/D for i < 5 with Z = zeta + i b, D = (Z^2 + x^2)^(1/2), e = x/(D + Z), its slope by Z, Re e^i, T_i).

    G_i is the integral of exp(-q Z) J_i(q x) dq, and T_i that of its real part over b from 0. Shapes (5, places, n).
    """
    # The root by real numbers, so that none of its parts cancels.
    real, imaginary = (x - b) * (x + b) + zeta * zeta, 2.0 * zeta * b
    size = jnp.sqrt(real * real + imaginary * imaginary)
    larger = jnp.sqrt(0.5 * (size + abs(real)))
    smaller = 0.5 * imaginary / larger
    distance = lax.select(real > 0.0, lax.complex(larger, smaller), lax.complex(smaller, larger))
    depth = lax.complex(*jnp.broadcast_arrays(zeta, b))
    total, inverse = distance + depth, jnp.conj(distance) / size
    e = jnp.conj(total) * (x / (total.real**2 + total.imag**2))
    powers = jnp.stack([jnp.ones_like(e), e, e * e, e * e * e, (e * e) * (e * e)])
    over = jnp.append(jnp.arctan2(total.imag, total.real)[None], powers[1:].imag / -_ORDER[1:], 0)
    wave = powers * inverse
    return wave, -wave * (depth + _ORDER * distance) * (inverse * inverse), powers.real, over


_ORDER: Any = np.arange(5)[:, None, None]
_SIGN = 1 - 2 * (_ORDER > 0)


def _bowls(b: Array, zeta: Array, x: Array) -> list[list[Array]]:
    """The integrals for n = 0, 1 and 2, and those with one and, but for n = 0, with two factors q more, for i < 5."""
    zeta, x, square = zeta[:, None], x[:, None], 4.0 * b * b
    wave, rate, real, over = _waves(b, zeta, x)

    def turned(more: Array) -> Array:
        return x * jnp.concatenate([-more[1:2], more[:-1]]) - zeta * more

    # Each is a homogeneous function of lengths, of which `more` are the slopes; nothing has to cancel at the edge.
    first = 2.0 * (turned(over) + _SIGN * b * real) / (1 + _ORDER)
    more = (2 * (1 - _ORDER) * square * over + 12.0 * turned(first)) / (2 + _ORDER)
    second = (square * first + turned(more)) / (3 + _ORDER)
    flat, most = -wave.imag, 12.0 * first + 2.0 * square * wave.imag
    return [
        [flat, first, second],
        [rate.imag, 2.0 * (over - b * wave.real), more],
        [2.0 * (flat + b * rate.real), most],
    ]


def _total(near: int, first: Array, second: Array, weight: Array) -> Array:
    """The sum of integrals, those for n = 1 at the last radii."""
    within, shape = weight.shape[1] - near, (*first.shape[:2], *weight.shape[:2])
    first, second = first.reshape(shape), second.reshape(shape)
    each = jnp.concatenate([second[..., :within], first[..., within:]], -1)
    return each.reshape(*shape[:2], -1) @ weight.reshape(-1, weight.shape[-1])


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _of_bowls(near: int, b: Array, weight: Array, zeta: Array, x: Array) -> Array:
    found = _bowls(b.ravel(), zeta, x)[:2]
    return jnp.stack([_total(near, first[:4], second[:4], weight) for _, first, second in found])


def _of_bowls_jvp(near: int, primals: tuple[Array, ...], tangents: tuple[Array, ...]) -> tuple[Array, Array]:
    b, weight, zeta, x = primals
    value, more, most = _bowls(b.ravel(), zeta, x)

    def sums(rows: list[list[Array]], weight: Array) -> Array:
        return jnp.stack([_total(near, first, second, weight) for first, second in rows])

    found, steeper = sums([value[1:], more[1:]], weight), sums([more[1:], most], weight)
    by_b, by_weight, by_zeta, by_x = tangents
    along = jnp.zeros_like(found)
    if not isinstance(by_b, SymbolicZero):
        # The slope of (b^2 - t^2)^n is that with n - 1, times 2 n b.
        power = jnp.where(np.arange(b.shape[1]) < b.shape[1] - near, 4, 2)
        along += sums([value[:2], more[:2]], (power * b * by_b)[..., None] * weight)
    if not isinstance(by_weight, SymbolicZero):
        along += sums([value[1:], more[1:]], by_weight)
    if not isinstance(by_zeta, SymbolicZero):
        along -= steeper * by_zeta[:, None]
    if not isinstance(by_x, SymbolicZero):
        lower = jnp.concatenate([-steeper[:, 1:2], steeper], 1)
        along += 0.5 * (lower[:, :-1] - jnp.roll(steeper, -1, axis=1)) * by_x[:, None]
    return found[:, :4], along[:, :4]  # that for i = 4 is of no use


_of_bowls.defjvp(_of_bowls_jvp, symbolic_zeros=True)


# --- responses --------------------------------------------------------------------------------------------------------


class Grid(NamedTuple):
    """Wavenumbers, and the sum of exponentials of them that goes through values there, in units of the radius."""

    q: np.ndarray  # (n,)
    zeta: np.ndarray  # (m,)
    fit: np.ndarray  # (m, n)


@functools.cache
def grid(spacing: float, double: bool) -> Grid:
    """The exponentials exp(-q zeta): responses are analytic for Re q > 0, which makes few of them enough."""
    zeta, q = np.exp(np.arange(-11.5, 6.0, spacing)), np.exp(np.arange(-6.0, 11.6, 0.75 * spacing))
    felt = q / (1.0 + q)  # of an error at long waves little is felt
    # Larger weights would cancel in float32.
    fit = np.linalg.pinv(felt[:, None] * np.exp(-q[:, None] * zeta), rcond=1e-9 if double else 1e-5)
    return Grid(q, zeta, fit * felt)
