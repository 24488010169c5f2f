"""What the figures share: what the paper draws and says, the numbers of its text, and sketches of contacts."""

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax
import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from scipy import optimize

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax._core.units import text_cells
from plgwear_jax.contact import GrossSlipContact
from plgwear_jax.plots.style import BLUE, DASH_DOT, DASHED, DOTTED, GREEN, ORANGE, STYLE, Style, page

COLUMN, PAGE = 8.6, 17.8  # widths in cm
EXPONENTS = np.array([-0.5, 0.0, 0.5])
AMPLITUDES = np.array([0.3, 0.6, 0.9])  # the paper shows three and does not say which
DEPTHS = (0.1, 1.0, 10.0)  # z0/a in Fig. 5, which the paper does not state either
PAIRS = np.array([0.2, 0.5, 0.8])  # abs(k) in Fig. 9
ALMOST = 1.0 - 1e-9

# Orange is k < 0, which is red in the paper, and blue k > 0.
OF_EXPONENT: dict[float, Style] = {
    -0.5: {"color": ORANGE, "linestyle": DASHED},
    0.0: {"color": "k", "linestyle": DASH_DOT, "linewidth": 1.1},
    0.5: {"color": BLUE},
}
OF_AMPLITUDE: dict[float, Style] = {
    phi: {"color": colour, "linestyle": dashes, "label": rf"$F_x/(\mu F_N) = {phi:g}$"}
    for phi, colour, dashes in zip(AMPLITUDES, (GREEN, "#E69F00", "#AA4499"), ("-", DASHED, DASH_DOT), strict=True)
}
WORN: Style = {"facecolor": "#BFDDEE", "edgecolor": BLUE, "hatch": "////", "linewidth": 0.0, "zorder": 3.5}
_THIN: Style = {"color": "0.3", "linewidth": 0.7, "zorder": 5}


# --- statements -------------------------------------------------------------------------------------------------------


class Claim(NamedTuple):
    """A statement of the paper, and the result of the library."""

    said: str
    """In the words of the paper, or nearly."""
    found: str
    """What the library gives, with numbers."""
    agrees: bool
    in_part: bool = False
    """Whether it agrees in part, if not in all."""

    @property
    def verdict(self) -> str:
        """One of "agrees", "agrees in part", "differs"."""
        return "agrees" if self.agrees else "agrees in part" if self.in_part else "differs"


class PaperFigure(NamedTuple):
    """A figure or table of the paper, how it is drawn, and how its claims are checked."""

    key: str
    """Key on the command line: "4" for Fig. 4, "table-1", "eq-27"."""
    label: str
    title: str
    size: tuple[float, float]
    """Width and height in cm."""
    check: Callable[[], list[Claim]]
    draw_on: Callable[[FigureBase], None]
    """Draws the figure on a page, or on a part of a page."""

    def draw(self) -> Figure:
        """The figure on a page of its own."""
        with rc_context(STYLE):
            figure = page(*self.size)
            self.draw_on(figure)
        return figure

    @property
    def stem(self) -> str:
        """The name of the figure's files without suffix."""
        return f"fig-{int(self.key):02d}" if self.key.isdigit() else self.key


FIGURES: dict[str, PaperFigure] = {}
_Drawing = Callable[[FigureBase], None]


def rising(values: Any, axis: int = 0) -> bool:
    """Whether values rise along an axis."""
    return bool(np.all(np.diff(values, axis=axis) > 0.0))


def verdict(claims: Sequence[Claim]) -> str:
    """The least favourable verdict of several claims."""
    return max((claim.verdict for claim in claims), key=("agrees", "agrees in part", "differs").index)


def of_paper(
    key: str, label: str, title: str, size: tuple[float, float], check: Callable[[], list[Claim]]
) -> Callable[[_Drawing], _Drawing]:
    """A decorator that enters a drawing function into `FIGURES`."""

    def enter(draw_on: _Drawing) -> _Drawing:
        FIGURES[key] = PaperFigure(key, label, title, size, functools.cache(check), draw_on)
        return draw_on

    return enter


# --- numbers ----------------------------------------------------------------------------------------------------------


def root(function: Callable[[float], Any], lower: float, upper: float) -> float:
    """The root of a function between two places, to rounding."""
    return optimize.brentq(lambda x: float(function(x)), lower, upper, xtol=1e-15, rtol=1e-14)  # pyright: ignore


