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
from plgwear_jax._startup.programs import program
from plgwear_jax.contact.arguments import NUMBER
from plgwear_jax.shapes import Shape, shape_of, unworn_of
from plgwear_jax.steady import numeric
from plgwear_jax.steady.state import State
from plgwear_jax.surfaces.cycles import inward
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.transient.amount import cycles_of, rate_of, volume_of
from plgwear_jax.transient.course import Course
from plgwear_jax.transient.fields import beside, depth_by, pressures_at, radius_of
from plgwear_jax.wear.rings import flat, for_each, runs_of, widths

__all__ = ["all_over_cycles", "cycles_to", "pressure", "profile", "volumes_at", "wear_depth", "wear_volume"]

_END = 1e6  # units of time, by when nothing wears any more


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
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    states, phi, course, _ = runs_of(contact, tangential_force, digits, control, rig_stiffness)
    return volume_of(course, phi, phi, _time(states, cycles, wear_coefficient))


def cycles_to(
    contact: Any,
    share: ArrayLike,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    states, phi, course, _ = runs_of(contact, tangential_force, digits, control, rig_stiffness)
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
    return jnp.where(inside & (phi > 0.0), depth_by(course, run, y, n, gap, steady), 0.0 * phi)  # NaN where it is


def wear_depth(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    states, phi, course, _ = runs_of(contact, tangential_force, digits, control, rig_stiffness)
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
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    lasting: dict[str, Any] = {"cycles": cycles, "wear_coefficient": wear_coefficient}
    held: dict[str, Any] = {"control": control, "rig_stiffness": rig_stiffness}
    depth = wear_depth(contact, r, tangential_force, **lasting, **held, digits=digits)
    return _worn(depth, guarded("r", r, RADIUS), guarded("radius", contact.radius, POSITIVE), shape_of(contact))


@program(once=True)
def _worn(depth: Array, r: Array, radius: Array, shape: Shape) -> Array:
    return depth + shape.height(r, radius)


# --- pressure ---------------------------------------------------------------------------------------------------------


@program(static=1, level=1)
def _inward(effort: Effort, states: State, course: Course, from_1: Array) -> tuple[tuple[Array, Array], Array]:
    """Of each run (places inside c, what the pressures of its cells add there), and the place nearest to c in m."""

    def of_run(state: State, swept: Array, from_c: Array, from_1: Array) -> tuple[Array, Array]:
        return inward(state.compliance, state.punch, swept, widths(state)[0], from_c, from_1, effort)

    there = for_each(of_run, flat(states), course.swept, course.edges, from_1)
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
    return jnp.where(phi > 0.0, worn, first) + 0.0 * phi  # NaN where it is


def pressure(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    states, phi, course, from_1 = runs_of(contact, tangential_force, digits, control, rig_stiffness)
    effort = effort_of(digits)
    r = jnp.asarray(guarded("r", r, RADIUS), phi.dtype)
    there, nearest = _inward(effort, states, course, from_1)
    # Before any wear and in the end, at r and at the place inside c that is the nearest to it.
    fields, near = (
        tuple(numeric.over_radii_of(name, effort, states, at) for name in ("unworn_pressure_at", "worn_pressure_at"))
        for at in (r, nearest)
    )
    time = _time(states, cycles, wear_coefficient)
    return _pressure(course, there, r, states.results.stick_radius, fields, near, phi, time)  # pyright: ignore[reportArgumentType]


def volumes_at(
    contact: Any, tangential_force: ArrayLike, n: np.ndarray, control: str, rig_stiffness: ArrayLike | None
) -> tuple[np.ndarray, np.ndarray, float]:
    """As `over_cycles.volumes_at`."""
    states, phi, course, _ = runs_of(contact, tangential_force, None, control, rig_stiffness)
    force, a_0 = np.asarray(states.force), np.asarray(states.results.contact_radius)
    pressure = force / (np.pi * a_0 * a_0)
    time = np.asarray(n / pressure, phi.dtype)
    volume, rate = (np.asarray(f(course, phi, phi, time)) for f in (volume_of, rate_of))
    return volume, rate / pressure, float(_time(states, 1.0, 1.0) * pressure)


# --- all of it --------------------------------------------------------------------------------------------------------


def all_over_cycles(
    contact: Any,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    cycles: np.ndarray,
    radii_of: Callable[[Array, Array], Array],
    control: str,
    rig_stiffness: ArrayLike | None,
) -> dict[str, Any]:
    """The fields of `WearOverCycles` of one contact, by their names.

    Args:
        contact: The contact; its fields are numbers.
        tangential_force: The force amplitude, positive.
        wear_coefficient: Archard's K.
        cycles: Numbers of cycles, shape (n,).
        radii_of: Radii, of the stick radius and that of the worn ring.
        control: What is held.
        rig_stiffness: Of the rig whose displacement is held.
    """
    states, phi, course, _ = runs_of(contact, tangential_force, None, control, rig_stiffness)
    # With arrays of NumPy what is left to be computed compiles nothing.
    a_0, c, worn, _, steady_volume = jax.tree.map(np.asarray, states.results)
    one = np.asarray(_time(states, 1.0, wear_coefficient))
    last = np.append(cycles, _END * np.asarray(course.scales.unit[0]) / one)
    lasting: dict[str, Any] = {"cycles": last[:, None], "wear_coefficient": wear_coefficient}
    lasting |= {"control": control, "rig_stiffness": rig_stiffness}
    time = _time(states, last, wear_coefficient)
    r: Any = np.asarray(radii_of(c, worn))
    volume = np.asarray(volume_of(course, phi, phi, time))
    radius = a_0 * np.asarray(radius_of(course, phi, phi, time))
    depth = np.asarray(wear_depth(contact, r, tangential_force, **lasting))
    pressed = np.asarray(pressure(contact, r, tangential_force, **lasting))
    rate = np.maximum(one * np.asarray(rate_of(course, phi, phi, time)), 0.0)[:-1]
    if control == "force":
        fields = (numeric.over_radii_of(f"worn_{x}_at", effort_of(None), states, r) for x in ("depth", "pressure"))
        end = steady_volume, worn, *fields
    else:
        end = volume[-1], radius[-1], depth[-1], pressed[-1]
    found = {
        "volume": volume[:-1],
        "volume_per_cycle": rate,
        "energy_per_cycle": rate * np.asarray(contact.friction) / wear_coefficient,
        "contact_radius": radius[:-1],
        "deepest_wear": np.max(depth[:-1], axis=-1),
        "radii": r,
        "unworn": unworn_of(contact)(r),
        "depth": depth[:-1],
        "pressure": pressed[:-1],
        "initial_pressure": numeric.over_radii_of("unworn_pressure_at", effort_of(None), states, r),
        "steady_depth": end[2],
        "steady_pressure": end[3],
    }
    ends = {"steady_volume": end[0], "stick_radius": c, "worn_radius": end[1]}
    return {name: np.asarray(x) for name, x in found.items()} | {name: float(x) for name, x in ends.items()}
