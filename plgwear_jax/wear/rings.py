"""The marches of `transient` on rings that `surfaces` computes: the runs of contacts without closed forms."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer

from plgwear_jax._startup.programs import NumbersWithSlopes, program, traced, value_of, with_slopes
from plgwear_jax.special.sequential import sequential_forward_mode
from plgwear_jax.steady.batch import each
from plgwear_jax.steady.state import State, refuse_tension, solved_states, solver_of, states_of
from plgwear_jax.surfaces.cycles import Cells, cells_of
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.transient.curves import RunCurves, curves_from, weights
from plgwear_jax.transient.grid import MarchEffort, RingCells, Scales, edges_of, march_effort_of

DIGITS = 4  # correct digits at most: docs/explanation/numerics.md

Edges = tuple[Array, Array]  # T - 1 and T - (a_0/c)^2 at the edges of the cells; T = (r/c)^2


def widths(state: State) -> tuple[Array, Array]:
    """(Width of the unworn ring, width of the final ring less that of the unworn ring): differences of r^2 over c^2."""
    unworn = jnp.expm1(2.0 * (state.unworn.log_c - state.punch.log_c))
    return unworn, jnp.maximum(state.end - unworn, 16.0 * jnp.finfo(unworn.dtype).eps * unworn)


def unit_of(cells: Cells) -> Array:
    """The final volume over the first rate. Time is 4 K mu theta N for N cycles, in 1/Pa."""
    return jnp.sum(cells.steady, -1) / jnp.sum(cells.first * cells.gap, -1)


def scales_of(state: State, unit: Array) -> Scales:
    """The units of a run."""
    unworn, grown = widths(state)
    volume = state.c**2 * state.height(state.punch) * state.volume
    return Scales(volume, unit, jnp.exp(2.0 * (state.punch.log_c - state.unworn.log_c)), unworn + grown)


def cells_at(effort: Effort, state: State, edges: Edges) -> Cells:
    """The ring in cells with these edges."""
    bodies = state.compliance, state.unworn, state.punch, state.beside
    return cells_of(*bodies, state.depth, state.outline, *edges, effort)


def in_unit(cells: Cells, unit: Array, from_c: Array) -> RingCells:
    """The cells in a unit of time."""
    return RingCells(cells.compliance / unit, cells.gap, cells.steady, cells.first * unit, cells.swept, from_c)


def for_each(function: Callable[..., Any], *trees: Any) -> Any:
    """The function's results for each row of the leaves, along a first axis."""
    if jax.tree.leaves(trees)[0].shape[0] == 1:
        return jax.tree.map(lambda x: x[None], function(*jax.tree.map(lambda x: x[0], trees)))
    if jax.default_backend() != "cpu":
        return jax.vmap(function)(*trees)
    # One after the other, since a batch would take as many steps as its slowest element.
    return jax.lax.map(lambda each: function(*each), trees)


def flat(states: State) -> State:
    """All states along one axis."""
    axes = len(states.shape)
    return jax.tree.map(lambda x: x.reshape(int(np.prod(states.shape)), *x.shape[axes:]), states)


def _cells_of(effort: Effort, steps: MarchEffort, state: State) -> tuple[RingCells, Scales, Array]:
    """(The ring in the cells of each march, the units, the edges of the finest march from a_0 on)."""
    edges = edges_of(*widths(state), steps)
    # One march after the other, so that the cells are compiled once and not once for each march.
    cells = jax.lax.map(functools.partial(cells_at, effort, state), edges)
    scales = scales_of(state, jnp.asarray(weights(steps, 2), state.c.dtype) @ unit_of(cells))
    return in_unit(cells, scales.unit, edges[0]), scales, edges[1][int(np.argmax(steps.multiples))]


@program(static=2, level=1)
def _rings(effort: Effort, steps: MarchEffort, states: State) -> tuple[RingCells, Scales, Array]:
    return for_each(functools.partial(_cells_of, effort, steps), flat(states))


@program(static=1, level=1)
def _curves(steps: MarchEffort, rings: RingCells, scales: Scales) -> RunCurves:
    """The runs, by one program for all kinds of bodies, since it depends on the rings alone."""
    return for_each(lambda ring, scale: curves_from(ring, scale, steps), rings, scales)


@program(static=2, level=1)
def _solved(effort: Effort, steps: MarchEffort, contact: Any, force: Array) -> tuple[State, RunCurves, Array]:
    """The states and their runs, as differentiable functions of the numbers of the contacts."""
    one, numbers, tables, _ = solver_of(effort, contact, force)

    def run(*numbers: Array) -> tuple[State, tuple[RunCurves, Array]]:
        state = one(*numbers)
        ring, scales, from_1 = _cells_of(effort, steps, state)
        return state, (curves_from(ring, scales, steps), from_1)

    states, found = each(sequential_forward_mode(run), numbers, tables)
    axes = len(states.shape)
    return states, *jax.tree.map(lambda x: x.reshape(-1, *x.shape[axes:]), found)


def _by_parts(effort: Effort, steps: MarchEffort, contact: Any, force: Array) -> tuple[State, RunCurves, Array]:
    """The same, by the programs of known numbers."""
    return _worn(effort, steps, solved_states(effort, contact, force))


def _worn(effort: Effort, steps: MarchEffort, states: State) -> tuple[State, RunCurves, Array]:
    rings, scales, from_1 = _rings(effort, steps, states)
    return states, _curves(steps, rings, scales), from_1


def efforts_of(digits: int | None) -> tuple[Effort, MarchEffort]:
    """(Effort of the contact, effort of its march)."""
    if digits is not None and digits > DIGITS:
        text = f"is outside the allowed range 1 <= digits <= {DIGITS} of wear over cycles of numeric contacts"
        raise ValueError(f"digits = {digits} {text}, whose narrow rings are not known to more")
    return effort_of(digits), march_effort_of(digits)


@program()
def _not_zero(contact: Any, force: Array) -> Array:
    return jnp.where(force == 0.0, 0.5 * contact.friction * contact.normal_force, force)


def runs_of(contact: Any, force: Any, digits: int | None) -> tuple[State, RunCurves, Array]:
    """The runs of all contacts and amplitudes.

    Returns:
        The states in the broadcast shape of all arguments; the curves of all runs along one axis; and T - (a_0/c)^2 at
        the edges of the cells. Where the amplitude is 0 and nothing wears, the run is that for phi = 1/2.
    """
    effort, steps = efforts_of(digits)
    if isinstance(force, Tracer) or np.any(value_of(force) == 0.0):
        force = _not_zero(contact, force)
    given = contact, force
    if any(isinstance(leaf, NumbersWithSlopes) for leaf in jax.tree.leaves(given)) or traced(given):
        shapes = (np.shape(x) for x in (contact.friction, contact.normal_force, force))
        single = jnp.broadcast_shapes(*shapes) == ()
        return with_slopes(_solved, _by_parts if single else None)(effort, steps, *given)
    states = states_of(contact, force, effort)
    refuse_tension(states, worn=True)
    return _worn(effort, steps, states)
