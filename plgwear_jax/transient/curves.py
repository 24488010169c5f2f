"""A run of the transient: the curves that its marches give, extrapolated in cells and steps, and read at any time."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import RefusedError, on_host
from plgwear_jax._startup.programs import program, value_of, with_slopes
from plgwear_jax.transient.batch import runs
from plgwear_jax.transient.grid import MarchEffort, RingCells, Scales, march_effort_of, rings_of
from plgwear_jax.transient.march import March, marches_of


class Curve(NamedTuple):
    """A quantity that never falls and its rate at increasing times. Times are in `Scales.unit`."""

    time: Array  # (steps + 1,)
    value: Array  # (steps + 1, ...)
    rate: Array


class Shares(NamedTuple):
    """The part of a run that tells which share of the final volume is worn."""

    volume: Curve  # worn volume over the final volume
    decay: Array  # as of `RunCurves`
    unit: Array  # the unit of time


class RunCurves(NamedTuple):
    """The result of a run: curves over time, and what reading them needs of the ring."""

    volume: Curve  # worn volume over the final volume
    edge: Curve  # (T - C)/C at the edge of the contact
    worn: Curve  # P in the cells
    decay: Array  # (a, b): beyond the last time the volume left to wear, r, obeys r' = -(a + b r) r
    ratio: Array  # H/g in the cells
    swept: Array  # Q/s integrated over the cells
    edges: Array  # T/C - 1 at the edges of the cells
    scales: Scales

    @property
    def shares(self) -> Shares:
        """The worn volume alone."""
        return Shares(self.volume, self.decay, self.scales.unit)


# --- from the marches -----------------------------------------------------------------------------------------------


def _polynomials(nodes: np.ndarray, places: np.ndarray, degree: int, slope: bool = False) -> np.ndarray:
    """The matrix of piecewise polynomial interpolation from values at the nodes to values, or slopes, at the places."""
    matrix, count = np.zeros((places.size, nodes.size)), degree + 1
    for row, place in zip(matrix, places, strict=True):
        first = int(np.clip(np.searchsorted(nodes, place) - count // 2, 0, nodes.size - count))
        near = slice(first, first + count)
        row[near] = np.linalg.inv(np.vander(nodes[near] - place, increasing=True))[int(slope)]
    return matrix


def _depths_and_pressures(ring: RingCells, march: March, effort: MarchEffort) -> Array:
    """(h g, p) of the finest march, (2, steps, cells), each times the ratio of extrapolated to computed values.

    All marches divide the same coarse cells. At the steps that all marches share, the worn depths and loads of the
    coarse cells are extrapolated to small cells.
    """
    coarse, first = effort.cells // max(effort.multiples), 0
    each, sums, dtype = [], [], ring.gap.dtype
    for i, multiple in enumerate(effort.multiples):
        rows, cells = slice(first, first + effort.outer * multiple), slice(coarse * multiple)
        first = rows.stop
        gap, size = ring.gap[i, cells], jnp.diff(ring.edges[i, : coarse * multiple + 1])
        each.append(jnp.stack([gap * jnp.expm1(march.worn[rows, cells]), march.pressure[rows, cells]]))
        met = each[-1][:, multiple - 1 :: multiple] * jnp.stack([jnp.ones_like(size), size])[:, None]
        sums.append(jnp.sum(met.reshape(2, effort.outer, coarse, multiple), -1))
    finest = effort.multiples.index(max(effort.multiples))
    limit = jnp.tensordot(jnp.asarray(weights(effort, 2), dtype), jnp.stack(sums), 1)
    counts = sums[finest] > 1e-9 * jnp.max(sums[finest], (1, 2), keepdims=True)  # elsewhere rounding decides
    ratio = jnp.where(counts, jnp.clip(limit / jnp.where(counts, sums[finest], 1.0), 0.5, 1.5), 1.0)
    to_steps, to_cells = (jnp.asarray(x, dtype) for x in _spreads(effort))
    return each[finest] * (to_steps @ ratio @ to_cells)


@functools.cache
def _spreads(effort: MarchEffort) -> tuple[np.ndarray, np.ndarray]:
    """Matrices of linear interpolation from the steps and cells that all marches share to those of the finest march."""
    multiple = max(effort.multiples)
    steps = np.maximum(np.arange(1, effort.steps + 1) / multiple, 1.0)
    count = effort.cells // multiple
    cells = np.clip((np.arange(effort.cells) + 0.5) / multiple - 0.5, 0.0, count - 1.0)
    return _polynomials(np.arange(1.0, effort.outer + 1), steps, 1), _polynomials(np.arange(float(count)), cells, 1).T


def weights(effort: MarchEffort, order: int) -> np.ndarray:
    """Weights of the marches in the extrapolation, if errors are power series in the cell size from `order` on."""
    powers = np.append(0.0, order + np.arange(len(effort.multiples) - 1.0))
    return np.linalg.inv(np.array(effort.multiples)[:, None] ** -powers)[0]


class _Matrices(NamedTuple):
    limit: np.ndarray  # from all steps of all marches to those that all marches share
    spread: np.ndarray  # from these to the steps of the finest march
    slope: np.ndarray  # at the steps of the finest march, from time 0 on


@functools.cache
def _matrices(effort: MarchEffort, order: int) -> _Matrices:
    multiples, common = effort.multiples, np.arange(1, effort.outer + 1)
    limit, first = np.zeros((effort.outer, effort.outer * sum(multiples))), 0
    for multiple, weight in zip(multiples, weights(effort, order), strict=True):
        limit[common - 1, first + common * multiple - 1] = weight
        first += effort.outer * multiple
    places = np.maximum(np.arange(1, effort.steps + 1) / max(multiples), 1.0)
    steps = np.arange(effort.steps + 1.0)
    return _Matrices(limit, _polynomials(common, places, 3), _polynomials(steps, steps, 4, slope=True))


def _from(start: Any, x: Array) -> Array:
    """The values at all steps, with the value at time 0 in front."""
    return jnp.concatenate([jnp.broadcast_to(jnp.asarray(start, x.dtype), (1, *x.shape[1:])), x])


def run(k: Array, phi: Array, effort: MarchEffort) -> RunCurves:
    """One run, for single numbers k and phi."""
    ring, scales = rings_of(k, jnp.where(phi > 0.0, phi, 0.5), effort)
    return curves_from(ring, scales, effort)


def curves_from(ring: RingCells, scales: Scales, effort: MarchEffort) -> RunCurves:
    """The curves of a run, from the cells of each march."""
    return _extrapolated(effort, ring, scales, marches_of(ring, effort))


def _extrapolated(effort: MarchEffort, ring: RingCells, scales: Scales, march: March) -> RunCurves:
    """The curves that remain of the marches, extrapolated to small cells and steps."""
    depths, pressures = _depths_and_pressures(ring, march, effort)
    multiple = max(effort.multiples)
    which = effort.multiples.index(multiple)
    last = effort.outer * sum(effort.multiples[: which + 1])
    finest = jax.tree.map(lambda x: x[last - effort.steps : last], march)
    ring = jax.tree.map(lambda x: x[which], ring)
    begin = effort.inner * multiple
    edge = ring.edges[begin : begin + effort.steps + 1]

    def limit(order: int, x: Array, finest: Array) -> Array:
        limit, spread, _ = (jnp.asarray(matrix, x.dtype) for matrix in _matrices(effort, order))
        # Clipped, since at few digits the first steps would otherwise go backwards.
        return _from(0.0, finest * jnp.clip(spread @ (limit @ x / finest[multiple - 1 :: multiple]), 0.25, 4.0))

    # The edge of the contact has an error of first order in the cell size, time and volume of second order.
    time, volume = limit(2, march.time, finest.time), limit(2, march.volume, finest.volume)
    edge_time = limit(1, march.time, finest.time)
    slope = jnp.asarray(_matrices(effort, 2).slope, time.dtype)
    by_step = slope @ jnp.stack([time, edge_time, volume, edge], -1)
    rate = jnp.concatenate([jnp.ones((1,), time.dtype), by_step[1:, 2] / by_step[1:, 0]])
    growth = jnp.concatenate([jnp.full((1,), jnp.inf, time.dtype), by_step[1:, 3] / by_step[1:, 1]])
    # The volume left to wear, r, decays as r' = -(a + b r) r; a and b follow from the slopes at two late times.
    rest = 1.0 - jnp.stack([volume[-1], volume[-1 - multiple]])
    fall = jnp.stack([rate[-1], rate[-1 - multiple]]) / rest
    more = (fall[0] - fall[1]) / (rest[0] - rest[1])
    return RunCurves(
        limited(Curve(time, volume, rate)),
        limited(Curve(edge_time, edge, growth)),
        limited(
            Curve(
                _from(0.0, time[1:]),
                _from(0.0, jnp.log1p(depths / ring.gap)),
                _from(ring.first, jnp.maximum(pressures, 0.0)),
            )
        ),
        jnp.stack([fall[0] - more * rest[0], more]),
        ring.steady / ring.gap,
        ring.swept,
        ring.edges,
        scales,
    )


def limited(curve: Curve) -> Curve:
    """The curve with rates limited so that no cubic between two times falls."""
    time, value, rate = curve
    chord = jnp.maximum(jnp.diff(value, axis=0), 0.0) / jnp.diff(time).reshape(-1, *(1,) * (value.ndim - 1))
    before, after = jnp.concatenate([chord[:1], chord]), jnp.concatenate([chord, chord[-1:]])
    return Curve(time, value, jnp.clip(rate, 0.0, 3.0 * jnp.minimum(before, after)))


@program(static=1, level=1)
def compiled_curves(effort: MarchEffort, k: Array, phi: Array) -> RunCurves:
    """Runs for all pairs of k and phi."""
    return runs(functools.partial(run, effort=effort), k, phi)


# For one pair of known numbers three programs, whose derivatives XLA compiles sooner than those of one.


@program(static=1, level=2)
def _ring_and_units(effort: MarchEffort, k: Array, phi: Array) -> tuple[RingCells, Scales]:
    k, phi = k.reshape(()), phi.reshape(())
    return rings_of(k, jnp.where(phi > 0.0, phi, 0.5), effort)


@program(static=1, level=2)
def _marches(effort: MarchEffort, ring: RingCells) -> March:
    return marches_of(ring, effort)


@program(static=1, level=2)
def _curves_of_march(effort: MarchEffort, ring: RingCells, scales: Scales, march: March) -> RunCurves:
    return jax.tree.map(lambda x: x[None], _extrapolated(effort, ring, scales, march))


def _by_parts(effort: MarchEffort, k: Array, phi: Array) -> RunCurves:
    ring, scales = _ring_and_units(effort, k, phi)
    return _curves_of_march(effort, ring, scales, _marches(effort, ring))


def curves_of(k: Array, phi: Array, digits: int | None) -> RunCurves:
    """The curves of the runs for all pairs of k and phi, which all of `transient` reads."""
    effort = march_effort_of(digits)
    if k.size * phi.size != 1 or jax.default_backend() != "cpu":
        return known_curves(compiled_curves(effort, k, phi), phi)
    return known_curves(with_slopes(compiled_curves, _by_parts)(effort, k, phi), phi)


def known_curves(curves: RunCurves, phi: Any) -> RunCurves:
    """The curves; known amplitudes so close to gross slip that rounding ends the march are refused."""
    volume, phi = value_of(curves.volume.value), value_of(phi)
    if on_host(volume) and on_host(phi) and np.isnan(volume).any() and np.max(phi) > 0.99:
        told = "is so close to gross slip that the wear over cycles cannot be followed"
        raise RefusedError(f"F_x/(mu F_N) = {np.max(phi)!s} {told}; its steady state can be computed")
    return curves


# --- at any time ----------------------------------------------------------------------------------------------------


class Moment(NamedTuple):
    """A time, located between the times of a curve or beyond the last one."""

    first: Array  # index of the interval
    part: Array  # share of the interval that has passed, 0 to 1
    length: Array  # length of the interval
    late: Array  # time since the last time of the curve


def moment_at(times: Array, run: np.ndarray, time: Array) -> Moment:
    """Locate a time among the times of a run."""
    last = times.shape[1] - 1
    fixed, now = jax.lax.stop_gradient(times), jax.lax.stop_gradient(time)
    first = jnp.zeros(jnp.broadcast_shapes(run.shape, time.shape), int)
    for bit in reversed(range(last.bit_length())):
        there = jnp.minimum(first + (1 << bit), last - 1)
        first = jnp.where(fixed[run, there] <= now, there, first)
    begin, end = times[run, first], times[run, first + 1]
    # At the last time itself, where `jnp.minimum` would halve the slope, the slope is that of the curve.
    inside = jnp.where(time > times[run, -1], times[run, -1], time)
    return Moment(first, (inside - begin) / (end - begin), end - begin, time - inside)


def interpolated(curve: Curve, moment: Moment, *at: Any) -> Array:
    """The curve of a run, and if given of a cell, at a moment: the cubic through two values and rates."""
    run, *cell = at
    i, j = (run, moment.first, *cell), (run, moment.first + 1, *cell)
    x, begin = moment.part, curve.value[i]
    rise = curve.value[j] - begin
    u, v = moment.length * curve.rate[i], moment.length * curve.rate[j]
    return begin + x * (u + x * (3.0 * rise - 2.0 * u - v + x * (u + v - 2.0 * rise)))


def end_of(curves: RunCurves, run: np.ndarray) -> Array:
    """Reduced cycles after which less is left to wear than the rounding error of the volume."""
    decay, time = curves.decay[run, 0], curves.volume.time[run, -1]
    long = -2.0 * jnp.log(jnp.finfo(time.dtype).eps) / jnp.where(decay > 0.0, decay, jnp.inf)
    return curves.scales.unit[run] * (time + long)


def share_at(shares: Shares, run: np.ndarray, n: Array) -> Array:
    """The share of the final volume that is worn after n."""
    moment = moment_at(shares.volume.time, run, n / shares.unit[run])
    share = interpolated(shares.volume, moment, run)
    rest = 1.0 - shares.volume.value[run, -1]
    a, b = shares.decay[run, 0], shares.decay[run, 1]
    fall = jnp.exp(-a * moment.late)
    after = 1.0 - jnp.where(a > 0.0, a * rest * fall / jnp.where(a > 0.0, a + b * rest * (1.0 - fall), 1.0), 0.0)
    return jnp.where(moment.late > 0.0, after, share)
