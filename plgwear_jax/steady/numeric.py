"""The steady state of contacts without closed forms, from one program that all their quantities share."""

# Properties that a function returns are none for Pyright.
# pyright: reportIncompatibleMethodOverride=false

import dataclasses
import math
from typing import Any, Self

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._core.startup.programs import program, traced, with_slopes
from plgwear_jax.partial_slip import loop_opening, softness
from plgwear_jax.shapes import outline_of
from plgwear_jax.shapes.shape import inwards
from plgwear_jax.special.elementary import clamp_keep_slope, crest, ratio_where, squares_apart
from plgwear_jax.special.jacobi import gamma
from plgwear_jax.special.quadrature import logistic, pieces
from plgwear_jax.special.root import root_of
from plgwear_jax.stresses.field import Pressed, samples
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.surfaces.power_laws import power_law
from plgwear_jax.surfaces.punch import (
    Punch,
    along_radius,
    apart,
    flat_pressure,
    own_pressure,
    pressed,
    punch_under,
    stiffness_apart,
    surplus,
)
from plgwear_jax.surfaces.ring import FEW_KINKS, deepest, sunk_beside

from .batch import as_numbers, in_turn
from .closed import Steady
from .state import Results, State, refuse_tension, solved_results, solved_states, states_of
from .stressed import half_space_of

# --- of each state ----------------------------------------------------------------------------------------------------


@program(static=1, level=1)
def _each_state(name: str, states: State, *more: Array) -> Any:
    # By a name, by which a kept program is known.
    return in_turn(globals()[name], states.shape, states, more=more)


@program(static=1, level=1)
def over_radii_of(name: str, states: State, r: Array) -> Array:
    """The function of this name, of a state and radii."""
    function, r = globals()[name], jnp.asarray(r, states.force.dtype)
    if states.shape == ():
        return function(states, r.ravel()).reshape(r.shape)
    return in_turn(lambda state, r: function(state, r[None])[0], states.shape, states, more=(r,))


def deepest_of(state: State) -> Array:
    worn = state.phi > 0.0
    most = deepest(state.beside.deficit(state.further), jnp.where(worn, state.end, 1.0))
    return state.height(state.punch) * jnp.where(worn, most, 0.0)


# --- pressures --------------------------------------------------------------------------------------------------------


def _edgewise(c: Array, distance: Array) -> tuple[Array, Array]:
    """(Whether distances are outside the edge or on it, 1 - (r/c)^2 inside and anything there, NaN where it is)."""
    outside = distance <= 0.0
    relative = jnp.where(outside, 0.5 * c, jnp.minimum(distance, c)) / c
    return outside, relative * (2.0 - relative)


def _infinite_at(state: State) -> tuple[Array, Array]:
    """Whether the pressure before any wear is infinite at the tip, and on a ring around it."""
    shape, radius = state.bodies.outline
    return shape.unbounded(radius, state.bodies.lead[0])


def _own_pressure(state: State, punch: Punch, distance: Array) -> Array:
    """The pressure in Pa at distances inside the edge of an unworn contact, shape (m,), 0 outside."""
    outside, z = _edgewise(punch.c, distance)
    tip, _ = _infinite_at(state)
    # `own_pressure` knows no place nearer to a tip: there the pressure is that of the nearest one, and infinite at the
    # tip alone, or integrals would be infinite. A program may round c in two ways.
    known = jnp.where(tip, jnp.minimum(z, 1.0 - 1e-11), z)
    found = state.height(punch) * own_pressure(state.bodies, punch, known)
    found = jnp.where(tip & (1.0 - z < 4.0 * jnp.finfo(z.dtype).eps), jnp.inf, found)
    return jnp.where(outside, 0.0 * punch.c, clamp_keep_slope(0.0, found))


def _more_pressure(state: State, distance: Array) -> Array:
    """The pressure in Pa that the worn contact adds, which is that of a flat punch, 0 outside."""
    punch = state.punch
    outside, z = _edgewise(state.c, distance)
    further = state.height(punch) * state.further
    found = jnp.where(outside, 0.0 * further, further * flat_pressure(state.bodies, punch, z))
    return jnp.where((distance == 0.0) & (state.phi > 0.0), jnp.inf, found)


