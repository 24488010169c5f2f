"""All that is known of a contact under fretting as its cycles go by, from few programs."""

import dataclasses
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting
from plgwear_jax._core.domains import POSITIVE, check, guarded
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._startup.programs import program
from plgwear_jax.contact.arguments import NUMBER, check_closed, held, is_closed, refuse_control
from plgwear_jax.contact.dispatch import closed_form_of
from plgwear_jax.contact.fretting_contact import FrettingContact

__all__ = ["WearOverCycles", "cycles_to_shares", "reduced_cycles", "volumes_at", "wear_over_cycles"]


@dataclasses.dataclass(frozen=True)
class WearOverCycles:
    """A contact under fretting after some numbers of cycles, in SI units.

    Attributes:
        cycles: The numbers of cycles, shape (n,).
        volume: The worn volume in m^3, shape (n,).
        volume_per_cycle: What the next cycle wears in m^3, shape (n,).
        energy_per_cycle: What friction takes in it in J, shape (n,).
        contact_radius: In m, shape (n,).
        deepest_wear: In m, the largest depth at the radii of the ring that were computed, shape (n,).
        radii: Radii in m, shape (r,): 0 to 1.15 times the worn radius, more of them in the worn ring.
        unworn: The height of the unworn indenter above its apex in m at these radii, shape (r,).
        depth: The worn depth in m there, shape (n, r).
        pressure: The pressure in Pa there, shape (n, r).
        steady_volume: The volume in m^3 worn in the end, Eq. (28).
        stick_radius: The inner edge of the worn ring in m, Eq. (16).
        worn_radius: Its outer edge in the end in m, Eq. (26).
        initial_pressure: p_0 in Pa at the radii before any wear, Eq. (13), shape (r,).
        steady_depth: The depth in m at the radii in the end, Eqs. (24) and (25), shape (r,).
        steady_pressure: The pressure in Pa there in the end, Eq. (17), shape (r,).
    """

    cycles: np.ndarray
    volume: np.ndarray
    volume_per_cycle: np.ndarray
    energy_per_cycle: np.ndarray
    contact_radius: np.ndarray
    deepest_wear: np.ndarray
    radii: np.ndarray
    unworn: np.ndarray
    depth: np.ndarray
    pressure: np.ndarray
    steady_volume: float
    stick_radius: float
    worn_radius: float
    initial_pressure: np.ndarray
    steady_depth: np.ndarray
    steady_pressure: np.ndarray


_INSIDE, _RING, _OUTSIDE = 61, 121, 9  # radii


class _Closed(NamedTuple):
    """The closed forms that are needed, from one program."""

    phi: Any
    n: Any  # the reduced cycles of a cycle
    a_0: Any
    stick_radius: Any
    worn_radius: Any
    volume: Any
    radii: Any
    first_pressure: Any
    depth: Any
    pressure: Any
    compliance: Any


@program(once=True)
def _radii(c: Array, worn: Array) -> Array:
    """Where fields are computed; beside the stick edge all have infinite slopes."""
    inside = c * (1.0 - jnp.linspace(1.0, 0.0, _INSIDE, endpoint=False) ** 4)
    ring = c + (worn - c) * jnp.linspace(0.0, 1.0, _RING) ** 2
    return jnp.concatenate([inside, ring, worn * jnp.linspace(1.0, 1.15, _OUTSIDE)[1:]])


@jax.jit
def _closed(
    contact: FrettingContact, force: Array, wear_coefficient: Array, rig_stiffness: Array | None = None
) -> _Closed:
    k, phi, a_0 = contact.material.k, contact.amplitude(force), contact.contact_radius()
    c, worn = fretting.stick_radius(k, phi), fretting.worn_radius(k, phi)
    r = _radii(c, worn)
    height, mean = contact._height(a_0), contact._mean_pressure(a_0)
    return _Closed(
        phi=phi,
        n=_reduced(contact, wear_coefficient),
        a_0=a_0,
        stick_radius=a_0 * c,
        worn_radius=a_0 * worn,
        volume=a_0 * a_0 * height * fretting.wear_volume(k, phi),
        radii=a_0 * r,
        first_pressure=mean * fretting.initial_pressure(r, k),
        depth=height * fretting.wear_depth(r, k, phi),
        pressure=mean * fretting.steady_pressure(r, k, phi),
        compliance=contact._displacements(rig_stiffness, None)[1],
    )


