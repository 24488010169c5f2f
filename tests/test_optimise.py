"""The optimum found is the optimum: against the oracle's derivative, against a dense scan, at and between bounds."""

import jax
import jax.numpy as jnp
import numpy as np
import oracle
import pytest
from mpmath import mp

from plgwear_jax import FrettingContact, PowerLawGraded, fretting, optimise

REFERENCE = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
CONTACT = FrettingContact(REFERENCE, radius=5e-3, normal_force=10.0, friction=0.4)


@pytest.fixture(scope="module")
def many():
    phi = jnp.linspace(0.001, 0.9999, 500)
    return phi, optimise.optimal_exponent(phi)


def test_every_amplitude_converges_and_is_certified(many):
    _, best = many
    assert bool(jnp.all(best.converged))
    assert bool(jnp.all(best.certified))


def test_no_exponent_of_a_dense_scan_wears_less(many):
    phi, best = many
    k = jnp.linspace(-0.95, 0.95, 2001)
    dense = jnp.min(jax.jit(fretting.wear_volume)(k, phi[:, None]), axis=1)
    assert bool(jnp.all(best.wear_volume <= dense * (1.0 + 1e-14)))


def exact_optimum(phi, near):
    def slope(k):
        return oracle.derivatives("wear_volume", (k, phi), wrt=(0,)).gradient[0]

    with mp.workdps(40):
        return mp.findroot(slope, (near - 1e-4, near + 1e-4), tol=1e-30)


