"""The keys of an input file: `keys.toml` has them all, as a JSON schema, which the reader and the documentation read.

Each error is told in one line: section, key, value, and what is allowed; the first one ends the reading. Imports
nothing that takes time.
"""

import contextlib
import copy
import functools
import itertools
import json
import re
import sys
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn

from plgwear_jax._core.catalogue import QUANTITIES, entry
from plgwear_jax._core.extras import needs
from plgwear_jax._core.rules import LASTING, WrongKeyError, limit_form
from plgwear_jax._core.words import GivenError, bare, near, near_or_all, shown

ELEMENTS = "material.thickness[0]", "material.modulus[0]"  # how they are written
MATERIALS = {"Material": "a power law", "Tabulated": "a table", "Layers": "layers"}  # what messages call them
KeyValues = dict[str, Any]  # what a section holds, by key
_SCHEMA = tomllib.loads(Path(__file__).with_name("keys.toml").read_text(encoding="utf-8"))
SECTIONS: KeyValues = _SCHEMA["$defs"]  # and the forms of values, in lower case
_LIMITED = dict.fromkeys(("edge_pressure", "contact_radius", "penetration", "pressure"))
_LIMITED |= dict.fromkeys(name for laws in QUANTITIES.values() for name in laws)
SECTIONS["Limits"]["properties"] |= {
    name: {"title": entry(name).name, "description": limit_form(name), "$ref": "#/$defs/allowed"}
    for name in (*_LIMITED, *LASTING)
}


# --- reading --------------------------------------------------------------------------------------------------------

_ABSENT = object()
NAMES = "material", "contact", "load", "wear", "design", "output"


class SceneError(GivenError):
    """An error in a scene, in one line: file, section, key, value, and what is allowed."""

    names_file = False


class ArgumentError(SceneError):
    """An error in an argument of `Scene.front`, with which its line begins."""

    names_argument = True


class OtherFileError(SceneError):
    """An error in the file of a scene, or in another one that it names; its line begins with that file."""

    names_file = True


class Reading(SimpleNamespace):
    """An input file while it is read: its sections as far as they are known.

    Attributes:
        file: The name of the file, for messages.
        document: What it holds.
        folder: Where names of other files begin.
        material, contact, wear, load, design, output: What the sections hold; None where they are absent.
    """

    def refuse(self, path: Iterable[str], text: str) -> NoReturn:
        """Refuse the key of this path, or a section: what it must be."""
        value: Any = self.document
        for key in path:
            value = {str(i): one for i, one in enumerate(value)} if isinstance(value, list) else value
            value = value.get(key, _ABSENT) if isinstance(value, dict) else _ABSENT
        section, *keys = map(bare, path)
        told = f"[{section}] {'.'.join(keys)}".rstrip()
        if value is _ABSENT:
            text = f"missing; it {text}" if keys else text
        elif keys:
            told = f"{told} = {shown(value)}"
        elif not isinstance(value, dict):
            told = f"{section} = {shown(value)}"
        raise OtherFileError(f"{self.file}: {told}: {text}")

    def values_of(self, section: str) -> tuple[str, KeyValues]:
        """What a section that is there means, as its name in `SECTIONS`, and the values of all its keys."""
        given = self.document[section]
        if section not in NAMES:
            wrong = f"there is no such section{near_or_all(section, NAMES)}"
            stray = f"stands outside the sections; allowed are {', '.join(NAMES)}"
            self.refuse((section,), wrong if isinstance(given, dict) else stray)
        with self.telling(section):
            if not isinstance(given, dict):
                raise WrongKeyError("", f"must be a section, written as [{section}]")
            schema, kind = _SCHEMA["properties"][section], given.get("kind")
            if section == "contact" and not (isinstance(kind, str) and kind in QUANTITIES):
                raise WrongKeyError("kind", f'must be "fretting" or "gross-slip"{near(kind, QUANTITIES)}')
        while "if" in schema:  # what the section means, by its keys
            schema = schema["then" if _allows(schema["if"], given) else "else"]
        name = _section_of(schema)
        return name, dict.fromkeys(SECTIONS[name]["properties"]) | self._values(name, given, section)

    def _values(self, section: str, given: Any, *path: str) -> KeyValues:
        """The values of those keys of a section that are there or have a default, as the library takes them.

        Args:
            section: Its name in `SECTIONS`.
            given: What the file has there.
            path: The path of the section.
        """
        schema, found = SECTIONS[section], {}
        keys = schema["properties"] | {
            name: key
            for pattern, key in schema.get("patternProperties", {}).items()
            for name in given
            if re.search(pattern, name)
        }
        for name in {**given, **keys}:  # as the file has them; what is missing comes last
            here, value = (*path, name), given.get(name)
            key = keys[name] if name in keys else self.refuse(here, _stray(section, name))
            inner, text = _section_of(key), f"must be {key['description']}"
            if name not in given:
                if name in schema["required"]:
                    self.refuse(here, text)
                elif "default" in key:
                    found[name] = key["default"]
            elif inner == "Allowed" and isinstance(value, list) and value and all(isinstance(x, dict) for x in value):
                found[name] = tuple(self._values(inner, x, *here, str(i)) for i, x in enumerate(value))
            elif inner and isinstance(value, dict) and (value or inner in ("Window", "TwoDepths", "Limits")):
                found[name] = self._values(inner, value, *here)
            elif inner or not _allows(key, value):
                self.refuse(here, text)
            else:
                kinds = [one for one in map(_section_of, key.get("anyOf", ())) if one and _allows(SECTIONS[one], value)]
                if kinds:  # of a section among others also its name
                    found[name] = kinds[0], self._values(kinds[0], value, *here)
                else:
                    found[name] = _with_floats(value)
        return {name: found[name] for name in keys if name in found}

    @contextlib.contextmanager
    def telling(self, section: str) -> Iterator[None]:
        """Tell what is raised within this context because of a section, or of a file that it names."""
        try:
            yield
        except WrongKeyError as error:
            self.refuse((section, *re.findall(r"material\.\w+\[\d+\]|transient\.\w+|[^.]+", error.key)), error.text)
        except GivenError as error:
            raise OtherFileError(str(error)) from None


