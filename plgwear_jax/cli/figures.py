"""The command `plgwear figures`: the figures of the paper, drawn by the library and checked."""

from pathlib import Path
from typing import Annotated

import typer

from plgwear_jax._core import files
from plgwear_jax._core.paper_figures import PAPER_FIGURES
from plgwear_jax._core.words import one_line

from .terminal import computing, option, refuse, working


def figures(
    out: Annotated[Path, option(help="The folder to write to; it is made if its parent is there.")],
    only: Annotated[
        list[str] | None, option(metavar="NUMBER", help="Only this figure: 1 to 10, table-1 or eq-27. May be repeated.")
    ] = None,
) -> None:
    """Draw the figures of the paper with the library, and check what the paper says about them.

    Each becomes a PDF and a PNG. In the same folder, contact-sheet shows all of them, and figures.md says of each
    statement whether it agrees. Number 10 is the second of the two figures that are printed as 9.

    Example: plgwear figures --out figures --only 4 --only 9
    """
    keys = [key.lstrip("0") or key for key in only or PAPER_FIGURES]
    for key in keys:
        if key not in PAPER_FIGURES:
            refuse(f"--only {one_line(key)}: there is no such figure; allowed are {', '.join(PAPER_FIGURES)}")
    with computing("getting ready", one_question=False):
        from plgwear_jax import plots
        from plgwear_jax.plots import figures as library
    chosen = [figure for figure in library.FIGURES.values() if figure.key in keys]
    suffixes = ".pdf", ".png"
    try:
        out.mkdir(exist_ok=True)
    except OSError as error:
        why = "is a file, not a folder to write to" if out.is_file() else f"cannot be made: {error.strerror}"
        raise files.TargetError(f"{out}: {why}") from None
    files.check_target(out / "figures.md", (".md",))
    for stem in (*(figure.stem for figure in chosen), "contact-sheet"):
        for suffix in suffixes:
            files.check_target(out / f"{stem}{suffix}", suffixes)
    for figure in chosen:
        with working(f"drawing and checking {figure.label}"):
            drawn = figure.draw()
            for suffix in suffixes:
                plots.save(drawn, out / f"{figure.stem}{suffix}")
            verdict = library.verdict(figure.check())
        typer.echo(f"{figure.label:10}{figure.title}: {verdict}")
    with working("drawing all of them on one sheet"):
        sheet = library.contact_sheet(chosen)
        for suffix in suffixes:
            plots.save(sheet, out / f"contact-sheet{suffix}")
        text = library.report(chosen).encode()
    files.write(out / "figures.md", lambda path: path.write_bytes(text))
