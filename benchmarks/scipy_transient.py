"""Wear over cycles in NumPy and SciPy: the library's own method, and the usual march by reduction of dimensions.

Units are those of `plgwear_jax.transient`. Both answer the share of the final volume that is worn after n.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.linalg import cho_factor, cho_solve

from plgwear_jax import fretting

__all__ = ["by_reduction_of_dimensions", "same_method"]

# --- the same method --------------------------------------------------------------------------------------------------

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


# --- the usual march ------------------------------------------------------------------------------------------------


def by_reduction_of_dimensions(phi: float, n: np.ndarray, points: int, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Profile to one-dimensional profile to pressure and back, in explicit steps, for k = 0.

    Returns:
        (Shares after n; the pressures at the radii of the last step, from the stick edge outwards.)
    """
    c, outer = (1.0 - phi) ** (1.0 / 3.0), float(fretting.worn_radius(0.0, phi))
    r = np.linspace(0.0, 1.02 * outer, points + 1)
    middle, width = 0.5 * (r[1:] + r[:-1]), r[1]
    # g(x) = x int_0^x f'(r)/sqrt(x^2 - r^2) dr with a constant f' between two radii.
    angle = np.arcsin(np.clip(r[None, :] / np.maximum(r, width)[:, None], 0.0, 1.0))
    to_line = r[:, None] * np.diff(angle, axis=1)
    # p(r) = 3/4 int_r^a g'(x)/sqrt(x^2 - r^2) dx with a constant g' between two places.
    upper = np.arccosh(np.maximum(r[None, :] / middle[:, None], 1.0))
    to_pressure = 0.75 * np.diff(upper, axis=1)
    gap = np.where(middle > c, _gap(middle, c), 0.0)
    times = np.linspace(0.0, n[-1], steps + 1)
    worn, volumes, pressure = np.zeros(points), [0.0], np.zeros(points)
    height = 0.5 * middle**2
    for length in np.diff(times):
        shape = height + worn
        slope = np.append(np.diff(shape) / width, r[-1])  # between the middles
        slope = 0.5 * (np.append(0.0, slope[:-1]) + slope)
        line = to_line @ slope
        # The contact carries the load: int_0^a (g(a) - g) dx = 2/3.
        load = r * line - np.concatenate([[0.0], np.cumsum(0.5 * (line[1:] + line[:-1]) * width)])
        edge = int(np.searchsorted(np.maximum.accumulate(load), 2.0 / 3.0))
        slopes = np.where(np.arange(points) < edge, np.diff(line) / width, 0.0)
        pressure = np.maximum(to_pressure @ slopes, 0.0)
        worn = worn + length * np.where(middle > c, pressure * (gap + worn), 0.0)
        volumes.append(2.0 * np.pi * width * np.sum(middle * worn))
        if not np.isfinite(volumes[-1]) or volumes[-1] > 1e3:
            volumes += [np.inf] * (steps + 1 - len(volumes))
            break
    return np.interp(n, times, volumes) / float(fretting.wear_volume(0.0, phi)), pressure[middle > c]


def _gap(r: np.ndarray, c: float) -> np.ndarray:
    """The gap beside the contact of radius c under the parabola, for k = 0."""
    root = np.sqrt(np.maximum((r / c) ** 2 - 1.0, 0.0))
    return 0.5 * r * r - c * c + c * c / np.pi * ((2.0 - (r / c) ** 2) * np.arcsin(np.minimum(c / r, 1.0)) + root)
