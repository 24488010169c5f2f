"""Hankel integrals of axisymmetric tractions over exp(-q zeta), in closed form, and responses as sums of these.

A traction t(r) is a sum of (b^2 - r^2)^(n - 1/2), each up to its radius b: what lies in a strip across it, P(t) in
t^(q) = integral of P(t) cos(q t) dt, is then a sum of (b^2 - t^2)^n, a quadratic spline of t^2.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax
from jax.custom_derivatives import SymbolicZero

# --- tractions --------------------------------------------------------------------------------------------------------


class Tractions(NamedTuple):
    """Sums of tractions with P(t) = (b^2 - t^2)^n where t < b, those with n < 2 at the edge, which is the last b."""

    b: Array  # (edges, radii)
    second: Array  # the weights of n = 2, (edges, radii, tractions)
    first: Array  # of n = 1 at the last radii, (edges, some, tractions)
    flat: Array | None  # of n = 0, (edges, tractions)


class Strips(NamedTuple):
    """Where P is asked, as shares of its radius, and what makes of it the spline, whose bends are dense at the edge."""

    b: np.ndarray  # (radii,)
    inside: np.ndarray  # 1 - t^2, (samples,)
    fit: np.ndarray  # the weights of n = 2 and one of n = 1, (radii + 1, samples)
    singular: np.ndarray  # of n = 2 at radii within, of n = 1 at NEAR ones and of n = 0, (radii + 1, samples)


_LEAST = 1.7e-4  # between radii: with less, weights are so large that roundings of far fields are felt
NEAR = 5  # radii at the edge, where a singular P is linear between them, for the same reason


@functools.cache
def strips(radii: int) -> Strips:
    """So many radii; the spline is that of least squares."""
    grade, samples = min(np.log(_LEAST) / np.log(1.0 / radii), 3.5), 3 * radii
    left, below = (np.arange(samples) + 0.5) / samples, np.arange(radii)[::-1] / radii
    left, below = left**grade, below**grade  # 1 - t and 1 - b
    inside = left * (2.0 - left)
    above = np.maximum(inside[:, None] - below * (2.0 - below), 0.0)
    every = above**2, above[:, -NEAR:], np.ones((samples, 1))
    felt = left[:, None] ** 0.3  # of a pressure that is infinite at the edge
    fit = _inverse(np.hstack([every[0], every[1][:, -1:]]))
    return Strips(1.0 - below, inside, fit, _inverse(felt * np.hstack([every[0][:, :-NEAR], *every[1:]])) * felt.T)


def _inverse(a: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(a, axis=0)
    return np.linalg.pinv(a / size) / size[:, None]


def transforms(tractions: Tractions, zeta: Array, x: Array) -> Array:
    """The integrals of q t^(q) exp(-q zeta) J_i(q x) dq for i < 4, and those with another factor q.

    Args:
        tractions: The tractions, with their transforms t^(q), the integrals of t J_0(q r) r dr.
        zeta: Depths > 0, (places,).
        x: Distances from the axis, >= 0, (places,).

    Returns:
        An array of shape (2, 4, places, tractions).
    """
    b, second, first, flat = tractions
    found = _of_bowls(b, second, first, zeta, x)
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


_ORDER = np.arange(5)[:, None, None]
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
    return [[flat, first, second], [rate.imag, 2.0 * (over - b * wave.real), more], [2.0 * (flat + b * rate.real), most]]


def _total(first: Array, second: Array, by_second: Array, by_first: Array) -> Array:
    """The sum of integrals for n = 1, of which those at the edges count, and n = 2 by their weights."""
    edges, some, tractions = by_first.shape
    first = first.reshape(*first.shape[:2], edges, -1)[..., -some:].reshape(*first.shape[:2], -1)
    return second @ by_second.reshape(-1, tractions) + first @ by_first.reshape(-1, tractions)


@jax.custom_jvp
def _of_bowls(b: Array, by_second: Array, by_first: Array, zeta: Array, x: Array) -> Array:
    found = _bowls(b.ravel(), zeta, x)[:2]
    return jnp.stack([_total(first[:4], second[:4], by_second, by_first) for _, first, second in found])


def _of_bowls_jvp(primals: tuple[Array, ...], tangents: tuple[Array, ...]) -> tuple[Array, Array]:
    b, *weights, zeta, x = primals
    value, more, most = _bowls(b.ravel(), zeta, x)

    def sums(pair: tuple[list[Array], ...], weights: list[Array], which: slice = np.s_[-2:]) -> Array:
        return jnp.stack([_total(*rows[which], *weights) for rows in pair])

    steeper = sums((more, most), weights)
    by_b, *by_weights, by_zeta, by_x = tangents
    along = jnp.zeros_like(steeper[:, :4])
    if not isinstance(by_b, SymbolicZero):
        moved = 2.0 * (b * by_b)[..., None]
        second, first = weights
        first = moved[:, -first.shape[1] :] * first
        along += sums((value, more), [2.0 * moved * second, first], np.s_[:2])[:, :4]
    if not all(isinstance(by, SymbolicZero) for by in by_weights):
        known = [jnp.zeros_like(w) if isinstance(by, SymbolicZero) else by for w, by in zip(weights, by_weights, strict=True)]
        along += sums((value, more), known)[:, :4]
    if not isinstance(by_zeta, SymbolicZero):
        along -= steeper[:, :4] * by_zeta[:, None]
    if not isinstance(by_x, SymbolicZero):
        lower = jnp.concatenate([-steeper[:, 1:2], steeper[:, :3]], 1)
        along += 0.5 * (lower - steeper[:, 1:]) * by_x[:, None]
    return sums((value, more), weights)[:, :4], along


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
    zeta, q = np.exp(np.arange(-11.5, 3.6 if double else 3.0, spacing)), np.exp(np.arange(-6.0, 11.6, 0.75 * spacing))
    felt = q / (1.0 + q)  # of an error at long waves little is felt
    # Larger weights would cancel in float32.
    fit = np.linalg.pinv(felt[:, None] * np.exp(-q[:, None] * zeta), rcond=1e-9 if double else 1e-5)
    return Grid(q, zeta, fit * felt)
