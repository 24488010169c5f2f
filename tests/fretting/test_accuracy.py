"""The accuracy that is promised, region by region, against the oracle; `make accuracy` prints the whole table."""

import dataclasses

import accuracy
import functions
import jax.numpy as jnp
import numpy as np
import oracle
import pytest
from hypothesis import given, settings, target
from hypothesis import strategies as st
from mpmath import mp

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax.fretting import deepest, ring
from plgwear_jax.special import gamma

# In SI units every point has eight derivatives: a few points, and all but those that users see first in the long run.
# There as well float32 near the edges of the contact, where it is float64's formulas again, in the bulk, which is
# easier than the edges of the domain, and at these but for the quantities that need most digits there.
SINGLE = ("fretting.wear_volume", "fretting.worn_radius", "fretting.steady_pressure", "gross_slip.volume_change")
# Second derivatives take longest to trace: those of what is minimised and limited, the others further below.
CURVED = ("fretting.wear_volume", "fretting.worn_radius", "fretting.edge_pressure", "gross_slip.volume_change")
# Of these a point takes the oracle a tenth of a second.
COSTLY = (
    "partial_slip.amplitude",
    "material.h_N",
    "fretting.steady_displacement",
    "gross_slip.steady_displacement",
)
ROWS = [
    pytest.param(
        quantity,
        region,
        dtype,
        id=f"{quantity.name}-{region}-{dtype}".replace(" ", "_"),
        marks=pytest.mark.long
        if (region in ("SI", *accuracy.NEAR) and dtype == "float32")
        or (region == "bulk" and dtype == "float32" and "edges" in quantity.regions)
        or (region == "edges" and dtype == "float32" and quantity.name not in SINGLE)
        or (region == "SI" and "holl" in quantity.name)
        else (),
    )
    for dtype in ("float64", "float32")
    for region in ("bulk", "edges", *accuracy.NEAR, "SI")
    for quantity in accuracy.QUANTITIES
    if region in quantity.regions
]


@pytest.mark.parametrize("quantity,region,dtype", ROWS)
def test_errors_stay_within_the_promise(quantity, region, dtype, seed):
    order = 2 if (region, dtype) == ("bulk", "float64") and quantity.name in CURVED else 1
    count = 24 if region == "SI" or quantity.name in COSTLY else 48
    for worst in accuracy.measure(quantity, region, dtype, count, seed, order=order):
        assert worst.error <= worst.kept, str(worst)


@pytest.mark.compiled
@pytest.mark.parametrize("quantity,region,dtype", [row for row in ROWS if row.values[0].order == 2])
def test_errors_of_second_derivatives_stay_within_the_promise(quantity, region, dtype, seed):
    for worst in accuracy.measure(quantity, region, dtype, 96, seed):
        assert worst.error <= worst.kept, str(worst)


@pytest.mark.long
@pytest.mark.parametrize("quantity,region,dtype", ROWS)
def test_errors_stay_within_the_promise_at_20000_points(quantity, region, dtype, seed):
    count = 20_000 if dtype == "float64" else 5_000
    for worst in accuracy.measure(quantity, region, dtype, count, seed=seed + 1, processes=2):
        print(worst)
        assert worst.error <= worst.kept, str(worst)


@pytest.mark.long
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("region", ["bulk", "edges"])
def test_second_derivatives_of_the_deepest_wear_stay_within_the_promise(region, dtype, seed):
    (deepest,) = (quantity for quantity in accuracy.QUANTITIES if quantity.name == "fretting.deepest_wear")
    deepest = dataclasses.replace(deepest, order=2)
    for worst in accuracy.measure(deepest, region, dtype, count=2000, seed=seed, processes=2):
        assert worst.error <= worst.kept, str(worst)


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


def with_gradient(name, *at):
    """The value and the gradient at one point."""
    _, value, gradient, _ = functions.derivatives(name, *(np.array([x]) for x in at))
    return value[0], gradient[0]


@given(k=any_exponent, phi=any_amplitude)
def test_no_point_breaks_the_wear_volume(k, phi):
    value, slopes = with_gradient("fretting.wear_volume", k, phi)
    exact = oracle.derivatives("wear_volume", (k, phi))
    error = abs(float(value) - exact.value) / exact.value
    target(float(error))
    assert error < 5e-13
    for mine, theirs in zip(slopes, exact.gradient, strict=True):
        assert abs(float(mine) - theirs) <= 1e-11 * max(abs(theirs), exact.value)


@given(k=any_exponent, phi=any_amplitude)
def test_no_point_breaks_the_deepest_wear(k, phi):
    value, slopes = with_gradient("fretting.deepest_wear", k, phi)
    exact = oracle.derivatives("deepest_wear", (k, phi))
    error = abs(float(value) - exact.value) / exact.value
    target(float(error))
    assert error < 5e-13
    for mine, theirs in zip(slopes, exact.gradient, strict=True):
        assert abs(float(mine) - theirs) <= 1e-11 * max(abs(theirs), exact.value)


@given(k=any_exponent, phi=any_amplitude)
def test_no_point_breaks_the_worn_radius(k, phi):
    exact = oracle.worn_radius(k, phi)
    error = abs(float(fretting.worn_radius(k, phi)) - exact) / exact
    target(float(error))
    assert error < 5e-13


