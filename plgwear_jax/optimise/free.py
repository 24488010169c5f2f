"""The best E(z) that no formula prescribes: its values at some depths are the variables.

Wear and contact radius, with their derivatives by all moduli, come from one program. SciPy's SLSQP descends from many
starts, since there are several minima: an optimum mostly lies on bounds, and what there is to choose is the order and
the thickness of stiff and compliant depths.
"""

import dataclasses
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import POSITIVE, ArrayLike, Numbers, check
from plgwear_jax._core.numbers import for_numbers, refuse_traced
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import program
from plgwear_jax.catalogue import read_from
from plgwear_jax.contact import FrettingContact
from plgwear_jax.optimise.designing import between, certainty, headline, measured
from plgwear_jax.optimise.life import amplitudes_and_test, life_of
from plgwear_jax.optimise.question import Load, LoadGiven, Objective, load_of, objective_of
from plgwear_jax.steady.solution import Steady
from plgwear_jax.wear_laws import WearLaw

_DIGITS = 4  # the default of all numeric contacts: one program serves the search and the result
_COARSE, _FINE = 1e-4, 1e-6  # the least change of the logarithm, of all descents and of the best of them
_SAME = 3e-3  # ends of descents whose logarithms differ by less are one
_REFINED = 2  # minima
_KEPT = 1e-5  # of the logarithm of the contact radius
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

    at: Numbers
    lower: Numbers
    upper: Numbers
    steepness: float | None = None

    def __post_init__(self) -> None:
        given = self.at, self.lower, self.upper
        refuse_traced("ModulusProfile", given, "a DepthGraded may have traced moduli")
        for name in ("at", "lower", "upper"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), float))
        at, lower, upper = (np.asarray(x) for x in (self.at, self.lower, self.upper))
        if at.ndim != 1 or not at.shape == lower.shape == upper.shape or not 3 <= at.size <= 8:
            raise ValueError(f"at, lower and upper of shapes {at.shape}, {lower.shape}, {upper.shape}: 3 to 8 depths")
        from plgwear_jax.surfaces import DepthGraded  # which a power law under a rigid indenter does not need

        DepthGraded(at, lower, 0.0)  # which checks them
        if not np.all(np.diff(at) > 0.0):
            raise ValueError("at: the depths must increase")
        check("upper", upper, POSITIVE)
        if not np.all(lower < upper):
            i = int(np.argmin(lower < upper))
            raise ValueError(
                f"modulus at {at[i]:g} m: [{lower[i]:g}, {upper[i]:g}]: the lowest must be below the highest"
            )
        if self.steepness is not None:
            check("steepness", self.steepness, POSITIVE)
            if at[0] == 0.0:
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
        objective: What was minimised.
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
    objective: str
    profile: ModulusProfile
    minima: tuple[LocalMinimum, ...]
    starts: int
    evaluations: int
    converged: bool

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
        lower, upper = np.asarray(self.profile.lower), np.asarray(self.profile.upper)
        side = np.where(self.modulus <= lower * 1.0001, "lower", np.where(self.modulus >= upper / 1.0001, "upper", ""))
        return tuple(str(word) or None for word in side)

    @property
    def certified(self) -> bool:
        """Converged, and more than one start ended in the best minimum; a better one elsewhere cannot be excluded."""
        return self.converged and self.minima[0].starts > 1

    def __repr__(self) -> str:
        """The objective, the moduli, the best power law, the contact radii, and what is certain."""
        profile, lines = self.profile, [headline(self)]
        bounds = zip(profile.at, profile.lower, profile.upper, self.modulus, self.at_bound, strict=True)  # pyright: ignore
        for depth, low, high, modulus, side in bounds:
            lines.append(between(f"modulus at {measured('depth', depth)}", "modulus", modulus, (low, high), side))
        law = f"k = {self.exponent:.3g}, {self.objective} = {measured(self.objective, self.power_law_value)}"
        lines.append(f"best power law: {law if np.isfinite(self.power_law_value) else 'none keeps the limits'}")
        best, _, reference = (measured("contact_radius", radius) for radius in self.contact_radii)
        lines.append(f"contact_radius = {best}, that of the reference {reference}")
        lines.append(f"{self.minima[0].starts} of {self.starts} descents ended here, minima: {len(self.minima)}")
        return "\n  ".join(["FreeDesign:", *lines, certainty(self, ("converged", "certified"))])


