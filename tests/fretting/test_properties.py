"""What the paper promises about every result: ranges, signs, limits.

Points come from hypothesis, eight at a time so that every function is compiled for one shape only; they crowd at the
ends of the domain. EPS is the rounding unit of float64; each tolerance is a few of it times what the formula loses.
"""

import math

import numpy as np
from functions import derivatives, fretting, gross_slip
from hypothesis import given
from hypothesis import strategies as st
from marks import parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import data

from plgwear_jax import PowerLawGraded

EPS = np.finfo(float).eps
POINTS = 8

near_one = st.floats(1e-15, 1e-3).map(lambda x: 1.0 - x)
exponent = st.one_of(
    st.floats(-0.999, 0.999, allow_subnormal=False),  # XLA takes subnormal numbers for zero
    near_one,
    near_one.map(lambda x: -x),
    st.sampled_from([0.0, 1e-300, -1e-9, math.nextafter(1.0, 0.0), math.nextafter(-1.0, 0.0)]),
)
amplitude = st.one_of(
    st.floats(1e-3, 0.999),
    st.floats(-300.0, -3.0).map(lambda e: 10.0**e),
    near_one,
    st.sampled_from([0.0, 5e-324, 2.5e-308, 0.25, 0.5, math.nextafter(1.0, 0.0)]),
)
ratio = st.one_of(st.floats(0.0, 1.0), st.floats(-15.0, -1.0).map(lambda e: 10.0**e))


def several(element):
    return st.lists(element, min_size=POINTS, max_size=POINTS).map(np.array)


EXPONENTS, AMPLITUDES = several(exponent), several(amplitude)
GRID_K, GRID_PHI = (
    x.ravel()
    for x in np.meshgrid(
        [-1.0 + 1e-9, -0.95, -0.5, -0.1, 0.0, 0.169, 0.5, 0.9, 1.0 - 1e-9], [0.0, 1e-9, 0.1, 0.4, 0.8, 0.99, 1.0 - 1e-9]
    )
)


def edges(k, phi):
    """(Stick radius, worn radius)."""
    return fretting.stick_radius(k, phi), fretting.worn_radius(k, phi)


# --- radii ----------------------------------------------------------------------------------------------------------


@parametrize("amplitude", [0.0, 2.5e-308, 1e-300])
def test_the_ring_of_smallest_amplitudes_has_the_slopes_of_the_limit(amplitude):
    """a_inf = 1 + (1-k)/(2 (3+k)) phi + ..."""
    k = np.linspace(-0.9, 0.9, POINTS)
    by_phi = derivatives("fretting.worn_radius", k, np.full(POINTS, amplitude))[2][:, 1]
    assert_allclose(by_phi, (1.0 - k) / (2.0 * (3.0 + k)), rtol=1e-14)


def check_radii(k, phi):
    c, a = edges(k, phi)
    assert np.all(c > 0.0) and np.all(c <= 1.0)
    assert np.all(a >= 1.0) and np.all(np.isfinite(a))  # promised as it stands, so no rounding unit is allowed for


test_radii_lie_on_their_sides_of_one = given(EXPONENTS, AMPLITUDES)(check_radii)


def test_radii_on_a_grid():
    """Where a_inf - 1 is about an ulp, c sqrt(1+y) may be rounded to the wrong side of 1."""
    check_radii(*(x.ravel() for x in np.meshgrid(np.linspace(-0.9995, 0.9995, 81), np.geomspace(1e-17, 1e-6, 89))))


@given(EXPONENTS, AMPLITUDES)
def test_volume_of_wear_is_positive_and_at_rest_zero(k, phi):
    volume = fretting.wear_volume(k, phi)
    assert np.all(volume >= 0.0) and np.all(np.isfinite(volume))
    assert np.all(volume[phi > 1e-100] > 0.0)  # below, V of the order phi^(2+q) underflows
    assert_array_equal(fretting.wear_volume(k, np.zeros_like(phi)), 0.0)


def next_amplitude(phi, step):
    """A part more of what is left, or of what there is: both ends of the range count."""
    more = phi + step * np.where(phi < 0.5, np.maximum(phi, 1e-100), 1.0 - phi)
    return np.minimum(more, math.nextafter(1.0, 0.0))


STEP = several(st.floats(1e-6, 0.999))


@given(EXPONENTS, AMPLITUDES, STEP)
def test_wear_and_worn_radius_grow_with_the_amplitude_and_the_stick_radius_shrinks(k, phi, step):
    more = next_amplitude(phi, step)
    told_apart = more - phi > 1e-9 * np.minimum(phi, 1.0 - phi)
    for wear in (fretting.wear_volume, fretting.deepest_wear):
        assert np.all(wear(k, more) >= wear(k, phi))
        grown = wear(k, more) > wear(k, phi)
        # 1 - phi must be resolved, the wear must not underflow, and the relative step in it must exceed 64 eps.
        assert np.all(grown | ~told_apart | (more < 1e-95) | (1.0 - more < 1e-9))
    assert np.all(fretting.stick_radius(k, more) <= fretting.stick_radius(k, phi))
    assert np.all(fretting.worn_radius(k, more) >= fretting.worn_radius(k, phi) * (1.0 - 4.0 * EPS))


# --- the ring -------------------------------------------------------------------------------------------------------


