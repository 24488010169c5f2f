"""Every quantity of contacts without closed forms, and its first derivative.

The numbers are those of rings of constant pressure, which share nothing with the library (`ring_contacts`).
"""

import functools

import jax
import jax.numpy as jnp
import kinds
import numpy as np
import pytest
import ring_contacts
from balance import sums
from functions import by_numpy
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose
from ring_contacts import BESIDE, COEFFICIENT, FRICTION, KINDS, RADII, RIG, A

from plgwear_jax import FrettingContact, PowerLawGraded
from plgwear_jax.loads import Block, Displacement, Force

RECORDED = ring_contacts.recorded()


@functools.cache
def asked(kind):
    known = RECORDED[kind]
    return KINDS[kind].contact(known["normal_force"]), known["tangential_force"], known


def scalars(steady):
    found = {name: getattr(steady, name) for name in RECORDED["a table"]["steady"] if name != "contact_share"}
    return found | {"contact_share": share_of(steady), "edge_pressure": steady.edge_pressure(1e-9)}


def share_of(steady):
    """The share of the contact in the displacement at the actuator of a rig, by which its energy ratio falls."""
    return steady.contact.steady(Force(steady.tangential_force, RIG)).energy_ratio / steady.energy_ratio


def places(known):
    """Where fields are recorded."""
    c, outer = (known["steady"][name] for name in ("stick_radius", "worn_radius"))
    inside = dict.fromkeys(("initial_pressure", "pressure", "traction"), RADII * A)
    beside = {"wear_depth": c + BESIDE * (outer - c), "slip_amplitude": c + BESIDE * (A - c)}
    return inside | beside | {"initial_displacement": A * np.array([0.5, 1.5, 3.0])}


@parametrize("kind", [compiled_case(kind) if kind == "a shape" else kind for kind in KINDS])
def test_steady_states_are_those_of_rings(kind):
    contact, force, known = asked(kind)
    steady = contact.steady(force)
    # Rings know less of a thin layer, and both less of pressures below a surface that is stiff there.
    most, of_fields = 3e-3 if "depth" in kind else 3e-4, 1e-2 if "stiff" in kind else 5e-4
    found, c = scalars(steady), known["steady"]["stick_radius"]
    for name, expected in known["steady"].items():
        assert_allclose(found[name], expected, rtol=most, err_msg=name)
    if "edge_intensity" in known["steady"]:
        assert_allclose(found["edge_pressure"], found["edge_intensity"] * (2e-9 / c) ** -0.5, rtol=1e-2)
    assert_allclose(steady.edge_pressure(0.2 * c), steady.pressure(steady.stick_radius - 0.2 * c), rtol=1e-9)
    for name, r in places(known).items():
        assert_allclose(getattr(steady, name)(r), known["fields"][name], rtol=of_fields, err_msg=name)
    touching = steady.worn_radius * np.array([0.0, 0.5, 0.98])
    assert_allclose(steady.steady_displacement(touching) + steady.profile(touching), steady.penetration, rtol=1e-7)


@compiled
@parametrize("kind", [kind for kind in KINDS if "depth" not in kind])
def test_five_digits_of_a_steady_state_are_those_of_rings(kind):
    contact, force, known = asked(kind)
    steady = contact.steady(force, digits=5)
    for name in ("contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume"):
        assert_allclose(getattr(steady, name), known["steady"][name], rtol=2e-5, err_msg=name)


@parametrize("kind", KINDS)
def test_runs_are_those_of_rings(kind):
    contact, force, known = asked(kind)
    run, cycles = contact.over_cycles(force, COEFFICIENT), np.array(known["cycles"])
    assert_allclose(run.volume(cycles), known["volumes"], rtol=5e-4)


def test_a_held_displacement_is_that_of_rings():
    contact, force, known = asked("layers under steel")
    held = Displacement(known["steady"]["displacement_amplitude"])
    assert_allclose(contact.steady(held).tangential_force, force, rtol=3e-4)
    run = contact.over_cycles(held, COEFFICIENT)
    assert_allclose(run.volume(np.array(known["cycles"])), known["held"], rtol=1e-2)


@parametrize("kind", ["layers under steel", "a power law under steel"])
def test_small_amplitudes_follow_their_limits(kind):
    """Where displacements would cancel, limits stand in: the stiffness does not change, loops open as the amplitude."""
    contact, _, known = asked(kind)
    few, more = (contact.steady(phi * FRICTION * known["normal_force"]) for phi in (5e-4, 2e-3))
    assert_allclose(share_of(few), share_of(more), rtol=1e-3)
    for name in ("loop_aperture", "energy_ratio", "displacement_amplitude"):
        assert_allclose(4.0 * getattr(few, name), getattr(more, name), rtol=3e-3, err_msg=name)


