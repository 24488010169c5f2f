"""Correct digits of every dimensionless quantity and its derivatives, all the way to the edges of the domain.

    python benchmarks/extremes.py                  the table of worst points in both dtypes: ten minutes
    python benchmarks/extremes.py --quick          some in float64, values and first derivatives, on a coarse grid
    python benchmarks/extremes.py --only wear_volume --processes 4

Points crowd at every edge, one a decade: k -> -1, 0, 1 to 1e-9 (float32: 1e-6 beside -1 and 1), phi -> 0, 1 to 1e-12
(1e-7 beside 1), nu -> 1/2 to 1e-12 (1e-6), r -> 0, c, a, a_inf to a relative 1e-12 (1e-6), and r -> infinity. Each is
compared with the 50-digit oracle of the tests. The error of a value is relative to the value, of a derivative to the
larger of itself and the value; what counts is the worst entry of the gradient or Hessian.

Radii near r = c and r = a_inf, which are roundings of real numbers, are forgiven what moving r by four units in its
last place makes of the exact result. Points within 32 units of them are left out. The wear depth, which is zero at
a_inf, still loses there what it takes to tell the two radii apart. Maps are drawn of second derivatives in float64, of
the quantities that lose digits there.

What is claimed: where the true result is a number of the dtype, ours is neither NaN nor infinite, and no wear is
negative. The exit code is 1 where that fails, and the points are listed.
"""

import dataclasses
import functools
import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal, NamedTuple

import cores
import harness  # before jax: pins the process
import jax
import numpy as np
import typer
from harness import DEFAULT_OUT, Out, Quick, Report, oracle
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray
from rich.table import Table

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax.plots.style import COLOURS, LABEL_SIZE, TICK_SIZE, page

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

ORDERS = ("value", "first derivatives", "second derivatives")
FINEST = {"float64": 12, "float32": 6}  # decades towards an edge that is not 0


# --- places ---------------------------------------------------------------------------------------------------------


class Place(NamedTuple):
    """One coordinate of the points, named by its distance to an edge."""

    name: str
    at: Callable[..., float]  # without arguments; a radius is a function of (c, a_inf)


@dataclasses.dataclass(frozen=True)
class Scale:
    """The places of an argument from end to end, with the symbols of the edges that stand between them."""

    label: str
    places: tuple[Place, ...]
    edges: tuple[tuple[int, str], ...]


def _scale(label: str, *parts: str | Place | list[Place]) -> Scale:
    """Symbols of edges, single places, and decades, as they follow each other."""
    places, edges = [], []
    for part in parts:
        if isinstance(part, str):
            edges.append((len(places), part))
        elif isinstance(part, Place):
            places.append(part)
        else:
            places += part
    return Scale(label, tuple(places), tuple(edges))


def _towards(name: str, at: Callable[..., float], decades: Iterable[int]) -> list[Place]:
    """Places at 10^-n from an edge for each n in turn."""
    return [Place(f"{name} = 1e-{n}", functools.partial(at, 10.0**-n)) for n in decades]


def _from(name: str, at: Callable[..., float], decades: Sequence[int]) -> list[Place]:
    return _towards(name, at, decades[::-1])


def _fixed(name: str, value: float) -> Place:
    return Place(f"{name} = {value:g}", lambda: value)


def _decades(finest: int, step: int) -> list[int]:
    return list(range(finest, 0, -step))


def k_scale(dtype: str, step: int) -> Scale:
    ends, middle = _decades(min(9, FINEST[dtype]), step), _decades(9, step)
    return _scale(
        "exponent $k$",
        "−1",
        _towards("1+k", lambda d: d - 1.0, ends),
        _fixed("k", -0.5),
        _from("-k", lambda d: -d, middle),
        "0",
        _fixed("k", 0.0),
        _towards("k", lambda d: d, middle),
        _fixed("k", 0.5),
        _from("1-k", lambda d: 1.0 - d, ends),
        "1",
    )


