"""Gradients that wear least: bounded, batched descent on optax, seeded and checked by a coarse scan.

The descent is local; a scan of the whole box, batched with everything else, finds the valleys to start from, and the
best of them must not be beaten by any scanned point. Both matter: near phi = 1 the two ends of k compete.
"""

import dataclasses
import functools
from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax import fretting
from plgwear_jax._formula import AMPLITUDE, EXPONENT, POSITIVE, check, check_digits, real_dtype
from plgwear_jax._record import record
from plgwear_jax.contact import FrettingContact
from plgwear_jax.material import PowerLawGraded

__all__ = ["Design", "Minimum", "OptimalExponent", "design", "minimise", "optimal_exponent"]

Bound = Literal["lower", "upper"]


@record
class Minimum:
    """The minimum of a function over a box.

    Attributes:
        variables: Where it lies, shape (n,).
        value: The function there.
        side: -1, 0 or +1 for each variable: on its lower bound, between, on its upper bound; shape (n,).
        projected_gradient: Largest slope that still leads downhill inside the box, relative to the value and to half
            the width of the box.
        converged: The projected gradient is below the tolerance.
        certified: Converged, and no scanned point of the whole box lies lower.
        steps: Evaluations of the objective and its gradient on the way from the start that led here.
    """

    variables: Array
    value: Array
    side: Array
    projected_gradient: Array
    converged: Array
    certified: Array
    steps: Array


def minimise(
    objective: Callable[[Array], Array],
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    samples: int = 65,
    starts: int = 3,
    max_steps: int = 100,
) -> Minimum:
    """Minimise a smooth function of a few variables over a box, from the deepest valleys of a scan.

    Runs under `jit` and `vmap`: bounds and what the objective closes over may be traced and batched.

    Args:
        objective: A differentiable function of an array of shape (n,), scalar, of one sign and finite in the box.
        lower: Lower bounds, shape (n,).
        upper: Upper bounds, shape (n,), above the lower ones.
        samples: Points of the scan along each variable, ends included, at least 3.
        starts: Valleys of the scan to descend from.
        max_steps: Evaluations of the objective and its gradient allowed from each start.

    Returns:
        The best minimum found, and what is known about it.
    """
    lower, upper = jnp.asarray(lower), jnp.asarray(upper)
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    axis = jnp.linspace(-1.0, 1.0, samples, dtype=lower.dtype)
    mesh = jnp.meshgrid(*(axis for _ in range(lower.size)), indexing="ij")
    scanned = jax.vmap(lambda u: objective(middle + half * u))(jnp.stack([m.ravel() for m in mesh], axis=-1))
    scale = jnp.max(jnp.abs(scanned[jnp.argmin(scanned)]))
    scale = jnp.where(scale > 0.0, scale, 1.0)

    valleys = _deepest_valleys(scanned.reshape((samples,) * lower.size), starts)
    begin = jnp.stack([axis[index] for index in jnp.unravel_index(valleys, (samples,) * lower.size)], axis=-1)

    def relative(u: Array) -> Array:
        return objective(middle + half * u) / scale

    ends, steps = jax.vmap(lambda u: _descend(relative, u, 1.0 / samples, max_steps))(begin)
    values, gradients = jax.vmap(jax.value_and_grad(relative))(ends)
    best = jnp.argmin(values)
    u, gradient = ends[best], gradients[best]
    # On a bound the variable takes the bound's own value, where the slope leads out of the box.
    tolerance = _tolerance(u.dtype)
    side = jnp.where((jnp.abs(u) > 1.0 - tolerance) & (gradient * u < 0.0), jnp.sign(u), 0.0)
    variables = jnp.where(side < 0.0, lower, jnp.where(side > 0.0, upper, middle + half * u))
    value = objective(variables)
    remaining = jnp.max(jnp.where(side == 0.0, jnp.abs(gradient), 0.0))
    converged = remaining < tolerance
    lowest = jnp.min(scanned)
    # Lower by more than the rounding of the objective, that is.
    certified = converged & (value <= lowest + 256.0 * jnp.finfo(u.dtype).eps * jnp.abs(lowest))
    return Minimum(variables, value, side.astype(int), remaining, converged, certified, steps[best])


def _tolerance(dtype: np.dtype) -> float:
    """What a relative slope can be brought to: well above its rounding error, well below what anyone needs."""
    return float(jnp.finfo(dtype).eps) ** 0.625


