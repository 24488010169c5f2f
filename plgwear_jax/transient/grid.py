"""The worn ring divided into cells, and the numbers of cells and steps that a number of digits needs."""

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


class MarchEffort(NamedTuple):
    """Numbers of cells and steps of a run. It has several marches, each with a multiple of the same cells and steps."""

    inner: int  # cells of the unworn ring, c < r < a_0
    outer: int  # cells beyond a_0 that the edge of the contact passes, one in each step
    length: float  # -log of the share of the ring's growth that is left after the last step
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

# For each number of digits the fewest cells by measured errors, the worst over k, phi, n: docs/explanation/numerics.md.
EFFORTS = {
    2: MarchEffort(8, 12, 4.5, (1, 2)),
    3: MarchEffort(8, 12, 4.5, (1, 2, 3)),
    4: MarchEffort(8, 18, 4.7, (1, 2, 3)),
    5: MarchEffort(12, 32, 7.0, (2, 3, 4, 6)),
}


def march_effort_of(digits: int | None) -> MarchEffort:
    """Cells and steps for a number of digits; by default for 4."""
    most = max(EFFORTS)
    if digits is not None and digits > most:
        raise ValueError(f"digits = {digits} is outside the allowed range 1 <= digits <= {most} of wear over cycles")
    return EFFORTS[max(4 if digits is None else digits, min(EFFORTS))]


@functools.cache
def _places(effort: MarchEffort) -> tuple[np.ndarray, np.ndarray]:
    """Places of the cell edges, one row per march: (0 to 1 over the unworn ring, share of the ring's growth beyond it).

    The growth begins as a square and ends as an exponential, so that the steps in n have about the same length.
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


class RingCells(NamedTuple):
    """The worn ring in cells, as the march needs it, in units in which the wear rate and time are of order one."""

    compliance: Array  # A over the unit of time, integrated over the two cells of each entry
    gap: Array  # g integrated over each cell
    steady: Array  # H integrated over each cell
    first: Array  # mean of p_0 over each cell, times the unit of time
    swept: Array  # Q/s integrated over each cell
    edges: Array  # T/C - 1 at the edges of the cells


class Scales(NamedTuple):
    """The units of a run."""

    volume: Array  # final volume
    unit: Array  # unit of n: the final volume over the first wear rate
    inner: Array  # C = c^2
    width: Array  # final width of the ring, in C


class RingParameters(NamedTuple):
    """The parameters of a power law's ring, from which its cells are computed. Widths are differences of T = r^2."""

    s: Array
    q: Array
    inner: Array  # C
    powered: Array  # C^s
    unworn: Array  # width of the unworn ring, in C
    grown: Array  # width of the final ring less that of the unworn ring, in C
    slip: Array  # s Lambda
    sine: Array  # sigma/(s q)


def ring_parameters(k: Array, phi: Array) -> RingParameters:
    """The parameters of the ring for one pair of k and phi > 0."""
    s, q = exponents(k)
    log_c = log_complement(phi) / (1.0 + s)
    digits = min(8, int(jnp.finfo(k.dtype).precision))
    unworn, width = jnp.expm1(-log_c), ring_edge(s, q, phi, digits, digits)
    grown = jnp.maximum(width - unworn, 16.0 * jnp.finfo(k.dtype).eps * unworn)
    # sigma/(s q) and sigma^2/(q^2 kappa) = sine^2/(2 (1+s)) are finite also as k -> -1 and k -> 1.
    return RingParameters(s, q, jnp.exp(log_c), jnp.exp(s * log_c), unworn, grown, slip(s, phi), sine_quotient(s, q))


def cells_of(from_c: Array, from_1: Array, at: RingParameters) -> tuple[RingCells, Array]:
    """(The ring in cells, the frictional work of the first cycle over C^(s+2)), for edges T/C - 1 and (T - 1)/C."""
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
    return RingCells(2.0 * compliance, gap, at.slip * swept - gap, first, swept, from_c), work


def edges_of(unworn: Array, grown: Array, effort: MarchEffort) -> tuple[Array, Array]:
    """The edges of the cells of each march, T/C - 1 and (T - 1)/C, (marches, cells + 1).

    Coarser marches end with empty cells, so that all marches have the same number.

    Args:
        unworn: Width of the unworn ring, in C.
        grown: Width of the final ring less that of the unworn ring, in C.
        effort: Numbers of cells and steps.
    """
    # Where the ring hardly grows, the unworn cells at its edge have to be smaller as well.
    near = jnp.clip(grown * (10.0 * effort.length * effort.inner**2 / effort.outer**2) / unworn, 0.3, 1.0)
    # Materialised, or each element of the arrays below would compute it again.
    near = materialised(near, grown)
    place, growth = (jnp.asarray(x, grown.dtype) for x in _places(effort))
    begin, end = place**3, near * (1.0 - place) ** 2
    from_c = unworn * begin / (begin + end) + grown * growth
    return from_c, grown * growth - unworn * end / (begin + end)


def rings_of(k: Array, phi: Array, effort: MarchEffort) -> tuple[RingCells, Scales]:
    """(The ring in the cells of each march, its units)."""
    numbers = ring_parameters(k, phi)
    numbers = RingParameters(*jnp.unstack(materialised(jnp.stack(numbers), k)))
    edges = edges_of(numbers.unworn, numbers.grown, effort)
    ring, work = jax.vmap(lambda from_c, from_1: cells_of(from_c, from_1, numbers))(*edges)
    return in_units(ring, work, int(np.argmax(effort.multiples)), numbers)


def in_units(ring: RingCells, work: Array, finest: int, at: RingParameters) -> tuple[RingCells, Scales]:
    """(The ring in the cells of each march with time in `Scales.unit`, the units by the finest march)."""
    total = jnp.sum(ring.steady[finest])
    unit = total / ((1.0 + at.s) * at.powered * work[finest])
    time = at.powered * unit
    ring = ring._replace(compliance=ring.compliance / time, first=ring.first * time)
    return ring, Scales(0.5 * jnp.pi * at.inner * at.inner * total, unit, at.inner, at.unworn + at.grown)
