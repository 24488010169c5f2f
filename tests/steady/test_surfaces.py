"""Elastic indenters, layers and any E(z): against the plane-strain equations, similarity and closed forms."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import surface_oracle
from functions import by_numpy
from kinds import FORCE, FRICTION, LAYERS, LIMIT, RADIUS, STEEL, contact_of, dome
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from processes import output
from refusals import cases, is_told, refusal
from scipy.interpolate import PchipInterpolator

import plgwear_jax
from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded, coating
from plgwear_jax.shapes import Cone, Parabola, TruncatedSphere
from plgwear_jax.shapes.shape import Outline
from plgwear_jax.special.pchip import pchip
from plgwear_jax.surfaces.any_modulus import through_springs
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.surfaces.half_space import excess_compliance
from plgwear_jax.surfaces.ring import DepthDeficit, deepest, ring_of

A = 1e-4  # about a contact radius
THICKNESS, MODULUS, NU, F_X = LAYERS.thickness, LAYERS.modulus, 0.3, 2.0
STEADY = ("contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume", "deepest_wear")


def every(contact):
    steady = contact.steady(F_X)
    return np.stack([getattr(steady, name) for name in STEADY])


# --- the compliance ---------------------------------------------------------------------------------------------------

Q = np.array([0.2, 1.0, 3.0, 12.0])  # in 1/m, of layers of 0.3 m and 0.7 m


def by_the_equations(modulus, depth, q=Q):
    """m(q) by the Riccati equation, which knows nothing of layers but where the modulus jumps."""
    return np.array([surface_oracle.excess(modulus, NU, depth[-1], list(depth), x) for x in q])


def equations_of_layers(thickness, modulus):
    below = np.cumsum(thickness)
    return by_the_equations(lambda z: modulus[np.searchsorted(below, z, "right")], below)


def of_layers(thickness, modulus):
    return excess_compliance(Layered.by_depth(thickness, modulus), jnp.asarray(NU), jnp.asarray(Q), 4)


by_layers, slopes_of_layers = by_numpy(of_layers), by_numpy(jax.jacfwd(of_layers, argnums=(0, 1)))


def by_differences(function, at, step=2e-3):
    """Of fifth order, by the logarithm of each number, along a last axis."""
    moves = [np.exp(step * row) for row in np.eye(at.size)]
    near = [function(at * move) - function(at / move) for move in moves]
    far = [function(at * move**2) - function(at / move**2) for move in moves]
    return (8.0 * np.stack(near, -1) - np.stack(far, -1)) / (12.0 * step)


def test_springs_act_between_cells_by_their_distance_and_so_do_their_slopes():
    @jax.jit
    def between(numbers):  # places of nodes, weights, integrals, what cells have there, and the strength of the springs
        table = numbers[-1] * jnp.exp(-jnp.exp(jnp.arange(-18.0, 6.125, 0.125)))  # by logarithms of distances
        (place, weight, whole), share = numbers[: 3 * count].reshape(3, -1), numbers[3 * count : -1].reshape(-1, count)
        return through_springs(table, whole, place, share, weight)

    count = 5
    place, size = 0.1 * np.arange(1.0, count + 1.0) ** 2, 0.13 * np.arange(1.0, count + 1.0)
    whole, share, x = 3.0 + place, np.cos(np.arange(3.0 * count)).reshape(3, -1), np.sqrt(1.0 + place)
    numbers = np.concatenate([place, size, whole, share.ravel(), [2.0]])
    itself = np.diag(0.5 * np.exp(-1.5) * size)  # of the mean of the logarithm, next to r = c
    kernel = 2.0 * np.exp(-abs(x[:, None] - x) - itself) + 2.0 * np.exp(-x[:, None] - x)
    expected = size[:, None] * kernel * size + np.diag(size * (whole - kernel @ size))
    assert_allclose(between(numbers), share @ expected @ share.T, rtol=1e-5, atol=1e-5)
    slopes = jax.jacfwd(between)(numbers) * numbers
    assert_allclose(slopes, by_differences(between, numbers, 1e-4), rtol=1e-6, atol=1e-9)


def test_the_compliance_and_its_slopes_are_those_of_the_equations():
    at = np.array([0.3, 0.7]), MODULUS / 1e9
    assert_allclose(by_layers(*at), equations_of_layers(*at), rtol=1e-7)
    by_thickness, by_modulus = slopes_of_layers(*at)
    assert_allclose(by_thickness * at[0], by_differences(lambda x: equations_of_layers(x, at[1]), at[0]), atol=1e-6)
    assert_allclose(by_modulus * at[1], by_differences(lambda x: equations_of_layers(at[0], x), at[1]), atol=1e-6)
    assert_allclose(by_modulus @ at[1], 0.0, atol=1e-12)  # m depends on ratios of moduli alone


@compiled
def test_second_derivatives_by_the_thicknesses_are_symmetric_and_those_of_differences():
    def slope(thickness):
        return jax.jacrev(of_layers)(thickness, MODULUS / 1e9) * thickness

    at = np.array([0.3, 0.7])
    found = jax.jacfwd(slope)(at) * at
    assert_allclose(found, by_differences(slope, at), atol=1e-8)
    assert_allclose(found, np.swapaxes(found, 1, 2), atol=1e-11)


@parametrize("factor, modulus", [(1e9, MODULUS[0]), (1e-9, MODULUS[-1])])
def test_very_thick_and_very_thin_layers_are_homogeneous(factor, modulus):
    """The surface's compliance over 2/q is that of the layer, or of the substrate."""
    thickness = factor * np.array([0.3, 0.7])
    assert_allclose((1.0 + by_layers(thickness, MODULUS)) / MODULUS[0], 1.0 / modulus, rtol=1e-6)
    assert np.isfinite(np.hstack(slopes_of_layers(thickness, MODULUS))).all()


