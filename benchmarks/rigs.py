"""Errors and times of runs of any test: displacement control, gross slip, blocks and wear laws, on one core.

    python benchmarks/rigs.py --quick
    python benchmarks/rigs.py          numbers to be quoted

Errors of volumes are in percent of the last volume of a test; 1 % is promised under a constant force, see
`docs/explanation/engines.md`. They are compared with rings of constant pressure that know the Green's function
alone (`tests/reference/march_oracle.py`), with the closed forms and the other march under a constant force, and with
what is known of energies and of the ends of tests. J is the processor's time of a process that imports JAX and
compiles the least there is; a first answer is that of a fresh process with all imports.
"""

import importlib
from typing import Any

import harness
import numpy as np
from harness import Report, short
from surfaces import COEFFICIENT, FORCE, FRICTION, LAYERS, START, STEEL, contact, fresh, seconds

from plgwear_jax import FrettingContact, PowerLawGraded
from plgwear_jax import contact as room
from plgwear_jax.loads import Block, Displacement
from plgwear_jax.wear_laws import PressurePower

march_oracle: Any = importlib.import_module("march_oracle")  # which harness makes known

RADIUS = 5e-3
SAME = PressurePower(COEFFICIENT, 1.0)  # Archard's law, in a form that only the march of any test takes
SHARES = np.array([0.003, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99])
EXPONENTS = -0.6, -0.3, 0.0, 0.3, 0.6
LAYERED = contact(LAYERS, STEEL)


def dome(k: Any) -> FrettingContact:
    """A rigid ball on a power law."""
    return contact(PowerLawGraded(110e9, 1e-4, k, 0.3), None)


def percent(error: Any) -> str:
    """The largest of some errors in percent."""
    return f"{100.0 * float(np.max(np.abs(error))):.2f}"


# --- errors -----------------------------------------------------------------------------------------------------------


