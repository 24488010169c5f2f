"""The best gradient for a contact and its load, for one contact or for many."""

import dataclasses
import math
import textwrap
from collections.abc import Mapping
from typing import Any, Literal, NamedTuple, Unpack

import jax
import numpy as np
from jax import Array
from jax.core import Tracer

from plgwear_jax._core.domains import POSITIVE, ArrayLike, check
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.record import record, static
from plgwear_jax._core.units import written
from plgwear_jax.catalogue import entry, read
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.loads import PARTIAL_SLIP
from plgwear_jax.optimise.cuts import search_over_scenarios
from plgwear_jax.optimise.evaluation import (
    Evaluation,
    Evaluator,
    evaluate,
    plan_for,
    reference_variables,
    search,
    valued,
)
from plgwear_jax.optimise.loads import WeightedLoad
from plgwear_jax.optimise.minimum import Minimum
from plgwear_jax.optimise.question import (
    Bounds,
    Keywords,
    LoadGiven,
    Question,
    keeps,
    question_of,
)
from plgwear_jax.rules import BY_THEN, one_of

ACTIVE = 1e-9  # a multiplier above it is that of an active limit


@record
class LimitState:
    """The value of a design for one of its limits.

    Attributes:
        value: The limited quantity, in SI units.
        allowed: The limit.
        multiplier: By how many percent the objective falls if the limit is loosened by one percent; 0 if it is not
            active.
        quantity: What is limited, by its name in the catalogue.
        lowest: The limit is the lowest value allowed, not the highest.
    """

    value: Array
    allowed: ArrayLike
    multiplier: Array
    quantity: str = static()
    lowest: bool = static()

    @property
    def active(self) -> bool:
        """The design reaches the limit, and would be better without it."""
        return bool(self.multiplier > ACTIVE)

    @property
    def kept(self) -> bool:
        """The limit is broken by no more than rounding."""
        with np.errstate(divide="ignore"):  # what is limited can be 0
            excess = np.log(np.asarray(self.value) / np.asarray(self.allowed))
        return keeps(-excess if self.lowest else excess)


@record
class Design:
    """The best gradient for a contact and its load. A pytree, as all that belongs to it.

    Attributes:
        contact: The contact with the best material.
        value: The objective of the best contact, in SI units.
        reference_value: The objective of the reference.
        limits: The value of the best contact for each limit, by name.
        minimum: The minimum of the logarithm of the objective, with what is certain about it.
        question: The inputs: the reference, the load, the bounds and the limits.
    """

    contact: FrettingContact | GrossSlipContact
    value: Array
    reference_value: Array
    limits: dict[str, LimitState]
    minimum: Minimum
    question: Question

    @property
    def reference(self) -> FrettingContact | GrossSlipContact:
        """The contact as it was given."""
        return self.question.contact

    @property
    def objective(self) -> str:
        """What was minimised."""
        return self.question.objective

    @property
    def hold(self) -> Literal["contact_radius"] | None:
        """What was held."""
        return "contact_radius" if self.question.hold else None

    @property
    def load(self) -> WeightedLoad | None:
        """The amplitudes that count, with their weights; None for gross slip."""
        return self.question.load

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """The lowest and the highest value of each variable, by name, in SI units."""
        return {name: (number(lowest), number(highest)) for name, (lowest, highest) in self.question.bounds.items()}

    @property
    def windows(self) -> list[tuple[float, float, float]]:
        """The depths in m at which the modulus is limited, each with its lowest and highest value; NaN for none."""
        found: dict[float, list[float]] = {}
        for one in self.question.limits:
            if one.quantity == "modulus_at":
                found.setdefault(number(one.places["z"]), [math.nan, math.nan])[not one.lowest] = number(one.value)
        return [(depth, lowest, highest) for depth, (lowest, highest) in sorted(found.items())]

    @property
    def variables(self) -> dict[str, float]:
        """The values of what was varied, by name."""
        return {name: number(value) for name, value in self.minimum.variables.items()}

    @property
    def reference_variables(self) -> dict[str, float]:
        """The values of the reference for what was varied, by name."""
        return {name: number(value) for name, value in reference_variables(self.question).items()}

    @property
    def saving(self) -> float:
        """The share by which the objective is less than that of the reference."""
        return number(1.0 - self.value / self.reference_value)

    @property
    def at_bound(self) -> dict[str, Literal["lower", "upper"] | None]:
        """For each variable the bound it lies on, or None."""
        named: dict[int, Literal["lower", "upper"] | None] = {-1: "lower", 0: None, 1: "upper"}
        return {name: named[int(side)] for name, side in self.minimum.side.items()}

    @property
    def keeps_limits(self) -> bool:
        """No limit is broken by more than rounding."""
        return keeps(self.minimum.limits)

    @property
    def converged(self) -> bool:
        """The search ended at a minimum."""
        return bool(self.minimum.converged)

    @property
    def certified(self) -> bool:
        """Converged, and the global search, the scan and descents from its valleys, found nothing better: no proof."""
        return bool(self.minimum.certified)

    @property
    def proven(self) -> bool:
        """For one variable: nothing better is expected between the points of the scan; no proof, see `Minimum`."""
        return bool(self.minimum.proven)

    @property
    def rival(self) -> dict[str, float] | None:
        """The next best minimum, or None."""
        if not math.isfinite(self.minimum.rival_value):
            return None
        return {name: number(value) for name, value in self.minimum.rival.items()}

    @property
    def rival_value(self) -> float:
        """The objective of the rival, in SI units; infinite if there is none."""
        return number(self.value * np.exp(self.minimum.rival_value - self.minimum.value))

    def __repr__(self) -> str:
        try:
            return _in_words(self)
        except (TypeError, ValueError, jax.errors.JAXTypeError):  # traced, or many of them
            return f"Design(of {', '.join(self.question.bounds)}, {self.objective}={self.value!r})"


