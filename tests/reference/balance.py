"""What the fields of a run add up to: the normal force by its pressures, the volume by its depths."""

import numpy as np


def sums(run, cycles):
    """(Force in N, volume in m^3) after so many cycles, which have a last axis of one number."""
    inner, outer = (np.asarray(radius(cycles)) for radius in (run.stick_radius, run.contact_radius))
    x, weight = np.polynomial.legendre.leggauss(60)
    x, weight = 0.5 + 0.5 * x, 0.5 * weight
    # Dense on both sides of the stick-slip boundary, in r^2.
    sticks, area = inner * np.sqrt(1.0 - x**3), np.pi * inner**2 * 3.0 * x**2 * weight
    ring = np.sqrt(inner**2 + (outer**2 - inner**2) * x * x * (2.0 - x * x))
    around = np.pi * (outer**2 - inner**2) * 4.0 * x * (1.0 - x * x) * weight
    pressed = np.sum(area * run.pressure(sticks, cycles), -1) + np.sum(around * run.pressure(ring, cycles), -1)
    return pressed, np.sum(around * run.depth(ring, cycles), -1)
