"""What the paper promises about every result: ranges, signs, limits, continuity at the edges, scaling laws.

Points come from hypothesis, eight at a time so that every function is compiled for one shape only; they crowd at the
ends of the domain. EPS is the rounding unit of float64; each tolerance is a few of it times what the formula loses.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from functions import fretting, gross_slip, material
from hypothesis import given
from hypothesis import strategies as st

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded

EPS = float(np.finfo(float).eps)
POINTS = 8

exponent = st.one_of(
    st.floats(-0.999, 0.999, allow_subnormal=False),  # XLA takes subnormal numbers for zero
    st.floats(1e-15, 1e-3).map(lambda x: 1.0 - x),
    st.floats(1e-15, 1e-3).map(lambda x: x - 1.0),
    st.sampled_from([0.0, 1e-300, -1e-9, math.nextafter(1.0, 0.0), math.nextafter(-1.0, 0.0)]),
)
amplitude = st.one_of(
    st.floats(1e-3, 0.999),
    st.floats(-300.0, -3.0).map(lambda e: 10.0**e),
    st.floats(1e-15, 1e-3).map(lambda x: 1.0 - x),
    st.sampled_from([0.0, 5e-324, 0.25, 0.5, math.nextafter(1.0, 0.0)]),
)
ratio = st.one_of(st.floats(0.0, 1.0), st.floats(-15.0, -1.0).map(lambda e: 10.0**e))


def several(element: st.SearchStrategy[float]) -> st.SearchStrategy[np.ndarray]:
    return st.lists(element, min_size=POINTS, max_size=POINTS).map(np.array)


EXPONENTS, AMPLITUDES = several(exponent), several(amplitude)
GRID_K, GRID_PHI = (
    x.ravel()
    for x in np.meshgrid(
        [-1.0 + 1e-9, -0.95, -0.5, -0.1, 0.0, 0.169, 0.5, 0.9, 1.0 - 1e-9], [0.0, 1e-9, 0.1, 0.4, 0.8, 0.99, 1.0 - 1e-9]
    )
)


def slip(k, phi):
    """s Lambda: the depth of the steady punch beyond its parabola, as the library's notes define it."""
    return phi / ((1.0 - phi) * (1.0 + 0.5 * (1.0 + k)))


# --- radii ----------------------------------------------------------------------------------------------------------


def check_radii(k, phi):
    c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    assert np.all(c > 0.0) and np.all(c <= 1.0)
    assert np.all(a >= 1.0) and np.all(np.isfinite(a))  # promised as it stands, so no rounding unit is allowed for


@given(EXPONENTS, AMPLITUDES)
def test_stick_radius_is_at_most_one_and_worn_radius_at_least_one(k, phi):
    check_radii(k, phi)


def test_radii_on_a_grid():
    check_radii(GRID_K, GRID_PHI)
    # Where a_inf - 1 is about an ulp, c sqrt(1+y) may be rounded to the wrong side of 1.
    check_radii(*(x.ravel() for x in np.meshgrid(np.linspace(-0.9995, 0.9995, 81), np.geomspace(1e-17, 1e-6, 89))))


@given(EXPONENTS, AMPLITUDES)
def test_volume_of_wear_is_positive_and_at_rest_zero(k, phi):
    volume = np.asarray(fretting.wear_volume(k, phi))
    assert np.all(volume >= 0.0) and np.all(np.isfinite(volume))
    assert np.all(volume[phi > 1e-100] > 0.0)  # below, V of the order phi^(2+q) underflows
    np.testing.assert_array_equal(fretting.wear_volume(k, np.zeros_like(phi)), 0.0)


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
        grown = np.asarray(wear(k, more) > wear(k, phi))
        # 1 - phi must be resolved, the wear must not underflow, and the relative step in it must exceed 64 eps.
        assert np.all(grown | ~told_apart | (more < 1e-95) | (1.0 - more < 1e-9))
    assert np.all(fretting.stick_radius(k, more) <= fretting.stick_radius(k, phi))
    assert np.all(fretting.worn_radius(k, more) >= fretting.worn_radius(k, phi) * (1.0 - 4.0 * EPS))


