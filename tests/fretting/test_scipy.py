"""The paper's equations as printed, in SciPy, beside the library; and where the two part, who is right.

The first part compares them at points that are easy for both. Its tolerances are what SciPy's side can deliver: about
five times the largest difference over thousands of such points. The second part lists points where SciPy or
jax.scipy are wrong, or where the printed form of an equation cancels; there mpmath decides.
"""

import re
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.scipy.special
import numpy as np
import oracle
import pytest
from functions import fretting, gross_slip, material
from scipy import integrate, optimize, special

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded

# --- the paper ------------------------------------------------------------------------------------------------------


def scipy_beta(t, p, q):
    """B(t; p, q) of Eq. (15)."""
    return special.betainc(p, q, t) * special.beta(p, q)


def outside_flat_punch(r, k, hyp2f1=special.hyp2f1):
    """Eq. (3), r > 1."""
    s = (1 + k) / 2
    return np.cos(k * np.pi / 2) / np.pi * 2 / (1 + k) * (1 / r) ** (1 + k) * hyp2f1(s, s, (3 + k) / 2, 1 / r**2)


def under_worn_punch(r, k, hyp2f1=special.hyp2f1):
    """Eq. (5), r <= 1."""
    return hyp2f1((k - 1) / 2, (1 + k) / 2, 1.0, r**2)


def beside_worn_punch(r, k, hyp2f1=special.hyp2f1):
    """Eq. (5), r > 1."""
    return (1 - k) / 2 * (1 / r) ** (1 + k) * hyp2f1((1 + k) / 2, (1 + k) / 2, 2.0, 1 / r**2)


def volume_change(k, hyp2f1=special.hyp2f1):
    """Eq. (7)."""
    return 1 - hyp2f1((k - 1) / 2, (1 + k) / 2, 2.0, 1.0)


def force_ratio(k):
    """Eq. (10)."""
    return np.pi * (1 - k) * (1 + k) / (4 * np.cos(k * np.pi / 2))


def beside_parabola(r, k, beta=scipy_beta):
    """Eq. (14), r > 1."""
    t = 1 / r**2
    bracket = beta(t, (1 + k) / 2, (1 - k) / 2) - r**2 * beta(t, (3 + k) / 2, (1 - k) / 2)
    return np.cos(k * np.pi / 2) / ((k + 1) * np.pi) * bracket


def stick_radius(k, phi):
    """Eq. (16)."""
    return (1 - phi) ** (1 / (k + 3))


def beside_worn_parabola(r, k, phi, beta=scipy_beta):
    """Eq. (24), r >= c."""
    c, cos = stick_radius(k, phi), np.cos(k * np.pi / 2) / np.pi
    t = c**2 / r**2
    first = cos * c**2 / (k + 3) * (1 + 2 / (k + 1) / c ** (k + 3)) * beta(t, (1 + k) / 2, (1 - k) / 2)
    return first - cos * r**2 / (k + 1) * beta(t, (3 + k) / 2, (1 - k) / 2)


def wear_depth(r, k, phi, beta=scipy_beta):
    """f_0(c) + w_inf(c) - w_inf(r) - f_0(r): the difference of the sides of Eq. (26), and the integrand of (28)."""
    c = stick_radius(k, phi)
    return c**2 / 2 + beside_worn_parabola(c, k, phi, beta) - beside_worn_parabola(r, k, phi, beta) - r**2 / 2


def worn_radius(k, phi):
    """Eq. (26)."""
    inner, outer = 1.0, 1.0 + phi  # the ring reaches beyond the initial contact
    while wear_depth(outer, k, phi) > 0:
        inner, outer = outer, 2 * outer
    return optimize.brentq(wear_depth, inner, outer, args=(k, phi), xtol=1e-300, rtol=8.9e-16)


def wear_volume(k, phi):
    """Eq. (28)."""

    def integrand(r):
        return wear_depth(r, k, phi) * 2 * np.pi * r

    edges = stick_radius(k, phi), worn_radius(k, phi)
    return integrate.quad(integrand, *edges, epsabs=0, epsrel=1e-13, limit=200, full_output=1)[0]


