"""Shared by the studies: the folder of their pictures, and how numbers are printed."""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import jax
from matplotlib.figure import Figure

from plgwear_jax import plots
from plgwear_jax.plots.style import BLUE, GREEN, ORANGE, legend_above, letters, page, show_units, use_style

__all__ = [
    "BLUE",
    "GREEN",
    "HERE",
    "MARK",
    "NOTE",
    "ORANGE",
    "SCALE",
    "legend_above",
    "letters",
    "page",
    "print_table",
    "run",
    "save",
    "show_units",
]

HERE = Path(__file__).resolve().parent

# For a few values of one quantity, rising; the dashes for grey prints.
SCALE = (("#08306b", "-"), ("#2171b5", (0, (5, 1.5))), ("#41ab5d", (0, (6, 1.5, 1, 1.5))), ("#e08214", (0, (1, 1))))
MARK = {"markeredgecolor": "k", "markeredgewidth": 0.7, "zorder": 5}
NOTE: dict[str, Any] = {"fontsize": 7, "color": "0.25"}


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
    use_style()
    parser = argparse.ArgumentParser(description=sys.modules[main.__module__].__doc__)
    parser.add_argument("--out", type=Path, default=HERE.parent / "docs" / "studies", help="folder of the picture")
    try:
        main(parser.parse_args().out)
    except plots.PictureError as error:
        parser.exit(2, f"{error}\n")
