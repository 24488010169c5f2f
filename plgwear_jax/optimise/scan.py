"""The scan of a search: the valleys from which it descends."""

import itertools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.optimise.descent import at_start, trial_points
from plgwear_jax.optimise.namespace import namespace
from plgwear_jax.optimise.state import DESCENT, Plan, Scanned, State, in_lanes

__all__ = [
    "overview",
    "scan_on",
    "seeded",
]


def scan_on(plan: Plan, state: State) -> State:
    """Ask for the next points of the scan."""
    xp = namespace(state.points)
    mesh, row = plan.mesh(), xp.minimum(state.passes, plan.passes - 1)
    points = mesh[row] if xp is np else jax.lax.dynamic_index_in_dim(jnp.asarray(mesh), row, keepdims=False)
    return state._replace(points=points)


class _Overview(NamedTuple):
    """The scan as a whole, each array with an entry a point."""

    values: Any  # of the objective
    excess: Any  # of the limits
    known: Any
    lowest: Any
    scale: Any


def overview(plan: Plan, scanned: Scanned) -> _Overview:
    """What the whole scan says."""
    xp, points = namespace(scanned.values), plan.samples**plan.variables
    values = scanned.values.reshape(-1, 1 + plan.limits)[:points]
    objective, excess = values[:, 0], xp.maximum(values[:, 1:], 0.0).sum(1)
    known = xp.isfinite(objective)
    lowest, highest = xp.where(known, objective, np.inf).min(), xp.where(known, objective, -np.inf).max()
    scale = xp.maximum(highest - lowest, 0.01 * xp.abs(lowest))
    scale = xp.where(scale > 0.0, scale, 1.0).astype(plan.dtype)
    return _Overview(objective, excess, known, lowest.astype(plan.dtype), scale)


def seeded(plan: Plan, state: State, scanned: Scanned) -> State:
    """Descents begun in the deepest valleys of the scan."""
    xp, seen = namespace(scanned.values), overview(plan, scanned)
    # Among points that break a limit, those that break it least.
    merit = (seen.values - seen.lowest) / seen.scale + 10.0 * seen.excess
    grid = plan.variables * (plan.samples,)
    valleys, count = _deepest_valleys(xp.where(seen.known, merit, np.inf).reshape(grid), plan.starts)
    axis = xp.asarray(plan.axis_points())
    start = xp.stack([axis[index] for index in xp.unravel_index(valleys, grid)], axis=-1)
    descent = at_start(plan, start, np.arange(plan.starts) >= count)
    return state._replace(
        phase=xp.full_like(state.phase, DESCENT),
        points=in_lanes(trial_points(plan, descent)),
        scale=seen.scale,
        valleys=count.astype(state.valleys.dtype),
        descent=descent,
    )


def _deepest_valleys(scanned: Any, count: int) -> tuple[Any, Any]:
    """Flat indices of the lowest scan points that no neighbour undercuts, and how many there are of them."""
    xp = namespace(scanned)
    valley = xp.isfinite(scanned)
    padded = xp.pad(scanned, 1, constant_values=np.inf)
    for offset in itertools.product((0, 1, 2), repeat=scanned.ndim):
        if offset == scanned.ndim * (1,):
            continue
        neighbour = padded[tuple(slice(o, o + size) for o, size in zip(offset, scanned.shape, strict=True))]
        # Of equal neighbours the first one is the valley.
        valley = valley & (scanned < neighbour if offset < scanned.ndim * (1,) else scanned <= neighbour)
    depths = xp.where(valley, scanned, np.inf).ravel()
    if xp is np:
        return np.argsort(depths, kind="stable")[:count], valley.sum()

    def next_deepest(depths: Array, _: None) -> tuple[Array, Array]:
        deepest = jnp.argmin(depths)
        return jnp.where(jnp.arange(depths.size) == deepest, jnp.inf, depths), deepest

    # Finding the minimum a few times is much faster than sorting by XLA.
    return jax.lax.scan(next_deepest, depths, length=count)[1], valley.sum()
