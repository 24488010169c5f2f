"""Section 2 of the paper: gross slip."""

import functools
import math
from typing import Any

import numpy as np
from matplotlib.figure import FigureBase
from matplotlib.patches import Patch, Polygon
from matplotlib.ticker import FixedLocator

from plgwear_jax import gross_slip
from plgwear_jax.figures.claims import Claim, of_paper, whether
from plgwear_jax.figures.style import (
    ALMOST,
    ARROW,
    BLACK,
    BLUE,
    BODY,
    COLUMN,
    DASH_DOT,
    DASHED,
    DEPTHS,
    DOTTED,
    EXPONENTS,
    GUIDE,
    NOTE,
    OF_EXPONENT,
    PAGE,
    RED,
    SOLID,
    SPAN,
    bare,
    draw_arrow,
    ground,
    letters,
    note,
    of_k,
)
from plgwear_jax.figures.text_numbers import balance_of, numbers, root, stiffness_of


def _check_flat() -> list[Claim]:
    r, k = np.linspace(0.0, 0.999, 200), np.array([-0.5, 0.0, 0.5])[:, None]
    rises = bool(np.all(np.diff(np.asarray(gross_slip.initial_pressure(r, k)), axis=1) > 0.0))
    edge = [float(gross_slip.initial_pressure(0.999, x)) for x in EXPONENTS]
    return [
        Claim(
            "the pressure is greatest at the edge, where it is singular, the milder the greater the exponent",
            "p0 at r = 0.999 a for k = −0.5, 0, 0.5: " + ", ".join(f"{x:.3g}" for x in edge) + " F_N0/(π a²)",
            whether(rises and edge[0] > edge[1] > edge[2]),
        )
    ]


@of_paper("1", "Fig. 1", "Gross slip of a flat punch: set-up and pressure", (PAGE, 5.6), _check_flat)
def gross_slip_set_up(page: FigureBase) -> None:
    """Fig. 1: a flat punch pressed into a graded half-space that moves below it.

    Beside it the pressure before and after wear, Eqs. (2), (9), for k = −0.5, 0, 0.5.
    """
    axes, pressures = page.subplots(1, 2, width_ratios=(1.25, 1.0))
    x = np.sin(np.linspace(0.0, 0.5 * np.pi, 301))[:-1]
    for k, style in OF_EXPONENT.items():
        pressures.plot([*x, 1.0], [*np.asarray(gross_slip.initial_pressure(x, k)), 99.0], label=of_k(k), **style)
        # wider ones lie behind, since two of these lines lie on each other
        behind = {"linewidth": 2.6, "zorder": 1} if k < 0.0 else {"linewidth": 0.9}
        pressures.plot([0.0, 1.0], [float(gross_slip.force_ratio(k))] * 2, **{**style, **behind})
    pressures.text(0.03, 0.94, r"steady, the same for $k = \pm 0.5$", **NOTE)
    pressures.text(0.45, 0.12, "initial", **NOTE)
    pressures.set(xlim=(0.0, 1.05), ylim=(0.0, 3.0), xlabel="$r/a$", ylabel=r"$p\, \pi a^2/F_{N0}$")
    pressures.legend(loc="upper left")
    depth, sides, bottom = 0.42, 2.5, 1.55
    r = np.concatenate([np.linspace(0.0, 1.0, 3), 1.0 + (sides - 1.0) * np.linspace(0.0, 1.0, 101)[1:] ** 3])
    ground(axes, r, depth * np.asarray(gross_slip.initial_displacement(r, 0.3)), bottom)
    axes.add_patch(Polygon([(-1.0, depth), (1.0, depth), (1.0, -0.75), (-1.0, -0.75)], **BODY))
    axes.plot([-sides, sides], [0.0, 0.0], color="0.3", linewidth=0.7, linestyle=DOTTED, zorder=5)
    draw_arrow(axes, (0.0, -1.35), (0.0, -0.75), ARROW)
    draw_arrow(axes, (0.0, depth - 0.12), (1.0, depth - 0.12), SPAN)
    draw_arrow(axes, (-0.62, 0.0), (-0.62, depth), SPAN)
    draw_arrow(axes, (0.9, 1.25), (2.1, 1.25), ARROW)
    draw_arrow(axes, (-2.2, 0.0), (-2.2, 1.2), ARROW | {"linewidth": 0.7})
    axes.plot([0.0, 0.0], [-0.75, depth], color="0.3", linewidth=0.6, linestyle=DASH_DOT, zorder=5)
    for x, z, text in (
        (0.12, -1.15, "$F_{N0}$"), (0.5, depth - 0.24, "$a$"), (-0.5, 0.5 * depth, "$d$"), (1.5, 1.08, "sliding"),
        (-2.08, 1.12, "$z$"), (-1.0, 1.18, r"$E(z)=E_0\left(z/z_0\right)^k$"),
    ):  # fmt: skip
        axes.text(x, z, text, fontsize=9, ha="left" if text[0] == "$" else "center", va="center", zorder=7)
    bare(axes, sides, -1.4, bottom)
    letters([axes, pressures])


