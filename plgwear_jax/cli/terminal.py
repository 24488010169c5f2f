"""Output of the command line: results on standard output, everything else on standard error."""

import contextlib
import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from plgwear_jax._core.units import readable
from plgwear_jax._core.words import one_line
from plgwear_jax._files import TargetError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

__all__ = [
    "console",
    "counted",
    "measure",
    "measures",
    "print_json",
    "refuse",
    "refusing_targets",
    "table_of",
    "warn",
    "working",
]


def refuse(line: str) -> NoReturn:
    """Report an error in the input in one line, and exit with code 2."""
    warn(line)
    raise typer.Exit(2)


def warn(line: str) -> None:
    """Print one line on standard error."""
    typer.echo(one_line(line), err=True)


@contextlib.contextmanager
def refusing_targets() -> Iterator[None]:
    """Refuse what cannot be written to."""
    try:
        yield
    except TargetError as error:
        refuse(str(error))


@contextlib.contextmanager
def working(doing: str) -> Iterator[None]:
    """Show on a terminal that something is being done; a pipe or a file sees nothing of it.

    Print nothing meanwhile: it would appear on standard error instead of standard output.

    Args:
        doing: What is being done, such as "drawing the map".
    """
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(f"{doing} ..."):
        yield


def console() -> "Console":
    """A console for tables, which prints their text without interpreting it."""
    from rich.console import Console

    return Console(markup=False, highlight=False, emoji=False)


def table_of(scene_file: Path) -> "Table":
    """A table under the name of a scene."""
    from rich.table import Table

    return Table(title=one_line(str(scene_file)), title_justify="left", title_style="bold")


def measure(value: float, unit: str) -> str:
    """A number with its unit, as a person writes it."""
    factor, name = readable(value, unit)
    return f"{value / factor:.4g} {name}".rstrip()


def counted(cycles: float) -> str:
    """A number of cycles as a person writes it."""
    return f"{cycles:,.0f}" if 10.0 <= cycles < 1e10 else f"{cycles:.3g}"


def measures(values: tuple[float, ...], unit: str) -> list[str]:
    """Numbers for comparison, all with the prefix of the smallest, unless others become too long."""
    smallest, largest = min(values, key=abs), max(values, key=abs)
    factor, name = readable(smallest, unit)
    if smallest == 0.0 or abs(largest) >= 1e4 * factor:
        return [measure(value, unit) for value in values]
    return [f"{value / factor:.4g} {name}".rstrip() for value in values]


def print_json(found: dict[str, Any]) -> None:
    """One JSON object on standard output."""
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