@given(
    EXPONENTS, AMPLITUDES, STEP, several(st.one_of(st.floats(0.0, 2.0), st.floats(-15.0, 3.0).map(lambda e: 10.0**e)))
)
def test_edge_pressure_grows_with_the_amplitude(k, phi, step, distance):
    less, more = (
        fretting.edge_pressure(distance, k, phi),
        fretting.edge_pressure(distance, k, next_amplitude(phi, step)),
    )
    # a power of the distance and one of c, as a logarithm up to 40 and its exponential
    assert np.all(more >= less * (1.0 - 64 * EPS))


# --- the ring -------------------------------------------------------------------------------------------------------


def ring_point(c, a, part):
    return np.clip(c + part * (a - c), c, a)


@given(EXPONENTS, AMPLITUDES, several(ratio))
def test_wear_depth_is_positive_in_the_ring(k, phi, part):
    c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    r = ring_point(c, a, part)
    depth = np.asarray(fretting.wear_depth(r, k, phi))
    assert np.all(depth >= 0.0)
    # Strictly inside, by 64 ulp of the radii, it must not vanish (unless it underflows).
    inner = (r > c * (1.0 + 64 * EPS)) & (r < a * (1.0 - 64 * EPS)) & (phi > 1e-100)
    assert np.all(depth[inner] > 0.0)


@given(EXPONENTS, AMPLITUDES, several(ratio))
def test_wear_is_nowhere_deeper_than_the_deepest(k, phi, part):
    c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    r = ring_point(c, a, part)
    deepest = np.asarray(fretting.deepest_wear(k, phi))
    # rounding of r moves the depth by its slope, and a narrow ring is only some ulp wide
    allowed = 64 * EPS * (1.0 + a / np.maximum(a - c, EPS * a))
    assert np.all(fretting.wear_depth(r, k, phi) <= deepest * (1.0 + allowed))


@given(EXPONENTS, AMPLITUDES, several(ratio), several(st.floats(0.0, 300.0)))
def test_wear_depth_is_exactly_zero_outside_the_ring(k, phi, part, beyond):
    c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    np.testing.assert_array_equal(fretting.wear_depth(part * c, k, phi), 0.0)
    np.testing.assert_array_equal(fretting.wear_depth(c, k, phi), 0.0)
    # Where the ring ends is known to a few ulp of a_inf, amplified where a_inf itself is badly conditioned: 64 EPS.
    outside = a * (1.0 + 64 * EPS) * 10.0**beyond
    np.testing.assert_array_equal(fretting.wear_depth(outside, k, phi), 0.0)


@given(EXPONENTS, AMPLITUDES, several(ratio))
def test_profile_is_the_parabola_and_the_wear(k, phi, part):
    c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    r = ring_point(c, a, part)
    both = 0.5 * r * r + np.asarray(fretting.wear_depth(r, k, phi))
    np.testing.assert_allclose(fretting.profile(r, k, phi), both, rtol=4 * EPS)  # one product and one sum


# --- no amplitude ---------------------------------------------------------------------------------------------------


def test_the_smallest_amplitudes_take_no_depth_below_zero():
    """In single precision, where the load of the deepest place must not underflow and so is too large."""
    k = np.float32(1.0 - np.geomspace(1e-7, 1e-2, 24)[:, None])
    assert np.all(fretting.deepest_wear(k, np.geomspace(1.2e-38, 1e-30, 60, dtype=np.float32)) >= 0.0)


