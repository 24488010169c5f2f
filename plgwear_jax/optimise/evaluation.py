"""The program of a question, and the search for concrete numbers."""

import dataclasses
import functools
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import RefusedError
from plgwear_jax._startup.programs import program
from plgwear_jax.optimise.candidate import Candidate, by_half_space, moved, reference_variables, rows_of, space
from plgwear_jax.optimise.loads import tail_weights
from plgwear_jax.optimise.minimum import Minimum, found_by, plan_of
from plgwear_jax.optimise.question import Question, limits_by_name, read_from_runs, solved_one_by_one
from plgwear_jax.optimise.search_state import Plan

if TYPE_CHECKING:  # designs for the steady state do not need it
    from plgwear_jax.optimise.along_exponent import RunsAlongExponent


class Evaluation(NamedTuple):
    """The result of `evaluate` at several choices of the variables."""

    values: Any  # of `Candidate.rows`, (lanes, 1 + m)
    slopes: Any  # by the variables on the scale on which they are searched, (lanes, 1 + m, n)
    materials: Any  # each field an array of shape (lanes, ...)
    log_unit: Any  # to be added to the objective for SI units


@program(static=1)
def _evaluate(
    names: tuple[str, ...], question: Question, runs: "RunsAlongExponent | None", variables: dict[str, Array]
) -> Evaluation:
    still = jnp.zeros_like(variables[names[0]])
    radii = None
    if question.hold is not None:  # one call for all radii, that of the reference last
        reference = reference_variables(question)
        everyone = {name: jnp.append(variables[name], reference[name]) for name in names}
        free = Candidate(dataclasses.replace(question, hold=None), everyone).contact_radius
        radii = free[:-1], free[-1]

    def along(name: str) -> tuple[Array, Array]:
        """`Candidate.rows`, and their slopes by one of the variables."""

        def there(step: Array) -> Array:
            return rows_of(question, moved(variables, {name: step}), radii and (None, radii[1]), runs)

        return jax.jvp(there, (still,), (jnp.ones_like(still),))

    rows = [along(name) for name in names]  # XLA computes the common values once
    values, slopes = rows[0][0], jnp.stack([slope for _, slope in rows], axis=-1)
    candidate = Candidate(question, variables, radii, runs)
    materials = jax.tree.map(lambda field: jnp.broadcast_to(field, still.shape), candidate.contact.material)
    return Evaluation(values, slopes, materials, candidate.log_unit())


def evaluate(question: Question, variables: Mapping[str, ArrayLike], known: "Known | None" = None) -> Evaluation:
    """`Candidate.rows` and their slopes at concrete choices of the variables, each an array of shape (points,).

    The program takes as many points as the search does, and is compiled once for a question: another load, limit or
    material uses it again. Of scenarios the values are those over all of them.
    """
    found = _at_points(question, variables, {} if known is None else known)
    if question.cases is None:
        return found
    values, slopes, *_ = over_cases(question, found.values, found.slopes)
    return found._replace(values=values, slopes=slopes)


def evaluate_cases(question: Question, variables: Mapping[str, ArrayLike], known: "Known") -> "Worst":
    """The same for a question with scenarios, with those that are the worst."""
    found = _at_points(question, variables, known)
    return over_cases(question, found.values, found.slopes)


def _at_points(question: Question, variables: Mapping[str, ArrayLike], known: "Known") -> Evaluation:
    points = {name: np.atleast_1d(concrete(variables[name])) for name in question.bounds}
    lanes = plan_for(question).lanes
    count = next(iter(points.values())).size
    run = _evaluator(question, known)
    found = []
    for first in range(0, count, lanes):
        some = {name: value[np.minimum(np.arange(first, first + lanes), count - 1)] for name, value in points.items()}
        found.append(jax.device_get(run(some)))
    values, slopes, materials = jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *(x[:3] for x in found))
    return Evaluation(values, slopes, materials, found[0][3])


def _evaluator(question: Question, known: "Known") -> Callable[[dict[str, Any]], Evaluation]:
    """What evaluates choices of the variables of a question, and adds to what is known."""
    names, numbers = tuple(question.bounds), concrete(question)
    if read_from_runs(question):
        from plgwear_jax.optimise.along_exponent import ends_of, runs_of  # only lives need it

        nu = numbers.contact.material.nu
        given = numbers.phi, numbers.load.weight, ends_of(numbers), [0.5 if isinstance(nu, str) else nu]
        key = np.concatenate(given).tobytes()
        if key not in known:
            known[key] = runs_of(numbers)
        return functools.partial(_evaluate, names, numbers, known[key])
    if solved_one_by_one(question):
        return functools.partial(_evaluate_solved, known, names, numbers)
    return functools.partial(_evaluate, names, numbers, None)


