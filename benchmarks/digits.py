"""Speed against accuracy: what fewer digits save, for the wear volume, its gradient and its Hessian, on one core.

Every `digits=` of both dtypes, its time a point and the worst error that it really has; SciPy's programs beside them.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import harness
import jax
import jax.numpy as jnp
import scipy_programs
from harness import Compared, Exact, Points, Program, median_ratio, short
from matplotlib.figure import Figure
from scipy_programs import EXPERT, PAPER

from plgwear_jax import fretting
from plgwear_jax.plots.style import COLOURS

VALUE, GRADIENT, HESSIAN = KINDS = ("value", "with gradient", "Hessian")
ORDERS = {VALUE: (0,), GRADIENT: (0, 1), HESSIAN: (2,)}
DTYPES = ("float64", "float32")
ASKED = {"float64": (*range(1, 16), None), "float32": (*range(1, 7), None)}
# A Hessian compiles for seconds, and what matters is seen from every other one.
FEWER = {"float64": (1, 2, 4, 6, 8, 10, 12, 14, None), "float32": (1, 2, 4, 6, None)}
QUICK = {
    VALUE: {"float64": (3, 8, None), "float32": (3, None)},
    GRADIENT: {"float64": (3, None), "float32": ()},
    HESSIAN: {"float64": (), "float32": ()},
}


class Case(NamedTuple):
    """A result asked of the library."""

    kind: str
    dtype: str
    digits: int | None


def function(case: Case) -> Callable[..., Any]:
    volume = partial(fretting.wear_volume, digits=case.digits)
    if case.kind == VALUE:
        return jax.jit(volume)
    derivative = jax.value_and_grad if case.kind == GRADIENT else jax.hessian
    return jax.jit(jax.vmap(derivative(volume, (0, 1))))


def programs(points: Points, exact: dict[str, Exact], quick: bool) -> dict[Any, Program]:
    """The library by `Case`, SciPy by name and kind."""
    found: dict[Any, Program] = {}
    for dtype in DTYPES:
        given = tuple(jnp.asarray(x, dtype) for x in points)
        fewer = tuple(x[: len(x) // 2] for x in given)
        for kind in KINDS:
            for digits in (QUICK[kind] if quick else FEWER if kind == HESSIAN else ASKED)[dtype]:
                case = Case(kind, dtype, digits)
                found[case] = Program(function(case), fewer if kind == HESSIAN else given, exact[dtype], ORDERS[kind])
    return found | scipy_programs.programs(points, exact["float64"], quick)


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Time over error for all digits."""
    count, sample, rounds = (100_000, 64, 3) if quick else (200_000, 1000, 5)
    report = harness.Report("digits", out, "Speed against accuracy, one core", quick)
    points = harness.bulk(count, sample)
    exact = {
        dtype: harness.exact_wear_volume(harness.head(points, sample, dtype), 1 if quick else 2) for dtype in DTYPES
    }
    found = harness.compared(programs(points, exact, quick), rounds)
    for kind in KINDS[: 2 if quick else None]:
        report.table(kind, *_table(found, kind))
    report.print("Worst relative errors: of a value, and of the derivatives themselves. x: times faster than SciPy's.")
    report.print("\nThe value, for a README:\n")
    report.markdown(*_summary(found))
    report.close(_picture(found))


def error(found: dict[Any, Compared], name: Any) -> float:
    """The worst error of what a program is about: of its highest derivative."""
    return found[name].errors[max(found[name].errors)]


def _table(found: dict[Any, Compared], kind: str) -> tuple[list[str], list[list[str]]]:
    """Columns and rows of one kind of result."""
    others = [(name, kind) for name in scipy_programs.VALUES if (name, kind) in found]
    columns = ["dtype, digits", "ns a point", "quartiles", "worst error", *(f"x {name}" for name, _ in others)]
    rows = []
    for name in [name for name in found if isinstance(name, Case) and name.kind == kind] + others:
        timing = found[name].timing
        what = f"{name.dtype}, {name.digits or 'all'}" if isinstance(name, Case) else f"SciPy: {name[0]}"
        ratios = (median_ratio(found[other].timing, timing) for other in others) if isinstance(name, Case) else ()
        rows.append([what, short(timing.median), timing.quartiles, f"{error(found, name):.1e}", *map(short, ratios)])
    return columns, rows


def _summary(found: dict[Any, Compared]) -> tuple[list[str], list[list[str]]]:
    """The value in few columns, for a README."""
    columns = ["digits", "float64: worst error", "ns a point", "x paper", "x expert"]
    columns += ["float32: worst error", "ns a point", "x paper", "x expert"]
    rows = []
    for digits in (case.digits for case in found if isinstance(case, Case) and case[:2] == (VALUE, "float64")):
        row = [f"{digits or 'all'}"]
        for case in (Case(VALUE, dtype, digits) for dtype in DTYPES):
            if case in found:
                timing = found[case].timing
                ratios = (median_ratio(found[other, VALUE].timing, timing) for other in (PAPER, EXPERT))
                row += [f"{error(found, case):.0e}", short(timing.median), *map(short, ratios)]
            else:
                row += [""] * 4
        rows.append(row)
    return columns, rows


def _picture(found: dict[Any, Compared]) -> Figure:
    """Time a point over worst error."""
    figure = harness.figure(6.4, 3.4)
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    for panel, kind in zip(axes, KINDS, strict=True):
        if Case(kind, "float64", None) not in found:
            continue
        for dtype, colour, line in zip(DTYPES, COLOURS, ("o-", "s--"), strict=False):
            cases = [name for name in found if isinstance(name, Case) and (name.kind, name.dtype) == (kind, dtype)]
            at = [(error(found, case), found[case].timing.median) for case in cases]
            panel.plot(
                *zip(*at, strict=True), line, color=colour, markersize=3, linewidth=0.8, label=f"plgwear {dtype}"
            )
            labelled, shift = ((2, 4, 8, None), 5) if dtype == "float64" else ((2, None), -11)
            for case, where in zip(cases, at, strict=True):
                if case.digits in labelled:
                    text = f"{case.digits or 'all'}"
                    panel.annotate(text, where, (0, shift), textcoords="offset points", ha="center", fontsize=7)
        for name, marker in zip(scipy_programs.VALUES, "sDv^", strict=True):
            if (name, kind) in found:
                where = error(found, (name, kind)), found[name, kind].timing.median
                panel.plot(*where, marker, color="0.4", markersize=4, label=f"SciPy: {name}")
        panel.set(xscale="log", yscale="log", title=kind, xlabel="worst relative error")
    axes[0].set_ylabel("time per point on one core (ns)")
    axes[0].set_xlim(1e-16, 1.0)
    axes[0].set_ylim(bottom=0.35 * axes[0].dataLim.y0)  # room for the numbers of digits below
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


if __name__ == "__main__":
    harness.run(main)
