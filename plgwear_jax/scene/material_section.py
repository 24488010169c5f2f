"""The section [material]: a power law of the depth, a table of the modulus, or layers."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, PrivateAttr, Tag, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from plgwear_jax.scene.fields import Section, positive, wrong

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


class Layer(Section):
    """A layer, or the substrate below the last one, which has no thickness.

    Attributes:
        E: Young's modulus in Pa.
        thickness: Thickness in m; the substrate has none.
    """

    E: float = positive("Young's modulus in Pa")
    thickness: float | None = positive("the thickness of the layer in m", None)


class Layered(Section):
    """The section [material] with layers: layers on a substrate, from the surface downwards.

    Attributes:
        layers: The layers from the surface downwards, the substrate last.
        nu: Poisson's ratio of all layers.
    """

    layers: Annotated[tuple[Layer, ...], Field(strict=False, min_length=2)] = Field(
        description="must be a list such as [{ thickness = 2e-6, E = 400e9 }, { E = 110e9 }], "
        "in m and Pa from the surface downwards, the last one without thickness: the substrate"
    )
    nu: Annotated[float, _RATIO] = Field(description=f"{_NU}, that of all layers")

    @model_validator(mode="after")
    def _on_a_substrate(self) -> Self:
        *above, last = self.layers
        if last.thickness is not None:
            raise wrong("layers", "the substrate is missing: add a last layer without thickness, { E = ... }")
        for number, layer in enumerate(above, 1):
            if layer.thickness is None:
                raise wrong("layers", f"layer {number} has no thickness; only the last one, the substrate, has none")
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
    named = given if isinstance(given, dict) else {}
    return next((name for name in ("table", "layers") if name in named), "power law")


def named(material: Section, *, key: bool = False) -> str:
    """A material in words, or by its key."""
    kind = _kind(material)
    return kind if key or kind == "layers" else f"a {kind}"


MATERIALS: dict[str, type[Section]] = {"power law": Material, "table": Tabulated, "layers": Layered}
AnyMaterial = Annotated[
    Annotated[Material, Tag("power law")] | Annotated[Tabulated, Tag("table")] | Annotated[Layered, Tag("layers")],
    Discriminator(_kind),
]
