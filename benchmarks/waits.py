"""How long users wait, in fresh processes on all cores, in units of what JAX takes to start: four tables.

    python benchmarks/waits.py --quick
    python benchmarks/waits.py first_answer waits

J is the time of a fresh process that starts JAX and compiles the least there is to compile. Times in units of J can be
compared between machines. Each line is a fresh process, as a user starts it, with Python's byte code in place and
the list of fonts that matplotlib makes once. Every process has an empty cache folder of its own, but for the lines that
say "again": these have the one that the line before has filled. Processes take turns, round by round; a ratio is taken
within its round, and its median is told.

first_answer: commands, calls after the imports, and a design beside SciPy's. waits: contacts without closed forms, runs
over cycles and designs for a life, with all imports; "again" is the same answer once more in the same process, with
other numbers, and "memory" the most that the process had at once. startup: what each part of `_core.startup`
buys, as the J that an answer takes more without it; the variable PLGWEAR_STARTUP switches parts off. matrix: every
question for contacts of every kind, so many that each pair of a body, an indenter, a shape and a load stands in one
row; searches are asked once a load. Letters stand for the lines that an error says, below the table.
"""

import os

os.environ["PLGWEAR_CORES"] = "all"  # before harness, which pins the process otherwise: users have all cores

import inspect
import itertools
import json
import re
import shutil
import string
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import cores
import harness
import numpy as np
import scipy_designs
from harness import ROOT, Part, Report, short

# --- processes ------------------------------------------------------------------------------------------------------


class Question(NamedTuple):
    """A process that answers something, and what it may take."""

    name: str
    arguments: tuple[str, ...]  # of the interpreter
    goal: float | None = None  # in J
    again: bool = False  # with what the question before has left in the cache folder
    code: int = 0  # with which the process ends


class Took(NamedTuple):
    """Seconds of a process with its children, and what it printed."""

    processor: float
    wall: float
    printed: str


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
    """Where processes run, with some variables: a folder with scenes and a folder of caches."""

    def __init__(self, folder: Path, variables: Mapping[str, str]) -> None:
        self.folder, self.cache = folder, folder / "cache"
        folder.mkdir(exist_ok=True)
        mistaken = re.sub(r"^nu = 0.3", "nu = 0.7", Path(scene(FIRST)).read_text("utf-8"), flags=re.MULTILINE)
        for name, text in (("mistaken", mistaken), ("layers", LAYERS), ("closed", CLOSED)):
            (folder / f"{name}.toml").write_text(text, "utf-8")
        kept = {name: value for name, value in os.environ.items() if not name.startswith(DECIDING)}
        path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
        own = {"PYTHONPATH": path, "XDG_CACHE_HOME": str(self.cache), "MPLCONFIGDIR": str(folder / "matplotlib")}
        self.environment = kept | own | dict(variables)
        self.run(Question("the list of fonts", ("-c", "import matplotlib.font_manager")))

    def run(self, question: Question) -> Took:
        """Run a process."""
        (self.folder / "new.toml").unlink(missing_ok=True)
        if not question.again:
            shutil.rmtree(self.cache, ignore_errors=True)
        self.cache.mkdir(exist_ok=True)
        how: dict[str, Any] = {"cwd": self.folder, "env": self.environment, "capture_output": True, "text": True}
        before, start = sum(os.times()[2:4]), time.perf_counter()
        done = subprocess.run([sys.executable, *question.arguments], check=False, **how)
        wall = time.perf_counter() - start
        if done.returncode != question.code:
            raise RuntimeError(f"{question.name}: exit code {done.returncode}\n{done.stderr}")
        return Took(sum(os.times()[2:4]) - before, wall, done.stdout)


@contextmanager
def workplaces(variants: Mapping[str, Mapping[str, str]]) -> Iterator[dict[str, Workplace]]:
    with tempfile.TemporaryDirectory(prefix="waits-") as folder:
        yield {name: Workplace(Path(folder) / str(n), given) for n, (name, given) in enumerate(variants.items())}


