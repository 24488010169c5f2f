"""Stresses of random contacts against integrals over all wavenumbers by SciPy, and what a peak takes.

The reference, `tests/reference/half_space_stress.py`, shares no code with the library but the pressures before any
wear, whose transforms it computes by quadrature.
"""

import functools
import time
from typing import Any

import harness
import jax
import numpy as np
from harness import Part, Report

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded
from plgwear_jax.stresses import Stress

reference: Any = harness.importlib.import_module("half_space_stress")

RADIUS, FORCE, E = 5e-3, 10.0, 210e9
DEPTHS = 0.02, 0.3, 1.0, 3.0  # in contact radii
COUNT = 4  # contacts of each kind
X = np.array([-2.0, -1.05, -0.9, -0.5, 0.0, 0.3, 0.6, 1.02])
DIGITS = 2, 3, 4, 5  # 4 by default
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
    if isinstance(material, DepthGraded):  # constant below its last depth
        tops = float(np.max(material.depth)) / a * np.linspace(0.0, 1.0, 240) ** 2
    else:
        tops = np.append(0.0, np.geomspace(1e-7, 1e3, 720))
    tops = np.sort(np.append(tops[abs(tops / z - 1.0) > 1e-6], z))
    middle = np.sqrt(np.maximum(tops[:-1], 1e-9) * tops[1:])
    moduli = np.append(np.asarray(material.modulus_at(middle * a)), float(material.modulus_at(tops[-1] * a)))
    if isinstance(material, PowerLawGraded):  # the skin, whose modulus may be infinite
        moduli[0] = float(material.modulus_at(tops[1] * a)) / (1.0 + float(np.asarray(material.k)))
    return tops, moduli / float(material.modulus_at(a))


def answers(material: Any, a: float) -> Any:
    """The responses of the reference, with the modulus at the depth itself."""
    nu = float(material.nu)
    known = dict[float, list[np.ndarray]]()  # before wear and worn, wavenumbers are the same

    def respond(xi: np.ndarray, z: float) -> list[np.ndarray]:
        if z in known:
            return known[z]
        tops, moduli = divided(material, a, z)
        there = float(material.modulus_at(z * a)) / float(material.modulus_at(a)) if tops.size > 100 else None
        return known.setdefault(z, reference.responses(xi, z, tops, moduli, nu, there))

    return respond


@functools.cache
def nodes() -> tuple[np.ndarray, np.ndarray]:
    """Gauss's nodes and weights, as many as the shortest waves need."""
    return np.polynomial.legendre.leggauss(800)


def rule(a: float) -> tuple[np.ndarray, np.ndarray]:
    """Radii from 0 to a and the weights of an integral over them, which takes a root at a."""
    node, weight = nodes()
    u = 0.25 * np.pi * (1.0 + node)
    return a * np.sin(u), a * 0.25 * np.pi * np.cos(u) * weight


def transform_of(steady: Any, a: float, unit: float, p_0: float) -> Any:
    """The transform of the pressure of a contact of the radius a, in other units of the length."""
    r, weight = rule(a / unit)
    return reference.transform(r, weight, np.asarray(steady.initial_pressure(r * unit)) / p_0)


def worn_transforms(steady: Any, a: float, p_0: float, phi: float) -> tuple[Any, Any]:
    """The transforms of the pressure and the traction in the steady state, in units of a."""
    c, mu, material = float(steady.stick_radius), float(steady.contact.friction), steady.contact.material
    if isinstance(material, PowerLawGraded):  # its singularity is too strong for a rule
        s, ratio = 0.5 * (1.0 + float(np.asarray(material.k))), c / a
        share, flat = (1.0 - phi) / ratio**2, phi / ratio**2 * s / (1.0 + s)
        own, punch = reference.bowl(s, ratio), reference.bowl(s - 1.0, ratio)
        return (lambda xi: share * own(xi) + flat * punch(xi)), (lambda xi: mu * flat * punch(xi))
    r, weight = rule(c / a)
    pressure, traction = (np.asarray(field(r * a)) / p_0 for field in (steady.pressure, steady.traction))
    return reference.transform(r, weight, pressure), reference.transform(r, weight, traction)


