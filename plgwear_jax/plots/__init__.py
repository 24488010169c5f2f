"""Pictures for print: a design beside its reference, the trade-off between wear and edge pressure, and others."""

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from plgwear_jax._core.extras import needs

with needs("pictures", "plots"):
    import matplotlib  # noqa: F401

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plgwear_jax import _files
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.units import readable
from plgwear_jax._files import TargetError as PictureError
from plgwear_jax.catalogue import AXES, entry, placed
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.optimise import Comparison, Design, Front, along, compared
from plgwear_jax.plots.coating import IN_LEGEND, PLACES, WINDOW, coating_picture, draw_rings, free_picture
from plgwear_jax.plots.over_cycles import blocks_picture, fit_picture, wear_picture
from plgwear_jax.plots.regimes import regimes_picture
from plgwear_jax.plots.style import (
    BEST,
    COLOURS,
    DOT,
    FORBIDDEN,
    GPA,
    GUIDE,
    LABEL_SIZE,
    REFERENCE,
    TICK_SIZE,
    UNWORN,
    finished,
    label_axes,
    labelled,
    legend_above,
    page,
    plain_ticks,
    scaled,
    use_style,
)
from plgwear_jax.rules import is_linear

__all__ = [
    "COLOURS",
    "PictureError",
    "blocks_picture",
    "check_target",
    "coating_picture",
    "design_picture",
    "fit_picture",
    "free_picture",
    "front_picture",
    "readable",
    "regimes_picture",
    "save",
    "use_style",
    "wear_picture",
]

# --- the picture of a design ----------------------------------------------------------------------------------------


