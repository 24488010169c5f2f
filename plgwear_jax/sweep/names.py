"""The quantities of a sweep: names of quantities, their derivatives and designs are made into functions of the axes.

A name is that of a function (`wear_volume`, `gross_slip.force_ratio`), with a contact any of the catalogue, or that of
a field of an optimum (`optimal_exponent.k`, `design.saving`). The variables to differentiate by follow it
(`wear_volume.dk`, `wear_volume.dk.dphi`, `wear_volume.dindenter.E`).
"""

import dataclasses
import functools
import inspect
import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax import fretting, gross_slip, material, optimise, partial_slip
from plgwear_jax._core.catalogue import (
    AMPLITUDES,
    AXES,
    FRETTING,
    GROSS_SLIP,
    MATERIAL,
    TANGENTIAL,
    Law,
    derivative,
    entry,
    kind_of,
    laws_of,
    leaf,
    quantity,
    read,
)
from plgwear_jax._core.leaves import leaf_of, paths_of, with_leaf
from plgwear_jax._core.rules import OBJECTIVE, PLACES
from plgwear_jax._core.units import text_cells
from plgwear_jax._core.words import GivenError, near, near_or_all, one_line
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.loads import Force, Load
from plgwear_jax.optimise.question import needs_force, never_steady
from plgwear_jax.special.elementary import value_with_slope


class QuantityError(GivenError):
    """Why a quantity cannot be computed, in one line that begins with its name."""


class AxisNames:
    """What a contact and its load have by the names of axes: `k` is `material.k`, `load[0].cycles` that of a block.

    Args:
        contact: The contact; None for the dimensionless functions.
        load: Its load, or one of that kind whose numbers are replaced.

    Attributes:
        paths: The path in the contact of each of its numbers, by all names that it has.
        own: The values in the contact, an array as a whole: those of the material without `material.`, if the catalogue
            has them.
        load: The load.
        held: It, if it is the `Blocks` of a test, whose numbers are inputs; None under one amplitude.
        of_load: The path in the load of each of its numbers, by name.
        allowed: All names; elements of an array are one.
    """

    def __init__(self, contact: Any, load: Any) -> None:
        leaves, nu = paths_of(contact), getattr(getattr(contact, "material", None), "nu", None)
        leaves |= {"material.nu": nu} if isinstance(nu, str) else {}  # Holl's ratio is no leaf for JAX
        self.paths, self.own, self.load, self.held = {}, {}, load, None if load.lasts else load
        for path, value in leaves.items():
            name = path.removeprefix("material.")
            name = path if path in AXES or name in leaves else name
            for place in [f"[{i}]" for i in range(np.shape(value)[-1])] if np.ndim(value) else [""]:
                self.paths |= dict.fromkeys((name + place, path + place), path + place)
            self.own[name if name in AXES else path] = value
        self.of_load = {
            path.removesuffix("_amplitude") if load.lasts else f"load{path.removeprefix('of')}": path
            for path in paths_of(load, lambda one: one is None)
        }
        self.allowed = [f"{name}[i]" if np.ndim(value) else name for name, value in self.own.items()]
        arguments = ["k", "phi", "nu", "r", "distance"] if contact is None else ["r", "z"]
        if isinstance(contact, FrettingContact):
            arguments = *reversed(AMPLITUDES), "rig_stiffness", "factor", *PLACES, "cycles", "wear_coefficient", "share"
        self.allowed += arguments


