"""Import and set up JAX and matplotlib for the command line, when a command needs them."""

import atexit
import contextlib
import gc
import warnings
from collections.abc import Iterator
from types import ModuleType

from plgwear_jax.cli import cache
from plgwear_jax.cli.terminal import working


def set_up(*, one_question: bool) -> None:
    """Import JAX and set it up, with double precision and the cache of programs; a second call changes nothing.

    Args:
        one_question: Whether the command runs few programs, each of them a `_startup.programs.Program`.
    """
    # Imports and tracing make many objects that stay: looking for garbage among them would take a tenth of the time.
    gc.set_threshold(200_000, 20, 20)
    atexit.register(gc.freeze)  # skips freeing all objects at the exit, which takes as long as drawing a picture
    import jax

    from plgwear_jax._core.doubts import DoubtfulInputWarning

    jax.config.update("jax_enable_x64", True)
    warnings.simplefilter("ignore", DoubtfulInputWarning)  # commands say it in lines of their own, `doubt_units`
    cache.use(one_question)


@contextlib.contextmanager
def computing(doing: str, *, one_question: bool) -> Iterator[None]:
    """Set JAX up, and show on a terminal that something is being done; see `set_up` and `terminal.working`."""
    with working(doing):
        set_up(one_question=one_question)
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
