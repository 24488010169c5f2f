"""Contacts without closed forms, by the names of the methods of `FrettingContact`: elastic indenters and any E(z)."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import DISTANCE, POSITIVE, RADIUS, guarded
from plgwear_jax._core.formula import compiled
from plgwear_jax.contact.arguments import DISPLACEMENT
from plgwear_jax.contact.batch import each, over_radii
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.surfaces.bodies import mindlin_ratio
from plgwear_jax.surfaces.compliance import Compliance, graded, power_law
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.surfaces.pchip import pchip
from plgwear_jax.surfaces.punch import Punch, at_edge, pressure_inside, punch_at, radius_under
from plgwear_jax.surfaces.ring import deepest, depth_beside, ring_integral
from plgwear_jax.surfaces.root import root_of
from plgwear_jax.surfaces.steady import stick, worn


class _One(NamedTuple):
    """One contact, of numbers."""

    compliance: Compliance
    force: Array
    radius: Array
    friction: Array
    theta: tuple[Array, Array]  # of the half-space and of the indenter
    effort: Effort

    @property
    def load(self) -> Array:
        return self.force * self.radius

    def height(self, punch: Punch) -> Array:
        """c^2/R."""
        return jnp.exp(2.0 * punch.log_c) / self.radius

    def unworn(self) -> Punch:
        return punch_at(self.compliance, radius_under(self.compliance, self.load, self.effort), self.effort)

    def tangential(self, unworn: Punch) -> Array:
        """mu theta; the bodies share in theta as in the energy of a flat punch."""
        shares = self.compliance.shares(jnp.exp(unworn.log_c), self.effort)
        own, other = (unworn.flat @ share @ unworn.flat for share in shares)
        return self.friction * (own * self.theta[0] + other * self.theta[1]) / (own + other)


def _each(function: Callable[..., Any], contact: Any, digits: int | None, *arguments: ArrayLike) -> tuple[Any, Any]:
    """(The function of `_One` and the arguments for each element, the shape of all elements)."""
    effort, material, indenter = effort_of(digits), contact.material, contact.indenter
    names = "normal_force", "radius", "friction"
    loads = [guarded(name, getattr(contact, name), POSITIVE) for name in names]
    power = isinstance(material, PowerLawGraded)
    if power:
        k = jnp.asarray(material.k) * 1.0
        nothing = jnp.zeros_like(k)
        given = [k, material.log_stiffness(digits=None) + nothing, material.tangential_ratio(), nothing]
    else:
        given = [jnp.asarray(material.depth), guarded("modulus", material.modulus, POSITIVE)]
        given += [jnp.asarray(material.nu), mindlin_ratio(material.nu)]
    given += [] if indenter is None else [indenter.plane_modulus, mindlin_ratio(indenter.nu)]
    everything = [*loads, *given, *map(jnp.asarray, arguments)]
    dtype = jnp.promote_types(jnp.result_type(*everything, 0.0), jnp.float32)
    everything = [x.astype(dtype) for x in everything]
    points = () if power else (3, 4)
    end = len(loads) + len(given)

    def one(*values: Array) -> Any:
        force, radius, friction, *body = values[:end]
        other = None if indenter is None else body[4]
        if power:
            k, log_stiffness, theta, _ = body[:4]
            assert other is not None
            compliance = power_law(k, log_stiffness, other, force * radius, effort)
        else:
            depth, modulus, nu, theta = body[:4]
            # Traced depths that do not increase.
            depth = jnp.where(jnp.all(jnp.diff(depth) >= 0.0) & (depth[0] >= 0.0), depth, jnp.nan)
            compliance = graded(pchip(depth, modulus), nu, other, force * radius, effort)
        thetas = theta, theta if indenter is None else body[5]
        contact = _One(compliance, force, radius, friction, thetas, effort)
        return function(contact, *values[end:])

    shapes = [x.shape[: x.ndim - (i in points)] for i, x in enumerate(everything)]
    return each(one, tuple(everything), points), jnp.broadcast_shapes(*shapes)


@compiled
def contact_radius(contact: Any, *, digits: int | None = None) -> Array:
    def one(contact: _One) -> Array:
        return jnp.exp(radius_under(contact.compliance, contact.load, contact.effort))

    return _each(one, contact, digits)[0]


@compiled
def stick_radius(contact: Any, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One, phi: Array) -> Array:
        return jnp.exp(radius_under(contact.compliance, (1.0 - phi) * contact.load, contact.effort))

    return _each(one, contact, digits, contact.amplitude(tangential_force))[0]


@compiled
def worn_radius(contact: Any, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One, phi: Array) -> Array:
        found = worn(contact.compliance, contact.load, phi, contact.effort)
        return jnp.exp(found.punch.log_c) * jnp.sqrt(1.0 + found.y)

    return _each(one, contact, digits, contact.amplitude(tangential_force))[0]


@compiled
def penetration(contact: Any, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One, phi: Array) -> Array:
        punch, depth = stick(contact.compliance, contact.load, phi, contact.effort)
        return contact.height(punch) * depth

    return _each(one, contact, digits, contact.amplitude(tangential_force))[0]


def _not_over_cycles(cycles: ArrayLike | None) -> None:
    if cycles is not None:
        raise ValueError(
            "wear over cycles is known for a power law under a rigid indenter alone, the steady state for all"
        )


@compiled
def wear_volume(
    contact: Any,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    del wear_coefficient
    _not_over_cycles(cycles)

    def one(contact: _One, phi: Array) -> Array:
        found = worn(contact.compliance, contact.load, phi, contact.effort)
        return jnp.exp(4.0 * found.punch.log_c) / contact.radius * found.volume

    return _each(one, contact, digits, contact.amplitude(tangential_force))[0]


@compiled
def cycles_to(
    contact: Any,
    share: ArrayLike,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    *,
    digits: int | None = None,
) -> Array:
    del contact, tangential_force, wear_coefficient, digits
    _not_over_cycles(share)
    raise AssertionError


@compiled
def deepest_wear(contact: Any, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One, phi: Array) -> Array:
        found = worn(contact.compliance, contact.load, phi, contact.effort)
        lack = found.beside.lack(found.depth)
        most = deepest(lack, found.beside.a, jnp.where(phi > 0.0, found.y, 1.0), contact.effort)
        return contact.height(found.punch) * jnp.where(phi > 0.0, most, 0.0)

    return _each(one, contact, digits, contact.amplitude(tangential_force))[0]


# --- pressures --------------------------------------------------------------------------------------------------------


class _Pressure(NamedTuple):
    """A pressure inside c."""

    c: Array
    s: Array
    y: Array  # coefficients, of a pressure in Pa
    infinite: Array  # whether it is, at the edge


def _pressure_of(contact: _One, punch: Punch, y: Array, singular: Array) -> _Pressure:
    c, s = jnp.exp(punch.log_c), contact.compliance.s
    e = jnp.exp(-jax.lax.lgamma(1.0 + s)) * jnp.exp2(-s)
    return _Pressure(c, s, (e * c / contact.radius) * y, singular > 0.0)


def _unworn_pressure(contact: _One) -> _Pressure:
    punch = contact.unworn()
    s = contact.compliance.s
    # That depth at which nothing is singular at the edge, also of what is left of the infinite series.
    depth = at_edge(punch.bowl, s) / at_edge(punch.flat, s)
    return _pressure_of(contact, punch, depth * punch.flat - punch.bowl, jnp.zeros_like(s))


def _at(pressure: _Pressure, apart: Array) -> Array:
    """The pressure at distances inside the edge, shape (m,), 0 outside."""
    inside = apart > 0.0
    relative = jnp.where(inside, jnp.minimum(apart, pressure.c), 0.5 * pressure.c) / pressure.c
    found = pressure_inside(pressure.y, pressure.s, relative * (2.0 - relative))
    return jnp.where(inside, found, jnp.where((apart == 0.0) & pressure.infinite, jnp.inf, 0.0 * apart))


def _at_radii(function: Callable[..., Any], contact: Any, r: ArrayLike, digits: int | None, *arguments: Array) -> Array:
    states, shape = _each(function, contact, digits, *arguments)
    r = jnp.asarray(guarded("r", r, RADIUS))
    return over_radii(lambda state, r: _at(state, state.c - r), states, shape, r.astype(states.c.dtype))


@compiled
def initial_pressure(contact: Any, r: ArrayLike, *, digits: int | None = None) -> Array:
    return _at_radii(_unworn_pressure, contact, r, digits)


@compiled
def peak_initial_pressure(contact: Any, *, digits: int | None = None) -> Array:
    shares = 1.0 - np.linspace(0.0, 1.0, 48, endpoint=False) ** 2  # of the distance to the edge

    def one(contact: _One) -> Array:
        pressure = _unworn_pressure(contact)
        return jnp.max(_at(pressure, pressure.c * jnp.asarray(shares, pressure.c.dtype)))

    return _each(one, contact, digits)[0]


def _steady_pressure(contact: _One, phi: Array) -> _Pressure:
    punch, depth = stick(contact.compliance, contact.load, phi, contact.effort)
    s = contact.compliance.s
    touching = at_edge(punch.bowl, s) / at_edge(punch.flat, s)
    return _pressure_of(contact, punch, (touching + depth - punch.depth) * punch.flat - punch.bowl, phi)


@compiled
def steady_pressure(contact: Any, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    return _at_radii(_steady_pressure, contact, r, digits, contact.amplitude(tangential_force))


@compiled
def pressure(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    del wear_coefficient
    _not_over_cycles(cycles)
    return steady_pressure(contact, r, tangential_force, digits=digits)


@compiled
def steady_traction(contact: Any, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One, phi: Array) -> _Pressure:
        punch, depth = stick(contact.compliance, contact.load, phi, contact.effort)
        return _pressure_of(contact, punch, contact.friction * (depth - punch.depth) * punch.flat, phi)

    return _at_radii(one, contact, r, digits, contact.amplitude(tangential_force))


@compiled
def edge_pressure(
    contact: Any, distance: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None
) -> Array:
    states, shape = _each(_steady_pressure, contact, digits, contact.amplitude(tangential_force))
    distance = jnp.asarray(guarded("distance", distance, DISTANCE)).astype(states.c.dtype)
    return over_radii(_at, states, shape, distance)


@compiled
def edge_intensity(contact: Any, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One, phi: Array) -> Array:
        punch, depth = stick(contact.compliance, contact.load, phi, contact.effort)
        k, log_g = contact.compliance.lead
        s = 0.5 * (1.0 + k)
        # Its square is the energy that the contact would release by growing.
        log_square = jnp.log(punch.growth) + (k - 3.0) * punch.log_c - log_g + 2.0 * (1.0 - s) * np.log(2.0)
        intensity = jnp.exp(0.5 * log_square - jax.lax.lgamma(s)) / np.sqrt(2.0 * np.pi)
        return contact.height(punch) * (depth - punch.depth) * intensity

    return _each(one, contact, digits, contact.amplitude(tangential_force))[0]


# --- displacements ----------------------------------------------------------------------------------------------------


class _Surface(NamedTuple):
    """What is beside a contact of radius c."""

    c: Array
    height: Array
    depth: Array  # in units of the height, as all below
    level: Array
    fall: Array
    v: Array
    a: Array
    end: Array  # y up to which there is a ring
    factor: Array  # of a result


def _surface_of(contact: _One, phi: Array) -> _Surface:
    found = worn(contact.compliance, contact.load, phi, contact.effort)
    return _surface(contact, found.punch, found.beside, found.depth, found.y)


def _surface(contact: _One, punch: Punch, beside: Any, depth: Array, end: Array) -> _Surface:
    lack, height = beside.lack(depth), contact.height(punch)
    return _Surface(jnp.exp(punch.log_c), height, depth, *lack, beside.a, end, jnp.ones_like(height))


def _depth_at(state: _Surface, r: Array, effort: Effort) -> Array:
    """The gap in m that Abel's integral leaves at radii beside the contact, shape (m,), and 0 under it."""
    from plgwear_jax.surfaces.ring import Lack

    lack = Lack(state.level, state.fall, state.v)
    outside = r > state.c
    near = jnp.where(outside, r, 1.5 * state.c)
    y = ((near - state.c) / state.c) * ((near + state.c) / state.c)
    found = jax.vmap(lambda y: depth_beside(lack, state.a, y, effort)[0])(y)
    return jnp.where(outside, state.height * found, 0.0)


