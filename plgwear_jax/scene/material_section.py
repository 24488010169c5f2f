"""The sections that describe a half-space, an elastic indenter or a shape, and become these records."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import Discriminator, Field, PrivateAttr, Tag, ValidationInfo, model_validator

from plgwear_jax._core.ranges import EXPONENT
from plgwear_jax.scene.fields import RATIO, Described, PositiveBound, Ratio, from_table, number, positive, wrong

if TYPE_CHECKING:
    from plgwear_jax.tables import Table


class HalfSpace(Described):
    """The section [material], of any kind."""

    words: ClassVar[str]

    @property
    def rows(self) -> dict[str, Any]:
        """The rows of numbers by name: thicknesses or depths, and moduli; none of a power law."""
        return {name: value for name, value in self.known.items() if not isinstance(value, float | str)}


class Material(HalfSpace):
    """The section [material]: the half-space E(z) = E0 (z/z0)^k.

    Attributes:
        E0: Young's modulus at the depth z0, in Pa.
        z0: Characteristic depth in m, at which the modulus is E0.
        k: Exponent; k > 0 is compliant at the surface and stiffer with depth, k < 0 the opposite.
        nu: Poisson's ratio; "holl" is 1/(2 + k).
    """

    record_name, words = "material.PowerLawGraded", "a power law"

    E0: float = positive("the modulus at the depth z0 in Pa")
    z0: float = positive("the characteristic depth in m")
    k: float = number(EXPONENT)
    nu: Ratio | Literal["holl"] = Field(description=f'{RATIO}, or "holl"')


class _FromFile(Described):
    """A part of a file that names a CSV file, whose columns are fields of the record."""

    form: ClassVar[str]
    _read: "Table | None" = PrivateAttr(None)

    @model_validator(mode="after")
    def _from_file(self, info: ValidationInfo) -> Self:
        folder, name = Path((info.context or {}).get("folder", "")), getattr(self, "table")  # noqa: B009
        self._read = from_table(lambda tables: getattr(tables, self.form), name, folder)
        return self

    @property
    def read(self) -> "Table":
        """The content of the file."""
        assert self._read is not None
        return self._read


class Tabulated(_FromFile, HalfSpace):
    """The section [material] with table: a half-space whose modulus is given at some depths.

    Attributes:
        table: CSV file with the columns depth and modulus, whose headers may name units.
        nu: Poisson's ratio, the same at all depths.
    """

    record_name, words, form = "surfaces.DepthGraded", "a table", "MODULUS"

    table: str = Field(
        min_length=1, description="must be the name of a CSV file with the columns depth and modulus, in m and Pa"
    )
    nu: Ratio = Field(description=f"{RATIO}, the same at all depths")

    @property
    def known(self) -> dict[str, Any]:
        """The fields of the record."""
        return {**self.read.columns, "nu": self.nu}


Lengths = Annotated[tuple[PositiveBound, ...], Field(strict=False)]


class Layers(HalfSpace):
    """The section [material] with thickness and modulus: layers on a substrate.

    Attributes:
        thickness: Thicknesses of the layers in m, from the surface downwards; without a layer [].
        modulus: Young's moduli of the layers and, the last one, of the substrate, in Pa.
        nu: Poisson's ratio of all layers and the substrate.
    """

    record_name, words = "surfaces.Layered", "layers"

    thickness: Lengths = Field(
        description="must be a list of finite numbers > 0 such as [2e-6, 3e-6], "
        "the thicknesses of the layers in m from the surface downwards"
    )
    modulus: Lengths = Field(
        description="must be a list of finite numbers > 0 such as [400e9, 200e9, 110e9], "
        "the moduli of the layers and, last, of the substrate in Pa"
    )
    nu: Ratio = Field(description=f"{RATIO}, that of all layers and the substrate")

    @model_validator(mode="after")
    def _on_a_substrate(self) -> Self:
        layers, moduli = len(self.thickness), len(self.modulus)
        if moduli != layers + 1:
            text = f"must hold {layers + 1} moduli for {layers} thicknesses, the last one that of the substrate"
            raise wrong("modulus", f"{text}, not {moduli}")
        return self


class Indenter(Described):
    """The key [contact] indenter of an elastic indenter.

    Attributes:
        E: Young's modulus of the indenter in Pa.
        nu: Poisson's ratio of the indenter.
    """

    record_name = "surfaces.Elastic"

    E: float = positive("Young's modulus in Pa")
    nu: Ratio


class PowerShape(Described):
    """The key [contact] shape of an indenter r^n/(n R^(n-1)).

    Attributes:
        kind: Which shape this is.
        exponent: The exponent n.
    """

    record_name = "shapes.PowerShape"

    kind: Literal["power"]
    exponent: float = Field(ge=1.0, allow_inf_nan=False)


class Cone(Described):
    """The key [contact] shape of a cone.

    Attributes:
        kind: Which shape this is.
        slope: Slope of the cone, dimensionless; its height is the slope times the radius.
    """

    record_name = "shapes.Cone"

    kind: Literal["cone"]
    slope: float = positive("the slope of the cone")


class Flat(Described):
    """The key [contact] shape of an indenter with a flat face.

    Attributes:
        kind: Which shape this is.
        flat_radius: Radius of the flat face in m.
    """

    kind: Literal["rounded_flat", "truncated_sphere"]
    flat_radius: float = Field(ge=0.0, allow_inf_nan=False)

    @property
    def record_name(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The record of this kind."""
        return "shapes.RoundedFlat" if self.kind == "rounded_flat" else "shapes.TruncatedSphere"


class Profile(_FromFile):
    """The key [contact] shape with table: heights at some radii, which the scene reads.

    Attributes:
        table: CSV file with the columns r and height, whose headers may name units.
    """

    record_name, form = "shapes.Profile", "HEIGHTS"

    table: str = Field(min_length=1)

    @property
    def known(self) -> dict[str, Any]:
        """The fields of the record."""
        return {"r": self.read["r"], "heights": self.read["height"]}


Shape = PowerShape | Cone | Flat | Profile
SHAPES = (
    '{ kind = "power", exponent = 4 } with an exponent >= 1, { kind = "cone", slope = 0.01 } with a slope > 0, '
    '{ kind = "rounded_flat", flat_radius = 1e-5 } or { kind = "truncated_sphere", flat_radius = 1e-5 } with a radius '
    '>= 0 in m, or { table = "profile.csv" }, a CSV file with the columns r and height'
)


def _kind(given: Any) -> str:
    """Which of the materials a section means."""
    keys = {"table": "table", "thickness": "layers", "modulus": "layers"}
    there = given if isinstance(given, dict) else getattr(given, "__dict__", ())
    return next((kind for key, kind in keys.items() if key in there), "power law")


MATERIALS: dict[str, type[HalfSpace]] = {"power law": Material, "table": Tabulated, "layers": Layers}
AnyMaterial = Annotated[
    Annotated[Material, Tag("power law")] | Annotated[Tabulated, Tag("table")] | Annotated[Layers, Tag("layers")],
    Discriminator(_kind),
]
