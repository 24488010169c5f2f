"""The least wear on a map, and how much more wears around it: of each amplitude, or of all designs."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from plgwear_jax.plots.maps.rows import Row
from plgwear_jax.plots.maps.texts import Subject, quantity_of

__all__ = ["draw_optimum", "runs"]


_COLOUR = "#C2260B"
_OPTIMUM: dict[str, Any] = {
    "color": _COLOUR,
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
_MARK: dict[str, Any] = {
    "color": _COLOUR,
    "marker": "*",
    "linestyle": "",
    "markersize": 9.0,
    "markeredgecolor": "w",
    "markeredgewidth": 0.8,
    "zorder": 6,
    "clip_on": False,
}
_PLATEAU: dict[str, Any] = {"colors": _COLOUR, "linewidths": 0.9, "linestyles": [(0, (4, 2))], "zorder": 4}

_WEARS = ("wear_volume", "worn_radius", "deepest_wear", "volume_change", "force_drop")
_AMPLITUDES = ("phi", "tangential_force")
_CHOSEN = ("k", "E0", "z0")  # what a design chooses
_MORE = 0.05  # as much more wear as the plateau has at its edge


def draw_optimum(axes: Axes, subject: Subject, across: Row, upwards: Row) -> list[Any]:
    """Draw the exponent of least wear for each amplitude, or the design of least wear; the entries of the legend.

    They are those of the values on the map: the lowest one, and between rows the vertex of the parabola through it and
    its neighbours.
    """
    if quantity_of(subject.variable) not in _WEARS:
        return []
    values = np.where(np.isnan(subject.values), np.inf, subject.values)
    if upwards.name == "k" and across.name in _AMPLITUDES:
        handles, least = _draw_course(axes, values, across, upwards), np.min(values, axis=0)
    elif {across.name, upwards.name} <= {*_CHOSEN} and np.min(values) < np.nanmax(subject.values):
        least = np.min(values)
        row, column = np.unravel_index(np.argmin(values), values.shape)
        handles = axes.plot(across.shown[column], upwards.shown[row], label="least wear", **_MARK)
    else:
        return []
    return [*handles, *_draw_plateau(axes, values, least, across, upwards)]


def _draw_course(axes: Axes, values: np.ndarray, across: Row, upwards: Row) -> list[Any]:
    row, joined = _least(values)
    course, at_bound = _between_rows(values, row, upwards)
    along = joined & at_bound[1:] & at_bound[:-1] & (row[1:] == row[:-1])
    handles = []
    for steps, style, name in (
        (joined & ~along, _OPTIMUM, r"least wear, $k^*$"),
        (along, _AT_BOUND, "$k^*$ at a bound"),
    ):
        if steps.any():
            handles += axes.plot(*_broken(across.shown, course, steps), label=name, **style)
    return handles


def _draw_plateau(axes: Axes, values: np.ndarray, least: Any, across: Row, upwards: Row) -> list[Any]:
    """Draw where the wear is a little more than the least one."""
    with np.errstate(divide="ignore", invalid="ignore"):
        more = np.ma.masked_invalid(values / least - 1.0)
    if not more.count() or not more.min() < _MORE < more.max():
        return []
    axes.contour(across.shown, upwards.shown, more, levels=[_MORE], **_PLATEAU)
    style = {"color": _COLOUR, "linewidth": 0.9, "linestyle": _PLATEAU["linestyles"][0]}
    return [Line2D([], [], label=f"{_MORE:.0%} more wear".replace("%", " %"), **style)]


def _between_rows(values: np.ndarray, row: np.ndarray, upwards: Row) -> tuple[np.ndarray, np.ndarray]:
    """Where the least value of each column lies upwards, and whether it is at an end."""
    spacing, last = upwards.spacing(), values.shape[0] - 1
    u = np.asarray(spacing.forward(upwards.values.astype(float)))
    place, ended = upwards.values[row], (row == 0) | (row == last)
    if last >= 2:
        columns, middle = np.arange(row.size), np.clip(row, 1, last - 1)
        near = [middle - 1, middle, middle + 1]
        (u_0, u_1, u_2), (v_0, v_1, v_2) = u[near], values[near, columns]
        with np.errstate(divide="ignore", invalid="ignore"):
            first, second = (v_1 - v_0) / (u_1 - u_0), (v_2 - v_1) / (u_2 - u_1)
            vertex = 0.5 * (u_0 + u_1 - first * (u_2 - u_0) / (second - first))
            inside = (second > first) & (u_0 < vertex) & (vertex < u_2)
        place = np.where(inside, spacing.inverse(np.where(inside, vertex, u_1)), place)
        ended &= ~inside
    return place / upwards.factor, ended


def _least(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The row of the least value of each column, -1 where all are the same, and whether it is continuous to the next.

    It is not continuous where larger values lie between the two rows.
    """
    told_apart = np.min(values, axis=0) < np.max(np.where(np.isfinite(values), values, -np.inf), axis=0)
    row = np.where(told_apart, np.argmin(values, axis=0), -1)
    joined = (row[1:] >= 0) & (row[:-1] >= 0)
    for column in np.flatnonzero(joined & (np.abs(np.diff(row)) > 1)):
        lower, upper = sorted((row[column], row[column + 1]))
        for side in (column, column + 1):
            ends = max(values[lower, side], values[upper, side])
            if not np.max(values[lower : upper + 1, side]) <= ends * (1.0 + 1e-5):
                joined[column] = False
    return row, joined


def _broken(x: np.ndarray, y: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points of a line of which only some steps are drawn."""
    parts = [np.append(line[first : last + 2], np.nan) for first, last in runs(steps) for line in (x, y)]
    return np.concatenate(parts[::2])[:-1], np.concatenate(parts[1::2])[:-1]


def runs(true: np.ndarray) -> list[tuple[int, int]]:
    """First and last place of every row of neighbours that are true."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], true, [False]]).astype(int)))
    return [(int(first), int(last) - 1) for first, last in zip(ends[::2], ends[1::2], strict=True)]
