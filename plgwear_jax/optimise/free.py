"""The best E(z) that no formula prescribes: its values at some depths are the variables."""

import dataclasses
import functools
import warnings
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple, Unpack

import numpy as np

from plgwear_jax._core import doubts
from plgwear_jax._core.catalogue import measured
from plgwear_jax._core.domains import POSITIVE, concrete_only, record, refuse_traced, whole
from plgwear_jax._core.rules import refuse_question
from plgwear_jax._core.startup.programs import holds_tracers
from plgwear_jax.contact.fretting_contact import FrettingContact, check_fretting_contact

from .best import certainty, headline, of_question, placed_between, printed
from .evaluation import Candidate, Evaluator
from .question import Keywords, Limit, LoadGiven, Question, is_held, question_of
from .search import by_name

# It is the question of a design in which all entries of `material.modulus` vary. SciPy's SLSQP descends from many
# starts, since there are several minima: an optimum mostly lies on bounds, and what there is to choose is the order
# and the thickness of stiff and compliant depths.


_COARSE, _FINE = 1e-4, 1e-6  # the least change of the logarithm, of all descents and of the best of them
_ONE_MINIMUM = 3e-3  # ends of descents whose logarithms differ by less are one
_REFINED = 2  # minima
_KEPT = 1e-5  # of log(value/limit)
_FLAT = 3e-3  # of the slope that still leads downhill, relative to the change of log(wear) over the box
_EXPONENTS = (-0.4, 0.4)  # from which the best power law is looked for


@record
class ModulusProfile:
    """The lowest and the highest modulus with which a coating can be made, at three depths or more.

    It takes numbers, not traced values.

    Attributes:
        at: The depths in m, shape (n,), increasing, 3 <= n <= 8, the first one 0 or above.
        lower: The lowest modulus in Pa at each of them, shape (n,), positive.
        upper: The highest modulus in Pa, shape (n,), above the lowest.
        steepness: Between neighbouring depths abs(log(E2/E1)/log(z2/z1)) is at most this, which for a power law is
            abs(k); None for no limit.
    """

    ranges: ClassVar = {"upper": POSITIVE, "steepness": POSITIVE}

    at: Any  # an array or a list of numbers
    lower: Any
    upper: Any
    steepness: float | None = None

    def __post_init__(self) -> None:
        given = self.at, self.lower, self.upper
        refuse_traced("ModulusProfile", holds_tracers(given), "a DepthGraded may have traced moduli")
        at, lower, upper = (np.asarray(x, float) for x in given)
        vars(self).update(at=at, lower=lower, upper=upper)
        if at.ndim != 1 or not at.shape == lower.shape == upper.shape or not 3 <= at.size <= 8:
            raise ValueError(f"at, lower and upper of shapes {at.shape}, {lower.shape}, {upper.shape}: 3 to 8 depths")
        from plgwear_jax.surfaces import DepthGraded  # which a power law under a rigid indenter does not need

        DepthGraded(at, lower, 0.0)  # which checks them
        if not np.all(np.diff(at) > 0.0):
            raise ValueError("at: the depths must increase")
        if not np.all(lower < upper):
            i = np.argmin(lower < upper)
            raise ValueError(
                f"modulus at {at[i]:g} m: [{lower[i]:g}, {upper[i]:g}]: the lowest must be below the highest"
            )
        if self.steepness is not None and at[0] == 0.0:
            raise ValueError("steepness: is of logarithms of depths, and needs a first depth above 0")


class LocalMinimum(NamedTuple):
    """One of the minima that the search found.

    Attributes:
        value: The objective in SI units.
        modulus: The moduli in Pa, shape (n,).
        starts: How many starts ended here.
    """

    value: float
    modulus: np.ndarray
    starts: int


