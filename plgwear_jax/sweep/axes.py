"""The values of the axes of a sweep: how they are written on a command line, and which are allowed."""

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from plgwear_jax._core.catalogue import AXES, leaf
from plgwear_jax._core.domains import check
from plgwear_jax._core.words import GivenError, cut, one_line, read_text
from plgwear_jax.tables import number_in, numbered_lines

_SPACINGS = "linear", "log", "logit"


class AxisError(GivenError):
    """An error in the values of an axis, in one line: its name, the value, and what is allowed."""


def check_axis(name: str, values: Any) -> np.ndarray:
    """The values of an axis as real numbers, a single one or a row of them.

    Raises:
        AxisError: There is none, one is outside its range, or they are no row of real numbers.
    """
    try:
        check(name, values, leaf(name).domain)
    except (TypeError, ValueError) as error:
        raise AxisError(one_line(str(error))) from None
    array = np.asarray(values)
    if array.ndim > 1:
        raise AxisError(f"{name}: takes a number or a row of numbers, not an array of shape {array.shape}")
    if array.size == 0:
        raise AxisError(f"{name}: holds no values; there must be at least one")
    return array if array.dtype == np.float32 else array.astype(float)


def spacing_of(name: str, values: np.ndarray) -> str:
    """The spacing on which the values of an axis are the most even: "linear", "log" or "logit", for pictures."""
    lower, upper = leaf(name).interval or (math.nan, math.nan)
    if values.size < 3:
        return "linear"
    with np.errstate(all="ignore"):
        stretched = np.stack([values, np.log(values), np.log((values - lower) / (upper - values))])
        uneven = np.nan_to_num(np.ptp(np.diff(stretched), axis=1) / np.ptp(stretched[:, [0, -1]], axis=1), nan=np.inf)
    return _SPACINGS[0 if uneven[0] < 1e-3 else uneven.argmin()]


# --- as text --------------------------------------------------------------------------------------------------------

_MOST = 100_000_000
_FORMS = "a number, start:stop:count, start:stop:count:log, start:stop:count:logit, or a file, one value per line"


def read_axis(name: str, text: str) -> np.ndarray:
    """The values of an axis from their text.

    Args:
        name: A leaf of a contact or an argument, as of `catalogue.leaf`.
        text: A number; `start:stop:count`, with `:log` for even steps of the logarithm or `:logit` for steps that get
            finer towards both ends of the range of k or phi; or the name of a file with one value on each line, in
            which blank lines and comments (#) are skipped.

    Returns:
        A single number of shape (), or a row of them. Both ends are among the values.

    Raises:
        AxisError: The text is none of these, or a value is outside its range: in one line.
    """
    said, parts = f"{name} = {cut(one_line(text))}", text.split(":")
    number = number_in(text)
    if number is not None:
        return check_axis(name, number)
    if number_in(parts[0]) is not None or (not Path(text).exists() and len(parts) > 2):
        return check_axis(name, _spaced(name, said, parts))
    if not os.path.lexists(text):
        raise AxisError(f"{said}: must be {_FORMS}; there is no such file")
    file = one_line(text)
    lines = numbered_lines(read_text(text, "the values of an axis come from a file, one per line", AxisError))
    if not lines:
        raise AxisError(f"{file}: holds no values of {name}; there must be at least one")
    # A word is NaN, which no axis takes.
    domain, values = leaf(name).domain, np.array([*map(number_in, lines.values())], float)
    for (row, line), inside in zip(lines.items(), domain.contains(values), strict=True):
        if not inside:
            raise AxisError(f"{file}: row {row}: {name} = {cut(one_line(line.strip()))}: must be {domain.text}")
    return values


def _spaced(name: str, said: str, parts: list[str]) -> np.ndarray:
    """The values of the range start:stop:count[:spacing], whose parts are given; `said` begins a complaint."""
    if len(parts) not in (3, 4):
        raise AxisError(f"{said}: must be {_FORMS}")
    start, stop = ends = np.array([*map(number_in, parts[:2])], float)  # a word is NaN
    if not np.isfinite(ends).all():
        raise AxisError(f"{said}: start and stop must be finite numbers")
    if not (parts[2].strip().isdecimal() and 1 <= int(parts[2]) <= _MOST):
        raise AxisError(f"{said}: the count must be a whole number from 1 to {_MOST}")
    count, spacing = int(parts[2]), [*parts, "linear"][3].strip()
    if spacing not in _SPACINGS:
        raise AxisError(f"{said}: the spacing must be one of {', '.join(_SPACINGS)}")
    if count == 1 and start != stop:
        raise AxisError(f"{said}: a count of 1 leaves out an end; write a single value as a number")
    if spacing == "linear":
        return np.linspace(start, stop, count)
    within = (0.0, math.inf) if spacing == "log" else leaf(name).interval
    if within is None:
        able = ", ".join(axis for axis, kind in AXES.items() if kind.interval is not None)
        raise AxisError(f"{said}: logit is only for {able}")
    lower, upper = within
    if not lower < ends.min() <= ends.max() < upper:
        must = "> 0" if spacing == "log" else f"between {lower:g} and {upper:g}"
        raise AxisError(f"{said}: with {spacing} both ends must be {must}")
    if spacing == "log":
        return np.geomspace(start, stop, count)
    first, last = (math.log((end - lower) / (upper - end)) for end in ends)
    values = lower + (upper - lower) / (1.0 + np.exp(-np.linspace(first, last, count)))
    values[[0, -1]] = ends
    return values
