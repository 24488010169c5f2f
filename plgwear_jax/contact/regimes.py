"""Partial or gross slip over displacement amplitude and normal force, with the loop of force and displacement."""

import dataclasses
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import POSITIVE, ArrayLike, Domain, RefusedError, check, concrete_only
from plgwear_jax._core.doubts import doubt, of_onset
from plgwear_jax._core.startup.programs import program
from plgwear_jax.loads import Force

from .fretting_contact import check_fretting_contact, is_closed

CRITERIA: dict[Literal["energy_ratio", "loop_aperture"], float] = {"energy_ratio": 0.2, "loop_aperture": 0.26}
"""By which laboratories tell partial from gross slip; right for a homogeneous body under a parabola alone."""

_MOVES = Domain("> 0 and finite, in m", POSITIVE.contains)


@dataclasses.dataclass(frozen=True)
class SlipRegimes:
    """A contact before any wear over n displacement amplitudes and m normal forces, in SI units.

    With a rig stiffness the displacement is that at the actuator, and the loop is that measured there.

    Attributes:
        displacement_amplitude: The displacement amplitudes in m, increasing, shape (n,).
        normal_force: The normal forces in N, shape (m,).
        gross_slip_displacement: Displacement amplitude in m from which on the whole contact slips, shape (m,).
        gross_slip_energy_ratio: Energy ratio at this transition, shape (m,).
        gross_slip_aperture: Sliding ratio at this transition, shape (m,).
        gross_slip: Whether the whole contact slips, shape (m, n); else the slip is partial.
        tangential_force: Amplitude of the tangential force in N, mu F_N in gross slip, shape (m, n).
        energy_ratio: Energy of a cycle over 4 F_x times the displacement amplitude, shape (m, n).
        loop_aperture: Displacement at no force over the displacement amplitude, shape (m, n).
    """

    displacement_amplitude: np.ndarray
    normal_force: np.ndarray
    gross_slip_displacement: np.ndarray
    gross_slip_energy_ratio: np.ndarray
    gross_slip_aperture: np.ndarray
    gross_slip: np.ndarray
    tangential_force: np.ndarray
    energy_ratio: np.ndarray
    loop_aperture: np.ndarray

    @property
    def energy_per_cycle(self) -> np.ndarray:
        """Energy in J that friction dissipates in a cycle, shape (m, n)."""
        return 4.0 * self.energy_ratio * self.tangential_force * self.displacement_amplitude

    def displacement_where(self, name: Literal["energy_ratio", "loop_aperture"], value: float) -> np.ndarray:
        """Displacement amplitude in m at which a quantity has a value, as a criterion of gross slip, shape (m,).

        Exact in gross slip; in partial slip interpolated between the amplitudes, and NaN below the smallest one.

        Args:
            name: The quantity.
            value: Its value, below 1.
        """
        at_onset = {"energy_ratio": self.gross_slip_energy_ratio, "loop_aperture": self.gross_slip_aperture}[name]
        sliding = (1.0 - at_onset) / (1.0 - value) * self.gross_slip_displacement
        rows = zip(getattr(self, name), self.gross_slip, at_onset, self.gross_slip_displacement, strict=True)
        within = []
        for values, slips, end, onset in rows:
            known = np.append(values[~slips], end), np.append(self.displacement_amplitude[~slips], onset)
            within.append(np.interp(value, *known, left=np.nan))
        return np.where(value < at_onset, np.array(within), sliding)


class _Loops(NamedTuple):
    """The loops of some contacts, at the actuator where there is a rig, each of shape (m, n) or (m, 1)."""

    force: Any
    displacement: Any
    energy_ratio: Any
    aperture: Any


@program(static=2, level=1)
def _loops_at(
    digits: int | None, closed: bool, contact: Any, limit: Array, rig_stiffness: Array | None, at: Array
) -> tuple[_Loops, _Loops]:
    """(The loops at the transition to gross slip, those at displacements, or at `_SHARES` of a numeric contact)."""
    at_rest = contact.steady(Force(0.0, rig_stiffness), digits=digits)
    begins = at_rest.gross_slip_displacement, at_rest.gross_slip_energy_ratio, at_rest.gross_slip_aperture
    onset = _Loops(limit, *(jnp.broadcast_to(x, limit.shape) for x in begins))
    if closed:
        # Where the contact slides, some partial slip stands in: what it gives is not read.
        force = at_rest.force_at(jnp.where(at < _NEAR * onset.displacement, at, 0.5 * onset.displacement))
    else:
        force = at * limit
    steady = contact.steady(Force(force, rig_stiffness), digits=digits)
    return onset, _Loops(force, steady.displacement_amplitude, steady.energy_ratio, steady.loop_aperture)


_NEAR = 1.0 - 1e-7  # displacement over that of the transition from which on loops are those of the transition
# Amplitudes phi between which the loops of a numeric contact are interpolated, dense at both ends.
_SHARES = 1.0 - (0.5 + 0.5 * np.cos(np.pi * np.arange(1, 20) / 20)) ** 2.5


