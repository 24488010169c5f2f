"""The shape of an indenter: its height f(r) above the apex, f(0) = 0, which increases with the radius r.

`FrettingContact(..., shape=...)` takes one of these or an instance of a class with `height(r, radius)`, see `Shape`.
"""

from plgwear_jax.shapes.powers import Cone, Parabola, PowerShape
from plgwear_jax.shapes.shape import Shape
from plgwear_jax.shapes.splines import Profile, RoundedFlat, TruncatedSphere

__all__ = ["Cone", "Parabola", "PowerShape", "Profile", "RoundedFlat", "Shape", "TruncatedSphere"]
