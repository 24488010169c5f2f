"""The numbers of the text."""

import functools
import re
from collections.abc import Callable, Iterator, Mapping
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
    found: Any = optimize.brentq(lambda x: float(function(x)), lower, upper, xtol=1e-15, rtol=1e-14)
    return float(found)


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


def modulus_factor(k: float, nu: float | str) -> float:
    """E0/(1-nu^2) over E/(1-nu^2) of the homogeneous material with the same contact radius a_0 = z0, Eq. (12)."""
    h_N = float(material.h_N(k, nu))  # pyright: ignore[reportArgumentType]
    return (1.0 + k) ** 2 * (3.0 + k) / (3.0 * h_N)


def listed(values: Any, form: str, name: str = "") -> str:
    """Values at the three exponents, in words."""
    return f"k = −0.5, 0, 0.5: {name}{', '.join(format(x, form) for x in values)}"


class TextNumber(NamedTuple):
    """A number of the paper's text, or one that the text leaves open."""

    words: str
    where: str
    printed: str
    """As the paper prints it; empty if it does not."""


# The exponents whose wear volumes or rings are compared; those that are drawn compare twice.
_CROSSINGS = {
    **{"pair": (-0.5, 0.5), "widest": (-0.99, 0.99), "stiff": (-0.5, 0.0), "stiffest": (-0.99, 0.0)},
    "compliant": (0.0, 0.5),
}
_DRAWN = "pair", "stiff", "compliant"


def _rows_of_table() -> Iterator[tuple[str, TextNumber]]:
    for line in _TABLE.strip().splitlines():
        name, words, where, printed = re.split("  +", line.strip())
        yield name, TextNumber(words, where, printed.strip("-"))
    for stem, what, how, where, printed, names in (
        ("turn", "those", "cross", "Fig. 9", "about 20 %", [*_CROSSINGS]),
        ("return", "those", "cross again", "Fig. 9", "not mentioned", _DRAWN),
        ("rings", "a∞", "are the same", "Fig. 7", "not mentioned", _DRAWN),
    ):
        for name in names:
            one, other = (f"{k:g}".replace("-", "−") for k in _CROSSINGS[name])
            yield f"{stem}_{name}", TextNumber(f"φ at which {what} of k = {one} and {other} {how}", where, printed)


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
"""
NUMBERS: Mapping[str, TextNumber] = dict(_rows_of_table())


@functools.cache
def numbers() -> Mapping[str, float]:
    """The values of `NUMBERS` as computed by the library, by name."""
    slope, by_k = jax.jit(jax.grad(gross_slip.volume_change)), jax.jit(jax.grad(fretting.wear_volume))
    stiff, _, compliant = EXPONENTS
    best, both = root(slope, -0.5, 0.9), np.array([stiff, compliant])
    plane = [1.0 - _poisson(k, "holl") ** 2 for k in EXPONENTS]
    factors = [modulus_factor(k, "holl") for k in both]
    values = [
        best,
        gross_slip.volume_change(best),
        *gross_slip.volume_change(both),
        *gross_slip.steady_displacement(1.0, both),
        *gross_slip.force_ratio(np.array([0.0, compliant])),
        stiffness_of(ALMOST, 0.5),
        stiffness_of(ALMOST, 0.3),
        balance_of(stiff, 0.5),
        balance_of(compliant, "holl"),
        *factors,
        *(modulus_factor(k, 0.5) for k in both),
        factors[0] * plane[0] / plane[1],
        factors[1] * plane[2] / plane[1],
        root(lambda phi: by_k(0.0, phi), 0.1, 0.4),
        *(_equal_at(fretting.wear_volume, *_CROSSINGS[name], 0.05, 0.5) for name in _CROSSINGS),
        *(_equal_at(fretting.wear_volume, *_CROSSINGS[name], 0.9, 0.9999) for name in _DRAWN),
        *(_equal_at(fretting.worn_radius, *_CROSSINGS[name], 0.9, 0.99999) for name in _DRAWN),
    ]
    return dict(zip(NUMBERS, map(float, values), strict=True))