def _deepest_valleys(scanned: Array, count: int) -> Array:
    """Flat indices of the lowest scan points that no neighbour along an axis undercuts."""
    valley = jnp.isfinite(scanned)
    for axis in range(scanned.ndim):
        padded = jnp.pad(
            scanned, [(1, 1) if a == axis else (0, 0) for a in range(scanned.ndim)], constant_values=jnp.inf
        )
        before = jax.lax.slice_in_dim(padded, 0, scanned.shape[axis], axis=axis)
        after = jax.lax.slice_in_dim(padded, 2, scanned.shape[axis] + 2, axis=axis)
        valley &= (scanned <= before) & (scanned <= after)
    return jax.lax.top_k(jnp.where(valley, -scanned, -jnp.inf).ravel(), count)[1]


def _projected(u: Array, gradient: Array) -> Array:
    """Largest step that steepest descent by the gradient could still take inside [-1, 1]."""
    return jnp.max(jnp.abs(u - jnp.clip(u - gradient, -1.0, 1.0)))


class _Descent(NamedTuple):
    """Where a descent stands: the point, what lies there, and the next trial step."""

    theta: Array
    value: Array
    gradient: Array
    direction: Array
    length: Array
    memory: optax.OptState
    steps: Array


def _descend(objective: Callable[[Array], Array], start: Array, margin: float, max_steps: int) -> tuple[Array, Array]:
    """L-BFGS with backtracking in theta, u = sin(theta), where a minimum on a bound is an ordinary one; (u, steps).

    Each pass evaluates one trial step, which is taken if the objective falls and shortened if not. So the loop holds a
    single copy of the objective and its gradient, where a line search within it would make XLA compile many.
    """
    solver = optax.scale_by_lbfgs()
    value_and_gradient = jax.value_and_grad(lambda theta: objective(jnp.sin(theta)))
    eps, tolerance = jnp.finfo(start.dtype).eps, _tolerance(start.dtype)

    def turn(theta: Array, gradient: Array, memory: optax.OptState) -> tuple[Array, optax.OptState]:
        updates, memory = solver.update(gradient, memory, theta)
        downhill = jnp.vdot(updates, gradient) > 0.0
        direction = -jnp.where(downhill, updates, gradient)
        # Not further than from the middle of the box to a bound in three steps.
        return direction * jnp.minimum(1.0, 0.5 / jnp.maximum(jnp.max(jnp.abs(direction)), eps)), memory

    def going_on(at: _Descent) -> Array:
        remaining = _projected(jnp.sin(at.theta), at.gradient / jnp.cos(at.theta))
        return (at.steps < max_steps) & (remaining > 0.25 * tolerance)

    def advance(at: _Descent) -> _Descent:
        theta = at.theta + at.length * at.direction
        value, gradient = value_and_gradient(theta)
        wanted = 1e-4 * at.length * jnp.vdot(at.gradient, at.direction)
        falls = value <= at.value + wanted + 16.0 * eps * jnp.abs(value)
        direction, memory = turn(theta, gradient, at.memory)
        taken = _Descent(theta, value, gradient, direction, jnp.ones_like(value), memory, at.steps + 1)
        shortened = at._replace(length=0.25 * at.length, steps=at.steps + 1)
        return jax.tree.map(functools.partial(jnp.where, falls), taken, shortened)

    # At u = +-1 itself the slope in theta vanishes whatever the objective does.
    theta = jnp.arcsin(jnp.clip(start, -1.0 + margin, 1.0 - margin))
    # The first pass stays where it is and accepts whatever it finds.
    still, unknown = jnp.zeros_like(theta), jnp.ones_like(theta)
    one = jnp.ones((), start.dtype)
    first = _Descent(theta, one * jnp.inf, unknown, still, one, solver.init(theta), jnp.asarray(0))
    last = jax.lax.while_loop(going_on, advance, first)
    return jnp.sin(last.theta), last.steps


# --- the exponent for an amplitude ----------------------------------------------------------------------------------


@record
class OptimalExponent:
    """The exponent that wears least at an amplitude, in the shape of the amplitude.

    Attributes:
        k: The exponent.
        wear_volume: Its wear volume in units of a_0^4/R.
        at_bound: It lies on one of the bounds.
        converged: The descent came to rest.
        certified: Converged, and no scanned exponent between the bounds wears less.
    """

    k: Array
    wear_volume: Array
    at_bound: Array
    converged: Array
    certified: Array


