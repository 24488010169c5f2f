"""Time and error of wear over cycles by its digits, on one core, beside a plain march in NumPy and SciPy.

The error is the largest over 64 answers in n and a grid of exponents and amplitudes, of the final volume, against a run
that is finer than any the library offers (than that of four digits if quick). What that itself is off by, the tests
tell, from rings and the Green's function alone. The time is that of one run with 64 answers, its gradient besides; the
first answer includes compilation.
"""

import time
from typing import Any

import harness
import jax
import jax.numpy as jnp
import numpy as np
from harness import Report, short
from scipy.linalg import cho_factor, cho_solve
from scipy.special import betainc

from plgwear_jax import fretting, partial_slip, transient
from plgwear_jax.transient.amount import volume_of
from plgwear_jax.transient.course import compiled_course
from plgwear_jax.transient.grid import EFFORTS, Effort

# As many as one program step takes.
K, PHI = (x.reshape(-1, 1) for x in np.meshgrid([-0.97, -0.4, 0.4, 0.97], [0.005, 0.3, 0.9, 0.98]))
POINT = 0.3, 0.5
FINEST = Effort(10, 24, 6.0, (2, 3, 4, 6))
DIGITS = 4  # the library's default


def unit(k: Any, phi: Any) -> np.ndarray:
    """The final volume over the first rate."""
    return np.asarray(fretting.wear_volume(k, phi) / (0.25 * np.pi * partial_slip.energy_per_cycle(k, phi)))


def plain(k: float, phi: float, n: np.ndarray, cells: int, steps: int) -> np.ndarray:
    """Implicit Euler's steps on uniform cells in T = r^2, as one would write them down first; share of the volume."""
    s, q = 0.5 * (1.0 + k), 0.5 * (1.0 - k)
    sigma, kappa = np.sin(np.pi * s) / np.pi, 2.0 * s * s * (1.0 + s)
    C, outer = (1.0 - phi) ** (1.0 / (1.0 + s)), float(fretting.worn_radius(k, phi)) ** 2
    edges = np.linspace(C, outer, cells + 1)
    size = edges[1] - edges[0]
    T = edges[:-1] + 0.5 * size
    x, weight = np.polynomial.legendre.leggauss(4)
    t = (edges[1:, None] - size * (0.5 + 0.5 * x) ** 4).ravel()
    weight = np.tile(2.0 * size * (0.5 + 0.5 * x) ** 3 * weight, cells) * t ** (s - 1.0)
    power = np.maximum(edges[:, None] - t, 0.0) ** q / q
    share = np.diff(power, axis=0) / size
    swept = betainc(q, s, 1.0 - C / T)
    matrix = sigma**2 / kappa * (share * weight) @ share.T + s / (kappa * C**s) * np.outer(swept, swept)
    matrix *= size
    lift = C * np.asarray(fretting.initial_displacement(np.sqrt(T / C), k))
    gap = 0.5 * T - (C / (1.0 + k) - lift)
    steady = (
        float(fretting.penetration(k, phi)) - np.asarray(fretting.steady_displacement(np.sqrt(T), k, phi)) - 0.5 * T
    )
    worn, times, volumes = np.zeros(cells), np.linspace(0.0, n[-1], steps + 1), [0.0]
    pressure = np.where(T < 1.0, 1.0, 0.0)
    for length in np.diff(times):
        for _ in range(50):
            on = pressure > 0.0
            on[0] = True
            grown = gap * np.exp(worn + length * pressure)
            lack = (grown - gap + matrix @ pressure - steady)[on]
            factor = cho_factor(matrix[np.ix_(on, on)] + np.diag(length * grown[on]))
            change = np.zeros(cells)
            change[on] = -cho_solve(factor, lack)
            rise = length * change
            pressure = np.maximum(pressure + np.where(rise > 0.5, np.log1p(np.maximum(rise, 0.0)), rise) / length, 0.0)
            beyond = ~on & (gap * np.expm1(worn) + matrix @ pressure < steady)
            pressure[beyond] = 1e-9
            if np.max(np.abs(rise)) < 1e-6 and not np.any(beyond):
                break
        worn = worn + length * pressure
        volumes.append(np.pi * size * np.sum(gap * np.expm1(worn)))
    return np.interp(n, times, volumes) / float(fretting.wear_volume(k, phi))


def volume(effort: Effort, *at: Any) -> np.ndarray:
    """The library's volume by a run of so many cells and steps."""
    k, phi, n = map(jnp.asarray, at)
    return np.asarray(volume_of(compiled_course(effort, k, phi), k, phi, n))


def seconds(call: Any, rounds: int) -> float:
    """The shortest of several calls."""
    found = []
    for _ in range(rounds):
        begin = time.perf_counter()
        jax.block_until_ready(call())
        found.append(time.perf_counter() - begin)
    return min(found)


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Time and error of each choice of digits."""
    report = Report("transient", out, "Wear over cycles")
    final, at = np.asarray(fretting.wear_volume(K, PHI)), unit(K, PHI) * np.append(0.0, np.geomspace(1e-3, 6.0, 63))
    one, n = np.asarray(unit(*POINT) * np.linspace(0.0, 6.0, 64)), int(quick)
    finest = EFFORTS[5] if quick else FINEST  # that the others are held to
    exact = volume(finest, K, PHI, at) / final
    best = volume(finest, *np.array(POINT), one) / np.asarray(fretting.wear_volume(*POINT))
    rows = []
    for digits in sorted(EFFORTS)[: 2 if quick else None]:
        first = seconds(lambda d=digits: transient.wear_volume(*POINT, one, digits=d), 1)
        again = seconds(lambda d=digits: transient.wear_volume(*POINT, one, digits=d), 9 - 6 * n)
        ratio = "-"
        if digits == DIGITS and not quick:  # one is enough: its program takes long to compile
            call = jax.jit(jax.value_and_grad(lambda k, phi: jnp.sum(transient.wear_volume(k, phi, one)), (0, 1)))
            seconds(lambda f=call: f(*POINT), 1)
            ratio = short(seconds(lambda f=call: f(*POINT), 5 - 3 * n) / again)
        error = np.abs(np.asarray(transient.wear_volume(K, PHI, at, digits=digits)) / final - exact)
        worst = np.unravel_index(np.argmax(error), error.shape)[0]
        where = f"k = {K[worst, 0]:g}, phi = {PHI[worst, 0]:g}"
        told = [f"{error.max():.1e}", f"{np.median(error.max(1)):.1e}", where]
        rows.append([str(digits), *told, short(1e3 * again), ratio, short(first)])
    columns = ("digits", "worst error", "median", "where", "ms", "with gradient, times", "first answer, s")
    report.table("The library, 64 answers", columns, rows)
    rows = []
    for cells, steps in ((60, 60), (120, 120), (240, 240))[: 3 - n]:
        begin = time.perf_counter()
        found = plain(*POINT, one, cells, steps)
        took = time.perf_counter() - begin
        rows.append([f"{cells} x {steps}", f"{np.max(np.abs(found - best)):.1e}", short(1e3 * took)])
    report.table(f"NumPy and SciPy at k, phi = {POINT}, first order", ("cells x steps", "error", "ms"), rows)
    report.close()


if __name__ == "__main__":
    harness.run(main)
