"""The section [design]: what may vary, be held and be limited."""

import itertools
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeVar

from pydantic import ConfigDict, Field, PrivateAttr, create_model, field_validator, model_validator
from pydantic_core import PydanticCustomError

from plgwear_jax._core.ranges import NUMBER, Domain
from plgwear_jax.catalogue import QUANTITIES
from plgwear_jax.rules import (
    PLACES,
    Complaint,
    Hold,
    Kind,
    complaint,
    free_complaint,
    limit_form,
    limited_quantity,
    placed_quantity,
    window_complaint,
)
from plgwear_jax.scene.fields import (
    WINDOW,
    Pair,
    PositiveBound,
    Section,
    bounds,
    bounds_form,
    domain_of_bounds,
    from_table,
    in_order,
    number,
    positive,
    wrong,
)

if TYPE_CHECKING:
    from plgwear_jax.tables import Table

_Some = TypeVar("_Some")
Several = Annotated[tuple[_Some, ...], Field(strict=False, min_length=2, max_length=8)]


class Window(Section):
    """A coating as its maker specifies it: the lowest and highest modulus that can be made, at two depths or more.

    At two depths it is a power law through moduli there. At three to eight depths these are what varies.

    Attributes:
        at: The depths in m.
        between: The lowest and the highest modulus at each depth, in Pa.
        steepness: The largest |log(E2/E1)/log(z2/z1)| between neighbouring depths; of a power law this is |k|.
    """

    at: Several[PositiveBound] = Field(
        description="must be [z1, z2] with 0 < z1 < z2, finite, two depths in m, or for a free gradient three to eight"
    )
    between: Several[Pair] = Field(
        description="must be [[lower, upper], [lower, upper]] with 0 < lower < upper, finite, in Pa at either depth"
    )
    steepness: float | None = positive("the largest |log(E2/E1)/log(z2/z1)| between depths of a free gradient", None)

    @field_validator("at")
    @classmethod
    def _downwards(cls, at: tuple[float, ...]) -> tuple[float, ...]:
        for pair in itertools.pairwise(at):
            in_order(pair)
        return at

    @field_validator("between")
    @classmethod
    def _each_in_order(cls, between: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        return tuple(in_order(pair) for pair in between)

    @model_validator(mode="after")
    def _at_each_depth(self) -> Self:
        if len(self.at) != len(self.between):
            raise wrong("between", f"must hold a pair [lower, upper] for each of the {len(self.at)} depths of at")
        if self.steepness is not None and len(self.at) == 2:
            raise wrong("steepness", "only for a free gradient, with three to eight depths; at two it is |k|")
        return self

    @property
    def free(self) -> bool:
        """The modulus is free at all depths: no power law is asked for."""
        return len(self.at) > 2

    @property
    def plain(self) -> dict[str, Any]:
        """Depths in m, lower and upper moduli in Pa there: at, lower, upper."""
        lower, upper = zip(*self.between, strict=True)
        return {"at": self.at, "lower": lower, "upper": upper}


class _Bounded(Section):
    """Lower and upper bounds of numbers of a contact, which `Vary` checks."""

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        if not self.bounds and getattr(self, "modulus", None) is None:
            raise ValueError
        return self

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """The bounds by name, such as k and indenter.E, without the numbers that stay as they are."""
        found = {}
        for name, given in self:
            if isinstance(given, _Bounded):
                found |= {f"{name}.{inner}": bounds for inner, bounds in given.bounds.items()}
            elif isinstance(given, tuple):
                found[name] = given
        return found


class VaryIndenter(_Bounded):
    """The bounds of an elastic indenter.

    Attributes:
        E: Young's modulus of the indenter in Pa.
        nu: Poisson's ratio of the indenter.
    """

    E: Pair | None = bounds("indenter.E")
    nu: Pair | None = bounds("indenter.nu")


class VaryShape(_Bounded):
    """The bounds of the shape of the indenter.

    Attributes:
        exponent: Exponent of a power shape.
        slope: Slope of a cone, dimensionless.
        flat_radius: Radius of the flat face in m.
    """

    exponent: Pair | None = bounds("shape.exponent")
    slope: Pair | None = bounds("shape.slope")
    flat_radius: Pair | None = bounds("shape.flat_radius")


_ELEMENT = re.compile(r"^material\.(thickness|depth|modulus)\[\d+\]$")
ELEMENTS = "material.thickness[0]", "material.modulus[0]"  # how they are written


def _by_pattern(schema: dict[str, Any]) -> None:
    """In the JSON schema, the names of elements in place of any other keys."""
    schema["patternProperties"] = {_ELEMENT.pattern: schema["additionalProperties"]}
    schema["additionalProperties"] = False


class Vary(_Bounded):
    """The design space: lower and upper bound of each number of the contact that may be chosen.

    Besides these keys it takes the numbers of layers and tables by their names in Python, the first one 0:
    "material.thickness[0]" = [1e-6, 2e-5], "material.modulus[0]" = [100e9, 400e9].

    Attributes:
        k: Exponent of the modulus.
        z0: Characteristic depth in m; not together with E0.
        E0: Modulus at the depth z0 in Pa; not together with z0.
        modulus: The modulus at two depths; at three to eight depths a free gradient.
        nu: Poisson's ratio of the half-space.
        radius: Radius of the indenter in m.
        normal_force: Normal force in N.
        friction: Coefficient of friction.
        depth: Indentation depth of a punch in m.
        indenter: Bounds of an elastic indenter.
        shape: Bounds of the shape of the indenter.
    """

    k: Pair | None = bounds("k")
    z0: Pair | None = bounds("z0")
    E0: Pair | None = bounds("E0")
    modulus: Window | None = Field(None, description=f"must be a window such as {WINDOW}")
    nu: Pair | None = bounds("nu")
    radius: Pair | None = bounds("radius")
    normal_force: Pair | None = bounds("normal_force")
    friction: Pair | None = bounds("friction")
    depth: Pair | None = bounds("depth")
    indenter: VaryIndenter | None = Field(None, description="must be bounds such as { E = [70e9, 400e9] }, in Pa")
    shape: VaryShape | None = Field(None, description="must be bounds such as { exponent = [2, 6] }")

    model_config = ConfigDict(extra="allow", json_schema_extra=_by_pattern)
    __pydantic_extra__: dict[str, Pair]  # pyright: ignore[reportIncompatibleVariableOverride]

    @model_validator(mode="before")
    @classmethod
    def _known(cls, given: Any) -> Any:
        for name in given if isinstance(given, dict) else ():
            if name not in cls.model_fields and not _ELEMENT.fullmatch(name):
                raise PydanticCustomError("extra_forbidden", "{key}", {"key": [name]})
        return given

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        for name, ends in self.bounds.items():
            try:
                in_order(ends, domain_of_bounds(name))
            except ValueError:
                raise wrong(name, bounds_form(name)) from None
        return self

    @field_validator("modulus")
    @classmethod
    def _within_exponents(cls, window: Window | None) -> Window | None:
        if window is not None and not window.free:
            said = window_complaint(**window.plain)
            if said is not None:
                raise wrong("between", said)
        return window


class Tail(Section):
    """The conditional value at risk: the mean of the worst part 1 - cvar of the load.

    Attributes:
        cvar: Level: 0.9 is the mean of the worst 10 %.
    """

    cvar: float = Field(ge=0.0, lt=1.0)


class Allowed(Section):
    """What a quantity may be, and where if it needs a place.

    Attributes:
        above: Lowest value, in the SI unit of the quantity.
        below: Highest value, in the SI unit of the quantity.
        between: Lowest and highest value, in the SI unit of the quantity.
        distance: Distance from the stick edge in m, for pressures there.
        r: Distance from the axis in m, for functions of the radius.
        z: Depth in m, for the modulus there.
    """

    above: float | None = positive("the lowest value in the SI unit of the quantity", None)
    below: float | None = positive("the highest value in the SI unit of the quantity", None)
    between: Pair | None = Field(
        None, description="must be [lowest, highest] with 0 < lowest < highest, finite, in the SI unit of the quantity"
    )
    distance: float | None = positive(PLACES["distance"], None)
    r: float | None = number(NUMBER, PLACES["r"], None)
    z: float | None = positive(PLACES["z"], None)

    @field_validator("between")
    @classmethod
    def _in_order(cls, ends: tuple[float, float] | None) -> tuple[float, float] | None:
        return None if ends is None else in_order(ends)

    @property
    def plain(self) -> dict[str, Any]:
        """What is given, by name."""
        return {name: value for name, value in self if value is not None}


class _Limits(Section):
    """The limits of the best design: each says what is allowed, and where if it needs a place."""

    modulus: Window | None = Field(None, description=f"must be a window such as {WINDOW}")

    @field_validator("modulus")
    @classmethod
    def _two_depths(cls, window: Window | None) -> Window | None:
        if window is not None and window.free:
            raise wrong("at", "must be [z1, z2]: a limit is at two depths; vary the modulus for a free gradient")
        return window

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        if not self.plain:
            raise ValueError
        return self

    @property
    def plain(self) -> dict[str, Any]:
        """The limits that are given, by quantity: above, below or between, with the place, or the window."""
        return {name: given.plain for name, given in self if given is not None}


_LIMITED = dict.fromkeys(["edge_pressure", "contact_radius", "penetration", "pressure"])
_LIMITED |= dict.fromkeys(name for laws in QUANTITIES.values() for name in laws)
Quantity = Annotated[str, Field(json_schema_extra={"enum": [*_LIMITED]})]
if TYPE_CHECKING:
    Limits = _Limits
else:
    Limits = create_model(
        "Limits",
        __base__=_Limits,
        __doc__=_Limits.__doc__,
        **{name: (Allowed | None, Field(None, description=f"must be {limit_form(name)}")) for name in _LIMITED},
    )


class Design(Section):
    """The section [design]: what may vary, what is held, what is minimised, over which loads, within which limits.

    Attributes:
        vary: What may vary, and between which bounds.
        hold: What is kept equal to the reference: the initial contact radius, by adjusting E0.
        minimise: The quantity that is minimised.
        over: How the amplitudes of a table, and scenarios, count; without it their mean.
        scenarios: A CSV file of what the contact may turn out to be.
        limits: Limits of quantities in the steady state, and of the modulus at two depths.
    """

    vary: Vary = Field(
        description="must be a table of bounds such as { k = [-0.9, 0.9] }: numbers of the material and the contact, "
        "or a window of the modulus"
    )
    hold: Hold | None = Field(None, description='must be "contact_radius", or left out')
    minimise: Quantity | dict[str, dict[str, Annotated[float, number(NUMBER)]]] = Field(
        description='must be a quantity such as "wear_volume", or one with its place, '
        "{ edge_pressure = { distance = 1e-6 } }",
    )
    over: Literal["mean", "worst"] | Tail | None = Field(
        None, description='must be "mean", "worst", or { cvar = level } with 0 <= level < 1'
    )
    scenarios: str | None = Field(
        None,
        min_length=1,
        description="must be the name of a CSV file of what the contact may turn out to be: columns of its numbers, "
        "such as friction, E0 or wear_coefficient, and if wanted weight",
    )
    limits: Limits | None = Field(
        None,
        description="must be a table of limits such as { deepest_wear = { below = 2e-6 } }, of any quantities, "
        "or of the modulus",
    )
    _scatter: "Table | None" = PrivateAttr(None)

    def read(self, folder: Path, columns: dict[str, Domain]) -> None:
        """Read the scenarios, if a file of them is named.

        Args:
            folder: Where names of files begin.
            columns: The numbers of the contact that it may have.
        """
        if self.scenarios is not None:
            self._scatter = from_table(lambda tables: tables.scenarios(columns), self.scenarios, folder)

    @property
    def scatter(self) -> "Table | None":
        """The scenarios; None without."""
        return self._scatter

    @property
    def variables(self) -> dict[str, Any]:
        """What may vary: bounds by name, for "modulus" the depths and the lower and upper moduli there."""
        window = self.vary.modulus
        return self.vary.bounds | ({} if window is None else {"modulus": window.plain})

    @property
    def level(self) -> float:
        """The mean is taken over the worst 1 - level of the load: 0 is the mean of all, 1 the worst case."""
        if isinstance(self.over, Tail):
            return self.over.cvar
        return 1.0 if self.over == "worst" else 0.0

    @property
    def edge_distance(self) -> float | None:
        """The distance in m inside the stick edge at which the pressure is limited; None without this limit."""
        allowed = self.allowed or {}
        return next((allowed[name].get("distance") for name in ("edge_pressure", "pressure") if name in allowed), None)

    @property
    def allowed(self) -> dict[str, Any] | None:
        """The limits that are given, by name; None without any. See `Limits.plain`."""
        return None if self.limits is None else self.limits.plain

    @property
    def free(self) -> Window | None:
        """The bounds of a free gradient; None if the coating is a power law."""
        return self.vary.modulus if self.vary.modulus is not None and self.vary.modulus.free else None

    @property
    def objective(self) -> str:
        """The quantity that is minimised."""
        return self.minimise if isinstance(self.minimise, str) else next(iter(self.minimise), "")

    def refuse(self, kind: Kind | None, flat: bool) -> None:
        """Refuse what a design cannot have, for a contact of a kind, if known, and a material with k = 0 or not."""
        places = {} if isinstance(self.minimise, str) else self.minimise.get(self.objective, {})
        if not isinstance(self.minimise, str) and len(self.minimise) != 1:
            raise wrong("minimise", "must name one quantity")
        allowed = self.allowed or {}
        found = placed_quantity("minimise", self.objective, places, kind)
        for name, given in allowed.items():
            if isinstance(found, str) and name != "modulus":
                one = limited_quantity(name, given, kind)
                found = one if isinstance(one, Complaint) else found
        if isinstance(found, str):
            if self.free is not None:
                found = free_complaint(self.variables, bool(self.hold), [*allowed], kind=kind)
                if found is None and self.scenarios is not None:
                    found = Complaint("scenarios", "cannot be combined with a free gradient; only a power law takes it")
            else:
                found = complaint(self.variables, bool(self.hold), found, [*allowed], kind=kind, flat=flat)
        if found is not None:
            raise wrong(found.key, found.text)
