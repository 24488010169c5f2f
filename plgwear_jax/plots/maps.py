"""Pictures of sweeps for print: curves, and maps with contour lines.

Needs the extras `sweep` and `plots`. A store may hold a map of any size: along each axis only as many values are read
as can be seen. Labels, units and the spacing of the axes are those that the sweep stores.
"""

import math
import re
import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np

from plgwear_jax._core.extras import needs

with needs("pictures of sweeps", "sweep"):
    import xarray as xr

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import AsinhNorm, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, MaxNLocator

from plgwear_jax._core.units import PREFIXED, written
from plgwear_jax._core.words import near_or_all, one_line
from plgwear_jax.plots.style import (
    BLUE,
    DASH_DOT,
    DASHED,
    DOTTED,
    GREEN,
    ORANGE,
    Style,
    page,
    picture,
    show_units,
)

__all__ = ["MapError", "map_picture"]

_FEW = 6  # most curves that can be told apart; more are drawn as a map
_SEEN, _SEEN_OF_CURVE = 750, 1500  # most values along a side of a picture, whose print is some 700 dots wide
_ALMOST = 1.0 - 1e-15
_BLANK = "0.86"
_CURVES: Style = {
    "color": [BLUE, ORANGE, GREEN, "#AA4499", "k", "#E69F00"],
    "linestyle": ["-", DASHED, DASH_DOT, DOTTED, (0, (9, 2)), (0, (3, 1.2, 1, 1.2, 1, 1.2))],
}
# Of two axes the one that comes first here is horizontal.
_ACROSS = ("r", "distance", "phi", "tangential_force", "k", "z0")
_WEARS = ("wear_volume", "worn_radius", "deepest_wear", "volume_change", "force_drop")
_MOST = 3.0  # as much more or less wear than on a homogeneous body has a colour of its own
_MORE = 0.05  # as much more wear as the plateau has at its edge
_EDGE: list[Any] = [withStroke(linewidth=3.0, foreground="k")]  # white with a black edge is seen on all colours
_LEAST: Style = {"color": "w", "linewidth": 1.6, "zorder": 5, "path_effects": _EDGE}
_STAR: Style = {"color": "w", "markersize": 9.0, "markeredgecolor": "k", "zorder": 6, "clip_on": False}


class MapError(ValueError):
    """Why a picture cannot be drawn, in one line."""


