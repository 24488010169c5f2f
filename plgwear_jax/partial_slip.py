"""Displacement amplitude, slip, energy and loop in a cycle of the unworn contact under partial slip, without units.

The tangential traction is mu times the difference of two normal pressures of the same indenter, with the contact radii
a_0 and c (Ciavarella 1998, Jaeger 1998). Every tangential displacement is mu theta times the normal one, with theta of
`material.tangential_ratio`. Radii are in units of a_0, phi = F_x/(mu F_N) is the amplitude.
"""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, NOT_NEGATIVE, NUMBER, ArrayLike, Domain
from plgwear_jax._core.formula import formula
from plgwear_jax.fretting import stick_radius
from plgwear_jax.fretting.surface import arc_between
from plgwear_jax.special.elementary import exponentials, exponents, in_dtype, log, log_complement

__all__ = [
    "amplitude",
    "contact_share",
    "displacement_amplitude",
    "energy_per_cycle",
    "energy_ratio",
    "loop_aperture",
    "slip_amplitude",
]

SHARE = Domain("0 <= displacement < 1, beyond which the slip is gross", AMPLITUDE.contains)


@formula(k=EXPONENT, phi=AMPLITUDE, compliance=NUMBER)
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

    Examples:
        >>> from plgwear_jax import partial_slip
        >>> print(f"{partial_slip.displacement_amplitude(0.0, 0.488):.6f}")
        0.360000

    References:
        `docs/explanation/numerics.md`, "Wear over cycles". For k = 0: Mindlin, Journal of Applied Mechanics 16 (1949)
        259.
    """
    s, _ = exponents(k)
    phi, compliance = jnp.asarray(phi), jnp.asarray(compliance)
    contact = -exponentials(log_complement(phi, digits) / (1.0 + s), digits)[1]
    return (contact + compliance * phi) / (1.0 + compliance)


@formula(k=EXPONENT, displacement=SHARE, compliance=NUMBER)
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

    Examples:
        >>> from plgwear_jax import partial_slip
        >>> displacement = partial_slip.displacement_amplitude(0.3, 0.4)
        >>> print(f"{partial_slip.amplitude(0.3, displacement):.6f}")
        0.400000

    References:
        `docs/explanation/numerics.md`, "Wear over cycles".
    """
    power, compliance = 0.5 * (3.0 + jnp.asarray(k)), jnp.asarray(compliance)
    log_square = _log_square(digits, log_complement(jnp.asarray(displacement), digits), power, compliance)
    return 0.0 - exponentials(power * log_square, digits)[1]  # not -0


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _log_square(digits: int | None, goal: Array, power: Array, compliance: Array) -> Array:
    """x = log(c^2), at which log((e^x + X e^(power x))/(1 + X)) has reached its goal."""
    goal, power, compliance = jnp.broadcast_arrays(goal, power, compliance)
    far, near = 1.0 / (1.0 + compliance), compliance / (1.0 + compliance)
    # The function is convex, with slopes from 1 to 2. Each of its terms alone gives an upper bound of x, and so does
    # the tangent at 0, which keeps x <= 0: from above, Newton's steps would end above a root that is nearly 0.
    most = jnp.minimum(goal - jnp.log(far), (goal - jnp.log(near)) / power)

    def closer(_: int, x: Array) -> Array:
        one, other = exponentials(x, digits), exponentials(power * x, digits)
        here = far * one[0] + near * other[0]
        small = here < 0.5
        near_one = log_complement(jnp.where(small, 0.5, -(far * one[1] + near * other[1])), digits)
        residual = goal - jnp.where(small, log(jnp.where(small, here, 0.5), digits), near_one)
        return x + residual * here / (far * one[0] + power * near * other[0])

    return lax.fori_loop(0, 6, closer, jnp.minimum(most, goal / (far + power * near)))


@_log_square.defjvp
def _log_square_jvp(digits: int | None, primals: Any, tangents: Any) -> tuple[Array, Array]:
    (goal, power, compliance), (dgoal, dpower, dcompliance) = primals, tangents
    x, far = _log_square(digits, goal, power, compliance), 1.0 / (1.0 + compliance)
    # The second term over the first, and what that adds to 1.
    other, more = exponentials((power - 1.0) * x, digits)
    held = far * more * dcompliance + compliance * other * x * dpower
    return x, ((1.0 + compliance * other) * dgoal - held) / (1.0 + power * compliance * other)


