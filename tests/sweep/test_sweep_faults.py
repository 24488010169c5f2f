"""Sweeps that are killed, run out of disk, lose their workers or are given many devices: the arrays are the same.

Bit for bit, that is; nothing that was finished is computed again, and nothing is left lying about.
"""

import contextlib
import functools
import json
import os
import random
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from marks import parametrize
from stores import into, refused
from sweep_process import KEYWORDS

from plgwear_jax.sweep import open_sweep

pytestmark = pytest.mark.faults

VARIABLES = [name.replace(".", "_") for name in KEYWORDS["quantities"]]
PROCESS = Path(__file__).with_name("sweep_process.py")
KILLS = 30
SEED = int(os.environ.get("PLGWEAR_SEED", "20240229"))
PATIENCE = 900.0  # s until something that should have happened has not


# --- processes ------------------------------------------------------------------------------------------------------


class Run(NamedTuple):
    """A sweep in a process of its own, and the file to which it tells what it does."""

    process: subprocess.Popen[bytes]
    file: Path

    @property
    def told(self):
        whole, _, _ = self.file.read_text().rpartition("\n")  # the last line may be half there
        return [json.loads(line) for line in whole.splitlines()]

    @property
    def done(self):
        return [line["done"] for line in self.told if "done" in line]

    def end(self):
        assert self.process.wait(PATIENCE) == 0, self.file.with_suffix(".err").read_text()
        return self.told

    def until(self, happened):
        """Whether that came before the end of the process."""
        while not happened():
            if self.process.poll() is not None:
                return bool(happened())  # it may have come just before
            time.sleep(0.001)
        return True

    def kill(self):
        """Kill it at once; whether it was still running."""
        running = self.process.poll() is None
        self.process.kill()
        return self.process.wait() != 0 and running


def command(**keywords):
    return [sys.executable, str(PROCESS), json.dumps(KEYWORDS | keywords)]


def as_users(**variables):
    """The environment of a process that compiles what it needs."""
    return {key: value for key, value in os.environ.items() if key != "JAX_COMPILATION_CACHE_DIR"} | variables


