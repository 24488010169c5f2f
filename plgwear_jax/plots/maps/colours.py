"""The range of the values, and their colours."""

import math
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.colors import AsinhNorm, CenteredNorm, Colormap, LogNorm, Normalize
from matplotlib.lines import Line2D

from plgwear_jax.plots.maps.subject import DECADES

__all__ = [
    "BLANK",
    "Span",
    "colours_of",
    "note",
    "span_of",
]


BLANK = "0.86"

# --- colours --------------------------------------------------------------------------------------------------------


class Span(NamedTuple):
    """The range of the colours, in the unit of the sweep.

    Attributes:
        any: There is at least one finite value.
        lower: The lowest value with a colour of its own.
        upper: The highest one.
        log: Colours follow the logarithm.
        signed: There are values of both signs.
        below: There are lower values than the lowest.
        above: There are higher values than the highest.
        bend: If not 0, colours follow the logarithm of the size, and are about linear below this size.
        clipped: A remark on values without a colour; empty if there are none.
    """

    any: bool
    lower: float
    upper: float
    log: bool = False
    signed: bool = False
    below: bool = False
    above: bool = False
    clipped: str = ""
    bend: float = 0.0


def span_of(values: np.ndarray, variable: xr.DataArray) -> Span:
    """The range of values, and how colours follow it."""
    finite = values[np.isfinite(values)].astype(float)
    if finite.size == 0:
        return Span(False, 0.0, 1.0)
    lower, upper = float(finite.min()), float(finite.max())
    infinite = bool(np.any(np.isinf(values)))
    size = max(-lower, upper)
    signed = lower < -1e-6 * size and upper > 1e-6 * size  # smaller values are rounding errors
    if not signed and upper > 0.0 and not _is_share(variable, upper):
        least = float(np.quantile(finite[finite > 0.0], 0.002))
        if upper > 10.0**DECADES * least:
            positive = float(finite[finite > 0.0].min())
            said = "infinite values are left out of the scale" if infinite else ""
            return Span(True, positive, upper, True, False, bool(np.any(values <= 0.0)), infinite, said)
    sizes = np.abs(finite[finite != 0.0])
    crowded = signed and size > 30.0 * np.median(sizes)  # most values lie close to zero
    wide = lower < 0.0 >= upper and size > 10.0**DECADES * sizes.min()
    if not infinite and (crowded or wide):
        bend = min(max(float(np.quantile(sizes, 0.2 if signed else 0.002)), 1e-5 * size), 0.1 * size)
        ends = (-size, size) if signed else (lower, upper)
        return Span(True, *ends, signed=signed, bend=10.0 ** math.ceil(math.log10(bend)))
    said, usual = "", float(np.quantile(np.abs(finite), 0.99))
    if infinite or (usual > 0.0 and size > 20.0 * usual):
        lower, upper = max(lower, -usual), min(upper, usual)
        said = "scale ends with 99 % of the values"
    if signed:
        lower, upper = -max(-lower, upper), max(-lower, upper)
    return Span(True, lower, upper, False, signed, bool(np.any(values < lower)), bool(np.any(values > upper)), said)


def _is_share(variable: xr.DataArray, upper: float) -> bool:
    return str(variable.attrs.get("units", "1")) == "1" and upper <= 1.0


def colours_of(span: Span, factor: float) -> tuple[Normalize, Colormap]:
    """The scale of the colours, in the unit shown, and the colours."""
    lower, upper = span.lower / factor, span.upper / factor
    if span.bend:
        return AsinhNorm(span.bend / factor, lower, upper), colormaps["RdBu_r" if span.signed else "viridis"]
    if span.signed:
        return CenteredNorm(0.0, upper), colormaps["RdBu_r"]
    if span.log:
        return LogNorm(lower, upper), colormaps["viridis"]
    if lower == upper:  # the same everywhere
        margin = 0.5 * abs(lower) or 0.5
        lower, upper = lower - margin, upper + margin
    return Normalize(lower, upper), colormaps["viridis"]


def note(text: str) -> Line2D:
    """A line of the legend that only says something."""
    return Line2D([], [], linestyle="", label=text)
