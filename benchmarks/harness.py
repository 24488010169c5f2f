"""What the benchmarks share: where they run, how they take times, how they measure errors, how they print and draw.

A time is the median over rounds in which all programs of a table run in turn, so that whatever slows the machine down
meets them alike; a ratio is taken within each round before its median is. A time stands next to the worst error against
the 50-digit oracle of the tests, measured on what the timed call itself returned: the points of that call begin with a
fresh random sample. Points are uniform in the bulk of the domain, abs(k) <= 0.97 and 0.005 <= phi <= 0.995; the sample
crowds at both ends of phi, as the sample of the accuracy tests does.
"""

from __future__ import annotations

import dataclasses
import datetime
import importlib
import json
import os
import platform
import re
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeAlias

import cores  # before jax: pins the process
import jax
import numpy as np
import typer
from rich.console import Console, RenderableType
from rich.measure import Measurement
from rich.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "reference"))

oracle: Any = importlib.import_module("oracle")
OUT = ROOT / "docs" / "benchmarks"

Points: TypeAlias = tuple[np.ndarray, ...]

SEED = int(os.environ.get("PLGWEAR_SEED", time.time()))  # fresh random points on every run

jax.config.update("jax_enable_x64", True)


# --- the machine ----------------------------------------------------------------------------------------------------


def machine() -> str:
    """What the times were taken on, in three lines."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("jax", "jaxlib", "numpy", "scipy"))
    return "\n".join(
        (
            f"{_processor()}, {', '.join(accelerators()) or 'no GPU'}",
            f"{platform.system()} {platform.machine()}, Python {platform.python_version()}, {packages}",
            f"{datetime.date.today():%Y-%m-%d}, seed of the random points {SEED}",
        )
    )


def accelerators() -> list[str]:
    """The kinds of devices beside the processor."""
    return sorted({device.device_kind for device in jax.devices() if device.platform != "cpu"})


def _processor() -> str:
    """Its name and what it can, as far as the system tells."""
    told = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    found = dict(re.findall(r"^([\w ]+?)\s*: (.*)$", told, re.MULTILINE))
    flags = found.get("flags", found.get("Features", "")).split()
    family = f" (family {found['cpu family']}, model {found['model']})" if "cpu family" in found else ""
    vectors = " ".join(flag for flag in ("avx2", "fma", "avx512f", "asimd", "sve") if flag in flags)
    name = found.get("model name") or platform.machine()
    return f"{name}{family}, {cores.USED}{', ' + vectors if vectors else ''}"


# --- points ---------------------------------------------------------------------------------------------------------


def generator() -> np.random.Generator:
    """A generator of random points, fresh on every run."""
    return np.random.default_rng(SEED)


def bulk(count: int, sample: int) -> Points:
    """(k, phi), uniform in the bulk; the first `sample` of them as the accuracy tests draw them."""
    accuracy = importlib.import_module("accuracy")  # imports all that tests need
    rng = generator()
    k, phi = rng.uniform(-0.97, 0.97, count), rng.uniform(0.005, 0.995, count)
    k[:sample], phi[:sample] = accuracy.k_phi(rng, min(sample, count), "bulk")
    return k, phi


def head(points: Points, count: int, dtype: Any = float) -> Points:
    """The first `count` points, in a dtype."""
    return tuple(x[:count].astype(dtype) for x in points)


# --- errors ---------------------------------------------------------------------------------------------------------

Exact: TypeAlias = list[np.ndarray]  # value, gradient, Hessian: arrays (points, entries, 2) of doubles hi + lo


def exact_wear_volume(points: Points, order: int) -> Exact:
    """The oracle's wear volume and its derivatives up to `order` at these very points."""
    found = oracle.map_points("wear_volume", np.stack(points, 1).astype(float).tolist(), processes=1, order=order)
    names = ("value", "gradient", "hessian")[: order + 1]
    return [np.array([getattr(point, name) for point in found]).reshape(len(found), -1, 2) for name in names]


def errors(result: Any, exact: Exact, orders: Sequence[int]) -> list[np.ndarray]:
    """Error at each point of the sample: of a value to itself, of derivatives to the larger of itself and the value.

    `result` holds arrays over the points: the value, or what `orders` says of value, gradient and Hessian.
    """
    leaves = iter(jax.tree.leaves(result))
    size = np.abs(exact[0][..., 0])
    found = []
    for order in orders:
        theirs = exact[order]
        mine = np.stack([np.asarray(next(leaves))[: len(theirs)] for _ in range(theirs.shape[1])], 1).astype(float)
        error = np.abs((mine - theirs[..., 0]) - theirs[..., 1]) / np.maximum(np.abs(theirs[..., 0]), size)
        found.append(np.where(np.isfinite(mine), error, np.inf).max(axis=1))
    return found


