"""The profile of an indenter that is a power of the radius, as the contact of a radius c sees it."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

__all__ = ["Profile", "profile_of"]


class Profile(NamedTuple):
    """r^n/(n R^(n-1)), which in units of c^2/R is size c^(n-2) T^(n/2) with T = (r/c)^2."""

    exponent: Array
    log_size: Array  # of R^(2-n)/n

    def at(self, c: Array) -> Array:
        """The factor of T^(n/2)."""
        return jnp.exp(self.log_size + (self.exponent - 2.0) * jnp.log(c))

    def moments(self, s: Array, count: int) -> Array:
        """Those of T^(n/2) with the pressures of `jacobi`, shape (count,)."""
        p, j = 0.5 * self.exponent, jnp.asarray(np.arange(count - 1), s.dtype)
        steps = jnp.cumprod((j - p) / (p + 1.0 + s + j))
        first = jnp.exp(jnp.sum(jax.lax.lgamma(jnp.stack([1.0 + p, 1.0 + s]))) - jax.lax.lgamma(1.0 + p + s))
        return first * jnp.append(jnp.ones_like(s), steps)

    def lifted(self, a: Array) -> Array:
        """The factor of T^(n/2) that Abel's integral with the exponent a takes to T^(n/2)."""
        p = 0.5 * self.exponent
        return jnp.exp(jnp.sum(jax.lax.lgamma(jnp.stack([1.0 + p, a]))) - jax.lax.lgamma(p + a))

    def log_radius(self, log_load: Array, k: ArrayLike = 0.0) -> Array:
        """About the logarithm of the contact radius, for F_N R over the stiffness of one body."""
        n = self.exponent
        wide = jnp.log(0.5 * (n + 1.0 + k) / (n * self.lifted(jnp.full_like(n, 0.5))))
        return (log_load + wide - self.log_size) / (n + 1.0 + k)


def profile_of(exponent: Array, radius: Array) -> Profile:
    """That of an indenter with this exponent and R."""
    return Profile(exponent, (2.0 - exponent) * jnp.log(radius) - jnp.log(exponent))
