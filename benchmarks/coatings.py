"""Which surface wears least on coatings of finite thickness, and the digits of two quantities of elastic pairs.

The contact is that of the tutorial: 50 N press a steel ball on coatings with moduli between 100 and 350 GPa, and the
friction is 0.6. A factor scales the moduli of each coating, so that the contact radius is the same on all of them.
"""

from collections.abc import Callable
from itertools import product
from typing import Any

import harness
import numpy as np
from harness import Part, Report

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded

STEEL, NU = Elastic(210e9, 0.3), 0.25
FRICTION_FORCE = 0.6 * 50.0  # N
LOW, HIGH = 100e9, 350e9  # Pa, about what the tutorial's coating may have
PHI = (0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.74, 0.9)


def on(material: Any) -> FrettingContact:
    """The contact of the tutorial on another half-space."""
    return FrettingContact(material, radius=0.0125, normal_force=50.0, friction=0.6, indenter=STEEL)


def radius_of(contact: FrettingContact) -> float:
    """The contact radius in m before any wear."""
    return float(contact.steady(0.0).contact_radius)


HOMOGENEOUS = on(Elastic(200e9, NU))


# --- the rule ---------------------------------------------------------------------------------------------------------


def coating(kind: str, thickness: float, surface: float, bottom: float) -> Callable[[float], Any]:
    """A coating with these moduli at its surface and its bottom, which goes on below; by a factor of all moduli.

    Args:
        kind: "power law", from a hundredth of the contact radius on; "linear"; or "layer".
        thickness: In contact radii.
        surface: Young's modulus at the surface in Pa.
        bottom: That at the bottom in Pa.
    """
    t = thickness * radius_of(HOMOGENEOUS)
    if kind == "layer":
        return lambda factor: Layered([t], [factor * surface, factor * bottom], NU)
    if kind == "linear":
        depth = np.linspace(0.0, t, 9)
        modulus = surface + (bottom - surface) * depth / t
    else:
        depth = np.geomspace(0.01 * t / thickness, t, 9)
        modulus = surface * (bottom / surface) ** np.linspace(0.0, 1.0, 9)
    return lambda factor: DepthGraded(depth, factor * modulus, NU)


def wear_at_the_same_radius(made: Callable[[float], Any], phi: tuple[float, ...] = PHI) -> np.ndarray:
    """The worn volumes on a coating over those on the homogeneous one of the same contact radius, minus 1, in %."""
    factor, missed = 1.0, np.inf
    contact = HOMOGENEOUS
    while abs(missed - 1.0) >= 1e-6:
        contact = on(made(factor))
        missed = radius_of(contact) / radius_of(HOMOGENEOUS)
        factor *= missed**5
    ours, others = (
        np.array([float(one.steady(x * FRICTION_FORCE).wear_volume) for x in phi]) for one in (contact, HOMOGENEOUS)
    )
    return 100.0 * (ours / missed**4 / others - 1.0)  # volumes go with the fourth power of the radius


def rule(report: Report, quick: bool) -> None:
    rows = []
    kinds = ("power law", "linear", "layer")[: 1 if quick else None]
    for kind, thickness, stiff in product(kinds, (1.0, 2.0, 3.0), (False, True)):
        moduli = (HIGH, LOW) if stiff else (LOW, HIGH)
        more = wear_at_the_same_radius(coating(kind, thickness, *moduli))
        surface = "stiff" if stiff else "compliant"
        rows.append([kind, f"{thickness:g}", surface, *(f"{x:+.1f}" for x in more)])
    told = "Change of the worn volume in % against a homogeneous body of the same contact radius"
    report.table(
        f"{told}; thickness in contact radii", ["gradient", "thickness", "surface", *(f"phi {x:g}" for x in PHI)], rows
    )


# --- digits -----------------------------------------------------------------------------------------------------------


def pairs(report: Report, quick: bool) -> None:
    """The worst difference between 4 digits, the default, and 5 on elastic pairs, at amplitudes from 0.05 to 0.95."""
    radius = radius_of(HOMOGENEOUS)
    bodies = {
        "a power law, k = 0.2154": PowerLawGraded(248.5e9, 1e-4, 0.2154, NU),
        "a power law, k = -0.5": PowerLawGraded(200e9, 1e-4, -0.5, NU),
        "a layer": Layered([radius], [LOW, HIGH], NU),
        "a table": DepthGraded(np.geomspace(0.01, 3.0, 9) * radius, np.geomspace(LOW, HIGH, 9), NU),
    }
    rows = []
    for name, body in bodies.items():
        contact, worst = on(body), np.zeros(3)
        for phi in (0.05, 0.2, 0.5, 0.74, 0.95)[: 1 if quick else None]:
            read = []
            for wanted in (4, 5):
                steady = contact.steady(phi * FRICTION_FORCE, digits=wanted)
                inside = [0.01 * radius, 1e-5]
                read.append([*np.asarray(steady.edge_pressure(np.array(inside))), float(steady.deepest_wear)])
            worst = np.maximum(worst, np.abs(np.divide(*read) - 1.0))
        rows.append([name, *(f"{x:.1e}" for x in worst)])
    heads = ["half-space under steel", "pressure at 0.01 a_0", "pressure at 10 um", "largest wear depth"]
    report.table("The worst difference of 4 digits from 5 at phi from 0.05 to 0.95", heads, rows)


PARTS = {
    "rule": Part("Stiff and compliant surfaces of coatings", [rule]),
    "pairs": Part("Digits of elastic pairs", [pairs]),
}

if __name__ == "__main__":
    harness.run(PARTS)
