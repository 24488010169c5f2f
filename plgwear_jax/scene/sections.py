"""The sections of an input file, whose keys `keys` has checked: what does not go together is refused here."""

import importlib
import json
import math
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Self

from plgwear_jax._core.words import near, one_line
from plgwear_jax.catalogue import Law, element, laws_of
from plgwear_jax.rules import (
    BY_THEN,
    OF_POWER_LAW,
    Complaint,
    Kind,
    complaint,
    domain_of,
    free_complaint,
    limited_quantity,
    placed_quantity,
    window_complaint,
)
from plgwear_jax.scene.complaints import OtherFileError, Reading, SceneError, WrongKeyError
from plgwear_jax.scene.keys import ELEMENTS, MATERIALS, SECTIONS

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.scene.solving import DisplacementEffect
    from plgwear_jax.tables import Table

LOADS = "tangential_force", "displacement", "table", "history"
COEFFICIENTS = "coefficient", "coefficient_mm3_per_N_m", "energy_coefficient_mm3_per_J"
PRESSED = "friction", "normal_force"
_CONTACTS: dict[Any, str] = {"fretting": "Fretting", "gross-slip": "GrossSlip"}
_FLAT = {"rounded_flat": "shapes.RoundedFlat", "truncated_sphere": "shapes.TruncatedSphere"}


def _from_table(form: Callable[[Any], Any], name: str, reading: Reading) -> "Table":
    """The content of a CSV file that a scene names; `form` takes the module `tables` and gives its form."""
    from plgwear_jax import tables  # imports NumPy, which a scene without files does not need

    try:
        return tables.read(reading.folder / name, form(tables))
    except tables.TableError as error:
        raise OtherFileError(str(error)) from None


# --- what touches ---------------------------------------------------------------------------------------------------


class Body(SimpleNamespace):
    """A half-space, an indenter, a shape or a contact, with the fields of its record as attributes.

    Attributes:
        record_name: The record of the library, with its module.
        kind: Of a half-space "power law", "table" or "layers", else the key of this name.
        fields: The fields of the record by name.
        file: The table that has them; None without one.
    """

    def __init__(self, record_name: str, kind: str, fields: Mapping[str, Any], file: "Table | None" = None) -> None:
        super().__init__(**fields, record_name=record_name, kind=kind, fields=fields, file=file)

    @property
    def words(self) -> str:
        """What messages call a half-space."""
        return self.kind if self.kind == "layers" else f"a {self.kind}"

    @property
    def rows(self) -> dict[str, Any]:
        """The rows of numbers of a half-space by name: thicknesses or depths, and moduli; none of a power law."""
        return {name: value for name, value in self.fields.items() if not isinstance(value, float | str)}

    def numbers(self) -> Iterator[str]:
        """The names of its single numbers, also of those of an elastic indenter or a shape."""
        for name, value in self.fields.items():
            if isinstance(value, Body):
                yield from (f"{name}.{inner}" for inner in value.numbers())
            elif isinstance(value, float):
                yield name

    def record(self, **others: Any) -> Any:
        """The record, with those fields that are told elsewhere. Imports JAX."""
        inner = {name: value.record() if isinstance(value, Body) else value for name, value in self.fields.items()}
        module, _, name = self.record_name.rpartition(".")
        return getattr(importlib.import_module(f"plgwear_jax.{module}"), name)(**inner | others)


def _body_of(reading: Reading, section: str, values: Mapping[str, Any]) -> Body:
    """What a section, or a key of [contact], describes; the file that it names is read from a folder."""
    fields, file = dict(values), None
    kind = fields.pop("kind", MATERIALS.get(section, ""))
    if "table" in fields:
        form, name = "HEIGHTS" if section == "Profile" else "MODULUS", fields.pop("table")
        file = _from_table(lambda tables: getattr(tables, form), name, reading)
        fields |= {"heights" if name == "height" else name: column for name, column in file.columns.items()}
    for name in ("indenter", "shape"):
        if name in fields:
            given = fields[name]
            fields[name] = _body_of(reading, *given) if isinstance(given, tuple) else None
    return Body(_FLAT.get(kind, SECTIONS[section].record), kind, fields, file)


