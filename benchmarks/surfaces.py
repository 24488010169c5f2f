"""Time and error of numeric contacts by their digits: elastic indenters and any E(z), on one core.

Errors are the largest relative ones of contact radius, stick radius, outer radius, penetration and worn volume over
amplitudes from 0.01 to 0.98 of the limit, and over cycles of the worn volume over the final one. The first two contacts
have closed forms; the others are held to more digits than the library offers. Gradients are those of log(V) at random
points, by k and by the logarithms of the moduli and of the normal force; they are held to differences of fifth order.
The free design is that of design/coatings/free_gradient.toml, in a fresh process, with imports and compilation.
"""

import dataclasses
import importlib
import itertools
import os
import subprocess
import sys
import time
from typing import Any

import harness
import jax
import jax.numpy as jnp
import numpy as np
from harness import Report, short

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded
from plgwear_jax.surfaces.effort import EFFORTS, Effort
from plgwear_jax.transient import grid

rigid_shapes: Any = importlib.import_module("rigid_shapes")  # which harness makes known

PHI = np.array([0.01, 0.1, 0.5, 0.9, 0.98])
FORCE, FRICTION = 10.0, 0.4
STEEL = Elastic(210e9, 0.3)
FINEST = Effort(5, 64, 0.15, 1e-5, 3e4, 64)


def contact(coating: Any, indenter: Elastic | None) -> FrettingContact:
    """A ball of 5 mm under 10 N."""
    return FrettingContact(coating, 5e-3, FORCE, FRICTION, indenter)


LAYERS = Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3)
TABLE = DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], [90e9, 150e9, 120e9, 210e9], 0.3)
CLOSED = {
    "k from -0.6 to 0.8, E = 1e20 Pa": (
        contact(PowerLawGraded(110e9, 1e-4, np.array([[-0.6], [-0.3], [0.02], [0.4], [0.8]]), 0.3), Elastic(1e20, 0.3)),
        contact(PowerLawGraded(110e9, 1e-4, np.array([[-0.6], [-0.3], [0.02], [0.4], [0.8]]), 0.3), None),
    ),
    "one modulus at all depths, rigid": (
        contact(DepthGraded([1e-5, 2e-5, 5e-5, 1e-4], np.full(4, 110e9), 0.3), None),
        contact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), None),
    ),
}
OPEN = {
    "k from -0.8 to 0.8, steel": contact(
        PowerLawGraded(110e9, 1e-4, np.array([[-0.8], [-0.4], [0.1], [0.4], [0.8]]), 0.3), STEEL
    ),
    "three layers, steel": contact(LAYERS, STEEL),
    "a table, steel": contact(TABLE, STEEL),
}


CASES = {
    "power law, steel": contact(PowerLawGraded(110e9, 1e-4, 0.2, 0.3), STEEL),
    "a table, steel": contact(TABLE, STEEL),
}
COEFFICIENT = 1e-14
SHARES = np.array([0.001, 0.01, 0.1, 0.3, 0.5, 0.8, 0.95, 0.999])
LIFE_PHI = np.array([0.02, 0.3, 0.9])[:, None]
DIGITS = (2, 3, 4)  # over cycles


def closed(quick: bool) -> dict[str, tuple[FrettingContact, FrettingContact]]:
    """Numeric contacts with the closed forms that they should agree with."""
    if not quick:
        return CLOSED
    coating = PowerLawGraded(110e9, 1e-4, 0.2, 0.3)
    return {"k = 0.2, E = 1e20 Pa": (contact(coating, Elastic(1e20, 0.3)), contact(coating, None))}


def with_axis(one: FrettingContact) -> FrettingContact:
    """The contact with another axis behind those of k, for the cycles."""
    k = getattr(one.material, "k", 0.0)
    if not np.ndim(k):
        return one
    return dataclasses.replace(one, material=dataclasses.replace(one.material, k=np.asarray(k)[..., None]))


def shares(one: FrettingContact, cycles: np.ndarray, digits: int, phi: Any = LIFE_PHI) -> np.ndarray:
    """The worn shares of the final volume after so many cycles, those of each force along a last axis."""
    one, force = with_axis(one), FRICTION * FORCE * phi
    worn = one.over_cycles(force, COEFFICIENT, digits=digits).volume(cycles)
    return np.asarray(worn / one.steady(force).wear_volume)


def lives(one: FrettingContact) -> np.ndarray:
    """About the cycles to the shares."""
    return np.asarray(with_axis(one).over_cycles(FRICTION * FORCE * LIFE_PHI, COEFFICIENT, digits=2).cycles_to(SHARES))


