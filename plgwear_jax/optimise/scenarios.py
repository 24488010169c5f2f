"""Uncertain contacts: what a contact may turn out to be, and how probable each of these scenarios is."""

from collections.abc import Sequence
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import NUMBER, ArrayLike, Domain, as_array, check, record
from plgwear_jax._core.leaves import paths_of
from plgwear_jax._core.startup.programs import holds_tracers
from plgwear_jax.contact import FrettingContact
from plgwear_jax.loads import AMPLITUDE_OF_FORCE, Load
from plgwear_jax.special.elementary import namespace
from plgwear_jax.steady.arguments import own_axes
from plgwear_jax.wear_laws import law_of

LEVEL = Domain("0 <= level <= 1", lambda level: (level >= 0.0) & (level <= 1.0))


def tail_weights(tangential_force: ArrayLike, weight: ArrayLike, level: ArrayLike = 0.0) -> Array:
    """Weights with which the wear under each amplitude enters the mean over the worst 1 - level of all contacts.

    Wear grows with the amplitude for every material, so the worst cases are the largest amplitudes.

    Args:
        tangential_force: Amplitudes, shape (n,), in any unit.
        weight: Their probabilities, shape (n,), >= 0 and not all zero; they need not sum to one.
        level: 0 for the mean, 1 for the worst case, between them the level of the CVaR (expected shortfall).

    Returns:
        Weights that sum to one, shape (n,); a NumPy array if all arguments are concrete.

    Raises:
        ValueError: A concrete argument is outside its range.
    """
    _, counting, order = falling(tangential_force, weight, level)
    return counting[namespace(order).argsort(order)]


def shares(weight: Any) -> Any:
    """Weights, shape (n,), with the sum 1."""
    weight = weight / weight.max()  # so that the sum stays within the range of numbers
    return weight / weight.sum()


@record
class WeightedLoad:
    """The amplitudes for which a design is made, and how much each of them counts.

    Attributes:
        load: A load whose amplitudes have the shape (n,), the largest one that counts first, or `Blocks`. Amplitudes
            without weight at the end are padding.
        weight: With which the wear under each of them enters what is minimised, shape (n,), with the sum 1.
    """

    tables: ClassVar = ("weight",)  # which have an axis of their own

    load: Load
    weight: Any

    @property
    def amplitudes(self) -> Any:
        """The amplitudes in N, or in m; None of blocks."""
        return self.load.amplitude

    @property
    def largest(self) -> Load:
        """The load of the largest amplitude; blocks as they are."""
        return self.load if self.amplitudes is None else self.load.with_amplitude(lambda amplitudes: amplitudes[0])

    def with_amplitudes(self, amplitudes: Any, weight: Any) -> "WeightedLoad":
        """The same kind of load with other amplitudes."""
        return WeightedLoad(self.load.with_amplitude(lambda _: amplitudes), weight)


def weighted_load(contact: FrettingContact, given: WeightedLoad, level: float) -> WeightedLoad:
    """The amplitudes that count, the largest first, or a ValueError."""
    load, weight = given.load, given.weight
    if load.amplitude is None:
        if weight is not None:
            raise ValueError("weight: belongs to several amplitudes, not to blocks")
        return WeightedLoad(load, np.ones(1))
    amplitudes = np.atleast_1d(load.amplitude)
    weight = np.ones(amplitudes.shape) if weight is None else np.asarray(weight)
    load.check(contact.friction, contact.normal_force)
    amplitudes, counting, _ = falling(amplitudes, weight, level)
    if amplitudes[0] == 0.0:
        name = "tangential_force" if load.holds_force else "displacement_amplitude"
        raise ValueError(f"{name} = 0: nothing wears, so there is nothing to design")
    return given.with_amplitudes(amplitudes[counting > 0.0], counting[counting > 0.0])


