"""Random design problems over all variables, loads, objectives and limits, and how they are put to the library.

    programs = random_programs(seed)                what is asked, apart from numbers
    problem = draw(programs[2], seed, 17)           the numbers; always the same ones
    valued(problem, design(problem))                the library's design, by the formulas of `scipy_designs`

Problems come in programs because the library compiles one for all of them.
"""

import dataclasses
from typing import Any, NamedTuple

import numpy as np
from scipy import special
from scipy_designs import (
    WEAR,
    Contact,
    Found,
    Limits,
    Problem,
    Span,
    amplitudes,
    at_material,
    edge_pressure,
    log_contact_radius,
    penetration,
    stick_radius,
)

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded, optimise

# --- drawing --------------------------------------------------------------------------------------------------------

KINDS = (
    "k",
    "k and z0",
    "k and E0",
    "E0",
    "z0",
    "k, radius held",
    "k, gross slip",
)
FIRST, LAST = 1e-3, 0.9995  # amplitudes


class Program(NamedTuple):
    """What is asked, apart from numbers."""

    kind: str
    objective: str
    load: str = "one amplitude"  # or "mean", "CVaR", "worst"
    amplitudes: int = 1
    limits: tuple[str, ...] = ()
    holl: bool = False


def random_programs(seed: int, count: int = 27) -> list[Program]:
    """Each kind in turn."""
    rng = np.random.default_rng(seed)
    return [_random_program(rng, KINDS[n % len(KINDS)]) for n in range(count)]


def _random_program(rng: np.random.Generator, kind: str) -> Program:
    if "gross slip" in kind:
        return Program(kind, str(rng.choice(["volume_change", "force_drop"])), "gross slip", 0)
    objective, holl = str(rng.choice(list(WEAR))), bool(rng.random() < 0.2)
    load = str(rng.choice(["one amplitude", "mean", "CVaR", "worst"], p=[0.4, 0.2, 0.2, 0.2]))
    amplitudes = 1 if load == "one amplitude" else int(rng.integers(2, 21))
    allowed = ["edge_pressure"]
    allowed += [] if "held" in kind else ["contact_radius"]
    allowed += [] if kind in ("E0", "z0") else ["penetration"]  # which falls as the wear does
    allowed += ["modulus"] if kind.startswith("k") else []
    limits = rng.choice(allowed, size=int(rng.choice([0, 1, 2], p=[0.4, 0.3, 0.3])), replace=False)
    return Program(kind, objective, load, amplitudes, tuple(limits.tolist()), holl)


def draw(program: Program, seed: int, number: int) -> Problem:
    """A problem that can be solved: its limits are kept at some point of the box, by a margin."""
    rng = np.random.default_rng([seed, number])
    contact = _random_contact(rng, program)
    vary, hold = _random_variables(rng, program.kind, contact), "held" in program.kind
    forces, weight = _random_load(rng, program, contact)
    level = float(rng.uniform(0.1, 0.6)) if program.load == "CVaR" else float(program.load == "worst")
    problem = Problem(program.kind, contact, forces, weight, level, vary, hold, program.objective, Limits())
    return _with_limits(rng, problem, program.limits) if program.limits else problem


def _log_uniform(rng: np.random.Generator, lower: float, upper: float) -> float:
    return float(np.exp(rng.uniform(np.log(lower), np.log(upper))))


def _random_contact(rng: np.random.Generator, program: Program) -> Contact:
    kind = program.kind
    k = float(rng.choice([-1, 1]) * rng.uniform(0.05, 0.8)) if kind in ("E0", "z0") else float(rng.uniform(-0.6, 0.6))
    nu = "holl" if program.holl else float(rng.uniform(0.1, 0.45))
    E0, R = _log_uniform(rng, 1e9, 4e11), _log_uniform(rng, 1e-3, 0.3)
    if "gross slip" in kind:
        return Contact(E0, _log_uniform(rng, 1e-5, 1e-2), k, nu, R, depth=_log_uniform(rng, 1e-7, 1e-5))
    F_N, mu = _log_uniform(rng, 0.1, 1e5), float(rng.uniform(0.1, 1.0))
    size = np.cbrt(F_N * R / E0)  # of the contact radius
    return Contact(E0, float(size * _log_uniform(rng, 0.03, 30.0)), k, nu, R, F_N, mu)


def _random_span(rng: np.random.Generator) -> Span:
    if rng.random() < 0.5:  # wide
        return float(rng.uniform(-0.97, -0.8)), float(rng.uniform(0.8, 0.97))
    lower = float(rng.uniform(-0.97, 0.5))
    return lower, float(rng.uniform(lower + 0.2, 0.97))