def unworn_pressure_at(state: State, r: Array) -> Array:
    """The pressure in Pa before any wear at radii, shape (m,)."""
    return _own_pressure(state, state.unworn, state.unworn.c - r)


def edge_pressure_of(state: State, distance: Array) -> Array:
    return _own_pressure(state, state.punch, distance) + _more_pressure(state, distance)


def worn_pressure_at(state: State, r: Array) -> Array:
    """The pressure in Pa in the end at radii, shape (m,)."""
    return edge_pressure_of(state, state.c - r)


def _worn_traction_at(state: State, r: Array) -> Array:
    return state.friction * _more_pressure(state, state.c - r)


def strips_of(state: State) -> tuple[Array, Array, Array, Array]:
    """`own`, `stuck`, `flat` and `s` of `Pressed`."""
    bodies, inside = state.bodies, samples(state.bodies.effort.digits, state.force.dtype)

    def unworn(punch: Punch) -> Array:
        return state.height(punch) * own_pressure(bodies, punch, inside, 0.5)

    own, stuck = jax.vmap(unworn)(jax.tree.map(lambda *both: jnp.stack(both), state.unworn, state.punch))
    further = state.height(state.punch) * state.further
    return own, stuck, further * flat_pressure(bodies, state.punch, inside, 0.5), bodies.s


_SHARES = np.linspace(0.0, 1.0, 48, endpoint=False) ** 0.5  # of a_0


def peak_of(state: State) -> Array:
    pressures = unworn_pressure_at(state, jnp.asarray(_SHARES, state.force.dtype) * state.unworn.c)
    tip, ring = _infinite_at(state)
    return jnp.where(tip | ring, jnp.inf, crest(pressures))  # they are at even distances in r^2


def intensity_of(state: State) -> Array:
    punch, (k, log_g) = state.punch, state.bodies.lead
    # Its square is the energy that the flat punch would release by growing.
    square = jnp.log(punch.growth) + (k - 3.0) * punch.log_c - log_g + (1.0 - k) * math.log(2.0)
    intensity = jnp.exp(0.5 * square) / (gamma(0.5 * (1.0 + k)) * math.sqrt(2.0 * math.pi))
    return state.height(punch) * clamp_keep_slope(0.0, state.further) * intensity


# --- displacements ----------------------------------------------------------------------------------------------------


def _outside(c: Array, r: Array) -> tuple[Array, Array]:
    """(Whether radii are outside c, (r/c)^2 - 1 there and anything inside or at infinity)."""
    outside = r > c
    near = jnp.where(outside & (r < jnp.inf), r, 1.5 * c)
    return outside, squares_apart(near, c, c)


def _gap(state: State, further: Array, r: Array) -> Array:
    """What Abel's integral leaves in m at radii (m,) beside c, pressed in further in c^2/R; 0 under the contact."""
    c, deficit = state.c, state.beside.deficit(further)
    outside, y = _outside(c, r)
    # One after the other where each needs G at many places, as in `own_pressure`, or at those of many kinks.
    together = deficit.v is not None and len(deficit.image.kink_positions) <= FEW_KINKS
    found = jax.vmap(deficit.depth)(y) if together else lax.map(jax.checkpoint(deficit.depth), y)
    return jnp.where(outside, state.height(state.punch) * found, 0.0 * c)


def unworn_gap_at(state: State, r: Array) -> Array:
    """The gap in m that the unworn indenter leaves beside its contact of the radius c, shape (m,)."""
    return jnp.maximum(-_gap(state, 0.0 * state.further, r), 0.0)


def worn_depth_at(state: State, r: Array) -> Array:
    """The depth in m worn off in the end at radii, shape (m,)."""
    edge = state.c * jnp.sqrt(1.0 + state.end)
    within = jnp.minimum(r, edge)
    found = jnp.maximum(_gap(state, state.further, within), 0.0)
    return jnp.where((r < edge) & (state.phi > 0.0), found, 0.0 * within)


def _profile(state: State, r: Array) -> Array:
    return state.bodies.outline.height(r) + worn_depth_at(state, r)


