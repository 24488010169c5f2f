"""What a sweep does to its store: it resumes, refuses what is not its own and leaves nothing else behind."""

import os
import re

import numpy as np
import pytest
import xarray as xr
import zarr
from marks import parametrize
from stores import AXES, CHUNKS, QUANTITIES, Stop, files, held, into, refused

from plgwear_jax.sweep import UnfinishedWarning, open_sweep

VARIABLES = ["stick_radius", "stick_radius_dk", "gross_slip_force_ratio"]


def chunk_files(path):
    """The files of chunks, with what they hold."""
    return {place.removeprefix(str(path)): content for place, content in held(path).items() if "/c/" in place}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The chunks of a sweep that nothing stops."""
    out = tmp_path_factory.mktemp("alone") / "alone.zarr"
    into(out)
    return chunk_files(out)


@parametrize(
    "after, error",
    [
        (0, KeyboardInterrupt()),
        (1, RuntimeError("told so")),
        (2, BrokenPipeError(32, "Broken pipe")),
        (5, ValueError()),
    ],
    ids=repr,
)
def test_a_sweep_goes_on(tmp_path, alone, after, error):
    """Stopped by an error of whoever listens to its progress, which arrives as it was raised: it is not the store's."""
    out = tmp_path / "map.zarr"
    with pytest.raises(type(error)) as raised:
        into(out, progress=Stop(after, error))
    assert raised.value is error
    there, done = files(out), chunk_files(out)
    with pytest.warns(UnfinishedWarning, match=rf"^{re.escape(str(out))}: is not finished: \d+ of 28 chunk files are"):
        unfinished = open_sweep(out).attrs["unfinished"]
    assert xr.open_zarr(out).attrs["status"].startswith("unfinished: ")
    listener = Stop()
    into(out, progress=listener)
    after_all = files(out)
    assert all(after_all[f"{out}{place}"] == there[f"{out}{place}"] for place in done)
    assert chunk_files(out) == alone and unfinished == len(alone) - len(done)
    assert listener.chunks == CHUNKS - after
    assert listener.done[0] + 100 * listener.chunks == listener.done[-1] == 1200
    found = open_sweep(out).attrs
    assert found["unfinished"] == 0 and found["status"] == xr.open_zarr(out).attrs["status"] == "finished"
    assert os.listdir(tmp_path) == ["map.zarr"]


def test_a_finished_sweep_is_left_alone(tmp_path, monkeypatch):
    """Nothing is compiled, computed or written again."""
    out = tmp_path / "map.zarr"
    into(out)
    monkeypatch.setattr("plgwear_jax.sweep.plan.SweepPlan.program", None)
    before, listener = files(out), Stop()
    into(out, progress=listener)
    assert files(out) == before
    assert listener.done == [1200]


@parametrize("loss", ["gone", "empty"])
def test_only_the_chunk_that_is_missing_is_computed(tmp_path, loss):
    """A file that is not there, or holds nothing since the disk was full, is all that is written."""
    out = tmp_path / "map.zarr"
    into(out)
    before, content, listener = files(out), held(out), Stop()
    lost = out / "stick_radius" / "c" / "1" / "2"
    lost.unlink() if loss == "gone" else lost.write_bytes(b"")
    into(out, progress=listener)
    assert listener.chunks == 1 and held(out) == content
    after = files(out)
    written = {place for place in content if after[place] != before[place]}
    assert written <= {str(out / name / "c" / "1" / "2") for name in VARIABLES}


def test_a_store_of_other_formulas_is_left_alone(tmp_path, monkeypatch):
    """Which another version of the library computed otherwise."""
    out = tmp_path / "map.zarr"
    into(out)
    monkeypatch.setattr("plgwear_jax.sweep.plan.FORMULAS", 3)
    assert refused(into, out).endswith("holds another sweep: formulas there is 2, here 3; name another folder")


def test_what_killed_writers_left_is_removed(tmp_path):
    """Files and stores that were begun, and the lock."""
    out, other = tmp_path / "map.zarr", tmp_path / ".other.zarr.17.part"
    into(out)
    before = files(out)
    for begun in (out / "stick_radius" / "c" / "0" / ".0a1b.partial", out / ".17ff.partial"):
        begun.write_bytes(b"\0" * 17)
    part = tmp_path / ".map.zarr.17.part"
    (part / "stick_radius").mkdir(parents=True)
    (part / "stick_radius" / "zarr.json").write_text("{")
    (tmp_path / ".map.zarr.lock").touch()
    other.mkdir()
    into(out)
    after = files(out)
    assert after.keys() == before.keys() and all(after[place] == before[place] for place in held(out))
    assert {path.name for path in tmp_path.iterdir()} == {"map.zarr", other.name}