def falling(tangential_force: ArrayLike, weight: ArrayLike, level: ArrayLike) -> tuple[Any, Any, Any]:
    """(Amplitudes, the weights of `tail_weights` with which they count, their order), the largest that counts first.

    The limits of a design are checked at that one: it counts at every level. It stands also for what has no weight.
    """
    tangential_force, weight = as_array(tangential_force), as_array(weight)
    check("tangential_force", tangential_force, NUMBER)
    check("weight", weight, NUMBER)
    check("level", level, LEVEL)
    dtype = jnp.result_type(tangential_force, weight, level, 0.0)
    # Concrete numbers are handled by NumPy, which compiles nothing.
    xp = jnp if holds_tracers((tangential_force, weight, level)) else np
    force, weight = xp.asarray(tangential_force, dtype), xp.asarray(weight, dtype)
    if force.ndim != 1 or force.shape != weight.shape or force.size == 0:
        raise ValueError(f"amplitudes of shape {force.shape} and weights of shape {weight.shape}: both must be (n,)")
    if not (holds_tracers(weight) or np.any(np.asarray(weight) > 0.0)):
        raise ValueError("weight: all weights are zero")
    order = xp.argsort(-force)
    force, share = force[order], shares(weight)[order]
    above = xp.cumsum(share) - share
    # The worst case is the largest amplitude that has any weight.
    tail = xp.maximum(1.0 - xp.asarray(level, dtype), np.finfo(dtype).tiny)
    in_tail = xp.clip(tail - above, 0.0, share)
    counting = in_tail / xp.sum(in_tail)
    largest = xp.where(counting > 0.0, force, 0.0).max()
    return xp.where(counting > 0.0, force, largest), counting, order


# --- where contacts without closed forms are solved -------------------------------------------------------------------

_NODES = 16  # a table of more amplitudes is solved at so many


def without_zeros(phi: Array) -> Array:
    """These phi, the largest first, where 0 becomes one that hardly wears: of 0 there is no logarithm and no share."""
    return jnp.where(phi > 0.0, phi, 1e-4 * phi[0])


def solved_at(phi: Array) -> tuple[Array, Array | None]:
    """(phi at which a contact is solved, the largest first, the matrix from there to all phi; None if they are all)."""
    if phi.size <= _NODES:
        return phi, None
    phi = without_zeros(phi)
    x = jnp.log(phi / (1.0 - phi))  # along which the logarithm of the wear is smooth also towards 0 and 1
    at = nodes_between(x[0], jnp.minimum(jnp.min(x), x[0] - 0.1), _NODES)
    return jnp.append(phi[:1], 1.0 / (1.0 + jnp.exp(-at[1:]))), shares_of_nodes(at, x)


def nodes_between(first: Any, last: Any, count: int) -> Array:
    """Chebyshev's nodes between two ends, of any shape, along a last axis."""
    first, last = jnp.asarray(first)[..., None], jnp.asarray(last)[..., None]
    at = 0.5 * np.cos(np.pi * np.arange(count) / max(count - 1, 1))
    return 0.5 * (first + last) + (first - last) * jnp.asarray(at, first.dtype)


def shares_of_nodes(nodes: Array, x: Array) -> Array:
    """The share of each node in the polynomial through all of them, along a last axis."""
    own = np.eye(nodes.shape[-1], dtype=bool)
    apart = jnp.where(own, 1.0, nodes[..., :, None] - nodes[..., None, :])
    return jnp.prod(jnp.where(own, 1.0, (x[..., None] - nodes)[..., None, :] / apart), axis=-1)


# --- uncertain contacts -----------------------------------------------------------------------------------------------


