"""Section 3 of the paper: fretting."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase
from matplotlib.patches import Polygon

from plgwear_jax import fretting
from plgwear_jax.figures.claims import Claim, of_paper, whether
from plgwear_jax.figures.style import (
    AMPLITUDES,
    ARROW,
    BLACK,
    BLUE,
    BODY,
    COLUMN,
    DASH_DOT,
    DASHED,
    DOTTED,
    EXPONENTS,
    GUIDE,
    NOTE,
    OF_AMPLITUDE,
    OF_EXPONENT,
    PAGE,
    PAIRS,
    RED,
    SPAN,
    THIN,
    bare,
    draw_arrow,
    ground,
    letters,
    of_k,
)
from plgwear_jax.figures.text_numbers import modulus_factor, numbers


def _check_paraboloid() -> list[Claim]:
    k, phi = np.array(EXPONENTS), np.array(AMPLITUDES)[:, None]
    stick, edge = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    r = np.linspace(0.0, 1.0, 50)[:, None, None] * stick
    same = bool(np.all(np.asarray(fretting.wear_depth(r, k, phi)) == 0.0))
    return [
        Claim(
            "in the stick area the final profile coincides with the initial one; around it is a worn ring",
            "f∞ = f0 at all r < c, and c < a0 < a∞ at all nine pairs of k and φ drawn in Fig. 8",
            whether(same and bool(np.all(stick < 1.0) and np.all(edge > 1.0))),
        )
    ]


@of_paper("6", "Fig. 6", "Partial slip of a parabolic indenter, set-up", (PAGE, 5.2), _check_paraboloid)
def fretting_set_up(page: FigureBase) -> None:
    """Fig. 6: a parabolic indenter in the initial and in the steady state; drawn for k = 0.3, φ = 0.7."""
    panels = page.subplots(1, 2)
    k, phi, height, sides, bottom = 0.3, 0.7, 0.62, 2.35, 1.3
    top = -1.15
    r = np.linspace(0.0, 1.0, 301) ** 2 * sides
    stick, edge = float(fretting.stick_radius(k, phi)), float(fretting.worn_radius(k, phi))
    flat, final = fretting.penetration(k, 0.0), fretting.penetration(k, phi)
    states = (
        (fretting.initial_displacement(r, k), 0.5 * r**2, flat, "a_0", 1.0),
        (fretting.steady_displacement(r, k, phi), fretting.profile(r, k, phi), final, r"a_\infty", edge),
    )
    for axes, (surface, profile, deep, name, outer) in zip(panels, states, strict=True):
        deep = height * float(deep)
        ground(axes, r, height * np.asarray(surface), bottom)
        shape = deep - height * np.asarray(profile)
        inside = shape > -0.55
        right = [*zip(r[inside], shape[inside], strict=True)]
        lid = [(right[-1][0], -0.62), (-right[-1][0], -0.62)]
        axes.add_patch(Polygon([*right, *lid, *((-x, z) for x, z in reversed(right))], **BODY))
        axes.plot([-sides, sides], [0.0, 0.0], color="0.3", linewidth=0.7, linestyle=DOTTED, zorder=5)
        axes.plot([0.0, 0.0], [-0.62, deep], color="0.3", linewidth=0.6, linestyle=DASH_DOT, zorder=5)
        draw_arrow(axes, (0.0, -1.1), (0.0, -0.62), ARROW)
        draw_arrow(axes, (0.0, -0.42), (-0.55, -0.42), ARROW)
        draw_arrow(axes, (0.0, -0.42), (0.55, -0.42), ARROW)
        axes.text(0.08, -0.95, "$F_N$", fontsize=9, va="center", zorder=7)
        axes.text(0.6, -0.42, "$F_x$", fontsize=9, va="center", zorder=7)
        for level, radius, text in ((deep + 0.14, stick, "c"), (deep + 0.42, outer, name)):
            start = deep - height * float(fretting.profile(radius, k, phi if outer == edge else 0.0))
            axes.plot([radius, radius], [start, level + 0.06], color="0.2", linewidth=0.5, zorder=5)
            draw_arrow(axes, (0.0, level), (radius, level), SPAN)
            axes.text(0.5 * radius, level + 0.01, f"${text}$", fontsize=9, ha="center", va="top", zorder=7)
        draw_arrow(axes, (-1.75, 0.0), (-1.75, deep), SPAN)
        axes.plot([-1.85, 0.0], [deep, deep], color="0.2", linewidth=0.5, zorder=5)
        axes.text(-1.68, 0.6 * deep, "$d_0$" if outer == 1.0 else r"$d_\infty$", fontsize=9, va="center", zorder=7)
        bare(axes, sides, top, bottom)
    worn = np.linspace(stick, edge, 101)
    deep = height * float(fretting.penetration(k, phi))
    for side in (-1.0, 1.0):
        panels[1].plot(side * worn, deep - height * 0.5 * worn**2, color="k", linewidth=0.7, linestyle=DASHED, zorder=5)
        gone = [deep - height * 0.5 * worn**2, deep - height * np.asarray(fretting.profile(worn, k, phi))]
        panels[1].fill_between(
            side * worn, *gone, facecolor="#BFDDEE", edgecolor=BLUE, hatch="////", linewidth=0.0, zorder=3.5
        )
    letters(panels, ("initial state", "steady state"))


_GRID = np.concatenate([np.geomspace(1e-6, 0.01, 40), np.linspace(0.02, 0.99, 98)])


def _check_radii() -> list[Claim]:
    n = numbers()
    inner = np.asarray(fretting.stick_radius(np.array(EXPONENTS)[:, None], _GRID))
    outer = np.asarray(fretting.worn_radius(np.array(EXPONENTS)[:, None], _GRID))
    grows, falls = bool(np.all(np.diff(inner, axis=0) > 0.0)), bool(np.all(np.diff(outer, axis=0) < 0.0))
    crossings = [n[f"rings_{name}"] for name in ("pair", "stiff", "compliant")]
    place = int(np.flatnonzero(np.isclose(_GRID, 0.5))[0])
    return [
        Claim(
            "the larger the exponent the larger the stick radius c",
            "at φ = 0.5 and k = −0.5, 0, 0.5: c = " + ", ".join(f"{x:.4f}" for x in inner[:, place]) + " a0",
            whether(grows),
        ),
        Claim(
            "the larger the exponent the smaller the outer radius a∞",
            "at φ = 0.5 and k = −0.5, 0, 0.5: a∞ = " + ", ".join(f"{x:.4f}" for x in outer[:, place]) + " a0; "
            f"it holds below φ = {min(crossings):.5f}, the opposite above {max(crossings):.5f}, close to gross slip",
            whether(False, in_part=falls),
        ),
    ]


@of_paper("7", "Fig. 7", "Inner and outer radius of the worn ring", (COLUMN, 7.0), _check_radii)
def edge_radii(page: FigureBase) -> None:
    """Fig. 7: inner and outer radius of the worn ring, c and a∞, over φ for k = −0.5, 0, 0.5; Eqs. (16), (26)."""
    axes = page.subplots()
    phi = 1.0 - np.linspace(1.0, 0.03, 241) ** 2
    for k, style in OF_EXPONENT.items():
        axes.plot(phi, np.asarray(fretting.worn_radius(k, phi)), label=of_k(k), **style)
        axes.plot([*phi, 1.0], [*np.asarray(fretting.stick_radius(k, phi)), 0.0], **style)
    axes.axhline(1.0, **GUIDE)
    axes.text(0.66, 1.92, r"$a_\infty/a_0$", ha="right", fontsize=9)
    axes.text(0.66, 0.52, "$c/a_0$", ha="right", fontsize=9)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 3.0), xlabel=r"$F_x/(\mu F_N)$", ylabel=r"$c/a_0,\ a_\infty/a_0$")
    axes.legend(loc="upper left")


def _check_factors() -> list[Claim]:
    n = numbers()
    found = []
    for name, k, printed in (("stiff", -0.5, 0.88), ("compliant", 0.5, 2.06)):
        factor, half, other = n[f"factor_{name}"], n[f"factor_{name}_half"], n[f"modulus_{name}"]
        found.append(
            Claim(
                f"{printed} E0 for k = {k:g}".replace("-", "−"),
                f"{factor:.4f} times E0/(1−ν²) with Holl's ratio in h_N; with ν = 1/2 in all it is {half:.4f}, "
                f"and {other:.4f} times E0 itself with Holl's ratio throughout",
                whether(round(factor, 2) == printed),
            )
        )
    return found


@of_paper("eq-27", "Eq. (27)", "Three materials with the same contact radius", (COLUMN, 6.2), _check_factors)
def gradients_of_equal_contact(page: FigureBase) -> None:
    """Eq. (27): the moduli over the depth of three materials with the same contact radius under the same force."""
    axes = page.subplots()
    z = np.linspace(0.0, 1.0, 301)[1:] ** 3 * 3.0
    for k, style in OF_EXPONENT.items():
        factor = modulus_factor(k, "holl")
        law = rf"{factor:.2f}\, E_0\, (z/a_0)^{{{k:g}}}" if k else "E_0"
        axes.plot(z, factor * z**k, label=f"$E(z) = {law}$", **style)
    axes.set(xlim=(0.0, 3.0), ylim=(0.0, 5.0), xlabel="$z/a_0$", ylabel="$E(z)/E_0$")
    axes.set_xticks(range(4))
    axes.legend(loc="upper right")


def _rows(values: np.ndarray, form: str) -> str:
    rows = (", ".join(format(x, form) for x in row) for row in values)
    return "; ".join(f"{row} at φ = {phi:g}" for row, phi in zip(rows, AMPLITUDES, strict=True))


_OF_PHI: dict[float, dict[str, Any]] = {
    phi: style | {"label": rf"$F_x/(\mu F_N) = {phi:g}$"} for phi, style in zip(AMPLITUDES, OF_AMPLITUDE, strict=True)
}


def _label_column(page: FigureBase, panels: Sequence[Axes]) -> None:
    """Label a column of panels, one for each exponent, with one legend and one axis for all of them."""
    page.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    panels[-1].set_xlabel("$r/a_0$")
    letters(panels, [of_k(k) for k in EXPONENTS])


def _check_profiles() -> list[Claim]:
    k, phi = np.array(EXPONENTS), np.array(AMPLITUDES)[:, None]
    inner, outer = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    area, deepest = outer**2 - inner**2, np.asarray(fretting.deepest_wear(k, phi))
    bend, volume = 8.0 * deepest / (outer - inner) ** 2, np.asarray(fretting.wear_volume(k, phi))
    n = numbers()
    return [
        Claim(
            "in all cases the wear volume grows with the amplitude",
            f"ΔV in a0⁴/R for k = −0.5, 0, 0.5: {_rows(volume, '.4f')}",
            whether(bool(np.all(np.diff(volume, axis=0) > 0.0))),
        ),
        Claim(
            "the wear volume is greater for negative exponents than for k = 0, and smaller for positive ones",
            "so it is at these amplitudes, and wherever φ is between "
            f"{max(n['turn_stiff'], n['turn_compliant']):.4f} and {min(n['return_stiff'], n['return_compliant']):.4f}",
            whether(bool(np.all(np.diff(volume, axis=1) < 0.0))),
        ),
        Claim(
            "the entire worn area decreases with the exponent",
            f"(a∞² − c²)/a0² for k = −0.5, 0, 0.5: {_rows(area, '.4f')}",
            whether(bool(np.all(np.diff(area, axis=1) < 0.0))),
        ),
        Claim(
            "the amount of curvature of the worn area increases with the exponent",
            f"8 (deepest wear)/(a∞ − c)² in 1/R for k = −0.5, 0, 0.5: {_rows(bend, '.3f')}",
            whether(bool(np.all(np.diff(bend, axis=1) > 0.0))),
        ),
    ]


@of_paper("8", "Fig. 8", "Limiting profiles for three amplitudes and exponents", (COLUMN, 14.5), _check_profiles)
def limiting_profiles(page: FigureBase) -> None:
    """Fig. 8: limiting profiles of the indenter for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5, Eq. (25).

    The contact radius is the same for all, as by Eq. (27). Dots mark the edges of the worn ring.
    """
    panels = page.subplots(3, 1, sharex=True, sharey=True)
    r = np.linspace(0.0, 2.0, 401)
    for k, axes in zip(EXPONENTS, panels, strict=True):
        axes.plot(r, 0.5 * r**2, label="unworn", **THIN)
        for phi, style in _OF_PHI.items():
            inner, outer = float(fretting.stick_radius(k, phi)), float(fretting.worn_radius(k, phi))
            # dense close to the stick edge, where the profile rises like a power of the distance
            ring = inner + (outer - inner) * np.linspace(0.0, 1.0, 201) ** 3
            axes.plot(ring, np.asarray(fretting.profile(ring, k, phi)), **style)
            axes.plot([inner, outer], [0.5 * inner**2, 0.5 * outer**2], ".", color=style["color"], markersize=4.0)
        axes.set(xlim=(0.0, 2.0), ylim=(0.0, 1.6), ylabel=r"$f_\infty\, R/a_0^2$")
        axes.set_xticks([0.0, 0.5, 1.0, 1.5, 2.0])
    _label_column(page, panels)


def _check_volumes() -> list[Claim]:
    n = numbers()
    pair = [n["turn_widest"], n["turn_pair"], n["turn"]]
    phi = np.linspace(0.3, 0.99, 139)
    large = np.asarray(fretting.wear_volume(np.array(EXPONENTS)[:, None], phi))
    again = [n["return_pair"], n["return_compliant"]]
    return [
        Claim(
            "below about 20 % of μ F_N a compliant surface over a stiff interior wears more",
            f"the volumes of −k and k cross at φ = {pair[0]:.4f} (|k| = 0.99), {pair[1]:.4f} (0.5) and {pair[2]:.4f} "
            "(k → 0)",
            whether(all(round(x, 1) == 0.2 for x in pair)),
        ),
        Claim(
            "in that range a negative exponent would reduce wear",
            f"k = −0.5 wears less than k = 0 below φ = {n['turn_stiff']:.4f} only, k = −0.99 below "
            f"{n['turn_stiffest']:.4f}; k = 0.5 wears more up to {n['turn_compliant']:.4f}",
            whether(n["turn_stiff"] >= 0.195, in_part=n["turn_stiff"] > 0.1),
        ),
        Claim(
            "high amplitudes require a positive exponent to minimize wear",
            f"of k = −0.5, 0 and 0.5 the last wears least from φ = {n['turn_compliant']:.4f} to {min(again):.4f}, "
            f"and most from {max(again):.4f} on, close to gross slip",
            whether(False, in_part=bool(np.all(np.diff(large, axis=0) < 0.0))),
        ),
    ]


@of_paper("9", "Fig. 9", "Wear volume over the amplitude", (PAGE, 7.6), _check_volumes)
def wear_volumes(page: FigureBase) -> None:
    """Fig. 9: the wear volume of Eq. (28) over φ, orange and dashed for negative exponents, blue for positive ones.

    (a) As in the paper; (b) over that of k = 0, at small amplitudes; (c) the same close to gross slip.
    """
    whole, low, high = page.subplots(1, 3)
    dashes, widths = (DOTTED, (0, (3, 1.4)), (0, (7, 1.6))), (0.8, 1.2, 1.8)
    curves: list[tuple[float, dict[str, Any]]] = [
        (-k, {"color": RED, "linestyle": dash}) for k, dash in zip(PAIRS[::-1], dashes[::-1], strict=True)
    ]
    curves += [(0.0, {"color": BLACK, "linestyle": DASH_DOT, "linewidth": 1.0})]
    curves += [(k, {"color": BLUE, "linewidth": width}) for k, width in zip(PAIRS, widths, strict=True)]
    phi, left = 1.0 - np.linspace(1.0, 0.2, 161) ** 2, np.geomspace(0.1, 1e-5, 161)
    small = 0.4 * np.linspace(0.0, 1.0, 161)[1:] ** 3
    for k, style in curves:
        whole.plot(phi, np.asarray(fretting.wear_volume(k, phi)), label=of_k(k), **style)
        for axes, x, some in ((low, small, small), (high, left, 1.0 - left)):
            axes.plot(x, np.asarray(fretting.wear_volume(k, some) / fretting.wear_volume(0.0, some)), **style)
    turn = numbers()["turn"]
    low.axvline(turn, **GUIDE)
    low.annotate("about 20 %", (turn, 1.88), (4, 0), textcoords="offset points", va="center", **NOTE)
    amplitude, ratio = r"$F_x/(\mu F_N)$", r"$\Delta V/\Delta V(k=0)$"
    whole.set(xlim=(0.0, 1.0), ylim=(0.0, 1.2), xlabel=amplitude, ylabel=r"$\Delta V\, R/a_0^4$")
    low.set(xlim=(0.0, 0.4), ylim=(0.0, 2.0), xlabel=amplitude, ylabel=ratio)
    high.set(xlim=(0.1, 1e-5), ylim=(0.05, 20.0), xscale="log", yscale="log", xlabel=f"$1 - ${amplitude}", ylabel=ratio)
    low.set_xticks([0.0, 0.1, 0.2, 0.3, 0.4])
    low.set_yticks([0.0, 0.5, 1.0, 1.5, 2.0])
    high.set_yticks([0.1, 1.0, 10.0], ["0.1", "1", "10"])
    whole.legend(loc="upper left")
    letters([whole, low, high])


def _check_pressures() -> list[Claim]:
    k = np.array(EXPONENTS)
    stick = np.asarray(fretting.stick_radius(k, np.array(AMPLITUDES)[:, None]))
    near = np.array([1e-10, 1e-11])[:, None] * stick[1]
    order = [
        np.diff(np.log(np.asarray(field)), axis=0)[0] / math.log(10.0)
        for field in (fretting.edge_pressure(near, k, AMPLITUDES[1]), _traction(near, k, AMPLITUDES[1]))
    ]
    mean = 1.0 / stick**2
    orders = ["; ".join(f"{x:.3f}" for x in some) for some in order]
    return [
        Claim(
            "the stick radius grows with the exponent, which means a lower mean pressure",
            f"F_N/(π c²) over F_N/(π a0²) for k = −0.5, 0, 0.5: {_rows(mean, '.3f')}",
            whether(bool(np.all(np.diff(mean, axis=1) < 0.0))),
        ),
        Claim(
            "the stress singularity becomes milder with the exponent",
            f"p∞ grows like δ^−n with n = {orders[0]} for k = −0.5, 0, 0.5",
            whether(bool(np.all(np.diff(order[0]) < 0.0) and np.allclose(order[0], 0.5 * (1 - k), atol=1e-3))),
        ),
        Claim(
            "the same applies to the tangential stresses according to Eq. (21)",
            f"τ∞ grows like δ^−n with n = {orders[1]}",
            whether(bool(np.all(np.diff(order[1]) < 0.0) and np.allclose(order[1], 0.5 * (1 - k), atol=1e-3))),
        ),
    ]


def _traction(distance: np.ndarray, k: np.ndarray, phi: float) -> np.ndarray:
    return np.asarray(fretting.steady_traction(np.asarray(fretting.stick_radius(k, phi)) - distance, k, phi))


@of_paper("10", "Fig. 10", "Pressures in the fully worn state", (COLUMN, 14.5), _check_pressures)
def worn_pressures(page: FigureBase) -> None:
    """Fig. 10: the pressure of Eq. (17) in the worn state for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5.

    It is printed as a second Fig. 9. Dotted lines mark the stick radius.
    """
    panels = page.subplots(3, 1, sharex=True, sharey=True)
    r = np.sin(np.linspace(0.0, 0.5 * np.pi, 301))
    for k, axes in zip(EXPONENTS, panels, strict=True):
        axes.plot(r, np.asarray(fretting.initial_pressure(r, k)), label="unworn", **THIN)
        for phi, style in _OF_PHI.items():
            stick = float(fretting.stick_radius(k, phi))
            inside = stick * (1.0 - np.geomspace(1.0, 1e-9, 401))
            axes.plot(inside, np.asarray(fretting.steady_pressure(inside, k, phi)), **style)
            axes.axvline(stick, **GUIDE | {"color": style["color"]})
        axes.set(xlim=(0.0, 1.05), ylim=(0.0, 5.0), ylabel=r"$p_\infty\, \pi a_0^2/F_N$")
    _label_column(page, panels)
