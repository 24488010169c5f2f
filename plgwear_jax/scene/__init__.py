"""A scene file: material, contact, load, design space and the quantities asked for, read from TOML and checked.

Every error in a file is reported in one line before anything is computed. JAX is imported only to compute, NumPy only
to read a table.
"""

import json
import math
import os
import re
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Self

from plgwear_jax._core.extras import needs

with needs("input files", "cli"):
    import pydantic  # noqa: F401

from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from plgwear_jax._core.ranges import Domain
from plgwear_jax._core.units import written
from plgwear_jax._core.words import near, one_line, read_text, shown
from plgwear_jax.catalogue import STRESSES, Law, element, laws_of
from plgwear_jax.rules import BY_THEN, OF_POWER_LAW, PLACES, Complaint, domain_of, placed_quantity
from plgwear_jax.scene.complaints import complaint
from plgwear_jax.scene.design_section import ELEMENTS, Design
from plgwear_jax.scene.fields import OtherFileError, SceneError, Section, wrong
from plgwear_jax.scene.material_section import AnyMaterial, Material, Profile
from plgwear_jax.scene.sections import LOADS, PRESSED, Fretting, GrossSlip, Load, Output, Wear

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.contact import FrettingContact, GrossSlipContact
    from plgwear_jax.optimise import Design as DesignFound
    from plgwear_jax.optimise import FreeDesign, Front
    from plgwear_jax.wear import Run
    from plgwear_jax.wear_laws import WearLaw

_MOST_DIGITS = 5  # of a numeric contact
_INSTEAD = (
    f"vary {' and '.join(map(json.dumps, ELEMENTS))} and so on, "
    "or give three depths or more in vary.modulus for a free gradient"
)

__all__ = ["OtherFileError", "Quantity", "Scene", "SceneError", "json_schema", "load", "one_line"]


class Quantity(NamedTuple):
    """One result of `Scene.solve`.

    Attributes:
        value: A float, or an array along `radii`.
        unit: The SI unit of the value; "1" for a plain number.
        description: What it is, in words.
        radii: The radii in m at which the array is given; None for a single number.
        unbounded_at: Where the quantity is infinite, so that the largest entry of the array has no meaning; else None.
        edge_distance: The distance in m inside that edge at which `edge_value` is taken, or the value of an edge
            pressure; None for other quantities.
        edge_value: The value there, of a function of the radius that is unbounded at the edge.
    """

    value: "float | np.ndarray"
    unit: str
    description: str
    radii: "np.ndarray | None" = None
    unbounded_at: str | None = None
    edge_distance: float | None = None
    edge_value: float | None = None


# --- the scene -------------------------------------------------------------------------------------------------------


