"""Cost against size, 1 to 10^8 points, and the distance to what the machine could do, on one core and on all.

The limit of the wear volume is made of measured ceilings. The optimised HLO, compiled without fusion so that nothing
stands in it twice, says what operations a point needs: each kind of transcendental function and of division at its
measured cost, everything else at the cost of a fused multiply-add, at best a multiplication and an addition together.
If moving the arguments in and the result out at the bandwidth of a stream takes longer, that is the limit. Ceilings are
the fastest of several runs of loops without dependences, whose cost is the slope between a short and a long one.

`--device gpu` does the same on a GPU.
"""

import json
import os
import re
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import cores
import harness  # before jax: pins the process
import jax
import jax.numpy as jnp
import numpy as np
import typer
from harness import Timing, interleave, short
from jax import Array, lax
from matplotlib.figure import Figure

from plgwear_jax import fretting
from plgwear_jax.plots.style import COLOURS

DTYPES = ("float64", "float32")
SHARE = 0.7  # of the free memory may be used
REFERENCE = 1_000_000  # points at which the time is compared with the limit
SIZES = [10**n for n in range(9)]
COSTLY: dict[str, Callable[[Array], Array]] = {
    "divide": lambda x: 1.0 / x,
    "exponential": jnp.exp,
    "exponential-minus-one": jnp.expm1,
    "log": jnp.log,
    "log-plus-one": jnp.log1p,
    "power": lambda x: lax.pow(x, x),
    "sqrt": jnp.sqrt,
    "rsqrt": lax.rsqrt,
    "tanh": jnp.tanh,
    "sine": jnp.sin,
    "cosine": jnp.cos,
}
ALWAYS = ("divide", "exponential", "log")  # measured even if nothing needs them
FREE = {
    *("parameter", "constant", "broadcast", "bitcast", "tuple", "get-tuple-element", "copy", "reshape", "iota"),
    *("fusion", "while", "call"),
}


# --- what a point needs ---------------------------------------------------------------------------------------------


def operations(function: Callable[..., Array], dtype: str) -> Counter[str]:
    """Operations a point by kind, of two arguments."""
    count = 1_000_003  # a number that stands for nothing else
    with jax.default_device(jax.devices("cpu")[0]):
        argument = jax.ShapeDtypeStruct((count,), dtype)
        lowered = jax.jit(function).lower(argument, argument)
        text = lowered.compile(compiler_options={"xla_disable_hlo_passes": "fusion"}).as_text()
    assert text is not None
    return _count(_computations(text), "ENTRY", str(count))


def _computations(text: str) -> dict[str, list[str]]:
    """The instructions of each computation; that of the entry is called ENTRY."""
    found: dict[str, list[str]] = {}
    lines: list[str] = []
    for line in text.splitlines():
        if head := re.match(r"(ENTRY )?%?([\w.-]+) .*\{$", line):
            found["ENTRY" if head[1] else head[2]] = lines = []
        elif " = " in line:
            lines.append(line)
    return found


def _count(computations: dict[str, list[str]], name: str, count: str) -> Counter[str]:
    total: Counter[str] = Counter()
    for line in computations[name]:
        found = re.search(r" = (.*?) ([a-z][a-z0-9-]*)\(", line)
        if not found:
            continue
        shape, kind = found.groups()
        if kind not in FREE and f"[{count}" in shape:
            total[kind] += 1
        if called := re.search(r"(?:calls|body|to_apply)=%?([\w.-]+)", line):
            trips = re.search(r'"known_trip_count":\{"n":"(\d+)"', line) if kind == "while" else None
            for inner, times in _count(computations, called[1], count).items():
                total[inner] += times * (int(trips[1]) if trips else 1)
    return total


def simple(needs: Counter[str]) -> int:
    """Instructions besides the costly ones, if every multiplication finds an addition to be fused with."""
    fused = min(needs["multiply"], needs["add"] + needs["subtract"])
    return sum(times for kind, times in needs.items() if kind not in COSTLY) - fused


# --- what the machine can do ----------------------------------------------------------------------------------------


def fused_multiply_adds(depth: int, x: Array) -> Array:
    """Eight independent chains, so that the next step of one need not wait for the last."""
    chains = [x + 0.01 * n for n in range(8)]
    for _ in range(depth):
        chains = [chain * x + 0.5 for chain in chains]
    return sum(chains[1:], chains[0])


