"""The steady state on any compliance by rings of constant pressure, collocated at their middles.

It shares nothing with the library: displacements of uniformly loaded discs by SciPy's hypergeometric function or by
integrals over the wavenumber, the half-space from the plane-strain equations by SciPy's integrator, radii chosen and
forces found from them. Besides, theta of a power law by the same equations.
"""

import itertools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import gamma, hyp2f1, j0, j1


def power_compliance(E0, z0, k, h_N, nu):
    """g of G(q) = g q^(k-1)."""
    c_N = E0 * h_N / ((1.0 - nu**2) * z0**k)
    return np.sin(0.5 * np.pi * (1.0 + k)) / c_N * 2.0 ** (1.0 - k) * gamma(0.5 - 0.5 * k) / gamma(0.5 + 0.5 * k)


def disc(r, k):
    """The displacement of a disc of radius 1 under a uniform pressure, over that at its centre: Eq. (5)."""
    inside = np.minimum(r, 1.0) ** 2
    outside = np.maximum(r, 1.0) ** -2.0
    s = 0.5 * (1.0 + k)
    return np.where(r < 1.0, hyp2f1(s - 1.0, s, 1.0, inside), (1.0 - s) * outside**s * hyp2f1(s, s, 2.0, outside))


def under_discs(k, b, r):
    """The displacement for G = q^(k-1) at r, of discs of radius b under unit pressure."""
    at_centre = 2.0 ** (k - 1.0) * gamma(0.5 + 0.5 * k) / gamma(1.5 - 0.5 * k) * b ** (1.0 - k)
    return at_centre * disc(r[:, None] / b, k)


def riccati(modulus, nu, q):
    """(Slopes along z of the compliance of waves of the wavenumber q, that of a homogeneous half-space of modulus E).

    Of the matrix S with displacements u = S t as (S_11, S_12, S_22), and of the same across the wave: antiplane shear.
    """
    ratio = nu / (1.0 - nu)

    def slope(z, state):
        mu = 0.5 * modulus(z) / (1.0 + nu)
        s11, s12, s22, across = state
        stiff = 2.0 * mu * q * q / (1.0 - nu)
        return np.array(
            [
                2.0 * q * s12 + 1.0 / mu - stiff * s11 * s11,
                q * s22 - ratio * q * s11 - stiff * s11 * s12,
                -2.0 * ratio * q * s12 + (0.5 - nu) / (1.0 - nu) / mu - stiff * s12 * s12,
                1.0 / mu - mu * q * q * across * across,
            ]
        )

    return slope, lambda E: np.array([-(1.0 - nu), 0.5 - nu, -(1.0 - nu), -1.0]) * 2.0 * (1.0 + nu) / (E * q)


def excess(modulus, nu, depth, jumps, q):
    """m of G(q) = 2 (1 + m) (1-nu^2)/(E(0) q) by the Riccati equation, from `depth` on, where E is constant."""
    begin, (slope, homogeneous) = min(18.0 / q, depth), riccati(modulus, nu, q)
    state = homogeneous(modulus(begin))
    stops = [begin, *sorted((z for z in jumps if z < begin), reverse=True), 0.0]
    for start, end in itertools.pairwise(stops):
        # The half-open intervals of a modulus with jumps.
        inside = 1e-12 * depth
        found = solve_ivp(slope, (start - inside, end), state, rtol=1e-9, atol=1e-12 * abs(state[2]), method="LSODA")
        state = found.y[:, -1]
    return -state[2] * q * modulus(0.0) / (2.0 * (1.0 - nu**2)) - 1.0


class Compliance(NamedTuple):
    """The sum of g q^(k-1) over `terms`, and m(q) g_0/q at nodes in q with weights."""

    terms: list[tuple[float, float]]
    q: np.ndarray = np.zeros(0)
    weighted: np.ndarray = np.zeros(0)  # weights times g_0 m

    def of_discs(self, b, r):
        total = sum(g * under_discs(k, b, r) for g, k in self.terms)
        if self.q.size:
            total = total + (j0(np.outer(r, self.q)) * (self.weighted / self.q)) @ (j1(np.outer(self.q, b)) * b)
        return total


def rings(c, count):
    """Edges, middles and areas of rings up to a radius, which crowd at it."""
    edges = c * (1.0 - (1.0 - np.linspace(0.0, 1.0, count + 1)) ** 2.5)
    return edges, 0.5 * (edges[1:] + edges[:-1]), np.pi * np.diff(edges**2)


class Contact(NamedTuple):
    """Without singular pressure at the edge, in the unit 1/R = 1."""

    force: float
    depth: float
    held: Callable[[float], tuple[np.ndarray, float]]  # of a force: (pressures, depth) with the radius held
    discs: np.ndarray


def steps(pressures):
    """Pressures of rings as those of discs."""
    return pressures - np.append(pressures[1:], 0.0)


def contact_of(compliance, c, count=240, n=2.0):
    """The contact of an indenter r^n/n, of radius c."""
    edges, middle, area = rings(c, count)
    matrix = compliance.of_discs(edges[1:], middle)
    matrix[:, 1:] -= matrix[:, :-1].copy()
    one, bowl = np.linalg.solve(matrix, np.stack([np.ones(count), middle**n / n], -1)).T

    def held(force):
        depth = (force + area @ bowl) / (area @ one)
        return depth * one - bowl, depth

    depth = bowl[-1] / one[-1]
    return Contact(area @ (depth * one - bowl), depth, held, edges[1:])


class Steady(NamedTuple):
    force: float
    phi: float
    worn_radius: float
    penetration: float
    volume: float
    inner: Contact  # of the radius c
    worn: Callable[[np.ndarray], np.ndarray]  # depths at radii


def steady(compliance, a, c, count=240, n=2.0):
    """The steady state of the contact with these radii before any wear and of the stick area, R = 1."""
    force, inner = contact_of(compliance, a, count, n).force, contact_of(compliance, c, count, n)
    pressures, depth = inner.held(force)
    weights = steps(pressures)

    def worn(r):
        return depth - r**n / n - compliance.of_discs(inner.discs, r) @ weights

    edge = brentq(lambda r: worn(np.array([r]))[0], 1.02 * c, 40.0 * a, xtol=1e-12 * a)
    x, weight = np.polynomial.legendre.leggauss(60)
    # Dense towards c, where the slope is infinite.
    share = (0.5 + 0.5 * x) ** 3
    r = c + (edge - c) * share
    weight = 0.5 * weight * 3.0 * (0.5 + 0.5 * x) ** 2 * (edge - c)
    volume = 2.0 * np.pi * (weight * r) @ worn(r)
    return Steady(force, 1.0 - inner.force / force, edge, depth, volume, inner, worn)


def tangential_ratio(k, nu):
    """theta from the surface compliances of waves in the graded half-space, z^k deep, at wavenumber 1.

    From deep down up to the surface, in x with z = x^m so that the singular modulus at the surface does not matter.
    """
    m, deep = 4.0 / (1.0 - abs(k)), 20.0
    slope, homogeneous = riccati(lambda z: z**k, nu, 1.0)

    ends = deep ** (1.0 / m), 1e-12
    found = solve_ivp(
        lambda x, state: m * x ** (m - 1.0) * slope(x**m, state),
        ends,
        homogeneous(deep**k),
        method="DOP853",
        rtol=1e-11,
        atol=1e-13,
        max_step=0.02,
    )
    in_plane, _, normal, anti = found.y[:, -1]
    return 0.5 * (in_plane + anti) / normal
