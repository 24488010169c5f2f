"""A run of the transient: its marches, extrapolated in cells and steps, and what they say at any time."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer

from plgwear_jax._startup.programs import program
from plgwear_jax.transient.batch import runs
from plgwear_jax.transient.grid import Effort, Ring, Scales, effort_of, rings_of
from plgwear_jax.transient.march import March, marches_of

__all__ = [
    "Course",
    "Curve",
    "Moment",
    "compiled_course",
    "course_from",
    "course_of",
    "interpolated",
    "limited",
    "moment_at",
    "share_at",
]


class Curve(NamedTuple):
    """A quantity that never falls and its rate, at growing times, in the unit of n."""

    time: Array  # (steps + 1,)
    value: Array  # (steps + 1, ...)
    rate: Array


class Course(NamedTuple):
    """What a run leaves behind."""

    volume: Curve  # as a share of the final one
    edge: Curve  # (T - C)/C at the edge of the contact
    worn: Curve  # P of the cells
    decay: Array  # by which the rest dies out beyond the last time, and by how much more per rest
    ratio: Array  # H/g of the cells
    swept: Array  # Q/s integrated over the cells
    edges: Array  # of the cells, T/C - 1
    scales: Scales
    pressure: Array | None = None  # of the cells, where it is not the rate of P
    stick: Array | None = None  # T/C - 1 of the stick radius at the times of the volume, where it grows


# --- from the marches -----------------------------------------------------------------------------------------------


def _polynomials(nodes: np.ndarray, places: np.ndarray, degree: int, slope: bool = False) -> np.ndarray:
    """The matrix that takes values at the nodes to values, or slopes, at the places, by polynomials."""
    matrix, count = np.zeros((places.size, nodes.size)), degree + 1
    for row, place in zip(matrix, places, strict=True):
        first = int(np.clip(np.searchsorted(nodes, place) - count // 2, 0, nodes.size - count))
        near = slice(first, first + count)
        row[near] = np.linalg.inv(np.vander(nodes[near] - place, increasing=True))[int(slope)]
    return matrix


def _depths_and_pressures(ring: Ring, march: March, effort: Effort) -> Array:
    """h g and p of the finest march, (2, steps, cells), times what the extrapolation makes of them.

    The cells of all marches fill the same coarse ones: their depths and loads are extrapolated where all marches meet.
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
    limit = jnp.tensordot(jnp.asarray(_weights(effort, 2), dtype), jnp.stack(sums), 1)
    told = sums[finest] > 1e-9 * jnp.max(sums[finest], (1, 2), keepdims=True)
    ratio = jnp.where(told, jnp.clip(limit / jnp.where(told, sums[finest], 1.0), 0.5, 1.5), 1.0)
    to_steps, to_cells = (jnp.asarray(x, dtype) for x in _spreads(effort))
    return each[finest] * (to_steps @ ratio @ to_cells)


@functools.cache
def _spreads(effort: Effort) -> tuple[np.ndarray, np.ndarray]:
    """From the steps and cells that all marches share to those of the finest, by straight lines."""
    multiple = max(effort.multiples)
    steps = np.maximum(np.arange(1, effort.steps + 1) / multiple, 1.0)
    count = effort.cells // multiple
    cells = np.clip((np.arange(effort.cells) + 0.5) / multiple - 0.5, 0.0, count - 1.0)
    return _polynomials(np.arange(1.0, effort.outer + 1), steps, 1), _polynomials(np.arange(float(count)), cells, 1).T


def _weights(effort: Effort, order: int) -> np.ndarray:
    """Of the marches, for errors that are series in the size of a cell that begin with a power, `order`."""
    powers = np.append(0.0, order + np.arange(len(effort.multiples) - 1.0))
    return np.linalg.inv(np.array(effort.multiples)[:, None] ** -powers)[0]


class _Matrices(NamedTuple):
    limit: np.ndarray  # from all steps of all marches to those that all marches share
    spread: np.ndarray  # from these to the steps of the finest march
    slope: np.ndarray  # at the steps of the finest march, from time 0 on


@functools.cache
def _matrices(effort: Effort, order: int) -> _Matrices:
    multiples, common = effort.multiples, np.arange(1, effort.outer + 1)
    weights = _weights(effort, order)
    limit, first = np.zeros((effort.outer, effort.outer * sum(multiples))), 0
    for multiple, weight in zip(multiples, weights, strict=True):
        limit[common - 1, first + common * multiple - 1] = weight
        first += effort.outer * multiple
    places = np.maximum(np.arange(1, effort.steps + 1) / max(multiples), 1.0)
    steps = np.arange(effort.steps + 1.0)
    return _Matrices(limit, _polynomials(common, places, 3), _polynomials(steps, steps, 4, slope=True))


def _from(start: Any, x: Array) -> Array:
    """The values with one at time 0 before them."""
    return jnp.concatenate([jnp.broadcast_to(jnp.asarray(start, x.dtype), (1, *x.shape[1:])), x])