STEEP = """\
0.041 0.053 0.06 0.081 0.09 0.139 0.141 0.172 0.21 0.212 0.251 0.31 0.665 0.936 1.041 1.412 1.607 1.671 6.859
268 38 149 58 44 93 91 107 36 233 243 82 28 46 144 55 64 29 86"""  # depths and moduli


def test_a_steep_table_has_the_compliance_of_the_equations():
    q, (depth, modulus) = np.array([0.12, 1.5, 6.0, 18.0]), np.loadtxt(STEEP.splitlines())
    cubic = PchipInterpolator(depth, modulus)
    exact = by_the_equations(lambda z: float(cubic(np.clip(z, depth[0], depth[-1]))), depth, q)
    table = pchip(jnp.asarray(depth), jnp.asarray(modulus))
    for digits, error in ((3, 3e-4), (4, 5e-5), (5, 5e-6)):
        found = by_numpy(lambda q, n=digits: excess_compliance(table, jnp.asarray(NU), q, n))(q)
        assert_allclose(1.0 + found, 1.0 + exact, rtol=error)
    single = jax.tree.map(jnp.float32, DepthGraded(1e-9 * depth, 1e9 * modulus, NU))
    assert_allclose(single.modulus_at(single.depth), single.modulus, rtol=1e-6)


# --- contacts ---------------------------------------------------------------------------------------------------------


def log_volume(contact, force):
    return jnp.log(contact.steady(force).wear_volume)


slopes_of = jax.grad(log_volume, argnums=(0, 1))  # by both in each test, so that they share a program


def test_slopes_of_the_wear_keep_the_similarity_of_contacts_and_are_those_of_differences():
    """Lengths times x and forces times x^2 give x^3 times the volume, moduli and forces times x the same volume."""
    contact = contact_of(LAYERS, STEEL)
    by, by_force = slopes_of(contact, F_X)
    lengths = by.material.thickness @ THICKNESS + by.radius * RADIUS
    forces = by.normal_force * FORCE + by_force * F_X
    moduli = by.material.modulus @ MODULUS + by.indenter.E * STEEL.E
    assert lengths + 2.0 * forces == pytest.approx(3.0, abs=2e-4)
    assert moduli + forces == pytest.approx(0.0, abs=1e-7)

    others = by_differences(
        lambda x: log_volume(dataclasses.replace(contact, material=Layered(x, MODULUS, NU)), F_X), THICKNESS
    )
    assert_allclose(by.material.thickness * THICKNESS, others, atol=2e-6)
    assert np.all(abs(by.material.thickness * THICKNESS) > 0.1)


