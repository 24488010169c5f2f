"""The command `plgwear plot`: pictures of sweeps."""

import warnings
from pathlib import Path
from typing import Annotated

import typer

from plgwear_jax._core.words import one_line
from plgwear_jax._files import check_targets
from plgwear_jax.cli import drawing
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.sweep import refusing_values, sweep_library
from plgwear_jax.cli.terminal import refuse, refusing_targets, warn

__all__ = ["plot"]


def plot(
    store: Annotated[Path, typer.Argument(metavar="MAP.zarr", help="The sweep.", show_default=False)],
    quantity: Annotated[
        str | None, typer.Option("--quantity", "-q", help="Which one. By default the first.", show_default=False)
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="AXIS=VALUE", help="Where to cut an axis, if there are more than two.", show_default=False
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Where to draw: a .png, .pdf or .svg file. By default it is named after the sweep, here.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Draw a sweep: a heat map with contours over two axes, lines over one.

    On maps of the wear volume over k and the amplitude the exponent that wears least is drawn on top.

    Example: plgwear plot map.zarr --quantity wear_volume --picture map.pdf
    """
    picture = picture or Path(f"{store.stem}.png")
    cuts = dict(_cut(text) for text in at or [])
    with refusing_targets():
        check_targets(picture)
    with computing("drawing the map", one_question=False), refusing_values():
        library = sweep_library()
        plots = drawing.plots()
        from plgwear_jax.plots import maps

        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always", library.UnfinishedWarning)
            found = library.open_sweep(store)
        plots.save(maps.map_picture(found, quantity, at=cuts), picture)
    typer.echo(f"picture: {one_line(str(picture))}")
    for said in heard:
        warn(str(said.message))


def _cut(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        refuse(f"--at {one_line(text)}: must be AXIS=VALUE, such as z0=1e-4")
    return name.strip(), value.strip()
