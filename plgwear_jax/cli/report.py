"""The output of a command: tables and lines for people, with --json one object for programs, and a CSV table.

A command says which rows and columns it has. Words and units of quantities come from the catalogue.
"""

import contextlib
import json
import os
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from plgwear_jax._core import files
from plgwear_jax._core.catalogue import entry, measured
from plgwear_jax._core.units import readable
from plgwear_jax._core.words import one_line

from .terminal import plots, warn, working

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.scene import Scene

_MOST = 40  # rows that are printed of a table that may be long


class Column(NamedTuple):
    """A column of a table.

    Attributes:
        heading: The text above the column.
        cells: Its cells, from top to bottom.
        end: The cell in the last row, below an empty line.
        left: Whether its cells are words, aligned at the left, which may continue in the next line.
        wrap: Whether a long heading may continue in the next line too.
    """

    heading: str
    cells: Sequence[str] = ()
    end: str = ""
    left: bool = False
    wrap: bool = False


def measures(values: Sequence[float], name: str) -> list[str]:
    """Values of one quantity for comparison, all with the prefix of the smallest, unless others become too long."""
    smallest, largest = min(values, key=abs), max(values, key=abs)
    factor, unit = readable(smallest, entry(name).unit)
    if smallest == 0.0 or abs(largest) >= 1e4 * factor:
        return [measured(name, value) for value in values]
    return [f"{value / factor:.4g} {unit}".rstrip() for value in values]


def counted(cycles: float) -> str:
    """A number of cycles in readable form."""
    return f"{cycles:,.0f}" if 10.0 <= cycles < 1e10 else f"{cycles:.3g}"


def about(cycles: float) -> str:
    """A number of cycles to as many digits as a run has."""
    return counted(float(f"{cycles:.3g}"))


def rounded(number: float) -> str:
    """A number without a unit in readable form."""
    return f"{number:.4g}" if abs(number) >= 1e-3 else f"{number:.1e}" if number else "0"


def fields(found: Any, *names: str) -> dict[str, Any]:
    """Some attributes of a result, by name."""
    return {name: getattr(found, name) for name in names}


def each_with_unit(name: str, values: Iterable[float], heading: str | None = None, end: Any = None) -> Column:
    """A column of values of a quantity, NaN for none, each with its own unit, by default below the quantity's words."""
    cells = [measured(name, value) if value == value else "" for value in values]
    return Column(heading or entry(name).words, cells, "" if end is None else measured(name, end))


def shared(name: str, values: "np.ndarray", end: Any = None, heading: str | None = None) -> Column:
    """A column of values of a quantity, all in the unit that suits the largest one and ends the heading.

    Args:
        name: The quantity.
        values: Its values in the SI unit, shape (n,).
        end: Another value, in the last row.
        heading: Replaces the name of the quantity in two lines.
    """
    factor, unit = readable(max(float(values.max()), end or 0.0), entry(name).unit)
    heading = heading or entry(name).name.replace(" ", "\n", 1)
    below = "" if end is None else rounded(end / factor)
    cells = [*map(rounded, (values / factor).tolist())]
    return Column(f"{heading}\n{unit}" if "\n" in heading else f"{heading} ({unit})", cells, below)


def by_rows(headings: Sequence[str], rows: Iterable[Sequence[str]], left: Sequence[int] = (0,)) -> list[Column]:
    """The columns of a table from its rows; `left` are those for words."""
    columns = enumerate(zip(headings, zip(*rows, strict=True), strict=False))  # there may be no rows
    return [Column(heading, cells, "", place in left) for place, (heading, cells) in columns]


def by_quantity(headings: Sequence[str], rows: Mapping[str, Any], words: Mapping[str, str] = {}) -> list[Column]:
    """The columns of a table with a row for each quantity, which compares its values.

    Args:
        headings: Headings of the compared columns, such as "best" and "reference".
        rows: For the name of each quantity a value per heading.
        words: Replacements of the catalogue's words, by the name of the quantity.
    """
    cells = ((words.get(name) or entry(name).words, *measures(values, name)) for name, values in rows.items())
    return by_rows(("", *headings), cells)


