"""The common style of all pictures, of designs, of sweeps and of the paper: colours, lines, labels and pages."""

import itertools
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib
import numpy as np
from matplotlib import rc_params_from_file
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure, FigureBase
from matplotlib.ticker import AsinhLocator, LogLocator, MaxNLocator, NullFormatter, ScalarFormatter

from plgwear_jax._core.catalogue import entry
from plgwear_jax._core.domains import concrete_only
from plgwear_jax._core.doubts import SMOOTH
from plgwear_jax._core.units import readable, written

Style = dict[str, Any]  # keywords of matplotlib

# Colours of Okabe and Ito, which everybody can tell apart, and different dashes for grey prints.
COLOURS = BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
DASHED, DOTTED, DASH_DOT = (0, (4, 1.5)), (0, (1, 1.2)), (0, (7, 1.5, 1.2, 1.5))
BEST: Style = {"color": BLUE, "linestyle": "-"}
REFERENCE: Style = {"color": ORANGE, "linestyle": DASHED}
OTHER: Style = {"color": GREEN, "linestyle": DASH_DOT}
UNWORN: Style = {"color": "k", "linewidth": 0.5, "zorder": 3}  # above the others, which mostly coincide with it
FORBIDDEN: Style = {"color": "0.65", "linestyle": (0, (2, 1.5)), "linewidth": 0.9, "zorder": 1}
GUIDE: Style = {"color": "0.5", "linewidth": 0.7, "linestyle": ":", "zorder": 0}
DOT: Style = {"markersize": 5.5, "markeredgewidth": 0.7, "markeredgecolor": "k", "zorder": 4}
ROUGHNESS = written(SMOOTH, entry("wear_depth").unit)  # of a ground surface: shallower wear cannot be told from it
STYLE: Any = rc_params_from_file(Path(__file__).with_name("plgwear.mplstyle"), use_default_template=False)

_Given = ParamSpec("_Given")


def use_style() -> None:
    """Have matplotlib draw your own pictures in the style of those of this library, from now on."""
    matplotlib.rcParams.update(STYLE | {"axes.xmargin": 0.05})


def picture(draw: Callable[_Given, Figure]) -> Callable[_Given, Figure]:
    """A decorator of functions that draw what the program returns, numbers alone, in the common style."""
    return concrete_only("draw what the program returns")(matplotlib.rc_context(STYLE)(draw))


def page(width: float, height: float, layout: Any = "constrained", dpi: int = 300) -> Figure:
    """An empty figure, width and height in cm."""
    return Figure(figsize=(width / 2.54, height / 2.54), dpi=dpi, layout=layout)


def letters(panels: Iterable[Axes], names: Iterable[str] = "") -> None:
    """(a), (b) and so on above the panels, with their names if they have any."""
    for letter, axes, name in zip("abcdefghijkl", panels, itertools.chain(names, itertools.repeat("")), strict=False):
        axes.set_title(f"({letter})   {name}".rstrip(), loc="left")


def mark(axes: Axes, place: float, words: str) -> None:
    """Draw a dotted line upwards at a place along the horizontal axis, with words above the panel."""
    axes.axvline(place, **GUIDE)
    axes.text(place, 1.01, words, transform=axes.get_xaxis_transform(), ha="center", va="bottom", color="0.3")


def mark_roughness(axes: Axes, deepest: float) -> bool:
    """Draw the roughness of a ground surface beside depths of wear, unless all are far below it, and set the limits."""
    seen = deepest > 0.2 * SMOOTH
    axes.set_ylim(0.0, 1.15 * max(deepest, SMOOTH * seen))
    if seen:
        own = {"color": "0.4", "linewidth": 0.8, "linestyle": DASH_DOT, "zorder": 1}
        axes.axhline(SMOOTH, label=f"roughness of {ROUGHNESS}", **own)
    return seen


def legend_above(figure: FigureBase, shown: Any, columns: int) -> None:
    """Draw a legend of what a panel, or several, show in rows above all panels."""
    handles = [handle for axes in np.ravel(shown) for handle in axes.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside upper center", ncols=columns)


class _Prefixed(ScalarFormatter):
    """Prints values in SI units in a unit with a prefix."""

    factor = 1.0

    def format_ticks(self, values: Any) -> list[str]:
        return super().format_ticks([value / self.factor for value in values])


def show_units(
    axis: Axis, name: str = "", words: str | None = None, unit: str | None = None, size: float | None = None
) -> None:
    """Label an axis whose values are in SI units and whose limits are set; its ticks have the prefix that suits them.

    Args:
        axis: The axis. One that is logarithmic, or so for both signs, has plain numbers, if they are short, or powers
            of ten.
        name: A quantity of the catalogue, which has words, a symbol and a unit.
        words: Replaces its name and symbol.
        unit: Replaces its unit.
        size: The number that the prefix has to suit; by default the largest limit.
    """
    lower, upper = np.sort(np.abs(axis.get_view_interval()))
    factor, prefixed = readable(size or upper, entry(name).unit if unit is None else unit)
    if axis.get_scale() == "linear" and upper >= 1e4 * factor:  # the prefixes of a volume are nine decades apart
        power = int(np.log10(upper / factor))
        factor, prefixed = factor * 10.0**power, f"$10^{power}$ {prefixed}".rstrip()
    axis.set_label_text(f"{words or entry(name).label} ({prefixed})".removesuffix(" ()"))
    if axis.get_scale() not in ("log", "asinh"):
        formatter = _Prefixed()
        formatter.factor = factor
        axis.set_major_formatter(formatter)
        return
    both = axis.get_scale() == "asinh"  # both signs: powers of ten outside of the linear part, and zero
    lower = getattr(axis.get_transform(), "linear_width", lower)
    short = 1e-3 <= lower / factor < upper / factor < 1e5
    # Powers of ten leave room for few others.
    more = (1.0, 2.0, 3.0, 5.0)[:: 1 if short else 2] if upper < 100.0 * lower else (1.0,)
    locator = LogLocator(subs=more)
    if short and upper < 7.0 * lower:  # of which such an axis would show two or none
        locator = MaxNLocator(6, steps=(1, 2, 2.5, 5, 10))
    axis.set_major_locator(AsinhLocator(lower, numticks=7) if both else locator)

    def number(x: float, _: Any) -> str:
        if short or x == 0.0 or np.isinf(x):
            return axis.get_major_formatter().fix_minus(f"{x / factor:g}")
        digit, power = f"{x / factor:.0e}".split("e")
        return rf"${digit} \times 10^{{{int(power)}}}$".replace(r"1 \times ", "")

    axis.set_major_formatter(number)
    axis.set_minor_formatter(NullFormatter())


def label(axes: Axes, x: str, y: str, words: str | None = None) -> None:
    """Label both axes of a panel by `show_units`, the vertical one with other words if there are any."""
    show_units(axes.xaxis, x)
    show_units(axes.yaxis, y, words)
