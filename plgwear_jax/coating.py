"""A measured or layered E(z) as a power law: the best exponent, and what the idealisation does to a contact."""

import dataclasses
import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import NUMBER, POISSON_RATIO, POSITIVE, ArrayLike, check, concrete_only, nan_outside
from plgwear_jax._core.doubts import FELT
from plgwear_jax._core.startup.programs import program
from plgwear_jax.contact import FrettingContact
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.surfaces import DepthGraded, Layered

__all__ = [
    "FELT",
    "Idealisation",
    "PowerLawFit",
    "felt",
    "fit_power_law",
    "idealised",
    "studied",
    "where_it_counts",
    "worn",
]

_LEVEL = 0.95  # of confidence
_FAR = 0.5  # least share of the stiffness within `FELT` that the depths of a table must cover
_ROUGH = 0.1  # standard deviation of log(E) about the fit above which the modulus is hardly a power law
_POINTS = 101  # radii in the worn ring
_COUNTED = 19  # depths of `where_it_counts`
_BETWEEN = 3  # depths of the half-space per depth of `where_it_counts`
_QUANTITIES = ("contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume", "deepest_wear")


def felt(relative_depth: ArrayLike, nu: ArrayLike) -> Array:
    """How much of the stiffness of a punch is due to the material above a depth, to first order in changes of E.

    By Gao, Chiu and Lee (1992).

    Args:
        relative_depth: The depth in contact radii, >= 0 and finite.
        nu: Poisson's ratio, -1 < nu <= 1/2.

    Returns:
        The share, from 0 at the surface to 1.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import coating
        >>> print(f"{coating.felt(1.0, 0.3):.3f}")  # what lies above one contact radius
        0.449

    References:
        Gao, Chiu and Lee, International Journal of Solids and Structures 29 (1992) 2471.
    """
    x = jnp.asarray(nan_outside("relative_depth", relative_depth, NUMBER), float)
    nu = nan_outside("nu", nu, POISSON_RATIO)
    shear = x * (jnp.log1p(x * x) - 2.0 * jnp.log(jnp.where(x > 0.0, x, 1.0)))
    return 2.0 / jnp.pi * jnp.arctan(x) + ((1.0 - 2.0 * nu) * shear - x / (1.0 + x * x)) / (2.0 * jnp.pi * (1.0 - nu))


@dataclasses.dataclass(frozen=True)
class PowerLawFit:
    """The power law E(z) = E0 (z/z0)^k that fits moduli at some depths best.

    Attributes:
        material: The half-space of this power law.
        covariance: Covariance of k and log(E0), shape (2, 2), from the scatter about the fit; NaN for two points.
        exponent_interval: The confidence interval of 95 % of k.
        modulus_interval: The confidence interval of 95 % of E0 in Pa, the modulus at the depth z0.
        depth: All depths in m, shape (n,).
        modulus: The moduli there in Pa, shape (n,).
        fitted: Moduli of the power law at all depths in Pa, shape (n,); 0 or infinite at the depth 0.
        weight: Weight of each point in the fit, shape (n,), >= 0, with the sum 1.
        scatter: The standard deviation of log(E) about the fit, of the points with a weight.
        felt: The depths in m between which the modulus influences the contact: `FELT` times the contact radius.
        covered: The share of this range that the depths cover, measured by the stiffness of a punch.
        doubt: A reason to doubt the fit, in a line; None if there is none.
    """

    material: PowerLawGraded
    covariance: np.ndarray
    exponent_interval: tuple[float, float]
    modulus_interval: tuple[float, float]
    depth: np.ndarray
    modulus: np.ndarray
    fitted: np.ndarray
    weight: np.ndarray
    scatter: float
    felt: tuple[float, float]
    covered: float
    doubt: str | None


