"""The sections of an input file, whose keys `keys` has checked: what does not go together is refused here."""

import math
import pkgutil
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Self

from plgwear_jax._core.catalogue import Law, laws_of, leaf
from plgwear_jax._core.rules import (
    BY_THEN,
    LASTING,
    OF_POWER_LAW,
    ON_K_ALONE,
    PLACES,
    WITHIN,
    WrongKeyError,
    exponents_within,
    limited_quantity,
    placed_quantity,
    refuse_question,
)
from plgwear_jax._core.units import written
from plgwear_jax._core.words import near_or_all, one_line

from .keys import MATERIALS, SECTIONS, KeyValues, OtherFileError, Reading, SceneError

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.tables import Table

LOADS = "tangential_force", "displacement", "table", "history"
COEFFICIENTS = "coefficient", "coefficient_mm3_per_N_m", "energy_coefficient_mm3_per_J"
PRESSED = "friction", "normal_force"


def from_table(form: str, name: str, reading: Reading, *columns: Any) -> "Table":
    """The content of a CSV file that a scene names, by the name of its form in `tables`, a function of some columns."""
    from plgwear_jax import tables  # imports NumPy, which a scene without files does not need

    found = getattr(tables, form)
    return tables.read(reading.folder / name, found(*columns) if columns else found)


# --- what touches ---------------------------------------------------------------------------------------------------


class Body(SimpleNamespace):
    """A half-space, an indenter, a shape or a contact, with the fields of its record as attributes.

    Attributes:
        record_name: The record of the library, with its module.
        kind: Of a half-space "a power law", "a table" or "layers", else the key of this name.
        fields: The fields of the record by name.
        file: The table that has them; None without one.
        rows: The rows of numbers of a half-space by name: thicknesses or depths, and moduli; none of a power law.
    """

    def __init__(self, record_name: str, kind: str, fields: KeyValues, file: "Table | None" = None) -> None:
        rows = {name: value for name, value in fields.items() if not isinstance(value, float | str)}
        super().__init__(**fields, record_name=record_name, kind=kind, fields=fields, file=file, rows=rows)

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
        return pkgutil.resolve_name(f"plgwear_jax.{self.record_name}")(**inner | others)


def body_from(reading: Reading, section: str, values: KeyValues) -> Body:
    """What a section, or a key of [contact], describes; the file that it names is read from a folder."""
    material = reading.material
    if section == "Layers" and len(values["modulus"]) != len(values["thickness"]) + 1:
        layers = len(values["thickness"])
        text = f"must hold {layers + 1} moduli for {layers} thicknesses, the last one that of the substrate"
        raise WrongKeyError("modulus", f"{text}, not {len(values['modulus'])}")
    if section == "GrossSlip" and material.kind != "a power law":
        raise WrongKeyError("kind", f"needs a power law under [material], not {material.kind}")
    if section == "Fretting" and math.isinf(values["friction"] * values["normal_force"]):
        raise WrongKeyError("friction", "times normal_force exceeds the range of numbers")
    fields, file = dict(values), None
    kind = fields.pop("kind", MATERIALS.get(section, ""))
    if "table" in fields:
        file = from_table("HEIGHTS" if section == "Profile" else "MODULUS", fields.pop("table"), reading)
        fields |= {"heights" if name == "height" else name: column for name, column in file.columns.items()}
    for name in {"indenter", "shape"} & fields.keys():
        fields[name] = body_from(reading, *fields[name]) if isinstance(fields[name], tuple) else None
    return Body(SECTIONS[section]["$comment"], kind, fields, file)


# --- loads and wear -------------------------------------------------------------------------------------------------


def _one_of(values: KeyValues, names: tuple[str, ...], what: str) -> str:
    """The one of some keys that is there."""
    there = [name for name in names if values[name] is not None]
    if not there:
        raise WrongKeyError("", f"needs one of its keys {', '.join(names)}")
    if len(there) > 1:
        raise WrongKeyError(there[-1], f"cannot be combined with {there[0]}; only one of them can be the {what}")
    return there[0]