def test_layers_are_a_table_with_jumps():
    at = np.cumsum(THICKNESS)
    table = DepthGraded(np.repeat(at, 2), np.repeat(MODULUS, 2)[1:-1], NU)
    depths = np.array([0.0, 1e-5, 2e-5, 3e-5, 5e-5, 1e-3, np.inf])
    assert_array_equal(LAYERS.modulus_at(depths), [50e9, 50e9, 300e9, 300e9, 100e9, 100e9, 100e9])
    assert_array_equal(LAYERS.modulus_at(depths), table.modulus_at(depths))
    assert_allclose(every(contact_of(LAYERS, STEEL)), every(contact_of(table, STEEL)), rtol=2e-6)


@parametrize(
    "layers",
    [compiled_case(Layered([], [110e9], NU)), Layered([1e-5, 3e-5], [110e9] * 3, NU)],
)
def test_one_modulus_is_a_homogeneous_half_space(layers):
    assert_allclose(every(contact_of(layers, STEEL)), every(contact_of(Elastic(110e9, NU), STEEL)), rtol=1e-5)
    material, alone = (slopes_of(contact_of(body, STEEL), F_X)[0].material for body in (layers, Elastic(110e9, NU)))
    assert_allclose(material.thickness * 1e-5, 0.0, atol=1e-9)
    assert material.thickness.shape == layers.thickness.shape
    assert_allclose(np.sum(material.modulus), alone.E, rtol=1e-4)
    assert_allclose(layers.modulus_at([0.0, 1e-5, 1.0]), 110e9)


def test_what_a_thin_layer_adds_is_in_proportion_to_its_thickness():
    """A layer of 1/20 and of 20 times the modulus: the volume is that of the substrate and a term in t."""
    closed, share = every(contact_of(Elastic(110e9, NU), STEEL))[:, None, None], np.array([1e-9, 1e-7, 1e-5])
    modulus = np.array([[5.5e9, 110e9], [2200e9, 110e9]])[:, None]
    found = every(contact_of(Layered(8e-5 * share[:, None], modulus, NU), STEEL)) / closed - 1.0
    volume = found[STEADY.index("wear_volume")]
    assert np.all(abs(found[..., 0]) < 2e-4) and np.all(abs(volume) < 100.0 * share + 5e-5)
    assert volume[0, -1] > 0.0 > volume[1, -1]


@compiled
def test_batches_of_layers_are_their_members():
    thickness, softer = np.array([[[1e-5, 3e-5]], [[2e-5, 4e-5]], [[5e-5, 1e-6]]]), np.array([1.0, 0.8])
    found = every(contact_of(Layered(thickness, softer[:, None] * MODULUS, NU), STEEL))
    assert found.shape == (len(STEADY), 3, 2)
    for i, j in ((0, 0), (1, 1), (2, 0)):
        one = Layered(thickness[i, 0], softer[j] * MODULUS, NU)
        assert_allclose(found[:, i, j], every(contact_of(one, STEEL)), rtol=1e-9)
    none = every(contact_of(Layered(np.zeros((2, 0)), np.array([[110e9], [220e9]]), NU)))
    assert_allclose(none[0, 0] / none[0, 1], 2.0 ** (1.0 / 3.0), rtol=1e-5)
    assert every(contact_of(Layered(np.zeros((0, 2)), MODULUS, NU))).shape == (len(STEADY), 0)


@compiled
def test_traced_layers_that_are_none_are_nan_and_so_are_their_slopes():
    def volume(thickness):
        return contact_of(Layered(thickness, MODULUS, NU), STEEL).steady(F_X).wear_volume

    bad = [1e-5, -1e-5], [0.0, 1e-5], [np.nan, 1e-5], [np.inf, 1e-5]
    values, slopes = jax.jit(jax.vmap(jax.value_and_grad(volume)))(np.stack([THICKNESS, *bad]))
    assert_allclose(values, [volume(THICKNESS), *[np.nan] * 4], rtol=1e-9)
    assert_allclose(slopes[0], jax.grad(volume)(THICKNESS), rtol=1e-6)
    assert np.all(np.isnan(slopes[1:]))