def _check_punch(k: float) -> list[Claim]:
    r = np.linspace(1.0, 3.0, 201)[1:]
    surfaces = gross_slip.initial_displacement, gross_slip.steady_displacement
    outside = [np.asarray(surface(r, exponent)) for surface in surfaces for exponent in (-0.5, 0.5)]
    falls = bool(np.all(outside[1] < outside[0]) and np.all(outside[3] < outside[2]))
    n = numbers()
    depths = [1.0 - n["edge_stiff"], 1.0 - n["edge_compliant"]]
    flat = float(np.ptp(np.asarray(gross_slip.steady_pressure(np.linspace(0.0, 0.99, 12), k)))) == 0.0
    return [
        Claim(
            "the contact depth becomes larger with the exponent",
            f"d − w∞(a) is {depths[0]:.4f} d at k = −0.5 and {depths[1]:.4f} d at k = 0.5",
            whether(depths[1] > depths[0]),
        ),
        Claim(
            "the surface displacements decrease with the exponent",
            f"w0 and w∞ at r = 1.5 a fall from {outside[0][49]:.4f} d and {outside[2][49]:.4f} d "
            f"to {outside[1][49]:.4f} d and {outside[3][49]:.4f} d, and fall at all r from a to 3 a",
            whether(falls),
        ),
        Claim(
            "the worn punch presses uniformly",
            f"p∞ = {n['ratio_graded']:.4f} F_N0/(π a²) at all r < a; shaded: {_change(k)}",
            whether(flat),
        ),
    ]


def _change(k: float) -> str:
    return f"ΔV = {100.0 * float(gross_slip.volume_change(k)):.2f} % of π a² d"


def _draw_punch(page: FigureBase, k: float) -> None:
    axes = page.subplots()
    inside, outside = np.sin(np.linspace(0.0, 0.5 * np.pi, 161)), 1.0 + np.linspace(0.0, 1.0, 161) ** 3 * 1.05
    worn, top = np.asarray(gross_slip.steady_displacement(inside, k)), -0.32
    body = [(0.0, top), *zip(inside, worn, strict=True), (1.0, top)]
    axes.add_patch(Polygon(body, facecolor="0.93", edgecolor="none", zorder=0))
    axes.fill_between(inside, worn, 1.0, facecolor="#BFDDEE", edgecolor=BLUE, hatch="////", linewidth=0.0, zorder=1)
    axes.plot([1.0, 1.0], [top, 1.0], color="k", linewidth=0.8, zorder=2)
    initial: dict[str, Any] = {"color": BLACK, "linestyle": SOLID}
    steady: dict[str, Any] = {"color": RED, "linestyle": DASHED}
    axes.plot(
        [*inside, *outside],
        [*np.ones(inside.size), *gross_slip.initial_displacement(outside, k)],
        label="initial",
        **initial,
    )
    axes.plot([*inside, *outside], [*worn, *gross_slip.steady_displacement(outside, k)], label="steady", **steady)
    axes.axhline(0.0, **GUIDE)
    axes.set(xlim=(0.0, 2.0), ylim=(1.12, top), xlabel="$r/a$", ylabel="$w/d$")
    axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "0.25", "0.5", "0.75", "1"])
    axes.set_xticks([0.0, 0.5, 1.0, 1.5, 2.0])
    axes.text(0.5, 0.5 * (top + 0.6), "rigid punch", ha="center", va="center", **NOTE)
    axes.annotate(
        r"$\Delta V$", (0.78, 1.0 - 0.45 * (1.0 - worn[int(0.58 * 160)])), (0.52, 0.62), fontsize=9,
        arrowprops={"arrowstyle": "-", "linewidth": 0.6, "shrinkB": 0.0},
    )  # fmt: skip
    axes.legend(loc="lower right", title=of_k(k))


