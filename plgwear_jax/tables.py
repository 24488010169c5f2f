"""Tables of tangential amplitudes, measured wear, moduli and heights, read from CSV files and checked.

A table gives each amplitude a weight: an uncertain load, or a population of contacts. A history lists the amplitudes
of a contact over its cycles, with or without the number of cycles of each. Measured wear is a list of volumes after
numbers of cycles. A graded modulus is a list of moduli at depths, a profile one of heights at radii. Cells are
separated by commas, semicolons or tabs; blank lines and comments (lines that start with #) are skipped; messages name
a row by the number of its line in the file, from 1.

A column of lengths, forces, volumes or moduli may name its unit, as "depth (um)", "depth [um]" or "depth_um": m, mm, um
or nm; N, mN, uN, kN or MN; m^3, mm^3, um^3 or nm^3; Pa, kPa, MPa or GPa. Without one its numbers are in SI units.
"""

import csv
import dataclasses
import io
import os
import re
import sys
from collections.abc import Mapping

import numpy as np

from plgwear_jax._core.ranges import Domain
from plgwear_jax._core.words import bare, cut, near_or_all, one_line, read_text
from plgwear_jax.catalogue import leaf

__all__ = [
    "Amplitudes",
    "GradedModulus",
    "Heights",
    "Measured",
    "Scatter",
    "TableError",
    "numbered_lines",
    "read_heights",
    "read_history",
    "read_measured",
    "read_modulus",
    "read_scatter",
    "read_table",
]


class TableError(ValueError):
    """An error in a table, in one line: file, row, column, value, and what is allowed."""


