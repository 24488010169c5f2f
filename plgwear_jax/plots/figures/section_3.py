"""Section 3 of the paper: fretting."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase

from plgwear_jax import fretting
from plgwear_jax.plots.figures.paper import (
    AMPLITUDES,
    COLUMN,
    EXPONENTS,
    OF_AMPLITUDE,
    OF_EXPONENT,
    PAGE,
    PAIRS,
    WORN,
    Claim,
    arrow,
    crowded,
    listed,
    modulus_factor,
    numbers,
    of_k,
    of_paper,
    rising,
    sketch,
)
from plgwear_jax.plots.style import BLUE, DASHED, GUIDE, ORANGE, Style, legend_above, letters

_PHI = AMPLITUDES[:, None]
_THIN: Style = {"color": "0.45", "linewidth": 0.7, "label": "unworn"}
_AMPLITUDE = r"amplitude $F_x/(\mu F_N)$"


def _by_amplitude(values: Any, form: str) -> str:
    """Values at all pairs of k, along the columns, and φ."""
    rows = (", ".join(format(x, form) for x in row) for row in values)
    told = "; ".join(f"{row} at φ = {phi:g}" for row, phi in zip(rows, AMPLITUDES, strict=True))
    return f"for k = −0.5, 0, 0.5: {told}"


def _radii() -> tuple[Any, Any]:
    return fretting.stick_radius(EXPONENTS, _PHI), fretting.worn_radius(EXPONENTS, _PHI)


def _check_paraboloid() -> list[Claim]:
    stick, edge = _radii()
    inside = fretting.wear_depth(np.linspace(0.0, 1.0, 50)[:, None, None] * stick, EXPONENTS, _PHI)
    return [
        Claim(
            "in the stick area the final profile coincides with the initial one; around it is a worn ring",
            "f∞ = f0 at all r < c, and c < a0 < a∞ at all nine pairs of k and φ drawn in Fig. 8",
            bool(np.all(inside == 0.0) and np.all(stick < 1.0) and np.all(edge > 1.0)),
        )
    ]


@of_paper("6", "Fig. 6", "Partial slip of a parabolic indenter, set-up", (PAGE, 5.2), _check_paraboloid)
def fretting_set_up(page: FigureBase) -> None:
    """Fig. 6: a parabolic indenter in the initial and in the steady state; drawn for k = 0.3, φ = 0.7."""
    panels = page.subplots(1, 2)
    k, height, r = 0.3, 0.62, np.linspace(0.0, 1.0, 301) ** 2 * 2.35
    stick, edge, deep = fretting.stick_radius(k, 0.7), 1.0, 0.0
    for axes, phi, index in zip(panels, (0.0, 0.7), ("0", r"\infty"), strict=True):
        deep, edge = height * fretting.penetration(k, phi), fretting.worn_radius(k, phi)
        z = deep - height * fretting.profile(r, k, phi)
        seen = z > -0.55
        body = [*r[seen], r[seen][-1]], [*z[seen], -0.62]
        sketch(axes, (r, height * fretting.steady_displacement(r, k, phi)), body, deep, -1.15, 1.3)
        arrow(axes, (0.0, -1.1), (0.0, -0.62), "$F_N$", (0.25, -0.95))
        arrow(axes, (-0.55, -0.42), (0.55, -0.42), "$F_x$", (0.75, -0.42), "<|-|>")
        for level, radius, words in ((deep + 0.14, stick, "$c$"), (deep + 0.42, edge, f"$a_{index}$")):
            start = deep - height * fretting.profile(radius, k, phi)
            axes.vlines(radius, start, level + 0.06, color="0.2", linewidth=0.5, zorder=5)
            arrow(axes, (0.0, level), (radius, level), words, (0.5 * radius, level + 0.12), "<->")
        arrow(axes, (-1.75, 0.0), (-1.75, deep), f"$d_{index}$", (-1.55, 0.6 * deep), "<->")
    ring = np.linspace(stick, edge, 101)
    unworn, worn = (deep - height * z for z in (0.5 * ring**2, fretting.profile(ring, k, 0.7)))
    for side in (-1.0, 1.0):
        panels[1].plot(side * ring, unworn, color="k", linewidth=0.7, linestyle=DASHED, zorder=5)
        panels[1].fill_between(side * ring, unworn, worn, **WORN)
    letters(panels, ("initial state", "steady state"))


def _check_radii() -> list[Claim]:
    n, phi = numbers(), np.concatenate([np.geomspace(1e-6, 0.01, 40), np.linspace(0.02, 0.98, 97)])
    inner, outer = fretting.stick_radius(EXPONENTS[:, None], phi), fretting.worn_radius(EXPONENTS[:, None], phi)
    crossings = [n[f"rings_{name}"] for name in ("pair", "stiff", "compliant")]
    return [
        Claim(
            "the larger the exponent the larger the stick radius c",
            f"at φ = 0.5 and {listed(fretting.stick_radius(EXPONENTS, 0.5), '.4f', 'c = ')} a0",
            rising(inner),
        ),
        Claim(
            "the larger the exponent the smaller the outer radius a∞",
            f"at φ = 0.5 and {listed(fretting.worn_radius(EXPONENTS, 0.5), '.4f', 'a∞ = ')} a0; it holds below "
            f"φ = {min(crossings):.5f}, the opposite above {max(crossings):.5f}, close to gross slip",
            False,
            rising(-outer),
        ),
    ]


@of_paper("7", "Fig. 7", "Inner and outer radius of the worn ring", (COLUMN, 7.0), _check_radii)
def edge_radii(page: FigureBase) -> None:
    """Fig. 7: inner and outer radius of the worn ring, c and a∞, over φ for k = −0.5, 0, 0.5; Eqs. (16), (26)."""
    axes = page.subplots()
    phi = 1.0 - np.linspace(1.0, 0.03, 241) ** 2
    for k, style in OF_EXPONENT.items():
        axes.plot(phi, fretting.worn_radius(k, phi), label=of_k(k), **style)
        axes.plot([*phi, 1.0], [*fretting.stick_radius(k, phi), 0.0], **style)
    axes.axhline(1.0, **GUIDE)
    axes.text(0.66, 1.92, r"$a_\infty/a_0$", ha="right", fontsize=9)
    axes.text(0.66, 0.52, "$c/a_0$", ha="right", fontsize=9)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 3.0), xlabel=_AMPLITUDE, ylabel=r"$c/a_0,\ a_\infty/a_0$")
    axes.legend(loc="upper left")


def _check_factors() -> list[Claim]:
    n, found = numbers(), []
    for name, k, printed in (("stiff", "−0.5", 0.88), ("compliant", "0.5", 2.06)):
        factor, half, other = n[f"factor_{name}"], n[f"factor_{name}_half"], n[f"modulus_{name}"]
        told = (
            f"{factor:.4f} times E0/(1−ν²) with Holl's ratio in h_N; with ν = 1/2 in all it is {half:.4f}, "
            f"and {other:.4f} times E0 itself with Holl's ratio throughout"
        )
        found.append(Claim(f"{printed} E0 for k = {k}", told, round(factor, 2) == printed))
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
    axes.legend(loc="upper right")


def _check_profiles() -> list[Claim]:
    (inner, outer), n = _radii(), numbers()
    area, deepest = outer**2 - inner**2, fretting.deepest_wear(EXPONENTS, _PHI)
    bend, volume = 8.0 * deepest / (outer - inner) ** 2, fretting.wear_volume(EXPONENTS, _PHI)
    ends = max(n["turn_stiff"], n["turn_compliant"]), min(n["return_stiff"], n["return_compliant"])
    told = f"so it is at these amplitudes, and wherever φ is between {ends[0]:.4f} and {ends[1]:.4f}"
    rows = (
        (
            "in all cases the wear volume grows with the amplitude",
            f"ΔV in a0⁴/R {_by_amplitude(volume, '.4f')}",
            volume.T,
        ),
        (
            "the wear volume is greater for negative exponents than for k = 0, and smaller for positive ones",
            told,
            -volume,
        ),
        ("the entire worn area decreases with the exponent", f"(a∞² − c²)/a0² {_by_amplitude(area, '.4f')}", -area),
        (
            "the amount of curvature of the worn area increases with the exponent",
            f"8 (largest wear depth)/(a∞ − c)² in 1/R {_by_amplitude(bend, '.3f')}",
            bend,
        ),
    )
    return [Claim(said, found, rising(grows, 1)) for said, found, grows in rows]


def _column(page: FigureBase, **frame: Any) -> Iterator[tuple[Axes, float]]:
    """A column of panels, each with its exponent, and the legend of what is drawn in them."""
    panels = page.subplots(3, 1, sharex=True, sharey=True)
    yield from zip(panels, EXPONENTS, strict=True)
    for axes in panels:
        axes.set(**frame)
    panels[-1].set_xlabel("$r/a_0$")
    letters(panels, map(of_k, EXPONENTS))
    legend_above(page, panels[0], 2)


@of_paper("8", "Fig. 8", "Limiting profiles for three amplitudes and exponents", (COLUMN, 14.5), _check_profiles)
def limiting_profiles(page: FigureBase) -> None:
    """Fig. 8: limiting profiles of the indenter for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5, Eq. (25).

    The contact radius is the same for all, as by Eq. (27). Dots mark the edges of the worn ring.
    """
    r = np.linspace(0.0, 2.0, 401)
    for axes, k in _column(page, xlim=(0.0, 2.0), ylim=(0.0, 1.6), ylabel=r"$f_\infty\, R/a_0^2$"):
        axes.plot(r, 0.5 * r**2, **_THIN)
        for phi, style in OF_AMPLITUDE.items():
            ends = np.array([fretting.stick_radius(k, phi), fretting.worn_radius(k, phi)])
            # dense close to the stick-slip boundary, where the profile rises like a power of the distance
            ring = ends[0] + np.ptp(ends) * np.linspace(0.0, 1.0, 201) ** 3
            axes.plot(ring, fretting.profile(ring, k, phi), **style)
            axes.plot(ends, 0.5 * ends**2, ".", color=style["color"], markersize=4.0)


def _check_volumes() -> list[Claim]:
    n = numbers()
    pair = n["turn_widest"], n["turn_pair"], n["turn"]
    large = fretting.wear_volume(EXPONENTS[:, None], np.linspace(0.3, 0.99, 139))
    again = n["return_pair"], n["return_compliant"]
    return [
        Claim(
            "below about 20 % of μ F_N a compliant surface over a stiff interior wears more",
            f"the volumes of −k and k cross at φ = {pair[0]:.4f} (|k| = 0.99), {pair[1]:.4f} (0.5) and {pair[2]:.4f} "
            "(k → 0)",
            all(round(x, 1) == 0.2 for x in pair),
        ),
        Claim(
            "in that range a negative exponent would reduce wear",
            f"k = −0.5 wears less than k = 0 below φ = {n['turn_stiff']:.4f} only, k = −0.99 below "
            f"{n['turn_stiffest']:.4f}; k = 0.5 wears more up to {n['turn_compliant']:.4f}",
            n["turn_stiff"] >= 0.195,
            n["turn_stiff"] > 0.1,
        ),
        Claim(
            "high amplitudes require a positive exponent to minimize wear",
            f"of k = −0.5, 0 and 0.5 the last wears least from φ = {n['turn_compliant']:.4f} to {min(again):.4f}, "
            f"and most from {max(again):.4f} on, close to gross slip",
            False,
            rising(-large),
        ),
    ]


@of_paper("9", "Fig. 9", "Wear volume over the amplitude", (PAGE, 8.4), _check_volumes)
def wear_volumes(page: FigureBase) -> None:
    """Fig. 9: the wear volume of Eq. (28) over φ, orange and dashed for negative exponents, blue for positive ones.

    (a) As in the paper; (b) over that of k = 0, at small amplitudes; (c) the same close to gross slip.
    """
    panels = whole, low, high = page.subplots(1, 3)
    phi, left = 1.0 - np.linspace(1.0, 0.2, 161) ** 2, np.geomspace(0.1, 1e-5, 161)
    small = 0.4 * np.linspace(0.0, 1.0, 161)[1:] ** 3
    for k in (*-PAIRS[::-1], 0.0, *PAIRS):
        style = {"color": ORANGE if k < 0.0 else BLUE if k else "k", "linestyle": DASHED if k < 0.0 else "-"}
        style["linewidth"] = 0.7 + 1.4 * abs(k)
        whole.plot(phi, fretting.wear_volume(k, phi), label=of_k(k), **style)
        for axes, x, some in ((low, small, small), (high, left, 1.0 - left)):
            axes.plot(x, fretting.wear_volume(k, some) / fretting.wear_volume(0.0, some), **style)
    turn, ratio = numbers()["turn"], r"wear volume $\Delta V/\Delta V(k=0)$"
    low.axvline(turn, **GUIDE)
    low.text(turn, 1.95, f" {turn:.3f}: $\\pm k$ cross,\n as $k \\to 0$", va="top", fontsize=7)
    whole.set(xlim=(0.0, 1.0), ylim=(0.0, 1.2), xlabel=_AMPLITUDE, ylabel=r"wear volume $\Delta V\, R/a_0^4$")
    low.set(xlim=(0.0, 0.4), ylim=(0.0, 2.0), xlabel=_AMPLITUDE, ylabel=ratio)
    high.set(
        xlim=(0.1, 1e-5), ylim=(0.05, 20.0), xscale="log", yscale="log", xlabel=r"$1 - F_x/(\mu F_N)$", ylabel=ratio
    )
    letters(panels, ("as in the paper", "small amplitudes", "close to gross slip"))
    legend_above(page, whole, 7)


def _check_pressures() -> list[Claim]:
    stick = _radii()[0]
    near, phi = np.array([1e-10, 1e-11])[:, None] * stick[1], AMPLITUDES[1]
    fields = fretting.edge_pressure(near, EXPONENTS, phi), fretting.steady_traction(stick[1] - near, EXPONENTS, phi)
    orders = [np.diff(np.log10(field), axis=0)[0] for field in fields]
    told = ["; ".join(f"{x:.3f}" for x in order) for order in orders]
    mild = [rising(-x) and np.allclose(x, 0.5 * (1.0 - EXPONENTS), atol=1e-3) for x in orders]
    return [
        Claim(
            "the stick radius grows with the exponent, which means a lower mean pressure",
            f"F_N/(π c²) over F_N/(π a0²) {_by_amplitude(1.0 / stick**2, '.3f')}",
            rising(stick, 1),
        ),
        Claim(
            "the stress singularity becomes milder with the exponent",
            f"p∞ grows like δ^−n with n = {told[0]} for k = −0.5, 0, 0.5",
            mild[0],
        ),
        Claim(
            "the same applies to the tangential stresses according to Eq. (21)",
            f"τ∞ grows like δ^−n with n = {told[1]}",
            mild[1],
        ),
    ]


@of_paper("10", "Fig. 10", "Pressures in the fully worn state", (COLUMN, 14.5), _check_pressures)
def worn_pressures(page: FigureBase) -> None:
    """Fig. 10: the pressure of Eq. (17) in the worn state for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5.

    It is printed as a second Fig. 9. Dotted lines mark the stick radius.
    """
    r = crowded(0.0, 1.0, 301)
    for axes, k in _column(page, xlim=(0.0, 1.05), ylim=(0.0, 5.0), ylabel=r"$p_\infty\, \pi a_0^2/F_N$"):
        axes.plot(r, fretting.initial_pressure(r, k), **_THIN)
        for phi, style in OF_AMPLITUDE.items():
            stick = float(fretting.stick_radius(k, phi))
            inside = stick * (1.0 - np.geomspace(1.0, 1e-9, 401))
            axes.plot(inside, fretting.steady_pressure(inside, k, phi), **style)
            axes.axvline(stick, **GUIDE | {"color": style["color"]})
