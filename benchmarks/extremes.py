"""Correct digits of every dimensionless quantity and its derivatives, all the way to the edges of the domain.

    python benchmarks/extremes.py                  the table of worst points in both dtypes: ten minutes
    python benchmarks/extremes.py --quick          some in float64, values and first derivatives, on a coarse grid

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

import functools
import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import cores
import harness  # before jax: pins the process
import jax
import numpy as np
from harness import Part, Report, oracle
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax.plots.style import COLOURS, STYLE, page

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

ORDERS = ("value", "first derivatives", "second derivatives")

# --- places ---------------------------------------------------------------------------------------------------------

Place = tuple[str, Callable[[float, float], float]]  # named by its distance to an edge; a function of c and a_inf


class Scale(NamedTuple):
    """The places of an argument from end to end, with the symbols of the edges that stand between them."""

    label: str
    places: tuple[Place, ...]
    edges: tuple[tuple[int, str], ...]


def _towards(name: str, at: Callable[[float, float, float], float], decades: Iterable[int]) -> list[Place]:
    """Places at 10^-n from an edge for each n in turn."""
    return [(f"{name} = 1e{-n}", functools.partial(at, 10.0**-n)) for n in decades]


def _parts(name: str, dtype: str, step: int, ring: bool) -> tuple[str, list[str | list[Place]]]:
    """The label of an argument, and symbols of edges and places as they follow each other."""
    finest = {"float64": 12, "float32": 6}[dtype]

    def to(name: str, at: Callable[[float, float, float], float], most: int = finest) -> list[Place]:
        return _towards(name, at, range(most, 0, -step))

    def off(name: str, at: Callable[[float, float, float], float], most: int = finest) -> list[Place]:
        return to(name, at, most)[::-1]

    def fixed(value: float) -> list[Place]:
        return [(f"{name} = {value:g}", lambda c, a: value)]

    if name == "k":
        near = min(9, finest)
        below = [to("1+k", lambda d, c, a: d - 1.0, near), fixed(-0.5), off("-k", lambda d, c, a: -d, 9)]
        above = [to("k", lambda d, c, a: d, 9), fixed(0.5), off("1-k", lambda d, c, a: 1.0 - d, near)]
        return "exponent $k$", ["−1", *below, "0", fixed(0.0), *above, "1"]
    if name == "phi":
        near = off("1-phi", lambda d, c, a: 1.0 - d, 12 if finest == 12 else 7)
        return r"amplitude $\varphi$", ["0", to("phi", lambda d, c, a: d, 12), fixed(0.5), near, "1"]
    if name == "nu":
        ends = to("1+nu", lambda d, c, a: d - 1.0, 5), off("1/2-nu", lambda d, c, a: 0.5 - d)
        return r"Poisson's ratio $\nu$", ["−1", ends[0], fixed(0.3), ends[1], "½"]
    far = (-1, -3, -6, -12, -30, *((-100, -300) if finest == 12 else ()))
    if ring:  # both edges of the worn ring; from c outwards a distance is in units of c or the ring's width b
        around = [
            _towards("r/c", lambda d, c, a: c * d, (12, 6, 3)),
            [("r/c = 0.5", lambda c, a: 0.5 * c)],
            off("1-r/c", lambda d, c, a: c - c * d),
            "$c$",
            to("(r-c)/min(b, c)", lambda d, c, a: c + min(a - c, c) * d),
            [("r^2 = c a_inf", lambda c, a: (c * a) ** 0.5), ("(r-c)/b = 0.5", lambda c, a: 0.5 * (c + a))],
            off("(a_inf-r)/b", lambda d, c, a: a - (a - c) * d),
            r"$a_\infty$",
            to("r/a_inf-1", lambda d, c, a: a + a * d),
            [("r/a_inf = 2", lambda c, a: 2.0 * a)],
            _towards("r/a_inf", lambda d, c, a: a * d, far),
        ]
    else:  # the edge r = 1 of the punch, or of the contact before any wear
        around = [
            _towards("r", lambda d, c, a: d, (12, 9, 6, 3)),
            fixed(0.5),
            off("1-r", lambda d, c, a: 1.0 - d),
            "$a$",
            to("r-1", lambda d, c, a: 1.0 + d),
            fixed(2.0),
            _towards("r", lambda d, c, a: d, far),
        ]
    return "radius $r$", ["0", fixed(0.0), *around, "∞"]


def scales(names: tuple[str, ...], dtype: str, quick: bool) -> tuple[Scale, ...]:
    """The scales of a quantity's arguments; the more arguments, the coarser."""
    ring = "r" in names and "phi" in names
    steps = {"k": 2, "phi": 4, "r": 2} if ring else {}
    if quick:
        steps = {"k": 18, "phi": 24, "r": 18} if ring else dict.fromkeys(names, 8)
    found = []
    for name in names:
        label, parts = _parts(name, dtype, steps.get(name, 1), ring)
        places: list[Place] = []
        edges = []
        for part in parts:
            if isinstance(part, str):
                edges.append((len(places), part))
            else:
                places += part
        found.append(Scale(label, tuple(places), tuple(edges)))
    return tuple(found)


