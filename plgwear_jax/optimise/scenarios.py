"""Uncertain contacts: what a contact may turn out to be, and how probable each of these scenarios is."""

from typing import Any

import jax
import numpy as np
from jax.typing import ArrayLike

from plgwear_jax._core.domains import check
from plgwear_jax._core.leaves import paths_of
from plgwear_jax._core.record import record
from plgwear_jax.loads import AMPLITUDE_OF_FORCE as FORCE
from plgwear_jax.optimise.loads import LEVEL, WEIGHT, shares
from plgwear_jax.wear_laws import Archard, WearLaw


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
        wear_coefficient: Archard's K in 1/Pa in each of them, shape (n,), or a law whose numbers may have that axis;
            by default that of the design.
        tangential_force: Force amplitude F_x in N in each of them, shape (n,); by default that of the design. Under a
            `Displacement` of the design NaN holds the displacement.

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
    wear_coefficient: Any = None
    tangential_force: Any = None


@record
class ScenarioBatch:
    """Scenarios as a search takes them.

    Attributes:
        contact: The contacts; each of their numbers has a leading axis of shape (n,).
        law: The wear laws in the same form; None for those of the design.
        weight: The probabilities, shape (n,), with the sum 1.
        tangential_force: Force amplitudes in N of their own, shape (n,), NaN where a displacement is held; or None.
        level: 0 takes the mean over scenarios and amplitudes, 1 the worst of them, between them the CVaR.
    """

    contact: Any
    law: Any
    weight: Any
    tangential_force: Any
    level: ArrayLike


def own_axes(contact: Any, number: int) -> list[int]:
    """For each of so many leaves, a contact's and those after it, how many axes of its own it has: 1 for a table."""
    own = []
    for (first, *rest), _ in jax.tree_util.tree_leaves_with_path(contact):
        tables = getattr(getattr(contact, first.name), "tables", ())
        own.append(int(bool(rest) and rest[-1].name in tables))
    return own + [0] * (number - len(own))


def scenario_batch(given: Any, contact: Any, law: Any, level: float) -> ScenarioBatch:
    """The scenarios of a design, or a ValueError; `given` is a `Scenarios` or its contact alone.

    Args:
        given: As of `design`.
        contact: The reference.
        law: The wear law of its life; None for the steady state.
        level: As of `design`.
    """
    given = given if isinstance(given, Scenarios) else Scenarios(given)
    check("level", level, LEVEL)
    if jax.tree.structure(given.contact) != jax.tree.structure(contact):
        raise ValueError("scenarios: takes contacts of the same bodies and shape as the contact of the design")
    own_law = given.wear_coefficient
    if own_law is not None:
        own_law = own_law if isinstance(own_law, WearLaw) else Archard(np.asarray(own_law, float))
        if jax.tree.structure(own_law) != jax.tree.structure(law):
            raise ValueError("scenarios: wear_coefficient takes the law of the design, for a number of cycles")
    names = [*paths_of(given.contact), *(f"wear_coefficient {name}" for name in paths_of(own_law))]
    leaves, rebuild = jax.tree.flatten((given.contact, own_law))
    leaves = [np.asarray(leaf, float) for leaf in leaves]
    own = own_axes(contact, len(leaves))
    shapes = {name: leaf.shape[: leaf.ndim - n] for name, leaf, n in zip(names, leaves, own, strict=True)}
    force = None if given.tangential_force is None else np.asarray(given.tangential_force, float)
    if force is not None:
        check("scenarios: tangential_force", np.nan_to_num(force), FORCE)
        shapes["tangential_force"] = force.shape
    if given.weight is not None:
        check("scenarios: weight", given.weight, WEIGHT)
        shapes["weight"] = np.shape(given.weight)
    try:
        (count,) = np.broadcast_shapes((1,), *shapes.values())
        alike = all(shape in ((), (count,)) for shape in shapes.values())
    except ValueError:
        count, alike = 0, False
    if not alike:
        told = ", ".join(f"{name} {shape}" for name, shape in shapes.items() if shape)
        raise ValueError(f"scenarios: all numbers must have one leading axis (n,), or none; their shapes are {told}")
    weight = np.ones(count) if given.weight is None else np.broadcast_to(np.asarray(given.weight, float), (count,))
    if not np.any(weight > 0.0):
        raise ValueError("scenarios: weight: all weights are zero")
    each = [np.broadcast_to(leaf, (count, *leaf.shape[leaf.ndim - n :])) for leaf, n in zip(leaves, own, strict=True)]
    batch, laws = jax.tree.unflatten(rebuild, each)
    forces = None if force is None else np.broadcast_to(force, (count,))
    return ScenarioBatch(batch, laws, shares(weight), forces, level)
