"""Two bodies that touch, and their compliance G(q) as the contact of radius c sees it.

Pressures are sums of coefficients y_n times (e/c) times what is J_(2n+s)(x) x^-s in the Hankel domain, x = q c, so that

    M y = moments of the depth by which they press,    M = sum over the terms g q^(k-1) of G of g c^-k times integrals,

and the force is 2 pi e^2 c y_0, e = 2^-s/Gamma(1+s). Beside the contact the displacement is Abel's integral of v(T),

    w(Y) = sin(pi a)/pi * integral over T from 0 to Y of T^(a-1) (Y-T)^-a v(T),      Y = (r/c)^2,

with a = 1/2 for the homogeneous term alone. v is known inside: d - G(T): `shapes` has G. It is computed beside it.
"""

import functools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import record, static
from plgwear_jax._core.startup.programs import moved_along
from plgwear_jax.shapes.powers import Power
from plgwear_jax.shapes.shape import AbelTransform, Outline, inwards
from plgwear_jax.special.cholesky import solve_symmetric
from plgwear_jax.special.elementary import in_dtype, value_with_slope
from plgwear_jax.special.jacobi import gamma, jacobi_table, ratios
from plgwear_jax.special.quadrature import Pieces, logistic, pieces
from plgwear_jax.special.root import root_of

from .effort import Effort


class Punch(NamedTuple):
    """The contact of radius c."""

    log_c: Array  # of the radius in m
    flat: Any  # y of a flat punch pressed by 1; on a power law alone this one and the next two are None
    indenter_solution: Any  # y of the indenter in units of c^2/R, T/2 for the parabola
    last: Any  # what the last pressure does to itself
    stiffness: Array  # F/d of the flat punch
    growth: Array  # its slope by log(c)
    held: Array  # the force that it takes, in units of c^2/R: F = stiffness d - held
    depth: Array  # d at which the indenter touches up to c and no further, in c^2/R
    force: Array  # its force over c^2/R

    @property
    def c(self) -> Array:
        """The radius in m."""
        return jnp.exp(self.log_c)

    @property
    def touching(self) -> Array:
        """y of the indenter that touches up to c and no further."""
        return self.depth * self.flat - self.indenter_solution


@record
class Bodies:
    """What all bodies have.

    A half-space with another compliance is a subclass, which has besides
    `s`, the exponent s of the pressures at the edge;
    `lead`, (k, log(g)) of the term that leads at large q;
    `far(log_r)`, the logarithm of the displacement far away, up to a constant;
    `matrices(c)`, (M, its slope by log(c)), and `of_indenter`, the part of M that is the indenter's;
    `ring_displacement(punch)`, v beside a `Punch`;
    `ring_compliance(c, width, from_c, from_1)`, (what cells beside c do to each other at a held depth of the indenter,
    in m/Pa, their images), with arguments as of `ring.cells_of`;
    `inward(found, sunk, from_c, from_1)`, (places 1 - T inside c that decrease, the pressures there), where what a unit
    of pressure in each cell beside c sinks in is `sunk` in m/Pa;
    `disc_compliance(b, edges)`, A in m/Pa, (cells, cells), of a whole contact up to b in m, of which no part has to
    stick: depths, integrated over T = (r/b)^2 in each cell, with edges from 0 to 1, follow from the pressures by A p.
    """

    outline: Outline  # of the indenter
    effort: Effort = static()  # how finely the contact is divided
    radius: Array  # an estimate of that of the contact; of any E(z) one over the unit of q_k as well

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    @property
    def never_pulls(self) -> bool:
        """Whether such bodies only press, whatever their numbers are."""
        return False

    @property
    def front(self) -> Any:
        """The factor e of the pressures."""
        s = self.s
        return jnp.exp2(-s) / gamma(1.0 + s)

    @property
    def abel(self) -> Array:
        """The exponent of Abel's integral: by the term which leads at large q."""
        return self.s

    def punch_at(self, log_c: Array) -> Punch:
        """The contact of this radius."""
        c, outline, modes = jnp.exp(log_c), self.outline, self.effort.modes
        matrix, slope = self.matrices(c)
        first = jnp.asarray(np.eye(modes, 1)[:, 0], c.dtype)
        moments, rising = outline.shape.moments(c, outline.radius, self.s, modes)
        found = solve_symmetric(matrix, jnp.stack([first, moments], -1))
        flat, indenter_solution = jnp.unstack(found, axis=1)
        # K and L of the elastic energy (d^2 K - 2 d L + ...)/2, which does not change with c where the pressure has no
        # singularity there: d = L'/K'. The slope of f by log(c) at a fixed r/c is r f'(r).
        unit = 2.0 * jnp.pi * self.front**2 * c
        forces = first @ found
        both = unit * jnp.stack([forces, forces - (slope @ flat) @ found])
        stiffness, held, growth, bent = jnp.unstack(both.ravel())
        depth = (bent + unit * (flat @ rising)) / growth
        return Punch(
            log_c, flat, indenter_solution, matrix[-1, -1], stiffness, growth, held, depth, stiffness * depth - held
        )


