"""The best gradient for a contact and its load, for one contact or for many."""

import dataclasses
import functools
import math
from collections.abc import Mapping
from typing import Any, Literal

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.record import record
from plgwear_jax.contact import PARTIAL_SLIP, FrettingContact, GrossSlipContact
from plgwear_jax.optimise.exponent import BATCH, in_chunks
from plgwear_jax.optimise.loads import WEIGHT, tail_weights
from plgwear_jax.optimise.minimum import Minimum, minimise
from plgwear_jax.optimise.problem import (
    BROKEN,
    Bounds,
    Candidate,
    Hold,
    Limits,
    ModulusWindow,
    Objective,
    Question,
    Task,
    asked,
    evaluate,
    limits_by_name,
    questioned,
    reference_variables,
    rows,
    search,
    space,
)

__all__ = ["Course", "Design", "Designs", "LimitState", "Misjudged", "along", "design", "designs", "misjudged"]


@record
class LimitState:
    """The value of a design for one of its limits.

    Attributes:
        value: The limited quantity, in SI units.
        allowed: The limit.
        multiplier: By how many percent the objective falls if the limit is loosened by one percent; 0 if it is not
            active.
    """

    value: Array
    allowed: ArrayLike
    multiplier: Array

    @property
    def active(self) -> bool:
        """The design reaches the limit, and would be better without it."""
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
        limits: The value of the best contact for each limit, by name.
        minimum: The minimum of the logarithm of the objective, with what is certain about it.
        question: The question without its numbers, for `sensitivities` and `misjudged`.
        task: The numbers of the question.
    """

    contact: FrettingContact | GrossSlipContact
    reference: FrettingContact | GrossSlipContact
    objective: str
    value: Array
    reference_value: Array
    limits: dict[str, LimitState]
    minimum: Minimum
    question: Question
    task: Task

    @property
    def variables(self) -> dict[str, float]:
        """The values of what was varied, by name."""
        return {name: float(value) for name, value in self.minimum.variables.items()}

    @property
    def reference_variables(self) -> dict[str, float]:
        """The values of the reference for what was varied, by name."""
        return {name: float(np.asarray(value)) for name, value in reference_variables(self.task).items()}

    @property
    def saving(self) -> float:
        """The share by which the objective is less than that of the reference."""
        return float(1.0 - self.value / self.reference_value)

    @property
    def at_bound(self) -> dict[str, Literal["lower", "upper"] | None]:
        """For each variable the bound it lies on, or None."""
        named: dict[int, Literal["lower", "upper"] | None] = {-1: "lower", 0: None, 1: "upper"}
        return {name: named[int(side)] for name, side in self.minimum.side.items()}

    @property
    def keeps_limits(self) -> bool:
        """No limit is broken by more than rounding."""
        return bool(np.max(self.minimum.limits, initial=-1.0) < BROKEN)

    @property
    def converged(self) -> bool:
        """The search ended at a minimum."""
        return bool(self.minimum.converged)

    @property
    def certified(self) -> bool:
        """Converged, and neither the scan nor the descents from its valleys found anything better."""
        return bool(self.minimum.certified)

    @property
    def proven(self) -> bool:
        """For one variable: nothing better can lie between the points of the scan; see `Minimum`."""
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
        return float(self.value * np.exp(self.minimum.rival_value - self.minimum.value))


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
    """Find the half-space or coating on which the indenter wears least.

    Args:
        contact: The contact with its reference material; its fields are numbers.
        tangential_force: Force amplitude F_x in N, 0 < F_x < mu F_N, or several, shape (n,), with their weights. Of a
            history of amplitudes give the largest one. None for gross slip.
        vary: Bounds of the variables: "k"; "z0" in m or "E0" in Pa, on a logarithmic scale; or instead of all these
            "modulus", a `ModulusWindow`, whose two moduli are then the variables. Gross slip depends on k alone.
        weight: Probabilities of the amplitudes, shape (n,), >= 0; by default all equal.
        level: 0 takes the mean over the amplitudes, 1 the worst case; between them the CVaR at that level, the mean
            over the worst 1 - level.
        hold: "contact_radius_by_E0" or "contact_radius_by_z0" keeps the initial contact radius of the reference by
            adjusting E0 or z0. Then only k can vary, since a contact depends on E0 and z0 only through E0/z0^k.
        minimise: "wear_volume" (the default), "worn_radius" or "deepest_wear"; for gross slip "volume_change" (the
            default) or "force_drop", the share of the normal force lost at a fixed depth, Eq. (10).
        limits: The limits of the design, to be kept at every amplitude.

    Returns:
        The best contact beside the reference.

    Raises:
        ValueError: An argument is outside its range, or the variables are missing, unknown or redundant.

    Example:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.design(contact, 3.2, {"k": (-0.5, 0.5)}, hold="contact_radius_by_E0")
        >>> print(best.variables["k"], best.at_bound["k"])
        0.5 upper
    """
    return answered(*asked(contact, tangential_force, vary, weight, level, hold, minimise, limits))


def answered(question: Question, task: Task) -> Design:
    """The design of a task."""
    found, reference = search(question, task), reference_variables(task)
    at = evaluate(question, task, {name: np.stack([found.variables[name], reference[name]]) for name in task.bounds})
    value, reference_value = np.exp(at.values[:, 0] + at.log_unit)
    return Design(
        contact=dataclasses.replace(task.contact, material=jax.tree.map(lambda field: float(field[0]), at.materials)),
        reference=task.contact,
        objective=question.objective,
        value=value,
        reference_value=reference_value,
        limits=_states(task, at.values[0], found.multipliers),
        minimum=found,
        question=question,
        task=task,
    )


def _states(task: Task, values: np.ndarray, multipliers: Any) -> dict[str, LimitState]:
    """The values for the limits at a choice of the variables, from the result of `rows`."""
    excess = zip(limits_by_name(task.limits).items(), values[1:], multipliers, strict=True)
    return {
        name: LimitState(float(np.asarray(allowed)) * np.exp(-over if name.endswith("_lowest") else over), allowed, by)
        for (name, allowed), over, by in excess
    }


@record
class Course:
    """The objective as one variable of a design changes and the others stay.

    Attributes:
        value: The objective in SI units, shape (n,).
        keeps_limits: Whether all limits are kept, shape (n,).
    """

    value: Array
    keeps_limits: Array


def along(found: Design, name: str, values: ArrayLike) -> Course:
    """The objective of a design as one of its variables changes and the others stay, for pictures.

    Args:
        found: The result of `design`.
        name: One of the variables.
        values: Its values, shape (n,), in SI units.

    Returns:
        The objective, and where the limits are kept.
    """
    if name not in found.variables:
        raise ValueError(f"{name!r} is not one of the variables {', '.join(found.variables)}")
    values = np.asarray(values)
    points = {other: np.full(values.shape, value) for other, value in found.variables.items()} | {name: values}
    at = evaluate(found.question, found.task, points)
    return Course(np.exp(at.values[:, 0] + at.log_unit), np.max(at.values[:, 1:], axis=1, initial=-1.0) < BROKEN)


# --- another load -----------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Misjudged:
    """What a design loses under a load that it was not made for.

    Attributes:
        factor: The true amplitudes over the assumed ones.
        value: The objective of the design under the true load, in SI units.
        best: The best design for the true load.
        loss: The share by which the objective is more than that of the best. Below zero where the design breaks limits
            under the true load, which the best one keeps.
        limits: The values of the design for its limits under the true load, by name; without multipliers.
    """

    factor: float
    value: float
    best: Design
    loss: float
    limits: dict[str, LimitState]


def misjudged(found: Design, factor: float = 1.1) -> Misjudged:
    """What a design loses if all force amplitudes are `factor` times those that it was made for.

    Args:
        found: The result of `design`.
        factor: The true amplitudes over the assumed ones, positive.

    Returns:
        The loss, and the best design for the true load.

    Raises:
        ValueError: The whole contact would slip, or the contact is one of gross slip, without an amplitude.
    """
    check("factor", factor, POSITIVE)
    if found.task.phi is None:
        raise ValueError("gross slip has no amplitude to misjudge")
    phi = factor * np.asarray(found.task.phi)
    check("factor * tangential_force/(friction * normal_force)", phi, PARTIAL_SLIP)
    task = dataclasses.replace(found.task, phi=phi)
    best = answered(found.question, task)
    at = evaluate(found.question, task, found.variables)
    value = float(np.exp(at.values[0, 0] + at.log_unit))
    states = _states(task, at.values[0], np.zeros(at.values.shape[1] - 1))
    return Misjudged(factor, value, best, value / float(best.value) - 1.0, states)


# --- many designs -----------------------------------------------------------------------------------------------------


@record
class Designs:
    """The best gradients for many contacts; every array has the shape of the batch.

    Attributes:
        variables: The best values of what was varied, by name.
        value: The objective of the best contacts, in SI units.
        saving: The share by which it is less than that of the reference.
        converged: The search ended at a minimum.
        certified: Converged, within the limits, and nothing better was found; see `Design`.
        proven: Nothing better can lie between the points of the scan; see `Design`.
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

    Works under `jit`, and can be differentiated with respect to the contact and the load.

    Args:
        contact: As for `design`; its fields may be arrays, whose shapes broadcast to that of the batch.
        tangential_force: As for `design`, one force amplitude per design, of a shape that broadcasts with the fields;
            or with `weight` several per design, along a last axis.
        vary: See `design`.
        weight: Probabilities of the amplitudes, of the shape of `tangential_force`; zero for padding.
        level: See `design`.
        hold: See `design`.
        minimise: See `design`.
        limits: See `design`.

    Returns:
        The designs. At an amplitude of 0, where nothing wears, all numbers are NaN.

    Raises:
        ValueError: See `design`. Under `jit` values outside their range give NaN.

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
    question, bounds, depths = questioned(contact, tangential_force, vary, hold, minimise, limits)
    phi = weights = None
    if isinstance(contact, FrettingContact):
        assert tangential_force is not None
        force = jnp.asarray(tangential_force)[..., None] if weight is None else jnp.asarray(tangential_force)
        single = jax.tree.map(lambda field: jnp.asarray(field)[..., None], contact)
        phi = single.amplitude(force)
        weights = jnp.ones_like(phi) if weight is None else jnp.broadcast_to(jnp.asarray(weight, phi.dtype), phi.shape)
        check("weight", weights, WEIGHT)
    return _designs(question, Task(contact, phi, weights, bounds, depths, limits), jnp.asarray(level))


