"""Pins the process to one core when it is imported; PLGWEAR_CORES=all leaves it all of them.

Imported before jax, whose thread pool is as large as the number of cores that it finds.
"""

import contextlib
import os
import sys
from collections.abc import Iterator

AFFINITY = hasattr(os, "sched_setaffinity")  # Linux has it, macOS and Windows have not


def _pin() -> None:
    if "jax" in sys.modules:
        raise RuntimeError("import cores (or harness) before jax: its threads are there already")
    if AFFINITY:
        os.sched_setaffinity(0, AVAILABLE[-1:])  # the first one is the busiest with what else the machine does
    else:
        os.environ["NPROC"] = "1"  # what XLA reads instead
        os.environ["XLA_FLAGS"] = os.environ.get("XLA_FLAGS", "") + " --xla_cpu_multi_thread_eigen=false"


@contextlib.contextmanager
def released() -> Iterator[None]:
    """The processes that are started here have all cores again."""
    if AFFINITY:
        before = os.sched_getaffinity(0)
        os.sched_setaffinity(0, AVAILABLE)
        yield
        os.sched_setaffinity(0, before)
    else:
        yield


AVAILABLE = sorted(os.sched_getaffinity(0)) if AFFINITY else list(range(os.cpu_count() or 1))
PINNED = os.environ.get("PLGWEAR_CORES") != "all"
if PINNED:
    _pin()
USED = f"{'1' if PINNED else len(AVAILABLE)} of {len(AVAILABLE)} cores" + (
    "" if AFFINITY or not PINNED else ", one thread, not pinned to a core"
)