def surplus(punch: Punch, log_load: Array) -> Array:
    """The logarithm of the force times R, less one of a load."""
    # Within the flat face of an indenter no force goes without a pressure that is singular at the edge.
    # A search for the radius goes outwards from there, and by no slope.
    some = punch.force > 0.0
    return jnp.where(some, 2.0 * punch.log_c + jnp.log(jnp.where(some, punch.force, 1.0)) - log_load, -1.0)


@jax.custom_jvp
def punch_under(bodies: Bodies, load: Array) -> Punch:
    """The contact under a load F_N R, whose radius is that of the unworn indenter."""
    goal, start = jnp.log(load), jnp.log(bodies.radius)
    log_c = root_of(lambda log_c: surplus(bodies.punch_at(log_c), goal), start, 3.0, enough=1e-13)
    # Next to the edge of a flat face the force falls within some roundings to none. Farther off its slope has more
    # digits, and the volume fewer, which in single precision counts more.
    face = jnp.asarray(bodies.outline.shape.face, log_c.dtype)
    roundings = 32.0 if face.dtype == jnp.float64 else 8.0
    log_c = jnp.maximum(log_c, jnp.log(face) + roundings * jnp.finfo(face.dtype).eps)
    return _carrying(bodies.punch_at(log_c), load)


def _carrying(punch: Punch, load: Array) -> Punch:
    """The contact with the force and the depth that go with its load."""
    # Where the slope of the indenter jumps both rise faster than the digits of the radius tell.
    force = load * jnp.exp(-2.0 * punch.log_c)
    return punch._replace(force=force, depth=pressed(punch, force))


@functools.partial(punch_under.defjvp, symbolic_zeros=True)
def _punch_under_jvp(primals: Any, tangents: Any) -> tuple[Punch, Punch]:
    # By the implicit function theorem: with log(c) held, and what log(c) then adds.
    bodies, load = primals
    punch = punch_under(bodies, load)
    by_c = along_radius(bodies, punch)
    _, (held, dload) = moved_along(lambda bodies, load: (bodies.punch_at(punch.log_c), load), primals, tangents)
    moved = (dload / load - held.force / punch.force) / (2.0 + by_c.force / punch.force)
    along = jax.tree.map(lambda one, other: one + moved * other, held, by_c)
    return punch, jax.jvp(_carrying, (punch, load), (along, dload))[1]


def along_radius(bodies: Bodies, punch: Punch) -> Punch:
    """The slopes of a contact by log(c)."""
    return value_with_slope(bodies.punch_at, punch.log_c)[1]


def pressed(punch: Punch, force: Array) -> Array:
    """The depth in c^2/R by which the indenter is pressed in by a force over c^2/R, the contact held at c."""
    return (force + punch.held) / punch.stiffness


# --- pressures --------------------------------------------------------------------------------------------------------


def flat_pressure(bodies: Bodies, punch: Punch, z: Array, half: float = 0.0) -> Array:
    """The pressure of the flat punch pressed by R, over 1/R, at z = 1 - (r/c)^2 > 0, shape (m,).

    Args:
        bodies: Both bodies.
        punch: The contact.
        z: Places; with `half` 1 - (t/c)^2 of strips across the contact.
        half: 0.5 for P/c, where the transform of the pressure is the integral over t of P cos(q t): half an integral.
    """
    c, s = punch.c, bodies.s
    if punch.flat is None:
        front = punch.stiffness * s / (jnp.pi * c * c) * _integrated(s, half)
        return front * jnp.exp((s - 1.0 + half) * jnp.log(z))
    return pressure_inside(bodies, punch.flat, z, half) / c


def _integrated(s: Array, half: float) -> Array | float:
    """What half an integral makes of the factor of (1 - (r/c)^2)^(s-1)."""
    return gamma(s) / gamma(s + half) * math.pi**-half if half else 1.0


