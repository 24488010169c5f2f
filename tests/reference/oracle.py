"""The paper in mpmath: every quantity of the library to 40 or more correct digits, from Eqs. (1)-(31) as printed.

Radii are in units of a (gross slip) or a_0 (fretting), phi = F_x/(mu F_N); units of the results stand in each
docstring. Arguments may be floats (taken exactly, as the binary number), ints, mpf or decimal strings. Every quantity
takes `digits`, the number of digits it is rounded to; the formulas themselves run with guard digits that grow with
the nearness of the arguments to an edge of the domain, see `_lost_digits`.

    worn_radius(0.3, 0.2)                                       an mpf
    derivatives(worn_radius, (0.3, 0.2), order=2)               value, gradient, hessian
    map_points("worn_radius", points, processes=2, order=1)     the same over many points, as pairs of doubles
"""

from functools import partial, wraps
from inspect import signature
from multiprocessing import get_context
from typing import Any, NamedTuple

from mpmath import mp, mpf

DIGITS = 50  # of a quantity
DERIVATIVE_DIGITS = 32  # aimed at in derivatives
GUARD_DIGITS = 30  # beyond _lost_digits: zeros inside the domain (wear depth near a_inf) and cancelling terms
STEP_BITS = 60  # a difference step is 2^-60 of the distance to the nearest edge of the domain

QUANTITIES = {}


def quantity(formula):
    """Make `formula`, which works at the ambient precision, a function correct to `digits` digits."""
    parameters = signature(formula).parameters
    names = tuple(name for name in parameters if name != "start")

    @wraps(formula)
    def rounded(*arguments, digits=DIGITS, **options):
        with mp.workdps(digits):
            extra = _lost_digits(_read(names, arguments))
        with mp.workdps(digits + GUARD_DIGITS + extra):
            exact = formula(*_read(names, arguments).values(), **options)
        with mp.workdps(digits):
            return +exact

    rounded.formula, rounded.names, rounded.has_root = formula, names, "start" in parameters
    QUANTITIES[formula.__name__] = rounded
    return rounded


def _read(names, arguments):
    """The arguments by name, exactly (strings at the ambient precision); they lie inside the domain of the paper."""
    return {name: mp.convert(x) for name, x in zip(names, arguments, strict=True)}


def _amplitude(at):
    """phi, given as such, by a displacement or in SI units; 0 where there is no tangential force."""
    return at["F_x"] / (at["mu"] * at["F_N"]) if "F_x" in at else at.get("phi", at.get("displacement", mpf(0)))


def _lost_digits(at):
    """Digits that may cancel here: three times those of the nearness to k = -1, 1, phi = 0, 1, r = c, oo."""
    phi = _amplitude(at)
    near = [phi, 1 - phi]
    if "k" in at:
        near.append(1 - abs(at["k"]))
    if "r" in at:
        near += [at["r"] / _inner_edge(at) - 1, 1 / (1 + at["r"])]
    if "distance" in at:
        near += [at["distance"], at["distance"] / _inner_edge(at) - 1]
    return 1 + sum(-mp.mag(x) for x in near if x and mp.mag(x) < 0)


def _inner_edge(at):
    """The radius at which fields are singular: c of Eq. (16), or the edge of the initial contact or of the punch."""
    return (1 - at["phi"]) ** (1 / (at["k"] + 3)) if "phi" in at else mpf(1)


# ---------------------------------------------------------------------------------------------- appendix: material


@quantity
def h_N(k, nu):
    """Eqs. (29)-(31), dimensionless."""
    beta = mp.sqrt((1 + k) * (1 - k * nu / (1 - nu)))
    C = 2 ** (1 + k) * mp.gamma((3 + k + beta) / 2) * mp.gamma((3 + k - beta) / 2) / (mp.pi * mp.gamma(2 + k))
    return (
        2 * (1 + k) * mp.cospi(k / 2) * mp.gamma(1 + k / 2)
        / (mp.sqrt(mp.pi) * C * beta * mp.sinpi(beta / 2) * mp.gamma((1 + k) / 2))
    )  # fmt: skip


@quantity
def holl_ratio(k):
    """Poisson's ratio of exact uncoupling, 1/(2+k)."""
    return 1 / (2 + k)


# --------------------------------------------------------------------------------------------- section 2: gross slip


@quantity
def gross_initial_pressure(r, k):
    """Eq. (2) over the mean pressure F_N0/(pi a^2) of Eq. (8)."""
    return _inside(r, 1, lambda x: (1 + k) / 2 * x ** ((k - 1) / 2))


