"""Pictures of a contact: its slip regimes and stresses before any wear, and its wear over the cycles."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from plgwear_jax._core.catalogue import entry, measured
from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._core.doubts import layers
from plgwear_jax.contact import CRITERIA, SlipRegimes
from plgwear_jax.fitting import Fit
from plgwear_jax.steady.closed import Steady
from plgwear_jax.wear.run import Run

from .style import (
    BEST,
    BLUE,
    DASHED,
    DOT,
    FORBIDDEN,
    GREEN,
    GUIDE,
    ORANGE,
    PURPLE,
    REFERENCE,
    UNWORN,
    Style,
    label,
    legend_above,
    letters,
    mark,
    mark_roughness,
    page,
    picture,
    show_units,
)

# --- before any wear --------------------------------------------------------------------------------------------------

_RATIOS = (0.01, 0.02, 0.05, 0.1, 0.4, 0.6, 0.8, 0.9, 0.95)
_OWN: Style = DOT | {"color": GREEN, "marker": "D", "linestyle": "", "zorder": 5}


@picture
def regimes_picture(
    found: SlipRegimes, cut: SlipRegimes, own: ArrayLike = (), rig_stiffness: float | None = None
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
    own = np.asarray(own)
    words = entry("displacement_amplitude").name + (" of the rig" if rig_stiffness else " $u_x$")
    x, y, force = found.displacement_amplitude, found.normal_force, cut.normal_force[0]
    onset, criterion = found.gross_slip_displacement, CRITERIA["energy_ratio"]
    left.fill_betweenx(y, x[0], onset, color="#E6F4FB", linewidth=0.0, zorder=-1, label="partial slip")
    left.set(xscale="log", yscale="log", ylim=y[[0, -1]])
    left.clabel(left.contour(x, y, found.energy_ratio, levels=_RATIOS, colors="0.45", linewidths=0.6), fontsize=6.5)
    at_onset = f"transition to gross slip, energy ratio {cut.gross_slip_energy_ratio[0]:.3g}"
    left.plot(onset, y, color="k", label=at_onset)
    said = f"energy ratio {criterion:g} (criterion of laboratories)"
    left.plot(found.displacement_where("energy_ratio", criterion), y, label=said, **REFERENCE)
    left.plot([], color="0.45", linewidth=0.6, label="energy ratio")
    if own.size:
        left.plot(own, np.full(own.size, force), label="load of the input file", **_OWN)
    left.axhline(force, **GUIDE)

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
    right.legend(loc="lower right", title=f"at {measured('normal_force', force)}")
    show_units(left.yaxis, "normal_force")
    for axes in panels:
        show_units(axes.xaxis, "displacement_amplitude", words)
    letters(panels)
    legend_above(figure, left, 2)
    return figure


_PEAK: Style = DOT | {"color": BLUE, "clip_on": False, "zorder": 5}
_LARGER: Style = _PEAK | {"markersize": 9.0}
_REACH = 1.6  # of the picture to both sides and downwards, in contact radii
_TICKS = slice(10, -10, 10)  # of the places along both axes, those whose directions are drawn
_LEVELS = 0.05, 0.1, 0.2, 0.4, 0.8
_COLOURS = 20  # about as many shades; a continuous scale makes files of three times the size


@picture
def stress_picture(steady: Steady) -> Figure:
    """Draw the stresses before any wear under the largest tangential force, of one contact.

    Colours are von Mises' stress, contours the largest principal stress, and ticks its direction in the plane, where it
    is a tension. The contact and its stick area lie on top, interfaces are dotted, and both peaks are marked.
    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        steady: Of one contact; where the surface modulus is infinite, for k < 0, the picture begins below it.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    a, c, p_0 = map(float, (steady.contact_radius, steady.stick_radius, steady.peak_initial_pressure))
    x, z = a * np.linspace(-_REACH, _REACH, 161), a * np.linspace(2e-3, _REACH, 81)
    stress = steady.stress(x, z[:, None])
    tension = np.asarray(stress.principal) / p_0
    figure = page(18.0, 10.0, "compressed")
    axes = figure.subplots()
    colours = axes.contourf(x, z, np.asarray(stress.mises) / p_0, levels=_COLOURS)
    figure.colorbar(colours, ax=axes, label="von Mises stress / $p_0$", ticks=MaxNLocator(6))
    axes.contour(x, z, tension, levels=_LEVELS, colors="w", linewidths=0.7)
    shares = ", ".join(map(str, _LEVELS))
    axes.plot([], color="w", linewidth=0.7, label=f"principal stress / $p_0$: {shares}; short lines: its direction")
    turn = np.where(tension > 0.0, 0.5 * np.arctan2(2.0 * stress.xz, stress.xx - stress.zz), np.nan)
    turn = turn[_TICKS, _TICKS]
    axes.quiver(
        x[_TICKS], z[_TICKS], np.cos(turn), np.sin(turn), color="w", angles="xy", pivot="mid", scale=45.0,
        width=1.2e-3, headwidth=0.0, headlength=0.0, headaxislength=0.0,
    )  # fmt: skip
    for depth in np.cumsum(layers(steady.contact.material)):  # where the modulus jumps
        axes.axhline(depth, **GUIDE | {"color": "w", "zorder": 2})
    for edge, colour, words in ((a, "k", "contact"), (c, GREEN, "stick area")):
        axes.hlines(0.0, -edge, edge, color=colour, linewidth=5.0, label=words, clip_on=False)
    told = [f"largest pressure $p_0$ {measured('pressure', p_0)}"]
    # The larger one first: both may be at one place.
    for name, marker, style in (("peak_tension", "D", _LARGER), ("peak_mises", "o", _PEAK)):
        words = entry(name).name.replace("peak", "largest")
        axes.plot(*map(float, getattr(steady, f"{name}_at")), marker, label=words, **style)
        told.append(f"{words} {measured(name, getattr(steady, name))}")
    axes.set(ylim=(z[-1], 0.0), title="; ".join(told), aspect="equal")
    for axis, words in ((axes.xaxis, "place along the motion $x$"), (axes.yaxis, "depth $z$")):
        show_units(axis, "r", words, size=a)
    figure.legend(loc="outside lower center", ncols=3, frameon=True, facecolor="0.35", edgecolor="none", labelcolor="w")
    return figure


