"""The numbers that tables and pictures of the wear over cycles show."""

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import CYCLES, POSITIVE, ArrayLike, check, guarded
from plgwear_jax._core.numbers import for_numbers
from plgwear_jax._startup.programs import program
from plgwear_jax.contact.engines import check_closed, run_of, test_of
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.shapes.of_contact import unworn_of
from plgwear_jax.steady.closed import ClosedSteady
from plgwear_jax.steady.solution import Steady

if TYPE_CHECKING:
    from plgwear_jax.wear.run import Run
    from plgwear_jax.wear_laws import WearLaw


@dataclasses.dataclass(frozen=True)
class WearOverCycles:
    """A contact under fretting after some numbers of cycles, in SI units.

    Attributes:
        cycles: The numbers of cycles, shape (n,).
        volume: Worn volume in m^3, shape (n,).
        volume_per_cycle: Volume in m^3 worn in the next cycle, shape (n,).
        energy_per_cycle: Energy in J that friction dissipates in the next cycle, shape (n,).
        contact_radius: Contact radius in m, shape (n,).
        stick_radii: Radius in m inside which the contact sticks, shape (n,); 0 in gross slip.
        deepest_wear: Largest worn depth in m at any of the radii below, shape (n,).
        radii: Radii in m, shape (r,): 0 to 1.15 times the worn radius, most of them in the worn ring.
        unworn: Height of the unworn indenter above its apex in m at these radii, shape (r,).
        depth: Worn depth in m at these radii, shape (n, r).
        pressure: Pressure in Pa at these radii, shape (n, r).
        steady_volume: Worn volume in m^3 in the steady state, Eq. (28); None without a steady state, as in gross slip.
        stick_radius: Inner radius of the worn ring in m, Eq. (16); 0 if some of these cycles slip as a whole.
        worn_radius: Outer radius of the worn ring in the steady state in m, Eq. (26), or else after the last cycle.
        initial_pressure: Pressure p_0 in Pa at the radii before any wear, Eq. (13), shape (r,).
        steady_depth: Worn depth in m at the radii in the steady state, Eqs. (24) and (25), shape (r,), or None.
        steady_pressure: Pressure in Pa at the radii in the steady state, Eq. (17), shape (r,), or None.
    """

    cycles: np.ndarray
    volume: np.ndarray
    volume_per_cycle: np.ndarray
    energy_per_cycle: np.ndarray
    contact_radius: np.ndarray
    stick_radii: np.ndarray
    deepest_wear: np.ndarray
    radii: np.ndarray
    unworn: np.ndarray
    depth: np.ndarray
    pressure: np.ndarray
    steady_volume: float | None
    stick_radius: float
    worn_radius: float
    initial_pressure: np.ndarray
    steady_depth: np.ndarray | None
    steady_pressure: np.ndarray | None

    @property
    def regime(self) -> str:
        """How the contact slips in these cycles, in words."""
        gross = self.stick_radii <= 0.0
        if gross.all():
            return "gross slip"
        return "gross slip, then partial slip" if gross[0] else "partial slip" if not gross.any() else "mixed slip"


_INSIDE, _RING, _OUTSIDE = 61, 121, 9  # numbers of radii inside the worn ring, in it, and outside


class _Ends(NamedTuple):
    """The quantities that do not depend on the number of cycles."""

    stick_radius: Any
    worn_radius: Any
    radii: Any
    initial_pressure: Any
    steady_volume: Any
    steady_depth: Any
    steady_pressure: Any


def _radii(c: Array, worn: Array) -> Array:
    # Radii crowd at the stick edge, where all quantities may have infinite slopes.
    inside = c * (1.0 - jnp.linspace(1.0, 0.0, _INSIDE, endpoint=False) ** 4)
    ring = c + (worn - c) * jnp.linspace(0.0, 1.0, _RING) ** 2
    return jnp.concatenate([inside, ring, worn * jnp.linspace(1.0, 1.15, _OUTSIDE)[1:]])


@program()
def _ends(steady: Steady) -> _Ends:
    c, worn = steady.stick_radius, steady.worn_radius
    r = _radii(c, worn)
    return _Ends(c, worn, r, steady.initial_pressure(r), steady.wear_volume, steady.wear_depth(r), steady.pressure(r))