def h_N(k, nu):
    """Eqs. (29)-(31)."""
    gamma = special.gamma
    beta = np.sqrt((1 + k) * (1 - k * nu / (1 - nu)))
    C = 2 ** (1 + k) * gamma((3 + k + beta) / 2) * gamma((3 + k - beta) / 2) / (np.pi * gamma(2 + k))
    above = 2 * (1 + k) * np.cos(k * np.pi / 2) * gamma(1 + k / 2)
    return above / (np.sqrt(np.pi) * C * beta * np.sin(beta * np.pi / 2) * gamma((1 + k) / 2))


# --- agreement ------------------------------------------------------------------------------------------------------

COUNT = 500


def sample(*names):
    """COUNT points: k in (-0.95, 0.95), phi in (0.01, 0.99), nu in (-0.9, 0.5), radii by their place."""
    rng = np.random.default_rng(20240229)
    k, phi, nu = rng.uniform(-0.95, 0.95, COUNT), rng.uniform(0.01, 0.99, COUNT), rng.uniform(-0.9, 0.5, COUNT)
    beyond = 1 + 10 ** rng.uniform(-3, 1.5, COUNT)
    within = rng.uniform(0, 0.999, COUNT)
    c = stick_radius(k, phi)
    drawn = {"k": k, "phi": phi, "nu": nu, "beyond": beyond, "within": within}
    drawn |= {"beyond c": c * beyond, "within c": c * within}
    return [drawn[name] for name in names]


def flat_pressure(r, k):
    """Eq. (2) over the mean of Eq. (8): (1+k)/2 (1-r^2)^((k-1)/2)."""
    return (1 + k) / 2 / (1 - r**2) ** ((1 - k) / 2)


def parabola_pressure(r, k):
    """Eq. (13)."""
    return (k + 3) / 2 * (1 - r**2) ** ((1 + k) / 2)


def worn_traction(r, k, phi):
    """Eq. (19)."""
    b = stick_radius(k, phi)
    return (k + 1) * phi / (2 * b**2) * (1 - (r / b) ** 2) ** ((k - 1) / 2)


def worn_pressure(r, k, phi):
    """Eq. (17) with F_1 = F_N b^(k+3)."""
    b = stick_radius(k, phi)
    return (k + 3) * b ** (k + 3) / (2 * b**2) * (1 - (r / b) ** 2) ** ((1 + k) / 2) + (k + 1) * (1 - b ** (k + 3)) / (
        2 * b**2
    ) * (1 - (r / b) ** 2) ** ((k - 1) / 2)


AGREEMENT = {
    # equation: printed, library, where, relative tolerance
    "2": (flat_pressure, gross_slip.initial_pressure, ("within", "k"), 5e-14),
    "3": (outside_flat_punch, gross_slip.initial_displacement, ("beyond", "k"), 3e-13),
    "5 within": (under_worn_punch, gross_slip.steady_displacement, ("within", "k"), 3e-13),
    "5 beyond": (beside_worn_punch, gross_slip.steady_displacement, ("beyond", "k"), 3e-13),
    "7": (volume_change, gross_slip.volume_change, ("k",), 1.5e-13),
    "10": (force_ratio, gross_slip.force_ratio, ("k",), 1e-14),
    "13": (parabola_pressure, fretting.initial_pressure, ("within", "k"), 5e-14),
    "14": (beside_parabola, fretting.initial_displacement, ("beyond", "k"), 1e-13),
    "16": (stick_radius, fretting.stick_radius, ("k", "phi"), 2e-15),
    "17": (worn_pressure, fretting.steady_pressure, ("within c", "k", "phi"), 5e-13),
    "19": (worn_traction, fretting.steady_traction, ("within c", "k", "phi"), 5e-13),
    "24": (beside_worn_parabola, fretting.steady_displacement, ("beyond c", "k", "phi"), 1e-13),
    "29": (h_N, material.h_N, ("k", "nu"), 1.5e-14),
}