def _refuse_slip(table: "Table", contact: Body, forces: "np.ndarray | float") -> None:
    """Refuse force amplitudes in N that reach the friction force, where the rows of a table may have their own."""
    limit: Any = math.prod(table.columns.get(name, getattr(contact, name)) for name in PRESSED) + 0.0 * table.row
    given, text = forces + 0.0 * limit, "this is gross slip, it must be below mu F_N ="
    table.refuse(~(given < limit), lambda i: f"tangential_force = {given.item(i)}: {text} {limit[i]:g} N")


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
        columns: Its columns, or the one amplitude by its key.
        of_displacement: The amplitudes are those of the displacement.
        cycles: How many cycles each amplitude of a history lasts, shape (n,); None if nothing says so.
        pressed: The normal forces in N and the coefficients of friction that a history has of its own, of shape (n,).
        material: The half-space.
        contact: The contact.
        wear: How it wears; None if nothing says so.
    """

    @classmethod
    def of(cls, reading: Reading, _: str, values: KeyValues) -> Self:
        """The load of the contact; force amplitudes of gross slip are refused."""
        kind, contact = _one_of(values, LOADS, "load"), reading.contact
        if contact.kind != "fretting":
            raise WrongKeyError("", 'only a contact with kind = "fretting" has a tangential force')
        limit: Any = contact.friction * contact.normal_force
        force, named = values["tangential_force"], values["table"] or values["history"]
        if force is not None and not force < limit:
            text = f"this is gross slip, F_x = {force:g} N is not below mu F_N = {limit:g} N"
            raise WrongKeyError(kind, f"{text}; lower it, or raise friction or normal_force")
        file = named and from_table("LOADS" if kind == "table" else "HISTORY", named, reading)
        columns: Mapping[str, Any] = file.columns if file else {kind: values[kind]}
        if file and "tangential_force" in columns:
            _refuse_slip(file, contact, columns["tangential_force"])
        return cls(
            **values,
            file=file,
            columns=columns,
            of_displacement="displacement" in columns,
            cycles=columns.get("cycles"),
            pressed={name: columns[name] for name in reversed(PRESSED) if name in columns},
            material=reading.material,
            contact=contact,
            wear=reading.wear,
        )

    @cached_property
    def given(self) -> "np.ndarray":
        """The amplitudes as they were given, in N or m, shape (n,): the one, or all of a history or a table."""
        import numpy as np

        return np.atleast_1d(self.columns["displacement" if self.of_displacement else "tangential_force"])

    @property
    def is_zero(self) -> bool:
        """Nothing moves, and so nothing wears."""
        return not (self.given * self.columns.get("weight", 1.0)).any()

    def refuse_rest(self) -> None:
        """Refuse a load under which nothing wears."""
        if self.is_zero:
            raise SceneError("[load]: an amplitude of 0: nothing wears")

    def record(self) -> Any:
        """The load of a test over cycles: an amplitude, or the blocks of a history."""
        from plgwear_jax import loads

        kind = loads.Displacement if self.of_displacement else loads.Force
        every = [kind(amplitude, self.rig_stiffness) for amplitude in self.given.tolist()]
        if self.cycles is None:
            return every[0]
        own = {"cycles": self.cycles, **self.pressed}
        return [
            loads.Block(load, **{name: column.item(row) for name, column in own.items()})
            for row, load in enumerate(every)
        ]

    def acting(self, lasts: bool) -> Any:
        """What a computation takes: over cycles displacements, which are kept, or blocks; else forces, with the rig.

        Of a history it is the largest, unless it has cycles.
        """
        if lasts and self.cycles is not None:
            return self.record()
        from plgwear_jax import loads

        held = lasts and self.of_displacement
        kind, some = (loads.Displacement, self.counting(self.given)) if held else (loads.Force, self.amplitudes)
        return kind(float(some.max()) if self.table is None else some, self.rig_stiffness)

    @cached_property
    def moved(self) -> Any:
        """What the displacements of `given` do to the unworn contact: a `DisplacementEffect`."""
        import jax

        from . import solving

        pressed = solving.homogeneous(self.contact.record(material=self.material.record(), **self.pressed))
        return jax.device_get(solving.displacement_effect(pressed, self.given, self.rig_stiffness))

    @property
    def in_gross_slip(self) -> "np.ndarray":
        """Which amplitudes of `given` make the unworn contact slip as a whole, shape (n,)."""
        return ~(self.given < (self.moved.gross_slip if self.of_displacement else math.inf))

    @cached_property
    def slides(self) -> SceneError | None:
        """What says that the contact slips as a whole before any wear, under the first such displacement; else None."""
        if self.pressed or not self.in_gross_slip.any():
            return None
        first, wear = self.in_gross_slip.argmax(), self.wear
        work = self.contact.normal_force * self.moved.path[first]
        by, worn = "Archard's law", f"{work:.4g} N m times the wear coefficient"
        if wear is not None and not wear.others:
            by = f"{by} with [wear] {wear.kind} = {getattr(wear, wear.kind):g}"
            worn = f"{1e18 * wear.archard * work:.4g} µm³"
        begins = written(self.moved.gross_slip, "m")
        begins += "" if self.rig_stiffness is None else " at the actuator"
        said = (
            f"displacement = {self.given[first]:g}: this is gross slip, the contact slips as a whole from {begins} on; "
            f"by {by} it wears {worn} a cycle at first; "
            "plgwear wear goes on, and plgwear design with cycles under [wear]"
        )
        if self.file is None:
            return SceneError(f"[load] {said}")
        return OtherFileError(f"{self.file.name}: row {self.file.row[first]}: {said}")

    @cached_property
    def amplitudes(self) -> "np.ndarray":
        """Amplitudes in N, shape (n,): the one amplitude, all of a history, or those of a table with weight > 0.

        A SceneError says where the contact slips as a whole.
        """
        if self.slides is not None:
            raise self.slides
        found = self.counting(self.moved.force if self.of_displacement else self.given)
        if math.isnan(found.sum()):
            raise SceneError("the force exceeds the range of numbers: some value in the input file is too extreme")
        return found

    def counting(self, amplitudes: Any) -> "np.ndarray":
        """Those amplitudes that count: all of a history, or those of a table with weight > 0."""
        if self.pressed:
            text = f"changes {' and '.join(self.pressed)}, so that no amplitude decides the steady state"
            raise SceneError(f"[load] history: {text}; plgwear wear takes it, and plgwear design with [wear]")
        weight = self.columns.get("weight")
        return amplitudes if weight is None else amplitudes[weight > 0.0]

    @property
    def weights(self) -> "np.ndarray | None":
        """Weights of the amplitudes of a table, > 0, shape (n,), with the sum 1; None if there is no table."""
        if self.table is None:
            return None
        from plgwear_jax.optimise.scenarios import shares

        weight = self.columns["weight"]
        return shares(weight[weight > 0.0])

    @property
    def largest(self) -> float:
        """The largest amplitude in N: it determines the worn state of a history, and the worst case of a table."""
        return float(self.amplitudes.max())

    @property
    def hardest(self) -> float:
        """The largest amplitude in N before any wear; in gross slip the friction force, but for rounding."""
        if self.slides is None:
            return self.largest
        import jax.numpy as jnp

        return self.contact.friction * self.contact.normal_force * (1.0 - 4.0 * float(jnp.finfo(float).eps))

    @property
    def remark(self) -> str | None:
        """The line that says which amplitude of a history counts, and which force goes with a displacement, or None."""
        if self.pressed or (self.displacement is None and self.history is None):
            return None
        if self.history is not None:
            number = f"{self.amplitudes.size} amplitude{'s' if self.amplitudes.size > 1 else ''}"
            row = self.file.row[self.amplitudes.argmax()]
            deciding = f"the largest, {self.largest:g} N (row {row}), decides the worn state"
            return f"history {one_line(self.history)}: {number}; {deciding}"
        told = f"the contact slips as a whole, from {written(float(self.moved.gross_slip), 'm')} on"
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
        kind: The key of its coefficient.
        indenter: The coefficient of the indenter in 1/Pa, or 1/Pa^exponent; from an energy coefficient it is that times
            the coefficient of friction.
        others: The keys that only some commands take.
    """

    @classmethod
    def of(cls, reading: Reading, _: str, values: KeyValues) -> Self:
        """The wear of the contact."""
        kind, contact = _one_of(values, COEFFICIENTS, "wear coefficient"), reading.contact
        if values["exponent"] == 1.0:  # as if left out
            values["exponent"] = None
        others = [name for name in ("exponent", "half_space_coefficient") if values[name] is not None]
        for name in others:
            if kind != "coefficient":
                raise WrongKeyError(name, f"cannot be combined with {kind}; give coefficient, in 1/Pa or 1/Pa^exponent")
        if contact.kind != "fretting":
            raise WrongKeyError("", 'only a contact with kind = "fretting" wears over cycles')
        friction, size = contact.friction if "energy" in kind else 1.0, 1.0 if kind == "coefficient" else 1e9
        return cls(**values, kind=kind, indenter=friction * values[kind] / size, others=others)

    def refuse_frictions(self, names: Iterable[str]) -> None:
        """Refuse an energy coefficient where the friction is among what changes: Archard's K is friction times it."""
        energy = self.energy_coefficient_mm3_per_J
        if energy is not None and any(name.rpartition(".")[2] == "friction" for name in names):
            text = "is not for a friction that changes, and Archard's coefficient with it; give coefficient, in 1/Pa"
            raise SceneError(f"[wear] energy_coefficient_mm3_per_J = {energy:g}: {text}")

    @property
    def archard(self) -> float:
        """Archard's coefficient in 1/Pa; a SceneError says if there is another wear law, or the half-space wears."""
        for name in self.others:
            raise SceneError(f"[wear] {name} = {getattr(self, name):g}: only plgwear wear takes it")
        return self.indenter

    @property
    def half_space_share(self) -> float:
        """The share of the half-space in all wear."""
        own = self.half_space_coefficient or 0.0
        return own / (self.indenter + own)

    @property
    def law(self) -> Any:
        """The wear law; its coefficient is the sum over both bodies."""
        from plgwear_jax.wear_laws import law_of

        return law_of(self.indenter + (self.half_space_coefficient or 0.0), self.exponent)


