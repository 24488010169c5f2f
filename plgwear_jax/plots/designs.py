"""Pictures of designs beside their references, of trade-offs, of measured coatings and of free gradients."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plgwear_jax._core.catalogue import entry, leaf, measured, placed
from plgwear_jax._core.rules import is_linear
from plgwear_jax.optimise import Comparison, Design, FreeDesign, Front, compared
from plgwear_jax.optimise.afterwards import evaluated_along
from plgwear_jax.optimise.ask_and_tell import INFINITE
from plgwear_jax.optimise.best import less
from plgwear_jax.optimise.evaluation import evaluate, space
from plgwear_jax.optimise.question import keeps
from plgwear_jax.optimise.search import scanned
from plgwear_jax.special.pchip import horner

from .style import (
    BEST,
    BLUE,
    DOT,
    FORBIDDEN,
    GUIDE,
    OTHER,
    REFERENCE,
    ROUGHNESS,
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

if TYPE_CHECKING:
    from plgwear_jax.coating import Idealisation, PowerLawFit

_FELT: Style = {"zorder": -1, "color": "0.9", "linewidth": 0.0}
_SYMBOLS = "$a_0$: contact radius before wear"
_RING = rf"{_SYMBOLS}; $c$, $a_\infty$: stick radius and outer radius of the worn ring, dotted"


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
    comparison = comparison or compared(design)
    found = comparison.quantities
    radius = found.get("contact_radius", (None, design.reference.radius))[1]
    best = "best" if design.keeps_limits else "closest design, limits violated"
    labels = [
        f"{words}, $k = {float(its.material.k):.3g}$" if hasattr(its.material, "k") else words  # pyright: ignore
        for words, its in ((best, design.contact), ("reference", design.reference))
    ]
    figure, panels = _three_panels(comparison.depths, comparison.modulus, labels, radius, design.windows)
    _draw_objective(panels[1], design)
    end, symbols = r"$a_\infty$", _RING
    if "worn_radius" not in found:
        end, symbols = "$a$", f"{_SYMBOLS}; $a$: contact radius when worn, dotted"
    words = r"worn off the face, $d - w_\infty$" if design.load is None else None
    _draw_depths(panels[2], comparison.radii, comparison.depth, (BEST, REFERENCE), end, words)
    saved = f"{best}: {less(design.saving)} {entry(design.objective).name} than the reference"
    kept = keeps(evaluate(design.question, design.reference_variables).values[0, 1:])
    breaks = "" if kept else ", which breaks a limit"
    told = [
        f"{entry(one.quantity).name} {'at least' if one.lowest else 'at most'} {measured(one.quantity, one.allowed)}"
        for one in design.limits.values()
        if one.quantity not in ("modulus_at", design.hold)  # which are drawn as bars, or kept
    ]
    limits = f"\nlimits: {', '.join(told)}" if told else ""
    return _explained(figure, panels, f"{saved}{breaks}{limits}\n{_conditions(design)}\n{symbols}")


def _conditions(design: Design) -> str:
    """The load and the contact, which both designs have in common, in words."""
    contact, load = design.reference, design.load
    if load is None:
        radius, depth = (measured(name, getattr(contact, name)) for name in ("radius", "depth"))
        return f"flat punch of radius {radius}, pressed {depth} deep"
    told = "blocks of amplitudes"
    if load.amplitudes is not None:
        name = "tangential_force" if load.load.holds_force else "displacement"
        several = "up to " if np.count_nonzero(load.weight) > 1 else ""
        told = f"amplitude ${entry(name).symbol}$ = {several}{measured(name, np.max(load.amplitudes))}"
        if load.load.holds_force:
            told += rf" ({100.0 * float(np.max(design.question.phi)):.2g} % of $\mu F_N$)"
    given = {name: getattr(contact, name) for name in ("normal_force", "friction", "radius")}
    words = [f"${entry(name).symbol}$ = {measured(name, value)}" for name, value in given.items()]
    indenter = getattr(contact, "indenter", None)
    body = "rigid indenter" if indenter is None else f"indenter of {measured('indenter.E', indenter.E)}"
    return ", ".join([told, *words, body])


def _three_panels(
    depths: Any, moduli: Any, labels: Sequence[str], radius: Any, windows: Any = ()
) -> tuple[Figure, Any]:
    """A page whose first panel has moduli over the depth, with bars between the lowest and the highest one allowed."""
    figure = page(18.0, 8.4)
    panels = figure.subplots(1, 3)
    axes = panels[0]
    for modulus, words, style in zip(moduli, labels, (BEST, REFERENCE, OTHER), strict=False):
        axes.loglog(depths, modulus, label=words, **style)
    if len(windows):
        z, *ends = np.asarray(windows).T
        told = {
            f"{a:.4g} to {b:.4g}" if a < b else f"at most {b:.4g}" if np.isnan(a) else f"at least {a:.4g}"
            for a, b in np.transpose(ends) / 1e9
        }
        low, high = np.where(np.isnan(ends), np.array([axes.get_ylim()]).T, ends)
        words = f": {' and '.join(sorted(told))} GPa" if len(told) < 3 else ""
        axes.errorbar(z, 0.5 * (low + high), 0.5 * (high - low), fmt="none", ecolor="k", elinewidth=0.8,
                      capsize=2.0, label=f"allowed modulus{words}")  # fmt: skip
    mark(axes, radius, "$a_0$")
    show_units(axes.xaxis, "depth", size=radius)
    show_units(axes.yaxis, "modulus", size=1e11)
    return figure, panels


def _explained(figure: Figure, panels: Any, words: str) -> Figure:
    """Letters, the legend above all panels, and below them what they have in common."""
    letters(panels)
    legend_above(figure, panels, 3)
    figure.supxlabel(words, fontsize=7, color="0.3")
    return figure


def _draw_depths(
    axes: Axes, radii: Any, depths: Any, styles: Sequence[Style], end: str = r"$a_\infty$", words: str | None = None
) -> None:
    """Draw wear depths over the radii of rings, and the roughness of a ground surface; elsewhere nothing is worn."""
    axes.margins(x=0.05)
    for r, depth, style in zip(radii, depths, styles, strict=True):
        axes.plot(r, depth, **style)
        for edge in filter(None, r[[0, -1]]):  # all of a punch, and after cycles, is drawn from the axis on
            axes.axvline(edge, **GUIDE | {"color": style["color"]})
    for edge, symbol in zip(radii[-1][[0, -1]], ("$c$", end), strict=True):
        if edge > 0.0:
            mark(axes, edge, symbol)
    if not mark_roughness(axes, np.max(depths)):
        axes.set_title(f"below the roughness, {ROUGHNESS}", loc="right")
    label(axes, "r", "wear_depth", words or entry("wear_depth").name)


def _draw_objective(axes: Axes, design: Design) -> None:
    bounds = design.bounds
    name = next((name for name in ("k", "E0", "z0") if name in bounds), next(iter(bounds)))
    here, there = design.variables[name], design.reference_variables[name]
    # Asked where the search may have solved the contact already; in between by cubics with the known slopes.
    values = np.unique([*scanned(space(design.question)[name]), here])
    at = evaluated_along(design, name, values)
    on_scale, back = (np.asarray, np.asarray) if is_linear(name) else (np.log, np.exp)
    rows, x = at.rows[..., [0, 1 + list(bounds).index(name)]], on_scale(values)
    value, slope = (
        np.nan_to_num(rows[..., i], nan=most, posinf=most, neginf=-most) for i, most in enumerate((INFINITE, 0.0))
    )
    fine = np.union1d(x, np.linspace(x[0], x[-1], 400))
    first = np.clip(np.searchsorted(x, fine, "right") - 1, 0, x.size - 2)
    step = np.diff(x)[:, None]
    chord, begin, end = np.diff(value, axis=0) / step, slope[:-1], slope[1:]
    cubics = value[:-1], begin, (3.0 * chord - 2.0 * begin - end) / step, (begin + end - 2.0 * chord) / step**2
    smooth = horner([one[first] for one in cubics], (fine - x[first])[:, None])
    smooth[np.interp(fine, x, ~np.isfinite(rows[:, 0, 0])) > 0.0] = np.nan
    curve, kept = 100.0 * (np.exp(smooth[:, 0]) * at.scale / design.reference_value - 1.0), keeps(smooth[:, 1:])
    values = back(fine)
    axes.set(xscale="linear" if is_linear(name) else "log", xmargin=0.05, ymargin=0.2)
    axes.plot(values, np.where(kept, curve, np.nan), color="0.2")
    axes.plot(there, 0.0, "s", color=REFERENCE["color"], **DOT)
    axes.plot(here, -100.0 * design.saving, "o", color=BLUE, **DOT)
    axes.axhline(0.0, **GUIDE)
    axes.set_title(less(design.saving), loc="right")
    low, high = axes.get_ylim()
    if not np.all(kept):  # it may be far from all that counts, and is cut off there
        seen = np.where((low < curve) & (curve < high), curve, np.nan)
        axes.plot(values, seen, label="breaks a limit", **FORBIDDEN)
    axes.set_ylim(low, high)
    others = "\nall else as in the best design" if len(bounds) > 1 else ""
    show_units(axes.xaxis, name, leaf(name).label)
    axes.set_xlabel(axes.get_xlabel() + others)
    if is_linear(name):  # labels such as -0.25 are wide
        axes.locator_params("x", nbins=5)
    minimised = entry(design.objective)
    several = design.load is not None and np.count_nonzero(design.load.weight) > 1
    axes.set_ylabel(f"change of {f'mean {minimised.name}' if several else minimised.label} (%)")


@picture
def front_picture(front: Front) -> Figure:
    """Draw the front, the best y for each x, beside the reference, and the variables along it.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Designs that are not certified are hollow. Below stands what ends the front on both sides: a variable at its bound,
    another limit, or that no better one exists.

    Args:
        front: The result of `optimise.front`.

    Returns:
        A figure 7 cm wide and 7 cm more for each variable; `save` writes it.
    """
    columns = {front.y_name: front.y, **front.variables}
    figure = page(7.0 * len(columns), 7.0)
    panels = figure.subplots(1, len(columns), sharex=True, squeeze=False)[0]
    for axes, (name, values) in zip(panels, columns.items(), strict=True):
        axes.plot(front.x, values, label=f"{front.best[1]} for this {entry(front.x_name).name}", **BEST)
        axes.margins(x=0.05)
        axes.scatter(front.x, values, s=12.0, color=np.where(front.certified, BLUE, "w"), edgecolors=BLUE)
        if np.ptp(values) < 1e-6 * np.max(np.abs(values)):  # else the axis would show rounding errors
            axes.set_ylim(*np.sort(values[0] * np.array([0.5, 1.5])))
        show_units(axes.yaxis, name, leaf(name).label, size=np.max(values))
    letters(panels)
    axes = panels[0]
    axes.plot(front.reference_x, front.reference_y, "s", color=REFERENCE["color"], label="reference", **DOT)
    axes.set_ylim(0.0, 1.1 * axes.dataLim.y1)
    legend_above(figure, axes, 2)
    for side, name, places in ((axes.yaxis, front.y_name, front.y_places), (axes.xaxis, front.x_name, front.x_places)):
        show_units(side, name, placed(name, places) if places else None)
    ended = (f"{best}: {end}" if end != best else best for best, end in zip(front.best, front.ends, strict=True))
    figure.supxlabel("\n".join([axes.get_xlabel(), *ended]), fontsize="medium")
    axes.set_xlabel("")
    return figure


@picture
def coating_picture(
    fit: "PowerLawFit",
    curve: tuple[np.ndarray, np.ndarray],
    counts: tuple[np.ndarray, np.ndarray],
    idealisation: "Idealisation",
    measured_radius: float | None = None,
) -> Figure:
    """Draw E(z) and its power law, how strongly each depth influences the wear, and the wear depths on both.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        fit: The result of `coating.fit_power_law`.
        curve: Depths in m, and the modulus in Pa that the contact was computed with, each of shape (n,).
        counts: The result of `coating.where_it_counts`.
        idealisation: The result of `coating.idealised`.
        measured_radius: A contact radius in m that was measured, if any.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    law, radii = fit.material, idealisation.quantities["contact_radius"]
    labels = "$E(z)$ as given", f"power law, $k = {law.k:.3g}$"
    figure, panels = _three_panels(curve[0], (curve[1], law.modulus_at(curve[0])), labels, radii[0])
    panels[0].plot(fit.depth, fit.modulus, "o", color=BLUE, markersize=3.0)
    _draw_influence(panels, counts, radii[0])
    panels[0].axvspan(*fit.felt, label="0.1 to 3 contact radii", **_FELT)
    panels[1].axvspan(*fit.felt, **_FELT)
    _draw_depths(panels[2], idealisation.radii, idealisation.wear_depth, (BEST, REFERENCE))
    told = " and ".join(measured("contact_radius", radius) for radius in radii)
    beside = "" if measured_radius is None else f"; measured: {measured('contact_radius', measured_radius)}"
    words = f"contact radius on $E(z)$ and on the power law: {told}{beside}\n{_RING}"
    return _explained(figure, panels, words)


