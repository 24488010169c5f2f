"""A scene file: material, contact, load, design space and the quantities asked for, read from TOML and checked.

Everything that can be wrong with a file is said here, in one line, before anything is computed.
"""

import datetime
import difflib
import functools
import json
import math
import os
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_validator, model_validator
from pydantic_core import ErrorDetails, PydanticCustomError

from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.material import PowerLawGraded

__all__ = ["Quantity", "Scene", "SceneError", "load", "one_line"]


class SceneError(ValueError):
    """What is wrong with a scene file, in one line: file, section, key, value, and what is allowed."""


class Quantity(NamedTuple):
    """One result of `Scene.solve`.

    Attributes:
        value: A float, or an array along `radii`.
        unit: The SI unit of the value; "1" for a plain number.
        description: What it is, in words.
        radii: The radii in m that the array belongs to; None for a single number.
        unbounded_at: Where the array grows without bound, so that its largest entry means nothing; else None.
    """

    value: float | np.ndarray
    unit: str
    description: str
    radii: np.ndarray | None = None
    unbounded_at: str | None = None


# --- the quantities -------------------------------------------------------------------------------------------------


class _Law(NamedTuple):
    """How a method of a contact is called, and what it gives."""

    arguments: tuple[Literal["r", "F_x"], ...]
    unit: str
    description: str
    unbounded_at: str | None = None


_FRETTING = {
    "contact_radius": _Law((), "m", "contact radius a_0 before any wear"),
    "stick_radius": _Law(("F_x",), "m", "stick radius c, the inner edge of the worn ring"),
    "worn_radius": _Law(("F_x",), "m", "outer radius a_inf of the worn ring"),
    "penetration": _Law(("F_x",), "m", "penetration d_inf of the worn indenter"),
    "wear_volume": _Law(("F_x",), "m^3", "volume worn off until the steady state"),
    "edge_intensity": _Law(("F_x",), "Pa", "strength of the pressure singularity at the stick edge"),
    "profile": _Law(("r", "F_x"), "m", "shape f_inf of the worn indenter above its apex"),
    "wear_depth": _Law(("r", "F_x"), "m", "depth f_inf - f_0 worn off the indenter"),
    "initial_displacement": _Law(("r",), "m", "normal displacement w_0 of the surface before any wear"),
    "steady_displacement": _Law(("r", "F_x"), "m", "normal displacement w_inf of the surface in the worn state"),
    "initial_pressure": _Law(("r",), "Pa", "contact pressure p_0 before any wear"),
    "steady_pressure": _Law(("r", "F_x"), "Pa", "contact pressure p_inf in the worn state", "the stick edge"),
    "steady_traction": _Law(("r", "F_x"), "Pa", "tangential traction tau_inf in the worn state", "the stick edge"),
}

_GROSS_SLIP = {
    "initial_force": _Law((), "N", "normal force before any wear"),
    "steady_force": _Law((), "N", "normal force on the worn punch at the same depth"),
    "force_ratio": _Law((), "1", "steady over initial normal force"),
    "volume_change": _Law((), "m^3", "effective volume worn off the punch"),
    "initial_displacement": _Law(("r",), "m", "normal displacement w_0 of the surface before any wear"),
    "steady_displacement": _Law(("r",), "m", "normal displacement w_inf of the surface, the shape of the worn punch"),
    "initial_pressure": _Law(("r",), "Pa", "contact pressure p_0 before any wear", "the edge of the punch"),
    "steady_pressure": _Law(("r",), "Pa", "uniform contact pressure in the worn state"),
}


@functools.partial(jax.jit, static_argnames=("names", "points", "digits"))
def _evaluate(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: float | None,
    *,
    names: tuple[str, ...],
    points: int,
    digits: int | None,
) -> tuple[Array | None, dict[str, Array]]:
    """The radii, if any quantity needs them, and the quantities named, each by one call."""
    laws = _FRETTING if isinstance(contact, FrettingContact) else _GROSS_SLIP
    given: dict[str, Any] = {"r": None, "F_x": tangential_force}
    if any("r" in laws[name].arguments for name in names):
        if isinstance(contact, FrettingContact):
            assert tangential_force is not None
            widest = 1.25 * contact.worn_radius(tangential_force, digits=digits)
        else:
            widest = 2.0 * jnp.asarray(contact.radius)
        given["r"] = widest * jnp.linspace(0.0, 1.0, points)
    values = {
        name: getattr(contact, name)(*(given[argument] for argument in laws[name].arguments), digits=digits)
        for name in names
    }
    return given["r"], values


