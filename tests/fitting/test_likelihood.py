"""The likelihood of measured wear: its values, derivatives, and what samplers do with it."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kinds import COEFFICIENT, LAW, contact_of
from marks import compiled, parametrize
from numpy.testing import assert_allclose
from refusals import cases

from plgwear_jax.fitting import Measurements, log_likelihood
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.wear_laws import Archard, law_of

ONE = contact_of(LAW)
CYCLES = np.array([1e4, 3e4, 1e5, 2e5, 3e5])
NOISE = 1.0 + 0.05 * np.random.default_rng(3).standard_normal(CYCLES.size)
FORCE, SQUARE = 2.0, law_of(COEFFICIENT / 5e8, 2.0)


def by_both(x, data):
    """By log(K) and log(mu)."""
    return log_likelihood(dataclasses.replace(ONE, friction=ONE.friction * jnp.exp(x[1])), jnp.exp(x[0]), data)


@pytest.fixture(scope="module")
def closed():
    volume = ONE.over_cycles(FORCE, COEFFICIENT).volume(CYCLES) * NOISE
    return Measurements(FORCE, CYCLES, volume, 0.05, relative=True)


AT = jnp.array([np.log(COEFFICIENT), 0.0])


def test_the_likelihood_is_that_of_normal_errors(closed):
    from scipy import stats

    volume, sigma = ONE.over_cycles(FORCE, COEFFICIENT).volume(CYCLES), 0.05 * closed.measured
    exact = stats.norm.logpdf(closed.measured, volume, sigma).sum()
    absolute = dataclasses.replace(closed, deviation=sigma, relative=False)
    for law, data in ((COEFFICIENT, closed), (Archard(COEFFICIENT), closed), (COEFFICIENT, absolute)):
        assert_allclose(log_likelihood(ONE, law, data), exact, rtol=1e-12)


@compiled
@parametrize(
    "load, law, what, r",
    [
        ([Block(FORCE, 1e5), Block(Displacement(1e-5), 2e5, 5.0)], COEFFICIENT, "volume", ()),
        (Force(FORCE), SQUARE, "volume", ()),
        (FORCE, COEFFICIENT, "contact_radius", ()),
        (FORCE, COEFFICIENT, "depth", (7.5e-5,)),
    ],
)
def test_of_other_loads_laws_and_measurements(load, law, what, r):
    """Where what was measured is what the run gives it is largest, as with normal errors."""
    value = getattr(ONE.over_cycles(load, law), what)(*r, CYCLES)
    data = Measurements(load, CYCLES, value, 0.05, *r, what=what, relative=True)
    most = -np.sum(np.log(0.05 * value)) - 0.5 * CYCLES.size * np.log(2.0 * np.pi)
    assert_allclose(log_likelihood(ONE, law, data), most, rtol=1e-9)


@compiled
def test_derivatives_are_differences(closed):
    step, value, slope = 1e-3, jax.jit(by_both), jax.jit(jax.grad(by_both))

    def difference(f):
        return np.stack([(f(AT + h, closed) - f(AT - h, closed)) / (2.0 * step) for h in step * jnp.eye(2)])

    assert_allclose(slope(AT, closed), difference(value), rtol=1e-3)
    curvature = jax.jit(jax.hessian(by_both))(AT, closed)
    assert_allclose(curvature, difference(slope), rtol=1e-2, atol=1e-2 * abs(curvature).max())
    by_deviation = jax.grad(lambda s: by_both(AT, dataclasses.replace(closed, deviation=s)))(0.05)
    z = closed.residuals(ONE.over_cycles(FORCE, COEFFICIENT).volume(CYCLES))
    assert_allclose(by_deviation, np.sum(z * z - 1.0) / 0.05, rtol=1e-9)
    some = jax.vmap(by_both, (0, None))(jnp.stack([AT, AT + 0.1]), closed)
    assert_allclose(some, [value(AT, closed), value(AT + 0.1, closed)], rtol=1e-9)


@cases("fitting/refused.toml", "measurements")
def test_what_is_no_measurement(case):
    given = {"load": FORCE, "cycles": CYCLES, "measured": 1e-15 * CYCLES, "deviation": 0.1} | case["given"]
    with pytest.raises(ValueError, match=case["line"]):
        Measurements(**given)
