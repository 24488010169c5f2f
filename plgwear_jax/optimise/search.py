"""The search for the least value over a box. It asks for values at points and is told them; it calls no objective.

A scan of the box finds the valleys, an optax descent goes down each of them, and Newton's method on the conditions of
Karush, Kuhn and Tucker finishes. `begin` makes a state, `state.points` are the points at which it asks for values,
always the same number, and `tell` makes the next state from the values and slopes, until `state.phase` is `DONE`:

    state = begin(plan)
    while state.phase != DONE:
        state = tell(plan, state, *evaluate(state.points))

It works on NumPy arrays, where only the solver of optax is compiled, and on JAX arrays, where the loop becomes one
program. Variables are u in [-1, 1]. Values are those of the objective and
of the limits g <= 0, shape (lanes, 1 + m), slopes those by u, shape (lanes, 1 + m, n).
"""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from jax import Array

from plgwear_jax.optimise.descent import at_start, descended
from plgwear_jax.optimise.namespace import namespace
from plgwear_jax.optimise.polish import at_end, polished_on
from plgwear_jax.optimise.proof import nothing_hides
from plgwear_jax.optimise.scan import overview, scan_on, seeded
from plgwear_jax.optimise.state import SCAN, Plan, Scanned, Solution, State, tolerance, with_row

__all__ = [
    "begin",
    "conclude",
    "tell",
]


def begin(plan: Plan) -> State:
    """The first state of a search, which asks for the first points of its scan."""
    n, m, mesh = plan.variables, plan.limits, plan.mesh()
    cells = np.zeros((plan.passes, plan.lanes, 1 + m), plan.dtype)
    scanned = Scanned(cells, cells if n == 1 else np.zeros(0, plan.dtype))
    number, count = np.zeros((), plan.dtype), np.zeros((), np.int32)
    descent = at_start(plan, np.zeros((plan.starts, n), plan.dtype), np.zeros(plan.starts, bool))
    return State(count, count, mesh[0], scanned, number, count, descent, at_end(descent))


def tell(
    plan: Plan, state: State, values: Any, slopes: Any, objective: Callable[[Array], Array] | None = None
) -> State:
    """The state after the values and slopes at `state.points` are known.

    Args:
        plan: How the search is done.
        state: Where it stands.
        values: At the points, (lanes, 1 + m).
        slopes: By u, (lanes, 1 + m, n).
        objective: The values at a point u, (1 + m,), for a solver of optax that has a line search of its own.
    """
    xp = namespace(values)
    scanning = state.phase == SCAN
    scanned = with_row(state.scanned, xp.minimum(state.passes, plan.passes - 1), scanning, values, slopes[:, :, 0])
    # The scan is kept out of the branches, which would copy it.
    state = state._replace(passes=state.passes + np.int32(1), scanned=scanned)
    rest = state._replace(scanned=None)
    steps: tuple[Callable[[State], State], ...] = (
        lambda rest: scan_on(plan, rest),
        lambda rest: seeded(plan, rest, scanned),
        lambda rest: descended(plan, rest, values, slopes, objective),
        lambda rest: polished_on(plan, rest, values, slopes),
        lambda rest: rest,
    )
    which = xp.where(scanning, (state.passes >= plan.passes).astype(np.int32), state.phase + np.int32(1))
    with np.errstate(all="ignore"):  # values that are not finite are handled below
        rest = steps[int(which)](rest) if xp is np else jax.lax.switch(which, steps, rest)
    return rest._replace(scanned=scanned)


# --- what was found -------------------------------------------------------------------------------------------------


def conclude(plan: Plan, state: State) -> Solution:
    """The best minimum of a finished search, its rival, and whether it is certain."""
    xp, seen, points = namespace(state.scale), overview(plan, state.scanned), state.polish.best
    used = np.arange(plan.starts) < state.valleys
    # The best keeps the limits; if none does, the one that breaks them least.
    good = used & (points.residual < tolerance(plan.dtype))
    value = points.values[:, 0]
    broken = xp.maximum(points.values[:, 1:], 0.0).max(1, initial=0.0)
    worse = xp.where(used & xp.isfinite(value), xp.where(good, 0.0, 1.0 + broken), np.inf)
    best = xp.where(worse == worse.min(), value, np.inf).argmin()
    apart = xp.abs(points.u - points.u[best]).max(1) > 1e-3
    others = xp.where(good & apart, value, np.inf)
    rival = others.argmin()
    has_rival = xp.isfinite(others[rival])

    slack = 16.0 * plan.noise * (1.0 + xp.abs(seen.lowest) / state.scale)
    kept = seen.known & (seen.excess <= 0.0)
    reached = value[best] <= xp.where(kept, seen.values, np.inf).min() / state.scale + slack
    converged = good[best]
    certified = converged & (state.valleys <= plan.starts) & reached
    proven = xp.zeros((), bool)
    scale = xp.where(np.arange(1 + plan.limits) == 0, state.scale, 1.0)
    if plan.variables == 1:
        scanned, inclined = (x.reshape(-1, 1 + plan.limits)[: plan.samples] / scale for x in state.scanned)
        u, values, multipliers = points.u[best, 0], points.values[best], points.multipliers[best]
        with np.errstate(all="ignore"):
            proven = certified & nothing_hides(
                xp.asarray(plan.axis_points()), scanned, inclined, u, values, multipliers, slack
            )
    # Without a rival the best is used twice, since NaN would spoil all derivatives.
    pair = xp.stack([best, xp.where(has_rival, rival, best)])
    return Solution(
        u=points.u[pair],
        multipliers=points.multipliers[pair],
        values=points.values[pair] * scale,
        slopes=points.slopes[pair] * scale[:, None],
        side=points.side[best],
        scale=state.scale,
        residual=points.residual[best],
        converged=converged,
        certified=certified,
        proven=proven,
        has_rival=has_rival,
        steps=state.descent.steps.max(),
    )
