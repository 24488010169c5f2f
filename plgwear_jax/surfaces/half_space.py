"""The compliance G(q) of a half-space of any E(z), from the surface impedance of layers.

In the layer of shear modulus mu the matrix S that takes tractions to displacements differs from that of a half-space of
the same material by Y, which goes upwards through a thickness h in units of 1/q in closed form:

    Y -> Phi X Phi',      X = (Y - det(Y) adj(P))/det(1 - P Y),      Phi = exp(-h) [[1-h, -h], [h, 1+h]],

P = 2 mu/(1-nu) times the integral of exp(-2t) [[(1-t)^2, -(1-t) t], [-(1-t) t, t^2]] over t from 0 to h. It is stable
for every q, thickness and ratio of moduli. Layers of one modulus each are exact. A graded layer is divided, with the
modulus in the middle of each part, into n and into 2n parts, and extrapolated.
"""

from typing import Any, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.special.pchip import Piecewise, horner

# --- the compliance ---------------------------------------------------------------------------------------------------

_DEEP = 12.0  # in units of 1/q: what is below counts by exp(-24)
_THICK = 1e3  # a layer that is thicker in units of 1/q counts as this one
_PARTS = {1: 12, 2: 16, 3: 20, 4: 28, 5: 44}  # of the depth, besides those for each row of the table
_EACH = {1: 1, 2: 1, 3: 2, 4: 3, 5: 8}  # for each row
_LEAST = 1e-4  # of the square of a change of log(E)


def _edges(modulus: Piecewise, q: Array, digits: int) -> tuple[Array, Array]:
    """Depths at which each q divides the half-space, from the surface downwards, shape (edges, q).

    With each comes the number of the interval below it. A part of the thickness h, in which log(E) changes by d, has an
    error like w h d^2, with w = exp(-2 z q). Extrapolated it falls with the fourth power of the number of parts: an
    interval gets parts in proportion to the fifth root of this.
    """
    # The first interval is what lies above the table.
    ends = jnp.minimum(jnp.append(jnp.zeros(1, q.dtype), modulus.start)[:, None], _DEEP / q)
    moduli = modulus.coefficients[0]
    depth, logs = jax.lax.stop_gradient((ends * q, jnp.log(jnp.append(moduli[:1], moduli))[:, None]))
    change, count = jnp.diff(logs, axis=0), moduli.size
    weight = -jnp.exp(-2.0 * depth[:-1]) * jnp.expm1(-2.0 * jnp.maximum(jnp.diff(depth, axis=0), 0.0))
    wanted = (weight * (change * change + _LEAST)) ** 0.2
    shares = jnp.cumsum(wanted, 0)
    more = _PARTS[digits] + (_EACH[digits] - 1) * count
    # The edge at which an interval begins: each has a part at least.
    first = jnp.floor(more * shares / shares[-1] + 1e-3) + np.arange(1, count + 1)[:, None]
    first = jnp.concatenate([jnp.zeros_like(q)[None], first])
    edge = np.arange(more + count + 1)[:, None]
    interval = jnp.minimum(jnp.sum(edge >= first[1:, None], 0), count - 1)
    # Within an interval parts grow with the modulus and with the depth, by a ratio of linear functions.
    bend = jnp.exp(0.3 * change) * ((1.0 + depth[1:]) / (1.0 + depth[:-1])) ** 0.6
    several = ends[:-1], jnp.diff(ends, axis=0), first[:-1], jnp.diff(first, axis=0), bend
    begin, length, start, parts, bend = jnp.stack(several)[:, interval, np.arange(q.size)]
    share = (edge - start) / parts
    return begin + length * share / (share + bend * (1.0 - share)), jnp.maximum(interval - 1, 0)


