"""The best gradients for many contacts in one call."""

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import ArrayLike, check, check_real
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import traced
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.optimise.candidate import Candidate, reference_variables, space
from plgwear_jax.optimise.designing import answered
from plgwear_jax.optimise.evaluation import plan_for
from plgwear_jax.optimise.exponent import BATCH, in_chunks
from plgwear_jax.optimise.life import amplitudes_and_test, life_of
from plgwear_jax.optimise.loads import WEIGHT, falling
from plgwear_jax.optimise.minimum import Minimum, minimise
from plgwear_jax.optimise.question import (
    Bounds,
    Hold,
    LimitsGiven,
    Load,
    LoadGiven,
    ModulusWindow,
    Objective,
    Question,
    limits_by_name,
    load_of,
    question_without_load,
    read_from_runs,
    solved_one_by_one,
)
from plgwear_jax.optimise.scenarios import own_axes
from plgwear_jax.steady.arguments import amplitude_of
from plgwear_jax.wear_laws import WearLaw

if TYPE_CHECKING:  # designs for the steady state do not need it
    from plgwear_jax.optimise.along_exponent import RunsAlongExponent


@record
class Designs:
    """The best gradients for many contacts; every array has the shape of the batch.

    Attributes:
        variables: The best values of what was varied, by name.
        value: The objective of the best contacts, in SI units.
        saving: The share by which it is less than that of the reference.
        converged: The search ended at a minimum.
        certified: Converged, within the limits, and nothing better was found; see `Design`.
        proven: Nothing better is expected between the points of the scan; no proof, see `Minimum`.
    """

    variables: dict[str, Array]
    value: Array
    saving: Array
    converged: Array
    certified: Array
    proven: Array


