"""Errors and times of wear over cycles, on one core, beside NumPy and SciPy.

    python benchmarks/transient.py --quick
    python benchmarks/transient.py          numbers to be quoted

Errors are the largest over a whole life, as shares of the final volume: over a grid of exponents and amplitudes against
a run with more cells and steps than the library offers, and for a few pairs against rings of constant pressure that
know the Green's function alone (`tests/reference/transient_oracle.py`). Times are those of the processor, the least of
several calls; a transient has 64 answers. J is what JAX takes to start and to compile the least there is, in its own
process.
"""

import importlib
import itertools
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import harness
import jax
import jax.numpy as jnp
import numpy as np
from harness import Report, short
from scipy_transient import by_reduction_of_dimensions, same_method

from plgwear_jax import fretting, partial_slip, transient
from plgwear_jax.transient.amount import volume_of
from plgwear_jax.transient.curves import compiled_curves
from plgwear_jax.transient.grid import EFFORTS, MarchEffort

transient_oracle: Any = importlib.import_module("transient_oracle")
transient_energy: Any = importlib.import_module("transient_energy")

POINT = 0.3, 0.5
FINEST = MarchEffort(12, 32, 7.0, (3, 4, 5, 6))
DIGITS = 4  # the library's default
START = "import jax, jax.numpy as jnp; jax.jit(lambda x: x+1)(1.0)"
FIRST = """
import jax
import numpy as np
from plgwear_jax import transient
jax.config.update("jax_enable_x64", True)
jax.block_until_ready(transient.wear_volume(0.3, 0.5, np.linspace(0.0, 20.0, 64)))
"""
NO_FIGURE = (
    "What finite elements take: no time was found in the literature that belongs to one contact and one processor. "
    "Cruzado, Urchegui and Gómez (Wear 289, 2012, 26-38) reduce the cost of theirs by computing 100 of all cycles with "
    "40 increments each, so 4000 nonlinear solutions; all of the library's marches together have 108 steps."
)


def unit(k: Any, phi: Any) -> np.ndarray:
    """The final volume over the first rate: after some five of them it is over."""
    return np.asarray(fretting.wear_volume(k, phi) / (0.25 * np.pi * partial_slip.energy_per_cycle(k, phi)))


def grid(quick: bool) -> tuple[np.ndarray, ...]:
    """(k, phi, n, final volumes), a row a pair."""
    exponents = [-0.97, 0.0, 0.97] if quick else [-0.97, -0.7, -0.3, 0.0, 0.3, 0.7, 0.97]
    amplitudes = [0.005, 0.3, 0.98] if quick else [0.005, 0.02, 0.1, 0.3, 0.6, 0.8, 0.9, 0.98]
    k, phi = (x.reshape(-1, 1) for x in np.meshgrid(exponents, amplitudes))
    n = unit(k, phi) * np.append(0.0, np.geomspace(1e-3, 8.0, 127))
    return k, phi, n, np.asarray(fretting.wear_volume(k, phi))


def share(effort: MarchEffort, k: Any, phi: Any, n: Any) -> np.ndarray:
    """The share worn by a run of so many cells and steps."""
    at = [jnp.asarray(x) for x in (k, phi, n)]
    return np.asarray(volume_of(compiled_curves(effort, *at[:2]), *at)) / np.asarray(fretting.wear_volume(k, phi))


def seconds(call: Callable[[], Any], rounds: int) -> float:
    """Of the processor, the least of several calls."""
    found = []
    for _ in range(rounds):
        begin = time.process_time()
        jax.block_until_ready(call())
        found.append(time.process_time() - begin)
    return min(found)


