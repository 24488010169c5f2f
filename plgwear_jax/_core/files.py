"""Writing files whole or not at all."""

import csv
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from .words import GivenError, PathGiven

if TYPE_CHECKING:
    import numpy as np

PICTURES = (".png", ".pdf", ".svg")


class TargetError(GivenError):
    """A file cannot be written; the message is one line that begins with the file."""


def check_target(path: PathGiven, suffixes: tuple[str, ...]) -> None:
    """Check that a file could be written, without leaving one.

    Args:
        path: The file.
        suffixes: The suffixes that it may have, such as ".png", in upper or lower case.

    Raises:
        TargetError: It has another suffix, or cannot be written there.
    """
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        *first, last = suffixes
        raise TargetError(f"{path}: must end in {' or '.join([', '.join(first), last] if first else [last])}")
    try:
        if path.is_dir():
            raise TargetError(f"{path}: is a folder, not a file to write to")
        sibling = _sibling(path)
        sibling.touch(exist_ok=False)
        sibling.unlink()
    except OSError as error:
        raise TargetError(f"{path}: cannot be written: {error.strerror}") from None


def write(path: PathGiven, content: Callable[[Path], object]) -> None:
    """Write a file, which afterwards is either complete or as it was before.

    Args:
        path: The file.
        content: A function that writes the content to a path.

    Raises:
        TargetError: The file cannot be written there.
    """
    path = Path(path)
    sibling = _sibling(path)
    try:
        content(sibling)
        sibling.replace(path)
    except OSError as error:
        raise TargetError(f"{path}: cannot be written: {error.strerror}") from None
    finally:
        sibling.unlink(missing_ok=True)


def _sibling(path: Path) -> Path:
    """The path of a temporary file in the same folder, which no other process writes to."""
    return path.with_name(f".{path.name}.{os.getpid()}.part")


def write_table(path: Path, columns: "Mapping[str, np.ndarray]") -> None:
    """Write a CSV file whole: the names of the columns, and their rows."""

    def write_rows(target: Path) -> None:
        with target.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))

    write(path, write_rows)
