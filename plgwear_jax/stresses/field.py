"""Stresses in the plane of the motion, `docs/explanation/numerics.md`, "Stresses"."""

from typing import Any, Literal, NamedTuple

import math
import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.material import holl_ratio
from plgwear_jax.special.pchip import Piecewise
from plgwear_jax.stresses.images import Grid, Tractions, bends, grid, transforms
from plgwear_jax.surfaces.bodies import AnyModulus
from plgwear_jax.surfaces.half_space import depths_for, responses


class Stress(NamedTuple):
    """Stresses in Pa in the plane of the motion, tension positive, shape of the places: `Steady.stress`.

    Attributes:
        xx: In the direction of the motion.
        yy: Across the plane.
        zz: Normal to the surface.
        xz: The shear stress.
    """

    xx: Array
    yy: Array
    zz: Array
    xz: Array

    @property
    def mises(self) -> Array:
        """Von Mises' stress in Pa."""
        xx, yy, zz, xz = self
        return _root(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xz * xz)

    @property
    def principal(self) -> Array:
        """The largest principal stress in Pa."""
        xx, yy, zz, xz = self
        return jnp.maximum(yy, 0.5 * (xx + zz) + _root(0.25 * (xx - zz) ** 2 + xz * xz))


def _root(square: Array) -> Array:
    some = square > 0.0
    return jnp.where(some, jnp.sqrt(jnp.where(some, square, 1.0)), 0.0 * square)


# --- contacts ---------------------------------------------------------------------------------------------------------


