"""The figures and tables of the paper, drawn by the library, with checks of the statements of the paper.

`FIGURES` lists them with the statements of the text that belong to them, and `numbers` computes the numbers of the
text. Needs the extra `plots`, and `jax_enable_x64` for all digits.
"""

from plgwear_jax.plots.figures import section_2, section_3  # noqa: F401  they enter their figures into `FIGURES`
from plgwear_jax.plots.figures.claims import FIGURES, Claim, PaperFigure, verdict
from plgwear_jax.plots.figures.pages import contact_sheet, report
from plgwear_jax.plots.figures.text_numbers import NUMBERS, TextNumber, numbers

__all__ = ["FIGURES", "NUMBERS", "Claim", "PaperFigure", "TextNumber", "contact_sheet", "numbers", "report", "verdict"]
