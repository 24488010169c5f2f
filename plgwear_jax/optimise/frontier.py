"""The trade-off between wear and the pressure beside the stick edge."""

import dataclasses
from collections.abc import Callable, Mapping

import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._formula import POSITIVE, check
from plgwear_jax._record import record
from plgwear_jax.contact import FrettingContact
from plgwear_jax.optimise.minimum import Minimum, found_by
from plgwear_jax.optimise.problem import (
    Bounds,
    Hold,
    Limits,
    ModulusWindow,
    Objective,
    Question,
    Task,
    asked,
    evaluate,
    limits_by_name,
    space,
)

__all__ = ["Front", "front"]

DISTANCE = POSITIVE


@record
class Front:
    """The least wear for each edge pressure that may be allowed, from the lowest possible to that of the least wear.

    Attributes:
        edge_pressure: The limit of the pressure in Pa at the critical distance, shape (points,), rising.
        value: The objective in SI units, shape (points,), falling.
        variables: The best variables, each of shape (points,).
        converged: Whether each search came to rest; a front is right where this holds.
        certified: Whether nothing better was met.
        distance: The critical distance in m.
        objective: What was minimised.
    """

    edge_pressure: Array
    value: Array
    variables: dict[str, Array]
    converged: Array
    certified: Array
    distance: ArrayLike
    objective: str


def front(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    vary: Mapping[str, Bounds | ModulusWindow],
    *,
    distance: float,
    points: int = 41,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: Limits | None = None,
) -> Front:
    """The trade-off between wear and the pressure beside the stick edge: the least of the one for each of the other.

    Args:
        contact: As for `design`, and so are all arguments not named here.
        tangential_force: See `design`.
        vary: See `design`.
        distance: Critical distance in m inside the stick edge at which the pressure is taken, positive.
        points: How many edge pressures, at least 2.
        weight: See `design`.
        level: See `design`.
        hold: See `design`.
        minimise: See `design`.
        limits: Other limits to keep to; without an edge pressure.

    Returns:
        The front; every point is a design, and one program serves all of them.

    Raises:
        ValueError: See `design`; or the limits already hold an edge pressure.
    """
    limits = limits or Limits()
    if not isinstance(contact, FrettingContact):
        raise ValueError("gross slip has no stick edge")
    if limits.edge_pressure is not None:
        raise ValueError("limits: the front itself sets the edge pressure")
    check("distance", distance, DISTANCE)
    if points < 2:
        raise ValueError(f"points = {points}: at least 2")
    # The pressure stands among the limits of all searches, in those for its ends as one that is far off.
    limits = dataclasses.replace(limits, edge_pressure=1.0, distance=distance)
    question, task = asked(contact, tangential_force, vary, weight, level, hold, minimise, limits)
    gentlest = _found(question, task, _least_pressure)
    least = _found(question, task, _least_wear)
    ends = evaluate(question, task, _joined(gentlest, least))
    pressure = np.exp(np.linspace(*ends.values[:, 1 + _row(task)], points))

    def best(allowed: float) -> Minimum:
        return _found(question, dataclasses.replace(task, limits=dataclasses.replace(limits, edge_pressure=allowed)))

    # At its ends the front is known, and the search would have a single point left there.
    designs = [gentlest, *(best(allowed) for allowed in pressure[1:-1]), least]
    variables = _joined(*designs)
    at = evaluate(question, task, variables)
    converged, certified = (np.array([getattr(x, name) for x in designs]) for name in ("converged", "certified"))
    value = np.exp(at.values[:, 0] + at.log_unit)
    return Front(pressure, value, variables, converged, certified, distance, question.objective)


_Told = tuple[np.ndarray, np.ndarray]  # values and slopes
_FAR_OFF = -1.0  # the logarithm of what is limited over a limit that does not count


def _row(task: Task) -> int:
    """Which of the limits is the edge pressure."""
    return list(limits_by_name(task.limits)).index("edge_pressure")


def _joined(*designs: Minimum) -> dict[str, np.ndarray]:
    return {name: np.stack([found.variables[name] for found in designs]) for name in designs[0].variables}


def _least_wear(values: np.ndarray, slopes: np.ndarray, row: int) -> _Told:
    """Without the limit of the pressure."""
    values[:, 1 + row], slopes[:, 1 + row] = _FAR_OFF, 0.0
    return values, slopes


def _least_pressure(values: np.ndarray, slopes: np.ndarray, row: int) -> _Told:
    """With the pressure instead of the wear."""
    values[:, 0], slopes[:, 0] = values[:, 1 + row], slopes[:, 1 + row]
    return _least_wear(values, slopes, row)


def _found(
    question: Question, task: Task, told: Callable[[np.ndarray, np.ndarray, int], _Told] | None = None
) -> Minimum:
    row = _row(task)

    def at(variables: dict[str, np.ndarray]) -> _Told:
        values, slopes, _ = evaluate(question, task, variables)
        return (values, slopes) if told is None else told(values, slopes, row)

    return found_by(at, space(task), len(limits_by_name(task.limits)))