def errors(contact: Any, phi: float) -> dict[int, tuple[float, float]]:
    """By digits the largest errors of a stress before any wear and in the end, over the largest pressure before it."""
    force, mu = float(contact.normal_force), float(contact.friction)
    steady = contact.steady(phi * mu * force, digits=max(DIGITS))
    inner = FrettingContact(contact.material, RADIUS, (1.0 - phi) * force, mu).steady(0.0, digits=max(DIGITS))
    a, c, p_0 = (float(x) for x in (steady.contact_radius, steady.stick_radius, steady.peak_initial_pressure))
    p, stuck = transform_of(steady, a, a, p_0), transform_of(inner, c, a, p_0)
    respond = answers(contact.material, a)
    known = [(p, lambda xi: mu * (p(xi) - stuck(xi))), worn_transforms(steady, a, p_0, phi)]
    asked = {digits: contact.steady(phi * mu * force, digits=digits) for digits in DIGITS}
    worst = {digits: [at_the_surface(one, steady, inner, a, p_0), 0.0] for digits, one in asked.items()}
    for z in DEPTHS:
        for worn, (pressure, traction) in enumerate(known):
            want = reference.stresses(pressure, traction, respond, X, z, 40.0 / z)
            for digits, one in asked.items():
                found = np.array(one.stress(X * a, z * a, worn=bool(worn))) / p_0
                worst[digits][worn] = max(worst[digits][worn], float(np.max(abs(found - want))))
    return {digits: (before, after) for digits, (before, after) in worst.items()}


def at_the_surface(asked: Any, steady: Any, inner: Any, a: float, p_0: float) -> float:
    """The error of what the surface carries, the pressure and the traction."""
    x, mu = np.linspace(-1.18, 1.18, 60) * a, float(steady.contact.friction)
    found = asked.stress(x, 0.0)
    pressure, stuck = (np.asarray(one.initial_pressure(abs(x))) for one in (steady, inner))
    return float(np.max(abs(np.array([found.zz + pressure, found.xz + mu * (pressure - stuck)]))) / p_0)


def peaks(contact: Any, digits: int | None = None) -> Any:
    """Both peaks of a contact."""
    steady = contact.steady(2.0, digits=digits)
    return steady.peak_tension, steady.peak_mises


def once(question: Any, contact: Any) -> float:
    """Seconds for a first answer."""
    begin = time.perf_counter()
    jax.block_until_ready(question(contact))
    return time.perf_counter() - begin


def stresses(report: Report, quick: bool) -> None:
    """Errors over random contacts, and times of peaks."""
    random, rows, times, trades = harness.generator(), [], [], []
    a = float(FrettingContact(Elastic(E, 0.3), RADIUS, FORCE, 0.5).steady(0.0).contact_radius)
    for kind in KINDS:
        found = []
        for _ in range(1 if quick else COUNT):
            contact = FrettingContact(half_space(kind, random, a), RADIUS, FORCE, random.uniform(0.1, 1.0))
            found.append(errors(contact, random.uniform(0.0, 0.99)))
        told = np.transpose([one[4] for one in found])
        rows.append([kind, f"{len(found)}", *(f"{x:.0e}" for row in told for x in (np.median(row), max(row)))])
        # On a power law of k < 0 there would be nothing to search.
        contact = FrettingContact(half_space(kind, np.random.default_rng(1), a), RADIUS, FORCE, 0.5)
        peak = jax.jit(lambda contact: peaks(contact)[0])
        first, eager = once(peaks, contact), once(jax.grad(lambda contact: peaks(contact)[0]), contact)
        slope, _ = once(jax.jit(jax.grad(peak)), contact), peak(contact)
        _, taken = harness.seconds(functools.partial(peak, contact), 5 if quick else 25)
        times.append([kind, f"{first:.1f}", f"{eager:.1f}", f"{slope:.1f}", f"{1e3 * taken:.1f}"])
        each = {digits: jax.jit(functools.partial(peaks, digits=digits)) for digits in DIGITS}
        calls = {digits: functools.partial(call, contact) for digits, call in each.items()}
        again = harness.interleave(calls, 3 if quick else 15)
        for digits in DIGITS:
            worst = np.max([one[digits] for one in found], axis=0)
            taken = f"{1e3 * np.median(again[digits]):.1f}"
            trades.append([kind, f"{digits}", *(f"{x:.0e}" for x in worst), taken])
    heads = ["half-space", "contacts", "error, median", "error, worst", "worn, median", "worn, worst"]
    report.table("Errors over the largest pressure, at depths from 0 to 3 contact radii, worn from 0.02", heads, rows)
    heads = ["half-space", "digits", "error, worst", "worn, worst", "both peaks again (ms)"]
    report.table("Fewer digits, which are 4 by default", heads, trades)
    heads = ["half-space", "first answer of both peaks (s)", "first gradient of one (s)"]
    heads += ["the same within jit (s)", "a peak again (ms)"]
    report.table("What peaks take within a process", heads, times)