# --- designs --------------------------------------------------------------------------------------------------------


class DesignSpace(SimpleNamespace):
    """The section [design]: what may vary, the constraint, what is minimised, over which loads, within which limits.

    Whether all this goes together is `checked` for what designs alone.

    Attributes:
        vary: What may vary, as in the file.
        hold: What is kept equal to the reference: the initial contact radius, by adjusting E0.
        minimise: The quantity that is minimised, with its place if it has one.
        over: How the amplitudes of a table, and scenarios, count, as in the file.
        scenarios: A CSV file of what the contact may turn out to be.
        limits: The limits, as in the file.
        reading: What the other sections are.
    """

    def checked(self) -> Self:
        """The same, or a SceneError if it does not go together, or with the other sections."""
        reading, variables, limits = self.reading, self.variables, self.limits or {}
        with reading.telling("design"):
            kind, load = reading.contact.kind, reading.load
            if "modulus" in variables:
                window, depths = variables["modulus"], len(variables["modulus"]["at"])
                if depths != len(window["between"]):
                    text = f"must hold a pair [lower, upper] for each of the {depths} depths of at"
                    raise WrongKeyError("vary.modulus.between", text)
                if "steepness" in window and not self.free:
                    text = "only for a free gradient, with three to eight depths; at two it is |k|"
                    raise WrongKeyError("vary.modulus.steepness", text)
                if not self.free:
                    exponents_within(**window)
            lasts = reading.wear is not None and self.objective in BY_THEN
            if load is not None and load.pressed and not (lasts and load.cycles is not None):
                text = "a design cannot be combined with a history that changes the normal force or the friction"
                raise WrongKeyError("", f"{text}, unless it is for the wear of its cycles, with [wear]")
            try:
                objective = placed_quantity("minimise", self.objective, self.places, kind)
            except WrongKeyError as error:  # of a place, which is a key of the quantity
                raise WrongKeyError(error.key.replace(".", f".{self.objective}.", 1), error.text) from None
            for name, several in self.allowed.items():
                for one in several:
                    limited_quantity(name, one, kind)
            if self.free:
                for name in variables:
                    if name != "modulus":
                        raise WrongKeyError(f"vary.{name}", "cannot vary beside a free gradient, which is no power law")
                if kind == "gross-slip":
                    raise WrongKeyError("vary.modulus", f"cannot vary: {ON_K_ALONE}")
                variables = {}
            flat = getattr(reading.material, "k", None) == 0.0
            refuse_question(variables, bool(self.hold), objective, limits, kind=kind, flat=flat)
            if self.free and self.scenarios is not None:
                raise WrongKeyError("scenarios", "cannot be combined with a free gradient; only a power law takes it")
            if not self.free and reading.material.kind != "a power law":
                self._refuse_what_needs_a_power_law()
            # bounds of what this contact does not have, and of what slips as a whole
            if "nu" in variables and isinstance(reading.material.nu, str):
                raise WrongKeyError("vary.nu", 'follows from k, as [material] nu = "holl"; give it a number')
            for name in variables:
                if name not in (*self.numbers, "modulus"):
                    text = f"is no number of this contact{near_or_all(name, self.numbers)}"
                    raise WrongKeyError(f"vary.{name}", text)
            varied = [name for name in PRESSED if name in variables]
            if varied and load is not None and not (load.of_displacement or load.pressed):
                lowest = (variables.get(name, [getattr(reading.contact, name)])[0] for name in PRESSED)
                if not load.largest < math.prod(lowest):
                    text = f"at the lowest {' and '.join(varied)} the whole contact slips"
                    raise WrongKeyError(f"vary.{varied[0]}", text)
            if self.scatter is None and self.over is not None and (load is None or load.table is None):
                text = "only for a load with a table, which gives the amplitudes and their weights, or for scenarios"
                raise WrongKeyError("over", text)
        return self

    def _refuse_what_needs_a_power_law(self) -> None:
        """All of it at once, with what to write for another material."""
        material = self.reading.material
        needing = [name for name in self.variables if name in (*OF_POWER_LAW, "modulus")]
        asked = [f"vary.{name}" for name in needing]
        asked += ["hold"] * (self.hold is not None) + ["limits.modulus"] * ("modulus" in (self.limits or ()))
        if not asked:
            return
        first, *others = asked
        as_do = f", as {'do' if others[1:] else 'does'} {' and '.join(others)}" if others else ""
        instead = ""
        if len(needing) == len(self.variables):
            name = next(name for name in ("thickness", "modulus") if len(material.rows.get(name, ())))
            value = float(material.rows[name][0])
            instead = f' and write vary = {{ "material.{name}[0]" = [{0.5 * value:g}, {2.0 * value:g}] }}'
            instead += ", or three depths or more in vary.modulus"
        text = f"needs a power law under [material], not {material.kind}{as_do}"
        raise WrongKeyError(first, f"{text}; delete {'them' if others else 'it'}{instead}")

    @cached_property
    def variables(self) -> KeyValues:
        """What may vary: bounds by name, such as k and indenter.E.

        For "modulus" the window: at two depths of a power law, at three to eight a free gradient.
        """
        found = {}
        for name, given in self.vary.items():
            nested = isinstance(given, dict) and name != "modulus"
            found |= {f"{name}.{one}": x for one, x in given.items()} if nested else {name: given}
        return found

    @property
    def allowed(self) -> KeyValues:
        """The limits by name, of each quantity one or more: above, below or between, with the place.

        Bounds of the modulus, also those within which it varies, are a limit at each of two depths.
        """
        limits = {name: [given] if isinstance(given, dict) else given for name, given in (self.limits or {}).items()}
        windows = limits.pop("modulus", [])
        if "modulus" in self.vary and not self.free:
            windows = [self.vary["modulus"]]
        for window in windows:
            at_depths = ({"z": z, "between": ends} for z, ends in zip(window["at"], window["between"], strict=False))
            limits["modulus_at"] = [*limits.get("modulus_at", ()), *at_depths]
        return limits

    @property
    def level(self) -> float:
        """The mean is taken over the worst 1 - level of the load: 0 is the mean of all, 1 the worst case."""
        return self.over[1]["cvar"] if isinstance(self.over, tuple) else float(self.over == "worst")

    @cached_property
    def scatter(self) -> "Table | None":
        """The scenarios; None without."""
        if self.scenarios is None:
            return None
        columns = {name: leaf(name).domain for name in (*self.numbers, "wear_coefficient")}
        found, load = from_table("scenarios", self.scenarios, self.reading, columns), self.reading.load
        if load is not None and not (load.of_displacement or load.pressed):
            _refuse_slip(found, self.reading.contact, load.largest)
        return found

    @property
    def numbers(self) -> list[str]:
        """The names of all numbers of the contact."""
        material = self.reading.material
        rows = (f"material.{name}[{i}]" for name, row in material.rows.items() for i in range(len(row)))
        return [*material.numbers(), *self.reading.contact.numbers(), *rows]

    @property
    def free(self) -> bool:
        """The modulus is free at three depths or more: no power law is asked for."""
        return "modulus" in self.variables and len(self.variables["modulus"]["at"]) > 2

    @property
    def objective(self) -> str:
        """The quantity that is minimised."""
        return self.minimise if isinstance(self.minimise, str) else next(iter(self.minimise))

    @property
    def places(self) -> Mapping[str, float]:
        """Where that is taken, in m, by name."""
        return {} if isinstance(self.minimise, str) else self.minimise[self.objective]


