"""A march that knows the contact by its worn shape alone, whatever is held and however the amplitude changes.

The slip is the gap that the worn indenter leaves beside the contact of its stick area: pressed by what the tangential
force leaves of the normal one, or less deep by the displacement over mu theta. So each step solves two contacts of one
shape, and Archard's law goes by the gap of the one and the pressure of the other. `docs/theory.md` has the equations.
Cells are fixed, so that both edges are known to a cell.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.special.cholesky import backward, cholesky, forward
from plgwear_jax.transient.grid import Numbers, Ring

__all__ = ["Held", "Record", "StickArea", "march_of", "stick_area_of"]


class Held(NamedTuple):
    """What is held in a step: stiffness times displacement and share times amplitude add up to a value.

    The displacement is in units of mu theta times that of depths, the amplitude is that of the force over mu F_N.
    """

    of_displacement: Array
    of_force: Array
    value: Array


class Record(NamedTuple):
    """The state at the end of each step."""

    worn: Array  # h integrated over each cell, (steps, cells)
    pressure: Array
    slip: Array  # integrated over each cell
    edge: Array  # of the contact, T/C - 1
    stick: Array  # of the area that sticks, T/C - 1
    amplitude: Array  # of the force, over mu F_N


class StickArea(NamedTuple):
    """The smallest stick area, of the radius c, and what the ring around it does to it; loads are over F_N."""

    unworn: Array  # width of the unworn ring, in C
    amplitude: Array  # of the force that goes with c, over mu F_N: the unworn contact of the radius c carries the rest
    stiffness: Array  # load of a flat punch of the radius c by a unit of depth
    flat: Array  # the gap beside this punch, integrated over each cell
    scale: Array  # load of the ring at a held depth: scale times the sum of flat times pressure
    displacement: Array  # of the unworn contact, for the load of the tangential force that goes with c


def stick_area_of(ring: Ring, at: Numbers, phi: Array, unit: Array) -> StickArea:
    """That of a power law, with depths over C/2 and the ring in its unit of time."""
    stiffness = at.s * (1.0 + at.s) * at.powered * at.inner
    return StickArea(at.unworn, phi, stiffness, at.s * ring.swept, at.inner / unit, at.unworn / at.s)


class _Contact(NamedTuple):
    """A contact of a given shape at some depth, from one factorisation."""

    factor: Array  # of the compliance of the ring at a held depth
    sunk: Array  # what a unit of depth does, by forward substitution
    area: StickArea


def _contact_of(ring: Ring, area: StickArea) -> _Contact:
    size = ring.gap.size
    held = ring.compliance - area.scale / area.stiffness * area.flat[:, None] * area.flat[None, :]
    factor = cholesky(jnp.where(jnp.eye(size, dtype=bool) & (ring.gap <= 0.0)[:, None], 1.0, held))
    return _Contact(factor, forward(factor, area.flat), area)


def _leading(positive: Array) -> Array:
    """Which entries come before the first that is not positive."""
    return jnp.cumprod(positive.astype(jnp.int32)) == 1


def _at_depth(contact: _Contact, free: Array, depth: Array) -> tuple[Array, Array, Array]:
    """(Load, its slope by the depth, forward substitution in the cells that touch).

    The Cholesky factor of a leading block is the block of the factor: one forward substitution serves every radius, and
    the contact ends where it changes its sign.
    """
    found = free + depth * contact.sunk
    found = jnp.where(_leading(found > 0.0), found, 0.0)
    sunk = jnp.where(found > 0.0, contact.sunk, 0.0)
    area = contact.area
    load = 1.0 - area.amplitude + area.stiffness * depth + area.scale * (found @ contact.sunk)
    return load, area.stiffness + area.scale * (sunk @ sunk), found


def march_of(ring: Ring, area: StickArea, length: Array, ratio: Array, held: Held) -> Record:
    """The march, step by step.

    Args:
        ring: The ring in cells, which begins at the smallest stick radius, in its unit of time.
        area: The smallest stick area.
        length: Of the steps, (steps,).
        ratio: Of each step to the one before; 0 in a first step.
        held: What is held, each (steps,).
    """
    contact = _contact_of(ring, area)
    number = np.arange(ring.gap.size)
    alive = ring.gap > 0.0
    unworn = ring.edges[1:] < area.unworn * (1.0 + 1e-6)  # cells that touch at all times
    deepest, turning = area.amplitude / area.stiffness, area.scale / area.stiffness

    def advance(state: tuple[Array, ...], step: tuple[Array, ...]) -> tuple[tuple[Array, ...], Record]:
        worn, before, slip, slip_before, moved = state
        length, ratio, *kept = step
        kept = Held(*kept)
        # The formula of second order with changing steps, BDF2; Euler's in a first one.
        known = worn + (ratio * ratio / (1.0 + 2.0 * ratio)) * (worn - before)
        ahead = ((1.0 + ratio) / (1.0 + 2.0 * ratio)) * length * jnp.maximum(slip + ratio * (slip - slip_before), 0.0)
        matrix = jnp.where(number[:, None] == number, ring.compliance + jnp.where(alive, ahead, 1.0), ring.compliance)
        factor = cholesky(matrix)
        lack = jnp.where(alive, ring.steady - known, -1.0)
        found = forward(factor, lack)
        touches = _leading((found > 0.0) | unworn)
        pressure = backward(factor, jnp.where(touches, found, 0.0))
        now = jnp.where(alive, known + ahead * pressure, 0.0)

        # The same shape where it sticks: of the depths only the displacement is sought, by Newton's method.
        depth = deepest - turning * (area.flat @ pressure)
        free = -forward(contact.factor, ring.gap + now)

        def nearer(_: Any, moved: Array) -> Array:
            load, slope, _ = _at_depth(contact, free, depth - moved)
            lack = kept.of_displacement * moved + kept.of_force * (1.0 - load) - kept.value
            return moved - lack / (kept.of_displacement + kept.of_force * slope)

        moved = jax.lax.fori_loop(0, 8, nearer, moved)
        load, _, sticks = _at_depth(contact, free, depth - moved)
        gap = contact.factor @ sticks + ring.gap + now - (depth - moved) * area.flat
        new = jnp.where((sticks > 0.0) | ~alive, 0.0, jnp.maximum(gap, 0.0))
        record = Record(
            now,
            pressure,
            new,
            _end_of(ring.edges, found, touches),
            ring.edges[jnp.sum(sticks > 0.0)],
            1.0 - load,
        )
        return (now, worn, new, slip, moved), record

    zero = jnp.zeros_like(ring.gap)
    start = zero, zero, ring.gap, ring.gap, area.displacement
    return jax.lax.scan(advance, start, (length, ratio, *held))[1]


def _end_of(edges: Array, found: Array, touches: Array) -> Array:
    """Where the forward substitution vanishes, between the middles of the last cell that touches and the next."""
    middle = 0.5 * (edges[1:] + edges[:-1])
    last = jnp.sum(touches) - 1
    following = jnp.minimum(last + 1, found.size - 1)
    one, other = jnp.maximum(found[last], 0.0), jnp.maximum(-found[following], 0.0)
    part = one / jnp.maximum(one + other, jnp.finfo(found.dtype).tiny)
    place = middle[last] + part * (middle[following] - middle[last])
    return jnp.where(last + 1 < found.size, place, edges[-1])
