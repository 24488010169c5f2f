"""The figures and tables of the paper, drawn again from the library, with what the paper says of each checked.

Every function draws one figure for print; `FIGURES` lists them with the claims of the text that belong to them, and
`numbers` computes the numbers that stand in it. Needs the extra `plots`, and `jax_enable_x64` for all digits.
"""

import functools
import math
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import jax
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.patches import Patch, Polygon
from matplotlib.ticker import FixedLocator
from scipy import optimize

from plgwear_jax import _files, fretting, gross_slip, material

__all__ = [
    "FIGURES",
    "Claim",
    "PaperFigure",
    "contact_sheet",
    "edge_radii",
    "effective_volume_change",
    "force_tendencies",
    "gradients_of_equal_contact",
    "limiting_profiles",
    "normal_forces",
    "numbers",
    "punch_on_hard_surface",
    "punch_on_soft_surface",
    "save",
    "verdict",
    "wear_volumes",
    "worn_pressures",
]

# --- style ----------------------------------------------------------------------------------------------------------

CENTIMETRE = 1.0 / 2.54
COLUMN, PAGE = 8.6, 17.8  # widths in cm

STYLE: dict[str, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 8.0,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.6,
    "axes.titlesize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "lines.linewidth": 1.3,
    "lines.dash_capstyle": "butt",
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "legend.handlelength": 2.8,
    "legend.labelspacing": 0.35,
    "patch.linewidth": 0.6,
    "hatch.linewidth": 0.4,
    "savefig.dpi": 300.0,
    "pdf.fonttype": 42,
}

# Colours of Okabe and Ito; dashes besides, for grey prints. As in the paper, red is negative and blue is positive.
RED, BLUE, BLACK = "#D55E00", "#0072B2", "k"
GREEN, ORANGE, PURPLE, SKY = "#009E73", "#E69F00", "#AA4499", "#56B4E9"
SOLID, DASHED, DOTTED = "-", (0, (5, 1.8)), (0, (1, 1.2))
DASH_DOT = (0, (7, 1.5, 1.2, 1.5))
OF_EXPONENT = {
    -0.5: {"color": RED, "linestyle": DASHED},
    0.0: {"color": BLACK, "linestyle": DASH_DOT, "linewidth": 1.1},
    0.5: {"color": BLUE, "linestyle": SOLID},
}
OF_AMPLITUDE = (
    {"color": GREEN, "linestyle": SOLID},
    {"color": ORANGE, "linestyle": DASHED, "linewidth": 1.5},
    {"color": PURPLE, "linestyle": DASH_DOT},
)
THIN: dict[str, Any] = {"color": "0.45", "linewidth": 0.7}
GUIDE: dict[str, Any] = {"color": "0.5", "linewidth": 0.7, "linestyle": DOTTED, "zorder": 1}
NOTE: dict[str, Any] = {"fontsize": 8.0, "color": "0.15"}

EXPONENTS = (-0.5, 0.0, 0.5)
AMPLITUDES = (0.3, 0.6, 0.9)  # the paper shows three and does not say which
DEPTHS = (0.1, 1.0, 10.0)  # z0/a in Fig. 5, where the text does not say either
PAIRS = (0.2, 0.5, 0.8)  # abs(k) in Fig. 9
ALMOST = 1.0 - 1e-9


def _letters(panels: Sequence[Axes], names: Sequence[str] = ()) -> None:
    for n, axes in enumerate(panels):
        words = f"   {names[n]}" if names else ""
        axes.set_title(f"({'abcdef'[n]}){words}", loc="left", pad=3.5)


# --- what the paper says, and what comes out ------------------------------------------------------------------------


class Claim(NamedTuple):
    """A statement of the paper, and what the library says of it."""

    said: str
    """In the words of the paper, or nearly."""
    found: str
    """What the library gives, with numbers."""
    verdict: str
    """One of "agrees", "agrees in part", "differs"."""


VERDICTS = ("agrees", "agrees in part", "differs")


class PaperFigure(NamedTuple):
    """A figure or table of the paper, how it is drawn, and how its claims are checked."""

    key: str
    """"4" of Fig. 4, "table-1", "eq-27"."""
    label: str
    title: str
    size: tuple[float, float]
    """Width and height in cm."""
    draw: Callable[..., FigureBase]
    check: Callable[[], list[Claim]]

    @property
    def stem(self) -> str:
        """The name of its files without suffix."""
        return f"fig-{int(self.key):02d}" if self.key.isdigit() else self.key


FIGURES: dict[str, PaperFigure] = {}


def verdict(claims: Sequence[Claim]) -> str:
    """The least favourable verdict of some claims."""
    return max((claim.verdict for claim in claims), key=VERDICTS.index)


def _whether(agrees: bool, in_part: bool = False) -> str:
    return "agrees" if agrees else "agrees in part" if in_part else "differs"