def _worn_depth(state: _Surface, r: Array, effort: Effort) -> Array:
    edge = state.c * jnp.sqrt(1.0 + state.end)
    return jnp.where(r < edge, jnp.maximum(_depth_at(state, jnp.minimum(r, edge), effort), 0.0), 0.0)


def _with_radii(
    function: Callable[..., Any],
    of: Callable[..., Array],
    contact: Any,
    r: ArrayLike,
    digits: int | None,
    *arguments: Any,
) -> Array:
    states, shape = _each(function, contact, digits, *arguments)
    effort = effort_of(digits)
    radii = jnp.asarray(guarded("r", r, RADIUS)).astype(states.c.dtype)
    return over_radii(lambda state, r: of(state, r, effort), states, shape, radii)


def _displaced(state: _Surface, r: Array, effort: Effort) -> Array:
    shape = 0.5 * state.height * (r / state.c) ** 2
    return state.height * state.depth - shape - _depth_at(state, r, effort)


@compiled
def initial_displacement(contact: Any, r: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One) -> _Surface:
        from plgwear_jax.surfaces.ring import beside

        punch = contact.unworn()
        return _surface(
            contact, punch, beside(contact.compliance, punch, contact.effort), punch.depth, jnp.zeros_like(punch.log_c)
        )

    return _with_radii(one, _displaced, contact, r, digits)


