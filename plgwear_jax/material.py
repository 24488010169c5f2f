"""The power-law graded half-space, Eq. (1), and the function h_N of its elastic constants, Eqs. (29)-(31)."""

import math
from collections.abc import Callable
from typing import Any, ClassVar, Literal

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import (
    EXPONENT,
    NOT_NEGATIVE,
    POISSON_RATIO,
    POSITIVE,
    ArrayLike,
    Numbers,
    check,
    field_nan_outside,
    nan_outside,
    number_or,
    record,
)
from plgwear_jax._core.formula import compiled, formula
from plgwear_jax.special.elementary import exponents, sinc_quotient, sine_quotient
from plgwear_jax.special.gamma import reciprocal_gamma, reciprocal_gamma_pair

__all__ = ["PowerLawGraded", "h_N", "holl_ratio", "tangential_ratio"]


def _gamma_factor(k: Array, s: Array, beta_squared: Array, digits: int | None) -> Array:
    """h_N m/((1+k)^2 q sine_quotient), Eqs. (29) and (30), with beta^2 = (1+k) m: analytic down to beta = 0, k = -1.

    Gamma((3+k+beta)/2) Gamma((3+k-beta)/2) and beta sin(pi beta/2) are even in beta, so beta itself is never needed.
    Of the other gamma functions Gamma(1+k/2)^2 is left, as Gamma(2+k) = 2^(1+k) Gamma(1+k/2) Gamma((3+k)/2)/sqrt(pi).
    """
    even, odd = reciprocal_gamma_pair(s, 0.25 * beta_squared, digits)
    gammas = even * even - 0.25 * beta_squared * odd * odd
    sine = (1.0 - 0.25 * beta_squared) * sinc_quotient(0.25 * beta_squared, digits)  # 2 sin(pi beta/2)/(pi beta)
    root = reciprocal_gamma(0.5 * k, digits)
    return gammas / (sine * root * root)


def _compliance_free(k: Array, beta_squared: Array, q_over_m: Array, digits: int | None) -> Array:
    """h_N/(1+k)^2 from beta^2 and q/m, Eqs. (29) and (30)."""
    s, q = exponents(k)
    return q_over_m * sine_quotient(s, q, digits) * _gamma_factor(k, s, beta_squared, digits)


def _coupling(k: Array, nu: Array) -> Array:
    """(1-nu) m = 1 - nu - k nu, Eq. (31), as a sum that keeps its digits towards k = 1, nu = 1/2."""
    return (1.0 - 2.0 * nu) + nu * (1.0 - k)


def _reduced(k: Array, nu: Array | None = None, *, digits: int | None = None) -> Array:
    """h_N/(1+k)^2, at Holl's ratio if nu is None."""
    s, q = exponents(k)
    if nu is None:
        return _compliance_free(k, jnp.ones_like(k), 2.0 * s * q, digits)
    m = _coupling(k, nu) / (1.0 - nu)
    # q/m, divided by the larger of its two terms, so that its derivatives keep their digits too.
    unlike = 1.0 - 2.0 * nu > q
    terms = jnp.where(unlike, (1.0 - 2.0 * nu) + 2.0 * nu * q, (1.0 - 2.0 * nu) / q + 2.0 * nu)
    q_over_m = (1.0 - nu) * jnp.where(unlike, q, 1.0) / terms
    return _compliance_free(k, (1.0 + k) * m, q_over_m, digits)


def _whole(k: Array, nu: Array | None = None, *, digits: int | None = None) -> Array:
    """h_N, at Holl's ratio if nu is None."""
    return (1.0 + k) ** 2 * _reduced(k, nu, digits=digits)


def _tangential(k: Array, nu: Array | None = None, *, digits: int | None = None) -> Array:
    """theta, at Holl's ratio if nu is None."""
    if nu is None:
        return 0.5 * (1.0 + k) * (3.0 + k)
    # Both terms have the pole of 1/m at k = 1, nu = 1/2; in h_N/cos(k pi/2) the zeros at k = -1 and k = 1 cancel.
    s, _ = exponents(k)
    coupling = _coupling(k, nu)
    beta_squared = (1.0 + k) * (coupling / (1.0 - nu))
    return s / coupling * ((1.0 - nu) + 2.0 / math.pi * _gamma_factor(k, s, beta_squared, digits))


