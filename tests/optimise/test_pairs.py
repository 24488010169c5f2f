"""Designs of power laws under an elastic indenter, which are solved numerically."""

import numpy as np
import pytest
from coated import on
from inputs import DESIGNS
from kinds import STEEL, contact_of, dome
from marks import compiled, compiled_case, long_case, parametrize
from numpy.testing import assert_allclose
from refusals import data

from plgwear_jax import Cone, Elastic, Layered, PowerShape, optimise, scene, sweep
from plgwear_jax.optimise.evaluation import evaluate
from plgwear_jax.optimise.question import question_of
from plgwear_jax.optimise.scenarios import solved_at

PAIR = dome(0.0, STEEL)
_, _, LIMITS, OF_STEEL, _ = data("optimise/numbers.toml").values()
RANGE = {"k": (-0.5, 0.5)}
FORCES = np.array([1.0, 1.5])


@compiled
def test_a_design_under_a_nearly_rigid_indenter_is_the_closed_one_and_its_slopes_are_right():
    found, closed = (
        optimise.design(dome(0.0, one), FORCES, RANGE, limits=LIMITS) for one in (Elastic(1e19, 0.3), None)
    )
    assert found.certified and closed.certified
    for name, value in closed.variables.items():
        assert_allclose(found.variables[name], value, atol=5e-4 if name == "k" else 0.0, rtol=5e-4)
    assert_allclose([found.value, found.reference_value], [closed.value, closed.reference_value], rtol=3e-4)
    for name, limit in closed.limits.items():
        assert_allclose(found.limits[name].value, limit.value, rtol=3e-4)
        assert_allclose(found.limits[name].multiplier, limit.multiplier, atol=2e-3)
    assert any(limit.active for limit in found.limits.values())

    pair = optimise.design(PAIR, FORCES, RANGE, limits=LIMITS)
    # Slopes against differences, by the same program.
    k = np.array([-0.3, 0.25])
    steps = np.array([-2e-3, -1e-3, 1e-3, 2e-3])
    values = evaluate(pair.question, {"k": (k[:, None] + steps).ravel()}).values.reshape(2, 4, -1)
    slopes = np.einsum("j,ijm->im", [1.0, -8.0, 8.0, -1.0], values) / 12e-3
    assert_allclose(evaluate(pair.question, {"k": k}).rows[:, :, 1], slopes, rtol=2e-6, atol=2e-7)


def test_a_cone_has_its_best_exponent_and_it_moves_as_said():
    """Contacts of the same radius: a numeric contact that is quickly solved, with an optimum between the bounds."""

    def designed(force=0.4):
        return optimise.design(dome(shape=Cone(0.01)), force, {"k": (-0.5, 0.6)}, hold="contact_radius")

    found = designed()
    k = np.append(np.linspace(-0.5, 0.6, 12), found.variables["k"] + np.array([-0.01, 0.01]))
    free = dome(k, shape=Cone(0.01))
    # By its force, a cone has a contact radius to the power 2 + k.
    radius = dome(shape=Cone(0.01)).steady(0.0).contact_radius
    volumes = on(free, E0=110e9 * (free.steady(0.0).contact_radius / radius) ** (2.0 + k)).steady(0.4).wear_volume
    least = int(np.argmin(volumes))
    assert volumes[least] * (1.0 - 1e-4) <= found.value <= volumes[least] * (1.0 + 1e-9)
    assert abs(found.variables["k"] - k[least]) < 0.02 and found.certified
    slopes, step = optimise.sensitivities(found), 1e-3
    lower, upper = ([one.variables["k"], one.saving] for one in map(designed, 0.4 * np.exp([-step, step])))
    told = slopes.variables["tangential_force"]["k"], slopes.saving["tangential_force"]
    assert_allclose(told, np.subtract(upper, lower) / (2.0 * step), rtol=1e-3)
    # phi = F_x/(mu F_N) alone counts.
    assert_allclose([slopes.variables[name]["k"] for name in ("friction", "slope")], [-told[0], 0.0], atol=1e-9)


