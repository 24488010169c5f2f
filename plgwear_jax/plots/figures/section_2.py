"""Section 2 of the paper: gross slip."""

import functools
import math

import numpy as np
from matplotlib.figure import FigureBase

from plgwear_jax import gross_slip
from plgwear_jax.plots.figures.paper import (
    ALMOST,
    COLUMN,
    DEPTHS,
    EXPONENTS,
    OF_EXPONENT,
    PAGE,
    WORN,
    Claim,
    arrow,
    balance_of,
    crowded,
    listed,
    numbers,
    of_k,
    of_paper,
    rising,
    root,
    sketch,
    stiffness_of,
)
from plgwear_jax.plots.style import BEST, BLUE, DASHED, GUIDE, ORANGE, REFERENCE, Style, legend_above, letters

_OVER_K: Style = {"xlim": (-1.0, 1.0), "xlabel": "exponent $k$", "xticks": (-1.0, -0.5, 0.0, 0.5, 1.0)}


def _check_flat() -> list[Claim]:
    pressure = gross_slip.initial_pressure(np.linspace(0.0, 0.999, 200), EXPONENTS[:, None])
    edge = pressure[:, -1]
    return [
        Claim(
            "the pressure is greatest at the edge, where it is singular, the milder the greater the exponent",
            f"p0 at r = 0.999 a for {listed(edge, '.3g')} F_N0/(π a²)",
            rising(pressure, 1) and rising(-edge),
        )
    ]


@of_paper("1", "Fig. 1", "Gross slip of a flat punch: set-up and pressure", (PAGE, 5.6), _check_flat)
def gross_slip_set_up(page: FigureBase) -> None:
    """Fig. 1: a flat punch pressed into a graded half-space that moves below it.

    Beside it the pressure before and after wear, Eqs. (2), (9), for k = −0.5, 0, 0.5.
    """
    axes, pressures = page.subplots(1, 2, width_ratios=(1.25, 1.0))
    r = crowded(0.0, 1.0, 301)
    for k, style in OF_EXPONENT.items():
        pressures.plot(r, gross_slip.initial_pressure(r, k), label=f"initial, {of_k(k)}", **style)
    for k, words, dashes in ((0.5, r"$k = \pm 0.5$", "-"), (0.0, "$k = 0$", DASHED)):
        steady: Style = {"color": "0.6", "linewidth": 1.0, "linestyle": dashes, "label": f"steady, {words}"}
        pressures.hlines(gross_slip.force_ratio(k), 0.0, 1.0, **steady)
    pressures.set(xlim=(0.0, 1.05), ylim=(0.0, 2.5), xlabel="$r/a$", ylabel=r"pressure $p\, \pi a^2/F_{N0}$")
    pressures.legend(loc="upper left")
    depth, r = 0.42, np.linspace(0.0, 2.5, 401)
    surface = r, depth * gross_slip.initial_displacement(r, 0.3)
    sketch(axes, surface, ([1.0, 1.0], [depth, -0.75]), depth, -1.4, 1.55)
    arrow(axes, (0.0, -1.35), (0.0, -0.75), "$F_{N0}$", (0.3, -1.15))
    arrow(axes, (0.0, depth - 0.12), (1.0, depth - 0.12), "$a$", (0.5, depth - 0.24), "<->")
    arrow(axes, (-0.62, 0.0), (-0.62, depth), "$d$", (-0.48, 0.5 * depth), "<->")
    arrow(axes, (0.9, 1.25), (2.1, 1.25), "sliding", (1.5, 1.08))
    arrow(axes, (-2.2, 0.0), (-2.2, 1.2), "$z$", (-2.05, 1.12))
    axes.text(-1.0, 1.18, r"$E(z)=E_0\left(z/z_0\right)^k$", fontsize=9, va="center", zorder=7)
    letters([axes, pressures])


