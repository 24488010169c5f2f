"""Partial slip in SI units."""

from typing import TYPE_CHECKING, Any

import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import POSITIVE, ArrayLike, Numbers, check_real, guarded
from plgwear_jax._core.doubts import one_question
from plgwear_jax._core.formula import compiled
from plgwear_jax._core.record import record
from plgwear_jax.contact.engines import run_of, steady_of, test_of
from plgwear_jax.steady.arguments import (
    PARTIAL_SLIP,
    check_arguments,
    check_bodies,
    check_displacement,
    check_fields,
    check_life,
    refuse_control,
)
from plgwear_jax.steady.solution import Steady

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plgwear_jax.loads import Block, Displacement, Force
    from plgwear_jax.shapes import Shape
    from plgwear_jax.surfaces import Elastic
    from plgwear_jax.wear.run import Run
    from plgwear_jax.wear_laws import WearLaw


@record
class FrettingContact:
    """A parabolic indenter under a constant normal and an oscillating tangential force: section 3 of the paper.

    The indenter wears, the half-space does not. A power law under a rigid parabola has the paper's closed forms, and so
    have two homogeneous bodies under a parabola, whose plane moduli are combined. Any other contact is solved
    numerically, to 2 to 5 `digits`, by default 4 (one digit is computed as two), and its tangential compliance is
    taken as proportional to the normal one. Over cycles these contacts have 2 to 4 digits. The types of the bodies
    decide, not their values.

    Each method answers one question. For several questions keep the object: `steady` for one amplitude, `over_cycles`
    for the way there.

    Attributes:
        material: The half-space: a `PowerLawGraded`, a `DepthGraded` of any modulus, a `Layered`, or an `Elastic`.
        radius: Radius of curvature R of the indenter, in m, positive.
        normal_force: Normal force F_N in N, positive.
        friction: Coefficient of friction mu, positive.
        indenter: An `Elastic` body; rigid if None.
        shape: A `Shape`; a parabola if None.

    The argument `tangential_force` of the methods is the force amplitude F_x in N, 0 <= F_x < mu F_N; `r` and
    `distance` are in m, r >= 0 and distance >= 0. A distance beyond the stick radius gives the value at the centre.

    Raises:
        ValueError: A concrete field or argument is outside its range. Under `jit` the result is NaN there. Or a length
            and a force look swapped: all lengths are more than ten times the radius of the indenter in m, and all
            forces in N are smaller numbers than this radius.

    Examples:
        >>> import jax
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> print(f"{contact.contact_radius():.3e} m")
        6.770e-05 m
        >>> slope = jax.grad(lambda contact: contact.wear_volume(2.0))(contact)
        >>> print(slope.normal_force < 0)  # a larger normal force wears less
        True

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (11) to (28); other bodies and shapes:
        `docs/explanation/theory.md`, "Elastic indenters and any E(z)".
    """

    material: Any
    radius: Numbers
    normal_force: Numbers
    friction: Numbers
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

    def steady(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Steady:
        """The contact under a force amplitude F_x in N, unworn and worn to its steady state: see `Steady`.

        To get several quantities, read them all from this object: a numerical contact is then solved only once.
        """
        return steady_of(self, tangential_force, digits)

    def over_cycles(
        self,
        load: "ArrayLike | Force | Displacement | Sequence[Block]",
        law: "ArrayLike | WearLaw",
        *,
        digits: int | None = None,
    ) -> "Run":
        """The wear over cycles, from the unworn contact on: see `Run`.

        A constant force amplitude under Archard's law has up to 5 digits. All other tests are marched, to about 2: a
        displacement amplitude, also one beyond the onset of gross slip, blocks of cycles, other wear laws.

        Args:
            load: A constant force amplitude F_x in N, a load of `loads`, or a list of `loads.Block`.
            law: Archard's wear coefficient K in 1/Pa, or a law of `wear_laws`.
            digits: Correct digits wanted of the volume: for a constant force under Archard's law 2 to 5 with closed
                forms and 2 to 4 with numerical contacts, by default 4; for any other test 2. One digit is computed
                as two.
        """
        return test_of(self, load, law, digits)

    def contact_radius(self, *, digits: int | None = None) -> Array:
        """Initial contact radius a_0 in m, Eq. (12)."""
        return self.steady(0.0, digits=digits).contact_radius

    def stick_radius(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Stick radius c in m, Eqs. (16) and (23)."""
        return self.steady(tangential_force, digits=digits).stick_radius

    def worn_radius(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Outer radius a_inf of the worn ring in m, Eq. (26)."""
        return self.steady(tangential_force, digits=digits).worn_radius

    def penetration(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Penetration d_inf in m in the steady state, Eqs. (11) and (25); d_0 of Eq. (11) for tangential_force = 0."""
        return self.steady(tangential_force, digits=digits).penetration

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
        """Volume in m^3 worn off the indenter until the steady state, Eq. (28), or in a number of `cycles`.

        The `wear_coefficient` is Archard's in 1/Pa = m^3/(N m): worn volume per normal force and sliding distance.
        `control` says which amplitude is constant: that of the "force", or that of the "displacement" which this force
        causes before any wear. With a `rig_stiffness` in N/m, it is the displacement at the
        actuator of the rig. Under displacement control less is worn, and Eq. (28) is not the limit.
        """
        check_life(cycles, wear_coefficient)
        if cycles is None or wear_coefficient is None:
            return self._force_alone(tangential_force, control, rig_stiffness, digits).wear_volume
        return run_of(self, tangential_force, wear_coefficient, control, rig_stiffness, digits).volume(cycles)

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
        """Cycles after which a share of the final volume is worn, 0 <= share < 1; `control` as in `wear_volume`."""
        return run_of(self, tangential_force, wear_coefficient, control, rig_stiffness, digits).cycles_to(share)

    def deepest_wear(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Largest depth in m worn off the indenter until the steady state, from Eqs. (24) and (25)."""
        return self.steady(tangential_force, digits=digits).deepest_wear

    def edge_pressure(self, distance: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Pressure in Pa in the steady state at a `distance` in m inside the stick edge, r = c - distance, Eq. (17)."""
        return self.steady(tangential_force, digits=digits).edge_pressure(distance)

    def edge_intensity(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Factor in Pa of (2 delta)^((k-1)/2) in the pressure at r = c (1 - delta), Eq. (20)."""
        return self.steady(tangential_force, digits=digits).edge_intensity

    def initial_displacement(self, r: ArrayLike, *, digits: int | None = None) -> Array:
        """Normal displacement w_0(r) of the surface in m before any wear, Eq. (14)."""
        return self.steady(0.0, digits=digits).initial_displacement(r)

    def steady_displacement(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Normal displacement w_inf(r) of the surface in m in the steady state, Eq. (24)."""
        return self.steady(tangential_force, digits=digits).steady_displacement(r)

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
        """Shape f_inf(r) of the worn indenter in m above its apex, Eq. (25), or after `cycles` as in `wear_volume`."""
        check_life(cycles, wear_coefficient)
        if cycles is None or wear_coefficient is None:
            return self._force_alone(tangential_force, control, rig_stiffness, digits).profile(r)
        return run_of(self, tangential_force, wear_coefficient, control, rig_stiffness, digits).profile(r, cycles)

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
        """Depth f_inf(r) - f_0(r) in m worn off, from Eqs. (24) and (25), or in `cycles` as in `wear_volume`."""
        check_life(cycles, wear_coefficient)
        if cycles is None or wear_coefficient is None:
            return self._force_alone(tangential_force, control, rig_stiffness, digits).wear_depth(r)
        return run_of(self, tangential_force, wear_coefficient, control, rig_stiffness, digits).depth(r, cycles)

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
        """Pressure in Pa in the steady state, as `steady_pressure`, or after `cycles` as in `wear_volume`."""
        check_life(cycles, wear_coefficient)
        if cycles is None or wear_coefficient is None:
            return self._force_alone(tangential_force, control, rig_stiffness, digits).pressure(r)
        return run_of(self, tangential_force, wear_coefficient, control, rig_stiffness, digits).pressure(r, cycles)

    def initial_pressure(self, r: ArrayLike, *, digits: int | None = None) -> Array:
        """Pressure p_0(r) in Pa before any wear, Eq. (13)."""
        return self.steady(0.0, digits=digits).initial_pressure(r)

    def peak_initial_pressure(self, *, digits: int | None = None) -> Array:
        """Largest pressure p_0 in Pa before any wear, Eq. (13)."""
        return self.steady(0.0, digits=digits).peak_initial_pressure

    def steady_pressure(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Pressure p_inf(r) in Pa in the steady state, Eq. (17); infinite at r = c."""
        return self.steady(tangential_force, digits=digits).steady_pressure(r)

    def steady_traction(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Tangential traction tau_inf(r) in Pa in the steady state, Eq. (19); infinite at r = c."""
        return self.steady(tangential_force, digits=digits).steady_traction(r)

    def gross_slip_displacement(self, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None) -> Array:
        """Amplitude in m of the tangential displacement at which the unworn contact begins to slip as a whole.

        The displacement is measured far from the contact, or, with a `rig_stiffness` in N/m, at
        the actuator of the rig.
        """
        alone = self.steady(0.0, digits=digits).gross_slip_displacement
        if rig_stiffness is None:
            return alone
        self._check(rig_stiffness=rig_stiffness)
        return alone + self._of_rig(jnp.multiply(self.friction, self.normal_force), rig_stiffness)

    def displacement_amplitude(
        self,
        tangential_force: ArrayLike,
        *,
        rig_stiffness: ArrayLike | None = None,
        worn: bool = False,
        digits: int | None = None,
    ) -> Array:
        """Amplitude in m of the tangential displacement, unworn or worn to the end; see `gross_slip_displacement`."""
        steady = self.steady(tangential_force, digits=digits)
        alone = steady.worn_displacement_amplitude if worn else steady.displacement_amplitude
        if rig_stiffness is None:
            return alone
        self._check(rig_stiffness=rig_stiffness)
        return alone + self._of_rig(tangential_force, rig_stiffness)

    @one_question()
    def tangential_force(
        self, displacement_amplitude: ArrayLike, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None
    ) -> Array:
        """Force amplitude F_x in N at which the unworn contact has a displacement amplitude in m.

        The displacement is below `gross_slip_displacement` for the same `rig_stiffness`.
        """
        steady = self.steady(0.0, digits=digits)
        self._check(displacement_amplitude=displacement_amplitude, rig_stiffness=rig_stiffness)
        check_displacement(steady, displacement_amplitude, rig_stiffness)
        return steady.force_at(displacement_amplitude, rig_stiffness)

    def slip_amplitude(self, r: ArrayLike, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Amplitude in m of the slip in the ring c < r < a_0 of the unworn contact; 0 where nothing slips."""
        return self.steady(tangential_force, digits=digits).slip_amplitude(r)

    def energy_per_cycle(self, tangential_force: ArrayLike, *, digits: int | None = None) -> Array:
        """Energy in J that friction dissipates in a cycle of the unworn contact."""
        return self.steady(tangential_force, digits=digits).energy_per_cycle

    def energy_ratio(
        self, tangential_force: ArrayLike, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None
    ) -> Array:
        """Energy of a cycle of the unworn contact over 4 F_x times the displacement amplitude, dimensionless.

        With a `rig_stiffness` in N/m, it is that of the loop at the actuator of the rig.
        """
        steady = self.steady(tangential_force, digits=digits)
        return steady.energy_ratio * self._share(steady, rig_stiffness)

    def loop_aperture(
        self, tangential_force: ArrayLike, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None
    ) -> Array:
        """Displacement of the unworn contact at no force over the displacement amplitude, see `energy_ratio`."""
        steady = self.steady(tangential_force, digits=digits)
        return steady.loop_aperture * self._share(steady, rig_stiffness)

    @one_question()
    def gross_slip_energy_ratio(self, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None) -> Array:
        """The energy ratio at which the unworn contact begins to slip as a whole, (1+k)/(5+k) for a parabola."""
        alone = self.steady(0.0, digits=digits).gross_slip_energy_ratio
        return alone * self._share_at_gross_slip(rig_stiffness, digits)

    @one_question()
    def gross_slip_aperture(self, *, rig_stiffness: ArrayLike | None = None, digits: int | None = None) -> Array:
        """The loop aperture at which the unworn contact begins to slip, 2^((1+k)/(3+k)) - 1 for a parabola."""
        alone = self.steady(0.0, digits=digits).gross_slip_aperture
        return alone * self._share_at_gross_slip(rig_stiffness, digits)

    def _share(self, steady: Steady, rig_stiffness: ArrayLike | None) -> Array | float:
        """The share of the contact in the displacement amplitude of a rig."""
        if rig_stiffness is None:
            return 1.0
        self._check(rig_stiffness=rig_stiffness)
        return steady.contact_share(rig_stiffness)

    def _share_at_gross_slip(self, rig_stiffness: ArrayLike | None, digits: int | None) -> Array | float:
        if rig_stiffness is None:
            return 1.0
        with_rig = self.gross_slip_displacement(rig_stiffness=rig_stiffness, digits=digits)
        return self.gross_slip_displacement(digits=digits) / with_rig

    def _force_alone(
        self, tangential_force: ArrayLike, control: str, rig_stiffness: ArrayLike | None, digits: int | None
    ) -> Steady:
        """The steady state, which is defined for force control only."""
        refuse_control(control, False, rig_stiffness is not None)
        return self.steady(tangential_force, digits=digits)

    def _of_rig(self, force: ArrayLike, rig_stiffness: ArrayLike) -> Array:
        """The displacement of a rig in m under an amplitude of the force."""
        return jnp.asarray(force) / guarded("rig_stiffness", rig_stiffness, POSITIVE)

    def _check(self, **given: ArrayLike | None) -> None:
        check_arguments(self, **given)
