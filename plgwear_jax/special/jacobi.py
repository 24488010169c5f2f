"""Pressures of the contact: what one coefficient each, of J_(2n+s)(q) q^-s in the Hankel domain, is elsewhere."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.xla import materialised

from .gamma import RECIPROCAL_GAMMA


def gamma(x: Array) -> Array:
    """Gamma(x) for 0 < x <= 2.5, by a polynomial: derivatives of `lax.lgamma` take XLA seconds to compile."""
    # Not by `polynomial`, which is faster for many numbers, but ten times as many operations to compile.
    terms, shape = np.asarray(RECIPROCAL_GAMMA, x.dtype), (*x.shape, len(RECIPROCAL_GAMMA))
    t, n = jnp.broadcast_to((x[..., None] - 0.75) / 1.25, shape), np.broadcast_to(np.arange(terms.size), shape)
    return 1.0 / (x * materialised(jnp.sum(terms * lax.pow(t, n), -1)))


def ratios(first: Any, above: Any, below: Any, count: int) -> Array:
    """first (above)_n/(below)_n for n < count, by rising factorials."""
    n = np.arange(count - 1, dtype=below.dtype)
    # By a sum of logarithms, whose derivative is a sum, not by a product; by a matrix, which XLA compiles fast.
    before = np.tri(count, count - 1, -1, below.dtype)
    return first * jnp.exp(before @ jnp.log((above + n) / (below + n)))


def power_matrix(k: Array, s: Array, count: int) -> Array:
    """The integrals of J_(2n+s) J_(2m+s) x^(k-2s) over all x > 0, shape (count, count)."""
    power, a, b = 2.0 * s - k, s + 0.5 * (1.0 - k), 0.5 * (1.0 + k)
    number = np.arange(count)
    # All four at once, since XLA compiles the polynomial each time.
    of_power, of_a, of_b, of_end = jnp.unstack(gamma(jnp.stack([power, a, b, 2.0 * s + 1.0 - b])))
    # 1/(Gamma(a+d) Gamma(a-d)) and Gamma(j+b)/Gamma(j+2s+1-b).
    turned = ratios((a - 1.0) / a, 2.0 - a, 1.0 + a, count - 1) * jnp.asarray((-1.0) ** (number[1:] - 1), s.dtype)
    difference = jnp.append(1.0, turned) / of_a**2
    total = ratios(of_b / of_end, b, 2.0 * s + 1.0 - b, 2 * count - 1)
    front = of_power * jnp.exp2(-power)
    return front * difference[abs(number[:, None] - number)] * total[number[:, None] + number]


def jacobi_table(count: int, s: Any, c: Any, x: Any) -> Array:
    """2F1(-n, n+s; c; (1-x)/2) for n < count and x of shape (m,), shape (count, m)."""
    below, along = c - 1.0, s - c
    n = np.arange(1, count - 1, dtype=s.dtype)
    m, below_all = 2.0 * n + s, (n + s) * (c + n)
    shift = (below - along) * (s - 1.0) / (m - 1.0)
    by_now = (0.5 * m / below_all)[:, None] * ((m + 1.0)[:, None] * x + shift[:, None])
    by_before = n * (n + along) * (m + 1.0) / (m - 1.0) / below_all

    def step(state: tuple[Array, Array], by: tuple[Array, Array]) -> tuple[tuple[Array, Array], Array]:
        before, now = state
        after = by[0] * now - by[1] * before
        return (now, after), after

    first, second = jnp.ones_like(x), ((s + 1.0) * x + below - along) / (2.0 * c)
    return jnp.concatenate([jnp.stack([first, second]), lax.scan(step, (first, second), (by_now, by_before))[1]])