START = "import jax, jax.numpy as jnp; jax.jit(lambda x: x+1)(1.0)"
J = Question("J", ("-c", START))
PLAIN: dict[str, dict[str, str]] = {"": {}}


class Rounds(NamedTuple):
    """What processes took in each round: J, and the others by variant and question."""

    starts: list[Took]
    taken: dict[tuple[str, str], list[Took]]

    def start(self, clock: str = "wall") -> np.ndarray:
        return np.array([getattr(took, clock) for took in self.starts])

    def seconds(self, name: str, variant: str = "", clock: str = "wall") -> np.ndarray:
        return np.array([getattr(took, clock) for took in self.taken[variant, name]])

    def ratio(self, name: str, variant: str = "", clock: str = "wall") -> float:
        """In J."""
        return float(np.median(self.seconds(name, variant, clock) / self.start(clock)))

    def printed(self, name: str) -> list[str]:
        return [took.printed for took in self.taken["", name]]


def measured(
    report: Report,
    questions: Iterable[Question],
    rounds: int,
    variants: Mapping[str, Mapping[str, str]] = PLAIN,
) -> Rounds:
    """All in turn, round by round."""
    found, questions = Rounds([], {}), list(questions)
    with workplaces(variants) as places:
        first = next(iter(places.values()))
        first.run(J)
        before = clocks()
        for _ in range(rounds):
            found.starts.append(first.run(J))
            for question in questions:
                for variant, place in places.items():
                    found.taken.setdefault((variant, question.name), []).append(place.run(question))
        report.others = taken_by_others(before)
    report.print(f'J = {np.median(found.start()):.2f} s: python -c "{START}"')
    return found


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


# --- first answers --------------------------------------------------------------------------------------------------

FIRST, *OTHERS = "electrical_contact", "blade_root", "hip_taper", "railway_axle", "steam_generator_tube"

LAYERS = """
material = { thickness = [2e-6], modulus = [400e9, 110e9], nu = 0.3 }
contact = { kind = "fretting", radius = 0.005, normal_force = 10.0, friction = 0.4 }
load = { tangential_force = 0.32 }
wear = { coefficient = 1e-14 }
"""
CLOSED = LAYERS.replace("thickness = [2e-6], modulus = [400e9, 110e9]", "E0 = 110e9, z0 = 1e-4, k = 0.2")

IMPORTS = """
import resource
import time

import jax
import jax.numpy as jnp
import numpy as np
from plgwear_jax import *
from plgwear_jax import compiler_options, fretting, optimise
from plgwear_jax.loads import Displacement
from plgwear_jax.shapes import *

jax.config.update("jax_enable_x64", True)
"""
# Prints the seconds that a call takes once all is imported and JAX has started.
INSIDE = """
jax.block_until_ready(jax.jit(lambda x: x + 1)(1.0))
start = time.perf_counter()
{}
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
BRENT = f"""
import numpy as np
from scipy import optimize, special

