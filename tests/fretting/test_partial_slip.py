"""Tangential displacement, slip and energy of the unworn contact, and theta."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import transient_oracle

from plgwear_jax import FrettingContact, PowerLawGraded, fretting, material, partial_slip
from plgwear_jax.loads import Displacement, Force


@pytest.mark.parametrize("k, nu", [(0.0, 0.3), (0.5, 0.2), (-0.5, 0.4), (0.8, 0.3), (-0.8, 0.1), (0.3, -0.5)])
def test_theta_is_that_of_the_equations_of_plane_strain(k, nu):
    assert float(material.tangential_ratio(k, nu)) == pytest.approx(transient_oracle.tangential_ratio(k, nu), rel=1e-9)


def test_theta_at_known_points():
    assert float(material.tangential_ratio(0.0, 0.3)) == pytest.approx(1.7 / 1.4, rel=1e-15)
    assert float(material.tangential_ratio(0.4, 1.0 / 2.4)) == pytest.approx(1.4 * 3.4 / 2.0, rel=1e-14)
    assert float(material.tangential_ratio(-0.4, "holl")) == pytest.approx(0.6 * 2.6 / 2.0, rel=1e-15)
    assert material.tangential_ratio(jnp.float32(0.4), jnp.float32(0.3)).dtype == jnp.float32


def dome(k=0.0):
    return FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), radius=5e-3, normal_force=10.0, friction=0.4)


def test_a_homogeneous_body_is_that_of_mindlin_and_deresiewicz():
    contact, phi = dome(), np.array([0.3, 0.5, 0.9])
    a_0, shear = float(contact.steady(0.0).contact_radius), 110e9 / 2.6
    lost = 9 * 0.4**2 * 10.0**2 * 1.7 / (10 * a_0 * shear)
    lost = lost * (1 - (1 - phi) ** (5 / 3) - 5 * phi / 6 * (1 + (1 - phi) ** (2 / 3)))
    np.testing.assert_allclose(contact.steady(4.0 * phi).energy_per_cycle, lost, rtol=1e-11)
    moved = 3 * 0.4 * 10.0 * 1.7 / (16 * shear * a_0) * (1 - (1 - phi) ** (2 / 3))
    np.testing.assert_allclose(contact.steady(4.0 * phi).displacement_amplitude, moved, rtol=1e-13)


@pytest.mark.compiled
@pytest.mark.parametrize("rig", [None, 1e4, 1e7, 1e12])
@pytest.mark.parametrize("k", [-0.6, 0.3])
def test_force_and_displacement_turn_each_other(k, rig):
    contact, force = dome(k), 4.0 * np.array([0.0, 1e-9, 0.1, 0.5, 0.99, 1.0 - 1e-9])
    moved = np.asarray(contact.steady(Force(force, rig)).displacement_amplitude)
    np.testing.assert_allclose(contact.steady(Displacement(moved, rig)).tangential_force, force, rtol=1e-13)
    limit = float(contact.steady(Force(0.0, rig)).gross_slip_displacement)
    alone = float(contact.steady(0.0).gross_slip_displacement)
    assert limit == pytest.approx(alone + (4.0 / rig if rig else 0.0), rel=1e-14)
    with pytest.raises(ValueError, match=r"0 <= displacement_amplitude < .* m, where gross slip begins"):
        _ = contact.steady(Displacement(1.01 * limit, rig)).tangential_force
    assert np.isnan(jax.jit(lambda moved: contact.steady(Displacement(moved)).tangential_force)(1.01 * alone))


def test_a_displacement_of_gross_slip_has_no_steady_state():
    contact = dome(0.3)
    onset = contact.steady(0.0).gross_slip_displacement
    with pytest.raises(ValueError, match=r"0 <= displacement_amplitude < .* m, where gross slip begins"):
        contact.steady(Displacement([0.5 * onset, 1.01 * onset]))
    assert np.isnan(jax.jit(lambda moved: contact.steady(Displacement(moved)).wear_volume)(1.01 * onset))


@pytest.mark.compiled
def test_the_force_has_the_slope_of_the_displacement_turned():
    contact = dome(0.3)
    moved = float(contact.steady(Force(2.0, 1e7)).displacement_amplitude)
    forth = jax.grad(lambda force: contact.steady(Force(force, 1e7)).displacement_amplitude)(2.0)
    back = jax.grad(lambda moved: contact.steady(Displacement(moved, 1e7)).tangential_force)(moved)
    assert float(forth * back) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.compiled
def test_energy_is_what_friction_does_along_the_slip():
    # Four slip amplitudes a cycle under mu p_0.
    steady = dome(0.3).steady(2.0)
    a_0, c = float(steady.contact_radius), float(steady.stick_radius)
    x, weight = np.polynomial.legendre.leggauss(200)
    r = c + (a_0 - c) * (1.0 - (0.5 - 0.5 * x) ** 2)
    length = 0.5 * weight * (a_0 - c) * 2.0 * (0.5 - 0.5 * x)
    work = 0.4 * np.asarray(steady.initial_pressure(r)) * 4.0 * np.asarray(steady.slip_amplitude(r))
    assert float(steady.energy_per_cycle) == pytest.approx(np.sum(length * 2 * np.pi * r * work), rel=1e-6)
    np.testing.assert_array_equal(steady.slip_amplitude(np.array([0.0, 0.9 * c, 1.01 * a_0])), 0.0)


@pytest.mark.parametrize("stiffness", [0.0, -1.0, np.nan])
def test_a_rig_that_is_none_is_refused(stiffness):
    with pytest.raises(ValueError, match="rig_stiffness"):
        dome().steady(Force(2.0, stiffness))


def test_displacement_is_a_share_of_that_of_gross_slip():
    phi = np.array([0.0, 0.25, 0.75])
    share = partial_slip.displacement_amplitude(0.2, phi)
    np.testing.assert_allclose(share, 1.0 - fretting.stick_radius(0.2, phi) ** 2, rtol=1e-14, atol=1e-16)


def test_the_smallest_displacements_go_with_the_smallest_forces():
    """There phi = d (1 + X)/(2/(3 + k) + X), to all digits and never below 0."""
    k, moved, compliance = (
        x.ravel() for x in np.meshgrid(np.linspace(-0.99, 0.99, 12), np.geomspace(1e-280, 1e-17, 12), [0.3, 1.0, 4.0])
    )
    expected = moved * (1.0 + compliance) / (2.0 / (3.0 + k) + compliance)
    np.testing.assert_allclose(partial_slip.amplitude(k, moved, compliance), expected, rtol=1e-14)


@pytest.mark.parametrize("k", [-0.5, 0.0, 0.5])
def test_the_displacement_of_the_worn_contact_is_larger(k):
    """In the steady state by c^2 Lambda/2 over (1 - c^2)/(1+k); Mindlin's relation before any wear."""
    alone, rig = (dome(k).steady(Force(2.0, stiffness)) for stiffness in (None, 1e6))
    u, at_actuator = (np.array([x.displacement_amplitude, x.worn_displacement_amplitude]) for x in (alone, rig))
    c, s = float(fretting.stick_radius(k, 0.5)), 0.5 * (1.0 + k)
    assert u[1] / u[0] == pytest.approx(c**2 * 0.5 / (0.5 * (1.0 + s)) / (1.0 - c**2), rel=1e-12)
    np.testing.assert_allclose(at_actuator - u, 2.0 / 1e6, rtol=1e-9)