def phi_scale(dtype: str, step: int) -> Scale:
    return _scale(
        r"amplitude $\varphi$",
        "0",
        _towards("phi", lambda d: d, _decades(12, step)),
        _fixed("phi", 0.5),
        _from("1-phi", lambda d: 1.0 - d, _decades({"float64": 12, "float32": 7}[dtype], step)),
        "1",
    )


def nu_scale(dtype: str, step: int) -> Scale:
    return _scale(
        r"Poisson's ratio $\nu$",
        "−1",
        _towards("1+nu", lambda d: d - 1.0, _decades(5, step)),
        _fixed("nu", 0.3),
        _from("1/2-nu", lambda d: 0.5 - d, _decades(FINEST[dtype], step)),
        "½",
    )


def _beyond(name: str, radius: Callable[[float, float], float], dtype: str) -> list[Place]:
    """Radii from ten times one to the largest ones."""
    tens = (1, 3, 6, 12, 30, 100, 300) if dtype == "float64" else (1, 3, 6, 12, 30)
    return [Place(f"{name} = 1e{n}", lambda c, a, n=n: radius(c, a) * 10.0**n) for n in tens]


def punch_scale(dtype: str, step: int) -> Scale:
    """Radii about the edge r = 1 of the punch, or of the contact before any wear."""
    near = _decades(FINEST[dtype], step)
    return _scale(
        "radius $r$",
        "0",
        Place("r = 0", lambda c, a: 0.0),
        _towards("r", lambda d, c, a: d, (12, 9, 6, 3)),
        Place("r = 0.5", lambda c, a: 0.5),
        _from("1-r", lambda d, c, a: 1.0 - d, near),
        "$a$",
        _towards("r-1", lambda d, c, a: 1.0 + d, near),
        Place("r = 2", lambda c, a: 2.0),
        _beyond("r", lambda c, a: 1.0, dtype),
        "∞",
    )


def ring_scale(dtype: str, step: int) -> Scale:
    """Radii about both edges of the worn ring. From c outwards a distance is in units of c or the ring's width b."""
    near = _decades(FINEST[dtype], step)
    return _scale(
        "radius $r$",
        "0",
        Place("r = 0", lambda c, a: 0.0),
        _towards("r/c", lambda d, c, a: c * d, (12, 6, 3)),
        Place("r/c = 0.5", lambda c, a: 0.5 * c),
        _from("1-r/c", lambda d, c, a: c - c * d, near),
        "$c$",
        _towards("(r-c)/min(b, c)", lambda d, c, a: c + min(a - c, c) * d, near),
        Place("r^2 = c a_inf", lambda c, a: (c * a) ** 0.5),
        Place("(r-c)/b = 0.5", lambda c, a: 0.5 * (c + a)),
        _from("(a_inf-r)/b", lambda d, c, a: a - (a - c) * d, near),
        r"$a_\infty$",
        _towards("r/a_inf-1", lambda d, c, a: a + a * d, near),
        Place("r/a_inf = 2", lambda c, a: 2.0 * a),
        _beyond("r/a_inf", lambda c, a: a, dtype),
        "∞",
    )


def scales(names: tuple[str, ...], dtype: str, quick: bool) -> tuple[Scale, ...]:
    """The scales of a quantity's arguments; the more arguments, the coarser."""
    ring = "r" in names and "phi" in names
    made = {"k": k_scale, "phi": phi_scale, "nu": nu_scale, "r": ring_scale if ring else punch_scale}
    steps = {"k": 2, "phi": 4, "r": 2} if ring else {}
    if quick:
        steps = {"k": 18, "phi": 24, "r": 18} if ring else dict.fromkeys(names, 8)
    return tuple(made[name](dtype, steps.get(name, 1)) for name in names)


