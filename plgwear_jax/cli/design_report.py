"""The report of `plgwear design`: numbers, words, tables and JSON."""

import dataclasses
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import typer
from rich.table import Table

from plgwear_jax import optimise
from plgwear_jax.cli.question import UNITS, amplitudes_told, words_of
from plgwear_jax.cli.terminal import console, measure, measures, table_of
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.optimise.problem import limited
from plgwear_jax.rules import is_linear
from plgwear_jax.scene import Scene

__all__ = [
    "Described",
    "Higher",
    "conflict_told",
    "described",
    "design_as_json",
    "edge_distance",
    "floats",
    "if_higher",
    "limit_words",
    "print_design",
    "print_sensitivities",
    "verdict",
]

Described = tuple[dict[str, float], dict[str, float]]  # quantities of the best contact, and of the reference


def edge_distance(found: optimise.Design, comparison: optimise.Comparison) -> float | None:
    """The distance inside the stick edge at which pressures are compared; None for gross slip."""
    return None if isinstance(found.reference, GrossSlipContact) else float(np.asarray(comparison.distance))


def described(found: optimise.Design, comparison: optimise.Comparison) -> Described:
    """The quantities of the best design and the reference, in SI units; all but the objective at the largest load."""
    described = []
    for which, contact in enumerate((found.contact, found.reference)):
        material: Any = contact.material  # a power law: others are not designed here
        quantities: dict[str, Any] = {"k": material.k, "E0": material.E0, "z0": material.z0}
        quantities |= {name: both[which] for name, both in comparison.quantities.items()}
        if isinstance(contact, FrettingContact):
            # (k-1)/2 of the body that gives way more at the edge: at k < 0 this is an elastic indenter
            k = material.k if is_closed(contact) else max(float(material.k), 0.0)
            quantities["edge_exponent"] = 0.5 * (k - 1.0)
        varied = (found.variables, found.reference_variables)[which]
        quantities = {name: value for name, value in varied.items() if name in UNITS} | quantities
        described.append({name: float(quantities[name]) for name in UNITS if name in quantities})
    best, reference = described
    return best, reference


class Higher(NamedTuple):
    """What happens if all force amplitudes are 10 % higher than assumed."""

    line: str
    loss: float | None = None


def if_higher(given: Scene, found: optimise.Design, words: dict[str, str]) -> Higher | None:
    """What the design loses, or breaks, if all amplitudes are 10 % higher than assumed; None without amplitudes."""
    if given.load is None or not isinstance(found.contact, FrettingContact):
        return None
    said = "if the force amplitude is 10 % higher than assumed,"
    try:
        higher = optimise.misjudged(found, 1.1)
    except ValueError:
        return Higher(f"{said} the contact slips as a whole")
    for limit, state in higher.limits.items():
        if not state.kept:
            name, _ = limited(limit)
            over = f"the {limit_words(found, words)[name]} is {measure(float(state.value), UNITS[name])}"
            return Higher(f"{said} this design breaks a limit: {over}")
    if not higher.best.converged:
        return Higher(f"{said} what it loses is not known: the search for the best one did not converge")
    loss = max(higher.loss, 0.0)
    lost = f"{100.0 * loss:.2g} %" if loss > 1e-6 else "nothing"
    return Higher(f"{said} this design loses {lost} against the best one for it", loss)


def _saving(found: optimise.Design, best: dict[str, float], reference: dict[str, float], words: dict[str, str]) -> str:
    """What the design gains, and what that costs in edge stress."""
    much = f"{abs(100.0 * found.saving):.3g} % {'less' if found.saving >= 0.0 else 'MORE'}"
    line = f"{much} {words[found.objective].partition(',')[0]} than the reference"
    if "edge_pressure" not in best:
        return line
    times = best["edge_pressure"] / reference["edge_pressure"]
    return f"{line}, at {times:.3g} times its {words['edge_pressure']}"


