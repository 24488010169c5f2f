"""Gradients that wear least: what may be changed, what must be held, what is feared, and under which load.

A contact's wear depends on its material only through k and the contact radius a_0, in powers of which everything
scales; and all that wears grows with the amplitude, whatever the material. So over a table of amplitudes the mean, the
worst case and the mean of the worst cases are means with weights that do not depend on the design: smooth, and cheap.
"""

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax import fretting, gross_slip
from plgwear_jax._amplitudes import CriticalAmplitudes, critical_amplitudes
from plgwear_jax._formula import AMPLITUDE, EXPONENT, POSITIVE, Domain, check, check_bounds, check_digits, real_dtype
from plgwear_jax._minimise import Interval, Minimum, minimise
from plgwear_jax._record import record
from plgwear_jax.contact import PARTIAL_SLIP, FrettingContact, GrossSlipContact

__all__ = [
    "Course",
    "CriticalAmplitudes",
    "Design",
    "Designs",
    "Front",
    "Interval",
    "LimitState",
    "Limits",
    "Minimum",
    "Misjudged",
    "ModulusWindow",
    "OptimalExponent",
    "Sensitivities",
    "along",
    "critical_amplitudes",
    "design",
    "designs",
    "front",
    "minimise",
    "misjudged",
    "optimal_exponent",
    "sensitivities",
    "tail_weights",
]

Hold = Literal["contact_radius_by_E0", "contact_radius_by_z0"]
Objective = Literal["wear_volume", "worn_radius", "deepest_wear", "volume_change", "force_drop"]
Bounds = tuple[float, float]

LEVEL = Domain("0 <= level <= 1", lambda level: (level >= 0.0) & (level <= 1.0))
WEIGHT = Domain(">= 0 and finite", lambda weight: (weight >= 0.0) & (weight < float("inf")))
DISTANCE = POSITIVE


# --- the exponent for an amplitude ----------------------------------------------------------------------------------


@record
class OptimalExponent:
    """The exponent that wears least at an amplitude, in the shape of the amplitude.

    Attributes:
        k: The exponent.
        wear_volume: Its wear volume in units of a_0^4/R.
        at_bound: It lies on one of the bounds.
        converged: The descent came to rest.
        certified: Converged, and neither a scanned nor any other minimum between the bounds wears less.
        proven: Between no two scanned exponents can anything wear less; see `Minimum`.
        rival: The next best minimum, such as the other end near gross slip; NaN if there is none.
        rival_wear_volume: The wear volume there; infinite if there is none.
    """

    k: Array
    wear_volume: Array
    at_bound: Array
    converged: Array
    certified: Array
    proven: Array
    rival: Array
    rival_wear_volume: Array


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
    dtype = real_dtype("optimal_exponent", (phi, lower, upper))
    check_bounds(bounds, EXPONENT, dtype)
    check_digits(digits, dtype)
    return _optimal_exponents(*(jnp.asarray(value, dtype) for value in (phi, lower, upper)), digits)


@functools.partial(jax.jit, static_argnums=3)
def _optimal_exponents(phi: Array, lower: Array, upper: Array, digits: int | None) -> OptimalExponent:
    phi, lower, upper = jnp.broadcast_arrays(phi, lower, upper)
    valid = AMPLITUDE.contains(phi) & EXPONENT.contains(lower) & EXPONENT.contains(upper) & (lower < upper)
    noise = None if digits is None else 10.0**-digits

    def best(phi: Array, lower: Array, upper: Array) -> Minimum:
        def wear(variables: dict[str, Array]) -> Array:
            return fretting.wear_volume(variables["k"], phi, digits=digits)

        return minimise(wear, {"k": Interval(lower, upper)}, noise=noise)

    found = _in_chunks(best, phi.shape, phi, lower, upper)
    defined = jnp.where(valid, 1.0, jnp.nan).astype(phi.dtype)  # as a factor it makes derivatives NaN too
    return OptimalExponent(
        k=defined * found.variables["k"],
        wear_volume=defined * found.value,
        at_bound=(found.side["k"] != 0) & valid,
        converged=found.converged & valid,
        certified=found.certified & valid,
        proven=found.proven & valid,
        rival=jnp.where(valid, found.rival["k"], jnp.nan),
        rival_wear_volume=jnp.where(valid, found.rival_value, jnp.nan),
    )


_CHUNK = 16384


def _in_chunks(function: Callable[..., Any], shape: tuple[int, ...], *values: Array) -> Any:
    """The function at each element of a batch, so many at a time as memory certainly has room for.

    The leading axes of the values have the shape of the batch.
    """
    size = math.prod(shape)
    flat = [value.reshape(size, *value.shape[len(shape) :]) for value in values]
    if size <= _CHUNK:
        found = jax.vmap(function)(*flat)
    else:
        padding = -size % _CHUNK
        chunks = [
            jnp.pad(value, ((0, padding), *((0, 0) for _ in value.shape[1:])), mode="edge").reshape(
                -1, _CHUNK, *value.shape[1:]
            )
            for value in flat
        ]
        found = jax.lax.map(lambda chunk: jax.vmap(function)(*chunk), chunks)
        found = jax.tree.map(lambda leaf: leaf.reshape(-1, *leaf.shape[2:])[:size], found)
    return jax.tree.map(lambda leaf: leaf.reshape(*shape, *leaf.shape[1:]), found)


