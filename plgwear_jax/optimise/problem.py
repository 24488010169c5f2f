"""The question of a design: what may vary, what is held, the limits, and what is minimised.

Wear depends on the material only through k and the contact radius a_0, and is proportional to a power of a_0. It grows
with the force amplitude for every material. So over a table of amplitudes the mean, the worst case and the mean of the
worst cases are means with weights that do not depend on the design, and smooth functions of it.
"""

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.typing import ArrayLike

from plgwear_jax import fretting, gross_slip
from plgwear_jax._core.domains import EXPONENT, POSITIVE, check
from plgwear_jax._core.programs import program
from plgwear_jax._core.record import record
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.optimise.loads import padded, sorted_loads
from plgwear_jax.optimise.minimum import Interval, Minimum, found_by, plan_of
from plgwear_jax.optimise.search import begin_solver
from plgwear_jax.optimise.state import Plan

__all__ = [
    "BROKEN",
    "Bounds",
    "Candidate",
    "Evaluation",
    "Hold",
    "Limits",
    "ModulusWindow",
    "Objective",
    "Question",
    "Task",
    "Told",
    "asked",
    "concrete",
    "evaluate",
    "limits_by_name",
    "questioned",
    "reference_variables",
    "rows",
    "search",
    "space",
]

Hold = Literal["contact_radius_by_E0", "contact_radius_by_z0"]
Objective = Literal["wear_volume", "worn_radius", "deepest_wear", "volume_change", "force_drop"]
Bounds = tuple[float, float]

BROKEN = 1e-6  # log(value/limit) above which a limit is broken by more than rounding


@record
class ModulusWindow:
    """The lowest and highest modulus with which a coating can be made, at two depths.

    Attributes:
        at: The two depths in m, positive, the smaller one first.
        lower: The lowest modulus in Pa at each of them.
        upper: The highest modulus in Pa at each of them.
    """

    at: tuple[float, float]
    lower: tuple[float, float]
    upper: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("at", "lower", "upper"):
            pair = getattr(self, name)
            if len(pair) != 2:
                raise ValueError(f"modulus: {name} = {pair}: must be a pair")
            for value in pair:
                check(f"modulus: {name}", value, POSITIVE)
        if not self.at[0] < self.at[1]:
            raise ValueError(f"modulus: at = {self.at}: the smaller depth must come first")
        for depth, lowest, highest in zip(self.at, self.lower, self.upper, strict=True):
            if not lowest < highest:
                raise ValueError(f"modulus at {depth} m: [{lowest}, {highest}]: the lowest must be below the highest")

    def exponents(self) -> Bounds:
        """The lowest and the highest exponent k that the window allows."""
        decades = math.log(self.at[1] / self.at[0])
        return math.log(self.lower[1] / self.upper[0]) / decades, math.log(self.upper[1] / self.lower[0]) / decades


@record
class Limits:
    """The limits of a design; None means no limit.

    Attributes:
        edge_pressure: Highest pressure p_inf in Pa at the distance `distance` inside the stick edge, Eq. (17). This is
            the usual way to compare singularities of different order.
        distance: This critical distance in m.
        contact_radius: Lowest and highest initial contact radius a_0 in m; either may be None.
        penetration: Largest penetration d_inf in m.
        modulus: The window of E(z) at two depths.
    """

    edge_pressure: ArrayLike | None = None
    distance: ArrayLike | None = None
    contact_radius: tuple[ArrayLike | None, ArrayLike | None] | None = None
    penetration: ArrayLike | None = None
    modulus: ModulusWindow | None = None

    def __post_init__(self) -> None:
        if self.edge_pressure is not None and self.distance is None:
            raise ValueError("limits: edge_pressure needs the distance from the stick edge at which it is taken")
        lowest, highest = self.contact_radius or (None, None)
        named = {
            "edge_pressure": self.edge_pressure,
            "distance": self.distance,
            "penetration": self.penetration,
            "contact_radius, lowest": lowest,
            "contact_radius, highest": highest,
        }
        for name, value in named.items():
            if value is not None:
                check(f"limits: {name}", value, POSITIVE)
        known = not isinstance(lowest, Tracer) and not isinstance(highest, Tracer)
        if known and lowest is not None and highest is not None and not np.all(np.less(lowest, highest)):
            raise ValueError(f"limits: contact_radius = {self.contact_radius}: the lowest must be below the highest")