@compiled
def test_fronts_and_designs_of_many_are_designs_one_by_one():
    limits = {name: one for name, one in OF_STEEL.items() if name != "edge_pressure"}
    front = optimise.front(PAIR, FORCES, RANGE, distance=3e-6, points=4, limits=limits)
    assert np.all(front.certified) and np.all(np.diff(front.y) < 0.0)
    one = OF_STEEL | {"edge_pressure": {"below": float(front.x[1]), "distance": 3e-6}}
    best = optimise.design(PAIR, FORCES, RANGE, limits=one)
    assert_allclose(front.y[1], best.value, rtol=1e-9)
    assert_allclose(front.variables["k"][1], best.variables["k"], atol=1e-8)

    many = optimise.designs(PAIR, np.array([FORCES, 0.0 * FORCES]), RANGE, weight=np.ones(2), limits=one)
    assert_allclose(many.value, [best.value, np.nan], rtol=1e-9)
    assert_allclose(many.variables["k"], [best.variables["k"], np.nan], atol=1e-9)
    assert many.certified.tolist() == [True, False]


def test_between_sixteen_amplitudes_polynomials_are_exact():
    """Of the logarithm of phi/(1-phi), up to the power 15."""
    phi = np.linspace(0.9, 0.01, 24)
    at, shares = solved_at(phi)
    x = [np.log(amplitudes / (1.0 - amplitudes)) for amplitudes in (phi, at)]
    assert at.shape == (16,)
    mine, there = (np.polynomial.chebyshev.chebvander((places + 1.2) / 3.6, 15) for places in x)
    assert_allclose(shares @ there, mine, rtol=0.0, atol=1e-10)


@compiled
def test_a_table_of_many_amplitudes_is_interpolated_between_sixteen():
    force = np.linspace(0.0, 3.6, 24)  # phi up to 0.9
    weight = np.linspace(1.0, 2.0, 24)
    asked_of, k = question_of(PAIR, force, RANGE, weight=weight), np.array([-0.4, 0.3])
    mean = np.average(dome(k[:, None], STEEL).steady(force).wear_volume, axis=1, weights=weight)
    assert_allclose(evaluate(asked_of, {"k": k}).objective, mean, rtol=1e-6)


@parametrize(
    "name",
    [
        compiled_case("blade_root"),  # several amplitudes, a limit at each end of the contact
        compiled_case("railway_axle"),  # with the contact radius held
        long_case("electrical_contact"),
        long_case("steam_generator_tube"),
    ],
)
def test_the_true_pairs_of_the_scenes_have_designs(name):
    given = scene.load(DESIGNS / f"{name}_pair.toml")
    found = given.design()
    assert found.certified and found.keeps_limits and 0.0 < found.saving < 0.3
    load, contact = found.load, found.contact
    # By the methods of the contact, which are another program.
    force, weight = (x[load.weight > 0.0] for x in (load.amplitudes, load.weight))
    steady = contact.steady(force)
    assert_allclose(found.value, np.sum(weight * getattr(steady, found.objective)), rtol=1e-9)
    for state in found.limits.values():
        if state.quantity in ("contact_radius", "penetration"):
            assert_allclose(state.value, getattr(steady, state.quantity)[0], rtol=1e-9)
    if found.hold is not None:
        assert_allclose(steady.contact_radius, found.reference.steady(0.0).contact_radius, rtol=1e-9)


@parametrize("bodies, stiff", [((), -0.7), ((None, PowerShape(3.0)), -0.7), ((STEEL,), -0.5)])
def test_the_stress_at_the_edge_is_that_of_the_body_which_gives_way_more_there(bodies, stiff):
    assert_allclose([dome(k, *bodies).steady(1.0)._edge_exponent for k in (-0.4, 0.4)], [stiff, -0.3])


@compiled
def test_a_sweep_of_layers_does_not_go_on_with_others(tmp_path):
    contact, asked = (
        contact_of(Layered([1e-5], [50e9, 100e9], 0.3), STEEL),
        {"out": tmp_path / "a.zarr", "digits": 2, "indenter.E": np.array([100e9, 210e9])},
    )
    sweep.sweep(["contact_radius"], contact=contact, **asked)
    with pytest.raises(sweep.SweepError, match="holds another sweep: bodies there"):
        sweep.sweep(["contact_radius"], contact=on(contact, modulus=[100e9, 200e9]), **asked)
