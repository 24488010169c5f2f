"""A run around a constant stick area: the curves that its marches give, extrapolated in cells and steps."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.startup.programs import program
from plgwear_jax.special.elementary import clamped, ratio_where
from plgwear_jax.steady.batch import in_turn
from plgwear_jax.surfaces.cells import RingCells
from plgwear_jax.wear.curves import Curve, limited, moment_at
from plgwear_jax.wear.ring_cells import MarchResolution, Scales, weights
from plgwear_jax.wear.ring_march import March, marches_of


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
    from_1: Array  # T/C - (a_0/c)^2 there
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


def _depths_and_pressures(ring: RingCells, march: March, resolution: MarchResolution) -> Array:
    """(h g, p) of the finest march, (2, steps, cells), each times the ratio of extrapolated to computed values.

    All marches divide the same coarse cells. At the steps that all marches share, the worn depths and loads of the
    coarse cells are extrapolated to small cells.
    """
    multiple, dtype = np.array(resolution.refinements)[:, None], ring.gap.dtype
    first = resolution.outer * (np.cumsum(multiple) - multiple[:, 0])
    shared = first[:, None] + multiple * np.arange(1, resolution.outer + 1) - 1
    cell = np.arange(resolution.cells) // multiple  # the coarse cell of each one
    within = jnp.asarray(cell[:, :, None] == np.arange(resolution.cells // multiple[-1, 0]), dtype)
    depth = ring.gap[:, None] * jnp.expm1(march.worn[shared])
    load = jnp.diff(ring.edges)[:, None] * march.pressure[shared]
    sums = jnp.stack([depth, load]) @ within
    limit = jnp.tensordot(jnp.asarray(weights(resolution, 2), dtype), sums, (0, 1))
    finest = sums[:, -1]
    counts = finest > 1e-9 * jnp.max(finest, (1, 2), keepdims=True)  # elsewhere rounding decides
    ratio = clamped(0.5, ratio_where(counts, limit, finest, 1.0), 1.5)
    *_, to_steps, to_cells = (jnp.asarray(x, dtype) for x in _matrices(resolution, 2))
    last = slice(-resolution.steps, None)
    both = jnp.stack([ring.gap[-1] * jnp.expm1(march.worn[last]), march.pressure[last]])
    return both * (to_steps @ ratio @ to_cells)


class _Matrices(NamedTuple):
    limit: np.ndarray  # from all steps of all marches to those that all marches share
    spread: np.ndarray  # from these to the steps of the finest march
    slope: np.ndarray  # at the steps of the finest march, from time 0 on
    linear: np.ndarray  # as `spread`, by straight lines
    to_cells: np.ndarray  # the same from the cells that all marches share to those of the finest march


@functools.cache
def _matrices(resolution: MarchResolution, order: int) -> _Matrices:
    refinements, common = resolution.refinements, np.arange(1, resolution.outer + 1)
    limit, first = np.zeros((resolution.outer, resolution.outer * sum(refinements))), 0
    for multiple, weight in zip(refinements, weights(resolution, order), strict=True):
        limit[common - 1, first + common * multiple - 1] = weight
        first += resolution.outer * multiple
    finest = refinements[-1]
    steps, shared = np.arange(resolution.steps + 1.0), np.arange(resolution.cells // finest)
    places = np.maximum(steps[1:] / finest, 1.0)
    cells = np.clip((np.arange(resolution.cells) + 0.5) / finest - 0.5, 0.0, shared[-1])
    return _Matrices(
        limit,
        _polynomials(common, places, 3),
        _polynomials(steps, steps, 4, slope=True),
        _polynomials(common, places, 1),
        _polynomials(shared, cells, 1).T,
    )


def _from(start: Any, x: Array) -> Array:
    """The values at all steps, with the value at time 0 in front."""
    return jnp.concatenate([jnp.broadcast_to(jnp.asarray(start, x.dtype), (1, *x.shape[1:])), x])


def curves_from(resolution: MarchResolution, ring: RingCells, scales: Scales) -> RunCurves:
    """The curves of a run, from the cells of each march, extrapolated to small cells and steps."""
    march = marches_of(ring, resolution)
    depths, pressures = _depths_and_pressures(ring, march, resolution)
    multiple = resolution.refinements[-1]
    finest = jax.tree.map(lambda x: x[-resolution.steps :], march)
    ring = jax.tree.map(lambda x: x[-1], ring)
    begin = resolution.inner * multiple
    edge = ring.edges[begin : begin + resolution.steps + 1]

    def limit(order: int, x: Array, finest: Array) -> Array:
        limit, spread, *_ = (jnp.asarray(matrix, x.dtype) for matrix in _matrices(resolution, order))
        # Clipped, since at few digits the first steps would otherwise go backwards.
        return _from(0.0, finest * clamped(0.25, spread @ (limit @ x / finest[multiple - 1 :: multiple]), 4.0))

    # The edge of the contact has an error of first order in the cell size, time and volume of second order.
    time, volume = limit(2, march.time, finest.time), limit(2, march.volume, finest.volume)
    edge_time = limit(1, march.time, finest.time)
    slope = jnp.asarray(_matrices(resolution, 2).slope, time.dtype)
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
                _from(ring.first, clamped(0.0, pressures)),
            )
        ),
        jnp.stack([fall[0] - more * rest[0], more]),
        ring.steady / ring.gap,
        ring.swept,
        ring.edges,
        ring.from_1,
        scales,
    )


@program(static=1, level=1)
def curves_by_parts(resolution: MarchResolution, rings: RingCells, scales: Scales) -> RunCurves:
    """The runs of rings of any bodies: one program for all of them, since it depends on the cells alone."""
    return in_turn(functools.partial(curves_from, resolution), scales.unit.shape, rings, scales)


# --- at any time ------------------------------------------------------------------------------------------------------


def end_of(curves: RunCurves) -> Array:
    """The time after which less is left to wear than the rounding error of the volume."""
    decay, time = curves.decay[..., 0], curves.volume.time[..., -1]
    long = -2.0 * jnp.log(jnp.finfo(time.dtype).eps) / jnp.where(decay > 0.0, decay, jnp.inf)
    return curves.scales.unit * (time + long)


def share_at(shares: Shares, time: Array) -> Array:
    """The share of the final volume that is worn by then."""
    moment = moment_at(shares.volume.time, time / shares.unit)
    rest = 1.0 - shares.volume.value[..., -1]
    a, b = shares.decay[..., 0], shares.decay[..., 1]
    fall = jnp.exp(-a * moment.late)
    after = 1.0 - ratio_where(a > 0.0, a * rest * fall, a + b * rest * (1.0 - fall))
    return jnp.where(moment.late > 0.0, after, moment.on(shares.volume))


def volume_of(curves: RunCurves, phi: Array, time: Array) -> Array:
    """The volume that is worn by then."""
    return jnp.where(phi > 0.0, curves.scales.volume * share_at(curves.shares, time), 0.0)
