"""Designs, on one core: against SciPy's searches, and for a life against brute force.

    python benchmarks/designs.py
    python benchmarks/designs.py life_designs --quick

designs: the best exponent of 10,000 amplitudes, and the optimum of random problems. `random_designs` draws variables,
loads, objectives and limits. What the library finds is valued by SciPy's formulas, like everything else: its excess is
over the best that SciPy finds from 20 starts with several methods, among what keeps the limits. "SciPy alone" is each
suitable method once, from the middle of the box. PLGWEAR_SEED repeats the problems.

life_designs: random contacts, amplitudes and lives. Where k varies alone the contact radius is held, by E0; else it is
limited to a quarter more or less than that of the reference. The design and all points of a grid are valued by runs,
one call for a grid, which is made again between the neighbours of its best point. The excess is of the design over the
best point, so that it is negative where the optimum lies between points.
"""

import itertools
import math
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import harness  # before jax: pins the process
import jax
import jax.numpy as jnp
import numpy as np
import random_designs
import scipy_designs
from harness import Part, Report, short
from random_designs import Program, design, valued
from scipy_designs import Found, Problem

from plgwear_jax import DepthGraded, FrettingContact, PowerLawGraded, fretting, optimise
from plgwear_jax._core.leaves import leaf_of, with_leaf
from plgwear_jax.rules import is_linear

WORSE = 1e-6  # by as much is a value not that of the optimum
BOUNDS = (-0.95, 0.95)
DESIGNS = 10_000


def timed(call: Callable[[], Any]) -> tuple[Any, float]:
    begin = time.perf_counter()
    result = jax.block_until_ready(call())
    return result, time.perf_counter() - begin


# --- random problems ------------------------------------------------------------------------------------------------


class Outcome(NamedTuple):
    """One problem and what came out."""

    problem: Problem
    alone: dict[str, Found]
    best: Found
    best_seconds: float
    mine: Found
    design: Any
    seconds: float

    @property
    def excess(self) -> float:
        """Of the library's value over SciPy's best, relative."""
        return self.mine.value / self.best.value - 1

    @property
    def lowest(self) -> float:
        kept = [found.value for found in (self.best, self.mine) if found.violation < 1e-9]
        return min(kept, default=math.inf)

    def is_wrong(self, found: Found) -> bool:
        return found.violation > WORSE or not found.value <= self.lowest * (1 + WORSE)


def solved(program: Program, number: int, starts: int) -> Outcome:
    problem = random_designs.draw(program, harness.SEED, number)
    design(problem)
    mine, seconds = timed(lambda: design(problem))
    best, best_seconds = timed(lambda: scipy_designs.best(problem, starts))
    return Outcome(problem, scipy_designs.alone(problem), best, best_seconds, valued(problem, mine), mine, seconds)


def _median(seconds: Iterable[float]) -> str:
    return short(1e3 * float(np.median(list(seconds))))