@for_numbers("draw what the program returns")
def design_picture(design: Design, comparison: Comparison | None = None) -> Figure:
    """Draw a design beside its reference: the modulus over the depth, the objective over a variable, the wear depths.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The variable is k if it varies; the others have the values of the best design. Where a limit is broken the curve is
    thin and dashed. The scale is that of what keeps the limits, and need not begin at zero. If the reference is not on
    the curve, since its other variables differ, the panel says so. Dotted lines mark the contact radius and the edges c
    and a_inf of the worn rings (at the largest force amplitude), the contact radius a after the cycles of a
    displacement or of blocks, or the edge of the punch.

    Args:
        design: The result of `optimise.design`.
        comparison: The result of `optimise.compared`, if it was computed already.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    comparison = compared(design) if comparison is None else comparison
    slips = isinstance(design.contact, GrossSlipContact)
    figure = page(18.0, 7.6)
    # Labels and ticks always need about the same room, and a layout engine would double the time of drawing.
    panels = figure.subplot_mosaic([["a", "b", "c"]], gridspec_kw=PLACES)  # pyright: ignore[reportCallIssue, reportArgumentType]
    _draw_modulus(panels["a"], design, comparison)
    _draw_objective(panels["b"], design)
    if slips:
        _draw_punch(panels["c"], design, comparison)
    else:
        rings = zip(comparison.radii, comparison.depth, _both(design), strict=True)
        by_then = "worn_radius" not in comparison.quantities
        end = "$a$" if by_then else r"$a_\infty$"
        draw_rings(panels["c"], [(r, worn, r[0], r[-1], style) for r, worn, (*_, style) in rings], end)
    finished(panels)
    entries = [
        Line2D([], [], label=f"{label}{_with_k(contact)}", marker=marker, **DOT, **style)
        for contact, label, marker, style in _both(design)
    ]
    if slips:
        entries.append(Line2D([], [], label="unworn punch", **UNWORN))
    if design.windows:
        entries.append(Line2D([], [], label="allowed modulus", **IN_LEGEND))
    legend_above(figure, entries, 4, handlelength=3.5)
    return figure


def _draw_modulus(axes: Axes, design: Design, comparison: Comparison) -> None:
    slips = isinstance(design.contact, GrossSlipContact)
    edges = [design.reference.radius] * 2 if slips else comparison.quantities["contact_radius"]
    edges = [float(np.asarray(edge)) for edge in edges]
    (unit, depth_label), (_, modulus_label) = scaled("depth", edges[1]), scaled("modulus", GPA)
    same = math.isclose(*edges, rel_tol=1e-9)
    depths = np.asarray(comparison.depths) / unit
    for modulus, edge, (*_, style) in zip(comparison.modulus, edges, _both(design), strict=True):
        axes.loglog(depths, modulus / GPA, **style)
        axes.axvline(edge / unit, color="0.5" if same else style["color"], **GUIDE)
    for z, lowest, highest in design.windows:  # NaN where one side is free
        axes.plot([z / unit] * 2, [lowest / GPA, highest / GPA], **WINDOW)
    symbol = "$a$" if slips else "$a_0$"
    head = axes.get_xaxis_transform()
    axes.text(edges[1] / unit, 1.01, symbol, transform=head, fontsize=LABEL_SIZE, ha="center", va="bottom", color="0.3")
    axes.set_xlim(depths[0], depths[-1])
    plain_ticks(axes.xaxis)
    plain_ticks(axes.yaxis)
    label_axes(axes, depth_label, modulus_label)


_FIRST = ("k", "E0", "z0")  # of these the first that varies is drawn along the axis


def _variable(name: str) -> tuple[str, str]:
    """The unit of a variable, and its name with its symbol."""
    axis, written = AXES.get(name.replace(".", "_")), entry(name)
    words = written.name if axis is None else axis.words
    return written.unit, f"{words} ${written.symbol}$" if written.symbol else words


def _sized(largest: float, unit: str) -> tuple[float, str]:
    """As `readable`, with a power of ten where two prefixes are too far apart."""
    factor, name = readable(largest, unit)
    if largest >= 1e4 * factor:
        decades = math.floor(math.log10(largest / factor))
        return factor * 10.0**decades, f"$10^{{{decades}}}$ {name}".rstrip()
    return factor, name


def _draw_objective(axes: Axes, design: Design) -> None:
    name = next((name for name in _FIRST if name in design.bounds), next(iter(design.bounds)))
    values = _values_along(design, name)
    course = along(design, name, values)
    curve, kept = np.asarray(course.value), np.asarray(course.keeps_limits)
    unit, words = entry(design.objective).unit, entry(design.objective).label
    if design.load is not None and np.count_nonzero(design.load.weight) > 1:
        words = f"mean {words}"
    # What breaks a limit may be far from all that counts, and is cut off there. On a scale from zero a gain of a
    # hundredth could not be seen.
    counts = np.array([*curve[kept], float(design.reference_value), float(design.value)])
    around = max(0.12 * np.ptp(counts) if kept.sum() > 0.3 * kept.size else 0.6 * np.ptp(counts), 0.01 * counts.max())
    tall, tall_name = _sized(float(counts.max()), unit)
    wide, wide_name = (1.0, "") if is_linear(name) else readable(values[-1], _variable(name)[0])
    axes.plot(values / wide, np.where(kept, curve, np.nan) / tall, color="0.2", linewidth=1.5)
    others = [_variable(other)[1].split()[-1] for other in design.bounds if other != name]
    broken = ~kept
    broken[1:] |= ~kept[:-1]  # up to where the limits are kept
    broken[:-1] |= ~kept[1:]
    if not kept.all():
        axes.plot(values / wide, np.where(broken, curve, np.nan) / tall, label="breaks a limit", zorder=1, **FORBIDDEN)
    marks = (design.variables[name], design.value), (design.reference_variables[name], design.reference_value)
    for (where, what), (_, _, marker, style) in zip(marks, _both(design), strict=True):
        drawn = np.interp(where, values, curve)
        beside = not math.isclose(drawn, what, rel_tol=2e-3)
        label = f"reference: different {' and '.join(others) or 'exponent'}" if marker == "s" and beside else ""
        axes.plot(where / wide, float(what) / tall, marker, color=style["color"], ls="", label=label, zorder=4, **DOT)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize=TICK_SIZE, handlelength=1.8, borderpad=0.2, handletextpad=0.5)
    share = 100.0 * float(design.saving)
    found = f"{_both(design)[0][1].split(',')[0]}: {abs(share):.3g} % {'less' if share >= 0.0 else 'more'}"
    axes.set_title(found, loc="right", y=1.0, fontsize=LABEL_SIZE)
    lowest, highest = counts.min() - around, counts.max() + (1.6 * around if axes.get_legend() else around)
    axes.set_ylim(lowest / tall, highest / tall)
    seen = [*values[(lowest <= curve) & (curve <= highest)], *(where for where, _ in marks)]
    ends = np.array([min(seen), max(seen)]) / wide
    if is_linear(name):
        axes.set_xlim(*(ends + 0.06 * np.ptp(ends) * np.array([-1.0, 1.0])))
    else:
        axes.set_xscale("log")
        axes.set_xlim(*(ends * (ends[1] / ends[0]) ** np.array([-0.06, 0.06])))
        plain_ticks(axes.xaxis)
    label = labelled(_variable(name)[1], wide_name)
    if others:
        label += f"; {' and '.join(others)} fixed at the optimum"
    label_axes(axes, label, labelled(words, tall_name))


def _values_along(design: Design, name: str) -> np.ndarray:
    """Values of a variable for a curve: between its bounds, closer around the best and the reference, and both."""
    first, last = design.bounds[name]
    values = np.linspace(first, last, 121) if is_linear(name) else np.geomspace(first, last, 121)
    near = []
    for place in (float(design.variables[name]), float(design.reference_variables[name])):
        n = int(np.clip(np.searchsorted(values, place), 1, values.size - 2))
        near += [*np.linspace(values[n - 1], values[n + 1], 21), place]
    values = np.unique([*values, *near])
    return values[(first <= values) & (values <= last)]


def _draw_punch(axes: Axes, design: Design, comparison: Comparison) -> None:
    a, depth = (float(np.asarray(getattr(design.reference, name))) for name in ("radius", "depth"))
    along_r, along_label = scaled("r", a)
    tall, tall_label = scaled("depth", depth, "worn off the face, $d - w_\\infty$")
    for r, worn, (*_, style) in zip(comparison.radii, comparison.depth, _both(design), strict=True):
        axes.plot(r / along_r, worn / tall, **style)
    axes.axhline(0.0, **UNWORN)
    axes.axvline(a / along_r, color="0.5", **GUIDE)
    axes.set_xlim(0.0, 1.05 * a / along_r)
    label_axes(axes, along_label, tall_label)


def _with_k(contact: Any) -> str:
    return f", $k = {float(np.asarray(contact.material.k)):.3g}$" if hasattr(contact.material, "k") else ""


def _both(design: Design) -> tuple[tuple[FrettingContact | GrossSlipContact, str, str, dict[str, Any]], ...]:
    found = "best" if design.keeps_limits else "closest design, limits violated"
    return (design.contact, found, "o", BEST), (design.reference, "reference", "s", REFERENCE)


# --- the picture of a trade-off -------------------------------------------------------------------------------------


@for_numbers("draw what the program returns")
def front_picture(front: Front) -> Figure:
    """Draw the front, the best y for each x, beside the reference, and the variables along it.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Designs that are not certified are hollow. Both ends say what ends the front there: a variable at its bound, another
    limit, or that no better one exists.

    Args:
        front: The result of `optimise.front`.

    Returns:
        A figure 7 cm wide and 7 cm more for each variable; `save` writes it.
    """
    count = 1 + len(front.variables)
    width, height, left, right, between = 7.0 * count, 7.0, 1.35, 0.3, 1.7  # cm; see `design_picture`
    figure = page(width, height)
    panel = (width - left - right - (count - 1) * between) / count
    places = {"left": left / width, "right": 1.0 - right / width, "bottom": 1.1 / height, "top": 0.92}
    panels = figure.subplots(1, count, sharex=True, gridspec_kw=places | {"wspace": between / panel})
    x, y = np.asarray(front.x), np.asarray(front.y)
    wide, wide_label = _along(front.x_name, front.x_places, max(x[0], x[-1]))
    tall, tall_label = _along(front.y_name, front.y_places, max(float(np.max(y)), float(front.reference_y)))
    drawn = [(y / tall, tall_label)]
    for name, values in front.variables.items():
        high, high_name = (1.0, "") if is_linear(name) else readable(float(np.max(values)), _variable(name)[0])
        drawn.append((np.asarray(values) / high, labelled(_variable(name)[1], high_name)))
    certain = np.asarray(front.certified)
    for axes, (values, label) in zip(panels, drawn, strict=True):
        axes.plot(x / wide, values, label=f"{front.best[1]} for this {entry(front.x_name).name}", **BEST)
        for some, inside in ((certain, BEST["color"]), (~certain, "w")):
            dots = {"color": BEST["color"], "markerfacecolor": inside, "markersize": 3.5, "linestyle": ""}
            axes.plot(x[some] / wide, values[some], "o", **dots)
        if np.ptp(values) < 1e-6 * np.max(np.abs(values)):  # else the axis would show rounding errors
            axes.set_ylim(*np.sort(values[0] * np.array([0.5, 1.5])))
        axes.set_ylabel(label, fontsize=LABEL_SIZE)
    finished(dict(zip("abcdefghijkl", panels, strict=False)))
    # the higher end has room above, the lower one below
    for end, said in zip((0, -1), front.ends, strict=True):
        above = (y[0] >= y[-1]) == (end == 0)
        panels[0].annotate(
            said.replace(", ", "\n"),
            (x[end] / wide, y[end] / tall),
            xytext=(0.0, 8.0 if above else -8.0),
            textcoords="offset points",
            ha="left" if (x[0] <= x[-1]) == (end == 0) else "right",
            va="bottom" if above else "top",
            fontsize=TICK_SIZE,
            color="0.3",
        )
    beside = float(front.reference_x) / wide, float(front.reference_y) / tall
    panels[0].plot(*beside, "s", color=REFERENCE["color"], label="reference", **DOT)
    panels[0].legend(frameon=False, fontsize=LABEL_SIZE)
    panels[0].set_ylim(0.0, 1.3 * panels[0].dataLim.y1)  # room for the legend
    figure.supxlabel(wide_label, y=0.03, fontsize=LABEL_SIZE)
    return figure


def _along(name: str, places: Mapping[str, Any], size: float) -> tuple[float, str]:
    """The unit of a quantity at its place along an axis, and the label of the axis."""
    factor, unit = _sized(size, entry(name).unit)
    return factor, labelled(placed(name, places) if places else entry(name).label, unit)


# --- files ----------------------------------------------------------------------------------------------------------


def check_target(path: str | os.PathLike[str]) -> None:
    """Check that a picture could be written to a file, without leaving one.

    Raises:
        PictureError: The suffix is not that of a picture, or the place cannot be written to.
    """
    _files.check_target(path, _files.PICTURES)


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a file, which afterwards is either complete or as it was before.

    The same figure gives the same bytes: no date is written.

    Args:
        figure: The figure.
        path: The file; its suffix gives the format: .png, .pdf or .svg.

    Raises:
        PictureError: The suffix is none of these, or the place cannot be written to.
    """
    check_target(path)
    kind = Path(path).suffix[1:].lower()
    dated = {"png": "Software", "pdf": "CreationDate", "svg": "Date"}[kind]
    _files.write(path, lambda target: figure.savefig(target, format=kind, metadata={dated: None}))
