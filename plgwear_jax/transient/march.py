"""The steps in n: an implicit one of Euler's by Newton's method, and all of them one after the other."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.transient.grid import Ring, times_of

__all__ = ["March", "limit_of", "marches_of"]


class _Step(NamedTuple):
    """An implicit step of Euler's: g (exp(P + p) - 1) + A p = H for p >= 0, the integral of the pressure over it."""

    matrix: Array  # A over the step
    gap: Array
    steady: Array
    worn: Array  # P before the step


def _excess(step: _Step, p: Array) -> Array:
    return step.gap * (jnp.exp(step.worn + p) - 1.0) + step.matrix @ p - step.steady


def _newton(step: _Step, p: Array, touches: Array, lack: Array) -> Array:
    """-lack over the slope of the excess, in the cells that touch."""
    slope = jnp.where(touches, step.gap * jnp.exp(step.worn + p), 1.0)
    matrix = jnp.where(touches[:, None] & touches[None, :], step.matrix, 0.0) + jnp.diag(slope)
    factor = jax.lax.linalg.cholesky(matrix, symmetrize_input=False)
    return jax.scipy.linalg.cho_solve((factor, True), -jnp.where(touches, lack, 0.0))


_MOST = 60  # of Newton's steps; a step takes three or four


@jax.custom_jvp
def _solved(step: _Step, start: Array) -> Array:
    """p of the step from a start that is positive in the first cells. They touch up to a last one, which is found."""
    number = jnp.arange(start.size)
    enough = 1e-5 if start.dtype == jnp.float64 else 1e-3  # of a step that squares what it leaves

    def body(state: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
        p, touches, count, _ = state
        change = _newton(step, p, touches, _excess(step, p))
        # Upwards like a diode's, or an exponential would overflow; and no pressure is negative.
        moved = p + jnp.where(change > 0.5, jnp.log1p(jnp.maximum(change, 0.0)), change)
        wanted = jnp.where(touches, moved > 0.0, _excess(step, moved) < 0.0)
        last = jnp.max(jnp.where(wanted, number, 0))
        now = (number <= last) & (touches | (count < 12))
        largest = jnp.max(jnp.abs(change))
        done = jnp.all(now == touches) & (largest < enough * (1.0 + jnp.max(moved)))
        return jnp.where(now, jnp.maximum(moved, 0.0), 0.0), now, count + 1, done

    begin = (start, (start > 0.0) | (number == 0), jnp.int32(0), jnp.bool_(False))
    p, _, _, done = jax.lax.while_loop(lambda state: ~state[3] & (state[2] < _MOST), body, begin)
    return jnp.where(done, p, jnp.nan)


@_solved.defjvp
def _solved_jvp(primals, tangents):
    (step, start), (dstep, _) = primals, tangents
    p = _solved(step, start)
    _, lack = jax.jvp(lambda step: _excess(step, p), (step,), (dstep,))
    return p, _newton(step, p, p > 0.0, lack)


class March(NamedTuple):
    """P, its steps over time and whatever they give, at each end of a step."""

    worn: Array  # (steps, cells)
    pressure: Array


def _march(ring: Ring, steps: np.ndarray, fresh: np.ndarray) -> March:
    """All steps one after the other, those that are `fresh` from the unworn contact."""

    def advance(state: tuple[Array, Array], at: tuple[Array, Array]) -> tuple[tuple[Array, Array], March]:
        length, begins = at
        worn = jnp.where(begins, 0.0, state[0])
        pressure = jnp.where(begins, ring.first, state[1])
        step = _Step(ring.compliance / length, ring.gap, ring.steady, worn)
        p = _solved(step, pressure * length)
        state = worn + p, p / length
        return state, March(*state)

    zero = jnp.zeros_like(ring.gap)
    dtype = zero.dtype
    return jax.lax.scan(advance, (zero, zero), (jnp.asarray(steps, dtype), jnp.asarray(fresh)))[1]


def marches_of(ring: Ring, steps: int, levels: int) -> March:
    """The marches with steps halved once more each, at the times of the first: (levels, steps, cells)."""
    lengths = [np.diff(times_of(steps << level)) for level in range(levels)]
    fresh = [np.arange(x.size) == 0 for x in lengths]
    march = _march(ring, np.concatenate(lengths), np.concatenate(fresh))
    begins = [steps * ((1 << level) - 1) for level in range(levels)]
    ends = np.stack([begin + (np.arange(1, steps + 1) << level) - 1 for level, begin in enumerate(begins)])
    return March(march.worn[ends], march.pressure[ends])


def limit_of(values: Any) -> Any:
    """The limit of values whose error is a series in the step, which is halved along the first axis."""

    def extrapolated(x: Array) -> Array:
        return jnp.tensordot(jnp.asarray(_weights(x.shape[0]), x.dtype), x, 1)

    return jax.tree.map(extrapolated, values)


def _weights(levels: int) -> np.ndarray:
    """Those of Romberg's scheme: x[1] + (x[1] - x[0])/(2^i - 1) in its columns i = 1, 2, ..."""
    weights = np.eye(levels)
    for i in range(1, levels):
        weights = weights[1:] + np.diff(weights, axis=0) / (2.0**i - 1.0)
    return weights[0]
