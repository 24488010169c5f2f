"""Programs for concrete numbers: `jax.jit`, but for what makes the first answer of a process come late.

Programs are first run step by step (`stepwise`), and compiled, with less optimisation, once they have taken half as
long as the compiler. The command line has programs kept in files: a later process loads one, and need not trace, lower
and compile; JAX's own cache saves the last of these alone. `benchmarks/startup.py` measures what each of these buys.
"""

import contextlib
import functools
import hashlib
import math
import os
import pickle
import platform
import zlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jax
import numpy as np
from jax.core import Tracer
from jax.custom_derivatives import SymbolicZero
from jax.experimental import serialize_executable

from plgwear_jax import _files
from plgwear_jax._startup import on
from plgwear_jax._startup.operations import UnknownError
from plgwear_jax._startup.stepwise import PATIENCE, Steps, stepwise


def compiler_options(level: int = 0) -> dict[str, bool | str | int | float]:
    """Options for `jax.jit` with which XLA compiles a program of your own two to three times sooner.

    The library compiles its own programs with these options. What answers a few questions runs for milliseconds and
    needs no more optimisation; a program that runs for minutes should be compiled without them.

    Args:
        level: How much LLVM optimises, 0 to 3. Runs over cycles have loops over matrices, which take several times as
            long at 0 as at 1.

    Returns:
        The options; none where JAX does not compute on a processor, whose compilers do not know them.

    Raises:
        ValueError: `level` is not one of 0 to 3.

    Examples:
        >>> import jax
        >>> from plgwear_jax import compiler_options, fretting
        >>> quick = jax.jit(jax.value_and_grad(fretting.wear_volume), compiler_options=compiler_options())
        >>> print(f"{quick(0.0, 0.5)[0]:.4f}")
        0.1322
    """
    if level not in (0, 1, 2, 3):
        raise ValueError(f"level = {level!r} is not one of 0, 1, 2 and 3")
    if jax.default_backend() != "cpu":
        return {}
    return {"xla_cpu_use_fusion_emitters": False, "xla_backend_optimization_level": level}


