"""What `plgwear design` says about a design: numbers, words and tables."""

import dataclasses
from typing import Any, NamedTuple

import numpy as np

from plgwear_jax import optimise
from plgwear_jax.catalogue import DESIGNED, placed
from plgwear_jax.cli.question import amplitudes_told, saved, words_of
from plgwear_jax.cli.report import Column, Report, counted, fields, measure
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.optimise.answers import doubtful
from plgwear_jax.rules import OF_POWER_LAW, is_linear
from plgwear_jax.scene import Scene


class Higher(NamedTuple):
    """What happens if all amplitudes are 10 % higher than assumed."""

    line: str
    loss: float | None = None


class Findings(NamedTuple):
    """What a report on a design needs.

    Attributes:
        given: The scene.
        found: The design.
        best: The quantities of the best contact, in SI units, by name.
        reference: Those of the reference.
        distance: The distance inside the stick edge at which pressures are compared; None for gross slip.
        words: What the quantities are called.
        limited: What each limit limits, at its place, by the name of the limit.
        why: Which limits cannot be kept together, if any.
        forever: What a design for a number of cycles does in the steady state.
        higher: What happens under a higher load; None without amplitudes.
        doubtful: Why nobody would make or measure the best coating, if so.
    """

    given: Scene
    found: optimise.Design
    best: dict[str, float]
    reference: dict[str, float]
    distance: float | None
    words: dict[str, str]
    limited: dict[str, str]
    why: optimise.Conflict | None
    forever: optimise.InSteadyState | None
    higher: Higher | None
    doubtful: str | None


def findings(given: Scene, found: optimise.Design, comparison: optimise.Comparison) -> Findings:
    """Compute all that the report on a design needs, but for sensitivities."""
    punch = isinstance(found.reference, GrossSlipContact)
    distance = None if punch else float(np.asarray(comparison.distance))
    words = words_of(distance or 0.0, found.bounds)
    if given.life is not None:
        words[found.objective] += f" after {counted(given.life)} cycles"
    why = optimise.conflict(found)
    question = found.question
    steady = question.horizon is not None and question.by_force and found.keeps_limits and question.scenarios is None
    forever = optimise.in_steady_state(found) if steady else None
    limited = {
        one.name: placed(one.quantity, one.places) if {"r", "z"} & {*one.places} else words[one.quantity]
        for one in question.limits
    }
    higher = _if_higher(given, found, words, limited)
    best, reference = described(found, comparison)
    if "edge_pressure" not in comparison.quantities:  # in gross slip there is no stick edge, and else it moves
        for one in (best, reference):
            one.pop("edge_exponent", None)
    told = doubtful(found, comparison)
    return Findings(given, found, best, reference, distance, words, limited, why, forever, higher, told)


def described(found: optimise.Design, comparison: optimise.Comparison) -> tuple[dict[str, float], dict[str, float]]:
    """The quantities of the best design and the reference, in SI units; all but the objective at the largest load."""
    described = []
    for which, contact in enumerate((found.contact, found.reference)):
        material: Any = contact.material
        quantities = {name: getattr(material, name) for name in OF_POWER_LAW if hasattr(material, name)}
        quantities |= {name: both[which] for name, both in comparison.quantities.items()}
        if isinstance(contact, FrettingContact):
            # (k-1)/2 of the body that deforms more at the edge: at k < 0 this is an elastic indenter
            k = quantities.get("k", 0.0)
            k = k if is_closed(contact) else max(float(k), 0.0)
            quantities["edge_exponent"] = 0.5 * (k - 1.0)
        varied = (found.variables, found.reference_variables)[which]
        quantities = dict(varied) | quantities
        ordered = dict.fromkeys([*DESIGNED, *quantities])
        described.append({name: float(quantities[name]) for name in ordered if name in quantities})
    best, reference = described
    return best, reference


