"""The wear of a life for all exponents of a design in closed form, read from runs at a few of them.

While only E0, z0, k and the radius vary, N cycles wear V(k, phi) s(k, n) in units of a_0^4/R: a share s of the final
volume V, Eq. (28), after n = 4 K mu theta(k) F_N/(pi a_0^2) N. The logarithms of V, s and theta/(1 + k) are smooth in
k: they are polynomials between the exponents of the runs, which are Chebyshev's nodes, and the runs are read at any n.
So a search needs no more runs than that, however many designs it tries.
"""

import dataclasses
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax import fretting
from plgwear_jax._startup.programs import program
from plgwear_jax.optimise.conditions import namespace
from plgwear_jax.optimise.question import Question
from plgwear_jax.optimise.scenarios import solved_at, without_padding
from plgwear_jax.special.sequential import sequential_forward_mode
from plgwear_jax.steady.batch import each
from plgwear_jax.wear.closed_ring import run
from plgwear_jax.wear.ring_cells import march_resolution_of
from plgwear_jax.wear.ring_curves import Shares, share_at

NODES = 33  # exponents: between them the wear is off by some 1e-6, by up to 6e-5 where abs(k) > 0.95
_ROOM = 0.1  # share of the way to abs(k) = 1 by which they reach beyond, for the differences of `sensitivities`


class RunsAlongExponent(NamedTuple):
    """Runs under each of several amplitudes, at exponents that are Chebyshev's nodes between two ends."""

    ends: Array  # the highest exponent and the lowest one
    log_volume: Array  # log(V), (amplitudes, exponents)
    log_ratio: Array  # log(theta/(1 + k)), (exponents,)
    shares: Any  # `Shares`, (amplitudes, exponents, ...)

    def log_worn(self, k: Array, log_n: Array) -> Array:
        """log(V s) of exponents after n = theta exp(log_n) reduced cycles, at each amplitude along a last axis.

        Both arguments have the same shape.
        """
        among = shares_of_nodes(self.ends, k, self.log_volume.shape[1])
        n = jnp.exp(log_n + jnp.log1p(k) + among @ self.log_ratio)
        share = share_at(self.shares, n[..., None, None])
        logs = self.log_volume + jnp.log(jnp.maximum(share, jnp.finfo(share.dtype).tiny))
        return jnp.sum(logs * among[..., None, :], axis=-1)


def shares_of_nodes(ends: Array, k: Array, count: int) -> Array:
    """The share of each node in the polynomial through all of them, along a last axis: a mean of T_j(x_i) T_j(x)."""
    if count == 1:
        return jnp.ones((*jnp.shape(k), 1), ends.dtype)
    # Ends are never reached: see `_ROOM`. Beyond them there are no runs, and the arc is NaN.
    arc, j = jnp.arccos((2.0 * k - ends[0] - ends[1]) / (ends[0] - ends[1])), np.arange(count)
    half = np.where(j % (count - 1) == 0, 0.5, 1.0)
    matrix = half[:, None] * half * np.cos(np.pi * np.outer(j, j) / (count - 1)) * (2.0 / (count - 1))
    return jnp.cos(arc[..., None] * j) @ jnp.asarray(matrix, arc.dtype)


def ends_of(question: Question) -> Any:
    """The highest and the lowest exponent at which runs are needed: those of the designs and of the reference."""
    k = question.contact.material.k
    if "k" not in question.bounds:
        return k, k
    low, high = question.bounds["k"]
    xp = namespace(k, low, high)
    return with_room(xp.maximum(high, k), xp.minimum(low, k))


def with_room(highest: Any, lowest: Any) -> tuple[Any, Any]:
    """Two exponents, and a part of the way from there to 1 and to -1."""
    return highest + _ROOM * (1.0 - abs(highest)), lowest - _ROOM * (1.0 - abs(lowest))


def exponents_of_runs(ends: Array, count: int) -> Array:
    """Chebyshev's nodes between two ends, of shape (2, ...), along a last axis."""
    highest, lowest = ends[..., None]
    at = np.cos(np.pi * np.arange(count) / max(count - 1, 1))
    return 0.5 * (highest + lowest) + 0.5 * (highest - lowest) * jnp.asarray(at, ends.dtype)


@program()
def _without_shares(question: Question) -> tuple[RunsAlongExponent, Array, Array]:
    """What closed forms tell of the runs, and the exponents and amplitudes, (n,), at which they are needed."""
    assert question.load is not None
    phi, _ = solved_at(without_padding(question.phi, question.load.weight))
    ends = jnp.stack([jnp.asarray(end, phi.dtype) for end in ends_of(question)])
    k = exponents_of_runs(ends, NODES if "k" in question.bounds else 1)
    log_ratio = jnp.log(dataclasses.replace(question.contact.material, k=k).tangential_ratio()) - jnp.log1p(k)
    return RunsAlongExponent(ends, jnp.log(fretting.wear_volume(k, phi[:, None])), log_ratio, None), k, phi


@program(level=1)
def _shares_at_nodes(k: Array, phi: Array) -> Shares:
    return each(
        sequential_forward_mode(lambda k, phi: run(march_resolution_of(None), k, phi).shares), (k, phi[:, None])
    )


def runs_of(question: Question) -> RunsAlongExponent:
    """The runs that a question needs."""
    found, *nodes = _without_shares(question)
    return found._replace(shares=_shares_at_nodes(*nodes))