@pytest.mark.parametrize("equation", AGREEMENT)
def test_library_agrees_with_the_printed_equation(equation):
    printed, library, where, tolerance = AGREEMENT[equation]
    point = sample(*where)
    np.testing.assert_allclose(library(*point), printed(*point), rtol=tolerance)


def test_displacement_agrees_with_equation_18_in_SI_units():
    """Eq. (18) with its two parts, F_1 from Eq. (12) for the radius b."""
    E0, z0, R, F_N, mu, nu = 110e9, 3e-5, 5e-3, 20.0, 0.3, 0.25
    k, phi, beyond = sample("k", "phi", "beyond")
    contact = FrettingContact(PowerLawGraded(E0=E0, z0=z0, k=k, nu=nu), radius=R, normal_force=F_N, friction=mu)
    b = np.asarray(contact.steady(phi * mu * F_N).stick_radius)
    r = b * beyond
    F_1 = 4 * h_N(k, nu) * E0 * b ** (k + 3) / ((1 - nu**2) * z0**k * (k + 1) ** 2 * (k + 3) * R)
    cos, t = np.cos(k * np.pi / 2), b**2 / r**2
    beta_1, beta_3 = scipy_beta(t, (1 + k) / 2, (1 - k) / 2), scipy_beta(t, (3 + k) / 2, (1 - k) / 2)
    tip = b**2 * cos / ((k + 1) * np.pi * R) * (beta_1 - r**2 / b**2 * beta_3)
    shift = cos * (1 - nu**2) * (1 + k) * z0**k * (F_N - F_1) / (2 * np.pi * h_N(k, nu) * E0 * b ** (1 + k)) * beta_1
    displacement = contact.steady(phi * mu * F_N).steady_displacement(r)
    # F_N - F_1 = phi F_N cancels: 1e-16/phi of the shift, with phi > 0.01
    np.testing.assert_allclose(displacement, tip + shift, rtol=3e-13)


def test_pressure_agrees_with_equation_2_in_SI_units():
    """Eq. (2) lacks a factor a on its right side: without it the two sides differ by a length, and so from (8)."""
    E0, z0, a, d, nu = 110e9, 3e-5, 2e-3, 1e-6, 0.25
    k, within = sample("k", "within")
    contact = GrossSlipContact(PowerLawGraded(E0=E0, z0=z0, k=k, nu=nu), radius=a, depth=d)
    r = a * within
    right = a * h_N(k, nu) / (2 * (1 - nu**2) * z0**k * (a**2 - r**2) ** ((1 - k) / 2))
    np.testing.assert_allclose(contact.steady().initial_pressure(r) * np.pi * a / (2 * E0 * d), right, rtol=3e-13)


K, PHI = (column[:24].tolist() for column in sample("k", "phi"))
RINGS = [pytest.param(k, phi, id=f"k={k:.3f}-phi={phi:.3f}") for k, phi in zip(K, PHI, strict=True)]


@pytest.mark.parametrize("k, phi", RINGS)
def test_worn_radius_agrees_with_the_root_of_equation_26(k, phi):
    assert float(fretting.worn_radius(k, phi)) == pytest.approx(worn_radius(k, phi), rel=1e-13)


@pytest.mark.parametrize("k, phi", RINGS)
def test_wear_depth_agrees_with_equation_25(k, phi):
    """The printed form subtracts heights of the size of the penetration, so that is what its error scales with."""
    c, a = stick_radius(k, phi), worn_radius(k, phi)
    r = c + (a - c) * np.linspace(0.01, 0.99, 21)
    scale = float(fretting.penetration(k, phi))
    np.testing.assert_allclose(fretting.wear_depth(r, k, phi), wear_depth(r, k, phi), rtol=0, atol=1e-14 * scale)