def _row(name: str, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    known = (
        sum(bool(getattr(one.design, what)) for one in outcomes)
        for what in ("converged", "certified", "scan_found_nothing_better")
    )
    missed = max((one.mine.violation for one in outcomes if one.problem.limited), default=None)
    return (
        name,
        str(len(outcomes)),
        f"{max(one.excess for one in outcomes):.1e}",
        str(sum(one.is_wrong(one.best) for one in outcomes)),
        "" if missed is None else f"{missed:.1e}",
        ", ".join(map(str, known)),
        _median(one.seconds for one in outcomes),
        _median(one.best_seconds for one in outcomes),
    )


def problems(report: Report, quick: bool) -> None:
    """What the library finds, and what SciPy finds."""
    programs = random_designs.random_programs(harness.SEED, 1 if quick else 27)
    numbered = zip(range(3 if quick else 200), itertools.cycle(programs))
    outcomes = [solved(program, number, 3 if quick else 20) for number, program in numbered]
    rows: list[tuple[str, ...]] = []
    groups: tuple[Callable[[Problem], str], ...] = (
        lambda p: p.kind,
        lambda p: p.load,
        lambda p: p.objective,
        lambda p: "with limits" if p.limited else "without limits",
        lambda p: "all",
    )
    for group in groups:
        names = dict.fromkeys(group(one.problem) for one in outcomes)
        rows += [_row(name, [one for one in outcomes if group(one.problem) == name]) for name in names]
        rows.append(())
    columns = ["", "problems", "worst excess", "SciPy's best worse", "limits missed by"]
    columns += ["converged, certified, scan_found_nothing_better", "ms", "ms, SciPy's best"]
    report.table("What plgwear finds, against the best of SciPy from many starts", columns, rows[:-1])
    rows = []
    for method in scipy_designs.METHODS:
        met = [(one, one.alone[method]) for one in outcomes if method in one.alone]
        wrong = [found for one, found in met if one.is_wrong(found)]
        counts = (
            len(met),
            len(wrong),
            sum(found.success for found in wrong),
            sum(found.value > one.lowest * 1.01 for one, found in met),
            sum(found.violation > WORSE for _, found in met),
            sum(not found.success for _, found in met),
        )
        if met:
            rows.append((method, *map(str, counts), _median(found.seconds for _, found in met)))
    columns = ("method", "problems", "wrong optimum", "unnoticed", "worse by > 1 %", "limit missed", "gave up", "ms")
    report.table("What SciPy finds alone, from the middle of the box", columns, rows)
    report.print(
        f"worst excess: of plgwear's value over SciPy's best, relative. SciPy's best worse: by more than {WORSE:.0e}.\n"
        "wrong optimum: worse than the best known, or a limit missed, by more than 1e-6; unnoticed: and said to have\n"
        "converged. ms: median time a problem, compiled."
    )
    for number, one in enumerate(outcomes):
        said = ", ".join(name for name in ("converged", "certified") if not getattr(one.design, name))
        if one.excess > 1e-9 or one.mine.violation > 1e-9 or said:
            told = f"problem {number} ({one.problem.kind}; {one.problem.objective}; {one.problem.load}): excess "
            missed = f"{one.excess:.1e}, limits missed by {one.mine.violation:.1e}"
            report.print(f"{told}{missed}{f', not {said}' if said else ''}")
    apart = max(abs(float(one.design.value) / one.mine.value - 1) for one in outcomes)
    report.print(f"The formulas of both are apart by {apart:.1e} at most.")


# --- 10,000 amplitudes ----------------------------------------------------------------------------------------------

# The points of a scan before, and how many amplitudes.
LOOPS = {"SciPy, the reduced form": (0, DESIGNS), "SciPy, the reduced form, after a scan of 65": (65, 2000)}
ANOTHER = 1e-4  # worse by as much, it is another optimum: Brent's method stops short of a bound by less


def amplitudes(report: Report, quick: bool) -> None:
    phi = jnp.linspace(random_designs.FIRST, 0.9999, DESIGNS)
    best, first = timed(lambda: optimise.optimal_exponent(phi, BOUNDS))
    calls = {"": lambda: optimise.optimal_exponent(phi, BOUNDS)}
    seconds = float(np.median(harness.interleave(calls, 2 if quick else 11, compiled=True)[""]))
    volume = jax.jit(fretting.wear_volume)
    k = jnp.linspace(*BOUNDS, 501 if quick else 2001)
    scan = jax.jit(jax.vmap(lambda phi: jnp.min(fretting.wear_volume(k, phi))))
    lowest = np.concatenate([np.asarray(scan(some)) for some in jnp.split(phi, 10)])
    found = {"plgwear, 10,000 at once, certified": (seconds / DESIGNS, np.asarray(best.wear_volume) / lowest - 1)}
    for name, (points, count) in LOOPS.items():
        some = harness.generator().choice(DESIGNS, count // 40 if quick else count, replace=False)
        given = np.asarray(phi[some])
        (exponent, _), taken = timed(lambda g=given, n=points: scipy_designs.brent_by_amplitude(g, BOUNDS, n))
        found[name] = taken / some.size, np.asarray(volume(exponent, given)) / lowest[some] - 1
    rows = []
    for name, (each, excess) in found.items():
        wrong = str(np.count_nonzero(excess > ANOTHER))
        worst = f"{excess.max():.1e}"
        rows.append((name, f"{excess.size:,}", short(each * 1e6), worst, wrong, short(each * DESIGNS / seconds)))
    columns = ("the best exponent", "designs", "us a design", "worst excess", "wrong optimum", "x plgwear")
    report.table(f"k from {BOUNDS[0]} to {BOUNDS[1]}, {DESIGNS:,} amplitudes from 0.001 to 0.9999", columns, rows)
    told = [
        f"{int(np.sum(getattr(best, name))):,} {name}"
        for name in ("converged", "certified", "scan_found_nothing_better")
    ]
    report.print(
        f"plgwear: first call {first:.2f} s, later ones {seconds * 1e3:.0f} ms; {', '.join(told)}.\n"
        "excess: of the volume over the lowest of a dense scan, relative; SciPy's exponents are valued by plgwear.\n"
        f"wrong optimum: worse by more than {ANOTHER:.0e}."
    )


def against_scipy(report: Report, quick: bool) -> None:
    amplitudes(report, quick)
    problems(report, quick)


# --- designs for a life ---------------------------------------------------------------------------------------------

COEFFICIENT = 1e-14
DIGITS = 1e-4  # of wear over cycles of numerical contacts; by as much may a design lie above the grid


class Question(NamedTuple):
    """A contact under an amplitude for a life, and what may vary."""

    contact: Any
    force: float
    cycles: float
    vary: dict[str, tuple[float, float]]

    @property
    def held(self) -> bool:
        """The contact radius is held, by E0."""
        return [*self.vary] == ["k"]

    @property
    def life(self) -> dict[str, Any]:
        return {"cycles": self.cycles, "law": COEFFICIENT}

    def worn(self, contact: Any) -> np.ndarray:
        return np.asarray(contact.over_cycles(self.force, COEFFICIENT).volume(self.cycles))


def _between(rng: np.random.Generator, lower: float, upper: float) -> float:
    return float(lower * (upper / lower) ** rng.uniform())


def _loaded(rng: np.random.Generator, material: Any, vary: dict[str, tuple[float, float]]) -> Question:
    """A random contact with this half-space, amplitude and life: from the first cycles to nearly the steady state."""
    friction, normal_force = rng.uniform(0.2, 0.8), _between(rng, 2.0, 50.0)
    contact = FrettingContact(material, _between(rng, 1e-3, 2e-2), normal_force, friction)
    force = rng.uniform(0.1, 0.9) * friction * normal_force
    slip = float(contact.steady(force).displacement_amplitude)
    # reduced cycles, of the order of 1 where half of all is worn
    cycles = _between(rng, 0.03, 30.0) * np.pi * radius(contact) ** 2 / (4.0 * COEFFICIENT * slip * normal_force)
    return Question(contact, force, float(cycles), vary)


def radius(contact: Any) -> Any:
    return np.asarray(contact.steady(0.0).contact_radius)


def _power_law(rng: np.random.Generator, *names: str) -> Question:
    material = PowerLawGraded(_between(rng, 20e9, 300e9), _between(rng, 3e-5, 3e-4), rng.uniform(-0.4, 0.4), 0.3)
    bounds = {"k": (-0.7, 0.7), "E0": (material.E0 / 3.0, 3.0 * material.E0)}
    return _loaded(rng, material, {name: bounds[name] for name in names})


def _graded(rng: np.random.Generator, name: str) -> Question:
    """A layer whose modulus changes from the surface down to a substrate; its modulus or its thickness varies."""
    modulus = [_between(rng, 60e9, 250e9) for _ in range(2)]
    material = DepthGraded([0.0, _between(rng, 1e-5, 2e-4)], modulus, 0.3)
    question = _loaded(rng, material, {})
    value = float(np.asarray(leaf_of(question.contact, name)))
    return question._replace(vary={name: (value / 2.5, 2.5 * value)})


KINDS: dict[str, tuple[int, Callable[[np.random.Generator], Question]]] = {  # with points of the grid a variable
    "closed forms, k": (41, lambda rng: _power_law(rng, "k")),
    "closed forms, k and E0": (15, lambda rng: _power_law(rng, "k", "E0")),
    "graded layer, its modulus": (11, lambda rng: _graded(rng, "material.modulus[0]")),
    "graded layer, its thickness": (11, lambda rng: _graded(rng, "material.depth[1]")),
}


def _with(question: Question, values: dict[str, Any]) -> Any:
    """The contact with these values of what varies, each of them an array."""
    contact = question.contact
    for name, value in values.items():
        contact = with_leaf(contact, name if "." in name else f"material.{name}", value)
    if question.held:
        law = contact.material
        contact = with_leaf(
            contact, "material.E0", law.E0 * (radius(contact) / radius(question.contact)) ** (3.0 + law.k)
        )
    return contact


Tried = tuple[Any, str, float, float, float, float]  # the design, what it is, its wear, the best other, both times


def against_grid(question: Question, points: int) -> Tried:
    """A design beside the best of three grids, each inside the one before."""
    contact, force, _, vary = question
    least, most = radius(contact) / 1.25, 1.25 * radius(contact)
    limits = {"limits": {"contact_radius": {"between": (float(least), float(most))}}}
    asked: dict[str, Any] = {"hold": "contact_radius"} if question.held else limits
    found, seconds = timed(lambda: optimise.design(contact, force, vary, **asked, **question.life))

    def lowest() -> float:
        best, ends = np.inf, vary
        for _ in range(3):
            along = {name: (np.linspace if is_linear(name) else np.geomspace)(*ends[name], points) for name in vary}
            grid = dict(zip(vary, map(np.ravel, np.meshgrid(*along.values(), indexing="ij")), strict=True))
            on_grid = _with(question, grid)
            inside = question.held | ((radius(on_grid) >= least) & (radius(on_grid) <= most))
            worn = np.nan_to_num(np.where(inside, question.worn(on_grid), np.inf), nan=np.inf)
            best = min(best, float(worn.min()))
            at = np.unravel_index(np.argmin(worn), [points] * len(vary))
            near = zip(along.items(), at, strict=True)
            ends = {name: (values[max(i - 1, 0)], values[min(i + 1, points - 1)]) for (name, values), i in near}
        return best

    best, others = timed(lowest)
    told = ", ".join(f"{name} = {short(value)}" for name, value in found.variables.items())
    mine = question.worn(_with(question, {name: np.array([x]) for name, x in found.variables.items()}))
    return found, told, float(mine[0]), best, seconds, others


def for_lives(report: Report, quick: bool) -> None:
    """Designs for a life against grids: what they wear, and how long both take."""
    highest = -np.inf
    for kind, (points, draw) in KINDS.items():
        rng, rows = np.random.default_rng(20), []  # fixed: these questions stay the same
        for _ in range(1 if quick else 10):
            found, told, *numbers = against_grid(draw(rng), 9 if quick else points)
            mine, best, *seconds = numbers
            highest = max(highest, mine / best - 1.0)
            volumes = f"{mine:.5e}", f"{best:.5e}", f"{mine / best - 1.0:+.1e}"
            rows.append((told, *volumes, *map(short, seconds), "yes" if found.certified else "no"))
        columns = "design", "m^3 by design", "best of grid", "excess", "s", "s of grid", "certified"
        report.table(kind, columns, rows)
    report.print(
        "The first design of a kind waits for the compiler. Excess: of the design over the best of others, relative."
    )
    report.print(f"Worst excess {highest:.1e}; {DIGITS:.0e} is allowed, by which lives of numerical contacts are off.")


PARTS = {
    "designs": Part("Designs against SciPy, one core, float64", against_scipy),
    "life_designs": Part("Designs for a life against brute force, one core, float64", for_lives),
}

if __name__ == "__main__":
    harness.run(PARTS)