{inspect.getsource(scipy_designs.volume_by_root)}
print(optimize.minimize_scalar(volume_by_root, args=(0.08,), bounds=(-0.9, 0.9), method="bounded").x)
"""


def scene(name: str) -> str:
    return str(ROOT / "design" / f"{name}.toml")


def command(goal: float | None, *words: str, say: str = "", **how: Any) -> Question:
    """A command line."""
    told = say or " ".join(Path(word).stem if word.endswith(".toml") else word for word in words)
    return Question(told, ("-m", "plgwear_jax", *words), goal, **how)


def twice(goals: tuple[float, float] | None, *words: str, say: str = "") -> list[Question]:
    """A command line, and the same with what it has left in the cache folder."""
    first = command(goals and goals[0], *words, say=say)
    return [first, command(goals and goals[1], *words, say=f"{first.name}, again", again=True)]


def python(name: str, lines: str, goal: float | None = None) -> Question:
    return Question(name, ("-c", IMPORTS + lines), goal)


COMMANDS = (
    command(0.4, "--help"),
    command(0.4, "new", "new.toml", say="new"),
    command(0.4, "schema"),
    command(0.4, "design", "mistaken.toml", say="design of a scene with a mistake", code=2),
    command(2, "solve", scene(FIRST)),
    *(one for name in (FIRST, *OTHERS) for one in twice((4 if name == FIRST else 5, 2), "design", scene(name))),
    *twice((10, 4), "design", scene("hip_taper_pair")),
    *twice((6, 4), "design", scene("steel_ball")),
    command(6, "design", scene(FIRST), "--sensitivities", say=f"design {FIRST}, sensitivities"),
    command(6, "design", scene("blade_root"), "--sensitivities", say="design blade_root, sensitivities"),
    command(6, "front", "--points", "11", "--distance", "1e-6", scene(FIRST), say=f"front {FIRST}"),
    command(6, "front", "--points", "11", scene("railway_axle"), say="front railway_axle"),
)
CALLS = {
    "optimise.design": (DESIGN, 3),
    "optimise.optimal_exponent(0.3)": ("found = optimise.optimal_exponent(0.3)", 2),
    "value_and_grad of wear_volume": ("found = jax.value_and_grad(fretting.wear_volume, (0, 1))(0.3, 0.4)", 0.6),
}
RIVALS = (
    python("optimise.design, with all imports", DESIGN + 'print(float(found.variables["k"]))'),
    Question("SciPy: the reduced form, bounded Brent", ("-c", BRENT)),
)
COLUMNS = ("", "s", "J", "goal, J", "reached")


def first_answer(report: Report, quick: bool) -> None:
    """Commands, calls, and what else answers a design."""
    calls = [python(name, INSIDE.format(lines), goal) for name, (lines, goal) in CALLS.items()]
    commands, calls, rivals = (
        (COMMANDS[:1] + COMMANDS[3:6], calls[2:], RIVALS[:2]) if quick else (COMMANDS, calls, RIVALS)
    )
    found = measured(report, (*commands, *calls, *rivals), 1 if quick else 3)

    def row(question: Question) -> tuple[str, ...]:
        seconds = found.seconds(question.name)
        if question in calls:
            seconds = np.array([float(text) for text in found.printed(question.name)])
        return question.name, short(float(np.median(seconds))), *_reached(seconds / found.start(), question.goal)

    report.table("plgwear ...", COLUMNS, map(row, commands))
    report.table("Python, after the imports", COLUMNS, map(row, calls))
    report.print("again: with what the command before has left in its cache folder; all others find it empty.")
    exponents = [float(found.printed(one.name)[-1]) for one in rivals]
    report.table(
        "The design of electrical_contact without its limits, with all imports, and what else answers it",
        ("", "s", "J", "exponent", "off by"),
        ((*row(one)[:3], f"{k:.9f}", f"{abs(k - exponents[0]):.0e}") for one, k in zip(rivals, exponents, strict=True)),
    )
    report.print("off by: from the exponent that the library finds, certified and proven.")


def _reached(ratios: np.ndarray, goal: float | None) -> tuple[str, str, str]:
    """J, the goal, and whether it is reached."""
    ratio = float(np.median(ratios))
    return (
        f"{ratio:.2f}",
        "" if goal is None else f"{goal:g}",
        "" if goal is None else "yes" if ratio <= goal else "not yet",
    )


# --- what takes longest ---------------------------------------------------------------------------------------------

ASKED = """
power_law = PowerLawGraded(110e9, 1e-4, 0.1, 0.3)
moduli = [90e9, 150e9, 120e9, 210e9]
rigid = FrettingContact(power_law, 5e-3, 10.0, 0.4)
steel = Elastic(210e9, 0.3)
table = FrettingContact(DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], moduli, 0.3), 5e-3, 10.0, 0.4, steel)
layers = FrettingContact(Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3), 5e-3, 10.0, 0.4, steel)
K, N = 1e-14, 4e5


class Own(Shape):
    slope: float

    def height(self, r, radius):
        return self.slope * r


def shaped(shape):
    return FrettingContact(power_law, 5e-3, 10.0, 0.4, None, shape)