@formula(r=NOT_NEGATIVE, k=EXPONENT, phi=AMPLITUDE)
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

    Examples:
        >>> from plgwear_jax import partial_slip
        >>> print(f"{partial_slip.slip_amplitude(0.95, 0.3, 0.4):.6f}")
        0.043774

    References:
        `docs/explanation/numerics.md`, "Wear over cycles".
    """
    r, k, phi = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi)
    s, q = exponents(k)
    c = stick_radius(k, phi)
    slips, y, at = arc_between(r, c, 1.0, s, q, digits)
    # The slip is mu theta times the gap outside the contact of radius c.
    return jnp.where(slips, 0.5 * c * c * at.share * y * at.chord, 0.0)


_Rule = tuple[np.ndarray, np.ndarray]


def _gauss(count: int) -> _Rule:
    """(Places, weights) of integrals from 0 to 1."""
    x, weight = np.polynomial.legendre.leggauss(count)
    return 0.5 + 0.5 * x, 0.5 * weight


# The integrands up to 3/4 have a pole at 4/3 or further away.
_POLES, _EXPONENTIAL = _gauss(17), _gauss(9)
_BESIDE_THE_EDGE = _POLES[0], _POLES[1] * _POLES[0] * (1.0 - _POLES[0])  # with the factor v (1-v)
_FAR = 0.75


def _integral(rule: _Rule, function: Callable[[Array], Array], like: Array) -> Array:
    """The integral over v from 0 to 1 of a function, whose last axis is that of v."""
    v, weight = in_dtype(like.dtype, *rule)
    return jnp.sum(weight * function(v), -1)


def _power(exponent: Array, x: Array, digits: int | None) -> Array:
    """(1 - x)^exponent, with an axis of its own for x."""
    return exponentials(exponent[..., None] * log_complement(x, digits), digits)[0]


def _work(s: Array, phi: Array, digits: int | None) -> tuple[Array, Array]:
    """(z = 1 - C, the integral of T^(s-1) (1-T) (T-C) over T from C = c^2 to 1, divided by z^2).

    The integral is proportional to energy and wear of the first cycle; its own powers of z might underflow.
    """
    log_c = log_complement(phi, digits) / (1.0 + s)
    z = 0.0 - exponentials(log_c, digits)[1]
    small = z < _FAR
    near = jnp.where(small, z, 0.5)[..., None]
    mean = _integral(_BESIDE_THE_EDGE, lambda v: _power(s - 1.0, near * v, digits), z)
    # From powers of C, (1 - C^(s+i))/(s+i). For i = 0 and small s it is -log(C) times the integral of C^(s x) over x.
    log_c = jnp.where(small, -1.5, log_c)
    C = jnp.exp(log_c)
    falls = [-exponentials((s + i) * log_c, digits)[1] / (s + i) for i in range(3)]
    close = s * log_c > -1.0
    some = jnp.where(close, s * log_c, -0.5)[..., None]
    power = _integral(_EXPONENTIAL, lambda x: exponentials(some * x, digits)[0], z)
    falls[0] = jnp.where(close, -log_c * power, falls[0])
    far, beyond = (1.0 + C) * falls[1] - C * falls[0] - falls[2], jnp.where(small, 0.5, z)
    return z, jnp.where(small, mean * z, far / (beyond * beyond))


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

    Examples:
        >>> from plgwear_jax import partial_slip
        >>> print(f"{partial_slip.energy_per_cycle(0.3, 0.4):.6f}")
        0.010926

    References:
        `docs/explanation/numerics.md`, "Wear over cycles". For k = 0: Mindlin and Deresiewicz, Journal of Applied
        Mechanics 20 (1953) 327.
    """
    s, _ = exponents(k)
    z, work = _work(s, jnp.asarray(phi), digits)
    return 2.0 * (1.0 + s) * z * z * work


# --- the loop of force and displacement -----------------------------------------------------------------------------