def kind_of_material(given: Mapping[str, Any]) -> str:
    """Which of the materials a section means."""
    keys = {"table": "Tabulated", "thickness": "Layers", "modulus": "Layers"}
    return next((kind for key, kind in keys.items() if key in given), "Material")


def material_of(reading: Reading, section: str, values: Mapping[str, Any]) -> Body:
    """The section [material]."""
    if section == "Layers" and len(values["modulus"]) != len(values["thickness"]) + 1:
        layers, moduli = len(values["thickness"]), len(values["modulus"])
        text = f"must hold {layers + 1} moduli for {layers} thicknesses, the last one that of the substrate"
        raise WrongKeyError("modulus", f"{text}, not {moduli}")
    return _body_of(reading, section, values)


def kind_of_contact(given: Mapping[str, Any]) -> str:
    """Which contact a section means."""
    kind = given.get("kind")
    if not isinstance(kind, str) or kind not in _CONTACTS:
        raise WrongKeyError("kind", f'must be "fretting" or "gross-slip"{near(kind, _CONTACTS)}')
    return _CONTACTS[kind]


def contact_of(reading: Reading, section: str, values: Mapping[str, Any]) -> Body:
    """The section [contact]."""
    material = reading.material
    if section == "GrossSlip" and material is not None and material.kind != "power law":
        raise WrongKeyError("kind", f"needs a power law under [material], not {material.words}")
    if section == "Fretting" and math.isinf(values["friction"] * values["normal_force"]):
        raise WrongKeyError("friction", "times normal_force exceeds the range of numbers")
    return _body_of(reading, section, values)


# --- loads and wear -------------------------------------------------------------------------------------------------


def _one_of(values: Mapping[str, Any], names: tuple[str, ...], what: str) -> str:
    """The one of some keys that is there."""
    there = [name for name in names if values[name] is not None]
    if not there:
        raise WrongKeyError("", f"needs one of its keys {', '.join(names)}")
    if len(there) > 1:
        raise WrongKeyError(there[-1], f"cannot be combined with {there[0]}; only one of them can be the {what}")
    return there[0]


