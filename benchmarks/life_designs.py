"""Designs for a life against brute force: what wears least of a grid of designs, at random questions.

    python benchmarks/life_designs.py
    python benchmarks/life_designs.py --quick

Each question has a random contact, amplitude and life. Where k varies alone the contact radius is held, by E0; else it
is limited to a quarter more or less than that of the reference. The design and all points of the grid are valued by the
same method of the contact after the cycles, one call for a grid, which is made again between the neighbours of its best
point. The excess is of the design over the best point, so that it is negative where the optimum lies between points.
A free gradient keeps the contact radius of the reference. It is compared with the reference, with all corners of its
bounds, with random moduli near it and with any between the bounds, all of them scaled to this radius. Those that then
leave the bounds do not count.
"""

import dataclasses
import itertools
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import harness  # before jax: pins the process
import numpy as np
from harness import short

from plgwear_jax import DepthGraded, FrettingContact, PowerLawGraded, optimise
from plgwear_jax.optimise.question import leaf_of, with_leaf
from plgwear_jax.rules import is_linear

ROUNDS = 3  # of a grid
DIGITS = 1e-4  # of wear over cycles of numerical contacts; by as much may a design lie above the grid
_TO_RADIUS = 8  # steps to the moduli of a contact radius
SEED = 20  # fixed: these questions stay the same


class Question(NamedTuple):
    """A contact under an amplitude for a life, and what may vary."""

    contact: FrettingContact
    force: float
    vary: dict[str, tuple[float, float]]
    life: dict[str, Any]

    @property
    def held(self) -> bool:
        """The contact radius is held, by E0."""
        return [*self.vary] == ["k"]


class Outcome(NamedTuple):
    """What a design wears, the best of all others that were tried, and the seconds that each took."""

    kind: str
    told: str
    mine: float
    best: float
    seconds: float
    others_seconds: float
    certified: bool

    @property
    def excess(self) -> float:
        return self.mine / self.best - 1.0


# --- questions ------------------------------------------------------------------------------------------------------


def _between(rng: np.random.Generator, lower: float, upper: float) -> float:
    return float(lower * (upper / lower) ** rng.uniform())


def _loaded(rng: np.random.Generator, material: Any) -> tuple[FrettingContact, float, dict[str, Any]]:
    """A random contact with this half-space, amplitude and life: from the first cycles to nearly the steady state."""
    radius, normal_force = _between(rng, 1e-3, 2e-2), _between(rng, 2.0, 50.0)
    contact = FrettingContact(material, radius, normal_force, rng.uniform(0.2, 0.8))
    force = rng.uniform(0.1, 0.9) * float(np.asarray(contact.friction)) * normal_force
    a_0 = float(np.asarray(contact.steady(0.0).contact_radius))
    slip = float(np.asarray(contact.steady(force).displacement_amplitude))
    # reduced cycles, of the order of 1 where half of all is worn
    cycles = _between(rng, 0.03, 30.0) * np.pi * a_0**2 / (4.0 * 1e-14 * slip * normal_force)
    return contact, force, {"cycles": float(cycles), "law": 1e-14}


def _power_law(rng: np.random.Generator, *names: str) -> Question:
    a_0 = 1e-4
    material = PowerLawGraded(_between(rng, 20e9, 300e9), _between(rng, 0.3, 3.0) * a_0, rng.uniform(-0.4, 0.4), 0.3)
    contact, force, life = _loaded(rng, material)
    bounds = {"k": (-0.7, 0.7), "E0": (material.E0 / 3.0, 3.0 * material.E0)}
    return Question(contact, force, {name: bounds[name] for name in names}, life)


def _graded(rng: np.random.Generator, name: str) -> Question:
    """A layer whose modulus changes from the surface down to a substrate; its modulus or its thickness varies."""
    modulus = [_between(rng, 60e9, 250e9) for _ in range(2)]
    contact, force, life = _loaded(rng, DepthGraded([0.0, _between(rng, 1e-5, 2e-4)], modulus, 0.3))
    value = float(np.asarray(leaf_of(contact, name)))
    return Question(contact, force, {name: (value / 2.5, 2.5 * value)}, life)


KINDS: dict[str, tuple[int, Callable[[np.random.Generator], Question]]] = {  # with points of the grid a variable
    "closed forms, k": (41, lambda rng: _power_law(rng, "k")),
    "closed forms, k and E0": (15, lambda rng: _power_law(rng, "k", "E0")),
    "graded layer, its modulus": (11, lambda rng: _graded(rng, "material.modulus[0]")),
    "graded layer, its thickness": (11, lambda rng: _graded(rng, "material.depth[1]")),
}

FREE = "free gradient"

# --- designs against grids ------------------------------------------------------------------------------------------


def _timed(call: Callable[[], Any]) -> tuple[Any, float]:
    begin = time.perf_counter()
    result = call()
    return result, time.perf_counter() - begin


def _worn(question: Question, contact: FrettingContact) -> np.ndarray:
    return np.asarray(contact.over_cycles(question.force, question.life["law"]).volume(question.life["cycles"]))


def _radius(contact: FrettingContact) -> np.ndarray:
    return np.asarray(contact.steady(0.0).contact_radius)


def _with(question: Question, values: dict[str, np.ndarray]) -> FrettingContact:
    contact: Any = question.contact
    for name, value in values.items():
        contact = with_leaf(contact, name, value)
    if question.held:
        k, E0 = contact.material.k, contact.material.E0
        contact = with_leaf(contact, "E0", E0 * (_radius(contact) / _radius(question.contact)) ** (3.0 + k))
    return contact


