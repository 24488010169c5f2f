"""Wear over cycles: against rings and the Green's function alone, and in every limit that has a closed form."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import transient_oracle
from transient_energy import rates_of_marches

from plgwear_jax import FrettingContact, PowerLawGraded, fretting, partial_slip, transient
from plgwear_jax.transient.amount import volume_of
from plgwear_jax.transient.curves import compiled_curves, curves_of
from plgwear_jax.transient.grid import EFFORTS, MarchEffort, rings_of
from plgwear_jax.transient.march import marches_of

# All tests ask for these shapes, so that they share their programs.
K = np.array([-0.95, -0.5, 0.0, 0.5, 0.95])[:, None]
PHI = np.array([0.01, 0.8, 0.5, 0.3, 0.97])[:, None]
ERROR = {digits: 10.0**-digits for digits in EFFORTS}  # promised, of the final volume


@pytest.fixture(scope="module")
def unit():
    """The final volume over the first rate, by the closed forms: after some five of them it is over."""
    return unit_of(K, PHI)


def unit_of(k, phi):
    return np.asarray(fretting.wear_volume(k, phi) / first_rate(k, phi))


def first_rate(k, phi):
    return 0.25 * np.pi * partial_slip.energy_per_cycle(k, phi)


@pytest.fixture(scope="module")
def times(unit):
    return unit * np.concatenate([[0.0, 1e-9], np.linspace(0.05, 5.9, 12), [7.0, 1e3]])


@pytest.fixture(scope="module")
def volume(times):
    return np.asarray(transient.wear_volume(K, PHI, times))


def test_the_volume_begins_with_the_closed_rate(volume, times):
    np.testing.assert_array_equal(volume[:, 0], 0.0)
    np.testing.assert_allclose(volume[:, 1], first_rate(K, PHI)[:, 0] * times[:, 1], rtol=1e-5)
    np.testing.assert_allclose(transient.wear_rate(K, PHI, times)[:, 0], first_rate(K, PHI)[:, 0], rtol=1e-6)


def test_the_volume_grows_to_the_closed_one(volume):
    final = np.asarray(fretting.wear_volume(K, PHI))
    assert np.all(np.diff(volume, axis=1) >= 0.0)
    assert np.all(volume <= volume[:, -1:])
    np.testing.assert_allclose(volume[:, -1:], final, rtol=1e-6)  # it is an integral over nodes


def test_the_rate_is_the_slope_of_the_volume(volume, times):
    step = 1e-4 * times[:, 2:-1]
    ahead, behind = (
        np.asarray(transient.wear_volume(K, PHI, times * (1.0 + sign * 1e-4)))[:, 2:-1] for sign in (1.0, -1.0)
    )
    rate = np.asarray(transient.wear_rate(K, PHI, times))
    np.testing.assert_allclose((ahead - behind) / (2 * step), rate[:, 2:-1], rtol=1e-4, atol=1e-5 * rate.max())
    assert np.all(rate >= 0.0)


# k, phi, the number of rings, and the share of the final volume that the rings themselves are off by.
RINGS = [
    (-0.5, 0.8, 80, 2e-4),
    *(
        pytest.param(*x, marks=pytest.mark.long)
        for x in (
            (-0.5, 0.2, 120, 1e-4),
            (-0.5, 0.5, 120, 1e-4),
            (-0.5, 0.8, 120, 1.5e-4),
            (0.0, 0.2, 120, 1e-4),
            (0.0, 0.5, 120, 1e-4),
            (0.0, 0.8, 120, 1e-4),
            (0.5, 0.2, 120, 4e-4),
            (0.5, 0.5, 120, 1e-4),
            (0.5, 0.8, 120, 1e-4),
        )
    ),
]


@pytest.mark.parametrize("k, phi, rings, off", RINGS)
def test_the_volume_is_that_of_rings_and_the_greens_function_alone(k, phi, rings, off):
    unit = float(fretting.wear_volume(k, phi) / first_rate(k, phi))
    at = np.array([0.25, 0.75, 1.5]) * unit
    rough, fine = (transient_oracle.worn_shares(k, phi, at, count, 5) for count in (rings // 2, rings))
    exact = (4.0 * fine - rough) / 3.0
    k, phi, at = np.full((5, 1), k), np.full((5, 1), phi), np.resize(at, (5, 16))
    mine = np.asarray(transient.wear_volume(k, phi, at) / fretting.wear_volume(k, phi))[0, :3]
    np.testing.assert_allclose(mine, exact, atol=ERROR[4] + off)


CLOSE = np.array([0.9997, 0.9999, 1.0 - 1e-8, 0.99999, 1.0 - 1e-6])[:, None]  # to gross slip


def test_close_to_gross_slip_it_wears_as_rings_do():
    """What is worn early is a small share there; at first the march found no step that long and was NaN."""
    k, phi = 0.5, float(CLOSE[1, 0])
    at = np.array([0.01, 0.03, 0.1]) * float(unit_of(k, phi))
    rough, fine = (transient_oracle.worn_shares(k, phi, at, count, 5) for count in (30, 60))
    mine = np.asarray(transient.wear_volume(np.full((5, 1), k), np.full((5, 1), phi), np.resize(at, (5, 16))))[0, :3]
    share = mine / np.asarray(fretting.wear_volume(k, phi))
    np.testing.assert_allclose(share, (4.0 * fine - rough) / 3.0, atol=ERROR[4] + 2e-4)
    assert 0.1 < share[0] < 0.5


def test_close_to_gross_slip_both_ends_are_closed_forms():
    times = unit_of(K, CLOSE) * np.concatenate([[0.0, 1e-13], np.geomspace(1e-4, 10.0, 13), [1e3]])
    volume = np.asarray(transient.wear_volume(K, CLOSE, times))
    assert np.all(np.diff(volume, axis=1) >= 0.0)
    np.testing.assert_allclose(volume[:, 1], first_rate(K, CLOSE)[:, 0] * times[:, 1], rtol=1e-5)
    np.testing.assert_allclose(volume[:, -1:], fretting.wear_volume(K, CLOSE), rtol=1e-6)


def test_closer_than_rounding_tells_it_is_refused():
    edge = np.full((5, 1), 1.0 - 2.0**-53)
    with pytest.raises(ValueError, match=r"F_x/\(mu F_N\) = 0.99999\d* is so close to gross slip"):
        transient.wear_volume(K, edge, np.ones((5, 16)))


@pytest.mark.long
def test_digits_are_kept_over_the_whole_domain():
    close = [1.0 - 1e-4, 1.0 - 1e-8]
    k, phi = (x.reshape(-1, 1) for x in np.meshgrid([-0.97, -0.5, 0.2, 0.7, 0.97], [0.005, 0.3, 0.9, 0.98, *close]))
    final = np.asarray(fretting.wear_volume(k, phi))
    at = final / first_rate(k, phi) * np.append(np.geomspace(1e-3, 8.0, 60), 0.0)
    # Finer than anything that the library offers.
    finer = MarchEffort(12, 32, 7.0, (3, 4, 5, 6))
    finest = volume_of(compiled_curves(finer, *map(jnp.asarray, (k, phi))), *map(jnp.asarray, (k, phi, at)))
    most = np.where(phi > 0.99, 2.5, 1.0)
    worst = {
        digits: np.max(np.abs(transient.wear_volume(k, phi, at, digits=digits) - finest) / (most * final))
        for digits in EFFORTS
    }
    assert all(worst[digits] < ERROR[digits] for digits in EFFORTS), worst


def test_more_digits_than_there_are_are_refused():
    more = max(EFFORTS) + 1
    with pytest.raises(ValueError, match=f"digits = {more} is outside the allowed range 1 <= digits <= {more - 1}"):
        transient.wear_volume(K, PHI, 1.0, digits=more)


def test_cycles_turn_the_volume(unit):
    share = np.array([0.0, 0.1, 0.5, 0.9, 0.99])
    n = np.asarray(transient.cycles(K, PHI, share))
    times = np.concatenate([n, np.zeros((5, 11))], axis=1)
    worn = np.asarray(transient.wear_volume(K, PHI, times) / fretting.wear_volume(K, PHI))
    np.testing.assert_allclose(worn[:, :5], np.broadcast_to(share, (5, 5)), atol=1e-12)


def test_nothing_is_below_what_it_begins_with():
    """Rounding does not take cycles, rates and pressures below 0 either, nor radii below 1."""
    rows = (x.reshape(-1, 5, 1) for x in np.meshgrid([-0.97, -0.6, 0.0, 0.4, 0.97], [0.006, 0.05, 0.5, 0.98]))
    n = np.append(0.0, np.geomspace(1e-12, 1e3, 15))
    for k, phi in zip(*rows, strict=True):
        c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
        assert np.all(transient.cycles(k, phi, np.append(0.0, np.geomspace(1e-300, 0.5, 4))) >= 0.0)
        assert np.all(transient.contact_radius(k, phi, n) >= 1.0)
        assert np.all(transient.wear_rate(k, phi, n) >= 0.0)
        # To where the contact ends before any wear, and after it.
        for r in (np.ones((5, 1)), np.full((5, 1), 1.0 - 2.0**-53), 0.5 * (1.0 + a), 0.5 * (1.0 + c)):
            assert np.all(transient.pressure(r, k, phi, n) >= 0.0)


def test_what_keeps_cycles_from_falling_below_zero_leaves_their_slopes():
    """After n = 0 the share grows by the first rate, 1/unit, also where rounding, on some processors, goes below 0."""
    k, phi = (
        np.array([-0.97, -0.97, -0.808, -0.889, -0.647])[:, None],
        np.array([0.495, 0.535, 0.899, 0.98, 0.98])[:, None],
    )
    share, unit = np.zeros((5, 1)), unit_of(k, phi)
    n, slope = jax.jvp(lambda share: transient.cycles(k, phi, share), (share,), (np.ones_like(share),))
    assert np.all(n >= 0.0)
    np.testing.assert_allclose(slope, unit, rtol=1e-6)


@pytest.mark.long
def test_errors_fall_with_the_size_of_a_cell():
    """Without extrapolation as the square, and with that of three marches a thousandth of it is left."""
    k, phi = (np.array([x]) for x in (0.0, 0.5))
    at = np.asarray(unit_of(k, phi))[:, None] * np.linspace(0.05, 2.0, 12)

    def share(multiples):
        curves = compiled_curves(MarchEffort(8, 12, 4.5, multiples), *map(jnp.asarray, (k, phi)))
        return np.asarray(volume_of(curves, *(jnp.asarray(x) for x in (k[:, None], phi[:, None], at))))

    exact = share((2, 3, 4, 6))
    one, two = (np.max(np.abs(share((multiple,)) - exact)) for multiple in (2, 4))
    assert 3.0 < one / two < 6.0
    assert np.max(np.abs(share((1, 2, 3)) - exact)) < 0.2 * two


@pytest.mark.parametrize("i", [1, pytest.param(4, marks=pytest.mark.long), pytest.param(0, marks=pytest.mark.long)])
def test_a_cycle_wears_by_the_energy_that_friction_takes(i):
    """The rate by p (g + h) of the cells, and by the energy of their pressures: the same without extrapolation."""
    k, phi = float(K[i, 0]), float(PHI[i, 0])
    rates = rates_of_marches(k, phi, 4)
    first = float(first_rate(k, phi))
    assert np.max(np.abs(rates.by_energy - rates.by_pressure)) < ERROR[4] * first
    # The slope of the volume is known less well than the volume.
    by_volume = np.asarray(transient.wear_rate(k, phi, rates.n))
    assert np.max(np.abs(rates.extrapolated - by_volume)) < 5e-3 * first


def test_the_rate_goes_on_at_the_last_time_of_the_run():
    """From there on the volume is known by its decay."""
    k, phi = jnp.asarray(0.0), jnp.asarray(0.8)
    run = curves_of(k, phi, None)
    last = float(run.volume.time[0, -1] * run.scales.unit[0]) * (1.0 + np.finfo(float).eps * np.arange(-3.0, 4.0))
    rate = np.asarray(transient.wear_rate(k, phi, last))
    np.testing.assert_allclose(rate, rate[0], rtol=1e-9)


@pytest.mark.long
def test_every_step_fulfils_its_equations():
    """The wear rate by p (g + h), with the depth h = H - A p of the contact and with that of Archard's law."""
    effort = MarchEffort(8, 12, 4.5, (2,))
    ring, _ = rings_of(jnp.asarray(0.3), jnp.asarray(0.6), effort)
    march = marches_of(ring, effort)
    A, gap, steady = (np.asarray(x[0]) for x in (ring.compliance, ring.gap, ring.steady))
    for worn, pressure in zip(np.asarray(march.worn), np.asarray(march.pressure), strict=True):
        rate = np.sum(pressure * gap * np.exp(worn))
        assert np.sum(pressure * (gap + steady - A @ pressure)) == pytest.approx(rate, rel=1e-6)