def over_cycles(report: Report, quick: bool) -> None:
    """Errors and times of the volume over cycles."""
    if quick:  # one force: what it asks is compiled least
        cycles, rows = np.geomspace(1e4, 1e7, 8), []
        for name, (one, known) in closed(quick).items():
            error = np.abs(shares(one, cycles, 2, 0.3) - shares(known, cycles, 4, 0.3)).max()
            rows.append([name, "2", f"{error:.0e}"])
        report.table("Largest errors of V(N) over the final one", ("contact", "digits", "error"), rows)
        return
    given = {name: (one, lives(one)) for name, (one, _) in CLOSED.items()}
    exact = {name: shares(known, given[name][1], 5) for name, (_, known) in CLOSED.items()}
    given |= {name: (one, lives(one)) for name, one in OPEN.items()}
    efforts = EFFORTS[4], grid.EFFORTS[4]
    EFFORTS[4], grid.EFFORTS[4] = FINEST._replace(digits=4, modes=56), grid.MarchEffort(12, 32, 7.0, (2, 3, 4))
    exact |= {name: shares(one, given[name][1], 4) for name, one in OPEN.items()}
    EFFORTS[4], grid.EFFORTS[4] = efforts
    rows = []
    for name, (one, cycles) in given.items():
        for digits in DIGITS:
            # Where the finest march fails, that errors are measured against, nothing is compared.
            known = np.isfinite(exact[name])
            told = f"{known.sum()} of {known.size}"
            error = np.max(abs(shares(one, cycles, digits) - exact[name])[known])
            rows.append([name, str(digits), f"{error:.0e}", told])
    report.table("Largest errors of V(N) over the final one", ("contact", "digits", "error", "points"), rows)
    rows = []
    for name, one in CASES.items():
        for digits in DIGITS:
            force = iter(np.linspace(1.0, 2.0, 100))

            def call(one: FrettingContact = one, digits: int = digits, force: Any = force) -> Any:
                return one.over_cycles(next(force), COEFFICIENT, digits=digits).volume(1e5)

            first, again = seconds(call, 10)
            rows.append([name, str(digits), short(first), short(1e3 * again)])
    report.table("Processor time of a volume over cycles", ("contact", "digits", "first answer, s", "ms"), rows)


def steady(one: FrettingContact, digits: int | None = None, quick: bool = False) -> list[np.ndarray]:
    """What errors are told of, or the last of it."""
    force = FRICTION * FORCE * PHI
    names = "stick_radius", "worn_radius", "penetration", "wear_volume"
    found = [] if quick else [one.steady(0.0, digits=digits).contact_radius]
    found += [getattr(one, name)(force, digits=digits) for name in (names[-1:] if quick else names)]
    return [np.asarray(x) for x in found]


def worst(found: list[np.ndarray], exact: list[np.ndarray]) -> str:
    """The largest relative error of each."""
    return ", ".join(f"{np.max(np.abs(x / y - 1.0)):.0e}" for x, y in zip(found, exact, strict=True))


def seconds(call: Any, rounds: int) -> tuple[float, float]:
    """(The processor's time of the first call, the least of several more)."""
    found = []
    for _ in range(rounds + 1):
        begin = time.process_time()
        jax.block_until_ready(call())
        found.append(time.process_time() - begin)
    return found[0], min(found[1:])


def scaled(times: tuple[float, float]) -> tuple[float, float]:
    """The first one in s, the other in ms."""
    return times[0], 1e3 * times[1]


def errors(report: Report, quick: bool) -> None:
    """Errors of each choice of digits."""
    choices = sorted(EFFORTS)[: 1 if quick else None]
    rows = []
    finer = EFFORTS[5]
    exact = {name: steady(known, quick=quick) for name, (_, known) in closed(quick).items()}
    if not quick:
        EFFORTS[5] = FINEST
        exact |= {name: steady(one, 5) for name, one in OPEN.items()}
        EFFORTS[5] = finer
    contacts = {name: numeric for name, (numeric, _) in closed(quick).items()} | ({} if quick else OPEN)
    for name, one in contacts.items():
        rows += [[name, str(digits), worst(steady(one, digits, quick), exact[name])] for digits in choices]
    what = "V" if quick else "a_0, c, a_inf, d_inf, V"
    report.table(f"Largest errors of {what}", ("contact", "digits", "errors"), rows)


