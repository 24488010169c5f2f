"""Curves along one axis, and maps over two with contour lines, in colours that fit their values.

Maps of the wear also show the least wear, of each amplitude or of all designs, and where a little more is worn.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import AsinhNorm, CenteredNorm, Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from plgwear_jax.plots.maps.rows import Row, edges_of, set_scale
from plgwear_jax.plots.maps.texts import DECADES, Span, Subject, plain_number, quantity_of, unit_of, words_of
from plgwear_jax.plots.style import BEST, COLOURS, LABEL_SIZE, REFERENCE, TICK_SIZE, labelled, plain_ticks

BLANK = "0.86"


def span_of(values: np.ndarray, variable: xr.DataArray) -> Span:
    """The range of values, and how colours follow it."""
    finite = values[np.isfinite(values)].astype(float)
    if finite.size == 0:
        return Span(False, 0.0, 1.0)
    lower, upper = float(finite.min()), float(finite.max())
    infinite = bool(np.any(np.isinf(values)))
    size = max(-lower, upper)
    signed = lower < -1e-6 * size and upper > 1e-6 * size  # smaller values are rounding errors
    if not signed and upper > 0.0 and not _is_share(variable, upper):
        least = float(np.quantile(finite[finite > 0.0], 0.002))
        if upper > 10.0**DECADES * least:
            positive = float(finite[finite > 0.0].min())
            said = "infinite values are left out of the scale" if infinite else ""
            return Span(True, positive, upper, True, False, bool(np.any(values <= 0.0)), infinite, said)
    sizes = np.abs(finite[finite != 0.0])
    crowded = signed and size > 30.0 * np.median(sizes)  # most values lie close to zero
    wide = lower < 0.0 >= upper and size > 10.0**DECADES * sizes.min()
    if not infinite and (crowded or wide):
        bend = min(max(float(np.quantile(sizes, 0.2 if signed else 0.002)), 1e-5 * size), 0.1 * size)
        ends = (-size, size) if signed else (lower, upper)
        return Span(True, *ends, signed=signed, bend=10.0 ** math.ceil(math.log10(bend)))
    said, usual = "", float(np.quantile(np.abs(finite), 0.99))
    if infinite or (usual > 0.0 and size > 20.0 * usual):
        lower, upper = max(lower, -usual), min(upper, usual)
        said = "scale ends with 99 % of the values"
    if signed:
        lower, upper = -max(-lower, upper), max(-lower, upper)
    return Span(True, lower, upper, False, signed, bool(np.any(values < lower)), bool(np.any(values > upper)), said)


def _is_share(variable: xr.DataArray, upper: float) -> bool:
    return str(variable.attrs.get("units", "1")) == "1" and upper <= 1.0


def colours_of(span: Span, factor: float) -> tuple[Normalize, Colormap]:
    """The scale of the colours, in the unit shown, and the colours."""
    lower, upper = span.lower / factor, span.upper / factor
    if span.bend:
        return AsinhNorm(span.bend / factor, lower, upper), colormaps["RdBu_r" if span.signed else "viridis"]
    if span.signed:
        return CenteredNorm(0.0, upper), colormaps["RdBu_r"]
    if span.log:
        return LogNorm(lower, upper), colormaps["viridis"]
    if lower == upper:  # the same everywhere
        margin = 0.5 * abs(lower) or 0.5
        lower, upper = lower - margin, upper + margin
    return Normalize(lower, upper), colormaps["viridis"]


def note(text: str) -> Line2D:
    """A line of the legend that only says something."""
    return Line2D([], [], linestyle="", label=text)


# Colours of Okabe and Ito; dashes besides, for grey prints.
_CURVES: tuple[dict[str, Any], ...] = (
    BEST,
    REFERENCE,
    {"color": "#009E73", "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 1.4},
    {"color": "#AA4499", "linestyle": (0, (1, 1.2)), "linewidth": 1.6},
    {"color": "k", "linestyle": (0, (9, 2)), "linewidth": 1.0},
    {"color": "#E69F00", "linestyle": (0, (3, 1.2, 1, 1.2, 1, 1.2)), "linewidth": 1.6},
)
# --- curves ---------------------------------------------------------------------------------------------------------


def draw_curves(axes: Axes, subject: Subject, across: Row, other: Row | None) -> list[Any]:
    """Draw one curve, or one for each value of the other axis; the entries of the legend."""
    values = subject.values
    curves = range(values.shape[0])
    axes.set_xmargin(0.0)
    set_scale(axes, "x", across)
    if values.dtype.kind == "b":
        factor = 1.0
        axes.set_yticks([0.0, 1.0], ["no", "yes"])
        axes.set_ylim(-0.2, 1.2)
        axes.set_ylabel(words_of(subject.variable), fontsize=LABEL_SIZE)
        notes = []
    else:
        span = span_of(values, subject.variable)
        factor, unit = unit_of(subject, span)
        axes.set_ylabel(labelled(words_of(subject.variable), unit), fontsize=LABEL_SIZE)
        notes = _stand_up(axes, span, factor)
    handles: list[Any] = []
    for place in curves:
        style: dict[str, Any] = {
            **_CURVES[place % len(_CURVES)],
            "label": "" if other is None else _entry(other, place),
        }
        if across.names is not None:
            style |= {"linestyle": "", "marker": "osD^v*"[place % 6], "markersize": 5.0}
        elif across.places.size <= 12:  # so few that people want to see where they are
            style |= {"marker": "osD^v*"[place % 6], "markersize": 3.0}
        if values.dtype.kind == "b" and across.names is None:
            style["drawstyle"] = "steps-mid"
        (line,) = axes.plot(across.shown, np.asarray(values[place], float) / factor, **style)
        if other is not None:
            handles.append(line)
    blank = np.isnan(np.asarray(values, float))
    if across.names is None and np.any(np.all(blank, axis=0)):
        edges = edges_of(across)
        for first, last in _runs(np.all(blank, axis=0)):
            axes.axvspan(edges[first], edges[last + 1], color=BLANK, linewidth=0.0, zorder=0)
        handles.append(Patch(facecolor=BLANK, label=f"grey: {subject.missing}"))
    elif np.any(blank):
        notes.append(f"gaps: {subject.missing}")
    return [*handles, *(note(text) for text in notes)]


def _stand_up(axes: Axes, span: Span, factor: float) -> list[str]:
    """The scale upwards, and what there is to say about it."""
    if span.log:
        axes.set_yscale("log")
        if span.clipped:
            axes.set_ylim(span.lower / factor, span.upper / factor)
        return [span.clipped] if span.clipped else []
    if span.signed:
        axes.axhline(0.0, color="0.7", linewidth=0.6, zorder=0)
    if span.bend:
        axes.set_yscale("asinh", linear_width=span.bend / factor)
        return []
    if span.clipped:
        margin = 0.03 * (span.upper - span.lower)
        axes.set_ylim((span.lower - margin) / factor, (span.upper + margin) / factor)
    axes.yaxis.set_major_locator(MaxNLocator(6))
    return [span.clipped] if span.clipped else []


def _entry(row: Row, place: int) -> str:
    if row.names is not None:
        return row.names[place]
    return f"${row.symbol}$ = {plain_number(row.shown[place], 4)} {row.unit}".rstrip()


# --- maps -------------------------------------------------------------------------------------------------------------


YES, NO = COLOURS[0], "#F6D3A3"


def draw_map(figure: Figure, axes: Axes, subject: Subject, across: Row, upwards: Row, contours: int) -> list[Any]:
    """Draw colours, contour lines and the optimum; the entries of the legend."""
    values = subject.values
    axes.set_facecolor(BLANK)
    for side, row in (("x", across), ("y", upwards)):
        set_scale(axes, side, row)
    edges = edges_of(across), edges_of(upwards)
    if values.dtype.kind == "b":
        axes.pcolormesh(*edges, values.astype(float), cmap=ListedColormap([NO, YES]), vmin=0, vmax=1, rasterized=True)
        no = "no, or not computed yet" if subject.ds.attrs.get("unfinished") else "no"
        words = words_of(subject.variable)
        return [Patch(facecolor=YES, label=f"{words}: yes"), Patch(facecolor=NO, label=no)]
    span = span_of(values, subject.variable)
    factor, unit = unit_of(subject, span)
    width = span.upper - span.lower or 1.0
    # matplotlib leaves out infinite values; here they get the colour of values beyond the scale
    bounded = np.where(np.isinf(values), np.sign(values) * (max(-span.lower, span.upper) + width), values)
    shown = np.ma.masked_invalid(bounded.astype(float) / factor)
    if span.log:
        shown = np.ma.maximum(shown, span.lower / factor)  # zero has a colour too
    norm, colours = colours_of(span, factor)
    mesh = axes.pcolormesh(*edges, shown, norm=norm, cmap=colours, rasterized=True)
    handles = _draw_optimum(axes, subject, across, upwards)
    if span.any:
        _draw_bar(figure, axes, mesh, span, factor, labelled(words_of(subject.variable), unit))
        if across.names is None and upwards.names is None:
            _draw_contours(axes, across, upwards, shown, _levels(span, factor, contours), norm, colours)
    if np.any(np.isnan(values)):
        handles.append(Patch(facecolor=BLANK, label=f"grey: {subject.missing}"))
    if span.clipped:
        handles.append(note(span.clipped))
    return handles


def _draw_bar(figure: Figure, axes: Axes, mesh: Any, span: Span, factor: float, label: str) -> None:
    extend = {(True, True): "both", (True, False): "min", (False, True): "max", (False, False): "neither"}
    bar = figure.colorbar(mesh, ax=axes, pad=0.02, aspect=22, extend=extend[span.below, span.above])
    bar.set_label(label, fontsize=LABEL_SIZE)
    bar.ax.tick_params(which="both", direction="in", labelsize=TICK_SIZE)
    bar.outline.set_linewidth(0.6)  # pyright: ignore[reportCallIssue, reportAttributeAccessIssue]
    if span.log:
        plain_ticks(bar.ax.yaxis)
    elif span.bend:
        levels: list[float] = []
        for level in sorted(_levels(span, factor, 8), key=lambda level: (level != 0.0, -abs(level))):
            if all(abs(mesh.norm(level) - mesh.norm(other)) > 0.06 for other in levels):
                levels.append(level)
        bar.set_ticks(levels, labels=[_level_text(level) for level in levels])
        bar.minorticks_off()


def _draw_contours(
    axes: Axes,
    across: Row,
    upwards: Row,
    shown: np.ma.MaskedArray,
    levels: Sequence[float],
    norm: Normalize,
    colours: Colormap,
) -> None:
    """Lines at levels, between values where their colours would be: these are even on a logarithmic scale, too."""
    heights = np.ma.masked_invalid(norm(shown).filled(np.nan))
    at = {float(norm(level)): level for level in levels}
    at = {height: level for height, level in at.items() if heights.min() < height < heights.max()}
    if not at:
        return
    lines = axes.contour(
        across.shown,
        upwards.shown,
        heights,
        levels=list(at),
        colors=["k" if _lightness(colours(height)) > 0.5 else "w" for height in at],
        linewidths=[1.1 if level == 0.0 else 0.5 for level in at.values()],
        linestyles="solid",
    )
    to_frame = axes.transData + axes.transAxes.inverted()
    texts = {height: _level_text(level) for height, level in at.items()}
    drawn = [to_frame.transform(line.get_xydata()) for line in axes.get_lines()]
    taken = [np.concatenate([np.empty((0, 2)), *drawn])]
    numbers: list[np.ndarray] = []
    for path in lines.get_paths():
        places = to_frame.transform(path.vertices)
        # A number lies along its line, so that there is little room where the line meets the frame.
        steep = np.ptp(places[:, 1]) > np.ptp(places[:, 0]) if places.size else False
        along = places[:, int(steep)]
        apart = [
            np.min(np.hypot(*(places[:, None] - x).T), axis=0, where=np.isfinite(x[:, :1]), initial=1.0) for x in taken
        ]
        room = np.min([along, 1.0 - along, *apart], axis=0)
        across_it = places[:, 1 - int(steep)]  # where half of its height lies beyond the frame it would be cut off
        room[np.minimum(across_it, 1.0 - across_it) < _HALF] = 0.0
        if room.size and room.max() > _ROOM:
            numbers.append(places[room.argmax()])
            taken.append(numbers[-1][None])
    if numbers:
        manual: Any = to_frame.inverted().transform(numbers)
        axes.clabel(lines, fmt=texts, fontsize=6, inline_spacing=2, manual=manual)


_ROOM = 0.04  # around a number, of the width or height of the frame
_HALF = 0.025  # half the height of a number


def _levels(span: Span, factor: float, count: int) -> list[float]:
    """Round numbers between the ends of the scale, about so many."""
    if not count:
        return []
    lower, upper = span.lower / factor, span.upper / factor
    if span.log:
        levels = _log_levels(lower, upper, count)
    elif span.bend:
        least, sides = span.bend / factor, 2 if span.signed else 1
        powers = [level for level in _log_levels(least, -lower, max(1, count // sides)) if level >= least]
        levels = [*(-level for level in reversed(powers)), *([0.0, *powers] if span.signed else [])]
    else:
        levels = [float(level) for level in MaxNLocator(count + 1).tick_values(lower, upper)]
    return [level for level in levels if lower <= level <= upper]


def _log_levels(lower: float, upper: float, count: int) -> list[float]:
    """Powers of ten, every so many of them; or 2 and 5 of each besides."""
    first, last = math.ceil(math.log10(lower) - 1e-9), math.floor(math.log10(upper) + 1e-9)
    decades = last - first + 1
    if decades > count:
        every = math.ceil(decades / count)
        return [10.0**power for power in range(first, last + 1) if power % every == 0]
    digits = (1.0, 2.0, 5.0) if 3 * decades <= count + 1 else (1.0, 3.0) if 2 * decades <= count + 1 else (1.0,)
    return [digit * 10.0**power for power in range(first - 1, last + 1) for digit in digits]


def _level_text(level: float) -> str:
    if level == 0.0 or 1e-3 <= abs(level) < 1e4:
        return plain_number(level)
    power = math.floor(math.log10(abs(level)) + 1e-9)
    digit = f"{level / 10.0**power:.3g}"
    if digit in ("1", "-1"):
        return f"${digit[:-1]}10^{{{power}}}$"
    return rf"${digit}{{\times}}10^{{{power}}}$"


def _lightness(colour: Sequence[float]) -> float:
    red, green, blue, *_ = colour
    return 0.299 * red + 0.587 * green + 0.114 * blue


# --- the least wear ---------------------------------------------------------------------------------------------------

_COLOUR = "w"  # with a black edge: red on green or violet is hard to see, and for some people not at all
_EDGE = [withStroke(linewidth=3.4, foreground="k")]
_OPTIMUM: dict[str, Any] = {"color": _COLOUR, "linewidth": 1.8, "zorder": 5, "path_effects": _EDGE}
_AT_BOUND: dict[str, Any] = {  # on the frame, not behind it
    **{name: _OPTIMUM[name] for name in ("color", "zorder")},
    "linewidth": 2.2,
    "linestyle": (0, (1, 1)),
    "clip_on": False,
    "path_effects": _EDGE,
}
_MARK: dict[str, Any] = {
    "color": _COLOUR,
    "marker": "*",
    "linestyle": "",
    "markersize": 9.0,
    "markeredgecolor": "k",
    "markeredgewidth": 0.8,
    "zorder": 6,
    "clip_on": False,
}
_PLATEAU: dict[str, Any] = {"colors": _COLOUR, "linewidths": 1.0, "linestyles": [(0, (4, 2))], "zorder": 4}
_THIN_EDGE: list[Any] = [withStroke(linewidth=2.0, foreground="k")]

_WEARS = ("wear_volume", "worn_radius", "deepest_wear", "volume_change", "force_drop")
_AMPLITUDES = ("phi", "tangential_force")
_CHOSEN = ("k", "E0", "z0")  # what a design chooses
_MORE = 0.05  # as much more wear as the plateau has at its edge


def _draw_optimum(axes: Axes, subject: Subject, across: Row, upwards: Row) -> list[Any]:
    """Draw the exponent of least wear for each amplitude, or the design of least wear; the entries of the legend.

    They are those of the values on the map: the lowest one, and between rows the vertex of the parabola through it and
    its neighbours.
    """
    if quantity_of(subject.variable) not in _WEARS:
        return []
    values = np.where(np.isnan(subject.values), np.inf, subject.values)
    if upwards.name == "k" and across.name in _AMPLITUDES:
        handles, least = _draw_course(axes, values, across, upwards), np.min(values, axis=0)
    elif {across.name, upwards.name} <= {*_CHOSEN} and np.min(values) < np.nanmax(subject.values):
        least = np.min(values)
        row, column = np.unravel_index(np.argmin(values), values.shape)
        handles = axes.plot(across.shown[column], upwards.shown[row], label="least wear", **_MARK)
    else:
        return []
    return [*handles, *_draw_plateau(axes, values, least, across, upwards)]


def _draw_course(axes: Axes, values: np.ndarray, across: Row, upwards: Row) -> list[Any]:
    row, joined = _least(values)
    course, at_bound = _between_rows(values, row, upwards)
    along = joined & at_bound[1:] & at_bound[:-1] & (row[1:] == row[:-1])
    handles = []
    for steps, style, name in (
        (joined & ~along, _OPTIMUM, r"least wear, $k^*$"),
        (along, _AT_BOUND, "$k^*$ at a bound"),
    ):
        if steps.any():
            handles += axes.plot(*_broken(across.shown, course, steps), label=name, **style)
    return handles


def _draw_plateau(axes: Axes, values: np.ndarray, least: Any, across: Row, upwards: Row) -> list[Any]:
    """Draw where the wear is a little more than the least one."""
    with np.errstate(divide="ignore", invalid="ignore"):
        more = np.ma.masked_invalid(values / least - 1.0)
    if not more.count() or not more.min() < _MORE < more.max():
        return []
    axes.contour(across.shown, upwards.shown, more, levels=[_MORE], **_PLATEAU).set_path_effects(_THIN_EDGE)
    style = {"color": _COLOUR, "linewidth": 1.0, "linestyle": _PLATEAU["linestyles"][0], "path_effects": _THIN_EDGE}
    return [Line2D([], [], label=f"{_MORE:.0%} more wear".replace("%", " %"), **style)]


def _between_rows(values: np.ndarray, row: np.ndarray, upwards: Row) -> tuple[np.ndarray, np.ndarray]:
    """Where the least value of each column lies upwards, and whether it is at an end."""
    spacing, last = upwards.spacing(), values.shape[0] - 1
    u = np.asarray(spacing.forward(upwards.values.astype(float)))
    place, ended = upwards.values[row], (row == 0) | (row == last)
    if last >= 2:
        columns, middle = np.arange(row.size), np.clip(row, 1, last - 1)
        near = [middle - 1, middle, middle + 1]
        (u_0, u_1, u_2), (v_0, v_1, v_2) = u[near], values[near, columns]
        with np.errstate(divide="ignore", invalid="ignore"):
            first, second = (v_1 - v_0) / (u_1 - u_0), (v_2 - v_1) / (u_2 - u_1)
            vertex = 0.5 * (u_0 + u_1 - first * (u_2 - u_0) / (second - first))
            inside = (second > first) & (u_0 < vertex) & (vertex < u_2)
        place = np.where(inside, spacing.inverse(np.where(inside, vertex, u_1)), place)
        ended &= ~inside
    return place / upwards.factor, ended


def _least(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The row of the least value of each column, -1 where all are the same, and whether it is continuous to the next.

    It is not continuous where larger values lie between the two rows.
    """
    told_apart = np.min(values, axis=0) < np.max(np.where(np.isfinite(values), values, -np.inf), axis=0)
    row = np.where(told_apart, np.argmin(values, axis=0), -1)
    joined = (row[1:] >= 0) & (row[:-1] >= 0)
    for column in np.flatnonzero(joined & (np.abs(np.diff(row)) > 1)):
        lower, upper = sorted((row[column], row[column + 1]))
        for side in (column, column + 1):
            ends = max(values[lower, side], values[upper, side])
            if not np.max(values[lower : upper + 1, side]) <= ends * (1.0 + 1e-5):
                joined[column] = False
    return row, joined


def _broken(x: np.ndarray, y: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points of a line of which only some steps are drawn."""
    parts = [np.append(line[first : last + 2], np.nan) for first, last in _runs(steps) for line in (x, y)]
    return np.concatenate(parts[::2])[:-1], np.concatenate(parts[1::2])[:-1]


def _runs(true: np.ndarray) -> list[tuple[int, int]]:
    """First and last place of every row of neighbours that are true."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], true, [False]]).astype(int)))
    return [(int(first), int(last) - 1) for first, last in zip(ends[::2], ends[1::2], strict=True)]
