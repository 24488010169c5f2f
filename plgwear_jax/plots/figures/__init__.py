"""The figures and tables of the paper, drawn by the library, with checks of the statements of the paper.

`FIGURES` lists them with the statements of the text that belong to them, and `numbers` computes the numbers of the
text. Needs the extra `plots`, and `jax_enable_x64` for all digits.
"""

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.figure import Figure

from plgwear_jax.plots.figures import section_2, section_3  # noqa: F401  they enter their figures into `FIGURES`
from plgwear_jax.plots.figures.paper import (
    AMPLITUDES,
    DEPTHS,
    FIGURES,
    NUMBERS,
    PAGE,
    PAIRS,
    Claim,
    PaperFigure,
    TextNumber,
    numbers,
    verdict,
)
from plgwear_jax.plots.style import STYLE, page

__all__ = ["FIGURES", "NUMBERS", "Claim", "PaperFigure", "TextNumber", "contact_sheet", "numbers", "report", "verdict"]


def report(figures: Sequence[PaperFigure]) -> str:
    """The statements of the paper about each figure, the results of the library, and the pictures, in Markdown."""
    depths, amplitudes, pairs = (", ".join(f"{x:g}" for x in row) for row in (DEPTHS, AMPLITUDES, (0.0, *PAIRS)))
    parts = [
        "# The figures of the paper, from the library",
        "Written by `plgwear figures`. Each statement of the paper is compared with the result of the library; φ is "
        "F_x/(μ F_N). The paper does not say at which z0/a, ν, amplitudes and, in Fig. 9, exponents it draws: Fig. 5 "
        f"is drawn for z0/a = {depths}, Figs. 8 and 10 for φ = {amplitudes}, Fig. 9 for |k| = "
        f"{pairs}. Fig. 10 is printed as a second Fig. 9.",
        "![All of them](contact-sheet.png)",
    ]
    for figure in figures:
        claims = figure.check()
        notes = " ".join(str(figure.draw_on.__doc__).split()).removeprefix(f"{figure.label}: ")
        rows = [(claim.said, claim.found, claim.verdict) for claim in claims]
        parts += [
            f"## {figure.label}: {figure.title}",
            f"![{figure.label}]({figure.stem}.png)",
            f"{notes[0].upper()}{notes[1:]} ([PDF]({figure.stem}.pdf))",
            _markdown_table(("The paper", "The library", ""), rows),
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


def contact_sheet(figures: Sequence[PaperFigure]) -> Figure:
    """All figures on one page in their own sizes, each with its label; those of a column stand in pairs."""
    rows: list[list[PaperFigure]] = []
    for figure in figures:
        waiting = [row for row in rows if len(row) == 1 and figure.size[0] == row[0].size[0] < PAGE]
        if waiting:
            waiting[0].append(figure)
        else:
            rows.append([figure])
    heights = [max(figure.size[1] for figure in row) + 0.7 for row in rows]
    with rc_context(STYLE):
        sheet = page(PAGE, sum(heights), dpi=110)
        for part, row in zip(
            sheet.subfigures(len(rows), 1, height_ratios=heights, squeeze=False).flat, rows, strict=True
        ):
            parts = part.subfigures(1, 2 if row[0].size[0] < PAGE else 1, squeeze=False)
            for place, figure in zip(parts.flat, row, strict=False):
                figure.draw_on(place)
                place.suptitle(figure.label, x=0.01, ha="left")
    return sheet
