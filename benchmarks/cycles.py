"""Errors and times of wear over cycles, on one core, beside NumPy and SciPy: two tables.

    python benchmarks/cycles.py --quick
    python benchmarks/cycles.py rigs

transient: rings of a constant force under Archard's law. Errors are the largest over a whole life, as shares of the
final volume: over a grid of exponents and amplitudes against a run with more cells and steps than the library offers.

rigs: the march of any other test. Errors of volumes are in percent of the last volume of a test; 1 % is promised, see
`docs/explanation/accuracy.md`. They are compared with rings of constant pressure that know the Green's function
alone (`tests/reference/march_oracle.py`), on power laws, layers and tables, and with the runs of a constant force.
`waits.py` measures how long first answers take. Energies and the ends of tests are compared in
`tests/contact/test_contract.py`.
"""

import functools
import importlib
from contextlib import AbstractContextManager
from typing import Any
from unittest import mock

import harness
import numpy as np
from harness import Part, Report, interleave, short

from plgwear_jax import FrettingContact, PowerLawGraded
from plgwear_jax.loads import Block, Displacement
from plgwear_jax.wear.ring_cells import RESOLUTIONS, MarchResolution
from plgwear_jax.wear_laws import PressurePower

reduced: Any = importlib.import_module("reduced")  # which harness makes known, as the next ones
march_oracle: Any = importlib.import_module("march_oracle")
surface_oracle: Any = importlib.import_module("surface_oracle")
ring_contacts: Any = importlib.import_module("ring_contacts")

RADIUS, FORCE = reduced.RADIUS, reduced.FORCE
FRICTION = reduced.LIMIT / FORCE

# --- a constant force -------------------------------------------------------------------------------------------------

POINT = 0.3, 0.5
FINEST = MarchResolution(12, 32, 7.0, (3, 4, 5, 6))
MOST = max(RESOLUTIONS)


def finest(quick: bool) -> AbstractContextManager[Any]:
    """Within this context a run with the most digits has more cells and steps than the library offers."""
    return mock.patch.dict(RESOLUTIONS, {} if quick else {MOST: FINEST})


def errors(report: Report, quick: bool) -> None:
    """By digits, over the domain."""
    exponents, amplitudes = [-0.97, -0.7, -0.3, 0.0, 0.3, 0.7, 0.97], [0.005, 0.02, 0.1, 0.3, 0.6, 0.8, 0.9, 0.98]
    every = 3 if quick else 1
    k, phi = (x.reshape(-1, 1) for x in np.meshgrid(exponents[::every], amplitudes[::every]))
    n = np.asarray(reduced.unit_of(k, phi)) * np.append(0.0, np.geomspace(1e-3, 8.0, 127))

    def share(digits: int) -> np.ndarray:
        return np.asarray(reduced.Reduced(k, phi, digits).volume(n) / reduced.fretting.wear_volume(k, phi))

    with finest(quick):
        exact = share(MOST)
    rows = []
    for digits in sorted(RESOLUTIONS)[: 1 if quick else None]:
        error, effort = np.abs(share(digits) - exact), RESOLUTIONS[digits]
        i, j = np.unravel_index(np.argmax(error), error.shape)
        where = f"k = {k[i, 0]:g}, phi = {phi[i, 0]:g}, share {exact[i, j]:.2f}"
        size = f"{effort.cells}, {effort.outer * sum(effort.refinements)}"
        rows.append([f"{digits}", f"{error.max():.1e}", f"{np.median(error.max(1)):.1e}", where, f"1e-{digits}", size])
    columns = "digits", "worst error", "median", "worst at", "promised", "cells, steps of all marches"
    report.table(f"Errors over the domain, {len(k)} pairs of k and phi, 128 answers each", columns, rows)


def times(report: Report, quick: bool) -> None:
    """Of the library and of NumPy and SciPy, in one run."""
    n, final = float(reduced.unit_of(*POINT)) * np.linspace(0.0, 6.0, 64), reduced.fretting.wear_volume(*POINT)
    with finest(quick):
        exact = np.asarray(reduced.Reduced(*POINT, MOST).volume(n) / final)
    one = reduced.Reduced(*POINT).contact
    coefficient, scale = reduced.coefficient_of(one), float(RADIUS / one.steady(0.0).contact_radius ** 4 / final)

    def share(digits: int) -> Any:
        run = one.over_cycles(FRICTION * FORCE * POINT[1], coefficient, digits=digits)
        return run.volume(reduced.MANY * n) * scale

    def by_rings(rings: int, steps: int) -> Any:
        return march_oracle.worn_shares(*POINT, n[1:], rings, steps)

    calls = {f"plgwear, digits = {d}": lambda d=d: share(d)[1:] for d in ((4,) if quick else sorted(RESOLUTIONS))}
    sizes = (20, 1), (40, 1), (80, 2)
    calls |= {f"rings of constant pressure in NumPy and SciPy, {m}": lambda m=m, s=s: by_rings(m, s) for m, s in sizes}
    slow = list(calls)[-1]
    seconds = interleave(calls, 3 if quick else 11)
    rows = []
    for name, call in calls.items():
        error = np.abs(np.asarray(call()) - exact[1:]).max()
        ratio = np.median(seconds[slow] / seconds[name])
        rows.append([name, short(1e3 * float(np.median(seconds[name]))), f"{error:.1e}", short(float(ratio))])
    report.table(f"A transient, 64 answers, k, phi = {POINT}", ("", "ms", "error", "times faster than the last"), rows)