@of_paper(
    "2", "Fig. 2", "Indenter profile and surface displacement for k = −0.5", (COLUMN, 6.6),
    functools.partial(_check_punch, -0.5),
)  # fmt: skip
def punch_on_stiff_surface(page: FigureBase) -> None:
    """Fig. 2: punch and surface, initial and steady, for k = −0.5, Eqs. (3), (5); shaded: the volume of Eq. (6)."""
    _draw_punch(page, -0.5)


@of_paper(
    "3", "Fig. 3", "Indenter profile and surface displacement for k = 0.5", (COLUMN, 6.6),
    functools.partial(_check_punch, 0.5),
)  # fmt: skip
def punch_on_compliant_surface(page: FigureBase) -> None:
    """Fig. 3: the same as Fig. 2 for k = 0.5."""
    _draw_punch(page, 0.5)


def _check_change() -> list[Claim]:
    n = numbers()
    k, most = n["best_k"], n["best_change"]
    ends = [float(gross_slip.volume_change(end)) for end in (-ALMOST, ALMOST)]
    return [
        Claim("its maximum is at k = 0.169", f"k = {k:.6f}", whether(round(k, 3) == 0.169)),
        Claim("it is 15.5 % there", f"{100.0 * most:.4f} %", whether(round(100.0 * most, 1) == 15.5)),
        Claim(
            "it tends to zero at the edges of the exponent's domain",
            f"{ends[0]:.1e} at k = −1 + 10⁻⁹ and {ends[1]:.1e} at k = 1 − 10⁻⁹",
            whether(max(ends) < 1e-8),
        ),
    ]


@of_paper("4", "Fig. 4", "Effective volume change over the exponent", (COLUMN, 6.0), _check_change)
def effective_volume_change(page: FigureBase) -> None:
    """Fig. 4: the effective volume change of the punch over the exponent, Eq. (7)."""
    axes = page.subplots()
    k = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 401)) * ALMOST
    best, most = numbers()["best_k"], numbers()["best_change"]
    axes.plot(k, 100.0 * np.asarray(gross_slip.volume_change(k)), color=BLUE)
    axes.plot([best, best, -1.0], [0.0, 100.0 * most, 100.0 * most], **GUIDE)
    axes.plot(best, 100.0 * most, "o", color=RED, markersize=4.0, zorder=3)
    note(axes, f"{100.0 * most:.1f} % at $k = {best:.3f}$", (best, 100.0 * most), **NOTE)
    axes.set(xlim=(-1.0, 1.0), ylim=(0.0, 18.0))
    axes.set_yticks([0.0, 5.0, 10.0, 15.0], ["0", "5", "10", "15"])
    axes.set(xlabel="exponent $k$", ylabel=r"$\Delta V/(\pi a^2 d)$ (%)")
    axes.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])


