"""Wear coefficients from synthetic volumes of tests in gross slip, in blocks and with other wear laws."""

import dataclasses

import numpy as np
import pytest
from kinds import COEFFICIENT, KINDS, LAW, contact_of
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose
from refusals import cases

from plgwear_jax.fitting import fit_wear_coefficient
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.optimise import design
from plgwear_jax.wear_laws import law_of

ONE = contact_of(LAW)
GROSS = Displacement(1e-5)  # gross slip begins at some 0.8 um
CYCLES = np.array([1e4, 3e4, 1e5, 2e5, 3e5])
CHANGING = [Block(GROSS, 1e5, normal_force=F) for F in (10.0, 4.0, 18.0)]
SCATTER = 0.05
NOISE = 1.0 + SCATTER * np.random.default_rng(3).standard_normal((40, CYCLES.size))


def law_with(exponent):
    """A coefficient and its law, whose wear is about that of Archard's by a pressure that the contacts here have."""
    K = COEFFICIENT * 5e8 ** (1.0 - exponent)
    return K, law_of(K, exponent)


@parametrize(
    "one, load, exponent",
    [
        (ONE, GROSS, 1.0),
        (ONE, Force(2.0), 1.0),
        *(
            compiled_case(one, load, exponent)
            for one, load, exponent in (
                (ONE, Displacement(1e-5, rig_stiffness=1e7), 1.0),
                (ONE, Displacement(3e-7), 1.0),
                (ONE, GROSS, 1.5),
                (ONE, Force(2.0), 1.5),
                (ONE, CHANGING, 1.0),
                (ONE, [Block(2.0, 1e5, friction=0.6), Block(GROSS, 1e5, 5.0), Block(Displacement(5e-7), 1e5)], 1.0),
                (KINDS["layers under steel"], GROSS, 1.0),
            )
        ),
    ],
)
def test_a_fit_finds_the_coefficient_that_has_worn(one, load, exponent):
    K, law = law_with(exponent)
    volume = one.over_cycles(load, law).volume(CYCLES)
    found = fit_wear_coefficient(one, load, CYCLES, volume, exponent=exponent)
    assert found.doubt is None
    assert_allclose(found.wear_coefficient, K, rtol=1e-3)
    assert_allclose(found.fitted, found.volume, rtol=1e-3)
    noisy = fit_wear_coefficient(one, load, CYCLES, volume * NOISE[0], SCATTER * volume, exponent=exponent)
    low, high = noisy.interval
    assert low < K < high and low < noisy.wear_coefficient < high < 1.5 * low
    assert noisy.steady_volume is not None or not isinstance(load, Force)
    # The curve of a picture begins with the fit, and the ends of the interval are on both sides of it.
    curve, lower, upper = noisy.curve
    assert np.all(lower <= curve) and np.all(curve <= upper)


@compiled
def test_tests_at_several_normal_forces_tell_the_exponent():
    K, law = law_with(1.5)
    volume, lacks = ONE.over_cycles(CHANGING, law).volume(CYCLES), []
    for exponent in (1.0, 1.5):
        found = fit_wear_coefficient(ONE, CHANGING, CYCLES, volume, SCATTER * volume, exponent=exponent)
        lacks.append(np.sum((found.fitted / volume - 1.0) ** 2))
    assert_allclose(found.wear_coefficient, K, rtol=0.01)
    assert lacks[1] < 1e-2 * lacks[0]


HALF = 2e5  # cycles to half of the final volume, about


@parametrize("cycles, share", [([3.0 * HALF, 6.0 * HALF, 20.0 * HALF], 0.05), ([2.0 * HALF, 4.0 * HALF], 0.3)])
def test_where_the_interval_is_open_the_coefficient_is_the_most_likely_one(cycles, share):
    volume = ONE.over_cycles(2.0, COEFFICIENT).volume(np.array(cycles))
    found = fit_wear_coefficient(ONE, 2.0, cycles, volume, share * volume)
    assert_allclose(found.wear_coefficient, COEFFICIENT, rtol=1e-5)
    assert found.interval[0] < 0.8 * COEFFICIENT and found.interval[1] == np.inf
    assert "a lower bound of the coefficient" in found.doubt


def test_a_coefficient_is_hardly_told_by_an_interval_of_a_factor_of_100():
    volume = np.asarray(ONE.over_cycles(2.0, COEFFICIENT).volume(1e-3 * CYCLES))  # which grow as the coefficient
    rough, worse = (fit_wear_coefficient(ONE, 2.0, 1e-3 * CYCLES, volume, share * volume) for share in (1.1, 1.13))
    assert rough.doubt is None and "the data hardly tell" in worse.doubt
    assert "in percent?" in fit_wear_coefficient(ONE, 2.0, 1e-3 * CYCLES, volume, 5.0, relative=True).doubt
    assert 20.0 < rough.interval[1] / rough.interval[0] < 100.0 < worse.interval[1] / worse.interval[0]


def test_the_most_likely_of_several_minima_is_found():
    """An early point and a late one that contradict each other, each with a minimum of its own."""
    run = ONE.over_cycles(2.0, COEFFICIENT)
    cycles = np.array([0.02 * HALF, 0.02 * HALF, 5.0 * HALF])
    for slow, fast in ((0.01, 1.0), (0.05, 1.3)):
        volume = np.asarray(run.volume(cycles * np.array([slow * 50.0, slow * 50.0, 0.01 * fast])))
        for deviation in ([0.3, 0.3, 0.02], [0.05, 0.05, 0.3]):
            given = volume, deviation * volume
            found = fit_wear_coefficient(ONE, 2.0, cycles, *given)
            K = np.geomspace(1e-3, 1e3, 4001) * COEFFICIENT
            modelled = run.volume(cycles * K[:, None] / COEFFICIENT)
            misfit = np.sum(((modelled - volume) / given[1]) ** 2, -1)
            assert_allclose(found.wear_coefficient, K[np.argmin(misfit)], rtol=4e-3)


def test_a_relative_deviation_stands_for_a_deviation_of_each():
    volume = ONE.over_cycles(2.0, COEFFICIENT).volume(CYCLES) * NOISE[0]
    of_each = fit_wear_coefficient(ONE, 2.0, CYCLES, volume, SCATTER * volume)
    begun = np.append(0.0, CYCLES), np.append(0.0, volume)  # before the first cycle nothing is worn
    share = fit_wear_coefficient(ONE, 2.0, *begun, SCATTER, relative=True)
    assert_allclose(share.interval, of_each.interval, rtol=1e-12)
    assert_allclose(share.deviation, SCATTER * begun[1], rtol=1e-15)


@cases("fitting/refused.toml", "fits")
def test_what_is_no_measurement_is_refused(case):
    given = {"load": GROSS, "cycles": CYCLES, "volume": [1e-15, 1e-14, 3e-14, 6e-14, 9e-14]} | case["given"]
    if given["load"] == "BLOCK":
        given["load"] = [Block(2.0, 1e4)]
    with pytest.raises((TypeError, ValueError), match=case["line"]):
        fit_wear_coefficient(ONE, **given)


@parametrize("ask, given", [(fit_wear_coefficient, (CYCLES, 1e-15 * CYCLES)), (design, ({"k": (0.0, 0.5)},))])
def test_a_fit_and_a_design_are_of_one_contact(ask, given):
    with pytest.raises(ValueError, match=r"contact: friction of shape \(2,\): takes one contact"):
        ask(dataclasses.replace(ONE, friction=[0.4, 0.5]), 2.0, *given)