class Question(NamedTuple):
    """The question without its numbers."""

    objective: str
    hold: Hold | None


@record
class Task:
    """The numbers of a design: all inputs with respect to which the result can be differentiated."""

    contact: Any  # of either kind
    phi: Any  # amplitudes F_x/(mu F_N) that count, the largest one first
    weight: Any
    bounds: dict[str, tuple[ArrayLike, ArrayLike]]
    depths: tuple[ArrayLike, ArrayLike] | None  # of the two moduli, where these are varied
    limits: Limits


SHALLOW, DEEP = "shallow_modulus", "deep_modulus"
POWERS = {"wear_volume": 4, "deepest_wear": 2, "worn_radius": 1}  # of a_0


# --- a choice of the variables ----------------------------------------------------------------------------------------


class Candidate:
    """Choices of the variables, scalars or arrays of one shape: their contacts, objective and limits.

    Only what is used is computed.
    """

    def __init__(
        self,
        question: Question,
        task: Task,
        variables: Mapping[str, ArrayLike],
        radii: tuple[Array | None, Array] | None = None,  # a_0 with nothing held, and the held a_0, where known
    ) -> None:
        self.question, self.task, self.radii = question, task, radii
        if SHALLOW in variables:
            assert task.depths is not None
            z1, z2 = task.depths
            E1, E2 = variables[SHALLOW], variables[DEEP]
            k = jnp.log(jnp.asarray(E2) / E1) / jnp.log(jnp.asarray(z2) / z1)
            self.changes: dict[str, Any] = {"E0": E1, "z0": z1, "k": k}
        else:
            self.changes = dict(variables)

    @property
    def k(self) -> Any:
        """Their exponents."""
        return self.changes.get("k", self.task.contact.material.k)

    @functools.cached_property
    def contact(self) -> Any:
        """Their contacts, with E0 or z0 adjusted to hold the contact radius."""
        reference, hold = self.task.contact, self.question.hold
        material = dataclasses.replace(reference.material, **self.changes)
        if hold is not None:
            # a_0 depends on E0/z0^k alone, Eq. (12).
            free = self.radii[0] if self.radii else None
            free = dataclasses.replace(reference, material=material).contact_radius() if free is None else free
            log_lack = (3.0 + jnp.asarray(material.k)) * jnp.log(free / self.contact_radius)
            if hold == "contact_radius_by_E0":
                material = dataclasses.replace(material, E0=material.E0 * jnp.exp(log_lack))
            else:
                material = dataclasses.replace(material, z0=material.z0 * jnp.exp(-log_lack / material.k))
        return dataclasses.replace(reference, material=material)

    @functools.cached_property
    def contact_radius(self) -> Array:
        """Their initial contact radii a_0 in m."""
        if self.question.hold is None:
            return self.contact.contact_radius()
        return self.radii[1] if self.radii else self.task.contact.contact_radius()

    def objective(self) -> Array:
        """The logarithm of what is minimised, divided by a constant; see `log_unit`."""
        name, k = self.question.objective, self.k
        if name in ("volume_change", "force_drop"):
            return jnp.log(getattr(gross_slip, name)(k))
        worn = getattr(fretting, name)(jnp.asarray(k)[..., None], self.task.phi)
        wear = jnp.log((self.task.weight * worn).sum(-1))
        return wear if self.question.hold is not None else wear + POWERS[name] * jnp.log(self.contact_radius)

    def log_unit(self) -> ArrayLike:
        """The logarithm of that constant, in SI units."""
        name, contact = self.question.objective, self.task.contact
        if name == "force_drop":
            return 0.0
        radius = jnp.asarray(contact.radius)
        if name == "volume_change":
            return jnp.log(jnp.pi * radius * radius * contact.depth)
        held = POWERS[name] * jnp.log(self.contact_radius) if self.question.hold is not None else 0.0
        return held if name == "worn_radius" else held - jnp.log(radius)

    def states(self) -> dict[str, tuple[Array, ArrayLike, int]]:
        """For each limit the limited value, the limit, and the allowed side: -1 below, +1 above.

        All values that depend on the amplitude rise with it, so they are taken at the largest one.
        """
        limits, found = self.task.limits, {}
        if limits.edge_pressure is not None:
            found["edge_pressure"] = (self.edge_pressure(), limits.edge_pressure, -1)
        lowest, highest = limits.contact_radius or (None, None)
        if lowest is not None:
            found["contact_radius_lowest"] = (self.contact_radius, lowest, 1)
        if highest is not None:
            found["contact_radius_highest"] = (self.contact_radius, highest, -1)
        if limits.penetration is not None:
            height = self.contact_radius**2 / jnp.asarray(self.task.contact.radius)
            depth = fretting.penetration(self.k, self.task.phi[0])
            found["penetration"] = (height * depth, limits.penetration, -1)
        if limits.modulus is not None:
            ends = zip(("shallow", "deep"), limits.modulus.at, limits.modulus.lower, limits.modulus.upper, strict=True)
            for name, depth, lowest, highest in ends:
                modulus = self.contact.material.modulus(depth)
                found[f"{name}_modulus_lowest"] = (modulus, lowest, 1)
                found[f"{name}_modulus_highest"] = (modulus, highest, -1)
        return dict(sorted(found.items()))  # the order that JAX gives a dict as well

    def edge_pressure(self) -> Array:
        """p_inf in Pa at the critical distance, at the largest amplitude."""
        a_0, contact = self.contact_radius, self.task.contact
        relative = jnp.asarray(self.task.limits.distance) / a_0
        return (
            jnp.asarray(contact.normal_force)
            / (jnp.pi * a_0 * a_0)
            * fretting.edge_pressure(relative, self.k, self.task.phi[0])
        )

    def excess(self) -> list[Array]:
        """log(value/limit) for each limit, with the sign that is positive where the limit is broken."""
        return [-side * jnp.log(value / bound) for value, bound, side in self.states().values()]


