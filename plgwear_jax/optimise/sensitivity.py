"""How a design changes with its inputs."""

import dataclasses
from collections.abc import Iterator
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.tree_util import tree_flatten_with_path

from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import program
from plgwear_jax.optimise.conditions import conditions, inclination, solved, with_slopes
from plgwear_jax.optimise.designing import Design
from plgwear_jax.optimise.evaluation import Candidate, Known, concrete, evaluate, shared_of
from plgwear_jax.optimise.question import Question, solved_one_by_one
from plgwear_jax.rules import is_linear


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
# derivatives of closed forms are exact. For contacts that are solved numerically, and for wear over cycles, they are
# differences of fourth order of exact slopes, by the program of the search. Here x is k, nu or an exponent, and the
# logarithm of every other variable.


@for_numbers("optimise.designs works there, with derivatives, for contacts with closed forms")
def sensitivities(found: Design) -> Sensitivities:
    """The derivatives of a design with respect to every input of its question.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The inputs are the numbers of the contact, such as E0, k, radius, friction, indenter_E; tangential_force (all
    amplitudes); the bounds, such as "lowest k"; the limits, such as "limit: edge_pressure"; and the depths of windows.

    Args:
        found: The result of `design`.

    Returns:
        The derivatives by input, of closed forms to rounding error, of others to some ten digits in float64.

    Raises:
        ValueError: The design is one for scenarios: where two of them are equally bad, there are none.
    """
    if found.question.scenarios is not None:
        raise ValueError("sensitivities takes a design without scenarios: where two are equally bad it has none")
    minimum, question, all_inputs = found.minimum, found.question, list(inputs(found.question))
    here, changes, curvatures = (_by_differences if solved_one_by_one(question) else _exact)(found, all_inputs)
    side = np.array([int(side) for side in minimum.side.values()])
    u = np.where(side == 0, 0.0, side)
    state = conditions(here.values, here.slopes, curvatures, u, np.asarray(minimum.multipliers))
    variables, saving = {}, {}
    share = float(found.value / found.reference_value)
    for one, change in zip(all_inputs, changes, strict=True):
        moved = np.zeros(len(u))
        if one.path[0] == "bounds":  # a bound moves only a variable that lies on it
            _, variable, end = one.path
            moved[[*question.bounds].index(variable)] = 1.0
            moved *= side == (-1, 1)[end]
        inclined = inclination(change.slopes, np.asarray(minimum.multipliers))
        of_limits = np.where(state.active > 0.0, change.values[1:], 0.0)
        dx = -solved(state.matrix, np.concatenate([np.where(state.side == 0.0, inclined, -moved), of_limits]))[: u.size]
        variables[one.name] = dict(zip(question.bounds, dx.tolist(), strict=True))
        saving[one.name] = -share * float(change.values[0] + here.slopes[0] @ dx)
    return Sensitivities(variables, saving)


class _AtPoint(NamedTuple):
    """Values and slopes at the best point."""

    values: Any  # (1 + m,), the objective over that of the reference
    slopes: Any  # (1 + m, n)


# At the best point, their derivatives by each input, and the second derivatives by the variables (1 + m, n, n).
Changes = tuple[_AtPoint, list[_AtPoint], np.ndarray]


def _at(found: Design) -> np.ndarray:
    return np.array([value if is_linear(name) else np.log(value) for name, value in found.variables.items()])


# --- derivatives ------------------------------------------------------------------------------------------------------


def _exact(found: Design, given: "list[Input]") -> Changes:
    """By the derivatives of the closed forms."""
    question = concrete(found.question)

    def direction(by: Input) -> Question:
        def along(place: Any, value: Any) -> Any:
            if by.path[0] == "bounds" or _path(place) != by.path:
                return np.zeros_like(value)
            return np.ones_like(value) if by.linear else value

        return jax.tree_util.tree_map_with_path(along, question)

    still, x = np.zeros(len(found.variables)), concrete(_at(found))
    moves = [(direction(by), still) for by in given]
    moves += [(jax.tree.map(np.zeros_like, question), one) for one in np.eye(x.size)]
    stacked = jax.tree.map(lambda *leaves: np.stack(leaves), *moves)
    here, changes = jax.device_get(_derivatives(tuple(found.question.bounds), (question, x), stacked))
    each = [jax.tree.map(lambda leaf, i=i: leaf[i], changes) for i in range(len(given))]
    return here, each, np.moveaxis(changes.slopes[len(given) :], 0, -1)


@program(static=1)
def _derivatives(names: tuple[str, ...], at: tuple[Question, Array], moves: tuple[Question, Array]) -> Any:
    """Values and slopes for a question at x, and their derivatives in directions of both."""

    def at_point(question: Question, x: Array) -> _AtPoint:
        shared = shared_of(question)

        def there(x: Array) -> Array:
            here = {name: value if is_linear(name) else jnp.exp(value) for name, value in zip(names, x, strict=True)}
            return Candidate(question, here, shared).rows()

        return _AtPoint(*with_slopes(there)(x))

    here, along = jax.linearize(at_point, *at)
    return here, jax.vmap(along)(*moves)


# --- differences ------------------------------------------------------------------------------------------------------


def _by_differences(found: Design, given: "list[Input]") -> Changes:
    """By differences of the values and slopes that the search has."""
    runs: Known = {}
    here = _at_best(found, found.question, runs)
    nothing = _AtPoint(*(np.zeros_like(part) for part in here))
    changes = [nothing if by.path[0] == "bounds" else _change(found, here, by, runs) for by in given]
    return here, changes, _curvatures(found, runs)