@pytest.mark.long  # compiles for half a minute
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
    # To the rounding of a share of the volume.
    lack = np.abs(by_n - weights * transient.wear_rate(K, PHI, n))
    assert np.all(lack < 1e-14 * weights * first_rate(K, PHI))


@pytest.mark.compiled
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
    np.testing.assert_allclose(pressure, fretting.initial_pressure(r, K), rtol=5e-4, atol=1e-12)
    assert np.all(np.asarray(transient.pressure(r, K, PHI, unit)) >= 0.0)
    radius = np.asarray(transient.contact_radius(K, PHI, np.concatenate([begin, unit, end], axis=1)))
    np.testing.assert_allclose(radius[:, :1], 1.0, atol=1e-12)
    np.testing.assert_allclose(radius[:, 2:], outer, rtol=1e-9)
    assert np.all(np.diff(radius, axis=1) >= 0.0)


@pytest.mark.compiled
@pytest.mark.parametrize("part", [0.1, pytest.param(0.5, marks=pytest.mark.long), 1.0])
def test_the_rate_is_that_of_the_pressures_and_of_their_energy(unit, part):
    """By the pressure times the gap that wear has opened, and by the energy in the one-dimensional picture."""
    n = part * unit
    c, outer = (np.asarray(x)[:, 0] for x in (fretting.stick_radius(K, PHI), transient.contact_radius(K, PHI, n)))
    edges = np.stack([transient_oracle.rings_between(*at) for at in zip(c, outer, strict=True)])
    r = np.sqrt(0.5 * (edges[:, 1:] + edges[:, :-1]))
    p, h = (np.asarray(field(r, K, PHI, n)) for field in (transient.pressure, transient.wear_depth))
    rate, first = (np.asarray(x)[:, 0] for x in (transient.wear_rate(K, PHI, n), first_rate(K, PHI)))
    for i in range(5):
        found = transient_oracle.rates(float(K[i, 0]), float(PHI[i, 0]), edges[i], p[i], h[i])
        np.testing.assert_allclose(found / first[i], rate[i] / first[i], atol=0.013)
    missing = np.pi * np.sum(h * np.diff(edges), 1) - np.asarray(transient.wear_volume(K, PHI, n))[:, 0]
    assert np.all(np.abs(missing) < 2e-3 * np.asarray(fretting.wear_volume(K, PHI))[:, 0])


