"""What the fields of the contacts and the arguments of their methods may be."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import CYCLES, DISTANCE, RADIUS, SHARE, ArrayLike, Domain, check, guarded
from plgwear_jax._core.leaves import leaf_of, paths_of
from plgwear_jax._core.ranges import FINITE
from plgwear_jax._core.record import guarded_field
from plgwear_jax.loads import AMPLITUDE_OF_DISPLACEMENT, PARTIAL_SLIP
from plgwear_jax.material import DEPTH, PowerLawGraded
from plgwear_jax.shapes.of_contact import shape_of
from plgwear_jax.shapes.shape import Shape

NUMBER = Domain("cycles >= 0 and finite", CYCLES.contains)
_WORN = Domain(">= 0 and finite", CYCLES.contains)

ARGUMENTS = {
    "displacement_amplitude": AMPLITUDE_OF_DISPLACEMENT,
    "r": RADIUS,
    "distance": DISTANCE,
    "x": FINITE,
    **dict.fromkeys(("z", "least", "most"), DEPTH),
    "cycles": NUMBER,
    "share": SHARE,
    "depth": _WORN,
    "volume": _WORN,
}


def check_again(contact: Any) -> None:
    """Check the fields again, since JAX rebuilds records without checks."""
    contact.__post_init__()
    contact.material.__post_init__()
    shape_of(contact).__post_init__()  # pyright: ignore[reportAttributeAccessIssue]
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


def check_arguments(contact: Any, **given: Any) -> None:
    """Check concrete values: the fields again, since JAX rebuilds records without checks, and the arguments."""
    check_again(contact)
    for name, value in given.items():
        if value is not None:
            check(name, value, ARGUMENTS[name])


def own_axes(tree: Any, number: int = 0) -> list[int]:
    """For each of so many leaves, a tree's and those after it, how many axes of its own it has: 1 for a table."""
    own = []
    for (*above, last), _ in jax.tree_util.tree_leaves_with_path(tree):
        tables = getattr(leaf_of(tree, jax.tree_util.keystr(tuple(above))), "tables", ())
        own.append(int(getattr(last, "name", None) in tables))
    return own + [0] * (number - len(own))


def refuse_array(contact: Any) -> None:
    """Refuse an array of contacts."""
    numbers = paths_of(contact)
    for (name, number), own in zip(numbers.items(), own_axes(contact, len(numbers)), strict=True):
        if np.ndim(number) > own:
            raise ValueError(f"contact: {name} of shape {np.shape(number)}: takes one contact, not an array of them")


def amplitude_of(contact: Any, tangential_force: ArrayLike) -> Array:
    """phi = F_x/(mu F_N), dimensionless; NaN from 1 on, where the whole contact slips."""
    limit = guarded_field(contact, "friction") * guarded_field(contact, "normal_force")
    phi = jnp.asarray(tangential_force) / limit
    return guarded("tangential_force/(friction * normal_force)", phi, PARTIAL_SLIP)
