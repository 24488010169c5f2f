"""The steady state of a contact: the dimensionless functions of `fretting` and `partial_slip` in SI units.

They hold for a rigid parabola on a power law, and for two homogeneous bodies, which are a power law with k = 0 and both
moduli. All other contacts have the same quantities, computed in `steady.numeric`.
"""

import functools
import math
import operator
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self

import jax.numpy as jnp
from jax import Array

from plgwear_jax import fretting, partial_slip
from plgwear_jax._core.catalogue import FRETTING
from plgwear_jax._core.domains import (
    EXPONENT,
    NUMBER,
    ArrayLike,
    Domain,
    check,
    field_nan_outside,
    nan_outside,
    nan_unless,
)
from plgwear_jax._core.doubts import doubt, of_onset, own_numbers
from plgwear_jax._core.formula import compiled
from plgwear_jax._core.startup.programs import follows, program, with_slopes
from plgwear_jax._core.xla import materialised
from plgwear_jax.loads import Force
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.special.jacobi import gamma

from .arguments import amplitude_of
from .batch import as_numbers, dtype_of
from .solution import Solution

if TYPE_CHECKING:
    from plgwear_jax.stresses.field import Pressed, Stress
    from plgwear_jax.stresses.peaks import Peak

_THICKNESS = Domain("> 0", lambda h: h > 0.0)


def one_half_space(contact: Any) -> PowerLawGraded:
    """The half-space, of two homogeneous bodies the one that deforms as both do together."""
    if contact.indenter is None:
        return contact.material.power_law
    from plgwear_jax.surfaces import in_series  # imported here, since a power law does not need it

    return in_series(contact.material, contact.indenter)


@program(static=1)
def _unworn_radius(digits: int | None, contact: Any) -> Array:
    """a_0 in m, Eq. (12)."""
    material = one_half_space(contact)
    log_stiffness = material.log_stiffness(digits=digits)
    k = jnp.asarray(material.k, log_stiffness.dtype)
    load = (field_nan_outside(contact, name) for name in ("normal_force", "radius"))
    log_load = sum(map(jnp.log, load), jnp.log(0.25 * (3.0 + k)))
    # Materialised, or XLA would compute it again for every result that it scales.
    return materialised(jnp.exp((log_load - log_stiffness) / (3.0 + k)))


def _number_in(function: Callable[..., Array], *units: str) -> Any:
    """A property that is a dimensionless function of the exponent and the load, in the product of these units."""

    def number(self: "Steady") -> Array:
        return self._scaled(functools.reduce(operator.mul, (getattr(self, unit) for unit in units)), function)

    number.__name__ = number.__qualname__ = function.__name__  # by which programs are told apart
    law = FRETTING[function.__name__]
    return property(compiled(number), doc=f"{law.description}, in {law.unit}")


