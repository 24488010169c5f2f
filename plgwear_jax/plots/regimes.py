"""The picture of partial and gross slip over displacement amplitude and normal force."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.units import readable
from plgwear_jax.catalogue import entry
from plgwear_jax.contact import CRITERIA, SlipRegimes
from plgwear_jax.plots.style import (
    BEST,
    DOT,
    GUIDE,
    REFERENCE,
    TICK_SIZE,
    finished,
    label_axes,
    labelled,
    legend_above,
    mark,
    page,
    plain_ticks,
    scaled,
)

_PLACES = {"left": 0.075, "right": 0.985, "bottom": 0.135, "top": 0.86, "wspace": 0.24}
_ONSET: dict[str, Any] = {"color": "k", "linewidth": 1.6}
_LEVELS = (0.01, 0.02, 0.05, 0.1, 0.4, 0.6, 0.8, 0.9, 0.95)
_CONTOURS: dict[str, Any] = {"colors": "0.45", "linewidths": 0.6}
_PARTIAL = "#E6F4FB"
_WORDS: dict[str, Any] = {"fontsize": 9, "fontstyle": "italic", "color": "0.25"}
_APART = 0.25  # least difference of the logarithms of displacements between the onset and a contour
_OWN: dict[str, Any] = {"color": "#009E73", "marker": "D", "linestyle": ""}


@for_numbers("draw what the program returns")
def regimes_picture(
    found: SlipRegimes, cut: SlipRegimes, own: np.ndarray | None = None, rig_stiffness: float | None = None
) -> Figure:
    """Draw where the slip is partial and where gross, with contours of the energy ratio, and a cut at a normal force.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `contact.slip_regimes`, at two normal forces or more.
        cut: The same at one normal force alone, from small amplitudes to gross slip.
        own: Displacement amplitudes in m to mark at the normal force of the cut, if any.
        rig_stiffness: The stiffness with which both were computed, if any.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    figure = page(18.0, 8.2)
    left, right = figure.subplots(1, 2, gridspec_kw=_PLACES | {"width_ratios": (1.15, 1.0)})
    own = np.zeros(0) if own is None else np.asarray(own)
    words = entry("displacement_amplitude").name + (" of the rig" if rig_stiffness is not None else " $u_x$")
    _draw_map(left, found, cut, own, words)
    _draw_cut(right, cut, own, words)
    finished({"a": left, "b": right})
    criterion = f"energy ratio {CRITERIA['energy_ratio']:g} (criterion of laboratories)"
    entries = [
        Line2D([], [], label="onset of gross slip", **_ONSET),
        Line2D([], [], label=criterion, **REFERENCE),
        Line2D([], [], label="energy ratio", color="0.45", linewidth=0.6),
    ]
    if own.size:
        entries.append(Line2D([], [], label="load of the input file", **_OWN | DOT))
    legend_above(figure, entries, 4, TICK_SIZE, handlelength=2.6, columnspacing=1.4)
    return figure


def _draw_map(axes: Axes, found: SlipRegimes, cut: SlipRegimes, own: np.ndarray, words: str) -> None:
    moves, forces, onset = found.displacement_amplitude, found.normal_force, found.gross_slip_displacement
    wide, wide_name = readable(float(moves[-1]), entry("displacement_amplitude").unit)
    tall, tall_label = scaled("normal_force", float(forces[-1]), entry("normal_force").label)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(moves[0] / wide, moves[-1] / wide)
    axes.set_ylim(forces[0] / tall, forces[-1] / tall)
    plain_ticks(axes.xaxis)
    plain_ticks(axes.yaxis)
    x, y = moves / wide, forces / tall
    axes.fill_betweenx(y, x[0], np.clip(onset / wide, x[0], x[-1]), color=_PARTIAL, linewidth=0.0, zorder=-1)
    criterion = CRITERIA["energy_ratio"]
    _draw_contours(axes, x, y, found, [level for level in _LEVELS if _is_apart(cut, level)])
    axes.plot(found.displacement_where("energy_ratio", criterion) / wide, y, **REFERENCE)
    axes.plot(onset / wide, y, **_ONSET)
    later = cut.displacement_where("energy_ratio", criterion) > cut.gross_slip_displacement
    _label_onset(axes, onset / wide, y, float(cut.gross_slip_energy_ratio[0]), left=bool(later[0]))
    _name_regions(axes, x, y, found)
    axes.plot(own / wide, np.full(own.size, cut.normal_force[0] / tall), zorder=5, **_OWN | DOT)
    axes.axhline(cut.normal_force[0] / tall, color="0.5", **GUIDE)
    axes.tick_params(which="both", pad=4.0)
    label_axes(axes, labelled(words, wide_name), tall_label)


