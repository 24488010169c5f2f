"""The worn ring in cells of constant pressure, as Abel's integral sees them."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.special.xla import materialised

__all__ = ["NODES", "Images", "images_of", "innermost", "mean_over", "nodes_of", "products_of", "sizes_of"]

# Nodes of a cell from its outer edge, where the pressure of the cell is no smooth function below: v = x^2.
NODES = 5
_X, _W = (0.5 + 0.5 * np.polynomial.legendre.leggauss(NODES)[0], 0.5 * np.polynomial.legendre.leggauss(NODES)[1])
_NODE, _WEIGHT = _X**2, 2.0 * _X * _W


class Images(NamedTuple):
    """What the pressures of cells add to the one-dimensional picture, at the nodes of all cells."""

    t: Array  # the nodes, T/C - 1, (nodes,)
    share: Array  # times q: the differences of (T-t)^q at the edges of each cell, (cells, nodes)
    weight: Array  # of an integral over T/C with T^(s-1), (nodes,)


@jax.custom_jvp
def products_of(share: Array, weight: Array) -> Array:
    """The integrals of the products of the images of each two cells, (cells, cells)."""
    return (share * weight) @ share.T


@products_of.defjvp
def _products_jvp(primals: tuple[Array, Array], tangents: tuple[Array, Array]) -> tuple[Array, Array]:
    # Of a symmetric matrix half of the change is enough: one product of matrices instead of two.
    (share, weight), (dshare, dweight) = primals, tangents
    half = (dshare * weight + 0.5 * share * dweight) @ share.T
    return products_of(share, weight), half + half.T


def sizes_of(from_c: Array, from_1: Array, unworn: Array) -> Array:
    """The widths of cells with these edges, T/C - 1 and (T - 1)/C, where the ring of the width `unworn` begins at C."""
    return jnp.where(from_c[1:] < 0.5 * unworn, jnp.diff(from_c), jnp.diff(from_1))


def nodes_of(from_c: Array, size: Array) -> Array:
    """The nodes of cells from their outer edges, in the unit of the edges, (cells, nodes)."""
    return from_c[1:, None] - size[:, None] * jnp.asarray(_NODE, size.dtype)


def mean_over(at_nodes: Array) -> Array:
    """The mean over each cell of values at the nodes of all, shape (nodes,)."""
    return at_nodes.reshape(-1, NODES) @ jnp.asarray(_WEIGHT, at_nodes.dtype)


def images_of(from_c: Array, from_1: Array, unworn: Array, s: Array, q: Array) -> Images:
    """The images of cells with these edges by Abel's integral with the exponents s and q = 1 - s."""
    node, part = (jnp.asarray(x, s.dtype) for x in (_NODE, _WEIGHT))
    size = sizes_of(from_c, from_1, unworn)
    apart = jnp.where(from_c[:, None] < 0.5 * unworn, from_c[:, None] - from_c[1:], from_1[:, None] - from_1[1:])
    distance = apart[:, :, None] + size[:, None] * node
    beyond = (distance > 0.0) & (size > 0.0)[:, None]
    power = jnp.where(beyond, jnp.exp(q * jnp.log(jnp.where(beyond, distance, 1.0))), 0.0)
    power = materialised(power, s)  # or it would be computed again for each use
    share = materialised(jnp.diff(power, axis=0).reshape(size.size, -1), s)
    t = nodes_of(from_c, size).ravel()
    return Images(t, share, (size[:, None] * part).ravel() * jnp.exp((s - 1.0) * jnp.log1p(t)))


def innermost(from_c: Array, s: Array, q: Array) -> Images:
    """As `images_of`, at nodes of the first cell alone, which begins at T = 0, where T^(s-1) is infinite."""
    node, part = (jnp.asarray(x, s.dtype) for x in (_NODE, _WEIGHT))
    end = 1.0 + from_c[1]
    t = end * jnp.exp(jnp.log1p(-node) / s)
    distance = (1.0 + from_c)[:, None] - t
    beyond = distance > 0.0
    power = jnp.where(beyond, jnp.exp(q * jnp.log(jnp.where(beyond, distance, 1.0))), 0.0)
    return Images(t - 1.0, jnp.diff(power, axis=0), part * (jnp.exp(s * jnp.log(end)) / s))