def several(contact):
    shares = np.linspace(0.98, 1.02, 100)
    return jax.tree.map(lambda x: jnp.asarray(np.multiply.outer(shares, x)), contact)


def worn(contact):
    return contact.over_cycles(1.0, K).volume(N)


def held(contact):
    return contact.over_cycles(Displacement(contact.steady(1.0).displacement_amplitude), K).volume(N)


def slips(contact):
    return contact.over_cycles(Displacement(3e-6), K).volume(1e5)


def steady(contact):
    return contact.steady(1.0).wear_volume


def best(vary, **asked):
    return lambda contact: optimise.design(contact, 1.0, vary, cycles=N, law=K, **asked).value


given = {}
ask = {}
other = jax.tree.map(lambda x: 1.001 * jnp.asarray(x), given)
jax.block_until_ready(ask(given))
start = time.perf_counter()
jax.block_until_ready(ask(other))
print(time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20)
"""
BODY, LESS = ASKED.rpartition("given = {}\n")[::2]
FAST = ", compiler_options=compiler_options(1)"
LIMIT = '{"contact_radius": {"above": 6e-5}}'
WAITS: tuple[tuple[str, str, str, float | None], ...] = (  # with the contact, what is asked of it, and the goal in J
    ("steady state of a table under steel: value", "table", "steady", 2.5),
    ("first gradient", "table", "jax.grad(steady)", 3),
    ("value and gradient inside jit", "table", "jax.jit(jax.value_and_grad(steady))", 5),
    ("the same with compiler_options(1)", "table", f"jax.jit(jax.value_and_grad(steady){FAST})", 5),
    ("second derivatives by all 14 numbers", "table", "jax.hessian(steady)", None),
    ("closed forms: second derivatives by all 7 numbers", "rigid", "jax.hessian(steady)", None),
    ("the same table over cycles: value", "table", "worn", 4),
    ("first gradient over cycles", "table", "jax.grad(worn)", 8),
    ("value and gradient over cycles inside jit", "table", "jax.jit(jax.value_and_grad(worn))", 10),
    ("over cycles with compiler_options(1)", "table", f"jax.jit(jax.value_and_grad(worn){FAST})", 10),
    ("100 contacts over cycles, jit(vmap)", "several(table)", "jax.jit(jax.vmap(worn))", 6),
    ("the same with gradients", "several(table)", "jax.jit(jax.vmap(jax.grad(worn)))", None),
    ("a power law under a rigid ball over cycles: first gradient", "rigid", "jax.grad(worn)", 5),
    ("a held displacement: first gradient", "table", "jax.grad(held)", 10),
    ("best k for a life, closed forms", "rigid", 'best({"k": (-0.6, 0.6)})', 6),
    (
        "best k and E0 for a life with a limit, closed forms",
        "rigid",
        f'best({{"k": (-0.6, 0.6), "E0": (50e9, 400e9)}}, limits={LIMIT})',
        8,
    ),
    ("gross slip of a power law: value", "rigid", "slips", 4),
    ("its first gradient", "rigid", "jax.grad(slips)", None),
    ("its gradient inside jit", "rigid", "jax.jit(jax.grad(slips))", None),
    ("gross slip of layers under steel: value", "layers", "slips", 4),
    ("gross slip of a cone", "shaped(Cone(0.01))", "slips", 4),
    ("of a class of one's own", "shaped(Own(0.01))", "slips", 4),
)


def waits(report: Report, quick: bool) -> None:
    """The first answer of what takes longest, and the next one."""
    rows = [WAITS[i] for i in (0, 4, 16)] if quick else WAITS
    code = {
        name: f"{BODY}given = {given}\nask = {ask}\n{LESS.partition('ask = {}')[2]}" for name, given, ask, _ in rows
    }
    found = measured(report, (python(name, lines) for name, lines in code.items()), 1 if quick else 2)
    table = []
    for name, *_, goal in rows:
        again, memory = np.array([text.split() for text in found.printed(name)], float).T
        ratios = (found.seconds(name) - again) / found.start()
        table.append([name, *_reached(ratios, goal), *(short(float(np.median(x))) for x in (again, memory))])
    report.table("With all imports", ("", "J", "goal, J", "reached", "again, s", "memory, GB"), table)


# --- every question for every contact -------------------------------------------------------------------------------

EVERY = """
import dataclasses, json
from plgwear_jax.fitting import fit_wear_coefficient
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.sweep import sweep

