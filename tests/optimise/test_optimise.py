"""The optimum found is the optimum: against closed cases, the oracle, dense scans; at bounds and limits, in batches."""

import dataclasses
import functools
import re

import jax
import jax.numpy as jnp
import numpy as np
import oracle
import pytest
from coated import PUNCH, on, over
from coated import RIGID as CONTACT
from functions import by_numpy, fretting, gross_slip
from hypothesis import example, given
from hypothesis import strategies as st
from marks import compiled, parametrize
from mpmath import mp
from numpy.testing import assert_allclose, assert_array_equal
from optima import optima
from refusals import data

from plgwear_jax import DepthGraded, Layered, optimise
from plgwear_jax.loads import Block
from plgwear_jax.optimise import Interval, afterwards, exponent, minimise, search
from plgwear_jax.optimise.question import question_of

SQUARE = {"x": Interval(-2.0, 2.0), "y": Interval(0.1, 10.0, "logarithmic")}


# --- minimise -------------------------------------------------------------------------------------------------------


def bowl(v):
    return (v["x"] - 0.3) ** 2 + (v["y"] - v["x"] ** 2 - 1.0) ** 2 + 3.0


def two_valleys(v):
    return (v["x"] ** 2 - 0.5) ** 2 + 0.1 * v["x"]


RIGHT = 0.6806392764236684  # where the higher valley lies


def test_the_minimum_of_two_variables(in_square):
    found = in_square["bowl"]
    assert found.variables == pytest.approx({"x": 0.3, "y": 1.09}, abs=1e-9)
    assert found.converged and found.certified
    assert not found.scan_found_nothing_better  # nothing is said of several variables


def dip(v):
    """Between two points of the scan, of which they know nothing but a slope."""
    return v["x"] ** 2 - 0.5 * jnp.exp(-(((v["x"] - 0.515) / 0.02) ** 2))


# Both valleys, the right one alone, bounds out of order, an upper bound that moves through the left valley; then hills,
# a dip, and room for a polynomial.
LOWER = np.array([-1.0, 0.3, 0.5, *np.full(7, -2.0), -1.0, -1.0, -1.0])
UPPER = np.array([1.0, 1.0, 0.2, *np.linspace(-1.5, 2.0, 7), 1.0, 1.0, 1.0])
WHICH = np.array([*np.zeros(10, int), 1, 2, 3])
MOVING, HILLS, DIP, POLYNOMIAL = slice(3, 10), 10, 11, 12


@pytest.fixture(scope="module")
def with_polynomial():
    """The two valleys between all these bounds, the hills, the dip and a polynomial, in one program."""

    @functools.partial(jax.vmap, in_axes=(0, 0, 0, None))
    def best(which, lower, upper, coefficients):
        def objective(v):
            hilly, quintic = (
                jnp.sin(40.0 * v["x"]) + v["x"],
                v["x"] * jnp.polyval(coefficients[::-1], v["x"]),
            )
            return jnp.stack([two_valleys(v), hilly, dip(v), quintic])[which]

        return minimise(objective, {"x": Interval(lower, upper)})

    return functools.partial(jax.jit(best), WHICH, LOWER, UPPER)


@pytest.fixture(scope="module")
def between(with_polynomial):
    return with_polynomial(np.zeros(5))


def entry(found, row):
    return jax.tree.map(lambda leaf: leaf[row], found)


FAR = -1.0  # of a limit that is not there


def away(v):
    return (v["x"] - 1.0) ** 2 + (v["y"] - 2.0) ** 2


