"""Design problems as a SciPy user has them: the formulas on scipy.special, the searches by scipy.optimize.

Imports nothing of the library and states no derivative. Lengths are in m and stresses in Pa; k is a number, phi and
what comes with it an array over the amplitudes of a load. Values are good to some 1e-13, so that differences of 1e-9
mean something: the wear volume by its closed form, written such that nothing cancels.

    alone(problem)                      what each of SciPy's methods makes of a problem from one start
    best(problem, starts=20)            the best of many starts and methods
"""

import dataclasses
import itertools
import time
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, special

Array: TypeAlias = NDArray[np.float64]
Span: TypeAlias = tuple[float, float]


# --- the worn ring --------------------------------------------------------------------------------------------------

# s = (1+k)/2, q = 1-s, y = (r/c)^2 - 1, Q = I_(y/(1+y))(q, s), and S_j the integral of v^j/(1+vy) v^(q-1) from 0 to 1,
# so that Q = (sin(pi s)/pi) y^q S_0. The load of a ring that ends at y is G = y (s + q S_1/S_0), and its edge the root
# of G = m = phi/((1-phi)(1+s)).


def _moments(y: Array, s: float) -> tuple[Array, Array, Array]:
    """S_0, S_1, S_2: downward from 2F1 for y <= 1, upward from the incomplete beta function beyond."""
    q, narrow = 1 - s, y <= 1.0
    found = np.empty((3, y.size))
    if narrow.any():
        v = y[narrow]
        S2 = special.hyp2f1(1.0, 2 + q, 3 + q, -v) / (2 + q)
        S1 = 1 / (1 + q) - v * S2
        found[:, narrow] = 1 / q - v * S1, S1, S2
    if not narrow.all():
        v = y[~narrow]
        Q = np.where(v < 5.0, special.betainc(q, s, v / (1 + v)), 1 - special.betainc(s, q, 1 / (1 + v)))
        S0 = Q * np.pi / np.sin(np.pi * s) * v**-q
        S1 = (1 / q - S0) / v
        found[:, ~narrow] = S0, S1, (1 / (1 + q) - S1) / v
    return found[0], found[1], found[2]


def _slip(s: float, phi: Array) -> Array:
    return phi / ((1 - phi) * (1 + s))


def _ring(k: float, phi: Array) -> Array:
    """The edge, by Newton's method from a lower bound: G is concave, so every step stays below the edge."""
    s, q = (1 + k) / 2, (1 - k) / 2
    m = _slip(s, phi)
    y = (1 + q) * m
    for _ in range(50):
        S0, S1, _ = _moments(y, s)
        slope = s - (q * S1 - 1 / (1 + y)) / S0**2
        step = (m - y * (s + q * S1 / S0)) / slope
        y = y + step
        if np.all(np.abs(step) <= 1e-9 * y):  # its square is left
            break
    return y


def stick_radius(k: float, phi: Array) -> Array:
    return (1 - phi) ** (1 / (k + 3))


def wear_volume(k: float, phi: Any) -> Array:
    """Eq. (28) in units of a_0^4/R."""
    phi = np.atleast_1d(np.asarray(phi, float))
    s, q = (1 + k) / 2, (1 - k) / 2
    y = _ring(k, phi)
    S0, S1, S2 = _moments(y, s)
    braces = (S0 - 2 * S1 + S2) / 2 + q / s * (S2 - S1**2 / S0)
    return np.sin(np.pi * s) / 2 * stick_radius(k, phi) ** 4 * y ** (2 + q) * braces


def _worn_radius(k: float, phi: Array) -> Array:
    """Eq. (26) in units of a_0."""
    return stick_radius(k, phi) * np.sqrt(1 + _ring(k, phi))


def penetration(k: float, phi: Array) -> Array:
    """Eqs. (11) and (25) in units of a_0^2/R."""
    s = (1 + k) / 2
    return stick_radius(k, phi) ** 2 * (1 + _slip(s, phi)) / (2 * s)


def edge_pressure(distance: float, k: float, phi: Array) -> Array:
    """Eq. (17) at r = c - distance, or at 0 from there on, in units of F_N/(pi a_0^2); the distance in a_0."""
    s, q = (1 + k) / 2, (1 - k) / 2
    c = stick_radius(k, phi)
    relative = np.minimum(distance / c, 1.0)
    z = relative * (2 - relative)
    return ((1 + s) * (1 - phi) * z**s + s * phi * z**-q) / c**2


# --- the contact ----------------------------------------------------------------------------------------------------


class Contact(NamedTuple):
    """The reference: a parabolic indenter on a graded half-space, or (`depth` given) a flat punch."""

    E0: float
    z0: float
    k: float
    nu: Any  # a number, or "holl"
    radius: float
    normal_force: float = np.nan
    friction: float = np.nan
    depth: float | None = None


