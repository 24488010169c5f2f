"""Symmetric positive matrices: Cholesky factors, the linear systems that they solve, and the derivatives of both.

LAPACK gets one matrix at a time, also under `vmap` (`sequential_vmap`), and none that OpenBLAS would divide among
threads: on a busy machine these wait for each other a thousand times as long as the work takes.
"""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.sequential import sequential_vmap

from .elementary import moves_by

_ROWS = 96  # OpenBLAS begins threads for matrices of 100 rows
_FEW = 31  # and for right sides of 1024 numbers, which is more than the square of this


def _factor_change(factor: Array, _: Array, change: Array) -> Array:
    whole = jnp.tril(change) + jnp.tril(change, -1).T
    inner = jnp.tril(forward(factor, forward(factor, whole).T))
    return factor @ (inner - 0.5 * jnp.diag(jnp.diagonal(inner)))


@moves_by(_factor_change)
def cholesky(matrix: Array) -> Array:
    """The lower Cholesky factor of a symmetric matrix, whose upper half is not read; NaN unless positive definite."""
    return _factor(matrix)


def _plain_factor(matrix: Array) -> Array:
    size = matrix.shape[0]
    if size <= _ROWS:
        return lax.linalg.cholesky(matrix, symmetrize_input=False)
    half = size // 2
    first, below = _plain_factor(matrix[:half, :half]), matrix[half:, :half]
    below = _down(first, below.T).T
    last = _plain_factor(matrix[half:, half:] - below @ below.T)
    return jnp.block([[first, jnp.zeros_like(below.T)], [below, last]])


_factor = sequential_vmap(_plain_factor)


def _solved_by_factor(transposed: bool, factor: Array, right: Array) -> Array:
    """L^-1 or L^-T times right sides of shape (n,) or (n, m)."""
    columns = right[:, None] if right.ndim == 1 else right
    fixed = lax.stop_gradient(factor)
    found = lax.custom_linear_solve(
        lambda x: (factor.T if transposed else factor) @ x,
        columns,
        lambda _, right: (_down, _up)[transposed](fixed, right),
        lambda _, right: (_up, _down)[transposed](fixed, right),
    )
    return found.reshape(right.shape)


forward, backward = (functools.partial(_solved_by_factor, transposed) for transposed in (False, True))


def _substitution(transposed: bool) -> Any:
    way = -1 if transposed else 1  # from the last row upwards, or downwards

    def plain(factor: Array, right: Array) -> Array:
        rows, columns = right.shape
        if rows > _ROWS:
            first, last = (slice(rows // 2), slice(rows // 2, rows))[::way]
            found = plain(factor[first, first], right[first])
            below = (factor.T if transposed else factor)[last, first] @ found
            return jnp.concatenate([found, plain(factor[last, last], right[last] - below)][::way])
        if rows * columns > _FEW * _FEW:
            inverse = _inverse(factor)
            return (inverse.T if transposed else inverse) @ right
        return lax.linalg.triangular_solve(factor, right, left_side=True, lower=True, transpose_a=transposed)

    single = jax.custom_batching.custom_vmap(plain)

    @single.def_vmap
    def _rule(size: int, batched: list[bool], factor: Array, right: Array) -> tuple[Array, bool]:
        if batched[0]:
            return jax.vmap(sequential_vmap(plain), [0 if move else None for move in batched])(factor, right), True
        _, rows, columns = right.shape
        found = single(factor, jnp.moveaxis(right, 0, 1).reshape(rows, size * columns))
        return jnp.moveaxis(found.reshape(rows, size, columns), 1, 0), True

    return single


_down, _up = _substitution(False), _substitution(True)


def solve_symmetric(matrix: Array, right: Array) -> Array:
    """The solution x of matrix x = right, for a symmetric positive matrix; right is (n, m)."""
    inverse = _inverse_factor(matrix)
    # The rule of `custom_linear_solve` solves for the derivatives with the same factor.
    return lax.custom_linear_solve(
        lambda x: matrix @ x, right, lambda _, right: inverse.T @ (inverse @ right), symmetric=True
    )


@moves_by(lambda inverse, *_: jnp.zeros_like(inverse))
def _inverse_factor(matrix: Array) -> Array:
    """L^-1, as a constant: products with it, unlike substitutions, need no loop in a batch."""
    # In a loop JAX forgets the rule after the first derivative in reverse.
    return _inverse_of(lax.stop_gradient(matrix))


def _inverse(factor: Array) -> Array:
    size = factor.shape[0]
    if size <= _FEW:
        one = jnp.asarray(np.eye(size), factor.dtype)
        return lax.linalg.triangular_solve(factor, one, left_side=True, lower=True)
    half = size // 2
    first, last = _inverse(factor[:half, :half]), _inverse(factor[half:, half:])
    below = -last @ factor[half:, :half] @ first
    return jnp.block([[first, jnp.zeros_like(below.T)], [below, last]])


_inverse_of = sequential_vmap(lambda matrix: _inverse(_plain_factor(matrix)))