# --- quantities -----------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Quantity:
    """A function of the library with the names of its arguments, and its twin in the oracle."""

    name: str
    function: Callable[..., jax.Array]
    arguments: tuple[str, ...]
    twin: str
    field: str | None = None  # of a twin that gives several quantities


@oracle.quantity
def h_N_holl(k: Any) -> Any:
    """h_N at Holl's ratio, by the oracle's own h_N."""
    return oracle.h_N.formula(k, 1 / (2 + k))


def _of_point(name: str) -> Quantity:
    return Quantity(f"fretting.{name}", getattr(fretting, name), ("k", "phi"), "fretting_point", name)


def _of_fretting(name: str, *arguments: str) -> Quantity:
    return Quantity(f"fretting.{name}", getattr(fretting, name), arguments, name)


def _of_gross_slip(name: str, *arguments: str) -> Quantity:
    prefix = "gross_" if "r" in arguments else ""
    return Quantity(f"gross_slip.{name}", getattr(gross_slip, name), arguments, f"{prefix}{name}")


AMPLITUDES = (
    _of_point("wear_volume"),
    _of_point("worn_radius"),
    _of_point("stick_radius"),
    _of_point("penetration"),
    _of_fretting("edge_intensity", "k", "phi"),
)
RING = tuple(
    _of_fretting(name, "r", "k", "phi")
    for name in ("wear_depth", "profile", "steady_displacement", "steady_pressure", "steady_traction")
)
PUNCH = (
    *(_of_gross_slip(f"{when}_displacement", "r", "k") for when in ("initial", "steady")),
    *(_of_gross_slip(f"{when}_pressure", "r", "k") for when in ("initial", "steady")),
    *(_of_fretting(f"initial_{what}", "r", "k") for what in ("displacement", "pressure")),
)
MATERIAL = (Quantity("material.h_N", material.h_N, ("k", "nu"), "h_N"),)
EXPONENTS = (
    Quantity("material.h_N (Holl)", lambda k: material.h_N(k, "holl"), ("k",), "h_N_holl"),
    Quantity("material.holl_ratio", material.holl_ratio, ("k",), "holl_ratio"),
    _of_gross_slip("force_ratio", "k"),
    _of_gross_slip("volume_change", "k"),
)
QUANTITIES = (*AMPLITUDES, *RING, *PUNCH, *MATERIAL, *EXPONENTS)
QUICK = (*AMPLITUDES[:2], RING[3], PUNCH[0])


def program(quantity: Quantity, order: int) -> Callable[..., tuple[Any, ...]]:
    """(value, gradient, Hessian) up to the first or second order, in one compiled program."""
    every = tuple(range(len(quantity.arguments)))
    slopes = jax.value_and_grad(quantity.function, every)

    def once(*at: jax.Array) -> tuple[Any, tuple[Any, Any]]:
        value, gradient = slopes(*at)
        return gradient, (value, gradient)

    def twice(*at: jax.Array) -> tuple[Any, Any, Any]:
        hessian, (value, gradient) = jax.jacfwd(once, every, has_aux=True)(*at)
        return value, gradient, hessian

    return jax.jit(jax.vmap(slopes if order == 1 else twice))


@functools.lru_cache(maxsize=1)  # four quantities share a point of the oracle
def _mapped(twin: str, points: bytes, arguments: int, order: int, processes: int) -> list[Any]:
    at = np.frombuffer(points).reshape(-1, arguments).tolist()
    # What is defined in this file is not known to other processes.
    return oracle.map_points(twin, at, 1 if twin == h_N_holl.__name__ else processes, order=order)


def exact(quantity: Quantity, points: Floats, order: int, processes: int) -> list[Floats]:
    """Value, gradient, Hessian at each column of `points`: arrays (points, entries, 2) of doubles hi + lo."""
    at = np.ascontiguousarray(points.T)
    found = _mapped(quantity.twin, at.tobytes(), len(points), order, processes)
    if quantity.field:
        found = [getattr(point, quantity.field) for point in found]
    rows = [[point.value for point in found], [point.gradient for point in found], [point.hessian for point in found]]
    return [np.array(row, float).reshape(len(found), -1, 2) for row in rows[: order + 1]]


