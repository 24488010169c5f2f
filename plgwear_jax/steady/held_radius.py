"""The radius of a contact without closed forms on a power law, and the stiffness for which it has a given one."""

from typing import Any

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.startup.programs import program
from plgwear_jax.shapes.of_contact import outline_of
from plgwear_jax.special.root import root_of
from plgwear_jax.surfaces.compliance import power_law
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.surfaces.punch import punch_at, surplus


@program()
def contact_radius_of(contact: Any) -> Array:
    """The contact radius in m before any wear, to the digits that are the default; a smaller program than `steady`."""
    effort, indenter = effort_of(None), contact.indenter
    load, outline = jnp.asarray(contact.normal_force) * contact.radius, outline_of(contact)
    k, log_stiffness = jnp.asarray(contact.material.k), contact.material.log_stiffness()
    plane_modulus = None if indenter is None else indenter.plane_modulus
    compliance = power_law(k, log_stiffness, plane_modulus, load, effort, outline)

    def excess(log_c: Array) -> Array:
        return surplus(punch_at(compliance, log_c, effort, outline), jnp.log(load))

    return jnp.exp(root_of(excess, jnp.log(compliance.radius), 3.0))


def log_stiffness_for(contact: Any, contact_radius: Array, digits: int | None = None) -> Array:
    """log(stiffness) of the half-space on which the contact has this radius in m; differentiable once.

    It is not sought by way of E0 or z0: at k = 0 z0 is without effect.
    """
    effort, indenter = effort_of(digits), contact.indenter
    load = jnp.asarray(contact.normal_force) * contact.radius
    plane_modulus = None if indenter is None else indenter.plane_modulus
    k, log_a, outline = jnp.asarray(contact.material.k), jnp.log(contact_radius), outline_of(contact)

    def excess(log_stiffness: Array) -> Array:
        compliance = power_law(k, log_stiffness, plane_modulus, load, effort, outline)
        return surplus(punch_at(compliance, log_a, effort, outline), jnp.log(load))

    # Under a rigid indenter it would be this one.
    alone = jnp.log(load) + jnp.log(0.25 * (3.0 + k)) - (3.0 + k) * log_a
    return root_of(excess, alone, 0.5)
