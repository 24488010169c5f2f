"""A contact that wears, in cells of constant pressure: the ring, where what is inside c sticks, or all of the contact.

Pressures inside c are eliminated: there the surfaces touch and no shape changes.
In units of c^2/R for depths, T = (r/c)^2 for areas and Pa for pressures, the ring deforms under its pressures by

    H - A p,      A = A_fixed + (pi c^2/K) e e',

A_fixed at a held depth of the indenter, e the gap that a flat punch of the radius c leaves and K its stiffness.
`docs/explanation/numerics.md` has the equations.
"""

import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.sequential import sequential_vmap
from plgwear_jax._core.xla import materialised
from plgwear_jax.special.cholesky import solve_symmetric
from plgwear_jax.special.elementary import clamp_keep_slope, clamped, value_with_slope
from plgwear_jax.special.jacobi import gamma
from plgwear_jax.special.pchip import horner

from .cells import NODES, Images, RingCells, images_of, products_of
from .compliance import Bodies, Graded, OnePower, PowerLaw
from .punch import pressure_inside
from .ring import Worn, between, sine_of


def cells_of(found: Worn, from_c: Array, from_1: Array) -> RingCells:
    """The ring in cells; depths in c^2/R, areas in T, pressures in Pa.

    Args:
        found: The contact of the radius a_0, that of the stick radius c, and how much deeper it is in the end.
        from_c: Edges of the cells, T - 1.
        from_1: The same from a_0 on, T - (a_0/c)^2.
    """
    bodies, further, beside = found.bodies, found.further, found.beside
    c, a, radius = found.c, beside.a, bodies.outline.radius
    at = c, found.width, from_c, from_1
    at_held_depth, (t, share, weight, size) = (
        _graded(bodies, *at) if isinstance(bodies, Graded) else _powers(bodies, *at)
    )
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


# --- powers of the wavenumber -----------------------------------------------------------------------------------------

_DISC = {2: 32, 3: 32, 4: 48, 5: 64}  # cells inside c for so many digits


def _cells_that_stick(from_c: Array, digits: int) -> Array:
    """Edges of cells inside c, T - 1, and the same in r inside.

    Towards c they become far finer than the first cell of the ring, or what they do to it would be too small.
    """
    return _towards_c(math.log(400.0) - jnp.log(from_c[1]), _DISC[digits])


def _towards_c(finest: Array, count: int) -> Array:
    apart = jnp.expm1(finest * jnp.asarray(np.linspace(1.0, 0.0, count + 1), finest.dtype)) / jnp.expm1(finest)
    return -apart * (2.0 - apart)


class _PowerTerms(NamedTuple):
    """Of each term, along a first axis."""

    images: Images  # of the cells beside c
    of_ring: Array  # what the images beside c do, in m/Pa
    disc: Array  # what cells inside c do to each other
    mixed: Array  # what cells beside c do to those inside by their images there


def power_terms(
    bodies: OnePower | PowerLaw, c: Array, width: Array, from_c: Array, from_1: Array, inner: tuple[Array, Array]
) -> _PowerTerms:
    """Of cells beside c, as of `cells_of`, and of cells inside c, whose edges `inner` are T - 1 and T - 1 - width."""
    edges = jnp.append(inner[0], from_c[1:]), jnp.append(inner[1], from_1[1:])
    cells = inner[0].size - 1
    count = cells * NODES

    def one(k: Array, s: Array, log_g: Array) -> _PowerTerms:
        q = 1.0 - s
        t, share, weight, size = images_of(*edges, width, s, q)
        # g 2^(k-1) c^(1-k)/Gamma(1+q)^2
        strength = jnp.exp(log_g + (k - 1.0) * math.log(2.0) + (1.0 - k) * jnp.log(c)) / gamma(1.0 + q) ** 2
        images = Images(t[count:], share[cells:, count:], weight[count:], size[cells:])
        of_ring = strength * products_of(images.share, images.weight)
        inside = strength * (share[:, :count] * weight[:count]) @ share[:cells, :count].T
        return _PowerTerms(images, of_ring, inside[:cells], inside[cells:].T)

    k, log_g = bodies.terms
    return jax.vmap(one)(k, 0.5 * (1.0 + k), log_g)


