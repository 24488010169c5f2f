"""The commands `plgwear sweep` and `plgwear plot`: what they write, say and refuse."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from commands import plgwear, refused
from inputs import DESIGNS
from marks import compiled
from matplotlib import image
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, is_told

from plgwear_jax import scene, sweep

SCENE = DESIGNS / "electrical_contact.toml"
MAP = "sweep --k=-0.9:0.9:7 --phi=0.1:0.9:5 --quantity wear_volume,stick_radius.dk --out map.zarr"


def test_a_map_is_written_resumed_and_drawn():
    first = plgwear(MAP)
    assert first.exit_code == 0, first.output
    assert first.stdout.startswith("map.zarr: wear_volume, stick_radius.dk at 35 points: 35 computed in ")
    assert "100%" in first.stderr
    found = sweep.open_sweep("map.zarr")
    k, phi = np.linspace(-0.9, 0.9, 7), np.linspace(0.1, 0.9, 5)
    expected = sweep.sweep(["wear_volume", "stick_radius.dk"], k=k, phi=phi)
    for name in expected:
        assert_array_equal(found[name], expected[name])

    again = plgwear(MAP)
    assert again.stdout == "map.zarr: wear_volume, stick_radius.dk at 35 points: all were computed already\n"
    assert again.stderr == ""
    Path("map.zarr/wear_volume/c/0/0").unlink()
    unfinished = plgwear("plot map.zarr --quantity stick_radius.dk --picture slope.png")
    assert unfinished.stderr == "map.zarr: is not finished: 1 of 2 chunk files are missing, read as NaN\n"
    assert plgwear(MAP).stdout.startswith("map.zarr: wear_volume, stick_radius.dk at 35 points: 35 computed in ")

    drawn = plgwear("plot map.zarr")
    assert drawn.exit_code == 0 and drawn.stdout == "picture: map.png\n" and drawn.stderr == ""
    assert image.imread("map.png").std() > 0.1
    assert {path.name for path in Path().iterdir()} == {"map.zarr", "map.png", "slope.png"}


def test_a_scene_gives_the_contact_and_the_load():
    Path("values.txt").write_text("1e-5\n1e-4\n")
    result = plgwear(f"sweep --scene {SCENE} --z0 values.txt -q wear_volume --out map.zarr")
    assert result.exit_code == 0, result.output
    given = scene.load(SCENE)
    volume = sweep.open_sweep("map.zarr").wear_volume
    assert volume.attrs["units"] == "m^3" and volume.dims == ("z0",)
    assert_allclose(volume.sel(z0=1e-4), given.build_contact().steady(given.load.amplitudes).wear_volume, rtol=1e-13)


@pytest.fixture
def stand_in(monkeypatch):
    """What the library is asked, in place of its answer."""
    asked = {}

    def listen(names, **arguments):
        asked.update(arguments, names=names)
        raise sweep.SweepError("seen")

    monkeypatch.setattr("plgwear_jax.sweep.sweep", listen)
    return asked


def test_any_number_of_the_contact_is_an_axis(stand_in):
    line = f"sweep --scene {SCENE} -q stick_radius --out map.zarr --axis material.nu=0.2:0.3:2 --displacement 1e-8"
    assert plgwear(line).stderr == "seen\n"
    assert stand_in["material.nu"].tolist() == [0.2, 0.3] and stand_in["displacement"] == 1e-8
    assert stand_in["contact"] == scene.load(SCENE).build_contact() and "tangential_force" not in stand_in


def test_tables_of_loads_are_an_axis(stand_in):
    Path("calm.csv").write_text("tangential_force,weight\n0.1,3\n0.3,1\n")
    Path("storm.csv").write_text("weight,tangential_force\n1,3.2\n")
    line = f"sweep --scene {SCENE} --load calm.csv --load storm.csv -q stick_radius --out map.zarr"
    assert plgwear(line).stderr == "seen\n"
    loads = {name: [column.tolist() for column in pair] for name, pair in stand_in["loads"].items()}
    assert loads == {"calm.csv": [[0.1, 0.3], [3.0, 1.0]], "storm.csv": [[3.2], [1.0]]}


def test_the_design_section_says_what_a_best_design_may_be(stand_in):
    result = plgwear(f"sweep --scene {SCENE} --phi=0.1:0.9:3 -q design.k --out map.zarr")
    assert result.stderr == "seen\n" and stand_in["names"] == ["design.k"]
    asked = scene.load(SCENE).arguments()
    assert stand_in["design"] == {name: asked[name] for name in ("vary", "hold", "level", "minimise", "limits")}
    assert "tangential_force" not in stand_in and stand_in["phi"].size == 3


def test_what_a_scene_holds_for_designs_alone_is_said(stand_in):
    line = f"sweep --scene {SCENE} --tangential-force=0.1:0.9:3 --out map.zarr"
    said = f"{SCENE}: wear_volume: E0 and z0 are those of [material] for every k; hold counts for design.* alone"
    heard = plgwear(line, "--k=-0.5:0.5:3 -q wear_volume,design.k").stderr
    assert heard.startswith(said) and heard.count("\n") == 2
    assert plgwear(line, "-q wear_volume").stderr == "seen\n"  # the k of the scene
    assert plgwear(line, "--k=-0.5:0.5:3 --z0=1e-5:1e-3:3 -q wear_volume").stderr == "seen\n"


WORN = """
material = { E0 = 110e9, z0 = 1e-4, k = 0.0, nu = 0.3 }
contact = { kind = "fretting", radius = 5e-3, normal_force = 10.0, friction = 0.4 }
wear = { coefficient = 1e-14, cycles = 4e5 }
design = { minimise = "wear_volume", vary = { k = [-0.5, 0.5] } }
"""
HELD = "load = { displacement = 2e-7, rig_stiffness = 2e7 }"


@cases("cli/held.toml", "loads", "axis")
def test_the_load_of_a_scene_is_held_as_it_says(stand_in, case):
    Path("scene.toml").write_text(WORN + case["load"])
    Path("h.csv").write_text("tangential_force,cycles\n1,2e5\n2,1e5\n")
    quantity = case["quantity"]
    assert plgwear(f"sweep --scene scene.toml {case['axis']} -q {quantity} --out map.zarr").stderr == "seen\n"
    names = ("load", "loads", "displacement", "rig_stiffness", "tangential_force")
    given = {name: value for name, value in stand_in.items() if name in names and not isinstance(value, np.ndarray)}
    assert repr(given) == case["given"]
    lasting = stand_in.get("design", stand_in)
    # blocks have cycles of their own
    assert lasting.get("cycles") == (None if quantity == "wear_volume" or "history" in case["load"] else 4e5)


@compiled
def test_where_some_points_slip_as_a_whole_is_said():
    Path("scene.toml").write_text(f"{WORN}load = {{ displacement = 2.67e-7 }}")
    found = plgwear("sweep --scene scene.toml --friction=0.15:0.45:3 -q transient.wear_volume --out map.zarr")
    assert "gross slip at 1 of 3 points along friction, partial slip at the others" in found.stdout


def test_a_held_displacement_has_no_axis_of_forces():
    Path("scene.toml").write_text(WORN + HELD)
    for quantity in ("transient.wear_rate", "design.k"):
        line = refused(f"sweep --scene scene.toml --phi=0.1:0.2:2 -q {quantity} --out m.zarr")
        assert line == "scene.toml: [load]: a displacement holds no force over cycles; give one, and sweep it"


def test_single_precision_digits_and_bounds_are_passed_on(stand_in):
    line = "sweep --phi=0.1:0.9:3 -q optimal_exponent.k --out map.zarr --chunk 7 --float32 --digits 5"
    plgwear(f"{line} --bounds=-0.5:0.25 --scheduler tcp://there:1")
    assert stand_in["phi"].dtype == np.float32 and stand_in["bounds"] == (-0.5, 0.25)
    assert [stand_in[name] for name in ("digits", "chunk", "scheduler")] == [5, 7, "tcp://there:1"]


@cases("cli/refused.toml", "sweep")
def test_refusals(monkeypatch, case):
    monkeypatch.setattr("plgwear_jax.sweep.cluster._PATIENCE", "0.2s", raising=True)
    Path("nan.txt").write_text("0.1\nnan\n")
    Path("taken.zarr").mkdir()
    Path("taken.zarr/notes.txt").write_text("not to be lost")
    changes, line = case["arguments"], case["line"]
    if "--scheduler" in changes:  # the store is there by then, and goes on with another one
        result = plgwear(MAP, *changes)
        assert (result.exit_code, result.stdout) == (2, "") and result.stderr.splitlines()[-1] == line
    else:
        assert refused(MAP, *changes) == line


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    out = tmp_path_factory.mktemp("sweep") / "map.zarr"
    sweep.sweep(["wear_volume"], k=[0.1, 0.2], phi=[0.1, 0.2], out=out)
    return out


@cases("cli/refused.toml", "plot")
def test_what_cannot_be_drawn(store, case):
    Path("map.zarr").symlink_to(store)
    assert is_told(refused("plot", *case["arguments"]), case)


@compiled
def test_a_sweep_that_is_interrupted_says_how_to_go_on():
    # Python would take down threads that still compute: its end is made to fail, as it then does now and then.
    script = "import atexit, os; from plgwear_jax.__main__ import main; atexit.register(os.abort); main()"
    line = [sys.executable, "-c", script, "sweep", "--k=-0.9:0.9:20000", "--phi=0.1:0.9:20000", "--chunk=65536"]
    line += ["-q", "wear_volume", "--out", "map.zarr"]
    # A shell that starts the tests in the background has them ignore the signal, and all that they start.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    signal.signal(signal.SIGINT, before)
    with process:
        chunks = Path("map.zarr/wear_volume/c")
        while not (chunks.is_dir() and any(chunks.rglob("*"))):
            assert process.poll() is None, process.communicate()
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        out, error = process.communicate(timeout=600)
    assert process.returncode == 130 and out == ""
    assert error.splitlines()[-1].startswith("map.zarr: stopped with ")
    assert error.splitlines()[-1].endswith(" % done; the same command continues it")
    assert "Traceback" not in error and sorted(os.listdir()) == ["map.zarr"]


def test_without_the_extra_one_line_says_what_to_install(monkeypatch):
    monkeypatch.delattr("plgwear_jax.sweep", raising=False)
    monkeypatch.delitem(sys.modules, "plgwear_jax.sweep", raising=False)
    monkeypatch.setitem(sys.modules, "zarr", None)
    assert refused(MAP).endswith("pip install 'plgwear-jax[sweep]', in a clone '.[sweep]'")
