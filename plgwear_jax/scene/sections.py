"""The sections of a scene file and what each may contain, except the quantities; `scene` puts them together.

The description of a field is used in messages, after the value that is not allowed.
"""

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, field_validator, model_validator
from pydantic_core import PydanticCustomError

from plgwear_jax._core.words import one_line, shown

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.tables import Amplitudes

__all__ = [
    "INNER",
    "OBJECTIVES",
    "Design",
    "Fretting",
    "GrossSlip",
    "Load",
    "Material",
    "Output",
    "Section",
    "one_of",
    "wrong",
]


class Section(BaseModel):
    """A part of a file: only the keys named here, and no conversion of values."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


def wrong(key: str, allowed: str) -> PydanticCustomError:
    """An error in the key of a section, with a text of our own."""
    return PydanticCustomError("scene", "{allowed}", {"key": key, "allowed": allowed})


def _positive(meaning: str) -> Any:
    return Field(gt=0.0, allow_inf_nan=False, description=f"must be a finite number > 0, {meaning}")


_PositiveBound = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
_ExponentBound = Annotated[float, Field(gt=-1.0, lt=1.0, allow_inf_nan=False)]
_Any = TypeVar("_Any")
_Pair = Annotated[tuple[_Any, _Any], Field(strict=False)]  # TOML has lists only
_Bounds = tuple[tuple[float, float], tuple[float, float]]
_WINDOW = "{ at = [1e-5, 1e-3], between = [[60e9, 400e9], [60e9, 400e9]] }"
_FrettingObjective = Literal["wear_volume", "worn_radius", "deepest_wear"]
_GrossSlipObjective = Literal["volume_change", "force_drop"]
OBJECTIVES: dict[str, tuple[str, ...]] = {
    "fretting": get_args(_FrettingObjective),
    "gross-slip": get_args(_GrossSlipObjective),
}


def one_of(names: tuple[str, ...]) -> str:
    """The names of several strings to choose from, in words."""
    *first, last = (f'"{name}"' for name in names)
    return f"{', '.join(first)} or {last}"


def _in_order(bounds: tuple[float, float]) -> tuple[float, float]:
    if not bounds[0] < bounds[1]:
        raise ValueError
    return bounds


class Material(Section):
    """The section [material]: the half-space E(z) = E0 (z/z0)^k."""

    E0: float = _positive("the modulus at the depth z0 in Pa")
    z0: float = _positive("the characteristic depth in m")
    k: float = Field(gt=-1.0, lt=1.0, allow_inf_nan=False, description="must be a number with -1 < k < 1")
    nu: Annotated[float, Field(gt=-1.0, le=0.5, allow_inf_nan=False)] | Literal["holl"] = Field(
        description='must be a number with -1 < nu <= 0.5, or "holl"'
    )


class Fretting(Section):
    """The section [contact] with kind = "fretting": a parabolic indenter under a constant normal force."""

    kind: Literal["fretting"]
    radius: float = _positive("the radius of curvature of the indenter in m")
    normal_force: float = _positive("the normal force in N")
    friction: float = _positive("the coefficient of friction")

    @model_validator(mode="after")
    def _finite_limit(self) -> Self:
        if math.isinf(self.friction * self.normal_force):
            raise wrong("friction", "times normal_force exceeds the range of numbers")
        return self


class GrossSlip(Section):
    """The section [contact] with kind = "gross-slip": a flat-ended punch at a constant depth."""

    kind: Literal["gross-slip"]
    radius: float = _positive("the radius of the punch in m")
    depth: float = _positive("the indentation depth in m")


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
        weight = self._read.weight[self._read.weight > 0.0]
        weight = weight / weight.max()  # so that the sum stays within the range of numbers
        return weight / weight.sum()

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


class Window(Section):
    """A coating as its maker specifies it: the lowest and highest modulus that can be made, at two depths."""

    at: _Pair[_PositiveBound] = Field(description="must be [z1, z2] with 0 < z1 < z2, finite, two depths in m")
    between: _Pair[_Pair[_PositiveBound]] = Field(
        description="must be [[lower, upper], [lower, upper]] with 0 < lower < upper, finite, in Pa at either depth"
    )

    @field_validator("at")
    @classmethod
    def _downwards(cls, at: tuple[float, float]) -> tuple[float, float]:
        return _in_order(at)

    @field_validator("between")
    @classmethod
    def _each_in_order(cls, between: _Bounds) -> _Bounds:
        return _in_order(between[0]), _in_order(between[1])

    @property
    def exponents(self) -> tuple[float, float]:
        """The smallest and the largest k = log(E2/E1)/log(z2/z1) within the window, Eq. (1)."""
        (z1, z2), ((low1, high1), (low2, high2)) = self.at, self.between
        span = max(math.log(z2) - math.log(z1), sys.float_info.min)  # neighbouring numbers can have one logarithm
        return (math.log(low2) - math.log(high1)) / span, (math.log(high2) - math.log(low1)) / span

    @property
    def plain(self) -> dict[str, tuple[float, float]]:
        """Depths in m, lower and upper moduli in Pa there: at, lower, upper."""
        (low1, high1), (low2, high2) = self.between
        return {"at": self.at, "lower": (low1, low2), "upper": (high1, high2)}


class Vary(Section):
    """The design space: lower and upper bound of each quantity that may be chosen."""

    k: _Pair[_ExponentBound] | None = Field(None, description="must be [lower, upper] with -1 < lower < upper < 1")
    z0: _Pair[_PositiveBound] | None = Field(
        None, description="must be [lower, upper] with 0 < lower < upper, finite, in m"
    )
    E0: _Pair[_PositiveBound] | None = Field(
        None, description="must be [lower, upper] with 0 < lower < upper, finite, in Pa"
    )
    modulus: Window | None = Field(None, description=f"must be a window such as {_WINDOW}")

    @field_validator("k", "z0", "E0")
    @classmethod
    def _in_order(cls, bounds: tuple[float, float] | None) -> tuple[float, float] | None:
        return None if bounds is None else _in_order(bounds)

    @field_validator("modulus")
    @classmethod
    def _within_exponents(cls, window: Window | None) -> Window | None:
        if window is not None:
            lowest, highest = window.exponents
            if not -1.0 < lowest <= highest < 1.0:
                text = f"reaches from k = {lowest:.4g} to {highest:.4g}, where k = log(E2/E1)/log(z2/z1)"
                raise wrong("between", f"{text}; only -1 < k < 1 is possible")
        return window

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        if not self.bounds and self.modulus is None:
            raise ValueError
        return self

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """The bounds of k, z0 and E0 by name, without those that stay as they are."""
        named = {"k": self.k, "z0": self.z0, "E0": self.E0}
        return {name: bounds for name, bounds in named.items() if bounds is not None}


class HeldBy(Section):
    """Which of E0 and z0 is adjusted so that the contact radius stays that of the reference."""

    contact_radius: Literal["E0", "z0"]


class Tail(Section):
    """The conditional value at risk: the mean of the worst part 1 - cvar of the load."""

    cvar: float = Field(ge=0.0, lt=1.0, allow_inf_nan=False)


class EdgePressure(Section):
    """The highest pressure allowed at a distance inside the stick edge."""

    below: float = _positive("a pressure in Pa")
    distance: float = _positive("the distance from the stick edge in m")


class Limits(Section):
    """The limits of the best coating."""

    edge_pressure: EdgePressure | None = Field(
        None, description="must be { below = ..., distance = ... }, a pressure in Pa and a distance in m"
    )
    contact_radius: _Pair[Annotated[float, Field(ge=0.0)]] | None = Field(
        None, description="must be [lower, upper] with 0 <= lower < upper, in m, and a finite end other than 0"
    )
    penetration: float | None = Field(
        None, gt=0.0, allow_inf_nan=False, description="must be a finite number > 0, the largest penetration in m"
    )
    modulus: Window | None = Field(None, description=f"must be a window such as {_WINDOW}")

    @field_validator("contact_radius")
    @classmethod
    def _some_end(cls, radius: tuple[float, float] | None) -> tuple[float, float] | None:
        if radius == (0.0, math.inf):
            raise ValueError
        return None if radius is None else _in_order(radius)

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        if not self.plain:
            raise ValueError
        return self

    @property
    def plain(self) -> dict[str, Any]:
        """The limits that are given, by name: edge_pressure with distance, contact_radius with None for an open end."""
        found: dict[str, Any] = {}
        if self.edge_pressure is not None:
            found |= {"edge_pressure": self.edge_pressure.below, "distance": self.edge_pressure.distance}
        if self.contact_radius is not None:
            lower, upper = self.contact_radius
            found["contact_radius"] = (lower if lower > 0.0 else None, upper if upper < math.inf else None)
        if self.penetration is not None:
            found["penetration"] = self.penetration
        if self.modulus is not None:
            found["modulus"] = self.modulus.plain
        return found


class Design(Section):
    """The section [design]: what may vary, what is held, what is minimised, over which loads, within which limits."""

    vary: Vary = Field(
        description="must be a table of bounds such as { k = [-0.9, 0.9] }: k, z0 or E0, or a window of the modulus"
    )
    hold: Literal["contact_radius"] | HeldBy | None = Field(
        None, description='must be "contact_radius", { contact_radius = "E0" }, { contact_radius = "z0" }, or left out'
    )
    minimise: Literal[_FrettingObjective, _GrossSlipObjective] = Field(
        description=f"must be {one_of(OBJECTIVES['fretting'])}; for gross slip {one_of(OBJECTIVES['gross-slip'])}"
    )
    over: Literal["mean", "worst"] | Tail | None = Field(
        None, description='must be "mean", "worst", or { cvar = level } with 0 <= level < 1'
    )
    limits: Limits | None = Field(
        None,
        description="must be a table of limits such as { penetration = 2e-6 }: edge_pressure, contact_radius, "
        "penetration, modulus",
    )

    @model_validator(mode="after")
    def _no_more_than_counts(self) -> Self:
        """A contact depends on k and E0/z0^k only, so no more than these two can be chosen."""
        vary, held = self.vary, self._hold_shown
        if vary.modulus is not None and (held or vary.bounds):
            beside = held or next(iter(vary.bounds))
            text = f"cannot stand beside {beside}: modulus sets both k and E0/z0^k"
            raise wrong("vary.modulus", f"{text}; vary k and put the window under limits")
        for name in ("z0", "E0"):
            if held and name in vary.bounds:
                text = f"cannot vary while {held} sets {self._held_by}: only E0/z0^k counts for the contact"
                raise wrong(f"vary.{name}", f"{text}; leave one of both out, or bound E(z) by limits.modulus")
        if vary.z0 and vary.E0:
            raise wrong("vary.E0", "cannot vary beside z0: only E0/z0^k counts for the contact; vary one of them")
        if self._held_by == "z0" and vary.k and vary.k[0] <= 0.0 <= vary.k[1]:
            text = "z0 has no effect at k = 0, which lies within vary.k; hold it by E0, or vary k on one side of 0"
            raise wrong("hold", text)
        if held and self.limits is not None and self.limits.contact_radius is not None:
            raise wrong("limits.contact_radius", f"cannot be limited while {held} fixes it")
        return self

    @property
    def variables(self) -> dict[str, Any]:
        """What may vary: bounds of k, z0, E0, or for "modulus" the depths and the lower and upper moduli there."""
        window = self.vary.modulus
        return self.vary.bounds if window is None else {"modulus": window.plain}

    @property
    def held(self) -> Literal["contact_radius_by_E0", "contact_radius_by_z0"] | None:
        """What is held, and by what; None for nothing."""
        if self.hold is None:
            return None
        return "contact_radius_by_z0" if self._held_by == "z0" else "contact_radius_by_E0"

    @property
    def level(self) -> float:
        """The mean is taken over the worst 1 - level of the load: 0 is the mean of all, 1 the worst case."""
        if isinstance(self.over, Tail):
            return self.over.cvar
        return 1.0 if self.over == "worst" else 0.0

    @property
    def allowed(self) -> dict[str, Any] | None:
        """The limits that are given, by name; None without any. See `Limits.plain`."""
        return None if self.limits is None else self.limits.plain

    @property
    def _held_by(self) -> str:
        return self.hold.contact_radius if isinstance(self.hold, HeldBy) else "E0"

    @property
    def _hold_shown(self) -> str | None:
        """The line that holds something, as the file has it."""
        if self.hold is None:
            return None
        value = self.hold if isinstance(self.hold, str) else self.hold.model_dump()
        return f"hold = {shown(value)}"

    def refuse_for_gross_slip(self) -> None:
        """Refuse what a punch does not have."""
        for name in ("hold", "limits"):
            if getattr(self, name) is not None:
                raise wrong(name, 'only for a contact with kind = "fretting"')
        for name in self.variables:
            if name != "k":
                text = "cannot vary: what a gross-slip contact loses at a fixed depth depends on k alone"
                raise wrong(f"vary.{name}", text)

    def refuse_for_material(self, material: Material) -> None:
        """Refuse a variable that has no effect on this material."""
        if set(self.vary.bounds) == {"z0"} and material.k == 0.0:
            raise wrong("vary.z0", "has no effect at k = 0, the exponent of [material]; vary k as well, or E0")


class Output(Section):
    """The section [output]: the quantities asked for."""

    quantities: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] = Field(
        description="must be a list of one or more names of quantities"
    )
    points: int = Field(201, ge=2, le=100_000, description="must be a whole number from 2 to 100000")

    @field_validator("quantities")
    @classmethod
    def _each_once(cls, quantities: tuple[str, ...]) -> tuple[str, ...]:
        for name in quantities:
            if quantities.count(name) > 1:
                raise wrong("quantities", f'"{name}" is asked for more than once')
        return quantities


INNER: dict[str, Any] = {"vary": Vary, "modulus": Window, "limits": Limits, "edge_pressure": EdgePressure}
