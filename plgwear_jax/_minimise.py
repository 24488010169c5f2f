"""The least value of a smooth function over a box, under limits, and what can be known about it.

A scan of the box finds every valley, an optax descent goes down each of them, and Newton's method on the conditions of
Karush, Kuhn and Tucker finishes. Whole batches go through one loop: nothing here is a Python loop over starts or steps.

Inside, variables are u in [-1, 1], and `function(u, params)` is the array of the objective and of the limits g <= 0.
"""

import functools
import itertools
from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike, DTypeLike

from plgwear_jax._formula import check_real, stored
from plgwear_jax._record import record

__all__ = ["Interval", "Minimum", "minimise"]

Variables = dict[str, Array]


@record
class Interval:
    """Between which values a variable may be chosen, and on which scale it is searched.

    Attributes:
        lower: The lowest value.
        upper: The highest value, above the lowest.
        scale: "linear", or "logarithmic" for a positive variable that may change by orders of magnitude.
    """

    lower: ArrayLike
    upper: ArrayLike
    scale: Literal["linear", "logarithmic"] = "linear"

    def __post_init__(self) -> None:
        if self.scale not in ("linear", "logarithmic"):
            raise ValueError(f'scale = {self.scale!r} is neither "linear" nor "logarithmic"')
        for name in ("lower", "upper"):
            check_real(name, getattr(self, name))
        if isinstance(self.lower, Tracer) or isinstance(self.upper, Tracer):
            return
        if not np.all(np.less(self.lower, self.upper) & np.isfinite(self.lower) & np.isfinite(self.upper)):
            raise ValueError(f"[{self.lower}, {self.upper}]: the lowest value must be below the highest, both finite")
        if self.scale == "logarithmic" and not np.all(np.greater(self.lower, 0.0)):
            raise ValueError(f"[{self.lower}, {self.upper}]: on a logarithmic scale both must be positive")


@record
class Minimum:
    """The least value of a function over a box, and what is known about it.

    Attributes:
        variables: Where it lies, by name.
        value: The function there.
        side: -1, 0 or +1 for each variable: on its lower bound, between, on its upper bound.
        bound_multipliers: For a variable on a bound the slope of the function (with active limits weighed in) along the
            variable or its logarithm, which leads out of the box; 0 between the bounds.
        limits: The limits there, each <= 0 up to the tolerance; shape (m,).
        multipliers: What the value would gain per unit that a limit were loosened by, >= 0; shape (m,).
        projected_gradient: Largest slope that still leads downhill inside the box, or violation of a limit, relative to
            half the box and to how much the function changes over it.
        converged: `projected_gradient` is below the tolerance, some 1e-10 in float64 and 5e-5 in float32.
        certified: Converged, every valley of the scan was descended into, and nothing lower was met that keeps the
            limits.
        proven: For one variable: between no two points of the scan can there be anything lower, as long as the second
            derivative between them leaves the range of its means over the intervals on both sides by no more than these
            differ. For several variables False.
        rival: The next best minimum that is another one, by name; NaN if there is none.
        rival_value: The function there; infinite if there is none.
        steps: Evaluations of the objective and its gradient on the longest of the descents.
    """

    variables: Variables
    value: Array
    side: Variables
    bound_multipliers: Variables
    limits: Array
    multipliers: Array
    projected_gradient: Array
    converged: Array
    certified: Array
    proven: Array
    rival: Variables
    rival_value: Array
    steps: Array


class _Plan(NamedTuple):
    """How a search is done."""

    samples: int
    starts: int
    max_steps: int
    solver: optax.GradientTransformation | None
    noise: float


class _Solution(NamedTuple):
    """The best minimum and its rival, and how the search ended."""

    u: Array  # (2, n), twice the same where there is no rival
    multipliers: Array  # (2, m), of the objective over its scale
    values: Array  # (2, 1 + m)
    slopes: Array  # (2, 1 + m, n)
    side: Array  # of the best
    scale: Array  # of the objective
    residual: Array
    converged: Array
    certified: Array
    proven: Array
    has_rival: Array
    steps: Array


