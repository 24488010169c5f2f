"""The accuracy that is promised, region by region, against the oracle; `make accuracy` prints the whole table."""

import runpy

import accuracy
import functions
import jax.numpy as jnp
import numpy as np
import oracle
import pytest
from hypothesis import given, target
from hypothesis import strategies as st
from inputs import ROOT
from marks import compiled, compiled_case, long, long_case, parametrize
from numpy.testing import assert_allclose
from refusals import data

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax.fretting import deepest, ring
from plgwear_jax.special import gamma

# In SI units every point has eight derivatives: a few points, and all but those that users see first in the long run.
# There as well float32 near the edges of the contact, where it is float64's formulas again, in the bulk, which is
# easier than the edges of the domain, and at these but for the quantities that need most digits there.
SINGLE = ("fretting.wear_volume", "fretting.worn_radius", "fretting.steady_pressure", "gross_slip.volume_change")
ROWS = [
    pytest.param(
        quantity,
        region,
        dtype,
        id=f"{quantity.name}-{region}-{dtype}".replace(" ", "_"),
        marks=long if dtype == "float32" and (region != "edges" or quantity.name not in SINGLE) else (),
    )
    for dtype in ("float64", "float32")
    for region in ("bulk", "edges", *accuracy.NEAR, "SI")
    for quantity in accuracy.QUANTITIES
    if region in quantity.regions
]
rows = parametrize("quantity,region,dtype", ROWS)


def check(*asked, **how):
    for worst in accuracy.measure(*asked, **how):
        print(worst)
        assert worst.error <= worst.kept, str(worst)


@rows
def test_errors_stay_within_the_promise(quantity, region, dtype, seed):
    check(quantity, region, dtype, 20, seed, order=2 if (region, dtype) == ("bulk", "float64") else 1)


@compiled
@parametrize("quantity,region,dtype", [row for row in ROWS if row.values[0].order == 2])
def test_errors_of_second_derivatives_stay_within_the_promise(quantity, region, dtype, seed):
    check(quantity, region, dtype, 96, seed)


@long
@rows
def test_errors_stay_within_the_promise_at_20000_points(quantity, region, dtype, seed):
    check(quantity, region, dtype, 20_000 if dtype == "float64" else 5_000, seed + 1, processes=2)


# --- the worst point, hunted ----------------------------------------------------------------------------------------

distances = st.floats(0.0, 9.0).map(lambda x: 10.0**-x)
signs = st.sampled_from([-1.0, 1.0])
any_exponent = st.one_of(
    st.floats(-0.97, 0.97),
    st.builds(lambda sign, d: sign * (1.0 - d), signs, distances).filter(lambda k: abs(k) < 1.0),
    st.builds(lambda sign, d: sign * d * 1e-5, signs, distances),
)
any_amplitude = st.one_of(
    st.floats(1e-12, 1.0 - 1e-12),
    st.floats(0.0, 12.0).map(lambda x: 10.0**-x).filter(lambda phi: phi < 1.0),
    st.floats(0.01, 12.0).map(lambda x: 1.0 - 10.0**-x),
)


def hunted(value, exact):
    """An error which hypothesis makes as large as it can."""
    error = float(abs(float(value) - exact) / exact)
    target(error)
    assert error < 5e-13


@parametrize("name", ["wear_volume", "deepest_wear"])
@given(k=any_exponent, phi=any_amplitude)
def test_no_point_breaks_a_wear_and_its_slopes(name, k, phi):
    _, value, slopes, _ = functions.derivatives(f"fretting.{name}", np.array([k]), np.array([phi]))
    exact = oracle.derivatives(name, (k, phi))
    hunted(value[0], exact.value)
    for mine, theirs in zip(slopes[0], exact.gradient, strict=True):
        assert abs(float(mine) - theirs) <= 1e-11 * max(abs(theirs), exact.value)