class Program:
    """A function that JAX compiles for concrete numbers.

    Args:
        function: What is compiled, for concrete numbers; of another program it is a part like any function.
        static: How many of its first arguments are no numbers; their reprs tell them apart.
        level: How much LLVM optimises: 1 for loops over whole matrices, which without it take ten times as long.
        slopes: The same for the program's derivatives at known numbers.
    """

    def __init__(self, function: Callable[..., Any], static: int = 0, level: int = 0, slopes: int = 0):
        functools.update_wrapper(self, function)
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.function, self.static, self.level, self.slopes = function, static, level, slopes
        self.known: dict[Any, Any] = {}  # what runs it, by the kind of its arguments

    @functools.cached_property
    def jitted(self) -> Any:
        """The function under `jax.jit`."""
        options = compiler_options(self.level) if on("levels") else None
        return jax.jit(self.function, static_argnums=range(self.static), compiler_options=options)

    @functools.cached_property
    def part(self) -> Any:
        """The function as a part of another program, which has options of its own."""
        return jax.jit(self.function, static_argnums=range(self.static))

    @functools.cached_property
    def along(self) -> "Program":
        """(The result, its derivatives along directions, with a first axis).

        The first argument tells which leaves of the numbers move, the last one has the directions of these.
        """

        def along(moves: tuple[bool, ...], *arguments: Any) -> tuple[Any, Any]:
            *given, directions = arguments
            leaves, tree = jax.tree.flatten(tuple(given[self.static :]))

            def at(moving: list[Any]) -> Any:
                return self.function(*given[: self.static], *tree.unflatten(merged(leaves, moves, moving)))

            def one(direction: list[Any]) -> Any:
                # Not `jax.linearize`, which takes JAX twice as long to trace.
                return jax.jvp(at, (selected(leaves, moves),), (direction,))

            return jax.vmap(one, out_axes=(None, 0))(directions)

        functools.update_wrapper(along, self.function)
        along.__qualname__ += ".along"
        return Program(along, 1 + self.static, self.slopes)

    def lower(self, *arguments: Any) -> Any:
        """As of `jax.jit`."""
        return self.jitted.lower(*arguments)

    def __call__(self, *arguments: Any) -> Any:
        """The function's result."""
        if any(isinstance(leaf, Moved) for leaf in jax.tree.leaves(arguments[self.static :])):
            return _followed(self, arguments[: self.static], arguments[self.static :])
        if traced(arguments):
            return self.part(*arguments)
        if _store is not None:
            arguments = *arguments[: self.static], *jax.tree.map(np.asarray, arguments[self.static :])
        run = self.steps(arguments) if _store is None else self.kept(_store, arguments)
        if run is None or (isinstance(run, Steps) and not run.worthwhile):
            return self.jitted(*arguments)
        with contextlib.suppress(UnknownError):
            return run(*arguments[self.static :])
        return self.jitted(*arguments)

    def steps(self, arguments: tuple[Any, ...]) -> Steps | None:
        """By which NumPy computes the program for arguments of this kind, if it should."""
        if any(map(_committed, jax.tree.leaves(arguments))):
            return None  # the results of committed numbers belong on their device
        kind = self._kind(arguments)
        if kind not in self.known:
            self.known[kind] = self._stepwise(self.jitted.trace(*arguments))
        found = self.known[kind]
        return found if found is not None and found.worthwhile else None

    def kept(self, store: "_Store", arguments: tuple[Any, ...]) -> Any:
        """What runs the program for arrays of this kind, from its file if there is one."""
        kind = store, *self._kind(arguments)
        if kind not in self.known:
            key = hashlib.sha256(repr((self.name, *kind[1:])).encode() + _house()).hexdigest()
            run = store.read(key)
            if run is None:
                traced = self.jitted.trace(*arguments)
                run = self._stepwise(traced, _KEPT) or store.compiled(traced.lower())
                store.write(key, run)
            self.known[kind] = run
        return self.known[kind]

    def _kind(self, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
        leaves, tree = jax.tree.flatten(arguments[self.static :])
        shapes = tuple(
            (np.shape(leaf), getattr(leaf, "dtype", type(leaf)), getattr(leaf, "weak_type", False)) for leaf in leaves
        )
        return arguments[: self.static], tree, shapes, _double()

    def _stepwise(self, traced: Any, patience: int = PATIENCE) -> Steps | None:
        return stepwise(traced, patience) if on("steps") else None


def program(*, static: int = 0, level: int = 0, slopes: int = 0) -> Callable[[Callable[..., Any]], Program]:
    """Make a function a `Program`."""
    return lambda function: Program(function, static, level, slopes)


_NUMBER = np.zeros((), np.float32)  # to put it on a device compiles nothing


def traced(arguments: Any) -> bool:
    """Whether a call is part of another program: its numbers are traced, or known but asked for while JAX traces."""
    return any(isinstance(leaf, Tracer) for leaf in (*jax.tree.leaves(arguments), jax.device_put(_NUMBER)))


def selected(leaves: list[Any], moves: Sequence[bool]) -> list[Any]:
    """Those leaves of a tree that are batched, or differentiated by."""
    return [x for x, move in zip(leaves, moves, strict=True) if move]


def merged(leaves: list[Any], moves: Sequence[bool], moving: list[Any]) -> list[Any]:
    """All leaves again, from those that were selected and the others."""
    rest = iter(moving)
    return [next(rest) if move else x for x, move in zip(leaves, moves, strict=True)]


_KEPT = PATIENCE // 2  # a kept program is compiled once for many processes
_FEW = 128  # numbers by each of which a program is differentiated; of a batch most of these derivatives would be zero


class Moved:
    """Known numbers and their derivatives along some directions, with a first axis.

    Among the arguments of a `Program` it makes the leaves of its result such pairs.
    """

    def __init__(self, value: Any, slopes: Any):
        self.value, self.slopes = value, slopes

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the numbers."""
        return np.shape(self.value)

    @property
    def size(self) -> int:
        """How many numbers there are."""
        return np.size(self.value)


def _followed(wanted: Program, static: tuple[Any, ...], numbers: tuple[Any, ...]) -> Any:
    """The program's result as a tree of `Moved`, from arguments some of which are."""
    leaves = jax.tree.leaves(numbers)
    moves = tuple(isinstance(leaf, Moved) for leaf in leaves)
    directions = [leaf.slopes for leaf in selected(leaves, moves)]
    return jax.tree.map(Moved, *wanted.along(moves, *static, *jax.tree.map(value_of, numbers), directions))


def value_of(leaf: Any) -> Any:
    """A leaf of a tree, without its derivatives if it is `Moved`."""
    return leaf.value if isinstance(leaf, Moved) else leaf


def _as_moved(leaves: list[Any], steps: list[Any]) -> tuple[list[Any], list[Any]]:
    """(The leaves, those with a step as `Moved` along unit directions; their steps)."""
    moves = [not isinstance(step, SymbolicZero) for step in steps]
    moving = selected(leaves, moves)
    return merged(leaves, moves, list(map(Moved, moving, _each(moving)))), selected(steps, moves)


def with_slopes(wanted: Program, parts: Callable[..., Any] | None = None) -> Callable[..., Any]:
    """A program of trees of floating numbers, whose derivatives at known numbers are programs of their own.

    XLA compiles these in a fourth of the time that it takes for what JAX makes of the program in reverse.

    Args:
        wanted: The program.
        parts: What calls one program after the other for the same result, and is used for known numbers: it may only
            pass on what these return. XLA compiles several small programs sooner than one large one.
    """
    known = wanted if parts is None else parts

    @functools.partial(jax.custom_jvp, nondiff_argnums=tuple(range(wanted.static)))
    def tied(*arguments: Any) -> Any:
        return (wanted if traced(arguments) else known)(*arguments)

    def _rule(*arguments: Any) -> tuple[Any, Any]:
        *static, primals, tangents = arguments
        steps = jax.tree.leaves(tangents, is_leaf=lambda x: isinstance(x, SymbolicZero))
        leaves, tree = jax.tree.flatten(primals)
        if _left_to_jax(leaves):
            return _by_jax(lambda *at: wanted(*static, *at), primals, steps)
        moved, steps = _as_moved(leaves, steps)
        found = known(*static, *tree.unflatten(moved))
        return jax.tree.map(value_of, found), _along(found, steps)

    tied.defjvp(_rule, symbolic_zeros=True)

    def asked(*arguments: Any) -> Any:
        # Without derivatives the rule of derivatives would only take time.
        return (tied if on("derivatives") and traced(arguments) else known)(*arguments)

    return asked


def read_with_slopes(solve: Callable[[Any], Any], read: Callable[..., Any], given: Any, more: Any, kept: Any) -> Any:
    """`read(solve(given), more)` of known numbers by which it is differentiated: no tree of JAX has all their slopes.

    Args:
        solve: What only calls programs, and passes on what these return.
        read: A program.
        given: A tree of floating numbers, some of them traced.
        more: One array more.
        kept: A dictionary for the solution with its slopes, which the next question reads as well.
    """

    @jax.custom_jvp
    def tied(given: Any, more: Any) -> Any:
        return read(solve(given), more)

    def rule(primals: Any, tangents: Any) -> tuple[Any, Any]:
        given, more = primals
        if _left_to_jax(jax.tree.leaves(primals)):
            steps = jax.tree.leaves(tangents, is_leaf=lambda x: isinstance(x, SymbolicZero))
            return _by_jax(lambda given, more: read(solve(given), more), primals, steps)
        leaves, tree = jax.tree.flatten(given)
        steps = jax.tree.leaves(tangents[0], is_leaf=lambda x: isinstance(x, SymbolicZero))
        moved, steps = _as_moved(leaves, steps)
        key = "moved", *(isinstance(leaf, Moved) for leaf in moved)
        if key not in kept:
            kept[key] = solve(tree.unflatten(moved))
        found, along = read(kept[key], more), []
        if steps:
            along.append(_along(found, steps))
        if not isinstance(tangents[1], SymbolicZero):
            values = jax.tree.map(value_of, kept[key])
            along.append(_along(read(values, Moved(more, _each([more])[0])), [tangents[1]]))
        return value_of(found), functools.reduce(jax.lax.add, along)

    tied.defjvp(rule, symbolic_zeros=True)
    return tied(given, more)


def _left_to_jax(leaves: list[Any]) -> bool:
    """Whether numbers are not known, too many, or on a device where the results belong."""
    return traced(leaves) or sum(map(np.size, leaves)) > _FEW or any(map(_committed, leaves))


def _committed(leaf: Any) -> bool:
    return getattr(leaf, "committed", False)


def _by_jax(function: Callable[..., Any], primals: tuple[Any, ...], steps: list[Any]) -> tuple[Any, Any]:
    """The function's result and its derivative along the steps of all leaves, by `jax.jvp` of those that move."""
    leaves, tree = jax.tree.flatten(tuple(primals))
    moves = [not isinstance(step, SymbolicZero) for step in steps]

    def at(moving: list[Any]) -> Any:
        return function(*tree.unflatten(merged(leaves, moves, moving)))

    return jax.jvp(at, (selected(leaves, moves),), (selected(steps, moves),))


def follows(given: Any) -> bool:
    """Whether these are few numbers which are known, and by which something is differentiated."""
    leaves = jax.tree.leaves(given)
    wanted = on("derivatives") and any(isinstance(leaf, Tracer) for leaf in leaves)
    return wanted and sum(map(np.size, leaves)) <= _FEW and not traced(())


def _each(leaves: list[Any]) -> list[np.ndarray]:
    """The unit directions of all numbers together, along a first axis of each leaf."""
    sizes = list(map(np.size, leaves))
    columns = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1], axis=1)[: len(sizes)]
    return [
        one.reshape(len(one), *np.shape(x)).astype(jax.numpy.result_type(x))
        for x, one in zip(leaves, columns, strict=True)
    ]


