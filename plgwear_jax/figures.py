"""The figures and tables of the paper, drawn by the library, with checks of the statements of the paper.

Each function draws one figure for print; `FIGURES` lists them with the statements of the text that belong to them, and
`numbers` computes the numbers of the text. Needs the extra `plots`, and `jax_enable_x64` for all digits.
"""

import functools
import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.patches import Patch, Polygon
from matplotlib.ticker import FixedLocator
from scipy import optimize

from plgwear_jax import fretting, gross_slip, material, plots
from plgwear_jax.plots.style import CENTIMETRE

__all__ = [
    "FIGURES",
    "NUMBERS",
    "Asked",
    "Claim",
    "PaperFigure",
    "contact_sheet",
    "edge_radii",
    "effective_volume_change",
    "force_tendencies",
    "fretting_set_up",
    "gradients_of_equal_contact",
    "gross_slip_set_up",
    "limiting_profiles",
    "normal_forces",
    "numbers",
    "punch_on_hard_surface",
    "punch_on_soft_surface",
    "report",
    "save",
    "verdict",
    "wear_volumes",
    "worn_pressures",
]

# --- style ----------------------------------------------------------------------------------------------------------

COLUMN, PAGE = 8.6, 17.8  # widths in cm

STYLE: Any = {  # settings of Matplotlib
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
    "savefig.dpi": "figure",
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
    """A statement of the paper, and the result of the library."""

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
    draw: Callable[[], Figure]
    draw_on: Callable[[FigureBase], None]
    """Draws it on a page or a part of one."""
    check: Callable[[], list[Claim]]

    @property
    def stem(self) -> str:
        """The name of its files without suffix."""
        return f"fig-{int(self.key):02d}" if self.key.isdigit() else self.key


FIGURES: dict[str, PaperFigure] = {}


def verdict(claims: Sequence[Claim]) -> str:
    """The least favourable verdict of several claims."""
    return max((claim.verdict for claim in claims), key=VERDICTS.index)


def _whether(agrees: bool, in_part: bool = False) -> str:
    return "agrees" if agrees else "agrees in part" if in_part else "differs"


def _of_paper(
    key: str, label: str, title: str, size: tuple[float, float], check: Callable[[], list[Claim]]
) -> Callable[[Callable[[FigureBase], None]], Callable[[], Figure]]:
    """Enter a drawing into `FIGURES`, and give it a page of its own."""

    def enter(content: Callable[[FigureBase], None]) -> Callable[[], Figure]:
        def draw_on(page: FigureBase) -> None:
            with rc_context(STYLE):
                content(page)

        @functools.wraps(content, assigned=("__module__", "__name__", "__qualname__", "__doc__"), updated=())
        def draw() -> Figure:
            page = Figure(figsize=(size[0] * CENTIMETRE, size[1] * CENTIMETRE), dpi=300, layout="constrained")
            draw_on(page)
            return page

        del draw.__wrapped__  # it takes a page
        FIGURES[key] = PaperFigure(key, label, title, size, draw, draw_on, functools.cache(check))
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


class Asked(NamedTuple):
    """A number of the paper's text, or one that the text leaves open."""

    words: str
    where: str
    printed: str
    """As the paper prints it; empty if it does not."""


NUMBERS: Mapping[str, Asked] = {
    "best_k": Asked("exponent of the greatest effective volume change", "Fig. 4", "0.169"),
    "best_change": Asked("greatest ΔV/(π a² d)", "Fig. 4", "15.5 %"),
    "change_hard": Asked("ΔV/(π a² d) at k = −0.5", "Fig. 2", ""),
    "change_soft": Asked("ΔV/(π a² d) at k = 0.5", "Fig. 3", ""),
    "edge_hard": Asked("w∞(a)/d at k = −0.5", "Fig. 2", ""),
    "edge_soft": Asked("w∞(a)/d at k = 0.5", "Fig. 3", ""),
    "least_ratio": Asked("least F_N∞/F_N0, at k = 0", "Eq. (10)", "less than 1"),
    "ratio_graded": Asked("F_N∞/F_N0 at k = −0.5 and 0.5", "Eq. (10)", "less than 1"),
    "gibson": Asked("F_N0/(2 E0 d a) for z0 = a, ν = 1/2, k = 1 − 10⁻⁹", "Sec. 2", "not zero"),
    "vanishing": Asked("the same with ν = 0.3", "Sec. 2", "tends to zero"),
    "balance_hard": Asked("z0/a at which F_N0 is that of k = 0: k = −0.5, ν = 1/2", "Table 1", "1"),
    "balance_soft": Asked("z0/a at which F_N0 is that of k = 0: k = 0.5, Holl's ratio", "Table 1", "1"),
    "factor_hard": Asked("factor of E0/(1−ν²), k = −0.5, Holl's ratio", "Eq. (27)", "0.88"),
    "factor_soft": Asked("factor of E0/(1−ν²), k = 0.5, Holl's ratio", "Eq. (27)", "2.06"),
    "factor_hard_half": Asked("the same for ν = 1/2 in both, k = −0.5", "Eq. (27)", ""),
    "factor_soft_half": Asked("the same for ν = 1/2 in both, k = 0.5", "Eq. (27)", ""),
    "modulus_hard": Asked("factor of E0 itself, k = −0.5, Holl's ratio in both", "Eq. (27)", ""),
    "modulus_soft": Asked("factor of E0 itself, k = 0.5, Holl's ratio in both", "Eq. (27)", ""),
    "turn": Asked("φ at which the wear volumes of −k and k cross, k → 0", "Fig. 9", "about 20 %"),
    "turn_pair": Asked("φ at which those of k = −0.5 and 0.5 cross", "Fig. 9", "about 20 %"),
    "turn_widest": Asked("φ at which those of k = −0.99 and 0.99 cross", "Fig. 9", "about 20 %"),
    "turn_hard": Asked("φ at which those of k = −0.5 and 0 cross", "Fig. 9", "about 20 %"),
    "turn_hardest": Asked("φ at which those of k = −0.99 and 0 cross", "Fig. 9", "about 20 %"),
    "turn_soft": Asked("φ at which those of k = 0 and 0.5 cross", "Fig. 9", "about 20 %"),
    "return_pair": Asked("φ at which those of k = −0.5 and 0.5 cross again", "Fig. 9", "not mentioned"),
    "return_hard": Asked("φ at which those of k = −0.5 and 0 cross again", "Fig. 9", "not mentioned"),
    "return_soft": Asked("φ at which those of k = 0 and 0.5 cross again", "Fig. 9", "not mentioned"),
    "rings_pair": Asked("φ at which a∞ of k = −0.5 and 0.5 are the same", "Fig. 7", "not mentioned"),
    "rings_hard": Asked("φ at which a∞ of k = −0.5 and 0 are the same", "Fig. 7", "not mentioned"),
    "rings_soft": Asked("φ at which a∞ of k = 0 and 0.5 are the same", "Fig. 7", "not mentioned"),
}


@functools.cache
def numbers() -> Mapping[str, float]:
    """The numbers of `NUMBERS`, from the library, by name."""
    slope, by_k = jax.jit(jax.grad(gross_slip.volume_change)), jax.jit(jax.grad(fretting.wear_volume))
    best = _root(slope, -0.5, 0.9)
    volume, outer = fretting.wear_volume, fretting.worn_radius
    plane = {k: 1.0 - float(_poisson(k, "holl")) ** 2 for k in EXPONENTS}
    return {
        "best_k": best,
        "best_change": float(gross_slip.volume_change(best)),
        "change_hard": float(gross_slip.volume_change(-0.5)),
        "change_soft": float(gross_slip.volume_change(0.5)),
        "edge_hard": float(gross_slip.steady_displacement(1.0, -0.5)),
        "edge_soft": float(gross_slip.steady_displacement(1.0, 0.5)),
        "least_ratio": float(gross_slip.force_ratio(0.0)),
        "ratio_graded": float(gross_slip.force_ratio(0.5)),
        "gibson": float(_stiffness(ALMOST, 0.5)),
        "vanishing": float(_stiffness(ALMOST, 0.3)),
        "balance_hard": float(_balance(-0.5, 0.5)),
        "balance_soft": float(_balance(0.5, "holl")),
        "factor_hard": _modulus_factor(-0.5, "holl"),
        "factor_soft": _modulus_factor(0.5, "holl"),
        "factor_hard_half": _modulus_factor(-0.5, 0.5),
        "factor_soft_half": _modulus_factor(0.5, 0.5),
        "modulus_hard": _modulus_factor(-0.5, "holl") * plane[-0.5] / plane[0.0],
        "modulus_soft": _modulus_factor(0.5, "holl") * plane[0.5] / plane[0.0],
        "turn": _root(lambda phi: by_k(0.0, phi), 0.1, 0.4),
        "turn_pair": _crossing(volume, -0.5, 0.5, 0.1, 0.4),
        "turn_widest": _crossing(volume, -0.99, 0.99, 0.1, 0.4),
        "turn_hard": _crossing(volume, -0.5, 0.0, 0.05, 0.4),
        "turn_hardest": _crossing(volume, -0.99, 0.0, 0.05, 0.4),
        "turn_soft": _crossing(volume, 0.0, 0.5, 0.1, 0.5),
        "return_pair": _crossing(volume, -0.5, 0.5, 0.9, 0.9999),
        "return_hard": _crossing(volume, -0.5, 0.0, 0.9, 0.9999),
        "return_soft": _crossing(volume, 0.0, 0.5, 0.9, 0.9999),
        "rings_pair": _crossing(outer, -0.5, 0.5, 0.9, 0.99999),
        "rings_hard": _crossing(outer, -0.5, 0.0, 0.9, 0.99999),
        "rings_soft": _crossing(outer, 0.0, 0.5, 0.9, 0.99999),
    }


# --- sketches -------------------------------------------------------------------------------------------------------

_ARROW: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.0, "color": "k", "shrinkA": 0.0, "shrinkB": 0.0}
_SPAN: dict[str, Any] = _ARROW | {"arrowstyle": "<->", "linewidth": 0.7}
_BODY: dict[str, Any] = {"facecolor": "0.88", "edgecolor": "k", "linewidth": 0.9, "zorder": 3}


