"""The exponent that wears least and the critical amplitudes, from the paper alone.

Every root is a change of sign of 60-digit numbers, seen on both sides of it. That there are no others is a matter of
scanning: dV/dk is positive for small amplitudes and close to gross slip, and negative in between.
"""

import random
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing import get_context

import oracle
from mpmath import mp, mpf
from oracle import Number

DIGITS = 60  # of what changes its sign
ROOT_DIGITS = 50  # of where it does so
STEP_DIGITS = 40  # a difference step is 10^-40 of the distance to the nearest edge of the domain
NEAR = mpf(10) ** -30  # so near to -1 and 1 the limits are evaluated, which are analytic: off by as much


def slope(k: Number, phi: Number) -> mpf:
    """dV/dk of Eq. (28), by a central difference."""
    with mp.workdps(2 * DIGITS):
        k, phi = mp.convert(k), mp.convert(phi)
        near = min(1 - abs(k), phi, 1 - phi)
    lost = 3 * max(0, -int(mp.log10(near)))
    with mp.workdps(DIGITS + STEP_DIGITS + oracle.GUARD_DIGITS + lost):
        step = (1 - abs(k)) * mpf(10) ** -STEP_DIGITS
        wear_volume = partial(oracle.wear_volume.formula, phi=phi, start=oracle._ring(k, phi))
        return (wear_volume(k + step) - wear_volume(k - step)) / (2 * step)


def difference(lower: Number, upper: Number, phi: Number) -> mpf:
    """V(upper) - V(lower)."""
    with mp.workdps(2 * DIGITS):
        digits = DIGITS - int(mp.log10(mp.convert(upper) - mp.convert(lower)))
    with mp.workdps(digits):
        return oracle.wear_volume(upper, phi, digits=digits) - oracle.wear_volume(lower, phi, digits=digits)


def root(f: Callable[[mpf], mpf], low: Number, high: Number) -> mpf:
    """Where f changes its sign between two points: by Illinois' secants, proved by its signs a unit to either side."""
    with mp.workdps(DIGITS):
        behind, here, unit = mp.convert(low), mp.convert(high), mpf(10) ** -ROOT_DIGITS
        at_behind, at_here, step = f(behind), f(here), here - behind
        if not at_behind * at_here < 0:
            raise ArithmeticError(f"no change of sign between {low} and {high}")
        while at_here and abs(step) > unit / 10:
            step = at_here * (here - behind) / (at_here - at_behind)
            there = here - step
            at_there = f(there)
            if at_there * at_here > 0:
                at_behind /= 2
            else:
                behind, at_behind = here, at_here
            here, at_here = there, at_there
        if not f(here - unit) * f(here + unit) < 0:
            raise ArithmeticError(f"no change of sign at {here}")
        return here


def best_exponent(phi: Number, bounds: tuple[Number, Number] = (-0.95, 0.95)) -> mpf:
    """The k of the least V between the bounds: the root of dV/dk if it rises through zero there, or the better end."""
    lower, upper = map(mp.convert, bounds)
    if slope(lower, phi) < 0 < slope(upper, phi):
        return root(lambda k: slope(k, phi), lower, upper)
    return lower if difference(lower, upper, phi) > 0 else upper


def critical_amplitudes(bounds: tuple[Number, Number] = (-1, 1)) -> tuple[mpf, mpf, mpf]:
    """The amplitudes at which dV/dk = 0 at the lower and at the upper bound, and at which both wear alike again."""
    with mp.workdps(2 * DIGITS):
        lower, upper = (min(max(mp.convert(k), NEAR - 1), 1 - NEAR) for k in bounds)
    return (
        root(lambda phi: slope(lower, phi), 0.05, 0.4),
        root(lambda phi: slope(upper, phi), 0.05, 0.4),
        root(lambda phi: difference(lower, upper, phi), 0.97, 0.998),
    )


# ------------------------------------------------------------------------------------------- the limits k -> -1 and 1


