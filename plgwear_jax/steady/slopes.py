"""Power laws under an elastic indenter worn at several amplitudes, with the slopes by the half-space.

A half-space is its exponent k and the logarithm of its stiffness. All that a contact does follows from these two and
its load, so that two slopes of each result are enough, whatever a design varies. They are taken of explicit formulas
at known roots; how a root moves follows by the implicit function theorem.
"""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.shapes.shape import Outline
from plgwear_jax.special.root import root_of
from plgwear_jax.steady import numeric
from plgwear_jax.steady.state import State, state_of
from plgwear_jax.surfaces.compliance import OnePower, PowerLaw, power_law
from plgwear_jax.surfaces.effort import Effort
from plgwear_jax.surfaces.punch import Punch, punch_at, surplus
from plgwear_jax.surfaces.ring import Worn, ring_around

_OF_STATE = {
    "deepest_wear": numeric.deepest_of,
    "edge_intensity": numeric.intensity_of,
    "peak_initial_pressure": numeric.peak_of,
}
_AT_PLACES = {
    "edge_pressure": numeric.edge_pressure_of,
    "pressure": numeric.worn_pressure_at,
    "initial_pressure": numeric.unworn_pressure_at,
    "wear_depth": numeric.worn_depth_at,
}
NAMES = ("stick_radius", "worn_radius", "penetration", "wear_volume", *_OF_STATE, *_AT_PLACES)  # what `worn_logs` knows


class Given(NamedTuple):
    """What the half-spaces are pressed by; numbers, and phi of shape (n,)."""

    force: Array
    radius: Array
    friction: Array
    plane_modulus: Array | None  # of the indenter; None if it is rigid
    phi: Array  # 0 < phi < 1
    places: tuple[Array, ...]  # in m, one for each quantity asked for; 0 for one without a place
    outline: Outline  # of the unworn indenter


class Logs(NamedTuple):
    """Logarithms of lengths, volumes and pressures in SI units."""

    contact_radius: Array
    worn: Array  # what was asked for, (amplitudes, names)
    states: State  # at the amplitudes, without what slip needs


def worn_logs(effort: Effort, names: tuple[str, ...], half_space: Array, given: Given) -> Logs:
    """The logarithms of quantities of these names; differentiable once, by the half-space (k, log(stiffness)) alone."""
    known = jax.lax.stop_gradient(half_space)
    found, by_radius, by_worn = _worn_logs(effort, names, known, jax.lax.stop_gradient(given))
    moved = half_space - known
    return found._replace(
        contact_radius=found.contact_radius + by_radius @ moved,
        worn=found.worn + jnp.tensordot(moved, by_worn, 1),
    )


def _along(function: Any, at: tuple[Any, ...], along: tuple[Any, ...]) -> tuple[Any, Any]:
    """(The function's results, their changes in each of several directions), one after the other: one program."""
    found = jax.lax.map(lambda step: jax.jvp(function, at, step), along)
    return jax.tree.map(lambda x: x[0], found[0]), found[1]


