"""Print the power series that `plgwear_jax/special/gamma.py` holds as constants; needs mpmath.

The functions have no poles near the interval, so their Taylor coefficients fall fast and one table is enough.
"""

import textwrap

import mpmath as mp

INDENT = "    "
TINY = mp.mpf("1e-19")


def series(function, centre, half_width, terms=48) -> list[float]:
    """Taylor coefficients in (x - centre)/half_width, until n^2 times the rest no longer matters in float64."""
    with mp.workdps(60):
        scaled = [c * mp.mpf(half_width) ** n for n, c in enumerate(mp.taylor(function, mp.mpf(centre), terms))]
        last = max(n for n, c in enumerate(scaled) if n * n * abs(c) > TINY)
        return [float(c) for c in scaled[: last + 1]]


def reciprocal_gamma() -> list[float]:
    """1/Gamma(1+z) about z = 3/4, for z in [-1/2, 2]."""
    return series(lambda z: mp.rgamma(1 + z), "0.75", "1.25")


def volume_numerator() -> list[float]:
    """((1+q)/Gamma(1+2q) - 1/Gamma(1+q)^2)/(q (1-q)) about q = 1/2, for q in [0, 1]."""
    return series(
        lambda q: ((1 + q) * mp.rgamma(1 + 2 * q) - mp.rgamma(1 + q) ** 2) / (q * (1 - q)),
        "0.5",
        "0.5",
    )


def edge_value(h):
    """2^-q Gamma(1+2q)/Gamma(1+q)^2 at q = 1/2 - h, without its poles at abs(h) = 1, 2, 3."""
    q = mp.mpf("0.5") - h
    poles = [1 - (h / m) ** 2 for m in (1, 2, 3)]
    return mp.fprod(poles) * mp.gamma(1 + 2 * q) * mp.rgamma(1 + q) ** 2 / 2**q


def edge_even() -> list[float]:
    """The part of `edge_value` that is even in h, about h^2 = 1/8, for h^2 in [0, 1/4]."""

    def even(square):
        h = mp.sqrt(square)
        return (edge_value(h) + edge_value(-h)) / 2

    return series(even, "0.125", "0.125", terms=16)


def edge_odd() -> list[float]:
    """The part that is odd, over h (1/4 - h^2), about h^2 = 1/8."""

    def odd(square):
        h = mp.sqrt(square)
        return (edge_value(h) - edge_value(-h)) / (2 * h * (mp.mpf("0.25") - square))

    return series(odd, "0.125", "0.125", terms=16)


if __name__ == "__main__":
    for table in (reciprocal_gamma, volume_numerator, edge_even, edge_odd):
        numbers = textwrap.fill(" ".join(map(repr, table())), 118, initial_indent=INDENT, subsequent_indent=INDENT)
        print(f'_{table.__name__.upper()} = _numbers_in("""\n{numbers}\n""")')
