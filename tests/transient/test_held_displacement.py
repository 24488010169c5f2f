"""Wear under a held displacement amplitude: against rings and the Green's function alone, and in its limits."""

import functools

import jax.numpy as jnp
import numpy as np
import pytest
from transient_oracle import march_at_held_displacement

from plgwear_jax import fretting, partial_slip, transient

# One shape for all, and so one program: two contacts under the displacement of their own and of two rigs.
K, PHI = np.array([0.0, 0.5])[:, None, None], np.array([0.5, 0.8])[:, None, None]
RIG = np.array([0.0, 1.0, 1e9])[:, None]
HELD = {"control": "displacement", "compliance": RIG}
ERROR = 1e-2  # promised, of the final volume


@functools.cache
def unit():
    """What the first cycles would take for the final volume, of each contact."""
    return np.asarray(fretting.wear_volume(K, PHI) / (0.25 * np.pi * partial_slip.energy_per_cycle(K, PHI)))


def times():
    return unit() * np.array([0.0, 1e-6, 0.1, 0.3, 0.6, 1.0, 3.0, 1e6])


@pytest.fixture(scope="module")
def volume():
    return np.asarray(transient.wear_volume(K, PHI, times(), **HELD))


@pytest.fixture(scope="module")
def at_held_force():
    return np.asarray(transient.wear_volume(K[:, 0], PHI[:, 0], times()[:, 0], digits=2))


def test_the_volume_is_that_of_rings_and_the_greens_function_alone(volume):
    for i, more in ((0, 6e-3), (1, 8e-3)):
        k, phi = float(K[i, 0, 0]), float(PHI[i, 0, 0])
        marched = 8.0 * unit()[i, 0, 0] * np.expm1(4.0 * np.linspace(0.0, 1.0, 161)) / np.expm1(4.0)
        worn, _ = march_at_held_displacement(k, phi, marched, 160)
        final = float(fretting.wear_volume(k, phi))
        there = np.interp(times()[i, 0, 2:7], marched, worn)
        np.testing.assert_allclose(volume[i, 0, 2:7] / final, there / final, atol=ERROR + more)
        assert volume[i, 0, -1] == pytest.approx(worn[-1], rel=ERROR + more)


@pytest.mark.compiled
def test_the_first_cycles_are_those_of_a_held_force(volume, at_held_force):
    np.testing.assert_array_equal(volume[..., 0], 0.0)
    first = np.broadcast_to(at_held_force[:, None, 1], volume.shape[:-1])
    np.testing.assert_allclose(volume[..., 1], first, rtol=2e-5)


@pytest.mark.compiled
def test_a_compliant_rig_holds_the_force(volume, at_held_force):
    final = at_held_force[:, -1:]
    np.testing.assert_allclose(volume[:, 2] / final, at_held_force / final, atol=ERROR)
    assert np.all(np.diff(volume[..., 2:], axis=1) > 0.0)  # the stiffer the rig, the less is worn


def test_less_is_worn_in_the_end_since_more_sticks(volume):
    np.testing.assert_allclose(volume[:, 0, -1] / fretting.wear_volume(K, PHI)[:, 0, 0], [0.931, 0.760], atol=ERROR)
    assert np.all(np.diff(volume, axis=-1) >= 0.0)


def test_nothing_is_put_back_when_hardly_anything_wears():
    """From ten units of time on less is worn in a step than its error."""
    k, phi = np.array([0.9, 0.5])[:, None, None], np.array([0.2, 0.4])[:, None, None]
    late = np.array([0.0, 20.0, 40.0, 50.0, 80.0, 100.0, 200.0, 1e6])
    assert np.all(np.diff(transient.wear_volume(k, phi, late, **HELD), axis=-1) >= 0.0)
    assert np.all(transient.wear_rate(k, phi, late, **HELD) >= 0.0)


@pytest.mark.compiled
def test_cycles_and_fields_go_with_the_volume(volume):
    n = np.asarray(transient.cycles(K, PHI, np.array([0.1, 0.5, 0.9]), **HELD))
    there = np.asarray(transient.wear_volume(K, PHI, np.pad(n, ((0, 0), (0, 0), (0, 5))), **HELD))[..., :3]
    np.testing.assert_allclose(there / volume[..., -1:], np.broadcast_to([0.1, 0.5, 0.9], there.shape), rtol=1e-9)
    r = np.linspace(0.0, 1.9, 400)[:, None, None, None]
    depth = np.asarray(transient.wear_depth(r, K, PHI, times(), **HELD))
    pressure = np.asarray(transient.pressure(r, K, PHI, times(), **HELD))
    ring = np.pi * np.diff(r**2, axis=0)
    total = np.sum(0.5 * (depth[1:] + depth[:-1]) * ring, axis=0)
    np.testing.assert_allclose(total, volume, atol=2.0 * ERROR * volume.max())
    assert np.all(depth >= 0.0) and np.all(pressure >= 0.0)
    np.testing.assert_allclose(np.sum(pressure[1:, ..., :3] * ring, axis=0), np.pi, rtol=0.03)
    radius = np.asarray(transient.contact_radius(K, PHI, times(), **HELD))
    assert np.all(np.diff(radius, axis=-1) >= 0.0) and np.all(radius <= fretting.worn_radius(K, PHI) * 1.001)


@pytest.mark.long  # compiles
def test_two_digits_are_kept_over_the_whole_domain(monkeypatch):
    from plgwear_jax.transient import held_displacement as held

    k, phi = (jnp.asarray(x.ravel()) for x in np.meshgrid([-0.97, -0.4, 0.3, 0.97], [0.005, 0.3, 0.8, 0.98]))
    shares = []
    for factor in (1, 2):
        for name in ("_INSIDE", "_WINDOW", "_UNWORN", "_OUTER", "_STEPS"):
            monkeypatch.setattr(held, name, factor * getattr(held, name))
        held._grids.cache_clear(), held._times.cache_clear()
        found = held.runs(held.run, k, phi, jnp.zeros(()))
        volume = np.asarray(found.volume.value * found.scales.volume[:, None])
        shares.append(volume[:, ::factor] / np.asarray(fretting.wear_volume(k, phi))[:, None])
    held._grids.cache_clear(), held._times.cache_clear()
    assert np.max(np.abs(shares[1] - shares[0])) < 0.75 * ERROR


@pytest.mark.parametrize(
    "given, what",
    [
        ({"control": "speed"}, "control = 'speed' is neither 'force' nor 'displacement'"),
        (
            {"control": "displacement", "digits": 3},
            "digits = 3 is outside the allowed range 1 <= digits <= 2 of wear under displacement control",
        ),
        ({"control": "displacement", "compliance": -1.0}, "compliance = -1.0 is outside the allowed range"),
    ],
)
def test_bad_input_is_refused(given, what):
    with pytest.raises(ValueError, match=what):
        transient.wear_volume(0.0, 0.5, 1.0, **given)


# --- in SI units ----------------------------------------------------------------------------------------------------
