"""Wear laws: the depth worn in a cycle."""

from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.record import record

__all__ = ["Archard"]


@record
class Archard:
    """Archard's law: the depth worn in a cycle is K times the pressure times the sliding distance in the cycle.

    Attributes:
        wear_coefficient: K in 1/Pa = m^3/(N m), positive: worn volume per normal force and sliding distance.

    Raises:
        ValueError: A concrete coefficient is not positive. Traced ones turn results into NaN.
    """

    wear_coefficient: ArrayLike

    def __post_init__(self) -> None:
        check("wear_coefficient", self.wear_coefficient, POSITIVE)
