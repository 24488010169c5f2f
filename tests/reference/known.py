"""A known trade-off curve, in place of a search for one."""

import dataclasses

import jax.numpy as jnp

from plgwear_jax import optimise


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