def _h_N(k: float, nu: float) -> float:
    """Eqs. (29)-(31)."""
    gamma = special.gamma
    beta = np.sqrt((1 + k) * (1 - k * nu / (1 - nu)))
    C = 2 ** (1 + k) * gamma((3 + k + beta) / 2) * gamma((3 + k - beta) / 2) / (np.pi * gamma(2 + k))
    above = 2 * (1 + k) * np.cos(k * np.pi / 2) * gamma(1 + k / 2)
    return above / (np.sqrt(np.pi) * C * beta * np.sin(beta * np.pi / 2) * gamma((1 + k) / 2))


def _log_load(contact: Contact, k: float) -> float:
    """log of a_0^(k+3) E0/z0^k, Eq. (12)."""
    nu = 1 / (2 + k) if contact.nu == "holl" else float(contact.nu)
    load = contact.normal_force * contact.radius * (1 - nu**2) * (k + 1) ** 2 * (k + 3)
    return np.log(load / (4 * _h_N(k, nu)))


def _log_stiffness(contact: Contact) -> float:
    return np.log(contact.E0) - contact.k * np.log(contact.z0)


def log_contact_radius(contact: Contact, k: float, log_stiffness: float) -> float:
    return (_log_load(contact, k) - log_stiffness) / (k + 3)


# --- the problem ----------------------------------------------------------------------------------------------------


class Limits(NamedTuple):
    """What a design must hold; None is no limit."""

    edge_pressure: float | None = None
    distance: float | None = None
    contact_radius: tuple[float | None, float | None] | None = None
    penetration: float | None = None
    modulus: tuple[tuple[float, float, float], ...] | None = None  # depth, lowest, highest

    @property
    def names(self) -> tuple[str, ...]:
        """Of what is limited."""
        return tuple(n for n, limit in self._asdict().items() if limit is not None and n != "distance")


WEAR = {"wear_volume": wear_volume, "worn_radius": _worn_radius}


@dataclasses.dataclass(frozen=True)
class Problem:
    """A design problem; what SciPy varies are numbers from 0 to 1, k linearly and all others by their logarithms."""

    kind: str
    contact: Contact
    forces: tuple[float, ...]
    weight: tuple[float, ...]
    level: float  # of the CVaR: 0 is the mean, 1 the worst case
    vary: dict[str, Span]
    hold: bool  # the contact radius, by E0
    objective: str
    limits: Limits

    @property
    def size(self) -> int:
        return len(self.vary)

    @property
    def limited(self) -> bool:
        return bool(self.limits.names)

    @property
    def load(self) -> str:
        if self.contact.depth is not None:
            return "gross slip"
        if len(self.forces) == 1:
            return "one amplitude"
        return {0.0: "mean", 1.0: "worst"}.get(self.level, "CVaR")

    def material(self, u: Array) -> tuple[float, float]:
        """(k, log of E0/z0^k) of the variables."""
        found = self.variables(u)
        k = found.get("k", self.contact.k)
        if self.hold:
            held = log_contact_radius(self.contact, self.contact.k, _log_stiffness(self.contact))
            return k, _log_load(self.contact, k) - (k + 3) * held
        return k, np.log(found.get("E0", self.contact.E0)) - k * np.log(found.get("z0", self.contact.z0))

    def variables(self, u: Array) -> dict[str, float]:
        """By name, in SI units."""
        found = {}
        for share, (name, (lower, upper)) in zip(u, self.vary.items(), strict=True):
            found[name] = lower + share * (upper - lower) if name == "k" else lower * (upper / lower) ** share
        return found


def _tail_mean(values: Array, weight: Array, level: float) -> float:
    """The mean of the worst 1-level of the probability."""
    order = np.argsort(-values)
    if level == 1.0:
        return float(values[order[0]])
    weight = weight[order] / weight.sum()
    taken = np.diff(np.minimum(np.cumsum(weight), 1 - level), prepend=0.0)
    return float(taken @ values[order] / taken.sum())


def amplitudes(problem: Problem) -> Array:
    return np.array(problem.forces) / (problem.contact.friction * problem.contact.normal_force)


def objective(problem: Problem, u: Array) -> float:
    """What is to be made small, in SI units."""
    contact = problem.contact
    k, log_stiffness = problem.material(u)
    if contact.depth is not None:
        if problem.objective == "force_drop":  # Eq. (10)
            return 1 - np.pi * (1 - k) * (1 + k) / (4 * np.cos(k * np.pi / 2))
        lost = special.gamma(1 - k / 2) * 2 ** (1 - k) / (np.sqrt(np.pi) * special.gamma((5 - k) / 2))  # Eq. (7)
        return np.pi * contact.radius**2 * contact.depth * (1 - lost)
    values = WEAR[problem.objective](k, amplitudes(problem))
    power = 1 if problem.objective == "worn_radius" else 4
    unit = np.exp(power * log_contact_radius(contact, k, log_stiffness))
    unit /= 1.0 if problem.objective == "worn_radius" else contact.radius
    return float(unit * _tail_mean(values, np.array(problem.weight), problem.level))


