"""The worn ring beside the stick area: what gap there is, by Abel's integral, where it ends and what it holds.

In T = (r/c)^2, y = T - 1 and heights in c^2/R, with v of `compliance`,

    depth(Y) = sin(pi a)/pi * integral over T from 1 to Y of T^(a-1) (Y-T)^-a D(T),      D(T) = d - G(T) - v(T),

as the same integral from 0 to 1 is that of the contact itself, where nothing is left over.
"""

import functools
import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.shapes.shape import Image, Outline, inwards
from plgwear_jax.special.elementary import clamped, crest, top_of
from plgwear_jax.special.quadrature import Rule, logistic, pieces
from plgwear_jax.special.root import root_of
from plgwear_jax.surfaces.compliance import Compliance, Graded, OnePower
from plgwear_jax.surfaces.effort import Effort, rule_of
from plgwear_jax.surfaces.punch import Punch, grown, on_the_law, punch_under, resolved

_NEAREST, _FARTHEST, _STEP = -36.0, 10.0, 0.5  # of log(y)
_FURTHER = 3  # nodes
_TAPS = 10
_MIDDLE = 0.5 * (_TAPS - 1)


@functools.cache
def _nodes() -> np.ndarray:
    return np.arange(_NEAREST, _FARTHEST + _STEP, _STEP)


@functools.cache
def _to_powers() -> np.ndarray:
    """From values at neighbouring nodes to the polynomial through them, in powers of the distance from their middle."""
    return np.linalg.inv(np.vander(np.arange(_TAPS) - _MIDDLE, increasing=True)).T


class Lack(NamedTuple):
    """D(T) = level - (G(T) - G(1)) - v."""

    level: Array
    image: Image  # G
    v: Array | None  # at the nodes in log(y); None if it is 0

    @property
    def near(self) -> Array:
        """D next to T = 1."""
        return self.level if self.v is None else self.level - self.v[0]

    def rule(self, effort: Effort) -> Rule:
        """The rule of integrals over D."""
        return rule_of(effort, self.v is None, len(self.image.bends))

    def at(self, y: Array) -> Array:
        """D at T = 1 + y."""
        found = self.level - self.image.fallen(y)
        return found if self.v is None else found - between(self.v, y)


def between(v: Array, y: Array) -> Array:
    """From values at the nodes to those at y, by polynomials in log(y)."""
    which, weights = _around(y)
    return jnp.sum(v[which] * weights, -1)