def optimal_exponent(
    phi: ArrayLike,
    bounds: tuple[ArrayLike, ArrayLike] = (-0.95, 0.95),
    *,
    digits: int | None = None,
) -> OptimalExponent:
    """The exponent k that wears least at the amplitude phi when the contact radius is held, Eq. (28).

    Differentiable in phi and the bounds: k by the implicit function theorem, the volume by the envelope theorem.

    Args:
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1, of any shape; all of them are designed in one call.
        bounds: Lowest and highest exponent allowed, -1 < lowest < highest < 1.
        digits: Correct digits wanted of the wear volume; by default all that the dtype holds.

    Returns:
        The optimum for each amplitude. At phi = 0 nothing wears, and k is the lower bound, the limit for phi -> 0.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Example:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import optimise
        >>> best = optimise.optimal_exponent(jnp.array([0.1, 0.9]), bounds=(-0.5, 0.5))
        >>> print(best.k)  # hard surface for small amplitudes, soft for large ones
        [-0.5  0.5]
    """
    lower, upper = bounds
    check("phi", phi, AMPLITUDE)
    for name, bound in (("bounds[0]", lower), ("bounds[1]", upper)):
        check(name, bound, EXPONENT)
    if not any(isinstance(bound, Tracer) for bound in bounds) and not np.all(np.less(lower, upper)):
        raise ValueError(f"bounds = {bounds}: the lowest exponent must be below the highest")
    dtype = real_dtype("optimal_exponent", (phi, lower, upper))
    check_digits(digits, dtype)
    return _optimal_exponents(*(jnp.asarray(value, dtype) for value in (phi, lower, upper)), digits)


@functools.partial(jax.jit, static_argnums=3)
def _optimal_exponents(phi: Array, lower: Array, upper: Array, digits: int | None) -> OptimalExponent:
    phi, lower, upper = jnp.broadcast_arrays(phi, lower, upper)
    shape = phi.shape
    # An empty batch has nothing to descend from.
    found = jax.vmap(lambda *point: _best_exponent(*point, digits))(phi.ravel(), lower.ravel(), upper.ravel())
    k, at_bound, converged, certified = (leaf.reshape(shape) for leaf in found)
    valid = AMPLITUDE.contains(phi) & EXPONENT.contains(lower) & EXPONENT.contains(upper) & (lower < upper)
    k = jnp.where(valid, k, jnp.nan)
    volume = fretting.wear_volume(k, phi, digits=digits)
    return OptimalExponent(k, volume, at_bound & valid, converged & valid, certified & valid)


@functools.partial(jax.custom_jvp, nondiff_argnums=(3,))
def _best_exponent(phi: Array, lower: Array, upper: Array, digits: int | None) -> tuple[Array, Array, Array, Array]:
    found = minimise(lambda k: fretting.wear_volume(k[0], phi, digits=digits), lower[None], upper[None])
    return found.variables[0], found.side[0] != 0, found.converged, found.certified


@_best_exponent.defjvp
def _best_exponent_jvp(digits: int | None, primals, tangents):
    phi, lower, upper = primals
    dphi, dlower, dupper = tangents
    found = _best_exponent(phi, lower, upper, digits)
    k, at_bound = found[0], found[1]
    slope = jax.grad(functools.partial(fretting.wear_volume, digits=digits))
    curvature, mixed = jax.grad(slope, (0, 1))(k, phi)
    on_bound = jnp.where(k <= lower, dlower, dupper)
    dk = jnp.where(at_bound, on_bound, -mixed / jnp.where(at_bound, 1.0, curvature) * dphi)
    flags = tuple(np.zeros(np.shape(flag), jax.dtypes.float0) for flag in found[1:])
    return found, (dk, *flags)


# --- the best material for a contact --------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Design:
    """The best gradient for a contact and its load.

    Attributes:
        contact: The contact with the best material.
        reference: The contact as it was given.
        variables: The values of what was varied, by name.
        wear_volume: Wear volume of the best contact in m^3.
        reference_wear_volume: Wear volume of the reference in m^3.
        at_bound: For each variable the bound it lies on, or None.
        converged: The descent came to rest.
        certified: Converged, and no scanned point between the bounds wears less.
    """

    contact: FrettingContact
    reference: FrettingContact
    variables: dict[str, float]
    wear_volume: Array
    reference_wear_volume: Array
    at_bound: dict[str, Bound | None]
    converged: bool
    certified: bool


