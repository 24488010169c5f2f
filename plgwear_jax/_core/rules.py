"""What a design may vary, hold, limit and minimise. Python and scenes refuse the same, by the same words.

Imports nothing that takes time: a scene is refused before JAX or NumPy are there.
"""

import math
import sys
from collections.abc import Collection, Mapping
from typing import Any

from .catalogue import PEAKS, QUANTITIES, TRANSIENT, Kind, quantity
from .words import GivenError, near_or_all, one_line

OBJECTIVE: dict[Kind, str] = {"fretting": "wear_volume", "gross-slip": "volume_change"}  # by default
# Besides these any other number of a contact, such as "shape.exponent" or "material.thickness[0]".
VARIABLES = ("k", "z0", "E0", "nu", "radius", "normal_force", "friction", "indenter.E", "indenter.nu")
# What can be minimised after a number of cycles, and what it is then.
BY_THEN = {
    "wear_volume": "transient.wear_volume",
    "wear_depth": "transient.wear_depth",
    "worn_radius": "transient.contact_radius",
}
# What a design can limit after a number of cycles, by its name there.
LASTING = {f"transient.{name}": law for name, law in TRANSIENT.items() if "share" not in law.arguments}
LARGER = ("", "x", "y", "xy")  # which quantities of a front are the better the larger they are
PLACES = {
    "r": "the distance from the axis in m",
    "distance": "the distance from the stick-slip boundary in m",
    "x": "the distance along the motion in m",
    "z": "the depth in m",
    "least": "the smallest depth in m",
    "most": "the largest depth in m",
}

WITHIN = "x", "z", "least", "most"  # places in the half-space, which a scene gives once for all quantities

ON_K_ALONE = "what a gross-slip contact loses at a fixed depth depends on k alone"
OF_POWER_LAW = ("k", "E0", "z0")


def is_linear(name: str) -> bool:
    """Whether a variable is searched on a linear scale: one that is dimensionless and spans no ratio."""
    return name.rpartition(".")[2] in ("k", "nu", "exponent")


def is_after_cycles(name: str) -> bool:
    """Whether a quantity is one after a number of cycles, such as "transient.wear_depth"."""
    return name.startswith("transient.")


class WrongKeyError(GivenError):
    """Why a question, or a section of a scene, is refused.

    Attributes:
        key: The name of the argument, or the key of a scene: "hold", "vary.z0"; empty for a whole section.
        text: What is wrong with its value.
    """

    names_file = False

    def __init__(self, key: str, text: str) -> None:
        super().__init__(f"{key}: {text}")
        self.key, self.text = key, text


def refuse_question(
    vary: Mapping[str, Any],
    hold: bool,
    objective: str,
    limits: Collection[str],
    *,
    kind: Kind,
    flat: bool,
) -> None:
    """Refuse a question whose single values are allowed, but do not go together, by a `WrongKeyError`.

    Args:
        vary: What varies, by name: the pair of bounds of k, z0 or E0, or "modulus" with anything.
        hold: The contact radius is held.
        objective: What is minimised.
        limits: The names of what is limited.
        kind: The kind of the contact.
        flat: The exponent of the reference is known to be 0.
    """
    held = 'hold = "contact_radius"' if hold else None
    if kind == "gross-slip":
        if hold:
            raise WrongKeyError("hold", f"only for a fretting contact: {ON_K_ALONE}")
        for name in vary:
            if name != "k" and not limits and objective in ("volume_change", "force_drop", "force_ratio"):
                raise WrongKeyError(f"vary.{name}", f"cannot vary: {ON_K_ALONE}")
    others = [name for name in vary if name in OF_POWER_LAW]
    if "modulus" in vary and (held or others):
        text = f"cannot be combined with {held or others[0]}: modulus sets both k and E0/z0^k"
        raise WrongKeyError("vary.modulus", f"{text}; vary k and put these bounds under limits")
    for name in ("z0", "E0"):
        if held and name in vary:
            text = f"cannot vary while {held} sets E0: only E0/z0^k counts for the contact"
            raise WrongKeyError(f"vary.{name}", f"{text}; leave one of both out, or limit E(z) by modulus_at")
    if "z0" in vary and "E0" in vary:
        raise WrongKeyError("vary.E0", "cannot vary beside z0: only E0/z0^k counts for the contact; vary one of them")
    if held and "contact_radius" in limits:
        raise WrongKeyError("limits.contact_radius", f"cannot be limited while {held} fixes it")
    if held and objective == "contact_radius":
        raise WrongKeyError("minimise", f"is fixed by {held}")
    if "z0" in vary and "k" not in vary and flat:
        raise WrongKeyError("vary.z0", "has no effect at k = 0, the exponent of the reference; vary k as well, or E0")
    highest = vary["k"][1] if "k" in vary else None
    if isinstance(highest, int | float) and highest < 0.0:
        for name in sorted(PEAKS.intersection([objective, *limits])):
            text = (
                f"{name} is infinite for every k < 0, as the modulus of the surface is; give E(z) as a table or layers"
            )
            raise WrongKeyError("minimise" if name == objective else f"limits.{name}", text)


