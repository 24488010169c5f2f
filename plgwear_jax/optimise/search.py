"""The search for the least value over a box. It asks for values at points and is told them; it calls no objective.

A scan of the box finds the valleys, an optax descent goes down each of them, and Newton's method on the conditions of
Karush, Kuhn and Tucker finishes. Under limits there are valleys among the points that keep them, and where they are
broken least; the lowest of all points that keep them is the answer if no descent has ended as low. `begin` makes a
state, `state.points` are the points at which it asks for values, always the same number, and `tell` makes the next
state from the values and slopes, until `state.phase` is `DONE`:

    state = begin(plan)
    while state.phase != DONE:
        state = tell(plan, state, *evaluate(state.points))

It works on NumPy arrays, where only the solver of optax is compiled, and on JAX arrays, where the loop becomes one
program. Variables are u in [-1, 1]. Values are those of the objective and
of the limits g <= 0, shape (lanes, 1 + m), slopes those by u, shape (lanes, 1 + m, n).
"""

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.optimise.conditions import projected
from plgwear_jax.optimise.descent import at_end, at_start, descended, polished, trial_points
from plgwear_jax.optimise.search_state import (
    DESCENT,
    SCAN,
    Kept,
    Plan,
    Point,
    Scanned,
    Solution,
    State,
    in_lanes,
    namespace,
    tolerance,
    with_row,
)


def begin(plan: Plan) -> State:
    """The first state of a search, which asks for the first points of its scan."""
    n, m, mesh = plan.variables, plan.limits, plan.mesh()
    cells = np.zeros((plan.passes, plan.lanes, 1 + m), plan.dtype)
    scanned = Scanned(cells, cells if n == 1 else np.zeros(0, plan.dtype))
    functions, count = np.ones(1 + m, plan.dtype), np.zeros((), np.int32)
    kept = Kept(np.zeros(n, plan.dtype), np.inf * functions, np.zeros((1 + m, n), plan.dtype)) if m else None
    descent = at_start(plan, np.zeros((plan.starts, n), plan.dtype), np.zeros(plan.starts, bool))
    return State(count, count, mesh[0], scanned, kept, functions, count, descent, at_end(descent))


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
    state = state._replace(passes=state.passes + np.int32(1), scanned=scanned, kept=_kept(state, values, slopes))
    rest = state._replace(scanned=None)
    steps: tuple[Callable[[State], State], ...] = (
        lambda rest: _scan_on(plan, rest),
        lambda rest: _descents_from_valleys(plan, rest, scanned),
        lambda rest: descended(plan, rest, values, slopes, objective),
        lambda rest: polished(plan, rest, values, slopes),
        lambda rest: rest,
    )
    which = xp.where(scanning, (state.passes >= plan.passes).astype(np.int32), state.phase + np.int32(1))
    with np.errstate(all="ignore"):  # values that are not finite are handled below
        rest = steps[int(which)](rest) if xp is np else jax.lax.switch(which, steps, rest)
    return rest._replace(scanned=scanned)


def _kept(state: State, values: Any, slopes: Any) -> Kept | None:
    """The lowest point that keeps the limits, with those at which the search has asked last."""
    if state.kept is None:
        return None
    xp, old = namespace(values), state.kept
    keeps = xp.isfinite(values).all(1) & (values[:, 1:] <= 0.0).all(1)
    lowest = xp.where(keeps, values[:, 0], np.inf).argmin()
    better = keeps[lowest] & (values[lowest, 0] < old.values[0])
    new = Kept(state.points[lowest], values[lowest], slopes[lowest])
    return Kept(*(xp.where(better, this, that) for this, that in zip(new, old, strict=True)))


# --- the scan: the valleys from which the search descends -------------------------------------------------------------


def _scan_on(plan: Plan, state: State) -> State:
    """The search, asking for the next points of its scan."""
    xp = namespace(state.points)
    mesh, row = plan.mesh(), xp.minimum(state.passes, plan.passes - 1)
    points = mesh[row] if xp is np else jax.lax.dynamic_index_in_dim(jnp.asarray(mesh), row, keepdims=False)
    return state._replace(points=points)


class _Scan(NamedTuple):
    """The scan as a whole: the first three arrays have an entry for each point."""

    values: Any  # of the objective
    excess: Any  # sum of the limits that are broken, each over its scale
    known: Any
    lowest: Any
    scale: Any  # of the objective and of the limits, (1 + m,)


