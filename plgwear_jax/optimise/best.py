"""The best design for a question, beside its reference and in words."""

import itertools
import math
import textwrap
from collections.abc import Iterable, Mapping
from typing import Any, Literal, Unpack

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core import doubts
from plgwear_jax._core.catalogue import measured
from plgwear_jax._core.domains import ArrayLike, concrete_only, record, static
from plgwear_jax._core.startup.programs import program
from plgwear_jax.contact import FrettingContact, GrossSlipContact

from .evaluation import (
    Evaluation,
    Evaluator,
    Known,
    concrete,
    evaluate,
    reference_variables,
    search,
    search_over_scenarios,
    tells_states,
    valued,
)
from .question import Bounds, Keywords, LoadGiven, Question, as_float, keeps, question_of, with_variables
from .search import Minimum

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
        return bool(keeps(-excess if self.lowest else excess))


def of_question(name: str) -> Any:
    """A field of the question, as a property of its answer."""
    return property(lambda self: getattr(self.question, name))


def _flag(name: str) -> Any:
    return property(lambda self: bool(getattr(self.minimum, name)))


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

    reference = of_question("contact")
    """The contact as it was given."""
    objective = of_question("objective")
    """What was minimised."""
    load = of_question("load")
    """The amplitudes that count, with their weights; None for gross slip."""
    bounds = of_question("bounds")
    """The lowest and the highest value of each variable, by name, in SI units."""
    converged = _flag("converged")
    """The search ended at a minimum."""
    certified = _flag("certified")
    """Converged, and the global search, the scan and descents from its valleys, found nothing better: no proof."""
    scan_found_nothing_better = _flag("scan_found_nothing_better")
    """For one variable: nothing better is expected between the points of the scan; no proof, see `Minimum`."""

    @property
    def hold(self) -> Literal["contact_radius"] | None:
        """What was held."""
        return "contact_radius" if self.question.hold else None

    @property
    def windows(self) -> list[tuple[float, float, float]]:
        """The depths in m at which the modulus is limited, each with its lowest and highest value; NaN for none."""
        found: dict[float, list[float]] = {}
        for one in self.question.limits:
            if one.quantity == "modulus_at":
                found.setdefault(one.places["z"], [math.nan, math.nan])[not one.lowest] = one.value
        return [(depth, *ends) for depth, ends in sorted(found.items())]  # pyright: ignore[reportReturnType]

    @property
    def variables(self) -> dict[str, float]:
        """The values of what was varied, by name."""
        return _floats(self.minimum.variables)

    @property
    def reference_variables(self) -> dict[str, float]:
        """The values of the reference for what was varied, by name."""
        return _floats(reference_variables(self.question))

    @property
    def saving(self) -> float:
        """The share by which the objective is less than that of the reference."""
        return as_float(1.0 - self.value / self.reference_value)

    @property
    def at_bound(self) -> dict[str, Literal["lower", "upper"] | None]:
        """For each variable the bound it lies on, or None."""
        named: Any = None, "upper", "lower"
        return {name: named[int(side)] for name, side in self.minimum.side.items()}

    @property
    def keeps_limits(self) -> bool:
        """No limit is broken by more than rounding."""
        return bool(keeps(self.minimum.limits))

    @property
    def rival(self) -> dict[str, float] | None:
        """The next best minimum, or None."""
        return _floats(self.minimum.rival) if math.isfinite(self.minimum.rival_value) else None

    @property
    def rival_value(self) -> float:
        """The objective of the rival, in SI units; infinite if there is none."""
        return as_float(self.value * np.exp(self.minimum.rival_value - self.minimum.value))

    def __repr__(self) -> str:
        try:
            return _in_words(self)
        except (TypeError, ValueError, jax.errors.JAXTypeError):  # traced, or many of them
            return f"Design(of {', '.join(self.question.bounds)}, {self.objective}={self.value!r})"


def _floats(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: as_float(value) for name, value in values.items()}


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


