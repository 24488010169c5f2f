"""The best gradients for many contacts in one call."""

import dataclasses
import functools
from collections.abc import Callable, Mapping
from typing import Any, Unpack

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import NUMBER, check, nan_outside, nan_unless, record
from plgwear_jax._core.startup.programs import traced
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.loads import PARTIAL_SLIP
from plgwear_jax.steady.arguments import own_axes

from .best import answered
from .evaluation import Candidate, plan_for, shared_of, space
from .exponent import BATCH, in_chunks
from .question import Bounds, Keywords, LoadGiven, Question, hardest, parts_of, solved_in_turn, solved_one_by_one
from .scenarios import WeightedLoad, falling, spread, weighted_load
from .search import minimise


@record
class Designs:
    """The best gradients for many contacts; every array has the shape of the batch.

    Attributes:
        variables: The best values of what was varied, by name.
        value: The objective of the best contacts, in SI units.
        saving: The share by which it is less than that of the reference.
        converged: The search ended at a minimum.
        certified: Converged, within the limits, and nothing better was found; see `Design`.
        scan_found_nothing_better: Nothing better is expected between the points of the scan; no proof, see `Minimum`.
    """

    variables: dict[str, Array]
    value: Array
    saving: Array
    converged: Array
    certified: Array
    scan_found_nothing_better: Array


def designs(
    contact: FrettingContact | GrossSlipContact,
    load: LoadGiven,
    vary: Mapping[str, Bounds],
    **keywords: Unpack[Keywords],
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
        **keywords: See `Keywords`, without scenarios. The weights have a shape that broadcasts with that of the
            amplitudes, zero for padding; cycles, law and limits may be arrays, whose shapes broadcast to that of the
            batch.

    Returns:
        The designs. At an amplitude of 0, where nothing wears, all numbers are NaN.

    Raises:
        ValueError: See `design`. Under `jit` values outside their range give NaN.

    Examples:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> best = optimise.designs(contact, jnp.array([0.2, 3.2]), {"k": (-0.5, 0.5)}, hold="contact_radius")
        >>> print(best.variables["k"])
        [-0.5  0.5]
        >>> print(best.value)  # m^3
        [6.62736508e-19 3.38602833e-15]

    References:
        As `design`.
    """
    if keywords.get("scenarios") is not None:
        raise ValueError("scenarios: designs takes none; ask design for each of them")
    question, level = parts_of(contact, load, vary, **keywords), keywords.get("level", 0.0)
    weighted: Any = question.load
    if weighted is None:
        return _designs_in_a_batch(question, level)
    if weighted.weight is not None:
        check("weight", weighted.weight, NUMBER)
    if weighted.amplitudes is not None:
        force = jnp.asarray(weighted.amplitudes)
        pairs = (force[..., None], jnp.ones(1)) if weighted.weight is None else (force, jnp.asarray(weighted.weight))
        question = dataclasses.replace(question, load=weighted.with_amplitudes(*jnp.broadcast_arrays(*pairs)))
    weighted = question.load
    if question.by_force:
        phi = nan_outside(*hardest(question), PARTIAL_SLIP)
        # NaN where traced numbers are outside their ranges
        weighted = weighted.with_amplitudes(weighted.amplitudes + 0.0 * phi, weighted.weight)
    elif weighted.weight is None:
        weighted = WeightedLoad(weighted.load, jnp.ones(1))
    question = dataclasses.replace(question, load=weighted)
    in_turn = solved_one_by_one(question) and not traced((question, level))
    return (_designs_in_turn if in_turn else _designs_in_a_batch)(question, level)


def _batch_of(question: Question, xp: Any) -> tuple[tuple[int, ...], list[Any], Callable[..., Question]]:
    """The shape of a batch of questions, their numbers with the axes of the batch first, and what makes one of them."""
    leaves, rebuild = jax.tree.flatten(question)
    own, load = own_axes(question), question.load
    if load is not None and load.amplitudes is not None:  # they have an axis of their own, as their weights do
        own[len(jax.tree.leaves(question.contact))] = 1
    dtype = jnp.result_type(0.0, *leaves)
    return *spread([xp.asarray(leaf, dtype) for leaf in leaves], own, xp), rebuild.unflatten


def _designs_in_turn(question: Question, level: float) -> Designs:
    """The designs of known numbers, by the program of a single one."""
    shape, numbers, one_of = _batch_of(question, np)
    nothing: Any = dict.fromkeys(question.bounds, np.nan), np.nan, np.nan, False, False, False
    found = [Designs(*nothing)]  # where nothing wears
    for place in np.ndindex(shape):
        one: Any = one_of(x[place] for x in numbers)
        load, best = one.load, found[0]
        if load.amplitudes is None or np.any(load.amplitudes * load.weight):
            best = answered(dataclasses.replace(one, load=weighted_load(one.contact, load, level)))
        found.append(Designs(*(getattr(best, field.name) for field in dataclasses.fields(Designs))))
    return jax.tree.map(lambda *leaves: jnp.asarray(np.reshape(leaves[1:], shape).astype(type(leaves[0]))), *found)


@jax.jit
def _designs_in_a_batch(question: Question, level: Array) -> Designs:
    """The designs of a question whose contact is a batch, and whose amplitudes have one more axis at the end."""
    shape, numbers, one_of = _batch_of(question, jnp)
    plan = plan_for(question)

    def best(*numbers: Array) -> Designs:
        one = one_of(numbers)
        load = one.load
        if load is not None and load.amplitudes is not None:
            one = dataclasses.replace(one, load=load.with_amplitudes(*falling(load.amplitudes, load.weight, level)[:2]))
        shared = shared_of(one)
        candidate = functools.partial(Candidate, one, shared=shared)
        found = minimise(
            lambda variables: candidate(variables).objective(),
            space(one),
            limits=lambda variables: candidate(variables).rows()[1:],
            samples=plan.samples,
            starts=plan.starts,
            axis_name=BATCH,
        )
        worn = shared.scale > 0.0
        told: Any = found.variables, jnp.exp(found.value) * shared.scale, -jnp.expm1(found.value)
        return Designs(
            *jax.tree.map(functools.partial(nan_unless, worn), told),
            converged=found.converged & worn,
            certified=found.certified & worn,
            scan_found_nothing_better=found.scan_found_nothing_better & worn,
        )

    if not solved_in_turn(question):
        return in_chunks(best, shape, *numbers)
    return in_chunks(best, shape, *map(_without_slopes, numbers), most=1)


@jax.custom_jvp
def _without_slopes(x: Array) -> Array:
    return x


@_without_slopes.defjvp
def _refuse_slopes(primals: Any, tangents: Any) -> Any:
    text = "has no derivatives by the numbers of a contact without closed forms, nor for a life of several runs"
    raise ValueError(f"designs: {text}; optimise.sensitivities(optimise.design(...)) gives them")
