"""Lives of all exponents, read from runs at a few, against the run of each contact."""

import jax
import numpy as np
from coated import LIFE, on
from hypothesis import example, given, settings
from hypothesis import strategies as st
from kinds import dome
from marks import compiled
from numpy.testing import assert_allclose
from reduced import MANY, coefficient_of

from plgwear_jax import optimise
from plgwear_jax.loads import Displacement
from plgwear_jax.optimise.evaluation import evaluate
from plgwear_jax.optimise.question import question_of, read_from_runs

CONTACT = dome(0.1)
AT = np.linspace(0.0, 1.0, 9)
LOADS = [0.0, 1.0]  # under no force nothing wears


@compiled
@settings(max_examples=20)
@given(
    ends=st.tuples(st.floats(-0.99, 0.9), st.floats(0.02, 1.5)).map(lambda two: (two[0], min(0.99, sum(two)))),
    phi=st.floats(0.01, 0.98),
    reduced=st.floats(-6.0, 3.0).map(lambda power: 10.0**power),
)
@example(ends=(-0.999999, 0.999999), phi=0.25, reduced=1e-6)
def test_wear_between_the_runs_is_that_of_a_run(ends, phi, reduced):
    """Over the domain in which runs are accurate, far below their own error of 1e-4 of the final volume."""
    force, cycles = phi * 4.0, reduced * MANY * coefficient_of(CONTACT) / 1e-14
    question = question_of(CONTACT, force, {"k": ends}, cycles=cycles, law=1e-14)
    assert read_from_runs(question)
    k = np.clip(ends[0] + (ends[1] - ends[0]) * AT, *ends)
    direct, final = dome(k).over_cycles(force, 1e-14).volume(cycles), dome(k).steady(force).wear_volume
    assert_allclose(evaluate(question, {"k": k}).objective / final, direct / final, atol=3e-5)


def test_slopes_between_the_runs():
    question = question_of(CONTACT, LOADS, {"k": (-0.6, 0.6), "E0": (50e9, 200e9)}, **LIFE)
    step, moved = 1e-4, np.array([[0, -1, 1, 0, 0], [0, 0, 0, -1, 1]])
    found = evaluate(question, {"k": 0.23 + step * moved[0], "E0": 90e9 * np.exp(step * moved[1])})
    values = found.values[:, 0]
    assert_allclose(found.rows[0, 0, 1:], (values[2::2] - values[1::2]) / (2.0 * step), rtol=1e-5)


def test_a_reference_and_wear_beyond_the_bounds_of_a_design():
    contact = dome(np.float64(0.8))
    found = optimise.design(contact, LOADS, {"k": (-0.3, 0.2)}, **LIFE)
    k = np.array([0.8, found.variables["k"], -0.7, 0.1, 0.6])
    worn = 0.5 * dome(k).over_cycles(1.0, 1e-14).volume(4e5)
    assert_allclose([found.reference_value, found.value], worn[:2], rtol=1e-6)
    course = optimise.along(found, "k", k[2:])
    assert_allclose(course.value, worn[2:], rtol=1e-5)
    assert np.all(course.keeps_limits)


def test_what_has_runs_of_its_own_for_each_design():
    """Another amplitude F_x/(mu F_N), another ratio theta, or another quantity."""
    for vary, more in (
        ({"friction": (0.3, 0.5)}, {}),
        ({"nu": (0.2, 0.4)}, {}),
        ({"k": (-0.3, 0.3)}, {"minimise": {"wear_depth": {"r": 6e-5}}}),
        ({"k": (-0.3, 0.3)}, {"load": Displacement(1e-7)}),
    ):
        assert not read_from_runs(question_of(CONTACT, **{"load": 1.0, "vary": vary, **LIFE, **more}))


@compiled
def test_designs_for_a_life_have_derivatives():
    def worn(radius):
        return optimise.designs(
            on(CONTACT, radius=radius), 1.0, {"k": (-0.6, 0.6)}, hold="contact_radius", **LIFE
        ).value

    radius, step = 5e-3, 1e-4
    lower, upper = map(worn, radius * np.array([1.0 - step, 1.0 + step]))
    assert_allclose(jax.jit(jax.grad(worn))(radius), (upper - lower) / (2.0 * step * radius), rtol=1e-4)
