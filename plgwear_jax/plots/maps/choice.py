"""What of a sweep is drawn: a quantity, cut where it has more than two axes."""

import math

import numpy as np
import xarray as xr

from plgwear_jax._core.words import near_or_all, one_line
from plgwear_jax.plots.maps.subject import MapError
from plgwear_jax.plots.maps.texts import quantity_of, value_text

__all__ = [
    "asked",
    "cut",
]


def asked(ds: xr.Dataset, quantity: str | None) -> xr.DataArray:
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


def cut(variable: xr.DataArray, at: dict[str, float | str]) -> tuple[xr.DataArray, list[str]]:
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