# --- what is asked for ------------------------------------------------------------------------------------------------


def output_of(reading: Reading, _: str, values: KeyValues) -> SimpleNamespace:
    """The section [output]: names of quantities of the contact."""
    output, contact, laws = SimpleNamespace(**values), reading.contact, laws_of_scene(reading)
    for name in output.quantities:
        if name not in laws:
            text = f'"{one_line(name)}" is not a quantity of a {contact.kind} contact{near_or_all(name, laws)}'
            if name in LASTING and contact.kind == "fretting":
                text = f'"{name}" counts after the cycles under [wear], of one load or a table'
            raise WrongKeyError("quantities", text)
        if "distance" in laws[name].arguments and edge_distance(reading.design, output)[1] is None:
            text = f'"{name}" needs a distance from the stick-slip boundary'
            raise WrongKeyError("quantities", f"{text}; give it in m, as distance = 1e-6 under [output]")
        needed = [place for place in WITHIN if place in laws[name].arguments]
        if needed:
            given = {place: x for place in needed if (x := getattr(output, place)) is not None}
            placed_quantity("", name, given, contact.kind)
    return output


def laws_of_scene(scene: Any) -> dict[str, Law]:
    """What a scene can be asked for: over cycles it takes a life, other than that of a history."""
    load, wear = scene.load, scene.wear
    lasts = wear is not None and wear.cycles is not None and load.history is None
    given = {*PLACES, "F_x", *(("cycles", "wear_coefficient") if lasts else ())}
    return {name: law for name, law in laws_of(scene.contact).items() if given.issuperset(law.arguments)}


def edge_distance(design: DesignSpace | None, output: SimpleNamespace | None = None) -> tuple[str, float | None]:
    """The distance in m from the edge at which a scene wants, minimises or limits pressures, and its key; else None."""
    given = [("[output] distance", getattr(output, "distance", None))]
    if design is not None:
        limits = (one for several in design.allowed.values() for one in several)
        places = [("minimise", design.places), *(("limits", one) for one in limits)]
        given += [(f"[design] {key}.edge_pressure.distance", at.get("distance")) for key, at in places]
    return next((one for one in given if one[1] is not None), ("", None))
