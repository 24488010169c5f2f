"""The marches of `transient` on rings that `surfaces` computes: the runs of contacts without closed forms."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._startup.programs import program, traced, with_slopes
from plgwear_jax.special.one_by_one import forwards
from plgwear_jax.steady import numeric
from plgwear_jax.steady.batch import as_numbers, each
from plgwear_jax.steady.numeric import State, solver_of, states_of
from plgwear_jax.surfaces.cycles import cells_of
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.transient.course import Course, course_from
from plgwear_jax.transient.grid import Effort as Steps
from plgwear_jax.transient.grid import Ring, Scales, edges_of
from plgwear_jax.transient.grid import effort_of as steps_of
from plgwear_jax.transient.held_displacement import check_control, check_digits, run_of
from plgwear_jax.transient.shapes import StickArea

__all__ = [
    "Runs",
    "efforts_of",
    "flat",
    "for_each",
    "rig_of",
    "ring_at",
    "runs_of",
    "scales_of",
    "stick_area",
    "widths",
]

DIGITS = 4  # that are kept at most: docs/theory.md

Edges = tuple[Array, Array]  # of the cells, T - 1 and T - (a_0/c)^2


class Runs(NamedTuple):
    """The runs of some contacts and amplitudes."""

    states: State  # in the shape of all
    phi: Array  # the amplitudes; where nothing wears the run is that of half the amplitude
    course: Course  # along one axis
    from_1: Array  # edges of its cells, T - (a_0/c)^2


def widths(state: State) -> tuple[Array, Array]:
    """Of the unworn ring, and by how much the final one is wider, in c^2."""
    unworn = jnp.expm1(2.0 * (state.unworn.log_c - state.punch.log_c))
    return unworn, jnp.maximum(state.end - unworn, 16.0 * jnp.finfo(unworn.dtype).eps * unworn)


def scales_of(effort: Effort, state: State) -> Scales:
    """The units of a run, of time that of 4 K mu theta N in 1/Pa."""
    unworn, grown = widths(state)
    volume = state.c**2 * state.height(state.punch) * state.volume
    unit = volume * (4.0 * state.friction * state.tangential) / numeric.energy_of(effort, state)
    return Scales(volume, unit, jnp.exp(2.0 * (state.punch.log_c - state.unworn.log_c)), unworn + grown)


def ring_at(effort: Effort, state: State, unit: Array, edges: Edges) -> Ring:
    """The ring in cells with these edges."""
    bodies = state.compliance, state.unworn, state.punch, state.beside
    cells = cells_of(*bodies, state.depth, state.radius, *edges, effort)
    return Ring(cells.compliance / unit, cells.gap, cells.steady, cells.first * unit, cells.swept, edges[0])


def stick_area(state: State, ring: Ring, unit: Array) -> StickArea:
    """The area that sticks, with depths in c^2/R."""
    height, unworn = state.height(state.punch), state.unworn
    return StickArea(
        unworn=widths(state)[0],
        amplitude=state.phi,
        stiffness=state.punch.stiffness * height / state.force,
        flat=ring.swept,
        scale=jnp.pi * state.c**2 / (unit * state.force),
        displacement=jnp.exp(2.0 * (unworn.log_c - state.punch.log_c)) * unworn.depth - state.punch.depth,
    )


def rig_of(state: State, rig: Array) -> Array:
    """How a rig of a compliance in m/N gives way: as of `held_displacement.run_of`."""
    return state.friction * state.force * rig / (state.tangential * state.height(state.punch))


def for_each(function: Callable[..., Any], *trees: Any) -> Any:
    """The function's results for each row of the leaves, along a first axis."""
    if jax.tree.leaves(trees)[0].shape[0] == 1:
        return jax.tree.map(lambda x: x[None], function(*jax.tree.map(lambda x: x[0], trees)))
    if jax.default_backend() != "cpu":
        return jax.vmap(function)(*trees)
    # One after the other: together the slowest would set the pace of all.
    return jax.lax.map(lambda each: function(*each), trees)


def flat(states: State) -> State:
    """All states along one axis."""
    axes = len(states.shape)
    return jax.tree.map(lambda x: x.reshape(int(np.prod(states.shape)), *x.shape[axes:]), states)


def _cells_of(effort: Effort, steps: Steps, state: State) -> tuple[Ring, Scales, Array]:
    """(The ring in the cells of each march, the units, the edges of the finest march from a_0 on)."""
    scales = scales_of(effort, state)
    edges = edges_of(*widths(state), steps)
    # The cells of one march after the other, since those of all at once would be compiled as often.
    rings = jax.lax.map(lambda edges: ring_at(effort, state, scales.unit, edges), edges)
    return rings, scales, edges[1][int(np.argmax(steps.multiples))]


