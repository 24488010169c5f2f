"""What the first result costs in a fresh process: import, trace, compile; and what a call costs from then on.

    python benchmarks/first_call.py
    python benchmarks/first_call.py --quick
    python benchmarks/first_call.py --redraw

Every number is the median over cold processes on one core, with the persistent compilation cache of JAX switched off
and Python's bytecode in place, as after the first run of an installed package. "First call" is the time from the end of
the imports to the result of a plain call, and so includes what JAX itself needs to start (the row of an addition);
"jitted" is the same of `jax.jit` of it. Tracing with lowering, and compiling, are those of the jitted call.
"""

import json
import os
import subprocess
import sys
from typing import Any, NamedTuple

import harness  # before jax: pins the process
import numpy as np
from harness import ROOT, short
from matplotlib.figure import Figure

from plgwear_jax.plots import COLOURS

# Runs in a process that has imported nothing yet. What is called is a line of Python: (function, arguments).
WORKER = """
import json, sys, time

clock = time.perf_counter
start = clock()
import jax
after_jax = clock()
from plgwear_jax import fretting, optimise
imported = clock()

from functools import partial

jax.config.update("jax_enable_x64", True)
call, way = sys.argv[1:]
function, arguments = eval(call)
found = {"import jax": after_jax - start, "import plgwear_jax": imported - after_jax}


def seconds(function, *arguments):
    start = clock()
    result = jax.block_until_ready(function(*arguments))
    return clock() - start, result


def later(function):
    repeats = max(1, min(1000, int(0.05 / seconds(function, *arguments)[0])))
    return sorted(
        seconds(lambda: [jax.block_until_ready(function(*arguments)) for _ in range(repeats)])[0] / repeats
        for _ in range(5)
    )[2]


if way == "plain":
    found["first call"], _ = seconds(function, *arguments)
    found["later call"] = later(function)
else:
    function = jax.jit(function)
    start = clock()
    lowered = function.lower(*arguments)
    found["trace and lower"] = clock() - start
    found["compile"], compiled = seconds(lowered.compile)
    found["run"], _ = seconds(compiled, *arguments)
    found["later, jitted"] = later(function)
print(json.dumps(found))
"""

ADDITION = "an addition: JAX alone"
VALUE, GRADIENT = "wear_volume", "its value and gradient"
CALLS = {
    ADDITION: "jax.numpy.add, (0.3, 0.4)",
    VALUE: "fretting.wear_volume, (0.3, 0.4)",
    GRADIENT: "jax.value_and_grad(fretting.wear_volume, (0, 1)), (0.3, 0.4)",
    "its Hessian": "jax.hessian(fretting.wear_volume, (0, 1)), (0.3, 0.4)",
    "profile at 201 radii": "fretting.profile, (jax.numpy.linspace(0.0, 1.25, 201), 0.3, 0.4)",
    "optimal_exponent": "optimise.optimal_exponent, (0.3,)",
}
STAGES = ("trace and lower", "compile", "run")


class Cold(NamedTuple):
    """Seconds by stage, one for each process."""

    taken: dict[str, np.ndarray]

    def median(self, *stages: str) -> float:
        """Of the sum of stages."""
        return float(np.median(sum(self.taken[stage] for stage in stages)))


