"""Print the power series that `plgwear_jax/special/gamma.py` holds as constants; needs mpmath.

Both functions are entire, so their Taylor coefficients fall faster than any power and a table serves every argument.
"""

import mpmath as mp

TINY = mp.mpf("1e-19")


def series(function, centre, half_width) -> list[float]:
    """Taylor coefficients in (x - centre)/half_width, until n^2 times the rest no longer matters in float64."""
    with mp.workdps(60):
        scaled = [c * mp.mpf(half_width) ** n for n, c in enumerate(mp.taylor(function, mp.mpf(centre), 48))]
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


if __name__ == "__main__":
    for table in (reciprocal_gamma, volume_numerator):
        print(f"_{table.__name__.upper()} = (")
        for coefficient in table():
            print(f"    {coefficient!r},")
        print(")")