@compiled
@pytest.mark.filterwarnings("ignore:radius = 1")  # the radius of 1 moves too, beyond what is doubted
@parametrize("kind", ["layers under steel", "a table", "a power law under steel", "a shape"])
def test_derivatives_are_those_of_differences(kind, seed):
    """All numbers of a contact and its load move at the same time; where they are equal, such as interfaces, alike."""
    contact, force, known = asked(kind)
    random = np.random.default_rng(seed)

    def direction(leaf):
        numbers, place = np.unique(leaf, return_inverse=True)
        ways = random.uniform(0.5, 1.0, numbers.size) * random.choice([-1.0, 1.0], numbers.size)
        return np.reshape(ways[place], np.shape(leaf))

    given = contact, force
    along = jax.tree.map(direction, given)

    def logs(step):
        contact, force = jax.tree.map(lambda x, way: x * (1.0 + step * way), given, along)
        found = scalars(contact.steady(force))
        if kind != "a shape":
            found["volume"] = contact.over_cycles(force, COEFFICIENT, digits=2).volume(np.array(known["cycles"]))
        return {name: jnp.log(x) for name, x in found.items()}

    # NumPy computes what is traced: XLA would need seconds to compile it.
    _, slopes = by_numpy(lambda step: jax.jvp(logs, (step,), (jnp.ones_like(step),)))(jnp.asarray(0.0))
    ahead, behind = logs(1e-3), logs(-1e-3)
    for name, slope in slopes.items():
        assert_allclose(slope, (ahead[name] - behind[name]) / 2e-3, rtol=1e-3, atol=1e-3, err_msg=name)


# --- over cycles ------------------------------------------------------------------------------------------------------

CLOSED, WEARS = kinds.KINDS["closed forms"], np.array([6e4, 2e5, 4e5])  # cycles: from a tenth or more to most is worn
# The load, and how far the slope of the volume may be from the rate.
LOADS = {
    "closed forms": (2.0, 1e-4),
    "layers under steel": (None, 1e-4),  # what is recorded
    "a power law under steel": (None, 1e-4),
    "a held displacement": (Displacement(2e-7), 0.06),
    "gross slip": (Displacement(2e-6), 0.06),
    "a block": ([Block(2.0, 1e6)], 0.06),
}


@parametrize("name", LOADS)
def test_the_fields_of_a_run_balance_its_numbers(name):
    """Pressures carry the normal force, depths add up to the volume, and friction wears off the rate."""
    contact, (load, most), cycles = CLOSED, LOADS[name], WEARS[:, None]
    if load is None:
        contact, load, known = asked(name)
        cycles = np.array(known["cycles"])[:, None]
    run = contact.over_cycles(load, COEFFICIENT)
    volume, rate = np.asarray(run.volume(cycles)), np.asarray(run.rate(cycles))
    pressed, worn = sums(run, cycles)
    assert_allclose(pressed, contact.normal_force, rtol=5e-3)
    assert_allclose(worn, volume[:, 0], rtol=5e-3)
    if run.load.holds_force:  # where the sum knows more digits of the pressures, so that errors of either sign show
        assert np.all(abs(pressed / contact.normal_force - 1.0) < np.array([3e-4, 2e-3, 5e-3]))
    assert_allclose(rate * contact.friction, COEFFICIENT * run.energy_per_cycle(cycles), rtol=1e-12)
    slope = (np.asarray(run.volume(1.001 * cycles)) - np.asarray(run.volume(0.999 * cycles))) / (0.002 * cycles)
    assert_allclose(slope, rate, rtol=most)
    r = np.linspace(0.0, 1.2, 7) * np.asarray(run.contact_radius(cycles))
    unworn = run.profile(r, cycles) - run.depth(r, cycles)
    assert_allclose(unworn, r**2 / (2.0 * contact.radius), rtol=1e-9, atol=1e-18)


@compiled
def test_pressures_of_five_digits_carry_the_normal_force():
    """Until they become singular at the stick-slip boundary, where the sum knows less of them."""
    pressed, _ = sums(CLOSED.over_cycles(2.0, COEFFICIENT, digits=5), WEARS[:2, None])
    assert_allclose(pressed, CLOSED.normal_force, rtol=5e-4)


def test_before_wear_closed_forms_carry_the_force_and_follow_the_indenter():
    steady = FrettingContact(PowerLawGraded(1e11, 1e-4, 0.2, 0.3), 5e-3, 10.0, 0.4).steady(0.0)
    a = steady.contact_radius
    assert_allclose(steady.initial_pressure(0.0), 1.6 * 10.0 / (np.pi * a * a), rtol=1e-13)  # (3 + k)/2 of the mean
    risen = steady.initial_displacement(0.0) - steady.initial_displacement(a)
    assert_allclose(risen, 0.5 * a * a / 5e-3, rtol=1e-12)
