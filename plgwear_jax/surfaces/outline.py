"""The outline of an indenter as the engine sees it, and by quadrature all that it needs of a height f(r).

In units of c^2/R for heights, with T = (r/c)^2, the engine asks for the moments of f and of r f'(r) with the pressures
of `jacobi`, and for what Abel's integral with the exponent a takes to f,

    G(T) = integral over r' from 0 to r of f'(r') (1 - (r'/r)^2)^(a-1) dr'.

Radii where f' jumps are ends of the quadrature's pieces. Places in a piece are those of the trapezoidal rule in
log(x/(1-x)), which bears singularities at both of its ends.
"""

import functools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.surfaces.jacobi import jacobi_table, ratios
from plgwear_jax.surfaces.root import root_of

__all__ = ["Image", "Outline", "begin_of", "image_of", "logistic", "moments_of", "pieces"]


class Image(Protocol):
    """G of one contact, a pytree."""

    @property
    def first(self) -> Array:
        """G(1)."""
        ...

    @property
    def fall(self) -> Array:
        """About the slope of G at T = 1."""
        ...

    @property
    def bends(self) -> Array | np.ndarray:
        """T - 1 of the kinks, increasing."""
        ...

    def fallen(self, y: Array) -> Array:
        """G(1 + y) - G(1) at y of shape (m,)."""
        ...


class Outline(Protocol):
    """The shape of an indenter with its R, a pytree."""

    def moments(self, c: Array, s: Array, count: int) -> tuple[Array, Array]:
        """Those of f and of r f'(r) for the contact radius c in m, each of shape (count,)."""
        ...

    def image(self, c: Array, a: Array) -> Image:
        """G beside the contact of the radius c in m."""
        ...

    def log_radius(self, log_load: Array, k: Array) -> Array:
        """About the logarithm of the contact radius in m, for F_N R over the stiffness of one body."""
        ...


Slope = Callable[[Array], Array]  # f' by the radius in m


Rule = tuple[np.ndarray, np.ndarray, np.ndarray]  # x, 1 - x, weights of an integral over x from 0 to 1


@functools.cache
def logistic(count: int, most: float = 17.0) -> Rule:
    """In equal steps of log(x/(1-x))."""
    v, step = np.linspace(-most, most, count, retstep=True)
    inside, outside = 1.0 / (1.0 + np.exp(-v)), 1.0 / (1.0 + np.exp(v))
    return inside, outside, step * inside * outside


@functools.cache
def bent(count: int, begin: float = -0.75) -> Rule:
    """In steps of log(x/(1-x)) that grow towards both ends and go further towards 1, for functions that oscillate."""
    w = np.linspace(begin, 1.0, count)
    bend = 2.4
    scale = 36.0 / np.sinh(bend)
    v, slope = scale * np.sinh(bend * w), scale * bend * np.cosh(bend * w)
    inside, outside = 1.0 / (1.0 + np.exp(-v)), 1.0 / (1.0 + np.exp(v))
    return inside, outside, (w[1] - w[0]) * slope * inside * outside


class Pieces(NamedTuple):
    """A rule for integrals over x from 0 to 1 in pieces."""

    x: Array
    left: Array  # 1 - x
    weight: Array
    last: Array | float  # the length of the last piece
    places: int  # in a piece

    def singular(self, power: Array) -> tuple[Array, Array]:
        """(Weights of the integral of a function times (1-x)^(power-1), and that of its value at the end).

        The latter is what the rule leaves out, which lies there.
        """
        weight = self.weight * jnp.exp((power - 1.0) * jnp.log(self.left))
        whole = jnp.exp(power * jnp.log(self.last)) / power
        return weight, whole - jnp.sum(weight[-self.places :])


