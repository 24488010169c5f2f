"""Designs against SciPy: the optimum of random problems, and the best exponent of 10,000 amplitudes, on one core.

    python benchmarks/designs.py
    python benchmarks/designs.py --quick

`random_designs` draws variables, loads, objectives and limits. What the library finds is valued by SciPy's formulas,
like everything else: its excess is over the best that SciPy finds from 20 starts with several methods, among what keeps
the limits. "SciPy alone" is each suitable method once, from the middle of the box. PLGWEAR_SEED repeats the problems.
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
from harness import short
from random_designs import Program, design, valued
from scipy_designs import Found, Problem

from plgwear_jax import fretting, optimise

WORSE = 1e-6  # by as much is a value not that of the optimum
BOUNDS = (-0.95, 0.95)
DESIGNS = 10_000

# --- problems -------------------------------------------------------------------------------------------------------


class Outcome(NamedTuple):
    """One problem and what came out."""

    number: int
    problem: Problem
    alone: dict[str, Found]
    best: Found
    best_seconds: float
    mine: Found
    design: Any
    first_seconds: float
    seconds: float

    @property
    def excess(self) -> float:
        """Of the library's value over SciPy's best, relative."""
        return self.mine.value / self.best.value - 1

    @property
    def differs(self) -> float:
        """The library's formulas from SciPy's, relative."""
        return abs(float(self.design.value) / self.mine.value - 1)

    def is_wrong(self, found: Found) -> bool:
        return found.violation > WORSE or not found.value <= self.lowest * (1 + WORSE)

    @property
    def lowest(self) -> float:
        kept = [found.value for found in (self.best, self.mine) if found.violation < 1e-9]
        return min(kept, default=math.inf)


def solved(program: Program, number: int, starts: int) -> Outcome:
    problem = random_designs.draw(program, harness.SEED, number)
    best, first = _timed(lambda: design(problem))
    best, again = _timed(lambda: design(problem))
    alone = scipy_designs.alone(problem)
    lowest, seconds = _timed(lambda: scipy_designs.best(problem, starts))
    return Outcome(number, problem, alone, lowest, seconds, valued(problem, best), best, first, again)


def _timed(call: Callable[[], Any]) -> tuple[Any, float]:
    begin = time.perf_counter()
    result = call()
    return result, time.perf_counter() - begin


# --- the tables of problems -----------------------------------------------------------------------------------------


def _worst(numbers: Iterable[float]) -> str:
    numbers = list(numbers)
    return f"{max(numbers):.1e}" if numbers else ""


def _median(numbers: Iterable[float]) -> str:
    numbers = list(numbers)
    return short(1e3 * float(np.median(numbers))) if numbers else ""


def _row(name: str, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    known = (sum(getattr(one.design, what) for one in outcomes) for what in ("converged", "certified", "proven"))
    return (
        name,
        str(len(outcomes)),
        _worst(one.excess for one in outcomes),
        str(sum(one.is_wrong(one.best) for one in outcomes)),
        _worst(one.mine.violation for one in outcomes if one.problem.limited),
        ", ".join(map(str, known)),
        _median(one.seconds for one in outcomes),
        _median(one.best_seconds for one in outcomes),
    )


def problem_tables(report: harness.Report, programs: Sequence[Program], outcomes: Sequence[Outcome]) -> None:
    def those(key: Callable[[Problem], Any], value: Any) -> list[Outcome]:
        return [one for one in outcomes if key(one.problem) == value]

    rows: list[tuple[str, ...]] = [
        _row(kind, those(lambda p: p.kind, kind)) for kind in dict.fromkeys(program.kind for program in programs)
    ]
    loads = dict.fromkeys(one.problem.load for one in outcomes)
    rows += [(), *(_row(load, those(lambda p: p.load, load)) for load in sorted(loads))]
    goals = dict.fromkeys(one.problem.objective for one in outcomes)
    rows += [(), *(_row(goal, those(lambda p: p.objective, goal)) for goal in sorted(goals))]
    rows += [(), _row("without limits", those(lambda p: p.limited, False))]
    rows += [_row("with limits", those(lambda p: p.limited, True)), (), _row("all", outcomes)]
    known = "converged, certified, proven"
    columns = (
        "",
        "problems",
        "worst excess",
        "SciPy's best worse",
        "limits missed by",
        known,
        "ms",
        "ms, SciPy's best",
    )
    report.table("What plgwear finds, against the best of SciPy from many starts", columns, rows)
    report.table(
        "What SciPy finds alone, from the middle of the box",
        ("method", "problems", "wrong optimum", "unnoticed", "worse by > 1 %", "limit missed", "gave up", "ms"),
        [_alone(method, outcomes) for method in scipy_designs.METHODS if any(method in one.alone for one in outcomes)],
    )
    first = np.median([one.first_seconds for one in outcomes[: len(programs)]])
    report.print(
        f"worst excess: of plgwear's value over SciPy's best, relative. SciPy's best worse: by more than {WORSE:.0e}.\n"
        "wrong optimum: worse than the best known, or a limit missed, by more than 1e-6; unnoticed: and said to have\n"
        f"converged. ms: median time a problem; plgwear compiled {len(programs)} programs, in {first:.0f} s each."
    )
    for one in outcomes:
        if one.excess > 1e-9 or one.mine.violation > 1e-9 or not (one.design.converged and one.design.certified):
            report.print(_told(one))


def _alone(method: str, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    met = [(one, one.alone[method]) for one in outcomes if method in one.alone]
    wrong = [(one, found) for one, found in met if one.is_wrong(found)]
    return (
        method,
        str(len(met)),
        str(len(wrong)),
        str(sum(found.success for _, found in wrong)),
        str(sum(found.value > one.lowest * 1.01 for one, found in met)),
        str(sum(found.violation > WORSE for _, found in met)),
        str(sum(not found.success for _, found in met)),
        _median(found.seconds for _, found in met),
    )


def _told(one: Outcome) -> str:
    said = ", ".join(name for name in ("converged", "certified") if not getattr(one.design, name))
    return (
        f"problem {one.number} ({one.problem.kind}; {one.problem.objective}; {one.problem.load}): excess "
        f"{one.excess:.1e}, limits missed by {one.mine.violation:.1e}{f', not {said}' if said else ''}"
    )


# --- 10,000 amplitudes ----------------------------------------------------------------------------------------------

LIBRARY = "plgwear, 10,000 at once, certified"
LOOPS: dict[str, tuple[Callable[[float, float], float], int, int]] = {
    # the volume, points of a scan before, amplitudes
    "SciPy, the paper as printed": (scipy_designs.printed_wear_volume, 0, 100),
    "SciPy, the reduced form": (scipy_designs.volume_by_root, 0, DESIGNS),
    "SciPy, the reduced form, after a scan of 65": (scipy_designs.volume_by_root, 65, 2000),
}
ANOTHER = 1e-4  # worse by as much, it is another optimum: Brent's method stops short of a bound by less


class Loop(NamedTuple):
    """A program that designs amplitudes."""

    seconds: float  # a design
    excess: np.ndarray  # of the volume over that of a dense scan, relative


def amplitude_table(report: harness.Report, quick: bool) -> dict[str, Loop]:
    phi = jnp.linspace(random_designs.FIRST, 0.9999, DESIGNS)
    best, first = _timed(lambda: jax.block_until_ready(optimise.optimal_exponent(phi, BOUNDS)))
    calls = {"": lambda: optimise.optimal_exponent(phi, BOUNDS)}
    seconds = float(np.median(harness.interleave(calls, 2 if quick else 11, compiled=True)[""]))
    lowest = _dense(phi, 501 if quick else 2001)
    found = {LIBRARY: Loop(seconds / DESIGNS, np.asarray(best.wear_volume) / lowest - 1)}
    found |= {name: _loop(name, phi, lowest, quick) for name in LOOPS}
    rows = [
        (
            name,
            f"{one.excess.size:,}",
            short(one.seconds * 1e6),
            f"{one.excess.max():.1e}",
            str(np.count_nonzero(one.excess > ANOTHER)),
            short(one.seconds / found[LIBRARY].seconds),
        )
        for name, one in found.items()
    ]
    columns = ("the best exponent", "designs", "us a design", "worst excess", "wrong optimum", "x plgwear")
    report.table(f"k from {BOUNDS[0]} to {BOUNDS[1]}, {DESIGNS:,} amplitudes from 0.001 to 0.9999", columns, rows)
    told = [f"{int(np.sum(getattr(best, name))):,} {name}" for name in ("converged", "certified", "proven")]
    report.print(
        f"plgwear: first call {first:.2f} s, later ones {seconds * 1e3:.0f} ms; {', '.join(told)}.\n"
        "excess: of the volume over the lowest of a dense scan, relative; SciPy's exponents are valued by plgwear.\n"
        f"wrong optimum: worse by more than {ANOTHER:.0e}."
    )
    harness.goals(
        report,
        (
            ("s for 10,000 certified designs, at most", 1.0, seconds, False),
            ("times faster than SciPy's loop, the paper as printed", 1000, _times(found, 0), True),
            ("times faster than SciPy's loop, the reduced form", 1000, _times(found, 1), True),
            ("certified", DESIGNS, float(np.sum(best.certified)), True),
            ("worst excess over a dense scan, at most", 1e-13, float(found[LIBRARY].excess.max()), False),
        ),
    )
    return found


def _loop(name: str, phi: jax.Array, lowest: np.ndarray, quick: bool) -> Loop:
    """One of SciPy's programs, on some of the amplitudes."""
    volume, scan, count = LOOPS[name]
    some = harness.generator().choice(DESIGNS, count // 40 if quick else count, replace=False)
    given = np.asarray(phi[some])
    (k, _), seconds = _timed(lambda: scipy_designs.brent_by_amplitude(volume, given, BOUNDS, scan))
    return Loop(seconds / some.size, np.asarray(jax.jit(fretting.wear_volume)(k, given)) / lowest[some] - 1)


def _times(found: dict[str, Loop], loop: int) -> float:
    return found[list(LOOPS)[loop]].seconds / found[LIBRARY].seconds


def _dense(phi: jax.Array, count: int) -> np.ndarray:
    """The lowest volume of a scan over k."""
    k = jnp.linspace(*BOUNDS, count)
    lowest = jax.jit(jax.vmap(lambda phi: jnp.min(fretting.wear_volume(k, phi))))
    return np.concatenate([np.asarray(lowest(some)) for some in jnp.split(phi, 10)])


# --- the report -----------------------------------------------------------------------------------------------------


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Designs against SciPy: values, certificates, times."""
    report = harness.Report("designs", out, "Designs against SciPy, one core, float64", quick)
    amplitude_table(report, quick)
    programs = random_designs.random_programs(harness.SEED, 1 if quick else 27)
    problems = zip(range(3 if quick else 200), itertools.cycle(programs))
    outcomes = [solved(program, number, 3 if quick else 20) for number, program in problems]
    problem_tables(report, programs, outcomes)
    harness.goals(
        report,
        (
            ("worst excess over SciPy's best, at most", 1e-9, max(one.excess for one in outcomes), False),
            ("limits missed by, at most", 1e-9, max(one.mine.violation for one in outcomes), False),
            ("formulas of both apart by, at most", 1e-11, max(one.differs for one in outcomes), False),
            ("certified", len(outcomes), float(sum(bool(one.design.certified) for one in outcomes)), True),
        ),
    )
    report.close()


LEAST, MOST = 1e-14, 1e2  # of the picture


if __name__ == "__main__":
    harness.run(main)
