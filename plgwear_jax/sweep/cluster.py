"""A sweep on a Dask cluster: one task is a few chunks, which the worker itself writes to the store.

Dask decides who computes what and when, and gives the tasks of a worker that died to others.
"""

import threading
from collections.abc import Generator, Sequence
from pathlib import Path

import distributed
import numpy as np
from distributed import CancelledError
from distributed.comm.core import CommClosedError

from plgwear_jax._core.words import one_line
from plgwear_jax._version import __version__

from .plan import SweepPlan
from .store import SweepError, SweepStore

_TASKS = 20_000  # at most so many: a scheduler holds some kilobytes for each
_PATIENCE = "10s"  # for the scheduler to answer
_UNFIT = "cluster: a worker cannot take part"
_compiling = threading.Lock()


def run_on_cluster(plan: SweepPlan, store: SweepStore, numbers: Sequence[int], scheduler: str) -> Generator[int]:
    """Have the chunks of these numbers computed by the workers of a Dask scheduler; the points of each task that ended.

    Raises:
        SweepError: No scheduler answers, or a worker could not do its part.
    """
    if not numbers:
        return
    batches = np.array_split(numbers, min(len(numbers), _TASKS))
    try:
        client = distributed.Client(scheduler, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError):
        raise SweepError(f"scheduler {one_line(scheduler)}: no Dask scheduler answers there") from None
    with client:
        # As a task of its own the plan is sent once to each worker, and again if they all die.
        shared = client.submit(lambda plan: plan, plan, pure=False)
        tasks = client.map(
            _compute_and_write, batches, plan=shared, path=str(store.path), version=__version__, pure=False
        )
        try:
            for task in distributed.as_completed(tasks, loop=client.loop):
                yield task.result()
                task.release()
        except distributed.KilledWorker:
            raise SweepError("cluster: the workers that tried the same chunks died, one after the other") from None
        except (CommClosedError, CancelledError):
            raise SweepError(f"scheduler {one_line(scheduler)}: does not answer any more") from None
        except ModuleNotFoundError as error:
            raise SweepError(f"{_UNFIT}: {error}") from None
        finally:
            client.cancel(tasks)


def _compute_and_write(numbers: Sequence[int], plan: SweepPlan, path: str, version: str) -> int:
    """Compute chunks and write them, on a worker; returns how many points they hold."""
    if version != __version__:
        raise SweepError(f"{_UNFIT}: it has plgwear_jax {__version__}, not {version}")
    if not Path(path).is_dir():
        raise SweepError(f"{_UNFIT}: it does not see {path}: out must lie on a file system that all share")
    store = SweepStore(path, plan)
    # A task is repeated if the worker that had finished it died.
    missing = [number for number in numbers if not store.has(number)]
    if missing:
        with _compiling:  # the threads of a worker share the plan, and so its program
            _ = plan.program
        for number, variables in plan.computed(missing):
            store.write(number, variables)
    return plan.size(numbers)
