"""What limits cost: the trade-off between wear and the pressure beside the stick edge, and limits in conflict."""

import dataclasses
import functools
from collections.abc import Mapping, Sequence

import jax
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.record import record, static
from plgwear_jax.contact import FrettingContact
from plgwear_jax.optimise.candidate import reference_variables
from plgwear_jax.optimise.designing import ACTIVE, Design
from plgwear_jax.optimise.evaluation import Rows, evaluate, search
from plgwear_jax.optimise.minimum import Minimum
from plgwear_jax.optimise.question import (
    Bounds,
    Hold,
    Limit,
    LimitsGiven,
    ModulusWindow,
    Objective,
    keeps,
    limited,
    limits_by_name,
    limits_of,
    question_of,
)
from plgwear_jax.wear_laws import WearLaw


@record
class Front:
    """The least wear for each allowed edge pressure, from the lowest possible pressure to that of the least wear.

    Attributes:
        edge_pressure: The limit of the pressure in Pa at the critical distance, shape (points,), rising.
        value: The objective in SI units, shape (points,), falling.
        variables: The best variables, each of shape (points,).
        at_bound: -1, 0 or +1 for each variable: on its lower bound, between, on its upper bound, each of shape
            (points,).
        active: Whether a design reaches a limit other than that of the pressure, and would be better without it, by the
            names of `Design.limits`, each of shape (points,).
        converged: Whether each search ended at a minimum; only there is the front right.
        certified: Whether each converged, and the global search found nothing better.
        reference_edge_pressure: The edge pressure of the contact as it was given.
        reference_value: Its objective.
        distance: The critical distance in m.
        objective: What was minimised.
    """

    edge_pressure: Array
    value: Array
    variables: dict[str, Array]
    at_bound: dict[str, Array]
    active: dict[str, Array]
    converged: Array
    certified: Array
    reference_edge_pressure: Array
    reference_value: Array
    distance: ArrayLike
    objective: str = static()

    @property
    def ends(self) -> tuple[str, str]:
        """What ends the front at the lowest and the highest pressure: bounds and limits, or nothing but the optimum."""
        return self._ended_by(0) or "least pressure", self._ended_by(-1) or "least wear"

    def _ended_by(self, end: int) -> str:
        said = [
            f"{name} at its {'upper' if side[end] > 0 else 'lower'} bound"
            for name, side in self.at_bound.items()
            if side[end]
        ]
        for name in (name for name, active in self.active.items() if active[end]):
            stem, _, which = name.rpartition("_") if name.endswith(("_lowest", "_highest")) else (name, "", "highest")
            said.append(f"{which} {stem.replace('_', ' ')} allowed")
        return ", ".join(said)


