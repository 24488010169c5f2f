"""How a design changes with its inputs."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.tree_util import tree_flatten_with_path

from plgwear_jax._core.leaves import with_leaf
from plgwear_jax._core.numbers import concrete_only
from plgwear_jax._core.record import record
from plgwear_jax.optimise.best import Design
from plgwear_jax.optimise.evaluation import (
    Known,
    Rows,
    evaluate,
)
from plgwear_jax.optimise.question import (
    Question,
)
from plgwear_jax.optimise.search import conditions, inclination, solved_by_elimination
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
        ValueError: The design is one for scenarios: where two of them are equally bad, there are none.
    """
    if found.question.scenarios is not None:
        raise ValueError("sensitivities takes a design without scenarios: where two are equally bad it has none")
    minimum, question, runs, variables, saving = found.minimum, found.question, Known(), {}, {}
    multipliers, side = np.asarray(minimum.multipliers), np.array([int(side) for side in minimum.side.values()])
    at = np.array([value if is_linear(name) else np.log(value) for name, value in found.variables.items()])
    here = _at(question, at[None], runs)
    curvatures = _curvatures(question, at, runs)
    state = conditions(here[0][0], here[1][0], curvatures, np.where(side == 0, 0.0, side), multipliers)
    share = float(found.value / found.reference_value)
    for one in inputs(question):
        # By its change the values and slopes change; a bound moves only a variable that lies on it.
        moved, values, slopes = np.zeros(at.size), *(np.zeros(part.shape[1:]) for part in here)
        if one.path[0] == "bounds":
            _, variable, end = one.path
            moved[[*question.bounds].index(variable)] = 1.0
            moved *= side == (-1, 1)[end]
        else:
            steps = _input_steps(question, one)
            beside = zip(*(_at(changed(question, one, step), at[None], runs) for step in steps), strict=True)
            # Values are subtracted first, so that the derivative of what does not change is exactly 0.
            parts = (np.concatenate(part) - now for now, part in zip(here, beside, strict=True))
            values, slopes = (np.tensordot(_weights_of_nodes(steps), part, 1) for part in parts)
        of_variables = np.where(state.side == 0.0, inclination(slopes, multipliers), -moved)
        of_limits = np.where(state.active > 0.0, values[1:], 0.0)
        dx = -solved_by_elimination(state.matrix, np.concatenate([of_variables, of_limits]))[: at.size]
        variables[one.name] = dict(zip(question.bounds, dx.tolist(), strict=True))
        saving[one.name] = -share * float(values[0] + here[1][0, 0] @ dx)
    return Sensitivities(variables, saving)


def _at(question: Question, at: np.ndarray, known: Known) -> Rows:
    """Values, (points, 1 + m), and slopes at several points, (points, n), on the scale of the search."""
    names = enumerate(question.bounds)
    found = evaluate(question, {name: at[:, i] if is_linear(name) else np.exp(at[:, i]) for i, name in names}, known)
    return found.values, found.slopes


def _curvatures(question: Question, at: np.ndarray, runs: Known) -> np.ndarray:
    """Second derivatives, (1 + m, n, n)."""
    room = {"k": lambda k: 1.0 - abs(k), "nu": lambda nu: min(1.0 + nu, 0.5 - nu)}  # within the range of the variable
    inside = (room.get(name, lambda x: 1.0)(x) for name, x in zip(question.bounds, at, strict=True))
    step = np.array([_step() * max(part, 0.01) for part in inside])
    stencil = at + np.concatenate([np.diag(x * step) for x in _NODES])
    slopes = _at(question, stencil, runs)[1].reshape(_NODES.size, at.size, -1, at.size)
    return np.einsum("j,jimk->mki", _weights_of_nodes(_NODES), slopes) / step


_NODES = np.arange(-2.0, 3.0)


def _step() -> float:
    """The step at which the error of a difference of fourth order equals that of rounding."""
    return float(jnp.finfo(jnp.result_type(float)).eps) ** 0.2


def _input_steps(question: Question, by: "Input") -> np.ndarray:
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


def _weights_of_nodes(nodes: np.ndarray) -> np.ndarray:
    """The weights of the values at five nodes in the derivative at 0."""
    scale = np.max(np.abs(nodes))
    powers = np.vander(nodes / scale, increasing=True).T
    return np.linalg.solve(powers, np.eye(nodes.size)[1]) / scale


# --- the inputs -------------------------------------------------------------------------------------------------------


class Input(NamedTuple):
    """A leaf of the question, or an entry of it.

    Attributes:
        name: As it is printed.
        place: Where the leaf is in the pytree.
        leaf: The leaf.
        entry: Which entry it is of a row of them; None for the whole leaf.
    """

    name: str
    place: tuple[Any, ...]
    leaf: Any
    entry: int | None = None

    @property
    def value(self) -> Any:
        """The number."""
        return self.leaf if self.entry is None else self.leaf[self.entry]

    @property
    def path(self) -> tuple[Any, ...]:
        """Names of fields and keys, and numbers of entries."""
        return tuple(getattr(key, "name", getattr(key, "key", getattr(key, "idx", None))) for key in self.place)


def inputs(question: Question) -> Iterator[Input]:
    """All inputs of a question; the amplitudes count as one, their weights as none, layers and tables one by one."""
    for place, leaf in tree_flatten_with_path(question)[0]:
        whole = Input("", place, leaf)
        name = _name(whole.path, question)
        if whole.path[0] == "contact" and np.ndim(leaf):
            for i in range(len(leaf)):
                yield whole._replace(name=f"{whole.path[1]}.{name}[{i}]", entry=i)
        elif name is not None:
            yield whole._replace(name=name)


def changed(question: Question, by: Input, step: float) -> Question:
    """The question with an input changed: k, nu and exponents by a sum, all else by the logarithm of a factor."""
    where = True if by.entry is None else np.arange(np.size(by.leaf)) == by.entry
    linear = any(is_linear(str(part)) for part in by.path)
    value = by.leaf + np.where(where, step, 0.0) if linear else by.leaf * np.where(where, np.exp(step), 1.0)
    return with_leaf(question, by.place, value)


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
