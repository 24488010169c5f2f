"""Pictures of sweeps for print: curves, and maps with contour lines.

Needs the extras `sweep` and `plots`. A store may hold a map of any size: along each axis only as many values are read
as can be seen. Labels, units and the spacing of the axes are those that the sweep stores.
"""

import itertools
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
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.scale import FuncScale
from matplotlib.ticker import FixedLocator, MaxNLocator, NullFormatter

from plgwear_jax._core.units import PREFIXED, written
from plgwear_jax._core.words import GivenError, near_or_all, one_line
from plgwear_jax.sweep.names import variable_name
from plgwear_jax.tables import number_in

from .style import BLUE, DASH_DOT, DASHED, DOTTED, GREEN, ORANGE, Style, page, picture, show_units

__all__ = ["MapError", "map_picture"]

_FEW = 6  # most curves that can be told apart; more are drawn as a map
_SEEN = 1000  # most values along a side of a picture, whose print is some 700 dots wide
_CONTOURS = 8  # about as many lines
_LONGEST = 50  # characters of a label, also of formulas, beside a panel
_ALMOST = 1.0 - 1e-15
_BLANK, _FIRM = "0.86", "\N{NO-BREAK SPACE}"
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


class MapError(GivenError):
    """Why a picture cannot be drawn, in one line."""


