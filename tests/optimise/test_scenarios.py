"""Designs of uncertain contacts, against the contacts of a dense grid."""

import dataclasses

import numpy as np
import pytest
from coated import HOLD, LIFE, PUNCH, RIGID, STEEL, held, is_least, on, over
from commands import told
from inputs import changed, scene_of
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose
from refusals import cases, is_told, refusal
from test_designs_of_any_quantity import SCENE

from plgwear_jax import optimise, scene
from plgwear_jax.loads import Displacement
from plgwear_jax.optimise import Scenarios
from plgwear_jax.optimise.evaluation import Evaluator
from plgwear_jax.optimise.question import question_of
from plgwear_jax.scene.designing import forces_in_scenarios

FORCE = 1.0
RANDOM = np.random.default_rng(5)
MU, PRESSED = 0.4 * np.exp(0.2 * RANDOM.standard_normal(12)), 10.0 * np.exp(0.1 * RANDOM.standard_normal(12))
WEIGHT = RANDOM.uniform(0.5, 1.5, 12)
UNCERTAIN = on(RIGID, friction=MU, normal_force=PRESSED)
SCENARIOS = Scenarios(UNCERTAIN, WEIGHT)


def scenarios_with(k, **fields):
    """All scenarios along the first axis, with exponents along the next ones."""
    axes = (slice(None), *(None,) * np.ndim(k))
    return on(RIGID, friction=MU[axes], normal_force=PRESSED[axes], k=k, **fields)


K = np.linspace(-0.6, 0.6, 601)


@parametrize("level", [*(compiled_case(x) for x in (0.0, 0.7)), 1.0])
def test_the_best_over_uncertain_friction_and_force(level):
    steady = scenarios_with(K, E0=held(K).material.E0).steady(FORCE)
    limits = {"penetration": {"above": steady.penetration.min(0)[450]}}  # from there on they sink in less
    found = optimise.design(
        RIGID, FORCE, {"k": (-0.6, 0.6)}, hold=HOLD, limits=limits, level=level, scenarios=SCENARIOS
    )
    is_least(found, over(steady.wear_volume[:, :451], WEIGHT, level), within=1e-4)
    there = dataclasses.replace(UNCERTAIN, material=found.contact.material).steady(FORCE)
    assert_allclose(found.value, over(there.wear_volume, WEIGHT, level), rtol=1e-9)
    assert_allclose(found.limits["penetration_lowest"].value, there.penetration.min(), rtol=1e-9)
    before = over(UNCERTAIN.steady(FORCE).wear_volume, WEIGHT, level)
    assert_allclose(found.reference_value, before, rtol=1e-9)


@compiled
def test_where_the_worst_scenario_changes_the_design_stands_between_two():
    """Both wear as much there, one of them less on stiffer surfaces, the other on more compliant ones."""
    friction = np.array([0.11, 3.0])
    stiff = np.array([1.0, 6e-4])
    scenarios = on(RIGID, friction=friction, E0=110e9 * stiff)
    found = optimise.design(RIGID, FORCE, {"k": (-0.6, 0.6)}, level=1.0, scenarios=scenarios)
    volumes = on(RIGID, friction=friction[:, None], E0=110e9 * stiff[:, None], k=K).steady(FORCE).wear_volume
    is_least(found, volumes.max(0), within=0.01)
    assert_allclose(on(scenarios, k=found.variables["k"]).steady(FORCE).wear_volume, found.value, rtol=1e-8)
    assert found.at_bound["k"] is None and not found.scan_found_nothing_better


