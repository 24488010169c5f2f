"""The picture of partial and gross slip over displacement amplitude and normal force."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from plgwear_jax._core.units import readable, written
from plgwear_jax.catalogue import entry
from plgwear_jax.contact import CRITERIA, SlipRegimes
from plgwear_jax.plots.style import (
    BEST,
    DOT,
    GREEN,
    GUIDE,
    PURPLE,
    REFERENCE,
    labelled,
    legend_above,
    letters,
    mark,
    page,
    picture,
    plain_ticks,
    scaled,
)

_LEVELS = (0.01, 0.02, 0.05, 0.1, 0.4, 0.6, 0.8, 0.9, 0.95)
_OWN: dict[str, Any] = DOT | {"color": GREEN, "marker": "D", "linestyle": "", "zorder": 5}


@picture
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
    left, right = panels = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    own = np.asarray([] if own is None else own)
    move = entry("displacement_amplitude")
    words = move.name + (" of the rig" if rig_stiffness is not None else " $u_x$")
    wide, prefixed = readable(float(found.displacement_amplitude[-1]), move.unit)
    tall, force_label = scaled("normal_force", found.normal_force[-1])
    x, y = found.displacement_amplitude / wide, found.normal_force / tall
    onset, force, criterion = found.gross_slip_displacement / wide, float(cut.normal_force[0]), CRITERIA["energy_ratio"]
    left.fill_betweenx(y, x[0], np.clip(onset, x[0], x[-1]), color="#E6F4FB", linewidth=0.0, zorder=-1)
    left.set(xscale="log", yscale="log", xlim=x[[0, -1]], ylim=y[[0, -1]])
    for axis in (left.xaxis, left.yaxis):
        plain_ticks(axis)
    lines = left.contour(x, y, found.energy_ratio, levels=_LEVELS, colors="0.45", linewidths=0.6)
    left.clabel(lines, fontsize=6.5)
    ratio = f"onset of gross slip, energy ratio {float(cut.gross_slip_energy_ratio[0]):.3g}"
    left.plot(onset, y, color="k", label=ratio)
    place = found.displacement_where("energy_ratio", criterion) / wide
    left.plot(place, y, label=f"energy ratio {criterion:g} (criterion of laboratories)", **REFERENCE)
    left.plot([], color="0.45", linewidth=0.6, label="energy ratio")
    if own.size:
        left.plot(own / wide, np.full(own.size, force / tall), label="load of the input file", **_OWN)
    left.axhline(force / tall, **GUIDE)
    for seen, name, place, side in (
        (~found.gross_slip[-1, 0], "partial slip", (0.03, 0.93), "left"),
        (found.gross_slip[0, -1], "gross slip", (0.97, 0.04), "right"),
    ):
        if seen:
            left.text(*place, name, transform=left.transAxes, ha=side, fontstyle="italic", color="0.25",
                      bbox={"facecolor": "w", "edgecolor": "none", "pad": 1.0})  # fmt: skip
    left.set(xlabel=labelled(words, prefixed), ylabel=force_label)

    moves, start = cut.displacement_amplitude, float(cut.gross_slip_displacement[0])
    wide, prefixed = readable(float(moves[-1]), move.unit)
    for (name, level), style in zip(CRITERIA.items(), (BEST, REFERENCE | {"color": PURPLE}), strict=True):
        right.plot(moves / wide, getattr(cut, name)[0], label=entry(name).name, **style)
        right.axhline(level, **GUIDE | {"color": style["color"]})
        right.plot(float(cut.displacement_where(name, level)[0]) / wide, level, "o", color=style["color"], **DOT)
        right.text(0.015, level, f"{level:g}", transform=right.get_yaxis_transform(), va="bottom", color=style["color"])
    mark(right, start / wide, "onset")
    within = own[own <= moves[-1]]
    right.plot(within / wide, np.interp(within, moves, cut.energy_ratio[0]), **_OWN)
    right.set_xlim(0.0, moves[-1] / wide)
    right.set(ylim=(0.0, None), xlabel=labelled(words, prefixed), ylabel="energy ratio, loop aperture")
    right.legend(loc="lower right", title=f"at {written(force, entry('normal_force').unit)}")
    letters(panels)
    legend_above(figure, left, 2)
    return figure