def test_interior_optima_are_the_roots_of_the_oracles_derivative(many):
    phi, best = many
    interior = np.flatnonzero(~np.asarray(best.at_bound))
    assert len(interior) > 100
    for i in interior[:: len(interior) // 8]:
        assert abs(float(best.k[i]) - exact_optimum(float(phi[i]), float(best.k[i]))) < 1e-9


def test_the_best_exponent_rises_with_the_amplitude_and_then_jumps(many):
    phi, best = many
    k = np.asarray(best.k)
    jump = int(np.argmin(np.diff(k)))
    assert np.all(np.diff(k[: jump + 1]) >= -1e-9)
    # Very close to gross slip the other end is better again.
    assert phi[jump] > 0.99
    assert (k[jump], k[jump + 1]) == (0.95, -0.95)


@pytest.mark.parametrize("phi,k", [(0.05, -0.4), (0.7, 0.6)])
def test_bounds_are_said_and_hit_exactly(phi, k):
    best = optimise.optimal_exponent(phi, bounds=(-0.4, 0.6))
    assert bool(best.at_bound)
    assert best.k == k


def test_an_optimum_between_narrower_bounds_is_the_same():
    best = optimise.optimal_exponent(0.25, bounds=(-0.4, 0.6))
    assert not bool(best.at_bound)
    assert float(best.k) == pytest.approx(float(optimise.optimal_exponent(0.25).k), abs=1e-9)


def test_bounds_may_be_batched():
    phi = jnp.full(500, 0.25)  # the shape of `many`, which is compiled
    best = optimise.optimal_exponent(phi, bounds=(jnp.linspace(-0.9, 0.5, 500), 0.9))
    np.testing.assert_allclose(best.k[0], float(optimise.optimal_exponent(0.25).k), atol=1e-9)
    assert best.k[-1] == 0.5


def test_no_load_wears_nothing():
    best = optimise.optimal_exponent(0.0)
    assert best.wear_volume == 0.0
    assert bool(best.converged)


def test_the_optimum_is_differentiable():
    step = 1e-4
    slope = jax.grad(lambda phi: optimise.optimal_exponent(phi).k)(0.25)
    ahead, behind = (optimise.optimal_exponent(0.25 + d).k for d in (step, -step))
    assert float(slope) == pytest.approx(float(ahead - behind) / (2 * step), rel=1e-5)
    # Envelope theorem: k does not count in the derivative of the least wear.
    wear = jax.grad(lambda phi: optimise.optimal_exponent(phi).wear_volume)(0.25)
    best = optimise.optimal_exponent(0.25).k
    assert float(wear) == pytest.approx(float(jax.grad(fretting.wear_volume, 1)(best, 0.25)), rel=1e-8)
    assert jax.grad(lambda phi: optimise.optimal_exponent(phi).k)(0.9) == 0.0


def test_traced_arguments_outside_the_domain_give_nan():
    best = jax.jit(optimise.optimal_exponent)(jnp.linspace(0.2, 1.2, 500))
    inside = np.linspace(0.2, 1.2, 500) < 1.0
    assert np.array_equal(np.isfinite(best.k), inside)
    assert np.array_equal(np.isfinite(best.wear_volume), inside)
    assert np.array_equal(best.converged, inside)


def test_float32():
    phi = jnp.array([0.1, 0.2, 0.3], jnp.float32)
    best = optimise.optimal_exponent(phi)
    assert best.k.dtype == jnp.float32
    np.testing.assert_allclose(best.k, optimise.optimal_exponent(phi.astype(float)).k, atol=1e-4)
    assert bool(jnp.all(best.converged))


def test_design_at_held_contact_radius():
    best = optimise.design(CONTACT, 1.0, {"k": (-0.9, 0.9)}, hold="contact_radius")
    phi = 1.0 / (0.4 * 10.0)
    assert best.variables["k"] == pytest.approx(float(optimise.optimal_exponent(phi, bounds=(-0.9, 0.9)).k), abs=1e-9)
    assert float(best.contact.contact_radius()) == pytest.approx(float(CONTACT.contact_radius()), rel=1e-13)
    assert best.reference is CONTACT
    assert best.wear_volume < best.reference_wear_volume
    assert best.at_bound == {"k": None}
    assert best.converged
    assert best.certified


def test_design_with_nothing_held_runs_into_the_bounds_of_z0():
    best = optimise.design(CONTACT, 1.0, {"k": (-0.5, 0.5), "z0": (1e-5, 1e-3)})
    assert best.at_bound["z0"] in ("lower", "upper")
    assert best.variables["z0"] in (1e-5, 1e-3)
    corners = [
        FrettingContact(PowerLawGraded(110e9, z0, k, 0.3), 5e-3, 10.0, 0.4).wear_volume(1.0)
        for z0 in (1e-5, 1e-3)
        for k in np.linspace(-0.5, 0.5, 101)
    ]
    assert best.wear_volume <= min(float(v) for v in corners) * (1 + 1e-14)


def test_design_of_z0_alone():
    best = optimise.design(
        FrettingContact(PowerLawGraded(110e9, 1e-4, 0.3, "holl"), 5e-3, 10.0, 0.4), 1.0, {"z0": (1e-5, 1e-3)}
    )
    # d ln V/d ln z0 = 4k/(k+3) > 0: the smallest depth, the stiffest material.
    assert best.variables == {"z0": 1e-5}


def test_minimise_finds_the_deeper_of_two_valleys():
    def two_valleys(x):
        return 2.0 + (x[0] ** 2 - 0.5) ** 2 + 0.1 * x[0] + (x[1] - 0.25) ** 2

    found = jax.jit(
        lambda: optimise.minimise(two_valleys, jnp.array([-1.0, -1.0]), jnp.array([1.0, 1.0]), samples=33)
    )()
    assert float(found.variables[0]) == pytest.approx(-0.730893, abs=1e-6)  # 4x^3 - 2x + 0.1 = 0
    assert float(found.variables[1]) == pytest.approx(0.25, abs=1e-6)
    assert found.side.tolist() == [0, 0]
    assert bool(found.certified)


def test_a_descent_that_is_cut_short_says_so():
    def valley(x):
        return jnp.exp(jnp.sin(9.0 * x[0])) + x[0] ** 2

    found = jax.jit(lambda: optimise.minimise(valley, jnp.array([-1.0]), jnp.array([1.0]), samples=5, max_steps=1))()
    assert not bool(found.converged)
    assert not bool(found.certified)
    assert found.projected_gradient > 1e-6
