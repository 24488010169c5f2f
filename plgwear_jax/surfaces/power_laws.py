"""Power laws E(z) under a rigid or a homogeneous indenter: terms g q^(k-1) of G(q), see `punch`."""

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import record
from plgwear_jax._core.sequential import sequential_forward_mode
from plgwear_jax._core.xla import materialised
from plgwear_jax.shapes.shape import Outline
from plgwear_jax.special.cholesky import solve_symmetric
from plgwear_jax.special.elementary import clamped, in_dtype
from plgwear_jax.special.jacobi import gamma, jacobi_table, power_matrix, ratios
from plgwear_jax.special.quadrature import bent

from .bodies import Elastic
from .cells import NODES, Images, images_of, products_of, towards_c
from .effort import Effort
from .punch import Bodies, Punch, grown, resolved
from .ring import RING_NODES, RingDisplacement, Worn


def _of_sign(k: Array) -> tuple[Array, Array]:
    """(max(k, 0), |k|), at k = 0 with the slopes of k > 0: all that depends on the side of k has to be of one side."""
    above = k >= 0.0
    return jnp.where(above, k, 0.0), jnp.where(above, k, -k)


_DISC = {2: 32, 3: 32, 4: 48, 5: 64}  # cells inside c for so many digits


def _cells_that_stick(from_c: Array, digits: int) -> Array:
    """Edges of cells inside c, T - 1, and the same in r inside.

    Towards c they become far finer than the first cell of the ring, or what they do to it would be too small.
    """
    return towards_c(math.log(400.0) - jnp.log(from_c[1]), _DISC[digits])


class _PowerTerms(NamedTuple):
    """Of each term, along a first axis."""

    images: Images  # of the cells beside c
    of_ring: Array  # what the images beside c do, in m/Pa
    disc: Array  # what cells inside c do to each other
    mixed: Array  # what cells beside c do to those inside by their images there


class _Powers(Bodies):
    """What one term and two have: `terms`, (k, log(g)) of each, along a first axis."""

    def _power_terms(
        self, c: Array, width: Array, from_c: Array, from_1: Array, inner: tuple[Array, Array]
    ) -> _PowerTerms:
        """Of cells beside c, as of `ring.cells_of`, and inside c, with the edges `inner`, T - 1 and T - 1 - width."""
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

        k, log_g = self.terms
        return jax.vmap(one)(k, 0.5 * (1.0 + k), log_g)

    def inward(self, found: Worn, sunk: Array, from_c: Array, from_1: Array) -> tuple[Array, Array]:
        """By cells there."""
        edges = _cells_that_stick(from_c, self.effort.digits)
        _, _, disc, mixed = self._power_terms(found.c, found.width, from_c, from_1, (edges, edges - found.width))
        pressures = solve_symmetric(disc.sum(0), jnp.diff(edges)[:, None] * sunk - mixed.sum(0))
        return -0.5 * (edges[1:] + edges[:-1]), pressures

    def disc_compliance(self, b: Array, edges: Array) -> Array:
        """The cells inside a radius with nothing beside it."""
        none = jnp.zeros_like(b)[None]
        return jnp.sum(self._power_terms(b, jnp.full_like(b, -1.0), none, none, (edges - 1.0, edges)).disc, 0)