class _Rows:
    """What was read from a file: equal where all fields are."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(np.array_equal(one, vars(other)[name]) for name, one in vars(self).items())


@dataclasses.dataclass(frozen=True, eq=False)
class Amplitudes(_Rows):
    """The amplitudes of a file, row by row.

    Attributes:
        name: The file, as it was named, on one line.
        amplitude: Amplitudes F_x in N, or of the displacement in m, finite, >= 0, shape (n,), n >= 1.
        weight: Weights of the amplitudes, finite, >= 0, not all zero, shape (n,); None for a history.
        row: Line number of each amplitude in the file, shape (n,).
        column: Kind of the amplitudes, "tangential_force" or "displacement".
        cycles: How many cycles each row of a history lasts, finite, >= 0, shape (n,); None if the file does not say.
        normal_force: Normal force in N in each row of a history, > 0, shape (n,); None if the file does not say.
        friction: Coefficient of friction in each row of a history, > 0, shape (n,); None if the file does not say.
    """

    name: str
    amplitude: np.ndarray
    weight: np.ndarray | None
    row: np.ndarray
    column: str = "tangential_force"
    cycles: np.ndarray | None = None
    normal_force: np.ndarray | None = None
    friction: np.ndarray | None = None

    @property
    def tangential_force(self) -> np.ndarray:
        """The force amplitudes in N; a TableError if the file has displacement amplitudes."""
        return self._of("tangential_force")

    @property
    def displacement(self) -> np.ndarray:
        """The displacement amplitudes in m; a TableError if the file has force amplitudes."""
        return self._of("displacement")

    def _of(self, column: str) -> np.ndarray:
        if self.column != column:
            raise TableError(f"{self.name}: has a column {self.column}, and none of {column}")
        return self.amplitude

    def refuse_from(self, limit: float | np.ndarray) -> None:
        """Raise a TableError for the first force, whatever its weight, that is not below a limit in N, or its own."""
        limit = np.broadcast_to(limit, self.row.shape)
        (beyond,) = np.nonzero(~(self.tangential_force < limit))
        if beyond.size:
            force, row = self.tangential_force[beyond[0]], self.row[beyond[0]]
            text = f"this is gross slip, it must be below mu F_N = {limit[beyond[0]]:g} N"
            raise TableError(f"{self.name}: row {row}: tangential_force = {force}: {text}")


@dataclasses.dataclass(frozen=True, eq=False)
class Measured:
    """Worn volumes of a test, row by row.

    Attributes:
        name: The file, as it was named, on one line.
        cycles: Numbers of cycles, finite, >= 0, shape (n,), n >= 1.
        volume: Volumes worn after these cycles in m^3, finite, >= 0, shape (n,).
        deviation: Standard deviations of the volumes in m^3, or relative, finite, > 0, shape (n,); None without such a
            column.
        row: The line number of each in the file, shape (n,).
        relative: The deviations are shares of the volumes.
    """

    name: str
    cycles: np.ndarray
    volume: np.ndarray
    deviation: np.ndarray | None
    row: np.ndarray
    relative: bool = False


@dataclasses.dataclass(frozen=True, eq=False)
class GradedModulus(_Rows):
    """Young's modulus at some depths, row by row.

    Attributes:
        name: The file, as it was named, on one line.
        depth: Depths in m, finite, >= 0, increasing, shape (n,), n >= 2.
        modulus: Young's modulus at these depths in Pa, finite, > 0, shape (n,).
        row: The line number of each in the file, shape (n,).
    """

    name: str
    depth: np.ndarray
    modulus: np.ndarray
    row: np.ndarray


@dataclasses.dataclass(frozen=True, eq=False)
class Heights(_Rows):
    """Heights of an indenter at some radii, row by row.

    Attributes:
        name: The file, as it was named, on one line.
        r: Radii in m, finite, increasing from 0, shape (n,), n >= 2.
        height: Heights in m above the apex at these radii, finite, increasing from 0, shape (n,).
        row: The line number of each in the file, shape (n,).
    """

    name: str
    r: np.ndarray
    height: np.ndarray
    row: np.ndarray


@dataclasses.dataclass(frozen=True, eq=False)
class Scatter(_Rows):
    """What a contact may turn out to be, row by row.

    Attributes:
        name: The file, as it was named, on one line.
        columns: Which numbers of the contact are known, by their names, such as "friction" or "indenter.E".
        numbers: Their values in SI units, shape (n, columns).
        weight: Probabilities of the rows, finite, >= 0, not all zero, shape (n,); None if the file does not say.
        row: The line number of each in the file, shape (n,).
    """

    name: str
    columns: tuple[str, ...]
    numbers: np.ndarray
    weight: np.ndarray | None
    row: np.ndarray


def read_table(path: str | os.PathLike[str]) -> Amplitudes:
    """Read a CSV file with the columns tangential_force, in N, or displacement, in m, and weight, in any order.

    Args:
        path: The file, in UTF-8.

    Returns:
        The amplitudes and weights as in the file; the weights need not sum to one.

    Raises:
        TableError: The file cannot be read, a column is missing or unknown, a cell is not a finite number >= 0, or all
            weights are zero; the first error is reported, in one line.
    """
    found = _amplitudes(path, ("weight",))
    assert found.weight is not None
    if not np.any(found.weight):
        raise TableError(f"{found.name}: {_rows(found.row)}: weight = 0 throughout; at least one weight must be > 0")
    return found


def read_history(path: str | os.PathLike[str]) -> Amplitudes:
    """Read a CSV file of a history: an amplitude in each row, and if known what else is constant in its cycles.

    The columns, in any order, are tangential_force, in N, or displacement, in m, and if wanted cycles, normal_force, in
    N, and friction.

    Args:
        path: The file, in UTF-8.

    Returns:
        The amplitudes, without weights, and what the file says of the cycles, normal forces and friction of each.

    Raises:
        TableError: The file cannot be read, a column or a unit is missing or unknown, a cell is not a finite number
            >= 0, or a normal force or a friction is 0; the first error is reported, in one line.
    """
    found = _amplitudes(path, (), ("cycles", *_PRESSED))
    for column in _PRESSED:
        values = getattr(found, column)
        if values is not None and not np.all(values > 0.0):
            row = found.row[int(np.argmin(values > 0.0))]
            raise TableError(f"{found.name}: row {row}: {column} = 0: {_ALLOWED[column]}")
    return found


def read_measured(path: str | os.PathLike[str]) -> Measured:
    """Read a CSV file with the columns cycles and volume, in m^3, and if wanted deviation, in m^3, in any order.

    The column `relative_deviation`, or `deviation (%)`, has the standard deviations as shares of the volumes instead.

    Args:
        path: The file, in UTF-8.

    Returns:
        The measured volumes.

    Raises:
        TableError: The file cannot be read, a column is missing or unknown, a cell is not a finite number >= 0, or a
            deviation is 0; the first error is reported, in one line.
    """
    name, row, cells = _read(path, (("cycles",), ("volume",)), ("deviation", _RELATIVE))
    if {"deviation", _RELATIVE} <= cells.keys():
        raise TableError(f"{name}: column {_RELATIVE}: cannot be combined with deviation")
    relative = _RELATIVE in cells
    deviation = cells.get(_RELATIVE if relative else "deviation")
    if deviation is not None and not np.all(deviation > 0.0):
        first = row[int(np.argmin(deviation > 0.0))]
        raise TableError(f"{name}: row {first}: deviation = 0: must be > 0; leave the column out if it is not known")
    return Measured(name, cells["cycles"], cells["volume"], deviation, row, relative)


def read_modulus(path: str | os.PathLike[str]) -> GradedModulus:
    """Read a CSV file with the columns depth and modulus, in any order.

    Numbers without a unit that no coating has in m and Pa raise an error.

    Args:
        path: The file, in UTF-8.

    Returns:
        The modulus at each depth, in SI units.

    Raises:
        TableError: The file cannot be read, a column or a unit is missing or unknown, a cell is not allowed, the depths
            do not increase, or there is one row only; the first error is reported, in one line.
    """
    name, row, cells = _read(path, (("depth",), ("modulus",)))
    depth, modulus = cells["depth"], cells["modulus"]
    if row.size < 2:
        raise TableError(f"{name}: row {row[0]}: is the only one; a graded modulus needs two depths or more")
    said = [f"row {row[i]}: modulus = 0: {_ALLOWED['modulus']}" for i in np.flatnonzero(modulus == 0.0)[:1]]
    for i in np.flatnonzero(np.diff(depth) <= 0.0)[:1]:
        text = "the depths must increase from row to row, from the surface downwards"
        said.append(f"row {row[i + 1]}: depth = {depth[i + 1]:g} m after {depth[i]:g} m: {text}")
    if said:
        raise TableError(f"{name}: {said[0]}")
    return GradedModulus(name, depth, modulus, row)


def read_scatter(path: str | os.PathLike[str], columns: Mapping[str, Domain]) -> Scatter:
    """Read a CSV file of what a contact may turn out to be: numbers of it, and if wanted weight, in any order.

    Args:
        path: The file, in UTF-8.
        columns: The columns that it may have, and what each allows, in SI units.

    Returns:
        The numbers of each row, and its weight.

    Raises:
        TableError: The file cannot be read, a column is unknown, a cell is not allowed, there is no column but weight,
            or all weights are zero; the first error is reported, in one line.
    """
    name, row, cells = _read(path, (), ("weight", *columns), signed=True)
    weight = cells.pop("weight", None)
    if weight is not None and not (np.all(weight >= 0.0) and np.any(weight)):
        raise TableError(f"{name}: {_rows(row)}: weight: must be >= 0, and not 0 throughout")
    if not cells:
        raise TableError(f"{name}: has no column but weight; allowed are {', '.join(columns)}")
    for column, values in cells.items():
        for i in np.flatnonzero(~columns[column].contains(values))[:1]:
            raise TableError(f"{name}: row {row[i]}: {column} = {values[i]:g}: must be in {columns[column].text}")
    return Scatter(name, tuple(cells), _frozen(np.stack([*cells.values()], axis=-1)), weight, row)


def read_heights(path: str | os.PathLike[str]) -> Heights:
    """Read a CSV file with the columns r and height, in any order.

    Args:
        path: The file, in UTF-8.

    Returns:
        The height at each radius, in m.

    Raises:
        TableError: The file cannot be read, a column or a unit is missing or unknown, a cell is not a finite number
            >= 0, the radii or heights do not increase from 0, or there is one row only; the first error is reported,
            in one line. The first heights may all be 0: a flat face.
    """
    name, row, cells = _read(path, (("r",), ("height",)))
    if row.size < 2:
        raise TableError(f"{name}: row {row[0]}: is the only one; a profile needs two radii or more")
    for column, values in cells.items():
        if values[0] != 0.0:
            raise TableError(
                f"{name}: row {row[0]}: {column} = {values[0]:g} m: a profile begins with r = 0, height = 0"
            )
        falls = (np.diff(values) <= 0.0) & ((column == "r") | (values[1:] != 0.0))
        for i in np.flatnonzero(falls)[:1]:
            text = "radii and heights must increase from row to row"
            raise TableError(f"{name}: row {row[i + 1]}: {column} = {values[i + 1]:g} m after {values[i]:g} m: {text}")
    if cells["height"][-1] == 0.0:
        raise TableError(f"{name}: row {row[-1]}: height = 0 m: the last one must be > 0")
    return Heights(name, cells["r"], cells["height"], row)


def _amplitudes(path: str | os.PathLike[str], more: tuple[str, ...], optional: tuple[str, ...] = ()) -> Amplitudes:
    columns = ("tangential_force", "displacement"), *((column,) for column in more)
    name, row, cells = _read(path, columns, optional)
    (column,) = cells.keys() - {*more, *optional}
    others = (cells.get(one) for one in ("cycles", *_PRESSED))
    return Amplitudes(name, cells[column], cells.get("weight"), row, column, *others)


def _rows(row: np.ndarray) -> str:
    return f"row {row[0]}" if row.size == 1 else f"rows {row[0]} to {row[-1]}"


# --- reading --------------------------------------------------------------------------------------------------------

_ALLOWED = {
    "tangential_force": "must be a finite number >= 0, the amplitude of the force in N",
    "displacement": "must be a finite number >= 0, the amplitude of the displacement in m",
    "weight": "must be a finite number >= 0",
    "cycles": "must be a finite number >= 0",
    "normal_force": "must be a finite number > 0, the normal force in N",
    "friction": "must be a finite number > 0, the coefficient of friction",
    "volume": "must be a finite number >= 0, the worn volume in m^3",
    "deviation": "must be a finite number > 0, the standard deviation of the volume in m^3",
    "relative_deviation": "must be a finite number > 0, the standard deviation over the volume",
    "depth": "must be a finite number >= 0, the depth below the surface",
    "modulus": "must be a finite number > 0, Young's modulus",
    "r": "must be a finite number >= 0, the radius",
    "height": "must be a finite number >= 0, the height above the apex",
}
_SIGNS = str.maketrans({"\N{MICRO SIGN}": "u", "\N{GREEK SMALL LETTER MU}": "u", "\N{SUPERSCRIPT THREE}": "^3"})
_UNITS = {  # by the SI unit, which is that of a column without one
    "m": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9},
    "N": {"N": 1.0, "mN": 1e-3, "uN": 1e-6, "kN": 1e3, "MN": 1e6},
    "m^3": {"m^3": 1.0, "mm^3": 1e-9, "um^3": 1e-18, "nm^3": 1e-27},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "share": {"1": 1.0, "%": 1e-2},
}
_RELATIVE = "relative_deviation"
_SI = {"volume": "m^3", "deviation": "m^3", _RELATIVE: "share", "modulus": "Pa", "height": "m"}  # not of the catalogue
_PRESSED = ("normal_force", "friction")  # optional columns of a history
_PLAIN = {"depth": (0.0, 0.1), "modulus": (1e3, 2e12)}  # allowed ranges in m and Pa for a column without a unit
_Columns = tuple[tuple[str, ...], ...]  # required columns; of each inner tuple the file must have one
_BLOCK = 1 << 16  # rows parsed at a time


def _read(
    path: str | os.PathLike[str],
    columns: _Columns,
    optional: tuple[str, ...] = (),
    signed: bool = False,
) -> tuple[str, np.ndarray, dict[str, np.ndarray]]:
    """The name of a file, the line number of each row, and its columns by name; signed ones may be negative."""
    name = one_line(os.fspath(path))
    rows, lines = numbered_lines(read_text(path, "a table is a CSV file", TableError))
    if not lines:
        raise TableError(f"{name}: is empty; it must begin with the row {_first_row(columns) or 'of its columns'}")
    separator = max(",;\t", key=lines[0].count)
    header, said = _header(lines[0], separator, columns, optional)
    header, factors = [column for column, _ in header], [factor for _, factor in header]
    if said is not None:
        raise TableError(f"{name}: row {rows[0]}: {said}")
    if len(lines) == 1:
        raise TableError(f"{name}: row {rows[0]}: names the columns, and no rows follow; there must be at least one")

    blocks = []
    for first in range(1, len(lines), _BLOCK):
        some = lines[first : first + _BLOCK]
        least = -np.inf if signed else 0.0
        block = _numbers(some, separator, len(header), least)
        if block is None:
            complaints = (_complaint(line, separator, header, least) for line in some)
            row, said = next((row, said) for row, said in zip(rows[first:], complaints, strict=False) if said)
            raise TableError(f"{name}: row {row}: {said}")
        blocks.append(block)
    cells = dict(zip(header, np.concatenate(blocks).T, strict=True))
    for column, factor in zip(header, factors, strict=True):
        if factor is None and column in _PLAIN:
            _refuse_without_unit(name, rows[1:], column, cells[column])
        elif factor is not None:
            # Divided by 1e6, 5 um is exactly the floating-point number 5e-6; multiplied by 1e-6 it is not.
            cells[column] = cells[column] * factor if factor >= 1.0 else cells[column] / round(1.0 / factor)
    return name, _frozen(np.array(rows[1:])), {column: _frozen(values) for column, values in cells.items()}


def _refuse_without_unit(name: str, rows: list[int], column: str, values: np.ndarray) -> None:
    """Refuse numbers that are implausible in m or Pa, since another unit is probably meant."""
    least, most = _PLAIN[column]
    wrong = np.flatnonzero((values > most) | ((values > 0.0) & (values < least)))
    if wrong.size:
        unit, example = next(iter(_units_of(column))), {"depth": "um", "modulus": "GPa"}[column]
        text = f"is no {column} of a coating in {unit}, the unit of a column without one; write {column} ({example})"
        raise TableError(f"{name}: row {rows[wrong[0]]}: {column} = {values[wrong[0]]:g}: {text}")


def _first_row(columns: _Columns) -> str:
    return ",".join(some[0] for some in columns)


def numbered_lines(text: str) -> tuple[list[int], list[str]]:
    """Number and text of each line that is neither blank nor a comment."""
    rows, lines = [], []
    for row, line in enumerate(io.StringIO(text, newline=None), 1):
        if line.lstrip()[:1] not in ("", "#"):
            rows.append(row)
            lines.append(line)
    return rows, lines


def _split(lines: list[str], separator: str) -> list[list[str]]:
    return list(csv.reader(lines, delimiter=separator, skipinitialspace=True, strict=True))


def _numbers(lines: list[str], separator: str, width: int, least: float) -> np.ndarray | None:
    """The numbers in some lines, shape (lines, width), or None if any of them is not allowed."""
    try:
        cells = _split(lines, separator)
        if len(cells) != len(lines) or set(map(len, cells)) != {width}:
            return None
        numbers = np.fromiter((float(cell) for row in cells for cell in row), float, len(lines) * width)
    except (csv.Error, ValueError):
        return None
    right = np.isfinite(numbers) & (numbers >= least)
    return numbers.reshape(-1, width) if right.all() else None


def _header(
    line: str, separator: str, columns: _Columns, optional: tuple[str, ...]
) -> tuple[list[tuple[str, float | None]], str | None]:
    """(Names of the columns in the order of the file, with their units in SI; what is wrong with them, or None)."""
    try:
        (cells,) = _split([line], separator)
    except csv.Error as problem:
        return [], _not_csv(problem)
    found: list[tuple[str, float | None]] = []
    if all(_number(cell) is not None for cell in cells):
        return found, f"holds numbers; the first row must name the columns, {_first_row(columns)}"
    known = [*(column for some in columns for column in some), *optional]
    for cell in cells:
        column, unit = _with_unit(cell.strip(), known)
        if column not in known:
            return found, f"column {bare(column)}: there is no such column{near_or_all(column, known)}"
        if column in (before for before, _ in found):
            return found, f"column {column}: stands there more than once"
        units = _units_of(column)
        if unit is not None and unit not in units:
            return found, f"column {bare(cell.strip())}: the unit must be {' or '.join(units)}"
        found.append((column, None if unit is None else units[unit]))
    for some in columns:
        there = [column for column, _ in found if column in some]
        if not there:
            return found, f"column {' or '.join(some)}: missing; the first row must be {_first_row(columns)}"
        if len(there) > 1:
            return (
                found,
                f"column {there[1]}: cannot be combined with {there[0]}; only one of them can be the amplitude",
            )
    return found, None


def _units_of(column: str) -> Mapping[str, float]:
    """The units that a column may name, with what each is in the SI unit; none for numbers without a unit."""
    return _UNITS.get(_SI.get(column) or leaf(column).unit, {})


def _with_unit(cell: str, known: list[str]) -> tuple[str, str | None]:
    """The name of a column and the unit in it: "depth (um)", "depth [um]" or "depth_um"."""
    for column in known:
        match = re.fullmatch(rf"{re.escape(column)}\s*(?:_(.+)|\((.*)\)|\[(.*)\])", cell)
        if match and cell not in known and _units_of(column):
            unit = next(unit for unit in match.groups() if unit is not None).strip().translate(_SIGNS)
            unit = re.sub(r"(?<=m)3$", "^3", unit)
            return (_RELATIVE, unit) if (column, unit) == ("deviation", "%") else (column, unit)
    return cell, None


def _complaint(line: str, separator: str, header: list[str], least: float) -> str | None:
    """What is wrong with a row; None if nothing is."""
    try:
        (cells,) = _split([line], separator)
    except csv.Error as problem:
        return _not_csv(problem)
    if len(cells) > len(header):
        point = "; decimals are set off by a point" if separator == "," else ""
        return f"has {len(cells)} cells, more than the {len(header)} of the first row{point}"
    for column, cell in zip(header, cells + [""] * len(header), strict=False):
        number, allowed = _number(cell), _ALLOWED.get(column, "must be a finite number")
        if not cell.strip():
            return f"{column}: missing; it {allowed}"
        if number is None or not max(least, -sys.float_info.max) <= number < np.inf:
            point = "; decimals are set off by a point" if "," in cell else ""
            return f"{column} = {cut(one_line(cell.strip()))}: {allowed}{point}"
    return None


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _not_csv(problem: csv.Error) -> str:
    return f"is not valid CSV: {one_line(str(problem))}"


def _frozen(values: np.ndarray) -> np.ndarray:
    values = np.ascontiguousarray(values)
    values.flags.writeable = False
    return values
