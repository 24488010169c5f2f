"""The leaves of a record by their paths: `material.k`, `indenter.E`, `material.modulus[2]`."""

import dataclasses
import re
from collections.abc import Callable
from typing import Any, cast

import jax
import jax.numpy as jnp
import numpy as np


def paths_of(tree: Any, is_leaf: Callable[[Any], bool] | None = None) -> dict[str, Any]:
    """The leaves of a pytree by path, in order."""
    leaves = jax.tree_util.tree_flatten_with_path(tree, is_leaf)[0]
    return {jax.tree_util.keystr(path).removeprefix("."): leaf for path, leaf in leaves}


def leaf_of(tree: Any, path: str) -> Any:
    """The leaf at a path, or the element of an array; as in `with_leaf`."""
    for key in _keys(path):
        tree = _stepped_into(tree, key)
    return tree


def with_leaf(tree: Any, path: Any, value: Any) -> Any:
    """The record with another value at a path, which may be traced. Records check concrete values as ever.

    Args:
        tree: A record, whose fields may be records, lists, tuples, dictionaries and arrays.
        path: Names of fields set off by points, and places in brackets, for arrays along the last axis; or a path of
            `jax.tree_util`.
        value: What is there instead. For an element of an array it may be an array itself, which broadcasts against
            all axes of the former but the last.

    Raises:
        AttributeError, LookupError: There is nothing at the path.
        ValueError: A record refuses the value.
    """
    return _with(tree, _keys(path if isinstance(path, str) else jax.tree_util.keystr(tuple(path))), value)


def _keys(path: str) -> list[str | int]:
    found = re.findall(r"\[(\d+)\]|\['(.*?)'\]|(\w+)", path)
    return [int(place) if place else key or name for place, key, name in found]


def _stepped_into(tree: Any, key: Any) -> Any:
    if isinstance(tree, list | tuple | dict):
        return tree[key]
    if isinstance(key, str):
        return getattr(tree, key)
    if not (np.ndim(tree) and key < np.shape(tree)[-1]):
        raise IndexError(f"there is no place {key}")
    return jnp.asarray(tree)[..., key]


def _with(tree: Any, keys: list[str | int], value: Any) -> Any:
    if not keys:
        return value
    key = keys[0]
    value = _with(_stepped_into(tree, key), keys[1:], value)
    if dataclasses.is_dataclass(tree):
        return dataclasses.replace(cast(Any, tree), **{str(key): value})
    if isinstance(tree, dict):
        return {**tree, key: value}
    if isinstance(tree, list | tuple):
        return type(tree)(value if place == key else other for place, other in enumerate(tree))
    whole = jnp.asarray(tree)
    shape = jnp.broadcast_shapes(whole.shape[:-1], np.shape(value))
    return jnp.broadcast_to(whole, (*shape, whole.shape[-1])).at[..., key].set(value)
