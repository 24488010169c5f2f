"""Indenters whose slope is a polynomial of the radius between some radii b_i, the knots, in closed form.

    f'(r) = sum over i and m of A_im (r - b_i)^m where r > b_i,      m < 3,

and Abel's integral with the exponent a takes (r - b)^m to r^(m+1) Phi_m(b/r),

    Phi_m(x) = integral over t from x to 1 of (t - x)^m (1 - t^2)^(a-1) dt
             = (1-x)^(m+a) 2^(a-1) m!/(a (a+1) ... (a+m)) 2F1(1-a, a; a+m+1; (1-x)/2).
"""

import math
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax
from jax.core import Tracer

from plgwear_jax._core.domains import NUMBER, Numbers, check_columns, nan_unless, record
from plgwear_jax.special.pchip import Piecewise, horner, pchip

from .shape import AbelTransform, Shape, kink_positions_at, with_first

_ORDERS = np.arange(3)
_TERMS = 56  # of a series in (1-x)/2 <= 1/2


def _series(a: Array) -> Array:
    """The coefficients of Phi_m (1-x)^(-m-a) by powers of (1-x)/2, shape (blocks, 8, orders)."""
    m, i = jnp.asarray(_ORDERS, a.dtype), jnp.asarray(np.arange(1.0, _TERMS - 1.0), a.dtype)[:, None]
    steps = jnp.log((1.0 - a + i) * (a + i) / ((a + m + 1.0 + i) * (1.0 + i)))
    # As in `special.jacobi.ratios`; the first factor 1 - a is 0 or negative from a = 1 on.
    later = jnp.exp(jnp.asarray(np.tri(_TERMS - 1, _TERMS - 2, -1), a.dtype) @ steps)
    below = jnp.cumprod(a + m)  # a (a+1) ... (a+m)
    front = jnp.exp2(a - 1.0) * jnp.asarray([math.factorial(n) for n in _ORDERS], a.dtype) / below
    terms = front * jnp.concatenate([jnp.ones_like(m)[None], (1.0 - a) * a / (a + m + 1.0) * later])
    return terms.reshape(-1, 8, _ORDERS.size)


@record
class Spline(AbelTransform):
    """G of such a shape, in units of c^2/R."""

    c: Array
    knots: Array  # (n,)
    slopes: Array  # A_im, (n, orders)
    series: Array
    a: Array
    radius: Array

    def rate(self, T: Array, above: Array) -> Array:
        """See `AbelTransform`."""
        count = self.kink_positions.size  # a table of many rows has none, but corners
        first = (self.knots.size - count) // 2
        last = first + count

        def at(T: Array, above: Array) -> Array:
            r = self.c * jnp.sqrt(T)[:, None]
            apart = r - self.knots  # of which roundings would be most where the slope of G is largest
            near = self.c * self.c * above[:, :count] / (r + self.knots[first:last])
            return self.at(T, jnp.concatenate([apart[:, :first], near, apart[:, last:]], 1))

        return jax.jvp(at, (T, above), (jnp.ones_like(T), jnp.ones_like(above)))[1]

    def at(self, T: Array, apart: Array | None = None) -> Array:
        """G, from how far the radii are beyond each knot."""
        r = self.c * jnp.sqrt(T)[:, None]
        apart = r - self.knots if apart is None else apart
        beyond = apart > 0.0
        left = jnp.where(beyond, apart, r) / r
        x = (0.5 * left)[..., None]
        powers = jnp.ones_like(x)
        for _ in range(3):
            powers, x = jnp.append(powers, x * powers, -1), x * x
        # By the eighth power, whose coefficients are the products of a matrix.
        total = horner([powers @ block for block in self.series], x)
        along = r * left
        own = self.slopes[:, 0] * total[..., 0] + along * (self.slopes[:, 1] * total[..., 1])
        own = r * jnp.exp(self.a * jnp.log(left)) * (own + along * along * (self.slopes[:, 2] * total[..., 2]))
        return (self.radius / (self.c * self.c)) * jnp.sum(jnp.where(beyond, own, 0.0), -1)


_MANY = 32  # rows of a table, from which on kinks are so many that they count no more
_CORNERS = 4  # of these that count where pressures are asked for
_MOST = 513  # rows of a table that count; see `Profile`