# --- the scan -------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Scan:
    """A quantity over the grid of its scales."""

    quantity: Quantity
    dtype: str
    scales: tuple[Scale, ...]
    points: Floats  # (arguments, *grid), what they are in the dtype
    digits: Floats  # (orders, *grid): correct digits of the worst entry; NaN where nothing can be compared
    broken: Flags  # (orders, *grid): NaN, infinite or negative, and should not be


@dataclasses.dataclass(frozen=True)
class Grid:
    """All combinations of places as they are in a dtype, and the two edges of the ring, or of the punch, for each."""

    points: Floats  # (arguments, points)
    c: Floats
    a_inf: Floats

    def __getitem__(self, chosen: Flags) -> "Grid":
        return Grid(self.points[:, chosen], self.c[chosen], self.a_inf[chosen])


def grid(arguments: tuple[str, ...], chosen: tuple[Scale, ...], dtype: str) -> Grid:
    """The grid of a quantity; radii are placed once k and phi have been rounded."""
    rows = [dict(zip(arguments, places, strict=True)) for places in itertools.product(*(s.places for s in chosen))]
    columns = {name: _rounded([row[name].at() for row in rows], dtype) for name in arguments if name != "r"}
    c = a_inf = np.ones(len(rows))
    if "phi" in arguments:
        inside = np.abs(columns["k"]) < 1.0
        safe = np.where(inside, columns["k"], np.nan), np.where(columns["phi"] < 1.0, columns["phi"], np.nan)
        c, a_inf = (np.asarray(jax.jit(f)(*safe)) for f in (fretting.stick_radius, fretting.worn_radius))
    if "r" in arguments:
        edges = zip(rows, c.tolist(), a_inf.tolist(), strict=True)
        columns["r"] = _rounded([row["r"].at(*ring) for row, *ring in edges], dtype)
    return Grid(np.stack([columns[name] for name in arguments]), c, a_inf)


def _rounded(x: Sequence[float], dtype: str) -> Floats:
    with np.errstate(over="ignore"):
        return np.array(x).astype(dtype).astype(float)


def scan(quantity: Quantity, dtype: str, order: int, quick: bool, processes: int) -> Scan:
    """Compare a quantity and its derivatives up to an order with the oracle."""
    arguments = quantity.arguments
    chosen = scales(arguments, dtype, quick)
    everywhere = grid(arguments, chosen, dtype)
    inside = _inside(arguments, everywhere)
    here = everywhere[inside]
    truth = exact(quantity, here.points, order, processes)
    forgiven = _forgiven(quantity, here, dtype, truth, processes)
    on_edge, unclear = (_beside(arguments, here, dtype, units) for units in (4.0, 32.0))
    least = _least(quantity, here, dtype)

    digits = np.full((order + 1, inside.size), np.nan)
    broken = np.zeros((order + 1, inside.size), bool)
    made = program(quantity, order)(*(x.astype(dtype) for x in everywhere.points))
    for n, derivative in enumerate(made):
        mine = np.stack([np.asarray(x)[inside].astype(float) for x in jax.tree.leaves(derivative)], axis=-1)
        correct, wrong = judge(mine, truth[n], np.abs(truth[0][:, :, 0]), forgiven[n], dtype)
        if n == 0:
            wrong = wrong | (mine[:, 0] < least)
        digits[n, inside], broken[n, inside] = np.where(unclear, np.nan, correct), wrong & ~on_edge
    shape = tuple(len(scale.places) for scale in chosen)
    points, digits = (x.reshape(-1, *shape) for x in (everywhere.points, digits))
    return Scan(quantity, dtype, chosen, points, digits, broken.reshape(-1, *shape))


