"""The search as ask and tell: it says where to look and is told what lies there, in a Python loop or in one program."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from coated import RIGID as CONTACT
from functions import fretting
from optima import optima

from plgwear_jax import optimise
from plgwear_jax.optimise.scenarios import padded
from plgwear_jax.optimise.search import DONE, begin, conclude, plan_of, tell

# --- ask and tell -----------------------------------------------------------------------------------------------------


class Polynomial:
    """A random polynomial of degree 4 in each of n variables, that is to stay in a ball about a random point."""

    def __init__(self, n: int, seed: int) -> None:
        rng = np.random.default_rng([seed, n])
        self.coefficients = rng.uniform(-1.0, 1.0, (n, 5))
        self.centre = rng.uniform(-0.5, 0.5, n)

    def objective(self, u):
        along = (
            np.polynomial.polynomial.polyval(x, c)
            for x, c in zip(np.moveaxis(u, -1, 0), self.coefficients, strict=True)
        )
        return sum(along) + np.prod(u, axis=-1)

    def excess(self, u):
        return np.sum((u - self.centre) ** 2, axis=-1) - 0.25

    def told(self, u):
        """Values (lanes, 2) and slopes (lanes, 2, n), by NumPy."""
        by_axis = [
            np.polynomial.polynomial.polyval(u[:, i], np.polynomial.polynomial.polyder(c))
            + np.prod(np.delete(u, i, axis=1), axis=1)
            for i, c in enumerate(self.coefficients)
        ]
        values = np.stack([self.objective(u), self.excess(u)], axis=-1)
        return values, np.stack([np.stack(by_axis, axis=-1), 2.0 * (u - self.centre)], axis=1)


def ended(plan, problem, state, next_state):
    """The state at the end, and the phases on the way, each once."""
    phases = []
    while state.phase != DONE:
        assert state.points.shape == (plan.lanes, plan.variables) and np.all(np.abs(state.points) <= 1.0)
        phases.append(int(state.phase))
        assert len(phases) < plan.passes + plan.max_steps + 10
        # It knows nothing of the problem but these numbers.
        state = next_state(state, *problem.told(np.asarray(state.points)))
    return state, sorted(set(phases), key=phases.index)


@pytest.mark.parametrize("n", [1, 2])
def test_it_needs_no_more_than_to_be_told(n, seed):
    problem, plan = Polynomial(n, seed), plan_of(n, 1, samples=33)
    state, phases = ended(plan, problem, begin(plan), functools.partial(tell, plan))
    assert phases == [0, 1, 2]
    found = conclude(plan, state)
    assert bool(found.converged) and bool(found.certified)
    assert all(isinstance(leaf, np.ndarray | np.generic) for leaf in jax.tree.leaves((state, found)))
    # Nothing on a dense grid that keeps the limit lies lower.
    grid = np.stack(np.meshgrid(*n * [np.linspace(-1.0, 1.0, 401)], indexing="ij"), axis=-1).reshape(-1, n)
    kept = problem.excess(grid) <= 0.0
    assert found.values[0, 1] <= plan.tolerance
    assert found.values[0, 0] <= np.min(problem.objective(grid[kept])) + 1e-9


def test_numpy_and_jax_go_the_same_way(seed):
    problem, plan = Polynomial(2, seed), plan_of(2, 1, samples=33)
    plain, phases = ended(plan, problem, begin(plan), functools.partial(tell, plan))
    compiled = jax.jit(functools.partial(tell, plan))
    traced, others = ended(plan, problem, jax.tree.map(jnp.asarray, begin(plan)), compiled)
    assert phases == others
    assert all(isinstance(leaf, jax.Array) for leaf in jax.tree.leaves(traced))
    # What is concluded is small enough for NumPy in both cases.
    found, other = (conclude(plan, jax.tree.map(np.asarray, state)) for state in (plain, traced))
    np.testing.assert_allclose(found.u, other.u, atol=1e-9)
    np.testing.assert_allclose(found.values, other.values, atol=1e-12)
    for flag in ("converged", "certified", "has_rival"):
        np.testing.assert_array_equal(getattr(found, flag), getattr(other, flag), err_msg=flag)


def test_values_that_are_not_finite_are_dealt_with():
    # A pole, and nothing known in a third of the box: the valley beside it is found.
    def told(u):
        with np.errstate(all="ignore"):
            values, slopes = np.log(u - 0.5 * u**2 - 0.1), (1.0 - u) / (u - 0.5 * u**2 - 0.1)
        return -values, -slopes[:, None]

    plan = plan_of(1, 0)
    state = begin(plan)
    while state.phase != DONE:
        state = tell(plan, state, *told(state.points))
    found = conclude(plan, state)
    assert found.u[0] == 1.0 and bool(found.converged)


# --- one by one and in one program ------------------------------------------------------------------------------------


@pytest.mark.compiled
@pytest.mark.parametrize("bounds", [(-0.95, 0.95), (-0.4, 0.6)])
def test_amplitudes_one_by_one_are_those_of_a_batch(bounds):
    phi = np.array([1e-3, 0.05, 0.1, 0.2, 0.3, 0.36, 0.6, 0.97, 0.997, 0.9999])
    few, many = optimise.optimal_exponent(phi, bounds), optima(phi, bounds)
    np.testing.assert_allclose(few.k, many.k, atol=1e-9)
    np.testing.assert_allclose(few.wear_volume, many.wear_volume, rtol=1e-13)
    np.testing.assert_allclose(few.rival, many.rival, atol=1e-8)
    np.testing.assert_allclose(few.rival_wear_volume, many.rival_wear_volume, rtol=1e-13)
    for flag in ("at_bound", "converged", "certified", "scan_found_nothing_better"):
        np.testing.assert_array_equal(getattr(few, flag), getattr(many, flag), err_msg=flag)
    assert np.any(few.at_bound) and not np.all(few.at_bound) and np.all(few.scan_found_nothing_better)


# --- loads of a few sizes ---------------------------------------------------------------------------------------------


def test_loads_are_filled_up_to_a_few_sizes():
    sizes = {}
    for count in (1, 2, 4, 5, 16, 17, 64, 65, 1024, 1025, 2048, 2049, 10_000):
        phi, weight = padded(np.linspace(0.9, 0.1, count), np.full(count, 1.0 / count))
        assert phi.shape == weight.shape and phi.size >= count
        np.testing.assert_array_equal(phi[:count], np.linspace(0.9, 0.1, count))
        np.testing.assert_array_equal(weight[:count], 1.0 / count)
        assert not np.any(phi[count:]) and not np.any(weight[count:])
        sizes[count] = phi.size
    assert sizes == {
        1: 1, 2: 4, 4: 4, 5: 16, 16: 16, 17: 64, 64: 64, 65: 256, 1024: 1024, 1025: 1280, 2048: 2048, 2049: 2560,
        10_000: 10_240,
    }  # fmt: skip


@pytest.mark.compiled
def test_what_fills_a_load_up_changes_nothing():
    """A load of three amplitudes is filled up to four; one that has an amplitude twice, a half each time, is not."""
    asked = {"vary": {"k": (-0.9, 0.9)}, "hold": "contact_radius", "minimise": "deepest_wear"}
    three = optimise.design(CONTACT, [0.2, 0.6, 1.2], weight=[3.0, 2.0, 1.0], **asked)
    four = optimise.design(CONTACT, [0.2, 0.6, 0.6, 1.2], weight=[3.0, 1.0, 1.0, 1.0], **asked)
    assert three.load.weight.tolist()[3:] == [0.0] and all(four.load.weight)
    assert three.variables["k"] == pytest.approx(four.variables["k"], abs=1e-9)
    assert float(three.value) == pytest.approx(float(four.value), rel=1e-14)
    assert three.saving == pytest.approx(four.saving, rel=1e-12)
    mean = np.average(three.contact.steady(np.array([0.2, 0.6, 1.2])).deepest_wear, weights=[3.0, 2.0, 1.0])
    assert float(three.value) == pytest.approx(mean, rel=1e-13)


@pytest.mark.compiled
def test_what_fills_a_load_up_does_not_limit():
    asked = {"vary": {"k": (-0.9, 0.9)}, "hold": "contact_radius"}
    limits = {"edge_pressure": {"below": 6.2e8, "distance": 1e-6}, "penetration": {"below": 9e-7}}
    found = optimise.design(CONTACT, [0.2, 0.6, 1.0], limits=limits, **asked)
    assert found.limits["edge_pressure"].value == pytest.approx(
        float(found.contact.steady(1.0).edge_pressure(1e-6)), rel=1e-12
    )
    assert found.limits["penetration"].value == pytest.approx(float(found.contact.steady(1.0).penetration), rel=1e-12)
    phi = 0.25 * np.array([0.2, 0.6, 1.0])
    expected = np.mean(fretting.wear_volume(found.variables["k"], phi)) * CONTACT.steady(0.0).contact_radius ** 4 / 5e-3
    assert float(found.value) == pytest.approx(float(expected), rel=1e-12)