def _divided(modulus: Piecewise, q: Array, digits: int) -> tuple[Array, Array, Array]:
    """(Thicknesses, moduli, modulus below) of layers of one modulus each, shapes (layers, divisions, q).

    The last division is the finest one; layers of constant modulus need no other than their own.
    """
    if len(modulus.coefficients) == 1:
        own = modulus.coefficients[0][:, None, None]
        return jnp.diff(modulus.start)[:, None, None], own[:-1], own[-1:]
    edges, interval = _edges(modulus, q, digits)
    # Of each layer two halves: once with the modulus in its middle, the first half empty, and once with that of each.
    layer, thick = edges[:-1, None, None], jnp.diff(edges, axis=0)[:, None, None]
    shares, parts = (jnp.asarray(x, q.dtype)[..., None] for x in ([[0.5, 0.25], [0.5, 0.75]], [[0.0, 0.5], [1.0, 0.5]]))
    begin, *powers = jnp.concatenate([modulus.start[None], modulus.coefficients])[:, interval]

    def at(x: Array, which: Any) -> Array:
        return horner([power[which] for power in powers], jnp.maximum(x - begin[which], 0.0))

    shape = (-1, 2, q.size)
    moduli = at(layer + shares * thick, np.index_exp[:-1, None, None]).reshape(shape)
    below = jnp.where(edges[-1] < modulus.start[-1], at(edges[-1], -1), modulus.coefficients[0, -1])
    return (parts * thick).reshape(shape), moduli, below


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
    surface = modulus.coefficients[0, 0]  # no depth is above z = 0
    thick, moduli, below = _divided(modulus, q, digits)
    h = jnp.minimum(thick * q, _THICK)
    s = jnp.broadcast_to(surface / moduli, h.shape)  # mu(0)/mu
    start = jnp.broadcast_to(surface / below, (1, *h.shape[1:]))
    total = s[0] - _raised(*_all_layers(s, start, nu, h)) / (1.0 - nu)
    return total[-1] + (total[-1] - total[0]) / 3.0 - 1.0


def _all_layers(s: Array, start: Array, nu: Array, h: Array) -> tuple[Array, ...]:
    """Of all layers at once what does not depend on those below: the arguments of `_raised`."""
    a, b = 1.0 - nu, 0.5 - nu
    step = s - jnp.concatenate([s[1:], start])
    once, lost, factor = jnp.exp(-h), -jnp.expm1(-2.0 * h), 0.5 / (a * s)
    e = once * once
    p11, p22 = factor * (lost + e * (2.0 * h - 2.0 * h * h)), factor * (lost - e * (2.0 * h + 2.0 * h * h))
    p12 = -factor * (2.0 * h * h * e)
    return a * step, b * step, p11, p12, p22, (1.0 - h) * once, h * once, (1.0 + h) * once


# --- the way up -------------------------------------------------------------------------------------------------------


def _through(y: tuple[Array, ...], layer: tuple[Array, ...]) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """(Y above a layer, Y inside at its bottom), from Y below."""
    along, across, p11, p12, p22, det_p, u, h, v = layer
    # S of a half-space is -s [[a, -b], [-b, a]].
    y11, y12, y22 = y[0] + along, y[1] - across, y[2] + along
    det_y = y11 * y22 - y12 * y12
    over = 1.0 / (1.0 - (p11 * y11 + 2.0 * p12 * y12 + p22 * y22) + det_p * det_y)
    x11, x12, x22 = (y11 - det_y * p22) * over, (y12 + det_y * p12) * over, (y22 - det_y * p11) * over
    above11 = u * u * x11 - 2.0 * u * h * x12 + h * h * x22
    above22 = h * h * x11 + 2.0 * h * v * x12 + v * v * x22
    above12 = u * h * x11 + (u * v - h * h) * x12 - h * v * x22
    return (above11, above12, above22), (y11, y12, y22)


@jax.custom_jvp
def _raised(*layers: Array) -> Array:
    """Y_22 at the surface, from what each layer adds to Y, from P and from Phi, all of shape (layers, ...)."""
    return _all_raised(*layers)[0]


def _all_raised(*layers: Array) -> tuple[Array, tuple[Array, ...]]:
    """(Y_22 at the surface, Y inside each layer at its bottom)."""
    along, across, p11, p12, p22, *phi = layers
    given = along, across, p11, p12, p22, p11 * p22 - p12 * p12, *phi
    none = jnp.zeros_like(along[0])
    # As tuples, not as one array, which each step would take apart and put together again.
    found, inside = jax.lax.scan(_through, (none, none, none), given, reverse=True)
    return found[2], inside