def minimise(
    objective: Callable[[Variables], Array],
    space: Mapping[str, Interval],
    *,
    limits: Callable[[Variables], Array] | None = None,
    solver: optax.GradientTransformation | None = None,
    samples: int | None = None,
    starts: int | None = None,
    max_steps: int = 200,
    noise: float | None = None,
    at: Minimum | None = None,
) -> Minimum:
    """Minimise a smooth function of a few variables over a box, from every valley of a scan.

    Runs under `jit`, `vmap`, `jvp` and `grad`: bounds and whatever the functions close over may be traced and batched.
    The variables are differentiable in them by the implicit function theorem, the value by the envelope theorem.
    Call it under `jit`: outside, every call compiles its loops anew.

    Args:
        objective: A twice differentiable scalar function of the variables, a dict of scalars.
        space: The interval of each variable.
        limits: A twice differentiable function of the variables whose entries, shape (m,), are to be <= 0; best of the
            order of one, such as logarithms of ratios.
        solver: An optax transformation; by default L-BFGS with a backtracking line search. It works on variables scaled
            to [-1, 1], is projected back onto the box, and sees the augmented Lagrangian of the limits.
        samples: Points of the scan along each variable, ends included, at least 3; by default 65 for one variable, 33
            each for two, 17 for three.
        starts: Valleys to descend into, the deepest ones; by default 3 for one variable and 24 for more.
        max_steps: Evaluations of the objective and its gradient allowed in each descent.
        noise: Relative error of the objective, below which differences mean nothing; by default that of rounding.
        at: What an earlier call has found for the same question: nothing is searched then, and it is returned with its
            derivatives.

    Returns:
        The best minimum found, and what is known about it. Whether it converged is said there, never hidden.

    Raises:
        ValueError: The space is empty, or a number is out of its range. NaN where traced bounds are.

    Example:
        >>> import jax
        >>> from plgwear_jax.optimise import Interval, minimise
        >>> space = {"x": Interval(0.0, 1.0), "y": Interval(2.0, 3.0)}
        >>> best = jax.jit(lambda: minimise(lambda v: (v["x"] - 0.5) ** 2 + v["y"], space))()
        >>> print(f"{best.variables['x']:.3f} {best.variables['y']} {best.side['y']}")
        0.500 2.0 -1
    """
    if not space:
        raise ValueError("space is empty: name at least one variable")
    n = len(space)
    for name, number, least in (("samples", samples, 3), ("starts", starts, 1), ("max_steps", max_steps, 1)):
        if number is not None and number < least:
            raise ValueError(f"{name} = {number} is below {least}")
    along = samples or {1: 65, 2: 33, 3: 17}.get(n, max(3, int(4096 ** (1.0 / n))))
    begun = min(along**n, starts or (3 if n == 1 else 24))
    dtype = jnp.result_type(*(end for i in space.values() for end in (i.lower, i.upper)), 0.0)
    lower = jnp.stack([jnp.asarray(interval.lower, dtype) for interval in space.values()])
    upper = jnp.stack([jnp.asarray(interval.upper, dtype) for interval in space.values()])
    eps = float(jnp.finfo(dtype).eps)
    logarithmic = np.array([interval.scale == "logarithmic" for interval in space.values()])

    def everything(variables: Variables) -> Array:
        value = jnp.asarray(objective(variables))[None]
        return value if limits is None else jnp.concatenate([value, jnp.asarray(limits(variables))])

    def named(values: Array) -> Variables:
        return dict(zip(space, values, strict=True))

    # What the functions close over becomes an argument, so that a rule can differentiate with respect to it.
    converted, closed_over = jax.closure_convert(everything, named(lower))

    def function(u: Array, params: Any) -> Array:
        lower, upper, closed_over = params
        return converted(named(_decoded(u, lower, upper, logarithmic)), *closed_over)

    valid = (lower < upper) & jnp.isfinite(upper - lower) & ((lower > 0.0) | ~logarithmic)
    defined = jnp.where(jnp.all(valid), 1.0, jnp.nan).astype(dtype)
    params = (lower * defined, upper, closed_over)
    # Derivatives are not those of the search: the conditions of the minimum have better ones.
    fixed = jax.lax.stop_gradient(params)
    if at is None:
        noise = 16.0 * eps if noise is None else noise
        found = _searched(function, _Plan(along, begun, max_steps, solver, noise), fixed)
    else:
        found = _given(at, function, fixed, logarithmic)
    tied = _tied(function, found.scale, (found.u, found.multipliers, found.values, found.slopes), params)
    u, tied_multipliers, (values, rival_values), (slopes, _) = tied
    at_best, at_rival = (_decoded(u, *params[:2], logarithmic) for u in u)
    has_rival = found.has_rival
    # Without limits JAX 0.10 cannot transpose what takes a row of nothing.
    multipliers = tied_multipliers[0] * found.scale if tied_multipliers.size else jnp.zeros(0, dtype)
    first, last = _ends(*params[:2], logarithmic)
    outward = (slopes[0] + multipliers @ slopes[1:]) / (0.5 * (last - first))
    return Minimum(
        variables=named(at_best),
        value=values[0],
        side=named(found.side.astype(int)),
        bound_multipliers=named(jnp.where(found.side == 0.0, 0.0, outward)),
        limits=values[1:],
        multipliers=multipliers,
        projected_gradient=found.residual,
        converged=found.converged,
        certified=found.certified,
        proven=found.proven,
        rival=named(jnp.where(has_rival, at_rival, jnp.nan)),
        rival_value=jnp.where(has_rival, rival_values[0], jnp.inf),
        steps=found.steps,
    )


