"""What `plgwear design` says about a design: numbers, words and tables."""

import dataclasses
from typing import Any, cast

import numpy as np

from plgwear_jax import optimise
from plgwear_jax.catalogue import DESIGNED, STRESSES, placed
from plgwear_jax.cli.question import amplitudes_told, saved, words_of
from plgwear_jax.cli.report import Column, Report, counted, fields, measure
from plgwear_jax.contact import FrettingContact, GrossSlipContact, is_closed
from plgwear_jax.optimise.best import doubtful
from plgwear_jax.rules import OF_POWER_LAW, is_linear
from plgwear_jax.scene import Scene

_NEGLIGIBLE = 1e-6  # smaller changes are not printed


class DesignReport:
    """A design beside its reference; making the report computes all that it tells, but for sensitivities.

    Args:
        given: The scene.
        found: The design.
        comparison: It beside the reference.

    Attributes:
        best: The quantities of the best contact, in SI units, by name.
        reference: Those of the reference.
        verdict: Whether this is the best design, and how certain that is.
    """

    def __init__(self, given: Scene, found: optimise.Design, comparison: optimise.Comparison) -> None:
        self._given, self._found, question = given, found, found.question
        punch = isinstance(found.reference, GrossSlipContact)
        self._distance = None if punch else float(np.asarray(comparison.distance))
        self._words = words_of(self._distance or 0.0, found.bounds)
        if given.life is not None:
            self._words[found.objective] += f" after {counted(given.life)} cycles"
        self._limited = {  # what each limit limits, at its place
            one.name: self._words[one.quantity] if {*one.places} <= {"distance"} else placed(one.quantity, one.places)
            for one in question.limits
        }
        self.best, self.reference = described(found, comparison)
        if "edge_pressure" not in comparison.quantities:  # in gross slip there is no stick-slip boundary; else it moves
            for one in (self.best, self.reference):
                one.pop("edge_exponent", None)
        self.verdict = _verdict(found)
        self._conflict = optimise.conflict(found)
        steady = (
            question.horizon is not None and question.by_force and found.keeps_limits and question.scenarios is None
        )
        self._forever = optimise.in_steady_state(found) if steady else None
        self._higher = self._if_higher()
        self._doubtful = doubtful(found, comparison)
        asked = {question.objective, *(one.quantity for one in question.limits)}
        self._tension = self._tensions() if STRESSES & asked and question.by_force else None

    def _tensions(self) -> str:
        """The largest tension of both contacts under the largest load, and where: only where stresses are asked for."""
        assert self._found.load is not None
        force, told, values = np.max(self._found.load.amplitudes), list[str](), list[float]()
        for contact in (self._found.contact, self._found.reference):
            steady: Any = cast(FrettingContact, contact).steady(force)
            values.append(float(steady.peak_tension))
            at = placed("tension", dict(zip("xz", steady.peak_tension_at, strict=True))).partition(" at ")[2]
            told.append(f"{measure(values[-1], 'peak_tension')} at {at}")
        times = f"{values[0] / values[1]:.3g} times that of the reference"
        return f"its peak tension, {told[0]}, is {times}, {told[1]}"

    def _if_higher(self) -> dict[str, Any] | None:
        """How far it is from the best one, or violates a limit, if all amplitudes are 10 % higher; None without any."""
        found, question = self._found, self._found.question
        if self._given.load is None or not isinstance(found.contact, FrettingContact):
            return None
        if not question.by_force and question.scenarios is not None and question.scenarios.tangential_force is not None:
            return None  # which scenarios slip as a whole would change
        said, loss = f"at a 10 % higher {'force' if question.by_force else 'displacement'} amplitude", None
        if found.load is not None and found.load.amplitudes is None:
            said = "with all amplitudes 10 % higher"
        try:
            higher = optimise.under_other_load(found, 1.1)
        except ValueError:
            return {"line": f"{said} the contact is in gross slip", "loss": None}
        violated = [
            f"the {self._limited[name]} is {_measure(x.value, x)}" for name, x in higher.limits.items() if not x.kept
        ]
        if violated:
            line = f"this design violates a limit: {violated[0]}"
        elif not higher.best.converged:
            line = "the best design is not known: the search for it did not converge"
        else:
            loss, line = max(higher.loss, 0.0), "this design is still the best"
            if loss > 1e-6:
                more = f"{100.0 * loss:.2g} % more {self._words[found.objective].partition(', ')[0]}"
                line = f"this design has {more} than the best one for that amplitude"
        return {"line": f"{said} {line}", "loss": loss}

    @property
    def doubts(self) -> list[str]:
        """What is to be warned of, if the design is not certainly the best."""
        return [] if self._found.certified else list(filter(None, (self.verdict, self._conflict_told())))

    def tell(self, report: Report) -> None:
        """The design next to its reference, what was varied and limited, how certain it is, and the steady state."""
        found, load = self._found, amplitudes_told(self._given, self._found.objective)
        report.say(load)
        called = "best" if found.keeps_limits else "closest"
        both = {name: (value, self.reference[name]) for name, value in self.best.items()}
        report.compare({"best": called, "reference": "reference"}, both, words=self._words)
        report.put(edge_distance=self._distance, objective=found.objective, load=load)
        self._tell_allowed(report, called)
        report.put(
            less_wear_percent=100.0 * found.saving,
            **fields(found, "hold", "converged", "certified", "scan_found_nothing_better"),
            conflict=self._conflict and fields(self._conflict, "allowed", "reachable"),
            verdict=self.verdict,
            **fields(found.minimum, "projected_gradient", "steps"),
            rival=None if found.rival is None else {"variables": found.rival, "value": found.rival_value},
            if_10_percent_higher=self._higher,
        )
        if not found.keeps_limits:  # savings have no meaning here
            report.say(self.verdict, self._conflict_told())
        else:
            gain, rival = saved(found.saving, self._words[found.objective]), None
            if "edge_pressure" in self.best:
                times = self.best["edge_pressure"] / self.reference["edge_pressure"]
                gain += f", at {times:.3g} times its {self._words['edge_pressure']}"
            if found.rival is not None:
                more = found.rival_value / float(found.value) - 1.0
                worse = f"{100.0 * more:.2g} % worse" if more < 1.0 else f"worse: {1.0 + more:.2g} times as much"
                rival = f"the next best minimum, at {_where(found.rival)}, is {worse if more > 1e-9 else 'as good'}"
            report.say(gain, self._tension, self.verdict, rival, None if self._higher is None else self._higher["line"])
        report.say(self._doubtful)
        self._tell_life(report)

    def _tell_allowed(self, report: Report, called: str) -> None:
        """What was varied and limited, and which bounds and limits the design reaches."""
        found, rows = self._found, []
        for name, ends in found.bounds.items():
            side, value = found.at_bound[name], found.variables[name]
            symbol = name if name in ("k", "E0", "z0", "nu") else self._words[name].partition(",")[0]
            standing = f"at the {side} bound" if side else "between"
            if side and found.keeps_limits:
                # the slope of the objective's logarithm by k, or by the logarithm of the variable
                gain = abs(float(found.minimum.bound_multipliers[name]))
                standing += f"; widening it by {'0.01' if is_linear(name) else '1 %'} saves {gain:.2g} %"
            rows.append((symbol, measure(value, name), " to ".join(measure(end, name) for end in ends), standing))
        for name, state in found.limits.items():
            standing = "kept" if state.kept else "VIOLATED"
            if state.active and found.keeps_limits:
                standing = f"active; relaxing it by 1 % saves {float(state.multiplier):.2g} %"
            allowed = f"at {'least' if state.lowest else 'most'} {_measure(state.allowed, state)}"
            rows.append((self._limited[name], _measure(state.value, state), allowed, standing))
        report.put(
            vary={
                name: {"value": found.variables[name], "bounds": list(ends), "at_bound": found.at_bound[name]}
                for name, ends in found.bounds.items()
            },
            limits={
                name: fields(x, "value", "allowed", "kept", "active", "multiplier") for name, x in found.limits.items()
            },
        )
        headings = "varied and limited" if found.limits else "varied", called, "allowed", ""
        columns = (Column(heading, left=i != 1, wrap=i in (0, 3)) for i, heading in enumerate(headings))
        report.table(*columns, rows=rows, title="")

    def _conflict_told(self) -> str | None:
        """Which limits cannot be kept together, and what is reachable; None if all can."""
        if self._conflict is None:
            return None
        limits, reached, names = [], [], []
        for limit in self._found.question.limits:
            if limit.name in self._conflict.allowed:
                said, best = self._limited[limit.name], measure(self._conflict.reachable[limit.name], limit.quantity)
                allowed = measure(self._conflict.allowed[limit.name], limit.quantity)
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

    def _tell_life(self, report: Report) -> None:
        """What a design for a life does in the steady state, and after how many cycles another one is better."""
        given, found, forever, cycles = self._given, self._found, self._forever, self._given.life
        if cycles is None and given.wear is not None and given.wear.cycles is not None:
            report.say(f"cycles: {found.objective} has no value after cycles; this is for the steady state")
        if forever is None or cycles is None:
            return
        assert found.question.horizon is not None
        flips_at = None if forever.flips_at is None else forever.flips_at * cycles
        best, least = forever.best.variables, float(forever.best.value)
        report.put(
            life={
                **vars(found.question.horizon.law),
                "cycles": cycles,
                "volume": float(found.value),
                "volume_for_ever": forever.volume,
                "reference_volume_for_ever": forever.reference_volume,
                "best_for_ever": {"variables": best, "volume": least},
                "best_for_ever_by_then": forever.best_by_then,
                "flips_at_cycles": flips_at,
            }
        )
        volumes = (measure(volume, found.objective) for volume in (forever.volume, forever.reference_volume, least))
        worn, reference, least = volumes
        worn = f"in the steady state it wears {worn}, the reference {reference}"
        if flips_at is None:
            report.say(f"{worn}; no other coating wears less in the steady state")
            return
        times = forever.best_by_then / float(found.value)
        report.say(
            f"{worn}, and the steady-state optimum, {_where(best)}, wears {least}",
            f"beyond {counted(float(f'{flips_at:.3g}'))} cycles the steady-state optimum wears less; "
            f"after {counted(cycles)} it has worn {times:.3g} times as much",
        )


