"""The compliance G(q) of a half-space with any E(z), from the surface impedance of layers.

In the layer of shear modulus mu the matrix S that takes tractions to displacements differs from that of a half-space of
the same material by Y, which goes upwards through a thickness h in units of 1/q in closed form:

    Y -> Phi (Y - det(Y) adj(P))/(1 - tr(P Y) + det(P) det(Y)) Phi',      Phi = exp(-h) [[1-h, -h], [h, 1+h]],

P = 2 mu/(1-nu) times the integral of exp(-2t) [[(1-t)^2, -(1-t) t], [-(1-t) t, t^2]] over t from 0 to h. It is stable
for every q, thickness and ratio of moduli. A graded layer is divided, with the modulus in the middle of each part, into
n and into 2n parts, and extrapolated.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.surfaces.pchip import Cubic

__all__ = ["excess_compliance"]

_DEEP = 12.0  # in units of 1/q: what is below counts by exp(-24)
_PARTS = {1: 12, 2: 16, 3: 20, 4: 24, 5: 32}
_EACH = {1: 1, 2: 2, 3: 3, 4: 4, 5: 6}  # parts of the distance between two points, if there are few of them


def _edges(cubic: Cubic, q: Array, digits: int) -> Array:
    """Depths at which each q divides the half-space, from the surface downwards, shape (q, edges)."""
    count = cubic.start.size - 1
    parts = max(1, min(_EACH[digits], 64 // count))
    share = jnp.asarray(np.arange(parts) / parts, q.dtype)
    inner = cubic.start[:-1, None] + jnp.diff(cubic.start)[:, None] * share
    own = jnp.concatenate([inner.ravel(), cubic.start[-1:]])
    near = jnp.asarray(_DEEP * np.linspace(0.0, 1.0, _PARTS[digits] + 1) ** 2, q.dtype) / q[:, None]
    end = jnp.minimum(cubic.start[-1], _DEEP / q)[:, None]
    both = jnp.concatenate([jnp.broadcast_to(own, (q.size, own.size)), near], -1)
    return jnp.sort(jnp.minimum(both, end), -1)


def excess_compliance(cubic: Cubic, nu: Array, q: Array, digits: int) -> Array:
    """m(q) in G(q) = 2 (1 + m(q))/(E*(0) q), for numbers nu and q of shape (n,).

    Args:
        cubic: Young's modulus, by the depth in the unit of 1/q.
        nu: Poisson's ratio.
        q: Wavenumbers.
        digits: How finely the depth is divided.
    """
    edges = _edges(cubic, q, digits)
    top, bottom = edges[:, :-1], edges[:, 1:]
    middle, surface = 0.5 * (top + bottom), cubic.at(jnp.zeros_like(nu))
    # Of each layer two halves: once with the modulus in its middle and once with that in the middle of each half.
    places = jnp.stack([0.5 * (top + middle), middle, 0.5 * (middle + bottom)])
    soft = surface / cubic.at(places)  # mu(0)/mu
    coarse, fine = jnp.stack([soft[1], soft[1]], -1), jnp.stack([soft[0], soft[2]], -1)
    softness = jnp.stack([coarse, fine]).reshape(2, q.size, -1)
    half = 0.5 * (bottom - top) * q[:, None]
    whole = jnp.stack([jnp.stack([0.0 * half, 2.0 * half], -1), jnp.stack([half, half], -1)]).reshape(softness.shape)
    a, b = 1.0 - nu, 0.5 - nu

    # Of all layers at once what does not depend on those below.
    h, s = (jnp.moveaxis(x, -1, 0) for x in (whole, softness))
    start = jnp.broadcast_to((surface / cubic.at(edges[:, -1]))[None, None], (1, 2, q.size))
    step = s - jnp.concatenate([s[1:], start])
    once, lost, factor = jnp.exp(-h), -jnp.expm1(-2.0 * h), 0.5 / (a * s)
    e = once * once
    p11, p22 = factor * (lost + e * (2.0 * h - 2.0 * h * h)), factor * (lost - e * (2.0 * h + 2.0 * h * h))
    p12 = -factor * (2.0 * h * h * e)
    p = p11, p12, p22, p11 * p22 - p12 * p12
    phi = (1.0 - h) * once, h * once, (1.0 + h) * once

    # As tuples, not as one array, which each step would take apart and put together again.
    def rise(below: tuple[Array, ...], layer: tuple[Array, ...]) -> tuple[tuple[Array, ...], None]:
        along, across, p11, p12, p22, det_p, u, h, v = layer
        # S of a half-space is -s [[a, -b], [-b, a]].
        y11, y12, y22 = below[0] + along, below[1] - across, below[2] + along
        det_y = y11 * y22 - y12 * y12
        over = 1.0 / (1.0 - (p11 * y11 + 2.0 * p12 * y12 + p22 * y22) + det_p * det_y)
        x11, x12, x22 = (y11 - det_y * p22) * over, (y12 + det_y * p12) * over, (y22 - det_y * p11) * over
        y11 = u * u * x11 - 2.0 * u * h * x12 + h * h * x22
        y22 = h * h * x11 + 2.0 * h * v * x12 + v * v * x22
        y12 = u * h * x11 + (u * v - h * h) * x12 - h * v * x22
        return (y11, y12, y22), None

    none = jnp.zeros((2, q.size), q.dtype)
    found, _ = jax.lax.scan(rise, (none, none, none), (a * step, b * step, *p, *phi), reverse=True)
    total = s[0] - found[2] / a
    return (4.0 * total[1] - total[0]) / 3.0 - 1.0
