"""The command line, as tests call it."""

from pathlib import Path
from typing import Any

from typer.testing import CliRunner

from plgwear_jax import cli


def plgwear(*arguments: str) -> Any:
    """The result of a command."""
    return CliRunner().invoke(cli.app, arguments)


def refused(*arguments: str) -> str:
    """The one line with which bad input is refused; nothing else is printed, and no file written."""
    before = sorted(Path().rglob("*"))
    result = plgwear(*arguments)
    assert result.exit_code == 2 and result.stdout == "" and sorted(Path().rglob("*")) == before
    (line,) = result.stderr.splitlines()
    return line
