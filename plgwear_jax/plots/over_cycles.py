"""Pictures of the wear over cycles: under one amplitude, over blocks of amplitudes, and fitted to measured volumes."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.units import written
from plgwear_jax.catalogue import entry
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
from plgwear_jax.shapes.of_contact import unworn_of
from plgwear_jax.wear.run import Final, Run

_PLACES = {"left": 0.075, "right": 0.985, "bottom": 0.14, "top": 0.855, "wspace": 0.32, "hspace": 0.1}
# From light to dark, for grey prints too.
_SHADES: tuple[dict[str, Any], ...] = (
    {"color": "#56B4E9", "linestyle": (0, (1, 1)), "linewidth": 1.4},
    {"color": COLOURS[0], "linestyle": (0, (4, 1.5)), "linewidth": 1.4},
    {"color": "#08306b", "linestyle": "-", "linewidth": 1.2},
)
_END: dict[str, Any] = {"color": COLOURS[1], "linestyle": "-", "linewidth": 1.4}


_INSIDE, _IN_RING, _OUTSIDE = 61, 121, 9  # numbers of radii inside the worn ring, in it, and outside


class _Shapes(NamedTuple):
    """Worn depths and pressures at radii in m, of a few states: after some cycles, and in the end if there is one."""

    radii: np.ndarray
    unworn: np.ndarray
    initial_pressure: np.ndarray
    depths: list[np.ndarray]
    pressures: list[np.ndarray]
    inner: float  # edges of the worn ring
    outer: float


def _shapes_of(run: Run, cycles: np.ndarray, final: Final | None) -> _Shapes:
    inner, outer = float(np.min(run.stick_radius(cycles))), float(np.max(run.contact_radius(cycles)))
    if final is not None:
        inner, outer = (float(final.stick_radius) if run.load.holds_force else inner), float(final.worn_radius)
    # Radii crowd at the stick edge, where all quantities may have infinite slopes.
    inside = inner * (1.0 - np.linspace(1.0, 0.0, _INSIDE, endpoint=False) ** 4)
    ring = inner + (outer - inner) * np.linspace(0.0, 1.0, _IN_RING) ** 2
    r = np.concatenate([inside, ring, outer * np.linspace(1.0, 1.15, _OUTSIDE)[1:]])
    states = cycles if final is None or run.load.holds_force else np.append(cycles, np.asarray(run.lasting_cycles))
    depths, pressures = (list(np.asarray(field(r, states[:, None]))) for field in (run.depth, run.pressure))
    if final is not None and run.load.holds_force and run.steady is not None:
        depths.append(np.asarray(run.steady.wear_depth(r)))
        pressures.append(np.asarray(run.steady.pressure(r)))
    before = run.contact.steady(0.0).initial_pressure(r)
    return _Shapes(r, np.asarray(unworn_of(run.contact)(r)), np.asarray(before), depths, pressures, inner, outer)


@for_numbers("draw runs of numbers")
def wear_picture(run: Run, cycles: ArrayLike, shown: Sequence[float] = (), life: float | None = None) -> Figure:
    """Draw the worn volume over the cycles with its two asymptotes, and the worn ring at a few numbers of cycles.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        run: The result of `FrettingContact.over_cycles`, of one contact.
        cycles: Increasing numbers of cycles between which the volume is drawn, shape (n,).
        shown: Up to three increasing numbers of cycles at which the ring is drawn.
        life: Another number of cycles to mark, if any.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    figure = page(18.0, 7.6)
    layout = [["a", "b", "c"], ["a", "depth", "c"]]
    panels = figure.subplot_mosaic(layout, gridspec_kw=_PLACES)  # pyright: ignore[reportCallIssue, reportArgumentType]
    panels["b"].sharex(panels["depth"])
    at, final = np.asarray(shown, float), run.final
    shapes = _shapes_of(run, at, final)
    styles = [*_SHADES[: at.size], *([] if final is None else [_END])]
    worn = np.asarray(run.volume(at))
    _draw_volume(panels["a"], run, np.asarray(cycles, float), (at, worn), life)
    _draw_shape(panels["b"], panels["depth"], shapes, styles)
    _draw_pressure(panels["c"], shapes, styles)
    figure.align_ylabels([panels["b"], panels["depth"]])
    finished(panels)
    deepest = float(max(depth.max() for depth in shapes.depths))
    ends = "in the end" if final is None else "steady state"
    title = f"{ends}: {written(deepest, entry('wear_depth').unit)} deep"
    panels["b"].set_title(title, loc="right", fontsize=LABEL_SIZE)
    entries = [Line2D([], [], label="before wear", **UNWORN)]
    for number, volume, style in zip(at, worn, _SHADES, strict=False):
        share = "" if final is None else f" ({100.0 * volume / float(final.volume):.0f} %)"
        entries.append(Line2D([], [], label=f"{plain_number(number)} cycles{share}", **style))
    if final is not None:
        entries.append(Line2D([], [], label="steady state", **_END))
    legend_above(figure, entries, 5, TICK_SIZE, handlelength=2.4, columnspacing=1.0, handletextpad=0.5)
    return figure


def plain_number(number: float) -> str:
    """A number of cycles in mathematical notation."""
    mantissa, _, exponent = f"{number:.1e}".partition("e")
    return rf"${mantissa}\times 10^{{{int(exponent)}}}$" if not 1.0 <= number < 1e3 else f"{number:.0f}"


