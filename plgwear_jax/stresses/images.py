"""Hankel integrals of axisymmetric tractions over exp(-q zeta), in closed form, and responses as sums of these.

A traction t(r) is a sum of b^2 - r^2 under square roots, each up to its radius b, and of one flat punch: what lies in
a strip across it, P(t) in t^(q) = integral of P(t) cos(q t) dt, is then piecewise linear in t^2.
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
    """Sums of tractions with P(t) = weight (b^2 - t^2) where t < b, and of one with P(t) = flat where t < end."""

    b: Array  # (n,)
    weight: Array  # (n, tractions)
    end: Array
    flat: Array | None  # (tractions,)


def bends(t: np.ndarray) -> np.ndarray:
    """The matrix that makes the weights of b = t[1:] of a P that is given at t, which begins with 0."""
    slope = np.diff(np.eye(t.size), axis=0) / np.diff(t * t)[:, None]
    return np.diff(slope, axis=0, append=0.0)


def transforms(tractions: Tractions, zeta: Array, x: Array) -> Array:
    """The integrals of q t^(q) exp(-q zeta) J_i(q x) dq for i < 4, and those with another factor q.

    Args:
        tractions: The tractions, with their transforms t^(q), the integrals of t J_0(q r) r dr.
        zeta: Depths > 0, (places,).
        x: Distances from the axis, >= 0, (places,).

    Returns:
        An array of shape (2, 4, places, tractions).
    """
    found = _of_bowls(tractions.b, tractions.weight, zeta, x)
    if tractions.flat is None:
        return found
    wave, rate, _ = _waves(tractions.end[None], zeta, x)
    return found + jnp.stack([-wave.imag, rate.imag])[:, :4] * tractions.flat


def _waves(b: Array, zeta: Array, x: Array) -> tuple[Array, Array, tuple[Array, ...]]:
    """(G_i = e^i/D for i < 5 with Z = zeta + i b, D = (Z^2 + x^2)^(1/2), e = x/(D + Z), its slope by Z, (e^i, D, T)).

    G_i is the integral of exp(-q Z) J_i(q x) dq, and T_i that of its real part over b from 0. Shapes (5, places, n).
    """
    zeta, x = zeta[:, None], x[:, None]
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
    rate = -wave * (depth + _ORDER * distance) * (inverse * inverse)
    return wave, rate, (powers, distance, over)


_ORDER = np.arange(5)[:, None, None]


def _bowls(b: Array, zeta: Array, x: Array) -> tuple[Array, Array, tuple[Array, Array]]:
    """The integrals for half of P = b^2 - t^2 for i < 4, those with another factor q for i < 5, and of `_waves`."""
    wave, rate, (powers, distance, over) = _waves(b, zeta, x)
    first = distance.imag - zeta[:, None] * over[0]
    others = 0.5 * x[:, None] * (over[:-2] + over[2:]) - b * powers[1:-1].real
    return jnp.append(first[None], others / _ORDER[1:-1], 0), over - b * wave.real, (wave, rate)


@jax.custom_jvp
def _of_bowls(b: Array, weight: Array, zeta: Array, x: Array) -> Array:
    value, more, _ = _bowls(b, zeta, x)
    return jnp.stack([value, more[:4]]) @ (2.0 * weight)


def _of_bowls_jvp(primals: tuple[Array, ...], tangents: tuple[Array, ...]) -> tuple[Array, Array]:
    b, weight, zeta, x = primals
    value, more, (wave, rate) = _bowls(b, zeta, x)
    rows = jnp.stack([value, more[:4]])
    found = rows @ (2.0 * weight)
    # With another factor q.
    steeper = jnp.stack([more, b * rate.real - wave.imag]) @ (2.0 * weight)
    by_b, by_weight, by_zeta, by_x = tangents
    along = jnp.zeros_like(found)
    if not isinstance(by_b, SymbolicZero):
        along += jnp.stack([-wave.imag, rate.imag])[:, :4] @ (2.0 * (b * by_b)[:, None] * weight)
    if not isinstance(by_weight, SymbolicZero):
        along += rows @ (2.0 * by_weight)
    if not isinstance(by_zeta, SymbolicZero):
        along -= steeper[:, :4] * by_zeta[:, None]
    if not isinstance(by_x, SymbolicZero):
        lower = jnp.concatenate([-steeper[:, 1:2], steeper[:, :3]], 1)
        along += 0.5 * (lower - steeper[:, 1:]) * by_x[:, None]
    return found, along


_of_bowls.defjvp(_of_bowls_jvp, symbolic_zeros=True)


# --- responses --------------------------------------------------------------------------------------------------------


class Grid(NamedTuple):
    """Wavenumbers, and the sum of exponentials of them that goes through values there, in units of the radius."""

    q: np.ndarray  # (n,)
    zeta: np.ndarray  # (m,)
    fit: np.ndarray  # (m, n)


@functools.cache
def grid(double: bool) -> Grid:
    """The exponentials exp(-q zeta): responses are analytic for Re q > 0, which makes few of them enough."""
    zeta, q = np.exp(np.arange(-11.5, 6.0, 0.4)), np.exp(np.arange(-6.0, 11.6, 0.3))
    felt = q / (1.0 + q)  # of an error at long waves little is felt
    # Larger weights would cancel in float32.
    fit = np.linalg.pinv(felt[:, None] * np.exp(-q[:, None] * zeta), rcond=1e-9 if double else 1e-5)
    return Grid(q, zeta, fit * felt)
