"""A scene file: material, contact, load, design space and the quantities asked for, read from TOML and checked.

Every error in a file is reported in one line before anything is computed. JAX is imported only to compute, NumPy only
to read a table.
"""

import dataclasses
import math
import os
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from plgwear_jax._core.catalogue import STRESSES, laws_of
from plgwear_jax._core.ranges import FINITE, POSITIVE
from plgwear_jax._core.rules import (
    BY_THEN,
    PLACES,
    WITHIN,
    WrongKeyError,
    is_after_cycles,
    limited_quantity,
    one_of,
    placed_quantity,
)
from plgwear_jax._core.units import written
from plgwear_jax._core.words import PathGiven, one_line, read_text, shown

from .keys import NAMES, ArgumentError, KeyValues, OtherFileError, Reading, SceneError, json_schema
from .sections import (
    LOADS,
    Body,
    DesignSpace,
    LoadSection,
    WearSection,
    body_from,
    edge_distance,
    laws_of_scene,
    output_of,
)

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.contact import FrettingContact, GrossSlipContact
    from plgwear_jax.optimise import Design, FreeDesign, Front
    from plgwear_jax.wear import Run

__all__ = ["OtherFileError", "Quantity", "Scene", "SceneError", "json_schema", "load", "one_line"]

_LATE = f"counts after the cycles under [wear], where {one_of(tuple(BY_THEN))} is minimised"


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