def _given(at: Minimum, function: Callable[[Array, Any], Array], params: Any, logarithmic: np.ndarray) -> _Solution:
    """A minimum as the search would have it."""
    lower, upper, _ = params
    first, last = _ends(lower, upper, logarithmic)
    dtype = first.dtype

    def encoded(variables: Variables) -> Array:
        value = jnp.stack([jnp.asarray(x, dtype) for x in variables.values()])
        along = jnp.where(logarithmic, jnp.log(jnp.where(logarithmic, value, 1.0)), value)
        return jnp.clip((2.0 * along - first - last) / (last - first), -1.0, 1.0)

    side = jnp.stack(list(at.side.values())).astype(dtype)
    best = jnp.where(side == 0.0, encoded(at.variables), side)
    has_rival = jnp.isfinite(at.rival_value)
    u = jnp.stack([best, jnp.where(has_rival, encoded(at.rival), best)])
    values, slopes = _both_first(function, u, params)
    return _Solution(
        u=u,
        multipliers=jnp.stack(2 * [at.multipliers]),
        values=values,
        slopes=slopes,
        side=side,
        scale=jnp.ones((), dtype),
        residual=at.projected_gradient,
        converged=at.converged,
        certified=at.certified,
        proven=at.proven,
        has_rival=has_rival,
        steps=at.steps,
    )


def _both_first(function: Callable[[Array, Any], Array], u: Array, params: Any) -> tuple[Array, Array]:
    """Values and Jacobians at the best minimum and at its rival."""
    return jax.vmap(_first(lambda u: function(u, params)))(u)


def _ends(lower: Array, upper: Array, logarithmic: np.ndarray) -> Array:
    """The bounds on the scale of the search, (2, n)."""
    ends = jnp.stack([lower, upper])
    return jnp.where(logarithmic, jnp.log(jnp.where(logarithmic, ends, 1.0)), ends) if np.any(logarithmic) else ends


def _decoded(u: Array, lower: Array, upper: Array, logarithmic: np.ndarray) -> Array:
    """The variables for u in [-1, 1]; at its ends the bounds as they were given."""
    first, last = _ends(lower, upper, logarithmic)
    value = 0.5 * (first + last) + 0.5 * (last - first) * u
    if np.any(logarithmic):
        value = jnp.where(logarithmic, jnp.exp(jnp.where(logarithmic, value, 0.0)), value)
    exact = jnp.where(u >= 1.0, upper, jnp.where(u <= -1.0, lower, jnp.clip(value, lower, upper)))
    return stored(value + jax.lax.stop_gradient(exact - value), u)


def _tolerance(dtype: DTypeLike) -> float:
    """What a relative slope can be brought to: well above its rounding error, well below what anyone needs."""
    return float(jnp.finfo(dtype).eps) ** 0.625


