"""The numbers of the text."""

import functools
import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import numpy as np
from scipy import optimize

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax.plots.figures.sketch import ALMOST, EXPONENTS


class OfNumbers:
    """A room of dimensionless functions, whose results are here numbers and arrays of NumPy."""

    def __init__(self, room: Any):
        self.room = room

    def __getattr__(self, name: str) -> Callable[..., Any]:
        function = getattr(self.room, name)
        return lambda *at: np.asarray(function(*at))[()]


def root(function: Callable[[float], Any], lower: float, upper: float) -> float:
    """The root of a function between two places, to rounding."""
    return optimize.brentq(lambda x: float(function(x)), lower, upper, xtol=1e-15, rtol=1e-14)  # pyright: ignore


def _equal_at(quantity: Callable[..., Any], one: float, other: float, lower: float, upper: float) -> float:
    """The amplitude between two at which a quantity is the same for both exponents."""
    return root(lambda phi: np.log(quantity(one, phi)) - np.log(quantity(other, phi)), lower, upper)


def _poisson(k: Any, nu: float | str) -> np.ndarray:
    """Poisson's ratio: the number nu, Holl's ratio for "holl", the smaller of Holl's ratio and 1/2 for "admissible"."""
    holl = np.asarray(material.holl_ratio(k))
    return holl if nu == "holl" else np.minimum(holl, 0.5) if nu == "admissible" else np.full_like(holl, nu)


def stiffness_of(k: Any, nu: float | str) -> Any:
    """F_N0/(2 E0 d a) of Eq. (8) for z0 = a."""
    value = _poisson(k, nu)
    h_N = np.asarray(material.h_N(k, "holl" if nu == "holl" else value))
    return h_N / ((1.0 - value) * (1.0 + value) * (1.0 + np.asarray(k)))


def balance_of(k: Any, nu: float | str) -> Any:
    """z0/a at which the initial force equals that on the homogeneous half-space with the same E0, Eq. (8)."""
    return np.exp(np.log(stiffness_of(k, nu) / stiffness_of(0.0, nu)) / np.asarray(k))


def modulus_factor(k: Any, nu: Any) -> Any:
    """E0/(1-nu^2) over E/(1-nu^2) of the homogeneous material with the same contact radius a_0 = z0, Eq. (12)."""
    return (1.0 + k) ** 2 * (3.0 + k) / (3.0 * np.asarray(material.h_N(k, nu)))


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
NUMBERS: Mapping[str, TextNumber] = {
    name: TextNumber(words, where, printed.strip("-"))
    for name, words, where, printed in (re.split("  +", line.strip()) for line in _TABLE.strip().splitlines())
}
# The exponents whose wear volumes are compared; every second pair is drawn, and compared once more, with its rings.
_COMPARED = (-0.5, 0.5), (-0.99, 0.99), (-0.5, 0.0), (-0.99, 0.0), (0.0, 0.5)


@functools.cache
def numbers() -> Mapping[str, float]:
    """The values of `NUMBERS` as computed by the library, by name."""
    slope, by_k = jax.jit(jax.grad(gross_slip.volume_change)), jax.jit(jax.grad(fretting.wear_volume))
    best, both, factors = root(slope, -0.5, 0.9), EXPONENTS[::2], modulus_factor(EXPONENTS, "holl")
    plane = 1.0 - _poisson(EXPONENTS, "holl") ** 2
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
