"""What a choice of the variables gives: the objective and how far each limit is broken, with their slopes.

Every quantity is read from `contact.steady(...)` or `contact.over_cycles(...)` of the contact with these variables, by
its name in the catalogue. Values are logarithms: of the objective over that of the reference, and of what is limited
over its limit.
"""

import dataclasses
import functools
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, cast

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax
from jax.typing import ArrayLike

from plgwear_jax._core.catalogue import PEAKS, SEARCHED, read, read_from
from plgwear_jax._core.domains import RefusedError
from plgwear_jax._core.rules import WrongKeyError, is_after_cycles, is_linear
from plgwear_jax._core.startup.programs import NumbersWithSlopes, program
from plgwear_jax.loads import Force

from .ask_and_tell import INFINITE, SearchPlan, plan_of
from .question import (
    Limit,
    Question,
    keeps,
    moved,
    read_from_runs,
    solved_in_turn,
    solved_one_by_one,
    variable_of,
    with_variables,
)
from .scenarios import ScenarioBatch, solved_at, tail_weights
from .search import SLOW_SAMPLES, Interval, Minimum, by_name, found_by, rows_of


class Shared(NamedTuple):
    """What all choices of the variables of a question have in common."""

    radius: Any = None  # the contact radius of the reference, if it is held
    runs: Any = None  # `RunsAlongExponent`, from which the wear is read, if it can be
    scale: Any = 1.0  # the objective of the reference in SI units


class Candidate:
    """A choice of the variables, which are scalars. Only what is used is computed."""

    def __init__(self, question: Question, variables: Mapping[str, Any], shared: Shared | None = None) -> None:
        self.question, self.shared = question, shared or Shared()
        self.varied = with_variables(question.contact, variables)  # E0 as it is
        self._runs: dict[Any, Any] = {}  # what was solved over cycles, for all quantities

    @functools.cached_property
    def contact(self) -> Any:
        """The contact, with E0 adjusted to hold the contact radius."""
        material, radius = self.varied.material, self.shared.radius
        if radius is None:
            return self.varied
        return with_variables(self.varied, {"E0": material.E0 * self.varied.steady(0.0)._stiffening(radius)})

    # --- the states of the contact ------------------------------------------------------------------------------------

    @functools.cached_property
    def _amplitudes(self) -> tuple[Any, Array | None]:
        """(Amplitudes at which it is solved, the largest first, the matrix from there to those of the load)."""
        load = self.question.load
        if not (solved_one_by_one(self.question) and self.question.by_force):
            return load.amplitudes, None
        limit = jnp.asarray(self.varied.friction * self.varied.normal_force)
        phi, between = solved_at(load.amplitudes / limit)
        return phi * limit, between

    def _steady(self, force: Any) -> Any:
        found, radius = self.contact.steady(Force(force, self.question.load.load.rig_stiffness)), self.shared.radius
        return found if radius is None else found._with_contact_radius(radius)

    @functools.cached_property
    def steady(self) -> Any:
        """At all amplitudes at which it is solved."""
        return self._steady(self._amplitudes[0])

    @functools.cached_property
    def largest(self) -> Any:
        """At the largest amplitude, first of an axis where all of them are solved together, or before any wear."""
        if tells_states(self.question):
            return self.steady
        return self._steady(self._amplitudes[0][0] if self.question.by_force else 0.0)

    # --- what is minimised, and the limits ----------------------------------------------------------------------------

    def _read(self, name: str, places: Mapping[str, ArrayLike], at_largest: bool) -> Any:
        """A quantity in SI units, at each amplitude at which it is solved or at the largest, first of an axis."""
        load, horizon, shared = self.question.load, self.question.horizon, self.shared
        if load is None or name == "modulus_at":
            return read(self.contact, name, None, places)
        if not is_after_cycles(name):
            return read_from(self.largest if at_largest else self.steady, name, places)
        if shared.runs is not None:
            return shared.runs.worn(self.varied, shared.radius, horizon)
        given = {**places, "cycles": jnp.asarray(horizon.cycles), "wear_coefficient": horizon.law}
        under = load if load.amplitudes is None else load.with_amplitudes(self._amplitudes[0], None)
        return read(self.contact, name, under.load, given, solved=self._runs)

    def amounts(self) -> Array:
        """What is minimised at each amplitude of the load, in SI units; its mean is not taken."""
        load = self.question.load
        found = self._read(self.question.counted, self.question.places, False)
        if load is None or load.amplitudes is None:
            return jnp.atleast_1d(found)
        amplitudes, between = self._amplitudes
        found = jnp.broadcast_to(found, jnp.shape(amplitudes))
        return found if between is None else jnp.exp(between @ _log_or_least(found))

    def objective(self) -> Array:
        """The logarithm of what is minimised, over that of the reference."""
        load = self.question.load
        total = jnp.dot(self.amounts(), 1.0 if load is None else load.weight).reshape(())
        return _log_or_least(total / self.shared.scale)

    def rows(self) -> Any:
        """The objective and the excess of each limit, (1 + m,); of scenarios see `_of_scenarios`.

        The excess is log(value/limit), with the sign that is positive where the limit is broken, also by inf.
        """
        if self.question.scenarios is not None:
            return self._of_scenarios(self.question.scenarios)
        limited = [(one, self._read(one.quantity, one.places, True)) for one in self.question.limits]
        return jnp.stack([self.objective(), *(_broken_by(one, jnp.ravel(found)[0]) for one, found in limited)])

    def _of_scenarios(self, scenarios: ScenarioBatch) -> tuple[Array, Array]:
        """The amounts over the scale, (scenarios * amplitudes,), and the excess of each limit, (scenarios, m)."""
        question = self.question

        def scenario(given: tuple[Any, Any, Any]) -> tuple[Array, Array]:
            there, law, force = given
            for name in (*question.bounds, *(("E0",) if question.hold else ())):
                own, base, value = (variable_of(contact, name) for contact in (there, question.contact, self.contact))
                value = value + (own - base) if is_linear(name) else value * (own / base)
                there = with_variables(there, {name: value})
            load, horizon = question.load, question.horizon
            if horizon is not None and law is not None:
                horizon = dataclasses.replace(horizon, law=law)
            if load is not None and force is not None:
                load = load.with_amplitudes(force[None], load.weight)
            # The names of what varies stay: they decide how a contact is solved.
            parts = {"contact": there, "load": load, "horizon": horizon, "hold": False, "scenarios": None}
            one = Candidate(dataclasses.replace(question, **parts), {})
            return one.amounts() / self.shared.scale, one.rows()[1:]

        given = scenarios.contact, scenarios.law, scenarios.tangential_force
        in_turn = solved_one_by_one(question)
        amounts, excess = lax.map(scenario, given) if in_turn else jax.vmap(scenario)(given)
        return amounts.ravel(), excess