class Worst(NamedTuple):
    """Scenarios in one: what is minimised over all of them, and each limit where it is broken the most."""

    values: np.ndarray  # as of `Candidate.rows`, (lanes, 1 + m)
    slopes: np.ndarray  # (lanes, 1 + m, n)
    weights: np.ndarray  # with which the scenarios and amplitudes count, (lanes, scenarios * amplitudes)
    scenario: np.ndarray  # where a limit is broken the most, (lanes, m)


class OfCases(NamedTuple):
    """Values and slopes of all scenarios, of the rows of `rows_of`."""

    amounts: np.ndarray  # (lanes, scenarios * amplitudes)
    by: np.ndarray  # their slopes, (lanes, scenarios * amplitudes, n)
    excess: np.ndarray  # (lanes, scenarios, m)
    inclined: np.ndarray  # (lanes, scenarios, m, n)


def of_cases(question: Question, values: np.ndarray, slopes: np.ndarray) -> OfCases:
    """The rows of scenarios, sorted."""
    assert question.cases is not None
    lanes, n, count = len(values), slopes.shape[-1], np.size(question.cases.weight)
    values, slopes = values.reshape(lanes, count, -1), slopes.reshape(lanes, count, -1, n)
    amplitudes = values.shape[-1] - len(limits_by_name(question.limits))
    amounts, by = values[..., :amplitudes], slopes[..., :amplitudes, :]
    return OfCases(
        amounts.reshape(lanes, -1), by.reshape(lanes, -1, n), values[..., amplitudes:], slopes[..., amplitudes:, :]
    )


def over_cases(question: Question, values: np.ndarray, slopes: np.ndarray) -> Worst:
    """The mean, worst or CVaR of what is minimised over scenarios and amplitudes, and the limits, from `rows_of`."""
    assert question.cases is not None
    found, weight = of_cases(question, values, slopes), np.ones(1) if question.load is None else question.load.weight
    probable = np.ravel(np.asarray(question.cases.weight)[:, None] * np.asarray(weight))
    level = question.cases.level
    weights = np.array([np.asarray(tail_weights(lane, probable, level)) for lane in found.amounts])
    total = np.maximum(np.einsum("lc,lc->l", weights, found.amounts), np.finfo(values.dtype).tiny)  # a depth can be 0
    inclined = np.einsum("lc,lcn->ln", weights, found.by) / total[:, None]
    at = found.excess.argmax(1)
    excess = np.take_along_axis(found.excess, at[:, None], 1)[:, 0]
    steep = np.take_along_axis(found.inclined, at[:, None, :, None], 1)[:, 0]
    values = np.concatenate([np.log(total)[:, None], excess], axis=1)
    return Worst(values, np.concatenate([inclined[:, None], steep], axis=1), weights, at)


def concrete(tree: Any) -> Any:
    """The same numbers as NumPy arrays of one dtype, so that one program is enough."""
    dtype = np.dtype(jnp.result_type(float))
    return jax.tree.map(lambda x: np.asarray(x, dtype), tree)


def plan_for(question: Question) -> Plan:
    """How the minimum of a question is searched."""
    plan = plan_of(len(question.bounds), len(limits_by_name(question.limits)))
    if not solved_one_by_one(question) or read_from_runs(question):
        return plan
    # Each value takes milliseconds, and wear changes smoothly with a gradient.
    if question.life is None:
        return plan._replace(samples=plan.samples if plan.variables == 1 else 9, starts=3)
    plan = plan._replace(samples=17 if plan.variables == 1 else 9, starts=3)
    return plan if question.life.smooth else plan._replace(samples=9, max_steps=12, noise=1e-4)


Rows = tuple[np.ndarray, np.ndarray]  # values and slopes
Known = dict[bytes, Any]  # what is known of points that are solved numerically, or the runs of a question


