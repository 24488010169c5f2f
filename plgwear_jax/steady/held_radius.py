"""The radius of a contact without closed forms on a power law, and the stiffness for which it has a given one."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.startup.programs import program
from plgwear_jax.shapes import outline_of
from plgwear_jax.special.root import root_of
from plgwear_jax.surfaces.compliance import power_law
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.surfaces.punch import punch_at, surplus


def _surplus_at(contact: Any, effort: Effort, log_stiffness: Array) -> tuple[Array, Callable[[Array], Array]]:
    """(An estimate of the radius in m, the surplus of the force at a log(c)), on a half-space of this stiffness."""
    load, k = jnp.asarray(contact.normal_force) * contact.radius, jnp.asarray(contact.material.k)
    bodies = power_law(k, log_stiffness, contact.indenter, load, effort, outline_of(contact))
    return bodies.radius, lambda log_c: surplus(punch_at(bodies, log_c), jnp.log(load))


@program()
def contact_radius_of(contact: Any) -> Array:
    """The contact radius in m before any wear, to the digits that are the default; a smaller program than `steady`."""
    radius, excess = _surplus_at(contact, effort_of(None), contact.material.log_stiffness())
    return jnp.exp(root_of(excess, jnp.log(radius), 3.0))


def log_stiffness_for(contact: Any, contact_radius: Array, digits: int | None = None) -> Array:
    """log(stiffness) of the half-space on which the contact has this radius in m; differentiable once.

    It is not sought by way of E0 or z0: at k = 0 z0 is without effect.
    """
    effort, k, log_a = effort_of(digits), jnp.asarray(contact.material.k), jnp.log(contact_radius)
    # Under a rigid indenter it would be this one.
    alone = jnp.log(jnp.asarray(contact.normal_force) * contact.radius * (0.25 * (3.0 + k))) - (3.0 + k) * log_a
    return root_of(lambda log_stiffness: _surplus_at(contact, effort, log_stiffness)[1](log_a), alone, 0.5)
