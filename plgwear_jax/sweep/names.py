"""The quantities of a sweep: names of quantities, their derivatives and designs are made into functions of the axes.

A name is that of a function (`wear_volume`, `gross_slip.force_ratio`), with a contact that of one of its methods, or
that of a field of an optimum (`optimal_exponent.k`, `design.saving`). The variables to differentiate by follow it
(`wear_volume.dk`, `wear_volume.dk.dphi`).
"""

import dataclasses
import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax import fretting, gross_slip, material, optimise
from plgwear_jax._core.words import near, near_or_all, one_line
from plgwear_jax.catalogue import (
    AXES,
    FRETTING,
    GROSS_SLIP,
    MATERIAL,
    QUANTITIES,
    TRANSIENT,
    Law,
    derivative,
    entry,
    kind_of,
)
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.rules import OBJECTIVE

__all__ = ["BODIES", "Asked", "QuantityError", "Subject", "is_search", "resolve", "units", "variable_name"]

BODIES = "material", "indenter", "shape"  # the fields of a contact that are no numbers

Values = Mapping[
    str, Any
]  # of the axes and of the fields of the contact, which broadcast; "load_case" holds row numbers


class QuantityError(ValueError):
    """Why a quantity cannot be computed, in one line that begins with its name."""


@dataclasses.dataclass(frozen=True, eq=False)
class Subject:
    """The contact and its loads.

    Attributes:
        contact: The contact whose methods are the quantities; None for the dimensionless functions.
        relative: The amplitude is given as phi, not as a force.
        holl: Poisson's ratio is Holl's, and so not a number.
        forces: Amplitudes in N of each load, shape (loads, n), padding without weight at the end; None without loads.
        weights: Their weights, of the same shape.
        design: Further arguments of `optimise.designs`; None if no design can be asked for.
        bounds: Of `optimal_exponent`.
        digits: Correct digits wanted.
    """

    contact: FrettingContact | GrossSlipContact | None = None
    relative: bool = False
    holl: bool = False
    forces: np.ndarray | None = None
    weights: np.ndarray | None = None
    design: Mapping[str, Any] | None = None
    bounds: tuple[float, float] = (-0.95, 0.95)
    digits: int | None = None

    @property
    def indenter(self) -> Any:
        """The elastic indenter, or None."""
        return getattr(self.contact, "indenter", None)

    @property
    def numeric(self) -> bool:
        """The contact has no closed forms."""
        return self.contact is not None and not is_closed(self.contact)


@dataclasses.dataclass(frozen=True, eq=False)
class Asked:
    """One quantity.

    Attributes:
        name: As it was asked for.
        needs: The axes or fields that need a value.
        slopes: Those with respect to which it can be differentiated.
        evaluate: The quantity at values that broadcast; the second argument holds results that quantities share.
        unit: Of the quantity.
        description: What it is, in words.
        equation: Its number in the paper; empty for designs.
    """

    name: str
    needs: tuple[str, ...]
    slopes: tuple[str, ...]
    evaluate: Callable[[Values, dict[Any, Any]], Array]
    unit: str
    description: str
    equation: str


def is_search(name: str) -> bool:
    """Whether the quantity needs a search or a march over cycles, which take a thousand times as long as a formula."""
    return name.split(".")[0] in _SEARCHES


_SEARCHES = ("optimal_exponent", "design", "transient")


def variable_name(quantity: str) -> str:
    """The name of a quantity in a dataset, which can be an attribute in Python: `wear_volume_dk`."""
    return quantity.replace(".", "_")


def units(contact: object | None) -> dict[str, str]:
    """The unit of every axis."""
    return {name: kind.unit if contact is not None else kind.scale or kind.unit for name, kind in AXES.items()}


# --- names ----------------------------------------------------------------------------------------------------------


def resolve(name: str, subject: Subject) -> Asked:
    """The quantity of this name.

    Raises:
        QuantityError: There is none.
    """
    stem, slopes = derivative(name)
    asked = _find(name, stem, subject)
    for slope in slopes:
        asked = _differentiated(asked, slope, subject)
    return dataclasses.replace(asked, name=name)


def _find(name: str, stem: str, subject: Subject) -> Asked:
    head, _, tail = stem.partition(".")
    if head == "optimal_exponent" and subject.contact is None:
        return _of_record(stem, _exponent_fields(), ("phi",), functools.partial(_optimum, subject))
    if head == "design" and subject.contact is not None:
        if subject.design is None:
            raise QuantityError(f"{one_line(name)}: needs to be told what may vary (design=, or a scene with [design])")
        needs = (*_force_of(subject), *_fields(subject))
        return _of_record(stem, _design_fields(subject), needs, functools.partial(_designs, subject))
    known = _over_cycles(subject) if head == "transient" else _known(subject)
    if stem not in known:
        text = f"{one_line(name)}: there is no such quantity"
        by = near(stem, known)
        if not by and head in known and tail:
            by = f"; {head} has derivatives by {', '.join('d' + axis for axis in known[head].slopes)}"
        raise QuantityError(f"{text}{by or near_or_all(stem, known)}")
    return known[stem]