@given(EXPONENTS, several(st.one_of(st.floats(0.0, 3.0), st.floats(0.0, 150.0).map(lambda e: 10.0**e))))
def test_nothing_happens_without_amplitude(k, r):
    rest = np.zeros_like(k)
    np.testing.assert_array_equal(fretting.stick_radius(k, rest), 1.0)
    np.testing.assert_array_equal(fretting.worn_radius(k, rest), 1.0)
    np.testing.assert_array_equal(fretting.wear_depth(r, k, rest), 0.0)
    np.testing.assert_allclose(fretting.profile(r, k, rest), 0.5 * r * r, rtol=0, atol=1e-307)  # XLA has no subnormals
    np.testing.assert_array_equal(fretting.steady_traction(r, k, rest), 0.0)
    np.testing.assert_array_equal(fretting.edge_intensity(k, rest), 0.0)
    np.testing.assert_array_equal(fretting.deepest_wear(k, rest), 0.0)
    np.testing.assert_array_equal(fretting.edge_pressure(0.0, k, rest), 0.0)
    # The same kernels with other constants: equal to a few ulp.
    for name in ("displacement", "pressure"):
        initial, steady = getattr(fretting, f"initial_{name}"), getattr(fretting, f"steady_{name}")
        np.testing.assert_allclose(steady(r, k, rest), initial(r, k), rtol=8 * EPS)
    np.testing.assert_allclose(fretting.penetration(k, rest), 1.0 / (1.0 + k), rtol=4 * EPS)
    np.testing.assert_allclose(fretting.penetration(k, rest), fretting.initial_displacement(0.0 * r, k), rtol=4 * EPS)


# --- continuity -----------------------------------------------------------------------------------------------------

STEPS = 2.0 ** -np.arange(10.0, 50.0, 3.0)[:, None]  # relative distances to an edge


def test_profile_is_continuous_at_the_stick_radius():
    k, phi = GRID_K, GRID_PHI
    c = np.asarray(fretting.stick_radius(k, phi))
    r = c * (1.0 + STEPS)
    depth = np.asarray(fretting.profile(r, k, phi)) - 0.5 * r * r
    # (c^2/2) Q Lambda bounds it, and Q <= (4/pi) s y^q with y = (r/c)^2 - 1; the 8 EPS are those of the subtraction.
    y = (r - c) / c * ((r + c) / c)
    bound = 2.0 / np.pi * c * c * slip(k, phi) * y ** (0.5 * (1.0 - k))
    assert np.all(depth <= bound * (1.0 + 1e-12) + 8 * EPS * r * r)
    inside = c * (1.0 - STEPS)
    np.testing.assert_allclose(fretting.profile(inside, k, phi), 0.5 * inside**2, rtol=2 * EPS)
    np.testing.assert_allclose(fretting.profile(c, k, phi), 0.5 * c * c, rtol=2 * EPS)


def test_profile_is_continuous_at_the_worn_radius():
    k, phi = GRID_K, GRID_PHI
    c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    s, q = 0.5 * (1.0 + k), 0.5 * (1.0 - k)
    r = a * (1.0 - STEPS)
    depth = np.asarray(fretting.profile(r, k, phi)) - 0.5 * r * r
    # (c^2/2) (Q/s) (m - G) with a slope of G of at most 1 and Q/s at most 1/s and at most (4/pi) y^q.
    y = np.maximum((a - c) / c * ((a + c) / c), 0.0)
    bound = STEPS * a * a * np.minimum(1.0 / s, 4.0 / np.pi * y**q)
    # The edge itself is known to 16 EPS, which counts like 16 EPS more distance.
    assert np.all(depth <= bound * (1.0 + 16 * EPS / STEPS) + 16 * EPS * a * a)
    beyond = a * (1.0 + STEPS)
    np.testing.assert_allclose(fretting.profile(beyond, k, phi), 0.5 * beyond**2, rtol=16 * EPS)
    np.testing.assert_allclose(fretting.profile(a, k, phi), 0.5 * a * a, rtol=64 * EPS)


