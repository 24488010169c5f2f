"""The two special functions of the problem against the general ones of SciPy and jax.scipy, on one core.

The tail of the arcsine law, y from 1e-3 to 1e3 evenly in log y, s uniform:

    Q(y; s) = I_x(q, s), q = 1 - s, x = y/(1+y)                     by an incomplete beta function
            = sin(pi s)/(pi q) x^q (1-x)^s 2F1(1, 1; 1+q; x)        by a hypergeometric one for y <= 1, where it is
                                                                    fastest and most accurate, and 1 - Q(1/y; q) beyond

The displacement under and beside the uniformly pressed disc, Eq. (5), 0 <= r <= 3, k = 2s - 1:

    2F1(s-1, s; 1; r^2)  for r <= 1,      (1-s) r^(-2s) 2F1(s, s; 2; 1/r^2)  beside

SciPy and jax get one hypergeometric function a point, its arguments chosen by r. Those that take long get the first of
the points. The iteration in jax.scipy ends with the slowest point of a batch, so it takes longer on more points.
"""

from collections.abc import Callable
from typing import Any

import harness
import jax
import jax.numpy as jnp
import jax.scipy.special as jax_special
import mpmath as mp
import numpy as np
import scipy.special as scipy_special
from harness import Compared, Exact, Points, Program, median_ratio

from plgwear_jax import gross_slip
from plgwear_jax.special.arcsine import arcsine_tail, fold

LIBRARY, BETA, HYPER, JAX_BETA, JAX_HYPER = (
    "plgwear",
    "scipy betainc",
    "scipy hyp2f1",
    "jax.scipy betainc",
    "jax.scipy hyp2f1",
)
NAMES = (LIBRARY, f"{LIBRARY} float32", BETA, HYPER, JAX_BETA, JAX_HYPER)
# Points of a program in its turn, where they are not all: about half a second of the slowest.
SUBSETS = {BETA: 100_000, HYPER: 100_000, JAX_BETA: 100_000, JAX_HYPER: 10_000}
QUICK = {BETA: 20_000, HYPER: 20_000, JAX_BETA: 20_000, JAX_HYPER: 1000}


# --- the tail -------------------------------------------------------------------------------------------------------


def tail(y: jax.Array, s: jax.Array) -> jax.Array:
    return arcsine_tail(fold(y), s, 1.0 - s)[0]


def tail_by_beta(y: Any, s: Any, betainc: Callable[..., Any]) -> Any:
    return betainc(1.0 - s, s, y / (1.0 + y))


def tail_by_hypergeometric(y: Any, s: Any, hyp2f1: Callable[..., Any], xp: Any) -> Any:
    near, one = y <= 1.0, xp.ones_like(s)
    x, q = xp.where(near, y, 1.0) / (1.0 + y), xp.where(near, 1.0 - s, s)
    value = xp.sinc(s) * s * x**q * (1.0 - x) ** (1.0 - q) / q * hyp2f1(one, one, 1.0 + q, x)
    return xp.where(near, value, 1.0 - value)


def tail_points(count: int) -> Points:
    rng = harness.generator()
    return 10.0 ** rng.uniform(-3.0, 3.0, count), (1.0 + rng.uniform(-0.97, 0.97, count)) / 2.0


def exact_tail(points: Points) -> Exact:
    def at(y: float, s: float) -> tuple[float, float]:
        x, p = mp.mpf(y) / (1 + mp.mpf(y)), mp.mpf(s)
        return harness.oracle.as_pairs(mp.betainc(1 - p, p, 0, x, regularized=True))

    with mp.workdps(50):
        return [np.array([at(float(y), float(s)) for y, s in zip(*points, strict=True)])[:, None]]


# --- the disc -------------------------------------------------------------------------------------------------------


def disc_by_hypergeometric(r: Any, k: Any, hyp2f1: Callable[..., Any], xp: Any) -> Any:
    s, under = (1.0 + k) / 2.0, r <= 1.0
    outer = xp.where(under, 1.0, r)
    argument = xp.where(under, r, 1.0 / outer) ** 2
    factor = xp.where(under, 1.0, (1.0 - s) * outer ** (-2.0 * s))
    return factor * hyp2f1(xp.where(under, s - 1.0, s), s, xp.where(under, 1.0, 2.0), argument)


