"""Any test: a march of two contacts of one worn shape, each in cells over the whole contact.

The first contact is pressed by F_N and has the pressure p. The second one has the same shape and touches only where the
contact sticks: it is pressed by F_N - F_x/mu, or less deep than the first by the displacement over mu theta. In gross
slip it does not touch at all. Its gap times mu theta is the slip amplitude. So a cycle wears

    rate(p, 4 mu theta gap).

Forces, friction and loads may differ from step to step.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax.loads import Control
from plgwear_jax.special.cholesky import backward, cholesky, forward
from plgwear_jax.special.elementary import clamped, ratio_where, value_with_slope
from plgwear_jax.wear_laws import WearLaw


class Disc(NamedTuple):
    """The bodies and the unworn indenter in cells, whose edges are in T = (r/b)^2."""

    edges: Array  # from 0 to 1, (cells + 1,)
    compliance: Array  # A in m/Pa, integrated over both cells
    unworn: Array  # f in m, integrated over each cell
    area: Array  # pi b^2 in m^2
    radii: Array  # the edges of the cells in m


class StageNumbers(NamedTuple):
    """What is given in each block of cycles, or in each step, each field of shape (blocks,) or (steps,)."""

    cycles: Array  # of a block; NaN for a test without an end
    normal_force: Array  # F_N in N
    friction: Array  # mu
    displacement_factor: Array  # of `Control`
    force_factor: Array
    value: Array

    tables = "cycles", "normal_force", "friction", "displacement_factor", "force_factor", "value"


class Steps(NamedTuple):
    """The steps, each field of shape (steps,)."""

    length: Array  # in cycles
    ratio: Array  # of its length to that of the step before; 0 for a first step
    given: StageNumbers


class Moments(NamedTuple):
    """The state at the end of each step; in cells shape (steps, cells)."""

    depth: Array  # worn depth in m, the mean over each cell
    pressure: Array  # in Pa
    slip: Array  # slip amplitude in m, the mean over each cell
    volume: Array  # worn since the beginning in m^3
    rate: Array  # volume in m^3 that the next cycle wears
    energy_per_cycle: Array  # energy in J that the next cycle dissipates
    contact_radius: Array  # in m
    stick_radius: Array
    force_amplitude: Array  # of the tangential force in N
    displacement_amplitude: Array  # of the contact in m, without a rig
    least: Array  # pressure of either contact over the mean, well inside the stick-slip boundary, averaged over cells
    opens: Array  # where it is, in m


class _Pressed(NamedTuple):
    """A contact."""

    depth: Array  # in m
    pressure: Array  # in Pa, 0 where nothing touches
    gap: Array  # in m, integrated over each cell, 0 where it touches
    radius: Array  # in m


# Pressures of single cells swing where these are narrow, most for k < -0.5 and next to the stick-slip boundary, where
# they are singular in the end: means over so many cells, of the first ones, do not.
_BESIDE, _WITHIN = 8, 32
_ROUNDS, _FALL = 3, 1e-3  # of a step, and of the least pressure over the mean in each
_FAST = 10.0  # pressure over that of the step before, from which on Euler's formula is used
_MOST = 64  # steps of Newton's method at most; some five are enough


def _pressed(
    compliance: Array, slope: Array, lower: Array, shape: Array, size: Array, middle: Array, control: Control
) -> _Pressed:
    """The contact: compliance p + slope p = depth size - shape where p > 0, and the control equation.

        displacement_factor depth + force_factor load/`Disc.area` = value

    `lower` is the Cholesky factor of the compliance with the slopes on its diagonal. The factor of a leading block is a
    block of it: one forward substitution serves every contact radius. Derivatives are those of the linear equations of
    the cells that touch, without those of the whole factor.
    """
    right = jnp.stack([size, shape], -1)
    fixed = lax.stop_gradient(control)
    one, held = forward(lower, lax.stop_gradient(right)).T

    def body(state: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        touches, _, count = state
        some = jnp.where(touches, one, 0.0)
        depth = _depth(fixed, some @ one, some @ held)
        now = jnp.cumprod((depth * one > held).astype(jnp.int32)) == 1  # all before the first one that does not touch
        return now, jnp.any(now != touches), count + 1

    # The load rises ever faster with the depth: from more cells than touch, Newton's method only drops cells.
    start = jnp.ones(size.shape, bool), jnp.bool_(True), jnp.int32(0)
    touches, _, _ = lax.while_loop(lambda state: state[1] & (state[2] < _MOST), body, start)
    there = touches[:, None]

    def times(x: Array) -> Array:  # one matrix of both would be one for each derivative
        return compliance @ x + slope[:, None] * x

    def solve(_: Any, x: Array) -> Array:
        within = jnp.where(there, forward(lower, jnp.where(there, x, 0.0)), 0.0)
        return jnp.where(there, backward(lower, within), x)

    by = lax.custom_linear_solve(
        lambda x: jnp.where(there, times(jnp.where(there, x, 0.0)), x),
        jnp.where(there, right, 0.0),
        solve,
        symmetric=True,
    )
    depth = _depth(control, size @ by[:, 0], size @ by[:, 1])
    pressure = depth * by[:, 0] - by[:, 1]
    gap = jnp.where(touches, 0.0, shape + times(pressure[:, None])[:, 0] - depth * size)
    # It ends where the forward substitution changes its sign, between the middles of the last cell that touches and the
    # next. The substitution divides by the diagonal of the factor, of which dA changes y' dA y/2.
    count = jnp.sum(pressure > 0.0)
    ends = clamped(0, jnp.stack([count - 1, count]), size.size - 1)
    y = backward(lower, (np.arange(size.size)[:, None] == ends).astype(size.dtype))
    grown = jnp.sum(y * times(y), 0)
    diagonal = jnp.diagonal(lower)[ends] * (1.0 + 0.5 * (grown - lax.stop_gradient(grown)))
    # A worn ring ends as nothing but roundings of either sign.
    inner, outer = diagonal[0] * pressure[ends[0]], jnp.maximum(gap[ends[1]], 0.0) / diagonal[1]
    whole = inner + outer
    # Below that its derivatives overflow.
    known = whole > jnp.finfo(size.dtype).eps ** 2 * jnp.max(jnp.diagonal(lower) * pressure)
    part = ratio_where(known, inner, whole, 0.5)
    radius = middle[ends[0]] + part * (middle[count] - middle[ends[0]])
    return _Pressed(depth, pressure, gap, jnp.where(count == 0, 0.0, radius))


def _depth(control: Control, one: Array, held: Array) -> Array:
    """The depth at which the control equation holds, by the loads of a depth of 1 and of the shape."""
    return (control.value + control.force_factor * held) / (control.displacement_factor + control.force_factor * one)


def march(disc: Disc, theta: Array, law: WearLaw, steps: Steps) -> Moments:
    """The march.

    Args:
        disc: The contact in cells. It has to be larger than the contact ever becomes: the results are NaN from then on.
        theta: The tangential compliance over the normal one.
        law: The wear law. If it is linear the pressures of a step are computed once.
        steps: What is given in each step.
    """
    size = jnp.diff(disc.edges)
    factor = cholesky(lax.stop_gradient(disc.compliance))
    middle = jnp.append(0.5 * (disc.radii[1:] + disc.radii[:-1]), disc.radii[-1])
    zero = 0.0 * size  # with derivatives from the start, or JAX would trace the steps twice for these

    def advance(state: tuple[Array, ...], step: Steps) -> tuple[tuple[Array, ...], Moments]:
        worn, before, slip, slip_before, pressure, pressure_before, sticks = state
        ratio, given = step.ratio, step.given
        mean = given.normal_force / disc.area
        # The formula of second order with changing steps, BDF2, where the pressure changes slowly. Euler's in a first
        # step, in cells that have just begun to touch, and where the pressure falls so fast that BDF2 would go beyond
        # the end: the cells outside would lose the contact with those that overshoot.
        touched = pressure_before > 1e-6 * mean
        change = lax.stop_gradient(ratio_where(touched, pressure, pressure_before, _FAST))
        second = clamped(0.0, 3.0 * change - 1.0, 1.0) * clamped(0.0, _FAST - change, 1.0)
        known = worn + second * (ratio * ratio / (1.0 + 2.0 * ratio)) * (worn - before)
        length = (1.0 - second * ratio / (1.0 + 2.0 * ratio)) * step.length
        # In gross slip all that wears off a cell adds to the slip there, and to extrapolate that is unstable.
        ahead = jnp.where(sticks, ratio, 0.0)
        path = 4.0 * jnp.maximum(slip + ahead * (slip - slip_before), 0.0)
        force = Control(0.0, 1.0, mean)
        found = jnp.maximum(pressure + ratio * (pressure - pressure_before), 0.5 * pressure)  # a first guess
        now = depth = radius = known
        # Newton's method, for a depth that is proportional to the pressure at once. A tangent at a small pressure gives
        # a cell that begins to touch far too much pressure, by p^m with m > 1, or none, with m < 1: the least pressure
        # falls from round to round. A tangent holds to first order wherever it is taken.
        some = mean
        for _ in range(1 if law.linear else _ROUNDS):
            some = lax.stop_gradient(jnp.maximum(found, _FALL * some))
            worn_there, slope = value_with_slope(lambda p: length * size * law.rate(p, path), some)
            bare = known + worn_there - slope * some
            lower = cholesky(lax.stop_gradient(disc.compliance + jnp.diag(slope)))
            contact = _pressed(disc.compliance, slope, lower, disc.unworn + bare, size, middle, force)
            depth, found, radius = contact.depth, contact.pressure, contact.radius
            now = jnp.where(found > 0.0, jnp.maximum(bare + slope * found, known), known)

        # What is kept constant, in the depth and the load of the second contact.
        tangential = given.friction * theta
        moved, loaded = given.displacement_factor * tangential, given.force_factor * given.friction
        control = Control(moved, loaded * disc.area, moved * depth + loaded * given.normal_force - given.value)
        second = _pressed(disc.compliance, zero, factor, disc.unworn + now, size, middle, control)
        sliding = tangential * jnp.maximum(second.gap, 0.0) / size
        load = disc.area * (size @ second.pressure)
        area = size[:_WITHIN].reshape(-1, _BESIDE)
        loads = jnp.stack([found, second.pressure])[:, :_WITHIN].reshape(2, *area.shape) * area
        pressures = jnp.min(jnp.sum(loads, -1) / jnp.sum(area, -1), 0)
        lowest = jnp.argmin(pressures)
        moments = Moments(
            depth=now / size,
            pressure=found,
            slip=sliding,
            volume=disc.area * jnp.sum(now),
            rate=disc.area * (size @ law.rate(jnp.maximum(found, 0.0), 4.0 * sliding)),
            energy_per_cycle=disc.area * given.friction * (size @ (found * 4.0 * sliding)),
            contact_radius=radius,
            stick_radius=second.radius,
            force_amplitude=given.friction * (given.normal_force - load),
            displacement_amplitude=tangential * (depth - second.depth),
            least=pressures[lowest] * jnp.pi * radius**2 / given.normal_force,
            opens=disc.radii[_BESIDE * lowest + _BESIDE // 2],
        )
        return (now, worn, sliding, slip, found, pressure, second.pressure[0] > 0.0), moments

    found = lax.scan(advance, ((zero,) * 6) + (jnp.bool_(True),), steps)[1]
    # In the steady state the edge touches without pressure, and rounding decides which cells do.
    return until(found.pressure[:, -1] * disc.area > 1e-6 * steps.given.normal_force, found)


def until(ends: Array, moments: Moments) -> Moments:
    """The moments before the first one that ends the march, NaN from there on; the least pressures always."""
    known = lax.cummax(ends.astype(int)) == 0
    found = jax.tree.map(lambda x: jnp.where(known.reshape(-1, *(1,) * (x.ndim - 1)), x, jnp.nan), moments)
    return found._replace(least=moments.least, opens=moments.opens)