def _broken_by(one: Limit, value: Any) -> Array:
    """How far a value breaks a limit: positive where it does."""
    over = jnp.minimum(_log_or_least(value / one.value), INFINITE)
    return -over if one.lowest else over


_how_far_broken = program()(_broken_by)


def _log_or_least(x: Any) -> Array:
    """log(x), finite where x is 0 or negative, as a depth of wear is outside of the ring."""
    x = jnp.asarray(x)
    return jnp.where(x <= 0.0, -INFINITE, jnp.log(jnp.where(x <= 0.0, 1.0, x)))


def reference_variables(question: Question) -> dict[str, Any]:
    """The values of the variables for the contact as given."""
    return {name: variable_of(question.contact, name) for name in question.bounds}


def space(question: Question) -> dict[str, Interval]:
    """The box of the variables: what spans a ratio is searched on a logarithmic scale."""
    return {
        name: Interval(*bounds, "linear" if is_linear(name) else "logarithmic")
        for name, bounds in question.bounds.items()
    }


def _held_radius(question: Question) -> Array | None:
    return question.contact.steady(0.0).contact_radius if question.hold else None


def shared_of(question: Question) -> Shared:
    """What all choices have in common, within a compiled program."""
    shared = Shared(_held_radius(question))
    if read_from_runs(question):
        from .along_exponent import runs_of  # only lives need it

        shared = shared._replace(runs=runs_of(question))
    reference = Candidate(question, reference_variables(question), shared)
    return shared._replace(scale=jnp.exp(reference.objective()))


# --- for concrete numbers ---------------------------------------------------------------------------------------------


Known = dict[Any, Any]  # what is known of questions, and of points that are solved numerically


