"""Pictures of the wear over cycles: under one amplitude, over blocks of amplitudes, and fitted to measured volumes."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.units import written
from plgwear_jax.catalogue import entry
from plgwear_jax.contact import WearByBlocks, WearOverCycles
from plgwear_jax.fitting import Fit
from plgwear_jax.plots.style import (
    BEST,
    COLOURS,
    DOT,
    FORBIDDEN,
    LABEL_SIZE,
    REFERENCE,
    TICK_SIZE,
    UNWORN,
    finished,
    label_axes,
    legend_above,
    mark,
    page,
    scaled,
)

_PLACES = {"left": 0.075, "right": 0.985, "bottom": 0.14, "top": 0.855, "wspace": 0.32, "hspace": 0.1}
# From light to dark, for grey prints too.
_SHADES: tuple[dict[str, Any], ...] = (
    {"color": "#56B4E9", "linestyle": (0, (1, 1)), "linewidth": 1.4},
    {"color": COLOURS[0], "linestyle": (0, (4, 1.5)), "linewidth": 1.4},
    {"color": "#08306b", "linestyle": "-", "linewidth": 1.2},
)
_END: dict[str, Any] = {"color": COLOURS[1], "linestyle": "-", "linewidth": 1.4}


@for_numbers("draw what the program returns")
def wear_picture(course: WearOverCycles, cycles: Sequence[float], life: float | None = None) -> Figure:
    """Draw the worn volume over the cycles with its two asymptotes, and the worn ring at a few numbers of cycles.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        course: The result of `contact.wear_over_cycles`.
        cycles: Up to three increasing numbers of cycles; the nearest ones of the course are drawn.
        life: Another number of cycles to mark, if any.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    figure = page(18.0, 7.6)
    layout = [["a", "b", "c"], ["a", "depth", "c"]]
    panels = figure.subplot_mosaic(layout, gridspec_kw=_PLACES)  # pyright: ignore[reportCallIssue, reportArgumentType]
    panels["b"].sharex(panels["depth"])
    at = [int(np.argmin(np.abs(course.cycles - number))) for number in cycles]
    _draw_volume(panels["a"], course, at, life)
    _draw_shape(panels["b"], panels["depth"], course, at)
    _draw_pressure(panels["c"], course, at)
    figure.align_ylabels([panels["b"], panels["depth"]])
    finished(panels)
    panels["b"].set_title(_result(course), loc="right", fontsize=LABEL_SIZE)
    entries = [Line2D([], [], label="before wear", **UNWORN)]
    for i, style in zip(at, _SHADES, strict=False):
        share = "" if course.steady_volume is None else f" ({100.0 * course.volume[i] / course.steady_volume:.0f} %)"
        entries.append(Line2D([], [], label=f"{plain_number(course.cycles[i])} cycles{share}", **style))
    if course.steady_volume is not None:
        entries.append(Line2D([], [], label="steady state", **_END))
    legend_above(figure, entries, 5, TICK_SIZE, handlelength=2.4, columnspacing=1.0, handletextpad=0.5)
    return figure


def _result(course: WearOverCycles) -> str:
    """The depth in the end, in words."""
    steady = course.steady_depth is not None
    deepest = float((course.steady_depth if course.steady_depth is not None else course.depth[-1]).max())
    return f"{'steady state' if steady else 'in the end'}: {written(deepest, entry('wear_depth').unit)} deep"


def plain_number(number: float) -> str:
    """A number of cycles in mathematical notation."""
    mantissa, _, exponent = f"{number:.1e}".partition("e")
    return rf"${mantissa}\times 10^{{{int(exponent)}}}$" if not 1.0 <= number < 1e3 else f"{number:.0f}"