@pytest.mark.parametrize("k, phi", RINGS)
def test_wear_volume_agrees_with_the_quadrature_of_equation_28(k, phi):
    """As for the depth: its error times the area of the ring, besides what quad is asked for."""
    ring = np.pi * (worn_radius(k, phi) ** 2 - stick_radius(k, phi) ** 2)
    noise = 1.5e-15 * float(fretting.penetration(k, phi)) * ring
    assert float(fretting.wear_volume(k, phi)) == pytest.approx(wear_volume(k, phi), rel=1e-13, abs=noise)


# --- disagreement ---------------------------------------------------------------------------------------------------

RIGHT = 1e-13
WRONG = 100 * RIGHT

JAX_HAS_2F1 = hasattr(jax.scipy.special, "hyp2f1")  # not in its oldest version that the library supports
jax_hyp2f1 = jax.jit(jax.scipy.special.hyp2f1) if JAX_HAS_2F1 else None
jax_betainc = jax.jit(jax.scipy.special.betainc)


def jax_beta(t, p, q):
    return jax_betainc(p, q, t) * jax.scipy.special.beta(p, q)


class Case(NamedTuple):
    """One quantity at one point; `error` is what the other one was seen to be off by, to one digit."""

    other: Callable
    library: Callable
    truth: Callable
    point: tuple[float, ...]
    error: float


def with_jax(printed, function):
    return lambda *point: printed(*point, function)