def reduced_cycles(contact: Any, wear_coefficient: ArrayLike, *, contact_radius: ArrayLike | None = None) -> Array:
    """Reduced cycles n of `transient` per cycle of the contact: 4 K mu theta F_N/(pi a_0^2).

    Args:
        contact: The contact.
        wear_coefficient: Archard's K in 1/Pa, positive.
        contact_radius: a_0 in m, positive, if it is known; by default it is computed.

    Returns:
        n for one cycle, broadcast over the fields and the coefficient.

    Raises:
        ValueError: The coefficient is outside its range.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.2, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> from plgwear_jax.contact import reduced_cycles
        >>> print(f"{reduced_cycles(contact, 1e-14):.3e}")
        1.365e-05

    References:
        `docs/explanation/theory.md`, "Wear over cycles".
    """
    check_closed(contact, "wear over cycles")
    a_0 = None if contact_radius is None else guarded("contact_radius", contact_radius, POSITIVE)
    return _reduced(contact, guarded("wear_coefficient", wear_coefficient, POSITIVE), a_0)


@jax.jit
def _reduced(contact: Any, wear_coefficient: Array, contact_radius: Array | None) -> Array:
    steady = ClosedSteady(contact, 0.0)
    a_0 = steady.contact_radius if contact_radius is None else contact_radius
    mean_pressure = jnp.asarray(contact.normal_force) / (jnp.pi * a_0 * a_0)
    return 4.0 * jnp.asarray(contact.friction) * steady.tangential_ratio * wear_coefficient * mean_pressure


