"""Programs for concrete numbers: `jax.jit`, until someone has them compiled ahead and kept.

The command line does so. A program is lowered at once, compiled in a thread, where XLA needs no Python, and kept in a
file. A later process loads it, and need not trace, lower and compile; JAX's own cache saves the last of these alone.
"""

import contextlib
import functools
import hashlib
import os
import pickle
import platform
import zlib
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path
from typing import Any, ClassVar

import jax
import numpy as np
from jax.core import Tracer
from jax.experimental import serialize_executable

from plgwear_jax._core import files

__all__ = ["Program", "ahead", "as_called", "program"]

# What answers one question is compiled once and runs for milliseconds: with less optimisation XLA compiles it in about
# half the time, and it runs as fast (`benchmarks/first_answer.py` has the times).
_ON_A_PROCESSOR = {"xla_cpu_use_fusion_emitters": False, "xla_backend_optimization_level": 0}
_HEAVY = {"xla_cpu_use_fusion_emitters": False}


class Program:
    """A function that JAX compiles for concrete numbers.

    Args:
        function: What is compiled, for concrete numbers; of another program it is a part like any function.
        static: How many of its first arguments are no numbers; their reprs tell them apart.
        heavy: Whether it runs so long that less optimisation would be felt.
    """

    def __init__(self, function: Callable[..., Any], static: int = 0, heavy: bool = False):
        functools.update_wrapper(self, function)
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.function, self.static, self.heavy = function, static, heavy

    @functools.cached_property
    def jitted(self) -> Any:
        """The function under `jax.jit`."""
        options = (_HEAVY if self.heavy else _ON_A_PROCESSOR) if jax.default_backend() == "cpu" else None
        return jax.jit(self.function, static_argnums=range(self.static), compiler_options=options)

    def lower(self, *arguments: Any) -> Any:
        """As of `jax.jit`."""
        return self.jitted.lower(*arguments)

    def __call__(self, *arguments: Any) -> Any:
        """The function's result."""
        if any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves(arguments)):
            return self.function(*arguments)  # part of another program, which has options of its own
        if _compiler is None:
            return self.jitted(*arguments)
        fixed, numbers = self.parted(arguments)
        return _compiler.begun(self, fixed, numbers).result()(*numbers)

    def begin(self, *arguments: Any) -> None:
        """Compile for arguments of these shapes while something else is done, if programs are compiled ahead."""
        if _compiler is not None:
            _compiler.begun(self, *self.parted(arguments))

    def parted(self, arguments: tuple[Any, ...]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """The static arguments, which come first, and all others as arrays."""
        return arguments[: self.static], jax.tree.map(np.asarray, arguments[self.static :])


def program(*, static: int = 0, heavy: bool = False) -> Callable[[Callable[..., Any]], Program]:
    """Make a function a `Program`."""
    return lambda function: Program(function, static, heavy)


def ahead(folder: Path | None = None, most: int = 0) -> None:
    """From now on compile ahead, and keep what was compiled.

    JAX's own cache has to be off: a program that it has read cannot be kept again.

    Args:
        folder: Where to; whoever writes there can have this process run anything. None keeps nothing.
        most: How many bytes to keep there.
    """
    global _compiler
    _compiler = _Compiler(None if folder is None else _Store(folder, most))


def as_called() -> None:
    """From now on leave it to `jax.jit` again."""
    global _compiler
    _compiler = None


class _Compiler:
    begun_here: ClassVar[dict[Any, Future[Any]]] = {}  # in this process
    threads: ClassVar = ThreadPoolExecutor(2, "compiler")

    def __init__(self, store: "_Store | None"):
        self.store = store

    def begun(self, wanted: Program, fixed: tuple[Any, ...], numbers: tuple[Any, ...]) -> "Future[Any]":
        leaves, tree = jax.tree.flatten(numbers)
        shapes = tuple((leaf.shape, leaf.dtype) for leaf in leaves)
        kind = wanted, fixed, tree, shapes, jax.config.jax_enable_x64  # pyright: ignore[reportAttributeAccessIssue]
        if kind not in self.begun_here:
            key = hashlib.sha256(repr((wanted.name, *kind[1:])).encode() + _house()).hexdigest()
            if self.store is not None and self.store.has(key):
                work = functools.partial(self._loaded, key, wanted, fixed, numbers)
            else:
                work = functools.partial(self._compiled, key, wanted.lower(*fixed, *numbers))
            self.begun_here[kind] = self.threads.submit(work)
        return self.begun_here[kind]

    def _loaded(self, key: str, wanted: Program, fixed: tuple[Any, ...], numbers: tuple[Any, ...]) -> Any:
        known = self.store and self.store.read(key)
        return self._compiled(key, wanted.lower(*fixed, *numbers)) if known is None else known

    def _compiled(self, key: str, lowered: Any) -> Any:
        compiled = lowered.compile()
        if self.store is not None:
            self.threads.submit(self.store.write, key, compiled)
        return compiled


_compiler: _Compiler | None = None


@functools.cache
def _house() -> bytes:
    """What tells programs of the same name and shapes apart: their source, and what makes and runs them."""
    hashed = hashlib.sha256()
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        hashed.update(file.read_bytes())
    device = jax.devices()[0]
    told = {
        "packages": [version(name) for name in ("jax", "jaxlib", "optax", "numpy")],
        "device": [device.device_kind, jax.device_count(), device.client.platform_version],
        "machine": [platform.node(), platform.machine(), *_features()],  # a home may be that of several machines
        "settings": sorted(item for item in os.environ.items() if item[0].startswith(("JAX_", "XLA_"))),
    }
    hashed.update(repr(told).encode())
    return hashed.digest()


def _features() -> Iterator[str]:
    """What the processor can do, where Linux tells."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            yield from sorted({line for line in file if line.startswith(("flags", "Features", "model name"))})
    except (OSError, UnicodeDecodeError):
        return


@functools.cache
def _begin_algebra() -> None:
    """Have JAX look for LAPACK, which it does when it lowers a decomposition; a program that is loaded would crash."""
    jax.jit(jax.lax.linalg.cholesky).lower(np.eye(1, dtype=np.float32))


# --- what is kept -----------------------------------------------------------------------------------------------------


class _Store:
    """A file a program; those not used for the longest time make room. Nothing wrong with it is an error."""

    def __init__(self, folder: Path, most: int):
        self.folder, self.most = folder, most

    def has(self, key: str) -> bool:
        """Whether a program is there, whole or not."""
        return (self.folder / key).exists()

    def read(self, key: str) -> Any:
        """A program, or None."""
        file = self.folder / key
        try:
            kept = zlib.decompress(file.read_bytes())  # which checks a sum
            with contextlib.suppress(OSError):  # a disk that is read only
                os.utime(file)
            algebra, *program = pickle.loads(kept)
            if algebra:
                _begin_algebra()
            return serialize_executable.deserialize_and_load(*program)
        except Exception:  # whatever it is, the program is compiled instead
            return None

    def write(self, key: str, compiled: Any) -> None:
        """Keep a program."""
        try:
            whole = "lapack_" in compiled.as_text(), *serialize_executable.serialize(compiled)
            content = zlib.compress(pickle.dumps(whole), level=1)
            self.folder.mkdir(mode=0o700, exist_ok=True)
            if self._makes_room(len(content)):
                files.write(self.folder / key, lambda target: target.write_bytes(content))
        except Exception:  # a full disk, a device whose programs cannot be kept
            return

    def _makes_room(self, size: int) -> bool:
        files = sorted((file.stat().st_mtime, file.stat().st_size, file) for file in self.folder.iterdir())
        left = self.most - size - sum(size for _, size, _ in files)
        for _, freed, file in files:
            if left >= 0:
                break
            file.unlink(missing_ok=True)
            left += freed
        return left >= 0