# --- loads ----------------------------------------------------------------------------------------------------------


def tail_weights(tangential_force: ArrayLike, weight: ArrayLike, level: ArrayLike = 0.0) -> Array:
    """Weights with which the wear under each amplitude enters the mean over the worst 1 - level of all contacts.

    What wears grows with the amplitude, whatever the material: the worst cases are the largest amplitudes.

    Args:
        tangential_force: Amplitudes, shape (n,), in any unit.
        weight: Their probabilities, shape (n,), >= 0 and not all zero; they need not sum to one.
        level: 0 for the mean, 1 for the worst case, between them the level of the CVaR (expected shortfall).

    Returns:
        Weights that sum to one, shape (n,).

    Raises:
        ValueError: A concrete argument is outside its range.
    """
    check("weight", weight, WEIGHT)
    check("level", level, LEVEL)
    dtype = jnp.result_type(tangential_force, weight, level, 0.0)
    force, weight = jnp.asarray(tangential_force, dtype), jnp.asarray(weight, dtype)
    if force.ndim != 1 or force.shape != weight.shape or force.size == 0:
        raise ValueError(f"amplitudes of shape {force.shape} and weights of shape {weight.shape}: both must be (n,)")
    if not isinstance(weight, Tracer) and not np.any(np.asarray(weight) > 0.0):
        raise ValueError("weight: all weights are zero")
    order = jnp.argsort(-force)
    share = weight[order] / jnp.sum(weight)
    above = jnp.cumsum(share) - share
    tail = 1.0 - jnp.asarray(level, dtype)
    in_tail = jnp.clip(tail - above, 0.0, share)
    # The worst case is the largest amplitude that has any weight.
    worst = (share > 0.0) & (above == 0.0)
    in_tail = jnp.where(jnp.sum(in_tail) > 0.0, in_tail, worst.astype(dtype))
    return jnp.zeros_like(share).at[order].set(in_tail / jnp.sum(in_tail))


# --- what is asked --------------------------------------------------------------------------------------------------


@record
class ModulusWindow:
    """Between which moduli a coating can be made, at two depths.

    Attributes:
        at: The two depths in m, positive, the smaller one first.
        lower: The lowest modulus in Pa at each of them.
        upper: The highest modulus in Pa at each of them.
    """

    at: tuple[float, float]
    lower: tuple[float, float]
    upper: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("at", "lower", "upper"):
            pair = getattr(self, name)
            if len(pair) != 2:
                raise ValueError(f"modulus: {name} = {pair}: must be a pair")
            for value in pair:
                check(f"modulus: {name}", value, POSITIVE)
        if not self.at[0] < self.at[1]:
            raise ValueError(f"modulus: at = {self.at}: the smaller depth must come first")
        for depth, lowest, highest in zip(self.at, self.lower, self.upper, strict=True):
            if not lowest < highest:
                raise ValueError(f"modulus at {depth} m: [{lowest}, {highest}]: the lowest must be below the highest")

    def exponents(self) -> Bounds:
        """The lowest and the highest exponent k that the window allows."""
        decades = math.log(self.at[1] / self.at[0])
        return math.log(self.lower[1] / self.upper[0]) / decades, math.log(self.upper[1] / self.lower[0]) / decades


@record
class Limits:
    """What a design has to keep to; what is None is not limited.

    Attributes:
        edge_pressure: Highest pressure p_inf in Pa at the distance `distance` inside the stick edge, the usual way to
            compare singularities of different order.
        distance: That critical distance in m.
        contact_radius: Lowest and highest initial contact radius a_0 in m; either may be None.
        penetration: Largest penetration d_inf in m.
        modulus: Where E(z) has to lie at two depths.
    """

    edge_pressure: ArrayLike | None = None
    distance: ArrayLike | None = None
    contact_radius: tuple[ArrayLike | None, ArrayLike | None] | None = None
    penetration: ArrayLike | None = None
    modulus: ModulusWindow | None = None

    def __post_init__(self) -> None:
        if self.edge_pressure is not None and self.distance is None:
            raise ValueError("limits: edge_pressure needs the distance from the stick edge at which it is taken")
        lowest, highest = self.contact_radius or (None, None)
        named = {
            "edge_pressure": self.edge_pressure,
            "distance": self.distance,
            "penetration": self.penetration,
            "contact_radius, lowest": lowest,
            "contact_radius, highest": highest,
        }
        for name, value in named.items():
            if value is not None:
                check(f"limits: {name}", value, POSITIVE)
        known = not isinstance(lowest, Tracer) and not isinstance(highest, Tracer)
        if known and lowest is not None and highest is not None and not np.all(np.less(lowest, highest)):
            raise ValueError(f"limits: contact_radius = {self.contact_radius}: the lowest must be below the highest")


class _Question(NamedTuple):
    """What is asked, apart from numbers."""

    objective: str
    hold: Hold | None


@record
class _Task:
    """The numbers of a design: everything that the outcome can be differentiated by."""

    contact: Any  # of either kind
    phi: Any  # amplitudes F_x/(mu F_N) that count, the largest one first
    weight: Any
    bounds: dict[str, tuple[ArrayLike, ArrayLike]]
    depths: tuple[ArrayLike, ArrayLike] | None  # of the two moduli, where these are varied
    limits: Limits


