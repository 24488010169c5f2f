"""The figures and tables of the paper, drawn by the library, with checks of the statements of the paper.

`FIGURES` lists them with the statements of the text that belong to them, and `numbers` computes the numbers of the
text. Needs the extra `plots`, and `jax_enable_x64` for all digits.
"""

import inspect
from collections.abc import Sequence

from matplotlib.figure import Figure

from ..style import page, picture
from .drawings import FIGURES
from .paper import NUMBERS, Claim, PaperFigure, TextNumber, numbers, verdict

__all__ = ["FIGURES", "NUMBERS", "Claim", "PaperFigure", "TextNumber", "contact_sheet", "numbers", "report", "verdict"]


def report(figures: Sequence[PaperFigure]) -> str:
    """The statements of the paper about each figure, the results of the library, and the pictures, in Markdown."""
    parts = [
        "# The figures of the paper, from the library",
        "Written by `plgwear figures`. Each statement of the paper is compared with the result of the library; φ is "
        "F_x/(μ F_N). The paper does not say at which z0/a, ν, amplitudes and, in Fig. 9, exponents it draws; below "
        "each figure stands what is drawn here.",
        "![All of them](contact-sheet.png)",
    ]
    for figure in figures:
        claims = [(claim.said, claim.found, claim.verdict) for claim in figure.check()]
        parts += [
            f"## {figure.label}: {figure.title}",
            f"![{figure.label}]({figure.stem}.png)",
            f"{inspect.getdoc(figure.draw_on)} ([PDF]({figure.stem}.pdf))",
            _markdown_table(("The paper", "The library", ""), claims),
        ]
    rows = [
        (asked.where, asked.words, asked.printed or "—", f"{numbers()[name]:.8g}") for name, asked in NUMBERS.items()
    ]
    parts += ["## Numbers", _markdown_table(("", "", "The paper", "The library"), rows)]
    return "\n\n".join(parts) + "\n"


def _markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)


@picture
def contact_sheet(figures: Sequence[PaperFigure]) -> Figure:
    """All figures on one page in their own sizes, each with its label; those of a column stand in pairs."""
    rows: list[list[PaperFigure]] = []
    for figure in figures:
        waiting = [row for row in rows if len(row) * figure.size[0] + row[0].size[0] < 18.0]
        if waiting:
            waiting[0].append(figure)
        else:
            rows.append([figure])
    heights = [max(figure.size[1] for figure in row) + 0.7 for row in rows]
    sheet = page(17.8, sum(heights), dpi=130)
    for part, row in zip(sheet.subfigures(len(rows), 1, height_ratios=heights, squeeze=False).flat, rows, strict=True):
        parts = part.subfigures(1, round(17.8 / row[0].size[0]), squeeze=False)
        for place, figure in zip(parts.flat, row, strict=False):
            figure.draw_on(place)
            place.suptitle(figure.label, x=0.01, ha="left")
    return sheet