Minimised = tuple[str, tuple[tuple[str, float], ...]]  # the quantity and its places


def _mean(objective: Minimised, contact: FrettingContact, load: Load, steady: Steady) -> Array:
    """The mean of the objective over the load: in the steady state, or after a life."""
    name, places = objective
    if load.life is None:
        worn = read_from(steady, name, [place for _, place in places])
    else:
        worn = load.life.read(contact, load.tangential_force, name, dict(places))
    return (load.weight * jnp.where(load.weight > 0.0, worn, 0.0)).sum()


@program(static=1, level=1)
def _evaluate(
    objective: Minimised, contact: FrettingContact, load: Load, depth: Array, log_modulus: Array
) -> tuple[Array, Array]:
    """The logarithms of the objective and of the contact radius, (2,), and their slopes by those of E, (2, n)."""
    from plgwear_jax.surfaces import DepthGraded

    force = jnp.nan_to_num(load.tangential_force)  # another load than the force leaves the contact radius as it is

    def logarithms(log_modulus: Array) -> Array:
        nu: Any = contact.material.nu
        material = DepthGraded(depth, jnp.exp(log_modulus), nu)
        there = dataclasses.replace(contact, material=material)
        steady = there.steady(force, digits=_DIGITS)
        return jnp.stack([jnp.log(_mean(objective, there, load, steady)), jnp.log(steady.contact_radius[0])])

    values, back = jax.vjp(logarithms, log_modulus)
    return values, jax.vmap(back)(jnp.eye(2, dtype=values.dtype))[0]


def _of_reference(contact: FrettingContact, load: Load, objective: Minimised) -> tuple[float, float]:
    """The objective and the contact radius of the reference."""
    steady = contact.steady(np.nan_to_num(load.tangential_force))
    return float(_mean(objective, contact, load, steady)), float(np.asarray(steady.contact_radius).flat[0])


