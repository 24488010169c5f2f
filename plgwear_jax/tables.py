r"""Tables of loads, measured wear, moduli, heights and scenarios, read from CSV files and checked by one reader.

Cells are separated by commas, semicolons or tabs; blank lines and comments (lines that start with #) are skipped;
messages name a row by the number of its line in the file, from 1.

A column of lengths, forces, volumes or moduli may name its unit, as "depth (um)", "depth [um]" or "depth_um": m, mm, um
or nm; N, mN, uN, kN or MN; m^3, mm^3, um^3 or nm^3; Pa, kPa, MPa or GPa. Without one its numbers are in SI units.

Examples:
    >>> import pathlib, tempfile
    >>> from plgwear_jax import tables
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "E_of_z.csv"
    >>> _ = file.write_text("depth (um),modulus (GPa)\n0,60\n20,110\n")
    >>> tables.read(file, tables.MODULUS)["depth"]
    array([0.e+00, 2.e-05])
"""

import csv
import dataclasses
import io
import os
import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from plgwear_jax._core import ranges
from plgwear_jax._core.catalogue import leaf
from plgwear_jax._core.ranges import NUMBER, Domain
from plgwear_jax._core.units import scales_of, text_cells
from plgwear_jax._core.words import GivenError, PathGiven, bare, cut, near_or_all, one_line, read_text

__all__ = [
    "HEIGHTS",
    "HISTORY",
    "LOADS",
    "MEASURED",
    "MODULUS",
    "Form",
    "Table",
    "TableError",
    "numbered_lines",
    "read",
    "scenarios",
]


class TableError(GivenError):
    """An error in a table, in one line: file, row, column, value, and what is allowed."""


@dataclasses.dataclass(frozen=True, eq=False)
class Table:
    """The columns of a file: `table["depth"]` is one of them in SI units, shape (n,), n >= 1.

    Attributes:
        name: The file, as it was named, on one line.
        columns: The columns by name.
        row: The line number of each row in the file, shape (n,).
    """

    name: str
    columns: Mapping[str, np.ndarray]
    row: np.ndarray

    def __getitem__(self, column: str) -> np.ndarray:
        if column not in self.columns:
            raise TableError(f"{self.name}: has no column {column}, but {', '.join(self.columns)}")
        return self.columns[column]

    def refuse(self, wrong: np.ndarray | bool, said: Callable[[int], str]) -> None:
        """Raise a TableError for the first row that is wrong; `said` is what is wrong with it, from its place."""
        for place in np.flatnonzero(wrong)[:1].tolist():
            raise TableError(f"{self.name}: row {self.row[place]}: {said(place)}")


class Form(NamedTuple):
    """What a kind of table holds.

    Attributes:
        columns: The columns that it must have; of each inner tuple one.
        optional: Those that it may have; of each inner tuple at most one.
        check: Refuses what is wrong with a table whose cells are allowed one by one.
        domains: Allowed values of columns that this module does not know, in SI units.
    """

    columns: tuple[tuple[str, ...], ...]
    optional: tuple[tuple[str, ...], ...] = ()
    check: Callable[[Table], None] = lambda _: None
    domains: Mapping[str, Domain] = {}

    @property
    def first_row(self) -> str:
        """The row that names the columns."""
        return ",".join(some[0] for some in self.columns)


def read(path: PathGiven, form: Form) -> Table:
    """Read a CSV file, whose columns may stand in any order and name their units.

    Args:
        path: The file, in UTF-8.
        form: Which columns it has: `LOADS`, amplitudes tangential_force in N or displacement in m, and weight, whose
            sum need not be one; `HISTORY`, an amplitude in each row, and if known cycles, normal_force in N and
            friction; `MEASURED`, cycles and volume in m^3, and if known deviation in m^3, or relative_deviation or
            deviation (%) as shares of the volumes; `MODULUS`, depth and modulus, whose numbers without a unit must be
            those of a coating in m and Pa, as volumes have to be those of a test; `HEIGHTS`, r and height, both
            increasing from 0, but for a flat face, without a unit at most 1 m; or what `scenarios` returns.

    Returns:
        The columns in SI units.

    Raises:
        TableError: The file cannot be read, a column or a unit is missing or unknown, or a cell is not allowed; the
            first error is reported, in one line.
    """
    name = one_line(os.fspath(path))
    lines = numbered_lines(read_text(path, "a table is a CSV file", TableError))
    if not lines:
        raise TableError(f"{name}: is empty; it must begin with the row {form.first_row or 'of its columns'}")
    separator = max(",;\t", key=next(iter(lines.values())).count)
    readers, values, row = {}, [], 0
    try:
        for row, line in lines.items():  # noqa: B007 - messages name it
            (cells,) = csv.reader([line], delimiter=separator, skipinitialspace=True, strict=True)
            if not readers:
                readers = _header(cells, form)
            elif len(cells) > len(readers):
                point = _POINT if separator == "," else ""
                raise ValueError(f"has {len(cells)} cells, more than the {len(readers)} of the first row{point}")
            else:
                cells += [""] * len(readers)
                values.append([reader(cell) for reader, cell in zip(readers.values(), cells, strict=False)])
        if not values:
            raise ValueError("names the columns, and no rows follow; there must be at least one")
    except (csv.Error, ValueError) as error:
        said = f"is not valid CSV: {one_line(str(error))}" if isinstance(error, csv.Error) else error
        raise TableError(f"{name}: row {row}: {said}") from None
    columns, numbers = np.array(values).T.copy(), np.array([*lines][1:])
    for array in (columns, numbers):
        array.flags.writeable = False
    found = Table(name, dict(zip(readers, columns, strict=True)), numbers)
    form.check(found)
    return found