@program(static=2, level=1)
def _rings(effort: Effort, steps: Steps, states: State) -> tuple[Ring, Scales, Array]:
    return for_each(functools.partial(_cells_of, effort, steps), flat(states))


@program(static=1, level=1)
def _courses(steps: Steps, rings: Ring, scales: Scales) -> Course:
    """The runs, by a program that knows nothing of the bodies and serves all of them."""
    return for_each(lambda ring, scale: course_from(ring, scale, steps), rings, scales)


def _course_at_held_displacement(effort: Effort, state: State, rig: Array) -> tuple[Course, Array]:
    """(The run, the edges of its cells from a_0 on) with a rig of a compliance in m/N."""
    scales = scales_of(effort, state)

    def at(edges: Edges) -> tuple[Ring, Scales, StickArea]:
        ring = ring_at(effort, state, scales.unit, edges)
        return ring, scales, stick_area(state, ring, scales.unit)

    course, edges = run_of(at, *widths(state), state.phi, rig_of(state, rig))
    return course, edges[1]


@program(static=1, level=1)
def _at_held_displacement(effort: Effort, states: State, rig: Array) -> tuple[Course, Array]:
    one = functools.partial(_course_at_held_displacement, effort)
    return for_each(one, flat(states), jnp.broadcast_to(rig, states.shape).ravel())


@program(static=2, level=1)
def _solved(
    effort: Effort, steps: Steps | None, contact: Any, force: Array, rig: Array
) -> tuple[State, tuple[Course, Array]]:
    """The states and their runs from the numbers of the contacts, by which they are differentiated."""
    one, numbers, tables = solver_of(effort, contact, force)

    def run(rig: Array, *numbers: Array) -> tuple[State, tuple[Course, Array]]:
        state = one(*numbers)
        if steps is None:
            return state, _course_at_held_displacement(effort, state, rig)
        ring, scales, from_1 = _cells_of(effort, steps, state)
        return state, (course_from(ring, scales, steps), from_1)

    states, found = each(forwards(run), (rig, *numbers), tuple(1 + i for i in tables))
    axes = len(states.shape)
    return states, jax.tree.map(lambda x: x.reshape(-1, *x.shape[axes:]), found)


def efforts_of(digits: int | None, control: str) -> tuple[Effort, Steps | None]:
    """(How finely a contact is divided, and its march; None at a held displacement, whose march is always the same)."""
    check_control(control)
    if control == "displacement":
        check_digits(digits)
        return effort_of(digits), None
    if digits is not None and digits > DIGITS:
        told = f"is outside the allowed range 1 <= digits <= {DIGITS} of wear over cycles of numeric contacts"
        raise ValueError(f"digits = {digits} {told}, whose narrow rings are not known to more")
    return effort_of(digits), steps_of(digits)


def runs_of(
    contact: Any, force: ArrayLike, digits: int | None, control: str = "force", rig_stiffness: ArrayLike | None = None
) -> Runs:
    """The runs of all contacts, amplitudes and rigs."""
    effort, steps = efforts_of(digits, control)
    phi = None
    if isinstance(force, Tracer) or np.any(np.asarray(force) == 0.0):
        phi = contact.amplitude(force)
        force = jnp.where(jnp.asarray(force) == 0.0, 0.5 * contact.friction * contact.normal_force, force)
    rig = numeric.rig_compliance(rig_stiffness)
    if traced((contact, force, rig)):
        states, (course, from_1) = with_slopes(_solved)(effort, steps, *as_numbers((contact, force, rig)))
    else:
        states = states_of(contact, force, effort)
        if steps is None:
            states = _spread(states, jnp.broadcast_shapes(states.shape, jnp.shape(rig)))
            course, from_1 = _at_held_displacement(effort, states, jnp.asarray(rig, states.phi.dtype))
        else:
            rings, scales, from_1 = _rings(effort, steps, states)
            course = _courses(steps, rings, scales)
    phi = states.phi if phi is None else jnp.broadcast_to(phi, states.shape)
    return Runs(states, phi, course, from_1)


def _spread(states: State, shape: tuple[int, ...]) -> State:
    """The states in a larger shape."""
    if shape == states.shape:
        return states
    axes, new = len(states.shape), len(shape)

    def whole(x: Array) -> Array:
        own = x.reshape(*(1,) * (new - axes), *x.shape)
        return jnp.broadcast_to(own, (*shape, *x.shape[axes:]))

    return jax.tree.map(whole, states)
