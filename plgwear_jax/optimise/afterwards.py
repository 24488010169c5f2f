"""What else is asked about a design: along a variable, by its inputs, under another load, after a life."""

import dataclasses
import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from jax import Array

from plgwear_jax._core.catalogue import entry, leaf, placed, quantity, read
from plgwear_jax._core.domains import POSITIVE, ArrayLike, check, record, static
from plgwear_jax._core.leaves import paths_of, with_leaf
from plgwear_jax._core.rules import BY_THEN, OF_POWER_LAW, is_after_cycles, one_of
from plgwear_jax.loads import PARTIAL_SLIP

from .best import Design, LimitState, answered, limit_states, of_design
from .conditions import conditions, residual_of, solved_by_elimination
from .evaluation import Evaluation, Known, evaluate, plan_for
from .question import Question, keeps, moved


@record
class ObjectiveCurve:
    """The objective as one variable of a design changes and the others stay.

    Attributes:
        value: The objective in SI units, shape (n,).
        keeps_limits: Whether all limits are kept, shape (n,).
    """

    value: Array
    keeps_limits: Array


@of_design
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
    at = evaluated_along(found, name, np.asarray(values))
    return ObjectiveCurve(at.objective, keeps(at.values[:, 1:]))


def evaluated_along(found: Design, name: str, values: np.ndarray) -> Evaluation:
    """The objective and the limits, with their slopes, as one variable of a design changes and the others stay."""
    if name not in found.variables:
        raise ValueError(f"{name!r} is not one of the variables {', '.join(found.variables)}")
    points = {other: np.full(values.shape, value) for other, value in found.variables.items()} | {name: values}
    reached = np.append(values, found.bounds[name])  # they may lie beyond the bounds
    bounds = {**found.question.bounds, name: (reached.min(), reached.max())}
    return evaluate(dataclasses.replace(found.question, bounds=bounds), points, vars(found).get("known"))


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


@of_design
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
    # All those of blocks.
    load = dataclasses.replace(load, load=load.load.with_amplitude(lambda x: factor * np.asarray(x)))
    question = dataclasses.replace(found.question, load=load, scenarios=scenarios)
    if question.by_force:
        check("factor * tangential_force/(friction * normal_force)", question.phi, PARTIAL_SLIP)
    best = answered(question)
    at = evaluate(question, found.variables, vars(best)["known"])
    value = float(at.objective[0])
    states = limit_states(question, at, np.zeros(len(question.limits)))
    return UnderOtherLoad(factor, value, best, value / float(best.value) - 1.0, states)


# --- the steady state after a life ------------------------------------------------------------------------------------