@quantity
def gross_steady_pressure(r, k):
    """The uniform pressure F_Ninf/(pi a^2) of Eq. (9) over F_N0/(pi a^2) of Eq. (8)."""
    return force_ratio.formula(k) if r <= 1 else mpf(0)


@quantity
def gross_initial_displacement(r, k):
    """Eq. (3), in d."""
    if r <= 1:
        return mpf(1)
    s = (1 + k) / 2
    return mp.cospi(k / 2) / mp.pi * 2 / (1 + k) * r ** (-1 - k) * mp.hyp2f1(s, s, (3 + k) / 2, 1 / r**2)


@quantity
def gross_steady_displacement(r, k):
    """Eq. (5), in d. The continuation of both series to the edge divides by k: one more precision pays for it."""
    working = mp.dps
    with mp.workdps(working + (working if not k else max(0, -mp.mag(k)))):
        k = k or mpf(10) ** -working
        s = (1 + k) / 2
        if r <= 1:
            return mp.hyp2f1((k - 1) / 2, s, 1, r**2)
        return (1 - k) / 2 * r ** (-1 - k) * mp.hyp2f1(s, s, 2, 1 / r**2)


@quantity
def volume_change(k):
    """Eq. (7), in pi a^2 d."""
    return 1 - mp.hyp2f1((k - 1) / 2, (1 + k) / 2, 2, 1)


@quantity
def force_ratio(k):
    """Eq. (10)."""
    return mp.pi * (1 - k) * (1 + k) / (4 * mp.cospi(k / 2))


@quantity
def force_drop(k):
    """1 minus Eq. (10)."""
    return 1 - force_ratio.formula(k)


@quantity
def gross_initial_force(E0, z0, k, nu, a, d):
    """Eq. (8), SI."""
    return 2 * E0 * d * a * h_N.formula(k, nu) / ((1 - nu**2) * (1 + k)) * (a / z0) ** k


@quantity
def gross_steady_force(E0, z0, k, nu, a, d):
    """Eq. (9), SI."""
    return 2 * E0 * d * a * mp.pi * h_N.formula(k, nu) * (1 - k) / (4 * (1 - nu**2) * mp.cospi(k / 2)) * (a / z0) ** k


# ------------------------------------------------------------------------------- partial slip, beyond the paper


@quantity
def tangential_ratio(k, nu):
    """Tangential compliance over the normal one: the mean of that along a wave of traction and that across it."""
    along = (1 + k) / (1 - k * nu / (1 - nu))
    return (along + h_N.formula(k, nu) / ((1 - nu) * mp.cospi(k / 2))) / 2


@quantity
def displacement_amplitude(k, phi, compliance):
    """Of the contact and of a spring in series, over that at which gross slip begins."""
    return (1 - stick_radius.formula(k, phi) ** 2 + compliance * phi) / (1 + compliance)


@quantity
def force_amplitude(k, displacement, compliance):
    """phi at which `displacement_amplitude` is the displacement, by Newton's method in c^2, in which it is convex."""
    power, C = (3 + k) / 2, 1 - displacement
    while True:
        excess = 1 - C + compliance * (1 - C**power) - displacement * (1 + compliance)
        step = excess / (1 + compliance * power * C ** (power - 1))
        C += step
        if abs(step) <= mpf(10) ** (-mp.dps * mpf("0.55")) * min(C, 1 - C):  # the next would be its square
            return 1 - C**power


@quantity
def slip_amplitude(r, k, phi):
    """The gap beside the contact of radius c under the parabola, in a_0^2/R; 0 where that sticks and beyond r = 1."""
    c = stick_radius.formula(k, phi)
    if r <= c or r > 1:
        return mpf(0)
    return r**2 / 2 - c**2 * (1 / (1 + k) - initial_displacement.formula(r / c, k))


@quantity
def energy_per_cycle(k, phi):
    """Four slip amplitudes under mu p_0 of Eq. (13), integrated by powers of r^2, in mu^2 theta F_N a_0^2/R."""
    s, C = (1 + k) / 2, stick_radius.formula(k, phi) ** 2
    falls = [(1 - C ** (s + j)) / (s + j) for j in range(3)]
    return 2 * (1 + s) * ((1 + C) * falls[1] - C * falls[0] - falls[2])