@dataclasses.dataclass(frozen=True, eq=False)
class Scene:
    """A checked scene. Its sections are those of the file; see `load`.

    Attributes:
        material: The reference half-space.
        contact: The indenter and how it is pressed.
        load: The tangential force or displacement, with the amplitudes of the file if it names one; None for gross
            slip.
        wear: The wear coefficient and the life in cycles; None if there are none.
        design_space: The section [design]: what may vary, be held and be limited; None if there is none. Only its
            keys are checked before a design is asked for.
        output: The quantities asked for; None for all single numbers.
    """

    material: Body
    contact: Body
    load: LoadSection | None
    wear: WearSection | None
    design_space: DesignSpace | None
    output: SimpleNamespace | None

    def build_contact(self) -> "FrettingContact | GrossSlipContact":
        """The contact of the scene, with the reference material."""
        return self.contact.record(material=self.material.record())

    def asked(self) -> DesignSpace:
        """The section [design] of a scene for which a design can be looked for.

        Raises:
            SceneError: There is no such section, it does not go together or with the others, or nothing wears.
        """
        if self.design_space is None:
            raise SceneError("[design]: missing; it says what may vary")
        if self.load is not None:
            self.load.refuse_rest()
        space = self.design_space.checked()
        late = [f"{name}:" for name in (space.objective, *space.allowed) if is_after_cycles(name)]
        if space.scatter is not None and "wear_coefficient" in space.scatter.columns:
            late.append("scenarios: its wear_coefficient")
        if late and self.life is None:
            raise SceneError(f"[design] {late[0]} {_LATE}")
        return space

    @property
    def life(self) -> float | None:
        """Cycles that a design is for; None for the steady state, as where the quantity has no value after cycles."""
        space = self.design_space
        if self.wear is None or space is None or space.objective not in BY_THEN:
            return None
        own = self.load and self.load.cycles  # of a history, which count more
        return self.wear.cycles if own is None else float(own.sum())

    @property
    def wears_otherwise(self) -> bool:
        """Whether a design is for a life under another load than force amplitudes: blocks, or displacements."""
        load = self.load
        return load is not None and self.life is not None and (load.cycles is not None or load.of_displacement)

    def tested(self) -> LoadSection:
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
        load.refuse_rest()
        return load

    def over_cycles(self, *, digits: int | None = None) -> "Run":
        """The test of the scene, with the wear law under [wear]: see `Run`.

        Args:
            digits: Correct digits wanted; by default all that such a run has.

        Raises:
            SceneError: The scene has no test over cycles, or no [wear].
        """
        load, wear = self.tested(), self.wear
        if wear is None:
            raise SceneError("[wear]: missing; it gives the wear coefficient, such as coefficient = 1e-14 in 1/Pa")
        wear.refuse_frictions(load.pressed)
        contact: Any = self.build_contact()
        return contact.over_cycles(load.record(), wear.law, digits=digits)

    def traded(self, key: str, given: str, distance: float | None = None) -> dict[str, dict[str, float]]:
        """A quantity of the contact with its place, as `optimise.front` takes it.

        Args:
            key: What it is given as, for messages, such as "x".
            given: Its name in the catalogue, and if it needs a place this in m: "penetration", "wear_depth@5e-5",
                "edge_pressure@1e-6", or two, "tension@-5e-5,0". Without one it has that of its limit in [design].
            distance: Its place, if it is given apart.

        Raises:
            SceneError: There is no such quantity of this contact, or its place is missing or wrong.
        """
        if distance is not None:
            if "@" in given:
                raise ArgumentError(f"{key} = {shown(given)}: has its place already; leave out the distance")
            given = f"{given}@{distance!r}"
        name, at, text = given.partition("@")
        twins = "edge_pressure", "pressure"  # two names of one quantity
        its = twins if name in twins else (name,)
        law, limits = laws_of(self.contact).get(its[0]), self.asked().allowed
        needed = [place for place in PLACES if place in getattr(law, "arguments", ())] or ["r"]
        limit = next((one for own in its for one in limits.get(own, ()) if {*needed} <= {*one}), {})
        places = {place: limit[place] for place in needed if limit}
        if at:
            try:
                places = dict(zip(needed, map(float, text.split(",")), strict=True))
            except ValueError:
                places = {needed[0]: math.nan}
        try:
            found = placed_quantity(key, name, places, self.contact.kind)
        except WrongKeyError as error:
            if error.key == "x.distance":
                raise ArgumentError(f"distance: missing; it {error.text}, such as 1e-6") from None
            such = f", such as {name}@{','.join(['1e-6'] * len(needed))}" if law and not at else ""
            raise ArgumentError(f"{error.key.replace('.', f' {name}@')}: {error.text}{such}") from None
        domain = FINITE if {*WITHIN} & {*places} else POSITIVE
        for place, value in places.items():
            if not domain.contains(value):
                text = f"a finite number{'' if domain is FINITE else ' > 0'}"
                raise ArgumentError(f"{key} = {shown(given)}: {PLACES[place]} must be {text}")
        if is_after_cycles(found) and self.life is None:
            raise ArgumentError(f"{key} = {shown(given)}: {_LATE}")
        return {found: places}

    def minimising(self, key: str, given: str) -> "Scene":
        """The scene with another quantity that is minimised, as `traded` takes it."""
        asked = vars(self.asked()) | {"minimise": self.traded(key, given)}
        return dataclasses.replace(self, design_space=DesignSpace(**asked))

    def design(self) -> "Design":
        """Find the half-space or coating on which the indenter wears least, as [design] asks for it.

        Of a history only the largest amplitude counts, but for the wear of its cycles, with [wear]; over a table it is
        the mean, the worst case or the mean of the worst cases, as `over` says.

        Returns:
            The best contact beside the reference, as of `optimise.design`.

        Raises:
            SceneError: There is no [design], nothing wears, or a number is too extreme.
        """
        from . import designing

        return designing.answer("design", **self.arguments())

    def arguments(self) -> dict[str, Any]:
        """The arguments of `optimise.design`, by name, with which `design` asks, to ask with some of them changed.

        Raises:
            SceneError: See `design`.
        """
        from . import designing

        return designing.arguments_of(self, *edge_distance(self.asked()))

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
            distance: The place of x in m, if it is a pressure inside the stick-slip boundary; by default of its limit.
            points: How many values of x, at least 2.

        Returns:
            The front, as of `optimise.front`.

        Raises:
            SceneError: See `design`; or there is no such quantity, or no place of it.
        """
        from . import designing

        given = self if y is None else self.minimising("y", y)
        asked, kind = given.traded("x", x, distance), self.contact.kind
        ((name, places),) = asked.items()
        arguments = designing.arguments_of(given, "distance", places.get("distance"), ArgumentError)
        if "scenarios" in arguments:
            raise SceneError("[design] scenarios: only plgwear design takes them")
        # A limit of x is replaced by its values; of several limits of one quantity those at other places stay.
        limits = {
            one: [
                at
                for at in several
                if limited_quantity(one, at, kind)[0] != name or (several[1:] and places.items() - at.items())
            ]
            for one, several in given.asked().allowed.items()
        }
        return designing.answer("front", **arguments | {"limits": limits}, x=asked, larger=larger, points=points)

    def free_design(self) -> "FreeDesign":
        """Find the E(z) on which the indenter wears least, by its values at the depths that [design] gives.

        Returns:
            It beside the best power law within the same bounds, as of `optimise.free_design`.

        Raises:
            SceneError: See `design`; or [design] asks for a power law.
        """
        space = self.asked()
        if not space.free:
            text = "asks for a power law; a free gradient takes modulus at three depths or more"
            raise SceneError(f"[design] vary: {text}")
        from plgwear_jax.optimise import ModulusProfile

        from . import designing

        at, between, *steepness = space.vary["modulus"].values()
        lower, upper = zip(*between, strict=True)
        profile = ModulusProfile(at, lower, upper, *steepness)
        return designing.answer("free_design", modulus=profile, **designing.keywords_of(self))

    def solve(self, *, digits: int | None = None) -> dict[str, Quantity]:
        """Compute the quantities that the scene asks for, and no others.

        Of a history only the largest amplitude counts. Over a table, numbers that depend on the amplitude are weighted
        means, and their descriptions say so. Functions of the radius are given from 0 to 1.25 times the largest worn
        radius, at half of the radii in the worn ring (fretting), or to twice the radius of the punch (gross slip).
        Beside the edge where a quantity is unbounded it is also given at one distance: that of [output], else that at
        which the edge pressure is minimised or limited, else a hundredth of the contact radius.

        Args:
            digits: Correct digits wanted; by default all that the dtype holds.

        Returns:
            The quantities by name, in the order of the scene. Without [output] these are all single numbers, the edge
            pressure only where the scene gives its distance, and `edge_intensity` only where there is an edge. Under
            a displacement that makes the contact slip as a whole, `load.slides` says so, and only what depends on no
            amplitude is given, and the peaks of stresses, which are those of sliding.

        Raises:
            SceneError: A function of the radius that depends on the amplitude is asked for over a table, the distance
                from the edge is larger than the stick radius or that of the punch, or the contact slips as a whole and
                has nothing of what is asked for.
        """
        laws, load, output = laws_of_scene(self), self.load, self.output
        key, distance = edge_distance(self.design_space, output)
        places: KeyValues = {place: getattr(output, place, None) for place in WITHIN} | {"distance": distance}
        if output is not None:
            names, points = output.quantities, int(output.points)
        else:
            given = {"F_x"} if distance is None else {"F_x", "distance"}
            left_out = STRESSES | ({"edge_intensity"} if load is not None and load.is_zero else set())
            names = [name for name, law in laws.items() if given.issuperset(law.arguments) and name not in left_out]
            points = 0
        table = load and load.table
        for name in names:
            if table is not None and {"r", "F_x"} <= {*laws[name].arguments}:
                text = f'"{name}" is a function of r, and so has no mean over a table of amplitudes'
                raise SceneError(f"[output] quantities = {shown(list(names))}: {text}; ask for single numbers")
        import numpy as np

        from plgwear_jax.loads import Force

        from . import solving

        contact = solving.homogeneous(self.build_contact())
        # The quantities with what gives them: a contact that slips as a whole has few.
        lasts = any("cycles" in laws[name].arguments for name in names)
        if load is None or load.slides is None:
            parts: list[tuple[Any, Any]] = [(names, load and load.acting(lasts))]
        else:
            still = [name for name in names if "F_x" not in laws[name].arguments]
            peaks = [name for name in names if name in STRESSES and table is None]
            if not still + peaks:
                raise load.slides
            parts = [(still, Force(0.0, load.rig_stiffness)), (peaks, Force(load.hardest))]
        if self.wear is not None and lasts:
            places |= {"cycles": self.wear.cycles, "wear_coefficient": self.wear.archard}
        values, weights = {}, load and load.weights
        for some, acting in parts:
            if some:
                values |= solving.scene_values(tuple(some), points, digits, contact, acting, weights, places)
        values = {name: np.asarray(value) for name, value in values.items()}
        if distance is not None and not distance < values.get("edge radius", math.inf):
            whose = "the stick radius" if load is not None else "the radius of the punch"
            raise SceneError(f"{key} = {distance:g}: must be below {whose}, {float(values['edge radius']):.3g} m")
        heights = getattr(self.contact.fields.get("shape"), "file", None)
        lacking = any(np.any(np.isnan(value)) for value in values.values())
        if heights is not None and lacking:
            end = f"ends at r = {heights['r'][-1]:g} m, inside the worn radius"
            raise OtherFileError(f"{heights.name}: row {heights.row[-1]}: {end}; give heights further out")
        if lacking and load is not None:
            _ = contact.steady(load.hardest, digits=digits).worn_radius  # says where it would have to pull
        found = {}
        for name in (name for name in names if name in values):
            law, value = laws[name], values[name]
            if "r" in law.arguments:
                unbounded = law.unbounded_at is not None and (load is None or load.largest > 0.0)
                beside: Any = (law.unbounded_at, float(values["edge distance"]), float(value[-1])) if unbounded else ()
                found[name] = Quantity(value[:-1], law.unit, law.description, values["radii"][:-1], *beside)
                continue
            over = f"mean over {one_line(table)}: " if table is not None and "F_x" in law.arguments else ""
            at = {axis: places[axis] for axis in law.arguments if axis in WITHIN}
            at |= dict(zip("xz", values.get(f"{name} at", ()), strict=False))
            side = "" if not at.get("x") else " (trailing side)" if at["x"] < 0.0 else " (leading side)"
            told = "".join(f", {axis} = {written(float(z), 'm')}{side * (axis == 'x')}" for axis, z in at.items())
            inside = distance if "distance" in law.arguments else None
            found[name] = Quantity(float(value), law.unit, f"{over}{law.description}{told}", edge_distance=inside)
        return found


# --- reading --------------------------------------------------------------------------------------------------------


def load(path: PathGiven) -> Scene:
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
    return scene_of(document, name, Path(path).parent)


def scene_of(document: KeyValues, name: str = "scene", folder: Path = Path()) -> Scene:
    """The scene of what a file holds.

    Args:
        document: Its sections.
        name: Its name, for messages.
        folder: Where names of other files begin.

    Raises:
        SceneError: See `load`.
    """
    reading = Reading(**dict.fromkeys(NAMES), file=name, document=document, folder=folder)
    given = {section: reading.values_of(section) for section in document}
    for section in ("material", "contact"):
        if section not in given:
            reading.refuse((section,), "missing; every input file needs this section")
    if given["contact"][0] == "Fretting" and "load" not in given:
        reading.refuse(("load",), f"missing; a fretting contact needs one of its keys {', '.join(LOADS)}")
    for section, build in _BUILT.items():
        if section in given:
            with reading.telling(section):
                setattr(reading, section, build(reading, *given[section]))
    return Scene(*(getattr(reading, section) for section in NAMES))


# How each section is made, from those before it, what it means and the values of its keys.
_BUILT: dict[str, Callable[[Reading, str, KeyValues], Any]] = {
    "material": body_from,
    "contact": body_from,
    "wear": WearSection.of,
    "load": LoadSection.of,
    "design": lambda reading, _, values: DesignSpace(**values, reading=reading),
    "output": output_of,
}