class Evaluation(NamedTuple):
    """The objective and the limits at several choices of the variables; of scenarios over all of them."""

    rows: Any  # of `Candidate.rows`, each with its slopes on the scale of the search, (points, 1 + m, 1 + n)
    held: dict[str, Any]  # E0 that holds the contact radius, by name, if it is held
    state: Any  # the solution at the largest amplitude, if it `tells_states`
    pressed: Any  # the rows of this one, if limits are left out
    scale: Any = None  # the objective of the reference in SI units
    weights: Any = None  # with which scenarios and amplitudes count, (points, scenarios * amplitudes)
    scenario: Any = None  # where a limit is broken the most, (points, m)

    @property
    def values(self) -> Any:
        """The rows without their slopes, (points, 1 + m)."""
        return self.rows[..., 0]

    @property
    def objective(self) -> Any:
        """What is minimised, in SI units."""
        return np.exp(self.values[:, 0]) * self.scale


def tells_states(question: Question) -> bool:
    """Whether the state of each contact at the largest amplitude is solved, and told besides the rows."""
    return solved_one_by_one(question) and question.horizon is None and question.scenarios is None


def _left_out(question: Question) -> tuple[int, ...]:
    """Which limits are of peaks that programs of their own search, as XLA compiles several programs sooner than one."""
    return tuple(i for i, one in enumerate(question.limits) if one.quantity in PEAKS and tells_states(question))


def _at_point(names: tuple[str, ...], question: Question, shared: Shared, point: Array) -> Evaluation:
    here, left_out = by_name(names, point), _left_out(question)
    limits = tuple(one for i, one in enumerate(question.limits) if i not in left_out)
    question = dataclasses.replace(question, limits=limits)

    def moved_by(steps: Array) -> tuple[Any, Any]:
        there = {name: moved(name, x, step) for (name, x), step in zip(here.items(), steps, strict=True)}
        candidate = Candidate(question, there, shared)
        pressed = candidate.steady._pressed if left_out else ()
        state = candidate.steady._solution if tells_states(question) else ()
        pressed, state = jax.tree.map(lambda x: x[0], (pressed, state))
        return (candidate.rows(), pressed), state

    held = {"E0": Candidate(question, here, shared).contact.material.E0} if question.hold else {}
    (rows, pressed), state = rows_of(moved_by, jnp.zeros(len(here), point.dtype))
    return Evaluation(rows, held, state, pressed)


def _at_points(names: tuple[str, ...], question: Question, shared: Shared, points: Array) -> Evaluation:
    at = functools.partial(_at_point, names, question, shared)
    return jax.vmap(at)(points) if len(points) > 1 else jax.tree.map(lambda x: x[None], at(points[0]))


_together = program(static=1)(_at_points)
_in_turn = [program(static=1, level=level, steps=False)(_at_points) for level in (0, 1)]


def concrete(tree: Any) -> Any:
    """The same numbers as NumPy arrays of one dtype, so that one program is enough."""
    dtype = np.dtype(jnp.result_type(float))
    return jax.tree.map(lambda x: np.asarray(x, dtype), tree)


def _bytes_of(tree: Any) -> bytes:
    return b"".join(np.asarray(leaf).tobytes() for leaf in jax.tree.leaves(tree))