law = PowerLawGraded(110e9, 1e-4, 0.2, 0.3)
layers = Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3)
table = DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], [90e9, 150e9, 120e9, 210e9], 0.3)
heights = np.linspace(0.0, 1e-3, 41)
one = FrettingContact({body}, 5e-3, 10.0, 0.4, {indenter}, {shape})
onset = float(one.steady(0.0).gross_slip_displacement)
mean = 10.0 / (np.pi * float(one.steady(0.0).contact_radius) ** 2)
N = 0.3 * float(one.steady(1.2).penetration) / (1e-14 * mean * 4.0 * onset)  # wears about half of what it can
load, life = {load}, dict(cycles=N, law=1e-14)
vary = {{"k": (-0.4, 0.6)}} if {body} is law else {{"material.modulus[1]": (60e9, 280e9)}}
depths = optimise.ModulusProfile(np.array([2e-5, 5e-5, 2e-4]), np.full(3, 60e9), np.full(3, 280e9))
cycles = N * np.array([0.3, 0.6, 1.0])


def volume(one, load=load):
    return one.over_cycles(load, 1e-14).volume(N)


def fit():
    data = np.asarray(one.over_cycles(load, 1e-14).volume(cycles))
    return fit_wear_coefficient(one, load, cycles, data, deviation=0.01 * data).wear_coefficient


asked = dict(
    value=lambda: volume(one),
    slopes=lambda: jax.grad(volume)(one),
    jit=lambda: jax.jit(volume)(one),
    vmap=lambda: jax.vmap(lambda x: volume(dataclasses.replace(one, radius=5e-3 * x)))(jnp.array([0.9, 1.0, 1.1])),
    float32=lambda: volume(*jax.tree.map(jnp.float32, (one, load))),
    design=lambda: optimise.design(one, load, vary, **life).value,
    free=lambda: optimise.free_design(one, load, depths, starts=2, **life).value,
    front=lambda: optimise.front(one, load, vary, "transient.contact_radius", points=3, **life).y,
    fit=fit,
    sweep=lambda: sweep("transient.wear_volume", contact=one, load=load, cycles=cycles, wear_coefficient=1e-14),
)
for name in {names}:
    begin = time.process_time()
    try:
        jax.block_until_ready(asked[name]())
        print(json.dumps(time.process_time() - begin))
    except (TypeError, ValueError, jax.errors.JaxRuntimeError) as error:
        print(json.dumps(str(error).splitlines()[0]))