@jax.jit
def _reduced(contact: FrettingContact, wear_coefficient: Array, contact_radius: Array | None = None) -> Array:
    a_0 = contact.contact_radius() if contact_radius is None else contact_radius
    return contact._reduced(a_0, 1.0, wear_coefficient, None)


def reduced_cycles(
    contact: FrettingContact, wear_coefficient: ArrayLike, *, contact_radius: ArrayLike | None = None
) -> Array:
    """How many of the reduced cycles n of `transient` a cycle of the contact is: 4 K mu theta F_N/(pi a_0^2).

    Args:
        contact: The contact.
        wear_coefficient: Archard's K in 1/Pa, positive.
        contact_radius: a_0 in m, positive, where it is known; by default that of the contact.

    Returns:
        n for one cycle, broadcast over the fields and the coefficient.

    Raises:
        ValueError: The coefficient is outside its range.
    """
    check_closed(contact, "wear over cycles")
    a_0 = None if contact_radius is None else guarded("contact_radius", contact_radius, POSITIVE)
    return _reduced(contact, guarded("wear_coefficient", wear_coefficient, POSITIVE), a_0)


def _asked(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    control: str,
    rig_stiffness: ArrayLike | None,
) -> tuple[_Closed, dict[str, Any]]:
    """(The closed forms, the keywords of `transient`)."""
    given = contact, tangential_force, wear_coefficient, rig_stiffness
    closed = jax.tree.map(np.asarray, _closed(*jax.tree.map(lambda x: jnp.asarray(x, float), given)))
    return closed, held(control, closed.compliance)


def _checked(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    control: str,
    rig_stiffness: ArrayLike | None,
) -> FrettingContact:
    """The contact, in closed form if it has one."""
    refuse_control(control, True, rig_stiffness is not None)
    if not is_closed(contact):
        contact = closed_form_of(contact) or contact
    if rig_stiffness is not None:
        check("rig_stiffness", rig_stiffness, POSITIVE)
    check("wear_coefficient", wear_coefficient, POSITIVE)
    check("tangential_force", tangential_force, POSITIVE)
    contact.amplitude(tangential_force)  # refuses gross slip
    return contact


