"""The common style of all pictures, of designs, of sweeps and of the paper: colours, lines, labels and pages."""

import functools
from collections.abc import Callable, Iterable
from typing import Any, ParamSpec

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure, FigureBase
from matplotlib.ticker import LogLocator, NullFormatter

from plgwear_jax._core.numbers import concrete_only
from plgwear_jax._core.units import readable
from plgwear_jax.catalogue import entry

# Colours of Okabe and Ito, which everybody can tell apart, and different dashes for grey prints.
COLOURS = BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
DASHED, DOTTED, DASH_DOT = (0, (4, 1.5)), (0, (1, 1.2)), (0, (7, 1.5, 1.2, 1.5))
BEST: dict[str, Any] = {"color": BLUE, "linestyle": "-"}
REFERENCE: dict[str, Any] = {"color": ORANGE, "linestyle": DASHED}
OTHER: dict[str, Any] = {"color": GREEN, "linestyle": DASH_DOT}
UNWORN: dict[str, Any] = {
    "color": "k",
    "linewidth": 0.5,
    "zorder": 3,
}  # above the others, which mostly coincide with it
FORBIDDEN: dict[str, Any] = {"color": "0.65", "linestyle": (0, (2, 1.5)), "linewidth": 0.9, "zorder": 1}
GUIDE: dict[str, Any] = {"color": "0.5", "linewidth": 0.7, "linestyle": ":", "zorder": 0}
DOT: dict[str, Any] = {"markersize": 5.5, "markeredgewidth": 0.7, "markeredgecolor": "k", "zorder": 4}
LABEL_SIZE, TICK_SIZE = 8, 7.5  # points

STYLE: Any = {  # settings of matplotlib
    "font.size": LABEL_SIZE,
    "axes.titlesize": LABEL_SIZE,
    "axes.titlepad": 11.0,
    "axes.linewidth": 0.6,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "xtick.labelsize": TICK_SIZE,
    "ytick.labelsize": TICK_SIZE,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": TICK_SIZE,
    "legend.title_fontsize": TICK_SIZE,
    "legend.handlelength": 2.4,
    "legend.columnspacing": 1.2,
    "pdf.fonttype": 42,
}

_Given = ParamSpec("_Given")


def use_style() -> None:
    """Have matplotlib draw your own pictures in the style of those of this library, from now on."""
    matplotlib.rcParams.update(STYLE | {"figure.dpi": 144, "figure.constrained_layout.use": True})


def picture(draw: Callable[_Given, Figure]) -> Callable[_Given, Figure]:
    """A decorator of functions that draw what the program returns, numbers alone, in the common style."""

    @functools.wraps(draw)
    def drawn(*args: _Given.args, **kwargs: _Given.kwargs) -> Figure:
        with matplotlib.rc_context(STYLE):
            return draw(*args, **kwargs)

    return concrete_only("draw what the program returns")(drawn)


def page(width: float, height: float, layout: Any = "constrained", dpi: int = 300) -> Figure:
    """An empty figure, width and height in cm."""
    return Figure(figsize=(width / 2.54, height / 2.54), dpi=dpi, layout=layout)


def letters(panels: Iterable[Axes], names: Iterable[str] = "") -> None:
    """(a), (b) and so on above the panels, with their names if they have any."""
    named = [*names]
    for n, axes in enumerate(panels):
        axes.set_title(f"({'abcdefghijkl'[n]})   {named[n] if named else ''}".rstrip(), loc="left")


def mark(axes: Axes, place: float, words: str) -> None:
    """Draw a dotted line upwards at a place along the horizontal axis, with words above the panel."""
    axes.axvline(place, **GUIDE)
    axes.text(place, 1.01, words, transform=axes.get_xaxis_transform(), ha="center", va="bottom", color="0.3")


def write_beside(axes: Axes, place: tuple[float, float], words: str, color: str, **alignment: Any) -> None:
    """Write words on a curve, in its colour, on a background that keeps them legible."""
    room = {"facecolor": "w", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    axes.text(*place, words, **({"fontsize": 7, "color": color, "va": "center", "bbox": room} | alignment))


def legend_above(figure: FigureBase, axes: Axes, columns: int) -> None:
    """Draw a legend of what a panel shows in rows above all panels."""
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=columns)


def plain_ticks(axis: Axis) -> None:
    """Stretch an axis, whose limits are set, like the logarithm, with plain numbers if they are short."""
    lower, upper = np.sort(axis.get_view_interval())
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0) if upper < 50.0 * lower else (1.0,)))
    if 1e-3 <= lower < upper < 1e5:
        axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def scaled(name: str, size: float, words: str | None = None) -> tuple[float, str]:
    """(The unit by which values of a quantity of the catalogue are divided along an axis, the label of the axis).

    Args:
        name: The quantity.
        size: The largest value, in the SI unit; the axis has the prefix that suits it.
        words: Replaces the name and symbol of the quantity.
    """
    factor, unit = readable(float(size), entry(name).unit)
    return factor, labelled(words or entry(name).label, unit)


def labelled(words: str, unit: str) -> str:
    """Words followed by the unit in brackets, if there is a unit."""
    return f"{words} ({unit})" if unit else words
