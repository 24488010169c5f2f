"""Formulas shared by the flat punch of section 2 and the parabolic indenter of section 3."""

import math
from typing import Any

import jax.numpy as jnp
from jax import Array

from plgwear_jax.special.arcsine import Fold
from plgwear_jax.special.elementary import log_complement
from plgwear_jax.special.lerch import fold_at


def exponents(k: Any) -> tuple[Array, Array]:
    """(s, q) = ((1+k)/2, (1-k)/2), each to full relative accuracy also where it is small."""
    k = jnp.asarray(k)
    return 0.5 * (1.0 + k), 0.5 * (1.0 - k)


def fold_outside(r: Array, c: Array) -> Fold:
    """Fold y = (r/c)^2 - 1 of a radius r > c, computed from r - c, which keeps its digits at the edge and far away.

    For r <= c, under the punch, callers ignore the result; it is finite, since it is computed at a radius outside.
    """
    inner = r <= math.sqrt(1.0 + fold_at(r.dtype)) * c
    near = jnp.where(inner & (r > c), r, 1.25 * c)
    y = ((near - c) / c) * ((near + c) / c)
    # For larger r from c/r and log(r), since products of derivatives must not overflow at a radius of 1e300.
    far = jnp.where(inner, 2.0 * c, r)
    inverse = c / far
    beyond = inverse * inverse
    log_beyond = 2.0 * (jnp.log(c) - jnp.log(far)) - log_complement(beyond)
    x = jnp.where(inner, y, beyond / (1.0 - beyond))
    log_x = jnp.where(inner, jnp.log(y), log_beyond)
    return Fold(x, log_x, inner)


def log_beside_edge(r: Array, c: Array) -> Array:
    """log(1 - (r/c)^2) for r < c."""
    # Near the centre the slopes of 1 - r/c and 1 + r/c cancel, and 1 - (r/c)^2 rounds away what is less than 1.
    central = r < 0.5 * c
    near = log_complement(jnp.where(central, r / c, 0.0) ** 2)
    return jnp.where(central, near, jnp.log(jnp.where(central, 1.0, ((c - r) / c) * ((c + r) / c))))


def punch_stress(r: Any, c: Array, s: Array, q: Array, *, smooth: Array, singular: Array) -> Array:
    """(smooth z^s + singular z^-q)/c^2 for r < c, z = 1 - (r/c)^2; zero outside, infinite at r = c if singular > 0."""
    under = r < c
    log_z = log_beside_edge(jnp.where(under, r, 0.0), c)
    stress = (smooth * jnp.exp(s * log_z) + singular * jnp.exp(-q * log_z)) / (c * c)
    return jnp.where(under, stress, jnp.where((r == c) & (singular > 0.0), jnp.inf, 0.0))
