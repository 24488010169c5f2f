"""Wear over cycles of contacts without closed forms: the march of `transient` on a ring that `surfaces` computes.

Functions have the names of the methods of `FrettingContact`, which say what they are.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, RADIUS, SHARE, guarded
from plgwear_jax._core.programs import program
from plgwear_jax.contact import numeric
from plgwear_jax.contact.arguments import NUMBER
from plgwear_jax.contact.numeric_state import State, states_of
from plgwear_jax.surfaces.cycles import cells_of
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.transient.amount import cycles_of, volume_of
from plgwear_jax.transient.course import Course, course_from
from plgwear_jax.transient.grid import Effort as Steps
from plgwear_jax.transient.grid import Ring, Scales, edges_of
from plgwear_jax.transient.grid import effort_of as steps_of

__all__ = ["cycles_to", "wear_volume"]

DIGITS = 4  # that are kept at most: docs/theory.md


# --- the runs ---------------------------------------------------------------------------------------------------------


def _run(effort: Effort, steps: Steps, state: State) -> Course:
    """One run, whose time is 4 K mu theta N in 1/Pa."""
    unworn = jnp.expm1(2.0 * (state.unworn.log_c - state.punch.log_c))
    grown = jnp.maximum(state.end - unworn, 16.0 * jnp.finfo(unworn.dtype).eps * unworn)
    volume = state.c**2 * state.height(state.punch) * state.volume
    unit = volume * (4.0 * state.friction * state.tangential) / numeric.energy_of(effort, state)

    def one(edges: tuple[Array, Array]) -> Ring:
        bodies = state.compliance, state.unworn, state.punch, state.beside
        cells = cells_of(*bodies, state.depth, state.radius, *edges, effort)
        return Ring(cells.compliance / unit, cells.gap, cells.steady, cells.first * unit, cells.swept, edges[0])

    # One march after the other, since all at once would be compiled as often.
    rings = jax.lax.map(one, edges_of(unworn, grown, steps))
    inner = jnp.exp(2.0 * (state.punch.log_c - state.unworn.log_c))
    return course_from(rings, Scales(volume, unit, inner, unworn + grown), steps)


def _for_each(function: Callable[[State], Any], states: State) -> Any:
    """The function's results for all states along a first axis."""
    count, axes = int(np.prod(states.shape)), len(states.shape)
    flat = jax.tree.map(lambda x: x.reshape(count, *x.shape[axes:]), states)
    if count == 1:
        return jax.tree.map(lambda x: x[None], function(jax.tree.map(lambda x: x[0], flat)))
    if jax.default_backend() != "cpu":
        return jax.vmap(function)(flat)
    # One after the other: together the slowest would set the pace of all.
    return jax.lax.map(function, flat)


@program(static=2, level=1)
def _courses(effort: Effort, steps: Steps, states: State) -> Course:
    return _for_each(lambda state: _run(effort, steps, state), states)


def _efforts(digits: int | None) -> tuple[Effort, Steps]:
    if digits is not None and digits > DIGITS:
        told = f"is outside the allowed range 1 <= digits <= {DIGITS} of wear over cycles of numeric contacts"
        raise ValueError(f"digits = {digits} {told}")
    return effort_of(digits), steps_of(digits)


# The quantities of one contact are asked for one after the other.
_last: list[Any] = []


def _course_of(contact: Any, force: ArrayLike, digits: int | None) -> tuple[State, Array, Course]:
    """(The states, their amplitudes in the same shape, the runs); where nothing wears a run of half the amplitude."""
    efforts, phi = _efforts(digits), contact.amplitude(force)
    if isinstance(force, jax.core.Tracer) or np.any(np.asarray(force) == 0.0):
        force = jnp.where(jnp.asarray(force) == 0.0, 0.5 * contact.friction * contact.normal_force, force)
    states = states_of(contact, force, digits)
    if not (_last and _last[0] is states and _last[1] == efforts):
        _last[:] = [states, efforts, _courses(*efforts, states)]
    return states, jnp.broadcast_to(phi, states.shape), _last[2]


def _time(states: State, cycles: ArrayLike, wear_coefficient: ArrayLike) -> Array:
    """4 K mu theta N in 1/Pa."""
    worn = guarded("wear_coefficient", wear_coefficient, POSITIVE) * guarded("cycles", cycles, NUMBER)
    return jnp.asarray(4.0 * states.tangential * worn, states.force.dtype)


# --- quantities -------------------------------------------------------------------------------------------------------


def wear_volume(
    contact: Any,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    digits: int | None = None,
) -> Array:
    states, phi, course = _course_of(contact, tangential_force, digits)
    return volume_of(course, phi, phi, _time(states, cycles, wear_coefficient))


def cycles_to(
    contact: Any,
    share: ArrayLike,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    *,
    digits: int | None = None,
) -> Array:
    states, phi, course = _course_of(contact, tangential_force, digits)
    share = jnp.asarray(guarded("share", share, SHARE), phi.dtype)
    return cycles_of(course, phi, phi, share) / _time(states, 1.0, wear_coefficient)
