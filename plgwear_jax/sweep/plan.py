"""The plan of a sweep: its quantities, axes and chunks, and the one program that computes any of the chunks.

All chunks have the same shape; those at the ends of the axes are padded. So one program computes all of them, and the
results do not depend on how many devices share the work.
"""

import dataclasses
import functools
import hashlib
import itertools
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import dask.array
import jax
import jax.experimental
import jax.numpy as jnp
import numpy as np
import xarray as xr
from dask.array.core import normalize_chunks, slices_from_chunks
from jax import Array
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from plgwear_jax._core.catalogue import BODIES
from plgwear_jax._core.startup.programs import compiler_options
from plgwear_jax._version import __version__

from .names import SweepPoints, SweepQuantity, SweepTarget, label_of, resolve, variable_name

LOAD = "load_case"

# To be raised when the same sweep gets other results, beyond rounding. A store of other formulas is not continued.
FORMULAS = 2


@dataclasses.dataclass(frozen=True, eq=False, kw_only=True)
class SweepPlan(SweepTarget):
    """Everything that determines the content of a sweep, whoever computes it.

    Attributes:
        names: The quantities.
        axes: The values along each axis; of loads their row numbers.
        loads: The names of the loads, if these are an axis.
        most: The most points of a chunk; None for the default.
    """

    names: tuple[str, ...]
    axes: Mapping[str, np.ndarray]
    loads: tuple[str, ...]
    most: int | None

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
    def chunk(self) -> tuple[int, ...]:
        """The shape of a chunk: by default of some megabytes of results, or of about a second if points are slow."""
        heads, usual, least = {name.split(".")[0] for name in self.names}, 2**20, 2**10
        if self.slow:
            usual, least = 2**2 if "design" in heads else 2**8, 1
        elif heads & {"optimal_exponent", "design", "transient"}:  # which take a thousand times as long as a formula
            usual = 2**14
        amplitudes = 1 if self.amplitudes is None else self.amplitudes[0].shape[1]
        return chunk_shape(self.shape, self.most or max(usual // amplitudes, least))

    @functools.cached_property
    def places(self) -> list[dict[str, slice]]:
        """The part of each axis that a chunk covers, for all chunks by number."""
        every = slices_from_chunks(normalize_chunks(self.chunk, self.shape))
        return [dict(zip(self.axes, place, strict=True)) for place in every]

    def size(self, numbers: Iterable[int]) -> int:
        """The number of points in the chunks with these numbers."""
        places = (self.places[number].values() for number in numbers)
        return sum(math.prod(part.stop - part.start for part in place) for place in places)

    def parts(self, number: int) -> dict[str, tuple[slice, ...]]:
        """What a chunk holds of each quantity: of chunks that differ only along other axes, the first has it."""
        place = self.places[number]
        away = {name for name, part in place.items() if part.start}
        return {
            name: tuple(place[dim] for dim in one.dims)  # pyright: ignore[reportArgumentType]
            for name, one in self.variables.items()
            if away.issubset(one.dims)
        }

    def keep(self, arrays: Any, number: int, variables: Mapping[str, np.ndarray]) -> int:
        """Write a chunk into arrays, of a store or in memory; the number of its points."""
        for name, part in self.parts(number).items():
            arrays[name][part] = variables[name]
        return self.size([number])

    @functools.cached_property
    def asked(self) -> tuple[SweepQuantity, ...]:
        """The quantities, made into functions."""
        return tuple(resolve(name, self) for name in self.names)

    @functools.cached_property
    def variables(self) -> dict[str, xr.Variable]:
        """The quantities as arrays without values, each along the axes that it depends on, in the order of the sweep.

        Their names can be attributes in Python: `wear_volume_dk`. They have unit, meaning, equation and digits as text.
        """
        rows = [jax.ShapeDtypeStruct((2,), values.dtype) for values in self.axes.values()]
        found = {}
        for asked, array in zip(self.asked, jax.eval_shape(self.evaluate, *rows), strict=True):
            along = [length == 2 for length in array.shape]
            dims, shape, chunks = (list(itertools.compress(x, along)) for x in (self.axes, self.shape, self.chunk))
            empty = dask.array.empty(shape, dtype=array.dtype, chunks=chunks)
            about = {
                "quantity": asked.name,
                "units": asked.unit,
                "label": label_of(asked.name),
                "long_name": asked.description,
                "equation": asked.equation,
                "digits": self.digits_of(asked.name),
            }
            about = {key: text for key, text in about.items() if text}  # not everything has an equation
            found[variable_name(asked.name)] = xr.Variable(dims, empty, about)
        return found

    def evaluate(self, *rows: Array) -> tuple[Array, ...]:
        """The quantities on the outer product of the rows, each with as many axes as there are rows."""
        values: dict[str, Any] = {LOAD: jnp.zeros((1,) * len(rows), np.int32)} | {
            name: value if isinstance(value, str) else jnp.asarray(value, self.dtype)
            for name, value in self.fixed.items()
        }
        values |= zip(self.axes, jnp.meshgrid(*rows, indexing="ij", sparse=True), strict=True)
        blocks = [value for name, value in values.items() if name.endswith("].cycles")]
        if blocks:  # which all count, if nothing says how many cycles do
            values.setdefault("cycles", (self.design or {}).get("cycles", sum(blocks)))
        points = SweepPoints(self, values)
        return tuple(jnp.array(asked.evaluate(points), ndmin=len(rows)) for asked in self.asked)

    @functools.cached_property
    def program(self) -> tuple[Any, NamedSharding]:
        """The program of its chunks, compiled once on all devices of this process, and how these share the rows.

        Each device computes a chunk at a time; none waits for another.
        """
        split = PartitionSpec("chunks")
        sharding = NamedSharding(Mesh(np.array(jax.local_devices()), ("chunks",)), split)
        rows = [
            jax.ShapeDtypeStruct((sharding.num_devices, size), values.dtype, sharding=sharding)
            for values, size in zip(self.axes.values(), self.chunk, strict=True)
        ]
        with self._in_precision():  # a worker has not set jax_enable_x64
            shared = jax.shard_map(
                lambda *rows: [x[None] for x in self.evaluate(*(row[0] for row in rows))],
                mesh=sharding.mesh,
                in_specs=split,
                out_specs=split,
                check_vma=False,
            )
            options: Any = compiler_options(1) if self.slow else None  # else XLA compiles for half a minute
            return jax.jit(shared).lower(*rows).compile(options), sharding

    def _in_precision(self) -> Any:
        """A context manager that sets JAX to the precision of the sweep, for this thread only."""
        home: Any = jax if hasattr(jax, "enable_x64") else jax.experimental  # before JAX 0.8
        return home.enable_x64(self.dtype == np.float64)

    def _start(self, numbers: Sequence[int]) -> list[Array]:
        """Start computing as many chunks as there are devices, or fewer."""
        program, sharding = self.program
        rows, filled = [], [*numbers, *[numbers[-1]] * (sharding.num_devices - len(numbers))]
        for (name, values), size in zip(self.axes.items(), self.chunk, strict=True):
            starts = [self.places[number][name].start for number in filled]
            rows.append(values.take(np.add.outer(starts, np.arange(size)), mode="clip"))
        with self._in_precision():
            return program(*jax.device_put(rows, sharding))

    def computed(self, numbers: Sequence[int]) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        """The chunks of these numbers, each with its variables; the next ones are computed while these are kept."""
        width = jax.local_device_count()
        batches = (numbers[first : first + width] for first in range(0, len(numbers), width))
        started = itertools.chain(((batch, self._start(batch)) for batch in batches), [([], [])])
        for (batch, found), _ in itertools.pairwise(started):
            for device, number in enumerate(batch):
                kept = {name: slice(part.stop - part.start) for name, part in self.places[number].items()}
                variables = {
                    name: np.asarray(array)[(device, *(kept[axis] if axis in one.dims else 0 for axis in kept))]
                    for (name, one), array in zip(self.variables.items(), found, strict=True)
                }
                yield number, variables

    @functools.cached_property
    def manifest(self) -> str:
        """A description of the sweep in JSON that can be compared with another and read by people."""
        heads = {name.split(".")[0] for name in self.names}
        kinds = {name: type(getattr(self.contact, name, None)).__name__ for name in BODIES}
        rows = {name: value for name, value in self.known.own.items() if np.ndim(value)}
        return json.dumps(
            {
                "version": __version__,
                "formulas": FORMULAS,
                "quantities": self.names,
                **self.axes,
                **self.fixed,
                "contact": type(self.contact).__name__,
                "bodies": kinds | rows,
                "loads": {"names": self.loads, "amplitudes": self.amplitudes},
                "held": type(self.known.held).__name__,
                "bounds": self.bounds if "optimal_exponent" in heads else "not used",
                "design": self.design if "design" in heads else "not used",
                "digits": "all" if self.digits is None else self.digits,
                "dtype": str(self.dtype),
                "axes": [*self.axes],
                "chunk": self.chunk,
            },
            default=_told,
        )


def _told(value: Any) -> Any:
    """A record or array as JSON; a row of values in words, with a digest that differs for other values."""
    if dataclasses.is_dataclass(value):
        return vars(value)
    if not np.ndim(value):
        return value.item()
    flat = np.ascontiguousarray(value, dtype=np.float64).ravel()
    digest = hashlib.sha256(flat.tobytes()).hexdigest()[:16]
    return f"{flat.size} values from {flat[0]} to {flat[-1]} (sha256 {digest})"


# --- chunks ---------------------------------------------------------------------------------------------------------


def chunk_shape(shape: Sequence[int], points: int) -> tuple[int, ...]:
    """The shape of chunks of at most so many points, of equal size and as square as possible."""
    parts = normalize_chunks("auto", tuple(shape), limit=points, dtype="u1")  # a byte for each point
    return tuple(-(-length // len(part)) for length, part in zip(shape, parts, strict=True))
