"""Where a contact would have to pull: the least of its pressures, before any wear and worn to the end.

Bodies only press on each other. A state whose pressure is negative somewhere is none that a contact can be in: it would
open there, and its equations would be others.
"""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.special.elementary import ratio_where

from .punch import own_pressures, pressure_inside
from .ring import Worn

# Pressures are promised to 1e-2 of the mean. What is less negative than twice that changes no result beyond its digits,
# and may be an error of the pressures alone.
MOST = 0.02

# r/c, nearer to each other towards the edge, as the zeros of the pressures are.
_PLACES = 0.995 * np.sin(0.5 * np.pi * (np.arange(48) + 0.5) / 48)
_CELLS = np.linspace(0.0, 1.0, 33)  # r/c at the edges of cells, where each part of a contact is known by itself


class Least(NamedTuple):
    """The least pressures, (before any wear, worn to the end)."""

    share: Array  # of the mean pressure
    r: Array  # in m
    pulled: Array  # 1 where it is tension, 0 where it is none


@jax.custom_jvp
def least_pressures(found: Worn, phi: Array) -> Least:
    """The least pressures of both states. Before any wear not only F_N has to press, but also (1 - phi) F_N."""
    if found.bodies.never_pulls:
        none = 0.0 * jnp.stack([phi, phi])
        return Least(1.0 + none, none, none)
    shares, places, usual = _of_springs(found, phi) if found.punch.flat is None else _of_sums(found)
    scaled = shares / usual
    which = jnp.stack([jnp.argmin(scaled[:2]), jnp.argmin(scaled[2]) + 2 * scaled[2].size]).astype(np.uint32)
    shares, places, scaled = jnp.unstack(jnp.stack([shares, places, scaled]).reshape(3, -1)[:, which])
    return Least(shares, places, (scaled < -MOST).astype(shares.dtype))


@functools.partial(least_pressures.defjvp, symbolic_zeros=True)
def _without_slopes_of_least(primals: Any, tangents: Any) -> tuple[Least, Least]:
    # Nothing is differentiated by what only refuses.
    least = least_pressures(*primals)
    return least, jax.tree.map(jnp.zeros_like, least)


def _of_sums(found: Worn) -> tuple[Array, Array, Array]:
    """(Pressures over their mean, radii, what is usual there), of sums of pressures.

    Rows are those of F_N and of (1 - phi) F_N before any wear, and that of the steady state.
    """
    bodies, own = found.bodies, own_pressures(found.punch)
    s = bodies.s
    worn = own + found.further * found.punch.flat
    y, z = jnp.stack([own_pressures(found.unworn), own, worn]), jnp.asarray(1.0 - _PLACES**2, s.dtype)
    pressures = pressure_inside(bodies, y, z) / (2.0 * bodies.front**2 * y[:, :1])
    edge = jnp.exp(s * jnp.log(z))  # as before any wear pressures vanish there
    c = found.c
    radii = jnp.stack([found.unworn.c, c, c])
    return pressures, radii[:, None] * jnp.asarray(_PLACES, s.dtype), jnp.stack([edge, edge, jnp.ones_like(edge)])


def _of_springs(found: Worn, phi: Array) -> tuple[Array, Array, Array]:
    """The same at the inner edges of cells, of a power law alone.

    What wears adds the pressure of a flat punch, which is positive everywhere. The pressure before any wear is that of
    flat punches of all radii, each with the share by which G rises there.
    """
    punch, image, s = found.punch, found.beside.image, found.bodies.s
    wide = found.width
    edges = jnp.append(jnp.asarray(_CELLS**2, s.dtype), 1.0 + wide * _CELLS[1:])
    G = jnp.append(-image.first, image.fallen(edges[1:] - 1.0))
    size, inner = jnp.diff(edges), edges[:-1]
    inside = jnp.maximum(edges - inner[:, None], 0.0) ** s
    slopes = ratio_where(size > 0.0, jnp.diff(G), size)
    parts = jnp.diff(inside) * (slopes * punch.stiffness / punch.force)
    own = jnp.sum(parts[:, : _CELLS.size - 1], -1)  # beside the stick area 0
    shares = jnp.stack([(1.0 - phi) * (1.0 + wide) * jnp.sum(parts, -1), own, own])
    areas = jnp.stack([1.0 + wide, jnp.ones_like(wide), jnp.ones_like(wide)])[:, None]
    left = jnp.maximum(1.0 - inner / areas, jnp.finfo(s.dtype).eps)
    return shares, jnp.broadcast_to(found.c * jnp.sqrt(inner), shares.shape), left**s
