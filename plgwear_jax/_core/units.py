"""Numbers with a convenient SI prefix."""

import math
import re
from collections.abc import Iterator


def text_cells(text: str) -> Iterator[list[str]]:
    """The cells of each line of a table: columns are set off by two spaces, and "-" is an empty one."""
    for line in text.strip().splitlines():
        yield ["" if cell == "-" else cell for cell in re.split("  +", line.strip())]


def scales_of(text: str) -> dict[str, dict[str, float]]:
    """What prefixed units are in a unit, from a line for each: the unit, then names and sizes of the prefixed ones."""
    return {unit: dict(zip(cells[::2], map(float, cells[1::2]), strict=True)) for unit, *cells in text_cells(text)}


PREFIXED = scales_of("""
    m    m  1      mm  1e-3    µm  1e-6    nm  1e-9     pm  1e-12
    m^3  m³  1     mm³  1e-9   µm³  1e-18  nm³  1e-27
    Pa   TPa  1e12  GPa  1e9   MPa  1e6    kPa  1e3     Pa  1
    N    MN  1e6   kN  1e3     N  1        mN  1e-3     µN  1e-6
    J    J  1      mJ  1e-3    µJ  1e-6    nJ  1e-9     pJ  1e-12
    1    -  1
""")


def readable(size: float, unit: str) -> tuple[float, str]:
    """A convenient SI prefix for a number of this size.

    Args:
        size: The number, or the largest of several, in the unit.
        unit: "m", "m^3", "Pa", "N", "J", or "1" for a plain number; others take no prefix.

    Returns:
        (The size of the prefixed unit in the unit, to divide numbers by; its name).

    Examples:
        >>> from plgwear_jax import plots
        >>> plots.readable(6.8e-5, "m")
        (1e-06, 'µm')
    """
    size = abs(size) or 1.0  # 0 has the unit itself
    smallest = 0.1 if unit == "m^3" else 1.0  # the prefixes of a volume are nine decades apart
    known = [(factor, name) for name, factor in PREFIXED.get(unit, {unit: 1.0}).items()]
    return max((one for one in known if size >= smallest * one[0]), default=min(known))


def written(value: float, unit: str) -> str:
    """A number with its unit as a person writes it, "68 µm"."""
    if math.isinf(value):
        return "infinite" if value > 0.0 else "-infinite"
    factor, prefixed = readable(value, unit)
    return f"{value / factor:.4g} {prefixed}".rstrip()
