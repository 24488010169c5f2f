"""Where increasing functions of one number have a value, with derivatives by the implicit function theorem."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from .elementary import clamp_keep_slope, clamped, ratio_where, value_with_slope

_MOST = 120  # evaluations; six or seven are enough, but where the function jumps
_SECANTS = 30  # of them, after which intervals are halved


def root_of(
    function: Callable[[Array], Array], start: Array, slope: float, farthest: float = 2.0, enough: float = 1e-10
) -> Array:
    """The root, by secants within the bounds that are known so far.

    Args:
        function: Of a number; may use traced values, by which the root can be differentiated.
        start: An estimate.
        slope: One of the slope.
        farthest: No step is longer.
        enough: In float64 a step of this size is the last one.
    """
    dtype = start.dtype
    enough = enough if dtype == jnp.float64 else 1e-5

    def solve(function: Callable[[Array], Array], start: Array) -> Array:
        def body(state: tuple[Array, ...]) -> tuple[Array, ...]:
            x, low, high, before, value_before, count, _ = state
            value = function(x)
            below, run = value < 0.0, x - before
            low, high = lax.select(below, x, low), lax.select(below, high, x)
            rate = jnp.where(run != 0.0, (value - value_before) / run, slope)  # nothing here is differentiated
            step = clamped(-farthest, -value / clamped(jnp.finfo(dtype).tiny, rate), farthest)
            ahead, middle, size = x + step, 0.5 * (low + high), 1.0 + abs(x)
            outside = (ahead <= low) | (ahead >= high)
            # Where the function jumps, or only rounding is left, the bounds meet, and no step from there is short.
            met = high - low < 4.0 * jnp.finfo(dtype).eps * size
            arrived = (abs(step) < enough * size) | ~jnp.isfinite(value)
            halves = (outside | (count > _SECANTS)) & ~arrived & jnp.isfinite(middle)
            return lax.select(halves, middle, ahead), low, high, x, value, count + 1, met | arrived

        bound = dtype.type(jnp.inf)
        begin: Any = start, -bound, bound, start, bound, np.int32(0), np.False_
        found = lax.while_loop(lambda state: ~state[-1] & (state[-2] < _MOST), body, begin)
        return lax.select(found[-1] & jnp.isfinite(found[4]), found[0], jnp.full_like(start, jnp.nan))

    return lax.custom_root(
        function,
        lax.stop_gradient(start),
        solve,
        lambda linear, value: value / linear(jnp.ones_like(value)),
    )


def first_at(function: Callable[[Any, Array], Array], given: Any, goal: Array, end: Array) -> Array:
    """The first x from 0 to `end` at which functions that never fall reach their goals; infinite where they do not.

    Args:
        function: Elementwise, of the tree `given` and of an array x.
        given: What it depends on, and by which the result can be differentiated.
        goal: What it is to reach, an array.
        end: The largest x, which broadcasts against the goals.
    """
    fixed = lax.stop_gradient(given)
    end = lax.stop_gradient(jnp.broadcast_to(end, jnp.broadcast_shapes(jnp.shape(end), goal.shape)))
    last = function(fixed, end)
    reached, never = last >= goal, jnp.where(jnp.isnan(last + goal), jnp.nan, jnp.inf)
    goal = jnp.where(reached, goal, 0.5 * last)
    aim = lax.stop_gradient(goal)

    def halve(_: int, bounds: tuple[Array, Array]) -> tuple[Array, Array]:
        middle = 0.5 * (bounds[0] + bounds[1])
        below = function(fixed, middle) < aim
        return jnp.where(below, middle, bounds[0]), jnp.where(below, bounds[1], middle)

    low, high = lax.fori_loop(0, jnp.finfo(goal.dtype).nmant + 8, halve, (0.0 * last, end + 0.0 * last))
    x = 0.5 * (low + high)
    # Newton's steps carry the derivatives, the second one those of second order.
    for _ in range(2):
        value, slope = value_with_slope(lambda x: function(given, x), x)
        x = x + ratio_where(slope > 0.0, goal - value, slope)
    return jnp.where(reached, clamp_keep_slope(0.0, x), never)
