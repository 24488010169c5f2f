"""Elastic indenters and any E(z): against closed forms, against rings of constant pressure, and what they refuse."""

import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import surface_oracle
from half_spaces import A, graded_compliance, layers_under_steel
from kinds import FORCE, FRICTION, RADIUS, STEEL, contact_of
from scipy.interpolate import PchipInterpolator

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded, PowerShape, coating, material
from plgwear_jax.shapes import TruncatedSphere

STEADY = ("contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume")


# --- against rings ----------------------------------------------------------------------------------------------------


def of_rings(compliance, coating, indenter, share, most, exponent=None):
    """The library against the rings, at 5 digits, for a stick radius of a share of the contact radius."""
    steady = surface_oracle.steady(compliance, A, share * A, n=exponent or 2.0)
    shape = None if exponent is None else PowerShape(exponent)
    contact = FrettingContact(coating, 1.0, steady.force, 0.5, indenter, shape)
    found = contact.steady(0.5 * steady.force * steady.phi, digits=5)
    expected = A, share * A, steady.worn_radius, steady.penetration, steady.volume
    for name, other in zip(STEADY, expected, strict=True):
        np.testing.assert_allclose(getattr(found, name), other, rtol=most, err_msg=name)


@pytest.mark.compiled
@pytest.mark.parametrize("k", [-0.6, -0.3, 0.3, 0.6])
def test_a_power_law_under_steel_is_that_of_rings(k):
    g = surface_oracle.power_compliance(110e9, 1e-4, k, float(material.h_N(k, 0.3)), 0.3)
    compliance = surface_oracle.Compliance([(g, k), (2.0 * (1.0 - 0.3**2) / 210e9, 0.0)])
    of_rings(compliance, PowerLawGraded(110e9, 1e-4, k, 0.3), STEEL, 0.6, 2e-5)


@pytest.mark.compiled
def test_layers_under_steel_are_those_of_rings():
    coating, compliance = layers_under_steel()
    of_rings(compliance, coating, STEEL, 0.6, 2e-5)
    for exponent, most in ((3.0, 5e-5), (6.0, 2e-5)):
        of_rings(compliance, coating, STEEL, 0.6, most, exponent)


@pytest.mark.compiled
def test_a_table_under_steel_is_that_of_rings():
    depth, modulus = np.array([0.15, 0.4, 1.0, 2.5]) * A, np.array([400e9, 150e9, 300e9, 210e9])
    cubic = PchipInterpolator(depth, modulus)
    assert np.max(abs(DepthGraded(depth, modulus, 0.25).modulus_at(np.linspace(0.1, 3.0, 40) * A) / 1e9)) <= 400.0
    np.testing.assert_allclose(
        DepthGraded(depth, modulus, 0.25).modulus_at(np.linspace(0.15, 2.5, 40) * A),
        cubic(np.linspace(0.15, 2.5, 40) * A),
        rtol=1e-12,
    )
    compliance = graded_compliance(
        lambda z: float(cubic(np.clip(z, depth[0], depth[-1]))), 0.25, depth[-1], list(depth), STEEL
    )
    of_rings(compliance, DepthGraded(depth, modulus, 0.25), STEEL, 0.6, 2e-5)


@pytest.mark.compiled
def test_a_layer_changes_the_stiffness_of_a_punch_as_published():
    """Gao, Chiu and Lee 1992: a flat punch on a layer, to first order in the change of its modulus."""
    thickness, step, phi = np.array([0.1, 0.3, 1.0, 3.0]) * A, np.array([[0.02], [-0.02]]), 0.5
    moduli = np.stack(np.broadcast_arrays(110e9 * np.exp(step), 110e9, thickness)[:2], -1)
    layer = Layered(thickness[:, None], moduli, 0.3)
    whole, part = contact_of(layer), contact_of(layer, force=FORCE * (1.0 - phi))
    # The steady state is the unworn contact of the same radius, which a flat punch has pressed deeper.
    c = np.asarray(whole.steady(FRICTION * FORCE * phi, digits=5).stick_radius)
    deeper = whole.steady(FRICTION * FORCE * phi, digits=5).penetration - part.steady(
        0.0, digits=5
    ).initial_displacement(0.0 * c)
    slope = np.squeeze(np.diff(np.log(deeper * c), axis=0)) / (2.0 * 0.02)
    np.testing.assert_allclose(slope, coating.felt(thickness / np.mean(c, 0), 0.3), rtol=5e-5)


@pytest.mark.compiled
def test_a_measured_contact_with_alumina_and_glass():
    """Jitcharoen et al. 1998: radii of 0.3895 mm on the graded body and 0.3597 mm on alumina were measured."""
    depth = np.linspace(0.0, 1.0, 48) ** 3 * 5e-3
    graded = DepthGraded(depth, 1e9 * (254.0 + 85.3 * (depth / 1e-3) ** 0.497), 0.22)
    alumina, ball = PowerLawGraded(386e9, 1e-4, 0.0, 0.22), Elastic(614e9, 0.22)
    radii = [FrettingContact(body, 4.76e-3, 3000.0, 0.5, ball).steady(0.0).contact_radius for body in (graded, alumina)]
    np.testing.assert_allclose(radii, [0.374e-3, 0.350e-3], rtol=3e-3)