def _moved(k, phi):
    """Displacement of the first loading, over that at which gross slip begins."""
    return 1 - stick_radius.formula(k, phi) ** 2


@quantity
def contact_share(k, phi, compliance):
    """Share of the contact in the displacement of the contact and of a spring in series."""
    return _moved(k, phi) / (_moved(k, phi) + compliance * phi)


@quantity
def energy_ratio(k, phi):
    """Area of the loop that Masing's rule makes of the first loading, 4 phi u - 8 int_0^phi u, over 4 phi u."""
    power = 2 / (3 + k)
    below = phi - (1 - (1 - phi) ** (1 + power)) / (1 + power)
    return 1 - 2 * below / (phi * _moved(k, phi))


@quantity
def loop_aperture(k, phi):
    """Displacement at no force on the way back, by Masing's rule, over the displacement amplitude."""
    return 1 - 2 * _moved(k, phi / 2) / _moved(k, phi)


# ------------------------------------------------------------------------------------------ section 3: fretting wear


@quantity
def contact_radius(E0, z0, k, nu, R, F_N):
    """a_0 from Eq. (12), SI."""
    return (F_N * (1 - nu**2) * z0**k * (k + 1) ** 2 * (k + 3) * R / (4 * h_N.formula(k, nu) * E0)) ** (1 / (k + 3))


@quantity
def stick_radius(k, phi):
    """Eqs. (16), (23), in a_0."""
    return (1 - phi) ** (1 / (k + 3))


@quantity
def penetration(k, phi):
    """d_inf, in a_0^2/R: Eq. (11) for a parabola to radius c, then Eqs. (8), (12) for the translation by F_N - F_1.

    Eq. (12) makes F_1/F_N = c^(k+3) = 1 - phi, so Eq. (8) at radius c moves the punch by
    (1 + k)(F_N - F_1)(1 - nu^2) z_0^k/(2 E_0 h_N c^(1+k)) = 2 phi/((k + 1)(k + 3) c^(k+1)).
    """
    c = stick_radius.formula(k, phi)
    return c**2 / (k + 1) + 2 * phi / ((k + 1) * (k + 3) * c ** (k + 1))


@quantity
def initial_pressure(r, k):
    """Eq. (13), in F_N/(pi a_0^2)."""
    return _inside(r, 1, lambda x: (k + 3) / 2 * x ** ((1 + k) / 2))


@quantity
def steady_pressure(r, k, phi):
    """Eq. (17) with b = c, F_1 = (1 - phi) F_N, in F_N/(pi a_0^2)."""
    c = stick_radius.formula(k, phi)
    parabola, punch = (k + 3) * (1 - phi) / (2 * c**2), edge_intensity.formula(k, phi)
    return _inside(r, c, lambda x: parabola * x ** ((1 + k) / 2) + punch * x ** ((k - 1) / 2))


@quantity
def steady_traction(r, k, phi):
    """Eq. (19) with b = c, in mu F_N/(pi a_0^2)."""
    return _inside(r, stick_radius.formula(k, phi), lambda x: edge_intensity.formula(k, phi) * x ** ((k - 1) / 2))


@quantity
def edge_intensity(k, phi):
    """The factor of (2 delta)^((k-1)/2) in Eqs. (20), (21), in F_N/(pi a_0^2) and mu F_N/(pi a_0^2)."""
    return (k + 1) * phi / (2 * stick_radius.formula(k, phi) ** 2)


@quantity
def initial_displacement(r, k):
    """Eq. (14) outside the contact, d_0 - r^2/2 inside with d_0 of Eq. (11), in a_0^2/R."""
    if r <= 1:
        return 1 / (k + 1) - r**2 / 2
    t = 1 / r**2
    beta_1, beta_3 = (_incomplete_beta(t, (n + k) / 2, (1 - k) / 2) for n in (1, 3))
    return mp.cospi(k / 2) / ((k + 1) * mp.pi) * (beta_1 - r**2 * beta_3)


@quantity
def steady_displacement(r, k, phi):
    """Eq. (24) outside the stick area, d_inf - r^2/2 inside, in a_0^2/R."""
    c = stick_radius.formula(k, phi)
    if r <= c:
        return penetration.formula(k, phi) - r**2 / 2
    beta_1, beta_3 = (_incomplete_beta(c**2 / r**2, (n + k) / 2, (1 - k) / 2) for n in (1, 3))
    cos_pi = mp.cospi(k / 2) / mp.pi
    return (
        cos_pi * c**2 / (k + 3) * (1 + 2 / ((k + 1) * c ** (k + 3))) * beta_1
        - cos_pi * r**2 / (k + 1) * beta_3
    )  # fmt: skip


