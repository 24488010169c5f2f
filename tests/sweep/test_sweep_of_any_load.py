"""Sweeps over cycles under displacements that are held, in gross slip, and blocks: beside the runs of the contact."""

import numpy as np
import pytest
from inputs import scene_of
from kinds import dome
from marks import compiled
from numpy.testing import assert_allclose, assert_array_equal

from plgwear_jax import loads, optimise, sweep
from plgwear_jax.loads import Displacement

CONTACT = dome()
ONSET = float(CONTACT.steady(0.0).gross_slip_displacement)
LIFE = {"cycles": 1e5, "wear_coefficient": 1e-14}
LAW = {"cycles": 1e5, "law": 1e-14}  # the same for designs
BLOCKS = [loads.Block(1.0, 2e5), loads.Block(loads.Displacement(0.5 * ONSET), 2e5, normal_force=8.0)]
MOVED, RIGS = ONSET * np.array([0.5, 3.0]), np.array([1e7, 1e8])


@compiled
def test_a_held_displacement_and_the_stiffness_of_its_rig_are_axes(tmp_path):
    names, out = ["transient.wear_volume", "transient.contact_radius"], tmp_path / "map.zarr"
    asked = {"contact": CONTACT, "load": loads.Displacement(MOVED, RIGS), **LIFE}
    found = sweep.sweep(names, **asked, out=out, chunk=2)
    run = CONTACT.over_cycles(loads.Displacement(MOVED[:, None], RIGS), LIFE["wear_coefficient"])
    assert found.transient_wear_volume.dims == ("displacement", "rig_stiffness")
    assert_allclose(found.transient_wear_volume, run.volume(LIFE["cycles"]), rtol=1e-5)
    assert_allclose(found.transient_contact_radius, run.contact_radius(LIFE["cycles"]), rtol=1e-5)
    assert found.displacement.attrs["long_name"] == "amplitude of the tangential displacement"
    assert found.rig_stiffness.attrs["units"] == "N/m"

    held = {"contact": CONTACT, **LIFE, "displacement": MOVED, "rig_stiffness": RIGS}
    by_axes = sweep.sweep(names, **held, out=out, chunk=2)  # the same question, in other words
    assert_array_equal(by_axes.transient_wear_volume, found.transient_wear_volume)
    with pytest.raises(sweep.SweepError, match="holds another sweep"):
        sweep.sweep(names, **(held | {"displacement": 0.9 * MOVED}), out=out, chunk=2)


@compiled
def test_numbers_of_blocks_and_their_scale_are_axes():
    by_path = {"load[1].normal_force": [7.0, 8.0], "wear_coefficient": 1e-14}  # after all cycles of the blocks
    found = sweep.sweep("transient.wear_volume", contact=CONTACT, load=BLOCKS, factor=[0.5, 1.0], **by_path)
    volume = found.transient_wear_volume
    assert volume.dims == ("factor", "load[1].normal_force")
    assert found["load[1].normal_force"].attrs["long_name"] == "normal force F_N, of block 2"
    expected = CONTACT.over_cycles(BLOCKS, 1e-14).volume(4e5)
    assert_allclose(volume[1, 1], expected, rtol=1e-5)
    half = [loads.Block(0.5, 2e5), loads.Block(loads.Displacement(0.25 * ONSET), 2e5, normal_force=7.0)]
    expected = CONTACT.over_cycles(half, 1e-14).volume(4e5)
    assert_allclose(volume[0, 0], expected, rtol=1e-5)


def test_the_stiffness_of_a_rig_and_the_scale_of_a_table_under_the_force():
    names = ["penetration", "displacement_amplitude"]
    found = sweep.sweep(names, contact=CONTACT, displacement=MOVED, rig_stiffness=RIGS)
    steady = CONTACT.steady(Displacement(MOVED[0], RIGS))
    assert_allclose(found.penetration[0], CONTACT.steady(steady.tangential_force).penetration, rtol=1e-12)
    assert_allclose(found.displacement_amplitude[0], MOVED[0], rtol=1e-12)
    assert np.isnan(found.penetration[1]).all()  # the contact slips as a whole
    table = {"calm": ([1.0, 2.0], [1.0, 3.0])}
    found = sweep.sweep("penetration", contact=CONTACT, loads=table, factor=[0.5, 1.0])
    mean = CONTACT.steady(np.array([[0.5, 1.0], [1.0, 2.0]])).penetration @ np.array([0.25, 0.75])
    assert_allclose(found.penetration, mean, rtol=1e-12)
    with pytest.raises(sweep.AxisError, match=r"^tangential_force = 4.0: this is gross slip"):
        sweep.sweep("penetration", contact=CONTACT, loads=table, factor=[1.0, 2.0])
    with pytest.raises(sweep.AxisError, match=r"^load\[0\].load.lasts: is no axis of a FrettingContact"):
        sweep.sweep("transient.wear_volume", contact=CONTACT, load=BLOCKS, **LIFE, **{"load[0].load.lasts": [0.5, 1.0]})
    found = sweep.sweep("penetration", contact=CONTACT, load=loads.Force([1.0, 2.0]))
    assert_array_equal(found.tangential_force, [1.0, 2.0])


# --- a displacement, of partial and of gross slip ---------------------------------------------------------------------

SCENE = """
material = {{ E0 = 110e9, z0 = 1e-4, k = 0.0, nu = 0.3 }}
contact = {{ kind = "fretting", radius = 5e-3, normal_force = 10.0, friction = {friction} }}
load = {{ displacement = {moved} }}
wear = {{ coefficient = 1e-14, cycles = 1e5 }}
"""


def worn_in_scenes(folder, frictions, moved):
    """What `plgwear wear` has worn after the life in one input file after the other."""
    found = []
    for friction in frictions:
        run = scene_of(SCENE.format(friction=friction, moved=moved), folder).over_cycles()
        found.append(run.volume(LIFE["cycles"]))
    return found


@compiled
def test_sweeps_wear_what_the_scenes_of_their_points_wear(tmp_path):
    moved, frictions, slips = 0.6 * ONSET, (0.15, 0.2, 0.4, 0.6), [True, True, False, False]
    found = sweep.sweep(
        ["transient.wear_volume", "wear_volume"], contact=CONTACT, displacement=moved, friction=frictions, **LIFE
    )
    assert_array_equal(found.gross_slip, slips)
    assert found.gross_slip.attrs["long_name"] == "the whole contact slips before any wear"
    assert_allclose(found.transient_wear_volume, worn_in_scenes(tmp_path, frictions, moved), rtol=1e-9)
    assert found.transient_wear_volume.attrs["digits"] == "2"
    assert_array_equal(np.isnan(found.wear_volume), slips)
    assert found.wear_volume.attrs["digits"] == "all of float64"


@compiled
def test_designs_over_lives_in_gross_slip():
    load = loads.Displacement(3.0 * ONSET)
    asked = {"vary": {"k": (-0.6, 0.6)}, **LAW}
    found = sweep.sweep(["design.k", "design.saving"], contact=CONTACT, load=load, design=asked, cycles=[1e5, 4e5])
    one = optimise.design(CONTACT, load, **(asked | {"cycles": 4e5}))
    assert_allclose(found.design_k[1], one.variables["k"], atol=1e-6)
    assert_allclose(found.design_saving[1], one.saving, rtol=1e-5)
