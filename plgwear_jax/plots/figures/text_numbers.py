"""The numbers of the text."""

import functools
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import numpy as np
from scipy import optimize

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax.plots.figures.sketch import ALMOST, EXPONENTS


def root(function: Callable[[float], Any], lower: float, upper: float) -> float:
    """The root of a function between two places, to rounding."""
    found: Any = optimize.brentq(lambda x: float(function(x)), lower, upper, xtol=1e-15, rtol=1e-14)
    return float(found)


def _crossing(quantity: Callable[..., Any], one: float, other: float, lower: float, upper: float) -> float:
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


class Asked(NamedTuple):
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


def _asked(name: str, what: str, how: str, where: str, printed: str = "not mentioned") -> Asked:
    one, other = (f"{k:g}".replace("-", "−") for k in _CROSSINGS[name])
    return Asked(f"φ at which {what} of k = {one} and {other} {how}", where, printed)


NUMBERS: Mapping[str, Asked] = {
    "best_k": Asked("exponent of the greatest effective volume change", "Fig. 4", "0.169"),
    "best_change": Asked("greatest ΔV/(π a² d)", "Fig. 4", "15.5 %"),
    "change_stiff": Asked("ΔV/(π a² d) at k = −0.5", "Fig. 2", ""),
    "change_compliant": Asked("ΔV/(π a² d) at k = 0.5", "Fig. 3", ""),
    "edge_stiff": Asked("w∞(a)/d at k = −0.5", "Fig. 2", ""),
    "edge_compliant": Asked("w∞(a)/d at k = 0.5", "Fig. 3", ""),
    "least_ratio": Asked("least F_N∞/F_N0, at k = 0", "Eq. (10)", "less than 1"),
    "ratio_graded": Asked("F_N∞/F_N0 at k = −0.5 and 0.5", "Eq. (10)", "less than 1"),
    "gibson": Asked("F_N0/(2 E0 d a) for z0 = a, ν = 1/2, k = 1 − 10⁻⁹", "Sec. 2", "not zero"),
    "vanishing": Asked("the same with ν = 0.3", "Sec. 2", "tends to zero"),
    "balance_stiff": Asked("z0/a at which F_N0 is that of k = 0: k = −0.5, ν = 1/2", "Table 1", "1"),
    "balance_compliant": Asked("z0/a at which F_N0 is that of k = 0: k = 0.5, Holl's ratio", "Table 1", "1"),
    "factor_stiff": Asked("factor of E0/(1−ν²), k = −0.5, Holl's ratio", "Eq. (27)", "0.88"),
    "factor_compliant": Asked("factor of E0/(1−ν²), k = 0.5, Holl's ratio", "Eq. (27)", "2.06"),
    "factor_stiff_half": Asked("the same for ν = 1/2 in both, k = −0.5", "Eq. (27)", ""),
    "factor_compliant_half": Asked("the same for ν = 1/2 in both, k = 0.5", "Eq. (27)", ""),
    "modulus_stiff": Asked("factor of E0 itself, k = −0.5, Holl's ratio in both", "Eq. (27)", ""),
    "modulus_compliant": Asked("factor of E0 itself, k = 0.5, Holl's ratio in both", "Eq. (27)", ""),
    "turn": Asked("φ at which the wear volumes of −k and k cross, k → 0", "Fig. 9", "about 20 %"),
    **{f"turn_{name}": _asked(name, "those", "cross", "Fig. 9", "about 20 %") for name in _CROSSINGS},
    **{f"return_{name}": _asked(name, "those", "cross again", "Fig. 9") for name in _DRAWN},
    **{f"rings_{name}": _asked(name, "a∞", "are the same", "Fig. 7") for name in _DRAWN},
}


@functools.cache
def numbers() -> Mapping[str, float]:
    """The values of `NUMBERS` as computed by the library, by name."""
    slope, by_k = jax.jit(jax.grad(gross_slip.volume_change)), jax.jit(jax.grad(fretting.wear_volume))
    best = root(slope, -0.5, 0.9)
    volume, outer = fretting.wear_volume, fretting.worn_radius
    plane = {k: 1.0 - float(_poisson(k, "holl")) ** 2 for k in EXPONENTS}
    return {
        "best_k": best,
        "best_change": float(gross_slip.volume_change(best)),
        "change_stiff": float(gross_slip.volume_change(-0.5)),
        "change_compliant": float(gross_slip.volume_change(0.5)),
        "edge_stiff": float(gross_slip.steady_displacement(1.0, -0.5)),
        "edge_compliant": float(gross_slip.steady_displacement(1.0, 0.5)),
        "least_ratio": float(gross_slip.force_ratio(0.0)),
        "ratio_graded": float(gross_slip.force_ratio(0.5)),
        "gibson": float(stiffness_of(ALMOST, 0.5)),
        "vanishing": float(stiffness_of(ALMOST, 0.3)),
        "balance_stiff": float(balance_of(-0.5, 0.5)),
        "balance_compliant": float(balance_of(0.5, "holl")),
        "factor_stiff": modulus_factor(-0.5, "holl"),
        "factor_compliant": modulus_factor(0.5, "holl"),
        "factor_stiff_half": modulus_factor(-0.5, 0.5),
        "factor_compliant_half": modulus_factor(0.5, 0.5),
        "modulus_stiff": modulus_factor(-0.5, "holl") * plane[-0.5] / plane[0.0],
        "modulus_compliant": modulus_factor(0.5, "holl") * plane[0.5] / plane[0.0],
        "turn": root(lambda phi: by_k(0.0, phi), 0.1, 0.4),
        **{f"turn_{name}": _crossing(volume, *both, 0.05, 0.5) for name, both in _CROSSINGS.items()},
        **{f"return_{name}": _crossing(volume, *_CROSSINGS[name], 0.9, 0.9999) for name in _DRAWN},
        **{f"rings_{name}": _crossing(outer, *_CROSSINGS[name], 0.9, 0.99999) for name in _DRAWN},
    }
