"""Elastic indenters and any E(z): against closed forms, against rings of constant pressure, and what they refuse."""

import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import surface_oracle
from functions import by_numpy
from half_spaces import FORCE, FRICTION, RADIUS, STEEL, A, contact_of, graded_compliance
from scipy.interpolate import PchipInterpolator

from plgwear_jax import DepthGraded, Elastic, FrettingContact, PowerLawGraded, PowerShape, coating, material

PHI = np.array([0.01, 0.3, 0.7, 0.98])
STEADY = ("contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume")


def steady_of(contact, force, digits=None):
    found = [contact.contact_radius(digits=digits)]
    found += [getattr(contact, name)(force, digits=digits) for name in STEADY[1:]]
    return [np.asarray(x) for x in found]


def homogeneous(E, nu, indenter=None):
    """DepthGraded with one modulus, and the closed form of the same."""
    series = (1 - nu**2) / E + (0.0 if indenter is None else (1 - indenter.nu**2) / indenter.E)
    coating = DepthGraded([1e-5, 2e-5, 5e-5, 1e-4], np.full(4, E), nu)
    return coating, PowerLawGraded(1.0 / series, 1e-4, 0.0, 0.0)


long = pytest.mark.long  # to compile; tests below have as many digits


@pytest.mark.compiled
@pytest.mark.parametrize("digits, most", [(4, 1e-4), pytest.param(5, 1e-5, marks=long)])
def test_a_power_law_under_a_nearly_rigid_indenter_is_the_closed_form(digits, most):
    k = np.array([-0.6, -0.3, -0.02, 0.0, 0.02, 0.4, 0.8])[:, None]
    coating, force = PowerLawGraded(110e9, 1e-4, k, 0.3), FRICTION * FORCE * PHI
    numeric = steady_of(contact_of(coating, Elastic(1e20, 0.3)), force, digits)
    closed = steady_of(contact_of(coating), force)
    for name, one, other in zip(STEADY, numeric, closed, strict=True):
        np.testing.assert_allclose(one, other, rtol=most, err_msg=name)


@pytest.mark.compiled
@pytest.mark.parametrize("digits, most", [pytest.param(4, 1e-4, marks=long), (5, 1e-5)])
def test_one_modulus_at_all_depths_is_the_closed_form(digits, most):
    coating, closed = homogeneous(110e9, 0.3, STEEL)
    force = FRICTION * FORCE * PHI
    numeric = steady_of(contact_of(coating, STEEL), force, digits)
    for name, one, other in zip(STEADY, numeric, steady_of(contact_of(closed), force), strict=True):
        np.testing.assert_allclose(one, other, rtol=most, err_msg=name)


def test_two_homogeneous_bodies_have_closed_forms(monkeypatch):
    _, closed = homogeneous(110e9, 0.3, STEEL)
    contact, force = contact_of(Elastic(110e9, 0.3), STEEL), FRICTION * FORCE * PHI
    monkeypatch.setitem(sys.modules, "plgwear_jax.steady.numeric", None)  # importing it would fail
    for one, other in zip(steady_of(contact, force), steady_of(contact_of(closed), force), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)


@pytest.mark.compiled
def test_all_fields_of_one_modulus():
    coating = DepthGraded([1e-5, 2e-5, 5e-5, 1e-4], np.full(4, 110e9), 0.25)
    numeric, closed = contact_of(coating, STEEL), contact_of(Elastic(110e9, 0.25), STEEL)
    force, r, rig = 2.0, np.linspace(0.0, 1.3e-4, 14), 1e7
    asked = {
        "deepest_wear": (force,),
        "edge_pressure": (1e-6, force),
        "edge_intensity": (force,),
        "initial_displacement": (r,),
        "steady_displacement": (r, force),
        "profile": (r, force),
        "wear_depth": (r, force),
        "initial_pressure": (r,),
        "steady_pressure": (r, force),
        "pressure": (r, force),
        "steady_traction": (r, force),
        "peak_initial_pressure": (),
        "slip_amplitude": (r, force),
        "energy_per_cycle": (force,),
        "gross_slip_displacement": (),
        "displacement_amplitude": (force,),
        "tangential_force": (1e-7,),
    }

    # NumPy computes the closed forms: XLA would need seconds to compile them.
    @by_numpy
    def exact():
        return {name: getattr(closed, name)(*arguments) for name, arguments in asked.items()}

    for name, other in exact().items():
        one = np.asarray(getattr(numeric, name)(*asked[name]))
        np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-4 * np.max(abs(other)), err_msg=name)
    worn = [contact.displacement_amplitude(force, worn=True, rig_stiffness=rig) for contact in (numeric, closed)]
    np.testing.assert_allclose(*worn, rtol=1e-6)
    held = numeric.tangential_force(numeric.displacement_amplitude(force, rig_stiffness=rig), rig_stiffness=rig)
    np.testing.assert_allclose(held, force, rtol=1e-6)


