"""What a rig is set to: a displacement amplitude, a wear coefficient and a number of cycles, in scenes."""

import numpy as np
import pytest
from inputs import scene_of
from marks import parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, data, is_told, refusal

from plgwear_jax import partial_slip, scene, tables
from plgwear_jax.loads import Displacement, Force

CONTACT = """
material = { E0 = 110e9, z0 = 1e-4, k = 0.25, nu = 0.3 }
contact = { kind = "fretting", radius = 0.005, normal_force = 10.0, friction = 0.4 }
output = { quantities = ["wear_volume"] }
"""
MOVED = "load = { displacement = 5e-8 }"
OF_RIG = "load = { displacement = 5e-7, rig_stiffness = 1e7 }"


def read(load, contact=CONTACT, **files):
    return scene_of(f"{contact}\n{load}\n", **files)


# --- the displacement -------------------------------------------------------------------------------------------------


@parametrize("load, stiffness", [(MOVED, None), (OF_RIG, 1e7)])
def test_a_displacement_is_a_force_of_the_unworn_contact(load, stiffness):
    given = read(load)
    assert given.load.of_displacement
    force = given.load.largest
    moved = given.build_contact().steady(Force(force, stiffness)).displacement_amplitude
    assert_allclose(moved, given.load.displacement, rtol=1e-12)
    assert_allclose(given.solve()["wear_volume"].value, given.build_contact().steady(force).wear_volume, rtol=1e-12)
    assert f"a force amplitude of {force:.4g} N" in (given.load.remark or "")


def test_tables_and_histories_take_displacements():
    given = read('load = { history = "moves.csv", rig_stiffness = 1e7 }', moves="displacement\n2e-8\n0\n6e-8\n")
    expected = given.build_contact().steady(Displacement(np.array([2e-8, 0.0, 6e-8]), 1e7)).tangential_force
    assert_allclose(given.load.amplitudes, expected, rtol=1e-12)
    assert given.load.largest == given.load.amplitudes[2]
    given = read('load = { table = "moves.csv" }', moves="weight,displacement\n1,2e-8\n0,5e-8\n3,6e-8\n")
    expected = given.build_contact().steady(Displacement(np.array([2e-8, 6e-8]))).tangential_force
    assert_allclose(given.load.amplitudes, expected, rtol=1e-12)
    assert_allclose(given.load.weights, [0.25, 0.75])
    assert [*given.load.acting(True).amplitude] == [2e-8, 6e-8]  # which are kept over cycles
    with pytest.raises(tables.TableError, match=r"moves.csv: has no column tangential_force, but"):
        tables.read("moves.csv", tables.LOADS)["tangential_force"]


def told_of_sliding(load):
    """A scene that wears in gross slip, and what it says of it."""
    given = read(f"load = {{ {load} }}\nwear = {{ coefficient_mm3_per_N_m = 1e-5, cycles = 1e5 }}")
    return given, refusal(scene.SceneError, given.solve)


def test_beyond_partial_slip_the_answer_is_what_sliding_wears():
    """And it goes on from the last cycle of partial slip without a jump."""
    contact = read(MOVED).build_contact()
    alone, rig = (float(contact.steady(Force(0.0, x)).gross_slip_displacement) for x in (None, 1e7))
    energy = contact.steady(4.0 * (1.0 - 1e-12)).energy_per_cycle
    for load, begins, where in (
        (f"displacement = {alone}", alone, "626.8 nm"),
        (f"displacement = {rig}, rig_stiffness = 1e7", rig, "1.027 µm at the actuator"),
    ):
        assert told_of_sliding(load)[1] == (
            f"[load] displacement = {begins:g}: this is gross slip, the contact slips as a whole from "
            f"{where} on; by Archard's law with [wear] coefficient_mm3_per_N_m = 1e-05 it wears "
            f"{1e4 * energy / 0.4:.4g} µm³ a cycle at first; plgwear wear goes on, and plgwear design "
            "with cycles under [wear]"
        )
    for law in ("", "wear = { coefficient = 1e-14, half_space_coefficient = 1e-14 }"):
        line = refusal(scene.SceneError, read(f"load = {{ displacement = 5e-6 }}\n{law}").solve)
        told = float(line.split(" N m times the wear coefficient a cycle")[0].split("it wears ")[1])
        k = 0.25
        assert_allclose(told, 10.0 * (4.0 * (5e-6 - alone) + 4.0 * (1.0 + k) / (5.0 + k) * alone), rtol=1e-3)
    assert_allclose(partial_slip.energy_per_cycle(k, 1.0 - 1e-12), 4.0 / (5.0 + k), rtol=1e-6)


def test_the_wear_of_the_first_cycle_of_gross_slip_is_that_of_its_run():
    """Not a number of cycles times it, from which the run differs since the scar grows."""
    given, line = told_of_sliding("displacement = 5e-6")
    told = 1e-18 * float(line.split(" µm³ a cycle at first; ")[0].split()[-1])
    run = given.over_cycles()
    assert_allclose(told, run.rate(0.0), rtol=5e-3)
    assert "in 100000 cycles" not in line and abs(1e5 * told / run.volume(1e5) - 1.0) > 0.01


WANTED = '["wear_volume", "peak_tension", "contact_radius", "initial_pressure"]'


