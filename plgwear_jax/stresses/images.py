"""Hankel integrals of axisymmetric tractions over exp(-q zeta), in closed form, and responses as sums of these.

What lies in strips across a traction is P(t) in t^(q) = integral of P(t) cos(q t) dt. It is a sum of (b^2 - t^2)^n,
each up to its own radius b, which is a quadratic spline of t^2, and on a power law of a power of 1 - (t/b)^2.
"""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

# --- tractions --------------------------------------------------------------------------------------------------------


class Tractions(NamedTuple):
    """Sums of tractions with P(t) = (b^2 - t^2)^n where t < b, and of others by their values beside the real axis."""

    near: int  # of the last radii, where n = 1; else it is 2
    b: Array  # (edges, radii)
    weight: Array | None  # (edges, radii, tractions)
    flat: Array | None = None  # of n = 0 and the last radius, (edges, tractions)
    beside: tuple[Array, Array] | None = None  # the places t/b of the last radius, (nodes,); (edges, nodes, tractions)


@functools.cache
def strips(radii: int, near: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(Radii b, 1 - t^2 where P is asked, what makes of P the weights of these and of n = 0), in units of the radius.

    P is the spline of least squares: quadratic up to the edge itself, or linear between the last radii in float32,
    where roundings of the weights of parabolas would be felt.
    """
    grade = min(4.0, 10.4 / np.log1p(radii))  # so that both are dense at the edge
    left, below = ((np.arange(3 * radii) + 0.5) / (3 * radii)) ** grade, (np.arange(radii)[::-1] / radii) ** grade
    inside = left * (2.0 - left)  # left is 1 - t, and below 1 - b
    every = np.maximum(inside[:, None] - np.append(below * (2.0 - below), -1.0), 0.0)
    every[:, : radii - near] **= 2
    every[:, radii] = 1.0
    felt = left[:, None] ** 0.3  # of a pressure that is infinite at the edge
    fit = np.linalg.pinv(felt * every) * felt.T
    return 1.0 - below, inside, fit + (np.eye(radii + 1) - fit @ every) @ fit


def transforms(tractions: Tractions, zeta: Array, x: Array, count: int) -> tuple[Array, Array]:
    """The integrals of q t^(q) exp(-q zeta) J_i(q x) dq for i < 4, and those with another factor q at the first places.

    Args:
        tractions: The tractions, with their transforms t^(q), the integrals of t J_0(q r) r dr.
        zeta: Depths > 0, (places,).
        x: Distances from the axis, >= 0, (places,).
        count: Of places where both are wanted.

    Returns:
        Arrays of the shapes (4, places, tractions), (4, count, tractions).
    """
    near, b, weight, flat, beside = tractions
    found: list[tuple[Array, Array]] = []
    if weight is not None:
        (first, second), (steep, steeper) = _bowls(b.ravel(), zeta, x)
        rate = _total(near, steep[:, :count], steeper[:, :count], weight)
        found.append((_total(near, first, second, weight), rate))
    if flat is not None:
        wave, rate, *_ = _waves(b[:, -1], zeta[:, None], x[:, None])
        found.append((-wave.imag @ flat, rate.imag[:, :count] @ flat))
    if beside is not None:
        turn, values = beside
        places, values = (b[:, -1:] * turn).ravel(), values.reshape(-1, values.shape[-1])
        _, rate, more, *_ = _waves(places.real, zeta[:, None] - places.imag, x[:, None])
        found.append((-(rate @ values).real, (more[:, :count] @ values).real))
    return jax.tree.map(lambda *parts: sum(parts[1:], parts[0]), *found)


@functools.cache
def path(step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(Places t, 1 - t^2, weights): Re of the integral of P(t) f(t) dt from 0 to 1 is that of a sum over the places.

    P is a power of 1 - t^2 and f real on the imaginary axis, and both are analytic below the real one, so that the
    integral may go along the circle from -i to 1. Places are dense at the edge, whence the singularities of f appear at
    the angle of pi/2 or more: steps of ln(1 - t) may be long, and longer still within 1e-4 of the edge.
    """
    along = 0.1 * step * np.arange(int(20.0 / step))
    angle = np.pi / (1.0 + np.exp(10.0 * np.sinh(along)))
    weight = step * np.cosh(along) * angle * (1.0 - angle / np.pi)
    weight[0] *= 0.5
    t = np.exp(-1j * angle)
    return t, 2j * np.sin(angle) * t, 1j * t * weight


def _waves(b: Array, zeta: Array, x: Array) -> tuple[Array, Array, Array, Array, Array]:
    """(G_i = e^i/D for i < 4, its two slopes by Z, Re e^i, T_i), shapes (4, places, n).

    There Z = zeta + i b, D = (Z^2 + x^2)^(1/2), e = x/(D + Z). G_i is the integral of exp(-q Z) J_i(q x) dq, and T_i
    that of its real part over b from 0.
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
    powers = jnp.stack([jnp.ones_like(e), e, e * e, e * e * e])
    over = jnp.append(jnp.arctan2(total.imag, total.real)[None], powers[1:].imag / -_ORDER[1:], 0)
    wave, turn = powers * inverse, depth * inverse
    rate = -wave * (turn + _ORDER) * inverse
    more = -(rate * (3.0 * turn + _ORDER) + wave * (1.0 + _ORDER * turn) * inverse) * inverse
    return wave, rate, more, powers.real, over


_ORDER: Any = np.arange(4)[:, None, None]
_SIGN = 1 - 2 * (_ORDER > 0)


def _bowls(b: Array, zeta: Array, x: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """The integrals for n = 1 and 2, and those with another factor q, for i < 4."""
    zeta, x, square = zeta[:, None], x[:, None], 4.0 * b * b
    wave, _, _, real, over = _waves(b, zeta, x)

    def turned(more: Array) -> Array:
        return x * jnp.concatenate([-more[1:2], more[:-1]]) - zeta * more

    # Each is a homogeneous function of lengths, of which `more` are the slopes; nothing has to cancel at the edge.
    first = 2.0 * (turned(over) + _SIGN * b * real) / (1 + _ORDER)
    more = (2 * (1 - _ORDER) * square * over + 12.0 * turned(first)) / (2 + _ORDER)
    second = (square * first + turned(more)) / (3 + _ORDER)
    return (first, second), (2.0 * (over - b * wave.real), more)


def _total(near: int, first: Array, second: Array, weight: Array) -> Array:
    """The sum of integrals, those for n = 1 at the last radii."""
    within, shape = weight.shape[1] - near, (*first.shape[:2], *weight.shape[:2])
    first, second = first.reshape(shape), second.reshape(shape)
    each = jnp.append(second[..., :within], first[..., within:], -1)
    return each.reshape(*shape[:2], -1) @ weight.reshape(-1, weight.shape[-1])


# --- responses --------------------------------------------------------------------------------------------------------


class Grid(NamedTuple):
    """Wavenumbers, and the sum of exponentials of them that goes through values there, in units of the radius."""

    q: np.ndarray  # (n,)
    zeta: np.ndarray  # (m,)
    fit: np.ndarray  # (m, n)


@functools.cache
def grid(spacing: float, double: bool) -> Grid:
    """The exponentials exp(-q zeta): responses are analytic for Re q > 0, which makes few of them enough."""
    # Near k = -1 waves a thousand times as long as the contact still count.
    zeta, q = np.exp(np.arange(-11.5, 9.0, spacing)), np.exp(np.arange(-9.0, 11.6, 0.75 * spacing))
    felt = q / (1.0 + q)  # of an error at long waves little is felt
    # Larger weights would cancel in float32.
    fit = np.linalg.pinv(felt[:, None] * np.exp(-q[:, None] * zeta), rcond=1e-9 if double else 1e-5)
    return Grid(q, zeta, fit * felt)
