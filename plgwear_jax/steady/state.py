"""A contact without closed forms, solved: its bodies, the state unworn and worn to the end, and its scalar results."""

import dataclasses
import functools
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import ArrayLike, RefusedError, field_nan_outside, nan_unless, record
from plgwear_jax._core.sequential import sequential_vmap
from plgwear_jax._core.startup.programs import holds_tracers, program, traced, value_of, with_slopes
from plgwear_jax._core.xla import materialised
from plgwear_jax.shapes import outline_of, shape_of
from plgwear_jax.special.cholesky import solve_symmetric
from plgwear_jax.special.elementary import clamp_keep_slope
from plgwear_jax.surfaces.any_modulus import graded
from plgwear_jax.surfaces.bodies import AnyModulus
from plgwear_jax.surfaces.effort import EFFORTS, Effort
from plgwear_jax.surfaces.power_laws import power_law
from plgwear_jax.surfaces.punch import Bodies
from plgwear_jax.surfaces.ring import Worn, worn
from plgwear_jax.surfaces.tension import Least, least_pressures

from .arguments import amplitude_of
from .batch import as_numbers, vmap_contacts


class Results(NamedTuple):
    """Scalar results in SI units, computed by the program of the state: each operation outside takes as long."""

    contact_radius: Array
    stick_radius: Array
    worn_radius: Array
    penetration: Array
    wear_volume: Array


@record
class State(Worn):
    """A contact under a force amplitude, before any wear and worn to the end; depths are in c^2/R."""

    force: Array  # F_N
    friction: Array
    tangential: Array  # mu theta
    phi: Array
    results: Results  # in SI units
    least: Least  # pressures, which are known also where the rest is NaN because of them

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the contacts, () for one."""
        return self.force.shape


def states_of(contact: Any, tangential_force: ArrayLike, effort: Effort) -> State:
    """The states of all contacts and forces, in their common shape."""
    given = as_numbers((contact, tangential_force))
    found, reach = with_slopes(solved_states)(effort, *given), shape_of(contact).known_radius
    if not traced(given):
        refuse_tension(found, worn=False)
        if reach is not None and np.any(np.isnan(found.results.worn_radius) & (found.least.pulled[..., 1] == 0.0)):
            unworn = np.any(np.isnan(found.results.contact_radius))
            raise RefusedError(
                f"shape: the table of heights ends at r = {np.min(reach):g} m, inside the "
                f"{'contact radius before any wear' if unworn else 'worn radius'} "
                f"at normal_force = {np.max(contact.normal_force):g}"
            )
    return found


def refuse_tension(state: State, worn: bool) -> None:
    """Refuse a known contact that would have to pull: worn to the end, or before any wear. Of a batch it stays NaN."""
    least = [value_of(x) for x in state.least]
    if state.shape or holds_tracers(least):
        return
    share, r, pulled = np.stack(least)[:, int(worn)]
    when, more = ("in the steady state", ", and Eq. (28) does not hold") if worn else ("before any wear", "")
    if pulled:
        raise RefusedError(opens(when, share, r) + more)


def opens(when: str, share: Any, r: Any) -> str:
    """What is said of a negative pressure."""
    where = f"at r = {r:.3g} m ({share:.2g} of the mean)"
    return f"the pressure {when} would be negative {where}: the contact would open there"


def bodies_of(effort: Effort, contact: Any, force: Array) -> Bodies:
    """The bodies of one contact under a normal force."""
    outline = outline_of(contact)
    return _touching(contact.material, contact.indenter, force * outline.radius, effort, outline)


@functools.singledispatch
def _touching(material: Any, indenter: Any, load: Array, *others: Any) -> Bodies:
    """The bodies by the half-space, of a power law or of one that is registered."""
    law = material.power_law
    return power_law(jnp.asarray(law.k, load.dtype), law.log_stiffness(), indenter, load, *others)


_touching.register(AnyModulus, graded)


def theta_of(contact: Any, bodies: Any, c: Array, flat: Array | None = None) -> Array:
    """theta of both bodies, which share in it as in the energy of a flat punch of radius c and pressures `flat`."""
    ratio = contact.material.tangential_ratio()
    if contact.indenter is None:
        return ratio
    if flat is None:
        first = jnp.asarray(np.eye(bodies.effort.modes, 1), c.dtype)
        flat = solve_symmetric(bodies.matrices(c)[0], first)[:, 0]
    # The whole matrix takes `flat` to a depth of 1, so that the energy of both is the first pressure.
    share = flat @ bodies.of_indenter @ flat / flat[0]
    return ratio + share * (contact.indenter.tangential_ratio() - ratio)


def state_of(effort: Effort, contact: Any, tangential_force: Array) -> State:
    """The state of one contact, NaN where it would have to pull: all of it but the least pressures, or what is worn."""
    force, friction = (field_nan_outside(contact, name) for name in ("normal_force", "friction"))
    # Few pressures do not resolve what lies between a corner and a contact that ends next to it.
    corner = getattr(shape_of(contact), "corner", 0.0)
    bodies = bodies_of(max(effort, EFFORTS[4 if corner else 2]), contact, force)
    phi = amplitude_of(friction, force, tangential_force)
    # Rings are resolved down to roundings of the radius: a smaller amplitude counts as none.
    phi = jnp.where(phi < 8.0 * jnp.finfo(phi.dtype).eps, phi - lax.stop_gradient(phi), phi)
    found = worn(bodies, force * bodies.outline.radius, phi)
    theta = theta_of(contact, bodies, found.unworn.c, found.unworn.flat)
    least, reach = least_pressures(found, phi), bodies.outline.shape.known_radius
    before, after = jnp.unstack(least.pulled == 0.0)
    if reach is not None:  # what is beyond a table is guessed
        before, after = before & (found.unworn.c <= reach), after & (found.c * jnp.sqrt(1.0 + found.end) <= reach)
    if not (bodies.never_pulls and reach is None):
        numbers = jnp.stack([found.further, found.end, found.volume])
        further, end, volume = jnp.unstack(nan_unless(after, numbers))
        # All that is read of a state depends on one of these.
        numbers = jnp.stack([force, phi, found.unworn.log_c, found.punch.log_c, end])
        force, phi, unworn, punch, end = jnp.unstack(materialised(nan_unless(before, numbers)))
        unworn, punch = found.unworn._replace(log_c=unworn), found.punch._replace(log_c=punch)
        found = dataclasses.replace(found, unworn=unworn, punch=punch, further=further, end=end, volume=volume)
    tangential, a_0, c = friction * theta, found.unworn.c, found.c
    square = c * c
    height = square / bodies.outline.radius
    # Both radii are roots of their own, known to some roundings.
    stick, end = -clamp_keep_slope(-a_0, -c), clamp_keep_slope(a_0, c * jnp.sqrt(1.0 + found.end))
    results = Results(a_0, stick, end, height * (found.punch.depth + found.further), square * height * found.volume)
    return State(
        **vars(found), force=force, friction=friction, tangential=tangential, phi=phi, results=results, least=least
    )


@program(static=1, level=1)
def solved_states(effort: Effort, contact: Any, tangential_force: Array) -> State:
    """The program of `states_of`."""
    return vmap_contacts(sequential_vmap(functools.partial(state_of, effort)), (contact, tangential_force))


@program(static=1, level=1)
def solved_results(effort: Effort, contact: Any, tangential_force: Array) -> Results:
    """The results of these states alone, whose derivatives at known numbers are a smaller program."""
    one = sequential_vmap(lambda *given: state_of(effort, *given).results)
    return vmap_contacts(one, (contact, tangential_force))