def softness(s: Array, phi: Array, digits: int | None) -> Array:
    """(1 - c^2)/phi, the displacement over the force: 1/(1 + s) for no force, and 1 at gross slip."""
    small = phi < _FAR
    near = jnp.where(small, phi, 0.5)[..., None]
    mean = _integral(_POLES, lambda v: _power(-s / (1.0 + s), near * v, digits), phi)
    far = jnp.where(small, 0.5, phi)
    at = -exponentials(log_complement(far, digits) / (1.0 + s), digits)[1] / far
    return jnp.where(small, mean / (1.0 + s), at)


@formula(k=EXPONENT, phi=AMPLITUDE, compliance=NUMBER)
def contact_share(k: ArrayLike, phi: ArrayLike, compliance: ArrayLike, *, digits: int | None = None) -> Array:
    """Share of the contact in the displacement amplitude at the actuator of a rig; the rig itself has the rest.

    `energy_ratio` and `loop_aperture` times this share are those of the loop that is measured at the actuator: what the
    rig gives way is elastic, and adds to the displacement amplitude alone.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        compliance: Rig compliance X, see `displacement_amplitude`.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The share, broadcast over all arguments, in (0, 1]: at phi = 0 that of the first motion, and towards gross slip
        1/(1 + X).

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import partial_slip
        >>> print(f"{partial_slip.contact_share(0.0, 0.4, 1.0):.6f}")
        0.419129

    References:
        `docs/explanation/numerics.md`, "Wear over cycles".
    """
    s, _ = exponents(k)
    alone = softness(s, jnp.asarray(phi), digits)
    return alone / (alone + jnp.asarray(compliance))


@formula(k=EXPONENT, phi=AMPLITUDE)
def energy_ratio(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Energy lost in a cycle over 4 F_x u_x, the area of the rectangle around the loop of the unworn contact.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The ratio, broadcast over k and phi: (1+k)/(3+k) phi/6 for small phi, and (1+k)/(5+k) towards gross slip, which
        is the 0.2 of laboratories at k = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import partial_slip
        >>> print(f"{partial_slip.energy_ratio(0.0, 0.4):.6f}")
        0.028202

    References:
        Fouvry, Kapsa and Vincent, Wear 185 (1995) 35-46, who take 0.2 as the border of gross slip.
    """
    (s, _), phi = exponents(k), jnp.asarray(phi)
    return s * (1.0 + s) * _work(s, phi, digits)[1] * softness(s, phi, digits)


@formula(k=EXPONENT, phi=AMPLITUDE)
def loop_aperture(k: ArrayLike, phi: ArrayLike, *, digits: int | None = None) -> Array:
    """Sliding ratio of the unworn contact: the displacement at no force over the displacement amplitude.

    Args:
        k: Exponent of the modulus, -1 < k < 1.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1.
        digits: Correct digits wanted; by default all that the dtype holds.

    Returns:
        The ratio, broadcast over k and phi: (1+k)/(3+k) phi/4 for small phi, and 2^((1+k)/(3+k)) - 1 towards gross
        slip, which is the 0.26 of laboratories at k = 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import partial_slip
        >>> print(f"{partial_slip.loop_aperture(0.0, 0.4):.6f}")
        0.042163

    References:
        Fouvry, Kapsa and Vincent, Wear 185 (1995) 35-46, who take 0.26 as the border of gross slip.
    """
    s, _ = exponents(k)
    return loop_opening(s, jnp.asarray(phi), digits)


def loop_opening(s: Array, phi: Array, digits: int | None) -> Array:
    """The `loop_aperture`, by s = (1 + k)/2: Masing's rule, u(F_x) - 2 u(F_x/2)."""
    e = s / (1.0 + s)
    small = phi < _FAR
    # The second half of the force moves the contact by more than the first: by so much over the force.
    near = 0.5 * jnp.where(small, phi, 0.5)[..., None]

    def opened(v: Array) -> Array:
        more = log_complement(near / (1.0 - near * v), digits)
        return _power(-e, near * v, digits) * exponentials(-e[..., None] * more, digits)[1]

    opening = 0.5 / (1.0 + s) * _integral(_POLES, opened, phi)
    # The same from powers, each as the difference from what it would be for s = 0, where no loop opens.
    far = jnp.where(small, 0.5, phi)
    half, whole = (exponentials(-e * log_complement(x, digits), digits)[1] for x in (0.5 * far, far))
    far = ((2.0 - far) * half - (1.0 - far) * whole) / far
    return jnp.where(small, opening, far) / softness(s, phi, digits)
