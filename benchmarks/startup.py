"""What each part of `plgwear_jax._startup` buys: the first answers without it, in units of what JAX takes to start.

    python benchmarks/startup.py
    python benchmarks/startup.py --quick

The variable PLGWEAR_STARTUP switches the parts off, each alone and all together. A number is how many J more the
answer takes then; J is the time of a fresh process that starts JAX and compiles the least there is to compile. The time
of the processor is that of all threads, and what else the machine does hardly changes it; the time on the wall shows
what threads gain. Processes and variants take turns, round by round, and the median over the rounds is told.
"""

import os

os.environ["PLGWEAR_CORES"] = "all"  # before harness, which pins the process otherwise: users have all cores

import sys
import tempfile
from pathlib import Path
from typing import Annotated, NamedTuple

import harness
import numpy as np
import typer
from first_answer import IMPORTS, START, Question, Workplace, command, scene

PARTS = ("kept", "steps", "derivatives", "levels")
VARIANTS = {"all": None, **{f"no {part}": ",".join(x for x in PARTS if x != part) for part in PARTS}, "none": ""}

LAYERS = """
[material]
thickness = [2e-6]
modulus = [400e9, 110e9]
nu = 0.3

[contact]
kind = "fretting"
radius = 0.005
normal_force = 10.0
friction = 0.4

[load]
tangential_force = 0.32

[wear]
coefficient = 1e-14
"""
CLOSED = LAYERS.replace("thickness = [2e-6]\nmodulus = [400e9, 110e9]", "E0 = 110e9\nz0 = 1e-4\nk = 0.2")

VOLUME = "jax.block_until_ready(jax.value_and_grad(fretting.wear_volume, (0, 1))(0.3, 0.4))"
PROFILE = "jax.block_until_ready(jax.value_and_grad(fretting.wear_depth, (0, 1, 2))(0.97, 0.3, 0.4))"
NUMERIC = """
from plgwear_jax.surfaces import Layered
import numpy as np
layers = Layered(np.array([2e-6]), np.array([400e9, 110e9]), 0.3)
contact = FrettingContact(layers, radius=5e-3, normal_force=10.0, friction=0.4)
jax.block_until_ready(jax.value_and_grad(contact.wear_volume)(0.32))
"""
DESIGN = """
material = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
contact = FrettingContact(material, radius=5e-3, normal_force=10.0, friction=0.4)
optimise.design(contact, 0.32, {"k": (-0.9, 0.9)}, hold="contact_radius")
"""


def twice(*words: str, say: str) -> list[Question]:
    return [command(0, *words, say=say), command(0, *words, say=f"{say}, again", again=True)]


def python(name: str, lines: str) -> Question:
    return Question(name, ("-c", IMPORTS + lines))


QUESTIONS = (
    *twice("solve", scene("electrical_contact"), say="solve closed"),
    *twice("solve", "layers.toml", say="solve layers"),
    *twice("wear", "closed.toml", say="wear closed"),
    *twice("wear", "layers.toml", say="wear layers"),
    *twice("design", scene("electrical_contact"), say="design closed"),
    *twice("design", scene("blade_root"), say="design with limits"),
    *twice("design", scene("hip_taper_pair"), say="design of a pair"),
    python("value", "jax.block_until_ready(fretting.wear_volume(0.3, 0.4))"),
    python("value_and_grad", VOLUME),
    python("value_and_grad of a profile", PROFILE),
    python("value_and_grad, layers", NUMERIC),
    python("optimise.design", DESIGN),
)
LONG = "layers", "pair", "limits"  # in the names of questions that are left out of a quick run


class Took(NamedTuple):
    """Seconds."""

    processor: float
    wall: float


Taken = dict[tuple[str, str], Took]  # by question and variant


def took(place: Workplace, question: Question) -> Took:
    """What a process takes, with its children."""
    before = os.times()
    wall, _ = place.run(question)
    after = os.times()
    return Took(sum(after[2:4]) - sum(before[2:4]), wall)


def measured(questions: list[Question], variants: list[str], rounds: int) -> tuple[Took, Taken]:
    """J, and what each question takes in each variant."""
    taken: dict[tuple[str, str], list[Took]] = {(q.name, variant): [] for q in questions for variant in variants}
    starts: list[Took] = []
    with tempfile.TemporaryDirectory(prefix="startup-") as folder:
        places = {name: workplace(Path(folder) / name, VARIANTS[name]) for name in variants}
        plain = workplace(Path(folder) / "J", None)
        for number in range(rounds):
            for question in questions:
                starts.append(took(plain, Question("J", ("-c", START))))
                for name in variants:
                    found = took(places[name], question)
                    taken[question.name, name].append(found)
                    told = f"{found.processor:.2f} s of the processor, {found.wall:.2f} s on the wall"
                    print(f"{number + 1}/{rounds} {question.name}, {name}: {told}", file=sys.stderr, flush=True)
    return _median(starts), {key: _median(found) for key, found in taken.items()}


def workplace(folder: Path, parts: str | None) -> Workplace:
    """A folder of a variant, with the scenes."""
    folder.mkdir()
    for name, text in (("layers", LAYERS), ("closed", CLOSED)):
        (folder / f"{name}.toml").write_text(text, "utf-8")
    place = Workplace(folder, {} if parts is None else {"PLGWEAR_STARTUP": parts})
    place.run(Question("the list of fonts", ("-c", "import matplotlib.font_manager")))
    return place


def _median(found: list[Took]) -> Took:
    return Took(*(float(x) for x in np.median(np.array(found), axis=0)))


def main(
    quick: Annotated[bool, typer.Option("--quick", help="One round, fewer questions.")] = False,
    rounds: Annotated[int, typer.Option(help="How often each process runs.")] = 3,
    only: Annotated[str, typer.Option(help="Variants, with commas between them.")] = ",".join(VARIANTS),
    about: Annotated[str, typer.Option(help="Only questions with one of these words in their names.")] = "",
    out: harness.Out = harness.DEFAULT_OUT,
) -> None:
    """What each part of the start buys."""
    rounds = 1 if quick else rounds
    told = f"What each part of the start buys, all cores, median of {rounds} round{'s'[: rounds > 1]}"
    report = harness.Report("startup", out, told, quick)
    wanted = [q for q in QUESTIONS if not (quick and any(word in q.name for word in LONG))]
    wanted = [q for q in wanted if not about or any(word in q.name for word in about.split(","))]
    variants = only.split(",")
    start, taken = measured(wanted, variants, rounds)
    report.print(f"J = {start.processor:.2f} s of the processor, {start.wall:.2f} s on the wall")
    for unit in Took._fields:
        j = getattr(start, unit)

        def row(question: Question, unit: str = unit, j: float = j) -> tuple[str, ...]:
            first, *rest = (getattr(taken[question.name, name], unit) / j for name in variants)
            return question.name, f"{first:.2f}", *(f"{x - first:+.2f}" for x in rest)

        heads = ("", f"{variants[0]}, J", *variants[1:])
        report.table(f"Time of the {unit}" if unit == "processor" else "Time on the wall", heads, map(row, wanted))
    report.print("again: with what the line before has left in its cache folder; all others find it empty.")
    report.close()


if __name__ == "__main__":
    harness.run(main)