# --- quantities -----------------------------------------------------------------------------------------------------


class Quantity(NamedTuple):
    """A function of the library with the names of its arguments, and its twin in the oracle."""

    name: str
    function: Callable[..., jax.Array]
    arguments: tuple[str, ...]
    twin: str


@oracle.quantity
def h_N_holl(k: Any) -> Any:
    """h_N at Holl's ratio, by the oracle's own h_N."""
    return oracle.h_N.formula(k, 1 / (2 + k))


def _of(module: Any, arguments: str, *names: str, twin: str = "{}") -> list[Quantity]:
    room = module.__name__.rpartition(".")[2]
    return [
        Quantity(f"{room}.{name}", getattr(module, name), tuple(arguments.split()), twin.format(name)) for name in names
    ]


RING = ("wear_depth", "profile", "steady_displacement", "steady_pressure", "steady_traction")
PUNCH = ("initial_displacement", "steady_displacement", "initial_pressure", "steady_pressure")
QUANTITIES = (
    *_of(fretting, "k phi", "wear_volume", "worn_radius", "stick_radius", "penetration", "edge_intensity"),
    *_of(fretting, "r k phi", *RING),
    *_of(gross_slip, "r k", *PUNCH, twin="gross_{}"),
    *_of(fretting, "r k", "initial_displacement", "initial_pressure"),
    *_of(material, "k nu", "h_N"),
    Quantity("material.h_N (Holl)", lambda k: material.h_N(k, "holl"), ("k",), "h_N_holl"),
    *_of(material, "k", "holl_ratio"),
    *_of(gross_slip, "k", "force_ratio", "volume_change"),
)
QUICK = ("fretting.wear_volume", "fretting.worn_radius", "fretting.steady_pressure", "gross_slip.initial_displacement")


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


def exact(quantity: Quantity, points: Floats, order: int) -> list[Floats]:
    """Value, gradient, Hessian at each column of `points`: arrays (points, entries, 2) of doubles hi + lo."""
    # What is defined in this file is not known to other processes.
    processes = 1 if quantity.twin == h_N_holl.__name__ else len(cores.AVAILABLE)
    found = oracle.map_points(quantity.twin, points.T.tolist(), processes, order=order)
    rows = [[point.value for point in found], [point.gradient for point in found], [point.hessian for point in found]]
    return [np.array(row, float).reshape(len(found), -1, 2) for row in rows[: order + 1]]


# --- the scan -------------------------------------------------------------------------------------------------------


class Scan(NamedTuple):
    """A quantity over the grid of its scales."""

    quantity: Quantity
    dtype: str
    scales: tuple[Scale, ...]
    points: Floats  # (arguments, *grid), what they are in the dtype
    digits: Floats  # (orders, *grid): correct digits of the worst entry; NaN where nothing can be compared
    broken: Flags  # (orders, *grid): NaN, infinite or negative, and should not be


class Grid(NamedTuple):
    """All combinations of places as they are in a dtype, and the two edges of the ring, or of the punch, for each."""

    at: dict[str, Floats]
    c: Floats
    a_inf: Floats

    @property
    def points(self) -> Floats:
        return np.stack(list(self.at.values()))

    def only(self, chosen: Flags) -> "Grid":
        return Grid({name: x[chosen] for name, x in self.at.items()}, self.c[chosen], self.a_inf[chosen])

    def beside(self, dtype: str, units: float) -> Flags:
        """Whether each r lies so close to an edge of the ring: within so many units in the last place of r."""
        if not {"r", "phi"} <= self.at.keys():
            return np.zeros(self.c.size, bool)
        r = self.at["r"]
        unit = np.spacing(r.astype(dtype)).astype(float)
        return np.minimum(np.abs(r - self.c), np.abs(r - self.a_inf)) <= units * unit


def grid(arguments: tuple[str, ...], chosen: tuple[Scale, ...], dtype: str) -> Grid:
    """The grid of a quantity; radii are placed once k and phi have been rounded."""
    rows = [dict(zip(arguments, places, strict=True)) for places in itertools.product(*(s.places for s in chosen))]
    c = a_inf = np.ones(len(rows))
    at: dict[str, Floats] = {}
    for name in arguments[::-1]:  # r is the first one
        if name == "r" and "phi" in at:
            inside = np.where(np.abs(at["k"]) < 1.0, at["k"], np.nan), np.where(at["phi"] < 1.0, at["phi"], np.nan)
            c, a_inf = (np.asarray(jax.jit(f)(*inside)) for f in (fretting.stick_radius, fretting.worn_radius))
        placed = [row[name][1](*ring) for row, *ring in zip(rows, c.tolist(), a_inf.tolist(), strict=True)]
        with np.errstate(over="ignore"):
            at[name] = np.array(placed).astype(dtype).astype(float)
    return Grid({name: at[name] for name in arguments}, c, a_inf)


