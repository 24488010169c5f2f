"""A design for a life: after how many cycles the wear counts, by which wear law, and which amplitude the rig holds."""

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.record import record, static
from plgwear_jax.catalogue import read
from plgwear_jax.contact import FrettingContact
from plgwear_jax.loads import Displacement
from plgwear_jax.rules import BY_THEN, is_after_cycles, one_of
from plgwear_jax.steady.arguments import check_life, refuse_control
from plgwear_jax.wear_laws import Archard, WearLaw


@record
class Life:
    """After how many cycles the wear of a design counts, and how the contact wears until then.

    Attributes:
        cycles: How many.
        law: The wear law.
        rig_stiffness: Stiffness in N/m of a rig in series with the contact, whose displacement is held; None without.
        displacement_amplitude: Amplitudes of the displacement in m, one for each amplitude of the force, to which they
            belong before any wear of the reference; None at a held force.
        control: Which amplitude is held, that of the "force" or of the "displacement".
    """

    cycles: ArrayLike
    law: WearLaw
    rig_stiffness: ArrayLike | None = None
    displacement_amplitude: Any = None
    control: str = static(default="force")

    @property
    def smooth(self) -> bool:
        """Whether wear by then and its slopes agree to many digits: a march of any test has about two."""
        return self.control == "force" and isinstance(self.law, Archard)

    def under(self, contact: FrettingContact, tangential_force: ArrayLike) -> "Life":
        """The same with the displacements that belong to force amplitudes before any wear, if these are held."""
        if self.control == "force":
            return self
        moved = contact.displacement_amplitude(tangential_force, rig_stiffness=self.rig_stiffness)
        return dataclasses.replace(self, displacement_amplitude=moved)

    def scaled(self, factor: ArrayLike) -> "Life":
        """The same with other displacements, if these are held."""
        if self.displacement_amplitude is None:
            return self
        return dataclasses.replace(self, displacement_amplitude=factor * jnp.asarray(self.displacement_amplitude))

    def read(
        self,
        contact: FrettingContact,
        tangential_force: ArrayLike,
        name: str,
        places: Mapping[str, ArrayLike],
        lives: ArrayLike = 1.0,
        solved: dict[Any, Any] | None = None,
    ) -> Array:
        """What a contact has of a quantity by then, or after so many lives, at each amplitude; `solved`: see `read`."""
        held = self.displacement_amplitude
        load = tangential_force if held is None else Displacement(held, self.rig_stiffness)
        given = {**places, "cycles": jnp.asarray(self.cycles) * lives, "wear_coefficient": self.law}
        return read(contact, BY_THEN.get(name, name), load, given, solved=solved)


def life_of(
    objective: str,
    limits: Iterable[str],
    cycles: ArrayLike | None,
    wear_coefficient: ArrayLike | WearLaw | None,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> Life | None:
    """The life, None for the steady state, or a ValueError; the arguments are those of `design`, of limits names."""
    if control != "force":
        from plgwear_jax.transient.held_displacement import check_control  # seldom needed, and takes time

        check_control(control)
    check_life(cycles, wear_coefficient)
    refuse_control(control, cycles is not None, rig_stiffness is not None)
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
    law = wear_coefficient if isinstance(wear_coefficient, WearLaw) else Archard(wear_coefficient)
    return Life(cycles, law, rig_stiffness, control=control)