def _draw_volume(axes: Axes, course: WearOverCycles, at: list[int], life: float | None) -> None:
    largest = float(course.volume.max()) if course.steady_volume is None else course.steady_volume
    unit, label = scaled("volume", largest)
    first = course.volume[0] / course.cycles[0] if course.cycles[0] > 0.0 else course.volume_per_cycle[0]
    axes.loglog(course.cycles, first * course.cycles / unit, label="wear of the first cycles", **FORBIDDEN)
    if course.steady_volume is not None:
        axes.axhline(course.steady_volume / unit, **_END)
    axes.loglog(course.cycles, course.volume / unit, color="k", linewidth=1.3, label=entry("volume").name)
    for i, style in zip(at, _SHADES, strict=False):
        axes.plot(course.cycles[i], course.volume[i] / unit, "o", color=style["color"], zorder=4, **DOT)
    if life is not None:
        mark(axes, life, "life")
    beyond = 1.5 if course.steady_volume is None else 1.0
    axes.set_xlim(course.cycles[0], beyond * course.cycles[-1])
    axes.set_ylim(course.volume[0] / unit, 3.0 * largest / unit)
    axes.legend(
        frameon=False, fontsize=TICK_SIZE, loc="lower right", handlelength=1.2, handletextpad=0.4, borderpad=0.2
    )
    label_axes(axes, entry("cycles").label, label)


def _ring(course: WearOverCycles) -> tuple[float, float]:
    """The range of radii that shows the worn ring."""
    margin = 0.15 * (course.worn_radius - course.stick_radius)
    return max(course.stick_radius - margin, 0.0), course.worn_radius + margin


def _draw_shape(above: Axes, below: Axes, course: WearOverCycles, at: list[int]) -> None:
    first, last = _ring(course)
    shown = (course.radii >= first) & (course.radii <= last)
    unit, radius_label = scaled("r", course.worn_radius)
    deepest = float(max(x.max() for x, _ in _states(course.depth, course.steady_depth, at)))
    depth, depth_label = scaled("wear_depth", deepest, entry("wear_depth").name)
    height, height_label = scaled("profile", float(course.unworn[shown].max()), f"{entry('profile').name} $f$")
    r = course.radii / unit
    above.plot(r, course.unworn / height, **UNWORN)
    below.axhline(0.0, **UNWORN)
    for worn, style in _states(course.depth, course.steady_depth, at):
        above.plot(r, (course.unworn + worn) / height, **style)
        below.plot(r, worn / depth, **style)
    # Limits of the axis by the unworn shape at both ends of the shown range.
    lowest, highest = course.unworn[shown][[0, -1]] / height
    above.set_ylim(lowest - 0.05 * (highest - lowest), highest + 0.1 * (highest - lowest))
    above.set_xlim(first / unit, last / unit)
    above.tick_params(labelbottom=False)
    above.set_ylabel(height_label, fontsize=LABEL_SIZE)
    below.set_ylim(bottom=0.0)
    label_axes(below, radius_label, depth_label)


def _draw_pressure(axes: Axes, course: WearOverCycles, at: list[int]) -> None:
    first, last = _ring(course)
    first = max(first - 1.5 * (course.worn_radius - course.stick_radius), 0.0)  # the stick zone takes the ring's load
    unit, radius_label = scaled("r", course.worn_radius)
    highest = (2.5 if course.stick_radius > 0.0 else 1.1) * float(course.initial_pressure[course.radii >= first].max())
    high, high_label = scaled("steady_pressure", highest, "pressure")
    axes.plot(course.radii / unit, course.initial_pressure / high, **UNWORN)
    for pressure, style in _states(course.pressure, course.steady_pressure, at):
        axes.plot(course.radii / unit, np.minimum(pressure, 2.0 * highest) / high, **style)
    if course.stick_radius > 0.0:
        mark(axes, course.stick_radius / unit, "stick edge")  # where the pressure is infinite in the end
    axes.set_xlim(first / unit, last / unit)
    axes.set_ylim(0.0, highest / high)
    label_axes(axes, radius_label, high_label)


def _states(fields: np.ndarray, end: np.ndarray | None, at: list[int]) -> list[tuple[np.ndarray, dict[str, Any]]]:
    """The fields at a few numbers of cycles and in the steady state, if there is one, each with its line style."""
    some = [(fields[i], style) for i, style in zip(at, _SHADES, strict=False)]
    return some if end is None else [*some, (end, _END)]