@picture
def map_picture(
    ds: xr.Dataset, quantity: str | None = None, *, at: Mapping[str, float | str] | None = None, contours: int = 8
) -> Figure:
    """Draw a quantity of a sweep: a curve over one axis, a few curves, or a map over two axes.

    A map of the wear volume over k shows it over that of k = 0, if that is among the values. On a map of the wear over
    k and the amplitude, a line marks the exponent that wears least, and a dashed line where 5 % more is worn; on one
    over two of k, E0 and z0 a star marks the least wear. Both are as exact as the map.

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
    variable, told = _cut(_asked(ds, quantity), dict(at or {}))
    across, *others = _arranged(variable)
    is_map = bool(others) and variable.sizes[others[0]] > _FEW
    numbers = [dim for dim in variable.dims if _is_number(variable[dim])]
    most = _SEEN if is_map else _SEEN_OF_CURVE
    seen = {dim: np.linspace(0, n - 1, min(most, n)).round().astype(int) for dim, n in variable.sizes.items()}
    variable = variable.sortby(numbers).isel(seen).transpose(*others, across).compute()
    figure = page(8.6, 6.6 if is_map else 6.1)
    axes = figure.subplots()
    draw = _draw_map if is_map else _draw_curves
    handles = draw(axes, variable, across, others[0] if others else "", contours)
    if np.isnan(variable.astype(float)).any():
        missing = "not computed yet" if ds.attrs.get("unfinished") else "undefined"
        handles.append(Patch(facecolor=_BLANK if is_map else "w", label=f"{'grey' if is_map else 'gaps'}: {missing}"))
    equation = str(variable.attrs.get("equation", ""))
    equation = f", Eq. ({equation})" if equation[:1].isdecimal() else ""
    lines = textwrap.wrap(", ".join([_label(variable) + equation, *told]), 66, break_long_words=False)
    figure.suptitle("\n".join(lines), x=0.02, ha="left", fontsize="medium")
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
    # long texts make the figure higher instead of the panel smaller
    figure.set_figheight(figure.get_figheight() + 0.16 * (len(lines) + (len(handles) > 3)))
    return figure


# --- what is drawn ----------------------------------------------------------------------------------------------------


def _asked(ds: xr.Dataset, quantity: str | None) -> xr.DataArray:
    if not ds.data_vars:
        raise MapError("the sweep holds no quantity")
    known = {name: one for one in ds.data_vars.values() for name in (_quantity(one), str(one.name))}
    if quantity is None:
        return next(iter(known.values()))
    if quantity not in known:
        raise MapError(f"{one_line(quantity)}: is not in the sweep{near_or_all(quantity, known)}")
    return known[quantity]


def _is_number(row: xr.DataArray) -> bool:
    return row.dtype.kind in "fiu"  # or the names of loads


def _quantity(variable: xr.DataArray) -> str:
    return str(variable.attrs.get("quantity", variable.name))


def _cut(variable: xr.DataArray, at: dict[str, float | str]) -> tuple[xr.DataArray, list[str]]:
    """The quantity along the axes that are drawn, and in print what all others are."""
    dims, name = [str(dim) for dim in variable.dims], variable.name
    if not dims:
        raise MapError(f"{name}: is a single number, {variable.to_numpy():g}; there is nothing to draw")
    for axis in at:
        if axis not in dims:
            raise MapError(f"{one_line(axis)}: is no axis of {name}{near_or_all(axis, dims)}")
    variable = variable.isel({dim: _nearest(variable[dim], value) for dim, value in at.items()})
    variable = variable.isel({dim: 0 for dim in variable.dims if np.all(variable[dim] == variable[dim][0])})
    left = [str(dim) for dim in variable.dims]
    if not left:
        raise MapError(f"{name}: every axis has a single value; there is nothing to draw")
    if len(left) > 2:
        spans = "; ".join(_axis_told(variable[dim]) for dim in left)
        raise MapError(f"{name}: choose a value for {len(left) - 2} of its {len(left)} axes: {spans}")
    told = []
    for dim, row in variable.coords.items():
        if row.ndim == 0:
            told.append(_entry(row) if _is_number(row) else f"{_label(row)} = {_entry(row)}")
            if str(dim) in at and _is_number(row) and not math.isclose(float(at[str(dim)]), row, rel_tol=1e-6):
                told[-1] += f" (nearest to {_value(row, float(at[str(dim)]))})"
    return variable, told


def _nearest(row: xr.DataArray, wanted: float | str) -> int:
    """The place on an axis nearest to a value."""
    values, said = row.to_numpy(), f"{row.name} = {one_line(str(wanted))}: is"
    if not _is_number(row):
        names = [str(value) for value in values]
        if wanted not in names:
            raise MapError(f"{said} not in the sweep{near_or_all(str(wanted), names)}")
        return names.index(str(wanted))
    try:
        number = float(wanted)
    except ValueError:
        number = math.nan
    # beyond the ends by at most the spacing of the values there
    ordered = np.sort(values)
    before, behind = (float(np.ptp(ends)) for ends in (ordered[:2], ordered[-2:]))
    if not ordered[0] - before <= number <= ordered[-1] + behind:
        raise MapError(f"{said} outside of the sweep: {_axis_told(row)}")
    return int(np.argmin(np.abs(values - number)))


def _axis_told(row: xr.DataArray) -> str:
    if not _is_number(row):
        return f"{row.name} ({', '.join(one_line(str(value)) for value in row.to_numpy())})"
    unit = row.attrs.get("units", "1")
    return f"{row.name} ({float(row.min()):g} to {float(row.max()):g}{'' if unit == '1' else f' {unit}'})"


def _arranged(variable: xr.DataArray) -> list[str]:
    """The horizontal axis, then the vertical one, or that with a curve for each value."""
    names = [str(dim) for dim in variable.dims]
    names.sort(key=lambda name: _ACROSS.index(name) if name in _ACROSS else len(_ACROSS))
    names.sort(key=lambda name: not _is_number(variable[name]))
    if len(names) == 2 and variable.sizes[names[0]] <= _FEW < variable.sizes[names[1]]:
        names.reverse()
    return names


# --- words and units --------------------------------------------------------------------------------------------------


def _label(array: xr.DataArray) -> str:
    """What a quantity or an axis is called, with its symbol: stores of before have its meaning alone."""
    return str(array.attrs.get("label") or _no_formula(str(array.attrs.get("long_name", array.name))))


def _symbol(row: xr.DataArray) -> str:
    label = _label(row)
    return label[label.index("$") :] if label.endswith("$") else label


def _value(row: xr.DataArray, value: Any) -> str:
    unit = row.attrs.get("units", "1")
    if isinstance(value, str):
        return _no_formula(value)
    return written(value, _printed(unit))


def _no_formula(text: str) -> str:
    """One line in which nothing is a formula."""
    return one_line(text).replace("$", r"\$")


def _printed(unit: str) -> str:
    """An SI unit as it is, one of the paper as a formula; nothing for a plain number."""
    if unit in PREFIXED:
        return unit
    return "$" + re.sub(r"\b(pi|mu|theta)\b ?", r"\\\1 ", unit.replace("F_N0", "F_{N0}")) + "$"


def _show(axis: Axis, array: xr.DataArray) -> None:
    """Label an axis on which values of a quantity or of an axis of the sweep stand."""
    show_units(axis, words=_label(array), unit=_printed(str(array.attrs.get("units", "1"))))


# --- axes and scales --------------------------------------------------------------------------------------------------


def _stretch(axes: Axes, side: str, row: xr.DataArray) -> np.ndarray:
    """Stretch an axis as the sweep has spaced its values; these values in the unit of the axis."""
    axis, values = getattr(axes, f"{side}axis"), row.to_numpy()
    if not _is_number(row):
        axis.set_ticks(np.arange(values.size), [_no_formula(str(value)) for value in values])
        axes.set(**{f"{side}label": _label(row)})
        return np.arange(values.size)
    values, spacing = values.astype(float), row.attrs.get("spacing", "linear")
    axes.set(**{f"{side}lim": values[[0, -1]]})
    bounded = spacing == "logit" and values[0] < 0.0  # k, between -1 and 1
    scale: Style = {"functions": (lambda x: np.arctanh(np.clip(x, -_ALMOST, _ALMOST)), np.tanh)}
    getattr(axes, f"set_{side}scale")("function" if bounded else spacing, **(scale if bounded else {}))
    if spacing != "logit":
        _show(axis, row)
        return values
    axis.set_label_text(_label(row))
    if bounded:
        axis.set_major_locator(FixedLocator([-0.999, -0.99, -0.9, 0.0, 0.9, 0.99, 0.999]))
    return values


def _cell_edges(axis: Any, values: np.ndarray) -> np.ndarray:
    """Where the cells around the values end: halfway on the scale of the axis; the outer ones with the values."""
    scale = axis.get_transform()
    u = scale.transform(values)
    return np.concatenate([values[:1], scale.inverted().transform(0.5 * (u[1:] + u[:-1])), values[-1:]])


def _norm(variable: xr.DataArray) -> Normalize:
    """The scale of values: logarithmic beyond two decades, centred on zero for both signs, without infinite ones."""
    values, share = variable.to_numpy().astype(float), variable.attrs.get("units", "1") == "1"
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return Normalize(0.0, 1.0)
    lower, upper, size = float(finite.min()), float(finite.max()), float(np.abs(finite).max())
    if np.any(np.isinf(values)):
        size = float(np.quantile(np.abs(finite), 0.99))
        lower, upper = max(lower, -size), min(upper, size)
    if lower < -1e-6 * size and upper > 1e-6 * size:  # smaller values are rounding errors
        usual = float(np.median(np.abs(finite)))
        return AsinhNorm(usual, -size, size) if size > 30.0 * usual > 0.0 else Normalize(-size, size)
    least = float(np.min(finite, where=finite > 0.0, initial=math.inf))
    if lower >= 0.0 and upper > 100.0 * least and not (share and upper <= 1.0):
        return LogNorm(least, upper)
    return Normalize(lower, upper) if lower < upper else Normalize(lower - 0.5, upper + 0.5)


# --- curves and maps --------------------------------------------------------------------------------------------------


def _draw_curves(axes: Axes, variable: xr.DataArray, across: str, other: str, contours: int) -> list[Any]:
    """Draw one curve, or one for each value of the other axis; the entries of the legend."""
    x, values = _stretch(axes, "x", variable[across]), np.atleast_2d(variable.to_numpy().astype(float))
    norm = _norm(variable)
    style = {"marker": "o", "markersize": 3.0} if x.size <= 12 else {}
    if not _is_number(variable[across]):
        style["linestyle"] = ""
    axes.set_prop_cycle(**_CURVES)
    for place, row in enumerate(values):
        axes.plot(x, row, label=_entry(variable[other][place]) if other else None, **style)
    if isinstance(norm, LogNorm):
        axes.set_yscale("log")
    elif isinstance(norm, AsinhNorm):
        axes.set_yscale("asinh", linear_width=norm.linear_width)
    _show(axes.yaxis, variable)
    if variable.dtype.kind == "b":
        axes.set_yticks([0.0, 1.0], ["no", "yes"])
    return axes.get_legend_handles_labels()[0]


def _entry(row: xr.DataArray) -> str:
    value = row.item()
    return _no_formula(value) if isinstance(value, str) else f"{_symbol(row)} = {_value(row, value)}"


def _relative(variable: xr.DataArray, other: str) -> xr.DataArray:
    """A map of the wear volume over that of k = 0, if it has that, wherever there is any wear."""
    if _quantity(variable) != "wear_volume" or "k" not in variable.dims or np.abs(variable.k).min() > 1e-9:
        return variable
    base = variable.sel(k=0.0, method="nearest", drop=True)
    wears = np.flatnonzero(base != 0.0)
    ratio = (variable / base).isel({other: wears}).transpose(*variable.dims)
    return ratio.assign_attrs(variable.attrs, units="1", label=r"wear volume $\Delta V/\Delta V(k=0)$")


def _draw_map(axes: Axes, variable: xr.DataArray, across: str, upwards: str, contours: int) -> list[Any]:
    """Draw colours, contour lines and the optimum; the entries of the legend."""
    given, variable = variable, _relative(variable, upwards if across == "k" else across)
    norm = _norm(variable) if variable is given else LogNorm(1.0 / _MOST, _MOST)
    x, y, values = _stretch(axes, "x", variable[across]), _stretch(axes, "y", variable[upwards]), variable.to_numpy()
    values, yes_or_no = values.astype(float), variable.dtype.kind == "b"
    signed = variable is not given or norm.vmin == -(norm.vmax or 0.0)
    # matplotlib leaves out infinite values; here they get the colours of those beyond the scale, and zero the lowest
    most = 10.0 * np.abs(norm.vmax or 1.0)
    shown = np.clip(values, norm.vmin if isinstance(norm, LogNorm) else -most, most)
    beyond = "both" if variable is not given or np.isinf(values).any() else "neither"
    colours: Any = ListedColormap(["#F6D3A3", BLUE]) if yes_or_no else "RdBu_r" if signed else "viridis"
    axes.set_facecolor(_BLANK)
    edges = _cell_edges(axes.xaxis, x), _cell_edges(axes.yaxis, y)
    mesh = axes.pcolormesh(*edges, shown, norm=norm, cmap=colours, rasterized=True)
    bar = axes.figure.colorbar(mesh, ax=axes, pad=0.02, aspect=22, extend=beyond)
    if not isinstance(norm, LogNorm | AsinhNorm):
        bar.locator = MaxNLocator(max(contours, 2))
    _show(bar.ax.yaxis, variable)
    if yes_or_no:
        bar.set_ticks([0.25, 0.75], labels=["no", "yes"])
    seen = values[np.isfinite(values)]
    levels = [level for level in bar.ax.get_yticks() if seen.size and seen.min() < level < seen.max()]
    if contours and levels and not yes_or_no:
        ink = ["k" if signed or norm(level) > 0.5 else "w" for level in levels]
        lines = axes.contour(x, y, np.ma.masked_invalid(values), levels=levels, colors=ink, linewidths=0.5)
        axes.clabel(lines, fontsize=6, inline_spacing=2, fmt=bar.ax.yaxis.get_major_formatter())
    return _draw_least(axes, variable, x, y) if _quantity(variable) in _WEARS else []


def _draw_least(axes: Axes, variable: xr.DataArray, x: np.ndarray, y: np.ndarray) -> list[Any]:
    """Draw the exponent of least wear for each amplitude, or the design of least wear, and where a little more is worn.

    They are those of the values on the map: the lowest one, and between rows the vertex of the parabola through it and
    its neighbours.
    """
    (upwards, across), values = variable.dims, np.nan_to_num(variable.to_numpy().astype(float), nan=np.inf)
    if upwards == "k" and across in ("phi", "tangential_force"):
        least, row = np.min(values, axis=0), np.argmin(values, axis=0)
        middle = np.clip(row, 1, y.size - 2)
        before, at, behind = (values[middle + step, np.arange(x.size)] for step in (-1, 0, 1))
        with np.errstate(all="ignore"):
            vertex = 0.5 * (before - behind) / (before - 2.0 * at + behind)
        row_of = np.where((np.abs(vertex) < 1.0) & (before + behind > 2.0 * at), middle + vertex, row)
        scale = axes.yaxis.get_transform()
        best = scale.inverted().transform(np.interp(row_of, np.arange(y.size), scale.transform(y)))
        best[np.isinf(least) | (least == values.max(axis=0))] = np.nan
        best[1:][np.abs(np.diff(row)) > 0.25 * y.size] = np.nan  # no step across where the other end wears less
        handles = axes.plot(x, best, label="least wear, $k^*$", clip_on=False, **_LEAST)
    elif {across, upwards} <= {"k", "E0", "z0"} and np.min(values) < np.max(values):
        least, (row, column) = np.min(values), np.unravel_index(np.argmin(values), values.shape)
        handles = axes.plot(x[column], y[row], "*", label="least wear", **_STAR)
    else:
        return []
    with np.errstate(all="ignore"):
        more = np.ma.masked_invalid(values / least - 1.0)
    if more.count() and more.min() < _MORE < more.max():
        style = {"colors": "w", "linewidths": 1.0, "linestyles": "dashed", "zorder": 4}
        axes.contour(x, y, more, levels=[_MORE], **style).set_path_effects(_EDGE)
        handles += axes.plot([], [], **_LEAST | {"linestyle": "--", "linewidth": 1.0, "label": "5 % more wear"})
    return handles