def described(found: optimise.Design, comparison: optimise.Comparison) -> tuple[dict[str, float], dict[str, float]]:
    """The quantities of the best design and the reference, in SI units; all but the objective at the largest load."""
    described = []
    for which, contact in enumerate((found.contact, found.reference)):
        material: Any = contact.material
        quantities: dict[str, Any] = dict((found.variables, found.reference_variables)[which])
        quantities |= {name: getattr(material, name) for name in OF_POWER_LAW if hasattr(material, name)}
        quantities |= {name: both[which] for name, both in comparison.quantities.items()}
        if isinstance(contact, FrettingContact):
            # (k-1)/2 of the body that deforms more at the edge: at k < 0 this is an elastic indenter
            k = getattr(material, "k", 0.0)
            quantities["edge_exponent"] = 0.5 * ((k if is_closed(contact) else max(float(k), 0.0)) - 1.0)
        ordered = dict.fromkeys([*DESIGNED, *quantities])
        described.append({name: float(quantities[name]) for name in ordered if name in quantities})
    best, reference = described
    return best, reference


def _measure(value: Any, state: optimise.LimitState) -> str:
    """A value of a limited quantity."""
    return measure(float(np.asarray(value)), state.quantity)


def _where(variables: dict[str, float]) -> str:
    return ", ".join(f"{name} = {measure(value, name)}" for name, value in variables.items())


def _verdict(found: optimise.Design) -> str:
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
