"""What may touch besides the power law: an elastic indenter, and a half-space with a table of moduli or layers."""

from collections.abc import Mapping
from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer

from plgwear_jax._core.domains import (
    NOT_NEGATIVE,
    NUMBER,
    POISSON_RATIO,
    POSITIVE,
    ArrayLike,
    Domain,
    Numbers,
    check_columns,
    field_nan_outside,
    nan_outside,
    nan_unless,
    record,
)
from plgwear_jax._core.formula import compiled
from plgwear_jax.material import HalfSpace, PowerLawGraded
from plgwear_jax.special.pchip import Piecewise, pchip


@record
class Elastic(HalfSpace):
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
        >>> print(f"{contact.steady(0.0).contact_radius:.4g}")  # m, as Hertz
        6.875e-05

    References:
        Hertz (1882); Johnson, Contact Mechanics (1985).
    """

    ranges: ClassVar = {"E": POSITIVE, "nu": POISSON_RATIO}

    E: Numbers
    nu: Numbers

    @property
    def plane_modulus(self) -> Array:
        """E/(1 - nu^2) in Pa."""
        nu = field_nan_outside(self, "nu")
        return field_nan_outside(self, "E") / ((1.0 - nu) * (1.0 + nu))

    @property
    def power_law(self) -> PowerLawGraded:
        """With k = 0."""
        return PowerLawGraded(self.E, 1.0, 0.0, self.nu)

    def modulus_at(self, z: ArrayLike) -> Array:
        """Young's modulus in Pa at depths z in m, z >= 0, which is E everywhere."""
        z = nan_outside("z", z, NOT_NEGATIVE)
        return nan_unless(~jnp.isnan(z), field_nan_outside(self, "E"))


class AnyModulus(HalfSpace):
    """A half-space of any E(z), which two arrays give, and of one Poisson's ratio."""

    tables: ClassVar[tuple[str, str]]  # the arrays, whose last axis is along the depth
    ranges: ClassVar[Mapping[str, Domain]]

    def arrays(self) -> list[Array]:
        """The two arrays, NaN where a traced number is outside its range."""
        return [field_nan_outside(self, name) for name in self.tables]

    @staticmethod
    def by_depth(one: Array, other: Array) -> Piecewise:
        """E(z) in Pa from the two arrays, of one half-space each."""
        raise NotImplementedError

    @compiled
    def modulus_at(self, z: ArrayLike) -> Array:
        """Young's modulus in Pa at depths z >= 0 in m; for fields without further axes than that along the depth."""
        arrays = self.arrays()
        dtype = jnp.result_type(*arrays, z, 0.0)
        z = jnp.asarray(nan_outside("z", z, NOT_NEGATIVE), dtype)
        length, modulus = (array.astype(dtype) for array in arrays)
        unit = 2.0**20  # 1/m: in micrometres the coefficients of cubics are numbers of float32
        found = self.by_depth(unit * length, modulus).at(unit * z)
        # One modulus a layer knows no depth.
        return nan_unless(~jnp.isnan(sum(map(jnp.sum, arrays), z)), found)

    def seen_by(self, radius: Array) -> tuple[Array, Any, Any]:
        """With its moduli."""
        lengths, moduli = self.arrays()
        return jnp.asarray(self.nu), None, self.by_depth(lengths / radius, moduli / moduli[0])


