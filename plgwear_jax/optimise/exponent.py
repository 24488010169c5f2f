"""The exponent that wears least at a constant contact radius, and the amplitudes at which it leaves its bounds."""

import functools
import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax import fretting
from plgwear_jax._core.domains import (
    AMPLITUDE,
    EXPONENT,
    POISSON_RATIO,
    POSITIVE,
    ArrayLike,
    Domain,
    check,
    check_all,
    check_bounds,
    check_digits,
    nan_unless,
    record,
)
from plgwear_jax._core.startup.programs import follows, program, traced, with_slopes
from plgwear_jax.material import tangential_ratio
from plgwear_jax.special.elementary import clamp_keep_slope, in_dtype, value_with_slope, with_digits
from plgwear_jax.special.root import first_at

from .ask_and_tell import plan_of
from .scenarios import nodes_between, shares_of_nodes
from .search import Interval, Minimum, found_by, minimise, rows_at


@record
class OptimalExponent:
    """The exponent that wears least at an amplitude, in the shape of the amplitude.

    Attributes:
        k: The exponent.
        wear_volume: Its wear volume in units of a_0^4/R.
        at_bound: It lies on one of the bounds.
        converged: The search ended at a minimum.
        certified: Converged, and no scanned exponent and no other minimum that was found wears less: no proof.
        scan_found_nothing_better: No exponent between two scanned ones is expected to wear less; no proof, see
            `Minimum`.
        rival: The next best minimum, such as the other end near gross slip; NaN if there is none.
        rival_wear_volume: The wear volume there; infinite if there is none.
    """

    k: Array
    wear_volume: Array
    at_bound: Array
    converged: Array
    certified: Array
    scan_found_nothing_better: Array
    rival: Array
    rival_wear_volume: Array


def optimal_exponent(
    phi: ArrayLike,
    bounds: tuple[ArrayLike, ArrayLike] = (-0.95, 0.95),
    *,
    life: ArrayLike | None = None,
    nu: ArrayLike | None = None,
    digits: int | None = None,
) -> OptimalExponent:
    """The exponent k that wears least at the amplitude phi, at a constant contact radius, Eq. (28), or in a life.

    When k changes, x = n/theta = 4 K mu F_N N/(pi a_0^2) stays the same, and not the reduced number of cycles n. Long
    before the steady state the stiff surface wears least at every amplitude. Differentiable in phi and the bounds, with
    a life also in life and nu: k by the implicit function theorem, the volume by the envelope theorem.

    Args:
        phi: Force amplitude F_x/(mu F_N), 0 <= phi < 1, of any shape; one call finds the optimum for each.
        bounds: Lowest and highest exponent allowed, -1 < lowest < highest < 1.
        life: x, positive and finite, of any shape that goes with that of phi; None for the steady state. All lives of
            an amplitude come from the same runs of the transient.
        nu: Poisson's ratio, -1 < nu <= 1/2, which a life needs and the steady state does not; a number or an array.
        digits: Correct digits wanted of the wear volume; by default all that the dtype holds, with a life 4.

    Returns:
        The optimum for each amplitude and life. At phi = 0 nothing wears, and k is the lower bound, the limit for
        phi -> 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import optimise
        >>> best = optimise.optimal_exponent(jnp.array([0.1, 0.9]), bounds=(-0.5, 0.5))
        >>> print(best.k)  # stiff surface for small amplitudes, compliant for large ones
        [-0.5  0.5]

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: the least of Eq. (28).
    """
    check("phi", phi, AMPLITUDE)
    if (life is None) != (nu is None):
        raise TypeError("life and nu go together: n/theta depends on Poisson's ratio, the steady state does not")
    of_life: Any = () if life is None else (life, nu)
    if of_life:
        check_all(("life", "nu"), of_life, (POSITIVE, POISSON_RATIO))
    dtype = check_bounds(bounds, EXPONENT, phi, *of_life)
    digits = check_digits(digits, dtype)
    values = in_dtype(dtype, phi, *bounds, *of_life)
    few = 0 < np.prod(np.broadcast_shapes(*(value.shape for value in values))) <= _FEW
    if few and not (of_life or traced(values)):
        return _few_optimal_exponents(values, digits)
    find = with_slopes(_many_optimal_exponents) if follows(values) else _many_optimal_exponents.part
    return find(digits, *values)


