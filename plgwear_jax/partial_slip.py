"""Displacement amplitude, slip and energy in a cycle of the unworn contact under partial slip, without units.

The tangential traction is mu times the difference of two normal pressures of the same indenter, with the contact radii
a_0 and c (Ciavarella 1998, Jaeger 1998). Every tangential displacement is mu theta times the normal one, with theta of
`material.tangential_ratio`. Radii are in units of a_0, phi = F_x/(mu F_N) is the amplitude.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, RADIUS, Domain
from plgwear_jax._core.formula import formula
from plgwear_jax._punch import exponents
from plgwear_jax.fretting import stick_radius
from plgwear_jax.special.arcsine import arc
from plgwear_jax.special.elementary import exponentials, log, log_complement

__all__ = ["amplitude", "displacement_amplitude", "energy_per_cycle", "slip_amplitude"]

SHARE = Domain("0 <= displacement < 1, beyond which the slip is gross", AMPLITUDE.contains)
SOFTNESS = Domain("compliance >= 0 and finite", lambda x: (x >= 0.0) & (x < float("inf")))


@formula(k=EXPONENT, phi=AMPLITUDE, compliance=SOFTNESS)
def displacement_amplitude(
    k: ArrayLike, phi: ArrayLike, compliance: ArrayLike = 0.0, *, digits: int | None = None
) -> Array:
    """Amplitude of the tangential displacement at an amplitude of the tangential force: (1 - c^2 + X phi)/(1 + X).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        compliance: X >= 0, for a rig in series with the contact: the displacement of the rig under the force mu F_N,
            over the displacement of the contact at which gross slip begins.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The displacement over the displacement at which gross slip begins, broadcast over all arguments, in [0, 1).

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    s, _ = exponents(jnp.asarray(k))
    phi, compliance = jnp.asarray(phi), jnp.asarray(compliance)
    contact = -exponentials(log_complement(phi, digits) / (1.0 + s), digits)[1]
    return (contact + compliance * phi) / (1.0 + compliance)


@formula(k=EXPONENT, displacement=SHARE, compliance=SOFTNESS)
def amplitude(
    k: ArrayLike, displacement: ArrayLike, compliance: ArrayLike = 0.0, *, digits: int | None = None
) -> Array:
    """The amplitude phi of the force at an amplitude of the displacement: the inverse of `displacement_amplitude`.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        displacement: Displacement amplitude over the displacement at which gross slip begins, in [0, 1).
        compliance: Rig compliance X, see `displacement_amplitude`.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        phi, broadcast over all arguments, in [0, 1).

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    k, displacement, compliance = jnp.asarray(k), jnp.asarray(displacement), jnp.asarray(compliance)
    power = 0.5 * (3.0 + k)
    far, near = 1.0 / (1.0 + compliance), compliance / (1.0 + compliance)
    goal = log_complement(displacement, digits)
    # In x = log(c^2) the function log(far e^x + near e^(power x)) is convex, with slopes from 1 to 2, and has to equal
    # goal. Each of its two terms alone gives an upper bound of x, and so does the tangent at 0, which keeps x <= 0:
    # from above, Newton's steps would end above a root that is nearly 0. The last two steps carry the derivatives.
    most = jnp.minimum(goal - jnp.log(far), (goal - jnp.log(near)) / power)
    x = jax.lax.stop_gradient(jnp.minimum(most, goal / (far + power * near)))
    for step in range(6):
        one, other = exponentials(x, digits), exponentials(power * x, digits)
        here = far * one[0] + near * other[0]
        small = here < 0.5
        near_one = log_complement(jnp.where(small, 0.5, -(far * one[1] + near * other[1])), digits)
        residual = goal - jnp.where(small, log(jnp.where(small, here, 0.5), digits), near_one)
        x = x + residual * here / (far * one[0] + power * near * other[0])
        x = jax.lax.stop_gradient(x) if step < 4 else x
    return -exponentials(power * x, digits)[1]


@formula(r=RADIUS, k=EXPONENT, phi=AMPLITUDE)
def slip_amplitude(r: ArrayLike, k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Amplitude of the slip between the surfaces in the ring c < r < 1, where the unworn contact slips.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The slip in units of mu theta a_0^2/R, broadcast over all arguments: 0 where the contact sticks, and 0 beyond
        r = 1, where the surfaces do not touch.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    c = stick_radius(k, phi)
    slips = (r > c) & (r <= 1.0)
    near = jnp.where(slips, r, 1.25 * c)
    y = ((near - c) / c) * ((near + c) / c)
    at = arc(y, s, q, digits)
    # The slip is mu theta times the gap outside the contact of radius c.
    return jnp.where(slips, 0.5 * c * c * at.share * y * at.chord, 0.0)


# Gauss rules from 0 to 1: with 17 nodes for the integral below up to z = 3/4, whose integrand then has a pole at
# v = 4/3, and with 9 nodes for an exponential.
_V, _WEIGHT = (0.5 + 0.5 * np.polynomial.legendre.leggauss(17)[0], 0.5 * np.polynomial.legendre.leggauss(17)[1])
_X, _OF_X = (0.5 + 0.5 * np.polynomial.legendre.leggauss(9)[0], 0.5 * np.polynomial.legendre.leggauss(9)[1])


def ring_work(s: Array, phi: Array, digits: int | None) -> Array:
    """Integral of T^(s-1) (1-T) (T-C) over T from C = c^2 to 1: proportional to energy and wear of the first cycle."""
    log_c = log_complement(phi, digits) / (1.0 + s)
    z = -exponentials(log_c, digits)[1]  # 1 - C
    small = z < 0.75
    # z^3 times the integral of v (1-v) (1 - z v)^(s-1) over v from 0 to 1.
    near = jnp.where(small, z, 0.5)
    v, weight = jnp.asarray(_V, z.dtype), jnp.asarray(_WEIGHT * _V * (1.0 - _V), z.dtype)
    powers = exponentials((s[..., None] - 1.0) * log_complement(near[..., None] * v, digits), digits)[0]
    near = near * near * near * jnp.sum(weight * powers, -1)
    # From powers of C, (1 - C^(s+i))/(s+i). For i = 0 and small s it is -log(C) times the integral of C^(s x) over x.
    log_c = jnp.where(small, -1.5, log_c)
    C = jnp.exp(log_c)
    falls = [-exponentials((s + i) * log_c, digits)[1] / (s + i) for i in range(3)]
    close = s * log_c > -1.0
    x, weight = jnp.asarray(_X, z.dtype), jnp.asarray(_OF_X, z.dtype)
    mean = jnp.sum(weight * exponentials((jnp.where(close, s * log_c, -0.5))[..., None] * x, digits)[0], -1)
    falls[0] = jnp.where(close, -log_c * mean, falls[0])
    far = (1.0 + C) * falls[1] - C * falls[0] - falls[2]
    return jnp.where(small, near, far)


@formula(k=EXPONENT, phi=AMPLITUDE)
def energy_per_cycle(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Energy lost in a cycle of the unworn contact; at k = 0 the result of Mindlin and Deresiewicz (1953).

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The energy in units of mu^2 theta F_N a_0^2/R, broadcast over k and phi; 0 at phi = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    s, _ = exponents(jnp.asarray(k))
    return 2.0 * (1.0 + s) * ring_work(s, jnp.asarray(phi), digits)
