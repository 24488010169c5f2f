"""Wear over cycles of contacts without closed forms: the march of `transient` on a ring that `surfaces` computes.

Functions have the names of the methods of `FrettingContact`, which say what they are.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, RADIUS, SHARE, guarded
from plgwear_jax._core.programs import program
from plgwear_jax.contact import numeric
from plgwear_jax.contact.arguments import NUMBER
from plgwear_jax.contact.numeric_state import State, states_of
from plgwear_jax.contact.shape import unworn_of, unworn_profile
from plgwear_jax.surfaces.cycles import cells_of, inward
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.transient.amount import cycles_of, rate_of, volume_of
from plgwear_jax.transient.course import Course, course_from
from plgwear_jax.transient.fields import beside, depth_by, pressures_at, radius_of
from plgwear_jax.transient.grid import Effort as Steps
from plgwear_jax.transient.grid import Ring, Scales, edges_of
from plgwear_jax.transient.grid import effort_of as steps_of

__all__ = ["all_over_cycles", "cycles_to", "pressure", "profile", "wear_depth", "wear_volume"]

DIGITS = 4  # that are kept at most: docs/theory.md


# --- the runs ---------------------------------------------------------------------------------------------------------


def _widths(state: State) -> tuple[Array, Array]:
    """Of the unworn ring, and by how much the final one is wider, in c^2."""
    unworn = jnp.expm1(2.0 * (state.unworn.log_c - state.punch.log_c))
    return unworn, jnp.maximum(state.end - unworn, 16.0 * jnp.finfo(unworn.dtype).eps * unworn)


def _ring(effort: Effort, steps: Steps, state: State) -> tuple[Ring, Scales]:
    """The ring in the cells of each march, in time of 4 K mu theta N in 1/Pa."""
    unworn, grown = _widths(state)
    volume = state.c**2 * state.height(state.punch) * state.volume
    unit = volume * (4.0 * state.friction * state.tangential) / numeric.energy_of(effort, state)

    def one(edges: tuple[Array, Array]) -> Ring:
        bodies = state.compliance, state.unworn, state.punch, state.beside
        cells = cells_of(*bodies, state.depth, state.radius, *edges, effort)
        return Ring(cells.compliance / unit, cells.gap, cells.steady, cells.first * unit, cells.swept, edges[0])

    # The cells of one march after the other, since those of all at once would be compiled as often.
    rings = jax.lax.map(one, edges_of(unworn, grown, steps))
    inner = jnp.exp(2.0 * (state.punch.log_c - state.unworn.log_c))
    return rings, Scales(volume, unit, inner, unworn + grown)


def _for_each(function: Callable[..., Any], *trees: Any) -> Any:
    """The function's results for each row of the leaves, along a first axis."""
    if jax.tree.leaves(trees)[0].shape[0] == 1:
        return jax.tree.map(lambda x: x[None], function(*jax.tree.map(lambda x: x[0], trees)))
    if jax.default_backend() != "cpu":
        return jax.vmap(function)(*trees)
    # One after the other: together the slowest would set the pace of all.
    return jax.lax.map(lambda each: function(*each), trees)


def _flat(states: State) -> State:
    """All states along one axis."""
    axes = len(states.shape)
    return jax.tree.map(lambda x: x.reshape(int(np.prod(states.shape)), *x.shape[axes:]), states)


@program(static=2, level=1)
def _rings(effort: Effort, steps: Steps, states: State) -> tuple[Ring, Scales]:
    return _for_each(lambda state: _ring(effort, steps, state), _flat(states))


@program(static=1, level=1)
def _courses(steps: Steps, rings: Ring, scales: Scales) -> Course:
    """The runs, by a program that knows nothing of the bodies and serves all of them."""
    return _for_each(lambda ring, scale: course_from(ring, scale, steps), rings, scales)


def _efforts(digits: int | None) -> tuple[Effort, Steps]:
    if digits is not None and digits > DIGITS:
        told = f"is outside the allowed range 1 <= digits <= {DIGITS} of wear over cycles of numeric contacts"
        raise ValueError(f"digits = {digits} {told}")
    return effort_of(digits), steps_of(digits)


# The quantities of one contact are asked for one after the other.
_last: list[Any] = []


def _course_of(contact: Any, force: ArrayLike, digits: int | None) -> tuple[State, Array, Course]:
    """(The states, their amplitudes in the same shape, the runs); where nothing wears a run of half the amplitude."""
    efforts, phi = _efforts(digits), None
    if isinstance(force, Tracer) or np.any(np.asarray(force) == 0.0):
        phi = contact.amplitude(force)
        force = jnp.where(jnp.asarray(force) == 0.0, 0.5 * contact.friction * contact.normal_force, force)
    states = states_of(contact, force, digits)
    if not (_last and _last[0] is states and _last[1] == efforts):
        _last[:] = [states, efforts, _courses(efforts[1], *_rings(*efforts, states))]
    phi = states.phi if phi is None else jnp.broadcast_to(phi, states.shape)
    return states, phi, _last[2]