@pytest.fixture(scope="module")
def in_square():
    """Questions over the same box, by name, in one program."""
    asked = {
        "linear": (lambda v: v["x"] + jnp.log(v["y"]) ** 2 + 2.0 * jnp.log(v["y"]), lambda v: (FAR, FAR)),
        "logarithm": (lambda v: v["x"] ** 2 + jnp.log(v["y"]), lambda v: (FAR, FAR)),
        "away": (away, lambda v: (v["x"] + v["y"] - 1.0, v["x"] - 1.5)),
        "not to be kept": (bowl, lambda v: (5.0 - v["x"], FAR)),
        "bowl": (bowl, lambda v: (FAR, FAR)),
    }

    def best(which):
        return minimise(
            lambda v: jnp.stack([function(v) for function, _ in asked.values()])[which],
            SQUARE,
            limits=lambda v: jnp.array([excess(v) for _, excess in asked.values()])[which],
        )

    found = jax.jit(jax.vmap(best))(np.arange(len(asked)))
    return {name: entry(found, row) for row, name in enumerate(asked)}


def test_the_rival_is_the_other_valley(between):
    found, alone = (entry(between, row) for row in (0, 1))
    assert float(found.variables["x"]) == pytest.approx(-0.7308931031862214, abs=1e-9)  # 4x^3 - 2x + 0.1 = 0
    assert float(found.rival["x"]) == pytest.approx(RIGHT, abs=1e-9)
    assert_allclose(found.rival_value, two_valleys({"x": RIGHT}), rtol=1e-6)
    assert found.scan_found_nothing_better
    assert np.isnan(alone.rival["x"]) and np.isinf(alone.rival_value)


def test_a_bound_is_hit_exactly_and_has_a_multiplier(in_square):
    found = in_square["linear"]
    assert found.variables["x"] == -2.0 and found.side["x"] == -1
    assert_allclose(found.variables["y"], np.exp(-1.0), rtol=1e-6)
    assert found.bound_multipliers == pytest.approx({"x": 1.0, "y": 0.0})
    found = in_square["logarithm"]
    assert found.variables["y"] == 0.1
    assert_allclose(found.bound_multipliers["y"], 1.0, rtol=1e-6)


def test_limits_are_kept_and_weighed_or_it_is_said(in_square):
    # Nearest point of the half-plane x + y <= 1 to (1, 2).
    found, hopeless = in_square["away"], in_square["not to be kept"]
    assert found.variables == pytest.approx({"x": 0.0, "y": 1.0}, abs=1e-9)
    assert_allclose(found.multipliers, [2.0, 0.0], atol=1e-8)
    assert_allclose(found.limits, [0.0, -1.5], atol=1e-9)
    assert [bool(x) for one in (found, hopeless) for x in (one.converged, one.certified)] == [True, True, False, False]
    # broken as little as can be
    assert_allclose(hopeless.limits[0], 3.0, rtol=1e-6)


@compiled
def test_a_descent_that_is_cut_short_says_so():
    found = jax.jit(lambda: minimise(two_valleys, {"x": Interval(-1.0, 1.0)}, max_steps=1))()
    assert found.steps == 1


def test_more_valleys_than_starts_are_not_certified(between):
    found = entry(between, HILLS)
    assert found.converged and not found.certified


def test_proof_is_not_given_where_something_can_hide(between):
    coarse = entry(between, DIP)
    assert not coarse.scan_found_nothing_better or float(coarse.variables["x"]) == pytest.approx(0.5144, abs=1e-3)


@example(coefficients=[2e-9, 0.0, 0.0, 1.0, 0.0])  # its lowest place is flat to the fourth order
@given(coefficients=st.lists(st.floats(-1.0, 1.0), min_size=5, max_size=5))
def test_proven_minima_of_random_polynomials_are_minima(with_polynomial, coefficients):
    found = entry(with_polynomial(np.array(coefficients)), POLYNOMIAL)
    x = np.linspace(-1.0, 1.0, 4001)
    polynomial = np.polynomial.Polynomial([0.0, *coefficients])
    lowest, bend = np.min(polynomial(x)), polynomial.deriv(2)(float(found.variables["x"]))
    # Where it hardly bends, the value is known, but not the place; then the search says that it did not converge.
    assert found.converged or (abs(bend) < 1e-3 and not found.scan_found_nothing_better)
    if bool(found.scan_found_nothing_better):
        assert float(found.value) <= lowest + 1e-12


