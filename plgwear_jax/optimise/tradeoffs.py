"""What limits cost: the trade-off between two quantities, such as wear and edge pressure, and limits in conflict."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, Unpack

import jax
import numpy as np
from jax import Array

from plgwear_jax._core.catalogue import entry, placed
from plgwear_jax._core.domains import concrete_only, record, static, whole
from plgwear_jax._core.rules import LARGER, WrongKeyError
from plgwear_jax._core.words import shown
from plgwear_jax.contact import FrettingContact, GrossSlipContact

from .ask_and_tell import INFINITE
from .best import ACTIVE, Design, of_design
from .evaluation import Known, evaluate, reference_variables, search, valued
from .question import (
    Bounds,
    Keywords,
    Limit,
    LoadGiven,
    Objective,
    Question,
    checked_kind_of,
    keeps,
    limits_of,
    objective_of,
    question_of,
)
from .search import Minimum


@record
class Front:
    """The best y for each allowed x, from the best x that is possible to the x of the best y.

    By default the least wear for each allowed edge pressure, from the lowest possible pressure to that of the least
    wear. Where larger is better, the best is the largest.

    Attributes:
        x: What is allowed of the one quantity in SI units, shape (points,), from the best value on.
        y: The other quantity, the objective, in SI units, shape (points,), up to its best value.
        variables: The best variables, each of shape (points,).
        at_bound: -1, 0 or +1 for each variable: on its lower bound, between, on its upper bound, each of shape
            (points,).
        active: Whether a design reaches a limit other than that of x, and would be better without it, by the
            names of `Design.limits`, each of shape (points,).
        converged: Whether each search ended at a minimum; only there is the front right.
        certified: Whether each converged, and the global search found nothing better.
        reference_x: x of the contact as it was given.
        reference_y: y of that contact.
        x_places: The place in m at which x is taken, by "r" or "distance"; empty if it has none.
        y_places: The same for y.
        x_name: x in the catalogue.
        y_name: y in the catalogue.
        larger: Which of both is the better the larger it is: "", "x", "y" or "xy".
        limits: Those that `active` names.
    """

    x: Array
    y: Array
    variables: dict[str, Array]
    at_bound: dict[str, Array]
    active: dict[str, Array]
    converged: Array
    certified: Array
    reference_x: Array
    reference_y: Array
    x_places: dict[str, Any]
    y_places: dict[str, Any]
    x_name: str = static()
    y_name: str = static()
    larger: str = static(default="")
    limits: tuple[Limit, ...] = ()

    @property
    def best(self) -> tuple[str, str]:
        """What is best at the first and at the last point, in words: least edge pressure, least wear volume."""
        first, last = (
            f"{'largest' if one in self.larger else 'least'} {entry(name).name}"
            for one, name in (("x", self.x_name), ("y", self.y_name))
        )
        return first, last

    @property
    def ends(self) -> tuple[str, str]:
        """What ends the front at its first and last point: bounds and limits, or nothing but the optimum."""
        told = []
        for end, best in zip((0, -1), self.best, strict=True):
            said = [
                f"{name} at its {'upper' if side[end] > 0 else 'lower'} bound"
                for name, side in self.at_bound.items()
                if side[end]
            ]
            said += [limit.words for limit in self.limits if self.active[limit.name][end]]
            told.append(", ".join(said) or best)
        return told[0], told[1]


@concrete_only("optimise.designs works there for contacts with closed forms")
def front(
    contact: FrettingContact | GrossSlipContact,
    load: LoadGiven,
    vary: Mapping[str, Bounds],
    x: Objective = "edge_pressure",
    y: Objective | None = None,
    *,
    larger: Literal["", "x", "y", "xy"] = "",
    distance: float | None = None,
    points: int = 21,
    **keywords: Unpack[Keywords],
) -> Front:
    """The trade-off between any two quantities of a contact: the best y for each allowed x.

    By default the least wear for each allowed pressure beside the stick-slip boundary.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: As for `design`, and so are all arguments not named here.
        load: See `design`.
        vary: See `design`.
        x: Any quantity of the contact that is a positive number, by its name in the catalogue, with its place if it
            needs one: "penetration", {"wear_depth": {"r": 5e-5}}. As a limit it is that of the steady state at the
            largest amplitude that counts, or after the cycles if it is one such as "transient.wear_depth".
        y: The other one, which is optimised: of the load and after the cycles as in `design`; by default `minimise`.
        larger: Which of both is the better the larger it is, such as "x" with "stick_radius"; else the smaller.
        distance: The place of x if it is an edge pressure given by its name alone, in m inside the stick-slip boundary,
            positive.
        points: How many values of x, at least 2.
        **keywords: As for `design`, without scenarios; the limits are further ones, without x.

    Returns:
        The front; every point is a design, and one program serves all of them.

    Raises:
        ValueError: See `design`; or the limits already hold x.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> curve = optimise.front(contact, 1.0, {"k": (-0.5, 0.5)}, "penetration", "deepest_wear", points=5)
        >>> print(curve.certified.all(), curve.ends[0])
        True least indentation depth

    References:
        `docs/how-to/designs.md`, "The trade-off curve".
    """
    if larger not in LARGER:
        raise ValueError(f"larger = {shown(larger)}: must be one of {', '.join(map(shown, LARGER))}")
    if distance is not None:
        if not isinstance(x, str):
            raise ValueError("distance: is the place of an x given by its name alone")
        x = {x: {"distance": distance}}
    kind = checked_kind_of(contact)
    name, places = objective_of(x, kind, "x")
    if keywords.get("scenarios") is not None:
        raise ValueError("scenarios: front takes none")
    limits = keywords.get("limits")
    if any(one.quantity == name for one in limits_of(limits, kind)):
        raise ValueError(f"limits: the front itself sets the {entry(name).name}")
    whole("points", points, 2)
    # All searches have x among their limits, so that they share a program; for the ends it has no effect. The limit of
    # the question stays 1 in SI units: what is known of its points serves all values of x.
    keywords["limits"] = {**(limits or {}), name: {"above" if "x" in larger else "below": 1.0, **places}}
    keywords["minimise"] = keywords.get("minimise") if y is None else y
    question = question_of(contact, load, vary, **keywords)
    of_several = question.load is not None and question.load.weight.size > 1  # of which y is a mean
    if (name, places) == (question.counted, question.places) and not of_several:
        raise WrongKeyError("x", f"the {placed(name, places)} is also y; a trade-off takes two quantities")
    row = 1 + [one.quantity for one in question.limits].index(name)
    others = {i: 0.0 for i in range(1, 1 + len(question.limits)) if i != row}
    x_side, y_side = (-1.0 if one in larger else 1.0 for one in "xy")
    known: Known = {}
    of_x = _least_within(question, known, {row: 1.0, 0: _TIE * y_side}, others)
    of_y = _least_within(question, known, {row: _TIE, 0: y_side}, others)
    first, last = evaluate(question, _joined([of_x, of_y]).variables, known).values[:, row]
    # The logarithm of 0 is -INFINITE here.
    if valued(last - first, question, contact) > 0.5 * INFINITE:
        told = "is 0 at one end of the front; a trade-off takes what stays above 0"
        raise WrongKeyError("x", f"the {placed(name, places)} {told}")
    allowed = np.linspace(first, last, points)  # log(x), negative where larger is better
    # The ends of the front are known; a search there would have a single point to choose from.
    inner = [_least_within(question, known, {0: y_side}, {**others, row: one}) for one in allowed[1:-1]]
    designs = _joined([of_x, *inner, of_y])
    variables, reference = designs.variables, reference_variables(question)
    at = evaluate(question, {one: np.append(variables[one], reference[one]) for one in variables}, known)
    return Front(
        x=np.exp(x_side * allowed),
        y=at.objective[:-1],
        variables=variables,
        at_bound=designs.side,
        active={question.limits[i - 1].name: designs.multipliers[:, i - 1] > ACTIVE for i in others},
        converged=designs.converged,
        certified=designs.certified,
        reference_x=np.exp(x_side * at.values[-1, row]),
        reference_y=at.objective[-1],
        x_places=places,
        y_places=question.places,
        x_name=name,
        y_name=question.objective,
        larger=larger,
        limits=tuple(question.limits[i - 1] for i in others),
    )


_FAR_OFF = -1.0  # log(value/limit) of a limit that has no effect
_TIE = 1e-6  # weight of the other quantity at the ends of a front, which chooses among designs with the best one


def _joined(designs: list[Minimum]) -> Minimum:
    return jax.tree.map(lambda *leaves: np.stack(leaves), *designs)


def _least_within(question: Question, known: Known, goal: Mapping[int, float], allowed: Mapping[int, float]) -> Minimum:
    """The least sum of rows with these weights, where the rows named last, of limits, are no more than is allowed."""
    kept, most = [*allowed], [*allowed.values()]

    def asked(rows: np.ndarray) -> np.ndarray:
        asked = np.zeros_like(rows)
        asked[..., 0] = _FAR_OFF
        asked[:, 0] = sum(weight * rows[:, row] for row, weight in goal.items())
        asked[:, kept] = rows[:, kept]
        asked[:, kept, 0] -= most
        return asked

    return search(question, asked, known)


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


@of_design
def conflict(found: Design) -> Conflict | None:
    """Why no design keeps the limits, by the programs that the design has compiled.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `design`.

    Returns:
        Limits that cannot be kept together, as few as possible, and what is reachable; None if the design keeps its
        limits, if it is one for scenarios, or none of these searches finds why it could not.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> limits = {"contact_radius": {"above": 9e-5}, "penetration": {"below": 1e-6}}
        >>> best = optimise.design(contact, 1.0, {"k": (-0.5, 0.5), "E0": (50e9, 200e9)}, limits=limits)
        >>> why = optimise.conflict(best)
        >>> print(", ".join(why.allowed), f"{why.reachable['penetration']:.2e} m")
        contact_radius_lowest, penetration 1.09e-06 m

    References:
        `docs/how-to/designs.md`.
    """
    limits, known = found.question.limits, {}
    if found.keeps_limits or not limits or found.question.scenarios is not None:
        return None

    def nearest(row: int, rows: Sequence[int]) -> Minimum:
        """The design that breaks one limit the least, or keeps it the best, while it keeps the others of some rows."""
        return _least_within(found.question, known, {row: 1.0}, {one: 0.0 for one in rows if one != row})

    def can_be_kept(rows: Sequence[int]) -> bool:
        at = nearest(rows[0], rows)
        return keeps(np.append(at.limits, at.value))

    every = guilty = [*range(1, 1 + len(limits))]
    if can_be_kept(every):
        return None
    for row in every:
        others = [one for one in guilty if one != row]
        if others and not can_be_kept(others):
            guilty = others
    allowed, reachable = {}, {}
    for row in guilty:
        one, excess = limits[row - 1], nearest(row, guilty).value
        allowed[one.name] = one.value
        reachable[one.name] = allowed[one.name] * float(np.exp(-excess if one.lowest else excess))
    return Conflict(allowed, reachable)
