"""The worn ring beside the stick area: what gap there is, by Abel's integral, where it ends and what it holds.

In T = (r/c)^2, y = T - 1 and heights in c^2/R, with v of `punch`,

    depth(Y) = sin(pi a)/pi * integral over T from 1 to Y of T^(a-1) (Y-T)^-a D(T),      D(T) = d - G(T) - v(T),

as the same integral from 0 to 1 is that of the contact itself, where nothing is left over.

In cells of constant pressure, areas in T and pressures in Pa, the ring deforms under its pressures by

    H - A p,      A = A_fixed + (pi c^2/K) e e',

A_fixed at a held depth of the indenter, e the gap that a flat punch of the radius c leaves and K its stiffness.
Pressures inside c are eliminated: there the surfaces touch and no shape changes. `docs/explanation/numerics.md` has the
equations.
"""

import functools
import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import record, static
from plgwear_jax._core.startup.programs import moved_along
from plgwear_jax.shapes.shape import AbelTransform, inwards
from plgwear_jax.special.cholesky import solve_symmetric
from plgwear_jax.special.elementary import clamp_keep_slope, clamped, crest, in_dtype, top_of, value_with_slope
from plgwear_jax.special.quadrature import logistic, pieces
from plgwear_jax.special.root import root_of

from .cells import RingCells
from .punch import Bodies, Punch, punch_under

_NEAREST, _FARTHEST, _STEP = -36.0, 10.0, 0.5  # of log(y)
RING_NODES = np.arange(_NEAREST, _FARTHEST + _STEP, _STEP)
FEW_KINKS = 4  # with 40 of them the places of all radii at once would be 36 GB
_TAPS = 10
_MIDDLE = 0.5 * (_TAPS - 1)
# From values at neighbouring nodes to the polynomial through them, in powers of the distance from their middle.
_TO_POWERS = np.linalg.inv(np.vander(np.arange(_TAPS) - _MIDDLE, increasing=True))


@record
class DepthDeficit:
    """D(T) = level - (G(T) - G(1)) - v."""

    level: Array
    image: AbelTransform  # G
    v: Array | None  # at the nodes in log(y); None if it is 0
    a: Array  # the exponent of Abel's integral
    nodes: int = static()  # of integrals where v is not 0

    @property
    def near(self) -> Array:
        """D next to T = 1."""
        return self.level if self.v is None else self.level - self.v[0]

    def at(self, y: Array) -> Array:
        """D at T = 1 + y."""
        found = self.level - self.image.fallen(y)
        return found if self.v is None else found - between(self.v, y)

    def depth(self, y: Array) -> Array:
        """The depth at a number y."""
        places, own, _ = _counts(self, y)
        return own @ self.at(places)


def between(v: Array, y: Array) -> Array:
    """From values at the nodes, along a last axis, to those at y, by polynomials in log(y)."""
    which, weights = _around(y)
    return jnp.sum(v[..., which] * weights, -1)