def _ground(axes: Axes, r: np.ndarray, z: np.ndarray, bottom: float) -> None:
    """The half-space below its surface z(r), shaded as the modulus grows with the depth."""
    r, z = np.concatenate([-r[::-1], r]), np.concatenate([z[::-1], z])
    body = Polygon([*zip(r, z, strict=True), (r[-1], bottom), (r[0], bottom)], facecolor="none", edgecolor="none")
    axes.add_patch(body)
    shade = np.sqrt(np.linspace(0.0, 1.0, 256))[:, None]
    extent = (r[0], r[-1], bottom, float(z.min()))
    image = axes.imshow(shade, cmap="Blues", vmin=-0.25, vmax=2.2, extent=extent, aspect="auto", zorder=0)
    image.set_clip_path(body)
    axes.plot(r, z, color=BLUE, zorder=4)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], style: dict[str, Any]) -> None:
    axes.annotate("", end, start, arrowprops=style, zorder=6)


def _bare(axes: Axes, sides: float, top: float, bottom: float) -> None:
    axes.set(xlim=(-sides, sides), ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()


def _check_flat() -> list[Claim]:
    r, k = np.linspace(0.0, 0.999, 200), np.array([-0.5, 0.0, 0.5])[:, None]
    rises = bool(np.all(np.diff(np.asarray(gross_slip.initial_pressure(r, k)), axis=1) > 0.0))
    edge = [float(gross_slip.initial_pressure(0.999, x)) for x in EXPONENTS]
    return [
        Claim(
            "the pressure is greatest at the edge, where it is singular, the milder the greater the exponent",
            "p0 at r = 0.999 a for k = −0.5, 0, 0.5: " + ", ".join(f"{x:.3g}" for x in edge) + " F_N0/(π a²)",
            _whether(rises and edge[0] > edge[1] > edge[2]),
        )
    ]


@_of_paper("1", "Fig. 1", "Gross slip of a flat punch: set-up and pressure", (PAGE, 5.6), _check_flat)
def gross_slip_set_up(page: FigureBase) -> None:
    """Fig. 1: a flat punch pressed into a graded half-space that moves below it.

    Beside it the pressure before and after wear, Eqs. (2), (9), for k = −0.5, 0, 0.5.
    """
    axes, pressures = page.subplots(1, 2, width_ratios=(1.25, 1.0))
    x = np.sin(np.linspace(0.0, 0.5 * np.pi, 301))[:-1]
    for k, style in OF_EXPONENT.items():
        pressures.plot([*x, 1.0], [*np.asarray(gross_slip.initial_pressure(x, k)), 99.0], label=_of_k(k), **style)
        pressures.plot([0.0, 1.0], [float(gross_slip.force_ratio(k))] * 2, **{**style, "linewidth": 0.8})
    pressures.text(0.03, 0.9, "steady", **NOTE)
    pressures.text(0.45, 0.12, "initial", **NOTE)
    pressures.set(xlim=(0.0, 1.05), ylim=(0.0, 3.0), xlabel="$r/a$", ylabel=r"$p\, \pi a^2/F_{N0}$")
    pressures.legend(loc="upper left")
    depth, sides, bottom = 0.42, 2.5, 1.55
    r = np.concatenate([np.linspace(0.0, 1.0, 3), 1.0 + (sides - 1.0) * np.linspace(0.0, 1.0, 101)[1:] ** 3])
    _ground(axes, r, depth * np.asarray(_initial_surface(r, 0.3)), bottom)
    axes.add_patch(Polygon([(-1.0, depth), (1.0, depth), (1.0, -0.75), (-1.0, -0.75)], **_BODY))
    axes.plot([-sides, sides], [0.0, 0.0], color="0.3", linewidth=0.7, linestyle=DOTTED, zorder=5)
    _arrow(axes, (0.0, -1.35), (0.0, -0.75), _ARROW)
    _arrow(axes, (0.0, depth - 0.12), (1.0, depth - 0.12), _SPAN)
    _arrow(axes, (-0.62, 0.0), (-0.62, depth), _SPAN)
    _arrow(axes, (0.9, 1.25), (2.1, 1.25), _ARROW)
    _arrow(axes, (-2.2, 0.0), (-2.2, 1.2), _ARROW | {"linewidth": 0.7})
    axes.plot([0.0, 0.0], [-0.75, depth], color="0.3", linewidth=0.6, linestyle=DASH_DOT, zorder=5)
    for x, z, text in (
        (0.12, -1.15, "$F_{N0}$"), (0.5, depth - 0.24, "$a$"), (-0.5, 0.5 * depth, "$d$"), (1.5, 1.08, "sliding"),
        (-2.08, 1.12, "$z$"), (-1.0, 1.18, r"$E(z)=E_0\left(z/z_0\right)^k$"),
    ):  # fmt: skip
        axes.text(x, z, text, fontsize=9, ha="left" if text[0] == "$" else "center", va="center", zorder=7)
    _bare(axes, sides, -1.4, bottom)
    _letters([axes, pressures])


# --- section 2: gross slip ------------------------------------------------------------------------------------------


def _check_punch(k: float) -> list[Claim]:
    r = np.linspace(1.0, 3.0, 201)[1:]
    outside = [
        np.asarray(field(r, exponent)) for field in (_initial_surface, _steady_surface) for exponent in (-0.5, 0.5)
    ]
    falls = bool(np.all(outside[1] < outside[0]) and np.all(outside[3] < outside[2]))
    n = numbers()
    depths = [1.0 - n["edge_hard"], 1.0 - n["edge_soft"]]
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
            f"p∞ = {n['ratio_graded']:.4f} F_N0/(π a²) at all r < a; shaded: {_change(k)}",
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
    initial: dict[str, Any] = {"color": BLACK, "linestyle": SOLID}
    steady: dict[str, Any] = {"color": RED, "linestyle": DASHED}
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
    """Fig. 2: punch and surface, initial and steady, for k = −0.5, Eqs. (3), (5); shaded: the volume of Eq. (6)."""
    _draw_punch(page, -0.5)


@_of_paper(
    "3", "Fig. 3", "Indenter profile and surface displacement for k = 0.5", (COLUMN, 6.6),
    functools.partial(_check_punch, 0.5),
)  # fmt: skip
def punch_on_soft_surface(page: FigureBase) -> None:
    """Fig. 3: the same as Fig. 2 for k = 0.5."""
    _draw_punch(page, 0.5)


def _check_change() -> list[Claim]:
    n = numbers()
    k, most = n["best_k"], n["best_change"]
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
    """Fig. 4: the effective volume change of the punch over the exponent, Eq. (7)."""
    axes = page.subplots()
    k = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 401)) * ALMOST
    best, most = numbers()["best_k"], numbers()["best_change"]
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
            _whether(
                abs(_stiffness(ALMOST, 0.5) - math.pi / 3.0) < 1e-6
                and max(_stiffness(-ALMOST, 0.5), _stiffness(-ALMOST, "holl"), _stiffness(ALMOST, "holl")) < 1e-6
            ),
        ),
    ]