@dataclasses.dataclass(frozen=True, eq=False, kw_only=True)
class SweepTarget:
    """The contact and its loads.

    Attributes:
        contact: The contact of which quantities are asked; None for the dimensionless functions.
        known: The names of its numbers, and of those of its load.
        inputs: The inputs of the load: one of `AMPLITUDES` or "load_case", "rig_stiffness", "factor", "load[0].cycles".
        amplitudes: Those in N of each load and their weights, each of shape (loads, n), padding without weight at the
            end; None without loads.
        design: Further arguments of `optimise.designs`; None if no design can be asked for.
        bounds: Of `optimal_exponent`.
        digits: Correct digits wanted.
        fixed: The inputs with a single value, by name; the text "holl" for Holl's ratio.
        dtype: float64 or float32.
    """

    contact: FrettingContact | GrossSlipContact | None
    known: AxisNames
    inputs: tuple[str, ...]
    amplitudes: tuple[np.ndarray, np.ndarray] | None
    design: Mapping[str, Any] | None
    bounds: tuple[float, float]
    digits: int | None
    fixed: Mapping[str, Any]
    dtype: np.dtype

    @property
    def holl(self) -> bool:
        """Poisson's ratio is Holl's, and so not a number."""
        return any(isinstance(value, str) for value in self.fixed.values())

    @property
    def numeric(self) -> bool:
        """The contact has no closed forms."""
        return isinstance(self.contact, FrettingContact) and not is_closed(self.contact)

    @property
    def for_life(self) -> bool:
        """Designs are those of a life."""
        return (self.design or {}).get("law") is not None

    @property
    def marched(self) -> bool:
        """What is over cycles has the two digits of a march."""
        return self.known.held is not None or "displacement" in self.inputs

    @property
    def slow(self) -> bool:
        """Each point takes milliseconds: the contact has no closed forms, or a test or a life is followed."""
        return self.numeric or self.marched or self.for_life

    def digits_of(self, name: str) -> str:
        """The correct digits of a quantity."""
        head = name.split(".")[0]
        lasts = head == "transient" or (head == "design" and self.for_life)
        usual = ("2" if self.marched else "4") if lasts else "4" if self.numeric else f"all of {self.dtype}"
        return str(self.digits or usual)


@dataclasses.dataclass(eq=False)
class SweepPoints:
    """Points of a sweep: the contact and its load there, and what quantities that share them have solved.

    Attributes:
        subject: The contact and its loads.
        values: Those of the axes and of the fields by name, which broadcast; "load_case" holds row numbers.
        solved: Results that quantities share.
    """

    subject: SweepTarget
    values: Mapping[str, Any]
    solved: dict[Any, Any] = dataclasses.field(default_factory=dict)

    @functools.cached_property
    def contact(self) -> Any:
        """The contact with these values of its leaves."""
        return _with_values(self.subject.contact, self.subject.known.paths, self.values)

    @functools.cached_property
    def load(self) -> tuple[Load, Any]:
        """The load, and the weights of its amplitudes or None; several amplitudes have a first axis of their own."""
        subject, values, weight = self.subject, dict(self.values), None
        if "phi" in values:
            values["tangential_force"] = values["phi"] * self.contact.friction * self.contact.normal_force
        if subject.amplitudes is not None:
            tables = (jnp.asarray(table.T, subject.dtype) for table in subject.amplitudes)
            values["tangential_force"], weight = (table[:, values["load_case"]] for table in tables)
        load = _with_values(subject.known.load, subject.known.of_load, values)
        if "factor" in values:
            load = load.with_amplitude(lambda amplitude: values["factor"] * amplitude)
        return load, weight

    @functools.cached_property
    def optimum(self) -> Mapping[str, Array]:
        """The fields of the best exponents, or of the best designs with what varies."""
        subject, values = self.subject, self.values
        if subject.contact is None:
            return vars(optimise.optimal_exponent(values["phi"], subject.bounds, digits=subject.digits))
        asked = {name: values.get(name, one) for name, one in (subject.design or {}).items()}
        if "law" in asked:
            asked["law"] = values.get("wear_coefficient", asked["law"])
            asked["cycles"] = asked.get("cycles", values.get("cycles"))
        load, weight = self.load if subject.inputs else (None, None)
        if load is not None and asked.get("cycles") is None:
            load = self.contact.steady(load).tangential_force
        if weight is not None:  # of designs along the last axis
            load, weight = jax.tree.map(lambda x: jnp.moveaxis(x, 0, -1), (load, weight))
        found = optimise.designs(self.contact, load, weight=weight, **asked)
        return vars(found) | found.variables


def _with_values(record: Any, paths: Mapping[str, str], values: Mapping[str, Any]) -> Any:
    """The record with those values for whose names it has paths."""
    for name, path in paths.items():
        if name in values:
            record = with_leaf(record, path, values[name])
    return record


class SweepQuantity(NamedTuple):
    """One quantity.

    Attributes:
        name: As it was asked for.
        needs: The axes or fields that need a value.
        evaluate: The quantity at points.
        unit: Of the quantity.
        description: What it is, in words.
        equation: Its number in the paper; empty for designs.
        smooth: It has derivatives.
    """

    name: str
    needs: tuple[str, ...]
    evaluate: Callable[[SweepPoints], Array]
    unit: str
    description: str
    equation: str = ""
    smooth: bool = True


