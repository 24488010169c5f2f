"""The report on all figures, and the contact sheet that shows them on one page."""

import os
from collections.abc import Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from plgwear_jax import plots
from plgwear_jax.figures.claims import PaperFigure
from plgwear_jax.figures.style import AMPLITUDES, COLUMN, DEPTHS, PAGE, PAIRS, STYLE
from plgwear_jax.figures.text_numbers import NUMBERS, numbers
from plgwear_jax.plots.style import page


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure as `plots.save` does, in the style of these figures."""
    with rc_context(STYLE):
        plots.save(figure, path)


def report(figures: Sequence[PaperFigure]) -> str:
    """The statements of the paper about each figure, the results of the library, and the pictures, in Markdown."""
    parts = [
        "# The figures of the paper, from the library",
        "Written by `plgwear figures`. Each statement of the paper is compared with the result of the library; φ is "
        "F_x/(μ F_N). The paper does not say at which z0/a, ν, amplitudes and, in Fig. 9, exponents it draws: Fig. 5 "
        f"is drawn for z0/a = {_listed(DEPTHS)}, Figs. 8 and 10 for φ = {_listed(AMPLITUDES)}, Fig. 9 for |k| = "
        f"{_listed((0.0, *PAIRS))}. Fig. 10 is printed as a second Fig. 9.",
        "![All of them](contact-sheet.png)",
    ]
    for figure in figures:
        claims = figure.check()
        notes = " ".join(str(figure.draw.__doc__).split()).removeprefix(f"{figure.label}: ")
        rows = [(claim.said, claim.found, claim.verdict) for claim in claims]
        parts += [
            f"## {figure.label}: {figure.title}",
            f"![{figure.label}]({figure.stem}.png)",
            f"{notes[0].upper()}{notes[1:]} ([PDF]({figure.stem}.pdf))",
            _table(("The paper", "The library", ""), rows),
        ]
    rows = [
        (asked.where, asked.words, asked.printed or "—", f"{numbers()[name]:.8g}") for name, asked in NUMBERS.items()
    ]
    parts += ["## Numbers", _table(("", "", "The paper", "The library"), rows)]
    return "\n\n".join(parts) + "\n"


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)


def contact_sheet(figures: Sequence[PaperFigure]) -> Figure:
    """All figures next to each other on one page, each with its label."""
    ends, places = [0.0, 0.0], []
    for strip in _strips(figures):
        side = ends.index(min(ends))
        top, ends[side] = ends[side], ends[side] + max(figure.size[1] for figure in strip) + 0.7
        places += [(figure, 2 * side + n, top, ends[side]) for n, figure in enumerate(strip)]
    edges = sorted({edge for _, _, top, bottom in places for edge in (top, bottom)})
    count = 4 if ends[1] else 2
    with rc_context(STYLE):
        sheet = page(0.5 * count * PAGE, edges[-1], "constrained", dpi=110)
        grid = sheet.add_gridspec(len(edges) - 1, count, height_ratios=np.diff(edges))
        for figure, column, top, bottom in places:
            width = 1 if figure.size[0] <= COLUMN else 2
            rows = slice(edges.index(top), edges.index(bottom))
            part = sheet.add_subfigure(grid[rows, column : column + width])
            figure.draw_on(part)
            part.suptitle(figure.label, x=0.01, ha="left", fontsize=10, weight="bold")
    return sheet


def _strips(figures: Sequence[PaperFigure]) -> list[list[PaperFigure]]:
    """The figures in strips: each wide figure alone, narrow figures in pairs."""
    wide = [[figure] for figure in figures if figure.size[0] > COLUMN]
    narrow = sorted(
        (figure for figure in figures if figure.size[0] <= COLUMN), key=lambda figure: figure.size[1] > 10.0
    )
    strips = wide + [narrow[n : n + 2] for n in range(0, len(narrow), 2)]
    order = list(figures)
    return sorted(strips, key=lambda strip: order.index(strip[0]))