class LoadSection(SimpleNamespace):
    """The section [load] of a fretting contact: one amplitude, or a file of many.

    Attributes:
        tangential_force: Amplitude of the force in N.
        displacement: Amplitude of the displacement in m: that of the contact, or at the actuator of a rig whose
            stiffness is given. It stays constant over the cycles; the steady state is that of the force that it needs
            before any wear.
        table: CSV file of amplitudes with weights, for an uncertain load or many contacts.
        history: CSV file of amplitudes in their order, with a column cycles for wear over cycles.
        rig_stiffness: Stiffness in N/m of the rig, if displacements are measured at its actuator.
        file: What the file has.
        material: The half-space.
        contact: The contact.
        wear: How it wears; None if nothing says so.
    """

    @classmethod
    def of(cls, reading: Reading, _: str, values: Mapping[str, Any]) -> Self | None:
        """The load of the contact, if that is known; force amplitudes of gross slip are refused."""
        kind, contact = _one_of(values, LOADS, "load"), reading.contact
        if contact is None:
            return None
        if contact.kind != "fretting":
            raise WrongKeyError("", 'only a contact with kind = "fretting" has a tangential force')
        limit: Any = contact.friction * contact.normal_force
        force, named = values["tangential_force"], values["table"] or values["history"]
        if force is not None and not force < limit:
            text = f"this is gross slip, F_x = {force:g} N is not below mu F_N = {limit:g} N"
            raise WrongKeyError(kind, f"{text}; lower it, or raise friction or normal_force")
        file = None
        if named is not None:
            file = _from_table(lambda tables: tables.LOADS if kind == "table" else tables.HISTORY, named, reading)
        found = cls(**values, file=file, material=reading.material, contact=contact, wear=reading.wear)
        if file is not None and not found.of_displacement:
            forces = file["tangential_force"]
            own: dict[str, Any] = {name: getattr(contact, name) + 0.0 * forces for name in PRESSED} | found.pressed
            limit, text = own["friction"] * own["normal_force"], "this is gross slip, it must be below mu F_N ="
            try:
                file.refuse(
                    ~(forces < limit), lambda i: f"tangential_force = {float(forces[i])}: {text} {limit[i]:g} N"
                )
            except ValueError as error:
                raise OtherFileError(str(error)) from None
        return found

    @cached_property
    def rows(self) -> "Table":
        """The content of the file, or the one amplitude as a table of one row."""
        if self.file is not None:
            return self.file
        import numpy as np

        from plgwear_jax.tables import Table

        name = "tangential_force" if self.displacement is None else "displacement"
        return Table("[load]", {name: np.array([getattr(self, name)], float)}, np.zeros(1, int))

    @property
    def of_displacement(self) -> bool:
        """The amplitudes are those of the displacement."""
        return self.displacement is not None or (self.file is not None and "displacement" in self.file.columns)

    @property
    def given(self) -> "np.ndarray":
        """The amplitudes as they were given, in N or m, shape (n,): the one, or all of a history or a table."""
        return self.rows["displacement" if self.of_displacement else "tangential_force"]

    @property
    def cycles(self) -> "np.ndarray | None":
        """How many cycles each amplitude of a history lasts, shape (n,); None if nothing says so."""
        return None if self.file is None else self.file.columns.get("cycles")

    @property
    def pressed(self) -> "dict[str, np.ndarray]":
        """The normal forces in N and the coefficients of friction that a history has of its own, each of shape (n,)."""
        own = {} if self.file is None else self.file.columns
        return {name: own[name] for name in reversed(PRESSED) if name in own}

    @property
    def is_zero(self) -> bool:
        """Nothing moves, and so nothing wears."""
        if self.file is None:
            return not (self.tangential_force or self.displacement)
        return not (self.given * self.file.columns.get("weight", 1.0)).any()

    def record(self) -> Any:
        """The load of a test over cycles: an amplitude, or the blocks of a history."""
        from plgwear_jax import loads

        kind = loads.Displacement if self.of_displacement else loads.Force
        every = [kind(amplitude, self.rig_stiffness) for amplitude in self.given.tolist()]
        if self.cycles is None:
            return every[0]
        names, columns = [*self.pressed], [self.cycles, *self.pressed.values()]
        rows = zip(every, *(column.tolist() for column in columns), strict=True)
        return [loads.Block(load, cycles, **dict(zip(names, own, strict=True))) for load, cycles, *own in rows]

    @cached_property
    def moved(self) -> "DisplacementEffect":
        """What the displacements of `given` do to the unworn contact."""
        from plgwear_jax.scene import solving

        assert self.material is not None
        pressed = solving.homogeneous(self.contact.record(material=self.material.record(), **self.pressed))
        return solving.displacement_effect(pressed, self.given, self.rig_stiffness)

    @property
    def in_gross_slip(self) -> "np.ndarray":
        """Which amplitudes of `given` make the unworn contact slip as a whole, shape (n,)."""
        import numpy as np

        return ~(self.given < np.asarray(self.moved.gross_slip if self.of_displacement else math.inf))

    @cached_property
    def forces(self) -> "np.ndarray":
        """The force amplitudes in N of `given`, shape (n,), or a SceneError where the contact slips as a whole."""
        if self.pressed:
            text = f"changes {' and '.join(self.pressed)}, so that no amplitude decides the steady state"
            raise SceneError(f"[load] history: {text}; only plgwear wear takes it")
        if not self.of_displacement:
            return self.given
        import numpy as np

        (beyond,) = np.nonzero(self.in_gross_slip)
        if not beyond.size:
            return np.asarray(self.moved.force)
        first, rows, wear = beyond[0], self.rows, self.wear
        work = self.contact.normal_force * float(np.asarray(self.moved.path)[first])
        worn = f"{work:.4g} N m times the wear coefficient"
        if wear is not None and wear.exponent is None:
            worn = f"{wear.archard(self.contact.friction) * work:.4g} m^3"
        said = (
            f"displacement = {self.given[first]:g}: this is gross slip, from {float(self.moved.gross_slip):.4g} m on "
            f"the {'contact' if self.rig_stiffness is None else 'rig'} slips as a whole; by Archard's law such sliding "
            f"wears {worn} a cycle at first; plgwear wear follows it over the cycles"
        )
        if self.file is None:
            raise SceneError(f"[load] {said}")
        raise OtherFileError(f"{rows.name}: row {rows.row[first]}: {said}")

    @property
    def amplitudes(self) -> "np.ndarray":
        """Amplitudes in N, shape (n,): the one amplitude, all of a history, or those of a table with weight > 0."""
        weight = self.rows.columns.get("weight")
        return self.forces if weight is None else self.forces[weight > 0.0]

    @property
    def weights(self) -> "np.ndarray | None":
        """Weights of the amplitudes of a table, > 0, shape (n,), with the sum 1; None if there is no table."""
        if self.table is None:
            return None
        from plgwear_jax.optimise.scenarios import shares

        weight = self.rows["weight"]
        return shares(weight[weight > 0.0])

    @property
    def largest(self) -> float:
        """The largest amplitude in N: it determines the worn state of a history, and the worst case of a table."""
        return float(self.amplitudes.max())

    @property
    def force(self) -> "float | np.ndarray":
        """What enters a computation, in N: one amplitude, the largest of a history, or the amplitudes of a table."""
        return self.largest if self.table is None else self.amplitudes

    @property
    def remark(self) -> str | None:
        """The line that says which amplitude of a history counts, and which force goes with a displacement, or None."""
        if self.pressed or (self.displacement is None and self.history is None):
            return None
        if self.history is not None:
            number = f"{self.forces.size} amplitude{'s' if self.forces.size > 1 else ''}"
            row = self.rows.row[self.forces.argmax()]
            deciding = f"the largest, {self.largest:g} N (row {row}), decides the worn state"
            return f"history {one_line(self.history)}: {number}; {deciding}"
        told = f"the contact slips as a whole, from {float(self.moved.gross_slip):.4g} m on"
        if not self.in_gross_slip.any():
            told = f"a force amplitude of {self.largest:.4g} N before wear"
        return f"displacement {self.displacement:g} m{'' if self.rig_stiffness is None else ' of the rig'}: {told}"