def _of_paper(
    key: str, label: str, title: str, size: tuple[float, float], check: Callable[[], list[Claim]]
) -> Callable[[Callable[[FigureBase], None]], Callable[..., FigureBase]]:
    """Enter a drawing into `FIGURES`; it then makes its own page unless it is given a part of one."""

    def enter(content: Callable[[FigureBase], None]) -> Callable[..., FigureBase]:
        @functools.wraps(content)
        def draw(page: FigureBase | None = None) -> FigureBase:
            with rc_context(STYLE):
                if page is None:
                    page = Figure(figsize=(size[0] * CENTIMETRE, size[1] * CENTIMETRE), dpi=300, layout="constrained")
                content(page)
            return page

        FIGURES[key] = PaperFigure(key, label, title, size, draw, check)
        return draw

    return enter


# --- numbers of the text --------------------------------------------------------------------------------------------


def _root(function: Callable[[float], Any], lower: float, upper: float) -> float:
    found: Any = optimize.brentq(lambda x: float(function(x)), lower, upper, xtol=1e-15, rtol=1e-14)
    return float(found)


def _crossing(quantity: Callable[..., Any], one: float, other: float, lower: float, upper: float) -> float:
    """The amplitude between two at which a quantity is the same for both exponents."""
    return _root(lambda phi: np.log(quantity(one, phi)) - np.log(quantity(other, phi)), lower, upper)


def _poisson(k: Any, nu: float | str) -> np.ndarray:
    """Poisson's ratio: a number, Holl's ratio, or Holl's where that is at most 1/2 and 1/2 elsewhere."""
    holl = np.asarray(material.holl_ratio(k))
    return holl if nu == "holl" else np.minimum(holl, 0.5) if nu == "admissible" else np.full_like(holl, nu)


def _stiffness(k: Any, nu: float | str) -> Any:
    """F_N0/(2 E0 d a) of Eq. (8) for z0 = a."""
    value = _poisson(k, nu)
    h_N = np.asarray(material.h_N(k, "holl" if nu == "holl" else value))
    return h_N / ((1.0 - value) * (1.0 + value) * (1.0 + np.asarray(k)))


def _balance(k: Any, nu: float | str) -> Any:
    """z0/a at which the initial force is that of the homogeneous half-space of the same E0, Eq. (8)."""
    return np.exp(np.log(_stiffness(k, nu) / _stiffness(0.0, nu)) / np.asarray(k))


def _modulus_factor(k: float, nu: float | str) -> float:
    """E0/(1-nu^2) over that of the homogeneous material with the same contact radius a_0 = z0, Eq. (12)."""
    h_N = float(material.h_N(k, nu))  # pyright: ignore[reportArgumentType]
    return (1.0 + k) ** 2 * (3.0 + k) / (3.0 * h_N)


@functools.cache
def numbers() -> Mapping[str, float]:
    """The numbers of the paper's text, and those that it invites to ask for, from the library.

    Returns:
        Name and value; a test compares each with the paper evaluated to 50 digits.
    """
    slope = jax.jit(jax.grad(gross_slip.volume_change))
    by_k = jax.jit(jax.grad(fretting.wear_volume))
    best = _root(slope, -0.5, 0.9)
    volume, outer = fretting.wear_volume, fretting.worn_radius
    holl = {k: 1.0 - float(_poisson(k, "holl")) ** 2 for k in EXPONENTS}
    return {
        "k of the greatest volume change": best,
        "greatest volume change": float(gross_slip.volume_change(best)),
        "volume change, k = -0.5": float(gross_slip.volume_change(-0.5)),
        "volume change, k = 0": float(gross_slip.volume_change(0.0)),
        "volume change, k = 0.5": float(gross_slip.volume_change(0.5)),
        "w_inf(a)/d, k = -0.5": float(gross_slip.steady_displacement(1.0, -0.5)),
        "w_inf(a)/d, k = 0.5": float(gross_slip.steady_displacement(1.0, 0.5)),
        "force ratio, k = 0": float(gross_slip.force_ratio(0.0)),
        "force ratio, k = 0.5": float(gross_slip.force_ratio(0.5)),
        "stiffness near k = 1, nu = 0.5": float(_stiffness(ALMOST, 0.5)),
        "factor, k = -0.5": _modulus_factor(-0.5, "holl"),
        "factor, k = 0.5": _modulus_factor(0.5, "holl"),
        "factor, k = -0.5, nu = 0.5": _modulus_factor(-0.5, 0.5),
        "factor, k = 0.5, nu = 0.5": _modulus_factor(0.5, 0.5),
        "factor of E0, k = -0.5": _modulus_factor(-0.5, "holl") * holl[-0.5] / holl[0.0],
        "factor of E0, k = 0.5": _modulus_factor(0.5, "holl") * holl[0.5] / holl[0.0],
        "balance, k = -0.5, nu = 0.5": float(_balance(-0.5, 0.5)),
        "balance, k = 0.5, nu = Holl": float(_balance(0.5, "holl")),
        "crossing, slope at k = 0": _root(lambda phi: by_k(0.0, phi), 0.1, 0.4),
        "crossing, k = -0.5 and 0.5": _crossing(volume, -0.5, 0.5, 0.1, 0.4),
        "crossing, k = -0.5 and 0": _crossing(volume, -0.5, 0.0, 0.05, 0.4),
        "crossing, k = 0 and 0.5": _crossing(volume, 0.0, 0.5, 0.1, 0.5),
        "crossing, k = -0.99 and 0.99": _crossing(volume, -0.99, 0.99, 0.1, 0.4),
        "second crossing, k = -0.5 and 0.5": _crossing(volume, -0.5, 0.5, 0.9, 0.9999),
        "second crossing, k = -0.5 and 0": _crossing(volume, -0.5, 0.0, 0.9, 0.9999),
        "second crossing, k = 0 and 0.5": _crossing(volume, 0.0, 0.5, 0.9, 0.9999),
        "worn radii cross, k = -0.5 and 0.5": _crossing(outer, -0.5, 0.5, 0.9, 0.99999),
        "worn radii cross, k = -0.5 and 0": _crossing(outer, -0.5, 0.0, 0.9, 0.99999),
        "worn radii cross, k = 0 and 0.5": _crossing(outer, 0.0, 0.5, 0.9, 0.99999),
    }


