"""The worn ring in cells and the reduced cycles in steps, and how many of both a number of digits takes."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.formula import stored
from plgwear_jax._punch import exponents
from plgwear_jax.fretting.ring import ring_edge
from plgwear_jax.fretting.stick import slip
from plgwear_jax.partial_slip import ring_work
from plgwear_jax.special.arcsine import arc
from plgwear_jax.special.elementary import log_complement, sine_quotient

__all__ = [
    "END",
    "GROWTH",
    "Effort",
    "Ring",
    "Scales",
    "closed_digits",
    "coarser",
    "edges_of",
    "effort_of",
    "ring_of",
    "times_of",
]


class Effort(NamedTuple):
    """The cells of the ring and the steps in n of the coarsest march; both are halved to extrapolate."""

    cells: int
    steps: int
    levels: int  # of halved steps


# Measured, worst of all k, phi and n: 6e-3, 7e-4, 6e-5 of the final volume; docs/theory.md.
EFFORTS = {2: Effort(8, 8, 3), 3: Effort(24, 24, 3), 4: Effort(64, 64, 3)}


def effort_of(digits: int | None) -> Effort:
    """Cells and steps for these digits; 3 by default."""
    most = max(EFFORTS)
    if digits is not None and digits > most:
        raise ValueError(f"digits = {digits} is outside the allowed range 1 <= digits <= {most} of wear over cycles")
    return EFFORTS[max(3 if digits is None else digits, min(EFFORTS))]


def edges_of(cells: int) -> np.ndarray:
    """Edges of the cells as shares of the ring in T: quadratically finer towards both of its ends."""
    u = np.linspace(0.0, 1.0, cells + 1)
    return u * u * (3.0 - 2.0 * u)


# Nodes of a cell from its outer edge, where the pressure of the cell is no smooth function below: v = x^4.
_X, _W = (0.5 + 0.5 * np.polynomial.legendre.leggauss(6)[0], 0.5 * np.polynomial.legendre.leggauss(6)[1])
_NODE, _WEIGHT = _X**4, 4.0 * _X**3 * _W

# The reduced cycles of the marches, in units of the final volume over the first rate: finer at first.
END, GROWTH = 6.0, 4.0


def times_of(steps: int) -> np.ndarray:
    """The ends of the steps, in units of the final volume over the first rate."""
    return END * np.expm1(GROWTH * np.linspace(0.0, 1.0, steps + 1)) / np.expm1(GROWTH)


class Ring(NamedTuple):
    """The worn ring in cells: what the march needs of it, in units in which the rate and time are of order one."""

    compliance: Array  # A over the unit of time, integrated over both cells
    gap: Array  # g integrated over each cell
    steady: Array  # H integrated over each cell
    first: Array  # p_0 times the unit of time, the mean over each cell
    swept: Array  # Q/s integrated over each cell


class Scales(NamedTuple):
    """The units of a run."""

    volume: Array  # the final one
    rate: Array  # the first one
    unit: Array  # of n: volume over rate
    inner: Array  # C
    width: Array  # of the ring, in C


# Of the closed forms of a cell: differences of integrals over the ring.
_DIGITS = 12


def closed_digits(x: Array) -> int:
    """Digits of the closed forms of a cell."""
    return min(_DIGITS, int(jnp.finfo(x.dtype).precision))


def ring_of(k: Array, phi: Array, cells: int) -> tuple[Ring, Scales]:
    """The ring of the final contact in cells."""
    digits = closed_digits(k)
    s, q = exponents(k)
    # Stored, or each of the many kernels that need them would compute them again.
    C = stored(jnp.exp(log_complement(phi) / (1.0 + s)), k)
    m = slip(s, phi)
    width = stored(ring_edge(s, q, phi, digits), k)
    edges = edges_of(cells)
    size = np.diff(edges)

    # What a cell's pressure adds to the one-dimensional picture at the nodes t of all cells, times q: (T-t)^q.
    distance = width * (edges[:, None, None] - edges[None, 1:, None] + size[None, :, None] * _NODE)
    beyond = distance > 0.0
    power = jnp.where(beyond, jnp.exp(q * jnp.log(jnp.where(beyond, distance, 1.0))), 0.0)
    share = jnp.diff(power, axis=0).reshape(cells, -1)
    t = (edges[1:, None] - size[:, None] * _NODE).ravel()
    weight = width * (size[:, None] * _WEIGHT).ravel() * jnp.exp((s - 1.0) * jnp.log1p(width * t))
    # sigma/q = s sine_quotient and sigma^2/(q^2 kappa) = sine_quotient^2/(2 (1+s)), regular at both ends.
    sine = sine_quotient(s, q)
    of_ring = (share * weight) @ share.T * (sine * sine / (2.0 * (1.0 + s)))
    swept = (share @ weight) * sine  # the integral of e(T), over s
    compliance = of_ring + (0.5 * s / (1.0 + s)) * swept[:, None] * swept[None, :]

    y = width * edges[1:]
    at = arc(y, jnp.full_like(y, s), jnp.full_like(y, q), digits)
    area, chord, low = stored(at.area, y), stored(at.chord, y), stored(at.below, y)
    height = y * chord
    below = low + (m - height) * area
    beside = height * area - low
    volume = stored(0.5 * jnp.pi * C * C * below[-1], k)
    rate = stored(0.5 * jnp.pi * (1.0 + s) * ring_work(s, phi, digits), k)
    unit = volume / rate
    T = jnp.clip(1.0 - C - C * width * edges, 0.0)
    load = jnp.where(T > 0.0, jnp.exp((1.0 + s) * jnp.log(jnp.where(T > 0.0, T, 1.0))), 0.0)
    # Depths over C/2, areas over C; A as a whole has C^(2-s).
    scale = 2.0 * jnp.exp(-(s + 1.0) * jnp.log(C)) * C / unit
    ring = Ring(
        compliance * scale,
        jnp.diff(beside, prepend=0.0),
        jnp.diff(below, prepend=0.0),
        -jnp.diff(load) / (C * width * size) * unit,
        jnp.diff(area, prepend=0.0),
    )
    return ring, Scales(volume, rate, unit, C, width)


def coarser(ring: Ring) -> Ring:
    """The ring with every two cells made one, which is exact for integrals over them."""
    gap, steady, swept = (x.reshape(-1, 2).sum(-1) for x in (ring.gap, ring.steady, ring.swept))
    compliance = ring.compliance.reshape(gap.size, 2, gap.size, 2).sum((1, 3))
    size = np.diff(edges_of(2 * gap.size)).reshape(-1, 2)
    part = (size / size.sum(-1, keepdims=True)).ravel()
    first = (ring.first * jnp.asarray(part, gap.dtype)).reshape(-1, 2).sum(-1)
    return Ring(compliance, gap, steady, first, swept)