def apart(bodies: Bodies, punch: Punch) -> tuple[Any, Any]:
    """(y_0 of the flat punch on a power law alone, y of the indenter less that on it); None if there is no other term.

    The law has the exponent 2 s - 1, and the compliance of the bodies at the shortest waves that the pressures resolve.
    It answers a slope that jumps in closed form, and what is left is smoother.
    """
    if punch.flat is None:
        return None, None
    s = bodies.s
    n = np.arange(punch.flat.size, dtype=s.dtype)
    # Its matrix, which is diagonal.
    yielding = punch.last * (2.0 * n[-1] + s) / (2.0 * n + s)
    shape, radius = bodies.outline
    moments, _ = shape.moments(punch.c, radius, s, n.size)
    return 1.0 / yielding[0], punch.indenter_solution - moments / yielding


def stiffness_apart(punch: Punch, first: Any) -> Array:
    """The stiffness of the flat punch on that power law alone, by the first result of `apart`."""
    return punch.stiffness if first is None else punch.stiffness * first / punch.flat[0]


def resolved(image: AbelTransform) -> bool:
    """Whether the pressures resolve the indenter, which then is a parabola."""
    return isinstance(image, Power) and image.power is None


def grown(bodies: Bodies, punch: Punch, image: AbelTransform) -> Array:
    """How much faster than G the depth rises next to c: the indenter is flat punches of radii up to c."""
    rise, edge = along_radius(bodies, punch).depth, jnp.ones((1,), punch.log_c.dtype)
    return (punch.depth + 0.5 * rise) / image.rate(edge, inwards(bodies.outline.shape.kinks, punch.c)[None])[0]


def risen(outline: Outline, image: AbelTransform, c: Array, z: Array, count: int) -> tuple[Pieces, Array]:
    """(A rule for integrals over x from 0 to 1, the slopes of G at T = 1 - z x)."""
    # The pieces follow their ends: beside a kink the slope of G is singular.
    ends = inwards(outline.shape.corners, c) / z
    parts = pieces(ends[::-1], c, logistic(count, 26.0))
    piece, own = np.arange(parts.x.size)[:, None] // parts.places, np.arange(ends.size)[::-1]
    ahead = jnp.where(piece == own, parts.ahead[:, None], ends - parts.x[:, None])
    ahead = jnp.where((piece > own) & (ends < 1.0), 0.0, ahead)
    return parts, image.rate((1.0 - z) + z * parts.left, z * ahead)


def own_pressure(bodies: Bodies, punch: Punch, z: Array, half: float = 0.0) -> Array:
    """The pressure of the indenter that touches up to c and no further, over c^2/R, as `flat_pressure` gives it."""
    c, s, outline = punch.c, bodies.s, bodies.outline
    (first, rest), image, power = apart(bodies, punch), outline.image(c, s), s + half

    def at(z: Array) -> Array:
        # Flat punches of all radii from r to c: the integral over T of (T - (r/c)^2)^(s-1) dG.
        parts, rates = risen(outline, image, c, z, 100)
        terms = parts.weight * rates * jnp.exp((power - 1.0) * jnp.log(parts.left))
        # Nearer to a tip than the places are its own power counts.
        least = jnp.where(1.0 - z < parts.left[-1], 1e-6, s)
        return jnp.sum(parts.ended(terms, least))

    # One after the other: at once, G by quadrature at all places of all cells is more than the memory holds.
    rise = image.first / power if resolved(image) else lax.map(jax.checkpoint(at), z)
    front = stiffness_apart(punch, first) * s / (jnp.pi * c * c) * _integrated(s, half)
    found = front * jnp.exp(power * jnp.log(z)) * rise
    if rest is None:
        return found
    less = rest.at[0].add(image.first * first)
    y = _without_edge(punch.depth * punch.flat - less)
    return found + pressure_inside(bodies, y, z, half) / c


def own_pressures(punch: Punch) -> Array:
    """y of the indenter that touches up to c and no further."""
    return _without_edge(punch.touching)


def _without_edge(y: Array) -> Array:
    """Pressures without what is singular at the edge, taken off the last ones, which leave force and middle alone."""
    # By a flat punch the roundings at the edge would be in the whole contact.
    n = np.arange(y.size)
    sign, share = in_dtype(y.dtype, (-1.0) ** n, (-1.0) ** n * n**2 / np.sum(n**2))
    return y - (y @ sign) * share


def pressure_inside(bodies: Bodies, y: Array, inside: Array, half: float = 0.0) -> Array:
    """The pressure over 1/c at z = 1 - (r/c)^2 > 0, shape (m,), of coefficients along a last axis."""
    s, count = bodies.s, y.shape[-1]
    end, middle = s + half, 1.0 - half
    front = 2.0 * bodies.front**2 * s * _integrated(s, half)
    total = (y * ratios(front, middle, end, count)) @ jacobi_table(count, s, middle, 2.0 * inside - 1.0)
    return jnp.exp((end - 1.0) * jnp.log(inside)) * total
