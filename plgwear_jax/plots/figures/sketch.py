"""What the paper draws: its exponents and amplitudes with their lines, and the parts of sketches of contacts."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from plgwear_jax.plots.style import BLUE, DASH_DOT, DASHED, DOTTED, GREEN, ORANGE, Style

COLUMN, PAGE = 8.6, 17.8  # widths in cm
EXPONENTS = (-0.5, 0.0, 0.5)
AMPLITUDES = (0.3, 0.6, 0.9)  # the paper shows three and does not say which
DEPTHS = (0.1, 1.0, 10.0)  # z0/a in Fig. 5, which the paper does not state either
PAIRS = (0.2, 0.5, 0.8)  # abs(k) in Fig. 9
ALMOST = 1.0 - 1e-9

# Orange is k < 0, which is red in the paper, and blue k > 0.
OF_EXPONENT: dict[float, Style] = {
    -0.5: {"color": ORANGE, "linestyle": DASHED},
    0.0: {"color": "k", "linestyle": DASH_DOT, "linewidth": 1.1},
    0.5: {"color": BLUE},
}
OF_AMPLITUDE: dict[float, Style] = {
    phi: {"color": colour, "linestyle": dashes, "label": rf"$F_x/(\mu F_N) = {phi:g}$"}
    for phi, colour, dashes in zip(AMPLITUDES, (GREEN, "#E69F00", "#AA4499"), ("-", DASHED, DASH_DOT), strict=True)
}
WORN: Style = {"facecolor": "#BFDDEE", "edgecolor": BLUE, "hatch": "////", "linewidth": 0.0, "zorder": 3.5}
_THIN: Style = {"color": "0.3", "linewidth": 0.7, "zorder": 5}


def of_k(k: float) -> str:
    """An exponent as a label."""
    return f"$k = {k:g}$"


def sketch(axes: Axes, r: np.ndarray, surface: np.ndarray, body: Any, depth: float, frame: tuple[float, ...]) -> None:
    """Draw a rigid body, a row of points, in a half-space whose shade grows with the depth like the modulus.

    The frame is the width of each side, the top and the bottom. The sketch is to scale, without axes, with lines along
    the unworn surface and along the axis of the contact, down to the depth.
    """
    sides, top, bottom = frame
    x, z = np.concatenate([-r[::-1], r]), np.concatenate([surface[::-1], surface])
    ground = Polygon([*zip(x, z, strict=True), (sides, bottom), (-sides, bottom)], facecolor="none")
    axes.add_patch(ground)
    shade, extent = np.sqrt(np.linspace(0.0, 1.0, 256))[:, None], (-sides, sides, bottom, z.min())
    image = axes.imshow(shade, cmap="Blues", vmin=-0.25, vmax=2.2, extent=extent, aspect="auto", zorder=0)
    image.set_clip_path(ground)
    axes.plot(x, z, color=BLUE, zorder=4)
    axes.add_patch(Polygon(body, facecolor="0.88", edgecolor="k", linewidth=0.9, zorder=3))
    axes.plot([-sides, sides], [0.0, 0.0], linestyle=DOTTED, **_THIN)
    axes.plot([0.0, 0.0], [min(z for _, z in body), depth], linestyle=DASH_DOT, **_THIN)
    axes.set(xlim=(-sides, sides), ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()


def arrow(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], words: Any = "", at: Any = (), heads: str = "-|>"
) -> None:
    """An arrow from start to end, or with two heads the length between both, and words at a place."""
    axes.annotate(
        "", end, start, arrowprops={"arrowstyle": heads, "shrinkA": 0.0, "shrinkB": 0.0, "color": "k"}, zorder=6
    )
    if words:
        axes.text(at[0], at[1], words, fontsize=9, ha="center", va="center", zorder=7)