@record
class OnePower(_Powers):
    """g q^(k-1), a power law under a rigid indenter: beside the contact v is 0, and G(1) says all of what is inside."""

    k: Array
    log_g: Array

    @property
    def never_pulls(self) -> bool:
        """Where r f'(r) nowhere falls."""
        return self.outline.shape.steepens

    @property
    def s(self) -> Array:
        """Edge exponent s of the pressure basis."""
        return 0.5 * (1.0 + self.k)

    def far(self, log_r: Array) -> Array:
        """The logarithm of the displacement far away, up to a constant."""
        return -2.0 * self.s * log_r

    @property
    def lead(self) -> tuple[Array, Array]:
        """(k, log(g))."""
        return self.k, self.log_g

    @property
    def terms(self) -> tuple[Array, Array]:
        """(k, log(g)) of each term, along a first axis."""
        return self.k[None], self.log_g[None]

    def punch_at(self, log_c: Array) -> Punch:
        """In closed form."""
        # The moment of f is G(1) with the exponent s + 1, and that of r f' is 2 s times what G(1) with s is above it.
        s = self.s
        depth, mean = self.outline.firsts(jnp.exp(log_c), s)
        stiffness = 4.0 * jnp.pi * s * self.front**2 * jnp.exp(2.0 * s * log_c - self.log_g)
        inner = stiffness, 2.0 * s * stiffness, stiffness * mean, depth, stiffness * (depth - mean)
        return Punch(log_c, None, None, None, *inner)

    def ring_displacement(self, punch: Punch) -> RingDisplacement:
        """0 but for the indenter."""
        return RingDisplacement(self.s, self.outline.image(punch.c, self.s), self.effort.nodes)

    def ring_compliance(self, c: Array, width: Array, from_c: Array, from_1: Array) -> tuple[Array, Images]:
        """The images beside c: the pressures inside take off exactly what the images inside add."""
        none = jnp.zeros_like(c)[None]
        images, of_ring, *_ = self._power_terms(c, width, from_c, from_1, (none, none - width))
        return of_ring[0], jax.tree.map(lambda x: x[0], images)


_FURTHER = 3  # nodes