@picture
def map_picture(ds: xr.Dataset, quantity: str | None = None, *, at: Mapping[str, float | str] | None = None) -> Figure:
    """Draw a quantity of a sweep: a curve over one axis, a few curves, or a map over two axes.

    A map of the wear volume over k shows it over that of k = 0, if that is among the values. On a map of the wear over
    k and the amplitude, a line marks the exponent that wears least, and a dashed line where 5 % more is worn; on one
    over two of k, E0 and z0 a star marks the least wear. Both are as exact as the map.

    Args:
        ds: What `sweep.sweep` or `sweep.open_sweep` returned; only what is drawn is read.
        quantity: Its name, "wear_volume.dk" or "wear_volume_dk"; by default the first one.
        at: Values of axes that are not drawn, in the units of the sweep, or the name of a load; the nearest values of
            the sweep are taken. All axes but two have to be among them, except those with a single value.

    Returns:
        A figure 8.6 cm wide; `plots.save` writes it.

    Raises:
        MapError: There is no such quantity or axis, or more than two axes are left; one line.
    """
    known = [str(one.attrs.get("quantity", one.name)) for one in ds.data_vars.values()]
    if not known:
        raise MapError("the sweep holds no quantity")
    name = variable_name(known[0] if quantity is None else quantity)
    if name not in ds:
        raise MapError(f"{one_line(str(quantity))}: is not in the sweep{near_or_all(str(quantity), known)}")
    variable, told = _cut(ds[name], at or {})
    is_map = variable.ndim == 2 and len(variable) > _FEW
    seen = {dim: np.linspace(0, n - 1, min(_SEEN, n)).round().astype(int) for dim, n in variable.sizes.items()}
    variable = variable.sortby([dim for dim in seen if _is_number(variable[dim])]).isel(seen).compute()
    figure = page(8.6, 6.6 if is_map else 6.1)
    axes = figure.subplots()
    handles = _draw_map(axes, variable) if is_map else _draw_curves(axes, variable)
    if variable.isnull().any():
        missing = "not computed yet" if ds.attrs.get("unfinished") else "undefined"
        handles.append(Patch(facecolor=_BLANK if is_map else "w", label=f"{'grey' if is_map else 'gaps'}: {missing}"))
    equation = f", Eq. ({variable.attrs['equation']})" if "equation" in variable.attrs else ""
    firm = [one.replace(" ", _FIRM) for one in told]  # no line ends between a symbol, its number and its unit
    lines = _lines(", ".join([variable.attrs["label"] + equation.replace(" ", _FIRM), *firm]), 66)
    figure.suptitle("\n".join(lines), x=0.02, ha="left", fontsize="medium")
    columns = 2 if any(len(str(handle.get_label())) > 13 for handle in handles) else 3
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=columns)
    # long texts make the figure higher instead of the panel smaller
    figure.set_figheight(figure.get_figheight() + 0.16 * (len(lines) + max(len(handles) - 1, 0) // columns))
    return figure


# --- what is drawn ----------------------------------------------------------------------------------------------------


def _is_number(row: xr.DataArray) -> bool:
    return row.dtype.kind in "fiu"  # or the names of loads


def _cut(variable: xr.DataArray, at: Mapping[str, float | str]) -> tuple[xr.DataArray, list[str]]:
    """The quantity along the axes that are drawn, the horizontal one last, and in print what all others are."""
    dims, name = [*map(str, variable.dims)], variable.name
    for axis in at:
        if axis not in dims:
            raise MapError(f"{one_line(axis)}: is no axis of {name}{near_or_all(axis, dims)}")
    variable = variable.isel({dim: _nearest(variable[dim], value) for dim, value in at.items()})
    variable = variable.squeeze()
    if variable.ndim == 0:
        raise MapError(f"{name}: is a single number, {float(variable):g}; there is nothing to draw")
    if variable.ndim > 2:
        spans = "; ".join(_axis_told(variable[dim]) for dim in variable.dims)
        raise MapError(f"{name}: choose a value for {variable.ndim - 2} of its {variable.ndim} axes: {spans}")
    told = []
    for dim, row in sorted(variable.coords.items(), key=str):  # a store tells them in any order
        if row.ndim == 0:
            told.append(_place_told(row))
            wanted = at.get(str(dim), row.item())
            if _is_number(row) and not math.isclose(float(wanted), row, rel_tol=1e-6):
                told[-1] += f" (nearest to {_value(row, float(wanted))})"
    # The vertical axis, or that with a curve for each value, then the horizontal one.
    order = *_ACROSS, *variable.dims
    ranked = sorted(
        variable.dims, key=lambda dim: (variable[dim].size > _FEW, _is_number(variable[dim]), -order.index(dim))
    )
    return variable.transpose(*ranked), told


def _nearest(row: xr.DataArray, wanted: float | str) -> int:
    """The place on an axis nearest to a value."""
    values, said = row.to_numpy(), f"{row.name} = {one_line(str(wanted))}: is"
    if not _is_number(row):
        names = [*map(str, values)]
        if wanted not in names:
            raise MapError(f"{said} not in the sweep{near_or_all(str(wanted), names)}")
        return names.index(str(wanted))
    number, ordered = number_in(str(wanted)), np.sort(values)
    # beyond the ends by at most the spacing of the values there
    if number is None or not ordered[0] - np.ptp(ordered[:2]) <= number <= ordered[-1] + np.ptp(ordered[-2:]):
        raise MapError(f"{said} outside of the sweep: {_axis_told(row)}")
    return int(np.argmin(np.abs(values - number)))


def _axis_told(row: xr.DataArray) -> str:
    if not _is_number(row):
        return f"{row.name} ({', '.join(one_line(str(value)) for value in row.to_numpy())})"
    unit = row.attrs["units"]
    return f"{row.name} ({float(row.min()):g} to {float(row.max()):g}{'' if unit == '1' else f' {unit}'})"


# --- words and units --------------------------------------------------------------------------------------------------


def _place_told(row: xr.DataArray) -> str:
    """The symbol, or else the name, and the value of an axis that has one."""
    words, formula, symbol = row.attrs["label"].partition("$")
    return f"{formula}{symbol or words} = {_value(row, row.item())}"


def _value(row: xr.DataArray, value: Any) -> str:
    if not _is_number(row):
        return _no_formula(value)
    return re.sub(r"(?<=\d)e\+?(-?)0?(\d+)", r"$\\times 10^{\1\2}$", written(value, _printed(row)))


def _no_formula(text: str) -> str:
    """One line in which nothing is a formula."""
    return one_line(text).replace("$", r"\$")


def _printed(array: xr.DataArray) -> str:
    """A unit of SI as it is, one of the paper as a formula."""
    unit = array.attrs["units"]
    if unit in PREFIXED:
        return unit
    if re.fullmatch(r"(m|N|Pa|J|[^A-Za-z])*", unit):  # of SI, upright
        return rf"$\mathrm{{{unit}}}$"
    return "$" + re.sub(r"\b(pi|mu|theta)\b ?", r"\\\1 ", unit.replace("F_N0", "F_{N0}")) + "$"


def _lines(text: str, width: int) -> list[str]:
    """The lines of a text, none of which ends within a formula."""
    firm = re.sub(r"\$.*?\$", lambda formula: formula[0].replace(" ", _FIRM), text)
    return [line.replace(_FIRM, " ") for line in textwrap.wrap(firm, width, break_long_words=False)]


def _show(axis: Axis, array: xr.DataArray) -> None:
    """Label an axis on which values of a quantity or of an axis of the sweep stand."""
    label = array.attrs["label"]
    if len(label) > _LONGEST:  # the title has its words
        label = label[max(label.find("$"), 0) :]
    show_units(axis, words=label, unit=_printed(array))
    axis.set_label_text("\n".join(_lines(axis.get_label_text(), _LONGEST)))


# --- axes and scales --------------------------------------------------------------------------------------------------


def _stretch(axes: Axes, side: str, row: xr.DataArray) -> np.ndarray:
    """Stretch an axis as the sweep has spaced its values; these values in the unit of the axis."""
    axis, values = getattr(axes, f"{side}axis"), row.to_numpy()
    axis.set_label_text(row.attrs["label"])
    if not _is_number(row):
        axis.set_ticks(np.arange(values.size), [*map(_no_formula, values)])
        return np.arange(values.size)
    values, spacing = values.astype(float), row.attrs.get("spacing", "linear")
    bounded = spacing == "logit" and values[0] < 0.0  # k, between -1 and 1
    atanh = FuncScale(axis, (lambda x: np.arctanh(np.clip(x, -_ALMOST, _ALMOST)), np.tanh))
    ends = values[[0, -1]] if np.ptp(values) else None
    axes.set(**{f"{side}lim": ends, f"{side}scale": atanh if bounded else spacing})
    _show(axis, row)
    if spacing == "logit":
        lowest = -1.0 if bounded else 0.0
        wide = min(values[0] - lowest, 1.0 - values[-1]) < 3e-4  # more numbers would touch each other
        apart = np.array([1e-3] if wide else [1e-3, 1e-2, 0.1])
        axis.set_major_locator(FixedLocator([*(lowest + apart), 0.5 * (lowest + 1.0), *(1.0 - apart)]))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    return values


def _between(axis: Any, values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The values of an axis at places counted from 0, also between them, on its scale; beyond the ends those."""
    scale = axis.get_transform()
    return scale.inverted().transform(np.interp(places, np.arange(values.size), scale.transform(values)))


def _norm(variable: xr.DataArray) -> Normalize:
    """The scale of values: logarithmic beyond two decades, centred on zero for both signs, without infinite ones."""
    values = variable.to_numpy().astype(float)
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return Normalize(0.0, 1.0)
    size = np.quantile(np.abs(finite), 0.99 if np.isinf(values).any() else 1.0)
    lower, upper = np.clip([finite.min(), finite.max()], -size, size)
    if lower < -1e-6 * size and upper > 1e-6 * size:  # smaller values are rounding errors
        usual = np.median(np.abs(finite))
        return AsinhNorm(usual, -size, size) if size > 30.0 * usual > 0.0 else Normalize(-size, size)
    least, share = finite[finite > 0.0].min(initial=np.inf), variable.attrs["units"] == "1" and upper <= 1.0
    if lower >= 0.0 and upper > 100.0 * least and not share:
        return LogNorm(least, upper)
    return Normalize(lower, upper) if lower < upper else Normalize(lower - 0.5, upper + 0.5)


# --- curves and maps --------------------------------------------------------------------------------------------------


def _draw_curves(axes: Axes, variable: xr.DataArray) -> list[Any]:
    """Draw one curve, or one for each value of the other axis; the entries of the legend."""
    *other, across = (variable[dim] for dim in variable.dims)
    x, norm = _stretch(axes, "x", across), _norm(variable)
    labels = [_place_told(one) if _is_number(one) else _value(one, one.item()) for row in other for one in row]
    # Points on the frame are whole, unless there is 0, which a logarithmic axis would draw far below it.
    style: Style = {"marker": "o", "markersize": 3.0, "clip_on": not variable.min()} if x.size <= 12 else {}
    if not _is_number(across):
        style["linestyle"] = ""
    axes.set_prop_cycle(**_CURVES)
    lines = axes.plot(x, variable.astype(float).T, label=labels or None, **style)
    if isinstance(norm, LogNorm):
        axes.set_yscale("log")
    elif isinstance(norm, AsinhNorm):
        axes.set_yscale("asinh", linear_width=norm.linear_width)
    _show(axes.yaxis, variable)
    if variable.dtype.kind == "b":
        axes.set_yticks([0.0, 1.0], ["no", "yes"])
    return lines if other else []


def _middles(axes: Axes, lines: ContourSet) -> Any:
    """Where the numbers of contours stand, (n, 2): at their middles, unless they crowd, as at the edge most of all."""
    of_axes, places = axes.transAxes.inverted(), []
    pieces = (axes.transData.transform_path(path).to_polygons(closed_only=False) for path in lines.get_paths())
    for piece in map(of_axes.transform, itertools.chain.from_iterable(pieces)):
        length = np.append(0.0, np.cumsum(np.hypot(*np.diff(piece, axis=0).T)))
        middle = [np.interp(0.5 * length[-1], length, along) for along in piece.T]
        apart = min([math.dist(middle, other) for other in places], default=1.0)
        if length[-1] > 0.15 and apart > 0.06 and np.abs(np.subtract(middle, 0.5)).max() < 0.47:
            places.append(middle)
    return (axes.transAxes - axes.transData).transform(places) if places else []


def _draw_map(axes: Axes, variable: xr.DataArray) -> list[Any]:
    """Draw colours, contour lines and the optimum; the entries of the legend."""
    yes_or_no, (upwards, across) = variable.dtype.kind == "b", variable.dims
    relative = variable.name == "wear_volume" and "k" in variable.dims and np.abs(variable.k).min() <= 1e-9
    if relative:  # over that of k = 0, wherever there is any wear
        base = variable.sel(k=0.0, method="nearest", drop=True)
        about = variable.attrs | {"units": "1", "label": r"wear volume $\Delta V/\Delta V(k=0)$"}
        variable = (variable / base).where(base != 0.0, drop=True).assign_attrs(about)
    norm = LogNorm(1.0 / _MOST, _MOST) if relative else _norm(variable)
    x, y = _stretch(axes, "x", variable[across]), _stretch(axes, "y", variable[upwards])
    values, most = variable.to_numpy().astype(float), np.abs(norm.vmax or 1.0)
    signed = relative or norm.vmin == -most
    # matplotlib leaves out infinite values; here they get the colours of those beyond the scale, and zero the lowest
    shown = np.clip(values, norm.vmin if isinstance(norm, LogNorm) else -10.0 * most, 10.0 * most)
    beyond = "both" if relative or np.isinf(values).any() else "neither"
    colours: Any = ListedColormap(["#F6D3A3", BLUE]) if yes_or_no else "RdBu_r" if signed else "viridis"
    axes.set_facecolor(_BLANK)
    edges = (_between(axis, row, np.arange(row.size + 1) - 0.5) for axis, row in ((axes.xaxis, x), (axes.yaxis, y)))
    mesh = axes.pcolormesh(*edges, shown, norm=norm, cmap=colours, rasterized=True)
    bar = axes.figure.colorbar(mesh, ax=axes, pad=0.02, aspect=22, extend=beyond)
    if not isinstance(norm, LogNorm | AsinhNorm):
        bar.locator = MaxNLocator(_CONTOURS)
    _show(bar.ax.yaxis, variable)
    if yes_or_no:
        bar.set_ticks([0.25, 0.75], labels=["no", "yes"])
        return []
    seen = values[np.isfinite(values)]
    levels = [level for level in bar.ax.get_yticks() if seen.size and seen.min() < level < seen.max()]
    if levels:
        ink = ["k" if signed or norm(level) > 0.5 else "w" for level in levels]
        lines = axes.contour(x, y, values, levels=levels, colors=ink, linewidths=0.5, linestyles="solid")
        axes.clabel(
            lines, fontsize=6, inline_spacing=4, fmt=bar.ax.yaxis.get_major_formatter(), manual=_middles(axes, lines)
        )
    return _draw_least(axes, variable, x, y) if variable.name in _WEARS else []


@np.errstate(all="ignore")
def _draw_least(axes: Axes, variable: xr.DataArray, x: np.ndarray, y: np.ndarray) -> list[Any]:
    """Draw the exponent of least wear for each amplitude, or the design of least wear, and where a little more is worn.

    They are those of the values on the map: the lowest one, and between rows the vertex of the parabola through it and
    its neighbours.
    """
    (upwards, across), values = variable.dims, variable.fillna(np.inf).to_numpy().astype(float)
    if upwards == "k" and across in ("phi", "tangential_force"):
        row = values.argmin(axis=0)
        near = np.clip(row + np.array([[-1], [0], [1]]), 0, y.size - 1)
        before, least, behind = np.take_along_axis(values, near, axis=0)
        vertex = 0.5 * (before - behind) / (before - 2.0 * least + behind)
        best = _between(axes.yaxis, y, row + np.nan_to_num(vertex))
        best[np.isinf(least) | (least == values.max(axis=0))] = np.nan
        best[1:][np.abs(np.diff(row)) > 0.25 * y.size] = np.nan  # no step across where the other end wears less
        handles = axes.plot(x, best, label="least wear, $k^*$", clip_on=False, **_LEAST)
    elif {across, upwards} <= {"k", "E0", "z0"} and values.min() < values.max():
        least, (row, column) = values.min(), np.unravel_index(values.argmin(), values.shape)
        handles = axes.plot(x[column], y[row], "*", label="least wear", **_STAR)
    else:
        return []
    more = np.ma.masked_invalid(values / least - 1.0)
    if more.count() and more.min() < _MORE < more.max():
        edge = axes.contour(x, y, more, levels=[_MORE], colors="w", linewidths=1.0, linestyles="dashed", zorder=4)
        edge.set_path_effects(_EDGE)
        handles += axes.plot([], [], **_LEAST | {"linestyle": "--", "linewidth": 1.0, "label": "5 % more wear"})
    return handles
