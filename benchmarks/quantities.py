"""What each fretting quantity costs, alone and all in one program, without units and in SI units; one core.

    python benchmarks/quantities.py
    python benchmarks/quantities.py --quick
    python benchmarks/quantities.py --redraw

Points are uniform in the bulk of the domain, and radii from 0 to 1.25 times the worn radius of each. "Together" is one
compiled program that returns every quantity of its column, in which what they share is computed once as far as the
compiler sees it; against it stands the sum of the programs that return one. Operations are those of the optimised
program, a point, with loops as often as they run; "exp, log" are the compiler's own transcendental functions among
them.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import harness  # before jax: pins the process
import jax
import jax.numpy as jnp
import numpy as np
from harness import Timing, interleave, short
from jax import Array
from matplotlib.figure import Figure
from size import operations

from plgwear_jax import FrettingContact, PowerLawGraded, fretting
from plgwear_jax.plots import COLOURS

QUANTITIES = {
    "wear_volume": ("phi",),
    "worn_radius": ("phi",),
    "stick_radius": ("phi",),
    "penetration": ("phi",),
    "profile": ("r", "phi"),
    "wear_depth": ("r", "phi"),
    "initial_displacement": ("r",),
    "steady_displacement": ("r", "phi"),
    "initial_pressure": ("r",),
    "steady_pressure": ("r", "phi"),
    "steady_traction": ("r", "phi"),
    "edge_intensity": ("phi",),
}  # with their arguments besides k
QUICK = ("wear_volume", "worn_radius", "wear_depth", "steady_pressure")  # and no operations, which compile longest
TOGETHER = "all together"
WITHOUT_UNITS, SI = "without units", "in SI units"
TRANSCENDENTAL = ("exponential", "exponential-minus-one", "log", "log-plus-one", "power", "sine", "cosine", "tanh")

NORMAL_FORCE, FRICTION = 10.0, 0.4


class Point(NamedTuple):
    """Arguments of every quantity, as arrays."""

    r: Any
    k: Any
    phi: Any


def without_units(names: Sequence[str], at: Point) -> dict[str, Array]:
    """The quantities named, radii in a_0."""
    found = {}
    for name in names:
        given = {key: getattr(at, key) for key in QUANTITIES[name]}
        found[name] = getattr(fretting, name)(k=at.k, **given)
    return found


def contact(k: Any) -> FrettingContact:
    """A dome on a coating of these exponents."""
    return FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), 5e-3, NORMAL_FORCE, FRICTION)


def in_si(names: Sequence[str], dome: FrettingContact, r: Any, tangential_force: Any) -> dict[str, Array]:
    """The same of a contact, radii in m."""
    given = {"r": ("r", r), "phi": ("tangential_force", tangential_force)}
    return {name: getattr(dome, name)(**dict(given[key] for key in QUANTITIES[name])) for name in names}


# --- measuring ------------------------------------------------------------------------------------------------------


class Cost(NamedTuple):
    """What a program costs a point."""

    timing: Timing
    needs: Counter[str]

    @property
    def operations(self) -> int:
        return sum(self.needs.values())

    @property
    def transcendental(self) -> int:
        return sum(self.needs[kind] for kind in TRANSCENDENTAL)


def points(count: int) -> Point:
    k, phi = harness.bulk(count, 0)
    r = harness.generator().uniform(0.0, 1.25, count) * np.asarray(jax.jit(fretting.worn_radius)(k, phi))
    return Point(*(jnp.asarray(x) for x in (r, k, phi)))


def measured(at: Point, names: Sequence[str], columns: Sequence[str], quick: bool) -> dict[tuple[str, str], Cost]:
    """The cost of every program, by column and quantity."""
    dome = contact(at.k)
    force, radii = FRICTION * NORMAL_FORCE * at.phi, at.r * dome.steady(0.0).contact_radius
    programs = {name: (name,) for name in names} | {TOGETHER: tuple(names)}
    calls, needs = {}, {}
    for name, returned in programs.items():
        if WITHOUT_UNITS in columns:
            calls[WITHOUT_UNITS, name] = partial(jax.jit(partial(without_units, returned)), at)
            needs[WITHOUT_UNITS, name] = partial(without_units, returned)
        if SI in columns:
            calls[SI, name] = partial(jax.jit(partial(in_si, returned)), dome, radii, force)
            needs[SI, name] = partial(_in_si_of, returned)
    seconds = interleave(calls, 3 if quick else 9)
    return {
        key: Cost(
            Timing(seconds[key] / at.k.size * 1e9),
            Counter() if quick else operations(_of_two(needs[key]), "float64"),
        )
        for key in calls
    }


def _of_two(program: Callable[[Point], Any]) -> Callable[[Array, Array], Any]:
    # Operations do not depend on the numbers: the amplitude serves as a radius as well.
    return lambda k, phi: program(Point(phi, k, phi))


def _in_si_of(names: Sequence[str], at: Point) -> dict[str, Array]:
    return in_si(names, contact(at.k), at.r, at.phi)


# --- the report -----------------------------------------------------------------------------------------------------


def main(quick: harness.Quick = False, redraw: harness.Redraw = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Cost of each fretting quantity, alone and together."""
    if redraw:
        _picture(_of_the_table()).savefig(out / "quantities.png")
        return
    report = harness.Report("quantities", out, "The fretting quantities, one core, float64", quick)
    at = points(100_000 if quick else 500_000)
    names, asked = (QUICK, (SI,)) if quick else (tuple(QUANTITIES), (WITHOUT_UNITS, SI))
    found = measured(at, names, asked, quick)
    for column in asked:
        rows = [_row(name, found[column, name]) for name in names]
        rows += [(), *_sums(found, names, column)]
        columns = ("", "ns a point", "quartiles", "operations a point", "of these exp, log")
        report.table(f"{at.k.size:,} points, {column}", columns, rows)
    report.close(_picture(_bars(found, names)))


