"""Half-spaces of any E(z), or of layers, under a rigid or a homogeneous indenter."""

import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import field_nan_outside, record
from plgwear_jax._core.sequential import sequential_vmap
from plgwear_jax._core.xla import materialised
from plgwear_jax.shapes.shape import Outline
from plgwear_jax.special.cholesky import solve_symmetric
from plgwear_jax.special.elementary import clamped, in_dtype, namespace, quotient, value_with_slope
from plgwear_jax.special.pchip import horner

from .bodies import AnyModulus, Elastic
from .cells import Images, images_of, products_of, towards_c
from .effort import Effort
from .foundation import Foundation, foundation, wavenumbers
from .half_space import excess_compliance
from .punch import Bodies, Punch, apart, grown, pressure_inside, resolved, risen
from .ring import RING_NODES, RingDisplacement, Worn

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
    # each direction. JAX alone makes one of every change: with a table of 100 depths derivatives of a run take several
    # times as long, and twice the memory.
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


@record
class Graded(Bodies):
    """(1 + m(q)) g/q, with m(q) = the sum of m_k/(1 + (q/q_k)^4)."""

    strength: Array  # g
    coefficients: Array  # m_k
    indenter: Array  # the indenter's part of g

    @property
    def front(self) -> float:
        """The factor e of the pressures, for s = 1/2."""
        return math.sqrt(2.0 / math.pi)

    @property
    def foundation(self) -> Foundation:
        """Its constants."""
        return foundation(self.effort)

    @property
    def s(self) -> Any:
        """Edge exponent s of the pressure basis: a constant, so that NumPy computes what follows from it alone."""
        return self.strength.dtype.type(0.5)

    def far(self, log_r: Array) -> Array:
        """The logarithm of the displacement far away, up to a constant: as on what lies below all layers."""
        return -log_r

    @property
    def lead(self) -> tuple[Array, Array]:
        """(k, log(g)) of the term that leads at large q."""
        return jnp.zeros_like(self.strength), jnp.log(self.strength)

    def _shares(self, c: Array) -> Array:
        """What each m_k counts for at each x_k."""
        q, *_ = wavenumbers(self.effort)
        # The square of these, by which derivatives divide, has to be a number of float32.
        fourth = np.minimum((self.foundation.x[:, None] / q) ** 4, 1e16)
        return 1.0 / (1.0 + jnp.asarray(fourth, c.dtype) * (self.radius / c) ** 4)

    def excess(self, c: Array) -> Array:
        """m at x_k."""
        return self._shares(c) @ self.coefficients

    def matrices(self, c: Array) -> tuple[Array, Array]:
        """(M, its slope by log(c))."""
        shares = self._shares(c)
        both = jnp.stack([shares, 4.0 * shares * (1.0 - shares)]) @ self.coefficients
        parts, matrix = in_dtype(c.dtype, self.foundation.parts.T, self.foundation.matrix)
        excess, slope = jnp.unstack(jnp.tensordot(both @ parts, matrix, (1, 2)))
        return self.strength * (self._of_surface + excess), self.strength * slope

    @property
    def _of_surface(self) -> Array:
        """M of 1/q."""
        return jnp.asarray(np.diag(1.0 / (4.0 * np.arange(self.effort.modes) + 1.0)), self.strength.dtype)

    @property
    def of_indenter(self) -> Array:
        """M of the indenter."""
        return self.indenter * self._of_surface

    def _beside(self, excess: Array, y: Array | np.ndarray, factors: Array) -> tuple[Array, Array]:
        """(v at T = 1, what is added at 1 + y, (m, n)) beside the contact, for n pressures."""
        constants = self.foundation
        springs = constants.terms.of(excess)
        xp = namespace(y)
        apart = (y / (xp.sqrt(1.0 + y) + 1.0))[:, None] * xp.asarray(constants.x * np.sqrt(0.5), y.dtype)  # t - 1
        less, half = xp.exp(-apart), xp.sin(0.5 * apart)
        fallen = xp.expm1(-apart) - 2.0 * less * half * half  # exp(-x) cos(x) - 1
        real, imaginary = jnp.unstack(springs[:, None] * factors * (self.front * self.strength))
        return jnp.sum(real, 0), fallen @ real + (less * xp.sin(apart)) @ imaginary

    def ring_displacement(self, punch: Punch) -> RingDisplacement:
        """By springs, for the pressures of the flat punch and of the indenter that touches up to c.

        A spring of short waves feels nothing but the edge, nearer to it than the pressures resolve. There the pressure
        is that on a half-plane: its Laplace transform is that on a homogeneous body over X(p),

            log(X(p)) = integral over u of p/(pi (u^2 + p^2)) log(1 + m(u)).

        (Wiener and Hopf: `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".)
        """
        c, s, outline, constants = punch.c, self.s, self.outline, self.foundation
        image, excess, (flat, rest) = outline.image(c, s), self.excess(c), apart(self, punch)
        both = jnp.stack([punch.flat, punch.touching], -1)
        # On the law of `punch.apart` alone, as `flat`.
        own = (rest - punch.indenter_solution).at[0].add(image.first * flat)
        table, smooth = jnp.asarray(constants.beside, c.dtype), resolved(image)
        found, own = table @ both, table @ own
        unit = 0.5 * math.sqrt(0.5 * math.pi) * flat
        if not smooth:  # the indenter consists of flat punches, whose radii are those of T = `parts.left`
            parts, rates = risen(outline, image, c, jnp.ones_like(c), 3 * self.effort.nodes)
            h = jnp.asarray(constants.x * np.sqrt(0.5), c.dtype)

            def waves(distance: Array) -> Array:
                x = h[:, None] * distance
                return jnp.exp(-x) * jnp.stack([jnp.cos(x), -jnp.sin(x)])

            inner = parts.x / (1.0 + jnp.sqrt(parts.left))
            exact = (waves(inner) - waves(2.0 - inner)) @ (unit * parts.ended(parts.weight * rates, s))
            found, own = found.at[:, :, 1].add(exact - own), exact
        edge = jnp.asarray(constants.edge, c.dtype) @ jnp.log1p(clamped(-0.999, excess))
        edge, own = (lax.complex(*jnp.unstack(each)) for each in (edge, own))
        # The edge of a half-plane has no kink beside it; without kinks it is more exact earlier than the sum.
        last = np.sum(constants.x < (0.5 if len(image.kink_positions) else 0.1) * self.effort.modes**2)
        edge = jnp.exp(-edge)
        near = jnp.stack([edge, edge * own], -1)
        near = jnp.stack([near.real, near.imag])
        known = 2 if smooth else 1  # of these pressures
        size = jnp.sqrt(quotient(*(jnp.sum(each[:, last, :known] ** 2, 0) for each in (found, near))))
        if not smooth:
            size = size * jnp.append(1.0, grown(self, punch, image) / unit)
        factors = jnp.append(found[:, :last], size * near[:, last:], 1)
        first, v = self._beside(excess, np.exp(RING_NODES, dtype=c.dtype), factors)
        of_flat, of_own = jnp.unstack(v, axis=1)
        return RingDisplacement(s, image, self.effort.nodes, first[0] + of_flat, of_own)

    def ring_compliance(self, c: Array, width: Array, from_c: Array, from_1: Array) -> tuple[Array, Images]:
        """What cells do to each other directly, and through the inside."""
        images, moved, caused = self._through_inside(c, width, from_c, from_1)
        return self._directly(c, jnp.zeros_like(c), from_c[-1], images) - moved @ caused, images

    def disc_compliance(self, b: Array, edges: Array) -> Array:
        """Directly alone."""
        images = images_of(edges - 1.0, edges, jnp.full_like(b, -1.0), self.s, self.s)
        return self._directly(b, edges[0] - 1.0, edges[-1] - 1.0, images)

    def inward(self, found: Worn, sunk: Array, from_c: Array, from_1: Array) -> tuple[Array, Array]:
        """By sums of pressures."""
        c = found.c
        # The sums of pressures do not know what is nearer to c than a thousandth of it.
        edges = towards_c(jnp.log(1e3 / jnp.minimum(found.width, 1.0)), 32)
        places = -0.5 * (edges[1:] + edges[:-1])
        modes = jnp.outer(found.punch.flat, sunk) - self._through_inside(c, found.width, from_c, from_1)[2]
        # Beside c a cell has an image that ends with some value there, and inside a pressure with the same image.
        root = jnp.append(0.0, jnp.sqrt(from_c[1:]))  # the root of 0 has no derivative
        modes = modes.at[0].add(-c * jnp.diff(root))
        smooth = pressure_inside(self, modes.T / c, places).T
        return places, smooth + (2.0 / math.pi) * jnp.diff(jnp.arctan(root / jnp.sqrt(places)[:, None]), axis=1)

    def _directly(self, c: Array, first: Array, last: Array, images: Images) -> Array:
        """What the cells from the place `first` to `last`, T - 1, do to each other if nothing else moves.

        By the homogeneous half-space of the surface's modulus, and by a kernel: (1/pi) times the integral of
        m(q) cos(q u) over q > 0, for distances u in units of c. Tables of it and of its integral from 0 to u go over
        log(u).
        """
        constants = self.foundation
        turned = np.exp(np.arange(_LEAST, _MOST + _TABLE, _TABLE))[:, None] * (constants.x * math.sqrt(0.5))
        springs = constants.x * math.sqrt(0.125) * np.exp(-turned) * (np.cos(turned) + np.sin(turned))
        # Half of 1 - exp(-x) cos(x), which would cancel.
        up_to = np.exp(-turned) * np.sin(0.5 * turned) ** 2 - 0.5 * np.expm1(-turned)
        kernel, integral = jnp.asarray([springs, up_to], c.dtype) @ constants.terms.of(self.excess(c))
        # At the axis the root has no slope.
        root, ends = jnp.sqrt(1.0 + images.t), clamped(jnp.finfo(c.dtype).tiny, 1.0 + jnp.stack([first, last]))
        begin, end = jnp.unstack(jnp.sqrt(ends))
        apart = (images.t - first) / (root + begin), (last - images.t) / (root + end), end + root, begin + root
        apart = clamped(math.exp(_LEAST), jnp.stack(apart))
        below, above, opposite, less = jnp.unstack(_values_at(_lagrange_cubics(integral), _places_of(apart)))
        # Weights of nodes are those of 2 dr.
        added = through_springs(kernel, 2.0 * (below + above + opposite - less), *images[:3])
        # g c/(2 Gamma(3/2)^2)
        return self.strength * c * (2.0 / math.pi) * (products_of(images.share, images.weight) + 0.5 * added)

    def _through_inside(self, c: Array, width: Array, from_c: Array, from_1: Array) -> tuple[Images, Array, Array]:
        """(The images, what each pressure inside c does beside it, those inside c against those of each cell).

        Each pressure inside has the force 2 pi e^2 c = 4 c.
        """
        images = images_of(from_c, from_1, width, self.s, self.s)
        y, factors = clamped(jnp.finfo(c.dtype).tiny, images.t), jnp.asarray(self.foundation.beside, c.dtype)
        first, more = self._beside(self.excess(c), y, factors)
        moved = (2.0 / math.pi) * (images.share * images.weight) @ (first + more)
        return images, moved, (c * math.pi / 4.0) * solve_symmetric(self.matrices(c)[0], moved.T)


