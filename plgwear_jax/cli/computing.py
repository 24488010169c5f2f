"""JAX set up for the command line when a command needs it: double precision, and the cache of programs."""

import contextlib
from collections.abc import Iterator

from plgwear_jax.cli import cache
from plgwear_jax.cli.terminal import working

__all__ = ["computing", "set_up"]


def set_up() -> None:
    """Import JAX and set it up; a second call changes nothing."""
    import jax

    jax.config.update("jax_enable_x64", True)
    cache.use()


@contextlib.contextmanager
def computing(doing: str) -> Iterator[None]:
    """Set JAX up, and show on a terminal that something is being done; see `terminal.working`."""
    with working(doing):
        set_up()
        yield
