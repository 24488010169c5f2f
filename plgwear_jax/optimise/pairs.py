"""The evaluation of a design whose indenter is elastic: one candidate after the other, solved numerically.

The search asks for values at points and does not mind whence they come, so that all else is as for closed forms.
"""

import dataclasses
import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._startup.programs import program
from plgwear_jax.optimise.candidate import Candidate
from plgwear_jax.optimise.problem import POWERS, Question
from plgwear_jax.shapes import outline_of
from plgwear_jax.steady.slopes import Given, Logs, stiffness_for, unworn_log_radius, worn_logs
from plgwear_jax.steady.state import State
from plgwear_jax.surfaces.effort import effort_of

__all__ = ["evaluate_pairs", "states_at"]

_DIGITS = 4
_NODES = 16  # a table of more amplitudes is solved at so many


class PairCandidate(Candidate):
    """One choice of the variables, of scalars."""

    @functools.cached_property
    def given(self) -> Given:
        """The load."""
        contact, limits = self.question.contact, self.question.limits
        distance = 0.0 if limits.distance is None else limits.distance
        return Given(
            force=jnp.asarray(contact.normal_force),
            radius=jnp.asarray(contact.radius),
            friction=jnp.asarray(contact.friction),
            plane_modulus=None if contact.indenter is None else contact.indenter.plane_modulus,
            phi=self._amplitudes[0],
            distance=jnp.asarray(distance, self._amplitudes[0].dtype),
            outline=outline_of(contact),
        )

    def _log_lack(self, contact: Any) -> Array:
        """The logarithm of the factor by which the half-space of a contact has to be stiffer for the held radius."""
        return self._half_space[1] - contact.material.log_stiffness()

    @property
    def log_radius(self) -> Array:
        """log(a_0), alone."""
        return unworn_log_radius(effort_of(_DIGITS), self._half_space, self.given)

    @functools.cached_property
    def _half_space(self) -> Array:
        """(k, log(stiffness))."""
        k = jnp.asarray(self.k)
        if self.question.hold is None:
            return jnp.stack([k, self.contact.material.log_stiffness()])
        # Not by way of E0 or z0: at k = 0 z0 is without effect.
        return jnp.stack([k, stiffness_for(effort_of(_DIGITS), k, jnp.log(self.contact_radius), self.given)])

    @functools.cached_property
    def contact_radius(self) -> Array:
        """Its initial contact radius a_0 in m."""
        if self.question.hold is not None:
            assert self.radii is not None
            return self.radii[1]
        return jnp.exp(self.solved.contact_radius)

    @functools.cached_property
    def _amplitudes(self) -> tuple[Array, Array | None]:
        """(phi at which it is solved, the largest first, the matrix from there to those of the load)."""
        assert self.question.load is not None
        # Padding has no weight.
        phi = jnp.asarray(self.question.phi)
        phi = jnp.where(self.question.load.weight > 0.0, phi, phi[0])
        if phi.size <= _NODES:
            return phi, None
        # Chebyshev's nodes, along which the logarithm of the wear is smooth also towards 0 and 1.
        x = jnp.log(phi / (1.0 - phi))
        first, last = x[0], jnp.minimum(jnp.min(x), x[0] - 0.1)
        nodes = np.cos(np.pi * np.arange(_NODES) / (_NODES - 1))
        at = first + 0.5 * (last - first) * (1.0 - nodes)
        signs = (-1.0) ** np.arange(_NODES) * np.where(np.arange(_NODES) % (_NODES - 1) == 0, 0.5, 1.0)
        apart = x[:, None] - at
        same = abs(apart) < 1e-6 * (first - last)
        shares = jnp.where(same.any(1)[:, None], same * 1.0, signs / jnp.where(same, 1.0, apart))
        return jnp.append(phi[:1], 1.0 / (1.0 + jnp.exp(-at[1:]))), shares / shares.sum(1)[:, None]

    @functools.cached_property
    def solved(self) -> Logs:
        """What it does at these amplitudes."""
        return worn_logs(effort_of(_DIGITS), self._names, self._half_space, self.given)

    @property
    def _names(self) -> tuple[str, ...]:
        limits = self.question.limits
        more = {"penetration": limits.penetration, "edge_pressure": limits.edge_pressure}
        return (self.question.objective, *(name for name, limit in more.items() if limit is not None))

    def objective(self) -> Array:
        """The logarithm of what is minimised, divided by a constant; see `log_unit`."""
        assert self.question.load is not None
        worn, between = self.solved.worn[:, 0], self._amplitudes[1]
        worn = worn - self.log_unit()
        return jnp.log(self.question.load.weight @ jnp.exp(worn if between is None else between @ worn))

    def log_unit(self) -> Array:
        """The logarithm of that constant, of the size of the contact, in SI units."""
        name, contact = self.question.objective, self.question.contact
        radius = jnp.asarray(contact.radius)
        plane_modulus = self.given.plane_modulus
        load = contact.normal_force * radius
        size = jnp.log(radius) if plane_modulus is None else jnp.log(load / plane_modulus) / 3.0
        return POWERS[name] * size - (0.0 if name == "worn_radius" else jnp.log(radius))

    def _limited(self, name: str) -> Array:
        return jnp.exp(self.solved.worn[0, self._names.index(name)])

    def penetration(self) -> Array:
        """d_inf in m at the largest amplitude."""
        return self._limited("penetration")

    def edge_pressure(self) -> Array:
        """p_inf in Pa at the critical distance, at the largest amplitude."""
        return self._limited("edge_pressure")