def _draw_influence(panels: Any, counts: Any, radius: float) -> None:
    """Draw in the second panel how strongly the modulus at each depth influences the wear."""
    axes = panels[1]
    axes.axhline(0.0, color="0.5", linewidth=0.6)
    axes.semilogx(*counts, marker="o", markersize=2.5, **BEST)
    axes.set_xlim(panels[0].get_xlim())
    axes.set_ylabel(r"$\partial\ln\Delta V\,/\,\partial\ln E$ per decade of depth")
    show_units(axes.xaxis, "depth", size=radius)
    mark(axes, radius, "$a_0$")


@picture
def free_picture(
    found: FreeDesign, curves: Sequence[np.ndarray], counts: tuple[np.ndarray, np.ndarray], worn: np.ndarray
) -> Figure:
    """Draw the best E(z), the best power law and the reference, the influence of each depth, and the wear depths.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `optimise.free_design`.
        curves: Depths in m, then the moduli in Pa at these depths of the best E(z), the power law and the reference,
            each of shape (n,).
        counts: The result of `coating.where_it_counts` for the best E(z).
        worn: Radii from edge to edge of the worn ring, and wear depths, in m, of the best E(z), the power law and the
            reference, shape (2, 3, n).

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    depths, best, law, reference = curves
    labels = "best free gradient", "reference", f"best power law, $k = {found.exponent:.3g}$"
    profile, radius = found.profile, found.contact_radii[0]
    bounds = np.stack([profile.at, profile.lower, profile.upper], -1)
    figure, panels = _three_panels(depths, (best, reference, law), labels, radius, bounds)
    _draw_influence(panels, counts, radius)
    _draw_depths(panels[2], worn[0], worn[1], (BEST, OTHER, REFERENCE))
    name = entry(found.objective).name
    told = f"{less(found.saving)} {name} than the reference, {less(found.freedom)} than the best power law"
    return _explained(figure, panels, f"best free gradient: {told}\n{_RING}")
