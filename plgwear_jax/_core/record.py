"""Frozen dataclasses that are pytrees, such as contacts and materials."""

import dataclasses
from types import UnionType
from typing import Any, TypeVar, Union, dataclass_transform, get_args, get_origin

import jax
import numpy as np
from jax import Array

from plgwear_jax._core.domains import as_array, check, nan_outside

T = TypeVar("T")

_STATIC, _WORD = "static", "word"


def static(**options: Any) -> Any:
    """A field that is part of the structure of a record, such as a choice between words: hashable, and not a number."""
    return dataclasses.field(metadata={_STATIC: True}, **options)


def number_or(word: str, **options: Any) -> Any:
    """A field of numbers that may hold this word instead, which is then part of the structure."""
    return dataclasses.field(metadata={_WORD: word}, **options)


def _takes_numbers(kind: Any) -> bool:
    options = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    return any(option in (Any, float, "float") for option in options)


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, static, number_or))
def record(cls: type[T]) -> type[T]:
    """A frozen dataclass that is a pytree of its fields, except for those declared by `static` or `number_or`.

    `__post_init__` makes arrays of lists and tuples in fields of numbers and checks the fields that have a `Domain` in
    the class variable `ranges`, if there is one. JAX rebuilds records without calling it, with traced values.
    """
    checked, ranges = getattr(cls, "__post_init__", None), getattr(cls, "ranges", {})

    def post_init(self: Any) -> None:
        for name in numbers:
            object.__setattr__(self, name, as_array(getattr(self, name)))
        for field in fields:
            value = getattr(self, field.name)
            if field.name in ranges and not (value is None is field.default):
                check(field.name, value, ranges[field.name])
        if checked is not None:
            checked(self)

    cls.__post_init__ = post_init  # pyright: ignore[reportAttributeAccessIssue]
    cls = dataclasses.dataclass(frozen=True)(cls)
    fields = dataclasses.fields(cls)  # pyright: ignore[reportArgumentType]
    about = {field.name: field.metadata for field in fields}
    numbers = [field.name for field in fields if _STATIC not in field.metadata and _takes_numbers(field.type)]

    def flatten(instance: T) -> tuple[list[tuple[Any, Any]], tuple[tuple[str, Any], ...]]:
        children, structure = [], []
        for name, known in about.items():
            value = getattr(instance, name)
            if _STATIC in known or (isinstance(value, str) and value == known.get(_WORD)):
                structure.append((name, value))
            else:
                children.append((jax.tree_util.GetAttrKey(name), value))
        return children, tuple(structure)

    def unflatten(structure: tuple[tuple[str, Any], ...], children: Any) -> T:
        instance = object.__new__(cls)
        words, numbers = dict(structure), iter(children)
        for name in about:
            object.__setattr__(instance, name, words[name] if name in words else next(numbers))
        return instance

    jax.tree_util.register_pytree_with_keys(cls, flatten, unflatten)
    return cls


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, static, number_or))
class RecordFamily:
    """A class of which all subclasses are records, without a decorator."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        record(cls)


def check_columns(of: Any) -> None:
    """Refuse a record whose two `tables` have not as many points, at least two."""
    one, other = (np.shape(getattr(of, name)) for name in of.tables)
    if not (one and other and one[-1] == other[-1] and one[-1] > 1):
        raise ValueError(f"{' and '.join(of.tables)} take two points or more, not shapes {one} and {other}")


def field_nan_outside(of: Any, name: str) -> Array:
    """A field of a record as an array, NaN where it is traced and outside its range."""
    return nan_outside(name, getattr(of, name), of.ranges[name])
