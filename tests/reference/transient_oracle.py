"""Wear over cycles by rings of constant pressure and the Green's function of the half-space alone.

Nothing here knows the one-dimensional picture of the contact, nor shares code with the library: the displacement beside
and under a uniformly pressed disc is the hypergeometric function of Eq. (5), a ring is the difference of two discs, and
every step of Archard's law is a Newton iteration for all pressures and the approach of the indenter. Units are those of
`plgwear_jax.transient`. First order in the step and about 3/2 in the width of a ring.

Besides, theta by integration of the equations of plane strain of the graded half-space.
"""

import numpy as np
import oracle
from mpmath import mp
from scipy.integrate import solve_ivp
from scipy.special import beta, hyp2f1


def disc(r, k):
    """The displacement of a disc of radius 1 under a uniform pressure, over that at its centre: Eq. (5)."""
    inside = np.minimum(r, 1.0) ** 2
    outside = np.maximum(r, 1.0) ** -2.0
    s = 0.5 * (1.0 + k)
    return np.where(r < 1.0, hyp2f1(s - 1.0, s, 1.0, inside), (1.0 - s) * outside**s * hyp2f1(s, s, 2.0, outside))


def influence(k, edges):
    """The displacements at the middles of rings between edges by a uniform pressure on each, for a power law."""
    s, middles = 0.5 * (1.0 + k), 0.5 * (edges[1:] + edges[:-1])
    # By Eqs. (11) and (13) the pressure (1+s) (1 - r^2)^s sinks in by 1/(1+k).
    scale = 1.0 / ((1.0 + k) * (1.0 - k) * (1.0 + s) * 0.5 * beta(0.5 * (1.0 - k), 1.0 + s))
    discs = np.zeros((middles.size, edges.size))
    discs[:, 1:] = scale * edges[1:] ** (1.0 - k) * disc(middles[:, None] / edges[1:], k)
    return np.diff(discs, axis=1)


class OneForce:
    """The rings of one contact: where they are, how they displace each other, the gap and the shape."""

    def __init__(self, k, phi, count):
        self.c = float(oracle.stick_radius(k, phi, digits=20))
        self.outer = float(oracle.worn_radius(k, phi, digits=20))
        edges = self.edges(count)
        self.r, self.load, self.influence = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges**2), influence(k, edges)
        self.shape = 0.5 * self.r**2
        # The parabola beside the contact of radius c, Eq. (14): zero for the rings that stick.
        with mp.workdps(30):
            self.gap = np.array([self._gap(float(r), k) for r in self.r])

    def edges(self, count):
        """Of the rings: half as many where it sticks as beside it."""
        inner = self.c * (1.0 - (1.0 - np.linspace(0.0, 1.0, count // 2 + 1)) ** 3)
        x = np.linspace(0.0, 1.0, count + 1)[1:]
        return np.concatenate([inner, self.c + (self.outer - self.c) * x**2 * (1.5 - 0.5 * x)])

    def _gap(self, r, k):
        if r <= self.c:
            return 0.0
        lift = self.c**2 * (1 / (1 + mp.mpf(k)) - oracle.initial_displacement(mp.mpf(r) / self.c, k, digits=20))
        return float(mp.mpf(r) ** 2 / 2 - lift)

    def march(self, times):
        """Worn volume at the times, and the pressures at the last, by implicit steps of Euler's."""
        worn = np.zeros(self.r.size)  # the integral of the pressure over n
        pressure, depth = np.where(self.r < 1.0, 1.0, 0.0), 1.0
        volumes = [0.0]
        for length in np.diff(times):
            pressure, depth = self._step(worn, length, pressure, depth)
            worn = worn + length * np.where(self.gap > 0.0, pressure, 0.0)
            volumes.append(np.pi * self.load @ (self.gap * np.expm1(worn)))
        return np.array(volumes), pressure

    def _step(self, worn, length, pressure, depth):
        touches = pressure > 0.0
        for count in range(60):
            grown = self.gap * np.exp(np.where(self.gap > 0.0, worn + length * pressure, 0.0))
            on = np.flatnonzero(touches)
            lack = (self.shape + grown - self.gap + self.influence @ pressure - depth)[on]
            matrix = np.zeros((on.size + 1, on.size + 1))
            matrix[:-1, :-1] = self.influence[np.ix_(on, on)] + np.diag(length * grown[on])
            matrix[:-1, -1], matrix[-1, :-1] = -1.0, self.load[on]
            change = np.linalg.solve(matrix, -np.append(lack, self.load @ pressure - 1.0))
            rise = np.where(self.gap[on] > 0.0, length * change[:-1], 0.0)
            bounded = np.where(rise > 0.5, np.log1p(np.maximum(rise, 0.0)) / length, change[:-1])
            moved = pressure.copy()
            moved[on] += bounded
            depth += change[-1]
            overlap = depth - self.shape - self.gap * np.expm1(worn) - self.influence @ moved
            # The contact is a disc, whose last ring is looked for.
            last = np.flatnonzero(np.where(touches, moved > 0.0, overlap > 0.0)).max()
            now = (np.arange(touches.size) <= last) & (touches | (count < 15))
            small = np.max(np.abs(rise)) < 1e-8
            pressure = np.where(now, np.maximum(moved, 0.0), 0.0)
            if small and np.all(now == touches):
                return pressure, depth
            touches = now
        raise RuntimeError("no pressures found")


def worn_shares(k, phi, times, rings=80, steps=40):
    """Worn volume over the final one at the times, extrapolated in the step."""
    final = float(oracle.wear_volume(k, phi, digits=20))
    return volumes_at(OneForce(k, phi, rings), times, steps) / final


def volumes_at(contact, times, steps):
    """Worn volumes at the times, extrapolated in the step."""

    def by(steps):
        grid = np.concatenate(
            [[0.0], *(np.linspace(a, b, steps + 1)[1:] for a, b in zip([0.0, *times], times, strict=False))]
        )
        return contact.march(grid)[0][steps::steps]

    one, two, four = by(steps), by(2 * steps), by(4 * steps)
    return (8.0 * four - 6.0 * two + one) / 3.0


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


def tangential_ratio(k, nu):
    """theta from the surface compliances of waves in the graded half-space, z^k deep, at wavenumber 1.

    From deep down up to the surface, in x with z = x^m so that the singular modulus at the surface does not matter.
    """
    m, deep = 4.0 / (1.0 - abs(k)), 20.0
    slope, homogeneous = riccati(lambda z: z**k, nu, 1.0)

    def along(x, state):
        return m * x ** (m - 1.0) * slope(x**m, state)

    ends = deep ** (1.0 / m), 1e-12
    found = solve_ivp(along, ends, homogeneous(deep**k), method="DOP853", rtol=1e-11, atol=1e-13, max_step=0.02)
    in_plane, _, normal, anti = found.y[:, -1]
    return 0.5 * (in_plane + anti) / normal
