"""The best gradients for many contacts in one call."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any, Unpack

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import check, check_real
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import traced
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.loads import Force
from plgwear_jax.optimise.best import answered
from plgwear_jax.optimise.evaluation import (
    Candidate,
    Shared,
    plan_for,
    shared_of,
    space,
)
from plgwear_jax.optimise.exponent import BATCH, in_chunks
from plgwear_jax.optimise.question import (
    Bounds,
    Keywords,
    LoadGiven,
    Question,
    parts_of,
    read_from_runs,
    solved_one_by_one,
)
from plgwear_jax.optimise.scenarios import WEIGHT, WeightedLoad, falling, own_axes, weighted_load
from plgwear_jax.optimise.search import Minimum, minimise
from plgwear_jax.steady.arguments import amplitude_of


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

    References:
        As `design`.
    """
    if keywords.get("scenarios") is not None:
        raise ValueError("scenarios: designs takes none; ask design for each of them")
    question, given = parts_of(contact, load, vary, **keywords)
    level, weight = jnp.asarray(keywords.get("level", 0.0)), keywords.get("weight")
    if given is None:
        return _designs_in_a_batch(question, level)
    if weight is not None:
        check("weight", weight, WEIGHT)
    question = dataclasses.replace(question, load=WeightedLoad(given, weight))
    if solved_one_by_one(question) and not traced((question, level)):
        return _designs_in_turn(question, keywords.get("level", 0.0))
    if not question.by_force:
        alone = given.with_amplitude(lambda x: jnp.asarray(x)[..., None]) if given.lasts else given
        return _designs_in_a_batch(dataclasses.replace(question, load=WeightedLoad(alone, jnp.ones(1))), level)
    force = jnp.asarray(given.amplitude)
    check_real("load", force)
    force = force[..., None] if weight is None else force
    pressed = {name: jnp.asarray(getattr(contact, name))[..., None] for name in ("normal_force", "friction")}
    phi = amplitude_of(dataclasses.replace(question.contact, **pressed), force)
    force = force + 0.0 * phi  # NaN where traced numbers are outside their ranges
    weights = jnp.ones_like(phi) if weight is None else jnp.asarray(weight, phi.dtype)
    force, weights = jnp.broadcast_arrays(force, weights)
    return _designs_in_a_batch(dataclasses.replace(question, load=WeightedLoad(Force(force), weights)), level)


class _Batch:
    """The numbers of a batch of questions, each with the axes of the batch first."""

    def __init__(self, question: Question, own_last: bool, xp: Any) -> None:
        parts = question.contact, question.horizon, question.load
        leaves, self._rebuild = jax.tree.flatten(parts)
        own = own_axes(question.contact, len(leaves))
        if question.load is not None:  # amplitudes, and their weights if there are any, have an axis of their own
            weighted = question.load.weight is not None
            own[len(leaves) - len(jax.tree.leaves(question.load))] = int(own_last)
            own[-1] = max(own[-1], int(weighted))
        leaves = [xp.asarray(leaf, jnp.result_type(0.0, *leaves)) for leaf in leaves]
        self.shape = np.broadcast_shapes(*(x.shape[: x.ndim - n] for x, n in zip(leaves, own, strict=True)))
        self.numbers = [
            xp.broadcast_to(x, (*self.shape, *x.shape[x.ndim - n :])) for x, n in zip(leaves, own, strict=True)
        ]
        self._question = question

    def one(self, numbers: Sequence[Any]) -> Question:
        """A question of the batch."""
        contact, horizon, load = jax.tree.unflatten(self._rebuild, numbers)
        return dataclasses.replace(self._question, contact=contact, horizon=horizon, load=load)


def _designs_in_turn(question: Question, level: float) -> Designs:
    """The designs of known numbers, by the program of a single one."""
    assert question.load is not None
    given = question.load
    batch = _Batch(question, given.weight is not None, np)
    rows = [x.reshape(-1, *x.shape[len(batch.shape) :]) for x in batch.numbers]
    nothing: Any = (dict.fromkeys(question.bounds, np.nan), np.nan, np.nan, False, False, False)
    found = [nothing]
    for i in range(math.prod(batch.shape)):
        one = batch.one([row[i] for row in rows])
        contact, load = one.contact, one.load
        assert load is not None
        if question.by_force and not np.any(
            np.atleast_1d(load.amplitudes) * (1.0 if load.weight is None else load.weight)
        ):
            found.append(nothing)
            continue
        weighted = weighted_load(contact, load.load, load.weight, level, one.horizon is None)
        best = answered(dataclasses.replace(one, load=weighted))
        known = best.converged, best.certified, best.scan_found_nothing_better
        found.append((best.variables, float(best.value), best.saving, *known))
    # The first one says of which kind the entries are, also of no design at all.
    of_all = jax.tree.map(lambda kind, *parts: jnp.asarray(np.array(parts, type(kind)).reshape(batch.shape)), *found)
    return Designs(*of_all)


@jax.jit
def _designs_in_a_batch(question: Question, level: Array) -> Designs:
    """The designs of a question whose contact is a batch, and whose amplitudes have one more axis at the end."""
    batch = _Batch(question, question.load is not None and question.load.amplitudes is not None, jnp)

    def best(*numbers: Array) -> Designs:
        one = batch.one(numbers)
        if one.load is not None and one.by_force:
            one = dataclasses.replace(
                one, load=one.load.with_amplitudes(*falling(one.load.amplitudes, one.load.weight, level))
            )
        shared = shared_of(one)
        found = minimum_of(one, shared)
        worn = shared.scale > 0.0
        defined = jnp.where(worn, 1.0, jnp.nan)
        return Designs(
            variables={name: defined * variable for name, variable in found.variables.items()},
            value=defined * jnp.exp(found.value) * shared.scale,
            saving=defined * -jnp.expm1(found.value),
            converged=found.converged & worn,
            certified=found.certified & worn,
            scan_found_nothing_better=found.scan_found_nothing_better & worn,
        )

    if not solved_one_by_one(question) or read_from_runs(question):
        return in_chunks(best, batch.shape, *batch.numbers)
    return in_chunks(best, batch.shape, *map(_without_slopes, batch.numbers), most=1)


@jax.custom_jvp
def _without_slopes(x: Array) -> Array:
    return x


@_without_slopes.defjvp
def _refuse_slopes(primals: Any, tangents: Any) -> Any:
    text = "has no derivatives by the numbers of a contact without closed forms, nor for a life of several runs"
    raise ValueError(f"designs: {text}; optimise.sensitivities(optimise.design(...)) gives them")


def minimum_of(question: Question, shared: Shared) -> Minimum:
    """The minimum of the logarithm of the objective over that of the reference, within a compiled program."""

    def limits(variables: dict[str, Array]) -> Array:
        return jnp.stack([jnp.asarray(x) for x in Candidate(question, variables, shared).excess()])

    plan = plan_for(question)
    return minimise(
        lambda variables: Candidate(question, variables, shared).objective(),
        space(question),
        limits=limits if question.limits else None,
        samples=plan.samples,
        starts=plan.starts,
        axis_name=BATCH,
    )