def limited(problem: Problem, u: Array) -> Array:
    """log(value/limit) for each limit, or log(limit/value) for a lower one: not above 0 where the limit is kept."""
    limits, contact = problem.limits, problem.contact
    k, log_stiffness = problem.material(u)
    found = []
    for depth, lowest, highest in limits.modulus or ():
        modulus = log_stiffness + k * np.log(depth)
        found += [modulus - np.log(highest), np.log(lowest) - modulus]
    if contact.depth is not None:
        return np.array(found)
    log_radius = log_contact_radius(contact, k, log_stiffness)
    if limits.edge_pressure is not None and limits.distance is not None:
        pressure = edge_pressure(limits.distance / np.exp(log_radius), k, amplitudes(problem)).max()
        unit = np.log(contact.normal_force / np.pi) - 2 * log_radius
        found.append(np.log(pressure) + unit - np.log(limits.edge_pressure))
    if limits.contact_radius is not None:
        lowest, highest = limits.contact_radius
        found += [] if lowest is None else [np.log(lowest) - log_radius]
        found += [] if highest is None else [log_radius - np.log(highest)]
    if limits.penetration is not None:
        depth = np.log(penetration(k, amplitudes(problem)).max() / contact.radius) + 2 * log_radius
        found.append(depth - np.log(limits.penetration))
    return np.array(found, float)


# --- the searches ---------------------------------------------------------------------------------------------------

BRENT, LBFGS, SLSQP, TRUST = METHODS = "bounded Brent", "L-BFGS-B", "SLSQP", "trust-constr"
OPTIONS: dict[str, dict[str, Any]] = {
    BRENT: {"xatol": 1e-10},  # the default stops 1e-5 from a bound, where many an optimum lies
    LBFGS: {},
    SLSQP: {"maxiter": 500, "ftol": 1e-12},
    # By default it stops at the first barrier that it has solved well enough, 1e-5 to 1e-3 above the optimum.
    TRUST: {"gtol": 0.0, "xtol": 1e-10, "barrier_tol": 1e-10},
}
FEASIBLE = 1e-12  # of the logarithms: what rounding leaves of a limit that is met exactly


class Found(NamedTuple):
    """Where a search ended."""

    u: Array
    value: float
    violation: float  # the largest logarithm by which a limit or a bound is missed, 0 where all are kept
    success: bool  # as the method says
    seconds: float

    @property
    def feasible(self) -> bool:
        return self.violation <= FEASIBLE


def at(problem: Problem, u: Array, success: bool = True, seconds: float = 0.0) -> Found:
    """The variables `u` and what they are worth."""
    beyond = np.max(np.maximum(-u, u - 1.0), initial=0.0)
    missed = limited(problem, u).max(initial=0.0)
    return Found(u, objective(problem, u), float(max(0.0, beyond, missed)), success, seconds)


def at_material(problem: Problem, E0: float, z0: float, k: float) -> Found:
    """What a material of these constants is worth."""
    u = []
    for name, (lower, upper) in problem.vary.items():
        x = {"E0": E0, "z0": z0, "k": k}[name]
        u.append((x - lower) / (upper - lower) if name == "k" else np.log(x / lower) / np.log(upper / lower))
    return at(problem, np.array(u))


def suitable(problem: Problem) -> tuple[str, ...]:
    """The methods that one would take."""
    if problem.limited:
        return SLSQP, TRUST
    return (BRENT,) if problem.size == 1 else (LBFGS,)


def search(problem: Problem, method: str, start: Array, between: Span = (0.0, 1.0), sharp: bool = False) -> Found:
    """One search by one method, of the scaled objective; `sharp`: by central differences, as far as it goes."""
    scale = abs(objective(problem, np.full(problem.size, 0.5)))

    def scaled(u: Any) -> float:
        return objective(problem, np.atleast_1d(u)) / scale

    begin = time.perf_counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            found = _minimised(problem, method, scaled, start, between, sharp)
        except ValueError:  # that is how trust-constr ends where a step of its own is not a number
            return at(problem, start, success=False, seconds=time.perf_counter() - begin)
    seconds = time.perf_counter() - begin
    return at(problem, np.clip(np.atleast_1d(found.x), 0.0, 1.0), bool(found.success), seconds)


