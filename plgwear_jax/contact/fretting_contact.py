"""Partial slip in SI units."""

from types import ModuleType
from typing import TYPE_CHECKING, Any

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting, partial_slip
from plgwear_jax._core.domains import DISTANCE, POSITIVE, RADIUS, SHARE, check_real, guarded
from plgwear_jax._core.formula import compiled
from plgwear_jax._core.record import record
from plgwear_jax.contact.arguments import DISPLACEMENT, NUMBER, PARTIAL_SLIP, check_bodies, check_fields, refuse_control
from plgwear_jax.contact.checking import check_arguments
from plgwear_jax.contact.dispatch import quantity
from plgwear_jax.special.xla import stored

if TYPE_CHECKING:
    from plgwear_jax.shapes import Shape
    from plgwear_jax.surfaces import Elastic

__all__ = ["FrettingContact"]


@record
class FrettingContact:
    """A parabolic indenter under a constant normal and an oscillating tangential force: section 3 of the paper.

    The indenter wears, the graded half-space does not. A power law under a rigid parabola has the paper's closed forms,
    and so have two homogeneous bodies, with their plane moduli in series. Any other pair is solved numerically, to
    `digits` of 2 to 5, by default 4, and its tangential compliance is taken as proportional to the normal one. Over
    cycles these pairs have 2 to 4 digits.

    Attributes:
        material: The graded half-space: a `PowerLawGraded`, or a `DepthGraded` of any modulus.
        radius: Radius of curvature R of the indenter, in m, positive.
        normal_force: F_N in N, positive.
        friction: Coefficient of friction mu, positive.
        indenter: An `Elastic` body; rigid if None.
        shape: A `Shape`; a parabola if None.

    The argument `tangential_force` of the methods is the force amplitude F_x in N, 0 <= F_x < mu F_N; `r` and
    `distance` are in m, r >= 0 and distance >= 0. A distance of the stick radius or more gives the value at the centre.

    Raises:
        ValueError: A concrete field or argument is outside its range. Under `jit` the result is NaN there. Or a length
            and a force look swapped: all lengths are more than ten times the radius of the indenter in m, and all
            forces, as numbers, less than this radius.

    Example:
        >>> import jax
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> print(f"{contact.contact_radius():.3e} m")
        6.770e-05 m
        >>> slope = jax.grad(lambda contact: contact.wear_volume(2.0))(contact)
        >>> print(slope.normal_force < 0)  # a larger normal force wears less
        True
    """

    material: Any  # a PowerLawGraded or a DepthGraded
    radius: ArrayLike
    normal_force: ArrayLike
    friction: ArrayLike
    indenter: "Elastic | None" = None
    shape: "Shape | None" = None

    def __post_init__(self) -> None:
        check_bodies(self)
        check_fields(self, "radius", "normal_force", "friction")

    @compiled
    def amplitude(self, tangential_force: ArrayLike) -> Array:
        """phi = F_x/(mu F_N), dimensionless, 0 <= phi < 1; from 1 on the whole contact slips."""
        limit = guarded("friction", self.friction, POSITIVE) * guarded("normal_force", self.normal_force, POSITIVE)
        check_real("tangential_force", tangential_force)
        phi = jnp.asarray(tangential_force) / limit
        return guarded("tangential_force/(friction * normal_force)", phi, PARTIAL_SLIP)

    @quantity
    def contact_radius(self, *, digits: int | None = None) -> Array:
        """Initial contact radius a_0 in m, Eq. (12)."""
        material = self.material
        log_stiffness = material.log_stiffness(digits=digits)
        k = jnp.asarray(material.k, log_stiffness.dtype)
        force, radius = guarded("normal_force", self.normal_force, POSITIVE), self._radius()
        log_load = jnp.log(force) + jnp.log(radius) + jnp.log(0.25 * (3.0 + k))
        # Stored, or XLA would compute it again for every result that it scales.
        return stored(jnp.exp((log_load - log_stiffness) / (3.0 + k)), k)

    @quantity
    def stick_radius(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Stick radius c in m, Eqs. (16) and (23)."""
        phi = self.amplitude(tangential_force)
        return self.contact_radius(digits=digits) * fretting.stick_radius(self.material.k, phi, digits=digits)

    @quantity
    def worn_radius(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Outer radius a_inf of the worn ring in m, Eq. (26)."""
        phi = self.amplitude(tangential_force)
        return self.contact_radius(digits=digits) * fretting.worn_radius(self.material.k, phi, digits=digits)

    @quantity
    def penetration(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Penetration d_inf in m in the steady state, Eqs. (11) and (25); d_0 of Eq. (11) for tangential_force = 0."""
        a_0 = self.contact_radius(digits=digits)
        phi = self.amplitude(tangential_force)
        return self._height(a_0) * fretting.penetration(self.material.k, phi, digits=digits)

    @quantity
    def wear_volume(
        self,
        tangential_force: ArrayLike,
        *,
        cycles: ArrayLike | None = None,
        wear_coefficient: ArrayLike | None = None,
        control: str = "force",
        rig_stiffness: ArrayLike | None = None,
        digits: int | None = None,
    ) -> Array:
        """Volume in m^3 worn off the indenter until the steady state, Eq. (28), or in so many `cycles`.

        The `wear_coefficient` is Archard's in 1/Pa, which is m^3/(N m): worn volume over normal force and way. What is
        held is by `control` the amplitude of the "force", or of the "displacement" that goes with it before any wear:
        of the rig, if its `rig_stiffness` in N/m is given. Less is worn then, and Eq. (28) is not the end.
        """
        phi = self.amplitude(tangential_force)
        a_0 = self.contact_radius(digits=digits)
        state, n, held = self._state(a_0, cycles, wear_coefficient, control, rig_stiffness, digits)
        return (a_0 * a_0) * self._height(a_0) * state.wear_volume(self.material.k, phi, *n, **held)

    @quantity
    def cycles_to(
        self,
        share: ArrayLike,
        tangential_force: ArrayLike,
        wear_coefficient: ArrayLike,
        *,
        control: str = "force",
        rig_stiffness: ArrayLike | None = None,
        digits: int | None = None,
    ) -> Array:
        """Cycles after which a share of the final volume is worn, 0 <= share < 1; `control` as of `wear_volume`."""
        phi = self.amplitude(tangential_force)
        share = guarded("share", share, SHARE)
        a_0 = self.contact_radius(digits=digits)
        state, n, held = self._state(a_0, 1.0, wear_coefficient, control, rig_stiffness, digits)
        return state.cycles(self.material.k, phi, share, **held) / n[0]

    @quantity
    def deepest_wear(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Largest depth in m worn off the indenter until the steady state, from Eqs. (24) and (25)."""
        a_0 = self.contact_radius(digits=digits)
        phi = self.amplitude(tangential_force)
        return self._height(a_0) * fretting.deepest_wear(self.material.k, phi, digits=digits)

    @quantity
    def edge_pressure(self, distance: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Pressure in Pa in the steady state at a `distance` in m inside the stick edge, r = c - distance, Eq. (17)."""
        a_0 = self.contact_radius(digits=digits)
        phi = self.amplitude(tangential_force)
        relative = guarded("distance", distance, DISTANCE) / a_0
        return self._mean_pressure(a_0) * fretting.edge_pressure(relative, self.material.k, phi, digits=digits)

    @quantity
    def edge_intensity(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Factor in Pa of (2 delta)^((k-1)/2) in the pressure at r = c (1 - delta), Eq. (20)."""
        a_0 = self.contact_radius(digits=digits)
        phi = self.amplitude(tangential_force)
        return self._mean_pressure(a_0) * fretting.edge_intensity(self.material.k, phi, digits=digits)

    @quantity
    def initial_displacement(self, r: ArrayLike, *, digits: int | None = None) -> Array:
        """Normal displacement w_0(r) of the surface in m before any wear, Eq. (14)."""
        a_0 = self.contact_radius(digits=digits)
        relative = self._relative(r, a_0)
        return self._height(a_0) * fretting.initial_displacement(relative, self.material.k, digits=digits)

    @quantity
    def steady_displacement(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Normal displacement w_inf(r) of the surface in m in the steady state, Eq. (24)."""
        a_0 = self.contact_radius(digits=digits)
        relative, phi = self._relative(r, a_0), self.amplitude(tangential_force)
        return self._height(a_0) * fretting.steady_displacement(relative, self.material.k, phi, digits=digits)

    @quantity
    def profile(
        self,
        r: ArrayLike,
        tangential_force: ArrayLike,
        *,
        cycles: ArrayLike | None = None,
        wear_coefficient: ArrayLike | None = None,
        control: str = "force",
        rig_stiffness: ArrayLike | None = None,
        digits: int | None = None,
    ) -> Array:
        """Shape f_inf(r) of the worn indenter in m above its apex, Eq. (25), or after `cycles` as of `wear_volume`."""
        a_0 = self.contact_radius(digits=digits)
        relative, phi = self._relative(r, a_0), self.amplitude(tangential_force)
        state, n, held = self._state(a_0, cycles, wear_coefficient, control, rig_stiffness, digits)
        return self._height(a_0) * state.profile(relative, self.material.k, phi, *n, **held)

    @quantity
    def wear_depth(
        self,
        r: ArrayLike,
        tangential_force: ArrayLike,
        *,
        cycles: ArrayLike | None = None,
        wear_coefficient: ArrayLike | None = None,
        control: str = "force",
        rig_stiffness: ArrayLike | None = None,
        digits: int | None = None,
    ) -> Array:
        """Depth f_inf(r) - f_0(r) in m worn off, from Eqs. (24) and (25), or in `cycles` as of `wear_volume`."""
        a_0 = self.contact_radius(digits=digits)
        relative, phi = self._relative(r, a_0), self.amplitude(tangential_force)
        state, n, held = self._state(a_0, cycles, wear_coefficient, control, rig_stiffness, digits)
        return self._height(a_0) * state.wear_depth(relative, self.material.k, phi, *n, **held)

    @quantity
    def pressure(
        self,
        r: ArrayLike,
        tangential_force: ArrayLike,
        *,
        cycles: ArrayLike | None = None,
        wear_coefficient: ArrayLike | None = None,
        control: str = "force",
        rig_stiffness: ArrayLike | None = None,
        digits: int | None = None,
    ) -> Array:
        """Pressure in Pa after `cycles` as of `wear_volume`; without them `steady_pressure`."""
        if cycles is None:
            return self.steady_pressure(r, tangential_force, digits=digits)
        a_0 = self.contact_radius(digits=digits)
        relative, phi = self._relative(r, a_0), self.amplitude(tangential_force)
        state, n, held = self._state(a_0, cycles, wear_coefficient, control, rig_stiffness, digits)
        return self._mean_pressure(a_0) * state.pressure(relative, self.material.k, phi, *n, **held)

    @quantity
    def initial_pressure(self, r: ArrayLike, *, digits: int | None = None) -> Array:
        """Pressure p_0(r) in Pa before any wear, Eq. (13)."""
        a_0 = self.contact_radius(digits=digits)
        relative = self._relative(r, a_0)
        return self._mean_pressure(a_0) * fretting.initial_pressure(relative, self.material.k, digits=digits)

    @quantity
    def peak_initial_pressure(self, *, digits: int | None = None) -> Array:
        """Largest pressure p_0(0) in Pa before any wear, Eq. (13): for every k it is in the middle."""
        pressure = fretting.initial_pressure(0.0, self.material.k, digits=digits)
        return self._mean_pressure(self.contact_radius(digits=digits)) * pressure

    @quantity
    def steady_pressure(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Pressure p_inf(r) in Pa in the steady state, Eq. (17); infinite at r = c."""
        a_0 = self.contact_radius(digits=digits)
        relative, phi = self._relative(r, a_0), self.amplitude(tangential_force)
        return self._mean_pressure(a_0) * fretting.steady_pressure(relative, self.material.k, phi, digits=digits)

    @quantity
    def steady_traction(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Tangential traction tau_inf(r) in Pa in the steady state, Eq. (19); infinite at r = c."""
        a_0 = self.contact_radius(digits=digits)
        relative, phi = self._relative(r, a_0), self.amplitude(tangential_force)
        traction = fretting.steady_traction(relative, self.material.k, phi, digits=digits)
        return jnp.asarray(self.friction) * self._mean_pressure(a_0) * traction

    @quantity
    def gross_slip_displacement(self, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None) -> Array:
        """Amplitude in m of the tangential displacement at which the unworn contact begins to slip as a whole.

        It is that of bodies far from the contact, or of the rig if its `rig_stiffness` in N/m, in series, is given.
        """
        alone, compliance = self._displacements(rig_stiffness, digits)
        return alone * (1.0 + compliance)

    @quantity
    def displacement_amplitude(
        self,
        tangential_force: ArrayLike,
        *,
        rig_stiffness: ArrayLike | None = None,
        worn: bool = False,
        digits: int | None = None,
    ) -> Array:
        """Amplitude in m of the tangential displacement, unworn or worn to the end; as `gross_slip_displacement`."""
        alone, compliance = self._displacements(rig_stiffness, digits)
        k, phi = self.material.k, self.amplitude(tangential_force)
        if worn:  # mu theta c^2 Lambda/2, by which the punch of the steady state sinks in beyond the parabola
            sunk = fretting.stick_radius(k, phi, digits=digits) ** 2 / ((1.0 - phi) * (1.5 + 0.5 * jnp.asarray(k)))
            return alone * phi * (sunk + compliance)
        return alone * (1.0 + compliance) * partial_slip.displacement_amplitude(k, phi, compliance, digits=digits)

    @quantity
    def tangential_force(
        self, displacement_amplitude: ArrayLike, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None
    ) -> Array:
        """Amplitude F_x in N that moves the unworn contact by a displacement amplitude in m.

        The displacement is below `gross_slip_displacement` for the same `rig_stiffness`.
        """
        alone, compliance = self._displacements(rig_stiffness, digits)
        share = guarded("displacement_amplitude", displacement_amplitude, DISPLACEMENT) / (alone * (1.0 + compliance))
        phi = partial_slip.amplitude(self.material.k, share, compliance, digits=digits)
        return jnp.asarray(self.friction) * jnp.asarray(self.normal_force) * phi

    @quantity
    def slip_amplitude(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Amplitude in m of the slip in the ring c < r < a_0 of the unworn contact; 0 where nothing slips."""
        a_0 = self.contact_radius(digits=digits)
        relative, phi = self._relative(r, a_0), self.amplitude(tangential_force)
        slip = partial_slip.slip_amplitude(relative, self.material.k, phi, digits=digits)
        return self._tangential_height(a_0, digits) * slip

    @quantity
    def energy_per_cycle(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Energy in J that friction takes in a cycle of the unworn contact."""
        a_0 = self.contact_radius(digits=digits)
        phi = self.amplitude(tangential_force)
        force = jnp.asarray(self.friction) * jnp.asarray(self.normal_force)
        energy = partial_slip.energy_per_cycle(self.material.k, phi, digits=digits)
        return force * self._tangential_height(a_0, digits) * energy

    def _state(
        self,
        a_0: Array,
        cycles: ArrayLike | None,
        wear_coefficient: ArrayLike | None,
        control: str,
        rig_stiffness: ArrayLike | None,
        digits: int | None,
    ) -> tuple[ModuleType, tuple[Array, ...], dict[str, Any]]:
        """(The room that knows the worn state, its reduced cycles, its keywords); without `cycles` the steady state."""
        refuse_control(control, cycles is not None, rig_stiffness is not None)
        if cycles is None:
            return fretting, (), {"digits": digits}
        from plgwear_jax import transient  # whose imports few questions need

        n = self._reduced(a_0, cycles, wear_coefficient, digits)
        if control == "force":
            return transient, (n,), {"digits": digits}
        _, compliance = self._displacements(rig_stiffness, digits)
        return transient, (n,), {"digits": digits, "control": control, "compliance": compliance}

    def _reduced(self, a_0: Array, cycles: ArrayLike, wear_coefficient: ArrayLike | None, digits: int | None) -> Array:
        """The reduced cycles n = 4 K mu theta F_N N/(pi a_0^2)."""
        assert wear_coefficient is not None
        number = guarded("cycles", cycles, NUMBER)
        worn = guarded("wear_coefficient", wear_coefficient, POSITIVE) * self._mean_pressure(a_0)
        return 4.0 * jnp.asarray(self.friction) * self.material.tangential_ratio(digits=digits) * worn * number

    def _tangential_height(self, a_0: Array, digits: int | None) -> Array:
        """mu theta a_0^2/R, the unit of tangential displacements."""
        friction = guarded("friction", self.friction, POSITIVE)
        return friction * self.material.tangential_ratio(digits=digits) * self._height(a_0)

    def _displacements(self, rig_stiffness: ArrayLike | None, digits: int | None) -> tuple[Array, Array]:
        """(The displacement in m at which the contact alone begins to slip, by how much more the rig gives way)."""
        a_0 = self.contact_radius(digits=digits)
        alone = self._tangential_height(a_0, digits) / (1.0 + jnp.asarray(self.material.k))
        if rig_stiffness is None:
            return alone, jnp.zeros_like(alone)
        limit = jnp.asarray(self.friction) * jnp.asarray(self.normal_force)
        return alone, limit / (guarded("rig_stiffness", rig_stiffness, POSITIVE) * alone)

    def _height(self, a_0: Array) -> Array:
        """a_0^2/R, the unit of heights."""
        return a_0 * a_0 / self._radius()

    def _mean_pressure(self, a_0: Array) -> Array:
        """F_N/(pi a_0^2), the unit of stresses."""
        return jnp.asarray(self.normal_force) / (jnp.pi * a_0 * a_0)

    def _radius(self) -> Array:
        return guarded("radius", self.radius, POSITIVE)

    def _relative(self, r: ArrayLike, a_0: Array) -> Array:
        return guarded("r", r, RADIUS) / a_0

    def _check(self, **given: ArrayLike) -> None:
        check_arguments(self, **given)
