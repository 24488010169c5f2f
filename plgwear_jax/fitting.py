"""What measured wear tells: how likely it is with a contact and a wear law, and the wear coefficient that fits it best.

The fit is by least squares. SciPy is imported when a fit is made.
"""

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import NOT_NEGATIVE, NUMBER, POSITIVE, ArrayLike, check, concrete_only, record, static
from plgwear_jax._core.doubts import doubt, of_contact, own_numbers
from plgwear_jax.contact.fretting_contact import FrettingContact, check_fretting_contact
from plgwear_jax.loads import Block, Load, load_of
from plgwear_jax.steady.arguments import refuse_array
from plgwear_jax.wear import Run
from plgwear_jax.wear.marched import MarchedRun
from plgwear_jax.wear_laws import WearLaw, law_of

__all__ = ["Fit", "Measurements", "fit_wear_coefficient", "log_likelihood"]

_MEASURABLE = "volume", "contact_radius", "depth"  # of a `Run`
_LEVEL = 0.95  # of confidence
_STEADY = 0.95  # share of the final volume above which small errors of the model decide on the coefficient
_EXCESS = 1.05  # measured over final volume above which the model cannot explain the volume
_GRID = 96  # points of the curve for a picture
_DENSE = 512  # wear coefficients of which a fit to one amplitude reads the volumes from its run, twice
_TRIED = 256  # wear coefficients between which a fit looks for the best one
_NODES = 17  # wear coefficients of which a fit to blocks computes the runs, twice
_LITTLE = 1e-20  # Archard's K in 1/Pa with which hardly anything wears


# --- measurements -----------------------------------------------------------------------------------------------------


@record
class Measurements:
    """What was measured in a test after numbers of cycles, with normally distributed errors.

    Attributes:
        load: A force amplitude F_x in N, 0 < F_x < mu F_N, or another load of `FrettingContact.over_cycles`: a
            `Displacement`, also beyond the transition to gross slip, or a list of `Block`.
        cycles: Numbers of cycles, shape (n,), >= 0.
        measured: What was measured after them in SI units, shape (n,), >= 0.
        deviation: Standard deviation of each, positive, a number or shape (n,); in SI units or relative.
        r: The radius in m at which a depth was measured, >= 0; None for others.
        what: What was measured: the worn "volume" in m^3, the "contact_radius" in m, of the scar, or the worn "depth"
            in m at r.
        relative: The deviations are shares of what was measured, which is then positive.

    Raises:
        ValueError: A concrete number is outside its range, or the shapes do not fit together.
    """

    ranges: ClassVar = {"cycles": NUMBER, "deviation": POSITIVE, "r": NOT_NEGATIVE}

    load: Any
    cycles: Any
    measured: Any
    deviation: Any
    r: ArrayLike | None = None
    what: str = static(default="volume")
    relative: bool = static(default=False)

    def __post_init__(self) -> None:
        if self.what not in _MEASURABLE:
            raise ValueError(f"what = {self.what!r}: must be one of {', '.join(_MEASURABLE)}")
        if (self.r is None) == (self.what == "depth"):
            raise ValueError("r: a depth is measured at a radius r in m, and nothing else is")
        load = load_of(self.load)
        object.__setattr__(self, "load", load)
        shapes = {np.shape(stage.load.control(1.0)[-1]) for stage in load.stages()}
        if shapes != {()}:
            raise ValueError(f"load takes one amplitude or a list of Block, not an array of {max(shapes)}")
        check(self.what, self.measured, POSITIVE if self.relative else NUMBER)
        shape = np.shape(self.measured)
        if len(shape) != 1 or np.shape(self.cycles) != shape:
            raise ValueError(
                f"cycles of shape {np.shape(self.cycles)} and {self.what} of shape {shape}: both must be (n,)"
            )
        if np.shape(self.deviation) not in ((), shape):
            told = f"must be a number or {shape}, as {self.what}"
            raise ValueError(f"deviation of shape {np.shape(self.deviation)}: {told}")

    @property
    def deviations(self) -> Any:
        """The standard deviation of each in SI units, shape (n,)."""
        return self.deviation * self.measured if self.relative else self.deviation + 0.0 * self.measured

    def residuals(self, modelled: Any) -> Any:
        """By how many standard deviations values of a model, shape (n,), are above what was measured."""
        return (modelled - self.measured) / self.deviations