def test_in_gross_slip_what_needs_no_amplitude_is_computed():
    """Of a homogeneous half-space the tension is Hamilton's, under a traction of mu times the pressure."""
    contact = CONTACT.replace("k = 0.25", "k = 0.0").replace('["wear_volume"]', f"{WANTED}, points = 6")
    given = read("load = { displacement = 5e-6, rig_stiffness = 1e7 }", contact)
    found, alone = given.solve(), given.build_contact().steady(0.0)
    assert [*found] == ["peak_tension", "contact_radius", "initial_pressure"]
    assert "slips as a whole" in str(given.load.slides)
    radius, pressure = alone.contact_radius, alone.peak_initial_pressure
    assert found["contact_radius"].value == radius
    radii = found["initial_pressure"].radii
    assert_allclose(radii[-1], 1.25 * radius, rtol=1e-14)
    assert_allclose(found["initial_pressure"].value, alone.initial_pressure(radii), rtol=1e-14)
    hamilton = pressure * ((1.0 - 2.0 * 0.3) / 3.0 + 0.4 * np.pi * (4.0 + 0.3) / 8.0)
    assert_allclose(found["peak_tension"].value, hamilton, rtol=1e-6)
    assert found["peak_tension"].description.endswith(f", x = -{1e6 * radius:.4g} µm (trailing side), z = 0 m")
    # A mean over several amplitudes needs all of them.
    given = read('load = { table = "moves.csv" }', contact, moves="displacement,weight\n1e-8,1\n9e-6,1\n")
    over_r = read('load = { table = "moves.csv" }', contact.replace("initial_pressure", "pressure"))
    assert "is a function of r" in refusal(scene.SceneError, over_r.solve)
    assert [*given.solve()] == ["contact_radius", "initial_pressure"]


def test_gross_slip_names_the_row_of_a_table():
    given = read('load = { table = "moves.csv" }', moves="displacement,weight\n1e-8,1\n\n9e-6,0\n")
    line = refusal(scene.SceneError, given.solve)
    assert line.startswith("moves.csv: row 4: displacement = 9e-06: this is gross slip, ")


# --- the wear coefficient ---------------------------------------------------------------------------------------------


@parametrize("keys, archard", data("scene/wear.toml")["coefficients"])
def test_the_coefficient_has_its_unit_in_its_name(keys, archard):
    assert_allclose(read(f"{MOVED}\nwear = {{ {keys} }}").wear.archard, archard, rtol=1e-15)


# --- what is refused --------------------------------------------------------------------------------------------------


@cases("scene/refused.toml", "rig")
def test_refusal(case):
    line = refusal(scene.SceneError, read, case["more"], forces="tangential_force\n0.3\n")
    assert is_told(line, case, "scene.toml")


# --- tests over cycles ------------------------------------------------------------------------------------------------

CHANGING = "displacement (um),cycles,normal_force_kN,friction\n0.02,1e4,0.01,0.4\n50,10,5e-3,0.3\n"


def test_a_history_changes_the_normal_force_and_the_friction():
    given = read("load = { history = 'h.csv' }\nwear = { coefficient = 1e-14 }", h=CHANGING)
    assert_allclose(given.load.given, [2e-8, 5e-5], rtol=1e-15)
    assert_array_equal(given.load.pressed["normal_force"], [10.0, 5.0])
    assert_array_equal(given.load.pressed["friction"], [0.4, 0.3])
    assert_array_equal(given.load.in_gross_slip, [False, True])
    first, second = given.load.record()
    assert first.load == Displacement(2e-8) and (first.normal_force, first.cycles) == (10.0, 1e4)
    assert second.load == Displacement(5e-5)
    assert given.load.remark is None
    line = refusal(scene.SceneError, given.solve)
    assert line.startswith("[load] history: changes normal_force and friction, so that no ")


@cases("scene/refused.toml", "histories")
def test_refusal_of_a_history_that_changes_forces(case):
    assert is_told(refusal(scene.SceneError, read, "load = { history = 'h.csv' }", h=case["content"]), case)


def test_only_wear_over_cycles_takes_other_wear_laws():
    for key in ("exponent", "half_space_coefficient"):
        given = read(f"{MOVED}\nwear = {{ coefficient = 1e-14, cycles = 1e4, {key} = 1.5 }}")
        with pytest.raises(scene.SceneError, match=rf"^\[wear\] {key} = 1.5: only plgwear wear takes it"):
            _ = given.wear.archard


DESIGN = (
    'wear = { coefficient = 1e-14, cycles = 4e5 }\ndesign = { minimise = "wear_volume", vary = { k = [-0.5, 0.5] } }'
)


def test_designs_for_a_life_in_gross_slip_and_of_blocks():
    asked = read(f"load = {{ displacement = 5e-5 }}\n{DESIGN}").arguments()
    assert asked["load"] == Displacement(5e-5) and asked["cycles"] == 4e5
    given = read(f"load = {{ history = 'h.csv' }}\n{DESIGN}", h=CHANGING)
    asked = given.arguments()
    assert [block.cycles for block in asked["load"]] == [1e4, 10.0] and asked["cycles"] == given.life == 10010.0
    assert asked["load"][1].load == Displacement(5e-5) and asked["load"][1].friction == 0.3
    asked = read(f"load = {{ displacement = 1e-8, rig_stiffness = 1e7 }}\n{DESIGN}").arguments()
    assert asked["load"] == Displacement(1e-8, 1e7)


def test_a_design_refuses_a_history_that_changes_the_normal_force():
    design = 'design = { minimise = "wear_volume", vary = { k = [-0.5, 0.5] } }'
    line = r"^scene.toml: \[design\]: a design cannot be combined with a history that changes the normal force"
    with pytest.raises(scene.SceneError, match=line):
        read(f"load = {{ history = 'h.csv' }}\n{design}", h=CHANGING).asked()


def test_a_scene_without_a_test_says_so():
    for load, line in data("scene/wear.toml")["untested"]:
        with pytest.raises(scene.SceneError, match=line):
            read(load, h="displacement\n1e-8\n").over_cycles()
