"""The shape of an indenter: its height f(r) above the apex, f(0) = 0, which increases with the radius r.

Numeric contacts need, in units of c^2/R for heights and with T = (r/c)^2, the moments of f and of r f'(r) with the
pressures of `special.jacobi`, and what Abel's integral with the exponent a makes of f,

    G(T) = integral over r' from 0 to r of f'(r') (1 - (r'/r)^2)^(a-1) dr'.

Radii where f' jumps are ends of the quadrature's pieces.
"""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple, dataclass_transform

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, Domain, check, guarded
from plgwear_jax._core.record import number_or, record, static
from plgwear_jax.special.jacobi import jacobi_table, ratios
from plgwear_jax.special.quadrature import Rule, bent, logistic, pieces
from plgwear_jax.special.root import root_of

__all__ = ["EXPONENT", "Outline", "Parabola", "PowerShape", "Shape", "outline_of", "shape_of", "unworn_of"]

EXPONENT = Domain("2 <= exponent <= 8", lambda n: (n >= 2.0) & (n <= 8.0))


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, static, number_or))
class Shape:
    """The shape of an indenter: `FrettingContact(..., shape=...)` takes an instance of any subclass.

    A subclass gives the height of its indenter. All that a contact needs besides is computed by quadrature. Without a
    decorator it becomes a frozen dataclass and a pytree of its fields, by which results can be differentiated.

    Attributes:
        tables: Names of the fields that hold one array each with a last axis of its own, such as the radii of a table.
            All other fields hold numbers; arrays of these are several indenters.

    Example:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, Shape
        >>> class Cone(Shape):
        ...     slope: float
        ...
        ...     def height(self, r, radius):
        ...         return self.slope * r
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4, shape=Cone(0.01))
        >>> print(f"{contact.contact_radius():.3e} m")
        7.257e-05 m
    """

    tables: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        record(cls)

    def __post_init__(self) -> None:
        """Check the fields, as far as they are concrete."""

    def guarded(self) -> "Shape":
        """The shape, with NaN for traced fields outside their range."""
        return self

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m at radii in m, elementwise and by functions of `jax.numpy`, f(0) = 0.

        Args:
            r: Radii in m, r >= 0.
            radius: R in m, the `radius` of the contact. Shapes that have lengths of their own leave it unused.
        """
        raise NotImplementedError(f"{type(self).__name__} has no height(r, radius)")

    @property
    def kinks(self) -> Sequence[Any]:
        """Radii in m, increasing, where the slope f' jumps or bends."""
        return ()

    def moments(self, c: Array, radius: Array, s: Array, count: int) -> tuple[Array, Array]:
        """The moments of f and of r f'(r) with `count` pressures, for the contact radius c in m, each (count,)."""
        outline = Outline(self, radius)
        x, weights = _places(self.kinks, c, s, bent(6 * count, -0.88))
        r, one = c * x, jnp.ones_like(s)
        scale = 2.0 * x * weights * (radius / (c * c))
        values = jnp.stack([outline.height(r), r * outline.slope(r)], -1) * scale[:, None]
        found = ratios(s, one, s, count)[:, None] * (jacobi_table(count, s, one, 1.0 - 2.0 * x * x) @ values)
        return found[:, 0], found[:, 1]

    def image(self, c: Array, radius: Array, a: Array) -> "Image":
        """G beside the contact of the radius c in m."""
        outline, near = Outline(self, radius), 0.01
        first, second = _image_at(outline, c, a, jnp.asarray([0.0, near], c.dtype))
        return Computed(outline, c, a, first, (second - first) / near)

    def log_radius(self, radius: Array, log_load: Array, k: Array) -> Array:
        """An estimate of the logarithm of the contact radius in m, for F_N R over the stiffness of one body."""
        outline, log_load, k = jax.lax.stop_gradient((Outline(self, radius), log_load, k))
        half = 0.5 * (1.0 + k)

        def excess(log_c: Array) -> Array:
            c = jnp.exp(log_c)
            x, weights = _places(outline.kinks, c, half, _RULE)
            force = (1.0 + k) * outline.radius * jnp.sum(2.0 * x * weights * (c * x) * outline.slope(c * x))
            some = force > 0.0  # as in `surfaces.punch.surplus`
            return jnp.where(some, (1.0 + k) * log_c + jnp.log(jnp.where(some, force, 1.0)) - log_load, -1.0)

        parabola = (log_load + jnp.log(0.25 * (3.0 + k))) / (3.0 + k)
        return root_of(excess, parabola, 3.0)