def _check_variables(vary: Mapping[str, tuple[float, float]], hold: str | None) -> None:
    if hold not in (None, "contact_radius"):
        raise ValueError(f'hold = {hold!r} is neither "contact_radius" nor None')
    allowed = {"k": EXPONENT, "z0": POSITIVE}
    if not vary:
        raise ValueError(f"vary is empty: name at least one of {', '.join(allowed)}")
    for name, bounds in vary.items():
        if name not in allowed:
            raise ValueError(f"vary: {name!r} is not one of {', '.join(allowed)}")
        lowest, highest = bounds
        check(f"vary: lowest {name}", lowest, allowed[name])
        check(f"vary: highest {name}", highest, allowed[name])
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
    if hold and set(vary) != {"k"}:
        raise ValueError("vary: with the contact radius held by E0 only k is left to vary: z0 counts only in E0/z0^k")


def _holding_radius(contact: FrettingContact, material: PowerLawGraded) -> PowerLawGraded:
    """The material with its E0 changed such that the contact radius stays that of the contact, Eq. (12)."""
    radius = dataclasses.replace(contact, material=material).contact_radius()
    E0 = material.E0 * (radius / contact.contact_radius()) ** (3.0 + jnp.asarray(material.k))
    return dataclasses.replace(material, E0=float(E0))


@functools.partial(jax.jit, static_argnums=(4, 5))
def _best_variables(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    lower: Array,
    upper: Array,
    names: tuple[str, ...],
    hold: str | None,
) -> Minimum:
    """The minimum over the variables `names`, z0 by its logarithm."""
    phi = contact.amplitude(tangential_force)

    def wear(variables: Array) -> Array:
        if hold is not None:
            # At a held a_0 the volume is a constant times its dimensionless value.
            return fretting.wear_volume(variables[names.index("k")], phi)
        values = {name: jnp.exp(x) if name == "z0" else x for name, x in zip(names, variables, strict=True)}
        material = dataclasses.replace(contact.material, **values)
        return dataclasses.replace(contact, material=material).wear_volume(tangential_force)

    return minimise(wear, lower, upper)


def design(
    contact: FrettingContact,
    tangential_force: float,
    vary: Mapping[str, tuple[float, float]],
    *,
    hold: Literal["contact_radius"] | None = None,
) -> Design:
    """Find the material that wears least in a contact under a tangential amplitude.

    Args:
        contact: The contact with its reference material; its fields are numbers.
        tangential_force: Amplitude F_x in N, 0 <= F_x < mu F_N.
        vary: Bounds of the variables: "k", and where nothing is held also "z0" in m, searched on a logarithmic scale.
        hold: "contact_radius" keeps the initial contact radius at the reference's by adjusting E0. Then only k is left
            to vary, since E0 and z0 count only as E0/z0^k.

    Returns:
        The best contact beside the reference.

    Raises:
        ValueError: An argument is outside its range, or the variables are none, unknown or redundant.

    Example:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.design(contact, 3.2, {"k": (-0.5, 0.5)}, hold="contact_radius")
        >>> print(best.variables["k"], best.at_bound["k"])
        0.5 upper
    """
    _check_variables(vary, hold)
    phi = contact.amplitude(tangential_force)
    names = tuple(vary)
    logarithmic = np.array([name == "z0" for name in names])
    bounds = np.array([vary[name] for name in names], float).T
    lower, upper = jnp.asarray(np.where(logarithmic, np.log(np.where(logarithmic, bounds, 1.0)), bounds), phi.dtype)

    found = _best_variables(contact, tangential_force, lower, upper, names, hold)
    inside = np.where(logarithmic, np.exp(found.variables), found.variables)
    side = np.asarray(found.side)
    # On a bound the number as it was given, not the exponential of its logarithm.
    values = np.where(side < 0, bounds[0], np.where(side > 0, bounds[1], inside))
    variables = dict(zip(names, values.tolist(), strict=True))
    material = dataclasses.replace(contact.material, **variables)
    if hold is not None:
        material = _holding_radius(contact, material)
    best = dataclasses.replace(contact, material=material)
    named: dict[int, Bound | None] = {-1: "lower", 0: None, 1: "upper"}
    return Design(
        contact=best,
        reference=contact,
        variables=variables,
        wear_volume=best.wear_volume(tangential_force),
        reference_wear_volume=contact.wear_volume(tangential_force),
        at_bound={name: named[where] for name, where in zip(names, side.tolist(), strict=True)},
        converged=bool(found.converged),
        certified=bool(found.certified),
    )
