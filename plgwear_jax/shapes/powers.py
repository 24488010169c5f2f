"""Indenters that are a power of the radius, in closed form."""

from typing import ClassVar

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import POSITIVE, Numbers, record
from plgwear_jax._core.ranges import SHAPE_EXPONENT

from .shape import AbelTransform, Shape


@record
class Power(AbelTransform):
    """G = first T^power."""

    power: Array | None = None  # None for 1

    def fallen(self, y: Array) -> Array:
        """See `AbelTransform`."""
        return self.first * (y if self.power is None else jnp.expm1(self.power * jnp.log1p(y)))

    def rate(self, T: Array, above: Array) -> Array:
        """See `AbelTransform`."""
        power = self.power
        return self.first * (jnp.ones_like(T) if power is None else power * jnp.exp((power - 1.0) * jnp.log(T)))


class Parabola(Shape):
    """An indenter f(r) = r^2/(2R), R being the `radius` of the contact.

    Examples:
        >>> from plgwear_jax.shapes import Parabola
        >>> print(f"{Parabola().height(1e-4, 5e-3):.2e}")  # r^2/(2 R), in m
        1.00e-06

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: above Eq. (11).
    """

    steepens = True

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m; by NumPy of numbers of NumPy."""
        return 0.5 * r * r / radius

    def moments(self, c: Array, radius: Array, s: Array, count: int) -> tuple[Array, Array]:
        """Those of T/2."""
        first, second = np.eye(count, 2, dtype=s.dtype).T
        found = 0.5 / (1.0 + s) * (first - second / (2.0 + s))
        return found, 2.0 * found

    def image(self, c: Array, radius: Array, a: Array) -> Power:
        """In closed form."""
        return Power(0.5 / a, np.zeros(0, c.dtype))

    def log_radius(self, radius: Array, log_load: Array, k: Array) -> Array:
        """In closed form."""
        return (log_load + jnp.log(0.25 * (3.0 + k))) / (3.0 + k)


class _OnePower(Shape):
    """f(r) = size r^n/R, of which a subclass gives n."""

    steepens = True

    def _n(self) -> Array:
        raise NotImplementedError

    def _log_size(self, radius: Array) -> Array:
        return jnp.log(self.height(radius, radius)) + (1.0 - self._n()) * jnp.log(radius)

    def unbounded(self, radius: Array, k: Array) -> tuple[Array, Array]:
        """Infinite at the tip up to n = 1 - k."""
        pointed = self._n() + k <= 1.0
        return pointed, jnp.zeros_like(pointed)

    def _at(self, c: Array, radius: Array) -> Array:
        """The factor of T^(n/2) that f is in units of c^2/R."""
        return jnp.exp(self._log_size(radius) + (self._n() - 2.0) * jnp.log(c))

    def _log_lifted(self, a: Array) -> Array:
        """The logarithm of the factor of T^(n/2) that Abel's integral with the exponent a takes to T^(n/2)."""
        p = 0.5 * self._n()
        return jnp.sum(lax.lgamma(jnp.stack([1.0 + p, a]))) - lax.lgamma(p + a)

    def moments(self, c: Array, radius: Array, s: Array, count: int) -> tuple[Array, Array]:
        """In closed form."""
        p, j = 0.5 * self._n(), jnp.asarray(np.arange(count - 1), s.dtype)
        steps = jnp.cumprod((j - p) / (p + 1.0 + s + j))
        first = jnp.exp(self._log_lifted(1.0 + s))
        found = self._at(c, radius) * (first * jnp.append(jnp.ones_like(s), steps))
        return found, 2.0 * p * found

    def image(self, c: Array, radius: Array, a: Array) -> Power:
        """In closed form."""
        return Power(self._at(c, radius) * jnp.exp(self._log_lifted(a)), np.zeros(0, c.dtype), 0.5 * self._n())

    def log_radius(self, radius: Array, log_load: Array, k: Array) -> Array:
        """In closed form."""
        n, s = self._n(), 0.5 * (1.0 + k)
        wide = jnp.log((n + 1.0 + k) / (4.0 * n * s)) - self._log_lifted(s) - self._log_size(radius)
        return (log_load + wide) / (n + 1.0 + k)


class PowerShape(_OnePower):
    """An indenter f(r) = r^n/(n R^(n-1)), R being the `radius` of the contact.

    With n = 2 it is the parabola of the radius of curvature R. For any other n it is R at which f has the slope 1. The
    larger n, the flatter the middle and the smaller the radius of curvature at the edge of the contact. Up to n = 1 - k
    the pressure before any wear is infinite at r = 0.

    Attributes:
        exponent: n >= 1 and finite.

    Raises:
        ValueError: A concrete exponent is outside its range. A traced one turns results into NaN.

    Examples:
        >>> from plgwear_jax.shapes import PowerShape
        >>> print(f"{PowerShape(4).height(1e-4, 5e-3):.2e}")  # r^4/(4 R^3), in m
        2.00e-10

    References:
        Popov and Heß, Method of Dimensionality Reduction in Contact Mechanics and Friction (2015).
    """

    exponent: Numbers

    ranges: ClassVar = {"exponent": SHAPE_EXPONENT}

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m; by NumPy of numbers of NumPy."""
        return radius / self.exponent * (r / radius) ** self.exponent

    def _n(self) -> Array:
        return jnp.asarray(self.exponent)


class Cone(_OnePower):
    """An indenter f(r) = slope r; the `radius` of the contact has no effect.

    The pressure before any wear is infinite at the tip r = 0 for k <= 0. For k > 0 it rises to a finite value there.

    Attributes:
        slope: The slope f', positive: the tangent of the angle between the face of the cone and the surface.

    Raises:
        ValueError: A concrete slope is outside its range. A traced one turns results into NaN.

    Examples:
        >>> from plgwear_jax.shapes import Cone
        >>> print(f"{Cone(0.01).height(1e-4, 5e-3):.2e}")  # in m
        1.00e-06

    References:
        Sneddon, International Journal of Engineering Science 3 (1965) 47.
    """

    slope: Numbers

    ranges: ClassVar = {"slope": POSITIVE}

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m."""
        return jnp.multiply(self.slope, r)

    def _n(self) -> Array:
        return jnp.ones_like(self.slope)