class Outline(NamedTuple):
    """A shape with its R."""

    shape: Shape
    radius: Array

    @property
    def kinks(self) -> Sequence[Any]:
        """Where f' jumps."""
        return self.shape.kinks

    def height(self, r: Array) -> Array:
        """f(r) in m."""
        return self.shape.height(r, self.radius)

    def slope(self, r: Array) -> Array:
        """f'(r)."""
        return jax.jvp(self.height, (r,), (jnp.ones_like(r),))[1]

    def moments(self, c: Array, s: Array, count: int) -> tuple[Array, Array]:
        """See `Shape.moments`."""
        return self.shape.moments(c, self.radius, s, count)

    def image(self, c: Array, a: Array) -> "Image":
        """See `Shape.image`."""
        return self.shape.image(c, self.radius, a)

    def log_radius(self, log_load: Array, k: Array) -> Array:
        """See `Shape.log_radius`."""
        return self.shape.log_radius(self.radius, log_load, k)


# --- any shape, by quadrature -----------------------------------------------------------------------------------------


def _stacked(kinks: Sequence[Any], dtype: Any) -> Array | np.ndarray:
    return jnp.stack([jnp.asarray(kink, dtype) for kink in kinks]) if len(kinks) else np.zeros(0, dtype)


def _places(kinks: Sequence[Any], end: Array, power: Array, rule: Rule) -> tuple[Array, Array]:
    """(Places x, weights) of the integral over x = r/end from 0 to 1 of a function times (1 - x^2)^(power-1)."""
    parts = pieces(_stacked(kinks, power.dtype) / end, power, rule)
    weights, last = parts.singular(power)
    x = jnp.append(parts.x, jnp.ones_like(end))
    return x, jnp.append(weights, last) * jnp.exp((power - 1.0) * jnp.log1p(x))


class Computed(NamedTuple):
    """G of any outline, by quadrature."""

    outline: Outline
    c: Array
    a: Array
    first: Array  # G(1)
    fall: Array  # about the slope of G at T = 1

    @property
    def bends(self) -> Array | np.ndarray:
        """T - 1 of the kinks, increasing; a constant for derivatives, since they only divide an integral."""
        kinks, c = jax.lax.stop_gradient((_stacked(self.outline.kinks, self.c.dtype), self.c))
        return (kinks - c) * (kinks + c) / (c * c)

    def fallen(self, y: Array) -> Array:
        """G(1 + y) - G(1) at y of shape (m,)."""
        return _image_at(self.outline, self.c, self.a, y) - self.first


_RULE = logistic(64, 22.0)


def _image_at(outline: Outline, c: Array, a: Array, y: Array) -> Array:
    def at(end: Array) -> Array:
        x, weights = _places(outline.kinks, end, a, _RULE)
        return end * jnp.sum(weights * outline.slope(end * x))

    return (outline.radius / (c * c)) * jax.vmap(at)(c * jnp.sqrt(1.0 + y))


# --- closed forms -----------------------------------------------------------------------------------------------------


class Power(NamedTuple):
    """G = first T^power."""

    first: Array
    power: Array | None = None  # None for 1

    @property
    def fall(self) -> Array:
        """The slope at T = 1."""
        return self.first if self.power is None else self.power * self.first

    @property
    def bends(self) -> np.ndarray:
        """There are none."""
        return np.zeros(0)

    def fallen(self, y: Array) -> Array:
        """G(1 + y) - G(1)."""
        return self.fall * (y if self.power is None else jnp.expm1(self.power * jnp.log1p(y)) / self.power)


