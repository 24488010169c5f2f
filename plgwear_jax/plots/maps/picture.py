"""A sweep as a picture for print: curves, or a map."""

import re
from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from plgwear_jax.plots.maps.choice import asked, cut
from plgwear_jax.plots.maps.curves import draw_curves
from plgwear_jax.plots.maps.field import draw_map
from plgwear_jax.plots.maps.rows import SEEN, SEEN_OF_CURVE, arranged, row_of
from plgwear_jax.plots.maps.subject import MapError, Subject
from plgwear_jax.plots.maps.texts import title_of
from plgwear_jax.plots.style import (
    CENTIMETRE,
    TICK_SIZE,
    for_print,
)

__all__ = [
    "map_picture",
]


def map_picture(
    ds: xr.Dataset,
    quantity: str | None = None,
    *,
    at: Mapping[str, float | str] | None = None,
    contours: int = 8,
) -> Figure:
    """Draw a quantity of a sweep: a curve over one axis, a few curves, or a map over two axes.

    On a map of the wear over k and the amplitude, a line marks the exponent that wears least, and a dashed line where
    5 % more is worn; on one over two of k, E0 and z0 a star marks the least wear. Both are as exact as the map.

    Args:
        ds: What `sweep.sweep` or `sweep.open_sweep` returned; only what is drawn is read.
        quantity: Its name, "wear_volume.dk" or "wear_volume_dk"; by default the first one.
        at: Values of axes that are not drawn, in the units of the sweep, or the name of a load; the nearest values of
            the sweep are taken. All axes but two have to be among them, except those with a single value.
        contours: About how many contour lines; 0 for none.

    Returns:
        A figure 8.6 cm wide; `plots.save` writes it.

    Raises:
        MapError: There is no such quantity or axis, or more than two axes are left; one line.
    """
    if contours < 0:
        raise MapError(f"contours = {contours}: must be >= 0")
    variable = asked(ds, quantity)
    variable, told = cut(variable, dict(at or {}))
    rows = [row_of(variable, str(dim)) for dim in variable.dims]
    across, other = arranged(rows)
    most = SEEN_OF_CURVE if other is None or other.few else SEEN
    across = across.thinned(most)
    if other is not None:
        other = other.thinned(SEEN)
    drawn = [row for row in (across, other) if row is not None]
    chosen = variable.isel({row.name: row.places for row in drawn}).transpose(*(row.name for row in reversed(drawn)))
    values = np.atleast_2d(chosen.to_numpy())
    missing = "not computed yet" if ds.attrs.get("unfinished") else "undefined"

    is_map = other is not None and not other.few
    figure = Figure(figsize=(8.6 * CENTIMETRE, (7.0 if is_map else 6.5) * CENTIMETRE), dpi=300, layout="constrained")
    axes = figure.subplots()
    subject = Subject(variable, values, ds, missing)
    if other is None or other.few:
        handles = draw_curves(axes, subject, across, other)
    else:
        handles = draw_map(figure, axes, subject, across, other, contours)
    for_print(axes)
    if across.names is not None:
        axes.tick_params(axis="x", which="both", top=False, bottom=False)
    title, rows_needed = title_of(variable, told), 0
    figure.suptitle(title, x=0.02, ha="left", fontsize=TICK_SIZE, linespacing=1.3)
    if handles:
        # columns as wide as their entries, of which some sixty letters fit
        widest = max(len(re.sub(r"\\[a-z]+|[${}]", "", str(handle.get_label()))) for handle in handles)
        columns = max(1, min(len(handles), 60 // (widest + 7)))
        rows_needed = -(-len(handles) // columns)
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=-(-len(handles) // rows_needed),
            handlelength=2.8,
            columnspacing=1.4,
            frameon=False,
            fontsize=TICK_SIZE,
        )
    # long texts make the figure higher instead of the map smaller
    figure.set_figheight(figure.get_figheight() + 0.4 * CENTIMETRE * max(0, title.count("\n") + rows_needed - 2))
    return figure
