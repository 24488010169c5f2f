"""Pictures of a measured coating with its fitted power law, and of the best free gradient."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from plgwear_jax._core.numbers import for_numbers
from plgwear_jax.catalogue import entry
from plgwear_jax.plots.style import (
    BEST,
    COLOURS,
    GPA,
    GUIDE,
    LABEL_SIZE,
    REFERENCE,
    finished,
    label_axes,
    legend_above,
    mark,
    page,
    plain_ticks,
    scaled,
)

if TYPE_CHECKING:
    from plgwear_jax.coating import Idealisation, PowerLawFit
    from plgwear_jax.optimise import FreeDesign

PLACES = {"left": 0.075, "right": 0.98, "bottom": 0.14, "top": 0.855, "wspace": 0.38}
WINDOW: dict[str, Any] = {"color": "k", "marker": "_", "markersize": 5.0, "linewidth": 0.8}  # allowed moduli
IN_LEGEND: dict[str, Any] = {"color": "k", "marker": r"$\mathrm{I}$", "markersize": 7.0, "linestyle": ""}  # the same
_EFFECT = r"$\partial\ln\Delta V\,/\,\partial\ln E$ per decade of depth"
_SHADE = {"color": "0.9", "linewidth": 0.0}


@for_numbers("draw what the program returns")
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
    radius = float(idealisation.quantities["contact_radius"][0])
    figure, panels, unit = _page(curve[0], fit.felt[1], radius, counts)
    for axes in (panels["a"], panels["b"]):
        axes.axvspan(*(depth / unit for depth in fit.felt), zorder=-1, **_SHADE)
    material = fit.material
    E0, z0, k = (float(np.asarray(value)) for value in (material.E0, material.z0, material.k))
    panels["a"].plot(curve[0] / unit, curve[1] / GPA, **BEST)
    panels["a"].plot(fit.depth / unit, fit.modulus / GPA, "o", color=BEST["color"], markersize=3.0)
    panels["a"].plot(curve[0] / unit, E0 * (curve[0] / z0) ** k / GPA, **REFERENCE)
    plain_ticks(panels["a"].yaxis)
    edges = idealisation.quantities["stick_radius"], idealisation.quantities["worn_radius"]
    worn = zip(idealisation.radii, idealisation.wear_depth, *edges, (BEST, REFERENCE), strict=True)
    draw_rings(panels["c"], [*worn])
    entries = [
        Line2D([], [], label="E(z) as given", marker="o", markersize=3.0, **BEST),
        Line2D([], [], label=f"power law, $k = {k:.3g}$", **REFERENCE),
        Patch(label="0.1 to 3 contact radii", **_SHADE),
    ]
    legend_above(figure, entries, 3, handlelength=3.0)
    return figure


def _page(depths: np.ndarray, size: float, radius: float, counts: Any) -> tuple[Figure, dict[str, Axes], float]:
    """A page for a coating, with the influence of each depth drawn, its panels by name, and the unit of the depth.

    The size is the depth in m whose prefix the depths take; the contact radius in m is marked.
    """
    figure = page(18.0, 7.6)
    panels = figure.subplot_mosaic([["a", "b", "c"]], gridspec_kw=PLACES)  # pyright: ignore[reportCallIssue, reportArgumentType]
    unit, depth_label = scaled("depth", size)
    panels["a"].set_yscale("log")
    panels["b"].axhline(0.0, color="0.5", linewidth=0.6)
    _draw_influence(panels["b"], counts[0] / unit, counts[1])
    for axes, label in ((panels["a"], scaled("modulus", GPA)[1]), (panels["b"], _EFFECT)):
        mark(axes, radius / unit, "$a_0$")
        axes.set_xscale("log")
        axes.set_xlim(float(depths[0]) / unit, float(depths[-1]) / unit)
        plain_ticks(axes.xaxis)
        label_axes(axes, depth_label, label)
    finished(panels)
    return figure, panels, unit


def _draw_influence(axes: Axes, depth: np.ndarray, effect: np.ndarray) -> None:
    """The influence of a few depths as dots, joined by a curve that has no corners."""
    from scipy.interpolate import PchipInterpolator

    between = np.geomspace(depth[0], depth[-1], 401)
    axes.plot(between, PchipInterpolator(np.log(depth), effect)(np.log(between)), **BEST)
    axes.plot(depth, effect, "o", color=BEST["color"], markersize=2.5)


def draw_rings(axes: Axes, worn: list[tuple[Any, ...]], end: str = r"$a_\infty$") -> None:
    """Draw wear depths, each given by radii, depths, stick and worn radius and a style, and mark both radii."""
    inner, outer = min(float(c) for _, _, c, _, _ in worn), max(float(a) for _, _, _, a, _ in worn)
    margin = 0.12 * (outer - inner)
    first, last = max(inner - margin, 0.0), outer + margin
    along, along_label = scaled("r", outer)
    deepest = max(float(np.max(depth)) for _, depth, _, _, _ in worn)
    depth, depth_label = scaled("wear_depth", deepest, entry("wear_depth").name)
    for radii, worn_off, c, a, style in worn:
        # outside the ring nothing is worn
        ring = float(c) > 0.0
        r = np.concatenate([[first] * ring, radii, [last]])
        axes.plot(r / along, np.concatenate([[0.0] * ring, worn_off, [0.0]]) / depth, **style)
        for edge in (c, a):
            axes.axvline(float(edge) / along, color=style["color"], **GUIDE)
    head = axes.get_xaxis_transform()
    for column, symbol in ((2, "$c$"), (3, end)):
        edges = [float(one[column]) for one in worn]
        if not any(edges):
            continue
        apart = np.ptp(edges) > 0.1 * (last - first)
        places = [(edge, one[-1]["color"]) for edge, one in zip(edges, worn, strict=True)]
        for place, color in places if apart else [(0.5 * (min(edges) + max(edges)), "0.3")]:
            axes.text(
                place / along, 1.01, symbol, transform=head, fontsize=LABEL_SIZE, ha="center", va="bottom", color=color
            )
    axes.set_xlim(first / along, last / along)
    axes.set_ylim(bottom=0.0)
    label_axes(axes, along_label, depth_label)


# --- a free gradient ------------------------------------------------------------------------------------------------

_LAW = {"color": COLOURS[2], "linestyle": (0, (1, 1)), "linewidth": 1.6}


@for_numbers("draw what the program returns")
def free_picture(found: "FreeDesign", curves: list[np.ndarray], counts: Any, worn: list[Any]) -> Figure:
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
    depths, moduli = curves[0], curves[1:]
    figure, panels, unit = _page(depths, float(depths[-1]), found.contact_radii[0], counts)
    styles, axes = (BEST, _LAW, REFERENCE), panels["a"]
    at, lower, upper = (np.asarray(x) for x in (found.profile.at, found.profile.lower, found.profile.upper))
    for modulus, style in reversed(list(zip(moduli, styles, strict=True))):
        axes.plot(depths / unit, modulus / GPA, **style)
    for z, low, high in zip(at, lower, upper, strict=True):
        axes.plot([z / unit] * 2, [low / GPA, high / GPA], **WINDOW)
    axes.set_ylim(0.9 * lower.min() / GPA, 1.1 * upper.max() / GPA)
    plain_ticks(axes.yaxis)
    draw_rings(panels["c"], [(*one, style) for one, style in zip(worn, styles, strict=True)])
    labels = "best free gradient", f"best power law, $k = {found.exponent:.3g}$", "reference"
    entries = [Line2D([], [], label=label, **style) for label, style in zip(labels, styles, strict=True)]
    entries.append(Line2D([], [], label="allowed modulus", **IN_LEGEND))
    legend_above(figure, entries, 4, handlelength=2.4, columnspacing=1.4)
    return figure