@record
class DepthGraded(AnyModulus):
    """A half-space whose Young's modulus is given at some depths: a measured E(z).

    Between the depths the modulus goes by a cubic without overshoot (PCHIP, as of `scipy.interpolate`), above the first
    and below the last one it is constant. A depth that is given twice is a jump; layers of one modulus each are
    `Layered`. A pytree: `jax.grad` with respect to it gives a half-space whose `modulus` holds the derivatives by the
    modulus at each depth.

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
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    tables = "depth", "modulus"
    ranges: ClassVar = {"depth": NUMBER, "modulus": POSITIVE, "nu": POISSON_RATIO}

    depth: Any  # an array or a list of numbers
    modulus: Any
    nu: Numbers

    def __post_init__(self) -> None:
        check_columns(self)
        if not isinstance(self.depth, Tracer):
            z = np.asarray(self.depth)
            wrong = np.diff(z, axis=-1) < 0.0
            if np.any(wrong):
                *row, i = np.argwhere(wrong)[0]
                at = z[tuple(row)]
                raise ValueError(f"depth = {at[i]} m is followed by {at[i + 1]} m: depths must increase")
            if np.any(z[..., 2:] == z[..., :-2]):
                raise ValueError("depth: a depth may be given twice, for a jump of the modulus, but not three times")

    @staticmethod
    def by_depth(one: Array, other: Array) -> Piecewise:
        """PCHIP between the depths, NaN where they do not increase."""
        # They are not subtracted: where a depth is given twice, a program may round the difference to below 0.
        return pchip(nan_unless(jnp.all(one[1:] >= one[:-1]), one), other)


@record
class Layered(AnyModulus):
    """Layers on a substrate, each with one Young's modulus.

    A pytree: `jax.grad` with respect to it gives a half-space whose `thickness` and `modulus` hold the derivatives by
    the thickness and by the modulus of each layer; designs, sweeps and input files call them `material.thickness[0]`
    and `material.modulus[0]`, the layer at the surface.

    Attributes:
        thickness: Thicknesses of the layers in m from the surface downwards, shape (..., n-1), positive; without a
            layer the half-space is homogeneous.
        modulus: Young's moduli in Pa of the layers and, the last one, of the substrate, shape (..., n), positive.
        nu: Poisson's ratio, the same in all layers and the substrate, -1 < nu <= 1/2.

    Raises:
        ValueError: A concrete field is outside its range, or there is not one modulus more than thicknesses. Traced
            ones turn results into NaN.

    Examples:
        >>> import jax
        >>> from plgwear_jax import FrettingContact, Layered
        >>> coating = Layered(thickness=[2e-6, 3e-6], modulus=[400e9, 200e9, 110e9], nu=0.3)
        >>> print(f"{coating.modulus_at(4e-6):.3g} Pa")
        2e+11 Pa
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> slope = jax.grad(lambda contact: contact.steady(2.0).wear_volume)(contact).material
        >>> print(slope.thickness[0] < 0)  # a thicker stiff layer: less wear
        True

    References:
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    tables = "thickness", "modulus"
    ranges: ClassVar = {"thickness": POSITIVE, "modulus": POSITIVE, "nu": POISSON_RATIO}

    thickness: Any  # an array or a list of numbers
    modulus: Any
    nu: Numbers

    def __post_init__(self) -> None:
        thickness, modulus = np.shape(self.thickness), np.shape(self.modulus)
        if not (thickness and modulus and modulus[-1] == thickness[-1] + 1):
            text = f"thickness of shape {thickness} and modulus of shape {modulus}"
            raise ValueError(f"{text}: there must be one modulus more than thicknesses, the last one of the substrate")

    @staticmethod
    def by_depth(one: Array, other: Array) -> Piecewise:
        """One modulus a layer."""
        return Piecewise(jnp.append(0.0, jnp.cumsum(one)), other[None])


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
    material = material.power_law
    if indenter is None:
        return material
    body = Elastic(material.E0, material.nu)  # pyright: ignore[reportArgumentType]
    one, other = 1.0 / body.plane_modulus, 1.0 / indenter.plane_modulus
    theta = (one * body.tangential_ratio() + other * indenter.tangential_ratio()) / (one + other)
    nu = (2.0 * theta - 2.0) / (2.0 * theta - 1.0)
    return PowerLawGraded((1.0 - nu) * (1.0 + nu) / (one + other), material.z0, material.k, nu)
