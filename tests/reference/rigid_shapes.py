"""Rigid indenters of all shapes on power laws, and their steady state by `shape_oracle`."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from kinds import FORCE, FRICTION, dome
from kinds import RADIUS as R
from mpmath import mp, mpf
from scipy.interpolate import PchipInterpolator
from shape_oracle import Oracle, Piece

from plgwear_jax import Cone, PowerShape, Profile, RoundedFlat, Shape, TruncatedSphere

STEADY = "contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume"
RADII = np.array([0.0, 2e-5, 4.5e-5, 7e-5, 1e-4, 1.5e-4, 2.2e-4, 4e-4])
HEIGHTS = RADII**2 / (2.0 * R) * (1.0 + 0.1 * np.sin(RADII * 3e4))


def contact_with(shape, k=0.2, indenter=None):
    return dome(k, indenter, shape)


def cubics():
    """f' of the table by SciPy's PCHIP, by powers of r."""
    third, second, first, _ = PchipInterpolator(RADII, HEIGHTS).c
    found = []
    for begin, a, b, c in zip(*([mpf(float(x)) for x in row] for row in (RADII, first, second, third)), strict=False):
        powers = a - 2 * b * begin + 3 * c * begin**2, 2 * b - 6 * c * begin, 3 * c
        found.append(Piece(begin, [(power, mpf(n)) for n, power in enumerate(powers)]))
    return found


def power(coefficient, n, begin=0.0, constant=0.0):
    return [Piece(mpf(begin), [(mpf(coefficient), mpf(n)), (mpf(constant), mpf(0))])]


SHAPES = {
    "cone": (Cone(0.01), power(0.01, 0), 1e-12),
    "power": (PowerShape(3.0), power(mpf(R) ** -2, 2), 1e-12),
    "sharp power": (PowerShape(1.5), power(mpf(R) ** mpf(-0.5), 0.5), 1e-12),
    "flat power": (PowerShape(12.0), power(mpf(R) ** -11, 11), 1e-12),
    "rounded flat": (RoundedFlat(5e-5), power(1 / mpf(R), 1, 5e-5, -mpf(5e-5) / mpf(R)), 1e-8),
    "truncated sphere": (TruncatedSphere(5e-5), power(1 / mpf(R), 1, 5e-5), 1e-8),
    "table": (Profile(RADII, HEIGHTS), None, 1e-8),
}


class Blend(Shape):
    """A shape of one's own: a sphere, rounded beyond a flat face, with a cone's slope from there on, and r^4."""

    flat: Any = 0.0
    cone: Any = 0.0
    fourth: Any = 0.0
    round: Any = 1.0

    def height(self, r, radius):
        beyond = jnp.maximum(r - self.flat, 0.0)
        return self.round * beyond**2 / (2.0 * radius) + self.cone * beyond + self.fourth * r**4

    @property
    def kinks(self):
        return (self.flat,)


def blended(flat=0.0, cone=0.0, fourth=0.0):
    quartic = (4 * mpf(fourth), mpf(3))
    beyond = [(1 / mpf(R), mpf(1)), (mpf(cone) - mpf(flat) / mpf(R), mpf(0)), quartic]
    below = [Piece(mpf(0), [quartic])] if fourth and flat else []
    return Blend(flat, cone, fourth), [*below, Piece(mpf(flat), beyond)], 1e-5


OWN = {
    "own rounded flat": blended(flat=5e-5),
    "own second and fourth power": blended(fourth=3e7),
    "own kink in the ring": blended(flat=1.1e-4, cone=0.003, fourth=3e8),
}


def steady(contact, force):
    """STEADY of a contact."""
    state = contact.steady(force)
    return np.array([getattr(state, name) for name in STEADY])


def exact(name, k, phi):
    """STEADY of a shape under phi FRICTION FORCE."""
    shape, pieces, _ = (SHAPES | OWN)[name]
    contact = contact_with(shape, k)
    # The contact of a truncated sphere may end close to its flat face.
    with mp.workdps(25 if name != "truncated sphere" or k > 0.0 else 30 if k > -0.8 else 45):
        pieces = cubics() if pieces is None else pieces
        # c_N is (1+k)^2 times the stiffness of the library.
        pressed = mpf(FORCE) / (2 * (1 + mpf(k)) ** 2 * mp.exp(mpf(float(contact.material.log_stiffness()))))
        start = mpf(float(contact.steady(0.0).contact_radius)) - pieces[0].begin
        phi = phi * FRICTION * FORCE / (FRICTION * FORCE)
        return [float(x) for x in Oracle(pieces, k).steady(pressed, phi, start)]
