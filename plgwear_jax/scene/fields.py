"""What the sections of a scene are made of."""

import importlib
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

from plgwear_jax._core.ranges import EXPONENT, NUMBER, POISSON_RATIO, POSITIVE, Domain
from plgwear_jax.catalogue import leaf


class SceneError(ValueError):
    """An error in a scene, in one line: file, section, key, value, and what is allowed."""


class OtherFileError(SceneError):
    """An error in the file of a scene, or in another one that it names; its line begins with that file."""


class Section(BaseModel):
    """A part of a file: only the keys named here, and no conversion of values."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class Described(Section):
    """A part of a file that describes a record of the library, whose fields have the names of its keys."""

    record_name: ClassVar[str]  # with the module of the library that has it

    @property
    def known(self) -> dict[str, Any]:
        """The fields of the record."""
        return {name: value for name, value in self if name != "kind"}

    def record(self, **others: Any) -> Any:
        """The record, with those fields that are told elsewhere. Imports JAX."""
        inner = {name: value.record() if isinstance(value, Described) else value for name, value in self.known.items()}
        module, _, name = self.record_name.rpartition(".")
        return getattr(importlib.import_module(f"plgwear_jax.{module}"), name)(**inner | others)


def wrong(key: str, allowed: str) -> PydanticCustomError:
    """An error in the key of a section, with a text of our own."""
    return PydanticCustomError("scene", "{allowed}", {"key": key, "allowed": allowed})


def from_table(form: Any, name: str, folder: Any) -> Any:
    """The content of a CSV file that a scene names; `form` takes the module `tables` and gives its form."""
    from plgwear_jax import tables  # imports NumPy, which a scene without files does not need

    try:
        return tables.read(folder / name, form(tables))
    except tables.TableError as error:
        raise in_other_file(error) from None


def in_other_file(error: ValueError) -> PydanticCustomError:
    """An error in another file than the scene."""
    return PydanticCustomError("table", "{line}", {"line": str(error)})


# --- numbers ----------------------------------------------------------------------------------------------------------

_ALLOWED: dict[Domain, tuple[dict[str, float], str, str]] = {  # for JSON schemas, for a number, for a pair of bounds
    POSITIVE: ({"gt": 0.0}, "a finite number > 0", "0 < lower < upper, finite"),
    NUMBER: ({"ge": 0.0}, "a finite number >= 0", ""),
    EXPONENT: ({"gt": -1.0, "lt": 1.0}, "a number with -1 < k < 1", "-1 < lower < upper < 1"),
    POISSON_RATIO: ({"gt": -1.0, "le": 0.5}, "a number with -1 < nu <= 0.5", "-1 < lower < upper <= 0.5"),
}


def number(domain: Domain, meaning: str = "", default: Any = ...) -> Any:
    """A number in a domain, and what it is."""
    limits: Any = _ALLOWED[domain][0]
    told = f"must be {_ALLOWED[domain][1]}{', ' if meaning else ''}{meaning}"
    return Field(default, allow_inf_nan=False, description=told, **limits)


def positive(meaning: str, default: Any = ...) -> Any:
    """A finite number > 0."""
    return number(POSITIVE, meaning, default)


PositiveBound = Annotated[float, positive("")]
Ratio = Annotated[float, number(POISSON_RATIO)]
RATIO = f"must be {_ALLOWED[POISSON_RATIO][1]}"
Pair = Annotated[tuple[float, float], Field(strict=False)]  # TOML has lists only
WINDOW = "{ at = [1e-5, 1e-3], between = [[60e9, 400e9], [60e9, 400e9]] }"


def domain_of_bounds(path: str) -> Domain:
    """What both bounds of a number of a contact may be."""
    domain = leaf(path).domain
    return domain if domain in _ALLOWED else POSITIVE


def bounds_form(path: str) -> str:
    """How the bounds of a number of a contact are written."""
    within = "1 <= lower < upper" if path == "shape.exponent" else _ALLOWED[domain_of_bounds(path)][2]
    unit = leaf(path).unit
    return f"must be [lower, upper] with {within}{'' if unit == '1' else f', in {unit}'}"


def bounds(path: str) -> Any:
    """The bounds of a number of a contact, which `in_order` checks; left out, it does not vary."""
    return Field(None, description=bounds_form(path))


def in_order(ends: tuple[float, float], domain: Domain = POSITIVE) -> tuple[float, float]:
    """The ends of a range, if both are allowed and the lowest is below the highest."""
    if not (domain.contains(ends[0]) and domain.contains(ends[1]) and ends[0] < ends[1]):
        raise ValueError
    return ends
