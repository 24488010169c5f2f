"""The worn ring of contacts without closed forms, in cells that `surfaces` computes."""

import functools
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import POSITIVE, nan_outside
from plgwear_jax._core.sequential import sequential_forward_mode
from plgwear_jax._core.startup.programs import NumbersWithSlopes, holds_tracers, program, traced, value_of, with_slopes
from plgwear_jax.steady.arguments import amplitude_of
from plgwear_jax.steady.batch import in_turn, vmap_contacts
from plgwear_jax.steady.numeric import energy_of, over_radii_of
from plgwear_jax.steady.state import State, refuse_tension, solved_states, state_of, states_of
from plgwear_jax.surfaces.cells import RingCells
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.surfaces.ring import cells_of, inward

from .curves import moment_at
from .ring_cells import MarchResolution, Scales, edges_of, march_resolution_of
from .ring_curves import RunCurves, curves_by_parts, curves_from
from .ring_run import RingRun, RunSolution


def numeric_rings_of(resolution: MarchResolution, state: State) -> tuple[RingCells, Scales]:
    """(The ring in the cells of each march, its units); time is 4 K mu theta N, in 1/Pa."""
    unworn, grown = state.widths
    # One march after the other, so that the cells are compiled once and not once for each march.
    cells = lax.map(lambda edges: cells_of(state, *edges), edges_of(unworn, grown, resolution))
    volume = state.c**2 * state.height(state.punch) * state.volume
    # The cells know the first rate to four digits, and the energy of friction knows it to eight.
    unit = 4.0 * state.friction * state.tangential * volume / energy_of(state)
    scales = Scales(volume, unit, jnp.exp(2.0 * (state.punch.log_c - state.unworn.log_c)), unworn + grown)
    return cells, scales


# --- the runs of all contacts -----------------------------------------------------------------------------------------

_Runs = tuple[State, RunCurves]


@program(static=1, level=1)
def _rings_of_each(resolution: MarchResolution, states: State) -> tuple[RingCells, Scales]:
    return in_turn(functools.partial(numeric_rings_of, resolution), states.shape, states)


@program(static=2, level=1)
def _runs(effort: Effort, resolution: MarchResolution, contact: Any, force: Array) -> _Runs:
    """The runs as differentiable functions of the numbers of the contacts."""

    def run(contact: Any, force: Array) -> _Runs:
        state = state_of(effort, contact, force)
        return state, curves_from(resolution, *numeric_rings_of(resolution, state))

    return vmap_contacts(sequential_forward_mode(run), (contact, force))


def _worn_runs(resolution: MarchResolution, states: State) -> _Runs:
    return states, curves_by_parts(resolution, *_rings_of_each(resolution, states))


@program()
def _not_zero(contact: Any, force: Array) -> Array:
    return jnp.where(force == 0.0, 0.5 * contact.friction * contact.normal_force, force)


def _runs_of(effort: Effort, resolution: MarchResolution, contact: Any, force: Any) -> _Runs:
    if holds_tracers(force) or np.any(np.asarray(value_of(force)) == 0.0):
        force = _not_zero(contact, force)
    given = contact, force
    if any(isinstance(leaf, NumbersWithSlopes) for leaf in jax.tree.leaves(given)) or traced(given):
        single = contact.friction.size == contact.normal_force.size == force.size == 1
        # The derivatives of known numbers are those of two programs.
        parts = (lambda _, steps, *given: _worn_runs(steps, solved_states(effort, *given))) if single else None
        return with_slopes(_runs, parts)(effort, resolution, *given)
    states = states_of(contact, force, effort)
    refuse_tension(states, worn=True)
    return _worn_runs(resolution, states)


# --- what is read -----------------------------------------------------------------------------------------------------


class NumericRing(NamedTuple):
    """A ring whose fields are integrals."""

    states: State

    def gap_and_depth(self, y: Array, r: Array) -> tuple[Array, Array]:
        """(The gap beside the unworn contact of the stick radius, the final depth), both in m, at radii in the ring."""
        return over_radii_of("unworn_gap_at", self.states, r), over_radii_of("worn_depth_at", self.states, r)

    def pressures(self, r: Array) -> Iterator[Array]:
        """The pressures in Pa before any wear and in the end."""
        return (over_radii_of(name, self.states, r) for name in ("unworn_pressure_at", "worn_pressure_at"))

    def caused(self, curves: RunCurves) -> tuple[Array, Callable[[Array], Array]]:
        """(The least known 1 - (r/c)^2 inside c; by it what pressures a unit of pressure in each cell causes there)."""
        states = self.states
        places, caused = in_turn(inward, states.shape, states, curves.flat_punch_gap, curves.edges, curves.from_1)

        def caused_at(z: Array) -> Array:
            place = moment_at(-places, -z, within=True)  # places decrease towards c
            return place._replace(part=place.part[..., None]).between(caused)

        return places[..., -1], caused_at


@program()
def _run_in_si(runs: _Runs, contact: Any, force: Array, wear_coefficient: Array) -> RunSolution:
    states, curves = runs
    phi = amplitude_of(states.friction, states.force, force)
    K = nan_outside("wear_coefficient", wear_coefficient, POSITIVE)
    pace = 4.0 * states.tangential * K / curves.unit  # 4 K mu theta in 1/Pa is the time of one cycle
    a_0 = states.results.contact_radius
    stick = jnp.where(phi > 0.0, states.results.stick_radius, a_0)
    return RunSolution(curves, phi, pace, a_0, stick, NumericRing(states), force, contact.friction / K)


class NumericRun(RingRun):
    """A run solved numerically, to 2 to 4 digits, by default 4."""

    known: ClassVar = 4, " of wear over cycles of numeric contacts, whose narrow rings are not known to more"

    def _solved(self, given: Any) -> RunSolution:
        contact, load, wear_coefficient = given
        runs = _runs_of(effort_of(self.digits), march_resolution_of(self.digits), contact, load.amplitude)
        return _run_in_si(runs, contact, load.amplitude, wear_coefficient)
