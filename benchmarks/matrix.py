"""Every question for every contact: what each takes in a process that has all imports, or why there is no answer.

    python benchmarks/matrix.py --quick
    python benchmarks/matrix.py          every pair of a body, an indenter, a shape and a load; searches once a load
    python benchmarks/matrix.py --every  every combination and every question; some hours

Times are seconds of the processor with what is compiled; later rows use programs that earlier ones have compiled. Each
answer is held to something: a gradient to differences, `jit`, `vmap` and float32 to the value, a design to the wear of
the reference, a fit to the coefficient that made the data, a sweep to the volume. A number in brackets is an error that
is larger than allowed. Letters stand for the lines that an error says, below the table.
"""

import dataclasses
import itertools
import string
import time
import warnings
from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

import harness
import jax
import jax.numpy as jnp
import numpy as np
import typer
from harness import Report, short

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded, optimise
from plgwear_jax.fitting import fit_wear_coefficient
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.optimise import ModulusProfile
from plgwear_jax.shapes import Cone, Parabola, Profile, RoundedFlat
from plgwear_jax.sweep import sweep

COEFFICIENT = 1e-14
RADIUS, FORCE, FRICTION = 5e-3, 10.0, 0.4

BODIES: dict[str, Any] = {
    "power law": PowerLawGraded(110e9, 1e-4, 0.2, 0.3),
    "layers": Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3),
    "table": DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], [90e9, 150e9, 120e9, 210e9], 0.3),
}
INDENTERS = {"rigid": None, "steel": Elastic(210e9, 0.3)}
HEIGHTS = np.linspace(0.0, 1e-3, 41)
SHAPES = {
    "parabola": Parabola(),
    "cone": Cone(0.01),
    "rounded flat": RoundedFlat(5e-5),
    "table of heights": Profile(HEIGHTS, HEIGHTS**2 / (2.0 * RADIUS)),
}
LOADS = "force", "displacement", "rig", "blocks", "gross slip"
SEARCHES = "design", "free", "front"
QUESTIONS = "value", "slopes", "jit", "vmap", "float32", "design", "free", "front", "fit", "sweep"


class Row(NamedTuple):
    """A contact and its test."""

    body: str
    indenter: str
    shape: str
    load: str

    @property
    def contact(self) -> FrettingContact:
        """The contact."""
        given = BODIES[self.body], RADIUS, FORCE, FRICTION, INDENTERS[self.indenter], SHAPES[self.shape]
        return FrettingContact(*given)


class Test(NamedTuple):
    """A load, and after how many cycles the wear counts."""

    load: Any
    cycles: float


def test_of(row: Row) -> Test:
    """A test that wears about half of what it can."""
    contact = row.contact
    onset = float(contact.steady(0.0).gross_slip_displacement)
    mean = FORCE / (np.pi * float(contact.steady(0.0).contact_radius) ** 2)
    depth = float(contact.steady(0.3 * FRICTION * FORCE).penetration)
    cycles = 0.3 * depth / (COEFFICIENT * mean * 4.0 * onset)
    stiffness = 0.5 * FRICTION * FORCE / onset
    force = Force(0.3 * FRICTION * FORCE)
    load = {
        "force": force,
        "displacement": Displacement(0.4 * onset),
        "rig": Displacement(0.8 * onset, stiffness),
        "blocks": (Block(force, 0.5 * cycles), Block(Displacement(0.5 * onset), 0.5 * cycles, 0.8 * FORCE)),
        "gross slip": Displacement(3.0 * onset),
    }[row.load]
    return Test(load, cycles)


# --- the questions ----------------------------------------------------------------------------------------------------


def volume(contact: FrettingContact, test: Test) -> Any:
    """What is asked."""
    return contact.over_cycles(test.load, COEFFICIENT).volume(test.cycles)


def allowed(test: Test) -> float:
    """How far answers may be from each other: a march of any test has two digits, and so have its derivatives."""
    return 3e-2 if not isinstance(test.load, Force) else 1e-3


def value(row: Row, test: Test) -> float:
    """The volume; nothing to hold it to but that it is one."""
    return 0.0 if float(volume(row.contact, test)) > 0.0 else np.inf


def gradient(row: Row, test: Test) -> float:
    """By the friction and the radius of the indenter, against differences."""
    contact, names = row.contact, ("normal_force", "friction")

    def along(x: Any) -> Any:
        return volume(
            dataclasses.replace(contact, normal_force=FORCE * jnp.exp(x), friction=FRICTION * jnp.exp(x)), test
        )

    slopes = jax.grad(volume)(contact, test)
    own = sum(float(getattr(slopes, name)) * getattr(contact, name) for name in names)
    step = 0.02 if allowed(test) > 1e-2 else 1e-3
    by = (float(along(step)) - float(along(-step))) / (2.0 * step)
    return abs(own - by) / max(abs(by), 0.1 * float(volume(contact, test)))


def compiled(row: Row, test: Test) -> float:
    """Under `jit`."""
    return _apart(jax.jit(volume)(row.contact, test), volume(row.contact, test))


def mapped(row: Row, test: Test) -> float:
    """Of three contacts under `vmap`."""
    contact, shares = row.contact, jnp.array([0.9, 1.0, 1.1])
    found = jax.vmap(lambda x: volume(dataclasses.replace(contact, radius=RADIUS * x), test))(shares)
    return _apart(found[1], volume(contact, test)) if np.all(np.isfinite(np.asarray(found))) else np.inf