# --- over the cycles --------------------------------------------------------------------------------------------------

# From light to dark, for grey prints too.
_SHADES: tuple[Style, ...] = (
    {"color": "#56B4E9", "linestyle": (0, (1, 1))},
    {"color": BLUE, "linestyle": DASHED},
    {"color": "#08306b", "linestyle": "-"},
)
_END: Style = {"color": ORANGE, "linestyle": "-", "label": "steady state"}


@picture
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
    figure = page(18.0, 8.5)
    panels = figure.subplot_mosaic("abd;acd")
    states, styles, final = [*shown], [], run.final
    axes, cycles = panels["a"], np.asarray(cycles, float)
    volumes = np.asarray(run.volume(cycles))
    end = float(final.volume) if final else volumes.max()
    axes.loglog(cycles, volumes[0] / cycles[0] * cycles, label="wear of the first cycles", **FORBIDDEN)
    axes.loglog(cycles, volumes, color="k", label=entry("volume").name)
    if final:
        axes.axhline(end, color=ORANGE)
    if life:
        mark(axes, life, "life")
    axes.set_ylim(volumes[0], 3.0 * end)
    label(axes, "cycles", "volume")
    for number, volume, shade in zip(shown, np.asarray(run.volume(shown)), _SHADES, strict=False):
        axes.plot(number, volume, "o", color=shade["color"], clip_on=False, **DOT)
        share = f" ({100.0 * volume / end:.0f} %)" if final else ""
        styles.append(shade | {"label": f"{float(f'{number:.2g}'):,.10g} cycles{share}"})
    if final:
        states.append(float(run.lasting_cycles))
        styles.append(_END)
    inner, outer = float(np.min(run.stick_radius(states))), float(np.max(run.contact_radius(states)))
    # Radii crowd at the stick-slip boundary, where all quantities may have infinite slopes.
    crowded = np.linspace(-1.0, 1.07, 301)
    r = np.maximum(inner + (outer - inner) * crowded * abs(crowded), 0.0)
    depths, pressures = (np.asarray(field(r, np.array(states)[:, None])) for field in (run.depth, run.pressure))
    start = run.contact.steady(0.0)
    shape, before = (np.asarray(field(r)) for field in (start.profile, start.initial_pressure))
    deepest, highest = depths.max(), (2.5 if inner > 0.0 else 1.1) * before[before < np.inf].max()  # infinite at a tip
    mark_roughness(panels["c"], deepest)
    panels["d"].set_ylim(0.0, highest)
    for key, name, words, unworn, rows in (
        ("b", "profile", f"{entry('profile').name} $f$", shape, shape + depths),
        ("c", "wear_depth", entry("wear_depth").name, 0.0 * r, depths),
        ("d", "pressure", "pressure", before, np.minimum(pressures, 9.0 * highest)),  # else infinite in the end
    ):
        axes = panels[key]
        axes.plot(r, unworn, label="before wear", **UNWORN)
        for row, style in zip(rows, styles, strict=True):
            axes.plot(r, row, **style)
        label(axes, "r", name, words)
    if inner > 0.0:
        mark(panels["d"], inner, "stick-slip boundary")
    deep = measured("wear_depth", deepest)
    panels["c"].set_title(f"{'steady state' if final else 'in the end'}: {deep} deep", loc="right")
    letters(panels[key] for key in "abcd")
    legend_above(figure, (panels["a"], panels["c"]), 4)
    return figure


