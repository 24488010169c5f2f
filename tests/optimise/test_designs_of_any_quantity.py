"""Designs whose variables are any numbers of the contact, whose objectives and limits are any quantities."""

import numpy as np
import pytest
from coated import RIGID as CONTACT
from commands import told, write
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose

from plgwear_jax import optimise
from plgwear_jax._core.catalogue import FRETTING, TANGENTIAL, read
from plgwear_jax.optimise.evaluation import evaluate
from plgwear_jax.optimise.question import question_of, with_variables

PLACES = {"distance": 2e-6, "r": 6.6e-5, "x": -5e-5, "z": 1e-5, "least": 1e-6, "most": 1e-5}  # within the worn ring
POSITIVE = [
    name for name in FRETTING | TANGENTIAL if name not in ("initial_displacement", "steady_displacement", "tension")
]


def places_of(name):
    return {place: PLACES[place] for place in (FRETTING | TANGENTIAL)[name].arguments if place in PLACES}


FEW = "edge_pressure", "contact_radius", "penetration", "modulus_at"


@parametrize("names", [FEW, compiled_case(POSITIVE)], ids=["few", "all"])
def test_every_quantity_can_be_limited_while_any_number_varies(names):
    """On either side: values against the methods of the contacts, slopes against differences, without the search."""
    limits = {name: {("below", "above")[i % 2]: 1.0 + i, **places_of(name)} for i, name in enumerate(names)}
    bounds = {"friction": (0.3, 0.8), "radius": (2e-3, 2e-2), "nu": (0.0, 0.45)}
    points = {"friction": np.array([0.35, 0.7]), "radius": np.array([6e-3, 4e-3]), "nu": np.array([0.1, 0.4])}
    question = question_of(CONTACT, 1.0, bounds, limits=limits, minimise="deepest_wear")
    assert {one.quantity: one.lowest for one in question.limits} == {x: "above" in one for x, one in limits.items()}
    assert all(one.value in limits[one.quantity].values() for one in question.limits)
    side = np.array([-1.0 if one.lowest else 1.0 for one in question.limits])
    found = evaluate(question, points)
    for i in range(2):
        contact = with_variables(CONTACT, {name: x[i] for name, x in points.items()})
        assert_allclose(found.objective[i], contact.steady(1.0).deepest_wear, rtol=1e-12)
        values = [read(contact, one.quantity, 1.0, one.places) / one.value for one in question.limits]
        assert_allclose(np.exp(side * found.values[i, 1:]), values, rtol=1e-12)
    step = 1e-4
    for column, name in enumerate(bounds):
        ends = np.array([x * np.exp(h) if name != "nu" else x + h for x in points[name][:1] for h in (-step, step)])
        both = evaluate(question, {other: np.repeat(x[:1], 2) for other, x in points.items()} | {name: ends})
        by_difference = np.diff(both.values, axis=0)[0] / (2.0 * step)
        # The place of a peak is that of a search, and so its slope has fewer digits.
        searched = np.array([0.0, *("mises" in one.quantity for one in question.limits)])
        gap = abs(found.rows[0, :, 1 + column] - by_difference)
        assert np.all(gap <= (1e-4 + 2e-4 * searched) * abs(by_difference) + 1e-6 + 2e-6 * searched), name


@compiled
def test_many_designs_take_the_same_questions():
    forces = np.array([0.5, 1.0])
    asked = {"vary": {"k": (-0.5, 0.5), "radius": (2e-3, 8e-3)}, "minimise": "deepest_wear"}
    limits = {"stick_radius": {"above": 5.5e-5}, "edge_pressure": {"below": np.array([7e8, 6e8]), "distance": 1e-6}}
    many = optimise.designs(CONTACT, forces, **asked, limits=limits)
    for i, force in enumerate(forces):
        own = limits | {"edge_pressure": {"below": limits["edge_pressure"]["below"][i], "distance": 1e-6}}
        one = optimise.design(CONTACT, force, **asked, limits=own)
        assert_allclose(many.value[i], one.value, rtol=1e-9)
        for name, value in one.variables.items():
            assert_allclose(many.variables[name][i], value, rtol=1e-6, atol=1e-7)
    assert np.all(many.certified)


SCENE = """
[material]
E0 = 110e9
z0 = 1e-4
k = 0.0
nu = 0.3
[contact]
kind = "fretting"
radius = 0.005
normal_force = 10.0
friction = 0.4
[load]
tangential_force = 1.0
[design]
vary = { k = [-0.5, 0.5], friction = [0.3, 0.8] }
minimise = "deepest_wear"
[design.limits]
pressure = { below = 7e8, distance = 1e-6 }
energy_per_cycle = { above = 3e-9 }
wear_depth = { below = 1e-7, r = 6e-5 }
"""


@compiled
@pytest.mark.usefixtures("here")
def test_an_input_file_takes_limits_of_any_quantity():
    write(SCENE.replace('"deepest_wear"', "{ edge_pressure = { distance = 2e-6 } }"))
    found = told("design mine.toml")
    steady = with_variables(CONTACT, {name: one["value"] for name, one in found["vary"].items()}).steady(1.0)
    limits = found["limits"]
    assert_allclose(found["best"]["edge_pressure"], steady.edge_pressure(found["edge_distance"]), rtol=1e-9)
    assert limits.keys() == {"edge_pressure", "energy_per_cycle_lowest", "wear_depth"}
    expected = steady.edge_pressure(1e-6), steady.energy_per_cycle, steady.wear_depth(6e-5)
    assert_allclose([one["value"] for one in limits.values()], expected, rtol=1e-8, atol=1e-12)
    assert all(one["kept"] for one in limits.values()) and found["certified"]