class Evaluator:
    """Evaluates a question at concrete choices of the variables, by one program; no point is solved twice."""

    def __init__(self, question: Question, known: Known | None = None) -> None:
        self.question, self.in_turn = concrete(question), solved_in_turn(question)
        self.lanes = 1 if self.in_turn else plan_for(question).lanes
        self.names, self.known = tuple(question.bounds), {} if known is None else known
        self.key = _bytes_of(self.question)

    @functools.cached_property
    def shared(self) -> Shared:
        """What all choices have in common."""
        question, known, runs = self.question, self.known, None
        if self.key not in known:
            if read_from_runs(question):
                from .along_exponent import ends_of, runs_of  # only lives need it

                key = _bytes_of((question.phi, ends_of(question), question.contact.material.nu))
                known[key] = runs = known.get(key) or runs_of(question)
            shared = Shared(concrete(_held_radius(question)), runs, concrete(1.0))
            told = self._solved(self.points(reference_variables(question)), shared)
            known[self.key] = shared._replace(scale=np.exp(over_scenarios(question, told).values[0, 0]))
        return known[self.key]

    def _solved(self, points: np.ndarray, shared: Shared) -> Evaluation:
        """What `_at_point` tells at points, (n <= lanes, variables), by one call."""
        lanes = np.pad(points, ((0, self.lanes - len(points)), (0, 0)), mode="edge")
        # A search along one variable ends sooner if its program is not optimised: it needs some 150 states.
        few = tells_states(self.question) and len(self.names) == 1
        solved = _in_turn[not few] if self.in_turn else _together
        found = jax.device_get(solved(self.names, self.question, shared, lanes))
        for i in _left_out(self.question):
            from plgwear_jax.steady.stressed import peak_with_slopes  # which few designs need

            one = self.question.limits[i]
            pressed = jax.tree.map(
                lambda x: NumbersWithSlopes(x[0, ..., 0], np.moveaxis(x[0, ..., 1:], -1, 0)), found.pressed
            )
            row = _how_far_broken(one, peak_with_slopes(pressed, one.quantity))
            found = found._replace(rows=np.insert(found.rows, 1 + i, np.append(row.value, row.slopes), 1))
        return jax.tree.map(lambda x: x[: len(points)], found)

    def told(self, variables: Mapping[str, ArrayLike]) -> Evaluation:
        """What `_at_point` tells at concrete choices of the variables, each a number or an array of shape (points,).

        Of contacts that are solved numerically it is kept.
        """
        points, known, found = self.points(variables), self.known if self.in_turn else {}, []
        for first in range(0, len(points), self.lanes):
            some = points[first : first + self.lanes]
            key = self.key, some.tobytes()
            if key not in known:
                known[key] = self._solved(some, self.shared)
            found.append(known[key])
        return jax.tree.map(lambda *parts: np.concatenate(parts), *found)

    def points(self, variables: Mapping[str, ArrayLike]) -> np.ndarray:
        """The choices as rows, (points, n)."""
        return np.stack([np.atleast_1d(concrete(variables[name])) for name in self.names], axis=-1)


def plan_for(question: Question) -> SearchPlan:
    """How the minimum of a question is searched."""
    plan = plan_of(len(question.bounds), len(question.limits))
    if not SEARCHED.isdisjoint((question.objective, *(limit.quantity for limit in question.limits))):
        # A search on grids has found them, and they jump a little when the contact changes.
        plan = plan._replace(noise=max(plan.noise, 1e-8))
    if not solved_in_turn(question):
        return plan
    # Wear changes smoothly with a gradient.
    along = SLOW_SAMPLES if question.horizon is None else 17
    plan = plan._replace(samples=along if plan.variables == 1 else 9, starts=3)
    # Points are solved one after the other and remembered: a step is tried with one length, and solved once.
    return plan._replace(tries=1) if question.smooth else plan._replace(samples=9, max_steps=12, noise=1e-4)


def evaluate(question: Question, variables: Mapping[str, ArrayLike], known: Known | None = None) -> Evaluation:
    """The objective and the limits at concrete choices of the variables, each an array of shape (points,).

    The program takes as many points as the search does, and is compiled once for a question: another load, limit or
    material uses it again. Of scenarios the values are those over all of them.
    """
    evaluator = Evaluator(question, known)
    return over_scenarios(evaluator.question, evaluator.told(variables))._replace(scale=evaluator.shared.scale)


def search(
    question: Question,
    changed: Callable[[Any], np.ndarray] = np.asarray,
    known: Known | None = None,
    limits: int | None = None,
) -> Minimum:
    """The minimum of the logarithm of the objective over that of the reference, for concrete numbers.

    Args:
        question: The inputs of the design.
        changed: Changes rows with their slopes before the search gets them, to minimise something else by the same
            program.
        known: What other searches have evaluated, which this one adds to.
        limits: How many limits there are in what `changed` returns; by default those of the question.
    """
    plan = plan_for(question)
    evaluator = Evaluator(question, known)
    if limits is not None:
        plan = plan._replace(limits=limits)
    return found_by(lambda variables: changed(evaluator.told(variables).rows), space(question), plan)


# --- scenarios --------------------------------------------------------------------------------------------------------


