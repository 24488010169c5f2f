"""Wear over cycles: against rings and the Green's function alone, and in every limit that has a closed form."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import transient_oracle

from plgwear_jax import FrettingContact, PowerLawGraded, fretting, partial_slip, transient

# All tests ask for these shapes, so that they share their programs.
K = np.array([-0.95, -0.5, 0.0, 0.5, 0.95])[:, None]
PHI = np.array([0.01, 0.8, 0.5, 0.3, 0.97])[:, None]
ERROR = {2: 1e-2, 3: 1e-3, 4: 2e-4}  # promised, of the final volume


@pytest.fixture(scope="module")
def unit():
    """The final volume over the first rate, by the closed forms: after some five of them it is over."""
    return np.asarray(fretting.wear_volume(K, PHI) / first_rate(K, PHI))


def first_rate(k, phi):
    return 0.25 * np.pi * partial_slip.energy_per_cycle(k, phi)


@pytest.fixture(scope="module")
def times(unit):
    return unit * np.concatenate([[0.0, 1e-6], np.linspace(0.05, 5.9, 12), [7.0, 1e3]])


@pytest.fixture(scope="module")
def volume(times):
    return np.asarray(transient.wear_volume(K, PHI, times))


def test_the_volume_begins_with_the_closed_rate(volume, times):
    np.testing.assert_array_equal(volume[:, 0], 0.0)
    np.testing.assert_allclose(volume[:, 1], first_rate(K, PHI)[:, 0] * times[:, 1], rtol=1e-5)
    np.testing.assert_allclose(transient.wear_rate(K, PHI, times)[:, 0], first_rate(K, PHI)[:, 0], rtol=1e-12)


def test_the_volume_grows_to_the_closed_one(volume):
    final = np.asarray(fretting.wear_volume(K, PHI))
    assert np.all(np.diff(volume, axis=1) >= 0.0)
    assert np.max(volume / final) < 1.0 + 1e-9
    np.testing.assert_allclose(volume[:, -1:], final, rtol=1e-9)


def test_the_rate_is_the_slope_of_the_volume(volume, times):
    step = 1e-4 * times[:, 2:-1]
    ahead, behind = (
        np.asarray(transient.wear_volume(K, PHI, times * (1.0 + sign * 1e-4)))[:, 2:-1] for sign in (1.0, -1.0)
    )
    rate = np.asarray(transient.wear_rate(K, PHI, times))
    np.testing.assert_allclose((ahead - behind) / (2 * step), rate[:, 2:-1], rtol=1e-4, atol=1e-5 * rate.max())
    assert np.all(rate >= 0.0)


# k, phi, and the share of the worn volume that the rings themselves are off by.
RINGS = [(0.0, 0.5, 1e-4), (-0.5, 0.8, 1.5e-4), (0.5, 0.8, 1e-4)]
MORE_RINGS = [
    (-0.5, 0.2, 1e-4),
    (-0.5, 0.5, 1e-4),
    (0.0, 0.2, 1e-4),
    (0.0, 0.8, 1e-4),
    (0.5, 0.2, 4e-4),
    (0.5, 0.5, 1e-4),
]


@pytest.mark.parametrize("k, phi, off", RINGS + [pytest.param(*x, marks=pytest.mark.long) for x in MORE_RINGS])
def test_the_volume_is_that_of_rings_and_the_greens_function_alone(k, phi, off):
    unit = float(fretting.wear_volume(k, phi) / first_rate(k, phi))
    at = np.array([0.25, 0.75, 1.5]) * unit
    rough, fine = (transient_oracle.worn_shares(k, phi, at, rings, 5) for rings in (60, 120))
    exact = (4.0 * fine - rough) / 3.0
    k, phi, at = np.full((5, 1), k), np.full((5, 1), phi), np.resize(at, (5, 16))
    mine = np.asarray(transient.wear_volume(k, phi, at) / fretting.wear_volume(k, phi))[0, :3]
    np.testing.assert_allclose(mine, exact, atol=ERROR[3] + off)


@pytest.mark.long
@pytest.mark.parametrize("digits", [2, 3, 4])
def test_digits_are_kept_over_the_whole_domain(digits):
    k, phi = (x.reshape(-1, 1) for x in np.meshgrid(np.linspace(-0.97, 0.97, 8), [0.005, 0.05, 0.3, 0.6, 0.9, 0.98]))
    final = np.asarray(fretting.wear_volume(k, phi))
    at = final / first_rate(k, phi) * np.append(np.geomspace(1e-3, 8.0, 40), 0.0)
    error = (transient.wear_volume(k, phi, at, digits=digits) - transient.wear_volume(k, phi, at, digits=5)) / final
    assert np.max(np.abs(error)) < ERROR[digits]


def test_cycles_turn_the_volume(unit):
    share = np.array([0.0, 0.1, 0.5, 0.9, 0.99])
    n = np.asarray(transient.cycles(K, PHI, share))
    times = np.concatenate([n, np.zeros((5, 11))], axis=1)
    worn = np.asarray(transient.wear_volume(K, PHI, times) / fretting.wear_volume(K, PHI))
    np.testing.assert_allclose(worn[:, :5], np.broadcast_to(share, (5, 5)), atol=1e-12)


def test_derivatives_are_those_of_differences(unit, times):
    n = times[:, 6:7]

    def total(k, phi, n):
        return jnp.sum(transient.wear_volume(k, phi, n) * np.arange(1.0, 6.0)[:, None])

    by_k, by_phi, by_n = jax.grad(total, (0, 1, 2))(K, PHI, n)
    weights = np.arange(1.0, 6.0)[:, None]
    for slope, step, moved in (
        (by_k, 1e-5, lambda h: (K + h, PHI, n)),
        (by_phi, 1e-5, lambda h: (K, PHI + h, n)),
    ):
        ahead, behind = (np.asarray(transient.wear_volume(*moved(sign * step))) for sign in (1.0, -1.0))
        np.testing.assert_allclose(slope, weights * (ahead - behind) / (2 * step), rtol=2e-4, atol=1e-9)
    np.testing.assert_allclose(by_n, weights * transient.wear_rate(K, PHI, n), rtol=1e-8)


def test_fields_have_their_limits(unit):
    c, outer = np.asarray(fretting.stick_radius(K, PHI)), np.asarray(fretting.worn_radius(K, PHI))
    r = np.concatenate([c * np.array([0.0, 0.5, 0.9]), c + (outer - c) * np.array([0.1, 0.5, 0.9, 1.2])], axis=1)
    end, begin = np.full((5, 1), 1e3) * unit, np.zeros((5, 1))
    depth = np.asarray(transient.wear_depth(r, K, PHI, end))
    np.testing.assert_allclose(depth, fretting.wear_depth(r, K, PHI), atol=1e-7 * depth.max())
    np.testing.assert_array_equal(transient.wear_depth(r, K, PHI, begin), 0.0)
    pressure = np.asarray(transient.pressure(r, K, PHI, end))
    np.testing.assert_allclose(pressure, fretting.steady_pressure(r, K, PHI), rtol=1e-9, atol=1e-9)
    pressure = np.asarray(transient.pressure(r, K, PHI, begin))
    np.testing.assert_allclose(pressure[:, :3], fretting.initial_pressure(r, K)[:, :3], rtol=5e-3)
    assert np.all(np.asarray(transient.pressure(r, K, PHI, unit)) >= 0.0)
    radius = np.asarray(transient.contact_radius(K, PHI, np.concatenate([begin, unit, end], axis=1)))
    np.testing.assert_allclose(radius[:, :1], 1.0, atol=1e-12)
    np.testing.assert_allclose(radius[:, 2:], outer, rtol=1e-9)
    assert np.all(np.diff(radius, axis=1) >= 0.0)


def test_nothing_wears_without_an_amplitude():
    phi = np.zeros((5, 1))
    assert np.all(transient.wear_volume(K, phi, np.ones((5, 16))) == 0.0)


def test_float32_keeps_three_digits(volume, times):
    single = [x.astype(np.float32) for x in (K, PHI, times)]
    worn = transient.wear_volume(*single)
    assert worn.dtype == jnp.float32
    error = (np.asarray(worn, float) - volume) / np.asarray(fretting.wear_volume(K, PHI))
    assert np.max(np.abs(error)) < 1e-3


@pytest.mark.parametrize("wrong", [(1.0, 0.5, 1.0), (0.0, 1.0, 1.0), (0.0, 0.5, -1.0), (0.0, 0.5, np.inf)])
def test_bad_input_is_refused(wrong):
    with pytest.raises(ValueError, match="is outside the allowed range"):
        transient.wear_volume(*wrong)


def test_traced_bad_input_gives_nan(times):
    wrong = np.where(np.arange(5)[:, None] == 2, 1.5, PHI)
    worn = jax.jit(transient.wear_volume)(K, wrong, times)
    np.testing.assert_array_equal(np.isnan(worn), np.broadcast_to(np.arange(5)[:, None] == 2, worn.shape))


def test_an_empty_array_of_cycles_has_an_empty_answer():
    assert transient.wear_volume(K, PHI, np.zeros((5, 0))).shape == (5, 0)


# --- in SI units ----------------------------------------------------------------------------------------------------


def contact(k=0.3):
    return FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), radius=5e-3, normal_force=10.0, friction=0.4)


def test_cycles_in_si_are_the_reduced_ones_times_their_unit():
    dome, K_wear = contact(), 1e-15
    a_0, theta = float(dome.contact_radius()), float(dome.material.tangential_ratio())
    n = 4.0 * K_wear * 0.4 * theta * 10.0 * 1e6 / (np.pi * a_0**2)
    expected = a_0**4 / 5e-3 * float(transient.wear_volume(0.3, 0.5, n))
    assert float(dome.wear_volume(2.0, cycles=1e6, wear_coefficient=K_wear)) == pytest.approx(expected, rel=1e-12)
    first = dome.wear_volume(2.0, cycles=1.0, wear_coefficient=K_wear)
    assert float(first) == pytest.approx(K_wear / 0.4 * float(dome.energy_per_cycle(2.0)), rel=1e-5)


@pytest.mark.parametrize(
    "given, what",
    [
        ({"cycles": 1e5}, "go together"),
        ({"wear_coefficient": 1e-15}, "go together"),
        ({"cycles": -1.0, "wear_coefficient": 1e-15}, "cycles = -1.0 is outside"),
        ({"cycles": np.inf, "wear_coefficient": 1e-15}, "cycles = inf is outside"),
        ({"cycles": 1.0, "wear_coefficient": 0.0}, "wear_coefficient = 0.0 is outside"),
        ({"cycles": 1.0, "wear_coefficient": -1e-15}, "wear_coefficient = -1e-15 is outside"),
    ],
)
def test_cycles_in_si_refuse_bad_input(given, what):
    with pytest.raises((TypeError, ValueError), match=what):
        contact().wear_volume(2.0, **given)
