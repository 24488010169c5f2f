"""Pictures of sweeps for print: curves, and maps with contour lines.

Needs the extras `sweep` and `plots`. A store may hold a map of any size: along each axis only as many values are read
as can be seen.
"""

from plgwear_jax.plots.maps.picture import map_picture
from plgwear_jax.plots.maps.texts import MapError

__all__ = ["MapError", "map_picture"]