def _random_variables(rng: np.random.Generator, kind: str, contact: Contact) -> dict[str, Span]:
    vary = {"k": _random_span(rng)} if kind.startswith("k") else {}
    for name in ("z0", "E0"):
        if name in kind:
            value = getattr(contact, name)
            vary[name] = value * _log_uniform(rng, 0.1, 0.7), value * _log_uniform(rng, 1.5, 10.0)
    return vary


def _random_load(
    rng: np.random.Generator, program: Program, contact: Contact
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """(forces, weights) of amplitudes from all over the range, and often from near its ends."""
    phi = special.expit(rng.uniform(special.logit(FIRST), special.logit(LAST), program.amplitudes))
    force = contact.friction * contact.normal_force * phi
    return tuple(force.tolist()), tuple(rng.exponential(1.0, phi.size).tolist())


def _with_limits(rng: np.random.Generator, problem: Problem, names: tuple[str, ...]) -> Problem:
    """Limits that a random point of the box keeps by 0.1 to 30 per cent."""
    contact, phi = problem.contact, amplitudes(problem)
    k, log_stiffness = problem.material(rng.uniform(0.0, 1.0, problem.size))
    radius = np.exp(log_contact_radius(contact, k, log_stiffness))

    def margin() -> float:
        return 1 + _log_uniform(rng, 1e-3, 0.3)

    given: dict[str, Any] = {}
    if "edge_pressure" in names:
        distance = _smallest_stick_radius(rng, problem) * _log_uniform(rng, 1e-4, 0.05)
        pressure = edge_pressure(distance / radius, k, phi).max() * contact.normal_force / (np.pi * radius**2)
        given |= {"edge_pressure": float(pressure * margin()), "distance": float(distance)}
    if "penetration" in names:
        given["penetration"] = float(penetration(k, phi).max() * radius**2 / contact.radius * margin())
    if "contact_radius" in names:
        wide = (1.0, 10.0, 1.0), (1.0, 1.0, 10.0)  # of both sides, or of one
        below, above = (1 + (margin() - 1) * share[int(rng.integers(3))] for share in wide)
        given["contact_radius"] = float(radius / below), float(radius * above)
    if "modulus" in names:
        depths = radius * _log_uniform(rng, 0.01, 0.3), radius * _log_uniform(rng, 0.5, 10.0)
        there = [(z, np.exp(log_stiffness + k * np.log(z)), margin() ** 2) for z in depths]
        given["modulus"] = tuple((float(z), float(E / share), float(E * share)) for z, E, share in there)
    return dataclasses.replace(problem, limits=Limits(**given))


def _smallest_stick_radius(rng: np.random.Generator, problem: Problem) -> float:
    """In m, over points all over the box."""
    found = []
    for u in rng.uniform(0.0, 1.0, (200, problem.size)):
        k, log_stiffness = problem.material(u)
        log_radius = log_contact_radius(problem.contact, k, log_stiffness)
        found.append(np.exp(log_radius) * stick_radius(k, amplitudes(problem)).min())
    return float(min(found))


# --- the library ----------------------------------------------------------------------------------------------------


def design(problem: Problem) -> Any:
    """The library's design."""
    given = problem.contact
    material = PowerLawGraded(given.E0, given.z0, given.k, given.nu)
    hold = "contact_radius" if problem.hold else None
    asked: dict[str, Any] = {"minimise": problem.objective, "hold": hold, "vary": problem.vary}
    asked["limits"] = _limits(problem.limits)
    if given.depth is not None:
        return optimise.design(GrossSlipContact(material, given.radius, given.depth), None, **asked)
    force: Any = np.array(problem.forces)
    if force.size > 1:
        asked |= {"weight": np.array(problem.weight), "level": problem.level}
    else:
        force = float(force[0])
    contact = FrettingContact(material, given.radius, given.normal_force, given.friction)
    return optimise.design(contact, force, **asked)


def _limits(given: Limits) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if given.edge_pressure is not None:
        found["edge_pressure"] = {"below": given.edge_pressure, "distance": given.distance}
    if given.contact_radius is not None:
        found["contact_radius"] = {"between": given.contact_radius}
    if given.penetration is not None:
        found["penetration"] = {"below": given.penetration}
    if given.modulus is not None:
        found["modulus_at"] = [{"between": (lowest, highest), "z": z} for z, lowest, highest in given.modulus]
    return found


def valued(problem: Problem, best: Any) -> Found:
    """The library's design by SciPy's formulas."""
    E0, z0, k = (float(getattr(best.contact.material, name)) for name in ("E0", "z0", "k"))
    return at_material(problem, E0, z0, k)