def _section_of(schema: KeyValues) -> str:
    """The section that a schema refers to, or of which it takes one or several; empty for other values."""
    name = schema.get("$ref", "").rpartition("/")[2].replace("allowed", "Allowed")
    return name if name[:1].isupper() else ""


def _with_floats(value: Any) -> Any:
    """A value with tuples for lists, and real numbers for whole ones."""
    if isinstance(value, dict):
        return {name: _with_floats(one) for name, one in value.items()}
    if isinstance(value, list):
        return tuple(map(_with_floats, value))
    return float(value) if isinstance(value, int) else value


def _allows(schema: KeyValues, value: Any) -> bool:
    """Whether a value is as its schema says."""
    return _validator()({"$defs": SECTIONS, **schema}).is_valid(value)


@functools.cache
def _validator() -> Any:
    """The validator of JSON schema, with finite numbers, and "increasing" for lists."""
    with needs("input files", "cli"):
        from jsonschema import Draft202012Validator, ValidationError, validators

    def increasing(_: Any, __: Any, numbers: Any, ___: Any) -> Iterator[ValidationError]:
        # The type of the list and of its items stand before in a schema, and the first error ends it.
        if any(low >= high for low, high in itertools.pairwise(numbers)):
            yield ValidationError("not increasing")

    types = Draft202012Validator.TYPE_CHECKER.redefine_many(
        {
            "number": lambda _, value: (
                isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max
            ),
            "integer": lambda _, value: type(value) is int,
        }
    )
    return validators.extend(Draft202012Validator, {"increasing": increasing}, type_checker=types)


def _stray(section: str, name: str) -> str:
    """What is wrong with a key that a section does not have."""
    if section in MATERIALS and any(name in SECTIONS[other]["properties"] for other in MATERIALS):
        return f"cannot be combined with {MATERIALS[section]}; the modulus is a power law, a table or layers"
    known = [*SECTIONS[section]["properties"], *(map(json.dumps, ELEMENTS) if section == "Vary" else ())]
    for one in known:  # TOML reads a point as that of a table
        if one.startswith(f"{name}."):
            return f'a name with a point needs quotation marks, such as "{one}"'
    return f"there is no such key{near_or_all(name, known)}"


def json_schema() -> KeyValues:
    """The JSON schema of an input file, with which editors check and complete it; `load` checks more."""
    schema = copy.deepcopy(_SCHEMA)
    schema["$defs"]["Design"]["properties"]["minimise"]["anyOf"][0] = {"enum": [*_LIMITED]}
    return schema
