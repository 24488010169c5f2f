"""A design compared with its reference: all numbers for tables and pictures of both, from one program."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import program
from plgwear_jax.contact import is_closed
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.optimise.designing import Design
from plgwear_jax.optimise.evaluation import concrete
from plgwear_jax.optimise.question import Question
from plgwear_jax.special.xla import materialised

_SAMPLES = 201
_FOR_A_PICTURE = 5  # digits


@record
class Comparison:
    """The quantities of the best contact of a design and of its reference, in SI units, at the largest amplitude.

    The first entry of every array is of the best contact, the second of the reference.

    Attributes:
        quantities: By name, each of shape (2,): "contact_radius", "stick_radius", "worn_radius", "wear_volume",
            "edge_pressure", "modulus_at_radius" and the objective, which is over the whole load. For gross slip
            "volume_change", "force_drop" and "modulus_at_radius"; for a displacement or blocks "contact_radius".
        distance: At which the edge pressure is taken, in m inside the stick edge; NaN where there is none.
        radii: Places in the worn ring, or on the face of the punch, shape (2, n); from the axis on after a displacement
            or blocks.
        depth: The wear depth there, shape (2, n), to some 5 digits.
        depths: Depths in the half-space at which the pictures show the modulus, shape (m,): two of a power law.
        modulus: Young's modulus there, shape (2, m).
    """

    quantities: dict[str, Array]
    distance: ArrayLike
    radii: Array
    depth: Array
    depths: Array
    modulus: Array


@for_numbers("optimise.designs works there for contacts with closed forms")
def compared(found: Design) -> Comparison:
    """Compare the best contact of a design with its reference.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The edge pressure is taken at the distance in the limits of the design, or else at a hundredth of the contact radius
    of the reference.

    Args:
        found: The result of `design`.

    Returns:
        The quantities and the wear profiles of both.
    """
    question, load = found.question, found.load
    pair = jax.tree.map(lambda *both: np.stack(both), concrete(found.contact), concrete(question.contact))
    depths = _depths_shown(question)
    if load is None:
        both = _punches(pair, depths)
    elif not question.by_force:
        both = _worn_by_then(pair, question, depths)
    else:
        force, distance = concrete(load.amplitudes)[0], concrete(question.distance)
        if not is_closed(question.contact):
            from plgwear_jax.steady import state  # which closed forms do without
            from plgwear_jax.surfaces.effort import effort_of

            both = _numeric_rings(pair, state.states_of(pair, force, effort_of(None)), distance, depths)
        else:
            others = () if question.objective == "wear_volume" else ("wear_volume",)  # what is minimised is known
            both = _rings(others, pair, force, distance, depths)
    both = jax.device_get(both)
    objective = {found.objective: np.array([found.value, found.reference_value])}
    return dataclasses.replace(both, quantities=both.quantities | objective)


def _depths_shown(question: Question) -> np.ndarray:
    """The range of the depths that have to be shown besides the contact radius, with some margin."""
    marked = np.array([one.places["z"] for one in question.limits if one.quantity == "modulus_at"], float)
    return np.array([0.5 * marked.min(), 2.0 * marked.max()] if marked.size else [np.inf, 0.0])


@program(static=1)
def _rings(
    others: tuple[str, ...],
    pair: Any,  # a FrettingContact of two
    force: Array,
    distance: ArrayLike | None,
    shown: Array,
) -> Comparison:
    steady = pair.steady(force)
    quantities: dict[str, Any] = {name: getattr(steady, name) for name in others}
    # Materialised, since many results use them.
    for name in ("contact_radius", "stick_radius", "worn_radius"):
        quantities[name] = materialised(getattr(steady, name), pair.material.k)
    inside = 0.01 * quantities["contact_radius"][1] if distance is None else jnp.asarray(distance)
    quantities["edge_pressure"] = steady.edge_pressure(inside)
    inner, outer = (quantities[name][:, None] for name in ("stick_radius", "worn_radius"))
    radii = inner + (outer - inner) * jnp.linspace(0.0, 1.0, _SAMPLES)
    # The steady state would compute the contact radius again, to fewer digits.
    a_0, k = (x[:, None] for x in (quantities["contact_radius"], pair.material.k))
    phi = steady.amplitude[:, None]
    depth = a_0 * a_0 / pair.radius[:, None] * fretting.wear_depth(radii / a_0, k, phi, digits=_FOR_A_PICTURE)
    return _with_moduli(pair, quantities, quantities["contact_radius"], inside, radii, depth, shown)


@program(level=1)
def _numeric_rings(pair: Any, states: Any, distance: ArrayLike | None, shown: Array) -> Comparison:
    from plgwear_jax.steady import numeric  # which closed forms do without
    from plgwear_jax.surfaces.effort import effort_of

    names = "wear_volume", "contact_radius", "stick_radius", "worn_radius"
    quantities = {name: getattr(states.results, name) for name in names}
    inside = 0.01 * quantities["contact_radius"][1] if distance is None else jnp.asarray(distance)

    def ring(state: Any) -> tuple[Array, Array, Array]:
        inner, outer = state.results.stick_radius, state.results.worn_radius
        radii, effort = inner + (outer - inner) * jnp.linspace(0.0, 1.0, _SAMPLES), effort_of(None)
        pressure = numeric.edge_pressure_of(effort, state, inside[None])[0]
        return pressure, radii, numeric.worn_depth_at(effort, state, radii)

    quantities["edge_pressure"], radii, depth = jax.lax.map(ring, states)
    return _with_moduli(pair, quantities, quantities["contact_radius"], inside, radii, depth, shown)


def _worn_by_then(pair: Any, question: Question, shown: np.ndarray) -> Comparison:
    """Under a load without a steady state: what is worn after the life."""
    horizon, load = question.horizon, question.load
    assert horizon is not None and load is not None
    one = load.load if load.amplitudes is None else load.with_amplitudes(load.amplitudes[0], None).load
    run = jax.tree.map(lambda field: field[:, None], pair).over_cycles(one, horizon.law)
    radii = run.contact_radius(horizon.cycles) * np.linspace(0.0, 1.0, _SAMPLES)
    depth = run.depth(radii, horizon.cycles)
    quantities = {"contact_radius": pair.steady(0.0).contact_radius}
    return _with_moduli(pair, quantities, quantities["contact_radius"], jnp.nan, radii, depth, jnp.asarray(shown))


@program()
def _punches(pair: Any, shown: Array) -> Comparison:  # a GrossSlipContact of two
    steady = pair.steady()
    quantities = {name: getattr(steady, name) for name in ("volume_change", "force_drop")}
    radii = pair.radius[:, None] * jnp.sin(jnp.linspace(0.0, 0.5 * jnp.pi, _SAMPLES))
    single = jax.tree.map(lambda field: field[:, None], pair)
    depth = single.depth - single.steady(digits=_FOR_A_PICTURE).steady_displacement(radii)
    return _with_moduli(pair, quantities, pair.radius, jnp.nan, radii, depth, shown)


def _with_moduli(
    pair: Any, quantities: dict[str, Any], edge: Array, distance: Any, radii: Array, depth: Any, shown: Array
) -> Comparison:
    power, ends = isinstance(pair.material, PowerLawGraded), (0.01 * edge[1], 10.0 * edge[1])
    depths = jnp.geomspace(jnp.minimum(ends[0], shown[0]), jnp.maximum(ends[1], shown[1]), 2 if power else _SAMPLES)
    at = jnp.concatenate([edge[:, None], jnp.broadcast_to(depths, (2, depths.size))], axis=1)
    if power:
        modulus = jax.tree.map(lambda field: field[:, None], pair.material).modulus(at)
    else:
        modulus = jax.lax.map(lambda one: one[0].modulus_at(one[1]), (pair.material, at))
    quantities["modulus_at_radius"] = modulus[:, 0]
    return Comparison(quantities, distance, radii, depth, depths, modulus[:, 1:])
