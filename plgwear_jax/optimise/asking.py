"""What can be asked, and what is refused."""

import dataclasses
from collections.abc import Mapping

import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import EXPONENT, POSITIVE, check
from plgwear_jax._core.numbers import refuse_traced
from plgwear_jax._core.rules import HOLDS, OBJECTIVES, VARIABLES, Hold, Kind, complaint, one_of, window_complaint
from plgwear_jax._core.words import shown
from plgwear_jax.contact import FrettingContact, GrossSlipContact, check_closed
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.optimise.loads import padded, sorted_loads
from plgwear_jax.optimise.problem import (
    DEEP,
    SHALLOW,
    Bounds,
    Limits,
    Load,
    ModulusWindow,
    Question,
    pair_of,
)
from plgwear_jax.steady.arguments import check_life

__all__ = [
    "asked",
    "given_limits",
    "questioned",
]


_RANGES = {"k": EXPONENT, "z0": POSITIVE, "E0": POSITIVE}


def asked(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: str | None = None,
    limits: Limits | None = None,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | None = None,
) -> Question:
    """The question, or a ValueError; the arguments are those of `design`."""
    limits = given_limits(limits)
    question = questioned(contact, tangential_force, vary, hold, minimise, limits)
    life = _life(question.objective, cycles, wear_coefficient)
    if isinstance(contact, GrossSlipContact):
        return question
    assert tangential_force is not None
    if life is not None:
        check_closed(contact, "a design for a life")
    load = Load(*padded(*sorted_loads(contact, tangential_force, weight, level)), life)
    return dataclasses.replace(question, load=load)


def _life(objective: str, cycles: ArrayLike | None, wear_coefficient: ArrayLike | None) -> ArrayLike | None:
    """The life of a load, or a ValueError."""
    check_life(cycles, wear_coefficient)
    if cycles is None or wear_coefficient is None:
        return None
    if objective != "wear_volume":
        raise ValueError(f"cycles: the {objective} is minimised in the steady state; only wear_volume after cycles")
    check("cycles", cycles, POSITIVE)
    check("wear_coefficient", wear_coefficient, POSITIVE)
    return np.asarray(cycles, float) * np.asarray(wear_coefficient, float)


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
) -> Question:
    """The question without its load, or a ValueError."""
    slips = isinstance(contact, GrossSlipContact)
    if not slips and not isinstance(contact, FrettingContact):
        raise TypeError(f"contact takes a FrettingContact or a GrossSlipContact, not {contact!r}")
    kind: Kind = "gross-slip" if slips else "fretting"
    if objective is None:
        objective = OBJECTIVES[kind][0]
    if hold is not None and hold not in HOLDS:
        raise ValueError(f"hold = {hold!r}: must be {one_of(HOLDS)}, or None")
    pairs = _pairs(vary)
    if not isinstance(contact.material, PowerLawGraded):
        raise ValueError("contact: a design of a power law takes a PowerLawGraded as its reference; see free_design")
    k = contact.material.k
    flat = not isinstance(k, Tracer) and bool(np.any(np.equal(k, 0.0)))
    allowed = [field.name for field in dataclasses.fields(limits) if getattr(limits, field.name) is not None]
    wrong = complaint(pairs, hold, objective, allowed, kind=kind, flat=flat)
    if wrong is not None:
        given = {"minimise": objective, "hold": hold}
        value = f" = {shown(given[wrong.key])}" if wrong.key in given else ""
        raise ValueError(f"{wrong.key}{value}: {wrong.text}")
    if slips and tangential_force is not None:
        raise ValueError("tangential_force: only a fretting contact has one")
    if not slips and tangential_force is None:
        raise ValueError("tangential_force: a fretting contact needs the amplitude of the force, in N")
    window, depths = vary.get("modulus"), None
    if isinstance(window, ModulusWindow):
        pairs, depths = {}, window.at
        for name, *ends in zip((SHALLOW, DEEP), window.lower, window.upper, strict=True):
            pairs[name] = (ends[0], ends[1])
    return Question(contact, None, pairs, depths, limits, objective, hold)


def _pairs(vary: Mapping[str, Bounds | ModulusWindow]) -> dict[str, tuple[ArrayLike, ArrayLike]]:
    """The bounds of what varies, each within its range; of a window its depths."""
    if not isinstance(vary, Mapping):
        raise TypeError(f'vary takes names with bounds, such as {{"k": (-0.9, 0.9)}}, not {vary!r}')
    pairs: dict[str, tuple[ArrayLike, ArrayLike]] = {}
    for name, given in vary.items():
        if name not in VARIABLES:
            raise ValueError(f"vary: {name!r} is not one of {', '.join(VARIABLES)}")
        if name == "modulus":
            if not isinstance(given, ModulusWindow):
                raise ValueError(f"vary: modulus takes a ModulusWindow, not {given!r}")
            said = window_complaint(given.at, given.lower, given.upper)
            if said is not None:
                raise ValueError(f"vary.modulus: {said}")
            pairs[name] = given.at
            continue
        lowest, highest = pair_of(f"vary: {name}", given)
        refuse_traced(f"vary: {name}", (lowest, highest), "the contact and the load may be traced")
        check(f"vary: lowest {name}", lowest, _RANGES[name])
        check(f"vary: highest {name}", highest, _RANGES[name])
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
        pairs[name] = (lowest, highest)
    if not pairs:
        raise ValueError(f"vary is empty: name at least one of {', '.join(VARIABLES)}")
    return pairs
