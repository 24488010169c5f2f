"""The best design over scenarios: the mean, the worst of them, or the mean of the worst, within limits in all of them.

Which scenarios are the worst depends on the design. So a search takes a few choices of their weights, and of the
scenarios in which limits are kept: no design can be better than the best of these relaxed questions. Where its answer
is as bad as the true one, it is the best of all. Where it is not, the weights and scenarios that are worst there join.
Over amplitudes alone, by which wear grows for every design, one choice is enough: `loads.tail_weights`.
"""

import dataclasses
from collections.abc import Mapping

import numpy as np
from jax.typing import ArrayLike

from plgwear_jax.optimise.evaluation import (
    Evaluator,
    Known,
    Rows,
    Worst,
    of_scenarios,
    over_scenarios,
    plan_for,
    reference_variables,
    search,
)
from plgwear_jax.optimise.minimum import Minimum
from plgwear_jax.optimise.question import Question, keeps

_ROUNDS = 30
_FAR_OFF = -1.0  # log(value/limit) of a limit that has no effect
_CLOSED = 1e-9  # of the logarithm of the objective


def search_over_scenarios(question: Question, known: Known) -> Minimum:
    """The minimum of the logarithm of the objective over the scenarios of a question, for concrete numbers."""
    closed, evaluator = max(_CLOSED, plan_for(question).noise), Evaluator(question, plan_for(question).lanes, known)

    def worst_at(variables: Mapping[str, ArrayLike]) -> Worst:
        return over_scenarios(question, *evaluator.rows(evaluator.points(variables)))

    at = worst_at(reference_variables(question))
    choices = [at.weights[0]]
    pairs = [(int(scenario), limit) for limit, scenario in enumerate(at.scenario[0])]
    best, multipliers, all_known = None, np.zeros(0), False
    for _ in range(_ROUNDS):
        found = [_relaxed(question, choices, pairs, which, known) for which in range(len(choices))]
        best = min(found, key=_badness)
        multipliers = np.zeros(len(at.scenario[0]), best.multipliers.dtype)
        for (_, limit), multiplier in zip(pairs, best.multipliers[len(choices) - 1 :], strict=False):
            multipliers[limit] += multiplier
        at = worst_at(best.variables)
        # Where the limits cannot be kept, a part of the box is empty: nothing is missed there.
        all_known = all(one.certified or not keeps(one.limits) for one in found)
        new = [(int(scenario), limit) for limit, scenario in enumerate(at.scenario[0])]
        new = [pair for pair in new if pair not in pairs and at.values[0, 1 + pair[1]] > closed]
        worse = at.values[0, 0] > float(best.value) + closed
        if worse and any(np.allclose(at.weights[0], one, rtol=1e-12, atol=1e-15) for one in choices):
            all_known = False  # a search has not ended where its limits are kept
            worse = False
        if not new and not worse:
            break
        pairs += new
        if worse:
            choices.append(at.weights[0])
    else:
        all_known = False
    assert best is not None
    return dataclasses.replace(
        best,
        value=at.values[0, 0],
        limits=at.values[0, 1:],
        multipliers=multipliers,
        certified=best.certified & all_known,
        proven=best.proven & all_known & (len(choices) == 1),
    )


def _badness(found: Minimum) -> tuple[bool, float]:
    kept = bool(keeps(found.limits)) and bool(np.isfinite(found.value))
    return (False, float(found.value)) if kept else (True, float(np.max(found.limits, initial=-np.inf)))


def _relaxed(
    question: Question, choices: list[np.ndarray], pairs: list[tuple[int, int]], which: int, known: Known
) -> Minimum:
    """The best design where one choice of the weights is the worst of those that are known, within some limits."""
    count = len(choices) - 1 + len(pairs)
    room = next(size for size in (0, 1, 2, 4, 8, 16, 32, 64, count) if size >= count)  # for few programs
    others = [other for other in range(len(choices)) if other != which]
    scenarios, limits = np.array(pairs, int).reshape(-1, 2).T
    weights = np.array(choices)

    def changed(values: np.ndarray, slopes: np.ndarray) -> Rows:
        each = of_scenarios(question, values, slopes)
        totals = np.maximum(each.amounts @ weights.T, np.finfo(values.dtype).tiny)  # a depth can be 0
        logs, inclined = np.log(totals), np.einsum("kc,lcn->lkn", weights, each.by) / totals[..., None]
        goal, along = logs[:, which], inclined[:, which]
        found = np.full((len(values), 1 + room), _FAR_OFF, values.dtype)
        by = np.zeros((*found.shape, slopes.shape[-1]), values.dtype)
        found[:, 0], by[:, 0] = goal, along
        found[:, 1 : len(choices)] = logs[:, others] - goal[:, None]
        by[:, 1 : len(choices)] = inclined[:, others] - along[:, None]
        found[:, len(choices) : 1 + count] = each.excess[:, scenarios, limits]
        by[:, len(choices) : 1 + count] = each.inclined[:, scenarios, limits]
        return found, by

    return search(question, changed, known, limits=room)
