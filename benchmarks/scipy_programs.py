"""The wear volume as SciPy's users have it today: two programs in NumPy arrays, the first and the fastest.

    paper, as printed    c by Eq. (16), the displacement by Eq. (24), a_inf by root finding on Eq. (26), and Eq. (28) by
                         SciPy's adaptive quadrature for arrays; derivatives by central differences
    expert, tuned        the reduced form: one incomplete beta function, for the edge of the ring Halley's step from a
                         fitted start, no further than the volume needs, which is stationary in the edge, and the
                         volume in closed form; derivatives at a fixed edge, in phi in closed form

Both are vectorised, and work in chunks of the size at which each runs fastest. Needs SciPy 1.15.
"""

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeAlias

import harness
import numpy as np
from numpy.typing import NDArray
from scipy import integrate, special
from scipy.optimize import elementwise

Array: TypeAlias = NDArray[np.float64]
Gradient: TypeAlias = tuple[Array, tuple[Array, Array]]


def in_chunks(size: int) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Call a function of arrays on `size` points at a time."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(function)
        def chunked(*points: Array) -> Any:
            count = len(points[0])
            parts = [function(*(x[i : i + size] for x in points)) for i in range(0, count, size)]
            return np.concatenate(parts, axis=-1)

        return chunked

    return decorate


# --- the paper as printed -------------------------------------------------------------------------------------------


def _coefficients(k: Array, phi: Array) -> tuple[Array, ...]:
    """All that does not depend on r: c, d_inf, the factors of both regularised betas of Eq. (24), their exponents."""
    c = (1 - phi) ** (1 / (k + 3))
    d = c**2 / (k + 1) + 2 * phi / ((k + 1) * (k + 3) * c ** (k + 1))
    p, q = (1 + k) / 2, (1 - k) / 2
    cosine = np.cos(k * np.pi / 2) / np.pi
    first = cosine * c**2 / (k + 3) * (1 + 2 / ((k + 1) * c ** (k + 3))) * special.beta(p, q)
    second = cosine / (k + 1) * special.beta(p + 1, q)
    return c, d, first, second, p, q


def _depth(r: Array, c: Array, d: Array, first: Array, second: Array, p: Array, q: Array) -> Array:
    """d_inf - w_inf - r^2/2: what Eq. (26) makes zero and Eq. (28) integrates."""
    t = (c / r) ** 2
    displacement = first * special.betainc(p, q, t) - second * r**2 * special.betainc(p + 1, q, t)
    return d - displacement - r**2 / 2


def _outer_radius(k: Array, phi: Array) -> Array:
    """a_inf: the ring reaches beyond the initial contact, and not to where w_inf would be negative."""
    coefficients = _coefficients(k, phi)
    bracket = (np.ones_like(k), np.sqrt(2 * coefficients[1]))
    return elementwise.find_root(_depth, bracket, args=coefficients).x


@in_chunks(16_384)
def paper_wear_volume(k: Array, phi: Array) -> Array:
    """Eq. (28) by adaptive tanh-sinh quadrature."""

    def integrand(r: Array, *coefficients: Array) -> Array:
        return 2 * np.pi * r * _depth(r, *coefficients)

    a, coefficients = _outer_radius(k, phi), _coefficients(k, phi)
    return integrate.tanhsinh(integrand, coefficients[0], a, args=coefficients, rtol=1e-10).integral


# --- the reduced form -----------------------------------------------------------------------------------------------

# s = (1+k)/2, q = 1 - s, y = (r/c)^2 - 1, sigma = sin(pi s)/pi, Q = I_(y/(1+y))(q, s), u = sigma y^q/Q,
# m = phi/((1-phi) (1+s)). The ring ends where s y - q + u = m, between y = (1+q) m and m/s.


def _tail(y: Array, s: Array, q: Array) -> tuple[Array, Array]:
    """(Q, sigma y^q)."""
    return special.betainc(q, s, y / (1 + y)), np.sin(np.pi * s) / np.pi * y**q


def _reduced(k: Array, phi: Array) -> tuple[Array, Array, Array]:
    s, q = (1 + k) / 2, (1 - k) / 2
    return s, q, phi / ((1 - phi) * (1 + s))


def _volume(phi: Array, y: Array, s: Array, q: Array, m: Array, Q: Array, power: Array) -> Array:
    """The integral of Eq. (28) over y in closed form."""
    load = (m + q) / s
    integral = (load * (1 + y) + (1 - y * y) / 2) * Q - power * ((load + 0.5) / q + y / (2 * s))
    return _unit(phi, s) * integral


