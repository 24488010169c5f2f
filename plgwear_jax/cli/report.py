"""What a command tells: tables and lines for people, with --json one object for programs, and a CSV table.

A command says which rows and columns it has. Words and units of what the catalogue knows come from there.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from plgwear_jax import _files
from plgwear_jax._core.units import readable, written
from plgwear_jax._core.words import one_line
from plgwear_jax.catalogue import entry
from plgwear_jax.cli.computing import plots
from plgwear_jax.cli.terminal import working

if TYPE_CHECKING:
    import numpy as np

__all__ = [
    "Column",
    "Report",
    "by_quantity",
    "counted",
    "each",
    "fields",
    "measure",
    "measures",
    "rounded",
    "shared",
    "units_of",
]

_MOST = 40  # rows that are printed of a table that may be long


class Column(NamedTuple):
    """A column of a table.

    Attributes:
        heading: What stands above it.
        cells: Its cells, from above.
        end: The cell below the rule that ends the table; None if this column has none.
        left: Whether its cells begin at the left: words, not numbers.
        wrap: Whether words may go on in the next line.
    """

    heading: str
    cells: Sequence[str] = ()
    end: str | None = None
    left: bool = False
    wrap: bool = False


def measure(value: float, name: str) -> str:
    """A value of a quantity of the catalogue with its unit, as a person writes it."""
    return written(value, entry(name).unit)


def measures(values: Sequence[float], name: str) -> list[str]:
    """Values of one quantity for comparison, all with the prefix of the smallest, unless others become too long."""
    smallest, largest = min(values, key=abs), max(values, key=abs)
    factor, unit = readable(smallest, entry(name).unit)
    if smallest == 0.0 or abs(largest) >= 1e4 * factor:
        return [measure(value, name) for value in values]
    return [f"{value / factor:.4g} {unit}".rstrip() for value in values]


def counted(cycles: float) -> str:
    """A number of cycles as a person writes it."""
    return f"{cycles:,.0f}" if 10.0 <= cycles < 1e10 else f"{cycles:.3g}"


def rounded(number: float) -> str:
    """A number without a unit as a person writes it."""
    return f"{number:.4g}" if abs(number) >= 1e-3 else f"{number:.1e}" if number else "0"


def units_of(names: Iterable[str]) -> dict[str, str]:
    """The SI units of quantities of the catalogue, by name."""
    return {name: entry(name).unit for name in names}


def fields(found: Any, *names: str) -> dict[str, Any]:
    """Some attributes of a result, by name."""
    return {name: getattr(found, name) for name in names}


def each(
    name: str, values: Iterable[float], heading: str | None = None, end: float | None = None, wrap: bool = False
) -> Column:
    """A column of values of a quantity, each with a unit of its own; by default under its name."""
    cells = [measure(float(value), name) for value in values]
    return Column(heading or entry(name).name, cells, None if end is None else measure(end, name), wrap=wrap)


def shared(
    name: str,
    values: "np.ndarray",
    heading: str | None = None,
    *,
    end: float | None = None,
    size: float | None = None,
    number: str = "",
) -> Column:
    """A column of values of a quantity, all in the unit that its heading ends with.

    Args:
        name: The quantity.
        values: Its values in the SI unit, shape (n,).
        heading: In place of the name of the quantity, in two lines.
        end: Another value, below the rule.
        size: The number whose prefix the unit takes; by default the largest of all.
        number: How numbers are formatted, such as "+.2g".
    """
    if size is None:
        size = max(float(values.max()), end or 0.0)
    factor, unit = readable(size, entry(name).unit)
    heading = heading or entry(name).name.replace(" ", "\n", 1)
    cells = [f"{value:{number}}" if number else rounded(value) for value in (values / factor).tolist()]
    below = None if end is None else rounded(end / factor)
    return Column(f"{heading}\n{unit}" if "\n" in heading else f"{heading} ({unit})", cells, below)


def by_quantity(
    headings: Sequence[str], rows: Mapping[str, Sequence[float]], words: Mapping[str, str] | None = None
) -> list[Column]:
    """The columns of a table with a row for each quantity, whose values are compared.

    Args:
        headings: What is compared, such as "best" and "reference".
        rows: A value for each heading, by the name of the quantity.
        words: In place of the words of the catalogue, by the name of the quantity.
    """
    cells = [measures(values, name) for name, values in rows.items()]
    named = Column("", [(words or {}).get(name) or entry(name).words for name in rows], left=True, wrap=True)
    return [named, *(Column(heading, [row[i] for row in cells]) for i, heading in enumerate(headings))]


class Report:
    """What a command has found: told at once, or with --json collected for one object.

    Args:
        scene_file: The scene, under whose name the tables stand.
        as_json: Whether one JSON object is wanted in place of words.
        picture: Where a picture will be drawn, if one will be.
        table: A .csv file to be written, if wanted.
        scene: A .toml file to be written, if wanted.

    Raises:
        TargetError: One of the files cannot be written.
    """

    def __init__(
        self,
        scene_file: Path,
        as_json: bool,
        picture: Path | None = None,
        table: Path | None = None,
        scene: Path | None = None,
    ) -> None:
        self.in_words = not as_json
        self._scene = str(scene_file)
        self._found: dict[str, Any] = {"scene": self._scene}
        self._files = {"picture": picture, "table": table, "scene": scene}
        for kind, suffixes in (("picture", _files.PICTURES), ("table", (".csv",)), ("scene", (".toml",))):
            file = self._files[kind]
            if file is not None:
                _files.check_target(file, suffixes)

    def put(self, **facts: Any) -> None:
        """Facts for programs, in SI units."""
        self._found |= facts

    def say(self, *lines: str | None) -> None:
        """Lines for people, without those that are None or empty."""
        for line in lines:
            if line and self.in_words:
                typer.echo(line)

    def table(
        self,
        *columns: Column,
        rows: Iterable[Sequence[str]] | None = None,
        title: str | None = None,
        more: str | None = None,
    ) -> None:
        """A table for people.

        Args:
            columns: From left to right, all with the same number of cells.
            rows: In place of the cells of the columns.
            title: By default the scene; none if it is empty.
            more: What the rows are called, if only the first ones are to be printed.
        """
        if not self.in_words:
            return
        from rich.console import Console
        from rich.table import Table

        title = self._scene if title is None else title
        table = Table(title=one_line(title) or None, title_justify="left", title_style="bold")
        for column in columns:
            justify = "left" if column.left else "right"
            table.add_column(column.heading, justify=justify, no_wrap=not column.wrap)
        rows = list(zip(*(column.cells for column in columns), strict=True) if rows is None else rows)
        for row in rows[: _MOST if more else None]:
            table.add_row(*row)
        if any(column.end is not None for column in columns):
            table.add_section()
            table.add_row(*(column.end or "" for column in columns))
        Console(markup=False, highlight=False, emoji=False).print(table)  # text is not interpreted
        if more and len(rows) > _MOST:
            typer.echo(f"and {len(rows) - _MOST} more {more}")

    def draw(self, name: str, *found: Any) -> None:
        """Draw the picture by the function of `plots` with this name."""
        with working("drawing it"):
            library = plots()
            library.save(getattr(library, name)(*found), self._files["picture"])

    def write_table(self, columns: "Mapping[str, np.ndarray]") -> None:
        """Write the .csv file, if it is wanted: the names of the columns, and their rows in SI units."""
        if self._files["table"] is not None:
            _files.write_table(self._files["table"], columns)

    def end(self) -> None:
        """Name the files that were written; with --json print the object."""
        for kind, file in self._files.items():
            if file is not None:
                self.say(f"{kind}: {one_line(str(file))}")
        if not self.in_words:
            picture = self._files["picture"]
            found = self._found | ({} if picture is None else {"picture": str(picture)})
            typer.echo(json.dumps(_plain(found), allow_nan=False))


def _plain(value: Any) -> Any:
    """The value in the types of JSON; a number that is not finite becomes null."""
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if hasattr(value, "tolist"):  # an array
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
