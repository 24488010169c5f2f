"""Tangential displacement, slip, energy and loop of the unworn contact, and theta."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import surface_oracle
from kinds import LIMIT, dome
from marks import compiled_case, parametrize
from numpy.testing import assert_allclose

from plgwear_jax import Elastic, fretting, material, partial_slip
from plgwear_jax.loads import Displacement, Force
from plgwear_jax.shapes import PowerShape, TruncatedSphere

EXPONENTS = np.array([-0.9, -0.5, 0.0, 0.3, 0.9])
GROSS = r"0 <= displacement_amplitude < .* m, where gross slip begins"


@parametrize("k, nu", [(0.0, 0.3), (0.5, 0.2), (-0.5, 0.4), (0.8, 0.3), (-0.8, 0.1), (0.3, -0.5)])
def test_theta_is_that_of_the_equations_of_plane_strain(k, nu):
    assert_allclose(material.tangential_ratio(k, nu), surface_oracle.tangential_ratio(k, nu), rtol=1e-9)


def test_a_homogeneous_body_is_that_of_mindlin_and_deresiewicz():
    phi = np.array([0.3, 0.5, 0.9])
    steady = dome().steady(LIMIT * phi)
    a_0, shear = steady.contact_radius, 110e9 / 2.6
    lost = 9 * LIMIT**2 * 1.7 / (10 * a_0 * shear)
    lost = lost * (1 - (1 - phi) ** (5 / 3) - 5 * phi / 6 * (1 + (1 - phi) ** (2 / 3)))
    assert_allclose(steady.energy_per_cycle, lost, rtol=1e-11)
    moved = 3 * LIMIT * 1.7 / (16 * shear * a_0) * (1 - (1 - phi) ** (2 / 3))
    assert_allclose(steady.displacement_amplitude, moved, rtol=1e-13)


def test_a_displacement_of_gross_slip_has_no_steady_state():
    contact = dome(0.3)
    onset = contact.steady(0.0).gross_slip_displacement
    with pytest.raises(ValueError, match=GROSS):
        contact.steady(Displacement([0.5 * onset, 1.01 * onset]))
    found = jax.jit(lambda moved: [getattr(contact.steady(Displacement(moved)), x) for x in ASKED])(1.01 * onset)
    assert np.all(np.isnan(found))


ASKED = "wear_volume", "tangential_force"


def test_the_smallest_displacements_go_with_the_smallest_forces():
    """There phi = d (1 + X)/(2/(3 + k) + X), to all digits and never below 0."""
    k, moved, compliance = (
        x.ravel() for x in np.meshgrid(np.linspace(-0.99, 0.99, 12), np.geomspace(1e-280, 1e-17, 12), [0.3, 1.0, 4.0])
    )
    expected = moved * (1.0 + compliance) / (2.0 / (3.0 + k) + compliance)
    assert_allclose(partial_slip.amplitude(k, moved, compliance), expected, rtol=1e-14)


@parametrize("k", [-0.5, 0.0, 0.5])
def test_the_displacement_of_the_worn_contact_is_larger(k):
    """In the steady state by c^2 Lambda/2 over (1 - c^2)/(1+k); Mindlin's relation before any wear."""
    alone, rig = (dome(k).steady(Force(0.5 * LIMIT, stiffness)) for stiffness in (None, 1e6))
    u, at_actuator = (np.array([x.displacement_amplitude, x.worn_displacement_amplitude]) for x in (alone, rig))
    c, s = fretting.stick_radius(k, 0.5), 0.5 * (1.0 + k)
    assert_allclose(u[1] / u[0], c**2 * 0.5 / (0.5 * (1.0 + s)) / (1.0 - c**2), rtol=1e-12)
    assert_allclose(at_actuator - u, 0.5 * LIMIT / 1e6, rtol=1e-9)


# --- the loop ---------------------------------------------------------------------------------------------------------


def loop(contact, force, rig, points=4001):
    """(Energy, displacement at no force on the way back) of the loop that Masing's rule makes of the first loading."""
    # Forces are dense at both ends, where the curve may be steep.
    forces = -force * np.cos(np.pi * np.linspace(0.0, 1.0, points))
    alone = contact.steady(0.5 * (force - forces)).displacement_amplitude
    back = contact.steady(force).displacement_amplitude + rig * force - 2.0 * alone - rig * (force - forces)
    return np.trapezoid(back + back[::-1], forces), np.interp(0.0, forces, back)