@_of_paper("5", "Fig. 5", "Normal force in the initial and steady state", (PAGE, 7.0), _check_forces)
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
            f"everywhere but for k < {even:.3f} and z0 up to at most {right.max():.2f} a",
            _whether(bool(np.all(right <= 1.0)), in_part=bool(right.max() < 1.2)),
        ),
    ]


@_of_paper("table-1", "Table 1", "Normal force against the homogeneous half-space", (COLUMN, 7.4), _check_tendencies)
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
    meanings: Any = (("greater than at $k=0$", up), ("smaller than at $k=0$", down), ("not as in Table 1", wrong))
    patches = [Patch(label=words, **{**style, "edgecolor": "0.45"}) for words, style in meanings]
    axes.legend(handles=patches, loc="lower left", handlelength=1.8)
    axes.set(yscale="log", xlim=(-1.0, 1.0), ylim=(low, high), xlabel="exponent $k$", ylabel="$z_0/a$")
    axes.yaxis.set_major_locator(FixedLocator([0.1, 1.0, 10.0]))
    axes.set_yticklabels(["0.1", "1", "10"])
    axes.set_xticks([-1.0, -0.5, 0.0, 0.5, 1.0])


# --- section 3: fretting --------------------------------------------------------------------------------------------


def _check_paraboloid() -> list[Claim]:
    k, phi = np.array(EXPONENTS), np.array(AMPLITUDES)[:, None]
    stick, edge = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    r = np.linspace(0.0, 1.0, 50)[:, None, None] * stick
    same = bool(np.all(np.asarray(fretting.wear_depth(r, k, phi)) == 0.0))
    return [
        Claim(
            "in the stick area the final profile coincides with the initial one; around it is a worn ring",
            "f∞ = f0 at all r < c, and c < a0 < a∞ at all nine pairs of k and φ drawn in Fig. 8",
            _whether(same and bool(np.all(stick < 1.0) and np.all(edge > 1.0))),
        )
    ]


