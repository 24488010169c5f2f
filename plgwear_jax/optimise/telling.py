"""A design in a few lines, as Python prints it."""

import textwrap
from typing import Any

import numpy as np

from plgwear_jax._core.units import readable
from plgwear_jax.catalogue import entry
from plgwear_jax.optimise.problem import limited

__all__ = ["told"]

_WIDTH = 98


def told(found: Any) -> str:
    """Of a `Design`: the objective, the variables, the material, what was held and limited, and what is certain."""
    share = 100.0 * found.saving
    much = f"{abs(share):.3g} % {'less' if share >= 0.0 else 'more'} than the reference"
    lines = [f"{found.objective} = {_measure(found.objective, found.value)}, {much}"]
    for name, value in found.variables.items():
        lowest, highest = (_measure(name, end) for end in found.bounds[name])
        side = found.at_bound[name]
        place = f", at the {side} bound" if side else ""
        lines.append(f"{name} = {_measure(name, value)}, between {lowest} and {highest}{place}")
    material = found.contact.material
    power = [name for name in ("E0", "z0", "k") if hasattr(material, name)]
    fields = ", ".join(f"{name} = {_measure(name, getattr(material, name))}" for name in power) or "E(z) at depths"
    lines.append(f"material: {fields}{f'; {found.hold}' if found.hold else ''}")
    if found.load is not None:
        counting = int(np.count_nonzero(np.asarray(found.load.weight)))
        largest = np.max(np.asarray(found.load.tangential_force))
        lines.append(f"load: {f'{counting} amplitudes, at most ' if counting > 1 else ''}{largest:.4g} N")
    if found.limits:
        limits = []
        for name, state in found.limits.items():
            what, lowest = limited(name)
            value, allowed = (_measure(what, number) for number in (state.value, state.allowed))
            limits.append(f"{what} {value} {'>=' if lowest else '<='} {allowed}{'' if state.kept else ' BROKEN'}")
        lines += textwrap.wrap(f"limits: {', '.join(limits)}", _WIDTH - 2, subsequent_indent="  ")
    known = {name: getattr(found, name) for name in ("converged", "certified", "proven")}
    lines.append(", ".join(name if true else f"not {name}" for name, true in known.items()))
    return "\n  ".join(["Design:", *lines])


def _measure(name: str, value: Any) -> str:
    number, unit = float(np.asarray(value)), entry(name).unit
    factor, prefixed = (1.0, "") if unit == "1" else readable(abs(number), unit)
    return f"{number / factor:.4g} {prefixed}".rstrip()
