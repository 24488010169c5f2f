"""Programs for concrete numbers: `jax.jit`, but for what makes the first answer of a process come late.

Programs are first run step by step (`stepwise`), and compiled, with less optimisation, once they have taken half as
long as the compiler. The command line has programs kept in files: a later process loads one, and need not trace, lower
and compile; JAX's own cache saves the last of these alone. `benchmarks/waits.py` measures what each of these buys.
"""

import contextlib
import dataclasses
import functools
import hashlib
import itertools
import os
import pickle
import platform
import zlib
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.core import Tracer
from jax.custom_derivatives import SymbolicZero
from jax.experimental import serialize_executable

from .. import files
from . import on
from .operations import UnknownError
from .stepwise import SteppedProgram, stepwise


def compiler_options(level: int = 0) -> dict[str, bool | str | int | float]:
    """Options for `jax.jit` with which XLA compiles a program of your own two to three times sooner.

    From JAX 0.11 on it is a fifth to a third sooner, as XLA has lost one of the two options. The library compiles its
    own programs with these options. What answers a few questions runs for milliseconds and needs no more optimisation;
    a program that runs for minutes should be compiled without them.

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
    options: dict[str, bool | str | int | float] = {"xla_backend_optimization_level": level}
    if jax.__version_info__ < (0, 11):  # later ones refuse it
        options["xla_cpu_use_fusion_emitters"] = False
    return options


class Program:
    """A function that JAX compiles for concrete numbers.

    Args:
        function: What is compiled, for concrete numbers; of another program it is a part like any function.
        static: How many of its first arguments are no numbers; their reprs tell them apart.
        level: How much LLVM optimises: 1 for loops over whole matrices, which without it take ten times as long.
        slopes: The same for the program's derivatives at known numbers.
        steps: Whether it may be run step by step at first, which takes longer where hundreds of answers are wanted.
    """

    def __init__(
        self, function: Callable[..., Any], static: int = 0, level: int = 0, slopes: int = 0, steps: bool = True
    ):
        functools.update_wrapper(self, function)
        self.name = f"{function.__module__}.{function.__qualname__}"
        self.function, self.static, self.level, self.slopes = in_full(function), static, level, slopes
        self.steps = steps
        self.known: dict[Any, Any] = {}  # what runs it, by the kind of its arguments

    @functools.cached_property
    def jitted(self):
        """The function under `jax.jit`."""
        options = compiler_options(self.level) if on("levels") else None
        return jax.jit(self.function, static_argnums=range(self.static), compiler_options=options)

    @functools.cached_property
    def part(self):
        """The function as a part of another program, which has options of its own."""
        return jax.jit(self.function, static_argnums=range(self.static))

    @functools.cached_property
    def moved(self):
        """(The result, how it moves), as a part of another program. JAX alone would trace the function once more.

        The first argument tells which leaves of the numbers move, the last one has the steps of these.
        """

        def moved(moves, *arguments):
            function, moving = self._of_moving(moves, arguments[:-1])
            return jax.jvp(function, (moving,), (arguments[-1],))

        return jax.jit(moved, static_argnums=range(1 + self.static))

    @functools.cached_property
    def along(self) -> "Program":
        """(The result, its derivatives along directions, with a first axis), of the same arguments."""

        def along(moves, *arguments):
            return along_each(*self._of_moving(moves, arguments[:-1]), arguments[-1])

        # No `functools.update_wrapper`, as JAX would take the arguments of the function for those of `along`.
        along.__module__, along.__qualname__ = self.function.__module__, f"{self.function.__qualname__}.along"
        return Program(along, 1 + self.static, self.slopes, self.slopes)

    @functools.cached_property
    def derivative(self):
        """`along`, whose derivatives at known numbers are a program of their own."""
        return with_slopes(self.along)

    def _of_moving(self, moves, given):
        moving, whole = parted(given[self.static :], moves)
        return lambda at: self.function(*given[: self.static], *whole(at)), moving

    def __call__(self, *arguments: Any) -> Any:
        """The function's result."""
        static, numbers = arguments[: self.static], arguments[self.static :]
        leaves = jax.tree.leaves(numbers)
        if any(moves := tuple(isinstance(leaf, NumbersWithSlopes) for leaf in leaves)):
            directions = [leaf.slopes for leaf in leaves if isinstance(leaf, NumbersWithSlopes)]
            return jax.tree.map(
                NumbersWithSlopes, *self.along(moves, *static, *jax.tree.map(value_of, numbers), directions)
            )
        if traced(arguments):
            return self.part(*arguments)
        if _store is not None:
            numbers = jax.tree.map(np.asarray, numbers)
        elif any(map(_committed, leaves)):
            return self.jitted(*arguments)  # on the device where the results of committed numbers belong
        with contextlib.suppress(UnknownError):
            return self.by(static, numbers)(*numbers)
        return self.jitted(*static, *numbers)

    def by(self, static: tuple[Any, ...], numbers: tuple[Any, ...]) -> Callable[..., Any]:
        """What runs the program for numbers of this kind: steps, what is kept, or else `jax.jit`."""
        leaves, tree = jax.tree.flatten(numbers)
        shapes = [(np.shape(x), getattr(x, "dtype", type(x)), getattr(x, "weak_type", False)) for x in leaves]
        kind = _store, static, tree, *shapes, jnp.result_type(0.0)
        if kind not in self.known:
            key = hashlib.sha256(repr((self.name, *kind[1:])).encode() + _house()).hexdigest() if _store else ""
            made = _store.read(key) if _store else None
            if made is None:
                traced = self.jitted.trace(*static, *numbers)
                made = stepwise(traced) if self.steps and on("steps") else None
                if _store:
                    made = made or traced.lower().compile()
                    _store.write(key, made)
            self.known[kind] = made or functools.partial(self.jitted, *static)
        run = self.known[kind]
        return run if getattr(run, "worthwhile", True) else functools.partial(self.jitted, *static)


