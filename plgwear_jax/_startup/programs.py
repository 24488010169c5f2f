"""Programs for concrete numbers: `jax.jit`, until someone has them compiled ahead and kept.

The command line does so. A program is lowered at once, compiled in a thread, where XLA needs no Python, and kept in a
file. A later process loads it, and need not trace, lower and compile; JAX's own cache saves the last of these alone.

What a question asks only once is not compiled but run step by step (`stepwise`), if it has neither loops nor large
arrays.
"""

import contextlib
import functools
import hashlib
import os
import pickle
import platform
import zlib
from collections.abc import Callable, Iterator
from concurrent import futures
from concurrent.futures import Future, ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path
from typing import Any, ClassVar

import jax
import numpy as np
from jax.core import Tracer
from jax.custom_derivatives import SymbolicZero
from jax.experimental import serialize_executable
from jax.flatten_util import ravel_pytree

from plgwear_jax import _files
from plgwear_jax._startup import on
from plgwear_jax._startup.leaves import merged, selected
from plgwear_jax._startup.stepwise import Steps, stepwise

__all__ = [
    "Program",
    "ahead",
    "as_called",
    "on_a_processor",
    "program",
    "settle",
    "traced",
    "with_slopes",
]


def on_a_processor(level: int) -> dict[str, bool | int]:
    """Options of XLA.

    What answers one question is compiled once and runs for milliseconds: with less optimisation XLA compiles it in
    about half the time, and it runs as fast (`benchmarks/first_answer.py` has the times).
    """
    return {"xla_cpu_use_fusion_emitters": False, "xla_backend_optimization_level": level}


