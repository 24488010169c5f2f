"""The question of a design: what may vary, what is held, the limits, and what is minimised.

Wear depends on the material only through k and the contact radius a_0, and is proportional to a power of a_0. It grows
with the force amplitude for every material. So over a table of amplitudes the mean, the worst case and the mean of the
worst cases are means with weights that do not depend on the design, and smooth functions of it.
"""

from typing import Any

import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.numbers import refuse_traced
from plgwear_jax._core.record import record, static
from plgwear_jax._core.rules import Hold, Objective, exponents
from plgwear_jax.contact import is_closed

__all__ = [
    "DEEP",
    "POWERS",
    "SHALLOW",
    "Bounds",
    "Hold",
    "Limits",
    "Load",
    "ModulusWindow",
    "Objective",
    "Question",
    "keeps",
    "limited",
    "pair_of",
    "solved_numerically",
]


Bounds = tuple[float, float]

_ROUNDING = 1e-6  # of log(value/limit)


def keeps(excess: Any) -> Any:
    """Whether limits are kept, up to rounding, along the last axis of log(value/limit), negative where the lowest."""
    kept = np.max(excess, axis=-1, initial=-1.0) < _ROUNDING if np.ndim(excess) else excess < _ROUNDING
    return bool(kept) if np.ndim(kept) == 0 else kept


def limited(name: str) -> tuple[str, bool]:
    """What a limit of this name limits, and whether it is the lowest value allowed: "contact_radius_lowest"."""
    what = name.removesuffix("_lowest")
    return what.removesuffix("_highest"), what != name


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

    It takes numbers, not traced values.

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
            refuse_traced("ModulusWindow", pair, "the other limits, the contact and the load may be traced")
            for value in pair:
                check(f"modulus: {name}", value, POSITIVE)
        if not self.at[0] < self.at[1]:
            raise ValueError(f"modulus: at = {self.at}: the smaller depth must come first")
        for depth, lowest, highest in zip(self.at, self.lower, self.upper, strict=True):
            if not lowest < highest:
                raise ValueError(f"modulus at {depth} m: [{lowest}, {highest}]: the lowest must be below the highest")

    def exponents(self) -> Bounds:
        """The lowest and the highest exponent k that the window allows."""
        return exponents(self.at, self.lower, self.upper)


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


@record
class Load:
    """The amplitudes for which a design is made, and how much each of them counts.

    Attributes:
        tangential_force: Amplitudes F_x in N, shape (n,), the largest one that counts first. Amplitudes without weight
            at the end are padding.
        weight: With which the wear under each of them enters what is minimised, shape (n,), with the sum 1.
        life: Archard's wear coefficient in 1/Pa times the cycles after which the wear counts; None for the steady
            state.
    """

    tangential_force: Any
    weight: Any
    life: Any = None


@record
class Question:
    """What a design is asked: all its inputs, as numbers, and what is minimised and held.

    Attributes:
        contact: The contact as it was given, with the reference material.
        load: The amplitudes; None for gross slip.
        bounds: The lowest and the highest value of each variable, by name, in SI units. The two moduli of a window are
            "shallow_modulus" and "deep_modulus".
        depths: The depths in m of these two moduli, where they vary; else None.
        limits: What is limited.
        objective: What is minimised.
        hold: What is held, and by which field of the material; None if nothing is.
    """

    contact: Any
    load: Load | None
    bounds: dict[str, tuple[ArrayLike, ArrayLike]]
    depths: tuple[ArrayLike, ArrayLike] | None
    limits: Limits
    objective: str = static()
    hold: Hold | None = static()

    @property
    def phi(self) -> Any:
        """The amplitudes F_x/(mu F_N), shape (n,), the largest first."""
        assert self.load is not None
        return self.load.tangential_force / (self.contact.friction * self.contact.normal_force)


SHALLOW, DEEP = "shallow_modulus", "deep_modulus"
POWERS = {"wear_volume": 4, "deepest_wear": 2, "worn_radius": 1}  # of a_0


def solved_numerically(question: Question) -> bool:
    """The contact has no closed forms: its indenter is elastic, or no parabola."""
    return not is_closed(question.contact)
