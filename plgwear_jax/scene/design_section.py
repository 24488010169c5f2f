"""The section [design]: what may vary, be held and be limited."""

import itertools
import json
from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import Field, field_validator, model_validator

from plgwear_jax._core.rules import (
    HOLDS,
    OBJECTIVES,
    Hold,
    Kind,
    Objective,
    complaint,
    free_complaint,
    one_of,
    window_complaint,
)
from plgwear_jax.scene.fields import (
    WINDOW,
    ExponentBound,
    Pair,
    PositiveBound,
    Section,
    in_order,
    positive,
    wrong,
)

__all__ = [
    "ContactRadius",
    "Design",
    "EdgePressure",
    "Limits",
    "Penetration",
    "Vary",
    "Window",
]


_Some = TypeVar("_Some")
Several = Annotated[tuple[_Some, ...], Field(strict=False, min_length=2, max_length=8)]


class Window(Section):
    """A coating as its maker specifies it: the lowest and highest modulus that can be made, at two depths or more.

    At two depths it is a power law through moduli there. At three to eight depths these are what varies.
    """

    at: Several[PositiveBound] = Field(
        description="must be [z1, z2] with 0 < z1 < z2, finite, two depths in m, or for a free gradient three to eight"
    )
    between: Several[Pair[PositiveBound]] = Field(
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


class Vary(Section):
    """The design space: lower and upper bound of each quantity that may be chosen."""

    k: Pair[ExponentBound] | None = Field(None, description="must be [lower, upper] with -1 < lower < upper < 1")
    z0: Pair[PositiveBound] | None = Field(
        None, description="must be [lower, upper] with 0 < lower < upper, finite, in m"
    )
    E0: Pair[PositiveBound] | None = Field(
        None, description="must be [lower, upper] with 0 < lower < upper, finite, in Pa"
    )
    modulus: Window | None = Field(None, description=f"must be a window such as {WINDOW}")

    @field_validator("k", "z0", "E0")
    @classmethod
    def _in_order(cls, bounds: tuple[float, float] | None) -> tuple[float, float] | None:
        return None if bounds is None else in_order(bounds)

    @field_validator("modulus")
    @classmethod
    def _within_exponents(cls, window: Window | None) -> Window | None:
        if window is not None and not window.free:
            said = window_complaint(**window.plain)
            if said is not None:
                raise wrong("between", said)
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


class Tail(Section):
    """The conditional value at risk: the mean of the worst part 1 - cvar of the load."""

    cvar: float = Field(ge=0.0, lt=1.0, allow_inf_nan=False)


class EdgePressure(Section):
    """The highest pressure allowed at a distance inside the stick edge."""

    below: float = positive("a pressure in Pa")
    distance: float = positive("the distance from the stick edge in m")


class ContactRadius(Section):
    """The lowest and the highest contact radius allowed, or one of them."""

    above: float | None = positive("the lowest contact radius in m", None)
    below: float | None = positive("the highest contact radius in m", None)

    @model_validator(mode="after")
    def _some_end_in_order(self) -> Self:
        if self.above is None or self.below is None:
            if self.above is self.below:
                raise ValueError
        elif not self.above < self.below:
            raise ValueError
        return self


class Penetration(Section):
    """The largest penetration allowed."""

    below: float = positive("the largest penetration in m")


class Limits(Section):
    """The limits of the best coating: each says what is allowed, and where if it needs a place."""

    edge_pressure: EdgePressure | None = Field(
        None, description="must be { below = ..., distance = ... }, a pressure in Pa and a distance in m"
    )
    contact_radius: ContactRadius | None = Field(
        None, description="must be { above = ..., below = ... } with above < below, in m, or one of both alone"
    )
    penetration: Penetration | None = Field(None, description="must be { below = ... }, in m")
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
        """The limits that are given, by name: edge_pressure with distance, contact_radius with None for an open end."""
        found: dict[str, Any] = {}
        if self.edge_pressure is not None:
            found |= {"edge_pressure": self.edge_pressure.below, "distance": self.edge_pressure.distance}
        if self.contact_radius is not None:
            found["contact_radius"] = (self.contact_radius.above, self.contact_radius.below)
        if self.penetration is not None:
            found["penetration"] = self.penetration.below
        if self.modulus is not None:
            found["modulus"] = self.modulus.plain
        return found


class Design(Section):
    """The section [design]: what may vary, what is held, what is minimised, over which loads, within which limits."""

    vary: Vary = Field(
        description="must be a table of bounds such as { k = [-0.9, 0.9] }: k, z0 or E0, or a window of the modulus"
    )
    hold: Hold | Literal["contact_radius"] | None = Field(
        None,
        description=f'must be {", ".join(map(json.dumps, HOLDS))}, for a free gradient "contact_radius", or left out',
    )
    minimise: Objective = Field(
        description=f"must be {one_of(OBJECTIVES['fretting'])}; for gross slip {one_of(OBJECTIVES['gross-slip'])}"
    )
    over: Literal["mean", "worst"] | Tail | None = Field(
        None, description='must be "mean", "worst", or { cvar = level } with 0 <= level < 1'
    )
    limits: Limits | None = Field(
        None,
        description="must be a table of limits such as { penetration = { below = 2e-6 } }: edge_pressure, "
        "contact_radius, penetration, modulus",
    )

    @property
    def variables(self) -> dict[str, Any]:
        """What may vary: bounds of k, z0, E0, or for "modulus" the depths and the lower and upper moduli there."""
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
        pressure = None if self.limits is None else self.limits.edge_pressure
        return None if pressure is None else pressure.distance

    @property
    def allowed(self) -> dict[str, Any] | None:
        """The limits that are given, by name; None without any. See `Limits.plain`."""
        return None if self.limits is None else self.limits.plain

    @property
    def free(self) -> Window | None:
        """The bounds of a free gradient; None if the coating is a power law."""
        return self.vary.modulus if self.vary.modulus is not None and self.vary.modulus.free else None

    def refuse(self, kind: Kind | None, flat: bool) -> None:
        """Refuse what a design cannot have, for a contact of a kind, if known, and a material with k = 0 or not."""
        if self.free is not None:
            found = free_complaint(self.variables, self.hold, self.minimise, [*(self.allowed or ())], kind=kind)
        else:
            found = complaint(self.variables, self.hold, self.minimise, [*(self.allowed or ())], kind=kind, flat=flat)
        if found is not None:
            raise wrong(found.key, found.text)
