"""Between which moduli a coating can be made, at depths of its own."""

import numpy as np
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.numbers import refuse_traced
from plgwear_jax._core.record import record

__all__ = ["ModulusProfile"]


@record
class ModulusProfile:
    """The lowest and the highest modulus with which a coating can be made, at three depths or more.

    It takes numbers, not traced values.

    Attributes:
        at: The depths in m, shape (n,), increasing, 3 <= n <= 8, the first one 0 or above.
        lower: The lowest modulus in Pa at each of them, shape (n,), positive.
        upper: The highest modulus in Pa, shape (n,), above the lowest.
        steepness: Between neighbouring depths abs(log(E2/E1)/log(z2/z1)) is at most this, which for a power law is
            abs(k); None for no limit.
    """

    at: ArrayLike
    lower: ArrayLike
    upper: ArrayLike
    steepness: float | None = None

    def __post_init__(self) -> None:
        given = self.at, self.lower, self.upper
        refuse_traced("ModulusProfile", given, "a DepthGraded may have traced moduli")
        for name in ("at", "lower", "upper"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), float))
        at, lower, upper = (np.asarray(x) for x in (self.at, self.lower, self.upper))
        if at.ndim != 1 or not at.shape == lower.shape == upper.shape or not 3 <= at.size <= 8:
            raise ValueError(f"at, lower and upper of shapes {at.shape}, {lower.shape}, {upper.shape}: 3 to 8 depths")
        from plgwear_jax.surfaces import DepthGraded  # which a power law under a rigid indenter does not need

        DepthGraded(at, lower, 0.0)  # which checks them
        if not np.all(np.diff(at) > 0.0):
            raise ValueError("at: the depths must increase")
        check("upper", upper, POSITIVE)
        if not np.all(lower < upper):
            i = int(np.argmin(lower < upper))
            raise ValueError(
                f"modulus at {at[i]:g} m: [{lower[i]:g}, {upper[i]:g}]: the lowest must be below the highest"
            )
        if self.steepness is not None:
            check("steepness", self.steepness, POSITIVE)
            if at[0] == 0.0:
                raise ValueError("steepness: is of logarithms of depths, and needs a first depth above 0")
