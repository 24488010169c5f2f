"""Shared by the studies: the style and folder of their pictures, and how numbers are printed."""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import jax
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from plgwear_jax import plots

__all__ = [
    "COLOURS",
    "HERE",
    "LEGEND",
    "MARK",
    "NOTE",
    "SCALE",
    "finish",
    "page",
    "plain_ticks",
    "print_table",
    "run",
    "save",
]

HERE = Path(__file__).resolve().parent

# Of Okabe and Ito: everybody can tell them apart.
COLOURS = {"blue": "#0072B2", "orange": "#D55E00", "green": "#009E73", "purple": "#CC79A7", "grey": "0.45"}
SCALE = ("#08306b", "#2171b5", "#41ab5d", "#e08214", "#b2182b")  # for a few values of one quantity, rising
LEGEND: dict[str, Any] = {"frameon": False, "fontsize": 7.5, "handlelength": 2.6, "title_fontsize": 7.5}
MARK = {"markeredgecolor": "k", "markeredgewidth": 0.7, "zorder": 5}
NOTE: dict[str, Any] = {"fontsize": 7, "color": "0.25"}
LABEL_SIZE, TICK_SIZE = 8, 7.5  # points


def page(width: float, height: float) -> Figure:
    """An empty figure for print, in centimetres."""
    return Figure(figsize=(width / 2.54, height / 2.54), dpi=300, layout="constrained")


def finish(panels: Sequence[Axes]) -> None:
    """Letters, ticks and lines as journals want them."""
    for letter, axes in zip("abcdefgh", panels, strict=False):
        if len(panels) > 1:
            axes.set_title(f"({letter})", loc="left", fontsize=9, fontweight="bold")
        axes.tick_params(which="both", direction="in", top=True, right=True, labelsize=TICK_SIZE)
        axes.xaxis.label.set_fontsize(LABEL_SIZE)
        axes.yaxis.label.set_fontsize(LABEL_SIZE)
        for side in axes.spines.values():
            side.set_linewidth(0.6)


def plain_ticks(axis: Axis, values: Sequence[float]) -> None:
    """Few plain numbers on a logarithmic axis."""
    axis.set_ticks(values, labels=[f"{value:g}" for value in values])
    axis.set_minor_locator(NullLocator())


def save(figure: Figure, path: Path) -> None:
    """Write a picture, and say where it is."""
    path.parent.mkdir(parents=True, exist_ok=True)
    plots.save(figure, path)
    print(f"picture: {path}")


def print_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A table whose first column is text and whose others are numbers."""
    widths = [max(map(len, column)) for column in zip(columns, *rows, strict=True)]
    for first, *others in (columns, *rows):
        numbers = (cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True))
        print("  ".join((first.ljust(widths[0]), *numbers)))


def run(main: Callable[[Path], None]) -> None:
    """Run a study from the command line, in double precision."""
    jax.config.update("jax_enable_x64", True)
    parser = argparse.ArgumentParser(description=sys.modules[main.__module__].__doc__)
    parser.add_argument("--out", type=Path, default=HERE.parent / "docs" / "studies", help="folder of the picture")
    try:
        main(parser.parse_args().out)
    except plots.PictureError as error:
        parser.exit(2, f"{error}\n")