def _worn_displacement(state: State, r: Array) -> Array:
    c, punch, further = state.c, state.punch, state.further
    outside, y = _outside(c, r)
    beyond = jnp.where(r == jnp.inf, 0.0, sunk_beside(state.bodies, punch, state.beside, further, y))
    under = state.height(punch) * (punch.depth + further) - state.bodies.outline.height(jnp.minimum(r, c))
    return jnp.where(outside, state.height(punch) * beyond, under)


def _unworn_displacement(state: State, r: Array) -> Array:
    around, none = state.bodies.ring_displacement(state.unworn), 0.0 * state.further
    return _worn_displacement(dataclasses.replace(state, punch=state.unworn, beside=around, further=none), r)


# --- slip -------------------------------------------------------------------------------------------------------------


def _most(state: State) -> Array:
    """The displacement in m at which the contact alone begins to slip as a whole."""
    return state.tangential * state.height(state.unworn) * state.unworn.depth


def _force(state: State, moved: Array, rig: Array) -> Array:
    most = _most(state)
    whole = most + rig * state.friction * state.force  # in its units nothing overflows, whatever the rig

    def at(log_c: Array) -> tuple[Array, Array]:
        punch = state.bodies.punch_at(log_c)
        height = state.height(punch)
        return state.friction * (state.force - height * punch.force), most - state.tangential * height * punch.depth

    def excess(log_c: Array) -> Array:
        force, alone = at(log_c)
        return (moved - alone - rig * force) / whole

    found = clamp_keep_slope(0.0, at(root_of(excess, state.unworn.log_c, 2.0))[0])
    return found - lax.stop_gradient(jnp.where(moved > 0.0, 0.0, found))  # a rounding of the root


def _slip(state: State, r: Array) -> Array:
    edge = state.unworn.c
    within = jnp.minimum(r, edge)
    slip = state.tangential * unworn_gap_at(state, within)
    return jnp.where(r <= edge, slip, 0.0 * within * state.c)