def verdict(found: optimise.Design) -> str:
    """Whether this is the best design, and how certain that is."""
    if not found.keeps_limits:
        return "NO DESIGN THAT KEEPS THE LIMITS was found; the one that comes nearest is shown"
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best design that it found"
    if not found.certified:
        return "the search converged, but there MAY BE LESS WEAR ELSEWHERE between the bounds"
    if found.proven:
        return "the search converged; nothing better was found, and nothing better can lie between the points scanned"
    hiding = "it is not proven that nothing better lies between the points scanned"
    return f"the search converged; nothing better was found, but {hiding}"


def limit_words(found: optimise.Design, words: dict[str, str]) -> dict[str, str]:
    """The name of each quantity, where moduli and radii are those of the limits."""
    window = found.question.window
    for name, limit in found.question.limits.items():
        if limit is not window and "r" in limit.places:
            at = measure(float(np.asarray(limit.places["r"])), "m")
            words = words | {name: f"{words[name].partition(',')[0]} at r = {at}"}
    moduli = {} if window is None else words_of(0.0, floats(window.at))
    return words | {name: moduli[name] for name in ("shallow_modulus", "deep_modulus") if moduli}


def conflict_told(why: optimise.Conflict, words: dict[str, str]) -> str:
    """Which limits cannot be kept together, and what is reachable."""
    limits, reached, names = [], [], []
    for name, allowed in why.allowed.items():
        what, lowest = limited(name)
        limits.append(f"{words[what]} {'above' if lowest else 'below'} {measure(allowed, UNITS[what])}")
        best = measure(why.reachable[name], UNITS[what])
        reached.append(f"the {'largest' if lowest else 'least'} {words[what]} is {best}")
        names.append(words[what])
    if len(limits) == 1:
        return f"limits: {limits[0]} cannot be kept between the bounds of what varies: {reached[0]}"
    if len(limits) == 2:
        pairs = zip(reversed(names), reached, strict=True)
        told = "; ".join(f"with the {kept} kept, {best}" for kept, best in pairs)
        return f"limits: {' and '.join(limits)} cannot both be kept: {told}"
    together = f"{', '.join(limits[:-1])} and {limits[-1]}"
    return f"limits: {together} cannot all be kept: with the others kept, {', '.join(reached)}"


def _rival(found: optimise.Design) -> str | None:
    """The next best minimum, in words."""
    if found.rival is None:
        return None
    where = ", ".join(f"{name} = {measure(value, UNITS[name])}" for name, value in found.rival.items())
    more = found.rival_value / float(found.value) - 1.0
    worse = f"{100.0 * more:.2g} % worse" if more < 1.0 else f"worse: {1.0 + more:.2g} times as much"
    return f"the next best minimum, at {where}, is {worse if more > 1e-9 else 'as good'}"


def design_as_json(
    given: Scene,
    found: optimise.Design,
    described: Described,
    distance: float | None,
    higher: Higher | None,
    why: optimise.Conflict | None,
) -> dict[str, Any]:
    """The report as one object."""
    best, reference = described
    return {
        "best": best,
        "reference": reference,
        "units": {name: unit for name, unit in UNITS.items() if name in best | found.bounds},
        "edge_distance": distance,
        "objective": found.objective,
        "load": amplitudes_told(given, found.objective),
        "less_wear_percent": 100.0 * found.saving,
        "vary": {
            name: {"value": found.variables[name], "bounds": list(ends), "at_bound": found.at_bound[name]}
            for name, ends in found.bounds.items()
        },
        "hold": found.hold,
        "limits": {
            name: {
                "value": float(state.value),
                "allowed": float(np.asarray(state.allowed)),
                "kept": state.kept,
                "active": state.active,
                "multiplier": float(state.multiplier),
            }
            for name, state in found.limits.items()
        },
        "conflict": None if why is None else dataclasses.asdict(why),
        "verdict": verdict(found),
        "converged": found.converged,
        "certified": found.certified,
        "proven": found.proven,
        "projected_gradient": float(found.minimum.projected_gradient),
        "steps": int(found.minimum.steps),
        "rival": None if found.rival is None else {"variables": found.rival, "value": found.rival_value},
        "if_10_percent_higher": None if higher is None else {"line": higher.line, "loss": higher.loss},
    }