# --- section 2: gross slip ------------------------------------------------------------------------------------------


def _check_punch(k: float) -> list[Claim]:
    r = np.linspace(1.0, 3.0, 201)[1:]
    outside = [
        np.asarray(field(r, exponent)) for field in (_initial_surface, _steady_surface) for exponent in (-0.5, 0.5)
    ]
    falls = bool(np.all(outside[1] < outside[0]) and np.all(outside[3] < outside[2]))
    n = numbers()
    depths = [1.0 - n[f"w_inf(a)/d, k = {exponent}"] for exponent in (-0.5, 0.5)]
    flat = float(np.ptp(np.asarray(gross_slip.steady_pressure(np.linspace(0.0, 0.99, 12), k)))) == 0.0
    return [
        Claim(
            "the contact depth becomes larger with the exponent",
            f"d − w∞(a) is {depths[0]:.4f} d at k = −0.5 and {depths[1]:.4f} d at k = 0.5",
            _whether(depths[1] > depths[0]),
        ),
        Claim(
            "the surface displacements decrease with the exponent",
            f"w0 and w∞ at r = 1.5 a fall from {outside[0][49]:.4f} d and {outside[2][49]:.4f} d "
            f"to {outside[1][49]:.4f} d and {outside[3][49]:.4f} d, and fall at all r from a to 3 a",
            _whether(falls),
        ),
        Claim(
            "the worn punch presses uniformly",
            f"p∞ = {n['force ratio, k = 0.5']:.4f} F_N0/(π a²) at all r < a; shaded: {_change(k)}",
            _whether(flat),
        ),
    ]


def _change(k: float) -> str:
    return f"ΔV = {100.0 * float(gross_slip.volume_change(k)):.2f} % of π a² d"


def _initial_surface(r: Any, k: float) -> Any:
    return gross_slip.initial_displacement(r, k)


def _steady_surface(r: Any, k: float) -> Any:
    return gross_slip.steady_displacement(r, k)


def _draw_punch(page: FigureBase, k: float) -> None:
    axes = page.subplots()
    inside, outside = np.sin(np.linspace(0.0, 0.5 * np.pi, 161)), 1.0 + np.linspace(0.0, 1.0, 161) ** 3 * 1.05
    worn, top = np.asarray(_steady_surface(inside, k)), -0.32
    body = [(0.0, top), *zip(inside, worn, strict=True), (1.0, top)]
    axes.add_patch(Polygon(body, facecolor="0.93", edgecolor="none", zorder=0))
    axes.fill_between(inside, worn, 1.0, facecolor="#BFDDEE", edgecolor=BLUE, hatch="////", linewidth=0.0, zorder=1)
    axes.plot([1.0, 1.0], [top, 1.0], color="k", linewidth=0.8, zorder=2)
    initial, steady = {"color": BLACK, "linestyle": SOLID}, {"color": RED, "linestyle": DASHED}
    axes.plot([*inside, *outside], [*np.ones(inside.size), *_initial_surface(outside, k)], label="initial", **initial)
    axes.plot([*inside, *outside], [*worn, *_steady_surface(outside, k)], label="steady", **steady)
    axes.axhline(0.0, **GUIDE)
    axes.set(xlim=(0.0, 2.0), ylim=(1.12, top), xlabel="$r/a$", ylabel="$w/d$")
    axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "0.25", "0.5", "0.75", "1"])
    axes.set_xticks([0.0, 0.5, 1.0, 1.5, 2.0])
    axes.text(0.5, 0.5 * (top + 0.6), "rigid punch", ha="center", va="center", **NOTE)
    axes.annotate(
        r"$\Delta V$", (0.78, 1.0 - 0.45 * (1.0 - worn[int(0.58 * 160)])), (0.52, 0.62), fontsize=9,
        arrowprops={"arrowstyle": "-", "linewidth": 0.6, "shrinkB": 0.0},
    )  # fmt: skip
    axes.legend(loc="lower right", title=_of_k(k))


