"""A known trade-off curve, in place of a search for one, and a design that is quickly found."""

import dataclasses
import functools

import jax.numpy as jnp

from plgwear_jax import GrossSlipContact, PowerLawGraded, optimise


@functools.cache
def punch_design():
    """The exponent with which a punch loses least of its force."""
    contact = GrossSlipContact(PowerLawGraded(1e9, 1e-3, -0.5, "holl"), 2e-3, 1e-6)
    return optimise.design(contact, None, {"k": (-0.9, 0.9)}, minimise="force_drop")


def front(**changed):
    """Of pressure against wear over k, the second design of which is not certain."""
    three = jnp.ones(3, bool)
    found = optimise.Front(
        x=jnp.array([1e8, 2e8, 4e8]),
        y=jnp.array([5e-18, 3e-18, 2e-18]),
        variables={"k": jnp.array([0.5, 0.0, -0.5])},
        at_bound={"k": jnp.array([1, 0, 0])},
        active={},
        converged=three,
        certified=three.at[1].set(False),
        reference_x=jnp.array(3e8),
        reference_y=jnp.array(4e-18),
        x_places={"distance": 1e-6},
        y_places={},
        x_name="edge_pressure",
        y_name="wear_volume",
    )
    return dataclasses.replace(found, **changed)