@functools.partial(jax.jit, static_argnums=0)
def _designs(question: Question, task: Task, level: Array) -> Designs:
    """The designs of a task whose contact is a batch, and whose amplitudes have one more axis at the end."""
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
            # The largest amplitude that has a weight comes first, and the limits are checked at it.
            weight = tail_weights(phi, weight, level)
            phi = jnp.where(weight > 0.0, phi, 0.0)
            order = jnp.argsort(-phi)
            one = dataclasses.replace(one, phi=phi[order], weight=weight[order])
        found = minimum_of(question, one)
        reference = rows(question, dataclasses.replace(one, limits=Limits()), reference_variables(one))[0]
        worn = reference > -jnp.inf
        defined = jnp.where(worn, 1.0, jnp.nan)
        unit = Candidate(question, one, {}).log_unit()
        return Designs(
            variables={name: defined * variable for name, variable in found.variables.items()},
            value=defined * jnp.exp(found.value + unit),
            saving=defined * -jnp.expm1(found.value - jnp.where(worn, reference, 0.0)),
            converged=found.converged & worn,
            certified=found.certified & worn,
            proven=found.proven & worn,
        )

    return in_chunks(best, shape, *fields, *loads)


def minimum_of(question: Question, task: Task) -> Minimum:
    """The minimum of the logarithm of the objective, within a compiled program."""

    def limits(variables: dict[str, Array]) -> Array:
        return jnp.stack(jnp.broadcast_arrays(*Candidate(question, task, variables).excess()))

    return minimise(
        lambda variables: Candidate(question, task, variables).objective(),
        space(task),
        limits=limits if limits_by_name(task.limits) else None,
        axis_name=BATCH,
    )
