"""How a design changes with its inputs."""

import dataclasses
from collections.abc import Mapping
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike

from plgwear_jax.optimise.conditions import conditions, inclination, solved
from plgwear_jax.optimise.designing import Design
from plgwear_jax.optimise.problem import Evaluation, Task, evaluate, reference_variables

__all__ = ["Sensitivities", "sensitivities"]


@dataclasses.dataclass(frozen=True)
class Sensitivities:
    """How a design changes with its inputs, by the implicit function theorem.

    Each is a derivative with respect to the logarithm of an input, that is per 100 % of it (k and nu: per unit).

    Attributes:
        variables: Derivatives of each variable (except for k of its logarithm), by input.
        saving: Derivatives of the share that the best design saves against the reference, by input.
    """

    variables: dict[str, dict[str, float]]
    saving: dict[str, float]


# At the best point x the conditions c(x, input) = 0 hold for every input, so dx/dinput = -(dc/dx)^-1 dc/dinput. The
# slopes in c are exact. Their derivatives are differences of fourth order, right to some ten digits; they need only the
# program of the search. Here x is k, and the logarithm of every other variable.


def sensitivities(found: Design) -> Sensitivities:
    """The derivatives of a design with respect to every input of its scene.

    The inputs are E0, z0, k, nu (unless it is Holl's) of the reference; radius, normal_force, friction (gross slip:
    radius, depth) of the contact; tangential_force (all amplitudes); the bounds, such as "lowest k"; the limits.

    Args:
        found: The result of `design`.

    Returns:
        The derivatives by input, to some ten digits in float64.
    """
    minimum, task, here = found.minimum, found.task, _told(found, found.task)
    side = np.array([int(side) for side in minimum.side.values()])
    u = np.where(side == 0, 0.0, side)
    state = conditions(here.values, here.slopes, _curvatures(found), u, np.asarray(minimum.multipliers))
    variables, saving = {}, {}
    share = float(found.value / found.reference_value)
    for name in _inputs(task):
        end, _, variable = name.partition(" ")
        change = _Told(*(np.zeros_like(part) for part in here))
        moved = np.zeros(len(u))
        if end in _ENDS and variable in task.bounds:  # a bound moves only a variable that lies on it
            moved = np.array(
                [other == variable and side[i] == _SIDES[end] for i, other in enumerate(task.bounds)], float
            )
        else:
            change = _change(found, here, name)
        inclined = inclination(change.slopes, np.asarray(minimum.multipliers))
        of_limits = np.where(state.active > 0.0, change.values[1:], 0.0)
        dx = -solved(state.matrix, np.concatenate([np.where(state.side == 0.0, inclined, -moved), of_limits]))[: u.size]
        variables[name] = dict(zip(task.bounds, dx.tolist(), strict=True))
        saving[name] = -share * float(change.values[0] + here.slopes[0] @ dx - change.reference)
    return Sensitivities(variables, saving)


class _Told(NamedTuple):
    """Values and slopes at the best point."""

    values: np.ndarray  # (1 + m,)
    slopes: np.ndarray  # (1 + m, n)
    reference: np.ndarray  # the objective of the reference


def _at(found: Design) -> np.ndarray:
    return np.array([value if name == "k" else np.log(value) for name, value in found.variables.items()])


def _evaluated(found: Design, task: Task, at: np.ndarray) -> Evaluation:
    """Values and slopes at several points, (points, n), and last at the reference."""
    reference = reference_variables(task)
    points = {
        name: np.append(at[:, i] if name == "k" else np.exp(at[:, i]), reference[name])
        for i, name in enumerate(task.bounds)
    }
    return evaluate(found.question, task, points)


def _told(found: Design, task: Task) -> _Told:
    told = _evaluated(found, task, _at(found)[None])
    return _Told(told.values[0], told.slopes[0], told.values[-1, 0])


def _change(found: Design, here: _Told, name: str) -> _Told:
    """The derivatives of these values with respect to an input."""
    steps = _steps(found.task, name)
    told = [_told(found, _changed(found.task, {name: step})) for step in steps]
    # Values are subtracted first, so that the derivative of what does not change is exactly 0.
    parts = (np.stack(part) - now for now, part in zip(here, zip(*told, strict=True), strict=True))
    return _Told(*(np.tensordot(_weights(steps), part, 1) for part in parts))