def scan(quantity: Quantity, dtype: str, quick: bool) -> Scan:
    """Compare a quantity and its derivatives with the oracle."""
    arguments, order = quantity.arguments, 1 if quick else 2
    chosen = scales(arguments, dtype, quick)
    everywhere = grid(arguments, chosen, dtype)
    at = everywhere.at
    # Rounding to the dtype may have put a point on an edge or beyond.
    inside = (np.abs(at["k"]) < 1.0) & (at.get("phi", at["k"]) < 1.0)
    if "r" in at:
        inside &= np.isfinite(at["r"]) & (at["r"] != everywhere.c) & (at["r"] != everywhere.a_inf)
    here = everywhere.only(inside)
    truth = exact(quantity, here.points, order)
    forgiven = _forgiven(quantity, here, dtype, truth)
    on_edge, unclear = (here.beside(dtype, units) for units in (4.0, 32.0))
    least = _least(quantity, here, dtype)

    digits = np.full((order + 1, inside.size), np.nan)
    broken = np.zeros((order + 1, inside.size), bool)
    made = program(quantity, order)(*(x.astype(dtype) for x in at.values()))
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


def _forgiven(quantity: Quantity, here: Grid, dtype: str, truth: list[Floats]) -> list[Floats]:
    """What moving r by four units in its last place, away from c and a_inf, makes of each exact entry."""
    forgiven = [np.zeros(x.shape[:2]) for x in truth]
    if not {"r", "phi"} <= here.at.keys():
        return forgiven
    r = here.at["r"]
    near = np.minimum(np.abs(r / here.c - 1.0), np.abs(r / here.a_inf - 1.0)) < 0.1
    near &= ~here.beside(dtype, 32.0)
    if near.any():
        inner = np.abs(r - here.c) < np.abs(r - here.a_inf)
        side = np.sign(r - np.where(inner, here.c, here.a_inf))
        moved = here._replace(at=here.at | {"r": r + 4.0 * side * np.spacing(r.astype(dtype)).astype(float)})
        for n, there in enumerate(exact(quantity, moved.only(near).points, len(truth) - 1)):
            forgiven[n][near] = np.abs((there - truth[n][near]).sum(axis=-1))
    return forgiven


def _least(quantity: Quantity, here: Grid, dtype: str) -> Any:
    """The lowest value allowed: wear is never negative, and the worn radius is never below the first contact radius."""
    if quantity.name == "fretting.profile":
        r = here.at["r"].astype(dtype)
        with np.errstate(over="ignore"):
            return (r.dtype.type(0.5) * r * r).astype(float)
    least = dict.fromkeys(("fretting.wear_volume", "fretting.wear_depth", "gross_slip.volume_change"), 0.0)
    return (least | {"fretting.worn_radius": 1.0}).get(quantity.name, -np.inf)


# --- the table ------------------------------------------------------------------------------------------------------


def _words(scan: Scan, index: Sequence[int]) -> str:
    return ", ".join(scale.places[i][0] for scale, i in zip(scan.scales, index, strict=True))


def worst_table(report: Report, scans: Sequence[Scan]) -> None:
    """The place of each quantity, order of derivative and dtype with the fewest correct digits."""
    rows: list[tuple[str, ...]] = []
    for name in sorted({one.quantity.name for one in scans}):
        for one in (one for one in scans if one.quantity.name == name):
            for order, digits in enumerate(one.digits):
                if not np.isnan(digits).all():
                    index = np.unravel_index(np.nanargmin(digits), digits.shape)
                    lost = np.nanmean(digits < 0.5 * -np.log10(np.finfo(one.dtype).eps))
                    reached = abs(digits[index])  # no minus before a zero
                    told = f"{reached:.1f}", f"{100.0 * lost:.1f} %", _words(one, [int(i) for i in index])
                    rows.append((name, str(order), one.dtype, *told))
        rows.append(())
    title = "Fewest correct digits, share of the points with less than half of them, and where"
    report.table(title, ("", "order", "dtype", "digits", "half lost", "at"), rows[:-1])


