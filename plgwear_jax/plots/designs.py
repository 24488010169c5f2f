"""Pictures of designs beside their references, of trade-offs, of measured coatings and of free gradients."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plgwear_jax._core.units import readable
from plgwear_jax.catalogue import entry, leaf, placed
from plgwear_jax.optimise import Comparison, Design, Front, along, compared
from plgwear_jax.plots.style import (
    BEST,
    BLUE,
    DOT,
    FORBIDDEN,
    GUIDE,
    OTHER,
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
from plgwear_jax.rules import is_linear

if TYPE_CHECKING:
    from plgwear_jax.coating import Idealisation, PowerLawFit
    from plgwear_jax.optimise import FreeDesign

_GPA = 1e9  # Pa
_MODULUS = f"{entry('modulus').label} (GPa)"
_POINTS = 61  # of a curve, which is one batch of contacts

_Worn = Sequence[tuple[Any, ...]]  # radii, wear depths, both edges of the ring, all in m, and a style


@picture
def design_picture(design: Design, comparison: Comparison | None = None) -> Figure:
    """Draw a design beside its reference: the modulus over the depth, the objective over a variable, the wear depths.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The objective is the change against the reference. The variable is k if it varies; the others have the values of the
    best design. Where a limit is broken the curve is thin and dashed. The reference is not on the curve if its other
    variables differ. Dotted lines mark the contact radius and the edges c and a_inf of the worn rings (at the largest
    force amplitude), the contact radius a after the cycles of a displacement or of blocks, or the edge of the punch.

    Args:
        design: The result of `optimise.design`.
        comparison: The result of `optimise.compared`, if it was computed already.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    comparison = compared(design) if comparison is None else comparison
    figure = page(18.0, 7.6)
    panels = figure.subplots(1, 3)
    found = comparison.quantities
    radius = float(found["contact_radius"][1] if "contact_radius" in found else np.asarray(design.reference.radius))
    best = "best" if design.keeps_limits else "closest design, limits violated"
    contacts = (best, design.contact), ("reference", design.reference)
    labels = [
        f"{words}, $k = {float(np.asarray(its.material.k)):.3g}$" if hasattr(its.material, "k") else words  # pyright: ignore[reportAttributeAccessIssue]
        for words, its in contacts
    ]
    unit = _draw_moduli(panels[0], comparison.depths, comparison.modulus, labels, radius)
    _draw_bars(panels[0], design.windows, unit)
    _draw_objective(panels[1], design)
    rings = zip(comparison.radii, comparison.depth, (BEST, REFERENCE), strict=True)
    worn = [(r, depth, r[0], r[-1], style) for r, depth, style in rings]
    if design.load is None:
        draw_depths(panels[2], worn, "$a$", r"worn off the face, $d - w_\infty$")
    else:
        draw_depths(panels[2], worn, r"$a_\infty$" if "worn_radius" in found else "$a$")
    letters(panels)
    legend_above(figure, panels[0], 4)
    return figure


def _draw_moduli(axes: Axes, depths: Any, moduli: Any, labels: Sequence[str], radius: float) -> float:
    """Draw moduli over the depth; the unit of the depth is that of the contact radius."""
    unit, label = scaled("depth", radius)
    for modulus, words, style in zip(moduli, labels, (BEST, REFERENCE, OTHER), strict=False):
        axes.loglog(np.asarray(depths) / unit, np.asarray(modulus) / _GPA, label=words, **style)
    mark(axes, radius / unit, "$a_0$")
    axes.set(xlim=(depths[0] / unit, depths[-1] / unit), xlabel=label, ylabel=_MODULUS)
    plain_ticks(axes.xaxis)
    plain_ticks(axes.yaxis)
    return unit


def _draw_bars(axes: Axes, windows: Sequence[tuple[float, float, float]], unit: float) -> None:
    """Bars from the lowest to the highest modulus allowed at some depths in m, NaN for none; few values are told."""
    if windows:
        z, *ends = np.asarray(windows).T
        told = {
            f"{a:.4g} to {b:.4g}" if a < b else f"at most {b:.4g}" if np.isnan(a) else f"at least {a:.4g}"
            for a, b in np.transpose(ends) / _GPA
        }
        low, high = np.where(np.isnan(ends), np.array([axes.get_ylim()]).T, np.asarray(ends) / _GPA)
        words = f": {' and '.join(sorted(told))} GPa" if len(told) < 3 else ""
        axes.errorbar(z / unit, 0.5 * (low + high), 0.5 * (high - low), fmt="none", ecolor="k", elinewidth=0.8,
                      capsize=2.0, label=f"allowed modulus{words}")  # fmt: skip
        plain_ticks(axes.yaxis)


