"""Functions of one contact, for arrays of contacts and arguments."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import real_dtype
from plgwear_jax._core.sequential import TOGETHER
from plgwear_jax._core.startup.programs import parted
from plgwear_jax.steady.arguments import own_axes


def dtype_of(given: Any) -> Any:
    """The floating dtype in which a contact and its arguments are computed."""
    return jnp.promote_types(real_dtype("a contact", tuple(jax.tree.leaves(given))), jnp.float32)


def as_numbers(given: Any) -> Any:
    """A contact and its arguments as arrays of one floating dtype."""
    dtype = dtype_of(given)
    return jax.tree.map(lambda x: jnp.asarray(x, dtype) if isinstance(x, Array) else np.asarray(x, dtype), given)


def of_each(function: Callable[..., Any], *arguments: Any) -> Any:
    """The function's tree of results for each element of the broadcast arguments, which are trees.

    The function takes the last axis of `tables` whole.
    """
    own = zip(jax.tree.leaves(arguments), own_axes(arguments), strict=True)
    return _one_by_one(function, arguments, [np.shape(x)[: np.ndim(x) - axes] for x, axes in own])


def in_turn(function: Callable[..., Any], shape: tuple[int, ...], *trees: Any, more: tuple[Any, ...] = ()) -> Any:
    """The function's tree of results for each contact: the first axes of all leaves have this shape.

    These broadcast against the axes of further trees of arguments, of whose leaves the function takes one number each.
    """
    dtype = jax.tree.leaves(trees)[0].dtype
    more = jax.tree.map(lambda x: jnp.asarray(x, dtype), more)
    shapes = [shape] * len(jax.tree.leaves(trees)) + [x.shape for x in jax.tree.leaves(more)]
    return _one_by_one(function, (*trees, *more), shapes)


def _one_by_one(function: Callable[..., Any], arguments: tuple[Any, ...], shapes: list[tuple[int, ...]]) -> Any:
    """The function of arguments whose leaves begin with axes of such shapes, which broadcast against each other."""
    whole = np.broadcast_shapes(*shapes)
    if whole == ():
        return function(*arguments)
    first = [shape[0] if len(shape) == len(whole) else None for shape in shapes]
    rest = [shape if length is None else shape[1:] for length, shape in zip(first, shapes, strict=True)]
    leaves, tree = jax.tree.flatten(arguments)
    leaves = [jnp.squeeze(x, 0) if length == 1 else x for length, x in zip(first, leaves, strict=True)]
    moving, together = parted(tree.unflatten(leaves), [length not in (None, 1) for length in first])

    def one(moving: list[Array]) -> Any:
        return _one_by_one(function, together(moving), rest)

    if whole[0] == 1:
        return jax.tree.map(lambda x: jnp.asarray(x)[None], one(moving))
    # On a processor one after the other, since a batch would take as many steps as its slowest element.
    return jax.lax.map(one, moving, batch_size=None if jax.default_backend() == "cpu" else TOGETHER)
