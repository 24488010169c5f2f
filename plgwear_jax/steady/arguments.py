"""What the fields of the contacts and the arguments of their methods may be."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import FINITE, NOT_NEGATIVE, NUMBER, SHARE, ArrayLike, nan_outside
from plgwear_jax._core.leaves import leaf_of, paths_of
from plgwear_jax.loads import PARTIAL_SLIP

ARGUMENTS = {
    **dict.fromkeys(("displacement_amplitude", "cycles", "depth", "volume"), NUMBER),
    **dict.fromkeys(("r", "distance", "z", "least", "most"), NOT_NEGATIVE),
    "x": FINITE,
    "share": SHARE,
}


def own_axes(tree: Any) -> list[int]:
    """For each leaf of a tree how many axes of its own it has: 1 for a table."""
    own = []
    for (*above, last), _ in jax.tree_util.tree_leaves_with_path(tree):
        tables = getattr(leaf_of(tree, jax.tree_util.keystr(tuple(above))), "tables", ())
        own.append(int(getattr(last, "name", None) in tables))
    return own


def refuse_array(contact: Any) -> None:
    """Refuse an array of contacts."""
    for (name, number), own in zip(paths_of(contact).items(), own_axes(contact), strict=True):
        if np.ndim(number) > own:
            raise ValueError(f"contact: {name} of shape {np.shape(number)}: takes one contact, not an array of them")


def amplitude_of(friction: Array, normal_force: Array, tangential_force: ArrayLike) -> Array:
    """phi = F_x/(mu F_N), dimensionless; NaN from 1 on, where the whole contact slips."""
    phi = jnp.asarray(tangential_force) / (friction * normal_force)
    return nan_outside("tangential_force/(friction * normal_force)", phi, PARTIAL_SLIP)