def _powers(bodies: OnePower | PowerLaw, c: Array, width: Array, from_c: Array, from_1: Array) -> tuple[Array, Images]:
    """The images beside c of each term, less what the pressures inside c take off.

    Alone each term would have these take off exactly what the images inside c add. With two terms they have no closed
    form, but of cells inside c only the difference counts.
    """
    inner = _cells_that_stick(from_c, bodies.effort.digits)
    images, of_ring, disc, mixed = power_terms(bodies, c, width, from_c, from_1, (inner, inner - width))
    if isinstance(bodies, OnePower):
        return of_ring[0], jax.tree.map(lambda x: x[0], images)

    def taken(disc: Array, mixed: Array) -> Array:
        return mixed.T @ solve_symmetric(disc, mixed)

    total = jnp.sum(of_ring + jax.vmap(taken)(disc, mixed), 0) - taken(disc.sum(0), mixed.sum(0))
    first = bodies.k >= 0.0
    return total, jax.tree.map(lambda x: jnp.where(first, x[0], x[1]), images)


# --- any E(z) ---------------------------------------------------------------------------------------------------------

_LEAST, _MOST, _TABLE = -18.0, 6.0, 0.125  # of the logarithms of distances, and their steps


class _Places(NamedTuple):
    """Where distances lie in a table over log(u)."""

    before: Array  # the number of the cubic
    part: Array  # of a step, from its beginning


def _places_of(u: Array) -> _Places:
    cubics = round((_MOST - _LEAST) / _TABLE) - 2
    # Materialised, or each direction of a derivative would compute it again.
    at = materialised(clamped(0.0, (jnp.log(u) - _LEAST) / _TABLE - 1.0, cubics - 1.0))
    before = jnp.floor(lax.stop_gradient(at))
    return _Places(before.astype(int).astype(np.uint32), at - before)


_CUBIC = np.linalg.inv(np.vander(np.arange(-1.0, 3.0), increasing=True))  # from values at -1, 0, 1, 2


def _lagrange_cubics(table: Array) -> Array:
    """The coefficients of Lagrange's cubics between each two of the inner values, by powers of the part of a step."""
    return jnp.asarray(_CUBIC, table.dtype) @ jnp.stack([table[i : table.size - 3 + i] for i in range(4)])


def _values_at(cubics: Array, places: _Places) -> Array:
    return horner(jnp.unstack(cubics[:, places.before]), places.part)


def _distances(t: Array, weight: Array) -> tuple[Array, Array]:
    """(Distances between nodes r/c, of a node to itself a mean one within its cell; sums of both)."""
    x = jnp.sqrt(1.0 + t)
    opposite = x[:, None] + x
    # By the mean of a logarithm.
    apart = jnp.where(np.eye(t.size, dtype=bool), 0.11 * weight, abs(t[:, None] - t) / opposite)
    return clamped(math.exp(_LEAST), apart), opposite


def _of_kernel(kernel: Array, whole: Array | float, share: Array, weight: Array) -> Array:
    weighted = share * weight
    return weighted @ kernel @ weighted.T + (weighted * (whole - kernel @ weight)) @ share.T


def _of_table(
    table: Array, near: _Places, far: _Places, share: Array, weight: Array, whole: Array | float = 0.0
) -> Array:
    cubics = _lagrange_cubics(table)
    return _of_kernel(_values_at(cubics, near) + _values_at(cubics, far), whole, share, weight)


_of_each_table = sequential_vmap(_of_table)  # the matrices of all directions would not be in the cache together


