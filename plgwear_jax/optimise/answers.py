"""The answers to the question of a design, with what Python prints, and what else is asked about them."""

import contextlib
import dataclasses
import functools
import math
import textwrap
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple, Unpack

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.tree_util import tree_flatten_with_path

from plgwear_jax._core import doubts
from plgwear_jax._core.domains import POSITIVE, ArrayLike, Numbers, check, check_real
from plgwear_jax._core.leaves import with_leaf
from plgwear_jax._core.numbers import concrete_only, refuse_traced
from plgwear_jax._core.record import record, static
from plgwear_jax._core.units import written
from plgwear_jax._core.words import shown
from plgwear_jax._startup.programs import program, traced
from plgwear_jax.catalogue import entry, read
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.loads import PARTIAL_SLIP, Force
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.optimise.evaluation import (
    FAR_OFF,
    Candidate,
    Evaluation,
    Evaluator,
    Known,
    Rows,
    Shared,
    concrete,
    evaluate,
    plan_for,
    reference_variables,
    search,
    search_over_scenarios,
    shared_of,
    space,
    tells_states,
    valued,
)
from plgwear_jax.optimise.exponent import BATCH, in_chunks
from plgwear_jax.optimise.question import (
    Bounds,
    Keywords,
    Limit,
    LoadGiven,
    Objective,
    Question,
    checked_kind_of,
    is_held,
    keeps,
    limits_of,
    objective_of,
    parts_of,
    question_of,
    read_from_runs,
    solved_one_by_one,
    unless_refused,
)
from plgwear_jax.optimise.scenarios import WEIGHT, WeightedLoad, falling, own_axes, weighted_load
from plgwear_jax.optimise.search import Minimum, conditions, inclination, minimise, solved_by_elimination
from plgwear_jax.rules import BY_THEN, LARGER, free_complaint, is_linear, one_of
from plgwear_jax.special.xla import materialised
from plgwear_jax.steady.arguments import amplitude_of

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
        return {name: (as_float(lowest), as_float(highest)) for name, (lowest, highest) in self.question.bounds.items()}

    @property
    def windows(self) -> list[tuple[float, float, float]]:
        """The depths in m at which the modulus is limited, each with its lowest and highest value; NaN for none."""
        found: dict[float, list[float]] = {}
        for one in self.question.limits:
            if one.quantity == "modulus_at":
                found.setdefault(as_float(one.places["z"]), [math.nan, math.nan])[not one.lowest] = as_float(one.value)
        return [(depth, lowest, highest) for depth, (lowest, highest) in sorted(found.items())]

    @property
    def variables(self) -> dict[str, float]:
        """The values of what was varied, by name."""
        return {name: as_float(value) for name, value in self.minimum.variables.items()}

    @property
    def reference_variables(self) -> dict[str, float]:
        """The values of the reference for what was varied, by name."""
        return {name: as_float(value) for name, value in reference_variables(self.question).items()}

    @property
    def saving(self) -> float:
        """The share by which the objective is less than that of the reference."""
        return as_float(1.0 - self.value / self.reference_value)

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
    def scan_found_nothing_better(self) -> bool:
        """For one variable: nothing better is expected between the points of the scan; no proof, see `Minimum`."""
        return bool(self.minimum.scan_found_nothing_better)

    @property
    def rival(self) -> dict[str, float] | None:
        """The next best minimum, or None."""
        if not math.isfinite(self.minimum.rival_value):
            return None
        return {name: as_float(value) for name, value in self.minimum.rival.items()}

    @property
    def rival_value(self) -> float:
        """The objective of the rival, in SI units; infinite if there is none."""
        return as_float(self.value * np.exp(self.minimum.rival_value - self.minimum.value))

    def __repr__(self) -> str:
        try:
            return _in_words(self)
        except (TypeError, ValueError, jax.errors.JAXTypeError):  # traced, or many of them
            return f"Design(of {', '.join(self.question.bounds)}, {self.objective}={self.value!r})"


def as_float(value: Any) -> Any:
    """A concrete number as a float; what is traced, or an array of several, as it is."""
    return value if isinstance(value, Tracer) or np.ndim(value) else float(np.asarray(value))


