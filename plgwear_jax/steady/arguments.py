"""What the fields of the contacts and the arguments of their methods may be."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer

from plgwear_jax._core.domains import (
    AMPLITUDE,
    CYCLES,
    DISTANCE,
    POSITIVE,
    RADIUS,
    SHARE,
    ArrayLike,
    Domain,
    as_array,
    check,
    check_all,
    check_real,
    on_host,
    real_dtype,
)
from plgwear_jax.loads import AMPLITUDE_OF_DISPLACEMENT as DISPLACEMENT
from plgwear_jax.loads import AMPLITUDE_OF_FORCE as FORCE
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.shapes.of_contact import shape_of
from plgwear_jax.shapes.shape import Shape

__all__ = [
    "ARGUMENTS",
    "DISPLACEMENT",
    "FORCE",
    "NUMBER",
    "PARTIAL_SLIP",
    "check_again",
    "check_arguments",
    "check_bodies",
    "check_displacement",
    "check_fields",
    "check_force",
    "check_life",
    "check_power_law",
    "refuse_control",
    "refuse_swapped",
]

PARTIAL_SLIP = Domain("0 <= F_x/(mu F_N) < 1, beyond which the slip is gross", AMPLITUDE.contains)
NUMBER = Domain("cycles >= 0 and finite", CYCLES.contains)
_WORN = Domain(">= 0 and finite", CYCLES.contains)

ARGUMENTS = {
    "r": RADIUS,
    "distance": DISTANCE,
    "displacement_amplitude": DISPLACEMENT,
    "rig_stiffness": POSITIVE,
    "cycles": NUMBER,
    "wear_coefficient": POSITIVE,
    "share": SHARE,
    "depth": _WORN,
    "volume": _WORN,
}


def check_life(cycles: Any, wear_coefficient: Any) -> None:
    """Refuse one of the two without the other."""
    if (cycles is None) != (wear_coefficient is None):
        raise TypeError("cycles and wear_coefficient go together: one needs the other")


def refuse_control(control: str, over_cycles: bool, with_rig: bool) -> None:
    """Refuse displacement control in the steady state, and a rig stiffness under force control."""
    if control == "displacement" and not over_cycles:
        raise TypeError('control = "displacement" needs cycles and wear_coefficient: Eq. (28) assumes force control')
    if with_rig and control == "force":
        raise TypeError('rig_stiffness needs control = "displacement": under force control a rig changes nothing')


def refuse_swapped(name: str, length: ArrayLike, force: ArrayLike, radius: ArrayLike) -> None:
    """Refuse a length and a force that look swapped, if both can be read without waiting for another device."""
    if not all(map(on_host, (length, force, radius))):
        return
    lengths, forces, radii = (np.asarray(value) for value in (length, force, radius))
    if not (lengths.size and forces.size and radii.size):
        return
    if 0.0 < np.max(forces) < np.min(radii) and np.min(lengths) > 10.0 * np.max(radii):
        told = f"{name} = {np.min(lengths)} and tangential_force = {np.max(forces)} look swapped"
        raise ValueError(f"{told}: {name} takes m, tangential_force takes N; the radius is {np.max(radii)} m")


def check_again(contact: Any) -> None:
    """Check the fields again, since JAX rebuilds records without checks."""
    contact.__post_init__()
    contact.material.__post_init__()
    shape_of(contact).__post_init__()
    if getattr(contact, "indenter", None) is not None:
        contact.indenter.__post_init__()


def check_bodies(contact: Any) -> None:
    """Check that there is a solution for this combination of material, indenter and shape."""
    if isinstance(contact.material, PowerLawGraded) and contact.indenter is None and contact.shape is None:
        return
    from plgwear_jax.surfaces.bodies import AnyModulus, Elastic

    if not isinstance(contact.material, PowerLawGraded | AnyModulus | Elastic):
        kinds = "a PowerLawGraded, a DepthGraded, a Layered or an Elastic"
        raise TypeError(f"material takes {kinds}, not {contact.material!r}")
    if not isinstance(contact.indenter, Elastic | None):
        raise TypeError(f"indenter takes an Elastic, or None for a rigid one, not {contact.indenter!r}")
    if not isinstance(shape_of(contact), Shape):
        raise TypeError(f"shape takes a Shape such as PowerShape(4), or None for a parabola, not {contact.shape!r}")


def check_power_law(material: Any) -> None:
    """Check that a material is a power law."""
    if not isinstance(material, PowerLawGraded):
        raise TypeError(f"material takes a PowerLawGraded, not {material!r}")


def check_fields(contact: Any, *names: str) -> None:
    """Check that the named fields are positive."""
    for name in names:
        check(name, getattr(contact, name), POSITIVE)


def check_force(force: ArrayLike, friction: ArrayLike, normal_force: ArrayLike, shares: Domain = PARTIAL_SLIP) -> None:
    """Check that a force amplitude is one of partial slip, as far as the values are concrete."""
    check_real("tangential_force", force)
    values = tuple(map(as_array, (force, friction, normal_force)))
    if any(isinstance(value, Tracer) for value in values):
        return
    if all(map(on_host, values)):  # compiles nothing
        dtype = real_dtype("tangential_force", values)
        values = tuple(np.asarray(value, dtype) for value in values)
    names = "tangential_force", "tangential_force/(friction * normal_force)"
    check_all(names, (values[0], values[0] / (values[1] * values[2])), (FORCE, shares))


def check_arguments(contact: Any, **given: Any) -> None:
    """Check concrete values: the fields again, since JAX rebuilds records without checks, and the arguments."""
    check_again(contact)
    given = {name: as_array(value) for name, value in given.items()}
    for name, value in given.items():
        if name == "tangential_force":
            check_force(value, contact.friction, contact.normal_force)
        elif value is not None:
            check(name, value, ARGUMENTS[name])
    for name in ("r", "distance"):
        if name in given and "tangential_force" in given:
            refuse_swapped(name, given[name], given["tangential_force"], contact.radius)


def check_displacement(steady: Any, displacement: ArrayLike, rig_stiffness: ArrayLike | None) -> None:
    """Refuse a displacement amplitude under which the unworn contact, in series with the rig, slips as a whole."""
    if any(isinstance(value, Tracer) for value in jax.tree.leaves((steady.contact, displacement, rig_stiffness))):
        return
    limit = steady.contact.gross_slip_displacement(rig_stiffness=rig_stiffness, digits=steady.digits)
    where = f"{float(limit):.4g} m, where" if limit.ndim == 0 else "gross_slip_displacement(), where"
    share = jnp.asarray(displacement) / limit
    if not np.all(np.asarray(share) < 1.0):
        text = f"0 <= displacement_amplitude < {where} gross slip begins"
        check("displacement_amplitude", displacement, Domain(text, lambda value: value / limit < 1.0))
