"""A whole contact in cells of constant pressure, which both bodies give way to.

Radii are in T = (r/b)^2, from 0 at the centre to 1 at the outer edge of the last cell. Depths, integrated over T in
each cell, follow from the pressures by A p. Unlike in the ring of `cycles`, no part of the contact has to stick.
"""

import jax.numpy as jnp
from jax import Array

from plgwear_jax.surfaces.cells import images_of
from plgwear_jax.surfaces.compliance import Bodies, Graded
from plgwear_jax.surfaces.cycles import directly, power_terms


def disc_of(bodies: Bodies, b: Array, edges: Array) -> Array:
    """A in m/Pa, (cells, cells).

    Args:
        bodies: Both bodies.
        b: Radius of the outer edge in m.
        edges: Edges of the cells in T, from 0 to 1, (cells + 1,).
    """
    from_b, none = edges - 1.0, jnp.zeros_like(b)
    if not isinstance(bodies, Graded):
        return jnp.sum(power_terms(bodies, b, none, none[None], none[None], from_b).disc, 0)
    half = jnp.full_like(b, 0.5)
    return directly(bodies, b, from_b[0], from_b[-1], images_of(from_b, from_b, none, half, half))
