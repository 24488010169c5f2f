"""The worn ring in cells, and how many cells and steps a number of digits takes."""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._cells import images_of, products_of, sizes_of
from plgwear_jax._punch import exponents
from plgwear_jax.fretting.ring import ring_edge
from plgwear_jax.fretting.stick import slip
from plgwear_jax.special.elementary import log_complement, sine_quotient
from plgwear_jax.special.xla import materialised

__all__ = [
    "Effort",
    "Numbers",
    "Ring",
    "Scales",
    "cells_of",
    "edges_of",
    "effort_of",
    "in_units",
    "numbers_of",
    "one_in_units",
    "rings_of",
]


class Effort(NamedTuple):
    """How finely a run is divided. It has several marches, each with a multiple of the same cells and steps."""

    inner: int  # cells of the unworn ring, c < r < a_0
    outer: int  # cells beyond a_0 that the edge of the contact passes, one in a step
    length: float  # minus the logarithm of the share of the growth that is left after the last step
    multiples: tuple[int, ...]

    @property
    def cells(self) -> int:
        """Cells of the finest march."""
        return (self.inner + self.outer + _BEYOND) * max(self.multiples)

    @property
    def steps(self) -> int:
        """Steps of the finest march."""
        return self.outer * max(self.multiples)


_BEYOND = 2  # cells that the edge of the contact does not reach

# Measured, worst of all k, phi and n: docs/theory.md.
EFFORTS = {
    2: Effort(8, 12, 4.5, (1, 2)),
    3: Effort(8, 12, 4.5, (1, 2, 3)),
    4: Effort(8, 18, 4.7, (1, 2, 3)),
    5: Effort(12, 32, 7.0, (2, 3, 4, 6)),
}


def effort_of(digits: int | None) -> Effort:
    """Cells and steps for these digits; 4 by default."""
    most = max(EFFORTS)
    if digits is not None and digits > most:
        raise ValueError(f"digits = {digits} is outside the allowed range 1 <= digits <= {most} of wear over cycles")
    return EFFORTS[max(4 if digits is None else digits, min(EFFORTS))]


@functools.cache
def _places(effort: Effort) -> tuple[np.ndarray, np.ndarray]:
    """Of the edges of the cells, a row a march: (from 0 to 1 over the unworn ring, share of the growth beyond it).

    The growth begins as a square and ends as an exponential, so that the steps in n become of about one length.
    """
    place, growth = np.ones((2, len(effort.multiples), effort.cells + 1))
    last = 1.0 + _BEYOND / effort.outer
    for i, multiple in enumerate(effort.multiples):
        inner, count = effort.inner * multiple, (effort.outer + _BEYOND) * multiple
        v = np.linspace(0.0, last, count + 1)
        place[i, : inner + 1] = np.linspace(0.0, 1.0, inner + 1)
        growth[i, : inner + 1] = 0.0
        growth[i, inner : inner + count + 1] = np.expm1(-effort.length * v * v) / np.expm1(-effort.length * last**2)
    return place, growth


class Ring(NamedTuple):
    """The worn ring in cells: what the march needs of it, in units in which the rate and time are of order one."""

    compliance: Array  # A over the unit of time, integrated over both cells
    gap: Array  # g integrated over each cell
    steady: Array  # H integrated over each cell
    first: Array  # p_0 times the unit of time, the mean over each cell
    swept: Array  # Q/s integrated over each cell
    edges: Array  # T/C - 1 at the edges of the cells


class Scales(NamedTuple):
    """The units of a run."""

    volume: Array  # the final one
    unit: Array  # of n: the final volume over the first rate
    inner: Array  # C
    width: Array  # of the ring, in C


class Numbers(NamedTuple):
    """What the cells of a ring are computed from."""

    s: Array
    q: Array
    inner: Array  # C
    powered: Array  # C^s
    unworn: Array  # width of the unworn ring, in C
    grown: Array  # by how much the final one is wider
    slip: Array  # s Lambda
    sine: Array  # sigma/(s q)


