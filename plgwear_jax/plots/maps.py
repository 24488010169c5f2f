"""Pictures of sweeps for print: curves, and maps with contour lines.

Needs the extras `sweep` and `plots`. A store may hold a map of any size: along each axis only as many values are read
as can be seen.
"""

import math
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import AsinhNorm, CenteredNorm, Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator, NullLocator

from plgwear_jax import fretting
from plgwear_jax._core.catalogue import AXES
from plgwear_jax._core.units import PREFIXED, readable
from plgwear_jax._core.words import near_or_all, one_line
from plgwear_jax.plots.style import (
    BEST,
    CENTIMETRE,
    LABEL_SIZE,
    REFERENCE,
    TICK_SIZE,
    for_print,
    labelled,
    plain_ticks,
)
from plgwear_jax.sweep.plan import LOAD, in_precision

__all__ = ["MapError", "map_picture"]

_FEW = 6  # most curves that can be told apart; more are drawn as a map
_SEEN = 750  # most values along a side of a map, whose print is some 700 dots wide
_SEEN_OF_CURVE = 1500
_DECADES = 2.0  # values over more decades need a logarithmic scale
_BLANK = "0.86"

# Colours of Okabe and Ito; dashes besides, for grey prints.
_CURVES: tuple[dict[str, Any], ...] = (
    BEST,
    REFERENCE,
    {"color": "#009E73", "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 1.4},
    {"color": "#AA4499", "linestyle": (0, (1, 1.2)), "linewidth": 1.6},
    {"color": "k", "linestyle": (0, (9, 2)), "linewidth": 1.0},
    {"color": "#E69F00", "linestyle": (0, (3, 1.2, 1, 1.2, 1, 1.2)), "linewidth": 1.6},
)
_OPTIMUM: dict[str, Any] = {
    "color": "#C2260B",
    "linewidth": 1.6,
    "zorder": 5,
    "path_effects": [withStroke(linewidth=2.8, foreground="w")],
}
_AT_BOUND: dict[str, Any] = {  # on the frame, not behind it
    **{name: _OPTIMUM[name] for name in ("color", "zorder")},
    "linewidth": 2.0,
    "linestyle": (0, (1, 1)),
    "clip_on": False,
}
_YES, _NO = "#0072B2", "#F6D3A3"


class MapError(ValueError):
    """Why a picture cannot be drawn, in one line."""


def map_picture(
    ds: xr.Dataset,
    quantity: str | None = None,
    *,
    at: Mapping[str, float | str] | None = None,
    contours: int = 8,
) -> Figure:
    """Draw a quantity of a sweep: a curve over one axis, a few curves, or a map over two axes.

    On a map of the wear over k and the amplitude, a line marks the exponent that wears least.

    Args:
        ds: What `sweep.sweep` or `sweep.open_sweep` returned; only what is drawn is read.
        quantity: Its name; by default the first one.
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
    rows = [_row(variable, str(dim)) for dim in variable.dims]
    across, other = _arranged(rows)
    most = _SEEN_OF_CURVE if other is None or other.few else _SEEN
    across = across.thinned(most)
    if other is not None:
        other = other.thinned(_SEEN)
    drawn = [row for row in (across, other) if row is not None]
    chosen = variable.isel({row.name: row.places for row in drawn}).transpose(*(row.name for row in reversed(drawn)))
    values = np.atleast_2d(chosen.to_numpy())
    missing = "not computed yet" if ds.attrs.get("unfinished") else "undefined"

    is_map = other is not None and not other.few
    figure = Figure(figsize=(8.6 * CENTIMETRE, (7.0 if is_map else 6.5) * CENTIMETRE), dpi=300, layout="constrained")
    axes = figure.subplots()
    subject = _Subject(variable, values, ds, missing)
    if other is None or other.few:
        handles = _draw_curves(axes, subject, across, other)
    else:
        handles = _draw_map(figure, axes, subject, across, other, contours)
    for_print(axes)
    if across.names is not None:
        axes.tick_params(axis="x", which="both", top=False, bottom=False)
    title, rows_needed = _title(variable, told), 0
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


# --- what is drawn --------------------------------------------------------------------------------------------------


def _asked(ds: xr.Dataset, quantity: str | None) -> xr.DataArray:
    names = [str(name) for name in ds.data_vars]
    if not names:
        raise MapError("the sweep holds no quantity")
    if quantity is None:
        return ds[names[0]]
    if quantity not in names:
        raise MapError(f"{one_line(quantity)}: is not in the sweep{near_or_all(quantity, names)}")
    return ds[quantity]


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
            told.append(_value_text(dim, variable, values[0]))
    left = [dim for dim in dims if dim not in places]
    if not left:
        raise MapError(f"{name}: every axis has a single value; there is nothing to draw")
    if len(left) > 2:
        spans = "; ".join(_span(dim, variable) for dim in left)
        raise MapError(f"{name}: choose a value for {len(left) - 2} of its {len(left)} axes: {spans}")
    if "k" in left:
        # printed, since a design may hold the contact radius by one of them
        held = (dim for dim in ("E0", "z0") if dim in variable.coords and variable[dim].ndim == 0)
        told += [_value_text(dim, variable, float(variable[dim])) for dim in held]
    return variable.isel(places), told


def _nearest(dim: str, variable: xr.DataArray, values: np.ndarray, wanted: float | str) -> tuple[int, str]:
    """The place on an axis nearest to a value, and its text."""
    if values.dtype.kind not in "fiu":
        names = [str(value) for value in values]
        if wanted not in names:
            raise MapError(f"{dim} = {one_line(str(wanted))}: is not in the sweep{near_or_all(str(wanted), names)}")
        return names.index(str(wanted)), _value_text(dim, variable, wanted)
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
    text = _value_text(dim, variable, values[place])
    if not math.isclose(float(values[place]), number, rel_tol=1e-6, abs_tol=1e-12 * abs(float(ordered[-1]))):
        text += f" (nearest to {_value_text(dim, variable, number).split(' = ')[1]})"
    return place, text


def _span(dim: str, variable: xr.DataArray) -> str:
    values = variable[dim]
    if values.dtype.kind not in "fiu":
        return f"{dim} ({', '.join(one_line(str(value)) for value in values.to_numpy())})"
    unit = values.attrs.get("units", "1")
    return f"{dim} ({float(values.min()):g} to {float(values.max()):g}{'' if unit == '1' else f' {unit}'})"


class _Subject(NamedTuple):
    """A quantity, its values with the rows from bottom to top, the sweep, and what a NaN means."""

    variable: xr.DataArray
    values: np.ndarray
    ds: xr.Dataset
    missing: str


# --- axes -----------------------------------------------------------------------------------------------------------


class _Spacing(NamedTuple):
    """The scale of an axis; `forward` makes values with this spacing even."""

    name: str
    forward: Callable[[Any], Any]
    inverse: Callable[[Any], Any]
    interval: tuple[float, float] = (-math.inf, math.inf)


def _same(x: Any) -> Any:
    return x


_LINEAR, _LOG = _Spacing("linear", _same, _same), _Spacing("log", np.log, np.exp, (0.0, math.inf))


def _logit(interval: tuple[float, float]) -> _Spacing:
    lower, upper = interval

    def forward(x: Any) -> Any:
        with np.errstate(divide="ignore", invalid="ignore"):  # matplotlib asks for the ends, too
            return np.log((x - lower) / (upper - x))

    def inverse(u: Any) -> Any:
        share = 0.5 + 0.5 * np.tanh(0.5 * np.abs(u))
        rest = (upper - lower) / (1.0 + np.exp(np.abs(u)))  # the distance from the nearer end keeps its digits
        return np.where(np.less(u, 0.0), lower + rest, np.where(share < 1.0, upper - rest, upper))

    return _Spacing("logit", forward, inverse, interval)


class _Row(NamedTuple):
    """An axis of the picture.

    Attributes:
        name: Of the axis of the sweep.
        places: The indices of the values that are drawn, in rising order of the values.
        values: These values, in the unit of the sweep; for names their numbers.
        factor: One printed unit in the unit of the sweep.
        label: Words, symbol and unit.
        symbol: Alone.
        unit: As it is printed.
        names: The values of an axis that holds names.
    """

    name: str
    places: np.ndarray
    values: np.ndarray
    factor: float
    label: str
    symbol: str
    unit: str
    names: list[str] | None = None

    @property
    def few(self) -> bool:
        return self.places.size <= _FEW

    @property
    def shown(self) -> np.ndarray:
        return self.values / self.factor

    def thinned(self, most: int) -> "_Row":
        """At most so many values, including both ends."""
        some = np.unique(np.linspace(0, self.places.size - 1, min(most, self.places.size)).round().astype(int))
        names = None if self.names is None else [self.names[place] for place in some]
        return self._replace(places=self.places[some], values=self.values[some], names=names)

    def spacing(self) -> _Spacing:
        """The scale on which the values are most evenly spaced; linear if they are nearly even on it."""
        found, least = _LINEAR, _unevenness(self.values)
        if self.names is not None or least < 0.02:
            return found
        for spacing in _stretched(self.name):
            lower, upper = spacing.interval
            if lower < self.values[0] and self.values[-1] < upper:
                uneven = _unevenness(spacing.forward(self.values.astype(float)))
                if uneven < 0.5 * least:
                    found, least = spacing, uneven
        return found


def _stretched(name: str) -> Sequence[_Spacing]:
    interval = AXES[name].interval if name in AXES else None
    return (_LOG,) if interval is None else (_LOG, _logit(interval))


def _unevenness(u: np.ndarray) -> float:
    """How far values are off even spacing, as a share of their range."""
    return float(np.max(np.abs((u - u[0]) / (u[-1] - u[0]) - np.linspace(0.0, 1.0, u.size))))


def _row(variable: xr.DataArray, dim: str) -> _Row:
    coordinate = variable[dim]
    values = coordinate.to_numpy()
    words, symbol = _axis_words(variable, dim)
    label = " ".join(filter(None, [words, f"${symbol}$" if symbol else ""]))
    if values.dtype.kind not in "fiu":
        names = [_plain(str(value)) for value in values]
        return _Row(dim, np.arange(values.size), np.arange(values.size), 1.0, label, symbol, "", names)
    steps = np.diff(values)
    if np.all(steps > 0.0):
        index = np.arange(values.size)
    elif np.all(steps < 0.0):
        index = np.arange(values.size)[::-1]
    else:
        index = np.unique(values, return_index=True)[1]
    row = _Row(dim, index, values[index], 1.0, label, symbol, "")
    factor, unit = _axis_unit(coordinate, row.thinned(_SEEN))
    if dim == "phi":
        label = r"amplitude $\varphi = F_x/(\mu F_N)$"
    return row._replace(factor=factor, unit=unit, label=labelled(label, unit))


def _axis_unit(coordinate: xr.DataArray, row: _Row) -> tuple[float, str]:
    unit = str(coordinate.attrs.get("units", "1"))
    if unit not in PREFIXED:
        return 1.0, _printed(unit)
    largest = float(np.max(np.abs(row.values)))
    if row.spacing().name == "log":
        largest = math.sqrt(float(row.values[0]) * float(row.values[-1]))
    return readable(largest, unit)


# Of two axes the one that comes first here is horizontal.
_ACROSS = ("r", "distance", "phi", "tangential_force", "k", "depth", "normal_force", "radius", "z0", "E0", "nu")


def _arranged(rows: list[_Row]) -> tuple[_Row, _Row | None]:
    """The horizontal axis, and the vertical one, or the one with a curve for each value."""
    if len(rows) == 1:
        return rows[0], None

    def rank(row: _Row) -> int:
        if row.names is not None:
            return len(_ACROSS) + 1
        return _ACROSS.index(row.name) if row.name in _ACROSS else len(_ACROSS)

    first, second = sorted(rows, key=rank)
    if second.few and (second.names is not None or not first.few or second.places.size <= first.places.size):
        return first, second
    return (second, first) if first.few else (first, second)


def _scale(axes: Axes, side: str, row: _Row) -> None:
    """Stretch an axis as its values are spaced, from the first of them to the last."""
    axis: Axis = getattr(axes, f"{side}axis")
    set_scale, set_limits = getattr(axes, f"set_{side}scale"), getattr(axes, f"set_{side}lim")
    getattr(axes, f"set_{side}label")(row.label, fontsize=LABEL_SIZE)
    if row.names is not None:
        axis.set_ticks(row.values, row.names)
        set_limits(-0.5, row.values.size - 0.5)
        return
    spacing = row.spacing()
    if spacing.name == "log":
        set_scale("log")
    elif spacing.name == "logit":
        if spacing.interval == (0.0, 1.0):
            set_scale("logit")
        else:
            set_scale("function", functions=(spacing.forward, spacing.inverse))
    set_limits(row.shown[0], row.shown[-1])
    if spacing.name == "log":
        plain_ticks(axis)
    elif spacing.name == "logit":
        ticks = _logit_ticks(spacing, row.values[0], row.values[-1])
        axis.set_ticks([place for place, _ in ticks], [text for _, text in ticks])
        axis.set_minor_locator(NullLocator())


def _logit_ticks(spacing: _Spacing, first: float, last: float) -> list[tuple[float, str]]:
    """Round numbers that come closer to the ends of the interval by powers of ten."""
    lower, upper = spacing.interval
    reach = max(spacing.forward(last), -spacing.forward(first)) / math.log(10.0)
    every = max(1, math.ceil(reach / 4.0))
    middle = 0.5 * (lower + upper)
    ticks = [(middle, _plain_number(middle))]
    if reach < 2.0 and lower < 0.0:
        ticks += [(-0.5, _plain_number(-0.5)), (0.5, _plain_number(0.5))]
    for power in range(every, 17, every):
        small = 10.0**-power
        for end, sign in ((lower, 1.0), (upper, -1.0)):
            text = _plain_number(end + sign * small)
            if power > 3:
                text = f"${f'{end:g}' if end else ''}{'-' if sign < 0.0 else '+' if end else ''}10^{{{-power}}}$"
            ticks.append((end + sign * small, text))
    ticks = sorted(tick for tick in ticks if first <= tick[0] <= last)
    if len(ticks) < 3:
        places = MaxNLocator(5).tick_values(first, last)
        ticks = [(float(x), _plain_number(x)) for x in places if first <= x <= last]
    return ticks


# --- curves ---------------------------------------------------------------------------------------------------------


def _draw_curves(axes: Axes, subject: _Subject, across: _Row, other: _Row | None) -> list[Any]:
    values = subject.values
    curves = range(values.shape[0])
    axes.set_xmargin(0.0)
    _scale(axes, "x", across)
    if values.dtype.kind == "b":
        factor = 1.0
        axes.set_yticks([0.0, 1.0], ["no", "yes"])
        axes.set_ylim(-0.2, 1.2)
        axes.set_ylabel(_words(subject.variable), fontsize=LABEL_SIZE)
        notes = []
    else:
        span = _span_of(values, subject.variable)
        factor, unit = _unit(subject, span)
        axes.set_ylabel(labelled(_words(subject.variable), unit), fontsize=LABEL_SIZE)
        notes = _stand_up(axes, span, factor)
    handles: list[Any] = []
    for place in curves:
        style: dict[str, Any] = {
            **_CURVES[place % len(_CURVES)],
            "label": "" if other is None else _entry(other, place),
        }
        if across.names is not None:
            style |= {"linestyle": "", "marker": "osD^v*"[place % 6], "markersize": 5.0}
        elif across.places.size <= 12:  # so few that people want to see where they are
            style |= {"marker": "osD^v*"[place % 6], "markersize": 3.0}
        if values.dtype.kind == "b" and across.names is None:
            style["drawstyle"] = "steps-mid"
        (line,) = axes.plot(across.shown, np.asarray(values[place], float) / factor, **style)
        if other is not None:
            handles.append(line)
    blank = np.isnan(np.asarray(values, float))
    if across.names is None and np.any(np.all(blank, axis=0)):
        edges = _edges(across)
        for first, last in _runs(np.all(blank, axis=0)):
            axes.axvspan(edges[first], edges[last + 1], color=_BLANK, linewidth=0.0, zorder=0)
        handles.append(Patch(facecolor=_BLANK, label=f"grey: {subject.missing}"))
    elif np.any(blank):
        notes.append(f"gaps: {subject.missing}")
    return [*handles, *(_note(text) for text in notes)]


def _stand_up(axes: Axes, span: "_Span", factor: float) -> list[str]:
    """The scale upwards, and what there is to say about it."""
    if span.log:
        axes.set_yscale("log")
        if span.clipped:
            axes.set_ylim(span.lower / factor, span.upper / factor)
        return [span.clipped] if span.clipped else []
    if span.signed:
        axes.axhline(0.0, color="0.7", linewidth=0.6, zorder=0)
    if span.bend:
        axes.set_yscale("asinh", linear_width=span.bend / factor)
        return []
    if span.clipped:
        margin = 0.03 * (span.upper - span.lower)
        axes.set_ylim((span.lower - margin) / factor, (span.upper + margin) / factor)
    axes.yaxis.set_major_locator(MaxNLocator(6))
    return [span.clipped] if span.clipped else []


def _entry(row: _Row, place: int) -> str:
    if row.names is not None:
        return row.names[place]
    return f"${row.symbol}$ = {_plain_number(row.shown[place], 4)} {row.unit}".rstrip()


def _runs(true: np.ndarray) -> list[tuple[int, int]]:
    """First and last place of every row of neighbours that are true."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], true, [False]]).astype(int)))
    return [(int(first), int(last) - 1) for first, last in zip(ends[::2], ends[1::2], strict=True)]


# --- maps -----------------------------------------------------------------------------------------------------------


def _draw_map(figure: Figure, axes: Axes, subject: _Subject, across: _Row, upwards: _Row, contours: int) -> list[Any]:
    values = subject.values
    axes.set_facecolor(_BLANK)
    for side, row in (("x", across), ("y", upwards)):
        _scale(axes, side, row)
    edges = _edges(across), _edges(upwards)
    if values.dtype.kind == "b":
        axes.pcolormesh(*edges, values.astype(float), cmap=ListedColormap([_NO, _YES]), vmin=0, vmax=1, rasterized=True)
        no = "no, or not computed yet" if subject.ds.attrs.get("unfinished") else "no"
        words = _words(subject.variable)
        return [Patch(facecolor=_YES, label=f"{words}: yes"), Patch(facecolor=_NO, label=no)]
    span = _span_of(values, subject.variable)
    factor, unit = _unit(subject, span)
    width = span.upper - span.lower or 1.0
    # matplotlib leaves out infinite values; here they get the colour of values beyond the scale
    bounded = np.where(np.isinf(values), np.sign(values) * (max(-span.lower, span.upper) + width), values)
    shown = np.ma.masked_invalid(bounded.astype(float) / factor)
    if span.log:
        shown = np.ma.maximum(shown, span.lower / factor)  # zero has a colour too
    norm, colours = _colours(span, factor)
    mesh = axes.pcolormesh(*edges, shown, norm=norm, cmap=colours, rasterized=True)
    handles = _draw_optimum(axes, subject, across, upwards)
    if span.any:
        _draw_bar(figure, axes, mesh, span, factor, labelled(_words(subject.variable), unit))
        if across.names is None and upwards.names is None:
            _draw_contours(axes, across, upwards, shown, _levels(span, factor, contours), norm, colours)
    if np.any(np.isnan(values)):
        handles.append(Patch(facecolor=_BLANK, label=f"grey: {subject.missing}"))
    if span.clipped:
        handles.append(_note(span.clipped))
    return handles


def _edges(row: _Row) -> np.ndarray:
    """Where the cells around the values of an axis end, printed; the outer ones end with the values."""
    if row.names is not None:
        return np.arange(row.values.size + 1) - 0.5
    spacing = row.spacing()
    values = row.values.astype(float)
    u = spacing.forward(values)
    return np.concatenate([values[:1], spacing.inverse(0.5 * (u[1:] + u[:-1])), values[-1:]]) / row.factor


def _draw_bar(figure: Figure, axes: Axes, mesh: Any, span: "_Span", factor: float, label: str) -> None:
    extend = {(True, True): "both", (True, False): "min", (False, True): "max", (False, False): "neither"}
    bar = figure.colorbar(mesh, ax=axes, pad=0.02, aspect=22, extend=extend[span.below, span.above])
    bar.set_label(label, fontsize=LABEL_SIZE)
    bar.ax.tick_params(which="both", direction="in", labelsize=TICK_SIZE)
    bar.outline.set_linewidth(0.6)  # pyright: ignore[reportCallIssue, reportAttributeAccessIssue]
    if span.log:
        plain_ticks(bar.ax.yaxis)
    elif span.bend:
        levels: list[float] = []
        for level in sorted(_levels(span, factor, 8), key=lambda level: (level != 0.0, -abs(level))):
            if all(abs(mesh.norm(level) - mesh.norm(other)) > 0.06 for other in levels):
                levels.append(level)
        bar.set_ticks(levels, labels=[_level_text(level) for level in levels])
        bar.minorticks_off()


def _draw_contours(
    axes: Axes,
    across: _Row,
    upwards: _Row,
    shown: np.ma.MaskedArray,
    levels: Sequence[float],
    norm: Normalize,
    colours: Colormap,
) -> None:
    """Lines at levels, between values where their colours would be: these are even on a logarithmic scale, too."""
    heights = np.ma.masked_invalid(norm(shown).filled(np.nan))
    at = {float(norm(level)): level for level in levels}
    at = {height: level for height, level in at.items() if heights.min() < height < heights.max()}
    if not at:
        return
    lines = axes.contour(
        across.shown,
        upwards.shown,
        heights,
        levels=list(at),
        colors=["k" if _lightness(colours(height)) > 0.5 else "w" for height in at],
        linewidths=[1.1 if level == 0.0 else 0.5 for level in at.values()],
        linestyles="solid",
    )
    places = _label_places(axes, [segment for segments in lines.allsegs for segment in segments])
    texts = {height: _level_text(level) for height, level in at.items()}
    axes.clabel(lines, fmt=texts, fontsize=6, inline_spacing=2, manual=places)


def _label_places(axes: Axes, segments: Sequence[np.ndarray]) -> list[tuple[float, float]]:
    """Where the numbers of contour lines stand: away from the frame, each other and other lines."""
    to_frame = axes.transData + axes.transAxes.inverted()
    taken = [to_frame.transform(np.asarray(line.get_xydata(), float)) for line in axes.lines]
    taken = [points[np.isfinite(points).all(axis=1)] for points in taken]
    places = []
    for segment in sorted(segments, key=len, reverse=True):
        points = segment[:: max(1, len(segment) // 60)]
        framed = to_frame.transform(points)
        room = np.min([framed, 1.0 - framed], axis=(0, 2)) - _BESIDE_FRAME
        for index, others in enumerate(taken):
            apart = np.min(np.linalg.norm(framed[:, None] - others[None], axis=2), axis=1)
            room = np.minimum(room, apart - (_BESIDE_LINE if index < len(axes.lines) else _BESIDE_NUMBER))
        best = int(np.argmax(room))
        if room[best] > 0.0:
            taken.append(framed[best : best + 1])
            places.append(tuple(points[best]))
    return places


_BESIDE_FRAME, _BESIDE_LINE, _BESIDE_NUMBER = 0.06, 0.06, 0.13  # of the width or height of the frame


def _levels(span: "_Span", factor: float, count: int) -> list[float]:
    """Round numbers between the ends of the scale, about so many."""
    if not count:
        return []
    lower, upper = span.lower / factor, span.upper / factor
    if span.log:
        levels = _log_levels(lower, upper, count)
    elif span.bend:
        least, sides = span.bend / factor, 2 if span.signed else 1
        powers = [level for level in _log_levels(least, -lower, max(1, count // sides)) if level >= least]
        levels = [*(-level for level in reversed(powers)), *([0.0, *powers] if span.signed else [])]
    else:
        levels = [float(level) for level in MaxNLocator(count + 1).tick_values(lower, upper)]
    return [level for level in levels if lower <= level <= upper]


def _log_levels(lower: float, upper: float, count: int) -> list[float]:
    """Powers of ten, every so many of them; or 2 and 5 of each besides."""
    first, last = math.ceil(math.log10(lower) - 1e-9), math.floor(math.log10(upper) + 1e-9)
    decades = last - first + 1
    if decades > count:
        every = math.ceil(decades / count)
        return [10.0**power for power in range(first, last + 1) if power % every == 0]
    digits = (1.0, 2.0, 5.0) if 3 * decades <= count + 1 else (1.0, 3.0) if 2 * decades <= count + 1 else (1.0,)
    return [digit * 10.0**power for power in range(first - 1, last + 1) for digit in digits]


def _level_text(level: float) -> str:
    if level == 0.0 or 1e-3 <= abs(level) < 1e4:
        return _plain_number(level)
    power = math.floor(math.log10(abs(level)) + 1e-9)
    digit = f"{level / 10.0**power:.3g}"
    if digit in ("1", "-1"):
        return f"${digit[:-1]}10^{{{power}}}$"
    return rf"${digit}{{\times}}10^{{{power}}}$"


def _lightness(colour: Sequence[float]) -> float:
    red, green, blue, *_ = colour
    return 0.299 * red + 0.587 * green + 0.114 * blue


# --- colours --------------------------------------------------------------------------------------------------------


class _Span(NamedTuple):
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


def _span_of(values: np.ndarray, variable: xr.DataArray) -> _Span:
    finite = values[np.isfinite(values)].astype(float)
    if finite.size == 0:
        return _Span(False, 0.0, 1.0)
    lower, upper = float(finite.min()), float(finite.max())
    infinite = bool(np.any(np.isinf(values)))
    size = max(-lower, upper)
    signed = lower < -1e-6 * size and upper > 1e-6 * size  # smaller values are rounding errors
    if not signed and upper > 0.0 and not _is_share(variable, upper):
        least = float(np.quantile(finite[finite > 0.0], 0.002))
        if upper > 10.0**_DECADES * least:
            positive = float(finite[finite > 0.0].min())
            said = "infinite values are left out of the scale" if infinite else ""
            return _Span(True, positive, upper, True, False, bool(np.any(values <= 0.0)), infinite, said)
    sizes = np.abs(finite[finite != 0.0])
    crowded = signed and size > 30.0 * np.median(sizes)  # most values lie close to zero
    wide = lower < 0.0 >= upper and size > 10.0**_DECADES * sizes.min()
    if not infinite and (crowded or wide):
        bend = min(max(float(np.quantile(sizes, 0.2 if signed else 0.002)), 1e-5 * size), 0.1 * size)
        ends = (-size, size) if signed else (lower, upper)
        return _Span(True, *ends, signed=signed, bend=10.0 ** math.ceil(math.log10(bend)))
    said, usual = "", float(np.quantile(np.abs(finite), 0.99))
    if infinite or (usual > 0.0 and size > 20.0 * usual):
        lower, upper = max(lower, -usual), min(upper, usual)
        said = "scale ends with 99 % of the values"
    if signed:
        lower, upper = -max(-lower, upper), max(-lower, upper)
    return _Span(True, lower, upper, False, signed, bool(np.any(values < lower)), bool(np.any(values > upper)), said)


def _is_share(variable: xr.DataArray, upper: float) -> bool:
    return str(variable.attrs.get("units", "1")) == "1" and upper <= 1.0


def _colours(span: _Span, factor: float) -> tuple[Normalize, Colormap]:
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


def _note(text: str) -> Line2D:
    """A line of the legend that only says something."""
    return Line2D([], [], linestyle="", label=text)


# --- the least wear -------------------------------------------------------------------------------------------------

_WEARS = ("wear_volume", "worn_radius", "deepest_wear")
_COURSE = 301  # amplitudes at which the best exponent is found
_SCANNED = 65  # exponents tried at a time
_REFINED = 3  # further scans, each between the neighbours of the best exponent


def _draw_optimum(axes: Axes, subject: _Subject, across: _Row, upwards: _Row) -> list[Any]:
    variable = subject.variable
    if variable.name not in _WEARS or upwards.name != "k" or across.name not in ("phi", "tangential_force"):
        return []
    unit = variable.attrs.get("units")
    if variable.name == "wear_volume" and unit == "a_0^4/R" and across.name == "phi":
        x, k, solid, dotted = _best_exponents(across, upwards)
        names = r"least wear, $k^*(\varphi)$", "$k^*$ at a bound"
    else:
        x = across.shown
        row, joined = _least(subject.values)
        k = np.where(row >= 0, upwards.shown[row], np.nan)
        solid, dotted = _parted(row, joined, upwards.values.size)
        names = "least on the map", "least, at a bound"
    handles = []
    for steps, style, name in ((solid, _OPTIMUM, names[0]), (dotted, _AT_BOUND, names[1])):
        if steps.any():
            handles += axes.plot(*_broken(x, k, steps), label=name, **style)
    return handles


def _best_exponents(across: _Row, upwards: _Row) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Amplitudes, the best exponents in the drawn range, and which neighbouring points a line joins.

    `optimise.optimal_exponent` gives the same with a proof, but compiling it takes longer than drawing the picture.
    """
    phi_of, k_of = across.spacing(), upwards.spacing()
    phi = _between(phi_of, across.values, np.linspace(0.0, 1.0, _COURSE))
    lower, upper = np.zeros(_COURSE), np.ones(_COURSE)
    share = np.linspace(0.0, 1.0, _SCANNED)[:, None]
    place, joined, row = np.zeros(_COURSE), np.zeros(0, bool), np.zeros(_COURSE, int)
    for turn in range(1 + _REFINED):
        places = lower + (upper - lower) * share
        with in_precision(np.float64):
            volumes = np.asarray(fretting.wear_volume(_between(k_of, upwards.values, places), phi))
        best = np.argmin(volumes, axis=0)
        if turn == 0:
            row, joined = _least(volumes)
        columns = np.arange(_COURSE)
        place = places[best, columns]
        lower, upper = (places[np.clip(best + shift, 0, _SCANNED - 1), columns] for shift in (-1, 1))
    row = np.where(place == 0.0, 0, np.where(place == 1.0, _SCANNED - 1, np.clip(row, 1, _SCANNED - 2)))
    return phi, _between(k_of, upwards.values, place), *_parted(row, joined, _SCANNED)


def _between(spacing: _Spacing, values: np.ndarray, share: np.ndarray) -> np.ndarray:
    """The value at a share of the way from the first to the last value, on the scale of the axis."""
    first, last = (float(values[end]) for end in (0, -1))
    u, v = float(spacing.forward(first)), float(spacing.forward(last))
    return np.clip(spacing.inverse(u + (v - u) * share), first, last)


def _least(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The row of the least value of each column, -1 where all are the same, and whether it is continuous to the next.

    It is not continuous where larger values lie between the two rows.
    """
    filled = np.where(np.isnan(values), np.inf, values)
    told_apart = np.min(filled, axis=0) < np.max(np.where(np.isfinite(filled), filled, -np.inf), axis=0)
    row = np.where(told_apart, np.argmin(filled, axis=0), -1)
    joined = (row[1:] >= 0) & (row[:-1] >= 0)
    for column in np.flatnonzero(joined & (np.abs(np.diff(row)) > 1)):
        lower, upper = sorted((row[column], row[column + 1]))
        for side in (column, column + 1):
            ends = max(filled[lower, side], filled[upper, side])
            if not np.max(filled[lower : upper + 1, side]) <= ends * (1.0 + 1e-5):
                joined[column] = False
    return row, joined


def _parted(row: np.ndarray, joined: np.ndarray, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Which steps from column to column are drawn solid, and which, along a bound, dotted."""
    along = joined & (row[1:] == row[:-1]) & ((row[1:] == 0) | (row[1:] == rows - 1))
    return joined & ~along, along


def _broken(x: np.ndarray, y: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points of a line of which only some steps are drawn."""
    parts = [np.append(line[first : last + 2], np.nan) for first, last in _runs(steps) for line in (x, y)]
    return np.concatenate(parts[::2])[:-1], np.concatenate(parts[1::2])[:-1]


# --- words and units ------------------------------------------------------------------------------------------------

_AXIS_WORDS = {
    "k": ("exponent", "k"),
    "phi": ("amplitude", r"\varphi"),
    "nu": ("Poisson's ratio", r"\nu"),
    "r": ("radius", "r"),
    "distance": ("distance inside the stick edge", "s"),
    "E0": ("modulus", "E_0"),
    "z0": ("characteristic depth", "z_0"),
    "radius": ("radius of the indenter", "R"),
    "normal_force": ("normal force", "F_N"),
    "friction": ("coefficient of friction", r"\mu"),
    "depth": ("indentation depth", "d"),
    "tangential_force": ("tangential force", "F_x"),
    LOAD: ("load", ""),
}
_SYMBOLS = {
    "contact_radius": "a_0",
    "stick_radius": "c",
    "worn_radius": r"a_\infty",
    "penetration": r"d_\infty",
    "wear_volume": r"\Delta V",
    "edge_pressure": r"p_\infty",
    "profile": r"f_\infty",
    "wear_depth": r"f_\infty-f_0",
    "initial_displacement": "w_0",
    "steady_displacement": r"w_\infty",
    "initial_pressure": "p_0",
    "steady_pressure": r"p_\infty",
    "steady_traction": r"\tau_\infty",
    "initial_force": "F_{N0}",
    "steady_force": r"F_{N\infty}",
    "force_ratio": r"F_{N\infty}/F_{N0}",
    "force_drop": r"1-F_{N\infty}/F_{N0}",
    "volume_change": r"\Delta V",
    "h_N": "h_N",
    "holl_ratio": r"\nu",
}
_NAMED = {"saving": "share saved", "h_N": "factor", "rival": "next best exponent", "holl_ratio": "Holl's ratio"}


def _axis_words(variable: xr.DataArray, dim: str) -> tuple[str, str]:
    if dim == "radius" and "depth" in variable.coords:
        return "radius of the punch", "a"
    return _AXIS_WORDS.get(dim, (_plain(dim.replace("_", " ")), ""))


def _words(variable: xr.DataArray) -> str:
    """A quantity in a few words and its symbol; of a derivative only that."""
    stem, slopes = _slopes(str(variable.name))
    head, _, name = stem.rpartition(".")
    if head in ("optimal_exponent", "design") and name in _AXIS_WORDS:
        words, symbol = f"best {_AXIS_WORDS[name][0]}", f"{_AXIS_WORDS[name][1]}^*"
    else:
        words = _NAMED.get(name, _plain(name.replace("_", " ")))
        symbol = _SYMBOLS.get(name, "")
        if head in ("optimal_exponent", "design") and name in _SYMBOLS:
            words = f"least {words}"
    if not slopes:
        return f"{words} ${symbol}$" if symbol else words
    power = f"^{len(slopes)}" if len(slopes) > 1 else ""
    below = []
    for slope in dict.fromkeys(slopes):
        times = slopes.count(slope)
        axis = _axis_words(variable, slope)[1]
        below.append(rf"\partial {f'{{{axis}}}^{times}' if times > 1 else axis}")
    if len(symbol) > 3 and "-" in symbol:
        symbol = f"({symbol})"
    over = rf"\partial{power} {symbol}" if symbol else rf"\partial{power}"
    under = r"\,".join(below)
    slope = f"${over}/{under if len(below) == 1 else f'({under})'}$"
    return slope if symbol else f"{slope} of {words}"


def _slopes(name: str) -> tuple[str, list[str]]:
    """The quantity that a derivative is one of, and by what."""
    parts, slopes = name.split("."), []
    while len(parts) > 1 and parts[-1][:1] == "d" and parts[-1][1:] in AXES:
        slopes.insert(0, parts.pop()[1:])
    return ".".join(parts), slopes


def _unit(subject: _Subject, span: _Span) -> tuple[float, str]:
    """The unit in which a quantity of this span is printed."""
    variable = subject.variable
    unit = str(variable.attrs.get("units", "1"))
    size = math.sqrt(span.lower * span.upper) if span.log else max(abs(span.lower), abs(span.upper))
    first, *rest = re.sub("[()]", "", unit).split("/")
    if first not in PREFIXED or not all(part in PREFIXED for part in rest):
        factor, text = 1.0, _printed(unit)
    else:
        factor, below = 1.0, []
        axes = [slope for slope in _slopes(str(variable.name))[1] if AXES[slope].unit != "1"]
        for axis, part in zip(axes, rest, strict=False):
            values = subject.ds[axis].to_numpy() if axis in subject.ds.coords else np.ones(1)
            prefix, name = readable(float(np.max(np.abs(values))), part)
            factor /= prefix
            below.append(name)
        above, name = readable(size / factor, first)
        factor *= above
        text = name
        if below:
            text = f"{name or '1'}/{below[0] if len(below) == 1 else '(' + ' '.join(below) + ')'}"
    largest = size / factor
    if not span.log and not span.bend and largest and not 0.01 <= largest < 1e4:
        power = math.floor(math.log10(largest))
        factor *= 10.0**power
        text = f"$10^{{{power}}}$ {text}".rstrip()
    return factor, text


def _printed(unit: str) -> str:
    """A unit of the paper as a formula; nothing for a plain number."""
    if unit == "1":
        return ""
    text = re.sub(r"\b(pi|mu)\b ?", r"\\\1 ", unit.replace("F_N0", "F_{N0}"))
    return f"${text}$"


def _value_text(dim: str, variable: xr.DataArray, value: Any) -> str:
    """The value of an axis in print."""
    if isinstance(value, str):
        return f"{_axis_words(variable, dim)[0]} = {_plain(value)}"
    words, symbol = _axis_words(variable, dim)
    unit = str(variable[dim].attrs.get("units", "1"))
    factor, text = readable(float(value), unit) if unit in PREFIXED else (1.0, _printed(unit))
    number = _plain_number(float(value) / factor, 4)
    return f"{f'${symbol}$' if symbol else words} = {number} {text}".rstrip()


_FORMULAS = (  # what the meanings of quantities hold of them, with the groups {0} and so on; without spaces
    (r"\bF_x/\(mu F_N\)", r"$F_x/(\mu\,F_N)$"),
    (r"\bmu F_N\b", r"$\mu\,F_N$"),
    (r"\b([acdfpw])_inf\b", r"${0}_\infty$"),
    (r"\btau_inf\b", r"$\tau_\infty$"),
    (r"\b([acfpwh])_([0N])\b", r"${0}_{1}$"),
    (r"\b([Ez])0\b", r"${0}_0$"),
    (r"\b(exponent|by) k\b", r"{0} $k$"),
    (r"\bby phi\b", r"by $\varphi$"),
    (r"\bby nu\b", r"by $\nu$"),
    (r"\bby friction\b", r"by $\mu$"),
)


def _title(variable: xr.DataArray, told: list[str]) -> str:
    """What is drawn, its equation in the paper, and the values of the axes that are not drawn."""
    text = str(variable.attrs.get("long_name", variable.name)).replace("$", r"\$").replace(" - ", " − ")
    for pattern, formula in _FORMULAS:
        text = re.sub(pattern, lambda match, formula=formula: formula.format(*match.groups()), text)
    text = re.sub(r"\b[a-z]+(?:_[a-z]+)+\b", lambda match: match[0].replace("_", " "), text)
    equation = str(variable.attrs.get("equation", ""))
    if re.fullmatch(r"[\d, -]+", equation):
        text += f", {_equations(equation)}"
    lines = textwrap.wrap(text, 62, break_long_words=False)
    line = ""
    for item in told:
        if line and len(line) + len(item) > 66:
            lines.append(line)
            line = ""
        line += f"{', ' if line else ''}{item}"
    return "\n".join([*lines, *([line] if line else [])])


def _equations(numbers: str) -> str:
    parts = [f"({part.strip()})".replace("-", ")–(") for part in numbers.split(",")]
    text = f"{'Eq.' if len(parts) == 1 and '–' not in parts[0] else 'Eqs.'} {', '.join(parts)}"
    return text.replace(" ", "\N{NO-BREAK SPACE}")


def _plain(text: str) -> str:
    return one_line(text).replace("$", r"\$")


def _plain_number(number: float, digits: int = 6) -> str:
    """A number with the sign that print has for less than nothing."""
    text = f"{number + 0.0:.{digits}g}"
    if "e" in text:
        mantissa, power = text.split("e")
        return rf"${mantissa}\times10^{{{int(power)}}}$"
    return text.replace("-", "−")
