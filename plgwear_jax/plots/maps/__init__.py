"""Pictures of sweeps for print: curves, and maps with contour lines.

Needs the extras `sweep` and `plots`. A store may hold a map of any size: along each axis only as many values are read
as can be seen.
"""

import math
import re
from collections.abc import Mapping

import numpy as np

from plgwear_jax._core.extras import needs

with needs("pictures of sweeps", "sweep"):
    import xarray  # noqa: F401

import xarray as xr
from matplotlib.figure import Figure

from plgwear_jax._core.words import near_or_all, one_line
from plgwear_jax.plots.maps.drawing import draw_curves, draw_map
from plgwear_jax.plots.maps.rows import SEEN, SEEN_OF_CURVE, arranged, row_of
from plgwear_jax.plots.maps.texts import MapError, Subject, quantity_of, title_of, value_text
from plgwear_jax.plots.style import CENTIMETRE, TICK_SIZE, for_print, page

__all__ = ["MapError", "map_picture"]


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
    variable = _asked(ds, quantity)
    variable, told = _cut(variable, dict(at or {}))
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
    figure = page(8.6, 7.0 if is_map else 6.5, "constrained")
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


# --- what is drawn ----------------------------------------------------------------------------------------------------


def _asked(ds: xr.Dataset, quantity: str | None) -> xr.DataArray:
    """The quantity to be drawn, or a MapError."""
    names = [str(name) for name in ds.data_vars]
    if not names:
        raise MapError("the sweep holds no quantity")
    if quantity is None:
        return ds[names[0]]
    known = {quantity_of(ds[name]): name for name in names} | dict(zip(names, names, strict=True))
    if quantity not in known:
        raise MapError(f"{one_line(quantity)}: is not in the sweep{near_or_all(quantity, known)}")
    return ds[known[quantity]]


def _cut(variable: xr.DataArray, at: dict[str, float | str]) -> tuple[xr.DataArray, list[str]]:
    """The quantity along the axes that are drawn, and in print what the others are."""
    dims = [str(dim) for dim in variable.dims]
    name = variable.name
    if not dims:
        raise MapError(f"{name}: is a single number, {variable.to_numpy():g}; there is nothing to draw")
    for axis in at:
        if axis not in dims:
            raise MapError(f"{one_line(axis)}: is no axis of {name}{near_or_all(axis, dims)}")
    places, told = {}, []
    for dim in dims:
        values = variable[dim].to_numpy()
        if dim in at:
            places[dim], text = _nearest(dim, variable, values, at[dim])
            told.append(text)
        elif np.all(values == values[0]):
            places[dim] = 0
            told.append(value_text(dim, variable, values[0]))
    left = [dim for dim in dims if dim not in places]
    if not left:
        raise MapError(f"{name}: every axis has a single value; there is nothing to draw")
    if len(left) > 2:
        spans = "; ".join(_span(dim, variable) for dim in left)
        raise MapError(f"{name}: choose a value for {len(left) - 2} of its {len(left)} axes: {spans}")
    fixed = (dim for dim in ("cycles", "wear_coefficient", "share") if dim in variable.coords)
    told += [value_text(dim, variable, float(variable[dim])) for dim in fixed if variable[dim].ndim == 0]
    if "k" in left:
        # printed, since a design may hold the contact radius by one of them
        held = (dim for dim in ("E0", "z0") if dim in variable.coords and variable[dim].ndim == 0)
        told += [value_text(dim, variable, float(variable[dim])) for dim in held]
    return variable.isel(places), told


def _nearest(dim: str, variable: xr.DataArray, values: np.ndarray, wanted: float | str) -> tuple[int, str]:
    """The place on an axis nearest to a value, and its text."""
    if values.dtype.kind not in "fiu":
        names = [str(value) for value in values]
        if wanted not in names:
            raise MapError(f"{dim} = {one_line(str(wanted))}: is not in the sweep{near_or_all(str(wanted), names)}")
        return names.index(str(wanted)), value_text(dim, variable, wanted)
    try:
        number = float(wanted)
    except ValueError:
        number = math.nan
    # beyond the ends by at most the spacing of the values there
    ordered = np.sort(values) if values.size > 1 else values
    before, behind = (float(np.ptp(ends)) for ends in (ordered[:2], ordered[-2:]))
    if not float(ordered[0]) - before <= number <= float(ordered[-1]) + behind:
        raise MapError(f"{dim} = {one_line(str(wanted))}: is outside of the sweep: {_span(dim, variable)}")
    place = int(np.argmin(np.abs(values - number)))
    text = value_text(dim, variable, values[place])
    if not math.isclose(float(values[place]), number, rel_tol=1e-6, abs_tol=1e-12 * abs(float(ordered[-1]))):
        text += f" (nearest to {value_text(dim, variable, number).split(' = ')[1]})"
    return place, text


def _span(dim: str, variable: xr.DataArray) -> str:
    values = variable[dim]
    if values.dtype.kind not in "fiu":
        return f"{dim} ({', '.join(one_line(str(value)) for value in values.to_numpy())})"
    unit = values.attrs.get("units", "1")
    return f"{dim} ({float(values.min()):g} to {float(values.max()):g}{'' if unit == '1' else f' {unit}'})"
