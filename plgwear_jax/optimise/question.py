"""The question of a design: what may vary, the constraint, the limits, the load, and what is minimised.

It is made once from the keywords of `design`; all other functions take it as it is. Wear grows with the amplitude for
every material. So over a table of amplitudes the mean, the worst case and the mean of the worst cases are means with
weights that do not depend on the design, and smooth functions of it.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict, Unpack, cast

import numpy as np
from jax.typing import ArrayLike

from plgwear_jax._core import leaves
from plgwear_jax._core.catalogue import QUANTITIES, Kind, kind_of, leaf, placed
from plgwear_jax._core.domains import POSITIVE, check, record, refuse_traced, static
from plgwear_jax._core.domains import ArrayLike as Given
from plgwear_jax._core.doubts import doubt, of_contact
from plgwear_jax._core.rules import (
    BY_THEN,
    OBJECTIVE,
    VARIABLES,
    WrongKeyError,
    is_after_cycles,
    is_linear,
    limited_quantity,
    one_of,
    placed_quantity,
    refuse_question,
)
from plgwear_jax._core.startup.programs import holds_tracers
from plgwear_jax._core.words import near_or_all
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.loads import PARTIAL_SLIP, Block, Load, load_of
from plgwear_jax.special.elementary import namespace
from plgwear_jax.steady.arguments import refuse_array
from plgwear_jax.wear_laws import Archard, WearLaw, law_of

from .scenarios import LEVEL, ScenarioBatch, WeightedLoad, scenario_batch, weighted_load

Bounds = tuple[float, float]
LoadGiven = Given | Load | Sequence[Block] | None
Objective = str | Mapping[str, Mapping[str, ArrayLike]]  # a name, or {"edge_pressure": {"distance": 1e-6}}


class Keywords(TypedDict, total=False):
    """What a design may be asked besides the contact, the load and what varies.

    Attributes:
        minimise: Any quantity of the contact that is a positive number, by its name in the catalogue: "wear_volume"
            (the default), "worn_radius", "deepest_wear", ...; for gross slip "volume_change" (the default),
            "force_drop", ... With its place if it needs one: {"edge_pressure": {"distance": 1e-6}}.
        limits: A mapping from quantities to "above" and "below" or "between" in SI units, with the place if it needs
            one: {"deepest_wear": {"below": 2e-6}, "edge_pressure": {"below": 5e8, "distance": 1e-6}}. Several limits
            of one quantity are a list: {"modulus_at": [{"between": (60e9, 400e9), "z": 1e-5}, ...]}. They are limits of
            the steady state at the largest amplitude that counts, or with names such as "transient.wear_depth" after
            the cycles.
        hold: "contact_radius" keeps the initial contact radius of the reference by adjusting E0. Then neither E0 nor z0
            can vary, as a contact depends on them only through E0/z0^k.
        cycles: After how many cycles the wear counts, positive: the wear_volume, the wear_depth at a radius or the
            worn_radius; by default that of the steady state counts.
        law: Archard's coefficient in 1/Pa, positive, or a law of `wear_laws`, which `cycles` needs.
        weight: Probabilities of the amplitudes, shape (n,), >= 0; by default all equal.
        level: 0 takes the mean over the amplitudes, 1 the worst case; between them the CVaR at that level, the mean
            over the worst 1 - level. With scenarios over all pairs of a scenario and an amplitude. Without them the
            worst amplitudes are the largest, as for wear, also if the stick radius, which falls, is minimised.
        scenarios: What the contact may turn out to be: `Scenarios`, or a contact whose numbers have a leading axis, all
            with equal probabilities. The limits are kept in every scenario. The reference is the contact itself.
    """

    minimise: Objective | None
    limits: Mapping[str, Any] | None
    hold: Literal["contact_radius"] | None
    cycles: Given | None
    law: Given | WearLaw | None
    weight: Given | None
    level: float
    scenarios: Any


_ROUNDING = 1e-6  # of log(value/limit)


def keeps(excess: Any) -> Any:
    """Whether limits are kept, up to rounding, along the last axis of log(value/limit), negative where the lowest."""
    return np.max(np.atleast_1d(excess), axis=-1, initial=-1.0) < _ROUNDING


@record
class Limit:
    """A limit of one quantity on one side.

    Attributes:
        value: What is allowed, in SI units.
        places: The place in m at which the quantity is taken, by "r", "distance" or "z"; empty if it has none.
        quantity: Its name in the catalogue.
        name: That of the limit, which no other limit of the question has: "contact_radius_lowest".
        lowest: It is the lowest value allowed, not the highest.
    """

    value: Any
    places: dict[str, Any]
    quantity: str = static()
    name: str = static()
    lowest: bool = static()

    @property
    def words(self) -> str:
        """What it is called in words."""
        return f"{'lowest' if self.lowest else 'highest'} {placed(self.quantity, self.places)} allowed"


def limits_of(given: Mapping[str, Any] | None, kind: Kind) -> tuple[Limit, ...]:
    """The limits in the order of their names, or an error that says what is wrong with them."""
    if not isinstance(given, Mapping | None):
        raise TypeError(f'limits takes a mapping such as {{"penetration": {{"below": 2e-6}}}}, not {given!r}')
    found: dict[str, Limit] = {}
    for name, allowed in (given or {}).items():
        several = allowed if isinstance(allowed, list | tuple) else [allowed]
        for place, one in enumerate(several):
            quantity, *ends, places = limited_quantity(name, one, kind)
            pairs = zip(("lowest", "highest"), ends, strict=True)
            sides = {side: value for side, value in pairs if value is not None}
            for side, value in sides.items():
                check(f"limits: {side} {quantity}", value, POSITIVE)
            places = _checked_places(f"limits: {{}} of {quantity}", places)
            if len(sides) == 2 and not holds_tracers(ends) and not np.all(np.less(*ends)):
                raise ValueError(f"limits.{name} between {tuple(ends)}: the lowest value must be below the highest")
            stem = quantity if len(several) == 1 else f"{quantity}[{place}]"
            # The contact radius has two sides always.
            both = "lowest" in sides or quantity == "contact_radius"
            for side, value in sides.items():
                called = f"{stem}_{side}" if both else stem
                if called in found or (both and stem in found):
                    raise ValueError(f"limits.{name}: {quantity} is limited already")
                found[called] = Limit(as_float(value), places, quantity, called, side == "lowest")
    return tuple(found[name] for name in sorted(found))


def _checked_places(said: str, places: Mapping[str, Any]) -> dict[str, Any]:
    positive = {"distance"} if "x" in places else {"distance", "z"}  # E(0) of a power law is no modulus
    for place, value in places.items():
        check(said.format(place), value, POSITIVE if place in positive else leaf(place).domain)
    return {place: as_float(value) for place, value in places.items()}


def objective_of(given: Objective, kind: Kind, key: str = "minimise") -> tuple[str, dict[str, Any]]:
    """The quantity that is minimised and its places, or a ValueError about the argument of this name."""
    if isinstance(given, str):
        name, places = given, {}
    else:
        try:
            ((name, places),) = given.items()
            places = dict(places)
        except (AttributeError, TypeError, ValueError):
            text = 'takes a name, or one with its place such as {"edge_pressure": {"distance": 1e-6}}'
            raise ValueError(f"{key}: {text}, not {given!r}") from None
    return placed_quantity(key, name, places, kind), _checked_places(f"{key}: {{}}", places)


@record
class WearHorizon:
    """After how many cycles the wear of a design counts, and by which law the contact wears until then.

    Attributes:
        cycles: How many.
        law: The wear law.
    """

    cycles: ArrayLike
    law: WearLaw


@record
class Question:
    """The inputs of a design, all as numbers, with what is minimised and held.

    Attributes:
        contact: The contact as it was given, with the reference material.
        load: The amplitudes with their weights; None for gross slip.
        bounds: The lowest and the highest value of each variable, by its path in the contact, in SI units.
        limits: What is limited.
        places: The place in m at which the quantity that is minimised is taken.
        horizon: After how many cycles the wear counts; None for the steady state.
        scenarios: What the contact may turn out to be; None if it is as given.
        objective: What is minimised.
        hold: The contact radius of the reference is kept.
    """

    contact: Any
    load: Any  # a `WeightedLoad`
    bounds: dict[str, Bounds]
    limits: tuple[Limit, ...]
    places: dict[str, ArrayLike]
    horizon: Any = None  # a `WearHorizon`
    scenarios: ScenarioBatch | None = None
    objective: str = static(default="")
    hold: bool = static(default=False)

    @property
    def phi(self) -> Any:
        """The amplitudes F_x/(mu F_N), the largest first, shape (n,); of scenarios, or a batch, along a last axis."""
        contact, force = self.contact, self.load.amplitudes
        if self.scenarios is not None:
            contact, own = self.scenarios.contact, self.scenarios.tangential_force
            force = force if own is None else own[..., None]
        limit = contact.friction * contact.normal_force
        return force / namespace(limit).asarray(limit)[..., None]

    @property
    def counted(self) -> str:
        """The quantity that is minimised, that after the cycles if there are any."""
        return self.objective if self.horizon is None else BY_THEN.get(self.objective, self.objective)

    @property
    def by_force(self) -> bool:
        """The amplitude of the force is constant."""
        return self.load is not None and self.load.load.holds_force

    @property
    def smooth(self) -> bool:
        """Whether wear and its slopes agree to many digits: a march of any test has about two."""
        return self.horizon is None or (self.by_force and isinstance(self.horizon.law, Archard))


def solved_one_by_one(question: Question) -> bool:
    """Each value takes milliseconds: the contact has no closed forms, or its way through a life is followed."""
    return not is_closed(question.contact) or question.horizon is not None


_SAME_RUNS = {"k", "E0", "z0", "radius"}  # with which F_x/(mu F_N) and theta(k) stay the same


def read_from_runs(question: Question) -> bool:
    """Whether runs at a few exponents tell the wear of all designs: see `along_exponent`."""
    contact, names = question.contact, {question.counted, *(one.quantity for one in question.limits)}
    return (
        question.horizon is not None
        and question.smooth
        and question.scenarios is None
        and is_closed(contact)
        and hasattr(contact.material, "k")
        and question.bounds.keys() <= _SAME_RUNS
        and {name for name in names if is_after_cycles(name)} == {BY_THEN["wear_volume"]}
    )


def solved_in_turn(question: Question) -> bool:
    """Each value takes milliseconds, and is not read from the runs of others."""
    return solved_one_by_one(question) and not read_from_runs(question)


def as_float(value: Any) -> Any:
    """A concrete number as a float; what is traced, or an array of several, as it is."""
    return value if holds_tracers(value) or np.ndim(value) else float(value)


# --- the numbers of a contact that may vary --------------------------------------------------------------------------


def _path_of(name: str) -> str:
    return f"material.{name}" if name in ("k", "E0", "z0", "nu") else name


def variable_of(contact: Any, name: str) -> Any:
    """The number of a contact that a variable of this name is."""
    return leaves.leaf_of(contact, _path_of(name))


def with_variables(contact: Any, values: Mapping[str, Any]) -> Any:
    """The contact with other numbers in these places."""
    for name, value in values.items():
        contact = leaves.with_leaf(contact, _path_of(name), value)
    return contact


def moved(name: str, value: Any, step: Any) -> Any:
    """A number of this name, moved by a step on the scale on which it is searched: k, nu and exponents are linear."""
    return value + step if is_linear(name) else value * namespace(step).exp(step)


# --- from the arguments of `design` -----------------------------------------------------------------------------------


def question_of(contact: Any, load: Any = None, vary: Any = None, **keywords: Unpack[Keywords]) -> Question:
    """The question of these arguments of `design`, or a ValueError. A question is handed back as it is."""
    if isinstance(contact, Question):
        return contact
    question = parts_of(contact, load, vary, **keywords)
    refuse_array(contact)
    of_question = dataclasses.replace(question, contact=None, load=None)
    for name, number in leaves.paths_of(of_question, lambda given: isinstance(given, list)).items():
        if np.shape(number):
            raise ValueError(f"{name}: takes one number, not an array of shape {np.shape(number)}")
    doubt(*of_contact(contact))
    level, scenarios = keywords.get("level", 0.0), keywords.get("scenarios")
    if scenarios is not None:
        law = None if question.horizon is None else question.horizon.law
        question = dataclasses.replace(question, scenarios=scenario_batch(scenarios, contact, law, level))
        level = 0.0  # it is that of all pairs of a scenario and an amplitude
    if question.load is None:
        return question
    question = dataclasses.replace(question, load=weighted_load(contact, question.load, level))
    own = None if question.scenarios is None else question.scenarios.tangential_force
    if own is not None and (not question.by_force or np.size(question.load.weight) > 1):
        raise ValueError("scenarios: tangential_force: takes the place of a single amplitude of the force")
    if question.by_force:
        if question.scenarios is not None:
            check("scenarios: tangential_force/(friction * normal_force)", question.phi, PARTIAL_SLIP)
        called, most = hardest(question)
        check(called, most[..., 0], PARTIAL_SLIP)
    return question


def hardest(question: Question) -> tuple[str, Any]:
    """The amplitudes F_x/(mu F_N) where what varies makes them largest, in words and shape (n,), or of a batch.

    Between the bounds of the friction and the normal force the whole contact may slip.
    """
    called, phi, at = "tangential_force/(friction * normal_force)", question.phi, " at the lowest "
    for name in ("friction", "normal_force"):
        if name in question.bounds:
            called, at = f"{called}{at}{name}", " and "
            own = variable_of(question.contact, name)
            phi = phi * namespace(own).asarray(own)[..., None] / question.bounds[name][0]
    return called, phi


def checked_kind_of(contact: Any) -> Kind:
    """The kind of a contact, or a TypeError."""
    if not isinstance(contact, FrettingContact | GrossSlipContact):
        raise TypeError(f"contact takes a FrettingContact or a GrossSlipContact, not {contact!r}")
    return kind_of(contact)


def is_held(hold: str | None) -> bool:
    """Whether the contact radius is held, or a ValueError."""
    if hold not in (None, "contact_radius"):
        raise ValueError(f'hold = {hold!r}: must be "contact_radius", or None')
    return hold is not None


def parts_of(contact: Any, load: Any, vary: Any, **keywords: Unpack[Keywords]) -> Question:
    """The question with its load and weights as given and without scenarios, or a ValueError; it may be a batch."""
    for name in keywords.keys() - Keywords.__annotations__.keys():
        raise TypeError(f"a design takes no {name}{near_or_all(name, [*Keywords.__annotations__])}")
    kind, minimise, hold = checked_kind_of(contact), keywords.get("minimise"), is_held(keywords.get("hold"))
    objective, places = objective_of(OBJECTIVE[kind] if minimise is None else minimise, kind)
    limits = limits_of(keywords.get("limits"), kind)
    bounds, k = _bounds_of(contact, vary), getattr(contact.material, "k", np.nan)
    flat = not holds_tracers(k) and bool(np.any(np.equal(k, 0.0)))
    names = [one.quantity for one in limits]
    refuse_question(bounds, hold, objective, names, kind=kind, flat=flat)
    if hold and not hasattr(contact.material, "E0"):
        raise ValueError("hold: needs a PowerLawGraded material, which has E0")
    level = keywords.get("level", 0.0)
    check("level", level, LEVEL)
    if np.ndim(level):
        raise ValueError(f"level: takes one number, not an array of shape {np.shape(level)}")
    load = None if load is None else load_of(load)
    if kind == "gross-slip" and load is not None:
        raise ValueError("load: only a fretting contact has one")
    if kind == "fretting" and load is None:
        raise ValueError("load: a fretting contact needs the amplitude of the force, in N")
    cycles, law = (cast(Any, keywords.get(name)) for name in ("cycles", "law"))
    kept = None if load is None or load.holds_force else load
    if cycles is None and kept is not None:
        raise ValueError(f"cycles: {never_steady(kept)}")
    if (cycles is None) != (law is None):
        raise TypeError("cycles and law go together: one needs the other")
    if kept is not None:
        for name in filter(needs_force, names):
            text = f"is a limit of the steady state under one amplitude of the force, not under {_held(kept)}"
            raise WrongKeyError(f"limits.{name}", text)
    lasting = [name for name in (objective, *names) if is_after_cycles(name)]
    if cycles is None and lasting:
        raise WrongKeyError(lasting[0], "is a quantity after a life, which needs cycles and a wear law")
    if cycles is not None:
        if objective not in BY_THEN and not lasting:
            after = one_of(tuple(BY_THEN))
            raise ValueError(f"cycles: the {objective} is minimised in the steady state; after cycles {after}")
        check("cycles", cycles, POSITIVE)
    horizon = None if cycles is None else WearHorizon(cycles, law_of(law))
    weighted = None if load is None else WeightedLoad(load, keywords.get("weight"))
    return Question(contact, weighted, bounds, limits, places, horizon, None, objective, hold)


def _held(load: Load) -> str:
    return "blocks of several loads" if not load.lasts else "a displacement, which is held"


def never_steady(load: Load) -> str:
    """Why a displacement, or blocks, has no steady state."""
    return f"wear under {_held(load)}, ends in no steady state of Eq. (28)"


def needs_force(name: str) -> bool:
    """Whether a quantity is that of the steady state under an amplitude of the force."""
    quantity = QUANTITIES["fretting"].get(name)
    return quantity is not None and "F_x" in quantity.arguments


def _bounds_of(contact: Any, vary: Any) -> dict[str, Bounds]:
    """The bounds of what varies, each within its range."""
    if not isinstance(vary, Mapping):
        raise TypeError(f'vary takes names with bounds, such as {{"k": (-0.9, 0.9)}}, not {vary!r}')
    pairs: dict[str, Bounds] = {}
    for given_name, given in vary.items():
        name = given_name.removeprefix("material.")
        name = name if name in VARIABLES else given_name
        try:
            own = variable_of(contact, name)
        except (AttributeError, IndexError, TypeError):
            own = None
        if isinstance(own, str):
            raise ValueError(f'vary: {name} = "{own}" follows from k; give the contact a number to vary it')
        if own is None or (not holds_tracers(own) and np.asarray(own).dtype.kind not in "fiu"):
            allowed = ", ".join(VARIABLES)
            raise ValueError(f"vary: {name!r} is not one of {allowed}, nor another number of the contact")
        try:
            lowest, highest = given
        except (TypeError, ValueError):
            raise ValueError(f"vary: {name} takes a pair of numbers, not {given!r}") from None
        refuse_traced(f"vary: {name}", holds_tracers((lowest, highest)), "the contact and the load may be traced")
        for side, end in (("lowest", lowest), ("highest", highest)):
            check(f"vary: {side} {name}", end, leaf(name).domain)
            with_variables(contact, {name: end})  # whose fields say what they cannot be
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
        if name in pairs:
            raise ValueError(f"vary: {name} is given twice")
        pairs[name] = as_float(lowest), as_float(highest)
    if not pairs:
        raise ValueError(f"vary is empty: name at least one of {', '.join(VARIABLES)}")
    return pairs
