"""What is drawn, and its labels, units, symbols and titles."""

import math
import re
import textwrap
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from plgwear_jax._core.units import PREFIXED, readable
from plgwear_jax._core.words import one_line
from plgwear_jax.catalogue import Entry, Law, derivative, leaf, quantity
from plgwear_jax.sweep.plan import LOAD

DECADES = 2.0  # values over more decades need a logarithmic scale


class MapError(ValueError):
    """Why a picture cannot be drawn, in one line."""


class Span(NamedTuple):
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


class Subject(NamedTuple):
    """A quantity, its values with the rows from bottom to top, the sweep, and what a NaN means."""

    variable: xr.DataArray
    values: np.ndarray
    ds: xr.Dataset
    missing: str


_OF_A_SEARCH = {"saving": "share saved", "rival": "next best exponent"}


def axis_words(variable: xr.DataArray, dim: str) -> tuple[str, str]:
    """What an axis is called, and its symbol."""
    if dim == "radius" and "depth" in variable.coords:
        return "radius of the punch", "a"
    kind = Entry("load", "", "1") if dim == LOAD else leaf(dim)
    return plain_text(kind.words.replace("_", " ")), kind.symbol


def words_of(variable: xr.DataArray) -> str:
    """A quantity in a few words and its symbol; of a derivative only that."""
    stem, slopes = derivative(quantity_of(variable))
    head, _, name = stem.partition(".")
    if head not in ("optimal_exponent", "design"):
        head, name = "", stem
    known = quantity(name) or leaf(name)
    words, symbol = _OF_A_SEARCH.get(name, plain_text(known.name.replace("_", " "))), known.symbol
    if head and isinstance(known, Law):
        words = f"least {words}"
    elif head and symbol:
        words, symbol = f"best {words}", f"{symbol}^*"
    if not slopes:
        return f"{words} ${symbol}$" if symbol else words
    power = f"^{len(slopes)}" if len(slopes) > 1 else ""
    below = []
    for slope in dict.fromkeys(slopes):
        times = slopes.count(slope)
        axis = axis_words(variable, slope)[1] or rf"\mathrm{{{slope.replace('_', ' ')}}}"
        below.append(rf"\partial {f'{{{axis}}}^{times}' if times > 1 else axis}")
    if len(symbol) > 3 and "-" in symbol:
        symbol = f"({symbol})"
    over = rf"\partial{power} {symbol}" if symbol else rf"\partial{power}"
    under = r"\,".join(below)
    slope = f"${over}/{under if len(below) == 1 else f'({under})'}$"
    return slope if symbol else f"{slope} of {words}"


def quantity_of(variable: xr.DataArray) -> str:
    """The quantity as it was asked for: "wear_volume.dk" of the variable `wear_volume_dk`."""
    return str(variable.attrs.get("quantity", variable.name))


def unit_of(subject: Subject, span: Span) -> tuple[float, str]:
    """The unit in which a quantity of this span is printed."""
    variable = subject.variable
    unit = str(variable.attrs.get("units", "1"))
    size = math.sqrt(span.lower * span.upper) if span.log else max(abs(span.lower), abs(span.upper))
    first, *rest = re.sub("[()]", "", unit).split("/")
    if first not in PREFIXED or not all(part in PREFIXED for part in rest):
        factor, text = 1.0, printed_unit(unit)
    else:
        factor, below = 1.0, []
        axes = [slope for slope in derivative(quantity_of(variable))[1] if leaf(slope).unit != "1"]
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


def printed_unit(unit: str) -> str:
    """A unit of the paper as a formula; nothing for a plain number."""
    if unit == "1":
        return ""
    if unit == "1/Pa":
        return unit
    text = re.sub(r"\b(pi|mu|theta)\b ?", r"\\\1 ", unit.replace("F_N0", "F_{N0}"))
    return f"${text}$"


def value_text(dim: str, variable: xr.DataArray, value: Any) -> str:
    """The value of an axis in print."""
    if isinstance(value, str):
        return f"{axis_words(variable, dim)[0]} = {plain_text(value)}"
    words, symbol = axis_words(variable, dim)
    unit = str(variable[dim].attrs.get("units", "1"))
    factor, text = readable(float(value), unit) if unit in PREFIXED else (1.0, printed_unit(unit))
    number = plain_number(float(value) / factor, 4)
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


def title_of(variable: xr.DataArray, told: list[str]) -> str:
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


def plain_text(text: str) -> str:
    """One line in which nothing is a formula."""
    return one_line(text).replace("$", r"\$")


def plain_number(number: float, digits: int = 6) -> str:
    """A number with the sign that print has for less than nothing."""
    text = f"{number + 0.0:.{digits}g}"
    if "e" in text:
        mantissa, power = text.split("e")
        return rf"${mantissa}\times10^{{{int(power)}}}$"
    return text.replace("-", "−")
