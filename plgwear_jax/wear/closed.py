"""Wear over cycles of contacts in closed form: the runs of `transient` in SI units."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import POSITIVE, ArrayLike, guarded
from plgwear_jax._startup.programs import program, with_slopes
from plgwear_jax.loads import Load
from plgwear_jax.steady.batch import as_numbers
from plgwear_jax.steady.closed import ClosedSteady
from plgwear_jax.transient.curves import RunCurves, curves_of
from plgwear_jax.transient.fields import depth_of, gap_and_depth, pressure_of
from plgwear_jax.wear.ring_run import BY_DEPTH, RingRun, Solved, places_in_ring, where_known


class _Units(NamedTuple):
    """The dimensionless arguments of `transient`, and the units of its results."""

    k: Array
    phi: Array
    per_cycle: Array  # reduced cycles n = 4 K mu theta F_N/(pi a_0^2)
    contact_radius: Array
    stick_radius: Array
    height: Array  # a_0^2/R
    mean_pressure: Array  # F_N/(pi a_0^2)


@program(static=1)
def _units(digits: int | None, contact: Any, load: Load, wear_coefficient: Array) -> _Units:
    steady = ClosedSteady(contact, load, digits)
    worn = guarded("wear_coefficient", wear_coefficient, POSITIVE) * steady.mean_pressure
    per_cycle = 4.0 * jnp.asarray(contact.friction) * steady.tangential_ratio * worn
    found = _Units(
        k=jnp.asarray(steady.k, worn.dtype),
        phi=steady.amplitude,
        per_cycle=jnp.zeros((), worn.dtype),
        contact_radius=steady.contact_radius,
        stick_radius=steady.stick_radius,
        height=steady.height,
        mean_pressure=steady.mean_pressure,
    )
    return _Units(*jnp.broadcast_arrays(*found))._replace(per_cycle=per_cycle)


@program()
def _in_axes_of_contacts(units: _Units, curves: RunCurves) -> Solved:
    curves = jax.tree.map(lambda x: x[: units.phi.size].reshape(*units.phi.shape, *x.shape[1:]), curves)
    k, phi, a_0 = units.k, units.phi, units.contact_radius
    return Solved(curves, k, phi, units.per_cycle, a_0 * a_0 * units.height, a_0, units.stick_radius, units)


@program()
def _depth(run: Solved, r: Array, cycles: Array) -> Array:
    at = r / run.contact_radius, run.k, run.phi, run.per_cycle * cycles
    return where_known(run.phi, run.more.height * depth_of(run.flat, *at), cycles, r)


@program(static=1)
def _by_depth(function: str, run: Solved, goal: Array) -> Array:
    y = places_in_ring(run, goal)
    gap, depth = gap_and_depth(y, run.k, jnp.where(run.phi > 0.0, run.phi, 0.5))
    return BY_DEPTH[function](run, goal, y, run.more.height * gap, run.more.height * depth)


@program()
def _pressure(run: Solved, r: Array, cycles: Array) -> Array:
    at = r / run.contact_radius, run.k, run.phi, run.per_cycle * cycles
    return where_known(run.phi, run.more.mean_pressure * pressure_of(run.flat, *at), cycles, r)


class ClosedRun(RingRun):
    """A run of the closed forms, to 1 to 5 digits, by default 4."""

    def _given(self) -> Any:
        return as_numbers((self.contact, self.load, self.law.wear_coefficient))

    def _solved(self, given: Any) -> Solved:
        units = with_slopes(_units)(self.digits, *given)
        return _in_axes_of_contacts(units, curves_of(units.k, units.phi, self.digits))

    def _by_depth(self, function: str, goal: Array) -> Array:
        return self._read(functools.partial(_by_depth, function), goal)

    def depth(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        return _depth(self._solution, self._radii(r), self._cycles(cycles))

    def pressure(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        return _pressure(self._solution, self._radii(r), self._cycles(cycles))
