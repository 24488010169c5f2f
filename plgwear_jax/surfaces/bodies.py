"""What may touch besides the power law: an elastic indenter, and a half-space whose modulus is given at points."""

from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POISSON_RATIO, POSITIVE, Domain, check, guarded, on_host
from plgwear_jax._core.formula import compiled
from plgwear_jax._core.numbers import listed
from plgwear_jax._core.record import record
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.special.pchip import pchip

DEPTH = Domain("z >= 0", lambda z: z >= 0.0)


def plane_modulus(E: ArrayLike, nu: ArrayLike) -> Array:
    """E* = E/(1 - nu^2)."""
    E, nu = guarded("E", E, POSITIVE), guarded("nu", nu, POISSON_RATIO)
    return E / ((1.0 - nu) * (1.0 + nu))


def mindlin_ratio(nu: ArrayLike) -> Array:
    """(2-nu)/(2(1-nu)), the tangential compliance of a homogeneous half-space over its normal one."""
    nu = guarded("nu", nu, POISSON_RATIO)
    return (1.0 - 0.5 * nu) / (1.0 - nu)


@record
class Elastic:
    """A homogeneous body: an indenter, `FrettingContact(..., indenter=Elastic(210e9, 0.3))`, or the half-space.

    Attributes:
        E: Young's modulus in Pa, positive.
        nu: Poisson's ratio, -1 < nu <= 1/2.

    Raises:
        ValueError: A concrete field is outside its range. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import Elastic, FrettingContact
        >>> ball = Elastic(210e9, 0.3)
        >>> contact = FrettingContact(ball, 5e-3, 10.0, 0.6, indenter=ball)
        >>> print(f"{contact.contact_radius():.4g}")  # m, as Hertz
        6.875e-05

    References:
        Hertz (1882); Johnson, Contact Mechanics (1985).
    """

    E: ArrayLike
    nu: ArrayLike

    def __post_init__(self) -> None:
        check("E", self.E, POSITIVE)
        check("nu", self.nu, POISSON_RATIO)

    @property
    def plane_modulus(self) -> Array:
        """E/(1 - nu^2) in Pa."""
        return plane_modulus(self.E, self.nu)