@record
class Scenarios:
    """What a contact may turn out to be, with probabilities.

    What a design varies or holds it sets in all scenarios together: there each keeps its ratio to the reference, and
    its difference where k, nu or an exponent varies. Scenarios that have there what the reference has get what the
    design says.

    Attributes:
        contact: Contacts of the same bodies as the reference. Each of their numbers is the same in all scenarios, or
            has a leading axis of shape (n,).
        weight: Probabilities of the scenarios, shape (n,), >= 0 and not all zero; by default all equal.
        law: Archard's K in 1/Pa in each of them, shape (n,), or a law whose numbers may have that axis; by default that
            of the design.
        tangential_force: Force amplitude F_x in N in each of them, shape (n,), in place of the single one of the
            design.

    Examples:
        >>> import jax.numpy as jnp
        >>> from plgwear_jax import FrettingContact, PowerLawGraded, optimise
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> uncertain = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=jnp.array([0.3, 0.4, 0.6]))
        >>> scenarios = optimise.Scenarios(uncertain, weight=[1.0, 2.0, 1.0])
        >>> best = optimise.design(contact, 0.6, {"k": (-0.5, 0.5)}, level=0.5, scenarios=scenarios)
        >>> print(best.variables["k"], best.certified)
        -0.5 True
    """

    contact: Any
    weight: Any = None
    law: Any = None
    tangential_force: Any = None


@record
class ScenarioBatch:
    """Scenarios as a search takes them.

    Attributes:
        contact: The contacts; each of their numbers has a leading axis of shape (n,).
        law: The wear laws in the same form; None for those of the design.
        weight: The probabilities, shape (n,), with the sum 1.
        tangential_force: Force amplitudes in N of their own, shape (n,); or None.
        level: 0 takes the mean over scenarios and amplitudes, 1 the worst of them, between them the CVaR.
    """

    contact: Any
    law: Any
    weight: Any
    tangential_force: Any
    level: ArrayLike


def scenario_batch(given: Any, contact: Any, law: Any, level: float) -> ScenarioBatch:
    """The scenarios of a design, or a ValueError; `given` is a `Scenarios` or its contact alone.

    Args:
        given: As of `design`.
        contact: The reference.
        law: The wear law of its life; None for the steady state.
        level: As of `design`.
    """
    given = given if isinstance(given, Scenarios) else Scenarios(given)
    if jax.tree.structure(given.contact) != jax.tree.structure(contact):
        raise ValueError("scenarios: takes contacts of the same bodies and shape as the contact of the design")
    own_law = None if given.law is None else law_of(given.law)
    if own_law is not None and jax.tree.structure(own_law) != jax.tree.structure(law):
        raise ValueError("scenarios: law takes the kind of law of the design, for a number of cycles")
    given = Scenarios(given.contact, 1.0 if given.weight is None else given.weight, own_law, given.tangential_force)
    check("scenarios: weight", given.weight, NUMBER)
    if given.tangential_force is not None:
        check("scenarios: tangential_force", given.tangential_force, AMPLITUDE_OF_FORCE)
    leaves = {name: np.asarray(leaf, float) for name, leaf in paths_of(given).items()}
    own = own_axes(given)
    shapes = {name: leaf.shape[: leaf.ndim - n] for (name, leaf), n in zip(leaves.items(), own, strict=True)}
    axes = {*shapes.values()} - {()}
    if not (len(axes) <= 1 and all(len(shape) == 1 for shape in axes)):
        told = ", ".join(f"{name.removeprefix('contact.')} {shape}" for name, shape in shapes.items() if shape)
        raise ValueError(f"scenarios: all numbers must have one leading axis (n,), or none; their shapes are {told}")
    _, each = spread([*leaves.values(), np.ones(1)], [*own, 0], np)
    found: Scenarios = jax.tree.unflatten(jax.tree.structure(given), each[:-1])
    if not np.any(found.weight > 0.0):
        raise ValueError("scenarios: weight: all weights are zero")
    return ScenarioBatch(found.contact, found.law, shares(found.weight), found.tangential_force, level)


def spread(leaves: Sequence[Any], own: Sequence[int], xp: Any) -> tuple[tuple[int, ...], list[Any]]:
    """The shape of a batch, and its numbers with the axes of the batch before so many of their own."""
    shape = np.broadcast_shapes(*(leaf.shape[: leaf.ndim - n] for leaf, n in zip(leaves, own, strict=True)))
    pairs = zip(leaves, own, strict=True)
    return shape, [xp.broadcast_to(leaf, (*shape, *leaf.shape[leaf.ndim - n :])) for leaf, n in pairs]