# --- the points of a question -----------------------------------------------------------------------------------------


class _Points:
    """What is known of a question: a search asks for some points again, and so do those who report on it.

    Threads that ask the same question may share it: rows are added whole and never taken away.
    """

    def __init__(self, names: tuple[str, ...], question: Question):
        self.names, self.question = names, question
        self.key = self._key(names, question)
        self.rows: dict[bytes, Any] = {}

    @staticmethod
    def _key(names: tuple[str, ...], question: Question) -> Any:
        leaves, tree = jax.tree.flatten(question)
        return names, tree, tuple((leaf.dtype, leaf.shape, leaf.tobytes()) for leaf in leaves)

    def is_of(self, names: tuple[str, ...], question: Question) -> bool:
        """Whether they answer this question too."""
        return question is self.question or self._key(names, question) == self.key

    def solve(self, points: np.ndarray) -> list[Any]:
        """(Values, slopes, material, unit) of points of shape (lanes, n)."""
        keys = [point.tobytes() for point in points]
        new = {key: point for key, point in zip(keys, points, strict=True) if key not in self.rows}
        if new:
            asked = np.array([*new.values(), *points[len(new) :]])
            told = _evaluate_pairs(
                self.names, self.question, dict(zip(self.names, asked.T, strict=True)), np.asarray(len(new))
            )
            values, slopes, materials, unit, _ = jax.device_get(told)
            for i, key in enumerate(new):
                self.rows[key] = values[i], slopes[i], jax.tree.map(lambda x, i=i: x[i], materials), unit
        return [self.rows[key] for key in keys]


_MOST = 20_000  # points
_last: _Points | None = None


def evaluate_pairs(names: tuple[str, ...], question: Question, variables: dict[str, Any]) -> Any:
    """The fields of `evaluation.Evaluation`, for concrete numbers."""
    global _last
    known = _last  # read once: another thread may replace it
    if known is None or len(known.rows) > _MOST or not known.is_of(names, question):
        _last = known = _Points(names, question)
    rows = known.solve(np.stack([variables[name] for name in names], axis=-1))
    *found, unit = zip(*rows, strict=True)
    return *(jax.tree.map(lambda *parts: np.stack(parts), *parts) for parts in found), unit[0]


def states_at(names: tuple[str, ...], question: Question, variables: dict[str, Any], lanes: int) -> State:
    """The states at the largest amplitude, by the same program of so many lanes."""
    count = len(variables[names[0]])
    some = {name: np.pad(variables[name], (0, lanes - count), mode="edge") for name in names}
    states = _evaluate_pairs(names, question, some, np.asarray(count))[-1]
    return jax.tree.map(lambda x: np.asarray(x)[:count], states)


@program(static=1, level=1)
def _evaluate_pairs(
    names: tuple[str, ...], question: Question, variables: dict[str, Array], count: Array
) -> tuple[Array, Array, Any, Array, State]:
    """Values, slopes, materials, the unit, and the states at the largest amplitude, of the first `count` points."""
    held = None
    if question.hold is not None:
        held = jnp.exp(PairCandidate(dataclasses.replace(question, hold=None), {}).log_radius)

    @jax.jit  # to be traced once
    def one(values: dict[str, Array]) -> tuple[Array, Array, Any, State]:
        def moved(steps: Array) -> tuple[Array, tuple[Any, State]]:
            there = {
                name: values[name] + step if name == "k" else values[name] * jnp.exp(step)
                for name, step in zip(names, steps, strict=True)
            }
            candidate = PairCandidate(question, there, None if held is None else (None, held))
            told = [candidate.objective(), *candidate.excess()]
            state = jax.tree.map(lambda x: x[0], candidate.solved.states)
            return jnp.stack(told), (candidate.contact.material, state)

        still = jnp.zeros(len(names), variables[names[0]].dtype)
        told, along, (material, state) = jax.linearize(moved, still, has_aux=True)
        slopes = jax.vmap(along)(jnp.eye(still.size, dtype=still.dtype))
        return told, slopes.T, jax.tree.map(lambda field: jnp.asarray(field, still.dtype), material), state

    def add(i: Array, found: Any) -> Any:
        new = one({name: value[i] for name, value in variables.items()})
        return jax.tree.map(lambda whole, x: whole.at[i].set(x), found, new)

    like = jax.eval_shape(one, {name: value[0] for name, value in variables.items()})
    lanes = variables[names[0]].size
    none = jax.tree.map(lambda x: jnp.zeros((lanes, *x.shape), x.dtype), like)
    values, slopes, materials, states = jax.lax.fori_loop(0, count, add, none)
    return values, slopes, materials, PairCandidate(question, {}).log_unit(), states