class Parabola(Shape):
    """An indenter f(r) = r^2/(2R), R being the radius of the contact."""

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m; by NumPy of numbers of NumPy."""
        return 0.5 * r * r / radius

    def moments(self, c: Array, radius: Array, s: Array, count: int) -> tuple[Array, Array]:
        """Those of T/2."""
        first, second = jnp.asarray(np.eye(count, 2).T, c.dtype)
        found = 0.5 / (1.0 + s) * (first - second / (2.0 + s))
        return found, 2.0 * found

    def image(self, c: Array, radius: Array, a: Array) -> Power:
        """In closed form."""
        return Power(0.5 / a)

    def log_radius(self, radius: Array, log_load: Array, k: Array) -> Array:
        """In closed form."""
        return (log_load + jnp.log(0.25 * (3.0 + k))) / (3.0 + k)


class PowerShape(Shape):
    """An indenter f(r) = r^n/(n R^(n-1)), R being the radius of the contact.

    With n = 2 it is the parabola of the radius of curvature R. For any other n it is R at which f has the slope 1. The
    larger n, the flatter the middle and the smaller the radius of curvature at the edge of the contact.

    Attributes:
        exponent: n, 2 <= n <= 8.

    Raises:
        ValueError: A concrete exponent is outside its range. A traced one turns results into NaN.
    """

    exponent: ArrayLike

    def __post_init__(self) -> None:
        """Check the exponent."""
        check("exponent", self.exponent, EXPONENT)

    def guarded(self) -> "PowerShape":
        """The shape, with NaN for a traced exponent outside its range."""
        return dataclasses.replace(self, exponent=guarded("exponent", self.exponent, EXPONENT))

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m; by NumPy of numbers of NumPy."""
        return radius / self.exponent * (r / radius) ** self.exponent

    def _log_size(self, radius: Array) -> Array:
        """The logarithm of R^(2-n)/n, which times c^(n-2) T^(n/2) is f in units of c^2/R."""
        n = jnp.asarray(self.exponent)
        return (2.0 - n) * jnp.log(radius) - jnp.log(n)

    def _at(self, c: Array, radius: Array) -> Array:
        return jnp.exp(self._log_size(radius) + (jnp.asarray(self.exponent) - 2.0) * jnp.log(c))

    def _lifted(self, a: Array) -> Array:
        """The factor of T^(n/2) that Abel's integral with the exponent a takes to T^(n/2)."""
        p = 0.5 * jnp.asarray(self.exponent)
        return jnp.exp(jnp.sum(jax.lax.lgamma(jnp.stack([1.0 + p, a]))) - jax.lax.lgamma(p + a))

    def moments(self, c: Array, radius: Array, s: Array, count: int) -> tuple[Array, Array]:
        """In closed form."""
        p, j = 0.5 * jnp.asarray(self.exponent), jnp.asarray(np.arange(count - 1), s.dtype)
        steps = jnp.cumprod((j - p) / (p + 1.0 + s + j))
        first = jnp.exp(jnp.sum(jax.lax.lgamma(jnp.stack([1.0 + p, 1.0 + s]))) - jax.lax.lgamma(1.0 + p + s))
        found = self._at(c, radius) * (first * jnp.append(jnp.ones_like(s), steps))
        return found, 2.0 * p * found

    def image(self, c: Array, radius: Array, a: Array) -> Power:
        """In closed form."""
        return Power(self._at(c, radius) * self._lifted(a), 0.5 * jnp.asarray(self.exponent))

    def log_radius(self, radius: Array, log_load: Array, k: Array) -> Array:
        """In closed form at k = 0."""
        n = jnp.asarray(self.exponent)
        wide = jnp.log(0.5 * (n + 1.0 + k) / (n * self._lifted(jnp.full_like(n, 0.5))))
        return (log_load + wide - self._log_size(radius)) / (n + 1.0 + k)


Image = Power | Computed


# --- of a contact -----------------------------------------------------------------------------------------------------


def shape_of(contact: Any) -> Shape:
    """The shape of a contact's indenter: without one it is the parabola."""
    shape = getattr(contact, "shape", None)
    return Parabola() if shape is None else shape


def outline_of(contact: Any) -> Outline:
    """The shape of a contact's indenter with its R."""
    radius = guarded("radius", contact.radius, POSITIVE)
    shape = jax.tree.map(lambda x: jnp.asarray(x, radius.dtype), shape_of(contact))
    return Outline(shape.guarded(), radius)


def unworn_of(contact: Any) -> Callable[[Any], Any]:
    """f of a contact, by radii in m."""
    shape = shape_of(contact)
    return lambda r: shape.height(r, contact.radius)
