"""Objects that are solved once and then read: what `contact.steady` and `contact.over_cycles` promise to JAX."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from functions import by_numpy
from jax import export
from kinds import COEFFICIENT, FRICTION, KINDS, STEEL, contact_of
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose

from plgwear_jax import DepthGraded, Elastic, Layered, PowerLawGraded, loads
from plgwear_jax.contact import is_closed
from plgwear_jax.steady import numeric
from plgwear_jax.steady.closed import Steady

F_X, CYCLES = 1.5, 1e5
RADII = np.array([0.0, 3e-5, 7e-5])
CLOSED, LAYERED = KINDS["closed forms"], KINDS["layers under steel"]
each_engine = parametrize("contact", [CLOSED, LAYERED], ids=["closed forms", "numeric"])


@pytest.fixture
def solved(monkeypatch):
    """How often a state was solved."""
    count, solve = [], numeric.states_of

    def counted(*given):
        count.append(given)
        return solve(*given)

    monkeypatch.setattr(numeric, "states_of", counted)
    return count


def test_a_numerical_contact_is_solved_by_the_first_that_reads_it_and_then_no_more(solved):
    steady = LAYERED.steady(F_X)
    assert not solved
    for read in (lambda: steady.wear_volume, lambda: steady.pressure(RADII), lambda: steady.energy_per_cycle):
        read()
    assert len(solved) == 1
    pickle.loads(pickle.dumps(steady)).deepest_wear
    jax.jit(lambda steady: steady.worn_radius)(steady)
    assert len(solved) == 1


ASKED = {
    "steady": lambda contact, force: contact.steady(force),
    "run": lambda contact, force: contact.over_cycles(force, COEFFICIENT),
    "march": lambda contact, force: contact.over_cycles(loads.Displacement(2e-7 * force), COEFFICIENT),
}


@parametrize(
    "contact, asked, same",
    [
        compiled_case(CLOSED, "steady", 1e-9),
        (LAYERED, "steady", 1e-9),  # searches for radii end at a step of 1e-10
        (CLOSED, "run", 1e-10),
        compiled_case(LAYERED, "run", 1e-9),
        compiled_case(CLOSED, "march", 1e-10),
    ],
    ids=["closed forms", "numeric", "a run", "a numeric run", "a march"],
)
def test_solutions_are_pytrees(contact, asked, same):
    def read(solution):
        if asked == "steady":
            return jnp.stack([solution.wear_volume, solution.pressure(1e-5), solution.stick_radius])
        return jnp.stack([solution.volume(CYCLES), solution.contact_radius(CYCLES)])

    ask = ASKED[asked]
    one = ask(contact, F_X)
    expected = read(one)
    # What leaves `jit` and `vmap`, as a batch and as one of its members
    several = jax.jit(jax.vmap(ask, (None, 0)))(contact, jnp.array([F_X, 1.0]))
    first, most = jax.tree.map(lambda x: x[0], several), max(same, 1e-5 * (asked == "march"))
    assert_allclose(jax.vmap(read)(several)[0], expected, rtol=most)
    for each, error in (one, same), (pickle.loads(pickle.dumps(one)), same), (first, most):
        assert type(each) is type(one) and each.digits is None
        assert_allclose(jax.jit(read)(each), expected, rtol=error)


@each_engine
def test_a_solution_of_another_trace_is_not_kept(contact):
    """Read for the first time under `jit`, known numbers give traced results, which must not be found afterwards."""
    steady = contact.steady(F_X, digits=2)
    inside = jax.jit(lambda r: steady.wear_volume + 0.0 * r)(1.0)
    assert_allclose(steady.wear_volume, inside, rtol=1e-11)


@each_engine
def test_objects_can_be_exported(contact):
    def volume(force):
        return contact.steady(force, digits=2).wear_volume

    assert_allclose(export.export(jax.jit(volume))(F_X).call(1.0), volume(1.0), rtol=1e-11)


@each_engine
def test_threads_read_one_object(contact):
    steady, expected = contact.steady(F_X, digits=2), float(contact.steady(F_X, digits=2).wear_volume)
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(lambda _: float(steady.wear_volume), range(8))) == [expected] * 8


def test_nobody_changes_them():
    for one in (CLOSED.steady(F_X), CLOSED.over_cycles(F_X, COEFFICIENT)):
        with pytest.raises(AttributeError, match="cannot be changed"):
            one.digits = 3


def test_repr_says_what_was_asked():
    told = repr(CLOSED.steady(F_X, digits=3))
    assert told.startswith("Steady(contact=FrettingContact(")
    assert "load=Force(tangential_force=1.5, rig_stiffness=None), digits=3)" in told
    assert "Archard(wear_coefficient=1e-14)" in repr(CLOSED.over_cycles(F_X, COEFFICIENT))


# --- the engines ------------------------------------------------------------------------------------------------------


@parametrize("indenter", [None, STEEL], ids=["rigid", "elastic"])
def test_homogeneous_bodies_have_closed_forms_in_and_out_of_jit(indenter):
    def volume(contact):
        return contact.steady(F_X).wear_volume

    pair, law = (contact_of(body, indenter) for body in (Elastic(110e9, 0.25), PowerLawGraded(110e9, 1e-4, 0.0, 0.25)))
    assert is_closed(pair) and type(pair.steady(F_X)) is Steady
    assert is_closed(law) == (indenter is None)  # by its type, whatever its k
    assert_allclose(jax.jit(volume)(pair), volume(pair), rtol=1e-14)


def test_homogeneous_bodies_share_the_tangential_compliance():
    """Two equal bodies have the compliance of one of half the modulus, and its ratio; Mindlin's at a rigid indenter."""
    one = contact_of(Elastic(100e9, 0.3), Elastic(100e9, 0.3))
    half = contact_of(Elastic(50e9, 0.3))
    for name in ("contact_radius", "gross_slip_displacement"):
        assert_allclose(*(getattr(each.steady(0.0), name) for each in (one, half)), rtol=1e-14)
    a_0 = half.steady(0.0).contact_radius
    theta = (2.0 - 0.3) / (2.0 * (1.0 - 0.3))
    assert_allclose(half.steady(0.0).gross_slip_displacement, FRICTION * theta * a_0**2 / 5e-3, rtol=1e-14)


