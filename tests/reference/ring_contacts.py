"""Contacts without closed forms, by rings of constant pressure: what the default tests compare with, recorded.

    python tests/reference/ring_contacts.py

writes `ring_contacts.json`, in a minute, and `tests/contact/test_quantities.py` holds the library to it. R = 1 m; F_N
presses the indenter to the contact radius A.
"""

import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import jax
import march_oracle
import numpy as np
import surface_oracle
from kinds import STEEL
from scipy.interpolate import CubicSpline, PchipInterpolator

from plgwear_jax import DepthGraded, Elastic, FrettingContact, PowerLawGraded, PowerShape, material

A = 1e-4  # contact radius
FRICTION, RIG, COEFFICIENT = 0.5, 2e7, 1e-14
STICK = 0.8  # c over A
RADII = np.array([0.1, 0.3, 0.5])  # over A, below the stick radius
BESIDE = np.array([0.2, 0.5, 0.8])  # the share of the way from c to the worn radius
TIMES = np.array([0.5, 2.0, 6.0])  # n as of `transient`
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


_DEPTH, _MODULUS = np.array([0.3, 0.3, 1.0, 1.0]) * A, np.array([50e9, 300e9, 300e9, 100e9])


def _layers():
    moduli = np.array([50e9, 300e9, 100e9])
    return graded_compliance(lambda z: moduli[np.searchsorted(_DEPTH[1:3], z, "right")], 0.2, A, list(_DEPTH[1:3]))


def table(depth, modulus):
    """On a rigid indenter's half-space whose moduli are given at some depths, in A and GPa."""
    places, values = np.array(depth) * A, np.array(modulus) * 1e9
    cubic = PchipInterpolator(places, values)

    def own():
        at = functools.partial(np.clip, a_min=places[0], a_max=places[-1])
        return graded_compliance(lambda z: float(cubic(at(z))), 0.25, places[-1], list(places))

    return Kind(DepthGraded(places, values, 0.25), None, 2.0, own)


_LAYERS = DepthGraded(_DEPTH, _MODULUS, 0.2)
KINDS = {
    "layers under steel": Kind(_LAYERS, STEEL, 2.0, _layers),
    "a table": table([0.15, 0.4, 1.0, 2.5], [400.0, 150.0, 300.0, 210.0]),
    "a stiff depth between compliant ones": table([0.015, 0.3, 3.0, 4.0], [60.0, 200.0, 60.0, 60.0]),
    "a power law under steel": power_law(0.3),
    "a power law stiff at its surface under steel": power_law(-0.3),
    "a shape": Kind(_LAYERS, STEEL, 4.0, _layers),
}


def tangential_ratio(kind, parts, a, count):
    """theta: both bodies share in it as in the energy of a flat punch of the radius a."""
    edges, middle, area = surface_oracle.rings(a, count)
    discs = [part.of_discs(edges[1:], middle) for part in parts]
    both = discs[0] + discs[1]
    both[:, 1:] -= both[:, :-1].copy()
    pressures = np.linalg.solve(both, np.ones(count))
    shares = [area * pressures @ (disc @ surface_oracle.steps(pressures)) for disc in discs]
    return float(np.dot(shares, kind.ratios) / np.sum(shares))


