"""A whole contact in cells of constant pressure, which both bodies give way to.

Radii are in T = (r/b)^2, from 0 at the centre to 1 at the outer edge of the last cell. Depths, integrated over T in
each cell, follow from the pressures by A p. Unlike in the ring of `cycles`, no part of the contact has to stick.
"""

import math

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.special.jacobi import gamma
from plgwear_jax.surfaces.cells import Images, images_of, products_of
from plgwear_jax.surfaces.compliance import Compliance, Graded
from plgwear_jax.surfaces.cycles import by_springs
from plgwear_jax.surfaces.effort import Effort


def disc_of(compliance: Compliance, b: Array, edges: Array, effort: Effort) -> Array:
    """A in m/Pa, (cells, cells).

    Args:
        compliance: That of both bodies.
        b: Radius of the outer edge in m.
        edges: Edges of the cells in T, from 0 to 1, (cells + 1,).
        effort: How finely the compliance of a graded body is divided.
    """
    from_b = edges - 1.0

    def images(s: Array) -> Images:
        return images_of(from_b, from_b, jnp.zeros_like(b), s, 1.0 - s)

    if isinstance(compliance, Graded):
        found = images(jnp.full_like(b, 0.5))
        added = by_springs(compliance, b, from_b[0], from_b[-1], found, effort)
        return compliance.strength * b * (2.0 / math.pi) * (products_of(found.share, found.weight) + 0.5 * added)

    def one(k: Array, s: Array, log_g: Array) -> Array:
        _, share, weight = images(s)
        strength = jnp.exp(log_g + (k - 1.0) * math.log(2.0) + (1.0 - k) * jnp.log(b)) / gamma(2.0 - s) ** 2
        return strength * products_of(share, weight)

    k, log_g = compliance.terms
    return jnp.sum(jax.vmap(one)(k, 0.5 * (1.0 + k), log_g), 0)