@dataclasses.dataclass(frozen=True, repr=False)
class FreeDesign:
    """The best E(z) within the bounds, the best power law within them, and the reference.

    Attributes:
        contact: The contact on the best half-space, a `DepthGraded`.
        power_law: The contact on the best power law, clipped to the bounds at the same depths.
        exponent: The exponent of this power law.
        reference: The contact as it was given.
        value: The objective of the best contact, in SI units.
        power_law_value: That of the power law; NaN if none keeps the limits.
        reference_value: That of the reference.
        contact_radii: Contact radii in m: of the best contact, of the power law, of the reference.
        question: What was asked, on a `DepthGraded`.
        profile: The bounds.
        minima: The minima that were found, the best one first.
        starts: How many descents were made.
        evaluations: How often the objective and its slopes were computed.
        converged: The best contact keeps the limits, and no slope leads downhill from it within them.
    """

    contact: FrettingContact
    power_law: FrettingContact
    exponent: float
    reference: FrettingContact
    value: float
    power_law_value: float
    reference_value: float
    contact_radii: tuple[float, float, float]
    question: Question
    profile: ModulusProfile
    minima: tuple[LocalMinimum, ...]
    starts: int
    evaluations: int
    converged: bool

    objective = of_question("objective")
    """What was minimised."""

    @property
    def modulus(self) -> np.ndarray:
        """The best moduli in Pa at the depths of the profile, shape (n,)."""
        return self.minima[0].modulus

    @property
    def saving(self) -> float:
        """The share by which the objective is less than that of the reference."""
        return 1.0 - self.value / self.reference_value

    @property
    def freedom(self) -> float:
        """The share by which the objective is less than that of the best power law."""
        return 1.0 - self.value / self.power_law_value

    @property
    def at_bound(self) -> tuple[str | None, ...]:
        """For each depth the bound on which the modulus lies, "lower" or "upper", or None."""
        rows = zip(self.modulus, self.profile.lower, self.profile.upper, strict=True)
        return tuple("lower" if x <= 1.0001 * low else "upper" if 1.0001 * x >= high else None for x, low, high in rows)

    @property
    def certified(self) -> bool:
        """Converged, and more than one start ended in the best minimum; a better one elsewhere cannot be excluded."""
        return self.converged and self.minima[0].starts > 1

    @property
    def doubt(self) -> str | None:
        """Why nobody could make or measure the best half-space, if so; None under loads without a steady state."""
        if not self.question.by_force:
            return None
        radius, deepest = self.contact_radii[0], self.contact.steady(self.question.load.largest).deepest_wear
        depths = radius * np.geomspace(*doubts.FELT, 16)
        return doubts.of_design(depths, self.contact.material.modulus_at(depths), radius, float(deepest))

    def __repr__(self) -> str:
        """The objective, the moduli, the best power law, the contact radii, what is doubtful, and what is certain."""
        profile = self.profile
        rows = zip(profile.at, profile.lower, profile.upper, self.modulus, self.at_bound, strict=True)
        law = f"k = {self.exponent:.3g}, {self.objective} = {measured(self.objective, self.power_law_value)}"
        best, _, reference = (measured("contact_radius", radius) for radius in self.contact_radii)
        lines = [
            headline(self),
            *(
                placed_between(f"modulus at {measured('depth', depth)}", "modulus", modulus, ends, side)
                for depth, *ends, modulus, side in rows
            ),
            f"best power law: {law if np.isfinite(self.power_law_value) else 'none keeps the limits'}",
            f"contact_radius = {best}, that of the reference {reference}",
            f"{self.minima[0].starts} of {self.starts} descents ended here, minima: {len(self.minima)}",
            self.doubt,
            certainty(self, "converged", "certified"),
        ]
        return printed("FreeDesign", lines)


