"""The script `plgwear`: it reads an input file and gives a table, a JSON object or a picture.

An error in the input is reported in one line on standard error, and the exit code is then 2. The file of a command
imports nothing that takes time: JAX, NumPy, Matplotlib and so on are imported by the first function that needs them.
"""

import io
import os
import sys
import textwrap
from typing import Annotated

import typer

from plgwear_jax._version import __version__

from . import coating, design, figures, new, solve, sweep, wear
from .terminal import refusing

__all__ = ["app", "main"]

app = typer.Typer(
    name="plgwear",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)


def main() -> None:
    """Run the script."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a terminal without µ
    app(prog_name="plgwear")


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"plgwear {__version__}")
        raise typer.Exit


_HELP = f"""Wear of an indenter on a coating whose Young's modulus varies with depth.

An input file in TOML describes the coating, the contact and the load. To get one to start from, run
`plgwear new SCENE.toml`. A complete one:

{textwrap.indent(new.FRETTING, "    ")}
Then `plgwear solve SCENE.toml` computes the quantities, `plgwear design SCENE.toml` finds the best coating,
`plgwear front SCENE.toml` shows the trade-off curve of two quantities, and `plgwear wear SCENE.toml`
the wear over cycles. `plgwear regimes SCENE.toml` shows where the slip is partial and where gross.
`plgwear coating TABLE.csv --scene SCENE.toml` fits a power law to a measured E(z), and says what it costs.
`plgwear sweep` needs no input file: it maps any quantity over any axes, and `plgwear plot` draws the map.
"""


@app.callback(help=_HELP)
def plgwear(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version and exit.")
    ] = False,
    no_cache: Annotated[
        bool,
        typer.Option(
            "--no-cache",
            envvar="PLGWEAR_NO_CACHE",
            help="Neither use what was compiled for earlier commands nor keep what this one compiles.",
        ),
    ] = False,
) -> None:
    if no_cache:
        os.environ["JAX_ENABLE_COMPILATION_CACHE"] = "false"  # which leaves off this cache, too


for _command in (
    new.new,
    solve.solve,
    design.design,
    design.front,
    wear.wear,
    solve.regimes,
    coating.coating,
    sweep.sweep,
    sweep.plot,
    figures.figures,
    new.schema,
):
    app.command()(refusing(_command))
