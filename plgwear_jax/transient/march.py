"""The steps of a march, each until the contact has grown by one cell: its pressures and its time by Newton's method.

Vectors here have an entry a cell and one more for the time, since every separate number costs XLA a kernel to compile.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.transient.grid import Effort, Ring

__all__ = ["March", "marches_of"]


class _Step(NamedTuple):
    """A step: g (exp(P + w) - 1) + A w/l = H in the cells that touch, A w/l = H in the next, which begins to.

    w is what the step adds to P and l what it adds to n, beyond what the steps before have made known.
    """

    compliance: Array
    gap: Array
    steady: Array
    known: Array  # P without w
    touching: Array  # number of cells that touch


def _apart(found: Array) -> tuple[Array, Array]:
    """(w, 1/l) of a solution."""
    return found[:-1], found[-1]


def _excess(step: _Step, found: Array) -> Array:
    """(What each equation lacks; A w)."""
    added, pace = _apart(found)
    sunk = step.compliance @ added
    grown = step.gap * (jnp.exp(step.known + added) - 1.0)
    return jnp.stack([grown + pace * sunk - step.steady, sunk])


_HUGE = 1e30  # the square of no right side comes near it


def _newton(step: _Step, found: Array, excess: Array) -> Array:
    """Newton's change of what was found, by the slope of the excess; the pace at most trebles."""
    size = step.gap.size
    added, pace = _apart(found)
    number = np.arange(size + 3)
    touches = number[:size] < step.touching
    row = pace * step.compliance[step.touching]
    # Three more rows below the matrix: its factor then has the forward substitutions of three right sides there.
    slope = jnp.where(touches, step.gap * jnp.exp(step.known + added), 1.0)
    below = jnp.concatenate([jnp.where(touches, pace * step.compliance, 0.0), excess, row[None]])
    inside = number < step.touching
    whole = jnp.where(inside, jnp.pad(below, ((0, 0), (0, 3))), 0.0)
    whole = jnp.where((inside | (number >= size))[:, None], whole, 0.0)
    diagonal = jnp.concatenate([slope, jnp.full((3,), _HUGE, slope.dtype)])
    whole = jnp.where(number[:, None] == number, whole + diagonal, whole)
    factor = jax.lax.linalg.cholesky(whole, symmetrize_input=False)
    half = factor[size:, :size]
    # What the next cell lacks sets the pace.
    product = half @ half.T
    change = (product[2, 0] - excess[0, step.touching]) / (excess[1, step.touching] - product[2, 1])
    change = jnp.clip(change, -0.7 * pace, 2.0 * pace)
    right = (half[0] + change * half[1])[:, None]
    moved = jax.lax.linalg.triangular_solve(factor[:size, :size], right, left_side=True, lower=True, transpose_a=True)
    return jnp.append(-moved[:, 0], change)


_MOST = 40  # of Newton's steps; three or four are enough


@jax.custom_jvp
def _solved(step: _Step, start: Array) -> Array:
    """(w; 1/l) of a step, from a start."""
    enough = 1e-4 if start.dtype == jnp.float64 else 1e-3  # of a step that squares what it leaves

    def body(state: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        found, count, _ = state
        change = _newton(step, found, _excess(step, found))
        # Upwards like a diode's, or an exponential would overflow.
        added, pace = _apart(change)
        moved = jnp.append(jnp.where(added > 0.5, jnp.log1p(jnp.maximum(added, 0.0)), added), pace)
        found = found + moved
        relative = jnp.stack([moved, found]) / jnp.where(number == step.gap.size, found[-1], 1.0)
        square = relative @ relative.T
        return found, count + 1, square[0, 0] < enough**2 * square[1, 1]

    number = np.arange(step.gap.size + 1)
    begin = (start, jnp.int32(0), jnp.bool_(False))
    found, _, done = jax.lax.while_loop(lambda state: ~state[2] & (state[1] < _MOST), body, begin)
    return jnp.where(done, found, jnp.nan)


@_solved.defjvp
def _solved_jvp(primals, tangents):
    (step, start), (dstep, _) = primals, tangents
    found = _solved(step, start)

    def excess_of(compliance: Array, gap: Array, steady: Array, known: Array) -> Array:
        return _excess(_Step(compliance, gap, steady, known, step.touching), found)

    excess, lack = jax.jvp(excess_of, step[:4], dstep[:4])
    return found, _newton(step, found, jnp.stack([lack[0], excess[1]]))


class March(NamedTuple):
    """P, the pressure, the time and the volume at the end of each step."""

    worn: Array  # (steps, cells)
    pressure: Array
    time: Array
    volume: Array  # as a share of the final one


def marches_of(ring: Ring, effort: Effort) -> March:
    """All marches, one after the other."""
    # The number of the march, of the cells that touch, and of the step in it.
    rows = np.array(
        [
            (i, effort.inner * multiple + j, j)
            for i, multiple in enumerate(effort.multiples)
            for j in range(1, effort.outer * multiple + 1)
        ],
        np.int32,
    )
    size = ring.gap.shape[-1]
    number = np.arange(size + 1)
    packed = jnp.concatenate([ring.compliance, jnp.stack([ring.gap, ring.steady, ring.first], 1)], 1)

    def advance(before: Array, row: Array) -> tuple[Array, Array]:
        which, count, place = row
        first = place == 1
        here = packed[which]
        # The formula of second order with equal steps. Before the first one the march goes on as a square.
        share = jnp.where(first, 0.5, 2.0 / 3.0).astype(before.dtype)
        known = jnp.where(first, 0.0, (4.0 * before[0] - before[1]) / 3.0)
        # Slopes by the number of the step, with those of the first step as a start.
        one, two, three = before[2:]
        slope = jnp.maximum(3.0 * (one - two) + three, 0.25 * one)
        slope = jnp.where(first, 0.04 * jnp.append(here[-1], 1.0), slope)
        slope = jnp.where(number == count - 1, 0.5 * jnp.roll(slope, 1), slope)
        slope = jnp.where((number < count) | (number == size), share * slope, 0.0)
        start = jnp.where(number == size, 1.0 / slope[-1], slope)
        step = _Step(here[:size], here[size], here[size + 1], known[:-1], count)
        found = _solved(step, jax.lax.stop_gradient(start))
        change = jnp.where(number == size, 1.0 / found[-1], found)
        now, slope = known + change, change / share
        kept = jax.lax.stop_gradient(slope)
        past = jnp.where(
            first, jnp.stack([0.0 * kept, kept, 0.0 * kept, -kept]), jnp.stack([before[0], kept, one, two])
        )
        return jnp.concatenate([now[None], past]), jnp.stack([now, slope])

    begin = jnp.zeros((5, size + 1), ring.gap.dtype)
    now, slope = jnp.unstack(jax.lax.scan(advance, begin, jnp.asarray(rows))[1], axis=1)
    gap = jnp.concatenate(
        [
            jnp.broadcast_to(ring.gap[i] / jnp.sum(ring.steady[i]), (effort.outer * multiple, size))
            for i, multiple in enumerate(effort.multiples)
        ]
    )
    worn, time = now[:, :-1], now[:, -1]
    return March(worn, slope[:, :-1] / slope[:, -1:], time, jnp.sum(gap * jnp.expm1(worn), -1))