# --- against rings ----------------------------------------------------------------------------------------------------


def of_rings(compliance, coating, indenter, share, most, exponent=None):
    """The library against the rings, at 5 digits, for a stick radius of a share of the contact radius."""
    steady = surface_oracle.steady(compliance, A, share * A, n=exponent or 2.0)
    shape = None if exponent is None else PowerShape(exponent)
    contact = FrettingContact(coating, 1.0, steady.force, 0.5, indenter, shape)
    found = steady_of(contact, 0.5 * steady.force * steady.phi, 5)
    expected = A, share * A, steady.worn_radius, steady.penetration, steady.volume
    for name, one, other in zip(STEADY, found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=most, err_msg=name)


@pytest.mark.compiled
@pytest.mark.parametrize("k", [-0.6, -0.3, 0.3, 0.6])
def test_a_power_law_under_steel_is_that_of_rings(k):
    g = surface_oracle.power_compliance(110e9, 1e-4, k, float(material.h_N(k, 0.3)), 0.3)
    compliance = surface_oracle.Compliance([(g, k), (2.0 * (1.0 - 0.3**2) / 210e9, 0.0)])
    of_rings(compliance, PowerLawGraded(110e9, 1e-4, k, 0.3), STEEL, 0.6, 2e-5)


@pytest.mark.compiled
def test_layers_under_steel_are_those_of_rings():
    moduli, interfaces = np.array([50e9, 300e9, 100e9]), np.array([0.3, 1.0]) * A
    compliance = graded_compliance(
        lambda z: moduli[np.searchsorted(interfaces, z, "right")], 0.25, interfaces[-1], list(interfaces), STEEL
    )
    coating = DepthGraded.layers(np.diff(interfaces, prepend=0.0), moduli, 0.25)
    of_rings(compliance, coating, STEEL, 0.6, 2e-5)
    for exponent, most in ((3.0, 5e-5), (6.0, 2e-5)):
        of_rings(compliance, coating, STEEL, 0.6, most, exponent)


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
    layer = DepthGraded.layers(thickness[:, None], moduli, 0.3)
    whole, part = contact_of(layer), contact_of(layer, force=FORCE * (1.0 - phi))
    # The steady state is the unworn contact of the same radius, which a flat punch has pressed deeper.
    c = np.asarray(whole.stick_radius(FRICTION * FORCE * phi, digits=5))
    deeper = whole.penetration(FRICTION * FORCE * phi, digits=5) - part.initial_displacement(0.0 * c, digits=5)
    slope = np.squeeze(np.diff(np.log(deeper * c), axis=0)) / (2.0 * 0.02)
    np.testing.assert_allclose(slope, coating.felt(thickness / np.mean(c, 0), 0.3), rtol=5e-5)


@pytest.mark.compiled
def test_a_measured_contact_with_alumina_and_glass():
    """Jitcharoen et al. 1998: radii of 0.3895 mm on the graded body and 0.3597 mm on alumina were measured."""
    depth = np.linspace(0.0, 1.0, 48) ** 3 * 5e-3
    graded = DepthGraded(depth, 1e9 * (254.0 + 85.3 * (depth / 1e-3) ** 0.497), 0.22)
    alumina, ball = PowerLawGraded(386e9, 1e-4, 0.0, 0.22), Elastic(614e9, 0.22)
    radii = [FrettingContact(body, 4.76e-3, 3000.0, 0.5, ball).contact_radius() for body in (graded, alumina)]
    np.testing.assert_allclose(radii, [0.374e-3, 0.350e-3], rtol=3e-3)


# --- derivatives, and what is refused ---------------------------------------------------------------------------------


