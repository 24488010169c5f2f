"""Pictures of the command line: matplotlib imported in two thirds of its time."""

from types import ModuleType

__all__ = ["plots"]


def plots() -> ModuleType:
    """The module `plgwear_jax.plots`.

    On import matplotlib writes the documentation of some hundred classes. Nobody asks a command line for it.
    """
    import matplotlib.artist

    written = matplotlib.artist.kwdoc
    setattr(matplotlib.artist, "kwdoc", lambda _: "")  # noqa: B010
    try:
        from plgwear_jax import plots
    finally:
        setattr(matplotlib.artist, "kwdoc", written)  # noqa: B010
    return plots