@given(EXPONENTS, AMPLITUDES, several(ratio))
def test_wear_depth_is_positive_in_the_ring_and_at_most_the_deepest(k, phi, part):
    c, a = edges(k, phi)
    r = np.clip(c + part * (a - c), c, a)
    depth = fretting.wear_depth(r, k, phi)
    assert np.all(depth >= 0.0)
    # Strictly inside, by 64 ulp of the radii, it must not vanish (unless it underflows).
    inner = (r > c * (1.0 + 64 * EPS)) & (r < a * (1.0 - 64 * EPS)) & (phi > 1e-100)
    assert np.all(depth[inner] > 0.0)
    deepest = fretting.deepest_wear(k, phi)
    # rounding of r moves the depth by its slope, and a narrow ring is only some ulp wide
    assert np.all(depth <= deepest * (1.0 + 64 * EPS * (1.0 + a / np.maximum(a - c, EPS * a))))
    assert_allclose(fretting.profile(r, k, phi), 0.5 * r * r + depth, rtol=4 * EPS)  # a product and a sum


@given(EXPONENTS, AMPLITUDES, several(ratio), several(st.floats(0.0, 300.0)))
def test_wear_depth_is_exactly_zero_outside_the_ring(k, phi, part, beyond):
    c, a = edges(k, phi)
    assert_array_equal(fretting.wear_depth(part * c, k, phi), 0.0)
    assert_array_equal(fretting.wear_depth(c, k, phi), 0.0)
    # Where the ring ends is known to a few ulp of a_inf, amplified where a_inf itself is badly conditioned: 64 EPS.
    assert_array_equal(fretting.wear_depth(a * (1.0 + 64 * EPS) * 10.0**beyond, k, phi), 0.0)


# --- no amplitude ---------------------------------------------------------------------------------------------------


def test_the_smallest_amplitudes_take_no_depth_below_zero():
    """In single precision, where the load of the deepest place must not underflow and so is too large."""
    k = np.float32(1.0 - np.geomspace(1e-7, 1e-2, 24)[:, None])
    assert np.all(fretting.deepest_wear(k, np.geomspace(1.2e-38, 1e-30, 60, dtype=np.float32)) >= 0.0)


anywhere = st.one_of(
    st.floats(0.0, 3.0),
    st.floats(0.0, 150.0).map(lambda e: 10.0**e),
    st.floats(-15.0, -2.0).map(lambda e: 1.0 + 10.0**e),
    st.floats(-15.0, -2.0).map(lambda e: 1.0 - 10.0**e),
)


@given(EXPONENTS, several(anywhere))
def test_nothing_happens_without_amplitude(k, r):
    rest = np.zeros_like(k)
    assert_array_equal(fretting.stick_radius(k, rest), 1.0)
    assert_array_equal(fretting.worn_radius(k, rest), 1.0)
    assert_array_equal(fretting.wear_depth(r, k, rest), 0.0)
    assert_allclose(fretting.profile(r, k, rest), 0.5 * r * r, rtol=0, atol=1e-307)  # XLA has no subnormals
    assert_array_equal(fretting.steady_traction(r, k, rest), 0.0)
    assert_array_equal(fretting.edge_intensity(k, rest), 0.0)
    assert_array_equal(fretting.deepest_wear(k, rest), 0.0)
    assert_array_equal(fretting.edge_pressure(0.0, k, rest), 0.0)
    # The same kernels with other constants: equal to a few ulp.
    for name in ("displacement", "pressure"):
        initial, steady = getattr(fretting, f"initial_{name}"), getattr(fretting, f"steady_{name}")
        assert_allclose(steady(r, k, rest), initial(r, k), rtol=8 * EPS)
    assert_allclose(fretting.penetration(k, rest), 1.0 / (1.0 + k), rtol=4 * EPS)
    assert_allclose(fretting.penetration(k, rest), fretting.initial_displacement(0.0 * r, k), rtol=4 * EPS)


# --- displacements --------------------------------------------------------------------------------------------------

EDGE_K = np.array(data("fretting/exponents.toml")["ends"])


def test_gross_slip_displacement_at_the_punch_edge_is_gauss_value():
    """2F1(-q, s; 1; 1) = Gamma(1+2q)/(2 Gamma(1+q)^2), Gauss's theorem: the value at r = a exactly."""
    q = 0.5 * (1.0 - EDGE_K)
    gauss = np.array([math.gamma(1.0 + 2.0 * x) / (2.0 * math.gamma(1.0 + x) ** 2) for x in q])
    assert_allclose(gross_slip.steady_displacement(1.0, EDGE_K), gauss, rtol=16 * EPS)
    assert_array_equal(gross_slip.initial_displacement(1.0, EDGE_K), 1.0)


RADII = np.concatenate([1.0 + 2.0 ** -np.arange(40.0, 0.0, -3.0), np.geomspace(1.6, 1e8, 40)])[:, None]


@parametrize("module", [gross_slip, fretting], ids=["gross slip", "fretting"])
def test_displacement_beyond_the_contact_is_positive_and_falls(module):
    k, slip = GRID_K, [GRID_PHI] if module is fretting else []
    edge = fretting.stick_radius(k, GRID_PHI) if slip else 1.0
    for w in (module.initial_displacement(RADII, k), module.steady_displacement(edge * RADII, k, *slip)):
        assert np.all(w > 0.0)
        # Rounding may undo a step that is smaller than it.
        assert np.all(np.diff(w, axis=0) <= 16 * EPS * w[1:])
        assert np.all(w[-1] < w[0])


@given(exponent, st.floats(1e-9, 1e3), st.floats(1e3, 1e15))
def test_modulus_at_the_characteristic_depth(k, z0, E0):
    graded = PowerLawGraded(E0=E0, z0=z0, k=k, nu=0.3)
    assert graded.modulus(z0) == E0
    assert graded.modulus(0.0) == (0.0 if k > 0.0 else math.inf if k < 0.0 else E0)
    # 2^k by an exponential of the logarithm
    assert_allclose(graded.modulus(2.0 * z0), E0 * 2.0**k, rtol=8 * EPS)