def judge(mine: Floats, theirs: Floats, size: Floats, forgiven: Floats, dtype: str) -> tuple[Floats, Flags]:
    """Correct digits of the worst entry at each point, and where one is NaN or infinite that should not be."""
    kind = np.finfo(dtype)
    representable = np.abs(theirs[..., 0]) <= float(kind.max)
    with np.errstate(invalid="ignore", over="ignore"):
        error = np.maximum(np.abs((mine - theirs[..., 0]) - theirs[..., 1]) - forgiven, 0.0)
        # The smallest number whose ulp is a normal number; what is smaller is as good as zero.
        scale = np.maximum(np.maximum(np.abs(theirs[..., 0]), size), float(kind.tiny / kind.eps))
        relative = error / scale
    relative = np.where(np.isfinite(mine), relative, 1.0)
    worst = np.where(representable, relative, 0.0).max(axis=1)
    digits = -np.log10(np.clip(worst, float(kind.epsneg), 1.0))
    digits[~representable.any(axis=1)] = np.nan
    return digits, np.asarray((representable & ~np.isfinite(mine)).any(axis=1))


def _inside(arguments: tuple[str, ...], grid: Grid) -> Flags:
    """Where rounding to the dtype has not put a point on an edge or beyond."""
    at = dict(zip(arguments, grid.points, strict=True))
    kept = np.abs(at["k"]) < 1.0
    if "phi" in at:
        kept &= at["phi"] < 1.0
    if "r" in at:
        kept &= np.isfinite(at["r"]) & (at["r"] != grid.c) & (at["r"] != grid.a_inf)
    return kept


def _beside(arguments: tuple[str, ...], grid: Grid, dtype: str, units: float) -> Flags:
    """Where r is within a few units in its last place of an edge of the ring."""
    if not {"r", "phi"} <= set(arguments):
        return np.zeros(grid.c.size, bool)
    r = grid.points[arguments.index("r")]
    return np.minimum(np.abs(r - grid.c), np.abs(r - grid.a_inf)) <= units * np.spacing(r.astype(dtype)).astype(float)


def _forgiven(quantity: Quantity, here: Grid, dtype: str, truth: list[Floats], processes: int) -> list[Floats]:
    """What moving r by four units in its last place, away from c and a_inf, makes of each exact entry."""
    forgiven = [np.zeros(x.shape[:2]) for x in truth]
    if not {"r", "phi"} <= set(quantity.arguments):
        return forgiven
    row = quantity.arguments.index("r")
    r = here.points[row]
    near = np.minimum(np.abs(r / here.c - 1.0), np.abs(r / here.a_inf - 1.0)) < 0.1
    near &= ~_beside(quantity.arguments, here, dtype, 32.0)
    moved = here.points[:, near]
    inner = np.abs(r - here.c) < np.abs(r - here.a_inf)
    side = np.sign(r - np.where(inner, here.c, here.a_inf))[near]
    moved[row] += 4.0 * side * np.spacing(moved[row].astype(dtype)).astype(float)
    if near.any():
        for n, there in enumerate(exact(quantity, moved, len(truth) - 1, processes)):
            forgiven[n][near] = np.abs((there - truth[n][near]).sum(axis=-1))
    return forgiven


def _least(quantity: Quantity, here: Grid, dtype: str) -> Floats:
    """What no value may fall below: nothing is negatively worn, and the ring reaches out of the contact."""
    count = here.c.size
    if quantity.name in ("fretting.wear_volume", "fretting.wear_depth", "gross_slip.volume_change"):
        return np.zeros(count)
    if quantity.name == "fretting.worn_radius":
        return np.ones(count)
    if quantity.name == "fretting.profile":
        r = here.points[0].astype(dtype)
        with np.errstate(over="ignore"):
            return (r.dtype.type(0.5) * r * r).astype(float)
    return np.full(count, -np.inf)


# --- the table ------------------------------------------------------------------------------------------------------


