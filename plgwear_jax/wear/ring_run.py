"""The wear over cycles of a ring around a constant stick area: a constant force amplitude under Archard's law."""

import abc
import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._core.doubts import SOON
from plgwear_jax._startup.programs import program
from plgwear_jax.special.elementary import crest
from plgwear_jax.special.root import first_at
from plgwear_jax.transient.amount import cycles_of, rate_of, volume_of
from plgwear_jax.transient.batch import run_numbers
from plgwear_jax.transient.curves import RunCurves, end_of
from plgwear_jax.transient.fields import depth_by, radius_of
from plgwear_jax.wear.run import Run


class Solved(NamedTuple):
    """The solution of a run. All leaves but `per_cycle` begin with the axes of the contacts."""

    curves: RunCurves
    k: Array  # exponent of a power law; for other bodies any array of this shape
    phi: Array  # amplitudes before any wear
    per_cycle: Array  # reduced cycles, or time, of one cycle; broadcasts against the contacts
    volume: Array  # unit of the volumes of the curves in m^3
    contact_radius: Array  # a_0 in m
    stick_radius: Array  # c before any wear in m
    more: Any  # further results that only one engine uses

    @property
    def flat(self) -> RunCurves:
        """The curves with the contacts along one axis, on which there is at least one."""
        axes, count = self.phi.ndim, self.phi.size
        if not count:
            return jax.tree.map(lambda x: jnp.zeros((1, *x.shape[axes:]), x.dtype), self.curves)
        return jax.tree.map(lambda x: x.reshape(count, *x.shape[axes:]), self.curves)


def where_known(phi: Array, found: Array, at: Array, r: Any = 1.0) -> Array:
    """What is found; NaN in value and slopes where a number is, which it is outside of its range."""
    return found + phi * (0.0 * at) * jnp.minimum(r, 1.0)  # radii may be infinite


@program()
def _volume(run: Solved, cycles: Array) -> Array:
    return where_known(run.phi, run.volume * volume_of(run.flat, run.k, run.phi, run.per_cycle * cycles), cycles)


@program()
def _rate(run: Solved, cycles: Array) -> Array:
    rate = run.volume * run.per_cycle * rate_of(run.flat, run.k, run.phi, run.per_cycle * cycles)
    return where_known(run.phi, rate, cycles)


@program()
def _contact_radius(run: Solved, cycles: Array) -> Array:
    radius = run.contact_radius * radius_of(run.flat, run.k, run.phi, run.per_cycle * cycles)
    return where_known(run.phi, radius, cycles)


@program()
def _stick_radius(run: Solved, cycles: Array) -> Array:
    return where_known(run.phi, run.stick_radius, cycles)


@program(static=1)
def _cycles_to(name: str, run: Solved, goal: Array) -> Array:
    if name == "share":
        return where_known(
            run.phi * run.contact_radius, cycles_of(run.flat, run.k, run.phi, goal) / run.per_cycle, goal
        )
    share = goal / (run.volume * run.flat.scales.volume.reshape(run.phi.shape))
    never = share >= 1.0
    found = cycles_of(run.flat, run.k, run.phi, jnp.where(never, 0.5, share))
    return _if_it_wears(run, jnp.where(never, jnp.inf, found), goal)


def deepest_after(run: Solved, cycles: Array, *ring: Array) -> Array:
    """The depth in m of the deepest of some places, as of `cycles_to_depth`, after numbers of cycles."""
    deepest = _deepest((run.flat, ring), run_numbers(run.phi, run.phi), run.per_cycle * cycles)
    return where_known(run.phi, jnp.where(run.phi > 0.0, deepest, 0.0), cycles)


def cycles_to_depth(run: Solved, goal: Array, *ring: Array) -> Array:
    """The cycles after which the deepest of some places is so deep.

    Args:
        run: The solution.
        goal: Depths in m.
        *ring: y, the gap g_0 in m, and the final depth in m at the places, along a first axis.
    """
    numbers = run_numbers(run.phi, run.phi)

    def deepest(given: Any, n: Array) -> Array:
        return _deepest(given, numbers, n)

    found = first_at(deepest, (run.flat, ring), goal, end_of(run.flat, numbers))
    return _if_it_wears(run, found, goal)


def _deepest(given: Any, numbers: np.ndarray, n: Array) -> Array:
    curves, (y, gap, steady) = given
    return crest(depth_by(curves, numbers, y, n, gap, steady))


BY_DEPTH = {"cycles_to": cycles_to_depth, "deepest": deepest_after}


def places_in_ring(run: Solved, goal: Array) -> Array:
    """y at places over the ring, along a first axis before those of the contacts and the goals."""
    axes = (1,) * max(goal.ndim, run.phi.ndim)
    places = np.linspace(0.0, 1.0, _PLACES)[1:-1] ** 2  # the deepest is near c after a few cycles
    return jnp.asarray(places.reshape(-1, *axes), goal.dtype) * run.flat.scales.width.reshape(run.phi.shape)


def _if_it_wears(run: Solved, n: Array, goal: Array) -> Array:
    """n in cycles; where nothing wears, no goal above 0 is reached."""
    n = jnp.where(run.phi == 0.0, jnp.where(goal > 0.0, jnp.inf, 0.0), n)
    return where_known(run.phi * run.contact_radius, n / run.per_cycle, goal)


@program()
def _lasting(run: Solved) -> Array:
    return _LONG * run.curves.scales.unit / run.per_cycle


_LONG = 1e6  # units of time after which nothing wears any more
_PLACES = 242  # over the ring, among which the deepest wear is looked for


class RingRun(Run):
    """A run of a constant force amplitude under Archard's law: the stick radius stays, and a ring around it wears."""

    law: Any  # Archard's

    def _doubt(self) -> str | None:
        run = self._solution
        unit = np.min(run.curves.scales.unit, initial=np.inf) / np.max(run.per_cycle, initial=0.0)
        # The cycles to 99 % are several units, and only few questions are to pay for them.
        return self._doubt_of_soon() if unit < SOON else None

    def volume(self, cycles: ArrayLike) -> Array:
        return self._after(_volume, cycles)

    def rate(self, cycles: ArrayLike) -> Array:
        return self._after(_rate, cycles)

    def contact_radius(self, cycles: ArrayLike) -> Array:
        return self._after(_contact_radius, cycles)

    def stick_radius(self, cycles: ArrayLike) -> Array:
        return self._after(_stick_radius, cycles)

    def force_amplitude(self, cycles: ArrayLike) -> Array:
        limit = jnp.asarray(self.contact.friction) * jnp.asarray(self.contact.normal_force)
        return self.load.control(limit).value + 0.0 * self._cycles(cycles)

    def energy_per_cycle(self, cycles: ArrayLike) -> Array:
        # By Archard's law mu/K times the volume that the cycle wears.
        return self.rate(cycles) * jnp.asarray(self.contact.friction) / jnp.asarray(self.law.wear_coefficient)

    def _cycles_to(self, name: str, goal: Array) -> Array:
        if name == "depth":
            return self._by_depth("cycles_to", goal)
        return self._read(functools.partial(_cycles_to, name), goal)

    def deepest_wear(self, cycles: ArrayLike) -> Array:
        return self._by_depth("deepest", self._cycles(cycles))

    @abc.abstractmethod
    def _by_depth(self, function: str, goal: Array) -> Array:
        """A function of `BY_DEPTH` of a depth in m, or after a number of cycles."""

    @property
    def lasting_cycles(self) -> Array:
        return _lasting(self._solution)