def errors(report: Report, quick: bool) -> None:
    """By digits, and by the size of a cell."""
    k, phi, n, final = grid(quick)
    exact = share(EFFORTS[DIGITS] if quick else FINEST, k, phi, n)

    def row(name: str, found: np.ndarray, *more: str) -> list[str]:
        error = np.abs(found - exact)
        i, j = np.unravel_index(np.argmax(error), error.shape)
        where = f"k = {k[i, 0]:g}, phi = {phi[i, 0]:g}, share {exact[i, j]:.2f}"
        return [name, f"{error.max():.1e}", f"{np.median(error.max(1)):.1e}", where, *more]

    rows = []
    for digits in sorted(EFFORTS)[: 1 if quick else None]:
        effort = EFFORTS[digits]
        size = f"{effort.cells}, {effort.outer * sum(effort.multiples)}"
        found = np.asarray(transient.wear_volume(k, phi, n, digits=digits)) / final
        rows.append(row(str(digits), found, f"1e-{digits}", size))
    columns = ("digits", "worst error", "median", "worst at", "promised", "cells, steps of all marches")
    report.table(f"Errors over the domain, {len(k)} pairs of k and phi, 128 answers each", columns, rows)
    if quick:
        return
    rows, before = [], None
    kinds = (1,), (2,), (4,), (1, 2), (2, 4), (1, 2, 3), (2, 4, 6)
    for multiples in kinds:
        found = share(EFFORTS[DIGITS]._replace(multiples=multiples), k, phi, n)
        error = np.abs(found - exact).max()
        same = before is not None and len(before[0]) == len(multiples)
        order = f"{np.log(before[1] / error) / np.log(multiples[-1] / before[0][-1]):.1f}" if same and before else "-"
        rows.append([*row(", ".join(map(str, multiples)), found), order])
        before = multiples, error
    columns = ("marches with multiples of 28 cells", "worst error", "median", "worst at", "order")
    report.table("Convergence", columns, rows)


def fields(report: Report, quick: bool) -> None:
    """What is between the ends of the other quantities, over all lives and the whole domain."""
    if quick:  # these are as many programs more
        return
    k, phi = (x.ravel() for x in np.meshgrid([-0.97, -0.5, 0.0, 0.5, 0.97], [0.005, 0.3, 0.8, 0.98]))
    n = unit(k, phi)[:, None] * np.array([0.0, 0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.5, 4.0])
    inner, last = (np.asarray(x) for x in (fretting.stick_radius(k, phi), fretting.worn_radius(k, phi)))
    first = np.asarray(0.25 * np.pi * partial_slip.energy_per_cycle(k, phi))
    final = np.asarray(fretting.wear_volume(k, phi))
    at = k[:, None], phi[:, None], n

    def told(digits: int) -> tuple[np.ndarray, ...]:
        rate, radius, volume = (
            np.asarray(f(*at, digits=digits))
            for f in (transient.wear_rate, transient.contact_radius, transient.wear_volume)
        )
        edges = np.array(
            [[transient_oracle.rings_between(c, a) for a in row] for c, row in zip(inner, radius, strict=True)]
        )
        r = np.sqrt(0.5 * (edges[..., 1:] + edges[..., :-1]))
        more = k[:, None, None], phi[:, None, None], n[..., None]
        p, h = (np.asarray(f(r, *more, digits=digits)) for f in (transient.pressure, transient.wear_depth))
        sums = [
            [transient_oracle.rates(*one, e, x, y) for e, x, y in zip(*rows, strict=True)]
            for *one, rows in zip(k, phi, zip(edges, p, h, strict=True), strict=True)
        ]
        missing = np.abs(np.pi * np.sum(h * np.diff(edges), -1) - volume) / final[:, None]
        lacks = np.max(np.abs(np.array(sums) - rate[..., None]), -1) / first[:, None]
        return rate / first[:, None], (radius - 1.0) / (last - 1.0)[:, None], missing, lacks

    best, rows = told(max(EFFORTS)), []
    for digits in sorted(EFFORTS):
        rate, radius, missing, lacks = told(digits)
        errors = [np.abs(rate - best[0]), np.abs(radius - best[1])] if digits < max(EFFORTS) else [None, None]
        row = [str(digits)]
        for error in (*errors, missing, lacks):
            if error is None:
                row.append("-")
                continue
            i, j = np.unravel_index(np.argmax(error), error.shape)
            row.append(f"{error.max():.1e}, {np.median(error.max(1)):.0e}: {k[i]:g}, {phi[i]:g}, {n[i, j] / n[i, 7]:g}")
        rows.append(row)
    columns = "digits", "wear rate", "contact radius", "volume by depth", "rate by p (g + h) and by energy"
    title = "Fields: worst error, median: at k, phi and n in its unit; over first rate, growth and final volume"
    report.table(title, columns, rows)


