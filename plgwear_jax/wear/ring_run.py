"""The wear over cycles of a ring around a constant stick area: a constant force amplitude under Archard's law."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer

from plgwear_jax._core.domains import ArrayLike, RefusedError
from plgwear_jax._core.doubts import SOON
from plgwear_jax._core.startup.programs import program, value_of
from plgwear_jax.special.elementary import clamp_keep_slope, crest
from plgwear_jax.special.root import first_at
from plgwear_jax.steady.batch import as_numbers
from plgwear_jax.wear.curves import Moment, cells_around, moment_at
from plgwear_jax.wear.ring_curves import RunCurves, end_of, share_at, volume_of
from plgwear_jax.wear.run import Run


class Pressures(NamedTuple):
    """Pressures in Pa at radii inside the stick radius; only the first one also counts outside."""

    unworn: Array  # before any wear
    steady: Array  # in the end
    caused: Array  # by a unit of pressure in each cell of the ring, along a last axis


class RunSolution(NamedTuple):
    """The solution of a run. All leaves but `per_cycle` begin with the axes of the contacts."""

    curves: RunCurves
    phi: Array  # amplitudes before any wear; where they are 0 the curves are those of 1/2
    per_cycle: Array  # the time of one cycle; broadcasts against the contacts
    contact_radius: Array  # a_0 in m
    stick_radius: Array  # c in m
    ring: Any  # the ring of the engine: its gap, its final depth, and the pressures that it causes inside c


def _nan_outside(run: RunSolution, found: Array, at: Array, r: Any = 1.0) -> Array:
    """What is found; NaN in value and slopes where a number is, which it is outside of its range."""
    # Radii may be infinite.
    return found + run.phi * run.contact_radius * run.per_cycle * (0.0 * at) * jnp.minimum(r, 1.0)


# --- one number of the run --------------------------------------------------------------------------------------------


def _volume(run: RunSolution, cycles: Array) -> Array:
    return volume_of(run.curves, run.phi, run.per_cycle * cycles)


def _volume_rate(run: RunSolution, cycles: Array) -> Array:
    return clamp_keep_slope(0.0, jax.jvp(lambda cycles: _volume(run, cycles), (cycles,), (jnp.ones_like(cycles),))[1])


def _contact_radius(run: RunSolution, cycles: Array) -> Array:
    curves, scales = run.curves, run.curves.scales
    moment = moment_at(curves.edge.time, run.per_cycle * cycles / scales.unit)
    y = moment.on(curves.edge)
    y = y + (scales.width - y) * -jnp.expm1(-curves.decay[..., 0] * moment.late)
    grown = clamp_keep_slope(1.0, jnp.sqrt(scales.inner * (1.0 + y)))
    return run.contact_radius * jnp.where(run.phi > 0.0, grown, 1.0)


_AMOUNTS: dict[str, Callable[[RunSolution, Array], Array]] = {
    "volume": _volume,
    "rate": _volume_rate,
    "contact_radius": _contact_radius,
    "stick_radius": lambda run, cycles: run.stick_radius,
    "deepest_wear": lambda run, cycles: _deepest((run, _over_ring(run, cycles)), cycles),
}


@program(static=1)
def _number_of_run(name: str, run: RunSolution, cycles: Array) -> Array:
    return _nan_outside(run, _AMOUNTS[name](run, cycles), cycles)


# --- depth ------------------------------------------------------------------------------------------------------------


def _depth_at(run: RunSolution, y: Array, gap: Array, steady: Array, cycles: Array) -> Array:
    """The worn depth h = g E/(1 + g E/H) at y in the ring. E grows without bound, so that h tends to exactly H."""
    curves = run.curves
    cell = cells_around(curves.edges, y)
    moment = moment_at(curves.worn.time, run.per_cycle * cycles / curves.scales.unit)

    def level(at: Array) -> Array:
        grown = jnp.expm1(moment.on(curves.worn, at))
        rest = jnp.maximum(1.0 - grown / cell.pick(curves.ratio, at), 1e-6)
        return jnp.log1p(grown / rest)

    grown = jnp.expm1(cell.across(level))
    grown = grown * jnp.exp(jnp.minimum(curves.decay[..., 0] * moment.late, 60.0))  # no more, or it would overflow
    return jnp.where(run.phi > 0.0, steady * (gap * grown) / (steady + gap * grown + jnp.finfo(gap.dtype).tiny), 0.0)


def _in_ring(run: RunSolution, r: Array) -> tuple[Array, Array, Array]:
    """(Whether radii lie in the ring, y = (r/c)^2 - 1 and radii there, harmless values elsewhere)."""
    c = run.stick_radius
    edge = c * jnp.sqrt(1.0 + run.curves.scales.width)
    inside = (r > c) & (r < edge)  # at c depths have no slope from outside
    near = jnp.where(inside, r, 0.5 * (c + edge))
    return inside, ((near - c) / c) * ((near + c) / c), near


def _depth_of_run(run: RunSolution, r: Array, cycles: Array) -> Array:
    inside, y, near = _in_ring(run, r)
    gap, steady = run.ring.gap_and_depth(y, near)
    return _nan_outside(run, jnp.where(inside, _depth_at(run, y, gap, steady, cycles), 0.0), cycles, r)


_PLACES = np.linspace(0.0, 1.0, 242)[1:-1] ** 2  # of the ring; the deepest is near c after a few cycles


def _over_ring(run: RunSolution, at: Array) -> tuple[Array, Array, Array]:
    """(y, gap, final depth) over the ring, along a first axis before those of the contacts and of other numbers."""
    places = _PLACES.reshape(-1, *(1,) * max(at.ndim, run.phi.ndim, run.per_cycle.ndim))
    y = jnp.asarray(places, at.dtype) * run.curves.scales.width
    gap, steady = run.ring.gap_and_depth(y, run.stick_radius * jnp.sqrt(1.0 + y))
    return y, gap, steady


def _deepest(given: tuple[RunSolution, tuple[Array, Array, Array]], cycles: Array) -> Array:
    run, ring = given
    return crest(_depth_at(run, *ring, cycles))


# --- how long ---------------------------------------------------------------------------------------------------------


@program(static=1)
def _cycles_to(name: str, run: RunSolution, goal: Array) -> Array:
    curves, wears = run.curves, run.phi > 0.0
    end = end_of(curves) / run.per_cycle
    if name == "depth":
        found = first_at(_deepest, (run, _over_ring(run, goal)), goal, end)
    else:

        def worn(given: Any, cycles: Array) -> Array:
            return share_at(given[0], given[1] * cycles)

        share = goal if name == "share" else goal / curves.scales.volume
        never = share >= 1.0
        found = first_at(worn, (curves.shares, run.per_cycle), jnp.where(never, 0.5, share), end)
        found = jnp.where(never, jnp.inf, found)
    # Where nothing wears, no goal above 0 is reached.
    found = jnp.where(wears, found, jnp.nan if name == "share" else jnp.where(goal > 0.0, jnp.inf, 0.0))
    return _nan_outside(run, found, goal * run.contact_radius)


@program()
def _lasting(run: RunSolution) -> Array:
    return _nan_outside(run, _LONG * run.curves.scales.unit / run.per_cycle, run.phi)


_LONG = 1e6  # units of time after which nothing wears any more


# --- pressure ---------------------------------------------------------------------------------------------------------


def _pressure(run: RunSolution, r: Array, cycles: Array) -> Array:
    inside, (nearest, beside) = run.ring.pressures(run, r)
    curves, c, unit = run.curves, run.stick_radius, run.curves.scales.unit
    moment = moment_at(curves.worn.time, run.per_cycle * cycles / unit)
    faded = jnp.exp(-curves.decay[..., 0] * moment.late) / unit

    def grown(moment: Moment, cell: Any) -> Array:
        """Pressure of a cell, without its share of the pressure before any wear; times `faded`."""
        rates = curves.worn.rate.at[..., 0, :].set(0.0)
        return moment.between(rates, cell)

    remains = jnp.where(moment.first == 0, 1.0 - moment.part, 0.0)  # of the pressure before any wear
    slips, y, _ = _in_ring(run, r)
    cell = cells_around(curves.edges, y, 1.0 / 3.0)  # edges grow as the cube of their index
    # A sum, since subtracting the first pressures would leave rounding errors where the pressure is zero.
    around = faded * cell.across(functools.partial(grown, moment)) + remains * inside.unworn
    # In the stick area the pressures of the ring cause a pressure that vanishes with them.
    begin = curves.worn.rate[..., 0, :] / unit[..., None]
    each = Moment(moment.axes, *(x[..., None] for x in moment[1:]))
    now = faded[..., None] * grown(each, np.arange(begin.shape[-1])) + remains[..., None] * begin
    # Next to c only the steady pressure is singular; its share 1 - `share` of the pressure grows from 0 to 1.
    share = jnp.clip(jnp.sum(beside.caused * now, -1) / jnp.sum(beside.caused * begin, -1), 0.0, 1.0)
    rest = jnp.sum(inside.caused * (now - share[..., None] * begin), -1)
    blend = share * inside.unworn + (1.0 - share) * jnp.where(r < c, inside.steady, 0.0) + rest
    # Nearer to c than what is known the pressure tends to that of the first cell of the ring, as long as this touches.
    under = jnp.where(r < c, r, 0.5 * c)
    within = jnp.minimum((c - under) * (c + under) / ((c - nearest) * (c + nearest)), 1.0)
    edge = now[..., 0]
    touching = (edge / begin[..., 0]) ** 2
    touching = touching / (touching + 0.05**2)
    inner = edge + (share * beside.unworn + (1.0 - share) * beside.steady - edge) * within
    inner = jnp.maximum(inner, jnp.finfo(r.dtype).tiny)
    # Close to c, after few cycles, the blend is a difference of infinite pressures, which may be negative.
    mean = jnp.log(inner) * touching + jnp.log(jnp.maximum(blend, 0.1 * inner)) * (1.0 - touching)
    under = jnp.where(within < 1.0, jnp.exp(mean), jnp.maximum(blend, 0.0))
    worn = jnp.where(r < c, under, jnp.where(slips, around, jnp.where(r == c, edge, 0.0)))
    return _nan_outside(run, jnp.where(run.phi > 0.0, worn, inside.unworn), cycles, r)


@program(static=1)
def _field_of_run(name: str, run: RunSolution, r: Array, cycles: Array) -> Array:
    read = _pressure if name == "pressure" and run.phi.size else _depth_of_run  # as empty
    return read(run, r, cycles)


# --- the run ----------------------------------------------------------------------------------------------------------


class RingRun(Run):
    """A run of a constant force amplitude under Archard's law: the stick radius stays, and a ring around it wears."""

    law: Any  # Archard's
    amount, field = staticmethod(_number_of_run), staticmethod(_field_of_run)

    def _given(self) -> Any:
        return as_numbers((self.contact, self.load, self.law.wear_coefficient))

    def _solve(self) -> RunSolution:
        found = super()._solve()
        volume, phi = value_of(found.curves.volume.value), value_of(found.phi)
        if not any(isinstance(x, Tracer) for x in (volume, phi)) and np.isnan(volume).any():
            if np.max(phi) > 0.99:
                told = "is so close to gross slip that the wear over cycles cannot be followed"
                raise RefusedError(f"F_x/(mu F_N) = {np.max(phi)!s} {told}; its steady state can be computed")
            if np.isnan(volume).any(-1).all():
                told = "the worn ring cannot be followed over cycles, as next to a kink or on a thin compliant skin"
                raise RefusedError(f"shape or material: {told}; fewer digits may do; its steady state can be computed")
        return found

    def _doubt(self) -> str | None:
        run = self._solution
        unit = np.min(run.curves.scales.unit, initial=np.inf) / np.max(run.per_cycle, initial=0.0)
        # The cycles to 99 % are several units, and only few questions are to pay for them.
        return self._doubt_of_soon() if unit < SOON else None

    def force_amplitude(self, cycles: ArrayLike) -> Array:
        limit = jnp.asarray(self.contact.friction) * jnp.asarray(self.contact.normal_force)
        return self.load.control(limit).value + 0.0 * self._argument("cycles", cycles)

    def energy_per_cycle(self, cycles: ArrayLike) -> Array:
        # By Archard's law mu/K times the volume that the cycle wears.
        return self.rate(cycles) * jnp.asarray(self.contact.friction) / jnp.asarray(self.law.wear_coefficient)

    def _cycles_to(self, name: str, goal: Array) -> Array:
        return self._read(functools.partial(_cycles_to, name), goal)

    @property
    def lasting_cycles(self) -> Array:
        return _lasting(self._solution)