def _around(y: Array) -> tuple[Array, Array]:
    """(The nodes around y, their weights), each of shape (m, taps)."""
    place = clamped(0.0, (jnp.log(y) - _NEAREST) / _STEP, RING_NODES.size - 1.0)
    first = jnp.floor(clamped(0.0, lax.stop_gradient(place) + (1 - _TAPS // 2), RING_NODES.size - _TAPS))
    part = (place - (first + _MIDDLE))[:, None]
    which = first.astype(np.uint32)[:, None] + np.arange(_TAPS, dtype=np.uint32)
    return which, part ** np.arange(_TAPS) @ jnp.asarray(_TO_POWERS, y.dtype)


@record
class RingDisplacement:
    """v beside the contact of fixed radius."""

    a: Array
    image: AbelTransform  # what Abel's integral takes to the indenter
    nodes: int = static()  # of integrals
    flat: Any = None  # of the flat punch
    own: Any = None  # of the indenter that touches up to c and no further, less what it is at c

    def deficit(self, further: Array) -> DepthDeficit:
        """D of the indenter pressed in further than it touches so, in c^2/R."""
        v = None if self.flat is None else further * self.flat + self.own
        return DepthDeficit(further, self.image, v, self.a, self.nodes)


def sine_of(a: Array) -> Array:
    """sin(pi a)/pi."""
    return jnp.sin(jnp.pi * (1.0 - a)) / jnp.pi


def _counts(deficit: DepthDeficit, y: Array) -> tuple[Array, Array, Array]:
    """Places between 0 and a number y, the last one y, and how much D counts there, each of shape (places,).

    It counts for the depth at y, and for the integral of the depth over T up to 1 + y.
    """
    a, kinks = deficit.a, deficit.image.kink_positions
    # Of a power law alone, whose integrands are known to all digits, the rule goes as far as these do.
    alone = (160, 36.0) if len(kinks) < FEW_KINKS else (100, 26.0)
    rule = pieces(kinks / y, a, logistic(*alone) if deficit.v is None else logistic(deficit.nodes))
    power = 1.0 - a
    weights = lax.pad(*rule.singular(power), [(0, 1, 0)])
    x, left = (lax.pad(each, y.dtype.type(end), [(0, 1, 0)]) for each, end in ((rule.x, 1.0), (rule.left, 0.0)))
    places = y * x
    weights = sine_of(a) * jnp.exp(power * (jnp.log(y) - jnp.log1p(places))) * weights
    return places, weights, weights * left * (y / power)


def sunk_beside(bodies: Bodies, punch: Punch, around: RingDisplacement, further: Array, y: Array) -> Array:
    """The displacements in c^2/R at T = 1 + y beside the contact, shape (m,), pressed in further than it touches.

    They are Abel's integral of v from 0 on, which is d - G(T) under the contact. Far away little is left of the depth.
    """
    a, image, deficit = around.a, around.image, around.deficit(further)
    level, known = punch.depth - image.first, jnp.minimum(y, math.exp(_FARTHEST))
    under = pieces(inwards(bodies.outline.shape.corners, punch.c)[::-1], a, logistic(200, 46.0))  # over x = 1 - T
    weight, last = under.singular(a)
    weight = weight * (level + further - image.fallen(-jnp.minimum(under.x, 1.0 - jnp.finfo(a.dtype).eps)))

    def at(y: Array) -> Array:
        sunk = weight @ jnp.exp(-a * jnp.log(y + under.x))
        sunk = sine_of(a) * (sunk + last * (punch.depth + further) * jnp.exp(-a * jnp.log1p(y)))
        if deficit.v is None:
            return sunk
        places, own, _ = _counts(deficit, y)
        return sunk + own @ (level + between(deficit.v, places))

    here, beyond = (bodies.far(punch.log_c + 0.5 * jnp.log1p(x)) for x in (known, y))
    return lax.map(jax.checkpoint(at), known) * jnp.exp(beyond - here)


class Ring(NamedTuple):
    """The worn ring as a whole."""

    log_y: Array  # at the outer edge, where the depth is 0 again
    volume: Array  # the integral of the depth over T


@jax.custom_jvp
def ring_of(deficit: DepthDeficit) -> Ring:
    """The ring of what is lacking."""
    near: Any = np.full(1, 0.01, deficit.a.dtype)
    (fall,) = deficit.image.fallen(near) / near  # about the slope of G at T = 1
    start = jnp.log(jnp.maximum(deficit.near / fall, jnp.finfo(near.dtype).eps))

    def excess(log_y: Array) -> Array:
        places, own, _ = _counts(deficit, jnp.exp(log_y))
        return -(own @ deficit.at(places)) / (jnp.sum(own) * fall * jnp.exp(start))

    log_y = root_of(excess, start, 1.0, 1.0)
    places, _, own = _counts(deficit, jnp.exp(log_y))
    return Ring(log_y, own @ deficit.at(places))


@functools.partial(ring_of.defjvp, symbolic_zeros=True)
def _ring_of_jvp(primals: Any, tangents: Any) -> tuple[Ring, Ring]:
    # Depth and volume are sums over D at places that move with the edge, where the depth stays 0.
    def sums(deficit: DepthDeficit, log_y: Array) -> Array:
        places, *own = _counts(deficit, jnp.exp(log_y))
        return jnp.stack(own) @ deficit.at(places)

    (deficit,), ring = primals, ring_of(*primals)
    log_y = ring.log_y
    _, by_y = value_with_slope(functools.partial(sums, deficit), log_y)
    _, held = moved_along(lambda deficit: sums(deficit, log_y), primals, tangents)
    moved = -held[0] / by_y[0]
    return ring, Ring(moved, held[1] + by_y[1] * moved)


# Of the depths that are compared, see `deepest`, and around the top of these.
_PLACES, _CLOSER = np.linspace(0.0, 1.0, 26)[1:-1], np.array([-0.004, 0.0, 0.004])


def deepest(deficit: DepthDeficit, end: Array) -> Array:
    """The largest depth in a ring that ends at y = end."""

    def depths_at(places: Array) -> Array:
        # In a wide ring it is at a power of the radius of the end, and towards either end for |k| -> 1.
        y = jnp.expm1(places * places * (3.0 - 2.0 * places) * jnp.log1p(end))
        return jax.vmap(deficit.depth)(y)

    places, near = in_dtype(end.dtype, _PLACES, _CLOSER)
    # Once more, nearer to the top, and there by a parabola: it has the second derivatives of a top that moves.
    around = top_of(places, depths_at(places)) + near
    top = top_of(around, depths_at(around))
    return crest(depths_at(lax.stop_gradient(top + near)))


# --- the contact unworn and worn --------------------------------------------------------------------------------------


@record
class Worn:
    """The contact before any wear, and its steady state; heights in c^2/R."""

    bodies: Bodies
    unworn: Punch  # of the radius a_0
    punch: Punch  # of the radius c, that of the stick area
    further: Array  # d_inf less the depth of `punch`
    beside: RingDisplacement  # of the radius c
    end: Array  # y of the outer edge of the worn ring
    volume: Array  # over c^4/R

    @property
    def c(self) -> Array:
        """The stick radius in m."""
        return self.punch.c

    def height(self, punch: Punch) -> Array:
        """c^2/R."""
        return jnp.exp(2.0 * punch.log_c) / self.bodies.outline.radius

    @property
    def width(self) -> Array:
        """That of the unworn ring: a difference of r^2 over c^2."""
        return jnp.expm1(2.0 * (self.unworn.log_c - self.punch.log_c))

    @property
    def widths(self) -> tuple[Array, Array]:
        """(That width, the width of the final ring less it)."""
        width = self.width
        return width, jnp.maximum(self.end - width, 16.0 * jnp.finfo(width.dtype).eps * width)


def worn(bodies: Bodies, load: Array, phi: Array) -> Worn:
    """Both states of numbers, under a load F_N R."""
    both = jax.vmap(functools.partial(punch_under, bodies))(jnp.stack([load, (1.0 - phi) * load]))
    unworn, punch = jax.tree.transpose(jax.tree.structure(both), None, jax.tree.map(jnp.unstack, both))
    # The force of the unworn indenter with the radius of the stick area is (1 - phi) F_N.
    rise, wears = punch.force / punch.stiffness, phi > 0.0
    further, v = rise * phi / (1.0 - phi), bodies.ring_displacement(punch)
    # Without an amplitude there is no ring; a narrow one tells how rings begin.
    few = math.sqrt(jnp.finfo(phi.dtype).eps)
    ring = ring_of(v.deficit(lax.select(wears, further, few * rise)))
    end = jnp.exp(ring.log_y) * jnp.where(wears, 1.0, phi / few)
    return Worn(bodies, unworn, punch, further, v, end, lax.select(wears, jnp.pi * ring.volume, 0.0 * phi))


# --- in cells ---------------------------------------------------------------------------------------------------------


def cells_of(found: Worn, from_c: Array, from_1: Array) -> RingCells:
    """The ring in cells; depths in c^2/R, areas in T, pressures in Pa.

    Args:
        found: The contact of the radius a_0, that of the stick radius c, and how much deeper it is in the end.
        from_c: Edges of the cells, T - 1.
        from_1: The same from a_0 on, T - (a_0/c)^2.
    """
    bodies, further, beside = found.bodies, found.further, found.beside
    c, a, radius = found.c, beside.a, bodies.outline.radius
    at_held_depth, (t, share, weight, size) = bodies.ring_compliance(c, found.width, from_c, from_1)
    front = sine_of(a) / (1.0 - a)
    y = clamped(jnp.finfo(t.dtype).tiny, t)
    # What Abel's integral takes to the gap of a flat punch, and to that of the unworn indenter. The latter vanishes at
    # c at this depth; where the modes end, that is not quite the depth of the contact.
    touching, flat, unworn_gap = jnp.zeros_like(further), jnp.ones_like(y), beside.image.fallen(y)
    if beside.flat is not None:
        touching = beside.own[0] / (1.0 - beside.flat[0])
        v = touching * beside.flat + beside.own
        lost, risen = jnp.unstack(between(jnp.stack([beside.flat, v]), y))
        flat, unworn_gap = 1.0 - lost, jnp.maximum(unworn_gap + risen - v[0], 1e-3 * unworn_gap)
    flat_punch_gap, gap = front * ((share * weight) @ jnp.stack([flat, unworn_gap], -1)).T
    rise = math.pi * radius / found.punch.stiffness
    whole = at_held_depth * (radius / (c * c)) + rise * flat_punch_gap[:, None] * flat_punch_gap
    # The depth in the end falls to zero at the outer edge. In the last cell it is at least a quarter of what a straight
    # line to there gives, where the modes lose more than all of it.
    some = size > 0.0
    last = jnp.sum(some) - 2  # and one more; behind both are empty cells
    (before, end), (first, second) = (
        jnp.unstack(lax.dynamic_slice(x, (last,), (2,))) for x in (gap / jnp.where(some, flat_punch_gap, 1.0), size)
    )
    sunk = jnp.maximum(further - touching, end + 0.25 * second / (first + second) * (end - before))
    steady = sunk * flat_punch_gap - gap
    # The pressure before any wear. That of the contact in modes is not known next to a kink.
    there = (from_1[1:] <= 0.0) & (steady > 0.0)
    matrix = jnp.where(there[:, None] & there, whole, np.eye(there.size, dtype=whole.dtype))
    pressure = solve_symmetric(matrix, jnp.where(there, steady, 0.0)[:, None])[:, 0]
    return RingCells(whole, gap, steady, clamp_keep_slope(0.0, pressure), flat_punch_gap, from_c, from_1)


def inward(found: Worn, flat_punch_gap: Array, from_c: Array, from_1: Array) -> tuple[Array, Array]:
    """(Places 1 - T inside c that decrease, what a unit of pressure in each cell adds there under force control).

    Args:
        found: The contact of the radius a_0, and that of the stick radius c.
        flat_punch_gap: As of `RingCells`.
        from_c: Edges of the cells, T - 1.
        from_1: The same from a_0 on.
    """
    sunk = -math.pi * found.c**2 / found.punch.stiffness * flat_punch_gap  # m/Pa
    return found.bodies.inward(found, sunk, from_c, from_1)
