"""Common to all commands: refusing bad input in one line, warning, showing work in progress, and setting up JAX."""

import _thread
import atexit
import contextlib
import errno
import functools
import gc
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any, NoReturn

import typer

from plgwear_jax._core.words import GivenError, one_line
from plgwear_jax.cli import cache


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
    before, later, main = sys.unraisablehook, [], threading.main_thread().ident or 0

    def interrupt() -> None:
        if hasattr(signal, "pthread_kill"):  # which also ends a wait
            signal.pthread_kill(main, signal.SIGINT)
        else:
            _thread.interrupt_main()

    def ignored(error: Any) -> None:
        if issubclass(error.exc_type, KeyboardInterrupt):  # once more, if it is lost again
            later.append(threading.Timer(_SOON, interrupt))
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
    """The line for an error in what was given, with the file that is wrong."""
    return str(error) if error.names_file or scene_file is None else f"{scene_file}: {error}"


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


# --- JAX and matplotlib -----------------------------------------------------------------------------------------------


def set_up(one_question: bool = True) -> None:
    """Import JAX and set it up, with double precision and the cache of programs; a second call changes nothing.

    Args:
        one_question: Whether the command runs few programs, each of them a `startup.programs.Program`.
    """
    # Imports and tracing make many objects that stay: looking for garbage among them would take a tenth of the time.
    gc.set_threshold(200_000, 20, 20)
    atexit.register(gc.freeze)  # skips freeing all objects at the exit, which takes as long as drawing a picture
    import jax

    from plgwear_jax._core.doubts import DoubtfulInputWarning

    jax.config.update("jax_enable_x64", True)
    warnings.simplefilter("ignore", DoubtfulInputWarning)  # commands say it in lines of their own, `Report.doubt`
    cache.use(one_question)


@contextlib.contextmanager
def computing(doing: str, one_question: bool = True) -> Iterator[None]:
    """Set JAX up, and show on a terminal that something is being done; see `set_up` and `working`."""
    with working(doing):
        set_up(one_question)
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
