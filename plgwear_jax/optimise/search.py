"""Minima of functions of a few variables over a box: inside a JAX program, or of concrete numbers.

The search itself is `ask_and_tell`. Its variables lie in [-1, 1]; here they have names, bounds and scales.
"""

import functools
from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar, Literal

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax
from jax.typing import ArrayLike

from plgwear_jax._core.domains import FINITE, NUMBER, check, nan_unless, record, static, whole
from plgwear_jax._core.startup.programs import holds_tracers
from plgwear_jax._core.xla import materialised
from plgwear_jax.special.elementary import namespace

from .ask_and_tell import DONE, Point, SearchPlan, SearchResult, begin, conclude, plan_of, tell
from .conditions import conditions, inclination, residual_of, solved_by_elimination

Variables = dict[str, Array]


@record
class Interval:
    """The range of a variable, and the scale on which it is searched.

    Attributes:
        lower: The lowest value.
        upper: The highest value, above the lowest.
        scale: "linear", or "logarithmic" for a positive variable that may change by orders of magnitude.
    """

    ranges: ClassVar = {"lower": FINITE, "upper": FINITE}

    lower: ArrayLike
    upper: ArrayLike
    scale: Literal["linear", "logarithmic"] = static(default="linear")

    def __post_init__(self) -> None:
        if self.scale not in ("linear", "logarithmic"):
            raise ValueError(f'scale = {self.scale!r} is neither "linear" nor "logarithmic"')
        if holds_tracers((self.lower, self.upper)):
            return
        if not np.all(np.less(self.lower, self.upper)):
            raise ValueError(f"[{self.lower}, {self.upper}]: the lowest value must be below the highest")
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
        scan_found_nothing_better: For one variable: nothing lower is expected between two points of the scan. This
            holds as long as the second derivative between them leaves the range of its means over this and the
            neighbouring intervals by no more than these differ, which is estimated, not bounded: no proof either. For
            several variables False.
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
    scan_found_nothing_better: Array
    rival: Variables
    rival_value: Array
    steps: Array


