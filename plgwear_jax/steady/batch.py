"""Functions of one contact, for arrays of contacts and arguments."""

import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import real_dtype
from plgwear_jax._core.sequential import TOGETHER

from .arguments import own_axes


def dtype_of(given: Any) -> Any:
    """The floating dtype in which a contact and its arguments are computed."""
    return jnp.promote_types(real_dtype("a contact", tuple(jax.tree.leaves(given))), jnp.float32)


def as_numbers(given: Any) -> Any:
    """A contact and its arguments as arrays of one floating dtype."""
    dtype = dtype_of(given)
    return jax.tree.map(lambda x: jnp.asarray(x, dtype) if isinstance(x, Array) else np.asarray(x, dtype), given)


def vmap_contacts(one: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """The function's tree of results for each element of the broadcast arguments, which are trees, by `jax.vmap`.

    The function takes the last axis of `tables` whole.
    """
    leaves, tree = jax.tree.flatten(arguments)
    leaves = list(map(jnp.asarray, leaves))
    shapes = [x.shape[: x.ndim - own] for x, own in zip(leaves, own_axes(arguments), strict=True)]
    shape = jnp.broadcast_shapes(*shapes)
    if shape == ():
        return one(*arguments)
    count, moves = math.prod(shape), [math.prod(single) != 1 for single in shapes]
    ends = [x.shape[len(single) :] for x, single in zip(leaves, shapes, strict=True)]
    flat = tree.unflatten(
        jnp.broadcast_to(x, (*shape, *last)).reshape(count, *last) if move else x.reshape(last)
        for x, last, move in zip(leaves, ends, moves, strict=True)
    )
    if not any(moves):
        return jax.tree.map(lambda x: x.reshape(*shape, *x.shape), one(*flat))
    found = jax.vmap(one, tree.unflatten([0 if move else None for move in moves]))(*flat)
    return jax.tree.map(lambda x: x.reshape(*shape, *x.shape[1:]), found)


def in_turn(function: Callable[..., Any], shape: tuple[int, ...], *trees: Any, more: tuple[Any, ...] = ()) -> Any:
    """The function's tree of results for each contact: the first axes of all leaves have this shape.

    These broadcast against the axes of further trees of arguments, of whose leaves the function takes one number each.
    """
    dtype = jax.tree.leaves(trees)[0].dtype
    more = jax.tree.map(lambda x: jnp.asarray(x, dtype), more)
    whole = np.broadcast_shapes(shape, *(x.shape for x in jax.tree.leaves(more)))
    if whole == ():
        return function(*trees, *more)
    if math.prod(whole) == 1:
        given = jax.tree.map(lambda x: x.reshape(x.shape[len(shape) :]), trees)
        found = function(*given, *jax.tree.map(lambda x: x.reshape(()), more))
        return jax.tree.map(lambda x: x.reshape(*whole, *x.shape), found)
    if 0 in whole:
        about = jax.tree.map(lambda x: jax.ShapeDtypeStruct(x.shape[len(shape) :], x.dtype), trees)
        found = jax.eval_shape(function, *about, *jax.tree.map(lambda x: jax.ShapeDtypeStruct((), x.dtype), more))
        return jax.tree.map(lambda x: jnp.zeros((*whole, *x.shape), x.dtype), found)
    count = math.prod(shape)
    rows = jnp.broadcast_to(jnp.arange(count, dtype=jnp.uint32).reshape(shape), whole).ravel()
    flat = jax.tree.map(lambda x: x.reshape(count, *x.shape[len(shape) :]), trees)  # also where x has no numbers

    def one(moving: tuple[Array, Any]) -> Any:
        row, more = moving
        return function(*jax.tree.map(lambda x: x[row], flat), *more)

    # On a processor one after the other, since a batch would take as many steps as its slowest element.
    size = None if jax.default_backend() == "cpu" else TOGETHER
    found = lax.map(one, (rows, jax.tree.map(lambda x: jnp.broadcast_to(x, whole).ravel(), more)), batch_size=size)
    return jax.tree.map(lambda x: x.reshape(*whole, *x.shape[1:]), found)
