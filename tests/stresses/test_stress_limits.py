"""Stresses at places and between depths as limits, objectives, axes and pictures, from Python and input files."""

import dataclasses

import jax
import numpy as np
from commands import printed
from inputs import changed, scene_of
from marks import compiled, parametrize
from numpy.testing import assert_allclose
from refusals import data, refusal

from plgwear_jax import Elastic, FrettingContact, Layered, sweep
from plgwear_jax._core.units import written
from plgwear_jax.optimise.evaluation import evaluate
from plgwear_jax.optimise.question import question_of
from plgwear_jax.plots import stress_picture
from plgwear_jax.scene import SceneError

SOFT = Layered([2e-5], [90e9, 210e9], 0.3)  # the coating is more compliant than what lies below
CONTACT = FrettingContact(SOFT, 5e-3, 10.0, 0.5)
SCENE = """
[material]
thickness = [2e-5]
modulus = [90e9, 210e9]
nu = 0.3
[contact]
kind = "fretting"
radius = 5e-3
normal_force = 10.0
friction = 0.5
[load]
tangential_force = 2.5
[output]
quantities = ["tension", "peak_mises_between", "modulus_at"]
x = -5e-5
z = 1e-6
least = 0
most = 2e-5
[design]
vary = { "material.modulus[0]" = [60e9, 500e9] }
minimise = "wear_volume"
[design.limits]
peak_mises_between = [{ below = 0.95e9, least = 0, most = 2e-5 }, { below = 0.81e9, least = 2e-5, most = 1 }]
tension = { below = 2e9, x = -1e-4, z = 0 }
"""


def given(tmp_path, *changes):
    return scene_of(changed(SCENE, *changes), tmp_path)


# --- between depths -----------------------------------------------------------------------------------------------


@compiled
@parametrize("modulus", [30e9, 600e9])
def test_an_interface_belongs_to_neither_part(modulus):
    """The depths of a layer are given as they are, with what rounding makes of them."""
    steady = dataclasses.replace(CONTACT, material=dataclasses.replace(SOFT, modulus=[modulus, 210e9])).steady(2.5)
    step = 1e-9
    above, below = (steady.peak_mises_between(2e-5 - step, 2e-5), steady.peak_mises_between(2e-5, 2e-5 + step))
    at = np.linspace(-2e-4, 2e-4, 801)
    for found, z in ((above, 2e-5 - step), (below, 2e-5 + step)):
        assert_allclose(found, np.max(steady.mises(at, z)), rtol=1e-3)
    assert abs(np.log(below / above)) > 0.1


def test_traced_depths_that_bound_nothing_are_nan():
    traced = jax.jit(dataclasses.replace(CONTACT, material=Elastic(210e9, 0.3)).steady(2.5).peak_mises_between)
    assert np.isnan([traced(2e-6, 1e-6), traced(-1e-6, 1e-6), traced(1e-6, 1e-6)]).all()
    assert np.isfinite(traced(0.0, np.inf))


@compiled
def test_the_derivative_between_depths_is_that_of_differences():
    def value(modulus):
        material = dataclasses.replace(SOFT, modulus=[modulus, 210e9])
        return dataclasses.replace(CONTACT, material=material).steady(2.5).peak_mises_between(2e-5, 1.0)

    step = 1e-3 * 90e9
    by_difference = (value(90e9 + step) - value(90e9 - step)) / (2.0 * step)
    assert_allclose(jax.grad(value)(90e9), by_difference, rtol=1e-3)


# --- designs --------------------------------------------------------------------------------------------------------


def test_a_design_limits_the_peak_that_the_state_has():
    """The search for the peak is a program of its own, with the slopes of the state."""
    name, limits = "material.modulus[0]", {"peak_tension": {"below": 1e8}}
    question = question_of(CONTACT, 2.5, {name: (60e9, 500e9)}, minimise="wear_volume", limits=limits)
    at = evaluate(question, {name: 90e9 * np.exp([-1e-3, 0.0, 1e-3])})
    assert_allclose(1e8 * np.exp(at.values[1, 1]), CONTACT.steady(2.5).peak_tension, rtol=1e-6)
    by_difference = at.values[2] - at.values[0]  # the slopes are by the modulus on another scale
    assert_allclose(at.rows[1, 1, 1] / at.rows[1, 0, 1], by_difference[1] / by_difference[0], rtol=1e-3)