class InSteadyState(NamedTuple):
    """What a design for a life wears in the steady state, compared with the design that wears least there.

    Attributes:
        best: The best design for the steady state, under the same limits of the steady state.
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


_LIVES = np.append(1.0, np.geomspace(1e-3, 1e5, 383))  # at which both are compared
_SAME = 2e-3  # of the volume: the digits of the wear over cycles


@of_design
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
    if question.horizon is None:
        raise ValueError("in_steady_state takes a design for a number of cycles; this one is for the steady state")
    if not question.by_force:
        raise ValueError(
            "in_steady_state takes a design under force control; under displacement control wear ends elsewhere"
        )
    # Those after the cycles have no meaning there.
    limits = tuple(one for one in question.limits if not is_after_cycles(one.quantity))
    best = answered(dataclasses.replace(question, horizon=None, limits=limits))
    force, weight = np.asarray(load.amplitudes), np.asarray(load.weight)
    horizon, name, places = question.horizon, question.objective, question.places

    given = {**places, "cycles": np.asarray(horizon.cycles) * _LIVES, "wear_coefficient": horizon.law}
    ours, theirs = (
        weight @ np.asarray(read(one, BY_THEN[name], force[:, None], given)) for one in (found.contact, best.contact)
    )
    volume, reference_volume = (
        float(weight @ np.broadcast_to(read(one, name, force, places), force.shape))
        for one in (found.contact, question.contact)
    )
    flips_at = overtaken_at(_LIVES[1:], ours[1:] / theirs[1:] - 1.0)
    return InSteadyState(best, volume, reference_volume, float(theirs[0]), flips_at)


def overtaken_at(lives: np.ndarray, more: np.ndarray) -> float | None:
    """Where the share by which the one wears more than the other becomes positive for good."""
    below = np.flatnonzero(more < 0.0)
    if not (below.size and more[-1] > _SAME):
        return None
    near = slice(below[-1], below[-1] + 2)
    return float(np.exp(np.interp(0.0, more[near], np.log(lives[near]))))


# --- how it changes with its inputs -----------------------------------------------------------------------------------


@record
class Sensitivities:
    """How a design changes with its inputs, by the implicit function theorem.

    Each is a derivative with respect to the logarithm of an input, that is per 100 % of it (k and nu: per unit).

    Attributes:
        variables: Derivatives of each variable (except for k of its logarithm), by input.
        saving: Derivatives of the share that the best design saves against the reference, by input.
        words: What each input is called in words, by input.
    """

    variables: dict[str, dict[str, float]]
    saving: dict[str, float]
    words: dict[str, str] = static()


# At the best point x the conditions c(x, input) = 0 hold for every input, so dx/dinput = -(dc/dx)^-1 dc/dinput. These
# derivatives are differences of fourth order of exact slopes, by the program of the search, which is compiled already.
# Here x is k, nu or an exponent, and the logarithm of every other variable.


@of_design
def sensitivities(found: Design) -> Sensitivities:
    """The derivatives of a design with respect to every input of its question.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The inputs are the numbers of the contact, such as E0, k, radius, friction, indenter.E; tangential_force (all
    amplitudes), of blocks "load[0].tangential_force"; the bounds, such as "lowest k"; the limits, such as
    "limit: edge_pressure"; and where they are.

    Args:
        found: The result of `design`.

    Returns:
        The derivatives by input, to some ten digits in float64; those of a life followed step by step, as under a held
            displacement, to one or two: its wear jumps a little.

    Raises:
        ValueError: The design is one for scenarios: where two of them are equally bad, there are none. Or it breaks a
            limit, and is no optimum.
    """
    if found.question.scenarios is not None:
        raise ValueError("sensitivities takes a design without scenarios: where two are equally bad it has none")
    if not found.keeps_limits:
        raise ValueError("sensitivities takes a design that keeps its limits: one that breaks them is no optimum")
    minimum, question, runs, variables, saving, words = found.minimum, found.question, Known(), {}, {}, {}
    multipliers, side = np.asarray(minimum.multipliers), np.array([int(side) for side in minimum.side.values()])
    best, noise = found.variables, plan_for(question).noise

    def rows(question: Question, variables: Mapping[str, float]) -> np.ndarray:
        """The objective and the limits at a point with their slopes, (1 + m, 1 + n)."""
        return evaluate(question, variables, runs).rows[0]

    here = rows(question, best)

    def slopes_by(path: str, value: Any, rows_at: Callable[[Any], np.ndarray], room: float = 1.0) -> np.ndarray:
        """Derivatives of rows by k, nu or an exponent, or by the logarithm of all else."""
        steps = _input_steps(path, float(np.max(value)), room, noise)
        beside = [rows_at(moved(path, value, step)) for step in steps]
        # Values are subtracted first, so that the derivative of what does not change is exactly 0.
        # The slope where no step is made, of the polynomial through all of them.
        return np.tensordot(np.linalg.inv(np.vander(steps))[-2], beside - here, 1)

    curvatures = [
        slopes_by(name, value, lambda x, name=name: rows(question, {**best, name: x}))[:, 1:]
        for name, value in best.items()
    ]
    state = conditions(here, np.stack(curvatures, axis=-1), 1.0 * side, multipliers)
    share, room = float(found.value / found.reference_value), dict[str, float]()
    if question.by_force:  # F_x < mu F_N
        room.update(dict.fromkeys(("tangential_force", "friction", "normal_force"), -np.log(np.max(question.phi))))
    for name, (path, value, words[name]) in inputs(question).items():
        # By its change the rows change; a bound moves only a variable that lies on it.
        along, change = np.zeros(len(best)), np.zeros_like(here)
        end, _, variable = name.partition(" ")
        if variable in best:
            along += (np.array([*best]) == variable) & (side == {"lowest": -1, "highest": 1}[end])
        else:
            given = room.get(name, 1.0)
            change = slopes_by(path, value, lambda x, path=path: rows(with_leaf(question, path, x), best), given)
        left = residual_of(change, state.side - along, multipliers, state.side, state.active)
        dx = -solved_by_elimination(state.matrix, left)[: len(best)]
        variables[name] = dict(zip(best, dx.tolist(), strict=True))
        saving[name] = -share * float(change[0, 0] + here[0, 1:] @ dx)
    return Sensitivities(variables, saving, words)


def _input_steps(path: str, value: float, room: float = 1.0, noise: float = 1e-4) -> np.ndarray:
    """Changes of a number that leave it well within its range, (5,)."""
    of = path.rpartition(".")[2]
    room = {"k": 1.0 - abs(value), "nu": 1.0 + value}.get(of, room)
    # With this step the error of a difference of fourth order is some of the noise: a longer one may leave a regime.
    steps = (0.1 * noise) ** 0.2 * min(room, 1.0) * np.arange(-2.0, 3.0)
    return steps - max(value + steps[-1] - 0.5, 0.0) if of == "nu" else steps  # nu <= 1/2


# --- the inputs -------------------------------------------------------------------------------------------------------


def inputs(question: Question) -> dict[str, tuple[str, Any, str]]:
    """The path, the value and the words of each input by its name.

    The amplitudes of a table count as one, blocks, layers and tables of moduli one by one.
    """
    found = {}
    for path, given in paths_of(question).items():
        if path.startswith("contact") and np.ndim(given):
            for i, value in enumerate(given):
                name = f"{path[8:]}[{i}]"
                found[name] = f"{path}[{i}]", value, entry(name).name
        elif path != "load.weight":
            name, words = _called(path, question)
            found[name] = path, given, words
    return found


def _called(path: str, question: Question) -> tuple[str, str]:
    """How an input is called, and in words."""
    if bound := re.fullmatch(r"bounds\['(.*)'\]\[(.)\]", path):
        side = ("lowest", "highest")[int(bound[2])]
        return f"{side} {bound[1]}", f"{side} {entry(bound[1]).name} allowed"
    parts = re.findall(r"\w+", path)
    room, key, last = parts[0], parts[1], parts[-1]
    if room == "limits":
        limit = question.limits[int(key)]
        if last == "value":
            return "limit: " + re.sub("(.*)_(lowest|highest)", r"\2 \1", limit.name), limit.words
        of = "" if limit.name == "edge_pressure" else f" of {limit.name}"
        return f"limit: {last}{of}", f"{last} of the {limit.words}"
    if room == "places":
        return f"{last} of {question.objective}", f"{last} of the {placed(question.objective, question.places)}"
    if last in OF_POWER_LAW:
        return last, f"{entry(last).name} of the reference"
    if room == "contact":  # the half-space has a nu of its own
        return path[8:] if key == "indenter" else last, entry(path[8:]).name
    name = f"load[{parts[3]}].{last}" if "of" in parts else last  # of several blocks
    return name, (quantity(name) or leaf(name)).name
