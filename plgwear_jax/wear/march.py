"""Any test: a march of two contacts of one worn shape, each in cells over the whole contact.

The first contact is pressed by F_N and has the pressure p. The second one has the same shape and touches only where the
contact sticks: it is pressed by F_N - F_x/mu, or less deep than the first by the displacement over mu theta. In gross
slip it does not touch at all. Its gap times mu theta is the slip amplitude. So a cycle wears

    rate(p, 4 mu theta gap).

Forces, friction and loads may differ from step to step.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax.special.cholesky import backward, cholesky, forward


class Disc(NamedTuple):
    """The bodies and the unworn indenter in cells, whose edges are in T = (r/b)^2."""

    edges: Array  # from 0 to 1, (cells + 1,)
    compliance: Array  # A in m/Pa, integrated over both cells
    unworn: Array  # f in m, integrated over each cell
    area: Array  # pi b^2 in m^2


class Steps(NamedTuple):
    """What is given in each step, each field of shape (steps,).

    The control equation is: displacement displacement_factor + (F_N - load of the second contact) force_factor = value,
    with the displacement over mu theta.
    """

    length: Array  # in cycles
    ratio: Array  # of its length to that of the step before; 0 for a first step
    normal_force: Array  # F_N in N
    friction: Array  # mu
    tangential: Array  # mu theta
    displacement_factor: Array
    force_factor: Array
    value: Array


class Moments(NamedTuple):
    """The state at the end of each step; in cells shape (steps, cells)."""

    depth: Array  # worn depth in m, the mean over each cell
    pressure: Array  # in Pa
    slip: Array  # slip amplitude in m, the mean over each cell
    volume: Array  # worn since the beginning in m^3
    rate: Array  # volume in m^3 that the next cycle wears
    energy: Array  # energy in J that the next cycle dissipates
    contact_radius: Array  # in m
    stick_radius: Array
    tangential_force: Array  # its amplitude in N
    displacement: Array  # amplitude of the contact in m, without a rig


def _leading(positive: Array) -> Array:
    """Which entries come before the first one that is not positive."""
    return jnp.cumprod(positive.astype(jnp.int32)) == 1


class _Contact(NamedTuple):
    """A contact whose pressures follow from one factorisation.

    The Cholesky factor of a leading block is a block of the whole factor: one forward substitution serves every contact
    radius, and the contact ends where the forward substitution changes its sign.
    """

    one: Array  # forward substitution of a depth of 1
    shape: Array  # of the shape


class _Control(NamedTuple):
    """displacement_factor depth + force_factor load = value, with the load over `Disc.area`."""

    displacement_factor: Array
    force_factor: Array
    value: Array


def _depth(contact: _Contact, control: _Control, touches: Array) -> Array:
    """The depth at which the control equation holds if these cells touch."""
    one = jnp.where(touches, contact.one, 0.0)
    stiffness, held = control.force_factor * (one @ contact.one), control.force_factor * (one @ contact.shape)
    return (control.value + held) / (control.displacement_factor + stiffness)


_MOST = 64  # steps of Newton's method at most; some five are enough


def _pressed(contact: _Contact, control: _Control) -> tuple[Array, Array, Array]:
    """(Depth, forward substitution of the pressures, 0 where nothing touches, that in all cells)."""
    fixed = jax.lax.stop_gradient((contact, control))

    def body(state: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        touches, _, count = state
        now = _leading(_depth(*fixed, touches) * fixed[0].one > fixed[0].shape)
        return now, jnp.any(now != touches), count + 1

    # The load rises ever faster with the depth: from more cells than touch, Newton's method only drops cells.
    start = jnp.ones(contact.one.shape, bool), jnp.bool_(True), jnp.int32(0)
    touches, _, _ = jax.lax.while_loop(lambda state: state[1] & (state[2] < _MOST), body, start)
    depth = _depth(contact, control, touches)
    whole = depth * contact.one - contact.shape
    return depth, jnp.where(touches, whole, 0.0), whole


def _radius(disc: Disc, whole: Array, touching: Array) -> Array:
    """The zero of the forward substitution, between the middles of the last cell that touches and the next, in m."""
    r = jnp.sqrt(disc.area / jnp.pi * disc.edges)
    middle = jnp.append(0.5 * (r[1:] + r[:-1]), r[-1])
    count = jnp.sum(touching > 0.0)
    last = jnp.maximum(count - 1, 0)
    inner, outer = touching[last], jnp.maximum(-jnp.append(whole, 0.0)[count], 0.0)
    part = inner / jnp.maximum(inner + outer, jnp.finfo(r.dtype).tiny)
    place = middle[last] + part * (middle[count] - middle[last])
    return jnp.where(count == 0, 0.0, place)


def march(disc: Disc, rate: Callable[[Array, Array], Array], rounds: int, steps: Steps) -> Moments:
    """The march.

    Args:
        disc: The contact in cells. It has to be larger than the contact ever becomes: the results are NaN from then on.
        rate: Depth in m worn in a cycle, of a pressure in Pa and the path that slips in a cycle in m.
        rounds: How often the pressures of a step are computed, once for a depth that is proportional to the pressure.
        steps: What is given in each step.
    """
    size = jnp.diff(disc.edges)
    factor = cholesky(disc.compliance)
    first = forward(factor, size)

    def advance(state: tuple[Array, ...], step: Steps) -> tuple[tuple[Array, ...], Moments]:
        worn, before, slip, slip_before, pressure, pressure_before, sticks = state
        ratio = step.ratio
        # The formula of second order with changing steps, BDF2; Euler's in a first one, and where the pressure falls so
        # fast that BDF2 would go beyond the end: the cells outside would lose the contact with those that overshoot.
        second = jnp.clip(3.0 * pressure / jnp.where(pressure_before > 0.0, pressure_before, 1.0) - 1.0, 0.0, 1.0)
        known = worn + second * (ratio * ratio / (1.0 + 2.0 * ratio)) * (worn - before)
        length = (1.0 - second * ratio / (1.0 + 2.0 * ratio)) * step.length
        # In gross slip all that wears off a cell adds to the slip there, and to extrapolate that is unstable.
        ahead = jnp.where(sticks, ratio, 0.0)
        path = 4.0 * jnp.maximum(slip + ahead * (slip - slip_before), 0.0)
        force = _Control(0.0, 1.0, step.normal_force / disc.area)  # pyright: ignore[reportArgumentType]
        guess = jnp.maximum(pressure + ratio * (pressure - pressure_before), 0.5 * pressure)
        mean, depth, touching, whole = step.normal_force / disc.area, 0.0, known, known
        wear = known
        for _ in range(rounds):
            some = jnp.maximum(guess, 1e-3 * mean)
            wear = length * size * rate(some, path) / some
            lower = cholesky(disc.compliance + jnp.diag(wear))
            right = forward(lower, jnp.stack([size, disc.unworn + known], -1))
            depth, touching, whole = _pressed(_Contact(right[:, 0], right[:, 1]), force)
            guess = backward(lower, touching)
        now, found = known + wear * guess, guess

        free = forward(factor, disc.unworn + now)
        value = step.value - step.force_factor * step.normal_force - step.displacement_factor * depth
        control = _Control(step.displacement_factor, step.force_factor * disc.area, -value)
        shallow, sticking, all_cells = _pressed(_Contact(first, free), control)
        gap = factor @ sticking + disc.unworn + now - shallow * size
        slips = jnp.where(sticking > 0.0, 0.0, jnp.maximum(gap, 0.0)) / size
        sliding = step.tangential * slips
        load = disc.area * (first @ sticking)
        moments = Moments(
            depth=now / size,
            pressure=found,
            slip=sliding,
            volume=disc.area * jnp.sum(now),
            rate=disc.area * (size @ rate(jnp.maximum(found, 0.0), 4.0 * sliding)),
            energy=disc.area * step.friction * (size @ (found * 4.0 * sliding)),
            contact_radius=_radius(disc, whole, touching),
            stick_radius=_radius(disc, all_cells, sticking),
            tangential_force=step.friction * (step.normal_force - load),
            displacement=step.tangential * (depth - shallow),
        )
        return (now, worn, sliding, slip, found, pressure, sticking[0] > 0.0), moments

    zero = jnp.zeros_like(size)
    found = jax.lax.scan(advance, ((zero,) * 6) + (jnp.bool_(True),), steps)[1]
    # In the steady state the edge touches without pressure, and rounding decides which cells do.
    outside = found.pressure[:, -1] * disc.area > 1e-6 * steps.normal_force
    known = jnp.where(jax.lax.cummax(outside.astype(int)) > 0, jnp.nan, 1.0).astype(size.dtype)
    return jax.tree.map(lambda x: x * known.reshape(-1, *(1,) * (x.ndim - 1)), found)