def against_rings(report: Report, quick: bool) -> None:
    """Volumes and contact radii beside rings."""
    rows, finest = [], 60 if quick else 200
    sizes = (finest // 2, finest), (finest, finest), (finest // 2, 2 * finest)
    for history, (blocks, outer) in march_oracle.HISTORIES.items():
        if quick and history != "gross slip":
            continue
        for k in (0.0,) if quick else EXPONENTS:
            one = dome(k)
            a_0, onset = float(one.steady(0.0).contact_radius), float(one.steady(0.0).gross_slip_displacement)
            reduced = float(room.reduced_cycles(one, COEFFICIENT))

            def load(given: Any, onset: float = onset) -> Any:
                held = given.displacement is not None
                return Displacement(given.displacement * onset) if held else given.force * FRICTION * FORCE

            given = [Block(load(x), x.n / reduced, FORCE * x.normal_force, FRICTION * x.friction) for x in blocks]
            run = one.over_cycles(given, COEFFICIENT)
            rough, fine, steps = (
                march_oracle.Rings(k, march_oracle.edges_to(outer, n, n)).march(blocks, m) for n, m in sizes
            )
            # Euler's steps are of first order: to steps of no length.
            volume = fine[1] + 2.0 * (np.interp(rough[0], steps[0], steps[1]) - rough[1])
            cycles = np.minimum(rough[0] / reduced, float(run.lasting_cycles))
            error = np.asarray(run.volume(cycles)) / (a_0**4 / RADIUS) - volume
            # Where a block ends a run tells of the next one.
            ends = np.asarray(run.contact_radius((1.0 - 1e-6) * cycles[finest::finest])) / a_0
            rows.append([history, f"{k:g}", percent(error / volume[-1]), percent(ends / widest(fine[3], blocks) - 1.0)])
    columns = "test", "k", "volume, %", "contact radius at ends of blocks, %"
    report.table(f"Against {2 * finest} rings and the Green's function alone", columns, rows)
    if not quick:
        report.print("The rings themselves are 0.5 to 2 % of a radius wide beside the edge of the contact.")


def widest(radius: np.ndarray, blocks: Any) -> np.ndarray:
    """The contact radii of rings at the ends of blocks: the largest since the normal force has fallen last."""
    its, found, most = radius[1:].reshape(len(blocks), -1), [], 0.0
    for number, (row, block) in enumerate(zip(its, blocks, strict=True)):
        falls = number > 0 and block.normal_force < blocks[number - 1].normal_force
        most = max(0.0 if falls else most, float(row.max()))
        found.append(most)
    return np.array(found)


def of_one_force(report: Report, quick: bool) -> None:
    """Runs by the march of any test beside those of the march of one force."""
    columns = "contact", "phi", "volume, %", "last volume, %", "contact radius, %", "stick radius, %"
    contacts = {f"k = {k:g}": dome(k) for k in ((0.0,) if quick else (-0.8, *EXPONENTS, 0.8))}
    contacts |= {} if quick else {"layers under steel": LAYERED}
    rows = []
    for name, one in contacts.items():
        for phi in (0.5,) if quick else (0.02, 0.3, 0.5, 0.8, 0.95):
            force = phi * FRICTION * FORCE
            exact, run = one.over_cycles(force, COEFFICIENT), one.over_cycles(force, SAME)
            cycles, last = np.asarray(exact.cycles_to(SHARES)), float(one.steady(force).wear_volume)
            volume, radius, stick = (
                np.asarray(getattr(run, what)(cycles)) - np.asarray(getattr(exact, what)(cycles))
                for what in ("volume", "contact_radius", "stick_radius")
            )
            row = [volume / last, float(run.volume(run.lasting_cycles)) / last - 1.0]
            row += [radius / float(exact.contact_radius(0.0)), stick / float(exact.steady(0.0).stick_radius)]
            rows.append([name, f"{phi:g}", *map(percent, row)])
    title = "A constant force beside closed forms, and for layers beside the other march"
    report.table(title, columns, rows)


def energies(report: Report, quick: bool) -> None:
    """What friction takes, what presses, and what is worn, by the fields of a run."""
    contacts = {"k = 0": dome(0.0)} if quick else {f"k = {k:g}": dome(k) for k in EXPONENTS}
    contacts |= {} if quick else {"layers under steel": LAYERED}
    rows = []
    for name, one in contacts.items():
        onset = float(one.steady(0.0).gross_slip_displacement)
        for times in (3.0,) if quick else (0.6, 3.0):
            run = one.over_cycles(Displacement(times * onset), COEFFICIENT)
            last = min(float(run.lasting_cycles), 1e6)
            cycles = last * np.append(0.0, np.geomspace(1e-5, 1.0, 400))
            # By Archard's law the energy is the volume over K/mu, in each cycle and in all together.
            energy = np.asarray(run.energy_per_cycle(cycles))
            a_cycle = energy * COEFFICIENT / FRICTION / np.asarray(run.rate(cycles)) - 1.0
            whole = COEFFICIENT / FRICTION * np.trapezoid(energy, cycles) / float(run.volume(last)) - 1.0
            lacks = []
            for n in last * np.array([1e-2, 1e-1, 1.0]):
                edges = np.linspace(0.0, (1.2 * float(run.contact_radius(n))) ** 2, 4001)
                r = np.sqrt(0.5 * (edges[1:] + edges[:-1]))
                sums = [np.pi * edges[1] * np.sum(getattr(run, what)(r, n)) for what in ("pressure", "depth")]
                lacks.append((sums[0] / FORCE - 1.0, sums[1] / float(run.volume(n)) - 1.0))
            told = a_cycle, whole, *np.array(lacks).T
            rows.append([name, f"{times:g}", f"{float(np.max(np.abs(a_cycle))):.0e}", *map(percent, told[1:])])
    columns = "contact", "u over onset", "energy a cycle", "energy of all, %", "pressures, %", "depths, %"
    title = "Energy beside mu V/K, relative; pressures beside F_N and depths beside V, by the fields of a run"
    report.table(title, columns, rows)


def known_ends(report: Report, quick: bool) -> None:
    """Gross slip by its way, and the end of other wear laws."""
    rows = []
    for k in (0.0,) if quick else EXPONENTS:
        one = dome(k)
        onset = float(one.steady(0.0).gross_slip_displacement)
        for times in (3.0,) if quick else (1.5, 3.0, 30.0):
            run = one.over_cycles(Displacement(times * onset), COEFFICIENT)
            last = float(run.lasting_cycles)
            at = last * np.array([0.01, 0.1, 1.0])
            volume, radius, rate = (np.asarray(f(at)) for f in (run.volume, run.contact_radius, run.rate))
            flat = (4.0 * volume * RADIUS / np.pi) ** 0.25
            sticks = "gross slip" if float(run.stick_radius(last)) == 0.0 else "partial slip"
            ways = (f"{x:.3f}" for x in rate / (4.0 * COEFFICIENT * FORCE * times * onset))
            scars = (f"{x:.3f}" for x in radius / flat)
            rows.append(
                [
                    f"{k:g}",
                    f"{times:g}",
                    sticks,
                    *ways,
                    *scars,
                    short(radius[-1] / float(one.steady(0.0).contact_radius)),
                ]
            )
    columns = (
        "k",
        "u over onset",
        "at the end",
        "rate at 1 %",
        "10 %",
        "end",
        "scar at 1 %",
        "10 %",
        "end",
        "a over a_0",
    )
    report.table(
        "Gross slip: the rate over 4 K F_N u, and the scar over (4 V R/pi)^(1/4), at shares of the cycles",
        columns,
        rows,
    )
    if quick:
        return
    rows = []
    for k in EXPONENTS:
        one = dome(k)
        pressure = float(one.steady(0.0).peak_initial_pressure)
        for exponent in (0.8, 1.5):
            law = PressurePower(COEFFICIENT * pressure ** (1.0 - exponent), exponent)
            found = []
            for phi in (0.3, 0.5, 0.8):
                run = one.over_cycles(phi * FRICTION * FORCE, law)
                found.append(
                    float(run.volume(run.lasting_cycles) / one.steady(phi * FRICTION * FORCE).wear_volume) - 1.0
                )
            rows.append([f"{k:g}", f"{exponent:g}", *map(percent, found)])
    report.table("Last volumes beside Eq. (28), in %", ("k", "exponent of p", "phi = 0.3", "0.5", "0.8"), rows)


# --- times ------------------------------------------------------------------------------------------------------------

IMPORTS = """
import jax, jax.numpy as jnp
jax.config.update("jax_enable_x64", True)
from plgwear_jax import *
from plgwear_jax.loads import Displacement
law = PowerLawGraded(110e9, 1e-4, 0.2, 0.3)
layers = Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3)
"""
BODIES = {
    "a power law, rigid ball": ("law, 5e-3, 10.0, 0.4", dome(0.2)),
    "layers under steel": ("layers, 5e-3, 10.0, 0.4, Elastic(210e9, 0.3)", LAYERED),
}
DISPLACEMENT, CYCLES = 3e-6, 1e5  # gross slip
WORN = f"one.over_cycles(Displacement(u), {COEFFICIENT}).volume({CYCLES})"
ASKED = {
    "volume": f"u = {DISPLACEMENT}; {WORN}.block_until_ready()",
    "gradient": f"jax.grad(lambda u: {WORN})({DISPLACEMENT}).block_until_ready()",
    "gradient under jit": f"jax.jit(jax.grad(lambda u: {WORN}))({DISPLACEMENT}).block_until_ready()",
}
TABLE = "Profile([0.0, 5e-5, 1e-4, 2e-4, 4e-4, 1e-3], [0.0, 2.6e-7, 1.1e-6, 4.2e-6, 1.7e-5, 1e-4])"
OWN = """
class Own(Shape):
    slope: float
    def height(self, r, radius):
        return self.slope * r
"""
SHAPES = {
    "cone": ("", "Cone(0.01)"),
    "rounded flat": ("", "RoundedFlat(5e-5)"),
    "a table of heights": ("", TABLE),
    "a class of one's own": (OWN, "Own(0.01)"),
}


def unit(quick: bool) -> float:
    """J in seconds of the processor."""
    return float(np.median([fresh(START)[0] for _ in range(1 if quick else 5)]))


def in_units(code: str, unit: float, rounds: int) -> str:
    """What a fresh process takes in J, the median of some."""
    return short(float(np.median([fresh(code)[0] for _ in range(rounds)])) / unit)


def times(report: Report, quick: bool) -> None:
    """First answers, later ones, and gradients, in gross slip."""
    rows, J, rounds = [], unit(quick), 1 if quick else 3
    for name, (arguments, one) in list(BODIES.items())[: 1 if quick else None]:
        moved = iter(np.linspace(1.0, 1.5, 100))

        def call(one: Any = one, moved: Any = moved) -> Any:
            return one.over_cycles(Displacement(DISPLACEMENT * next(moved)), COEFFICIENT).volume(CYCLES)

        again = 1e3 * seconds(call, 5 if quick else 20)[1]
        asked = list(ASKED.values())[: 1 if quick else None]
        code = (f"{IMPORTS}one = FrettingContact({arguments})\n{line}" for line in asked)
        first = [in_units(x, J, rounds) for x in code]
        rows.append([name, short(again), *first, *["-"] * (3 - len(first))])
    title = f"In gross slip by displacement; J = {short(J)} s of the processor; the goals are 100 ms and 4 J"
    columns = "contact", "volume again, ms", "first volume, J", "first gradient, J", "under jit, J"
    report.table(title, columns, rows)
    if quick:
        return
    rows = []
    for name, (lines, shape) in SHAPES.items():
        row = [name]
        for kind in ("law, 5e-3, 10.0, 0.4, None", "layers, 5e-3, 10.0, 0.4, Elastic(210e9, 0.3)"):
            begin = f"{IMPORTS}{lines}one = FrettingContact({kind}, {shape})\n"
            row += [
                in_units(f"{begin}{line}", J, 1)
                for line in ("one.wear_volume(2.0).block_until_ready()", ASKED["volume"])
            ]
        rows.append(row)
    columns = ("indenter", "power law, steady", "in gross slip", "layers, steel, steady", "in gross slip")
    report.table("First volumes of other shapes in J; the goal is 4 J", columns, rows)


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Errors and times of runs of any test."""
    report = Report("rigs", out, "Runs of any test: displacement control, gross slip, blocks and wear laws", quick)
    times(report, quick)
    against_rings(report, quick)
    of_one_force(report, quick)
    energies(report, quick)
    known_ends(report, quick)
    report.close()


if __name__ == "__main__":
    harness.run(main)
