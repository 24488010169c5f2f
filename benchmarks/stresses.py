"""Stresses of random contacts against integrals over all wavenumbers by SciPy, and what a peak takes.

The reference, `tests/reference/half_space_stress.py`, shares no code with the library but the pressures before any
wear, whose transforms it computes by quadrature.
"""

import functools
from typing import Any

import harness
import jax
import numpy as np
from harness import Part, Report

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded

reference: Any = harness.importlib.import_module("half_space_stress")

RADIUS, FORCE, E = 5e-3, 10.0, 210e9
DEPTHS = 0.05, 0.3, 1.0, 3.0  # in contact radii
X = np.array([-2.0, -1.05, -0.9, -0.5, 0.0, 0.3, 0.6, 1.02])
KINDS = "homogeneous", "a power law", "layers", "a table"


def half_space(kind: str, random: np.random.Generator, a: float) -> Any:
    """A half-space of this kind, with depths in units of a contact radius a in m."""
    nu = random.uniform(0.0, 0.49)
    if kind == "homogeneous":
        return Elastic(E, nu)
    if kind == "a power law":
        return PowerLawGraded(E, 1e-4, random.uniform(-0.9, 0.9), nu)
    depths = a * np.sort(np.exp(random.uniform(np.log(0.05), np.log(3.0), 3)))
    moduli = E * 5.0 ** random.uniform(-0.5, 0.5, 4)
    if kind == "layers":
        return Layered(np.diff(depths, prepend=0.0), moduli, nu)
    return DepthGraded(np.append(0.0, depths), moduli, nu)


def divided(material: Any, a: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths in contact radii at which thin layers begin, one of them z, and their moduli over some modulus."""
    if isinstance(material, Elastic):
        return np.zeros(1), np.ones(1)
    if isinstance(material, Layered):
        return np.append(0.0, np.cumsum(material.thickness)) / a, np.asarray(material.modulus) / E
    tops = np.append(0.0, np.geomspace(1e-6, 1e3, 250))
    tops[np.argmin(abs(tops - z))] = z
    middle = np.sqrt(np.maximum(tops[:-1], 1e-9) * tops[1:])
    moduli = np.append(np.asarray(material.modulus_at(middle * a)), float(material.modulus_at(tops[-1] * a)))
    if isinstance(material, PowerLawGraded):  # the skin, whose modulus may be infinite
        moduli[0] = float(material.modulus_at(tops[1] * a)) / (1.0 + float(np.asarray(material.k)))
    return tops, moduli / float(material.modulus_at(a))


def answers(material: Any, a: float) -> Any:
    """The responses of the reference, with the modulus at the depth itself."""
    nu = float(material.nu)

    def respond(xi: np.ndarray, z: float) -> list[np.ndarray]:
        tops, moduli = divided(material, a, z)
        parts = [reference.responses(q, z, tops, moduli, nu) for q in np.array_split(xi, 1 + xi.size // 200)]
        found = [np.concatenate(rows) for rows in zip(*parts, strict=True)]
        if tops.size > 100:
            place, ratio = np.searchsorted(tops, z, side="right") - 1, nu / (1.0 - nu)
            there = float(material.modulus_at(z * a)) / float(material.modulus_at(a)) / moduli[place]
            for n in (0, 1, 4, 5):
                normal = ratio * found[n + 2 - n % 2]
                found[n] = normal + there * (found[n] - normal)
            found[8] = there * found[8]
        return found

    return respond


def transform_of(steady: Any, a: float, unit: float, p_0: float) -> Any:
    """The transform of the pressure of a contact of the radius a, in other units of the length."""
    node, weight = np.polynomial.legendre.leggauss(250)
    u = 0.25 * np.pi * (1.0 + node)
    r, weight = a / unit * np.sin(u), a / unit * 0.25 * np.pi * np.cos(u) * weight
    return reference.transform(r, weight, np.asarray(steady.initial_pressure(r * unit)) / p_0)


def error(contact: Any, phi: float) -> float:
    """The largest error of a stress, over the largest pressure."""
    force, mu = float(contact.normal_force), float(contact.friction)
    steady = contact.steady(phi * mu * force)
    inner = FrettingContact(contact.material, RADIUS, (1.0 - phi) * force, mu).steady(0.0)
    a, c, p_0 = (float(x) for x in (steady.contact_radius, steady.stick_radius, steady.peak_initial_pressure))
    p, stuck = transform_of(steady, a, a, p_0), transform_of(inner, c, a, p_0)
    respond, worst = answers(contact.material, a), 0.0
    for z in DEPTHS:
        want = reference.stresses(p, lambda xi: mu * (p(xi) - stuck(xi)), respond, X, z, min(40.0 / z, 500.0))
        worst = max(worst, float(np.max(abs(np.array(steady.stress(X * a, z * a)) / p_0 - want))))
    return worst


_peak = jax.jit(lambda contact: contact.steady(2.0).peak_tension)


def stresses(report: Report, quick: bool) -> None:
    """Errors over random contacts, and milliseconds for a peak once it is compiled."""
    random, rows = harness.generator(), []
    a = float(FrettingContact(Elastic(E, 0.3), RADIUS, FORCE, 0.5).steady(0.0).contact_radius)
    for kind in KINDS:
        found = []
        for _ in range(1 if quick else 12):
            contact = FrettingContact(half_space(kind, random, a), RADIUS, FORCE, random.uniform(0.1, 1.0))
            found.append(error(contact, random.uniform(0.0, 0.99)))
        contact = FrettingContact(half_space(kind, random, a), RADIUS, FORCE, 0.5)
        _, taken = harness.seconds(functools.partial(_peak, contact), 5 if quick else 25)
        rows.append([kind, f"{np.median(found):.0e}", f"{max(found):.0e}", f"{1e3 * taken:.0f}"])
    heads = ["half-space", "error, median", "error, worst", "ms for a peak"]
    report.table("Errors over the largest pressure, from 0.05 to 3 contact radii below the surface", heads, rows)


PARTS = {"stresses": Part("Stresses in the half-space", stresses)}

if __name__ == "__main__":
    harness.run(PARTS)