@pytest.mark.parametrize("state", ["initial", "steady"])
def test_fretting_displacement_is_continuous_at_the_contact_edge(state):
    k, phi = GRID_K, GRID_PHI if state == "steady" else np.zeros_like(GRID_PHI)
    c = np.asarray(fretting.stick_radius(k, phi))

    def displacement(r):
        return np.asarray(
            fretting.steady_displacement(r, k, phi) if state == "steady" else fretting.initial_displacement(r, k)
        )

    at = displacement(c)
    m = slip(k, phi)
    # Under the punch it is d - r^2/2.
    d = np.asarray(fretting.penetration(k, phi))
    np.testing.assert_allclose(at, d - 0.5 * c * c, rtol=16 * EPS, atol=16 * EPS)
    inside = displacement(c * (1.0 - STEPS)) - at
    np.testing.assert_allclose(inside, 0.5 * c * c * STEPS * (2.0 - STEPS), rtol=0, atol=1e-15 * (1.0 + np.max(d)))
    # Beside it the change is at most (d - c^2/2) Q and as much again from the second term, Q <= (4/pi) s y^q.
    y = STEPS * (2.0 + STEPS)
    bound = 4.0 * (1.0 + m) * c * c * y ** (0.5 * (1.0 - k)) + 16 * EPS * at
    outside = at - displacement(c * (1.0 + STEPS))
    assert np.all(outside >= -16 * EPS * at) and np.all(outside <= bound)


EDGE_K = np.array([-1.0 + 1e-9, -0.95, -0.5, -0.1, -1e-9, 0.0, 1e-9, 0.169, 0.5, 0.9, 0.97, 0.99, 0.999, 1.0 - 1e-9])


def test_gross_slip_displacement_at_the_punch_edge_is_gauss_value():
    """2F1(-q, s; 1; 1) = Gamma(1+2q)/(2 Gamma(1+q)^2), Gauss's theorem: the value at r = a exactly."""
    q = 0.5 * (1.0 - EDGE_K)
    gauss = np.array([math.gamma(1.0 + 2.0 * x) / (2.0 * math.gamma(1.0 + x) ** 2) for x in q])
    np.testing.assert_allclose(gross_slip.steady_displacement(1.0, EDGE_K), gauss, rtol=16 * EPS)
    np.testing.assert_array_equal(gross_slip.initial_displacement(1.0, EDGE_K), 1.0)


def test_gross_slip_displacement_is_continuous_at_the_punch_edge():
    k = EDGE_K[EDGE_K < 0.96]  # beyond, the step over the edge is too steep for doubles to show the limit
    q = 0.5 * (1.0 - k)
    at = np.asarray(gross_slip.steady_displacement(1.0, k))
    # cb(-q)/2 x^2q and a term linear in x, which merge with a logarithm at k = 0; x is 2 STEPS to leading order.
    x = 2.1 * STEPS
    bound = 2.0 * np.maximum(x ** (2.0 * q), x) * (1.0 + np.minimum(-np.log(x), 1.0 / np.maximum(np.abs(k), 1e-12)))
    bound = bound + 16 * EPS
    for side in (1.0 - STEPS, 1.0 + STEPS):
        jump = np.abs(np.asarray(gross_slip.steady_displacement(side, k)) - at)
        assert np.all(jump <= bound), np.max(jump / bound, axis=0)
    # The flat punch: 1 inside, and 1 - Q outside with Q <= (4/pi) s y^q.
    fall = 1.0 - np.asarray(gross_slip.initial_displacement(1.0 + STEPS, k))
    s = 0.5 * (1.0 + k)
    assert np.all(fall >= 0.0) and np.all(fall <= 4.0 / np.pi * s * (STEPS * (2.0 + STEPS)) ** q + 16 * EPS)


RADII = np.concatenate([1.0 + 2.0 ** -np.arange(40.0, 0.0, -3.0), np.geomspace(1.6, 1e8, 40)])[:, None]


