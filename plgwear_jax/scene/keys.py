"""The keys of an input file: `keys.toml` has them all; the reader, the JSON schema and the documentation read it.

Imports nothing that takes time.
"""

import itertools
import json
import math
import operator
import re
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from plgwear_jax._core.words import near_or_all
from plgwear_jax.catalogue import QUANTITIES, entry
from plgwear_jax.rules import limit_form

ELEMENTS = "material.thickness[0]", "material.modulus[0]"  # how they are written
MATERIALS = {"Material": "power law", "Tabulated": "table", "Layers": "layers"}  # what messages call them
REQUIRED = object()
_DOCUMENT = tomllib.loads(Path(__file__).with_name("keys.toml").read_text(encoding="utf-8"))
_FORMS: dict[str, dict[str, Any]] = _DOCUMENT["forms"]
_ELEMENT = re.compile(r"^material\.(thickness|depth|modulus)\[\d+\]$")
_LIMITED = dict.fromkeys(("edge_pressure", "contact_radius", "penetration", "pressure"))
_LIMITED |= dict.fromkeys(name for laws in QUANTITIES.values() for name in laws)


class Key(NamedTuple):
    """A key of an input file.

    Attributes:
        schema: The JSON schema of its value.
        text: What it must be, for messages.
        about: What it is.
        default: Its value where it is left out; `REQUIRED` if it must be there.
    """

    schema: dict[str, Any]
    text: str
    about: str
    default: Any


class SectionKeys(NamedTuple):
    """The keys of a section by name, what they describe, and the record of the library with these fields."""

    keys: dict[str, Key]
    about: str
    record: str


def _schema(takes: str) -> dict[str, Any]:
    """The schema of what a key takes: words in quotation marks, forms, sections, or one of several."""
    first, *others = takes.split(" or ")
    if others:
        return {"anyOf": list(map(_schema, (first, *others)))}
    if first.startswith('"'):
        return {"enum": [json.loads(first)]}
    return {name: x for name, x in _FORMS[first].items() if name != "must"} if first in _FORMS else _reference(first)


def _reference(section: str) -> dict[str, str]:
    return {"$ref": f"#/$defs/{section}"}


def _sections() -> dict[str, SectionKeys]:
    found = {}
    for name, section in _DOCUMENT.items():
        keys = {}
        for key, told in section.get("keys", {}).items():
            takes, default = told["takes"], told.get("default", REQUIRED)
            text = told.get("must") or _FORMS.get(takes, {}).get("must", takes)
            keys[key] = Key(
                _schema(takes),
                f"must be {text}{told.get('said', '')}",
                told["about"],
                None if default == "" else default,
            )
        if keys:
            found[name] = SectionKeys(keys, section["about"], section.get("record", ""))
    for name in _LIMITED:
        limit = Key(_reference("Allowed"), f"must be {limit_form(name)}", entry(name).name, None)
        found["Limits"].keys[name] = limit
    return found


SECTIONS = _sections()


# --- reading --------------------------------------------------------------------------------------------------------

Refuse = Callable[[tuple[str, ...], str], None]  # what is done with the path of a wrong key, and what it must be


def values_of(section: str, given: Mapping[str, Any], refuse: Refuse, path: tuple[str, ...] = ()) -> dict[str, Any]:
    """The values of those keys of a section that are there or have a default, as the library takes them.

    Args:
        section: Its name in `SECTIONS`.
        given: What the file has there.
        refuse: Takes the path of a wrong key, and what it must be.
        path: The path of the section.
    """
    keys, found = SECTIONS[section].keys, dict[str, Any]()
    if section == "Vary":
        elements = {name: _ELEMENT.fullmatch(name) for name in given}
        keys = keys | {name: SECTIONS["Elements"].keys[one[1]] for name, one in elements.items() if one}
    for name in given:
        if name not in keys:
            refuse((*path, name), _stray(section, name))
    for name, key in keys.items():
        here, value, inner = (*path, name), given.get(name), _section_of(key.schema)
        if name not in given:
            if key.default is REQUIRED:
                refuse(here, key.text)
            elif key.default is not None:
                found[name] = key.default
        elif inner and isinstance(value, dict) and (value or inner == "Window"):
            found[name] = values_of(inner, value, refuse, here)
        else:
            try:
                found[name] = _taken(value, key.schema)
            except (ValueError, OverflowError):
                refuse(here, key.text)
    return found


def _section_of(schema: Mapping[str, Any]) -> str:
    return schema.get("$ref", "").rpartition("/")[2]


def _taken(value: Any, schema: Mapping[str, Any]) -> Any:
    """A value as the library takes it; a ValueError if its schema does not allow it."""
    for one in schema.get("anyOf", ()):
        try:
            inner = _section_of(one)
            return (inner, values_of(inner, value, _raise)) if inner and value else _taken(value, one)
        except (AttributeError, TypeError, ValueError, OverflowError):
            pass
    kind, size = schema.get("type"), value
    if kind is None and isinstance(value, str) and value in schema.get("enum", ()):
        return value
    if kind == "object" and isinstance(value, dict):
        return {name: _taken(one, schema["additionalProperties"]) for name, one in value.items()}
    if kind == "array" and isinstance(value, list | tuple):
        value = tuple(_taken(one, schema["items"]) for one in value)
        rises = all(low < high for low, high in itertools.pairwise(value))
        size = len(value) if rises or "increasing" not in schema else math.nan
    elif kind == "string" and isinstance(value, str):
        size = len(value)
    elif kind == "number" and isinstance(value, int | float) and not isinstance(value, bool):
        value = size = float(value)
    elif kind != "integer" or type(value) is not int:
        raise ValueError
    if not (abs(size) < math.inf and all(_LIMITS[one](size, schema[one]) for one in _LIMITS.keys() & schema.keys())):
        raise ValueError
    return value


_LIMITS = {
    **dict.fromkeys(("minimum", "minItems", "minLength"), operator.ge),
    **dict.fromkeys(("maximum", "maxItems"), operator.le),
    **{"exclusiveMinimum": operator.gt, "exclusiveMaximum": operator.lt},
}


def _raise(*_: Any) -> None:
    raise ValueError


def _stray(section: str, name: str) -> str:
    """What is wrong with a key that a section does not have."""
    if section in MATERIALS and any(name in SECTIONS[other].keys for other in MATERIALS):
        return f"cannot be combined with {MATERIALS[section]}; the modulus is a power law, a table or layers"
    known = [*SECTIONS[section].keys, *(map(json.dumps, ELEMENTS) if section == "Vary" else ())]
    return f"there is no such key{near_or_all(name, known)}"


def json_schema() -> dict[str, Any]:
    """The JSON schema of an input file, with which editors check and complete it; `load` checks more."""
    models: dict[str, Any] = {
        name: {
            "type": "object",
            "description": section.about,
            "properties": {
                key: {"title": one.about, "description": one.text.removeprefix("must be "), **one.schema}
                for key, one in section.keys.items()
            },
            "required": [key for key, one in section.keys.items() if one.default is REQUIRED],
            "additionalProperties": False,
        }
        for name, section in SECTIONS.items()
    }
    elements = models.pop("Elements")["properties"]
    models["Vary"]["patternProperties"] = {_ELEMENT.pattern: elements["modulus"]}
    minimise = models["Design"]["properties"]["minimise"]
    minimise["anyOf"] = [{"enum": [*_LIMITED]}, *minimise["anyOf"][1:]]
    return _DOCUMENT["schema"] | {"$defs": models}