@concrete_only("optimise.designs works there for contacts with closed forms")
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
        >>> best = optimise.design(contact, 3.2, {"k": (-0.5, 0.5)}, hold="contact_radius")
        >>> print(best.variables["k"], best.at_bound["k"])
        0.5 upper

    References:
        The mean of the worst part: Rockafellar and Uryasev, Journal of Risk 2 (2000) 21. The search:
        `docs/how-to/designs.md`.
    """
    return answered(question_of(contact, load, vary, **keywords))


def answered(question: Question, known: Known | None = None) -> Design:
    """The design that answers a question; what is evaluated on the way is put to what is known."""
    known = {} if known is None else known
    found = search(question, known=known) if question.scenarios is None else search_over_scenarios(question, known)
    evaluator = Evaluator(question, known)
    at = evaluator.evaluate(found.variables)
    contact = evaluator.contact(question.contact, found.variables)
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
class ObjectiveCurve:
    """The objective as one variable of a design changes and the others stay.

    Attributes:
        value: The objective in SI units, shape (n,).
        keeps_limits: Whether all limits are kept, shape (n,).
    """

    value: Array
    keeps_limits: Array


@concrete_only("optimise.designs works there for contacts with closed forms")
def along(found: Design, name: str, values: ArrayLike) -> ObjectiveCurve:
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
    return ObjectiveCurve(at.objective, keeps(at.values[:, 1:]))


# --- another load -----------------------------------------------------------------------------------------------------


@record
class UnderOtherLoad:
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


@concrete_only("optimise.designs works there for contacts with closed forms")
def under_other_load(found: Design, factor: float = 1.1) -> UnderOtherLoad:
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
    known: Known = {}
    best = answered(question, known)
    at = evaluate(question, found.variables, known)
    value = float(at.objective[0])
    states = _states(question, at, np.zeros(len(question.limits)))
    return UnderOtherLoad(factor, value, best, value / float(best.value) - 1.0, states)


# --- the steady state after a life ------------------------------------------------------------------------------------


class InSteadyState(NamedTuple):
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


@concrete_only("optimise.designs works there for contacts with closed forms")
def in_steady_state(found: Design) -> InSteadyState:
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
        raise ValueError("in_steady_state takes a design for one contact; each scenario has a steady state of its own")
    if question.objective not in BY_THEN:
        raise ValueError(f"in_steady_state takes a design by {one_of(tuple(BY_THEN))}, not by {question.objective}")
    if load is None or question.horizon is None:
        raise ValueError("in_steady_state takes a design for a number of cycles; this one is for the steady state")
    if not question.by_force:
        raise ValueError(
            "in_steady_state takes a design under force control; under displacement control wear ends elsewhere"
        )
    best = answered(dataclasses.replace(question, horizon=None))
    force, weight = np.asarray(load.amplitudes), np.asarray(load.weight)
    horizon, name, places = question.horizon, question.objective, question.places

    def over_lives(contact: Any) -> np.ndarray:
        given = {**places, "cycles": np.asarray(horizon.cycles) * _LIVES, "wear_coefficient": horizon.law}
        return weight @ np.asarray(read(contact, BY_THEN[name], force[:, None], given))

    def for_good(contact: Any) -> float:
        return float(weight @ np.broadcast_to(read(contact, name, force, places), force.shape))

    ours, theirs = map(over_lives, (found.contact, best.contact))
    flips_at = overtaken_at(_LIVES[1:], ours[1:] / theirs[1:] - 1.0)
    return InSteadyState(best, for_good(found.contact), for_good(question.contact), float(theirs[0]), flips_at)


def overtaken_at(lives: np.ndarray, more: np.ndarray) -> float | None:
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
        lines.append(placed_between(name, name, value, found.bounds[name], found.at_bound[name]))
    material = found.contact.material
    numbers = [name for name in ("E0", "z0", "k", "thickness", "modulus") if name in vars(material)]
    told = ", ".join(_row_of(name, getattr(material, name)) for name in numbers)
    told = "E(z) at depths" if "depth" in vars(material) else told
    lines += textwrap.wrap(f"material: {told}{f'; {found.hold} held' if found.hold else ''}", _WIDTH - 2, **_INDENTED)
    if found.load is not None:
        counting, amplitudes = int(np.count_nonzero(np.asarray(found.load.weight))), found.load.amplitudes
        told = f"{counting} amplitudes, at most " if counting > 1 else ""
        lines.append(f"load: {told}{f'{np.max(amplitudes):.4g} N' if found.question.by_force else found.load.load}")
    if found.question.scenarios is not None:
        lines.append(f"scenarios: {np.size(found.question.scenarios.weight)}, limits for the worst of them")
    if isinstance(found.contact, FrettingContact) and found.load is not None and found.question.by_force:
        with contextlib.suppress(ValueError):  # of a design put together by hand, whose contacts cannot be compared
            lines += textwrap.wrap(doubtful(found, compared(found)) or "", _WIDTH - 2)
    if found.limits:
        limits = []
        for state in found.limits.values():
            value, allowed = (measured(state.quantity, number) for number in (state.value, state.allowed))
            side = ">=" if state.lowest else "<="
            limits.append(f"{state.quantity} {value} {side} {allowed}{'' if state.kept else ' BROKEN'}")
        lines += textwrap.wrap(f"limits: {', '.join(limits)}", _WIDTH - 2, **_INDENTED)
    lines.append(certainty(found, ("converged", "certified", "scan_found_nothing_better")))
    return "\n  ".join(["Design:", *lines])


def _row_of(name: str, values: Any) -> str:
    """A number of a material, or a row of them."""
    told = ", ".join(measured(f"material.{name}", value) for value in np.ravel(values))
    return f"{name} = [{told}]" if np.ndim(values) else f"{name} = {told}"


def headline(found: Any) -> str:
    """The objective of a design, and what it saves."""
    share = 100.0 * found.saving
    much = f"{abs(share):.3g} % {'less' if share >= 0.0 else 'more'} than the reference"
    return f"{found.objective} = {measured(found.objective, found.value)}, {much}"


def placed_between(called: str, name: str, value: Any, bounds: tuple[Any, Any], side: str | None) -> str:
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


# --- beside the reference ---------------------------------------------------------------------------------------------
# A design compared with its reference: all numbers for tables and pictures of both, from one program.


_SAMPLES = 201
_FOR_A_PICTURE = 5  # digits


@record
class Comparison:
    """The quantities of the best contact of a design and of its reference, in SI units, at the largest amplitude.

    The first entry of every array is of the best contact, the second of the reference.

    Attributes:
        quantities: By name, each of shape (2,): "contact_radius", "stick_radius", "worn_radius", "wear_volume",
            "edge_pressure", "modulus_at_radius" and the objective, which is over the whole load. For gross slip
            "volume_change", "force_drop" and "modulus_at_radius"; for a displacement or blocks "contact_radius".
        distance: At which the edge pressure is taken, in m inside the stick-slip boundary; NaN where there is none.
        radii: Places in the worn ring, or on the face of the punch, shape (2, n); from the axis on after a displacement
            or blocks.
        depth: The wear depth there, shape (2, n), to some 5 digits.
        depths: Depths in the half-space at which the pictures show the modulus, shape (m,): two of a power law.
        modulus: Young's modulus there, shape (2, m).
    """

    quantities: dict[str, Array]
    distance: ArrayLike
    radii: Array
    depth: Array
    depths: Array
    modulus: Array


@concrete_only("optimise.designs works there for contacts with closed forms")
def compared(found: Design) -> Comparison:
    """Compare the best contact of a design with its reference.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The edge pressure is taken at the distance in the limits of the design, or else at a hundredth of the contact radius
    of the reference.

    Args:
        found: The result of `design`.

    Returns:
        The quantities and the wear profiles of both.
    """
    question, load = found.question, found.load
    pair = jax.tree.map(lambda *both: np.stack(both), concrete(found.contact), concrete(question.contact))
    depths = _depths_shown(question)
    if load is None:
        both = _punches(pair, depths)
    elif not question.by_force:
        both = _worn_by_then(pair, question, depths)
    else:
        force, distance = concrete(load.amplitudes)[0], concrete(question.distance)
        if not is_closed(question.contact):
            if tells_states(question):
                known = {name: np.array([found.variables[name], x]) for name, x in found.reference_variables.items()}
                evaluator = Evaluator(question)
                states = evaluator.told(evaluator.points(known)).state
            else:
                from plgwear_jax.steady import state  # which closed forms do without
                from plgwear_jax.surfaces.effort import effort_of

                states = state.states_of(pair, force, effort_of(None))
            both = _numeric_rings(pair, states, distance, depths)
        else:
            others = () if question.objective == "wear_volume" else ("wear_volume",)  # what is minimised is known
            both = _closed_rings(others, pair, force, distance, depths)
    both = jax.device_get(both)
    objective = {found.objective: np.array([found.value, found.reference_value])}
    return dataclasses.replace(both, quantities=both.quantities | objective)


def doubtful(found: Design, comparison: Comparison) -> str | None:
    """Why nobody could make or measure the best contact, if so, from what `compared` gives."""
    punch = isinstance(found.contact, GrossSlipContact)
    radius = as_float(found.contact.radius if punch else comparison.quantities["contact_radius"][0])
    return doubts.of_design(comparison.depths, comparison.modulus[0], radius, as_float(np.max(comparison.depth[0])))


def _depths_shown(question: Question) -> np.ndarray:
    """The range of the depths that have to be shown besides the contact radius, with some margin."""
    marked = np.array([one.places["z"] for one in question.limits if one.quantity == "modulus_at"], float)
    return np.array([0.5 * marked.min(), 2.0 * marked.max()] if marked.size else [np.inf, 0.0])


@program(static=1)
def _closed_rings(
    others: tuple[str, ...], pair: Any, force: ArrayLike, distance: ArrayLike | None, shown: ArrayLike
) -> Comparison:
    column = _in_columns(pair)  # a FrettingContact of two
    steady = column.steady(force)
    names = "contact_radius", "stick_radius", "worn_radius", *others
    # Materialised, since many results use them.
    quantities = {name: materialised(getattr(steady, name), column.radius) for name in names}
    radius, inner, outer = (quantities[name] for name in names[:3])
    inside = 0.01 * radius[1, 0] if distance is None else jnp.asarray(distance)
    quantities["edge_pressure"] = steady.edge_pressure(inside)
    radii = inner + (outer - inner) * jnp.linspace(0.0, 1.0, _SAMPLES)
    # A picture does with fewer digits.
    steady = column.steady(force, digits=_FOR_A_PICTURE).with_contact_radius(radius)
    quantities = {name: value[:, 0] for name, value in quantities.items()}
    return _with_moduli(pair, quantities, radius, inside, radii, steady.wear_depth(radii), shown)


def _in_columns(pair: Any) -> Any:
    """Two contacts, along the first of two axes."""
    return jax.tree.map(lambda field: field[:, None], pair)


@program(level=1)
def _numeric_rings(pair: Any, states: Any, distance: ArrayLike | None, shown: Array) -> Comparison:
    from plgwear_jax.steady import numeric  # which closed forms do without
    from plgwear_jax.surfaces.effort import effort_of

    names = "wear_volume", "contact_radius", "stick_radius", "worn_radius"
    quantities = {name: getattr(states.results, name) for name in names}
    inside = 0.01 * quantities["contact_radius"][1] if distance is None else jnp.asarray(distance)

    def ring(state: Any) -> tuple[Array, Array, Array]:
        inner, outer = state.results.stick_radius, state.results.worn_radius
        radii, effort = inner + (outer - inner) * jnp.linspace(0.0, 1.0, _SAMPLES), effort_of(None)
        pressure = numeric.edge_pressure_of(effort, state, inside[None])[0]
        return pressure, radii, numeric.worn_depth_at(effort, state, radii)

    quantities["edge_pressure"], radii, depth = jax.lax.map(ring, states)
    return _with_moduli(pair, quantities, quantities["contact_radius"][:, None], inside, radii, depth, shown)


def _worn_by_then(pair: Any, question: Question, shown: np.ndarray) -> Comparison:
    """Under a load without a steady state: what is worn after the life."""
    horizon, load = question.horizon, question.load
    assert horizon is not None and load is not None
    one = load.load if load.amplitudes is None else load.with_amplitudes(load.amplitudes[0], None).load
    column = _in_columns(pair)
    run = column.over_cycles(one, horizon.law)
    radii = run.contact_radius(horizon.cycles) * np.linspace(0.0, 1.0, _SAMPLES)
    radius = column.steady(0.0).contact_radius
    depth = run.depth(radii, horizon.cycles)
    return _with_moduli(pair, {"contact_radius": radius[:, 0]}, radius, jnp.nan, radii, depth, shown)


@program()
def _punches(pair: Any, shown: Array) -> Comparison:  # a GrossSlipContact of two
    column = _in_columns(pair)
    steady = column.steady()
    quantities = {name: getattr(steady, name)[:, 0] for name in ("volume_change", "force_drop")}
    radii = column.radius * jnp.sin(jnp.linspace(0.0, 0.5 * jnp.pi, _SAMPLES))
    depth = column.depth - column.steady(digits=_FOR_A_PICTURE).steady_displacement(radii)
    return _with_moduli(pair, quantities, column.radius, jnp.nan, radii, depth, shown)


def _with_moduli(
    pair: Any, quantities: dict[str, Any], edge: Any, distance: Any, radii: Any, depth: Any, shown: Any
) -> Comparison:
    power, last = isinstance(pair.material, PowerLawGraded), edge[1, 0]
    ends = jnp.minimum(0.01 * last, shown[0]), jnp.maximum(10.0 * last, shown[1])
    depths = jnp.geomspace(*ends, 2 if power else _SAMPLES)
    at = jnp.concatenate([edge, jnp.broadcast_to(depths, (2, depths.size))], axis=1)
    modulus = jnp.stack([jax.tree.map(lambda x, i=i: x[i], pair.material).modulus_at(at[i]) for i in range(2)])
    quantities["modulus_at_radius"] = modulus[:, 0]
    return Comparison(quantities, distance, radii, depth, depths, modulus[:, 1:])


# --- trade-offs, and limits that cannot be kept together --------------------------------------------------------------
# What limits cost: the trade-off between two quantities, such as wear and edge pressure, and limits in conflict.


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
        return self._ended_by(0) or self.best[0], self._ended_by(-1) or self.best[1]

    def _ended_by(self, end: int) -> str:
        said = [
            f"{name} at its {'upper' if side[end] > 0 else 'lower'} bound"
            for name, side in self.at_bound.items()
            if side[end]
        ]
        for name in (name for name, active in self.active.items() if active[end]):
            name = name.removeprefix("transient.")
            stem, _, which = name.rpartition("_") if name.endswith(("_lowest", "_highest")) else (name, "", "highest")
            said.append(f"{which} {stem.replace('_', ' ')} allowed")
        return ", ".join(said)


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
        True least penetration

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
    if points < 2:
        raise ValueError(f"points = {points}: at least 2")
    # All searches have x among their limits, so that they share a program; for the ends it has no effect. The limit of
    # the question stays 1 in SI units: what is known of its points serves all values of x.
    keywords["limits"] = {**(limits or {}), name: {"above" if "x" in larger else "below": 1.0, **places}}
    keywords["minimise"] = keywords.get("minimise") if y is None else y
    question = question_of(contact, load, vary, **keywords)
    row = next(i for i, one in enumerate(question.limits) if one.quantity == name)
    others = [other for other in range(len(question.limits)) if other != row]
    known: dict[Any, Any] = {}

    def best(x_weight: float, y_weight: float, most: float | None = None) -> Minimum:
        """The least mean of x and y, of those within a limit of log(x) if there is one."""

        def asked(values: np.ndarray, slopes: np.ndarray) -> Rows:
            for part in (values, slopes):
                part[:, 0] *= -1.0 if "y" in larger else 1.0
                part[:, 0] = x_weight * part[:, 1 + row] + y_weight * part[:, 0]
            if most is None:
                return _instead(None, others, values, slopes)
            values[:, 1 + row] -= most
            return values, slopes

        return search(question, asked, known)

    of_x, of_y = best(1.0, _TIE), best(_TIE, 1.0)
    ends = evaluate(question, _joined([of_x, of_y]).variables, known)
    first, last = ends.values[:, 1 + row]
    allowed = np.linspace(first, last, points)  # log(x), negative where larger is better
    # The ends of the front are known; a search there would have a single point to choose from.
    inner = [best(0.0, 1.0, one) for one in allowed[1:-1]]
    designs = _joined([of_x, *inner, of_y])
    variables, reference = designs.variables, reference_variables(question)
    at = evaluate(question, {one: np.append(variables[one], reference[one]) for one in variables}, known)
    value, side = at.objective, -1.0 if "x" in larger else 1.0
    return Front(
        x=np.exp(side * allowed),
        y=value[:-1],
        variables=variables,
        at_bound=designs.side,
        active={question.limits[i].name: designs.multipliers[:, i] > ACTIVE for i in others},
        converged=designs.converged,
        certified=designs.certified,
        reference_x=np.exp(side * at.values[-1, 1 + row]),
        reference_y=value[-1],
        x_places=places,
        y_places=question.places,
        x_name=name,
        y_name=question.objective,
        larger=larger,
    )


_TIE = 1e-6  # weight of the other quantity at the ends of a front, which chooses among designs with the best one


def _joined(designs: list[Minimum]) -> Minimum:
    return jax.tree.map(lambda *leaves: np.stack(leaves), *designs)


def _instead(goal: int | None, kept: Sequence[int], values: np.ndarray, slopes: np.ndarray) -> Rows:
    """log(value/limit) of one limit in place of the objective, if one is named, and only some of the limits."""
    if goal is not None:
        values[:, 0], slopes[:, 0] = values[:, 1 + goal], slopes[:, 1 + goal]
    left_out = [1 + row for row in range(values.shape[1] - 1) if row not in kept]
    values[:, left_out], slopes[:, left_out] = FAR_OFF, 0.0
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


@concrete_only("optimise.designs works there for contacts with closed forms")
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
    limits = {one.name: one for one in found.question.limits}
    if found.keeps_limits or not limits or found.question.scenarios is not None:
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
    allowed = {name: float(np.asarray(limits[name].value)) for name in guilty}
    reachable = {}
    for name in guilty:
        excess = float(nearest(name, [other for other in guilty if other != name]).value)
        reachable[name] = allowed[name] * float(np.exp(-excess if limits[name].lowest else excess))
    return Conflict(allowed, reachable)


# --- sensitivities ----------------------------------------------------------------------------------------------------
# How a design changes with its inputs.


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


# --- a free modulus ---------------------------------------------------------------------------------------------------
# The best E(z) that no formula prescribes: its values at some depths are the variables.
#
# It is the question of a design in which all entries of `material.modulus` vary. SciPy's SLSQP descends from many
# starts, since there are several minima: an optimum mostly lies on bounds, and what there is to choose is the order
# and the thickness of stiff and compliant depths.


_COARSE, _FINE = 1e-4, 1e-6  # the least change of the logarithm, of all descents and of the best of them
_ONE_MINIMUM = 3e-3  # ends of descents whose logarithms differ by less are one
_REFINED = 2  # minima
_KEPT = 1e-5  # of log(value/limit)
_FLAT = 3e-3  # of the slope that still leads downhill, relative to the change of log(wear) over the box
_EXPONENTS = (-0.4, 0.4)  # from which the best power law is looked for


@record
class ModulusProfile:
    """The lowest and the highest modulus with which a coating can be made, at three depths or more.

    It takes numbers, not traced values.

    Attributes:
        at: The depths in m, shape (n,), increasing, 3 <= n <= 8, the first one 0 or above.
        lower: The lowest modulus in Pa at each of them, shape (n,), positive.
        upper: The highest modulus in Pa, shape (n,), above the lowest.
        steepness: Between neighbouring depths abs(log(E2/E1)/log(z2/z1)) is at most this, which for a power law is
            abs(k); None for no limit.
    """

    at: Numbers
    lower: Numbers
    upper: Numbers
    steepness: float | None = None

    def __post_init__(self) -> None:
        given = self.at, self.lower, self.upper
        refuse_traced("ModulusProfile", given, "a DepthGraded may have traced moduli")
        for name in ("at", "lower", "upper"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), float))
        at, lower, upper = (np.asarray(x) for x in (self.at, self.lower, self.upper))
        if at.ndim != 1 or not at.shape == lower.shape == upper.shape or not 3 <= at.size <= 8:
            raise ValueError(f"at, lower and upper of shapes {at.shape}, {lower.shape}, {upper.shape}: 3 to 8 depths")
        from plgwear_jax.surfaces import DepthGraded  # which a power law under a rigid indenter does not need

        DepthGraded(at, lower, 0.0)  # which checks them
        if not np.all(np.diff(at) > 0.0):
            raise ValueError("at: the depths must increase")
        check("upper", upper, POSITIVE)
        if not np.all(lower < upper):
            i = int(np.argmin(lower < upper))
            raise ValueError(
                f"modulus at {at[i]:g} m: [{lower[i]:g}, {upper[i]:g}]: the lowest must be below the highest"
            )
        if self.steepness is not None:
            check("steepness", self.steepness, POSITIVE)
            if at[0] == 0.0:
                raise ValueError("steepness: is of logarithms of depths, and needs a first depth above 0")


class LocalMinimum(NamedTuple):
    """One of the minima that the search found.

    Attributes:
        value: The objective in SI units.
        modulus: The moduli in Pa, shape (n,).
        starts: How many starts ended here.
    """

    value: float
    modulus: np.ndarray
    starts: int


@dataclasses.dataclass(frozen=True, repr=False)
class FreeDesign:
    """The best E(z) within the bounds, the best power law within them, and the reference.

    Attributes:
        contact: The contact on the best half-space, a `DepthGraded`.
        power_law: The contact on the best power law, clipped to the bounds at the same depths.
        exponent: The exponent of this power law.
        reference: The contact as it was given.
        value: The objective of the best contact, in SI units.
        power_law_value: That of the power law; NaN if none keeps the limits.
        reference_value: That of the reference.
        contact_radii: Contact radii in m: of the best contact, of the power law, of the reference.
        question: What was asked, on a `DepthGraded`.
        profile: The bounds.
        minima: The minima that were found, the best one first.
        starts: How many descents were made.
        evaluations: How often the objective and its slopes were computed.
        converged: The best contact keeps the limits, and no slope leads downhill from it within them.
    """

    contact: FrettingContact
    power_law: FrettingContact
    exponent: float
    reference: FrettingContact
    value: float
    power_law_value: float
    reference_value: float
    contact_radii: tuple[float, float, float]
    question: Question
    profile: ModulusProfile
    minima: tuple[LocalMinimum, ...]
    starts: int
    evaluations: int
    converged: bool

    @property
    def objective(self) -> str:
        """What was minimised."""
        return self.question.objective

    @property
    def modulus(self) -> np.ndarray:
        """The best moduli in Pa at the depths of the profile, shape (n,)."""
        return self.minima[0].modulus

    @property
    def saving(self) -> float:
        """The share by which the objective is less than that of the reference."""
        return 1.0 - self.value / self.reference_value

    @property
    def freedom(self) -> float:
        """The share by which the objective is less than that of the best power law."""
        return 1.0 - self.value / self.power_law_value

    @property
    def at_bound(self) -> tuple[str | None, ...]:
        """For each depth the bound on which the modulus lies, "lower" or "upper", or None."""
        lower, upper = np.asarray(self.profile.lower), np.asarray(self.profile.upper)
        side = np.where(self.modulus <= lower * 1.0001, "lower", np.where(self.modulus >= upper / 1.0001, "upper", ""))
        return tuple(str(word) or None for word in side)

    @property
    def certified(self) -> bool:
        """Converged, and more than one start ended in the best minimum; a better one elsewhere cannot be excluded."""
        return self.converged and self.minima[0].starts > 1

    @property
    def doubt(self) -> str | None:
        """Why nobody could make or measure the best half-space, if so; None under loads without a steady state."""
        if self.question.load is None or not self.question.by_force:
            return None
        radius, deepest = self.contact_radii[0], self.contact.steady(self.question.load.amplitudes[0]).deepest_wear
        depths = radius * np.geomspace(*doubts.FELT, 16)
        return doubts.of_design(depths, np.asarray(self.contact.material.modulus_at(depths)), radius, float(deepest))

    def __repr__(self) -> str:
        """The objective, the moduli, the best power law, the contact radii, what is doubtful, and what is certain."""
        profile, lines = self.profile, [headline(self)]
        bounds = zip(profile.at, profile.lower, profile.upper, self.modulus, self.at_bound, strict=True)  # pyright: ignore
        for depth, low, high, modulus, side in bounds:
            lines.append(
                placed_between(f"modulus at {measured('depth', depth)}", "modulus", modulus, (low, high), side)
            )
        law = f"k = {self.exponent:.3g}, {self.objective} = {measured(self.objective, self.power_law_value)}"
        lines.append(f"best power law: {law if np.isfinite(self.power_law_value) else 'none keeps the limits'}")
        best, _, reference = (measured("contact_radius", radius) for radius in self.contact_radii)
        lines.append(f"contact_radius = {best}, that of the reference {reference}")
        lines.append(f"{self.minima[0].starts} of {self.starts} descents ended here, minima: {len(self.minima)}")
        lines += textwrap.wrap(self.doubt or "", _WIDTH - 2)
        return "\n  ".join(["FreeDesign:", *lines, certainty(self, ("converged", "certified"))])


class _FreeModuli:
    """The question for SLSQP: log(E) scaled to 0 at the lower and 1 at the upper bound; no point is solved twice.

    The last limit of the question is that of the contact radius by that of the reference, which holds it or not.
    """

    def __init__(self, question: Question, profile: ModulusProfile, held: bool):
        self.known: Known = {}
        self.evaluator, self.held = Evaluator(question, self.known, lanes=1), held
        self.depth, self.low = np.asarray(profile.at), np.log(profile.lower)
        self.width = np.log(profile.upper) - self.low
        # What the steepness wants to be >= 0: a constant and its slopes.
        self.room, self.by_room = np.zeros(0), np.zeros((0, self.low.size))
        if profile.steepness is not None:
            apart = np.diff(np.log(self.depth))
            first, step = np.diff(self.low) / apart, np.diff(np.diag(self.width), axis=0) / apart[:, None]
            self.room = np.concatenate([profile.steepness - first, profile.steepness + first])
            self.by_room = np.concatenate([-step, step])

    def moduli(self, x: np.ndarray) -> np.ndarray:
        """The moduli in Pa."""
        return np.exp(self.low + np.clip(x, 0.0, 1.0) * self.width)

    def contact_radius(self, x: np.ndarray) -> float:
        """The contact radius over that of the reference."""
        return float(np.exp(self.evaluator.rows(self.moduli(x)[None])[0][0, -1]))

    def rows(self, x: np.ndarray) -> Rows:
        """The logarithm of the objective, what has to be 0, what has to be >= 0, and their slopes."""
        (values,), (slopes,) = self.evaluator.rows(self.moduli(x)[None])
        rows, by = (
            np.concatenate([part[:1], part[-1:][: self.held], -part[1:-1], more])
            for part, more in ((values, self.room + self.by_room @ x), (slopes * self.width, self.by_room))
        )
        return rows, by

    def log_value(self, x: np.ndarray) -> float:
        """The logarithm of the objective; infinite where a limit is broken."""
        rows, _ = self.rows(x)
        broken = np.minimum(rows[1:], 0.0)
        broken[: self.held] = rows[1 : 1 + self.held]
        return float(rows[0]) if np.all(np.isfinite(rows)) and np.all(np.abs(broken) < _KEPT) else np.inf

    def value(self, x: np.ndarray) -> float:
        """The objective in SI units; NaN where a limit is broken."""
        least = self.log_value(x)
        return float(np.exp(least) * self.evaluator.shared.scale) if np.isfinite(least) else np.nan

    def descended(self, start: np.ndarray, change: float) -> np.ndarray:
        """Where a descent ends."""
        return _slsqp(start, self.rows, self.held, np.array([[0.0, 1.0]] * start.size), change)


@concrete_only("the methods of contacts on a DepthGraded work there")
def free_design(
    contact: FrettingContact,
    load: LoadGiven,
    modulus: ModulusProfile,
    *,
    starts: int = 20,
    **keywords: Unpack[Keywords],
) -> FreeDesign:
    """Find the E(z) on which the indenter wears least, by its values at some depths, with PCHIP between them.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact with its reference material and its indenter; its fields are numbers.
        load: As of `design`; the time grows with the number of amplitudes.
        modulus: The depths, and the bounds of the modulus there.
        starts: How many descents are made, at least 1: from the power law, and from random corners of the bounds.
        **keywords: As of `design`, without scenarios.

    Returns:
        The best contact, with the other minima that were found, and the best power law within the same bounds.

    Raises:
        ValueError: An argument is outside its range.
    """
    if not isinstance(contact, FrettingContact):
        raise TypeError(f"contact takes a FrettingContact, not {contact!r}")
    if starts < 1:
        raise ValueError(f"starts = {starts}: must be at least 1")
    if keywords.get("scenarios") is not None:
        raise ValueError("scenarios: a free gradient takes none")
    nu, hold = contact.material.nu, is_held(keywords.pop("hold", None))
    if isinstance(nu, str):
        raise ValueError('contact: nu = "holl" changes with k; a free gradient needs a number')
    from plgwear_jax.surfaces import DepthGraded

    def on(moduli: Any) -> FrettingContact:
        return dataclasses.replace(contact, material=DepthGraded(np.asarray(modulus.at), moduli, nu))

    # One structure, and so one program, whatever the reference is.
    ends = zip(np.asarray(modulus.lower), np.asarray(modulus.upper), strict=True)
    vary = {f"material.modulus[{i}]": (float(low), float(high)) for i, (low, high) in enumerate(ends)}
    question = question_of(on(modulus.lower), load, vary, **keywords)
    unless_refused(free_complaint((), hold, {one.quantity for one in question.limits}))
    reference_value = np.exp(Candidate(dataclasses.replace(question, contact=contact), {}).objective()).item()
    radius = float(np.asarray(contact.steady(0.0).contact_radius))
    last = Limit(radius, {}, "contact_radius", "contact_radius", False)
    problem = _FreeModuli(dataclasses.replace(question, limits=(*question.limits, last)), modulus, hold)

    power_law, exponent = _best_power_law(problem)
    random = np.random.default_rng(0)
    begun = [power_law] + [0.05 + 0.9 * random.integers(0, 2, problem.depth.size) for _ in range(starts - 1)]
    minima = _distinct(problem, [(problem.descended(x, _COARSE), 1) for x in begun])
    refined = [(problem.descended(x, _FINE), n) for x, n in minima[:_REFINED]]
    minima = _distinct(problem, refined + minima[_REFINED:])  # again: two of them may have ended in one
    x = minima[0][0]
    local = tuple(LocalMinimum(problem.value(x), problem.moduli(x), n) for x, n in minima)
    return FreeDesign(
        contact=on(local[0].modulus),
        power_law=on(problem.moduli(power_law)),
        exponent=exponent,
        reference=contact,
        value=local[0].value,
        power_law_value=problem.value(power_law),
        reference_value=reference_value,
        contact_radii=(radius * problem.contact_radius(x), radius * problem.contact_radius(power_law), radius),
        question=question,
        profile=modulus,
        minima=local,
        starts=starts,
        evaluations=sum(isinstance(key, tuple) for key in problem.known),
        converged=np.isfinite(problem.log_value(x)) and _downhill(problem, x) < _FLAT,
    )


def _slsqp(
    start: np.ndarray, rows: Callable[[np.ndarray], Rows], held: bool, bounds: np.ndarray, change: float = _FINE
) -> np.ndarray:
    """Where SLSQP ends."""
    from scipy import optimize

    kinds = ("eq", slice(1, 1 + held)), ("ineq", slice(1 + held, None))
    limits: Any = [
        {"type": kind, "fun": lambda x, part=part: rows(x)[0][part], "jac": lambda x, part=part: rows(x)[1][part]}
        for kind, part in kinds
        if rows(start)[0][part].size
    ]
    with warnings.catch_warnings():
        # Older SciPy steps beyond a bound by rounding, and says so.
        warnings.filterwarnings("ignore", "Values in x were outside bounds", RuntimeWarning)
        found = optimize.minimize(
            lambda x: tuple(part[0] for part in rows(x)),
            start,
            jac=True,
            method="SLSQP",
            bounds=bounds,
            constraints=limits,
            options={"maxiter": 80, "ftol": change},
        )
    return np.clip(found.x, *bounds.T)


def _distinct(problem: _FreeModuli, ends: list[tuple[np.ndarray, int]]) -> list[tuple[np.ndarray, int]]:
    """The minima at which so many descents ended, the best one first; those that break limits come last."""
    found: list[tuple[np.ndarray, int]] = []
    for x, number in sorted(ends, key=lambda end: problem.log_value(end[0])):
        if found and not problem.log_value(x) - problem.log_value(found[-1][0]) >= _ONE_MINIMUM:
            found[-1] = (found[-1][0], found[-1][1] + number)
        else:
            found.append((x, number))
    kept = [one for one in found if np.isfinite(problem.log_value(one[0]))]
    return kept or found


def _best_power_law(problem: _FreeModuli) -> tuple[np.ndarray, float]:
    """The best power law clipped to the bounds: where it lies between them, and its exponent."""
    low, width = problem.low, problem.width
    z = np.log(np.maximum(problem.depth, 1e-3 * problem.depth[1]))
    z = z - z.mean()
    middle, scale = (low + 0.5 * width).mean(), np.ptp(low) + width.max()

    def clipped(p: np.ndarray) -> Rows:
        """The moduli for the exponent and the modulus in the middle, between the bounds, and their slopes."""
        x = (middle + scale * p[1] + p[0] * z - low) / width
        inside = ((x > 0.0) & (x < 1.0)) / width
        return np.clip(x, 0.0, 1.0), np.stack([z * inside, scale * inside], axis=1)

    def rows(p: np.ndarray) -> Rows:
        x, slopes = clipped(p)
        values, by = problem.rows(x)
        return values, by @ slopes

    bounds = np.array([[-0.999, 0.999], [-1.0, 1.0]])
    ends = [_slsqp(np.array([k, 0.0]), rows, problem.held, bounds) for k in _EXPONENTS]
    best = min(ends, key=lambda p: problem.log_value(clipped(p)[0]))
    return clipped(best)[0], float(best[0])


def _downhill(problem: _FreeModuli, x: np.ndarray) -> float:
    """The largest change of log(objective) over the box that leads downhill within bounds and limits."""
    from scipy import optimize

    rows, by = problem.rows(x)
    # Multipliers of the bounds that are reached and of the limits that are active, all >= 0 but for a held radius.
    active = by[1:][np.abs(rows[1:]) < 10.0 * _KEPT]
    held = -by[1 : 1 + problem.held]
    edges = np.concatenate([np.eye(x.size)[x < 1e-6], -np.eye(x.size)[x > 1.0 - 1e-6], active, held])
    return float(optimize.nnls(edges.T, by[0])[1]) if edges.size else float(np.abs(by[0]).max())


# --- many designs -----------------------------------------------------------------------------------------------------
# The best gradients for many contacts in one call.


@record
class Designs:
    """The best gradients for many contacts; every array has the shape of the batch.

    Attributes:
        variables: The best values of what was varied, by name.
        value: The objective of the best contacts, in SI units.
        saving: The share by which it is less than that of the reference.
        converged: The search ended at a minimum.
        certified: Converged, within the limits, and nothing better was found; see `Design`.
        scan_found_nothing_better: Nothing better is expected between the points of the scan; no proof, see `Minimum`.
    """

    variables: dict[str, Array]
    value: Array
    saving: Array
    converged: Array
    certified: Array
    scan_found_nothing_better: Array


def designs(
    contact: FrettingContact | GrossSlipContact,
    load: LoadGiven,
    vary: Mapping[str, Bounds],
    **keywords: Unpack[Keywords],
) -> Designs:
    """Find the best material for each of many contacts or loads, in one compiled call.

    Works under `jit`. Designs of contacts with closed forms can be differentiated with respect to the contact and the
    load: those for the steady state, and those for the volume worn in a life if k, E0, z0 or the radius vary alone. All
    others are looked for one after the other, and have no derivatives: the search of one design needs the first
    derivatives already, and `sensitivities` takes differences of them.

    Args:
        contact: As for `design`; its fields may be arrays, whose shapes broadcast to that of the batch.
        load: As for `design`, one force amplitude per design, of a shape that broadcasts with the fields;
            or with `weight` several per design, along a last axis.
        vary: See `design`. Its bounds are numbers, not traced values.
        **keywords: See `Keywords`, without scenarios. The weights have a shape that broadcasts with that of the
            amplitudes, zero for padding; cycles, law and limits may be arrays, whose shapes broadcast to that of the
            batch.

    Returns:
        The designs. At an amplitude of 0, where nothing wears, all numbers are NaN.

    Raises:
        ValueError: See `design`. Under `jit` values outside their range give NaN.

    Examples:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.designs(contact, jnp.array([0.2, 3.2]), {"k": (-0.5, 0.5)}, hold="contact_radius")
        >>> print(best.variables["k"])
        [-0.5  0.5]

    References:
        As `design`.
    """
    if keywords.get("scenarios") is not None:
        raise ValueError("scenarios: designs takes none; ask design for each of them")
    question, given = parts_of(contact, load, vary, **keywords)
    level, weight = jnp.asarray(keywords.get("level", 0.0)), keywords.get("weight")
    if given is None:
        return _designs_in_a_batch(question, level)
    if weight is not None:
        check("weight", weight, WEIGHT)
    question = dataclasses.replace(question, load=WeightedLoad(given, weight))
    if solved_one_by_one(question) and not traced((question, level)):
        return _designs_in_turn(question, keywords.get("level", 0.0))
    if not question.by_force:
        alone = given.with_amplitude(lambda x: jnp.asarray(x)[..., None]) if given.lasts else given
        return _designs_in_a_batch(dataclasses.replace(question, load=WeightedLoad(alone, jnp.ones(1))), level)
    force = jnp.asarray(given.amplitude)
    check_real("load", force)
    force = force[..., None] if weight is None else force
    pressed = {name: jnp.asarray(getattr(contact, name))[..., None] for name in ("normal_force", "friction")}
    phi = amplitude_of(dataclasses.replace(question.contact, **pressed), force)
    force = force + 0.0 * phi  # NaN where traced numbers are outside their ranges
    weights = jnp.ones_like(phi) if weight is None else jnp.asarray(weight, phi.dtype)
    force, weights = jnp.broadcast_arrays(force, weights)
    return _designs_in_a_batch(dataclasses.replace(question, load=WeightedLoad(Force(force), weights)), level)


class _Batch:
    """The numbers of a batch of questions, each with the axes of the batch first."""

    def __init__(self, question: Question, own_last: bool, xp: Any) -> None:
        parts = question.contact, question.horizon, question.load
        leaves, self._rebuild = jax.tree.flatten(parts)
        own = own_axes(question.contact, len(leaves))
        if question.load is not None:  # amplitudes, and their weights if there are any, have an axis of their own
            weighted = question.load.weight is not None
            own[len(leaves) - len(jax.tree.leaves(question.load))] = int(own_last)
            own[-1] = max(own[-1], int(weighted))
        leaves = [xp.asarray(leaf, jnp.result_type(0.0, *leaves)) for leaf in leaves]
        self.shape = np.broadcast_shapes(*(x.shape[: x.ndim - n] for x, n in zip(leaves, own, strict=True)))
        self.numbers = [
            xp.broadcast_to(x, (*self.shape, *x.shape[x.ndim - n :])) for x, n in zip(leaves, own, strict=True)
        ]
        self._question = question

    def one(self, numbers: Sequence[Any]) -> Question:
        """A question of the batch."""
        contact, horizon, load = jax.tree.unflatten(self._rebuild, numbers)
        return dataclasses.replace(self._question, contact=contact, horizon=horizon, load=load)


def _designs_in_turn(question: Question, level: float) -> Designs:
    """The designs of known numbers, by the program of a single one."""
    assert question.load is not None
    given = question.load
    batch = _Batch(question, given.weight is not None, np)
    rows = [x.reshape(-1, *x.shape[len(batch.shape) :]) for x in batch.numbers]
    nothing: Any = (dict.fromkeys(question.bounds, np.nan), np.nan, np.nan, False, False, False)
    found = [nothing]
    for i in range(math.prod(batch.shape)):
        one = batch.one([row[i] for row in rows])
        contact, load = one.contact, one.load
        assert load is not None
        if question.by_force and not np.any(
            np.atleast_1d(load.amplitudes) * (1.0 if load.weight is None else load.weight)
        ):
            found.append(nothing)
            continue
        weighted = weighted_load(contact, load.load, load.weight, level, one.horizon is None)
        best = answered(dataclasses.replace(one, load=weighted))
        known = best.converged, best.certified, best.scan_found_nothing_better
        found.append((best.variables, float(best.value), best.saving, *known))
    # The first one says of which kind the entries are, also of no design at all.
    of_all = jax.tree.map(lambda kind, *parts: jnp.asarray(np.array(parts, type(kind)).reshape(batch.shape)), *found)
    return Designs(*of_all)


@jax.jit
def _designs_in_a_batch(question: Question, level: Array) -> Designs:
    """The designs of a question whose contact is a batch, and whose amplitudes have one more axis at the end."""
    batch = _Batch(question, question.load is not None and question.load.amplitudes is not None, jnp)

    def best(*numbers: Array) -> Designs:
        one = batch.one(numbers)
        if one.load is not None and one.by_force:
            one = dataclasses.replace(
                one, load=one.load.with_amplitudes(*falling(one.load.amplitudes, one.load.weight, level))
            )
        shared = shared_of(one)
        found = minimum_of(one, shared)
        worn = shared.scale > 0.0
        defined = jnp.where(worn, 1.0, jnp.nan)
        return Designs(
            variables={name: defined * variable for name, variable in found.variables.items()},
            value=defined * jnp.exp(found.value) * shared.scale,
            saving=defined * -jnp.expm1(found.value),
            converged=found.converged & worn,
            certified=found.certified & worn,
            scan_found_nothing_better=found.scan_found_nothing_better & worn,
        )

    if not solved_one_by_one(question) or read_from_runs(question):
        return in_chunks(best, batch.shape, *batch.numbers)
    return in_chunks(best, batch.shape, *map(_without_slopes, batch.numbers), most=1)


@jax.custom_jvp
def _without_slopes(x: Array) -> Array:
    return x


@_without_slopes.defjvp
def _refuse_slopes(primals: Any, tangents: Any) -> Any:
    text = "has no derivatives by the numbers of a contact without closed forms, nor for a life of several runs"
    raise ValueError(f"designs: {text}; optimise.sensitivities(optimise.design(...)) gives them")


def minimum_of(question: Question, shared: Shared) -> Minimum:
    """The minimum of the logarithm of the objective over that of the reference, within a compiled program."""

    def limits(variables: dict[str, Array]) -> Array:
        return jnp.stack([jnp.asarray(x) for x in Candidate(question, variables, shared).excess()])

    plan = plan_for(question)
    return minimise(
        lambda variables: Candidate(question, variables, shared).objective(),
        space(question),
        limits=limits if question.limits else None,
        samples=plan.samples,
        starts=plan.starts,
        axis_name=BATCH,
    )