# --- kinds of tables --------------------------------------------------------------------------------------------------

_POINT = "; decimals are set off by a point"
_AMPLITUDE = "tangential_force", "displacement"
_RELATIVE = "relative_deviation"


def _some_weight(table: Table) -> None:
    if "weight" in table.columns and not np.any(table["weight"]):
        first, last = table.row[0], table.row[-1]
        rows = f"row {first}" if first == last else f"rows {first} to {last}"
        raise TableError(f"{table.name}: {rows}: weight = 0 throughout; at least one weight must be > 0")


def _increasing(table: Table, columns: tuple[str, ...], needed: str, text: str) -> None:
    """Refuse a single row, and values that do not increase; heights may be level at the beginning."""
    table.refuse(table.row.size < 2, lambda _: f"is the only one; {needed}")
    for column in columns:
        values = table[column]
        level = (values[1:] == 0.0) & (column == "height")
        falls = np.append(False, (np.diff(values) <= 0.0) & ~level)
        table.refuse(falls, lambda i: f"{column} = {values[i]:g} m after {values[i - 1]:g} m: {text}")  # noqa: B023


def _outwards(table: Table) -> None:
    ends = "r", "height"
    _increasing(table, ends, "a profile needs two radii or more", "radii and heights must increase from row to row")
    for column in ends:
        begins = f"{column} = {table[column][0]:g} m: a profile begins with r = 0, height = 0"
        table.refuse(table[column][:1] != 0.0, lambda _, begins=begins: begins)
    if not table["height"][-1]:
        raise TableError(f"{table.name}: row {table.row[-1]}: height = 0 m: the last one must be > 0")


LOADS = Form((_AMPLITUDE, ("weight",)), check=_some_weight)
HISTORY = Form((_AMPLITUDE,), (("cycles",), ("normal_force",), ("friction",)))
MEASURED = Form((("cycles",), ("volume",)), (("deviation", _RELATIVE),))
MODULUS = Form(
    (("depth",), ("modulus",)),
    check=lambda table: _increasing(
        table,
        ("depth",),
        "a graded modulus needs two depths or more",
        "the depths must increase from row to row, from the surface downwards",
    ),
)
HEIGHTS = Form((("r",), ("height",)), check=_outwards)


def scenarios(columns: Mapping[str, Domain]) -> Form:
    """The form of a table of what a contact may turn out to be: numbers of it, and if wanted weight, for `read`.

    Args:
        columns: The columns that it may have, such as "friction" or "indenter.E", and what each allows, in SI units.
    """
    return Form((), (("weight",), *zip(columns)), _some_weight, columns)


# --- columns ----------------------------------------------------------------------------------------------------------

# By column: the SI unit, which is that of a column without one; what is allowed; what it is; and of some the least and
# most that there is in the SI unit, of what, and which unit is meant beyond.
_COLUMNS = {
    column: cells
    for column, *cells in text_cells("""
    tangential_force  N    NUMBER    the amplitude of the force in N
    displacement      m    NUMBER    the amplitude of the displacement in m
    weight            1    NUMBER    -
    cycles            1    NUMBER    -
    normal_force      N    POSITIVE  the normal force in N
    friction          1    POSITIVE  the coefficient of friction
    volume            m^3  NUMBER    the worn volume in m^3       0  10  volume that a test wears  um^3
    deviation         m^3  POSITIVE  the standard deviation of the volume in m^3; leave it out if it is not known
    relative_deviation  share  POSITIVE  the standard deviation over the volume; leave it out if it is not known
    depth             m    NUMBER    the depth below the surface  0    0.1   depth of a coating      um
    modulus           Pa   POSITIVE  Young's modulus              1e3  2e12  modulus of a coating    GPa
    r                 m    NUMBER    the radius                   0    1     radius of an indenter   um
    height            m    NUMBER    the height above the apex    0    1     height of an indenter   um
    """)
}
_UNITS = scales_of("""
    m      m  1    mm  1e-3    um  1e-6    nm  1e-9
    N      N  1    mN  1e-3    uN  1e-6    kN  1e3    MN  1e6
    m^3    m^3  1  mm^3  1e-9  um^3  1e-18  nm^3  1e-27
    Pa     Pa  1   kPa  1e3    MPa  1e6    GPa  1e9
    share  1  1    %  1e-2
""")
_SIGNS = str.maketrans({"\N{MICRO SIGN}": "u", "\N{GREEK SMALL LETTER MU}": "u", "\N{SUPERSCRIPT THREE}": "^3"})


