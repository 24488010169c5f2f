"""What the paper draws: its exponents and amplitudes with their lines, and the parts of sketches of contacts."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from plgwear_jax.plots.style import BLUE, DASH_DOT, DASHED, DOTTED, GREEN, ORANGE, Style

COLUMN, PAGE = 8.6, 17.8  # widths in cm
EXPONENTS = np.array([-0.5, 0.0, 0.5])
AMPLITUDES = np.array([0.3, 0.6, 0.9])  # the paper shows three and does not say which
DEPTHS = (0.1, 1.0, 10.0)  # z0/a in Fig. 5, which the paper does not state either
PAIRS = np.array([0.2, 0.5, 0.8])  # abs(k) in Fig. 9
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


def sketch(axes: Axes, surface: Any, body: Any, depth: float, top: float, bottom: float) -> None:
    """Draw a rigid body in a half-space whose shade grows with the depth like the modulus, between two heights.

    Both outlines are (radii, z) from the axis outwards, and mirrored. The sketch is to scale, without axes, with lines
    along the unworn surface and along the axis of the contact, down to the depth.
    """
    (x, z), outline = (np.hstack([np.flip(half, 1) * [[-1.0], [1.0]], half]) for half in (surface, body))
    shade, extent = np.sqrt(np.linspace(0.0, 1.0, 256))[:, None], (x[0], x[-1], bottom, z.min())
    axes.imshow(shade, cmap="Blues", vmin=-0.25, vmax=2.2, extent=extent, aspect="auto", zorder=0)
    axes.fill_between(x, z.min(), z, color="w", linewidth=0.0, zorder=1)
    axes.plot(x, z, color=BLUE, zorder=4)
    axes.fill(*outline, facecolor="0.88", edgecolor="k", linewidth=0.9, zorder=3)
    axes.axhline(0.0, linestyle=DOTTED, **_THIN)
    axes.plot([0.0, 0.0], [outline[1].min(), depth], linestyle=DASH_DOT, **_THIN)
    axes.set(xlim=x[[0, -1]], ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()


_Place = tuple[float, float]


def arrow(axes: Axes, start: _Place, end: _Place, words: str, at: _Place, heads: str = "-|>") -> None:
    """An arrow from start to end, or with two heads the length between both, and words at a place."""
    style = {"arrowstyle": heads, "shrinkA": 0.0, "shrinkB": 0.0, "color": "k"}
    axes.annotate("", end, start, arrowprops=style, zorder=6)
    axes.text(*at, words, fontsize=9, ha="center", va="center", zorder=7)