def numbers_of(k: Array, phi: Array) -> Numbers:
    """The numbers for one pair of k and phi > 0."""
    s, q = exponents(k)
    log_c = log_complement(phi) / (1.0 + s)
    digits = min(8, int(jnp.finfo(k.dtype).precision))
    unworn, width = jnp.expm1(-log_c), ring_edge(s, q, phi, digits, digits)
    grown = jnp.maximum(width - unworn, 16.0 * jnp.finfo(k.dtype).eps * unworn)
    # sigma/(s q) and sigma^2/(q^2 kappa) = sine^2/(2 (1+s)) are regular at both ends.
    return Numbers(s, q, jnp.exp(log_c), jnp.exp(s * log_c), unworn, grown, slip(s, phi), sine_quotient(s, q))


def cells_of(from_c: Array, from_1: Array, at: Numbers) -> tuple[Ring, Array]:
    """(The ring in cells, the first work over C^(s+2)) with these edges, T/C - 1 and (T - 1)/C."""
    s, q, unworn = at.s, at.q, at.unworn
    size, (t, share, weight) = sizes_of(from_c, from_1, unworn), images_of(from_c, from_1, unworn, s, q)
    swept, gap = (share @ jnp.stack([weight, weight * t], -1)).T * at.sine
    of_ring = products_of(share, weight) * (at.sine * at.sine / (2.0 * (1.0 + s)))
    compliance = of_ring + (0.5 * s / (1.0 + s)) * swept[:, None] * swept[None, :]
    # The integral of T^(s-1) (1-T) (T-C) over the unworn ring, over C^(s+2).
    work = jnp.sum(weight * t * jnp.maximum(unworn - t, 0.0))
    load = jnp.maximum(-from_1, 0.0)
    load = jnp.where(load > 0.0, jnp.exp((1.0 + s) * jnp.log(jnp.where(load > 0.0, load, 1.0))), 0.0)
    first = jnp.where(size > 0.0, -jnp.diff(load) / jnp.where(size > 0.0, size, 1.0), 0.0)
    # Depths over C/2, areas over C, pressures over C^s.
    return Ring(2.0 * compliance, gap, at.slip * swept - gap, first, swept, from_c), work


def edges_of(unworn: Array, grown: Array, effort: Effort) -> tuple[Array, Array]:
    """The edges of the cells of each march, T/C - 1 and (T - 1)/C, (marches, cells + 1).

    All marches are filled up with empty cells to one length.

    Args:
        unworn: Width of the unworn ring, in C.
        grown: By how much the final one is wider.
        effort: How finely it is divided.
    """
    # Where the ring hardly grows, the unworn cells at its edge have to be smaller as well.
    near = jnp.clip(grown * (10.0 * effort.length * effort.inner**2 / effort.outer**2) / unworn, 0.3, 1.0)
    # Materialised, or each element of the arrays below would compute it again.
    near = materialised(near, grown)
    place, growth = (jnp.asarray(x, grown.dtype) for x in _places(effort))
    begin, end = place**3, near * (1.0 - place) ** 2
    from_c = unworn * begin / (begin + end) + grown * growth
    return from_c, grown * growth - unworn * end / (begin + end)


def rings_of(k: Array, phi: Array, effort: Effort) -> tuple[Ring, Scales]:
    """The ring of the final contact in the cells of each march."""
    numbers = numbers_of(k, phi)
    numbers = Numbers(*jnp.unstack(materialised(jnp.stack(numbers), k)))
    edges = edges_of(numbers.unworn, numbers.grown, effort)
    ring, work = jax.vmap(lambda from_c, from_1: cells_of(from_c, from_1, numbers))(*edges)
    return in_units(ring, work, int(np.argmax(effort.multiples)), numbers)


def in_units(ring: Ring, work: Array, finest: int, at: Numbers) -> tuple[Ring, Scales]:
    """The rings of some marches with time in its unit, and the units, by the finest of them."""
    total = jnp.sum(ring.steady[finest])
    unit = total / ((1.0 + at.s) * at.powered * work[finest])
    time = at.powered * unit
    ring = ring._replace(compliance=ring.compliance / time, first=ring.first * time)
    return ring, Scales(0.5 * jnp.pi * at.inner * at.inner * total, unit, at.inner, at.unworn + at.grown)


def one_in_units(edges: tuple[Array, Array], at: Numbers) -> tuple[Ring, Scales]:
    """A single ring with these edges, T/C - 1 and (T - 1)/C, with time in its unit."""
    ring, work = cells_of(*edges, at)
    ring, scales = in_units(jax.tree.map(lambda x: x[None], ring), work[None], 0, at)
    return jax.tree.map(lambda x: x[0], ring), scales