def _is_apart(cut: SlipRegimes, level: float) -> bool:
    """Whether the contour of an energy ratio leaves room for the onset and its label."""
    shift = np.log(cut.displacement_where("energy_ratio", level) / cut.gross_slip_displacement)
    return not abs(float(shift[0])) < _APART  # NaN: far below


def _draw_contours(axes: Axes, x: np.ndarray, y: np.ndarray, found: SlipRegimes, levels: list[float]) -> None:
    """Contours of the energy ratio, each with its value where it crosses a falling diagonal of the panel."""
    drawn = axes.contour(x, y, found.energy_ratio, levels=levels, **_CONTOURS)
    along = np.linspace(0.04, 0.96, 400)
    columns = np.floor(along * (x.size - 1)).astype(int)
    rows = np.floor((0.9 - 0.72 * along) * (y.size - 1)).astype(int)
    values = found.energy_ratio[rows, columns]
    places = [int(np.argmin(abs(values - level))) for level in levels]
    near = [n for n, level in zip(places, levels, strict=True) if abs(values[n] - level) < 0.15 * level]
    if near:
        manual = [(float(x[columns[n]]), float(y[rows[n]])) for n in near]
        axes.clabel(drawn, manual=manual, fontsize=6.5, fmt="%g", inline_spacing=2)


def _label_onset(axes: Axes, onset: np.ndarray, y: np.ndarray, ratio: float, left: bool) -> None:
    """Write along the onset the energy ratio there, on one side of it, where there is room."""
    first, last = axes.get_xlim()
    seen = np.flatnonzero((onset > first) & (onset < last))
    if seen.size < 4:
        return
    at = int(seen[int(0.75 * seen.size)])
    ends = axes.transData.transform(np.column_stack([onset, y])[[at - 1, at + 1]])
    turn = float(np.degrees(np.arctan2(*(ends[1] - ends[0])[::-1])))
    axes.text(
        float(onset[at]) * (0.985 if left else 1.06),
        float(y[at]),
        f"onset, energy ratio {ratio:.3g}",
        rotation=turn,
        rotation_mode="anchor",
        ha="center",
        va="bottom" if left else "top",
        fontsize=7,
    )


def _name_regions(axes: Axes, x: np.ndarray, y: np.ndarray, found: SlipRegimes) -> None:
    """Write the names of the two regions, if they are seen."""
    if not found.gross_slip[-1, 0]:
        axes.text(0.03, 0.965, "partial slip", transform=axes.transAxes, va="top", bbox=_on(_PARTIAL), **_WORDS)
    if found.gross_slip[0, -1]:
        axes.text(0.97, 0.035, "gross slip", transform=axes.transAxes, ha="right", bbox=_on("w"), **_WORDS)


def _on(colour: str) -> dict[str, Any]:
    """What a text covers the contours below it with."""
    return {"facecolor": colour, "edgecolor": "none", "pad": 1.0}


def _draw_cut(axes: Axes, cut: SlipRegimes, own: np.ndarray, words: str) -> None:
    moves, onset = cut.displacement_amplitude, float(cut.gross_slip_displacement[0])
    wide, wide_name = readable(float(moves[-1]), entry("displacement_amplitude").unit)
    factor, unit = readable(float(cut.normal_force[0]), entry("normal_force").unit)
    styles = {"energy_ratio": BEST, "loop_aperture": {**REFERENCE, "color": "#CC79A7"}}
    for name, level in CRITERIA.items():
        values, style = getattr(cut, name)[0], styles[name]
        axes.plot(moves / wide, values, label=entry(name).name, **style)
        axes.axhline(level, color=style["color"], **GUIDE)
        place = float(cut.displacement_where(name, level)[0]) / wide
        axes.plot(place, level, "o", color=style["color"], zorder=4, **DOT)
        axes.text(0.015, level, f"{level:g}", transform=axes.get_yaxis_transform(), va="bottom", ha="left",
                  fontsize=TICK_SIZE, color=style["color"])  # fmt: skip
    axes.axvline(onset / wide, **_ONSET | {"linewidth": 1.0})
    mark(axes, onset / wide, "onset")
    within = own[own <= moves[-1]]
    axes.plot(within / wide, np.interp(within, moves, cut.energy_ratio[0]), zorder=5, **_OWN | DOT)
    axes.set_xlim(0.0, moves[-1] / wide)
    axes.set_ylim(0.0, 1.05 * float(max(cut.energy_ratio.max(), cut.loop_aperture.max())))
    title = f"at {cut.normal_force[0] / factor:.4g} {unit}"
    axes.legend(frameon=False, fontsize=TICK_SIZE, loc="lower right", title=title, title_fontsize=TICK_SIZE)
    label_axes(axes, labelled(words, wide_name), "energy ratio, loop aperture")
