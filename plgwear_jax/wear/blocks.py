"""The wear of a contact by blocks of cycles of different amplitudes, in SI units."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import POSITIVE, check
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax.contact.arguments import NUMBER, held, is_closed, refuse_control
from plgwear_jax.contact.dispatch import closed_form_of
from plgwear_jax.contact.fretting_contact import FrettingContact

__all__ = ["WearByBlocks", "wear_by_blocks"]


@dataclasses.dataclass(frozen=True)
class WearByBlocks:
    """A contact after each block of cycles, in SI units, each shape (blocks,).

    Attributes:
        cycles: Numbers of cycles since the beginning.
        tangential_force: The amplitude in N at the end of the block; at a held displacement it has fallen.
        volume: The volume in m^3 worn since the beginning.
        volume_per_cycle: What the last cycle of the block wears in m^3.
        contact_radius: In m.
        stick_radius: The radius in m in which nothing slips at the end of the block.
    """

    cycles: np.ndarray
    tangential_force: np.ndarray
    volume: np.ndarray
    volume_per_cycle: np.ndarray
    contact_radius: np.ndarray
    stick_radius: np.ndarray


@jax.jit
def _numbers(
    contact: FrettingContact, force: Array, wear_coefficient: Array, rig_stiffness: Array | None
) -> tuple[Any, ...]:
    a_0 = contact.contact_radius()
    n = contact._reduced(a_0, 1.0, wear_coefficient, None)
    return contact.amplitude(force), n, a_0, contact._height(a_0), contact._displacements(rig_stiffness, None)[1]


@for_numbers("transient.blocks works there")
def wear_by_blocks(
    contact: FrettingContact,
    tangential_force: ArrayLike,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> WearByBlocks:
    """The wear by blocks of cycles, each of which goes on from the shape that those before have left.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact; its fields are numbers.
        tangential_force: The force amplitude F_x of each block in N, shape (blocks,), 0 <= F_x < mu F_N.
        cycles: Numbers of cycles of each block, shape (blocks,), >= 0 and finite.
        wear_coefficient: Archard's K in 1/Pa, positive.
        control: What is held in a block, the amplitude of the "force", or of the "displacement" that goes with F_x
            before any wear.
        rig_stiffness: In N/m, of the rig whose displacement is held.

    Returns:
        Volumes, forces and radii after each block, to the digits of `transient.blocks`.

    Raises:
        ValueError: An argument is outside its range, or the blocks have not all an amplitude and a number of cycles.
    """
    from plgwear_jax import transient

    tangential_force, cycles = np.asarray(tangential_force), np.asarray(cycles)
    refuse_control(control, True, rig_stiffness is not None)
    if not is_closed(contact):
        contact = closed_form_of(contact) or contact
    check("wear_coefficient", wear_coefficient, POSITIVE)
    check("cycles", cycles, NUMBER)
    if rig_stiffness is not None:
        check("rig_stiffness", rig_stiffness, POSITIVE)
    contact.amplitude(tangential_force)  # refuses gross slip
    if tangential_force.ndim != 1 or tangential_force.shape != cycles.shape or not cycles.size:
        shapes = f"{tangential_force.shape} and {cycles.shape}"
        raise ValueError(f"tangential_force and cycles take one number a block, not arrays of the shapes {shapes}")
    so_far = np.cumsum(cycles.astype(float))
    if not is_closed(contact):
        from plgwear_jax.wear.numeric_blocks import by_blocks

        numeric = by_blocks(contact, tangential_force, cycles, wear_coefficient, control, rig_stiffness)
        return WearByBlocks(cycles=so_far, **numeric)
    given = contact, tangential_force, wear_coefficient, rig_stiffness
    phi, n, a_0, height, compliance = (
        np.asarray(x) for x in _numbers(*jax.tree.map(lambda x: jnp.asarray(x, float), given))
    )
    blocks = transient.blocks(contact.material.k, phi, n * cycles, **held(control, compliance))
    found = jax.tree.map(np.asarray, blocks)
    volume = a_0 * a_0 * height
    return WearByBlocks(
        cycles=so_far,
        tangential_force=found.amplitude * np.asarray(contact.friction) * np.asarray(contact.normal_force),
        volume=volume * found.volume,
        volume_per_cycle=volume * n * found.wear_rate,
        contact_radius=a_0 * found.contact_radius,
        stick_radius=a_0 * found.stick_radius,
    )