def energy_of(state: State) -> Array:
    """The energy in J that friction takes in a cycle of one unworn contact."""
    # As the stick area shrinks to c, F grows and the contact gives way by dF theta/K(c): the area of the loop is
    # 4 theta times the integral of F' (F - F') over 1/K, where nothing cancels but forces.
    begin, end, kinks = state.punch.log_c, state.unworn.log_c, state.beside.image.kink_positions
    # Where the contact grows beyond a kink F has one too: few are ends of pieces, many take more places.
    few, count = len(kinks) < FEW_KINKS, state.bodies.effort.nodes
    inner = ratio_where(end > begin, 0.5 * jnp.log1p(kinks), end - begin, 1.0) if few else np.zeros(0)
    parts = pieces(inner, begin, logistic((count // 2 + 8 if inner.size else count) if few else 4 * count, 12.0))

    def rate(log_c: Array) -> Array:
        punch = state.bodies.punch_at(log_c)
        force = state.height(punch) * punch.force
        less, more = (state.height(edge) * edge.force for edge in (state.punch, state.unworn))
        return (more - force) * (force - less) * punch.growth / punch.stiffness**2

    total = (end - begin) * (parts.weight @ lax.map(jax.checkpoint(rate), begin + (end - begin) * parts.x))
    return clamp_keep_slope(0.0, 4.0 * state.friction * state.tangential * total) + 0.0 * state.phi  # NaN where it is


# --- the loop of force and displacement -------------------------------------------------------------------------------


def _sunk(state: State, punch: Punch) -> Array:
    """How far in m the unworn indenter sinks in under the force of a punch."""
    # An error of the radius, which is a root, counts by its square: else it would remain where displacements cancel.
    return state.height(punch) * pressed(punch, punch.force)


def _moved(state: State) -> Array:
    """The displacement amplitude in m of the unworn contact."""
    return clamp_keep_slope(0.0, state.tangential * (_sunk(state, state.unworn) - _sunk(state, state.punch)))


def _worn_moved(state: State) -> Array:
    """That of the worn contact."""
    return clamp_keep_slope(0.0, state.tangential * state.height(state.punch) * state.further)


def _first(state: State) -> tuple[Array, Array, Array]:
    """(Whether the amplitude is so small that displacements cancel, s of a power law, an amplitude for it).

    The stiffness of this law grows with the normal force as that of the unworn contact does.
    """
    unworn, few = state.unworn, 1e-3 if state.phi.dtype == jnp.float64 else 0.05
    by_c, small = along_radius(state.bodies, unworn), state.phi < few
    growth = by_c.stiffness / unworn.stiffness / (2.0 + by_c.force / unworn.force)
    return small, growth / (1.0 - growth), jnp.where(small, state.phi, 0.5 * few)


def energy_ratio_of(state: State) -> Array:
    around = 4.0 * state.phi * state.friction * state.force * _moved(state)
    _, s, _ = _first(state)
    return ratio_where(state.phi > 0.0, energy_of(state), around, state.phi * s / (6.0 + 6.0 * s))


def aperture_of(state: State) -> Array:
    small, s, first = _first(state)
    half = _under(state, 1.0 - 0.5 * jnp.where(small, 0.5, state.phi))
    # Masing's rule, u(F_x) - 2 u(F_x/2).
    opened = state.tangential * (2.0 * _sunk(state, half) - _sunk(state, state.unworn) - _sunk(state, state.punch))
    return ratio_where(~small, opened, _moved(state), loop_opening(s, first, None))


def gross_slip_energy_ratio_of(state: State) -> Array:
    # The area beside the curve of the force over the displacement, from the elastic energy of the unworn contact: that
    # of springs on the power law alone, whose pressures do not know each other, and what the rest adds.
    punch, bodies = state.unworn, state.bodies
    c, s, outline = punch.c, bodies.s, bodies.outline
    image = outline.image(c, s)
    parts = pieces(1.0 - inwards(outline.shape.corners, c), c, logistic(100, 26.0))
    lifted = image.first + image.fallen(-jnp.minimum(parts.left, 1.0 - jnp.finfo(c.dtype).eps))  # T is not 0
    first, rest = apart(bodies, punch)
    weight = parts.weight * jnp.exp((s - 1.0) * jnp.log(parts.x))
    own = stiffness_apart(punch, first) * s * (weight @ (lifted * lifted))
    if rest is not None:
        moments, _ = outline.shape.moments(c, outline.radius, s, bodies.effort.modes)
        own = own + punch.stiffness / punch.flat[0] * (moments @ rest)
    return (punch.held - own / punch.depth) / punch.force


def gross_slip_aperture_of(state: State) -> Array:
    return 2.0 * _sunk(state, _under(state, 0.5)) / _sunk(state, state.unworn) - 1.0


def _under(state: State, share: Array | float) -> Punch:
    """The unworn contact under a share of the normal force."""
    return punch_under(state.bodies, share * state.force * state.bodies.outline.radius)


def share_of(state: State, rig: Array) -> Array:
    """The share of the contact in the displacement of a rig of this compliance."""
    small, s, first = _first(state)
    alone = state.tangential / (state.friction * state.unworn.stiffness) * (1.0 + s) * softness(s, first, None)
    alone = ratio_where(~small, _moved(state), state.phi * state.friction * state.force, alone)
    return alone / (alone + rig)


def _field(name: str, worn: bool = False) -> Any:
    """A method that is the function of this name of each state and of radii in m."""

    def at(self: "NumericSteady", r: ArrayLike) -> Array:
        r = self._argument("r", r)
        return over_radii_of(name, self._worn if worn else self._solution, r)

    return at


def _number(name: str, worn: bool = False) -> Any:
    """A property that is the function of this name of each state."""
    return property(lambda self: _each_state(name, self._worn if worn else self._solution))


def _result(name: str, worn: bool = False) -> Any:
    """A property that is this scalar result."""

    def result(self: "NumericSteady") -> Array:
        results = self._results
        if worn and "solved" in vars(self):
            self._check_worn()
        return getattr(results, name)

    return property(result)


class NumericSteady(Steady):
    """A contact without closed forms: to `digits` of 2 to 5, by default 4."""

    def _check_question(self) -> None:
        super(Steady, self)._check_question()
        effort_of(self.digits)  # which refuses more digits than there are

    @property
    def _applied_force(self) -> Any:
        return self.load.force_before_wear(self if self.load.holds_force else self._at_rest)

    @property
    def tangential_force(self) -> Any:
        if self.load.holds_force:
            return self._applied_force
        state = self._solution
        return state.phi * state.friction * state.force

    def _solve(self) -> State:
        return states_of(self.contact, self._applied_force, effort_of(self.digits))

    @property
    def _results(self) -> Results:
        if "solved" in vars(self) or traced(()) or not traced((self.contact, self.load)):
            return self._solution.results
        # At known numbers the derivatives of the results alone do not need those of all that a state has.
        return with_slopes(solved_results)(effort_of(self.digits), *self._given())

    @property
    def _worn(self) -> State:
        """The state, of which what is worn is read."""
        self._check_worn()
        return self._solution

    # --- scalars ----------------------------------------------------------------------------------------------------

    contact_radius = _result("contact_radius")
    stick_radius = _result("stick_radius")
    worn_radius = _result("worn_radius", worn=True)
    penetration = _result("penetration", worn=True)
    wear_volume = _result("wear_volume", worn=True)
    deepest_wear = _number("deepest_of", worn=True)
    edge_intensity = _number("intensity_of", worn=True)
    _edge_exponent = property(lambda self: 0.5 * (self._solution.bodies.lead[0] - 1.0))
    peak_initial_pressure = _number("peak_of")
    energy_per_cycle = _number("energy_of")
    _energy_ratio = _number("energy_ratio_of")
    _aperture = _number("aperture_of")
    _onset_energy_ratio = _number("gross_slip_energy_ratio_of")
    _onset_aperture = _number("gross_slip_aperture_of")
    _onset = _number("_most")
    _moved = _number("_moved")
    _worn_moved = _number("_worn_moved", worn=True)

    @property
    def _share_of_contact(self) -> Array:
        return _each_state("share_of", self._solution, self.load.rig_compliance)

    def force_at(self, displacement_amplitude: ArrayLike) -> Array:
        moved = self._argument("displacement_amplitude", displacement_amplitude)
        return _each_state("_force", self._solution, moved, self.load.rig_compliance)

    def _stiffening(self, contact_radius: Array) -> Array:
        """By a root of the half-space's stiffness, differentiable once; at k = 0 z0 would be without effect."""
        contact = self.contact
        load, k, log_a = contact.normal_force * contact.radius, jnp.asarray(contact.material.k), jnp.log(contact_radius)

        def too_much_force(log_stiffness: Array) -> Array:
            bodies = power_law(k, log_stiffness, contact.indenter, load, effort_of(None), outline_of(contact))
            return surplus(bodies.punch_at(log_a), jnp.log(load))

        # Under a rigid indenter it would be this one.
        alone = jnp.log(load * (0.25 * (3.0 + k))) - (3.0 + k) * log_a
        return jnp.exp(root_of(too_much_force, alone, 0.5) - contact.material.log_stiffness())

    def _with_contact_radius(self, contact_radius: Array) -> Self:
        """The same, which has this radius as far as its digits go."""
        return self

    def _check_worn(self) -> None:
        refuse_tension(self._solution, worn=True)

    def _given(self) -> Any:
        return as_numbers((self.contact, self._applied_force))

    def _solved(self, given: Any) -> Self:
        contact, force = given
        return self._unflatten(self.digits, (contact, None, solved_states(effort_of(self.digits), contact, force)))

    @property
    def _pressed(self) -> Pressed:
        state = self._solution
        own, stuck, flat, s = _each_state("strips_of", state)
        a_0, rest = state.unworn.c, half_space_of(self.contact.material, state.unworn.c)
        return Pressed(self.digits, state.force, a_0, state.c / a_0, state.friction, own, stuck, flat, s, *rest)

    # --- functions of the radius ------------------------------------------------------------------------------------

    def edge_pressure(self, distance: ArrayLike) -> Array:
        return over_radii_of("edge_pressure_of", self._worn, self._argument("distance", distance))

    initial_displacement = _field("_unworn_displacement")
    steady_displacement = _field("_worn_displacement", worn=True)
    profile = _field("_profile", worn=True)
    wear_depth = _field("worn_depth_at", worn=True)
    initial_pressure = _field("unworn_pressure_at")
    pressure = _field("worn_pressure_at", worn=True)
    traction = _field("_worn_traction_at", worn=True)
    slip_amplitude = _field("_slip")