def log_likelihood(
    contact: FrettingContact, law: ArrayLike | WearLaw, data: Measurements, *, digits: int | None = None
) -> Array:
    """The logarithm of the probability density of measurements, if a contact wears by a law.

    A pure function of all numbers of the contact, the law and the measurements, also of their deviation: `grad`,
    `hessian`, `jit` and `vmap` work, and so do samplers, whose programs compile soonest with `compiler_options(1)`. Its
    largest value over K is at the coefficient of `fit_wear_coefficient`.

    Args:
        contact: The contact.
        law: Archard's K in 1/Pa, positive, or a law of `wear_laws`.
        data: The measurements. Those of several tests with the same contact are independent: add what they give.
        digits: Correct digits wanted of the model, see `FrettingContact.over_cycles`; fewer run faster.

    Returns:
        The log-likelihood, a number: the sum of -(z^2 + log(2 pi))/2 - log(sigma) with z = (model - measured)/sigma, so
        that the measured density is one per m^3 or per m.

    Raises:
        ValueError: A concrete number is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> import jax
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, fitting
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> data = fitting.Measurements(2.0, [1e4, 1e5], [1.3e-17, 1.4e-16], deviation=0.1, relative=True)
        >>> by_log_K = jax.grad(lambda log: fitting.log_likelihood(contact, jax.numpy.exp(log), data))
        >>> print(by_log_K(-33.0) > 0.0 > by_log_K(-31.0))  # K = 1e-14 is in between
        True
    """
    places = {"cycles": data.cycles} | ({} if data.r is None else {"r": data.r})
    modelled = getattr(contact.over_cycles(data.load, law, digits=digits), data.what)(**places)
    z = data.residuals(modelled)
    return -jnp.sum(0.5 * z * z + jnp.log(data.deviations) + 0.5 * math.log(2.0 * math.pi))


# --- the fit ----------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Fit:
    """The wear coefficient that fits measured volumes.

    Attributes:
        wear_coefficient: The most likely wear coefficient, Archard's K in 1/Pa, with an exponent in 1/Pa^exponent. If
            the likelihood rises up to an infinite coefficient, it is one that wears all points to the steady state.
        interval: The confidence interval of 95 % of K in the same unit, by the increase of the sum of squares; its
            upper end is infinite if the data do not bound K from above, both are NaN for one point without a deviation.
        cycles: The numbers of cycles of the data, shape (n,).
        volume: The measured volumes in m^3, shape (n,).
        fitted: Volumes of the fit at these cycles in m^3, shape (n,).
        deviation: The standard deviation of each volume in m^3, shape (n,): as given, or the scatter about the fit.
        steady_volume: Final worn volume in m^3, which does not depend on the coefficient; None in gross slip and for
            blocks.
        doubt: What the data do not determine, or a reason to doubt the fit, in a line; None if there is none.
        curve_cycles: Numbers of cycles for a picture, shape (m,).
        curve: Volumes in m^3 at these cycles by the fit and by both ends of its interval, shape (3, m).
    """

    wear_coefficient: float
    interval: tuple[float, float]
    cycles: np.ndarray
    volume: np.ndarray
    fitted: np.ndarray
    deviation: np.ndarray
    steady_volume: float | None
    doubt: str | None
    curve_cycles: np.ndarray
    curve: np.ndarray


def _by_log(curve: Any, cycles: np.ndarray, logs: np.ndarray, known: Any = None) -> Any:
    """Volumes at the cycles of the data by log(K), a cubic between those at some log(K) and those that are known.

    Args:
        curve: Volumes with coefficients of shape (c, 1) at cycles of shape (n,); both broadcast.
        cycles: Numbers of cycles, shape (n,).
        logs: Some log(K), rising.
        known: Such a cubic, whose points stay.
    """
    from scipy.interpolate import PchipInterpolator

    volumes = curve(np.exp(logs)[:, None], cycles)
    # The largest coefficients may wear more than a run follows.
    followed = np.logical_and.accumulate(np.isfinite(volumes).all(axis=-1))
    logs, volumes = logs[followed], volumes[followed]
    if known is not None:
        logs, places = np.unique(np.append(known.x, logs), return_index=True)
        volumes = np.append(known(known.x), volumes, axis=0)[places]
    return PchipInterpolator(logs, volumes)


