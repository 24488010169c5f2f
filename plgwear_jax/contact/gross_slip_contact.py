"""Gross slip in SI units."""

from collections.abc import Callable
from typing import ClassVar

import jax.numpy as jnp
from jax import Array

from plgwear_jax import gross_slip
from plgwear_jax._core.domains import POSITIVE, ArrayLike, Numbers, field_nan_outside, record
from plgwear_jax._core.formula import compiled
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.steady.solution import Solution


@record
class GrossSlipContact:
    """A rigid flat-ended punch pressed to a fixed depth and slid until its pressure is uniform: section 2 of the paper.

    Attributes:
        material: The graded half-space.
        radius: Radius a of the punch, in m, positive.
        depth: Indentation depth d, in m, positive, constant while sliding.

    Raises:
        ValueError: A concrete field is outside its range. Under `jit` results are NaN there.

    Examples:
        >>> from plgwear_jax import GrossSlipContact, PowerLawGraded
        >>> contact = GrossSlipContact(PowerLawGraded(E0=1e9, z0=1e-3, k=0.0, nu=0.5), radius=2e-3, depth=1e-6)
        >>> steady = contact.steady()
        >>> print(f"{steady.initial_force:.2f} N, later {steady.steady_force:.2f} N")
        5.33 N, later 4.19 N

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (2) to (10).
    """

    ranges: ClassVar = {"radius": POSITIVE, "depth": POSITIVE}

    material: PowerLawGraded
    radius: Numbers
    depth: Numbers

    def __post_init__(self) -> None:
        if not isinstance(self.material, PowerLawGraded):
            raise TypeError(f"material takes a PowerLawGraded, not {self.material!r}")

    def steady(self, *, digits: int | None = None) -> "SteadyPunch":
        """The contact before any wear and in its steady state; `digits` are the correct digits wanted."""
        return SteadyPunch(self, digits=digits)


class SteadyPunch(Solution):
    """A flat punch at a constant depth, unworn and worn until its pressure is uniform: `GrossSlipContact.steady`.

    Radii r are in m, r >= 0.

    Raises:
        ValueError: A concrete number is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import GrossSlipContact, PowerLawGraded
        >>> steady = GrossSlipContact(PowerLawGraded(E0=1e9, z0=1e-3, k=0.0, nu=0.5), radius=2e-3, depth=1e-6).steady()
        >>> print(f"{steady.force_ratio:.4f}")  # pi/4
        0.7854

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (2) to (10).
    """

    numbers: ClassVar = ("contact",)

    @property
    @compiled
    def initial_force(self) -> Array:
        """Normal force F_N0 in N under the flat punch, Eq. (8)."""
        log_stiffness = self.contact.material.log_stiffness(digits=self.digits)
        k = jnp.asarray(self.contact.material.k, log_stiffness.dtype)
        a = self._radius
        return 2.0 * self._depth * a * (1.0 + k) * jnp.exp(log_stiffness + k * jnp.log(a))

    @property
    @compiled
    def steady_force(self) -> Array:
        """Normal force F_Ninf in N under the worn punch at the same depth, Eq. (9)."""
        return self.initial_force * self.force_ratio

    @property
    @compiled
    def force_ratio(self) -> Array:
        """F_Ninf/F_N0 at fixed depth, Eq. (10); at fixed force it is the ratio of initial to steady depth."""
        return self._of(gross_slip.force_ratio)

    @property
    @compiled
    def force_drop(self) -> Array:
        """Share of the normal force lost at fixed depth, 1 - F_Ninf/F_N0, Eq. (10)."""
        return self._of(gross_slip.force_drop)

    @property
    @compiled
    def volume_change(self) -> Array:
        """Effective volume change of the punch in m^3, Eq. (7)."""
        a = self._radius
        return jnp.pi * a * a * self._depth * self._of(gross_slip.volume_change)

    @compiled
    def initial_pressure(self, r: ArrayLike) -> Array:
        """Pressure p_0(r) in Pa under the flat punch, Eq. (2); infinite at r = a."""
        return self._mean_pressure * self._of(gross_slip.initial_pressure, r)

    @compiled
    def steady_pressure(self, r: ArrayLike) -> Array:
        """Pressure in Pa under the worn punch, uniform for r <= a."""
        return self._mean_pressure * self._of(gross_slip.steady_pressure, r)

    @compiled
    def initial_displacement(self, r: ArrayLike) -> Array:
        """Normal displacement w_0(r) of the surface in m, Eq. (3)."""
        return self._depth * self._of(gross_slip.initial_displacement, r)

    @compiled
    def steady_displacement(self, r: ArrayLike) -> Array:
        """Normal displacement w_inf(r) of the surface in m, which is the shape of the worn punch, Eq. (5)."""
        return self._depth * self._of(gross_slip.steady_displacement, r)

    def modulus_at(self, z: ArrayLike) -> Array:
        """Young's modulus of the half-space in Pa at a depth z in m, Eq. (1)."""
        return self.contact.material.modulus_at(z)

    @property
    def _mean_pressure(self) -> Array:
        """F_N0/(pi a^2), the unit of pressures."""
        a = self._radius
        return self.initial_force / (jnp.pi * a * a)

    @property
    def _radius(self) -> Array:
        return field_nan_outside(self.contact, "radius")

    @property
    def _depth(self) -> Array:
        return field_nan_outside(self.contact, "depth")

    def _of(self, function: Callable[..., Array], *r: ArrayLike) -> Array:
        """A dimensionless function of the exponent, and of radii in m if given."""
        relative = (self._relative("r", x, self._radius) for x in r)
        return function(*relative, self.contact.material.k, digits=self.digits)
