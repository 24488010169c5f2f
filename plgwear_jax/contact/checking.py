"""What the methods of `FrettingContact` refuse."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax._core.domains import Domain, check
from plgwear_jax.contact.arguments import ARGUMENTS, check_again, check_force, check_life, refuse_swapped

__all__ = ["check_arguments"]


def check_arguments(contact: Any, **given: Any) -> None:
    """Check concrete values: the fields again, since JAX rebuilds records without checks, and the arguments."""
    check_again(contact)
    if "share" not in given:
        check_life(given.get("cycles"), given.get("wear_coefficient"))
    for name, value in given.items():
        if name == "tangential_force":
            check_force(value, contact.friction, contact.normal_force)
        elif value is not None:
            check(name, value, ARGUMENTS[name])
    if "displacement_amplitude" in given:
        _check_displacement(contact, given["displacement_amplitude"], given.get("rig_stiffness"))
    for name in ("r", "distance"):
        if name in given and "tangential_force" in given:
            refuse_swapped(name, given[name], given["tangential_force"], contact.radius)


def _check_displacement(contact: Any, displacement: ArrayLike, rig_stiffness: ArrayLike | None) -> None:
    if any(isinstance(value, Tracer) for value in jax.tree.leaves((contact, displacement, rig_stiffness))):
        return
    limit = contact.gross_slip_displacement(rig_stiffness=rig_stiffness)
    where = f"{float(limit):.4g} m, where" if limit.ndim == 0 else "gross_slip_displacement(), where"
    share = jnp.asarray(displacement) / limit
    if not np.all(np.asarray(share) < 1.0):
        text = f"0 <= displacement_amplitude < {where} gross slip begins"
        check("displacement_amplitude", displacement, Domain(text, lambda value: value / limit < 1.0))