def designs(
    contact: FrettingContact | GrossSlipContact,
    load: LoadGiven,
    vary: Mapping[str, Bounds | ModulusWindow],
    *,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: Objective | None = None,
    limits: LimitsGiven | None = None,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | WearLaw | None = None,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> Designs:
    """Find the best material for each of many contacts or loads, in one compiled call.

    Works under `jit`. Designs of contacts with closed forms can be differentiated with respect to the contact and the
    load: those for the steady state, and those for the volume worn in a life if k, E0, z0 or the radius vary alone. All
    others are looked for one after the other, and have no derivatives: the search of one design needs the first
    derivatives already, and `sensitivities` takes differences of them.

    Args:
        contact: As for `design`; its fields may be arrays, whose shapes broadcast to that of the batch.
        load: As for `design`, one force amplitude per design, of a shape that broadcasts with the fields;
            or with `weight` several per design, along a last axis.
        vary: See `design`. Its bounds are numbers, not traced values.
        weight: Probabilities of the amplitudes, of a shape that broadcasts with theirs; zero for padding.
        level: See `design`.
        hold: See `design`.
        minimise: See `design`.
        limits: See `design`.
        cycles: See `design`; it may be an array whose shape broadcasts to that of the batch, as the next ones.
        wear_coefficient: See `design`.
        control: See `design`.
        rig_stiffness: See `design`.

    Returns:
        The designs. At an amplitude of 0, where nothing wears, all numbers are NaN.

    Raises:
        ValueError: See `design`. Under `jit` values outside their range give NaN.

    Examples:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.designs(contact, jnp.array([0.2, 3.2]), {"k": (-0.5, 0.5)}, hold="contact_radius_by_E0")
        >>> print(best.variables["k"])
        [-0.5  0.5]

    References:
        As `design`.
    """
    question = question_without_load(contact, load, vary, hold, minimise, limits)
    force, test = amplitudes_and_test(load, weight)
    life = life_of(question.objective, question.limits, cycles, wear_coefficient, control, rig_stiffness, test)
    if isinstance(contact, FrettingContact):
        question = dataclasses.replace(question, load=Load(force, weight, life))
        if solved_one_by_one(question) and not traced((question, level)):
            return _one_by_one(question, level)
        if test is not None:
            alone = Load(jnp.full(1, jnp.nan), jnp.ones(1), life)
            return _designs(dataclasses.replace(question, load=alone), jnp.asarray(level))
        check_real("load", force)
        force = jnp.asarray(force)[..., None] if weight is None else jnp.asarray(force)
        pressed = {name: jnp.asarray(getattr(contact, name))[..., None] for name in ("normal_force", "friction")}
        phi = amplitude_of(dataclasses.replace(contact, **pressed), force)
        force = force + 0.0 * phi  # NaN where traced numbers are outside their ranges
        weights = jnp.ones_like(phi) if weight is None else jnp.asarray(weight, phi.dtype)
        check("weight", weights, WEIGHT)
        force, weights = jnp.broadcast_arrays(force, weights)
        question = dataclasses.replace(question, load=Load(force, weights, life))
    return _designs(question, jnp.asarray(level))


def _one_by_one(question: Question, level: float) -> Designs:
    """The designs of known numbers, by the program of a single one."""
    load = question.load
    assert load is not None
    fields, rebuild = jax.tree.flatten((question.contact, load.life))
    forces = np.asarray(load.tangential_force, float)
    weights = np.ones((1,)) if load.weight is None else np.asarray(load.weight, float)
    forces = forces[..., None] if load.weight is None else forces
    check("weight", weights, WEIGHT)
    forces, weights = np.broadcast_arrays(forces, weights)
    fields, own = [np.asarray(field, float) for field in fields], own_axes(question.contact, len(fields))
    singles = [field.shape[: field.ndim - n] for field, n in zip(fields, own, strict=True)]
    shape = np.broadcast_shapes(*singles, forces.shape[:-1])

    def rows_of(x: np.ndarray, n: int) -> np.ndarray:
        last = x.shape[x.ndim - n :]
        return np.broadcast_to(x, (*shape, *last)).reshape(-1, *last)

    each = [rows_of(field, n) for field, n in zip(fields, own, strict=True)]
    nothing: Any = (dict.fromkeys(question.bounds, np.nan), np.nan, np.nan, False, False, False)
    found = [nothing]
    loads = zip(rows_of(forces, 1), rows_of(weights, 1), strict=True)
    for i, (force, share) in enumerate(loads):
        if np.all((force == 0.0) | (share == 0.0)):
            found.append(nothing)
            continue
        contact, life = jax.tree.unflatten(rebuild, [field[i] for field in each])
        load = load_of(contact, force, share, level, life)
        best = answered(dataclasses.replace(question, contact=contact, load=load))
        known = best.converged, best.certified, best.proven
        found.append((best.variables, float(best.value), best.saving, *known))
    # The first one says of which kind the entries are, also of no design at all.
    of_all = jax.tree.map(lambda kind, *parts: jnp.asarray(np.array(parts, type(kind)).reshape(shape)), *found)
    return Designs(*of_all)


@jax.jit
def _designs(question: Question, level: Array) -> Designs:
    """The designs of a question whose contact is a batch, and whose amplitudes have one more axis at the end."""
    fields, rebuild = jax.tree.flatten((question.contact, question.life))
    fields = [jnp.asarray(field) for field in fields]
    loads = () if question.load is None else (question.load.tangential_force, question.load.weight)
    own = own_axes(question.contact, len(fields))
    shape = np.broadcast_shapes(
        *(field.shape[: field.ndim - n] for field, n in zip(fields, own, strict=True)),
        *(load.shape[:-1] for load in loads),
    )
    dtype = jnp.result_type(0.0, *fields, *loads)
    fields = [
        jnp.broadcast_to(field, (*shape, *field.shape[field.ndim - n :])).astype(dtype)
        for field, n in zip(fields, own, strict=True)
    ]
    loads = [jnp.broadcast_to(load, (*shape, load.shape[-1])).astype(dtype) for load in loads]

    def best(*numbers: Array) -> Designs:
        contact, life = jax.tree.unflatten(rebuild, numbers[: len(fields)])
        one = dataclasses.replace(question, contact=contact)
        if loads:
            force, weight = numbers[len(fields) :]
            force, counting = falling(force, weight, level)
            life = None if life is None else life.under(contact, force)
            one = dataclasses.replace(one, load=Load(force, counting, life))
        runs = None
        if read_from_runs(one):
            from plgwear_jax.optimise.along_exponent import runs_of  # only lives need it

            runs = runs_of(one)
        found = minimum_of(one, runs)
        reference = Candidate(one, reference_variables(one), runs=runs).objective()
        worn = reference > -jnp.inf
        defined = jnp.where(worn, 1.0, jnp.nan)
        unit = Candidate(one, {}).log_unit()
        return Designs(
            variables={name: defined * variable for name, variable in found.variables.items()},
            value=defined * jnp.exp(found.value + unit),
            saving=defined * -jnp.expm1(found.value - jnp.where(worn, reference, 0.0)),
            converged=found.converged & worn,
            certified=found.certified & worn,
            proven=found.proven & worn,
        )

    if not solved_one_by_one(question) or read_from_runs(question):
        return in_chunks(best, shape, *fields, *loads)
    return in_chunks(best, shape, *map(_without_slopes, (*fields, *loads)), most=1)


@jax.custom_jvp
def _without_slopes(x: Array) -> Array:
    return x


@_without_slopes.defjvp
def _refuse_slopes(primals: Any, tangents: Any) -> Any:
    text = "has no derivatives by the numbers of a contact without closed forms, nor for a life of several runs"
    raise ValueError(f"designs: {text}; optimise.sensitivities(optimise.design(...)) gives them")


def minimum_of(question: Question, runs: "RunsAlongExponent | None" = None) -> Minimum:
    """The minimum of the logarithm of the objective, within a compiled program."""

    def limits(variables: dict[str, Array]) -> Array:
        return jnp.stack(jnp.broadcast_arrays(*Candidate(question, variables, runs=runs).excess()))

    plan = plan_for(question)
    return minimise(
        lambda variables: Candidate(question, variables, runs=runs).objective(),
        space(question),
        limits=limits if limits_by_name(question.limits) else None,
        samples=plan.samples,
        starts=plan.starts,
        axis_name=BATCH,
    )
