"""Stresses in the plane of the motion, `docs/explanation/numerics.md`, "Stresses"."""

import math
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import record, static
from plgwear_jax.special.elementary import in_dtype
from plgwear_jax.special.pchip import Piecewise, horner
from plgwear_jax.surfaces.half_space import depths_for, responses

from .images import Grid, Tractions, grid, path, strips, transforms


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


class Fineness(NamedTuple):
    """How finely stresses are divided."""

    radii: int  # of the spline of a pressure
    near: int  # of these at the edge, between which it is linear; one is the edge itself
    spacing: float  # of the logarithms of depths of the exponentials
    step: float  # along the path for a power
    rounds: int  # of the search for a peak


_FINENESS = {
    2: Fineness(8, 1, 0.8, 1.2, 2),
    3: Fineness(12, 1, 0.6, 1.0, 3),
    4: Fineness(16, 1, 0.45, 0.75, 4),
    5: Fineness(32, 1, 0.37, 0.5, 5),  # at 0.4 the exponentials leave 5e-3 at the edge of a stiff layer
}
_SINGLE = Fineness(40, 40, 0.4, 0.6, 4)  # in float32, where the far field of parabolas would cancel


def fineness_of(digits: int | None, dtype: Any) -> Fineness:
    """How finely stresses are divided for digits of 2 to 5, by default 4."""
    return _FINENESS[min(max(4 if digits is None else digits, 2), 5)] if dtype == jnp.float64 else _SINGLE


_ALONE = 1, 1  # radii where P is such a power alone


def samples(digits: int | None, dtype: Any, alone: bool = False) -> Array:
    """1 - t^2 where `Pressed` has P; few places are enough for a P that is `alone` what it is next to the edge."""
    return jnp.asarray(strips(*_ALONE if alone else fineness_of(digits, dtype)[:2])[1], dtype)