def times(report: Report, quick: bool) -> None:
    """Times of each choice of digits, with its derivatives at the default one."""
    choices = sorted(EFFORTS)[: 1 if quick else None]
    rows = []
    for name, one in list(CASES.items())[-1 if quick else 0 :]:
        for digits in choices:
            force = iter(np.linspace(1.0, 2.0, 100))
            first, again = seconds(
                lambda o=one, d=digits, f=force: o.steady(next(f), digits=d).wear_volume, 3 if quick else 20
            )
            told = [name, str(digits), short(first), short(1e3 * again), "-", "-", "-", "-"]
            if digits == 4:
                slope = jax.grad(lambda one, force: one.steady(force).wear_volume)
                told[4:6] = map(short, scaled(seconds(lambda o=one, s=slope, f=force: s(o, next(f)), 3)))
            if digits == 4:  # one is enough: its program takes long to compile
                slope = jax.jit(jax.value_and_grad(lambda one, force: one.steady(force).wear_volume))
                told[6:] = map(short, scaled(seconds(lambda o=one, s=slope, f=force: s(o, next(f)), 10)))
            rows.append(told)
    columns = "contact", "digits", "first answer, s", "ms", "first gradient, s", "ms", "under jit, s", "ms"
    report.table("Processor time of a worn volume", columns, rows)


def rigid(report: Report, quick: bool) -> None:
    """Errors of rigid indenters of all shapes on power laws."""
    rows = []
    for name, (shape, *_) in rigid_shapes.SHAPES.items():
        # With a lower k and phi = 0.99 a truncated sphere sticks up to its flat face, to all digits of a radius.
        lowest = -0.7 if name == "truncated sphere" else -0.9
        for k in (0.3,) if quick else (lowest, 0.0, 0.9):
            one, found = rigid_shapes.contact_with(shape, k), []
            for phi in (0.4,) if quick else (0.01, 0.5, 0.99):
                known = rigid_shapes.exact(name, k, phi)
                found.append(
                    np.abs(rigid_shapes.steady(one, phi * rigid_shapes.FRICTION * rigid_shapes.FORCE) / known - 1)
                )
            rows.append([name, f"{k:g}", ", ".join(f"{x:.0e}" for x in np.max(found, 0))])
    columns = "rigid indenter", "k", "a_0, c, a_inf, d_inf, V"
    report.table("Largest errors on a power law, phi from 0.01 to 0.99, against integrals in mpmath", columns, rows)


DESIGN = """
import sys, jax
jax.config.update("jax_enable_x64", True)
from plgwear_jax import optimise, scene
found = scene.load(sys.argv[1]).free_design()
told = f"{found.saving:.1%} less wear, {found.freedom:.1%} less than the best power law"
print(f"{told}; {found.evaluations} evaluations, {found.minima[0].starts} of {found.starts} starts ended here")
"""
START = "import jax, jax.numpy as jnp; jax.jit(lambda x: x+1)(1.0)"


def fresh(*arguments: str) -> tuple[float, float, str]:
    """The processor's time and that on the wall of a fresh process of Python, and what it printed."""
    before, begin = os.times(), time.perf_counter()
    text = subprocess.run([sys.executable, "-c", *arguments], capture_output=True, text=True, check=True).stdout
    wall, after = time.perf_counter() - begin, os.times()
    own = after.children_user + after.children_system - before.children_user - before.children_system
    return own, wall, text.strip()


def design(report: Report) -> None:
    """What a free design takes, in seconds and in J."""
    units = [fresh(START) for _ in range(3)]
    unit = [float(np.median(x)) for x in zip(*((own, wall) for own, wall, _ in units), strict=True)]
    own, wall, told = fresh(DESIGN, str(harness.ROOT / "design" / "coatings" / "free_gradient.toml"))
    rows = [
        ["processor", short(own), short(unit[0]), short(own / unit[0])],
        ["wall, one core", short(wall), short(unit[1]), short(wall / unit[1])],
    ]
    report.table("A free design of 5 depths with 20 starts; the goal is 20 J", ("", "s", "J, s", "in J"), rows)
    report.print(told)