def _log_of_mean(amounts: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Logarithms of means of all amounts, and their slopes; the weights are (points, ..., scenarios * amplitudes)."""
    mean = np.einsum("l...c,lcn->l...n", weights, amounts)
    total = np.maximum(mean[..., :1], np.finfo(weights.dtype).tiny)  # a depth can be 0
    return np.append(np.log(total), mean[..., 1:] / total, -1)


def over_scenarios(question: Question, told: Evaluation) -> Evaluation:
    """The mean, worst or CVaR of what is minimised over scenarios and amplitudes, and each limit where it is worst."""
    if question.scenarios is None:
        return told
    amounts, excess = told.rows
    probable = np.outer(question.scenarios.weight, 1.0 if question.load is None else question.load.weight).ravel()
    weights = np.array([tail_weights(lane, probable, question.scenarios.level) for lane in amounts[..., 0]])
    at = excess[..., 0].argmax(1)
    worst = np.take_along_axis(excess, at[:, None, :, None], 1)[:, 0]
    rows = np.append(_log_of_mean(amounts, weights)[:, None], worst, 1)
    return told._replace(rows=rows, weights=weights, scenario=at)


def valued(value: Any, question: Question, contact: Any) -> Any:
    """The value of the best candidate; where none has one, an error says why by its contact."""
    if not np.isnan(value):
        return value
    why = f"{question.objective}, which is minimised, must be > 0 everywhere between the bounds"
    load = question.load and dataclasses.replace(question.load, load=question.load.largest)  # several are not refused
    try:
        Candidate(dataclasses.replace(question, contact=contact, load=load), {}).amounts()
    except RefusedError as error:
        why = f"no candidate has a {question.objective}: {error}"
    raise WrongKeyError("vary", why)


# --- the best over scenarios ------------------------------------------------------------------------------------------
# The best design over scenarios: the mean, the worst of them, or the mean of the worst, within limits in all of them.
#
# Which scenarios are the worst depends on the design. So a search takes a few choices of their weights, and of the
# scenarios in which limits are kept: no design can be better than the best of these relaxed questions. Where its answer
# is as bad as the true one, it is the best of all. Where it is not, the weights and scenarios that are worst there
# join. Over amplitudes alone, by which wear grows for every design, one choice is enough: `tail_weights`.


_ROUNDS = 30
_CLOSED = 1e-9  # of the logarithm of the objective


def search_over_scenarios(question: Question, known: Known) -> Minimum:
    """The minimum of the logarithm of the objective over the scenarios of a question, for concrete numbers."""
    closed, count = max(_CLOSED, plan_for(question).noise), len(question.limits)
    at = evaluate(question, reference_variables(question), known)
    # The scenarios in which the limits are kept.
    choices, kept_in, all_known = [at.weights[0]], np.unique(at.scenario[0]), False

    def relaxed(which: int) -> Minimum:
        """The best design where one choice of the weights is the worst of those that are known, within some limits."""

        def changed(rows: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
            amounts, excess = rows[0], rows[1][:, kept_in].reshape(len(rows[0]), -1, rows[0].shape[-1])
            means = _log_of_mean(amounts, np.broadcast_to(choices, (len(amounts), *np.shape(choices))))
            goal, others = means[:, [which]], np.delete(means, which, axis=1)
            return np.concatenate([goal, others - goal, excess], axis=1)

        return search(question, changed, known, limits=len(choices) - 1 + kept_in.size * count)

    def badness(found: Minimum) -> tuple[bool, Any]:
        kept = keeps(found.limits) and np.isfinite(found.value)
        return not kept, found.value if kept else np.max(found.limits, initial=-np.inf)

    best = multipliers = cast(Any, None)
    for _ in range(_ROUNDS):
        found = [*map(relaxed, range(len(choices)))]
        best = min(found, key=badness)
        multipliers = best.multipliers[len(choices) - 1 :].reshape(kept_in.size, count).sum(0)
        at = evaluate(question, best.variables, known)
        # Where the limits cannot be kept, a part of the box is empty: nothing is missed there.
        all_known = all(one.certified or not keeps(one.limits) for one in found)
        new = np.setdiff1d(at.scenario[0][at.values[0, 1:] > closed], kept_in)
        worse = at.values[0, 0] > float(best.value) + closed
        if worse and any(np.allclose(at.weights[0], one, rtol=1e-12, atol=1e-15) for one in choices):
            all_known = worse = False  # a search has not ended where its limits are kept
        if not new.size and not worse:
            break
        kept_in = np.append(kept_in, new)
        choices += [at.weights[0]] if worse else []
    else:
        all_known = False
    return dataclasses.replace(
        best,
        value=at.values[0, 0],
        limits=at.values[0, 1:],
        multipliers=multipliers,
        certified=best.certified & all_known,
        scan_found_nothing_better=best.scan_found_nothing_better & all_known & (len(choices) == 1),
    )
