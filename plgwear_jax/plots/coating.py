"""Pictures of a measured coating with its fitted power law, and of the best free gradient."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from plgwear_jax._core.numbers import for_numbers
from plgwear_jax.catalogue import entry
from plgwear_jax.contact import unworn_of
from plgwear_jax.plots.style import (
    BEST,
    COLOURS,
    GPA,
    GUIDE,
    LABEL_SIZE,
    REFERENCE,
    TICK_SIZE,
    UNWORN,
    finished,
    page,
    plain_ticks,
    scaled,
)

if TYPE_CHECKING:
    from plgwear_jax.coating import Idealisation, PowerLawFit
    from plgwear_jax.optimise import FreeDesign

__all__ = ["coating_picture", "free_picture"]

_PLACES = {"left": 0.075, "right": 0.98, "bottom": 0.14, "top": 0.855, "wspace": 0.38, "hspace": 0.1}
_EFFECT = r"$\partial\ln\Delta V\,/\,\partial\ln E$ per decade of depth"
_SHADE = {"color": "0.9", "linewidth": 0.0}


@for_numbers("draw what the program returns")
def coating_picture(
    fit: "PowerLawFit",
    curve: tuple[np.ndarray, np.ndarray],
    counts: tuple[np.ndarray, np.ndarray],
    idealisation: "Idealisation",
    contact: Any,
) -> Figure:
    """Draw E(z) and its power law, how strongly each depth influences the wear, and the worn profiles on both.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        fit: The result of `coating.fit_power_law`.
        curve: Depths in m, and the modulus in Pa that the contact was computed with, each of shape (n,).
        counts: The result of `coating.where_it_counts`.
        idealisation: The result of `coating.idealised`.
        contact: The contact, whose unworn indenter is drawn as well.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    figure = page(18.0, 7.6)
    layout = [["a", "b", "c"], ["a", "b", "depth"]]
    panels = figure.subplot_mosaic(layout, gridspec_kw=_PLACES)  # pyright: ignore[reportCallIssue, reportArgumentType]
    unit, depth_label = scaled("depth", fit.felt[1])
    limits = float(curve[0][0]) / unit, float(curve[0][-1]) / unit
    for axes in (panels["a"], panels["b"]):
        axes.axvspan(*(depth / unit for depth in fit.felt), zorder=0, **_SHADE)
        axes.axvline(float(idealisation.quantities["contact_radius"][0]) / unit, color="0.5", **GUIDE)
        axes.set_xscale("log")
        axes.set_xlim(*limits)
        axes.set_xlabel(depth_label, fontsize=LABEL_SIZE)
        head = axes.get_xaxis_transform()
        place = float(idealisation.quantities["contact_radius"][0]) / unit
        axes.text(place, 1.01, "$a_0$", transform=head, fontsize=LABEL_SIZE, ha="center", va="bottom", color="0.3")
    _draw_modulus(panels["a"], fit, curve, unit)
    panels["b"].axhline(0.0, color="0.5", linewidth=0.6)
    panels["b"].plot(counts[0] / unit, counts[1], **BEST)
    panels["b"].set_ylabel(_EFFECT, fontsize=LABEL_SIZE)
    plain_ticks(panels["a"].xaxis)
    plain_ticks(panels["b"].xaxis)
    panels["depth"].sharex(panels["c"])
    _draw_worn(panels["c"], panels["depth"], idealisation, contact)
    figure.align_ylabels([panels["c"], panels["depth"]])
    finished(panels)
    entries = [
        Line2D([], [], label="E(z) as given", marker="o", markersize=3.0, **BEST),
        Line2D([], [], label=f"power law, $k = {float(np.asarray(fit.material.k)):.3g}$", **REFERENCE),
        Line2D([], [], label="unworn indenter", **UNWORN),
        Patch(label="0.1 to 3 contact radii", **_SHADE),
    ]
    figure.legend(handles=entries, loc="upper center", ncols=4, handlelength=3.0, frameon=False, fontsize=LABEL_SIZE)
    return figure


def _draw_modulus(axes: Axes, fit: "PowerLawFit", curve: tuple[np.ndarray, np.ndarray], unit: float) -> None:
    stiff, modulus_label = scaled("modulus", GPA)
    axes.set_yscale("log")
    axes.plot(curve[0] / unit, curve[1] / stiff, **BEST)
    axes.plot(fit.depth / unit, fit.modulus / stiff, "o", color=BEST["color"], markersize=3.0)
    material = fit.material
    E0, z0, k = (float(np.asarray(value)) for value in (material.E0, material.z0, material.k))
    axes.plot(curve[0] / unit, E0 * (curve[0] / z0) ** k / stiff, **REFERENCE)
    plain_ticks(axes.yaxis)
    axes.set_ylabel(modulus_label, fontsize=LABEL_SIZE)


def _draw_worn(above: Axes, below: Axes, idealisation: "Idealisation", contact: Any) -> None:
    edges = idealisation.quantities["stick_radius"], idealisation.quantities["worn_radius"]
    worn = zip(idealisation.radii, idealisation.wear_depth, *edges, strict=True)
    _draw_rings(above, below, [(*one, style) for one, style in zip(worn, (BEST, REFERENCE), strict=True)], contact)