class Scene(Section):
    """A checked scene. Its sections are those of the file; see `load`.

    Attributes:
        material: The reference half-space.
        contact: The indenter and how it is pressed.
        load: The tangential force or displacement, with the amplitudes of the file if it names one; None for gross
            slip.
        wear: The wear coefficient and the life in cycles; None if there are none.
        design_space: The section [design]: what may vary, be held and be limited; None if there is none.
        output: The quantities asked for; None for all single numbers.
    """

    material: AnyMaterial
    contact: Annotated[Fretting | GrossSlip, Field(discriminator="kind")]
    load: Load | None = Field(None, validate_default=True)
    wear: Wear | None = None
    design_space: Design | None = Field(None, alias="design")
    output: Output | None = None

    @field_validator("contact")
    @classmethod
    def _on_this_material(cls, contact: Fretting | GrossSlip, info: ValidationInfo) -> Fretting | GrossSlip:
        material = info.data.get("material")
        if isinstance(contact, GrossSlip) and material is not None and not isinstance(material, Material):
            raise wrong("kind", f"needs a power law under [material], not {material.words}")
        return contact

    @field_validator("load")
    @classmethod
    def _partial_slip(cls, load: Load | None, info: ValidationInfo) -> Load | None:
        contact = info.data.get("contact")
        if isinstance(contact, GrossSlip) and load is not None:
            raise wrong("", 'only a contact with kind = "fretting" has a tangential force')
        if isinstance(contact, Fretting):
            if load is None:
                raise wrong("", f"missing; a fretting contact needs one of its keys {', '.join(LOADS)}")
            folder = Path((info.context or {}).get("folder", ""))
            load.read(folder, contact)
        return load

    @field_validator("wear")
    @classmethod
    def _of_partial_slip(cls, wear: Wear | None, info: ValidationInfo) -> Wear | None:
        if wear is not None and isinstance(info.data.get("contact"), GrossSlip):
            raise wrong("", 'only a contact with kind = "fretting" wears over cycles')
        return wear

    @model_validator(mode="after")
    def _of_the_load(self) -> Self:
        if self.load is not None and isinstance(self.contact, Fretting):
            self.load.belongs_to(self.material, self.contact, self.wear)
        return self

    @field_validator("design_space")
    @classmethod
    def _of_this_contact(cls, design: Design | None, info: ValidationInfo) -> Design | None:
        material, contact, load = (info.data.get(name) for name in ("material", "contact", "load"))
        if design is None:
            return design
        lasts = info.data.get("wear") is not None and design.objective in BY_THEN
        if load is not None and load.pressed and not (lasts and load.cycles is not None):
            text = "a design cannot be combined with a history that changes the normal force or the friction"
            raise wrong("", f"{text}, unless it is for the wear of its cycles, with [wear]")
        design.refuse(None if contact is None else contact.kind, isinstance(material, Material) and material.k == 0.0)
        if design.free is None and material is not None and not isinstance(material, Material):
            asked = [f"vary.{name}" for name in design.variables if name in (*OF_POWER_LAW, "modulus")]
            asked += ["hold"] * (design.hold is not None) + ["limits.modulus"] * ("modulus" in (design.allowed or {}))
            if asked:
                raise wrong(asked[0], f"needs a power law under [material], not {material.words}; {_INSTEAD}")
        if contact is not None:
            _refuse_to_vary(design, contact, material, load)
        alone = design.scenarios is None and (load is None or load.table is None)
        if design.over is not None and "load" in info.data and alone:
            raise wrong(
                "over", "only for a load with a table, which gives the amplitudes and their weights, or for scenarios"
            )
        if contact is not None and material is not None:
            folder = Path((info.context or {}).get("folder", ""))
            design.read(folder, _uncertain(material, contact, info.data.get("wear")))
        return design

    @field_validator("output")
    @classmethod
    def _known(cls, output: Output | None, info: ValidationInfo) -> Output | None:
        contact = info.data.get("contact")
        if output is not None and contact is not None:
            laws = _laws(contact, info.data.get("load"), info.data.get("wear"))
            for name in output.quantities:
                if name not in laws:
                    text = f'"{one_line(name)}" is not a quantity of a {contact.kind} contact'
                    raise wrong("quantities", f"{text}; allowed are {', '.join(laws)}{near(name, laws)}")
                no_place = "design_space" in info.data and _edge_distance(info.data["design_space"], output) is None
                if "distance" in laws[name].arguments and no_place:
                    text = f'"{name}" needs a distance from the stick edge'
                    raise wrong("quantities", f"{text}; give it in m, as distance = 1e-6 under [output]")
        return output

    def build_contact(self) -> "FrettingContact | GrossSlipContact":
        """The contact of the scene, with the reference material."""
        return self.contact.record(material=self.material.record())

    @property
    def is_closed(self) -> bool:
        """Whether this is a power law under a rigid parabola."""
        contact = self.contact
        rigid = not isinstance(contact, Fretting) or (contact.indenter == "rigid" and contact.shape is None)
        return rigid and isinstance(self.material, Material)

    def asked(self) -> Design:
        """The section [design] of a scene for which a design can be looked for.

        Raises:
            SceneError: There is no such section, or nothing wears.
        """
        if self.design_space is None:
            raise SceneError("[design]: missing; it says what may vary")
        load = self.load
        if load is not None and load.is_zero:
            single = [name for name in ("tangential_force", "displacement") if getattr(load, name) is not None]
            key = f"{single[0]} = 0.0" if single else "all amplitudes are 0"
            raise SceneError(f"[load] {key}: nothing wears, so there is nothing to design")
        return self.design_space

    @property
    def life(self) -> float | None:
        """Cycles that a design is for; None for the steady state, as where the quantity has no value after cycles."""
        space = self.design_space
        return None if space is None or space.objective not in BY_THEN else self.lasts

    @property
    def lasts(self) -> float | None:
        """The cycles of the wear: those of a history that has its own, or of [wear]; None without."""
        if self.wear is None:
            return None
        own = None if self.load is None else self.load.cycles
        return self.wear.cycles if own is None else float(own.sum())

    @property
    def wears_otherwise(self) -> bool:
        """Whether a design is for a life under another load than force amplitudes: blocks, or a displacement."""
        load = self.load
        return load is not None and self.life is not None and (load.cycles is not None or load.displacement is not None)

    def tested(self) -> Load:
        """The section [load] of a scene that wears over cycles: one amplitude, or a history with cycles.

        Raises:
            SceneError: There is no such load, or nothing wears.
        """
        load = self.load
        if load is None:
            raise SceneError('[contact] kind = "gross-slip": only a fretting contact wears over cycles')
        if load.table is not None:
            raise SceneError("[load] table: wear over cycles is of one amplitude: tangential_force or displacement")
        if load.history is not None and load.cycles is None:
            text = "its amplitudes have no cycles: add a column cycles to it, or give one amplitude"
            raise SceneError(f"[load] history: {text}")
        if load.is_zero:
            raise SceneError("[load]: an amplitude of 0: nothing wears")
        return load

    def over_cycles(self) -> "Run":
        """The test of the scene, with the wear law under [wear]: see `Run`.

        Raises:
            SceneError: The scene has no test over cycles, or no [wear].
        """
        load = self.tested().record()
        if self.wear is None:
            raise SceneError("[wear]: missing; it gives the wear coefficient, such as coefficient = 1e-14 in 1/Pa")
        contact: Any = self.build_contact()
        return contact.over_cycles(load, self.law)

    @property
    def law(self) -> "WearLaw":
        """The wear law of a scene with [wear]."""
        assert self.wear is not None and isinstance(self.contact, Fretting)
        return self.wear.record(self.contact.friction)

    @property
    def archard(self) -> float:
        """Archard's wear coefficient in 1/Pa of a scene with [wear]."""
        assert self.wear is not None and isinstance(self.contact, Fretting)
        return self.wear.archard(self.contact.friction)

    def traded(self, key: str, given: str, distance: float | None = None) -> dict[str, dict[str, float]]:
        """A quantity of the contact with its place, as `optimise.front` takes it.

        Args:
            key: What it is given as, for messages, such as "x".
            given: Its name in the catalogue, and if it needs a place this in m: "penetration", "wear_depth@5e-5",
                "edge_pressure@1e-6". Without a place it has that of its limit in [design].
            distance: Its place, if it is given apart.

        Raises:
            SceneError: There is no such quantity of this contact, or its place is missing or wrong.
        """
        given = given if distance is None else f"{given}@{distance!r}"
        name, at, text = given.partition("@")
        its = ("edge_pressure", "pressure") if name in ("edge_pressure", "pressure") else (name,)
        law, limits = laws_of(self.contact).get(its[0]), self.asked().allowed or {}
        needed = next((place for place in PLACES if law is not None and place in law.arguments), "r")
        values = [text] if at else [limits[one][needed] for one in its if needed in limits.get(one, {})]
        places = {needed: values[0]} if values else {}
        found = placed_quantity(key, name, places, self.contact.kind)
        if isinstance(found, Complaint):
            raise SceneError(f"{found.key}: {found.text}")
        try:
            places = {place: float(value) for place, value in places.items()}
        except ValueError:
            places = {needed: math.nan}
        if not all(0.0 < value < math.inf for value in places.values()):
            raise SceneError(f"{key} = {shown(given)}: {PLACES[needed]} must be a finite number > 0")
        return {found: places}

    def minimising(self, objective: dict[str, dict[str, float]]) -> "Scene":
        """The scene with another quantity that is minimised, of `traded`."""
        ((name, places),) = objective.items()
        space = self.asked().model_copy(update={"minimise": {name: places} if places else name})
        return self.model_copy(update={"design_space": space})

    def design(self) -> "DesignFound":
        """Find the half-space or coating on which the indenter wears least, as [design] asks for it.

        Of a history only the largest amplitude counts, but for the wear of its cycles, with [wear]; over a table it is
        the mean, the worst case or the mean of the worst cases, as `over` says.

        Returns:
            The best contact beside the reference, as of `optimise.design`.

        Raises:
            SceneError: There is no [design], nothing wears, or a number is too extreme.
        """
        from plgwear_jax.scene import designing

        return designing.design(self)

    def arguments(self) -> dict[str, Any]:
        """The arguments of `optimise.design`, by name, with which `design` asks, to ask with some of them changed.

        Raises:
            SceneError: See `design`.
        """
        from plgwear_jax.scene import designing

        return designing.arguments_of(self)

    def front(
        self,
        *,
        x: str = "edge_pressure",
        y: str | None = None,
        larger: Literal["", "x", "y", "xy"] = "",
        distance: float | None = None,
        points: int = 21,
    ) -> "Front":
        """Find the best y for each x, by default the least wear for each edge pressure, within what [design] allows.

        Args:
            x: The one quantity, as `traded` takes it. A limit of it in [design] is left out.
            y: The other one; by default what [design] minimises.
            larger: Which of both is the better the larger it is; else smaller is better.
            distance: The place of x in m, if it is a pressure beside the stick edge; by default that of its limit.
            points: How many values of x, at least 2.

        Returns:
            The front, as of `optimise.front`.

        Raises:
            SceneError: See `design`; or there is no such quantity, or no place of it.
        """
        from plgwear_jax.scene import designing

        given = self if y is None else self.minimising(self.traded("y", y))
        return designing.front(given, self.traded("x", x, distance), larger, points)

    def free_design(self, *, starts: int = 20) -> "FreeDesign":
        """Find the E(z) on which the indenter wears least, by its values at the depths that [design] gives.

        Args:
            starts: How many descents are made.

        Returns:
            It beside the best power law within the same bounds, as of `optimise.free_design`.

        Raises:
            SceneError: See `design`; or [design] asks for a power law.
        """
        from plgwear_jax.scene import designing

        return designing.free_design(self, starts)

    def solve(self, *, digits: int | None = None) -> dict[str, Quantity]:
        """Compute the quantities that the scene asks for, and no others.

        Of a history only the largest amplitude counts. Over a table, numbers that depend on the amplitude are weighted
        means, and their descriptions say so. Functions of the radius are given from 0 to 1.25 times the largest worn
        radius (fretting) or twice the radius of the punch (gross slip). Beside the edge where a quantity is unbounded
        it is also given at one distance: that of [output], else that of the limit of the edge pressure, else a
        hundredth of the contact radius.

        Args:
            digits: Correct digits wanted; by default all that the dtype holds.

        Returns:
            The quantities by name, in the order of the scene. Without [output] these are all single numbers, the edge
            pressure only where the scene gives its distance, and the edge intensity only where there is an edge.

        Raises:
            SceneError: A function of the radius that depends on the amplitude is asked for over a table, the distance
                from the edge is larger than the stick radius or that of the punch, or under a displacement of the
                scene the contact slips as a whole.
        """
        laws = _laws(self.contact, self.load, self.wear)
        distance = _edge_distance(self.design_space, self.output)
        left_out = {"r"} if distance is not None else {"r", "distance"}
        left_out |= {"cycles"}
        edgeless = {"edge_intensity"} if self.load is not None and self.load.is_zero else set()
        edgeless |= STRESSES  # which take longer than all others
        names = tuple(name for name, law in laws.items() if left_out.isdisjoint(law.arguments) and name not in edgeless)
        points = 0
        if self.output is not None:
            names, points = self.output.quantities, self.output.points
        load = self.load
        weights, table = (None, None) if load is None else (load.weights, load.table)
        for name in names if table is not None else ():
            if {"r", "F_x"} <= {*laws[name].arguments}:
                text = f'"{name}" is a function of r, and so has no mean over a table of amplitudes'
                raise SceneError(f"[output] quantities = {shown(list(names))}: {text}; ask for single numbers")
        import numpy as np

        from plgwear_jax.contact import is_closed
        from plgwear_jax.loads import Force
        from plgwear_jax.scene import solving

        contact = solving.homogeneous(self.build_contact())
        if digits is not None and digits > _MOST_DIGITS and not is_closed(contact):
            raise SceneError(f"digits = {digits}: at most {_MOST_DIGITS}, since this contact is solved numerically")
        life = None
        if self.wear is not None and any("cycles" in laws[name].arguments for name in names):
            life = self.wear.cycles, self.archard
        force = None if load is None else Force(load.force, load.rig_stiffness)
        radii, values, edge, where = solving.evaluate(names, points, digits, contact, force, weights, distance, life)
        if edge is not None and distance is not None and not distance < float(edge.radius):
            key = "[design] limits.edge_pressure.distance"
            if self.output is not None and self.output.distance is not None:
                key = "[output] distance"
            whose = "the stick radius" if load is not None else "the radius of the punch"
            raise SceneError(f"{key} = {distance:g}: must be below {whose}, {float(edge.radius):.3g} m")
        radii = None if radii is None else np.asarray(radii)
        shape = getattr(self.contact, "shape", None)
        if isinstance(shape, Profile) and any(np.any(np.isnan(value)) for value in values.values()):
            end = f"ends at r = {shape.read['r'][-1]:g} m, inside the worn radius"
            raise OtherFileError(f"{shape.read.name}: row {shape.read.row[-1]}: {end}; give heights further out")
        found = {}
        for name in names:
            law, value = laws[name], np.asarray(values[name])
            if "r" in law.arguments:
                found[name] = Quantity(value, law.unit, law.description, radii)
                if edge is not None and name in edge.values and (load is None or load.largest > 0.0):
                    beside = law.unbounded_at, float(edge.distance), float(edge.values[name])
                    found[name] = Quantity(value, law.unit, law.description, radii, *beside)
            else:
                over = f"mean over {one_line(table)}: " if table is not None and "F_x" in law.arguments else ""
                place = distance if "distance" in law.arguments else None
                places = zip("xz", where.get(name, ()), strict=False)
                at = "".join(f", {axis} = {written(float(one), 'm')}" for axis, one in places)
                told = f"{over}{law.description}{at}"
                found[name] = Quantity(float(value), law.unit, told, edge_distance=place)
        return found


