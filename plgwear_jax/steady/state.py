"""A contact without closed forms, solved: its bodies, the state unworn and worn to the end, and its scalar results."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer

from plgwear_jax._core.domains import ArrayLike, RefusedError, one_or_nan
from plgwear_jax._core.record import guarded_field
from plgwear_jax._core.sequential import sequential_vmap
from plgwear_jax._core.startup.programs import Program, program, traced, value_of, with_slopes
from plgwear_jax._core.xla import materialised
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.shapes.of_contact import outline_of, shape_of
from plgwear_jax.shapes.shape import Outline
from plgwear_jax.special.cholesky import solve_symmetric
from plgwear_jax.special.elementary import clamp_keep_slope
from plgwear_jax.steady.arguments import amplitude_of
from plgwear_jax.steady.batch import as_numbers, each
from plgwear_jax.surfaces.bodies import AnyModulus, Elastic, in_series, mindlin_ratio
from plgwear_jax.surfaces.compliance import Compliance, OnePower, graded, power_law
from plgwear_jax.surfaces.effort import Effort
from plgwear_jax.surfaces.punch import Punch
from plgwear_jax.surfaces.ring import Beside, Worn, worn
from plgwear_jax.surfaces.tension import Least, least_pressures


class Results(NamedTuple):
    """Scalar results in SI units, computed by the program of the state: each operation outside takes as long."""

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
    outline: Outline  # of the unworn indenter
    tangential: Array  # mu theta
    phi: Array
    unworn: Punch  # of the radius a_0
    punch: Punch  # of the radius c
    further: Array  # d_inf less the depth of `punch`
    beside: Beside  # of the radius c
    end: Array  # y of the outer edge of the worn ring
    volume: Array  # in c^4/R
    results: Results  # in SI units
    least: Least  # pressures, which are known also where the rest is NaN because of them

    @property
    def c(self) -> Array:
        """The stick radius in m."""
        return jnp.exp(self.punch.log_c)

    def height(self, punch: Punch) -> Array:
        """c^2/R."""
        return jnp.exp(2.0 * punch.log_c) / self.radius

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the contacts, () for one."""
        return self.force.shape


def states_of(contact: Any, tangential_force: ArrayLike, effort: Effort) -> State:
    """The states of all contacts and forces, in their common shape."""
    return _found(solved_states, contact, tangential_force, effort)


def results_of(contact: Any, tangential_force: ArrayLike, effort: Effort) -> Results:
    """The results of these states alone, whose derivatives at known numbers are a smaller program."""
    return _found(_results, contact, tangential_force, effort)


def _found(program: Program, contact: Any, force: ArrayLike, effort: Effort) -> Any:
    given = as_numbers((contact, force))
    found, reach = with_slopes(program)(effort, *given), shape_of(contact).reach
    if isinstance(found, State) and not traced(given):
        refuse_tension(found, worn=False)
        if reach is not None and np.any(np.isnan(found.results.worn_radius) & (found.least.pulled[..., 1] == 0.0)):
            raise RefusedError(f"shape: the table of heights ends at r = {np.min(reach):g} m, inside the worn radius")
    return found


def refuse_tension(state: State, worn: bool) -> None:
    """Refuse a known contact that would have to pull: worn to the end, or before any wear. Of a batch it stays NaN."""
    least = [value_of(x) for x in state.least]
    if state.shape or isinstance(least[0], Tracer):
        return
    share, r, pulled = np.stack(least)[:, int(worn)]
    when, more = ("in the steady state", ", and Eq. (28) does not hold") if worn else ("before any wear", "")
    if pulled:
        raise RefusedError(opens(when, share, r) + more)


def opens(when: str, share: Any, r: Any) -> str:
    """What is said of a negative pressure."""
    where = f"at r = {r:.3g} m ({share:.2g} of the mean)"
    return f"the pressure {when} would be negative {where}: the contact would open there"


class Solver(NamedTuple):
    """How a contact of one kind of bodies is solved."""

    one: Callable[..., State]  # of the numbers of one contact
    numbers: tuple[Array, ...]  # the arguments of `one` for all contacts, which broadcast
    tables: tuple[int, ...]  # which of the numbers have a last axis of their own: depths and moduli
    bodies: Callable[..., "Bodies"]  # of the same numbers


def solver_of(effort: Effort, contact: Any, tangential_force: Array) -> Solver:
    """The function that solves one contact of these bodies, and its arguments for all of them."""
    material, indenter = contact.material, contact.indenter
    if isinstance(material, Elastic):
        material = in_series(material, None)
    names = "normal_force", "radius", "friction"
    loads = [guarded_field(contact, name) for name in names]
    any_modulus = isinstance(material, AnyModulus)
    if any_modulus:
        given = [*material.arrays(), guarded_field(material, "nu"), mindlin_ratio(material.nu)]
    else:
        given = [jnp.asarray(material.k), material.log_stiffness(), material.tangential_ratio()]
    others = [] if indenter is None else [indenter.plane_modulus, mindlin_ratio(indenter.nu)]
    shape = outline_of(contact).shape
    phi = amplitude_of(contact, tangential_force)
    # Rings are resolved down to roundings of the radius: a smaller amplitude counts as none.
    phi = jnp.where(phi < 8.0 * float(jnp.finfo(phi.dtype).eps), phi - jax.lax.stop_gradient(phi), phi)
    before = (*loads, phi, *given, *others)
    kind = effort, type(material), indenter is not None, jax.tree.structure(shape)
    one, bodies = functools.partial(_one, *kind), functools.partial(_bodies, *kind)
    own = jax.tree_util.tree_leaves_with_path(shape)
    tables = [4, 5] if any_modulus else []
    tables += [len(before) + place for place, (path, _) in enumerate(own) if path[0].name in shape.tables]
    numbers = tuple(jnp.asarray(x, phi.dtype) for x in (*before, *(leaf for _, leaf in own)))
    return Solver(one, numbers, tuple(tables), bodies)


