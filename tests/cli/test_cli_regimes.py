"""The command `plgwear regimes`."""

import functools
from pathlib import Path

import commands
import numpy as np
import pytest
from commands import write
from marks import compiled
from matplotlib import image
from numpy.testing import assert_allclose
from refusals import cases, is_told

from plgwear_jax import contact, plots, scene
from plgwear_jax.loads import Force

SCENE = """
material = { E0 = 110e9, z0 = 1e-4, k = 0.5, nu = 0.3 }
contact = { kind = "fretting", radius = 0.005, normal_force = 10.0, friction = 0.4 }
load = { displacement = 1.5e-7 }
"""
refused, told, printed = (
    functools.partial(run, "regimes mine.toml") for run in (commands.refused, commands.told, commands.printed)
)


@pytest.fixture(autouse=True)
def _scene(_folder):
    write(SCENE)


@compiled
def test_the_map_is_told_written_and_drawn():
    found = told("--csv map.csv --picture map.png")
    its = scene.load("mine.toml").build_contact()
    assert found["load"] == {"normal_force": 10.0, "displacement_amplitude": [1.5e-7]}
    moves, forces = (np.array(found[name]) for name in ("displacement_amplitude", "normal_force"))
    onset = found["onset"]["displacement_amplitude"]
    assert moves[0] < 1.5e-7 < onset < moves[-1]
    assert_allclose(forces[[0, -1]], [1.0, 100.0], rtol=1e-6)
    again = contact.slip_regimes(its, moves, forces)
    rows = np.genfromtxt("map.csv", delimiter=",", names=True)
    for name in ("gross_slip", "energy_ratio", "loop_aperture", "tangential_force"):
        assert_allclose(found[name], getattr(again, name), rtol=1e-12)
    assert_allclose(rows["energy_ratio"], np.ravel(found["energy_ratio"]), rtol=1e-12)
    drawn = image.imread("map.png")
    assert drawn.shape[:2] == (968, 2125) and drawn[..., :3].std() > 0.1

    table = printed("--picture map.png")
    assert ["150 nm", "partial", "1.063 N", "0.022", "0.033"] in commands.table_rows(table)
    assert "gross slip begins at 926.8 nm, where the energy ratio is 0.2727 and the sliding ratio 0.3459" in table
    assert "the energy ratio is 0.2 at 804.4 nm, 13.2 % below the transition" in table


def test_ranges_and_a_rig_are_taken(undrawn):
    write(SCENE.replace("displacement = 1.5e-7", "tangential_force = 3.0"))
    found = told("--normal-force 5:20 --displacement 1e-7:1e-5 --rig-stiffness 1e7")
    its = scene.load("mine.toml").build_contact()
    assert found["normal_force"][0] == 5.0
    assert_allclose(found["displacement_amplitude"][-1], 1e-5, rtol=1e-6)
    moved = float(its.steady(Force(3.0, 1e7)).displacement_amplitude)
    assert_allclose(found["load"]["displacement_amplitude"], [moved], rtol=1e-12)
    assert_allclose(found["onset"]["energy_ratio"], its.steady(Force(0.0, 1e7)).gross_slip_energy_ratio, rtol=1e-6)
    write(SCENE.replace("displacement = 1.5e-7", "displacement = 1.5e-6, rig_stiffness = 1e7"))
    own = told()
    # in gross slip
    assert own["rig_stiffness"] == 1e7
    assert_allclose([*own["onset"].values()], [*found["onset"].values()], rtol=1e-9)
    table = printed()
    assert "of the rig" in table and ["1.5 µm", "gross"] in [row[:2] for row in commands.table_rows(table)]


@compiled
def test_two_homogeneous_bodies_have_the_criteria_of_laboratories():
    write(SCENE.replace("k = 0.5", "k = 0.0").replace("0.4 }", "0.4, indenter = { E = 210e9, nu = 0.3 } }"))
    assert_allclose(told()["onset"]["energy_ratio"], 0.2, rtol=1e-12)
    assert "the energy ratio is 0.2 at 589.5 nm, at the transition" in printed()


@cases("cli/refused.toml", "regimes")
def test_refusal(case):
    write(case.get("scene") or SCENE.replace(case.get("old", ""), case.get("new", "")))
    Path("history.csv").write_text("tangential_force,cycles,friction\n5,1,0.9\n")
    assert is_told(refused(*case.get("arguments", ())), case)


@compiled
def test_the_picture_says_what_it_shows():
    its = scene.load("mine.toml").build_contact()
    onset = float(its.steady(0.0).gross_slip_displacement)
    found = contact.slip_regimes(its, onset * np.geomspace(0.03, 30.0, 41), np.geomspace(1.0, 100.0, 11))
    cut = contact.slip_regimes(its, found.displacement_amplitude, [10.0])
    figure = plots.regimes_picture(found, cut, np.array([1.5e-7]))
    left, right = figure.axes
    assert left.get_xlabel().startswith("displacement amplitude $u_x$ (")
    assert left.get_ylabel() == "normal force $F_N$ (N)"
    told = {text.get_text() for text in figure.legends[0].get_texts()}
    assert {"partial slip", "transition to gross slip, energy ratio 0.273", "load of the input file"} <= told
    assert [text.get_text() for text in right.texts] == ["0.2", "0.26", "transition"]
    of_rig = plots.regimes_picture(found, cut, rig_stiffness=1e7).axes[0]
    assert of_rig.get_xlabel().startswith("displacement amplitude of the rig (")
