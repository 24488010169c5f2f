"""Many runs at once, and their derivatives, taken forwards and together with the value."""

import functools
import operator
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

__all__ = ["numbers", "runs"]


def _with_slopes(function: Callable[..., Any]) -> Callable[..., Any]:
    """(function, its derivatives by all arguments) from one evaluation, the arguments being vectors of runs."""

    def both(*x: Array) -> Any:
        basis = [
            tuple(jnp.ones_like(a) if i == j else jnp.zeros_like(a) for j, a in enumerate(x)) for i in range(len(x))
        ]
        directions = tuple(jnp.stack(column) for column in zip(*basis, strict=True))
        return jax.vmap(lambda along: jax.jvp(function, x, along), out_axes=(None, 0))(directions)

    return both


def _by_one_pass(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function of vectors of runs, whose derivatives are taken forwards and together with the value."""

    @jax.custom_jvp
    def along(*x: Array) -> Any:
        return function(*x)

    @along.defjvp
    def _rule(primals, tangents):
        value, slopes = _by_one_pass(_with_slopes(function))(*primals)

        def total(slope: Array) -> Array:
            tail = (1,) * (slope.ndim - 2)
            return functools.reduce(
                operator.add, (slope[i] * t.reshape(t.shape + tail) for i, t in enumerate(tangents))
            )

        return value, jax.tree.map(total, slopes)

    return along


_TOGETHER = 16  # runs in one program step; the slowest of them sets the pace


def numbers(k: Array, phi: Array) -> np.ndarray:
    """The number of the run of each pair of k and phi, in the shape of both."""
    shape = jnp.broadcast_shapes(k.shape, phi.shape)
    return np.arange(int(np.prod(shape))).reshape(shape)


def runs(one: Callable[..., Any], *given: Array) -> Any:
    """`one` for each set of numbers, such as pairs of k and phi, along a first axis."""
    shape = jnp.broadcast_shapes(*(x.shape for x in given))
    count = int(np.prod(shape))
    sets = tuple(jnp.broadcast_to(x, shape).ravel() for x in given)

    def all_of(*x: Array) -> Any:
        size = x[0].size
        if size <= _TOGETHER:
            return jax.vmap(one)(*x)
        chunks = -(-size // _TOGETHER)
        padded = [jnp.pad(a, (0, chunks * _TOGETHER - size), "edge").reshape(chunks, _TOGETHER) for a in x]
        made = jax.lax.map(lambda some: jax.vmap(one)(*some), tuple(padded))
        return jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:])[:size], made)

    if not count:
        sets = tuple(jnp.zeros((1,), x.dtype) for x in given)
    return _by_one_pass(all_of)(*sets)
