"""A run of the transient: marches, extrapolated in the step and the cell, and what they say between the steps."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._punch import exponents
from plgwear_jax.transient.batch import runs
from plgwear_jax.transient.grid import (
    END,
    GROWTH,
    Effort,
    Ring,
    Scales,
    coarser,
    edges_of,
    effort_of,
    ring_of,
    times_of,
)
from plgwear_jax.transient.march import March, limit_of, marches_of

__all__ = [
    "DECAY",
    "Course",
    "Curve",
    "Moment",
    "compiled_course",
    "course_of",
    "interpolated",
    "limited",
    "moment_at",
    "share_at",
]


class Curve(NamedTuple):
    """A quantity that never falls and its rate, at the times of the coarsest march, in the unit of n."""

    value: Array
    rate: Array


class Course(NamedTuple):
    """What a run leaves behind."""

    volume: Curve  # as a share of the final one, (steps + 1,)
    worn: Curve  # P, and the pressure times the unit of n, (steps + 1, cells)
    edge: Array  # (T - C)/C at the edge of the contact, (steps + 1,)
    ratio: Array  # H/g of the cells
    swept: Array
    scales: Scales


def _shares(ring: Ring, march: March) -> Curve:
    total = jnp.sum(ring.steady)
    grown = ring.gap * jnp.exp(march.worn)
    worn = jnp.sum(ring.gap * jnp.expm1(march.worn), -1)
    return Curve(worn / total, jnp.sum(grown * march.pressure, -1) / total)


def _contact_edge(pressure: Array, s: Array) -> Array:
    """The edge of the contact as a share of the ring, from the loads of its last two cells.

    The pressure falls as the power s of the distance from the edge, so the loads tell where it is in the last cell.
    """
    edges = jnp.asarray(edges_of(pressure.shape[-1]), pressure.dtype)
    load = pressure * jnp.diff(edges)
    number = np.arange(load.shape[-1])
    last = jnp.maximum(jnp.max(jnp.where(pressure > 0.0, number, 1), -1), 1)

    def at(i: Array) -> Array:
        return jnp.take_along_axis(load, i[..., None], -1)[..., 0]

    ratio = at(last - 1) / jnp.maximum(at(last), jnp.finfo(load.dtype).tiny)
    before, begin, end = edges[last - 1], edges[last], edges[last + 1]
    within = (begin - before) / jnp.expm1(jnp.log1p(ratio) / (1.0 + s))
    return jnp.minimum(begin + within, end)


def run(k: Array, phi: Array, effort: Effort) -> Course:
    """One run for numbers k and phi."""
    phi = jnp.where(phi > 0.0, phi, 0.5)
    fine, scales = ring_of(k, phi, 2 * effort.cells)
    rough = coarser(fine)
    marches = marches_of(rough, effort.steps, effort.levels)
    finest = March(*(x[0] for x in marches_of(fine, effort.steps, 1)))

    coarse = _shares(rough, marches)
    # The error is as the square of the size of a cell, and hardly depends on the step.
    volume = jax.tree.map(lambda x, a, b: x + 4.0 / 3.0 * (b - a[0]), limit_of(coarse), coarse, _shares(fine, finest))
    # What halving the steps changes, from the rough cells: two fine ones each.
    better = jax.tree.map(
        lambda x, a, b: jnp.maximum(b + jnp.repeat(x - a[0], 2, -1), 0.0), limit_of(marches), marches, finest
    )
    s, _ = exponents(k)
    outer = _contact_edge(marches.pressure, s)
    edge = jnp.clip(_contact_edge(finest.pressure, s) + limit_of(outer) - outer[0], 0.0, 1.0) * scales.width

    def from_start(start: Any, x: Array) -> Array:
        return jnp.concatenate([jnp.broadcast_to(jnp.asarray(start, x.dtype), (1, *x.shape[1:])), x])

    return Course(
        Curve(from_start(0.0, volume.value), from_start(1.0, volume.rate)),
        Curve(from_start(0.0, better.worn), from_start(fine.first, better.pressure)),
        from_start(1.0 / scales.inner - 1.0, edge),
        fine.steady / fine.gap,
        fine.swept,
        scales,
    )


@functools.partial(jax.jit, static_argnums=2)
def compiled_course(k: Array, phi: Array, effort: Effort) -> Course:
    """Runs for all pairs of k and phi."""
    return runs(functools.partial(run, effort=effort), k, phi)


def course_of(k: Array, phi: Array, digits: int | None) -> Course:
    """The one program behind all functions here: what takes long to compile and to run."""
    return compiled_course(k, phi, effort_of(digits))


# --- between the steps ----------------------------------------------------------------------------------------------


class Moment(NamedTuple):
    """n as seen by the times of a march, whose last one it may be beyond."""

    first: Array  # number of the interval
    part: Array  # of it
    length: Array
    late: Array  # time since the last one, in the unit of n


DECAY = 1.5  # by which the rest decays beyond the last time


def moment_at(n: Array, unit: Array, steps: int) -> Moment:
    """Where n is between the times of a march of so many steps."""
    time = n / unit
    inside = jnp.minimum(time, END)
    place = steps * jnp.log1p(jax.lax.stop_gradient(inside) * (np.expm1(GROWTH) / END)) / GROWTH
    first = jnp.clip(place.astype(int), 0, steps - 1)
    nodes = jnp.asarray(times_of(steps), time.dtype)
    length = nodes[first + 1] - nodes[first]
    return Moment(first, (inside - nodes[first]) / length, length, jnp.maximum(time - END, 0.0))


def limited(curve: Curve) -> Curve:
    """The curve without what the extrapolation may have left: falls, and rates that would make a cubic fall."""
    value = jax.lax.cummax(curve.value, axis=1)
    times = np.diff(times_of(value.shape[1] - 1)).reshape(1, -1, *(1,) * (value.ndim - 2))
    chord = jnp.diff(value, axis=1) / jnp.asarray(times, value.dtype)
    before, after = jnp.concatenate([chord[:, :1], chord], 1), jnp.concatenate([chord, chord[:, -1:]], 1)
    return Curve(value, jnp.clip(curve.rate, 0.0, 3.0 * jnp.minimum(before, after)))


def interpolated(curve: Curve, moment: Moment, *at: Any) -> Array:
    """The cubic through two values and rates of a run, and of a cell of it."""
    run, *cell = at
    value, rate = curve
    i, j = (run, moment.first, *cell), (run, moment.first + 1, *cell)
    x, rise = moment.part, value[j] - value[i]
    u, v = moment.length * rate[i], moment.length * rate[j]
    return value[i] + x * (u + x * (3.0 * rise - 2.0 * u - v + x * (u + v - 2.0 * rise)))


def share_at(course: Course, run: np.ndarray, n: Array) -> Array:
    """The share of the final volume that is worn after n."""
    volume = course.volume
    curve = limited(volume._replace(value=jnp.minimum(volume.value, 1.0)))
    moment = moment_at(n, course.scales.unit[run], curve.value.shape[1] - 1)
    share = interpolated(curve, moment, run)
    # Beyond the end the rest dies out as exp(-t), with no jump in value and rate.
    rest = 1.0 - curve.value[run, -1]
    bend = jnp.maximum(DECAY * rest - curve.rate[run, -1], 0.0)
    after = 1.0 - (rest + bend * moment.late) * jnp.exp(-DECAY * moment.late)
    return jnp.where(moment.late > 0.0, after, share)