@compiled
def test_limits_hold_in_every_scenario():
    limits = {"edge_pressure": {"below": 7e8, "distance": 1e-6}, "penetration": {"below": 1.6e-6}}
    bounds = {"k": (-0.6, 0.6), "E0": (60e9, 240e9)}
    asked = {"vary": bounds, "level": 0.7, "scenarios": SCENARIOS}
    found = optimise.design(RIGID, FORCE, **asked, limits=limits)
    k, modulus = np.meshgrid(np.linspace(-0.6, 0.6, 121), np.geomspace(60e9, 240e9, 121), indexing="ij")
    steady = scenarios_with(k, E0=modulus).steady(FORCE)
    pressure, depth = steady.edge_pressure(1e-6).max(0), steady.penetration.max(0)
    worn = over(steady.wear_volume, WEIGHT, 0.7)
    is_least(found, np.where((pressure <= 7e8) & (depth <= 1.6e-6), worn, np.nan), within=0.02)
    assert any(state.active for state in found.limits.values())
    there = dataclasses.replace(UNCERTAIN, material=found.contact.material).steady(FORCE)
    expected = there.edge_pressure(1e-6).max(), there.penetration.max()
    assert_allclose([found.limits[name].value for name in limits], expected, rtol=1e-9)
    # The multiplier of a limit is that of all scenarios together.
    name, state = next((name, state) for name, state in found.limits.items() if state.active)
    step, values = 1e-4, []
    for factor in np.exp([-step, step]):
        looser = limits | {name: limits[name] | {"below": factor * limits[name]["below"]}}
        values.append(np.log(optimise.design(RIGID, FORCE, **asked, limits=looser).value))
    assert_allclose(state.multiplier, (values[0] - values[1]) / (2.0 * step), rtol=1e-3)


@compiled
@parametrize(
    "contact, asked",
    [
        (RIGID, {"hold": HOLD, "limits": {"edge_pressure": {"below": 6e8, "distance": 1e-6}}}),
        (RIGID, {"hold": HOLD, **LIFE}),
        (STEEL, {"hold": HOLD}),
    ],
)
def test_one_scenario_is_the_plain_design(contact, asked):
    plain = optimise.design(contact, FORCE, {"k": (-0.5, 0.5)}, **asked)
    found = optimise.design(contact, FORCE, {"k": (-0.5, 0.5)}, scenarios=contact, **asked)
    assert_allclose(found.value, plain.value, rtol=1e-6)
    assert_allclose(found.variables["k"], plain.variables["k"], atol=1e-4)
    assert found.certified == plain.certified and found.at_bound == plain.at_bound
    for name, state in plain.limits.items():
        assert_allclose(found.limits[name].multiplier, state.multiplier, rtol=1e-6)


@compiled
def test_scenarios_and_amplitudes_count_together():
    force, share = np.array([0.5, 1.0]), np.array([0.7, 0.3])
    asked = {"vary": {"k": (-0.6, 0.6)}, "weight": share, "level": 0.8, "scenarios": SCENARIOS}
    found = optimise.design(RIGID, force, **asked)
    volumes = np.concatenate([scenarios_with(K).steady(one).wear_volume for one in force])
    weight = np.concatenate([one * WEIGHT for one in share])
    is_least(found, over(volumes, weight, 0.8), within=1e-4)
    harder = optimise.under_other_load(found, 1.05)
    assert_allclose(harder.best.value, optimise.design(RIGID, 1.05 * force, **asked).value, rtol=1e-9)


def test_what_varies_has_its_scatter_about_the_reference():
    scenarios = on(RIGID, E0=110e9 * np.array([0.8, 1.3]), k=np.array([0.2, -0.1]))
    question = question_of(RIGID, FORCE, {"k": (-0.5, 0.5), "E0": (60e9, 240e9)}, scenarios=scenarios)
    assert_allclose(Evaluator(question).shared.scale, np.mean(scenarios.steady(FORCE).wear_volume), rtol=1e-12)


@compiled
def test_what_varies_keeps_its_scatter():
    """A modulus within 10 % of what is asked for, and an exponent within 0.05."""
    scenarios = on(RIGID, E0=110e9 * np.array([0.9, 1.1]), k=np.array([0.05, -0.05]))
    found = optimise.design(RIGID, FORCE, {"k": (-0.5, 0.5), "E0": (60e9, 240e9)}, scenarios=scenarios)
    k, modulus = np.meshgrid(np.linspace(-0.5, 0.5, 101), np.geomspace(60e9, 240e9, 21), indexing="ij")
    volumes = [on(RIGID, k=k + dk, E0=f * modulus).steady(FORCE).wear_volume for f, dk in ((0.9, 0.05), (1.1, -0.05))]
    is_least(found, np.mean(volumes, axis=0), within=0.01)