def against_grid(kind: str, question: Question, points: int) -> Outcome:
    contact, force, vary, life = question
    a_0 = float(_radius(contact))
    least, most = a_0 / 1.25, 1.25 * a_0
    limited: dict[str, Any] = {"limits": {"contact_radius": {"between": (least, most)}}}
    asked = {"hold": "contact_radius"} if question.held else limited
    found, seconds = _timed(lambda: optimise.design(contact, force, vary, **asked, **life))
    begin, best, ends = time.perf_counter(), np.inf, vary
    for _ in range(ROUNDS):
        along = {name: (np.linspace if is_linear(name) else np.geomspace)(*ends[name], points) for name in vary}
        grid = dict(zip(vary, map(np.ravel, np.meshgrid(*along.values(), indexing="ij")), strict=True))
        on_grid = _with(question, grid)
        radius = _radius(on_grid)
        worn = np.where(question.held | ((radius >= least) & (radius <= most)), _worn(question, on_grid), np.inf)
        worn = np.where(np.isnan(worn), np.inf, worn)
        best = min(best, float(worn.min()))
        at = np.unravel_index(np.argmin(worn), [points] * len(vary))
        near = zip(along.items(), at, strict=True)
        ends = {name: (values[max(i - 1, 0)], values[min(i + 1, points - 1)]) for (name, values), i in near}
    others_seconds = time.perf_counter() - begin
    mine = float(_worn(question, _with(question, {name: np.array(x) for name, x in found.variables.items()})))
    told = ", ".join(f"{name} = {short(value)}" for name, value in found.variables.items())
    return Outcome(kind, told, mine, best, seconds, others_seconds, found.certified and found.keeps_limits)


# --- free gradients -------------------------------------------------------------------------------------------------


def free(rng: np.random.Generator, tries: int) -> Outcome:
    """A modulus that is free at three depths, against corners, changes of a tenth, and any others within bounds."""
    a_0 = 1e-4
    contact, force, life = _loaded(rng, PowerLawGraded(_between(rng, 60e9, 200e9), a_0, 0.0, 0.3))
    a_0 = float(np.asarray(contact.steady(0.0).contact_radius))
    at, middle = a_0 * np.array([0.03, 0.3, 2.0]), contact.material.E0
    profile = optimise.ModulusProfile(at, np.full(3, middle / 1.8), np.full(3, 1.8 * middle))
    lower, upper = np.asarray(profile.lower), np.asarray(profile.upper)
    question = Question(contact, force, {}, life)
    found, seconds = _timed(lambda: optimise.free_design(contact, force, profile, hold=True, starts=3, **life))
    near = found.modulus * np.exp(0.1 * rng.uniform(-1.0, 1.0, (tries, 3)))
    anywhere = lower * (upper / lower) ** rng.uniform(size=(tries, 3))
    corners = list(itertools.product(*zip(lower, upper, strict=True)))
    others = np.concatenate([np.full((1, 3), middle), corners, near, anywhere])

    def on(moduli: np.ndarray) -> FrettingContact:
        return dataclasses.replace(contact, material=DepthGraded(at, moduli, 0.3))

    def all_worn() -> np.ndarray:
        moduli = others
        for _ in range(_TO_RADIUS):
            moduli = moduli * ((_radius(on(moduli)) / a_0) ** 3)[:, None]
        inside = np.all((moduli >= lower) & (moduli <= upper), axis=1)
        return np.where(inside, _worn(question, on(moduli)), np.inf)

    worn, others_seconds = _timed(all_worn)
    told = ", ".join(f"{short(one / 1e9)}" for one in found.modulus) + " GPa"
    best = float(np.nanmin(worn))
    return Outcome(
        FREE, told, float(_worn(question, on(found.modulus))), best, seconds, others_seconds, found.certified
    )


# --- the report -----------------------------------------------------------------------------------------------------


def outcomes(kind: str, quick: bool, questions: int) -> Iterator[Outcome]:
    rng = np.random.default_rng(SEED)
    for _ in range(1 if quick else questions):
        if kind == FREE:
            yield free(rng, 2 if quick else 20)
        else:
            points, draw = KINDS[kind]
            yield against_grid(kind, draw(rng), 9 if quick else points)


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT, questions: int = 10) -> None:
    """Designs for a life against grids: what they wear, and how long both take."""
    report = harness.Report("life_designs", out, "Designs for a life against brute force, one core, float64", quick)
    worst = -np.inf
    for kind in (*KINDS, FREE):
        those = list(outcomes(kind, quick, questions))
        worst = max(worst, *(one.excess for one in those))
        rows = [
            (
                one.told,
                *(f"{volume:.5e}" for volume in (one.mine, one.best)),
                f"{one.excess:+.1e}",
                *map(short, (one.seconds, one.others_seconds)),
                "yes" if one.certified else "no",
            )
            for one in those
        ]
        tried = "others" if kind == FREE else "grid"
        columns = "design", "m^3 by design", f"best of {tried}", "excess", "s", f"s of {tried}", "certified"
        report.table(kind, columns, rows)
    report.print(
        "The first design of a kind waits for the compiler. Excess: of the design over the best of others, relative."
    )
    harness.goals(
        report,
        (("worst excess over the best of all others, at most", DIGITS, worst, False),),
    )
    report.close()


if __name__ == "__main__":
    harness.run(main)