def _units_of(column: str) -> Mapping[str, float]:
    """The units that a column may name, with what each is in the SI unit; none for numbers without a unit."""
    return _UNITS.get(_COLUMNS[column][0] if column in _COLUMNS else leaf(column).unit, {})


# --- reading ----------------------------------------------------------------------------------------------------------


def numbered_lines(text: str) -> dict[int, str]:
    """Each line that is neither blank nor a comment, by its number."""
    lines = enumerate(io.StringIO(text, newline=None), 1)
    return {row: line for row, line in lines if line.lstrip()[:1] not in ("", "#")}


def _header(cells: list[str], form: Form) -> dict[str, Callable[[str], float]]:
    """What reads the cells of each column, in the order of the file; a ValueError says what is wrong."""
    found, alternatives = {}, (*form.columns, *form.optional)
    known = [column for some in alternatives for column in some]
    if all(number_in(cell) is not None for cell in cells):
        raise ValueError(f"holds numbers; the first row must name the columns, {form.first_row}")
    for cell in cells:
        column, unit = _with_unit(cell.strip(), known)
        if column not in known:
            raise ValueError(f"column {bare(column)}: there is no such column{near_or_all(column, known)}")
        if column in found:
            raise ValueError(f"column {column}: stands there more than once")
        units = _units_of(column)
        if unit is not None and unit not in units:
            raise ValueError(f"column {bare(cell.strip())}: the unit must be {' or '.join(units)}")
        found[column] = _reader(column, unit and units[unit], form)
    if form.domains and [*found] == ["weight"]:
        raise ValueError(f"has no column but weight; allowed are {', '.join(form.domains)}")
    for some in alternatives:
        there = [column for column in found if column in some]
        if not there and some in form.columns:
            raise ValueError(f"column {' or '.join(some)}: missing; the first row must be {form.first_row}")
        for other in there[1:]:
            raise ValueError(f"column {other}: cannot be combined with {there[0]}; only one of them can count")
    return found


def _with_unit(cell: str, known: list[str]) -> tuple[str, str | None]:
    """The name of a column and the unit in it: "depth (um)", "depth [um]" or "depth_um"."""
    for column in known:
        match = re.fullmatch(rf"{re.escape(column)}\s*(?:_(.+)|\((.*)\)|\[(.*)\])", cell)
        if match and cell not in known and _units_of(column):
            unit = match[match.lastindex or 0].strip().translate(_SIGNS)
            unit = re.sub(r"(?<=m)3$", "^3", unit)
            return (_RELATIVE, unit) if (column, unit) == ("deviation", "%") else (column, unit)
    return cell, None


def _reader(column: str, size: Any, form: Form) -> Callable[[str], float]:
    """What reads a cell of a column in a unit of this size, None without one; a ValueError says what is wrong."""
    domain, si, plain = form.domains.get(column), "", []
    if domain:  # of a contact, whose depth is not that of a coating
        wanted = f"must be {domain.text}"
    else:
        si, allowed, meaning, *plain = _COLUMNS[column]
        domain = getattr(ranges, allowed)
        wanted = f"must be a finite number {'>= 0' if domain is NUMBER else '> 0'}{meaning and f', {meaning}'}"

    low, high = map(float, plain[:2] or (0.0, 0.0))

    def number(cell: str) -> float:
        value = number_in(cell)
        if value is None or not domain.contains(value):
            told = f"{column} = {cut(one_line(cell.strip()))}: {wanted}{_POINT if ',' in cell else ''}"
            raise ValueError(told if cell.strip() else f"{column}: missing; it {wanted}")
        if plain and not size and not (value == 0.0 or low <= value <= high):
            unit = f"{si}, the unit of a column without one; write {column} ({plain[3]})"
            raise ValueError(f"{column} = {value:g}: is no {plain[2]} in {unit}")
        # Divided by 1e6, 5 um is exactly the floating-point number 5e-6; multiplied by 1e-6 it is not.
        return value / round(1.0 / size) if size and size < 1.0 else value * (size or 1.0)

    return number


def number_in(cell: str) -> float | None:
    """The number in a text; None if there is none."""
    try:
        return float(cell)
    except ValueError:
        return None