@parametrize(
    "contact",
    [
        compiled_case(contact_of(LAYERS, STEEL)),
        compiled_case(contact_of(Layered([1e-5], [3e11, 1e11], NU))),
        contact_of(DepthGraded([0.0, 1e-5, 4.7e-5, 5.1e-5, 8.6e-5], [150e9, 50e9, 570e9, 105e9, 76e9], 0.4), STEEL),
        contact_of(STEEL, None, Cone(0.01)),
    ],
)
@parametrize("within", [lambda slope: slope, compiled_case(jax.jit)])  # where numbers below 1e-38 count as 0
def test_slopes_by_the_half_space_in_single_precision(contact, within):
    slope = jax.grad(lambda contact, force: contact.steady(force).wear_volume)
    found = within(slope)(*jax.tree.map(jnp.float32, (contact, F_X))).material
    for one, known in zip(*map(jax.tree.leaves, (found, slope(contact, F_X).material)), strict=True):
        assert one.dtype == np.float32
        assert_allclose(one, known, rtol=2e-2, atol=2e-2 * np.max(abs(known)))


@parametrize(
    "contact, E, k, error",
    [
        (dome(0.4, STEEL), 110e9, 0.4, 1e-4),
        (dome(-0.4, STEEL), 110e9, -0.4, 1e-4),
        (contact_of(LAYERS, STEEL), 100e9, 0.0, 2e-3),
    ],
)
def test_displacements_far_beside_a_contact_are_those_of_a_concentrated_force(contact, E, k, error):
    steady = contact.steady(2.0)
    r = steady.contact_radius * np.array([100.0, 300.0, 1e5, 1e8])
    body = np.cos(0.5 * np.pi * k) / (E * plgwear_jax.material.h_N(k, 0.3)) * (1e-4 / r) ** k
    expected = FORCE * (1.0 - 0.3**2) / np.pi * (body + 1.0 / STEEL.E) / r
    assert_allclose(steady.initial_displacement(r), expected, rtol=error)
    assert_allclose(steady.steady_displacement(np.append(r, np.inf)), np.append(expected, 0.0), rtol=error)


# --- what is published ------------------------------------------------------------------------------------------------


@compiled
def test_a_layer_changes_the_stiffness_of_a_punch_as_published():
    """Gao, Chiu and Lee 1992: a flat punch on a layer, to first order in the change of its modulus."""
    thickness, step, phi = np.array([0.1, 0.3, 1.0, 3.0]) * A, np.array([[0.02], [-0.02]]), 0.5
    moduli = np.stack(np.broadcast_arrays(110e9 * np.exp(step), 110e9, thickness)[:2], -1)
    layer = Layered(thickness[:, None], moduli, 0.3)
    whole, part = contact_of(layer), contact_of(layer, force=FORCE * (1.0 - phi))
    # The steady state is the unworn contact of the same radius, which a flat punch has pressed deeper.
    worn = whole.steady(LIMIT * phi, digits=5)
    c = worn.stick_radius
    deeper = worn.penetration - part.steady(0.0, digits=5).initial_displacement(0.0 * c)
    slope = np.squeeze(np.diff(np.log(deeper * c), axis=0)) / (2.0 * 0.02)
    assert_allclose(slope, coating.felt(thickness / np.mean(c, 0), 0.3), rtol=5e-5)


@compiled
def test_a_measured_contact_with_alumina_and_glass():
    """Jitcharoen et al. 1998: radii of 0.3895 mm on the graded body and 0.3597 mm on alumina were measured."""
    depth = np.linspace(0.0, 1.0, 48) ** 3 * 5e-3
    graded = DepthGraded(depth, 1e9 * (254.0 + 85.3 * (depth / 1e-3) ** 0.497), 0.22)
    alumina, ball = PowerLawGraded(386e9, 1e-4, 0.0, 0.22), Elastic(614e9, 0.22)
    radii = [FrettingContact(body, 4.76e-3, 3000.0, 0.5, ball).steady(0.0).contact_radius for body in (graded, alumina)]
    assert_allclose(radii, [0.374e-3, 0.350e-3], rtol=3e-3)