def several(function: Callable[[Array], Array], times: int, x: Array) -> Array:
    """The sum of `times` independent values of a function, each with a multiplication and an addition."""
    return sum((function(x * (1.0 + 0.01 * n)) for n in range(1, times)), function(x))


def ceilings(kinds: Sequence[str], dtype: str, count: int, stream: int) -> dict[str, float]:
    """Nanoseconds an element for each kind of operation, and for a byte of a stream."""
    x = jnp.linspace(0.5, 0.9, count, dtype=dtype)
    multiply_add = _slope(fused_multiply_adds, x, 16, 64) / 8.0
    found = {"fused multiply-add": multiply_add}
    for kind in kinds:
        found[kind] = _slope(partial(several, COSTLY[kind]), x, 4, 12) - multiply_add
    return found | {"byte": _stream(stream, dtype)}


def _slope(loop: Callable[[int, Array], Array], x: Array, few: int, many: int) -> float:
    calls = {times: partial(jax.jit(partial(loop, times)), x) for times in (few, many)}
    fastest = {times: float(seconds.min()) for times, seconds in interleave(calls, 9).items()}
    return (fastest[many] - fastest[few]) / (many - few) / x.size * 1e9


def _stream(count: int, dtype: str) -> float:
    """Reading and writing an array in place: new memory would cost page faults besides."""
    scale = jax.jit(lambda x: x * 1.0001, donate_argnums=0)
    x = scale(jnp.ones(count, dtype))
    fastest = np.inf
    for _ in range(7):
        start = time.perf_counter()
        x = jax.block_until_ready(scale(x))
        fastest = min(fastest, time.perf_counter() - start)
    return fastest / (2 * x.nbytes) * 1e9


# --- one process ----------------------------------------------------------------------------------------------------


def available_bytes() -> float:
    """Free memory of the device, as far as that can be known."""
    device = jnp.zeros(()).devices().pop()
    if device.platform != "cpu":
        stats = device.memory_stats() or {}
        return stats.get("bytes_limit", np.inf) - stats.get("bytes_in_use", 0)
    kibibytes = re.search(r"MemAvailable:\s*(\d+) kB", _read("/proc/meminfo"))
    return int(kibibytes[1]) * 1024 if kibibytes else 4e9


def _read(path: str) -> str:
    return Path(path).read_text() if os.path.exists(path) else ""


def cost_over_size(sizes: Sequence[int], dtypes: Sequence[str]) -> dict[str, dict[int, list[float] | str]]:
    """Nanoseconds a point in each round, or why there are none, by dtype and size."""
    found: dict[str, dict[int, list[float] | str]] = {dtype: {} for dtype in dtypes}
    for count in sizes:
        calls = {}
        for dtype in dtypes:
            argument = jax.ShapeDtypeStruct((count,), dtype)
            compiled = jax.jit(fretting.wear_volume).lower(argument, argument).compile()
            memory: Any = compiled.memory_analysis()
            needed = memory.argument_size_in_bytes + 2 * memory.output_size_in_bytes + memory.temp_size_in_bytes
            if needed > SHARE * (free := available_bytes()):
                gigabytes = f"{needed / 1e9:.1f} GB, more than {SHARE:.0%} of the {free / 1e9:.1f} GB that are free"
                found[dtype][count] = f"skipped: they need {gigabytes}"
                continue
            k, phi = (jnp.resize(jnp.asarray(x, dtype), (count,)) for x in harness.bulk(min(count, REFERENCE), 0))
            calls[dtype] = partial(compiled, k, phi)
            del k, phi
        rounds = 15 if count <= REFERENCE else 5 if count <= 10 * REFERENCE else 3
        for dtype, seconds in interleave(calls, rounds).items():
            found[dtype][count] = (seconds / count * 1e9).tolist()
    return found


def eager() -> float:
    """Microseconds of a call with Python floats."""
    taken = interleave({"": lambda: fretting.wear_volume(0.3, 0.2)}, 15, 2e-2)
    return float(np.median(taken[""])) * 1e6


