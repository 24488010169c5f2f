"""How long one answer takes of contacts without closed forms, of runs over cycles and of designs for a life.

    python benchmarks/waits.py --quick
    python benchmarks/waits.py

Each row is a fresh process on all cores with all imports, in units of J, the time of a process that starts JAX and
compiles the least there is (`first_answer.py`). "again" is the same answer once more in the same process, with other
numbers. "memory" is the most that the process had at once. Processes take turns, round by round; the medians are told.
"""

import os

os.environ["PLGWEAR_CORES"] = "all"  # before harness, which pins the process otherwise: users have all cores

import tempfile
from pathlib import Path
from typing import Annotated, NamedTuple

import first_answer
import harness
import numpy as np
import typer
from first_answer import START, Question, Workplace
from harness import short

BEFORE = """
import resource
import time
import numpy as np
import jax
import jax.numpy as jnp
from plgwear_jax import DepthGraded, Elastic, FrettingContact, PowerLawGraded, compiler_options, optimise

jax.config.update("jax_enable_x64", True)
power_law = PowerLawGraded(110e9, 1e-4, 0.1, 0.3)
moduli = [90e9, 150e9, 120e9, 210e9]
rigid = FrettingContact(power_law, 5e-3, 10.0, 0.4)
table = FrettingContact(DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], moduli, 0.3), 5e-3, 10.0, 0.4, Elastic(210e9, 0.3))
K, N = 1e-14, 4e5


def several(contact):
    shares = np.linspace(0.98, 1.02, 100)
    return jax.tree.map(lambda x: jnp.asarray(np.multiply.outer(shares, x)), contact)


def worn(contact):
    return contact.over_cycles(1.0, K).volume(N)


def held(contact):
    return contact.wear_volume(1.0, cycles=N, wear_coefficient=K, control="displacement")


def steady(contact):
    return contact.steady(1.0).wear_volume


def best(vary, **asked):
    return lambda contact: optimise.design(contact, 1.0, vary, cycles=N, law=K, **asked).value


"""

AFTER = """
other = jax.tree.map(lambda x: 1.001 * jnp.asarray(x), given)
jax.block_until_ready(ask(given))
start = time.perf_counter()
jax.block_until_ready(ask(other))
print(time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20)
"""


class Wait(NamedTuple):
    """A row."""

    question: str
    given: str  # the contact
    ask: str  # the function
    goal: float | None = None  # in J
    again: float | None = None  # in s

    @property
    def process(self) -> Question:
        """The process that answers it."""
        code = f"{BEFORE}given = {self.given}\nask = {self.ask}\n{AFTER}"
        return Question(self.question, ("-c", code))


QUICK = ", compiler_options=compiler_options(1)"
LIMIT = '{"contact_radius": {"above": 6e-5}}'
WAITS = (
    Wait("steady state of a table under steel: value", "table", "steady", 2.5),
    Wait("first gradient", "table", "jax.grad(steady)", 3),
    Wait("value and gradient inside jit", "table", "jax.jit(jax.value_and_grad(steady))", 5),
    Wait("the same with compiler_options(1)", "table", f"jax.jit(jax.value_and_grad(steady){QUICK})", 5),
    Wait("the same table over cycles: value", "table", "worn", 4),
    Wait("first gradient over cycles", "table", "jax.grad(worn)", 8),
    Wait("value and gradient over cycles inside jit", "table", "jax.jit(jax.value_and_grad(worn))", 10),
    Wait("over cycles with compiler_options(1)", "table", f"jax.jit(jax.value_and_grad(worn){QUICK})", 10),
    Wait("100 contacts over cycles, jit(vmap)", "several(table)", "jax.jit(jax.vmap(worn))", 6, 1.5),
    Wait("the same with gradients", "several(table)", "jax.jit(jax.vmap(jax.grad(worn)))"),
    Wait("a power law under a rigid ball over cycles: first gradient", "rigid", "jax.grad(worn)", 5),
    Wait("a held displacement: first gradient", "table", "jax.grad(held)", 10),
    Wait("best k for a life, closed forms", "rigid", 'best({"k": (-0.6, 0.6)})', 6),
    Wait(
        "best k and E0 for a life with a limit, closed forms",
        "rigid",
        f'best({{"k": (-0.6, 0.6), "E0": (50e9, 400e9)}}, limits={LIMIT})',
        8,
    ),
)


def main(
    quick: Annotated[bool, typer.Option("--quick", help="One round, four rows.")] = False,
    rounds: Annotated[int, typer.Option(help="How often each process runs.")] = 3,
    out: harness.Out = harness.DEFAULT_OUT,
) -> None:
    """The first answer of what takes longest, and the next one."""
    rounds = 1 if quick else rounds
    told = f"How long one answer takes, all cores, median of {rounds} round{'s'[: rounds > 1]}"
    report = harness.Report("waits", out, told, quick)
    waits = [WAITS[i] for i in (0, 1, 4, 9)] if quick else WAITS
    starts, first, again, memory = [], *({wait: [] for wait in waits} for _ in range(3))
    with tempfile.TemporaryDirectory(prefix="waits-") as folder:
        place = Workplace(Path(folder), {})
        place.run(Question("J", ("-c", START)))
        before = first_answer.clocks()
        for _ in range(rounds):
            starts.append(place.run(Question("J", ("-c", START)))[0])
            for wait in waits:
                seconds, printed = place.run(wait.process)
                later, most = map(float, printed.split())
                first[wait].append(seconds - later)
                again[wait].append(later)
                memory[wait].append(most)
        others = first_answer.taken_by_others(before)
    report.print(f'J = {np.median(starts):.2f} s: python -c "{START}"')
    rows = []
    for wait in waits:
        ratio = float(np.median(np.array(first[wait]) / np.array(starts)))
        goal, reached = "", ""
        if wait.goal is not None:
            goal, reached = f"{wait.goal:g}", "yes" if ratio <= wait.goal else "not yet"
        rows.append([wait.question, f"{ratio:.1f}", goal, reached, short(float(np.median(again[wait])))])
        rows[-1].append(short(float(np.median(memory[wait]))))
    report.table("With all imports", ("", "J", "goal, J", "reached", "again, s", "memory, GB"), rows)
    report.warn_if_shared(others)
    report.close()


if __name__ == "__main__":
    harness.run(main)
