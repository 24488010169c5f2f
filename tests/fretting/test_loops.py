"""The loop of force and displacement before any wear: its energy ratio and its aperture, and those of gross slip."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from plgwear_jax import Elastic, FrettingContact, PowerLawGraded, partial_slip
from plgwear_jax.loads import Force

EXPONENTS = np.array([-0.9, -0.5, 0.0, 0.3, 0.9])
LIMIT = 4.0  # mu F_N


def dome(k=0.0):
    return FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), radius=5e-3, normal_force=10.0, friction=0.4)


def loop(contact, force, rig=0.0, points=4001):
    """(Energy, displacement at no force on the way back) of the loop that Masing's rule makes of the first loading."""
    # Forces are dense at both ends, where the curve may be steep.
    share = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, points))
    forces = force * (2.0 * share - 1.0)
    alone = np.asarray(contact.steady(0.5 * (force - forces)).displacement_amplitude)
    back = float(contact.steady(force).displacement_amplitude) + rig * force - 2.0 * alone - rig * (force - forces)
    forth = -back[::-1]
    return np.trapezoid(back - forth, forces), np.interp(0.0, forces, back)


@pytest.mark.parametrize("k", EXPONENTS)
@pytest.mark.parametrize("rig", [None, 1e7])
def test_both_are_those_of_the_loop(k, rig):
    contact, force = dome(k), 0.7 * LIMIT
    energy, opened = loop(contact, force, 0.0 if rig is None else 1.0 / rig)
    most = float(contact.steady(Force(force, rig)).displacement_amplitude)
    found = contact.steady(Force(force, rig)).energy_ratio, contact.steady(Force(force, rig)).loop_aperture
    np.testing.assert_allclose(found, [energy / (4.0 * force * most), opened / most], rtol=1e-5)
    assert energy == pytest.approx(float(contact.steady(force).energy_per_cycle), rel=1e-5)  # a rig loses nothing


def test_at_the_onset_of_gross_slip():
    contact = dome(EXPONENTS)
    ratio, aperture = (1.0 + EXPONENTS) / (5.0 + EXPONENTS), 2.0 ** ((1.0 + EXPONENTS) / (3.0 + EXPONENTS)) - 1.0
    np.testing.assert_allclose(contact.steady(0.0).gross_slip_energy_ratio, ratio, rtol=1e-14)
    np.testing.assert_allclose(contact.steady(0.0).gross_slip_aperture, aperture, rtol=1e-14)
    near = 1.0 - 1e-15
    np.testing.assert_allclose(partial_slip.energy_ratio(EXPONENTS, near), ratio, rtol=1e-6)
    np.testing.assert_allclose(partial_slip.loop_aperture(EXPONENTS, near), aperture, rtol=1e-6)
    two = dataclasses.replace(dome(), material=Elastic(110e9, 0.3), indenter=Elastic(210e9, 0.3))
    assert float(two.steady(0.0).gross_slip_energy_ratio) == pytest.approx(0.2, rel=1e-15)
    assert float(two.steady(0.0).gross_slip_aperture) == pytest.approx(2.0 ** (1.0 / 3.0) - 1.0, rel=1e-15)
    alone, rig = dome(0.5).steady(0.0), dome(0.5).steady(Force(0.0, 1e7))
    share = float(alone.gross_slip_displacement / rig.gross_slip_displacement)
    assert float(rig.gross_slip_energy_ratio) == pytest.approx(share * 1.5 / 5.5, rel=1e-14)
    assert float(rig.gross_slip_aperture) == pytest.approx(share * float(alone.gross_slip_aperture), rel=1e-14)


@pytest.mark.parametrize("name, part", [("energy_ratio", 6.0), ("loop_aperture", 4.0)])
def test_both_vanish_with_the_force(name, part):
    function, slope = getattr(partial_slip, name), (1.0 + EXPONENTS) / (3.0 + EXPONENTS) / part
    np.testing.assert_array_equal(function(EXPONENTS, 0.0), 0.0)
    for phi in (1e-300, 1e-100, 1e-9):
        np.testing.assert_allclose(function(EXPONENTS, phi), slope * phi, rtol=1e-8)
    np.testing.assert_allclose([jax.grad(function, 1)(k, 0.0) for k in EXPONENTS], slope, rtol=1e-14)
    at_rest = jax.grad(lambda force: getattr(dome(0.3).steady(Force(force, 1e7)), name))(0.0)
    moved = float(dome(0.3).steady(1e-9).displacement_amplitude)
    assert float(at_rest) == pytest.approx(slope[3] / LIMIT * moved / (moved + 1e-9 / 1e7), rel=1e-9)


def test_float32_and_what_is_outside():
    for function in (partial_slip.energy_ratio, partial_slip.loop_aperture):
        single = function(np.float32(0.3), np.float32(0.5))
        assert single.dtype == np.float32 and float(single) == pytest.approx(float(function(0.3, 0.5)), rel=1e-6)
        with pytest.raises(ValueError, match=r"phi = 1.0 is outside the allowed range 0 <= phi < 1"):
            function(0.3, 1.0)
        assert np.isnan(jax.jit(function)(0.3, jnp.asarray(1.0)))
    with pytest.raises(ValueError, match="rig_stiffness"):
        dome().steady(Force(2.0, 0.0))
    assert np.isnan(jax.jit(lambda rig: dome().steady(Force(2.0, rig)).loop_aperture)(-1.0))
