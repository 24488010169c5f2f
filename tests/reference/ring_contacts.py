"""Contacts without closed forms, by rings of constant pressure: what the default tests compare with, recorded.

`tools/record_rings.py` writes `ring_contacts.json`, and `tests/contact/test_quantities.py` holds the library to it.
R = 1 m; F_N presses the indenter to the contact radius A.
"""

import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import march_oracle
import numpy as np
import surface_oracle
from kinds import STEEL
from scipy.interpolate import CubicSpline, PchipInterpolator

from plgwear_jax import DepthGraded, Elastic, FrettingContact, PowerLawGraded, PowerShape, material

A = 1e-4  # contact radius
FRICTION, RIG, COEFFICIENT = 0.5, 2e7, 1e-14
RADII = np.array([0.1, 0.3, 0.5])  # over A, below the stick radius
BESIDE = np.array([0.2, 0.5, 0.8])  # the share of the way from c to the worn radius
RIGID = Elastic(1e30, 0.3)


class Kind(NamedTuple):
    """A contact, and the compliance of the half-space alone."""

    half_space: Any
    indenter: Any  # None for a rigid one
    exponent: float  # of f(r) = r^n/n
    own: Callable[[], surface_oracle.Compliance]

    def contact(self, force):
        shape = None if self.exponent == 2.0 else PowerShape(self.exponent)
        return FrettingContact(self.half_space, 1.0, force, FRICTION, self.indenter, shape)

    @property
    def parts(self):
        """The compliance of the half-space, and of the indenter."""
        body = self.indenter or RIGID
        return self.own(), surface_oracle.Compliance([(2.0 * (1.0 - body.nu**2) / body.E, 0.0)])

    @property
    def both(self):
        """The compliance of both bodies."""
        own, other = self.parts
        return surface_oracle.Compliance([*own.terms, *other.terms], own.q, own.weighted)

    def rings(self, both, whole, edges):
        """Rings with these edges over A, from both bodies and the contact of the radius A before any wear."""
        unit = whole.force / (np.pi * A ** (2.0 + self.exponent))

        def of_discs(b, r):
            return unit * both.of_discs(A * b, A * r)

        return march_oracle.rings_of(edges, of_discs, whole.depth / A**self.exponent, self.exponent)

    @property
    def ratios(self):
        """Of tangential to normal compliance, for both."""
        k, nu = getattr(self.half_space, "k", None), self.half_space.nu
        own = mindlin(nu) if k is None else float(material.tangential_ratio(k, nu))
        return own, mindlin((self.indenter or RIGID).nu)


def graded_compliance(modulus, nu, bottom, jumps):
    """2 (1 + m) (1-nu^2)/(E(0) q) with m on a fine mesh of wavenumbers, up to where it is nothing."""
    logs = np.linspace(np.log(1e-4), np.log(240.0), 90)
    m = CubicSpline(logs, [surface_oracle.excess(modulus, nu, bottom, jumps, np.exp(x) / A) for x in logs])
    edges = np.concatenate([[0.0], np.geomspace(1e-3, 0.2, 12), np.arange(0.7, 60.0, 0.5)])
    x, weight = np.polynomial.legendre.leggauss(8)
    q = (edges[:-1, None] + np.diff(edges)[:, None] * (0.5 + 0.5 * x)).ravel()
    weights = (0.5 * np.diff(edges)[:, None] * weight).ravel() / A
    own = 2.0 * (1.0 - nu**2) / modulus(0.0)
    weighted = weights * own * m(np.maximum(np.log(q), logs[0]))
    return surface_oracle.Compliance([(own, 0.0)], q / A, weighted)


def mindlin(nu):
    return (2.0 - nu) / (2.0 - 2.0 * nu)


def power_law(k):
    def own():
        g = surface_oracle.power_compliance(110e9, 1e-4, k, float(material.h_N(k, 0.3)), 0.3)
        return surface_oracle.Compliance([(g, k)])

    return Kind(PowerLawGraded(110e9, 1e-4, k, 0.3), STEEL, 2.0, own)


def layers(ends, modulus, indenter=STEEL, exponent=2.0):
    """Layers that end at some depths, and what is below, in A and GPa."""
    places, values = np.array(ends) * A, np.array(modulus) * 1e9
    half_space = DepthGraded(np.repeat(places, 2), np.repeat(values, 2)[1:-1], 0.2)

    return Kind(
        half_space,
        indenter,
        exponent,
        lambda: graded_compliance(lambda z: values[np.searchsorted(places, z, "right")], 0.2, places[-1], [*places]),
    )


def table(depth, modulus):
    """On a rigid indenter's half-space whose moduli are given at some depths, in A and GPa."""
    places, values = np.array(depth) * A, np.array(modulus) * 1e9
    cubic = PchipInterpolator(places, values)

    def own():
        at = functools.partial(np.clip, a_min=places[0], a_max=places[-1])
        return graded_compliance(lambda z: float(cubic(at(z))), 0.25, places[-1], list(places))

    return Kind(DepthGraded(places, values, 0.25), None, 2.0, own)


def drawn(rng):
    """Random layers under steel, or a random table under a rigid indenter."""
    steps, modulus = 10.0 ** rng.uniform(-1.2, 0.3, 4), 110.0 * 20.0 ** rng.uniform(-0.5, 0.5, 4)
    return layers(np.cumsum(steps[:2]), modulus[:3]) if rng.random() < 0.5 else table(np.cumsum(steps), modulus)


KINDS = {
    "layers under steel": layers([0.3, 1.0], [50.0, 300.0, 100.0]),
    "a table": table([0.15, 0.4, 1.0, 2.5], [400.0, 150.0, 300.0, 210.0]),
    "a stiff depth between compliant ones": table([0.015, 0.3, 3.0, 4.0], [60.0, 200.0, 60.0, 60.0]),
    "a power law under steel": power_law(0.3),
    "a power law stiff at its surface under steel": power_law(-0.3),
    "a shape": layers([0.3, 1.0], [50.0, 300.0, 100.0], exponent=4.0),
}


FILE = Path(__file__).with_suffix(".json")


def recorded():
    """By the kind of contact."""
    return json.loads(FILE.read_text("utf-8"))