def _lowering(layers: tuple[Array, ...], inside: tuple[Array, ...]) -> tuple[Array, ...]:
    """(1 - P Y)^-1 Phi', which takes tractions from the top of each layer to its bottom."""
    _, _, p11, p12, p22, u, h, v = layers
    y11, y12, y22 = inside
    py11, py12 = p11 * y11 + p12 * y12, p11 * y12 + p12 * y22
    py21, py22 = p12 * y11 + p22 * y12, p12 * y12 + p22 * y22
    over = 1.0 / ((1.0 - py11) * (1.0 - py22) - py12 * py21)
    return (
        ((1.0 - py22) * u - py12 * h) * over,
        ((1.0 - py22) * h + py12 * v) * over,
        (py21 * u - (1.0 - py11) * h) * over,
        (py21 * h + (1.0 - py11) * v) * over,
    )


def _down(w: tuple[Array, Array], matrix: tuple[Array, ...]) -> tuple[tuple[Array, Array], tuple[Array, ...]]:
    below = matrix[0] * w[0] + matrix[1] * w[1], matrix[2] * w[0] + matrix[3] * w[1]
    return below, (*w, *below)


@_raised.defjvp
def _raised_jvp(layers: tuple[Array, ...], along: tuple[Array, ...]) -> tuple[Array, Array]:
    """The sum over the layers of w_b' dY w_b + x' dP x + 2 w' dPhi x.

    w = (0, 1) at the surface goes down through each layer as w_b = (1 - P Y)^-1 Phi' w, and x = Y w_b.
    """
    found, inside = _all_raised(*layers)
    y11, y12, y22 = inside
    matrix = _lowering(layers, inside)

    begin = jnp.zeros_like(found), jnp.ones_like(found)
    w1, w2, b1, b2 = jax.lax.scan(_down, begin, matrix)[1]
    x1, x2 = y11 * b1 + y12 * b2, y12 * b1 + y22 * b2
    factors = (
        b1 * b1 + b2 * b2,
        -2.0 * b1 * b2,
        x1 * x1,
        2.0 * x1 * x2,
        x2 * x2,
        2.0 * w1 * x1,
        2.0 * (w2 * x1 - w1 * x2),
        2.0 * w2 * x2,
    )
    return found, sum((jnp.sum(factor * by, 0) for factor, by in zip(factors, along, strict=True)), 0.0 * found)


# --- the way down -----------------------------------------------------------------------------------------------------


class Modulus(Protocol):
    """E(z) in any unit."""

    def between(self, x: Array, y: Array, /) -> Array:
        """What counts as E of a thin layer between two depths, or at one."""
        ...


def depths_for(modulus: Piecewise, q: Array, digits: int) -> tuple[Array, bool]:
    """`edges` and `even` of `responses`."""
    if len(modulus.coefficients) == 1:
        return modulus.start[:, None], True
    return _edges(modulus, q, digits)[0], False


def _layer_matrices(dtype: Any) -> list[Array]:
    """Of plane waves, and of those across the wave as the first of two numbers on a third axis: 1, parts of matrices.

    These are of Y less the compliance without and with nu, of P with what is lost, left and left times h, and of Phi.
    """
    own, own_by_nu, lost, left, squared, turn = np.zeros((6, 2, 2, 2))
    own[..., 0], own[0, 0, 1], own_by_nu[..., 0] = [[1.0, -0.5], [-0.5, 1.0]], 1.0, [[-1.0, 1.0], [1.0, -1.0]]
    lost[..., 0], lost[0, 0, 1], left[..., 0] = 0.5 * np.eye(2), 0.5, [[1.0, 0.0], [0.0, -1.0]]
    squared[..., 0], turn[..., 0] = -1.0, [[-1.0, -1.0], [1.0, 1.0]]
    one = np.stack([np.eye(2)] * 2, -1)
    return [jnp.asarray(each[..., None, None], dtype) for each in (one, own, own_by_nu, lost, left, squared, turn)]


def _matrix_product(a: Array, b: Array) -> Array:
    """The product of matrices on the first two axes; XLA has none for many small ones."""
    return jnp.sum(a[:, :, None] * b[None], 1)


