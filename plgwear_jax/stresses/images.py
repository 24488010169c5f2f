"""Hankel integrals of an axisymmetric traction over exp(-q zeta), in closed form, and responses as sums of these.

A traction t(r) is a sum of b^2 - r^2 under square roots, each up to its radius b, and of one flat punch: what lies in
a strip across it, P(t) in t^(q) = integral of P(t) cos(q t) dt, is then piecewise linear in t^2.
"""

import functools
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

# --- tractions --------------------------------------------------------------------------------------------------------


class Traction(NamedTuple):
    """A sum of tractions with P(t) = weight (b^2 - t^2) where t < b, and of one with P(t) = 1 where t < end."""

    b: Array  # (n,)
    weight: Array  # (n,)
    end: Array
    flat: Array


def traction_of(t: np.ndarray, strips: Array, radius: Array) -> Traction:
    """The traction whose P at shares t of its radius, from 0 to 1, are radius times strips."""
    slope = jnp.diff(strips) / jnp.asarray(np.diff(t * t), strips.dtype)
    weight = jnp.append(-jnp.diff(-slope), -slope[-1])
    return Traction(radius * jnp.asarray(t[1:], strips.dtype), weight / radius, radius, radius * strips[-1])


def transforms(traction: Traction, zeta: Array, x: Array) -> tuple[Array, Array]:
    """(The integrals of q t^(q) exp(-q zeta) J_i(q x) dq for i < 4, those with another factor q), shape (4, ...).

    Args:
        traction: The traction, with its transform t^(q), the integral of t J_0(q r) r dr.
        zeta: Depths > 0, which broadcast against x.
        x: Distances from the axis, >= 0.
    """
    zeta, x = jnp.broadcast_arrays(zeta, x)
    zeta, x = zeta[..., None], x[..., None]
    powers, inverse, depth, angle = _roots_at(traction.b, zeta, x)
    b, weight, third = traction.b, traction.weight, powers[1] * powers[2]
    first = [
        depth.distance.imag - zeta * angle,
        0.5 * x * (angle - 0.5 * powers[2].imag) - b * powers[1].real,
        -0.25 * x * (powers[1] + third / 3.0).imag - 0.5 * b * powers[2].real,
        -(x * (0.25 * powers[2] + 0.125 * powers[2] ** 2).imag + b * third.real) / 3.0,
    ]
    rates = [angle, -powers[1].imag, -0.5 * powers[2].imag, -third.imag / 3.0]
    powers = [*powers, third]
    second = [rate - b * (power * inverse).real for rate, power in zip(rates, powers, strict=True)]
    powers, inverse, depth, _ = _roots_at(traction.end[None], zeta, x)
    powers = [*powers, powers[1] * powers[2]]
    punch = [-power * inverse for power in powers]
    steeper = [more * (depth.complex + i * depth.distance) * inverse * inverse for i, more in enumerate(punch)]

    def both(bowls: list[Array], punch: list[Array]) -> Array:
        return 2.0 * jnp.stack(bowls) @ weight + traction.flat * jnp.stack(punch).imag[..., 0]

    return both(first, punch), both(second, steeper)


class _Depth(NamedTuple):
    complex: Array  # Z = zeta + i b
    distance: Array  # D = (Z^2 + x^2)^(1/2)


def _roots_at(b: Array, zeta: Array, x: Array) -> tuple[list[Array], Array, _Depth, Array]:
    """(e^i for i < 3 with e = x/(D + Z), 1/D, Z and D, the angle of D + Z)."""
    depth = jnp.asarray(zeta + 1j * b)
    # The root by real numbers, so that none of its parts cancels.
    real, imaginary = (x - b) * (x + b) + zeta * zeta, 2.0 * zeta * b
    size = jnp.sqrt(real * real + imaginary * imaginary)
    larger = jnp.sqrt(0.5 * (size + abs(real)))
    smaller = 0.5 * imaginary / larger
    distance = jnp.where(real > 0.0, larger, smaller) + 1j * jnp.where(real > 0.0, smaller, larger)
    total = distance + depth
    e = x / total
    return [jnp.ones_like(e), e, e * e], 1.0 / distance, _Depth(depth, distance), jnp.angle(total)


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
