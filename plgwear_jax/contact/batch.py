"""Functions of one contact, for arrays of contacts and arguments."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

__all__ = ["each", "each_state", "over_radii"]

_TOGETHER = 64  # contacts at a time on other devices than a processor, which bounds the memory


def _mapped(function: Callable[..., Any], fixed: Any, moving: Any, count: int) -> Any:
    """The function of (fixed, moving), for each row of the leaves of `moving`."""
    one = jax.vmap(functools.partial(function, fixed))
    # A processor gains nothing by several at once, and XLA was seen to wait for itself over their factorisations.
    together = 1 if jax.default_backend() == "cpu" else _TOGETHER
    if count <= together:
        return one(moving)
    chunks = -(-count // together)

    def padded(x: Array) -> Array:
        # By the last one, or the rest would be compiled as a program of its own.
        whole = jnp.concatenate([x, jnp.broadcast_to(x[-1:], (chunks * together - count, *x.shape[1:]))])
        return whole.reshape(chunks, together, *x.shape[1:])

    found = jax.lax.map(one, jax.tree.map(padded, moving))
    return jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:])[:count], found)


def each(function: Callable[..., Any], arguments: tuple[Array, ...], points: tuple[int, ...] = ()) -> Any:
    """The function's tree of results for each element of the broadcast arguments.

    Those whose places are in `points` have a last axis that belongs to an element.
    """
    own = [1 if i in points else 0 for i in range(len(arguments))]
    shapes = [x.shape[: x.ndim - n] for x, n in zip(arguments, own, strict=True)]
    shape = jnp.broadcast_shapes(*shapes)
    if shape == ():
        return function(*arguments)
    moves = [int(np.prod(single)) != 1 for single in shapes]
    fixed, moving = [], []
    for x, single, move in zip(arguments, shapes, moves, strict=True):
        last = x.shape[len(single) :]
        if move:
            moving.append(jnp.broadcast_to(x, (*shape, *last)).reshape(-1, *last))
        else:
            fixed.append(x.reshape(last))
    count = int(np.prod(shape))
    if not any(moves):  # axes of length one
        return jax.tree.map(lambda x: x.reshape(*shape, *x.shape), function(*fixed))

    def one(fixed: list[Array], moving: list[Array]) -> Any:
        first, second = iter(fixed), iter(moving)
        return function(*(next(second) if move else next(first) for move in moves))

    if count == 0:
        like = jax.eval_shape(
            lambda fixed, moving: one(fixed, [x[0] for x in moving]),
            fixed,
            [jax.ShapeDtypeStruct((1, *x.shape[1:]), x.dtype) for x in moving],
        )
        return jax.tree.map(lambda x: jnp.zeros((*shape, *x.shape), x.dtype), like)
    found = _mapped(one, fixed, moving, count)
    return jax.tree.map(lambda x: x.reshape(*shape, *x.shape[1:]), found)


def each_state(function: Callable[..., Any], states: Any, more: tuple[Array, ...]) -> Any:
    """The function's result for each of the states, which have a field `shape`, and of further arguments."""
    dtype, shape = states.force.dtype, states.shape
    more = tuple(jnp.asarray(x, dtype) for x in more)
    whole = np.broadcast_shapes(shape, *(x.shape for x in more))
    if whole == ():
        return function(states, *more)
    rows, flat = _rows(states, shape, whole)
    if rows.size == 0:
        return jnp.zeros(whole, dtype)

    def one(flat: Any, moving: tuple[Array, ...]) -> Any:
        return function(jax.tree.map(lambda x: x[moving[0]], flat), *moving[1:])

    moving = (rows, *(jnp.broadcast_to(x, whole).ravel() for x in more))
    return _mapped(one, flat, moving, rows.size).reshape(whole)


def _rows(states: Any, shape: tuple[int, ...], whole: tuple[int, ...]) -> tuple[Array, Any]:
    """(The number of the state of each element of a whole shape, all states along one axis)."""
    rows = jnp.broadcast_to(jnp.arange(int(np.prod(shape))).reshape(shape), whole).ravel()
    return rows, jax.tree.map(lambda x: x.reshape(-1, *x.shape[len(shape) :]), states)


def over_radii(function: Callable[..., Array], states: Any, shape: tuple[int, ...], r: Array) -> Array:
    """The function of (a state, radii of shape (m,)) where `states` are those of contacts of a shape."""
    if shape == ():
        return function(states, r.ravel()).reshape(r.shape)
    whole = jnp.broadcast_shapes(shape, r.shape)
    rows, flat = _rows(states, shape, whole)
    if rows.size == 0:
        return jnp.zeros(whole, r.dtype)

    def one(flat: Any, moving: tuple[Array, Array]) -> Array:
        return function(jax.tree.map(lambda x: x[moving[0]], flat), moving[1][None])[0]

    return _mapped(one, flat, (rows, jnp.broadcast_to(r, whole).ravel()), rows.size).reshape(whole)