def _first(function: Callable[[Array], Array]) -> Callable[[Array], tuple[Array, Array]]:
    """Values and Jacobian."""

    def first(u: Array) -> tuple[Array, Array]:
        jacobian = jax.jacfwd if u.size <= 3 else jax.jacrev

        def twice(u: Array) -> tuple[Array, Array]:
            values = function(u)
            return values, values

        slopes, values = jacobian(twice, has_aux=True)(u)
        return stored(values, u[0]), stored(slopes, u[0])

    return first


def _second(function: Callable[[Array], Array]) -> Callable[[Array], tuple[Array, Array, Array]]:
    """Values, Jacobian and second derivatives."""

    def second(u: Array) -> tuple[Array, Array, Array]:
        def twice(u: Array) -> tuple[Array, tuple[Array, Array]]:
            values, slopes = _first(function)(u)
            return slopes, (values, slopes)

        curvatures, (values, slopes) = jax.jacfwd(twice, has_aux=True)(u)
        return values, slopes, stored(curvatures, u[0])

    return second


# --- the search -----------------------------------------------------------------------------------------------------


def _searched(function: Callable[[Array, Any], Array], plan: _Plan, params: Any) -> _Solution:
    def at(u: Array) -> Array:
        return function(u, params)

    n, dtype = params[0].size, params[0].dtype
    tolerance = _tolerance(dtype)
    axis = jnp.linspace(-1.0, 1.0, plan.samples, dtype=dtype)
    mesh = jnp.stack([m.ravel() for m in jnp.meshgrid(*n * (axis,), indexing="ij")], axis=-1)
    # Were it a constant, XLA would see through `stored` and evaluate the scan again for everything made of it.
    mesh = mesh + 0.0 * params[0]
    nodes = jax.vmap(_first(at))(mesh) if n == 1 else (jax.vmap(at)(mesh),)
    values, excess = nodes[0][:, 0], jnp.sum(jnp.maximum(nodes[0][:, 1:], 0.0), axis=1)
    known = jnp.isfinite(values)
    lowest, highest = jnp.min(jnp.where(known, values, jnp.inf)), jnp.max(jnp.where(known, values, -jnp.inf))
    scale = jnp.maximum(highest - lowest, 0.01 * jnp.abs(lowest))
    scale = jnp.where(scale > 0.0, scale, 1.0)

    # Among points that break a limit, those that break it least.
    merit = (values - lowest) / scale + 10.0 * excess
    grid = n * (plan.samples,)
    valleys, count = _deepest_valleys(jnp.where(known, merit, jnp.inf).reshape(grid), plan.starts)
    begin = jnp.stack([axis[index] for index in jnp.unravel_index(valleys, grid)], axis=-1)

    def scaled(u: Array) -> Array:
        values = at(u)
        return jnp.concatenate([values[:1] / scale, values[1:]])

    used = jnp.arange(plan.starts) < count
    ends, multipliers, steps = jax.vmap(lambda u, used: _descend(scaled, u, used, plan))(begin, used)
    points = jax.vmap(lambda u, multipliers: _polished(scaled, u, multipliers))(ends, multipliers)

    # The best keeps the limits; if none does, the one that breaks them least.
    good = used & (points.residual < tolerance)
    value = points.values[:, 0]
    broken = jnp.max(jnp.maximum(points.values[:, 1:], 0.0), axis=1, initial=0.0)
    worse = jnp.where(used & jnp.isfinite(value), jnp.where(good, 0.0, 1.0 + broken), jnp.inf)
    best = jnp.lexsort((value, worse))[0]
    apart = jnp.max(jnp.abs(points.u - points.u[best]), axis=1) > 1e-3
    others = jnp.where(good & apart, value, jnp.inf)
    rival = jnp.argmin(others)
    has_rival = jnp.isfinite(others[rival])

    slack = 16.0 * plan.noise * (1.0 + jnp.abs(lowest) / scale)
    kept = known & (excess <= 0.0)
    reached = value[best] <= jnp.min(jnp.where(kept, values, jnp.inf)) / scale + slack
    converged = good[best]
    certified = converged & (count <= plan.starts) & reached
    proven = jnp.zeros((), bool)
    if n == 1:
        scanned, inclined = (part.reshape(plan.samples, -1).at[:, 0].divide(scale) for part in nodes)
        here = jax.tree.map(lambda leaf: leaf[best], points)
        proven = certified & _nothing_hides(axis, scanned, inclined, here, slack)
    # Where there is none, the best stands in: derivatives of NaN would spoil all others.
    pair = jnp.stack([best, jnp.where(has_rival, rival, best)])
    return _Solution(
        u=points.u[pair],
        multipliers=points.multipliers[pair],
        values=points.values[pair].at[:, 0].multiply(scale),
        slopes=points.slopes[pair].at[:, 0].multiply(scale),
        side=points.side[best],
        scale=scale,
        residual=points.residual[best],
        converged=converged,
        certified=certified,
        proven=proven,
        has_rival=has_rival,
        steps=jnp.max(steps),
    )


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _tied(function: Callable[[Array, Any], Array], scale: Array, found: Any, params: Any) -> Any:
    """(u, multipliers, values, slopes) of minima, tied to the parameters by the implicit function theorem."""
    del function, scale, params
    return found


