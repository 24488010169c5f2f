"""What the command line says, and where: results on standard output, everything else on standard error."""

from typing import NoReturn

import typer
from rich.console import Console

from plgwear_jax._words import one_line

__all__ = ["console", "refuse", "warn"]


def refuse(line: str) -> NoReturn:
    """Say in one line what is wrong with the input, and leave with exit code 2."""
    warn(line)
    raise typer.Exit(2)


def warn(line: str) -> None:
    """Say something in one line on standard error."""
    typer.echo(one_line(line), err=True)


def console() -> Console:
    """Where tables are printed: as they are, whatever stands in them."""
    return Console(markup=False, highlight=False, emoji=False)