def _row(name: str, cost: Cost) -> tuple[str, ...]:
    counted = (f"{cost.operations:,}", str(cost.transcendental)) if cost.needs else ("-", "-")
    return name, short(cost.timing.median), cost.timing.quartiles, *counted


def _parts(found: dict[tuple[str, str], Cost], names: Sequence[str], column: str) -> Cost:
    """The sum of the programs that return one quantity."""
    parts = [found[column, name] for name in names]
    return Cost(Timing(sum((part.timing.ns for part in parts), np.zeros(1))), sum((p.needs for p in parts), Counter()))


def _sums(found: dict[tuple[str, str], Cost], names: Sequence[str], column: str) -> list[tuple[str, ...]]:
    parts, together = _parts(found, names, column), found[column, TOGETHER]
    counted = ((parts.operations, together.operations), (parts.transcendental, together.transcendental))
    ratios = (short(one / other) if other else "-" for one, other in counted)
    return [
        _row("sum of the above", parts),
        _row(TOGETHER, together),
        ("sum over together", short(harness.median_ratio(parts.timing, together.timing)), "", *ratios),
    ]


def _bars(found: dict[tuple[str, str], Cost], names: Sequence[str]) -> dict[str, dict[str, tuple[float, int]]]:
    """(ns a point, operations a point) of each quantity, without units and in SI units."""
    bars: dict[str, dict[str, tuple[float, int]]] = {}
    for column in (WITHOUT_UNITS, SI):
        if (column, TOGETHER) in found:
            costs = {name: found[column, name] for name in names}
            costs |= {"sum of the above": _parts(found, names, column), TOGETHER: found[column, TOGETHER]}
            bars[column] = {name: (cost.timing.median, cost.operations) for name, cost in costs.items()}
    return bars


def _of_the_table() -> dict[str, dict[str, tuple[float, int]]]:
    """The same from the committed table."""
    bars: dict[str, dict[str, tuple[float, int]]] = {}
    for column, (_, rows) in zip((WITHOUT_UNITS, SI), harness.committed("quantities"), strict=True):
        bars[column] = {row[0]: (harness.number(row[1]), int(harness.number(row[3]))) for row in rows if row[2]}
    return bars


def _picture(bars: dict[str, dict[str, tuple[float, int]]]) -> Figure:
    figure = harness.figure(6.4, 4.4)
    axes: Any = figure.subplots()
    looks = (-0.2, WITHOUT_UNITS, COLOURS[0], ""), (0.2, SI, COLOURS[1], "////")
    rows: list[str] = []
    for shift, column, colour, hatch in looks:
        if column not in bars:
            continue
        rows = list(bars[column])
        at, times = np.arange(len(rows)) + shift, [time for time, _ in bars[column].values()]
        axes.barh(at, times, 0.38, color=colour, hatch=hatch, edgecolor="w", linewidth=0.0, label=column)
        for y, time in zip(at, times, strict=True):
            axes.text(time * 1.06, y, f"{time:.0f}" if time >= 10.0 else f"{time:.1f}", va="center", fontsize=6.5)
    axes.set(xscale="log", yticks=range(len(rows)), yticklabels=rows, xlabel="time per point (ns), one core")
    axes.set_xlim(right=2.5 * axes.get_xlim()[1])
    axes.axhline(len(rows) - 2.5, color="0.5", linewidth=0.6)
    found = bars.get(SI) or bars[WITHOUT_UNITS]
    saved = found["sum of the above"][0] / found[TOGETHER][0]
    units = SI if SI in bars else WITHOUT_UNITS
    axes.set_title(f"{units}, all quantities together take {short(saved)} times less than one by one")
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.legend(loc="upper right")
    return figure


if __name__ == "__main__":
    harness.run(main)