def many(report: Report, quick: bool) -> None:
    """What many contacts in one call take."""
    scales = np.linspace(0.5, 2.0, 1000)
    table: Any = TABLE
    kinds = {
        "power law, steel": contact(PowerLawGraded(110e9 * scales, 1e-4, 0.2, 0.3), STEEL),
        "a table, steel": contact(dataclasses.replace(table, modulus=scales[:, None] * table.modulus), STEEL),
    }
    rows, digits = [], 2 if quick else 4
    for name, one in kinds.items():
        force = iter(np.linspace(1.0, 2.0, 100))
        first, again = seconds(lambda o=one, f=force: o.steady(next(f), digits=digits).wear_volume, 1 if quick else 3)
        rows.append([name, str(digits), short(first), short(1e3 * again / scales.size)])
    columns = "contacts", "digits", "first answer, s", "ms a contact"
    report.table("Processor time of 1,000 worn volumes in one call", columns, rows)


POINTS, STEP = 40, 1e-3
SMOOTH = 1e-6  # by which differences of two steps differ at most, where the volume is smooth


def of_power_law(x: Any) -> FrettingContact:
    """A contact by k and logarithms of E_0, of the indenter's E and of the normal force."""
    coating = PowerLawGraded(110e9 * jnp.exp(x[1]), 1e-4, x[0], 0.3)
    return FrettingContact(coating, 5e-3, FORCE * jnp.exp(x[3]), FRICTION, Elastic(210e9 * jnp.exp(x[2]), 0.3))


def of_table(x: Any) -> FrettingContact:
    """A contact by logarithms of E at each depth, of the indenter's E and of the normal force."""
    coating = DepthGraded(TABLE.depth, 110e9 * jnp.exp(x[:4]), 0.3)
    return FrettingContact(coating, 5e-3, FORCE * jnp.exp(x[5]), FRICTION, Elastic(210e9 * jnp.exp(x[4]), 0.3))


def slopes(report: Report) -> None:
    """The largest differences between gradients and differences."""
    rng, rows = harness.generator(), []
    names = {
        of_power_law: ("k", "E_0", "E_b", "F_N"),
        of_table: (*(f"E at {z:g} m" for z in TABLE.depth), "E_b", "F_N"),
    }
    for make, variables in names.items():

        def volume(x: Any, force: Any, make: Any = make) -> Any:
            return jnp.log(make(x).steady(force).wear_volume)

        slope, number = jax.jit(jax.grad(volume)), len(variables)
        values = jax.jit(lambda x, force, volume=volume: jax.lax.map(lambda x: volume(x, force), x))
        worst = np.zeros(number), np.zeros((number, number)), np.zeros(number)
        smooth = np.zeros(number, int)
        for _ in range(POINTS):
            x = rng.uniform(-0.7, 0.7, number)
            force = FRICTION * FORCE * rng.uniform(0.05, 0.9) * np.exp(x[-1])
            step = STEP * np.eye(number)
            found = [np.asarray(values(np.concatenate([x + n * step, x - n * step]), force)) for n in (1, 2, 4)]
            central = [(at[:number] - at[number:]) / (2.0 * n * STEP) for at, n in zip(found, (1, 2, 4), strict=True)]
            differences, rougher = ((4.0 * one - two) / 3.0 for one, two in itertools.pairwise(central))
            same = np.abs(rougher - differences) < SMOOTH
            smooth += same
            error = np.where(same, np.abs(np.asarray(slope(x, force)) - differences), 0.0)
            worse = error > worst[0]
            for known, new in zip(worst, (error, np.broadcast_to(x, (number, number)), force), strict=True):
                known[worse] = new[worse] if np.ndim(new) else new
        for i, variable in enumerate(variables):
            at = ", ".join(f"{value:.3f}" for value in worst[1][i])
            told = "power law" if make is of_power_law else "a table"
            among = f"{smooth[i]} of {POINTS}"
            rows.append([told, variable, f"{worst[0][i]:.0e}", among, f"{worst[2][i]:.3f}", at])
    columns = "contact", "by", "difference", "points", "F_x, N", "at"
    report.table("Largest differences of slopes of log(V) from differences; the goal is 1e-6", columns, rows)
    report.print("at: k, or logarithms of the moduli over 110 GPa (E_b: 210 GPa), and of the normal force over 10 N.")
    report.print(
        "points: those at which differences of two steps agree. PCHIP has a kink where neighbouring moduli are"
    )
    report.print("equal, and where the load lets the wavenumbers move the volume jumps by less than its error.")


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Errors and times of each choice of digits."""
    report = Report("surfaces", out, "Elastic indenters and any E(z)", quick)
    times(report, quick)  # before all else, as first answers compile
    errors(report, quick)
    rigid(report, quick)
    over_cycles(report, quick)
    many(report, quick)
    if not quick:  # each waits for the compiler for half a minute
        slopes(report)
        design(report)
    report.close()


if __name__ == "__main__":
    harness.run(main)