@compiled
def test_a_design_keeps_the_von_mises_stress_of_a_coating_and_of_what_lies_below(tmp_path):
    found = given(tmp_path).design()
    assert found.keeps_limits and found.certified
    coating, below, at = (found.limits[name] for name in ("peak_mises_between[0]", "peak_mises_between[1]", "tension"))
    assert coating.active or below.active  # so that the wear is larger than without them
    steady = found.contact.steady(2.5)
    for state, ends in ((coating, (0.0, 2e-5)), (below, (2e-5, 1.0))):
        assert_allclose(state.value, steady.peak_mises_between(*ends), rtol=1e-6)
    assert_allclose(at.value, steady.tension(-1e-4, 0.0), rtol=1e-6)


@compiled
def test_a_stress_between_depths_is_minimised(tmp_path):
    objective = "minimise = { peak_mises_between = { least = 2e-5, most = 1 } }"
    limits = ("[design.limits]", "[design.limits]\ncontact_radius = { below = 1e-3 }")
    text = SCENE.partition("peak_mises_between = [")[0]
    found = given(tmp_path, (SCENE, text), ('minimise = "wear_volume"', objective), limits).design()
    assert_allclose(found.value, found.contact.steady(2.5).peak_mises_between(2e-5, 1.0), rtol=1e-6)
    assert found.value < CONTACT.steady(2.5).peak_mises_between(2e-5, 1.0)


# --- from the command line ------------------------------------------------------------------------------------------


@compiled
def test_solve_gives_stresses_at_the_places_of_the_input_file(tmp_path):
    found, steady = given(tmp_path).solve(), CONTACT.steady(2.5)
    assert_allclose(found["tension"].value, steady.tension(-5e-5, 1e-6), rtol=1e-9)
    assert_allclose(found["peak_mises_between"].value, steady.peak_mises_between(0.0, 2e-5), rtol=1e-9)
    assert found["modulus_at"].value == 90e9
    assert found["tension"].description.endswith(", x = -50 µm (trailing side), z = 1 µm")


@compiled
def test_the_picture_of_solve_has_both_peaks_in_its_title(tmp_path):
    steady, picture = CONTACT.steady(2.5), tmp_path / "stress.png"
    axes = stress_picture(steady).axes[0]
    peaks = steady.peak_initial_pressure, steady.peak_tension, steady.peak_mises
    p_0, tension, mises = (written(float(peak), "Pa") for peak in peaks)
    assert (
        axes.get_title() == f"largest pressure $p_0$ {p_0}; largest tension {tension}; largest von Mises stress {mises}"
    )
    assert axes.get_ylim()[1] == 0.0
    given(tmp_path)
    printed("solve", f"{tmp_path}/scene.toml", "--picture", str(picture))
    assert picture.stat().st_size > 1000


def test_the_places_of_a_front_are_given_after_its_name(tmp_path):
    asked = given(tmp_path)
    assert asked.traded("x", "tension@-5e-5,0") == {"tension": {"x": -5e-5, "z": 0.0}}
    assert asked.traded("x", "tension") == {"tension": {"x": -1e-4, "z": 0.0}}
    assert asked.traded("x", "peak_mises_between") == {"peak_mises_between": {"least": 0.0, "most": 2e-5}}
    for text, line in data("stresses/traded.toml")["refused"]:
        assert refusal(SceneError, asked.traded, "x", text) == line


@compiled
def test_depths_and_places_are_axes():
    most = np.array([1e-5, 2e-5, 1e-3])
    found = sweep.sweep(["peak_mises_between"], contact=CONTACT, tangential_force=2.5, least=0.0, most=most)
    steady = CONTACT.steady(2.5)
    assert_allclose(found.peak_mises_between, [steady.peak_mises_between(0.0, end) for end in most], rtol=1e-6)
    found = sweep.sweep(["mises"], contact=CONTACT, tangential_force=2.5, x=np.array([-5e-5, 0.0]), z=1e-6)
    assert_allclose(found.mises, steady.mises(np.array([-5e-5, 0.0]), 1e-6), rtol=1e-6)