UNDER = (gross_slip.steady_displacement, oracle.gross_steady_displacement)
FLAT = (gross_slip.initial_displacement, oracle.gross_initial_displacement)
VOLUME = (gross_slip.volume_change, oracle.volume_change)
PARABOLA = (fretting.initial_displacement, oracle.initial_displacement)
DISAGREEMENT = {
    # SciPy's 2F1 where c-a-b is nearly an integer: 1-k in both lines of (5); see also the last test
    "(5) SciPy, k = 1.5e-13, under the edge": Case(under_worn_punch, *UNDER, (1 - 1e-4, 1.5e-13), 1e-6),
    "(5) SciPy, k = -1.5e-13, beside the edge": Case(beside_worn_punch, *UNDER, (1 + 1e-4, -1.5e-13), 1e-7),
    "(5) SciPy, k = 1e-12, under the edge": Case(under_worn_punch, *UNDER, (1 - 1e-4, 1e-12), 4e-8),
    "(5) SciPy, k = 1e-12, beside the edge": Case(beside_worn_punch, *UNDER, (1 + 1e-4, 1e-12), 1e-7),
    "(5) SciPy, k = -1e-10, under the edge": Case(under_worn_punch, *UNDER, (1 - 1e-4, -1e-10), 2e-9),
    # the argument 1/r^2 is rounded, which forgets the distance to the edge
    "(3) SciPy, k = 0.9, at the edge": Case(outside_flat_punch, *FLAT, (1 + 1e-9, 0.9), 4e-11),
    "(3) SciPy, k = 0.999, at the edge": Case(outside_flat_punch, *FLAT, (1 + 1e-9, 0.999), 8e-11),
    # jax.scipy's 2F1 gives up its series
    "(5) jax.scipy, k = 0.01, under the edge": Case(
        with_jax(under_worn_punch, jax_hyp2f1), *UNDER, (0.999, 0.01), 3e-4
    ),
    "(5) jax.scipy, k = 0.4, under the edge": Case(with_jax(under_worn_punch, jax_hyp2f1), *UNDER, (0.999, 0.4), 4e-3),
    "(5) jax.scipy, k = 0.8, beside the edge": Case(
        with_jax(beside_worn_punch, jax_hyp2f1), *UNDER, (1.001, 0.8), 4e-2
    ),
    "(3) jax.scipy, k = -0.5, beside the edge": Case(
        with_jax(outside_flat_punch, jax_hyp2f1), *FLAT, (1.001, -0.5), 4e-4
    ),
    "(3) jax.scipy, k = 0, beside the edge": Case(with_jax(outside_flat_punch, jax_hyp2f1), *FLAT, (1.001, 0.0), 5e-3),
    "(3) jax.scipy, k = 0.9, beside the edge": Case(
        with_jax(outside_flat_punch, jax_hyp2f1), *FLAT, (1.001, 0.9), 7e-2
    ),
    # (7) is 1 minus a number that tends to 1
    "(7) SciPy, k -> 1": Case(volume_change, *VOLUME, (1 - 1e-6,), 5e-10),
    "(7) SciPy, k -> -1": Case(volume_change, *VOLUME, (-1 + 1e-6,), 7e-10),
    "(7) SciPy, k = 1 - 1e-9": Case(volume_change, *VOLUME, (1 - 1e-9,), 1e-7),
    "(7) jax.scipy, k -> 1": Case(with_jax(volume_change, jax_hyp2f1), *VOLUME, (1 - 1e-6,), 1e-9),
    "(7) jax.scipy, k -> -1": Case(with_jax(volume_change, jax_hyp2f1), *VOLUME, (-1 + 1e-6,), 1e-9),
    # cos(k pi/2) near its zeros
    "(10) k = 1 - 1e-9": Case(force_ratio, gross_slip.force_ratio, oracle.force_ratio, (1 - 1e-9,), 1e-7),
    "(10) k = -1 + 1e-9": Case(force_ratio, gross_slip.force_ratio, oracle.force_ratio, (-1 + 1e-9,), 1e-7),
    "(29) SciPy, k = -1 + 1e-9": Case(h_N, material.h_N, oracle.h_N, (-1 + 1e-9, 0.3), 1e-7),
    "(29) SciPy, k = 1 - 1e-9": Case(h_N, material.h_N, oracle.h_N, (1 - 1e-9, 0.3), 1e-7),
    # jax.scipy's beta function loses digits for small arguments
    "(14) jax.scipy, k = 1 - 1e-5": Case(with_jax(beside_parabola, jax_beta), *PARABOLA, (1.1, 1 - 1e-5), 3e-10),
    # a narrow ring: its depth is a small difference of heights, its volume an even smaller one
    "(26) SciPy, k = -0.5, phi = 1e-8": Case(
        worn_radius, fretting.worn_radius, oracle.worn_radius, (-0.5, 1e-8), 4e-10
    ),
    "(28) SciPy, k = -0.5, phi = 1e-6": Case(wear_volume, fretting.wear_volume, oracle.wear_volume, (-0.5, 1e-6), 5e-5),
    "(28) SciPy, k = 0, phi = 1e-6": Case(wear_volume, fretting.wear_volume, oracle.wear_volume, (0.0, 1e-6), 3e-5),
    "(28) SciPy, k = 0.5, phi = 1e-6": Case(wear_volume, fretting.wear_volume, oracle.wear_volume, (0.5, 1e-6), 4e-8),
    "(28) SciPy, k = -0.5, phi = 1e-3": Case(
        wear_volume, fretting.wear_volume, oracle.wear_volume, (-0.5, 1e-3), 2e-10
    ),
}


def error(value, truth):
    """Relative, at the truth's precision; infinite where the value is not a number."""
    value = float(value)
    return float(abs(oracle.mpf(value) - truth) / abs(truth)) if np.isfinite(value) else np.inf


CASES = {name: case for name, case in DISAGREEMENT.items() if JAX_HAS_2F1 or not re.match(r"\([357]\) jax", name)}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_library_is_right_where_the_other_is_not(case):
    truth = case.truth(*case.point)
    assert error(case.library(*case.point), truth) <= RIGHT
    assert error(case.other(*case.point), truth) > WRONG, f"was off by {case.error:.0e}; this entry may go"


@pytest.mark.parametrize("k", [1e-13, -1e-13, 1e-14, -1e-14])
@pytest.mark.parametrize("r", [1 - 1e-4, 1 - 1e-6, 1 + 1e-6, 1 + 1e-4])
def test_worn_punch_is_right_where_a_version_of_scipy_is_infinite(r, k):
    """SciPy 1.17.1 is, for 1e-15 <= |k| <= 1e-13; 1.11.3 is right there, and off by 1e-6 from 1.5e-13 on."""
    assert error(gross_slip.steady_displacement(r, k), oracle.gross_steady_displacement(r, k)) <= 1e-14