@_of_paper(
    "2", "Fig. 2", "Indenter profile and surface displacement for k = −0.5", (COLUMN, 6.6),
    functools.partial(_check_punch, -0.5),
)  # fmt: skip
def punch_on_hard_surface(page: FigureBase) -> None:
    """Fig. 2: punch and surface, initial and steady, for k = -0.5."""
    _draw_punch(page, -0.5)


@_of_paper(
    "3", "Fig. 3", "Indenter profile and surface displacement for k = 0.5", (COLUMN, 6.6),
    functools.partial(_check_punch, 0.5),
)  # fmt: skip
def punch_on_soft_surface(page: FigureBase) -> None:
    """Fig. 3: punch and surface, initial and steady, for k = 0.5."""
    _draw_punch(page, 0.5)


def _check_change() -> list[Claim]:
    n = numbers()
    k, most = n["k of the greatest volume change"], n["greatest volume change"]
    ends = [float(gross_slip.volume_change(end)) for end in (-ALMOST, ALMOST)]
    return [
        Claim("its maximum is at k = 0.169", f"k = {k:.6f}", _whether(round(k, 3) == 0.169)),
        Claim("it is 15.5 % there", f"{100.0 * most:.4f} %", _whether(round(100.0 * most, 1) == 15.5)),
        Claim(
            "it tends to zero at the edges of the exponent's domain",
            f"{ends[0]:.1e} at k = −1 + 10⁻⁹ and {ends[1]:.1e} at k = 1 − 10⁻⁹",
            _whether(max(ends) < 1e-8),
        ),
    ]


@_of_paper("4", "Fig. 4", "Effective volume change over the exponent", (COLUMN, 6.0), _check_change)
def effective_volume_change(page: FigureBase) -> None:
    """Fig. 4: Delta V/(pi a^2 d) over k, Eq. (7)."""
    axes = page.subplots()
    k = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 401)) * ALMOST
    best, most = numbers()["k of the greatest volume change"], numbers()["greatest volume change"]
    axes.plot(k, 100.0 * np.asarray(gross_slip.volume_change(k)), color=BLUE)
    axes.plot([best, best, -1.0], [0.0, 100.0 * most, 100.0 * most], **GUIDE)
    axes.plot(best, 100.0 * most, "o", color=RED, markersize=4.0, zorder=3)
    axes.annotate(
        f"{100.0 * most:.1f} % at $k = {best:.3f}$", (best, 100.0 * most), (0, 4), textcoords="offset points",
        ha="center", va="bottom", **NOTE,
    )  # fmt: skip
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
            _whether(bool(np.all(ratio < 1.0))),
        ),
        Claim(
            "the ratio is an even function of k", f"F_N∞/F_N0(k) − F_N∞/F_N0(−k) ≤ {even:.0e}", _whether(even < 1e-14)
        ),
        Claim(
            "the contact stiffness vanishes at k = −1 and k = 1, but for the incompressible Gibson medium",
            f"F_N0/(2 E0 d a) for z0 = a at |k| = 1 − 10⁻⁹: {_stiffness(-ALMOST, 'holl'):.1e} and "
            f"{_stiffness(ALMOST, 'holl'):.1e} with Holl's ratio; {_stiffness(-ALMOST, 0.5):.1e} and "
            f"{_stiffness(ALMOST, 0.5):.6f} (π/3) with ν = 1/2",
            _whether(abs(_stiffness(ALMOST, 0.5) - math.pi / 3.0) < 1e-6 and _stiffness(ALMOST, "holl") < 1e-6),
        ),
    ]


