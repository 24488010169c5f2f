"""What the methods of `FrettingContact` refuse."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import Domain, check, check_all, check_real, on_host, real_dtype
from plgwear_jax.contact.arguments import ARGUMENTS, FORCE, PARTIAL_SLIP, check_again, check_life

__all__ = ["check_arguments"]


def check_arguments(contact: Any, **given: Any) -> None:
    """Check concrete values: the fields again, since JAX rebuilds records without checks, and the arguments."""
    check_again(contact)
    if "share" not in given:
        check_life(given.get("cycles"), given.get("wear_coefficient"))
    for name, value in given.items():
        if name == "tangential_force":
            _check_force(contact, value)
        elif value is not None:
            check(name, value, ARGUMENTS[name])
    if "displacement_amplitude" in given:
        _check_displacement(contact, given["displacement_amplitude"], given.get("rig_stiffness"))
    for name in ("r", "distance"):
        if name in given and "tangential_force" in given:
            _refuse_swapped(contact, name, given[name], given["tangential_force"])


def _refuse_swapped(contact: Any, name: str, length: ArrayLike, force: ArrayLike) -> None:
    """Refuse a length and a force that make sense only the other way round, where reading them costs nothing."""
    if not all(map(on_host, (length, force, contact.radius))):
        return
    lengths, forces, radii = (np.asarray(value) for value in (length, force, contact.radius))
    if not (lengths.size and forces.size and radii.size):
        return
    if 0.0 < np.max(forces) < np.min(radii) and np.min(lengths) > 10.0 * np.max(radii):
        told = f"{name} = {np.min(lengths)} and tangential_force = {np.max(forces)} look swapped"
        raise ValueError(f"{told}: {name} takes m, tangential_force takes N; the radius is {np.max(radii)} m")


def _check_displacement(contact: Any, displacement: ArrayLike, rig_stiffness: ArrayLike | None) -> None:
    if any(isinstance(value, Tracer) for value in jax.tree.leaves((contact, displacement, rig_stiffness))):
        return
    limit = contact.gross_slip_displacement(rig_stiffness=rig_stiffness)
    where = f"{float(limit):.4g} m, where" if limit.ndim == 0 else "gross_slip_displacement(), where"
    share = jnp.asarray(displacement) / limit
    if not np.all(np.asarray(share) < 1.0):
        text = f"0 <= displacement_amplitude < {where} gross slip begins"
        check("displacement_amplitude", displacement, Domain(text, lambda value: value / limit < 1.0))


def _check_force(contact: Any, force: ArrayLike) -> None:
    check_real("tangential_force", force)
    values = force, contact.friction, contact.normal_force
    if any(isinstance(value, Tracer) for value in values):
        return
    if all(map(on_host, values)):  # compiles nothing
        dtype = real_dtype("tangential_force", values)
        values = tuple(np.asarray(value, dtype) for value in values)
    names = "tangential_force", "tangential_force/(friction * normal_force)"
    check_all(names, (values[0], values[0] / (values[1] * values[2])), (FORCE, PARTIAL_SLIP))