@jax.custom_jvp
def through_springs(table: Array, whole: Array, t: Array, share: Array, weight: Array) -> Array:
    """What cells do to each other by a kernel of the distance of their nodes, and of that to their mirror images.

    A kernel that is narrower than the distance of nodes, as of thin layers, is missed by sums over these. What its
    integral over all cells, `whole`, is more than the sum acts on the spot.
    """
    near, far = map(_places_of, _distances(t, weight))
    return _of_table(table, near, far, share, weight, whole)


@through_springs.defjvp
def _through_springs_jvp(primals: Any, tangents: Any) -> tuple[Array, Array]:
    # The kernel is symmetric: half of its change is by the first of both nodes. Only that of the table is a matrix for
    # each direction.
    (table, whole, t, share, weight), (dtable, dwhole, dt, dshare, dweight) = primals, tangents
    distances, cubics, weighted = _distances(t, weight), _lagrange_cubics(table), share * weight
    near, far = map(_places_of, distances)
    (of_near, by_near), (of_far, by_far) = (
        value_with_slope(lambda u: _values_at(cubics, _places_of(u)), u) for u in distances
    )
    kernel = of_near + of_far
    by_first = by_far + by_near * jnp.sign(t[:, None] - t)
    missed = whole - kernel @ weight
    own = 0.11 * jnp.diagonal(by_near) * dweight
    dx = 0.5 * dt / jnp.sqrt(1.0 + t)
    dmissed = dwhole - kernel @ dweight - dx * (by_first @ weight) - (dx * weight) @ by_first - own * weight
    on_the_spot = 0.5 * (dweight * missed + weight * dmissed)
    half = (dshare * weight + share * dweight) @ (kernel @ weighted.T) + (weighted * dx) @ (by_first @ weighted.T)
    half += (0.5 * weighted * own) @ weighted.T + (dshare * (weight * missed) + share * on_the_spot) @ share.T
    found = _of_kernel(kernel, whole, share, weight)
    return found, half + half.T + _of_each_table(dtable, near, far, share, weight)


def directly(bodies: Graded, c: Array, first: Array, last: Array, images: Images) -> Array:
    """What the cells from the place `first` to `last`, T - 1, do to each other if nothing else moves.

    By the homogeneous half-space of the surface's modulus, and by a kernel: (1/pi) times the integral of m(q) cos(q u)
    over q > 0, for distances u in units of c. Tables of it and of its integral from 0 to u go over log(u).
    """
    constants = bodies.foundation
    turned = np.exp(np.arange(_LEAST, _MOST + _TABLE, _TABLE))[:, None] * (constants.x * math.sqrt(0.5))
    springs = constants.x * math.sqrt(0.125) * np.exp(-turned) * (np.cos(turned) + np.sin(turned))
    # Half of 1 - exp(-x) cos(x), which would cancel.
    up_to = np.exp(-turned) * np.sin(0.5 * turned) ** 2 - 0.5 * np.expm1(-turned)
    kernel, integral = jnp.asarray([springs, up_to], c.dtype) @ constants.terms.of(bodies.excess(c))
    # At the axis the root has no slope.
    root, ends = jnp.sqrt(1.0 + images.t), clamped(jnp.finfo(c.dtype).tiny, 1.0 + jnp.stack([first, last]))
    begin, end = jnp.unstack(jnp.sqrt(ends))
    apart = (images.t - first) / (root + begin), (last - images.t) / (root + end), end + root, begin + root
    apart = clamped(math.exp(_LEAST), jnp.stack(apart))
    below, above, opposite, less = jnp.unstack(_values_at(_lagrange_cubics(integral), _places_of(apart)))
    # Weights of nodes are those of 2 dr.
    added = through_springs(kernel, 2.0 * (below + above + opposite - less), *images[:3])
    # g c/(2 Gamma(3/2)^2)
    return bodies.strength * c * (2.0 / math.pi) * (products_of(images.share, images.weight) + 0.5 * added)