def cold(call: str, way: str) -> dict[str, float]:
    """The stages of one call in a fresh process."""
    hidden = {key: value for key, value in os.environ.items() if not key.startswith("JAX_COMPILATION_CACHE")}
    quiet = {"JAX_ENABLE_COMPILATION_CACHE": "false", "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path[1:]])}
    command = [sys.executable, "-c", WORKER, call, way]
    done = subprocess.run(command, env=hidden | quiet, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def measured(calls: dict[str, str], rounds: int) -> dict[str, Cold]:
    """All calls in turn, round by round."""
    found: dict[str, dict[str, list[float]]] = {name: {} for name in calls}
    if rounds > 1:
        cold(CALLS[VALUE], "plain")  # leaves bytecode and files in the machine's caches
    for _ in range(rounds):
        for name, call in calls.items():
            for stage, seconds in (cold(call, "plain") | cold(call, "jitted")).items():
                found[name].setdefault(stage, []).append(seconds)
    return {name: Cold({stage: np.array(x) for stage, x in stages.items()}) for name, stages in found.items()}


# --- the report -----------------------------------------------------------------------------------------------------


def main(quick: harness.Quick = False, redraw: harness.Redraw = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Import, first call and later calls."""
    if redraw:
        _picture(_of_the_table()).savefig(out / "first_call.png")
        return
    rounds = 1 if quick else 9
    report = harness.Report("first_call", out, f"The first call in a fresh process, median of {rounds}", quick)
    found = measured({name: CALLS[name] for name in (VALUE, GRADIENT)} if quick else CALLS, rounds)
    imports = np.concatenate([one.taken["import plgwear_jax"] for one in found.values()])
    report.table(
        "Import, s",
        ("", "median", "quartiles"),
        (
            _import_row("jax", np.concatenate([one.taken["import jax"] for one in found.values()])),
            _import_row("plgwear_jax, after jax", imports),
        ),
    )
    columns = ("", "trace, lower", "compile", "first call", "jitted", "later call, µs", "jitted, µs")
    report.table("Calls, s", columns, (_row(name, one) for name, one in found.items()))
    report.print("Without the persistent compilation cache.")
    harness.goals(
        report,
        (
            ("import of plgwear_jax after jax, s, at most", 0.1, float(np.median(imports)), False),
            ("first wear_volume with its gradient, s, at most", 0.5, found[GRADIENT].median("first call"), False),
            ("later wear_volume, plain call, µs, at most", 60.0, 1e6 * found[VALUE].median("later call"), False),
        ),
    )
    report.close(_picture(_parts(found)))


def _import_row(name: str, seconds: np.ndarray) -> tuple[str, str, str]:
    low, high = np.quantile(seconds, (0.25, 0.75))
    return name, short(float(np.median(seconds))), f"{short(low)}-{short(high)}"


def _row(name: str, one: Cold) -> tuple[str, ...]:
    stages = [short(one.median(stage)) for stage in ("trace and lower", "compile", "first call")]
    later = [short(1e6 * one.median(stage)) for stage in ("later call", "later, jitted")]
    return name, *stages, short(one.median(*STAGES)), *later


# What is drawn: (colour, hatches that tell it apart without colour) of each part of the time.
LOOKS = {
    "import of JAX": ("0.8", ""),
    "import of plgwear_jax": ("0.35", ""),
    "trace and lower": (COLOURS[0], ""),
    "compile": (COLOURS[1], "////"),
    "run": ("k", ""),
}


def _parts(found: dict[str, Cold]) -> dict[str, list[float]]:
    """The parts of the time of each call, in the order of LOOKS."""
    stages = ("import jax", "import plgwear_jax", *STAGES)
    return {name: [one.median(stage) for stage in stages] for name, one in found.items()}


def _of_the_table() -> dict[str, list[float]]:
    """The same from the committed table, whose running time is what is left of the jitted call."""
    (_, imports), (_, calls), *_ = harness.committed("first_call")
    imported = [harness.number(row[1]) for row in imports]
    parts = {}
    for name, *cells in calls:
        trace, compiling, _, jitted, *_ = map(harness.number, cells)
        parts[name] = [*imported, trace, compiling, max(0.0, jitted - trace - compiling)]
    return parts


def _picture(parts: dict[str, list[float]]) -> Figure:
    figure = harness.figure(6.4, 3.2)
    axes: Any = figure.subplots()
    names = list(parts)
    left = np.zeros(len(names))
    for part, (colour, hatch) in enumerate(LOOKS.values()):
        width = np.array([parts[name][part] for name in names])
        label = list(LOOKS)[part]
        axes.barh(names, width, 0.6, left=left, color=colour, hatch=hatch, edgecolor="w", linewidth=0.0, label=label)
        left += width
    for y, total in enumerate(left):
        axes.text(total + 0.08, y, f"{short(total)} s", va="center", fontsize=7.5)
    axes.set(xlabel="time from the start of the process (s), one core", xlim=(0.0, 1.12 * left.max()))
    axes.set_title(f"the first {names[1]} takes {short(left[1])} s, later calls microseconds")
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.legend(loc="upper right")
    return figure


if __name__ == "__main__":
    harness.run(main)
