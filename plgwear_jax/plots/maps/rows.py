"""The axes of a picture: their values, spacings and ticks."""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import LogitLocator, MaxNLocator, NullLocator

from plgwear_jax._core.units import PREFIXED, readable
from plgwear_jax.catalogue import leaf
from plgwear_jax.plots.maps.texts import axis_words, plain_number, plain_text, printed_unit
from plgwear_jax.plots.style import LABEL_SIZE, labelled, plain_ticks

FEW = 6  # most curves that can be told apart; more are drawn as a map
SEEN = 750  # most values along a side of a map, whose print is some 700 dots wide
SEEN_OF_CURVE = 1500


# --- axes -----------------------------------------------------------------------------------------------------------


class Spacing(NamedTuple):
    """The scale of an axis; `forward` makes values with this spacing even."""

    name: str
    forward: Callable[[Any], Any]
    inverse: Callable[[Any], Any]
    interval: tuple[float, float] = (-math.inf, math.inf)


def _same(x: Any) -> Any:
    return x


_LINEAR, _LOG = Spacing("linear", _same, _same), Spacing("log", np.log, np.exp, (0.0, math.inf))


def _logit(interval: tuple[float, float]) -> Spacing:
    lower, upper = interval

    def forward(x: Any) -> Any:
        with np.errstate(divide="ignore", invalid="ignore"):  # matplotlib asks for the ends, too
            return np.log((x - lower) / (upper - x))

    def inverse(u: Any) -> Any:
        share = 0.5 + 0.5 * np.tanh(0.5 * np.abs(u))
        rest = (upper - lower) / (1.0 + np.exp(np.abs(u)))  # the distance from the nearer end keeps its digits
        return np.where(np.less(u, 0.0), lower + rest, np.where(share < 1.0, upper - rest, upper))

    return Spacing("logit", forward, inverse, interval)


class Row(NamedTuple):
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
        """Whether its values can be told apart as curves."""
        return self.places.size <= FEW

    @property
    def shown(self) -> np.ndarray:
        """The values in the unit of the axis."""
        return self.values / self.factor

    def thinned(self, most: int) -> "Row":
        """At most so many values, including both ends."""
        some = np.unique(np.linspace(0, self.places.size - 1, min(most, self.places.size)).round().astype(int))
        names = None if self.names is None else [self.names[place] for place in some]
        return self._replace(places=self.places[some], values=self.values[some], names=names)

    def spacing(self) -> Spacing:
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


def _stretched(name: str) -> Sequence[Spacing]:
    interval = leaf(name).interval
    return (_LOG,) if interval is None else (_LOG, _logit(interval))


def _unevenness(u: np.ndarray) -> float:
    """How far values are off even spacing, as a share of their range."""
    return float(np.max(np.abs((u - u[0]) / (u[-1] - u[0]) - np.linspace(0.0, 1.0, u.size))))


def row_of(variable: xr.DataArray, dim: str) -> Row:
    """An axis of a variable, spaced as its values are."""
    coordinate = variable[dim]
    values = coordinate.to_numpy()
    words, symbol = axis_words(variable, dim)
    label = " ".join(filter(None, [words, f"${symbol}$" if symbol else ""]))
    if values.dtype.kind not in "fiu":
        names = [plain_text(str(value)) for value in values]
        return Row(dim, np.arange(values.size), np.arange(values.size), 1.0, label, symbol, "", names)
    steps = np.diff(values)
    if np.all(steps > 0.0):
        index = np.arange(values.size)
    elif np.all(steps < 0.0):
        index = np.arange(values.size)[::-1]
    else:
        index = np.unique(values, return_index=True)[1]
    row = Row(dim, index, values[index], 1.0, label, symbol, "")
    factor, unit = _axis_unit(coordinate, row.thinned(SEEN))
    if dim == "phi":
        label = r"amplitude $\varphi = F_x/(\mu F_N)$"
    return row._replace(factor=factor, unit=unit, label=labelled(label, unit))


def _axis_unit(coordinate: xr.DataArray, row: Row) -> tuple[float, str]:
    unit = str(coordinate.attrs.get("units", "1"))
    if unit not in PREFIXED:
        return 1.0, printed_unit(unit)
    largest = float(np.max(np.abs(row.values)))
    if row.spacing().name == "log":
        largest = math.sqrt(float(row.values[0]) * float(row.values[-1]))
    return readable(largest, unit)


# Of two axes the one that comes first here is horizontal.
_ACROSS = ("r", "distance", "phi", "tangential_force", "k", "depth", "normal_force", "radius", "z0", "E0", "nu")


def arranged(rows: list[Row]) -> tuple[Row, Row | None]:
    """The horizontal axis, and the vertical one, or the one with a curve for each value."""
    if len(rows) == 1:
        return rows[0], None

    def rank(row: Row) -> int:
        if row.names is not None:
            return len(_ACROSS) + 1
        return _ACROSS.index(row.name) if row.name in _ACROSS else len(_ACROSS)

    first, second = sorted(rows, key=rank)
    if second.few and (second.names is not None or not first.few or second.places.size <= first.places.size):
        return first, second
    return (second, first) if first.few else (first, second)


def set_scale(axes: Axes, side: str, row: Row) -> None:
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
        axis.set_minor_locator(NullLocator())
        ticks = _logit_ticks(float(row.values[0]), float(row.values[-1]))
        axis.set_ticks(ticks, [_logit_text(tick) for tick in ticks])


def _logit_ticks(first: float, last: float) -> list[float]:
    """Those of matplotlib between 0 and 1; below 0 they are mirrored."""
    if first >= 0.0:
        ticks = LogitLocator(nbins=5).tick_values(first, last)
    else:
        below, above = (LogitLocator(nbins=4).tick_values(0.5, max(end, 0.999)) for end in (-first, last))
        ticks = [*(-tick for tick in reversed(below[1:])), 0.0, *above[1:]]
    ticks = [float(tick) for tick in ticks if first <= tick <= last]
    return ticks if len(ticks) >= 3 else [float(x) for x in MaxNLocator(5).tick_values(first, last)[1:-1]]


def _logit_text(value: float) -> str:
    """Short also close to 0 and to 1, where matplotlib's is too long for a narrow axis."""
    for end, rest in ((0.0, abs(value)), (1.0, 1.0 - abs(value))):
        power = math.log10(rest) if rest else 0.0
        if power < -3.5 and math.isclose(power, round(power), abs_tol=1e-3):
            sign, other = ("-", "+") if value < 0.0 else ("", "-")
            return f"${f'{sign}1{other}' if end else sign}10^{{{round(power)}}}$"
    return plain_number(value)


def edges_of(row: Row) -> np.ndarray:
    """Where the cells around the values of an axis end, printed; the outer ones end with the values."""
    if row.names is not None:
        return np.arange(row.values.size + 1) - 0.5
    spacing = row.spacing()
    values = row.values.astype(float)
    u = spacing.forward(values)
    return np.concatenate([values[:1], spacing.inverse(0.5 * (u[1:] + u[:-1])), values[-1:]]) / row.factor