def worst(found: Any, exact: Any) -> str:
    """The largest relative error of each of several arrays."""
    return ", ".join(f"{np.max(np.abs(x / y - 1.0)):.0e}" for x, y in zip(found, exact, strict=True))


# --- times ----------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Timing:
    """Nanoseconds a point, one for each round."""

    ns: np.ndarray

    @property
    def median(self) -> float:
        return float(np.median(self.ns))

    @property
    def quartiles(self) -> str:
        low, high = np.quantile(self.ns, (0.25, 0.75))
        return f"{short(low)}-{short(high)}"


def interleave(calls: Mapping[Any, Callable[[], Any]], rounds: int) -> dict[Any, np.ndarray]:
    """Seconds a call in each round, by name; each is repeated within its turn until it lasts 2 ms."""
    repeats = {}
    for name, call in calls.items():
        jax.block_until_ready(call())  # compiled
        repeats[name] = max(1, round(2e-3 / max(_seconds(call, 1), 1e-7)))
    names, clocks = list(calls), (time.perf_counter(), time.process_time())
    taken = {name: np.empty(rounds) for name in names}
    for n in range(rounds):
        for name in names[n % len(names) :] + names[: n % len(names)]:
            taken[name][n] = _seconds(calls[name], repeats[name])
    _clocks.append((time.perf_counter() - clocks[0], time.process_time() - clocks[1]))
    return taken


_clocks: list[tuple[float, float]] = []  # of each table: seconds on the wall, seconds of the process


def taken_by_others() -> float:
    """The share of its core that this process did not get while it took times, as far as that can be known."""
    wall, own = np.sum([*_clocks, (1e-9, 1e-9)], axis=0)
    return max(0.0, 1.0 - own / wall) if cores.PINNED and not accelerators() else 0.0


def _seconds(call: Callable[[], Any], repeats: int) -> float:
    start = time.perf_counter()
    for _ in range(repeats):
        jax.block_until_ready(call())
    return (time.perf_counter() - start) / repeats


def seconds(call: Callable[[], Any], rounds: int) -> tuple[float, float]:
    """(The processor's time of the first call, the least of several more)."""
    found = []
    for _ in range(rounds + 1):
        begin = time.process_time()
        jax.block_until_ready(call())
        found.append(time.process_time() - begin)
    return found[0], min(found[1:])


@dataclasses.dataclass(frozen=True)
class Program:
    """Something to be timed: a function, its points, what it should give for the first of them, and which of that."""

    function: Callable[..., Any]
    points: Sequence[Any]
    exact: Exact
    orders: tuple[int, ...] = (0,)  # of derivatives that it returns

    def __call__(self) -> Any:
        return self.function(*self.points)

    @property
    def count(self) -> int:
        return len(self.points[0])


@dataclasses.dataclass(frozen=True)
class Compared:
    """The time that one program takes, and its worst errors."""

    timing: Timing
    errors: dict[int, float]  # the worst, by order of derivative


def compared(programs: Mapping[Any, Program], rounds: int) -> dict[Any, Compared]:
    """Time all programs and measure their errors."""
    found = {name: errors(program(), program.exact, program.orders) for name, program in programs.items()}
    seconds = interleave(programs, rounds)
    return {
        name: Compared(
            Timing(seconds[name] / program.count * 1e9),
            {order: float(error.max()) for order, error in zip(program.orders, found[name], strict=True)},
        )
        for name, program in programs.items()
    }


# --- tables and pictures --------------------------------------------------------------------------------------------


def short(x: float) -> str:
    """Three significant digits, without an exponent where that is readable."""
    size = abs(x) or 100.0
    return f"{x:,.{max(0, 2 - int(np.floor(np.log10(size))))}f}" if 1e-3 <= size < 1e6 else f"{x:.2e}"