# --- runs -------------------------------------------------------------------------------------------------------------


def test_coefficients_of_one_contact_share_its_run():
    many = CLOSED.over_cycles(F_X, np.array([1e-15, COEFFICIENT]))
    assert many._solution.curves.edges.ndim == 1
    assert_allclose(many.volume(CYCLES)[1], CLOSED.over_cycles(F_X, COEFFICIENT).volume(CYCLES), rtol=1e-12)


def of_run(k, force):
    run = contact_of(PowerLawGraded(110e9, 1e-4, k, 0.3)).over_cycles(force, COEFFICIENT)
    return jnp.stack([run.depth(7e-5, CYCLES), run.pressure(7e-5, CYCLES), run.lasting_cycles])


@compiled
@parametrize(
    "ask, bad",
    [
        (of_run, (1.2, F_X)),
        (of_run, (0.2, 5.0)),
        (lambda nu: contact_of(Layered([2e-5], [50e9, 100e9], nu)).steady(F_X).wear_volume, (0.6,)),
        (LAYERED.material.modulus_at, (-1.0,)),
        (lambda K: CLOSED.over_cycles(F_X, K).volume(CYCLES), (-1.0,)),
        (CLOSED.over_cycles(F_X, COEFFICIENT).volume, (-1.0,)),
    ],
)
def test_numbers_outside_leave_nothing_plausible(ask, bad):
    assert np.all(np.isnan(by_numpy(ask)(*map(jnp.asarray, bad))))


@compiled
def test_a_batch_of_amplitudes_has_its_axis_also_where_it_is_differentiated_under_jit():
    """What a state takes over from the contact, such as R, has no axis of its own in the rule of derivatives."""

    def pressures(modulus):
        half_space = DepthGraded([1e-5, 5e-5, 2e-4], modulus, 0.3)
        return contact_of(half_space).steady(np.array([0.4, 0.2]), digits=2).edge_pressure(1e-6).sum()

    modulus = np.array([90e9, 100e9, 110e9])
    assert_allclose(jax.jit(jax.grad(pressures))(modulus), jax.grad(pressures)(modulus), rtol=1e-8)