@_of_paper("5", "Fig. 5", "Normal force in the initial and steady state", (PAGE, 7.0), _check_forces)
def normal_forces(page: FigureBase) -> None:
    """Fig. 5: the forces of Eqs. (8), (9) over k for z0/a = 0.1, 1, 10, with two laws of Poisson's ratio."""
    panels = page.subplots(1, 2, sharey=True)
    k = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 241)) * ALMOST
    ratio = np.asarray(gross_slip.force_ratio(k))
    styles = (BLUE, 1.5), (BLACK, 0.9), (RED, 1.3)
    names = r"$\nu = 1/(2+k)$, at most $1/2$", r"$\nu = 1/(2+k)$, formally for all $k$"
    for axes, nu in zip(panels, ("admissible", "holl"), strict=True):
        stiffness = _stiffness(k, nu)
        for depth, (colour, width) in zip(DEPTHS, styles, strict=True):
            initial = stiffness * depth**-k
            axes.plot(k, initial, color=colour, linewidth=width)
            axes.plot(k, initial * ratio, color=colour, linewidth=width, linestyle=DASHED)
            most = int(np.argmax(initial))
            place = (float(k[most]), float(initial[most])) if depth != 1.0 else (-0.52, 0.98)
            axes.annotate(
                f"$z_0/a = {depth:g}$",
                place,
                (0, 4),
                textcoords="offset points",
                ha="center",
                va="bottom",
                color=colour,
            )
        axes.axvline(0.0, **GUIDE)
        axes.axhline(4.0 / 3.0, **GUIDE)
        axes.set(xlim=(-1.0, 1.0), ylim=(0.0, 4.0), xlabel="exponent $k$")
        axes.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])
        axes.set_yticks(range(5))
    panels[0].set_ylabel("$F_N/(2 E_0 d a)$")
    panels[0].plot([], [], color="0.3", label="$F_{N0}$, initial")
    panels[0].plot([], [], color="0.3", linestyle=DASHED, label=r"$F_{N\infty}$, steady")
    panels[0].legend(loc="upper left")
    _letters(panels, names)


_LAW = "admissible"  # of Poisson's ratio: Holl's for k >= 0, 1/2 for k < 0


def _check_tendencies() -> list[Claim]:
    negative, positive = -np.geomspace(1e-4, 0.999, 400), np.geomspace(1e-4, 0.999, 400)
    left, right = _balance(negative, _LAW), _balance(positive, _LAW)
    even = _root(lambda k: np.log(_balance(k, _LAW)), 0.01, 0.5)
    stated = "F_N {} for {} and {}"
    at = {k: float(_balance(k, _LAW)) for k in (-0.9, -0.5, 0.5, 0.9)}
    return [
        Claim(
            stated.format("↓", "−1 < k < 0", "z0 < a"),
            f"without exception: it falls wherever z0 < {left.min():.2f} a",
            _whether(bool(np.all(left > 1.0))),
        ),
        Claim(
            stated.format("↑", "−1 < k < 0", "z0 > a"),
            f"only where z0 > {left.min():.2f} a near k = 0, {at[-0.5]:.2f} a at k = −0.5, {at[-0.9]:.2f} a at "
            f"k = −0.9 and ever more as k → −1",
            _whether(bool(np.all(left <= 1.0)), in_part=bool(np.all(np.isfinite(left)))),
        ),
        Claim(
            stated.format("↑", "0 < k < 1", "z0 < a"),
            f"only where z0 < {min(1.0, at[0.5]):.2f} a at k = 0.5, {at[0.9]:.2f} a at k = 0.9 and ever less as k → 1",
            _whether(bool(np.all(right >= 1.0)), in_part=bool(np.all(right > 0.0))),
        ),
        Claim(
            stated.format("↓", "0 < k < 1", "z0 > a"),
            f"everywhere but for k < {even:.3f}, where z0 > {right.max():.2f} a or less is needed",
            _whether(bool(np.all(right <= 1.0)), in_part=bool(right.max() < 1.2)),
        ),
    ]


@_of_paper("table-1", "Table 1", "Normal force against the homogeneous half-space", (COLUMN, 7.4), _check_tendencies)
def force_tendencies(page: FigureBase) -> None:
    """Table 1: where F_N0 of Eq. (8) is greater than at k = 0, over k and z0/a."""
    axes = page.subplots()
    low, high = 0.03, 30.0
    up, down, wrong = {"facecolor": "#FBE3C8"}, {"facecolor": "#D6E8F3"}, {"facecolor": "none", "edgecolor": "0.45"}
    wrong |= {"hatch": "\\\\\\\\"}
    for sign in (-1.0, 1.0):
        k = sign * np.sin(np.linspace(1e-4, 0.5 * np.pi - 1e-3, 401))
        balance = _balance(k, _LAW)
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
    meanings = (("greater than at $k=0$", up), ("smaller than at $k=0$", down), ("not as in Table 1", wrong))
    patches = [Patch(label=words, **style | {"edgecolor": "0.45"}) for words, style in meanings]
    axes.legend(handles=patches, loc="lower left", handlelength=1.8)
    axes.set(yscale="log", xlim=(-1.0, 1.0), ylim=(low, high), xlabel="exponent $k$", ylabel="$z_0/a$")
    axes.yaxis.set_major_locator(FixedLocator([0.1, 1.0, 10.0]))
    axes.set_yticklabels(["0.1", "1", "10"])
    axes.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])


# --- section 3: fretting --------------------------------------------------------------------------------------------

_GRID = np.concatenate([np.geomspace(1e-6, 0.01, 40), np.linspace(0.02, 0.99, 98)])