@quantity
def wear_depth(r, k, phi):
    """f_inf - f_0 of Eqs. (25), (28), in a_0^2/R: positive in the ring c < r < a_inf, where Eq. (28) changes sign."""
    if r <= stick_radius.formula(k, phi):
        return mpf(0)
    return max(mpf(0), penetration.formula(k, phi) - steady_displacement.formula(r, k, phi) - r**2 / 2)


@quantity
def profile(r, k, phi):
    """f_inf of Eq. (25), in a_0^2/R."""
    return r**2 / 2 + wear_depth.formula(r, k, phi)


@quantity
def worn_radius(k, phi, *, start=None):
    """a_inf, the root of Eq. (26) outside c, in a_0. `start` is a first guess of (a_inf/c)^2 - 1."""
    return stick_radius.formula(k, phi) * mp.sqrt(1 + _ring(k, phi, start))


@quantity
def wear_volume(k, phi, *, start=None):
    """Eq. (28), in a_0^4/R, by its antiderivative. `start` is as in `worn_radius`."""
    return _wear_volume(k, phi, _ring(k, phi, start))


@quantity
def deepest_wear(k, phi, *, start=None):
    """The maximum of `wear_depth` over r, in a_0^2/R. `start` is a first guess of (r/c)^2 - 1 there."""
    if not phi:
        return mpf(0)
    return wear_depth.formula(stick_radius.formula(k, phi) * mp.sqrt(1 + _deepest(k, phi, start)), k, phi)


@quantity
def edge_pressure(distance, k, phi):
    """Eq. (17) at `distance` inside the stick-slip boundary, at most at the centre, in F_N/(pi a_0^2)."""
    return steady_pressure.formula(max(mpf(0), stick_radius.formula(k, phi) - distance), k, phi)


@quantity
def wear_volume_in_si(
    E0, z0, k, nu, R, F_N, mu, F_x,
    *, start = None,
):  # fmt: skip
    """Eqs. (12) and (28), in m^3. `start` is as in `worn_radius`."""
    return (
        contact_radius.formula(E0, z0, k, nu, R, F_N) ** 4 / R * wear_volume.formula(k, F_x / (mu * F_N), start=start)
    )


def _inside(r, edge, field):
    """`field` of 1 - (r/edge)^2 within `edge`, 0 outside, its limit on it (field(0) or infinity)."""
    if r > edge:
        return mpf(0)
    try:
        return field(1 - (r / edge) ** 2)
    except ZeroDivisionError:
        return mp.inf


def _incomplete_beta(t, p, q):
    """B(t; p, q), Eq. (15), by the 2F1 of DLMF 8.17.7, reflected to an argument of at most 1/2."""
    if 2 * t > 1:
        return mp.beta(p, q) - _incomplete_beta(1 - t, q, p)
    return t**p / p * mp.hyp2f1(p, 1 - q, p + 1, t)


def _tail(y, k):
    """Q = 1 - sigma B(1/(1+y); (1+k)/2, (1-k)/2) with sigma = cos(k pi/2)/pi, which makes Q(0) = 0, Q(oo) = 1."""
    sigma = mp.cospi(k / 2) / mp.pi
    if y > 1:
        return 1 - sigma * _incomplete_beta(1 / (1 + y), (1 + k) / 2, (1 - k) / 2)
    return sigma * _incomplete_beta(y / (1 + y), (1 - k) / 2, (1 + k) / 2)