# --- the sections of a file -----------------------------------------------------------------------------------------
# The description of a field is what a message says about an allowed value.


class _Section(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


def _wrong(key: str, allowed: str) -> PydanticCustomError:
    """An error in the key of a section, with a text of our own."""
    return PydanticCustomError("scene", "{allowed}", {"key": key, "allowed": allowed})


def _positive(meaning: str) -> Any:
    return Field(gt=0.0, allow_inf_nan=False, description=f"must be a finite number > 0, {meaning}")


_PositiveBound = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
_ExponentBound = Annotated[float, Field(gt=-1.0, lt=1.0, allow_inf_nan=False)]


class Material(_Section):
    """The section [material]: the half-space E(z) = E0 (z/z0)^k."""

    E0: float = _positive("the modulus at the depth z0 in Pa")
    z0: float = _positive("the characteristic depth in m")
    k: float = Field(gt=-1.0, lt=1.0, allow_inf_nan=False, description="must be a number with -1 < k < 1")
    nu: Annotated[float, Field(gt=-1.0, le=0.5, allow_inf_nan=False)] | Literal["holl"] = Field(
        description='must be a number with -1 < nu <= 0.5, or "holl"'
    )


class Fretting(_Section):
    """The section [contact] with kind = "fretting": a parabolic indenter under a constant force."""

    kind: Literal["fretting"]
    radius: float = _positive("the radius of curvature of the indenter in m")
    normal_force: float = _positive("the normal force in N")
    friction: float = _positive("the coefficient of friction")

    @model_validator(mode="after")
    def _finite_limit(self) -> Self:
        if math.isinf(self.friction * self.normal_force):
            raise _wrong("friction", "times normal_force exceeds the range of numbers")
        return self


class GrossSlip(_Section):
    """The section [contact] with kind = "gross-slip": a flat-ended punch at a constant depth."""

    kind: Literal["gross-slip"]
    radius: float = _positive("the radius of the punch in m")
    depth: float = _positive("the indentation depth in m")


class Load(_Section):
    """The section [load] of a fretting contact."""

    tangential_force: float = Field(
        ge=0.0, allow_inf_nan=False, description="must be a finite number >= 0, the amplitude of the force in N"
    )


class Vary(_Section):
    """The design space: lower and upper bound of each quantity that may be chosen."""

    k: Annotated[tuple[_ExponentBound, _ExponentBound], Field(strict=False)] | None = Field(
        None, description="must be [lower, upper] with -1 < lower < upper < 1"
    )
    z0: Annotated[tuple[_PositiveBound, _PositiveBound], Field(strict=False)] | None = Field(
        None, description="must be [lower, upper] with 0 < lower < upper, finite, in m"
    )

    @field_validator("k", "z0")
    @classmethod
    def _in_order(cls, bounds: tuple[float, float] | None) -> tuple[float, float] | None:
        if bounds is not None and not bounds[0] < bounds[1]:
            raise ValueError
        return bounds

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        if not self.bounds:
            raise ValueError
        return self

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """The bounds by name, without the quantities that stay as they are."""
        named = {"k": self.k, "z0": self.z0}
        return {name: bounds for name, bounds in named.items() if bounds is not None}


class Design(_Section):
    """The section [design]: what may vary, what is held, what is to be small."""

    vary: Vary = Field(description="must be a table of bounds such as { k = [-0.9, 0.9] }, with k, z0 or both")
    hold: Literal["contact_radius"] | None = Field(None, description='must be "contact_radius", or left out')
    minimise: Literal["wear_volume"] = Field(description='must be "wear_volume"')

    @model_validator(mode="after")
    def _one_scale(self) -> Self:
        if self.hold is not None and self.vary.z0 is not None:
            text = 'cannot vary while hold = "contact_radius" sets E0: only E0/z0^k counts for the contact'
            raise _wrong("vary.z0", text)
        return self


class Output(_Section):
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
                raise _wrong("quantities", f'"{name}" is asked for more than once')
        return quantities


class Scene(_Section):
    """A checked scene. Its sections are those of the file; see `load`.

    Attributes:
        material: The reference half-space.
        contact: The indenter and how it is pressed.
        load: The tangential force; None for gross slip.
        design: The design space; None if there is none.
        output: The quantities asked for; None for all single numbers.
    """

    material: Material
    contact: Annotated[Fretting | GrossSlip, Field(discriminator="kind")]
    load: Load | None = Field(None, validate_default=True)
    design: Design | None = None
    output: Output | None = None

    @field_validator("load")
    @classmethod
    def _partial_slip(cls, load: Load | None, info: ValidationInfo) -> Load | None:
        contact = info.data.get("contact")
        if isinstance(contact, GrossSlip) and load is not None:
            raise _wrong("", 'only a contact with kind = "fretting" has a tangential force')
        if isinstance(contact, Fretting):
            if load is None:
                raise _wrong("", "missing; a fretting contact needs its key tangential_force")
            limit = contact.friction * contact.normal_force
            if not load.tangential_force < limit:
                text = f"this is gross slip, F_x = {load.tangential_force:g} N is not below mu F_N = {limit:g} N"
                raise _wrong("tangential_force", f'{text}; use a scene with contact kind = "gross-slip"')
        return load

    @field_validator("design")
    @classmethod
    def _of_fretting(cls, design: Design | None, info: ValidationInfo) -> Design | None:
        if design is not None and isinstance(info.data.get("contact"), GrossSlip):
            raise _wrong("", 'only for a contact with kind = "fretting"')
        return design

    @field_validator("output")
    @classmethod
    def _known(cls, output: Output | None, info: ValidationInfo) -> Output | None:
        contact = info.data.get("contact")
        if output is not None and contact is not None:
            laws = _laws(contact)
            for name in output.quantities:
                if name not in laws:
                    text = f'"{one_line(name)}" is not a quantity of a {contact.kind} contact'
                    raise _wrong("quantities", f"{text}{_near_or_all(name, laws)}")
        return output

    def build_contact(self) -> FrettingContact | GrossSlipContact:
        """The contact of the scene, with the reference material."""
        material = PowerLawGraded(**dict(self.material))
        contact = self.contact
        if isinstance(contact, Fretting):
            return FrettingContact(material, contact.radius, contact.normal_force, contact.friction)
        return GrossSlipContact(material, contact.radius, contact.depth)

    def solve(self, *, digits: int | None = None) -> dict[str, Quantity]:
        """Compute the quantities that the scene asks for, and no others.

        Functions of the radius are given from 0 to 1.25 times the worn radius (fretting) or twice the radius of the
        punch (gross slip).

        Args:
            digits: Correct digits wanted; by default all that the dtype holds.

        Returns:
            The quantities by name, in the order of the scene.
        """
        laws = _laws(self.contact)
        names, points = tuple(name for name, law in laws.items() if "r" not in law.arguments), 0
        if self.output is not None:
            names, points = self.output.quantities, self.output.points
        force = None if self.load is None else self.load.tangential_force
        radii, values = _evaluate(self.build_contact(), force, names=names, points=points, digits=digits)
        radii = None if radii is None else np.asarray(radii)
        found = {}
        for name in names:
            law = laws[name]
            if "r" in law.arguments:
                unbounded_at = None if force == 0.0 else law.unbounded_at
                found[name] = Quantity(np.asarray(values[name]), law.unit, law.description, radii, unbounded_at)
            else:
                found[name] = Quantity(float(values[name]), law.unit, law.description)
        return found


def _laws(contact: Fretting | GrossSlip) -> dict[str, _Law]:
    return _FRETTING if isinstance(contact, Fretting) else _GROSS_SLIP


# --- reading --------------------------------------------------------------------------------------------------------


def load(path: str | os.PathLike[str]) -> Scene:
    """Read a scene file and check it.

    Args:
        path: A TOML file with the sections [material], [contact], for fretting [load], and if wanted [design] and
            [output].

    Returns:
        The scene; nothing is computed yet.

    Raises:
        SceneError: The file cannot be read or something in it is wrong: the first such thing, in one line.
    """
    name = one_line(os.fspath(path))
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise SceneError(f"{name}: there is no such file") from None
    except IsADirectoryError:
        raise SceneError(f"{name}: is a folder; a scene is a TOML file") from None
    except UnicodeDecodeError as error:
        raise SceneError(f"{name}: is not a text file in UTF-8 (byte {error.start})") from None
    except (OSError, ValueError) as error:
        raise SceneError(f"{name}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{name}: is not valid TOML: {one_line(str(error))}") from None
    except (ValueError, RecursionError):
        raise SceneError(f"{name}: is not valid TOML: a number too long or brackets too deep") from None
    try:
        return Scene.model_validate(document)
    except ValidationError as error:
        complaints = [_complaint(detail, document) for detail in error.errors(include_url=False)]
    _, line = min(complaints, key=lambda complaint: complaint[0])
    raise SceneError(f"{name}: {line}")


def _complaint(detail: ErrorDetails, document: dict[str, Any]) -> tuple[tuple[float, ...], str]:
    """The place of an error in the file, for sorting, and what is to be said about it."""
    kind, context = detail["type"], detail.get("ctx", {})
    section, *keys = (part for part in detail["loc"] if isinstance(part, str))
    if section not in Scene.model_fields:
        return _stray(section, document)
    model = _KINDS[keys.pop(0)] if section == "contact" and keys else _SECTIONS[section]
    if kind == "scene":
        keys = [key for key in context["key"].split(".") if key]
    elif kind.startswith("union_tag"):
        keys = ["kind"]
    keys = keys[:2] if keys[:1] == ["vary"] else keys[:1]
    place, value = _find(document, section, *keys)
    if not keys:
        return place, _about_section(section, value, context.get("allowed"))

    key = f"[{section}] {'.'.join(_bare(key) for key in keys)}"
    given = f"{key} = {_shown(value)}"
    if keys == ["kind"]:
        allowed = f"must be {' or '.join(json.dumps(name) for name in _KINDS)}{_near(value, _KINDS)}"
    elif kind == "scene":
        allowed = context["allowed"]
    else:
        fields = Vary.model_fields if len(keys) == 2 else model.model_fields
        if kind == "extra_forbidden":
            return place, f"{given}: there is no such key{_near_or_all(keys[-1], fields)}"
        allowed = fields[keys[-1]].description
    return place, f"{key}: missing; it {allowed}" if value is _ABSENT else f"{given}: {allowed}"


_ABSENT = object()
_SECTIONS: dict[str, Any] = {
    "material": Material,
    "contact": None,  # the model depends on the kind
    "load": Load,
    "design": Design,
    "output": Output,
}
_KINDS: dict[str, Any] = {"fretting": Fretting, "gross-slip": GrossSlip}


def _stray(key: str, document: dict[str, Any]) -> tuple[tuple[float, ...], str]:
    place, value = _find(document, key)
    if isinstance(value, dict):
        return place, f"[{_bare(key)}]: there is no such section{_near_or_all(key, _SECTIONS)}"
    return place, f"{_bare(key)} = {_shown(value)}: stands outside the sections; allowed are {', '.join(_SECTIONS)}"


def _about_section(section: str, value: Any, said: str | None) -> str:
    if said is not None:
        return f"[{section}]: {said}"
    if value is _ABSENT:
        return f"[{section}]: missing; every scene needs this section"
    return f"{section} = {_shown(value)}: must be a section, written as [{section}]"


def _find(document: dict[str, Any], *keys: str) -> tuple[tuple[float, ...], Any]:
    """Where in the file a key stands, section by section, and its value; what is absent comes after the rest."""
    place: list[float] = []
    node: Any = document
    for key in keys:
        present = isinstance(node, dict) and key in node
        place.append(list(node).index(key) if present else math.inf)
        node = node[key] if present else _ABSENT
    return tuple(place), node


# --- words ----------------------------------------------------------------------------------------------------------

_LONGEST = 60


def _near(wrong: Any, right: Iterable[str]) -> str:
    match = difflib.get_close_matches(wrong, right, n=1) if isinstance(wrong, str) else []
    return f"; did you mean {match[0]}?" if match else ""


def _near_or_all(wrong: str, right: Iterable[str]) -> str:
    names = list(right)
    return _near(wrong, names) or f"; allowed are {', '.join(names)}"


def one_line(text: str) -> str:
    """The same text on one line: what would not print is escaped."""
    return "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in text)


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def _bare(key: str) -> str:
    """A key as TOML writes it, and not too long."""
    plain = key.isascii() and key.replace("-", "").replace("_", "").isalnum()
    return _cut(key if plain else _shown(key))


def _shown(value: Any) -> str:
    """A value as TOML writes it, on one line and not too long."""
    return _cut(one_line(_toml(value, depth=0)))


def _toml(value: Any, depth: int) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, int):
        return str(value) if value.bit_length() < 200 else hex(value)
    if isinstance(value, (list, dict)) and depth > 3:
        return "..."
    if isinstance(value, list):
        return f"[{', '.join(_toml(item, depth + 1) for item in value)}]"
    if isinstance(value, dict):
        items = (f"{_bare(key)} = {_toml(item, depth + 1)}" for key, item in value.items())
        return f"{{ {', '.join(items)} }}" if value else "{}"
    return value.isoformat() if isinstance(value, (datetime.date, datetime.time)) else str(value)