class Steady(Solution):
    """A contact under a load, unworn and worn to its steady state, in SI units: `FrettingContact.steady`.

    What nobody reads is neither computed nor traced. A contact without closed forms is solved once, when the first
    result is read.

    Attributes:
        contact: The contact.
        load: A force amplitude F_x, 0 <= F_x < mu F_N, broadcast against the fields of the contact, or a displacement
            amplitude. The steady state is that under the force amplitude which the load has before any wear.
        digits: Correct digits wanted; by default all that the solver has, see `FrettingContact`.

    Radii r and distances are in m, >= 0. A distance from the stick-slip boundary beyond the stick radius gives the
    value at the centre. Where the load has a rig stiffness, displacement amplitudes are those at the actuator of the
    rig, and energy ratios and sliding ratios are those of the loop that is measured there.

    Raises:
        ValueError: A concrete number is outside its range, or the bodies would have to pull on each other: where the
            pressure before any wear would be negative nothing has a result, where only that in the steady state would
            be, nothing that is worn. Under `jit`, and for members of batches, the result is NaN there.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> steady = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4).steady(0.32)
        >>> print(f"{steady.stick_radius:.3e} m, {steady.wear_volume:.3e} m^3")
        6.584e-05 m, 2.961e-18 m^3

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (11) to (28); other bodies and shapes:
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    def _check_question(self) -> None:
        super()._check_question()
        # What is read later by programs alone, where numbers are traced.
        if not self.load.holds_force:
            with own_numbers():  # whoever reads the force hears the doubt
                self.load.check_at_rest(self._at_rest)

    # --- the load ---------------------------------------------------------------------------------------------------

    @property
    def tangential_force(self) -> Any:
        """Force amplitude F_x in N, of a displacement amplitude that before any wear."""
        return self.load.force_before_wear(self) if self.load.holds_force else self._solution[1]

    def _solve(self) -> tuple[Array, ArrayLike | None]:
        """The contact radius and the force that a displacement needs, once for all results."""
        find = with_slopes(_unworn_radius) if follows(self.contact) else _unworn_radius
        radius = find(self.digits, self.contact)
        if self.load.holds_force:
            return radius, None
        return radius, self.load.force_before_wear(self._at_rest._with_contact_radius(radius))

    @property
    def _at_rest(self) -> Self:
        return type(self)(self.contact, Force(0.0, self.load.rig_stiffness), digits=self.digits)

    @property
    @compiled
    def amplitude(self) -> Array:
        """phi = F_x/(mu F_N), dimensionless."""
        friction, force = (field_nan_outside(self.contact, name) for name in ("friction", "normal_force"))
        return amplitude_of(friction, force, self.tangential_force)

    @property
    def _limiting_friction(self) -> Array:
        """mu F_N."""
        return self.contact.friction * self.contact.normal_force

    # --- units ------------------------------------------------------------------------------------------------------

    @property
    def _k(self) -> Any:
        """The exponent of the half-space."""
        return one_half_space(self.contact).k

    def _stiffening(self, contact_radius: Array) -> Array:
        """How many times as large E0 is where the contact has this radius in m: that depends on E0/z0^k, Eq. (12)."""
        return (self.contact_radius / contact_radius) ** (3.0 + self._k)

    def _with_contact_radius(self, contact_radius: Array) -> Self:
        """The same where the contact radius is known: all units follow from it, and E0 and z0 are not read."""
        return self._unflatten(self.digits, (self.contact, self.load, (contact_radius, None)))

    @property
    def _height(self) -> Array:
        """a_0^2/R, the unit of heights."""
        return self.contact_radius * self.contact_radius / field_nan_outside(self.contact, "radius")

    @property
    def _mean_pressure(self) -> Array:
        """F_N/(pi a_0^2), the unit of stresses."""
        return self.contact.normal_force / (jnp.pi * self.contact_radius * self.contact_radius)

    @property
    def _tangential_ratio(self) -> Array:
        """theta, the tangential compliance over the normal one."""
        return one_half_space(self.contact).tangential_ratio(digits=self.digits)

    @property
    def _tangential_height(self) -> Array:
        """mu theta a_0^2/R, the unit of tangential displacements."""
        return field_nan_outside(self.contact, "friction") * self._tangential_ratio * self._height

    def _scaled(self, unit: Array, function: Callable[..., Array], **at: ArrayLike) -> Array:
        """A dimensionless function, of radii or distances in m if given, in this unit."""
        relative = (self._relative(name, x, self.contact_radius) for name, x in at.items())
        return unit * function(*relative, self._k, self.amplitude, digits=self.digits)

    def _before_wear(self, unit: Array, function: Callable[..., Array], r: ArrayLike) -> Array:
        """The same of a function that does not depend on the load."""
        return unit * function(self._relative("r", r, self.contact_radius), self._k, digits=self.digits)

    # --- scalars ----------------------------------------------------------------------------------------------------

    @property
    def contact_radius(self) -> Array:
        """Contact radius a_0 before any wear in m, Eq. (12)."""
        return self._solution[0]

    stick_radius: Array = _number_in(fretting.stick_radius, "contact_radius")
    """Stick radius c in m, Eqs. (16) and (23)."""

    worn_radius: Array = _number_in(fretting.worn_radius, "contact_radius")
    """Outer radius a_inf of the worn ring in m, Eq. (26)."""

    penetration: Array = _number_in(fretting.penetration, "_height")
    """Indentation depth d_inf in m, Eqs. (11) and (25); at F_x = 0 it is d_0 of Eq. (11)."""

    wear_volume: Array = _number_in(fretting.wear_volume, "contact_radius", "contact_radius", "_height")
    """Volume worn off the indenter in m^3, Eq. (28)."""

    deepest_wear: Array = _number_in(fretting.deepest_wear, "_height")
    """Largest depth worn off the indenter in m, from Eqs. (24) and (25)."""

    edge_intensity: Array = _number_in(fretting.edge_intensity, "_mean_pressure")
    """Factor in Pa of (2 delta)^((k-1)/2) in the pressure at r = c (1 - delta), Eq. (20).

    Of a power law under an elastic indenter the body that gives way most at the edge decides: for k < 0 the
    exponent is that of k = 0. At k = 0 both bodies count and the factor jumps, so that its slope by k means nothing
    there; `edge_pressure` does not jump.
    """

    @property
    def _edge_exponent(self) -> Any:
        """(k-1)/2, that of the pressure at the stick-slip boundary, of the body that gives way most at the edge."""
        return 0.5 * (self._k - 1.0)

    @property
    def peak_initial_pressure(self) -> Array:
        """Largest pressure before any wear in Pa, Eq. (13)."""
        return self.initial_pressure(0.0)  # for every k it is the one at the centre

    # --- displacements, with those of a rig ---------------------------------------------------------------------------

    @property
    def gross_slip_displacement(self) -> Array:
        """Displacement amplitude in m at which the unworn contact begins to slip as a whole."""
        alone = self._onset
        doubt(of_onset(alone))
        return self._with_rig(alone, self._limiting_friction)

    @property
    def displacement_amplitude(self) -> Array:
        """Displacement amplitude in m of the unworn contact, measured far from it."""
        return self._with_rig(self._moved, self.tangential_force)

    @property
    def worn_displacement_amplitude(self) -> Array:
        """Displacement amplitude in m of the worn contact."""
        return self._with_rig(self._worn_moved, self.tangential_force)

    @property
    def energy_ratio(self) -> Array:
        """Energy of a cycle of the unworn contact over 4 F_x u_x, dimensionless; 0 at F_x = 0."""
        return self._energy_ratio * self._share

    @property
    def loop_aperture(self) -> Array:
        """Displacement of the unworn contact at no force over its displacement amplitude; 0 at F_x = 0."""
        return self._aperture * self._share

    @property
    def gross_slip_energy_ratio(self) -> Array:
        """The energy ratio at which the unworn contact begins to slip as a whole, (1+k)/(5+k) for a parabola."""
        return self._onset_energy_ratio * self._share_at_onset

    @property
    def gross_slip_aperture(self) -> Array:
        """The sliding ratio at which gross slip of the unworn contact begins, 2^((1+k)/(3+k)) - 1 for a parabola."""
        return self._onset_aperture * self._share_at_onset

    @property
    def _share(self) -> Array | float:
        """The share of the unworn contact in the displacement amplitude."""
        return 1.0 if self.load.rig_stiffness is None else self._share_of_contact

    @property
    def _share_at_onset(self) -> Array | float:
        if self.load.rig_stiffness is None:
            return 1.0
        alone = self._onset
        return alone / self._with_rig(alone, self._limiting_friction)

    def _with_rig(self, alone: Array, force: ArrayLike) -> Array:
        """The displacement in m at the actuator of the rig under a force."""
        return alone if self.load.rig_stiffness is None else alone + jnp.asarray(force) * self.load.rig_compliance

    # --- the same without a rig ---------------------------------------------------------------------------------------

    @property
    @compiled
    def _onset(self) -> Array:
        return self._tangential_height / (1.0 + self._k)

    _moved = _number_in(partial_slip.displacement_amplitude, "_onset")

    @property
    @compiled
    def _worn_moved(self) -> Array:
        # mu theta times c^2 Lambda/2, the depth of the steady-state punch beyond a parabola of the same contact radius
        k, phi = self._k, self.amplitude
        sunk = fretting.stick_radius(k, phi, digits=self.digits) ** 2 / ((1.0 - phi) * (1.5 + 0.5 * k))
        return self._onset * phi * sunk

    energy_per_cycle: Array = _number_in(partial_slip.energy_per_cycle, "_limiting_friction", "_tangential_height")
    """Energy in J that friction dissipates in a cycle of the unworn contact."""

    _energy_ratio = _number_in(partial_slip.energy_ratio, "_one")

    _aperture = _number_in(partial_slip.loop_aperture, "_one")

    @property
    @compiled
    def _onset_energy_ratio(self) -> Array:
        k = nan_outside("k", self._k, EXPONENT)
        return self._one * ((1.0 + k) / (5.0 + k))

    @property
    @compiled
    def _onset_aperture(self) -> Array:
        k = nan_outside("k", self._k, EXPONENT)
        return self._one * jnp.expm1(math.log(2.0) * (1.0 + k) / (3.0 + k))

    @property
    def _one(self) -> Array:
        """1 of each contact, NaN where one is outside its ranges."""
        return 1.0 + 0.0 * self.contact_radius

    @compiled
    def force_at(self, displacement_amplitude: ArrayLike) -> Array:
        """Force amplitude F_x in N at which the unworn contact has a displacement amplitude in m."""
        moved = nan_outside("displacement_amplitude", displacement_amplitude, NUMBER)
        limit, onset = self._limiting_friction, self._onset
        rig = limit * self.load.rig_compliance
        return limit * partial_slip.amplitude(self._k, moved / (onset + rig), rig / onset, digits=self.digits)

    @property
    @compiled
    def _share_of_contact(self) -> Array:
        rig = self._limiting_friction * self.load.rig_compliance / self._onset
        return partial_slip.contact_share(self._k, self.amplitude, rig, digits=self.digits)

    # --- functions of the radius ------------------------------------------------------------------------------------

    @compiled
    def edge_pressure(self, distance: ArrayLike) -> Array:
        """Worn pressure in Pa at a distance inside the stick-slip boundary, r = c - distance, Eq. (17)."""
        return self._scaled(self._mean_pressure, fretting.edge_pressure, distance=distance)

    @compiled
    def initial_displacement(self, r: ArrayLike) -> Array:
        """Normal displacement w_0 of the surface in m before any wear, Eq. (14)."""
        return self._before_wear(self._height, fretting.initial_displacement, r)

    @compiled
    def steady_displacement(self, r: ArrayLike) -> Array:
        """Normal displacement w_inf of the surface in m, Eq. (24)."""
        return self._scaled(self._height, fretting.steady_displacement, r=r)

    @compiled
    def profile(self, r: ArrayLike) -> Array:
        """Shape f_inf of the worn indenter in m above its apex, Eq. (25)."""
        return self._scaled(self._height, fretting.profile, r=r)

    @compiled
    def wear_depth(self, r: ArrayLike) -> Array:
        """Depth f_inf - f_0 in m worn off, from Eqs. (24) and (25)."""
        return self._scaled(self._height, fretting.wear_depth, r=r)

    @compiled
    def initial_pressure(self, r: ArrayLike) -> Array:
        """Pressure p_0 in Pa before any wear, Eq. (13)."""
        return self._before_wear(self._mean_pressure, fretting.initial_pressure, r)

    @compiled
    def pressure(self, r: ArrayLike) -> Array:
        """Pressure p_inf in Pa, Eq. (17); infinite at r = c."""
        return self._scaled(self._mean_pressure, fretting.steady_pressure, r=r)

    @compiled
    def traction(self, r: ArrayLike) -> Array:
        """Tangential traction tau_inf in Pa, Eq. (19); infinite at r = c."""
        return self._scaled(self.contact.friction * self._mean_pressure, fretting.steady_traction, r=r)

    @compiled
    def slip_amplitude(self, r: ArrayLike) -> Array:
        """Slip amplitude in m in the ring c < r < a_0 of the unworn contact; 0 where nothing slips."""
        return self._scaled(self._tangential_height, partial_slip.slip_amplitude, r=r)

    def modulus_at(self, z: ArrayLike) -> Array:
        """Young's modulus of the half-space in Pa at a depth z in m, Eq. (1)."""
        return self.contact.material.modulus_at(z)

    # --- stresses -----------------------------------------------------------------------------------------------------

    def stress(self, x: ArrayLike, z: ArrayLike, *, worn: bool = False) -> "Stress":
        """Stresses in Pa in the plane of the motion, under the largest tangential force.

        Args:
            x: Along the motion in m, from the axis of the contact, negative behind it.
            z: Depth in m, z >= 0; broadcasts against x.
            worn: In the steady state, infinite at the surface at the stick-slip boundary, not before any wear.

        A grid is fast as x of shape (n,) and z of shape (m, 1).
        """
        from .stressed import stresses_of  # imported by the first contact that needs it

        if worn:
            self._check_worn()
        return stresses_of(self, self._argument("x", x), self._argument("z", z), worn)

    def tension(self, x: ArrayLike, z: ArrayLike) -> Array:
        """Largest principal stress in Pa before any wear at x and z, see `stress`."""
        return self.stress(x, z).principal

    def mises(self, x: ArrayLike, z: ArrayLike) -> Array:
        """Von Mises' stress in Pa before any wear at x and z, see `stress`."""
        return self.stress(x, z).mises

    @property
    def peak_tension(self) -> Array:
        """Largest principal stress anywhere before any wear in Pa; infinite where the surface modulus is (k < 0)."""
        return self._peak("principal").value

    @property
    def peak_mises(self) -> Array:
        """Largest von Mises stress anywhere before any wear in Pa; infinite like `peak_tension`."""
        return self._peak("mises").value

    @property
    def peak_tension_at(self) -> tuple[Array, Array]:
        """Where the largest principal stress is, (x, z) in m."""
        return self._peak("principal")[1:]

    @property
    def peak_mises_at(self) -> tuple[Array, Array]:
        """Where von Mises' stress is largest, (x, z) in m."""
        return self._peak("mises")[1:]

    def peak_mises_between(self, least: ArrayLike, most: ArrayLike) -> Array:
        """Von Mises' stress in Pa before any wear where it is largest between two depths in m, least < most.

        At an interface `least` is just below it and `most` just above, so that the depths of a layer are those of its
        stresses alone. Scalars, or one pair for each contact of a batch.
        """
        low, high = self._argument("least", least), self._argument("most", most)
        check("most - least", high - low, _THICKNESS)
        from .stressed import peak_stress_of

        inside = 16.0 * jnp.finfo(dtype_of(self.contact)).eps
        high = nan_unless(high > low, high * (1.0 - inside))
        return peak_stress_of(self, "mises", low * (1.0 + inside), high).value

    def _peak(self, name: str) -> "Peak":
        from .stressed import peak_stress_of

        return self._once(f"peak {name}", lambda: peak_stress_of(self, name))  # for its value and its place

    def _given(self) -> Any:
        """The numbers of the question, as arrays of one dtype."""
        return as_numbers((self.contact, self.load, self._solution))

    def _solved(self, given: Any) -> Self:
        """What programs of stresses take, of such numbers and by programs alone."""
        return self._unflatten(self.digits, given)

    def _check_worn(self) -> None:
        """Refuse a contact that would have to pull."""

    @property
    def _pressed(self) -> "Pressed":
        """What the stresses follow from."""
        from plgwear_jax.stresses.field import Pressed, samples

        from .stressed import half_space_of

        contact = self.contact
        units = self._k, self.amplitude, self._mean_pressure, self.contact_radius
        k, phi, mean, radius, force, friction = jnp.broadcast_arrays(*units, contact.normal_force, contact.friction)
        stick, s = fretting.stick_radius(k, phi, digits=self.digits), 0.5 + 0.5 * k
        inside = samples(self.digits, k.dtype, alone=True)
        # As p = (1 - r^2)^s; what is added is a flat punch, with s - 1.
        unit = mean * gamma(1.0 + s) / gamma(0.5 + s) * math.pi**-0.5
        flat = unit[..., None] * jnp.exp((s - 0.5)[..., None] * jnp.log(inside))
        own, area = ((1.0 + s) / (0.5 + s))[..., None] * inside * flat, stick * stick
        stuck, flat = ((1.0 - phi) / area)[..., None] * own, (phi / area)[..., None] * flat
        rest = half_space_of(contact.material, radius)
        return Pressed(self.digits, force, radius, stick, friction, own, stuck, flat, s, *rest)
