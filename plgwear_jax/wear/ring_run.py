"""The wear over cycles of a ring around a constant stick area: a constant force amplitude under Archard's law."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import RefusedError
from plgwear_jax._core.doubts import SOON
from plgwear_jax._core.startup.programs import holds_tracers
from plgwear_jax.special.elementary import clamp_keep_slope, crest, squares_apart, value_with_slope
from plgwear_jax.special.root import first_at
from plgwear_jax.steady.batch import as_numbers

from .curves import Moment, cells_around, moment_at
from .ring_curves import RunCurves, share_at
from .run import Run


class RunSolution(NamedTuple):
    """The solution of a run. All leaves but numbers of the question begin with the axes of the contacts."""

    curves: RunCurves
    phi: Array  # amplitudes before any wear; where they are 0 the curves are those of 1/2
    pace: Array  # the time of one cycle in the unit of the curves; broadcasts against the contacts
    a_0: Array  # contact radius before any wear in m
    c: Array  # stick radius in m
    ring: Any  # the ring of the engine: its gap, its final depth, and the pressures that it causes inside c
    force: Array  # its amplitude in N
    work: Array  # of friction in J/m^3 for the worn volume, mu/K by Archard's law

    def _known(self, found: Array, at: Array | float = 0.0, r: Any = 1.0) -> Array:
        """What is found; NaN in value and slopes where a number is, which it is outside of its range."""
        # Radii may be infinite.
        return found + self.phi * self.a_0 * self.pace * (0.0 * at) * jnp.minimum(r, 1.0)

    def number(self, name: str, cycles: Array) -> Array:
        """One number of the run, such as its contact radius."""
        return self._known(_NUMBERS[name](self, cycles), cycles)

    def field(self, name: str, r: Array, cycles: Array) -> Array:
        """The worn depth or the pressure at radii."""
        # Of no contact at all both are empty, and the integrals of a pressure need one.
        read = _pressure if name == "pressure" and self.phi.size else _depth_over_radii
        return self._known(read(self, r, cycles), cycles, r)

    def cycles_to(self, name: str, goal: Array) -> Array:
        """When so much is worn: a depth, a volume, or a share of the final volume."""
        shares, decay, time = self.curves.shares, self.curves.decay, self.curves.volume.time[..., -1]
        # Then less is left to wear than the rounding error of the volume.
        long = -2.0 * jnp.log(jnp.finfo(time.dtype).eps) / jnp.where(decay > 0.0, decay, jnp.inf)
        end = (time + long) / self.pace
        if name == "depth":
            found = first_at(_deepest, (self, _over_ring(self, goal)), goal, end)
        else:
            share = goal if name == "share" else goal / self.curves.final
            goals = jnp.where(share < 1.0, share, jnp.inf)
            found = first_at(lambda run, cycles: share_at(run[0], run[1] * cycles), (shares, self.pace), goals, end)
        # Where nothing wears, no goal above 0 is reached.
        found = jnp.where(self.phi > 0.0, found, jnp.nan if name == "share" else jnp.where(goal > 0.0, jnp.inf, 0.0))
        return self._known(found, goal * self.a_0)

    def last(self) -> Array:
        """Cycles after which nothing wears any more."""
        return self._known(_LONG / self.pace)


_LONG = 1e6  # units of time after which nothing wears any more


# --- one number of the run --------------------------------------------------------------------------------------------


def _volume(run: RunSolution, cycles: Array) -> Array:
    return jnp.where(run.phi > 0.0, run.curves.final * share_at(run.curves, run.pace * cycles), 0.0)


def _volume_rate(run: RunSolution, cycles: Array) -> Array:
    return clamp_keep_slope(0.0, value_with_slope(functools.partial(_volume, run), cycles)[1])


def _contact_radius(run: RunSolution, cycles: Array) -> Array:
    curves = run.curves
    moment = moment_at(curves.edge.time, run.pace * cycles)
    y = moment.on(curves.edge)
    y = y + (curves.width - y) * -jnp.expm1(-curves.decay * moment.late)
    grown = clamp_keep_slope(1.0, jnp.sqrt(curves.inner * (1.0 + y)))
    return run.a_0 * jnp.where(run.phi > 0.0, grown, 1.0)


_NUMBERS: dict[str, Callable[[RunSolution, Array], Array]] = {
    "volume": _volume,
    "rate": _volume_rate,
    "contact_radius": _contact_radius,
    "stick_radius": lambda run, cycles: run.c,
    "force_amplitude": lambda run, cycles: run.force,
    "energy_per_cycle": lambda run, cycles: run.work * _volume_rate(run, cycles),
    "deepest_wear": lambda run, cycles: _deepest((run, _over_ring(run, cycles)), cycles),
}


# --- depth ------------------------------------------------------------------------------------------------------------


_InRing = tuple[Array, Array, Array]  # in the ring: y, and the gap and the final depth there in m


def _depth_at(run: RunSolution, places: _InRing, cycles: Array) -> Array:
    """The worn depth h = g E/(1 + g E/H) in the ring. E grows without bound, so that h tends to exactly H."""
    curves, (y, gap, steady) = run.curves, places
    cell = cells_around(curves.edges, y)
    moment = moment_at(curves.worn.time, run.pace * cycles)

    def level(at: Array) -> Array:
        grown = jnp.expm1(moment.on(curves.worn, at))
        rest = jnp.maximum(1.0 - grown / cell.pick(curves.ratio, at), 1e-6)
        return jnp.log1p(grown / rest)

    grown = jnp.expm1(cell.across(level))
    grown = grown * jnp.exp(jnp.minimum(curves.decay * moment.late, 60.0))  # no more, or it would overflow
    return jnp.where(run.phi > 0.0, steady * (gap * grown) / (steady + gap * grown + jnp.finfo(gap.dtype).tiny), 0.0)


def _in_ring(run: RunSolution, r: Array) -> tuple[Array, Array, Array]:
    """(Whether radii lie in the ring, y = (r/c)^2 - 1 and radii there, harmless values elsewhere)."""
    c = run.c
    edge = c * jnp.sqrt(1.0 + run.curves.width)
    inside = (r > c) & (r < edge)  # at c depths have no slope from outside
    near = jnp.where(inside, r, 0.5 * (c + edge))
    return inside, squares_apart(near, c, c), near


def _depth_over_radii(run: RunSolution, r: Array, cycles: Array) -> Array:
    inside, y, near = _in_ring(run, r)
    return jnp.where(inside, _depth_at(run, (y, *run.ring.gap_and_depth(y, near)), cycles), 0.0)


_PLACES = np.linspace(0.0, 1.0, 242)[1:-1] ** 2  # of the ring; the deepest is near c after a few cycles


def _over_ring(run: RunSolution, at: Array) -> _InRing:
    """Places over the ring, along a first axis before those of the contacts and of other numbers."""
    places = _PLACES.reshape(-1, *(1,) * max(at.ndim, run.phi.ndim, run.pace.ndim))
    y = jnp.asarray(places, at.dtype) * run.curves.width
    return y, *run.ring.gap_and_depth(y, run.c * jnp.sqrt(1.0 + y))


def _deepest(given: tuple[RunSolution, _InRing], cycles: Array) -> Array:
    return crest(_depth_at(*given, cycles))


# --- pressure ---------------------------------------------------------------------------------------------------------


def _pressure(run: RunSolution, r: Array, cycles: Array) -> Array:
    curves, c, unit = run.curves, run.c, run.curves.unit
    under = jnp.where(r < c, r, 0.5 * c)
    z, (nearest, caused_at) = squares_apart(c, under, c), run.ring.caused(curves)
    unworn, steady = run.ring.pressures(r)
    moment = moment_at(curves.worn.time, run.pace * cycles)
    faded = jnp.exp(-curves.decay * moment.late) / unit

    def grown(moment: Moment, cell: Any) -> Array:
        """Pressure of a cell, without its share of the pressure before any wear; times `faded`."""
        return moment.between(curves.worn.rate.at[..., 0, :].set(0.0), cell)

    remains = jnp.where(moment.first == 0, 1.0 - moment.part, 0.0)  # of the pressure before any wear
    slips, y, _ = _in_ring(run, r)
    cell = cells_around(curves.edges, y, 1.0 / 3.0)  # edges grow as the cube of their index
    # A sum, since subtracting the first pressures would leave rounding errors where the pressure is zero.
    around = faded * cell.across(functools.partial(grown, moment)) + remains * unworn
    # In the stick area the pressures of the ring cause a pressure that vanishes with them.
    begin = curves.worn.rate[..., 0, :] / unit[..., None]
    each = Moment(moment.axes, *(x[..., None] for x in moment[1:]))
    now = faded[..., None] * grown(each, np.arange(begin.shape[-1])) + remains[..., None] * begin
    # Next to c only the steady pressure is singular; its share 1 - `share` of the pressure grows from 0 to 1.
    beside = caused_at(nearest)
    share = jnp.clip(jnp.sum(beside * now, -1) / jnp.sum(beside * begin, -1), 0.0, 1.0)
    rest = jnp.sum(caused_at(z) * (now - share[..., None] * begin), -1)
    blend = share * unworn + (1.0 - share) * jnp.where(r < c, steady, 0.0) + rest
    # Nearer to c than what is known the pressure tends to that of the first cell of the ring, as long as this touches.
    within, edge = jnp.minimum(z / nearest, 1.0), now[..., 0]
    touching = (edge / begin[..., 0]) ** 2
    touching = touching / (touching + 0.05**2)
    unworn_beside, steady_beside = run.ring.pressures(c * jnp.sqrt(1.0 - nearest))
    inner = edge + (share * unworn_beside + (1.0 - share) * steady_beside - edge) * within
    inner = jnp.maximum(inner, jnp.finfo(r.dtype).tiny)
    # Close to c, after few cycles, the blend is a difference of infinite pressures, which may be negative.
    mean = jnp.log(inner) * touching + jnp.log(jnp.maximum(blend, 0.1 * inner)) * (1.0 - touching)
    inside = jnp.where(within < 1.0, jnp.exp(mean), jnp.maximum(blend, 0.0))
    worn = jnp.where(r < c, inside, jnp.where(slips, around, jnp.where(r == c, edge, 0.0)))
    return jnp.where(run.phi > 0.0, worn, unworn)


# --- the run ----------------------------------------------------------------------------------------------------------


class RingRun(Run):
    """A run of a constant force amplitude under Archard's law: the stick radius stays, and a ring around it wears."""

    law: Any  # Archard's

    def _given(self) -> Any:
        return as_numbers((self.contact, self.load, self.law.wear_coefficient))

    def _solve(self) -> RunSolution:
        found = super()._solve()
        volume, phi = found.curves.volume.value, found.phi
        if not holds_tracers((volume, phi)) and np.isnan(volume).any():
            if not 1e-6 < np.max(phi) < 0.99:
                told = "is so close to 0 or 1 that the wear over cycles cannot be followed"
                raise RefusedError(f"F_x/(mu F_N) = {np.max(phi)!s} {told}; its steady state can be computed")
            if np.isnan(volume).any(-1).all():
                told = "the worn ring cannot be followed over cycles, as next to a kink or on a thin compliant skin"
                raise RefusedError(f"shape or material: {told}; fewer digits may do; its steady state can be computed")
        return found

    def _doubt(self) -> str | None:
        # The cycles to 99 % are several units, and only few questions are to pay for them.
        return self._doubt_of_soon() if np.max(self._solution.pace, initial=0.0) * SOON > 1.0 else None
