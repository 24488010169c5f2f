"""Constants of a compliance that is a sum of m_k/(1 + (q/q_k)^4), with q_k in equal steps of its logarithm.

Each term is the real part of 1/(1 + (q/p)^2) with p = q_k exp(i pi/4), a row of springs with a shear layer on it, and
all its integrals over the pressures of the contact are Bessel functions. In x = q c, with J of the order 2n + 1/2,

    integral of J_n J_m/(x (1 + (x/p)^2)) dx = delta_nm/(4n+1) - (-1)^(n+m) I_(larger)(p) K_(smaller)(p),
    integral of J_n cos(x t)/(sqrt(x) (1 + (x/p)^2)) dx = (pi/2) sqrt(p) (-1)^n I_n(p) exp(-p t),    t > 1.
"""

import functools
from typing import NamedTuple

import numpy as np
from jax import Array

from plgwear_jax.special.elementary import in_dtype

from .effort import Effort

# Wavenumbers in units of one over the radius, below which the compliance is constant and above which it is that of the
# surface: a narrow ring feels layers of 1e-7 radii.
_LEAST, _MOST = 1e-3, 1e7
_LARGER = 5.0  # than its estimate the radius of the contact may be by such a factor
_FELT = 1e-15  # of the largest square of a combination of values that the contact feels
_BELOW, _ABOVE = 4.0, 5.0  # the grid goes on by these factors beyond where the compliance is constant


def _steps(spacing: float, further: float = 1.0) -> np.ndarray:
    least, most = _LEAST / (_BELOW * further), _ABOVE * further * _MOST
    return least * np.exp(spacing * np.arange(int(np.log(most / least) / spacing) + 2))


class Terms(NamedTuple):
    """The coefficients m_k of the terms with q_k at some wavenumbers, and what the sum of them is there."""

    values: np.ndarray  # (n, n), of each term
    inverse: np.ndarray

    def of(self, values: Array) -> Array:
        """The coefficients, of values at these wavenumbers."""
        inverse, own = in_dtype(values.dtype, self.inverse, self.values)
        found = inverse @ values
        # The inverse is large, so that in float32 the sum is only right once what is left over has been added.
        return found + inverse @ (values - own @ found)


def _terms(x: np.ndarray) -> Terms:
    values = 1.0 / (1.0 + (x[:, None] / x) ** 4)
    return Terms(values, np.linalg.inv(values))


@functools.cache
def wavenumbers(effort: Effort) -> tuple[np.ndarray, np.ndarray, Terms]:
    """(Wavenumbers q_k in units of one over an estimate of the radius, those whose compliance they get, the terms).

    Towards both ends they get that of the last one that counts, without a kink, which would not be a sum of such terms.
    """
    q = _steps(effort.spacing)
    seen = ((q**4 + _LEAST**4) / (1.0 + (q / _MOST) ** 4)) ** 0.25
    return q, seen, _terms(q)


class Foundation(NamedTuple):
    """Matrices that take values of the compliance at x."""

    x: np.ndarray  # (n,)
    parts: np.ndarray  # (r, n), to the few combinations of them that the contact feels
    matrix: np.ndarray  # (modes, modes, r), from these to that of the contact
    terms: Terms
    beside: (
        np.ndarray
    )  # (2, n, modes), of the pressure's coefficients: m_k times both are the factors of the real and of
    # the negative imaginary part of exp(-p_k (t-1))
    edge: np.ndarray  # (2, n, n), real and imaginary part of what log(1 + m) counts for at the edge of a half-plane


@functools.cache
def foundation(effort: Effort) -> Foundation:
    """Foundation matrices for this accuracy, in x = q c."""
    from scipy.special import gammaln, ive, kve  # which power laws do without

    x = _steps(effort.spacing, _LARGER)
    number = np.arange(effort.modes)
    order = 2.0 * number + 0.5
    pole = (x * np.exp(0.25j * np.pi))[:, None]
    rising, falling = ive(order, pole), kve(order, pole) * np.exp(-1j * pole.imag)
    i, j = np.maximum(number[:, None], number), np.minimum(number[:, None], number)
    sign = (-1.0) ** number
    # Where a product is no number, x is small.
    power = (order[i] - order[j]) * np.log(0.5 * pole[:, None]) + gammaln(order[j]) - gammaln(order[i] + 1.0)
    with np.errstate(over="ignore", invalid="ignore"):
        product = rising[:, i] * falling[:, j]
        product = np.where(np.isfinite(product) & (abs(rising[:, i]) > 0.0), product, 0.5 * np.exp(power))
    springs = np.diag(1.0 / (2.0 * order)) - sign[:, None] * sign * product.real
    terms = _terms(x)
    beside = 0.5 * np.pi * np.sqrt(pole) * sign * rising * np.exp(-1j * pole.imag)
    matrix = np.moveaxis(np.tensordot(terms.inverse, springs, (0, 0)), 0, -1)
    weighted = (np.sqrt(2.0 * order[:, None] * 2.0 * order)[:, :, None] * matrix).reshape(-1, x.size)
    sizes, parts = np.linalg.eigh(weighted.T @ weighted)
    parts = parts[:, sizes > _FELT * sizes[-1]]
    edge = effort.spacing / np.pi * pole * x / (x * x + pole * pole)
    beside, edge = (np.stack([both.real, both.imag]) for both in (beside, edge))
    return Foundation(x, parts.T, matrix @ parts, terms, beside, edge)