def _worn_logs(effort: Effort, names: tuple[str, ...], half_space: Array, given: Given) -> tuple[Logs, Array, Array]:
    load, dtype = given.force * given.radius, half_space.dtype
    compliance, by_law = _along(
        lambda law: power_law(law[0], law[1], given.plane_modulus, load, effort, given.outline),
        (half_space,),
        (jnp.eye(2, dtype=dtype),),
    )
    by_two = jax.tree.map(lambda x: jnp.concatenate([x, jnp.zeros_like(x[:1])]), by_law)
    third = jnp.asarray([0.0, 0.0, 1.0], dtype)

    def unmoving(phi: Array) -> tuple[Punch, Punch]:
        """The contact inside the stick edge, and its slopes."""
        log_c = _log_radius(effort, compliance, load, phi, given.outline)
        at = compliance, log_c
        punch, by = _along(
            lambda compliance, log_c: punch_at(compliance, log_c, effort, given.outline), at, (by_two, third)
        )
        rates = by.force / punch.force + 2.0 * third
        moves = -rates[:2] / rates[2]
        return punch, jax.tree.map(lambda x: x[:2] + moves.reshape(2, *(1,) * (x.ndim - 1)) * x[2], by)

    punches, by_punches = jax.lax.map(unmoving, jnp.append(jnp.zeros_like(given.phi[:1]), given.phi))
    unworn = jax.tree.map(lambda x: x[0], punches)

    def ring(phi: Array, punch: Punch, by_punch: Punch) -> tuple[Array, Array, State]:
        def told(compliance: Any, punch: Punch) -> tuple[Array, State]:
            found = Worn(unworn, punch, *ring_around(compliance, punch, phi, effort, given.outline))
            # No slip is asked for.
            loads = given.force, given.radius, given.friction, given.outline, jnp.full_like(phi, jnp.nan), phi
            state = state_of(compliance, loads, found)
            found = [_quantity(effort, *one, state) for one in zip(names, given.places, strict=True)]
            # Outside of the ring a depth of wear is 0.
            return jnp.stack([jnp.where(x <= 0.0, -1e3, jnp.log(jnp.where(x <= 0.0, 1.0, x))) for x in found]), state

        (logs, state), (by_logs, _) = _along(told, (compliance, punch), (by_law, by_punch))
        return logs, by_logs, state

    after = jax.tree.map(lambda x: x[1:], (punches, by_punches))
    logs, by_logs, states = jax.lax.map(lambda each: ring(*each), (given.phi, *after))
    return Logs(unworn.log_c, logs, states), by_punches.log_c[0], jnp.moveaxis(by_logs, 1, 0)


def _log_radius(effort: Effort, compliance: OnePower | PowerLaw, load: Array, phi: Array, outline: Outline) -> Array:
    """log(c)."""
    goal = jnp.log(load) + jnp.log1p(-phi)

    def excess(log_c: Array) -> Array:
        return surplus(punch_at(compliance, log_c, effort, outline), goal)

    return root_of(excess, jnp.log(compliance.radius) + jnp.log1p(-phi) / 3.0, 3.0)


def unworn_log_radius(effort: Effort, half_space: Array, given: Given) -> Array:
    """log(a_0) alone."""
    load = given.force * given.radius
    compliance = power_law(half_space[0], half_space[1], given.plane_modulus, load, effort, given.outline)
    return _log_radius(effort, compliance, load, jnp.zeros_like(load), given.outline)


def _quantity(effort: Effort, name: str, place: Array, state: State) -> Array:
    if name in _AT_PLACES:
        return _AT_PLACES[name](effort, state, place[None])[0]
    return _OF_STATE[name](effort, state) if name in _OF_STATE else getattr(state.results, name)


def stiffness_for(effort: Effort, k: Array, log_a: Array, given: Given) -> Array:
    """log(stiffness) of the half-space on which the contact has the radius exp(log_a); differentiable once."""

    def excess(k: Array, given: Given, log_stiffness: Array) -> Array:
        load = given.force * given.radius
        compliance = power_law(k, log_stiffness, given.plane_modulus, load, effort, given.outline)
        return surplus(punch_at(compliance, log_a, effort, given.outline), jnp.log(load))

    known = jax.lax.stop_gradient((k, given))
    # Under a rigid indenter it would be this one.
    alone = jnp.log(known[1].force * known[1].radius) + jnp.log(0.25 * (3.0 + known[0])) - (3.0 + known[0]) * log_a
    root = jax.lax.stop_gradient(root_of(functools.partial(excess, *known), alone, 0.5))
    # A step of Newton's method, which moves with everything that the excess depends on.
    left, slope = jax.jvp(functools.partial(excess, k, given), (root,), (jnp.ones_like(root),))
    return root - left / jax.lax.stop_gradient(slope)