def _if_higher(given: Scene, found: optimise.Design, words: dict[str, str], limited: dict[str, str]) -> Higher | None:
    """How far the design is from the best one, or violates a limit, if all amplitudes are 10 % higher; None without."""
    if given.load is None or not isinstance(found.contact, FrettingContact):
        return None
    question = found.question
    if not question.by_force and question.scenarios is not None and question.scenarios.tangential_force is not None:
        return None  # which scenarios slip as a whole would change
    blocks = found.load is not None and found.load.amplitudes is None
    said = f"at a 10 % higher {'force' if question.by_force else 'displacement'} amplitude"
    said = "with all amplitudes 10 % higher" if blocks else said
    try:
        higher = optimise.under_other_load(found, 1.1)
    except ValueError:
        return Higher(f"{said} the contact is in gross slip")
    for name, state in higher.limits.items():
        if not state.kept:
            over = f"the {limited[name]} is {measure(float(state.value), state.quantity)}"
            return Higher(f"{said} this design violates a limit: {over}")
    if not higher.best.converged:
        return Higher(f"{said} the best design is not known: the search for it did not converge")
    loss = max(higher.loss, 0.0)
    if loss <= 1e-6:
        return Higher(f"{said} this design is still the best", loss)
    more = f"{100.0 * loss:.2g} % more {words[found.objective].partition(',')[0]}"
    return Higher(f"{said} this design has {more} than the best one for that amplitude", loss)


def _saving(one: Findings) -> str:
    """What the design gains, and what that costs in edge stress."""
    line = saved(one.found.saving, one.words[one.found.objective])
    if "edge_pressure" not in one.best:
        return line
    times = one.best["edge_pressure"] / one.reference["edge_pressure"]
    return f"{line}, at {times:.3g} times its {one.words['edge_pressure']}"


def _verdict(found: optimise.Design) -> str:
    """Whether this is the best design, and how certain that is."""
    if not found.keeps_limits:
        return "NO DESIGN THAT KEEPS THE LIMITS was found; the closest design is shown, limits violated"
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best design that it found"
    if not found.certified:
        return "the search converged, but there MAY BE LESS WEAR ELSEWHERE between the bounds"
    said = "the search converged; global search found nothing better"
    if found.scan_found_nothing_better:
        return f"{said}, none expected between the points of the scan (curvature is estimated, not bounded)"
    return f"{said}, but the scan has too few points to say what lies between them"


def _conflict_told(one: Findings) -> str | None:
    """Which limits cannot be kept together, and what is reachable; None if all can."""
    if one.why is None:
        return None
    limits, reached, names = [], [], []
    for limit in one.found.question.limits:
        if limit.name in one.why.allowed:
            said, best = one.limited[limit.name], measure(one.why.reachable[limit.name], limit.quantity)
            allowed = measure(one.why.allowed[limit.name], limit.quantity)
            limits.append(f"{said} {'above' if limit.lowest else 'below'} {allowed}")
            reached.append(f"the {'largest' if limit.lowest else 'least'} {said} is {best}")
            names.append(said)
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
    where = ", ".join(f"{name} = {measure(value, name)}" for name, value in found.rival.items())
    more = found.rival_value / float(found.value) - 1.0
    worse = f"{100.0 * more:.2g} % worse" if more < 1.0 else f"worse: {1.0 + more:.2g} times as much"
    return f"the next best minimum, at {where}, is {worse if more > 1e-9 else 'as good'}"


def tell_design(report: Report, one: Findings) -> None:
    """The design next to its reference, what was varied and limited, how certain it is, and the steady state."""
    found, load = one.found, amplitudes_told(one.given, one.found.objective)
    report.say(load)
    both = {name: (value, one.reference[name]) for name, value in one.best.items()}
    report.compare({"best": _found_as(found), "reference": "reference"}, both, words=one.words)
    report.put(edge_distance=one.distance, objective=found.objective, load=load)
    _tell_allowed(report, one)
    report.put(
        less_wear_percent=100.0 * found.saving,
        **fields(found, "hold", "converged", "certified", "scan_found_nothing_better"),
        conflict=one.why and fields(one.why, "allowed", "reachable"),
        verdict=_verdict(found),
        **fields(found.minimum, "projected_gradient", "steps"),
        rival=None if found.rival is None else {"variables": found.rival, "value": found.rival_value},
        if_10_percent_higher=one.higher and one.higher._asdict(),
    )
    if found.keeps_limits:
        report.say(_saving(one), _verdict(found), _rival(found), one.higher and one.higher.line)
    else:  # savings have no meaning here
        report.say(_verdict(found), _conflict_told(one))
    report.say(one.doubtful)
    _tell_life(report, one)


def uncertain(one: Findings) -> list[str]:
    """What is to be warned of, if the design is not certainly the best."""
    if one.found.certified:
        return []
    return [line for line in (_verdict(one.found), _conflict_told(one)) if line]


def _found_as(found: optimise.Design) -> str:
    return "best" if found.keeps_limits else "closest"


