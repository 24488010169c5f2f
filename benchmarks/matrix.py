"""Every question for every contact: what each takes in a process that has all imports, or why there is no answer.

    python benchmarks/matrix.py --quick
    python benchmarks/matrix.py          every pair of a body, an indenter, a shape and a load; searches once a load

Times are seconds of the processor with what is compiled; later rows use programs that earlier ones have compiled. Each
answer is held to something: a gradient to differences, `jit`, `vmap` and float32 to the value, a design to the wear of
the reference, a fit to the coefficient that made the data, a sweep to the volume. A number in brackets is an error that
is larger than allowed. Letters stand for the lines that an error says, below the table.
"""

import dataclasses
import itertools
import string
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import harness
import jax
import jax.numpy as jnp
import numpy as np
from harness import Part, Report, short

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

    contact: FrettingContact
    load: Any
    cycles: float
    vary: dict[str, Any]

    @property
    def life(self) -> dict[str, Any]:
        return {"cycles": self.cycles, "law": COEFFICIENT}

    @property
    def allowed(self) -> float:
        """How far answers may be from each other: a march of any test has two digits, and so have its derivatives."""
        return 1e-3 if isinstance(self.load, Force) else 3e-2

    def volume(self, contact: Any = None, cycles: Any = None) -> Any:
        """What is asked."""
        run = (contact or self.contact).over_cycles(self.load, COEFFICIENT)
        return run.volume(self.cycles if cycles is None else cycles)


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
    vary = {"k": (-0.4, 0.6)} if row.body == "power law" else {"material.modulus[1]": (60e9, 280e9)}
    return Test(contact, load, cycles, vary)


# --- the questions: each tells how far an answer is from what it is held to -------------------------------------------


def apart(one: Any, other: Any) -> float:
    return abs(float(one) / float(other) - 1.0)


def gradient(test: Test) -> float:
    """By the friction and the normal force, against differences."""
    contact = test.contact

    def along(x: Any) -> Any:
        forces = {"normal_force": FORCE * jnp.exp(x), "friction": FRICTION * jnp.exp(x)}
        return test.volume(dataclasses.replace(contact, **forces))

    slopes = jax.grad(test.volume)(contact)
    own = float(slopes.normal_force) * FORCE + float(slopes.friction) * FRICTION
    step = 0.02 if test.allowed > 1e-2 else 1e-3
    by = (float(along(step)) - float(along(-step))) / (2.0 * step)
    return abs(own - by) / max(abs(by), 0.1 * float(test.volume()))


def mapped(test: Test) -> float:
    """Of three contacts under `vmap`."""
    shares = jnp.array([0.9, 1.0, 1.1])
    found = jax.vmap(lambda x: test.volume(dataclasses.replace(test.contact, radius=RADIUS * x)))(shares)
    return apart(found[1], test.volume()) if np.all(np.isfinite(np.asarray(found))) else np.inf


def single(test: Test) -> float:
    """In single precision, against a looser bound."""
    few = test._replace(**jax.tree.map(jnp.float32, {"contact": test.contact, "load": test.load}))
    return apart(few.volume(), test.volume()) * test.allowed / 3e-2


def free_design(test: Test) -> float:
    """With a modulus at three depths."""
    modulus = ModulusProfile(np.array([2e-5, 5e-5, 2e-4]), np.full(3, 60e9), np.full(3, 280e9))
    return -optimise.free_design(test.contact, test.load, modulus, starts=2, **test.life).saving


def front(test: Test) -> float:
    """Three points between wear and the scar: the wear falls where a larger scar is allowed."""
    scar = "transient.contact_radius"
    y = np.asarray(optimise.front(test.contact, test.load, test.vary, scar, points=3, **test.life).y)
    return float(np.max(np.diff(y) / y[:-1]))


def fit(test: Test) -> float:
    """The coefficient that made the data."""
    cycles = test.cycles * np.array([0.3, 0.6, 1.0])
    data = np.asarray(test.volume(cycles=cycles))
    found = fit_wear_coefficient(test.contact, test.load, cycles, data, deviation=0.01 * data)
    return apart(found.wear_coefficient, COEFFICIENT)


def swept(test: Test) -> float:
    """Three numbers of cycles."""
    given = {"cycles": test.cycles * np.array([0.5, 0.8, 1.0]), "wear_coefficient": COEFFICIENT}
    found = sweep(["transient.wear_volume"], contact=test.contact, load=test.load, **given)
    return apart(found["transient_wear_volume"].values.ravel()[-1], test.volume())


ANSWERS: dict[str, Callable[[Test], float]] = {
    "value": lambda test: 0.0 if float(test.volume()) > 0.0 else np.inf,
    "slopes": gradient,
    "jit": lambda test: apart(jax.jit(test.volume)(test.contact), test.volume()),
    "vmap": mapped,
    "float32": single,
    # The best coating wears no more than the reference.
    "design": lambda test: -optimise.design(test.contact, test.load, test.vary, **test.life).saving,
    "free": free_design,
    "front": front,
    "fit": fit,
    "sweep": swept,
}


# --- the table --------------------------------------------------------------------------------------------------------


def rows_of(quick: bool) -> list[Row]:
    """So many rows that each pair of two of the four stands in one of them."""
    every = [Row(*each) for each in itertools.product(BODIES, INDENTERS, SHAPES, LOADS)]
    pairs = {pair for row in every for pair in itertools.combinations(enumerate(row), 2)}
    found: list[Row] = []
    while pairs and not quick:
        best = max(every, key=lambda row: len(pairs & {*itertools.combinations(enumerate(row), 2)}))
        found.append(best)
        pairs -= {*itertools.combinations(enumerate(best), 2)}
    return sorted(found, key=every.index) or every[:1]


def asked(question: str, row: Row, reasons: dict[str, str]) -> str:
    """A cell: seconds, an error that is too large, or a letter."""
    test, begin = test_of(row), time.process_time()
    try:
        with harness.quietly():
            error = ANSWERS[question](test)
    except (TypeError, ValueError, jax.errors.JaxRuntimeError) as wrong:  # the last one where memory is out
        line = str(wrong).splitlines()[0]
        return reasons.setdefault(line, string.ascii_letters[len(reasons)])
    taken = short(time.process_time() - begin)
    return taken if error <= test.allowed else f"{taken} ({error:.0e})"


def matrix(report: Report, quick: bool) -> None:
    """Every question for every contact."""
    reasons: dict[str, str] = {}
    table, searched = [], set()
    for row in rows_of(quick):
        left_out = SEARCHES if quick or row.load in searched else ()
        searched.add(row.load)
        table.append([*row, *("" if name in left_out else asked(name, row, reasons) for name in ANSWERS)])
    report.table("Seconds, the first answer in this process", ("body", "indenter", "shape", "load", *ANSWERS), table)
    for line, letter in reasons.items():
        report.print(f"{letter}: {line}")


if __name__ == "__main__":
    harness.run({"matrix": Part("Every question for every contact: seconds of the processor", matrix)})