# --- what is refused ------------------------------------------------------------------------------------------------


def holding(folder, **files):
    folder.mkdir()
    for name, content in files.items():
        (folder / name.replace("_", ".")).write_text(content)


def damaged(store, content):
    """A sweep whose first array is gone, or holds something else."""
    into(store)
    about = store / "stick_radius" / "zarr.json"
    about.unlink() if content is None else about.write_text(content)


def a_group(path, **attributes):
    group = zarr.open_group(path, mode="w")
    group.attrs.update(attributes)
    return group


NO_STORE = "is not a Zarr store"
OTHERS = {
    "a file": (lambda path: path.write_text("not a store"), NO_STORE),
    "a folder": (lambda path: holding(path, measured_txt="not to be lost"), NO_STORE),
    "an empty folder": (holding, NO_STORE),
    "a broken store": (lambda path: holding(path, zarr_json="{"), NO_STORE),
    "an array": (lambda path: zarr.create_array(path, shape=(3,), dtype="f8"), NO_STORE),
    "a group": (
        lambda path: a_group(path).create_array("stick_radius", shape=(3,), dtype="f8"),
        "is a Zarr store of something else than a sweep",
    ),
    "no JSON": (lambda path: a_group(path, plgwear_sweep="no JSON"), ""),
    "no manifest": (lambda path: a_group(path, plgwear_sweep="[1]"), ""),
    "an array gone": (lambda path: damaged(path, None), ""),
    "an array broken": (lambda path: damaged(path, "{"), ""),
}


@parametrize("make, said", OTHERS.values(), ids=OTHERS)
def test_what_is_no_sweep_is_left_alone(tmp_path, make, said):
    """One line says what is there instead, whether it is to be written or read."""
    path = tmp_path / "map.zarr"
    make(path)
    before = files(tmp_path)
    for attempt in (into, open_sweep):
        assert refused(attempt, path).startswith(f"{path}: {said}")
    assert files(tmp_path) == before


@parametrize(
    "changes, said",
    [
        ({"phi": np.linspace(0.02, 0.99, 30)}, "phi there is 30 values from 0.01 to 0.99"),
        ({"k": np.nextafter(AXES["k"], 1.0)}, "k there is 40 values"),
        ({"quantities": QUANTITIES[:2]}, "quantities there is"),
        ({"digits": 6}, "digits there is all, here 6"),
        ({"chunk": 50}, "chunk there is [10, 10]"),
        ({name: values.astype(np.float32) for name, values in AXES.items()}, "there is"),
    ],
    ids=["phi", "one_bit", "quantities", "digits", "chunk", "float32"],
)
def test_another_sweep_is_left_alone(tmp_path, changes, said):
    """One line says what makes it another one."""
    out = tmp_path / "map.zarr"
    with pytest.raises(KeyboardInterrupt):
        into(out, progress=Stop(3, KeyboardInterrupt()))
    before, line = held(tmp_path), refused(into, out, **changes)
    assert line.startswith(f"{out}: holds another sweep: ") and said in line
    assert held(tmp_path) == before


def test_one_process_at_a_time(tmp_path):
    """A second sweep into the same store is told of the first, which goes on."""
    out = tmp_path / "map.zarr"
    said = []

    def listen(done, points):
        del done, points
        said.append(refused(into, out))

    into(out, progress=listen)
    assert said == [f"{out}: another process is sweeping into it"] * (CHUNKS + 1)
    assert open_sweep(out).attrs["unfinished"] == 0
    assert os.listdir(tmp_path) == ["map.zarr"]


def test_where_nothing_can_be_put(tmp_path):
    """A file in the place of the folder, no folder at all, a name that is too long: nothing is made."""
    (tmp_path / "file").write_text("not a store")
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / ".map.zarr.lock").mkdir()
    before = files(tmp_path)
    for out in (
        tmp_path / "file" / "map.zarr",
        tmp_path / "no" / "folder" / "map.zarr",
        tmp_path / f"{'m' * 250}.zarr",
        tmp_path / "taken" / "map.zarr",
    ):
        assert refused(into, out).startswith(f"{out}: cannot be written: ")
    assert files(tmp_path) == before