def worst_error(dtype: str, sample: int) -> float:
    points = harness.head(harness.bulk(sample, sample), sample, dtype)
    exact = harness.exact_wear_volume(points, 0)
    return float(harness.errors(fretting.wear_volume(*points), exact, (0,))[0].max())


def measure_here(device: str, sizes: Sequence[int], dtypes: Sequence[str], sample: int) -> dict[str, Any]:
    """All that one process measures, as JSON can hold it."""
    jax.config.update("jax_default_device", jax.devices(device)[0])
    on_gpu = jnp.zeros(()).devices().pop().platform != "cpu"
    count = 2**24 if on_gpu else 2**16 * (1 if cores.PINNED else len(cores.AVAILABLE))
    found: dict[str, Any] = {
        "machine": harness.machine(),
        "eager": eager(),
        "ceilings": {},
        "needs": {},
        "analysis": {},
    }
    found["errors"] = {dtype: worst_error(dtype, sample) for dtype in dtypes} if sample else {}
    for dtype in dtypes:
        needs = operations(fretting.wear_volume, dtype)
        kinds = [kind for kind in COSTLY if kind in needs or kind in ALWAYS]
        found["needs"][dtype] = needs
        found["ceilings"][dtype] = ceilings(kinds, dtype, count, 2**26)
        argument = jax.ShapeDtypeStruct((REFERENCE,), dtype)
        analysis: Any = jax.jit(fretting.wear_volume).lower(argument, argument).compile().cost_analysis()
        found["analysis"][dtype] = {
            what: analysis.get(what, 0.0) / REFERENCE for what in ("flops", "transcendentals", "bytes accessed")
        }
    found["sizes"] = cost_over_size(sizes, dtypes)
    found["taken_by_others"] = harness.taken_by_others()
    return found


def in_new_process(how_many: str, *arguments: Any) -> dict[str, Any]:
    """`measure_here` on one core or on all: how many there are is settled before jax starts."""
    cores.release()
    command = [sys.executable, __file__, "--worker", json.dumps(arguments)]
    environment = os.environ | {"PLGWEAR_CORES": how_many}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


# --- the tables -----------------------------------------------------------------------------------------------------


def limit(found: dict[str, Any], dtype: str) -> tuple[float, list[list[str]]]:
    """Nanoseconds a point at the ceilings, and the sum line by line."""
    costs, needs = found["ceilings"][dtype], Counter(found["needs"][dtype])
    terms = [(kind, needs[kind], costs[kind]) for kind in COSTLY if kind in needs]
    terms.append(("fused multiply-add and other", simple(needs), costs["fused multiply-add"]))
    computing = sum(times * cost for _, times, cost in terms)
    rows = [[kind, str(times), short(cost), short(times * cost)] for kind, times, cost in terms]
    size = 3 * np.dtype(dtype).itemsize
    moving = size * costs["byte"]
    rows += [["all operations", "", "", short(computing)]]
    rows += [["bytes in and out", str(size), short(costs["byte"]), short(moving)]]
    return max(computing, moving), rows


def main(
    quick: harness.Quick = False,
    out: harness.Out = harness.DEFAULT_OUT,
    device: Annotated[str, typer.Option(help="cpu or gpu.")] = "cpu",
    worker: Annotated[str, typer.Option(hidden=True)] = "",
) -> None:
    """Time a point over the number of points, and the distance to the machine's limits."""
    if worker:
        print(json.dumps(measure_here(*json.loads(worker))))
        return
    if device != "cpu" and device not in {one.platform for one in jax.devices()}:
        raise typer.BadParameter(f"jax sees no {device} here")
    sizes, dtypes, sample = ([1, 100, 10_000, REFERENCE], DTYPES[:1], 64) if quick else (SIZES, DTYPES, 1000)
    name = "size" if device == "cpu" else f"size_{device}"
    report = harness.Report(name, out, "Cost against size", quick)
    found = {}
    for n, how_many in enumerate(("1", "all") if device == "cpu" else ("all",)):
        where = {"1": "one core", "all": "all cores"}[how_many] if device == "cpu" else device.upper()
        if quick and device == "cpu":  # one core, as this process has; all of them are left out
            found[where] = json.loads(json.dumps(measure_here(device, sizes, dtypes, sample)))
            break
        found[where] = in_new_process(how_many, device, sizes, dtypes, 0 if n else sample)
    _tables(report, found, sizes)
    report.warn_if_shared(max(process["taken_by_others"] for process in found.values()))
    report.close(_picture(found))


