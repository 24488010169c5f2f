"""Worn volume and wear rate after n reduced cycles, and the cycles after which a share of the volume is worn."""

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax._startup.programs import program
from plgwear_jax.special.elementary import clamp_keep_slope
from plgwear_jax.special.root import first_at
from plgwear_jax.transient.batch import run_numbers
from plgwear_jax.transient.curves import RunCurves, curves_of, end_of, share_at


@program()
def volume_of(curves: RunCurves, k: Array, phi: Array, n: Array) -> Array:
    """The worn volume after n reduced cycles, read from the runs of all k and phi."""
    run = run_numbers(k, phi)
    return jnp.where(phi > 0.0, curves.scales.volume[run] * share_at(curves.shares, run, n), 0.0)


@program()
def rate_of(curves: RunCurves, k: Array, phi: Array, n: Array) -> Array:
    """The wear rate dV/dn at n, read from the runs of all k and phi."""
    n = jnp.broadcast_to(n, jnp.broadcast_shapes(k.shape, phi.shape, n.shape))
    return clamp_keep_slope(0.0, jax.jvp(lambda n: volume_of(curves, k, phi, n), (n,), (jnp.ones_like(n),))[1])


@program()
def cycles_of(curves: RunCurves, k: Array, phi: Array, share: Array) -> Array:
    """The reduced cycles n after which a share of the final volume is worn, read from the runs of all k and phi."""
    run = run_numbers(k, phi)
    found = first_at(lambda shares, n: share_at(shares, run, n), curves.shares, share, end_of(curves, run))
    return jnp.where(phi > 0.0, found, jnp.nan)


def wear_volume(k: Array, phi: Array, n: Array, digits: int | None) -> Array:
    """The worn volume after n reduced cycles, by runs to these digits."""
    return volume_of(curves_of(k, phi, digits), k, phi, n)
