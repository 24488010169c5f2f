"""The compliance of surfaces without a closed form, by the Green's function alone."""

import numpy as np
import surface_oracle
from kinds import STEEL
from scipy.interpolate import CubicSpline

from plgwear_jax import Layered

A = 1e-4  # contact radius


def graded_compliance(modulus, nu, bottom, jumps, indenter):
    """2 (1 + m)/(E* q) with m on a fine mesh of wavenumbers, up to where it is nothing."""
    logs = np.linspace(np.log(1e-4), np.log(240.0), 90)
    m = CubicSpline(logs, [surface_oracle.excess(modulus, nu, bottom, jumps, np.exp(x) / A) for x in logs])
    edges = np.concatenate([[0.0], np.geomspace(1e-3, 0.2, 12), np.arange(0.7, 60.0, 0.5)])
    x, weight = np.polynomial.legendre.leggauss(8)
    q = (edges[:-1, None] + np.diff(edges)[:, None] * (0.5 + 0.5 * x)).ravel()
    weights = (0.5 * np.diff(edges)[:, None] * weight).ravel() / A
    own = 2.0 * (1.0 - nu**2) / modulus(0.0)
    both = own + 2.0 * (1.0 - indenter.nu**2) / indenter.E
    weighted = weights * own * m(np.maximum(np.log(q), logs[0]))
    return surface_oracle.Compliance([(both, 0.0)], q / A, weighted)


def layers_under_steel():
    """Three layers, and what they and steel yield together."""
    moduli, interfaces = np.array([50e9, 300e9, 100e9]), np.array([0.3, 1.0]) * A
    compliance = graded_compliance(
        lambda z: moduli[np.searchsorted(interfaces, z, "right")], 0.25, interfaces[-1], list(interfaces), STEEL
    )
    return Layered(np.diff(interfaces, prepend=0.0), moduli, 0.25), compliance
