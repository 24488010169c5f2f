"""The wear of a life for all exponents of a design in closed form, read from runs at a few of them.

While only E0, z0, k and the radius vary, N cycles wear V(k, phi) s(k, n) in units of a_0^4/R: a share s of the final
volume V, Eq. (28), after n = 4 K mu theta(k) F_N/(pi a_0^2) N. The logarithms of V, s and theta/(1 + k) are smooth in
k: they are polynomials between the exponents of the runs, which are Chebyshev's nodes, and the runs are read at any n.
So a search needs no more runs than that, however many designs it tries.
"""

import dataclasses
from typing import Any, NamedTuple

import jax.numpy as jnp
from jax import Array

from plgwear_jax import fretting
from plgwear_jax._core.sequential import sequential_forward_mode
from plgwear_jax._core.startup.programs import program
from plgwear_jax.special.elementary import namespace
from plgwear_jax.steady.batch import vmap_contacts
from plgwear_jax.wear.closed_ring import run
from plgwear_jax.wear.ring_cells import march_resolution_of
from plgwear_jax.wear.ring_curves import Shares, share_at

from .question import Question
from .scenarios import nodes_between, shares_of_nodes, solved_at, without_zeros

NODES = 33  # exponents: between them the wear is off by some 1e-6, by up to 6e-5 where abs(k) > 0.95
_ROOM = 0.1  # share of the way to abs(k) = 1 by which they reach beyond, for the differences of `sensitivities`


class RunsAlongExponent(NamedTuple):
    """Runs under each of several amplitudes, at exponents that are Chebyshev's nodes."""

    k: Array  # (exponents,)
    log_volume: Array  # log(V), (amplitudes, exponents)
    log_ratio: Array  # log(theta/(1 + k)), (exponents,)
    shares: Any  # `Shares`, (amplitudes, exponents, ...)

    def worn(self, contact: Any, radius: Any, horizon: Any) -> Array:
        """The volume that a contact, of this radius before any wear if it is held, wears by then at each amplitude."""
        radius = contact.steady(0.0).contact_radius if radius is None else radius
        pressed = 4.0 * jnp.asarray(contact.friction) * contact.normal_force * horizon.law.wear_coefficient
        log_n = jnp.log(pressed * horizon.cycles / jnp.pi) - 2.0 * jnp.log(radius)
        k, log_n = jnp.broadcast_arrays(contact.material.k, log_n)
        among = shares_of_nodes(self.k, k)
        n = jnp.exp(log_n + jnp.log1p(k) + among @ self.log_ratio)
        share = share_at(self.shares, n[..., None, None] / self.shares.unit)
        logs = self.log_volume + jnp.log(jnp.maximum(share, jnp.finfo(share.dtype).tiny))
        return radius**4 / jnp.asarray(contact.radius) * jnp.exp(jnp.sum(logs * among[..., None, :], axis=-1))


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


@program()
def _without_shares(question: Question) -> tuple[RunsAlongExponent, Array]:
    """What closed forms tell of the runs, and the amplitudes at which they are needed, (n,)."""
    phi = without_zeros(solved_at(question.phi)[0])
    highest, lowest = (jnp.asarray(end, phi.dtype) for end in ends_of(question))
    k = nodes_between(highest, lowest, NODES if "k" in question.bounds else 1)
    log_ratio = jnp.log(dataclasses.replace(question.contact.material, k=k).tangential_ratio()) - jnp.log1p(k)
    return RunsAlongExponent(k, jnp.log(fretting.wear_volume(k, phi[:, None])), log_ratio, None), phi


@program(level=1)
def _shares_at_nodes(k: Array, phi: Array) -> Shares:
    return vmap_contacts(
        sequential_forward_mode(lambda k, phi: run(march_resolution_of(None), k, phi).shares), (k, phi[:, None])
    )


def runs_of(question: Question) -> RunsAlongExponent:
    """The runs that a question needs."""
    found, phi = _without_shares(question)
    return found._replace(shares=_shares_at_nodes(found.k, phi))