@_of_paper("6", "Fig. 6", "Partial slip of a parabolic indenter, set-up", (PAGE, 5.2), _check_paraboloid)
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
        _ground(axes, r, height * np.asarray(surface), bottom)
        shape = deep - height * np.asarray(profile)
        inside = shape > -0.55
        right = [*zip(r[inside], shape[inside], strict=True)]
        lid = [(right[-1][0], -0.62), (-right[-1][0], -0.62)]
        axes.add_patch(Polygon([*right, *lid, *((-x, z) for x, z in reversed(right))], **_BODY))
        axes.plot([-sides, sides], [0.0, 0.0], color="0.3", linewidth=0.7, linestyle=DOTTED, zorder=5)
        axes.plot([0.0, 0.0], [-0.62, deep], color="0.3", linewidth=0.6, linestyle=DASH_DOT, zorder=5)
        _arrow(axes, (0.0, -1.1), (0.0, -0.62), _ARROW)
        _arrow(axes, (0.0, -0.42), (-0.55, -0.42), _ARROW)
        _arrow(axes, (0.0, -0.42), (0.55, -0.42), _ARROW)
        axes.text(0.08, -0.95, "$F_N$", fontsize=9, va="center", zorder=7)
        axes.text(0.6, -0.42, "$F_x$", fontsize=9, va="center", zorder=7)
        for level, radius, text in ((deep + 0.14, stick, "c"), (deep + 0.42, outer, name)):
            start = deep - height * float(fretting.profile(radius, k, phi if outer == edge else 0.0))
            axes.plot([radius, radius], [start, level + 0.06], color="0.2", linewidth=0.5, zorder=5)
            _arrow(axes, (0.0, level), (radius, level), _SPAN)
            axes.text(0.5 * radius, level + 0.01, f"${text}$", fontsize=9, ha="center", va="top", zorder=7)
        _arrow(axes, (-1.75, 0.0), (-1.75, deep), _SPAN)
        axes.plot([-1.85, 0.0], [deep, deep], color="0.2", linewidth=0.5, zorder=5)
        axes.text(-1.68, 0.6 * deep, "$d_0$" if outer == 1.0 else r"$d_\infty$", fontsize=9, va="center", zorder=7)
        _bare(axes, sides, top, bottom)
    worn = np.linspace(stick, edge, 101)
    deep = height * float(fretting.penetration(k, phi))
    for side in (-1.0, 1.0):
        panels[1].plot(side * worn, deep - height * 0.5 * worn**2, color="k", linewidth=0.7, linestyle=DASHED, zorder=5)
        gone = [deep - height * 0.5 * worn**2, deep - height * np.asarray(fretting.profile(worn, k, phi))]
        panels[1].fill_between(
            side * worn, *gone, facecolor="#BFDDEE", edgecolor=BLUE, hatch="////", linewidth=0.0, zorder=3.5
        )
    _letters(panels, ("initial state", "steady state"))