def search(
    question: Question,
    changed: Callable[[np.ndarray, np.ndarray], Rows] | None = None,
    known: Known | None = None,
    limits: int | None = None,
) -> Minimum:
    """The minimum of the logarithm of the objective, for concrete numbers.

    Args:
        question: The inputs of the design.
        changed: Changes values and slopes before the search gets them, to minimise something else by the same program.
        known: What other searches have evaluated of this question, which this one adds to.
        limits: How many limits there are in what `changed` returns; by default those of the question.
    """
    run = _evaluator(question, {} if known is None else known)

    def at(variables: dict[str, np.ndarray]) -> Rows:
        found = run(variables)
        both = np.array(found[0]), np.array(found[1])
        return both if changed is None else changed(*both)

    plan = plan_for(question)
    return found_by(at, space(question), plan if limits is None else plan._replace(limits=limits))


# --- contacts that are solved numerically, one after the other --------------------------------------------------------


def _evaluate_solved(known: Known, names: tuple[str, ...], question: Question, variables: dict[str, Any]) -> Evaluation:
    """As `_evaluate`, for concrete numbers; no point is solved twice."""
    points = np.stack([variables[name] for name in names], axis=-1)
    keys = [point.tobytes() for point in points]
    new = {key: point for key, point in zip(keys, points, strict=True) if key not in known}
    if new:
        some = np.array([*new.values(), *points[len(new) :]])
        solved = _solve(names, question, dict(zip(names, some.T, strict=True)), np.asarray(len(new)))
        *each, unit, _ = jax.device_get(solved)
        known |= {key: (*jax.tree.map(lambda x, i=i: x[i], each), unit) for i, key in enumerate(new)}
    *parts, units = zip(*(known[key] for key in keys), strict=True)
    values, slopes, materials = (jax.tree.map(lambda *rows: np.stack(rows), *part) for part in parts)
    return Evaluation(values, slopes, materials, units[0])


def states_of(question: Question, variables: Mapping[str, ArrayLike]) -> Any:
    """The states at the largest amplitude of contacts solved by their half-space, by the program of the search."""
    some = {name: np.asarray(concrete(variables[name])) for name in question.bounds}
    count = next(iter(some.values())).size
    some = {name: np.pad(x, (0, plan_for(question).lanes - count), mode="edge") for name, x in some.items()}
    return jax.tree.map(
        lambda x: np.asarray(x)[:count], _solve(tuple(some), concrete(question), some, np.asarray(count))[-1]
    )


@program(static=1, level=1)
def _solve(
    names: tuple[str, ...], question: Question, variables: dict[str, Array], count: Array
) -> tuple[Array, Array, Any, ArrayLike, Any]:
    """Values, slopes, materials, the unit, and the states at the largest amplitude, of the first `count` points."""
    held, fast = None, by_half_space(question) and question.cases is None
    if question.hold is not None:
        held = jnp.exp(Candidate(dataclasses.replace(question, hold=None), {}).log_radius)

    @jax.jit  # to be traced once
    def one(variables: dict[str, Array]) -> tuple[Array, Array, Any, Any]:
        def there(steps: Array) -> tuple[Array, tuple[Any, Any]]:
            at = moved(variables, dict(zip(names, steps, strict=True)))
            radii = None if held is None else (None, held)
            candidate = Candidate(question, at, radii)
            state = jax.tree.map(lambda x: x[0], candidate.solved.states) if fast else ()
            rows = candidate.rows() if question.cases is None else rows_of(question, at, radii)
            return rows, (candidate.contact.material, state)

        still = jnp.zeros(len(names), variables[names[0]].dtype)
        values, along, (material, state) = jax.linearize(there, still, has_aux=True)
        slopes = jax.vmap(along)(jnp.eye(still.size, dtype=still.dtype))
        return values, slopes.T, jax.tree.map(lambda field: jnp.asarray(field, still.dtype), material), state

    def add(i: Array, found: Any) -> Any:
        new = one({name: value[i] for name, value in variables.items()})
        return jax.tree.map(lambda whole, x: whole.at[i].set(x), found, new)

    like = jax.eval_shape(one, {name: value[0] for name, value in variables.items()})
    lanes = variables[names[0]].size
    none = jax.tree.map(lambda x: jnp.zeros((lanes, *x.shape), x.dtype), like)
    values, slopes, materials, states = jax.lax.fori_loop(0, count, add, none)
    return values, slopes, materials, Candidate(question, {}).log_unit(), states


def valued(value: Any, question: Question, contact: Any) -> Any:
    """The value of the best candidate; where none has one, an error says why by its contact."""
    if not np.isnan(value):
        return value
    why = ""
    try:
        if question.load is not None:
            _ = contact.steady(np.max(np.nan_to_num(question.load.tangential_force))).wear_volume
    except RefusedError as error:
        why = f": {error}"
    raise RefusedError(f"vary: no candidate has a {question.objective}{why}")
