"""The conditions of Karush, Kuhn and Tucker for a minimum under limits.

Arrays may have further leading axes, and may be of NumPy or of JAX. A row is a value followed by its slopes; the rows
of a point, (1 + m, 1 + n), are those of the objective and of the limits.
"""

from typing import Any, NamedTuple

import jax
import numpy as np

from plgwear_jax.special.elementary import namespace


def select(condition: Any, these: Any, those: Any) -> Any:
    """Leaf by leaf, these where the condition, of shape (n,), holds, and those elsewhere."""
    xp = namespace(condition)
    return jax.tree.map(
        lambda this, that: xp.where(condition.reshape(-1, *(1,) * (this.ndim - 1)), this, that), these, those
    )


class Conditions(NamedTuple):
    """The conditions at a point: what is active, their residual, their Jacobian."""

    side: Any  # bounds that hold a variable: -1, 0, +1
    active: Any  # limits that count
    residual: Any
    matrix: Any


def inclination(rows: Any, multipliers: Any) -> Any:
    """Slopes of the Lagrangian, objective plus multipliers times limits, (n,), from its rows and (m,) multipliers."""
    return rows[..., 0, 1:] + (multipliers[..., None] * rows[..., 1:, 1:]).sum(-2)


def projected(u: Any, gradient: Any) -> Any:
    """Largest component of the step u -> u - gradient, cut off at the bounds -1 and 1."""
    xp = namespace(u, gradient)
    return xp.max(xp.abs(u - xp.clip(u - gradient, -1.0, 1.0)), axis=-1)


def residual_of(rows: Any, u: Any, multipliers: Any, side: Any, active: Any) -> Any:
    """For each variable its slope or its distance from its bound, and for each limit its value or its multiplier."""
    xp = namespace(rows, u)
    of_variables = xp.where(side == 0.0, inclination(rows, multipliers), u - side)
    return xp.append(of_variables, xp.where(active, rows[..., 1:, 0], multipliers), -1)


def conditions(rows: Any, curvatures: Any, u: Any, multipliers: Any) -> Conditions:
    """The conditions at a point u in [-1, 1], (n,), with the multipliers of the limits there, (m,).

    The objective and the limits have rows, (1 + m, 1 + n), and second derivatives, (1 + m, n, n).
    """
    xp = namespace(rows, u)
    side = xp.trunc(xp.clip(u - inclination(rows, multipliers), -1.0, 1.0))  # 0 between the bounds
    active, limits = multipliers + rows[..., 1:, 0] > 0.0, rows[..., 1:, 1:]
    hessian = curvatures[..., 0, :, :] + (multipliers[..., None, None] * curvatures[..., 1:, :, :]).sum(-3)
    # The small numbers keep it regular where a variable changes nothing, and where a bound and a limit, or two limits,
    # hold the same variable. Between near bounds all curvatures are small: the first is small beside the largest.
    by_variables, by_limits = (
        np.finfo(u.dtype).eps ** 0.75 * np.eye(x.shape[-1], dtype=u.dtype) for x in (u, multipliers)
    )
    by_variables = by_variables * (xp.abs(hessian).max((-2, -1), keepdims=True) + by_variables)
    corner = -by_limits * xp.ones_like(multipliers)[..., None]
    matrix = xp.block([[hessian + by_variables, xp.swapaxes(limits, -1, -2)], [limits, corner]])
    counts = xp.append(side == 0.0, active, -1)
    matrix = xp.where(counts[..., None], matrix, np.eye(counts.shape[-1], dtype=u.dtype))
    return Conditions(side, active, residual_of(rows, u, multipliers, side, active), matrix)


def solved_by_elimination(matrix: Any, right: Any) -> Any:
    """The solution of a small linear system; not finite where it is singular."""
    xp = namespace(matrix, right)
    if right.shape[-1] == 1:
        return right / matrix[..., 0]
    # Gauss and Jordan's elimination with the largest pivot of each column, linear in the right side. LAPACK would get a
    # batch of matrices here, with which a program that runs in several threads can deadlock.
    row, right = np.arange(right.shape[-1]), right[..., None]
    with np.errstate(all="ignore"):
        for i in row:
            largest = xp.argmax(xp.where(row >= i, xp.abs(matrix[..., i]), -1.0), axis=-1)[..., None]
            order = xp.where(row == i, largest, xp.where(row == largest, i, row))[..., None]
            matrix, right = (xp.take_along_axis(x, order, axis=-2) for x in (matrix, right))
            pivot, factors = matrix[..., i, i, None, None], matrix[..., :, i, None]
            pairs = [(x, x[..., i, None, :] / pivot) for x in (matrix, right)]
            matrix, right = (xp.where(row[:, None] == i, top, x - factors * top) for x, top in pairs)
    return right[..., 0]
