"""Layers on a substrate: against the plane-strain equations, similarity, and tables with jumps."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import surface_oracle
from kinds import COEFFICIENT, FORCE, FRICTION, RADIUS, STEEL, contact_of

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered
from plgwear_jax.surfaces.half_space import excess_compliance

THICKNESS, MODULUS, NU, F_X = np.array([2e-5, 3e-5]), np.array([50e9, 300e9, 100e9]), 0.3, 2.0
LAYERS = Layered(THICKNESS, MODULUS, NU)
STEADY = ("contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume", "deepest_wear")


def every(contact):
    steady = contact.steady(F_X)
    return np.stack([getattr(steady, name) for name in STEADY])


# --- the compliance ---------------------------------------------------------------------------------------------------

Q = np.array([0.2, 1.0, 3.0, 12.0])  # in 1/m, of layers of 0.3 m and 0.7 m


def by_the_equations(thickness, modulus):
    """m(q) by the Riccati equation, which knows nothing of layers but where the modulus jumps."""
    below = np.cumsum(thickness)
    return np.array(
        [
            surface_oracle.excess(
                lambda z: modulus[np.searchsorted(below, z, "right")], NU, below[-1], list(below), float(q)
            )
            for q in Q
        ]
    )


def by_layers(thickness, modulus):
    return excess_compliance(Layered.by_depth(thickness, modulus), jnp.asarray(NU), jnp.asarray(Q), 4)


def by_differences(function, at, step=2e-3):
    """Of fifth order, by the logarithm of each number, along a last axis."""
    moves = [np.exp(step * row) for row in np.eye(at.size)]
    near = [function(at * move) - function(at / move) for move in moves]
    far = [function(at * move**2) - function(at / move**2) for move in moves]
    return (8.0 * np.stack(near, -1) - np.stack(far, -1)) / (12.0 * step)


def test_the_compliance_and_its_slopes_are_those_of_the_equations():
    at = np.array([0.3, 0.7]), MODULUS / 1e9
    np.testing.assert_allclose(by_layers(*at), by_the_equations(*at), rtol=1e-7)
    by_thickness, by_modulus = jax.jacfwd(by_layers, argnums=(0, 1))(*at)
    equations = by_differences(lambda thickness: by_the_equations(thickness, at[1]), at[0])
    np.testing.assert_allclose(by_thickness * at[0], equations, atol=1e-6)
    equations = by_differences(lambda modulus: by_the_equations(at[0], modulus), at[1])
    np.testing.assert_allclose(by_modulus * at[1], equations, atol=1e-6)
    np.testing.assert_allclose(by_modulus @ at[1], 0.0, atol=1e-12)  # m depends on ratios of moduli alone


@pytest.mark.compiled
def test_second_derivatives_by_the_thicknesses_are_symmetric_and_those_of_differences():
    def slope(thickness):
        return jax.jacrev(by_layers)(thickness, MODULUS / 1e9) * thickness

    at = np.array([0.3, 0.7])
    found = np.asarray(jax.jacfwd(slope)(at)) * at
    np.testing.assert_allclose(found, by_differences(slope, at), atol=1e-8)
    np.testing.assert_allclose(found, np.swapaxes(found, 1, 2), atol=1e-11)


@pytest.mark.parametrize("factor, modulus", [(1e9, MODULUS[0]), (1e-9, MODULUS[-1])])
def test_very_thick_and_very_thin_layers_are_homogeneous(factor, modulus):
    """The surface's compliance over 2/q is that of the layer, or of the substrate."""
    found = (1.0 + by_layers(factor * np.array([0.3, 0.7]), MODULUS)) / MODULUS[0]
    np.testing.assert_allclose(found, 1.0 / modulus, rtol=1e-6)
    slopes = jax.jacfwd(by_layers)(factor * np.array([0.3, 0.7]), MODULUS)
    assert np.all(np.isfinite(slopes))


