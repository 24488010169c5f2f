"""The search for the least value over a box as ask and tell: it asks for values at points and is told them.

A scan of the box finds the valleys, an optax descent goes down each of them, and Newton's method on the conditions of
Karush, Kuhn and Tucker finishes. Under limits there are valleys among the points that keep them, and where they are
broken least; the lowest of all points that keep them is the answer if no descent has ended as low. `begin` makes a
state, `state.points` are the points at which it asks for values, always the same number, and `tell` makes the next
state from the values and slopes, until `state.phase` is `DONE`:

    state = begin(plan)
    while state.phase != DONE:
        state = tell(plan, state, evaluate(state.points))

It works on NumPy arrays, where only the solver of optax is compiled, and on JAX arrays, where the loop becomes one
program. Variables are u in [-1, 1]. It is told rows of the objective and of the limits g <= 0, each a value followed by
its slopes by u, shape (lanes, 1 + m, 1 + n).
"""

import functools
import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.startup.programs import program
from plgwear_jax.special.elementary import namespace

from .conditions import conditions, inclination, projected, select, solved_by_elimination

# --- the parameters of a search ---------------------------------------------------------------------------------------


class SearchPlan(NamedTuple):
    """The parameters of a search; they determine its program.

    Attributes:
        variables: n, how many variables.
        limits: m, how many limits.
        samples: Points of the scan along each variable.
        starts: How many valleys to descend from.
        max_steps: Evaluations allowed on each descent.
        noise: Relative error of the objective, below which differences have no meaning.
        dtype: The dtype of all numbers.
        tries: How many lengths of steps a descent tries at once, at most `trials`.
        axis: Name of the axis along which `jax.vmap` batches problems, which then change phase together; None if there
            is no such axis or it is not known.
    """

    variables: int
    limits: int
    samples: int
    starts: int
    max_steps: int
    noise: float
    dtype: Any
    tries: int
    axis: str | None = None

    @property
    def trials(self) -> int:
        """Points for each start: steps of several lengths in a descent, a stencil in Newton's method."""
        return 2 * self.variables + 1

    @property
    def lanes(self) -> int:
        """The number of points in each evaluation."""
        return self.starts * self.trials

    @property
    def passes(self) -> int:
        """The number of evaluations of the scan."""
        return -(-(self.samples**self.variables) // self.lanes)

    @property
    def eps(self) -> float:
        """Relative rounding error."""
        return float(jnp.finfo(self.dtype).eps)

    @property
    def width(self) -> float:
        """The width of the stencil, whose differences of slopes stand for second derivatives."""
        return self.eps ** (1.0 / 3.0)

    @property
    def tolerance(self) -> float:
        """The relative slope at which it has converged: above rounding errors and noise, well below what users need."""
        return max(self.eps**0.625, min(self.noise, 1e-8))

    def axis_points(self) -> np.ndarray:
        """Points of the scan along a variable."""
        return np.linspace(-1.0, 1.0, self.samples).astype(self.dtype)

    def mesh(self) -> np.ndarray:
        """Points of the scan, (passes, lanes, n); the last evaluation is filled up with the first points."""
        points = np.stack(np.meshgrid(*self.variables * (self.axis_points(),), indexing="ij"), axis=-1)
        return np.resize(points, (self.passes, self.lanes, self.variables))

    def lengths(self) -> np.ndarray:
        """The lengths of the trial steps of a descent, in units of the longest; the last one fills the rest."""
        return 0.25 ** np.minimum(np.arange(self.trials), self.tries - 1).astype(self.dtype)


def plan_of(
    n: int,
    limits: int,
    dtype: Any = None,
    samples: int | None = None,
    starts: int | None = None,
    max_steps: int = 200,
    noise: float | None = None,
) -> SearchPlan:
    """The plan of the search for so many variables and limits."""
    dtype = np.dtype(jnp.result_type(float)) if dtype is None else dtype
    along = samples or {1: 65, 2: 33, 3: 17}.get(n, max(3, int(4096 ** (1.0 / n))))
    begun = min(along**n, starts or (3 if n == 1 else 24))
    noise = 16.0 * float(jnp.finfo(dtype).eps) if noise is None else noise
    return SearchPlan(n, limits, along, begun, max_steps, noise, dtype, 2 * n + 1)


# --- its state --------------------------------------------------------------------------------------------------------

SCAN, DESCENT, POLISH, DONE = np.arange(4, dtype=np.int32)  # the phases


class Descent(NamedTuple):
    """The state of each descent: the point, its values, the next trial steps, multipliers and penalty of the limits."""

    u: Any  # (starts, n)
    rows: Any  # (starts, 1 + m, 1 + n)
    step: Any  # (starts, n), the longest of the next trial steps
    memory: tuple[Any, ...]  # the leaves of the solver's state, (starts, ...) each
    multipliers: Any  # (starts, m)
    penalty: Any  # (starts,)
    steps: Any  # (starts,)
    done: Any  # (starts,)


class Point(NamedTuple):
    """Points and their values, with a first axis for each start, or a single point without it."""

    u: Any  # (n,)
    multipliers: Any  # (m,)
    rows: Any  # (1 + m, 1 + n)
    residual: Any  # of the conditions of a minimum

    @property
    def values(self) -> Any:
        """Those of the objective and of the limits, (1 + m,)."""
        return self.rows[..., 0]


class SearchState(NamedTuple):
    """A search under way."""

    phase: Any
    passes: Any  # evaluations so far
    points: Any  # whose values the search needs next, (lanes, n)
    scanned: Any  # rows, (passes, lanes, 1 + m, 1), and of one variable, where the proof needs them, with their slopes
    kept: Point  # the lowest that keeps the limits among all at which there are values; infinite if none does
    scale: Any  # the change of the objective and of each limit over the scan, (1 + m,)
    valleys: Any  # the number of valleys that the scan found
    descent: Descent
    best: Point  # with the least residual of the conditions that Newton's method has found from each start
    count: Any  # (starts,), of its steps


class SearchResult(NamedTuple):
    """The best minimum and its rival, and how the search ended."""

    pair: Point  # both along a first axis, the same point twice if there is no rival
    has_rival: Any
    ended: dict[str, Any]  # what is said of a `Minimum` besides


def all_done(plan: SearchPlan, done: Any) -> Any:
    """Whether all starts are done, in all problems of the batch."""
    everybody = done.all()
    return everybody if plan.axis is None else lax.pmin(everybody.astype(int), plan.axis) > 0


# --- descents and their ends ------------------------------------------------------------------------------------------


# The limits enter through an augmented Lagrangian; its multipliers are updated when a descent has settled. Each pass
# evaluates steps of several lengths at once. Of those at which the merit falls enough, it takes that with the lowest.


_LIGHTEST, _HEAVIEST = 300.0, 1e8  # penalties: with which a descent begins, and beyond which none goes on


def _solver(variables: int) -> Any:
    import optax  # a tenth of a second, which a process that loads its programs does without

    return optax.scale_by_lbfgs(memory_size=min(10, 2 * variables - 1))


@program()
def _empty_memory(start: Array) -> tuple[Array, ...]:
    """The memory of the solver before its first step, without its structure, which is made of classes of optax."""
    return tuple(jax.tree.leaves(jax.vmap(_solver(start.shape[1]).init)(start)))


def trial_points(plan: SearchPlan, at: Descent) -> Any:
    """The points of steps of several lengths; a descent that is done asks for nothing new."""
    xp = namespace(at.u)
    steps = plan.lengths()[:, None, None] * xp.where(at.done[:, None], 0.0, at.step)
    return xp.clip(at.u + steps, -1.0, 1.0).reshape(plan.lanes, -1)


def _merit(at: Descent, rows: Any) -> Any:
    return rows[..., 0, 0] + (_pushed(at, rows) ** 2 - at.multipliers**2).sum(-1) / (2.0 * at.penalty)


def _pushed(at: Descent, rows: Any) -> Any:
    """The updated multiplier of each limit, max(multiplier + penalty g, 0)."""
    return namespace(rows).maximum(at.multipliers + at.penalty[..., None] * rows[..., 1:, 0], 0.0)


def _merit_slope(at: Descent) -> Any:
    return inclination(at.rows, _pushed(at, at.rows))


def descended(plan: SearchPlan, state: SearchState, rows: Any) -> SearchState:
    """All descents a step further; when the last one is done, their ends are polished."""
    xp, at = namespace(rows), state.descent
    trials = state.points.reshape(plan.trials, plan.starts, plan.variables)
    enough = plan.eps**0.375  # from here on Newton's method is used

    after = _merit(at, rows)
    wanted = 1e-4 * (_merit_slope(at) * (trials - at.u)).sum(-1)
    falls = (after <= _merit(at, at.rows) + wanted + plan.noise * xp.abs(after)) & ~at.done
    taken, lowest = falls.any(0), xp.where(falls, after, np.inf).argmin(0)
    u, rows = (
        select(taken, new[lowest, np.arange(plan.starts)], old) for new, old in ((trials, at.u), (rows, at.rows))
    )
    shortest = plan.lengths()[-1] * at.step
    stuck = ~at.done & ~taken & (xp.abs(shortest).max(1) < enough)
    at = at._replace(u=u, rows=rows, step=0.25 * shortest, steps=at.steps + ~at.done)
    settled = stuck | (taken & (projected(at.u, _merit_slope(at)) < enough))
    pushed = _pushed(at, rows)
    violation = xp.abs(pushed - at.multipliers).max(1, initial=0.0) / at.penalty
    # Where a descent settles even under the largest penalty, limits that are broken cannot be kept.
    ends = settled & ((violation < enough) | (at.penalty >= _HEAVIEST))
    at = at._replace(
        multipliers=select(settled, pushed, at.multipliers),
        penalty=xp.where(settled, 4.0 * at.penalty, at.penalty),
        done=at.done | ends | (at.steps >= plan.max_steps),
    )
    at = _turned(plan, at, taken | settled)
    finished = all_done(plan, at.done)
    return state._replace(
        phase=xp.where(finished, POLISH, DESCENT),
        points=xp.where(finished, _stencil(plan, at.u), trial_points(plan, at)),
        descent=at,
    )


def _turned(plan: SearchPlan, at: Descent, turns: Any) -> Descent:
    """The next direction, along the bounds where they are met."""
    xp, gradient = namespace(at.u), _merit_slope(at)
    free = ~((at.u * gradient < 0.0) & (xp.abs(at.u) >= 1.0))
    gradient = xp.where(free, gradient, 0.0)
    direction, *memory = map(xp.asarray, _next_directions(at.u, gradient, at.memory))
    direction = select((direction * gradient).sum(1) < 0.0, direction, -gradient)
    # At most 0.4, so that it takes three steps from the middle of the box to a bound.
    longest = xp.maximum(xp.abs(direction).max(1, keepdims=True), plan.eps)
    direction = direction * xp.minimum(1.0, 0.4 / longest)
    return at._replace(
        step=select(turns, xp.where(free, direction, 0.0), at.step),
        memory=select(turns, tuple(memory), at.memory),
    )


@program()
def _next_directions(u: Any, gradient: Any, memory: Any) -> tuple[Any, ...]:
    """The directions and the memory that the solver of optax gives."""
    solver = _solver(u.shape[1])

    def one(u: Array, gradient: Array, memory: Any) -> tuple[Array, ...]:
        tree = jax.tree.structure(solver.init(u))
        upwards, memory = solver.update(gradient, tree.unflatten(memory), u)
        return -upwards, *jax.tree.leaves(memory)

    return jax.vmap(one)(u, gradient, memory)


# --- the end: Newton's method on the conditions of a minimum ----------------------------------------------------------


_ROUNDS, _MORE = 6, 6  # of Newton's method, and those added where it still converges
_NEAR = 1e-2  # residual below which it does


def _stencil(plan: SearchPlan, u: Any) -> Any:
    """Each point and its neighbours on both sides along each variable; close to a bound these are moved inwards."""
    xp, steps = namespace(u), plan.width * np.eye(plan.variables, dtype=plan.dtype)[:, None]
    inward = xp.clip(u, -1.0 + plan.width, 1.0 - plan.width)
    return xp.concatenate([u[None], inward + steps, inward - steps]).reshape(plan.lanes, plan.variables)


def polished(plan: SearchPlan, state: SearchState, rows: Any) -> SearchState:
    """A Newton step on the conditions. Differences of slopes stand for second derivatives: as good, and faster."""
    xp, at, n = namespace(rows), state.descent, plan.variables
    curvatures = xp.moveaxis(rows[1 : n + 1] - rows[n + 1 :], 0, -1)[..., 1:, :] / (2.0 * plan.width)
    here = conditions(rows[0], curvatures, at.u, at.multipliers)
    left = projected(at.u, inclination(rows[0], at.multipliers))
    left = xp.maximum(left, xp.abs(here.residual[:, n:]).max(1, initial=0.0))
    point = Point(at.u, at.multipliers, rows[0], left)
    change = -solved_by_elimination(here.matrix, here.residual)
    goes_on = ~_finished(plan, state)
    moves = xp.isfinite(change).all(1) & goes_on
    at = at._replace(
        u=select(moves, xp.clip(at.u + xp.clip(change[:, :n], -0.1, 0.1), -1.0, 1.0), at.u),
        multipliers=select(moves, xp.maximum(at.multipliers + change[:, n:], 0.0), at.multipliers),
    )
    best = select((left < state.best.residual) & goes_on, point, state.best)
    state = state._replace(points=_stencil(plan, at.u), descent=at, best=best, count=state.count + goes_on)
    return state._replace(phase=xp.where(all_done(plan, _finished(plan, state)), DONE, POLISH))


def _finished(plan: SearchPlan, at: SearchState) -> Any:
    left, unused = at.best.residual, np.arange(plan.starts) >= at.valleys
    converging = (left < _NEAR) & (left >= plan.tolerance)
    enough = max(4.0 * plan.eps, 0.25 * min(plan.noise, plan.tolerance))
    return unused | (at.count >= _ROUNDS) & ~converging | (at.count >= _ROUNDS + _MORE) | (left <= enough)


# --- from the scan to the answer --------------------------------------------------------------------------------------


def begin(plan: SearchPlan) -> SearchState:
    """The first state of a search, which asks for the first points of its scan."""
    starts, n, functions = plan.starts, plan.variables, 1 + plan.limits
    zeros, one, steps = functools.partial(np.zeros, dtype=plan.dtype), np.ones(starts, plan.dtype), np.int32(0)
    u, multipliers, rows = zeros((starts, n)), zeros((starts, plan.limits)), zeros((starts, functions, 1 + n))
    rows[:, 0, 0] = np.inf  # all that is evaluated lies lower
    best = Point(u, multipliers, rows, np.inf * one)
    descent = Descent(
        u=u,
        rows=rows,
        step=u,
        memory=_empty_memory(u),
        multipliers=multipliers,
        penalty=_LIGHTEST * one,
        steps=np.full(starts, steps),
        done=one < 0.0,
    )
    return SearchState(
        phase=SCAN,
        passes=steps,
        points=plan.mesh()[0],
        scanned=zeros((plan.passes, plan.lanes, functions, 2 if n == 1 else 1)),
        kept=jax.tree.map(lambda x: x[0], best),
        scale=np.ones(functions, plan.dtype),
        valleys=steps,
        descent=descent,
        best=best,
        count=descent.steps,
    )


def tell(plan: SearchPlan, state: SearchState, rows: Any) -> SearchState:
    """The state after the rows at `state.points` are known, (lanes, 1 + m, 1 + n)."""
    xp, old, values = namespace(rows), state.kept, rows[..., 0]
    keeps = xp.isfinite(values).all(1) & (values[:, 1:] <= 0.0).all(1)
    # Without limits it is that of the scan: around a minimum all points lie as low, up to rounding.
    height = xp.where(keeps & ((state.phase == SCAN) | (plan.limits > 0)), values[:, 0], np.inf)
    at = height.argmin()
    new = old._replace(u=state.points[at], rows=rows[at])
    kept = jax.tree.map(lambda this, that: xp.where(height[at] < old.values[0], this, that), new, old)
    # After the scan there is no such pass, and nothing changes.
    now = (np.arange(plan.passes) == state.passes)[:, None, None, None]
    scanned = xp.where(now, rows[..., : state.scanned.shape[-1]], state.scanned)
    # The scan is kept out of the branches, which would copy it.
    rest = state._replace(passes=state.passes + np.int32(1), scanned=None, kept=kept)
    rows = (rows / state.scale[:, None]).reshape(plan.trials, plan.starts, *rows.shape[1:])
    steps: tuple[Callable[[SearchState], SearchState], ...] = (
        lambda rest: rest._replace(points=xp.asarray(plan.mesh())[rest.passes]),
        lambda rest: _descents_from_valleys(plan, rest, scanned),
        lambda rest: descended(plan, rest, rows),
        lambda rest: polished(plan, rest, rows),
    )
    which = state.phase + (rest.passes >= plan.passes)
    with np.errstate(all="ignore"):  # values that are not finite are handled below
        rest = steps[int(which)](rest) if xp is np else lax.switch(which, steps, rest)
    return rest._replace(scanned=scanned)


# --- the scan: the valleys from which the search descends -------------------------------------------------------------

INFINITE = 1e3  # the value of a limit where what it limits is infinite


def _descents_from_valleys(plan: SearchPlan, state: SearchState, scanned: Any) -> SearchState:
    """The search with its descents begun in the deepest valleys of the scan."""
    xp, is_limit = namespace(scanned), np.arange(1 + plan.limits) > 0
    values = scanned[..., 0].reshape(-1, 1 + plan.limits)[: plan.samples**plan.variables]
    known = xp.isfinite(values).all(1)
    lowest = xp.where(known[:, None], values, np.inf).min(0)
    change = xp.where(known[:, None], values, -np.inf).max(0) - lowest
    # A limit that changes little over the box decides as much as one that changes by orders of magnitude.
    change = xp.where(is_limit, xp.minimum(change, 1.0), xp.maximum(change, 0.01 * xp.abs(lowest)))
    counts = xp.isfinite(change) & (change > np.where(is_limit, plan.eps**0.375, 0.0))
    scale = xp.where(counts, change, 1.0).astype(plan.dtype)

    above = values[:, 1:] / scale[1:]
    excess, worst = xp.maximum(above, 0.0).sum(1), above.max(1, initial=-np.inf)
    height, keeps = (values[:, 0] - lowest[0]) / scale[0], known & (worst <= 0.0)
    # Points that keep the limits lie below all others, which are the higher the more they break them.
    # Where some keep them, those are left out at which a limited stress is infinite.
    near = known & ((worst < INFINITE) | ~keeps.any())
    depth = xp.where(keeps, height, xp.where(near, 2.0 + excess, np.inf))
    valley = _valleys(plan, depth)
    valleys, count = xp.lexsort((xp.where(valley, depth, np.inf),))[: plan.starts], valley.sum()
    points = xp.asarray(plan.mesh().reshape(-1, plan.variables))
    start = points[valleys]
    for step in (-1, 1) if plan.limits and plan.variables == 1 else ():
        # Begun on a limit that is reached towards a lower neighbour: from a valley that keeps the limits a step would
        # go over a hill that is narrower than the scan.
        other = xp.clip(valleys + step, 0, plan.samples - 1)
        lower = keeps[valleys] & ~keeps[other] & known[other] & (height[other] < height[valleys])
        share = xp.where(lower, worst[valleys] / (worst[valleys] - worst[other]), 0.0)  # along a straight line
        start = start + share[:, None] * (points[other] - points[valleys])
    # No valley that breaks the limits may be worth more than one that keeps them, or a step leads there for good.
    kept_at = xp.where(valley & keeps, height, -np.inf).max()
    needed = xp.where(valley & ~keeps, 4.0 * (kept_at - height) / excess**2, 0.0).max(initial=0.0)
    descent = state.descent._replace(
        u=start,
        penalty=xp.where(keeps[valleys], xp.clip(needed, _LIGHTEST, 1e5), state.descent.penalty),
        done=np.arange(plan.starts) >= count,
    )
    return state._replace(
        phase=xp.asarray(DESCENT),
        points=trial_points(plan, descent),
        scale=scale,
        valleys=count.astype(state.valleys.dtype),
        descent=descent,
    )


def _valleys(plan: SearchPlan, heights: Any) -> Any:
    """Whether a point of the scan is finite and undercut by no neighbour."""
    xp, centre = namespace(heights), plan.variables * (1,)
    heights = heights.reshape(plan.variables * (plan.samples,))
    padded, valley = xp.pad(heights, 1, constant_values=np.inf), xp.isfinite(heights)
    for offset in itertools.product((0, 1, 2), repeat=plan.variables):
        neighbour = padded[tuple(slice(o, o + plan.samples) for o in offset)]
        # Of equal neighbours the first one is the valley.
        valley = valley & (heights < neighbour if offset < centre else heights <= neighbour)
    return valley.ravel()


# --- what was found ---------------------------------------------------------------------------------------------------


def conclude(plan: SearchPlan, state: SearchState) -> SearchResult:
    """The best minimum of a finished search, its rival, and whether it is certain."""
    xp, one, scale = namespace(state.scale), state.kept, state.scale[:, None]
    # A point that keeps limits is a design, also where no descent has ended in one as low.
    rows = one.rows / scale
    one = one._replace(rows=rows, residual=projected(one.u, rows[0, 1:]))
    points = jax.tree.map(lambda ends, x: xp.concatenate([ends, x[None]]), state.best, one)
    used = xp.append(np.arange(plan.starts) < state.valleys, plan.limits > 0) & xp.isfinite(points.values[:, 0])
    good = used & (points.residual < plan.tolerance)
    # An end may be higher by what the rounding of the objective and of its limits is worth.
    slack = 16.0 * plan.noise * (1.0 + xp.abs(points.values[:, 0]))
    value = points.values[:, 0] - xp.where(good, slack + plan.tolerance * points.multipliers.sum(1), 0.0)
    # The best keeps the limits; if none does, the one that breaks them least.
    broken = xp.maximum(points.values[:, 1:], 0.0).max(1, initial=0.0)
    broken = xp.where(good | ((broken <= 0.0) & (np.arange(broken.size) == plan.starts)), 0.0, 1.0 + broken)
    broken = xp.where(used, broken, np.inf)
    best = xp.where(broken == broken.min(), value, np.inf).argmin()
    distinct = xp.abs(points.u - points.u[best]).max(1) > 1e-3
    others = xp.where(good & distinct, value, np.inf)
    rival = others.argmin()
    has_rival = xp.isfinite(others[rival])

    certified = good[best] & (state.valleys <= plan.starts) & (value[best] <= one.values[0])
    scan_found_nothing_better = xp.zeros((), bool)
    if plan.variables == 1:
        rows = state.scanned.reshape(-1, *one.rows.shape)[: plan.samples] / scale
        with np.errstate(all="ignore"):
            nothing_hides = _nothing_hides(plan, rows, Point(*(x[best] for x in points)), slack[best])
        scan_found_nothing_better = certified & nothing_hides
    # Without a rival the best is used twice, since NaN would spoil all derivatives.
    pair = xp.stack([best, xp.where(has_rival, rival, best)])
    points = Point(
        points.u[pair],
        points.multipliers[pair] * scale[0] / scale[1:, 0],
        points.rows[pair] * scale,
        points.residual[pair],
    )
    ended = {
        "converged": good[best],
        "certified": certified,
        "scan_found_nothing_better": scan_found_nothing_better,
        "steps": state.descent.steps.max(),
    }
    return SearchResult(points, has_rival, ended)


def _nothing_hides(plan: SearchPlan, scanned: Any, best: Point, slack: Any) -> Any:
    """Whether no interval of the scan can contain a point that keeps the limits and is lower than the best.

    An interval is excluded if a limit is broken everywhere in it, if a lower bound of the objective, or of the
    Lagrangian, lies above the best, or if the Lagrangian is convex from there to the best, where it is stationary. The
    bounds are Taylor polynomials from both ends, with the least second derivative that the interval can have.

    The scan has rows of the objective and the limits, (samples, 1 + m, 2). A point may be lower by the slack.
    """
    xp, axis = namespace(scanned), plan.axis_points()
    step = axis[1] - axis[0]
    weights = xp.append(1.0, best.multipliers)[:, None]
    # the objective, the limits, and last the Lagrangian
    rows = xp.append(scanned, (weights * scanned).sum(1, keepdims=True), 1)
    values, slopes = rows[..., 0], rows[..., 1]

    # The mean second derivative of each interval is known. Its least value inside is taken as the least mean of the
    # interval and its neighbours, minus the larger difference between the means of neighbours.
    mean = xp.diff(slopes, axis=0) / step
    around = xp.pad(mean, ((1, 1), (0, 0)), mode="edge")
    change = xp.abs(xp.diff(around, axis=0))
    least = xp.minimum(mean, xp.minimum(around[:-2], around[2:])) - xp.maximum(change[:-1], change[1:])

    def bound(value: Any, inward: Any) -> Any:
        """The least value in each interval, from one of its ends."""

        def rise(distance: Any) -> Any:
            return distance * (inward + 0.5 * least * distance)

        lowest = xp.clip(-inward / xp.where(least > 0.0, least, 1.0), 0.0, step)
        return value + xp.where(least > 0.0, rise(lowest), xp.minimum(0.0, rise(step)))

    bounds = xp.maximum(bound(values[:-1], slopes[:-1]), bound(values[1:], -slopes[1:]))
    above = (bounds[:, [0, -1]] >= best.values[0] - slack).any(1) | (bounds[:, 1:-1] > 0.0).any(1)
    home = xp.clip((axis <= best.u).sum() - 1, 0, plan.samples - 2)
    bent = least[:, -1] < 0.0
    last = xp.cumsum(bent)
    first = last - bent
    convex = xp.maximum(last, last[home]) == xp.minimum(first, first[home])  # in all intervals from there to the best
    return (above | convex).all()