def _ring(k, phi, start=None):
    """y_inf = (a_inf/c)^2 - 1: the root of Eq. (26) outside c.

    The recurrence B(t; s+1, 1-s) = s B(t; s, 1-s) - t^s (1-t)^(1-s), s = (1+k)/2, makes the depth of Eq. (28)
        w_inf(0) - w_inf(r) - r^2/2 = c^2 Q (rise - L)/2,
        L(y) = y - (1-s)/s + u,  u = sigma y^(1-s)/(s Q),  rise = phi/((1-phi) s (s+1)),
    so Eq. (26) is L(y) = rise. L is increasing and y <= L(y) <= y/(s (2-s)), which brackets the root: with
    Q = sigma int_0^y v^-s/(1+v) dv, u - (1-s)/s is y (1-s)/s times the mean of v over the weight v^(-s)/(1 + y v)
    on [0, 1], which falls from (1-s)/(2-s) at y = 0 to 0. Halley's step, halving the bracket where it leaves it.
    """
    if not phi:
        return mpf(0)
    s, sigma = (1 + k) / 2, mp.cospi(k / 2) / mp.pi
    rise = phi / ((1 - phi) * s * (s + 1))
    low, high = rise * s * (2 - s), rise
    y = low if start is None else mp.convert(start)
    converged = mpf(10) ** (-mp.dps * mpf("0.4"))  # cubic: the step after this one would be 10^(-1.2 dps)
    while True:
        u = sigma * y ** (1 - s) / (s * _tail(y, k))
        excess = y - (1 - s) / s + u - rise
        low, high = (y, high) if excess < 0 else (low, y)
        log_slope = ((1 - s) - s * u / (1 + y)) / y  # u'/u
        slope = 1 + u * log_slope
        bend = u * (log_slope**2 - (1 - s) / y**2 - s * u * (log_slope * y * (1 + y) - 1 - 2 * y) / (y * (1 + y)) ** 2)
        step = excess / (slope - excess * bend / (2 * slope))
        if abs(step) <= converged * y:
            return y - step
        y = y - step if low < y - step < high else (low + high) / 2


def _deepest(k, phi, start=None):
    """(r/c)^2 - 1 where d_inf - w_inf - r^2/2 is greatest.

    By Eqs. (15) and (24) with t = c^2/r^2 = 1/(1+y) its derivative in r is r times P y^-s/(1+y) - C,
        C = 1 - 2 sigma B(t; s+1, 1-s)/(k+1),    P = 4 sigma (c^-(k+3) - 1)/((k+1)(k+3)),
    a power that falls and an integral that rises from 0: one root, where their logarithms are equal. Newton's step in
    log(y), of which the difference of the logarithms is a concave function with slopes between -1 and -2.
    """
    s, sigma = (1 + k) / 2, mp.cospi(k / 2) / mp.pi
    P = 4 * sigma * (stick_radius.formula(k, phi) ** (-k - 3) - 1) / ((k + 1) * (k + 3))
    y = phi / (1 - phi) if start is None else mp.convert(start)
    converged = mpf(10) ** (-mp.dps * mpf("0.55"))  # quadratic: the step after this one would be 10^(-1.1 dps)
    while True:
        C = 1 - 2 * sigma * _incomplete_beta(1 / (1 + y), s + 1, 1 - s) / (k + 1)
        power = y**-s / (1 + y)
        slope = -s - y / (1 + y) - 2 * sigma / (k + 1) * y * power / (1 + y) / C
        step = mp.log(P * power / C) / slope
        y = y * mp.exp(-step)
        if abs(step) <= converged:
            return y


def _wear_volume(k, phi, y):
    """Eq. (28) to (a_inf/c)^2 - 1 = y. With the depth as in `_ring`, rise - L = M - y - u and M = rise + 1/s - 1,

        V = pi c^4/2 int_0^y ((M - y) Q - sigma y^(1-s)/s) dy,

    integrated by parts with Q' = sigma y^(-s)/(1+y) and int y^(1-s)/(1+y) dy = y^(1-s)/(1-s) - Q/sigma.
    """
    if not y:
        return mpf(0)
    s, sigma = (1 + k) / 2, mp.cospi(k / 2) / mp.pi
    M = phi / ((1 - phi) * s * (s + 1)) + 1 / s - 1
    integral = (M * (1 + y) + (1 - y**2) / 2) * _tail(y, k) - sigma * y ** (1 - s) * (
        (M + mpf(1) / 2) / (1 - s) + y / (2 * s)
    )
    return mp.pi * stick_radius.formula(k, phi) ** 4 / 2 * integral


# --------------------------------------------------------------------------------------------------- derivatives


class Derivatives(NamedTuple):
    """Value, gradient and (order 2) symmetric Hessian, rows and columns in the order of `wrt`."""

    value: Any
    gradient: tuple[Any, ...]
    hessian: tuple[tuple[Any, ...], ...] | None


