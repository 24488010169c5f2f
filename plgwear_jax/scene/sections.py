"""The sections of a scene file and what each may contain, except the quantities; `scene` puts them together.

The description of a field is used in messages, after the value that is not allowed.
"""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, field_validator, model_validator
from pydantic_core import PydanticCustomError

from plgwear_jax._core.words import one_line

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.tables import Amplitudes
from plgwear_jax.scene.design_section import ContactRadius, EdgePressure, Limits, Penetration, Vary, Window
from plgwear_jax.scene.fields import Material, Section, positive, wrong

__all__ = [
    "INNER",
    "Fretting",
    "GrossSlip",
    "Load",
    "Material",
    "Output",
]


class Fretting(Section):
    """The section [contact] with kind = "fretting": a parabolic indenter under a constant normal force."""

    kind: Literal["fretting"]
    radius: float = positive("the radius of curvature of the indenter in m")
    normal_force: float = positive("the normal force in N")
    friction: float = positive("the coefficient of friction")

    @model_validator(mode="after")
    def _finite_limit(self) -> Self:
        if math.isinf(self.friction * self.normal_force):
            raise wrong("friction", "times normal_force exceeds the range of numbers")
        return self


class GrossSlip(Section):
    """The section [contact] with kind = "gross-slip": a flat-ended punch at a constant depth."""

    kind: Literal["gross-slip"]
    radius: float = positive("the radius of the punch in m")
    depth: float = positive("the indentation depth in m")


class Load(Section):
    """The section [load] of a fretting contact: one amplitude, or a file of many, which the scene reads.

    Attributes:
        tangential_force: The amplitude in N; None if a file gives it.
        table: A CSV file of amplitudes with weights, as the scene names it; see `tables.read_table`.
        history: A CSV file of amplitudes over cycles, as the scene names it; see `tables.read_history`.
    """

    tangential_force: float | None = Field(
        None, ge=0.0, allow_inf_nan=False, description="must be a finite number >= 0, the amplitude of the force in N"
    )
    table: str | None = Field(
        None, min_length=1, description="must be the name of a CSV file with the columns tangential_force and weight"
    )
    history: str | None = Field(
        None, min_length=1, description="must be the name of a CSV file with the column tangential_force"
    )
    _read: "Amplitudes | None" = PrivateAttr(None)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [name for name in type(self).model_fields if getattr(self, name) is not None]
        if not kinds:
            raise wrong("", f"needs one of its keys {', '.join(type(self).model_fields)}")
        if len(kinds) > 1:
            raise wrong(kinds[-1], f"stands beside {kinds[0]}; only one of them can be the load")
        return self

    def read(self, folder: Path, limit: float) -> None:
        """Read the file that is named, if any, and refuse amplitudes from a limit in N on, where the slip is gross.

        Args:
            folder: Where names of files begin.
            limit: mu F_N in N.
        """
        if self.tangential_force is not None and not self.tangential_force < limit:
            text = f"this is gross slip, F_x = {self.tangential_force:g} N is not below mu F_N = {limit:g} N"
            raise wrong("tangential_force", f"{text}; lower it, or raise friction or normal_force")
        if self.table is None and self.history is None:
            return
        from plgwear_jax import tables  # imports NumPy, which a scene with one amplitude does not need

        try:
            if self.table is not None:
                self._read = tables.read_table(folder / self.table)
            else:
                assert self.history is not None
                self._read = tables.read_history(folder / self.history)
            self._read.refuse_from(limit)
        except tables.TableError as error:  # the error is in another file than the scene
            raise PydanticCustomError("table", "{line}", {"line": str(error)}) from None

    @property
    def amplitudes(self) -> "np.ndarray":
        """Amplitudes in N, shape (n,): the one amplitude, all of a history, or those of a table with weight > 0."""
        if self._read is None:
            import numpy as np

            return np.array([self.tangential_force], float)
        forces, weight = self._read.tangential_force, self._read.weight
        return forces if weight is None else forces[weight > 0.0]

    @property
    def weights(self) -> "np.ndarray | None":
        """Weights of the amplitudes of a table, > 0, shape (n,), with the sum 1; None if there is no table."""
        if self._read is None or self._read.weight is None:
            return None
        from plgwear_jax.optimise.loads import shares

        return shares(self._read.weight[self._read.weight > 0.0])

    @property
    def largest(self) -> float:
        """The largest amplitude in N: it determines the worn state of a history, and the worst case of a table."""
        return float(self.amplitudes.max() if self.tangential_force is None else self.tangential_force)

    @property
    def force(self) -> "float | np.ndarray":
        """What enters a computation, in N: one amplitude, the largest of a history, or the amplitudes of a table."""
        return self.largest if self.table is None else self.amplitudes

    @property
    def remark(self) -> str | None:
        """For a history, the line that says which amplitude counts; else None."""
        if self.history is None or self._read is None:
            return None
        forces = self._read.tangential_force
        number = "1 amplitude" if forces.size == 1 else f"{forces.size} amplitudes"
        row = self._read.row[forces.argmax()]
        deciding = f"the largest, {self.largest:g} N (row {row}), decides the worn state"
        return f"history {one_line(self.history)}: {number}; {deciding}"


class Output(Section):
    """The section [output]: the quantities asked for."""

    quantities: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] = Field(
        description="must be a list of one or more names of quantities"
    )
    distance: float | None = Field(
        None,
        gt=0.0,
        allow_inf_nan=False,
        description="must be a finite number > 0, the distance inside the edge at which pressures are given, in m",
    )
    points: int = Field(201, ge=2, le=100_000, description="must be a whole number from 2 to 100000")

    @field_validator("quantities")
    @classmethod
    def _each_once(cls, quantities: tuple[str, ...]) -> tuple[str, ...]:
        for name in quantities:
            if quantities.count(name) > 1:
                raise wrong("quantities", f'"{name}" is asked for more than once')
        return quantities


INNER: dict[str, Any] = {
    "vary": Vary,
    "modulus": Window,
    "limits": Limits,
    "edge_pressure": EdgePressure,
    "contact_radius": ContactRadius,
    "penetration": Penetration,
}
