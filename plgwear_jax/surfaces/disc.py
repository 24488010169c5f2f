"""A whole contact in cells of constant pressure, which both bodies give way to.

Radii are in T = (r/b)^2, from 0 at the centre to 1 at the outer edge of the last cell. Depths, integrated over T in
each cell, follow from the pressures by A p. Unlike in the ring of `cycles`, no part of the contact has to stick.
"""

import jax.numpy as jnp
from jax import Array

from plgwear_jax.surfaces.cells import images_of
from plgwear_jax.surfaces.compliance import Compliance, Graded
from plgwear_jax.surfaces.cycles import directly, power_terms
from plgwear_jax.surfaces.effort import Effort


def disc_of(compliance: Compliance, b: Array, edges: Array, effort: Effort) -> Array:
    """A in m/Pa, (cells, cells).

    Args:
        compliance: That of both bodies.
        b: Radius of the outer edge in m.
        edges: Edges of the cells in T, from 0 to 1, (cells + 1,).
        effort: How finely the compliance of a graded body is divided.
    """
    from_b, none = edges - 1.0, jnp.zeros_like(b)
    if not isinstance(compliance, Graded):
        return jnp.sum(power_terms(compliance, b, none, none[None], none[None], from_b).disc, 0)
    half = jnp.full_like(b, 0.5)
    return directly(compliance, b, from_b[0], from_b[-1], images_of(from_b, from_b, none, half, half), effort)