gaps = st.floats(-12.0, 3.0).map(lambda x: 10.0**x)
radii = st.one_of(gaps.map(lambda gap: 1.0 + gap), gaps.map(lambda gap: 1.0 / (1.0 + gap)))


@parametrize(
    "name, twin, places",
    [
        ("fretting.worn_radius", "worn_radius", (any_exponent, any_amplitude)),
        ("gross_slip.steady_displacement", "gross_steady_displacement", (radii, any_exponent)),
        ("material.h_N", "h_N", (any_exponent, st.floats(-0.9, 0.5))),
    ],
)
@given(data=st.data())
def test_no_point_breaks_a_value(name, twin, places, data):
    at = data.draw(st.tuples(*places))
    hunted(functions.FUNCTIONS[name](*at), oracle.QUANTITIES[twin](*at))


# --- the ways to the ring's edge and to its deepest place ------------------------------------------------------------


# The starter, and Halley's step from it.
@parametrize(
    "root, errors",
    [(ring.EDGE, {2: 6e-3, 3: 2e-3, 5: 2e-5, 8: 2e-8}), (deepest._DEEPEST, {3: 4e-4, 4: 3e-6, 6: 2e-8, 10: 1e-11})],
    ids=["edge of the ring", "deepest place"],
)
def test_a_place_is_as_good_as_each_stage_says(root, errors, seed):
    rng = np.random.default_rng(seed)
    for region in ("bulk", "edges"):
        k, phi = accuracy.k_phi(rng, 20_000, region)
        shape = [jnp.asarray(x) for x in (0.5 * (1.0 + k), 0.5 * (1.0 - k), phi)]
        exact = ring.place_of(root, *shape, None, None)
        for digits, error in errors.items():
            assert np.max(np.abs(ring.place_of(root, *shape, None, digits) / exact - 1.0)) < error


# --- places of their own --------------------------------------------------------------------------------------------


def test_volume_change_keeps_its_relative_accuracy_towards_its_zeros():
    for k in (sign * (1.0 - distance) for distance in (1e-3, 1e-6, 1e-9, 1e-12, 2.0**-52) for sign in (-1.0, 1.0)):
        exact = oracle.volume_change(k)
        assert abs(float(gross_slip.volume_change(k)) - exact) < 2e-14 * exact


def test_nothing_happens_at_k_zero():
    """And beside it, where versions of SciPy's 2F1 are infinite, or off by 1e-6."""
    _, radii, exponents = data("fretting/exponents.toml").values()
    points = [(r, k) for k in exponents for r in radii]
    _, values, gradients, _ = functions.derivatives("gross_slip.steady_displacement", *np.array(points).T)
    exact = [oracle.derivatives("gross_steady_displacement", point) for point in points]
    assert_allclose(values, [float(x.value) for x in exact], rtol=0.0, atol=2e-14)
    slopes = np.array([x.gradient for x in exact], float)
    assert np.all(abs(gradients - slopes) <= 1e-13 * np.maximum(abs(slopes), 1.0))


def test_h_N_at_the_ends_of_poissons_ratio():
    for k in (-1.0 + 1e-9, -0.5, 0.0, 0.5, 1.0 - 1e-9):
        for nu, ratio in ((0.5, 0.5), ("holl", oracle.holl_ratio(k))):
            exact = oracle.h_N(k, ratio)
            assert abs(float(material.h_N(k, nu)) - exact) < 2e-14 * exact


# Some seconds each; what the library makes of these is tested above.
@parametrize(
    "name",
    [
        *(long_case(x) for x in ("reciprocal_gamma", "volume_numerator", "edge_even")),
        compiled_case("edge_odd"),
    ],
)
def test_the_gamma_tables_are_those_of_their_program(name):
    program = runpy.run_path(str(ROOT / "tools" / "gamma_tables.py"))
    assert tuple(program[name]()) == getattr(gamma, f"_{name.upper()}")


def test_float32_underflow_is_zero_and_not_nan():
    assert fretting.wear_volume(jnp.float32(0.5), jnp.float32(1e-30)) == 0.0