@for_numbers("contact.cycles_to(shares, F_x, wear_coefficient) works there")
def cycles_to_shares(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    shares: ArrayLike,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> np.ndarray:
    """The cycles after which shares of the final volume are worn, as `FrettingContact.cycles_to`.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Nothing is compiled but what `wear_over_cycles` needs too.
    """
    from plgwear_jax import transient

    contact = _checked(contact, tangential_force, wear_coefficient, control, rig_stiffness)
    if not is_closed(contact):
        keywords = {"control": control, "rig_stiffness": rig_stiffness}
        return np.asarray(contact.cycles_to(shares, tangential_force, wear_coefficient, **keywords))
    closed, keywords = _asked(contact, tangential_force, wear_coefficient, control, rig_stiffness)
    return np.asarray(transient.cycles(contact.material.k, closed.phi, shares, **keywords)) / closed.n


@for_numbers("contact.wear_volume(F_x, cycles=..., wear_coefficient=...) and its sisters work there")
def volumes_at(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    n: np.ndarray,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> tuple[np.ndarray, np.ndarray, float]:
    """The volumes and rates after reduced cycles n = 4 K mu theta F_N N/(pi a_0^2) of one contact.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Returns:
        The volume in m^3 and its slope by n, shape (n,), and what n is after a cycle with a coefficient of 1/Pa.
    """
    from plgwear_jax import transient

    contact = _checked(contact, tangential_force, 1.0, control, rig_stiffness)
    if not is_closed(contact):
        from plgwear_jax.wear.numeric import volumes_at as numeric

        return numeric(contact, tangential_force, n, control, rig_stiffness)
    closed, keywords = _asked(contact, tangential_force, 1.0, control, rig_stiffness)
    unit = closed.a_0**4 / np.asarray(contact.radius)
    found = (f(contact.material.k, closed.phi, n, **keywords) for f in (transient.wear_volume, transient.wear_rate))
    volume, rate = (unit * np.asarray(x) for x in found)
    return volume, rate, float(closed.n)


_END = 1e12  # reduced cycles, by when nothing wears any more


@for_numbers("contact.wear_volume(F_x, cycles=..., wear_coefficient=...) and its sisters work there")
def wear_over_cycles(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    cycles: ArrayLike,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> WearOverCycles:
    """What a table and a picture of the wear over cycles show, at a constant amplitude of force or displacement.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact; its fields are numbers.
        tangential_force: The force amplitude F_x in N, 0 < F_x < mu F_N.
        wear_coefficient: Archard's K in 1/Pa, positive.
        cycles: Numbers of cycles, shape (n,), >= 0 and finite.
        control: What is held, as of `FrettingContact.wear_volume`: at a "displacement" F_x is the amplitude before any
            wear, and what is called steady is the end of that, not Eqs. (17) and (24) to (28).
        rig_stiffness: In N/m, of the rig whose displacement is held.

    Returns:
        Volumes, radii, depths and pressures, to the digits of `FrettingContact.wear_volume`.

    Raises:
        ValueError: An argument is outside its range.
    """
    from plgwear_jax import transient

    check("cycles", cycles, NUMBER)
    cycles = np.asarray(cycles)
    contact = _checked(contact, tangential_force, wear_coefficient, control, rig_stiffness)
    if not is_closed(contact):
        from plgwear_jax.wear.numeric import all_over_cycles

        found = all_over_cycles(contact, tangential_force, wear_coefficient, cycles, _radii, control, rig_stiffness)
        return WearOverCycles(cycles=cycles, **found)
    k = contact.material.k
    closed, keywords = _asked(contact, tangential_force, wear_coefficient, control, rig_stiffness)
    phi, n, a_0 = closed.phi, np.append(closed.n * cycles, _END), closed.a_0
    height, mean = a_0 * a_0 / np.asarray(contact.radius), np.asarray(contact.normal_force) / (np.pi * a_0 * a_0)
    unit, r = a_0 * a_0 * height, closed.radii / a_0
    rate = unit * closed.n * np.maximum(np.asarray(transient.wear_rate(k, phi, n, **keywords)), 0.0)[:-1]
    volume = unit * np.asarray(transient.wear_volume(k, phi, n, **keywords))
    radius = a_0 * np.asarray(transient.contact_radius(k, phi, n, **keywords))
    depth = height * np.asarray(transient.wear_depth(r, k, phi, n[:, None], **keywords))
    pressure = mean * np.asarray(transient.pressure(r, k, phi, n[:, None], **keywords))
    if control == "force":
        end = closed.volume, closed.worn_radius, closed.depth, closed.pressure
    else:
        end = volume[-1], radius[-1], depth[-1], pressure[-1]
    return WearOverCycles(
        cycles=cycles,
        volume=volume[:-1],
        volume_per_cycle=rate,
        energy_per_cycle=rate * np.asarray(contact.friction) / np.asarray(wear_coefficient),
        contact_radius=radius[:-1],
        deepest_wear=depth[:-1].max(axis=-1),
        radii=closed.radii,
        unworn=0.5 * height * r * r,
        depth=depth[:-1],
        pressure=pressure[:-1],
        steady_volume=float(end[0]),
        stick_radius=float(closed.stick_radius),
        worn_radius=float(end[1]),
        initial_pressure=closed.first_pressure,
        steady_depth=end[2],
        steady_pressure=end[3],
    )
