"""Designs, on one core, against SciPy's searches.

    python benchmarks/designs.py
    python benchmarks/designs.py --quick

designs: the best exponent of 10,000 amplitudes, and the optimum of random problems. `random_designs` draws variables,
loads, objectives and limits. What the library finds is valued by SciPy's formulas, like everything else: its excess is
over the best that SciPy finds from 20 starts with several methods, among what keeps the limits. "SciPy alone" is each
suitable method once, from the middle of the box. PLGWEAR_SEED repeats the problems.
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

from plgwear_jax import fretting, optimise

WORSE = 1e-6  # relative; a design whose value exceeds the optimum by more is worse
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
    columns = "method", "problems", "wrong optimum", "unnoticed", "worse by > 1 %", "limit missed", "gave up", "ms"
    report.table("What SciPy finds alone, from the middle of the box", columns, rows)
    report.print(
        f"worst excess: of plgwear's value over SciPy's best, relative. SciPy's best worse: by more than {WORSE:.0e}.\n"
        "wrong optimum: worse than the best known, or a limit missed, by more than 1e-6; unnoticed: and said to have\n"
        "converged. ms: median time of a problem, asked once before. plgwear runs its programs by NumPy until it\n"
        "would have taken less time to compile them."
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
    seconds = float(np.median(harness.interleave(calls, 2 if quick else 11)[""]))
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
    columns = "the best exponent", "designs", "us a design", "worst excess", "wrong optimum", "x plgwear"
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


PARTS = {
    "designs": Part("Designs against SciPy, one core, float64", [amplitudes, problems]),
}

if __name__ == "__main__":
    harness.run(PARTS)
