"""Designs of power laws under an elastic indenter, which are solved numerically."""

import dataclasses
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from coated import RIGID, on
from marks import compiled, long, parametrize
from numpy.testing import assert_allclose

from plgwear_jax import Cone, Elastic, FrettingContact, Layered, PowerLawGraded, optimise, scene, sweep
from plgwear_jax.cli.design_report import described
from plgwear_jax.optimise.evaluation import evaluate
from plgwear_jax.optimise.question import question_of
from plgwear_jax.optimise.scenarios import solved_at

DESIGN = Path(__file__).resolve().parents[2] / "design"
STEEL = Elastic(210e9, 0.3)
LIMITS: dict[str, Any] = {
    "edge_pressure": {"below": 8e8, "distance": 3e-6},
    "contact_radius": {"above": 6e-5},
    "penetration": {"below": 1e-6},
}
OF_STEEL = LIMITS | {"penetration": {"below": 1.4e-6}}  # which steel can keep
RANGE = {"k": (-0.5, 0.5)}
FORCES = np.array([1.0, 1.5])


def under(indenter: Elastic | None) -> FrettingContact:
    return dataclasses.replace(RIGID, indenter=indenter)


def nearly_the_same(found: optimise.Design, closed: optimise.Design) -> None:
    assert found.certified and closed.certified
    for name, value in closed.variables.items():
        assert_allclose(found.variables[name], value, atol=5e-4 if name == "k" else 0.0, rtol=5e-4)
    for one, other in ((found.value, closed.value), (found.reference_value, closed.reference_value)):
        assert_allclose(one, other, rtol=3e-4)
    for name, limit in closed.limits.items():
        assert_allclose(found.limits[name].value, limit.value, rtol=3e-4)
        assert_allclose(found.limits[name].multiplier, limit.multiplier, atol=2e-3)


@compiled
def test_a_design_under_a_nearly_rigid_indenter_is_the_closed_one_and_its_slopes_are_right():
    found, closed = (optimise.design(under(one), FORCES, RANGE, limits=LIMITS) for one in (Elastic(1e19, 0.3), None))
    nearly_the_same(found, closed)
    assert any(limit.active for limit in found.limits.values())

    pair = optimise.design(under(STEEL), FORCES, RANGE, limits=LIMITS)
    # Slopes against differences, by the same program.
    k = np.array([-0.3, 0.25])
    steps = 1e-3 * np.array([-2.0, -1.0, 1.0, 2.0])
    values = evaluate(pair.question, {"k": (k[:, None] + steps).ravel()}).values.reshape(2, 4, -1)
    slopes = np.einsum("j,ijm->im", [1.0, -8.0, 8.0, -1.0], values) / 12e-3
    assert_allclose(evaluate(pair.question, {"k": k}).slopes[:, :, 0], slopes, rtol=2e-6, atol=2e-7)


def test_a_cone_has_its_best_exponent_and_it_moves_as_said():
    """Contacts of the same radius: a numeric contact that is quickly solved, with an optimum between the bounds."""

    def designed(slope: float = 0.01) -> optimise.Design:
        cone = dataclasses.replace(RIGID, shape=Cone(slope))
        return optimise.design(cone, 0.4, {"k": (-0.5, 0.6)}, hold="contact_radius")

    found = designed()
    k = np.linspace(-0.5, 0.6, 56)
    free = dataclasses.replace(RIGID, shape=Cone(0.01), material=PowerLawGraded(110e9, 1e-4, k, 0.3))
    # By its force, a cone has a contact radius to the power 2 + k.
    radius = np.asarray(dataclasses.replace(RIGID, shape=Cone(0.01)).steady(0.0).contact_radius)
    modulus = 110e9 * (np.asarray(free.steady(0.0).contact_radius) / radius) ** (2.0 + k)
    volumes = dataclasses.replace(free, material=PowerLawGraded(modulus, 1e-4, k, 0.3)).steady(0.4).wear_volume
    least = int(np.argmin(volumes))
    assert float(volumes[least]) * (1.0 - 1e-4) <= float(found.value) <= float(volumes[least]) * (1.0 + 1e-9)
    assert abs(float(found.variables["k"]) - k[least]) < 0.02 and found.certified
    slopes, step = optimise.sensitivities(found), 1e-3
    lower, upper = ([one.variables["k"], one.saving] for one in map(designed, 0.01 * np.exp([-step, step])))
    told = slopes.variables["slope"]["k"], slopes.saving["slope"]
    assert_allclose(told, np.subtract(upper, lower) / (2.0 * step), rtol=1e-3, atol=1e-6)


