"""What the first answer to one question takes, in units of what JAX takes to start, and what SciPy takes for it.

    python benchmarks/first_answer.py
    python benchmarks/first_answer.py --quick
    python benchmarks/first_answer.py --full

J is the time of a fresh process that starts JAX and compiles the least there is to compile. All else is in units of J,
which makes numbers of different machines comparable. Each line is a fresh process on all cores, as a user starts it,
with Python's bytecode in place and the list of fonts that matplotlib makes once. Every process has an empty cache
folder of its own, but for the lines that say "again": these have the one that the line before has filled. Processes
take turns, round by round; a ratio is taken within its round, and its median is told.

Before the first round each process runs once untimed, and XLA writes down what it compiles: the instructions and the
kernels (fusions) of that are counted.
"""

import os

os.environ["PLGWEAR_CORES"] = "all"  # before harness, which pins the process otherwise: users have all cores

import inspect
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import cores
import harness
import numpy as np
import scipy_designs
import typer
from harness import ROOT, short

# --- the questions --------------------------------------------------------------------------------------------------

START = "import jax, jax.numpy as jnp; jax.jit(lambda x: x+1)(1.0)"

IMPORTS = """
import jax
import jax.numpy as jnp
from plgwear_jax import FrettingContact, PowerLawGraded, fretting, optimise

jax.config.update("jax_enable_x64", True)
"""

# Prints the seconds that a call takes once all is imported and JAX has started; what that compiled does not count.
AFTER_IMPORTS = f"""
import pathlib, sys, time
{IMPORTS}
jax.block_until_ready(jax.jit(lambda x: x + 1)(1.0))
for file in pathlib.Path(sys.argv[2]).glob("*.txt"):
    file.unlink()
start = time.perf_counter()
exec(sys.argv[1])
jax.block_until_ready(found)
print(time.perf_counter() - start)
"""

# The question of design/electrical_contact.toml without its limits, in Python.
DESIGN = """
material = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
contact = FrettingContact(material, radius=5e-3, normal_force=10.0, friction=0.4)
found = optimise.design(contact, 0.32, {"k": (-0.9, 0.9)}, hold="contact_radius")
"""

# While the contact radius is held, only the amplitude counts: 0.32 N of 4 N.
GRID = f"""{IMPORTS}
k = jnp.linspace(-0.9, 0.9, 2001)
print(float(k[jnp.argmin(fretting.wear_volume(k, 0.08))]))
"""

BRENT = f"""
import numpy as np
from scipy import optimize, special

{inspect.getsource(scipy_designs.volume_by_root)}
print(optimize.minimize_scalar(volume_by_root, args=(0.08,), bounds=(-0.9, 0.9), method="bounded").x)
"""

SCENES = ROOT / "design"
FIRST, *OTHERS = "electrical_contact", "blade_root", "hip_taper", "railway_axle", "steam_generator_tube"


class Question(NamedTuple):
    """A process that answers something."""

    name: str
    arguments: tuple[str, ...]  # of the interpreter
    goal: float | None = None  # in J
    again: bool = False  # with what the question before has left in the cache folder
    inside: bool = False  # the process says itself how long it took
    finds: bool = False  # the process prints the best exponent
    code: int = 0  # with which the process ends


def command(goal: float, *words: str, say: str = "", **how: Any) -> Question:
    """A command line."""
    told = say or " ".join(Path(word).stem if word.endswith(".toml") else word for word in words)
    return Question(told, ("-m", "plgwear_jax", *words), goal, **how)


def scene(name: str) -> str:
    return str(SCENES / f"{name}.toml")


def call(goal: float, name: str, lines: str) -> Question:
    """A call in Python, without the imports."""
    return Question(name, ("-c", AFTER_IMPORTS, lines), goal, inside=True)


def designs() -> list[Question]:
    """Each scene, and each again."""
    found = []
    for name in (FIRST, *OTHERS):
        found.append(command(4 if name == FIRST else 5, "design", scene(name)))
        found.append(command(2, "design", scene(name), say=f"design {name}, again", again=True))
    return found


WHOLE = "optimise.design, with all imports"

