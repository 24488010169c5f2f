"""Lists and tuples of numbers are arrays, integers of NumPy are integers, and an empty array is an empty answer.

What is asked of all is traced and not computed; the values of some are those of arrays.
"""

import functools
import pickle

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from dependence import GOOD, PLACES, build, depends, quantities
from functions import FUNCTIONS, arguments, by_one_rule
from kinds import COEFFICIENT, KINDS, LAW, Linear
from marks import compiled, parametrize
from numpy.testing import assert_allclose, assert_array_equal

from plgwear_jax import (
    Cone,
    DepthGraded,
    Elastic,
    FrettingContact,
    GrossSlipContact,
    Layered,
    PowerLawGraded,
    Profile,
    RoundedFlat,
    Shape,
    coating,
    fitting,
    fretting,
    loads,
    optimise,
    wear_laws,
)
from plgwear_jax import contact as room

CLOSED, NUMERIC = KINDS["closed forms"], KINDS["layers under steel"]


def shape_of(function):
    """The one shape of all results, which are traced alone."""
    shapes = {x.shape for x in jax.tree.leaves(jax.eval_shape(function))}
    assert len(shapes) == 1, shapes
    return shapes.pop()


# --- functions --------------------------------------------------------------------------------------------------------


@by_one_rule
def test_functions_take_lists_tuples_and_nothing(name):
    function, good = FUNCTIONS[name], [GOOD[key] for key in arguments(name)]
    two = [[x, 0.9 * x] for x in good]
    assert shape_of(lambda: function(*two)) == (2,)
    assert shape_of(lambda: function(*map(tuple, two), digits=np.int64(4))) == (2,)
    assert shape_of(lambda: function([[good[0]], [0.9 * good[0]]], *good[1:])) == (2, 1)
    assert shape_of(lambda: function(*(np.zeros((2, 0)) for _ in good))) == (2, 0)
    assert shape_of(lambda: function(np.zeros((0, 3)), *([x] for x in good[1:]))) == (0, 3)
    assert_array_equal(function(*two), function(*map(np.array, two)))
    assert_array_equal(function(*two, digits=np.int64(4)), function(*two, digits=4))


def test_what_is_in_a_list_is_checked_by_its_place():
    for given, error, told in (
        ([0.1, 2.0], ValueError, r"^k = 2.0 at index 1 is outside"),
        ([[0.1], [0.2, 0.3]], ValueError, r"^k takes numbers, in rows of one length, not \[\[0.1\], \[0.2, 0.3\]\]$"),
        (["a"], TypeError, r"^k takes real numbers"),
        ([None, 0.1], TypeError, r"^k takes real numbers"),
        ([0.1j], TypeError, r"^k takes real numbers"),
    ):
        with pytest.raises(error, match=told):
            fretting.stick_radius(given, 0.5)
    for digits in (True, np.bool_(True), 2.5, np.float64(4.0), "4", 0, np.int64(0), np.int64(99)):
        for ask in (functools.partial(CLOSED.steady, 0.5), build(GrossSlipContact).steady):
            with pytest.raises(ValueError, match=r"^digits = .* is outside the allowed range 1 <= digits"):
                ask(digits=digits)


def test_lists_are_arrays_under_jit_grad_and_vmap():
    def volume(k):
        return fretting.wear_volume([k, 2.0 * k], (0.3, 0.4)).sum()

    alone = jax.grad(lambda k: fretting.wear_volume(k, 0.3) + fretting.wear_volume(2.0 * k, 0.4))(0.1)
    assert_allclose(jax.grad(volume)(0.1), alone, rtol=1e-14)
    assert jax.eval_shape(jax.vmap(volume), jnp.ones(3)).shape == (3,)
    nothing = jax.grad(lambda force: NUMERIC.steady(force).wear_volume.sum())(jnp.zeros(0))
    assert nothing.shape == (0,)


# --- contacts, and what they answer -----------------------------------------------------------------------------------

ARGUMENTS = {name: places for name, places in quantities(FrettingContact).items() if len(places) < 2}


@parametrize("name", ARGUMENTS)
def test_a_steady_state_takes_lists_and_nothing(name):
    def read(force, at):
        found = getattr(CLOSED.steady(force, digits=np.int64(3)), name)
        return found(at) if ARGUMENTS[name] else found

    (place,) = (1e-8 if key == "displacement_amplitude" else PLACES[key] for key in ARGUMENTS[name] or ["r"])
    if "tangential_force" in depends(FrettingContact, name):
        assert shape_of(lambda: read([1.0, 2.0], [place, 1.1 * place])) == (2,)
        assert shape_of(lambda: read([[1.0], [2.0]], [place])) == (2, 1)
        assert shape_of(lambda: read(np.zeros((0, 3)), np.zeros((0, 1)))) == (0, 3)
    if ARGUMENTS[name]:
        assert shape_of(lambda: read(1.0, [[place], [1.1 * place]])) == (2, 1)
        assert shape_of(lambda: read(1.0, [])) == (0,)