def limits() -> tuple[mpf, mpf, mpf]:
    """`critical_amplitudes` of the bounds -1 and 1 from the limits of Eqs. (26) and (28), written out.

    V = pi c^4/2 int_0^y (Q/s) (m - G(v)) dv with Q = sin(pi s)/pi int_0^v w^-s/(1+w) dw, c^4 = (1-phi)^(2/(1+s)),
    m = phi/((1-phi)(1+s)) and G = s v - (1-s) + v^(1-s)/int_0^v w^-s/(1+w) dw, which is m at the edge y, Eq. (26).
    V is stationary in y. At s = 0 and to first order in q = 1 - s

        Q/s = log(1+v) - s J(v),    J = int_0^v log(w)/(1+w) dw        Q/s = 1 + q - q log(1+1/v)
        G = v/log(1+v) - 1 + s (v + 1 - v (log v - J/log(1+v))/log(1+v))       G = v - q v
    """
    with mp.workdps(DIGITS):
        return (
            root(_slope_at_lower_end, 0.05, 0.4),
            root(_slope_at_upper_end, 0.05, 0.4),
            root(lambda phi: mp.pi / 16 * phi**2 / (1 - phi) - _wear_volume_at_lower_end(phi), 0.97, 0.998),
        )


def _edge_at_lower_end(M: mpf) -> mpf:
    """y = M log(1+y), M = 1/(1-phi) > 1, by the other branch of Lambert's function."""
    return -M * mp.lambertw(-mp.exp(-1 / M) / M, -1).real - 1


def _wear_volume_at_lower_end(phi: mpf) -> mpf:
    M = 1 / (1 - phi)
    y = _edge_at_lower_end(M)
    return mp.pi / (2 * M**2) * (M * ((1 + y) * mp.log1p(y) - y) - y**2 / 2)


def _slope_at_lower_end(phi: mpf) -> mpf:
    """2/(pi c^4) dV/ds: the terms in J/log(1+v) cancel."""
    M = 1 / (1 - phi)
    y = _edge_at_lower_end(M)
    log_y, log_1y = mp.log(y), mp.log1p(y)
    J = log_y * log_1y + mp.polylog(2, -y).real
    area_log = (1 + y) * log_1y - y  # int_0^y log(1+v) dv, and so on
    area_J = (1 + y) * J - y * log_y + y
    moment_log = (y**2 - 1) / 2 * log_1y - y**2 / 4 + y / 2
    moment_log_v = y**2 / 2 * log_y - y**2 / 4
    return 2 * mp.log(M) * (M * area_log - y**2 / 2) - M * area_J - M * area_log - moment_log + moment_log_v


def _slope_at_upper_end(phi: mpf) -> mpf:
    """-2/(pi c^4) dV/dq, with y = m = phi/(2 (1-phi))."""
    m = phi / (2 * (1 - phi))
    # int_0^m (m - v) log(1+1/v) dv
    logarithms = (1 + m) ** 2 / 2 * mp.log1p(m) - m**2 / 2 * mp.log(m) - m / 2
    return logarithms - m**2 / 4 * mp.log(1 - phi) - 3 * m**2 / 2


# ------------------------------------------------------------------------------------------------------ many amplitudes


def interior_amplitudes(count: int, seed: int, bounds: tuple[Number, Number]) -> list[float]:
    """Random amplitudes with the best exponent between the bounds, numbers that float32 holds too."""
    leaves, reaches, _ = critical_amplitudes(bounds)
    generator = random.Random(seed)
    return [round(generator.uniform(float(leaves) + 1e-4, float(reaches) - 1e-4) * 2**22) / 2**22 for _ in range(count)]


def best_exponents(amplitudes: Sequence[float], bounds: tuple[Number, Number]) -> list[mpf]:
    """`best_exponent` at many amplitudes, in two processes where they take more than a few seconds."""
    work = partial(best_exponent, bounds=bounds)
    if len(amplitudes) < 30:
        return [work(phi) for phi in amplitudes]
    with get_context("spawn").Pool(2) as pool:
        return pool.map(work, amplitudes, chunksize=8)
