"""The best gradient for a contact and its load, for one contact or for many."""

import dataclasses
import math
import textwrap
from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

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
from plgwear_jax.optimise.candidate import HALF_SPACE, reference_variables
from plgwear_jax.optimise.cuts import search_over_cases
from plgwear_jax.optimise.evaluation import Known, evaluate, search, valued
from plgwear_jax.optimise.minimum import Minimum
from plgwear_jax.optimise.question import (
    DEEP,
    SHALLOW,
    Bounds,
    Hold,
    LimitsGiven,
    Load,
    LoadGiven,
    ModulusWindow,
    Objective,
    Question,
    keeps,
    limited,
    limits_by_name,
    question_of,
    read_from_runs,
    with_leaf,
)
from plgwear_jax.optimise.scenarios import Scenarios
from plgwear_jax.rules import BY_THEN, is_linear, one_of
from plgwear_jax.wear_laws import WearLaw

ACTIVE = 1e-9  # a multiplier above it is that of an active limit


@record
class LimitState:
    """The value of a design for one of its limits.

    Attributes:
        value: The limited quantity, in SI units.
        allowed: The limit.
        multiplier: By how many percent the objective falls if the limit is loosened by one percent; 0 if it is not
            active.
        lowest: The limit is the lowest value allowed, not the highest.
    """

    value: Array
    allowed: ArrayLike
    multiplier: Array
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
    def hold(self) -> Hold | None:
        """What was held, and by which field of the material."""
        return self.question.hold

    @property
    def load(self) -> Load | None:
        """The amplitudes that count, with their weights; None for gross slip."""
        return self.question.load

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """The lowest and the highest value of each variable, by name, in SI units."""
        return {name: (number(lowest), number(highest)) for name, (lowest, highest) in self.question.bounds.items()}

    @property
    def windows(self) -> list[tuple[float, float, float]]:
        """The depths in m at which the modulus is bounded or limited, each with the lowest and the highest modulus."""
        question, limit = self.question, self.question.window
        found = [] if limit is None else list(zip(limit.at, limit.lower, limit.upper, strict=True))
        if question.depths is not None:  # JAX sorts dicts by their keys
            moduli = (question.bounds[name] for name in (SHALLOW, DEEP))
            found += [(depth, *ends) for depth, ends in zip(question.depths, moduli, strict=True)]
        return [(number(depth), number(lowest), number(highest)) for depth, lowest, highest in found]

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
    contact: FrettingContact | GrossSlipContact,
    load: LoadGiven,
    vary: Mapping[str, Bounds | ModulusWindow],
    *,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: LimitsGiven | None = None,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | WearLaw | None = None,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    scenarios: Scenarios | FrettingContact | GrossSlipContact | None = None,
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
            "material.modulus[0]" of a `Layered`, "material.modulus[2]" of a `DepthGraded`; or instead of k, z0 and E0
            "modulus", a `ModulusWindow`, whose two moduli are then the variables. All but k, nu and exponents are
            searched on a logarithmic scale.
        weight: Probabilities of the amplitudes, shape (n,), >= 0; by default all equal.
        level: 0 takes the mean over the amplitudes, 1 the worst case; between them the CVaR at that level, the mean
            over the worst 1 - level. With scenarios over all pairs of a scenario and an amplitude.
        hold: "contact_radius_by_E0" or "contact_radius_by_z0" keeps the initial contact radius of the reference by
            adjusting E0 or z0. Then neither of them can vary, as a contact depends on them only through E0/z0^k.
        minimise: Any quantity of the contact that is a positive number, by its name in the catalogue: "wear_volume"
            (the default), "worn_radius", "deepest_wear", ...; for gross slip "volume_change" (the default),
            "force_drop", ... With its place if it needs one: {"edge_pressure": {"distance": 1e-6}}.
        limits: The limits of the design, as `Limits` or for any quantity as a mapping from its name to "above" and
            "below" or "between", with its place if it needs one: {"deepest_wear": {"below": 2e-6},
            "edge_pressure": {"below": 5e8, "distance": 1e-6}, "wear_depth": {"below": 1e-6, "r": 5e-5}}. They are
            limits of the steady state at the largest amplitude that counts, or with names such as
            "transient.wear_depth" after the cycles.
        cycles: After how many cycles the wear counts, positive: the wear_volume, the wear_depth at a radius or the
            worn_radius; by default that of the steady state counts.
        wear_coefficient: Archard's coefficient in 1/Pa, positive, or a law of `wear_laws`, which `cycles` needs.
        control: Which amplitude is held in these cycles. For "displacement" every contact is moved by the displacement
            that the force amplitude causes before any wear of the reference, and may slip as a whole; a `Displacement`
            as the load says it in m.
        rig_stiffness: Rig stiffness in N/m, if this is the displacement at its actuator.
        scenarios: What the contact may turn out to be: `Scenarios`, or a contact whose numbers have a leading axis, all
            with equal probabilities. The limits are kept in every scenario. The reference is `contact`.

    Returns:
        The best contact, compared with the reference.

    Raises:
        ValueError: An argument is outside its range, or the variables are missing, unknown or redundant.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.design(contact, 3.2, {"k": (-0.5, 0.5)}, hold="contact_radius_by_E0")
        >>> print(best.variables["k"], best.at_bound["k"])
        0.5 upper

    References:
        The mean of the worst part: Rockafellar and Uryasev, Journal of Risk 2 (2000) 21. The search:
        `docs/how-to/designs.md`.
    """
    question = question_of(
        contact,
        load,
        vary,
        weight,
        level,
        hold,
        minimise,
        limits,
        cycles,
        wear_coefficient,
        control,
        rig_stiffness,
        scenarios,
    )
    return answered(question)


def answered(question: Question) -> Design:
    """The design that answers a question."""
    known: Known = {}
    found = search(question, known=known) if question.cases is None else search_over_cases(question, known)
    reference = reference_variables(question)
    both = {name: np.stack([found.variables[name], reference[name]]) for name in question.bounds}
    at = evaluate(question, both, known)
    value, reference_value = np.exp(at.values[:, 0] + at.log_unit)
    material = jax.tree.map(lambda field: field[0] if field[0].ndim else float(field[0]), at.materials)
    contact = dataclasses.replace(question.contact, material=material)
    for name in question.bounds:
        if name not in HALF_SPACE and not name.startswith("material."):
            contact = with_leaf(contact, name, float(found.variables[name]))
    return Design(
        contact=contact,
        value=valued(value, question, contact),
        reference_value=reference_value,
        limits=_states(question, at.values[0], found.multipliers),
        minimum=found,
        question=question,
    )


def _states(question: Question, values: np.ndarray, multipliers: Any) -> dict[str, LimitState]:
    """The values for the limits at a choice of the variables, from the result of `evaluate`."""
    found = {}
    for (name, allowed), over, by in zip(limits_by_name(question.limits).items(), values[1:], multipliers, strict=True):
        _, lowest = limited(name)
        value = float(np.asarray(allowed)) * np.exp(-over if lowest else over)
        found[name] = LimitState(value, allowed, by, lowest)
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
    return Course(np.exp(at.values[:, 0] + at.log_unit), keeps(at.values[:, 1:]))


_STEPS, _ROUNDS = 41, 3  # values of the other variable in each round, and rounds between the neighbours of the best


def best_along(found: Design, name: str, values: ArrayLike) -> tuple[Course, bool]:
    """The objective as one variable of a design changes, and whether another one is chosen again at each of its values.

    Where the limits cannot be kept, the value is the one that breaks them least. With more than two variables, where no
    design keeps the limits, and for a life, which takes long to follow, the others stay, as by `along`.
    """
    others = [other for other in found.bounds if other != name]
    life, known = found.question.life, {}
    if len(others) != 1 or not found.keeps_limits or (life is not None and not read_from_runs(found.question)):
        return along(found, name, values), False
    (other,), values = others, np.asarray(values)
    if is_linear(other):
        forward = inverse = np.asarray
    else:
        forward, inverse = np.log, np.exp
    first, last = (float(forward(end)) for end in found.bounds[other])
    lower, upper = np.full(values.shape, first), np.full(values.shape, last)
    rows = np.arange(values.size)
    course: tuple[Any, Any] = values, rows
    for _ in range(_ROUNDS):
        u = np.linspace(lower, upper, _STEPS, axis=-1)
        # the optimum is one of the choices at its own value
        u[np.isclose(values, float(found.variables[name]), rtol=1e-12), 0] = forward(float(found.variables[other]))
        points = {name: np.repeat(values, _STEPS), other: inverse(u).ravel()}
        at = evaluate(found.question, points, known)
        value = np.exp(at.values[:, 0] + at.log_unit).reshape(u.shape)
        kept = keeps(at.values[:, 1:]).reshape(u.shape)
        excess = np.max(at.values[:, 1:], axis=-1, initial=-1.0).reshape(u.shape)
        best = np.where(kept.any(axis=1), np.argmin(np.where(kept, value, np.inf), axis=1), np.argmin(excess, axis=1))
        step = (upper - lower) / (_STEPS - 1)
        course = value[rows, best], kept[rows, best]
        chosen = u[rows, best]
        lower, upper = np.maximum(chosen - step, first), np.minimum(chosen + step, last)
    return Course(*course), True


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
    life = None if load.life is None else load.life.with_amplitudes(lambda x: factor * np.asarray(x))
    load = dataclasses.replace(load, tangential_force=factor * np.asarray(load.tangential_force), life=life)
    cases = found.question.cases
    if cases is not None and cases.tangential_force is not None:
        cases = dataclasses.replace(cases, tangential_force=factor * np.asarray(cases.tangential_force))
    question = dataclasses.replace(found.question, load=load, cases=cases)
    phi = np.asarray(question.phi)  # NaN where a displacement is held
    check("factor * tangential_force/(friction * normal_force)", phi[~np.isnan(phi)], PARTIAL_SLIP)
    best = answered(question)
    at = evaluate(question, found.variables)
    value = float(np.exp(at.values[0, 0] + at.log_unit))
    states = _states(question, at.values[0], np.zeros(at.values.shape[1] - 1))
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
    if question.cases is not None:
        raise ValueError("for_ever takes a design for one contact; each scenario has a steady state of its own")
    if question.objective not in BY_THEN:
        raise ValueError(f"for_ever takes a design by {one_of(tuple(BY_THEN))}, not by {question.objective}")
    if load is None or load.life is None:
        raise ValueError("for_ever takes a design for a number of cycles; this one is for the steady state")
    if load.life.control != "force":
        raise ValueError("for_ever takes a design under force control; under displacement control wear ends elsewhere")
    best = answered(dataclasses.replace(question, load=dataclasses.replace(load, life=None)))
    counting = np.asarray(load.weight) > 0.0
    force, weight = (np.asarray(x)[counting] for x in (load.tangential_force, load.weight))
    life, name, places = load.life, question.objective, question.places

    def over_lives(contact: Any) -> np.ndarray:
        return weight @ np.asarray(life.read(contact, force[:, None], name, places, _LIVES))

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
    lines += textwrap.wrap(f"material: {told}{f'; {found.hold}' if found.hold else ''}", _WIDTH - 2, **_INDENTED)
    if found.load is not None:
        counting = int(np.count_nonzero(np.asarray(found.load.weight)))
        largest = np.max(np.asarray(found.load.tangential_force))
        told = f"{f'{counting} amplitudes, at most ' if counting > 1 else ''}{largest:.4g} N"
        life = found.load.life
        lines.append(f"load: {told if life is None or np.isfinite(largest) else life.load}")
    if found.question.cases is not None:
        lines.append(f"scenarios: {np.size(found.question.cases.weight)}, limits for the worst of them")
    if found.limits:
        limits = []
        for name, state in found.limits.items():
            what, lowest = limited(name)
            value, allowed = (measured(what, number) for number in (state.value, state.allowed))
            limits.append(f"{what} {value} {'>=' if lowest else '<='} {allowed}{'' if state.kept else ' BROKEN'}")
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