def _tables(report: harness.Report, found: dict[str, dict[str, Any]], sizes: Sequence[int]) -> None:
    first = next(iter(found))
    series = [(where, dtype) for where in found for dtype in found[where]["sizes"]]
    report.table(
        "wear_volume, ns a point (quartiles)",
        ("points", *(f"{where}, {dtype}" for where, dtype in series)),
        [
            [f"{count:,}", *(_cell(found[where]["sizes"][dtype][str(count)]) for where, dtype in series)]
            for count in sizes
        ],
    )
    for where, dtype in series:
        for count, result in found[where]["sizes"][dtype].items():
            if isinstance(result, str):
                report.print(f"{where}, {dtype}, {int(count):,} points {result}")
    for dtype, error in found[first]["errors"].items():
        report.print(f"worst relative error in {dtype}: {error:.1e}")
    report.print(f"a call with Python floats: {found[first]['eager']:.1f} us ({first})")
    distances = {}
    for where, dtype in series:
        report.print()
        bound, rows = limit(found[where], dtype)
        measured = _median(
            found[where]["sizes"][dtype].get(str(REFERENCE), found[where]["sizes"][dtype][str(sizes[-1])])
        )
        distances[where, dtype] = measured / bound
        rows += [["the limit", "", "", short(bound)], [f"measured at {REFERENCE:,} points", "", "", short(measured)]]
        rows += [["times the limit", "", "", short(measured / bound)]]
        report.table(f"The limit, {where}, {dtype}", ("", "a point", "ns each", "ns a point"), rows)
        report.print(_ceiling_line(found[where], dtype))
    slower = [(f"times the limit, {where}, {dtype}", 3.0, d, False) for (where, dtype), d in distances.items()]
    harness.goals(report, [*slower, ("a call with Python floats, us", 60.0, found[first]["eager"], False)])


def _ceiling_line(found: dict[str, Any], dtype: str) -> str:
    costs, analysis = found["ceilings"][dtype], found["analysis"][dtype]
    flops, bandwidth = 2.0 / costs["fused multiply-add"], 1.0 / costs["byte"]
    each = ", ".join(f"{kind} {costs[kind]:.2f} ns" for kind in ALWAYS)
    return (
        f"Ceilings: fused multiply-add {flops:.1f} Gflop/s, stream {bandwidth:.1f} GB/s, {each}.\n"
        f"As compiled, with fusion, a point takes {analysis['flops']:.0f} flops, {analysis['transcendentals']:.0f} "
        f"transcendentals and {analysis['bytes accessed']:.0f} bytes to and from memory or cache."
    )


def _median(result: list[float] | str) -> float:
    return float("nan") if isinstance(result, str) else float(np.median(result))


def _cell(result: list[float] | str) -> str:
    if isinstance(result, str):
        return "-"
    timing = Timing(np.array(result))
    return f"{short(timing.median)} ({timing.quartiles})"


def _picture(found: dict[str, dict[str, Any]]) -> Figure:
    figure = harness.figure(6.4, 4.0)
    axes = figure.subplots()
    for (where, results), style in zip(found.items(), ("-", "--"), strict=False):
        for dtype, colour, marker in zip(results["sizes"], COLOURS, "os", strict=False):
            at = [(int(n), _median(x)) for n, x in results["sizes"][dtype].items() if not isinstance(x, str)]
            label = f"{where}, {dtype}"
            axes.plot(*zip(*at, strict=True), style, color=colour, marker=marker, markersize=3, label=label)
            axes.axhline(limit(results, dtype)[0], color=colour, linestyle=style, linewidth=0.6, alpha=0.8)
            words = f"the processor's limit: {label}"
            axes.annotate(
                words, (1.0, limit(results, dtype)[0]), (0, 2), textcoords="offset points", color=colour, fontsize=7
            )
    axes.set(xscale="log", yscale="log", xlabel="points", ylabel="time per point (ns)", title="wear_volume")
    axes.legend()
    return figure


if __name__ == "__main__":
    harness.run(main)