def _tell_allowed(report: Report, one: Findings) -> None:
    """What was varied and limited, and which bounds and limits the design reaches."""
    found, rows = one.found, []
    for name, ends in found.bounds.items():
        side, value = found.at_bound[name], found.variables[name]
        symbol = name if name in ("k", "E0", "z0", "nu") else one.words[name].partition(",")[0]
        standing = f"at the {side} bound" if side else "between"
        if side and found.keeps_limits:
            # the slope of the objective's logarithm by k, or by the logarithm of the variable
            gain = abs(float(found.minimum.bound_multipliers[name]))
            standing += f"; widening it by {'0.01' if is_linear(name) else '1 %'} saves {gain:.2g} %"
        rows.append((symbol, measure(value, name), " to ".join(measure(end, name) for end in ends), standing))
    for name, state in found.limits.items():
        value, allowed = (measure(float(np.asarray(x)), state.quantity) for x in (state.value, state.allowed))
        standing = "kept" if state.kept else "VIOLATED"
        if state.active and found.keeps_limits:
            standing = f"active; relaxing it by 1 % saves {float(state.multiplier):.2g} %"
        rows.append((one.limited[name], value, f"at {'least' if state.lowest else 'most'} {allowed}", standing))
    report.put(
        vary={
            name: {"value": found.variables[name], "bounds": list(ends), "at_bound": found.at_bound[name]}
            for name, ends in found.bounds.items()
        },
        limits={
            name: fields(x, "value", "allowed", "kept", "active", "multiplier") for name, x in found.limits.items()
        },
    )
    columns = (
        Column("varied and limited" if found.limits else "varied", left=True, wrap=True),
        Column(_found_as(found)),
        Column("allowed", left=True),
        Column("", left=True, wrap=True),
    )
    report.table(*columns, rows=rows, title="")


_NEGLIGIBLE = 1e-6  # smaller changes are not printed


def tell_sensitivities(report: Report, slopes: optimise.Sensitivities) -> None:
    """The changes if an input grows by 1 %; inputs that change nothing are only named."""
    report.put(sensitivities=dataclasses.asdict(slopes))
    columns, rows, idle = [Column("input", left=True), Column("saving (points)")], [], []
    for name in next(iter(slopes.variables.values())):
        columns.append(Column(name if is_linear(name) else f"{name} (%)"))
    for source, by in slopes.variables.items():
        changes = [slopes.saving[source], *(0.01 * x if is_linear(name) else x for name, x in by.items())]
        if all(abs(change) < _NEGLIGIBLE for change in changes):
            idle.append(source)
        else:
            # not the best k, which is a result
            label = "k of the reference" if source == "k" else source
            rows.append([label, *(f"{x:+.2g}" if abs(x) >= _NEGLIGIBLE else "0" for x in changes)])
    report.say("what changes if an input grows by 1 % (k, nu: by 0.01):")
    report.table(*columns, rows=rows, title="")
    report.say(f"without effect: {', '.join(idle)}" if idle else None)


def _tell_life(report: Report, one: Findings) -> None:
    """What a design for a life does in the steady state, and after how many cycles another one is better."""
    given, found, forever = one.given, one.found, one.forever
    if given.life is None:
        of_another = given.wear is not None and given.wear.cycles is not None
        said = f"cycles: {found.objective} has no value after cycles; this is for the steady state"
        report.say(said if of_another else None)
        return
    if forever is None:
        return
    cycles = given.life
    assert found.question.horizon is not None
    flips_at = None if forever.flips_at is None else forever.flips_at * cycles
    report.put(
        life={
            **vars(found.question.horizon.law),
            "cycles": cycles,
            "volume": float(found.value),
            "volume_for_ever": forever.volume,
            "reference_volume_for_ever": forever.reference_volume,
            "best_for_ever": {"variables": forever.best.variables, "volume": float(forever.best.value)},
            "best_for_ever_by_then": forever.best_by_then,
            "flips_at_cycles": flips_at,
        }
    )
    worn = f"in the steady state it wears {measure(forever.volume, found.objective)}, the reference"
    worn = f"{worn} {measure(forever.reference_volume, found.objective)}"
    if flips_at is None:
        report.say(f"{worn}; no other coating wears less in the steady state")
        return
    best = ", ".join(f"{name} = {measure(value, name)}" for name, value in forever.best.variables.items())
    volume, times = measure(float(forever.best.value), found.objective), forever.best_by_then / float(found.value)
    report.say(
        f"{worn}, and the steady-state optimum, {best}, wears {volume}",
        f"beyond {counted(float(f'{flips_at:.3g}'))} cycles the steady-state optimum wears less; "
        f"after {counted(cycles)} it has worn {times:.3g} times as much",
    )
