"""The steady state in closed form: the dimensionless functions of `fretting` and `partial_slip` in SI units."""

import functools
import math
from typing import TYPE_CHECKING, Any

import jax.numpy as jnp
from jax import Array

from plgwear_jax import fretting, partial_slip
from plgwear_jax._core.domains import DISTANCE, EXPONENT, POSITIVE, RADIUS, ArrayLike, guarded
from plgwear_jax._core.doubts import own_numbers
from plgwear_jax._core.formula import compiled
from plgwear_jax.loads import AMPLITUDE_OF_DISPLACEMENT, Load
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.special.jacobi import gamma
from plgwear_jax.special.xla import materialised
from plgwear_jax.steady.solution import Steady

if TYPE_CHECKING:
    from plgwear_jax.stresses.field import Pressed


class ClosedSteady(Steady):
    """A rigid parabola on a power law, or two homogeneous bodies, which are a power law with k = 0 and both moduli."""

    def __init__(self, contact: Any, load: Load, digits: int | None = None) -> None:
        super().__init__(contact, load, digits)
        if not load.holds_force:  # later only programs read the force, where numbers are traced
            with own_numbers():  # whoever reads the force hears the doubt
                load.check_at_rest(self._at_rest)

    # --- units ------------------------------------------------------------------------------------------------------

    @property
    def _material(self) -> PowerLawGraded:
        material = self.contact.material
        if isinstance(material, PowerLawGraded):
            return material
        from plgwear_jax.surfaces import in_series  # imported here, since a power law does not need it

        return in_series(material, self.contact.indenter)

    @property
    def k(self) -> ArrayLike:
        """The exponent of the half-space."""
        return self._material.k

    def with_contact_radius(self, contact_radius: Array) -> "ClosedSteady":
        """The same where the contact radius is known: all units follow from it, and E0 and z0 are not read."""
        names = self.numbers, self.words
        given = (tuple(getattr(self, name) for name in these) for these in names)
        numbers, words = given
        return self._unflatten(words, (*numbers, contact_radius))

    @functools.cached_property  # safe under tracing: each program rebuilds this object with its own traced numbers
    def _radius(self) -> Array:
        known = self._solution
        return self.contact_radius if known is None else known

    @property
    def height(self) -> Array:
        """a_0^2/R, the unit of heights."""
        return self._radius * self._radius / guarded("radius", self.contact.radius, POSITIVE)

    @property
    def mean_pressure(self) -> Array:
        """F_N/(pi a_0^2), the unit of stresses."""
        return jnp.asarray(self.contact.normal_force) / (jnp.pi * self._radius * self._radius)

    @property
    def tangential_ratio(self) -> Array:
        """theta, the tangential compliance over the normal one."""
        return self._material.tangential_ratio(digits=self.digits)

    @property
    def _tangential_height(self) -> Array:
        """mu theta a_0^2/R, the unit of tangential displacements."""
        friction = guarded("friction", self.contact.friction, POSITIVE)
        return friction * self.tangential_ratio * self.height

    def _relative(self, r: ArrayLike) -> Array:
        return guarded("r", r, RADIUS) / self._radius

    # --- scalars ----------------------------------------------------------------------------------------------------

    @property
    @compiled
    def contact_radius(self) -> Array:
        contact, material = self.contact, self._material
        log_stiffness = material.log_stiffness(digits=self.digits)
        k = jnp.asarray(material.k, log_stiffness.dtype)
        force, radius = (
            guarded("normal_force", contact.normal_force, POSITIVE),
            guarded("radius", contact.radius, POSITIVE),
        )
        log_load = jnp.log(force) + jnp.log(radius) + jnp.log(0.25 * (3.0 + k))
        # Materialised, or XLA would compute it again for every result that it scales.
        return materialised(jnp.exp((log_load - log_stiffness) / (3.0 + k)), k)

    @property
    @compiled
    def stick_radius(self) -> Array:
        return self._radius * fretting.stick_radius(self.k, self.amplitude, digits=self.digits)

    @property
    @compiled
    def worn_radius(self) -> Array:
        return self._radius * fretting.worn_radius(self.k, self.amplitude, digits=self.digits)

    @property
    @compiled
    def penetration(self) -> Array:
        return self.height * fretting.penetration(self.k, self.amplitude, digits=self.digits)

    @property
    @compiled
    def wear_volume(self) -> Array:
        volume = fretting.wear_volume(self.k, self.amplitude, digits=self.digits)
        return self._radius * self._radius * self.height * volume

    @property
    @compiled
    def deepest_wear(self) -> Array:
        return self.height * fretting.deepest_wear(self.k, self.amplitude, digits=self.digits)

    @property
    @compiled
    def edge_intensity(self) -> Array:
        return self.mean_pressure * fretting.edge_intensity(self.k, self.amplitude, digits=self.digits)

    @property
    @compiled
    def peak_initial_pressure(self) -> Array:
        # For every k the largest pressure is at the centre.
        return self.mean_pressure * fretting.initial_pressure(0.0, self.k, digits=self.digits)

    @property
    @compiled
    def _onset(self) -> Array:
        return self._tangential_height / (1.0 + jnp.asarray(self.k))

    @property
    @compiled
    def _moved(self) -> Array:
        share = partial_slip.displacement_amplitude(self.k, self.amplitude, digits=self.digits)
        return self._onset * share

    @property
    @compiled
    def _worn_moved(self) -> Array:
        # mu theta times c^2 Lambda/2, the depth of the steady-state punch beyond a parabola of the same contact radius
        k, phi = self.k, self.amplitude
        sunk = fretting.stick_radius(k, phi, digits=self.digits) ** 2 / ((1.0 - phi) * (1.5 + 0.5 * jnp.asarray(k)))
        return self._onset * phi * sunk

    @property
    @compiled
    def energy_per_cycle(self) -> Array:
        energy = partial_slip.energy_per_cycle(self.k, self.amplitude, digits=self.digits)
        return self._limiting_friction * self._tangential_height * energy

    @property
    @compiled
    def _energy_ratio(self) -> Array:
        return self._of_each_contact(partial_slip.energy_ratio(self.k, self.amplitude, digits=self.digits))

    @property
    @compiled
    def _aperture(self) -> Array:
        return self._of_each_contact(partial_slip.loop_aperture(self.k, self.amplitude, digits=self.digits))

    @property
    @compiled
    def _onset_energy_ratio(self) -> Array:
        k = guarded("k", self.k, EXPONENT)
        return self._of_each_contact((1.0 + k) / (5.0 + k))

    @property
    @compiled
    def _onset_aperture(self) -> Array:
        k = guarded("k", self.k, EXPONENT)
        return self._of_each_contact(jnp.expm1(math.log(2.0) * (1.0 + k) / (3.0 + k)))

    def _of_each_contact(self, value: Array) -> Array:
        """A value by k and phi alone, in the shape of all contacts and NaN where one is outside its ranges."""
        return value + 0.0 * self._radius

    @property
    def _pressed(self) -> "Pressed":
        from plgwear_jax.stresses.field import Pressed, poisson_ratio_of, samples

        shape = jnp.shape(self._of_each_contact(self.amplitude))
        k, phi, mean = (
            jnp.broadcast_to(x, shape)[..., None] for x in (jnp.asarray(self.k), self.amplitude, self.mean_pressure)
        )
        stick, s = fretting.stick_radius(k, phi, digits=self.digits), 0.5 + 0.5 * k
        inside = samples(self.digits, k.dtype, alone=True)
        # As p = (1 - r^2)^s; what is added is a flat punch, with s - 1.
        unit = mean * gamma(1.0 + s) / gamma(0.5 + s) * math.pi**-0.5 * jnp.exp((s - 0.5) * jnp.log(inside))
        own, share = unit * (1.0 + s) / (0.5 + s) * inside, (1.0 - phi) / (stick * stick)
        flat = phi / (stick * stick) * unit
        nu = poisson_ratio_of(self.contact.material)
        given = self.contact.normal_force, self._radius, stick[..., 0], self.contact.friction, nu
        force, radius, stick, friction, nu = (jnp.broadcast_to(jnp.asarray(x), shape) for x in given)
        return Pressed(force, radius, stick, friction, own, share * own, flat, s[..., 0], nu, (k[..., 0],))

    # --- functions of the radius ------------------------------------------------------------------------------------

    @compiled
    def edge_pressure(self, distance: ArrayLike) -> Array:
        relative = guarded("distance", distance, DISTANCE) / self._radius
        return self.mean_pressure * fretting.edge_pressure(relative, self.k, self.amplitude, digits=self.digits)

    @compiled
    def initial_displacement(self, r: ArrayLike) -> Array:
        return self.height * fretting.initial_displacement(self._relative(r), self.k, digits=self.digits)

    @compiled
    def steady_displacement(self, r: ArrayLike) -> Array:
        at = self._relative(r), self.k, self.amplitude
        return self.height * fretting.steady_displacement(*at, digits=self.digits)

    @compiled
    def profile(self, r: ArrayLike) -> Array:
        return self.height * fretting.profile(self._relative(r), self.k, self.amplitude, digits=self.digits)

    @compiled
    def wear_depth(self, r: ArrayLike) -> Array:
        return self.height * fretting.wear_depth(self._relative(r), self.k, self.amplitude, digits=self.digits)

    @compiled
    def initial_pressure(self, r: ArrayLike) -> Array:
        return self.mean_pressure * fretting.initial_pressure(self._relative(r), self.k, digits=self.digits)

    @compiled
    def pressure(self, r: ArrayLike) -> Array:
        at = self._relative(r), self.k, self.amplitude
        return self.mean_pressure * fretting.steady_pressure(*at, digits=self.digits)

    @compiled
    def traction(self, r: ArrayLike) -> Array:
        traction = fretting.steady_traction(self._relative(r), self.k, self.amplitude, digits=self.digits)
        return jnp.asarray(self.contact.friction) * self.mean_pressure * traction

    @compiled
    def slip_amplitude(self, r: ArrayLike) -> Array:
        slip = partial_slip.slip_amplitude(self._relative(r), self.k, self.amplitude, digits=self.digits)
        return self._tangential_height * slip

    @compiled
    def force_at(self, displacement_amplitude: ArrayLike) -> Array:
        moved = guarded("displacement_amplitude", displacement_amplitude, AMPLITUDE_OF_DISPLACEMENT)
        share = moved / (self._onset * (1.0 + self._rig))
        return self._limiting_friction * partial_slip.amplitude(self.k, share, self._rig, digits=self.digits)

    @property
    @compiled
    def _share_of_contact(self) -> Array:
        return partial_slip.contact_share(self.k, self.amplitude, self._rig, digits=self.digits)

    @property
    def _rig(self) -> Array:
        """X of `partial_slip`: displacement of the rig over that of the contact alone, at gross slip."""
        return self._limiting_friction * self.load.rig_compliance / self._onset
