"""The critical amplitudes and the best exponents are those of the oracle's roots, for any bounds and in the limits."""

import jax
import jax.numpy as jnp
import numpy as np
import optimum_oracle
import pytest
from functions import by_numpy
from marks import compiled
from mpmath import mp, mpf
from numpy.testing import assert_allclose

from plgwear_jax import optimise

NAMES = ("leaves_lower", "reaches_upper", "ends_equal")
BOUNDS = (-0.95, 0.95)


def stacked(bounds):
    found = optimise.critical_amplitudes(bounds)
    return jnp.stack([getattr(found, name) for name in NAMES])


BY_STEPS = by_numpy(lambda *bounds: stacked(bounds))


def errors(found, exact):
    """Relative to the exact numbers, which hold more digits than a float; of 1 - phi for the last of the three."""
    scales = (exact[0], exact[1], 1 - exact[2])
    return [float(abs(mpf(float(x)) - y) / scale) for x, y, scale in zip(found, exact, scales, strict=True)]


# --- values ---------------------------------------------------------------------------------------------------------


def test_between_the_limits():
    # Two units in the last place of the first two; the last is the float next to it, 1e-14 of 1 - phi.
    found = BY_STEPS(np.float64(-1.0), np.float64(1.0))
    exact = optimum_oracle.critical_amplitudes()
    assert max(errors(found, exact)[:2]) < 2e-15
    assert float(found[2]) == pytest.approx(float(exact[2]), abs=1.2e-16)


@pytest.fixture(scope="module")
def bounds(seed):
    """Pairs of bounds: wide, narrow, at both limits."""
    lower, upper = np.sort(np.random.default_rng(seed).uniform(-1.0, 1.0, (2, 4)), axis=0)
    lower[2:] = [-1.0, 1.0 - 1e-6]
    upper[1:] = [lower[1] + 1e-5, lower[2] + 1e-9, 1.0]
    return lower, upper


@pytest.fixture(scope="module")
def with_derivatives(bounds):
    """The amplitudes and their derivatives in both bounds, each of shape (3, 4), with all compiled once."""

    @jax.jit
    def along(lower, upper, dlower, dupper):
        return jax.jvp(lambda *bounds: stacked(bounds), (lower, upper), (dlower, dupper))

    one, zero = np.ones(4), np.zeros(4)
    return along, along(*bounds, one, zero), along(*bounds, zero, one)


@compiled
def test_between_any_bounds(bounds, with_derivatives):
    for found, *pair in zip(with_derivatives[1][0].T, *bounds, strict=True):
        assert max(errors(found, optimum_oracle.critical_amplitudes(tuple(pair)))) < 5e-14


@compiled
def test_derivatives_are_those_of_the_implicit_functions(bounds, with_derivatives):
    _, (_, by_lower), (_, by_upper) = with_derivatives
    for i in range(4):
        lower, upper = (mpf(float(bound[i])) for bound in bounds)
        with mp.workdps(40):
            step = mpf(10) ** -10 * (upper - lower)
            middle, raised, lowered = (
                optimum_oracle.critical_amplitudes(pair)
                for pair in ((lower, upper), (lower + step, upper), (lower, upper - step))
            )
            exact_by_lower = [float((x - y) / step) for x, y in zip(raised, middle, strict=True)]
            exact_by_upper = [float((y - x) / step) for x, y in zip(lowered, middle, strict=True)]
        # The last one's is a quotient of small differences between narrow bounds.
        tolerance = [1e-9, 1e-9, 1e-9 + 1e-13 / float(upper - lower)]
        for found, exact in ((by_lower[:, i], exact_by_lower), (by_upper[:, i], exact_by_upper)):
            assert np.all(np.abs(np.subtract(found, exact)) <= tolerance), (lower, upper)


@compiled
def test_bounds_broadcast(bounds):
    lower = bounds[0][:2]
    found = stacked((lower[:, None], np.array([0.95, 1.0])))
    assert found.shape == (3, 2, 2)
    assert_allclose(found[:, 1, 1], stacked((lower[1], 1.0)), rtol=1e-13)


def test_float32():
    found = BY_STEPS(np.float32(-1.0), np.float32(1.0))
    assert found.dtype == jnp.float32
    assert_allclose(found, np.array(optimum_oracle.critical_amplitudes(), float), rtol=2e-6)
    half = jax.eval_shape(lambda: optimise.critical_amplitudes((np.float16(-1.0), np.float16(1.0))))
    assert half.leaves_lower.dtype == jnp.float16


# --- what is outside ------------------------------------------------------------------------------------------------


@compiled
def test_traced_bounds_out_of_range_give_nan(with_derivatives):
    lower, upper = np.array([-1.5, 0.0, 0.5, -0.5]), np.array([0.0, 1.5, 0.5, 0.5])
    found, slopes = with_derivatives[0](lower, upper, np.ones(4), np.ones(4))
    assert np.array_equal(np.isnan(found), np.broadcast_to([True, True, True, False], (3, 4)))
    assert np.array_equal(np.isnan(slopes), np.isnan(found))


# --- what the three numbers say -------------------------------------------------------------------------------------


@compiled
def test_the_best_exponent_leaves_its_bounds_there():
    at = optimise.critical_amplitudes(BOUNDS)
    phi = jnp.stack([x + d for x in (at.leaves_lower, at.reaches_upper, at.ends_equal) for d in (-1e-6, 1e-6)])
    best = optimise.optimal_exponent(phi, BOUNDS)
    assert best.at_bound.tolist() == [True, False, False, True, True, True]
    assert_allclose(best.k, np.repeat([-0.95, 0.95, 0.95, -0.95], [2, 2, 1, 1]), atol=1e-4)