def _overview(plan: Plan, scanned: Scanned) -> _Scan:
    """The scan as a whole."""
    xp, points = namespace(scanned.values), plan.samples**plan.variables
    values = scanned.values.reshape(-1, 1 + plan.limits)[:points]
    known = xp.isfinite(values).all(1)
    lowest, highest = (
        end(xp.where(known[:, None], values, far), axis=0) for end, far in ((xp.min, np.inf), (xp.max, -np.inf))
    )
    # A limit that changes little over the box decides as much as one that changes by orders of magnitude.
    change = xp.where(
        np.arange(1 + plan.limits) == 0,
        xp.maximum(highest - lowest, 0.01 * xp.abs(lowest)),
        xp.minimum(highest - lowest, 1.0),
    )
    least = np.where(np.arange(1 + plan.limits) == 0, 0.0, plan.eps**0.375)
    scale = xp.where(xp.isfinite(change) & (change > least), change, 1.0).astype(plan.dtype)
    excess = xp.maximum(values[:, 1:] / scale[1:], 0.0).sum(1)
    return _Scan(values[:, 0], excess, known, lowest[0].astype(plan.dtype), scale)


def _descents_from_valleys(plan: Plan, state: State, scanned: Scanned) -> State:
    """The search with its descents begun in the deepest valleys of the scan."""
    xp, seen = namespace(scanned.values), _overview(plan, scanned)
    grid = plan.variables * (plan.samples,)
    height = (seen.values - seen.lowest) / seen.scale[0]
    merit = xp.where(seen.known, height + 10.0 * seen.excess, np.inf)
    valley = _valleys(merit.reshape(grid))
    if plan.limits:
        # First the valleys among points that keep the limits, then those where they are broken least.
        keeps = seen.known & (seen.excess <= 0.0)
        valley = valley | _valleys(xp.where(keeps, height, np.inf).reshape(grid))
        valley = valley | _valleys(xp.where(seen.known, seen.excess, np.inf).reshape(grid)) & ~keeps.reshape(grid)
        merit = xp.where(keeps, height, 2.0 + merit)
    valleys, count = _deepest(xp.where(valley.ravel(), merit, np.inf), plan.starts), valley.sum()
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


def _valleys(scanned: Any) -> Any:
    """Whether a point of the scan is finite and undercut by no neighbour."""
    xp = namespace(scanned)
    valley = xp.isfinite(scanned)
    padded = xp.pad(scanned, 1, constant_values=np.inf)
    for offset in itertools.product((0, 1, 2), repeat=scanned.ndim):
        if offset == scanned.ndim * (1,):
            continue
        neighbour = padded[tuple(slice(o, o + size) for o, size in zip(offset, scanned.shape, strict=True))]
        # Of equal neighbours the first one is the valley.
        valley = valley & (scanned < neighbour if offset < scanned.ndim * (1,) else scanned <= neighbour)
    return valley


def _deepest(depths: Any, count: int) -> Any:
    """The indices of the lowest numbers."""
    if namespace(depths) is np:
        return np.argsort(depths, kind="stable")[:count]

    def next_deepest(depths: Array, _: None) -> tuple[Array, Array]:
        deepest = jnp.argmin(depths)
        return jnp.where(jnp.arange(depths.size) == deepest, jnp.inf, depths), deepest

    # Finding the minimum a few times is much faster than sorting by XLA.
    return jax.lax.scan(next_deepest, depths, length=count)[1]


# --- what was found -------------------------------------------------------------------------------------------------


