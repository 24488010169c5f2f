"""The exponent of least wear, on maps over k and the amplitude."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from plgwear_jax import fretting
from plgwear_jax.plots.maps.curves import runs
from plgwear_jax.plots.maps.rows import Row, Spacing
from plgwear_jax.plots.maps.subject import Subject
from plgwear_jax.sweep.plan import in_precision

__all__ = [
    "draw_optimum",
]


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
# --- the least wear -------------------------------------------------------------------------------------------------

_WEARS = ("wear_volume", "worn_radius", "deepest_wear")
_COURSE = 301  # amplitudes at which the best exponent is found
_SCANNED = 65  # exponents tried at a time
_REFINED = 3  # further scans, each between the neighbours of the best exponent


def draw_optimum(axes: Axes, subject: Subject, across: Row, upwards: Row) -> list[Any]:
    """Draw the exponent of least wear; the entries of the legend."""
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


def _best_exponents(across: Row, upwards: Row) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
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


def _between(spacing: Spacing, values: np.ndarray, share: np.ndarray) -> np.ndarray:
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
    parts = [np.append(line[first : last + 2], np.nan) for first, last in runs(steps) for line in (x, y)]
    return np.concatenate(parts[::2])[:-1], np.concatenate(parts[1::2])[:-1]
