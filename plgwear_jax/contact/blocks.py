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
    tangential_force, cycles = np.asarray(tangential_force), np.asarray(cycles)
    check("cycles", cycles, CYCLES)
    run = run_of(contact, tangential_force, wear_coefficient, control, rig_stiffness)
    if tangential_force.ndim != 1 or tangential_force.shape != cycles.shape or not cycles.size:
        shapes = f"{tangential_force.shape} and {cycles.shape}"
        raise ValueError(f"tangential_force and cycles take one number a block, not arrays of the shapes {shapes}")
    so_far = np.cumsum(cycles.astype(float))
    return WearByBlocks(cycles=so_far, **jax.tree.map(np.asarray, run.by_blocks(cycles)))
