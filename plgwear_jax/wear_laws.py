"""Wear laws: the depth worn in a cycle."""

from typing import Any, ClassVar

from jax import Array

from plgwear_jax._core.domains import POSITIVE, Numbers, RecordFamily, field_nan_outside
from plgwear_jax.special.elementary import power_where

__all__ = ["Archard", "PressurePower", "WearLaw"]


class WearLaw(RecordFamily):
    """A wear law: `FrettingContact.over_cycles(load, law)` takes an instance of any subclass.

    A subclass gives the depth worn in a cycle. Without a decorator it becomes a frozen dataclass and a pytree of its
    fields, by which results can be differentiated.

    Attributes:
        linear: Whether the depth is proportional to the pressure, so that a step need not be repeated.
        ranges: What fields may be, by their names.

    Examples:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, WearLaw
        >>> class WithThreshold(WearLaw):
        ...     coefficient: float
        ...     threshold: float
        ...
        ...     def rate(self, pressure, slip):
        ...         return self.coefficient * jnp.maximum(pressure - self.threshold, 0.0) * slip
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> run = contact.over_cycles(2.0, WithThreshold(1e-15, 1e7))
        >>> print(run.volume(1e5) < contact.over_cycles(2.0, 1e-15).volume(1e5))
        True

    References:
        `docs/explanation/numerics.md`, "Any test".
    """

    linear: ClassVar[bool] = False

    def rate(self, pressure: Array, slip: Array) -> Array:
        """Depth in m worn in a cycle, elementwise and by functions of `jax.numpy`.

        Args:
            pressure: Pressures in Pa, >= 0.
            slip: The path that slips in a cycle in m, >= 0: four times the slip amplitude.
        """
        raise NotImplementedError(f"{type(self).__name__} has no rate(pressure, slip)")


class Archard(WearLaw):
    """Archard's law: the depth worn in a cycle is K times the pressure times the sliding distance in the cycle.

    Attributes:
        wear_coefficient: K in 1/Pa = m^3/(N m), positive: worn volume per normal force and sliding distance.

    Raises:
        ValueError: A concrete coefficient is not positive. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import wear_laws
        >>> print(f"{wear_laws.Archard(1e-14).rate(1e9, 1e-6):.2e}")  # m in a cycle: K p s
        1.00e-11

    References:
        Archard, Journal of Applied Physics 24 (1953) 981.
    """

    linear: ClassVar[bool] = True
    ranges: ClassVar = {"wear_coefficient": POSITIVE}

    wear_coefficient: Numbers

    def rate(self, pressure: Array, slip: Array) -> Array:
        """K p s in m."""
        return field_nan_outside(self, "wear_coefficient") * pressure * slip


class PressurePower(WearLaw):
    """The depth worn in a cycle is a coefficient times a power of the pressure times the sliding distance in the cycle.

    In the steady state the worn shape is that of Archard's law, Eq. (25); only the way there differs.

    Attributes:
        coefficient: In 1/Pa^exponent, positive.
        exponent: Exponent of the pressure, positive; 1 is Archard's law.

    Raises:
        ValueError: A concrete field is not positive. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import wear_laws
        >>> print(f"{wear_laws.PressurePower(1e-23, 2.0).rate(1e9, 1e-6):.2e}")  # m in a cycle: K p^m s
        1.00e-11

    References:
        `docs/explanation/numerics.md`, "Any test".
    """

    ranges: ClassVar = {"coefficient": POSITIVE, "exponent": POSITIVE}

    coefficient: Numbers
    exponent: Numbers

    def rate(self, pressure: Array, slip: Array) -> Array:
        """The coefficient times p^exponent s in m."""
        power = power_where(pressure > 0.0, pressure, field_nan_outside(self, "exponent"))
        return field_nan_outside(self, "coefficient") * power * slip


def law_of(given: Any, exponent: float | None = None) -> WearLaw:
    """The law as it is; of a number, the law with this wear coefficient and exponent, by default Archard's."""
    if isinstance(given, WearLaw):
        return given
    return Archard(given) if exponent in (None, 1.0) else PressurePower(given, exponent)
