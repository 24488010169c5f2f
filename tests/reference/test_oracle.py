"""What the oracle says of displacements, against the Green's function alone.

Its numbers are those of the library, which shares no code with it, in `test_accuracy`, and its equations fit each other
in `test_figures`.
"""

import oracle
from marks import long_case, parametrize
from mpmath import mp, mpf


def same(x, y):
    """To 20 digits."""
    return abs(x - y) <= mpf("1e-20") * abs(y)


@parametrize("k", [-0.7, long_case(0), 0.4])  # 0 has closed forms
@parametrize("r", [1.01, 1.5, 20])
@mp.workdps(60)
def test_displacements_are_those_of_the_pressures(k, r):
    """w(r)/w(0) from the Green's function of the half-space, distance^-(1+k), without Eqs. (3), (5), (14), (24).

    A pressure x^n, x = 1 - q^2, on the unit disc gives B(n+1, 1-s) at the centre, s = (1+k)/2, and outside the
    integral over rings, each 2F1(s, s; 1; q^2/r^2)/r^(2s), here over v = x^(n+1).
    """
    k, r, phi = mpf(k), mpf(r), mpf("0.6")
    s = (1 + k) / 2

    def disc(n):
        with mp.workdps(30):
            return mp.quad(lambda v: mp.hyp2f1(s, s, 1, (1 - v ** (1 / (n + 1))) / r**2), [0, 1]) / (n + 1)

    def ratio(*terms):
        outside = sum(a * disc(n) for a, n in terms) / r ** (2 * s)
        return outside / sum(a * mp.beta(n + 1, 1 - s) for a, n in terms)

    c = oracle.stick_radius(k, phi)
    steady = ((k + 3) * (1 - phi) / (2 * c**2), s), (oracle.edge_intensity(k, phi), s - 1)
    assert same(oracle.gross_initial_displacement(r, k), ratio((1, s - 1)))
    assert same(oracle.gross_steady_displacement(r, k), ratio((1, mpf(0))))
    assert same(oracle.initial_displacement(r, k) * (k + 1), ratio((1, s)))
    assert same(oracle.steady_displacement(c * r, k, phi) / oracle.penetration(k, phi), ratio(*steady))
