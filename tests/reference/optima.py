"""The best exponents at a few amplitudes, for all tests by the same program: each length is compiled anew."""

import jax
import jax.numpy as jnp

from plgwear_jax import optimise

LENGTH = 500


def optima(phi, bounds=(-0.95, 0.95)):
    phi = jnp.atleast_1d(jnp.asarray(phi))
    filled = jnp.pad(phi, (0, -phi.size % LENGTH), constant_values=0.5)
    lower, upper = (jnp.resize(jnp.asarray(bound, phi.dtype), filled.size) for bound in bounds)
    return jax.tree.map(lambda leaf: leaf[: phi.size], optimise.optimal_exponent(filled, (lower, upper)))