def _time(states: State, cycles: ArrayLike, wear_coefficient: ArrayLike) -> Array:
    """4 K mu theta N in 1/Pa."""
    given = guarded("wear_coefficient", wear_coefficient, POSITIVE), guarded("cycles", cycles, NUMBER)
    return _times(states.tangential, *given)


@program(once=True)
def _times(tangential: Array, wear_coefficient: Array, cycles: Array) -> Array:
    return jnp.asarray(4.0 * tangential * (wear_coefficient * cycles), tangential.dtype)


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
    return _cycles(course, phi, share, _time(states, 1.0, wear_coefficient))


@program()
def _cycles(course: Course, phi: Array, share: Array, one: Array) -> Array:
    return cycles_of(course, phi, phi, share) / one


@program()
def _depth(course: Course, r: Array, c: Array, gap: Array, steady: Array, phi: Array, n: Array) -> Array:
    run = np.arange(phi.size).reshape(phi.shape)
    inside, y = beside(r, c, c * jnp.sqrt(1.0 + course.scales.width[run]))
    gap, steady = (jnp.where(inside, x, 1.0) for x in (gap, steady))
    return jnp.where(inside & (phi > 0.0), depth_by(course, run, y, n, gap, steady), 0.0)


def wear_depth(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    digits: int | None = None,
) -> Array:
    states, phi, course = _course_of(contact, tangential_force, digits)
    r = jnp.asarray(guarded("r", r, RADIUS), phi.dtype)
    fields = (numeric.over_radii_of(name, effort_of(digits), states, r) for name in ("unworn_gap_at", "worn_depth_at"))
    return _depth(course, r, states.results.stick_radius, *fields, phi, _time(states, cycles, wear_coefficient))


def profile(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    digits: int | None = None,
) -> Array:
    lasting = {"cycles": cycles, "wear_coefficient": wear_coefficient}
    depth = wear_depth(contact, r, tangential_force, **lasting, digits=digits)
    exponent = None if contact.shape is None else contact.shape.exponent
    return _worn(depth, guarded("r", r, RADIUS), guarded("radius", contact.radius, POSITIVE), exponent)


@program(once=True)
def _worn(depth: Array, r: Array, radius: Array, exponent: Array | None) -> Array:
    return depth + unworn_profile(r, radius, exponent)


# --- pressure ---------------------------------------------------------------------------------------------------------


@program(static=2, level=1)
def _inward(effort: Effort, steps: Steps, course: Course, states: State) -> tuple[tuple[Array, Array], Array]:
    """Of each run (places inside c, what the pressures of its cells add there), and the place nearest to c in m."""
    finest = int(np.argmax(steps.multiples))

    def of_run(state: State, swept: Array) -> tuple[Array, Array]:
        unworn, grown = _widths(state)
        from_c, from_1 = (x[finest] for x in edges_of(unworn, grown, steps))
        return inward(state.compliance, state.punch, swept, unworn, from_c, from_1, effort)

    there = _for_each(of_run, _flat(states), course.swept)
    return there, states.c * jnp.sqrt(1.0 - there[0][:, -1].reshape(states.shape))


def _between_places(places: Array, values: Array, at: Array) -> Array:
    """Between values at places, which decrease along a last axis."""
    whole = jnp.broadcast_shapes(places.shape[:-1], values.shape[:-1], at.shape)
    first = jnp.clip(jnp.sum(places > at[..., None], -1) - 1, 0, places.shape[-1] - 2)

    def take(x: Array, i: Array) -> Array:
        x, i = jnp.broadcast_to(x, (*whole, x.shape[-1])), jnp.broadcast_to(i, whole)
        return jnp.take_along_axis(x, i[..., None], -1)[..., 0]

    begin, end = take(places, first), take(places, first + 1)
    part = jnp.clip((begin - at) / (begin - end), 0.0, 1.0)
    return (1.0 - part) * take(values, first) + part * take(values, first + 1)


