"""Pictures of the wear over cycles: under one amplitude, over blocks of amplitudes, and fitted to measured volumes."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._core.units import written
from plgwear_jax.catalogue import entry
from plgwear_jax.fitting import Fit
from plgwear_jax.plots.style import (
    BEST,
    BLUE,
    DASHED,
    DOT,
    FORBIDDEN,
    ORANGE,
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
)
from plgwear_jax.shapes.of_contact import unworn_of
from plgwear_jax.wear.run import Run

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
    states, styles, end = [*shown], [], np.inf if run.final is None else float(run.final.volume)
    _draw_volume(panels["a"], run, np.asarray(cycles, float), end, life)
    for number, volume, shade in zip(shown, np.asarray(run.volume(shown)), _SHADES, strict=False):
        panels["a"].plot(number, volume, "o", color=shade["color"], **DOT)
        share = f" ({100.0 * volume / end:.0f} %)" if end < np.inf else ""
        styles.append(shade | {"label": f"{plain_number(number)} cycles{share}"})
    if end < np.inf:
        states.append(float(run.lasting_cycles))
        styles.append(_END)
    inner, outer = float(np.min(run.stick_radius(states))), float(np.max(run.contact_radius(states)))
    first, last = max(2.0 * inner - outer, 0.0), outer + 0.15 * (outer - inner)
    # Radii crowd at the stick-slip boundary, where all quantities may have infinite slopes.
    crowded = np.linspace(0.0, 1.0, 121) ** 2
    r = np.unique([*(inner - (inner - first) * crowded**2), *(inner + (outer - inner) * crowded), last])
    depths, pressures = (np.asarray(field(r, np.array(states)[:, None])) for field in (run.depth, run.pressure))
    shape, before = np.asarray(unworn_of(run.contact)(r)), np.asarray(run.contact.steady(0.0).initial_pressure(r))
    deepest, highest = float(np.max(depths)), (2.5 if inner > 0.0 else 1.1) * before.max()
    for key, name, words, unworn, rows in (
        ("b", "profile", f"{entry('profile').name} $f$", shape, shape + depths),
        ("c", "wear_depth", entry("wear_depth").name, 0.0 * r, depths),
        ("d", "pressure", "pressure", before, np.minimum(pressures, 9.0 * highest)),  # else infinite in the end
    ):
        axes = panels[key]
        axes.plot(r, unworn, label="before wear", **UNWORN)
        for row, style in zip(rows, styles, strict=True):
            axes.plot(r, row, **style)
        axes.set_xlim(first, last)
        if key == "c":
            mark_roughness(axes, deepest)
        elif key == "d":
            axes.set_ylim(0.0, highest)
        label(axes, "r", name, words)
    if inner > 0.0:
        mark(panels["d"], inner, "stick-slip boundary")
    deep = written(deepest, entry("wear_depth").unit)
    panels["c"].set_title(f"{'steady state' if end < np.inf else 'in the end'}: {deep} deep", loc="right")
    letters(panels[key] for key in "abcd")
    legend_above(figure, (panels["a"], panels["c"]), 4)
    return figure


def plain_number(number: float) -> str:
    """A number of cycles in mathematical notation."""
    mantissa, _, exponent = f"{number:.1e}".partition("e")
    return rf"${mantissa}\times 10^{{{int(exponent)}}}$" if not 1.0 <= number < 1e3 else f"{number:.0f}"


def _draw_volume(axes: Axes, run: Run, cycles: np.ndarray, end: float, life: float | None) -> None:
    volume = np.asarray(run.volume(cycles))
    axes.loglog(cycles, volume[0] / cycles[0] * cycles, label="wear of the first cycles", **FORBIDDEN)
    axes.loglog(cycles, volume, color="k", label=entry("volume").name)
    if end < np.inf:
        axes.axhline(end, color=ORANGE)
    if life is not None:
        mark(axes, life, "life")
    axes.set(xlim=cycles[[0, -1]], ylim=(volume[0], 3.0 * (end if end < np.inf else volume.max())))
    label(axes, "cycles", "volume")


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
        (panels[0], "volume", run.volume, BEST | {"marker": "o", "markersize": 3.0}),
        (panels[1], "tangential_force", run.force_amplitude, BEST | steps),
        (panels[2], "r", run.contact_radius, BEST | steps | {"label": "contact"}),  # the larger one sets the limits
        (panels[2], "r", run.stick_radius, REFERENCE | steps | {"label": "stick"}),
    ):
        values = np.asarray(read(ends))
        # the volume grows from nothing, all others are those at the end of each block
        axes.plot(cycles, np.append(0.0 if name == "volume" else values[0], values), **style)
        axes.set(xlim=(0.0, 1.02 * cycles[-1] or None), ylim=(0.0, None))
        label(axes, "cycles", name, entry(name).name)
    panels[2].legend()
    letters(panels)
    return figure


@picture
def fit_picture(fit: Fit, points: str = "measured") -> Figure:
    """Draw measured volumes and the fitted volume over the cycles, and the differences between both.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        fit: The result of `fitting.fit_wear_coefficient`.
        points: What the points are called, such as "simulated".

    Returns:
        A figure 14 cm wide; `save` writes it.
    """
    figure = page(14.0, 7.0)
    left, right = panels = figure.subplots(1, 2)
    dots: Style = {"fmt": "o", "color": "k", "markersize": 3.5, "elinewidth": 0.8, "capsize": 2.0}
    bars = np.nan_to_num(fit.deviation, posinf=0.0)
    best, low, high = fit.curve
    if np.all(np.isfinite(low)):
        left.fill_between(fit.curve_cycles, low, high, color=BLUE, alpha=0.2, linewidth=0.0, label="95 %")
    left.plot(fit.curve_cycles, best, label="fit", **BEST)
    if fit.steady_volume is not None:
        left.axhline(fit.steady_volume, **_END)
    right.axhline(0.0, **BEST)
    left.set_ylim(0.0, 1.3 * max(fit.volume.max(), fit.fitted.max()))
    for axes, known, words in ((left, 0.0, None), (right, fit.fitted, f"{points} less fitted")):
        axes.errorbar(fit.cycles, fit.volume - known, bars, label=points, **dots)
        axes.set_xlim(0.0, 1.1 * fit.cycles.max())
        label(axes, "cycles", "volume", words)
    letters(panels)
    legend_above(figure, left, 4)
    return figure