def _known(subject: Subject) -> dict[str, Asked]:
    """All quantities except those of optima, by name."""
    contact = subject.contact
    if contact is not None:
        laws = FRETTING if isinstance(contact, FrettingContact) else GROSS_SLIP
        return {name: _of_contact(name, law, subject) for name, law in laws.items() if law.unit is not None}
    found: dict[str, Asked] = {}
    for module, laws in ((fretting, FRETTING), (gross_slip, GROSS_SLIP), (material, MATERIAL)):
        for name, law in laws.items():
            if law.scale is not None:
                asked = _of_function(getattr(module, name), law, subject)
                found.setdefault(name, asked)
                found[f"{module.__name__.rpartition('.')[2]}.{name}"] = asked
    return found


def _over_cycles(subject: Subject) -> dict[str, Asked]:
    """The quantities after some cycles, by name."""
    from plgwear_jax import transient  # seldom needed, and takes time

    if isinstance(subject.contact, GrossSlipContact):
        return {}
    if subject.contact is not None:
        laws = {name: law for name, law in TRANSIENT.items() if law.unit is not None}
        return {f"transient.{name}": _of_contact(name, law, subject) for name, law in laws.items()}
    return {
        f"transient.{name}": _of_function(getattr(transient, name), law, subject) for name, law in TRANSIENT.items()
    }


def _of_function(function: Callable[..., Array], law: Law, subject: Subject) -> Asked:
    parameters = inspect.signature(function).parameters.values()
    needs = tuple(one.name for one in parameters if one.kind is not one.KEYWORD_ONLY)
    slopes = tuple(name for name in needs if not (name == "nu" and subject.holl))

    def evaluate(values: Values, memo: dict[Any, Any]) -> Array:
        del memo
        return function(*(values[name] for name in needs), digits=subject.digits)

    assert law.scale is not None
    return Asked(function.__name__.lstrip("_"), needs, slopes, evaluate, law.scale, law.description, law.equation)


def _of_contact(name: str, law: Law, subject: Subject) -> Asked:
    fields = _fields(subject)
    over = tuple(argument for argument in law.arguments if argument in ("cycles", "wear_coefficient"))
    places = tuple(argument for argument in law.arguments if argument != "F_x" and argument not in over)
    needs = (*places, *(_force_of(subject) if "F_x" in law.arguments else ()), *fields, *over)

    def evaluate(values: Values, memo: dict[Any, Any]) -> Array:
        del memo
        if "F_x" not in law.arguments:
            return getattr(_contact(subject, values), name)(*(values[place] for place in places), digits=subject.digits)
        force, weight = _load(subject, values)
        if weight is None:
            arguments, after = (*(values[place] for place in places), force), {one: values[one] for one in over}
            return getattr(_contact(subject, values), name)(*arguments, **after, digits=subject.digits)
        single = {axis: x if isinstance(x, str) else jnp.asarray(x)[..., None] for axis, x in values.items()}
        arguments, after = (*(single[place] for place in places), force), {one: single[one] for one in over}
        each = getattr(_contact(subject, single), name)(*arguments, **after, digits=subject.digits)
        return jnp.sum(jnp.where(weight > 0.0, weight * each, 0.0), axis=-1)

    mean = "mean over the load of: " if subject.forces is not None and "F_x" in law.arguments else ""
    assert law.unit is not None
    slopes = tuple(need for need in needs if need != "load_case")
    return Asked(name, needs, slopes, evaluate, law.unit, f"{mean}{law.description}", law.equation)


def _differentiated(asked: Asked, by: str, subject: Subject) -> Asked:
    if by not in asked.slopes:
        have = f"; it has those by {', '.join(asked.slopes)}" if asked.slopes else ""
        raise QuantityError(f"{asked.name}: has no derivative by {by}{have}")

    def evaluate(values: Values, memo: dict[Any, Any]) -> Array:
        del memo

        def along(x: Array) -> Array:
            return asked.evaluate({**values, by: x}, {})

        x = jnp.asarray(values[by])
        return jax.jvp(along, (x,), (jnp.ones_like(x),))[1]

    axis_unit = units(subject.contact)[by]
    unit = asked.unit
    if axis_unit.startswith("1/"):
        unit = f"{unit} {axis_unit[2:]}"
    elif axis_unit != "1":
        unit = f"{f'({unit})' if '/' in unit else unit}/{axis_unit}"
    return dataclasses.replace(
        asked,
        name=f"{asked.name}.d{by}",
        evaluate=evaluate,
        unit=unit,
        description=f"derivative by {by} of: {asked.description}",
    )


# --- contacts and loads ---------------------------------------------------------------------------------------------


def _fields(subject: Subject) -> tuple[str, ...]:
    contact = subject.contact
    assert contact is not None
    own = tuple(field.name for field in dataclasses.fields(contact) if field.name not in BODIES)
    nu = () if subject.holl else ("nu",)
    law = ("E0", "z0", "k") if isinstance(contact.material, PowerLawGraded) else ()
    return (*law, *nu, *own, *(() if subject.indenter is None else ("indenter_E",)))


