"""The numbers of the paper's text from the library and from the oracle, and whether its equations fit each other.

    python tests/reference/paper_numbers.py    prints both tables in Markdown; to put them between the marks in a page:
    python tests/reference/paper_numbers.py --write docs/reference/hess_numbers.md

The oracle's column and all checks of equations use mpmath and `oracle.py` alone; only the library's column uses it.
"""

import argparse
import functools
import os
from pathlib import Path

import jax
import oracle
from mpmath import mp, mpf

from plgwear_jax.plots import figures

DIGITS = 25
HALF = mpf(1) / 2


# --- numbers --------------------------------------------------------------------------------------------------------


@functools.cache
def from_oracle():
    """The numbers of `figures.NUMBERS`, by name, from Eqs. (1)-(31) as printed."""
    with mp.workdps(DIGITS + 10):
        almost, soft = mpf(1.0 - 1e-9), HALF  # the double, as in the library's column
        best = mp.findroot(slope_of_change, (mpf("0.1"), mpf("0.2")), solver="anderson")
        far, turn = mpf(0.99), mp.findroot(slope_at_zero, (mpf("0.19"), mpf("0.21")), solver="anderson")
        turns = {  # the exponents, and amplitudes on both sides
            "turn_pair": (-soft, soft, "0.1", "0.4"),
            "turn_widest": (-far, far, "0.1", "0.4"),
            "turn_stiff": (-soft, 0, "0.05", "0.4"),
            "turn_stiffest": (-far, 0, "0.05", "0.4"),
            "turn_compliant": (0, soft, "0.1", "0.5"),
        }
        crossings = {"turn": turn} | {name: crossing(oracle.wear_volume, *between) for name, between in turns.items()}
        for again, quantity in {"return": oracle.wear_volume, "rings": oracle.worn_radius}.items():
            for name, ends in {"pair": (-soft, soft), "stiff": (-soft, 0), "compliant": (0, soft)}.items():
                crossings[f"{again}_{name}"] = crossing(quantity, *ends, "0.99", "0.999")
        return {
            "best_k": best,
            "best_change": change(best),
            "change_stiff": change(-soft),
            "change_compliant": change(soft),
            "edge_stiff": oracle.gross_steady_displacement(1, -soft, digits=DIGITS),
            "edge_compliant": oracle.gross_steady_displacement(1, soft, digits=DIGITS),
            "least_ratio": oracle.force_ratio(0, digits=DIGITS),
            "ratio_graded": oracle.force_ratio(soft, digits=DIGITS),
            "gibson": stiffness(almost, HALF),
            "vanishing": stiffness(almost, mpf(0.3)),
            "balance_stiff": (stiffness(-soft, HALF) / stiffness(mpf(0), HALF)) ** (1 / -soft),
            "balance_compliant": (stiffness(soft, holl(soft)) / stiffness(mpf(0), HALF)) ** (1 / soft),
            "factor_stiff": modulus_factor(-soft, holl(-soft)),
            "factor_compliant": modulus_factor(soft, holl(soft)),
            "factor_stiff_half": modulus_factor(-soft, HALF),
            "factor_compliant_half": modulus_factor(soft, HALF),
            "modulus_stiff": modulus_factor(-soft, holl(-soft)) * (1 - holl(-soft) ** 2) / (1 - HALF**2),
            "modulus_compliant": modulus_factor(soft, holl(soft)) * (1 - holl(soft) ** 2) / (1 - HALF**2),
        } | crossings


def change(k):
    return oracle.volume_change(k, digits=DIGITS + 10)


def slope_of_change(k):
    return oracle.derivatives("volume_change", (k,)).gradient[0]


def slope_at_zero(phi):
    return oracle.derivatives("wear_volume", (0, phi), wrt=(0,)).gradient[0]


def crossing(quantity, one, other, lower, upper):
    """The amplitude at which a quantity is the same for both exponents, by bisection and secants."""
    return mp.findroot(
        lambda phi: mp.log(quantity(one, phi, digits=DIGITS) / quantity(other, phi, digits=DIGITS)),
        (mpf(lower), mpf(upper)),
        solver="anderson",
        tol=mpf(10) ** -DIGITS,
    )


def holl(k):
    return oracle.holl_ratio(k, digits=DIGITS)


def stiffness(k, nu):
    """F_N0/(2 E0 d a) of Eq. (8) for z0 = a."""
    return oracle.gross_initial_force(1, 1, k, nu, 1, 1, digits=DIGITS) / 2