# --- any test ---------------------------------------------------------------------------------------------------------

COEFFICIENT = 1e-14
SHARES = np.array([0.003, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99])


def dome(k: float) -> FrettingContact:
    """A rigid ball on a power law."""
    return FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), RADIUS, FORCE, FRICTION)


def percent(error: Any) -> str:
    """The largest of some errors in percent."""
    return f"{100.0 * float(np.max(np.abs(error))):.2f}"


def beside_rings(one: FrettingContact, rings: Any, blocks: Any, outer: float, count: int) -> float:
    """The largest error of the volume over the last one, beside twice as many rings."""
    start = one.steady(0.0)
    limit = one.friction * one.normal_force
    a, most, depth = (float(getattr(start, x)) for x in ("contact_radius", "gross_slip_displacement", "penetration"))
    given = [
        Block(
            Displacement(x.displacement * most, limit / (x.rig * most) if x.rig else None)
            if x.displacement
            else x.force * limit,
            x.n * reduced.MANY,
            one.normal_force * x.normal_force,
            one.friction * x.friction,
        )
        for x in blocks
    ]
    # The mean pressure is F_N/(pi a^2), and theta is most/(mu depth).
    run = one.over_cycles(given, np.pi * a * a * depth / (4.0 * most * one.normal_force * reduced.MANY))
    rough, fine, steps = (
        rings(march_oracle.edges_to(outer, n, n)).march(blocks, m)
        for n, m in ((count // 2, count), (count, count), (count // 2, 2 * count))
    )
    # Euler's steps are of first order: to steps of no length.
    volume = fine[1] + 2.0 * (np.interp(rough[0], steps[0], steps[1]) - rough[1])
    found = run.volume(np.minimum(rough[0] * reduced.MANY, float(run.lasting_cycles)))
    return float(np.max(abs(found * (one.radius / a**4) - volume)) / volume[-1])


def on_power_law(rng: np.random.Generator) -> tuple[FrettingContact, Any]:
    """A rigid ball on a random power law, and its rings."""
    k = rng.uniform(-0.7, 0.8)
    return dome(k), functools.partial(march_oracle.on_power_law, k)


def on_layers(rng: np.random.Generator) -> tuple[FrettingContact, Any]:
    """A ball on random layers or a random table, and its rings."""
    kind = ring_contacts.drawn(rng)
    whole = surface_oracle.contact_of(kind.both, ring_contacts.A)
    return kind.contact(whole.force), functools.partial(kind.rings, kind.both, whole)


def against_rings(report: Report, quick: bool) -> None:
    """Volumes of random tests beside rings."""
    rows = []
    # Several tests of each body of layers, whose compliance takes long.
    for name, draw, bodies, tests in (("power laws", on_power_law, 1000, 1), ("layers and tables", on_layers, 20, 10)):
        rng, found = np.random.default_rng(1), []
        for one, rings in (draw(rng) for _ in range(1 if quick else bodies)):
            for _ in range(1 if quick else tests):
                blocks, error = march_oracle.drawn(rng), np.inf
                # finer ones where coarse rings may be what errs
                for outer, count in ((3.3, 60), (3.3, 240), (1.5, 240)):
                    error = min(error, beside_rings(one, rings, blocks, outer, count))
                    if error < 5e-3:
                        break
                found.append((error, f"{one}, {blocks}"))
        rows.append(
            [name, f"{len(found)}", *map(percent, np.quantile([error for error, _ in found], (0.5, 0.95, 1.0)))]
        )
        report.print(f"The worst on {name}: {max(found)[1]}")
    report.table(
        "Volumes of random tests beside rings and the Green's function, % of the last one",
        ("on", "tests", "half", "95 of 100", "worst"),
        rows,
    )


def of_one_force(report: Report, quick: bool) -> None:
    """Runs by the march of any test beside rings."""
    contacts = {f"k = {k:g}": dome(k) for k in (0.0, -0.8, -0.6, -0.3, 0.3, 0.6, 0.8)}
    contacts["layers under steel"] = ring_contacts.KINDS["layers under steel"].contact(0.1)
    rows = []
    for name, one in list(contacts.items())[: 1 if quick else None]:
        for phi in (0.02, 0.3, 0.5, 0.8, 0.95):
            force = phi * one.friction * one.normal_force
            # Archard's law, and it in a form that only the march of any test takes
            exact, run = (one.over_cycles(force, law) for law in (COEFFICIENT, PressurePower(COEFFICIENT, 1.0)))
            cycles, steady = np.asarray(exact.cycles_to(SHARES)), one.steady(force)
            volume, radius, stick = (
                np.asarray(getattr(run, what)(cycles)) - np.asarray(getattr(exact, what)(cycles))
                for what in ("volume", "contact_radius", "stick_radius")
            )
            shares = volume / steady.wear_volume, radius / one.steady(0.0).contact_radius, stick / steady.stick_radius
            rows.append([name, f"{phi:g}", *map(percent, shares)])
    report.table(
        "A constant force beside closed forms, and for layers beside the other march",
        ("contact", "phi", "volume, %", "contact radius, %", "stick radius, %"),
        rows,
    )


PARTS = {
    "transient": Part("Wear over cycles", [errors, times]),
    "rigs": Part(
        "Runs of any test: displacement control, gross slip, blocks and wear laws", [against_rings, of_one_force]
    ),
}

if __name__ == "__main__":
    harness.run(PARTS)