class _FreeModuli:
    """The question for SLSQP, whose variables are the logarithms of the moduli; no point is solved twice.

    The first limit of the question is that of the contact radius by that of the reference, which holds it or not.
    """

    def __init__(self, question: Question, profile: ModulusProfile, held: bool):
        self.evaluator, self.held, self.depth = Evaluator(question), held, profile.at
        self.box = np.log(np.column_stack([profile.lower, profile.upper]))
        # What the steepness wants to be >= 0: a constant and its slopes.
        self.steep = np.zeros((0, 1 + self.depth.size))
        if profile.steepness is not None:
            slope = np.diff(np.eye(self.depth.size), axis=0) / np.diff(np.log(self.depth))[:, None]
            self.steep = np.insert(np.concatenate([-slope, slope]), 0, profile.steepness, axis=1)

    def rows(self, modulus: np.ndarray) -> np.ndarray:
        """The logarithms of the objective and of the contact radius, what has to be >= 0, each with its slopes."""
        told = self.evaluator.told(by_name(self.evaluator.names, modulus)).rows[0]
        steep = np.column_stack([self.steep @ np.append(1.0, np.log(modulus)), self.steep[:, 1:]])
        return np.concatenate([told[:2], -told[2:], steep])

    def end(self, log_modulus: np.ndarray, starts: int = 1) -> LocalMinimum:
        """A point as the end of so many descents; its value is NaN where a limit is broken."""
        modulus = np.exp(log_modulus)
        least, radius, *room = self.rows(modulus)[:, 0]
        kept = np.all(np.append(room, -abs(radius) if self.held else 0.0) > -_KEPT)
        return LocalMinimum(float(np.exp(least) * self.evaluator.shared.scale) if kept else np.nan, modulus, starts)

    def minima(
        self, begun: list[LocalMinimum], change: float, others: Sequence[LocalMinimum] = ()
    ) -> list[LocalMinimum]:
        """Where descents end, and others have, the best one first; those that break limits come last."""
        found = list[LocalMinimum]()
        descend = functools.partial(_slsqp, lambda x: self.rows(np.exp(x)), self.held, self.box, change)
        ends = [self.end(descend(np.log(one.modulus)), one.starts) for one in begun]
        for one in sorted([*ends, *others], key=_rank):
            if found and not one.value > (1.0 + _ONE_MINIMUM) * found[-1].value:
                found[-1] = found[-1]._replace(starts=found[-1].starts + one.starts)
            else:
                found.append(one)
        return [one for one in found if np.isfinite(one.value)] or found


def _rank(end: LocalMinimum) -> tuple[Any, float]:
    """By which the best end is the first, and those that break limits are the last."""
    return np.isnan(end.value), end.value


@concrete_only("the methods of contacts on a DepthGraded work there")
def free_design(
    contact: FrettingContact,
    load: LoadGiven,
    modulus: ModulusProfile,
    *,
    starts: int = 20,
    **keywords: Unpack[Keywords],
) -> FreeDesign:
    """Find the E(z) on which the indenter wears least, by its values at some depths, with PCHIP between them.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact with its reference material and its indenter; its fields are numbers.
        load: As of `design`; the time grows with the number of amplitudes.
        modulus: The depths, and the bounds of the modulus there.
        starts: How many descents are made, at least 1: from the power law, and from random corners of the bounds.
        **keywords: As of `design`, without scenarios.

    Returns:
        The best contact, with the other minima that were found, and the best power law within the same bounds.

    Raises:
        ValueError: An argument is outside its range.
    """
    check_fretting_contact(contact)
    whole("starts", starts, 1)
    if keywords.get("scenarios") is not None:
        raise ValueError("scenarios: a free gradient takes none")
    nu, hold = contact.material.nu, is_held(keywords.pop("hold", None))
    if not isinstance(modulus, ModulusProfile):
        raise TypeError(f"modulus takes a ModulusProfile, not {modulus!r}")
    if isinstance(nu, str):
        raise ValueError('contact: nu = "holl" changes with k; a free gradient needs a number')
    from plgwear_jax.surfaces import DepthGraded

    def on(moduli: Any) -> FrettingContact:
        return dataclasses.replace(contact, material=DepthGraded(modulus.at, moduli, nu))

    # One structure, and so one program, whatever the reference is.
    ends = zip(modulus.lower, modulus.upper, strict=True)
    vary = {f"material.modulus[{i}]": (float(low), float(high)) for i, (low, high) in enumerate(ends)}
    question = question_of(on(modulus.lower), load, vary, **keywords)
    limited = {one.quantity for one in question.limits}
    refuse_question({}, hold, question.objective, limited, kind="fretting", flat=False)
    reference_value = np.exp(Candidate(dataclasses.replace(question, contact=contact), {}).objective()).item()
    radius = float(contact.steady(0.0).contact_radius)
    first = Limit(radius, {}, "contact_radius", "contact_radius", False)
    problem = _FreeModuli(dataclasses.replace(question, limits=(first, *question.limits)), modulus, hold)

    power_law, exponent = _best_power_law(problem)
    random, (low, high) = np.random.default_rng(0), problem.box.T
    corners = [
        problem.end(low + (0.05 + 0.9 * random.integers(0, 2, low.size)) * (high - low)) for _ in range(starts - 1)
    ]
    minima = problem.minima([power_law, *corners], _COARSE)
    minima = problem.minima(minima[:_REFINED], _FINE, minima[_REFINED:])  # two of them may end in one
    best = minima[0]
    radii = (radius * np.exp(problem.rows(one.modulus)[1, 0]).item() for one in (best, power_law))
    return FreeDesign(
        contact=on(best.modulus),
        power_law=on(power_law.modulus),
        exponent=exponent,
        reference=contact,
        value=best.value,
        power_law_value=power_law.value,
        reference_value=reference_value,
        contact_radii=(*radii, radius),
        question=question,
        profile=modulus,
        minima=tuple(minima),
        starts=starts,
        evaluations=sum(isinstance(key, tuple) for key in problem.evaluator.known),
        converged=bool(np.isfinite(best.value)) and _downhill(problem, best.modulus) < _FLAT,
    )


