"""Frozen records that are pytrees: how the library holds things with units."""

import dataclasses
from typing import Any, TypeVar, dataclass_transform

import jax

__all__ = ["record"]

T = TypeVar("T")


@dataclass_transform(frozen_default=True)
def record(cls: type[T]) -> type[T]:
    """A frozen dataclass that is a pytree of its fields; a field that holds a string is part of the structure.

    `__post_init__` checks what a caller passes in. JAX rebuilds records without calling it, with traced values.
    """
    cls = dataclasses.dataclass(frozen=True)(cls)
    names = tuple(field.name for field in dataclasses.fields(cls))  # pyright: ignore[reportArgumentType]

    def flatten(instance: T) -> tuple[list[tuple[Any, Any]], tuple[str | None, ...]]:
        values = [getattr(instance, name) for name in names]
        static = tuple(value if isinstance(value, str) else None for value in values)
        children = [
            (jax.tree_util.GetAttrKey(name), value)
            for name, value in zip(names, values, strict=True)
            if not isinstance(value, str)
        ]
        return children, static

    def unflatten(static: tuple[str | None, ...], children: Any) -> T:
        instance = object.__new__(cls)
        remaining = iter(children)
        for name, value in zip(names, static, strict=True):
            object.__setattr__(instance, name, next(remaining) if value is None else value)
        return instance

    jax.tree_util.register_pytree_with_keys(cls, flatten, unflatten)
    return cls