@record
class Pressed:
    """What the stresses follow from; P, as in `images`, in units of its radius, at `samples`."""

    digits: int | None = static()
    force: Array  # F_N in N
    radius: Array  # a_0 in m
    stick: Array  # c/a_0
    friction: Array
    own: Array  # P of a_0 before any wear in Pa
    stuck: Array  # P of c under (1 - phi) F_N
    flat: Array  # P of c, what the worn contact adds
    s: Array  # beside the edge `flat` goes as (1 - t^2)^(s - 1/2), and the others with one more factor of 1 - t^2
    nu: Array
    k: Array | None  # the exponent of a power law
    table: Piecewise | None  # E over that of the surface by z/a_0, of any other half-space that is not homogeneous

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the contacts, () for one."""
        return self.force.shape

    @property
    def fineness(self) -> Fineness:
        """How finely its stresses are divided."""
        return fineness_of(self.digits, self.stick.dtype)

    def tractions(self, worn: bool) -> Tractions:
        """The pressure, and the traction along the motion, in units of a_0."""
        c, fine, graded = self.stick, self.fineness, self.k is not None
        alone = self.own.shape[-1] < fine.radii  # there are three samples for each radius
        size = _ALONE if alone else fine[:2]
        b, inside, fit = in_dtype(c.dtype, *strips(*size))
        both, normal = jnp.stack([jnp.ones_like(self.friction), self.friction]), jnp.asarray([1.0, 0.0], c.dtype)

        def added(own: Array, stuck: Array, flat: Array) -> Array:
            own, stuck, flat = own[:, None], stuck[:, None], flat[:, None]
            if worn:
                return (stuck * normal + flat * both)[None]
            return jnp.stack([own * both, stuck * both * (normal - 1.0)])

        pressures, beside, weight, flat = jnp.stack([self.own, self.stuck, self.flat]), None, None, None
        if graded:
            # Next to an edge a pressure is mostly a power, which no spline can follow; still nearer roundings count.
            power = self.s + jnp.asarray([0.5, 0.5, -0.5], c.dtype)
            at = jnp.searchsorted(inside, jnp.finfo(c.dtype).eps ** 0.2)
            law = jnp.exp(power[:, None] * jnp.log(inside))
            share = (pressures[:, at] / law[:, at])[:, None]
            pressures -= share * law
            t, square, of_path = in_dtype((1j * power).dtype, *path(fine.step))
            own, stuck, more = share * (jnp.exp(power[:, None] * jnp.log(square)) * of_path)
            beside = t, added(own, c * c * stuck, c * c * more)
        if not (alone and graded):
            powers = jnp.full_like(b, 1.0 / c**3).at[-size[1] :].set(1.0 / c)
            own, stuck, more = pressures @ fit.T
            # Without a singularity of the pressure there must be no trace of one, which is the last weight.
            weight = added(own[:-1], powers * stuck[:-1], powers * more[:-1])
            flat = c * more[-1:, None] * both if worn and not graded else None
        edges = c * b[None] if worn else jnp.stack([b, c * b])
        return Tractions(size[1], edges, weight, flat, beside)


# --- E(z) -------------------------------------------------------------------------------------------------------------

_NEAR = 1e-6  # of a_0, as which the surface counts where E is infinite there
_SHORTEST = 1e-5  # of a_0, about 1/q of the last wave of `images.grid`
_STEP = 0.25  # of the logarithms of depths in units of 1/q
_DEPTHS = np.exp(np.arange(-16.0, 2.7, _STEP))
_ENDS = float(_DEPTHS[0]), float(_DEPTHS[-1])


class PowerModulus(NamedTuple):
    """E(z) = z^k, whose responses depend on z and on the wavenumber by their product alone."""

    k: Array
    cubics: Array  # of the responses less `_own_responses`, between _DEPTHS, (4, intervals, 8)

    def at(self, x: Array) -> Array:
        """E; at the surface 0 for k > 0, and for k < 0 that of a depth close to it."""
        return jnp.where((x == 0.0) & (self.k > 0.0), 0.0, jnp.where(x == 0.0, _NEAR, x) ** self.k)

    def shallow(self, x: Array) -> Array:
        """What waves too short for `images` count by: E of what the last of these reach is 1 to them, or that of x."""
        return self.at(x) / self.at(x + _SHORTEST)

    def responses(self, z: Array, q: Array) -> Array:
        """What `cubics` are of, (8, depths, n)."""
        log = jnp.log(jnp.clip(z[:, None] * q, *_ENDS) / _ENDS[0])
        place = jnp.minimum((log / _STEP).astype(int), len(_DEPTHS) - 2)
        return jnp.moveaxis(horner(jnp.unstack(self.cubics[::-1, place]), (log - _STEP * place)[..., None]), -1, 0)


Body = Piecewise | PowerModulus | None


def body_of(pressed: Pressed) -> Body:
    """E(z) over that of the surface, or of the depth a_0 on a power law, by z/a_0; for one contact."""
    k, nu = pressed.k, pressed.nu
    if k is not None:
        from scipy.interpolate import CubicSpline  # late: it takes SciPy longer to import than a contact to be solved

        def mean(x: Array, y: Array) -> Array:  # of z^k between two depths, by which the skin resists a strain
            end = jnp.maximum(y, 1e-30)
            thin = x > 0.999 * end
            share = jnp.where(thin, 0.5, x / end)
            return end**k * jnp.where(thin, 1.0, (1.0 - share ** (1.0 + k)) / ((1.0 + k) * (1.0 - share)))

        depths = jnp.asarray(_DEPTHS, k.dtype)
        edges = jnp.append(0.0, depths)[:, None]
        found = responses(mean, edges, False, depths, jnp.ones_like(k)[None], nu)
        cubics = CubicSpline(_STEP * np.arange(len(_DEPTHS)), np.eye(len(_DEPTHS))).c
        rest = found[..., 0] - _own_responses(nu, depths)
        return PowerModulus(k, jnp.tensordot(jnp.asarray(cubics, k.dtype), rest, (2, 1)))
    return pressed.table


# --- the field --------------------------------------------------------------------------------------------------------

_MANY = 32  # depths at once

# The responses as `responses` has them: by which traction, whether it is a displacement, which counts by E, and of a
# homogeneous half-space h_0 without nu, what nu adds to it, and h_1 of (h_0 + h_1 q z) exp(-q z).
_RESPONSES = np.loadtxt(
    """
    # pressure  traction  moved  h_0   by nu  h_1
    1           0         1      0.5   -1     -0.5
    1           0         0      1     0      1
    1           0         0      0     0      1
    0           1         1      -1    1      0.5
    0           1         0      0     0      -1
    0           1         0      1     0      -1
    0           1         1      -1    0      0
    0           1         0      1     0      0
    """.splitlines()
)
_MOVED, _HOMOGENEOUS = _RESPONSES[:, 2] > 0.0, _RESPONSES[:, 3:].T
# How the integrals of J_0 to J_3 with a response add to a stress: to 0, 1, 2 and 3, which are xx, yy, zz and xz. Lines
# that begin with 1 are what the stress along the waves adds, which depends on Poisson's ratio.
_ADDED = np.loadtxt(
    """
    # along  stress  response  J_0   J_1   J_2   J_3
    0        0       6         0     0.5   0     0.5
    0        1       6         0     -0.5  0     -0.5
    0        2       1         -1    0     0     0
    0        2       4         0     1     0     0
    0        3       2         0     -1    0     0
    0        3       5         -0.5  0     0.5   0
    0        3       7         -0.5  0     -0.5  0
    1        0       0         -0.5  0     0.5   0
    1        1       0         -0.5  0     -0.5  0
    1        0       3         0     0.75  0     -0.25
    1        1       3         0     0.25  0     0.25
    """.splitlines()
)
_PATTERNS = np.zeros((2, 4, 8, 4))
_PATTERNS[*_ADDED[:, :3].T.astype(int)] = _ADDED[:, 3:]


def _first_responses(nu: Array) -> tuple[Array, Array]:
    """(h_0, h_1) of responses (h_0 + h_1 q z) exp(-q z) of a homogeneous half-space, each (8,)."""
    without, by_nu, second = jnp.asarray(_HOMOGENEOUS, nu.dtype)
    return without + nu * by_nu, second


def _own_responses(nu: Array, height: Array) -> Array:
    """These responses at q z."""
    first, second = (each.reshape(-1, *(1,) * height.ndim) for each in _first_responses(nu))
    return (first + second * height) * jnp.exp(-height)


def _image_weights(body: Piecewise | PowerModulus, nu: Array, z: Array, images: Grid) -> Array:
    """Of each exponential in the responses at depths (n,) less `_own_responses`, shape (8, n, exponentials)."""
    q, moved = jnp.asarray(images.q, z.dtype), jnp.asarray(_MOVED)[:, None, None]
    fit = jnp.asarray(images.fit.T, z.dtype)
    if isinstance(body, PowerModulus):
        stiff, own = body.at(z)[:, None] * q**body.k, _own_responses(nu, z[:, None] * q)
        more = (stiff - body.shallow(z)[:, None]) * own
        # At the surface itself tractions are those that are given, however stiff the skin below it is.
        return (jnp.where(moved, stiff, (z > 0.0)[:, None]) * body.responses(z, q) + jnp.where(moved, more, 0.0)) @ fit
    edges, even = depths_for(body, q, 2)

    def at(z: Array) -> Array:
        found = responses(body.between, edges, even, z, q, nu) * jnp.where(moved, body.at(z)[:, None], 1.0)
        return (found - _own_responses(nu, z[:, None] * q)) @ fit

    if z.size <= _MANY:
        return at(z)
    padded = jnp.pad(z, (0, -z.size % _MANY)).reshape(-1, _MANY)
    found = jnp.moveaxis(lax.map(at, padded), 0, 1)
    return found.reshape(found.shape[0], -1, found.shape[-1])[:, : z.size]


def _parts(nu: Array) -> Array:
    """How the integrals of J_i with each response of each traction add to xx, yy, zz and xz, shape (4, 8, 4, 2)."""
    by_each = _PATTERNS[..., None] * _RESPONSES[:, None, :2]
    (fixed, along), ratio = in_dtype(nu.dtype, *by_each), nu / (1.0 - nu)
    across = along[np.array([1, 0, 2, 3])]
    # sigma_ss = ratio sigma_zz + 2/(1-nu) times the displacement, sigma_tt = ratio (sigma_zz + 2 times it).
    return fixed + 2.0 / (1.0 - nu) * along + ratio * (2.0 * across + jnp.roll(along + across, 1, axis=1))


def field(pressed: Pressed, body: Body, worn: bool, x: Array, z: Array) -> Stress:
    """Stresses in Pa of one contact at x and z in units of a_0, which broadcast; fast where both do so."""
    return Stress(*jnp.sum(of_each_traction(pressed, body, worn, x, z), -1))


def of_each_traction(pressed: Pressed, body: Body, worn: bool, x: Array, z: Array) -> Array:
    """The stresses by the pressure and by the traction along the motion, (4, ..., 2)."""
    shape = jnp.broadcast_shapes(x.shape, z.shape)
    x, z = (at.reshape((1,) * (len(shape) - at.ndim) + at.shape) for at in (x, z))
    nu, images = pressed.nu, grid(pressed.fineness.spacing, x.dtype == jnp.float64)
    parts = _parts(nu)
    # First the places, then for each x all images.
    near = jnp.maximum(z, jnp.finfo(z.dtype).eps ** 2)
    places, heights = (jnp.broadcast_to(at, shape).ravel() for at in (x, near))
    if body is not None:
        places = jnp.append(places, jnp.repeat(x.ravel(), images.zeta.size))
        heights = jnp.append(heights, jnp.tile(jnp.asarray(images.zeta, z.dtype), x.size))
    count = math.prod(shape)
    found, rate = transforms(pressed.tractions(worn), heights, places, count)
    value, rate = found[:, :count].reshape(4, *shape, 2), rate.reshape(4, *shape, 2)
    each = _first_responses(nu)
    if isinstance(body, PowerModulus):
        each = (jnp.where(_MOVED, body.shallow(z)[..., None], 1.0) * one for one in each)
    first, second = (jnp.einsum("crit,...r->ci...t", parts, one) for one in each)
    rising = z[..., None] * jnp.einsum("ci...t,i...t->c...t", second, rate)
    stress = jnp.einsum("ci...t,i...t->c...t", first, value) + rising
    if body is not None:
        weights = _image_weights(body, nu, z.ravel(), images).reshape(8, *z.shape, -1)
        each = found[:, count:].reshape(4, *x.shape, -1, 2)
        stress += jnp.einsum("r...m,cr...mt->c...t", weights, jnp.einsum("crit,i...mt->cr...mt", parts, each))
    return stress