def modulus_factor(k, nu):
    """E0/(1-nu^2) that gives the force of Eq. (12) at a_0 = z0, over that of k = 0."""

    def load(k):  # for E0/(1-nu^2) = R = a_0 = z0 = 1
        return 4 * oracle.h_N(k, nu, digits=DIGITS) / ((k + 1) ** 2 * (k + 3))

    return load(mpf(0)) / load(k)


def number_table():
    library, exact = figures.numbers(), from_oracle()
    rows = []
    for name, asked in figures.NUMBERS.items():
        off = abs(float(library[name]) / float(exact[name]) - 1.0)
        rows.append(
            (
                asked.where,
                asked.words,
                asked.printed or "—",
                f"{library[name]:.9g}",
                f"{float(exact[name]):.9g}",
                ok(off),
            )
        )
    return figures._markdown_table(("", "", "paper", "library", "mpmath", "library against mpmath"), rows)


def ok(off):
    return "the same to 1e-10" if off < 1e-10 else f"off by {off:.0e}"


# --- equations ------------------------------------------------------------------------------------------------------

# Numbers without meaning, none of them 1, so that a length that is missing shows.
E0, Z0, A, D, R = mpf(7), mpf("0.6"), mpf("1.7"), mpf("0.05"), mpf(23)
POINTS = (("-0.7", "0.15", "0.2"), ("-0.2", "0.5", "0.5"), ("0.4", "0.9", "0.3"))
TINY = mpf(10) ** -300

EQUATIONS = []


def equation(number, words):
    """Enter the ratio of two things that the paper calls the same, at k, phi and nu."""

    def enter(ratio):
        EQUATIONS.append((number, words, ratio))
        return ratio

    return enter


def over_disc(pressure, radius, k):
    """The force of a pressure that is z^((k-1)/2) times a smooth function of z = 1 - (r/radius)^2."""
    power = 2 / (1 + k)  # z = u^power takes the singularity away
    return mp.pi * radius**2 * mp.quad(lambda u: pressure(u**power) * power * u ** (power - 1), [0, 1])


def punch_force(k, nu):
    """Eq. (8)."""
    return oracle.gross_initial_force.formula(E0, Z0, k, nu, A, D)


def punch_pressure(z, k, nu):
    """Eq. (2)."""
    right = oracle.h_N.formula(k, nu) / (2 * (1 - nu**2) * Z0**k * (A**2 * z) ** ((1 - k) / 2))
    return 2 * E0 * D / (mp.pi * A) * right


def load(a, k, nu):
    """Eq. (12)."""
    return 4 * oracle.h_N.formula(k, nu) * E0 * a ** (k + 3) / ((1 - nu**2) * Z0**k * (k + 1) ** 2 * (k + 3) * R)


def beside(r, b, k, sunk=0):
    """Eq. (14) for a_0 = b, and by how much a punch of that radius sinks in besides, as in Eq. (18)."""
    s, t = (1 + k) / 2, (b / r) ** 2
    first, second = (mp.betainc(s + n, 1 - s, 0, t) for n in (0, 1))
    cos = mp.cospi(k / 2)
    return b**2 * cos / ((k + 1) * mp.pi * R) * (first - second / t) + sunk * cos / mp.pi * first


def worn_pressure(z, k, phi):
    """Eq. (17) over F_N, where F_1 = (1 - phi) F_N."""
    both = (k + 3) * (1 - phi) * z ** ((1 + k) / 2) + (k + 1) * phi * z ** ((k - 1) / 2)
    return both / (2 * mp.pi * edge(k, phi) ** 2)


def edge(k, phi):
    """b = c of Eqs. (16), (23)."""
    return A * oracle.stick_radius.formula(k, phi)


@equation("(2)", "its integral over the contact, over Eq. (8): **as printed**, a = 1.7")
def punch_carries_its_force_as_printed(k, phi, nu):
    return over_disc(lambda z: punch_pressure(z, k, nu), A, k) / punch_force(k, nu)


@equation("(2)", "the same, with a factor a on the right side")
def punch_carries_its_force(k, phi, nu):
    return over_disc(lambda z: A * punch_pressure(z, k, nu), A, k) / punch_force(k, nu)


@equation("(3)", "just outside r = a, and 1")
def surface_joins_the_punch(k, phi, nu):
    return oracle.gross_initial_displacement.formula(1 + TINY, k)


@equation("(3)", "at k = 0, and (2/π) arcsin(a/r)")
def surface_beside_a_punch_is_the_known_one(k, phi, nu):
    r = 1 + phi
    return oracle.gross_initial_displacement.formula(r, mpf(0)) / (2 / mp.pi * mp.asin(1 / r))


