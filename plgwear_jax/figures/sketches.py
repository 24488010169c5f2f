"""Half-spaces, arrows and panels for sketches of contacts."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from plgwear_jax.figures.style import BLUE

__all__ = [
    "ARROW",
    "BODY",
    "SPAN",
    "bare",
    "draw_arrow",
    "ground",
]


ARROW: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.0, "color": "k", "shrinkA": 0.0, "shrinkB": 0.0}
SPAN: dict[str, Any] = ARROW | {"arrowstyle": "<->", "linewidth": 0.7}
BODY: dict[str, Any] = {"facecolor": "0.88", "edgecolor": "k", "linewidth": 0.9, "zorder": 3}


def ground(axes: Axes, r: np.ndarray, z: np.ndarray, bottom: float) -> None:
    """Draw the half-space below its surface z(r), with a shade that grows with the depth like the modulus."""
    r, z = np.concatenate([-r[::-1], r]), np.concatenate([z[::-1], z])
    body = Polygon([*zip(r, z, strict=True), (r[-1], bottom), (r[0], bottom)], facecolor="none", edgecolor="none")
    axes.add_patch(body)
    shade = np.sqrt(np.linspace(0.0, 1.0, 256))[:, None]
    extent = (r[0], r[-1], bottom, float(z.min()))
    image = axes.imshow(shade, cmap="Blues", vmin=-0.25, vmax=2.2, extent=extent, aspect="auto", zorder=0)
    image.set_clip_path(body)
    axes.plot(r, z, color=BLUE, zorder=4)


def draw_arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], style: dict[str, Any]) -> None:
    """An arrow from start to end."""
    axes.annotate("", end, start, arrowprops=style, zorder=6)


def bare(axes: Axes, sides: float, top: float, bottom: float) -> None:
    """Make a panel a sketch: to scale, without axes."""
    axes.set(xlim=(-sides, sides), ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()
