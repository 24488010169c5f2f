"""Which limits of a design cannot be kept together, and what can be reached instead."""

import functools
from collections.abc import Sequence

import numpy as np

from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._core.record import record
from plgwear_jax.optimise.designing import Design
from plgwear_jax.optimise.evaluation import Told, search
from plgwear_jax.optimise.minimum import Minimum
from plgwear_jax.optimise.problem import keeps, limited, limits_by_name

__all__ = ["Conflict", "conflict"]


@record
class Conflict:
    """Limits that no design within the bounds keeps together. Without any one of them the others can be kept.

    Attributes:
        allowed: These limits in SI units, by the names of `Design.limits`.
        reachable: For each of them the best value while the others are kept: the largest if its name ends in "_lowest",
            else the least.
    """

    allowed: dict[str, float]
    reachable: dict[str, float]


@for_numbers("optimise.designs works there for contacts with closed forms")
def conflict(found: Design) -> Conflict | None:
    """Why no design keeps the limits, by the programs that the design has compiled.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `design`.

    Returns:
        Limits that cannot be kept together, as few as possible, and what is reachable; None if the design keeps its
        limits, or none of these searches finds why it could not.

    Example:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> limits = optimise.Limits(contact_radius=(9e-5, None), penetration=1e-6)
        >>> best = optimise.design(contact, 1.0, {"k": (-0.5, 0.5), "E0": (50e9, 200e9)}, limits=limits)
        >>> why = optimise.conflict(best)
        >>> print(", ".join(why.allowed), f"{why.reachable['penetration']:.2e} m")
        contact_radius_lowest, penetration 1.09e-06 m
    """
    limits = limits_by_name(found.question.limits)
    if found.keeps_limits or not limits:
        return None
    names, known = list(limits), {}

    def nearest(name: str, others: Sequence[str]) -> Minimum:
        """The design that breaks one limit the least, or keeps it the best, while it keeps others."""
        kept = [names.index(other) for other in others]
        return search(found.question, functools.partial(_least_excess, names.index(name), kept), known)

    def can_be_kept(together: Sequence[str]) -> bool:
        first, *others = together
        at = nearest(first, others)
        return keeps(np.append(at.limits, at.value))

    if can_be_kept(names):
        return None
    guilty = names
    for name in names:
        others = [other for other in guilty if other != name]
        if others and not can_be_kept(others):
            guilty = others
    allowed = {name: float(np.asarray(limits[name])) for name in guilty}
    reachable = {}
    for name in guilty:
        excess = float(nearest(name, [other for other in guilty if other != name]).value)
        reachable[name] = allowed[name] * float(np.exp(-excess if limited(name)[1] else excess))
    return Conflict(allowed, reachable)


_FAR_OFF = -1.0  # log(value/limit) of a limit that has no effect


def _least_excess(row: int, kept: list[int], values: np.ndarray, slopes: np.ndarray) -> Told:
    """log(value/limit) of one limit instead of the wear, and only some of the others."""
    values[:, 0], slopes[:, 0] = values[:, 1 + row], slopes[:, 1 + row]
    left_out = [1 + other for other in range(values.shape[1] - 1) if other not in kept]
    values[:, left_out], slopes[:, left_out] = _FAR_OFF, 0.0
    return values, slopes
