"""Numbers that are possible, but probably meant in another unit: one warning for each question, and it goes on."""

import contextlib
import contextvars
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from jax.core import Tracer

from .units import written

WIDE, FAR, SOON = 1.0, 1e-3, 100.0  # m, m and cycles, beyond or below which a number is doubted
MADE, SMOOTH = (1e9, 1e12), 5e-8  # Pa, what coatings are made of; m, a depth that roughness hides
STICKY = 3.0  # a coefficient of friction that dry metals do not reach
SMALL, THICK = 0.3, 0.1  # of the radius of the indenter, what formulas hold for; m, what no coating has
FELT = 0.1, 3.0  # contact radii, the range of depths that influences a contact


class DoubtfulInputWarning(UserWarning):
    """A number is possible, but probably in another unit than that of its argument."""


_told: contextvars.ContextVar[set[str] | None] = contextvars.ContextVar("told", default=None)
_EVERYTHING = "all that can be said"


@contextlib.contextmanager
def one_question(*told: str) -> Iterator[None]:
    """Each doubt is told once within this context, and those that are told already are not told again."""
    token = _told.set({*told, *(_told.get() or ())})
    try:
        yield
    finally:
        _told.reset(token)


def own_numbers() -> contextlib.AbstractContextManager[None]:
    """What the library asks by numbers of its own is not doubted."""
    return one_question(_EVERYTHING)


def doubt(*lines: str | None) -> None:
    """Warn of these doubts, unless this question has told them."""
    told = _told.get()
    for line in lines:
        if line is not None and (told is None or told.isdisjoint((line, _EVERYTHING))):
            if told is not None:
                told.add(line)
            warnings.warn(line, DoubtfulInputWarning, stacklevel=_outside())


def _outside() -> int:
    """How many calls up the caller of the library is, whose line a warning names."""
    frame, level, own = sys._getframe(2), 2, __name__.partition(".")[0]
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] in (own, "contextlib"):
        frame, level = frame.f_back, level + 1
    return level


def _readable(value: Any) -> bool:
    return not isinstance(value, Tracer) and np.size(value) > 0


def of_contact(contact: Any) -> Iterator[str]:
    """What is doubtful of a contact: an indenter wider than a metre, a layer thicker than its radius, much friction."""
    radius = contact.radius
    if not _readable(radius):
        return
    radius = np.asarray(radius)  # while JAX traces, it would trace what is asked of its own arrays
    if np.max(radius) > WIDE:
        yield f"radius = {np.max(radius):g}: is the indenter wider than 1 m? radius is in m"
    friction = getattr(contact, "friction", 0.0)
    if _readable(friction) and (most := np.max(np.asarray(friction))) > STICKY:
        yield f"friction = {most:g}: in percent? friction is a force over a force, mostly below 1"
    thickness = layers(contact.material)
    if np.size(thickness) and np.max(thickness) > np.min(radius):
        sizes = f"{written(float(np.max(thickness)), 'm')}, thicker than the radius of the indenter"
        yield f"thickness: a layer of {sizes}, {written(float(np.min(radius)), 'm')}? thickness is in m"


def layers(material: Any) -> Any:
    """The thicknesses of layers in m; none of a modulus without jumps."""
    thickness, depth = getattr(material, "thickness", None), getattr(material, "depth", None)
    if thickness is not None:
        return np.asarray(thickness) if _readable(thickness) else ()
    if depth is None or np.ndim(depth) != 1 or not _readable(depth):
        return ()
    z = np.asarray(depth)
    return np.diff(z[1:][np.diff(z) == 0.0], prepend=0.0)  # a depth that is given twice is an interface


def of_input(contact: Any, contact_radius: float | None, onset: float | None) -> Iterator[str]:
    """What is doubtful of the numbers of an input file, as values in wrong units give it.

    Args:
        contact: The contact of the file.
        contact_radius: In m; None if it is not known.
        onset: The displacement amplitude in m at which gross slip begins; None if it is not known.
    """
    yield from of_contact(contact)
    material, radius = contact.material, contact.radius
    about, high = ("depth", contact.depth) if hasattr(contact, "depth") else ("contact radius", contact_radius)
    if high is not None and high > SMALL * radius:
        said = f"the {about}, {written(high, 'm')}, is {high / radius:.2g} times the radius of the indenter"
        yield f"{said}; the formulas hold for small ones; check the units: moduli are in Pa, all else in m and N"
    elif onset is not None and (said := of_onset(onset)):
        yield said
    if hasattr(material, "depth") and contact_radius is not None:
        before, last = material.modulus[-2:]
        end = material.depth[-1] / contact_radius
        if end < FELT[1] and abs(last - before) > 0.01 * last:
            said = f"[material] table: ends at {end:.2g} contact radii, where E(z) still changes"
            yield f"{said}; below that its last modulus is taken, {written(last, 'Pa')}"
    z0 = getattr(material, "z0", 0.0)
    if z0 > THICK:
        yield f"[material] z0 = {z0:g}: a coating {z0:g} m thick? z0 is in m"


def of_onset(displacement: Any) -> str | None:
    """What is doubtful of the displacement amplitude at which gross slip begins."""
    if not _readable(displacement) or not np.max(displacement) > FAR:
        return None
    begins = f"gross slip begins at {written(float(np.max(displacement)), 'm')}, beyond 1 mm"
    return f"{begins}; are modulus, force, radius and rig stiffness in Pa, N, m and N/m?"


def of_wear(cycles: float, grows: bool = False) -> str | None:
    """What is doubtful of the cycles after which a scar is worn, or if it grows without an end, has grown."""
    if not cycles < SOON:
        return None
    if grows:
        said = f"the scar is ten times as wide as the contact after {cycles:.2g} cycles"
        return f"{said}; are the displacement in m and the wear coefficient in 1/Pa?"
    unit = "is the unit of the wear coefficient right? 1e-5 mm^3/(N m) is 1e-14 1/Pa"
    return f"99 % is worn after {cycles:.2g} cycles; {unit}"


def of_design(depth: Any, modulus: Any, contact_radius: float, wear_depth: float) -> str | None:
    """What is doubtful of the best coating: moduli that nobody can make, and wear that roughness hides.

    Args:
        depth: Some depths in m, rising, beyond both ends of those that are felt.
        modulus: Young's modulus there in Pa.
        contact_radius: In m.
        wear_depth: The largest one, in m.
    """
    felt, found = contact_radius * np.geomspace(*FELT, 16), []
    there = np.exp(np.interp(np.log(felt), np.log(depth), np.log(modulus)))
    worst = np.argmax(np.maximum(there / MADE[1], MADE[0] / there))
    if not MADE[0] <= there[worst] <= MADE[1]:
        place = f"{written(float(there[worst]), 'Pa')} at a depth of {written(float(felt[worst]), 'm')}"
        found.append(f"{place} is outside 1 to 1,000 GPa: limit E(z) by limits = {{ modulus = ... }}")
    if wear_depth < SMOOTH:
        found.append(f"the wear is only {written(wear_depth, 'm')} deep: the roughness of most surfaces is larger")
    return "; ".join(found) or None