def print_design(
    scene_file: Path,
    given: Scene,
    found: optimise.Design,
    described: Described,
    words: dict[str, str],
    higher: Higher | None,
    why: optimise.Conflict | None,
) -> None:
    """The report as tables and lines."""
    best, reference = described
    measured = amplitudes_told(given, found.objective)
    if measured is not None:
        typer.echo(measured)
    table = table_of(scene_file)
    table.add_column("")
    for heading in (_found_as(found), "reference"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, value in best.items():
        table.add_row(words[name], *measures((value, reference[name]), UNITS[name]))
    console().print(table)
    _print_allowed(found, words)
    if found.keeps_limits:
        lines = _saving(found, best, reference, words), verdict(found), _rival(found), higher and higher.line
    else:  # savings have no meaning here
        lines = verdict(found), why and conflict_told(why, limit_words(found, words))
    for line in (*lines, _too_stiff(best)):
        if line:
            typer.echo(line)


def _found_as(found: optimise.Design) -> str:
    return "best" if found.keeps_limits else "nearest"


_DIAMOND = 1.2e12  # Pa


def _too_stiff(best: dict[str, float]) -> str | None:
    """A line about moduli that cannot be made."""
    modulus = best["modulus_at_radius"]
    if modulus < _DIAMOND:
        return None
    return f"{measure(modulus, 'Pa')} is stiffer than diamond: limit E(z) by limits = {{ modulus = ... }}"


def _print_allowed(found: optimise.Design, words: dict[str, str]) -> None:
    """What was varied and limited, and which bounds and limits the design reaches."""
    table = Table()
    table.add_column("varied and limited" if found.limits else "varied")
    table.add_column(_found_as(found), justify="right", no_wrap=True)
    table.add_column("allowed", no_wrap=True)
    table.add_column("")
    for name, ends in found.bounds.items():
        lower, upper = (measure(end, UNITS[name]) for end in ends)
        side = found.at_bound[name]
        symbol = name if name in ("k", "E0", "z0", "nu") else words[name].partition(",")[0]
        value = measure(found.variables[name], UNITS[name])
        standing = f"at the {side} bound" if side else "between"
        if side and found.keeps_limits:
            # the slope of the objective's logarithm by k, or by the logarithm of the variable
            gain = abs(float(found.minimum.bound_multipliers[name]))
            standing += f"; {'0.01' if is_linear(name) else '1 %'} wider saves {gain:.2g} %"
        table.add_row(symbol, value, f"{lower} to {upper}", standing)
    words = limit_words(found, words)
    for name, state in found.limits.items():
        what, least = limited(name)
        value, allowed = (measure(float(np.asarray(x)), UNITS[what]) for x in (state.value, state.allowed))
        standing = "kept" if state.kept else "BROKEN"
        if state.active and found.keeps_limits:
            standing = f"reached; 1 % looser saves {float(state.multiplier):.2g} %"
        table.add_row(words[what], value, f"at {'least' if least else 'most'} {allowed}", standing)
    console().print(table)


def floats(pair: Any) -> tuple[float, float] | None:
    """Two numbers, if they are there."""
    return None if pair is None else (float(np.asarray(pair[0])), float(np.asarray(pair[1])))


_NEGLIGIBLE = 1e-6  # smaller changes are not printed


def print_sensitivities(slopes: optimise.Sensitivities) -> None:
    """The changes if an input grows by 1 %; inputs that change nothing are only named."""
    typer.echo("what changes if an input grows by 1 % (k, nu: by 0.01):")
    table = Table()
    table.add_column("input", no_wrap=True)
    table.add_column("saving (points)", justify="right", no_wrap=True)
    for name in next(iter(slopes.variables.values())):
        table.add_column(name if is_linear(name) else f"{name} (%)", justify="right", no_wrap=True)
    idle = []
    for source, by in slopes.variables.items():
        changes = [slopes.saving[source], *(0.01 * x if is_linear(name) else x for name, x in by.items())]
        if all(abs(change) < _NEGLIGIBLE for change in changes):
            idle.append(source)
        else:
            # not the best k, which is a result
            label = "k of the reference" if source == "k" else source
            table.add_row(label, *(f"{x:+.2g}" if abs(x) >= _NEGLIGIBLE else "0" for x in changes))
    console().print(table)
    if idle:
        typer.echo(f"without effect: {', '.join(idle)}")
