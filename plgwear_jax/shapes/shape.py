"""What a contact asks of a shape, and its answer by quadrature for any f(r).

Heights are in units of c^2/R, T = (r/c)^2. All contacts need what Abel's integral with the exponent a makes of f,

    G(T) = integral over r' from 0 to r of f'(r') (1 - (r'/r)^2)^(a-1) dr',

and those that are solved by sums of pressures the moments of f and of r f'(r) with the pressures of `special.jacobi`.
Radii where f' jumps are ends of the quadrature's pieces.
"""

import dataclasses
from typing import Any, ClassVar, NamedTuple, cast

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import Domain, RecordFamily, field_nan_outside, record
from plgwear_jax.special.elementary import value_with_slope
from plgwear_jax.special.jacobi import jacobi_table, ratios
from plgwear_jax.special.quadrature import Rule, bent, logistic, pieces
from plgwear_jax.special.root import root_of


@record
class AbelTransform:
    """G of a shape, of which a subclass gives `at` or `fallen`."""

    first: Array  # G(1)
    kink_positions: Array | np.ndarray  # T - 1 where G bends, increasing: `kink_positions_at`

    def at(self, T: Array) -> Array:
        """G at T of shape (m,)."""
        return self.first + self.fallen(T - 1.0)

    def fallen(self, y: Array) -> Array:
        """G(1 + y) - G(1) at y of shape (m,)."""
        return self.at(1.0 + y) - self.first

    def rate(self, T: Array, above: Array) -> Array:
        """The slope of G by T, which may be singular above a kink: with T come its differences from those of kinks."""
        return value_with_slope(self.at, T)[1]


class Shape(RecordFamily):
    """The shape of an indenter: `FrettingContact(..., shape=...)` takes an instance of any subclass.

    A subclass gives the height of its indenter. All that a contact needs besides is computed by quadrature. Without a
    decorator it becomes a frozen dataclass and a pytree of its fields, by which results can be differentiated.

    Where f' jumps the pressure is infinite, as at the tip of a cone, on a half-space that is as stiff at its surface as
    below or stiffer (k <= 0). There, pressures are given at a distance. Where f' bends the pressure has a kink.

    Attributes:
        tables: Names of the fields that hold one array each with a last axis of its own, such as the radii of a table.
            All other fields hold numbers; arrays of these are several indenters.
        ranges: What fields may be, by their names.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, Shape
        >>> class Wavy(Shape):
        ...     steep: float
        ...
        ...     def height(self, r, radius):
        ...         return r**2 / (2 * radius) + self.steep * r**4
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4, shape=Wavy(1e9))
        >>> print(f"{contact.steady(0.0).contact_radius:.3e} m")
        6.618e-05 m

    References:
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    tables: ClassVar[tuple[str, ...]] = ()
    ranges: ClassVar[dict[str, Domain]] = {}
    steepens: ClassVar[bool] = False  # whether r f'(r) nowhere falls, so that nothing pulls on a power law

    def guarded(self) -> "Shape":
        """The shape, with NaN for traced fields outside their range."""
        return dataclasses.replace(cast(Any, self), **{name: field_nan_outside(self, name) for name in self.ranges})

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m at radii in m, elementwise and by functions of `jax.numpy`; f(0) is subtracted.

        Args:
            r: Radii in m, r >= 0.
            radius: R in m, the `radius` of the contact. Shapes that have lengths of their own leave it unused.
        """
        raise NotImplementedError(f"{type(self).__name__} has no height(r, radius)")

    @property
    def kinks(self) -> Any:
        """Radii in m, increasing, where the slope f' jumps or bends: a sequence of numbers, or an array."""
        return ()

    @property
    def corners(self) -> Any:
        """Radii in m, increasing, at which integrals over the inside of a contact are divided: by default all kinks."""
        return self.kinks

    @property
    def face(self) -> Any:
        """The radius in m of a flat face, beyond which any contact reaches."""
        return 0.0

    @property
    def known_radius(self) -> Any:
        """The radius in m up to which f is known; None if it is known everywhere."""
        return None

    def unbounded(self, radius: Array, k: Array) -> tuple[Array, Array]:
        """Whether the pressure is infinite (at the tip, on a ring around it) where G goes as q^(k-1) at large q."""
        pointed = Outline(self, radius).slope(0.0 * radius) > 0.0
        return pointed & (k <= 0.0), jnp.zeros_like(pointed)

    def moments(self, c: Array, radius: Array, s: Array, count: int) -> tuple[Array, Array]:
        """The moments of f and of r f'(r) with `count` pressures, for the contact radius c in m, each (count,)."""
        outline = Outline(self, radius)
        x, weights = _places_below(self.kinks, c, s, bent(6 * count, -0.88))
        r, one = c * x, jnp.ones_like(s)
        scale = 2.0 * x * weights * (radius / (c * c))
        values = jnp.stack([outline.height(r), r * outline.slope(r)], -1) * scale[:, None]
        found = ratios(s, one, s, count)[:, None] * (jacobi_table(count, s, one, 1.0 - 2.0 * x * x) @ values)
        return found[:, 0], found[:, 1]

    def image(self, c: Array, radius: Array, a: Array) -> AbelTransform:
        """G beside the contact of the radius c in m."""
        return with_first(Computed(c, kink_positions_at(self.kinks, c), c, Outline(self, radius), a))

    def log_radius(self, radius: Array, log_load: Array, k: Array) -> Array:
        """The logarithm of the contact radius in m on a power law, for F_N R over its stiffness; not differentiable."""
        shape, radius, log_load, k = lax.stop_gradient((self, radius, log_load, k))
        s = 0.5 * (1.0 + k)

        def excess(log_c: Array) -> Array:
            # As in `punch_at` of `surfaces.power_laws.OnePower`.
            depth, mean = Outline(shape, radius).firsts(jnp.exp(log_c), s)
            some = depth > mean
            force = jnp.log(4.0 * s) + jnp.log(jnp.where(some, depth - mean, 1.0))
            return jnp.where(some, (3.0 + k) * log_c + force - log_load, -1.0)

        parabola = (log_load + jnp.log(0.25 * (3.0 + k))) / (3.0 + k)
        return root_of(excess, parabola, 3.0)