@_tied.defjvp
def _tied_jvp(function, primals, tangents):
    scale, _, params = primals
    dparams = tangents[2]
    tied = _tied(function, *primals)

    def scaled(u: Array, params: Any) -> Array:
        values = function(u, params)
        return jnp.concatenate([values[:1] / scale, values[1:]])

    def change(u: Array, multipliers: Array) -> tuple[Array, Array]:
        state = _conditions(*_second(lambda u: scaled(u, params))(u), u, multipliers)

        def residual(params: Any) -> Array:
            values, slopes = _first(lambda u: scaled(u, params))(u)
            return _residual(values, slopes, u, multipliers, state.side, state.active)

        _, by_params = jax.jvp(residual, (params,), (dparams,))
        step = -_solved(state.matrix, by_params)
        return step[: u.size], step[u.size :]

    du, dmultipliers = jax.vmap(change)(*tied[:2])
    _, along = jax.jvp(functools.partial(_both_first, function), (tied[0], params), (du, dparams))
    return tied, (du, dmultipliers, *along)


def _deepest_valleys(scanned: Array, count: int) -> tuple[Array, Array]:
    """Flat indices of the lowest scan points that no neighbour undercuts, and how many there are of them."""
    valley = jnp.isfinite(scanned)
    padded = jnp.pad(scanned, 1, constant_values=jnp.inf)
    for offset in itertools.product((0, 1, 2), repeat=scanned.ndim):
        if offset == scanned.ndim * (1,):
            continue
        neighbour = padded[tuple(slice(o, o + size) for o, size in zip(offset, scanned.shape, strict=True))]
        # Of equal neighbours the first one is the valley.
        valley &= scanned < neighbour if offset < scanned.ndim * (1,) else scanned <= neighbour
    depths = jnp.where(valley, scanned, jnp.inf).ravel()

    def next_deepest(depths: Array, _: None) -> tuple[Array, Array]:
        deepest = jnp.argmin(depths)
        return depths.at[deepest].set(jnp.inf), deepest

    # A few times the least of all is much sooner had than XLA's sorting for the first few.
    deepest = jax.lax.scan(next_deepest, depths, length=count)[1]
    return deepest, jnp.sum(valley)


# --- the descent ----------------------------------------------------------------------------------------------------


class _Descent(NamedTuple):
    """Where a descent stands: the point, what lies there, the next trial step, and what the limits weigh."""

    u: Array
    values: Array
    slopes: Array
    free: Array
    direction: Array
    length: Array
    memory: optax.OptState
    multipliers: Array
    penalty: Array
    violation: Array
    steps: Array
    done: Array


