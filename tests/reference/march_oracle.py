"""Any test over cycles by rings of constant pressure and the Green's function of the half-space alone.

Nothing here shares code with the library. The displacement of a uniformly pressed disc is the hypergeometric function
of Eq. (5), a ring is the difference of two discs, and which rings touch is found by exchange, so they need be neither
a disc nor one ring. Steps are of Euler's method, of first order, the pressure implicit and the slip explicit. Radii are
in a_0, heights in a_0^2/R, volumes in a_0^4/R, pressures in F_N/(pi a_0^2), and n is that of `plgwear_jax.transient`,
all by the F_N and mu of the contact.
"""

from typing import NamedTuple

import numpy as np
import oracle
from refusals import data
from scipy.special import beta
from surface_oracle import disc


class Given(NamedTuple):
    """What is given in a block, forces, friction and displacements relative to those of the contact."""

    n: float
    force: float | None = None  # amplitude over mu F_N
    displacement: float | None = None  # amplitude over that at which the contact begins to slip as a whole
    normal_force: float = 1.0
    friction: float = 1.0
    rig: float = 0.0  # by how much a rig gives way under mu F_N, relative to the same displacement as above


# Blocks, and a radius beyond the last scar.
HISTORIES = {
    name: ([Given(**block) for block in one["blocks"]], one["outer"])
    for name, one in data("reference/histories.toml").items()
}


def drawn(rng):
    """One to three blocks with a force, a displacement, or one at the actuator of a rig."""
    blocks = []
    for way in rng.integers(3, size=rng.integers(1, 4)):
        N, mu = rng.uniform((0.7, 0.8), (1.4, 1.25))
        rig = (way == 2) * 10.0 ** rng.uniform(-1.0, 1.0)
        asked = (None, rng.uniform(0.1, 2.8) + 0.6 * rig) if way else (rng.uniform(0.05, 0.97) * N * mu, None)
        blocks.append(Given(rng.uniform(0.1, 0.8), *asked, N, mu, rig))
    return blocks


class Rings(NamedTuple):
    """Rings of any half-space under a shape."""

    r: np.ndarray  # of their middles
    load: np.ndarray  # area over pi
    shape: np.ndarray  # its height
    A: np.ndarray  # displacements by pressures
    first: float  # the penetration of the unworn contact

    def pressed(self, shape, soft, touches, *, force=None, depth=None, rig=0.0):
        """(Pressures, depth) of a shape under a force or at a depth: A p + soft p = depth - shape where p > 0.

        A depth is that of a spring, which gives way by `rig` for a force of 1.
        """
        A = self.A + rig * self.load
        for _ in range(300):
            if force is not None and not np.any(touches):
                touches = shape == shape.min()
            on = np.flatnonzero(touches)
            matrix = A[np.ix_(on, on)] + np.diag(soft[on])
            if force is None:
                found = np.linalg.solve(matrix, depth - shape[on]) if on.size else np.zeros(0)
            else:
                right = np.linalg.solve(matrix, np.stack([np.ones(on.size), shape[on]], -1))
                depth = (force + self.load[on] @ right[:, 1]) / (self.load[on] @ right[:, 0])
                found = depth * right[:, 0] - right[:, 1]
            p = np.zeros(shape.size)
            p[on] = found
            overlaps = depth - shape - A @ p > 1e-13
            now = np.where(touches, p > 0.0, overlaps)
            if np.all(now == touches):
                return p, depth - rig * (self.load @ p)
            # All that pull let go; of those that overlap enough come back to begin again.
            touches = now if np.any(now) else overlaps | (shape == shape.min())
        raise RuntimeError("no pressures found")

    def march(self, blocks, steps):
        """At the ends of all steps: n, volumes, force amplitudes over mu F_N, outer radii of contact and stick area."""
        worn, touches, sticks = np.zeros(self.r.size), self.r < 1.0, self.r < 1.0
        p, depth = self.pressed(self.shape, 0.0 * worn, touches, force=blocks[0].normal_force)
        n, found = 0.0, [(0.0, 0.0, np.nan, 1.0, np.nan)]
        for given in blocks:
            # Steps that grow, so that a new load is followed from its first moments on.
            lengths = given.n * np.diff(np.expm1(6.0 * np.linspace(0.0, 1.0, steps + 1)) / np.expm1(6.0))
            p, depth = self.pressed(self.shape + worn, 0.0 * worn, p > 0.0, force=given.normal_force)
            for length in lengths:
                shape, nothing = self.shape + worn, 0.0 * worn
                if given.displacement is not None:
                    rig = given.rig * self.first
                    less = depth - given.displacement / given.friction * self.first + rig * given.normal_force
                    held = {"depth": less, "rig": rig}
                    second = self.pressed(shape, nothing, sticks, **held) if less > shape.min() else (nothing, less)
                else:
                    load = given.normal_force - given.force / given.friction
                    second = self.pressed(shape, nothing, sticks, force=load)
                sticks = second[0] > 0.0
                gap = np.where(sticks, 0.0, np.maximum(shape + self.A @ second[0] - second[1], 0.0))
                soft = length * given.friction * gap
                p, depth = self.pressed(shape, soft, p > 0.0, force=given.normal_force)
                worn, n = worn + soft * p, n + length
                tangential = given.friction * (given.normal_force - self.load @ second[0])
                found.append((n, np.pi * self.load @ worn, tangential, self.radius(p), self.radius(second[0])))
        return np.array(found).T

    def volumes_at(self, times, steps, **given):
        """Worn volumes at the times of one block, extrapolated in the step."""
        between = [Given(n, **given) for n in np.diff(times, prepend=0.0)]
        one, two, four = (self.march(between, m * steps)[1][m * steps :: m * steps] for m in (1, 2, 4))
        return (8.0 * four - 6.0 * two + one) / 3.0

    def radius(self, pressures):
        """The outer one of the last ring with a pressure."""
        return np.sqrt(np.sum(self.load[: np.max(np.flatnonzero(pressures), initial=-1) + 1]))


