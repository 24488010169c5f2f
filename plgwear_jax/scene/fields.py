"""What the sections of a scene are made of."""

from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError


class SceneError(ValueError):
    """An error in a scene, in one line: file, section, key, value, and what is allowed."""


class OtherFileError(SceneError):
    """An error in a file that a scene names; its line begins with that file."""


class Section(BaseModel):
    """A part of a file: only the keys named here, and no conversion of values."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


def wrong(key: str, allowed: str) -> PydanticCustomError:
    """An error in the key of a section, with a text of our own."""
    return PydanticCustomError("scene", "{allowed}", {"key": key, "allowed": allowed})


def positive(meaning: str, default: Any = ...) -> Any:
    """A finite number > 0."""
    return Field(default, gt=0.0, allow_inf_nan=False, description=f"must be a finite number > 0, {meaning}")


PositiveBound = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
ExponentBound = Annotated[float, Field(gt=-1.0, lt=1.0, allow_inf_nan=False)]
RatioBound = Annotated[float, Field(gt=-1.0, le=0.5, allow_inf_nan=False)]
_Any = TypeVar("_Any")
Pair = Annotated[tuple[_Any, _Any], Field(strict=False)]  # TOML has lists only
WINDOW = "{ at = [1e-5, 1e-3], between = [[60e9, 400e9], [60e9, 400e9]] }"


def in_order(bounds: tuple[float, float]) -> tuple[float, float]:
    """The bounds, if the lowest is below the highest."""
    if not bounds[0] < bounds[1]:
        raise ValueError
    return bounds