def draw_depths(axes: Axes, worn: _Worn, end: str = r"$a_\infty$", words: str = entry("wear_depth").name) -> None:
    """Draw wear depths over the radius; outside of the ring nothing is worn."""
    outer = max(float(row[3]) for row in worn)
    unit, label = scaled("r", outer)
    tall, depth_label = scaled("wear_depth", max(float(np.max(row[1])) for row in worn), words)
    for r, depth, c, a, style in worn:
        axes.plot(np.asarray(r) / unit, np.asarray(depth) / tall, **style)
        for edge in (c, a):
            axes.axvline(float(edge) / unit, **GUIDE | {"color": style["color"]})
    for edge, symbol in ((worn[-1][2], "$c$"), (worn[-1][3], end)):
        if edge > 0.0:
            mark(axes, float(edge) / unit, symbol)
    axes.set(xlabel=label, ylabel=depth_label)
    axes.set_ylim(bottom=0.0)


def _draw_objective(axes: Axes, design: Design) -> None:
    bounds = design.bounds
    name = next((name for name in ("k", "E0", "z0") if name in bounds), next(iter(bounds)))
    here, there = design.variables[name], design.reference_variables[name]
    spaced = np.linspace if is_linear(name) else np.geomspace
    ends = bounds[name]
    values = np.unique([*spaced(*ends, _POINTS), here, *([there] if ends[0] <= there <= ends[1] else [])])
    course = along(design, name, values)
    curve, kept = (
        100.0 * (np.asarray(course.value) / float(design.reference_value) - 1.0),
        np.asarray(course.keeps_limits),
    )
    change = -100.0 * design.saving
    unit, prefixed = (1.0, "") if is_linear(name) else readable(float(values[-1]), entry(name).unit)
    label = labelled(leaf(name).label, prefixed)
    if len(bounds) > 1:
        label += "\nother variables as in the best design"
    if not kept.all():
        axes.plot(values / unit, curve, label="breaks a limit", **FORBIDDEN)
    axes.plot(values / unit, np.where(kept, curve, np.nan), color="0.2")
    axes.plot(there / unit, 0.0, "s", color=REFERENCE["color"], **DOT)
    axes.plot(here / unit, change, "o", color=BLUE, **DOT)
    axes.axhline(0.0, **GUIDE)
    axes.set_title(f"{abs(change):.3g} % {'less' if change <= 0.0 else 'more'}", loc="right")
    # What breaks a limit may be far from all that counts, and is cut off there.
    seen = np.array([*curve[kept], 0.0, change])
    room = 0.2 * np.ptp(seen)
    axes.set_ylim(seen.min() - room, seen.max() + room)
    if not is_linear(name):
        axes.set_xscale("log")
        plain_ticks(axes.xaxis)
    if not kept.all():
        axes.legend()
    mean = "mean " if design.load is not None and np.count_nonzero(design.load.weight) > 1 else ""
    axes.set(xlabel=label, ylabel=f"change of {mean}{entry(design.objective).label} (%)")


@picture
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
    figure = page(7.0 * count, 7.0)
    panels = figure.subplots(1, count, sharex=True, squeeze=False)[0]
    x, y = np.asarray(front.x), np.asarray(front.y)
    inside = [BLUE if certain else "w" for certain in np.asarray(front.certified)]
    named = (front.x_name, x, front.x_places), (front.y_name, y, front.y_places)
    (wide, x_label), (tall, y_label) = (
        scaled(name, values.max(), placed(name, places) if places else None) for name, values, places in named
    )
    rows = [(y / tall, y_label)]
    for name, values in front.variables.items():
        unit, prefixed = (1.0, "") if is_linear(name) else readable(float(np.max(values)), entry(name).unit)
        rows.append((np.asarray(values) / unit, labelled(leaf(name).label, prefixed)))
    for axes, (values, label) in zip(panels, rows, strict=True):
        axes.plot(x / wide, values, label=f"{front.best[1]} for this {entry(front.x_name).name}", **BEST)
        axes.scatter(x / wide, values, s=12.0, color=inside, edgecolors=BLUE)
        if np.ptp(values) < 1e-6 * np.max(np.abs(values)):  # else the axis would show rounding errors
            axes.set_ylim(*np.sort(values[0] * np.array([0.5, 1.5])))
        axes.set_ylabel(label)
    letters(panels)
    axes = panels[0]
    axes.plot(float(front.reference_x) / wide, float(front.reference_y) / tall, "s", color=REFERENCE["color"],
              label="reference", **DOT)  # fmt: skip
    for end, words in zip((0, -1), front.ends, strict=True):
        above = (y[0] >= y[-1]) == (end == 0)  # the higher end has room above, the lower one below
        axes.annotate(
            words.replace(", ", "\n"), (x[end] / wide, y[end] / tall), (0.0, 8.0 if above else -8.0),
            textcoords="offset points", ha="left" if (x[0] <= x[-1]) == (end == 0) else "right",
            va="bottom" if above else "top", color="0.3",
        )  # fmt: skip
    axes.set_ylim(0.0, 1.4 * axes.dataLim.y1)
    axes.legend()
    figure.supxlabel(x_label, fontsize="medium")
    return figure