def limits_by_name(limits: Limits) -> dict[str, ArrayLike]:
    """The limits, by the names of `Candidate.states` and in their order."""
    lowest, highest = limits.contact_radius or (None, None)
    named = {
        "edge_pressure": limits.edge_pressure,
        "contact_radius_lowest": lowest,
        "contact_radius_highest": highest,
        "penetration": limits.penetration,
    }
    window = limits.modulus
    if window is not None:
        for name, lowest, highest in zip((SHALLOW, DEEP), window.lower, window.upper, strict=True):
            named |= {f"{name}_lowest": lowest, f"{name}_highest": highest}
    return {name: allowed for name, allowed in sorted(named.items()) if allowed is not None}


def rows(
    question: Question,
    task: Task,
    variables: Mapping[str, ArrayLike],
    radii: tuple[Array | None, Array] | None = None,
) -> Array:
    """The logarithm of the objective, over a constant, and the excess of each limit, along a last axis of 1 + m.

    Args:
        question: What is asked.
        task: Its numbers.
        variables: Scalars, or arrays of one shape.
        radii: See `Candidate`.
    """
    candidate = Candidate(question, task, variables, radii)
    told = [candidate.objective(), *candidate.excess()]
    return jnp.stack(jnp.broadcast_arrays(*told), axis=-1)


def reference_variables(task: Task) -> dict[str, ArrayLike]:
    """The values of the variables for the contact as given."""
    material = task.contact.material
    if task.depths is None:
        return {name: getattr(material, name) for name in task.bounds}
    # Eq. (1), for numbers of NumPy as well as for traced ones
    moduli = [material.E0 * (depth / material.z0) ** material.k for depth in task.depths]
    return dict(zip((SHALLOW, DEEP), moduli, strict=True))


def space(task: Task) -> dict[str, Interval]:
    """The box of the variables: moduli and z0 are searched on a logarithmic scale."""
    scales: dict[str, Literal["linear", "logarithmic"]] = {"k": "linear"}
    return {name: Interval(*bounds, scales.get(name, "logarithmic")) for name, bounds in task.bounds.items()}


# --- numbers in, numbers out ------------------------------------------------------------------------------------------


class Evaluation(NamedTuple):
    """The result of `evaluate` at several choices of the variables."""

    values: Any  # of `rows`, (lanes, 1 + m)
    slopes: Any  # with respect to k, and to the logarithm of other variables, (lanes, 1 + m, n)
    materials: Any  # `PowerLawGraded`, each field an array of shape (lanes,)
    log_unit: Any  # to be added to the objective for SI units


