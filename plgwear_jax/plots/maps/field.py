"""Maps over two axes, with contour lines."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from plgwear_jax.plots.maps.colours import BLANK, Span, colours_of, note, span_of
from plgwear_jax.plots.maps.optimum import draw_optimum
from plgwear_jax.plots.maps.rows import Row, edges_of, set_scale
from plgwear_jax.plots.maps.subject import Subject
from plgwear_jax.plots.maps.texts import plain_number, unit_of, words_of
from plgwear_jax.plots.style import (
    LABEL_SIZE,
    TICK_SIZE,
    labelled,
    plain_ticks,
)

__all__ = [
    "draw_map",
]

YES, NO = "#0072B2", "#F6D3A3"


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
    handles = draw_optimum(axes, subject, across, upwards)
    if span.any:
        _draw_bar(figure, axes, mesh, span, factor, labelled(words_of(subject.variable), unit))
        if across.names is None and upwards.names is None:
            _draw_contours(axes, across, upwards, shown, _levels(span, factor, contours), norm, colours)
    if np.any(np.isnan(values)):
        handles.append(Patch(facecolor=BLANK, label=f"grey: {subject.missing}"))
    if span.clipped:
        handles.append(note(span.clipped))
    return handles


def _draw_bar(figure: Figure, axes: Axes, mesh: Any, span: "Span", factor: float, label: str) -> None:
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
    drawn = [to_frame.transform(np.transpose(line.get_data())) for line in axes.get_lines()]
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
        if room.size and room.max() > _ROOM:
            numbers.append(places[room.argmax()])
            taken.append(numbers[-1][None])
    if numbers:
        manual = to_frame.inverted().transform(numbers)
        axes.clabel(lines, fmt=texts, fontsize=6, inline_spacing=2, manual=manual)


_ROOM = 0.04  # around a number, of the width or height of the frame


def _levels(span: "Span", factor: float, count: int) -> list[float]:
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