def _descend(function: Callable[[Array], Array], start: Array, used: Array, plan: _Plan) -> tuple[Array, Array, Array]:
    """Down from a start, along the bounds where they are met: (u, multipliers, steps).

    The augmented Lagrangian takes the limits in; its multipliers are renewed whenever the descent has settled. Each
    pass evaluates one trial step, which is taken if the merit falls and shortened if not. So the loop holds a single
    copy of the objective and its gradient, where a line search within it would make XLA compile many.
    """
    first, m = _first(function), jax.eval_shape(function, start).size - 1
    eps, dtype = jnp.finfo(start.dtype).eps, start.dtype
    enough = float(eps) ** 0.375  # Newton's method does the rest
    default = optax.chain(optax.scale_by_lbfgs(memory_size=min(10, 2 * start.size - 1)), optax.scale(-1.0))
    solver = optax.with_extra_args_support(plan.solver or default)

    def merit(values: Array, multipliers: Array, penalty: Array) -> Array:
        pushed = jnp.maximum(multipliers + penalty * values[1:], 0.0)
        return values[0] + jnp.sum(pushed**2 - multipliers**2) / (2.0 * penalty)

    def merit_slope(at: _Descent) -> Array:
        return at.slopes[0] + jnp.maximum(at.multipliers + at.penalty * at.values[1:], 0.0) @ at.slopes[1:]

    def turned(at: _Descent) -> _Descent:
        gradient = merit_slope(at)
        free = jnp.where(at.u * gradient < 0.0, jnp.abs(at.u) < 1.0, True)
        # What was learnt with other variables on their bounds is of no use.
        fresh = jnp.any(free != at.free)
        memory = jax.tree.map(functools.partial(jnp.where, fresh), solver.init(at.u), at.memory)
        gradient = jnp.where(free, gradient, 0.0)
        known = {
            "value": merit(at.values, at.multipliers, at.penalty),
            "grad": gradient,
            "value_fn": lambda u: merit(function(u), at.multipliers, at.penalty),
        }
        direction, memory = solver.update(gradient, memory, at.u, **known)
        if plan.solver is None:
            direction = jnp.where(jnp.vdot(direction, gradient) < 0.0, direction, -gradient)
            # Not further than from the middle of the box to a bound in three steps.
            direction = direction * jnp.minimum(1.0, 0.4 / jnp.maximum(jnp.max(jnp.abs(direction)), eps))
        direction = jnp.where(free, direction, 0.0)
        return at._replace(free=free, direction=direction, length=jnp.ones_like(at.length), memory=memory)

    def advance(at: _Descent) -> _Descent:
        u = jnp.clip(at.u + at.length * at.direction, -1.0, 1.0)
        values, slopes = first(u)
        tried = at._replace(u=u, values=values, slopes=slopes)
        before, after = (merit(v, at.multipliers, at.penalty) for v in (at.values, values))
        wanted = 1e-4 * jnp.vdot(merit_slope(at), u - at.u)
        falls = after <= before + wanted + plan.noise * jnp.abs(after)
        taken = falls if plan.solver is None else jnp.ones_like(falls)
        stuck = ~taken & (at.length * jnp.max(jnp.abs(at.direction)) < 4.0 * eps)
        at = _chosen(taken, tried, at._replace(length=0.25 * at.length))._replace(steps=at.steps + 1)

        settled = stuck | (taken & (_projected(at.u, merit_slope(at)) < enough))
        violation = jnp.max(jnp.abs(jnp.maximum(at.values[1:], -at.multipliers / at.penalty)), initial=0.0)
        if m > 0:
            heavier = jnp.where(violation > 0.25 * at.violation, 4.0 * at.penalty, at.penalty)
            renewed = at._replace(
                multipliers=jnp.maximum(at.multipliers + at.penalty * at.values[1:], 0.0),
                penalty=jnp.minimum(heavier, 1e6),
                violation=violation,
                memory=solver.init(at.u),
            )
            at = _chosen(settled, renewed, at)
        return _chosen(taken | settled, turned(at), at)._replace(done=settled & (violation < enough))

    one = jnp.ones((), dtype)
    # The first pass stays where it is and accepts whatever it finds.
    at = _Descent(
        u=start,
        values=jnp.full(1 + m, jnp.inf, dtype).at[1:].set(0.0),
        slopes=jnp.zeros((1 + m, start.size), dtype),
        free=jnp.ones(start.shape, bool),
        direction=jnp.zeros_like(start),
        length=one,
        memory=solver.init(start),
        multipliers=jnp.zeros(m, dtype),
        penalty=300.0 * one,  # so that no descent slides from a valley that keeps the limits into one that breaks them
        violation=one * jnp.inf,
        steps=jnp.asarray(0),
        done=~used,
    )
    last = jax.lax.while_loop(lambda at: ~at.done & (at.steps < plan.max_steps), advance, at)
    return last.u, last.multipliers, last.steps


