"""Designs for a life of any contact, load and wear law, against scans of the wear over cycles, or other questions."""

import jax
import numpy as np
import pytest
from coated import HOLD, LIFE, RIGID, STEEL, held, is_least, on
from kinds import COEFFICIENT, contact_of
from marks import compiled, long, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from reduced import Reduced

from plgwear_jax import DepthGraded, Layered, loads, material, optimise, wear_laws
from plgwear_jax.optimise.afterwards import overtaken_at
from plgwear_jax.optimise.question import question_of

LAYERS = contact_of(Layered([1e-5], [50e9, 100e9], 0.3))
FORCE, CYCLES = 1.0, LIFE["cycles"]
RANGE = {"k": (-0.6, 0.6)}


def worn(contact, load=FORCE, law=COEFFICIENT):
    """The volume after the life."""
    return contact.over_cycles(load, law).volume(CYCLES)


# --- every contact ----------------------------------------------------------------------------------------------------


@compiled
def test_two_variables_under_an_elastic_indenter_with_a_limit():
    """The best k and E0 beside a scan of both."""
    radius = float(STEEL.steady(0.0).contact_radius)
    bounds = {"k": (-0.4, 0.4), "E0": (60e9, 240e9)}
    found = optimise.design(STEEL, FORCE, bounds, limits={"contact_radius": {"above": radius}}, **LIFE)
    k, modulus = np.linspace(-0.4, 0.4, 9)[:, None], np.geomspace(60e9, 240e9, 9)
    scanned = on(STEEL, k=k, E0=modulus)
    kept = scanned.steady(0.0).contact_radius >= radius
    is_least(found, np.where(kept, worn(scanned), np.nan), within=0.1, run=True)
    assert found.limits["contact_radius_lowest"].active
    assert_allclose(found.value, worn(found.contact), rtol=1e-9)


# --- every test -------------------------------------------------------------------------------------------------------


ONSET = float(RIGID.steady(0.0).gross_slip_displacement)
TESTS = {
    "partial slip": loads.Displacement(0.5 * ONSET, rig_stiffness=2e7),
    # That which the force causes on the reference, by which some coatings slip as a whole.
    "partial and gross slip": loads.Displacement(RIGID.steady(3.0).displacement_amplitude),
    "gross slip": loads.Displacement(3.0 * ONSET),
    "blocks": [loads.Block(1.0, 2e5), loads.Block(loads.Displacement(0.5 * ONSET), 2e5, normal_force=8.0)],
}


@compiled
@parametrize("name", TESTS)
def test_loads_other_than_the_force(name):
    found = optimise.design(RIGID, TESTS[name], RANGE, **LIFE)
    scanned = on(RIGID, k=np.linspace(-0.6, 0.6, 13))
    within = 0.05 if name == "partial and gross slip" else 0.02
    is_least(found, worn(scanned, TESTS[name]), within=within, run=True)
    assert "load: " in repr(found)
    with pytest.raises(ValueError, match="in_steady_state takes a design under force control"):
        optimise.in_steady_state(found)
    if name == "partial slip":  # which a march follows to two digits, in whatever unit of force
        by = optimise.sensitivities(found).saving
        assert abs(by["E0"] + by["normal_force"] + by["rig_stiffness"] - by["wear_coefficient"]) < 0.02
    if name == "gross slip":
        many = optimise.designs(RIGID, loads.Displacement(np.array([0.0, 3.0 * ONSET])), RANGE, **LIFE)
        assert_allclose(many.value, [np.nan, found.value], rtol=1e-9)  # without a motion nothing wears
        assert_allclose(optimise.under_other_load(found, 1.1).best.load.amplitudes, [3.3 * ONSET], rtol=1e-12)