# --- derivatives, and what is refused ---------------------------------------------------------------------------------


@compiled
def test_second_derivatives_of_a_batch():
    def volume(x):
        return log_volume(dome(x[0], Elastic(210e9 * jnp.exp(x[1]), 0.3)), 1.5 + at).sum()

    at, step = np.array([0.3, 0.1]), 1e-3
    slope = jax.jit(jax.grad(volume))
    differences = [(slope(at + side) - slope(at - side)) / (2.0 * step) for side in step * np.eye(2)]
    found = jax.jit(jax.hessian(volume))(at)
    assert_allclose(found, found.T, atol=1e-5)
    assert_allclose(found, differences, atol=2e-5)


def test_second_derivatives_of_rings_and_of_the_deepest_wear_know_that_places_move():
    a, end = jnp.asarray(0.4), jnp.asarray(0.9)
    image = Outline(Parabola(), jnp.asarray(RADIUS)).image(jnp.asarray(5e-5), a)

    def read(level):  # at fixed places depth and volume would be proportional to it
        left = DepthDeficit(level, image, None, a, effort_of(4))
        return jnp.stack([deepest(left, end), *ring_of(left)])

    less, at, more = map(by_numpy(read), jnp.array([0.28, 0.3, 0.32]))
    assert_allclose(
        by_numpy(jax.jacfwd(jax.jacfwd(read)))(jnp.asarray(0.3)), (less - 2.0 * at + more) / 0.02**2, rtol=1e-2
    )


@parametrize(
    "pair",
    [(dome(0.4, Elastic(1e17, NU)), dome(0.4)), (dome(0.0, STEEL), contact_of(Elastic(110e9, NU), STEEL))],
    ids=["nearly rigid", "homogeneous"],
)
def test_the_intensity_at_the_edge_is_that_of_closed_forms(pair):
    assert_allclose(*(contact.steady(F_X).edge_intensity for contact in pair), rtol=1e-5)


@compiled
def test_a_narrow_ring_beside_a_kink():
    """Its derivative is that of differences: the slope of what a kink adds is singular."""
    contact = dome(0.26, STEEL, TruncatedSphere(8.76e-5))

    def volume(log_force):
        return jnp.log(contact.steady(jnp.exp(log_force)).wear_volume)

    at = np.log(0.003 * LIMIT)
    difference = (volume(at + 1e-3) - volume(at - 1e-3)) / 2e-3
    assert_allclose(jax.grad(volume)(at), difference, rtol=1e-5)
    state = jax.eval_shape(lambda one: one.steady(jnp.float32(1.0))._solution, jax.tree.map(jnp.float32, contact))
    assert {x.dtype for x in jax.tree.leaves(state)} == {jnp.dtype("float32")}


@cases("steady/refused.toml", "record")
def test_what_is_refused(case):
    """Half-spaces, and shapes of indenters."""
    line = refusal((TypeError, ValueError), getattr(plgwear_jax, case["name"]), *case["fields"])
    assert is_told(line, case)


def test_an_indenter_that_is_none_is_refused():
    with pytest.raises(TypeError, match="takes an Elastic"):
        FrettingContact(LAYERS, RADIUS, FORCE, FRICTION, "rigid")


def test_closed_forms_pay_nothing_for_numerical_solutions():
    program = (
        "import sys, plgwear_jax as p\n"
        "p.FrettingContact(p.PowerLawGraded(1e11, 1e-4, 0.2, 0.3), 5e-3, 10.0, 0.4).steady(0.0).contact_radius\n"
        "assert not [name for name in sys.modules if 'surfaces' in name or 'numeric' in name.partition('plgwear')[2]]\n"
        "p.FrettingContact(p.Elastic(1e11, 0.3), 5e-3, 10.0, 0.4, p.Elastic(2e11, 0.3)).steady(2.0).wear_volume\n"
        "assert not {'plgwear_jax.steady.numeric'} & set(sys.modules)\n"
    )
    output("-c", program)