@equation("(5)", "its two branches at r = a")
def steady_surface_joins(k, phi, nu):
    inside, outside = (oracle.gross_steady_displacement.formula(r, k) for r in (mpf(1), 1 + TINY))
    return inside / outside


@equation("(5)", "at k = 0 inside, and (2/π) times the elliptic integral of modulus r/a")
def pressed_disc_is_the_known_one(k, phi, nu):
    return oracle.gross_steady_displacement.formula(phi, mpf(0)) / (2 / mp.pi * mp.ellipe(phi**2))


@equation("(6), (7)", "the integral of Eqs. (3), (5), and the closed form")
def volume_change_is_the_integral(k, phi, nu):
    def gone(u):  # r^2 = 1 - u^8: the edge is smooth
        return (1 - oracle.gross_steady_displacement.formula(mp.sqrt(1 - u**8), k)) * 8 * u**7

    return mp.quad(gone, [0, 1]) / oracle.volume_change.formula(k)


@equation("(8), (9), (10)", "the ratio of the first two, and the third")
def force_ratio_is_that_of_the_forces(k, phi, nu):
    steady, initial = (
        force.formula(E0, Z0, k, nu, A, D) for force in (oracle.gross_steady_force, oracle.gross_initial_force)
    )
    return steady / initial / oracle.force_ratio.formula(k)


@equation("(2), (10)", "the centre sinks in as deep under both pressures, by Green's function r^−(1+k)")
def centre_keeps_its_depth(k, phi, nu):
    s = (1 + k) / 2
    initial = s / 2 * mp.beta(s, 1 - s)  # the integral of s (1-x^2)^(s-1) x^-k dx
    return initial * (1 - k) / oracle.force_ratio.formula(k)


@equation("(8), (11), (12)", "dF_N/dd of the parabola, and F_N/d of a punch of its contact radius")
def parabola_is_as_stiff_as_its_punch(k, phi, nu):
    by_radius, depth_by_radius = (k + 3) * load(A, k, nu) / A, 2 * A / ((k + 1) * R)
    return by_radius / depth_by_radius / (punch_force(k, nu) / D)


@equation("(13)", "its integral over the contact, and F_N")
def initial_pressure_carries_the_load(k, phi, nu):
    return over_disc(lambda z: (k + 3) / (2 * mp.pi * A**2) * z ** ((1 + k) / 2), A, k)


@equation("(11), (14)", "w_0(a_0), and d_0 − a_0²/(2R)")
def initial_surface_joins(k, phi, nu):
    return beside(A, A, k) / (A**2 / ((k + 1) * R) - A**2 / (2 * R))


@equation("(14)", "at k = 0, and Hertz")
def initial_surface_is_that_of_hertz(k, phi, nu):
    x = 1 + phi
    hertz = ((2 - x**2) * mp.asin(1 / x) + mp.sqrt(x**2 - 1)) * A**2 / (mp.pi * R)
    return beside(A * x, A, mpf(0)) / hertz


@equation("(12), (16), (23)", "F_1(c)/F_N, and 1 − φ")
def stick_area_carries_its_share(k, phi, nu):
    return load(edge(k, phi), k, nu) / load(A, k, nu) / (1 - phi)


@equation("(17)", "its integral over the contact, and F_N")
def worn_pressure_carries_the_load(k, phi, nu):
    return over_disc(lambda z: worn_pressure(z, k, phi), edge(k, phi), k)


@equation("(18), (24)", "w_∞(1.3 c)")
def worn_surface_is_that_of_the_punch(k, phi, nu):
    b, h_N, F_N = edge(k, phi), oracle.h_N.formula(k, nu), load(A, k, nu)
    sunk = (1 - nu**2) * (1 + k) * Z0**k * (F_N - load(b, k, nu)) / (2 * h_N * E0 * b ** (1 + k))
    r = mpf("1.3") * b
    return beside(r, b, k, sunk) / (oracle.steady_displacement.formula(r / A, k, phi) * A**2 / R)


@equation("(19)", "its integral over the contact, and F_x")
def traction_carries_the_force(k, phi, nu):
    return over_disc(lambda z: (k + 1) / (2 * mp.pi) * z ** ((k - 1) / 2), mpf(1), k)


