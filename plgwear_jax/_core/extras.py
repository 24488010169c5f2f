"""Modules whose packages come with an extra."""

import contextlib
from collections.abc import Iterator


@contextlib.contextmanager
def needs(what: str, extra: str) -> Iterator[None]:
    """Say in one line, in Python as on the command line, which extra an import lacks.

    Args:
        what: What cannot be done without it, in the plural.
        extra: Its name.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if "pip install" in str(error):  # said already
            raise
        how = f"pip install 'plgwear-jax[{extra}]', in a clone '.[{extra}]'"
        text = f"{what} need the extra {extra} ({error.name} is missing): {how}"
        raise ModuleNotFoundError(text, name=error.name) from None