def _draw_volume(
    axes: Axes, run: Run, cycles: np.ndarray, shown: tuple[np.ndarray, np.ndarray], life: float | None
) -> None:
    volume, final = np.asarray(run.volume(cycles)), run.final
    largest = float(volume.max() if final is None else final.volume)
    unit, label = scaled("volume", largest)
    first = volume[0] / cycles[0] if cycles[0] > 0.0 else float(run.rate(0.0))
    axes.loglog(cycles, first * cycles / unit, label="wear of the first cycles", **FORBIDDEN)
    if final is not None:
        axes.axhline(largest / unit, **_END)
    axes.loglog(cycles, volume / unit, color="k", linewidth=1.3, label=entry("volume").name)
    for number, worn, style in zip(*shown, _SHADES, strict=False):
        axes.plot(number, worn / unit, "o", color=style["color"], zorder=4, **DOT)
    if life is not None:
        mark(axes, life, "life")
    axes.set_xlim(cycles[0], (1.5 if final is None else 1.0) * cycles[-1])
    axes.set_ylim(volume[0] / unit, 3.0 * largest / unit)
    axes.legend(
        frameon=False, fontsize=TICK_SIZE, loc="lower right", handlelength=1.2, handletextpad=0.4, borderpad=0.2
    )
    label_axes(axes, entry("cycles").label, label)


def _draw_shape(above: Axes, below: Axes, shapes: _Shapes, styles: list[dict[str, Any]]) -> None:
    margin = 0.15 * (shapes.outer - shapes.inner)
    first, last = max(shapes.inner - margin, 0.0), shapes.outer + margin
    shown = (shapes.radii >= first) & (shapes.radii <= last)
    unit, radius_label = scaled("r", shapes.outer)
    deepest = float(max(worn.max() for worn in shapes.depths))
    depth, depth_label = scaled("wear_depth", deepest, entry("wear_depth").name)
    height, height_label = scaled("profile", float(shapes.unworn[shown].max()), f"{entry('profile').name} $f$")
    r = shapes.radii / unit
    above.plot(r, shapes.unworn / height, **UNWORN)
    below.axhline(0.0, **UNWORN)
    for worn, style in zip(shapes.depths, styles, strict=True):
        above.plot(r, (shapes.unworn + worn) / height, **style)
        below.plot(r, worn / depth, **style)
    # Limits of the axis by the unworn shape at both ends of the shown range.
    lowest, highest = shapes.unworn[shown][[0, -1]] / height
    above.set_ylim(lowest - 0.05 * (highest - lowest), highest + 0.1 * (highest - lowest))
    above.set_xlim(first / unit, last / unit)
    above.tick_params(labelbottom=False)
    above.set_ylabel(height_label, fontsize=LABEL_SIZE)
    below.set_ylim(bottom=0.0)
    label_axes(below, radius_label, depth_label)


def _draw_pressure(axes: Axes, shapes: _Shapes, styles: list[dict[str, Any]]) -> None:
    width = shapes.outer - shapes.inner
    first, last = max(shapes.inner - 1.65 * width, 0.0), shapes.outer + 0.15 * width  # the stick zone takes the load
    unit, radius_label = scaled("r", shapes.outer)
    highest = (2.5 if shapes.inner > 0.0 else 1.1) * float(shapes.initial_pressure[shapes.radii >= first].max())
    high, high_label = scaled("pressure", highest, "pressure")
    axes.plot(shapes.radii / unit, shapes.initial_pressure / high, **UNWORN)
    for pressure, style in zip(shapes.pressures, styles, strict=True):
        axes.plot(shapes.radii / unit, np.minimum(pressure, 2.0 * highest) / high, **style)
    if shapes.inner > 0.0:
        mark(axes, shapes.inner / unit, "stick edge")  # where the pressure is infinite in the end
    axes.set_xlim(first / unit, last / unit)
    axes.set_ylim(0.0, highest / high)
    label_axes(axes, radius_label, high_label)


@for_numbers("draw runs of numbers")
def blocks_picture(run: Run) -> Figure:
    """Draw the worn volume over the cycles, and the force amplitude and the two radii at the end of each block.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        run: The result of `FrettingContact.over_cycles` under a list of `Block`, of one contact.

    Returns:
        A figure 16 cm wide; `save` writes it.
    """
    figure = page(16.0, 6.5)
    places = {"left": 0.085, "right": 0.985, "bottom": 0.155, "top": 0.92, "wspace": 0.36}
    panels = figure.subplots(1, 3, gridspec_kw=places)
    ends = np.cumsum([float(stage.cycles) for stage in run.load.stages()])
    volume, force, contact, stick = (
        np.asarray(read(ends)) for read in (run.volume, run.force_amplitude, run.contact_radius, run.stick_radius)
    )
    cycles = np.append(0.0, ends)
    worn, forces, radii = panels
    unit, label = scaled("volume", float(volume[-1]))
    worn.plot(cycles, np.append(0.0, volume) / unit, marker="o", markersize=3.0, **BEST)
    worn.set_ylabel(label, fontsize=LABEL_SIZE)
    unit, label = scaled("tangential_force", float(force.max()), entry("tangential_force").name)
    forces.stairs(force / unit, cycles, baseline=None, **BEST)
    forces.set_ylabel(label, fontsize=LABEL_SIZE)
    unit, label = scaled("r", float(contact.max()), entry("r").name)
    radii.stairs(contact / unit, cycles, baseline=None, label="contact", **BEST)
    radii.stairs(stick / unit, cycles, baseline=None, label="stick", **REFERENCE)
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
