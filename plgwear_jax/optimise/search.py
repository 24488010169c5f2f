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

import functools
import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array
from jax.typing import DTypeLike

from plgwear_jax._core.programs import Program
from plgwear_jax.optimise.conditions import conditions, inclination, projected, solved
from plgwear_jax.optimise.namespace import namespace, select
from plgwear_jax.optimise.proof import nothing_hides

__all__ = ["DONE", "Plan", "Solution", "State", "begin", "conclude", "tell", "tolerance"]

SCAN, DESCENT, POLISH, DONE = range(4)


class Plan(NamedTuple):
    """The parameters of a search; they determine its program.

    Attributes:
        variables: n, how many variables.
        limits: m, how many limits.
        samples: Points of the scan along each variable.
        starts: How many valleys to descend from.
        max_steps: Evaluations allowed on each descent.
        noise: Relative error of the objective, below which differences have no meaning.
        dtype: Of all numbers.
        solver: An optax transformation; None for L-BFGS with a backtracking line search.
        axis: Name of the axis along which `jax.vmap` batches problems, which then change phase together; None if there
            is no such axis or it is not known.
    """

    variables: int
    limits: int
    samples: int
    starts: int
    max_steps: int
    noise: float
    dtype: DTypeLike
    solver: optax.GradientTransformation | None = None
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
        """The number of evaluations of the scan; the last one is padded."""
        return -(-(self.samples**self.variables) // self.lanes)

    @property
    def eps(self) -> float:
        """Relative rounding error."""
        return float(jnp.finfo(self.dtype).eps)

    @property
    def width(self) -> float:
        """The width of the stencil, whose differences of slopes stand for second derivatives."""
        return self.eps ** (1.0 / 3.0)

    def axis_points(self) -> np.ndarray:
        """Points of the scan along a variable."""
        return np.linspace(-1.0, 1.0, self.samples).astype(self.dtype)

    def mesh(self) -> np.ndarray:
        """Points of the scan, (passes, lanes, n)."""
        axes = np.meshgrid(*self.variables * (self.axis_points(),), indexing="ij")
        points = np.stack([axis.ravel() for axis in axes], axis=-1)
        filled = np.pad(points, ((0, self.passes * self.lanes - len(points)), (0, 0)), mode="edge")
        return filled.reshape(self.passes, self.lanes, self.variables)


class Scanned(NamedTuple):
    """The results of the scan; slopes are kept only for one variable, where the proof needs them."""

    values: Any  # (passes, lanes, 1 + m)
    slopes: Any  # (passes, lanes, 1 + m), or empty for several variables


class Descent(NamedTuple):
    """The state of each descent: the point, its values, the next trial steps, multipliers and penalty of the limits."""

    u: Any  # (starts, n)
    values: Any  # (starts, 1 + m)
    slopes: Any  # (starts, 1 + m, n)
    free: Any  # (starts, n), variables that are not on a bound
    direction: Any  # (starts, n)
    length: Any  # (starts,), of the longest of the next trial steps
    memory: optax.OptState
    fresh: Any  # (starts,), the memory has to be reset
    multipliers: Any  # (starts, m)
    penalty: Any  # (starts,)
    violation: Any  # (starts,)
    steps: Any  # (starts,)
    done: Any  # (starts,)


class Point(NamedTuple):
    """Stationary points and their values, one for each start."""

    u: Any
    multipliers: Any
    side: Any
    values: Any
    slopes: Any
    residual: Any


class Polish(NamedTuple):
    """The state of Newton's method, and the points with the least residual of the conditions."""

    u: Any
    multipliers: Any
    best: Point
    count: Any  # (starts,), steps


class State(NamedTuple):
    """A search under way."""

    phase: Any
    passes: Any  # evaluations so far
    points: Any  # asked for next, (lanes, n)
    scanned: Scanned
    scale: Any  # the change of the objective over the scan
    valleys: Any  # the number of valleys that the scan found
    descent: Descent
    polish: Polish


class Solution(NamedTuple):
    """The best minimum and its rival, and how the search ended."""

    u: Any  # (2, n), the same point twice if there is no rival
    multipliers: Any  # (2, m), of the objective over its scale
    values: Any  # (2, 1 + m)
    slopes: Any  # (2, 1 + m, n)
    side: Any  # of the best
    scale: Any  # of the objective
    residual: Any
    converged: Any
    certified: Any
    proven: Any
    has_rival: Any
    steps: Any


def tolerance(dtype: DTypeLike) -> float:
    """The relative slope at which a search has converged: well above rounding errors, well below what users need."""
    return float(np.finfo(np.dtype(dtype)).eps) ** 0.625


# --- ask and tell -----------------------------------------------------------------------------------------------------


def begin(plan: Plan) -> State:
    """The first state of a search, which asks for the first points of its scan."""
    n, m, mesh = plan.variables, plan.limits, plan.mesh()
    cells = np.zeros((plan.passes, plan.lanes, 1 + m), plan.dtype)
    scanned = Scanned(cells, cells if n == 1 else np.zeros(0, plan.dtype))
    number, count = np.zeros((), plan.dtype), np.zeros((), np.int32)
    descent = _at_start(plan, np.zeros((plan.starts, n), plan.dtype), np.zeros(plan.starts, bool))
    return State(count, count, mesh[0], scanned, number, count, descent, _at_end(descent))


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
    scanned = _written(state.scanned, xp.minimum(state.passes, plan.passes - 1), scanning, values, slopes[:, :, 0])
    # The scan is kept out of the branches, which would copy it.
    state = state._replace(passes=state.passes + np.int32(1), scanned=scanned)
    rest = state._replace(scanned=None)
    steps: tuple[Callable[[State], State], ...] = (
        lambda rest: _scan_on(plan, rest),
        lambda rest: _seeded(plan, rest, scanned),
        lambda rest: _descended(plan, rest, values, slopes, objective),
        lambda rest: _polished(plan, rest, values, slopes),
        lambda rest: rest,
    )
    which = xp.where(scanning, (state.passes >= plan.passes).astype(np.int32), state.phase + np.int32(1))
    with np.errstate(all="ignore"):  # values that are not finite are handled below
        rest = steps[int(which)](rest) if xp is np else jax.lax.switch(which, steps, rest)
    return rest._replace(scanned=scanned)


def _written(scanned: Scanned, row: Any, scanning: Any, values: Any, slopes: Any) -> Scanned:
    """The scan with one more row."""

    def written(rows: Any, new: Any) -> Any:
        if rows.size == 0:
            return rows
        if isinstance(rows, np.ndarray) and isinstance(new, np.ndarray):
            return np.where((scanning & (np.arange(len(rows)) == row))[:, None, None], new, rows)
        old = jax.lax.dynamic_index_in_dim(rows, row, keepdims=False)
        return jax.lax.dynamic_update_index_in_dim(rows, jnp.where(scanning, new, old), row, 0)

    return Scanned(written(scanned.values, values), written(scanned.slopes, slopes))


def _everybody(plan: Plan, done: Any) -> Any:
    """Whether all starts are done, in all problems of the batch."""
    everybody = done.all()
    return everybody if plan.axis is None else jax.lax.pmin(everybody.astype(int), plan.axis) > 0


def _in_lanes(points: Any) -> Any:
    """Trials of all starts, (starts, trials, n), as points of one evaluation."""
    return points.reshape(-1, points.shape[-1])


def _of_starts(plan: Plan, state: State, values: Any, slopes: Any) -> tuple[Any, Any]:
    """The values and slopes for each start and its trials, with the objective divided by its scale."""
    xp = namespace(values)
    scale = xp.where(np.arange(values.shape[1]) == 0, state.scale, 1.0)
    values, slopes = values / scale, slopes / scale[:, None]
    return tuple(x.reshape(plan.starts, plan.trials, *x.shape[1:]) for x in (values, slopes))


# --- the scan -------------------------------------------------------------------------------------------------------


def _scan_on(plan: Plan, state: State) -> State:
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


def _overview(plan: Plan, scanned: Scanned) -> _Overview:
    xp, points = namespace(scanned.values), plan.samples**plan.variables
    values = scanned.values.reshape(-1, 1 + plan.limits)[:points]
    objective, excess = values[:, 0], xp.maximum(values[:, 1:], 0.0).sum(1)
    known = xp.isfinite(objective)
    lowest, highest = xp.where(known, objective, np.inf).min(), xp.where(known, objective, -np.inf).max()
    scale = xp.maximum(highest - lowest, 0.01 * xp.abs(lowest))
    scale = xp.where(scale > 0.0, scale, 1.0).astype(plan.dtype)
    return _Overview(objective, excess, known, lowest.astype(plan.dtype), scale)


def _seeded(plan: Plan, state: State, scanned: Scanned) -> State:
    """Descents begun in the deepest valleys of the scan."""
    xp, seen = namespace(scanned.values), _overview(plan, scanned)
    # Among points that break a limit, those that break it least.
    merit = (seen.values - seen.lowest) / seen.scale + 10.0 * seen.excess
    grid = plan.variables * (plan.samples,)
    valleys, count = _deepest_valleys(xp.where(seen.known, merit, np.inf).reshape(grid), plan.starts)
    axis = xp.asarray(plan.axis_points())
    start = xp.stack([axis[index] for index in xp.unravel_index(valleys, grid)], axis=-1)
    descent = _at_start(plan, start, np.arange(plan.starts) >= count)
    return state._replace(
        phase=xp.full_like(state.phase, DESCENT),
        points=_in_lanes(_trials(plan, descent)),
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


# --- the descent ----------------------------------------------------------------------------------------------------

# The limits enter through an augmented Lagrangian; its multipliers are updated when a descent has settled. Each pass
# evaluates steps of several lengths at once, and takes the longest one at which the merit falls enough.


_HEAVIEST = 1e6  # penalty


def _solver(plan: Plan) -> optax.GradientTransformationExtraArgs:
    memory = min(10, 2 * plan.variables - 1)
    default = optax.chain(optax.scale_by_lbfgs(memory_size=memory), optax.scale(-1.0))
    return optax.with_extra_args_support(plan.solver or default)


@functools.lru_cache(maxsize=32)
def _memory(plan: Plan) -> optax.OptState:
    """The memory of the solver, in the right shape, before its first step."""
    start = jax.ShapeDtypeStruct((plan.starts, plan.variables), plan.dtype)
    shapes = jax.eval_shape(jax.vmap(_solver(plan).init), start)
    return jax.tree.map(lambda leaf: np.zeros(leaf.shape, leaf.dtype), shapes)


def _at_start(plan: Plan, start: Any, unused: Any) -> Descent:
    xp, m = namespace(start, unused), plan.limits
    one = np.ones(plan.starts, plan.dtype)
    # The first pass evaluates the starting points, which are accepted.
    values = np.zeros((plan.starts, 1 + m), plan.dtype)
    values[:, 0] = np.inf
    descent = Descent(
        u=start,
        values=values,
        slopes=np.zeros((plan.starts, 1 + m, plan.variables), plan.dtype),
        free=np.ones((plan.starts, plan.variables), bool),
        direction=np.zeros((plan.starts, plan.variables), plan.dtype),
        length=one,
        memory=_memory(plan),
        fresh=one > 0.0,
        multipliers=np.zeros((plan.starts, m), plan.dtype),
        penalty=300.0 * one,  # large, so that no descent leaves a valley that keeps the limits for one that breaks them
        violation=np.inf * one,
        steps=np.zeros(plan.starts, np.int32),
        done=unused,
    )
    return jax.tree.map(xp.asarray, descent)


def _lengths(plan: Plan) -> np.ndarray:
    """The lengths of the trial steps, in units of the longest; with a solver from the caller all are the same."""
    return (0.25 ** np.arange(plan.trials) if plan.solver is None else np.ones(plan.trials)).astype(plan.dtype)


def _trials(plan: Plan, at: Descent) -> Any:
    steps = (at.length[:, None] * _lengths(plan))[..., None] * at.direction[:, None]
    return namespace(at.u).clip(at.u[:, None] + steps, -1.0, 1.0)


def _merit(values: Any, multipliers: Any, penalty: Any) -> Any:
    pushed = _pushed(values, multipliers, penalty)
    return values[..., 0] + (pushed**2 - multipliers**2).sum(-1) / (2.0 * penalty)


def _pushed(values: Any, multipliers: Any, penalty: Any) -> Any:
    """The updated multiplier of each limit, max(multiplier + penalty g, 0)."""
    return namespace(values).maximum(multipliers + penalty[..., None] * values[..., 1:], 0.0)


def _merit_slope(at: Descent) -> Any:
    return inclination(at.slopes, _pushed(at.values, at.multipliers, at.penalty))


def _descended(plan: Plan, state: State, values: Any, slopes: Any, objective: Callable[[Array], Array] | None) -> State:
    """All descents a step further; when the last one is done, their ends are polished."""
    xp, at = namespace(values), state.descent
    trials = state.points.reshape(plan.starts, plan.trials, -1)
    values, slopes = _of_starts(plan, state, values, slopes)
    enough = plan.eps**0.375  # from here on Newton's method is used

    before, slope = _merit(at.values, at.multipliers, at.penalty), _merit_slope(at)
    after = _merit(values, at.multipliers[:, None], at.penalty[:, None])
    wanted = 1e-4 * (slope[:, None] * (trials - at.u[:, None])).sum(-1)
    falls = after <= before[:, None] + wanted + plan.noise * xp.abs(after)
    falls = (falls if plan.solver is None else xp.ones_like(falls)) & ~at.done[:, None]
    taken = falls.any(1)
    first = falls & (xp.cumsum(falls, axis=1) == 1)
    u, found, inclined = (
        _picked(first, taken, new, old)
        for new, old in zip((trials, values, slopes), (at.u, at.values, at.slopes), strict=True)
    )
    shortest = _lengths(plan)[-1] * at.length
    stuck = ~at.done & ~taken & (shortest * xp.abs(at.direction).max(1) < 4.0 * plan.eps)
    at = at._replace(
        u=u, values=found, slopes=inclined, length=0.25 * shortest, steps=at.steps + (~at.done).astype(np.int32)
    )
    settled = stuck | (taken & (projected(at.u, _merit_slope(at)) < enough))
    done = settled
    if plan.limits > 0:
        violation = xp.abs(xp.maximum(at.values[:, 1:], -at.multipliers / at.penalty[:, None])).max(1)
        penalty, before_violation = at.penalty, at.violation
        heavier = xp.where(violation > 0.25 * at.violation, xp.minimum(4.0 * at.penalty, _HEAVIEST), at.penalty)
        at = at._replace(
            multipliers=select(settled, _pushed(at.values, at.multipliers, at.penalty), at.multipliers),
            penalty=xp.where(settled, heavier, at.penalty),
            violation=xp.where(settled, violation, at.violation),
            fresh=at.fresh | settled,
        )
        # Where even the largest penalty does not reduce the violation, the limits cannot be kept, and the descent ends.
        lost = (penalty >= _HEAVIEST) & (violation > 0.25 * before_violation)
        done = settled & ((violation < enough) | lost)
    at = _turned(plan, at, taken | settled, state.scale, objective)
    at = at._replace(done=at.done | done | (at.steps >= plan.max_steps))

    finished, polish = _everybody(plan, at.done), _at_end(at)
    return state._replace(
        phase=xp.where(finished, POLISH, DESCENT).astype(np.int32),
        points=_in_lanes(xp.where(finished, _stencil(plan, at.u), _trials(plan, at))),
        descent=at,
        polish=polish,
    )


def _picked(first: Any, taken: Any, these: Any, those: Any) -> Any:
    """For each start the trial that was taken, or the old value if none was."""
    xp = namespace(first)
    shape = first.shape + (1,) * (these.ndim - 2)
    picked = xp.where(first.reshape(shape), these, 0.0).sum(1)
    return select(taken, picked, those)


def _turned(plan: Plan, at: Descent, turns: Any, scale: Any, objective: Callable[[Array], Array] | None) -> Descent:
    """The next direction, along the bounds where they are met."""
    xp, gradient = namespace(at.u), _merit_slope(at)
    free = xp.where(at.u * gradient < 0.0, xp.abs(at.u) < 1.0, True)
    # The memory is reset when other variables are on their bounds.
    fresh = at.fresh | (free != at.free).any(1)
    gradient = xp.where(free, gradient, 0.0)
    if xp is np:
        direction, memory = jax.device_get(_solver_step(plan, at.u, gradient, at.memory, fresh))
    else:
        known = None if objective is None or plan.solver is None else (objective, scale, at)
        direction, memory = _directions(plan, at.u, gradient, at.memory, fresh, known)
    if plan.solver is None:
        direction = select((direction * gradient).sum(1) < 0.0, direction, -gradient)
        # At most 0.4, so that it takes three steps from the middle of the box to a bound.
        longest = xp.maximum(xp.abs(direction).max(1, keepdims=True), plan.eps)
        direction = direction * xp.minimum(1.0, 0.4 / longest)
    return at._replace(
        free=select(turns, free, at.free),
        direction=select(turns, xp.where(free, direction, 0.0), at.direction),
        length=xp.where(turns, 1.0, at.length).astype(plan.dtype),
        memory=select(turns, memory, at.memory),
        fresh=at.fresh & ~turns,
    )


def _directions(plan: Plan, u: Any, gradient: Any, memory: Any, fresh: Any, known: Any = None) -> tuple[Any, Any]:
    """The directions and the memory that the solver of optax gives for the gradients."""
    solver = _solver(plan)

    def one(u: Array, gradient: Array, memory: Any, fresh: Array, *state: Array) -> tuple[Array, Any]:
        memory = jax.tree.map(functools.partial(jnp.where, fresh), solver.init(u), memory)
        more: dict[str, Any] = {}
        if known is not None:
            objective, scale, _ = known
            values, multipliers, penalty = state

            def merit(u: Array) -> Array:
                found = objective(u)
                return _merit(jnp.concatenate([found[:1] / scale, found[1:]]), multipliers, penalty)

            more = {"value": _merit(values, multipliers, penalty), "grad": gradient, "value_fn": merit}
        return solver.update(gradient, memory, u, **more)

    state = () if known is None else (known[2].values, known[2].multipliers, known[2].penalty)
    return jax.vmap(one)(u, gradient, memory, fresh, *state)


_solver_step = Program(_directions, static=1)


def begin_solver(plan: Plan) -> None:
    """Begin to compile what a search for concrete numbers compiles, if programs are compiled ahead."""
    at = begin(plan).descent
    _solver_step.begin(plan, at.u, at.u, at.memory, at.fresh)


# --- Newton's method -------------------------------------------------------------------------------------------------

_ROUNDS = 6


def _at_end(at: Descent) -> Polish:
    xp = namespace(at.u)
    infinite = xp.full_like(at.length, np.inf)
    unknown = Point(at.u, at.multipliers, at.u, xp.zeros_like(at.values), xp.zeros_like(at.slopes), infinite)
    return Polish(at.u, at.multipliers, unknown, xp.zeros_like(at.steps))


def _stencil(plan: Plan, u: Any) -> Any:
    """Each point and its neighbours on both sides along each variable; close to a bound these are moved inwards."""
    xp, n = namespace(u), plan.variables
    steps = plan.width * np.concatenate([np.zeros((1, n)), np.eye(n), -np.eye(n)])
    inward = xp.clip(u, -1.0 + plan.width, 1.0 - plan.width)
    centre = xp.where(np.arange(plan.trials)[:, None] > 0, inward[:, None], u[:, None])
    return (centre + steps).astype(plan.dtype)


def _polished(plan: Plan, state: State, values: Any, slopes: Any) -> State:
    """A Newton step on the conditions. Differences of slopes stand for second derivatives: as good, and faster."""
    xp, at, n = namespace(values), state.polish, plan.variables
    values, slopes = _of_starts(plan, state, values, slopes)
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
    done = _everybody(plan, _finished(plan, at) | (np.arange(plan.starts) >= state.valleys))
    return state._replace(
        phase=xp.where(done, DONE, POLISH).astype(np.int32), points=_in_lanes(_stencil(plan, at.u)), polish=at
    )


def _finished(plan: Plan, at: Polish) -> Any:
    return (at.count >= _ROUNDS) | (at.best.residual <= 4.0 * plan.eps)


# --- what was found -------------------------------------------------------------------------------------------------


def conclude(plan: Plan, state: State) -> Solution:
    """The best minimum of a finished search, its rival, and whether it is certain."""
    xp, seen, points = namespace(state.scale), _overview(plan, state.scanned), state.polish.best
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