_SHALLOW, _DEEP = "shallow_modulus", "deep_modulus"
_POWERS = {"wear_volume": 4, "deepest_wear": 2, "worn_radius": 1}  # of a_0


class _Candidate:
    """A choice of the variables: its contact, and what a search asks about it. What is not asked is not computed."""

    def __init__(self, question: _Question, task: _Task, variables: Mapping[str, Array]) -> None:
        self.question, self.task, self.variables = question, task, variables
        if _SHALLOW in variables:
            assert task.depths is not None
            z1, z2 = task.depths
            E1, E2 = variables[_SHALLOW], variables[_DEEP]
            self.changes = {"E0": E1, "z0": z1, "k": jnp.log(E2 / E1) / jnp.log(jnp.asarray(z2) / z1)}
        else:
            self.changes = dict(variables)

    @property
    def k(self) -> Any:
        return self.changes.get("k", self.task.contact.material.k)

    @functools.cached_property
    def contact(self) -> Any:
        reference, hold = self.task.contact, self.question.hold
        material = dataclasses.replace(reference.material, **self.changes)
        if hold is not None:
            # a_0 hangs on E0/z0^k, Eq. (12).
            wider = dataclasses.replace(reference, material=material).contact_radius() / reference.contact_radius()
            log_lack = (3.0 + jnp.asarray(material.k)) * jnp.log(wider)
            if hold == "contact_radius_by_E0":
                material = dataclasses.replace(material, E0=material.E0 * jnp.exp(log_lack))
            else:
                material = dataclasses.replace(material, z0=material.z0 * jnp.exp(-log_lack / material.k))
        return dataclasses.replace(reference, material=material)

    @functools.cached_property
    def contact_radius(self) -> Array:
        held = self.question.hold is not None
        return self.task.contact.contact_radius() if held else self.contact.contact_radius()

    def objective(self) -> Array:
        """The logarithm of what is minimised, over a constant."""
        name, k = self.question.objective, self.k
        if name in ("volume_change", "force_drop"):
            return jnp.log(getattr(gross_slip, name)(k))
        if name == "edge_pressure":
            return jnp.log(self.edge_pressure())
        wear = jnp.log(jnp.vdot(self.task.weight, getattr(fretting, name)(k, self.task.phi)))
        return wear if self.question.hold is not None else wear + _POWERS[name] * jnp.log(self.contact_radius)

    def states(self) -> dict[str, tuple[Array, ArrayLike, int]]:
        """Of each limit what it limits, the limit, and which side is allowed: -1 below, +1 above.

        All that depends on the amplitude rises with it, so the largest one decides.
        """
        limits, found = self.task.limits, {}
        if limits.edge_pressure is not None:
            found["edge_pressure"] = (self.edge_pressure(), limits.edge_pressure, -1)
        lowest, highest = limits.contact_radius or (None, None)
        if lowest is not None:
            found["contact_radius_lowest"] = (self.contact_radius, lowest, 1)
        if highest is not None:
            found["contact_radius_highest"] = (self.contact_radius, highest, -1)
        if limits.penetration is not None:
            height = self.contact_radius**2 / jnp.asarray(self.task.contact.radius)
            depth = fretting.penetration(self.k, self.task.phi[0])
            found["penetration"] = (height * depth, limits.penetration, -1)
        if limits.modulus is not None:
            ends = zip(("shallow", "deep"), limits.modulus.at, limits.modulus.lower, limits.modulus.upper, strict=True)
            for name, depth, lowest, highest in ends:
                modulus = self.contact.material.modulus(depth)
                found[f"{name}_modulus_lowest"] = (modulus, lowest, 1)
                found[f"{name}_modulus_highest"] = (modulus, highest, -1)
        return dict(sorted(found.items()))  # the order that JAX gives a dict as well

    def edge_pressure(self) -> Array:
        """p_inf in Pa at the critical distance, at the largest amplitude."""
        a_0, contact = self.contact_radius, self.task.contact
        relative = jnp.asarray(self.task.limits.distance) / a_0
        return (
            jnp.asarray(contact.normal_force)
            / (jnp.pi * a_0 * a_0)
            * fretting.edge_pressure(relative, self.k, self.task.phi[0])
        )

    def excess(self) -> Array:
        """By how much each limit is broken, as a logarithm."""
        return jnp.stack([-side * jnp.log(value / bound) for value, bound, side in self.states().values()])


@functools.partial(jax.jit, static_argnums=0)
def _search(question: _Question, task: _Task, at: Minimum | None = None) -> Minimum:
    """The minimum of the logarithm of the objective; with one at hand only its derivatives."""
    space = {
        name: Interval(*bounds, "linear" if name == "k" else "logarithmic") for name, bounds in task.bounds.items()
    }
    given = task.limits
    named = (given.edge_pressure, given.penetration, given.modulus, *(given.contact_radius or ()))
    limited = any(limit is not None for limit in named)

    def candidate(variables: dict[str, Array]) -> _Candidate:
        return _Candidate(question, task, variables)

    return minimise(
        lambda variables: candidate(variables).objective(),
        space,
        limits=(lambda variables: candidate(variables).excess()) if limited else None,
        at=at,
    )