def _refuse_to_vary(design: Design, contact: Fretting | GrossSlip, material: Any, load: Load | None) -> None:
    """Refuse bounds of what this contact does not have, and those between which the whole contact slips."""
    bounds = design.vary.bounds
    for name in bounds:
        first = name.partition(".")[0]
        missing = {"indenter": "rigid indenter", "shape": "parabola"}.get(first)
        if missing is not None and getattr(contact, first, None) in (None, "rigid"):
            raise wrong(f"vary.{first}", f"the contact has a {missing}")
        if first == "material":
            table, place = element(name.removeprefix("material."))
            found = 0 if material is None else len(material.rows.get(table, ()))
            if material is not None and not (place is not None and place < found):
                has = f"has {found} of {table}" if found else f"has no {table}"
                raise wrong(f"vary.{name}", f"there is no such number: [material], {material.words}, {has}")
        elif first not in (*OF_POWER_LAW, "nu", "indenter", "shape") and first not in type(contact).model_fields:
            raise wrong(f"vary.{name}", f"is no number of a {contact.kind} contact")
    if "nu" in bounds and isinstance(getattr(material, "nu", None), str):
        raise wrong("vary.nu", 'follows from k, as [material] nu = "holl"; give it a number')
    varied = [name for name in PRESSED if name in bounds]
    if varied and load is not None and isinstance(contact, Fretting) and not (load.of_displacement or load.pressed):
        limit = math.prod(bounds[name][0] if name in bounds else getattr(contact, name) for name in PRESSED)
        if not load.largest < limit:
            raise wrong(f"vary.{varied[0]}", f"at the lowest {' and '.join(varied)} the whole contact slips")