def _is_holl(nu: ArrayLike | str) -> bool:
    """Whether nu stands for Holl's ratio; any other string is refused."""
    if isinstance(nu, str) and nu != "holl":
        raise ValueError(f'nu = "{nu}" is neither a number in {POISSON_RATIO.text} nor "holl"')
    return isinstance(nu, str)


def _of_both_ratios(kernel: Callable[..., Array]) -> Callable[..., Array]:
    """The function of k and of nu, which may be "holl"."""
    by_number = formula(joint=("k",), k=EXPONENT, nu=POISSON_RATIO)(kernel)
    at_holl = formula(joint=("k",), k=EXPONENT)(kernel)

    def of_both(k: ArrayLike, nu: ArrayLike | Literal["holl"], *, digits: int | None = None) -> Array:
        return at_holl(k, digits=digits) if _is_holl(nu) else by_number(k, nu, digits=digits)

    return of_both


_reduced_h = _of_both_ratios(_reduced)
_whole_h = _of_both_ratios(_whole)
_tangential_ratio = _of_both_ratios(_tangential)


def h_N(k: ArrayLike, nu: ArrayLike | Literal["holl"], *, digits: int | None = None) -> Array:
    """The function h_N of Eqs. (29)-(31), which relates force and indentation; 1 at k = 0.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        nu: Poisson's ratio, -1 < nu <= 1/2, or "holl" for Holl's ratio 1/(2+k), where beta = 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        h_N, dimensionless, broadcast over k and nu.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import material
        >>> print(f"{material.h_N(0.0, 0.3):.3f}")
        1.000

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (29) to (31).
    """
    return _whole_h(k, nu, digits=digits)


def tangential_ratio(k: ArrayLike, nu: ArrayLike | Literal["holl"], *, digits: int | None = None) -> Array:
    """Tangential compliance of the surface over its normal one, averaged over the directions of slip.

    theta = ((1+k)^2/beta^2 + h_N/((1-nu) cos(k pi/2)))/2, from the compliances of the half-space in the direction of a
    wave and across it. At k = 0 it is Mindlin's (2-nu)/(2(1-nu)), at Holl's ratio (1+k)(3+k)/2.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        nu: Poisson's ratio, -1 < nu <= 1/2, or "holl" for Holl's ratio at this k, where beta = 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        theta, dimensionless and positive, broadcast over k and nu.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import material
        >>> print(f"{material.tangential_ratio(0.0, 0.3):.4f}")
        1.2143

    References:
        `docs/explanation/numerics.md`, "Wear over cycles". At k = 0: Mindlin, Journal of Applied Mechanics 16 (1949)
        259.
    """
    return _tangential_ratio(k, nu, digits=digits)


@formula(k=EXPONENT)
def holl_ratio(k: ArrayLike, *, digits: int | None = None) -> Array:
    """Holl's ratio nu = 1/(2+k), at which normal and tangential contact uncouple (section 2).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        Poisson's ratio, in the shape of k. For k < 0 it exceeds 1/2, which no isotropic material has.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import material
        >>> print(f"{material.holl_ratio(0.5):.6f}")  # 1/(2 + k)
        0.400000

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: in the text before Eq. (2).
    """
    return 1.0 / (2.0 + jnp.asarray(k))


class HalfSpace:
    """What half-spaces have."""

    nu: Any

    def _check(self, **given: ArrayLike) -> None:
        """Check concrete values: the fields again, since JAX rebuilds records without checks, and a depth."""
        self.__post_init__()  # pyright: ignore[reportAttributeAccessIssue]
        for name, value in given.items():
            check(name, value, NOT_NEGATIVE)

    def tangential_ratio(self) -> Array:
        """Tangential over normal compliance, dimensionless, (2-nu)/(2(1-nu)) as that of a homogeneous half-space."""
        nu = field_nan_outside(self, "nu")
        return (1.0 - 0.5 * nu) / (1.0 - nu)

    def seen_by(self, radius: Array) -> tuple[Array, Any, Any]:
        """nu, the exponent of a power law, and E(z) of any other over that of the surface by z over a radius."""
        return jnp.asarray(self.nu), None, None