def single(row: Row, test: Test) -> float:
    """In single precision, against a looser bound."""
    few = jax.tree.map(lambda x: jnp.asarray(x, jnp.float32), (row.contact, test))
    return _apart(volume(*few), volume(row.contact, test)) * allowed(test) / 3e-2


def _apart(one: Any, other: Any) -> float:
    return abs(float(one) / float(other) - 1.0)


def _varied(row: Row) -> dict[str, Any]:
    return {"k": (-0.4, 0.6)} if row.body == "power law" else {"material.modulus[1]": (60e9, 280e9)}


def design(row: Row, test: Test) -> float:
    """The best coating wears no more than the reference."""
    life: dict[str, Any] = {"cycles": test.cycles, "wear_coefficient": COEFFICIENT}
    return max(0.0, -optimise.design(row.contact, test.load, _varied(row), **life).saving)


def free_design(row: Row, test: Test) -> float:
    """The same with a modulus at three depths."""
    modulus = ModulusProfile(np.array([2e-5, 5e-5, 2e-4]), np.full(3, 60e9), np.full(3, 280e9))
    life: dict[str, Any] = {"cycles": test.cycles, "wear_coefficient": COEFFICIENT}
    return max(0.0, -optimise.free_design(row.contact, test.load, modulus, starts=2, **life).saving)


def front(row: Row, test: Test) -> float:
    """Three points between wear and the scar: the wear falls where a larger scar is allowed."""
    life: dict[str, Any] = {"cycles": test.cycles, "wear_coefficient": COEFFICIENT}
    found = optimise.front(row.contact, test.load, _varied(row), "transient.contact_radius", points=3, **life)
    return max(0.0, float(np.max(np.diff(np.asarray(found.y)) / np.asarray(found.y)[:-1])))


def fit(row: Row, test: Test) -> float:
    """The coefficient that made the data."""
    cycles = test.cycles * np.array([0.3, 0.6, 1.0])
    data = np.asarray(row.contact.over_cycles(test.load, COEFFICIENT).volume(cycles))
    found = fit_wear_coefficient(row.contact, test.load, cycles, data, deviation=0.01 * data)
    return _apart(found.wear_coefficient, COEFFICIENT)


def swept(row: Row, test: Test) -> float:
    """Three numbers of cycles."""
    given: dict[str, Any] = {"cycles": test.cycles * np.array([0.5, 0.8, 1.0]), "wear_coefficient": COEFFICIENT}
    found = sweep(["transient.wear_volume"], contact=row.contact, load=test.load, **given)
    return _apart(found["transient_wear_volume"].values.ravel()[-1], volume(row.contact, test))


ANSWERS: dict[str, Callable[[Row, Test], float]] = dict(
    zip(
        QUESTIONS,
        (value, gradient, compiled, mapped, single, design, free_design, front, fit, swept),
        strict=True,
    )
)


# --- the table --------------------------------------------------------------------------------------------------------


def rows_of(quick: bool, every_row: bool) -> list[Row]:
    """The rows: all, or so many that each pair of two of the four stands in one of them."""
    every = [Row(*each) for each in itertools.product(BODIES, INDENTERS, SHAPES, LOADS)]
    if every_row:
        return every
    if quick:
        return every[:1]
    pairs = {pair for row in every for pair in itertools.combinations(enumerate(row), 2)}
    found: list[Row] = []
    while pairs:
        best = max(every, key=lambda row: len(pairs & {*itertools.combinations(enumerate(row), 2)}))
        found.append(best)
        pairs -= {*itertools.combinations(enumerate(best), 2)}
    return sorted(found, key=every.index)


def asked(question: str, row: Row, reasons: dict[str, str]) -> str:
    """A cell: seconds, an error that is too large, or a letter."""
    test, begin = test_of(row), time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            error = ANSWERS[question](row, test)
    except (TypeError, ValueError, jax.errors.JaxRuntimeError) as wrong:  # the last one where memory is out
        line = str(wrong).splitlines()[0]
        return reasons.setdefault(line, string.ascii_letters[len(reasons)])
    taken = short(time.process_time() - begin)
    return taken if error <= allowed(test) else f"{taken} ({error:.0e})"


def main(
    quick: harness.Quick = False,
    out: harness.Out = harness.DEFAULT_OUT,
    every: Annotated[bool, typer.Option("--every", help="Every combination.")] = False,
) -> None:
    """Every question for every contact."""
    report = Report("matrix", out, "Every question for every contact: seconds of the processor", quick)
    reasons: dict[str, str] = {}
    table = []
    searched: set[str] = set()
    for row in rows_of(quick, every):
        left_out = () if every else SEARCHES if quick or row.load in searched else ()
        searched.add(row.load)
        cells = ["" if question in left_out else asked(question, row, reasons) for question in QUESTIONS]
        table.append([*row, *cells])
        print(*row, *cells, flush=True)
    report.table("Seconds, the first answer in this process", ("body", "indenter", "shape", "load", *QUESTIONS), table)
    for line, letter in reasons.items():
        report.print(f"{letter}: {line}")
    report.close()


if __name__ == "__main__":
    harness.run(main)