GROUPS: tuple[tuple[Question, ...], ...] = (
    (
        command(0.4, "--help"),
        command(0.4, "new", "new.toml", say="new"),
        command(0.4, "schema"),
        command(0.4, "design", "mistaken.toml", say="design of a scene with a mistake", code=2),
        command(2, "solve", scene(FIRST)),
    ),
    tuple(designs()),
    (
        command(10, "design", scene("hip_taper_pair")),
        command(4, "design", scene("hip_taper_pair"), say="design hip_taper_pair, again", again=True),
    ),
    (
        command(6, "design", scene(FIRST), "--sensitivities", say=f"design {FIRST}, sensitivities"),
        command(6, "design", scene("blade_root"), "--sensitivities", say="design blade_root, sensitivities"),
        command(6, "front", "--points", "11", "--distance", "1e-6", scene(FIRST), say=f"front {FIRST}"),
        command(6, "front", "--points", "11", scene("railway_axle"), say="front railway_axle"),
    ),
    (
        call(3, "optimise.design", DESIGN),
        call(2, "optimise.optimal_exponent(0.3)", "found = optimise.optimal_exponent(0.3)"),
        call(
            0.6,
            "value_and_grad of wear_volume",
            "found = jax.value_and_grad(fretting.wear_volume, (0, 1))(0.3, 0.4)",
        ),
    ),
    (
        Question(WHOLE, ("-c", IMPORTS + DESIGN + 'print(float(found.variables["k"]))'), finds=True),
        Question("SciPy: the reduced form, bounded Brent", ("-c", BRENT), finds=True),
        Question("wear_volume at 2001 exponents, the least", ("-c", GRID), finds=True),
    ),
)
# In the names of questions that are left out of a quick run.
LONG = (*OTHERS, "hip_taper_pair", "again", "sensitivities", "front", "new", "schema", "2001 exponents")


def asked(quick: bool) -> tuple[tuple[Question, ...], ...]:
    """The questions; of the first scene alone, and without those that take longest, if it has to be quick."""

    def kept(one: Question) -> bool:
        return not quick or (one.name != "optimise.design" and not any(word in one.name for word in LONG))

    return tuple(group for group in (tuple(filter(kept, group)) for group in GROUPS) if group)


# --- processes ------------------------------------------------------------------------------------------------------


# Variables that decide what is kept, byte code as well, and how XLA compiles: the processes get none of them.
DECIDING = (
    "JAX_COMPILATION_CACHE",
    "JAX_ENABLE_COMPILATION_CACHE",
    "JAX_PERSISTENT_CACHE",
    "PLGWEAR_",
    "PYTHONDONTWRITEBYTECODE",
    "XLA_FLAGS",
)


class Workplace:
    """Where processes run, with some variables: a folder with a scene that has a mistake, and folders of caches."""

    def __init__(self, folder: Path, variables: Mapping[str, str] | None = None) -> None:
        self.folder, self.variables = folder, variables or {}
        self.dump = folder / "dump"
        self.cache = folder / "cache"
        text = Path(scene(FIRST)).read_text(encoding="utf-8")
        (folder / "mistaken.toml").write_text(re.sub(r"^nu = 0.3", "nu = 0.7", text, flags=re.MULTILINE), "utf-8")

    def run(self, question: Question, dump: bool = False) -> tuple[float, str]:
        """Seconds, and what was printed."""
        for made in (self.folder / "new.toml", self.dump, *([] if question.again else [self.cache])):
            shutil.rmtree(made) if made.is_dir() else made.unlink(missing_ok=True)
        self.cache.mkdir(exist_ok=True)
        inside = [str(self.dump)] if question.inside else []
        environment = self._environment() | ({"XLA_FLAGS": f"--xla_dump_to={self.dump}"} if dump else {})
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, *question.arguments, *inside],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        seconds = time.perf_counter() - start
        if done.returncode != question.code:
            raise RuntimeError(f"{question.name}: exit code {done.returncode}\n{done.stderr}")
        return (float(done.stdout) if question.inside else seconds), done.stdout

    def _environment(self) -> dict[str, str]:
        kept = {name: value for name, value in os.environ.items() if not name.startswith(DECIDING)}
        path = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        fonts = str(self.folder / "matplotlib")
        own = {"PYTHONPATH": os.pathsep.join(path), "XDG_CACHE_HOME": str(self.cache), "MPLCONFIGDIR": fonts}
        return kept | own | dict(self.variables)


class Compiled(NamedTuple):
    """What one process compiled, all programs together."""

    programs: int
    entry: int  # instructions of the entry computations
    instructions: int  # of all computations
    kernels: int


def counted(folder: Path) -> Compiled:
    """From what XLA has written down; what is read from a cache has no processor in its name."""
    texts = [path.read_text(encoding="utf-8") for path in folder.glob("*[cg]pu_after_optimizations.txt")]
    entries = [text[text.index("\nENTRY") :].split("\n}", 1)[0] for text in texts]

    def occurrences(pattern: str, where: Sequence[str]) -> int:
        return sum(len(re.findall(pattern, text, re.MULTILINE)) for text in where)

    instruction = r"^ .* = "
    return Compiled(
        len(texts),
        occurrences(instruction, entries),
        occurrences(instruction, texts),
        occurrences(r" fusion\(", texts),
    )


class Answers(NamedTuple):
    """What was measured, by question."""

    start: np.ndarray  # J in each round
    seconds: Mapping[str, np.ndarray]  # in each round
    compiled: Mapping[str, Compiled]
    exponents: Mapping[str, float]
    others: float  # the share of all cores that other processes had

    def ratio(self, question: Question) -> float:
        return float(np.median(self.seconds[question.name] / self.start))


