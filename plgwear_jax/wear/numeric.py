"""Wear over cycles of contacts without closed forms: the march of `transient` on a ring that `surfaces` computes."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import POSITIVE, ArrayLike, RefusedError, guarded, on_host
from plgwear_jax._startup.programs import program, value_of
from plgwear_jax.steady.arguments import amplitude_of
from plgwear_jax.steady.batch import as_numbers
from plgwear_jax.steady.numeric import over_radii_of
from plgwear_jax.steady.state import State
from plgwear_jax.surfaces.cycles import inward
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.transient.curves import RunCurves, known_curves
from plgwear_jax.transient.fields import depth_by, place_in_ring, pressures_at
from plgwear_jax.wear.ring_run import BY_DEPTH, RingRun, Solved, places_in_ring, where_known
from plgwear_jax.wear.rings import efforts_of, flat, for_each, runs_of, widths


@program()
def _depth(curves: RunCurves, r: Array, c: Array, gap: Array, steady: Array, phi: Array, n: Array) -> Array:
    run = np.arange(phi.size).reshape(phi.shape)
    inside, y = place_in_ring(r, c, c * jnp.sqrt(1.0 + curves.scales.width[run]))
    gap, steady = (jnp.where(inside, x, 1.0) for x in (gap, steady))
    depth = jnp.where(inside & (phi > 0.0), depth_by(curves, run, y, n, gap, steady), 0.0)
    return where_known(phi, depth, n, r)


@program()
def _places(run: Solved, goal: Array) -> tuple[Array, Array]:
    """(y, the radii in m) at places over the ring."""
    y = places_in_ring(run, goal)
    return y, run.more.states.results.stick_radius * jnp.sqrt(1.0 + y)


@program(static=1)
def _by_depth(function: str, run: Solved, goal: Array, y: Array, gap: Array, depth: Array) -> Array:
    return BY_DEPTH[function](run, goal, y, gap, depth)


# --- pressure ---------------------------------------------------------------------------------------------------------


@program(static=1, level=1)
def _inward(effort: Effort, states: State, curves: RunCurves, from_1: Array) -> tuple[tuple[Array, Array], Array]:
    """For each run (places inside c, pressures there per pressure of each cell), and the radius nearest to c in m."""

    def of_run(state: State, swept: Array, from_c: Array, from_1: Array) -> tuple[Array, Array]:
        return inward(state.compliance, state.punch, swept, widths(state)[0], from_c, from_1, effort)

    there = for_each(of_run, flat(states), curves.swept, curves.edges, from_1.reshape(curves.edges.shape))
    return there, states.c * jnp.sqrt(1.0 - there[0][:, -1].reshape(states.shape))


def _between_places(places: Array, values: Array, at: Array) -> Array:
    """Linear interpolation at `at` between values at places, which decrease along the last axis."""
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
    curves: RunCurves,
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
    slips, y = place_in_ring(r, c, c * jnp.sqrt(1.0 + curves.scales.width[run]))
    ring = pressures_at(curves, run, n).at(y, first)
    # In the stick area the pressures of the ring cause a pressure that vanishes with them.
    places, response = inward[0][run], inward[1][run]
    now = pressures_at(curves, run[..., None], n[..., None]).of(np.arange(response.shape[-1]))
    begin = curves.worn.rate[run, 0] / curves.scales.unit[run][..., None]
    added, at_first = (jnp.einsum("...pc,...c->...p", response, x) for x in (now, begin))
    # Next to c only the steady pressure is singular; its share 1 - `share` of the pressure grows from 0 to 1.
    share = jnp.clip(added[..., -1] / at_first[..., -1], 0.0, 1.0)
    under = jnp.where(r < c, r, 0.5 * c)
    depth = ((c - under) / c) * ((c + under) / c)
    rest = _between_places(places, added - share[..., None] * at_first, depth)
    blend = share * first + (1.0 - share) * jnp.where(r < c, last, 0.0) + rest
    # Nearer to c than all places the pressure tends to that of the first cell of the ring, as long as this touches.
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
    return where_known(phi, jnp.where(phi > 0.0, worn, first), n, r)


# --- the run ----------------------------------------------------------------------------------------------------------


class _Bodies(NamedTuple):
    """The states of the bodies, from which depths and pressures are computed, and the cells of their rings."""

    states: State
    from_1: Array  # T - (a_0/c)^2 at the edges of the cells


@program()
def _in_axes_of_contacts(
    states: State, curves: RunCurves, from_1: Array, contact: Any, force: Array, wear_coefficient: Array
) -> Solved:
    phi = jnp.broadcast_to(amplitude_of(contact, force), states.shape)
    curves, from_1 = jax.tree.map(lambda x: x.reshape(*phi.shape, *x.shape[1:]), (curves, from_1))
    # 4 K mu theta in 1/Pa, the time of one cycle.
    per_cycle = 4.0 * states.tangential * guarded("wear_coefficient", wear_coefficient, POSITIVE)
    # At zero amplitude, where nothing wears, the run was computed for phi = 1/2 instead.
    a_0 = states.results.contact_radius
    stick = jnp.where(phi > 0.0, states.results.stick_radius, a_0)
    return Solved(curves, phi, phi, per_cycle, jnp.ones_like(phi), a_0, stick, _Bodies(states, from_1))


class NumericRun(RingRun):
    """A run solved numerically, to 2 to 4 digits, by default 4."""

    def __init__(self, *question: Any, **more: Any) -> None:
        super().__init__(*question, **more)
        efforts_of(self.digits)  # raises an error for more digits than there are

    @property
    def _effort(self) -> Effort:
        return effort_of(self.digits)

    def _given(self) -> Any:
        return as_numbers((self.contact, self.load.amplitude, self.law.wear_coefficient))

    def _solved(self, given: Any) -> Solved:
        contact, force, wear_coefficient = given
        states, curves, from_1 = runs_of(contact, force, self.digits)
        known_curves(curves, states.phi)
        volume = value_of(curves.volume.value)
        if on_host(volume) and volume.size and np.isnan(volume).any(-1).all() and on_host(states.phi):
            told = "the worn ring cannot be followed over cycles, as next to a kink; its steady state can be computed"
            raise RefusedError(f"shape: {told}")
        return _in_axes_of_contacts(states, curves, from_1, contact, force, wear_coefficient)

    def _field(self, name: str, r: Array) -> Array:
        return over_radii_of((name, self._effort), self._solution.more.states, r)

    def _by_depth(self, function: str, goal: Array) -> Array:
        y, r = _places(self._solution, goal)
        fields = self._field("unworn_gap_at", r), self._field("worn_depth_at", r)
        return _by_depth(function, self._solution, goal, y, *fields)

    def depth(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        run, r = self._solution, self._radii(r)
        fields = self._field("unworn_gap_at", r), self._field("worn_depth_at", r)
        c, time = run.more.states.results.stick_radius, run.per_cycle * self._cycles(cycles)
        return _depth(run.flat, r, c, *fields, run.phi, time)

    def pressure(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        run, r = self._solution, self._radii(r)
        states = run.more.states
        if 0 in states.shape:
            return self.depth(r, cycles)  # as empty
        there, nearest = _inward(self._effort, states, run.flat, run.more.from_1)
        # Pressures before any wear and in the steady state, at r and at the radius inside c that is nearest to c.
        fields, near = (
            tuple(self._field(name, at) for name in ("unworn_pressure_at", "worn_pressure_at")) for at in (r, nearest)
        )
        time = run.per_cycle * self._cycles(cycles)
        return _pressure(run.flat, there, r, states.results.stick_radius, fields, near, run.phi, time)  # pyright: ignore[reportArgumentType]
