"""A design for a life beside the best one for ever."""

import dataclasses
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax import transient
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._startup.programs import program
from plgwear_jax.contact import reduced_cycles
from plgwear_jax.optimise.designing import Design, answered
from plgwear_jax.optimise.evaluation import concrete
from plgwear_jax.optimise.problem import Load, Question

__all__ = ["ForEver", "for_ever", "without_end"]


class ForEver(NamedTuple):
    """What a design for a life does for ever, beside the design that wears least for ever.

    Attributes:
        best: The best design for the steady state, under the same limits.
        volume: The volume in m^3 that the design for a life wears until the steady state.
        reference_volume: The same of the reference.
        best_by_then: The volume in m^3 that `best` wears in the life.
        flips_at: After so many lives both have worn the same, and beyond it `best` wears less; None if they are the
            same, or the design for a life wears no more for ever.
    """

    best: Design
    volume: float
    reference_volume: float
    best_by_then: float
    flips_at: float | None


_LIVES = np.concatenate([[1.0], np.geomspace(1e-3, 1e5, 383)])  # at which both are compared
_SAME = 2e-3  # of the volume: the digits of the wear over cycles


def without_end(question: Question) -> Question:
    """The same question for the steady state."""
    assert question.load is not None
    return dataclasses.replace(question, load=dataclasses.replace(question.load, life=None))


@for_numbers("optimise.designs works there for contacts with closed forms")
def for_ever(found: Design) -> ForEver:
    """Compare a design for a life with the best one for ever.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `design` with `cycles`.

    Returns:
        Both, and after how many lives the choice between them flips.

    Raises:
        ValueError: The design is one for the steady state.
    """
    if found.load is None or found.load.life is None:
        raise ValueError("for_ever takes a design for a number of cycles; this one is for the steady state")
    best = answered(without_end(found.question))
    contacts = found.contact, best.contact, found.question.contact
    three = jax.tree.map(lambda *x: np.stack(x), *map(concrete, contacts))
    told = jax.device_get(_curves(three, concrete(found.load), concrete(_LIVES)))
    (ours, theirs), (volume, _, reference) = told.worn, told.steady
    flips_at = _crossing(_LIVES[1:], ours[1:] / theirs[1:] - 1.0)
    return ForEver(best, float(volume), float(reference), float(theirs[0]), flips_at)


class _Curves(NamedTuple):
    worn: Array  # by the design for a life and by the best for ever after some lives, (2, n)
    steady: Array  # by both and by the reference until the steady state, (3,)


@program()
def _curves(three: Any, load: Load, lives: Array) -> _Curves:  # a FrettingContact of three
    phi = load.tangential_force / (three.friction[:2, None] * three.normal_force[:2, None])
    n = reduced_cycles(three, load.life)[:2, None, None] * lives
    each = transient.wear_volume(three.material.k[:2, None, None], phi[..., None], n)
    unit = (three.contact_radius() ** 4 / three.radius)[:2, None]
    single = jax.tree.map(lambda field: field[:, None], three)
    steady = single.wear_volume(load.tangential_force)
    return _Curves(unit * jnp.einsum("j,ijn->in", load.weight, each), steady @ load.weight)


def _crossing(lives: np.ndarray, more: np.ndarray) -> float | None:
    """Where the share by which the one wears more than the other becomes positive for good."""
    if not more[-1] > _SAME:
        return None
    (below,) = np.nonzero(more < 0.0)
    if not below.size:
        return None
    i = below[-1]
    part = more[i] / (more[i] - more[i + 1])
    return float(lives[i] * (lives[i + 1] / lives[i]) ** part)