def disc_points(count: int) -> Points:
    rng = harness.generator()
    return rng.uniform(0.0, 3.0, count), rng.uniform(-0.97, 0.97, count)


def exact_disc(points: Points) -> Exact:
    pairs = np.stack(points, 1).astype(float).tolist()
    return [np.array(harness.oracle.map_points("gross_steady_displacement", pairs, processes=1))[:, None]]


# --- all of them ----------------------------------------------------------------------------------------------------


def programs(
    library: Callable[..., jax.Array],
    others: dict[str, Callable[..., Any]],
    points: Points,
    exact: Callable[[Points], Exact],
    sample: int,
    subsets: dict[str, int],
) -> dict[str, Program]:
    """The library in both dtypes and the other programs in float64, each with what the oracle says."""
    single = tuple(x.astype(np.float32) for x in points)
    in_double, in_single = exact(harness.head(points, sample)), exact(harness.head(single, sample))
    double = tuple(jnp.asarray(x) for x in points)
    found = {
        LIBRARY: Program(jax.jit(library), double, in_double),
        f"{LIBRARY} float32": Program(jax.jit(library), tuple(jnp.asarray(x) for x in single), in_single),
    }
    for name, function in others.items():
        given = double if name.startswith("jax") else points
        compiled = jax.jit(function) if name.startswith("jax") else function
        found[name] = Program(compiled, tuple(x[: subsets[name]] for x in given), in_double)
    return found


def main(quick: harness.Quick = False, out: harness.Out = harness.DEFAULT_OUT) -> None:
    """Time and error of the arcsine tail and of the disc."""
    count, sample, rounds = (100_000, 64, 3) if quick else (1_000_000, 1000, 15)
    report = harness.Report("kernels", out, "Special functions, one core", quick)
    subsets = QUICK if quick else SUBSETS
    tails = {
        BETA: lambda y, s: tail_by_beta(y, s, scipy_special.betainc),
        HYPER: lambda y, s: tail_by_hypergeometric(y, s, scipy_special.hyp2f1, np),
        JAX_BETA: lambda y, s: tail_by_beta(y, s, jax_special.betainc),
        JAX_HYPER: lambda y, s: tail_by_hypergeometric(y, s, jax_special.hyp2f1, jnp),
    }
    discs = {
        HYPER: lambda r, k: disc_by_hypergeometric(r, k, scipy_special.hyp2f1, np),
        JAX_HYPER: lambda r, k: disc_by_hypergeometric(r, k, jax_special.hyp2f1, jnp),
    }
    found = {
        "arcsine tail": harness.compared(
            programs(tail, tails, tail_points(count), exact_tail, sample, subsets), rounds
        ),
        "disc": harness.compared(
            programs(gross_slip.steady_displacement, discs, disc_points(count), exact_disc, sample, subsets), rounds
        ),
    }
    for title, measured in found.items():
        report.table(
            title,
            ("program", "ns a point", "quartiles", "worst error", "median error", "x plgwear"),
            [_row(name, program, measured[LIBRARY]) for name, program in measured.items()],
        )
    report.print("Errors are relative; inf stands for a result that is no finite number. x: times as long as plgwear.")
    _goals(report, found)
    report.close()


def _row(name: str, program: Compared, library: Compared) -> list[str]:
    errors = f"{program.errors[0]:.1e}", f"{np.median(program.error_at[0]):.1e}"
    times = harness.short(program.timing.median), program.timing.quartiles
    return [name, *times, *errors, harness.short(median_ratio(program.timing, library.timing))]


def _goals(report: harness.Report, found: dict[str, dict[str, Compared]]) -> None:
    def ratio(title: str, slow: str) -> float:
        return median_ratio(found[title][slow].timing, found[title][LIBRARY].timing)

    harness.goals(
        report,
        (
            ("tail, times faster than scipy betainc", 12, ratio("arcsine tail", BETA), True),
            ("tail, times faster than jax.scipy betainc", 100, ratio("arcsine tail", JAX_BETA), True),
            ("disc, times faster than scipy hyp2f1", 10, ratio("disc", HYPER), True),
            ("disc, times faster than jax.scipy hyp2f1", 600, ratio("disc", JAX_HYPER), True),
        ),
    )


if __name__ == "__main__":
    harness.run(main)