def minimise(
    objective: Callable[[Variables], Array],
    space: Mapping[str, Interval],
    *,
    limits: Callable[[Variables], Array] | None = None,
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
    whole("max_steps", max_steps, 1)
    for name, number, least in (("samples", samples, 3), ("starts", starts, 1)):
        if number is not None:
            whole(name, number, least)
    if noise is not None:
        check("noise", noise, NUMBER)
    if not (isinstance(space, Mapping) and space):
        raise ValueError(f"space takes an Interval for at least one name, not {space!r}")
    for name, one in space.items():
        if not isinstance(one, Interval):
            raise TypeError(f"space takes optimise.Interval(lower, upper) for {name}, not {one!r}")
    dtype = jnp.result_type(*(end for i in space.values() for end in (i.lower, i.upper)), 0.0)
    lower, upper, logarithmic = _box_of(space, jnp, dtype)

    def everything(variables: Variables) -> Array:
        value = jnp.asarray(objective(variables))[None]
        return value if limits is None else jnp.concatenate([value, jnp.asarray(limits(variables))])

    # Values that the functions close over become arguments, so that a rule can differentiate with respect to them. It
    # lives longer than traced values: the bounds are arguments as well.
    names = tuple(space)
    converted, closed_over = jax.closure_convert(everything, by_name(names, lower))

    def function(u: Array, params: Any) -> Array:
        lower, upper, closed_over = params
        return converted(by_name(names, _decoded(u, lower, upper, logarithmic)), *closed_over)

    valid = (lower < upper) & jnp.isfinite(upper - lower) & ((lower > 0.0) | ~logarithmic)
    params = (nan_unless(jnp.all(valid), lower), upper, closed_over)
    count = jax.eval_shape(function, lower, params).size - 1
    plan = plan_of(len(space), count, dtype, samples, starts, max_steps, noise)._replace(axis=axis_name)
    # Derivatives are not taken through the search, but from the conditions of the minimum, which is more accurate.
    evaluate = functools.partial(rows_at, function, params=lax.stop_gradient(params))
    found = conclude(
        plan,
        lax.while_loop(  # whose program contains the objective once
            lambda state: state.phase != DONE,
            lambda state: tell(plan, state, evaluate(state.points)),
            jax.tree.map(jnp.asarray, begin(plan)),
        ),
    )
    found = found._replace(pair=Point._make((*implicit(function, found.pair[:-1], params), found.pair.residual)))
    return _minimum_of(found, names, params[0], upper, logarithmic)


def by_name(names: Iterable[str], values: Any) -> dict[str, Any]:
    """The values by the names."""
    return dict(zip(names, values, strict=True))


def _minimum_of(found: SearchResult, names: Iterable[str], *box: Any) -> Minimum:
    """A solution in terms of the named variables."""
    u, multipliers, rows, residual = found.pair
    xp, named, values = namespace(rows), functools.partial(by_name, names), rows[..., 0]
    at_best, at_rival = (_decoded(one, *box) for one in u)
    side = xp.where(xp.abs(u[0]) == 1.0, u[0], 0.0)
    first, last = _ends(*box)
    outward = inclination(rows[0], multipliers[0]) / (0.5 * (last - first))
    return Minimum(
        variables=named(at_best),
        value=values[0, 0],
        side=named(side.astype(int)),
        bound_multipliers=named(xp.where(side == 0.0, 0.0, outward)),
        limits=values[0, 1:],
        multipliers=multipliers[0],
        projected_gradient=residual[0],
        rival=named(xp.where(found.has_rival, at_rival, np.nan)),
        rival_value=xp.where(found.has_rival, values[1, 0], np.inf),
        **found.ended,
    )


# --- on the scale of the search ---------------------------------------------------------------------------------------


def _box_of(space: Mapping[str, Interval], xp: Any, dtype: Any) -> tuple[Any, Any, np.ndarray]:
    """The lowest and highest values of the variables, each (n,), and which have a logarithmic scale."""
    lower, upper = (xp.stack([xp.asarray(getattr(i, end), dtype) for i in space.values()]) for end in Interval.ranges)
    return lower, upper, np.array([i.scale == "logarithmic" for i in space.values()])


def _ends(lower: Any, upper: Any, logarithmic: np.ndarray) -> Any:
    """The bounds on the scale of the search, (2, n)."""
    xp = namespace(lower, upper)
    ends = xp.stack([lower, upper])
    return xp.where(logarithmic, xp.log(xp.where(logarithmic, ends, 1.0)), ends)


def _decoded(u: Any, lower: Any, upper: Any, logarithmic: np.ndarray) -> Any:
    """The variables for u in [-1, 1]; at its ends the bounds as they were given."""
    xp = namespace(u, lower, upper)
    first, last = _ends(lower, upper, logarithmic)
    value = 0.5 * (first + last) + 0.5 * (last - first) * u
    value = xp.where(logarithmic, xp.exp(xp.where(logarithmic, value, 0.0)), value)
    exact = xp.where(u >= 1.0, upper, xp.where(u <= -1.0, lower, xp.clip(value, lower, upper)))
    return exact if xp is np else materialised(value + lax.stop_gradient(exact - value))


SLOW_SAMPLES = 33  # of the scan of one variable where each value takes milliseconds


def scanned(interval: Interval) -> np.ndarray:
    """The values at which a search of one variable scans it where each value takes milliseconds."""
    plan = plan_of(1, 0, samples=SLOW_SAMPLES)
    return _decoded(plan.axis_points()[:, None], *_box_of({"": interval}, np, plan.dtype))[:, 0]


def found_by(
    evaluate: Callable[[dict[str, np.ndarray]], Any],
    space: Mapping[str, Interval],
    plan: SearchPlan,
) -> Minimum:
    """Minimise as `minimise` does, for concrete numbers: a loop in Python over two small programs.

    The compiled programs serve all questions with as many variables and limits.

    Args:
        evaluate: Takes the variables, each an array of shape (lanes,), to the rows of the objective and the limits,
            (lanes, 1 + m, 1 + n), with slopes by the variables, or by their logarithms where the scale is logarithmic.
            The number of lanes is always the same.
        space: The interval of each variable.
        plan: How the search is done.

    Returns:
        The best minimum, of NumPy arrays.
    """
    box, state = _box_of(space, np, plan.dtype), begin(plan)
    first, last = _ends(*box)
    by_u = np.insert(0.5 * (last - first), 0, 1.0)
    while state.phase != DONE:
        at = by_name(space, _decoded(state.points, *box).T)
        state = tell(plan, state, by_u * np.asarray(evaluate(at)))
    return _minimum_of(conclude(plan, state), space, *box)


# --- derivatives of minima with respect to whatever their functions depend on -----------------------------------------


def rows_of(function: Callable[[Array], tuple[Any, Any]], u: Array) -> tuple[Any, Any]:
    """Values, a tree of them, each followed by its slopes along a last axis; and what the function tells besides."""

    def twice(u: Array) -> Any:
        values, more = function(u)
        return values, (values, more)

    slopes, (values, more) = (jax.jacfwd if u.size <= 3 else jax.jacrev)(twice, has_aux=True)(u)
    return jax.tree.map(lambda value, by: materialised(jnp.append(value[..., None], by, -1)), values, slopes), more


def rows_at(function: Callable[[Array, Any], Array], u: Array, params: Any) -> Array:
    """The rows of a function at several points."""
    return jax.vmap(lambda u: rows_of(lambda u: (function(u, params), ()), u)[0])(u)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def implicit(function: Callable[[Array, Any], Array], found: Any, params: Any) -> Any:
    """(u, multipliers, rows) of minima as functions of the parameters, by the implicit function theorem."""
    return found


@implicit.defjvp
def _implicit_jvp(function, primals, tangents):
    minima, params = implicit(function, *primals), primals[1]
    u, multipliers, rows = minima
    curvatures = jax.vmap(jax.jacfwd(jax.jacfwd(lambda u: function(u, params))))(u)
    here = conditions(rows, curvatures, u, multipliers)
    _, by_params = jax.jvp(functools.partial(rows_at, function, u), (params,), tangents[1:])
    _, left = jax.jvp(lambda rows: residual_of(rows, u, multipliers, here.side, here.active), (rows,), (by_params,))
    step = -solved_by_elimination(here.matrix, left)
    du, dmultipliers = jnp.split(step, u.shape[-1:], -1)
    by_u = jnp.append(rows[..., None, 1:], curvatures, -2)
    return minima, (du, dmultipliers, by_params + (by_u * du[:, None, None]).sum(-1))
