"""A run around a constant stick area: the curves that its marches give, extrapolated in cells and steps."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.startup.programs import program
from plgwear_jax.special.elementary import clamped, in_dtype, ratio_where
from plgwear_jax.steady.batch import in_turn
from plgwear_jax.surfaces.cells import RingCells

from .curves import Curve, limited, moment_at
from .ring_cells import MarchResolution, Scales, weights
from .ring_march import March, marches_of


class Shares(NamedTuple):
    """The part of a run that tells which share of the final volume is worn, all of it as of `RunCurves`."""

    volume: Curve
    decay: Array
    slowing: Array
    unit: Array


class RunCurves(NamedTuple):
    """The result of a run: curves over time in its unit, and what reading them needs of the ring."""

    volume: Curve  # worn volume over the final volume
    edge: Curve  # (T - C)/C at the edge of the contact
    worn: Curve  # P in the cells
    decay: Array  # a: beyond the last time the volume left to wear, r, obeys r' = -(a + b r) r
    slowing: Array  # b
    ratio: Array  # H/g in the cells
    flat_punch_gap: Array  # Q/s integrated over the cells
    edges: Array  # T/C - 1 at the edges of the cells
    from_1: Array  # T/C - (a_0/c)^2 there
    # As of `Scales`
    final: Array
    unit: Array
    inner: Array
    width: Array

    @property
    def shares(self) -> Shares:
        """The worn volume alone."""
        return Shares(self.volume, self.decay, self.slowing, self.unit)


# --- from the marches -----------------------------------------------------------------------------------------------


def _polynomials(nodes: np.ndarray, places: np.ndarray, degree: int, slope: bool = False) -> np.ndarray:
    """The matrix of piecewise polynomial interpolation from values at the nodes to values, or slopes, at the places."""
    matrix, powers = np.zeros((places.size, nodes.size)), np.arange(degree + 1)
    first = np.clip(np.searchsorted(nodes, places) - powers.size // 2, 0, nodes.size - powers.size)
    near = first[:, None] + powers
    to_powers = np.linalg.inv((nodes[near] - places[:, None])[:, :, None] ** powers)
    np.put_along_axis(matrix, near, to_powers[:, int(slope)], 1)
    return matrix


@functools.cache
def _shared_steps(resolution: MarchResolution) -> np.ndarray:
    """The indices of the steps that all marches share, (marches, steps), among those of all marches."""
    multiple = np.array(resolution.refinements)[:, None]
    before = resolution.outer * (np.cumsum(multiple)[:, None] - multiple)  # the steps of the marches before
    return (before + multiple * np.arange(1, resolution.outer + 1) - 1).astype(np.uint32)  # JAX wraps other indices


@functools.cache
def _matrices(resolution: MarchResolution) -> tuple[np.ndarray, ...]:
    """Matrices that interpolate in the finest march.

    Returns:
        (From the steps that all marches share to all of its steps, the same by straight lines, the same for cells, from
        values at its steps to their slopes.)
    """
    finest, common = resolution.refinements[-1], np.arange(1, resolution.outer + 1)
    steps, shared = np.arange(resolution.steps + 1.0), np.arange(resolution.cells // finest)
    places = np.maximum(steps[1:] / finest, 1.0)
    cells = np.clip((np.arange(resolution.cells) + 0.5) / finest - 0.5, 0.0, shared[-1])
    return (
        _polynomials(common, places, 3),
        _polynomials(common, places, 1),
        _polynomials(shared, cells, 1).T,
        _polynomials(steps, steps, 4, slope=True),
    )


def _depths_and_pressures(ring: RingCells, march: March, resolution: MarchResolution) -> Array:
    """(h g, p) of the finest march, (2, steps, cells), each times the ratio of extrapolated to computed values.

    All marches divide the same coarse cells. At the steps that all marches share, the worn depths and loads of the
    coarse cells are extrapolated to small cells.
    """
    multiple, dtype, shared = resolution.refinements, ring.gap.dtype, _shared_steps(resolution)
    cell = np.arange(resolution.cells) // np.array(multiple)[:, None]  # the coarse cell of each one
    within = jnp.asarray(cell[:, :, None] == np.arange(resolution.cells // multiple[-1]), dtype)
    depth = ring.gap[:, None] * jnp.expm1(march.worn[shared])
    load = jnp.diff(ring.edges)[:, None] * march.pressure[shared]
    sums = jnp.stack([depth, load]) @ within
    limit = jnp.tensordot(jnp.asarray(weights(resolution, 2), dtype), sums, (0, 1))
    finest = sums[:, -1]
    counts = finest > 1e-9 * jnp.max(finest, (1, 2), keepdims=True)  # elsewhere rounding decides
    ratio = clamped(0.5, ratio_where(counts, limit, finest, 1.0), 1.5)
    _, to_steps, to_cells, _ = in_dtype(dtype, *_matrices(resolution))
    last = slice(-resolution.steps, None)
    both = jnp.stack([ring.gap[-1] * jnp.expm1(march.worn[last]), march.pressure[last]])
    return both * (to_steps @ ratio @ to_cells)


def _from(start: Any, x: Array) -> Array:
    """The values at all steps, with the value at time 0 in front."""
    return jnp.concatenate([jnp.full((1, *x.shape[1:]), start, x.dtype), x])


def curves_from(resolution: MarchResolution, ring: RingCells, scales: Scales) -> RunCurves:
    """The curves of a run, from the cells of each march, extrapolated to small cells and steps."""
    # Pressures are in the inverse of the unit of time.
    ring = ring._replace(compliance=ring.compliance / scales.unit, first=ring.first * scales.unit)
    march = marches_of(ring, resolution)
    depths, pressures = _depths_and_pressures(ring, march, resolution)
    multiple = resolution.refinements[-1]
    ring = jax.tree.map(lambda x: x[-1], ring)
    begin = resolution.inner * multiple
    edge = ring.edges[begin : begin + resolution.steps + 1]
    spread, _, _, slope = in_dtype(edge.dtype, *_matrices(resolution))
    # The edge of the contact has an error of first order in the cell size, time and volume of second order.
    each = jnp.stack([march.time, march.time, march.volume], -1)
    orders = np.stack([weights(resolution, order) for order in (2, 1, 2)], -1)
    shared = each[_shared_steps(resolution)]
    limit = jnp.sum(shared * jnp.asarray(orders[:, None], edge.dtype), 0)
    # Clipped, since at few digits the first steps would otherwise go backwards.
    ratio = clamped(0.25, spread @ (limit / shared[-1]), 4.0)
    time, edge_time, volume = jnp.unstack(_from(0.0, each[-resolution.steps :] * ratio), axis=1)
    by_step = slope @ jnp.stack([time, edge_time, volume, edge], -1)
    rate, growth = jnp.unstack(_from(np.array([1.0, np.inf]), by_step[1:, 2:] / by_step[1:, :2]), axis=1)
    # The volume left to wear, r, decays as r' = -(a + b r) r; a and b follow from the slopes at two late times.
    late = slice(-1 - multiple, None, multiple)
    left = 1.0 - volume[late]
    (before, fall), (wide, rest) = jnp.unstack(rate[late] / left), jnp.unstack(left)
    more = (fall - before) / (rest - wide)
    return RunCurves(
        limited(Curve(time, volume, rate)),
        limited(Curve(edge_time, edge, growth)),
        limited(Curve(time, _from(0.0, jnp.log1p(depths / ring.gap)), _from(ring.first, clamped(0.0, pressures)))),
        fall - more * rest,
        more,
        ring.steady / ring.gap,
        ring.flat_punch_gap,
        ring.edges,
        ring.from_1,
        *scales,
    )


@program(static=1, level=1)
def curves_by_parts(resolution: MarchResolution, rings: RingCells, scales: Scales) -> RunCurves:
    """The runs of rings of any bodies: one program for all of them, since it depends on the cells alone."""
    return in_turn(functools.partial(curves_from, resolution), scales.unit.shape, rings, scales)


# --- at any time ------------------------------------------------------------------------------------------------------


def share_at(shares: Shares | RunCurves, time: Array) -> Array:
    """The share of the final volume that is worn by a time, in the unit of the run."""
    moment = moment_at(shares.volume.time, time)
    rest, a = 1.0 - shares.volume.value[..., -1], shares.decay
    fall = jnp.exp(-a * moment.late)
    after = 1.0 - ratio_where(a > 0.0, a * rest * fall, a + shares.slowing * rest * (1.0 - fall))
    return jnp.where(moment.late > 0.0, after, moment.on(shares.volume))