def _words(scan: Scan, index: tuple[int, ...]) -> str:
    return ", ".join(scale.places[i].name for scale, i in zip(scan.scales, index, strict=True))


def _indices(flags: Flags) -> list[tuple[int, ...]]:
    return [tuple(map(int, index)) for index in np.argwhere(flags)]


def worst_table(scans: Sequence[Scan]) -> Table:
    """The place of each quantity, order of derivative and dtype with the fewest correct digits."""
    title = "Fewest correct digits, share of the points with less than half of them, and where"
    table = Table(title=title, title_justify="left", title_style="bold")
    for column, side in zip(("", "order", "dtype", "digits", "half lost"), "lllrr", strict=True):
        table.add_column(column, justify="right" if side == "r" else "left", no_wrap=True)
    table.add_column("at")
    for name, group in itertools.groupby(sorted(scans, key=lambda s: s.quantity.name), key=lambda s: s.quantity.name):
        for one in group:
            for order, digits in enumerate(one.digits):
                if not np.isnan(digits).all():
                    index = tuple(map(int, np.unravel_index(np.nanargmin(digits), digits.shape)))
                    lost = np.nanmean(digits < 0.5 * -np.log10(np.finfo(one.dtype).eps))
                    reached = abs(digits[index])  # no minus before a zero
                    numbers = (str(order), one.dtype, f"{reached:.1f}", f"{100.0 * lost:.1f} %")
                    table.add_row(name, *numbers, _words(one, index))
        table.add_section()
    return table


def broken_lines(scans: Sequence[Scan]) -> list[str]:
    """The points at which a result is NaN, infinite or negative, and should not be."""
    return [
        f"{one.quantity.name}, {order}, {one.dtype}: ({', '.join(repr(float(x)) for x in one.points[:, *index])})"
        f"  {_words(one, index)}"
        for one in scans
        for order, broken in zip(ORDERS, one.broken, strict=False)
        for index in _indices(broken)
    ]


# --- the maps -------------------------------------------------------------------------------------------------------

BROKEN, NOTHING = COLOURS[1], "0.82"
MOST = 16  # digits


class Sheet(NamedTuple):
    """A figure: maps of the second derivatives of quantities, with two arguments along the axes of each."""

    name: str
    quantities: tuple[str, ...]
    x: str
    y: str
    note: str


# Where second derivatives lose digits; all other numbers are in the table.
LOST = ("fretting.wear_depth", "fretting.profile", "fretting.steady_pressure")
SHEETS = (
    Sheet("extremes_ring_k", LOST, "r", "k", "the worst of all amplitudes"),
    Sheet("extremes_ring_phi", LOST, "r", "phi", "the worst of all exponents"),
)


def _flattened(scan: Scan, x: str, y: str) -> tuple[Floats, Flags, Scale, Scale]:
    """Digits and broken points of the second derivatives as (y, x), the worst over any other argument."""
    names = scan.quantity.arguments
    kept = [1 + names.index(name) for name in (y, x)]
    others = tuple(set(range(1, scan.digits.ndim)) - set(kept))
    digits = np.where(np.isnan(scan.digits), np.inf, scan.digits).min(axis=others)[2]
    digits, broken = np.where(np.isinf(digits), np.nan, digits), np.asarray(scan.broken.any(axis=others))[2]
    if kept[0] > kept[1]:
        digits, broken = digits.T, broken.T
    return digits, broken, scan.scales[kept[1] - 1], scan.scales[kept[0] - 1]


