"""Errors in a scene file, each in one line: section, key, value, and what is allowed."""

import json
import math
import re
from typing import Any

from pydantic_core import ErrorDetails

from plgwear_jax._core.words import bare, near, near_or_all, shown
from plgwear_jax.scene.design_section import ELEMENTS, Design, Vary
from plgwear_jax.scene.fields import bounds_form
from plgwear_jax.scene.material_section import MATERIALS
from plgwear_jax.scene.sections import INNER, Fretting, GrossSlip, Load, Output, Wear


def complaint(name: str, detail: ErrorDetails, document: dict[str, Any]) -> tuple[tuple[float, ...], str]:
    """The place of an error in the file `name`, for sorting, and the line that reports it."""
    if detail["type"] == "table":  # the error is in another file
        return _find(document, str(detail["loc"][0]))[0], detail["ctx"]["line"]  # pyright: ignore[reportTypedDictNotRequiredAccess]
    place, line = _about(detail, document)
    return place, f"{name}: {line}"


def _about(detail: ErrorDetails, document: dict[str, Any]) -> tuple[tuple[float, ...], str]:
    """The place of an error, and the text that reports it."""
    kind, context = detail["type"], detail.get("ctx", {})
    section, *parts = (part for part in detail["loc"] if isinstance(part, str))
    if section not in _SECTIONS:
        return _stray(section, document)
    members = _SECTIONS[section] if isinstance(_SECTIONS[section], dict) else {}
    model = members[parts.pop(0)] if members and parts else _SECTIONS[section]
    if "key" in context:
        key = context["key"]
        parts += re.findall(r"material\.\w+\[\d+\]|[^.]+", key) if isinstance(key, str) else key
    elif kind.startswith("union_tag"):
        parts = ["kind"]
    keys = parts[:1]  # what follows a key is the member of a union, unless the key holds a section itself
    for part in parts[1:]:
        if section != "design" or keys[-1] not in INNER:
            break
        model = INNER[keys[-1]]
        keys.append(part)
    place, value = _find(document, section, *keys)
    if not keys:
        return place, _about_section(section, value, context.get("allowed"))

    key = f"[{section}] {'.'.join(bare(key) for key in keys)}"
    given = f"{key} = {shown(value)}"
    if kind == "scene":
        allowed = context["allowed"]
    elif keys == ["kind"]:
        allowed = f"must be {' or '.join(json.dumps(name) for name in _KINDS)}{near(value, _KINDS)}"
    elif kind == "extra_forbidden" and keys[-1] not in model.model_fields:
        if section == "material" and any(keys[-1] in other.model_fields for other in MATERIALS.values()):
            beside = next(name for name in MATERIALS if MATERIALS[name] is model)
            return place, f"{given}: cannot be combined with {beside}; the modulus is a power law, a table or layers"
        known = [*model.model_fields, *(map(json.dumps, ELEMENTS) if model is Vary else ())]
        return place, f"{given}: there is no such key{near_or_all(keys[-1], known)}"
    else:
        field = model.model_fields.get(keys[-1])
        allowed = bounds_form(keys[-1]) if field is None else field.description
    return place, f"{key}: missing; it {allowed}" if value is _ABSENT else f"{given}: {allowed}"


_ABSENT = object()
_KINDS: dict[str, Any] = {"fretting": Fretting, "gross-slip": GrossSlip}
_SECTIONS: dict[str, Any] = {  # of some there are several kinds, by what stands there
    "material": MATERIALS,
    "contact": _KINDS,
    "load": Load,
    "wear": Wear,
    "design": Design,
    "output": Output,
}


def _stray(key: str, document: dict[str, Any]) -> tuple[tuple[float, ...], str]:
    place, value = _find(document, key)
    if isinstance(value, dict):
        return place, f"[{bare(key)}]: there is no such section{near_or_all(key, _SECTIONS)}"
    return place, f"{bare(key)} = {shown(value)}: stands outside the sections; allowed are {', '.join(_SECTIONS)}"


def _about_section(section: str, value: Any, said: str | None) -> str:
    if said is not None:
        return f"[{section}]: {said}"
    if value is _ABSENT:
        return f"[{section}]: missing; every input file needs this section"
    return f"{section} = {shown(value)}: must be a section, written as [{section}]"


def _find(document: dict[str, Any], *keys: str) -> tuple[tuple[float, ...], Any]:
    """The place of a key in the file, section by section, and its value; an absent key comes last."""
    place: list[float] = []
    node: Any = document
    for key in keys:
        present = isinstance(node, dict) and key in node
        place.append(list(node).index(key) if present else math.inf)
        node = node[key] if present else _ABSENT
    return tuple(place), node
