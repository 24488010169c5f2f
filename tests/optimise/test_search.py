"""The search as ask and tell: it says where to look and is told what lies there, in a Python loop or in one program."""

import dataclasses
import functools

import jax
import jax.numpy as jnp
import numpy as np
from coated import RIGID as CONTACT
from marks import compiled, parametrize
from numpy.testing import assert_allclose
from optima import optima

from plgwear_jax import optimise
from plgwear_jax.optimise.ask_and_tell import DONE, INFINITE, begin, conclude, plan_of, tell

# --- ask and tell -----------------------------------------------------------------------------------------------------


def polynomial(n, seed):
    """Rows of one of degree 4 in each of n variables and of the excess over a ball about a random point."""
    rng = np.random.default_rng([seed, n])
    along, centre = rng.uniform(-1.0, 1.0, (n, 5)), rng.uniform(-0.5, 0.5, n)

    def both(u):
        goal = sum(map(jnp.polyval, along, u)) + jnp.prod(u)
        return jnp.stack([goal, jnp.sum((u - centre) ** 2) - 0.25])

    return jax.jit(jax.vmap(lambda u: jnp.column_stack([both(u), jax.jacfwd(both)(u)])))


def ended(plan, problem, state, next_state):
    """The state at the end, and the phases on the way, each once."""
    phases = []
    while state.phase != DONE:
        assert state.points.shape == (plan.lanes, plan.variables) and np.all(np.abs(state.points) <= 1.0)
        phases.append(int(state.phase))
        assert len(phases) < plan.passes + plan.max_steps + 10
        # It knows nothing of the problem but these numbers.
        u = np.asarray(state.points)
        state = next_state(state, np.asarray(problem(u)))
    return state, sorted(set(phases))


@parametrize("n", [1, 2])
def test_it_needs_no_more_than_to_be_told(n, seed):
    problem, plan = polynomial(n, seed), plan_of(n, 1, samples=33)
    state, phases = ended(plan, problem, begin(plan), functools.partial(tell, plan))
    found = conclude(plan, state)
    assert phases == [0, 1, 2] and found.ended["converged"] and found.ended["certified"]
    assert all(isinstance(leaf, np.ndarray | np.generic) for leaf in jax.tree.leaves((state, found)))
    # Nothing on a dense grid that keeps the limit lies lower.
    grid = np.stack(np.meshgrid(*n * [np.linspace(-1.0, 1.0, 401)], indexing="ij"), axis=-1).reshape(-1, n)
    goal, excess = np.asarray(problem(grid))[..., 0].T
    assert found.pair.values[0, 1] <= plan.tolerance and found.pair.values[0, 0] <= np.min(goal[excess <= 0.0]) + 1e-9
    if n == 1:
        return
    # By JAX the search goes the same way; what is concluded is small enough for NumPy.
    first = jax.tree.map(jnp.asarray, begin(plan))
    traced, others = ended(plan, problem, first, jax.jit(functools.partial(tell, plan)))
    assert others == phases and all(isinstance(leaf, jax.Array) for leaf in jax.tree.leaves(traced))
    other = conclude(plan, jax.tree.map(np.asarray, traced))
    assert_allclose(found.pair.u, other.pair.u, atol=1e-9)
    assert_allclose(found.pair.values, other.pair.values, atol=1e-12)
    assert found.has_rival == other.has_rival and other.ended["certified"]


def test_values_that_are_not_finite_are_dealt_with():
    # A pole, and nothing known in a third of the box: the valley beside it is found.
    def told(u):
        with np.errstate(all="ignore"):
            values, slopes = np.log(u - 0.5 * u**2 - 0.1), (1.0 - u) / (u - 0.5 * u**2 - 0.1)
        return -np.stack([values, slopes], axis=-1)

    plan = plan_of(1, 0)
    found = conclude(plan, ended(plan, told, begin(plan), functools.partial(tell, plan))[0])
    assert found.pair.u[0] == 1.0 and found.ended["converged"]


def test_no_descent_begins_where_a_limit_is_infinite():
    def told(u):
        slope = np.ones_like(u)
        limit = np.where(u < 0.0, INFINITE, u - 0.3)
        return np.stack([np.hstack([-u, -slope]), np.hstack([limit, slope])], axis=1)

    plan = plan_of(1, 1)
    assert ended(plan, told, begin(plan), functools.partial(tell, plan))[0].valleys == 1


# --- one by one and in one program ------------------------------------------------------------------------------------


@compiled
@parametrize("bounds", [(-0.95, 0.95), (-0.4, 0.6)])
def test_amplitudes_one_by_one_are_those_of_a_batch(bounds):
    phi = np.array([1e-3, 0.05, 0.1, 0.2, 0.3, 0.36, 0.6, 0.97, 0.997, 0.9999])
    few, many = optimise.optimal_exponent(phi, bounds), optima(phi, bounds)
    tolerances = {"k": {"atol": 1e-9}, "rival": {"atol": 1e-8}}
    for name in (field.name for field in dataclasses.fields(few)):
        pair = getattr(few, name), getattr(many, name)
        assert_allclose(*pair, **tolerances.get(name, {"rtol": 1e-13}), err_msg=name)
    assert np.any(few.at_bound) and not np.all(few.at_bound) and np.all(few.scan_found_nothing_better)


# --- loads without weight ---------------------------------------------------------------------------------------------


@compiled
def test_what_has_no_weight_neither_counts_nor_limits():
    limits = {"edge_pressure": {"below": 6.2e8, "distance": 1e-6}, "penetration": {"below": 9e-7}}
    asked = {"hold": "contact_radius", "minimise": "deepest_wear", "limits": limits}
    vary, force, weight = {"k": (-0.9, 0.9)}, np.array([0.2, 0.6, 1.0]), np.array([3.0, 2.0, 1.0])
    question = CONTACT, np.append(force, 3.0), vary
    three, many = (
        search(*question, weight=np.append(weight, 0.0), **asked) for search in (optimise.design, optimise.designs)
    )
    assert_allclose(many.value, three.value, rtol=1e-12)
    steady = three.contact.steady(force)
    assert_allclose(three.value, np.average(steady.deepest_wear, weights=weight), rtol=1e-13)
    limited = steady.edge_pressure(1e-6)[-1], steady.penetration[-1]
    assert_allclose([three.limits[name].value for name in limits], limited, rtol=1e-12)