def graded(material: AnyModulus, indenter: Elastic | None, load: Array, effort: Effort, outline: Outline) -> Graded:
    """A half-space of any E(z), and a homogeneous body or a rigid one, for a load F_N R."""
    (lengths, moduli), nu = material.arrays(), field_nan_outside(material, "nu")
    plane = (1.0 - nu) * (1.0 + nu)
    first = moduli[0]
    surface = 2.0 * plane / first
    of_indenter = jnp.zeros_like(surface) if indenter is None else 2.0 / indenter.plane_modulus
    # An estimate of the radius: with the mean of the moduli, by logarithms.
    middle = plane / jnp.exp(jnp.mean(jnp.log(moduli)))
    log_scale = outline.shape.log_radius(outline.radius, jnp.log(load * (middle + 0.5 * of_indenter)), 0.0 * load)
    # The wavenumbers stay where they are when the inputs change a little, and move from one to another.
    step = 5.0 * effort.spacing
    scale = jnp.exp(step * jnp.round(lax.stop_gradient(log_scale) / step))
    _, seen, terms = wavenumbers(effort)
    # In these units slopes of cubics by the depth are numbers of float32.
    unit = material.by_depth(lengths / scale, quotient(moduli, first))
    excess = excess_compliance(unit, nu, jnp.asarray(seen, nu.dtype), effort.digits)
    # What is too thin for the largest wavenumber counts as what lies below it.
    thin = excess[-1]
    strength = surface * (1.0 + thin) + of_indenter
    coefficients = terms.of((excess - thin) * (surface / strength))
    return Graded(outline, effort, scale, strength, coefficients, of_indenter)