def _draw_rings(above: Axes, below: Axes, worn: list[tuple[Any, Any, float, float, Any]], contact: Any) -> None:
    """Worn profiles and depths, each given by radii, depths, stick and worn radius and a style."""
    inner, outer = min(float(c) for _, _, c, _, _ in worn), max(float(a) for _, _, _, a, _ in worn)
    margin = 0.12 * (outer - inner)
    first, last = max(inner - margin, 0.0), outer + margin
    along, along_label = scaled("r", outer)
    unworn = unworn_of(contact)
    height, height_label = scaled("profile", float(unworn(last)))
    deepest = max(float(np.max(depth)) for _, depth, _, _, _ in worn)
    depth, depth_label = scaled("wear_depth", deepest, entry("wear_depth").name)
    everywhere = np.linspace(first, last, 201)
    above.plot(everywhere / along, unworn(everywhere) / height, **UNWORN)
    for r, worn_off, c, a, style in worn:
        r = np.concatenate([[first], r, [last]])
        worn_off = np.concatenate([[0.0], worn_off, [0.0]])
        above.plot(r / along, (unworn(r) + worn_off) / height, **style)
        below.plot(r / along, worn_off / depth, **style)
        for axes in (above, below):
            for edge in (c, a):
                axes.axvline(float(edge) / along, color=style["color"], **GUIDE)
    above.set_xlim(first / along, last / along)
    above.set_ylim(float(unworn(first)) / height, 1.1 * float(unworn(last)) / height)
    above.tick_params(labelbottom=False)
    above.set_ylabel(height_label, fontsize=LABEL_SIZE)
    below.set_ylim(bottom=0.0)
    below.set_xlabel(along_label, fontsize=LABEL_SIZE)
    below.set_ylabel(depth_label, fontsize=LABEL_SIZE)


# --- a free gradient ------------------------------------------------------------------------------------------------

_LAW = {"color": COLOURS[2], "linestyle": (0, (1, 1)), "linewidth": 1.6}


@for_numbers("draw what the program returns")
def free_picture(found: "FreeDesign", curves: list[np.ndarray], counts: Any, worn: list[Any]) -> Figure:
    """Draw the best E(z), the best power law and the reference, the influence of each depth, and the worn profiles.

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
    figure = page(18.0, 7.6)
    layout = [["a", "b", "c"], ["a", "b", "depth"]]
    panels = figure.subplot_mosaic(layout, gridspec_kw=_PLACES)  # pyright: ignore[reportCallIssue, reportArgumentType]
    styles = BEST, _LAW, REFERENCE
    unit, depth_label = scaled("depth", float(curves[0][-1]))
    stiff, modulus_label = scaled("modulus", GPA)
    at, lower, upper = (np.asarray(x) for x in (found.profile.at, found.profile.lower, found.profile.upper))
    for axes in (panels["a"], panels["b"]):
        axes.axvline(found.contact_radii[0] / unit, color="0.5", **GUIDE)
        axes.set_xscale("log")
        axes.set_xlim(float(curves[0][0]) / unit, float(curves[0][-1]) / unit)
        axes.set_xlabel(depth_label, fontsize=LABEL_SIZE)
        head = axes.get_xaxis_transform()
        place = found.contact_radii[0] / unit
        axes.text(place, 1.01, "$a_0$", transform=head, fontsize=LABEL_SIZE, ha="center", va="bottom", color="0.3")
        plain_ticks(axes.xaxis)
    panels["a"].set_yscale("log")
    for modulus, style in reversed(list(zip(curves[1:], styles, strict=True))):
        panels["a"].plot(curves[0] / unit, modulus / stiff, **style)
    for z, low, high in zip(at, lower, upper, strict=True):
        panels["a"].plot(
            [z / unit] * 2, [low / stiff, high / stiff], color="k", marker="_", markersize=5.0, linewidth=0.8
        )
    panels["a"].set_ylim(0.9 * lower.min() / stiff, 1.1 * upper.max() / stiff)
    plain_ticks(panels["a"].yaxis)
    panels["a"].set_ylabel(modulus_label, fontsize=LABEL_SIZE)
    panels["b"].axhline(0.0, color="0.5", linewidth=0.6)
    panels["b"].plot(counts[0] / unit, counts[1], **BEST)
    panels["b"].set_ylabel(_EFFECT, fontsize=LABEL_SIZE)
    panels["depth"].sharex(panels["c"])
    rings = [(*one, style) for one, style in zip(worn, styles, strict=True)]
    _draw_rings(panels["c"], panels["depth"], rings, found.reference)
    figure.align_ylabels([panels["c"], panels["depth"]])
    finished(panels)
    labels = "best free gradient", f"best power law, $k = {found.exponent:.3g}$", "reference"
    entries = [Line2D([], [], label=label, **style) for label, style in zip(labels, styles, strict=True)]
    entries.append(Line2D([], [], label="unworn indenter", **UNWORN))
    entries.append(Line2D([], [], label="allowed", color="k", marker=r"$\mathrm{I}$", markersize=7.0, linestyle=""))
    spacing = {"handlelength": 2.4, "columnspacing": 1.0, "handletextpad": 0.5}
    figure.legend(handles=entries, loc="upper center", ncols=5, frameon=False, fontsize=TICK_SIZE, **spacing)
    return figure