def _slsqp(
    rows: Callable[[np.ndarray], np.ndarray], held: bool, box: np.ndarray, change: float, start: np.ndarray
) -> np.ndarray:
    """Where SLSQP ends."""
    from scipy import optimize

    kinds = ("eq", slice(1, 1 + held)), ("ineq", slice(2, None))
    limits: Any = [
        {"type": kind, "fun": lambda x, part=part: rows(x)[part, 0], "jac": lambda x, part=part: rows(x)[part, 1:]}
        for kind, part in kinds
    ]
    with warnings.catch_warnings():
        # Older SciPy steps beyond a bound by rounding, and says so.
        warnings.filterwarnings("ignore", "Values in x were outside bounds", RuntimeWarning)
        found = optimize.minimize(
            lambda x: (rows(x)[0, 0], rows(x)[0, 1:]),
            start,
            jac=True,
            method="SLSQP",
            bounds=box,
            constraints=limits,
            options={"maxiter": 80, "ftol": change},
        )
    return np.clip(found.x, *box.T)


def _best_power_law(problem: _FreeModuli) -> tuple[LocalMinimum, float]:
    """The best power law clipped to the bounds: its moduli, and its exponent."""
    low, high = problem.box.T
    z = np.log(np.maximum(problem.depth, 1e-3 * problem.depth[1]))
    by = np.column_stack([z - z.mean(), np.ones(z.size)])  # the exponent, and log(E) in the middle
    box = np.array([[-0.999, 0.999], [low.min(), high.max()]])

    def rows(p: np.ndarray) -> np.ndarray:
        found, inside = problem.rows(np.exp(np.clip(by @ p, low, high))), (low < by @ p) & (by @ p < high)
        return np.column_stack([found[:, 0], found[:, 1:] @ (by * inside[:, None])])

    ends = [_slsqp(rows, problem.held, box, _FINE, np.array([k, problem.box.mean()])) for k in _EXPONENTS]
    return min(((problem.end(np.clip(by @ p, low, high)), float(p[0])) for p in ends), key=lambda pair: _rank(pair[0]))


def _downhill(problem: _FreeModuli, modulus: np.ndarray) -> float:
    """The largest change of log(objective) over the box that leads downhill within bounds and limits."""
    from scipy import optimize

    rows, width, axes = problem.rows(modulus), np.ptp(problem.box, axis=1), np.eye(modulus.size)
    by = rows[:, 1:] * width
    low, high = (np.abs(np.log(modulus) - end) < 1e-6 * width for end in problem.box.T)
    # Multipliers of the bounds that are reached and of the limits that are active, all >= 0 but for a held radius.
    held = by[1 : 1 + problem.held]
    active = by[2:][np.abs(rows[2:, 0]) < 10.0 * _KEPT]
    none = np.zeros((1, modulus.size))  # SciPy takes no empty matrix
    edges = np.concatenate([none, axes[low], -axes[high], active, held, -held])
    return float(optimize.nnls(edges.T, by[0])[1])
