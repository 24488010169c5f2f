"""Two bodies that touch, and their compliance G(q) as the contact of radius c sees it.

Pressures are sums of coefficients y_n times (e/c) times what is J_(2n+s)(x) x^-s in the Hankel domain, x = q c, so that

    M y = moments of the depth by which they press,    M = sum over the terms g q^(k-1) of G of g c^-k times integrals,

and the force is 2 pi e^2 c y_0, e = 2^-s/Gamma(1+s). Beside the contact the displacement is Abel's integral of v(T),

    w(Y) = sin(pi a)/pi * integral over T from 0 to Y of T^(a-1) (Y-T)^-a v(T),      Y = (r/c)^2,

with a = 1/2 for the homogeneous term alone. v is known inside: d - G(T): `shapes` has G. It is computed beside it.
"""

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import field_nan_outside, record, static
from plgwear_jax._core.sequential import sequential_forward_mode
from plgwear_jax._core.xla import materialised
from plgwear_jax.shapes.shape import Outline
from plgwear_jax.special.elementary import clamped, in_dtype, quotient
from plgwear_jax.special.jacobi import gamma, jacobi_table, power_matrix, ratios
from plgwear_jax.special.quadrature import bent

from .bodies import AnyModulus, Elastic
from .effort import Effort
from .foundation import Foundation, foundation, wavenumbers
from .half_space import excess_compliance


def _of_sign(k: Array) -> tuple[Array, Array]:
    """(max(k, 0), |k|), at k = 0 with the slopes of k > 0: all that depends on the side of k has to be of one side."""
    above = k >= 0.0
    return jnp.where(above, k, 0.0), jnp.where(above, k, -k)


@record
class _Touching:
    """What all bodies have."""

    outline: Outline  # of the indenter
    effort: Effort = static()  # how finely the contact is divided
    radius: Array  # an estimate of that of the contact; of any E(z) one over the unit of q_k as well

    enough = 1e-13  # as which roundings of the force count

    @property
    def never_pulls(self) -> bool:
        """Whether such bodies only press, whatever their numbers are."""
        return False

    @property
    def front(self: Any) -> Any:
        """The factor e of the pressures."""
        s = self.s
        return jnp.exp2(-s) / gamma(1.0 + s)

    @property
    def abel(self: Any) -> Array:
        """The exponent of Abel's integral: by the term which leads at large q."""
        return self.s


@record
class OnePower(_Touching):
    """g q^(k-1), a power law under a rigid indenter: beside the contact v is 0, and G(1) says all of what is inside."""

    k: Array
    log_g: Array

    enough = 1e-14  # the force is known to all digits

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


@record
class PowerLaw(_Touching):
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
        """v at T = 1 + y beside the contact, shape (m, ...), for coefficients of shape (modes, ...)."""
        flat = (slice(None), *(None,) * (coefficients.ndim - 1))
        strength = jnp.where(self.k >= 0.0, jnp.log(self.homogeneous), self.log_g - self.k * jnp.log(c))
        found, lag = _tables(_inside, self.effort, self.k, self.s), 0.5 * _of_sign(self.k)[1]
        outside = jnp.asarray(bent(4 * self.effort.nodes)[1], c.dtype)
        begin = jnp.exp((lag - 1.0) * jnp.log1p(y))[flat] * jnp.tensordot(found.first, coefficients, 1)
        kernel = jnp.exp((lag - 1.0) * jnp.log(y[:, None] + outside))
        total = jnp.tensordot(kernel, jnp.tensordot(found.density, coefficients, 1), 1) + begin
        return (found.front * jnp.exp(strength + (1.0 - self.abel) * jnp.log1p(y)))[flat] * total

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


class OnTheLaw(NamedTuple):
    """The indenter that touches up to c and no further, on the law of `punch.apart` alone."""

    flat: Array  # y_0 of a flat punch pressed by 1
    own: Array  # y of the indenter, as far as they resolve it
    # T of the radii of the flat punches that it consists of, 1 - T, by how much each is pressed, and how much faster
    # the last of them are pressed on the bodies; None where `own` says all.
    punches: tuple[Array, Array, Array, Array] | None


