"""The question of a design: what may vary, what is held, the limits, and what is minimised.

Wear grows with the force amplitude for every material. So over a table of amplitudes the mean, the worst case and the
mean of the worst cases are means with weights that do not depend on the design, and smooth functions of it.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core import leaves
from plgwear_jax._core.domains import POSITIVE, RADIUS, check
from plgwear_jax._core.domains import ArrayLike as Given
from plgwear_jax._core.doubts import doubt, of_contact
from plgwear_jax._core.numbers import refuse_traced
from plgwear_jax._core.record import record, static
from plgwear_jax._core.words import shown
from plgwear_jax.catalogue import kind_of
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.loads import PARTIAL_SLIP, Block, Displacement, Force
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.optimise.life import Life, amplitudes_and_test, life_of
from plgwear_jax.optimise.loads import padded, sorted_loads
from plgwear_jax.optimise.scenarios import Cases, cases_of
from plgwear_jax.rules import (
    BY_THEN,
    HOLDS,
    OBJECTIVE,
    VARIABLES,
    Complaint,
    Hold,
    Kind,
    complaint,
    domain_of,
    exponents,
    is_after_cycles,
    limited_quantity,
    one_of,
    placed_quantity,
    window_complaint,
)
from plgwear_jax.wear_laws import WearLaw

Bounds = tuple[float, float]
LoadGiven = Given | Force | Displacement | Sequence[Block] | None
Objective = str | Mapping[str, Mapping[str, ArrayLike]]  # a name, or {"edge_pressure": {"distance": 1e-6}}

_ROUNDING = 1e-6  # of log(value/limit)


def keeps(excess: Any) -> Any:
    """Whether limits are kept, up to rounding, along the last axis of log(value/limit), negative where the lowest."""
    kept = np.max(excess, axis=-1, initial=-1.0) < _ROUNDING if np.ndim(excess) else excess < _ROUNDING
    return bool(kept) if np.ndim(kept) == 0 else kept


def limited(name: str) -> tuple[str, bool]:
    """What a limit of this name limits, and whether it is the lowest value allowed: "contact_radius_lowest"."""
    what = name.removesuffix("_lowest")
    return what.removesuffix("_highest"), what != name


def _pair_of(name: str, given: Any) -> tuple[Any, Any]:
    """Two numbers, or a ValueError that says what the argument of this name takes."""
    try:
        lowest, highest = given
    except (TypeError, ValueError):
        raise ValueError(f"{name} takes a pair of numbers, not {given!r}") from None
    return lowest, highest


@record
class ModulusWindow:
    """The lowest and highest modulus with which a coating can be made, at two depths.

    It takes numbers, not traced values.

    Attributes:
        at: The two depths in m, positive, the smaller one first.
        lower: The lowest modulus in Pa at each of them.
        upper: The highest modulus in Pa at each of them.
    """

    at: tuple[float, float]
    lower: tuple[float, float]
    upper: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("at", "lower", "upper"):
            pair = _pair_of(f"modulus: {name}", getattr(self, name))
            refuse_traced("ModulusWindow", pair, "the other limits, the contact and the load may be traced")
            for value in pair:
                check(f"modulus: {name}", value, POSITIVE)
        if not self.at[0] < self.at[1]:
            raise ValueError(f"modulus: at = {self.at}: the smaller depth must come first")
        for depth, lowest, highest in zip(self.at, self.lower, self.upper, strict=True):
            if not lowest < highest:
                raise ValueError(f"modulus at {depth} m: [{lowest}, {highest}]: the lowest must be below the highest")

    def exponents(self) -> Bounds:
        """The lowest and the highest exponent k that the window allows."""
        return exponents(self.at, self.lower, self.upper)


@record
class Limit:
    """The limits of one quantity.

    Attributes:
        above: The lowest value allowed, in SI units; None if there is none.
        below: The highest value allowed; None if there is none.
        places: The place in m at which the quantity is taken, by "r" or "distance"; empty if it has none.
    """

    above: ArrayLike | None
    below: ArrayLike | None
    places: dict[str, ArrayLike]


@record
class Limits:
    """The most common limits of a design; None means no limit.

    The same as a mapping from quantities to what they may be, which every quantity of the catalogue takes, such as
    `{"edge_pressure": {"below": 5e8, "distance": 1e-6}, "deepest_wear": {"below": 2e-6}}`.

    Attributes:
        edge_pressure: Highest pressure p_inf in Pa at the distance `distance` inside the stick edge, Eq. (17). This is
            the usual way to compare singularities of different order.
        distance: This critical distance in m.
        contact_radius: Lowest and highest initial contact radius a_0 in m; either may be None.
        penetration: Largest penetration d_inf in m.
        modulus: The window of E(z) at two depths.
    """

    edge_pressure: ArrayLike | None = None
    distance: ArrayLike | None = None
    contact_radius: tuple[ArrayLike | None, ArrayLike | None] | None = None
    penetration: ArrayLike | None = None
    modulus: ModulusWindow | None = None

    def __post_init__(self) -> None:
        limits_of(self, "fretting")

    @property
    def by_quantity(self) -> dict[str, Any]:
        """The same as a mapping."""
        found: dict[str, Any] = {}
        if self.edge_pressure is not None:
            place = {} if self.distance is None else {"distance": self.distance}
            found["edge_pressure"] = {"below": self.edge_pressure, **place}
        if self.contact_radius is not None:
            found["contact_radius"] = {"between": self.contact_radius}
        if self.penetration is not None:
            found["penetration"] = {"below": self.penetration}
        return found if self.modulus is None else found | {"modulus": self.modulus}


LimitsGiven = Limits | Mapping[str, Any]


def limits_of(given: LimitsGiven | None, kind: Kind) -> "dict[str, Limit | ModulusWindow]":
    """The limits by quantity, none by default, or an error that says what is wrong with them."""
    if isinstance(given, Limits):
        given = given.by_quantity
    if not isinstance(given, Mapping | None):
        raise TypeError(f'limits takes a mapping such as {{"penetration": {{"below": 2e-6}}}}, not {given!r}')
    found: dict[str, Limit | ModulusWindow] = {}
    for name, allowed in (given or {}).items():
        if name == "modulus":
            if not isinstance(allowed, ModulusWindow):
                raise TypeError(f"limits.modulus takes a ModulusWindow, not {allowed!r}")
            found[name] = allowed
            continue
        one = limited_quantity(name, allowed, kind)
        if isinstance(one, Complaint):
            raise ValueError(f"{one.key}: {one.text}")
        quantity, above, below, places = one
        ends = above, below
        for side, value in zip(("lowest", "highest"), ends, strict=True):
            if value is not None:
                check(f"limits: {side} {quantity}", value, POSITIVE)
        for place, value in places.items():
            check(f"limits: {place} of {quantity}", value, RADIUS if place == "r" else POSITIVE)
        if not any(end is None or isinstance(end, Tracer) for end in ends) and not np.all(np.less(*ends)):
            raise ValueError(f"limits.{name} between {ends}: the lowest value must be below the highest")
        if quantity in found:
            raise ValueError(f"limits.{name}: {quantity} is limited already")
        if ends != (None, None):
            found[quantity] = Limit(above, below, places)
    return found


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
    found = placed_quantity(key, name, places, kind)
    if isinstance(found, Complaint):
        raise ValueError(f"{found.key}: {found.text}")
    for place, value in places.items():
        check(f"{key}: {place}", value, RADIUS if place == "r" else POSITIVE)
    return found, places


@record
class Load:
    """The amplitudes for which a design is made, and how much each of them counts.

    Attributes:
        tangential_force: Amplitudes F_x in N, shape (n,), the largest one that counts first. Amplitudes without weight
            at the end are padding. NaN, shape (1,), where the life has another load.
        weight: With which the wear under each of them enters what is minimised, shape (n,), with the sum 1.
        life: After how many cycles the wear counts, and how it comes about; None for the steady state.
    """

    tangential_force: Any
    weight: Any
    life: Life | None = None

    def under(self, force: ArrayLike) -> "Load":
        """The load under another single amplitude of the force in N; where it is NaN, a displacement stays held."""
        if self.life is not None and self.life.load is not None:
            return dataclasses.replace(self, life=dataclasses.replace(self.life, tangential_force=force))
        return dataclasses.replace(self, tangential_force=np.reshape(force, (1,)))


@record
class Question:
    """The inputs of a design, all as numbers, with what is minimised and held.

    Attributes:
        contact: The contact as it was given, with the reference material.
        load: The amplitudes; None for gross slip.
        bounds: The lowest and the highest value of each variable, by name, in SI units. The two moduli of a window are
            "shallow_modulus" and "deep_modulus".
        depths: The depths in m of these two moduli, where they vary; else None.
        limits: What is limited, by quantity.
        objective: What is minimised.
        hold: What is held, and by which field of the material; None if nothing is.
        places: The place in m at which the quantity that is minimised is taken, by "r" or "distance".
        cases: What the contact may turn out to be; None if it is as given.
    """

    contact: Any
    load: Load | None
    bounds: dict[str, tuple[ArrayLike, ArrayLike]]
    depths: tuple[ArrayLike, ArrayLike] | None
    limits: Any  # a dict of Limit and ModulusWindow; it takes all that `design` takes
    objective: str = static()
    hold: Hold | None = static()
    places: dict[str, ArrayLike] = dataclasses.field(default_factory=dict)
    cases: Cases | None = None

    def __post_init__(self) -> None:
        given = self.limits
        if isinstance(given, Limits) or any(isinstance(x, Mapping) for x in given.values()):
            object.__setattr__(self, "limits", limits_of(given, kind_of(self.contact)))

    @property
    def phi(self) -> Any:
        """The amplitudes F_x/(mu F_N), the largest first, shape (n,); of scenarios (scenarios, n)."""
        assert self.load is not None
        if self.cases is None:
            return self.load.tangential_force / (self.contact.friction * self.contact.normal_force)
        contact, own = self.cases.contact, self.cases.tangential_force
        force = self.load.tangential_force if own is None else own[..., None]
        return force / (contact.friction * contact.normal_force)[..., None]

    @property
    def life(self) -> Life | None:
        """After how many cycles the wear counts; None for the steady state."""
        return None if self.load is None else self.load.life

    @property
    def window(self) -> ModulusWindow | None:
        """The limit of the modulus at two depths; None if there is none."""
        found = self.limits.get("modulus")
        return found if isinstance(found, ModulusWindow) else None

    @property
    def distance(self) -> ArrayLike | None:
        """The distance from the stick edge at which the pressure is limited; None without this limit."""
        found = self.limits.get("edge_pressure")
        return found.places["distance"] if isinstance(found, Limit) else None


SHALLOW, DEEP = "shallow_modulus", "deep_modulus"


def limits_by_name(limits: "Mapping[str, Limit | ModulusWindow]") -> dict[str, ArrayLike]:
    """The limits one by one, in the order in which JAX gives a dict: the quantity, with what `limited` takes off."""
    named: dict[str, ArrayLike | None] = {}
    for name, limit in limits.items():
        if isinstance(limit, Limit):
            named[f"{name}_lowest"] = limit.above
            # The contact radius has two sides always.
            both = limit.above is not None or name == "contact_radius"
            named[f"{name}_highest" if both else name] = limit.below
            continue
        for modulus, lowest, highest in zip((SHALLOW, DEEP), limit.lower, limit.upper, strict=True):
            named |= {f"{modulus}_lowest": lowest, f"{modulus}_highest": highest}
    return {name: allowed for name, allowed in sorted(named.items()) if allowed is not None}


def solved_one_by_one(question: Question) -> bool:
    """Each value takes milliseconds: the contact has no closed forms, or its way through a life is followed."""
    return not is_closed(question.contact) or question.life is not None


_SAME_RUNS = {"k", "E0", "z0", "radius", SHALLOW, DEEP}  # with which F_x/(mu F_N) and theta(k) stay the same


def read_from_runs(question: Question) -> bool:
    """Whether runs at a few exponents tell the wear of all designs: see `along_exponent`."""
    life, contact = question.life, question.contact
    if life is None or not life.smooth or question.cases is not None or not is_closed(contact):
        return False
    names = {BY_THEN.get(question.objective, question.objective), *question.limits}
    return (
        isinstance(contact.material, PowerLawGraded)
        and question.bounds.keys() <= _SAME_RUNS
        and {name for name in names if is_after_cycles(name)} == {BY_THEN["wear_volume"]}
    )


# --- the numbers of a contact that may vary --------------------------------------------------------------------------


def _path(name: str) -> str:
    return f"material.{name}" if name in ("k", "E0", "z0", "nu") else name


def leaf_of(contact: Any, name: str) -> Any:
    """The number of a contact that a variable of this name is."""
    return leaves.leaf_of(contact, _path(name))


def with_leaf(contact: Any, name: str, value: Any) -> Any:
    """The contact with another number in this place."""
    return leaves.with_leaf(contact, _path(name), value)


# --- from the arguments of `design` -----------------------------------------------------------------------------------


def question_of(
    contact: FrettingContact | GrossSlipContact,
    load: Any,
    vary: Mapping[str, Bounds | ModulusWindow],
    weight: Given | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: LimitsGiven | None = None,
    cycles: Given | None = None,
    wear_coefficient: Given | WearLaw | None = None,
    control: str = "force",
    rig_stiffness: Given | None = None,
    scenarios: Any = None,
) -> Question:
    """The question, or a ValueError; the arguments are those of `design`."""
    question = question_without_load(contact, load, vary, hold, minimise, limits)
    doubt(*of_contact(contact))
    force, test = amplitudes_and_test(load, weight)
    life = life_of(question.objective, question.limits, cycles, wear_coefficient, control, rig_stiffness, test)
    if scenarios is not None:
        refuse_traced("scenarios", scenarios, "a design for each of them works there")
        cases = cases_of(scenarios, contact, None if life is None else life.law, level)
        question = dataclasses.replace(question, cases=cases)
        level = 0.0  # it is that of all pairs of a scenario and an amplitude
    if isinstance(contact, GrossSlipContact):
        return question
    load = load_of(contact, force, weight, level, life)
    own = None if question.cases is None else question.cases.tangential_force
    if own is not None:
        if np.size(load.weight) > 1:
            raise ValueError("scenarios: tangential_force: is a single amplitude, and the load has several")
        if test is not None:
            load = load.under(_force_before_wear(contact, test))
    question = dataclasses.replace(question, load=load)
    if test is not None:
        return question
    if question.cases is not None:
        check("scenarios: tangential_force/(friction * normal_force)", question.phi, PARTIAL_SLIP)
    _refuse_gross_slip(question, load.tangential_force[0] if own is None else own)
    return question


def _force_before_wear(contact: FrettingContact, load: Any) -> float:
    """The force amplitude in N that a displacement needs before any wear; NaN where the whole contact slips."""
    if not isinstance(load, Displacement):
        raise ValueError("scenarios: tangential_force: belongs to an amplitude, not to blocks")
    moved, rig = load.displacement_amplitude, load.rig_stiffness
    if not moved < contact.gross_slip_displacement(rig_stiffness=rig):
        return np.nan
    return float(contact.tangential_force(moved, rig_stiffness=rig))


def load_of(
    contact: FrettingContact, tangential_force: ArrayLike, weight: Given | None, level: float, life: Life | None
) -> Load:
    """The load of known amplitudes of a contact, with the displacements that are held in a life, if any are."""
    if life is not None and life.load is not None:
        return Load(np.array([np.nan]), np.ones(1), life)
    force, counting = sorted_loads(contact, tangential_force, weight, level)
    if life is None:
        return Load(*padded(force, counting))
    return Load(force, counting, life.under(contact, force))  # without padding, which would be worn as well


def _refuse_gross_slip(question: Question, force: ArrayLike) -> None:
    """Refuse bounds of the friction and the normal force between which the whole contact slips."""
    varied = [name for name in ("friction", "normal_force") if name in question.bounds]
    if varied:
        lowest = question.contact if question.cases is None else question.cases.contact
        for name in varied:
            own = leaf_of(lowest, name) / leaf_of(question.contact, name)
            lowest = with_leaf(lowest, name, question.bounds[name][0] * own)
        phi = force / (np.asarray(lowest.friction) * np.asarray(lowest.normal_force))
        check(f"tangential_force/(friction * normal_force) at the lowest {' and '.join(varied)}", phi, PARTIAL_SLIP)


def checked_kind_of(contact: Any) -> Kind:
    """The kind of a contact, or a TypeError."""
    if not isinstance(contact, FrettingContact | GrossSlipContact):
        raise TypeError(f"contact takes a FrettingContact or a GrossSlipContact, not {contact!r}")
    return kind_of(contact)


def question_without_load(
    contact: FrettingContact | GrossSlipContact,
    load: Any,
    vary: Mapping[str, Bounds | ModulusWindow],
    hold: Hold | None,
    minimise: Objective | None,
    limits: LimitsGiven | None,
) -> Question:
    """The question without its load, or a ValueError."""
    kind, slips = checked_kind_of(contact), isinstance(contact, GrossSlipContact)
    objective, places = objective_of(OBJECTIVE[kind] if minimise is None else minimise, kind)
    allowed = limits_of(limits, kind)
    if hold is not None and hold not in HOLDS:
        raise ValueError(f"hold = {hold!r}: must be {one_of(HOLDS)}, or None")
    pairs, power = _bounds_of(contact, vary), isinstance(contact.material, PowerLawGraded)
    for name in ("vary", "limits"):
        if not power and "modulus" in (vary if name == "vary" else allowed):
            raise ValueError(f"{name}.modulus: is a window of a PowerLawGraded; vary material.modulus[0] and so on")
    k = contact.material.k if power else np.nan
    flat = not isinstance(k, Tracer) and bool(np.any(np.equal(k, 0.0)))
    wrong = complaint(pairs, hold, objective, allowed, kind=kind, flat=flat)
    if wrong is not None:
        value = f" = {shown(hold)}" if wrong.key == "hold" else ""
        raise ValueError(f"{wrong.key}{value}: {wrong.text}")
    if hold is not None and not power:
        raise ValueError(f"hold = {shown(hold)}: needs a PowerLawGraded material, which has E0 and z0")
    if slips and load is not None:
        raise ValueError("load: only a fretting contact has one")
    if not slips and load is None:
        raise ValueError("load: a fretting contact needs the amplitude of the force, in N")
    window, depths = vary.get("modulus"), None
    if isinstance(window, ModulusWindow):
        depths = window.at
        del pairs["modulus"]
        for name, *ends in zip((SHALLOW, DEEP), window.lower, window.upper, strict=True):
            pairs[name] = (ends[0], ends[1])
    return Question(contact, None, pairs, depths, allowed, objective, hold, places)


def _bounds_of(contact: Any, vary: Mapping[str, Bounds | ModulusWindow]) -> dict[str, tuple[ArrayLike, ArrayLike]]:
    """The bounds of what varies, each within its range; of a window its depths."""
    if not isinstance(vary, Mapping):
        raise TypeError(f'vary takes names with bounds, such as {{"k": (-0.9, 0.9)}}, not {vary!r}')
    pairs: dict[str, tuple[ArrayLike, ArrayLike]] = {}
    for given_name, given in vary.items():
        name = given_name.removeprefix("material.")
        name = name if name in VARIABLES else given_name
        if name == "modulus":
            if not isinstance(given, ModulusWindow):
                raise ValueError(f"vary: modulus takes a ModulusWindow, not {given!r}")
            said = window_complaint(given.at, given.lower, given.upper)
            if said is not None:
                raise ValueError(f"vary.modulus: {said}")
            pairs[name] = given.at
            continue
        _check_leaf(contact, name)
        lowest, highest = _pair_of(f"vary: {name}", given)
        refuse_traced(f"vary: {name}", (lowest, highest), "the contact and the load may be traced")
        check(f"vary: lowest {name}", lowest, domain_of(name))
        check(f"vary: highest {name}", highest, domain_of(name))
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
        for end in (lowest, highest):
            with_leaf(contact, name, end)  # whose fields say what they cannot be
        if name in pairs:
            raise ValueError(f"vary: {name} is given twice")
        pairs[name] = (lowest, highest)
    if not pairs:
        raise ValueError(f"vary is empty: name at least one of {', '.join(VARIABLES)}")
    return pairs


def _check_leaf(contact: Any, name: str) -> None:
    """Refuse a variable that is no number of the contact."""
    try:
        leaf = leaf_of(contact, name)
    except (AttributeError, IndexError, TypeError):
        leaf = None
    if isinstance(leaf, str):
        raise ValueError(f'vary: {name} = "{leaf}" follows from k; give the contact a number to vary it')
    if leaf is None or (not isinstance(leaf, Tracer) and np.asarray(leaf).dtype.kind not in "fiu"):
        text = f"{name!r} is not one of {', '.join(VARIABLES)}, nor another number of the contact"
        raise ValueError(f"vary: {text}")