def answered(question: Question) -> Design:
    """The design that answers a question, with what has been evaluated on the way as `known`."""
    known: Known = {}
    found = search(question, known=known) if question.scenarios is None else search_over_scenarios(question, known)
    at = evaluate(question, found.variables, known)
    given = {name: np.asarray(value).item() for name, value in {**found.variables, **at.held}.items()}
    contact = with_variables(question.contact, given)
    best = Design(
        contact=contact,
        value=valued(at.objective[0], question, contact),
        reference_value=at.scale,
        limits=limit_states(question, at, found.multipliers),
        minimum=found,
        question=question,
    )
    vars(best)["known"] = known  # for its picture, and for other designs under its load
    return best


def limit_states(question: Question, at: Evaluation, multipliers: Any) -> dict[str, LimitState]:
    """The values for the limits at the first choice of the variables."""
    found = {}
    for one, over, by in zip(question.limits, at.values[0, 1:], multipliers, strict=True):
        value = one.value * np.exp(-over if one.lowest else over)
        found[one.name] = LimitState(value, one.value, by, one.quantity, one.lowest)
    return found


# --- beside the reference ---------------------------------------------------------------------------------------------

_SAMPLES = 201


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
        depth: The wear depth there, shape (2, n).
        depths: Depths in the half-space at which the pictures show the modulus, shape (m,): two of a power law.
        modulus: Young's modulus there, shape (2, m).
    """

    quantities: dict[str, Array]
    distance: ArrayLike
    radii: Array
    depth: Array
    depths: Array
    modulus: Array


of_design = concrete_only("optimise.designs works there for contacts with closed forms", Design)
"""A decorator of functions of a design."""


@of_design
def compared(found: Design) -> Comparison:
    """Compare the best contact of a design with its reference.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The edge pressure is taken at the distance at which it is minimised, else at that in the limits of the design, or
    else at a hundredth of the contact radius of the reference.

    Args:
        found: The result of `design`.

    Returns:
        The quantities and the wear profiles of both.
    """
    question, load, evaluator = found.question, found.question.load, Evaluator(found.question)
    pair = concrete(found.contact), concrete(question.contact)
    places = question.places, *(one.places for one in question.limits)
    distance, each = concrete(next((at["distance"] for at in places if "distance" in at), np.nan)), []
    for one, values in zip(reversed(pair), (found.reference_variables, found.variables), strict=True):
        if load is None:
            each.append(_face(one))
        elif not question.by_force:
            each.append(_worn_by_then(question, one))
        else:
            steady = one.steady(concrete(load.amplitudes)[0])
            if tells_states(question):  # by the program of the search
                vars(steady)["solved"] = jax.tree.map(lambda x: x[0], evaluator.told(values).state)
            distance, *ring = _ring(steady, distance)  # both at the place of the reference
            each.append(ring)
    quantities, edge, radii, depth = jax.tree.map(lambda *parts: np.stack(parts[::-1]), *map(tuple, each))
    marked = [one.places["z"] for one in question.limits if one.quantity == "modulus_at"]
    ends = min([0.01 * edge[1], *(0.5 * z for z in marked)]), max([10.0 * edge[1], *(2.0 * z for z in marked)])
    depths = concrete(np.geomspace(*ends, _SAMPLES))
    modulus: Any = np.stack([_moduli(one.material, np.append(at, depths)) for one, at in zip(pair, edge, strict=True)])
    quantities["modulus_at_radius"] = modulus[:, 0]
    quantities[found.objective] = np.array([found.value, found.reference_value])
    return Comparison(quantities, np.asarray(distance), radii, depth, depths, modulus[:, 1:])


# Each gives quantities, the edge of the contact before any wear, radii and wear depths there.


_OF_RING = "contact_radius", "stick_radius", "worn_radius", "wear_volume"


@program(level=1)
def _ring(steady: Any, distance: Array) -> Any:
    quantities = {name: getattr(steady, name) for name in _OF_RING}
    radius, inner, outer, *_ = quantities.values()
    distance = jnp.where(jnp.isnan(distance), 0.01 * radius, distance)
    quantities |= {"edge_exponent": steady._edge_exponent, "edge_pressure": steady.edge_pressure(distance)}
    radii = inner + (outer - inner) * jnp.linspace(0.0, 1.0, _SAMPLES)
    return distance, quantities, radius, radii, steady.wear_depth(radii)


@program()
def _face(punch: Any) -> Any:
    steady = punch.steady()
    quantities = {name: getattr(steady, name) for name in ("volume_change", "force_drop")}
    radii = punch.radius * jnp.sin(jnp.linspace(0.0, 0.5 * jnp.pi, _SAMPLES))
    return quantities, punch.radius, radii, punch.depth - steady.steady_displacement(radii)


def _worn_by_then(question: Question, contact: Any) -> Any:
    """Under a load without a steady state: what is worn after the life."""
    horizon = question.horizon
    run, radius = contact.over_cycles(question.load.largest, horizon.law), contact.steady(0.0).contact_radius
    radii = run.contact_radius(horizon.cycles) * np.linspace(0.0, 1.0, _SAMPLES)
    return {"contact_radius": radius}, radius, radii, run.depth(radii, horizon.cycles)


@program()
def _moduli(material: Any, depths: Array) -> Array:
    return material.modulus_at(depths)


def doubtful(found: Design, comparison: Comparison) -> str | None:
    """Why nobody could make or measure the best contact, if so, from what `compared` gives."""
    radius = as_float(comparison.quantities.get("contact_radius", [found.contact.radius])[0])
    return doubts.of_design(comparison.depths, comparison.modulus[0], radius, as_float(np.max(comparison.depth[0])))


# --- in words ---------------------------------------------------------------------------------------------------------


def printed(kind: str, lines: Iterable[str | None]) -> str:
    """Lines below the name of what they tell of, so that they fit a screen."""
    wrapped = (textwrap.wrap(line or "", 96, subsequent_indent="  ") for line in lines)
    return "\n  ".join([f"{kind}:", *itertools.chain(*wrapped)])


def _in_words(found: Design) -> str:
    """The objective, the variables, the material, what was held and limited, and what is certain."""
    lines: list[str | None] = [headline(found)]
    for name, value in found.variables.items():
        lines.append(placed_between(name, name, value, found.bounds[name], found.at_bound[name]))
    material, load, scenarios = vars(found.contact.material), found.load, found.question.scenarios
    told = []
    for name in ("E0", "z0", "k", "thickness", "modulus"):
        if name in material:
            row = ", ".join(measured(f"material.{name}", value) for value in np.ravel(material[name]))
            told.append(f"{name} = [{row}]" if np.ndim(material[name]) else f"{name} = {row}")
    of_what = "E(z) at depths" if "depth" in material else ", ".join(told)
    lines.append(f"material: {of_what}{f'; {found.hold} held' if found.hold else ''}")
    if load is not None:
        counting = np.count_nonzero(load.weight)
        told = f"{counting} amplitudes, at most " if counting > 1 else ""
        lines.append(f"load: {told}{f'{np.max(load.amplitudes):.4g} N' if found.question.by_force else load.load}")
    if scenarios is not None:
        lines.append(f"scenarios: {np.size(scenarios.weight)}, limits for the worst of them")
    if found.question.by_force:
        lines.append(doubtful(found, compared(found)))
    limits = []
    for state in found.limits.values():
        value, allowed = (measured(state.quantity, number) for number in (state.value, state.allowed))
        side = ">=" if state.lowest else "<="
        limits.append(f"{state.quantity} {value} {side} {allowed}{'' if state.kept else ' BROKEN'}")
    lines.append(f"limits: {', '.join(limits)}" if limits else None)
    return printed("Design", [*lines, certainty(found, "converged", "certified", "scan_found_nothing_better")])


def headline(found: Any) -> str:
    """The objective of a design, and what it saves."""
    return f"{found.objective} = {measured(found.objective, found.value)}, {less(found.saving)} than the reference"


def less(saving: float) -> str:
    """How much less there is of something; nothing is told of digits that the search does not have."""
    if abs(saving) < 1e-5:
        return "no less"
    return f"{100.0 * abs(saving):.3g} % {'less' if saving >= 0.0 else 'more'}"


def placed_between(called: str, name: str, value: Any, bounds: Iterable[Any], side: str | None) -> str:
    """The value of what varies, with its bounds and the one on which it lies."""
    lowest, highest = (measured(name, end) for end in bounds)
    place = f", at the {side} bound" if side else ""
    return f"{called} = {measured(name, value)}, between {lowest} and {highest}{place}"


def certainty(found: Any, *names: str) -> str:
    """Which of these is true of a design, and which is not."""
    return ", ".join(name if getattr(found, name) else f"not {name}" for name in names)