@long  # to march
def test_another_wear_law_over_a_table_of_amplitudes():
    law, force, weight = wear_laws.PressurePower(1e-19, 1.6), np.array([0.8, 1.6]), np.array([3.0, 1.0])
    found = optimise.design(RIGID, force, RANGE, weight=weight, hold=HOLD, cycles=CYCLES, law=law)
    scanned = held(np.linspace(-0.6, 0.6, 13))
    mean = weight @ [worn(scanned, one, law) for one in force] / weight.sum()
    is_least(found, mean, within=0.02, run=True)


@compiled
def test_the_depth_at_a_radius():
    life = {**LIFE, "minimise": {"wear_depth": {"r": 6.6e-5}}}
    found = optimise.design(RIGID, FORCE, RANGE, hold=HOLD, **life)
    assert_allclose(found.value, found.contact.over_cycles(FORCE, COEFFICIENT).depth(6.6e-5, CYCLES), rtol=1e-6)
    for k in (-0.6, 0.0, 0.6):
        assert optimise.along(found, "k", [k]).value[0] >= found.value * (1.0 - 1e-9)


# --- every question ---------------------------------------------------------------------------------------------------


@compiled
def test_fronts_designs_and_sensitivities_of_a_life_agree_with_the_design():
    limit = {"edge_pressure": {"below": 1.0, "distance": 2e-6}}
    asked = {"hold": HOLD, **LIFE}
    front = optimise.front(RIGID, FORCE, RANGE, distance=2e-6, points=3, **asked)
    assert np.all(front.certified) and np.all(np.diff(front.y) < 0.0)
    limit["edge_pressure"]["below"] = float(front.x[1])
    one = optimise.design(RIGID, FORCE, RANGE, limits=limit, **asked)
    assert_allclose(front.y[1], one.value, rtol=1e-9)
    step, slopes = 1e-3, optimise.sensitivities(one)
    lower, upper = (
        optimise.design(RIGID, FORCE, RANGE, limits=limit, hold=HOLD, **LIFE | {"cycles": CYCLES * np.exp(x)})
        for x in (-step, step)
    )
    assert_allclose(slopes.saving["cycles"], (upper.saving - lower.saving) / (2.0 * step), rtol=1e-4)
    assert_allclose(slopes.saving["cycles"], slopes.saving["wear_coefficient"], rtol=1e-4)


@long  # to compile
@parametrize("contact, life", [(RIGID, LIFE), (STEEL, {}), (LAYERS, {})])
def test_designs_within_a_program(contact, life):
    bounds = {"material.modulus[0]": (40e9, 200e9)} if contact is LAYERS else RANGE
    single = optimise.design(contact, FORCE, bounds, **life)
    found = jax.jit(lambda force: optimise.designs(contact, force, bounds, **life))(np.array([FORCE]))
    assert_allclose(found.value, [single.value], rtol=1e-6)
    for name, value in single.variables.items():
        assert_allclose(found.variables[name], [value], rtol=1e-4, atol=1e-5)


@long
def test_a_free_gradient_for_a_life():
    """It wears no more than any corner of the bounds."""
    at, lower, upper = np.array([1e-6, 2e-5, 2e-4]), np.full(3, 60e9), np.full(3, 200e9)
    found = optimise.free_design(RIGID, FORCE, optimise.ModulusProfile(at, lower, upper), starts=3, **LIFE)
    corners = np.stack(np.meshgrid(*np.stack([lower, upper], 1), indexing="ij"), -1).reshape(-1, 3)
    scanned = contact_of(DepthGraded(at, corners, 0.3))
    least = np.nanmin(worn(scanned))  # a run on a stiff depth between compliant ones has no answer
    assert found.converged and least * 0.8 < found.value <= least * (1.0 + 1e-6)
    assert_allclose(found.value, worn(found.contact), rtol=1e-6)


# --- the length of a life ---------------------------------------------------------------------------------------------