def _uncertain(material: Any, contact: Fretting | GrossSlip, wear: Wear | None) -> dict[str, Domain]:
    """The numbers of the contact that scenarios may know, and what each of them can be."""
    names = [name for name, value in material if isinstance(value, float)]
    names += [f"material.{name}[{i}]" for name, values in material.rows.items() for i in range(len(values))]
    names += [name for name, value in contact if isinstance(value, float)]
    for body in ("indenter", "shape"):
        inner = getattr(contact, body, None)
        inner = () if isinstance(inner, str | None) else inner
        names += [f"{body}.{name}" for name, value in inner if isinstance(value, float)]
    names += ["wear_coefficient"] if wear is not None and wear.cycles is not None else []
    return {name: domain_of(name) for name in names}


def _laws(contact: Fretting | GrossSlip, load: Load | None, wear: Wear | None) -> dict[str, Law]:
    """What a scene can be asked for: over cycles it takes a life, other than that of a history."""
    lasts = wear is not None and wear.cycles is not None
    held = load is not None and load.history is None
    given = {"r", "distance", "F_x", *(("cycles", "wear_coefficient") if lasts and held else ())}
    return {name: law for name, law in laws_of(contact).items() if given.issuperset(law.arguments)}


def _edge_distance(design: Design | None, output: Output | None) -> float | None:
    """The distance from the edge at which a scene wants pressures, in m; None if it gives none."""
    if output is not None and output.distance is not None:
        return output.distance
    return None if design is None else design.edge_distance