class Outline(NamedTuple):
    """A shape with its R."""

    shape: Shape
    radius: Array

    def height(self, r: Array) -> Array:
        """f(r) - f(0) in m: an own shape may be measured from elsewhere than its apex."""
        return self.shape.height(r, self.radius) - self.shape.height(jnp.zeros_like(self.radius), self.radius)

    def slope(self, r: Array) -> Array:
        """f'(r)."""
        return value_with_slope(self.height, r)[1]

    def image(self, c: Array, a: Array) -> AbelTransform:
        """See `Shape.image`."""
        return self.shape.image(c, self.radius, a)

    def firsts(self, c: Array, s: Array) -> tuple[Array, Array]:
        """G(1) for the exponents s and s + 1."""
        depth, mean = jax.vmap(lambda a: self.image(c, a).first)(jnp.stack([s, s + 1.0]))
        return depth, mean


# --- by quadrature ----------------------------------------------------------------------------------------------------


def kink_positions_at(kinks: Any, c: Array) -> Array:
    """T - 1 at these radii; constants for derivatives, since they only divide an integral."""
    return lax.stop_gradient(-inwards(kinks, c))


def inwards(kinks: Any, c: Array) -> Array:
    """1 - T at these radii."""
    kinks = jnp.asarray(kinks, c.dtype)
    return (c - kinks) * (c + kinks) / (c * c)


def _places_below(kinks: Any, end: Array, power: Array, rule: Rule) -> tuple[Array, Array]:
    """(Places x, weights) of the integral over x = r/end from 0 to 1 of a function times (1 - x^2)^(power-1)."""
    parts = pieces(jnp.asarray(kinks, power.dtype) / end, power, rule)
    weights, last = parts.singular(power)
    x = jnp.append(parts.x, jnp.ones_like(end))
    return x, jnp.append(weights, last) * jnp.exp((power - 1.0) * jnp.log1p(x))


_RULE = logistic(80, 26.0)


@record
class Computed(AbelTransform):
    """G of any outline, by quadrature."""

    c: Array
    outline: Outline
    a: Array

    def at(self, T: Array) -> Array:
        """See `AbelTransform`."""
        outline, c = self.outline, self.c

        def up_to(end: Array) -> Array:
            x, weights = _places_below(outline.shape.kinks, end, self.a, _RULE)
            return end * jnp.sum(weights * outline.slope(end * x))

        return (outline.radius / (c * c)) * jax.vmap(up_to)(c * jnp.sqrt(T))


def with_first(image: Any) -> AbelTransform:
    """The image of a contact of the radius c, with its `first`."""
    return dataclasses.replace(image, first=image.at(jnp.ones(1, image.c.dtype))[0])