@equation("(17), (20)", "at δ = 10⁻²⁰⁰")
def worn_pressure_is_singular(k, phi, nu):
    z = 2 * mpf(10) ** -200
    return worn_pressure(z, k, phi) / ((k + 1) * phi / (2 * mp.pi * edge(k, phi) ** 2) * z ** ((k - 1) / 2))


@equation("(22)", "its right side, and φ: **as printed**, μ = 0.4")
def edge_is_about_to_slip_as_printed(k, phi, nu):
    return mpf("0.4") * edge_is_about_to_slip(k, phi, nu)


@equation("(22)", "the same, without the factor μ")
def edge_is_about_to_slip(k, phi, nu):
    return (1 - load(edge(k, phi), k, nu) / load(A, k, nu)) / phi


@equation("(11), (24), (25)", "w_∞(c), and d_∞ − c²/(2R)")
def worn_surface_joins(k, phi, nu):
    c = oracle.stick_radius.formula(k, phi)
    outside = oracle.steady_displacement.formula(c * (1 + TINY), k, phi)
    return outside / (oracle.penetration.formula(k, phi) - c**2 / 2)


@equation("(26)", "w_∞(0) − w_∞(a_∞), and f_0(a_∞)")
def ring_ends_on_the_parabola(k, phi, nu):
    a = oracle.worn_radius.formula(k, phi)
    rise = oracle.penetration.formula(k, phi) - oracle.steady_displacement.formula(a, k, phi)
    return rise / (a**2 / 2)


@equation("(28)", "by quadrature, and in closed form")
def wear_volume_is_the_integral(k, phi, nu):
    c, a = oracle.stick_radius.formula(k, phi), oracle.worn_radius.formula(k, phi)

    area = a**2 - c**2
    depths = mp.quad(lambda part: oracle.wear_depth.formula(mp.sqrt(c**2 + part * area), k, phi), [0, 1])
    return mp.pi * area * depths / oracle.wear_volume.formula(k, phi)


@equation("(29)–(31)", "h_N at k = 0, and 1, which makes Eq. (8) that of Boussinesq")
def homogeneous_half_space_is_the_known_one(k, phi, nu):
    return oracle.h_N.formula(mpf(0), nu)


@equation("(31)", "β at Holl's ratio, and 1")
def holl_ratio_makes_beta_one(k, phi, nu):
    return mp.sqrt((1 + k) * (1 - k * holl(k) / (1 - holl(k))))


@equation("(8), (29)–(31)", "at k = 1 − 10⁻³⁰⁰ and ν = 1/2, and Gibson's soil, F_N = (2/3) (E_0/z_0) π a² d")
def gibson_soil_is_a_winkler_foundation(k, phi, nu):
    return punch_force(1 - TINY, HALF) / (mpf(2) / 3 * E0 / Z0 * mp.pi * A**2 * D)


# What is looked at so close to an edge takes digits to be there.
BESIDE_AN_EDGE = (
    surface_joins_the_punch,
    steady_surface_joins,
    worn_surface_joins,
    gibson_soil_is_a_winkler_foundation,
)
EQUAL = mpf(10) ** -20


def ratios(ratio):
    """At `POINTS`."""
    with mp.workdps(700 if ratio in BESIDE_AN_EDGE else 40):
        return [ratio(*map(mpf, point)) for point in POINTS]


def equation_table():
    rows = []
    for number, words, ratio in EQUATIONS:
        found = ratios(ratio)
        same = max(abs(x - 1) for x in found) < EQUAL
        rows.append((number, words, "the same" if same else f"**{mp.nstr(found[0], 4)} of it**"))
    return figures._markdown_table(("equation", "compared", ""), rows)


# --- the page -------------------------------------------------------------------------------------------------------


def renewed(page, tables):
    """The page with each table between its marks."""
    for name, text in tables.items():
        first, last = f"<!-- {name} -->\n", f"\n<!-- end of {name} -->"
        head, mark, rest = page.partition(first)
        _, end, tail = rest.partition(last)
        if not (mark and end):
            raise ValueError(f"the page has no place for {name}")
        page = head + first + "\n" + text + "\n" + last + tail
    return page


def main():
    jax.config.update("jax_enable_x64", True)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", type=Path, metavar="PAGE.md", help="the page to put the tables into")
    page = parser.parse_args().write
    tables = {"numbers": number_table(), "equations": equation_table()}
    print("\n\n".join(tables.values()))
    if page is not None:
        sibling = page.with_name(f".{page.name}.{os.getpid()}.part")
        sibling.write_text(renewed(page.read_text("utf-8"), tables), "utf-8")
        sibling.replace(page)


if __name__ == "__main__":
    main()
