"""Constants of a compliance that is a sum of m_k/(1 + (q/q_k)^2), with q_k in equal steps of its logarithm.

Such a compliance is a row of springs with shear layers on it, and all its integrals over the pressures of the contact
are Bessel functions. In x = q c, with J of the order 2n + 1/2,

    integral of J_n J_m/(x (1 + (x/x_k)^2)) dx = delta_nm/(4n+1) - (-1)^(n+m) I_(larger)(x_k) K_(smaller)(x_k),
    integral of J_n cos(x t)/(sqrt(x) (1 + (x/x_k)^2)) dx = (pi/2) sqrt(x_k) (-1)^n I_n(x_k) exp(-x_k t),    t > 1.
"""

import functools
from typing import NamedTuple

import numpy as np
from scipy.special import ive, kve

from plgwear_jax.surfaces.effort import Effort

__all__ = ["Foundation", "foundation", "wavenumbers"]

_REACH = 10.0  # by which the radius of the contact may be larger than its estimate; and twice that, smaller


def _steps(least: float, most: float, spacing: float) -> np.ndarray:
    return least * np.exp(spacing * np.arange(int(np.log(most / least) / spacing) + 2))


def _inverse(x: np.ndarray) -> np.ndarray:
    """From values at x to the coefficients m_k."""
    return np.linalg.inv(1.0 / (1.0 + (x[:, None] / x) ** 2))


@functools.cache
def wavenumbers(effort: Effort) -> tuple[np.ndarray, np.ndarray]:
    """(Wavenumbers in units of one over an estimate of the radius, the matrix from values there to coefficients)."""
    q = _steps(effort.least / _REACH, 2.0 * _REACH * effort.most, effort.spacing)
    return q, _inverse(q)


class Foundation(NamedTuple):
    """Matrices that take values of the compliance at x."""

    x: np.ndarray  # (n,)
    matrix: np.ndarray  # (modes, modes, n), to that of the contact
    coefficients: np.ndarray  # (n, n), to the coefficients m_k
    beside: np.ndarray  # (n, modes), of coefficients of the pressure: m_k times it is the factor of exp(-x_k (t-1))


@functools.cache
def foundation(effort: Effort) -> Foundation:
    """Those in x = q c."""
    x = _steps(effort.least, effort.most, effort.spacing)
    number = np.arange(effort.modes)
    order = 2.0 * number + 0.5
    rising, falling = ive(order, x[:, None]), kve(order, x[:, None])
    i, j = np.maximum(number[:, None], number), np.minimum(number[:, None], number)
    sign = (-1.0) ** number
    with np.errstate(over="ignore", invalid="ignore"):
        product = rising[:, i] * falling[:, j]
    # Where the one is nothing and the other is without bounds: from their ratio to orders of the diagonal.
    product = np.where(np.isfinite(product), product, 0.0)
    springs = np.diag(1.0 / (2.0 * order)) - sign[:, None] * sign * product
    inverse = _inverse(x)
    beside = 0.5 * np.pi * np.sqrt(x)[:, None] * sign * rising
    return Foundation(x, np.moveaxis(np.tensordot(inverse, springs, (0, 0)), 0, -1), inverse, beside)
