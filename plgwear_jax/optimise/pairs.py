"""The evaluation of a design whose indenter is elastic: one candidate after the other, solved numerically.

The search asks for values at points and does not mind whence they come, so that all else is as for closed forms.
"""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.programs import program
from plgwear_jax.contact.numeric_state import states_of
from plgwear_jax.optimise.candidate import Candidate
from plgwear_jax.optimise.problem import POWERS, Question
from plgwear_jax.surfaces.compliance import power_law
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.surfaces.punch import punch_at
from plgwear_jax.surfaces.root import root_of

__all__ = ["begin_pairs", "evaluate_pairs"]

_DIGITS = 4


class PairCandidate(Candidate):
    """One choice of the variables, of scalars."""

    def _log_lack(self, contact: Any) -> Array:
        """The logarithm of the factor by which the half-space of a contact has to be stiffer for the held radius."""
        effort, material = effort_of(_DIGITS), contact.material
        k, log_stiffness = jnp.asarray(material.k), material.log_stiffness()
        load, log_c = jnp.asarray(contact.normal_force) * contact.radius, jnp.log(self.contact_radius)

        def excess(factor: Array) -> Array:
            compliance = power_law(k, log_stiffness + factor, contact.indenter.plane_modulus, load, effort)
            return 2.0 * log_c + jnp.log(punch_at(compliance, log_c, effort).force) - jnp.log(load)

        # Under a rigid indenter it would be this one.
        alone = jnp.log(load) + jnp.log(0.25 * (3.0 + k)) - (3.0 + k) * log_c - log_stiffness
        return root_of(excess, alone, 0.5)

    @functools.cached_property
    def contact_radius(self) -> Array:
        """Its initial contact radius a_0 in m."""
        if self.question.hold is not None:
            assert self.radii is not None
            return self.radii[1]
        return states_of(self.contact, self._force, _DIGITS).results.contact_radius[0]

    @property
    def _force(self) -> Any:
        # Whatever is asked for at the same amplitudes shares their states.
        assert self.question.load is not None
        return self.question.load.tangential_force

    def _of_states(self, name: str, *first: Any) -> Array:
        return getattr(self.contact, name)(*first, self._force, digits=_DIGITS)

    def objective(self) -> Array:
        """The logarithm of what is minimised, divided by a constant; see `log_unit`."""
        assert self.question.load is not None
        worn = self._of_states(self.question.objective)
        return jnp.log((self.question.load.weight * worn).sum()) - self.log_unit()

    def log_unit(self) -> Array:
        """The logarithm of that constant, of the size of the contact, in SI units."""
        name, contact = self.question.objective, self.question.contact
        radius = jnp.asarray(contact.radius)
        size = jnp.log(contact.normal_force * radius / contact.indenter.plane_modulus) / 3.0
        return POWERS[name] * size - (0.0 if name == "worn_radius" else jnp.log(radius))

    def penetration(self) -> Array:
        """d_inf in m at the largest amplitude."""
        return self._of_states("penetration")[0]

    def edge_pressure(self) -> Array:
        """p_inf in Pa at the critical distance, at the largest amplitude."""
        return self._of_states("edge_pressure", self.question.limits.distance)[0]


def evaluate_pairs(names: tuple[str, ...], question: Question, variables: dict[str, Any]) -> Any:
    """The fields of `evaluation.Evaluation`, for concrete numbers."""
    return _evaluate_pairs(names, question, variables, _held(question))


def begin_pairs(names: tuple[str, ...], question: Question, variables: dict[str, Any]) -> None:
    """Begin to compile `evaluate_pairs`, if programs are compiled ahead."""
    _evaluate_pairs.begin(names, question, variables, None if question.hold is None else np.zeros_like(question.phi[0]))


def _held(question: Question) -> Any:
    """The contact radius that is held, that of the reference."""
    return None if question.hold is None else np.asarray(question.contact.contact_radius(digits=_DIGITS))


@program(static=1)
def _evaluate_pairs(
    names: tuple[str, ...], question: Question, variables: dict[str, Array], held: Array | None
) -> tuple[Array, Array, Any, Array]:

    def one(values: dict[str, Array]) -> tuple[Array, Array, Any]:
        def moved(steps: Array) -> tuple[Array, Any]:
            there = {
                name: values[name] + step if name == "k" else values[name] * jnp.exp(step)
                for name, step in zip(names, steps, strict=True)
            }
            candidate = PairCandidate(question, there, None if held is None else (None, held))
            told = [candidate.objective(), *candidate.excess()]
            return jnp.stack(told), candidate.contact.material

        still = jnp.zeros(len(names), variables[names[0]].dtype)
        (values_, material), along = jax.linearize(moved, still)
        slopes = jax.lax.map(lambda step: along(step)[0], jnp.eye(still.size, dtype=still.dtype))
        return values_, slopes.T, jax.tree.map(lambda field: jnp.asarray(field, still.dtype), material)

    return *jax.lax.map(one, variables), PairCandidate(question, {}).log_unit()