@for_numbers("draw what the program returns")
def blocks_picture(found: WearByBlocks) -> Figure:
    """Draw the worn volume over the cycles, and the force amplitude and the two radii at the end of each block.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `contact.wear_by_blocks`.

    Returns:
        A figure 16 cm wide; `save` writes it.
    """
    figure = page(16.0, 6.5)
    places = {"left": 0.085, "right": 0.985, "bottom": 0.155, "top": 0.92, "wspace": 0.36}
    panels = figure.subplots(1, 3, gridspec_kw=places)
    cycles = np.append(0.0, found.cycles)
    worn, forces, radii = panels
    unit, label = scaled("volume", float(found.volume[-1]))
    worn.plot(cycles, np.append(0.0, found.volume) / unit, marker="o", markersize=3.0, **BEST)
    worn.set_ylabel(label, fontsize=LABEL_SIZE)
    unit, label = scaled("tangential_force", float(found.tangential_force.max()), entry("tangential_force").name)
    forces.stairs(found.tangential_force / unit, cycles, baseline=None, **BEST)
    forces.set_ylabel(label, fontsize=LABEL_SIZE)
    unit, label = scaled("r", float(found.contact_radius.max()), entry("r").name)
    radii.stairs(found.contact_radius / unit, cycles, baseline=None, label="contact", **BEST)
    radii.stairs(found.stick_radius / unit, cycles, baseline=None, label="stick", **REFERENCE)
    radii.set_ylabel(label, fontsize=LABEL_SIZE)
    radii.legend(frameon=False, fontsize=TICK_SIZE)
    for axes in panels:
        axes.set_xlabel(entry("cycles").label, fontsize=LABEL_SIZE)
        axes.ticklabel_format(axis="x", scilimits=(0, 4), useMathText=True)
        axes.xaxis.get_offset_text().set_fontsize(TICK_SIZE)
        axes.set_ylim(bottom=0.0)
        if cycles[-1] > 0.0:
            axes.set_xlim(0.0, 1.02 * cycles[-1])
    finished(dict(zip("abc", panels, strict=True)))
    return figure


@for_numbers("draw what the program returns")
def fit_picture(fit: Fit) -> Figure:
    """Draw measured volumes and the fitted volume over the cycles, and the differences between both.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        fit: The result of `fitting.fit_wear_coefficient`.

    Returns:
        A figure 14 cm wide; `save` writes it.
    """
    figure = page(14.0, 7.0)
    places = {"left": 0.1, "right": 0.985, "bottom": 0.15, "top": 0.85, "wspace": 0.3}
    left, right = figure.subplots(1, 2, gridspec_kw=places)
    highest = max(float(fit.volume.max()), float(fit.fitted.max()))
    unit, label = scaled("volume", highest)
    difference = scaled("volume", highest, "measured less fitted")[1]
    if highest >= 1e4 * unit:  # between units that are powers of a thousand cubed
        power = math.floor(math.log10(highest / unit))
        unit *= 10.0**power
        label, difference = (text.replace("(", rf"($10^{{{power}}}$ ") for text in (label, difference))
    dots: dict[str, Any] = {"fmt": "o", "color": "k", "markersize": 3.5, "elinewidth": 0.8, "capsize": 2.0}
    bars = np.where(np.isfinite(fit.deviation), fit.deviation, 0.0)
    best, low, high = fit.curve / unit
    if np.all(np.isfinite(low)):
        left.fill_between(fit.curve_cycles, low, high, color=BEST["color"], alpha=0.2, linewidth=0.0, label="95 %")
    left.plot(fit.curve_cycles, best, label="fit", **BEST)
    steady = highest / unit if fit.steady_volume is None else fit.steady_volume / unit
    if fit.steady_volume is not None:
        left.axhline(steady, label="steady state", **_END)
    left.errorbar(fit.cycles, fit.volume / unit, bars / unit, label="measured", **dots)
    right.axhline(0.0, **BEST)
    right.errorbar(fit.cycles, (fit.volume - fit.fitted) / unit, bars / unit, **dots)
    worn = fit.cycles > 0.0
    for axes in (left, right):
        if fit.cycles.max() > 30.0 * fit.cycles[worn].min():
            axes.set_xscale("log")
            axes.set_xlim(fit.curve_cycles[[0, -1]])
        else:
            axes.set_xlim(0.0, 1.1 * fit.cycles.max())
    left.set_ylim(0.0, 1.12 * max(highest / unit, min(steady, 1.5 * highest / unit)))
    label_axes(left, entry("cycles").label, label)
    label_axes(right, entry("cycles").label, difference)
    finished({"a": left, "b": right})
    legend_above(figure, left.get_legend_handles_labels()[0], 4)
    return figure