# --- contacts ---------------------------------------------------------------------------------------------------------


def test_slopes_of_the_wear_keep_the_similarity_of_contacts_and_are_those_of_differences():
    """Lengths times x and forces times x^2 give x^3 times the volume, moduli and forces times x the same volume."""

    def log_volume(contact, force):
        return jnp.log(contact.steady(force).wear_volume)

    contact = contact_of(LAYERS, STEEL)
    by, by_force = jax.grad(log_volume, argnums=(0, 1))(contact, F_X)
    lengths = by.material.thickness @ THICKNESS + by.radius * RADIUS
    forces = by.normal_force * FORCE + by_force * F_X
    moduli = by.material.modulus @ MODULUS + by.indenter.E * STEEL.E
    assert lengths + 2.0 * forces == pytest.approx(3.0, abs=2e-4)
    assert moduli + forces == pytest.approx(0.0, abs=1e-7)

    def of_thickness(thickness):
        return log_volume(dataclasses.replace(contact, material=Layered(thickness, MODULUS, NU)), F_X)

    np.testing.assert_allclose(by.material.thickness * THICKNESS, by_differences(of_thickness, THICKNESS), atol=2e-6)
    assert np.all(abs(by.material.thickness * THICKNESS) > 0.1)


def test_layers_are_a_table_with_jumps():
    at = np.cumsum(THICKNESS)
    table = DepthGraded(np.repeat(at, 2), np.repeat(MODULUS, 2)[1:-1], NU)
    depths = np.array([0.0, 1e-5, 2e-5, 3e-5, 5e-5, 1e-3, np.inf])
    np.testing.assert_array_equal(LAYERS.modulus_at(depths), [50e9, 50e9, 300e9, 300e9, 100e9, 100e9, 100e9])
    np.testing.assert_array_equal(LAYERS.modulus_at(depths), table.modulus_at(depths))
    np.testing.assert_allclose(every(contact_of(LAYERS, STEEL)), every(contact_of(table, STEEL)), rtol=2e-6)


@pytest.mark.parametrize(
    "layers",
    [pytest.param(Layered([], [110e9], NU), marks=pytest.mark.compiled), Layered([1e-5, 3e-5], [110e9] * 3, NU)],
)
def test_one_modulus_is_a_homogeneous_half_space(layers):
    closed = every(contact_of(Elastic(110e9, NU), STEEL))
    np.testing.assert_allclose(every(contact_of(layers, STEEL)), closed, rtol=1e-5)
    slope = jax.grad(lambda contact: jnp.log(contact.steady(F_X).wear_volume))
    material = slope(contact_of(layers, STEEL)).material
    alone = slope(contact_of(Elastic(110e9, NU), STEEL)).material
    np.testing.assert_allclose(material.thickness * 1e-5, 0.0, atol=1e-9)
    assert material.thickness.shape == layers.thickness.shape
    np.testing.assert_allclose(np.sum(material.modulus), alone.E, rtol=1e-4)
    np.testing.assert_allclose(layers.modulus_at([0.0, 1e-5, 1.0]), 110e9)


def test_a_layer_that_is_too_thin_to_be_resolved_is_the_substrate():
    thickness, modulus = np.array([1e-13, 1e-14])[:, None], np.stack([[11e9, 1100e9], [110e9, 110e9]], -1)[:, None]
    closed = every(contact_of(Elastic(110e9, NU), STEEL))[:, None, None]
    found = every(contact_of(Layered(thickness, modulus, NU), STEEL))
    np.testing.assert_allclose(found / closed, 1.0, rtol=2e-4)