def number(value: Any) -> Any:
    """A concrete number as a float; what is traced, or an array of several, as it is."""
    return value if isinstance(value, Tracer) or np.ndim(value) else float(np.asarray(value))


@for_numbers("optimise.designs works there for contacts with closed forms")
def design(
    contact: FrettingContact | GrossSlipContact | Question,
    load: LoadGiven = None,
    vary: Mapping[str, Bounds] | None = None,
    **keywords: Unpack[Keywords],
) -> Design:
    """Find the half-space or coating on which the indenter wears least.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact with its reference material; its fields are numbers.
        load: Force amplitude F_x in N, 0 < F_x < mu F_N, or several, shape (n,), with their weights. Of a history of
            amplitudes give the largest one. With `cycles` also a `Displacement`, of partial or gross slip, or a list of
            `Block`. None for a `GrossSlipContact`.
        vary: Bounds of the variables, which are numbers of the contact in SI units: "k", "z0", "E0" and "nu" of a power
            law, "radius", "normal_force", "friction", "indenter.E", "shape.exponent", "material.thickness[0]" and
            "material.modulus[0]" of a `Layered`, "material.modulus[2]" of a `DepthGraded`. All but k, nu and exponents
            are searched on a logarithmic scale.
        **keywords: What is minimised, limited and held, and which loads count how much: see `Keywords`. A `Question`
            alone in place of all arguments asks it.

    Returns:
        The best contact, compared with the reference.

    Raises:
        ValueError: An argument is outside its range, or the variables are missing, unknown or redundant.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.design(contact, 3.2, {"k": (-0.5, 0.5)}, hold=True)
        >>> print(best.variables["k"], best.at_bound["k"])
        0.5 upper

    References:
        The mean of the worst part: Rockafellar and Uryasev, Journal of Risk 2 (2000) 21. The search:
        `docs/how-to/designs.md`.
    """
    return answered(question_of(contact, load, vary, **keywords))


def answered(question: Question) -> Design:
    """The design that answers a question."""
    known: dict[Any, Any] = {}
    found = search(question, known=known) if question.scenarios is None else search_over_scenarios(question, known)
    evaluator = Evaluator(question, plan_for(question).lanes, known)
    at = evaluator.evaluate(found.variables)
    contact = evaluator.contact(found.variables)
    return Design(
        contact=contact,
        value=valued(at.objective[0], question, contact),
        reference_value=at.scale,
        limits=_states(question, at, found.multipliers),
        minimum=found,
        question=question,
    )


def _states(question: Question, at: Evaluation, multipliers: Any) -> dict[str, LimitState]:
    """The values for the limits at the first choice of the variables."""
    found = {}
    for one, over, by in zip(question.limits, at.values[0, 1:], multipliers, strict=True):
        value = float(np.asarray(one.value)) * np.exp(-over if one.lowest else over)
        found[one.name] = LimitState(value, one.value, by, one.quantity, one.lowest)
    return found


@record
class Course:
    """The objective as one variable of a design changes and the others stay.

    Attributes:
        value: The objective in SI units, shape (n,).
        keeps_limits: Whether all limits are kept, shape (n,).
    """

    value: Array
    keeps_limits: Array


@for_numbers("optimise.designs works there for contacts with closed forms")
def along(found: Design, name: str, values: ArrayLike) -> Course:
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
    lowest, highest = found.bounds[name]
    bounds = {name: (np.min(values, initial=lowest), np.max(values, initial=highest))}
    question = dataclasses.replace(found.question, bounds=found.bounds | bounds)
    at = evaluate(question, points)
    return Course(at.objective, keeps(at.values[:, 1:]))


# --- another load -----------------------------------------------------------------------------------------------------


@record
class Misjudged:
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


@for_numbers("optimise.designs works there for contacts with closed forms")
def misjudged(found: Design, factor: float = 1.1) -> Misjudged:
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
    best = answered(question)
    at = evaluate(question, found.variables)
    value = float(at.objective[0])
    states = _states(question, at, np.zeros(len(question.limits)))
    return Misjudged(factor, value, best, value / float(best.value) - 1.0, states)


# --- the steady state after a life ------------------------------------------------------------------------------------


class ForEver(NamedTuple):
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