@record
class LimitState:
    """How a design stands to one of its limits.

    Attributes:
        value: What is limited, in SI units.
        allowed: The limit.
        multiplier: By how many percent the objective falls if the limit is loosened by one percent; 0 if it is not
            active.
    """

    value: Array
    allowed: ArrayLike
    multiplier: Array

    @property
    def active(self) -> bool:
        """The limit holds the design back."""
        return bool(self.multiplier > 1e-9)


@record
class Design:
    """The best gradient for a contact and its load.

    Attributes:
        contact: The contact with the best material.
        reference: The contact as it was given.
        objective: What was minimised.
        value: The objective of the best contact, in SI units.
        reference_value: The objective of the reference.
        limits: How the best contact stands to each limit, by name.
        minimum: The minimum of the logarithm of the objective, with all that the search knows about it.
        question: What was asked, for `sensitivities` and `misjudged`.
        task: Its numbers.
    """

    contact: FrettingContact | GrossSlipContact
    reference: FrettingContact | GrossSlipContact
    objective: str
    value: Array
    reference_value: Array
    limits: dict[str, LimitState]
    minimum: Minimum
    question: _Question
    task: _Task

    @property
    def variables(self) -> dict[str, float]:
        """The values of what was varied, by name."""
        return {name: float(value) for name, value in self.minimum.variables.items()}

    @property
    def saving(self) -> float:
        """By which share of the reference's the objective is less."""
        return float(1.0 - self.value / self.reference_value)

    @property
    def at_bound(self) -> dict[str, Literal["lower", "upper"] | None]:
        """For each variable the bound it lies on, or None."""
        named: dict[int, Literal["lower", "upper"] | None] = {-1: "lower", 0: None, 1: "upper"}
        return {name: named[int(side)] for name, side in self.minimum.side.items()}

    @property
    def keeps_limits(self) -> bool:
        """No limit is broken by more than rounding."""
        return bool(jnp.max(self.minimum.limits, initial=-1.0) < _BROKEN)

    @property
    def converged(self) -> bool:
        """The search came to rest."""
        return bool(self.minimum.converged)

    @property
    def certified(self) -> bool:
        """Converged, and nothing better was met by the scan and the descents from its valleys."""
        return bool(self.minimum.certified)

    @property
    def proven(self) -> bool:
        """For one variable: nothing better can hide between the points of the scan; see `Minimum`."""
        return bool(self.minimum.proven)

    @property
    def rival(self) -> dict[str, float] | None:
        """The next best minimum, or None."""
        if not math.isfinite(self.minimum.rival_value):
            return None
        return {name: float(value) for name, value in self.minimum.rival.items()}

    @property
    def rival_value(self) -> float:
        """The objective of the rival, in SI units; infinite if there is none."""
        return float(self.value * jnp.exp(self.minimum.rival_value - self.minimum.value))


def design(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    *,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: Limits | None = None,
) -> Design:
    """Find the material that wears least in a contact.

    Args:
        contact: The contact with its reference material; its fields are numbers.
        tangential_force: Amplitude F_x in N, 0 < F_x < mu F_N, or several of them, shape (n,), with their weights. A
            history of amplitudes counts by its largest one alone. None for gross slip.
        vary: Bounds of the variables: "k"; "z0" in m or "E0" in Pa, on a logarithmic scale; or instead of all these
            "modulus", a `ModulusWindow`, whose two moduli are then the variables. Gross slip hangs on k alone.
        weight: Probabilities of the amplitudes, shape (n,), >= 0; by default all alike.
        level: Of the amplitudes, 0 takes the mean, 1 the worst case, between them the CVaR at that level: the mean over
            the worst 1 - level.
        hold: "contact_radius_by_E0" or "contact_radius_by_z0" keeps the initial contact radius at the reference's by
            adjusting E0 or z0. Then only k is left to vary, since E0 and z0 count only as E0/z0^k.
        minimise: "wear_volume" (the default), "worn_radius" or "deepest_wear"; for gross slip "volume_change" (the
            default) or "force_drop", the share of the normal force lost at a fixed depth, Eq. (10).
        limits: What the design has to keep to, at every amplitude.

    Returns:
        The best contact beside the reference.

    Raises:
        ValueError: An argument is outside its range, or the variables are none, unknown or redundant.

    Example:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.design(contact, 3.2, {"k": (-0.5, 0.5)}, hold="contact_radius_by_E0")
        >>> print(best.variables["k"], best.at_bound["k"])
        0.5 upper
    """
    question, task = _asked(contact, tangential_force, vary, weight, level, hold, minimise, limits or Limits())
    return _answered(question, task)


def _answered(question: _Question, task: _Task) -> Design:
    found = _search(question, task)
    best = _Candidate(question, task, {name: jnp.asarray(float(value)) for name, value in found.variables.items()})
    contact, value, states = _evaluated(question, task, best.variables)
    limits = {
        name: LimitState(value, allowed, multiplier)
        for (name, (value, allowed)), multiplier in zip(states.items(), found.multipliers, strict=True)
    }
    return Design(
        contact=jax.tree.map(float, contact),
        reference=task.contact,
        objective=question.objective,
        value=value,
        reference_value=_objective_of(task.contact, question, task),
        limits=limits,
        minimum=found,
        question=question,
        task=task,
    )


@functools.partial(jax.jit, static_argnums=0)
def _evaluated(question: _Question, task: _Task, variables: dict[str, Array]) -> Any:
    """The contact of a choice of the variables, its objective in SI units, and what is limited beside its limit."""
    at = _Candidate(question, task, variables)
    states = {name: (value, allowed) for name, (value, allowed, _) in at.states().items()}
    return at.contact, _objective_of(at.contact, question, task), states


