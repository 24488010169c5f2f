"""The contact of an indenter under normal and tangential force, unworn and worn to the end, in SI units."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.surfaces.compliance import Compliance
from plgwear_jax.surfaces.effort import Effort
from plgwear_jax.surfaces.outline import Outline
from plgwear_jax.surfaces.punch import Punch, pressed, punch_under
from plgwear_jax.surfaces.ring import Beside, beside, ring_of

__all__ = ["Worn", "ring_around", "worn"]


class Worn(NamedTuple):
    """The contact before any wear, and its steady state; heights in c^2/R."""

    unworn: Punch
    punch: Punch  # of the stick area
    depth: Array  # d_inf
    beside: Beside
    y: Array  # of the outer edge
    volume: Array  # over c^4/R


def worn(compliance: Compliance, load: Array, phi: Array, effort: Effort, outline: Outline) -> Worn:
    """Both states of numbers, under a load F_N R."""
    loads = jnp.stack([load, (1.0 - phi) * load])
    both = jax.vmap(lambda load: punch_under(effort, compliance, load, outline))(loads)
    unworn, punch = (jax.tree.map(lambda x, i=i: x[i], both) for i in (0, 1))
    return Worn(unworn, punch, *ring_around(compliance, punch, phi, effort, outline))


def ring_around(
    compliance: Compliance, punch: Punch, phi: Array, effort: Effort, outline: Outline
) -> tuple[Array, Beside, Array, Array]:
    """The fields of `Worn` from `depth` on, of a stick area."""
    # The force of the unworn indenter with this radius is (1 - phi) F_N.
    d = pressed(punch, punch.force / (1.0 - phi))
    v = beside(compliance, punch, effort, outline)
    # Without an amplitude there is no ring; any other stands in for it.
    ring = ring_of(effort, v.lack(jnp.where(phi > 0.0, d, d + v.image.first)), v.a)
    worn = phi > 0.0
    y, volume = (jnp.where(worn, x, 0.0 * phi) for x in (jnp.exp(ring.log_y), jnp.pi * ring.volume))
    return d, v, y, volume
