"""What `plgwear design` says about a design: numbers, words and tables."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from plgwear_jax import coating, optimise
from plgwear_jax._core import doubts
from plgwear_jax._core.catalogue import DESIGNED, STRESSES, entry, measured, placed
from plgwear_jax._core.rules import OF_POWER_LAW, is_linear
from plgwear_jax._core.words import one_line
from plgwear_jax.optimise.best import doubtful, less
from plgwear_jax.scene import Scene
from plgwear_jax.scene.designing import forces_in_scenarios

from .report import Column, Report, about, by_quantity, by_rows, counted, each_with_unit, fields

_NEGLIGIBLE = 1e-6  # smaller changes are not printed


def tell_design(report: Report, given: Scene, found: optimise.Design, sensitivities: bool) -> tuple[Any, ...]:
    """A design next to its reference, what was varied and limited, how certain it is, and the steady state.

    Returns:
        What is to be warned of if the design is not certainly the best; the contact radius of the reference in m, if it
        is known; and the picture of it, with what that shows.
    """
    question, comparison, objective = found.question, optimise.compared(found), found.objective
    words = {"edge_pressure": placed("edge_pressure", {"distance": comparison.distance})}
    lessened = placed(objective, question.places)
    if given.life:
        lessened += f" after {counted(given.life)} cycles"
    if given.life or question.places:
        words[objective] = lessened
    limited = {one.name: placed(one.quantity, one.places) for one in question.limits}  # what each limit limits
    both = described(found, comparison)
    verdict, conflict, higher = _verdict(found), optimise.conflict(found), _if_higher(found, limited, lessened)
    conflict_told = conflict and _conflict_told(found, conflict, limited)
    load, best_called = amplitudes_told(given, objective), "best" if found.keeps_limits else "closest"
    report.say(load)
    report.compare({"best": best_called, "reference": "reference"}, both, words=words)
    _tell_allowed(report, found, best_called, limited)
    report.put(
        edge_distance=comparison.distance,
        objective=objective,
        load=load,
        less_wear_percent=100.0 * found.saving,
        **fields(found, "hold", "converged", "certified", "scan_found_nothing_better"),
        conflict=conflict and vars(conflict),
        verdict=verdict,
        **fields(found.minimum, "projected_gradient", "steps"),
        rival=found.rival and {"variables": found.rival, "value": found.rival_value},
        if_10_percent_higher=higher,
    )
    if not found.keeps_limits:  # savings have no meaning here
        report.say(verdict, conflict_told)
    else:
        rival, gain = None, f"{less(found.saving)} {lessened} than the reference"
        if "edge_pressure" in both:
            best, reference = both["edge_pressure"]
            gain += f", at {best / reference:.3g} times its {words['edge_pressure']}"
        if found.rival:
            more = found.rival_value / found.value - 1.0
            worse = f"{100.0 * more:.2g} % worse" if more < 1.0 else f"worse: {1.0 + more:.2g} times as much"
            rival = f"the next best minimum, at {_named(found.rival.items())}, is {worse if more > 1e-9 else 'as good'}"
        asked = {question.objective, *(one.quantity for one in question.limits)}
        tension = _tensions(found) if STRESSES & asked and question.by_force else None
        report.say(gain, tension, verdict, rival, None if higher is None else higher["line"])
    report.say(doubtful(found, comparison))
    _tell_life(report, given, found)
    if sensitivities and found.keeps_limits:
        _tell_sensitivities(report, optimise.sensitivities(found))
    told = filter(None, (verdict, conflict_told))
    return told, both.get("contact_radius", (None, None))[1], "design_picture", found, comparison


def _verdict(found: optimise.Design) -> str:
    """How certain the design is."""
    if not found.keeps_limits:
        return "NO DESIGN THAT KEEPS THE LIMITS was found; the closest design is shown, limits violated"
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best design that it found"
    if not found.certified:
        return "the search converged, but there MAY BE LESS WEAR ELSEWHERE between the bounds"
    said = "the search converged; a global search found nothing better"
    if found.scan_found_nothing_better:
        return f"{said} and expects nothing better (curvature is estimated, not bounded)"
    return f"{said}, but the scan has too few points to say what lies between them"


def _conflict_told(found: optimise.Design, conflict: optimise.Conflict, limited: dict[str, str]) -> str:
    """Which limits cannot be kept together, and what is reachable."""
    limits, reached = [], []
    for limit in found.question.limits:
        if limit.name in conflict.allowed:
            said = limited[limit.name]
            best, allowed = (measured(limit.quantity, x[limit.name]) for x in (conflict.reachable, conflict.allowed))
            limits.append(f"{said} {'above' if limit.lowest else 'below'} {allowed}")
            reached.append(f"the {'largest' if limit.lowest else 'least'} {said} is {best}")
    cannot = "together: with the others kept," if limits[1:] else "between the bounds of what varies:"
    return f"limits: {' and '.join(limits)} cannot be kept {cannot} {', '.join(reached)}"


def _tensions(found: optimise.Design) -> str:
    """The largest tension of both contacts under the largest load, and where: only where stresses are asked for."""
    contacts: Any = found.contact, found.reference
    best, other = both = [contact.steady(np.max(found.load.amplitudes)) for contact in contacts]  # pyright: ignore
    its, that = (
        f"{measured('tension', one.peak_tension)} at {_named(zip('xz', one.peak_tension_at, strict=True))}"
        for one in both
    )
    times = f"{best.peak_tension / other.peak_tension:.3g} times that of the reference"
    return f"its peak tension, {its}, is {times}, {that}"


def _if_higher(found: optimise.Design, limited: dict[str, str], called: str) -> dict[str, Any] | None:
    """How far it is from the best one, or violates a limit, if all amplitudes are 10 % higher; None without any."""
    load = found.load
    if load is None:
        return None
    said, loss = f"at a 10 % higher {'force' if found.question.by_force else 'displacement'} amplitude", None
    if load.amplitudes is None:
        said = "with all amplitudes 10 % higher"
    try:
        higher = optimise.under_other_load(found, 1.1)
    except ValueError:
        return {"line": f"{said} the contact is in gross slip", "loss": None}
    violated = [
        f"the {limited[name]} is {measured(x.quantity, x.value)}" for name, x in higher.limits.items() if not x.kept
    ]
    if violated:
        line = f"this design violates a limit: {violated[0]}"
    elif not higher.best.converged:
        line = "the best design is not known: the search for it did not converge"
    else:
        loss, line = max(higher.loss, 0.0), "this design is still the best"
        if loss > 1e-6:
            line = f"this design has {100.0 * loss:.2g} % more {called} than the best one for that amplitude"
    return {"line": f"{said} {line}", "loss": loss}


def _tell_allowed(report: Report, found: optimise.Design, called: str, limited: dict[str, str]) -> None:
    """What was varied and limited, and which bounds and limits the design reaches."""
    rows, variables = [], {}
    for name, ends in found.bounds.items():
        side, value = found.at_bound[name], found.variables[name]
        variables[name] = {"value": value, "bounds": ends, "at_bound": side}
        standing = f"at the {side} bound" if side else "between"
        if side and found.keeps_limits:
            # the slope of the objective's logarithm by k, or by the logarithm of the variable
            gain = abs(found.minimum.bound_multipliers[name])
            standing += f"; widening it by {'0.01' if is_linear(name) else '1 %'} saves {gain:.2g} %"
        rows.append((entry(name).name, measured(name, value), measured(name, ends), standing))
    for name, state in found.limits.items():
        standing = "kept" if state.kept else "VIOLATED"
        if state.active and found.keeps_limits:
            standing = f"active; relaxing it by 1 % saves {float(state.multiplier):.2g} %"
        allowed = f"at {'least' if state.lowest else 'most'} {measured(state.quantity, state.allowed)}"
        rows.append((limited[name], measured(state.quantity, state.value), allowed, standing))
    states = {name: fields(x, "value", "allowed", "kept", "active", "multiplier") for name, x in found.limits.items()}
    report.put(vary=variables, limits=states)
    headings = "varied and limited" if found.limits else "varied", called, "allowed", ""
    report.table(*by_rows(headings, rows, left=(0, 2, 3)), title="")


def _tell_life(report: Report, given: Scene, found: optimise.Design) -> None:
    """What a design for a life does in the steady state, and after how many cycles another one is better."""
    question, cycles = found.question, given.life
    if cycles is None and given.wear and given.wear.cycles:
        report.say(f"cycles: {found.objective} has no value after cycles; this is for the steady state")
    if question.scenarios or not (question.by_force and found.keeps_limits and cycles and question.horizon):
        return
    forever = optimise.in_steady_state(found)
    flips_at = forever.flips_at and forever.flips_at * cycles
    best, least = forever.best.variables, forever.best.value
    report.put(
        life={
            **vars(question.horizon.law),
            "cycles": cycles,
            "volume": found.value,
            "volume_for_ever": forever.volume,
            "reference_volume_for_ever": forever.reference_volume,
            "best_for_ever": {"variables": best, "volume": least},
            "best_for_ever_by_then": forever.best_by_then,
            "flips_at_cycles": flips_at,
        }
    )
    values = forever.volume, forever.reference_volume, least
    worn, reference, least = (measured(found.objective, value) for value in values)
    worn = f"in the steady state it wears {worn}, the reference {reference}"
    if flips_at is None:
        report.say(f"{worn}; no other coating wears less in the steady state")
        return
    report.say(
        f"{worn}, and the steady-state optimum, {_named(best.items())}, wears {least}",
        f"beyond {about(flips_at)} cycles the steady-state optimum wears less; "
        f"after {counted(cycles)} it has worn {forever.best_by_then / found.value:.3g} times as much",
    )


def described(found: optimise.Design, comparison: optimise.Comparison) -> dict[str, list[float]]:
    """The quantities of [the best design, the reference] in SI units; all but the objective at the largest load."""
    pair = found.contact, found.reference
    both: dict[str, Any] = {name: (x, found.reference_variables[name]) for name, x in found.variables.items()}
    for name in OF_POWER_LAW:
        if hasattr(found.contact.material, name):
            both[name] = [getattr(contact.material, name) for contact in pair]
    both |= comparison.quantities
    return {name: [*map(float, both[name])] for name in dict.fromkeys([*DESIGNED, *both]) if name in both}


def _slipping(given: Scene, rows: Any) -> str:
    """Which of these rows of scenarios slip as a whole under a displacement, in words."""
    forces = forces_in_scenarios(given)
    if forces is None:
        return ""
    slip = rows[np.isnan(forces)].tolist()
    if len(slip) in (0, rows.size):
        return f", {'all' if slip else 'none'} in gross slip"
    which = f"row{'s' if slip[1:] else ''} {', '.join(map(str, slip[:9]))}{' and others' if slip[9:] else ''}"
    return f", {len(slip)} in gross slip ({which})"


def amplitudes_told(given: Scene, objective: str) -> str | None:
    """Which amplitudes count, and how, if there are several."""
    load, space, name = given.load, given.asked(), entry(objective).name
    part = {0.0: "mean", 1.0: "worst"}.get(space.level, f"mean over the worst {100.0 * (1.0 - space.level):.3g} %")
    if space.scatter:
        rows = space.scatter.row
        said = f"the {name} is its {part} over them, limits are for the worst, all else is for the reference"
        return f"scenarios {one_line(str(space.scenarios))}: {rows.size}{_slipping(given, rows)}; {said}"
    if load is None:
        return None
    if load.cycles is not None and given.life:
        return f"history {one_line(str(load.history))}: {load.cycles.size} blocks, {given.life:g} cycles in all"
    if load.table is None:
        kept = f"; every coating is given this {'displacement' if given.wears_otherwise else 'force'}"
        return load.remark if load.displacement is None else f"{load.remark}{kept}"
    acting = load.acting(given.life is not None).amplitude
    unit = entry("displacement" if given.wears_otherwise else "tangential_force").unit
    part = part if space.level < 1.0 else "value at the largest"
    told = f"the {name} is its {part}, all else is for the largest, {acting.max():g} {unit}"
    return f"table {one_line(load.table)}: {acting.size} amplitude{'s' if acting.size > 1 else ''}; {told}"


def _named(values: Iterable[tuple[str, Any]]) -> str:
    return ", ".join(f"{name} = {measured(name, value)}" for name, value in values)


def _tell_sensitivities(report: Report, slopes: optimise.Sensitivities) -> None:
    """The changes if an input grows by 1 %; inputs that change nothing are only named."""
    report.put(sensitivities=vars(slopes))
    varied, rows, idle = [*next(iter(slopes.variables.values()))], [], []
    for source, by in slopes.variables.items():
        changes = slopes.saving[source], *(0.01 * x if is_linear(name) else x for name, x in by.items())
        cells = [f"{x:+.2g}" if abs(x) >= _NEGLIGIBLE else "0" for x in changes]
        if {*cells} == {"0"}:
            idle.append(slopes.words[source])
        else:
            rows.append([slopes.words[source], *cells])
    headings = "input", "saving (points)", *(name if is_linear(name) else f"{entry(name).name} (%)" for name in varied)
    report.say("what changes if an input grows by 1 % (k, nu: by 0.01):")
    report.table(*by_rows(headings, rows), title="")
    report.say(f"without effect: {', '.join(idle)}" if idle else None)


# --- a modulus that is free at three depths or more -------------------------------------------------------------------


def tell_freely(report: Report, given: Scene, found: optimise.FreeDesign) -> tuple[Any, ...]:
    """The best free gradient next to the best power law and the reference; returns what `tell_design` does."""
    assert given.load is not None
    force, profile, objective = given.load.largest, found.profile, entry(found.objective)
    contacts, widest = (found.contact, found.power_law, found.reference), found.contact_radii[0]
    verdict, load = _free_verdict(found), amplitudes_told(given, found.objective)
    sides = {"best": "free\ngradient", "power_law": f"power law,\nk = {found.exponent:.3g}", "reference": "reference"}
    counts, at = coating.where_it_counts(found.contact, force), profile.at
    rings = [coating.worn(contact, force) for contact in contacts]
    worn = np.array([[ring[name] for ring in rings] for name in ("radii", "wear_depth")])
    depths = np.geomspace(min(0.5 * at[at > 0.0][0], 0.03 * widest), max(2.0 * at[-1], 3.0 * widest), 300)
    curves = [depths, *(contact.material.modulus_at(depths) for contact in contacts)]
    moduli = found.modulus, found.power_law.material.modulus, found.reference.material.modulus_at(at)
    values = found.value, found.power_law_value, found.reference_value
    compared = {found.objective: values, "contact_radius": found.contact_radii}
    report.put(
        {"value": objective.unit, "contact_radius": entry("contact_radius").unit},
        load=load,
        **fields(found, "objective", "modulus", "at_bound", "starts", "evaluations", "converged", "certified"),
        depth=profile.at,
        **fields(profile, "lower", "upper", "steepness"),
        value=dict(zip(sides, values, strict=True)),
        contact_radius=dict(zip(sides, found.contact_radii, strict=True)),
        power_law={"k": found.exponent, "modulus": moduli[1]},
        less_wear_percent=100.0 * found.saving,
        less_than_power_law_percent=100.0 * found.freedom,
        minima=[minimum._asdict() for minimum in found.minima],
        verdict=verdict,
        where_it_counts=dict(zip(("depth", "dlogV_dlogE_per_decade"), counts, strict=True)),
    )
    report.say(load)
    report.table(*by_quantity([*sides.values()], compared))
    allowed = (measured("modulus", ends) for ends in np.stack([profile.lower, profile.upper], 1))
    report.table(
        each_with_unit("depth", at),
        *(each_with_unit("modulus", row, name) for row, name in zip(moduli, sides.values(), strict=True)),
        Column("allowed", [*allowed]),
        Column("", [f"{side} bound" if side else "between" for side in found.at_bound], left=True),
        title="modulus at a depth",
    )
    freedom = f"the free gradient wears {less(found.freedom)} than the best power law within these bounds"
    if found.power_law_value != found.power_law_value:  # NaN
        freedom = "no power law within these bounds keeps the limits"
    report.say(f"{less(found.saving)} {objective.name} than the reference", freedom, verdict)
    for rival in found.minima[1:2]:
        report.say(f"the next best minimum is {100.0 * (rival.value / found.value - 1.0):.2g} % worse")
    report.say(doubts.of_design(depths, curves[1], widest, worn[1, 0].max()))
    return [verdict], found.contact_radii[2], "free_picture", found, curves, counts, worn


def _free_verdict(found: optimise.FreeDesign) -> str:
    """How certain a free gradient is."""
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best gradient that it found"
    if not found.certified:
        return f"the search converged, but only one of {found.starts} descents ended here: THERE MAY BE A BETTER ONE"
    best, *others = found.minima
    other = f"the best of {len(found.minima)} minima" if others else "the same minimum"
    some = f"{best.starts} of {found.starts} descents ended in {other}"
    return f"the search converged; {some}; with several variables a better one elsewhere cannot be excluded"