def _objective_of(contact: FrettingContact | GrossSlipContact, question: _Question, task: _Task) -> Array:
    """The objective in SI units."""
    if isinstance(contact, GrossSlipContact):
        return getattr(contact, question.objective)()
    assert task.phi is not None and task.weight is not None
    force = task.phi * jnp.asarray(contact.friction) * jnp.asarray(contact.normal_force)
    return jnp.vdot(task.weight, getattr(contact, question.objective)(force))


@record
class Course:
    """What happens as one variable of a design changes and the others stay.

    Attributes:
        value: The objective in SI units, shape (n,).
        keeps_limits: Whether all limits are kept, shape (n,).
    """

    value: Array
    keeps_limits: Array


def along(found: Design, name: str, values: ArrayLike) -> Course:
    """The objective of a design as one of its variables changes and the others stay, for pictures of how flat it is.

    Args:
        found: The result of `design`.
        name: One of the variables.
        values: Its values, shape (n,), in SI units.

    Returns:
        The objective, and where the limits are kept.
    """
    if name not in found.variables:
        raise ValueError(f"{name!r} is not one of the variables {', '.join(found.variables)}")
    others = {other: jnp.asarray(value) for other, value in found.variables.items()}

    def at(value: Array) -> Course:
        candidate = _Candidate(found.question, found.task, others | {name: value})
        kept = jnp.max(candidate.excess()) < _BROKEN if found.limits else jnp.asarray(True)
        return Course(_objective_of(candidate.contact, found.question, found.task), kept)

    return jax.jit(jax.vmap(at))(jnp.asarray(values))


_BROKEN = 1e-6  # a limit's excess that is more than rounding


# --- many designs ---------------------------------------------------------------------------------------------------


@record
class Designs:
    """The best gradients for many contacts; every array has the shape of the batch.

    Attributes:
        variables: The best values of what was varied, by name.
        value: The objective of the best contacts, in SI units.
        saving: By which share of the reference's it is less.
        converged: The search came to rest.
        certified: Converged, within the limits, and nothing better was met; see `Design`.
        proven: Nothing better can hide between the points of the scan; see `Design`.
    """

    variables: dict[str, Array]
    value: Array
    saving: Array
    converged: Array
    certified: Array
    proven: Array


def designs(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    *,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: Limits | None = None,
) -> Designs:
    """Find the best material for each of many contacts or loads, in one compiled call.

    Works under `jit`, and is differentiable by the contact and the load.

    Args:
        contact: As for `design`; its fields may be arrays, whose shapes broadcast to that of the batch.
        tangential_force: As for `design`, one amplitude a design, of a shape that broadcasts with the fields; or with
            `weight` several for each, along a last axis of their own.
        vary: See `design`.
        weight: Probabilities of the amplitudes, of the shape of `tangential_force`; zero for those that do not count.
        level: See `design`.
        hold: See `design`.
        minimise: See `design`.
        limits: See `design`.

    Returns:
        The designs. Where nothing wears all numbers are NaN.

    Raises:
        ValueError: See `design`. Under `jit` what is outside its range gives NaN.

    Example:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.designs(contact, jnp.array([0.2, 3.2]), {"k": (-0.5, 0.5)}, hold="contact_radius_by_E0")
        >>> print(best.variables["k"])
        [-0.5  0.5]
    """
    limits = limits or Limits()
    question, bounds, depths = _questioned(contact, tangential_force, vary, hold, minimise, limits)
    phi = weights = None
    if isinstance(contact, FrettingContact):
        assert tangential_force is not None
        force = jnp.asarray(tangential_force)[..., None] if weight is None else jnp.asarray(tangential_force)
        single = jax.tree.map(lambda field: jnp.asarray(field)[..., None], contact)
        phi = single.amplitude(force)
        weights = jnp.ones_like(phi) if weight is None else jnp.broadcast_to(jnp.asarray(weight, phi.dtype), phi.shape)
        check("weight", weights, WEIGHT)
    return _designs(question, _Task(contact, phi, weights, bounds, depths, limits), jnp.asarray(level))


@functools.partial(jax.jit, static_argnums=0)
def _designs(question: _Question, task: _Task, level: Array) -> Designs:
    """The designs of a task whose contact is a batch, and whose amplitudes have a last axis besides."""
    fields, rebuild = jax.tree.flatten(task.contact)
    fields = [jnp.asarray(field) for field in fields]
    loads = () if task.phi is None else (task.phi, task.weight)
    shape = np.broadcast_shapes(*(field.shape for field in fields), *(load.shape[:-1] for load in loads))
    dtype = jnp.result_type(0.0, *fields, *loads)
    fields = [jnp.broadcast_to(field, shape).astype(dtype) for field in fields]
    loads = [jnp.broadcast_to(load, (*shape, load.shape[-1])).astype(dtype) for load in loads]

    def best(*numbers: Array) -> Designs:
        contact = jax.tree.unflatten(rebuild, numbers[: len(fields)])
        one = dataclasses.replace(task, contact=contact)
        if loads:
            phi, weight = numbers[len(fields) :]
            # The largest amplitude of any weight comes first and decides about limits; none that has no weight counts.
            weight = tail_weights(phi, weight, level)
            phi = jnp.where(weight > 0.0, phi, 0.0)
            order = jnp.argsort(-phi)
            one = dataclasses.replace(one, phi=phi[order], weight=weight[order])
        found = _search(question, one)
        value = _evaluated(question, one, found.variables)[1]
        reference = _objective_of(contact, question, one)
        defined = jnp.where(reference > 0.0, 1.0, jnp.nan)
        return Designs(
            variables={name: defined * variable for name, variable in found.variables.items()},
            value=defined * value,
            saving=defined * (1.0 - value / reference),
            converged=found.converged & (reference > 0.0),
            certified=found.certified & (reference > 0.0),
            proven=found.proven & (reference > 0.0),
        )

    return _in_chunks(best, shape, *fields, *loads)


