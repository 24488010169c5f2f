"""The descents of a search, which optax drives, and their ends, which Newton's method finds."""

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._startup.programs import Program, traced
from plgwear_jax.optimise.conditions import conditions, inclination, projected, solved
from plgwear_jax.optimise.search_state import (
    DESCENT,
    DONE,
    POLISH,
    Descent,
    Plan,
    Point,
    Polish,
    State,
    all_done,
    in_lanes,
    namespace,
    of_starts,
    select,
    tolerance,
)

if TYPE_CHECKING:
    import optax


# The limits enter through an augmented Lagrangian; its multipliers are updated when a descent has settled. Each pass
# evaluates steps of several lengths at once, and takes the longest one at which the merit falls enough.


_HEAVIEST = 1e8  # penalty
_STATIONARY = 1e-3  # slope of broken limits, over half the box, along which they are not kept either


def _solver(plan: Plan) -> "optax.GradientTransformationExtraArgs":
    import optax  # a tenth of a second, which a process that loads its programs does without

    memory = min(10, 2 * plan.variables - 1)
    default = optax.chain(optax.scale_by_lbfgs(memory_size=memory), optax.scale(-1.0))
    return optax.with_extra_args_support(plan.solver or default)


def _empty(plan: Plan) -> tuple[Any, ...]:
    """The memory of the solver without its structure, which is made of classes of optax."""
    start = jax.ShapeDtypeStruct((plan.starts, plan.variables), plan.dtype)
    shapes = jax.eval_shape(jax.vmap(_solver(plan).init), start)
    return tuple(jnp.zeros(leaf.shape, leaf.dtype) for leaf in jax.tree.leaves(shapes))


_kept_empty = Program(_empty, static=1)


@functools.lru_cache(maxsize=32)
def _memory(plan: Plan) -> tuple[np.ndarray, ...]:
    """The memory of the solver, in the right shape, before its first step."""
    leaves = jax.eval_shape(lambda: _empty(plan)) if traced(()) else _kept_empty(plan)
    return tuple(np.zeros(leaf.shape, leaf.dtype) for leaf in leaves)


def at_start(plan: Plan, start: Any, unused: Any) -> Descent:
    """Descents at their starting points; those that are unused are done."""
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


def trial_points(plan: Plan, at: Descent) -> Any:
    """The points of steps of several lengths."""
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


def descended(plan: Plan, state: State, values: Any, slopes: Any, objective: Callable[[Array], Array] | None) -> State:
    """All descents a step further; when the last one is done, their ends are polished."""
    xp, at = namespace(values), state.descent
    trials = state.points.reshape(plan.starts, plan.trials, -1)
    values, slopes = of_starts(plan, state, values, slopes)
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
        # Where even the largest penalty does not reduce the violation, and no step would, the limits cannot be kept.
        broken = xp.maximum(at.values[:, 1:], 0.0) / xp.maximum(violation, plan.eps)[:, None]
        stationary = projected(at.u, (broken[..., None] * at.slopes[:, 1:]).sum(1)) < _STATIONARY
        lost = (penalty >= _HEAVIEST) & (violation > 0.25 * before_violation) & stationary
        done = settled & ((violation < enough) | lost)
    at = _turned(plan, at, taken | settled, state.scale, objective)
    at = at._replace(done=at.done | done | (at.steps >= plan.max_steps))

    finished, polish = all_done(plan, at.done), at_end(at)
    return state._replace(
        phase=xp.where(finished, POLISH, DESCENT).astype(np.int32),
        points=in_lanes(xp.where(finished, _stencil(plan, at.u), trial_points(plan, at))),
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
        direction, memory = jax.device_get(solver_step(plan, at.u, gradient, at.memory, fresh))
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
        at_first, tree = jax.tree.flatten(solver.init(u))
        memory = tree.unflatten([jnp.where(fresh, *both) for both in zip(at_first, memory, strict=True)])
        more: dict[str, Any] = {}
        if known is not None:
            objective, scale, _ = known
            values, multipliers, penalty = state

            def merit(u: Array) -> Array:
                found = objective(u)
                return _merit(found / scale, multipliers, penalty)

            more = {"value": _merit(values, multipliers, penalty), "grad": gradient, "value_fn": merit}
        direction, memory = solver.update(gradient, memory, u, **more)
        return direction, tuple(jax.tree.leaves(memory))

    state = () if known is None else (known[2].values, known[2].multipliers, known[2].penalty)
    return jax.vmap(one)(u, gradient, memory, fresh, *state)


solver_step = Program(_directions, static=1)


# --- the end: Newton's method on the conditions of a minimum ----------------------------------------------------------


_ROUNDS, _MORE = 6, 6  # of Newton's method, and those added where it still converges
_NEAR = 1e-2  # residual below which it does


def at_end(at: Descent) -> Polish:
    """Newton's method at the ends of the descents."""
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


def polished(plan: Plan, state: State, values: Any, slopes: Any) -> State:
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
        phase=xp.where(done, DONE, POLISH).astype(np.int32), points=in_lanes(_stencil(plan, at.u)), polish=at
    )


def _finished(plan: Plan, at: Polish) -> Any:
    left = at.best.residual
    converging = (left < _NEAR) & (left >= tolerance(plan.dtype))
    return (at.count >= _ROUNDS) & ~converging | (at.count >= _ROUNDS + _MORE) | (left <= 4.0 * plan.eps)