@concrete_only("the quantities of contact.steady(load) work there")
def slip_regimes(
    contact: Any,
    displacement_amplitude: ArrayLike,
    normal_force: ArrayLike,
    *,
    rig_stiffness: float | None = None,
    digits: int | None = None,
) -> SlipRegimes:
    """Partial or gross slip over displacement amplitude and normal force, before any wear.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    The normal force is constant during a cycle, so that the loop follows from the first loading by Masing's rule. In
    gross slip the energy ratio is 1 - (1 - A_g) u_g/u and the sliding ratio 1 - (1 - D_g) u_g/u, with the displacement
    amplitude u and with u_g, A_g and D_g those of the transition.

    Args:
        contact: A `FrettingContact` of any kind whose fields are numbers; its own normal force is not used.
        displacement_amplitude: Displacement amplitudes in m, positive and increasing, shape (n,).
        normal_force: Normal forces in N, positive, shape (m,).
        rig_stiffness: Rig stiffness in N/m, if the displacement is measured at its actuator.
        digits: Correct digits wanted; by default all that the solver has, see `FrettingContact`. A numerical contact is
            solved at 19 amplitudes of the force for each normal force, and its loops are interpolated.

    Returns:
        The regime, the force amplitude, the energy ratio and the sliding ratio at each pair.

    Raises:
        ValueError: An argument is outside its range, or no row of numbers.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> from plgwear_jax.contact import slip_regimes
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.5, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> found = slip_regimes(contact, [3e-7, 1e-6, 3e-6], [5.0, 20.0])
        >>> found.gross_slip
        array([[False,  True,  True],
               [False, False,  True]])
        >>> found.gross_slip_energy_ratio.round(3)  # (1+k)/(5+k) at the transition to gross slip; 0.2 for k = 0
        array([0.273, 0.273])

    References:
        Fouvry, Kapsa and Vincent, Wear 185 (1995) 35-46; `docs/explanation/numerics.md`, "Wear over cycles".
    """
    check_fretting_contact(contact)
    check("displacement_amplitude", displacement_amplitude, _MOVES)
    check("normal_force", normal_force, POSITIVE)
    load = Force(0.0, rig_stiffness)
    moves, forces = np.asarray(displacement_amplitude, float), np.asarray(normal_force, float)
    for name, row in (("displacement_amplitude", moves), ("normal_force", forces)):
        if row.ndim != 1:
            raise ValueError(f"{name}: takes a row of numbers, not an array of shape {row.shape}")
    if np.any(np.diff(moves) < 0.0):
        raise ValueError("displacement_amplitude: the amplitudes must not decrease")
    of_all = dataclasses.replace(contact, normal_force=forces[:, None])
    limit = np.asarray(contact.friction, float) * forces[:, None]
    rig = float(load.rig_compliance)
    closed = is_closed(contact)
    onset, loops = jax.tree.map(
        np.asarray, _loops_at(digits, closed, of_all, limit, load.rig_stiffness, moves if closed else _SHARES)
    )
    unknown = np.isnan(onset.displacement)
    if unknown.any():
        told = "before any wear the contact would have to pull, or reaches beyond the table of its shape"
        raise RefusedError(f"normal_force = {forces[unknown[:, 0]][0]}: {told}")
    doubt(of_onset(onset.displacement - rig * limit))
    if not closed:
        loops = _between(loops, onset, moves, rig)
    slides = moves >= _NEAR * onset.displacement

    def over_both(partial: np.ndarray, at_onset: np.ndarray) -> np.ndarray:
        # Sliding adds a rectangle as high as the loop at the transition.
        sliding = 1.0 - (1.0 - at_onset) * np.minimum(onset.displacement / moves, 1.0)
        return np.where(slides, sliding, partial)

    return SlipRegimes(
        displacement_amplitude=moves,
        normal_force=forces,
        gross_slip_displacement=onset.displacement[:, 0],
        gross_slip_energy_ratio=onset.energy_ratio[:, 0],
        gross_slip_aperture=onset.aperture[:, 0],
        gross_slip=moves >= onset.displacement,
        tangential_force=np.where(slides, limit, loops.force),
        energy_ratio=over_both(loops.energy_ratio, onset.energy_ratio),
        loop_aperture=over_both(loops.aperture, onset.aperture),
    )


def _between(loops: _Loops, onset: _Loops, moves: np.ndarray, rig: float) -> _Loops:
    """Loops at displacement amplitudes, of a rig or not, from those at some force amplitudes; row by row."""
    from scipy.interpolate import CubicSpline

    rows = []
    for known in np.append(np.stack(loops, -1), np.stack(onset, -1), 1):
        own = known[:, 1] - rig * known[:, 0]  # the displacement of the contact itself, in which all are smooth
        over = CubicSpline(own, known / own[:, None])  # as all begin like the displacement
        places = np.linspace(0.0, own[-1], 4001)
        with_rig = places * over(places)[:, 1]
        at = CubicSpline(with_rig, places)(np.minimum(moves, with_rig[-1]))
        rows.append(at[:, None] * over(at))
    return _Loops(*np.moveaxis(np.array(rows), -1, 0))