@concrete_only("coating.felt works there")
def fit_power_law(depth: ArrayLike, modulus: ArrayLike, nu: float, contact_radius: float) -> PowerLawFit:
    """Fit a power law to moduli at some depths: a straight line to log(E) over log(z), by weighted least squares.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Each point represents the depths nearer to it than to others, on a logarithmic scale, within 0.1 to 3 contact radii
    and within the table. Its weight is the share of these depths in the stiffness of a punch (`felt`). So it does not
    matter where in the table the depths are dense.

    Args:
        depth: Depths in m, shape (n,), >= 0, increasing.
        modulus: Young's modulus there in Pa, shape (n,), positive. An indentation modulus is a mean over depths, not
            that at one.
        nu: Poisson's ratio.
        contact_radius: The contact radius in m, at which depth E0 is the modulus: a free choice.

    Returns:
        The power law, with its confidence from Student's distribution, as if the points scattered independently.

    Raises:
        ValueError: An argument is outside its range, fewer than two points count, or k is not between -1 and 1.

    Examples:
        >>> from plgwear_jax import coating
        >>> depth, modulus = [1e-5, 1e-4, 1e-3], [5e10, 1e11, 2e11]
        >>> fit = coating.fit_power_law(depth, modulus, 0.3, contact_radius=1e-4)
        >>> print(f"{fit.material.k:.3f}, {fit.material.E0:.3g} Pa")
        0.301, 1e+11 Pa

    References:
        The weights: Gao, Chiu and Lee, International Journal of Solids and Structures 29 (1992) 2471.
    """
    from scipy import special

    half_space = DepthGraded(depth, modulus, nu)  # raises an error for wrong arguments
    check("contact_radius", contact_radius, POSITIVE)
    depth, modulus = np.asarray(half_space.depth, float), np.asarray(half_space.modulus, float)
    low, high = FELT[0] * contact_radius, FELT[1] * contact_radius
    weight, covered = _weights_of_depths(depth, nu, contact_radius)
    counts = weight > 0.0
    if counts.sum() < 2:
        number = f"only {counts.sum()} of {depth.size} depths {'lies' if counts.sum() == 1 else 'lie'}"
        text = f"within 0.1 to 3 contact radii, {low:.3g} m to {high:.3g} m; a power law needs two"
        raise ValueError(f"depth: {number} {text}")
    x, y, w = np.log(depth[counts] / contact_radius), np.log(modulus[counts]), weight[counts]
    best, inverse = np.polyfit(x, y, 1, w=np.sqrt(w), cov="unscaled")
    k, log_modulus = map(float, best)
    if not -1.0 < k < 1.0:
        raise ValueError(f"k = {k:.3g} fits best; only -1 < k < 1 is possible: this is no power law, but a layer")
    residual, powers = y - np.polyval(best, x), np.vander(x, 2)
    # The moduli scatter alike at all points, whatever their weights.
    spread = inverse @ (powers.T @ ((w * w)[:, None] * powers))
    freedom = counts.sum() - 2
    variance = float(w @ residual**2) / max(1.0 - float(np.trace(spread)), 1e-12) if freedom else math.nan
    covariance = variance * spread @ inverse
    quantile = float(special.stdtrit(freedom, 0.5 + 0.5 * _LEVEL)) if freedom else math.nan
    scatter, reach = math.sqrt(variance), quantile * np.sqrt(np.diag(covariance))
    material = PowerLawGraded(math.exp(log_modulus), contact_radius, k, nu)
    doubt = None
    if covered < _FAR:
        doubt = f"the table covers {100.0 * covered:.0f} % of the depths that count; beyond its ends E is constant"
    elif not freedom:
        doubt = "two points and two unknowns: there is no interval"
    elif scatter > _ROUGH:
        doubt = f"the moduli scatter {100.0 * scatter:.0f} % about the fit: this is hardly a power law"
    with np.errstate(divide="ignore"):
        fitted = math.exp(log_modulus) * (depth / contact_radius) ** k
    return PowerLawFit(
        material=material,
        covariance=covariance,
        exponent_interval=(k - reach[0], k + reach[0]),
        modulus_interval=(math.exp(log_modulus - reach[1]), math.exp(log_modulus + reach[1])),
        depth=depth,
        modulus=modulus,
        fitted=fitted,
        weight=weight,
        scatter=scatter,
        felt=(low, high),
        covered=covered,
        doubt=doubt,
    )


def _weights_of_depths(depth: np.ndarray, nu: float, radius: float) -> tuple[np.ndarray, float]:
    """(Weights of the depths, with the sum 1 unless all are 0; the share of the range `FELT` that they cover)."""

    def parts(edges: np.ndarray) -> np.ndarray:
        """What is between the edges, of the range that counts."""
        return np.diff(felt(np.clip(edges / radius, *FELT), nu))

    weight, below = np.zeros_like(depth), depth > 0.0
    z = depth[below]
    weight[below] = parts(np.concatenate([z[:1], np.sqrt(z[1:] * z[:-1]), z[-1:]]))
    total, ends = weight.sum(), radius * np.array(FELT)
    return (weight / total if total > 0.0 else weight), float((parts(depth[[0, -1]]) / parts(ends))[0])


# --- what the idealisation does -------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Idealisation:
    """A contact on its own half-space, compared with the same contact on a power law.

    Attributes:
        quantities: Contact, stick and worn radius, indentation depth, wear volume and largest wear depth by name,
            each for both, in SI units, shape (2,): first for the half-space as it is, then for the power law.
        radii: Radii from the inner to the outer edge of the worn ring in m, shape (2, points).
        profile: The worn profile there in m, shape (2, points).
        wear_depth: The depth worn off there in m, shape (2, points).
    """

    quantities: dict[str, np.ndarray]
    radii: np.ndarray
    profile: np.ndarray
    wear_depth: np.ndarray

    def error(self, name: str) -> float:
        """The relative error of a quantity on the power law."""
        real, power_law = self.quantities[name]
        return float(power_law / real - 1.0)


@program()
def _compared_quantities(contact: FrettingContact, tangential_force: float) -> dict[str, Array]:
    """All compared quantities of one contact, by name."""
    steady = contact.steady(tangential_force)
    found = {name: jnp.asarray(getattr(steady, name)) for name in _QUANTITIES}
    # The radii are dense at both edges of the ring; outside it nothing is worn.
    share = 0.5 - 0.5 * jnp.cos(jnp.pi * jnp.linspace(0.0, 1.0, _POINTS))
    radii = found["stick_radius"] + (found["worn_radius"] - found["stick_radius"]) * share
    return found | {"radii": radii, "profile": steady.profile(radii), "wear_depth": steady.wear_depth(radii)}


