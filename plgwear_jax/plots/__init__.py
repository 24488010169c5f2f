"""Pictures for print: a design beside its reference, the trade-off between wear and edge pressure, and others."""

from pathlib import Path

from plgwear_jax._core.extras import needs

with needs("pictures", "plots"):
    import matplotlib

from matplotlib.figure import Figure

from plgwear_jax._core import files
from plgwear_jax._core.files import TargetError as PictureError
from plgwear_jax._core.units import readable
from plgwear_jax._core.words import PathGiven

from .contacts import blocks_picture, fit_picture, regimes_picture, stress_picture, wear_picture
from .designs import coating_picture, design_picture, free_picture, front_picture
from .style import COLOURS, STYLE, use_style

__all__ = [
    "COLOURS",
    "PictureError",
    "blocks_picture",
    "check_target",
    "coating_picture",
    "design_picture",
    "fit_picture",
    "free_picture",
    "front_picture",
    "readable",
    "regimes_picture",
    "save",
    "stress_picture",
    "use_style",
    "wear_picture",
]


def check_target(path: PathGiven) -> None:
    """Check that a picture could be written to a file, without leaving one.

    Raises:
        PictureError: The suffix is not that of a picture, or the place cannot be written to.
    """
    files.check_target(path, files.PICTURES)


def save(figure: Figure, path: PathGiven) -> None:
    """Write a figure to a file, which afterwards is either complete or as it was before.

    The same figure gives the same bytes: no date is written.

    Args:
        figure: The figure.
        path: The file; its suffix gives the format: .png, .pdf or .svg.

    Raises:
        PictureError: The suffix is none of these, or the place cannot be written to.
    """
    check_target(path)
    kind = Path(path).suffix[1:].lower()
    dated = {"png": "Software", "pdf": "CreationDate", "svg": "Date"}[kind]
    with matplotlib.rc_context(STYLE):
        files.write(path, lambda target: figure.savefig(target, format=kind, metadata={dated: None}))