@record
class PowerLaw(_Powers):
    """g q^(k-1) + g_h/q, a power law and a homogeneous body."""

    k: Array
    log_g: Array
    homogeneous: Array  # g_h
    s: Array
    power_terms: Array  # matrices of both
    homogeneous_terms: Array

    @property
    def abel(self) -> Array:
        """That of the power law or that of the homogeneous body."""
        return 0.5 * (1.0 + _of_sign(self.k)[0])

    def far(self, log_r: Array) -> Array:
        """The logarithm of the displacement in m far away, under a force of 2 pi."""
        half = 0.5 * self.k
        log_g = self.log_g + self.k * math.log(2.0) + jnp.log(gamma(0.5 + half) / gamma(0.5 - half))
        return jnp.logaddexp(log_g - (1.0 + self.k) * log_r, jnp.log(self.homogeneous) - log_r)

    @property
    def lead(self) -> tuple[Array, Array]:
        """(k, log(g)) of the term that leads at large q."""
        power, homogeneous = self.log_g, jnp.log(self.homogeneous)
        log_g = jnp.where(self.k > 0.0, power, jnp.where(self.k < 0.0, homogeneous, jnp.logaddexp(power, homogeneous)))
        return _of_sign(self.k)[0], log_g

    @property
    def terms(self) -> tuple[Array, Array]:
        """(k, log(g)) of each term, along a first axis."""
        return jnp.stack([self.k, jnp.zeros_like(self.k)]), jnp.stack([self.log_g, jnp.log(self.homogeneous)])

    def matrices(self, c: Array) -> tuple[Array, Array]:
        """(M, its slope by log(c))."""
        power = jnp.exp(self.log_g - self.k * jnp.log(c)) * self.power_terms
        return self.of_indenter + power, -self.k * power

    @property
    def of_indenter(self) -> Array:
        """M of the indenter."""
        return self.homogeneous * self.homogeneous_terms

    def beside(self, c: Array, y: Array, coefficients: Array) -> Array:
        """v at T = 1 + y beside the contact, shape (m, n), for coefficients of shape (modes, n)."""
        strength = jnp.where(self.k >= 0.0, jnp.log(self.homogeneous), self.log_g - self.k * jnp.log(c))
        found, lag = _tables(_inside, self.effort, self.k, self.s), 0.5 * _of_sign(self.k)[1]
        outside = jnp.asarray(bent(4 * self.effort.nodes)[1], c.dtype)
        begin = jnp.exp((lag - 1.0) * jnp.log1p(y))[:, None] * (found.first @ coefficients)
        kernel = jnp.exp((lag - 1.0) * jnp.log(y[:, None] + outside))
        total = kernel @ (found.density @ coefficients) + begin
        return (found.front * jnp.exp(strength + (1.0 - self.abel) * jnp.log1p(y)))[:, None] * total

    def edge(self, c: Array, log_y: np.ndarray) -> tuple[Array, Array]:
        """1 - v beside a flat punch at the edge of a half-plane, up to a factor, and its mean from 0 to y.

        Its Laplace transform is exp(S)/q, with S(q) the integral over u of log(1 + the ratio of both terms at q exp(u))
        times sech(u)/(2 pi): `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".

        Args:
            c: Radius in m.
            log_y: Logarithms of T - 1, in equal steps, (n,).
        """
        step, reach = float(log_y[1] - log_y[0]), 40
        log_q = -log_y[-1] + step * np.arange(-2 * reach, log_y.size + 2 * reach)  # of q c/2
        inner, size = log_q[reach:-reach], _of_sign(self.k)[1]
        other = jnp.log(self.homogeneous) - self.log_g
        ratio = jnp.where(self.k >= 0.0, other, -other) - size * (jnp.asarray(log_q, c.dtype) + jnp.log(2.0 / c))
        means = step / (2.0 * math.pi) / np.cosh(inner[:, None] - log_q)
        factor = jnp.exp(jnp.asarray(means, c.dtype) @ jnp.logaddexp(ratio, 0.0))
        turned = np.exp(log_y[:, None] + inner)
        lost = -np.expm1(-turned)
        kernels = np.stack([lost, 1.0 - lost / turned]) - turned / (1.0 + turned)
        front = step / math.pi * jnp.sin(0.5 * math.pi * size)
        # What exp(S) at 1/y leaves out is an integral over the cut of exp(S), near 1/y alone.
        spread = front * (jnp.asarray(kernels, c.dtype) @ (jnp.exp(ratio[reach:-reach]) / factor))
        at, mean = factor[reach : reach + log_y.size][::-1] + spread
        return at, mean

    def ring_displacement(self, punch: Punch) -> RingDisplacement:
        """By the pressures, and next to c by the edge of a half-plane."""
        c, a, depth = punch.c, self.abel, punch.depth
        image = self.outline.image(c, a)
        y = jnp.exp(jnp.asarray(RING_NODES, c.dtype))
        both = jnp.stack([punch.flat, punch.touching], -1)
        # Nearer to c than the pressures resolve, both gaps go as at the edge of a half-plane. Where the slope of the
        # indenter jumps its depth has fewer digits, which count less further out.
        count = int(np.searchsorted(RING_NODES, -2.0 * math.log(self.effort.modes)))
        begin = count if resolved(image) else count + _FURTHER
        v, fallen = self.beside(c, y[count:], both), image.fallen(y)
        flat, own = 1.0 - v[:, 0], fallen[begin:] - depth + image.first + v[begin - count :, 1]
        edge, mean = self.edge(c, RING_NODES[: begin + 1])
        y = y[: begin + 1]
        known = jnp.maximum(y, jnp.finfo(c.dtype).eps ** 0.5)  # where G has risen by more than its roundings
        mean = y * mean * (image.fallen(known) / known)
        size = flat[0] / edge[count]
        near = own[0] / mean[-1] * mean
        if not resolved(image):
            further = 2.0 * (RING_NODES[begin] - RING_NODES[begin:])
            near = size * grown(self, punch, image) * mean
            own = own * (1.0 + (near[-1] / own[0] - 1.0) * jnp.exp(jnp.asarray(further, c.dtype)))
        flat, own = jnp.append(size * edge[:count], flat), jnp.append(near[:-1], own)
        return RingDisplacement(a, image, self.effort.nodes, 1.0 - flat, own - fallen)

    def ring_compliance(self, c: Array, width: Array, from_c: Array, from_1: Array) -> tuple[Array, Images]:
        """The images beside c of each term, less what the pressures inside c take off.

        Alone each term would have these take off exactly what the images inside c add. With two terms they have no
        closed form, but of cells inside c only the difference counts.
        """
        inner = _cells_that_stick(from_c, self.effort.digits)
        images, of_ring, disc, mixed = self._power_terms(c, width, from_c, from_1, (inner, inner - width))

        def taken(disc: Array, mixed: Array) -> Array:
            return mixed.T @ solve_symmetric(disc, mixed)

        total = jnp.sum(of_ring + jax.vmap(taken)(disc, mixed), 0) - taken(disc.sum(0), mixed.sum(0))
        first = self.k >= 0.0
        return total, jax.tree.map(lambda x: jnp.where(first, x[0], x[1]), images)