def _minimised(
    problem: Problem, method: str, scaled: Callable[..., float], start: Array, between: Span, sharp: bool
) -> Any:
    options = OPTIONS[method] | ({"ftol": 1e-16} if sharp else {})
    if method == BRENT:
        return optimize.minimize_scalar(scaled, bounds=between, method="bounded", options=options)
    given: dict[str, Any] = {"jac": "3-point" if sharp else "2-point"}
    given["bounds"] = optimize.Bounds(np.zeros(problem.size), np.ones(problem.size), keep_feasible=True)
    if problem.limited:
        given["constraints"] = optimize.NonlinearConstraint(lambda u: limited(problem, u), -np.inf, 0.0)
    return optimize.minimize(scaled, start, method=method, options=options, **given)


def alone(problem: Problem) -> dict[str, Found]:
    """What each suitable method finds from the middle of the box."""
    return {method: search(problem, method, np.full(problem.size, 0.5)) for method in suitable(problem)}


def best(problem: Problem, starts: int = 20, seed: int = 0) -> Found:
    """The best that keeps the limits, of several methods from many starts each.

    Brent's starts are so many parts of the interval, and its two ends; the other methods start at random points, and
    the best of them all are searched once more by SLSQP with central differences. Where that misses a limit by a
    little, it is pulled back inside, straight towards a point that keeps them all.
    """
    if suitable(problem) == (BRENT,):
        edges = np.linspace(0.0, 1.0, starts + 1)
        found = [search(problem, BRENT, edges[:1], (a, b)) for a, b in itertools.pairwise(edges.tolist())]
        return min([*found, *(at(problem, end) for end in (edges[:1], edges[-1:]))], key=lambda one: one.value)
    begin = np.random.default_rng(seed).uniform(0.0, 1.0, (starts, problem.size))
    methods = (SLSQP, TRUST) if problem.limited else (LBFGS, SLSQP)
    found = [search(problem, method, start) for method in methods for start in begin]
    nearest = sorted((one for one in found if one.violation < 1e-3), key=lambda one: one.value)[:3]
    found += [search(problem, SLSQP, one.u, sharp=True) for one in nearest]
    return _best_inside(problem, [one for one in found if np.isfinite(one.value)])


def _best_inside(problem: Problem, found: list[Found]) -> Found:
    inside = [one for one in found if one.feasible]
    if not inside:
        return min(found, key=lambda one: one.violation)
    lowest = min(inside, key=lambda one: one.value)
    if problem.limited:
        deepest = min(inside, key=lambda one: limited(problem, one.u).max())
        outside = (one for one in found if FEASIBLE < one.violation < 1e-3 and one.value < lowest.value)
        inside += [at(problem, _pulled_inside(problem, one.u, deepest.u)) for one in outside]
    return min(inside, key=lambda one: one.value)


def _pulled_inside(problem: Problem, outside: Array, inside: Array) -> Array:
    """The point nearest to `outside` on the way to `inside` that keeps the limits."""
    low, high = 0.0, 1.0
    for _ in range(60):
        share = 0.5 * (low + high)
        kept = limited(problem, outside + share * (inside - outside)).max() <= FEASIBLE
        low, high = (low, share) if kept else (share, high)
    return outside + high * (inside - outside)


# --- the best exponent, amplitude by amplitude ----------------------------------------------------------------------


def volume_by_root(k: float, phi: float) -> float:
    """The reduced form: `brentq` for the edge of the ring, and the closed volume, one incomplete beta function each."""
    s, q = (1 + k) / 2, (1 - k) / 2
    m, sine = phi / ((1 - phi) * (1 + s)), np.sin(np.pi * s) / np.pi

    def excess(y: float) -> float:
        return s * y - q - m + sine * y**q / special.betainc(q, s, y / (1 + y))

    y = optimize.brentq(excess, (1 + q) * m, m / s, rtol=1e-10)
    Q, power, load = special.betainc(q, s, y / (1 + y)), sine * y**q, (m + q) / s
    braces = (load * (1 + y) + (1 - y * y) / 2) * Q - power * ((load + 0.5) / q + y / (2 * s))
    return np.pi / 2 * (1 - phi) ** (2 / (1 + s)) * braces


def brent_by_amplitude(amplitudes: Array, bounds: Span, scan: int = 0) -> tuple[Array, Array]:
    """(k, volume): bounded Brent for one amplitude after the other; beside the lowest point of a scan, where one is."""
    exponents, volumes = np.empty(amplitudes.size), np.empty(amplitudes.size)
    grid = np.linspace(*bounds, scan).tolist()
    for n, phi in enumerate(amplitudes.tolist()):
        between = bounds
        if scan:
            lowest = int(np.argmin([volume_by_root(k, phi) for k in grid]))
            between = grid[max(lowest - 1, 0)], grid[min(lowest + 1, scan - 1)]
        found = optimize.minimize_scalar(volume_by_root, args=(phi,), bounds=between, method="bounded")
        exponents[n], volumes[n] = found.x, found.fun
    return exponents, volumes
