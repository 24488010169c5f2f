"""Rates of wear from the cells of the marches themselves, before anything is extrapolated or read between cells."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from transient_oracle import rate_by_energy

from plgwear_jax.wear.closed_ring import rings_of
from plgwear_jax.wear.ring_cells import RESOLUTIONS, weights
from plgwear_jax.wear.ring_march import marches_of


class Rates(NamedTuple):
    """dV/dn where all marches of a run meet."""

    by_pressure: np.ndarray  # the sum of p (g + h) over the cells, (marches, places)
    by_energy: np.ndarray  # by the energy of the same pressures
    n: np.ndarray  # the times in the limit of small cells, (places,)
    extrapolated: np.ndarray  # the energies in that limit, (places,)


def rates_of_marches(k: float, phi: float, digits: int, places: int = 6) -> Rates:
    """The rates of one run at some of the steps that all its marches share, from the first to the last."""
    resolution = RESOLUTIONS[digits]
    ring, scales = rings_of(resolution, jnp.asarray(k), jnp.asarray(phi))
    march = jax.tree.map(np.asarray, jax.jit(marches_of, static_argnums=1)(ring, resolution))
    ring, unit, inner = jax.tree.map(np.asarray, ring), float(scales.unit), float(scales.inner)
    at = np.unique(np.linspace(1, resolution.outer, places).astype(int))
    found, first = [], 0
    for i, multiple in enumerate(resolution.refinements):
        rows = first + at * multiple - 1
        first += resolution.outer * multiple
        cells = int(np.sum(np.diff(ring.edges[i]) > 0.0))
        edges, gap = inner * (1.0 + ring.edges[i, : cells + 1]), 0.5 * inner * inner * ring.gap[i, :cells]
        pressures = march.pressure[rows, :cells] / unit
        by_pressure = np.pi * np.sum(pressures * gap * np.exp(march.worn[rows, :cells]), axis=-1)
        by_energy = [rate_by_energy(k, phi, edges, pressure) for pressure in pressures]
        found.append([by_pressure, np.array(by_energy), unit * march.time[rows]])
    by_pressure, by_energy, n = np.moveaxis(np.array(found), 0, 1)
    limit = weights(resolution, 2)
    return Rates(by_pressure, by_energy, limit @ n, limit @ by_energy)
