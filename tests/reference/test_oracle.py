"""The oracle against quadrature, higher precision, other formulas and the limits that are known."""

import itertools

import accuracy
import numpy as np
import oracle
import pytest
from marks import long_case, parametrize
from mpmath import mp, mpf

EXPONENTS = (-1 + 1e-9, -0.5, -1e-14, 0.0, 1e-14, 0.3, 1 - 1e-9)
AMPLITUDES = (1e-12, 0.3, 1 - 1e-12)


@pytest.fixture(autouse=True)
def working_precision():
    with mp.workdps(60):
        yield


def same(x, y, digits, scale=0):
    """x = y to `digits` digits of y, or of `scale` where y may vanish."""
    return abs(x - y) <= mpf(10) ** -digits * max(abs(y), scale)


@parametrize("quantity", accuracy.QUANTITIES, ids=lambda quantity: f"{quantity.name}-{quantity.regions[0]}")
def test_values_do_not_change_with_precision(quantity, seed):
    f = oracle.QUANTITIES[quantity.oracle]
    for region in quantity.regions:
        for point in zip(*quantity.sampler(np.random.default_rng(seed), 12, region), strict=True):
            x, y = f(*point), f(*point, digits=90)
            assert same(x, y, 49), (point, x, y)


@parametrize(
    "name, point",
    [
        ("wear_volume", (-0.5, 0.9)),
        ("steady_displacement", (1.25, 0.3, 0.4)),
        ("deepest_wear", (-0.3, 0.4)),
        ("edge_pressure", (0.01, 0.3, 0.4)),
        ("wear_volume_in_si", (1e11, 1e-4, 0.3, 0.25, 5e-3, 10.0, 0.4, 2.0)),
        ("h_N", (0.25, 0.3)),
    ],
)
def test_derivatives_agree_with_mpmath(name, point):
    formula = oracle.QUANTITIES[name].formula
    found = oracle.derivatives(name, point, order=2)
    exact, count = tuple(mpf(x) for x in point), len(point)
    unit = [tuple(int(i == j) for j in range(count)) for i in range(count)]
    k = oracle.QUANTITIES[name].names.index("k")
    with mp.workdps(40):
        for i, slope in enumerate(found.gradient):
            assert same(slope, mp.diff(formula, exact, unit[i]), 25)
            for j in range(i + 1):
                assert found.hessian[i][j] == found.hessian[j][i]
                if count > 3 and i != j and k not in (i, j):
                    continue  # in SI units these are powers; seconds
                both = tuple(a + b for a, b in zip(unit[i], unit[j], strict=True))
                assert same(found.hessian[i][j], mp.diff(formula, exact, both), 25, scale=mpf("0.01"))


def test_quantities_are_their_parts():
    for at in itertools.product(EXPONENTS, AMPLITUDES):
        with mp.workdps(120):
            c = oracle.stick_radius(*at, digits=120)
            assert same(oracle.edge_pressure(c / 3, *at), oracle.steady_pressure(2 * c / 3, *at), 48)
        assert oracle.edge_pressure(0, *at) == mp.inf
        assert oracle.edge_pressure(2, *at) == oracle.steady_pressure(0, *at)
    hertz = mp.cbrt(3 * mpf(10) * mpf(5e-3) * (1 - mpf(0.25) ** 2) / (4 * mpf(1e11)))
    assert same(oracle.contact_radius(1e11, 1e-4, 0, 0.25, 5e-3, 10), hertz, 48)
    assert oracle.worn_radius(0.3, 0) == 1 and oracle.wear_volume(0.3, 0) == oracle.deepest_wear(0.3, 0) == 0


@parametrize("k, phi", list(itertools.product(EXPONENTS, (*AMPLITUDES, 0.8))))
def test_no_radius_is_worn_deeper_than_the_deepest(k, phi):
    """The depth falls by the square of a relative step of 1e-9 in y on either side, and no other root is there."""
    with mp.workdps(120):
        c, y = oracle.stick_radius(k, phi, digits=120), oracle._deepest(mpf(k), mpf(phi))
        deepest = oracle.deepest_wear(k, phi, digits=120)

        def lack(y):
            return 1 - oracle.wear_depth(c * mp.sqrt(1 + y), k, phi, digits=120) / deepest

        for side in (-1, 1):
            assert 0 < lack(y * (1 + side * mpf("1e-9"))) < mpf("1e-18")
        steps = [lack(y * mpf(10) ** (mpf(n) / 4)) for n in range(-8, 9)]
        assert steps[8] == 0 and steps[:9] == sorted(steps[:9], reverse=True) and steps[8:] == sorted(steps[8:])


@parametrize("k", [-0.7, long_case(0), 0.4])  # 0 has closed forms
@parametrize("r", [1.01, 1.5, 20])
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
    assert same(oracle.gross_initial_displacement(r, k), ratio((1, s - 1)), 20)
    assert same(oracle.gross_steady_displacement(r, k), ratio((1, mpf(0))), 20)
    assert same(oracle.initial_displacement(r, k) * (k + 1), ratio((1, s)), 20)
    assert same(oracle.steady_displacement(c * r, k, phi) / oracle.penetration(k, phi), ratio(*steady), 20)