@pytest.fixture
def targets(tmp_path):
    """A folder with stores alone."""
    (tmp_path / "targets").mkdir()
    return tmp_path / "targets"


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The arrays of a sweep that nothing disturbs."""
    out = tmp_path_factory.mktemp("alone") / "alone.zarr"
    subprocess.run(command(out=str(out)), env=as_users(XLA_FLAGS=""), stdout=subprocess.DEVNULL, check=True)
    return arrays(out)


@pytest.fixture
def start(tmp_path):
    """Start a sweep in a process, with nothing compiled before."""
    runs = []

    def started(*, flags="", **keywords):
        file = tmp_path / f"run-{len(runs)}.out"
        with file.open("wb") as out, file.with_suffix(".err").open("wb") as err:
            process = subprocess.Popen(command(**keywords), stdout=out, stderr=err, env=as_users(XLA_FLAGS=flags))
        runs.append(Run(process, file))
        return runs[-1]

    yield started
    for run in runs:
        run.kill()


# --- what is there --------------------------------------------------------------------------------------------------


def arrays(path):
    """The arrays, bit for bit."""
    found = open_sweep(path)
    assert found.attrs["unfinished"] == 0
    return {str(name): found[name].values.tobytes() for name in found}


def finished(path):
    """Which chunks are there whole, each with what identifies its files and when they were written."""
    found = {}
    for file in (file for name in VARIABLES for file in (path / name / "c").glob("*/*[0-9]")):
        status, index = file.stat(), (int(file.parent.name), int(file.name))
        found.setdefault(index, []).append((status.st_ino, status.st_mtime_ns, status.st_size))
    return {index: files for index, files in found.items() if len(files) == len(VARIABLES)}


def litter(folder):
    """Whatever in a folder is not a finished part of a store."""
    beside = [str(path) for path in folder.iterdir() if path.suffix != ".zarr"]
    return beside + [str(path) for path in folder.rglob("*") if path.suffix in (".partial", ".part", ".lock")]


# --- killed ---------------------------------------------------------------------------------------------------------


def undisturbed(start, out):
    """How long a sweep starts, creates its store, compiles and runs, in seconds."""
    moments, run = [time.perf_counter()], start(out=str(out))
    for happened in (out.with_name(f".{out.name}.lock").exists, lambda: run.done, lambda: run.done[1:]):
        assert run.until(happened)
        moments.append(time.perf_counter())
    run.end()
    return np.diff([*moments, time.perf_counter()])


def test_a_killed_sweep_goes_on(start, targets):
    """Killed while it starts, creates the store, compiles, computes and writes, a sweep is resumed each time."""
    clock = undisturbed(start, targets / "undisturbed.zarr")
    _, creating, _, running = clock
    expected = arrays(targets / "undisturbed.zarr")
    chunks = len(finished(targets / "undisturbed.zarr"))
    assert chunks > 200
    rng = random.Random(SEED)
    kills = {"creating": 0, "anything": 0, "running": 0}
    hit = {"no store": 0, "no chunk": 0, "some chunks": 0}
    sweeps = 0
    while sum(kills.values()) < KILLS or not (all(hit.values()) or sweeps > KILLS):
        out = targets / f"killed-{sweeps}.zarr"
        sweeps += 1
        before = {}
        for kind in (*kills, "to its end"):
            run = start(out=str(out))
            ended = False
            if kind == "creating":
                ended = not run.until(out.with_name(f".{out.name}.lock").exists)
                time.sleep(rng.uniform(0.0, creating))
            elif kind == "anything":
                time.sleep(rng.uniform(0.0, clock.sum()))
            elif kind == "running":
                ended = not run.until(lambda run=run: run.done[1:])  # it is compiled
                time.sleep(rng.uniform(0.0, (1.0 - len(before) / chunks) * running))
            else:
                run.end()
            last = ended or not run.kill()
            there = finished(out)
            assert {index: there.get(index) for index in before} == before, f"{kind}: computed again, seed {SEED}"
            told, new = len(run.done[1:]), len(there) - len(before)
            if last:
                # so many chunks it says it computed, so many were missing
                assert told == new == chunks - len(before)
                break
            assert told <= new
            kills[kind] += 1
            hit["no store" if not out.exists() else "some chunks" if there else "no chunk"] += 1
            before = there
        assert last and arrays(out) == expected and litter(targets) == []
    print(f"{sum(kills.values())} kills in {sweeps} sweeps: {hit}; {clock}")
    assert all(hit.values()), hit


# --- on a cluster ---------------------------------------------------------------------------------------------------


class Cluster(NamedTuple):
    """A Dask scheduler and its workers, each a process with a file of what JAX compiles in it."""

    folder: Path
    processes: dict[str, subprocess.Popen[bytes]]

    def launch(self, name, module, *options):
        words = [sys.executable, "-m", f"distributed.cli.{module}", "--no-dashboard", *options]
        # As the sweeps beside which their results are put. A scheduler that saves memory takes the plan from workers
        # which are idle for a moment, as on a busy machine, and these compile it once more.
        environment = as_users(
            JAX_LOG_COMPILES="1", XLA_FLAGS="", DASK_DISTRIBUTED__SCHEDULER__ACTIVE_MEMORY_MANAGER__START="False"
        )
        with (self.folder / f"{name}.log").open("wb") as log:
            self.processes[name] = subprocess.Popen(words, stdout=log, stderr=subprocess.STDOUT, env=environment)

    def add(self, name):
        alone = "--no-nanny", "--nthreads", "1", "--local-directory", str(self.folder)
        self.launch(name, "dask_worker", self.address, "--name", name, *alone)

    @property
    def address(self):
        """That of the scheduler, once it has written its file whole."""
        for _ in range(int(PATIENCE / 0.01)):
            with contextlib.suppress(FileNotFoundError, json.JSONDecodeError):
                return json.loads((self.folder / "scheduler.json").read_text())["address"]
            time.sleep(0.01)
        raise TimeoutError

    def compiled(self, name):
        return (self.folder / f"{name}.log").read_text().count("Finished XLA compilation")

    def kill(self, name):
        process = self.processes.pop(name)
        process.kill()
        process.wait()


@pytest.fixture
def cluster(tmp_path):
    """A scheduler without workers."""
    pytest.importorskip("distributed")
    folder = tmp_path / "cluster"
    folder.mkdir()
    found, told = Cluster(folder, {}), str(folder / "scheduler.json")
    at = "--port", "0", "--host", "127.0.0.1", "--scheduler-file", told, "--idle-timeout", str(PATIENCE)
    found.launch("scheduler", "dask_scheduler", *at)
    yield found
    for name in tuple(found.processes):
        found.kill(name)


def test_a_cluster_loses_a_worker_and_gets_another(start, cluster, targets, alone):
    """Of three workers one is killed in mid-run and one is added: the arrays are those without a cluster."""
    out = targets / "cluster.zarr"
    for name in ("a", "b", "c"):
        cluster.add(name)
    run = start(out=str(out), scheduler=cluster.address)
    assert run.until(lambda: run.done and all(cluster.compiled(name) for name in ("a", "b", "c")))
    cluster.add("d")
    cluster.kill("a")
    there = len(finished(out))
    assert run.until(lambda: cluster.compiled("d")), "the sweep ended before the new worker had a part in it"
    told = run.end()
    assert there < len(finished(out)) and arrays(out) == alone and litter(targets) == []
    assert [line["compiled"] for line in told if "compiled" in line] == [[]]  # all is computed by the workers
    assert {name: cluster.compiled(name) for name in "abcd"} == dict.fromkeys("abcd", 1)
    assert run.done[-1] == KEYWORDS["k"][2] * KEYWORDS["phi"][2]


def test_a_cluster_whose_scheduler_dies(start, cluster, targets, alone):
    """It ends in a line that says so; without a cluster the sweep goes on to the same arrays."""
    out = targets / "cluster.zarr"
    cluster.add("a")
    run = start(out=str(out), scheduler=cluster.address)
    assert run.until(lambda: len(run.done) > 10)
    cluster.kill("scheduler")
    assert run.process.wait(PATIENCE) == 1
    last = run.file.with_suffix(".err").read_text().splitlines()[-1]
    assert last.startswith("plgwear_jax.sweep.store.SweepError: "), last
    cluster.kill("a")
    before = finished(out)
    start(out=str(out)).end()
    assert {index: files for index, files in finished(out).items() if index in before} == before
    assert arrays(out) == alone and litter(targets) == []


# --- many devices ---------------------------------------------------------------------------------------------------


@parametrize("wide", [True, False], ids=["float64", "float32"])
@parametrize("chunk, k, phi", [(1000, 131, 97), (200_000, 2001, 301)], ids=["small_chunks", "large_chunks"])
def test_eight_devices_compute_what_one_does(start, tmp_path, wide, chunk, k, phi):
    """Bit for bit, with chunks that eight devices cannot share evenly, and one program for all of them."""
    quantities = ["wear_volume", "wear_volume.dk", "optimal_exponent.k"]
    sizes = {"k": [-0.95, 0.95, k], "phi": [0.01, 0.99, phi], "chunk": chunk}
    found = {}
    for count in (1, 8):
        file = tmp_path / f"{count}.npz"
        flags = f"--xla_force_host_platform_device_count={count}"
        told = start(flags=flags, arrays=str(file), quantities=quantities, wide=wide, **sizes).end()
        assert told[-1] == {"compiled": ["jit(<lambda>)"], "devices": count}
        with np.load(file) as loaded:
            found[count] = {name: (loaded[name].dtype, loaded[name].tobytes()) for name in loaded}
    assert {dtype for dtype, _ in found[1].values()} == {np.dtype(float if wide else np.float32)}
    assert found[8] == found[1]


# --- disks ----------------------------------------------------------------------------------------------------------

small = functools.partial(into, quantities=KEYWORDS["quantities"])


@pytest.fixture
def disk(tmp_path):
    """A disk of a size of its own: mounted, and with `again` mounted with other options."""
    folder = tmp_path / "disk"
    folder.mkdir()

    def mount(options, *, again=False):
        options = f"remount,{options}" if again else options
        try:
            command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        except FileNotFoundError:
            pytest.skip("there is no command mount here")
        if done.returncode and not again:
            pytest.skip(f"nothing can be mounted here: {done.stderr.strip()}")
        assert done.returncode == 0, done.stderr
        return folder

    yield mount
    subprocess.run(["umount", str(folder)], capture_output=True, check=False)


@parametrize("size", ["size=4k", "size=20k", "nr_inodes=2", "nr_inodes=6", "nr_inodes=12"])
def test_no_room_to_begin(disk, size):
    """A sweep that cannot even be created leaves nothing, and begins once there is room."""
    folder = disk(size)
    assert refused(small, folder / "map.zarr") == f"{folder / 'map.zarr'}: cannot be written: No space left on device"
    assert list(folder.iterdir()) == []
    disk("size=64m,nr_inodes=1000", again=True)
    small(folder / "map.zarr")
    assert small(folder / "map.zarr").attrs["unfinished"] == 0


@parametrize("size", ["size=40k", "size=80k", "nr_inodes=26"])
def test_a_disk_that_is_full(disk, tmp_path, size):
    """What was written stays, and with room again the sweep goes on to the same arrays."""
    folder = disk(size)
    out = folder / "map.zarr"
    line, before = refused(small, out), finished(out)
    assert 0 < len(before) < 12
    assert line == (
        f"{out}: cannot be written: No space left on device; {len(before)} of 12 chunks are finished, "
        "and the same sweep continues with the others"
    )
    assert litter(folder) == []
    assert "No space left" in refused(small, out)
    disk("size=64m,nr_inodes=1000", again=True)
    small(out)
    after = finished(out)
    assert {index: after[index] for index in before} == before
    small(tmp_path / "roomy.zarr")
    assert arrays(out) == arrays(tmp_path / "roomy.zarr")
    assert litter(folder) == []