def _check_punch(k: float) -> list[Claim]:
    r, n = np.linspace(1.0, 3.0, 201)[1:], numbers()
    surfaces = gross_slip.initial_displacement, gross_slip.steady_displacement
    outside = np.stack([surface(r, np.array([[-0.5], [0.5]])) for surface in surfaces])
    depths = 1.0 - n["edge_stiff"], 1.0 - n["edge_compliant"]
    (initial, steady), change = outside[:, :, 49], 100.0 * gross_slip.volume_change(k)
    return [
        Claim(
            "the contact depth becomes larger with the exponent",
            f"d − w∞(a) is {depths[0]:.4f} d at k = −0.5 and {depths[1]:.4f} d at k = 0.5",
            depths[1] > depths[0],
        ),
        Claim(
            "the surface displacements decrease with the exponent",
            f"w0 and w∞ at r = 1.5 a fall from {initial[0]:.4f} d and {steady[0]:.4f} d "
            f"to {initial[1]:.4f} d and {steady[1]:.4f} d, and fall at all r from a to 3 a",
            rising(-outside, 1),
        ),
        Claim(
            "the worn punch presses uniformly",
            f"p∞ = {n['ratio_graded']:.4f} F_N0/(π a²) at all r < a; shaded: ΔV = {change:.2f} % of π a² d",
            not np.ptp(gross_slip.steady_pressure(np.linspace(0.0, 0.99, 12), k)),
        ),
    ]


def _draw_punch(page: FigureBase, k: float) -> None:
    axes, top = page.subplots(), -0.32
    r = np.append(crowded(0.0, 1.0, 161), 1.0 + np.linspace(0.0, 1.0, 161) ** 3)
    steady, inside = gross_slip.steady_displacement(r, k), r <= 1.0
    axes.fill_between(r, top, steady, inside, facecolor="0.93", zorder=0)
    axes.fill_between(r, steady, 1.0, inside, **WORN | {"zorder": 1, "label": r"worn, $\Delta V$"})
    axes.plot([1.0, 1.0], [top, 1.0], color="k", linewidth=0.8)
    axes.plot(r, gross_slip.initial_displacement(r, k), label="initial", color="k")
    axes.plot(r, steady, label="steady", **REFERENCE)
    axes.axhline(0.0, **GUIDE)
    axes.set(xlim=(0.0, 2.0), ylim=(1.12, top), xlabel="$r/a$", ylabel="$w/d$")
    legend_above(page, axes, 3)
    axes.set_title(of_k(k), loc="left")


_PUNCH = "Indenter profile and surface displacement for k = "


@of_paper("2", "Fig. 2", f"{_PUNCH}−0.5", (COLUMN, 6.6), functools.partial(_check_punch, -0.5))
def punch_on_stiff_surface(page: FigureBase) -> None:
    """Fig. 2: punch and surface, initial and steady, for k = −0.5, Eqs. (3), (5); shaded: the volume of Eq. (6)."""
    _draw_punch(page, -0.5)


@of_paper("3", "Fig. 3", f"{_PUNCH}0.5", (COLUMN, 6.6), functools.partial(_check_punch, 0.5))
def punch_on_compliant_surface(page: FigureBase) -> None:
    """Fig. 3: the same as Fig. 2 for k = 0.5."""
    _draw_punch(page, 0.5)


def _check_change() -> list[Claim]:
    k, most = numbers()["best_k"], 100.0 * numbers()["best_change"]
    ends = [gross_slip.volume_change(end) for end in (-ALMOST, ALMOST)]
    return [
        Claim("its maximum is at k = 0.169", f"k = {k:.6f}", round(k, 3) == 0.169),
        Claim("it is 15.5 % there", f"{most:.4f} %", round(most, 1) == 15.5),
        Claim(
            "it tends to zero at the edges of the exponent's domain",
            f"{ends[0]:.1e} at k = −1 + 10⁻⁹ and {ends[1]:.1e} at k = 1 − 10⁻⁹",
            bool(max(ends) < 1e-8),
        ),
    ]


