"""The worn ring divided into cells, and the numbers of cells and steps that a number of digits needs."""

import functools
from typing import NamedTuple

import numpy as np
from jax import Array

from plgwear_jax._core.domains import whole
from plgwear_jax._core.xla import materialised
from plgwear_jax.special.elementary import clamped, in_dtype


class MarchResolution(NamedTuple):
    """Numbers of cells and steps of a run. It has several marches, each with a multiple of the same cells and steps."""

    inner: int  # cells of the unworn ring, c < r < a_0
    outer: int  # cells beyond a_0 that the edge of the contact passes, one in each step
    length: float  # -log of the share of the ring's growth that is left after the last step
    refinements: tuple[int, ...]  # increasing, so that the finest march is the last one

    @property
    def cells(self) -> int:
        """Cells of the finest march."""
        return (self.inner + self.outer + _BEYOND) * self.refinements[-1]

    @property
    def steps(self) -> int:
        """Steps of the finest march."""
        return self.outer * self.refinements[-1]


_BEYOND = 2  # cells that the edge of the contact does not reach

# For each number of digits the fewest cells by measured errors, the worst over k, phi, n: docs/explanation/numerics.md.
RESOLUTIONS = {
    2: MarchResolution(8, 12, 4.5, (1, 2)),
    3: MarchResolution(8, 12, 4.5, (1, 2, 3)),
    4: MarchResolution(8, 18, 4.7, (1, 2, 3)),
    5: MarchResolution(12, 32, 7.0, (2, 3, 4, 6)),
}


def march_resolution_of(digits: int | None) -> MarchResolution:
    """Cells and steps for a number of digits; by default for 4."""
    known = whole("digits", 4 if digits is None else digits, 1, max(RESOLUTIONS), " of wear over cycles")
    return RESOLUTIONS[max(known, min(RESOLUTIONS))]


@functools.cache
def _places_of_edges(resolution: MarchResolution) -> tuple[np.ndarray, np.ndarray]:
    """Places of the cell edges, one row per march: (0 to 1 over the unworn ring, share of the ring's growth beyond it).

    The growth begins as a square and ends as an exponential, so that the steps in n have about the same length.
    """
    edge, multiple = np.arange(resolution.cells + 1.0), np.array(resolution.refinements)[:, None]
    inner, outer = resolution.inner * multiple, resolution.outer * multiple
    last = (resolution.outer + _BEYOND) / resolution.outer
    v = np.clip((edge - inner) / outer, 0.0, last)
    growth = np.expm1(-resolution.length * v * v) / np.expm1(-resolution.length * last * last)
    return np.minimum(edge / inner, 1.0), growth


class Scales(NamedTuple):
    """The units of a run."""

    final: Array  # final volume
    unit: Array  # unit of n: the final volume over the first wear rate
    inner: Array  # C = c^2
    width: Array  # final width of the ring, in C


def edges_of(unworn: Array, grown: Array, resolution: MarchResolution) -> tuple[Array, Array]:
    """The edges of the cells of each march, T/C - 1 and (T - 1)/C, (marches, cells + 1).

    Coarser marches end with empty cells, so that all marches have the same number.

    Args:
        unworn: Width of the unworn ring, in C.
        grown: Width of the final ring less that of the unworn ring, in C.
        resolution: Numbers of cells and steps.
    """
    # Where the ring hardly grows, the unworn cells at its edge have to be smaller as well.
    near = grown * (10.0 * resolution.length * resolution.inner**2 / resolution.outer**2) / unworn
    # Materialised, or each element of the arrays below would compute it again.
    near = materialised(clamped(0.3, near, 1.0))
    place, growth = in_dtype(grown.dtype, *_places_of_edges(resolution))
    begin, end = place**3, near * (1.0 - place) ** 2
    grown, whole = grown * growth, begin + end
    return unworn * begin / whole + grown, grown - unworn * end / whole


def weights(resolution: MarchResolution, order: int) -> np.ndarray:
    """Weights of the marches in the extrapolation, if errors are power series in the cell size from `order` on."""
    powers = np.append(0.0, order + np.arange(len(resolution.refinements) - 1.0))
    return np.linalg.inv(np.array(resolution.refinements)[:, None] ** -powers)[0]
