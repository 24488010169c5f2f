"""The wear volume and its gradient: the library against what SciPy's users have today, on one core.

All programs get the same random points of the bulk of the domain, a million for the library; the slower ones get the
first of them. The SciPy programs are described in `scipy_programs.py`.
"""

from functools import partial
from typing import NamedTuple

import harness
import jax
import jax.numpy as jnp
import scipy_programs
from harness import Compared, Exact, Points, Program, median_ratio
from scipy_programs import EXPERT, PAPER, TUNED_EXPERT, TUNED_PAPER

from plgwear_jax import fretting


class Setting(NamedTuple):
    """How the library is called."""

    dtype: str
    digits: int | None

    def __str__(self) -> str:
        return f"plgwear {self.dtype}, {'all digits' if self.digits is None else f'digits={self.digits}'}"


SETTINGS = (
    Setting("float64", None),
    Setting("float64", 4),
    Setting("float32", None),
    Setting("float32", 6),
    Setting("float32", 4),
)
DOUBLE, FOUR_DIGITS, _, SINGLE_SIX, _ = map(str, SETTINGS)
QUICK = (DOUBLE, FOUR_DIGITS, SINGLE_SIX)  # with the gradient of the first alone


def programs(points: Points, exact: dict[str, Exact], quick: bool) -> dict[tuple[str, str], Program]:
    found = {}
    for setting in SETTINGS:
        if quick and str(setting) not in QUICK:
            continue
        volume = partial(fretting.wear_volume, digits=setting.digits)
        given = [jnp.asarray(x, setting.dtype) for x in points]
        found[str(setting), "value"] = Program(jax.jit(volume), given, exact[setting.dtype])
        if quick and str(setting) != DOUBLE:
            continue
        gradient = jax.jit(jax.vmap(jax.value_and_grad(volume, (0, 1))))
        found[str(setting), "with gradient"] = Program(gradient, given, exact[setting.dtype], (0, 1))
    return found | scipy_programs.programs(points, exact["float64"], quick)


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Time and error of the wear volume and its gradient, against SciPy."""
    sample = 64 if quick else 1000
    report = harness.Report("wear_volume", out, "The wear volume, one core", quick)
    points = harness.bulk(200_000 if quick else 1_000_000, sample)
    exact = {
        dtype: harness.exact_wear_volume(harness.head(points, sample, dtype), 1) for dtype in ("float64", "float32")
    }
    found = harness.compared(programs(points, exact, quick), 3 if quick else 11)
    for what in ("value", "with gradient"):
        report.table(f"{len(points[0]):,} points, {what}", *_table(found, what))
    report.print("off by: the worst relative error; x: how many times faster than that SciPy program.")
    _goals(report, found)
    report.close()


def _table(found: dict[tuple[str, str], Compared], what: str) -> tuple[list[str], list[list[str]]]:
    """Columns and rows."""
    rows = []
    for (name, kind), program in found.items():
        if kind == what:
            others = scipy_programs.VALUES if name not in scipy_programs.VALUES else ()
            ratios = (median_ratio(found[other, what].timing, program.timing) for other in others)
            errors = (f"{error:.1e}" for error in program.errors.values())
            times = harness.short(program.timing.median), program.timing.quartiles
            rows.append([name, *times, *errors, *map(harness.short, ratios)])
    errors = ["value off by"] if what == "value" else ["value off by", "gradient off by"]
    ratios = [f"x {name}" for name in scipy_programs.VALUES]
    return ["program", "ns a point", "quartiles", *errors, *ratios], rows


def _goals(report: harness.Report, found: dict[tuple[str, str], Compared]) -> None:
    def ratio(slow: str, fast: str, what: str = "value", than: str = "value") -> float:
        return median_ratio(found[slow, what].timing, found[fast, than].timing)

    harness.goals(
        report,
        (
            ("times faster than the paper, as printed", 1200, ratio(PAPER, DOUBLE), True),
            ("times faster than the paper, tuned", 1200, ratio(TUNED_PAPER, DOUBLE), True),
            ("times faster than the expert", 35, ratio(EXPERT, DOUBLE), True),
            ("times faster than the expert, tuned", 35, ratio(TUNED_EXPERT, DOUBLE), True),
            ("value with gradient over value, at most", 2.0, ratio(DOUBLE, DOUBLE, "with gradient"), False),
            ("float32 digits=6, times faster than float64", 3.0, ratio(DOUBLE, SINGLE_SIX), True),
            ("float64 digits=4, times faster than all digits", 1.6, ratio(DOUBLE, FOUR_DIGITS), True),
        ),
    )


if __name__ == "__main__":
    harness.run(main)