@of_paper("4", "Fig. 4", "Effective volume change over the exponent", (COLUMN, 6.0), _check_change)
def effective_volume_change(page: FigureBase) -> None:
    """Fig. 4: the effective volume change of the punch over the exponent, Eq. (7)."""
    axes = page.subplots()
    k = crowded(-1.0, 1.0, 401) * ALMOST
    best, most = numbers()["best_k"], 100.0 * numbers()["best_change"]
    axes.plot(k, 100.0 * gross_slip.volume_change(k), **BEST)
    axes.plot([best, best, -1.0], [0.0, most, most], **GUIDE)
    axes.plot(best, most, "o", color=ORANGE, markersize=4.0)
    axes.text(best, most + 0.6, f"{most:.1f} % at $k = {best:.3f}$", ha="center")
    axes.set(ylim=(0.0, 18.0), ylabel=r"$\Delta V/(\pi a^2 d)$ (%)", **_OVER_K)


def _check_forces() -> list[Claim]:
    ratio = gross_slip.force_ratio(np.linspace(-ALMOST, ALMOST, 4001))
    even = np.max(np.abs(ratio - ratio[::-1]))
    holl, half = (stiffness_of(np.array([-ALMOST, ALMOST]), nu) for nu in ("holl", 0.5))
    return [
        Claim(
            "the normal force decreases, whatever the characteristic depth (Eq. (10) is less than 1)",
            f"F_N∞/F_N0 is from {ratio.min():.6f} (π/4, at k = 0) to 1 (as |k| → 1), and z0 cancels",
            bool(ratio.max() < 1.0),
        ),
        Claim("the ratio is an even function of k", f"F_N∞/F_N0(k) − F_N∞/F_N0(−k) ≤ {even:.0e}", even < 1e-14),
        Claim(
            "the contact stiffness vanishes at k = −1 and k = 1, but for the incompressible Gibson medium",
            f"F_N0/(2 E0 d a) for z0 = a at |k| = 1 − 10⁻⁹: {holl[0]:.1e} and {holl[1]:.1e} with Holl's ratio; "
            f"{half[0]:.1e} and {half[1]:.6f} (π/3) with ν = 1/2",
            abs(half[1] - math.pi / 3.0) < 1e-6 and max(half[0], *holl) < 1e-6,
        ),
    ]


@of_paper("5", "Fig. 5", "Normal force in the initial and steady state", (PAGE, 7.0), _check_forces)
def normal_forces(page: FigureBase) -> None:
    """Fig. 5: the forces of Eqs. (8), (9) over the exponent for z0/a = 0.1, 1 and 10.

    (a) With Holl's ratio where that is at most 1/2, and 1/2 for k < 0; (b) with Holl's ratio for all k. The dotted line
    is the initial force on the homogeneous half-space.
    """
    panels = page.subplots(1, 2, sharey=True)
    k = crowded(-1.0, 1.0, 241) * ALMOST
    ratio = gross_slip.force_ratio(k)
    for axes, nu in zip(panels, ("admissible", "holl"), strict=True):
        for depth, colour in zip(DEPTHS, (BLUE, "k", ORANGE), strict=True):
            initial = stiffness_of(k, nu) * depth**-k
            axes.plot(k, initial, color=colour, label=f"initial, $z_0/a = {depth:g}$")
            axes.plot(k, initial * ratio, color=colour, linestyle=DASHED, label=f"steady, $z_0/a = {depth:g}$")
        axes.axvline(0.0, **GUIDE)
        axes.axhline(4.0 / 3.0, **GUIDE)
        axes.set(ylim=(0.0, 4.0), **_OVER_K)
    panels[0].set_ylabel("$F_N/(2 E_0 d a)$")
    legend_above(page, panels[0], 3)
    letters(panels, (r"$\nu = 1/(2+k)$, at most $1/2$", r"$\nu = 1/(2+k)$, formally for all $k$"))