def _unit(phi: Array, s: Array) -> Array:
    """pi c^4/2."""
    return np.pi / 2 * (1 - phi) ** (2 / (1 + s))


def _at_edge(k: Array, phi: Array, y: Array) -> Array:
    s, q, m = _reduced(k, phi)
    return _volume(phi, y, s, q, m, *_tail(y, s, q))


def _halley(y: Array, s: Array, q: Array, m: Array) -> Array:
    Q, power = _tail(y, s, q)
    u = power / Q
    v = u / (1 + y)
    log_slope = (q - v) / y  # u'/u
    slope = s + u * log_slope
    bend = u * (log_slope**2 - (log_slope + v * (log_slope - 1 / (1 + y))) / y)
    excess = s * y - q + u - m
    return y - excess / (slope - excess * bend / (2 * slope))


def _edge(k: Array, phi: Array, steps: int) -> Array:
    """The edge from a start that is 8 % off at the worst; the first step leaves 2e-6, the second nothing."""
    s, q, m = _reduced(k, phi)
    y = m * (1 + q - q * q * np.expm1(-s * np.log1p(m / 1.5)) / s)
    for _ in range(steps):
        y = _halley(y, s, q, m)
    return y


@in_chunks(8192)
def tuned_expert_wear_volume(k: Array, phi: Array) -> Array:
    """An error of 2e-6 in the edge is its square in the volume."""
    return _at_edge(k, phi, _edge(k, phi, 1))


# --- derivatives ----------------------------------------------------------------------------------------------------


STEP = 3e-4  # of central differences, in shares of the distance from the ends of the domain


def paper_gradient(k: Array, phi: Array) -> Gradient:
    """By central differences."""
    volume, dk, dphi = paper_wear_volume, STEP * (1 - np.abs(k)), STEP * np.minimum(phi, 1 - phi)
    by_k = (volume(k + dk, phi) - volume(k - dk, phi)) / (2 * dk)
    by_phi = (volume(k, phi + dphi) - volume(k, phi - dphi)) / (2 * dphi)
    return volume(k, phi), (by_k, by_phi)


def tuned_expert_gradient(k: Array, phi: Array) -> Gradient:
    """The volume is stationary in the edge: its gradient is that at a fixed edge, with one beta function a value."""
    value, by_k, by_phi = _at_fixed_edge(k, phi)
    return value, (by_k, by_phi)


@in_chunks(8192)
def _at_fixed_edge(k: Array, phi: Array) -> Array:
    s, q, m = _reduced(k, phi)
    y = _edge(k, phi, 2)
    Q, power = _tail(y, s, q)
    value = _volume(phi, y, s, q, m, Q, power)
    rise = 1 / ((1 - phi) ** 2 * (1 + s) * s)  # of the load (m + q)/s, with phi
    by_phi = _unit(phi, s) * rise * ((1 + y) * Q - power / q) - 2 * value / ((1 - phi) * (1 + s))
    dk = STEP * (1 - np.abs(k))
    by_k = (_at_edge(k + dk, phi, y) - _at_edge(k - dk, phi, y)) / (2 * dk)
    return np.stack([value, by_k, by_phi])


PAPER, TUNED_EXPERT = "paper, as printed", "expert, tuned"
VALUES: dict[str, Callable[[Array, Array], Array]] = {
    PAPER: paper_wear_volume,
    TUNED_EXPERT: tuned_expert_wear_volume,
}
GRADIENTS: dict[str, Callable[[Array, Array], Gradient]] = {
    PAPER: paper_gradient,
    TUNED_EXPERT: tuned_expert_gradient,
}


# --- the table ------------------------------------------------------------------------------------------------------

SUBSETS = {PAPER: 16_384, TUNED_EXPERT: 131_072}  # points: some tenths of a second


def programs(points: harness.Points, exact: harness.Exact, quick: bool) -> dict[tuple[str, str], harness.Program]:
    """All programs by name and "value" or "with gradient", on the first of `points`."""
    found = {}
    for name, most in SUBSETS.items():
        count = most // 8 if quick else most
        found[name, "value"] = harness.Program(VALUES[name], harness.head(points, count), exact)
        found[name, "with gradient"] = harness.Program(GRADIENTS[name], harness.head(points, count // 2), exact, (0, 1))
    return found
