"""The wear coefficient from measured volumes, by least squares with the exact derivative of the wear over cycles.

SciPy is imported when a fit is made.
"""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, Domain, check
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax.contact import FrettingContact
from plgwear_jax.contact.engines import run_of
from plgwear_jax.steady.arguments import NUMBER

__all__ = ["Fit", "fit_wear_coefficient"]

_VOLUME = Domain(">= 0 and finite", lambda volume: (volume >= 0.0) & (volume < float("inf")))
_LEVEL = 0.95  # of confidence
_STEADY = 0.95  # share of the final volume above which small errors of the model decide on the coefficient
_EXCESS = 1.05  # measured over final volume above which the model cannot explain the volume
_GRID = 96  # points of the curve for a picture
_DENSE = 1024  # points between which the model interpolates


@dataclasses.dataclass(frozen=True)
class Fit:
    """The wear coefficient that fits measured volumes.

    Attributes:
        wear_coefficient: The most likely wear coefficient, Archard's K in 1/Pa.
        interval: The confidence interval of 95 % of K in 1/Pa, by the increase of the sum of squares; its upper end is
            infinite if the data do not bound K from above, both are NaN for one point without a deviation.
        cycles: The numbers of cycles of the data, shape (n,).
        volume: The measured volumes in m^3, shape (n,).
        fitted: Volumes of the fit at these cycles in m^3, shape (n,).
        deviation: The standard deviation of each volume in m^3, shape (n,): as given, or the scatter about the fit.
        steady_volume: Final worn volume in m^3, which does not depend on the coefficient.
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
    steady_volume: float
    doubt: str | None
    curve_cycles: np.ndarray
    curve: np.ndarray


class _Model:
    """The worn volume over the final volume, and its slope by log(x), where x = K N with K in 1/Pa and N cycles.

    A fit needs many x of one contact. One run gives values and slopes at points so dense that cubics between them have
    errors below 1e-8 of the volume, under force control.
    """

    def __init__(self, contact: FrettingContact, tangential_force: ArrayLike, **control: Any):
        from scipy.interpolate import CubicHermiteSpline

        run = run_of(contact, tangential_force, 1.0, **control)
        self.grid = float(run.lasting_cycles) * np.geomspace(1e-12, 0.1, _DENSE)
        volume, rate = np.asarray(run.volume(self.grid)), np.asarray(run.rate(self.grid))
        self.final = float(volume[-1])
        self.shares, slopes = volume / volume[-1], self.grid * rate / volume[-1]
        self.share = CubicHermiteSpline(np.log(self.grid), self.shares, slopes)
        self.slope = self.share.derivative()

    def __call__(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # Before the first point the volume grows with x, after the last one not at all.
        at, early = np.log(np.clip(x, self.grid[0], self.grid[-1])), np.minimum(x / self.grid[0], 1.0)
        return early * self.share(at), np.where(x < self.grid[-1], early * self.slope(at), 0.0)

    def inverse(self, share: float | np.ndarray) -> np.ndarray:
        """The approximate x at which a share of the final volume is worn."""
        return np.exp(np.interp(share, self.shares, np.log(self.grid)))


@for_numbers("contact.wear_volume(F_x, cycles=..., wear_coefficient=...) works there")
def fit_wear_coefficient(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    cycles: ArrayLike,
    volume: ArrayLike,
    deviation: ArrayLike | None = None,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> Fit:
    """Fit the wear coefficient to volumes that were measured at a constant amplitude of the force or displacement.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact; its fields are numbers.
        tangential_force: The force amplitude F_x in N, 0 < F_x < mu F_N.
        cycles: Numbers of cycles, shape (n,), >= 0, at least one of them > 0.
        volume: The volumes worn by then in m^3, shape (n,), >= 0, not all zero.
        deviation: Their standard deviations in m^3, positive, shape (n,); if not given they are taken as equal, and
            estimated from the scatter.
        control: Which amplitude the rig held constant, see `FrettingContact.wear_volume`. For "displacement" F_x is the
            force amplitude before any wear, and the steady volume is the final one of the run.
        rig_stiffness: Stiffness in N/m of the rig, if the displacement was measured at its actuator.

    Returns:
        The coefficient with its confidence interval, from Student's distribution without deviations.

    Raises:
        ValueError: An argument is outside its range, or there is nothing to fit.
    """
    from scipy import optimize, special

    check("cycles", cycles, NUMBER)
    check("volume", volume, _VOLUME)
    check("tangential_force", tangential_force, POSITIVE)
    cycles, volume = np.asarray(cycles, float), np.asarray(volume, float)
    if cycles.ndim != 1 or cycles.shape != volume.shape:
        raise ValueError(f"cycles of shape {cycles.shape} and volume of shape {volume.shape}: both must be (n,)")
    worn = cycles > 0.0
    if not np.any(volume[worn] > 0.0):
        raise ValueError("volume: nothing is worn after any cycles, so that no wear coefficient can be told")
    if deviation is not None:
        check("deviation", deviation, POSITIVE)
        deviation = np.broadcast_to(np.asarray(deviation, float), volume.shape)

    model = _Model(contact, tangential_force, control=control, rig_stiffness=rig_stiffness)
    steady = float(contact.wear_volume(tangential_force)) if control == "force" else model.final
    N, target = cycles[worn], volume[worn] / steady
    sigma = np.ones_like(target) if deviation is None else deviation[worn] / steady

    # log(K) between hardly any wear at the last point and the steady state at the first point.
    ends = math.log(model.grid[0] / N.max()), math.log(float(model.inverse(1.0 - 1e-6)) / N.min())
    guesses = np.log(model.inverse(np.clip(target, 1e-5, 0.99)) / N)
    start = float(np.clip(np.median(guesses), ends[0] + 1e-6, ends[1] - 1e-6))

    def residuals(x: np.ndarray) -> np.ndarray:
        return (model(np.exp(x) * N)[0] - target) / sigma

    def slopes(x: np.ndarray) -> np.ndarray:
        return (model(np.exp(x) * N)[1] / sigma)[:, None]

    found = optimize.least_squares(residuals, [start], slopes, bounds=([ends[0]], [ends[1]]), xtol=1e-10, ftol=1e-12)
    best, freedom = float(found.x[0]), N.size - 1
    share = model(math.exp(best) * N)[0]
    scatter = math.sqrt(2.0 * found.cost / freedom) if freedom else math.nan
    # The sum of squares rises up to the ends of the interval by the squared quantile of Student's t, or of the normal
    # distribution if the deviations are known.
    if deviation is not None:
        rise = float(special.ndtri(0.5 + 0.5 * _LEVEL)) ** 2
    else:
        rise = (scatter * float(special.stdtrit(freedom, 0.5 + 0.5 * _LEVEL))) ** 2 if freedom else math.nan

    def excess(x: float) -> float:
        return float(np.sum(residuals(np.array([x])) ** 2)) - 2.0 * found.cost - rise

    low, high = (math.nan, math.nan) if math.isnan(rise) else (_crossing(excess, best, end) for end in ends)
    doubt = None
    if math.isnan(rise):
        doubt = "one point and one unknown: without its deviation the data tell no interval"
    elif low == -math.inf:
        doubt = "the scatter is too large: the data do not tell the wear coefficient"
    elif high == math.inf or share.min() > _STEADY:
        doubt = (
            f"all points lie beyond {share.min():.0%} of the steady state: they tell little but the least coefficient"
        )
    elif high - low > math.log(100.0):
        doubt = "the scatter is too large: the data hardly tell the wear coefficient"
    elif deviation is not None and freedom and special.chdtrc(freedom, 2.0 * found.cost) < 0.01:
        doubt = f"the points scatter {scatter:.2g} times as much about the curve as their deviations say"
    if target.max() > _EXCESS and np.mean(target / np.maximum(share, 1e-300)) > _EXCESS:
        more = f"up to {target.max():.3g} times the volume of the steady state is measured"
        doubt = f"{more}: the amplitude is larger than given, or the contact slips as a whole"
    if high == math.inf and low > -math.inf:
        best = low
    interval = math.exp(low), math.exp(high)
    curve_cycles = np.geomspace(0.5 * cycles[worn].min(), 2.0 * cycles.max(), _GRID)
    return Fit(
        wear_coefficient=math.exp(best),
        interval=interval,
        cycles=cycles,
        volume=volume,
        fitted=steady * np.where(worn, model(np.exp(best) * cycles)[0], 0.0),
        deviation=np.full_like(volume, scatter * steady) if deviation is None else deviation,
        steady_volume=steady,
        doubt=doubt,
        curve_cycles=curve_cycles,
        curve=steady * np.stack([_curve(model, K * curve_cycles) for K in (math.exp(best), *interval)]),
    )


def _crossing(excess: Callable[[float], float], best: float, end: float) -> float:
    """Where the excess becomes positive between the best and an end; infinite if it does not."""
    from scipy import optimize

    step, last = math.copysign(0.01, end - best), best
    while (end - last) * step > 0.0:
        there = min(last + step, end) if step > 0.0 else max(last + step, end)
        if excess(there) > 0.0:
            return float(optimize.brentq(excess, last, there, xtol=1e-6)) if excess(last) < 0.0 else last
        last, step = there, 2.0 * step
    return math.copysign(math.inf, step)


def _curve(model: _Model, x: np.ndarray) -> np.ndarray:
    if not np.all(np.isfinite(x)):
        return np.full_like(x, math.nan if np.any(np.isnan(x)) else 1.0)
    return model(x)[0]