def _along(found: Any, steps: list[Any]) -> Any:
    """The derivatives of a tree, some of it `Moved`, along the steps of all numbers by each of which it has slopes."""
    leaves, tree = jax.tree.flatten(found)
    count = sum(map(np.size, steps))
    slopes = [
        x.slopes if isinstance(x, Moved) else np.zeros((count, *np.shape(x)), jax.numpy.result_type(x)) for x in leaves
    ]
    flat = np.concatenate([np.reshape(slope, (count, np.size(slope) // max(count, 1))) for slope in slopes], axis=1)
    return tree.unflatten(_product(tuple(map(np.shape, map(value_of, leaves))), flat, steps))


@functools.partial(jax.jit, static_argnums=0)  # one product, since XLA compiles each of many
def _product(shapes: tuple[tuple[int, ...], ...], slopes: Any, steps: list[Any]) -> list[Any]:
    along = jax.numpy.concatenate([jax.numpy.ravel(step) for step in steps])
    places = np.cumsum([math.prod(shape) for shape in shapes])[:-1]
    parts = jax.numpy.split(along @ slopes, places)
    return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]


def keep_in(folder: Path | None, most: int = 0, meanwhile: Callable[[], Any] | None = None) -> None:
    """From now on keep what is compiled in a folder.

    JAX's own cache has to be off: a program that it has read cannot be kept again.

    Args:
        folder: Where to; whoever writes there can have this process run anything. None keeps nothing.
        most: How many bytes to keep there.
        meanwhile: What this process needs later, such as an import. It is done while XLA compiles the first program.
    """
    global _store
    _store = None if folder is None else _Store(folder, most, meanwhile)


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

    def __init__(self, folder: Path, most: int, meanwhile: Callable[[], Any] | None):
        self.folder, self.most, self.meanwhile = folder, most, meanwhile

    def compiled(self, lowered: Any) -> Any:
        """The program, compiled in a thread, where XLA needs no Python."""
        if self.meanwhile is None:
            return lowered.compile()
        with ThreadPoolExecutor(1, "compiler") as thread:
            compiling, meanwhile, self.meanwhile = thread.submit(lowered.compile), self.meanwhile, None
            meanwhile()
            return compiling.result()

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


_store: _Store | None = None
