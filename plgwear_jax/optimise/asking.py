"""What can be asked, and what is refused."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.numbers import refuse_traced
from plgwear_jax._core.words import shown
from plgwear_jax.catalogue import kind_of
from plgwear_jax.contact import PARTIAL_SLIP, FrettingContact, GrossSlipContact, check_closed
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.optimise.loads import padded, sorted_loads
from plgwear_jax.optimise.problem import (
    DEEP,
    SHALLOW,
    Bounds,
    LimitsGiven,
    Load,
    ModulusWindow,
    Objective,
    Question,
    leaf_of,
    limits_of,
    objective_of,
    pair_of,
    with_leaf,
)
from plgwear_jax.rules import HOLDS, OBJECTIVE, VARIABLES, Hold, complaint, domain_of, one_of, window_complaint
from plgwear_jax.steady.arguments import check_life

__all__ = ["asked", "questioned"]


def asked(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: LimitsGiven | None = None,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | None = None,
) -> Question:
    """The question, or a ValueError; the arguments are those of `design`."""
    question = questioned(contact, tangential_force, vary, hold, minimise, limits)
    life = _life(question.objective, cycles, wear_coefficient)
    if isinstance(contact, GrossSlipContact):
        return question
    assert tangential_force is not None
    if life is not None:
        check_closed(contact, "a design for a life")
    force, counting = sorted_loads(contact, tangential_force, weight, level)
    _refuse_gross_slip(question, force[0])
    return dataclasses.replace(question, load=Load(*padded(force, counting), life))


def _refuse_gross_slip(question: Question, force: ArrayLike) -> None:
    """Refuse bounds of the friction and the normal force between which the whole contact slips."""
    varied = [name for name in ("friction", "normal_force") if name in question.bounds]
    if varied:
        lowest = question.contact
        for name in varied:
            lowest = with_leaf(lowest, name, question.bounds[name][0])
        phi = force / (np.asarray(lowest.friction) * np.asarray(lowest.normal_force))
        check(f"tangential_force/(friction * normal_force) at the lowest {' and '.join(varied)}", phi, PARTIAL_SLIP)


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


def questioned(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    hold: Hold | None,
    minimise: Objective | None,
    limits: LimitsGiven | None,
) -> Question:
    """The question without its load, or a ValueError."""
    slips = isinstance(contact, GrossSlipContact)
    if not slips and not isinstance(contact, FrettingContact):
        raise TypeError(f"contact takes a FrettingContact or a GrossSlipContact, not {contact!r}")
    kind = kind_of(contact)
    objective, places = objective_of(OBJECTIVE[kind] if minimise is None else minimise, kind)
    allowed = limits_of(limits, kind)
    if hold is not None and hold not in HOLDS:
        raise ValueError(f"hold = {hold!r}: must be {one_of(HOLDS)}, or None")
    pairs, power = _pairs(contact, vary), isinstance(contact.material, PowerLawGraded)
    for name in ("vary", "limits"):
        if not power and "modulus" in (vary if name == "vary" else allowed):
            raise ValueError(f"{name}.modulus: is a window of a PowerLawGraded; vary material.modulus[0] and so on")
    k = contact.material.k if power else np.nan
    flat = not isinstance(k, Tracer) and bool(np.any(np.equal(k, 0.0)))
    wrong = complaint(pairs, hold, objective, allowed, kind=kind, flat=flat)
    if wrong is not None:
        value = f" = {shown(hold)}" if wrong.key == "hold" else ""
        raise ValueError(f"{wrong.key}{value}: {wrong.text}")
    if hold is not None and not power:
        raise ValueError(f"hold = {shown(hold)}: needs a PowerLawGraded material, which has E0 and z0")
    if slips and tangential_force is not None:
        raise ValueError("tangential_force: only a fretting contact has one")
    if not slips and tangential_force is None:
        raise ValueError("tangential_force: a fretting contact needs the amplitude of the force, in N")
    window, depths = vary.get("modulus"), None
    if isinstance(window, ModulusWindow):
        depths = window.at
        del pairs["modulus"]
        for name, *ends in zip((SHALLOW, DEEP), window.lower, window.upper, strict=True):
            pairs[name] = (ends[0], ends[1])
    return Question(contact, None, pairs, depths, allowed, objective, hold, places)


def _pairs(contact: Any, vary: Mapping[str, Bounds | ModulusWindow]) -> dict[str, tuple[ArrayLike, ArrayLike]]:
    """The bounds of what varies, each within its range; of a window its depths."""
    if not isinstance(vary, Mapping):
        raise TypeError(f'vary takes names with bounds, such as {{"k": (-0.9, 0.9)}}, not {vary!r}')
    pairs: dict[str, tuple[ArrayLike, ArrayLike]] = {}
    for given_name, given in vary.items():
        name = given_name.removeprefix("material.")
        name = name if name in VARIABLES else given_name
        if name == "modulus":
            if not isinstance(given, ModulusWindow):
                raise ValueError(f"vary: modulus takes a ModulusWindow, not {given!r}")
            said = window_complaint(given.at, given.lower, given.upper)
            if said is not None:
                raise ValueError(f"vary.modulus: {said}")
            pairs[name] = given.at
            continue
        _check_leaf(contact, name)
        lowest, highest = pair_of(f"vary: {name}", given)
        refuse_traced(f"vary: {name}", (lowest, highest), "the contact and the load may be traced")
        check(f"vary: lowest {name}", lowest, domain_of(name))
        check(f"vary: highest {name}", highest, domain_of(name))
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
        for end in (lowest, highest):
            with_leaf(contact, name, end)  # whose fields say what they cannot be
        if name in pairs:
            raise ValueError(f"vary: {name} is given twice")
        pairs[name] = (lowest, highest)
    if not pairs:
        raise ValueError(f"vary is empty: name at least one of {', '.join(VARIABLES)}")
    return pairs


def _check_leaf(contact: Any, name: str) -> None:
    """Refuse a variable that is no number of the contact."""
    try:
        leaf = leaf_of(contact, name)
    except (AttributeError, IndexError, TypeError):
        leaf = None
    if isinstance(leaf, str):
        raise ValueError(f'vary: {name} = "{leaf}" follows from k; give the contact a number to vary it')
    if leaf is None or (not isinstance(leaf, Tracer) and np.asarray(leaf).dtype.kind not in "fiu"):
        text = f"{name!r} is not one of {', '.join(VARIABLES)}, nor another number of the contact"
        raise ValueError(f"vary: {text}")