@compiled
def test_uncertain_wear_coefficients_and_friction_in_a_life():
    coefficient = np.array([3e-15, 1e-14, 3e-14])
    uncertain = on(RIGID, friction=np.array([0.3, 0.4, 0.6]))
    scenarios = Scenarios(uncertain, [1.0, 2.0, 1.0], coefficient)
    found = optimise.design(RIGID, FORCE, {"k": (-0.5, 0.5)}, level=0.5, scenarios=scenarios, **LIFE)
    k = np.linspace(-0.5, 0.5, 41)
    grid = on(RIGID, friction=uncertain.friction[:, None], k=k)
    volumes = grid.over_cycles(FORCE, coefficient[:, None]).volume(4e5)
    is_least(found, over(volumes, np.array([1.0, 2.0, 1.0]), 0.5), within=0.01)


@compiled
def test_uncertain_punches():
    depth = np.array([0.5e-6, 1e-6, 2e-6])
    found = optimise.design(PUNCH, None, {"k": (-0.5, 0.5)}, level=1.0, scenarios=on(PUNCH, depth=depth))
    k = np.linspace(-0.5, 0.5, 201)
    grid = on(PUNCH, depth=depth[:, None], k=k)
    is_least(found, grid.steady().volume_change.max(0), within=1e-3)


@parametrize(
    "scenarios, said",
    [
        (STEEL, "scenarios: takes contacts of the same bodies"),
        (on(RIGID, friction=MU, normal_force=PRESSED[:3]), r"one leading axis \(n,\), or none; their"),
        (Scenarios(UNCERTAIN, WEIGHT[:3]), r"their shapes are normal_force \(12,\), friction \(12,\), weight \(3,\)"),
        (Scenarios(UNCERTAIN, -WEIGHT), "scenarios: weight = .* is outside"),
        (Scenarios(UNCERTAIN, 0.0 * WEIGHT), "scenarios: weight: all weights are zero"),
        (Scenarios(UNCERTAIN, law=1e-14), "law takes the kind of law of the design"),
        (on(RIGID, friction=np.array([0.05, 0.4])), "scenarios: tangential_force.* = .* is outside"),
    ],
)
def test_what_is_no_scenario(scenarios, said):
    with pytest.raises(ValueError, match=said):
        optimise.design(RIGID, FORCE, {"k": (-0.5, 0.5)}, scenarios=scenarios)


# --- input files ------------------------------------------------------------------------------------------------------


SCATTER = """friction,normal_force,E0,k,weight
0.35,9.0,100e9,-0.05,1
0.4,10.0,110e9,0.0,2
0.55,12.0,130e9,0.05,1
"""


VARY = "vary = { k = [-0.5, 0.5], friction = [0.3, 0.8] }"
OVER = 'vary = { k = [-0.4, 0.4] }\nscenarios = "scatter.csv"\nover = { cvar = 0.5 }'


def scattered(folder, scatter, *changes):
    text = SCENE.partition("[design.limits]")[0]
    return scene_of(changed(text, (VARY, OVER), *changes), folder, scatter=scatter)


@compiled
def test_an_input_file_names_a_table_of_scenarios(here):
    scattered(here, SCATTER)
    found = told("design scene.toml")
    uncertain = on(
        RIGID,
        E0=np.array([100e9, 110e9, 130e9]),
        k=np.array([-0.05, 0.0, 0.05]),
        friction=np.array([0.35, 0.4, 0.55]),
        normal_force=np.array([9.0, 10.0, 12.0]),
    )
    scenarios = Scenarios(uncertain, np.array([1.0, 2.0, 1.0]))
    best = optimise.design(RIGID, FORCE, {"k": (-0.4, 0.4)}, level=0.5, minimise="deepest_wear", scenarios=scenarios)
    assert_allclose(found["vary"]["k"]["value"], best.variables["k"], atol=1e-9)
    assert_allclose(found["best"]["deepest_wear"], best.value, rtol=1e-9)
    assert found["load"].startswith("scenarios scatter.csv: 3; the wear depth is its mean over the worst 50 %")