@for_numbers("optimise.designs works there for contacts with closed forms")
def front(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    vary: Mapping[str, Bounds | ModulusWindow],
    *,
    distance: float,
    points: int = 21,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: LimitsGiven | None = None,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | WearLaw | None = None,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> Front:
    """The trade-off between wear and the pressure beside the stick edge: the least wear for each allowed pressure.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

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
        limits: Further limits, without an edge pressure.
        cycles: See `design`; the pressure is that of the steady state at the force amplitude.
        wear_coefficient: See `design`.
        control: See `design`.
        rig_stiffness: See `design`.

    Returns:
        The front; every point is a design, and one program serves all of them.

    Raises:
        ValueError: See `design`; or the limits already hold an edge pressure.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> contact = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), 5e-3, 10.0, 0.4)
        >>> asked = {"distance": 1e-6, "hold": "contact_radius_by_E0", "points": 3}
        >>> curve = optimise.front(contact, 0.32, {"k": (-0.5, 0.5)}, **asked)
        >>> print([f"{100.0 * value / curve.reference_value:.0f} %" for value in curve.value])
        ['133 %', '102 %', '84 %']

    References:
        `docs/how-to/designs.md`, "The trade-off curve".
    """
    if not isinstance(contact, FrettingContact):
        raise ValueError("contact takes a FrettingContact: gross slip has no stick edge")
    others = limits_of(limits, "fretting")
    if "edge_pressure" in others:
        raise ValueError("limits: the front itself sets the edge pressure")
    check("distance", distance, POSITIVE)
    if points < 2:
        raise ValueError(f"points = {points}: at least 2")
    # All searches have the pressure among their limits, so that they share a program; for the ends it has no effect.
    life = cycles, wear_coefficient, control, rig_stiffness
    question = question_of(contact, tangential_force, vary, weight, level, hold, minimise, limits, *life)
    pressed = Limit(None, 1.0, {"distance": distance})
    question = dataclasses.replace(question, limits=others | {"edge_pressure": pressed})
    names = list(limits_by_name(question.limits))
    row = names.index("edge_pressure")
    look = functools.partial(search, question, known={})
    others = [other for other in range(len(names)) if other != row]
    gentlest, least = (look(functools.partial(_instead, goal, others)) for goal in (row, None))
    ends = evaluate(question, _joined([gentlest, least]).variables)
    first, last = ends.values[:, 1 + row]
    pressure = np.exp(np.linspace(first, last, points))

    # The ends of the front are known; a search there would have a single point to choose from. The limit of the
    # question stays 1 Pa: what is known of its points serves all pressures.
    inner = [look(functools.partial(_allowing, row, np.log(allowed))) for allowed in pressure[1:-1]]
    designs = _joined([gentlest, *inner, least])
    variables, reference = designs.variables, reference_variables(question)
    at = evaluate(question, {name: np.append(variables[name], reference[name]) for name in variables})
    value = np.exp(at.values[:, 0] + at.log_unit)
    return Front(
        edge_pressure=pressure,
        value=value[:-1],
        variables=variables,
        at_bound=designs.side,
        active={name: designs.multipliers[:, i] > ACTIVE for i, name in enumerate(names) if i != row},
        converged=designs.converged,
        certified=designs.certified,
        reference_edge_pressure=np.exp(at.values[-1, 1 + row]),
        reference_value=value[-1],
        distance=distance,
        objective=question.objective,
    )


def _allowing(row: int, log_pressure: float, values: np.ndarray, slopes: np.ndarray) -> Rows:
    """With another limit of the pressure."""
    values[:, 1 + row] -= log_pressure
    return values, slopes


def _joined(designs: list[Minimum]) -> Minimum:
    return jax.tree.map(lambda *leaves: np.stack(leaves), *designs)


_FAR_OFF = -1.0  # log(value/limit) of a limit that has no effect


def _instead(goal: int | None, kept: Sequence[int], values: np.ndarray, slopes: np.ndarray) -> Rows:
    """log(value/limit) of one limit in place of the objective, if one is named, and only some of the limits."""
    if goal is not None:
        values[:, 0], slopes[:, 0] = values[:, 1 + goal], slopes[:, 1 + goal]
    left_out = [1 + row for row in range(values.shape[1] - 1) if row not in kept]
    values[:, left_out], slopes[:, left_out] = _FAR_OFF, 0.0
    return values, slopes


# --- limits that cannot be kept together ------------------------------------------------------------------------------


@record
class Conflict:
    """Limits that no design within the bounds keeps together. Without any one of them the others can be kept.

    Attributes:
        allowed: These limits in SI units, by the names of `Design.limits`.
        reachable: For each of them the best value while the others are kept: the largest if its name ends in "_lowest",
            else the least.
    """

    allowed: dict[str, float]
    reachable: dict[str, float]


@for_numbers("optimise.designs works there for contacts with closed forms")
def conflict(found: Design) -> Conflict | None:
    """Why no design keeps the limits, by the programs that the design has compiled.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `design`.

    Returns:
        Limits that cannot be kept together, as few as possible, and what is reachable; None if the design keeps its
        limits, or none of these searches finds why it could not.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> limits = optimise.Limits(contact_radius=(9e-5, None), penetration=1e-6)
        >>> best = optimise.design(contact, 1.0, {"k": (-0.5, 0.5), "E0": (50e9, 200e9)}, limits=limits)
        >>> why = optimise.conflict(best)
        >>> print(", ".join(why.allowed), f"{why.reachable['penetration']:.2e} m")
        contact_radius_lowest, penetration 1.09e-06 m

    References:
        `docs/how-to/designs.md`.
    """
    limits = limits_by_name(found.question.limits)
    if found.keeps_limits or not limits:
        return None
    names, known = list(limits), {}

    def nearest(name: str, others: Sequence[str]) -> Minimum:
        """The design that breaks one limit the least, or keeps it the best, while it keeps others."""
        kept = [names.index(other) for other in others]
        return search(found.question, functools.partial(_instead, names.index(name), kept), known)

    def can_be_kept(together: Sequence[str]) -> bool:
        first, *others = together
        at = nearest(first, others)
        return keeps(np.append(at.limits, at.value))

    if can_be_kept(names):
        return None
    guilty = names
    for name in names:
        others = [other for other in guilty if other != name]
        if others and not can_be_kept(others):
            guilty = others
    allowed = {name: float(np.asarray(limits[name])) for name in guilty}
    reachable = {}
    for name in guilty:
        excess = float(nearest(name, [other for other in guilty if other != name]).value)
        reachable[name] = allowed[name] * float(np.exp(-excess if limited(name)[1] else excess))
    return Conflict(allowed, reachable)
