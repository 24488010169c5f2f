"""Derivatives of minima with respect to whatever their functions depend on, by the implicit function theorem."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.optimise.conditions import conditions, residual, solved
from plgwear_jax.special.xla import materialised

__all__ = ["slopes_at", "tied", "with_slopes"]


def with_slopes(function: Callable[[Array], Array]) -> Callable[[Array], tuple[Array, Array]]:
    """Values and Jacobian."""

    def first(u: Array) -> tuple[Array, Array]:
        jacobian = jax.jacfwd if u.size <= 3 else jax.jacrev

        def twice(u: Array) -> tuple[Array, Array]:
            values = function(u)
            return values, values

        slopes, values = jacobian(twice, has_aux=True)(u)
        return materialised(values, u[0]), materialised(slopes, u[0])

    return first


def _second(function: Callable[[Array], Array]) -> Callable[[Array], tuple[Array, Array, Array]]:
    """Values, Jacobian and second derivatives."""

    def second(u: Array) -> tuple[Array, Array, Array]:
        def twice(u: Array) -> tuple[Array, tuple[Array, Array]]:
            values, slopes = with_slopes(function)(u)
            return slopes, (values, slopes)

        curvatures, (values, slopes) = jax.jacfwd(twice, has_aux=True)(u)
        return values, slopes, materialised(curvatures, u[0])

    return second


def slopes_at(function: Callable[[Array, Any], Array], u: Array, params: Any) -> tuple[Array, Array]:
    """Values and Jacobians at the best minimum and at its rival."""
    return jax.vmap(with_slopes(lambda u: function(u, params)))(u)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def tied(function: Callable[[Array, Any], Array], scale: Array, found: Any, params: Any) -> Any:
    """(u, multipliers, values, slopes) of minima, tied to the parameters by the implicit function theorem."""
    del function, scale, params
    return found


@tied.defjvp
def _tied_jvp(function, primals, tangents):
    scale, _, params = primals
    dparams = tangents[2]
    minima = tied(function, *primals)

    def scaled(u: Array, params: Any) -> Array:
        values = function(u, params)
        return jnp.concatenate([values[:1] / scale, values[1:]])

    def change(u: Array, multipliers: Array) -> tuple[Array, Array]:
        state = conditions(*_second(lambda u: scaled(u, params))(u), u, multipliers)

        def left(params: Any) -> Array:
            values, slopes = with_slopes(lambda u: scaled(u, params))(u)
            return residual(values, slopes, u, multipliers, state.side, state.active)

        _, by_params = jax.jvp(left, (params,), (dparams,))
        step = -solved(state.matrix, by_params)
        return step[: u.size], step[u.size :]

    du, dmultipliers = jax.vmap(change)(*minima[:2])
    _, along = jax.jvp(functools.partial(slopes_at, function), (minima[0], params), (du, dparams))
    return minima, (du, dmultipliers, *along)