# --- against another package ------------------------------------------------------------------------------------------

_SLIDING = 1.0 - 1e-9  # F_x/(mu F_N), beside which everything slips
_WIDTH, _CELLS, _BELOW = 10.0, 512, 25  # of the periodic surface in contact radii, and in cells; depths


def of_tamaas(mu: float, nu: float) -> tuple[np.ndarray, np.ndarray, Any]:
    """(x, z, stresses) of a sliding Hertzian contact by Tamaas, in units of the radius and the largest pressure."""
    tamaas: Any = harness.importlib.import_module("tamaas")  # not needed otherwise

    model = tamaas.ModelFactory.createModel(
        tamaas.model_type.volume_2d, [1.2, _WIDTH, _WIDTH], [_BELOW, _CELLS, _CELLS]
    )
    model.E, model.nu = 1.0, nu
    tamaas.ModelFactory.registerVolumeOperators(model)
    cell = _WIDTH / _CELLS
    x = (np.arange(_CELLS) - _CELLS // 2) * cell
    inside = (np.arange(8) + 0.5) / 8.0 - 0.5  # the mean over each cell, from 8 by 8 points
    squares = (x[:, None] + cell * inside) ** 2
    p = np.array([np.sqrt(np.maximum(1.0 - row[:, None, None] - squares, 0.0)).mean((0, 2)) for row in squares])
    strain = np.zeros((*model.displacement.shape[:3], 6))
    stress = np.zeros_like(strain)
    model.operators["boussinesq_gradient"](np.stack([mu * p, 0.0 * p, p], -1), strain)
    model.operators["hooke"](strain, stress)
    xx, yy, zz, _, xz, _ = np.moveaxis(stress[:, :, _CELLS // 2], -1, 0)
    return x, np.linspace(0.0, 1.2, _BELOW), Stress(xx, yy, zz, xz / np.sqrt(2.0))


def tamaas(report: Report, quick: bool) -> None:
    """The stresses of sliding Hertzian contacts against those of Tamaas, on a periodic surface."""
    rows = []
    for mu, nu in ((1e-9, 0.3), (0.5, 0.3), (0.5, 0.0))[: 2 if quick else 3]:
        x, z, theirs = of_tamaas(mu, nu)
        steady = FrettingContact(Elastic(E, nu), RADIUS, FORCE, mu).steady(_SLIDING * mu * FORCE)
        a, p_0 = float(steady.contact_radius), float(steady.peak_initial_pressure)
        near, deep = abs(x) < 2.0, z > 0.09
        ours = steady.stress(x[near] * a, z[:, None] * a)
        worst = max(
            np.max(abs(np.asarray(one) / p_0 - other[:, near])[deep]) for one, other in zip(ours, theirs, strict=True)
        )
        pairs = [(steady.peak_mises / p_0, np.max(theirs.mises)), (steady.peak_tension / p_0, np.max(theirs.principal))]
        hamilton = (1.0 - 2.0 * nu) / 3.0 + mu * np.pi * (4.0 + nu) / 8.0
        told = [f"{float(value):.3f}" for pair in pairs for value in pair]
        rows.append([f"{mu:.1f}", f"{nu:g}", f"{worst:.0e}", *told, f"{hamilton:.3f}"])
    heads = ["mu", "nu", "largest difference", "von Mises", "Tamaas", "tension", "Tamaas", "Hamilton"]
    what = (
        f"Peaks over the largest pressure; differences from 0.1 contact radii down; Tamaas {harness.version('tamaas')}"
    )
    report.table(f"{what}, {_CELLS} by {_CELLS} cells {_WIDTH / _CELLS:.2f} radii wide", heads, rows)


PARTS = {
    "stresses": Part("Stresses in the half-space", [stresses]),
    "tamaas": Part("Stresses of sliding Hertzian contacts by Tamaas", [tamaas]),
}

if __name__ == "__main__":
    harness.run(PARTS)