@compiled
def steady_displacement(contact: Any, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    return _with_radii(_surface_of, _displaced, contact, r, digits, contact.amplitude(tangential_force))


@compiled
def wear_depth(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    del wear_coefficient
    _not_over_cycles(cycles)
    return _with_radii(_surface_of, _worn_depth, contact, r, digits, contact.amplitude(tangential_force))


@compiled
def profile(
    contact: Any,
    r: ArrayLike,
    tangential_force: ArrayLike,
    *,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    del wear_coefficient
    _not_over_cycles(cycles)

    def shape(state: _Surface, r: Array, effort: Effort) -> Array:
        return 0.5 * state.height * (r / state.c) ** 2 + _worn_depth(state, r, effort)

    return _with_radii(_surface_of, shape, contact, r, digits, contact.amplitude(tangential_force))


# --- slip -------------------------------------------------------------------------------------------------------------


def _with_rig(rig_stiffness: ArrayLike | None) -> Array:
    """The compliance of the rig."""
    return jnp.zeros(()) if rig_stiffness is None else 1.0 / guarded("rig_stiffness", rig_stiffness, POSITIVE)


@compiled
def gross_slip_displacement(
    contact: Any, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None
) -> Array:
    def one(contact: _One, rig: Array) -> Array:
        punch = contact.unworn()
        return contact.tangential(punch) * contact.height(punch) * punch.depth + rig * contact.friction * contact.force

    return _each(one, contact, digits, _with_rig(rig_stiffness))[0]


@compiled
def displacement_amplitude(
    contact: Any,
    tangential_force: ArrayLike,
    *,
    rig_stiffness: ArrayLike | None = None,
    worn: bool = False,
    digits: int | None = None,
) -> Array:
    def one(contact: _One, phi: Array, rig: Array) -> Array:
        unworn = contact.unworn()
        punch, depth = stick(contact.compliance, contact.load, phi, contact.effort)
        if worn:
            moved = contact.height(punch) * (depth - punch.depth)
        else:
            moved = contact.height(unworn) * unworn.depth - contact.height(punch) * punch.depth
        return contact.tangential(unworn) * moved + rig * contact.friction * phi * contact.force

    return _each(one, contact, digits, contact.amplitude(tangential_force), _with_rig(rig_stiffness))[0]


@compiled
def tangential_force(
    contact: Any,
    displacement_amplitude: ArrayLike,
    *,
    rig_stiffness: ArrayLike | None = None,
    digits: int | None = None,
) -> Array:
    moved = guarded("displacement_amplitude", displacement_amplitude, DISPLACEMENT)

    def one(contact: _One, moved: Array, rig: Array) -> Array:
        unworn = contact.unworn()
        tangential, most = contact.tangential(unworn), contact.height(unworn) * unworn.depth

        def force_at(log_c: Array) -> tuple[Array, Array]:
            punch = punch_at(contact.compliance, log_c, contact.effort)
            held = contact.height(punch) * punch.force
            return contact.friction * (contact.force - held), contact.height(punch) * punch.depth

        def excess(log_c: Array) -> Array:
            force, depth = force_at(log_c)
            return (moved - tangential * (most - depth) - rig * force) / (tangential * most)

        return force_at(root_of(excess, unworn.log_c, 2.0))[0]

    return _each(one, contact, digits, moved, _with_rig(rig_stiffness))[0]


class _Slip(NamedTuple):
    unworn: Punch
    surface: _Surface


def _slip(contact: _One, phi: Array) -> _Slip:
    from plgwear_jax.surfaces.ring import beside

    unworn = contact.unworn()
    punch, _ = stick(contact.compliance, contact.load, phi, contact.effort)
    end = jnp.expm1(2.0 * (unworn.log_c - punch.log_c))
    surface = _surface(contact, punch, beside(contact.compliance, punch, contact.effort), punch.depth, end)
    return _Slip(unworn, surface._replace(factor=contact.tangential(unworn)))


@compiled
def slip_amplitude(contact: Any, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def of(state: _Surface, r: Array, effort: Effort) -> Array:
        edge = state.c * jnp.sqrt(1.0 + state.end)
        slip = -state.factor * _depth_at(state, jnp.minimum(r, edge), effort)
        return jnp.where(r <= edge, jnp.maximum(slip, 0.0), 0.0)

    def one(contact: _One, phi: Array) -> _Surface:
        return _slip(contact, phi).surface

    return _with_radii(one, of, contact, r, digits, contact.amplitude(tangential_force))


@compiled
def energy_per_cycle(contact: Any, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
    def one(contact: _One, phi: Array) -> Array:
        pressure, (unworn, surface) = _unworn_pressure(contact), _slip(contact, phi)
        end = jnp.where(phi > 0.0, surface.end, 1.0)

        def work(y: Array, left: Array) -> Array:
            r = surface.c * jnp.sqrt(1.0 + y)
            # z = 1 - (r/a)^2 without cancellation.
            z = left * end / (1.0 + end)
            return pressure_inside(pressure.y, pressure.s, z) * -_depth_at(surface, r, contact.effort)

        total = ring_integral(work, end, contact.effort)
        energy = 4.0 * np.pi * contact.friction * surface.factor * jnp.exp(2.0 * jnp.log(surface.c)) * total
        return jnp.where(phi > 0.0, energy, 0.0)

    return _each(one, contact, digits, contact.amplitude(tangential_force))[0]
