"""The sections of an input file that ask for something, [design] and [output], whose keys `keys` has checked."""

import math
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Self

from plgwear_jax._core.catalogue import Law, laws_of
from plgwear_jax._core.rules import (
    BY_THEN,
    OF_POWER_LAW,
    ON_K_ALONE,
    PLACES,
    WITHIN,
    WrongKeyError,
    domain_of,
    exponents_within,
    limited_quantity,
    placed_quantity,
    refuse_question,
)
from plgwear_jax._core.words import near_or_all, one_line
from plgwear_jax.scene.keys import KeyValues, Reading
from plgwear_jax.scene.sections import PRESSED, from_table

if TYPE_CHECKING:
    from plgwear_jax.tables import Table

# --- designs --------------------------------------------------------------------------------------------------------


def _refuse_window(key: str, window: KeyValues) -> None:
    """Refuse what does not go together of the moduli that can be made, at two depths or more."""
    depths = len(window["at"])
    if depths != len(window["between"]):
        raise WrongKeyError(f"{key}.between", f"must hold a pair [lower, upper] for each of the {depths} depths of at")
    if "steepness" in window and depths == 2:
        text = "only for a free gradient, with three to eight depths; at two it is |k|"
        raise WrongKeyError(f"{key}.steepness", text)


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
        reading, variables, allowed = self.reading, self.variables, self.allowed
        with reading.telling("design"):
            material, kind, load = reading.material, reading.contact.kind, reading.load
            if "modulus" in variables:
                _refuse_window("vary.modulus", variables["modulus"])
                if not self.free:
                    exponents_within(**variables["modulus"])
            lasts = reading.wear is not None and self.objective in BY_THEN
            if load is not None and load.pressed and not (lasts and load.cycles is not None):
                text = "a design cannot be combined with a history that changes the normal force or the friction"
                raise WrongKeyError("", f"{text}, unless it is for the wear of its cycles, with [wear]")
            places = {} if isinstance(self.minimise, str) else self.minimise[self.objective]
            try:
                objective = placed_quantity("minimise", self.objective, places, kind)
            except WrongKeyError as error:  # these places have no keys of their own
                raise WrongKeyError("minimise", error.text) from None
            for name, several in allowed.items():
                for one in several:
                    if name != "modulus":
                        limited_quantity(name, one, kind)
                    else:
                        _refuse_window("limits.modulus", one)
                        if len(one["at"]) > 2:
                            text = "must be [z1, z2]: a limit is at two depths; vary the modulus for a free gradient"
                            raise WrongKeyError("limits.modulus.at", text)
            if self.free:
                for name in variables:
                    if name != "modulus":
                        raise WrongKeyError(f"vary.{name}", "cannot vary beside a free gradient, which is no power law")
                if kind == "gross-slip":
                    raise WrongKeyError("vary.modulus", f"cannot vary: {ON_K_ALONE}")
                variables = {}
            flat = getattr(material, "k", None) == 0.0
            refuse_question(variables, bool(self.hold), objective, allowed, kind=kind, flat=flat)
            if self.free and self.scenarios is not None:
                raise WrongKeyError("scenarios", "cannot be combined with a free gradient; only a power law takes it")
            self._refuse_other_materials()
            self._refuse_to_vary()
            if self.scatter is None and self.over is not None and (load is None or load.table is None):
                text = "only for a load with a table, which gives the amplitudes and their weights, or for scenarios"
                raise WrongKeyError("over", text)
        return self

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
        """The limits by name, of each quantity one or more: above, below or between with the place, or the window."""
        return {name: [given] if isinstance(given, dict) else given for name, given in (self.limits or {}).items()}

    @property
    def level(self) -> float:
        """The mean is taken over the worst 1 - level of the load: 0 is the mean of all, 1 the worst case."""
        return self.over[1]["cvar"] if isinstance(self.over, tuple) else float(self.over == "worst")

    @cached_property
    def scatter(self) -> "Table | None":
        """The scenarios; None without."""
        if self.scenarios is None:
            return None
        lasts = getattr(self.reading.wear, "cycles", None) is not None
        columns = {name: domain_of(name) for name in self.numbers + ["wear_coefficient"] * lasts}
        return from_table("scenarios", self.scenarios, self.reading, columns)

    @property
    def numbers(self) -> list[str]:
        """The names of all numbers of the contact."""
        material, contact = self.reading.material, self.reading.contact
        rows = (f"material.{name}[{i}]" for name, row in material.rows.items() for i in range(len(row)))
        return [*material.numbers(), *contact.numbers(), *rows]

    @property
    def free(self) -> bool:
        """The modulus is free at three depths or more: no power law is asked for."""
        return "modulus" in self.variables and len(self.variables["modulus"]["at"]) > 2

    @property
    def objective(self) -> str:
        """The quantity that is minimised."""
        return self.minimise if isinstance(self.minimise, str) else next(iter(self.minimise))

    def _refuse_other_materials(self) -> None:
        """Refuse all that needs a power law at once, and say what to write for this material."""
        material = self.reading.material
        if self.free or material.kind == "power law":
            return
        kept = [name for name in self.variables if name not in (*OF_POWER_LAW, "modulus")]
        asked = [f"vary.{name}" for name in self.variables if name not in kept]
        asked += ["hold"] * (self.hold is not None) + ["limits.modulus"] * ("modulus" in self.allowed)
        if not asked:
            return
        first, *others = asked
        as_do = f", as {'do' if others[1:] else 'does'} {' and '.join(others)}" if others else ""
        instead = ""
        if not kept:
            name = next(name for name in ("thickness", "modulus") if len(material.rows.get(name, ())))
            value = float(material.rows[name][0])
            instead = f' and write vary = {{ "material.{name}[0]" = [{0.5 * value:g}, {2.0 * value:g}] }}'
            instead += ", or three depths or more in vary.modulus"
        text = f"needs a power law under [material], not {material.words}{as_do}"
        raise WrongKeyError(first, f"{text}; delete {'them' if others else 'it'}{instead}")

    def _refuse_to_vary(self) -> None:
        """Refuse bounds of what this contact does not have, and of what slips as a whole."""
        contact, load = self.reading.contact, self.reading.load
        if "nu" in self.variables and isinstance(self.reading.material.nu, str):
            raise WrongKeyError("vary.nu", 'follows from k, as [material] nu = "holl"; give it a number')
        for name in self.variables:
            if name not in (*self.numbers, "modulus"):
                raise WrongKeyError(f"vary.{name}", f"is no number of this contact{near_or_all(name, self.numbers)}")
        varied = [name for name in PRESSED if name in self.variables]
        if varied and load is not None and not (load.of_displacement or load.pressed):
            lowest = (self.variables.get(name, [getattr(contact, name)])[0] for name in PRESSED)
            if not load.largest < math.prod(lowest):
                text = f"at the lowest {' and '.join(varied)} the whole contact slips"
                raise WrongKeyError(f"vary.{varied[0]}", text)


