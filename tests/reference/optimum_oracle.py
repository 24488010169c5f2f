"""The exponent that wears least and the critical amplitudes, from the paper alone.

Every root is a change of sign of 60-digit numbers, seen on both sides of it. That there are no others is a matter of
scanning: dV/dk is positive for small amplitudes and close to gross slip, and negative in between.
"""

import functools

import oracle
from mpmath import mp, mpf

DIGITS = 60  # of what changes its sign
ROOT_DIGITS = 50  # of where it does so
STEP_DIGITS = 40  # a difference step is 10^-40 of the distance to the nearest edge of the domain
NEAR = mpf(10) ** -30  # so near to -1 and 1 the limits are evaluated, which are analytic: off by as much


def slope(k, phi):
    """dV/dk of Eq. (28), by a central difference."""
    with mp.workdps(2 * DIGITS):
        k, phi = mp.convert(k), mp.convert(phi)
        near = min(1 - abs(k), phi, 1 - phi)
    lost = 3 * max(0, -int(mp.log10(near)))
    with mp.workdps(DIGITS + STEP_DIGITS + oracle.GUARD_DIGITS + lost):
        step = (1 - abs(k)) * mpf(10) ** -STEP_DIGITS
        wear_volume = functools.partial(oracle.wear_volume.formula, phi=phi, start=oracle._ring(k, phi))
        return (wear_volume(k + step) - wear_volume(k - step)) / (2 * step)


def difference(lower, upper, phi):
    """V(upper) - V(lower)."""
    with mp.workdps(2 * DIGITS):
        digits = DIGITS - int(mp.log10(mp.convert(upper) - mp.convert(lower)))
    with mp.workdps(digits):
        return oracle.wear_volume(upper, phi, digits=digits) - oracle.wear_volume(lower, phi, digits=digits)


def root(f, low, high):
    """Where f changes its sign between two points, proved by its signs a unit to either side."""
    with mp.workdps(DIGITS):
        ends, unit = (mp.convert(low), mp.convert(high)), mpf(10) ** -ROOT_DIGITS
        here = mp.findroot(f, ends, solver="anderson", tol=abs(f(ends[0])) * unit / 1000, verify=False)
        if not f(here - unit) * f(here + unit) < 0:
            raise ArithmeticError(f"no change of sign at {here}")
        return here


@functools.cache
def critical_amplitudes(bounds=(-1, 1)):
    """The amplitudes at which dV/dk = 0 at the lower and at the upper bound, and at which both wear alike again."""
    with mp.workdps(2 * DIGITS):
        lower, upper = (min(max(mp.convert(k), NEAR - 1), 1 - NEAR) for k in bounds)
    return (
        root(lambda phi: slope(lower, phi), 0.05, 0.4),
        root(lambda phi: slope(upper, phi), 0.05, 0.4),
        root(lambda phi: difference(lower, upper, phi), 0.97, 0.998),
    )
