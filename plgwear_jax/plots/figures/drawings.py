"""The figures of the paper: each is drawn, and what the paper says about it is compared with the library."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase
from matplotlib.rcsetup import cycler

from plgwear_jax import fretting, gross_slip
from plgwear_jax._core.paper_figures import PAPER_FIGURES
from plgwear_jax._core.units import text_cells

from ..style import BEST, BLUE, DASH_DOT, DASHED, GREEN, GUIDE, ORANGE, REFERENCE, Style, legend_above, letters
from .paper import (
    ALMOST,
    EXPONENTS,
    Claim,
    PaperFigure,
    balance_of,
    modulus_factor,
    numbers,
    rising,
    root,
    stiffness_of,
)

AMPLITUDES = np.array([0.3, 0.6, 0.9])  # the paper shows three and does not say which
DEPTHS = np.array([0.1, 1.0, 10.0])  # z0/a in Fig. 5, which the paper does not state either
PAIRS = np.array([-0.8, -0.5, -0.2, 0.0, 0.2, 0.5, 0.8])  # exponents in Fig. 9

# Orange is k < 0, which is red in the paper, and blue k > 0.
_OF_EXPONENT = cycler(color=[ORANGE, "k", BLUE], linestyle=[DASHED, DASH_DOT, "-"])
_OF_AMPLITUDE = cycler(color=[GREEN, "#E69F00", "#AA4499"], linestyle=["-", DASHED, DASH_DOT])
_OF_PAIR = cycler(
    color=[ORANGE] * 3 + ["k"] + [BLUE] * 3, linestyle=[DASHED] * 3 + ["-"] * 4, linewidth=0.7 + 1.4 * abs(PAIRS)
)
_WORN: Style = {"facecolor": "#BFDDEE", "edgecolor": BLUE, "hatch": "////", "linewidth": 0.7}
_THIN: Style = {"color": "0.4", "linewidth": 0.7}
_OVER_K: Style = {"xlim": (-1.0, 1.0), "xlabel": "exponent $k$", "xticks": (-1.0, -0.5, 0.0, 0.5, 1.0)}
_OVER_PHI: Style = {"xlim": (0.0, 1.0), "xlabel": r"amplitude $F_x/(\mu F_N)$"}
_LAW = "admissible"  # Poisson's ratio is Holl's for k >= 0, and 1/2 for k < 0
_PAIRED = EXPONENTS[:, None], AMPLITUDES  # all nine pairs of k and φ
_of_k = "$k = {:g}$".format


def _crowded(lower: float) -> np.ndarray:
    """A column of numbers from -1 or 0 to 1, dense towards -1 and 1, where functions have infinite slopes."""
    return np.sin(0.5 * np.pi * np.linspace(lower, 1.0, 401))[:, None]


def _listed(values: Any, form: str) -> str:
    """Values in words, such as those at the three exponents."""
    return ", ".join(format(x, form) for x in values)


def _by_amplitude(values: Any, form: str) -> str:
    """Values at all pairs of k and φ in words."""
    rows = zip(values.T, AMPLITUDES, strict=True)
    return f"for k = −0.5, 0, 0.5: {'; '.join(f'{_listed(row, form)} at φ = {phi:g}' for row, phi in rows)}"


# --- set-ups ----------------------------------------------------------------------------------------------------------


def _sketch(axes: Axes, r: np.ndarray, surface: Any, body: Any, arrows: str) -> None:
    """Draw a rigid body in a half-space whose shade grows with the depth like the modulus, to scale, without axes.

    Both outlines are heights over r, downwards. Arrows are a line each: words, where they begin and end, and heads.
    """
    z, top = np.linspace(-0.2, 1.4, 401)[:, None], -0.7
    axes.pcolormesh(r, z, np.where(z > surface, z, np.nan), cmap="Blues", vmax=2.2, rasterized=True)
    axes.fill_between(r, top, body, body > top, facecolor="0.88", edgecolor="k", linewidth=0.9)
    axes.plot(r, surface, color=BLUE)
    axes.axhline(0.0, **GUIDE | {"zorder": 2})
    axes.plot([0.0, 0.0], [top, body.max()], linestyle=DASH_DOT, **_THIN)
    for words, *places, heads in text_cells(arrows):
        x0, z0, x1, z1 = map(float, places)
        style = {"arrowstyle": heads or "-", "shrinkA": 0.0, "shrinkB": 0.0, "color": "k"}
        axes.annotate("", (x1, z1), (x0, z0), arrowprops=style)
        axes.text(0.5 * (x0 + x1), 0.5 * (z0 + z1) - 0.07, f" {words}", fontsize=9)
    axes.set(ylim=(1.4, -1.3), aspect="equal")
    axes.set_axis_off()


def gross_slip_set_up(page: FigureBase) -> list[Claim]:
    """A flat punch pressed into a graded half-space that moves below it.

    Beside it the pressure before and after wear, Eqs. (2), (9), for k = −0.5, 0, 0.5.
    """
    axes, pressures = page.subplots(1, 2, width_ratios=(1.25, 1.0))
    r, x, depth = _crowded(0.0), np.linspace(-2.5, 2.5, 1001), 0.42
    initial, steady = gross_slip.initial_pressure(r, EXPONENTS), gross_slip.steady_pressure(r, EXPONENTS[1:])
    pressures.set_prop_cycle(_OF_EXPONENT)
    pressures.plot(r, initial, label=[f"initial, {_of_k(k)}" for k in EXPONENTS])
    pressures.plot(r, steady, color="0.6", label=["steady, $k = 0$", r"steady, $k = \pm 0.5$"])
    pressures.set(ylim=(0.0, 2.5), xlabel="$r/a$", ylabel=r"pressure $p\, \pi a^2/F_{N0}$")
    pressures.legend(loc="upper left")
    _sketch(
        axes,
        x,
        depth * gross_slip.initial_displacement(abs(x), 0.3),
        np.where(abs(x) < 1.001, depth, -1.0),
        r"""
        $F_{N0}$  0.0   -1.3  0.0   -0.7  -|>
        $a$       0.0   0.3   1.0   0.3   <->
        $d$       -0.6  0.0   -0.6  0.42  <->
        sliding   0.9   1.2   2.1   1.2   -|>
        $z$       -2.2  0.0   -2.2  1.2   -|>
        $E(z)=E_0\left(z/z_0\right)^k$  -1.2  1.2  -1.2  1.2  -
        """,
    )
    letters([axes, pressures])
    edge = gross_slip.initial_pressure(0.999, EXPONENTS)
    return [
        Claim(
            "the pressure is greatest at the edge, where it is singular, the milder the greater the exponent",
            f"p0 at r = 0.999 a for k = −0.5, 0, 0.5: {_listed(edge, '.3g')} F_N0/(π a²)",
            rising(initial) and rising(-edge),
        )
    ]


def fretting_set_up(page: FigureBase) -> list[Claim]:
    """A parabolic indenter in the initial and in the steady state; drawn for k = 0.3, φ = 0.7."""
    panels, k, height, r = page.subplots(1, 2), 0.3, 0.62, np.linspace(-2.35, 2.35, 1001)
    stick = fretting.stick_radius(k, 0.7)
    for axes, phi, index in zip(panels, (0.0, 0.7), ("0", r"\infty"), strict=True):
        deep, edge = height * fretting.penetration(k, phi), fretting.worn_radius(k, phi)
        unworn, body = (deep - height * shape for shape in (0.5 * r**2, fretting.profile(abs(r), k, phi)))
        _sketch(
            axes,
            r,
            height * fretting.steady_displacement(abs(r), k, phi),
            body,
            f"""
            $F_N$        0.0    -1.2           0.0      -0.7           -|>
            $F_x$        -1.1   -0.4           -0.1     -0.4           <|-|>
            $d_{index}$  -1.75  0.0            -1.75    {deep}         <->
            $c$          0.0    {deep + 0.15}  {stick}  {deep + 0.15}  <->
            $a_{index}$  0.0    {deep + 0.4}   {edge}   {deep + 0.4}   <->
            """,
        )
        axes.vlines((stick, edge), np.interp((stick, edge), r, unworn), (deep + 0.2, deep + 0.45), **_THIN)
        axes.fill_between(r, unworn, body, unworn > body, **_WORN)
    letters(panels, ("initial state", "steady state"))
    stick, edge = fretting.stick_radius(*_PAIRED), fretting.worn_radius(*_PAIRED)
    inside = fretting.wear_depth(np.linspace(0.0, 1.0, 50)[:, None, None] * stick, *_PAIRED)
    return [
        Claim(
            "in the stick area the final profile coincides with the initial one; around it is a worn ring",
            "f∞ = f0 at all r < c, and c < a0 < a∞ at all nine pairs of k and φ drawn in Fig. 8",
            np.all(inside == 0.0) and np.all(stick < 1.0) and np.all(edge > 1.0),
        )
    ]


# --- gross slip -------------------------------------------------------------------------------------------------------


def _punch(page: FigureBase, k: float) -> list[Claim]:
    n, top, r = numbers(), -0.32, 1.0 + np.linspace(-1.0, 1.0, 401) ** 3  # dense at the edge of the punch
    steady, inside = gross_slip.steady_displacement(r, k), r <= 1.0
    axes = page.add_subplot(ylim=(1.12, top), xlabel="$r/a$", ylabel="$w/d$")
    axes.fill_between(r, top, steady, inside, facecolor="0.93")
    axes.fill_between(r, steady, 1.0, inside, label=r"worn, $\Delta V$", **_WORN)
    axes.vlines(1.0, top, 1.0, color="k", linewidth=0.8)
    axes.plot(r, gross_slip.initial_displacement(r, k), label="initial", color="k")
    axes.plot(r, steady, label="steady", **REFERENCE)
    axes.axhline(0.0, **GUIDE)
    legend_above(page, axes, 3)
    axes.set_title(_of_k(k), loc="left")
    surfaces = gross_slip.initial_displacement, gross_slip.steady_displacement
    beside = np.stack([surface(np.linspace(1.01, 3.0, 200), EXPONENTS[::2, None]) for surface in surfaces], 1)
    depths, (stiff, compliant) = (1.0 - n["edge_stiff"], 1.0 - n["edge_compliant"]), beside[..., 49]
    return [
        Claim(
            "the contact depth becomes larger with the exponent",
            f"d − w∞(a) is {depths[0]:.4f} d at k = −0.5 and {depths[1]:.4f} d at k = 0.5",
            depths[1] > depths[0],
        ),
        Claim(
            "the surface displacements decrease with the exponent",
            f"w0 and w∞ at r = 1.5 a fall from {stiff[0]:.4f} d and {stiff[1]:.4f} d "
            f"to {compliant[0]:.4f} d and {compliant[1]:.4f} d, and fall at all r from a to 3 a",
            rising(-beside),
        ),
        Claim(
            "the worn punch presses uniformly",
            f"p∞ = {n['ratio_graded']:.4f} F_N0/(π a²) at all r < a; shaded: "
            f"ΔV = {100.0 * gross_slip.volume_change(k):.2f} % of π a² d",
            np.ptp(gross_slip.steady_pressure(np.linspace(0.0, 0.99, 12), k)) == 0.0,
        ),
    ]


def punch_on_stiff_surface(page: FigureBase) -> list[Claim]:
    """Punch and surface, initial and steady, for k = −0.5, Eqs. (3), (5); shaded: the volume of Eq. (6)."""
    return _punch(page, -0.5)


def punch_on_compliant_surface(page: FigureBase) -> list[Claim]:
    """The same as Fig. 2 for k = 0.5."""
    return _punch(page, 0.5)


def effective_volume_change(page: FigureBase) -> list[Claim]:
    """The effective volume change of the punch over the exponent, Eq. (7)."""
    k, best, most = _crowded(-1.0) * ALMOST, numbers()["best_k"], 100.0 * numbers()["best_change"]
    change = gross_slip.volume_change(k)
    axes = page.add_subplot(ylim=(0.0, 18.0), ylabel=r"$\Delta V/(\pi a^2 d)$ (%)", **_OVER_K)
    axes.plot(k, 100.0 * change, **BEST)
    axes.plot([best, best, -1.0], [0.0, most, most], **GUIDE)
    axes.plot(best, most, "o", color=ORANGE, markersize=4.0)
    axes.text(best, most + 0.6, f"{most:.1f} % at $k = {best:.3f}$", ha="center")
    ends = change[0, 0], change[-1, 0]
    return [
        Claim("its maximum is at k = 0.169", f"k = {best:.6f}", round(best, 3) == 0.169),
        Claim("it is 15.5 % there", f"{most:.4f} %", round(most, 1) == 15.5),
        Claim(
            "it tends to zero at the edges of the exponent's domain",
            f"{ends[0]:.1e} at k = −1 + 10⁻⁹ and {ends[1]:.1e} at k = 1 − 10⁻⁹",
            max(ends) < 1e-8,
        ),
    ]


def normal_forces(page: FigureBase) -> list[Claim]:
    """The forces of Eqs. (8), (9) over the exponent for z0/a = 0.1, 1 and 10.

    (a) With Holl's ratio where that is at most 1/2, and 1/2 for k < 0; (b) with Holl's ratio for all k. The dotted line
    is the initial force on the homogeneous half-space.
    """
    k, cycle = _crowded(-1.0) * ALMOST, cycler(color=[BLUE, "k", ORANGE])
    panels = page.subplots(1, 2, sharey=True, subplot_kw=_OVER_K | {"ylim": (0.0, 4.0), "prop_cycle": cycle})
    ratio = gross_slip.force_ratio(k)
    for axes, nu in zip(panels, (_LAW, "holl"), strict=True):
        for words, share, dashes in (("initial", 1.0, "-"), ("steady", ratio, DASHED)):
            labels = [f"{words}, $z_0/a = {depth:g}$" for depth in DEPTHS]
            axes.plot(k, share * stiffness_of(k, nu) * DEPTHS**-k, linestyle=dashes, label=labels)
        axes.axvline(0.0, **GUIDE)
        axes.axhline(4.0 / 3.0, **GUIDE)
    panels[0].set_ylabel("$F_N/(2 E_0 d a)$")
    legend_above(page, panels[0], 2)
    letters(panels, (r"$\nu = 1/(2+k)$, at most $1/2$", r"$\nu = 1/(2+k)$, formally for all $k$"))
    even, (holl, half) = (ratio - ratio[::-1]).max(), (stiffness_of(k[[0, -1], 0], nu) for nu in ("holl", 0.5))
    return [
        Claim(
            "the normal force decreases, whatever the characteristic depth (Eq. (10) is less than 1)",
            f"F_N∞/F_N0 is from {ratio.min():.6f} (π/4, at k = 0) to 1 (as |k| → 1), and z0 cancels",
            ratio.max() < 1.0,
        ),
        Claim("the ratio is an even function of k", f"F_N∞/F_N0(k) − F_N∞/F_N0(−k) ≤ {even:.0e}", even < 1e-14),
        Claim(
            "the contact stiffness vanishes at k = −1 and k = 1, but for the incompressible Gibson medium",
            f"F_N0/(2 E0 d a) for z0 = a at |k| = 1 − 10⁻⁹: {holl[0]:.1e} and {holl[1]:.1e} with Holl's ratio; "
            f"{half[0]:.1e} and {half[1]:.6f} (π/3) with ν = 1/2",
            abs(half[1] - math.pi / 3.0) < 1e-6 and max(half[0], *holl) < 1e-6,
        ),
    ]


def force_tendencies(page: FigureBase) -> list[Claim]:
    """Where F_N0 of Eq. (8) is greater than that of the homogeneous half-space with ν = 1/2 and the same E0.

    Poisson's ratio is 1/2 for k < 0 and Holl's for k > 0. The arrows are those of the table.
    """
    k, z0 = 0.9999 * _crowded(-1.0)[:, 0], np.geomspace(0.03, 30.0, 101)
    axes = page.add_subplot(yscale="log", ylabel="characteristic depth $z_0/a$", **_OVER_K)
    said = -k * np.log(z0[:, None])  # positive where the force grows by Table 1
    grows = np.log(stiffness_of(k, _LAW) / stiffness_of(0.0, _LAW)) + said
    areas = axes.contourf(k, z0, grows, [-99.0, 0.0, 99.0], colors=["#D6E8F3", "#FBE3C8"])
    wrong = axes.contourf(k, z0, grows * said, [-99.0, 0.0], colors="none", hatches=[r"\\\\"])
    axes.contour(k, z0, grows, [0.0], colors="k")
    axes.axhline(1.0, color="k", linewidth=0.8, linestyle=DASHED)
    for x, y, words in text_cells("""
        -0.5  0.4   $F_N$ ↓
        -0.4  10.0  $F_N$ ↑
        0.3   0.1   $F_N$ ↑
        0.5   6.0   $F_N$ ↓
    """):
        axes.text(float(x), float(y), words, ha="center", va="center", fontsize=11)
    handles = areas.legend_elements()[0] + wrong.legend_elements()[0]
    labels = "smaller than at $k=0$", "greater than at $k=0$", "not as in Table 1"
    page.legend(handles, labels, loc="outside upper center", ncols=2, title="initial normal force $F_N$")
    axes.yaxis.set_major_formatter("{x:g}")
    size = np.geomspace(1e-4, 0.999, 400)
    left, right = balance_of(-size, _LAW), balance_of(size, _LAW)
    stiffest, stiff, soft, softest = balance_of(np.array([-0.9, -0.5, 0.5, 0.9]), _LAW)
    even = root(lambda k: balance_of(k, _LAW) - 1.0, 0.01, 0.5)
    return [
        Claim(
            "F_N ↓ for −1 < k < 0 and z0 < a",
            f"without exception: it falls wherever z0 < {left.min():.2f} a",
            left.min() > 1.0,
        ),
        Claim(
            "F_N ↑ for −1 < k < 0 and z0 > a",
            f"only where z0 > {left.min():.2f} a near k = 0, {stiff:.2f} a at k = −0.5, {stiffest:.2f} a at k = −0.9 "
            "and ever more as k → −1",
            left.max() <= 1.0,
            left.max() < np.inf,
        ),
        Claim(
            "F_N ↑ for 0 < k < 1 and z0 < a",
            f"only where z0 < {soft:.2f} a at k = 0.5, {softest:.2f} a at k = 0.9 and ever less as k → 1",
            right.min() >= 1.0,
            right.min() > 0.0,
        ),
        Claim(
            "F_N ↓ for 0 < k < 1 and z0 > a",
            f"everywhere but for k < {even:.3f} and z0 up to at most {right.max():.2f} a",
            right.max() <= 1.0,
            right.max() < 1.2,
        ),
    ]


# --- fretting ---------------------------------------------------------------------------------------------------------


def edge_radii(page: FigureBase) -> list[Claim]:
    """Inner and outer radius of the worn ring, c and a∞, over φ for k = −0.5, 0, 0.5; Eqs. (16), (26)."""
    n, phi = numbers(), ALMOST * (1.0 - np.linspace(1.0, 0.0, 241)[:, None] ** 2)
    inner, outer = fretting.stick_radius(EXPONENTS, phi), fretting.worn_radius(EXPONENTS, phi)
    axes = page.add_subplot(prop_cycle=_OF_EXPONENT, ylim=(0.0, 3.0), ylabel=r"$c/a_0,\ a_\infty/a_0$", **_OVER_PHI)
    axes.plot(phi, outer, label=[*map(_of_k, EXPONENTS)])
    axes.plot(phi, inner)
    axes.axhline(1.0, **GUIDE)
    axes.text(0.5, 1.5, r"$a_\infty/a_0$")
    axes.text(0.5, 0.5, "$c/a_0$")
    axes.legend(loc="upper left")
    crossings = [n[f"rings_{name}"] for name in ("pair", "stiff", "compliant")]
    return [
        Claim(
            "the larger the exponent the larger the stick radius c",
            f"at φ = 0.5 and k = −0.5, 0, 0.5: c = {_listed(fretting.stick_radius(EXPONENTS, 0.5), '.4f')} a0",
            rising(inner[1:-1].T),
        ),
        Claim(
            "the larger the exponent the smaller the outer radius a∞",
            f"at φ = 0.5 and k = −0.5, 0, 0.5: a∞ = {_listed(fretting.worn_radius(EXPONENTS, 0.5), '.4f')} a0; it "
            f"holds below φ = {min(crossings):.5f}, the opposite above {max(crossings):.5f}, close to gross slip",
            False,
            rising(-outer[1:200].T),
        ),
    ]


def gradients_of_equal_contact(page: FigureBase) -> list[Claim]:
    """The moduli over the depth of three materials with the same contact radius under the same force."""
    n, z, factors = numbers(), np.linspace(0.0, 1.0, 301)[1:, None] ** 3 * 3.0, modulus_factor(EXPONENTS, "holl")
    axes = page.add_subplot(prop_cycle=_OF_EXPONENT, ylim=(0.0, 5.0), xlabel="$z/a_0$", ylabel="$E(z)/E_0$")
    laws = [rf"{x:.2f}\, E_0\, (z/a_0)^{{{k:g}}}" if k else "E_0" for x, k in zip(factors, EXPONENTS, strict=True)]
    axes.plot(z, factors * z**EXPONENTS, label=[f"$E(z) = {law}$" for law in laws])
    axes.legend(loc="upper right")
    return [
        Claim(
            f"{printed} E0 for k = {k}",
            f"{n[f'factor_{name}']:.4f} times E0/(1−ν²) with Holl's ratio in h_N; with ν = 1/2 in all it is "
            f"{n[f'factor_{name}_half']:.4f}, and {n[f'modulus_{name}']:.4f} times E0 itself with Holl's ratio "
            "throughout",
            round(n[f"factor_{name}"], 2) == printed,
        )
        for name, k, printed in (("stiff", "−0.5", 0.88), ("compliant", "0.5", 2.06))
    ]


def _column(page: FigureBase, field: Callable[..., Any], x: Any, reach: float, top: float, label: str) -> Any:
    """A column of panels, one for each exponent, with a field at each amplitude over x of shape (k, r, φ)."""
    frame = {"prop_cycle": _OF_AMPLITUDE, "ylim": (0.0, top), "ylabel": label}
    panels, r = page.subplots(3, 1, sharex=True, sharey=True, subplot_kw=frame), reach * _crowded(0.0)
    for axes, k, places in zip(panels, EXPONENTS, x, strict=True):
        axes.plot(places, field(places, k, AMPLITUDES), label=[rf"$F_x/(\mu F_N) = {phi:g}$" for phi in AMPLITUDES])
        axes.plot(r, field(r, k, 0.0), label="unworn", linestyle="-", **_THIN)
    panels[-1].set_xlabel("$r/a_0$")
    letters(panels, map(_of_k, EXPONENTS))
    legend_above(page, panels[0], 2)
    return panels


def limiting_profiles(page: FigureBase) -> list[Claim]:
    """Limiting profiles of the indenter for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5, Eq. (25).

    The contact radius is the same for all, as by Eq. (27). Dots mark the edges of the worn ring.
    """
    n, inner, outer = numbers(), fretting.stick_radius(*_PAIRED), fretting.worn_radius(*_PAIRED)
    # dense close to the stick-slip boundary, where the profile rises like a power of the distance
    ring = inner[:, None] + (outer - inner)[:, None] * np.linspace(0.0, 1.0, 201)[:, None] ** 3
    panels = _column(page, fretting.profile, ring, 2.0, 1.6, r"$f_\infty\, R/a_0^2$")
    for axes, ends in zip(panels, ring[:, [0, -1]], strict=True):
        axes.plot(ends, 0.5 * ends**2, ".", markersize=4.0)
    area, bend = outer**2 - inner**2, 8.0 * fretting.deepest_wear(*_PAIRED) / (outer - inner) ** 2
    volume = fretting.wear_volume(*_PAIRED)
    between = max(n["turn_stiff"], n["turn_compliant"]), min(n["return_stiff"], n["return_compliant"])
    return [
        Claim(
            "in all cases the wear volume grows with the amplitude",
            f"ΔV in a0⁴/R {_by_amplitude(volume, '.4f')}",
            rising(volume.T),
        ),
        Claim(
            "the wear volume is greater for negative exponents than for k = 0, and smaller for positive ones",
            f"so it is at these amplitudes, and wherever φ is between {between[0]:.4f} and {between[1]:.4f}",
            rising(-volume),
        ),
        Claim(
            "the entire worn area decreases with the exponent",
            f"(a∞² − c²)/a0² {_by_amplitude(area, '.4f')}",
            rising(-area),
        ),
        Claim(
            "the amount of curvature of the worn area increases with the exponent",
            f"8 (largest wear depth)/(a∞ − c)² in 1/R {_by_amplitude(bend, '.3f')}",
            rising(bend),
        ),
    ]


def wear_volumes(page: FigureBase) -> list[Claim]:
    """The wear volume of Eq. (28) over φ for |k| = 0, 0.2, 0.5, 0.8, blue for positive exponents, else dashed.

    (a) As in the paper; (b) over that of k = 0, at small amplitudes; (c) the same close to gross slip.
    """
    panels = whole, low, high = page.subplots(1, 3, subplot_kw={"prop_cycle": _OF_PAIR})
    phi, left = 1.0 - np.linspace(1.0, 1e-4, 161)[:, None] ** 2, np.geomspace(0.1, 1e-5, 161)[:, None]
    small = 0.4 * np.linspace(0.0, 1.0, 161)[1:, None] ** 3
    whole.plot(phi, fretting.wear_volume(PAIRS, phi), label=[*map(_of_k, PAIRS)])
    for axes, x, some in ((low, small, small), (high, left, 1.0 - left)):
        axes.plot(x, fretting.wear_volume(PAIRS, some) / fretting.wear_volume(0.0, some))
        axes.set_ylabel(r"wear volume $\Delta V/\Delta V(k=0)$")
    n = numbers()
    low.axvline(n["turn"], **GUIDE)
    low.text(n["turn"], 1.7, f" {n['turn']:.3f}:\n $\\pm k$ cross\n as $k \\to 0$")
    whole.set(ylim=(0.0, 1.2), ylabel=r"wear volume $\Delta V\, R/a_0^4$", **_OVER_PHI)
    low.set(ylim=(0.0, 2.0), xlabel=_OVER_PHI["xlabel"])
    high.set(xscale="log", yscale="log", ylim=(0.05, 20.0), xlabel=r"$1 - F_x/(\mu F_N)$")
    high.invert_xaxis()
    letters(panels, ("as in the paper", "small amplitudes", "close to gross slip"))
    legend_above(page, whole, 7)
    pair, again = (n["turn_widest"], n["turn_pair"], n["turn"]), (n["return_pair"], n["return_compliant"])
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
            rising(-fretting.wear_volume(EXPONENTS[:, None], np.linspace(0.3, 0.99, 139))),
        ),
    ]


def worn_pressures(page: FigureBase) -> list[Claim]:
    """The pressure of Eq. (17) in the worn state for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5.

    It is printed as a second Fig. 9. Dotted lines mark the stick radius.
    """
    stick = fretting.stick_radius(*_PAIRED)
    inside = stick[:, None] * (1.0 - np.geomspace(1.0, 1e-9, 401)[:, None])
    panels = _column(page, fretting.steady_pressure, inside, 1.0, 5.0, r"$p_\infty\, \pi a_0^2/F_N$")
    for axes, edges in zip(panels, stick, strict=True):
        axes.vlines(edges, 0.0, 5.0, **GUIDE | {"color": _OF_AMPLITUDE.by_key()["color"]})
    phi, edge, near = AMPLITUDES[1], stick[:, 1], np.array([1e-10, 1e-11])[:, None] * stick[:, 1]
    fields = fretting.edge_pressure(near, EXPONENTS, phi), fretting.steady_traction(edge - near, EXPONENTS, phi)
    orders = [np.diff(np.log10(field), axis=0)[0] for field in fields]
    mild = [rising(-x) and np.allclose(x, 0.5 * (1.0 - EXPONENTS), atol=1e-3) for x in orders]
    return [
        Claim(
            "the stick radius grows with the exponent, which means a lower mean pressure",
            f"F_N/(π c²) over F_N/(π a0²) {_by_amplitude(1.0 / stick**2, '.3f')}",
            rising(stick),
        ),
        Claim(
            "the stress singularity becomes milder with the exponent",
            f"p∞ grows like δ^−n with n = {_listed(orders[0], '.3f')} for k = −0.5, 0, 0.5",
            mild[0],
        ),
        Claim(
            "the same applies to the tangential stresses according to Eq. (21)",
            f"τ∞ grows like δ^−n with n = {_listed(orders[1], '.3f')}",
            mild[1],
        ),
    ]


# --- all of them ------------------------------------------------------------------------------------------------------

_DRAWN = (
    gross_slip_set_up,
    punch_on_stiff_surface,
    punch_on_compliant_surface,
    effective_volume_change,
    normal_forces,
    force_tendencies,
    fretting_set_up,
    edge_radii,
    gradients_of_equal_contact,
    limiting_profiles,
    wear_volumes,
    worn_pressures,
)
FIGURES = {
    key: PaperFigure(key, label, title, (float(width), float(height)), draw_on)
    for (key, (label, title, width, height)), draw_on in zip(PAPER_FIGURES.items(), _DRAWN, strict=True)
}
