"""Any test over cycles by rings of constant pressure and the Green's function of the half-space alone.

Nothing here shares code with the library. The displacement of a uniformly pressed disc is the hypergeometric function
of Eq. (5), a ring is the difference of two discs, and which rings touch is found by exchange, so they need be neither
a disc nor one ring. Steps are of Euler's method, of first order, the pressure implicit and the slip explicit. Radii are
in a_0, heights in a_0^2/R, volumes in a_0^4/R, pressures in F_N/(pi a_0^2), and n is that of `plgwear_jax.transient`,
all by the F_N and mu of the contact.
"""

from typing import NamedTuple

import numpy as np
from transient_oracle import influence


class Given(NamedTuple):
    """What is given in a block, forces, friction and displacements relative to those of the contact."""

    n: float
    force: float | None = None  # amplitude over mu F_N
    displacement: float | None = None  # amplitude over that at which the contact begins to slip as a whole
    normal_force: float = 1.0
    friction: float = 1.0


# Blocks, and a radius beyond the last scar.
HISTORIES = {
    "a held displacement": ([Given(3.0, displacement=0.6)], 1.25),
    "gross slip": ([Given(0.6, displacement=3.0)], 2.8),
    "just beyond the onset": ([Given(0.3, displacement=1.05), Given(0.5, displacement=1.05)], 2.0),
    "changing force and friction": (
        [
            Given(0.5, displacement=0.5),
            Given(0.3, displacement=0.8, normal_force=1.5, friction=0.8),
            Given(0.5, force=0.5, friction=1.2),
        ],
        1.8,
    ),
    "from gross to partial slip": (
        [
            Given(0.4, displacement=2.0),
            Given(0.6, displacement=0.6, friction=1.3),
            Given(0.3, displacement=2.5, normal_force=0.7),
        ],
        2.4,
    ),
}


class Rings(NamedTuple):
    """Rings of any half-space under a shape."""

    r: np.ndarray  # of their middles
    load: np.ndarray  # area over pi
    shape: np.ndarray  # its height
    A: np.ndarray  # displacements by pressures
    first: float  # the penetration of the unworn contact

    def pressed(self, shape, soft, touches, *, force=None, depth=None):
        """(Pressures, depth) of a shape under a force or at a depth: A p + soft p = depth - shape where p > 0."""
        for _ in range(300):
            on = np.flatnonzero(touches)
            matrix = self.A[np.ix_(on, on)] + np.diag(soft[on])
            if force is None:
                found = np.linalg.solve(matrix, depth - shape[on]) if on.size else np.zeros(0)
            else:
                right = np.linalg.solve(matrix, np.stack([np.ones(on.size), shape[on]], -1))
                depth = (force + self.load[on] @ right[:, 1]) / (self.load[on] @ right[:, 0])
                found = depth * right[:, 0] - right[:, 1]
            p = np.zeros(shape.size)
            p[on] = found
            overlaps = depth - shape - self.A @ p > 1e-13
            now = np.where(touches, p > 0.0, overlaps)
            if np.all(now == touches):
                return p, depth
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
                    less = depth - given.displacement / given.friction * self.first
                    second = self.pressed(shape, nothing, sticks, depth=less) if less > shape.min() else (nothing, less)
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

    def radius(self, pressures):
        """The outer one of the last ring with a pressure."""
        return np.sqrt(np.sum(self.load[: np.max(np.flatnonzero(pressures), initial=-1) + 1]))


def on_power_law(k, edges):
    """Rings between edges, from 0 on, under a parabola."""
    r = 0.5 * (edges[1:] + edges[:-1])
    return Rings(r, np.diff(edges**2), 0.5 * r**2, influence(k, edges), 1.0 / (1.0 + k))


def edges_to(outer, inner=60, beyond=60):
    """Of rings that crowd towards a_0 from both sides, to an outer radius."""
    inside = 1.0 - (1.0 - np.linspace(0.0, 1.0, inner + 1)) ** 1.5
    x = np.linspace(0.0, 1.0, beyond + 1)[1:]
    first = 1.0 / inner
    growth = np.log(max((outer - 1.0) / (first * beyond), 1.001)) * 1.6
    return np.concatenate([inside, 1.0 + (outer - 1.0) * np.expm1(growth * x) / np.expm1(growth)])