def _around(y: Array) -> tuple[Array, Array]:
    """(The nodes around y, their weights), each of shape (m, taps)."""
    last = _nodes().size - _TAPS
    place = clamped(0.0, (jnp.log(y) - _NEAREST) / _STEP, _nodes().size - 1.0)
    first = jnp.floor(clamped(0.0, jax.lax.stop_gradient(place) + (1 - _TAPS // 2), last))
    part = (place - (first + _MIDDLE))[:, None]
    powers, square = jnp.concatenate([jnp.ones_like(part), part], 1), part * part
    fourth = jnp.concatenate([powers, square * powers], 1)
    eighth = square * square
    powers = jnp.concatenate([fourth, eighth * fourth, eighth * eighth * powers], 1)
    which = first.astype(int)[:, None] + np.arange(_TAPS)
    return which.astype(np.uint32), powers @ jnp.asarray(_to_powers().T, y.dtype)


def _between_nodes(y: Array) -> Array:
    """The matrix from v at the nodes to v at y, of shape (m, nodes)."""
    which, weights = _around(y)
    return jnp.sum(jnp.where(which[:, :, None] == np.arange(_nodes().size), weights[:, :, None], 0.0), 1)


class Beside(NamedTuple):
    """v beside the contact of fixed radius."""

    a: Array
    flat: Array | None  # of the flat punch
    own: Array | None  # of the indenter that touches up to c and no further, less what it is at c
    image: Image  # what Abel's integral takes to the indenter

    def lack(self, further: Array) -> Lack:
        """D of the indenter pressed in further than it touches so, in c^2/R."""
        v = None if self.flat is None or self.own is None else further * self.flat + self.own
        return Lack(further, self.image, v)


def beside(compliance: Compliance, punch: Punch, effort: Effort, outline: Outline) -> Beside:
    """v of both."""
    c, a = jnp.exp(punch.log_c), compliance.abel
    image, depth = outline.image(c, a), punch.depth
    if isinstance(compliance, OnePower) or punch.flat is None or punch.bowl is None:
        return Beside(a, None, None, image)
    y = jnp.exp(jnp.asarray(_nodes(), c.dtype))
    both = jnp.stack([punch.flat, depth * punch.flat - punch.bowl], -1)
    if isinstance(compliance, Graded):
        law = on_the_law(compliance, punch, effort, outline)
        first, v = compliance.beside_edge(c, y, both, law, len(image.bends), effort)
        return Beside(a, first[0] + v[:, 0], v[:, 1], image)
    # Nearer to c than the pressures resolve, both gaps go as at the edge of a half-plane. Where the slope of the
    # indenter jumps its depth has fewer digits, which count less further out.
    count = int(np.sum(_nodes() < -2.0 * math.log(effort.modes)))
    begin = count if resolved(image) else count + _FURTHER
    v, fallen = compliance.beside(c, y[count:], both, effort), image.fallen(y)
    flat, own = 1.0 - v[:, 0], fallen[begin:] - depth + image.first + v[begin - count :, 1]
    edge, mean = compliance.edge(c, _nodes()[: begin + 1])
    y = y[: begin + 1]
    known = jnp.maximum(y, jnp.finfo(c.dtype).eps ** 0.5)  # where G has risen by more than its roundings
    mean = y * mean * (image.fallen(known) / known)
    size = flat[0] / edge[count]
    near = own[0] / mean[-1] * mean
    if not resolved(image):
        further = 2.0 * (_nodes()[begin] - _nodes()[begin:])
        near = size * grown(compliance, punch, effort, outline, image) * mean
        own = own * (1.0 + (near[-1] / own[0] - 1.0) * jnp.exp(jnp.asarray(further, c.dtype)))
    flat, own = jnp.append(size * edge[:count], flat), jnp.append(near[:-1], own)
    return Beside(a, 1.0 - flat, own - fallen, image)


def sine_of(a: Array) -> Array:
    """sin(pi a)/pi."""
    return jnp.sin(jnp.pi * (1.0 - a)) / jnp.pi


def _counts(a: Array, y: Array, lack: Lack, effort: Effort) -> tuple[Array, Array]:
    """Places between 0 and a number y, the last one y, and how much D counts there, (2, places).

    It counts for the depth at y, and for the integral of the depth over T up to 1 + y.
    """
    rule = pieces(lack.image.bends / y, a, lack.rule(effort))
    places, (weight, last) = jnp.append(y * rule.x, y), rule.singular(1.0 - a)
    further = jnp.append(y / (1.0 - a) * rule.left * weight, 0.0)
    front = sine_of(a) * jnp.exp((1.0 - a) * jnp.log(y) + (a - 1.0) * jnp.log1p(places))
    return places, front * jnp.stack([jnp.append(weight, last), further])


def depth_beside(lack: Lack, a: Array, y: Array, effort: Effort) -> Array:
    """The depth at a number y."""
    places, own = _counts(a, y, lack, effort)
    return own[0] @ lack.at(places)


def sunk_beside(
    compliance: Compliance, punch: Punch, around: Beside, further: Array, y: Array, outline: Outline, effort: Effort
) -> Array:
    """The displacements in c^2/R at T = 1 + y beside the contact, shape (m,), pressed in further than it touches.

    They are Abel's integral of v from 0 on, which is d - G(T) under the contact. Far away little is left of the depth.
    """
    a, image, lack, log_c = around.a, around.image, around.lack(further), punch.log_c
    level, known = punch.depth - image.first, jnp.minimum(y, math.exp(_FARTHEST))
    under = pieces(inwards(outline.kinks, jnp.exp(log_c))[::-1], a, logistic(200, 46.0))  # over x = 1 - T
    weight, last = under.singular(a)
    weight = weight * (level + further - image.fallen(-jnp.minimum(under.x, 1.0 - jnp.finfo(a.dtype).eps)))

    def at(y: Array) -> Array:
        sunk = weight @ jnp.exp(-a * jnp.log(y + under.x))
        sunk = sine_of(a) * (sunk + last * (punch.depth + further) * jnp.exp(-a * jnp.log1p(y)))
        if lack.v is None:
            return sunk
        places, (own, _) = _counts(a, y, lack, effort)
        return sunk + own @ (level + between(lack.v, places))

    sunk, log_r, log_last = jax.lax.map(jax.checkpoint(at), known), *(log_c + 0.5 * jnp.log1p(x) for x in (y, known))
    return sunk * jnp.exp(compliance.far(log_r) - compliance.far(log_last))


class Ring(NamedTuple):
    """The worn ring as a whole."""

    log_y: Array  # at the outer edge, where the depth is 0 again
    volume: Array  # the integral of the depth over T


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def ring_of(effort: Effort, lack: Lack, a: Array) -> Ring:
    """The ring of what is lacking."""
    start = jnp.log(jnp.maximum(lack.near / lack.image.fall, float(jnp.finfo(a.dtype).eps)))

    def excess(log_y: Array) -> Array:
        places, (own, _) = _counts(a, jnp.exp(log_y), lack, effort)
        return -(own @ lack.at(places)) / (jnp.sum(own) * lack.image.fall * jnp.exp(start))

    log_y = root_of(excess, start, 1.0, 1.0)
    places, (_, own) = _counts(a, jnp.exp(log_y), lack, effort)
    return Ring(log_y, own @ lack.at(places))


@ring_of.defjvp
def _ring_of_jvp(effort: Effort, primals: Any, tangents: Any) -> tuple[Ring, Ring]:
    # Depth and volume are sums over D at places that move with the edge, where the depth stays 0.
    (lack, a), (dlack, da) = primals, tangents
    ring = ring_of(effort, lack, a)

    def sums(log_y: Array) -> tuple[Array, tuple[Array, ...]]:
        places, own = _counts(a, jnp.exp(log_y), lack, effort)
        found = lack.at(places)
        return own @ found, (places, own, found)

    _, by_y, (places, own, found) = jax.jvp(sums, (ring.log_y,), (jnp.ones_like(a),), has_aux=True)
    _, counts = jax.jvp(lambda a: _counts(a, jnp.exp(ring.log_y), lack, effort)[1], (a,), (da,))
    _, fallen = jax.jvp(lambda image: image.fallen(places), (lack.image,), (dlack.image,))
    held = own @ (dlack.level - fallen) + counts @ found
    if lack.v is not None:
        held = held - (own @ _between_nodes(places)) @ dlack.v
    moved = -held[0] / by_y[0]
    return ring, Ring(moved, held[1] + by_y[1] * moved)


# Of the depths that are compared, see `deepest`, and around the top of these.
_PLACES, _CLOSER = np.linspace(0.0, 1.0, 26)[1:-1], np.array([-0.004, 0.0, 0.004])


def deepest(lack: Lack, a: Array, end: Array, effort: Effort) -> Array:
    """The largest depth in a ring that ends at y = end."""

    def depths_at(places: Array) -> Array:
        # In a wide ring it is at a power of the radius of the end, and towards either end for |k| -> 1.
        y = jnp.expm1(places * places * (3.0 - 2.0 * places) * jnp.log1p(end))
        return jax.vmap(lambda y: depth_beside(lack, a, y, effort))(y)

    places, near = jnp.asarray(_PLACES, a.dtype), jnp.asarray(_CLOSER, a.dtype)
    # Once more, nearer to the top, and there by a parabola: it has the second derivatives of a top that moves.
    around = top_of(places, depths_at(places)) + near
    top = top_of(around, depths_at(around))
    return crest(depths_at(jax.lax.stop_gradient(top + near)))


# --- the contact unworn and worn --------------------------------------------------------------------------------------


class Worn(NamedTuple):
    """The contact before any wear, and its steady state; heights in c^2/R."""

    unworn: Punch
    punch: Punch  # of the stick area
    further: Array  # d_inf less the depth of `punch`
    beside: Beside
    y: Array  # of the outer edge
    volume: Array  # over c^4/R


def worn(compliance: Compliance, load: Array, phi: Array, effort: Effort, outline: Outline) -> Worn:
    """Both states of numbers, under a load F_N R."""
    loads = jnp.stack([load, (1.0 - phi) * load])
    both = jax.vmap(lambda load: punch_under(effort, compliance, load, outline))(loads)
    unworn, punch = jax.tree.transpose(jax.tree.structure(both), None, jax.tree.map(jnp.unstack, both))
    return Worn(unworn, punch, *ring_around(compliance, punch, phi, effort, outline))


def ring_around(
    compliance: Compliance, punch: Punch, phi: Array, effort: Effort, outline: Outline
) -> tuple[Array, Beside, Array, Array]:
    """The fields of `Worn` from `further` on, of a stick area."""
    # The force of the unworn indenter with this radius is (1 - phi) F_N.
    rise, worn = punch.force / punch.stiffness, phi > 0.0
    further = rise * phi / (1.0 - phi)
    v = beside(compliance, punch, effort, outline)
    # Without an amplitude there is no ring; a narrow one tells how rings begin.
    few = 4096.0 * float(jnp.finfo(phi.dtype).eps)
    ring = ring_of(effort, v.lack(jnp.where(worn, further, few * rise)), v.a)
    y, volume = jnp.exp(ring.log_y) * jnp.where(worn, 1.0, phi / few), jnp.where(worn, jnp.pi * ring.volume, 0.0 * phi)
    return further, v, y, volume