@compiled
def test_wear_coefficients_in_a_table_are_those_of_a_life(tmp_path):
    life = ("[design]", "[wear]\ncoefficient = 1e-14\ncycles = 4e5\n[design]")
    found = scattered(tmp_path, "wear_coefficient\n3e-15\n1e-14\n", life, ('"deepest_wear"', '"wear_volume"')).design()
    scenarios = Scenarios(RIGID, law=np.array([3e-15, 1e-14]))
    best = optimise.design(RIGID, FORCE, {"k": (-0.4, 0.4)}, level=0.5, scenarios=scenarios, **LIFE)
    assert_allclose(found.value, best.value, rtol=1e-9)


@cases("optimise/refused.toml", "scatter")
def test_errors_in_a_table_of_scenarios(tmp_path, case):
    line = refusal(scene.SceneError, lambda: scattered(tmp_path, case["content"]).asked())
    assert is_told(line, case, f"{tmp_path}/scatter.csv")


def test_scenarios_stand_alone(tmp_path):
    with pytest.raises(scene.SceneError, match="scenarios: only plgwear design takes them"):
        scattered(tmp_path, SCATTER).front(x="penetration")


# --- under a displacement ---------------------------------------------------------------------------------------------

MOVED = """
material = {{ E0 = 110e9, z0 = 1e-4, k = 0.2, nu = 0.3 }}
contact = {{ kind = "fretting", radius = 5e-3, normal_force = 10.0, friction = {friction} }}
load = {{ displacement = {moved} }}
wear = {{ coefficient = 1e-14{cycles} }}
design = {{ minimise = "wear_volume", vary = {{ k = [-0.3, 0.3] }}, scenarios = "scatter.csv" }}
"""
FRICTION = (0.3, 0.5, 0.7)


def moved(folder, friction, displacement, cycles=", cycles = 1e6"):
    text = MOVED.format(friction=friction, moved=displacement, cycles=cycles)
    return scene_of(text, folder, scatter="\n".join(["friction", *map(str, FRICTION)]))


def test_each_scenario_has_the_force_that_its_displacement_needs(tmp_path):
    contacts = [moved(tmp_path, friction, 1e-6).build_contact() for friction in FRICTION]
    onsets = [float(one.steady(0.0).gross_slip_displacement) for one in contacts]
    for displacement, slips in ((2e-7, 0), (1e-6, 2), (2e-6, 3)):
        given = moved(tmp_path, 0.5, displacement)
        forces = forces_in_scenarios(given)
        assert [displacement >= onset for onset in onsets] == [True] * slips + [False] * (3 - slips)
        expected = [
            np.nan if i < slips else one.steady(Displacement(displacement)).tangential_force
            for i, one in enumerate(contacts)
        ]
        assert_allclose(forces, np.array(expected, float), rtol=1e-12)
        assert given.arguments()["load"] == Displacement(displacement)  # which the life holds
    with pytest.raises(
        scene.SceneError, match=r"scatter.csv: row 2: the whole contact slips; a design for the wear of"
    ):
        moved(tmp_path, 0.7, 1e-6, cycles="").arguments()


@parametrize(
    "friction, displacement, cycles",
    [
        (0.5, 2e-7, ""),
        compiled_case(0.5, 2e-7, ", cycles = 1e6"),
        compiled_case(0.5, 1e-6, ", cycles = 1e6"),  # the reference slips as a whole
        compiled_case(0.7, 1e-6, ", cycles = 1e6"),
    ],
)
def test_scenarios_wear_what_the_scene_of_each_wears(tmp_path, friction, displacement, cycles):
    worn = []
    for each in FRICTION:
        one = moved(tmp_path, each, displacement, cycles)
        worn.append(one.over_cycles().volume(1e6) if cycles else one.solve()["wear_volume"].value)
    given = moved(tmp_path, friction, displacement, cycles)
    assert_allclose(Evaluator(question_of(**given.arguments())).shared.scale, np.mean(worn), rtol=1e-9)