def variable_name(quantity: str) -> str:
    """The name of a quantity in a dataset, which can be an attribute in Python: `wear_volume_dk`."""
    return re.sub(r"\W+", "_", quantity).strip("_")


def axis_unit(axis: str, contact: object | None) -> str:
    """The unit of an axis."""
    kind = leaf(axis)
    return kind.unit if contact is not None else kind.scale or kind.unit


def label_of(name: str) -> str:
    """What a quantity is called in pictures, with its symbol in TeX."""
    stem, slopes = derivative(name)
    head, _, tail = stem.partition(".")
    stem = tail if head in ("optimal_exponent", "design") else stem
    known = quantity(stem) or leaf(stem)
    words, symbol = known.name.replace("_", " "), known.symbol
    if stem == tail and symbol:
        words, symbol = (f"least {words}", symbol) if isinstance(known, Law) else (f"best {words}", f"{symbol}^*")
    if slopes:
        power = f"^{len(slopes)}" if len(slopes) > 1 else ""
        below = r"\,".join(rf"\partial {leaf(slope).symbol or slope.replace('_', ' ')}" for slope in slopes)
        words, symbol = f"derivative of {words}", rf"\partial{power} {symbol}/({below})"
    return f"{words} ${symbol}$" if symbol else words


# --- names ----------------------------------------------------------------------------------------------------------


def resolve(name: str, subject: SweepTarget) -> SweepQuantity:
    """The quantity of this name.

    Raises:
        QuantityError: There is none.
    """
    stem, slopes = derivative(name)
    (head, _, tail), contact = stem.partition("."), subject.contact
    if head == ("optimal_exponent" if contact is None else "design"):
        known = {stem: _of_optimum(name, head, tail, subject)}
    elif contact is None:
        known = _functions(subject)
    else:
        known = {one: _of_contact(one, law, subject) for one, law in laws_of(contact).items()}
    if stem == SLIPS and "displacement" in subject.inputs:
        onset = known["gross_slip_displacement"].evaluate
        known[stem] = SweepQuantity(
            stem,
            subject.inputs,
            lambda points: ~(points.values["displacement"] < onset(points)),
            "1",
            "the whole contact slips before any wear",
            smooth=False,
        )
    if stem not in known:
        by = near_or_all(stem, known)
        if contact is None and (head in ("transient", "design") or stem in FRETTING):
            by = "; it is that of a contact, as an input file gives it (--scene)"
        elif head in known and tail and not near(stem, known):
            by = f"; {head} has derivatives by {', '.join('d' + axis for axis in _slopes_of(known[head], subject))}"
        raise QuantityError(f"{one_line(name)}: there is no such quantity{by}")
    if subject.known.held is not None and needs_force(stem):
        raise QuantityError(f"{stem}: {never_steady(subject.known.held)}")
    asked = known[stem]
    for slope in slopes:
        asked = _differentiated(asked, slope, subject)
    return asked._replace(name=name)


def _functions(subject: SweepTarget) -> dict[str, SweepQuantity]:
    """The dimensionless functions, by name and by that with their room."""
    found = {}
    for module, laws in (
        (fretting, FRETTING),
        (partial_slip, TANGENTIAL),
        (gross_slip, GROSS_SLIP),
        (material, MATERIAL),
    ):
        for name, law in laws.items():
            function = getattr(module, name, None) or getattr(module, f"steady_{name}", None)
            if function is None:
                continue
            parameters = inspect.signature(function).parameters.values()
            needs = tuple(one.name for one in parameters if one.default is one.empty)
            one = SweepQuantity(
                name,
                needs,
                lambda points, function=function, needs=needs: function(
                    *(points.values[name] for name in needs), digits=subject.digits
                ),
                law.scale or "1",
                law.description,
                law.equation,
            )
            found.setdefault(name, one)
            found[f"{module.__name__.rpartition('.')[2]}.{name}"] = one
    return found


