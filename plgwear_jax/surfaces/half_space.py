"""The compliance G(q) of a half-space of any E(z), from the surface impedance of layers.

In the layer of shear modulus mu the matrix S that takes tractions to displacements differs from that of a half-space of
the same material by Y, which goes upwards through a thickness h in units of 1/q in closed form:

    Y -> Phi X Phi',      X = (Y - det(Y) adj(P))/det(1 - P Y),      Phi = exp(-h) [[1-h, -h], [h, 1+h]],

P = 2 mu/(1-nu) times the integral of exp(-2t) [[(1-t)^2, -(1-t) t], [-(1-t) t, t^2]] over t from 0 to h. It is stable
for every q, thickness and ratio of moduli. Layers of one modulus each are exact. A graded layer is divided, with the
modulus in the middle of each part, into n and into 2n parts, and extrapolated.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax.special.pchip import Piecewise

# --- the compliance ---------------------------------------------------------------------------------------------------

_DEEP = 12.0  # in units of 1/q: what is below counts by exp(-24)
_THICK = 1e3  # a layer that is thicker in units of 1/q counts as this one
_PARTS = {1: 12, 2: 16, 3: 20, 4: 28, 5: 44}  # of the depth, besides those for each row of the table
_EACH = {1: 1, 2: 1, 3: 2, 4: 3, 5: 8}  # for each row
_LEAST = 1e-4  # of the square of a change of log(E)


def depths_for(modulus: Piecewise, q: Array, digits: int) -> tuple[Array, bool]:
    """Depths at which each q divides the half-space, from the surface downwards, `edges` and `even` of `responses`.

    A part of the thickness h, in which log(E) changes by d, has an error like w h d^2, with w = exp(-2 z q).
    Extrapolated it falls with the fourth power of the number of parts: an interval gets parts in proportion to the
    fifth root of this.
    """
    if len(modulus.coefficients) == 1:
        return modulus.start[:, None], True
    # The first interval is what lies above the table.
    none, moduli = q.dtype.type(0.0), modulus.coefficients[0]
    ends, count = jnp.minimum(lax.pad(modulus.start, none, [(1, 0, 0)])[:, None], _DEEP / q), moduli.size
    depth, logs = lax.stop_gradient((ends * q, jnp.log(moduli)))
    change = lax.pad(logs[1:] - logs[:-1], none, [(1, 0, 0)])[:, None]
    top, bottom = depth[:-1], depth[1:]
    weight = -jnp.exp(-2.0 * top) * jnp.expm1(-2.0 * jnp.maximum(bottom - top, 0.0))  # roundings may be negative
    shares = lax.cumsum((weight * (change * change + _LEAST)) ** 0.2)
    more = _PARTS[digits] + (_EACH[digits] - 1) * count
    # The edge at which an interval begins: each has a part at least.
    edge = np.arange(more + count + 1, dtype=q.dtype)[:, None]
    first = jnp.floor(more * shares / shares[-1] + 1e-3) + edge[1 : count + 1]
    first = lax.pad(first, none, [(1, 0, 0), (0, 0, 0)])
    interval = jnp.sum(edge >= first[1:-1, None], 0, dtype=np.uint32)  # none from behind
    # Within an interval parts grow with the modulus and with the depth, by a ratio of linear functions.
    bend = jnp.exp(0.3 * change) * ((1.0 + bottom) / (1.0 + top)) ** 0.6
    both = jnp.stack([ends, first])
    begins = both[:, :-1]
    several = jnp.concatenate([begins, both[:, 1:] - begins, bend[None]])
    begin, start, length, parts, bend = jnp.unstack(several[:, interval, np.arange(q.size, dtype=np.uint32)])
    share = (edge - start) / parts
    return begin + length * share / (share + bend * (1.0 - share)), False


def _layers(between: Callable[[Array, Array], Array], edges: Array, even: bool, q: Array) -> tuple[Array, Array]:
    """(Thicknesses in units of 1/q, one over the moduli) of layers of one modulus each, on axes as of `_MATRICES`.

    Last comes an empty layer of what lies below. Each part has two halves, and the last axis but that of q has two
    divisions: once with the modulus in the middle of the part, the first half empty, and once with that of each half.
    Parts of an `even` modulus need no other division than their own.
    """
    shares = jnp.asarray([[0.0], [1.0]] if even else [[0.0, 0.0], [0.0, 0.5], [1.0, 1.0]], q.dtype)[..., None]
    parts = lax.pad(edges[1:] - edges[:-1], edges.dtype.type(0.0), [(0, 1, 0), (0, 0, 0)])[:, None, None]
    bounds = edges[:, None, None] + shares * parts
    low, high = (x.reshape(-1, 1, 1, 1, *bounds.shape[2:]) for x in (bounds[:, :-1], bounds[:, 1:]))
    h = jnp.minimum((high - low) * q, _THICK)
    return h, jnp.broadcast_to(1.0 / between(low, high), h.shape)


def excess_compliance(modulus: Piecewise, nu: Array, q: Array, digits: int) -> Array:
    """m(q) in G(q) = 2 (1 + m(q))/(E*(0) q), for numbers nu and q of shape (n,).

    Args:
        modulus: Young's modulus, by the depth in the unit of 1/q.
        nu: Poisson's ratio.
        q: Wavenumbers.
        digits: How finely the depth is divided.
    """
    if modulus.start.size == 1:  # a homogeneous half-space
        return jnp.zeros_like(q)
    edges, even = depths_for(modulus, q, digits)
    h, s = _layers(modulus.between, edges, even, q)
    s = modulus.coefficients[0, 0] * s  # mu(0)/mu: no depth is above z = 0
    total = s[0, 0, 0, 0] - _raised(*_layer_matrices(s, nu, h))[0] / (1.0 - nu)
    least, most = total[0], total[-1]
    return most + (most - least) / 3.0 - 1.0


# --- the way up -------------------------------------------------------------------------------------------------------

# Matrices are on two axes after that of the layers. On a third one are those of plane waves, and where they are wanted
# those of waves across, which are numbers: the first of each matrix.


# 1, and parts of matrices: of the compliance without and with nu, of P with what is lost, left and left times h, and of
# Phi.
_MATRICES: Any = np.loadtxt(
    """
    # By rows and columns, of waves in a plane and across it.
    # 11       12       21       22
    1    1     0     0  0     0  1    1
    1    1     -0.5  0  -0.5  0  1    0
    -1   0     1     0  1     0  -1   0
    0.5  0.5   0     0  0     0  0.5  0
    1    0     0     0  0     0  -1   0
    -1   0     -1    0  -1    0  -1   0
    -1   0     -1    0  1     0  1    0
    """.splitlines()
).reshape(7, 2, 2, 2)


def _parts_of_matrices(dtype: Any, planes: int) -> list[Array]:
    """These parts, of plane waves alone or of both."""
    return [jnp.asarray(each[..., :planes, None, None], dtype) for each in _MATRICES]


def _layer_matrices(s: Array, nu: Array, h: Array, planes: int = 1) -> tuple[Array, Array, Array]:
    """Of all layers at once (what each adds to Y, P, Phi), from one over their moduli; the last one is empty."""
    one, own, own_by_nu, of_lost, of_left, of_squared, turn = _parts_of_matrices(h.dtype, planes)
    once = jnp.exp(-h)
    left = once * once * h
    spread = (left * of_left + left * h * of_squared - jnp.expm1(-2.0 * h) * of_lost) / s
    spread = spread * jnp.stack([1.0 / (1.0 - nu), nu.dtype.type(1.0)][:planes])[:, None, None]
    return (own + nu * own_by_nu) * (s - jnp.append(s[1:], s[-1:], 0)), spread, once * (one + h * turn)


def _matrix_product(a: Array, b: Array) -> Array:
    """The product of matrices on the first two axes; XLA has none for many small ones."""
    return jnp.sum(a[:, :, None] * b[None], 1)


def _upwards(step: Array, spread: Array, phi: Array) -> tuple[Array, tuple[Array, Array]]:
    """(Y at the surface, (Y inside each layer at its bottom, what takes tractions from its top to there))."""
    one, *_ = _parts_of_matrices(step.dtype, step.shape[3])

    def through(y: Array, layer: tuple[Array, ...]) -> tuple[Array, tuple[Array, Array]]:
        step, spread, phi = layer
        y = y + step
        rest = one - _matrix_product(spread, y)
        swapped = (2.0 * one - 1.0) * rest[::-1, ::-1].swapaxes(0, 1)  # the adjugate
        down = _matrix_product(swapped, phi.swapaxes(0, 1)) / jnp.sum(rest[0] * swapped[:, 0], 0)
        return _matrix_product(phi, _matrix_product(y, down)), (y, down)

    return lax.scan(through, jnp.zeros_like(spread[0]), (step, spread, phi), reverse=True)


def _tractions_below(tractions: Array, down: Array) -> Array:
    """The tractions at the bottom of each layer, from those at the surface."""

    def lower(tractions: Array, down: Array) -> tuple[Array, Array]:
        below = _matrix_product(down, tractions)
        return below, below

    return lax.scan(lower, tractions, down)[1]


@jax.custom_jvp
def _raised(step: Array, spread: Array, phi: Array) -> Array:
    """Y_22 at the surface."""
    return _upwards(step, spread, phi)[0][1, 1]


@_raised.defjvp
def _raised_jvp(layers: tuple[Array, ...], along: tuple[Array, ...]) -> tuple[Array, Array]:
    """The sum over the layers of w_b' dY w_b + x' dP x + 2 w' dPhi x.

    w = (0, 1) at the surface goes down through each layer as w_b = (1 - P Y)^-1 Phi' w, and x = Y w_b.
    """
    top, (inside, down) = _upwards(*layers)
    begin = jnp.stack([jnp.zeros_like(top[:1, 0]), jnp.ones_like(top[:1, 0])])
    below = _tractions_below(begin, down)
    above = jnp.concatenate([begin[None], below[:-1]])
    x = jnp.sum(inside * below.swapaxes(1, 2), 2, keepdims=True)
    step, spread, phi = along
    moved = below * below.swapaxes(1, 2) * step + x * x.swapaxes(1, 2) * spread + 2.0 * above * x.swapaxes(1, 2) * phi
    return top[1, 1], jnp.sum(moved, (0, 1, 2))


# --- the way down -----------------------------------------------------------------------------------------------------


def responses(
    between: Callable[[Array, Array], Array], edges: Array, even: bool, z: Array, q: Array, nu: Array
) -> Array:
    """How a half-space answers waves of traction of unit amplitude, `docs/explanation/numerics.md`, "Stresses".

    Args:
        between: What counts as E of a thin layer between two depths, or at one, in the unit of 1/q.
        edges: Depths from 0 downwards that divide the half-space, (edges, q) or (edges, 1).
        even: Between them E is constant; else each part is halved, and the result extrapolated.
        z: Depths, (depths,).
        q: Wavenumbers, (n,).
        nu: Poisson's ratio.

    Returns:
        The displacement along the wave times q/(2 (1+nu)), sigma_zz and sigma_sz of normal tractions, the same of
        tractions along the wave, the displacement and sigma_tz of tractions across it, shape (8, depths, n).
    """
    every = jnp.sort(jnp.append(edges, jnp.broadcast_to(z[:, None], (z.size, edges.shape[1])), 0), 0)
    place = jnp.maximum(jnp.sum(every[:, None] < z[:, None], 0), 1)
    h, s = _layers(between, every, even, q)
    _, (inside, down) = _upwards(*_layer_matrices(s, nu, h, planes=2))
    one, own, own_by_nu, *_ = _parts_of_matrices(q.dtype, 2)
    shape = down.shape[1:]
    tractions = _tractions_below(jnp.broadcast_to(one, shape), down)
    last = len(h) // len(every) * place - 1  # the part above each depth
    last = jnp.broadcast_to(last[:, None, None, None, None], (z.size, 1, 1, 1, *shape[3:]))
    compliance, tractions = (
        jnp.take_along_axis(each, last, 0) for each in (inside - (own + nu * own_by_nu) * s, tractions)
    )
    moved = jnp.sum(compliance[:, 0, :, None] * tractions, 1)
    # By the component, the traction that causes it, and the plane.
    found = jnp.stack([moved, tractions[:, 1], tractions[:, 0]]).transpose(0, 2, 3, 1, 4, 5)
    found = found.reshape(12, z.size, *shape[3:])
    found = found[np.array([2, 6, 10, 0, 4, 8, 1, 9])]
    return found[:, :, -1] + (found[:, :, -1] - found[:, :, 0]) / 3.0