def _curvatures(found: Design) -> np.ndarray:
    """Second derivatives, (1 + m, n, n)."""
    at, n = _at(found), len(found.variables)
    step = np.array(
        [_step() * (1.0 - abs(x) if name == "k" else 1.0) for name, x in zip(found.variables, at, strict=True)]
    )
    stencil = at + np.concatenate([np.diag(x * step) for x in _NODES])
    slopes = _evaluated(found, found.task, stencil).slopes[:-1].reshape(_NODES.size, n, -1, n)
    return np.einsum("j,jimk->mki", _weights(_NODES), slopes) / step


# --- differences ------------------------------------------------------------------------------------------------------

_NODES = np.arange(-2.0, 3.0)


def _step() -> float:
    """The step at which the error of a difference of fourth order equals that of rounding."""
    return float(jnp.finfo(jnp.result_type(float)).eps) ** 0.2


def _steps(task: Task, name: str) -> np.ndarray:
    """Changes of an input that leave it well within its range, (5,)."""
    value, room = float(np.asarray(_inputs(task)[name])), 1.0
    if name == "k":
        room = 1.0 - abs(value)
    elif name == "nu":
        room = 1.0 + value
    elif name in _OF_AMPLITUDE and task.phi is not None:  # F_x < mu F_N
        room = -np.log(np.max(task.phi))
    steps = _step() * min(room, 1.0) * _NODES
    return steps - max(value + steps[-1] - 0.5, 0.0) if name == "nu" else steps  # nu <= 1/2


def _weights(nodes: np.ndarray) -> np.ndarray:
    """The weights of the values at five nodes in the derivative at 0."""
    scale = np.max(np.abs(nodes))
    powers = np.vander(nodes / scale, increasing=True).T
    return np.linalg.solve(powers, np.eye(nodes.size)[1]) / scale


# --- inputs by name ---------------------------------------------------------------------------------------------------


def _inputs(task: Task) -> dict[str, ArrayLike]:
    """All inputs, by the names that are printed; the amplitudes as one common factor."""
    contact, limits = task.contact, task.limits
    found: dict[str, Any] = {name: getattr(contact.material, name) for name in ("E0", "z0", "k", "nu")}
    found |= {field.name: getattr(contact, field.name) for field in dataclasses.fields(contact)[1:]}
    if task.phi is not None:
        found["tangential_force"] = 1.0
    for name, pair in task.bounds.items():
        found |= {f"{end} {name}": bound for end, bound in zip(_ENDS, pair, strict=True)}
    for name in ("edge_pressure", "distance", "penetration"):
        found |= {f"limit: {name}": getattr(limits, name)}
    found |= {f"limit: {end} contact_radius": x for end, x in zip(_ENDS, limits.contact_radius or (), strict=False)}
    return {name: value for name, value in found.items() if value is not None and not isinstance(value, str)}


_ENDS = ("lowest", "highest")
_SIDES = {"lowest": -1, "highest": 1}


def _changed(task: Task, changes: Mapping[str, float]) -> Task:
    """The task with its inputs changed: k and nu by a sum, all else by the logarithm of a factor."""
    values = {
        name: value + changes[name] if name.split()[-1] in ("k", "nu") else value * np.exp(changes[name])
        for name, value in _inputs(task).items()
        if name in changes
    }
    contact, limits = task.contact, task.limits
    material = {name: values[name] for name in ("E0", "z0", "k", "nu") if name in values}
    fields = {field.name: values[field.name] for field in dataclasses.fields(contact)[1:] if field.name in values}
    contact = dataclasses.replace(contact, material=dataclasses.replace(contact.material, **material), **fields)
    phi = task.phi
    if phi is not None:  # F_x/(mu F_N)
        for name, power in (("tangential_force", 1.0), ("friction", -1.0), ("normal_force", -1.0)):
            phi = phi * np.exp(power * changes.get(name, 0.0))
    bounds = {
        name: tuple(values.get(f"{end} {name}", bound) for end, bound in zip(_ENDS, pair, strict=True))
        for name, pair in task.bounds.items()
    }
    allowed = {name: values.get(f"limit: {name}", getattr(limits, name)) for name in _PLAIN_LIMITS}
    radii = limits.contact_radius and tuple(
        values.get(f"limit: {end} contact_radius", bound)
        for end, bound in zip(_ENDS, limits.contact_radius, strict=True)
    )
    limits = dataclasses.replace(limits, **allowed, contact_radius=radii)
    return dataclasses.replace(task, contact=contact, phi=phi, bounds=bounds, limits=limits)


_PLAIN_LIMITS = ("edge_pressure", "distance", "penetration")
_OF_AMPLITUDE = ("tangential_force", "friction", "normal_force")