def _graded(bodies: Graded, c: Array, width: Array, from_c: Array, from_1: Array) -> tuple[Array, Images]:
    """What cells do to each other directly, and through the inside."""
    images, moved, caused = _through_inside(bodies, c, width, from_c, from_1)
    return directly(bodies, c, jnp.zeros_like(c), from_c[-1], images) - moved @ caused, images


def _through_inside(
    bodies: Graded, c: Array, width: Array, from_c: Array, from_1: Array
) -> tuple[Images, Array, Array]:
    """(The images, what each pressure inside c does in each cell beside it, those inside c against those of each cell).

    Each of them has the force 2 pi e^2 c = 4 c.
    """
    modes: Any = np.eye(bodies.effort.modes, dtype=c.dtype)
    images = images_of(from_c, from_1, width, bodies.s, bodies.s)
    first, more = bodies.beside(c, clamped(jnp.finfo(c.dtype).tiny, images.t), modes)
    moved = (2.0 / math.pi) * (images.share * images.weight) @ (first + more)
    return images, moved, (c * math.pi / 4.0) * solve_symmetric(bodies.matrices(c)[0], moved.T)


# --- inside c ---------------------------------------------------------------------------------------------------------


def inward(found: Worn, flat_punch_gap: Array, from_c: Array, from_1: Array) -> tuple[Array, Array]:
    """(Places 1 - T inside c that decrease, what a unit of pressure in each cell adds there under force control).

    Args:
        found: The contact of the radius a_0, and that of the stick radius c.
        flat_punch_gap: As of `RingCells`.
        from_c: Edges of the cells, T - 1.
        from_1: The same from a_0 on.
    """
    bodies, punch, c, at = found.bodies, found.punch, found.c, (found.width, from_c, from_1)
    sunk = -math.pi * c * c / punch.stiffness * flat_punch_gap  # m/Pa
    if not isinstance(bodies, Graded):
        edges = _cells_that_stick(from_c, bodies.effort.digits)
        _, _, disc, mixed = power_terms(bodies, c, *at, (edges, edges - found.width))
        pressures = solve_symmetric(disc.sum(0), jnp.diff(edges)[:, None] * sunk - mixed.sum(0))
        return -0.5 * (edges[1:] + edges[:-1]), pressures
    # The sums of pressures do not know what is nearer to c than a thousandth of it.
    edges = _towards_c(jnp.log(1e3 / jnp.minimum(found.width, 1.0)), 32)
    places = -0.5 * (edges[1:] + edges[:-1])
    modes = jnp.outer(punch.flat, sunk) - _through_inside(bodies, c, *at)[2]
    # Beside c a cell has an image that ends with some value there, and inside a pressure with the same image.
    root = jnp.append(0.0, jnp.sqrt(from_c[1:]))  # the root of 0 has no derivative
    modes = modes.at[0].add(-c * jnp.diff(root))
    smooth = pressure_inside(bodies, modes.T / c, places).T
    return places, smooth + (2.0 / math.pi) * jnp.diff(jnp.arctan(root / jnp.sqrt(places)[:, None]), axis=1)


# --- the whole contact ------------------------------------------------------------------------------------------------


def disc_of(bodies: Bodies, b: Array, edges: Array) -> Array:
    """A in m/Pa, (cells, cells), of a whole contact in cells, of which no part has to stick.

    Radii are in T = (r/b)^2. Depths, integrated over T in each cell, follow from the pressures by A p.

    Args:
        bodies: Both bodies.
        b: Radius of the outer edge in m.
        edges: Edges of the cells in T, from 0 to 1, (cells + 1,).
    """
    from_b, axis, none = edges - 1.0, jnp.full_like(b, -1.0), jnp.zeros_like(b)[None]
    if not isinstance(bodies, Graded):
        return jnp.sum(power_terms(bodies, b, axis, none, none, (from_b, edges)).disc, 0)
    return directly(bodies, b, from_b[0], from_b[-1], images_of(from_b, edges, axis, bodies.s, bodies.s))