@picture
def blocks_picture(run: Run) -> Figure:
    """Draw the worn volume over the cycles, and the force amplitude and the two radii at the end of each block.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        run: The result of `FrettingContact.over_cycles` under a list of `Block`, of one contact.

    Returns:
        A figure 16 cm wide; `save` writes it.
    """
    figure = page(16.0, 6.5)
    panels = figure.subplots(1, 3)
    ends = np.cumsum([float(stage.cycles) for stage in run.load.stages()])
    cycles, steps = np.append(0.0, ends), {"drawstyle": "steps-pre"}
    for axes, name, read, style in (
        (panels[0], "volume", run.volume, BEST | {"marker": "o", "markersize": 3.0, "clip_on": False}),
        (panels[1], "tangential_force", run.force_amplitude, BEST | steps),
        (panels[2], "r", run.contact_radius, BEST | steps | {"label": "contact radius at the end of each block"}),
        (panels[2], "r", run.stick_radius, REFERENCE | steps | {"label": "stick radius at the end of each block"}),
    ):
        values = np.asarray(read(ends))
        # the volume grows from nothing, all others are those at the end of each block
        axes.plot(cycles, np.append(0.0 if name == "volume" else values[0], values), **style)
        axes.set_ylim(0.0, 1.05 * axes.dataLim.y1 or 1.0)
        label(axes, "cycles", name, entry(name).name)
    legend_above(figure, panels[2], 2)
    letters(panels)
    return figure


@picture
def fit_picture(fit: Fit, points: str = "measured") -> Figure:
    """Draw measured volumes and the fitted volume over the cycles, and the differences as a share of the fitted one.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        fit: The result of `fitting.fit_wear_coefficient`.
        points: What the points are called, such as "synthetic".

    Returns:
        A figure 14 cm wide; `save` writes it.
    """
    figure = page(14.0, 7.0)
    left, right = panels = figure.subplots(1, 2)
    bars = np.nan_to_num(fit.deviation, posinf=0.0)
    best, low, high = fit.curve
    if np.all(np.isfinite(low)):
        left.fill_between(fit.curve_cycles, low, high, color=BLUE, alpha=0.2, linewidth=0.0, label="95 % confidence")
    left.plot(fit.curve_cycles, best, label="fit", **BEST)
    if fit.steady_volume:
        left.axhline(fit.steady_volume, **_END)
    right.axhline(0.0, **BEST)
    left.set_ylim(0.0, 1.3 * max(fit.volume.max(), fit.fitted.max()))
    percent = np.where(fit.fitted, 0.01 * fit.fitted, np.inf)  # before the first cycle there is nothing to compare
    for axes, known, unit in ((left, 0.0, 1.0), (right, fit.fitted, percent)):
        axes.errorbar(fit.cycles, (fit.volume - known) / unit, bars / unit, label=points, fmt="o", color="k",
                      markersize=3.5, elinewidth=0.8, capsize=2.0)  # fmt: skip
        axes.set_xlim(0.0, 1.1 * fit.cycles.max())
        show_units(axes.xaxis, "cycles")
    show_units(left.yaxis, "volume")
    right.set_ylabel("difference from the fit (%)")
    letters(panels)
    legend_above(figure, left, 4)
    return figure