def draw(sheet: Sheet, scans: Sequence[Scan]) -> Figure:
    """The maps of a sheet."""
    figure = page(18.0, 6.6, "constrained")
    panels = figure.subplots(1, len(scans), sharey=True, squeeze=False)[0]
    for axes, one in zip(panels, scans, strict=True):
        digits, broken, x, y = _flattened(one, sheet.x, sheet.y)
        _map(axes, digits, broken)
        axes.set_title(one.quantity.name.removeprefix("fretting.").replace("_", " "), fontsize=LABEL_SIZE, pad=3)
        _mark(axes, "x", x)
        _mark(axes, "y", y)
        axes.label_outer(remove_inner_ticks=False)
        axes.set_xlabel(f"{x.label}, each cell a decade", fontsize=LABEL_SIZE)
        if axes is panels[0]:
            axes.set_ylabel(y.label, fontsize=LABEL_SIZE)
    _legend(figure, panels, sheet.note)
    return figure


def _map(axes: Axes, digits: Floats, broken: Flags) -> None:
    axes.set_facecolor(NOTHING)
    axes.pcolormesh(np.ma.masked_invalid(digits), cmap="viridis", norm=_norm(), rasterized=True)
    rows, columns = np.nonzero(broken)
    axes.plot(columns + 0.5, rows + 0.5, "x", color=BROKEN, markersize=3, markeredgewidth=0.9)
    axes.set(xlim=(0, digits.shape[1]), ylim=(0, digits.shape[0]))


def _norm() -> BoundaryNorm:
    return BoundaryNorm(np.linspace(0.0, MOST, 17), 256)


def _mark(axes: Axes, side: Literal["x", "y"], scale: Scale) -> None:
    """Edges of the domain along one side of a map, with lines there."""
    axis, line = (axes.xaxis, axes.axvline) if side == "x" else (axes.yaxis, axes.axhline)
    axis.set_ticks([at for at, _ in scale.edges], [symbol for _, symbol in scale.edges])
    axes.tick_params(axis=side, which="major", length=3.5, width=0.6, pad=1.5, labelsize=TICK_SIZE)
    for at, _ in scale.edges:
        line(at, color="w", linewidth=0.8)


def _legend(figure: Figure, panels: Any, note: str) -> None:
    bar = figure.colorbar(
        ScalarMappable(_norm(), "viridis"),
        ax=panels,
        location="top",
        fraction=0.04,
        aspect=60,
        pad=0.01,
        ticks=range(0, MOST + 1, 2),
    )
    bar.ax.tick_params(labelsize=TICK_SIZE)
    bar.set_label(f"correct digits of second derivatives in float64, {note}", fontsize=LABEL_SIZE)
    handles = [
        Patch(color=NOTHING, label="nothing to compare: an edge, or no number"),
        Line2D([], [], linestyle="", marker="x", color=BROKEN, markersize=4, label="NaN, infinite or negative"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=TICK_SIZE, frameon=False)


# --- the program ----------------------------------------------------------------------------------------------------


def main(
    quick: Quick = False,
    out: Out = DEFAULT_OUT,
    only: str = typer.Option("", help="Quantities whose name contains this."),
    processes: int = typer.Option(1, help="Processes for the oracle, which takes most of the time."),
) -> None:
    """Scan every quantity towards every edge of its domain."""
    if processes > 1:
        cores.release()
    report = Report("extremes", out, "Correct digits towards the edges of the domain", quick)
    chosen = [quantity for quantity in (QUICK if quick and not only else QUANTITIES) if only in quantity.name]
    scans = []
    for dtype in ("float64",) if quick else ("float64", "float32"):
        scans += [scan(quantity, dtype, 1 if quick else 2, quick, processes) for quantity in chosen]
    lost = {one.quantity.name: one for one in scans if one.dtype == "float64" and not quick}
    for sheet in SHEETS:
        if set(sheet.quantities) <= set(lost):
            draw(sheet, [lost[name] for name in sheet.quantities]).savefig(out / f"{sheet.name}.png")
    report.print(worst_table(scans))
    broken = broken_lines(scans)
    for line in broken:
        report.print(line)
    report.print(f"{len(broken)} results are NaN, infinite or negative where they should not be")
    report.close()
    raise typer.Exit(bool(broken))


if __name__ == "__main__":
    harness.run(main)
