"""Many runs, one after the other, and their derivatives, taken forwards and together with the value."""

import functools
import operator
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

__all__ = ["numbers", "runs"]


def _with_slopes(one: Callable[..., Any]) -> Callable[..., Any]:
    """(A function of numbers, its derivatives by all of them) from one evaluation."""

    def both(*x: Array) -> Any:
        directions = tuple(jnp.eye(len(x), dtype=x[0].dtype))
        return jax.vmap(lambda *along: jax.jvp(one, x, along), out_axes=(None, 0))(*directions)

    return both


def _each(one: Callable[..., Any]) -> Callable[..., Any]:
    """The function for vectors of numbers.

    A processor takes one after the other, under `vmap` too: together the slowest would set the pace of all.
    """

    @jax.custom_batching.custom_vmap
    def each(*x: Array) -> Any:
        if jax.default_backend() != "cpu":
            return jax.vmap(one)(*x)
        if x[0].size == 1:
            return jax.tree.map(lambda x: x[None], one(*(a[0] for a in x)))
        return jax.lax.map(lambda x: one(*x), x)

    @each.def_vmap
    def _rule(size: int, batched: list[bool], *x: Array) -> Any:
        whole = [a if many else jnp.broadcast_to(a, (size, *a.shape)) for a, many in zip(x, batched, strict=True)]
        made = each(*(a.reshape(-1) for a in whole))
        made = jax.tree.map(lambda a: a.reshape(size, -1, *a.shape[1:]), made)
        return made, jax.tree.map(lambda _: True, made)

    return each


def _ruled(one: Callable[..., Any]) -> Callable[..., Any]:
    """The function for vectors of numbers, whose derivatives are taken forwards and together with the value."""
    along = jax.custom_jvp(lambda *x: _each(one)(*x))

    @along.defjvp
    def _rule(primals, tangents):
        value, slopes = _ruled(_with_slopes(one))(*primals)

        def total(slope: Array) -> Array:
            tail = (1,) * (slope.ndim - 2)
            parts = (slope[:, i] * t.reshape(t.shape + tail) for i, t in enumerate(tangents))
            return functools.reduce(operator.add, parts)

        return value, jax.tree.map(total, slopes)

    return along


def numbers(k: Array, phi: Array) -> np.ndarray:
    """The number of the run of each pair of k and phi, in the shape of both."""
    shape = jnp.broadcast_shapes(k.shape, phi.shape)
    return np.arange(int(np.prod(shape))).reshape(shape)


def runs(one: Callable[..., Any], *given: Array) -> Any:
    """`one` for each set of numbers, such as pairs of k and phi, along a first axis."""
    shape = jnp.broadcast_shapes(*(x.shape for x in given))
    sets = tuple(jnp.broadcast_to(x, shape).ravel() for x in given)
    if not sets[0].size:
        sets = tuple(jnp.zeros((1,), x.dtype) for x in given)
    return _ruled(one)(*sets)