def energies(report: Report, quick: bool) -> None:
    """The rate by the energy that friction takes, from the pressures of the cells themselves."""
    pairs = [(k, phi) for k in (-0.97, 0.0, 0.97) for phi in (0.005, 0.3, 0.8, 0.98)]
    rows = []
    for digits in (DIGITS,) if quick else sorted(EFFORTS):
        found = []
        for k, phi in pairs[5:6] if quick else pairs:
            rates = transient_energy.rates_of_marches(k, phi, digits)
            first = float(0.25 * np.pi * partial_slip.energy_per_cycle(k, phi))
            by_volume = np.asarray(transient.wear_rate(k, phi, rates.n, digits=digits))
            lacks = rates.by_energy - rates.by_pressure, rates.extrapolated - by_volume
            found.append((*(float(np.abs(lack).max()) / first for lack in lacks), k, phi))
        told = [max(found, key=lambda row, i=i: row[i]) for i in (0, 1)]
        medians = np.median(np.array(found), axis=0)
        cells = (f"{row[i]:.1e}, {medians[i]:.0e}: {row[2]:g}, {row[3]:g}" for i, row in enumerate(told))
        rows.append([str(digits), *cells])
    columns = "digits", "energy and p (g + h) of the cells", "energy in the limit, and wear rate"
    report.table("Rates by energy: worst difference, median: at k, phi; over the first rate", columns, rows)


