"""Where a stress is largest before any wear, and how large it is."""

from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax.special.pchip import Piecewise
from plgwear_jax.stresses.field import Half, Pressed, Stress, body_of, field


class Peak(NamedTuple):
    """The largest value of a stress in Pa, and where in m."""

    value: Array
    x: Array
    z: Array


# In units of a_0: the edges of the contact are places of the grid, where the tension of a homogeneous one has its peak.
_X = np.array([-1.5, -1.15, -1.0, -0.85, -0.6, -0.3, 0.0, 0.3, 0.6, 0.85, 1.0, 1.15, 1.5])
_Z = np.array([0.0, 3e-3, 0.015, 0.06, 0.15, 0.28, 0.4, 0.55, 0.75, 1.0, 1.4, 2.0, 3.0])
_AROUND, _REACH, _CLOSER = np.linspace(-1.0, 1.0, 13), 0.17, 4.5
_ROUNDS = 4


def peak(pressed: Pressed, kind: Half, wanted: Callable[[Stress], Array], least: Array, most: Array) -> Peak:
    """The largest value of what is wanted of the stresses of one contact, between two depths in m.

    On a grid, then on finer ones around the best place. This is one in units of a_0 as the derivatives go, but for the
    depths of both sides of each interface, which are among those of all grids, and for the ends of the depths.
    """
    dtype, still = pressed.force.dtype, lax.stop_gradient(pressed)
    low = least / pressed.radius
    high = jnp.maximum(low, jnp.minimum(most, _Z[-1] * pressed.radius) / pressed.radius)
    ends = jnp.clip(jnp.append(_sides(body_of(pressed, kind), dtype), jnp.stack([low, high])), low, high)
    around = jnp.asarray(_AROUND, dtype)

    def closer(count: int, state: tuple[Array, ...]) -> tuple[Array, ...]:
        del count
        xs, zs, reach = state[:3]
        zs = lax.stop_gradient(jnp.append(jnp.clip(zs, low, high), ends))
        found = wanted(field(still, kind, False, xs, zs[:, None]))
        at = jnp.argmax(jnp.where(jnp.isnan(found), -jnp.inf, found))
        x, z = xs[at % xs.size], zs[at // xs.size]
        # Nearer to the surface by smaller steps.
        next_z = z + jnp.minimum(reach, 0.5 * z + 1e-3 * reach) * around
        return x + reach * around, next_z, reach / _CLOSER, x, z

    begin = jnp.asarray(_X, dtype), jnp.asarray(_Z, dtype), jnp.asarray(_REACH, dtype), 0.0 * low, 0.0 * low
    *_, x, z = lax.stop_gradient(lax.fori_loop(0, _ROUNDS, closer, begin))
    near = ends[jnp.argmin(abs(lax.stop_gradient(ends) - z))]
    z = jnp.where(lax.stop_gradient(near) == z, near, z)
    value = wanted(field(pressed, kind, False, x, z))
    if kind is None:  # where the modulus of the surface is infinite
        unbounded = (pressed.body[0] < 0.0) & (low == 0.0)
        value, z = jnp.where(unbounded, jnp.inf, value), jnp.where(unbounded, 0.0, z)
    known = jnp.where(jnp.isnan(value), value, pressed.radius)
    return Peak(value, x * known, z * known)


def _sides(body: object, dtype: jnp.dtype) -> Array:
    """Depths just above and below interfaces, in units of a_0."""
    if not isinstance(body, Piecewise):
        return jnp.zeros(0, dtype)
    jumps = body.start[1:]
    return jnp.concatenate([jumps * (1.0 - 8.0 * jnp.finfo(dtype).eps), jumps])