@concrete_only("contact.over_cycles(load, law).volume(cycles) works there")
def fit_wear_coefficient(
    contact: FrettingContact,
    load: "ArrayLike | Load | Sequence[Block]",
    cycles: ArrayLike,
    volume: ArrayLike,
    deviation: ArrayLike | None = None,
    *,
    relative: bool = False,
    exponent: float = 1.0,
) -> Fit:
    """Fit the wear coefficient to volumes that were measured in a test.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact; its fields are numbers.
        load: A force amplitude F_x in N, 0 < F_x < mu F_N, or another load of `FrettingContact.over_cycles`: a
            `Displacement`, also beyond the transition to gross slip, or a list of `Block`.
        cycles: Numbers of cycles, shape (n,), >= 0, at least one of them > 0.
        volume: The volumes worn by then in m^3, shape (n,), >= 0, not all zero.
        deviation: Their standard deviations in m^3, positive, a number or shape (n,); if not given they are taken as
            equal, and estimated from the scatter.
        relative: The deviations are shares of the volumes, which are then positive after any cycles.
        exponent: Exponent of the pressure in the wear law; the coefficient is then in 1/Pa^exponent.

    Returns:
        The coefficient with its confidence interval, from Student's distribution without deviations.

    Raises:
        ValueError: An argument is outside its range, or there is nothing to fit.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.2, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> from plgwear_jax.fitting import fit_wear_coefficient
        >>> cycles = [1e5, 2e5, 5e5]
        >>> volume = contact.over_cycles(2.0, 1e-14).volume(cycles)
        >>> print(f"{fit_wear_coefficient(contact, 2.0, cycles, volume).wear_coefficient:.2e}")  # 1/Pa
        1.00e-14

    References:
        Archard, Journal of Applied Physics 24 (1953) 981; `docs/explanation/numerics.md`, "Wear over cycles".
    """
    from scipy import special

    check_fretting_contact(contact)
    refuse_array(contact)
    doubt(*of_contact(contact))
    with own_numbers():  # wear coefficients with which it searches
        check("exponent", exponent, POSITIVE)
        if relative and deviation is None:
            raise ValueError("relative: says that deviations are shares of the volumes, and needs deviation")
        held = Measurements(load, cycles, volume, 1.0 if deviation is None else deviation).load
        cycles, volume = (np.asarray(x, float) for x in (cycles, volume))
        worn = cycles > 0.0
        N, target = cycles[worn], volume[worn]
        if not np.any(target > 0.0):
            raise ValueError("volume: nothing is worn after any cycles, so that no wear coefficient can be told")
        if relative and not np.all(target > 0.0):
            raise ValueError(f"volume = 0 after {N[target <= 0.0][0]:g} cycles: has no relative deviation")
        deviations = np.asarray(target.max() if deviation is None else deviation, float)
        deviations = deviations * (volume if relative else np.ones_like(volume))

        def run_with(coefficient: Any) -> Run:
            return contact.over_cycles(held, law_of(coefficient, exponent))

        run = final = None
        if held.lasts:
            # The time scales with the coefficient: one run tells all volumes up to its end, or up to a tenth of it
            # where it has no state at its last time.
            run = run_with(1.0)
            last = float(run.lasting_cycles) * (1.0 if isinstance(run, MarchedRun) else 0.1)
            logs = np.linspace(math.log(1e-12 * last / N.max()), math.log(last / N.min()), _DENSE)
            final, little = run.final and float(run.final.volume), run.volume(last)
        else:
            last, least = math.inf, _LITTLE * float(contact.steady(0.0).peak_initial_pressure) ** (1.0 - exponent)
            little = np.max(run_with(least).volume(N))
            # from the coefficient without any change of the contact by its wear; if nothing wears, it does not count
            slow = least * target.max() / float(little or 1.0)
            logs = np.log(np.geomspace(1e-2 * slow, 1e5 * slow, _NODES))
        if little == 0.0:
            raise ValueError("load: wears nothing, so that no wear coefficient can be told")

        def curve(coefficient: np.ndarray, cycles: np.ndarray) -> np.ndarray:
            if run is not None:
                volumes = np.asarray(run.volume(np.fmin(coefficient * cycles, last)))
                return np.where(np.isnan(coefficient), math.nan, volumes)
            wears = POSITIVE.contains(coefficient)
            found = np.asarray(run_with(np.where(wears, coefficient, 1.0)[:, 0]).volume(cycles[:, None])).T
            return np.where(wears, found, np.where(coefficient == 0.0, 0.0, math.nan))

        def misfit(log: float) -> float:
            return float(np.sum(((model(log) - target) / deviations[worn]) ** 2))

        model = _by_log(curve, N, logs)
        most, first = model(model.x).max(axis=0), model(model.x)[:, N.argmin()]
        # From hardly any wear to all of it, also at the first point.
        ends = logs[0], np.interp(first.max() * (1.0 if final is None else 1.0 - 1e-6), first, model.x)
        model = _by_log(curve, N, _least_of(misfit, ends) + np.linspace(-0.5, 0.5, logs.size), model)
        best = _least_of(misfit, ends)
        tried = np.linspace(*ends, _TRIED)
        least, freedom, fitted = misfit(best), N.size - 1, np.zeros_like(volume)
        fitted[worn] = model(best)
        scatter = math.sqrt(least / freedom) if freedom else math.nan
        # The sum of squares rises up to the ends of the interval by the squared quantile of Student's t, or of the
        # normal distribution if the deviations are known.
        within = 0.5 + 0.5 * _LEVEL
        quantile = special.ndtri(within) if deviation is not None else scatter * special.stdtrit(freedom, within)
        rise = float(quantile) ** 2
        low, high = (_exceeded_at(lambda log: misfit(log) - least - rise, best, some) for some in (tried[::-1], tried))
        said = None
        if relative and (largest := np.asarray(deviation, float).max()) > 1.0:
            said = f"a deviation of {largest:g} times the volume: in percent? it is a share, such as 0.05"
        elif math.isnan(rise):
            low = high = math.nan
            said = "one point and one unknown: without its deviation there is no interval"
        elif low == -math.inf:
            said = "the scatter is too large: the data do not tell the wear coefficient"
        elif high == math.inf and final is None:
            said = "the data do not bound the wear coefficient from above"
        elif final is not None and (high == math.inf or fitted[worn].min() > _STEADY * final):
            beyond = f"all points lie beyond {100.0 * fitted[worn].min() / final:.0f} % of the steady state"
            said = f"{beyond}: they give little more than a lower bound of the coefficient"
        elif high - low > math.log(100.0):
            said = "the scatter is too large: the data hardly tell the wear coefficient"
        elif deviation is not None and freedom and special.chdtrc(freedom, least) < 0.01:
            said = f"the points scatter {scatter:.2g} times as much about the curve as their deviations say"
        if final is not None:
            ratio = target.max() / final
            if min(ratio, np.mean(target / np.maximum(fitted[worn], 1e-300))) > _EXCESS:
                more = f"up to {ratio:.3g} times the volume of the steady state is measured"
                said = f"{more}: the amplitude is larger than given, or the contact slips as a whole"
        elif np.any(target > _EXCESS * most):
            said = "more is measured than any wear coefficient explains: the test is not the one that is given"
        lasting = math.inf if held.lasts else sum(float(stage.cycles) for stage in held.stages())
        curve_cycles = np.geomspace(0.5 * N.min(), min(2.0 * N.max(), lasting), _GRID)
        return Fit(
            wear_coefficient=math.exp(best),
            interval=(math.exp(low), math.exp(high)),
            cycles=cycles,
            volume=volume,
            fitted=fitted,
            deviation=scatter * deviations if deviation is None else deviations,
            steady_volume=final,
            doubt=said,
            curve_cycles=curve_cycles,
            curve=curve(np.exp([[best], [low], [high]]), curve_cycles),
        )


def _least_of(misfit: Callable[[float], float], ends: tuple[float, float]) -> float:
    """Where the misfit is least; points early and late in a test can each have a minimum."""
    from scipy import optimize

    tried, found = np.linspace(*ends, _TRIED), []
    falls = np.diff([misfit(log) for log in tried]) < 0.0
    for place in np.flatnonzero(np.append(True, falls) & ~np.append(falls, False)):
        middle = tried[place]
        beside = (tried[max(place - 1, 0) : place + 2] - middle)[[0, -1]]
        found.append(float(middle + optimize.fminbound(lambda x, at=middle: misfit(at + x), *beside, xtol=1e-10)))
    return min(found, key=misfit)


def _exceeded_at(excess: Callable[[float], float], best: float, tried: np.ndarray) -> float:
    """Where the excess becomes positive between the best and the last place of some; infinite if it does not."""
    from scipy import optimize

    outwards = tried[-1] - tried[0]
    beyond = next((log for log in tried if (log - best) * outwards > 0.0 and excess(log) > 0.0), None)
    return outwards * math.inf if beyond is None else float(optimize.brentq(excess, best, beyond, xtol=1e-6))
