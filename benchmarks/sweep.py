"""Sweeps: what labels, files and a cluster cost besides the kernel, the memory they need, and the price of scale.

Rates are medians of rounds in which all programs run in turn, once each is compiled; besides the time on the wall
stands that of the processor, of all threads together. Memory is the peak of a fresh process above its peak after a tiny
sweep. Whatever is measured runs in a process of its own on all cores, and on a GPU only where that is said.

The last table extrapolates. What is measured is said there, and all else stands below as constants.
"""

import contextlib
import functools
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import cores
import harness  # before jax: pins the process
import jax
import numpy as np
import typer
from harness import short

from plgwear_jax import fretting
from plgwear_jax.sweep import open_sweep, sweep

# --- assumptions of the price ---

ALL = 10**12  # points
CORE_HOUR = 0.04  # USD, one core of a rented node
GPU_HOUR = 3.0  # USD, one GPU with its share of a host
GB_MONTH = 0.02  # USD, object storage or a file system
NODE_CORES = 64  # cores of a node; as fast as those here, each with its share of the bandwidth
NODES = 100
NODE_DISK = 2e9  # bytes/s, the local disk of one node
SHARED_DISK = 50e9  # bytes/s, the file system that 100 nodes share
GPU_BANDWIDTH = 2.0e12  # bytes/s of its memory
GPU_FLOPS = 10e12  # float64 operations/s, before any loss
GPU_SHARE = 0.5  # of these two is reached
GPU_LINK = 20e9  # bytes/s from GPU to host
KEEPERS = 1  # threads of a sweep that pack and write

SIDE = 1024  # of a chunk, at most: as sweep chooses them by default
GOAL = 0.6  # of the kernel's rate in memory is reached on disk
MEMORY = 1024.0  # MiB, at most


# --- one process ----------------------------------------------------------------------------------------------------


def grid(points: int) -> dict[str, np.ndarray]:
    """Even axes of a square with about so many points."""
    side = math.isqrt(points)
    return {"k": np.linspace(-0.95, 0.95, side), "phi": np.linspace(0.005, 0.995, side)}


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    """A temporary folder for stores, which may be large."""
    with tempfile.TemporaryDirectory(prefix="plgwear-") as name:
        yield Path(name)