# --- what is asked for ------------------------------------------------------------------------------------------------


def output_of(reading: Reading, _: str, values: KeyValues) -> SimpleNamespace:
    """The section [output]: names of quantities of the contact."""
    output, contact = SimpleNamespace(**values), reading.contact
    for name in output.quantities:
        if output.quantities.count(name) > 1:
            raise WrongKeyError("quantities", f'"{name}" is asked for more than once')
    laws = laws_of_scene(reading)
    for name in output.quantities:
        if name not in laws:
            text = f'"{one_line(name)}" is not a quantity of a {contact.kind} contact{near_or_all(name, laws)}'
            raise WrongKeyError("quantities", text)
        if "distance" in laws[name].arguments and edge_distance(reading.design, output) is None:
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
    lasts = wear is not None and wear.cycles is not None and (load is None or load.history is None)
    given = {*PLACES, "F_x", *(("cycles", "wear_coefficient") if lasts else ())}
    return {name: law for name, law in laws_of(scene.contact).items() if given.issuperset(law.arguments)}


def edge_distance(design: DesignSpace | None, output: SimpleNamespace | None = None) -> float | None:
    """The distance from the edge at which a scene wants pressures, or limits them, in m; None if it gives none."""
    own = getattr(output, "distance", None)
    limits = [] if design is None else design.allowed.values()
    limited = (one["distance"] for several in limits for one in several if "distance" in one)
    return next(limited, None) if own is None else own
