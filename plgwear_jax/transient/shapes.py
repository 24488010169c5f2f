"""A march from worn shape to worn shape, under force or displacement control and with any sequence of amplitudes.

The slip is the gap of a second contact of the same worn shape, which touches in the stick area alone. It is pressed by
F_N - F_x/mu, or less deep than the first contact by the displacement over mu theta. So each step solves two contacts of
one shape: Archard's law takes the pressure of the first and the gap of the second;
`docs/explanation/theory.md` has the equations. Cells are fixed, so that both edges are known to within a cell.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax.special.cholesky import backward, cholesky, forward
from plgwear_jax.transient.grid import RingCells, RingParameters


class ControlEquation(NamedTuple):
    """Control equation of a step: displacement_factor displacement + force_factor amplitude = value.

    The displacement is in mu theta times the unit of depths; the amplitude is the force amplitude over mu F_N.
    """

    displacement_factor: Array
    force_factor: Array
    value: Array


class StepStates(NamedTuple):
    """The state at the end of each step."""

    worn: Array  # h integrated over each cell, (steps, cells)
    pressure: Array  # (steps, cells)
    slip: Array  # slip integrated over each cell, (steps, cells)
    edge: Array  # T/C - 1 at the contact radius, (steps,)
    stick: Array  # T/C - 1 at the stick radius, (steps,)
    amplitude: Array  # force amplitude over mu F_N, (steps,)


class StickArea(NamedTuple):
    """The smallest stick area, of radius c, and how pressures in the ring around it act on it; loads are over F_N."""

    unworn: Array  # width of the unworn ring, in C
    amplitude: Array  # phi at which c is the stick radius: an unworn contact of radius c carries the load 1 - phi
    stiffness: Array  # load of a flat punch of radius c per unit of depth
    flat: Array  # gap outside this punch, integrated over each cell
    scale: Array  # load of the ring at constant depth: scale times the sum of flat times pressure
    displacement: Array  # displacement amplitude of the unworn contact at this phi


def stick_area_of(ring: RingCells, at: RingParameters, phi: Array, unit: Array) -> StickArea:
    """The stick area on a power law, with depths over C/2 and the ring in its unit of time."""
    stiffness = at.s * (1.0 + at.s) * at.powered * at.inner
    return StickArea(at.unworn, phi, stiffness, at.s * ring.swept, at.inner / unit, at.unworn / at.s)


class _Contact(NamedTuple):
    """The second contact: its load at any depth and shape follows from one factorisation."""

    factor: Array  # Cholesky factor of the ring's compliance at constant depth
    sunk: Array  # forward substitution of `flat`, the change of gaps per unit of depth
    area: StickArea


def _contact_of(ring: RingCells, area: StickArea) -> _Contact:
    size = ring.gap.size
    compliance = ring.compliance - area.scale / area.stiffness * area.flat[:, None] * area.flat[None, :]
    factor = cholesky(jnp.where(jnp.eye(size, dtype=bool) & (ring.gap <= 0.0)[:, None], 1.0, compliance))
    return _Contact(factor, forward(factor, area.flat), area)


def _leading(positive: Array) -> Array:
    """Which entries come before the first one that is not positive."""
    return jnp.cumprod(positive.astype(jnp.int32)) == 1


def _at_depth(contact: _Contact, free: Array, depth: Array) -> tuple[Array, Array, Array]:
    """(Load, its slope by the depth, forward substitution in the cells that touch).

    The Cholesky factor of a leading block is a block of the whole factor: one forward substitution serves every contact
    radius, and the contact ends where the forward substitution changes its sign.
    """
    found = free + depth * contact.sunk
    found = jnp.where(_leading(found > 0.0), found, 0.0)
    sunk = jnp.where(found > 0.0, contact.sunk, 0.0)
    area = contact.area
    load = 1.0 - area.amplitude + area.stiffness * depth + area.scale * (found @ contact.sunk)
    return load, area.stiffness + area.scale * (sunk @ sunk), found


def march_of(ring: RingCells, area: StickArea, length: Array, ratio: Array, control: ControlEquation) -> StepStates:
    """The march, step by step.

    Args:
        ring: The ring in cells, which begins at the smallest stick radius, in its unit of time.
        area: The smallest stick area.
        length: Lengths of the steps, (steps,).
        ratio: Ratio of each step to the step before; 0 for a first step.
        control: The control equation of each step, fields of shape (steps,).
    """
    contact = _contact_of(ring, area)
    number = np.arange(ring.gap.size)
    alive = ring.gap > 0.0
    unworn = ring.edges[1:] < area.unworn * (1.0 + 1e-6)  # cells that touch at all times
    deepest, turning = area.amplitude / area.stiffness, area.scale / area.stiffness

    def advance(state: tuple[Array, ...], step: tuple[Array, ...]) -> tuple[tuple[Array, ...], StepStates]:
        worn, before, slip, slip_before, moved = state
        length, ratio, *kept = step
        kept = ControlEquation(*kept)
        # The formula of second order with changing steps, BDF2; Euler's in a first one.
        known = worn + (ratio * ratio / (1.0 + 2.0 * ratio)) * (worn - before)
        wear = ((1.0 + ratio) / (1.0 + 2.0 * ratio)) * length * jnp.maximum(slip + ratio * (slip - slip_before), 0.0)
        matrix = jnp.where(number[:, None] == number, ring.compliance + jnp.where(alive, wear, 1.0), ring.compliance)
        factor = cholesky(matrix)
        found = forward(factor, jnp.where(alive, ring.steady - known, -1.0))
        touches = _leading((found > 0.0) | unworn)
        pressure = backward(factor, jnp.where(touches, found, 0.0))
        now = jnp.where(alive, known + wear * pressure, 0.0)

        # The second contact, of the same shape: `moved`, the difference of both depths, by Newton's method.
        depth = deepest - turning * (area.flat @ pressure)
        free = -forward(contact.factor, ring.gap + now)

        def nearer(_: Any, moved: Array) -> Array:
            load, slope, _ = _at_depth(contact, free, depth - moved)
            residual = kept.displacement_factor * moved + kept.force_factor * (1.0 - load) - kept.value
            return moved - residual / (kept.displacement_factor + kept.force_factor * slope)

        moved = jax.lax.fori_loop(0, 8, nearer, moved)
        load, _, sticks = _at_depth(contact, free, depth - moved)
        gap = contact.factor @ sticks + ring.gap + now - (depth - moved) * area.flat
        new = jnp.where((sticks > 0.0) | ~alive, 0.0, jnp.maximum(gap, 0.0))
        record = StepStates(
            now,
            pressure,
            new,
            _end_of(ring.edges, found, touches),
            ring.edges[jnp.sum(sticks > 0.0)],
            1.0 - load,
        )
        return (now, worn, new, slip, moved), record

    zero = 0.0 * ring.gap  # with derivatives from the start, or JAX would trace the steps twice for these
    start = zero, zero, ring.gap, ring.gap, area.displacement
    return jax.lax.scan(advance, start, (length, ratio, *control))[1]


def _end_of(edges: Array, found: Array, touches: Array) -> Array:
    """The zero of the forward substitution, between the middles of the last cell that touches and the next cell."""
    middle = 0.5 * (edges[1:] + edges[:-1])
    last = jnp.sum(touches) - 1
    following = jnp.minimum(last + 1, found.size - 1)
    one, other = jnp.maximum(found[last], 0.0), jnp.maximum(-found[following], 0.0)
    part = one / jnp.maximum(one + other, jnp.finfo(found.dtype).tiny)
    place = middle[last] + part * (middle[following] - middle[last])
    return jnp.where(last + 1 < found.size, place, edges[-1])