@picture
def coating_picture(
    fit: "PowerLawFit",
    curve: tuple[np.ndarray, np.ndarray],
    counts: tuple[np.ndarray, np.ndarray],
    idealisation: "Idealisation",
) -> Figure:
    """Draw E(z) and its power law, how strongly each depth influences the wear, and the wear depths on both.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        fit: The result of `coating.fit_power_law`.
        curve: Depths in m, and the modulus in Pa that the contact was computed with, each of shape (n,).
        counts: The result of `coating.where_it_counts`.
        idealisation: The result of `coating.idealised`.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    law, found = fit.material, idealisation.quantities
    E0, z0, k = (float(np.asarray(value)) for value in (law.E0, law.z0, law.k))
    moduli = curve[1], E0 * (curve[0] / z0) ** k
    figure, panels, unit = _coating(curve[0], moduli, ("E(z) as given", f"power law, $k = {k:.3g}$"),
                                    float(found["contact_radius"][0]), counts)  # fmt: skip
    panels[0].plot(fit.depth / unit, fit.modulus / _GPA, "o", color=BLUE, markersize=3.0)
    for axes in panels[:2]:
        axes.axvspan(fit.felt[0] / unit, fit.felt[1] / unit, zorder=-1, color="0.9", linewidth=0.0,
                     label="0.1 to 3 contact radii")  # fmt: skip
    edges = found["stick_radius"], found["worn_radius"]
    worn = zip(idealisation.radii, idealisation.wear_depth, *edges, (BEST, REFERENCE), strict=True)
    draw_depths(panels[2], [*worn])
    legend_above(figure, panels[0], 3)
    return figure


def _coating(
    depths: np.ndarray, moduli: Sequence[np.ndarray], labels: Sequence[str], radius: float, counts: Any
) -> tuple[Figure, Any, float]:
    """A page with moduli and influences over the depth, its three panels, and the unit of the depth."""
    figure = page(18.0, 7.6)
    panels = figure.subplots(1, 3)
    unit = _draw_moduli(panels[0], depths, moduli, labels, radius)
    axes = panels[1]
    axes.axhline(0.0, color="0.5", linewidth=0.6)
    axes.semilogx(counts[0] / unit, counts[1], marker="o", markersize=2.5, **BEST)
    axes.set(xlim=panels[0].get_xlim(), xlabel=panels[0].get_xlabel(),
             ylabel=r"$\partial\ln\Delta V\,/\,\partial\ln E$ per decade of depth")  # fmt: skip
    plain_ticks(axes.xaxis)
    mark(axes, radius / unit, "$a_0$")
    letters(panels)
    return figure, panels, unit


@picture
def free_picture(
    found: "FreeDesign", curves: Sequence[np.ndarray], counts: tuple[np.ndarray, np.ndarray], worn: _Worn
) -> Figure:
    """Draw the best E(z), the best power law and the reference, the influence of each depth, and the wear depths.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `optimise.free_design`.
        curves: Depths in m, then the moduli in Pa at these depths of the best E(z), the power law and the reference,
            each of shape (n,).
        counts: The result of `coating.where_it_counts` for the best E(z).
        worn: (Radii, wear depths, stick radius, worn radius) in m of the best E(z), the power law and the reference.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    depths, best, law, reference = curves
    labels = "best free gradient", "reference", f"best power law, $k = {found.exponent:.3g}$"
    figure, panels, unit = _coating(depths, (best, reference, law), labels, float(found.contact_radii[0]), counts)
    bounds = (np.asarray(x) for x in (found.profile.at, found.profile.lower, found.profile.upper))
    _draw_bars(panels[0], [*zip(*bounds, strict=True)], unit)
    rows = zip(worn, (BEST, OTHER, REFERENCE), strict=True)
    draw_depths(panels[2], [(*row, style) for row, style in rows])
    legend_above(figure, panels[0], 4)
    return figure