class WearSection(SimpleNamespace):
    """The section [wear]: how fast the contact wears, by default by Archard's law, and for how long.

    Attributes:
        coefficient: Worn volume over normal force and sliding distance, in 1/Pa = m^3/(N m); with an exponent in
            1/Pa^exponent.
        coefficient_mm3_per_N_m: The same in mm^3/(N m).
        energy_coefficient_mm3_per_J: Worn volume over the energy of friction, in mm^3/J.
        exponent: Exponent of the pressure in the wear law; left out, it is 1, Archard's law.
        half_space_coefficient: Coefficient of the half-space in 1/Pa, or 1/Pa^exponent, if it wears too; `coefficient`
            is then that of the indenter.
        cycles: Number of cycles of the life.
    """

    @classmethod
    def of(cls, reading: Reading, _: str, values: Mapping[str, Any]) -> Self:
        """The wear of the contact, if that is known."""
        kind, found, contact = _one_of(values, COEFFICIENTS, "wear coefficient"), cls(**values), reading.contact
        for name in found.others:
            if kind != "coefficient":
                raise WrongKeyError(name, f"cannot be combined with {kind}; give coefficient, in 1/Pa or 1/Pa^exponent")
        if contact is not None and contact.kind != "fretting":
            raise WrongKeyError("", 'only a contact with kind = "fretting" wears over cycles')
        return found

    @property
    def others(self) -> list[str]:
        """The keys that only some commands take."""
        return [name for name in ("exponent", "half_space_coefficient") if getattr(self, name) is not None]

    def archard(self, friction: float) -> float:
        """Archard's wear coefficient in 1/Pa; from an energy coefficient it is that times the coefficient of friction.

        Args:
            friction: The coefficient of friction.

        Raises:
            SceneError: The section has another wear law, or wear of the half-space.
        """
        for name in self.others:
            raise SceneError(f"[wear] {name} = {getattr(self, name):g}: only plgwear wear takes it")
        return self._indenter(friction)

    def _indenter(self, friction: float) -> float:
        if self.coefficient is not None:
            return self.coefficient
        return (self.coefficient_mm3_per_N_m or friction * (self.energy_coefficient_mm3_per_J or 0.0)) / 1e9

    @property
    def half_space_share(self) -> float:
        """The share of the half-space in all wear."""
        own = self.half_space_coefficient or 0.0
        return own and own / (self._indenter(0.0) + own)

    def record(self, friction: float) -> Any:
        """The wear law; its coefficient is the sum over both bodies."""
        from plgwear_jax.wear_laws import law_of

        return law_of(self._indenter(friction) + (self.half_space_coefficient or 0.0), self.exponent)