def _equal_at(quantity: Callable[..., Any], one: float, other: float, lower: float, upper: float) -> float:
    """The amplitude between two at which a quantity is the same for both exponents."""
    return root(lambda phi: np.log(quantity(one, phi)) - np.log(quantity(other, phi)), lower, upper)


def stiffness_of(k: Any, nu: Any) -> np.ndarray:
    """F_N0/(2 E0 d a) of Eq. (8) for z0 = a; "admissible" is the smaller one of Holl's ratio and 1/2."""
    ratio = np.minimum(material.holl_ratio(k), 0.5) if nu == "admissible" else nu
    punch = GrossSlipContact(material.PowerLawGraded(1.0, 1.0, k, ratio), 1.0, 1.0)
    return np.asarray(punch.steady().initial_force) / 2.0


def balance_of(k: Any, nu: float | str) -> Any:
    """z0/a at which the initial force equals that on the homogeneous half-space with the same E0, Eq. (8)."""
    return np.exp(np.log(stiffness_of(k, nu) / stiffness_of(0.0, nu)) / k)


def modulus_factor(k: Any, nu: Any) -> Any:
    """E0/(1-nu^2) over E/(1-nu^2) of the homogeneous material with the same contact radius a_0 = z0, Eq. (12)."""
    return (1.0 + k) ** 2 * (3.0 + k) / (3.0 * material.h_N(k, nu))


def listed(values: Any, form: str, name: str = "") -> str:
    """Values at the three exponents, in words."""
    return f"k = −0.5, 0, 0.5: {name}{', '.join(format(x, form) for x in values)}"


class TextNumber(NamedTuple):
    """A number of the paper's text, or one that the text leaves open."""

    words: str
    where: str
    printed: str
    """As the paper prints it; empty if it does not."""


# Names, what they are, where the paper has them, and what it prints; columns are set off by two spaces.
_TABLE = """
    best_k  exponent of the greatest effective volume change  Fig. 4  0.169
    best_change  greatest ΔV/(π a² d)  Fig. 4  15.5 %
    change_stiff  ΔV/(π a² d) at k = −0.5  Fig. 2  -
    change_compliant  ΔV/(π a² d) at k = 0.5  Fig. 3  -
    edge_stiff  w∞(a)/d at k = −0.5  Fig. 2  -
    edge_compliant  w∞(a)/d at k = 0.5  Fig. 3  -
    least_ratio  least F_N∞/F_N0, at k = 0  Eq. (10)  less than 1
    ratio_graded  F_N∞/F_N0 at k = −0.5 and 0.5  Eq. (10)  less than 1
    gibson  F_N0/(2 E0 d a) for z0 = a, ν = 1/2, k = 1 − 10⁻⁹  Sec. 2  not zero
    vanishing  the same with ν = 0.3  Sec. 2  tends to zero
    balance_stiff  z0/a at which F_N0 is that of k = 0: k = −0.5, ν = 1/2  Table 1  1
    balance_compliant  z0/a at which F_N0 is that of k = 0: k = 0.5, Holl's ratio  Table 1  1
    factor_stiff  factor of E0/(1−ν²), k = −0.5, Holl's ratio  Eq. (27)  0.88
    factor_compliant  factor of E0/(1−ν²), k = 0.5, Holl's ratio  Eq. (27)  2.06
    factor_stiff_half  the same for ν = 1/2 in both, k = −0.5  Eq. (27)  -
    factor_compliant_half  the same for ν = 1/2 in both, k = 0.5  Eq. (27)  -
    modulus_stiff  factor of E0 itself, k = −0.5, Holl's ratio in both  Eq. (27)  -
    modulus_compliant  factor of E0 itself, k = 0.5, Holl's ratio in both  Eq. (27)  -
    turn  φ at which the wear volumes of −k and k cross, k → 0  Fig. 9  about 20 %
    turn_pair  φ at which those of k = −0.5 and 0.5 cross  Fig. 9  about 20 %
    turn_widest  φ at which those of k = −0.99 and 0.99 cross  Fig. 9  about 20 %
    turn_stiff  φ at which those of k = −0.5 and 0 cross  Fig. 9  about 20 %
    turn_stiffest  φ at which those of k = −0.99 and 0 cross  Fig. 9  about 20 %
    turn_compliant  φ at which those of k = 0 and 0.5 cross  Fig. 9  about 20 %
    return_pair  φ at which those of k = −0.5 and 0.5 cross again  Fig. 9  not mentioned
    return_stiff  φ at which those of k = −0.5 and 0 cross again  Fig. 9  not mentioned
    return_compliant  φ at which those of k = 0 and 0.5 cross again  Fig. 9  not mentioned
    rings_pair  φ at which a∞ of k = −0.5 and 0.5 are the same  Fig. 7  not mentioned
    rings_stiff  φ at which a∞ of k = −0.5 and 0 are the same  Fig. 7  not mentioned
    rings_compliant  φ at which a∞ of k = 0 and 0.5 are the same  Fig. 7  not mentioned
"""
NUMBERS = {name: TextNumber(*about) for name, *about in text_cells(_TABLE)}
# The exponents whose wear volumes are compared; every second pair is drawn, and compared once more, with its rings.
_COMPARED = (-0.5, 0.5), (-0.99, 0.99), (-0.5, 0.0), (-0.99, 0.0), (0.0, 0.5)


