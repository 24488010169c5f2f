"""Tables of tangential amplitudes, read from CSV files and checked.

A table gives each amplitude a weight: an uncertain load, or a population of contacts. A history lists the amplitudes
of a contact over its cycles. Cells are separated by commas, semicolons or tabs; blank lines and comments (lines that
start with #) are skipped; messages name a row by the number of its line in the file, from 1.
"""

import csv
import dataclasses
import io
import os

import numpy as np

from plgwear_jax._core.words import bare, cut, near_or_all, one_line, read_text

__all__ = ["Amplitudes", "TableError", "numbered_lines", "read_history", "read_table"]


class TableError(ValueError):
    """An error in a table, in one line: file, row, column, value, and what is allowed."""


@dataclasses.dataclass(frozen=True, eq=False)
class Amplitudes:
    """The amplitudes of a file, row by row.

    Attributes:
        name: The file, as it was named, on one line.
        tangential_force: Amplitudes F_x in N, finite, >= 0, shape (n,), n >= 1.
        weight: Their weights, finite, >= 0, not all zero, shape (n,); None for a history.
        row: The line number of each in the file, shape (n,).
    """

    name: str
    tangential_force: np.ndarray
    weight: np.ndarray | None
    row: np.ndarray

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Amplitudes):
            return NotImplemented
        same = self.name == other.name and np.array_equal(self.row, other.row)
        same = same and np.array_equal(self.tangential_force, other.tangential_force)
        if self.weight is None or other.weight is None:
            return same and self.weight is other.weight
        return same and np.array_equal(self.weight, other.weight)

    def refuse_from(self, limit: float) -> None:
        """Raise a TableError for the first amplitude, whatever its weight, that is not below a limit in N."""
        (beyond,) = np.nonzero(~(self.tangential_force < limit))
        if beyond.size:
            force, row = self.tangential_force[beyond[0]], self.row[beyond[0]]
            text = f"this is gross slip, it must be below mu F_N = {limit:g} N"
            raise TableError(f"{self.name}: row {row}: tangential_force = {force}: {text}")


def read_table(path: str | os.PathLike[str]) -> Amplitudes:
    """Read a CSV file with the columns tangential_force, in N, and weight, in any order.

    Args:
        path: The file, in UTF-8.

    Returns:
        The amplitudes and weights as in the file; the weights need not sum to one.

    Raises:
        TableError: The file cannot be read, a column is missing or unknown, a cell is not a finite number >= 0, or all
            weights are zero; the first error is reported, in one line.
    """
    found = _read(path, ("tangential_force", "weight"))
    assert found.weight is not None
    if not np.any(found.weight):
        rows = f"row {found.row[0]}" if found.row.size == 1 else f"rows {found.row[0]} to {found.row[-1]}"
        raise TableError(f"{found.name}: {rows}: weight = 0 throughout; at least one weight must be > 0")
    return found


def read_history(path: str | os.PathLike[str]) -> Amplitudes:
    """Read a CSV file with the single column tangential_force, in N.

    Args:
        path: The file, in UTF-8.

    Returns:
        The amplitudes, without weights.

    Raises:
        TableError: The file cannot be read, the column is missing or not alone, or a cell is not a finite number >= 0;
            the first error is reported, in one line.
    """
    return _read(path, ("tangential_force",))


# --- reading --------------------------------------------------------------------------------------------------------

_ALLOWED = {
    "tangential_force": "must be a finite number >= 0, the amplitude of the force in N",
    "weight": "must be a finite number >= 0",
}
_BLOCK = 1 << 16  # rows parsed at a time


def _read(path: str | os.PathLike[str], columns: tuple[str, ...]) -> Amplitudes:
    name = one_line(os.fspath(path))
    rows, lines = numbered_lines(read_text(path, "a table is a CSV file", TableError))
    if not lines:
        raise TableError(f"{name}: is empty; it must begin with the row {','.join(columns)}")
    separator = max(",;\t", key=lines[0].count)
    header, said = _header(lines[0], separator, columns)
    if said is not None:
        raise TableError(f"{name}: row {rows[0]}: {said}")
    if len(lines) == 1:
        raise TableError(f"{name}: row {rows[0]}: names the columns, and no rows follow; there must be at least one")

    blocks = []
    for first in range(1, len(lines), _BLOCK):
        some = lines[first : first + _BLOCK]
        block = _numbers(some, separator, len(header))
        if block is None:
            complaints = (_complaint(line, separator, header) for line in some)
            row, said = next((row, said) for row, said in zip(rows[first:], complaints, strict=False) if said)
            raise TableError(f"{name}: row {row}: {said}")
        blocks.append(block)
    cells = dict(zip(header, np.concatenate(blocks).T, strict=True))
    weight = _frozen(cells["weight"]) if "weight" in cells else None
    return Amplitudes(name, _frozen(cells["tangential_force"]), weight, _frozen(np.array(rows[1:])))


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


def _numbers(lines: list[str], separator: str, width: int) -> np.ndarray | None:
    """The numbers in some lines, shape (lines, width), or None if any of them is not allowed."""
    try:
        cells = _split(lines, separator)
        if len(cells) != len(lines) or set(map(len, cells)) != {width}:
            return None
        numbers = np.fromiter((float(cell) for row in cells for cell in row), float, len(lines) * width)
    except (csv.Error, ValueError):
        return None
    right = np.isfinite(numbers) & (numbers >= 0.0)
    return numbers.reshape(-1, width) if right.all() else None


def _header(line: str, separator: str, columns: tuple[str, ...]) -> tuple[list[str], str | None]:
    """The names of the columns in the order of the file, and what is wrong with them."""
    try:
        (cells,) = _split([line], separator)
    except csv.Error as problem:
        return [], _not_csv(problem)
    header = [cell.strip() for cell in cells]
    if all(_number(cell) is not None for cell in header):
        return header, f"holds numbers; the first row must name the columns, {','.join(columns)}"
    for column in header:
        if column not in columns:
            return header, f"column {bare(column)}: there is no such column{near_or_all(column, columns)}"
        if header.count(column) > 1:
            return header, f"column {column}: stands there more than once"
    for column in columns:
        if column not in header:
            return header, f"column {column}: missing; the first row must be {','.join(columns)}"
    return header, None


def _complaint(line: str, separator: str, header: list[str]) -> str | None:
    """What is wrong with a row; None if nothing is."""
    try:
        (cells,) = _split([line], separator)
    except csv.Error as problem:
        return _not_csv(problem)
    if len(cells) > len(header):
        point = "; decimals are set off by a point" if separator == "," else ""
        return f"has {len(cells)} cells, more than the {len(header)} of the first row{point}"
    for column, cell in zip(header, cells + [""] * len(header), strict=False):
        number = _number(cell)
        if not cell.strip():
            return f"{column}: missing; it {_ALLOWED[column]}"
        if number is None or not 0.0 <= number < np.inf:
            point = "; decimals are set off by a point" if "," in cell else ""
            return f"{column} = {cut(one_line(cell.strip()))}: {_ALLOWED[column]}{point}"
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