@parametrize("worn", [False, True])
def test_stresses_at_no_place_are_none(worn):
    assert shape_of(lambda: CLOSED.steady(1.0).stress([], np.zeros((2, 1)), worn=worn).xx) == (2, 0)


@compiled
def test_a_numeric_steady_state_of_lists_is_that_of_arrays():
    steady, other = NUMERIC.steady(range(1, 3)), NUMERIC.steady(np.array([1.0, 2.0]))
    assert_array_equal(steady.wear_volume, other.wear_volume)
    r = [[2e-5], (8e-5,)]
    assert_array_equal(steady.wear_depth(r), other.wear_depth(np.array(r)))
    assert steady.pressure(np.zeros((0, 1))).shape == (0, 2)
    assert pickle.loads(pickle.dumps(steady)).wear_volume.shape == (2,)
    nobody = NUMERIC.steady(np.zeros((0, 3)))
    asked = nobody.wear_volume, nobody.deepest_wear, nobody.energy_per_cycle, nobody.edge_intensity
    assert {x.shape for x in (*asked, nobody.wear_depth(5e-5), nobody.pressure([5e-5]))} == {(0, 3)}


RUNS = {
    "closed forms": lambda force: CLOSED.over_cycles(force, COEFFICIENT),
    "rings": lambda force: NUMERIC.over_cycles(force, COEFFICIENT),
    "a march": lambda force: CLOSED.over_cycles(force, wear_laws.PressurePower(1e-23, 2.0), digits=np.int64(2)),
}


@parametrize("kind", RUNS)
def test_a_run_of_nothing_is_nothing(kind):
    run = RUNS[kind](np.zeros((0, 2)))
    for name in ("volume", "rate", "contact_radius", "stick_radius", "energy_per_cycle"):
        if hasattr(run, name):
            assert getattr(run, name)([1e4]).shape == (0, 2), name
    assert run.cycles_to([0.5]).shape == (0, 2)
    for name in ("depth", "profile", "pressure"):
        assert getattr(run, name)([5e-5], 1e4).shape == (0, 2), name


def test_blocks_are_a_list_of_their_own_and_numbers_an_array():
    blocks = [loads.Block([1.0, 2.0], 1e4), loads.Block(0.5, [1e4], friction=(0.4, 0.5))]
    assert CLOSED.over_cycles(blocks, COEFFICIENT).load.of == tuple(blocks)
    assert isinstance(blocks[1].friction, np.ndarray)


# --- records ----------------------------------------------------------------------------------------------------------


class Steep(Shape):
    """A shape of a user."""

    steep: float

    def height(self, r, radius):
        return self.steep * r


RECORDS = [
    lambda x: PowerLawGraded(x, x, x, x),
    lambda x: Elastic(x, x),
    lambda x: DepthGraded(x, x, 0.3),
    lambda x: Layered(x[:1], x, 0.3),
    lambda x: FrettingContact(LAW, x, x, x),
    lambda x: GrossSlipContact(LAW, x, x),
    *(Cone, RoundedFlat, Steep, Linear, loads.Force, wear_laws.Archard),
    lambda x: Profile([0.0, *x], [0.0, *x]),
    lambda x: loads.Displacement(x, x),
    lambda x: loads.Block(x, x, x, x),
    lambda x: wear_laws.PressurePower(x, x),
]


@parametrize("make", RECORDS)
def test_fields_of_records_are_arrays(make):
    """A list that stayed one would be as many leaves as it has numbers."""
    of_list = make([0.25, 0.5])
    for other in (make((0.25, 0.5)), make(jnp.array([0.25, 0.5])), pickle.loads(pickle.dumps(of_list))):
        assert jax.tree.structure(other) == jax.tree.structure(of_list)
        jax.tree.map(assert_array_equal, other, of_list)


# --- what reads its numbers -------------------------------------------------------------------------------------------


def test_what_reads_its_numbers_takes_lists_too():
    assert shape_of(lambda: coating.felt([0.1, 1.0], [0.3, 0.2])) == (2,)
    assert shape_of(lambda: coating.felt([], 0.3)) == (0,)
    assert_array_equal(optimise.tail_weights([1.0, 2.0], (1.0, 3.0), np.float64(0.5)), [0.0, 1.0])
    regimes = room.slip_regimes(CLOSED, [1e-8, 1e-6], [], digits=np.int64(3))
    assert regimes.energy_ratio.shape == (0, 2) and regimes.gross_slip_displacement.shape == (0,)
    data = fitting.Measurements(1.0, [1e4, 1e5], (1e-17, 9e-17), [1e-18, 1e-18])
    assert isinstance(data.cycles, np.ndarray) and isinstance(data.measured, np.ndarray)


@compiled
def test_the_best_exponent_for_no_amplitude_is_none():
    assert shape_of(lambda: optimise.optimal_exponent(np.zeros((0, 3)), digits=np.int64(4)).k) == (0, 3)
