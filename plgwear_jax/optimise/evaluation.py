"""The program of a question, and the search for concrete numbers."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._startup.programs import program
from plgwear_jax.optimise.candidate import Candidate, limits_by_name, reference_variables, rows, space
from plgwear_jax.optimise.minimum import Minimum, found_by, plan_of
from plgwear_jax.optimise.problem import Question, solved_numerically
from plgwear_jax.optimise.state import Plan

__all__ = [
    "Evaluation",
    "Told",
    "concrete",
    "evaluate",
    "search",
    "states_of",
]


class Evaluation(NamedTuple):
    """The result of `evaluate` at several choices of the variables."""

    values: Any  # of `rows`, (lanes, 1 + m)
    slopes: Any  # with respect to k, and to the logarithm of other variables, (lanes, 1 + m, n)
    materials: Any  # `PowerLawGraded`, each field an array of shape (lanes,)
    log_unit: Any  # to be added to the objective for SI units


@program(static=1)
def _evaluate(names: tuple[str, ...], question: Question, variables: dict[str, Array]) -> Evaluation:
    still = jnp.zeros_like(variables[names[0]])
    radii = None
    if question.hold is not None:  # one call for all radii, that of the reference last
        reference = reference_variables(question)
        everyone = {name: jnp.append(variables[name], reference[name]) for name in names}
        free = Candidate(dataclasses.replace(question, hold=None), everyone).contact_radius
        radii = free[:-1], free[-1]

    def along(name: str) -> tuple[Array, Array]:
        """`rows`, and their slopes by one of the variables."""

        def moved(step: Array) -> Array:
            value = variables[name]
            there = variables | {name: value + step if name == "k" else value * jnp.exp(step)}
            return rows(question, there, radii and (None, radii[1]))

        return jax.jvp(moved, (still,), (jnp.ones_like(still),))

    told = [along(name) for name in names]  # XLA computes the common values once
    values, slopes = told[0][0], jnp.stack([slope for _, slope in told], axis=-1)
    candidate = Candidate(question, variables, radii)
    materials = jax.tree.map(lambda field: jnp.broadcast_to(field, still.shape), candidate.contact.material)
    return Evaluation(values, slopes, materials, candidate.log_unit())


def _program(question: Question) -> Any:
    """What computes an `Evaluation`, of static names, a question and variables."""
    if not solved_numerically(question):
        return _evaluate
    from plgwear_jax.optimise.pairs import evaluate_pairs  # which other designs do not need

    return evaluate_pairs


def evaluate(question: Question, variables: Mapping[str, ArrayLike]) -> Evaluation:
    """`rows` and their slopes at concrete choices of the variables, each an array of shape (points,).

    The program takes as many points as the search does, and is compiled once for a question: another load, limit or
    material uses it again.
    """
    numbers = concrete(question)
    points = {name: np.atleast_1d(concrete(variables[name])) for name in question.bounds}
    lanes = _plan(question).lanes
    count = next(iter(points.values())).size
    run, found = _program(question), []
    for first in range(0, count, lanes):
        some = {name: value[np.minimum(np.arange(first, first + lanes), count - 1)] for name, value in points.items()}
        found.append(jax.device_get(run(tuple(points), numbers, some)))
    values, slopes, materials = jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *(x[:3] for x in found))
    return Evaluation(values, slopes, materials, found[0][3])


def states_of(question: Question, variables: Mapping[str, ArrayLike]) -> Any:
    """The states at the largest amplitude of contacts under an elastic indenter, by the program of the search."""
    from plgwear_jax.optimise.pairs import states_at

    points = {name: np.asarray(concrete(variables[name])) for name in question.bounds}
    return states_at(tuple(points), concrete(question), points, _plan(question).lanes)


def concrete(tree: Any) -> Any:
    """The same numbers as NumPy arrays of one dtype, so that one program is enough."""
    dtype = np.dtype(jnp.result_type(float))
    return jax.tree.map(lambda x: np.asarray(x, dtype), tree)


def _plan(question: Question) -> Plan:
    plan = plan_of(len(question.bounds), len(limits_by_name(question.limits)))
    if not solved_numerically(question):
        return plan
    # Each value takes milliseconds, and wear changes smoothly with a gradient.
    return plan if plan.variables == 1 else plan._replace(samples=9, starts=3)


Told = tuple[np.ndarray, np.ndarray]  # values and slopes


def search(question: Question, told: Callable[[np.ndarray, np.ndarray], Told] | None = None) -> Minimum:
    """The minimum of the logarithm of the objective, for concrete numbers.

    Args:
        question: What is asked.
        told: Changes the values and slopes before the search gets them, to minimise something else by the same program.
    """
    numbers, run = concrete(question), _program(question)

    def at(variables: dict[str, np.ndarray]) -> Told:
        found = run(tuple(variables), numbers, variables)
        both = np.array(found[0]), np.array(found[1])
        return both if told is None else told(*both)

    return found_by(at, space(question), plan=_plan(question))
