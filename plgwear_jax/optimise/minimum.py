"""The least value of a smooth function over a box, under limits, and what is certain about it."""

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import check_real
from plgwear_jax._core.record import record, static
from plgwear_jax.optimise.conditions import slopes_at, tied, with_slopes
from plgwear_jax.optimise.search import begin, conclude, tell
from plgwear_jax.optimise.search_state import DONE, Plan, Solution, State, namespace
from plgwear_jax.special.xla import materialised

if TYPE_CHECKING:
    import optax


Variables = dict[str, Array]


@record
class Interval:
    """The range of a variable, and the scale on which it is searched.

    Attributes:
        lower: The lowest value.
        upper: The highest value, above the lowest.
        scale: "linear", or "logarithmic" for a positive variable that may change by orders of magnitude.
    """

    lower: ArrayLike
    upper: ArrayLike
    scale: Literal["linear", "logarithmic"] = static(default="linear")

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
    """The least value of a function over a box, and what is certain about it.

    Attributes:
        variables: Where it lies, by name.
        value: The function there.
        side: -1, 0 or +1 for each variable: on its lower bound, between, on its upper bound.
        bound_multipliers: For a variable on a bound the slope of the Lagrangian (function plus multipliers times
            limits) along the variable or its logarithm; 0 between the bounds.
        limits: The limits there, each <= 0 up to the tolerance; shape (m,).
        multipliers: The decrease of the value per unit by which a limit is loosened, >= 0; shape (m,).
        projected_gradient: Largest slope that still leads downhill inside the box, or violation of a limit; relative to
            half the width of the box and to the change of the function over it.
        converged: `projected_gradient` is below the tolerance, some 1e-10 in float64 and 5e-5 in float32.
        certified: Converged, a descent was made from every valley of the scan, and nothing lower that keeps the limits
            was found. This is what a global search can say, and no proof.
        proven: For one variable: nothing lower is expected between two points of the scan. This holds as long as the
            second derivative between them leaves the range of its means over this and the neighbouring intervals by
            no more than these differ, which is estimated, not bounded: no proof either. For several variables False.
        rival: The next best minimum, by name; NaN if there is none.
        rival_value: The function there; infinite if there is none.
        steps: How often the objective and its gradient were evaluated on the longest of the descents.
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


def minimise(
    objective: Callable[[Variables], Array],
    space: Mapping[str, Interval],
    *,
    limits: Callable[[Variables], Array] | None = None,
    solver: "optax.GradientTransformation | None" = None,
    samples: int | None = None,
    starts: int | None = None,
    max_steps: int = 200,
    noise: float | None = None,
    axis_name: str | None = None,
) -> Minimum:
    """Minimise a smooth function of a few variables over a box, from every valley of a scan.

    Runs under `jit`, `vmap`, `jvp` and `grad`: bounds and whatever the functions close over may be traced and batched.
    The variables are differentiable in them by the implicit function theorem, the value by the envelope theorem.
    Call it under `jit`: otherwise every call compiles its loop again.

    Args:
        objective: A twice differentiable scalar function of the variables, a dict of scalars.
        space: The interval of each variable.
        limits: A twice differentiable function of the variables whose entries, shape (m,), are to be <= 0. They should
            be of the order of one, such as logarithms of ratios.
        solver: An optax transformation; by default L-BFGS with a backtracking line search. It works on variables scaled
            to [-1, 1], is projected back onto the box, and sees the augmented Lagrangian of the limits.
        samples: Points of the scan along each variable, ends included, at least 3; by default 65 for one variable, 33
            each for two, 17 for three.
        starts: How many of the deepest valleys to descend from; by default 3 for one variable and 24 for more.
        max_steps: Evaluations of the objective and its gradient allowed in each descent.
        noise: Relative error of the objective, below which differences have no meaning; by default that of rounding.
        axis_name: The `axis_name` of the `jax.vmap` that batches problems. It makes large batches faster: all problems
            then go from the scan to the descents and on together.

    Returns:
        The best minimum found, and what is certain about it, also whether the search converged.

    Raises:
        ValueError: The space is empty, or a number is outside its range. Traced bounds outside theirs give NaN.

    Examples:
        >>> import jax
        >>> from plgwear_jax.optimise import Interval, minimise
        >>> space = {"x": Interval(0.0, 1.0), "y": Interval(2.0, 3.0)}
        >>> best = jax.jit(lambda: minimise(lambda v: (v["x"] - 0.5) ** 2 + v["y"], space))()
        >>> print(f"{best.variables['x']:.3f} {best.variables['y']} {best.side['y']}")
        0.500 2.0 -1

    References:
        Nocedal and Wright, Numerical Optimization (2006).
    """
    for name, number, least in (("samples", samples, 3), ("starts", starts, 1), ("max_steps", max_steps, 1)):
        if number is not None and number < least:
            raise ValueError(f"{name} = {number} is below {least}")
    posed = _posed(objective, space, limits)
    plan = plan_of(len(space), posed.limits, posed.dtype, samples, starts, max_steps, noise)
    plan = plan._replace(solver=solver, axis=axis_name)
    # Derivatives are not taken through the search, but from the conditions of the minimum, which is more accurate.
    fixed = jax.lax.stop_gradient(posed.params)
    found = _searched(lambda u: posed.function(u, fixed), plan)
    return _with_derivatives(posed, found)


def differentiable(
    found: Minimum,
    objective: Callable[[Variables], Array],
    space: Mapping[str, Interval],
    *,
    limits: Callable[[Variables], Array] | None = None,
) -> Minimum:
    """A known minimum with its derivatives, as `minimise` gives them: nothing is searched.

    Args:
        found: The result of `minimise` for the same objective, space and limits.
        objective: See `minimise`.
        space: See `minimise`.
        limits: See `minimise`.

    Returns:
        The same minimum, differentiable in the bounds and in whatever the functions close over.

    Raises:
        ValueError: See `minimise`.

    Examples:
        >>> import jax
        >>> from plgwear_jax.optimise import Interval, differentiable, minimise
        >>> space = {"x": Interval(0.0, 1.0)}
        >>> best = jax.jit(lambda a: minimise(lambda v: (v["x"] - a) ** 2, space))(0.5)
        >>> again = lambda a: differentiable(best, lambda v: (v["x"] - a) ** 2, space)
        >>> print(f"{jax.grad(lambda a: again(a).variables['x'])(0.5):.3f}")
        1.000
    """
    posed = _posed(objective, space, limits)
    return _with_derivatives(posed, _given(found, posed))


class _Posed(NamedTuple):
    """Objective and limits as one function on the scale of the search, and what it depends on."""

    function: Callable[[Array, Any], Array]  # of u in [-1, 1]
    params: Any  # the lower and upper bounds, and what the functions close over
    limits: int
    names: tuple[str, ...]
    logarithmic: np.ndarray
    dtype: Any


def _posed(
    objective: Callable[[Variables], Array],
    space: Mapping[str, Interval],
    limits: Callable[[Variables], Array] | None,
) -> _Posed:
    if not space:
        raise ValueError("space is empty: name at least one variable")
    dtype = jnp.result_type(*(end for i in space.values() for end in (i.lower, i.upper)), 0.0)
    lower = jnp.stack([jnp.asarray(interval.lower, dtype) for interval in space.values()])
    upper = jnp.stack([jnp.asarray(interval.upper, dtype) for interval in space.values()])
    logarithmic = _logarithmic(space)

    def everything(variables: Variables) -> Array:
        value = jnp.asarray(objective(variables))[None]
        return value if limits is None else jnp.concatenate([value, jnp.asarray(limits(variables))])

    names = tuple(space)  # without the bounds: rules of JAX, which live longer than traced values, keep the function

    # Values that the functions close over become arguments, so that a rule can differentiate with respect to them.
    converted, closed_over = jax.closure_convert(everything, _named(names, lower))

    def function(u: Array, params: Any) -> Array:
        lower, upper, closed_over = params
        return converted(_named(names, _decoded(u, lower, upper, logarithmic)), *closed_over)

    valid = (lower < upper) & jnp.isfinite(upper - lower) & ((lower > 0.0) | ~logarithmic)
    defined = jnp.where(jnp.all(valid), 1.0, jnp.nan).astype(dtype)
    params = (lower * defined, upper, closed_over)
    count = jax.eval_shape(function, lower, params).size - 1
    return _Posed(function, params, count, names, logarithmic, dtype)


def _with_derivatives(posed: _Posed, found: Solution) -> Minimum:
    minima = (found.u, found.multipliers, found.values, found.slopes)
    u, multipliers, values, slopes = tied(posed.function, found.scale, minima, posed.params)
    found = found._replace(u=u, multipliers=multipliers, values=values, slopes=slopes)
    lower, upper, _ = posed.params
    return _minimum_of(found, posed.names, lower, upper, posed.logarithmic)


def plan_of(
    n: int,
    limits: int,
    dtype: Any = None,
    samples: int | None = None,
    starts: int | None = None,
    max_steps: int = 200,
    noise: float | None = None,
) -> Plan:
    """The plan of the search for so many variables and limits."""
    dtype = np.dtype(jnp.result_type(float)) if dtype is None else dtype
    along = samples or {1: 65, 2: 33, 3: 17}.get(n, max(3, int(4096 ** (1.0 / n))))
    begun = min(along**n, starts or (3 if n == 1 else 24))
    noise = 16.0 * float(jnp.finfo(dtype).eps) if noise is None else noise
    return Plan(n, limits, along, begun, max_steps, noise, dtype)


def _logarithmic(space: Mapping[str, Interval]) -> np.ndarray:
    return np.array([interval.scale == "logarithmic" for interval in space.values()])


def _named(names: Iterable[str], values: Any) -> dict[str, Any]:
    return dict(zip(names, values, strict=True))


def _minimum_of(found: Solution, names: tuple[str, ...], lower: Any, upper: Any, logarithmic: np.ndarray) -> Minimum:
    """A solution in terms of the named variables."""
    values, slopes = found.values, found.slopes
    at_best, at_rival = (_decoded(u, lower, upper, logarithmic) for u in found.u)
    # Without limits: JAX 0.10 cannot transpose an index into an empty array.
    xp = namespace(values)
    multipliers = (
        found.multipliers[0] * found.scale[0] / found.scale[1:] if found.multipliers.size else xp.zeros(0, values.dtype)
    )
    first, last = _ends(lower, upper, logarithmic)
    outward = (slopes[0, 0] + multipliers @ slopes[0, 1:]) / (0.5 * (last - first))
    return Minimum(
        variables=_named(names, at_best),
        value=values[0, 0],
        side=_named(names, found.side.astype(int)),
        bound_multipliers=_named(names, xp.where(found.side == 0.0, 0.0, outward)),
        limits=values[0, 1:],
        multipliers=multipliers,
        projected_gradient=found.residual,
        converged=found.converged,
        certified=found.certified,
        proven=found.proven,
        rival=_named(names, xp.where(found.has_rival, at_rival, np.nan)),
        rival_value=xp.where(found.has_rival, values[1, 0], np.inf),
        steps=found.steps,
    )


# --- on the scale of the search ---------------------------------------------------------------------------------------


def _ends(lower: Any, upper: Any, logarithmic: np.ndarray) -> Any:
    """The bounds on the scale of the search, (2, n)."""
    xp = namespace(lower, upper)
    ends = xp.stack([lower, upper])
    return xp.where(logarithmic, xp.log(xp.where(logarithmic, ends, 1.0)), ends) if np.any(logarithmic) else ends


def _decoded(u: Any, lower: Any, upper: Any, logarithmic: np.ndarray) -> Any:
    """The variables for u in [-1, 1]; at its ends the bounds as they were given."""
    xp = namespace(u, lower, upper)
    first, last = _ends(lower, upper, logarithmic)
    value = 0.5 * (first + last) + 0.5 * (last - first) * u
    if np.any(logarithmic):
        value = xp.where(logarithmic, xp.exp(xp.where(logarithmic, value, 0.0)), value)
    exact = xp.where(u >= 1.0, upper, xp.where(u <= -1.0, lower, xp.clip(value, lower, upper)))
    return exact if xp is np else materialised(value + jax.lax.stop_gradient(exact - value), u)


# --- one loop or many calls -------------------------------------------------------------------------------------------


def _searched(function: Callable[[Array], Array], plan: Plan) -> Solution:
    """The search as one loop, whose program contains the objective once."""
    evaluate = jax.vmap(with_slopes(function))

    def step(state: State) -> State:
        return tell(plan, state, *evaluate(state.points), objective=function)

    first = jax.tree.map(jnp.asarray, begin(plan))
    return conclude(plan, jax.lax.while_loop(lambda state: state.phase != DONE, step, first))


def found_by(
    evaluate: Callable[[dict[str, np.ndarray]], tuple[Any, Any]],
    space: Mapping[str, Interval],
    plan: Plan,
) -> Minimum:
    """Minimise as `minimise` does, for concrete numbers: a loop in Python over two small programs.

    The compiled programs serve all questions with as many variables and limits.

    Args:
        evaluate: Takes the variables, each an array of shape (lanes,), to the values of the objective and the limits,
            (lanes, 1 + m), and to their slopes by the variables, or their logarithms where the scale is
            logarithmic, (lanes, 1 + m, n). The number of lanes is always the same.
        space: The interval of each variable.
        plan: How the search is done.

    Returns:
        The best minimum, of NumPy arrays.
    """
    lower, upper = (np.array([getattr(i, end) for i in space.values()], plan.dtype) for end in ("lower", "upper"))
    logarithmic = _logarithmic(space)
    first, last = _ends(lower, upper, logarithmic)
    state = begin(plan)
    while state.phase != DONE:
        at = _decoded(state.points, lower, upper, logarithmic)
        values, slopes = evaluate(_named(space, at.T))
        state = tell(plan, state, np.asarray(values), 0.5 * (last - first) * np.asarray(slopes))
    return _minimum_of(conclude(plan, state), tuple(space), lower, upper, logarithmic)


# --- a known minimum -----------------------------------------------------------------------------------------


def _given(at: Minimum, posed: _Posed) -> Solution:
    """A minimum in the form of a result of the search."""
    params, logarithmic = jax.lax.stop_gradient(posed.params), posed.logarithmic
    lower, upper, _ = params
    first, last = _ends(lower, upper, logarithmic)
    dtype = first.dtype

    def encoded(variables: Variables) -> Array:
        value = jnp.stack([jnp.asarray(x, dtype) for x in variables.values()])
        along = jnp.where(logarithmic, jnp.log(jnp.where(logarithmic, value, 1.0)), value)
        return jnp.clip((2.0 * along - first - last) / (last - first), -1.0, 1.0)

    side = jnp.stack([jnp.asarray(side, dtype) for side in at.side.values()])
    best = jnp.where(side == 0.0, encoded(at.variables), side)
    has_rival = jnp.isfinite(at.rival_value)
    u = jnp.stack([best, jnp.where(has_rival, encoded(at.rival), best)])
    values, slopes = slopes_at(posed.function, u, params)
    return Solution(
        u=u,
        multipliers=jnp.stack(2 * [jnp.asarray(at.multipliers, dtype)]),
        values=values,
        slopes=slopes,
        side=side,
        scale=jnp.ones(values.shape[1], dtype),
        residual=jnp.asarray(at.projected_gradient),
        converged=jnp.asarray(at.converged),
        certified=jnp.asarray(at.certified),
        proven=jnp.asarray(at.proven),
        has_rival=has_rival,
        steps=jnp.asarray(at.steps),
    )