class _Splined(Shape):
    """A shape of which a subclass gives the knots and the A_im."""

    def _spline(self, radius: Array) -> tuple[Array, Array]:
        raise NotImplementedError

    def image(self, c: Array, radius: Array, a: Array) -> AbelTransform:
        """In closed form."""
        return with_first(Spline(c, kink_positions_at(self.kinks, c), c, *self._spline(radius), _series(a), a, radius))


class _Flat(_Splined):
    """An indenter with a flat face."""

    flat_radius: Numbers
    steepens = True
    corner: ClassVar[float]  # what the slope f' is at r = b, over b/R

    ranges: ClassVar = {"flat_radius": NUMBER}

    @property
    def face(self) -> Any:
        """All of the flat."""
        return self.flat_radius

    @property
    def kinks(self) -> Any:
        """The edge of the flat face."""
        return (self.face,)

    def unbounded(self, radius: Array, k: Array) -> tuple[Array, Array]:
        """Infinite where the face ends in a corner."""
        corner = (self.corner * jnp.asarray(self.flat_radius) > 0.0) & (k <= 0.0)
        return jnp.zeros_like(corner), corner

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m."""
        b = jnp.asarray(self.flat_radius)
        return 0.5 * jnp.maximum(r - b, 0.0) * (r + (2.0 * self.corner - 1.0) * b) / radius

    def _spline(self, radius: Array) -> tuple[Array, Array]:
        b = jnp.asarray(self.flat_radius)
        return b[None], jnp.stack([self.corner * b / radius, 1.0 / radius, 0.0 * radius])[None]


class RoundedFlat(_Flat):
    """A flat face with a round edge: f(r) = 0 up to r = b, (r - b)^2/(2R) beyond, R being the `radius` of the contact.

    The pressure before any wear has a kink at r = b.

    Attributes:
        flat_radius: b in m, >= 0.

    Raises:
        ValueError: A concrete radius is outside its range. A traced one turns results into NaN.

    Examples:
        >>> from plgwear_jax.shapes import RoundedFlat
        >>> print(f"{RoundedFlat(5e-5).height(1e-4, 5e-3):.2e}")  # (r - b)^2/(2 R), in m
        2.50e-07

    References:
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    corner = 0.0


