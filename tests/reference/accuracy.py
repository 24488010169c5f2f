"""How far the library is from the oracle, region by region: the harness of the accuracy tests.

Errors are relative: of a value to itself, of a derivative to the larger of itself and the value. Points are fresh for
each seed; the regions are

    bulk    abs(k) <= 0.97, phi in [0.005, 0.995], r from 1.01 c to 1000 c (derivatives from 1.1 c), nu in [-0.9, 0.5]
    edges   1 - abs(k) down to 1e-9, abs(k) down to 1e-14, phi and 1 - phi down to 1e-12, r -> a down to 1e-12
    near    the displacement closer to the stick-slip boundary than 1.01 c, the profile in the whole ring, the wear
            depth in its inner nine tenths: the error is allowed what moving r by 4 units in its last place makes
    SI      a contact in SI units with k, nu and phi of the bulk and all else over decades; derivatives by what has a
            unit are relative to themselves
"""

import dataclasses
import functools
from collections.abc import Callable

import functions
import jax
import jax.numpy as jnp
import numpy as np
import oracle
from refusals import data

from plgwear_jax import FrettingContact, PowerLawGraded, fretting, gross_slip, material, partial_slip

# --- points ---------------------------------------------------------------------------------------------------------


def _mixed(rng, count, *samplers):
    """Points from all samplers in equal parts, shuffled."""
    return rng.permutation(np.concatenate([sampler(count // len(samplers) + 1) for sampler in samplers]))[:count]


def exponents(rng, count, region):
    if "edges" not in region:
        return rng.uniform(-0.97, 0.97, count)
    return _mixed(
        rng,
        count,
        lambda n: rng.choice([-1.0, 1.0], n) * (1.0 - 10.0 ** -rng.uniform(0.0, 9.0, n)),
        lambda n: rng.choice([-1.0, 1.0], n) * 10.0 ** -rng.uniform(0.0, 14.0, n),
        lambda n: rng.uniform(-1.0, 1.0, n),
    ).clip(-1.0 + 1e-9, 1.0 - 1e-9)


def amplitudes(rng, count, region):
    decades, least = (12.0, 1e-12) if "edges" in region else (2.3, 0.005)
    return _mixed(
        rng,
        count,
        lambda n: rng.uniform(0.0, 1.0, n),
        lambda n: 10.0 ** -rng.uniform(0.01, decades, n),
        lambda n: 1.0 - 10.0 ** -rng.uniform(0.01, decades, n),
    ).clip(least, 1.0 - least)


def k_nu(rng, count, region):
    finest = 12.0 if region == "edges" else 2.0
    nu = _mixed(rng, count, lambda n: rng.uniform(-0.9, 0.5, n), lambda n: 0.5 - 10.0 ** -rng.uniform(0.0, finest, n))
    return exponents(rng, count, region), nu.clip(-0.9, 0.5 - 1e-12)


def k_phi(rng, count, region):
    return exponents(rng, count, region), amplitudes(rng, count, region)


def k_phi_and_rig(rng, count, region):
    """(k, phi or displacement, compliance), that of what is in series from far stiffer to far more compliant."""
    decades = 12.0 if region == "edges" else 3.0
    return *k_phi(rng, count, region), 10.0 ** rng.uniform(-decades, decades, count)


def beside_indenter(rng, count, region):
    """(r, k) with r from 1.01 to 1000."""
    return 1.0 + 10.0 ** rng.uniform(-2.0, 3.0, count).clip(-1.9999), exponents(rng, count, region)


def _of_stick(rng, region, part):
    """(r, k, phi) with r a part of c."""
    k, phi = k_phi(rng, part.size, region)
    return part * (1.0 - phi) ** (1.0 / (k + 3.0)), k, phi


def beside_stick(rng, count, region):
    """(r, k, phi) with r from 1.01 c to 1000 c."""
    return _of_stick(rng, region, beside_indenter(rng, count, region)[0])


def near_stick(rng, count, region):
    """(r, k, phi) within 1 % of c on both sides, down to 1e-12."""
    return _of_stick(rng, region, 1.0 + rng.choice([-1.0, 1.0], count) * 10.0 ** -rng.uniform(2.0, 12.0, count))


def under_stick(rng, count, region):
    """(r, k, phi) with r from 0 to 0.95 c."""
    return _of_stick(rng, region, rng.uniform(0.0, 0.95, count))


def inside_edge(rng, count, region):
    """(distance, k, phi) with the distance from 0.001 c (edges: 1e-12 c) to 2 c, a sixth of them beyond the centre."""
    part = _mixed(
        rng,
        count,
        lambda n: 10.0 ** rng.uniform(-3.0 if region == "bulk" else -12.0, 0.0, n),
        lambda n: rng.uniform(0.01, 1.0, n),
        lambda n: rng.uniform(0.01, 2.0, n),
    )
    return _of_stick(rng, region, part)


def in_ring(rng, count, region, most=1.0, power=0.4, outer=None):
    """(r, k, phi) with r between c and a_inf or another radius, crowded at both ends."""
    k, phi = k_phi(rng, count, region)
    inner = (1.0 - phi) ** (1.0 / (k + 3.0))
    share = most * rng.beta(0.4, power, count).clip(1e-6, 1.0 - 1e-6)
    return (
        inner + share * ((np.asarray(functions.fretting.worn_radius(k, phi)) if outer is None else outer) - inner),
        k,
        phi,
    )


# At a_inf the depth is a difference to zero.
worn_side = functools.partial(in_ring, most=0.9, power=1.0)
in_slip = functools.partial(in_ring, outer=1.0)


def dome(rng, count, region):
    """(E0, z0, k, nu, R, F_N, mu, F_x)."""
    k, phi = k_phi(rng, count, "bulk")
    decades = (6.0, 12.0), (-7.0, -2.0), (-4.0, 1.0), (-3.0, 5.0), (-2.0, 0.5)
    E0, z0, R, F_N, mu = (10.0 ** rng.uniform(*span, count) for span in decades)
    return E0, z0, k, rng.uniform(-0.9, 0.5, count), R, F_N, mu, phi * mu * F_N


def punch(rng, count, region):
    """(r, k) from 0 to 1000, crowded at both sides of the edge r = 1 down to 1e-12."""
    finest = 12.0 if region == "edges" else 3.0
    return _mixed(
        rng,
        count,
        lambda n: rng.uniform(0.0, 1.0, n),
        lambda n: 10.0 ** rng.uniform(0.0, 3.0, n),
        lambda n: 1.0 - 10.0 ** -rng.uniform(0.5, finest, n),
        lambda n: 1.0 + 10.0 ** -rng.uniform(0.5, finest, n),
    ), exponents(rng, count, region)


def under_punch(rng, count, region):
    r, k = punch(rng, count, region)
    return np.where(r > 1.0, 1.0 / r, r), k


# --- rows -----------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Quantity:
    """A function of the library, its twin in the oracle, where to compare them, and how many derivatives."""

    name: str
    function: Callable[..., jax.Array]
    sampler: Callable[[np.random.Generator, int, str], tuple[np.ndarray, ...]]
    oracle: str
    order: int = 1
    regions: tuple[str, ...] = ("bulk", "edges")
    derivatives_from: float = 0.0  # least distance from the stick-slip boundary, over c, where derivatives count
    with_unit: tuple[str, ...] = ()  # arguments that have one, so that the value is no measure of derivatives by them

    @property
    def arguments(self):
        return oracle.QUANTITIES[self.oracle].names


def wear_volume_in_si(*at):
    *material, R, F_N, mu, F_x = at
    return FrettingContact(PowerLawGraded(*material), R, F_N, mu).steady(F_x).wear_volume


def _of(module, sampler, *names, twin="{}", **how):
    room = module.__name__.rpartition(".")[2]
    return [Quantity(f"{room}.{name}", getattr(module, name), sampler, twin.format(name), **how) for name in names]


NEAR = ("near", "near edges")
_FAR = {"derivatives_from": 0.1}
_NEAR = {"regions": NEAR}
_SI = {"regions": ("SI",), "with_unit": ("E0", "z0", "R", "F_N", "mu", "F_x")}  # mu multiplies F_N
QUANTITIES = (
    *_of(fretting, k_phi, "wear_volume", "deepest_wear", order=2),
    *_of(fretting, k_phi, "worn_radius", "stick_radius", "penetration", "edge_intensity"),
    *_of(fretting, inside_edge, "edge_pressure"),
    *_of(fretting, beside_indenter, "initial_displacement", **_FAR),
    *_of(fretting, beside_stick, "steady_displacement", **_FAR),
    *_of(fretting, under_stick, "steady_pressure", "steady_traction", **_FAR),
    *_of(fretting, near_stick, "steady_displacement", **_NEAR),
    *_of(fretting, worn_side, "wear_depth", **_NEAR),
    *_of(fretting, in_ring, "profile", **_NEAR),
    *_of(gross_slip, punch, "initial_displacement", "steady_displacement", twin="gross_{}"),
    *_of(gross_slip, under_punch, "initial_pressure", "steady_pressure", twin="gross_{}"),
    *_of(fretting, under_punch, "initial_pressure"),
    *_of(gross_slip, lambda *given: (exponents(*given),), "volume_change", "force_ratio", "force_drop"),
    *_of(material, k_nu, "h_N", "tangential_ratio"),
    *_of(partial_slip, k_phi_and_rig, "displacement_amplitude", "contact_share"),
    *_of(partial_slip, k_phi_and_rig, "amplitude", twin="force_amplitude"),
    *_of(partial_slip, in_slip, "slip_amplitude", **_NEAR),
    *_of(partial_slip, k_phi, "energy_per_cycle", "energy_ratio", "loop_aperture"),
    Quantity("FrettingContact.wear_volume", wear_volume_in_si, dome, "wear_volume_in_si", **_SI),
)

# By dtype and region, and for some quantities by their names, dtype and region.
PROMISED, SHORT = (
    {tuple(key.split(", ")): kept for key, kept in rows.items()} for rows in data("reference/accuracy.toml").values()
)


@dataclasses.dataclass(frozen=True)
class Worst:
    """The worst error of one order of derivative of one quantity in one region."""

    quantity: str
    region: str
    dtype: str
    order: int
    error: float
    promised: float
    kept: float  # what is kept where the promise is not
    point: tuple[float, ...]
    points: int

    def __str__(self):
        what = ("value", "1st derivative", "2nd derivative")[self.order]
        at = ", ".join(f"{x:.17g}" for x in self.point)
        mark = "" if self.error <= self.promised else "   <-- short" if self.error <= self.kept else "   <-- broken"
        return (
            f"{self.quantity:36} {self.region:10} {self.dtype:7} {what:14} {self.error:8.1e} of {self.promised:.0e}"
            f"  ({self.points} points)  at ({at}){mark}"
        )


def measure(quantity, region, dtype, count, seed, processes=1, order=2):
    """Worst errors of a quantity and its derivatives, up to an order, at `count` fresh points of a region."""
    rng = np.random.default_rng([seed, *quantity.oracle.encode(), *region.encode()])
    # Half as many again, since some are dropped.
    points = _representable(quantity, quantity.sampler(rng, 3 * count // 2 + 16, region), dtype)
    points = tuple(x[:count] for x in points)
    promised = PROMISED[dtype, region]
    kept = SHORT.get((quantity.name, dtype, region), promised)
    order = min(order, quantity.order, len(promised) - 1)
    near = region in NEAR
    at = np.stack(points, 1).astype(float).tolist()
    exact = oracle.map_points(quantity.oracle, at, processes, order=max(order, 1))  # near an edge a value needs a slope

    worst = []
    measured = np.array([name not in quantity.with_unit for name in quantity.arguments], float)  # by the value
    value = np.array([point.value for point in exact])
    size = np.abs(value[:, 0])
    computed = _derivatives(quantity, points, order)
    for n, mine in enumerate(computed):
        rows = [_flat(point, n) for point in exact]
        theirs = np.array(rows).reshape(len(rows), -1, 2)
        error = np.abs((mine.astype(float) - theirs[..., 0]) - theirs[..., 1])
        if near:
            slope = np.array([point.gradient[0] for point in exact])[:, 0]
            error = np.maximum(error - 4.0 * np.abs(slope[:, None]) * np.spacing(points[0])[:, None], 0.0)
        # Where the dtype has no normal number for the result, there is nothing to compare.
        scale = np.maximum(np.abs(theirs[..., 0]), size[:, None] * (measured if n == 1 else 1.0))
        relative = np.where(scale < np.finfo(dtype).tiny, 0.0, error / np.where(scale > 0.0, scale, 1.0))
        relative = np.where(np.isfinite(mine), relative, np.inf)
        if n and quantity.derivatives_from:
            edge = (1.0 - points[2]) ** (1.0 / (points[1] + 3.0)) if len(points) == 3 else 1.0
            relative = np.where((np.abs(points[0] / edge - 1.0) < quantity.derivatives_from)[:, None], 0.0, relative)
        at = int(np.argmax(relative.max(axis=1)))
        error, point = float(relative.max()), tuple(float(x[at]) for x in points)
        worst.append(Worst(quantity.name, region, dtype, n, error, promised[n], kept[n], point, len(value)))
    return worst


def _representable(quantity, points, dtype):
    """The points in a dtype, without those it cannot tell from an edge: k = +-1, phi = 1, r = c, r = a_inf."""
    rounded, edges = np.stack([x.astype(dtype) for x in points]), {"k": 1.0, "phi": 1.0, "displacement": 1.0, "nu": 0.5}
    names, eps = list(quantity.arguments), np.finfo(dtype).eps
    inside = [abs(x) < edges[name] for name, x in zip(names, rounded, strict=True) if name in edges]
    rounded = rounded[:, np.all(inside, axis=0)]
    if names[0] not in ("r", "distance"):
        return tuple(rounded)
    place, *slip = rounded.astype(float)
    if names[0] == "distance":
        kept = np.abs(place / np.asarray(functions.fretting.stick_radius(*slip)) - 1.0) > 32.0 * eps
    else:
        radii = functions.fretting.stick_radius, functions.fretting.worn_radius
        at = [np.asarray(radius(*slip)) for radius in radii] if "phi" in names else [1.0]
        kept = np.all([np.abs(place - edge) > 32.0 * np.spacing(rounded[0]) for edge in at], axis=0)
    return tuple(rounded[:, kept])


def _derivatives(quantity, points, order):
    """[value, gradient, hessian] up to `order`, the last axis over their entries."""
    if quantity.name not in functions.FUNCTIONS:
        return list(functions.in_rounds(_with_gradient(quantity), *points))[: order + 1]
    made = [functions.values(quantity.name, *points)[:, None]]
    if order > 0:
        made.append(functions.derivatives(quantity.name, *points)[2])
    if order > 1:
        made.append(functions.hessians(quantity.name, *points).reshape(len(points[0]), -1))
    return made


@functools.cache
def _with_gradient(quantity):
    """One program for a quantity that is no public function."""

    def point(*at):
        value, slopes = functions.with_gradient(quantity.function, *at)
        return value[:, None], jnp.stack(slopes, -1)

    return functions.by_numpy(point)


def _flat(point, order):
    if order == 0:
        return [point.value]
    return point.gradient if order == 1 else [entry for row in point.hessian for entry in row]