@pytest.mark.parametrize("name", ["gross_slip.initial", "gross_slip.steady", "fretting.initial", "fretting.steady"])
def test_displacement_beyond_the_contact_is_positive_and_falls(name):
    k, phi = GRID_K, GRID_PHI
    if name == "fretting.steady":
        w = fretting.steady_displacement(fretting.stick_radius(k, phi) * RADII, k, phi)
    elif name == "fretting.initial":
        w = fretting.initial_displacement(RADII, k)
    else:
        which = gross_slip.initial_displacement if name.endswith("initial") else gross_slip.steady_displacement
        w = which(RADII, k)
    w = np.asarray(w)
    assert np.all(w > 0.0)
    # Rounding may undo a step that is smaller than it.
    assert np.all(np.diff(w, axis=0) <= 16 * EPS * w[1:])
    assert np.all(w[-1] < w[0])


# --- numbers that are known -----------------------------------------------------------------------------------------


@given(EXPONENTS)
def test_volume_change_range(k):
    change = np.asarray(gross_slip.volume_change(k))
    assert np.all(change >= 0.0) and np.all(change < 0.156)


def test_volume_change_on_a_grid():
    k = np.linspace(-1.0, 1.0, 20003)[1:-1]
    change = np.asarray(gross_slip.volume_change(k))
    assert np.all(change > 0.0) and np.all(change < 0.156)
    assert np.max(change) > 0.155 and abs(k[np.argmax(change)] - 0.169) < 1e-3  # the maximum that the paper states


@given(EXPONENTS)
def test_force_ratio_is_even(k):
    ratio = np.asarray(gross_slip.force_ratio(k))
    np.testing.assert_allclose(ratio, gross_slip.force_ratio(-k), rtol=8 * EPS)  # s and q enter by different sums
    assert np.all(ratio >= np.pi / 4.0 * (1.0 - 4 * EPS)) and np.all(ratio <= 1.0 + 4 * EPS)


@given(several(st.one_of(st.floats(-0.999999, 0.5), st.sampled_from([0.5, 0.0, math.nextafter(-1.0, 0.0)]))))
def test_h_n_of_the_homogeneous_half_space_is_one(nu):
    np.testing.assert_allclose(material.h_N(0.0, nu), 1.0, rtol=32 * EPS)  # some forty products of gamma functions
    np.testing.assert_allclose(material.h_N(0.0, "holl"), 1.0, rtol=32 * EPS)


@given(exponent, st.floats(1e-9, 1e3), st.floats(1e3, 1e15))
def test_modulus_at_the_characteristic_depth(k, z0, E0):
    graded = PowerLawGraded(E0=E0, z0=z0, k=k, nu=0.3)
    assert float(graded.modulus(z0)) == E0
    assert float(graded.modulus(0.0)) == (0.0 if k > 0.0 else math.inf if k < 0.0 else E0)
    # 2^k by an exponential of the logarithm
    assert float(graded.modulus(2.0 * z0)) == pytest.approx(E0 * 2.0**k, rel=8 * EPS)


# --- scaling laws in SI units ---------------------------------------------------------------------------------------


def fretting_contact(E0, z0, k, nu, R, F_N, mu):
    return FrettingContact(PowerLawGraded(E0, z0, k, nu), radius=R, normal_force=F_N, friction=mu)


@jax.jit
def fretting_results(E0, z0, k, nu, R, F_N, mu, F_x, part):
    contact = fretting_contact(E0, z0, k, nu, R, F_N, mu)
    r = part * contact.steady(0.0).contact_radius
    return {
        "contact_radius": contact.steady(0.0).contact_radius,
        "worn_radius": contact.steady(F_x).worn_radius,
        "wear_volume": contact.steady(F_x).wear_volume,
        "deepest_wear": contact.steady(F_x).deepest_wear,
        "edge_pressure": contact.steady(F_x).edge_pressure(r),
        "steady_pressure": contact.steady(F_x).pressure(r),
    }


@jax.jit
def gross_slip_results(E0, z0, k, nu, a, d):
    contact = GrossSlipContact(PowerLawGraded(E0, z0, k, nu), radius=a, depth=d)
    return {"initial_force": contact.steady().initial_force, "volume_change": contact.steady().volume_change}