def _contact(subject: Subject, values: Values) -> Any:
    contact = subject.contact
    assert contact is not None
    changes = {name: values[name] for name in _fields(subject)}
    own = {name: changes.pop(name) for name in tuple(changes) if hasattr(contact, name)}
    if "indenter_E" in changes:
        own["indenter"] = dataclasses.replace(subject.indenter, E=changes.pop("indenter_E"))
    if subject.holl:
        changes["nu"] = "holl"
    return dataclasses.replace(contact, material=dataclasses.replace(contact.material, **changes), **own)


def _force_of(subject: Subject) -> tuple[str, ...]:
    """The inputs that set the amplitude."""
    if not isinstance(subject.contact, FrettingContact):
        return ()
    if subject.forces is not None:
        return ("load_case",)
    return ("phi",) if subject.relative else ("tangential_force",)


def _load(subject: Subject, values: Values) -> tuple[Any, Any]:
    """Amplitudes in N and their weights, along a last axis; or a single amplitude and None."""
    if subject.forces is not None and subject.weights is not None:
        row, dtype = values["load_case"], jnp.asarray(values["normal_force"]).dtype
        return jnp.asarray(subject.forces, dtype)[row], jnp.asarray(subject.weights, dtype)[row]
    if subject.relative:
        return values["phi"] * values["friction"] * values["normal_force"], None
    return values["tangential_force"], None


# --- optima ---------------------------------------------------------------------------------------------------------


class _Field(NamedTuple):
    get: Callable[[Any], Array]
    unit: str
    description: str
    smooth: bool = True  # has derivatives


_DESCRIPTIONS = {
    "converged": "the search ended at a minimum",
    "certified": "converged, and nothing better was found",
    "proven": "nothing better can lie between the exponents that were scanned",
}


def _flags(*names: str) -> dict[str, _Field]:
    return {
        name: _Field(lambda found, name=name: getattr(found, name), "1", _DESCRIPTIONS[name], smooth=False)
        for name in names
    }


def _exponent_fields() -> dict[str, _Field]:
    def field(name: str, unit: str, description: str, *, smooth: bool = True) -> _Field:
        return _Field(lambda found: getattr(found, name), unit, description, smooth)

    unit = FRETTING["wear_volume"].scale or "1"
    return {
        "k": field("k", "1", "exponent k that wears least"),
        "wear_volume": field("wear_volume", unit, "least wear volume of any exponent"),
        "at_bound": field("at_bound", "1", "the best exponent lies on a bound", smooth=False),
        "rival": field("rival", "1", "exponent of the next best minimum", smooth=False),
        "rival_wear_volume": field("rival_wear_volume", unit, "wear volume there", smooth=False),
        **_flags("converged", "certified", "proven"),
    }


def _design_fields(subject: Subject) -> dict[str, _Field]:
    assert subject.design is not None
    vary = subject.design["vary"]
    window = "modulus" in vary
    moduli = ("shallow_modulus", "deep_modulus")
    names = {name: entry(name).words for name in (moduli if window else ())}
    names |= {name: AXES[name].description if name in AXES else entry(name).words for name in vary if name != "modulus"}
    kind = kind_of(subject.contact)
    given = subject.design.get("minimise") or OBJECTIVE[kind]
    objective = given if isinstance(given, str) else next(iter(given))
    law = QUANTITIES[kind].get(objective)

    def variable(name: str, description: str) -> _Field:
        return _Field(lambda found: found.variables[name], entry(name).unit, f"best {description}")

    return {
        **{name: variable(name, description) for name, description in names.items()},
        **({objective: _Field(lambda found: found.value, law.unit or "1", f"least {law.description}")} if law else {}),
        "saving": _Field(lambda found: found.saving, "1", f"share of the {objective} saved against the reference"),
        **_flags("converged", "certified", "proven"),
    }


def _of_record(
    stem: str, fields: Mapping[str, _Field], needs: tuple[str, ...], search: Callable[[Values], Any]
) -> Asked:
    head, _, name = stem.partition(".")
    if name not in fields:
        raise QuantityError(f"{one_line(stem)}: {head} has no such field{near_or_all(name, fields)}")
    field = fields[name]

    def evaluate(values: Values, memo: dict[Any, Any]) -> Array:
        if head not in memo:  # all fields of an optimum come from one search
            memo[head] = search(values)
        return field.get(memo[head])

    slopes = tuple(need for need in needs if need != "load_case") if field.smooth else ()
    equation = "28" if head == "optimal_exponent" else ""
    return Asked(stem, needs, slopes, evaluate, field.unit, field.description, equation)


def _optimum(subject: Subject, values: Values) -> optimise.OptimalExponent:
    return optimise.optimal_exponent(values["phi"], subject.bounds, digits=subject.digits)


def _designs(subject: Subject, values: Values) -> optimise.Designs:
    assert subject.design is not None
    force, weight = (None, None) if not _force_of(subject) else _load(subject, values)
    return optimise.designs(_contact(subject, values), force, weight=weight, **subject.design)
