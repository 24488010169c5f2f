"""Blocks of cycles of contacts without closed forms, by the march of `transient.sequence`."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._startup.programs import program
from plgwear_jax.special.elementary import at_least
from plgwear_jax.steady.numeric import rig_compliance
from plgwear_jax.steady.state import State, states_of
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.transient.sequence import edges_between, ends_of
from plgwear_jax.wear.rings import rig_of, ring_at, scales_of, stick_area, widths

__all__ = ["by_blocks"]


@program(static=2, level=1)
def _by_blocks(
    effort: Effort, control: str, states: State, phi: Array, cycles: Array, wear_coefficient: Array, rig: Array
) -> dict[str, Array]:
    largest = jnp.argmax(phi)
    state = jax.tree.map(lambda x: x[largest], states)
    scales, (unworn, grown) = scales_of(effort, state), widths(state)
    # The unworn contact under the amplitude of each block, in units of the smallest stick area.
    log_c = states.punch.log_c - state.punch.log_c
    narrower = jnp.where(phi > 0.0, unworn - jnp.expm1(2.0 * log_c), 0.0)
    deep = jnp.exp(2.0 * (state.unworn.log_c - state.punch.log_c)) * state.unworn.depth
    displacement = jnp.where(phi > 0.0, deep - jnp.exp(2.0 * log_c) * states.punch.depth, 0.0)
    edges = edges_between(unworn, grown, jax.lax.stop_gradient(narrower))
    ring = ring_at(effort, state, scales.unit, edges)
    area = stick_area(state, ring, scales.unit)
    one = 4.0 * state.tangential * wear_coefficient / scales.unit  # of a cycle
    last = ends_of(control, ring, area, phi, displacement, rig_of(state, rig), cycles * one)
    worn, a_0 = phi[largest] > 0.0, jnp.exp(state.unworn.log_c)
    nothing = jnp.where(worn, 1.0, 0.0)
    return {
        "tangential_force": nothing * state.friction * state.force * last.amplitude,
        "volume": nothing * scales.volume * last.share,
        "volume_per_cycle": nothing * scales.volume * one * last.rate,
        "contact_radius": at_least(a_0, jnp.where(worn, state.c * jnp.sqrt(1.0 + last.edge), a_0)),
        "stick_radius": jnp.where(worn, state.c * jnp.sqrt(1.0 + last.stick), a_0),
    }


def by_blocks(
    contact: Any,
    tangential_force: np.ndarray,
    cycles: np.ndarray,
    wear_coefficient: ArrayLike,
    control: str,
    rig_stiffness: ArrayLike | None,
) -> dict[str, np.ndarray]:
    """The fields of `WearByBlocks` but the cycles, by their names."""
    phi = np.asarray(contact.amplitude(tangential_force))
    # Where nothing slips any other amplitude stands in.
    force = np.where(phi > 0.0, tangential_force, 0.5 * np.asarray(contact.friction) * np.asarray(contact.normal_force))
    states = states_of(contact, force, None)
    dtype = states.phi.dtype
    given = (np.asarray(x, dtype) for x in (phi, cycles, wear_coefficient, rig_compliance(rig_stiffness)))
    return jax.tree.map(np.asarray, _by_blocks(effort_of(None), control, states, *given))