@compiled
def test_fronts_and_designs_of_many_are_designs_one_by_one():
    limits = {name: one for name, one in OF_STEEL.items() if name != "edge_pressure"}
    front = optimise.front(under(STEEL), FORCES, RANGE, distance=3e-6, points=4, limits=limits)
    assert np.all(front.certified) and np.all(np.diff(front.y) < 0.0)
    one = OF_STEEL | {"edge_pressure": {"below": float(front.x[1]), "distance": 3e-6}}
    best = optimise.design(under(STEEL), FORCES, RANGE, limits=one)
    assert_allclose(front.y[1], best.value, rtol=1e-9)
    assert_allclose(front.variables["k"][1], best.variables["k"], atol=1e-8)

    forces = np.array([FORCES, 0.0 * FORCES])
    many = optimise.designs(under(STEEL), forces, RANGE, weight=np.ones(2), limits=one)
    assert_allclose(many.value, [float(best.value), np.nan], rtol=1e-9)
    assert_allclose(many.variables["k"], [best.variables["k"], np.nan], atol=1e-9)
    assert many.certified.tolist() == [True, False]


def test_between_sixteen_amplitudes_polynomials_are_exact():
    """Of the logarithm of phi/(1-phi), up to the power 15."""
    phi = np.linspace(0.9, 0.01, 24)
    at, shares = solved_at(phi)
    x = [np.log(amplitudes / (1.0 - amplitudes)) for amplitudes in (phi, np.asarray(at))]
    assert at.shape == (16,) and shares is not None
    mine, there = (np.polynomial.chebyshev.chebvander((places + 1.2) / 3.6, 15) for places in x)
    assert_allclose(shares @ there, mine, rtol=0.0, atol=1e-10)


@compiled
def test_a_table_of_many_amplitudes_is_interpolated_between_sixteen():
    force = np.geomspace(0.04, 3.6, 24)  # phi from 0.01 to 0.9
    weight = np.linspace(1.0, 2.0, 24)
    asked_of, k = question_of(under(STEEL), force, RANGE, weight=weight), np.array([-0.4, 0.3])
    each = on(under(STEEL), k=k[:, None]).steady(force).wear_volume
    mean = np.average(each, axis=1, weights=weight)
    assert_allclose(evaluate(asked_of, {"k": k}).objective, mean, rtol=1e-6)


@parametrize(
    "name",
    [
        pytest.param("blade_root", marks=compiled),  # several amplitudes, a limit at each end of the contact
        pytest.param("railway_axle", marks=compiled),  # with the contact radius held
        pytest.param("electrical_contact", marks=long),
        pytest.param("steam_generator_tube", marks=long),
    ],
)
def test_the_true_pairs_of_the_scenes_have_designs(name):
    given = scene.load(DESIGN / f"{name}_pair.toml")
    found = given.design()
    assert found.certified and found.keeps_limits and 0.0 < found.saving < 0.3
    load, contact = found.load, found.contact
    assert load is not None and isinstance(contact, FrettingContact)
    # By the methods of the contact, which are another program.
    force, weight = (x[load.weight > 0.0] for x in (load.amplitudes, load.weight))
    steady, comparison = contact.steady(force), optimise.compared(found)
    compared = comparison.quantities
    assert_allclose(found.value, np.sum(weight * getattr(steady, found.objective)), rtol=1e-9)
    of_limits = {
        "contact_radius": steady.contact_radius,
        "penetration": steady.penetration[0],
        "edge_pressure": steady.edge_pressure(comparison.distance)[0],
    }
    for state in found.limits.values():
        if state.quantity in of_limits:
            assert_allclose(state.value, of_limits[state.quantity], rtol=1e-9)
    for quantity in {"stick_radius", "worn_radius", "wear_volume"} - {found.objective}:  # which is over the whole load
        assert_allclose(compared[quantity][0], getattr(steady, quantity)[0], rtol=1e-9)
    if found.hold is not None:
        assert_allclose(*compared["contact_radius"], rtol=1e-9)


@parametrize("indenter, stiff", [(None, -0.7), (STEEL, -0.5)])
def test_the_stress_at_the_edge_is_that_of_the_body_which_gives_way_more_there(indenter, stiff):
    found: Any = SimpleNamespace(
        contact=dataclasses.replace(under(indenter), material=PowerLawGraded(110e9, 1e-4, -0.4, 0.3)),
        reference=dataclasses.replace(under(indenter), material=PowerLawGraded(110e9, 1e-4, 0.4, 0.3)),
        variables={},
        reference_variables={},
    )
    told = described(found, SimpleNamespace(quantities={"edge_pressure": [1.0, 1.0]}))  # pyright: ignore[reportArgumentType]
    assert_allclose(told["edge_exponent"], [stiff, -0.3])


def layered():
    return dataclasses.replace(under(STEEL), material=Layered([1e-5], [50e9, 100e9], 0.3))


@compiled
def test_a_sweep_of_layers_does_not_go_on_with_others(tmp_path):
    contact, asked = layered(), {"out": tmp_path / "a.zarr", "digits": 2, "indenter_E": np.array([100e9, 210e9])}
    sweep.sweep(["contact_radius"], contact=contact, **asked)
    stiffer = dataclasses.replace(contact, material=Layered([1e-5], [100e9, 200e9], 0.3))
    with pytest.raises(sweep.SweepError, match="holds another sweep: bodies there"):
        sweep.sweep(["contact_radius"], contact=stiffer, **asked)
