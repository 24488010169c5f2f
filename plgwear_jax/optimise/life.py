"""A design for a life: after how many cycles the wear counts, by which wear law, and which amplitude the rig holds."""

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import POSITIVE, ArrayLike, check
from plgwear_jax._core.record import record, static
from plgwear_jax.catalogue import QUANTITIES, read
from plgwear_jax.contact import FrettingContact
from plgwear_jax.loads import Displacement, Force, load_of
from plgwear_jax.rules import BY_THEN, is_after_cycles, one_of
from plgwear_jax.wear_laws import Archard, WearLaw, law_of


@record
class Life:
    """After how many cycles the wear of a design counts, and how the contact wears until then.

    Attributes:
        cycles: How many.
        law: The wear law.
        load: The load of all candidates, a `Displacement` or a tuple of `Block`; None under amplitudes of the force.
            For `control` "displacement" it is what these amplitudes cause before any wear of the reference.
        rig_stiffness: Rig stiffness in N/m for this displacement; None without.
        tangential_force: The force amplitude in N that replaces this displacement where it is no NaN; None if it never
            does.
        control: What is held, the amplitude of the "force" or of the "displacement", or "blocks" of several loads.
    """

    cycles: ArrayLike
    law: WearLaw
    load: Any = None
    rig_stiffness: ArrayLike | None = None
    tangential_force: ArrayLike | None = None
    control: str = static(default="force")

    @property
    def smooth(self) -> bool:
        """Whether wear by then and its slopes agree to many digits: a march of any test has about two."""
        return self.control == "force" and isinstance(self.law, Archard)

    def under(self, contact: FrettingContact, tangential_force: ArrayLike) -> "Life":
        """The same with the displacements that belong to force amplitudes before any wear, if these are held."""
        if self.control == "force" or self.load is not None:
            return self
        moved = contact.steady(Force(tangential_force, self.rig_stiffness)).displacement_amplitude
        return dataclasses.replace(self, load=Displacement(moved, self.rig_stiffness))

    def with_amplitudes(self, change: Callable[[Any], Any]) -> "Life":
        """The same with other amplitudes of its load, if it has one."""
        if self.load is None:
            return self
        force = None if self.tangential_force is None else change(self.tangential_force)
        return dataclasses.replace(self, load=with_amplitudes(self.load, change), tangential_force=force)

    def read(
        self,
        contact: FrettingContact,
        tangential_force: ArrayLike,
        name: str,
        places: Mapping[str, ArrayLike],
        lives: Any = 1.0,
        solved: dict[Any, Any] | None = None,
    ) -> Array:
        """What a contact has of a quantity by then, or after so many lives, at each amplitude; `solved`: see `read`."""
        given = {**places, "cycles": jnp.asarray(self.cycles) * lives, "wear_coefficient": self.law}

        def under(load: Any, solved: dict[Any, Any] | None = None) -> Array:
            return read(contact, BY_THEN.get(name, name), load, given, solved=solved)

        if self.tangential_force is None:
            return under(tangential_force if self.load is None else self.load, solved)
        known = jnp.asarray(self.tangential_force)
        slips = jnp.all(jnp.isnan(known))
        some = 0.5 * jnp.min(jnp.asarray(contact.friction) * contact.normal_force)  # any, where it is not read
        force = jnp.where(slips, some, known)
        return jax.lax.cond(slips, lambda: under(self.load), lambda: under(force))


def with_amplitudes(load: Any, change: Callable[[Any], Any]) -> Any:
    """A load with other amplitudes: an amplitude of the force, a load of `loads`, or a tuple of blocks."""
    return load_of(load).with_amplitude(change)


def life_of(
    objective: str,
    limits: Iterable[str],
    cycles: ArrayLike | None,
    wear_coefficient: ArrayLike | WearLaw | None,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    load: Any = None,
) -> Life | None:
    """The life, None for the steady state, or a ValueError; the arguments are those of `design`, of limits names.

    A `load` is none of force amplitudes.
    """
    if load is not None:
        if control != "force" or rig_stiffness is not None:
            raise ValueError("control, rig_stiffness: belong to amplitudes of the force; this load says what is held")
        control = "blocks" if not load.lasts else "displacement"
        if cycles is None:
            raise ValueError(f"cycles: {never_steady(load)}")
        steady = [name for name in limits if needs_force(name)]
        if steady:
            text = f"is a limit of the steady state under one amplitude of the force, not under {_held(load)}"
            raise ValueError(f"limits.{steady[0]}: {text}")
    if (cycles is None) != (wear_coefficient is None):
        raise TypeError("cycles and wear_coefficient go together: one needs the other")
    lasting = [name for name in (objective, *limits) if is_after_cycles(name)]
    if cycles is None or wear_coefficient is None:
        if lasting:
            raise ValueError(f"{lasting[0]}: is a quantity after a life, which needs cycles and wear_coefficient")
        return None
    if objective not in BY_THEN and not lasting:
        text = f"the {objective} is minimised in the steady state; after cycles {one_of(tuple(BY_THEN))}"
        raise ValueError(f"cycles: {text}")
    check("cycles", cycles, POSITIVE)
    if rig_stiffness is not None:
        check("rig_stiffness", rig_stiffness, POSITIVE)
    return Life(cycles, law_of(wear_coefficient), load, rig_stiffness, control=control)


def _held(load: Any) -> str:
    return "blocks of several loads" if not load.lasts else "a displacement, which is held"


def never_steady(load: Any) -> str:
    """Why a `Displacement`, or a tuple of `Block`, has no steady state."""
    return f"wear under {_held(load)}, ends in no steady state of Eq. (28)"


def needs_force(name: str) -> bool:
    """Whether a quantity is that of the steady state under an amplitude of the force."""
    law = QUANTITIES["fretting"].get(name)
    return law is not None and "F_x" in law.arguments


def amplitudes_and_test(load: Any, weight: ArrayLike | None) -> tuple[Any, Any]:
    """(Amplitudes of the force in N, None), or (NaN, a `Displacement` or tuple of `Block`), which have no weight."""
    if load is None:
        return None, None
    load = load_of(load)
    if load.holds_force:
        return load.tangential_force, None
    if weight is not None:
        raise ValueError("weight: belongs to several amplitudes of the force")
    return np.nan, load
