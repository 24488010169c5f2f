"""Sweeps: what labels and files cost besides the kernel, and the memory they need.

Rates are medians of rounds in which all programs run in turn, once each is compiled; besides the time on the wall
stands that of the processor, of all threads together. Memory is the peak of a fresh process above its peak after a tiny
sweep. Whatever is measured runs in a process of its own on all cores.
"""

import math
import resource
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cores
import harness  # before jax: pins the process
import jax
import numpy as np
from harness import Part, Report, in_new_process, short

from plgwear_jax import fretting
from plgwear_jax.sweep import open_sweep, sweep

SIDE = 1024  # of a chunk, at most: as sweep chooses them by default
PROGRAMS = {
    "kernel": "the kernel, chunk by chunk, dropped",
    "whole": "the kernel, one call, in memory",
    "memory": "sweep in memory",
    "zarr": "sweep into Zarr",
    "read": "reading that back",
}


def grid(points: int) -> dict[str, np.ndarray]:
    """Even axes of a square with about so many points."""
    side = math.isqrt(points)
    return {"k": np.linspace(-0.95, 0.95, side), "phi": np.linspace(0.005, 0.995, side)}


@jax.jit
def outer(k: jax.Array, phi: jax.Array) -> jax.Array:
    return fretting.wear_volume(k[:, None], phi)


def in_chunks(k: np.ndarray, phi: np.ndarray) -> None:
    """The kernel on chunk after chunk, results dropped."""
    size = k.size // -(-k.size // SIDE)
    for row in range(0, k.size, size):
        for column in range(0, k.size, size):
            outer(
                *(x[min(first, k.size - size) :][:size] for x, first in ((k, row), (phi, column)))
            ).block_until_ready()


@contextmanager
def store() -> Iterator[Path]:
    """A place for a store, which may be large."""
    with tempfile.TemporaryDirectory(prefix="plgwear-") as name:
        yield Path(name) / "map.zarr"


def swept(axes: Mapping[str, np.ndarray], **keywords: Any) -> Any:
    return sweep("wear_volume", k=axes["k"], phi=axes["phi"], **keywords)


def rates(points: int, rounds: int) -> dict[str, Any]:
    """Seconds a point of each program on the wall and of the processor, by round, and the size on disk."""
    axes = grid(points)
    with store() as where:
        calls: dict[str, Callable[[], Any]] = {
            "kernel": lambda: in_chunks(**axes),
            "whole": lambda: outer(**axes).block_until_ready(),
            "memory": lambda: swept(axes),
            "zarr": lambda: swept(axes, out=where),
            "read": lambda: open_sweep(where)["wear_volume"].values,
        }
        taken: dict[str, list[tuple[float, ...]]] = {name: [] for name in calls}
        for _ in range(rounds + 1):
            for name, call in calls.items():  # "read" reads what was just written
                if name == "zarr":
                    shutil.rmtree(where, ignore_errors=True)
                start = time.perf_counter(), time.process_time()
                call()
                ends = time.perf_counter(), time.process_time()
                taken[name].append(
                    tuple((end - begin) / axes["k"].size ** 2 for begin, end in zip(start, ends, strict=True))
                )
        files = [file.stat().st_size for file in (where / "wear_volume" / "c").rglob("*") if file.is_file()]
        return {name: each[1:] for name, each in taken.items()} | {"files": len(files), "bytes": sum(files)}


def memory(points: int) -> tuple[float, float]:
    """MiB that a process has had at most after a tiny sweep, and after one into Zarr."""
    found = []
    for count in (100, points):
        with store() as where:
            swept(grid(count), out=where)
        used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        found.append(used / 2**20 if sys.platform == "darwin" else used / 2**10)
    return found[0], found[1]


def sweeps(report: Report, quick: bool) -> None:
    """Rates, memory, scaling."""
    points, rounds = (4 * 10**6, 1) if quick else (10**8, 3)
    found = in_new_process(rates, points, rounds)
    rows = []
    for name, text in PROGRAMS.items():
        wall, processor = np.median(found[name], axis=0)
        rows.append([text, *map(short, (1e-6 / wall, wall * 1e9, processor * 1e9, processor / wall))])
    columns = "", "10^6 points/s", "ns a point", "processor, ns a point", "cores busy"
    report.table(f"wear_volume, float64, {points:,} points, {len(cores.AVAILABLE)} cores", columns, rows)
    report.print(f"The store holds {found['files']} files, {found['bytes'] / points:.2f} bytes a point.")
    used = [(n, *in_new_process(memory, n)) for n in sorted({points, min(points, 10**7)})]
    rows = [[f"{n:,}", *map(short, (8 * n / 2**20, idle, peak, peak - idle))] for n, idle, peak in used]
    report.table("Memory of a sweep into Zarr, MiB", ("points", "result", "idle", "peak", "above idle"), rows)
    ratio = np.median([whole[0] / zarr[0] for whole, zarr in zip(found["whole"], found["zarr"], strict=True)])
    report.print(f"The rate into Zarr is {ratio:.0%} of that of the kernel in memory; 60 % is wanted.")


if __name__ == "__main__":
    harness.run({"sweep": Part("Sweeps", [sweeps])}, [rates, memory])