def _of_contact(name: str, law: Law, subject: SweepTarget) -> SweepQuantity:
    moved, rig = "F_x" in law.arguments, "rig_stiffness"
    told = "F_x", *(["cycles"] if subject.known.held else [])  # by the load; blocks have cycles of their own
    given = tuple(argument for argument in law.arguments if argument not in told)
    # a rig counts without an amplitude too: where gross slip begins at its actuator
    at_rest = [rig] * (rig in subject.inputs and name.startswith("gross_slip_"))
    digits = min(subject.digits or 2, 2) if subject.marched and "wear_coefficient" in given else subject.digits

    def evaluate(points: SweepPoints) -> Array:
        load, weight = points.load if moved else (Force(0.0, points.values.get(rig)), None)
        found = read(points.contact, name, load, points.values, digits=digits, solved=points.solved)
        return found if weight is None else jnp.sum(jnp.where(weight > 0.0, weight * found, 0.0), axis=0)

    mean = "mean over the load of: " if moved and subject.amplitudes is not None else ""
    needs = *given, *(subject.inputs if moved else at_rest)
    return SweepQuantity(name, needs, evaluate, law.unit, f"{mean}{law.description}", law.equation)


def _differentiated(asked: SweepQuantity, by: str, subject: SweepTarget) -> SweepQuantity:
    path, slopes = subject.known.paths.get(by, ""), _slopes_of(asked, subject)
    if not (by in slopes or (path and slopes and not (subject.holl and path == "material.nu"))):
        have = f"; it has those by {', '.join(slopes)}" if slopes else ""
        raise QuantityError(f"{asked.name}: has no derivative by {by}{have}")

    def evaluate(points: SweepPoints) -> Array:
        values = points.values
        name = next((one for one in values if subject.known.paths.get(one) == path), by)
        x = jnp.asarray(values[name] if name in values else leaf_of(subject.contact, path))
        return value_with_slope(lambda x: asked.evaluate(SweepPoints(subject, {**values, name: x})), x)[1]

    unit, below = asked.unit, axis_unit(by, subject.contact)
    if below.startswith("1/"):
        unit = f"{unit} {below[2:]}"
    elif below != "1":
        unit = f"{f'({unit})' if '/' in unit else unit}/{below}"
    return asked._replace(
        name=f"{asked.name}.d{by}",
        evaluate=evaluate,
        unit=unit,
        description=f"derivative by {by} of: {asked.description}",
    )


SLIPS = "gross_slip"  # the quantity that every sweep under a displacement has


def _slopes_of(asked: SweepQuantity, subject: SweepTarget) -> list[str]:
    """What a quantity can be differentiated by: numbers that it needs, and those of the contact."""
    numbers = [name for name, value in subject.known.own.items() if not np.ndim(value)]
    left_out = {"load_case", "nu"} if subject.holl else {"load_case"}
    return [name for name in (*asked.needs, *numbers) if asked.smooth and name not in left_out]


# --- optima ---------------------------------------------------------------------------------------------------------


# Fields of an optimum: name, unit, and what it is.
_FLAGS = """
    converged                  1  the search ended at a minimum
    certified                  1  converged, and nothing better was found
    scan_found_nothing_better  1  nothing better is expected between the exponents (curvature estimated, not bounded)
"""
_EXPONENT = """
    k                  1        exponent k that wears least
    wear_volume        a_0^4/R  least wear volume of any exponent
    at_bound           1        the best exponent lies on a bound
    rival              1        exponent of the next best minimum
    rival_wear_volume  a_0^4/R  wear volume there
"""
_SMOOTH = "k", "wear_volume"


def _of_optimum(stem: str, head: str, field: str, subject: SweepTarget) -> SweepQuantity:
    """A field of the best exponents or designs, which all come from one search."""
    given, objective = None if subject.contact is None else subject.design, ""
    if subject.contact is None:
        rows = [*text_cells(_EXPONENT)]
    elif given is None:
        raise QuantityError(f"{one_line(stem)}: needs to be told what may vary (design=, or a scene with [design])")
    else:
        minimised = given.get("minimise") or OBJECTIVE[kind_of(subject.contact)]
        objective = minimised if isinstance(minimised, str) else next(iter(minimised))
        rows = [[name, leaf(name).unit, f"best {leaf(name).description}"] for name in given["vary"]]
        rows += [
            [objective, entry(objective).unit, f"least {entry(objective).description}"],
            ["saving", "1", f"share of the {objective} saved against the reference"],
        ]
    fields = {name: about for name, *about in [*rows, *text_cells(_FLAGS)]}
    if field not in fields:
        raise QuantityError(f"{one_line(stem)}: {head} has no such field{near_or_all(field, fields)}")

    needs, equation = (("phi",), "28") if given is None else (subject.inputs, "")
    smooth = given is None and field in _SMOOTH
    key, (unit, about) = "value" if field == objective else field, fields[field]
    return SweepQuantity(f"{head}.{field}", needs, lambda points: points.optimum[key], unit, about, equation, smooth)
