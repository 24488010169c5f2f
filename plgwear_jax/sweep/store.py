"""A sweep in a Zarr store: created as a whole, continued after a stop, refused if it holds another sweep."""

import contextlib
import functools
import json
import os
import shutil
import warnings
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr
import zarr
from filelock import FileLock, Timeout
from zarr.codecs import BloscCodec
from zarr.errors import ZarrUserWarning

from plgwear_jax._core.catalogue import leaf
from plgwear_jax._core.words import GivenError, PathGiven, cut, one_line, shown
from plgwear_jax._version import __version__

from .axes import spacing_of
from .names import axis_unit, variable_name
from .plan import LOAD, SweepPlan

_MANIFEST = "plgwear_sweep"
UNFINISHED, FINISHED = "unfinished: missing values are NaN, and the same sweep continues it", "finished"


class SweepError(GivenError):
    """Why a sweep cannot be computed or read, in one line."""


class UnfinishedWarning(UserWarning):
    """A sweep that was opened lacks chunks."""


def labelled(plan: SweepPlan) -> xr.Dataset:
    """The axes and single values of a sweep, and its description as attributes.

    Each has its unit and meaning, what it is called in pictures, and how its values are spaced.
    """
    found = xr.Dataset(attrs={"title": "plgwear sweep", "source": f"plgwear_jax {__version__}"})
    for name, value in {**plan.axes, **plan.fixed}.items():
        if isinstance(value, str):
            found.attrs[name] = value
            continue
        values: Any = np.asarray(value)
        kind, of_punch = leaf(name), name == "radius" and hasattr(plan.contact, "depth")
        about = {
            "units": axis_unit(name, plan.contact),
            "label": "radius of the punch $a$" if of_punch else kind.label,
            "long_name": kind.description,
            "spacing": spacing_of(name, values),
        }
        if name == LOAD:
            values, about = np.array(plan.loads, object), {"label": "load", "long_name": "load"}
        found = found.assign_coords({name: ([name] * values.ndim, values, about)})
    found.attrs[_MANIFEST] = plan.manifest
    return found


