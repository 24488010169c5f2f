"""Statements of the paper compared with results of the library, and the list of figures."""

import functools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure, FigureBase

from plgwear_jax.plots.style import STYLE, page


class Claim(NamedTuple):
    """A statement of the paper, and the result of the library."""

    said: str
    """In the words of the paper, or nearly."""
    found: str
    """What the library gives, with numbers."""
    agrees: bool
    in_part: bool = False
    """Whether it agrees in part, if not in all."""

    @property
    def verdict(self) -> str:
        """One of "agrees", "agrees in part", "differs"."""
        return "agrees" if self.agrees else "agrees in part" if self.in_part else "differs"


class PaperFigure(NamedTuple):
    """A figure or table of the paper, how it is drawn, and how its claims are checked."""

    key: str
    """Key on the command line: "4" for Fig. 4, "table-1", "eq-27"."""
    label: str
    title: str
    size: tuple[float, float]
    """Width and height in cm."""
    check: Callable[[], list[Claim]]
    draw_on: Callable[[FigureBase], None]
    """Draws the figure on a page, or on a part of a page."""

    def draw(self) -> Figure:
        """The figure on a page of its own."""
        with rc_context(STYLE):
            figure = page(*self.size)
            self.draw_on(figure)
        return figure

    @property
    def stem(self) -> str:
        """The name of the figure's files without suffix."""
        return f"fig-{int(self.key):02d}" if self.key.isdigit() else self.key


FIGURES: dict[str, PaperFigure] = {}
_Drawing = Callable[[FigureBase], None]


def rising(values: np.ndarray, axis: int = 0) -> bool:
    """Whether values rise along an axis."""
    return bool(np.all(np.diff(values, axis=axis) > 0.0))


def verdict(claims: Sequence[Claim]) -> str:
    """The least favourable verdict of several claims."""
    return max((claim.verdict for claim in claims), key=("agrees", "agrees in part", "differs").index)


def of_paper(
    key: str, label: str, title: str, size: tuple[float, float], check: Callable[[], list[Claim]]
) -> Callable[[_Drawing], _Drawing]:
    """A decorator that enters a drawing function into `FIGURES`."""

    def enter(draw_on: _Drawing) -> _Drawing:
        FIGURES[key] = PaperFigure(key, label, title, size, functools.cache(check), draw_on)
        return draw_on

    return enter