class Report:
    """A program's table and picture, NAME.txt and NAME.png."""

    def __init__(self, name: str, out: Path, title: str, quick: bool) -> None:
        self.path, self.others, self.failed = out / name, 0.0, False
        out.mkdir(parents=True, exist_ok=True)
        _clocks.clear()
        self.console = Console(record=True, width=120, highlight=False, markup=False, emoji=False)
        self.print(title)
        self.print(machine())
        if quick:
            self.print("Quick: fewer points, rounds and rows than in the numbers that are quoted.")

    def print(self, what: RenderableType = "") -> None:
        self.console.print(what)

    def table(self, title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
        """A table whose first column is text and whose others are numbers."""
        table = Table(title=title, title_justify="left", title_style="bold")
        rows = [tuple(row) for row in rows]
        for n, column in enumerate(columns):
            widest = max((len(row[n]) for row in rows if n < len(row)), default=0)  # headings may wrap, numbers not
            room = max([widest, *map(len, column.split())])
            heading = "\n".join(textwrap.wrap(column, room, break_on_hyphens=False)) if column else ""
            table.add_column(heading, justify="right" if n else "left", min_width=widest)
        for row in rows:
            table.add_row(*row) if row else table.add_section()
        # wider than the text rather than cut off
        least = Measurement.get(self.console, self.console.options.update(width=1000), table).minimum
        self.console.print(table, width=max(self.console.width, least), crop=False)

    def markdown(self, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
        """A table for a page: "table of" this file in docs/generated.py takes it."""
        for row in (columns, ["---", *["---:"] * (len(columns) - 1)], *rows):
            self.console.print(f"| {' | '.join(row)} |", soft_wrap=True)

    def close(self, figure: Figure | None = None) -> None:
        share = max(self.others, taken_by_others())
        if share > 0.05:  # the short ones among the timed calls may escape that, so not even ratios hold
            self.print(f"Do not quote these times: other processes took {share:.0%} of the core meanwhile.")
        if figure is not None:
            figure.savefig(self.path.with_suffix(".png"))
        lines = map(str.rstrip, self.console.export_text().splitlines())
        self.path.with_suffix(".txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


def figure(width: float = 6.4, height: float = 4.0) -> Figure:
    """An empty picture in inches, for print."""
    import matplotlib  # a process that only measures does without
    from cycler import cycler

    from plgwear_jax.plots import COLOURS, use_style
    from plgwear_jax.plots.style import page

    use_style()
    matplotlib.rcParams.update(
        {
            "axes.prop_cycle": cycler(color=[*COLOURS, "0.3", "#E69F00", "#56B4E9"]),
            "legend.fontsize": 8,
            "axes.grid": True,
            "axes.axisbelow": True,
            "grid.alpha": 0.3,
            "grid.linewidth": 0.5,
        }
    )
    return page(2.54 * width, 2.54 * height, "constrained", dpi=200)


# --- programs -------------------------------------------------------------------------------------------------------


class Part(NamedTuple):
    """What a program measures for one table."""

    title: str
    measures: Sequence[
        Callable[[Report, bool], Figure | None]
    ]  # with whether they have to be quick; the last one draws


def run(parts: Mapping[str, Part], workers: Iterable[Callable[..., Any]] = ()) -> None:
    """Run a program from the command line: its parts, or one of its workers in a process of its own."""

    def main(
        names: Annotated[
            list[str] | None, typer.Argument(help="Parts, by the names of tables; all by default.")
        ] = None,
        quick: Annotated[bool, typer.Option("--quick", help="Fewer points, rounds and rows: noisier.")] = False,
        out: Annotated[Path, typer.Option(help="Where tables and pictures go.", show_default="docs/benchmarks")] = OUT,
        worker: Annotated[str, typer.Option(hidden=True)] = "",
    ) -> None:
        if worker:
            what, *arguments = json.loads(worker)
            print(json.dumps({one.__name__: one for one in workers}[what](*arguments)))
            return
        failed = False
        for name in names or parts:
            report = Report(name, out, parts[name].title, quick)
            report.close([measure(report, quick) for measure in parts[name].measures][-1])
            failed |= report.failed
        raise typer.Exit(failed)

    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    app.command()(main)
    app()


def in_new_process(worker: Callable[..., Any], *arguments: Any, on: str = "all", **variables: str) -> Any:
    """What a worker of a program finds in a process of its own, on all cores or on one."""
    command = [sys.executable, sys.argv[0], "--worker", json.dumps([worker.__name__, *arguments])]
    with cores.released():
        environment = os.environ | {"PLGWEAR_CORES": on} | variables
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout.splitlines()[-1])