class Program:
    """A function that JAX compiles for concrete numbers.

    Args:
        function: What is compiled, for concrete numbers; of another program it is a part like any function.
        static: How many of its first arguments are no numbers; their reprs tell them apart.
        level: How much LLVM optimises: 1 for loops over whole matrices, which without it take ten times as long.
        once: Whether a question asks it only once.
    """

    def __init__(self, function: Callable[..., Any], static: int = 0, level: int = 0, once: bool = False):
        functools.update_wrapper(self, function)
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.function, self.static, self.level, self.once = function, static, level, once
        self.known: dict[Any, Steps | None] = {}

    @functools.cached_property
    def jitted(self) -> Any:
        """The function under `jax.jit`."""
        options = on_a_processor(self.level) if on("levels") and jax.default_backend() == "cpu" else None
        return jax.jit(self.function, static_argnums=range(self.static), compiler_options=options)

    @functools.cached_property
    def part(self) -> Any:
        """The function as a part of another program, which has options of its own."""
        return jax.jit(self.function, static_argnums=range(self.static))

    @functools.cached_property
    def slopes(self) -> "Program":
        """The function's result and its derivatives by each of its numbers, along a first axis."""

        def slopes(*arguments: Any) -> tuple[Any, Any]:
            flat, back = ravel_pytree(arguments[self.static :])
            at = functools.partial(self.function, *arguments[: self.static])
            found, along = jax.linearize(lambda flat: at(*back(flat)), flat)
            return found, jax.vmap(along)(jax.numpy.eye(flat.size, dtype=flat.dtype))

        functools.update_wrapper(slopes, self.function)
        slopes.__qualname__ += ".slopes"
        return Program(slopes, self.static)  # at the lowest level, where XLA takes half the time to compile it

    def lower(self, *arguments: Any) -> Any:
        """As of `jax.jit`."""
        return self.jitted.lower(*arguments)

    def __call__(self, *arguments: Any) -> Any:
        """The function's result."""
        if traced(arguments):
            return self.part(*arguments)
        if _compiler is None:
            steps = self.steps(arguments) if self.once and on("steps") else None
            return self.jitted(*arguments) if steps is None else steps(*arguments[self.static :])
        fixed, numbers = self.parted(arguments)
        run = _compiler.begun(self, fixed, numbers).result()
        return self.jitted(*arguments) if isinstance(run, Steps) and not run.worthwhile else run(*numbers)

    def steps(self, arguments: tuple[Any, ...]) -> Steps | None:
        """By which NumPy computes the program for arguments of this kind, if it should."""
        leaves, tree = jax.tree.flatten(arguments[self.static :])
        if any(getattr(leaf, "committed", False) for leaf in leaves):
            return None  # its results belong on a device
        shapes = tuple(
            (np.shape(leaf), getattr(leaf, "dtype", type(leaf)), getattr(leaf, "weak_type", False)) for leaf in leaves
        )
        kind = arguments[: self.static], tree, shapes, _double()
        if kind not in self.known:
            self.known[kind] = stepwise(self.jitted.trace(*arguments))
        found = self.known[kind]
        return found if found is not None and found.worthwhile else None

    def begin(self, *arguments: Any) -> None:
        """Compile for arguments of these shapes while something else is done, if programs are compiled ahead."""
        if _compiler is not None and on("ahead"):
            _compiler.begun(self, *self.parted(arguments))

    def parted(self, arguments: tuple[Any, ...]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """The static arguments, which come first, and all others as arrays."""
        return arguments[: self.static], jax.tree.map(np.asarray, arguments[self.static :])


def program(*, static: int = 0, level: int = 0, once: bool = False) -> Callable[[Callable[..., Any]], Program]:
    """Make a function a `Program`."""
    return lambda function: Program(function, static, level, once)


_NUMBER = np.zeros((), np.float32)  # to put it on a device compiles nothing


def traced(arguments: Any) -> bool:
    """Whether a call is part of another program: its numbers are traced, or known but asked for while JAX traces."""
    return any(isinstance(leaf, Tracer) for leaf in (*jax.tree.leaves(arguments), jax.device_put(_NUMBER)))


_FEW = 64  # numbers by each of which a program is differentiated; of a batch most of these derivatives would be zero


def with_slopes(wanted: Program) -> Callable[..., Any]:
    """A program of trees of floating numbers, whose derivatives at known numbers are one more program.

    XLA compiles that in a fourth of the time that it takes for what JAX makes of the program in reverse.
    """
    if not on("derivatives"):
        return wanted
    fixed = range(wanted.static)

    @functools.partial(jax.custom_jvp, nondiff_argnums=tuple(fixed))
    def tied(*arguments: Any) -> Any:
        return wanted(*arguments)

    def _rule(*arguments: Any) -> tuple[Any, Any]:
        *static, primals, tangents = arguments
        steps = jax.tree.leaves(tangents, is_leaf=lambda x: isinstance(x, SymbolicZero))
        leaves, tree = jax.tree.flatten(primals)
        moves = [not isinstance(step, SymbolicZero) for step in steps]
        if traced(primals) or sum(map(np.size, leaves)) > _FEW:

            def at(moving: list[Any]) -> Any:
                return wanted(*static, *tree.unflatten(merged(leaves, moves, moving)))

            return jax.jvp(at, (selected(leaves, moves),), (selected(steps, moves),))
        found, slopes = wanted.slopes(*static, *primals)
        steps = [step if move else np.zeros_like(x) for x, step, move in zip(leaves, steps, moves, strict=True)]
        return found, _along(slopes, ravel_pytree(steps)[0])

    tied.defjvp(_rule, symbolic_zeros=True)
    return tied


@jax.jit
def _along(slopes: Any, along: Any) -> Any:
    return jax.tree.map(lambda by: jax.numpy.tensordot(along, by, 1), slopes)


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


def settle() -> None:
    """Return when all that was begun is compiled and in its file. A process that ends waits for that by itself."""
    futures.wait(list(_Compiler.begun_here.values()))  # what is compiled hands in what is written
    futures.wait(list(_Compiler.writing))


class _Compiler:
    begun_here: ClassVar[dict[Any, Future[Any]]] = {}  # in this process
    writing: ClassVar[set[Future[None]]] = set()
    threads: ClassVar = ThreadPoolExecutor(2, "compiler")

    def __init__(self, store: "_Store | None"):
        self.store = store

    def begun(self, wanted: Program, fixed: tuple[Any, ...], numbers: tuple[Any, ...]) -> "Future[Any]":
        leaves, tree = jax.tree.flatten(numbers)
        shapes = tuple((leaf.shape, leaf.dtype) for leaf in leaves)
        kind = wanted, fixed, tree, shapes, _double()
        if kind not in self.begun_here:
            key = hashlib.sha256(repr((wanted.name, *kind[1:])).encode() + _house()).hexdigest()
            if self.store is not None and self.store.has(key):
                self.begun_here[kind] = self.threads.submit(self._loaded, key, wanted, fixed, numbers)
            else:
                self.begun_here[kind] = self._made(key, wanted, wanted.jitted.trace(*fixed, *numbers))
        return self.begun_here[kind]

    def _loaded(self, key: str, wanted: Program, fixed: tuple[Any, ...], numbers: tuple[Any, ...]) -> Any:
        known = self.store and self.store.read(key)
        if known is None:  # computed here: to wait for another thread might be to wait for ever
            traced = wanted.jitted.trace(*fixed, *numbers)
            known = self._stepwise(key, wanted, traced) or self._compiled(key, traced.lower())
        return known

    def _stepwise(self, key: str, wanted: Program, traced: Any) -> Steps | None:
        steps = stepwise(traced) if wanted.once and on("steps") else None
        if steps is not None:
            self._keep(key, steps)
        return steps

    def _made(self, key: str, wanted: Program, traced: Any) -> "Future[Any]":
        steps = self._stepwise(key, wanted, traced)
        if steps is None:
            return self.threads.submit(self._compiled, key, traced.lower())
        made: Future[Any] = Future()
        made.set_result(steps)
        return made

    def _compiled(self, key: str, lowered: Any) -> Any:
        compiled = lowered.compile()
        self._keep(key, compiled)
        return compiled

    def _keep(self, key: str, made: Any) -> None:
        if self.store is None:
            return
        try:
            written = self.threads.submit(self.store.write, key, made)
        except RuntimeError:  # Python ends, and waits for this thread alone
            self.store.write(key, made)
        else:
            self.writing.add(written)
            written.add_done_callback(self.writing.discard)


_compiler: _Compiler | None = None


def _double() -> bool:
    return jax.config.jax_enable_x64  # pyright: ignore[reportAttributeAccessIssue]


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
        "settings": sorted(
            item for item in os.environ.items() if item[0].startswith(("JAX_", "XLA_", "PLGWEAR_STARTUP"))
        ),
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
            known = pickle.loads(kept)
            if isinstance(known, Steps):
                return known
            algebra, *program = known
            if algebra:
                _begin_algebra()
            return serialize_executable.deserialize_and_load(*program)
        except Exception:  # whatever it is, the program is compiled instead
            return None

    def write(self, key: str, made: Any) -> None:
        """Keep a program."""
        try:
            if not isinstance(made, Steps):
                made = "lapack_" in made.as_text(), *serialize_executable.serialize(made)
            content = zlib.compress(pickle.dumps(made), level=1)
            self.folder.mkdir(mode=0o700, exist_ok=True)
            if self._makes_room(len(content)):
                _files.write(self.folder / key, lambda target: target.write_bytes(content))
        except Exception:  # a full disk, a device whose programs cannot be kept
            return

    def _makes_room(self, size: int) -> bool:
        files = []
        for file in self.folder.iterdir():
            with contextlib.suppress(FileNotFoundError):  # another thread or process has just finished or removed it
                about = file.stat()
                files.append((about.st_mtime, about.st_size, file))
        files.sort()
        left = self.most - size - sum(size for _, size, _ in files)
        for _, freed, file in files:
            if left >= 0:
                break
            file.unlink(missing_ok=True)
            left += freed
        return left >= 0