def program(**options: Any) -> Callable[[Callable[..., Any]], Program]:
    """Make a function a `Program` with these options."""
    return lambda function: Program(function, **options)


_NUMBER = np.zeros((), np.float32)  # to put it on a device compiles nothing


def in_full(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function with products of matrices in the precision of their numbers: a GPU keeps three digits of float32."""

    @functools.wraps(function)
    def found(*arguments):
        with jax.default_matmul_precision("highest"):
            return function(*arguments)

    return found


def holds_tracers(tree: Any) -> bool:
    """Whether some numbers of a tree are traced."""
    return any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves(tree))


def traced(arguments: Any) -> bool:
    """Whether a call is part of another program: its numbers are traced, or known but asked for while JAX traces."""
    return holds_tracers((arguments, jax.device_put(_NUMBER)))


def parted(given: Any, moves: Sequence[bool]) -> tuple[list[Any], Callable[[list[Any]], Any]]:
    """(Those leaves of a tree that are batched or differentiated by, what makes the tree from such and the others)."""
    leaves, tree = jax.tree.flatten(tuple(given))

    def whole(moving):
        rest = iter(moving)
        return tree.unflatten([next(rest) if move else x for x, move in zip(leaves, moves, strict=True)])

    return list(itertools.compress(leaves, moves)), whole


def steps_of(tangents: Any) -> tuple[list[bool], list[Any]]:
    """(Which leaves a rule of derivatives differentiates by, the steps of these), of its symbolic zeros."""
    steps = jax.tree.leaves(tangents, is_leaf=lambda x: isinstance(x, SymbolicZero))
    moves = [not isinstance(step, SymbolicZero) for step in steps]
    return moves, list(itertools.compress(steps, moves))


def moved_along(function: Callable[..., Any], primals: Any, tangents: Any) -> tuple[Any, Any]:
    """`jax.jvp` for a rule of derivatives that has symbolic zeros: of what does not move nothing is traced."""
    moves, steps = steps_of(tangents)
    moving, whole = parted(primals, moves)
    return jax.jvp(lambda at: function(*whole(at)), (moving,), (steps,))


def along_each(function: Callable[[Any], Any], moving: Any, directions: Any) -> tuple[Any, Any]:
    """(The result, its derivatives along directions, with a first axis)."""
    # Not `jax.linearize`, which takes JAX twice as long to trace.
    return jax.vmap(lambda along: jax.jvp(function, (moving,), (along,)), out_axes=(None, 0))(directions)


# --- derivatives ------------------------------------------------------------------------------------------------------

_FEW = 128  # derivatives by known numbers; of a batch most would be zero


class NumbersWithSlopes:
    """Known numbers and their derivatives along some directions, with a first axis.

    Among the arguments of a `Program` it makes the leaves of its result such pairs.
    """

    def __init__(self, value: Any, slopes: Any):
        self.value, self.slopes = value, slopes
        self.shape, self.size = np.shape(value), np.size(value)


def value_of(leaf: Any) -> Any:
    """A leaf of a tree, without its derivatives if it is `NumbersWithSlopes`."""
    return leaf.value if isinstance(leaf, NumbersWithSlopes) else leaf


def with_slopes(wanted: Callable[..., Any], parts: Callable[..., Any] | None = None) -> Callable[..., Any]:
    """A program of trees of floating numbers, whose derivatives at known numbers are programs of their own.

    XLA compiles these in a fourth of the time that it takes for what JAX makes of the program in reverse.

    Args:
        wanted: The program.
        parts: What calls one program after the other for the same result, and is used for known numbers: it may only
            pass on what these return. XLA compiles several small programs sooner than one large one.
    """
    known, static = parts or wanted, getattr(wanted, "static", 0)

    @functools.partial(jax.custom_jvp, nondiff_argnums=tuple(range(static)))
    def implicit(*arguments):
        return (wanted if traced(arguments) else known)(*arguments)

    @in_full
    def _rule(*arguments):
        *words, primals, tangents = arguments
        moves, steps = steps_of(tangents)
        moving, whole = parted(primals, moves)
        leaves, again = list(map(_beneath, jax.tree.leaves(primals))), traced(primals)
        # Second derivatives are symmetric.
        count = sum(map(np.size, moving)) * (sum(map(np.size, leaves)) // 2 if again else 1)
        few = not (traced(leaves) or count > _FEW or any(map(_committed, leaves)))
        if not isinstance(wanted, Program):
            if again or not few:
                return moved_along(functools.partial(wanted, *words), primals, tangents)
        elif not few:
            return wanted.moved(tuple(moves), *words, *primals, steps)
        elif again:
            value, slopes = wanted.derivative(tuple(moves), *words, *primals, _unit_directions(moving))
            return value, _along_steps(jax.tree.map(NumbersWithSlopes, value, slopes), steps)
        found = known(*words, *whole(list(map(NumbersWithSlopes, moving, _unit_directions(moving)))))
        return jax.tree.map(value_of, found), _along_steps(found, steps)

    implicit.defjvp(_rule, symbolic_zeros=True)

    def asked(*arguments):
        if not traced(arguments):  # the rule of derivatives would only take time
            return known(*arguments)
        return (implicit if on("derivatives") else wanted)(*arguments)

    return asked


def read_with_slopes(solve: Callable[[Any], Any], read: Callable[..., Any], given: Any, more: Any, kept: Any) -> Any:
    """`read(solve(given), more)` of known numbers by which it is differentiated.

    Args:
        solve: What only calls programs, and passes on what these return.
        read: A program.
        given: A tree of floating numbers, some of them traced.
        more: One array more.
        kept: A dictionary for the solution with its slopes, which the next question reads as well.
    """

    def parts(given, more):
        key = (
            "moved",
            *(len(leaf.slopes) if isinstance(leaf, NumbersWithSlopes) else 0 for leaf in jax.tree.leaves(given)),
        )
        if key not in kept:
            kept[key] = solve(given)
        return read(kept[key], more)

    return with_slopes(lambda given, more: read(solve(given), more), parts)(given, more)


def _beneath(leaf):
    """The number at which a derivative of any order is taken."""
    return _beneath(leaf.primal) if hasattr(leaf, "primal") else leaf


def _committed(leaf):
    return getattr(leaf, "committed", False)


def follows(given: Any) -> bool:
    """Whether these are few numbers which are known, and by which something is differentiated."""
    leaves = jax.tree.leaves(given)
    return on("derivatives") and holds_tracers(leaves) and sum(map(np.size, leaves)) <= _FEW and not traced(())


def _unit_directions(leaves):
    """The unit directions of all numbers together, along a first axis of each leaf."""
    ends = np.cumsum([np.size(x) for x in leaves])
    each = zip(leaves, np.split(np.eye(ends[-1]), ends[:-1], axis=1), strict=True)
    return [part.reshape(len(part), *np.shape(x)).astype(jnp.result_type(x)) for x, part in each]


def _along_steps(found, steps):
    """The derivatives of a tree, some of it with slopes by each of some numbers, along steps of these numbers."""
    leaves, tree = jax.tree.flatten(found)
    count = sum(map(np.size, steps))
    slopes = [
        x.slopes if isinstance(x, NumbersWithSlopes) else np.zeros((count, *np.shape(x)), jnp.result_type(x))
        for x in leaves
    ]
    return tree.unflatten(_products(slopes, steps))


@jax.jit
def _products(slopes, steps):
    along = jnp.concatenate([jnp.ravel(step) for step in steps])
    # Whether something converged has no derivative.
    return [x[0] if x.dtype == jax.dtypes.float0 else jnp.tensordot(along, x, 1) for x in slopes]


# --- what is kept -----------------------------------------------------------------------------------------------------


def keep_in(folder: Path | None, most: int = 0) -> None:
    """From now on keep what is compiled in a folder.

    JAX's own cache has to be off: a program that it has read cannot be kept again.

    Args:
        folder: Where to; whoever writes there can have this process run anything. None keeps nothing.
        most: How many bytes to keep there.
    """
    global _store
    _store = None if folder is None else _Store(folder, most)


@functools.cache
def _house() -> bytes:
    """What tells programs of the same name and shapes apart: their source, and what makes and runs them."""
    device = jax.devices()[0]
    told = [version(name) for name in ("jax", "jaxlib", "optax", "numpy")]
    told += [platform.node(), device.device_kind, device.client.platform_version, jax.device_count()]
    told += sorted(item for item in os.environ.items() if item[0].startswith(("JAX_", "XLA_", "PLGWEAR_STARTUP")))
    with contextlib.suppress(OSError):  # a home may be that of several machines; Linux tells what each can do
        told += sorted({line for line in Path("/proc/cpuinfo").read_text("latin-1").splitlines() if "MHz" not in line})
    source = b"".join(file.read_bytes() for file in sorted(Path(__file__).parents[2].rglob("*.py")))
    return hashlib.sha256(source + repr(told).encode()).digest()


@dataclasses.dataclass(eq=False)  # a folder that is given again is read again
class _Store:
    """A file a program; those not used for the longest time make room. Nothing wrong with it is an error."""

    folder: Path
    most: int  # bytes

    def read(self, key: str) -> Any:
        """A program, or None."""
        file = self.folder / key
        with contextlib.suppress(Exception):  # whatever it is, the program is compiled instead
            known = pickle.loads(zlib.decompress(file.read_bytes()))  # which checks a sum
            with contextlib.suppress(OSError):  # a disk that is read only
                os.utime(file)
            if isinstance(known, SteppedProgram):
                return known
            if b"lapack" in known[0]:  # JAX looks for it when it lowers a decomposition; what is loaded would crash
                jax.jit(lax.linalg.cholesky).lower(np.eye(1, dtype=np.float32))
            return serialize_executable.deserialize_and_load(*known)

    def write(self, key: str, made: Any) -> None:
        """Keep a program."""
        with contextlib.suppress(Exception):  # a full disk, a device whose programs cannot be kept
            kept = made if isinstance(made, SteppedProgram) else serialize_executable.serialize(made)
            content = zlib.compress(pickle.dumps(kept), level=1)
            self.folder.mkdir(mode=0o700, exist_ok=True)
            left = self.most - len(content)
            for file in sorted(self.folder.iterdir(), key=lambda file: file.stat().st_mtime, reverse=True):
                left -= file.stat().st_size
                if left < 0:
                    file.unlink(missing_ok=True)
            if len(content) <= self.most:
                files.write(self.folder / key, lambda target: target.write_bytes(content))


_store: _Store | None = None