def kernel_in_chunks(axes: Mapping[str, np.ndarray]) -> int:
    """The kernel on chunk after chunk, results dropped; how many points that were."""
    k, phi = axes["k"], axes["phi"]
    size = -(-k.size // -(-k.size // SIDE))
    starts = [min(first, k.size - size) for first in range(0, k.size, size)]
    for row in starts:
        for column in starts:
            _outer(k[row : row + size], phi[column : column + size]).block_until_ready()
    return (len(starts) * size) ** 2


@jax.jit
def _outer(k: jax.Array, phi: jax.Array) -> jax.Array:
    return fretting.wear_volume(k[:, None], phi)


def swept(axes: Mapping[str, np.ndarray], **keywords: Any) -> Any:
    return sweep("wear_volume", k=axes["k"], phi=axes["phi"], **keywords)


def clocks(call: Callable[[], Any]) -> tuple[float, float]:
    """Seconds on the wall and of the processor; the result is thrown away before the next call."""
    start = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - start[0], time.process_time() - start[1]


def rates(points: int, rounds: int) -> dict[str, Any]:
    """Seconds a point of the kernel and of sweeps, each round; sizes on disk and reading back."""
    axes = grid(points)
    count = axes["k"].size ** 2
    with folder() as where:
        store = where / "map.zarr"
        calls: dict[str, Callable[[], Any]] = {
            "kernel": functools.partial(kernel_in_chunks, axes),
            "whole": lambda: _outer(axes["k"], axes["phi"]).block_until_ready(),
            "memory": lambda: swept(axes),
            "zarr": lambda: swept(axes, out=store),
            "read": lambda: open_sweep(store)["wear_volume"].values,
        }
        computed = dict.fromkeys(calls, count) | {"kernel": kernel_in_chunks(axes)}
        taken: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
        first: dict[str, float] = {}
        for turn in range(rounds + 1):
            for name, call in calls.items():  # "read" reads what was just written
                if name == "zarr":
                    shutil.rmtree(store, ignore_errors=True)
                wall, processor = clocks(call)
                if turn:
                    taken[name].append((wall / computed[name], processor / computed[name]))
                else:
                    first[name] = wall
        files = [file for file in (store / "wear_volume" / "c").rglob("*") if file.is_file()]
        analysis: Any = _outer.lower(axes["k"], axes["phi"]).compile().cost_analysis()
        return {
            "points": count,
            "taken": taken,
            "first": first["zarr"],
            "files": len(files),
            "bytes": sum(file.stat().st_size for file in files),
            "flops": analysis.get("flops", 0.0) / count,
            "disk": file_system(where),
            "cores": len(cores.AVAILABLE),
            "device": jax.devices()[0].device_kind,
        }


def file_system(path: Path) -> str:
    """What kind of file system a folder lies on, as far as Linux tells."""
    mounts = Path("/proc/mounts")
    if not mounts.exists():
        return "an unknown file system"
    lines = [line.split() for line in mounts.read_text().splitlines()]
    over = [(len(line[1]), line[2]) for line in lines if path.resolve().is_relative_to(line[1])]
    return max(over, default=(0, "an unknown file system"))[1]


def peak() -> float:
    """The most memory that this process has had, in MiB."""
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return used / 2**20 if sys.platform == "darwin" else used / 2**10


def memory(points: int) -> dict[str, float]:
    """MiB of a process that sweeps into Zarr, and after a tiny sweep."""
    with folder() as where:
        swept(grid(100), out=where / "tiny.zarr")
        idle = peak()
        swept(grid(points), out=where / "map.zarr")
        return {"idle": idle, "peak": peak()}


def designs(count: int, rounds: int) -> dict[str, Any]:
    """Seconds an optimal exponent, each round."""
    phi = np.linspace(0.005, 0.995, count)
    taken = [clocks(lambda: sweep("optimal_exponent.k", phi=phi)) for _ in range(rounds + 1)][1:]
    return {"count": count, "taken": [(wall / count, processor / count) for wall, processor in taken]}


# --- clusters -------------------------------------------------------------------------------------------------------


@contextlib.contextmanager
def cluster(workers: int, where: Path) -> Iterator[str]:
    """The address of a scheduler with so many workers, each a process with one thread for XLA."""
    told = where / "scheduler.json"
    program = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--host", "127.0.0.1"]
    command = [*program, "--no-dashboard", "--scheduler-file", str(told), "--idle-timeout", "300"]  # if nobody is left
    processes = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)]
    try:
        while not (told.exists() and told.read_text()):
            time.sleep(0.05)
        address = json.loads(told.read_text())["address"]
        program = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--no-dashboard"]
        flags = os.environ.get("XLA_FLAGS", "") + " --xla_cpu_multi_thread_eigen=false"
        for _ in range(workers):
            command = [*program, "--nthreads", "1", "--local-directory", str(where)]
            environment = os.environ | {"XLA_FLAGS": flags, "NPROC": "1"}
            processes.append(
                subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            )
        _wait_for(address, workers)
        yield address
    finally:
        for process in processes:
            process.kill()  # they hold nothing, and some wait for each other when they are asked to end
        for process in processes:
            process.wait()


def _wait_for(address: str, workers: int) -> None:
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(workers, timeout=60)