@for_numbers("contact.cycles_to(shares, F_x, wear_coefficient) works there")
def cycles_to_shares(
    contact: Any,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    shares: ArrayLike,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> np.ndarray:
    """The cycles after which shares of the final volume are worn; the arguments are those of `wear_over_cycles`.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.2, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> from plgwear_jax.contact import cycles_to_shares
        >>> print([f"{cycles:.2e}" for cycles in cycles_to_shares(contact, 2.0, 1e-14, [0.5, 0.9])])
        ['1.98e+05', '4.49e+05']

    References:
        `docs/explanation/theory.md`, "Wear over cycles".
    """
    check("tangential_force", tangential_force, POSITIVE)
    run = run_of(contact, tangential_force, wear_coefficient, control, rig_stiffness)
    return np.asarray(run.cycles_to(shares))


@for_numbers("contact.over_cycles(load, law).volume(cycles) and its sisters work there")
def wear_over_cycles(
    contact: Any,
    load: "ArrayLike | Force | Displacement | Sequence[Block]",
    law: "ArrayLike | WearLaw",
    cycles: ArrayLike,
    *,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
) -> WearOverCycles:
    """The wear of a test over cycles, as tables and pictures show it.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact; its fields are numbers.
        load: A force amplitude F_x in N, 0 < F_x < mu F_N, or another load of `FrettingContact.over_cycles`.
        law: Archard's K in 1/Pa, positive, or a wear law.
        cycles: Numbers of cycles, shape (n,), >= 0 and finite.
        control: Which amplitude is constant, see `FrettingContact.wear_volume`. For "displacement" F_x is the force
            amplitude before any wear, and the steady quantities are the final ones of the run, not Eqs. (17) to (28).
        rig_stiffness: Rig stiffness in N/m, if the displacement is measured at its actuator.

    Returns:
        Volumes, radii, depths and pressures, to the digits of `FrettingContact.over_cycles`.

    Raises:
        ValueError: An argument is outside its range.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.2, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> from plgwear_jax.contact import wear_over_cycles
        >>> found = wear_over_cycles(contact, 2.0, 1e-14, [1e5, 1e6])
        >>> print(found.regime, [f"{volume:.2e}" for volume in found.volume])  # m^3
        partial slip ['1.95e-16', '7.93e-16']

    References:
        `docs/explanation/theory.md`, "Wear over cycles", "Any test".
    """
    check("cycles", cycles, CYCLES)
    if not isinstance(load, Force | Displacement | list | tuple):
        check("tangential_force", load, POSITIVE)  # pyright: ignore[reportArgumentType]
    if control == "force" and rig_stiffness is None:
        run = test_of(contact, load, law, None)
    else:
        run = run_of(contact, load, law, control, rig_stiffness)  # pyright: ignore[reportArgumentType]
    return read(run, np.asarray(cycles))


def read(run: "Run", cycles: np.ndarray) -> WearOverCycles:
    """Read a run of one contact after numbers of cycles of shape (n,)."""
    # As arrays of NumPy, so that the arithmetic that remains compiles nothing.
    steady = run.steady
    ends = None if steady is None else jax.tree.map(np.asarray, _ends(steady))
    stick, widest = np.asarray(run.stick_radius(cycles)), np.asarray(run.contact_radius(cycles))
    r = np.asarray(_radii(stick.min(), np.nanmax(widest))) if ends is None else ends.radii
    last = np.append(cycles, np.asarray(run.lasting_cycles))
    volume, radius = np.asarray(run.volume(last)), np.asarray(run.contact_radius(last))
    depth, pressure = np.asarray(run.depth(r, last[:, None])), np.asarray(run.pressure(r, last[:, None]))
    given = {
        "cycles": cycles,
        "volume": volume[:-1],
        "volume_per_cycle": np.asarray(run.rate(cycles)),
        "energy_per_cycle": np.asarray(run.energy_per_cycle(cycles)),
        "contact_radius": radius[:-1],
        "stick_radii": np.broadcast_to(stick, cycles.shape),
        "deepest_wear": depth[:-1].max(axis=-1),
        "radii": r,
        "unworn": unworn_of(run.contact)(r),
        "depth": depth[:-1],
        "pressure": pressure[:-1],
    }
    if ends is None:
        before = np.asarray(run.contact.steady(0.0).initial_pressure(r))
        last_radius = float(np.nanmax(widest))
        return WearOverCycles(
            **given,
            steady_volume=None,
            stick_radius=float(stick.min()),
            worn_radius=last_radius,
            initial_pressure=before,
            steady_depth=None,
            steady_pressure=None,
        )
    own = run.ends_otherwise
    return WearOverCycles(
        **given,
        steady_volume=float(volume[-1] if own else ends.steady_volume),
        stick_radius=float(ends.stick_radius),
        worn_radius=float(radius[-1] if own else ends.worn_radius),
        initial_pressure=ends.initial_pressure,
        steady_depth=depth[-1] if own else ends.steady_depth,
        steady_pressure=pressure[-1] if own else ends.steady_pressure,
    )


# --- blocks of cycles -------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class WearByBlocks:
    """A contact after each block of cycles, in SI units; all attributes have the shape (blocks,).

    Attributes:
        cycles: Numbers of cycles since the beginning.
        normal_force: Normal force in N in the block.
        friction: Coefficient of friction in the block.
        tangential_force: Force amplitude in N at the end of the block; under displacement control it changes within.
        volume: Volume in m^3 worn since the beginning.
        volume_per_cycle: Volume in m^3 worn in the last cycle of the block.
        deepest_wear: Largest worn depth in m.
        contact_radius: Contact radius in m.
        stick_radius: Stick radius in m at the end of the block; 0 in gross slip.
    """

    cycles: np.ndarray
    normal_force: np.ndarray
    friction: np.ndarray
    tangential_force: np.ndarray
    volume: np.ndarray
    volume_per_cycle: np.ndarray
    deepest_wear: np.ndarray
    contact_radius: np.ndarray
    stick_radius: np.ndarray


@for_numbers("contact.over_cycles(blocks, law) works there")
def wear_by_blocks(contact: Any, blocks: Sequence[Block], law: "ArrayLike | WearLaw") -> WearByBlocks:
    """The wear over blocks of cycles, each of which begins with the worn shape that the blocks before have left.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        contact: The contact; its fields are numbers.
        blocks: One `Block` or more: an amplitude, a number of cycles, if wanted a normal force and a friction.
        law: Archard's K in 1/Pa, positive, or a wear law.

    Returns:
        Volumes, forces and radii after each block. Volumes have errors up to 1 % of the last one, or of the final one
        at the largest amplitude, and up to 2 % under displacement control.

    Raises:
        ValueError: An argument is outside its range, or there are no blocks.

    References:
        `docs/explanation/theory.md`, "Any test".
    """
    blocks = tuple(blocks)
    if not blocks or not all(isinstance(block, Block) for block in blocks):
        raise ValueError("blocks takes one Block or more")
    return read_blocks(test_of(contact, blocks, law, None))


def read_blocks(run: "Run") -> WearByBlocks:
    """Read a run of blocks of one contact at the end of each of them."""
    from plgwear_jax.wear.marched import MarchedRun  # imported by the first contact that needs it

    assert isinstance(run, MarchedRun)
    return WearByBlocks(**jax.tree.map(np.asarray, run.at_block_ends()))
