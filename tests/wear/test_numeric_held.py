"""Held displacements, blocks and fits of contacts without a closed form: against closed forms, and in their limits."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import surface_oracle
import transient_oracle
from half_spaces import FORCE, FRICTION, STEEL, A, contact_of, graded_compliance
from test_numeric_cycles import COEFFICIENT, F_X, LASTING, LAYERS, SHARES

from plgwear_jax import DepthGraded, Elastic, FrettingContact, PowerLawGraded, contact
from plgwear_jax.fitting import fit_wear_coefficient
from plgwear_jax.steady.numeric import states_of
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.transient import grid
from plgwear_jax.wear.rings import ring_at, scales_of, widths

HELD = {"control": "displacement"}
RIG = 3e7
RIGID = contact_of(PowerLawGraded(110e9, 1e-4, -0.4, 0.3))
NEARLY = dataclasses.replace(RIGID, indenter=Elastic(1e20, 0.3))


@pytest.mark.compiled
@pytest.mark.parametrize("rig", [{}, {"rig_stiffness": RIG}])
def test_a_power_law_under_a_nearly_rigid_indenter_wears_as_the_closed_form(rig):
    held = HELD | rig
    cycles = np.asarray(RIGID.cycles_to(SHARES, F_X, COEFFICIENT, **held))
    numeric, closed = (contact.wear_over_cycles(each, F_X, COEFFICIENT, cycles, **held) for each in (NEARLY, RIGID))
    for field in ("volume", "contact_radius", "depth", "volume_per_cycle", "steady_volume", "steady_depth"):
        expected = getattr(closed, field)
        np.testing.assert_allclose(getattr(numeric, field), expected, atol=1e-5 * np.max(expected), err_msg=field)
    near = abs(closed.radii / closed.stick_radius - 1.0) < 0.03
    for field in ("pressure", "steady_pressure"):
        found, expected = getattr(numeric, field)[..., ~near], getattr(closed, field)[..., ~near]
        np.testing.assert_allclose(found, expected, rtol=1e-2, atol=1e-3 * np.max(expected), err_msg=field)
    np.testing.assert_allclose(contact.cycles_to_shares(NEARLY, F_X, COEFFICIENT, SHARES, **held), cycles, rtol=1e-4)


@pytest.mark.compiled
@pytest.mark.parametrize("held", [{}, HELD | {"rig_stiffness": RIG}])
def test_blocks_and_fits_are_those_of_the_closed_form(held):
    given = F_X * np.array([0.5, 1.0, 0.0, 0.75]), np.array([2e5, 4e5, 1e5, 3e5]), COEFFICIENT
    numeric, closed = (contact.wear_by_blocks(each, *given, **held) for each in (NEARLY, RIGID))
    for field in (field.name for field in dataclasses.fields(closed)):
        expected = getattr(closed, field)
        np.testing.assert_allclose(getattr(numeric, field), expected, atol=1e-5 * np.max(expected), err_msg=field)
    measured = closed.cycles, closed.volume * np.array([1.01, 0.99, 1.0, 1.02])
    fits = [fit_wear_coefficient(each, F_X, *measured, **held) for each in (NEARLY, RIGID)]
    assert fits[0].wear_coefficient == pytest.approx(fits[1].wear_coefficient, rel=1e-4)
    assert fits[0].interval == pytest.approx(fits[1].interval, rel=1e-4)
    assert fits[0].steady_volume == pytest.approx(fits[1].steady_volume, rel=1e-4)


@pytest.mark.compiled
def test_layers_under_steel_at_a_held_displacement():
    layered = contact_of(LAYERS, STEEL)
    end = float(layered.wear_volume(F_X))
    cycles = np.asarray(layered.cycles_to(SHARES, F_X, COEFFICIENT))
    forces, rigs = np.array([F_X, 0.0])[:, None, None], np.array([1e20, 1e7, 1.0])[:, None]
    worn = np.asarray(layered.wear_volume(forces, cycles=cycles, rig_stiffness=rigs, **HELD, **LASTING)) / end
    np.testing.assert_array_equal(worn[1], 0.0)
    np.testing.assert_allclose(worn[0, :, 0], SHARES[0], rtol=0.02)  # the first cycles know nothing of it
    np.testing.assert_allclose(worn[0, 2], SHARES, atol=1e-2)  # a compliant rig holds the force
    assert np.all(worn[0, :-1, -1] < worn[0, 1:, -1])  # the stiffer the rig, the less is worn


@pytest.mark.long
def test_layers_wear_as_rings_at_a_held_displacement():
    moduli, interfaces = np.array([50e9, 300e9, 100e9]), np.array([0.3, 1.0]) * A
    compliance = graded_compliance(
        lambda z: moduli[np.searchsorted(interfaces, z, "right")], 0.25, interfaces[-1], list(interfaces), STEEL
    )
    steady = surface_oracle.steady(compliance, A, 0.6 * A)
    layers = DepthGraded.layers(np.diff(interfaces, prepend=0.0), moduli, 0.25)
    one = FrettingContact(layers, 1.0, steady.force, 0.5, STEEL)
    F_x = 0.5 * steady.force * steady.phi
    mu_theta = float(one.gross_slip_displacement() / one.penetration(0.0))
    last = float(one.cycles_to(0.999, F_x, COEFFICIENT))
    cycles = last * np.expm1(4.0 * np.linspace(0.0, 1.0, 161)) / np.expm1(4.0)
    n = 4.0 * COEFFICIENT * mu_theta * steady.force / (np.pi * A**2) * cycles
    moved = float(one.displacement_amplitude(F_x)) / mu_theta / A**2
    first = float(one.penetration(0.0)) / A**2
    rings = surface_oracle.Wearing(compliance, A, 0.6 * A, steady, 120)
    worn, _ = transient_oracle.rings_at_held_displacement(rings, first, moved, n)
    at = slice(20, None, 20)
    found = np.asarray(one.wear_volume(F_x, cycles=cycles[at], **HELD, **LASTING))
    np.testing.assert_allclose(found / steady.volume, A**4 * worn[at] / steady.volume, atol=1.6e-2)
    assert found[-1] < 0.99 * steady.volume


@pytest.mark.long
def test_derivatives_are_those_of_differences():
    body = PowerLawGraded(110e9, 1e-4, 0.3, 0.3)
    given = contact_of(body, STEEL), F_X, 2e5, COEFFICIENT, RIG
    leaves, structure = jax.tree.flatten(jax.tree.map(lambda x: jnp.asarray(x, float), given))

    def volume(*leaves):
        one, F_x, cycles, K, rig = jax.tree.unflatten(structure, leaves)
        return jnp.log(one.wear_volume(F_x, cycles=cycles, wear_coefficient=K, rig_stiffness=rig, **HELD))

    slopes = jax.jit(jax.grad(volume, argnums=tuple(range(len(leaves)))))(*leaves)
    value = jax.jit(volume)
    for i, (leaf, slope) in enumerate(zip(leaves, slopes, strict=True)):
        ahead, behind = (float(value(*leaves[:i], leaf * (1.0 + step), *leaves[i + 1 :])) for step in (3e-3, -3e-3))
        # The stick edge moves by whole cells, which differences see.
        assert float(slope * leaf) == pytest.approx((ahead - behind) / 6e-3, abs=2e-3), i


@pytest.mark.compiled
def test_outside_of_partial_slip_it_is_nan_under_jit():
    layered = contact_of(LAYERS, STEEL)
    forces = jnp.array([F_X, 2.0 * FRICTION * FORCE, 0.0, 0.5 * F_X])
    r = 0.9 * float(layered.contact_radius())

    @jax.jit
    def fields(forces):
        lasting = {"cycles": 1e5, **HELD, **LASTING}
        names = layered.wear_depth, layered.pressure
        return jnp.stack([layered.wear_volume(forces, **lasting), *(field(r, forces, **lasting) for field in names)])

    found = np.asarray(fields(forces))
    assert np.all(np.isnan(found) == np.array([False, True, False, False]))
    assert found[0, 2] == 0.0 and found[2, 2] == pytest.approx(float(layered.initial_pressure(r)))


@pytest.mark.compiled
@pytest.mark.parametrize("phi", [0.3, 0.9])
def test_the_ring_answers_to_its_first_pressure_next_to_the_stick_edge(phi):
    """The cells of A p_0 = H: in too coarse cells inside c the ones next to c would have pressures of any size."""
    one = contact_of(PowerLawGraded(110e9, 1e-4, -0.8, 0.3), STEEL)
    steps, effort = grid.EFFORTS[5], effort_of(None)
    state = states_of(one, phi * FRICTION * FORCE, None)
    unit = scales_of(effort, state).unit
    ring = jax.jit(
        lambda state: ring_at(effort, state, unit, tuple(x[0] for x in grid.edges_of(*widths(state), steps)))
    )
    cells, count = ring(state), steps.inner * steps.multiples[0]
    pressure = np.linalg.solve(np.asarray(cells.compliance)[:count, :count], np.asarray(cells.steady)[:count])
    np.testing.assert_allclose((pressure / np.asarray(cells.first)[:count])[: count // 2], 1.0, rtol=0.04)


@pytest.mark.compiled
def test_the_pressure_in_the_middle_is_that_of_the_closed_form():
    force, r = 0.9 * FRICTION * FORCE, float(RIGID.contact_radius()) * np.array([0.0, 0.1, 0.2])[:, None]
    cycles = np.asarray(RIGID.cycles_to(SHARES, force, COEFFICIENT))
    found, expected = (np.asarray(each.pressure(r, force, cycles=cycles, **LASTING)) for each in (NEARLY, RIGID))
    np.testing.assert_allclose(found, expected, rtol=0.02)


@pytest.mark.parametrize(
    "given, what",
    [
        (HELD | {"digits": 3}, "digits = 3 is outside the allowed range 1 <= digits <= 2 of wear at a held displ"),
        (HELD | {"rig_stiffness": -1.0}, "rig_stiffness = -1.0 is outside the allowed range"),
        ({"control": "speed"}, "control = 'speed' is neither 'force' nor 'displacement'"),
    ],
)
def test_bad_input_is_refused(given, what):
    with pytest.raises(ValueError, match=what):
        contact_of(LAYERS, STEEL).wear_volume(F_X, cycles=1e4, **LASTING, **given)
    with pytest.raises(ValueError, match="take one number a block"):
        contact.wear_by_blocks(contact_of(LAYERS, STEEL), [1.0, 2.0], [1.0], COEFFICIENT)
