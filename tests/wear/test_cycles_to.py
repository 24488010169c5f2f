"""How long until so much is worn: against the first cycle, the steady state, and the runs themselves."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kinds import COEFFICIENT, KINDS, LAW, contact_of
from marks import compiled, compiled_case, long_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases

from plgwear_jax.loads import Block, Displacement
from plgwear_jax.wear_laws import PressurePower

ONE, FORCE = contact_of(LAW), 2.0
BLOCKS = [Block(force, 1e5) for force in (FORCE, 0.5, 0.5, 3.0)]  # the second and the third wear nothing new
LOADS = {
    "closed": (ONE, FORCE),
    "numeric": (KINDS["layers under steel"], FORCE),
    "held": (ONE, Displacement(3e-7)),
    "sliding": (ONE, Displacement(1e-5)),
    "blocks": (ONE, BLOCKS),
}


def run_of(name, law=COEFFICIENT):
    one, load = LOADS[name]
    return one.over_cycles(load, law)


@parametrize("name", ["closed", "held", *map(compiled_case, ("sliding", "numeric", "blocks"))])
def test_a_run_has_worn_that_much_by_then(name):
    run = run_of(name)
    end, shares = run.lasting_cycles, np.array([0.01, 0.3, 0.9])
    volumes = shares * run.volume(end)
    assert run.volume(0.0) == run.depth(0.0, 0.0) == run.pressure(1.0, 0.0) == 0.0
    assert_allclose(run.volume(run.cycles_to(volume=volumes)), volumes, rtol=1e-9)
    assert_allclose(run.cycles_to(volume=volumes), run.cycles_to(shares), rtol=1e-9)
    r = np.linspace(0.0, run.contact_radius(end), 8001)
    depths = shares * np.max(run.depth(r, end))
    by_then = np.max(run.depth(r[:, None], run.cycles_to(depth=depths)), 0)
    assert_allclose(by_then, depths, rtol=5e-4)
    last = [getattr(run, name)(end) for name in ("volume", "deepest_wear", "stick_radius", "contact_radius")]
    assert run.final is None or np.allclose(run.final, last, rtol=1e-4, atol=0.0)


def test_the_first_cycles_and_the_last_ones():
    """Before the contact changes, a cycle wears K p_0 times the path that slips; in the end it is the steady state."""
    run, steady = run_of("closed"), ONE.steady(FORCE)
    r = np.linspace(steady.stick_radius, steady.contact_radius, 4001)
    a_cycle = COEFFICIENT * np.max(steady.initial_pressure(r) * 4.0 * steady.slip_amplitude(r))
    assert_allclose(run.cycles_to(depth=10.0 * a_cycle), 10.0, rtol=5e-3)
    assert_allclose(run.cycles_to(volume=10.0 * (COEFFICIENT / 0.4 * steady.energy_per_cycle)), 10.0, rtol=1e-3)
    for name, most in (("depth", steady.deepest_wear), ("volume", steady.wear_volume)):
        found = run.cycles_to(**{name: most * np.array([0.0, 1.0 - 1e-6, 1.0 + 1e-6])})
        assert 0.0 <= found[0] < 1e-6 and 1e6 < found[1] < 1e8 and found[2] == np.inf


def test_what_is_never_worn_takes_for_ever():
    still = ONE.over_cycles(0.0, COEFFICIENT)
    for name in ("depth", "volume"):
        assert_array_equal(still.cycles_to(**{name: np.array([0.0, 1e-30])}), [0.0, np.inf])
        # Gross slip goes on when the run has ended.
        assert np.isnan(run_of("sliding").cycles_to(**{name: 1.0}))
    assert np.isnan(still.cycles_to(0.5))


@compiled
def test_blocks_end():
    run = run_of("blocks")
    ends = run.volume(np.array([1e5, 3e5, 4e5]))
    assert run.cycles_to(volume=1.01 * ends[2]) == np.inf
    assert 3e5 < run.cycles_to(volume=0.5 * (ends[1] + ends[2])) < 4e5
    half = run_of("blocks", PressurePower(COEFFICIENT, 1.0)).cycles_to(volume=0.5 * ends[0])
    assert_allclose(half, run.cycles_to(volume=0.5 * ends[0]), rtol=1e-2)


@compiled
@parametrize(
    "name, goals, most",
    [
        ("closed", {"depth": 5e-8}, 1e-6),
        ("closed", {"volume": 2e-16}, 1e-8),
        long_case("numeric", {"depth": 5e-8}, 1e-5),
        ("sliding", {"volume": 1e-14}, 2e-2),
    ],
)
def test_derivatives_are_those_of_the_implicit_function(name, goals, most):
    def of(x):
        one, load = LOADS[name]
        one = dataclasses.replace(one, normal_force=one.normal_force * jnp.exp(x[0]))
        run = one.over_cycles(load, COEFFICIENT * jnp.exp(x[1]))
        return jnp.log(run.cycles_to(**{name: goal * jnp.exp(x[2]) for name, goal in goals.items()}))

    at, value, step = jnp.zeros(3), jax.jit(of), 1e-3
    slope = jax.grad(of)(at)
    ahead = [[float(value(times * step * one)) for times in (1.0, -1.0, 2.0, -2.0)] for one in np.eye(3)]
    differences = [(8.0 * (a - b) - (c - d)) / (12.0 * step) for a, b, c, d in ahead]
    assert_allclose(slope, differences, atol=most)
    assert float(slope[1]) == pytest.approx(-1.0, abs=1e-9)  # only K times the cycles counts
    assert_allclose(jax.vmap(of)(jnp.stack([at, at])), [value(at)] * 2, rtol=1e-9)


def test_slopes_by_the_volume_are_those_of_the_rate():
    run, volume = run_of("closed"), 2e-16
    slope = jax.grad(lambda volume: run.cycles_to(volume=volume))(volume)
    assert_allclose(slope, 1.0 / run.rate(run.cycles_to(volume=volume)), rtol=1e-9)


@compiled
def test_batches_single_precision_and_values_outside_under_jit():
    depths = np.array([1e-9, 1e-8, 1e-6])
    found = ONE.over_cycles([1.0, 2.0], COEFFICIENT).cycles_to(depth=depths[:, None])
    assert_allclose(found[:, 1], run_of("closed").cycles_to(depth=depths), rtol=1e-9)
    one, *single = jax.tree.map(jnp.float32, (ONE, FORCE, COEFFICIENT))
    run = one.over_cycles(*single)
    assert run.cycles_to(depth=jnp.float32(1e-8)).dtype == np.float32
    assert_allclose(run.cycles_to(depth=jnp.float32(1e-8)), found[1, 1], rtol=1e-3)
    asked = jax.jit(jax.vmap(lambda force, K, depth: ONE.over_cycles(force, K).cycles_to(depth=depth)))
    force, K = np.array([2.0, 5.0, 2.0, 2.0, 2.0]), np.array([1e-14, 1e-14, -1.0, 1e-14, 1e-14])
    told = asked(force, K, np.array([1e-8, 1e-8, 1e-8, -1.0, 1e-3]))
    assert_allclose(told, [found[1, 1], *[np.nan] * 3, np.inf], rtol=1e-9)
    assert run.cycles_to(depth=np.zeros((0, 1), np.float32)).shape == (0, 1)


@cases("wear/refused.toml", "goals")
def test_what_is_no_goal(case):
    with pytest.raises(ValueError, match=case["line"]):
        run_of("closed").cycles_to(**case["given"])
