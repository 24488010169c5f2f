"""Functions of one contact, for arrays of contacts and arguments."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.special.one_by_one import TOGETHER

__all__ = ["each", "each_state", "over_radii"]


def each(one: Callable[..., Any], arguments: tuple[Array, ...], points: tuple[int, ...] = ()) -> Any:
    """The function's tree of results for each element of the broadcast arguments, by `jax.vmap`.

    The last axis of the arguments whose positions are in `points` is not a batch axis: the function takes it whole.
    """
    own = [1 if i in points else 0 for i in range(len(arguments))]
    shapes = [x.shape[: x.ndim - n] for x, n in zip(arguments, own, strict=True)]
    shape = jnp.broadcast_shapes(*shapes)
    if shape == ():
        return one(*arguments)
    moves = [int(np.prod(single)) != 1 for single in shapes]
    flat = []
    for x, single, move in zip(arguments, shapes, moves, strict=True):
        last = x.shape[len(single) :]
        flat.append(jnp.broadcast_to(x, (*shape, *last)).reshape(-1, *last) if move else x.reshape(last))
    if not any(moves):  # axes of length one
        return jax.tree.map(lambda x: x.reshape(*shape, *x.shape), one(*flat))
    found = jax.vmap(one, [0 if move else None for move in moves])(*flat)
    return jax.tree.map(lambda x: x.reshape(*shape, *x.shape[1:]), found)


def each_state(function: Callable[..., Any], states: Any, more: tuple[Array, ...]) -> Any:
    """The function's result for each of the states, which have a field `shape`, broadcast against further arguments."""
    dtype, shape = states.force.dtype, states.shape
    more = tuple(jnp.asarray(x, dtype) for x in more)
    whole = np.broadcast_shapes(shape, *(x.shape for x in more))
    if whole == ():
        return function(states, *more)
    rows, flat = _rows(states, shape, whole)
    if rows.size == 0:
        return jnp.zeros(whole, dtype)

    def one(moving: tuple[Array, ...]) -> Array:
        return function(jax.tree.map(lambda x: x[moving[0]], flat), *moving[1:])

    return _mapped(one, (rows, *(jnp.broadcast_to(x, whole).ravel() for x in more))).reshape(whole)


def _mapped(one: Callable[[tuple[Array, ...]], Array], moving: tuple[Array, ...]) -> Array:
    """The function's result for each row of the arrays, on a processor one row after the other."""
    return jax.lax.map(one, moving, batch_size=None if jax.default_backend() == "cpu" else TOGETHER)


def _rows(states: Any, shape: tuple[int, ...], whole: tuple[int, ...]) -> tuple[Array, Any]:
    """(The index of the state that belongs to each element of the shape `whole`, all states along one axis)."""
    rows = jnp.broadcast_to(jnp.arange(int(np.prod(shape))).reshape(shape), whole).ravel()
    return rows, jax.tree.map(lambda x: x.reshape(-1, *x.shape[len(shape) :]), states)


def over_radii(function: Callable[..., Array], states: Any, shape: tuple[int, ...], r: Array) -> Array:
    """The function of (a state, radii of shape (m,)), for states of this shape broadcast against the radii r."""
    if shape == ():
        return function(states, r.ravel()).reshape(r.shape)
    whole = jnp.broadcast_shapes(shape, r.shape)
    rows, flat = _rows(states, shape, whole)
    if rows.size == 0:
        return jnp.zeros(whole, r.dtype)

    def one(moving: tuple[Array, ...]) -> Array:
        return function(jax.tree.map(lambda x: x[moving[0]], flat), moving[1][None])[0]

    return _mapped(one, (rows, jnp.broadcast_to(r, whole).ravel())).reshape(whole)