# --- designs --------------------------------------------------------------------------------------------------------


def _window_of(key: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """The lowest and highest modulus that can be made, at two depths or more: at, lower, upper."""
    at, between = values["at"], values["between"]
    if len(at) != len(between):
        text = f"must hold a pair [lower, upper] for each of the {len(at)} depths of at"
        raise WrongKeyError(f"{key}.between", text)
    if "steepness" in values and len(at) == 2:
        text = "only for a free gradient, with three to eight depths; at two it is |k|"
        raise WrongKeyError(f"{key}.steepness", text)
    return dict(zip(("at", "lower", "upper"), (at, *zip(*between, strict=True)), strict=True))


class DesignSpace(SimpleNamespace):
    """The section [design]: what may vary, the constraint, what is minimised, over which loads, within which limits.

    Attributes:
        variables: What may vary: bounds by name, such as k and indenter.E; for "modulus" the depths at, and the lower
            and upper moduli there: at two depths of a power law, at three to eight a free gradient.
        steepness: The largest |log(E2/E1)/log(z2/z1)| between depths of a free gradient; None without a limit.
        hold: What is kept equal to the reference: the initial contact radius, by adjusting E0.
        minimise: The quantity that is minimised, with its place if it has one.
        level: The mean is taken over the worst 1 - level of the load: 0 is the mean of all, 1 the worst case.
        scenarios: A CSV file of what the contact may turn out to be.
        scatter: The scenarios; None without.
        allowed: The limits by name: above, below or between with the place, or the window; None without any.
    """

    @classmethod
    def of(cls, reading: Reading, _: str, values: Mapping[str, Any]) -> Self:
        """The design space of the contact, as far as that is known."""
        material, contact, load, wear = reading.material, reading.contact, reading.load, reading.wear
        variables, allowed = {}, dict(values["limits"] or {})
        for name, given in values["vary"].items():
            if name == "modulus":
                variables[name] = _window_of("vary.modulus", given)
                if len(given["at"]) == 2 and (said := window_complaint(**variables[name])) is not None:
                    raise WrongKeyError("vary.modulus.between", said)
            else:
                inner = (
                    {f"{name}.{one}": ends for one, ends in given.items()} if isinstance(given, dict) else {name: given}
                )
                variables |= inner
        if "modulus" in allowed:
            allowed["modulus"] = _window_of("limits.modulus", allowed["modulus"])
            if len(allowed["modulus"]["at"]) > 2:
                text = "must be [z1, z2]: a limit is at two depths; vary the modulus for a free gradient"
                raise WrongKeyError("limits.modulus.at", text)
        over = values["over"]
        found = cls(
            variables=variables,
            steepness=values["vary"].get("modulus", {}).get("steepness"),
            allowed=allowed or None,
            level=over[1]["cvar"] if isinstance(over, tuple) else float(over == "worst"),
            **{name: values[name] for name in ("hold", "minimise", "scenarios")},
            scatter=None,
        )
        lasts = wear is not None and found.objective in BY_THEN
        if load is not None and load.pressed and not (lasts and load.cycles is not None):
            text = "a design cannot be combined with a history that changes the normal force or the friction"
            raise WrongKeyError("", f"{text}, unless it is for the wear of its cycles, with [wear]")
        found._refuse(getattr(contact, "kind", None), getattr(material, "k", None) == 0.0)
        if material is None or contact is None:
            return found
        found._refuse_to_vary(material, contact, load)
        known = "load" not in reading.wrong
        if over is not None and found.scenarios is None and known and (load is None or load.table is None):
            text = "only for a load with a table, which gives the amplitudes and their weights, or for scenarios"
            raise WrongKeyError("over", text)
        if found.scenarios is not None:
            names = [*material.numbers(), *contact.numbers()]
            names += [f"material.{name}[{i}]" for name, row in material.rows.items() for i in range(len(row))]
            names += ["wear_coefficient"] if wear is not None and wear.cycles is not None else []
            columns = {name: domain_of(name) for name in names}
            found.scatter = _from_table(lambda tables: tables.scenarios(columns), found.scenarios, reading)
        return found

    @property
    def edge_distance(self) -> float | None:
        """Distance in m inside the stick-slip boundary at which the pressure is limited; None without this limit."""
        allowed = self.allowed or {}
        return next((allowed[name].get("distance") for name in ("edge_pressure", "pressure") if name in allowed), None)

    @property
    def free(self) -> bool:
        """The modulus is free at three depths or more: no power law is asked for."""
        return "modulus" in self.variables and len(self.variables["modulus"]["at"]) > 2

    @property
    def objective(self) -> str:
        """The quantity that is minimised."""
        return self.minimise if isinstance(self.minimise, str) else next(iter(self.minimise), "")

    def _refuse(self, kind: Kind | None, flat: bool) -> None:
        """Refuse what a design cannot have, for a contact of a kind, if known, and a material with k = 0 or not."""
        places = {} if isinstance(self.minimise, str) else self.minimise.get(self.objective, {})
        if not isinstance(self.minimise, str) and len(self.minimise) != 1:
            raise WrongKeyError("minimise", "must name one quantity")
        allowed = self.allowed or {}
        found = placed_quantity("minimise", self.objective, places, kind)
        for name, given in allowed.items():
            one = None if name == "modulus" else limited_quantity(name, given, kind)
            found = one if isinstance(found, str) and isinstance(one, Complaint) else found
        if isinstance(found, str) and not self.free:
            found = complaint(self.variables, bool(self.hold), found, [*allowed], kind=kind, flat=flat)
        elif isinstance(found, str):
            found = free_complaint(self.variables, bool(self.hold), [*allowed], kind=kind)
            if found is None and self.scenarios is not None:
                found = Complaint("scenarios", "cannot be combined with a free gradient; only a power law takes it")
        if found is not None:
            # the places of what is minimised have no keys of their own
            raise WrongKeyError("minimise" if found.key.startswith("minimise") else found.key, found.text)

    def _refuse_to_vary(self, material: Body, contact: Body, load: LoadSection | None) -> None:
        """Refuse what needs a power law, bounds of what this contact does not have, and of what slips as a whole."""
        if not self.free and material.kind != "power law":
            asked = [f"vary.{name}" for name in self.variables if name in (*OF_POWER_LAW, "modulus")]
            asked += ["hold"] * (self.hold is not None) + ["limits.modulus"] * ("modulus" in (self.allowed or {}))
            if asked:
                raise WrongKeyError(asked[0], f"needs a power law under [material], not {material.words}; {_INSTEAD}")
        for name in self.variables:
            first = name.partition(".")[0]
            missing = {"indenter": "rigid indenter", "shape": "parabola"}.get(first)
            if missing is not None and getattr(contact, first, None) is None:
                raise WrongKeyError(f"vary.{first}", f"the contact has a {missing}")
            if first == "material":
                table, place = element(name.removeprefix("material."))
                found = len(material.rows.get(table, ()))
                if place is None or place >= found:
                    has = f"has {found} of {table}" if found else f"has no {table}"
                    text = f"there is no such number: [material], {material.words}, {has}"
                    raise WrongKeyError(f"vary.{name}", text)
            elif first not in (*OF_POWER_LAW, "nu", "modulus", *contact.fields):
                raise WrongKeyError(f"vary.{name}", f"is no number of a {contact.kind} contact")
        if "nu" in self.variables and isinstance(material.nu, str):
            raise WrongKeyError("vary.nu", 'follows from k, as [material] nu = "holl"; give it a number')
        varied = [name for name in PRESSED if name in self.variables]
        if varied and load is not None and not (load.of_displacement or load.pressed):
            lowest = (self.variables[name][0] if name in varied else getattr(contact, name) for name in PRESSED)
            if not load.largest < math.prod(lowest):
                text = f"at the lowest {' and '.join(varied)} the whole contact slips"
                raise WrongKeyError(f"vary.{varied[0]}", text)


_INSTEAD = (
    f"vary {' and '.join(map(json.dumps, ELEMENTS))} and so on, "
    "or give three depths or more in vary.modulus for a free gradient"
)


# --- what is asked for ------------------------------------------------------------------------------------------------


def output_of(reading: Reading, _: str, values: Mapping[str, Any]) -> SimpleNamespace:
    """The section [output]: names of quantities of the contact, if that is known."""
    output, contact = SimpleNamespace(**values), reading.contact
    for name in output.quantities:
        if output.quantities.count(name) > 1:
            raise WrongKeyError("quantities", f'"{name}" is asked for more than once')
    if contact is None:
        return output
    laws = laws_of_scene(contact, reading.load, reading.wear)
    for name in output.quantities:
        if name not in laws:
            text = f'"{one_line(name)}" is not a quantity of a {contact.kind} contact'
            raise WrongKeyError("quantities", f"{text}; allowed are {', '.join(laws)}{near(name, laws)}")
        nowhere = "design" not in reading.wrong and edge_distance(reading.design, output) is None
        if "distance" in laws[name].arguments and nowhere:
            text = f'"{name}" needs a distance from the stick-slip boundary'
            raise WrongKeyError("quantities", f"{text}; give it in m, as distance = 1e-6 under [output]")
    return output


def laws_of_scene(contact: Body, load: LoadSection | None, wear: WearSection | None) -> dict[str, Law]:
    """What a scene can be asked for: over cycles it takes a life, other than that of a history."""
    lasts = wear is not None and wear.cycles is not None and (load is None or load.history is None)
    given = {"r", "distance", "F_x", *(("cycles", "wear_coefficient") if lasts else ())}
    return {name: law for name, law in laws_of(contact).items() if given.issuperset(law.arguments)}


def edge_distance(design: DesignSpace | None, output: SimpleNamespace | None) -> float | None:
    """The distance from the edge at which a scene wants pressures, in m; None if it gives none."""
    if output is not None and output.distance is not None:
        return output.distance
    return None if design is None else design.edge_distance
