"""A design in a few lines, as Python prints it."""

import textwrap
from typing import Any

import numpy as np

__all__ = ["told"]

_WIDTH = 98


def told(found: Any) -> str:
    """Of a `Design`: the objective, the variables, the material, what was held and limited, and what is certain."""
    share = 100.0 * found.saving
    much = f"{abs(share):.3g} % {'less' if share >= 0.0 else 'more'} than the reference"
    lines = [f"{found.objective} = {_short(found.value)}, {much}"]
    for name, value in found.variables.items():
        lowest, highest = found.bounds[name]
        side = found.at_bound[name]
        place = f", at the {side} bound" if side else ""
        lines.append(f"{name} = {_short(value)}, between {_short(lowest)} and {_short(highest)}{place}")
    material = found.contact.material
    fields = ", ".join(f"{name}={_short(getattr(material, name))}" for name in ("E0", "z0", "k", "nu"))
    lines.append(f"material: {fields}{f'; {found.hold}' if found.hold else ''}")
    if found.load is not None:
        counting = int(np.count_nonzero(np.asarray(found.load.weight)))
        largest = _short(np.max(np.asarray(found.load.tangential_force)))
        lines.append(f"load: {f'{counting} amplitudes, at most ' if counting > 1 else ''}{largest} N")
    if found.limits:
        limits = (
            f"{name} {_short(state.value)} {'>=' if state.lowest else '<='} {_short(state.allowed)}"
            f"{'' if state.kept else ' BROKEN'}"
            for name, state in found.limits.items()
        )
        lines += textwrap.wrap(f"limits: {', '.join(limits)}", _WIDTH - 2, subsequent_indent="  ")
    known = {name: getattr(found, name) for name in ("converged", "certified", "proven")}
    lines.append(", ".join(name if true else f"not {name}" for name, true in known.items()))
    return "\n  ".join(["Design:", *lines])


def _short(value: Any) -> str:
    return value if isinstance(value, str) else f"{float(np.asarray(value)):.4g}"
