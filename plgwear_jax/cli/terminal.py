"""Common to all commands: options, refusing bad input in one line, showing work in progress, and setting up JAX."""

import _thread
import atexit
import contextlib
import errno
import functools
import gc
import math
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from plgwear_jax._core.words import GivenError, one_line

from . import cache

if TYPE_CHECKING:
    from plgwear_jax.scene import Scene


def refuse(line: str) -> NoReturn:
    """Report an error in the input in one line, and exit with code 2."""
    warn(line)
    raise typer.Exit(2)


def warn(line: str) -> None:
    """Print one line on standard error."""
    typer.echo(one_line(line), err=True)


def refusing(command: Callable[..., None]) -> Callable[..., None]:
    """The command, made to report errors in its scene, in a table or in a file to be written in one line."""

    @functools.wraps(command)
    def run(**given: Any) -> None:
        try:
            with _interrupts():
                command(**given)
        except KeyboardInterrupt:
            os._exit(130)  # XLA may still compute: at its own end Python takes away what that uses, and crashes
        except GivenError as error:
            refuse(message(error, given.get("scene_file")))
        except ModuleNotFoundError as error:  # of an extra
            refuse(str(error))
        except OSError as error:
            if error.errno != errno.ENOSPC:
                raise
            refuse("standard output: no space is left on the device")

    return run


@contextlib.contextmanager
def _interrupts() -> Iterator[None]:
    """Repeat an interrupt that was lost: Python ignores those in callbacks, as in that of JAX to collect garbage."""
    before, later, again = sys.unraisablehook, [], _thread.interrupt_main
    if hasattr(signal, "pthread_kill"):  # which also ends a wait
        again = functools.partial(signal.pthread_kill, threading.main_thread().ident or 0, signal.SIGINT)

    def ignored(error: Any) -> None:
        if issubclass(error.exc_type, KeyboardInterrupt):  # once more, if it is lost again
            later.append(threading.Timer(_SOON, again))
            later[-1].start()
        else:
            before(error)

    sys.unraisablehook = ignored
    try:
        yield
    finally:
        sys.unraisablehook = before
        for timer in later:
            timer.cancel()


_SOON = 0.05  # s, after which a callback has mostly ended


def message(error: GivenError, scene_file: Any) -> str:
    """The line for an error in what was given, with the file or the option that is wrong."""
    if error.names_file or scene_file is None:
        return str(error)
    return f"{scene_file}: {'--' if error.names_argument else ''}{error}"


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


# --- what is given ----------------------------------------------------------------------------------------------------

# An option without a default that is worth showing.
option = functools.partial(typer.Option, show_default=False)


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The input file.", show_default=False)]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object, in SI units, instead of tables.")]
Digits = Annotated[
    int | None,
    option(min=1, max=15, help="Correct digits wanted; fewer run faster. By default all there are, 4 if numerical."),
]
Picture = Annotated[
    Path | None,
    option(help="Where to draw the picture: a .png, .pdf or .svg file. By default it is named after the input, here."),
]
CsvFile = Annotated[Path | None, option("--csv", help="A .csv file to write the numbers to, row by row, in SI units.")]


def read_scene(scene_file: Path) -> "Scene":
    """The scene of a file."""
    from plgwear_jax import scene

    return scene.load(scene_file)


def refuse_extremes(finite: Any, what: str = "the wear exceeds") -> None:
    """Refuse a scene whose results are not finite, or nothing where they should be something."""
    if not finite:
        from plgwear_jax.scene import SceneError

        raise SceneError(f"{what} the range of numbers: some value in the input file is too extreme")


def interval(key: str, text: str | None, least: float, most: float, unit: str = "") -> tuple[float, float] | None:
    """The numbers of LOWEST:HIGHEST between the least and the most, or a line that says so."""
    if text is None:
        return None
    try:
        lower, upper = map(float, text.split(":"))
    except ValueError:
        lower = upper = math.nan
    if not least < lower < upper < most:
        below = f" < {most:g}" if most < math.inf else ""
        refuse(f"{key} {one_line(text)}: must be LOWEST:HIGHEST{unit}, {least:g} < LOWEST < HIGHEST{below}")
    return lower, upper


def positive(key: str, value: float | None, what: str) -> None:
    """Refuse a number that is not positive, or not finite."""
    if value is not None and not 0.0 < value < math.inf:
        refuse(f"{key} = {value:g}: must be a finite number > 0, {what}")


# --- JAX and matplotlib -----------------------------------------------------------------------------------------------


@contextlib.contextmanager
def computing(doing: str, one_question: bool = True) -> Iterator[None]:
    """Show that something is being done, and import JAX, with double precision and the cache; see `working`.

    Args:
        doing: What is being done.
        one_question: Whether the command runs few programs, each of them a `startup.programs.Program`.
    """
    with working(doing):
        # Imports and tracing make many objects that stay: looking for garbage would take a tenth of the time.
        gc.set_threshold(200_000, 20, 20)
        atexit.register(gc.freeze)  # skips freeing all objects at the exit, which takes as long as drawing a picture
        import jax

        from plgwear_jax._core.doubts import DoubtfulInputWarning

        jax.config.update("jax_enable_x64", True)
        warnings.simplefilter("ignore", DoubtfulInputWarning)  # commands say it in lines of their own, `Report.doubt`
        cache.use(one_question)
        yield


def plots() -> ModuleType:
    """The module `plgwear_jax.plots`.

    On import matplotlib writes the documentation of a few hundred classes, which a command line never shows.
    """
    import matplotlib.artist

    written = matplotlib.artist.kwdoc
    setattr(matplotlib.artist, "kwdoc", lambda _: "")  # noqa: B010
    try:
        from plgwear_jax import plots
    finally:
        setattr(matplotlib.artist, "kwdoc", written)  # noqa: B010
    return plots