def run(k: Array, phi: Array, effort: Effort) -> Course:
    """One run for numbers k and phi."""
    ring, scales = _begin.function(effort, k, phi)
    return course_from(ring, scales, effort)


def course_from(ring: Ring, scales: Scales, effort: Effort) -> Course:
    """The run of a ring in the cells of each march."""
    return _end.function(effort, ring, scales, marches_of(ring, effort))


@program(static=1, level=2, once=True)
def _begin(effort: Effort, k: Array, phi: Array) -> tuple[Ring, Scales]:
    return rings_of(k, jnp.where(phi > 0.0, phi, 0.5), effort)


@program(static=1, level=2)
def _marches(effort: Effort, ring: Ring) -> March:
    return marches_of(ring, effort)


@program(static=1, level=2, once=True)
def _end(effort: Effort, ring: Ring, scales: Scales, march: March) -> Course:
    """What is kept of the marches."""
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
        # Within bounds, or the first steps of few digits would go backwards.
        return _from(0.0, finest * jnp.clip(spread @ (limit @ x / finest[multiple - 1 :: multiple]), 0.25, 4.0))

    # The edge of the contact is known to a share of a cell.
    time, volume = limit(2, march.time, finest.time), limit(2, march.volume, finest.volume)
    edge_time = limit(1, march.time, finest.time)
    slope = jnp.asarray(_matrices(effort, 2).slope, time.dtype)
    by_step = slope @ jnp.stack([time, edge_time, volume, edge], -1)
    rate = jnp.concatenate([jnp.ones((1,), time.dtype), by_step[1:, 2] / by_step[1:, 0]])
    growth = jnp.concatenate([jnp.full((1,), jnp.inf, time.dtype), by_step[1:, 3] / by_step[1:, 1]])
    # The rest r dies out as r' = -(a + b r) r, which two of its last slopes tell.
    rest = 1.0 - jnp.stack([volume[-1], volume[-1 - multiple]])
    fall = jnp.stack([rate[-1], rate[-1 - multiple]]) / rest
    more = (fall[0] - fall[1]) / (rest[0] - rest[1])
    return Course(
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
    """The curve without falls, and without rates that would make a cubic fall."""
    time, value, rate = curve
    chord = jnp.maximum(jnp.diff(value, axis=0), 0.0) / jnp.diff(time).reshape(-1, *(1,) * (value.ndim - 1))
    before, after = jnp.concatenate([chord[:1], chord]), jnp.concatenate([chord, chord[-1:]])
    return Curve(time, value, jnp.clip(rate, 0.0, 3.0 * jnp.minimum(before, after)))


@program(static=1, level=1)
def compiled_course(effort: Effort, k: Array, phi: Array) -> Course:
    """Runs for all pairs of k and phi."""
    return runs(functools.partial(run, effort=effort), k, phi)


def course_of(k: Array, phi: Array, digits: int | None) -> Course:
    """The one program behind all functions here: what takes long to compile and to run.

    For one pair of numbers only the marches are compiled, and NumPy does what comes before and after.
    """
    effort = effort_of(digits)
    if k.size * phi.size != 1 or isinstance(k, Tracer) or isinstance(phi, Tracer) or jax.default_backend() != "cpu":
        return compiled_course(effort, k, phi)
    ring, scales = _begin(effort, *(x.reshape(()) for x in (k, phi)))
    course = _end(effort, ring, scales, _marches(effort, ring))
    return jax.tree.map(lambda x: x[None], course)


# --- at any time ----------------------------------------------------------------------------------------------------


class Moment(NamedTuple):
    """A time between those of a curve, or beyond the last one."""

    first: Array  # number of the interval
    part: Array  # of it
    length: Array
    late: Array  # time since the last one


def moment_at(times: Array, run: np.ndarray, time: Array) -> Moment:
    """Where a time is among those of a run."""
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
    """The cubic through two values and rates of a run, and of a cell of it."""
    run, *cell = at
    i, j = (run, moment.first, *cell), (run, moment.first + 1, *cell)
    x, begin = moment.part, curve.value[i]
    rise = curve.value[j] - begin
    u, v = moment.length * curve.rate[i], moment.length * curve.rate[j]
    return begin + x * (u + x * (3.0 * rise - 2.0 * u - v + x * (u + v - 2.0 * rise)))


def share_at(course: Course, run: np.ndarray, n: Array) -> Array:
    """The share of the final volume that is worn after n."""
    moment = moment_at(course.volume.time, run, n / course.scales.unit[run])
    share = interpolated(course.volume, moment, run)
    rest = 1.0 - course.volume.value[run, -1]
    a, b = course.decay[run, 0], course.decay[run, 1]
    fall = jnp.exp(-a * moment.late)
    after = 1.0 - jnp.where(a > 0.0, a * rest * fall / jnp.where(a > 0.0, a + b * rest * (1.0 - fall), 1.0), 0.0)
    return jnp.where(moment.late > 0.0, after, share)