def _check_radii() -> list[Claim]:
    n = numbers()
    inner = np.asarray(fretting.stick_radius(np.array(EXPONENTS)[:, None], _GRID))
    outer = np.asarray(fretting.worn_radius(np.array(EXPONENTS)[:, None], _GRID))
    grows, falls = bool(np.all(np.diff(inner, axis=0) > 0.0)), bool(np.all(np.diff(outer, axis=0) < 0.0))
    crossings = [n[f"worn radii cross, k = {pair}"] for pair in ("-0.5 and 0", "-0.5 and 0.5", "0 and 0.5")]
    place = int(np.flatnonzero(np.isclose(_GRID, 0.5))[0])
    return [
        Claim(
            "the larger the exponent the larger the stick radius c",
            "at φ = 0.5 and k = −0.5, 0, 0.5: c = " + ", ".join(f"{x:.4f}" for x in inner[:, place]) + " a0",
            _whether(grows),
        ),
        Claim(
            "the larger the exponent the smaller the outer radius a∞",
            "at φ = 0.5 and k = −0.5, 0, 0.5: a∞ = " + ", ".join(f"{x:.4f}" for x in outer[:, place]) + " a0; "
            f"it holds below φ = {min(crossings):.5f}, the opposite above {max(crossings):.5f}, close to gross slip",
            _whether(False, in_part=falls),
        ),
    ]


@_of_paper("7", "Fig. 7", "Inner and outer radius of the worn ring", (COLUMN, 7.0), _check_radii)
def edge_radii(page: FigureBase) -> None:
    """Fig. 7: c and a_inf over phi for k = -0.5, 0, 0.5."""
    axes = page.subplots()
    phi = 1.0 - np.linspace(1.0, 0.03, 241) ** 2
    for k, style in OF_EXPONENT.items():
        axes.plot(phi, np.asarray(fretting.worn_radius(k, phi)), label=_of_k(k), **style)
        axes.plot([*phi, 1.0], [*np.asarray(fretting.stick_radius(k, phi)), 0.0], **style)
    axes.axhline(1.0, **GUIDE)
    axes.text(0.66, 1.92, r"$a_\infty/a_0$", ha="right", fontsize=9)
    axes.text(0.66, 0.52, "$c/a_0$", ha="right", fontsize=9)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 3.0), xlabel=r"$F_x/(\mu F_N)$", ylabel=r"$c/a_0,\ a_\infty/a_0$")
    axes.legend(loc="upper left")


def _of_k(k: float) -> str:
    return f"$k = {k:g}$"


def _legend_above(page: FigureBase, axes: Axes) -> None:
    page.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)


def _of_phi(phi: float) -> str:
    return rf"$F_x/(\mu F_N) = {phi:g}$"


def _check_factors() -> list[Claim]:
    n = numbers()
    found = []
    for k, printed in ((-0.5, 0.88), (0.5, 2.06)):
        factor, half, other = n[f"factor, k = {k}"], n[f"factor, k = {k}, nu = 0.5"], n[f"factor of E0, k = {k}"]
        found.append(
            Claim(
                f"{printed} E0 for k = {k:g}".replace("-", "−"),
                f"{factor:.4f} times E0/(1−ν²) with Holl's ratio in h_N; with ν = 1/2 in all it is {half:.4f}, "
                f"and {other:.4f} times E0 itself with Holl's ratio throughout",
                _whether(round(factor, 2) == printed),
            )
        )
    return found


@_of_paper("eq-27", "Eq. (27)", "Three materials with the same contact radius", (COLUMN, 6.2), _check_factors)
def gradients_of_equal_contact(page: FigureBase) -> None:
    """Eq. (27): the moduli over the depth of three materials with the same contact radius under the same force."""
    axes = page.subplots()
    z = np.linspace(0.0, 1.0, 301)[1:] ** 3 * 3.0
    for k, style in OF_EXPONENT.items():
        factor = _modulus_factor(k, "holl")
        law = rf"{factor:.2f}\, E_0\, (z/a_0)^{{{k:g}}}" if k else "E_0"
        axes.plot(z, factor * z**k, label=f"$E(z) = {law}$", **style)
    axes.set(xlim=(0.0, 3.0), ylim=(0.0, 5.0), xlabel="$z/a_0$", ylabel="$E(z)/E_0$")
    axes.set_xticks(range(4))
    axes.legend(loc="upper right")


def _volumes() -> np.ndarray:
    """Wear volumes at `AMPLITUDES` (rows) for `EXPONENTS`."""
    return np.asarray(fretting.wear_volume(np.array(EXPONENTS), np.array(AMPLITUDES)[:, None]))


def _rows(values: np.ndarray, form: str) -> str:
    rows = (", ".join(format(x, form) for x in row) for row in values)
    return "; ".join(f"{row} at φ = {phi:g}" for row, phi in zip(rows, AMPLITUDES, strict=True))


