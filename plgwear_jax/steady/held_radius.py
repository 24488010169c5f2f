"""The stiffness of a power law for which a contact without closed forms has a given radius."""

from typing import Any

import jax.numpy as jnp
from jax import Array

from plgwear_jax.shapes import outline_of
from plgwear_jax.special.root import root_of
from plgwear_jax.surfaces.compliance import power_law
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.surfaces.punch import punch_at, surplus


def log_stiffness_for(contact: Any, contact_radius: Array) -> Array:
    """log(stiffness) of the half-space on which the contact has this radius in m; differentiable once.

    It is not sought by way of E0 or z0: at k = 0 z0 is without effect.
    """
    load, k = jnp.asarray(contact.normal_force) * contact.radius, jnp.asarray(contact.material.k)
    log_a = jnp.log(contact_radius)

    def too_much_force(log_stiffness: Array) -> Array:
        bodies = power_law(k, log_stiffness, contact.indenter, load, effort_of(None), outline_of(contact))
        return surplus(punch_at(bodies, log_a), jnp.log(load))

    # Under a rigid indenter it would be this one.
    alone = jnp.log(load * (0.25 * (3.0 + k))) - (3.0 + k) * log_a
    return root_of(too_much_force, alone, 0.5)