_GRID = np.concatenate([np.geomspace(1e-6, 0.01, 40), np.linspace(0.02, 0.99, 98)])


def _check_radii() -> list[Claim]:
    n = numbers()
    inner = np.asarray(fretting.stick_radius(np.array(EXPONENTS)[:, None], _GRID))
    outer = np.asarray(fretting.worn_radius(np.array(EXPONENTS)[:, None], _GRID))
    grows, falls = bool(np.all(np.diff(inner, axis=0) > 0.0)), bool(np.all(np.diff(outer, axis=0) < 0.0))
    crossings = [n[f"rings_{name}"] for name in ("pair", "hard", "soft")]
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
    """Fig. 7: inner and outer radius of the worn ring, c and a∞, over φ for k = −0.5, 0, 0.5; Eqs. (16), (26)."""
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
    for name, k, printed in (("hard", -0.5, 0.88), ("soft", 0.5, 2.06)):
        factor, half, other = n[f"factor_{name}"], n[f"factor_{name}_half"], n[f"modulus_{name}"]
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
            f"so it is at these amplitudes, and wherever φ is between {max(n['turn_hard'], n['turn_soft']):.4f} and "
            f"{min(n['return_hard'], n['return_soft']):.4f}",
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
    """Fig. 8: limiting profiles of the indenter for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5, Eq. (25).

    The contact radius is the same for all, as by Eq. (27). Dots mark the edges of the worn ring.
    """
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
    pair = [n["turn_widest"], n["turn_pair"], n["turn"]]
    phi = np.linspace(0.3, 0.99, 139)
    large = np.asarray(fretting.wear_volume(np.array(EXPONENTS)[:, None], phi))
    again = [n["return_pair"], n["return_soft"]]
    return [
        Claim(
            "below about 20 % of μ F_N a compliant surface over a stiff interior wears more",
            f"the volumes of −k and k cross at φ = {pair[0]:.4f} (|k| = 0.99), {pair[1]:.4f} (0.5) and {pair[2]:.4f} "
            "(k → 0)",
            _whether(all(round(x, 1) == 0.2 for x in pair)),
        ),
        Claim(
            "in that range a negative exponent would reduce wear",
            f"k = −0.5 wears less than k = 0 below φ = {n['turn_hard']:.4f} only, k = −0.99 below "
            f"{n['turn_hardest']:.4f}; k = 0.5 wears more up to {n['turn_soft']:.4f}",
            _whether(n["turn_hard"] >= 0.195, in_part=n["turn_hard"] > 0.1),
        ),
        Claim(
            "high amplitudes require a positive exponent to minimize wear",
            f"of k = −0.5, 0 and 0.5 the last wears least from φ = {n['turn_soft']:.4f} to {min(again):.4f}, and most "
            f"from {max(again):.4f} on, close to gross slip",
            _whether(False, in_part=bool(np.all(np.diff(large, axis=0) < 0.0))),
        ),
    ]


