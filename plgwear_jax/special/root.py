"""The root of an increasing function of one number, with derivatives by the implicit function theorem."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import Array

__all__ = ["root_of"]

_MOST = 60  # evaluations; six or seven are enough


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
            low, high = jnp.where(value < 0.0, x, low), jnp.where(value < 0.0, high, x)
            run = x - before
            rate = jnp.where(run == 0.0, slope, (value - value_before) / jnp.where(run == 0.0, 1.0, run))
            step = jnp.where(rate > 0.0, -value / jnp.where(rate > 0.0, rate, 1.0), -jnp.sign(value) * farthest)
            step = jnp.clip(step, -farthest, farthest)
            outside = (x + step <= low) | (x + step >= high)
            done = (abs(step) < enough * (1.0 + abs(x))) | ~jnp.isfinite(value)
            moved = jnp.where(outside & ~done & jnp.isfinite(low + high), 0.5 * (low + high), x + step)
            return moved, low, high, x, value, count + 1, done

        bound = jnp.full_like(start, jnp.inf)
        begin = (start, -bound, bound, start, bound, jnp.int32(0), jnp.bool_(False))
        found = jax.lax.while_loop(lambda state: ~state[-1] & (state[-2] < _MOST), body, begin)
        return jnp.where(found[-1] & jnp.isfinite(found[4]), found[0], jnp.nan)

    def tangent(linear: Callable[[Array], Array], value: Array) -> Array:
        return value / linear(jnp.ones_like(value))

    return jax.lax.custom_root(function, jax.lax.stop_gradient(start), solve, tangent)