class Report:
    """The results of a command: lines and tables, which `end` prints, or with --json one object.

    Args:
        scene_file: The scene, whose name is the title of tables.
        as_json: Whether to print one JSON object instead of words.
        named: The name of the picture, if one will be drawn that has no other.
        read: Files that the command reads, other than those that the scene names.
        targets: The files to be written, if any: a `picture`, a `table` in CSV, and a `scene` in TOML.

    Raises:
        TargetError: One of the files cannot be written, or would replace one that is read.
    """

    def __init__(self, scene_file: Path, as_json: bool, named: str = "", *read: Path, **targets: Path | None) -> None:
        self.scene = str(scene_file)
        self._as_json, self._words = as_json, []
        self._found: dict[str, Any] = {"scene": self.scene}
        self._units = {}
        if named:
            targets["picture"] = targets["picture"] or Path(f"{named}.png")
        self._files = {what: file for what, file in targets.items() if file}
        # What stands in quotation marks, other than in comments, may be a file that it names. A pipe is empty now.
        text = scene_file.read_text("utf-8") if scene_file.is_file() else ""
        quoted = re.findall(r"""#.*|["'](.+?)["']""", text)
        known = {os.path.realpath(one) for one in (scene_file, *read, *map(scene_file.parent.joinpath, quoted))}
        for what, file in self._files.items():
            if os.path.realpath(file) in known:
                raise files.TargetError(f"{file}: is named twice; what is written must not replace what is read")
            files.check_target(file, {"table": (".csv",), "scene": (".toml",)}.get(what, files.PICTURES))

    def put(self, units: Mapping[str, str] = {}, /, **facts: Any) -> None:
        """Add results in SI units to the JSON object; their units are those of the catalogue, or `units`."""
        self._found |= facts
        for name, value in facts.items():
            for one, x in (value if isinstance(value, dict) else {name: value}).items():
                if not isinstance(x, dict | str | None):
                    with contextlib.suppress(KeyError):  # of what the catalogue does not have
                        self._units[one] = entry(one).unit
        self._units |= units

    def say(self, *lines: str | None) -> None:
        """Add lines; those that are None or empty are left out."""
        self._words += filter(None, lines)

    def table(self, *columns: Column, title: str | None = None, more: str = "") -> None:
        """Add a table.

        Args:
            columns: The columns from left to right, all with the same number of cells.
            title: By default the scene; no title if it is empty.
            more: Name of the rows, if only the first ones are to be printed of a long table.
        """
        from rich import box
        from rich.table import Table

        title = one_line(self.scene if title is None else title)
        table = Table(title=title or None, title_justify="left", title_style="bold", box=box.SIMPLE, footer_style="")
        table.show_footer = any(column.end for column in columns)
        for column in columns:
            justify = "left" if column.left else "right"
            lines = "\n".join((column.heading, column.end, *column.cells)).split("\n")
            least = None if column.left or column.wrap else max(map(len, lines))
            table.add_column(column.heading, column.end, justify=justify, min_width=least)
        rows = [*zip(*(column.cells for column in columns), strict=True)]
        for row in rows[: _MOST if more else None]:
            table.add_row(*row)
        self._words.append(table)
        self.say(f"and {len(rows) - _MOST} more {more}" if more and len(rows) > _MOST else None)

    def compare(
        self,
        headings: Mapping[str, str],
        rows: Mapping[str, Any],
        *more: Column,
        words: Mapping[str, str] = {},
    ) -> None:
        """Compare quantities: a table with a row for each, and an object for each side in the JSON object.

        Args:
            headings: The sides by their keys in the JSON object, such as "best".
            rows: For the name of each quantity a value per side.
            more: Further columns of the table.
            words: Replacements of the catalogue's words, by the name of the quantity.
        """
        for side, key in enumerate(headings):
            self.put(**{key: {name: values[side] for name, values in rows.items()}})
        self.table(*by_quantity([*headings.values()], rows, words), *more)

    def doubt(self, given: "Scene", contact_radius: float | None = None, onset: float | None = None) -> None:
        """Warn of values out of proportion, as numbers in wrong units give them; `onset` is that of gross slip in m."""
        from plgwear_jax._core import doubts

        if onset is None and given.load is not None and given.load.of_displacement:
            onset = given.load.moved.gross_slip.max()
        for line in doubts.of_input(given.build_contact(), contact_radius, onset):
            warn(f"{self.scene}: {line}")

    def draw(self, name: str, *found: Any) -> None:
        """Draw the picture by the function of `plots` with this name."""
        with working("drawing it"):
            library = plots()
            library.save(getattr(library, name)(*found), self._files["picture"])

    def write_table(self, columns: "Mapping[str, np.ndarray]") -> None:
        """Write the .csv file, if the command was given one: names of the columns, and rows in SI units."""
        if "table" in self._files:
            files.write_table(self._files["table"], columns)

    def end(self) -> None:
        """Print the words, and the names of the files that were written, or with --json the object."""
        if self._as_json:
            found = self._found | ({"units": self._units} if self._units else {})
            if "picture" in self._files:
                found["picture"] = str(self._files["picture"])
            # A number that is not finite becomes null.
            finite = json.loads(json.dumps(found, default=lambda array: array.tolist()), parse_constant=lambda _: None)
            typer.echo(json.dumps(finite))
            return
        from rich.console import Console

        for one in (*self._words, *(f"{what}: {one_line(str(file))}" for what, file in self._files.items())):
            if isinstance(one, str):
                typer.echo(one)
            else:
                # A narrow terminal breaks lines, and cuts no numbers; text is not interpreted.
                console = Console(width=1000, markup=False, highlight=False, emoji=False)
                console.width = max(80, shutil.get_terminal_size().columns, console.measure(one).minimum)
                console.print(one)
