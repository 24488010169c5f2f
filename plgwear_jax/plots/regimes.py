"""The picture of partial and gross slip over displacement amplitude and normal force."""

import numpy as np
from matplotlib.figure import Figure

from plgwear_jax._core.units import written
from plgwear_jax.catalogue import entry
from plgwear_jax.contact import CRITERIA, SlipRegimes
from plgwear_jax.plots.style import (
    BEST,
    DOT,
    GREEN,
    GUIDE,
    PURPLE,
    REFERENCE,
    Style,
    legend_above,
    letters,
    mark,
    page,
    picture,
    show_units,
)

_LEVELS = (0.01, 0.02, 0.05, 0.1, 0.4, 0.6, 0.8, 0.9, 0.95)
_OWN: Style = DOT | {"color": GREEN, "marker": "D", "linestyle": "", "zorder": 5}


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
    words = entry("displacement_amplitude").name + (" of the rig" if rig_stiffness is not None else " $u_x$")
    x, y, force = found.displacement_amplitude, found.normal_force, float(cut.normal_force[0])
    onset, criterion = found.gross_slip_displacement, CRITERIA["energy_ratio"]
    left.fill_betweenx(y, x[0], onset, color="#E6F4FB", linewidth=0.0, zorder=-1)
    left.set(xscale="log", yscale="log", xlim=x[[0, -1]], ylim=y[[0, -1]])
    left.clabel(left.contour(x, y, found.energy_ratio, levels=_LEVELS, colors="0.45", linewidths=0.6), fontsize=6.5)
    criterion_at = found.displacement_where("energy_ratio", criterion)
    at_onset = f"transition to gross slip, energy ratio {float(cut.gross_slip_energy_ratio[0]):.3g}"
    left.plot(onset, y, color="k", label=at_onset)
    left.plot(criterion_at, y, label=f"energy ratio {criterion:g} (criterion of laboratories)", **REFERENCE)
    left.plot([], color="0.45", linewidth=0.6, label="energy ratio")
    if own.size:
        left.plot(own, np.full(own.size, force), label="load of the input file", **_OWN)
    left.axhline(force, **GUIDE)
    box = {"facecolor": "w", "edgecolor": "none", "pad": 1.0}
    place: Style = {"transform": left.transAxes, "fontstyle": "italic", "color": "0.25", "bbox": box}
    if not found.gross_slip[-1, 0]:
        left.text(0.03, 0.93, "partial slip", **place)
    if found.gross_slip[0, -1]:
        left.text(0.97, 0.04, "gross slip", ha="right", **place)

    moves = cut.displacement_amplitude
    for (name, level), style in zip(CRITERIA.items(), (BEST, REFERENCE | {"color": PURPLE}), strict=True):
        colour: Style = {"color": style["color"]}
        right.plot(moves, getattr(cut, name)[0], label=entry(name).name, **style)
        right.axhline(level, **GUIDE | colour)
        right.plot(cut.displacement_where(name, level), level, "o", **DOT | colour)
        right.text(0.015, level, f"{level:g}", transform=right.get_yaxis_transform(), va="bottom", **colour)
    mark(right, cut.gross_slip_displacement[0], "transition")
    right.plot(own, np.interp(own, moves, cut.energy_ratio[0]), **_OWN)  # those beyond the panel are cut off
    right.set(xlim=(0.0, moves[-1]), ylim=(0.0, None), ylabel="energy ratio, sliding ratio")
    right.legend(loc="lower right", title=f"at {written(force, entry('normal_force').unit)}")
    show_units(left.yaxis, "normal_force")
    for axes in panels:
        show_units(axes.xaxis, "displacement_amplitude", words)
    letters(panels)
    legend_above(figure, left, 2)
    return figure