def _chosen(condition: Array, these: _Descent, those: _Descent) -> _Descent:
    return jax.tree.map(functools.partial(jnp.where, condition), these, those)


def _projected(u: Array, gradient: Array) -> Array:
    """Largest step that steepest descent by the gradient could still take inside [-1, 1]."""
    return jnp.max(jnp.abs(u - jnp.clip(u - gradient, -1.0, 1.0)))


# --- the conditions of a minimum ------------------------------------------------------------------------------------


class _State(NamedTuple):
    """The conditions of Karush, Kuhn and Tucker at a point: what is active, what is left of them, their Jacobian."""

    side: Array  # bounds that hold a variable: -1, 0, +1
    active: Array  # limits that count: 0 or 1
    residual: Array
    matrix: Array


class _Point(NamedTuple):
    """A stationary point and what lies there."""

    u: Array
    multipliers: Array
    side: Array
    values: Array
    slopes: Array
    residual: Array


def _residual(values: Array, slopes: Array, u: Array, multipliers: Array, side: Array, active: Array) -> Array:
    """A row a variable, its slope or distance from the bound that holds it; a row a limit, itself or its multiplier."""
    gradient = slopes[0] + multipliers @ slopes[1:]
    return jnp.concatenate(
        [jnp.where(side == 0.0, gradient, u - side), jnp.where(active > 0.0, values[1:], multipliers)]
    )


def _conditions(values: Array, slopes: Array, curvatures: Array, u: Array, multipliers: Array) -> _State:
    gradient = slopes[0] + multipliers @ slopes[1:]
    ahead = u - gradient
    side = jnp.where(ahead >= 1.0, 1.0, jnp.where(ahead <= -1.0, -1.0, 0.0)).astype(u.dtype)
    active = (multipliers + values[1:] > 0.0).astype(u.dtype)
    free = (side == 0.0).astype(u.dtype)
    hessian = curvatures[0] + jnp.tensordot(multipliers, curvatures[1:], 1)
    by_u = free[:, None] * hessian + jnp.diag(1.0 - free)
    limits = active[:, None] * slopes[1:]
    # The small number keeps it regular where a bound and a limit, or two limits, hold the same variable.
    corner = jnp.diag(1.0 - active - jnp.finfo(u.dtype).eps ** 0.75 * active)
    matrix = jnp.block([[by_u, free[:, None] * slopes[1:].T], [limits, corner]])
    return _State(side, active, _residual(values, slopes, u, multipliers, side, active), matrix)


def _solved(matrix: Array, right: Array) -> Array:
    if right.size == 1:
        return right / matrix[0]
    return jnp.linalg.solve(matrix, right)