def rings_of(edges, of_discs, first, n=2.0):
    """Rings between edges, from 0 on, under r^n/n, from the displacements of discs, (their radii, places)."""
    r = 0.5 * (edges[1:] + edges[:-1])
    discs = np.zeros((r.size, edges.size))
    discs[:, 1:] = of_discs(edges[1:], r)
    return Rings(r, np.diff(edges**2), r**n / n, np.diff(discs, axis=1), first)


def on_power_law(k, edges):
    """Rings under a parabola."""
    s = 0.5 * (1.0 + k)
    # By Eqs. (11) and (13) the pressure (1+s) (1 - r^2)^s sinks in by 1/(1+k).
    scale = 1.0 / ((1.0 + k) * (1.0 - k) * (1.0 + s) * 0.5 * beta(0.5 * (1.0 - k), 1.0 + s))
    return rings_of(edges, lambda b, r: scale * b ** (1.0 - k) * disc(r[:, None] / b, k), 1.0 / (1.0 + k))


def edges_to(outer, inner, beyond):
    """Of rings that crowd towards a_0 from both sides, to an outer radius."""
    inside = 1.0 - (1.0 - np.linspace(0.0, 1.0, inner + 1)) ** 1.5
    x = np.linspace(0.0, 1.0, beyond + 1)[1:]
    growth = np.log(max((outer - 1.0) * inner / beyond, 1.001)) * 1.6
    return np.concatenate([inside, 1.0 + (outer - 1.0) * np.expm1(growth * x) / np.expm1(growth)])


def edges_beside(c, outer, count):
    """Of rings that crowd towards the stick-slip boundary: half as many where it sticks as beside it."""
    inner = c * (1.0 - (1.0 - np.linspace(0.0, 1.0, count // 2 + 1)) ** 3)
    x = np.linspace(0.0, 1.0, count + 1)[1:]
    return np.concatenate([inner, c + (outer - c) * x**2 * (1.5 - 0.5 * x)])


def worn_shares(k, phi, times, count, steps):
    """Worn volume over the final one at the times, of a constant force."""
    names = "stick_radius", "worn_radius", "wear_volume"
    c, outer, final = (float(oracle.QUANTITIES[name](k, phi, digits=20)) for name in names)
    return on_power_law(k, edges_beside(c, outer, count)).volumes_at(times, steps, force=phi) / final