@pytest.mark.parametrize("thickness", [1e-7, 1e-5])  # over the radius of the contact
def test_what_a_thin_layer_adds_is_in_proportion_to_its_thickness(thickness):
    """A layer of 1/20 and of 20 times the modulus: the volume is that of the substrate and a term in t."""
    closed = contact_of(Elastic(110e9, NU), STEEL).steady(F_X).wear_volume
    layers = Layered(np.full((2, 1), 8e-5 * thickness), np.array([[5.5e9, 110e9], [2200e9, 110e9]]), NU)
    found = contact_of(layers, STEEL).steady(F_X).wear_volume / closed - 1.0
    np.testing.assert_array_less(abs(found), 100.0 * thickness + 5e-5)
    assert thickness < 1e-6 or (found[0] > 0.0 > found[1])


def test_batches_of_layers_are_their_members():
    thickness, softer = np.array([[[1e-5, 3e-5]], [[2e-5, 4e-5]], [[5e-5, 1e-6]]]), np.array([1.0, 0.8])
    several = Layered(thickness, softer[:, None] * MODULUS, NU)
    found = every(contact_of(several, STEEL))
    assert found.shape == (len(STEADY), 3, 2)
    for i, j in ((0, 0), (1, 1), (2, 0)):
        one = Layered(thickness[i, 0], softer[j] * MODULUS, NU)
        np.testing.assert_allclose(found[:, i, j], every(contact_of(one, STEEL)), rtol=1e-9)
    none = every(contact_of(Layered(np.zeros((2, 0)), np.array([[110e9], [220e9]]), NU)))
    np.testing.assert_allclose(none[0, 0] / none[0, 1], 2.0 ** (1.0 / 3.0), rtol=1e-5)
    assert every(contact_of(Layered(np.zeros((0, 2)), MODULUS, NU))).shape == (len(STEADY), 0)


@pytest.mark.compiled
def test_under_jit_and_vmap_and_in_single_precision():
    def volume(thickness, modulus):
        return contact_of(Layered(thickness, modulus, NU), STEEL).steady(F_X).wear_volume

    known = volume(THICKNESS, MODULUS)
    np.testing.assert_allclose(jax.jit(volume)(THICKNESS, MODULUS), known, rtol=1e-9)
    several = jax.jit(jax.vmap(jax.value_and_grad(volume), (0, None)))
    values, slopes = several(np.stack([THICKNESS, [1e-5, -1e-5], [0.0, 1e-5], [np.nan, 1e-5], [np.inf, 1e-5]]), MODULUS)
    np.testing.assert_allclose(values, [known, *[np.nan] * 4], rtol=1e-9)
    np.testing.assert_allclose(slopes[0], jax.grad(volume)(THICKNESS, MODULUS), rtol=1e-6)
    assert np.all(np.isnan(slopes[1:]))
    whole = contact_of(LAYERS, STEEL), F_X
    single = jax.value_and_grad(lambda contact, force: contact.steady(force).wear_volume)(
        *jax.tree.map(jnp.float32, whole)
    )
    assert single[0].dtype == single[1].material.thickness.dtype == np.float32
    np.testing.assert_allclose(single[0], known, rtol=5e-3)
    np.testing.assert_allclose(single[1].material.thickness, slopes[0], rtol=2e-2)


@pytest.mark.compiled
def test_a_list_of_traced_numbers_is_an_array():
    def radius(thickness):
        return contact_of(Layered([thickness, 3e-5], MODULUS, NU), STEEL).steady(0.0).contact_radius

    slope = jax.grad(lambda layers: contact_of(layers, STEEL).steady(0.0).contact_radius)(LAYERS).thickness[0]
    np.testing.assert_allclose(jax.grad(radius)(2e-5), slope, rtol=1e-12)


@pytest.mark.compiled
def test_wear_over_cycles_has_slopes_by_the_thicknesses():
    def volume(thickness):
        contact = FrettingContact(Layered(thickness, MODULUS, NU), RADIUS, FORCE, FRICTION, STEEL)
        return jnp.log(contact.over_cycles(F_X, COEFFICIENT, digits=2).volume(2e5))

    slope = jax.grad(volume)(THICKNESS) * THICKNESS
    np.testing.assert_allclose(slope, by_differences(volume, THICKNESS), atol=1e-4)