class _Inside(NamedTuple):
    """What the pressures are in the integral over T from 0 to 1 that gives v beside the contact, by k and s alone."""

    density: Array  # of each pressure at each T, with its weight, (T, modes)
    first: Array  # what is left at T = 0, (modes,)
    front: Array


def _tables(function: Callable[..., Any], effort: Effort, k: Array, s: Array) -> Any:
    # In forward mode: reverse mode multiplies by tables, and compiles no more.
    return sequential_forward_mode(functools.partial(function, effort))(k, s)


def _inside(effort: Effort, k: Array, s: Array) -> _Inside:
    positive, size = _of_sign(k)
    a, lag = 0.5 * (1.0 + positive), 0.5 * size
    other = jnp.where(k >= 0.0, 0.5, 0.5 * (1.0 + k))  # of the other term, not that which leads
    rise = 1.0 + s - other
    # All at once, since XLA compiles the polynomial each time.
    of_rise, of_a, of_lag, of_s = jnp.unstack(gamma(jnp.stack([rise, a, 1.0 + lag, 1.0 + s])))
    factors = ratios(1.0 / of_rise, other, rise, effort.modes)
    inside, outside, weight = in_dtype(s.dtype, *bent(4 * effort.nodes))
    table = jacobi_table(effort.modes, s, other, outside - inside)
    # From the middle on by logarithms: the value at T = 0 apart, whose integral is a beta function of both ends.
    log_in, log_out = jnp.log(inside), jnp.log(outside)
    density = weight * jnp.exp((other - 1.0) * log_in + (s - other) * log_out)
    core = weight * jnp.exp((other - 1.0) * log_in + log_out)  # (1-T) T^(o-1): the integral is 1/(o (o+1))
    first = factors * (1.0 / (other * (other + 1.0)) - jnp.sum(core))
    front = of_a * lag / of_lag * jnp.exp2(other - 1.0 + other - 2.0 * s) / of_s
    return _Inside(density[:, None] * factors * table.T, first, front)


def power_law(
    k: Array, log_stiffness: Array, indenter: Elastic | None, load: Array, effort: Effort, outline: Outline
) -> OnePower | PowerLaw:
    """A power law and a homogeneous body or a rigid one, for a load F_N R.

    Args:
        k: Exponent.
        log_stiffness: Of `PowerLawGraded`.
        indenter: The homogeneous body; None for a rigid one.
        load: Normal force times radius, of which the radius of the contact is estimated.
        effort: How finely it is divided.
        outline: Of the indenter.
    """
    half = 0.5 * (1.0 + k)
    log_g = math.log(math.pi) - math.log(2.0) * (1.0 + k) - 2.0 * jnp.log(gamma(1.0 + half)) - log_stiffness
    if indenter is None:  # the estimate, as of a parabola, is enough to look for the radius
        radius = jnp.exp((jnp.log(load) - log_stiffness + jnp.log(0.25 * (3.0 + k))) / (3.0 + k))
        return OnePower(outline, effort, radius, k, log_g)
    alone = outline.shape.log_radius(outline.radius, jnp.log(load) - log_stiffness, k)
    plane_modulus = indenter.plane_modulus
    homogeneous = 2.0 / plane_modulus
    hertz = outline.shape.log_radius(outline.radius, jnp.log(load / plane_modulus), 0.0 * k)
    radius = jnp.exp(jnp.logaddexp(3.0 * alone, 3.0 * hertz) / 3.0)
    # Exponent of the pressures at the edge: that of the body which gives way most in the last parts of the contact.
    last = log_g - jnp.log(homogeneous) + k * (math.log(2.0 * effort.modes**2) - jnp.log(radius))
    share = 1.0 / (1.0 + jnp.exp(-2.0 * clamped(-40.0, last, 40.0)))
    s = materialised(0.5 + 0.5 * k * share)
    return PowerLaw(outline, effort, radius, k, log_g, homogeneous, s, *_tables(_terms, effort, k, s))


def _terms(effort: Effort, k: Array, s: Array) -> Array:
    """The matrices of the power law and of the homogeneous body, by k and s."""
    return jax.vmap(lambda k: power_matrix(k, s, effort.modes))(jnp.stack([k, jnp.zeros_like(k)]))
