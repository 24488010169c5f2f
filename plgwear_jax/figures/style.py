"""How the figures of the paper look: settings, line styles, labels, and the parts of sketches of contacts."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from plgwear_jax.plots.style import COLOURS, LABEL_SIZE, TICK_SIZE

COLUMN, PAGE = 8.6, 17.8  # widths in cm

STYLE: Any = {  # settings of Matplotlib
    "font.size": TICK_SIZE,
    "axes.labelsize": LABEL_SIZE,
    "axes.linewidth": 0.6,
    "axes.titlesize": LABEL_SIZE,
    "xtick.labelsize": TICK_SIZE,
    "ytick.labelsize": TICK_SIZE,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "lines.linewidth": 1.3,
    "lines.dash_capstyle": "butt",
    "legend.frameon": False,
    "legend.fontsize": TICK_SIZE,
    "legend.handlelength": 2.8,
    "legend.labelspacing": 0.35,
    "patch.linewidth": 0.6,
    "hatch.linewidth": 0.4,
    "savefig.dpi": "figure",
    "pdf.fonttype": 42,
}

# Colours of Okabe and Ito, and dashes for grey prints. Orange is k < 0, which is red in the paper, and blue k > 0.
BLUE, RED, GREEN, _ = COLOURS
BLACK, ORANGE, PURPLE, SKY = "k", "#E69F00", "#AA4499", "#56B4E9"
SOLID, DASHED, DOTTED = "-", (0, (5, 1.8)), (0, (1, 1.2))
DASH_DOT = (0, (7, 1.5, 1.2, 1.5))
OF_EXPONENT = {
    -0.5: {"color": RED, "linestyle": DASHED},
    0.0: {"color": BLACK, "linestyle": DASH_DOT, "linewidth": 1.1},
    0.5: {"color": BLUE, "linestyle": SOLID},
}
OF_AMPLITUDE = (
    {"color": GREEN, "linestyle": SOLID},
    {"color": ORANGE, "linestyle": DASHED, "linewidth": 1.5},
    {"color": PURPLE, "linestyle": DASH_DOT},
)
THIN: dict[str, Any] = {"color": "0.45", "linewidth": 0.7}
GUIDE: dict[str, Any] = {"color": "0.5", "linewidth": 0.7, "linestyle": DOTTED, "zorder": 1}
NOTE: dict[str, Any] = {"fontsize": TICK_SIZE, "color": "0.15"}

EXPONENTS = (-0.5, 0.0, 0.5)
AMPLITUDES = (0.3, 0.6, 0.9)  # the paper shows three and does not say which
DEPTHS = (0.1, 1.0, 10.0)  # z0/a in Fig. 5, which the paper does not state either
PAIRS = (0.2, 0.5, 0.8)  # abs(k) in Fig. 9
ALMOST = 1.0 - 1e-9

ARROW: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.0, "color": "k", "shrinkA": 0.0, "shrinkB": 0.0}
SPAN: dict[str, Any] = ARROW | {"arrowstyle": "<->", "linewidth": 0.7}
BODY: dict[str, Any] = {"facecolor": "0.88", "edgecolor": "k", "linewidth": 0.9, "zorder": 3}


def letters(panels: Sequence[Axes], names: Sequence[str] = ()) -> None:
    """(a), (b) and so on above the panels, with their names."""
    for n, axes in enumerate(panels):
        words = f"   {names[n]}" if names else ""
        axes.set_title(f"({'abcdef'[n]}){words}", loc="left", pad=3.5)


def of_k(k: float) -> str:
    """An exponent as a label."""
    return f"$k = {k:g}$"


def note(axes: Axes, words: str, place: tuple[float, float], **style: Any) -> None:
    """Words a little above a place."""
    axes.annotate(words, place, (0, 4), textcoords="offset points", ha="center", va="bottom", **style)


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