_FEW = 32  # up to so many amplitudes, one by one is faster than compiling a program for all of them


def _few_optimal_exponents(values: list[Array], digits: int | None) -> OptimalExponent:
    phi, lower, upper = np.broadcast_arrays(*map(np.asarray, values))
    plan = plan_of(1, 0, phi.dtype, noise=digits and 10.0**-digits)

    def one(phi: Any, *bounds: Any) -> OptimalExponent:
        wear = functools.partial(_wear, phi=phi, digits=digits)
        return _exponent_of(found_by(wear, {"k": Interval(*bounds)}, plan))

    found = map(one, phi.ravel(), lower.ravel(), upper.ravel())
    # Unlike `jnp.asarray` it compiles nothing.
    return jax.device_put(jax.tree.map(lambda *each: np.reshape(each, phi.shape), *found))


@with_digits
def _wear(variables: dict[str, Array], *, phi: Array, digits: int | None) -> Array:
    """The wear volume at several exponents and its slope, (lanes, 1, 2)."""
    return rows_at(lambda k, phi: fretting.wear_volume(k, phi, digits=digits), variables["k"][:, None], phi)


@program(static=1)
def _many_optimal_exponents(digits: int | None, phi: Array, *bounds_and_life: Array) -> OptimalExponent:
    shape = jnp.broadcast_shapes(phi.shape, *(one.shape for one in bounds_and_life))
    (lower, upper, *of_life), valid = bounds_and_life, AMPLITUDE.contains(phi)
    given: tuple[Array, ...] = (jnp.broadcast_to(phi, shape),)
    wear: Callable[..., Array] = functools.partial(fretting.wear_volume, digits=digits)
    if of_life:
        from plgwear_jax.wear.closed_ring import curves_of
        from plgwear_jax.wear.ring_cells import march_resolution_of
        from plgwear_jax.wear.ring_curves import share_at

        from .along_exponent import NODES, with_room  # seldom needed, and take time

        life, nu = of_life
        valid = valid & POSITIVE.contains(life) & POISSON_RATIO.contains(nu)
        worn = jnp.broadcast_to(jnp.where(phi > 0.0, 1.0, 0.0), shape)
        # Runs are along a last axis, and only as many as there are pairs of bounds and amplitudes.
        k = nodes_between(*with_room(upper, lower), NODES)
        phi, life, nu = (x[..., None] for x in (jnp.where(phi > 0.0, phi, 0.005), life, nu))
        runs = curves_of(march_resolution_of(digits), k, phi)
        volume = runs.final * share_at(runs, life * tangential_ratio(k, nu) / runs.unit)
        given = *(jnp.broadcast_to(x, (*shape, NODES)) for x in (k, jnp.log(volume))), worn
        digits = digits or 4

        def between_nodes(k: Array, nodes: Array, heights: Array, worn: Array) -> Array:
            return worn * jnp.exp(shares_of_nodes(nodes, k) @ heights)

        wear = between_nodes

    def best(lower: Array, upper: Array, *given: Array) -> Minimum:
        space = {"k": Interval(lower, upper)}
        return minimise(
            lambda variables: wear(variables["k"], *given), space, noise=digits and 10.0**-digits, axis_name=BATCH
        )

    lower, upper = (jnp.broadcast_to(x, shape) for x in (lower, upper))
    valid = valid & EXPONENT.contains(lower) & EXPONENT.contains(upper) & (lower < upper)
    found = _exponent_of(in_chunks(best, shape, lower, upper, *given))
    return jax.tree.map(lambda x: x & valid if x.dtype == bool else nan_unless(valid, x), found)


def _exponent_of(found: Minimum) -> OptimalExponent:
    return OptimalExponent(
        k=found.variables["k"],
        wear_volume=found.value,
        at_bound=found.side["k"] != 0,
        converged=found.converged,
        certified=found.certified,
        scan_found_nothing_better=found.scan_found_nothing_better,
        rival=found.rival["k"],
        rival_wear_volume=found.rival_value,
    )


BATCH = "problems"  # the axis of a batch, whose searches run in step
CHUNK = 16384