def on_clusters(workers: Sequence[int], points: int, tasks: int, rounds: int) -> list[dict[str, float]]:
    """Seconds a point and a task of a single point, by the number of workers, 0 for this process itself."""
    axes, few = grid(points), {name: values[: math.isqrt(tasks)] for name, values in grid(10**6).items()}
    asked = {"point": (axes, SIDE**2 // 16), "task": (few, 1)}
    found = []
    for count in (0, *workers):
        with folder() as where, cluster(count, where) if count else contextlib.nullcontext() as scheduler:
            each: dict[str, float] = {"workers": count}
            for name, (values, chunk) in asked.items():
                seconds = []
                for turn in range(rounds + 1):  # in the first one every worker compiles
                    out = where / f"{name}-{turn}.zarr"
                    call = functools.partial(swept, values, out=out, scheduler=scheduler, chunk=chunk)
                    seconds.append(clocks(call)[0] / values["k"].size ** 2)
                each[name] = float(np.median(seconds[1:]))
        found.append(each)
    return found


# --- all of it ------------------------------------------------------------------------------------------------------

MEASURED: dict[str, Callable[..., Any]] = {
    "rates": rates,
    "memory": memory,
    "designs": designs,
    "on_clusters": on_clusters,
}


def in_new_process(what: str, *arguments: Any, gpu: bool = False) -> Any:
    """A measurement in a process of its own with all cores."""
    cores.release()
    command = [sys.executable, __file__, "--worker", json.dumps([what, *arguments])]
    environment = os.environ | {"PLGWEAR_CORES": "all"} | ({} if gpu else {"JAX_PLATFORMS": "cpu"})
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def main(
    quick: harness.Quick = False,
    out: harness.Out = harness.DEFAULT_OUT,
    worker: Annotated[str, typer.Option(hidden=True)] = "",
) -> None:
    """Rates, memory, sizes, scaling and the price of sweeps."""
    if worker:
        what, *arguments = json.loads(worker)
        print(json.dumps(MEASURED[what](*arguments)))
        return
    report = harness.Report("sweep", out, "Sweeps", quick)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    points, rounds = 4 * 10**6 if quick else 10**8, 1 if quick else 3
    found = in_new_process("rates", points, rounds)
    report.print(f"All of {found['cores']} cores; stores on {found['disk']}.\n")
    if load > 0.5:
        report.print(f"Do not quote these times: the load of the machine was {load:.1f} before.\n")
    _rates(report, found)
    on_gpu = None
    if any(device.platform != "cpu" for device in jax.devices()):
        on_gpu = in_new_process("rates", points, rounds, gpu=True)
        report.print(f"On {on_gpu['device']}:")
        _rates(report, on_gpu)
    peaks = {count: in_new_process("memory", count) for count in sorted({points, points if quick else 10**7})}
    _memory(report, peaks)
    if not quick:
        _designs(report, in_new_process("designs", 200_000, rounds))
        size = ((1, 2, 4), 10**7, 400)
        _clusters(report, in_new_process("on_clusters", *size, rounds), size[1], found["cores"])
    _price(report, found, on_gpu)
    ratio = _median_ratio(found, "zarr", "whole")
    above = [(f"peak memory above idle at {n:.0e} points, MiB", MEMORY, _above(p), False) for n, p in peaks.items()]
    harness.goals(report, [("rate into Zarr, of the kernel's in memory", GOAL, ratio, True), *above])
    report.close()


# --- the tables -----------------------------------------------------------------------------------------------------

PROGRAMS = {
    "kernel": "the kernel, chunk by chunk, dropped",
    "whole": "the kernel, one call, in memory",
    "memory": "sweep in memory",
    "zarr": "sweep into Zarr",
    "read": "reading that back",
}


def _median(found: Mapping[str, Any], name: str, clock: int = 0) -> float:
    """Seconds a point, on the wall or of the processor."""
    return float(np.median([pair[clock] for pair in found["taken"][name]]))


def _median_ratio(found: Mapping[str, Any], name: str, to: str) -> float:
    """The rate of a program as a share of that of another, round by round."""
    pairs = zip(found["taken"][name], found["taken"][to], strict=True)
    return float(np.median([other[0] / own[0] for own, other in pairs]))


def _rates(report: harness.Report, found: Mapping[str, Any]) -> None:
    rows = []
    for name, text in PROGRAMS.items():
        wall, processor = _median(found, name), _median(found, name, 1)
        rows.append([text, short(1e-6 / wall), short(wall * 1e9), short(processor * 1e9), short(processor / wall)])
    columns = ("", "10^6 points/s", "ns a point", "processor, ns a point", "cores busy")
    report.table(f"wear_volume, float64, {found['points']:,} points", columns, rows)
    ratios = [f"{_median_ratio(found, 'zarr', name):.0%} of that of {PROGRAMS[name]}" for name in list(PROGRAMS)[:3]]
    report.print(f"The rate into Zarr is {', '.join(ratios)}.")
    raw = 8 * found["points"]
    report.print(
        f"The first sweep into Zarr took {found['first']:.2f} s with compilation. It holds {found['files']} files, "
        f"{found['bytes'] / 1e6:.0f} MB,\n{found['bytes'] / raw:.0%} of {raw / 1e6:.0f} MB; reading back, from the "
        f"page cache, gives {8e-9 / _median(found, 'read'):.2f} GB/s.\n"
    )


def _above(process: Mapping[str, float]) -> float:
    return process["peak"] - process["idle"]


def _memory(report: harness.Report, peaks: Mapping[int, Mapping[str, float]]) -> None:
    rows = [[f"{n:,}", short(8 * n / 2**20), *map(short, (p["idle"], p["peak"], _above(p)))] for n, p in peaks.items()]
    report.table("Memory of a sweep into Zarr, MiB", ("points", "result", "idle", "peak", "above idle"), rows)
    report.print()


def _designs(report: harness.Report, found: Mapping[str, Any]) -> None:
    wall, processor = (float(np.median(clock)) for clock in zip(*found["taken"], strict=True))
    report.print(
        f"optimal_exponent.k at {found['count']:,} amplitudes: {short(1.0 / wall)} a second, "
        f"{short(wall * 1e6)} us each, {short(processor * 1e6)} us of the processor.\n"
    )


def _clusters(report: harness.Report, found: Sequence[Mapping[str, float]], points: int, available: int) -> None:
    rows, one, alone = [], found[1]["point"], found[0]["task"]
    for each in found:
        workers, speed = int(each["workers"]), one / each["point"]
        row = [str(workers) if workers else "none", short(1e-6 / each["point"])]
        row += [short(speed), f"{speed / workers:.0%}"] if workers else ["", ""]
        rows.append([*row, short(1e3 * each["task"]), short(1e3 * (each["task"] - alone)) if workers else ""])
    columns = ("workers", "10^6 points/s", "times one", "efficiency", "ms a task of one point", "of these Dask's")
    report.table(f"On a Dask cluster, {points:,} points, one thread a worker", columns, rows)
    report.print(
        f"The workers share {available} cores with the scheduler and the process that asked. Up to as many workers "
        "as cores the table\nshows what it costs to distribute, with more only that it does no harm. Of networks, and "
        "of file systems that nodes\nshare, it says nothing; a task should last much longer than what Dask takes for "
        "it.\n"
    )


def _price(report: harness.Report, found: Mapping[str, Any], on_gpu: Mapping[str, Any] | None) -> None:
    core = 1.0 / (_median(found, "zarr") * found["cores"])  # points/s of one core, files included
    keeping = max(_median(found, "zarr", 1) - _median(found, "kernel", 1), 1e-10)  # s of one core
    stored = found["bytes"] / found["points"]
    if on_gpu is None:
        gpu = GPU_SHARE * min(GPU_FLOPS / max(found["flops"], 1.0), GPU_BANDWIDTH / 8.0)
        about = (
            f"No GPU was measured: {GPU_SHARE:.0%} of {GPU_FLOPS / 1e12:.0f} Tflop/s at {found['flops']:.0f} flops a "
            f"point, or of {GPU_BANDWIDTH / 1e12:.1f} TB/s at 8 bytes a point, whichever is slower,"
        )
    else:
        gpu, about = 1.0 / _median(on_gpu, "kernel"), f"The kernel was measured on {on_gpu['device']};"
    places = {
        f"here, {found['cores']} cores": (found["cores"] * core, {}, NODE_DISK, found["cores"] * CORE_HOUR),
        f"one node, {NODE_CORES} cores": (NODE_CORES * core, {}, NODE_DISK, NODE_CORES * CORE_HOUR),
        f"{NODES} such nodes": (NODES * NODE_CORES * core, {}, SHARED_DISK, NODES * NODE_CORES * CORE_HOUR),
        "one GPU": (gpu, {"the link": GPU_LINK / 8.0, "packing": KEEPERS / keeping}, NODE_DISK, GPU_HOUR),
    }
    rows = []
    for place, (computing, others, disk, price) in places.items():
        limits = {"computing": computing, **others, "the disk": disk / stored}
        slowest = min(limits, key=lambda what: limits[what])
        hours = ALL / limits[slowest] / 3600.0
        numbers = (3600.0 * computing, 3600.0 * limits[slowest], hours, hours * price)
        rows.append([place, *map(short, (*numbers, computing * stored / 1e9)), slowest])
    computed = ("points an hour, if only computed", "GB/s to store then")
    columns = ("", computed[0], "points an hour", "hours", "USD", computed[1], "limited by")
    report.table(f"What {ALL:.0e} points of wear_volume would take: an extrapolation", columns, rows)
    files = ALL / (found["points"] / found["files"])
    size = ALL * stored
    report.print(
        f"Measured: points/s of {found['cores']} cores into Zarr, {stored:.2f} bytes stored a point, and "
        f"{keeping * 1e9:.2f} ns of the processor to pack and\nwrite one. Assumed: all cores as fast as these, "
        f"{CORE_HOUR} USD a core hour, {GPU_HOUR} USD a GPU hour; disks that take\n{NODE_DISK / 1e9:.0f} GB/s in a "
        f"node and {SHARED_DISK / 1e9:.0f} GB/s for all nodes.\n{about}\n{GPU_LINK / 1e9:.0f} GB/s to the host, and "
        f"{KEEPERS} threads that pack there.\n"
        f"The {8 * ALL / 1e12:.0f} TB are stored as {size / 1e12:.1f} TB in {files:.1e} files, for "
        f"{size / 1e9 * GB_MONTH:,.0f} USD a month at {GB_MONTH} USD a GB.\n"
    )


if __name__ == "__main__":
    harness.run(main)