def _check_forces() -> list[Claim]:
    k = np.linspace(-ALMOST, ALMOST, 4001)
    ratio = np.asarray(gross_slip.force_ratio(k))
    even = float(np.max(np.abs(ratio - ratio[::-1])))
    return [
        Claim(
            "the normal force decreases, whatever the characteristic depth (Eq. (10) is less than 1)",
            f"F_N∞/F_N0 is from {ratio.min():.6f} (π/4, at k = 0) to 1 (as |k| → 1), and z0 cancels",
            whether(bool(np.all(ratio < 1.0))),
        ),
        Claim(
            "the ratio is an even function of k", f"F_N∞/F_N0(k) − F_N∞/F_N0(−k) ≤ {even:.0e}", whether(even < 1e-14)
        ),
        Claim(
            "the contact stiffness vanishes at k = −1 and k = 1, but for the incompressible Gibson medium",
            f"F_N0/(2 E0 d a) for z0 = a at |k| = 1 − 10⁻⁹: {stiffness_of(-ALMOST, 'holl'):.1e} and "
            f"{stiffness_of(ALMOST, 'holl'):.1e} with Holl's ratio; {stiffness_of(-ALMOST, 0.5):.1e} and "
            f"{stiffness_of(ALMOST, 0.5):.6f} (π/3) with ν = 1/2",
            whether(
                abs(stiffness_of(ALMOST, 0.5) - math.pi / 3.0) < 1e-6
                and max(stiffness_of(-ALMOST, 0.5), stiffness_of(-ALMOST, "holl"), stiffness_of(ALMOST, "holl")) < 1e-6
            ),
        ),
    ]


@of_paper("5", "Fig. 5", "Normal force in the initial and steady state", (PAGE, 7.0), _check_forces)
def normal_forces(page: FigureBase) -> None:
    """Fig. 5: the forces of Eqs. (8), (9) over the exponent for z0/a = 0.1, 1 and 10.

    (a) With Holl's ratio where that is at most 1/2, and 1/2 for k < 0; (b) with Holl's ratio for all k. The dotted line
    is the initial force on the homogeneous half-space.
    """
    panels = page.subplots(1, 2, sharey=True)
    k = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 241)) * ALMOST
    ratio = np.asarray(gross_slip.force_ratio(k))
    styles = (BLUE, 1.5), (BLACK, 0.9), (RED, 1.3)
    names = r"$\nu = 1/(2+k)$, at most $1/2$", r"$\nu = 1/(2+k)$, formally for all $k$"
    for axes, nu in zip(panels, ("admissible", "holl"), strict=True):
        stiffness = stiffness_of(k, nu)
        for depth, (colour, width) in zip(DEPTHS, styles, strict=True):
            initial = stiffness * depth**-k
            axes.plot(k, initial, color=colour, linewidth=width)
            axes.plot(k, initial * ratio, color=colour, linewidth=width, linestyle=DASHED)
            most = int(np.argmax(initial))
            place = (float(k[most]), float(initial[most])) if depth != 1.0 else (-0.52, 0.98)
            note(axes, f"$z_0/a = {depth:g}$", place, color=colour)
        axes.axvline(0.0, **GUIDE)
        axes.axhline(4.0 / 3.0, **GUIDE)
        axes.set(xlim=(-1.0, 1.0), ylim=(0.0, 4.0), xlabel="exponent $k$")
        axes.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])
        axes.set_yticks(range(5))
    panels[0].set_ylabel("$F_N/(2 E_0 d a)$")
    panels[0].plot([], [], color="0.3", label="$F_{N0}$, initial")
    panels[0].plot([], [], color="0.3", linestyle=DASHED, label=r"$F_{N\infty}$, steady")
    panels[0].legend(loc="upper left")
    letters(panels, names)


_LAW = "admissible"  # Poisson's ratio is Holl's for k >= 0, and 1/2 for k < 0


