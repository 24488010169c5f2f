"""What can be asked, and what is refused."""

from collections.abc import Mapping

import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import EXPONENT, POSITIVE, check
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.optimise.loads import padded, sorted_loads
from plgwear_jax.optimise.problem import (
    DEEP,
    POWERS,
    SHALLOW,
    Bounds,
    Hold,
    Limits,
    ModulusWindow,
    Question,
    Task,
    pair_of,
)

__all__ = [
    "asked",
    "given_limits",
    "questioned",
]


_FRETTING_OBJECTIVES = tuple(POWERS)
_GROSS_SLIP_OBJECTIVES = ("volume_change", "force_drop")
_VARIABLES = {"k": EXPONENT, "z0": POSITIVE, "E0": POSITIVE}


def asked(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: str | None = None,
    limits: Limits | None = None,
) -> tuple[Question, Task]:
    """The question and its numbers, or a ValueError; the arguments are those of `design`."""
    limits = given_limits(limits)
    question, bounds, depths = questioned(contact, tangential_force, vary, hold, minimise, limits)
    if isinstance(contact, GrossSlipContact):
        return question, Task(contact, None, None, bounds, depths, limits)
    assert tangential_force is not None
    phi, weight = padded(*sorted_loads(contact, tangential_force, weight, level))
    return question, Task(contact, phi, weight, bounds, depths, limits)


def given_limits(limits: Limits | None) -> Limits:
    """The limits, none by default, or a TypeError."""
    if limits is not None and not isinstance(limits, Limits):
        raise TypeError(f"limits takes a Limits, such as Limits(edge_pressure=5e8, distance=1e-6), not {limits!r}")
    return limits or Limits()


def questioned(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    hold: Hold | None,
    objective: str | None,
    limits: Limits,
) -> tuple[Question, dict[str, tuple[ArrayLike, ArrayLike]], tuple[ArrayLike, ArrayLike] | None]:
    """The question, the bounds of the variables, and the depths of the moduli if they are these, or a ValueError."""
    slips = isinstance(contact, GrossSlipContact)
    if not slips and not isinstance(contact, FrettingContact):
        raise TypeError(f"contact takes a FrettingContact or a GrossSlipContact, not {contact!r}")
    objectives = _GROSS_SLIP_OBJECTIVES if slips else _FRETTING_OBJECTIVES
    if objective is None:
        objective = objectives[0]
    if objective not in objectives:
        raise ValueError(f"minimise = {objective!r} is not one of {', '.join(objectives)}")
    if hold not in (None, "contact_radius_by_E0", "contact_radius_by_z0"):
        raise ValueError(f'hold = {hold!r} is neither "contact_radius_by_E0", "contact_radius_by_z0" nor None')
    bounds, depths = _variables(vary, hold, contact.material.k)
    if slips:
        if set(bounds) != {"k"} or hold is not None or limits != Limits() or tangential_force is not None:
            raise ValueError("gross slip at a fixed depth depends on k alone: vary k alone, without hold, limits, load")
    elif tangential_force is None:
        raise ValueError("tangential_force: a fretting contact needs the amplitude of the force, in N")
    elif hold is not None and limits.contact_radius is not None:
        raise ValueError("limits: contact_radius cannot be limited while hold fixes it")
    return Question(objective, hold), bounds, depths


def _variables(
    vary: Mapping[str, Bounds | ModulusWindow], hold: str | None, k: ArrayLike
) -> tuple[dict[str, tuple[ArrayLike, ArrayLike]], tuple[ArrayLike, ArrayLike] | None]:
    """The bounds of the variables of the search, and the depths of the moduli if they are these."""
    if not isinstance(vary, Mapping):
        raise TypeError(f'vary takes names with bounds, such as {{"k": (-0.9, 0.9)}}, not {vary!r}')
    window = vary.get("modulus")
    if window is not None:
        if not isinstance(window, ModulusWindow):
            raise ValueError(f"vary: modulus takes a ModulusWindow, not {window!r}")
        if set(vary) != {"modulus"}:
            raise ValueError("vary: modulus sets both k and E0/z0^k: nothing else can vary beside it")
        if hold is not None:
            text = "with the contact radius held only k can vary: vary k, and put the window under limits"
            raise ValueError(f"vary: modulus sets both k and E0/z0^k; {text}")
        lowest, highest = window.exponents()
        if not (lowest > -1.0 and highest < 1.0):
            raise ValueError(f"vary: modulus allows k from {lowest:.3g} to {highest:.3g}: allowed is -1 < k < 1")
        ends = zip(window.lower, window.upper, strict=True)
        return dict(zip((SHALLOW, DEEP), ends, strict=True)), window.at
    bounds: dict[str, tuple[ArrayLike, ArrayLike]] = {}
    for name, pair in vary.items():
        if name not in _VARIABLES:
            raise ValueError(f"vary: {name!r} is not one of {', '.join(_VARIABLES)}, modulus")
        lowest, highest = pair_of(f"vary: {name}", pair)
        check(f"vary: lowest {name}", lowest, _VARIABLES[name])
        check(f"vary: highest {name}", highest, _VARIABLES[name])
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
        bounds[name] = (lowest, highest)
    if not bounds:
        raise ValueError(f"vary is empty: name at least one of {', '.join(_VARIABLES)}, modulus")
    if "z0" in bounds and "E0" in bounds:
        raise ValueError("vary: a contact depends on z0 and E0 only through E0/z0^k: vary one of them")
    if hold is not None and set(bounds) != {"k"}:
        raise ValueError("vary: with the contact radius held only k can vary: z0 and E0 enter only through E0/z0^k")
    if bounds.keys() == {"z0"} and not isinstance(k, Tracer) and np.any(np.equal(k, 0.0)):
        raise ValueError("vary: z0 has no effect at k = 0")
    if hold == "contact_radius_by_z0" and np.sign(bounds["k"][0]) * np.sign(bounds["k"][1]) <= 0.0:
        raise ValueError("hold: z0 has no effect at k = 0; for contact_radius_by_z0 the bounds of k need one sign")
    return bounds, None