@compiled
def test_derivatives_follow_the_implicit_function_theorem():
    def best(a, c):
        def objective(v):
            return (v["x"] - a) ** 2 + jnp.exp(c * v["x"]) + v["y"] * v["x"] ** 2 + (v["y"] - 1.0) ** 2

        found = minimise(objective, SQUARE, limits=lambda v: (v["x"] + v["y"] - c)[None])
        return jnp.stack([found.variables["x"], found.variables["y"], found.value, found.multipliers[0]])

    value, forward, reverse = (jax.jit(f) for f in (best, jax.jacfwd(best, (0, 1)), jax.jacrev(best, (0, 1))))
    step = 1e-4
    for a, c in ((0.3, 3.0), (0.3, 0.7)):  # the limit not active, and active
        numeric = [
            (value(a + step, c) - value(a - step, c)) / (2 * step),
            (value(a, c + step) - value(a, c - step)) / (2 * step),
        ]
        for slopes in (forward(a, c), reverse(a, c)):
            assert_allclose(slopes, numeric, atol=1e-7)
    second = jax.jit(jax.hessian(lambda a: best(a, 0.7)[0]))(0.3)
    slopes = [forward(0.3 + h, 0.7)[0][0] for h in (step, -step)]
    assert_allclose(second, (slopes[0] - slopes[1]) / (2 * step), atol=1e-6)


def test_a_known_minimum_moves_with_what_its_function_depends_on():
    def function(u, a):
        # x = a/(1 + y) with y = u + 2 on its lower bound; the limit is not reached, the third changes nothing
        return jnp.stack([1e-6 * ((u[0] - a) ** 2 + (u[1] + 2.0) * u[0] ** 2), u[0] - 5.0])

    def found(a):
        u = jnp.array([[0.15, -1.0, 0.4]])
        return search.implicit(function, (u, 0.0 * u[:, :1], search.rows_at(function, u, 0.3)), a)

    moved, _, rows = by_numpy(jax.jacfwd(found))(np.float64(0.3))
    assert_allclose(np.append(moved, rows[0, 1, 0]), [0.5, 0.0, 0.0, 0.5], atol=1e-12)


def test_bounds_may_be_batched(between):
    # Below its valley, at -0.7309, the function falls towards the upper bound.
    assert_allclose(between.variables["x"][MOVING], np.where(UPPER < -0.7309, UPPER, -0.73089310)[MOVING], atol=1e-8)


def test_traced_bounds_out_of_order_give_nan(between):
    assert_array_equal(np.isnan(between.variables["x"]), LOWER > UPPER)
    assert_array_equal(between.converged, LOWER < UPPER)


# --- the exponent for an amplitude ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def many():
    phi = jnp.linspace(0.001, 0.9999, 500)
    return phi, optima(phi)


def test_no_exponent_of_a_dense_scan_wears_less(many):
    phi, best = many
    assert jnp.all(best.converged & best.certified & best.scan_found_nothing_better)
    k = jnp.linspace(-0.95, 0.95, 2001)
    assert jnp.all(best.wear_volume <= np.min(fretting.wear_volume(k, phi[:, None]), 1) * (1.0 + 1e-14))


def exact_optimum(phi, near):
    with mp.workdps(40):
        return mp.findroot(
            lambda k: oracle.derivatives("wear_volume", (k, phi), wrt=(0,)).gradient[0],
            (near - 1e-4, near + 1e-4),
            tol=1e-30,
        )


