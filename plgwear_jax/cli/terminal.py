"""What every command does alike on a terminal: it refuses bad input in one line, warns, and shows that it works."""

import contextlib
import functools
import sys
from collections.abc import Callable, Iterator
from typing import Any, NoReturn

import typer

from plgwear_jax._core.words import one_line
from plgwear_jax._files import TargetError


def refuse(line: str) -> NoReturn:
    """Report an error in the input in one line, and exit with code 2."""
    warn(line)
    raise typer.Exit(2)


def warn(line: str) -> None:
    """Print one line on standard error."""
    typer.echo(one_line(line), err=True)


def refusing(command: Callable[..., None]) -> Callable[..., None]:
    """A command that refuses what turns out wrong with its scene, with a table or with a file that it writes."""

    @functools.wraps(command)
    def run(**given: Any) -> None:
        try:
            command(**given)
        except ValueError as error:
            line = _refusal(error, given.get("scene_file"))
            if line is None:
                raise
            refuse(line)

    return run


def _refusal(error: ValueError, scene_file: Any) -> str | None:
    """What is said of an error in the input; None for an error of the program."""
    if isinstance(error, TargetError):
        return str(error)
    from plgwear_jax.scene import OtherFileError, SceneError

    if isinstance(error, SceneError):
        return str(error) if isinstance(error, OtherFileError) else f"{scene_file}: {error}"
    from plgwear_jax.tables import TableError

    return str(error) if isinstance(error, TableError) else None


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