@functools.cache
def numbers() -> Mapping[str, float]:
    """The values of `NUMBERS` as computed by the library, by name."""
    slope, by_k = jax.jit(jax.grad(gross_slip.volume_change)), jax.jit(jax.grad(fretting.wear_volume))
    best, both, factors = root(slope, -0.5, 0.9), EXPONENTS[::2], modulus_factor(EXPONENTS, "holl")
    plane = 1.0 - material.holl_ratio(EXPONENTS) ** 2
    values = [
        best,
        gross_slip.volume_change(best),
        *gross_slip.volume_change(both),
        *gross_slip.steady_displacement(1.0, both),
        *gross_slip.force_ratio(EXPONENTS[1:]),
        *(stiffness_of(ALMOST, nu) for nu in (0.5, 0.3)),
        balance_of(EXPONENTS[0], 0.5),
        balance_of(EXPONENTS[2], "holl"),
        *factors[::2],
        *modulus_factor(both, 0.5),
        *(factors * plane / plane[1])[::2],
        root(lambda phi: by_k(0.0, phi), 0.1, 0.4),
        *(_equal_at(fretting.wear_volume, *pair, 0.05, 0.5) for pair in _COMPARED),
        *(_equal_at(fretting.wear_volume, *pair, 0.9, 0.9999) for pair in _COMPARED[::2]),
        *(_equal_at(fretting.worn_radius, *pair, 0.9, 0.99999) for pair in _COMPARED[::2]),
    ]
    return dict(zip(NUMBERS, map(float, values), strict=True))


# --- sketches ---------------------------------------------------------------------------------------------------------


def crowded(lower: float, upper: float, count: int) -> np.ndarray:
    """Numbers between two of -1 to 1, dense towards 1 and -1, where functions have infinite slopes."""
    return np.sin(0.5 * np.pi * np.linspace(lower, upper, count))


def of_k(k: float) -> str:
    """An exponent as a label."""
    return f"$k = {k:g}$"


def sketch(axes: Axes, surface: Any, body: Any, depth: Any, top: float, bottom: float) -> None:
    """Draw a rigid body in a half-space whose shade grows with the depth like the modulus, between two heights.

    Both outlines are (radii, z) from the axis outwards, and mirrored. The sketch is to scale, without axes, with lines
    along the unworn surface and along the axis of the contact, down to the depth.
    """
    (x, z), outline = (np.hstack([np.flip(half, 1) * [[-1.0], [1.0]], half]) for half in (surface, body))
    shade, extent = np.sqrt(np.linspace(0.0, 1.0, 256))[:, None], (x[0], x[-1], bottom, z.min())
    axes.imshow(shade, cmap="Blues", vmin=-0.25, vmax=2.2, extent=extent, aspect="auto", zorder=0)
    axes.fill_between(x, z.min(), z, color="w", linewidth=0.0, zorder=1)
    axes.plot(x, z, color=BLUE, zorder=4)
    axes.fill(*outline, facecolor="0.88", edgecolor="k", linewidth=0.9, zorder=3)
    axes.axhline(0.0, linestyle=DOTTED, **_THIN)
    axes.plot([0.0, 0.0], [outline[1].min(), depth], linestyle=DASH_DOT, **_THIN)
    axes.set(xlim=x[[0, -1]], ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()


def arrow(axes: Axes, start: Any, end: Any, words: str, at: tuple[Any, Any], heads: str = "-|>") -> None:
    """An arrow from start to end, or with two heads the length between both, and words at a place."""
    style = {"arrowstyle": heads, "shrinkA": 0.0, "shrinkB": 0.0, "color": "k"}
    axes.annotate("", end, start, arrowprops=style, zorder=6)
    axes.text(*at, words, fontsize=9, ha="center", va="center", zorder=7)
