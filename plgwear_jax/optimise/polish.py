"""The end of a search: Newton's method on the conditions of a minimum."""

from typing import Any

import numpy as np

from plgwear_jax.optimise.conditions import conditions, inclination, projected, solved
from plgwear_jax.optimise.namespace import namespace, select
from plgwear_jax.optimise.state import DONE, POLISH, Descent, Plan, Point, Polish, State, all_done, in_lanes, of_starts

__all__ = [
    "at_end",
    "polished_on",
    "stencil",
]


_ROUNDS = 6


def at_end(at: Descent) -> Polish:
    """Newton's method at the ends of the descents."""
    xp = namespace(at.u)
    infinite = xp.full_like(at.length, np.inf)
    unknown = Point(at.u, at.multipliers, at.u, xp.zeros_like(at.values), xp.zeros_like(at.slopes), infinite)
    return Polish(at.u, at.multipliers, unknown, xp.zeros_like(at.steps))


def stencil(plan: Plan, u: Any) -> Any:
    """Each point and its neighbours on both sides along each variable; close to a bound these are moved inwards."""
    xp, n = namespace(u), plan.variables
    steps = plan.width * np.concatenate([np.zeros((1, n)), np.eye(n), -np.eye(n)])
    inward = xp.clip(u, -1.0 + plan.width, 1.0 - plan.width)
    centre = xp.where(np.arange(plan.trials)[:, None] > 0, inward[:, None], u[:, None])
    return (centre + steps).astype(plan.dtype)


def polished_on(plan: Plan, state: State, values: Any, slopes: Any) -> State:
    """A Newton step on the conditions. Differences of slopes stand for second derivatives: as good, and faster."""
    xp, at, n = namespace(values), state.polish, plan.variables
    values, slopes = of_starts(plan, state, values, slopes)
    curvatures = xp.moveaxis(slopes[:, 1 : n + 1] - slopes[:, n + 1 :], 1, -1) / (2.0 * plan.width)
    values, slopes = values[:, 0], slopes[:, 0]
    here = conditions(values, slopes, curvatures, at.u, at.multipliers)
    left = projected(at.u, inclination(slopes, at.multipliers))
    if plan.limits > 0:
        left = xp.maximum(left, xp.abs(here.residual[:, n:]).max(1))
    side = xp.where(xp.abs(at.u) == 1.0, here.side, 0.0)
    point = Point(at.u, at.multipliers, side, values, slopes, left)
    change = -solved(here.matrix, here.residual)
    usable = xp.isfinite(change).all(1)
    moved = xp.clip(at.u + xp.clip(change[:, :n], -0.1, 0.1), -1.0, 1.0)
    raised = xp.maximum(at.multipliers + change[:, n:], 0.0)
    done = _finished(plan, at)
    at = Polish(
        u=select(usable & ~done, moved, at.u),
        multipliers=select(usable & ~done, raised, at.multipliers),
        best=select((left < at.best.residual) & ~done, point, at.best),
        count=at.count + (~done).astype(np.int32),
    )
    done = all_done(plan, _finished(plan, at) | (np.arange(plan.starts) >= state.valleys))
    return state._replace(
        phase=xp.where(done, DONE, POLISH).astype(np.int32), points=in_lanes(stencil(plan, at.u)), polish=at
    )


def _finished(plan: Plan, at: Polish) -> Any:
    return (at.count >= _ROUNDS) | (at.best.residual <= 4.0 * plan.eps)
