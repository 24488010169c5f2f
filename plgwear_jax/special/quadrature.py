"""Rules for integrals from 0 to 1, in pieces, of functions that may be singular at both ends of a piece.

Places are those of the trapezoidal rule in log(x/(1-x)).
"""

import functools
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array, lax

Rule = tuple[np.ndarray, np.ndarray, np.ndarray]  # x, 1 - x, weights of an integral over x from 0 to 1


def _by_logits(v: np.ndarray, step: np.ndarray | float) -> Rule:
    """At these places of log(x/(1-x)), with the steps between them."""
    inside, outside = 1.0 / (1.0 + np.exp(-v)), 1.0 / (1.0 + np.exp(v))
    return inside, outside, step * inside * outside


@functools.cache
def logistic(count: int, most: float = 17.0) -> Rule:
    """In equal steps of log(x/(1-x))."""
    return _by_logits(*np.linspace(-most, most, count, retstep=True))


@functools.cache
def bent(count: int, begin: float = -0.75) -> Rule:
    """In steps of log(x/(1-x)) that grow towards both ends and go further towards 1, for functions that oscillate."""
    w, step = np.linspace(begin, 1.0, count, retstep=True)
    bend = 2.4
    scale = 36.0 / np.sinh(bend)
    return _by_logits(scale * np.sinh(bend * w), step * scale * bend * np.cosh(bend * w))


class Pieces(NamedTuple):
    """A rule for integrals over x from 0 to 1 in pieces."""

    x: Array
    left: Array  # 1 - x
    ahead: Array  # the end of the piece less x
    weight: Array
    last: Array | float  # the length of the last piece
    places: int  # in a piece

    def singular(self, power: Array) -> tuple[Array, Array]:
        """(Weights of the integral of a function times (1-x)^(power-1), and that of its value at the end).

        The latter is what the rule leaves out, which lies there.
        """
        weight = self.weight * jnp.exp((power - 1.0) * jnp.log(self.left))
        return weight, self.last**power / power - jnp.sum(weight[-self.places :])

    def ended(self, terms: Array, power: Array) -> Array:
        """Terms of an integral of what is at the end of each piece as a power of `ahead`, of `power` - 1 or more."""
        terms = terms.reshape(-1, self.places)
        # In equal steps of a logarithm what is left out goes on as a geometric series, of which the last term gets all.
        before, last = terms[:, -2], terms[:, -1]
        some = before * last > 0.0
        decay = jnp.log(jnp.where(some, before, 2.0) / jnp.where(some, last, 1.0))
        last = -last / jnp.expm1(-jnp.maximum(decay, power * jnp.log(self.ahead[-2] / self.ahead[-1])))
        return jnp.append(terms[:, :-1], last[:, None], 1).ravel()


def pieces(inner: Array | np.ndarray, like: Array, rule: Rule) -> Pieces:
    """The rule between 0, inner x that increase, and 1; those not between 0 and 1 have no part."""
    inside, outside, weight = (jnp.asarray(x, like.dtype) for x in rule)
    if not inner.size:
        return Pieces(inside, outside, outside, weight, 1.0, weight.size)
    # Beyond 1 it is where the piece before it begins: a piece without a length, whose places are those of the whole.
    inner = lax.cummax(jnp.where((inner > 0.0) & (inner < 1.0), inner, 0.0))
    begins, ends = jnp.append(jnp.zeros_like(like), inner), jnp.append(inner, jnp.ones_like(like))
    length = (ends - begins)[:, None]
    x = jnp.where(length > 0.0, begins[:, None] + length * inside, inside)
    left = jnp.where(length > 0.0, (1.0 - ends)[:, None] + length * outside, outside)
    ahead = length * outside
    return Pieces(x.ravel(), left.ravel(), ahead.ravel(), (length * weight).ravel(), length[-1, 0], weight.size)