"""
BODIES = {"power law": "law", "layers": "layers", "table": "table"}
INDENTERS = {"rigid": "None", "steel": "Elastic(210e9, 0.3)"}
SHAPES = {
    "parabola": "Parabola()",
    "cone": "Cone(0.01)",
    "rounded flat": "RoundedFlat(5e-5)",
    "table of heights": "Profile(heights, heights**2 / 1e-2)",
}
LOADS = {
    "force": "Force(1.2)",
    "displacement": "Displacement(0.4 * onset)",
    "rig": "Displacement(0.8 * onset, 2.0 / onset)",
    "blocks": "[Block(Force(1.2), 0.5 * N), Block(Displacement(0.5 * onset), 0.5 * N, 8.0)]",
    "gross slip": "Displacement(3.0 * onset)",
}
ASKS = "value", "slopes", "jit", "vmap", "float32", "fit", "sweep", "design", "free", "front"


def matrix(report: Report, quick: bool) -> None:
    """Seconds of the processor of each question, one after the other in the process of a row."""
    every = list(itertools.product(BODIES, INDENTERS, SHAPES, LOADS))
    chosen, pairs = [], {pair for row in every for pair in itertools.combinations(enumerate(row), 2)}
    while pairs:  # rows in which each pair of two of the four stands
        chosen.append(max(every, key=lambda row: len(pairs & {*itertools.combinations(enumerate(row), 2)})))
        pairs -= {*itertools.combinations(enumerate(chosen[-1]), 2)}
    reasons: dict[str, str] = {}
    table, searched, asks = [], set(), 3 if quick else len(ASKS)
    with workplaces(PLAIN) as places:
        for row in sorted(chosen, key=every.index)[: 1 if quick else None]:
            names = ASKS[: min(asks, 7 if row[3] in searched else 10)]  # searches once a load
            searched.add(row[3])
            given = zip(("body", "indenter", "shape", "load"), (BODIES, INDENTERS, SHAPES, LOADS), row, strict=True)
            code = EVERY.format(names=names, **{what: known[name] for what, known, name in given})
            told = [json.loads(line) for line in places[""].run(python(", ".join(row), code)).printed.splitlines()]
            letters = string.ascii_letters
            cells = [reasons.setdefault(x, letters[len(reasons)]) if isinstance(x, str) else short(x) for x in told]
            table.append([*row, *cells])
    report.table("Seconds, the first answer in this process", ("body", "indenter", "shape", "load", *ASKS), table)
    for line, letter in reasons.items():
        report.print(f"{letter}: {line}")


# --- what the parts of the start buy --------------------------------------------------------------------------------

PARTS_OF_START = ("kept", "steps", "derivatives", "levels")
VARIANTS: dict[str, dict[str, str]] = {
    "all": {},
    **{f"no {x}": {"PLGWEAR_STARTUP": ",".join(p for p in PARTS_OF_START if p != x)} for x in PARTS_OF_START},
    "none": {"PLGWEAR_STARTUP": ""},
}
STARTS = (
    *twice(None, "solve", "layers.toml", say="solve layers"),
    *twice(None, "solve", scene(FIRST), say="solve closed"),
    *twice(None, "wear", "closed.toml", say="wear closed"),
    *twice(None, "wear", "layers.toml", say="wear layers"),
    *twice(None, "design", scene(FIRST), say="design closed"),
    *twice(None, "design", scene("blade_root"), say="design with limits"),
    *twice(None, "design", scene("hip_taper_pair"), say="design of a pair"),
    python("value", "jax.block_until_ready(fretting.wear_volume(0.3, 0.4))"),
    python("value_and_grad", CALLS["value_and_grad of wear_volume"][0]),
    python("value_and_grad of a profile", "jax.value_and_grad(fretting.wear_depth, (0, 1, 2))(0.97, 0.3, 0.4)"),
    python("value_and_grad, layers", BODY + "jax.block_until_ready(jax.value_and_grad(steady)(layers))"),
    python("optimise.design", DESIGN),
)


def startup(report: Report, quick: bool) -> None:
    """What each part of the start buys."""
    questions = STARTS[:2] if quick else STARTS
    found = measured(report, questions, 1, VARIANTS)
    for clock, title in (("processor", "Time of the processor"), ("wall", "Time on the wall")):
        rows = []
        for question in questions:
            first, *rest = (found.ratio(question.name, variant, clock) for variant in VARIANTS)
            rows.append([question.name, f"{first:.2f}", *(f"{x - first:+.2f}" for x in rest)])
        report.table(title, ("", "all, J", *list(VARIANTS)[1:]), rows)
    report.print("again: with what the line before has left in its cache folder; all others find it empty.")


PARTS = {
    "first_answer": Part("The first answer in a fresh process, all cores, median of 3 rounds", [first_answer]),
    "waits": Part("How long one answer takes, all cores, median of 2 rounds", [waits]),
    "matrix": Part("Every question for every contact: seconds of the processor", [matrix]),
    "startup": Part("What each part of the start buys, all cores, one round", [startup]),
}

if __name__ == "__main__":
    harness.run(PARTS)
