"""What a design may vary, hold, limit and minimise. Python and scenes refuse the same, by the same words.

Imports nothing that takes time: a scene is refused before JAX or NumPy are there.
"""

import math
import sys
from collections.abc import Collection, Mapping
from typing import Any, Literal, NamedTuple, get_args

__all__ = [
    "HOLDS",
    "OBJECTIVES",
    "VARIABLES",
    "Complaint",
    "FrettingObjective",
    "GrossSlipObjective",
    "Hold",
    "Kind",
    "Objective",
    "complaint",
    "exponents",
    "free_complaint",
    "one_of",
    "window_complaint",
]

Kind = Literal["fretting", "gross-slip"]
FrettingObjective = Literal["wear_volume", "worn_radius", "deepest_wear"]
GrossSlipObjective = Literal["volume_change", "force_drop"]
Objective = Literal[FrettingObjective, GrossSlipObjective]
Hold = Literal["contact_radius_by_E0", "contact_radius_by_z0"]

OBJECTIVES: dict[Kind, tuple[str, ...]] = {
    "fretting": get_args(FrettingObjective),  # the default first
    "gross-slip": get_args(GrossSlipObjective),
}
HOLDS: tuple[str, ...] = get_args(Hold)
VARIABLES = ("k", "z0", "E0", "modulus")

_ON_K_ALONE = "what a gross-slip contact loses at a fixed depth depends on k alone"


class Complaint(NamedTuple):
    """Why something cannot be asked.

    Attributes:
        key: Of the argument, or the key of a scene: "hold", "vary.z0".
        text: What is wrong with its value.
    """

    key: str
    text: str


def complaint(
    vary: Mapping[str, Any],
    hold: str | None,
    objective: str,
    limits: Collection[str],
    *,
    kind: Kind | None = None,
    flat: bool = False,
) -> Complaint | None:
    """The first thing that is wrong with a question whose single values are allowed; None if nothing is.

    Args:
        vary: What varies, by name: the pair of bounds of k, z0 or E0, or "modulus" with anything.
        hold: What is held.
        objective: What is minimised.
        limits: The names of what is limited.
        kind: The kind of the contact, if it is known.
        flat: The exponent of the reference is known to be 0.
    """
    held = None if hold is None else f'hold = "{hold}"'
    if hold is not None and hold not in HOLDS:
        return Complaint("hold", f"must be {one_of(HOLDS)}: only a free gradient holds it without naming E0 or z0")
    if kind is not None and objective not in OBJECTIVES[kind]:
        return Complaint("minimise", f"must be {one_of(OBJECTIVES[kind])} for a {kind} contact")
    if kind == "gross-slip":
        for name, given in (("hold", hold), ("limits", limits)):
            if given:
                return Complaint(name, f"only for a fretting contact: {_ON_K_ALONE}")
        for name in vary:
            if name != "k":
                return Complaint(f"vary.{name}", f"cannot vary: {_ON_K_ALONE}")
    others = [name for name in vary if name != "modulus"]
    if "modulus" in vary and (held or others):
        text = f"cannot stand beside {held or others[0]}: modulus sets both k and E0/z0^k"
        return Complaint("vary.modulus", f"{text}; vary k and put the window under limits")
    for name in ("z0", "E0"):
        if held and name in vary:
            text = f"cannot vary while {held} sets {str(hold)[-2:]}: only E0/z0^k counts for the contact"
            return Complaint(f"vary.{name}", f"{text}; leave one of both out, or bound E(z) by limits.modulus")
    if "z0" in vary and "E0" in vary:
        return Complaint("vary.E0", "cannot vary beside z0: only E0/z0^k counts for the contact; vary one of them")
    if hold == "contact_radius_by_z0" and "k" in vary and vary["k"][0] <= 0.0 <= vary["k"][1]:
        text = "z0 has no effect at k = 0, which lies within vary.k; hold it by E0, or vary k on one side of 0"
        return Complaint("hold", text)
    if held and "contact_radius" in limits:
        return Complaint("limits.contact_radius", f"cannot be limited while {held} fixes it")
    if set(vary) == {"z0"} and flat:
        return Complaint("vary.z0", "has no effect at k = 0, the exponent of the reference; vary k as well, or E0")
    return None


def free_complaint(
    vary: Collection[str], hold: str | None, objective: str, limits: Collection[str], *, kind: Kind | None = None
) -> Complaint | None:
    """The first thing that is wrong with a question for a free gradient; None if nothing is. See `complaint`."""
    for name in vary:
        if name != "modulus":
            return Complaint(f"vary.{name}", "cannot vary beside a free gradient, which is no power law")
    if kind == "gross-slip":
        return Complaint("vary.modulus", f"cannot vary: {_ON_K_ALONE}")
    if objective not in OBJECTIVES["fretting"]:
        return Complaint("minimise", f"must be {one_of(OBJECTIVES['fretting'])} for a fretting contact")
    if hold not in (None, "contact_radius"):
        return Complaint("hold", 'must be "contact_radius" for a free gradient, or left out')
    for name in limits:
        if name not in ("contact_radius",):
            return Complaint(f"limits.{name}", "is no limit of a free gradient, which takes contact_radius alone")
    if hold and "contact_radius" in limits:
        return Complaint("limits.contact_radius", f'cannot be limited while hold = "{hold}" fixes it')
    return None


def exponents(at: tuple[Any, Any], lower: tuple[Any, Any], upper: tuple[Any, Any]) -> tuple[float, float]:
    """The lowest and the highest k = log(E2/E1)/log(z2/z1) between moduli at two depths, Eq. (1)."""
    span = max(math.log(at[1]) - math.log(at[0]), sys.float_info.min)  # neighbouring numbers can have one logarithm
    lowest, highest = math.log(lower[1]) - math.log(upper[0]), math.log(upper[1]) - math.log(lower[0])
    return lowest / span, highest / span


def window_complaint(at: tuple[Any, Any], lower: tuple[Any, Any], upper: tuple[Any, Any]) -> str | None:
    """What is wrong with a window within which both moduli vary; None if nothing is."""
    lowest, highest = exponents(at, lower, upper)
    if -1.0 < lowest <= highest < 1.0:
        return None
    reached = f"reaches from k = {lowest:.4g} to {highest:.4g}, where k = log(E2/E1)/log(z2/z1)"
    return f"{reached}; only -1 < k < 1 is possible"


def one_of(names: tuple[str, ...]) -> str:
    """The names of several strings to choose from, in words."""
    *first, last = (f'"{name}"' for name in names)
    return f"{', '.join(first)} or {last}"
