"""The quantities of a scene, computed in one program. Not in `scene`, which has to check a file without JAX."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.catalogue import FRETTING, GROSS_SLIP
from plgwear_jax._core.programs import program
from plgwear_jax.contact import FrettingContact, GrossSlipContact

__all__ = ["evaluate"]


@program(static=3)
def evaluate(
    names: tuple[str, ...],
    points: int,
    digits: int | None,
    contact: FrettingContact | GrossSlipContact,
    tangential_force: float | np.ndarray | None,
    weights: np.ndarray | None,
) -> tuple[Array | None, dict[str, Array]]:
    """The radii, if any quantity needs them, and the named quantities; weighted sums where the load has weights."""
    laws = FRETTING if isinstance(contact, FrettingContact) else GROSS_SLIP
    given: dict[str, Any] = {"r": None, "F_x": tangential_force}
    if any("r" in laws[name].arguments for name in names):
        if isinstance(contact, FrettingContact):
            assert tangential_force is not None
            widest = 1.25 * jnp.max(contact.worn_radius(tangential_force, digits=digits))
        else:
            widest = 2.0 * jnp.asarray(contact.radius)
        given["r"] = widest * jnp.linspace(0.0, 1.0, points)
    values = {
        name: getattr(contact, name)(*(given[argument] for argument in laws[name].arguments), digits=digits)
        for name in names
    }
    if weights is not None:
        of_load = [name for name in names if "F_x" in laws[name].arguments]
        values |= {name: jnp.vdot(weights, values[name]) for name in of_load}
    return given["r"], values
