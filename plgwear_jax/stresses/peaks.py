"""Where a stress is largest before any wear, and how large it is."""

from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax.special.pchip import Piecewise
from plgwear_jax.stresses.field import Pressed, Stress, body_of, field


class Peak(NamedTuple):
    """The largest value of a stress in Pa, and where in m."""

    value: Array
    x: Array
    z: Array


# In units of a_0: the edges of the contact are places of the grid, where the tension of a homogeneous one has its peak.
_X = np.concatenate([[-1.5, -1.2], np.linspace(-1.0, 1.0, 17), [1.2, 1.5]])
_Z = np.array([0.0, 3e-3, 0.015, 0.06, 0.15, 0.3, 0.5, 0.75, 1.1, 1.6, 2.2, 3.0])
_AROUND = np.linspace(-1.0, 1.0, 7)
_ROUNDS = 3  # each of which divides the distance to the peak by 3


def peak(pressed: Pressed, kind: type | None, wanted: Callable[[Stress], Array], least: Array, most: Array) -> Peak:
    """The largest value of what is wanted of the stresses of one contact, between two depths in m.

    On a grid, then on finer ones around the best place, which is one in units of a_0 as the derivatives go. Depths of
    both sides of each interface are among those of all grids, and move with it.
    """
    dtype, zero = pressed.force.dtype, jnp.zeros_like(pressed.force)
    body = body_of(pressed, kind)
    sides = _sides(body, dtype)
    low = least / pressed.radius
    high = jnp.maximum(low, jnp.minimum(most, _Z[-1] * pressed.radius) / pressed.radius)

    def depths(z: Array) -> Array:
        return jnp.clip(jnp.append(lax.stop_gradient(z), sides), low, high)

    def best(x: Array, z: Array) -> tuple[Array, Array]:
        found = wanted(field(still, kind, False, x, z[:, None]))
        at = jnp.argmax(jnp.where(jnp.isnan(found), -jnp.inf, found))
        return at % x.size, at // x.size

    still = lax.stop_gradient(pressed)
    x, z = jnp.asarray(_X, dtype), jnp.asarray(_Z, dtype)
    at_x, at_z = best(x, depths(z))
    begin = x[at_x], depths(z)[at_z], jnp.asarray(0.12, dtype)

    def closer(_: int, state: tuple[Array, ...]) -> tuple[Array, ...]:
        x, z, reach = state
        wide = jnp.minimum(reach, 0.5 * z + 1e-3 * reach)  # nearer to the surface by smaller steps
        xs, zs = (
            x + reach * jnp.asarray(_AROUND, dtype),
            lax.stop_gradient(depths(z + wide * jnp.asarray(_AROUND, dtype))),
        )
        at_x, at_z = best(xs, zs)
        return xs[at_x], zs[at_z], reach / 3.0

    x, z, _ = lax.stop_gradient(lax.fori_loop(0, _ROUNDS, closer, begin))
    moving = jnp.clip(jnp.append(sides, jnp.stack([low, high])), low, high)
    # At an interface or an end of the depths the peak moves with it.
    near = jnp.argmin(abs(moving - z))
    z = jnp.where(lax.stop_gradient(moving[near]) == z, moving[near], z)
    value = wanted(field(pressed, kind, False, x, z))
    if kind is None:  # the modulus of the surface is infinite
        unbounded = (pressed.body[0] < 0.0) & (low == 0.0)
        value, z = jnp.where(unbounded, jnp.inf, value), jnp.where(unbounded, zero, z)
    return Peak(value, x * pressed.radius, z * pressed.radius)


def _sides(body: object, dtype: jnp.dtype) -> Array:
    """Depths just above and below interfaces, in units of a_0."""
    if not isinstance(body, Piecewise):
        return jnp.zeros((0,), dtype)
    jumps = body.start[1:]
    return jnp.concatenate([jumps * (1.0 - 8.0 * jnp.finfo(dtype).eps), jumps])