class Pressed(NamedTuple):
    """What the stresses follow from; P, as in `images`, in units of its radius, at the shares `STRIPS` of it."""

    force: Array  # F_N in N
    radius: Array  # a_0 in m
    stick: Array  # c/a_0
    friction: Array
    own: Array  # P of a_0 before any wear in Pa
    stuck: Array  # P of c under (1 - phi) F_N
    flat: Array  # P of c, what the worn contact adds
    nu: Array
    body: tuple[Array, ...]  # the exponent of a power law, or the two arrays of `AnyModulus`

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the contacts, () for one."""
        return self.force.shape

    def tractions(self, worn: bool) -> Tractions:
        """The pressure, and the traction along the motion, in units of a_0."""
        t, c = jnp.asarray(STRIPS[1:], self.own.dtype), self.stick
        both = jnp.stack([jnp.ones_like(self.friction), self.friction])
        bend = jnp.asarray(bends(STRIPS), self.own.dtype)
        if worn:
            more = self.flat[:, None] * both
            whole = self.stuck[:, None] * np.array([1.0, 0.0]) + more
            return Tractions(c * t, bend @ whole / c, c, c * more[-1])
        stuck = self.stuck[:, None] * (both * np.array([0.0, -1.0]) / c)
        weight = jnp.concatenate([bend @ (self.own[:, None] * both), bend @ stuck])
        return Tractions(jnp.append(t, c * t), weight, c, None)


def poisson_ratio_of(material: Any) -> Array:
    """Poisson's ratio of a half-space, also where it is Holl's."""
    return holl_ratio(material.k) if isinstance(material.nu, str) else jnp.asarray(material.nu)


STRIPS = 1.0 - (1.0 - np.linspace(0.0, 1.0, 49)) ** 3.5
INSIDE = ((1.0 - STRIPS) * (1.0 + STRIPS))[:-1]  # 1 - t^2


def ended(strips: Array, power: Array, singular: bool = False) -> Array:
    """P at `STRIPS` from those inside, for a P like (1 - t^2)^power at the edge, with the right mean between them."""
    node, weight = np.polynomial.legendre.leggauss(4)
    between = INSIDE[:-1, None] + np.diff(INSIDE)[:, None] * (0.5 + 0.5 * node)
    relative = jnp.asarray(np.log(between / np.stack([INSIDE[:-1], INSIDE[1:]])[..., None]), strips.dtype)
    above = 1.0 - jnp.exp(power[..., None, None, None] * relative) @ jnp.asarray(0.5 * weight, strips.dtype)
    excess = 0.5 * (strips[..., :-1] * above[..., 0, :] + strips[..., 1:] * above[..., 1, :])
    beside = jnp.concatenate([excess, jnp.zeros_like(excess[..., :1])], -1)
    inner = strips[..., 1:] - 0.5 * (beside[..., :-1] + beside[..., 1:])
    outer = 2.0 * strips[..., -1] / (1.0 + power) - inner[..., -1]
    # Without a singularity of the pressure there must be no trace of one.
    return jnp.concatenate([strips[..., :1], inner, (outer if singular else 0.0 * outer)[..., None]], -1)


Half = Literal["homogeneous"] | type[AnyModulus] | None
"""What the half-space is: the class of a table, or None for a power law."""


class PowerModulus(NamedTuple):
    """E(z) = z^k."""

    k: Array

    def at(self, x: Array) -> Array:
        """E; at the surface 0 for k > 0, and for k < 0 that of a depth close to it."""
        near = jnp.exp(self.k * jnp.log(jnp.maximum(x, _NEAR)))
        return jnp.where((x == 0.0) & (self.k > 0.0), 0.0, near)

    def between(self, x: Array, y: Array) -> Array:
        """The mean, which is what the skin resists a strain by."""
        end = jnp.maximum(y, 1e-30)
        share = x / end
        thin = share > 0.999
        share = jnp.where(thin, 0.5, share)
        some = share > 0.0
        power = jnp.where(some, jnp.exp((1.0 + self.k) * jnp.log(jnp.where(some, share, 1.0))), 0.0)
        mean = jnp.where(thin, 1.0, (1.0 - power) / ((1.0 + self.k) * (1.0 - share)))
        return jnp.exp(self.k * jnp.log(end)) * mean


_NEAR = 1e-6  # of a_0, as which the surface counts where E is infinite there
_RUNGS = np.append(0.0, np.exp(np.arange(-16.0, 2.7, 0.25)))  # depths of a power law in units of 1/q


def body_of(pressed: Pressed, kind: Half) -> Piecewise | PowerModulus:
    """E(z) over that of the surface, or of the depth a_0 on a power law, by z/a_0; for one contact."""
    if kind is None or kind == "homogeneous":
        return PowerModulus(pressed.body[0])
    table = kind.by_depth(*pressed.body)
    powers = pressed.radius ** np.arange(len(table.coefficients), dtype=pressed.radius.dtype)[:, None]
    return Piecewise(table.start / pressed.radius, table.coefficients * powers / table.coefficients[0, 0])


# --- the field --------------------------------------------------------------------------------------------------------

_MANY = 32  # depths at once


def _first_responses(nu: Array, whole: Array) -> tuple[Array, Array]:
    """(h_0, h_1) of responses (h_0 + h_1 q z) exp(-q z) like those of `responses`, each (10,).

    They are those of a homogeneous half-space; with `whole` = 0 those of a surface without a modulus, which follows.
    """
    ratio, one, none = nu / (1.0 - nu), jnp.ones_like(nu), jnp.zeros_like(nu)
    a, b = (jnp.stack([one, 2.0 * nu]) - ratio) * whole + ratio, (jnp.stack([-one, none]) - ratio) * whole + ratio
    c, d = -jnp.stack([2.0 * one, 2.0 * nu]) * whole, (jnp.stack([one, none]) + ratio) * whole - ratio
    first = jnp.concatenate([a, jnp.stack([one, none]), c, jnp.stack([none, one, -whole * one, one])])
    second = jnp.concatenate([b, jnp.stack([one, one]), d, jnp.stack([-one, -one, none, none])])
    return first, second


def _image_weights(
    body: Piecewise | PowerModulus, nu: Array, z: Array, given: Grid, alone: tuple[Array, Array]
) -> Array:
    """Of each exponential in what the responses at depths (n,) are besides `alone`, shape (10, n, exponentials)."""
    q = jnp.asarray(given.q, z.dtype)
    edges, even = (
        (jnp.asarray(_RUNGS[:, None]) / q, False) if isinstance(body, PowerModulus) else depths_for(body, q, 4)
    )

    def at(z: Array) -> Array:
        height = z[:, None] * q
        rest = (alone[0][:, None, None] + alone[1][:, None, None] * height) * jnp.exp(-height)
        return (responses(body, edges, even, z, q, nu) - rest) @ jnp.asarray(given.fit.T, z.dtype)

    if z.size <= _MANY:
        return at(z)
    padded = jnp.pad(z, (0, -z.size % _MANY)).reshape(-1, _MANY)
    found = jnp.moveaxis(jax.lax.map(at, padded), 0, 1)
    return found.reshape(found.shape[0], -1, found.shape[-1])[:, : z.size]


def _parts() -> np.ndarray:
    """How the integrals of J_i with each response add to xx, yy, zz and xz, shape (4, 10, 4)."""
    of = np.zeros((4, 10, 4))
    even, odd, ahead, aside = [0.5, 0.0, 0.5, 0.0], [0.0, 0.25, 0.0, 0.25], [0.5, 0.0, -0.5, 0.0], [0.0, 0.75, 0.0, -0.25]
    of[0, 0], of[0, 1], of[0, 4], of[0, 5], of[0, 8] = np.negative(ahead), np.negative(even), aside, odd, 2.0 * np.array(odd)
    of[1, 0], of[1, 1], of[1, 4], of[1, 5], of[1, 8] = np.negative(even), np.negative(ahead), odd, aside, -2.0 * np.array(odd)
    of[2, 2, 0], of[2, 6, 1] = -1.0, 1.0
    of[3, 3, 1], of[3, 7], of[3, 9] = -1.0, np.negative(ahead), np.negative(even)
    return of


_PARTS = _parts()
_ALONG = np.arange(10) >= 4  # the responses to the traction, after those to the pressure


def field(pressed: Pressed, kind: Half, worn: bool, x: Array, z: Array) -> Stress:
    """Stresses in Pa of one contact at x and z in units of a_0, which broadcast; fast where both do so."""
    shape = jnp.broadcast_shapes(x.shape, z.shape)
    x, z = (at.reshape((1,) * (len(shape) - at.ndim) + at.shape) for at in (x, z))
    nu, given = pressed.nu, grid(x.dtype == jnp.float64)
    whole = jnp.where(pressed.body[0] == 0.0, 1.0, 0.0 * nu) if kind is None else jnp.ones_like(nu)
    alone = _first_responses(nu, whole)
    parts = jnp.asarray(_PARTS, z.dtype)
    # First the places, then for each x the images of them all.
    least = float(jnp.finfo(z.dtype).eps) ** 2
    places, heights = jnp.broadcast_to(x, shape).ravel(), jnp.broadcast_to(jnp.maximum(z, least), shape).ravel()
    if kind != "homogeneous":
        zeta = jnp.broadcast_to(jnp.asarray(given.zeta, z.dtype), (x.size, given.zeta.size))
        heights = jnp.append(heights, zeta)
        places = jnp.append(places, jnp.broadcast_to(x.ravel()[:, None], zeta.shape))
    found = transforms(pressed.tractions(worn), heights, abs(places))
    sign = jnp.stack([jnp.ones_like(places), jnp.sign(places)])[jnp.array([0, 1, 0, 1])]
    found = (found * sign[:, :, None])[..., _ALONG.astype(int)]  # of each response
    count = math.prod(shape)
    value, rate = (each.reshape(4, *shape, 10) for each in found[:, :, :count])
    stress = jnp.einsum("cri,r,i...r->c...", parts, alone[0], value)
    stress += z * jnp.einsum("cri,r,i...r->c...", parts, alone[1], rate)
    if kind != "homogeneous":
        weights = _image_weights(body_of(pressed, kind), nu, z.ravel(), given, alone).reshape(10, *z.shape, -1)
        images = found[0, :, count:].reshape(4, *x.shape, -1, 10)
        stress += jnp.einsum("r...m,cr...m->c...", weights, jnp.einsum("cri,i...mr->cr...m", parts, images))
    return Stress(*stress)