def against_differences(contact, force, loose=0):
    """The first numbers, depths, move the ends of layers, whose errors are no smooth functions.

    The gradient of log(volume) by the logarithm of each number, and differences of fifth order."""
    leaves, structure = jax.tree.flatten((contact, force))
    sizes = [np.size(leaf) for leaf in leaves]
    leaves = [np.asarray(leaf, float) for leaf in leaves]

    def volume(logs):
        parts = jnp.split(logs, np.cumsum(sizes)[:-1])
        values = [leaf * jnp.exp(part.reshape(leaf.shape)) for leaf, part in zip(leaves, parts, strict=True)]
        contact, force = jax.tree.unflatten(structure, values)
        return jnp.log(contact.wear_volume(force))

    zero, step = np.zeros(sum(sizes)), 2e-3
    program = jax.jit(jax.grad(volume))
    values = jax.jit(lambda logs: jax.lax.map(volume, logs))
    eye = np.eye(zero.size) * step
    one, two = (values(jnp.asarray(np.concatenate([n * eye, -n * eye]))).reshape(2, -1) for n in (1.0, 2.0))
    differences = (8.0 * (one[0] - one[1]) - (two[0] - two[1])) / (12.0 * step)
    found = program(zero)
    np.testing.assert_allclose(found[loose:], differences[loose:], atol=2e-6)
    np.testing.assert_allclose(found[:loose], differences[:loose], atol=4e-5)


@pytest.mark.compiled
def test_derivatives_by_the_modulus_at_each_depth():
    coating = DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], [90e9, 150e9, 120e9, 210e9], 0.3)
    against_differences(contact_of(coating, STEEL), 1.5, loose=4)


@pytest.mark.long
@pytest.mark.parametrize("k", [-0.4, 0.4])
def test_derivatives_by_the_power_law(k):
    against_differences(contact_of(PowerLawGraded(110e9, 1e-4, k, 0.3), STEEL), 1.5)


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
        return jnp.log(contact_of(coating, Elastic(210e9 * jnp.exp(x[1]), 0.3)).wear_volume(1.5))

    at, step = np.array([0.3, 0.1]), 1e-3
    slope = jax.jit(jax.grad(volume))
    differences = [(slope(at + side) - slope(at - side)) / (2.0 * step) for side in step * np.eye(2)]
    found = np.asarray(jax.jit(jax.hessian(volume))(at))
    np.testing.assert_allclose(found, found.T, atol=1e-5)
    np.testing.assert_allclose(found, differences, atol=2e-5)


@pytest.mark.long
def test_derivatives_are_finite_where_there_is_no_gradient():
    slope = jax.grad(lambda contact: contact.wear_volume(1.5))(contact_of(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), STEEL))
    assert all(np.isfinite(leaf) for leaf in jax.tree.leaves(slope))


@pytest.mark.compiled
def test_a_thousand_contacts_in_one_call():
    moduli = np.linspace(0.5, 2.0, 1000)[:, None] * np.array([90e9, 150e9, 120e9, 210e9])
    many = contact_of(DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], moduli, 0.3), STEEL)
    volumes = np.asarray(many.wear_volume(1.5))
    one = contact_of(DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], moduli[617], 0.3), STEEL).wear_volume(1.5)
    assert volumes.shape == (1000,)
    np.testing.assert_allclose(volumes[617], one, rtol=1e-9)


@pytest.mark.compiled
def test_single_precision_keeps_three_digits():
    coating = DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], [90e9, 150e9, 120e9, 210e9], 0.3)
    single, double = (
        jax.tree.map(lambda x, dtype=dtype: jnp.asarray(x, dtype), (contact_of(coating, STEEL), 2.0))
        for dtype in (jnp.float32, jnp.float64)
    )
    for one, other in zip(steady_of(*single), steady_of(*double), strict=True):
        assert one.dtype == np.float32
        np.testing.assert_allclose(one, other, rtol=1e-3)


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
    with pytest.raises(ValueError, match="one modulus a layer"):
        DepthGraded.layers([1e-5], [1e11], 0.3)
    contact = contact_of(DepthGraded([0.0, 1e-5], [1e11, 2e11], 0.3), STEEL)
    with pytest.raises(ValueError, match="1 <= digits <= 5"):
        contact.wear_volume(1.0, digits=6)
    with pytest.raises(ValueError, match="gross"):
        contact.wear_volume(5.0)
    with pytest.raises(TypeError, match="takes an Elastic"):
        FrettingContact(contact.material, RADIUS, FORCE, FRICTION, "rigid")


def test_a_power_law_under_a_rigid_indenter_pays_nothing():
    program = (
        "import sys, plgwear_jax as p\n"
        "p.FrettingContact(p.PowerLawGraded(1e11, 1e-4, 0.2, 0.3), 5e-3, 10.0, 0.4).contact_radius()\n"
        "assert not [name for name in sys.modules if 'surfaces' in name or 'numeric' in name.partition('plgwear')[2]]\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