@parametrize("k", EXPONENTS)
def test_energy_ratio_and_aperture_are_those_of_the_loop(k):
    contact, force = dome(k), 0.7 * LIMIT
    energy, opened = loop(contact, force, 1e-7)
    found = contact.steady(Force(force, 1e7))
    most = found.displacement_amplitude
    expected = energy, energy / (4.0 * force * most), opened / most  # a rig loses nothing
    assert_allclose([found.energy_per_cycle, found.energy_ratio, found.loop_aperture], expected, rtol=1e-5)


def test_at_the_onset_of_gross_slip():
    ratio, aperture = (1.0 + EXPONENTS) / (5.0 + EXPONENTS), 2.0 ** ((1.0 + EXPONENTS) / (3.0 + EXPONENTS)) - 1.0
    two = dataclasses.replace(dome(), material=Elastic(110e9, 0.3), indenter=Elastic(210e9, 0.3))
    alone, rig = (dome(EXPONENTS).steady(Force(0.0, stiffness)) for stiffness in (None, 1e7))
    share = alone.gross_slip_displacement / rig.gross_slip_displacement
    near, same = 1.0 - 1e-15, {"rtol": 1e-14}
    assert_allclose(partial_slip.energy_ratio(EXPONENTS, near), ratio, rtol=1e-6)
    assert_allclose(partial_slip.loop_aperture(EXPONENTS, near), aperture, rtol=1e-6)
    for steady, part, places in ((alone, 1.0, slice(None)), (rig, share, slice(None)), (two.steady(0.0), 1.0, 2)):
        assert_allclose(steady.gross_slip_energy_ratio, (part * ratio)[places], **same)
        assert_allclose(steady.gross_slip_aperture, (part * aperture)[places], **same)


@parametrize("name, part", [("energy_ratio", 6.0), ("loop_aperture", 4.0)])
def test_both_vanish_with_the_force(name, part):
    function, slope = getattr(partial_slip, name), (1.0 + EXPONENTS) / (3.0 + EXPONENTS) / part
    for phi in (0.0, 1e-300, 1e-100, 1e-9):
        assert_allclose(function(EXPONENTS, phi), slope * phi, rtol=1e-8)
    assert_allclose([jax.grad(function, 1)(k, 0.0) for k in EXPONENTS], slope, rtol=1e-14)
    at_rest = jax.grad(lambda force: getattr(dome(0.3).steady(Force(force, 1e7)), name))(0.0)
    moved = dome(0.3).steady(1e-9).displacement_amplitude
    assert_allclose(at_rest, slope[3] / LIMIT * moved / (moved + 1e-9 / 1e7), rtol=1e-9)


@parametrize("shape", [PowerShape(2.0), compiled_case(TruncatedSphere(2e-5))])
def test_loops_and_rings_of_any_shape_vanish_with_the_force(shape):
    def asked(force):
        steady = dome(0.3, shape=shape).steady(force)
        grown = steady.worn_radius - steady.contact_radius
        return jnp.stack([steady.energy_ratio, steady.loop_aperture, grown])

    assert_allclose(jax.jvp(asked, (0.0,), (1.0,))[1], asked(4e-6) / 4e-6, rtol=1e-5)


def test_the_force_of_a_displacement_has_the_slopes_of_the_closed_form():
    def force(shape):
        return lambda moved: dome(0.3, shape=shape).steady(Displacement(moved)).tangential_force

    found, known = (jax.jvp(force(shape), (2e-7,), (1.0,)) for shape in (PowerShape(2.0), None))
    assert_allclose(found, known, rtol=1e-9)


@parametrize("stiffness", [0.0, -1.0, np.nan])
def test_a_traced_rig_that_is_none_is_nan(stiffness):
    assert np.isnan(jax.jit(lambda rig: dome().steady(Force(2.0, rig)).loop_aperture)(jnp.asarray(stiffness)))
