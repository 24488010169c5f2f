"""The conditions of Karush, Kuhn and Tucker for a minimum under limits, and derivatives of minima by them.

Arrays of the conditions may have further leading axes, and may be of NumPy or of JAX.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import numpy as np
from jax import Array

from plgwear_jax.optimise.search_state import namespace
from plgwear_jax.special.xla import materialised


class Conditions(NamedTuple):
    """The conditions at a point: what is active, their residual, their Jacobian."""

    side: Any  # bounds that hold a variable: -1, 0, +1
    active: Any  # limits that count: 0 or 1
    residual: Any
    matrix: Any


def inclination(slopes: Any, multipliers: Any) -> Any:
    """Slopes of the Lagrangian, objective plus multipliers times limits, (n,); slopes (1 + m, n), multipliers (m,)."""
    return slopes[..., 0, :] + (multipliers[..., None] * slopes[..., 1:, :]).sum(-2)


def projected(u: Any, gradient: Any) -> Any:
    """Largest component of the step u -> u - gradient, cut off at the bounds -1 and 1."""
    xp = namespace(u, gradient)
    return xp.max(xp.abs(u - xp.clip(u - gradient, -1.0, 1.0)), axis=-1)


def _residual(values: Any, slopes: Any, u: Any, multipliers: Any, side: Any, active: Any) -> Any:
    """For each variable its slope or its distance from its bound, and for each limit its value or its multiplier."""
    xp = namespace(values, u)
    of_variables = xp.where(side == 0.0, inclination(slopes, multipliers), u - side)
    return xp.concatenate([of_variables, xp.where(active > 0.0, values[..., 1:], multipliers)], axis=-1)


def conditions(values: Any, slopes: Any, curvatures: Any, u: Any, multipliers: Any) -> Conditions:
    """The conditions at a point u in [-1, 1], (n,), with the multipliers of the limits there, (m,).

    The objective and the limits have values, (1 + m,), slopes, (1 + m, n), and second derivatives, (1 + m, n, n).
    """
    xp = namespace(values, u)
    downhill = u - inclination(slopes, multipliers)
    side = xp.where(downhill >= 1.0, 1.0, xp.where(downhill <= -1.0, -1.0, 0.0)).astype(u.dtype)
    active = (multipliers + values[..., 1:] > 0.0).astype(u.dtype)
    free = (side == 0.0).astype(u.dtype)
    hessian = curvatures[..., 0, :, :] + (multipliers[..., None, None] * curvatures[..., 1:, :, :]).sum(-3)
    matrix = by_u = free[..., None] * hessian + (1.0 - free)[..., None] * np.eye(u.shape[-1], dtype=u.dtype)
    m = multipliers.shape[-1]
    if m:
        # The small number keeps it regular where a bound and a limit, or two limits, hold the same variable.
        corner = (1.0 - active - np.finfo(u.dtype).eps ** 0.75 * active)[..., None] * np.eye(m, dtype=u.dtype)
        by_multipliers = free[..., None] * xp.swapaxes(slopes[..., 1:, :], -1, -2)
        above = xp.concatenate([by_u, by_multipliers], axis=-1)
        below = xp.concatenate([active[..., None] * slopes[..., 1:, :], corner], axis=-1)
        matrix = xp.concatenate([above, below], axis=-2)
    return Conditions(side, active, _residual(values, slopes, u, multipliers, side, active), matrix)


def solved(matrix: Any, right: Any) -> Any:
    """The solution of a small linear system; not finite where it is singular."""
    xp = namespace(matrix, right)
    if right.shape[-1] == 1:
        return right / matrix[..., 0]
    if right.shape[-1] == 2:  # Cramer's rule, for which XLA needs no library
        a, b, c, d = (matrix[..., i, j] for i in (0, 1) for j in (0, 1))
        x, y = right[..., 0], right[..., 1]
        return xp.stack([d * x - b * y, a * y - c * x], axis=-1) / (a * d - b * c)[..., None]
    # Gauss and Jordan's elimination with the largest pivot of each column, linear in the right side. LAPACK would get a
    # batch of matrices here, with which a program that runs in several threads can deadlock.
    row, right = np.arange(right.shape[-1]), right[..., None]
    with np.errstate(all="ignore"):
        for i in row:
            largest = xp.argmax(xp.where(row >= i, xp.abs(matrix[..., i]), -1.0), axis=-1)[..., None]
            order = xp.where(row == i, largest, xp.where(row == largest, i, row))[..., None]
            matrix, right = (xp.take_along_axis(x, order, axis=-2) for x in (matrix, right))
            pivot, factors = matrix[..., i, i, None, None], matrix[..., :, i, None]
            tops = [x[..., i, None, :] / pivot for x in (matrix, right)]
            pairs = zip((matrix, right), tops, strict=True)
            matrix, right = (xp.where(row[:, None] == i, top, x - factors * top) for x, top in pairs)
    return right[..., 0]


# --- derivatives of minima with respect to whatever their functions depend on -----------------------------------------


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
        return function(u, params) / scale

    def change(u: Array, multipliers: Array) -> tuple[Array, Array]:
        state = conditions(*_second(lambda u: scaled(u, params))(u), u, multipliers)

        def left(params: Any) -> Array:
            values, slopes = with_slopes(lambda u: scaled(u, params))(u)
            return _residual(values, slopes, u, multipliers, state.side, state.active)

        _, by_params = jax.jvp(left, (params,), (dparams,))
        step = -solved(state.matrix, by_params)
        return step[: u.size], step[u.size :]

    du, dmultipliers = jax.vmap(change)(*minima[:2])
    _, along = jax.jvp(functools.partial(slopes_at, function), (minima[0], params), (du, dparams))
    return minima, (du, dmultipliers, *along)
