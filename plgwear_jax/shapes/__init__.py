"""The shape of an indenter: its height f(r) above the apex, f(0) = 0, which increases with the radius r.

`FrettingContact(..., shape=...)` takes one of these or an instance of a class with `height(r, radius)`, see `Shape`.
"""

from typing import Any

import jax
import jax.numpy as jnp

from plgwear_jax._core.domains import field_nan_outside

from .powers import Cone, Parabola, PowerShape
from .shape import Outline, Shape
from .splines import Profile, RoundedFlat, TruncatedSphere

__all__ = ["Cone", "Parabola", "PowerShape", "Profile", "RoundedFlat", "Shape", "TruncatedSphere"]


def shape_of(contact: Any) -> Shape:
    """The shape of a contact's indenter: without one it is the parabola."""
    shape = getattr(contact, "shape", None)
    return Parabola() if shape is None else shape


def outline_of(contact: Any) -> Outline:
    """The shape of a contact's indenter with its R."""
    radius = field_nan_outside(contact, "radius")
    shape = jax.tree.map(lambda x: jnp.asarray(x, radius.dtype), shape_of(contact))
    return Outline(shape.guarded(), radius)
