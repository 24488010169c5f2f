"""What else is asked about a design: along a variable, under another load, and in the steady state after a life."""

import dataclasses
from typing import Any, NamedTuple

import numpy as np
from jax import Array

from plgwear_jax._core.domains import POSITIVE, ArrayLike, check
from plgwear_jax._core.numbers import concrete_only
from plgwear_jax._core.record import record
from plgwear_jax.catalogue import read
from plgwear_jax.loads import PARTIAL_SLIP
from plgwear_jax.optimise.best import Design, LimitState, answered, limit_states
from plgwear_jax.optimise.evaluation import Known, evaluate
from plgwear_jax.optimise.question import keeps
from plgwear_jax.rules import BY_THEN, one_of


@record
class ObjectiveCurve:
    """The objective as one variable of a design changes and the others stay.

    Attributes:
        value: The objective in SI units, shape (n,).
        keeps_limits: Whether all limits are kept, shape (n,).
    """

    value: Array
    keeps_limits: Array


@concrete_only("optimise.designs works there for contacts with closed forms")
def along(found: Design, name: str, values: ArrayLike) -> ObjectiveCurve:
    """The objective of a design as one of its variables changes and the others stay, for pictures.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `design`.
        name: One of the variables.
        values: Its values, shape (n,), in SI units.

    Returns:
        The objective, and where the limits are kept.
    """
    if name not in found.variables:
        raise ValueError(f"{name!r} is not one of the variables {', '.join(found.variables)}")
    values = np.asarray(values)
    points = {other: np.full(values.shape, value) for other, value in found.variables.items()} | {name: values}
    reached = np.append(values, found.bounds[name])  # they may lie beyond the bounds
    bounds = {**found.question.bounds, name: (reached.min(), reached.max())}
    at = evaluate(dataclasses.replace(found.question, bounds=bounds), points)
    return ObjectiveCurve(at.objective, keeps(at.values[:, 1:]))


# --- another load -----------------------------------------------------------------------------------------------------


@record
class UnderOtherLoad:
    """What a design loses under a load that it was not made for.

    Attributes:
        factor: The true amplitudes over the assumed ones.
        value: The objective of the design under the true load, in SI units.
        best: The best design for the true load.
        loss: The share by which the objective is more than that of the best. Below zero where the design breaks limits
            under the true load, which the best one keeps.
        limits: The values of the design for its limits under the true load, by name; without multipliers.
    """

    factor: float
    value: float
    best: Design
    loss: float
    limits: dict[str, LimitState]


@concrete_only("optimise.designs works there for contacts with closed forms")
def under_other_load(found: Design, factor: float = 1.1) -> UnderOtherLoad:
    """What a design loses if all amplitudes are `factor` times those that it was made for.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `design`.
        factor: The true amplitudes over the assumed ones, positive.

    Returns:
        The loss, and the best design for the true load.

    Raises:
        ValueError: The whole contact would slip, or the contact is one of gross slip, without an amplitude.
    """
    check("factor", factor, POSITIVE)
    load = found.load
    if load is None:
        raise ValueError("gross slip has no amplitude to misjudge")
    scenarios = found.question.scenarios
    if scenarios is not None and scenarios.tangential_force is not None:
        scenarios = dataclasses.replace(scenarios, tangential_force=factor * np.asarray(scenarios.tangential_force))
    question = dataclasses.replace(found.question, load=load.times(factor), scenarios=scenarios)
    if question.by_force:
        check("factor * tangential_force/(friction * normal_force)", question.phi, PARTIAL_SLIP)
    known: Known = {}
    best = answered(question, known)
    at = evaluate(question, found.variables, known)
    value = float(at.objective[0])
    states = limit_states(question, at, np.zeros(len(question.limits)))
    return UnderOtherLoad(factor, value, best, value / float(best.value) - 1.0, states)


# --- the steady state after a life ------------------------------------------------------------------------------------


class InSteadyState(NamedTuple):
    """What a design for a life wears in the steady state, compared with the design that wears least there.

    Attributes:
        best: The best design for the steady state, under the same limits.
        volume: What the design for a life wears until the steady state, in m^3; if a depth or a radius was minimised,
            that one in m.
        reference_volume: The same of the reference.
        best_by_then: What `best` wears in the life.
        flips_at: After so many lives both have worn the same, and beyond it `best` wears less; None if they are the
            same, or the design for a life wears no more in the steady state.
    """

    best: Design
    volume: float
    reference_volume: float
    best_by_then: float
    flips_at: float | None


_LIVES = np.concatenate([[1.0], np.geomspace(1e-3, 1e5, 383)])  # at which both are compared
_SAME = 2e-3  # of the volume: the digits of the wear over cycles


@concrete_only("optimise.designs works there for contacts with closed forms")
def in_steady_state(found: Design) -> InSteadyState:
    """Compare a design for a life with the best one for the steady state.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `design` with `cycles`.

    Returns:
        Both, and after how many lives the choice between them flips.

    Raises:
        ValueError: The design is one for the steady state, or under displacement control, for which Eq. (28) is not
            where the wear ends; or one for scenarios, each of which has a steady state of its own.
    """
    load, question = found.load, found.question
    if question.scenarios is not None:
        raise ValueError("in_steady_state takes a design for one contact; each scenario has a steady state of its own")
    if question.objective not in BY_THEN:
        raise ValueError(f"in_steady_state takes a design by {one_of(tuple(BY_THEN))}, not by {question.objective}")
    if load is None or question.horizon is None:
        raise ValueError("in_steady_state takes a design for a number of cycles; this one is for the steady state")
    if not question.by_force:
        raise ValueError(
            "in_steady_state takes a design under force control; under displacement control wear ends elsewhere"
        )
    best = answered(dataclasses.replace(question, horizon=None))
    force, weight = np.asarray(load.amplitudes), np.asarray(load.weight)
    horizon, name, places = question.horizon, question.objective, question.places

    def over_lives(contact: Any) -> np.ndarray:
        given = {**places, "cycles": np.asarray(horizon.cycles) * _LIVES, "wear_coefficient": horizon.law}
        return weight @ np.asarray(read(contact, BY_THEN[name], force[:, None], given))

    def for_good(contact: Any) -> float:
        return float(weight @ np.broadcast_to(read(contact, name, force, places), force.shape))

    ours, theirs = map(over_lives, (found.contact, best.contact))
    flips_at = overtaken_at(_LIVES[1:], ours[1:] / theirs[1:] - 1.0)
    return InSteadyState(best, for_good(found.contact), for_good(question.contact), float(theirs[0]), flips_at)


def overtaken_at(lives: np.ndarray, more: np.ndarray) -> float | None:
    """Where the share by which the one wears more than the other becomes positive for good."""
    below = np.flatnonzero(more < 0.0)
    if not (below.size and more[-1] > _SAME):
        return None
    near = slice(below[-1], below[-1] + 2)
    return float(np.exp(np.interp(0.0, more[near], np.log(lives[near]))))
