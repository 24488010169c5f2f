"""The steps of a march: each lasts until the contact has grown by one cell, with pressures and time by Newton's method.

Vectors here have an entry for the time in front of the entries of the cells, since XLA compiles a kernel for every
separate number.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax.special.cholesky import backward, cholesky, forward
from plgwear_jax.surfaces.cells import RingCells

from .ring_cells import MarchResolution


class _Step(NamedTuple):
    """A step: g (exp(P + w) - 1) + A w/l = H in the cells that touch, and A w/l = H in the cell that begins to touch.

    The unknowns are w, the increase of P, and l, the increase of n, beyond the values known from the steps before.
    """

    compliance: Array
    gap: Array
    steady: Array
    known: Array  # P without w
    touching: Array  # number of cells that touch


def _excess(step: _Step, found: Array) -> Array:
    """(The residual of each equation, A w) for (1/l; w)."""
    added = found[1:]
    sunk = step.compliance @ added
    return jnp.stack([step.gap * (jnp.exp(step.known + added) - 1.0) + found[0] * sunk - step.steady, sunk])


_HUGE = 1e30  # far above the square of any right side
_SIZES = 4  # number of matrix sizes that are compiled: the time to factor a matrix grows as the cube of its size


def _newton(step: _Step, found: Array) -> Array:
    """Newton's change of (1/l; w); that of the pace 1/l is limited to refinements of the pace."""
    pace, cells, excess = found[0], step.gap.size, _excess(step, found)
    touches = np.arange(cells) < step.touching
    # Huge numbers on the diagonal keep all other cells unchanged.
    slope = jnp.where(touches, step.gap * jnp.exp(step.known + found[1:]), _HUGE)
    below = jnp.concatenate([jnp.where(touches, excess, 0.0), pace * step.compliance[step.touching][None]])
    of_next = excess[:, step.touching]

    def change(size: int) -> Array:
        # With three right sides as rows below the matrix, its factor has their forward substitutions in these rows.
        whole = jnp.pad(jnp.concatenate([pace * step.compliance[:size, :size], below[:, :size]]), ((0, 0), (0, 3)))
        diagonal = jnp.append(slope[:size], jnp.full(3, _HUGE, slope.dtype))
        whole = whole + jnp.where(np.eye(size + 3, dtype=bool), diagonal, 0.0)
        factor = cholesky(whole)
        half = factor[size:, :size]
        # The equation of the next cell determines the pace.
        left = of_next - half[2] @ half[:2].T
        change = lax.clamp(-0.7 * pace, -left[0] / left[1], 2.0 * pace)
        moved = backward(factor[:size, :size], half[0] + change * half[1])
        return jnp.pad(jnp.append(change, -moved), (0, cells - size))

    sizes = [-(-cells * (i + 2) // (_SIZES + 1)) for i in range(_SIZES)]
    which = jnp.sum(step.touching > np.array(sizes[:-1]))
    changed = lax.switch(which, [functools.partial(change, size) for size in sizes])
    return jnp.where(np.arange(cells + 1) <= step.touching, changed, 0.0)


_MOST = 40  # Newton steps at most; two or three are enough


@jax.custom_jvp
def _solved(step: _Step, start: Array) -> Array:
    """(1/l; w) of a step, from a start."""
    enough = 3e-4 if start.dtype == jnp.float64 else 1e-3  # relative change after which the next error is its square

    def body(state: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        found, count, _ = state
        change = _newton(step, found)
        # Increases are limited to their logarithm, as for diodes in circuits, or an exponential would overflow.
        # Decreases are limited too. Those of cells may go below 0, since towards the end the formula of second order
        # overshoots a little.
        moved = jnp.where((change > 0.5) & (number > 0), jnp.log1p(jnp.maximum(change, 0.0)), change)
        moved = jnp.maximum(moved, -0.75 * jnp.maximum(found, number > 0))
        found = found + moved
        relative = jnp.stack([moved, found]) / jnp.where(number == 0, found[0], 1.0)
        square = jnp.sum(relative * relative, 1)
        return found, count + 1, square[0] < enough**2 * square[1]

    number = np.arange(step.gap.size + 1)
    begin = (start, jnp.int32(0), jnp.bool_(False))
    found, _, done = lax.while_loop(lambda state: ~state[2] & (state[1] < _MOST), body, begin)
    return jnp.where(done, found, jnp.nan)


@_solved.defjvp
def _solved_jvp(primals, tangents):
    # The change of (1/l; w) that removes the residual of the moved equations; linear in it, for reverse mode.
    (step, start), (dstep, _) = primals, tangents
    found = _solved(step, start)
    moved = jax.jvp(lambda *moving: _excess(_Step._make((*moving, step.touching)), found), step[:4], dstep[:4])[1]
    both, number = jnp.stack([step.compliance @ found[1:], moved[0]]), np.arange(step.gap.size)
    touches = number < step.touching
    slope = jnp.where(touches, step.gap * jnp.exp(step.known + found[1:]), 1.0)
    matrix = jnp.where(touches[:, None] & touches, found[0] * step.compliance, 0.0)
    factor = cholesky(matrix + jnp.where(number[:, None] == number, slope, 0.0))
    known = backward(factor, forward(factor, jnp.where(touches, both, 0.0).T))
    # The equation of the next cell determines the pace.
    left, rest = both[:, step.touching] - found[0] * step.compliance[step.touching] @ known
    change = -rest / left
    return found, jnp.append(change, -(known @ jnp.stack([change, jnp.ones_like(change)])))


class March(NamedTuple):
    """P, the pressure, the time and the volume at the end of each step."""

    worn: Array  # (steps, cells)
    pressure: Array
    time: Array
    volume: Array  # worn volume over the final volume


_FRONT = 4  # cells behind the edge of the contact, whose slopes depend mostly on their distance to it


def marches_of(ring: RingCells, resolution: MarchResolution) -> March:
    """All marches, one after the other."""
    # For each step: the index of its march, how many cells touch, and its number in the march.
    rows = np.array(
        [
            (i, resolution.inner * multiple + j, j)
            for i, multiple in enumerate(resolution.refinements)
            for j in range(1, resolution.outer * multiple + 1)
        ],
        np.uint32,  # JAX wraps other indices
    )
    marches, size = ring.gap.shape
    number = np.arange(size + 1)
    cells = jnp.stack([ring.gap, ring.steady], 1)
    # For the guesses, which are not differentiated: a slope to begin with, and what no cell wears more than.
    gap, steady, first = lax.stop_gradient((ring.gap, ring.steady, ring.first))
    bounds = jnp.stack([0.04 * first, jnp.log1p(steady / jnp.where(gap > 0.0, gap, 1.0))], 1)
    bounds = jnp.append(np.full((marches, 2, 1), [[0.04], [np.inf]], gap.dtype), bounds, -1)

    def advance(state: tuple[Array, ...], row: Array) -> tuple[tuple[Array, ...], Array]:
        last, before, *slopes = state
        which, count, place = jnp.unstack(row)
        (gap, steady), (begin, most) = jnp.unstack(cells[which]), jnp.unstack(bounds[which])
        first = place == 1
        # The BDF formula of second order with equal steps; in the first step P and n grow as squares.
        share = jnp.where(first, 0.5, 2.0 / 3.0).astype(gap.dtype)
        known = jnp.where(first, 0.0, (4.0 * last - before) / 3.0)
        # The parabola through the three slopes before, but at least a quarter of the last.
        front = (number > count - _FRONT) & (place > 3)
        one, two, three = (jnp.where(front, jnp.roll(slope, i), slope) for i, slope in enumerate(slopes, 1))
        slope = jnp.where(first, begin, jnp.maximum(3.0 * (one - two) + three, 0.25 * one))
        slope = jnp.where((number == count) & (place <= 3), 0.5 * jnp.roll(slope, 1), slope)
        # From a far larger exponential Newton's method would come down by 1 a time.
        start = jnp.minimum(share * slope, jnp.maximum(most - lax.stop_gradient(known), 0.0))
        start = jnp.where(number == 0, 1.0 / (share * slope[0]), jnp.where(number <= count, start, 0.0))
        found = _solved(_Step(ring.compliance[which], gap, steady, known[1:], count), start)
        change = jnp.where(number == 0, 1.0 / found[0], found)
        now, slope = known + change, change / share
        kept = lax.stop_gradient(slope)
        earlier = jnp.where(first, 0.0, slopes[0]), jnp.where(first, -kept, slopes[1])
        return (now, jnp.where(first, 0.0, last), kept, *earlier), jnp.stack([now, slope])

    # With derivatives from the start, or JAX would trace the steps twice for these.
    none = jnp.zeros(size + 1, gap.dtype)
    begin = none + 0.0 * ring.gap[0, 0]
    now, slope = jnp.unstack(lax.scan(advance, (begin, begin, none, none, none), jnp.asarray(rows))[1], axis=1)
    gap = (ring.gap / jnp.sum(ring.steady, -1, keepdims=True))[rows[:, 0]]
    worn = now[:, 1:]
    return March(worn, slope[:, 1:] / slope[:, :1], now[:, 0], jnp.sum(gap * jnp.expm1(worn), -1))
