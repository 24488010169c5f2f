"""Wear over cycles in NumPy and SciPy, by the library's own method.

Units are those of `plgwear_jax.transient`. The answer is the share of the final volume that is worn after n.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.linalg import cho_factor, cho_solve

from plgwear_jax import fretting

__all__ = ["same_method"]

INNER, OUTER, BEYOND, LENGTH, MULTIPLES = 8, 18, 2, 4.7, (1, 2, 3)  # those of four digits


class _Ring(NamedTuple):
    matrix: np.ndarray
    gap: np.ndarray
    steady: np.ndarray
    first: np.ndarray  # p_0
    inner: int
    steps: int


def _ring(k: float, phi: float, multiple: int) -> _Ring:
    """A ring in cells of constant pressure, all integrated over cells, in units of C."""
    s, q = 0.5 * (1.0 + k), 0.5 * (1.0 - k)
    sigma, kappa = np.sin(np.pi * s) / np.pi, 2.0 * s * s * (1.0 + s)
    C, outer = (1.0 - phi) ** (1.0 / (1.0 + s)), float(fretting.worn_radius(k, phi)) ** 2
    inner, count = INNER * multiple, (OUTER + BEYOND) * multiple
    place, v = np.linspace(0.0, 1.0, inner + 1), np.linspace(0.0, 1.0 + BEYOND / OUTER, count + 1)[1:]
    near = np.clip((outer - 1.0) / (1.0 - C) * 10.0 * LENGTH * INNER**2 / OUTER**2, 0.3, 1.0)
    begin, end = place**3, near * (1.0 - place) ** 2
    growth = np.expm1(-LENGTH * v * v) / np.expm1(-LENGTH * v[-1] ** 2)
    T = np.concatenate([C + (1.0 - C) * begin / (begin + end), 1.0 + (outer - 1.0) * growth])
    size = np.diff(T)
    x, weight = np.polynomial.legendre.leggauss(5)
    x, weight = 0.5 + 0.5 * x, 0.5 * weight
    t = (T[1:, None] - size[:, None] * x**2).ravel()
    weight = (size[:, None] * 2.0 * x * weight).ravel() * t ** (s - 1.0)
    share = np.diff(np.maximum(T[:, None] - t, 0.0) ** q / q, axis=0)
    swept, gap = sigma * share @ weight, sigma / (2.0 * s) * share @ (weight * (t - C))
    matrix = sigma**2 / kappa * (share * weight) @ share.T + s / (kappa * C**s) * np.outer(swept, swept)
    wear = phi / ((1.0 - phi) * s * (1.0 + s))  # Lambda
    load = np.maximum(1.0 - T, 0.0) ** (1.0 + s)
    return _Ring(matrix, gap, 0.5 * C * wear * swept - gap, -np.diff(load) / size, inner, OUTER * multiple)


def _march(ring: _Ring) -> tuple[np.ndarray, np.ndarray]:
    """(Times, shares) at the ends of the steps, each of which ends when the contact has grown by a cell."""
    size, enough = ring.gap.size, 3e-4
    past, slopes, told = [np.zeros(size + 1)], [], []
    for step in range(1, ring.steps + 1):
        touching = ring.inner + step
        part = 0.5 if step == 1 else 2.0 / 3.0
        known = np.zeros(size + 1) if step == 1 else (4.0 * past[-1] - past[-2]) / 3.0
        slope = _ahead(slopes, touching) if slopes else 0.04 * np.append(ring.first, ring.gap[0])
        if step <= 3:
            slope[touching - 1] = 0.5 * slope[touching - 2]
        if not slopes:
            slope[-1] = 0.04 * np.sum(ring.steady) / np.sum(ring.first * ring.gap)
        w, pace = part * slope[:touching], 1.0 / (part * slope[-1])
        matrix, row = ring.matrix[:touching, :touching], ring.matrix[touching, :touching]
        gap, steady = ring.gap[:touching], ring.steady[:touching]
        for _ in range(40):
            grown, sunk = gap * np.exp(known[:touching] + w), matrix @ w
            right = np.stack([grown - gap + pace * sunk - steady, sunk], 1)
            factor = cho_factor(pace * matrix + np.diag(grown), lower=True, check_finite=False)
            lack, other = cho_solve(factor, right, check_finite=False).T
            missing, sunk_next = pace * row @ w - ring.steady[touching], row @ w
            change = np.clip((pace * row @ lack - missing) / (sunk_next - pace * row @ other), -0.7 * pace, 2.0 * pace)
            moved = -(lack + change * other)
            moved = np.where(moved > 0.5, np.log1p(np.maximum(moved, 0.0)), moved)
            w, pace = w + moved, pace + change
            if moved @ moved + (change / pace) ** 2 < enough**2 * (w @ w + 1.0):
                break
        change = np.zeros(size + 1)
        change[:touching], change[-1] = w, 1.0 / pace
        past.append(known + change)
        slopes.append(change / part)
        told.append((past[-1][-1], np.sum(ring.gap * np.expm1(past[-1][:-1])) / np.sum(ring.steady)))
    return np.array(told)[:, 0], np.array(told)[:, 1]


def _ahead(slopes: list[np.ndarray], touching: int) -> np.ndarray:
    """The next slopes, by a parabola through the last three; beside the edge of the contact in its own frame."""
    one, two, three = (slopes[-i] if len(slopes) >= i else np.zeros_like(slopes[0]) for i in (1, 2, 3))
    if len(slopes) == 1:
        three = -one
    found = np.maximum(3.0 * (one - two) + three, 0.25 * one)
    if len(slopes) > 2:
        a, b, c = (np.roll(x[:-1], i) for i, x in ((1, one), (2, two), (3, three)))
        found[touching - 4 : touching] = np.maximum(3.0 * (a - b) + c, 0.25 * a)[touching - 4 : touching]
    return found


def same_method(k: float, phi: float, n: np.ndarray) -> np.ndarray:
    """Three marches with multiples of the same cells and steps, extrapolated, as the library has them."""
    marches = [_march(_ring(k, phi, multiple)) for multiple in MULTIPLES]
    weights = np.linalg.inv(np.array(MULTIPLES)[:, None] ** -np.array([0.0, 2.0, 3.0]))[0]
    common = [
        np.stack([x[multiple - 1 :: multiple] for x in march])
        for multiple, march in zip(MULTIPLES, marches, strict=True)
    ]
    finest, limit = np.stack(marches[-1]), np.einsum("i,ijk->jk", weights, np.array(common))
    steps = np.arange(1, finest.shape[1] + 1) / MULTIPLES[-1]
    ratio = CubicSpline(np.arange(1, limit.shape[1] + 1), limit / common[-1], axis=1)(np.maximum(steps, 1.0))
    time, share = np.concatenate([np.zeros((2, 1)), finest * ratio], 1)
    rates = np.gradient(share, edge_order=2) / np.gradient(time, edge_order=2)
    rates[0] = np.sum(share[1] / time[1])
    late, rest = np.maximum(n - time[-1], 0.0), 1.0 - share[-1]
    inside = CubicHermiteSpline(time, share, rates)(np.minimum(n, time[-1]))
    return np.where(late > 0.0, 1.0 - rest * np.exp(-rates[-2] / (1.0 - share[-2]) * late), inside)
