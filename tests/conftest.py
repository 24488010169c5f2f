"""Settings that all tests share."""

import atexit
import ctypes
import functools
import gc
import importlib.machinery
import importlib.metadata
import os
import shutil
import sys
import tempfile
from pathlib import Path

import psutil
import pytest

# Most of the suite waits for XLA, and asks what a program answers, not how fast it is: with less optimisation it waits
# less. What accuracy and kernels are measured by is compiled as users have it, by `functions.AS_USERS`, and so are the
# long checks, as none of this is set where the environment says something else than which instructions to use.
FLAGS, INSTRUCTIONS = os.environ.get("XLA_FLAGS"), "--xla_cpu_max_isa="
if FLAGS is None or (FLAGS and all(flag.startswith(INSTRUCTIONS) for flag in FLAGS.split())):
    cheap = "--xla_backend_optimization_level=0"
    if tuple(map(int, importlib.metadata.version("jaxlib").split(".")[:2])) < (0, 11):
        cheap += " --xla_cpu_use_fusion_emitters=false"  # a later XLA ends the process at this word
    os.environ["XLA_FLAGS"] = f"{cheap} {FLAGS or ''}".strip()
# Matrices here are small. The threads of OpenBLAS would spend up to fifty times as long waiting for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# All processes of a run share byte code, in the folders __pycache__: compiling the sources of tests and library takes
# each of them seconds.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False


class AsInstalled(importlib.machinery.PathFinder):
    """Finds packages with a plugin for pytest as they are: pytest would rewrite the assertions in all their modules."""

    @classmethod
    def find_spec(cls, fullname, path=None, target=None):
        return super().find_spec(fullname, path) if fullname.partition(".")[0] in ("hypothesis", "zarr") else None


sys.meta_path.insert(0, AsInstalled)

# Compilation is what most tests wait for. What one of them has compiled serves the others of this run, whichever
# process they are in, and the processes that they start. The folder begins empty and goes with the run.
FOLDER, SECONDS = "JAX_COMPILATION_CACHE_DIR", "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"

# JAX does not write its files whole. A process that has read half a file says so and compiles: neither is an error.
HALVES = {"PYTHONWARNINGS": "ignore:Error reading persistent compilation cache"}


def pytest_configure(config):
    if not hasattr(config, "workerinput"):
        os.environ |= {FOLDER: tempfile.mkdtemp(prefix="plgwear-"), SECONDS: "0.05"} | HALVES


@functools.cache
def prepare():
    """Import and set what tests need, only in the processes that run them."""
    import jax
    from hypothesis import HealthCheck, settings

    # To take apart at the end all that tracing has made takes seconds.
    atexit.register(gc.freeze)
    # The caller's choice, and here the tests are the caller; the library itself never touches it.
    jax.config.update("jax_enable_x64", True)

    settings.register_profile("default", deadline=None, max_examples=25, suppress_health_check=[HealthCheck.too_slow])
    settings.register_profile("long", parent=settings.get_profile("default"), max_examples=2000)
    settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))


def pytest_collectstart():
    prepare()


# Modules that trace the same programs stand next to each other and share a process; so do the tests of every other
# module. Notebooks, which have processes of their own, come when most of what they ask for is compiled.
TOGETHER = [
    ["test_accuracy", "test_border", "test_transforms", "test_digits"],
    ["test_optimise", "test_amplitudes", "test_search"],
    ["test_contract", "test_solutions"],
]
LAST = ["test_docs", "test_notebooks"]


def place(item):
    name = item.path.stem
    for number, modules in enumerate(TOGETHER):
        if name in modules:
            return number - len(TOGETHER), modules.index(name)
    return (1, LAST.index(name)) if name in LAST else (0, 0)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """With `--dist loadfile` a process takes all modules of a group, and groups in the order of `place`."""
    if config.getoption("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class ByGroup(LoadFileScheduling):
        def _split_scope(self, nodeid):
            name = Path(super()._split_scope(nodeid)).stem
            return next((modules[0] for modules in TOGETHER if name in modules), name)

    config.option.loadscopereorder = False
    return ByGroup(config, log)


def pytest_collection_modifyitems(items):
    items.sort(key=place)
    # Tracing makes many objects that stay. Looking through all of them for garbage took a third of its time.
    gc.freeze()
    gc.set_threshold(100_000, 50, 1000)


def pytest_unconfigure(config):
    if not hasattr(config, "workerinput"):
        shutil.rmtree(os.environ[FOLDER], ignore_errors=True)


@pytest.fixture(autouse=True)
def programs_not_kept():
    """What a command line in this process has asked for ends with its test."""
    yield
    if "plgwear_jax._core.startup.programs" in sys.modules:
        sys.modules["plgwear_jax._core.startup.programs"].keep_in(None)


@pytest.fixture(autouse=True, scope="module")
def memory_that_two_processes_share():
    """Programs of earlier modules are forgotten where they fill the memory; the folder of this run still has them."""
    yield
    if psutil.Process().memory_info().rss > 3e9:
        sys.modules["jax"].clear_caches()
        gc.collect()
        if sys.platform == "linux":
            ctypes.CDLL(None).malloc_trim(0)  # else half of it stays with the process, which would soon clear again


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder of its own, in which the test runs."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def seed():
    """A seed for random points, fresh on every day unless PLGWEAR_SEED fixes it; printed with every failure."""
    return int(os.environ.get("PLGWEAR_SEED", "20240229"))