def test_nothing_wears_without_an_amplitude():
    phi = np.zeros((5, 1))
    assert np.all(transient.wear_volume(K, phi, np.ones((5, 16))) == 0.0)


@pytest.mark.compiled
def test_float32_keeps_three_digits(volume, times):
    single = [x.astype(np.float32) for x in (K, PHI, times)]
    worn = transient.wear_volume(*single, digits=3)
    assert worn.dtype == jnp.float32
    error = (np.asarray(worn, float) - volume) / np.asarray(fretting.wear_volume(K, PHI))
    assert np.max(np.abs(error)) < 1e-3


@pytest.mark.parametrize("wrong", [(1.0, 0.5, 1.0), (0.0, 1.0, 1.0), (0.0, 0.5, -1.0), (0.0, 0.5, np.inf)])
def test_bad_input_is_refused(wrong):
    with pytest.raises(ValueError, match="is outside the allowed range"):
        transient.wear_volume(*wrong)


def test_traced_bad_input_gives_nan(times):
    wrong = np.where(np.arange(5)[:, None] == 2, 1.5, PHI)
    worn = jax.jit(lambda phi: transient.wear_volume(K, phi, times[:, 6:7], digits=2))(wrong)
    np.testing.assert_array_equal(np.isnan(worn), np.arange(5)[:, None] == 2)


def test_an_empty_array_of_cycles_has_an_empty_answer():
    assert transient.wear_volume(K, PHI, np.zeros((5, 0))).shape == (5, 0)


def test_the_displacement_of_the_worn_contact_is_larger():
    """In the steady state by c^2 Lambda/2 over (1 - c^2)/(1+k); Mindlin's relation before any wear."""
    for k in (-0.5, 0.0, 0.5):
        dome = contact(k)
        u = np.array([dome.displacement_amplitude(2.0, worn=worn) for worn in (False, True)])
        c, s = float(fretting.stick_radius(k, 0.5)), 0.5 * (1.0 + k)
        assert u[1] / u[0] == pytest.approx(c**2 * 0.5 / (0.5 * (1.0 + s)) / (1.0 - c**2), rel=1e-12)
        rig = np.array([dome.displacement_amplitude(2.0, worn=worn, rig_stiffness=1e6) for worn in (False, True)])
        np.testing.assert_allclose(rig - u, 2.0 / 1e6, rtol=1e-9)


# --- in SI units ----------------------------------------------------------------------------------------------------


def contact(k=0.3):
    return FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), radius=5e-3, normal_force=10.0, friction=0.4)