def _polished(function: Callable[[Array], Array], u: Array, multipliers: Array) -> _Point:
    """Newton's method on the conditions, from where a descent ended; the point at which they are met best.

    Second derivatives are differences of the slopes: as good as exact ones here, and much sooner compiled.
    """
    n, first = u.size, _first(function)
    width = float(jnp.finfo(u.dtype).eps) ** (1.0 / 3.0)
    stencil = width * jnp.concatenate([jnp.zeros((1, n)), jnp.eye(n), -jnp.eye(n)]).astype(u.dtype)
    values, slopes = (jnp.zeros(part.shape, u.dtype) for part in jax.eval_shape(first, u))
    unknown = _Point(u, multipliers, u, values, slopes, jnp.asarray(jnp.inf, u.dtype))

    def step(carry: tuple[Array, Array, Array, _Point]) -> tuple[Array, Array, Array, _Point]:
        count, u, multipliers, best = carry
        # Beside a bound the stencil is moved inwards.
        centre = jnp.where(jnp.arange(2 * n + 1)[:, None] > 0, jnp.clip(u, -1.0 + width, 1.0 - width), u)
        values, slopes = jax.vmap(first)(centre + stencil)
        curvatures = jnp.moveaxis(slopes[1 : n + 1] - slopes[n + 1 :], 0, -1) / (2.0 * width)
        values, slopes = values[0], slopes[0]
        state = _conditions(values, slopes, curvatures, u, multipliers)
        gradient = slopes[0] + multipliers @ slopes[1:]
        left = jnp.maximum(_projected(u, gradient), jnp.max(jnp.abs(state.residual[n:]), initial=0.0))
        here = _Point(u, multipliers, jnp.where(jnp.abs(u) == 1.0, state.side, 0.0), values, slopes, left)
        best = jax.tree.map(functools.partial(jnp.where, left < best.residual), here, best)
        change = -_solved(state.matrix, state.residual)
        usable = jnp.all(jnp.isfinite(change))
        moved = jnp.clip(u + jnp.clip(change[:n], -0.1, 0.1), -1.0, 1.0)
        raised = jnp.maximum(multipliers + change[n:], 0.0)
        return count + 1, jnp.where(usable, moved, u), jnp.where(usable, raised, multipliers), best

    def going_on(carry: tuple[Array, Array, Array, _Point]) -> Array:
        count, _, _, best = carry
        return (count < 6) & (best.residual > 4.0 * float(jnp.finfo(u.dtype).eps))

    return jax.lax.while_loop(going_on, step, (jnp.asarray(0), u, multipliers, unknown))[3]


# --- the proof for one variable -------------------------------------------------------------------------------------


def _nothing_hides(axis: Array, values: Array, slopes: Array, best: _Point, slack: Array) -> Array:
    """Whether no interval of the scan can hold anything that keeps the limits and lies lower than the best.

    An interval is cleared if a limit is broken all over it, if a lower bound of the objective, or of the Lagrangian,
    lies above the best, or if the Lagrangian is convex from there to the best, where it is stationary. All bounds are
    Taylor's from both ends, with the least second derivative that the interval can have.
    """
    step = axis[1] - axis[0]

    def least_curvature(slope: Array) -> Array:
        # The mean second derivative of each interval is known. Inside, it may undercut the least of those of the
        # interval and its neighbours by as much again as it changes between them.
        mean = jnp.diff(slope) / step
        beside = jnp.pad(mean, 1, mode="edge")
        change = jnp.pad(jnp.abs(jnp.diff(mean)), 1, mode="edge")
        lowest = jnp.minimum(mean, jnp.minimum(beside[:-2], beside[2:]))
        return lowest - jnp.maximum(change[:-1], change[1:])

    def bound(value: Array, slope: Array) -> Array:
        least = least_curvature(slope)

        def from_end(value: Array, inward: Array) -> Array:
            bowl = jnp.clip(-inward / jnp.where(least > 0.0, least, 1.0), 0.0, step)
            ends = jnp.minimum(0.0, step * (inward + 0.5 * least * step))
            return value + jnp.where(least > 0.0, bowl * (inward + 0.5 * least * bowl), ends)

        return jnp.maximum(from_end(value[:-1], slope[:-1]), from_end(value[1:], -slope[1:]))

    level = best.values[0] - slack
    above = bound(values[:, 0], slopes[:, 0]) >= level
    along = slopes[:, 0]
    if values.shape[1] > 1:
        weights = jnp.concatenate([jnp.ones_like(best.values[:1]), best.multipliers])
        along = slopes @ weights
        of_limits = jax.vmap(bound, in_axes=1, out_axes=1)(values[:, 1:], slopes[:, 1:])
        above |= (bound(values @ weights, along) >= level) | jnp.any(of_limits > 0.0, axis=1)
    intervals = jnp.arange(axis.size - 1)
    home = jnp.clip(jnp.sum(axis <= best.u[0]) - 1, 0, axis.size - 2)
    bent = least_curvature(along) < 0.0
    before = jnp.max(jnp.where(bent & (intervals <= home), intervals, -1))
    behind = jnp.min(jnp.where(bent & (intervals >= home), intervals, axis.size))
    return jnp.all(above | ((intervals > before) & (intervals < behind)))
