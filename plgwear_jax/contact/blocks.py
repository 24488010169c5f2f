"""The wear of a contact by blocks of cycles of different amplitudes, in SI units."""

import dataclasses
from typing import Any

import jax
import numpy as np
from jax.typing import ArrayLike

from plgwear_jax._core.domains import CYCLES, check
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax.contact.engines import run_of

__all__ = ["WearByBlocks", "wear_by_blocks"]


@dataclasses.dataclass(frozen=True)
class WearByBlocks:
    """A contact after each block of cycles, in SI units; all attributes have the shape (blocks,).

    Attributes:
        cycles: Numbers of cycles since the beginning.
        tangential_force: Force amplitude in N at the end of the block; under displacement control it falls in a block.
        volume: Volume in m^3 worn since the beginning.
        volume_per_cycle: Volume in m^3 worn in the last cycle of the block.
        contact_radius: Contact radius in m.
        stick_radius: Stick radius in m at the end of the block.
    """

    cycles: np.ndarray
    tangential_force: np.ndarray
    volume: np.ndarray
    volume_per_cycle: np.ndarray
    contact_radius: np.ndarray
    stick_radius: np.ndarray


@for_numbers("transient.blocks works there")
def wear_by_blocks(
    contact: Any,
    tangential_force: ArrayLike,
    cycles: ArrayLike,
    wear_coefficient: ArrayLike,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> WearByBlocks:
    """The wear over blocks of cycles, each of which begins with the worn shape that the blocks before have left.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact; its fields are numbers.
        tangential_force: The force amplitude F_x of each block in N, shape (blocks,), 0 <= F_x < mu F_N.
        cycles: Numbers of cycles of each block, shape (blocks,), >= 0 and finite.
        wear_coefficient: Archard's K in 1/Pa, positive.
        control: Which amplitude is constant in a block, that of the "force", or of the "displacement" that F_x causes
            before any wear.
        rig_stiffness: Stiffness in N/m of a rig in series, if the displacement is measured at its actuator.

    Returns:
        Volumes, forces and radii after each block, with the errors stated in `transient.blocks`.

    Raises:
        ValueError: An argument is outside its range, or there are not as many amplitudes as numbers of cycles.
    """
    tangential_force, cycles = np.asarray(tangential_force), np.asarray(cycles)
    check("cycles", cycles, CYCLES)
    run = run_of(contact, tangential_force, wear_coefficient, control, rig_stiffness)
    if tangential_force.ndim != 1 or tangential_force.shape != cycles.shape or not cycles.size:
        shapes = f"{tangential_force.shape} and {cycles.shape}"
        raise ValueError(f"tangential_force and cycles take one number a block, not arrays of the shapes {shapes}")
    so_far = np.cumsum(cycles.astype(float))
    return WearByBlocks(cycles=so_far, **jax.tree.map(np.asarray, run.by_blocks(cycles)))
