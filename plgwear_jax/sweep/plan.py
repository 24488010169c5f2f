"""The plan of a sweep: its quantities, axes and chunks, and the one program that computes any of the chunks.

All chunks have the same shape; those at the ends of the axes are padded. So one program computes all of them, and the
results do not depend on how many devices share the work.
"""

import dataclasses
import functools
import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import dask.array
import jax
import jax.experimental
import jax.numpy as jnp
import numpy as np
import xarray as xr
from jax import Array
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from plgwear_jax._startup.programs import compiler_options
from plgwear_jax._version import __version__
from plgwear_jax.catalogue import BODIES, leaf
from plgwear_jax.sweep.axes import spacing_of
from plgwear_jax.sweep.names import (
    SEARCHES,
    SweepQuantity,
    SweepTarget,
    axis_unit,
    digits_of,
    label_of,
    resolve,
    variable_name,
)

LOAD = "load_case"

# To be raised when the same sweep gets other results, beyond rounding. A store of other formulas is not continued.
FORMULAS = 2


@dataclasses.dataclass(frozen=True, eq=False)
class SweepPlan:
    """Everything that determines the content of a sweep, whoever computes it.

    Attributes:
        names: The quantities.
        axes: The values along each axis; of loads their row numbers.
        fixed: The inputs with a single value, by name; the text "holl" for Holl's ratio.
        subject: The contact, its loads, and what else the quantities depend on.
        loads: The names of the loads, if these are an axis.
        dtype: float64 or float32.
        chunk: The shape of a chunk.
    """

    names: tuple[str, ...]
    axes: Mapping[str, np.ndarray]
    fixed: Mapping[str, Any]
    subject: SweepTarget
    loads: tuple[str, ...]
    dtype: np.dtype
    chunk: tuple[int, ...]

    def __getstate__(self) -> dict[str, Any]:
        # sent to other processes: the fields, not the cached functions, which each process makes itself
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}

    @functools.cached_property
    def shape(self) -> tuple[int, ...]:
        """The number of values along each axis."""
        return tuple(values.size for values in self.axes.values())

    @property
    def points(self) -> int:
        """The number of points."""
        return math.prod(self.shape)

    @functools.cached_property
    def grid(self) -> tuple[int, ...]:
        """The number of chunks along each axis."""
        return tuple(-(-length // size) for length, size in zip(self.shape, self.chunk, strict=True))

    @property
    def chunks(self) -> int:
        """The number of chunks."""
        return math.prod(self.grid)

    def index(self, number: int) -> dict[str, int]:
        """The place of a chunk along each axis, from its number."""
        return dict(zip(self.axes, map(int, np.unravel_index(number, self.grid)), strict=True))

    def place(self, number: int) -> dict[str, slice]:
        """The part of each axis that a chunk covers, from its number."""
        found = {}
        for (name, index), size, length in zip(self.index(number).items(), self.chunk, self.shape, strict=True):
            found[name] = slice(index * size, min((index + 1) * size, length))
        return found

    def size(self, numbers: Sequence[int]) -> int:
        """The number of points in the chunks with these numbers."""
        places = (self.place(number).values() for number in numbers)
        return sum(math.prod(part.stop - part.start for part in place) for place in places)

    @functools.cached_property
    def asked(self) -> tuple[SweepQuantity, ...]:
        """The quantities, made into functions."""
        return tuple(resolve(name, self.subject) for name in self.names)

    @functools.cached_property
    def variables(self) -> dict[str, xr.Variable]:
        """The quantities as arrays without values, each along the axes that it depends on, in the order of the sweep.

        Their names can be attributes in Python: `wear_volume_dk`. They have unit, meaning, equation and digits as text.
        """
        rows = [jax.ShapeDtypeStruct((2,), self.row_dtype(name)) for name in self.axes]
        found = {}
        for asked, array in zip(self.asked, jax.eval_shape(self.evaluate, *rows), strict=True):
            along = [place for place, length in enumerate(array.shape) if length == 2]
            dims, shape, chunks = ([each[place] for place in along] for each in ([*self.axes], self.shape, self.chunk))
            empty = dask.array.empty(shape, dtype=array.dtype, chunks=chunks)
            found[variable_name(asked.name)] = xr.Variable(dims, empty, self._attributes(asked))
        return found

    def row_dtype(self, name: str) -> np.dtype:
        """The dtype in which the values of an axis enter the program."""
        return np.dtype(np.int32) if name == LOAD else self.dtype

    def _attributes(self, asked: SweepQuantity) -> dict[str, str]:
        digits = self.subject.digits or digits_of(asked.name, self.subject) or f"all of {self.dtype}"
        return {
            "quantity": asked.name,
            "units": asked.unit,
            "label": label_of(asked.name),
            "long_name": asked.description,
            **({"equation": asked.equation} if asked.equation else {}),
            "digits": str(digits),
        }

    def evaluate(self, *rows: Array) -> tuple[Array, ...]:
        """The quantities on the outer product of the rows, each with as many axes as there are rows."""
        count = len(rows)
        values: dict[str, Any] = {LOAD: jnp.zeros((), np.int32)} | {
            name: value if isinstance(value, str) else jnp.asarray(value, self.dtype)
            for name, value in self.fixed.items()
        }
        for place, (name, row) in enumerate(zip(self.axes, rows, strict=True)):
            values[name] = row.reshape([-1 if place == axis else 1 for axis in range(count)])
        shared: dict[Any, Any] = {}
        found = (asked.evaluate(values, shared) for asked in self.asked)
        return tuple(x.reshape((1,) * (count - x.ndim) + x.shape) for x in found)

    def coordinate_attributes(self, name: str) -> dict[str, str]:
        """Unit and meaning of an axis, what it is called in pictures, and how its values are spaced."""
        if name == LOAD:
            return {"label": "load", "long_name": "load"}
        kind, of_punch = leaf(name), name == "radius" and hasattr(self.subject.contact, "depth")
        return {
            "units": axis_unit(name, self.subject.contact),
            "label": "radius of the punch $a$" if of_punch else kind.label,
            "long_name": kind.description,
            "spacing": spacing_of(name, self.axes.get(name, np.zeros(1))),
        }

    @functools.cached_property
    def engine(self) -> "Engine":
        """The program of its chunks, which each process compiles once and keeps as long as the plan."""
        return Engine(self)

    @functools.cached_property
    def manifest(self) -> dict[str, Any]:
        """A description of the sweep that can be compared with another and read by people."""
        subject, heads = self.subject, {name.split(".")[0] for name in self.names}
        return {
            "version": __version__,
            "formulas": FORMULAS,
            "quantities": list(self.names),
            **{name: "loads" if name == LOAD else _told(values) for name, values in self.axes.items()},
            **{name: value if isinstance(value, str) else float(value) for name, value in self.fixed.items()},
            "contact": type(subject.contact).__name__ if subject.contact is not None else "none",
            **({"bodies": _told_bodies(subject)} if subject.numeric else {}),
            "loads": list(self.loads)
            if subject.amplitudes is None
            else {"names": list(self.loads)}
            | dict(zip(("forces", "weights"), map(_told, subject.amplitudes), strict=True)),
            **({"held": type(subject.load).__name__} if subject.load is not None else {}),
            "bounds": list(map(float, subject.bounds)) if "optimal_exponent" in heads else "not used",
            "design": json.loads(json.dumps(subject.design, default=_as_json)) if "design" in heads else "not used",
            "digits": "all" if subject.digits is None else subject.digits,
            "dtype": str(self.dtype),
            "axes": list(self.axes),
            "chunk": list(self.chunk),
        }


def _told(values: np.ndarray) -> str:
    """A row of values in words, with a digest that differs for other values."""
    flat = np.ascontiguousarray(values, dtype=np.float64).ravel()
    digest = hashlib.sha256(flat.tobytes()).hexdigest()[:16]
    return f"{flat.size} values from {flat[0]} to {flat[-1]} (sha256 {digest})"


def _told_bodies(subject: SweepTarget) -> dict[str, Any]:
    """What touches beside the numbers that are among the axes and fields."""
    bodies = {name: getattr(subject.contact, name, None) for name in BODIES}
    rows = {name: value for name, value in subject.names.own.items() if np.ndim(value)}
    kinds = {name: type(body).__name__ for name, body in bodies.items() if body is not None}
    return kinds | {name: _told(np.asarray(row)) for name, row in rows.items()}


def _as_json(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    return np.asarray(value).tolist()


# --- chunks ---------------------------------------------------------------------------------------------------------


def default_chunk(names: Sequence[str], amplitudes: int, slow: bool = False) -> int:
    """The points of a chunk: some megabytes of results, or about a second of searching or of slow contacts."""
    heads = {name.split(".")[0] for name in names}
    if slow:
        return max((2**2 if "design" in heads else 2**8) // amplitudes, 1)
    return max((2**14 if heads & SEARCHES else 2**20) // amplitudes, 2**10)


def chunk_shape(shape: Sequence[int], points: int) -> tuple[int, ...]:
    """The shape of chunks of at most so many points, of equal size and as square as possible."""
    parts = [1] * len(shape)

    def sizes() -> list[int]:
        return [-(-length // count) for length, count in zip(shape, parts, strict=True)]

    while math.prod(sizes()) > points:
        longest = max(range(len(shape)), key=lambda axis: sizes()[axis])
        parts[longest] = min(max(parts[longest] + 1, int(1.02 * parts[longest])), shape[longest])
    return tuple(sizes())


# --- computing ------------------------------------------------------------------------------------------------------

_AXIS = "chunks"


def in_precision(dtype: Any) -> Any:
    """A context manager that sets JAX to the precision of a dtype, for this thread only."""
    home: Any = jax if hasattr(jax, "enable_x64") else jax.experimental  # before JAX 0.8
    return home.enable_x64(np.dtype(dtype) == np.float64)


class Engine:
    """The program of a plan, compiled once, on all devices of this process: each computes a chunk at a time."""

    def __init__(self, plan: SweepPlan) -> None:
        self.plan = plan
        devices = jax.local_devices()
        self.width = len(devices)
        mesh = Mesh(np.array(devices), (_AXIS,))
        split = PartitionSpec(_AXIS)
        self._sharding = NamedSharding(mesh, split)
        rows = [
            jax.ShapeDtypeStruct((self.width, size), plan.row_dtype(name), sharding=self._sharding)
            for name, size in zip(plan.axes, plan.chunk, strict=True)
        ]

        def one_chunk(*rows: Array) -> dict[str, Array]:
            found = (x[None] for x in plan.evaluate(*(row[0] for row in rows)))
            return dict(zip(plan.variables, found, strict=True))

        with in_precision(plan.dtype):  # a worker has not set jax_enable_x64
            # Each device runs the same program on a chunk of its own; none waits for another.
            shared = jax.shard_map(one_chunk, mesh=mesh, in_specs=split, out_specs=split, check_vma=False)
            options: Any = compiler_options(1) if plan.subject.slow else None  # else XLA compiles for half a minute
            self._compiled = jax.jit(shared).lower(*rows).compile(options)

    def batches(self, numbers: Sequence[int]) -> Iterator[Sequence[int]]:
        """The chunks of these numbers, as many at a time as there are devices."""
        return (numbers[first : first + self.width] for first in range(0, len(numbers), self.width))

    def start(self, numbers: Sequence[int]) -> dict[str, Array]:
        """Start computing as many chunks as there are devices, or fewer."""
        plan = self.plan
        filled = [*numbers, *[numbers[-1]] * (self.width - len(numbers))]
        places = [plan.place(number) for number in filled]
        rows = []
        for (name, values), size in zip(plan.axes.items(), plan.chunk, strict=True):
            parts = [values[place[name]] for place in places]
            stacked = np.stack([np.pad(part, (0, size - part.size), mode="edge") for part in parts])
            rows.append(stacked.astype(plan.row_dtype(name)))
        with in_precision(plan.dtype):
            return self._compiled(*jax.device_put(rows, self._sharding))

    def finish(self, numbers: Sequence[int], started: dict[str, Array]) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        """The numbers of the chunks that were started, each with its variables, without the padding."""
        for device, number in enumerate(numbers):
            kept = {name: slice(part.stop - part.start) for name, part in self.plan.place(number).items()}
            variables = {}
            for name, variable in self.plan.variables.items():
                place = (kept[axis] if axis in variable.dims else 0 for axis in kept)
                variables[name] = np.asarray(started[name])[(device, *place)]
            yield number, variables