class _Question:
    """The problem for SLSQP: log(E) scaled to 0 at the lower and 1 at the upper bound; no point is evaluated twice."""

    def __init__(
        self,
        contact: FrettingContact,
        load: Load,
        profile: ModulusProfile,
        objective: Minimised,
        radii: tuple[float | None, float | None],
    ):
        self.contact, self.load, self.objective, self.radii = contact, load, objective, radii
        self.held = radii[0] is not None and radii[0] == radii[1]  # the contact radius is held, not limited
        self.depth = np.asarray(profile.at)
        self.low, self.high = np.log(profile.lower), np.log(profile.upper)
        self.steepness = profile.steepness
        self.known: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values and slopes by x."""
        key = np.asarray(x).tobytes()
        if key not in self.known:
            modulus = self.low + np.clip(x, 0.0, 1.0) * (self.high - self.low)
            found = _evaluate(self.objective, self.contact, self.load, self.depth, modulus)
            values, slopes = (np.asarray(part, float) for part in jax.device_get(found))
            self.known[key] = values, slopes * (self.high - self.low)
        return self.known[key]

    def value(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The logarithm of the objective, and its slopes."""
        values, slopes = self.at(x)
        return values[0], slopes[0]

    def limits(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What has to be >= 0, and its slopes: of the contact radius, and of the steepness."""
        rows, slopes = [], []
        for bound, side in zip(self.radii, (1.0, -1.0), strict=True):
            if bound is not None:
                values, by = self.at(x)
                rows.append(side * (values[1] - np.log(bound)))
                slopes.append(side * by[1])
        if self.steepness is not None:
            width, number = self.high - self.low, len(x)
            step = (np.diff(np.eye(number), axis=0) * width) / np.diff(np.log(self.depth))[:, None]
            first = np.diff(self.low) / np.diff(np.log(self.depth))
            for side in (1.0, -1.0):
                rows += list(self.steepness - side * (first + step @ x))
                slopes += list(-side * step)
        return np.array(rows), np.array(slopes).reshape(len(rows), len(x))

    def moduli(self, x: np.ndarray) -> np.ndarray:
        """The moduli in Pa."""
        return np.exp(self.low + x * (self.high - self.low))

    def log_value(self, x: np.ndarray) -> float:
        """The logarithm of the objective; infinite where a limit is broken."""
        rows, _ = self.limits(x)
        return float(self.at(x)[0][0]) if np.all(rows > -_KEPT) and np.all(np.isfinite(self.at(x)[0])) else np.inf


@for_numbers("the methods of contacts on a DepthGraded work there")
def free_design(
    contact: FrettingContact,
    load: LoadGiven,
    modulus: ModulusProfile,
    *,
    weight: ArrayLike | None = None,
    level: float = 0.0,
    hold: bool = False,
    contact_radius: tuple[float | None, float | None] = (None, None),
    minimise: Objective = "wear_volume",
    starts: int = 20,
    seed: int = 0,
    cycles: ArrayLike | None = None,
    wear_coefficient: ArrayLike | WearLaw | None = None,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> FreeDesign:
    """Find the E(z) on which the indenter wears least, by its values at some depths, with PCHIP between them.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact with its reference material and its indenter; its fields are numbers.
        load: As of `design`; the time grows with the number of amplitudes.
        modulus: The depths, and the bounds of the modulus there.
        weight: Probabilities of the amplitudes, as of `design`.
        level: As of `design`: 0 takes the mean over the amplitudes, 1 the worst case.
        hold: Keep the contact radius of the reference.
        contact_radius: The lowest and the highest contact radius in m; either may be None.
        minimise: As of `design`.
        starts: How many descents are made, at least 1: from the power law, and from random corners of the bounds.
        seed: Seed of the random numbers.
        cycles: As of `design`, and so are the next ones.
        wear_coefficient: Archard's coefficient in 1/Pa, or a wear law.
        control: Which amplitude is held in these cycles.
        rig_stiffness: Rig stiffness in N/m.

    Returns:
        The best contact, with the other minima that were found, and the best power law within the same bounds.

    Raises:
        ValueError: An argument is outside its range.
    """
    if not isinstance(contact, FrettingContact):
        raise TypeError(f"contact takes a FrettingContact, not {contact!r}")
    name, places = objective_of(minimise, "fretting")
    objective = name, tuple((place, float(np.asarray(x))) for place, x in places.items())
    if starts < 1:
        raise ValueError(f"starts = {starts}: must be at least 1")
    if hold and contact_radius != (None, None):
        raise ValueError("contact_radius: cannot be limited while hold keeps it")
    force, test = amplitudes_and_test(load, weight)
    life = life_of(name, (), cycles, wear_coefficient, control, rig_stiffness, test)
    amplitudes = load_of(contact, force, weight, level, life)
    nu = contact.material.nu
    if isinstance(nu, str):
        raise ValueError('contact: nu = "holl" changes with k; a free gradient needs a number')
    from plgwear_jax.surfaces import DepthGraded

    assert not isinstance(nu, str)
    # One structure, and so one program, whatever the reference is.
    blank = dataclasses.replace(contact, material=DepthGraded(modulus.at, modulus.lower, nu))
    reference_value, radius = _of_reference(contact, amplitudes, objective)
    low, high = (radius, radius) if hold else contact_radius
    question = _Question(blank, amplitudes, modulus, objective, (low, high))

    power_law, exponent, law = _best_power_law(question)
    random = np.random.default_rng(seed)
    begun = [power_law] + [0.05 + 0.9 * random.integers(0, 2, question.depth.size) for _ in range(starts - 1)]
    minima = _distinct(question, [(_descended(question, np.asarray(x, float), _COARSE), 1) for x in begun])
    refined = [(_descended(question, x, _FINE), n) for x, n in minima[:_REFINED]]
    minima = _distinct(question, refined + minima[_REFINED:])  # again: two of them may have ended in one
    x = minima[0][0]
    local = tuple(LocalMinimum(np.exp(question.log_value(x)).item(), question.moduli(x), n) for x, n in minima)

    def on(moduli: np.ndarray) -> FrettingContact:
        return dataclasses.replace(contact, material=DepthGraded(np.asarray(modulus.at), moduli, nu))

    radii = [np.exp(question.at(one)[0][1]).item() for one in (x, power_law)]
    return FreeDesign(
        contact=on(local[0].modulus),
        power_law=on(question.moduli(power_law)),
        exponent=exponent,
        reference=contact,
        value=local[0].value,
        power_law_value=law,
        reference_value=reference_value,
        contact_radii=(*radii, radius),
        objective=name,
        profile=modulus,
        minima=local,
        starts=starts,
        evaluations=len(question.known),
        converged=np.isfinite(question.log_value(x)) and _downhill(question, x) < _FLAT,
    )


Rows = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def _slsqp(
    start: np.ndarray, value: Rows, limits: Rows, held: bool, bounds: Any = None, change: float = _FINE
) -> np.ndarray:
    """Where SLSQP ends; the first limit of a held radius is an equation, and the second one is left out."""
    from scipy import optimize

    kinds: list[dict[str, Any]] = []
    if limits(start)[0].size:
        equation, rest = (slice(0, 1), slice(2, None)) if held else (None, slice(None))
        for kind, part in (("eq", equation), ("ineq", rest)):
            if part is not None and limits(start)[0][part].size:
                rows = {"fun": lambda x, part=part: limits(x)[0][part], "jac": lambda x, part=part: limits(x)[1][part]}
                kinds.append({"type": kind, **rows})
    with warnings.catch_warnings():
        # Older SciPy steps beyond a bound by rounding, and says so.
        warnings.filterwarnings("ignore", "Values in x were outside bounds", RuntimeWarning)
        found = optimize.minimize(
            value,
            start,
            jac=True,
            method="SLSQP",
            bounds=bounds or [(0.0, 1.0)] * start.size,
            constraints=kinds,
            options={"maxiter": 80, "ftol": change},
        )
    return found.x


def _descended(question: _Question, start: np.ndarray, change: float) -> np.ndarray:
    return np.clip(_slsqp(start, question.value, question.limits, question.held, None, change), 0.0, 1.0)


def _distinct(question: _Question, ends: list[tuple[np.ndarray, int]]) -> list[tuple[np.ndarray, int]]:
    """The minima at which so many descents ended, the best one first; those that break limits come last."""
    found: list[tuple[np.ndarray, int]] = []
    for x, number in sorted(ends, key=lambda end: question.log_value(end[0])):
        if found and not question.log_value(x) - question.log_value(found[-1][0]) >= _SAME:
            found[-1] = (found[-1][0], found[-1][1] + number)
        else:
            found.append((x, number))
    kept = [one for one in found if np.isfinite(question.log_value(one[0]))]
    return kept or found


def _best_power_law(question: _Question) -> tuple[np.ndarray, float, float]:
    """The best power law clipped to the bounds: where it lies between them, its exponent, and its objective."""
    width, middle = question.high - question.low, 0.5 * (question.low + question.high).mean()
    z = np.log(np.maximum(question.depth, 1e-3 * question.depth[1]))
    z = z - z.mean()
    scale = float(np.ptp(question.low) + width.max())

    def clipped(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The moduli for the exponent and the modulus in the middle, between the bounds, and their slopes."""
        x = (middle + scale * p[1] + p[0] * z - question.low) / width
        inside = ((x > 0.0) & (x < 1.0)) / width
        return np.clip(x, 0.0, 1.0), np.stack([z * inside, scale * inside], axis=1)

    def along(rows: Rows) -> Rows:
        def of_power_law(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            x, slopes = clipped(p)
            values, by = rows(x)
            return values, by @ slopes

        return of_power_law

    bounds = [(-0.999, 0.999), (-1.0, 1.0)]
    starts = [np.array([k, 0.0]) for k in _EXPONENTS]
    ends = [_slsqp(p, along(question.value), along(question.limits), question.held, bounds) for p in starts]
    best = min(ends, key=lambda p: question.log_value(clipped(p)[0]))
    x = clipped(best)[0]
    least = question.log_value(x)
    return x, float(best[0]), float(np.exp(least)) if np.isfinite(least) else float("nan")


def _downhill(question: _Question, x: np.ndarray) -> float:
    """The largest change of log(objective) over the box that leads downhill within bounds and limits."""
    from scipy import optimize

    slope = question.at(x)[1][0]
    rows, by = question.limits(x)
    active = by[np.abs(rows) < 10.0 * _KEPT]
    # Multipliers of the bounds that are reached and of the limits that are active, all >= 0 but for a held radius.
    edges = np.concatenate([np.eye(x.size)[x < 1e-6], -np.eye(x.size)[x > 1.0 - 1e-6], active])
    if not edges.size:
        return float(np.abs(slope).max())
    return float(optimize.nnls(edges.T, slope)[1])