@settings(max_examples=max(settings().max_examples // 2, 20))  # the oracle's integrals take a tenth of a second each
@given(k=any_exponent, gap=st.floats(-12.0, 3.0).map(lambda x: 10.0**x), inside=st.booleans())
def test_no_point_breaks_the_disc_displacement(k, gap, inside):
    r = 1.0 / (1.0 + gap) if inside else 1.0 + gap
    exact = oracle.gross_steady_displacement(r, k)
    error = abs(float(gross_slip.steady_displacement(r, k)) - exact) / exact
    target(float(error))
    assert error < 5e-13


@given(k=any_exponent, nu=st.floats(-0.9, 0.5))
def test_no_point_breaks_h_N(k, nu):
    exact = oracle.h_N(k, nu)
    error = abs(float(material.h_N(k, nu)) - exact) / exact
    target(float(error))
    assert error < 5e-13


# --- the ways to the ring's edge and to its deepest place ------------------------------------------------------------


def test_the_edge_of_the_ring_is_as_good_as_each_stage_says(seed):
    rng = np.random.default_rng(seed)
    for region in ("bulk", "edges"):
        k, phi = accuracy.k_phi(rng, 100_000, region)
        shape = (0.5 * (1.0 + k), 0.5 * (1.0 - k), phi)
        exact = ring.ring_edge(*map(jnp.asarray, shape), None)
        for digits, error in ((2, 6e-3), (3, 2e-3), (5, 2e-5), (8, 2e-8)):  # the starter, and Halley's step from it
            assert np.max(np.abs(ring.ring_edge(*map(jnp.asarray, shape), None, digits) / exact - 1.0)) < error


def test_the_deepest_place_is_as_good_as_each_stage_says(seed):
    rng = np.random.default_rng(seed)
    for region in ("bulk", "edges"):
        k, phi = accuracy.k_phi(rng, 100_000, region)
        shape = [jnp.asarray(x) for x in (0.5 * (1.0 + k), 0.5 * (1.0 - k), phi)]
        exact = ring.place_of(deepest._DEEPEST, *shape, None, None)
        for digits, error in ((3, 4e-4), (4, 3e-6), (6, 2e-8), (10, 1e-11)):
            found = ring.place_of(deepest._DEEPEST, *shape, None, digits)
            assert np.max(np.abs(found / exact - 1.0)) < error


# --- places of their own --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 1e-12, 2.0**-52])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_volume_change_keeps_its_relative_accuracy_towards_its_zeros(sign, distance):
    k = sign * (1.0 - distance)
    exact = oracle.volume_change(k)
    assert abs(float(gross_slip.volume_change(k)) - exact) < 2e-14 * exact


def test_nothing_happens_at_k_zero():
    radii = (0.3, 0.99, 1.0 - 1e-12, 1.0 + 1e-12, 1.01, 2.0)
    points = [(r, k) for k in (0.0, 1e-16, -1e-16, 1e-14, 1e-8) for r in radii]
    points += [(r, k) for k in (1e-300, -1e-300) for r in (0.99, 1.01)]  # the oracle takes a second for each
    _, values, gradients, _ = functions.derivatives("gross_slip.steady_displacement", *np.array(points).T)
    for point, value, gradient in zip(points, values, gradients, strict=True):
        exact = oracle.derivatives("gross_steady_displacement", point)
        assert abs(float(value) - exact.value) < 2e-14, point
        for a, b in zip(gradient, exact.gradient, strict=True):
            assert abs(float(a) - b) <= 1e-13 * max(abs(b), 1), point


def test_h_N_at_the_ends_of_poissons_ratio():
    for k in (-1.0 + 1e-9, -0.5, 0.0, 0.5, 1.0 - 1e-9):
        exact = oracle.h_N(k, 0.5)
        assert abs(float(material.h_N(k, 0.5)) - exact) < 2e-14 * exact
        with mp.workdps(60):
            holl = oracle.h_N(k, 1 / (2 + mp.mpf(k)))
        assert abs(float(material.h_N(k, "holl")) - holl) < 2e-14 * holl


def test_second_derivatives_of_the_wear_volume_are_symmetric():
    k, phi = np.linspace(-0.9, 0.9, 7), np.linspace(0.05, 0.95, 7)
    hessian = functions.hessians("fretting.wear_volume", k, phi)
    np.testing.assert_allclose(hessian[:, 0, 1], hessian[:, 1, 0], rtol=1e-12)


long = pytest.mark.long  # some seconds each; what the library makes of these is tested above


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("reciprocal_gamma", marks=long),
        pytest.param("volume_numerator", marks=long),
        pytest.param("edge_even", marks=long),
        pytest.param("edge_odd", marks=pytest.mark.compiled),
    ],
)
def test_the_gamma_tables_are_those_of_their_program(name):
    assert tuple(getattr(gamma_tables(), name)()) == getattr(gamma, f"_{name.upper()}")


def gamma_tables():
    import importlib.util
    from pathlib import Path

    path = Path(__file__).parents[2] / "tools" / "gamma_tables.py"
    spec = importlib.util.spec_from_file_location("gamma_tables", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_float32_underflow_is_zero_and_not_nan():
    tiny = jnp.float32(1e-30)
    assert fretting.wear_volume(jnp.float32(0.5), tiny) == 0.0