# --- derivatives, and what is refused ---------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("kind", ["power law", "table"])
def test_second_derivatives(kind):
    def volume(x):
        if kind == "table":
            coating = DepthGraded(
                [1e-5, 3e-5, 1e-4], 1e11 * jnp.exp(jnp.stack([x[0], 0.6 + 0.0 * x[0], 0.2 + 0.0 * x[0]])), 0.3
            )
        else:
            coating = PowerLawGraded(110e9, 1e-4, x[0], 0.3)
        return jnp.log(contact_of(coating, Elastic(210e9 * jnp.exp(x[1]), 0.3)).steady(1.5).wear_volume)

    at, step = np.array([0.3, 0.1]), 1e-3
    slope = jax.jit(jax.grad(volume))
    differences = [(slope(at + side) - slope(at - side)) / (2.0 * step) for side in step * np.eye(2)]
    found = np.asarray(jax.jit(jax.hessian(volume))(at))
    np.testing.assert_allclose(found, found.T, atol=1e-5)
    np.testing.assert_allclose(found, differences, atol=2e-5)


def test_a_narrow_ring_beside_a_kink():
    """Its derivative is that of differences: the slope of what a kink adds is singular."""
    contact = contact_of(PowerLawGraded(110e9, 1e-4, 0.26, 0.3), STEEL, TruncatedSphere(8.76e-5))

    def volume(log_force):
        return jnp.log(contact.steady(jnp.exp(log_force)).wear_volume)

    at = np.log(0.003 * FRICTION * FORCE)
    difference = (volume(at + 1e-3) - volume(at - 1e-3)) / 2e-3
    np.testing.assert_allclose(jax.grad(volume)(at), difference, rtol=1e-5)
    single = jax.tree.map(jnp.float32, contact)
    state = jax.eval_shape(lambda one: one.steady(jnp.float32(1.0))._solution, single)
    assert {x.dtype for x in jax.tree.leaves(state)} == {jnp.dtype("float32")}


@pytest.mark.long
def test_derivatives_are_finite_where_there_is_no_gradient():
    slope = jax.grad(lambda contact: contact.steady(1.5).wear_volume)(
        contact_of(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), STEEL)
    )
    assert all(np.isfinite(leaf) for leaf in jax.tree.leaves(slope))


def test_what_is_refused():
    E = [1e11, 2e11, 3e11]
    for depth, modulus, told in (
        ([0.0, 2e-5, 1e-5], E, "depths must increase"),
        ([0.0, 1e-5, 1e-5, 1e-5], [*E, 1e11], "not three times"),
        ([0.0, -1e-5, 1e-5], E, r"depth = -1e-05 at index 1 is outside"),
        ([0.0, np.nan, 1e-5], E, "depth = nan"),
        ([0.0, 1e-5, 2e-5], [1e11, -1.0, 1e11], "modulus = -1.0"),
        ([0.0], [1e11], "two points or more"),
        ([0.0, 1e-5], E, "two points or more"),
    ):
        with pytest.raises(ValueError, match=told) as error:
            DepthGraded(depth, modulus, 0.3)
        assert "\n" not in str(error.value)
    for thickness, modulus, told in (
        ([1e-5], [1e11], r"thickness of shape \(1,\) and modulus of shape \(1,\): there must be one modulus more"),
        ([[1e-5]], [1e11, 2e11, 3e11], r"shape \(1, 1\) and modulus of shape \(3,\): there must be one modulus more"),
        (1e-5, [1e11, 2e11], r"thickness of shape \(\) and modulus of shape \(2,\)"),
        ([], [], r"thickness of shape \(0,\) and modulus of shape \(0,\)"),
        ([0.0], [1e11, 2e11], r"thickness = 0.0 at index 0 is outside the allowed range > 0 and finite"),
        ([1e-5, -1e-6], E, r"thickness = -1e-06 at index 1 is outside"),
        ([np.inf], [1e11, 2e11], r"thickness = inf at index 0 is outside"),
        ([np.nan], [1e11, 2e11], r"thickness = nan at index 0 is outside"),
        ([1e-5], [1e11, 0.0], r"modulus = 0.0 at index 1 is outside"),
    ):
        with pytest.raises(ValueError, match=told) as error:
            Layered(thickness, modulus, 0.3)
        assert "\n" not in str(error.value)
    with pytest.raises(ValueError, match=r"nu = 0\.6"):
        Layered([1e-5], [1e11, 2e11], 0.6)
    with pytest.raises(TypeError, match="thickness takes real numbers"):
        Layered(["a"], [1e11, 2e11], 0.3)
    with pytest.raises(TypeError, match="takes an Elastic"):
        FrettingContact(DepthGraded([0.0, 1e-5], [1e11, 2e11], 0.3), RADIUS, FORCE, FRICTION, "rigid")


def test_closed_forms_pay_nothing_for_numerical_solutions():
    program = (
        "import sys, plgwear_jax as p\n"
        "p.FrettingContact(p.PowerLawGraded(1e11, 1e-4, 0.2, 0.3), 5e-3, 10.0, 0.4).steady(0.0).contact_radius\n"
        "assert not [name for name in sys.modules if 'surfaces' in name or 'numeric' in name.partition('plgwear')[2]]\n"
        "p.FrettingContact(p.Elastic(1e11, 0.3), 5e-3, 10.0, 0.4, p.Elastic(2e11, 0.3)).steady(2.0).wear_volume\n"
        "assert not {'plgwear_jax.steady.numeric'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
