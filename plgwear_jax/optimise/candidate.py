"""A choice of the variables: what is minimised there, and how far each limit is broken."""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any, Literal

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting, gross_slip
from plgwear_jax.contact import reduced_cycles
from plgwear_jax.optimise.minimum import Interval
from plgwear_jax.optimise.problem import DEEP, POWERS, SHALLOW, Limits, Question

__all__ = [
    "Candidate",
    "limits_by_name",
    "reference_variables",
    "rows",
    "space",
]


class Candidate:
    """Choices of the variables, scalars or arrays of one shape: their contacts, objective and limits.

    Only what is used is computed.
    """

    def __init__(
        self,
        question: Question,
        variables: Mapping[str, ArrayLike],
        radii: tuple[Array | None, Array] | None = None,  # a_0 with nothing held, and the held a_0, where known
    ) -> None:
        self.question, self.radii = question, radii
        if SHALLOW in variables:
            assert question.depths is not None
            z1, z2 = question.depths
            E1, E2 = variables[SHALLOW], variables[DEEP]
            k = jnp.log(jnp.asarray(E2) / E1) / jnp.log(jnp.asarray(z2) / z1)
            self.changes: dict[str, Any] = {"E0": E1, "z0": z1, "k": k}
        else:
            self.changes = dict(variables)

    @property
    def k(self) -> Any:
        """Their exponents."""
        return self.changes.get("k", self.question.contact.material.k)

    @functools.cached_property
    def contact(self) -> Any:
        """Their contacts, with E0 or z0 adjusted to hold the contact radius."""
        reference, hold = self.question.contact, self.question.hold
        material = dataclasses.replace(reference.material, **self.changes)
        if hold is not None:
            log_lack = self._log_lack(dataclasses.replace(reference, material=material))
            if hold == "contact_radius_by_E0":
                material = dataclasses.replace(material, E0=material.E0 * jnp.exp(log_lack))
            else:
                material = dataclasses.replace(material, z0=material.z0 * jnp.exp(-log_lack / material.k))
        return dataclasses.replace(reference, material=material)

    def _log_lack(self, contact: Any) -> Array:
        """The logarithm of the factor by which the half-space of a contact has to be stiffer for the held radius."""
        # a_0 depends on E0/z0^k alone, Eq. (12).
        free = self.radii[0] if self.radii else None
        free = contact.contact_radius() if free is None else free
        return (3.0 + jnp.asarray(contact.material.k)) * jnp.log(free / self.contact_radius)

    @functools.cached_property
    def contact_radius(self) -> Array:
        """Their initial contact radii a_0 in m."""
        if self.question.hold is None:
            return self.contact.contact_radius()
        return self.radii[1] if self.radii else self.question.contact.contact_radius()

    def objective(self) -> Array:
        """The logarithm of what is minimised, divided by a constant; see `log_unit`."""
        name, k = self.question.objective, self.k
        if name in ("volume_change", "force_drop"):
            return jnp.log(getattr(gross_slip, name)(k))
        assert self.question.load is not None
        if self.question.load.life is None:
            worn = getattr(fretting, name)(jnp.asarray(k)[..., None], self.question.phi)
        else:
            worn = self._worn_by_then()
        wear = jnp.log((self.question.load.weight * worn).sum(-1))
        return wear if self.question.hold is not None else wear + POWERS[name] * jnp.log(self.contact_radius)

    def _worn_by_then(self) -> Array:
        """The volumes worn in the life, along a last axis of the amplitudes."""
        from plgwear_jax import transient  # seldom needed, and takes time

        assert self.question.load is not None
        a_0, material = jnp.asarray(self.contact_radius), self.question.contact.material
        contact = dataclasses.replace(self.question.contact, material=dataclasses.replace(material, k=self.k))
        n = reduced_cycles(contact, self.question.load.life, contact_radius=a_0)
        return transient.wear_volume(jnp.asarray(self.k)[..., None], self.question.phi, n[..., None])

    def log_unit(self) -> ArrayLike:
        """The logarithm of that constant, in SI units."""
        name, contact = self.question.objective, self.question.contact
        if name == "force_drop":
            return 0.0
        radius = jnp.asarray(contact.radius)
        if name == "volume_change":
            return jnp.log(jnp.pi * radius * radius * contact.depth)
        held = POWERS[name] * jnp.log(self.contact_radius) if self.question.hold is not None else 0.0
        return held if name == "worn_radius" else held - jnp.log(radius)

    def states(self) -> dict[str, tuple[Array, ArrayLike, int]]:
        """For each limit the limited value, the limit, and the allowed side: -1 below, +1 above.

        All values that depend on the amplitude rise with it, so they are taken at the largest one.
        """
        limits, found = self.question.limits, {}
        if limits.edge_pressure is not None:
            found["edge_pressure"] = (self.edge_pressure(), limits.edge_pressure, -1)
        lowest, highest = limits.contact_radius or (None, None)
        if lowest is not None:
            found["contact_radius_lowest"] = (self.contact_radius, lowest, 1)
        if highest is not None:
            found["contact_radius_highest"] = (self.contact_radius, highest, -1)
        if limits.penetration is not None:
            found["penetration"] = (self.penetration(), limits.penetration, -1)
        if limits.modulus is not None:
            ends = zip(("shallow", "deep"), limits.modulus.at, limits.modulus.lower, limits.modulus.upper, strict=True)
            for name, depth, lowest, highest in ends:
                modulus = self.contact.material.modulus(depth)
                found[f"{name}_modulus_lowest"] = (modulus, lowest, 1)
                found[f"{name}_modulus_highest"] = (modulus, highest, -1)
        return dict(sorted(found.items()))  # the order that JAX gives a dict as well

    def penetration(self) -> Array:
        """d_inf in m at the largest amplitude."""
        height = self.contact_radius**2 / jnp.asarray(self.question.contact.radius)
        return height * fretting.penetration(self.k, self.question.phi[0])

    def edge_pressure(self) -> Array:
        """p_inf in Pa at the critical distance, at the largest amplitude."""
        a_0, contact = self.contact_radius, self.question.contact
        relative = jnp.asarray(self.question.limits.distance) / a_0
        return (
            jnp.asarray(contact.normal_force)
            / (jnp.pi * a_0 * a_0)
            * fretting.edge_pressure(relative, self.k, self.question.phi[0])
        )

    def excess(self) -> list[Array]:
        """log(value/limit) for each limit, with the sign that is positive where the limit is broken."""
        return [-side * jnp.log(value / bound) for value, bound, side in self.states().values()]


