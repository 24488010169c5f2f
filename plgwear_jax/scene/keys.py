"""The keys of an input file: `keys.toml` has them all; the reader, the JSON schema and the documentation read it.

Imports nothing that takes time.
"""

import functools
import itertools
import json
import re
import sys
import tomllib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from plgwear_jax._core.extras import needs
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
    form = _FORMS.get(first, {"$ref": f"#/$defs/{first}"})
    return {name: x for name, x in form.items() if name != "must"}


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
        limit = Key(_schema("Allowed"), f"must be {limit_form(name)}", entry(name).name, None)
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
        elif inner == "Allowed" and isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
            found[name] = tuple(values_of(inner, one, refuse, (*here, str(i))) for i, one in enumerate(value))
        elif inner and isinstance(value, dict) and (value or inner in ("Window", "Limits")):
            found[name] = values_of(inner, value, refuse, here)
        elif inner or not _allows(key.schema, value):
            refuse(here, key.text)
        else:
            found[name] = _taken(value, key.schema, refuse, here)
    return found


def _section_of(schema: Mapping[str, Any]) -> str:
    return schema.get("$ref", "").rpartition("/")[2]


def _taken(value: Any, schema: Mapping[str, Any], *where: Any) -> Any:
    """An allowed value as the library takes it: tuples for lists, and of a section among others also its name."""
    for one in schema.get("anyOf", ()):
        if _allows(one, value):
            inner = _section_of(one)
            return (inner, values_of(inner, value, *where)) if inner else _taken(value, one)
    if isinstance(value, dict):
        return {name: _taken(one, schema["additionalProperties"]) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return tuple(_taken(one, schema["items"]) for one in value)
    return float(value) if schema.get("type") == "number" else value


def _allows(schema: Mapping[str, Any], value: Any) -> bool:
    """Whether a value is as its schema says."""
    return _validator()({"$defs": _definitions(), **schema}).is_valid(value)


@functools.cache
def _validator() -> Any:
    """The validator of JSON schema, with finite numbers, and "increasing" for lists."""
    with needs("input files", "cli"):
        from jsonschema import Draft202012Validator, ValidationError, validators

    def increasing(validator: Any, _: Any, value: Any, __: Any) -> Iterator[ValidationError]:
        numbers = validator.is_type(value, "array") and all(validator.is_type(one, "number") for one in value)
        if numbers and any(low >= high for low, high in itertools.pairwise(value)):
            yield ValidationError("not increasing")

    def is_number(_: Any, value: Any) -> bool:
        return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max

    types = Draft202012Validator.TYPE_CHECKER.redefine_many(
        {
            "number": is_number,
            "integer": lambda _, value: type(value) is int,
            "array": lambda _, value: isinstance(value, list | tuple),
        }
    )
    return validators.extend(Draft202012Validator, {"increasing": increasing}, type_checker=types)


def _stray(section: str, name: str) -> str:
    """What is wrong with a key that a section does not have."""
    if section in MATERIALS and any(name in SECTIONS[other].keys for other in MATERIALS):
        return f"cannot be combined with {MATERIALS[section]}; the modulus is a power law, a table or layers"
    known = [*SECTIONS[section].keys, *(map(json.dumps, ELEMENTS) if section == "Vary" else ())]
    return f"there is no such key{near_or_all(name, known)}"


@functools.cache
def _definitions() -> dict[str, Any]:
    """The JSON schemas of all sections, by name."""
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
    for name in _LIMITED:
        one = models["Limits"]["properties"][name]
        one["anyOf"] = [{"$ref": one["$ref"]}, {"type": "array", "items": {"$ref": one.pop("$ref")}, "minItems": 1}]
    minimise = models["Design"]["properties"]["minimise"]
    minimise["anyOf"] = [{"enum": [*_LIMITED]}, *minimise["anyOf"][1:]]
    return models


def json_schema() -> dict[str, Any]:
    """The JSON schema of an input file, with which editors check and complete it; `load` checks more."""
    return _DOCUMENT["schema"] | {"$defs": _definitions()}