def json_schema() -> dict[str, Any]:
    """The JSON schema of a scene, with which editors check and complete it; `load` checks more than it can express."""
    found = Scene.model_json_schema()
    # Descriptions begin with "must be", for messages; the schema leaves these words out.
    for model in (found, *found["$defs"].values()):
        model["description"] = model["description"].partition("\n")[0]
        for about in model.get("properties", {}).values():
            if "description" in about:
                about["description"] = about["description"].removeprefix("must be ")
    # The kind of the material is told by a key, so that a validator says what is wrong within the kind that was meant.
    choice: dict[str, Any] = {"$ref": "#/$defs/Material"}
    for key, model in (("modulus", "Layers"), ("thickness", "Layers"), ("table", "Tabulated")):
        choice = {"if": {"required": [key]}, "then": {"$ref": f"#/$defs/{model}"}, "else": choice}
    found["properties"]["material"] = {"title": "Material", "type": "object"} | choice
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found, "title": "plgwear scene"}


# --- reading --------------------------------------------------------------------------------------------------------


def load(path: str | os.PathLike[str]) -> Scene:
    """Read a scene file and check it.

    Args:
        path: A TOML file with the sections [material], [contact], for fretting [load], and if wanted [wear], [design]
            and [output].

    Returns:
        The scene; nothing is computed yet.

    Raises:
        SceneError: The file cannot be read or has an error; the first error is reported, in one line.
    """
    text = read_text(path, "an input file is a TOML file", OtherFileError)
    name = one_line(os.fspath(path))
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        comma = "; decimals are set off by a point" if re.search(r"=\s*[-+]?\d+,\d", text) else ""
        raise OtherFileError(f"{name}: is not valid TOML: {one_line(str(error))}{comma}") from None
    except (ValueError, RecursionError):
        raise OtherFileError(f"{name}: is not valid TOML: a number too long or brackets too deep") from None
    try:
        return Scene.model_validate(document, context={"folder": Path(path).parent})
    except ValidationError as error:
        complaints = [complaint(name, detail, document) for detail in error.errors(include_url=False)]
    _, line = min(complaints, key=lambda found: found[0])
    raise OtherFileError(line)