def held_displacement(report: Report, quick: bool) -> None:
    """A held displacement and blocks, beside the rings of the tests, as shares of the final volume."""
    rows, count, pairs = [], 80 if quick else 160, ((0.0, 0.5), (0.5, 0.8))[: 1 if quick else None]
    for k, phi in pairs:
        end, final = float(unit(k, phi)), float(fretting.wear_volume(k, phi))
        times = 8.0 * end * np.expm1(4.0 * np.linspace(0.0, 1.0, 161)) / np.expm1(4.0)
        n = end * np.array([0.1, 0.3, 0.6, 1.0, 3.0])
        marches = [transient_oracle.march_at_held_displacement(k, phi, times, x) for x in (count // 2, count)[quick:]]
        shares = [np.interp(n, times, march[0]) / final for march in marches]

        def mine(k: float = k, phi: float = phi, n: np.ndarray = n) -> Any:
            return transient.wear_volume(k, phi, n, control="displacement")

        error = np.abs(np.asarray(mine()) / final - shares[-1]).max()
        change = "-" if quick else f"{np.abs(shares[1] - shares[0]).max():.1e}"
        took = seconds(mine, 3 if quick else 20)
        rows.append([f"displacement, k, phi = {k:g}, {phi:g}", short(1e3 * took), f"{error:.1e}", change])
    whole = np.array([0.1, 0.2, 0.7])
    for k, phi in () if quick else pairs:
        n = float(unit(k, phi)) * whole

        def by_blocks(k: float = k, phi: float = phi, n: np.ndarray = n) -> Any:
            return transient.blocks(k, np.full(3, phi), n).volume

        # Three blocks of one amplitude are one life, which the other march knows to five digits.
        exact = transient.wear_volume(k, phi, np.cumsum(n), digits=max(EFFORTS))
        error = np.abs(np.asarray(by_blocks()) - np.asarray(exact)).max() / float(fretting.wear_volume(k, phi))
        took = seconds(by_blocks, 20)
        rows.append([f"three blocks of one amplitude, k, phi = {k:g}, {phi:g}", short(1e3 * took), f"{error:.1e}", "-"])
    columns = "", "ms", "error", "change of the rings when doubled"
    report.table(f"A moving stick edge: {count} rings, or the march at a held force; 1e-2 is promised", columns, rows)


def against_rings(report: Report, quick: bool) -> None:
    """A check that shares nothing with the method."""
    rows, numbers, steps = [], (40, 80) if quick else (60, 120, 240), 4 if quick else 8
    for k, phi in ((-0.5, 0.8),) if quick else ((-0.5, 0.2), (-0.5, 0.8), (0.0, 0.5), (0.5, 0.2), (0.5, 0.8)):
        n = float(unit(k, phi)) * np.array([0.25, 0.75, 1.5])
        rough = [transient_oracle.worn_shares(k, phi, n, rings, steps) for rings in numbers]
        mine = np.asarray(transient.wear_volume(k, phi, n) / fretting.wear_volume(k, phi))
        limits = [(4.0 * fine - coarse) / 3.0 for coarse, fine in itertools.pairwise(rough)]
        change = "-" if quick else f"{np.abs(limits[1] - limits[0]).max():.1e}"
        rows.append([f"{k:g}, {phi:g}", f"{np.abs(mine - limits[-1]).max():.1e}", change])
    columns = ("k, phi", "difference", "change of the rings when doubled")
    report.table(f"Against {numbers[-1]} rings and the Green's function alone, extrapolated", columns, rows)


def times(report: Report, quick: bool) -> None:
    """Of the library and of NumPy and SciPy."""
    n, rounds = float(unit(*POINT)) * np.linspace(0.0, 6.0, 64), 5 if quick else 40
    exact = same_method(*POINT, n) if quick else share(EFFORTS[max(EFFORTS)], POINT[0], POINT[1], n)
    rows = []
    for digits in (DIGITS,) if quick else sorted(EFFORTS):
        seconds(lambda d=digits: transient.wear_volume(*POINT, n, digits=d), 1)
        took = seconds(lambda d=digits: transient.wear_volume(*POINT, n, digits=d), rounds)
        error = np.abs(
            np.asarray(transient.wear_volume(*POINT, n, digits=digits) / fretting.wear_volume(*POINT)) - exact
        )
        rows.append([f"plgwear, digits = {digits}", short(1e3 * took), f"{error.max():.1e}"])
    took = seconds(lambda: same_method(*POINT, n), 3 if quick else 10)
    rows.append(
        ["NumPy and SciPy, as digits = 4", short(1e3 * took), f"{np.abs(same_method(*POINT, n) - exact).max():.1e}"]
    )
    error = "from NumPy and SciPy by" if quick else "error"
    report.table(f"A transient, 64 answers, k, phi = {POINT}", ("", "ms", error), rows)
    if quick:
        return

    n = float(unit(0.0, POINT[1])) * np.linspace(0.0, 1.0, 64)
    exact = share(EFFORTS[DIGITS], np.array(0.0), np.array(POINT[1]), n)
    rows = []
    for points, steps in ((100, 200), (200, 800), (400, 3200)):
        took = seconds(lambda m=points, s=steps: by_reduction_of_dimensions(POINT[1], n, m, s), 1)
        found, pressure = by_reduction_of_dimensions(POINT[1], n, points, steps)
        beside = pressure[: points // 20]
        jump = f"{np.max(np.abs(np.diff(beside))) / np.mean(beside):.0%}" if beside.any() else "none is left"
        rows.append([f"{points}, {steps}", short(1e3 * took), f"{np.abs(found - exact).max():.1e}", jump])
    columns = ("radii, steps", "ms", "error", "jump of the pressure beside c between two radii")
    report.table("The usual march, profile to line to pressure and back, k = 0, phi = 0.5, to n = unit", columns, rows)
    report.print("Li, Forsbach and Benad (FU Mech Eng 17, 2019, 87-93) describe that instability at the stick edge.")
    report.print(NO_FIGURE)


def goals(report: Report, quick: bool) -> None:
    """Beside what was asked for."""
    n = float(unit(*POINT)) * np.linspace(0.0, 6.0, 64)
    started, answered = (least(code, 1 if quick else 5) for code in (START, FIRST))
    value = seconds(lambda: transient.wear_volume(*POINT, n), 3) and seconds(
        lambda: transient.wear_volume(*POINT, n), 5 if quick else 40
    )
    rows = [
        ("64 answers, ms", 20.0, 1e3 * value, False),
        ("first answer with all imports, J", 3.0, answered / started, False),
    ]
    if not quick:  # takes long to compile
        k, phi = np.linspace(-0.9, 0.9, 1000), np.resize(np.linspace(0.1, 0.9, 37), 1000)
        seconds(lambda: transient.wear_volume(k, phi, unit(k, phi)), 1)
        pairs = seconds(lambda: transient.wear_volume(k, phi, unit(k, phi)), 1)
        rows.append(("1,000 pairs of k and phi, s", 20.0, pairs, False))
        call = jax.jit(lambda k, phi: jnp.sum(transient.wear_volume(k, phi, n)))
        both = jax.jit(jax.value_and_grad(lambda k, phi: jnp.sum(transient.wear_volume(k, phi, n)), (0, 1)))
        taken = [(seconds(lambda f=f: f(*POINT), 1), seconds(lambda f=f: f(*POINT), 20))[1] for f in (call, both)]
        rows.append(("value and gradient over value", 3.0, taken[1] / taken[0], False))
    harness.goals(report, rows)


def least(code: str, rounds: int) -> float:
    """Seconds of a fresh process, the least of several."""
    found = []
    for _ in range(rounds):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], cwd=harness.ROOT, check=True)
        found.append(time.perf_counter() - begin)
    return min(found)


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Errors and times."""
    report = Report("transient", out, "Wear over cycles", quick)
    for part in (errors, fields, energies, against_rings, held_displacement, times, goals):
        part(report, quick)
    report.close()


if __name__ == "__main__":
    harness.run(main)