# --- what is refused ------------------------------------------------------------------------------------------------

_FRETTING_OBJECTIVES = tuple(_POWERS)
_GROSS_SLIP_OBJECTIVES = ("volume_change", "force_drop")
_VARIABLES = {"k": EXPONENT, "z0": POSITIVE, "E0": POSITIVE}


def _asked(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    weight: ArrayLike | None,
    level: float,
    hold: Hold | None,
    objective: str | None,
    limits: Limits,
) -> tuple[_Question, _Task]:
    """The question and its numbers, or a ValueError."""
    question, bounds, depths = _questioned(contact, tangential_force, vary, hold, objective, limits)
    if isinstance(contact, GrossSlipContact):
        return question, _Task(contact, None, None, bounds, depths, limits)
    assert tangential_force is not None
    phi, weight = _loads(contact, tangential_force, weight, level)
    return question, _Task(contact, phi, weight, bounds, depths, limits)


def _questioned(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    hold: Hold | None,
    objective: str | None,
    limits: Limits,
) -> tuple[_Question, dict[str, tuple[ArrayLike, ArrayLike]], tuple[ArrayLike, ArrayLike] | None]:
    """The question, the bounds of the variables, and the depths of the moduli if they are these, or a ValueError."""
    slips = isinstance(contact, GrossSlipContact)
    objectives = _GROSS_SLIP_OBJECTIVES if slips else _FRETTING_OBJECTIVES
    if objective is None:
        objective = objectives[0]
    if objective not in objectives:
        raise ValueError(f"minimise = {objective!r} is not one of {', '.join(objectives)}")
    if hold not in (None, "contact_radius_by_E0", "contact_radius_by_z0"):
        raise ValueError(f'hold = {hold!r} is neither "contact_radius_by_E0", "contact_radius_by_z0" nor None')
    bounds, depths = _variables(vary, hold, contact.material.k)
    if slips:
        if set(bounds) != {"k"} or hold is not None or limits != Limits() or tangential_force is not None:
            raise ValueError("gross slip at a fixed depth hangs on k alone: nothing else to vary, hold, limit or load")
    elif tangential_force is None:
        raise ValueError("tangential_force: a fretting contact needs its amplitude")
    elif hold is not None and limits.contact_radius is not None:
        raise ValueError("limits: contact_radius is held")
    return _Question(objective, hold), bounds, depths


def _variables(
    vary: Mapping[str, Bounds | ModulusWindow], hold: str | None, k: ArrayLike
) -> tuple[dict[str, tuple[ArrayLike, ArrayLike]], tuple[ArrayLike, ArrayLike] | None]:
    """The bounds of the variables of the search, and the depths of the moduli if they are these."""
    window = vary.get("modulus")
    if window is not None:
        if not isinstance(window, ModulusWindow):
            raise ValueError(f"vary: modulus takes a ModulusWindow, not {window!r}")
        if set(vary) != {"modulus"}:
            raise ValueError("vary: modulus sets both k and E0/z0^k: nothing else can vary beside it")
        if hold is not None:
            text = "with the contact radius held only k is left: vary k, and put the window under limits"
            raise ValueError(f"vary: modulus sets both k and E0/z0^k; {text}")
        lowest, highest = window.exponents()
        if not (lowest > -1.0 and highest < 1.0):
            raise ValueError(f"vary: modulus allows k from {lowest:.3g} to {highest:.3g}: allowed is -1 < k < 1")
        ends = zip(window.lower, window.upper, strict=True)
        return dict(zip((_SHALLOW, _DEEP), ends, strict=True)), window.at
    bounds: dict[str, tuple[ArrayLike, ArrayLike]] = {}
    for name, pair in vary.items():
        if name not in _VARIABLES:
            raise ValueError(f"vary: {name!r} is not one of {', '.join(_VARIABLES)}, modulus")
        assert not isinstance(pair, ModulusWindow)
        lowest, highest = pair
        check(f"vary: lowest {name}", lowest, _VARIABLES[name])
        check(f"vary: highest {name}", highest, _VARIABLES[name])
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
        bounds[name] = (lowest, highest)
    if not bounds:
        raise ValueError(f"vary is empty: name at least one of {', '.join(_VARIABLES)}, modulus")
    if "z0" in bounds and "E0" in bounds:
        raise ValueError("vary: z0 and E0 count only as E0/z0^k: vary one of them")
    if hold is not None and set(bounds) != {"k"}:
        raise ValueError("vary: with the contact radius held only k is left to vary: z0 and E0 count only as E0/z0^k")
    if bounds.keys() == {"z0"} and not isinstance(k, Tracer) and np.any(np.equal(k, 0.0)):
        raise ValueError("vary: z0 has no effect at k = 0")
    if hold == "contact_radius_by_z0" and np.sign(bounds["k"][0]) * np.sign(bounds["k"][1]) <= 0.0:
        raise ValueError("hold: z0 cannot hold the contact radius at k = 0, where it has no effect: keep k to one side")
    return bounds, None