def responses(modulus: Modulus, edges: Array, even: bool, z: Array, q: Array, nu: Array) -> Array:
    """How a half-space answers waves of traction of unit amplitude, `docs/explanation/numerics.md`, "Stresses".

    Args:
        modulus: Young's modulus by the depth in the unit of 1/q.
        edges: Depths from 0 downwards that divide the half-space, (edges, q) or (edges, 1).
        even: Between them E is constant; else each part is halved, and the result extrapolated.
        z: Depths, (depths,).
        q: Wavenumbers, (n,).
        nu: Poisson's ratio.

    Returns:
        The displacement along the wave times q/(2 (1+nu)), sigma_zz and sigma_sz of normal tractions, the same of
        tractions along the wave, the displacement and sigma_tz of tractions across it, shape (8, depths, n).
    """
    every = jnp.sort(jnp.concatenate([edges, jnp.broadcast_to(z[:, None], (z.size, edges.shape[1]))]), 0)
    place = jnp.maximum(jnp.sum(every[:, None] < z[:, None], 0), 1)
    # Of each part the ends of its halves, the first half once empty.
    shares = jnp.asarray([[0.0], [1.0]] if even else [[0.0, 0.0], [0.0, 0.5], [1.0, 1.0]], q.dtype)[..., None]
    bounds = every[:-1, None, None] + shares * jnp.diff(every, axis=0)[:, None, None]
    low, high = (x.reshape(-1, 1, 1, 1, *bounds.shape[2:]) for x in (bounds[:, :-1], bounds[:, 1:]))
    h = jnp.minimum((high - low) * q, _THICK)
    s = jnp.broadcast_to(1.0 / modulus.between(low, high), h.shape)
    below = jnp.broadcast_to(1.0 / modulus.between(every[-1], every[-1]), (1, *h.shape[1:]))

    one, own, own_by_nu, of_lost, of_left, of_squared, turn = _layer_matrices(q.dtype)
    once, own = jnp.exp(-h), own + nu * own_by_nu
    left = once * once * h
    spread = (left * of_left + left * h * of_squared - jnp.expm1(-2.0 * h) * of_lost) / s
    spread = spread * jnp.stack([1.0 / (1.0 - nu), jnp.ones_like(nu)])[:, None, None]
    layers = own * (s - jnp.append(s[1:], below, 0)), spread, once * (one + h * turn)

    def through(y: Array, layer: tuple[Array, ...]) -> tuple[Array, tuple[Array, Array]]:
        """(Y above a layer, (Y at its bottom, what takes tractions from its top to there)), from Y below it."""
        step, spread, phi = layer
        y = y + step
        rest = one - _matrix_product(spread, y)
        swapped = sign * rest[::-1, ::-1].swapaxes(0, 1)  # the adjugate
        down = _matrix_product(swapped, phi.swapaxes(0, 1)) / (rest[0, 0] * rest[1, 1] - rest[0, 1] * rest[1, 0])
        return _matrix_product(phi, _matrix_product(y, down)), (y, down)

    def lower(tractions: Array, down: Array) -> tuple[Array, Array]:
        below = _matrix_product(down, tractions)
        return below, below

    shape, sign = layers[1].shape[1:], 2.0 * one - 1.0
    _, (inside, down) = jax.lax.scan(through, jnp.zeros(shape, h.dtype), layers, reverse=True)
    _, tractions = jax.lax.scan(lower, jnp.broadcast_to(one, shape), down)
    last = (shares.shape[0] - 1) * place - 1  # the part above each depth
    last = jnp.broadcast_to(last[:, None, None, None, None], (z.size, 1, 1, 1, *shape[3:]))
    compliance, tractions = (jnp.take_along_axis(each, last, 0) for each in (inside - own * s, tractions))
    moved = jnp.sum(compliance[:, 0, :, None] * tractions, 1)
    # By the component, the traction that causes it, and the plane.
    found = jnp.stack([moved, tractions[:, 1], tractions[:, 0]]).transpose(0, 2, 3, 1, 4, 5)
    found = found.reshape(12, z.size, *shape[3:])
    found = found[np.array([2, 6, 10, 0, 4, 8, 1, 9])]
    return found[:, :, -1] + (found[:, :, -1] - found[:, :, 0]) / 3.0
