"""Partial and gross slip over displacement amplitude and normal force."""

import dataclasses

import jax
import numpy as np
from kinds import FORCE, FRICTION, KINDS, RADIUS, dome
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose
from refusals import cases, refusal

from plgwear_jax import Elastic, GrossSlipContact, Profile
from plgwear_jax.contact import CRITERIA, regimes, slip_regimes
from plgwear_jax.loads import Displacement, Force

FORCES = np.array([1.0, 10.0, 60.0])
LIMIT = FRICTION * FORCES[:, None]
SHARES = np.array([0.01, 0.2, 0.7, 0.999, 1.0, 1.001, 1.5, 8.0])
RIGS = [None, 2e7]


def under(contact):
    return dataclasses.replace(contact, normal_force=FORCES[:, None])


@parametrize("rig", RIGS)
@parametrize("k", [compiled_case(-0.8), 0.0, 0.5])
def test_a_map_is_made_of_single_contacts(k, rig):
    contact = dome(k)
    whole = under(contact).steady(Force(0.0, rig)).gross_slip_displacement
    moves = np.sort((whole * SHARES).ravel())
    found = slip_regimes(contact, moves, FORCES, rig_stiffness=rig)
    assert_allclose(found.gross_slip_displacement, whole[:, 0], rtol=1e-14)
    assert_allclose(found.tangential_force[found.gross_slip], (LIMIT + 0.0 * moves)[found.gross_slip])
    inside, beyond = moves < 0.9999 * whole, moves > 1.0001 * whole
    state = under(contact).steady(Force(np.where(inside, found.tangential_force, 0.5 * LIMIT), rig))
    for name in ("energy_ratio", "loop_aperture"):
        assert_allclose(getattr(found, name)[inside], getattr(state, name)[inside], rtol=1e-12)
    assert_allclose(state.displacement_amplitude[inside], (moves + 0.0 * whole)[inside], rtol=1e-12)
    assert_allclose(found.energy_per_cycle[inside], state.energy_per_cycle[inside], rtol=1e-11)
    # Beyond the onset friction works along the whole way besides.
    onset = under(contact).steady(0.0).gross_slip_displacement
    sliding = 4.0 * LIMIT * ((1.0 + k) / (5.0 + k) * onset + moves - whole)
    assert_allclose(found.energy_per_cycle[beyond], sliding[beyond], rtol=1e-12)
    opened = (2.0 ** ((1.0 + k) / (3.0 + k)) - 1.0) * onset + moves - whole
    assert_allclose((found.loop_aperture * moves)[beyond], opened[beyond], rtol=1e-12)


@parametrize("rig", RIGS)
def test_nothing_jumps_at_the_onset(rig):
    onset = dome(0.9).steady(Force(0.0, rig)).gross_slip_displacement
    moves = onset * (1.0 + np.array([-1e-6, -2e-7, -1e-7, -1e-9, -1e-15, 0.0, 1e-9, 1e-6]))
    found = slip_regimes(dome(0.9), moves, [FORCE], rig_stiffness=rig)
    for name in ("energy_ratio", "loop_aperture", "tangential_force"):
        assert_allclose(np.diff(getattr(found, name)[0]), 0.0, atol=1e-5)
    assert_allclose(found.energy_ratio[0, 5], found.gross_slip_energy_ratio[0], rtol=1e-8)
    assert np.all(np.isfinite(found.energy_ratio)) and found.gross_slip[0, -1] and not found.gross_slip[0, 0]


@parametrize("indenter", [None, compiled_case(Elastic(210e9, 0.3))])
def test_no_displacement_needs_no_force(indenter):
    force = dome(np.array([0.2, 0.3]), indenter).steady(Displacement(0.0)).tangential_force
    assert str(np.asarray(force)) == "[0. 0.]"  # neither a rounding nor -0


@compiled
def test_a_rig_may_be_as_soft_as_can_be():
    load = Displacement(1e-7, 1e-300)
    assert_allclose(dome(0.2, Elastic(210e9, 0.3)).steady(load).tangential_force, 0.0, atol=1e-12)


@compiled
def test_a_table_of_heights_may_end_within_what_wears_close_to_gross_slip():
    r = np.linspace(0.0, 4e-4, 41)
    short = dome(0.0, shape=Profile(r, r * r / (2.0 * RADIUS)))
    found, expected = (slip_regimes(each, [2e-7, 1e-5], [1.0, 10.0]) for each in (short, dome(0.0)))
    assert_allclose(found.energy_ratio, expected.energy_ratio, rtol=1e-2)
    state = jax.jit(lambda force: [getattr(short.steady(force), name) for name in ("worn_radius", "energy_ratio")])
    assert np.isnan(state(0.99999 * LIMIT[1])[0]) and np.isfinite(state(0.99999 * LIMIT[1])[1])
    line = refusal(ValueError, slip_regimes, short, [1e-7], [1.0, 1e5])
    assert line.startswith("normal_force = 100000.0: before any wear the contact would have to pull, or reaches beyond")


@parametrize("rig", RIGS)
@parametrize("k", [-0.6, 0.3])
@parametrize("indenter", [None, compiled_case(Elastic(1e20, 0.3))])
def test_a_map_between_loops_is_that_of_the_closed_form(k, indenter, rig, monkeypatch):
    closed = dome(k)
    moves = closed.steady(Force(0.0, rig)).gross_slip_displacement * np.geomspace(0.011, 10.0, 61)
    expected = slip_regimes(closed, moves, FORCES, rig_stiffness=rig)
    monkeypatch.setattr(regimes, "is_closed", lambda _: False)
    found = slip_regimes(dome(k, indenter), moves, FORCES, rig_stiffness=rig)
    for field in dataclasses.fields(expected):
        assert_allclose(getattr(found, field.name), getattr(expected, field.name), rtol=2e-4, err_msg=field.name)


@parametrize("k", [compiled_case(-0.5), 0.0, 0.5])
def test_criteria_lie_where_the_map_has_their_value(k):
    contact = dome(k)
    onset = contact.steady(0.0).gross_slip_displacement
    found = slip_regimes(contact, onset * np.linspace(0.01, 2.0, 400), [FORCE])
    for name, level in CRITERIA.items():
        at = found.displacement_where(name, level)
        assert_allclose(getattr(slip_regimes(contact, at, [FORCE]), name)[0, 0], level, rtol=1e-4)
    shift = found.displacement_where("energy_ratio", 0.2)[0] / onset
    assert_allclose(shift, {-0.5: 10.0 / 9.0, 0.0: 1.0, 0.5: 0.868}[k], rtol=1e-3)
    assert np.isnan(found.displacement_where("energy_ratio", 1e-9)[0])


@cases("contact/refused.toml", "regimes")
def test_refusal(case):
    asked = KINDS["closed forms"], case["moves"], case["forces"]
    assert refusal(ValueError, slip_regimes, *asked, **case["more"]) == case["line"]


def test_a_punch_has_no_regimes():
    punch = GrossSlipContact(KINDS["closed forms"].material, 1e-3, 1e-6)
    assert refusal(TypeError, slip_regimes, punch, [1e-7], [1.0]).startswith("contact takes a FrettingContact, not ")
