"""How a design changes with what it was made for."""

import dataclasses
from collections.abc import Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax.optimise.conditions import conditions, solved
from plgwear_jax.optimise.designing import Design
from plgwear_jax.optimise.problem import Evaluation, Task, evaluate, reference_variables

__all__ = ["Sensitivities", "sensitivities"]


@dataclasses.dataclass(frozen=True)
class Sensitivities:
    """How a design changes with what it was made for, by the implicit function theorem.

    Each is a derivative with respect to the logarithm of an input, that is per 100 % of it (k and nu: per unit).

    Attributes:
        variables: Of each variable (other than k: of its logarithm), by input.
        saving: Of the share that the best design saves against the reference, by input.
    """

    variables: dict[str, dict[str, float]]
    saving: dict[str, float]


# At the best point u the conditions c(u, x) = 0 hold, whatever the input x is: du/dx = -(dc/du)^-1 dc/dx. What is in
# them are slopes, which are exact; their derivatives here are differences of fourth order, right to some 10 digits, and
# need no program but that of the search.


def sensitivities(found: Design) -> Sensitivities:
    """The derivatives of a design with respect to every input of its scene.

    The inputs are E0, z0, k, nu (unless it is Holl's) of the reference; radius, normal_force, friction (gross slip:
    radius, depth) of the contact; tangential_force (all amplitudes alike); the bounds, such as "lowest k"; the limits.

    Args:
        found: The result of `design`.

    Returns:
        The derivatives by input, to some ten digits in float64.
    """
    here = _told(found, found.task)
    names, by_values, by_slopes, shifts, by_reference = list(_inputs(found.task)), [], [], [], []
    for name in names:
        steps = _steps(found.task, name)
        told = [_told(found, _changed(found.task, {name: step})) for step in steps]
        # What does not change at all then has no derivative at all, not even by rounding.
        parts = (np.stack(part) - now for now, part in zip(here, zip(*told, strict=True), strict=True))
        changes = (np.tensordot(_weights(steps), part, 1) for part in parts)
        for collected, change in zip((by_values, by_slopes, shifts, by_reference), changes, strict=True):
            collected.append(change)
    minimum, values, slopes = found.minimum, np.stack(by_values), np.stack(by_slopes)
    du = np.asarray(_implicit(*here[:2], _curvatures(found), _place(found), minimum.multipliers, values, slopes))
    lower, upper = _ends(found.task)
    variables = np.stack(shifts) + 0.5 * (upper - lower) * du
    share = float(found.value / found.reference_value)
    saving = -share * (values[:, 0] + du @ here.slopes[0] - np.stack(by_reference))
    return Sensitivities(
        variables={name: dict(zip(found.variables, x.tolist(), strict=True)) for name, x in zip(names, variables, strict=True)},
        saving=dict(zip(names, saving.tolist(), strict=True)),
    )


@jax.jit
def _implicit(
    values: Array, slopes: Array, curvatures: Array, u: Array, multipliers: Array, by_values: Array, by_slopes: Array
) -> Array:
    """du/dx for each input x, (inputs, n), from the derivatives of values and slopes at a fixed u."""
    state = conditions(values, slopes, curvatures, u, multipliers)

    def change(by_values: Array, by_slopes: Array) -> Array:
        inclined = jnp.where(state.side == 0.0, by_slopes[0] + multipliers @ by_slopes[1:], 0.0)
        right = jnp.concatenate([inclined, jnp.where(state.active > 0.0, by_values[1:], 0.0)])
        return -solved(state.matrix, right)[: u.size]

    return jax.vmap(change)(by_values, by_slopes)


class _Told(NamedTuple):
    """What there is at the best point u."""

    values: np.ndarray  # (1 + m,)
    slopes: np.ndarray  # by u, (1 + m, n)
    at: np.ndarray  # the variables, or their logarithms, (n,)
    reference: np.ndarray  # the objective of the reference


def _ends(task: Task) -> np.ndarray:
    """Bounds of each variable, or of its logarithm, (2, n)."""
    return np.array([np.log(pair) if name != "k" else pair for name, pair in task.bounds.items()], float).T


def _place(found: Design) -> np.ndarray:
    """The best point on its box, [-1, 1]."""
    lower, upper = _ends(found.task)
    at = np.array([value if name == "k" else np.log(value) for name, value in found.variables.items()])
    side = np.array([int(side) for side in found.minimum.side.values()])
    return np.where(side == 0, np.clip((2.0 * at - lower - upper) / (upper - lower), -1.0, 1.0), side)


def _evaluated(found: Design, task: Task, u: np.ndarray) -> tuple[Evaluation, np.ndarray]:
    """What lies at some points u, and last at the reference; with the place of the first of them."""
    (lower, upper), reference = _ends(task), reference_variables(task)
    half = 0.5 * (upper - lower)
    at = np.where(u < 0.0, lower + half * (1.0 + u), upper - half * (1.0 - u))  # on a bound nothing but that
    points = {
        name: np.append(at[:, i] if name == "k" else np.exp(at[:, i]), reference[name])
        for i, name in enumerate(task.bounds)
    }
    told = evaluate(found.question, task, points)
    return told._replace(slopes=told.slopes * half), at[0]


def _told(found: Design, task: Task) -> _Told:
    told, at = _evaluated(found, task, _place(found)[None])
    return _Told(told.values[0], told.slopes[0], at, told.values[-1, 0])


def _curvatures(found: Design) -> np.ndarray:
    """Second derivatives by u, (1 + m, n, n)."""
    u, n = _place(found), len(found.variables)
    step = np.clip(0.5 * (1.0 - np.abs(u)), _STEP**2, _STEP)  # no further than the box
    centre = np.clip(u, 2.0 * step - 1.0, 1.0 - 2.0 * step)
    stencil = centre + np.concatenate([np.diag(x * step) for x in _NODES])
    slopes = _evaluated(found, found.task, stencil)[0].slopes[:-1].reshape(_NODES.size, n, -1, n)
    return np.einsum("j,jimk->mki", _weights(_NODES), slopes) / step


# --- differences ------------------------------------------------------------------------------------------------------

_STEP = float(jnp.finfo(jnp.result_type(float)).eps) ** 0.2
_NODES = np.arange(-2.0, 3.0)


def _steps(task: Task, name: str) -> np.ndarray:
    """Changes of an input that leave it within its range, (5,)."""
    value, room = float(np.asarray(_inputs(task)[name])), np.inf
    symbol = name.split()[-1]
    if symbol == "k":
        room = 1.0 - abs(value)
    elif symbol == "nu":
        room = 1.0 + value
    elif symbol in _OF_AMPLITUDE and task.phi is not None:  # F_x < mu F_N
        room = -np.log(np.max(task.phi))
    steps = min(_STEP, 0.2 * room) * _NODES
    return steps - max(value + steps[-1] - 0.5, 0.0) if symbol == "nu" else steps  # nu <= 1/2


def _weights(nodes: np.ndarray) -> np.ndarray:
    """Of the values at five nodes in the derivative at 0."""
    scale = np.max(np.abs(nodes))
    powers = np.vander(nodes / scale, increasing=True).T
    return np.linalg.solve(powers, np.eye(nodes.size)[1]) / scale


# --- inputs by name ---------------------------------------------------------------------------------------------------


def _inputs(task: Task) -> dict[str, ArrayLike]:
    """All inputs but the amplitudes' own numbers, by the names that people are told."""
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
