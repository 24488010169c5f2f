"""The question of a design: what may vary, what is held, the limits, and what is minimised.

Wear depends on the material only through k and the contact radius a_0, and is proportional to a power of a_0. It grows
with the force amplitude for every material. So over a table of amplitudes the mean, the worst case and the mean of the
worst cases are means with weights that do not depend on the design, and smooth functions of it.
"""

import math
from typing import Any, Literal, NamedTuple

import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.record import record

__all__ = [
    "BROKEN",
    "DEEP",
    "POWERS",
    "SHALLOW",
    "Bounds",
    "Hold",
    "Limits",
    "ModulusWindow",
    "Objective",
    "Question",
    "Task",
    "pair_of",
]


Hold = Literal["contact_radius_by_E0", "contact_radius_by_z0"]
Objective = Literal["wear_volume", "worn_radius", "deepest_wear", "volume_change", "force_drop"]
Bounds = tuple[float, float]

BROKEN = 1e-6  # log(value/limit) above which a limit is broken by more than rounding


def pair_of(name: str, given: Any) -> tuple[Any, Any]:
    """Two numbers, or a ValueError that says what the argument of this name takes."""
    try:
        lowest, highest = given
    except (TypeError, ValueError):
        raise ValueError(f"{name} takes a pair of numbers, not {given!r}") from None
    return lowest, highest


@record
class ModulusWindow:
    """The lowest and highest modulus with which a coating can be made, at two depths.

    Attributes:
        at: The two depths in m, positive, the smaller one first.
        lower: The lowest modulus in Pa at each of them.
        upper: The highest modulus in Pa at each of them.
    """

    at: tuple[float, float]
    lower: tuple[float, float]
    upper: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("at", "lower", "upper"):
            pair = pair_of(f"modulus: {name}", getattr(self, name))
            for value in pair:
                check(f"modulus: {name}", value, POSITIVE)
        if not self.at[0] < self.at[1]:
            raise ValueError(f"modulus: at = {self.at}: the smaller depth must come first")
        for depth, lowest, highest in zip(self.at, self.lower, self.upper, strict=True):
            if not lowest < highest:
                raise ValueError(f"modulus at {depth} m: [{lowest}, {highest}]: the lowest must be below the highest")

    def exponents(self) -> Bounds:
        """The lowest and the highest exponent k that the window allows."""
        decades = math.log(self.at[1] / self.at[0])
        return math.log(self.lower[1] / self.upper[0]) / decades, math.log(self.upper[1] / self.lower[0]) / decades


@record
class Limits:
    """The limits of a design; None means no limit.

    Attributes:
        edge_pressure: Highest pressure p_inf in Pa at the distance `distance` inside the stick edge, Eq. (17). This is
            the usual way to compare singularities of different order.
        distance: This critical distance in m.
        contact_radius: Lowest and highest initial contact radius a_0 in m; either may be None.
        penetration: Largest penetration d_inf in m.
        modulus: The window of E(z) at two depths.
    """

    edge_pressure: ArrayLike | None = None
    distance: ArrayLike | None = None
    contact_radius: tuple[ArrayLike | None, ArrayLike | None] | None = None
    penetration: ArrayLike | None = None
    modulus: ModulusWindow | None = None

    def __post_init__(self) -> None:
        if self.edge_pressure is not None and self.distance is None:
            raise ValueError("limits: edge_pressure needs the distance from the stick edge at which it is taken")
        if self.modulus is not None and not isinstance(self.modulus, ModulusWindow):
            raise TypeError(f"limits: modulus takes a ModulusWindow, not {self.modulus!r}")
        lowest = highest = None
        if self.contact_radius is not None:
            lowest, highest = pair_of("limits: contact_radius", self.contact_radius)
        named = {
            "edge_pressure": self.edge_pressure,
            "distance": self.distance,
            "penetration": self.penetration,
            "contact_radius, lowest": lowest,
            "contact_radius, highest": highest,
        }
        for name, value in named.items():
            if value is not None:
                check(f"limits: {name}", value, POSITIVE)
        known = not isinstance(lowest, Tracer) and not isinstance(highest, Tracer)
        if known and lowest is not None and highest is not None and not np.all(np.less(lowest, highest)):
            raise ValueError(f"limits: contact_radius = {self.contact_radius}: the lowest must be below the highest")


class Question(NamedTuple):
    """The question without its numbers."""

    objective: str
    hold: Hold | None


@record
class Task:
    """The numbers of a design: all inputs with respect to which the result can be differentiated."""

    contact: Any  # of either kind
    phi: Any  # amplitudes F_x/(mu F_N) that count, the largest one first
    weight: Any
    bounds: dict[str, tuple[ArrayLike, ArrayLike]]
    depths: tuple[ArrayLike, ArrayLike] | None  # of the two moduli, where these are varied
    limits: Limits


SHALLOW, DEEP = "shallow_modulus", "deep_modulus"
POWERS = {"wear_volume": 4, "deepest_wear": 2, "worn_radius": 1}  # of a_0