class SweepStore:
    """The Zarr store of a sweep, to be written to by whoever computes its chunks.

    Attributes:
        path: The folder.
        name: It, as it was named, for messages.
    """

    def __init__(self, path: PathGiven, plan: SweepPlan) -> None:
        self.path, self.name, self._plan = Path(os.path.abspath(path)), one_line(os.fspath(path)), plan

    @functools.cached_property
    def _arrays(self) -> dict[str, zarr.Array]:
        # A chunk of NaN only can be a finished one, so its file has to be written too.
        with zarr.config.set({"array.write_empty_chunks": True}):
            return _arrays_at(self.path, self.name, self._plan.variables, "r+")

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        """Say why something cannot be written."""
        try:
            yield
        except Timeout:
            raise SweepError(f"{self.name}: another process is sweeping into it") from None
        except OSError as error:
            raise SweepError(f"{self.name}: cannot be written: {error.strerror or error}") from None

    @contextlib.contextmanager
    def held(self) -> Iterator[list[int]]:
        """The numbers of the chunks that are missing; until the end no other process can write to the store."""
        if self.path.suffix != ".zarr":
            raise SweepError(f"{self.name}: must end in .zarr")
        if not self.path.parent.is_dir():
            raise SweepError(f"{self.name}: cannot be written: there is no folder to put it in")
        lock = FileLock(self.path.with_name(f".{self.path.name}.lock"))
        with contextlib.ExitStack() as until:
            with self._writing():
                until.enter_context(lock.acquire(timeout=0))
                until.callback(Path(lock.lock_file).unlink, missing_ok=True)  # before the release: nobody else has it
                # what a process that was killed left unfinished
                for part in self.path.parent.glob(f".{self.path.name}.*.part"):
                    shutil.rmtree(part, ignore_errors=True)
                self.remove_partial()
                if os.path.lexists(self.path):
                    self._refuse_other()
                else:
                    self._create()
                missing = self._missing()
            yield missing

    def _refuse_other(self) -> None:
        """Refuse a sweep that differs from the one in the store, and name the difference."""
        there, here = _manifest_at(self.path, self.name), json.loads(self._plan.manifest)
        for key in dict.fromkeys([*there, *here]):
            old, new = (manifest.get(key, "absent") for manifest in (there, here))
            if old != new and key != "version":  # the version of the formulas decides
                old, new = (cut(value) if isinstance(value, str) else shown(value) for value in (old, new))
                said = f"holds another sweep: {key} there is {old}, here {new}"
                raise SweepError(f"{self.name}: {said}; name another folder")

    def _missing(self) -> list[int]:
        return [number for number in range(len(self._plan.places)) if not self.has(number)]

    def has(self, number: int) -> bool:
        """Whether all files of a chunk exist."""
        for name, part in self._plan.parts(number).items():
            array = self._arrays[name]
            index = tuple(one.start // size for one, size in zip(part, array.chunks, strict=True))
            file = self.path / name / array.metadata.encode_chunk_key(index)
            if not (file.is_file() and file.stat().st_size):  # a loss of power may leave an empty one
                return False
        return True

    def write(self, number: int, variables: Mapping[str, np.ndarray]) -> int:
        """Write the files of a chunk, each whole or not at all; the number of its points.

        Raises:
            SweepError: They cannot be written; it says how many chunks are finished.
        """
        try:
            with self._writing():
                return self._plan.keep(self._arrays, number, variables)
        except SweepError as error:
            chunks = len(self._plan.places)
            done = f"{chunks - len(self._missing())} of {chunks} chunks are finished"
            raise SweepError(f"{error}; {done}, and the same sweep continues with the others") from None

    def finish(self) -> None:
        """Write into the store that it is finished.

        Raises:
            SweepError: It cannot be written.
        """
        with self._writing():
            self.remove_partial()  # of workers that died
            group = zarr.open_group(self.path, mode="r+")
            if group.attrs.get("status") != FINISHED:
                group.update_attributes({"status": FINISHED})

    def _create(self) -> None:
        """Create everything but the chunks, under another name until it is complete."""
        part = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
        found = labelled(self._plan).assign_attrs(status=UNFINISHED).assign(self._plan.variables)
        encoding = {
            name: {
                "compressors": [BloscCodec(cname="lz4", clevel=1, shuffle="bitshuffle")],
                # chunks that are missing read as NaN
                "fill_value": np.nan if variable.dtype.kind == "f" else 0,
            }
            for name, variable in self._plan.variables.items()
        }
        try:
            with warnings.catch_warnings():
                # Zarr has consolidated metadata for years, but its version 3 has yet to say it
                warnings.simplefilter("ignore", ZarrUserWarning)
                found.to_zarr(part, mode="w", compute=False, consolidated=True, zarr_format=3, encoding=encoding)
            part.rename(self.path)
        finally:
            shutil.rmtree(part, ignore_errors=True)

    def remove_partial(self) -> None:
        """Remove unfinished files of writers that were killed."""
        for file in self.path.rglob("*.partial"):
            file.unlink(missing_ok=True)


def open_sweep(path: PathGiven) -> xr.Dataset:
    """Open a sweep in a Zarr store. Values are read when they are used; values that are still missing are NaN.

    Args:
        path: The folder.

    Returns:
        The sweep; its attribute `unfinished` is the number of chunk files that are still missing. A warning says so
        if there are any (`UnfinishedWarning`).

    Raises:
        SweepError: The folder holds no sweep.
    """
    name = one_line(os.fspath(path))
    variables = [variable_name(one) for one in _manifest_at(Path(path), name)["quantities"]]
    arrays = _arrays_at(path, name, variables, "r").values()
    files = sum(one.nchunks for one in arrays)
    missing = files - sum(one.nchunks_initialized for one in arrays)
    if missing:
        said = f"{name}: is not finished: {missing} of {files} chunk files are missing, read as NaN"
        warnings.warn(UnfinishedWarning(said), stacklevel=2)
    found = xr.open_zarr(path, consolidated=False, chunks={})[variables]
    return found.assign_attrs(status=UNFINISHED if missing else FINISHED, unfinished=missing)


def _manifest_at(path: Path, name: str) -> dict[str, Any]:
    """The manifest of the sweep at a path."""
    if not os.path.lexists(path):
        raise SweepError(f"{name}: there is no such folder")
    try:
        group = zarr.open_group(path, mode="r", use_consolidated=False)
    except (OSError, ValueError, KeyError, TypeError):
        raise SweepError(f"{name}: is not a Zarr store") from None
    with contextlib.suppress(ValueError, TypeError, KeyError):
        manifest = json.loads(str(group.attrs[_MANIFEST]))
        if manifest["quantities"]:
            return manifest
    raise SweepError(f"{name}: is a Zarr store of something else than a sweep")


def _arrays_at(path: PathGiven, name: str, variables: Iterable[str], mode: Literal["r", "r+"]) -> dict[str, zarr.Array]:
    """The arrays of these variables in the sweep at a path."""
    try:
        return {one: zarr.open_array(Path(path, one), mode=mode) for one in variables}
    except (KeyError, ValueError, TypeError) as error:
        raise SweepError(f"{name}: is damaged: {cut(one_line(str(error)))}") from None