def in_chunks(function: Callable[..., Any], shape: tuple[int, ...], *values: Array, most: int = CHUNK) -> Any:
    """The function at each element of a batch, in chunks of so many at most, that fit into memory.

    The leading axes of the values have the shape of the batch.
    """
    size = math.prod(shape)
    most = min(size, most) or 1
    # One chunk is no loop: in loops JAX loses the rules of closed forms in second derivatives that begin in reverse.
    chunks = (-(-size // most), most)[size <= most :]
    # The last chunk is filled up with the first elements.
    filled = [jnp.resize(value, chunks + value.shape[len(shape) :]) for value in values]
    together = jax.vmap(lambda chunk: function(*chunk), axis_name=BATCH)
    found = lax.map(together, filled) if size > most else together(filled)
    return jax.tree.map(lambda leaf: jnp.resize(leaf, shape + leaf.shape[len(chunks) :]), found)


# --- critical amplitudes ----------------------------------------------------------------------------------------------

# Three numbers are enough. For every exponent k the slope dV/dk changes its sign twice between phi = 0 and phi = 1, at
# phi_1(k) from + to - and at phi_2(k) from - to +, and both rise with k:
#
#     phi_1 from 0.0591 at k -> -1 to 0.3855 at k -> 1,      phi_2 from 0.9796 to 0.9972
#
# So the best exponent is the lower bound up to phi_1(lower), then rises continuously, and is the upper bound from
# phi_1(upper) on. From phi_2(lower) to phi_2(upper) the wear has a maximum between the two bounds. At one amplitude
# there both bounds wear the same, and the best exponent jumps back to the lower one. There are never more than two
# minima, and where there are two, they are the bounds. (Found by scanning and tested, not proved.)

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

    Examples:
        >>> from plgwear_jax import optimise
        >>> at = optimise.critical_amplitudes()
        >>> print(f"{at.leaves_lower:.6f} {at.reaches_upper:.6f} {at.ends_equal:.6f}")
        0.059075 0.385545 0.992521

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eq. (28).
    """
    dtype = check_bounds(bounds, _CLOSED)
    working = jnp.promote_types(dtype, jnp.float32)
    lower, upper = (jnp.asarray(bound, working) for bound in bounds)
    return CriticalAmplitudes(*(root.astype(dtype) for root in _critical(lower, upper)))


# For any k, phi_1, phi_1 and phi_2 lie between these amplitudes and those so much larger; dV/dk has these signs there.
_BRACKETS = (0.05, 0.05, 0.97), (0.35, 0.35, 0.028), (-1.0, -1.0, 1.0)
# Nodes on [-1, 1] and weights; a mean of dV/dk is right to 1e-15, even over all exponents.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


@jax.jit
def _critical(lower: Array, upper: Array) -> Array:
    """The three amplitudes for each pair of bounds, shape (3, ...)."""
    lower, upper = jnp.broadcast_arrays(lower, upper)
    allowed = _CLOSED.contains(lower) & _CLOSED.contains(upper) & (lower < upper)
    # At -1 and 1 the formulas cannot be evaluated, but at the numbers next to them.
    least = float(jnp.finfo(lower.dtype).epsneg) - 1.0
    lower, upper = clamp_keep_slope(least, lower), -clamp_keep_slope(least, -upper)
    # V(upper) - V(lower) is the mean of dV/dk times the width. So all three are roots of such means, and the
    # difference of the two volumes loses no digits between near bounds.
    first, last = jnp.stack([lower, upper, lower]), jnp.stack([lower, upper, upper])
    nodes, weights = in_dtype(lower.dtype, _NODES, _WEIGHTS)
    k = first[..., None] + (last - first)[..., None] * (0.5 + 0.5 * nodes)
    begins, widths, signs = jnp.asarray(_BRACKETS, k.dtype).reshape(3, 3, *lower.ndim * (1,))

    def rising(k: Array, beyond: Array) -> Array:
        phi = begins + beyond
        at = jnp.broadcast_to(phi[..., None], k.shape)
        _, by_k = value_with_slope(lambda k: fretting.wear_volume(k, at), k)
        # Divided by the volume at k = 1, which is phi^2/(1 - phi) up to a factor: then it is nearly linear in phi.
        return signs * (by_k @ weights) * (1.0 - phi) / (phi * phi)

    return nan_unless(allowed, begins + first_at(rising, k, jnp.zeros_like(first), widths))