def pieces(inner: Array | np.ndarray, like: Array, rule: Rule) -> Pieces:
    """The rule between 0, inner x that increase, and 1; those not between 0 and 1 have no part."""
    inside, outside, weight = (jnp.asarray(x, like.dtype) for x in rule)
    if not inner.size:
        return Pieces(inside, outside, weight, 1.0, weight.size)
    # Beyond 1 it is where the piece before it begins: a piece without a length, whose places are those of the whole.
    inner = jax.lax.cummax(jnp.where((inner > 0.0) & (inner < 1.0), inner, 0.0))
    begins, ends = jnp.append(jnp.zeros_like(like), inner), jnp.append(inner, jnp.ones_like(like))
    length = (ends - begins)[:, None]
    x = jnp.where(length > 0.0, begins[:, None] + length * inside, inside)
    left = jnp.where(length > 0.0, (1.0 - ends)[:, None] + length * outside, outside)
    return Pieces(x.ravel(), left.ravel(), (length * weight).ravel(), length[-1, 0], weight.size)


def _stacked(kinks: Sequence[Any], dtype: Any) -> Array | np.ndarray:
    return jnp.stack([jnp.asarray(kink, dtype) for kink in kinks]) if len(kinks) else np.zeros(0, dtype)


def _places(kinks: Sequence[Any], end: Array, power: Array, rule: Rule) -> tuple[Array, Array]:
    """(Places x, weights) of the integral over x = r/end from 0 to 1 of a function times (1 - x^2)^(power-1)."""
    parts = pieces(_stacked(kinks, power.dtype) / end, power, rule)
    weights, last = parts.singular(power)
    x = jnp.append(parts.x, jnp.ones_like(end))
    return x, jnp.append(weights, last) * jnp.exp((power - 1.0) * jnp.log1p(x))


def moments_of(
    height: Slope, slope: Slope, kinks: Sequence[Any], c: Array, radius: Array, s: Array, count: int
) -> tuple[Array, Array]:
    """As of `Outline`."""
    x, weights = _places(kinks, c, s, bent(6 * count, -0.88))
    r, one = c * x, jnp.ones_like(s)
    values = jnp.stack([height(r), r * slope(r)], -1) * (2.0 * x * weights * (radius / (c * c)))[:, None]
    found = ratios(s, one, s, count)[:, None] * (jacobi_table(count, s, one, 1.0 - 2.0 * x * x) @ values)
    return found[:, 0], found[:, 1]


class Computed(NamedTuple):
    """G of any outline."""

    outline: Any  # with a slope and kinks
    c: Array
    a: Array
    first: Array
    fall: Array

    @property
    def bends(self) -> Array | np.ndarray:
        """As of `Image`; an integral is the same wherever it is parted."""
        kinks, c = jax.lax.stop_gradient((_stacked(self.outline.kinks, self.c.dtype), self.c))
        return (kinks - c) * (kinks + c) / (c * c)

    def fallen(self, y: Array) -> Array:
        """As of `Image`."""
        return _image_at(self.outline, self.c, self.a, y) - self.first


def image_of(outline: Any, c: Array, a: Array) -> Computed:
    """G of an outline with a slope f'(r), its `kinks` and its `radius`."""
    near = 0.01
    first, second = _image_at(outline, c, a, jnp.asarray([0.0, near], c.dtype))
    return Computed(outline, c, a, first, (second - first) / near)


_RULE = logistic(64, 22.0)


def _image_at(outline: Any, c: Array, a: Array, y: Array) -> Array:
    def at(end: Array) -> Array:
        x, weights = _places(outline.kinks, end, a, _RULE)
        return end * jnp.sum(weights * outline.slope(end * x))

    return (outline.radius / (c * c)) * jax.vmap(at)(c * jnp.sqrt(1.0 + y))


def begin_of(slope: Slope, kinks: Sequence[Any], radius: Array, log_load: Array, k: Array) -> Array:
    """The logarithm of the contact radius, as of `Outline`; a constant for derivatives, since it is an estimate."""
    half = 0.5 * (1.0 + k)

    def excess(log_c: Array) -> Array:
        c = jnp.exp(log_c)
        x, weights = _places(kinks, c, half, _RULE)
        force = (1.0 + k) * radius * jnp.sum(2.0 * x * weights * (c * x) * slope(c * x))
        some = force > 0.0  # as in `punch.surplus`
        return jnp.where(some, (1.0 + k) * log_c + jnp.log(jnp.where(some, force, 1.0)) - log_load, -1.0)

    parabola = (log_load + jnp.log(0.25 * (3.0 + k))) / (3.0 + k)
    return root_of(excess, parabola, 3.0)