def _loads(
    contact: FrettingContact, tangential_force: ArrayLike, weight: ArrayLike | None, level: float
) -> tuple[Array, Array]:
    """Amplitudes phi and weights of those that count, the largest first."""
    force = np.atleast_1d(np.asarray(tangential_force))
    weight = np.ones(force.shape) if weight is None else np.asarray(weight)
    phi = np.asarray(contact.amplitude(force))
    counting = np.asarray(tail_weights(phi, weight, level))
    # The largest amplitude of any weight counts at every level, and comes first: it decides about the limits.
    order = np.argsort(-phi, kind="stable")
    order = order[counting[order] > 0.0]
    if phi[order[0]] == 0.0:
        raise ValueError("tangential_force = 0: nothing wears, so there is nothing to design")
    return jnp.asarray(phi[order]), jnp.asarray(counting[order])


# --- what a design hangs on -----------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Sensitivities:
    """How a design changes with what it was made for, by the implicit function theorem.

    Each is a derivative with respect to the logarithm of an input, that is per 100 % of it (k and nu: per unit).

    Attributes:
        variables: Of each variable (other than k: of its logarithm), by input.
        saving: Of the share that the best design saves against the reference, by input.
    """

    variables: dict[str, dict[str, float]]
    saving: dict[str, float]


def sensitivities(found: Design) -> Sensitivities:
    """The derivatives of a design with respect to every input of its scene.

    The inputs are E0, z0, k, nu (unless it is Holl's) of the reference; radius, normal_force, friction (gross slip:
    radius, depth) of the contact; tangential_force (all amplitudes alike); the bounds, such as "lowest k"; the limits.

    Args:
        found: The result of `design`.

    Returns:
        The derivatives by input.
    """
    names = tuple(_inputs(found.task))
    slopes = jax.device_get(_sensitivities(found.question, names, found.task, found.minimum))
    return Sensitivities(
        variables={
            name: {variable: float(slope[i]) for variable, slope in slopes["variables"].items()}
            for i, name in enumerate(names)
        },
        saving={name: float(slopes["saving"][i]) for i, name in enumerate(names)},
    )


@functools.partial(jax.jit, static_argnums=(0, 1))
def _sensitivities(question: _Question, names: tuple[str, ...], task: _Task, at: Minimum) -> Any:
    def outcome(changes: Array) -> Any:
        changed = _changed(task, dict(zip(names, changes, strict=True)))
        best = _search(question, changed, at)
        variables = {name: x if name == "k" else jnp.log(x) for name, x in best.variables.items()}
        value = _evaluated(question, changed, best.variables)[1]
        return {"variables": variables, "saving": 1.0 - value / _objective_of(changed.contact, question, changed)}

    return jax.jacrev(outcome)(jnp.zeros(len(names)))


def _inputs(task: _Task) -> dict[str, ArrayLike]:
    """All inputs but the amplitudes' own numbers, by the names that people are told."""
    contact, limits = task.contact, task.limits
    found: dict[str, Any] = {name: getattr(contact.material, name) for name in ("E0", "z0", "k", "nu")}
    found |= {field.name: getattr(contact, field.name) for field in dataclasses.fields(contact)[1:]}
    if task.phi is not None:
        found["tangential_force"] = 1.0
    for name, pair in task.bounds.items():
        found |= {f"{end} {name}": bound for end, bound in zip(_ENDS, pair, strict=True)}
    for name in ("edge_pressure", "distance", "penetration"):
        found |= {f"limit: {name}": getattr(limits, name)}
    found |= {f"limit: {end} contact_radius": x for end, x in zip(_ENDS, limits.contact_radius or (), strict=False)}
    return {name: value for name, value in found.items() if value is not None and not isinstance(value, str)}


_ENDS = ("lowest", "highest")


def _changed(task: _Task, changes: Mapping[str, Array]) -> _Task:
    """The task with its inputs changed: k and nu by a sum, all else by the logarithm of a factor."""
    values = {
        name: value + changes[name] if name.split()[-1] in ("k", "nu") else value * jnp.exp(changes[name])
        for name, value in _inputs(task).items()
        if name in changes
    }
    contact, limits = task.contact, task.limits
    material = {name: values[name] for name in ("E0", "z0", "k", "nu") if name in values}
    fields = {field.name: values[field.name] for field in dataclasses.fields(contact)[1:] if field.name in values}
    contact = dataclasses.replace(contact, material=dataclasses.replace(contact.material, **material), **fields)
    phi = task.phi
    if phi is not None:  # F_x/(mu F_N)
        for name, power in (("tangential_force", 1.0), ("friction", -1.0), ("normal_force", -1.0)):
            phi = phi * jnp.exp(power * changes.get(name, 0.0))
    bounds = {
        name: tuple(values.get(f"{end} {name}", bound) for end, bound in zip(_ENDS, pair, strict=True))
        for name, pair in task.bounds.items()
    }
    allowed = {name: values.get(f"limit: {name}", getattr(limits, name)) for name in _PLAIN_LIMITS}
    radii = limits.contact_radius and tuple(
        values.get(f"limit: {end} contact_radius", bound)
        for end, bound in zip(_ENDS, limits.contact_radius, strict=True)
    )
    limits = dataclasses.replace(limits, **allowed, contact_radius=radii)
    return dataclasses.replace(task, contact=contact, phi=phi, bounds=bounds, limits=limits)


