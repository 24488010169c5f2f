"""How a design changes with its inputs."""

import re
from collections.abc import Mapping
from typing import Any

import jax.numpy as jnp
import numpy as np

from plgwear_jax._core.leaves import paths_of, with_leaf
from plgwear_jax._core.numbers import concrete_only
from plgwear_jax._core.record import record
from plgwear_jax.optimise.best import Design, stem_and_side
from plgwear_jax.optimise.evaluation import Known, Rows, evaluate
from plgwear_jax.optimise.question import Question, moved
from plgwear_jax.optimise.search import conditions, inclination, solved_by_elimination


@record
class Sensitivities:
    """How a design changes with its inputs, by the implicit function theorem.

    Each is a derivative with respect to the logarithm of an input, that is per 100 % of it (k and nu: per unit).

    Attributes:
        variables: Derivatives of each variable (except for k of its logarithm), by input.
        saving: Derivatives of the share that the best design saves against the reference, by input.
    """

    variables: dict[str, dict[str, float]]
    saving: dict[str, float]


# At the best point x the conditions c(x, input) = 0 hold for every input, so dx/dinput = -(dc/dx)^-1 dc/dinput. These
# derivatives are differences of fourth order of exact slopes, by the program of the search, which is compiled already.
# Here x is k, nu or an exponent, and the logarithm of every other variable.


@concrete_only("optimise.designs works there, with derivatives, for contacts with closed forms")
def sensitivities(found: Design) -> Sensitivities:
    """The derivatives of a design with respect to every input of its question.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The inputs are the numbers of the contact, such as E0, k, radius, friction, indenter_E; tangential_force (all
    amplitudes); the bounds, such as "lowest k"; the limits, such as "limit: edge_pressure"; and the depths of windows.

    Args:
        found: The result of `design`.

    Returns:
        The derivatives by input, to some ten digits in float64.

    Raises:
        ValueError: The design is one for scenarios: where two of them are equally bad, there are none. Or it breaks a
            limit, and is no optimum.
    """
    if found.question.scenarios is not None:
        raise ValueError("sensitivities takes a design without scenarios: where two are equally bad it has none")
    if not found.keeps_limits:
        raise ValueError("sensitivities takes a design that keeps its limits: one that breaks them is no optimum")
    minimum, question, runs, variables, saving = found.minimum, found.question, Known(), {}, {}
    multipliers, side = np.asarray(minimum.multipliers), np.array([int(side) for side in minimum.side.values()])
    best = found.variables

    def rows(question: Question, variables: Mapping[str, float]) -> Rows:
        """Values, (1 + m,), and slopes, (1 + m, n), at a point."""
        at = evaluate(question, variables, runs)
        return at.values[0], at.slopes[0]

    here = rows(question, best)

    def changes(steps: np.ndarray, beside: list[Rows]) -> Rows:
        """Derivatives of values and slopes by what is changed in steps."""
        # Values are subtracted first, so that the derivative of what does not change is exactly 0.
        values, slopes = (np.array(part) - now for now, part in zip(here, zip(*beside, strict=True), strict=True))
        return np.tensordot(_weights_of(steps), values, 1), np.tensordot(_weights_of(steps), slopes, 1)

    curvatures = []
    for name, value in best.items():
        steps = _input_steps(name, value)
        beside = [rows(question, {**best, name: moved(name, value, step)}) for step in steps]
        curvatures.append(changes(steps, beside)[1])
    state = conditions(*here, np.stack(curvatures, axis=-1), np.where(side == 0, 0.0, side), multipliers)
    share, room = float(found.value / found.reference_value), dict[str, float]()
    if question.by_force:  # F_x < mu F_N
        room.update(dict.fromkeys(("tangential_force", "friction", "normal_force"), -np.log(np.max(question.phi))))
    for name, (path, value) in inputs(question).items():
        # By its change the values and slopes change; a bound moves only a variable that lies on it.
        along, values, slopes = np.zeros(len(best)), *map(np.zeros_like, here)
        end, _, variable = name.partition(" ")
        if variable in best:
            along += (np.array([*best]) == variable) & (side == {"lowest": -1, "highest": 1}[end])
        else:
            steps = _input_steps(path, float(np.max(value)), room.get(name, 1.0))
            values, slopes = changes(steps, [rows(changed(question, path, value, step), best) for step in steps])
        of_variables = np.where(state.side == 0.0, inclination(slopes, multipliers), -along)
        of_limits = np.where(state.active > 0.0, values[1:], 0.0)
        dx = -solved_by_elimination(state.matrix, np.concatenate([of_variables, of_limits]))[: len(best)]
        variables[name] = dict(zip(best, dx.tolist(), strict=True))
        saving[name] = -share * float(values[0] + here[1][0] @ dx)
    return Sensitivities(variables, saving)


def _input_steps(path: str, value: float, room: float = 1.0) -> np.ndarray:
    """Changes of a number that leave it well within its range, (5,)."""
    of = path.rpartition(".")[2]
    room = {"k": 1.0 - abs(value), "nu": 1.0 + value}.get(of, room)
    # With this step the error of a difference of fourth order equals that of rounding.
    steps = float(jnp.finfo(jnp.result_type(float)).eps) ** 0.2 * min(room, 1.0) * np.arange(-2.0, 3.0)
    return steps - max(value + steps[-1] - 0.5, 0.0) if of == "nu" else steps  # nu <= 1/2


def _weights_of(steps: np.ndarray) -> np.ndarray:
    """The weights of the values after five steps in the derivative before them."""
    scale = np.max(np.abs(steps))
    return np.linalg.solve(np.vander(steps / scale, increasing=True).T, np.eye(steps.size)[1]) / scale


# --- the inputs -------------------------------------------------------------------------------------------------------


def inputs(question: Question) -> dict[str, tuple[str, Any]]:
    """The path and the value of each input by its name; the amplitudes count as one, layers and tables one by one."""
    found = {}
    for path, leaf in paths_of(question).items():
        if path.startswith("contact") and np.ndim(leaf):
            found |= {f"{path[8:]}[{i}]": (f"{path}[{i}]", value) for i, value in enumerate(leaf)}
        elif path != "load.weight":
            found[_name(path, question)] = path, leaf
    return found


def changed(question: Question, path: str, value: Any, step: float) -> Question:
    """The question with an input changed: k, nu and exponents by a sum, all else by the logarithm of a factor."""
    return with_leaf(question, path, moved(path, value, step))


def _name(path: str, question: Question) -> str:
    """How an input is called."""
    if bound := re.fullmatch(r"bounds\['(.*)'\]\[(.)\]", path):
        return f"{('lowest', 'highest')[int(bound[2])]} {bound[1]}"
    parts = re.findall(r"\w+", path)
    room, key, last = parts[0], parts[1], parts[-1]
    if room == "limits":
        name = question.limits[int(key)].name
        stem, end = stem_and_side(name)
        if last == "value":
            return f"limit: {end} {stem}" if end else f"limit: {stem}"
        return f"limit: {last}" if name == "edge_pressure" else f"limit: {last} of {name}"
    if room == "places":
        return f"{last} of {question.objective}"
    return f"indenter_{last}" if key == "indenter" else last  # the half-space has a nu of its own
