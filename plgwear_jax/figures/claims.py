"""Statements of the paper compared with results of the library, and the list of figures."""

import functools
from collections.abc import Callable, Sequence
from typing import NamedTuple

from matplotlib import rc_context
from matplotlib.figure import Figure, FigureBase

from plgwear_jax.figures.style import STYLE
from plgwear_jax.plots.style import page


class Claim(NamedTuple):
    """A statement of the paper, and the result of the library."""

    said: str
    """In the words of the paper, or nearly."""
    found: str
    """What the library gives, with numbers."""
    verdict: str
    """One of "agrees", "agrees in part", "differs"."""


VERDICTS = ("agrees", "agrees in part", "differs")


class PaperFigure(NamedTuple):
    """A figure or table of the paper, how it is drawn, and how its claims are checked."""

    key: str
    """Key on the command line: "4" for Fig. 4, "table-1", "eq-27"."""
    label: str
    title: str
    size: tuple[float, float]
    """Width and height in cm."""
    draw: Callable[[], Figure]
    draw_on: Callable[[FigureBase], None]
    """Draws the figure on a page, or on a part of a page."""
    check: Callable[[], list[Claim]]

    @property
    def stem(self) -> str:
        """The name of the figure's files without suffix."""
        return f"fig-{int(self.key):02d}" if self.key.isdigit() else self.key


FIGURES: dict[str, PaperFigure] = {}


def verdict(claims: Sequence[Claim]) -> str:
    """The least favourable verdict of several claims."""
    return max((claim.verdict for claim in claims), key=VERDICTS.index)


def whether(agrees: bool, in_part: bool = False) -> str:
    """The verdict on a claim, from whether it agrees and, if not, whether it agrees in part."""
    return "agrees" if agrees else "agrees in part" if in_part else "differs"


def of_paper(
    key: str, label: str, title: str, size: tuple[float, float], check: Callable[[], list[Claim]]
) -> Callable[[Callable[[FigureBase], None]], Callable[[], Figure]]:
    """A decorator that enters a drawing function into `FIGURES`, and returns a function that draws on a new page."""

    def enter(content: Callable[[FigureBase], None]) -> Callable[[], Figure]:
        def draw_on(page: FigureBase) -> None:
            with rc_context(STYLE):
                content(page)

        @functools.wraps(content, assigned=("__module__", "__name__", "__qualname__", "__doc__"), updated=())
        def draw() -> Figure:
            figure = page(*size, "constrained")
            draw_on(figure)
            return figure

        del draw.__wrapped__  # else `draw` would seem to take a page
        FIGURES[key] = PaperFigure(key, label, title, size, draw, draw_on, functools.cache(check))
        return draw

    return enter