def conclude(plan: Plan, state: State) -> Solution:
    """The best minimum of a finished search, its rival, and whether it is certain."""
    xp, seen, points, scale = namespace(state.scale), _overview(plan, state.scanned), state.polish.best, state.scale
    used = np.arange(plan.starts) < state.valleys
    slack = 16.0 * plan.noise * (1.0 + xp.abs(seen.lowest) / scale[0])
    least = xp.where(seen.known & (seen.excess <= 0.0), seen.values, np.inf).min() / scale[0]
    if state.kept is not None:
        # A point that keeps the limits is a design, also where no descent has ended in one as low.
        kept = _as_point(plan, state.kept, scale)
        points = Point(*(xp.concatenate([ends, one[None]]) for ends, one in zip(points, kept, strict=True)))
        least, used = kept.values[0], xp.append(used, xp.isfinite(kept.values[0]))
    good = used & (points.residual < tolerance(plan.dtype))
    # An end may be higher by what the rounding of the objective and of its limits is worth.
    value = points.values[:, 0] - xp.where(good, slack + tolerance(plan.dtype) * points.multipliers.sum(1), 0.0)
    # The best keeps the limits; if none does, the one that breaks them least.
    broken = xp.maximum(points.values[:, 1:], 0.0).max(1, initial=0.0)
    broken = xp.where(good | ((broken <= 0.0) & (np.arange(broken.size) >= plan.starts)), 0.0, 1.0 + broken)
    broken = xp.where(used & xp.isfinite(value), broken, np.inf)
    best = xp.where(broken == broken.min(), value, np.inf).argmin()
    distinct = xp.abs(points.u - points.u[best]).max(1) > 1e-3
    others = xp.where(good & distinct, value, np.inf)
    rival = others.argmin()
    has_rival = xp.isfinite(others[rival])

    converged = good[best]
    certified = converged & (state.valleys <= plan.starts) & (value[best] <= least)
    proven = xp.zeros((), bool)
    if plan.variables == 1:
        scanned, inclined = (x.reshape(-1, 1 + plan.limits)[: plan.samples] / scale for x in state.scanned)
        u, values, multipliers = points.u[best, 0], points.values[best], points.multipliers[best]
        with np.errstate(all="ignore"):
            proven = certified & _nothing_hides(
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


def _as_point(plan: Plan, kept: Kept, scale: Any) -> Point:
    """The lowest point that keeps the limits, in the form of the end of a descent."""
    xp, slopes = namespace(scale), kept.slopes / scale[:, None]
    side = xp.where(xp.abs(kept.u) == 1.0, kept.u, 0.0)
    none = xp.zeros(plan.limits, plan.dtype)
    return Point(kept.u, none, side, kept.values / scale, slopes, projected(kept.u, slopes[0]))


def _nothing_hides(
    axis: Any, values: Any, slopes: Any, best: Any, best_values: Any, multipliers: Any, slack: Any
) -> Any:
    """Whether no interval of the scan can contain a point that keeps the limits and is lower than the best.

    An interval is excluded if a limit is broken everywhere in it, if a lower bound of the objective, or of the
    Lagrangian, lies above the best, or if the Lagrangian is convex from there to the best, where it is stationary. The
    bounds are Taylor polynomials from both ends, with the least second derivative that the interval can have.

    At the points of the scan, (samples,), there are values and slopes of the objective and the limits, (samples,
    1 + m); at the best point their values, (1 + m,), and the multipliers. A point may be lower by the slack.
    """
    xp = namespace(values, best)
    step = axis[1] - axis[0]
    # the objective, the limits, and last the Lagrangian
    weights = xp.concatenate([xp.ones_like(best_values[:1]), multipliers])
    values, slopes = (xp.concatenate([x, (weights * x).sum(1)[:, None]], axis=1) for x in (values, slopes))

    # The mean second derivative of each interval is known. Its least value inside is taken as the least mean of the
    # interval and its neighbours, minus the larger difference between the means of neighbours.
    mean = (slopes[1:] - slopes[:-1]) / step
    neighbours = xp.concatenate([mean[:1], mean, mean[-1:]])
    change = xp.abs(mean[1:] - mean[:-1])
    change = xp.concatenate([change[:1], change, change[-1:]])
    lowest = xp.minimum(mean, xp.minimum(neighbours[:-2], neighbours[2:]))
    least = lowest - xp.maximum(change[:-1], change[1:])

    def bound(value: Any, inward: Any) -> Any:
        """The least value in each interval, from one of its ends."""
        lowest_at = xp.clip(-inward / xp.where(least > 0.0, least, 1.0), 0.0, step)
        ends = xp.minimum(0.0, step * (inward + 0.5 * least * step))
        return value + xp.where(least > 0.0, lowest_at * (inward + 0.5 * least * lowest_at), ends)

    bounds = xp.maximum(bound(values[:-1], slopes[:-1]), bound(values[1:], -slopes[1:]))
    above = (bounds[:, 0] >= best_values[0] - slack) | (bounds[:, -1] >= best_values[0] - slack)
    above = above | xp.any(bounds[:, 1:-1] > 0.0, axis=1)
    intervals = xp.arange(axis.size - 1)
    home = xp.clip(xp.sum(axis <= best) - 1, 0, axis.size - 2)
    bent = least[:, -1] < 0.0
    before = xp.max(xp.where(bent & (intervals <= home), intervals, -1))
    behind = xp.min(xp.where(bent & (intervals >= home), intervals, axis.size))
    return xp.all(above | ((intervals > before) & (intervals < behind)))