@record
class DepthGraded:
    """A half-space whose Young's modulus is given at some depths: a measured E(z), a coating, layers.

    Between the depths the modulus goes by a cubic without overshoot (PCHIP, as of `scipy.interpolate`), above the first
    and below the last one it is constant. A depth that is given twice is a jump. A pytree: `jax.grad` with respect to
    it gives a half-space whose `modulus` holds the derivatives by the modulus at each depth.

    Attributes:
        depth: Depths z in m, shape (..., points), >= 0 and increasing; at least two.
        modulus: Young's modulus at these depths in Pa, shape (..., points), positive.
        nu: Poisson's ratio, the same at all depths, -1 < nu <= 1/2.

    Raises:
        ValueError: A concrete field is outside its range, or the depths do not increase. Traced ones turn results
            into NaN.

    Examples:
        >>> from plgwear_jax import DepthGraded
        >>> coating = DepthGraded(depth=[0.0, 2e-5, 1e-4], modulus=[400e9, 300e9, 210e9], nu=0.25)
        >>> print(f"{coating.modulus_at(5e-5):.3e} Pa")
        2.469e+11 Pa

    References:
        `docs/explanation/theory.md`, "Elastic indenters and any E(z)".
    """

    tables: ClassVar = ("depth", "modulus")  # whose last axis is that of the points

    depth: Any  # an array or a list of numbers
    modulus: Any
    nu: ArrayLike

    def __post_init__(self) -> None:
        for name in ("depth", "modulus"):
            if isinstance(getattr(self, name), list | tuple):
                object.__setattr__(self, name, listed(name, getattr(self, name)))
        check("depth", self.depth, Domain(">= 0 and finite", lambda z: (z >= 0.0) & (z < float("inf"))))
        check("modulus", self.modulus, POSITIVE)
        check("nu", self.nu, POISSON_RATIO)
        depth, modulus = np.shape(self.depth), np.shape(self.modulus)
        if not (depth and modulus and depth[-1] == modulus[-1] and depth[-1] > 1):
            raise ValueError(f"depth and modulus take two points or more, not shapes {depth} and {modulus}")
        if not isinstance(self.depth, Tracer) and on_host(self.depth):
            z = np.asarray(self.depth)
            wrong = np.diff(z, axis=-1) < 0.0
            if np.any(wrong):
                i = int(np.argwhere(wrong)[0, -1])
                at = z[tuple(np.argwhere(wrong)[0, :-1])]
                raise ValueError(f"depth = {at[i]} m is followed by {at[i + 1]} m: depths must increase")
            if np.any(z[..., 2:] == z[..., :-2]):
                raise ValueError("depth: a depth may be given twice, for a jump of the modulus, but not three times")

    @classmethod
    def layers(cls, thickness: Any, modulus: Any, nu: ArrayLike) -> "DepthGraded":
        """Layers on a substrate.

        Args:
            thickness: Thicknesses in m from the surface downwards, shape (..., layers), positive.
            modulus: Young's moduli in Pa of the layers and, the last one, of the substrate, shape (..., layers + 1).
            nu: Poisson's ratio of all of them.

        Returns:
            The half-space, with each interface as a depth that is given twice.
        """
        thickness, modulus = (
            value if isinstance(value, Array) else listed(name, value)
            for name, value in (("thickness", thickness), ("modulus", modulus))
        )
        check("thickness", thickness, POSITIVE)
        if not (thickness.ndim and modulus.ndim and modulus.shape[-1] == thickness.shape[-1] + 1):
            told = f"{modulus.shape} for thickness of shape {thickness.shape}"
            raise ValueError(f"modulus has shape {told}: it takes one modulus a layer and one of the substrate")
        xp = jnp if isinstance(thickness, Array) or isinstance(modulus, Array) else np
        depth = xp.repeat(xp.cumsum(thickness, -1), 2, -1)
        return cls(depth, xp.repeat(modulus, 2, -1)[..., 1:-1], nu)

    def _check(self, **given: ArrayLike) -> None:
        self.__post_init__()
        for name, value in given.items():
            check(name, value, DEPTH)

    @compiled
    def modulus_at(self, z: ArrayLike) -> Array:
        """Young's modulus in Pa at depths z >= 0 in m; for fields without further axes than that of the points."""
        depth, modulus = jnp.asarray(self.depth), guarded("modulus", self.modulus, POSITIVE)
        dtype = jnp.result_type(depth, modulus, z, 0.0)
        z = jnp.asarray(guarded("z", z, DEPTH), dtype)
        return pchip(depth.astype(dtype), modulus.astype(dtype)).at(z)


def in_series(material: "PowerLawGraded | Elastic", indenter: Elastic | None) -> PowerLawGraded:
    """The homogeneous half-space that deforms as two homogeneous bodies together do, also tangentially.

    Args:
        material: A homogeneous half-space, or a power law with k = 0.
        indenter: The other body; None for a rigid one.

    Examples:
        >>> from plgwear_jax import Elastic
        >>> from plgwear_jax.surfaces import in_series
        >>> ball = Elastic(210e9, 0.3)
        >>> print(f"{in_series(ball, ball).E0:.4g}")  # Pa
        1.05e+11

    References:
        Johnson, Contact Mechanics (1985).
    """
    if isinstance(material, Elastic):
        material = PowerLawGraded(material.E, 1.0, 0.0, material.nu)
    if indenter is None:
        return material
    one = 1.0 / plane_modulus(material.E0, material.nu)  # pyright: ignore[reportArgumentType]
    other = 1.0 / indenter.plane_modulus
    ratios = mindlin_ratio(material.nu), mindlin_ratio(indenter.nu)  # pyright: ignore[reportArgumentType]
    theta = (one * ratios[0] + other * ratios[1]) / (one + other)
    nu = (2.0 * theta - 2.0) / (2.0 * theta - 1.0)
    return PowerLawGraded((1.0 - nu) * (1.0 + nu) / (one + other), material.z0, material.k, nu)