_PLAIN_LIMITS = ("edge_pressure", "distance", "penetration")


@dataclasses.dataclass(frozen=True)
class Misjudged:
    """What a design loses if the load turns out another one than it was made for.

    Attributes:
        factor: The true amplitudes over the assumed ones.
        value: The objective of the design under the true load, in SI units.
        best: The design that would have been the best one.
        loss: By which share of the best the objective is more than it had to be. Below zero where the design breaks
            limits under the true load, which the best one keeps.
    """

    factor: float
    value: float
    best: Design
    loss: float


def misjudged(found: Design, factor: float = 1.1) -> Misjudged:
    """See what a design loses if all amplitudes are `factor` times those that it was made for.

    Args:
        found: The result of `design`.
        factor: The true amplitudes over the assumed ones, positive.

    Returns:
        The loss, and the design that would have been the best one.

    Raises:
        ValueError: The contact would slip as a whole, or has no amplitude.
    """
    check("factor", factor, POSITIVE)
    if found.task.phi is None:
        raise ValueError("gross slip has no amplitude to misjudge")
    check("factor * tangential_force/(friction * normal_force)", factor * found.task.phi, PARTIAL_SLIP)
    task = dataclasses.replace(found.task, phi=factor * found.task.phi)
    best = _answered(found.question, task)
    value = _objective_of(found.contact, found.question, task)
    return Misjudged(factor, float(value), best, float(value / best.value - 1.0))


# --- the trade-off --------------------------------------------------------------------------------------------------


@record
class Front:
    """The least wear for each edge pressure that may be allowed, from the lowest possible to that of the least wear.

    Attributes:
        edge_pressure: The limit of the pressure in Pa at the critical distance, shape (points,), rising.
        value: The objective in SI units, shape (points,), falling.
        variables: The best variables, each of shape (points,).
        converged: Whether each search came to rest; a front is right where this holds.
        certified: Whether nothing better was met.
        distance: The critical distance in m.
        objective: What was minimised.
    """

    edge_pressure: Array
    value: Array
    variables: dict[str, Array]
    converged: Array
    certified: Array
    distance: ArrayLike
    objective: str


def front(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    vary: Mapping[str, Bounds | ModulusWindow],
    *,
    distance: float,
    points: int = 41,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: Limits | None = None,
) -> Front:
    """The trade-off between wear and the pressure beside the stick edge: the least of the one for each of the other.

    Args:
        contact: As for `design`, and so are all arguments not named here.
        tangential_force: See `design`.
        vary: See `design`.
        distance: Critical distance in m inside the stick edge at which the pressure is taken, positive.
        points: How many edge pressures, at least 2.
        weight: See `design`.
        level: See `design`.
        hold: See `design`.
        minimise: See `design`.
        limits: Other limits to keep to; without an edge pressure.

    Returns:
        The front; every point is a design, and all are found in one call.

    Raises:
        ValueError: See `design`; or the limits already hold an edge pressure.
    """
    limits = limits or Limits()
    if limits.edge_pressure is not None:
        raise ValueError("limits: the front itself sets the edge pressure")
    check("distance", distance, DISTANCE)
    if points < 2:
        raise ValueError(f"points = {points}: at least 2")
    limits = dataclasses.replace(limits, distance=distance)
    question, task = _asked(contact, tangential_force, vary, weight, level, hold, minimise, limits)
    if not isinstance(contact, FrettingContact):
        raise ValueError("gross slip has no stick edge")
    return _front(question, task, points)


@functools.partial(jax.jit, static_argnums=(0, 2))
def _front(question: _Question, task: _Task, points: int) -> Front:
    def pressure(variables: dict[str, Array]) -> Array:
        return _Candidate(question, task, variables).edge_pressure()

    gentlest = _search(question._replace(objective="edge_pressure"), task)
    least = _search(question, task)
    ends = [jnp.log(pressure(best.variables)) for best in (gentlest, least)]
    allowed = jnp.exp(jnp.linspace(ends[0], ends[1], points))

    def best(allowed: Array) -> Minimum:
        limits = dataclasses.replace(task.limits, edge_pressure=allowed)
        return _search(question, dataclasses.replace(task, limits=limits))

    # At its ends the front is known, and the search would have a single point left there.
    inner = jax.vmap(best)(allowed[1:-1])

    def joined(first: Array, middle: Array, last: Array) -> Array:
        return jnp.concatenate([first[None], middle, last[None]])

    variables = jax.tree.map(joined, gentlest.variables, inner.variables, least.variables)
    converged, certified = (
        joined(getattr(gentlest, name), getattr(inner, name), getattr(least, name))
        for name in ("converged", "certified")
    )
    value = jax.vmap(lambda variables: _evaluated(question, task, variables)[1])(variables)
    distance = jnp.asarray(task.limits.distance)
    return Front(allowed, value, variables, converged, certified, distance, question.objective)