class Bodies(NamedTuple):
    """What touches: two bodies, and the shape of the indenter."""

    compliance: Compliance
    outline: Outline
    ratio: Array  # theta of the half-space
    other: Array | None  # of an elastic indenter

    def tangential_ratio(self, effort: Effort, c: Array, flat: Array | None = None) -> Array:
        """theta of both, which share in it as in the energy of a flat punch of radius c and pressures `flat`."""
        if isinstance(self.compliance, OnePower) or self.other is None:
            return self.ratio
        if flat is None:
            first = jnp.asarray(np.eye(effort.modes, 1), c.dtype)
            flat = solve_symmetric(self.compliance.matrices(c, effort)[0], first)[:, 0]
        # The whole matrix takes `flat` to a depth of 1, so that the energy of both is the first pressure.
        share = flat @ self.compliance.of_indenter(effort) @ flat / flat[0]
        return self.ratio + share * (self.other - self.ratio)


def _bodies(
    effort: Effort,
    half_space: type[PowerLawGraded | AnyModulus],
    elastic: bool,
    shape: Any,
    force: Array,
    radius: Array,
    friction: Array,
    phi: Array,
    *numbers: Array,
) -> Bodies:
    """The bodies of one contact: a half-space of this kind under an elastic or a rigid indenter.

    `shape` is the structure of the indenter's shape, whose leaves are the last of the numbers: JAX keeps this function
    in its rules, so that traced values have to be arguments and must not be closed over.
    """
    del friction, phi
    parts = 4 if issubclass(half_space, AnyModulus) else 3, 2 if elastic else 0
    body, other = numbers[: parts[0]], numbers[parts[0] : sum(parts)]
    outline = Outline(jax.tree.unflatten(shape, numbers[sum(parts) :]), radius)
    plane_modulus = other[0] if elastic else None
    load = force * radius
    if issubclass(half_space, AnyModulus):
        lengths, moduli, nu, _ = body
        compliance = graded(half_space.by_depth, lengths, moduli, nu, plane_modulus, load, effort, outline)
    else:
        compliance = power_law(body[0], body[1], plane_modulus, load, effort, outline)
    return Bodies(compliance, outline, body[-1], other[1] if elastic else None)


def _one(
    effort: Effort, half_space: type[PowerLawGraded | AnyModulus], elastic: bool, shape: Any, *numbers: Array
) -> State:
    """The state of one contact, NaN where it would have to pull: all of it but the least pressures, or what is worn."""
    force, radius, friction, phi, *_ = numbers
    bodies = _bodies(effort, half_space, elastic, shape, *numbers)
    compliance, outline = bodies.compliance, bodies.outline
    found = worn(compliance, force * radius, phi, effort, outline)
    unworn = found.unworn
    theta = bodies.tangential_ratio(effort, jnp.exp(unworn.log_c), unworn.flat)
    least, known, reach = least_pressures(compliance, found, phi, outline), [], outline.shape.reach
    if reach is not None:  # what is beyond a table is guessed
        known.append(jnp.exp(found.punch.log_c) * jnp.sqrt(1.0 + found.y) <= reach)
    if not (isinstance(compliance, OnePower) and outline.shape.steepens):  # which nothing pulls
        before, after = jnp.unstack(least.pulled == 0.0)
        after = one_or_nan(after)
        found = found._replace(further=after * found.further, y=after * found.y, volume=after * found.volume)
        known.append(before)
    if known:  # all that is read of a state depends on one of these
        factor = materialised(one_or_nan(functools.reduce(jnp.logical_and, known)))
        numbers = force, phi, found.unworn.log_c, found.punch.log_c, found.y
        force, phi, unworn, punch, y = (factor * x for x in numbers)
        unworn, punch = found.unworn._replace(log_c=unworn), found.punch._replace(log_c=punch)
        found = found._replace(unworn=unworn, punch=punch, y=y)
    results = results_in(radius, found)
    return State(compliance, force, radius, friction, outline, friction * theta, phi, *found, results, least)


@program(static=1, level=1)
def solved_states(effort: Effort, contact: Any, tangential_force: Array) -> State:
    """The program of `states_of`."""
    one, numbers, tables, _ = solver_of(effort, contact, tangential_force)
    return each(sequential_vmap(one), numbers, tables)


@program(static=1, level=1)
def _results(effort: Effort, contact: Any, tangential_force: Array) -> Results:
    one, numbers, tables, _ = solver_of(effort, contact, tangential_force)
    return each(sequential_vmap(lambda *numbers: one(*numbers).results), numbers, tables)


def results_in(radius: Array, found: Worn) -> Results:
    """The results in SI units."""
    a_0, c = jnp.exp(found.unworn.log_c), jnp.exp(found.punch.log_c)
    height = c * c / radius
    # Both radii are roots of their own, known to some roundings.
    stick, end = -clamp_keep_slope(-a_0, -c), clamp_keep_slope(a_0, c * jnp.sqrt(1.0 + found.y))
    return Results(a_0, stick, end, height * (found.punch.depth + found.further), c * c * height * found.volume)