def _check_profiles() -> list[Claim]:
    k, phi = np.array(EXPONENTS), np.array(AMPLITUDES)[:, None]
    inner, outer = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    area, deepest = outer**2 - inner**2, np.asarray(fretting.deepest_wear(k, phi))
    bend, volume = 8.0 * deepest / (outer - inner) ** 2, _volumes()
    n = numbers()
    return [
        Claim(
            "in all cases the wear volume grows with the amplitude",
            f"ΔV in a0⁴/R for k = −0.5, 0, 0.5: {_rows(volume, '.4f')}",
            _whether(bool(np.all(np.diff(volume, axis=0) > 0.0))),
        ),
        Claim(
            "the wear volume is greater for negative exponents than for k = 0, and smaller for positive ones",
            f"so it is at these amplitudes, and between φ = {n['crossing, k = 0 and 0.5']:.4f} and "
            f"{n['second crossing, k = 0 and 0.5']:.4f}",
            _whether(bool(np.all(np.diff(volume, axis=1) < 0.0))),
        ),
        Claim(
            "the entire worn area decreases with the exponent",
            f"(a∞² − c²)/a0² for k = −0.5, 0, 0.5: {_rows(area, '.4f')}",
            _whether(bool(np.all(np.diff(area, axis=1) < 0.0))),
        ),
        Claim(
            "the amount of curvature of the worn area increases with the exponent",
            f"8 (deepest wear)/(a∞ − c)² in 1/R for k = −0.5, 0, 0.5: {_rows(bend, '.3f')}",
            _whether(bool(np.all(np.diff(bend, axis=1) > 0.0))),
        ),
    ]


@_of_paper("8", "Fig. 8", "Limiting profiles for three amplitudes and exponents", (COLUMN, 14.5), _check_profiles)
def limiting_profiles(page: FigureBase) -> None:
    """Fig. 8: f_inf for three amplitudes and k = -0.5, 0, 0.5, whose contact radius is the same; Eq. (27)."""
    panels = page.subplots(3, 1, sharex=True, sharey=True)
    for k, axes in zip(EXPONENTS, panels, strict=True):
        r = np.linspace(0.0, 2.0, 401)
        axes.plot(r, 0.5 * r**2, label="unworn", **THIN)
        for phi, style in zip(AMPLITUDES, OF_AMPLITUDE, strict=True):
            inner, outer = float(fretting.stick_radius(k, phi)), float(fretting.worn_radius(k, phi))
            # close to the stick edge the profile rises like a power of the distance
            ring = inner + (outer - inner) * np.linspace(0.0, 1.0, 201) ** 3
            axes.plot(ring, np.asarray(fretting.profile(ring, k, phi)), label=_of_phi(phi), **style)
            axes.plot([inner, outer], [0.5 * inner**2, 0.5 * outer**2], ".", color=style["color"], markersize=4.0)
        axes.set_ylabel(r"$f_\infty\, R/a_0^2$")
        axes.set(xlim=(0.0, 2.0), ylim=(0.0, 1.6))
        axes.set_xticks([0.0, 0.5, 1.0, 1.5, 2.0])
    _legend_above(page, panels[0])
    panels[-1].set_xlabel("$r/a_0$")
    _letters(panels, [_of_k(k) for k in EXPONENTS])


def _check_volumes() -> list[Claim]:
    n = numbers()
    pair = [n["crossing, k = -0.99 and 0.99"], n["crossing, k = -0.5 and 0.5"], n["crossing, slope at k = 0"]]
    phi = np.linspace(0.3, 0.99, 139)
    large = np.asarray(fretting.wear_volume(np.array(EXPONENTS)[:, None], phi))
    again = [n[f"second crossing, k = {pair}"] for pair in ("-0.5 and 0", "-0.5 and 0.5", "0 and 0.5")]
    return [
        Claim(
            "amplitudes less than about 20 % of μ F_N cause more wear if the surface is soft and the ground hard",
            f"the volumes of −k and k cross at φ = {pair[0]:.4f} (|k| = 0.99), {pair[1]:.4f} (0.5) and {pair[2]:.4f} "
            f"(k → 0); those of k = 0 and −0.5 at {n['crossing, k = -0.5 and 0']:.4f}, of k = 0 and 0.5 at "
            f"{n['crossing, k = 0 and 0.5']:.4f}",
            _whether(all(round(x, 1) == 0.2 for x in pair)),
        ),
        Claim(
            "high amplitudes require a positive exponent to minimize wear",
            f"of k = −0.5, 0 and 0.5 the last wears least up to φ = {min(again):.4f} and most from "
            f"{max(again):.4f} on, close to gross slip",
            _whether(False, in_part=bool(np.all(np.diff(large, axis=0) < 0.0))),
        ),
    ]