def _check_tendencies() -> list[Claim]:
    negative, positive = -np.geomspace(1e-4, 0.999, 400), np.geomspace(1e-4, 0.999, 400)
    left, right = balance_of(negative, _LAW), balance_of(positive, _LAW)
    even = root(lambda k: np.log(balance_of(k, _LAW)), 0.01, 0.5)
    stated = "F_N {} for {} and {}"
    at = {k: float(balance_of(k, _LAW)) for k in (-0.9, -0.5, 0.5, 0.9)}
    return [
        Claim(
            stated.format("↓", "−1 < k < 0", "z0 < a"),
            f"without exception: it falls wherever z0 < {left.min():.2f} a",
            whether(bool(np.all(left > 1.0))),
        ),
        Claim(
            stated.format("↑", "−1 < k < 0", "z0 > a"),
            f"only where z0 > {left.min():.2f} a near k = 0, {at[-0.5]:.2f} a at k = −0.5, {at[-0.9]:.2f} a at "
            f"k = −0.9 and ever more as k → −1",
            whether(bool(np.all(left <= 1.0)), in_part=bool(np.all(np.isfinite(left)))),
        ),
        Claim(
            stated.format("↑", "0 < k < 1", "z0 < a"),
            f"only where z0 < {min(1.0, at[0.5]):.2f} a at k = 0.5, {at[0.9]:.2f} a at k = 0.9 and ever less as k → 1",
            whether(bool(np.all(right >= 1.0)), in_part=bool(np.all(right > 0.0))),
        ),
        Claim(
            stated.format("↓", "0 < k < 1", "z0 > a"),
            f"everywhere but for k < {even:.3f} and z0 up to at most {right.max():.2f} a",
            whether(bool(np.all(right <= 1.0)), in_part=bool(right.max() < 1.2)),
        ),
    ]


@of_paper("table-1", "Table 1", "Normal force against the homogeneous half-space", (COLUMN, 7.4), _check_tendencies)
def force_tendencies(page: FigureBase) -> None:
    """Table 1: where F_N0 of Eq. (8) is greater than that of the homogeneous half-space with ν = 1/2 and the same E0.

    Poisson's ratio is 1/2 for k < 0 and Holl's for k > 0. The arrows are those of the table.
    """
    axes = page.subplots()
    low, high = 0.03, 30.0
    up: dict[str, Any] = {"facecolor": "#FBE3C8"}
    down: dict[str, Any] = {"facecolor": "#D6E8F3"}
    wrong: dict[str, Any] = {"facecolor": "none", "edgecolor": "0.45", "hatch": "\\\\\\\\"}
    for sign in (-1.0, 1.0):
        k = sign * np.sin(np.linspace(1e-4, 0.5 * np.pi - 1e-3, 401))
        balance = balance_of(k, _LAW)
        edge = np.clip(balance, low, high)
        above, below = (up, down) if sign < 0.0 else (down, up)
        axes.fill_between(k, edge, high, linewidth=0.0, zorder=0, **above)
        axes.fill_between(k, low, edge, linewidth=0.0, zorder=0, **below)
        axes.fill_between(k, edge, 1.0, linewidth=0.0, zorder=1, **wrong)
        axes.plot(k, balance, color="k")
    axes.axvline(0.0, color="k", linewidth=0.8)
    axes.axhline(1.0, color="k", linewidth=0.8, linestyle=DASHED)
    places = {(-0.5, 0.45): "down", (-0.42, 10.0): "up", (0.32, 0.12): "up", (0.5, 6.0): "down"}
    for (x, y), way in places.items():
        axes.text(x, y, rf"$F_N\{way}arrow$", ha="center", va="center", fontsize=11)
    meanings: Any = (("greater than at $k=0$", up), ("smaller than at $k=0$", down), ("not as in Table 1", wrong))
    patches = [Patch(label=words, **{**style, "edgecolor": "0.45"}) for words, style in meanings]
    axes.legend(handles=patches, loc="lower left", handlelength=1.4, fontsize=7.0)
    axes.set(yscale="log", xlim=(-1.0, 1.0), ylim=(low, high), xlabel="exponent $k$", ylabel="$z_0/a$")
    axes.yaxis.set_major_locator(FixedLocator([0.1, 1.0, 10.0]))
    axes.set_yticklabels(["0.1", "1", "10"])
    axes.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])