class TruncatedSphere(_Flat):
    """A sphere worn or ground flat: f(r) = 0 up to r = b, (r^2 - b^2)/(2R) beyond, R being the `radius` of the contact.

    The pressure before any wear is infinite at r = b for k <= 0.

    Attributes:
        flat_radius: b in m, >= 0.

    Raises:
        ValueError: A concrete radius is outside its range. A traced one turns results into NaN.

    Examples:
        >>> from plgwear_jax.shapes import TruncatedSphere
        >>> print(f"{TruncatedSphere(5e-5).height(1e-4, 5e-3):.2e}")  # (r^2 - b^2)/(2 R), in m
        7.50e-07

    References:
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    corner = 1.0


class Profile(_Splined):
    """A measured shape: heights f at some radii, with a cubic without overshoot (PCHIP) between them.

    The table has to reach beyond the worn radius; gross slip is followed until the scar nears its end. Where it is
    steep at r = 0 it is a cone there: the pressure before any wear is infinite at the tip for k <= 0. At each radius of
    the table the pressure has a kink.

    Of a table of more than 513 rows, every second, third or further one counts, and the last, so that there are no more
    than 513. From 33 rows on results have fewer digits (`docs/explanation/accuracy.md`, "How exactly").

    Attributes:
        r: Radii in m, shape (..., points), increasing from 0; at least two.
        heights: Heights in m at these radii, shape (..., points), increasing from 0. The first ones may all be 0: a
            flat face.

    Raises:
        ValueError: Concrete radii or heights do not increase, or the table ends inside the worn radius. Traced ones
            turn results into NaN.

    Examples:
        >>> import numpy as np
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, Profile
        >>> r = np.linspace(0.0, 1.5e-4, 16)
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, 5e-3, 10.0, 0.4, shape=Profile(r, r**2 / 1e-2))
        >>> print(f"{contact.steady(0.0).contact_radius:.3e} m")
        6.768e-05 m

    References:
        The cubic between the points: Fritsch and Carlson, SIAM Journal on Numerical Analysis 17 (1980) 238.
    """

    r: Any  # an array or a list of numbers
    heights: Any
    tables = ("r", "heights")
    ranges: ClassVar = dict.fromkeys(tables, NUMBER)

    def __post_init__(self) -> None:
        """Check the table."""
        check_columns(self)
        for name in self.tables:
            given = getattr(self, name)
            if not isinstance(given, Tracer):
                _refuse_column(name, np.asarray(given))

    def guarded(self) -> "Profile":
        """The shape, with NaN for traced tables that do not increase."""
        r, heights = jnp.asarray(self.r), jnp.asarray(self.heights)
        right = _right("r", r) & _right("heights", heights)
        return Profile(r, nan_unless(right[..., None], heights))

    @property
    def kinks(self) -> Any:
        """The radii between the first and the last one, unless they are many."""
        r = jnp.asarray(self.r)
        return () if r.shape[-1] > _MANY else r[1:-1]

    @property
    def corners(self) -> Any:
        """Of many rows those where the shape bends most, such as the edge of a flat face."""
        if np.shape(self.r)[-1] <= _MANY:
            return self.kinks
        r, slopes = lax.stop_gradient(self._spline(jnp.ones(())))
        bends = abs(slopes[:, 1])
        return jnp.sort(jnp.where(bends >= jnp.sort(bends)[-_CORNERS], r, 0.0))[-_CORNERS:]

    def unbounded(self, radius: Array, k: Array) -> tuple[Array, Array]:
        """Infinite at a tip; a slope there that is a rounding of the next one is none, as of a smooth table."""
        slope, following = self._cubic().coefficients[1, :2]
        pointed = (slope > 1e-5 * following) & (k <= 0.0)
        return pointed, jnp.zeros_like(pointed)

    @property
    def known_radius(self) -> Any:
        """The last radius."""
        return self.r[..., -1]

    def height(self, r: Array, radius: Array) -> Array:
        """f(r) in m; beyond the table its slope stays."""
        cubic, r = self._cubic(), jnp.asarray(r)
        place = cubic.interval(r)
        found = horner(jnp.unstack(cubic.coefficients[:, place]), r - cubic.start[place])
        return jnp.where(r == jnp.inf, cubic.coefficients[1, -1] * r, found)

    def _cubic(self) -> Piecewise:
        """The heights; beyond the last radius, where a search may look, the slope stays."""
        r = jnp.asarray(self.r, jnp.result_type(self.r, self.heights))
        # Memory grows with the square of the rows.
        every = -(-(r.size - 1) // (_MOST - 1))  # at even distances, since PCHIP is less exact where they alternate
        kept = np.append(np.arange(0, r.size - 1, every), r.size - 1)
        cubic = pchip(r[kept], jnp.asarray(self.heights, r.dtype)[kept])
        r = cubic.start
        slope, bend, third = cubic.coefficients[1:, -2]
        step = r[-1] - r[-2]
        last = slope + step * (2.0 * bend + step * 3.0 * third)
        return cubic._replace(coefficients=cubic.coefficients.at[1, -1].set(last))

    def _spline(self, radius: Array) -> tuple[Array, Array]:
        r, (_, slope, bend, third) = self._cubic()
        jumps = 2.0 * jnp.diff(bend) - 6.0 * third[:-1] * jnp.diff(r)
        first = jnp.append(slope[:1], 0.0 * slope[1:])
        return r, jnp.stack([first, jnp.append(2.0 * bend[:1], jumps), 3.0 * jnp.diff(third, prepend=0.0)], -1)


def _right(name: str, x: Any) -> Any:
    steps = x[..., 1:] - x[..., :-1]
    flat = (x[..., 1:] == 0.0) if name == "heights" else (steps > 0.0)
    return (x[..., 0] == 0.0) & ((steps > 0.0) | flat).all(-1) & (x[..., -1] > 0.0)


def _refuse_column(name: str, x: np.ndarray) -> None:
    wrong = ~_right(name, x)
    if np.any(wrong):
        row = x[tuple(np.argwhere(wrong)[0])]
        if row[0] != 0.0:
            raise ValueError(f"{name}[0] = {row[0]} m: the table begins with r = 0 and the height 0")
        steps = np.diff(row) <= 0.0
        i = int(np.argmax(steps if name == "r" else steps & (row[1:] != 0.0)))
        if not row[-1] > 0.0:
            raise ValueError(f"{name}[{row.size - 1}] = {row[-1]} m: the last one must be > 0")
        raise ValueError(f"{name}[{i}] = {row[i]} m is followed by {row[i + 1]} m: {name} must increase")