def _evaluated(question: Question, at: np.ndarray, known: Known) -> _AtPoint:
    """Values and slopes at several points, (points, n)."""
    names = enumerate(question.bounds)
    found = evaluate(question, {name: at[:, i] if is_linear(name) else np.exp(at[:, i]) for i, name in names}, known)
    return _AtPoint(found.values, found.slopes)


def _at_best(found: Design, question: Question, known: Known) -> _AtPoint:
    return _AtPoint(*(part[0] for part in _evaluated(question, _at(found)[None], known)))


def _change(found: Design, here: _AtPoint, by: "Input", runs: Known) -> _AtPoint:
    """The derivatives of these values with respect to an input."""
    steps = _steps(found.question, by)
    at = [_at_best(found, changed(found.question, by, step), runs) for step in steps]
    # Values are subtracted first, so that the derivative of what does not change is exactly 0.
    parts = (np.stack(part) - now for now, part in zip(here, zip(*at, strict=True), strict=True))
    return _AtPoint(*(np.tensordot(_weights(steps), part, 1) for part in parts))


def _curvatures(found: Design, runs: Known) -> np.ndarray:
    """Second derivatives, (1 + m, n, n)."""
    at, n = _at(found), len(found.variables)
    room = {"k": lambda k: 1.0 - abs(k), "nu": lambda nu: min(1.0 + nu, 0.5 - nu)}  # within the range of the variable
    inside = (room.get(name, lambda x: 1.0)(x) for name, x in zip(found.variables, at, strict=True))
    step = np.array([_step() * max(part, 0.01) for part in inside])
    stencil = at + np.concatenate([np.diag(x * step) for x in _NODES])
    slopes = _evaluated(found.question, stencil, runs).slopes.reshape(_NODES.size, n, -1, n)
    return np.einsum("j,jimk->mki", _weights(_NODES), slopes) / step


_NODES = np.arange(-2.0, 3.0)


def _step() -> float:
    """The step at which the error of a difference of fourth order equals that of rounding."""
    return float(jnp.finfo(jnp.result_type(float)).eps) ** 0.2


def _steps(question: Question, by: "Input") -> np.ndarray:
    """Changes of an input that leave it well within its range, (5,)."""
    room, of = 1.0, by.path[-1]
    if of == "k":
        room = 1.0 - abs(float(by.value))
    elif of == "nu":
        room = 1.0 + float(by.value)
    elif of in ("tangential_force", "friction", "normal_force"):  # F_x < mu F_N
        room = -np.log(np.max(question.phi))
    steps = _step() * min(room, 1.0) * _NODES
    return steps - max(float(by.value) + steps[-1] - 0.5, 0.0) if of == "nu" else steps  # nu <= 1/2


def _weights(nodes: np.ndarray) -> np.ndarray:
    """The weights of the values at five nodes in the derivative at 0."""
    scale = np.max(np.abs(nodes))
    powers = np.vander(nodes / scale, increasing=True).T
    return np.linalg.solve(powers, np.eye(nodes.size)[1]) / scale


# --- the inputs -------------------------------------------------------------------------------------------------------


class Input(NamedTuple):
    """A leaf of the question.

    Attributes:
        name: As it is printed.
        path: Where it is in the pytree.
        value: What it is.
    """

    name: str
    path: tuple[Any, ...]
    value: Any

    @property
    def linear(self) -> bool:
        """It changes by a sum, not by a factor."""
        return any(is_linear(str(part)) for part in self.path)


def inputs(question: Question) -> Iterator[Input]:
    """All inputs of a question; the amplitudes count as one, their weights as none, layers and tables one by one."""
    for place, value in tree_flatten_with_path(question)[0]:
        path = _path(place)
        name = _name(path, question)
        if path[0] == "contact" and np.ndim(value):
            yield from (Input(f"{path[1]}.{name}[{i}]", (*path, i), one) for i, one in enumerate(value))
        elif name is not None:
            yield Input(name, path, value)


def changed(question: Question, by: Input, step: float) -> Question:
    """The question with an input changed: k and nu by a sum, all else by the logarithm of a factor."""

    def anew(place: Any, value: Any) -> Any:
        path = _path(place)
        if path == by.path[:-1]:
            return np.where(np.arange(np.size(value)) == by.path[-1], np.exp(step), 1.0) * value
        if path != by.path:
            return value
        return value + step if by.linear else value * np.exp(step)

    made = jax.tree_util.tree_map_with_path(anew, question)
    # JAX sorts the names in a dict; the order of the variables is that of the program and of all arrays.
    return dataclasses.replace(made, bounds={name: made.bounds[name] for name in question.bounds})


def _path(place: Any) -> tuple[Any, ...]:
    """Names of fields and keys, and numbers of entries."""
    return tuple(getattr(key, "name", getattr(key, "key", getattr(key, "idx", None))) for key in place)


_ENDS = "lowest", "highest"


def _name(path: tuple[Any, ...], question: Question) -> str | None:
    match path:
        case "load", "weight":
            return None
        case "contact", "indenter", field:  # the half-space has a nu of its own
            return f"indenter_{field}"
        case "bounds", variable, end:
            return f"{_ENDS[end]} {variable}"
        case "limits", number, "value":
            name = question.limits[number].name
            stem, _, end = name.rpartition("_") if name.endswith(("_lowest", "_highest")) else (name, "", "")
            return f"limit: {end} {stem}" if end else f"limit: {stem}"
        case "limits", number, "places", place:
            name = question.limits[number].name
            return f"limit: {place}" if name == "edge_pressure" else f"limit: {place} of {name}"
        case "places", place:
            return f"{place} of {question.objective}"
    return path[-1]
