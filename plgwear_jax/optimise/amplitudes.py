"""The amplitudes at which the best exponent, at a constant contact radius, leaves or reaches its bounds.

Three numbers are enough. For every exponent k the slope dV/dk changes its sign twice between phi = 0 and phi = 1, at
phi_1(k) from + to - and at phi_2(k) from - to +, and both rise with k:

    phi_1 from 0.0591 at k -> -1 to 0.3855 at k -> 1,      phi_2 from 0.9796 to 0.9972

So the best exponent is the lower bound up to phi_1(lower), then rises continuously, and is the upper bound from
phi_1(upper) on. From phi_2(lower) to phi_2(upper) the wear has a maximum between the two bounds. At one amplitude there
both bounds wear the same, and the best exponent jumps back to the lower one. There are never more than two minima, and
where there are two, they are the bounds. (Found by scanning and tested, not proved.)
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting
from plgwear_jax._core.domains import Domain, check_bounds, real_dtype
from plgwear_jax._core.record import record

__all__ = ["CriticalAmplitudes", "critical_amplitudes"]

_CLOSED = Domain("-1 <= k <= 1", lambda k: (k >= -1.0) & (k <= 1.0))


@record
class CriticalAmplitudes:
    """Force amplitudes phi = F_x/(mu F_N) between which the best exponent is a bound, in the shape of the bounds.

    Attributes:
        leaves_lower: Up to here the lower bound is best, dV/dk = 0 there; then the best exponent rises with phi.
        reaches_upper: From here on the upper bound is best, dV/dk = 0 there.
        ends_equal: Both bounds wear the same; from here on, close to gross slip, the lower one is best again.
    """

    leaves_lower: Array
    reaches_upper: Array
    ends_equal: Array


def critical_amplitudes(bounds: tuple[ArrayLike, ArrayLike] = (-1.0, 1.0)) -> CriticalAmplitudes:
    """The amplitudes at which the best exponent at a constant contact radius leaves a bound, Eq. (28).

    Each exists and is unique for all bounds. (The bounds also wear the same at an amplitude between the first two, but
    there an exponent between them wears less.) Differentiable in the bounds by the implicit function theorem.

    Args:
        bounds: Lowest and highest exponent allowed, -1 <= lowest < highest <= 1, which broadcast; -1 and 1 are the
            limits k -> -1 and k -> 1.

    Returns:
        The three amplitudes, to rounding error.

    Raises:
        ValueError: A concrete bound is outside its range, or not below the other. Under `jit` the result is NaN there.

    Example:
        >>> from plgwear_jax import optimise
        >>> at = optimise.critical_amplitudes()
        >>> print(f"{at.leaves_lower:.6f} {at.reaches_upper:.6f} {at.ends_equal:.6f}")
        0.059075 0.385545 0.992521
    """
    dtype = real_dtype("critical_amplitudes", bounds)
    working = jnp.promote_types(dtype, jnp.float32)
    check_bounds(bounds, _CLOSED, working)
    lower, upper = (jnp.asarray(bound, working) for bound in bounds)
    return CriticalAmplitudes(*(root.astype(dtype) for root in _critical(lower, upper)))


# For any k, dV/dk is positive at the first amplitude of each pair, negative at the second, and phi_1 or phi_2 between.
_FIRST, _SECOND = (0.05, 0.4), (0.998, 0.97)
# Nodes on [-1, 1] and weights; a mean of dV/dk is right to 1e-15, even over all exponents.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
# Nine give 12 digits or more for any bounds; each further one multiplies the number of digits by 1.5.
_SECANTS = 12


@jax.jit
def _critical(lower: Array, upper: Array) -> Array:
    lower, upper = jnp.broadcast_arrays(lower, upper)
    # As a factor NaN makes derivatives NaN too.
    allowed = jnp.where(_CLOSED.contains(lower) & _CLOSED.contains(upper) & (lower < upper), 1.0, jnp.nan)
    return _roots(*(_in_between(bound * allowed).ravel() for bound in (lower, upper))).reshape(3, *lower.shape)


def _in_between(k: Array) -> Array:
    """The exponent, or the number next to it where it is -1 or 1, where the formulas cannot be evaluated."""
    most = 1.0 - jnp.finfo(k.dtype).epsneg
    return k + jax.lax.stop_gradient(jnp.clip(k, -most, most) - k)


@jax.custom_jvp
def _roots(lower: Array, upper: Array) -> Array:
    """The three amplitudes for each pair of bounds, shape (3, n)."""
    # V(upper) - V(lower) is the mean of dV/dk times the width. So all three are roots of such means, and the
    # difference of the two volumes loses no digits between near bounds.
    first, last = jnp.stack([lower, upper, lower]), jnp.stack([lower, upper, upper])
    nodes, weights = (jnp.asarray(values, lower.dtype) for values in (_NODES, _WEIGHTS))
    k = first[..., None] + (last - first)[..., None] * (0.5 + 0.5 * nodes)

    def mean_slope(phi: Array) -> Array:
        # Divided by the volume at k = 1, which is phi^2/(1 - phi) up to a factor: then it is nearly linear in phi.
        return _by_k(k, jnp.broadcast_to(phi[..., None], k.shape)) @ weights * (1.0 - phi) / (phi * phi)

    above, below = (jnp.broadcast_to(jnp.array(ends, k.dtype)[:, None], first.shape) for ends in _BRACKETS)
    return _bracketed_root(mean_slope, above, below)


_BRACKETS = tuple(zip(_FIRST, _FIRST, _SECOND, strict=True))


class _Bracket(NamedTuple):
    """Two points with a root between them, the newer one first, and the best point so far."""

    here: Array
    f_here: Array
    behind: Array
    f_behind: Array
    best: Array
    f_best: Array


def _bracketed_root(f: Callable[[Array], Array], above: Array, below: Array) -> Array:
    """The root of each element of f, positive at one end and negative at the other, by the Illinois method."""

    def secant(_, at: _Bracket) -> _Bracket:
        rise = at.f_here - at.f_behind
        step = at.f_here * (at.behind - at.here) / jnp.where(rise == 0.0, 1.0, rise)
        there = at.here + jnp.where(rise == 0.0, 0.0, step)
        f_there = f(there)
        same = jnp.sign(f_there) == jnp.sign(at.f_here)
        # The value at an end that stays is halved, so that the next secant crosses to its side.
        behind, f_behind = jnp.where(same, at.behind, at.here), jnp.where(same, 0.5 * at.f_behind, at.f_here)
        # Later secants follow rounding errors and may move away from the root again.
        better = jnp.abs(f_there) < jnp.abs(at.f_best)
        best, f_best = jnp.where(better, there, at.best), jnp.where(better, f_there, at.f_best)
        return _Bracket(there, f_there, behind, f_behind, best, f_best)

    # Rough values at the ends are good enough, and the program then contains f only once.
    rough = jnp.full_like(above, 0.1)
    unknown = jnp.full_like(above, jnp.inf)
    return jax.lax.fori_loop(0, _SECANTS, secant, _Bracket(below, -rough, above, rough, above * jnp.nan, unknown)).best


@_roots.defjvp
def _roots_jvp(primals, tangents):
    """The implicit functions: V_kk dk + V_kphi dphi = 0 at each bound, and dV(upper) = dV(lower)."""
    at_lower, at_upper, equal = roots = _roots(*primals)
    k, turning, equal = (jnp.concatenate(pair) for pair in (primals, (at_lower, at_upper), (equal, equal)))
    bend = _along(lambda k: _by_k(k, turning), k)
    twist = _along(lambda phi: _by_k(k, phi), turning)
    slope = _by_k(k, equal)
    rise = _along(lambda phi: fretting.wear_volume(k, phi), equal)

    # As products of matrices, which XLA does not fuse with the four factors: fused, compiling takes three times as
    # long.
    def coefficients(which: np.ndarray, *parts: Array) -> Array:
        return jnp.asarray(which, k.dtype) @ jnp.concatenate(parts).reshape(4, -1)

    by_lower, by_upper = (coefficients(_EQUATIONS * at, bend, slope) for at in ([1, 0, 1, 0], [0, 1, 0, 1]))
    by_phi = coefficients(_EQUATIONS, twist, rise)
    return roots, -(by_lower * tangents[0] + by_upper * tangents[1]) / by_phi


# A row for each of the three amplitudes: the factors of two numbers at the lower and the upper bound.
_EQUATIONS = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 1]])


def _by_k(k: Array, phi: Array) -> Array:
    """dV/dk."""
    return _along(lambda k: fretting.wear_volume(k, phi), k)


def _along(f: Callable[[Array], Array], x: Array) -> Array:
    """The derivative of each element of f."""
    return jax.jvp(f, (x,), (jnp.ones_like(x),))[1]
