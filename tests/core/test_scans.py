"""Second derivatives of loops that contain closed forms: what JAX loses, and what keeps it."""

import jax
import jax.numpy as jnp
import pytest
from functions import by_numpy
from marks import parametrize
from numpy.testing import assert_allclose

from plgwear_jax import fretting

AT = jnp.array([0.9, 0.2])


def step(phi, x):
    return fretting.penetration(x[1], x[0] * phi) * phi, None


def looped(body):
    return lambda x: jax.lax.scan(body, jnp.asarray(0.5), jnp.tile(x, (2, 1)))[0]


def unrolled(x):
    phi = jnp.asarray(0.5)
    for _ in range(2):
        phi, _ = step(phi, x)
    return phi


@pytest.fixture(scope="module")
def expected():
    return by_numpy(jax.hessian(unrolled))(AT)


@parametrize("outer", [jax.jacfwd, jax.jacrev])
def test_second_derivatives_of_a_loop_that_keep_the_rules(expected, outer):
    assert_allclose(by_numpy(outer(jax.jacfwd(looped(step))))(AT), expected, rtol=1e-10)


@pytest.mark.xfail(
    jax.__version_info__ < (0, 12),
    reason="JAX loses rules of differentiation in loops: docs/how-to/in_your_model.md",
    strict=True,
)
def test_second_derivatives_of_a_loop_that_begin_in_reverse(expected):
    """Where this passes, the page has to say so."""
    assert_allclose(by_numpy(jax.hessian(looped(step)))(AT), expected, rtol=1e-6)
