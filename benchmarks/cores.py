"""Pins the process to one core when it is imported; PLGWEAR_CORES=all leaves it all of them.

Imported before jax, whose thread pool is as large as the number of cores that it finds.
"""

import os
import sys

__all__ = ["AVAILABLE", "USED", "release"]

AFFINITY = hasattr(os, "sched_setaffinity")  # Linux has it, macOS and Windows have not


def _available() -> list[int]:
    return sorted(os.sched_getaffinity(0)) if AFFINITY else list(range(os.cpu_count() or 1))


def _pin() -> None:
    if "jax" in sys.modules:
        raise RuntimeError("import cores (or harness) before jax: its threads are there already")
    if AFFINITY:
        os.sched_setaffinity(0, AVAILABLE[-1:])  # the first one is the busiest with what else the machine does
    else:
        os.environ["NPROC"] = "1"  # what XLA reads instead
        os.environ["XLA_FLAGS"] = os.environ.get("XLA_FLAGS", "") + " --xla_cpu_multi_thread_eigen=false"


def release() -> None:
    """Let the processes that are started from here on have all cores again."""
    if AFFINITY:
        os.sched_setaffinity(0, AVAILABLE)


AVAILABLE = _available()
PINNED = os.environ.get("PLGWEAR_CORES") != "all"
if PINNED:
    _pin()
USED = f"{'1' if PINNED else len(AVAILABLE)} of {len(AVAILABLE)} cores" + (
    "" if AFFINITY or not PINNED else ", one thread, not pinned to a core"
)