# --- quantities -------------------------------------------------------------------------------------------------------


def placed_quantity(key: str, name: str, places: Mapping[str, Any], kind: Kind) -> str:
    """The name in the catalogue of a quantity at places, or a `WrongKeyError` that says why there is none.

    Args:
        key: The key under which the quantity is given, for the error.
        name: The quantity; "pressure" at a distance from the stick-slip boundary is `edge_pressure`.
        places: The places that are given, by names such as "r" or "distance".
        kind: The kind of the contact.
    """
    laws = QUANTITIES[kind]
    if is_after_cycles(name) and kind == "fretting":
        laws = LASTING
    if name == "pressure" and "distance" in places:
        name = "edge_pressure"
    if name not in laws:
        raise WrongKeyError(key, f"{one_line(name)} is no quantity of a {kind} contact{near_or_all(name, laws)}")
    needed = [place for place in laws[name].arguments if place in PLACES]
    for place in needed:
        if place not in places:
            raise WrongKeyError(f"{key}.{place}", f"must be a finite number, as {name} needs {PLACES[place]}")
    for place in places:
        if place not in needed:
            text = f"{name} takes {' and '.join(needed)} alone" if needed else f"{name} has one value for the contact"
            raise WrongKeyError(f"{key}.{place}", f"there is no such argument: {text}")
    depths = [places[one] for one in ("least", "most") if isinstance(places.get(one), float | int)]
    if len(depths) == 2 and not depths[0] < depths[1]:
        raise WrongKeyError(f"{key}.most", "must be a larger depth than least")
    return name


_SIDES = ("above", "below", "between")


def limited_quantity(name: str, given: Mapping[str, Any], kind: Kind) -> tuple[str, Any, Any, dict[str, Any]]:
    """What a limit such as {"below": 2e-6} limits, or a `WrongKeyError` about its keys. Values are checked elsewhere.

    Returns:
        The quantity in the catalogue; the lowest and the highest value allowed, each None if there is none; and the
        place at which the quantity is taken, by "r" or "distance", empty if it has none.
    """
    key = f"limits.{name}"
    if not isinstance(given, Mapping):
        raise WrongKeyError(key, f"must be {limit_form(name)}")
    for other in given:
        if other not in (*_SIDES, *PLACES):
            raise WrongKeyError(f"{key}.{other}", f"there is no such key{near_or_all(other, (*_SIDES, *PLACES))}")
    sides, places = ({one: x for one, x in given.items() if one in those} for those in (_SIDES, PLACES))
    found = placed_quantity(key, name, places, kind)
    if not sides:
        raise WrongKeyError(key, f"must be {limit_form(name)}")
    if "between" in sides:
        if len(sides) > 1:
            raise WrongKeyError(
                f"{key}.between", f"cannot be combined with {next(one for one in sides if one != 'between')}"
            )
        try:
            above, below = sides["between"]
        except (TypeError, ValueError):
            raise WrongKeyError(f"{key}.between", "must be [lowest, highest]") from None
    else:
        above, below = sides.get("above"), sides.get("below")
    if isinstance(above, float | int) and isinstance(below, float | int) and not above < below:
        raise WrongKeyError(key, "the lowest value must be below the highest")
    return found, above, below, places


def limit_form(name: str) -> str:
    """How the limit of a quantity is written."""
    law = quantity(name)
    arguments = ("distance",) if name == "pressure" else () if law is None else law.arguments
    form = ", ".join(f"{one} = ..." for one in ("below", *(place for place in arguments if place in PLACES)))
    unit = law.unit if law is not None and law.unit != "1" else None
    return f"{{ {form} }}{f' in {unit}' if unit else ''}, or with above, or with between = [lowest, highest]"


# --- free gradients ---------------------------------------------------------------------------------------------------


def exponents_within(at: Any, between: Any) -> tuple[float, float]:
    """The lowest and the highest k = log(E2/E1)/log(z2/z1) of moduli that vary at two depths, Eq. (1).

    Args:
        at: Both depths in m.
        between: The lowest and the highest modulus at each; refused are those that reach what is no power law.
    """
    span = max(math.log(at[1]) - math.log(at[0]), sys.float_info.min)  # neighbouring numbers can have one logarithm
    (low, high), (low_below, high_below) = (map(math.log, ends) for ends in between)
    lowest, highest = (low_below - high) / span, (high_below - low) / span
    if not -1.0 < lowest <= highest < 1.0:
        reached = f"reaches from k = {lowest:.4g} to {highest:.4g}, where k = log(E2/E1)/log(z2/z1)"
        raise WrongKeyError("vary.modulus.between", f"{reached}; only -1 < k < 1 is possible")
    return lowest, highest


def one_of(names: tuple[str, ...]) -> str:
    """The names of several strings to choose from, in words."""
    *first, last = (f'"{name}"' for name in names)
    return f"{', '.join(first)} or {last}"