@jax.jit
def volume_slope(E0, z0, k, nu, R, F_N, mu, F_x):
    def log_volume(log_z0):
        return jnp.log(fretting_contact(E0, jnp.exp(log_z0), k, nu, R, F_N, mu).steady(F_x).wear_volume)

    return jax.grad(log_volume)(jnp.log(z0))


SI = {
    "E0": st.floats(1e8, 1e12),
    "z0": st.floats(1e-6, 1e-2),
    "k": st.floats(-0.95, 0.95),
    "nu": st.floats(-0.5, 0.499),
    "R": st.floats(1e-4, 1.0),
    "F_N": st.floats(1e-2, 1e3),
    "mu": st.floats(0.05, 1.5),
    "phi": st.floats(0.01, 0.99),
    "scale": st.floats(0.1, 10.0),
}
# exp of a logarithm of up to 50 costs 50 eps, divided by 3+k and then raised to the fourth power: 400 eps
SI_RTOL = 400 * EPS


@given(st.fixed_dictionaries(SI))
def test_contact_radius_grows_as_a_power_of_the_load(at):
    base = (at["E0"], at["z0"], at["k"], at["nu"], at["R"])
    one = fretting_results(*base, at["F_N"], at["mu"], at["phi"] * at["mu"] * at["F_N"], 0.1)
    F_N = at["scale"] * at["F_N"]
    other = fretting_results(*base, F_N, at["mu"], at["phi"] * at["mu"] * F_N, 0.1)
    radius = at["scale"] ** (1.0 / (at["k"] + 3.0))
    powers = {"contact_radius": radius, "worn_radius": radius, "deepest_wear": radius**2, "wear_volume": radius**4}
    for name, power in powers.items():
        # phi itself is rounded on the way, which counts towards phi = 1
        assert float(other[name] / one[name]) == pytest.approx(power, rel=SI_RTOL + 8 * EPS / (1.0 - at["phi"])), name


@given(st.fixed_dictionaries(SI))
def test_only_the_ratio_of_modulus_to_depth_counts(at):
    rest = (at["k"], at["nu"], at["R"], at["F_N"], at["mu"], at["phi"] * at["mu"] * at["F_N"], 0.1)
    E0, z0 = at["E0"] * at["scale"] ** at["k"], at["z0"] * at["scale"]
    one, other = fretting_results(at["E0"], at["z0"], *rest), fretting_results(E0, z0, *rest)
    for name in one:
        assert float(other[name]) == pytest.approx(float(one[name]), rel=SI_RTOL), name
    one, other = (
        gross_slip_results(*half, at["k"], at["nu"], at["R"], 1e-6) for half in ((at["E0"], at["z0"]), (E0, z0))
    )
    for name in one:
        assert float(other[name]) == pytest.approx(float(one[name]), rel=SI_RTOL), name


@given(st.fixed_dictionaries(SI))
def test_volume_follows_the_characteristic_depth_as_a_power(at):
    F_x = at["phi"] * at["mu"] * at["F_N"]
    slope = volume_slope(at["E0"], at["z0"], at["k"], at["nu"], at["R"], at["F_N"], at["mu"], F_x)
    expected = 4.0 * at["k"] / (at["k"] + 3.0)
    assert float(slope) == pytest.approx(expected, rel=64 * EPS, abs=64 * EPS)


@given(st.fixed_dictionaries(SI))
def test_gross_slip_scales_with_depth_and_radius(at):
    base = (at["E0"], at["z0"], at["k"], at["nu"])
    one = gross_slip_results(*base, at["R"], 1e-6)
    deeper = gross_slip_results(*base, at["R"], at["scale"] * 1e-6)
    wider = gross_slip_results(*base, at["scale"] * at["R"], 1e-6)
    for name, power in (("initial_force", 1.0 + at["k"]), ("volume_change", 2.0)):
        assert float(deeper[name] / one[name]) == pytest.approx(at["scale"], rel=SI_RTOL), name
        assert float(wider[name] / one[name]) == pytest.approx(at["scale"] ** power, rel=SI_RTOL), name