def edge_intensity(both, c, F_N, n, count=480):
    """The factor of z^-1/2, z = 1 - (r/c)^2, in the pressure of the worn contact on a surface of finite modulus."""
    inner = surface_oracle.contact_of(both, c, count, n)
    more = inner.held(F_N)[0] - inner.held(inner.force)[0]
    z, near = 1.0 - (surface_oracle.rings(c, count)[1] / c) ** 2, slice(-count // 4, -count // 20)
    return float(np.polyfit(z[near], (more * np.sqrt(z))[near], 2)[-1])


def computed(kind, count=240):
    """What the rings give, in SI units."""
    parts, n, c = kind.parts, kind.exponent, STICK * A
    one, other = parts
    both = surface_oracle.Compliance([*one.terms, *other.terms], one.q, one.weighted)
    end = surface_oracle.steady(both, A, c, count, n)
    F_N, mu = float(end.force), FRICTION
    F_x = mu * F_N * end.phi
    whole, inner = surface_oracle.contact_of(both, A, count, n), end.inner
    theta = tangential_ratio(kind, parts, A, count)
    before, _ = whole.held(F_N)
    worn, depth = inner.held(F_N)
    first, _ = inner.held(inner.force)

    def sunk(discs, pressures, r):
        return both.of_discs(discs, r) @ surface_oracle.steps(pressures)

    def at(pressures, radius, power, r):
        # Over a power of the distance to the edge the pressures of rings are a smooth function of their middles.
        middle = surface_oracle.rings(radius, count)[1]
        smooth = PchipInterpolator(middle[:-1], (pressures * (1.0 - (middle / radius) ** 2) ** -power)[:-1])
        return smooth(r) * (1.0 - (r / radius) ** 2) ** power

    ring = c + BESIDE * (end.worn_radius - c)
    around = np.linspace(c, end.worn_radius, 2001)[1:]
    slipping = c + BESIDE * (A - c)
    slip = slipping**n / n - (inner.depth - sunk(inner.discs, first, slipping))

    # The displacement grows as less and less of the contact sticks.
    radii = A * np.append(1.0 - np.linspace(0.0, 1.0, 40)[:-1] ** 2, 0.0)[::-1]
    loads, depths_of = np.zeros((2, radii.size))
    for i, radius in enumerate(radii[1:], 1):
        contact = surface_oracle.contact_of(both, radius, count // 2, n)
        loads[i], depths_of[i] = contact.force, contact.depth
    forces, moved = mu * (loads[-1] - loads)[::-1], mu * theta * (depths_of[-1] - depths_of)[::-1]
    u = PchipInterpolator(forces, moved)

    def ratio(force):
        return float(1.0 - 2.0 * u.integrate(0.0, force) / force / u(force))

    def aperture(force):
        return float(1.0 - 2.0 * u(0.5 * force) / u(force))

    amplitude = mu * theta * (whole.depth - inner.depth)
    per_cycle = 4.0 * COEFFICIENT * mu * theta * F_N / (np.pi * A**2)

    def wearing(count):
        edges = march_oracle.edges_beside(c / A, end.worn_radius / A, count)
        unit = F_N / (np.pi * A ** (2.0 + n))
        return march_oracle.rings_of(edges, lambda b, r: unit * both.of_discs(A * b, A * r), whole.depth / A**n, n)

    fewer, rings = wearing(80), wearing(160)
    coarse, fine = (each.volumes_at(TIMES, 40, force=end.phi) for each in (fewer, rings))
    held = fewer.volumes_at(TIMES, 40, displacement=1.0 - inner.depth / whole.depth)
    finite = isinstance(kind.half_space, DepthGraded)
    return {
        "normal_force": F_N,
        "tangential_force": F_x,
        "steady": {
            "contact_radius": A,
            "stick_radius": c,
            "worn_radius": end.worn_radius,
            "penetration": end.penetration,
            "wear_volume": end.volume,
            "deepest_wear": np.max(end.worn(around)),
            "peak_initial_pressure": np.max(before),
            "gross_slip_displacement": mu * theta * whole.depth,
            "displacement_amplitude": amplitude,
            "worn_displacement_amplitude": mu * theta * (depth - inner.depth),
            "energy_per_cycle": 4.0 * F_x * amplitude * ratio(F_x),
            "energy_ratio": ratio(F_x),
            "loop_aperture": aperture(F_x),
            "gross_slip_energy_ratio": ratio(forces[-1]),
            "gross_slip_aperture": aperture(forces[-1]),
            "contact_share": amplitude / (amplitude + F_x / RIG),
            **({"edge_intensity": edge_intensity(both, c, F_N, n)} if finite else {}),
        },
        "fields": {
            "initial_pressure": at(before, A, 0.5, RADII * A),
            "pressure": at(worn, c, -0.5, RADII * A),
            "traction": mu * at(worn - first, c, -0.5, RADII * A),
            "initial_displacement": sunk(whole.discs, before, A * np.array([0.5, 1.5, 3.0])),
            "wear_depth": end.worn(ring),
            "slip_amplitude": mu * theta * slip,
        },
        "cycles": TIMES / per_cycle,
        "volumes": A ** (2.0 + n) * (fine + (fine - coarse) / 3.0),
        "held": A ** (2.0 + n) * held,
    }


def listed(found):
    """With lists in place of arrays."""
    return jax.tree.map(lambda x: x.tolist() if isinstance(x, np.ndarray) else float(x), found)


FILE = Path(__file__).with_suffix(".json")


def recorded():
    """By the kind of contact, what `computed` gives."""
    return json.loads(FILE.read_text("utf-8"))


if __name__ == "__main__":
    jax.config.update("jax_enable_x64", True)
    found = jax.tree.map(lambda x: float(f"{x:.7g}"), {name: listed(computed(kind)) for name, kind in KINDS.items()})
    FILE.write_text(json.dumps(found, indent=1) + "\n", "utf-8")