@long  # to compile
def test_a_short_life_wants_a_stiff_surface_and_a_long_one_what_the_steady_state_wants():
    force, bounds = 2.0, {"k": (-0.9, 0.9)}
    short, long = (
        optimise.design(
            RIGID, force, bounds, hold=HOLD, law=COEFFICIENT, cycles=N, limits={"transient.wear_volume": {"below": 1.0}}
        )
        for N in (5e5, 1e9)
    )
    assert short.variables["k"] == -0.9 and short.certified
    ever = optimise.in_steady_state(short)
    steady = optimise.design(RIGID, force, bounds, hold=HOLD)
    assert ever.best.variables == steady.variables
    assert ever.volume > ever.reference_volume > steady.value and ever.best_by_then > 2.0 * short.value
    # After so many lives both have worn the same.
    runs = (x.over_cycles(force, COEFFICIENT) for x in (short.contact, steady.contact))
    one, other = (run.volume(ever.flips_at * 5e5) for run in runs)
    assert_allclose(one, other, rtol=2e-3)
    assert long.variables == steady.variables
    assert_allclose(long.value, steady.value, rtol=1e-3)
    assert optimise.in_steady_state(long).flips_at is None
    with pytest.raises(ValueError, match="in_steady_state takes a design for a number of cycles"):
        optimise.in_steady_state(steady)


@compiled
def test_the_best_exponent_for_a_life():
    """x stays when k changes: before the steady state the stiff surface is best, in the end what is best for ever."""
    phi, x = np.array([[0.1], [0.8]]), np.array([1.0, 6.0, 40.0, 1e6])
    found = optimise.optimal_exponent(phi, (-0.8, 0.8), life=x, nu=0.3, digits=2)
    assert found.k.shape == (2, 4) and np.all(found.certified)
    ever = optimise.optimal_exponent(phi[:, 0], (-0.8, 0.8))
    assert_allclose(found.k[:, -1], ever.k, atol=0.01)
    assert_allclose(found.wear_volume[:, -1], ever.wear_volume, rtol=1e-2)
    assert_array_equal(found.k[:, :2], -0.8)  # before the steady state
    assert found.k[1, 2] == 0.8 and np.all(found.at_bound[:, :2])
    # No exponent of a scan wears less.
    k = np.linspace(-0.8, 0.8, 33)[:, None, None]
    scan = Reduced(k, phi, digits=2).volume(x * material.tangential_ratio(k, 0.3))
    more = scan.min(axis=0) / found.wear_volume
    assert np.all((more > 0.995) & (more <= 1.01))


def test_a_saving_ends_where_it_last_changes_its_sign():
    lives = np.geomspace(1.0, 1e4, 9)
    more = 0.01 * np.log(lives / 3e2)
    for once_before in (more[1], 0.02):
        more[1] = once_before
        assert_allclose(overtaken_at(lives, more), 3e2, rtol=1e-12)
    assert overtaken_at(lives, -more) is None and overtaken_at(lives, abs(more)) is None


# --- what stays refused -----------------------------------------------------------------------------------------------


@compiled
def test_a_search_has_no_derivatives_where_only_first_ones_exist():
    for contact, life, load in ((STEEL, {}, loads.Force), (RIGID, LIFE, loads.Displacement)):

        def designed(amplitude, x=contact, life=life, load=load):
            return optimise.designs(x, load(amplitude), RANGE, **life).value

        with pytest.raises(ValueError, match="designs: has no derivatives by the numbers of a contact without closed"):
            jax.grad(designed)(FORCE if load is loads.Force else 0.5 * ONSET)


def test_several_displacements_have_weights():
    load = loads.Displacement(ONSET * np.array([0.2, 0.6, 0.4]), rig_stiffness=3e7)
    question = question_of(RIGID, load, RANGE, weight=[1.0, 1.0, 2.0], **LIFE)
    assert_allclose(question.load.amplitudes, ONSET * np.array([0.6, 0.4, 0.2]), rtol=1e-12)
    assert_allclose(question.load.weight, [0.25, 0.5, 0.25])