@program(static=2)
def _evaluate(question: Question, names: tuple[str, ...], task: Task, variables: dict[str, Array]) -> Evaluation:
    still = jnp.zeros_like(variables[names[0]])
    radii = None
    if question.hold is not None:  # one call for all radii, that of the reference last
        reference = reference_variables(task)
        everyone = {name: jnp.append(variables[name], reference[name]) for name in names}
        free = Candidate(question._replace(hold=None), task, everyone).contact_radius
        radii = free[:-1], free[-1]

    def along(name: str) -> tuple[Array, Array]:
        """`rows`, and their slopes by one of the variables."""

        def moved(step: Array) -> Array:
            value = variables[name]
            there = variables | {name: value + step if name == "k" else value * jnp.exp(step)}
            return rows(question, task, there, radii and (None, radii[1]))

        return jax.jvp(moved, (still,), (jnp.ones_like(still),))

    told = [along(name) for name in names]  # XLA computes the common values once
    values, slopes = told[0][0], jnp.stack([slope for _, slope in told], axis=-1)
    candidate = Candidate(question, task, variables, radii)
    materials = jax.tree.map(lambda field: jnp.broadcast_to(field, still.shape), candidate.contact.material)
    return Evaluation(values, slopes, materials, candidate.log_unit())


def evaluate(question: Question, task: Task, variables: Mapping[str, ArrayLike]) -> Evaluation:
    """`rows` and their slopes at concrete choices of the variables, each an array of shape (points,).

    The program takes as many points as the search does, and is compiled once for a question: another load, limit or
    material uses it again.
    """
    numbers = concrete(task)
    points = {name: np.atleast_1d(concrete(variables[name])) for name in task.bounds}
    lanes = _plan(task).lanes
    count = next(iter(points.values())).size
    found = []
    for first in range(0, count, lanes):
        some = {name: value[np.minimum(np.arange(first, first + lanes), count - 1)] for name, value in points.items()}
        found.append(jax.device_get(_evaluate(question, tuple(points), numbers, some)))
    values, slopes, materials = jax.tree.map(lambda *parts: np.concatenate(parts)[:count], *(x[:3] for x in found))
    return Evaluation(values, slopes, materials, found[0].log_unit)


def concrete(tree: Any) -> Any:
    """The same numbers as NumPy arrays of one dtype, so that one program is enough."""
    dtype = np.dtype(jnp.result_type(float))
    return jax.tree.map(lambda x: np.asarray(x, dtype), tree)


def _plan(task: Task) -> Plan:
    return plan_of(len(task.bounds), len(limits_by_name(task.limits)))


def begin(question: Question, task: Task) -> None:
    """Begin to compile what `search` and `evaluate` need, if programs are compiled ahead."""
    plan = _plan(task)
    points = {name: np.zeros(plan.lanes, plan.dtype) for name in task.bounds}
    _evaluate.begin(question, tuple(points), concrete(task), points)
    begin_solver(plan)


Told = tuple[np.ndarray, np.ndarray]  # values and slopes


def search(question: Question, task: Task, told: Callable[[np.ndarray, np.ndarray], Told] | None = None) -> Minimum:
    """The minimum of the logarithm of the objective, for concrete numbers.

    Args:
        question: What is asked.
        task: Its numbers.
        told: Changes the values and slopes before the search gets them, to minimise something else by the same program.
    """
    numbers = concrete(task)

    def at(variables: dict[str, np.ndarray]) -> Told:
        found = _evaluate(question, tuple(variables), numbers, variables)
        both = np.array(found.values), np.array(found.slopes)
        return both if told is None else told(*both)

    return found_by(at, space(task), len(limits_by_name(task.limits)))


# --- what is refused ------------------------------------------------------------------------------------------------

_FRETTING_OBJECTIVES = tuple(POWERS)
_GROSS_SLIP_OBJECTIVES = ("volume_change", "force_drop")
_VARIABLES = {"k": EXPONENT, "z0": POSITIVE, "E0": POSITIVE}


def asked(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: Hold | None = None,
    minimise: str | None = None,
    limits: Limits | None = None,
) -> tuple[Question, Task]:
    """The question and its numbers, or a ValueError; the arguments are those of `design`."""
    limits = limits or Limits()
    question, bounds, depths = questioned(contact, tangential_force, vary, hold, minimise, limits)
    if isinstance(contact, GrossSlipContact):
        return question, Task(contact, None, None, bounds, depths, limits)
    assert tangential_force is not None
    phi, weight = padded(*sorted_loads(contact, tangential_force, weight, level))
    return question, Task(contact, phi, weight, bounds, depths, limits)