_LAW = "admissible"  # Poisson's ratio is Holl's for k >= 0, and 1/2 for k < 0


def _check_tendencies() -> list[Claim]:
    size = np.geomspace(1e-4, 0.999, 400)
    left, right = balance_of(-size, _LAW), balance_of(size, _LAW)
    even = root(lambda k: np.log(balance_of(k, _LAW)), 0.01, 0.5)
    at = {k: balance_of(k, _LAW) for k in (-0.9, -0.5, 0.5, 0.9)}
    rows = (
        ("↓", "−1 < k < 0", "z0 < a", left > 1.0, left > 1.0,
         f"without exception: it falls wherever z0 < {left.min():.2f} a"),
        ("↑", "−1 < k < 0", "z0 > a", left <= 1.0, np.isfinite(left),
         f"only where z0 > {left.min():.2f} a near k = 0, {at[-0.5]:.2f} a at k = −0.5, {at[-0.9]:.2f} a at k = −0.9 "
         "and ever more as k → −1"),
        ("↑", "0 < k < 1", "z0 < a", right >= 1.0, right > 0.0,
         f"only where z0 < {min(1.0, at[0.5]):.2f} a at k = 0.5, {at[0.9]:.2f} a at k = 0.9 and ever less as k → 1"),
        ("↓", "0 < k < 1", "z0 > a", right <= 1.0, right < 1.2,
         f"everywhere but for k < {even:.3f} and z0 up to at most {right.max():.2f} a"),
    )  # fmt: skip
    return [
        Claim(f"F_N {way} for {where} and {depth}", found, bool(agrees.all()), bool(in_part.all()))
        for way, where, depth, agrees, in_part, found in rows
    ]


@of_paper("table-1", "Table 1", "Normal force against the homogeneous half-space", (COLUMN, 8.8), _check_tendencies)
def force_tendencies(page: FigureBase) -> None:
    """Table 1: where F_N0 of Eq. (8) is greater than that of the homogeneous half-space with ν = 1/2 and the same E0.

    Poisson's ratio is 1/2 for k < 0 and Holl's for k > 0. The arrows are those of the table.
    """
    axes, low, high = page.subplots(), 0.03, 30.0
    up: Style = {"facecolor": "#FBE3C8", "label": "greater than at $k=0$"}
    down: Style = {"facecolor": "#D6E8F3", "label": "smaller than at $k=0$"}
    wrong: Style = {"facecolor": "none", "edgecolor": "0.45", "hatch": r"\\\\", "label": "not as in Table 1"}
    for sign, above, below in ((-1.0, up, down), (1.0, down, up)):
        k = sign * np.sin(np.linspace(1e-4, 0.5 * np.pi - 1e-3, 401))
        edge = np.clip(balance_of(k, _LAW), low, high)
        axes.fill_between(k, edge, high, zorder=0, **above)
        axes.fill_between(k, low, edge, zorder=0, **below)
        axes.fill_between(k, edge, 1.0, linewidth=0.0, zorder=1, **wrong)
        axes.plot(k, balance_of(k, _LAW), color="k")
    axes.axvline(0.0, color="k", linewidth=0.8)
    axes.axhline(1.0, color="k", linewidth=0.8, linestyle=DASHED)
    for x, y, way in ((-0.5, 0.45, "down"), (-0.42, 10.0, "up"), (0.32, 0.12, "up"), (0.5, 6.0, "down")):
        axes.text(x, y, rf"$F_N\{way}arrow$", ha="center", va="center", fontsize=11)
    page.legend(handles=axes.collections[:3], loc="outside upper center", ncols=2, title="initial normal force $F_N$")
    axes.set(yscale="log", ylim=(low, high), ylabel="characteristic depth $z_0/a$", **_OVER_K)
    axes.yaxis.set_major_formatter("{x:g}")