def measured(rounds: int, groups: tuple[tuple[Question, ...], ...], quick: bool) -> Answers:
    """The questions in turn, round by round; if it has to be quick, nothing counts what they compile."""
    questions = [question for group in groups for question in group]
    seconds: dict[str, list[float]] = {question.name: [] for question in questions}
    starts, compiled, exponents = [], {}, {}
    start = Question("J", ("-c", START))
    with tempfile.TemporaryDirectory(prefix="first_answer-") as folder:
        place = Workplace(Path(folder))
        place.run(start)
        if quick:
            place.run(Question("the list of fonts", ("-c", "import matplotlib.font_manager")))
        for question in () if quick else questions:
            place.run(question, dump=True)
            compiled[question.name] = counted(place.dump)
        before = clocks()
        for _ in range(rounds):
            several = []
            for group in groups:
                several.append(place.run(start)[0])
                for question in group:
                    taken, printed = place.run(question)
                    seconds[question.name].append(taken)
                    if question.finds:
                        exponents[question.name] = float(printed)
            starts.append(np.median(several))
        others = taken_by_others(before)
    return Answers(np.array(starts), {name: np.array(x) for name, x in seconds.items()}, compiled, exponents, others)


def clocks() -> tuple[float, float, float] | None:
    """Seconds: on the wall, of all cores, of this process and those it has started; None where that is not known."""
    try:
        lines = Path("/proc/stat").read_text().splitlines()
        ticks = [int(field) for field in lines[0].split()[1:9]]
    except (OSError, ValueError):
        return None
    if sum(bool(re.match(r"cpu\d", line)) for line in lines) != len(cores.AVAILABLE):
        return None  # the numbers are those of a larger machine
    busy = (sum(ticks) - sum(ticks[3:5])) / os.sysconf("SC_CLK_TCK")
    return time.perf_counter(), busy, sum(os.times()[:4])


def taken_by_others(before: tuple[float, float, float] | None) -> float:
    """The share of all cores that other processes have had since then."""
    after = clocks()
    if before is None or after is None:
        return 0.0
    wall, busy, own = (end - begin for end, begin in zip(after, before, strict=True))
    return max(0.0, (busy - own) / (wall * len(cores.AVAILABLE)))


# --- the report -----------------------------------------------------------------------------------------------------


def main(
    quick: Annotated[bool, typer.Option("--quick", help="One round, fewer questions.")] = False,
    full: Annotated[bool, typer.Option("--full", help="Five rounds instead of three.")] = False,
    out: harness.Out = harness.DEFAULT_OUT,
) -> None:
    """The first answer to one question, and SciPy's."""
    rounds = 1 if quick else 5 if full else 3
    told = f"The first answer in a fresh process, all cores, median of {rounds} round{'s'[: rounds > 1]}"
    report = harness.Report("first_answer", out, told, quick)
    groups = asked(quick)
    found = measured(rounds, groups, quick)
    report.print(f'J = {np.median(found.start):.2f} s: python -c "{START}"')
    *commands, calls, rivals = ([_row(question, found) for question in group] for group in groups)
    sections = [row for group in commands for row in ((), *group)][1:]
    report.table("plgwear ...", COLUMNS, sections)
    report.table("Python, after the imports", COLUMNS, calls)
    report.print(
        "again: with what the command before has left in its cache folder; all others find it empty.\n"
        "front: of 11 points. programs: how many are compiled; entry, all: the instructions of their entry\n"
        "computations, and of all; kernels: the fusions among these. make test is not measured here."
    )
    report.table(
        "The design of electrical_contact without its limits, with all imports, and what else answers it",
        ("", "s", "J", "exponent", "off by"),
        ((*row[:3], *_exponent(row[0], found)) for row in rivals),
    )
    report.print("off by: from the exponent that the library finds, certified and proven.")
    goals = [question for group in groups for question in group if question.goal is not None]
    reached = sum(_reached(question, found) for question in goals)
    report.print(f"{reached} of {len(goals)} goals are reached.")
    report.warn_if_shared(found.others)
    report.close()


COLUMNS = ("", "s", "J", "goal, J", "reached", "programs", "entry", "all", "kernels")


def _reached(question: Question, found: Answers) -> bool:
    return question.goal is not None and found.ratio(question) <= question.goal


def _row(question: Question, found: Answers) -> tuple[str, ...]:
    return (
        question.name,
        short(float(np.median(found.seconds[question.name]))),
        f"{found.ratio(question):.2f}",
        f"{question.goal or 0.0:g}",
        "yes" if _reached(question, found) else "not yet",
        *(f"{number:,}" for number in found.compiled.get(question.name, ())),
    )


def _exponent(name: str, found: Answers) -> tuple[str, str]:
    """The exponent that was found, and how far it is from the library's."""
    exponent = found.exponents[name]
    return f"{exponent:.9f}", "" if name == WHOLE else f"{abs(exponent - found.exponents[WHOLE]):.0e}"


def _full_name(question: Question) -> str:
    return f"plgwear {question.name}" if "plgwear_jax" in question.arguments else question.name


if __name__ == "__main__":
    harness.run(main)
