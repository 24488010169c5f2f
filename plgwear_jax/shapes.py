"""Indenters of other shapes than the parabola: f(r) = r^n/(n R^(n-1))."""

from collections.abc import Callable
from typing import Any

from jax.typing import ArrayLike

from plgwear_jax._core.domains import Domain, check
from plgwear_jax._core.record import record

__all__ = ["EXPONENT", "PowerShape", "unworn_of", "unworn_profile"]

EXPONENT = Domain("2 <= exponent <= 8", lambda n: (n >= 2.0) & (n <= 8.0))


@record
class PowerShape:
    """An indenter f(r) = r^n/(n R^(n-1)): `FrettingContact(..., shape=PowerShape(4))`, R being its `radius`.

    With n = 2 it is the parabola of the radius of curvature R. For any other n it is R at which f has the slope 1. The
    larger n, the flatter the middle and the smaller the radius of curvature at the edge of the contact.

    Attributes:
        exponent: n, 2 <= n <= 8.

    Raises:
        ValueError: A concrete exponent is outside its range. A traced one turns results into NaN.
    """

    exponent: ArrayLike

    def __post_init__(self) -> None:
        check("exponent", self.exponent, EXPONENT)


def unworn_profile(r: Any, radius: Any, exponent: Any = None) -> Any:
    """f_0(r) in m of the parabola, or with an exponent; of numbers of NumPy by NumPy."""
    return 0.5 * r * r / radius if exponent is None else radius / exponent * (r / radius) ** exponent


def unworn_of(contact: Any) -> Callable[[Any], Any]:
    """f_0 of a contact."""
    exponent = None if contact.shape is None else contact.shape.exponent
    return lambda r: unworn_profile(r, contact.radius, exponent)
