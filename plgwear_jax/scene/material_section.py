"""The section [material]: a power law of the depth, a table of the modulus, or layers."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, PrivateAttr, Tag, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from plgwear_jax.scene.fields import PositiveBound, Section, positive, wrong

if TYPE_CHECKING:
    from plgwear_jax.tables import GradedModulus, Heights

_RATIO = Field(gt=-1.0, le=0.5, allow_inf_nan=False)
_NU = "must be a number with -1 < nu <= 0.5"


class Material(Section):
    """The section [material]: the half-space E(z) = E0 (z/z0)^k.

    Attributes:
        E0: Young's modulus at the depth z0, in Pa.
        z0: Characteristic depth in m, at which the modulus is E0.
        k: Exponent; k > 0 is compliant at the surface and stiffer with depth, k < 0 the opposite.
        nu: Poisson's ratio; "holl" is 1/(2 + k).
    """

    E0: float = positive("the modulus at the depth z0 in Pa")
    z0: float = positive("the characteristic depth in m")
    k: float = Field(gt=-1.0, lt=1.0, allow_inf_nan=False, description="must be a number with -1 < k < 1")
    nu: Annotated[float, _RATIO] | Literal["holl"] = Field(description=f'{_NU}, or "holl"')


class Tabulated(Section):
    """The section [material] with table: a half-space whose modulus is given at some depths.

    Attributes:
        table: CSV file with the columns depth and modulus, whose headers may name units.
        nu: Poisson's ratio, the same at all depths.
    """

    table: str = Field(
        min_length=1, description="must be the name of a CSV file with the columns depth and modulus, in m and Pa"
    )
    nu: Annotated[float, _RATIO] = Field(description=f"{_NU}, the same at all depths")
    _read: "GradedModulus | None" = PrivateAttr(None)

    @model_validator(mode="after")
    def _from_file(self, info: ValidationInfo) -> Self:
        self._read = _from_table("read_modulus", self.table, info)
        return self

    @property
    def read(self) -> "GradedModulus":
        """The content of the file."""
        assert self._read is not None
        return self._read


Lengths = Annotated[tuple[PositiveBound, ...], Field(strict=False)]


class Layers(Section):
    """The section [material] with thickness and modulus: layers on a substrate.

    Attributes:
        thickness: Thicknesses of the layers in m, from the surface downwards; without a layer [].
        modulus: Young's moduli of the layers and, the last one, of the substrate, in Pa.
        nu: Poisson's ratio of all layers and the substrate.
    """

    thickness: Lengths = Field(
        description="must be a list of finite numbers > 0 such as [2e-6, 3e-6], "
        "the thicknesses of the layers in m from the surface downwards"
    )
    modulus: Lengths = Field(
        description="must be a list of finite numbers > 0 such as [400e9, 200e9, 110e9], "
        "the moduli of the layers and, last, of the substrate in Pa"
    )
    nu: Annotated[float, _RATIO] = Field(description=f"{_NU}, that of all layers and the substrate")

    @model_validator(mode="after")
    def _on_a_substrate(self) -> Self:
        layers, moduli = len(self.thickness), len(self.modulus)
        if moduli != layers + 1:
            text = f"must hold {layers + 1} moduli for {layers} thicknesses, the last one that of the substrate"
            raise wrong("modulus", f"{text}, not {moduli}")
        return self


class Indenter(Section):
    """The key [contact] indenter of an elastic indenter.

    Attributes:
        E: Young's modulus of the indenter in Pa.
        nu: Poisson's ratio of the indenter.
    """

    E: float = positive("Young's modulus in Pa")
    nu: Annotated[float, _RATIO]


class PowerShape(Section):
    """The key [contact] shape of an indenter r^n/(n R^(n-1)).

    Attributes:
        kind: Which shape this is.
        exponent: The exponent n.
    """

    kind: Literal["power"]
    exponent: float = Field(ge=1.0, allow_inf_nan=False)


class Cone(Section):
    """The key [contact] shape of a cone.

    Attributes:
        kind: Which shape this is.
        slope: Slope of the cone, dimensionless; its height is the slope times the radius.
    """

    kind: Literal["cone"]
    slope: float = positive("the slope of the cone")


class Flat(Section):
    """The key [contact] shape of an indenter with a flat face.

    Attributes:
        kind: Which shape this is.
        flat_radius: Radius of the flat face in m.
    """

    kind: Literal["rounded_flat", "truncated_sphere"]
    flat_radius: float = Field(ge=0.0, allow_inf_nan=False)


class Profile(Section):
    """The key [contact] shape with table: heights at some radii, which the scene reads.

    Attributes:
        table: CSV file with the columns r and height, whose headers may name units.
    """

    table: str = Field(min_length=1)
    _read: "Heights | None" = PrivateAttr(None)

    @model_validator(mode="after")
    def _from_file(self, info: ValidationInfo) -> Self:
        self._read = _from_table("read_heights", self.table, info)
        return self

    @property
    def read(self) -> "Heights":
        """The content of the file."""
        assert self._read is not None
        return self._read


Shape = PowerShape | Cone | Flat | Profile
SHAPES = (
    '{ kind = "power", exponent = 4 } with an exponent >= 1, { kind = "cone", slope = 0.01 } with a slope > 0, '
    '{ kind = "rounded_flat", flat_radius = 1e-5 } or { kind = "truncated_sphere", flat_radius = 1e-5 } with a radius '
    '>= 0 in m, or { table = "profile.csv" }, a CSV file with the columns r and height'
)


def _from_table(reader: str, name: str, info: ValidationInfo) -> Any:
    """The content of a CSV file that a scene names."""
    from plgwear_jax import tables  # imports NumPy, which other scenes do not need

    try:
        return getattr(tables, reader)(Path((info.context or {}).get("folder", "")) / name)
    except tables.TableError as error:  # the error is in another file than the scene
        raise PydanticCustomError("table", "{line}", {"line": str(error)}) from None


def _kind(given: Any) -> str:
    """Which of the materials a section means."""
    if isinstance(given, Section):
        return next(name for name, model in MATERIALS.items() if isinstance(given, model))
    keys = {"table": "table", "thickness": "layers", "modulus": "layers"}
    return next((kind for key, kind in keys.items() if isinstance(given, dict) and key in given), "power law")


def named(material: Section) -> str:
    """A material in words."""
    kind = _kind(material)
    return kind if kind == "layers" else f"a {kind}"


def tables_of(material: Section) -> dict[str, Any]:
    """The rows of numbers of a material by name: thicknesses or depths, and moduli; none of a power law."""
    if isinstance(material, Tabulated):
        return {"depth": material.read.depth, "modulus": material.read.modulus}
    return {"thickness": material.thickness, "modulus": material.modulus} if isinstance(material, Layers) else {}


MATERIALS: dict[str, type[Section]] = {"power law": Material, "table": Tabulated, "layers": Layers}
AnyMaterial = Annotated[
    Annotated[Material, Tag("power law")] | Annotated[Tabulated, Tag("table")] | Annotated[Layers, Tag("layers")],
    Discriminator(_kind),
]
