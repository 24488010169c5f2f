"""The common style of all pictures, of designs and of sweeps: colours, sizes, ticks."""

from collections.abc import Mapping
from typing import Any, Literal

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogFormatterMathtext, LogLocator, MaxNLocator, NullFormatter

from plgwear_jax._core.units import readable
from plgwear_jax.catalogue import entry

# Colours of Okabe and Ito, which everybody can tell apart, and different dashes for grey prints.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")  # blue, orange, green, purple
BEST = {"color": COLOURS[0], "linestyle": "-", "linewidth": 1.4}
REFERENCE = {"color": COLOURS[1], "linestyle": (0, (4, 1.5)), "linewidth": 1.4}
UNWORN = {"color": "k", "linestyle": "-", "linewidth": 0.5, "zorder": 3}  # on top of the others, which mostly coincide
FORBIDDEN = {"color": "0.65", "linestyle": (0, (2, 1.5)), "linewidth": 0.9}
GUIDE = {"linewidth": 0.7, "linestyle": ":", "zorder": 0}
DOT = {"markersize": 5.5, "markeredgewidth": 0.7, "markeredgecolor": "k"}
LABEL_SIZE, TICK_SIZE = 8, 7.5  # points
GPA = 1e9  # Pa, the size of all moduli that are drawn

CENTIMETRE = 1.0 / 2.54


def page(width: float, height: float, layout: Literal["none", "constrained"] = "none", dpi: int = 300) -> Figure:
    """An empty figure, width and height in cm; panels have fixed places where no layout engine may move them."""
    size = width * CENTIMETRE, height * CENTIMETRE
    return Figure(figsize=size, dpi=dpi, layout=layout)  # pyright: ignore[reportArgumentType]


def for_print(axes: Axes) -> None:
    """Ticks inwards on all sides, thin frames."""
    axes.tick_params(which="both", direction="in", top=True, right=True, labelsize=TICK_SIZE)
    for side in axes.spines.values():
        side.set_linewidth(0.6)


def finished(panels: Mapping[str, Axes]) -> None:
    """Format panels as journals want them, each with its name as a title if that is a letter."""
    for name, axes in panels.items():
        if len(name) == 1:
            axes.set_title(f"({name})", loc="left", x=-0.12, y=1.0, fontsize=9, fontweight="bold")
        for_print(axes)


def label_axes(axes: Axes, across: str, upwards: str) -> None:
    """Write labels along the two axes of a panel."""
    axes.set_xlabel(across, fontsize=LABEL_SIZE)
    axes.set_ylabel(upwards, fontsize=LABEL_SIZE)


def mark(axes: Axes, place: float, words: str) -> None:
    """Draw a dotted line upwards at a place along the horizontal axis, with words above the panel."""
    axes.axvline(place, color="0.5", **GUIDE)
    head = axes.get_xaxis_transform()
    axes.text(place, 1.01, words, transform=head, fontsize=LABEL_SIZE, ha="center", va="bottom", color="0.3")


def write_beside(axes: Axes, place: tuple[float, float], words: str, color: str, **alignment: Any) -> None:
    """Write words on a curve, in its colour, on a background that keeps them legible."""
    room = {"facecolor": "w", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    axes.text(*place, words, **({"fontsize": 7, "color": color, "va": "center", "bbox": room} | alignment))


def legend_above(figure: Figure, entries: list[Any], columns: int, size: float = LABEL_SIZE, **spacing: Any) -> None:
    """Draw the legend of a figure in rows above its panels."""
    spacing |= {"loc": "upper center", "ncols": columns, "frameon": False, "fontsize": size}
    figure.legend(handles=entries, **spacing)


def plain_ticks(axis: Axis) -> None:
    """Label at least three ticks of a logarithmic axis, whose limits are set, with plain numbers if they are short."""
    lower, upper = np.sort(axis.get_view_interval())
    plain = lower >= 1e-3 and upper < 2e4
    for locator in (*(LogLocator(subs=digits) for digits in _DIGITS), MaxNLocator(4)):
        ticks = np.asarray(locator.tick_values(lower, upper))
        if np.count_nonzero((lower <= ticks) & (ticks <= upper)) >= 3:
            axis.set_major_locator(locator)
            axis.set_major_formatter(
                FuncFormatter(lambda value, _: f"{value:g}") if plain else LogFormatterMathtext(labelOnlyBase=False)
            )
            axis.set_minor_formatter(NullFormatter())
            return


_DIGITS = ((1.0,), (1.0, 3.0), (1.0, 2.0, 5.0), (1.0, 1.5, 2.0, 3.0, 5.0, 7.0))


def use_style() -> None:
    """Have matplotlib draw your own pictures in the style of those of this library, from now on."""
    matplotlib.rcParams.update(
        {
            "figure.dpi": 144,
            "figure.constrained_layout.use": True,
            "font.size": LABEL_SIZE,
            "axes.titlesize": LABEL_SIZE,
            "xtick.labelsize": TICK_SIZE,
            "ytick.labelsize": TICK_SIZE,
            "legend.fontsize": TICK_SIZE,
            "legend.title_fontsize": TICK_SIZE,
            "lines.linewidth": 1.4,
            "axes.linewidth": 0.6,
            "xtick.direction": "in",
            "ytick.direction": "in",
            "xtick.top": True,
            "ytick.right": True,
            "legend.frameon": False,
        }
    )


def scaled(name: str, size: float, words: str | None = None) -> tuple[float, str]:
    """(The unit by which values of a quantity of the catalogue are divided along an axis, the label of the axis).

    Args:
        name: The quantity.
        size: The largest value, in the SI unit; the axis has the prefix that suits it.
        words: Replaces the name and symbol of the quantity.
    """
    factor, unit = readable(size, entry(name).unit)
    return factor, labelled(words or entry(name).label, unit)


def labelled(words: str, unit_name: str) -> str:
    """Words followed by the unit in brackets, if there is a unit."""
    return f"{words} ({unit_name})" if unit_name else words