@record
class PowerLawGraded(HalfSpace):
    """A half-space whose Young's modulus follows E(z) = E0 (z/z0)^k with the depth z, Eq. (1).

    A pytree: `jax.grad` with respect to it gives a material whose fields are derivatives. Fields may be arrays that
    broadcast.

    Attributes:
        E0: Modulus at the depth z0, in Pa, positive.
        z0: Characteristic depth, in m, positive. A contact depends on E0 and z0 only through E0/z0^k.
        k: Exponent, -1 < k < 1: for k > 0 compliant at the surface and stiffer with depth, for k < 0 the reverse.
        nu: Poisson's ratio, -1 < nu <= 1/2, or "holl" for Holl's ratio 1/(2+k), which changes with k. For k < 0 it is
            above 1/2, which no isotropic material has; Eq. (27) uses it all the same.

    Raises:
        ValueError: A concrete field is outside its range. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.5, nu=0.3)
        >>> print(f"{coating.modulus(4e-4):.4g}")  # Pa
        2.2e+11

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (1).
    """

    ranges: ClassVar = {"E0": POSITIVE, "z0": POSITIVE, "k": EXPONENT}

    E0: Numbers
    z0: Numbers
    k: Numbers
    nu: ArrayLike | Literal["holl"] = number_or("holl")

    def __post_init__(self) -> None:
        if not _is_holl(self.nu):
            check("nu", self.nu, POISSON_RATIO)  # pyright: ignore[reportArgumentType]

    @compiled
    def modulus(self, z: ArrayLike) -> Array:
        """Young's modulus E(z) in Pa at depths z >= 0 in m, Eq. (1); at z = 0 its limit: 0, E0 or infinity."""
        E0, z0, k = self._guarded()
        relative = nan_outside("z", z, NOT_NEGATIVE) / z0
        inside = relative > 0.0
        power = jnp.exp(k * jnp.log(jnp.where(inside, relative, 1.0)))
        surface = jnp.where(k > 0.0, 0.0, jnp.where(k < 0.0, jnp.inf, 1.0))
        return E0 * jnp.where(inside, power, jnp.where(relative == 0.0, surface, jnp.nan))

    modulus_at = modulus  # its name in every half-space

    @property
    def power_law(self) -> "PowerLawGraded":
        """Itself, as a homogeneous half-space is one with k = 0."""
        return self

    def seen_by(self, radius: Array) -> tuple[Array, Any, Any]:
        """With k."""
        return holl_ratio(self.k) if isinstance(self.nu, str) else jnp.asarray(self.nu), jnp.asarray(self.k), None

    def _guarded(self) -> tuple[Array, Array, Array]:
        """(E0, z0, k), NaN where they are traced and outside their ranges."""
        return field_nan_outside(self, "E0"), field_nan_outside(self, "z0"), field_nan_outside(self, "k")

    @compiled
    def plane_compliance(self) -> Array:
        """1 - nu^2, with nu = 1/(2+k) for Holl's ratio."""
        if isinstance(self.nu, str):
            k = jnp.asarray(self.k, jnp.result_type(self.k, 0.0))
            return (1.0 + k) * (3.0 + k) / ((2.0 + k) * (2.0 + k))
        return (1.0 - jnp.asarray(self.nu)) * (1.0 + jnp.asarray(self.nu))

    @compiled
    def tangential_ratio(self, *, digits: int | None = None) -> Array:
        """Tangential over normal compliance, dimensionless: the function `tangential_ratio` of this k and nu."""
        return tangential_ratio(field_nan_outside(self, "k"), self.nu, digits=digits)

    @compiled
    def log_stiffness(self, *, digits: int | None = None) -> Array:
        """log of E0 h_N/((1-nu^2) z0^k (1+k)^2), the only combination of E0, z0 and nu that enters a contact."""
        E0, z0, k = self._guarded()
        reduced = jnp.log(_reduced_h(k, self.nu, digits=digits))
        return jnp.log(E0) - k * jnp.log(z0) + reduced - jnp.log(self.plane_compliance())