@record
class Graded(_Touching):
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

    def beside(self, c: Array, y: Array, coefficients: Array) -> tuple[Array, Array]:
        """(v at T = 1, what is added at 1 + y, (m, ...)) beside the contact, for coefficients of shape (modes, ...)."""
        factors = jnp.tensordot(jnp.asarray(self.foundation.beside, c.dtype), coefficients, 1)
        return self._beside(self.excess(c), y, factors)

    def _beside(self, excess: Array, y: Array, factors: Array) -> tuple[Array, Array]:
        constants = self.foundation
        springs = constants.terms.of(excess)
        apart = (y / (jnp.sqrt(1.0 + y) + 1.0))[:, None] * jnp.asarray(constants.x * np.sqrt(0.5), y.dtype)  # t - 1
        sine, half = jnp.sin(apart), jnp.sin(0.5 * apart)
        fallen = jnp.expm1(-apart) - 2.0 * jnp.exp(-apart) * half * half  # exp(-x) cos(x) - 1
        real, imaginary = jnp.unstack(springs[:, None] * factors * (self.front * self.strength))
        return jnp.sum(real, 0), fallen @ real + (jnp.exp(-apart) * sine) @ imaginary

    def beside_edge(self, c: Array, y: Array, both: Array, law: OnTheLaw, kinks: int) -> tuple[Array, Array]:
        """The same of pressures of the flat punch and of the indenter that touches up to c, (modes, 2).

        A spring of short waves feels nothing but the edge, nearer to it than the pressures resolve. There the pressure
        is that on a half-plane: its Laplace transform is that on a homogeneous body over X(p),

            log(X(p)) = integral over u of p/(pi (u^2 + p^2)) log(1 + m(u)).

        (Wiener and Hopf: `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".)
        """
        constants, excess = self.foundation, self.excess(c)
        table = jnp.asarray(constants.beside, c.dtype)
        found, own = jnp.tensordot(table, both, 1), table @ law.own
        h = jnp.asarray(constants.x * np.sqrt(0.5), c.dtype)
        unit = 0.5 * math.sqrt(0.5 * math.pi) * law.flat
        if law.punches is not None:
            T, left, pressed, _ = law.punches

            def waves(distance: Array) -> Array:
                x = h[:, None] * distance
                return jnp.exp(-x) * jnp.stack([jnp.cos(x), -jnp.sin(x)])

            inner = left / (1.0 + jnp.sqrt(T))
            exact = (waves(inner) - waves(2.0 - inner)) @ (unit * pressed)
            found, own = found.at[:, :, 1].add(exact - own), exact
        edge = jnp.asarray(constants.edge, c.dtype) @ jnp.log1p(clamped(-0.999, excess))
        edge, own = (lax.complex(*jnp.unstack(both)) for both in (edge, own))
        # The edge of a half-plane has no kink beside it; without kinks it is more exact earlier than the sum.
        last = np.sum(constants.x < (0.5 if kinks else 0.1) * self.effort.modes**2)
        near = jnp.exp(-edge)[:, None] * jnp.stack([jnp.ones_like(own), own], -1)
        near = jnp.stack([near.real, near.imag])
        resolved = 2 if law.punches is None else 1  # of these pressures
        size = jnp.sqrt(quotient(*(jnp.sum(both[:, last, :resolved] ** 2, 0) for both in (found, near))))
        if law.punches is not None:
            size = size * jnp.append(1.0, law.punches[3] / unit)
        return self._beside(excess, y, jnp.append(found[:, :last], size * near[:, last:], 1))


Bodies = OnePower | PowerLaw | Graded


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


def graded(material: AnyModulus, indenter: Elastic | None, load: Array, effort: Effort, outline: Outline) -> Graded:
    """A half-space of any E(z), and a homogeneous body or a rigid one, for a load F_N R."""
    (lengths, moduli), nu = material.arrays(), field_nan_outside(material, "nu")
    plane = (1.0 - nu) * (1.0 + nu)
    surface = 2.0 * plane / moduli[0]
    of_indenter = jnp.zeros_like(surface) if indenter is None else 2.0 / indenter.plane_modulus
    # An estimate of the radius: with the mean of the moduli, by logarithms.
    middle = plane / jnp.exp(jnp.mean(jnp.log(moduli)))
    log_scale = outline.shape.log_radius(outline.radius, jnp.log(load * (middle + 0.5 * of_indenter)), 0.0 * load)
    # The wavenumbers stay where they are when the inputs change a little, and move from one to another.
    step = 5.0 * effort.spacing
    scale = jnp.exp(step * jnp.round(lax.stop_gradient(log_scale) / step))
    _, seen, terms = wavenumbers(effort)
    # In these units slopes of cubics by the depth are numbers of float32.
    unit = material.by_depth(lengths / scale, moduli / moduli[0])
    excess = excess_compliance(unit, nu, jnp.asarray(seen, nu.dtype), effort.digits)
    # What is too thin for the largest wavenumber counts as what lies below it.
    strength = surface * (1.0 + excess[-1]) + of_indenter
    coefficients = terms.of((excess - excess[-1]) * (surface / strength))
    return Graded(outline, effort, scale, strength, coefficients, of_indenter)
