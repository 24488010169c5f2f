"""The steady state of contacts without closed forms, from one program that all their quantities share."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.flatten_util import ravel_pytree
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, guarded, real_dtype
from plgwear_jax._core.programs import program, trace_state, traced
from plgwear_jax.contact.batch import each
from plgwear_jax.contact.shape import EXPONENT, unworn_profile
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.special.elementary import at_least
from plgwear_jax.surfaces.bodies import mindlin_ratio
from plgwear_jax.surfaces.compliance import Compliance, graded, power_law
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.surfaces.pchip import pchip
from plgwear_jax.surfaces.profile import Profile, profile_of
from plgwear_jax.surfaces.punch import Punch
from plgwear_jax.surfaces.ring import Beside
from plgwear_jax.surfaces.steady import Worn, worn

__all__ = ["State", "profile_on", "results_in", "results_of", "states_of", "unworn_radius"]


class Results(NamedTuple):
    """What the methods of their names answer, from the program of the state: each operation outside takes as long."""

    contact_radius: Array
    stick_radius: Array
    worn_radius: Array
    penetration: Array
    wear_volume: Array


class State(NamedTuple):
    """A contact under a force amplitude, before any wear and worn to the end; depths are in c^2/R."""

    compliance: Compliance
    force: Array
    radius: Array
    friction: Array
    profile: Profile | None  # of the unworn indenter; None for the parabola
    tangential: Array  # mu theta
    phi: Array
    unworn: Punch  # of the radius a_0
    punch: Punch  # of the radius c
    depth: Array  # d_inf
    beside: Beside  # of the radius c
    end: Array  # y of the outer edge of the worn ring
    volume: Array  # in c^4/R
    results: Results  # in SI units

    @property
    def c(self) -> Array:
        """In m."""
        return jnp.exp(self.punch.log_c)

    def height(self, punch: Punch) -> Array:
        """c^2/R."""
        return jnp.exp(2.0 * punch.log_c) / self.radius

    def unworn_profile(self, r: Array) -> Array:
        """f_0 in m."""
        return unworn_profile(r, self.radius, None if self.profile is None else self.profile.exponent)

    @property
    def shape(self) -> tuple[int, ...]:
        """Of all contacts."""
        return self.force.shape


def states_of(contact: Any, tangential_force: ArrayLike, digits: int | None) -> State:
    """The states of all contacts and forces, in their common shape."""
    return _found(_differentiable, contact, tangential_force, digits)


def results_of(contact: Any, tangential_force: ArrayLike, digits: int | None) -> Results:
    """The results of these states; at known numbers their derivatives do not need those of all that a state has."""
    known = not any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves((contact, tangential_force)))
    if known or traced(()):
        return states_of(contact, tangential_force, digits).results
    return _found(_results, contact, tangential_force, digits)


def _found(differentiable: Any, contact: Any, tangential_force: ArrayLike, digits: int | None) -> Any:
    given = contact, tangential_force
    leaves = jax.tree.leaves(given)
    effort = effort_of(digits)
    key = differentiable, effort, jax.tree.structure(given), trace_state()
    if _last and _last[0] == key and _same(_last[1], leaves):
        return _last[2]
    dtype = jnp.promote_types(real_dtype("a contact", tuple(leaves)), jnp.float32)
    cast = jax.tree.map(lambda x: jnp.asarray(x, dtype) if isinstance(x, Array) else np.asarray(x, dtype), given)
    # Without derivatives the rule of derivatives would only take time.
    known = not any(isinstance(leaf, Tracer) for leaf in leaves)
    found = _states(effort, *cast) if known else differentiable(effort, cast)
    _last[:] = [key, _remembered(leaves), found]
    return found


def unworn_radius(contact: Any, digits: int | None) -> Array:
    """The contact radii before any wear, of the last states if these are of the same contacts under one force."""
    if _last:
        key, remembered, found = _last
        force = remembered[-1][0]
        same = key[1:] == (effort_of(digits), jax.tree.structure((contact, force)), trace_state())
        if same and np.shape(force) == () and _same(remembered[:-1], jax.tree.leaves(contact)):
            return (found if isinstance(found, Results) else found.results).contact_radius
    return results_of(contact, 0.0, digits).contact_radius


# The quantities of one contact are asked for one after the other, often in one program, which would contain its
# solution as often.
_last: list[Any] = []


def _remembered(leaves: list[Any]) -> list[tuple[Any, Any]]:
    """With a copy of what may be changed in place."""
    return [(leaf, leaf.copy() if isinstance(leaf, np.ndarray) else None) for leaf in leaves]


def _same(remembered: list[tuple[Any, Any]], leaves: list[Any]) -> bool:
    pairs = zip(remembered, leaves, strict=False)
    unchanged = (a is b and (copy is None or np.array_equal(copy, b, equal_nan=True)) for (a, copy), b in pairs)
    return len(remembered) == len(leaves) and all(unchanged)


@program(static=1, level=1)
def _states(effort: Effort, contact: Any, tangential_force: Array) -> State:
    material, indenter = contact.material, contact.indenter
    names = "normal_force", "radius", "friction"
    loads = [guarded(name, getattr(contact, name), POSITIVE) for name in names]
    power = isinstance(material, PowerLawGraded)
    if power:
        k = jnp.asarray(material.k)
        given = [k, material.log_stiffness(), material.tangential_ratio()]
    else:
        given = [jnp.asarray(material.depth), guarded("modulus", material.modulus, POSITIVE)]
        given += [jnp.asarray(material.nu), mindlin_ratio(material.nu)]
    end = len(loads) + len(given) + 1
    others = [] if indenter is None else [indenter.plane_modulus, mindlin_ratio(indenter.nu)]
    shape = [] if contact.shape is None else [guarded("exponent", contact.shape.exponent, EXPONENT)]

    def one(force: Array, radius: Array, friction: Array, phi: Array, *bodies: Array) -> State:
        profile = profile_of(bodies[-1], radius) if shape else None
        body, other = bodies[: end - 4], bodies[end - 4 : end - 4 + len(others)]
        plane_modulus = other[0] if other else None
        if power:
            assert plane_modulus is not None
            compliance = power_law(body[0], body[1], plane_modulus, force * radius, effort, profile)
        else:
            depth, modulus, nu, _ = body
            increasing = jnp.all(jnp.diff(depth) >= 0.0) & (depth[0] >= 0.0)
            depth = jnp.where(increasing, depth, jnp.nan)
            compliance = graded(pchip(depth, modulus), nu, plane_modulus, force * radius, effort, profile)
        load = force * radius
        found = worn(compliance, load, phi, effort, profile)
        unworn = found.unworn
        # The bodies share in theta as in the energy of a flat punch.
        shares = [unworn.flat @ share @ unworn.flat for share in compliance.shares(jnp.exp(unworn.log_c), effort)]
        theta = body[-1]
        if other:
            theta = (shares[0] * theta + shares[1] * other[1]) / (shares[0] + shares[1])
        told = results_in(radius, found)
        return State(compliance, force, radius, friction, profile, friction * theta, phi, *found, told)

    phi = contact.amplitude(tangential_force)
    everything = [jnp.asarray(x) for x in (*loads, phi, *given, *others, *shape)]
    return each(one, tuple(everything), () if power else (4, 5))


def results_in(radius: Array, found: Worn) -> Results:
    """The results in SI units."""
    a_0, c = jnp.exp(found.unworn.log_c), jnp.exp(found.punch.log_c)
    height = c * c / radius
    # Both radii are roots of their own, known to some roundings.
    stick, end = -at_least(-a_0, -c), at_least(a_0, c * jnp.sqrt(1.0 + found.y))
    return Results(a_0, stick, end, height * found.depth, c * c * height * found.volume)


def profile_on(contact: Any) -> Profile | None:
    """The profile of the unworn indenter of one contact, None for the parabola."""
    if contact.shape is None:
        return None
    exponent = guarded("exponent", jnp.asarray(contact.shape.exponent, jnp.asarray(contact.radius).dtype), EXPONENT)
    return profile_of(exponent, jnp.asarray(contact.radius))


# --- derivatives ------------------------------------------------------------------------------------------------------


_FEW = 64  # numbers by each of which all is differentiated; of a batch most of these derivatives would be zero


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _differentiable(effort: Effort, given: Any) -> State:
    return _states(effort, *given)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _results(effort: Effort, given: Any) -> Results:
    return _states(effort, *given).results


def _rule(whole: bool, effort: Effort, primals: Any, tangents: Any) -> tuple[Any, Any]:
    """The derivatives of known numbers by a program of their own, which XLA compiles in a fourth of the time."""
    (given,), (along,) = primals, tangents
    if traced(given) or sum(map(np.size, jax.tree.leaves(given))) > _FEW:
        return jax.jvp(lambda given: _asked(whole, _states(effort, *given)), (given,), (along,))
    found, slopes = _sloped(whole, effort, jax.tree.map(np.asarray, given))
    return found, _along(slopes, ravel_pytree(along)[0])


_differentiable.defjvp(functools.partial(_rule, True))
_results.defjvp(functools.partial(_rule, False))


def _asked(whole: bool, state: State) -> Any:
    return state if whole else state.results


@program(static=2)
def _sloped(whole: bool, effort: Effort, given: Any) -> tuple[Any, Any]:
    """The states or their results, and the derivatives by each of the numbers, along a first axis."""
    flat, back = ravel_pytree(given)
    found, along = jax.linearize(lambda flat: _asked(whole, _states(effort, *back(flat))), flat)
    return found, jax.vmap(along)(jnp.eye(flat.size, dtype=flat.dtype))


@jax.jit
def _along(slopes: Any, along: Array) -> Any:
    return jax.tree.map(lambda by: jnp.tensordot(along, by, 1), slopes)