def questioned(
    contact: FrettingContact | GrossSlipContact,
    tangential_force: ArrayLike | None,
    vary: Mapping[str, Bounds | ModulusWindow],
    hold: Hold | None,
    objective: str | None,
    limits: Limits,
) -> tuple[Question, dict[str, tuple[ArrayLike, ArrayLike]], tuple[ArrayLike, ArrayLike] | None]:
    """The question, the bounds of the variables, and the depths of the moduli if they are these, or a ValueError."""
    slips = isinstance(contact, GrossSlipContact)
    objectives = _GROSS_SLIP_OBJECTIVES if slips else _FRETTING_OBJECTIVES
    if objective is None:
        objective = objectives[0]
    if objective not in objectives:
        raise ValueError(f"minimise = {objective!r} is not one of {', '.join(objectives)}")
    if hold not in (None, "contact_radius_by_E0", "contact_radius_by_z0"):
        raise ValueError(f'hold = {hold!r} is neither "contact_radius_by_E0", "contact_radius_by_z0" nor None')
    bounds, depths = _variables(vary, hold, contact.material.k)
    if slips:
        if set(bounds) != {"k"} or hold is not None or limits != Limits() or tangential_force is not None:
            raise ValueError("gross slip at a fixed depth depends on k alone: vary k alone, without hold, limits, load")
    elif tangential_force is None:
        raise ValueError("tangential_force: a fretting contact needs the amplitude of the force, in N")
    elif hold is not None and limits.contact_radius is not None:
        raise ValueError("limits: contact_radius cannot be limited while hold fixes it")
    return Question(objective, hold), bounds, depths


def _variables(
    vary: Mapping[str, Bounds | ModulusWindow], hold: str | None, k: ArrayLike
) -> tuple[dict[str, tuple[ArrayLike, ArrayLike]], tuple[ArrayLike, ArrayLike] | None]:
    """The bounds of the variables of the search, and the depths of the moduli if they are these."""
    window = vary.get("modulus")
    if window is not None:
        if not isinstance(window, ModulusWindow):
            raise ValueError(f"vary: modulus takes a ModulusWindow, not {window!r}")
        if set(vary) != {"modulus"}:
            raise ValueError("vary: modulus sets both k and E0/z0^k: nothing else can vary beside it")
        if hold is not None:
            text = "with the contact radius held only k can vary: vary k, and put the window under limits"
            raise ValueError(f"vary: modulus sets both k and E0/z0^k; {text}")
        lowest, highest = window.exponents()
        if not (lowest > -1.0 and highest < 1.0):
            raise ValueError(f"vary: modulus allows k from {lowest:.3g} to {highest:.3g}: allowed is -1 < k < 1")
        ends = zip(window.lower, window.upper, strict=True)
        return dict(zip((SHALLOW, DEEP), ends, strict=True)), window.at
    bounds: dict[str, tuple[ArrayLike, ArrayLike]] = {}
    for name, pair in vary.items():
        if name not in _VARIABLES:
            raise ValueError(f"vary: {name!r} is not one of {', '.join(_VARIABLES)}, modulus")
        assert not isinstance(pair, ModulusWindow)
        lowest, highest = pair
        check(f"vary: lowest {name}", lowest, _VARIABLES[name])
        check(f"vary: highest {name}", highest, _VARIABLES[name])
        if not lowest < highest:
            raise ValueError(f"vary: {name} = [{lowest}, {highest}]: the lowest value must be below the highest")
        bounds[name] = (lowest, highest)
    if not bounds:
        raise ValueError(f"vary is empty: name at least one of {', '.join(_VARIABLES)}, modulus")
    if "z0" in bounds and "E0" in bounds:
        raise ValueError("vary: a contact depends on z0 and E0 only through E0/z0^k: vary one of them")
    if hold is not None and set(bounds) != {"k"}:
        raise ValueError("vary: with the contact radius held only k can vary: z0 and E0 enter only through E0/z0^k")
    if bounds.keys() == {"z0"} and not isinstance(k, Tracer) and np.any(np.equal(k, 0.0)):
        raise ValueError("vary: z0 has no effect at k = 0")
    if hold == "contact_radius_by_z0" and np.sign(bounds["k"][0]) * np.sign(bounds["k"][1]) <= 0.0:
        raise ValueError("hold: z0 has no effect at k = 0; for contact_radius_by_z0 the bounds of k need one sign")
    return bounds, None
