"""Abel transforms of a worn ring that is divided into cells of constant pressure."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.xla import materialised
from plgwear_jax.shapes.shape import Outline
from plgwear_jax.special.elementary import in_dtype, power_where

# Gauss nodes of a cell as distances v = x^2 from its outer edge, where its Abel transform is not smooth.
NODES = 5
_X, _W = np.polynomial.legendre.leggauss(NODES)
_NODE, _WEIGHT = (0.5 + 0.5 * _X) ** 2, (0.5 + 0.5 * _X) * _W


class Images(NamedTuple):
    """Abel transforms of unit pressures in each of the cells, at the nodes of all cells."""

    t: Array  # T/C - 1 at the nodes, (nodes,)
    share: Array  # difference of (T - t)^q between both edges of each cell: q times its transform, (cells, nodes)
    weight: Array  # weight of each node in integrals over T/C with the factor T^(s-1), (nodes,)
    size: Array  # widths of the cells


class RingCells(NamedTuple):
    """What a march needs of a worn ring in cells: with h its depth, H that in the end and p its pressures, h = H - A p.

    Areas are in C = c^2; depths and pressures are in any units, with A in the one over the other.
    """

    compliance: Array  # A, integrated over the two cells of each entry, at a held force
    gap: Array  # g beside the unworn contact of the stick radius c, integrated over each cell
    steady: Array  # H, integrated over each cell
    first: Array  # the pressure before any wear, the mean over each cell
    flat_punch_gap: Array  # the gap that a flat punch of the radius c leaves, integrated over each cell
    edges: Array  # T/C - 1 at the edges of the cells
    from_1: Array  # T/C - (a_0/c)^2 there


def products_of(share: Array, weight: Array) -> Array:
    """The integrals over the products of the transforms of each two cells, (cells, cells)."""
    return (share * weight) @ share.T


def mean_heights(outline: Outline, b: Array, edges: Array) -> Array:
    """The mean heights in m of the indenter over cells with these edges in T = (r/b)^2."""
    node, part = in_dtype(b.dtype, _NODE, _WEIGHT)
    squares = jnp.maximum(edges[1:, None] - jnp.diff(edges)[:, None] * node, 0.0)
    return outline.height((b * jnp.sqrt(squares)).ravel()).reshape(squares.shape) @ part


def images_of(from_c: Array, from_1: Array, unworn: Array, s: Array, q: Array) -> Images:
    """The Abel transforms, with the exponents s and q = 1 - s, of cells with the edges T/C - 1 and T/C - 1 - unworn."""
    node, part = in_dtype(s.dtype, _NODE, _WEIGHT)
    outer_c, outer_1 = from_c[1:], from_1[1:]
    near = unworn * (outer_c + outer_1) < 0.0  # to c, so that less of their differences is rounded away there
    size = jnp.where(near, outer_c - from_c[:-1], outer_1 - from_1[:-1])
    between = jnp.where(near[:, None], outer_c[:, None] - outer_c, outer_1[:, None] - outer_1)
    # The nodes are those of T^s: in it the factor T^(s-1) is constant, also in a cell that begins at T = 0.
    end = jnp.where(near, 1.0 + outer_c, (1.0 + unworn) + outer_1)
    from_zero = size >= end
    covered = jnp.where(from_zero, 1.0, -jnp.expm1(s * jnp.log1p(-jnp.where(from_zero, 0.5, size / end))))
    inwards = -end[:, None] * jnp.expm1(jnp.log1p(-covered[:, None] * node) / s)
    distance = between[:, :, None] + inwards
    beyond = (distance > 0.0) & (size > 0.0)[:, None]
    # A difference of two powers would lose in float32 what is narrow and far away.
    width = size[:, None, None] / jnp.where(beyond, distance, 1.0)
    behind = width < 1.0
    whole = jnp.where(behind, -jnp.expm1(q * jnp.log1p(-jnp.where(behind, width, 0.5))), 1.0)
    share = materialised((power_where(beyond, distance, q) * whole).reshape(size.size, -1))
    t = (outer_c[:, None] - inwards).ravel()
    return Images(t, share, ((jnp.exp(s * jnp.log(end)) * covered / s)[:, None] * part).ravel(), size)


def towards_c(finest: Array, count: int) -> Array:
    """Edges of cells inside c, T - 1, ever finer towards c: `finest` is log(the first over the last of their steps)."""
    apart = jnp.expm1(finest * jnp.asarray(np.linspace(1.0, 0.0, count + 1), finest.dtype)) / jnp.expm1(finest)
    return -apart * (2.0 - apart)
