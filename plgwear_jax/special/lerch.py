"""The alternating Lerch series, the only series of the fretting problem, as a continued fraction.

    Phi(x; a) = sum over n >= 0 of (-1)^n x^n/(n + a) = 1/(a + a^2 x/T),      T = 1 + a + x U,

    U = 1/(2 + a + (1+a)^2 x/(3 + a + 2^2 x/(4 + a + (2+a)^2 x/(5 + a + 3^2 x/(6 + a + ...

for x >= 0 and a >= 0. All its terms are positive, so neither the fraction nor its derivatives lose digits. Each level
reduces the error by the factor (sqrt(1+x) + 1)/(sqrt(1+x) - 1), for any a.
"""

import math
from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
from jax import Array
from jax.typing import DTypeLike

from .elementary import with_digits, working_digits


def fold_at(dtype: DTypeLike) -> float:
    """The largest x at which the fraction is used; for larger x callers use 1/x.

    The forms for 1/x lose digits, but fewer if this x is larger. In float32 no digit may be lost, so its x is larger;
    in float64 a larger x would need more levels of the fraction.
    """
    return 2.0 if jnp.finfo(dtype).bits == 32 else 1.5


@with_digits
def lerch_tail(x: Array, a: Array, digits: int | None) -> tuple[Array, Array]:
    """(numerator, denominator) of U, both positive and neither large nor small."""
    fold = fold_at(x.dtype)
    # As many levels below the first as keep the error below the last digit wanted, for x up to the fold. The first one
    # and the estimated start below the last one together give a digit and a half.
    root = math.sqrt(1.0 + fold)
    gain = 1.05 * math.log10((root + 1.0) / (root - 1.0))
    last = 1 + max(1, math.ceil((working_digits(digits, x.dtype) - 1.6) / gain))
    size = 1.0 / _fraction(1.0, 0.5, last, fold)[1]
    numerator, denominator = _fraction(x, a, last, fold)
    return size * numerator, size * denominator


def _fraction(x: Any, a: Any, last: int, fold: float) -> tuple[Any, Any]:
    # The denominators satisfy N_j = (j + a) N_(j+1) + b_j N_(j+2), b_j = (j/2 + a)^2 x or ((j+1)/2)^2 x. Those of odd
    # index are divided by a factorial squared, which saves one product per level and keeps them small.
    scale = [1.0] * (last + 3)
    for j in range(last, 1, -1):
        scale[j] = scale[j + 2] * ((j + 1) // 2) ** 2 if j % 2 else 1.0
    twice, square = 2.0 * a * x, a * a * x

    def level(j: int) -> tuple[Any, Any]:
        ratio = scale[j + 1] / scale[j]
        i = j // 2
        return ratio * a + ratio * j, x if j % 2 else (square + i * twice) + (i * i) * x

    levels = [level(j) for j in range(last, 1, -1)]
    # N_j/N_(j+1) tends to j (1 + sqrt(1+x))/2 for large j. The code takes the chord of this function of x between x = 0
    # and the fold: docs/explanation/theory.md, "The continued fraction".
    beyond = 0.5 * (math.sqrt(1.0 + fold) - 1.0) / fold
    bottom = (last + 1 + a) * (1.0 + beyond * x) * (1.0 / scale[last + 1])
    # The chain of dependent steps is cut into two halves, which a processor computes at the same time.
    half = (len(levels) + 1) // 2
    upper, lower = _descend(levels[:half], bottom, 1.0 / scale[last + 2])
    first, second = _descend(levels[half:], 1.0, 0.0), _descend(levels[half:], 0.0, 1.0)
    denominator = first[0] * upper + second[0] * lower
    numerator = first[1] * upper + second[1] * lower
    return numerator * scale[3], denominator * scale[2]


def _descend(levels: Sequence[tuple[Any, Any]], upper: Any, lower: Any) -> tuple[Any, Any]:
    """(N_j, N_(j+1)) after these levels, from (N_(j+1), N_(j+2)) before them."""
    for a, b in levels:
        upper, lower = b * lower + a * upper, upper
    return upper, lower