@for_numbers("optimise.designs works there for contacts with closed forms")
def for_ever(found: Design) -> ForEver:
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
        raise ValueError("for_ever takes a design for one contact; each scenario has a steady state of its own")
    if question.objective not in BY_THEN:
        raise ValueError(f"for_ever takes a design by {one_of(tuple(BY_THEN))}, not by {question.objective}")
    if load is None or question.horizon is None:
        raise ValueError("for_ever takes a design for a number of cycles; this one is for the steady state")
    if not question.by_force:
        raise ValueError("for_ever takes a design under force control; under displacement control wear ends elsewhere")
    best = answered(dataclasses.replace(question, horizon=None))
    force, weight = np.asarray(load.amplitudes), np.asarray(load.weight)
    horizon, name, places = question.horizon, question.objective, question.places

    def over_lives(contact: Any) -> np.ndarray:
        given = {**places, "cycles": np.asarray(horizon.cycles) * _LIVES, "wear_coefficient": horizon.law}
        return weight @ np.asarray(read(contact, BY_THEN[name], force[:, None], given))

    def for_good(contact: Any) -> float:
        return float(weight @ np.broadcast_to(read(contact, name, force, places), force.shape))

    ours, theirs = map(over_lives, (found.contact, best.contact))
    flips_at = _crossing(_LIVES[1:], ours[1:] / theirs[1:] - 1.0)
    return ForEver(best, for_good(found.contact), for_good(question.contact), float(theirs[0]), flips_at)


def _crossing(lives: np.ndarray, more: np.ndarray) -> float | None:
    """Where the share by which the one wears more than the other becomes positive for good."""
    if not more[-1] > _SAME:
        return None
    (below,) = np.nonzero(more < 0.0)
    if not below.size:
        return None
    i = below[-1]
    part = more[i] / (more[i] - more[i + 1])
    return float(lives[i] * (lives[i + 1] / lives[i]) ** part)


# --- in words ---------------------------------------------------------------------------------------------------------


_WIDTH = 98
_INDENTED: Any = {"subsequent_indent": "  "}


def _in_words(found: Design) -> str:
    """The objective, the variables, the material, what was held and limited, and what is certain."""
    lines = [headline(found)]
    for name, value in found.variables.items():
        lines.append(between(name, name, value, found.bounds[name], found.at_bound[name]))
    material = found.contact.material
    numbers = [name for name in ("E0", "z0", "k", "thickness", "modulus") if name in vars(material)]
    told = ", ".join(_named(name, getattr(material, name)) for name in numbers)
    told = "E(z) at depths" if "depth" in vars(material) else told
    lines += textwrap.wrap(f"material: {told}{f'; {found.hold} held' if found.hold else ''}", _WIDTH - 2, **_INDENTED)
    if found.load is not None:
        counting, amplitudes = int(np.count_nonzero(np.asarray(found.load.weight))), found.load.amplitudes
        told = f"{counting} amplitudes, at most " if counting > 1 else ""
        told += f"{np.max(amplitudes):.4g} N" if found.question.by_force else str(found.load.load)
        lines.append(f"load: {told}")
    if found.question.scenarios is not None:
        lines.append(f"scenarios: {np.size(found.question.scenarios.weight)}, limits for the worst of them")
    if found.limits:
        limits = []
        for state in found.limits.values():
            value, allowed = (measured(state.quantity, number) for number in (state.value, state.allowed))
            side = ">=" if state.lowest else "<="
            limits.append(f"{state.quantity} {value} {side} {allowed}{'' if state.kept else ' BROKEN'}")
        lines += textwrap.wrap(f"limits: {', '.join(limits)}", _WIDTH - 2, **_INDENTED)
    lines.append(certainty(found, ("converged", "certified", "proven")))
    return "\n  ".join(["Design:", *lines])


def _named(name: str, values: Any) -> str:
    """A number of a material, or a row of them."""
    told = ", ".join(measured(f"material.{name}", value) for value in np.ravel(values))
    return f"{name} = [{told}]" if np.ndim(values) else f"{name} = {told}"


def headline(found: Any) -> str:
    """The objective of a design, and what it saves."""
    share = 100.0 * found.saving
    much = f"{abs(share):.3g} % {'less' if share >= 0.0 else 'more'} than the reference"
    return f"{found.objective} = {measured(found.objective, found.value)}, {much}"


def between(called: str, name: str, value: Any, bounds: tuple[Any, Any], side: str | None) -> str:
    """The value of what varies, with its bounds and the one on which it lies."""
    lowest, highest = (measured(name, end) for end in bounds)
    place = f", at the {side} bound" if side else ""
    return f"{called} = {measured(name, value)}, between {lowest} and {highest}{place}"


def certainty(found: Any, names: tuple[str, ...]) -> str:
    """Which of these is true of a design, and which is not."""
    return ", ".join(name if getattr(found, name) else f"not {name}" for name in names)


def measured(name: str, value: Any) -> str:
    """A value of a quantity or a variable with its unit."""
    return written(float(np.asarray(value)), entry(name).unit)