@program()
def _pressure(
    course: Course,
    inward: tuple[Array, Array],
    r: Array,
    c: Array,
    fields: tuple[Array, Array],
    near: tuple[Array, Array],
    phi: Array,
    n: Array,
) -> Array:
    first, last = fields
    run = np.arange(phi.size).reshape(phi.shape)
    slips, y = beside(r, c, c * jnp.sqrt(1.0 + course.scales.width[run]))
    ring = pressures_at(course, run, n).at(y, first)
    # Where it sticks the pressures of the ring add something, and take it away while they vanish.
    places, response = inward[0][run], inward[1][run]
    now = pressures_at(course, run[..., None], n[..., None]).of(np.arange(response.shape[-1]))
    begin = course.worn.rate[run, 0] / course.scales.unit[run][..., None]
    added, at_first = (jnp.einsum("...pc,...c->...p", response, x) for x in (now, begin))
    # Next to c the pressure is singular in the end alone, by a share that grows.
    share = jnp.clip(added[..., -1] / at_first[..., -1], 0.0, 1.0)
    under = jnp.where(r < c, r, 0.5 * c)
    depth = ((c - under) / c) * ((c + under) / c)
    rest = _between_places(places, added - share[..., None] * at_first, depth)
    blend = share * first + (1.0 - share) * jnp.where(r < c, last, 0.0) + rest
    # Nearer to c than all places it goes on to that of the ring, as long as the ring touches there.
    edge, nearest = now[..., 0], places[..., -1]
    within = jnp.minimum(depth / nearest, 1.0)
    touching = (edge / begin[..., 0]) ** 2
    touching = touching / (touching + 0.05**2)
    known = share * near[0] + (1.0 - share) * near[1]
    inner = edge + (known - edge) * within
    least = jnp.finfo(r.dtype).tiny
    mean = jnp.log(jnp.maximum(inner, least)) * touching + jnp.log(jnp.maximum(blend, least)) * (1.0 - touching)
    under = jnp.where(within < 1.0, jnp.exp(mean), jnp.maximum(blend, 0.0))
    worn = jnp.where(r < c, under, jnp.where(slips, ring, 0.0))
    return jnp.where(phi > 0.0, worn, first)


def pressure(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    digits: int | None = None,
) -> Array:
    states, phi, course = _course_of(contact, tangential_force, digits)
    effort, steps = _efforts(digits)
    r = jnp.asarray(guarded("r", r, RADIUS), phi.dtype)
    there, nearest = _inward(effort, steps, course, states)
    # Before any wear and in the end, at r and at the place inside c that is the nearest to it.
    fields, near = (
        tuple(numeric.over_radii_of(name, effort, states, at) for name in ("unworn_pressure_at", "worn_pressure_at"))
        for at in (r, nearest)
    )
    time = _time(states, cycles, wear_coefficient)
    return _pressure(course, there, r, states.results.stick_radius, fields, near, phi, time)  # pyright: ignore[reportArgumentType]


# --- all of it --------------------------------------------------------------------------------------------------------


def all_over_cycles(
    contact: Any,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    cycles: np.ndarray,
    radii_of: Callable[[Array, Array], Array],
) -> dict[str, Any]:
    """The fields of `WearOverCycles` of one contact, by their names.

    Args:
        contact: The contact; its fields are numbers.
        tangential_force: The force amplitude, positive.
        wear_coefficient: Archard's K.
        cycles: Numbers of cycles, shape (n,).
        radii_of: Radii, of the stick radius and that of the worn ring.
    """
    states, phi, course = _course_of(contact, tangential_force, None)
    # With arrays of NumPy what is left to be computed compiles nothing.
    a_0, c, worn, _, steady_volume = jax.tree.map(np.asarray, states.results)
    lasting: dict[str, Any] = {"cycles": cycles[:, None], "wear_coefficient": wear_coefficient}
    time, one = _time(states, cycles, wear_coefficient), np.asarray(_time(states, 1.0, wear_coefficient))
    r: Any = np.asarray(radii_of(c, worn))
    depth = np.asarray(wear_depth(contact, r, tangential_force, **lasting))
    rate = np.maximum(one * np.asarray(rate_of(course, phi, phi, time)), 0.0)
    found = {
        "volume": volume_of(course, phi, phi, time),
        "volume_per_cycle": rate,
        "energy_per_cycle": rate * np.asarray(contact.friction) / wear_coefficient,
        "contact_radius": a_0 * np.asarray(radius_of(course, phi, phi, time)),
        "deepest_wear": np.max(depth, axis=-1),
        "radii": r,
        "unworn": unworn_of(contact)(r),
        "depth": depth,
        "pressure": pressure(contact, r, tangential_force, **lasting),
        "initial_pressure": numeric.over_radii_of("unworn_pressure_at", effort_of(None), states, r),
        "steady_depth": numeric.over_radii_of("worn_depth_at", effort_of(None), states, r),
        "steady_pressure": numeric.over_radii_of("worn_pressure_at", effort_of(None), states, r),
    }
    ends = {"steady_volume": steady_volume, "stick_radius": c, "worn_radius": worn}
    return {name: np.asarray(x) for name, x in found.items()} | {name: float(x) for name, x in ends.items()}