def worn(contact: FrettingContact, tangential_force: float) -> dict[str, np.ndarray]:
    """The compared results of a contact by name: the quantities of an `Idealisation`, radii, profile and wear depth.

    Args:
        contact: Any contact of partial slip.
        tangential_force: The force amplitude in N, 0 <= F_x < mu F_N.

    Raises:
        ValueError: The force amplitude is outside its range.
    """
    contact.steady(tangential_force)  # raises an error for a wrong force, which a program cannot
    return jax.device_get(_compared_quantities(contact, tangential_force))


@concrete_only("coating.worn works there")
def idealised(
    contact: FrettingContact,
    tangential_force: float,
    material: PowerLawGraded,
    as_given: dict[str, np.ndarray] | None = None,
) -> Idealisation:
    """Compare a contact on its own half-space with the same contact on a power law.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact on its own half-space.
        tangential_force: The force amplitude in N, 0 <= F_x < mu F_N.
        material: The power law, such as the result of `fit_power_law`.
        as_given: The result of `worn` for the contact, if it was computed before.

    Returns:
        Both contacts in the steady state.
    """
    instead = worn(dataclasses.replace(contact, material=material), tangential_force)
    found = [worn(contact, tangential_force) if as_given is None else as_given, instead]
    both = {name: np.stack([one[name] for one in found]) for name in found[0]}
    return Idealisation({name: both.pop(name) for name in _QUANTITIES}, **both)


@program()
def _slopes_by_depth(contact: FrettingContact, tangential_force: float, depth: Array, hats: Array) -> Array:
    """d log(wear volume)/d log(E) at some depths, summed with the weights `hats` of shape (points, depths)."""
    half_space: Any = contact.material
    modulus = jnp.log(half_space.modulus_at(depth))

    def log_volume(log_modulus: Array) -> Array:
        material = DepthGraded(depth, jnp.exp(log_modulus), half_space.nu)
        return jnp.log(dataclasses.replace(contact, material=material).steady(tangential_force).wear_volume)

    return hats @ jax.grad(log_volume)(modulus)


@concrete_only("jax.grad of contact.steady(F_x).wear_volume by the moduli works there")
def where_it_counts(
    contact: FrettingContact, tangential_force: float, contact_radius: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """How strongly the modulus at each depth of a half-space influences the wear volume.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: A contact on a `DepthGraded` or a `Layered`; a cubic replaces its modulus between these depths.
        tangential_force: The force amplitude in N, 0 < F_x < mu F_N.
        contact_radius: Its contact radius in m, if it was computed before.

    Returns:
        (Depths in m between 0.01 and 10 contact radii, the change of log(V) there with log(E), per decade of the
        depth), each of shape (19,): 0.3 means that a decade of depths with 1 % more modulus wears 0.3 % more.

    Raises:
        ValueError: An argument is outside its range.
    """
    if not isinstance(contact.material, DepthGraded | Layered):
        raise ValueError(f"contact: its half-space is neither a DepthGraded nor a Layered, but {contact.material!r}")
    check("tangential_force", tangential_force, POSITIVE)
    steady = contact.steady(tangential_force)
    radius = float(steady.contact_radius) if contact_radius is None else contact_radius
    check("contact_radius", radius, POSITIVE)
    decades, step = np.linspace(-2.0, 1.0, _COUNTED, retstep=True)  # log10 of the depths over the contact radius
    fine = np.linspace(-2.0 - step, 1.0 + step, (_COUNTED + 1) * _BETWEEN + 1)
    hats = np.maximum(1.0 - np.abs(fine - decades[:, None]) / step, 0.0)
    slopes = np.asarray(_slopes_by_depth(contact, float(tangential_force), radius * 10.0**fine, hats))
    return radius * 10.0**decades, slopes / step


@concrete_only("coating.worn works there")
def studied(
    contact: FrettingContact, tangential_force: float
) -> tuple[PowerLawFit, tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray], Idealisation]:
    """All that a picture of a measured coating shows: what `plots.coating_picture` takes.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: A contact on a `DepthGraded`, whose depths and moduli are those that were measured.
        tangential_force: The force amplitude in N, 0 < F_x < mu F_N.

    Returns:
        (The result of `fit_power_law`; depths in m and the moduli in Pa there of the half-space as given, each of
        shape (200,); the result of `where_it_counts`; that of `idealised`).

    Raises:
        ValueError: As `fit_power_law`.
    """
    table: Any = contact.material
    as_given = worn(contact, tangential_force)
    radius = float(as_given["contact_radius"])
    fit = fit_power_law(table.depth, table.modulus, float(table.nu), radius)
    depths = np.geomspace(0.01 * radius, 10.0 * radius, 200)
    curve, counts = (depths, np.asarray(table.modulus_at(depths))), where_it_counts(contact, tangential_force, radius)
    return fit, curve, counts, idealised(contact, tangential_force, fit.material, as_given)