@_of_paper("9", "Fig. 9", "Wear volume over the amplitude", (PAGE, 7.6), _check_volumes)
def wear_volumes(page: FigureBase) -> None:
    """Fig. 9: the wear volume of Eq. (28) over phi; red is negative, blue positive; beside it over that of k = 0."""
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
        whole.plot(phi, np.asarray(fretting.wear_volume(k, phi)), label=_of_k(k), **style)
        for axes, x, some in ((low, small, small), (high, left, 1.0 - left)):
            axes.plot(x, np.asarray(fretting.wear_volume(k, some) / fretting.wear_volume(0.0, some)), **style)
    turn = numbers()["crossing, slope at k = 0"]
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
    _letters([whole, low, high])


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
            _whether(bool(np.all(np.diff(mean, axis=1) < 0.0))),
        ),
        Claim(
            "the stress singularity becomes milder with the exponent",
            f"p∞ grows like δ^−n with n = {orders[0]} for k = −0.5, 0, 0.5",
            _whether(bool(np.all(np.diff(order[0]) < 0.0) and np.allclose(order[0], 0.5 * (1 - k), atol=1e-3))),
        ),
        Claim(
            "the same applies to the tangential stresses according to Eq. (21)",
            f"τ∞ grows like δ^−n with n = {orders[1]}",
            _whether(bool(np.all(np.diff(order[1]) < 0.0) and np.allclose(order[1], 0.5 * (1 - k), atol=1e-3))),
        ),
    ]


def _traction(distance: np.ndarray, k: np.ndarray, phi: float) -> np.ndarray:
    return np.asarray(fretting.steady_traction(np.asarray(fretting.stick_radius(k, phi)) - distance, k, phi))


@_of_paper("10", "Fig. 10", "Pressures in the fully worn state", (COLUMN, 14.5), _check_pressures)
def worn_pressures(page: FigureBase) -> None:
    """Fig. 10, printed as a second Fig. 9: p_inf for three amplitudes and k = -0.5, 0, 0.5."""
    panels = page.subplots(3, 1, sharex=True, sharey=True)
    for k, axes in zip(EXPONENTS, panels, strict=True):
        r = np.sin(np.linspace(0.0, 0.5 * np.pi, 301))
        axes.plot(r, np.asarray(fretting.initial_pressure(r, k)), label="unworn", **THIN)
        for phi, style in zip(AMPLITUDES, OF_AMPLITUDE, strict=True):
            stick = float(fretting.stick_radius(k, phi))
            inside = stick * (1.0 - np.geomspace(1.0, 1e-9, 401))
            axes.plot(inside, np.asarray(fretting.steady_pressure(inside, k, phi)), label=_of_phi(phi), **style)
            axes.axvline(stick, **GUIDE | {"color": style["color"]})
        axes.set_ylabel(r"$p_\infty\, \pi a_0^2/F_N$")
        axes.set(xlim=(0.0, 1.05), ylim=(0.0, 5.0))
    _legend_above(page, panels[0])
    panels[-1].set_xlabel("$r/a_0$")
    _letters(panels, [_of_k(k) for k in EXPONENTS])


# --- all of them ----------------------------------------------------------------------------------------------------


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a .png or .pdf file, which afterwards is either whole or as it was before.

    The same figure gives the same bytes: no date is written.

    Raises:
        TargetError: The place cannot be written to.
    """
    kind = Path(path).suffix[1:].lower()
    said = {"CreationDate": None} if kind == "pdf" else {"Software": None}
    with rc_context(STYLE):
        _files.write(path, lambda target: figure.savefig(target, format=kind, metadata=said))


def contact_sheet(figures: Sequence[PaperFigure]) -> Figure:
    """All figures beside each other on one page, each under its label."""
    ends, places = [0.0, 0.0], []
    for strip in _strips(figures):
        side = ends.index(min(ends))
        top, ends[side] = ends[side], ends[side] + max(figure.size[1] for figure in strip) + 0.7
        places += [(figure, 2 * side + n, top, ends[side]) for n, figure in enumerate(strip)]
    edges = sorted({edge for _, _, top, bottom in places for edge in (top, bottom)})
    count = 4 if ends[1] else 2
    with rc_context(STYLE):
        size = (0.5 * count * PAGE * CENTIMETRE, edges[-1] * CENTIMETRE)
        page = Figure(figsize=size, dpi=300, layout="constrained")
        grid = page.add_gridspec(len(edges) - 1, count, height_ratios=np.diff(edges))
        for figure, column, top, bottom in places:
            width = 1 if figure.size[0] <= COLUMN else 2
            rows = slice(edges.index(top), edges.index(bottom))
            part = page.add_subfigure(grid[rows, column : column + width])
            figure.draw(part)
            part.suptitle(figure.label, x=0.01, ha="left", fontsize=10, weight="bold")
    return page


def _strips(figures: Sequence[PaperFigure]) -> list[list[PaperFigure]]:
    """Single wide figures, and pairs of narrow ones."""
    wide = [[figure] for figure in figures if figure.size[0] > COLUMN]
    narrow = sorted(
        (figure for figure in figures if figure.size[0] <= COLUMN), key=lambda figure: figure.size[1] > 10.0
    )
    strips = wide + [narrow[n : n + 2] for n in range(0, len(narrow), 2)]
    order = list(figures)
    return sorted(strips, key=lambda strip: order.index(strip[0]))