def derivatives(f, point, wrt=None, order=1):
    """Derivatives of a quantity by central differences, correct to about 30 digits.

    `wrt` holds positions in `point` (all of them by default), `order` is 1 or 2. Steps are 2^-60 of the distance to
    the nearest edge, and the working precision has the digits that divided differences lose.
    """
    f = QUANTITIES[f] if isinstance(f, str) else f
    wrt = tuple(range(len(point))) if wrt is None else tuple(wrt)
    with mp.workdps(DIGITS + GUARD_DIGITS):
        at = _read(f.names, point)
        step = [mp.ldexp(distance, -STEP_BITS) for distance in _distances_to_edge(f, at)]
        lost = _lost_digits(at) + order * max(1 - int(mp.log10(step[i] / max(1, abs(at[f.names[i]])))) for i in wrt)
    with mp.workdps(DERIVATIVE_DIGITS + GUARD_DIGITS + lost):
        centre = tuple(_read(f.names, point).values())
        formula = f.formula
        if f.has_root:
            at, root = dict(zip(f.names, centre, strict=True)), _deepest if f is deepest_wear else _ring
            formula = partial(formula, start=root(at["k"], _amplitude(at)))

        def moved(*moves):
            x = list(centre)
            for i, sign in moves:
                x[i] += sign * step[i]
            return formula(*x)

        middle = moved()
        ahead, behind = ({i: moved((i, sign)) for i in wrt} for sign in (1, -1))
        pairs = [(i, j) for i in wrt for j in wrt if i < j] if order == 2 else []
        corners = {(i, j): (moved((i, 1), (j, 1)), moved((i, -1), (j, -1))) for i, j in pairs}

        def second(i, j):
            i, j = min(i, j), max(i, j)
            bends = {m: ahead[m] - 2 * middle + behind[m] for m in (i, j)}
            if i == j:
                return bends[i] / step[i] ** 2
            along = corners[i, j][0] - 2 * middle + corners[i, j][1]
            return (along - bends[i] - bends[j]) / (2 * step[i] * step[j])

        gradient = tuple((ahead[i] - behind[i]) / (2 * step[i]) for i in wrt)
        hessian = tuple(tuple(second(i, j) for j in wrt) for i in wrt) if order == 2 else None
        return Derivatives(middle, gradient, hessian)


def _distances_to_edge(f, at):
    """How far each argument may move on the scale of the nearest singularity; moving k or phi moves the radii too."""
    edge, gap = _inner_edge(at), mpf(1)
    if "r" in at:
        edges = [edge]
        if f in (profile, wear_depth):
            edges.append(worn_radius.formula(at["k"], at["phi"]))
        gap = min(1, *(abs(at["r"] / radius - 1) for radius in edges))
    if "distance" in at:
        gap = min(1, at["distance"] / edge, abs(at["distance"] / edge - 1))
    phi = _amplitude(at)
    slip = min(phi, 1 - phi)  # the rest of the way to no slip or to gross slip, over mu F_N
    scale = {"k": lambda k: gap * (1 - abs(k)), "phi": lambda phi: gap * min(phi, 1 - phi), "r": lambda r: gap * edge}
    scale["nu"] = lambda nu: (1 - nu) * (1 - abs(at["k"]))
    scale["distance"] = lambda distance: gap * edge
    scale["displacement"] = lambda displacement: min(displacement, 1 - displacement)
    scale |= {name: lambda x: slip * x for name in ("mu", "F_N", "F_x") if "F_x" in at}
    return [scale.get(name, abs)(x) for name, x in at.items()]


# -------------------------------------------------------------------------------------------------- many points


def map_points(name, points, processes=2, order=0):
    """A quantity (order 0) or its `derivatives` at many points, each number x as doubles (hi, lo) with x = hi + lo.

    The error of a double y is then (y - hi) - lo. Processes are spawned and import this module only; a script that
    calls this needs the usual `if __name__ == "__main__":`.
    """
    work = partial(_pairs_at, name, order)
    points = [tuple(point) for point in points]
    if processes == 1:
        return [work(point) for point in points]
    with get_context("spawn").Pool(processes) as pool:
        return pool.map(work, points, chunksize=max(1, min(64, len(points) // (4 * processes))))


def _pairs_at(name, order, point):
    return as_pairs(derivatives(name, point, order=order) if order else QUANTITIES[name](*point))


def as_pairs(x):
    """Every mpf x of a result as doubles (hi, lo), x = hi + lo to 31 digits."""
    if isinstance(x, tuple):
        return type(x)(*map(as_pairs, x)) if hasattr(x, "_fields") else tuple(map(as_pairs, x))
    if x is None:
        return None
    hi = float(x)
    with mp.workdps(DIGITS):
        return hi, float(x - hi) if mp.isfinite(x) else 0.0