def limits_by_name(limits: Limits) -> dict[str, ArrayLike]:
    """The limits, by the names of `Candidate.states` and in their order."""
    lowest, highest = limits.contact_radius or (None, None)
    named = {
        "edge_pressure": limits.edge_pressure,
        "contact_radius_lowest": lowest,
        "contact_radius_highest": highest,
        "penetration": limits.penetration,
    }
    window = limits.modulus
    if window is not None:
        for name, lowest, highest in zip((SHALLOW, DEEP), window.lower, window.upper, strict=True):
            named |= {f"{name}_lowest": lowest, f"{name}_highest": highest}
    return {name: allowed for name, allowed in sorted(named.items()) if allowed is not None}


def rows(
    question: Question,
    variables: Mapping[str, ArrayLike],
    radii: tuple[Array | None, Array] | None = None,
) -> Array:
    """The logarithm of the objective, over a constant, and the excess of each limit, along a last axis of 1 + m.

    Args:
        question: What is asked.
        variables: Scalars, or arrays of one shape.
        radii: See `Candidate`.
    """
    candidate = Candidate(question, variables, radii)
    told = [candidate.objective(), *candidate.excess()]
    return jnp.stack(jnp.broadcast_arrays(*told), axis=-1)


def reference_variables(question: Question) -> dict[str, ArrayLike]:
    """The values of the variables for the contact as given."""
    material = question.contact.material
    if question.depths is None:
        return {name: getattr(material, name) for name in question.bounds}
    # Eq. (1), for numbers of NumPy as well as for traced ones
    moduli = [material.E0 * (depth / material.z0) ** material.k for depth in question.depths]
    return dict(zip((SHALLOW, DEEP), moduli, strict=True))


def space(question: Question) -> dict[str, Interval]:
    """The box of the variables: moduli and z0 are searched on a logarithmic scale."""
    scales: dict[str, Literal["linear", "logarithmic"]] = {"k": "linear"}
    return {name: Interval(*bounds, scales.get(name, "logarithmic")) for name, bounds in question.bounds.items()}
