"""What is said of the figures of the paper: their records, statements of the text, and its numbers."""

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax
import numpy as np
from matplotlib.figure import Figure, FigureBase
from scipy import optimize

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax._core.units import text_cells
from plgwear_jax.contact import GrossSlipContact

from ..style import page, picture

EXPONENTS = np.array([-0.5, 0.0, 0.5])
ALMOST = 1.0 - 1e-9


# --- statements -------------------------------------------------------------------------------------------------------


class Claim(NamedTuple):
    """A statement of the paper, and the result of the library."""

    said: str
    """In the words of the paper, or nearly."""
    found: str
    """What the library gives, with numbers."""
    agrees: Any
    in_part: Any = False
    """Whether it agrees in part, if not in all."""

    @property
    def verdict(self) -> str:
        """One of "agrees", "agrees in part", "differs"."""
        return "agrees" if self.agrees else "agrees in part" if self.in_part else "differs"


class PaperFigure(NamedTuple):
    """A figure or table of the paper, how it is drawn, and what the paper says about it."""

    key: str
    """Key on the command line: "4" for Fig. 4, "table-1", "eq-27"."""
    label: str
    title: str
    size: tuple[float, float]
    """Width and height in cm."""
    draw_on: Callable[[FigureBase], list[Claim]]
    """Draws the figure, as it is described there, on a page or on a part of it, and compares what the paper says."""

    @picture
    def draw(self) -> Figure:
        """The figure on a page of its own."""
        figure = page(*self.size)
        self.draw_on(figure)
        return figure

    def check(self) -> list[Claim]:
        """What the paper says about the figure, compared with the library."""
        return self.draw_on(page(*self.size))

    @property
    def stem(self) -> str:
        """The name of the figure's files without suffix."""
        return f"fig-{int(self.key):02d}" if self.key.isdigit() else self.key


def rising(values: Any) -> Any:
    """Whether values rise along their first axis."""
    return np.all(np.diff(values, axis=0) > 0.0)


def verdict(claims: Sequence[Claim]) -> str:
    """The least favourable verdict of several claims."""
    return max(claim.verdict for claim in claims)  # the better one comes first in the alphabet


# --- numbers ----------------------------------------------------------------------------------------------------------


def root(function: Callable[[float], Any], lower: float, upper: float) -> float:
    """The root of a function between two places, to rounding."""
    return optimize.brentq(function, lower, upper, xtol=1e-15)  # pyright: ignore


def _equal_at(quantity: Callable[..., Any], pairs: np.ndarray, lower: float, upper: float) -> list[float]:
    """The amplitudes between two at which a quantity is the same for both exponents of each pair."""
    return [root(lambda phi, pair=pair: np.diff(quantity(pair, phi))[0], lower, upper) for pair in pairs]


def stiffness_of(k: Any, nu: Any) -> Any:
    """F_N0/(2 E0 d a) of Eq. (8) for z0 = a; "admissible" is the smaller one of Holl's ratio and 1/2."""
    ratio = np.minimum(material.holl_ratio(k), 0.5) if nu == "admissible" else nu
    return GrossSlipContact(material.PowerLawGraded(0.5, 1.0, k, ratio), 1.0, 1.0).steady().initial_force


def balance_of(k: Any, nu: float | str) -> Any:
    """z0/a at which the initial force equals that on the homogeneous half-space with the same E0, Eq. (8)."""
    return (stiffness_of(k, nu) / stiffness_of(0.0, nu)) ** (1.0 / k)


def modulus_factor(k: Any, nu: Any) -> Any:
    """E0/(1-nu^2) over E/(1-nu^2) of the homogeneous material with the same contact radius a_0 = z0, Eq. (12)."""
    return (1.0 + k) ** 2 * (3.0 + k) / (3.0 * material.h_N(k, nu))


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
_COMPARED = np.array([(-0.5, 0.5), (-0.99, 0.99), (-0.5, 0.0), (-0.99, 0.0), (0.0, 0.5)])


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
        *_equal_at(fretting.wear_volume, _COMPARED, 0.05, 0.5),
        *_equal_at(fretting.wear_volume, _COMPARED[::2], 0.9, 0.9999),
        *_equal_at(fretting.worn_radius, _COMPARED[::2], 0.9, 0.99999),
    ]
    return dict(zip(NUMBERS, map(float, values), strict=True))