def test_interior_optima_are_the_roots_of_the_oracles_derivative(many):
    phi, best = many
    interior = np.flatnonzero(~best.at_bound)
    assert len(interior) > 100
    for i in interior[:: len(interior) // 8]:
        assert abs(float(best.k[i]) - exact_optimum(float(phi[i]), float(best.k[i]))) < 1e-9


def test_the_best_exponent_rises_with_the_amplitude_and_then_jumps(many):
    phi, best = many
    k = best.k
    rises = np.diff(k)
    jump = np.argmin(rises)
    assert np.all(rises[:jump] >= -1e-9)
    # Very close to gross slip the other end is better again, and each is the other's rival.
    assert phi[jump] > 0.99
    ends = slice(jump, jump + 2)
    assert_array_equal(k[ends], [0.95, -0.95])
    assert_array_equal(best.rival[ends], -k[ends])
    assert np.all(best.rival_wear_volume[ends] > best.wear_volume[ends])
    assert np.isnan(best.rival[0]) and np.isinf(best.rival_wear_volume[0])


def test_bounds_are_said_and_hit_exactly_and_may_be_batched():
    best = optima([0.05, 0.7, 0.25, 0.25, 0.0], bounds=([-0.4, -0.4, -0.9, 0.5, -0.95], 0.6))
    assert best.at_bound.tolist() == [True, True, False, True, True]
    assert best.k.tolist() == [-0.4, 0.6, pytest.approx(float(optima(0.25).k[0]), abs=1e-9), 0.5, -0.95]
    # No load wears nothing.
    assert best.wear_volume[4] == 0.0 and best.converged[4]


def test_more_values_than_a_chunk_and_none():
    phi = jnp.linspace(0.05, 0.9, 6).reshape(2, 3)
    best = exponent.in_chunks(lambda phi: {"k": phi + jnp.zeros(2), "none": jnp.zeros(0)}, phi.shape, phi, most=4)
    assert_array_equal(best["k"], phi[..., None] + jnp.zeros(2))
    assert best["none"].shape == (2, 3, 0)
    assert exponent.in_chunks(jnp.sin, (0, 3), jnp.zeros((0, 3))).shape == (0, 3)
    # A single chunk is no loop, in which JAX would lose rules of differentiation.
    ways = fretting.penetration, lambda *at: exponent.in_chunks(fretting.penetration, (), *at)
    assert_allclose(*(by_numpy(jax.hessian(way, 1))(*phi[1, :2]) for way in ways), rtol=1e-10)


# --- loads ----------------------------------------------------------------------------------------------------------


@parametrize("value", [0.0, 0.3, 0.5])
def test_differences_by_poissons_ratio_stay_within_its_range(value):
    steps = afterwards._input_steps("contact.material.nu", value)
    assert np.max(value + steps) <= 0.5 and np.ptp(steps) > 1e-3


@example(table=[(0.3, 0.5), (0.1, 0.25), (0.5, 0.0)], level=1.0, k=0.2)  # what has no weight is not the worst
@given(
    st.lists(st.tuples(st.floats(0.01, 0.99), st.just(0.0) | st.floats(1e-9, 1.0)), min_size=1, max_size=8),
    st.floats(0.0, 1.0),
    st.floats(-0.9, 0.9),
)
def test_the_tail_is_the_cvar_by_its_definition(table, level, k):
    rows = [*table, *(8 - len(table)) * [(0.5, 0.0)]]  # each length would be compiled anew
    phi, weight = (np.array(column) for column in zip(*rows, strict=True))
    counts = weight > 0.0
    if not np.any(counts):
        return
    losses = np.asarray(fretting.wear_volume(k, phi))
    found = np.dot(optimise.tail_weights(phi, weight, level), losses)
    if level > 1.0 - 1e-9:
        assert found >= np.max(losses[counts]) * (1.0 - 1e-6)
    else:
        assert_allclose(found, over(losses[counts], weight[counts], level), rtol=1e-6)


# --- designs --------------------------------------------------------------------------------------------------------

HELD = {"vary": {"k": (-0.9, 0.9)}, "hold": "contact_radius"}


def pressed(most, distance=1e-6, **others):
    """The limit of the edge pressure, with others."""
    return {"edge_pressure": {"below": most, "distance": distance}, **others}


@pytest.fixture(scope="module")
def held():
    return optimise.design(CONTACT, 1.0, **HELD)


def test_design_at_held_contact_radius(held):
    assert held.variables["k"] == pytest.approx(float(optima(0.25, bounds=(-0.9, 0.9)).k[0]), abs=1e-9)
    assert_allclose(held.contact.steady(0.0).contact_radius, CONTACT.steady(0.0).contact_radius, rtol=1e-13)
    assert held.reference is CONTACT and held.objective == "wear_volume"
    assert_allclose(held.value, held.contact.steady(1.0).wear_volume, rtol=1e-6)
    assert_allclose(held.reference_value, CONTACT.steady(1.0).wear_volume, rtol=1e-13)
    assert 0.0 < held.saving < 1.0 and held.at_bound == {"k": None} and held.rival is None
    assert held.converged and held.certified and held.scan_found_nothing_better and held.keeps_limits


def test_a_design_is_a_pytree_with_public_numbers(held):
    again = jax.jit(lambda design: design)(held)
    assert jax.tree.structure(again) == jax.tree.structure(held) and again.variables == held.variables
    assert again.bounds == {"k": (-0.9, 0.9)} and again.hold == "contact_radius" and again.limits == {}
    assert again.load.amplitudes.tolist() == [1.0] and again.at_bound == {"k": None}
    slope = jax.grad(lambda question: question.phi[0])(held.question)
    assert float(slope.contact.friction) == -0.25 / 0.4 and float(slope.load.amplitudes[0]) == 0.25
    both = jax.tree.map(lambda *leaves: jnp.stack(leaves), held, held)
    assert jax.vmap(lambda design: design.saving)(both).tolist() == [held.saving] * 2


def test_what_python_prints_of_a_design_fits_a_screen(held, monkeypatch):
    names = "edge_pressure", "contact_radius_lowest", "contact_radius_highest", "penetration", "worn_radius"
    names += tuple(f"modulus_at[{i}]_{end}" for i in range(2) for end in ("lowest", "highest"))
    states = {
        name: optimise.LimitState(1e-6, 1.0, 0.0, re.sub(r"_lowest|_highest|\[.\]", "", name), name.endswith("lowest"))
        for name in names
    }
    for design in (held, dataclasses.replace(held, limits=states)):
        lines = repr(design).splitlines()
        assert len(lines) <= 12 and max(map(len, lines)) <= 100
        assert f"k = {held.variables['k']:.4g}, between -0.9 and 0.9" in repr(design)
        assert "  the wear is only 27.57 nm deep: the roughness of most surfaces is larger" in lines
    assert "BROKEN" in repr(design)
    comparison = optimise.compared(held)  # instead of that of layers, which takes the compiler seconds
    monkeypatch.setattr("plgwear_jax.optimise.best.compared", lambda _: comparison)
    bodies = Layered([2e-6, 3e-6], [400e9, 200e9, 110e9], 0.3), DepthGraded([0.0, 5e-5], [100e9, 150e9], 0.3)
    contacts = (dataclasses.replace(held.contact, material=body) for body in bodies)
    told, graded = (repr(dataclasses.replace(held, contact=contact)) for contact in contacts)
    assert "E(z) at depths" in graded
    assert "material: thickness = [2 µm, 3 µm], modulus = [400 GPa, 200 GPa, 110 GPa]; contact_radius held" in told
    jax.jit(lambda design: len(repr(design)))(held)
    assert repr(jax.tree.map(lambda leaf: jnp.stack([leaf, leaf]), held)).startswith("Design(of k, wear_volume=")


def test_a_misjudged_load_costs_what_a_new_design_would_save(held):
    told = optimise.under_other_load(held, 1.1)
    again = optimise.design(CONTACT, 1.1, **HELD)
    assert_allclose(told.value, held.contact.steady(1.1).wear_volume, rtol=1e-6)
    assert told.best.variables["k"] == pytest.approx(again.variables["k"], abs=1e-9)
    assert_allclose(told.loss, float(held.contact.steady(1.1).wear_volume / again.value) - 1.0, rtol=1e-6)
    assert told.loss > 0.0
    with pytest.raises(ValueError, match="beyond which the slip is gross"):
        optimise.under_other_load(held, 4.0)


INPUTS = data("optimise/numbers.toml")["inputs"]


def test_inputs_are_all_numbers_of_a_question_as_they_were_given():
    """What a sensitivity is a derivative by: nothing that follows from them is kept."""
    limits = pressed(1e9, penetration={"below": 1e-6}, contact_radius={"between": (5e-5, 7e-5)})
    limits["modulus_at"] = [{"above": 6e10, "z": 1e-5}, {"below": 4e11, "z": 1e-3}]
    question = question_of(on(CONTACT, k=0.1), np.array([1.0, 0.5]), {"k": (-0.5, 0.5)}, limits=limits)
    found = afterwards.inputs(question)
    assert {name: np.asarray(value).tolist() for name, (_, value, _) in found.items()} == INPUTS
    assert found["limit: lowest modulus_at[0]"][2] == "lowest modulus at 10 µm allowed"
    blocks = [Block(1.0, 1e4), Block(2.0, 2e4)]
    found = afterwards.inputs(question_of(CONTACT, blocks, {"k": (-0.5, 0.5)}, cycles=3e4, law=1e-14))
    assert found["load[0].tangential_force"][1:] == (1.0, "tangential force of block 1")


def test_gross_slip_hangs_on_the_exponent():
    found = optimise.design(PUNCH, None, {"k": (-0.5, 0.9)})
    ends = gross_slip.volume_change(jnp.array([-0.5, 0.9]))
    assert found.variables["k"] == [-0.5, 0.9][int(jnp.argmin(ends))] and found.rival is not None
    assert_allclose(found.value, found.contact.steady().volume_change, rtol=1e-6)
    drop = optimise.design(PUNCH, None, {"k": (-0.5, 0.9)}, minimise="force_drop")
    assert drop.variables["k"] == 0.9
    assert_allclose(drop.rival_value, gross_slip.force_drop(-0.5), rtol=1e-6)
    with pytest.raises(ValueError, match="no amplitude to misjudge"):
        optimise.under_other_load(drop)
    told = optimise.sensitivities(drop)
    # On its bound k moves with the bound only; the saving also depends on the k of the reference.
    none = dict.fromkeys(("E0", "z0", "k", "nu", "radius", "depth", "lowest k", "highest k"), 0.0)
    assert told.variables == {name: {"k": pytest.approx(float(name == "highest k"), abs=1e-11)} for name in none}
    value, slope = jax.value_and_grad(gross_slip.force_drop)(0.1)
    best, steepness = jax.value_and_grad(gross_slip.force_drop)(0.9)
    expected = none | {"k": float(best * slope / value**2), "highest k": float(-steepness / value)}
    assert told.saving == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_sensitivities_are_those_of_other_scenes(held):
    told = optimise.sensitivities(held)
    step = 1e-4
    ahead, behind = (optimise.design(CONTACT, np.exp(h), **HELD) for h in (step, -step))
    slope = (ahead.variables["k"] - behind.variables["k"]) / (2 * step)
    assert_allclose(told.variables["tangential_force"]["k"], slope, rtol=1e-6)
    assert_allclose(told.saving["tangential_force"], (ahead.saving - behind.saving) / (2 * step), rtol=1e-6)
    # phi = F_x/(mu F_N), and at a held radius nothing else counts.
    assert_allclose(told.variables["friction"]["k"], -slope, rtol=1e-6)
    assert told.variables["radius"]["k"] == pytest.approx(0.0, abs=1e-12)
    # The wear of the reference depends on its k; the best design, at the same contact radius, does not.
    by_k = jax.grad(lambda k: fretting.wear_volume(k, 0.25))(0.0) / fretting.wear_volume(0.0, 0.25)
    assert told.variables["k"]["k"] == pytest.approx(0.0, abs=1e-12)
    assert_allclose(told.saving["k"], (1.0 - held.saving) * float(by_k), rtol=1e-6)
    assert told.saving.keys() == {"lowest k", "highest k"} | {
        "E0", "z0", "k", "nu", "radius", "normal_force", "friction", "tangential_force",
    }  # fmt: skip


def test_limits_of_a_design_are_kept_and_weighed(held):
    distance = 1e-6
    free = float(held.contact.steady(1.0).edge_pressure(distance))
    tight = optimise.design(CONTACT, 1.0, **HELD, limits=pressed(0.9 * free))
    state = tight.limits["edge_pressure"]
    assert tight.converged and tight.certified and tight.keeps_limits and state.active
    assert_allclose(tight.contact.steady(1.0).edge_pressure(distance), 0.9 * free, rtol=1e-9)
    assert tight.value > held.value
    # The multiplier is what a looser limit saves.
    looser = optimise.design(CONTACT, 1.0, **HELD, limits=pressed(0.9001 * free))
    gain = -np.log(float(looser.value / tight.value)) / np.log(0.9001 / 0.9)
    assert_allclose(state.multiplier, gain, rtol=1e-2)
    loose = optimise.design(CONTACT, 1.0, **HELD, limits=pressed(1.1 * free))
    assert not loose.limits["edge_pressure"].active
    assert loose.variables["k"] == pytest.approx(held.variables["k"], abs=1e-9)
    hopeless = optimise.design(CONTACT, 1.0, **HELD, limits=pressed(1e-3 * free))
    assert not hopeless.converged and not hopeless.keeps_limits and not hopeless.certified
    with pytest.raises(ValueError, match="keeps its limits"):
        optimise.sensitivities(hopeless)
    # What is reachable, from a scan.
    why, k = optimise.conflict(hopeless), np.linspace(-0.9, 0.9, 2001)
    a_0 = float(CONTACT.steady(0.0).contact_radius)
    pressure = fretting.edge_pressure(distance / a_0, k, 0.25) * 10.0 / (np.pi * a_0**2)
    assert why.allowed == {"edge_pressure": 1e-3 * free}
    assert_allclose(why.reachable["edge_pressure"], np.min(pressure), rtol=1e-5)
    assert optimise.conflict(tight) is optimise.conflict(held) is None


@compiled
def test_limits_that_cannot_be_kept_are_told_with_what_is_reachable():
    """But for that of the contact radius, which does no harm."""
    vary = {"k": (-0.5, 0.5), "E0": (50e9, 200e9)}
    limits = pressed(2e8, penetration={"below": 1e-6}, contact_radius={"above": 4e-5})
    why = optimise.conflict(optimise.design(CONTACT, 1.0, vary, limits=limits))
    assert why.allowed == {"edge_pressure": 2e8, "penetration": 1e-6}
    k, E0 = np.meshgrid(np.linspace(*vary["k"], 301), np.geomspace(*vary["E0"], 301))
    steady = on(CONTACT, k=k, E0=E0).steady(1.0)
    pressure, depth = np.asarray(steady.edge_pressure(1e-6)), np.asarray(steady.penetration)
    scanned = {"edge_pressure": pressure[depth <= 1e-6].min(), "penetration": depth[pressure <= 2e8].min()}
    assert_allclose([why.reachable[name] for name in scanned], [*scanned.values()], rtol=1e-2)
    assert all(why.reachable[name] <= best * (1.0 + 1e-9) for name, best in scanned.items())
