"""Numbers with a convenient SI prefix."""

import math

PREFIXED = {
    "m": {1.0: "m", 1e-3: "mm", 1e-6: "µm", 1e-9: "nm", 1e-12: "pm"},
    "m^3": {1.0: "m³", 1e-9: "mm³", 1e-18: "µm³", 1e-27: "nm³"},
    "Pa": {1e12: "TPa", 1e9: "GPa", 1e6: "MPa", 1e3: "kPa", 1.0: "Pa"},
    "N": {1e6: "MN", 1e3: "kN", 1.0: "N", 1e-3: "mN", 1e-6: "µN"},
    "J": {1.0: "J", 1e-3: "mJ", 1e-6: "µJ", 1e-9: "nJ", 1e-12: "pJ"},
    "1": {1.0: ""},
}


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
    scales = PREFIXED.get(unit, {1.0: unit})
    if size == 0.0:
        return 1.0, scales[1.0]
    smallest = 0.1 if unit == "m^3" else 1.0  # the prefixes of a volume are nine decades apart
    for factor, name in scales.items():
        if abs(size) >= smallest * factor:
            return factor, name
    return min(scales.items())


def written(value: float, unit: str) -> str:
    """A number with its unit as a person writes it, "68 µm"."""
    if math.isinf(value):
        return "infinite" if value > 0.0 else "-infinite"
    factor, prefixed = readable(value, unit)
    return f"{value / factor:.4g} {prefixed}".rstrip()