def broken_lines(scans: Sequence[Scan]) -> list[str]:
    """The points at which a result is NaN, infinite or negative, and should not be."""
    return [
        f"{one.quantity.name}, {order}, {one.dtype}: ({', '.join(repr(float(x)) for x in one.points[:, *index])})"
        f"  {_words(one, index)}"
        for one in scans
        for order, broken in zip(ORDERS, one.broken, strict=False)
        for index in np.argwhere(broken).tolist()
    ]


# --- the maps -------------------------------------------------------------------------------------------------------

BROKEN, NOTHING = COLOURS[1], "0.82"
LABEL_SIZE, TICK_SIZE = STYLE["font.size"], STYLE["legend.fontsize"]  # points
NORM = BoundaryNorm(np.linspace(0.0, 16.0, 17), 256)
# Where second derivatives lose digits; all other numbers are in the table.
LOST = ("fretting.wear_depth", "fretting.profile", "fretting.steady_pressure")
SHEETS = {
    "extremes_ring_k": ("k", "phi", "the worst of all amplitudes"),
    "extremes_ring_phi": ("phi", "k", "the worst of all exponents"),
}


def draw(scans: Sequence[Scan], y: str, over: str, note: str) -> Any:
    """Maps of second derivatives over the radius and another argument, the worst over the third."""
    figure = page(18.0, 6.6)
    panels = figure.subplots(1, len(scans), sharey=True, squeeze=False)[0]
    for axes, one in zip(panels, scans, strict=True):
        names = one.quantity.arguments
        lost = names.index(over)
        digits, broken = np.where(np.isnan(one.digits[2]), np.inf, one.digits[2]).min(lost).T, one.broken[2].any(lost).T
        axes.set_facecolor(NOTHING)
        axes.pcolormesh(np.ma.masked_invalid(np.where(np.isinf(digits), np.nan, digits)), norm=NORM, rasterized=True)
        rows, columns = np.nonzero(broken)
        axes.plot(columns + 0.5, rows + 0.5, "x", color=BROKEN, markersize=3, markeredgewidth=0.9)
        axes.set(xlim=(0, digits.shape[1]), ylim=(0, digits.shape[0]))
        axes.set_title(one.quantity.name.removeprefix("fretting.").replace("_", " "), fontsize=LABEL_SIZE, pad=3)
        across, up = one.scales[0], one.scales[names.index(y)]
        for axis, scale, line in ((axes.xaxis, across, axes.axvline), (axes.yaxis, up, axes.axhline)):
            axis.set_ticks([at for at, _ in scale.edges], [symbol for _, symbol in scale.edges])
            for at, _ in scale.edges:
                line(at, color="w", linewidth=0.8)
        axes.tick_params(which="major", length=3.5, width=0.6, pad=1.5, labelsize=TICK_SIZE)
        axes.label_outer(remove_inner_ticks=False)
        axes.set_xlabel(across.label, fontsize=LABEL_SIZE)
        if axes is panels[0]:
            axes.set_ylabel(up.label, fontsize=LABEL_SIZE)
    colours = ScalarMappable(NORM, "viridis")
    bar = figure.colorbar(colours, ax=panels, location="top", fraction=0.04, aspect=60, pad=0.05, ticks=range(0, 17, 2))
    bar.ax.tick_params(labelsize=TICK_SIZE)
    bar.set_label(f"correct digits of second derivatives in float64, {note}", fontsize=LABEL_SIZE)
    handles: list = [Patch(color="none", label="each cell: a decade of the distance from the nearest mark")]
    if any(np.isnan(one.digits[2]).all(one.quantity.arguments.index(over)).any() for one in scans):
        handles.append(Patch(color=NOTHING, label="nothing to compare: an edge, or no number"))
    if any(one.broken[2].any() for one in scans):
        handles.append(
            Line2D([], [], linestyle="", marker="x", color=BROKEN, markersize=4, label="NaN, infinite or negative")
        )
    figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=TICK_SIZE, frameon=False)
    return figure


# --- the program ----------------------------------------------------------------------------------------------------


def extremes(report: Report, quick: bool) -> None:
    """Scan every quantity towards every edge of its domain."""
    dtypes = ("float64",) if quick else ("float64", "float32")
    with cores.released():
        asked = [one for one in QUANTITIES if not quick or one.name in QUICK]
        scans = [scan(quantity, dtype, quick) for dtype in dtypes for quantity in asked]
    if not quick:
        lost = [next(one for one in scans if one.quantity.name == name) for name in LOST]
        for name, sheet in SHEETS.items():
            draw(lost, *sheet).savefig(report.path.with_name(f"{name}.png"))
    worst_table(report, scans)
    broken = broken_lines(scans)
    for line in broken:
        report.print(line)
    report.print(f"{len(broken)} results are NaN, infinite or negative where they should not be")
    report.failed = bool(broken)


if __name__ == "__main__":
    harness.run({"extremes": Part("Correct digits towards the edges of the domain", [extremes])})