@_of_paper("9", "Fig. 9", "Wear volume over the amplitude", (PAGE, 7.6), _check_volumes)
def wear_volumes(page: FigureBase) -> None:
    """Fig. 9: the wear volume of Eq. (28) over φ, red for negative and blue for positive exponents.

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
        whole.plot(phi, np.asarray(fretting.wear_volume(k, phi)), label=_of_k(k), **style)
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
    """Fig. 10: the pressure of Eq. (17) in the worn state for φ = 0.3, 0.6, 0.9 and k = −0.5, 0, 0.5.

    It is printed as a second Fig. 9. Dotted lines mark the stick radius.
    """
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
    """Write a figure as `plots.save` does, in the style of these figures."""
    with rc_context(STYLE):
        plots.save(figure, path)


def report(figures: Sequence[PaperFigure]) -> str:
    """The statements of the paper about each figure, the results of the library, and the pictures, in Markdown."""
    parts = [
        "# The figures of the paper, from the library",
        "Written by `plgwear figures`. Each statement of the paper stands beside what the library gives; φ is "
        "F_x/(μ F_N). The paper does not say at which z0/a, ν, amplitudes and, in Fig. 9, exponents it draws: Fig. 5 "
        f"is drawn for z0/a = {_listed(DEPTHS)}, Figs. 8 and 10 for φ = {_listed(AMPLITUDES)}, Fig. 9 for |k| = "
        f"{_listed((0.0, *PAIRS))}. Fig. 10 is printed as a second Fig. 9.",
        "![All of them](contact-sheet.png)",
    ]
    for figure in figures:
        claims = figure.check()
        notes = " ".join(str(figure.draw.__doc__).split()).removeprefix(f"{figure.label}: ")
        rows = [(claim.said, claim.found, claim.verdict) for claim in claims]
        parts += [
            f"## {figure.label}: {figure.title}",
            f"![{figure.label}]({figure.stem}.png)",
            f"{notes[0].upper()}{notes[1:]} ([PDF]({figure.stem}.pdf))",
            _table(("The paper", "The library", ""), rows),
        ]
    rows = [
        (asked.where, asked.words, asked.printed or "—", f"{numbers()[name]:.8g}") for name, asked in NUMBERS.items()
    ]
    parts += ["## Numbers", _table(("", "", "The paper", "The library"), rows)]
    return "\n\n".join(parts) + "\n"


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)


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
        page = Figure(figsize=size, dpi=150, layout="constrained")
        grid = page.add_gridspec(len(edges) - 1, count, height_ratios=np.diff(edges))
        for figure, column, top, bottom in places:
            width = 1 if figure.size[0] <= COLUMN else 2
            rows = slice(edges.index(top), edges.index(bottom))
            part = page.add_subfigure(grid[rows, column : column + width])
            figure.draw_on(part)
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
