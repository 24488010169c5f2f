"""A run under a held displacement amplitude, of the contact or of a rig in series with it.

As wear takes load from the ring, the indenter sinks in and more of the contact sticks: the stick radius c grows. It
never falls back, because nothing wears where it sticks. So the ring that slips becomes narrower, and in the end less is
worn than under a held force.
"""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._startup.programs import program
from plgwear_jax.transient.batch import runs
from plgwear_jax.transient.course import Course, Curve, course_of, limited
from plgwear_jax.transient.grid import Ring, Scales, numbers_of, one_in_units
from plgwear_jax.transient.shapes import Held, Record, StickArea, march_of, stick_area_of

__all__ = ["CONTROLS", "DIGITS", "check_control", "check_digits", "course_under", "run_of"]

CONTROLS = ("force", "displacement")
DIGITS = 2  # that a march with fixed cells keeps; docs/theory.md

_INSIDE, _WINDOW, _UNWORN, _OUTER = 8, 24, 24, 24  # cells: up to a window around the last c, in it, to a_0, beyond it
_WINDOWS = 8.0, 1.15  # half the width of the window, as a factor: the first march looks for the last c
_GUESS = 0.05  # of that first march: the growth of c^2 over the unworn ring, per phi
_STEPS, _END, _BEND = 128, 8.0, 5.0  # steps, the last time in its unit, logarithm of the last step over the first


Edges = tuple[Array, Array]  # of the cells, T/C - 1 and (T - 1)/C


@functools.cache
def _grids() -> tuple[np.ndarray, ...]:
    inside = np.linspace(0.0, 1.0, _INSIDE + 1) ** 1.5
    window = np.linspace(0.0, 1.0, _WINDOW + 1)[1:]
    place = np.linspace(0.0, 1.0, _UNWORN + 1)[1:]
    begin, end = place**3, 0.4 * (1.0 - place) ** 2
    x = np.linspace(0.0, 1.0, _OUTER + 1)[1:]
    growth = np.expm1(-4.5 * x * x) / np.expm1(-4.5)
    return inside, window, begin / (begin + end), end / (begin + end), growth


def _edges(unworn: Array, grown: Array, middle: Array, width: Array) -> Edges:
    """The edges of the cells, T/C - 1 and (T - 1)/C, with a window of fine cells around a share of the unworn ring."""
    inside, window, place, left, growth = (jnp.asarray(x, middle.dtype) for x in _grids())
    last = jnp.minimum(middle * width, 0.9)
    first = jnp.minimum(middle / width, 0.8 * last)
    near = jnp.concatenate([first * inside, first * (last / first) ** window])
    from_c = jnp.concatenate([near, last + (1.0 - last) * place])
    from_1 = jnp.concatenate([near - 1.0, -(1.0 - last) * left])
    beyond = grown * growth
    return (
        jnp.concatenate([unworn * from_c, unworn + beyond]),
        jnp.concatenate([unworn * from_1, beyond]),
    )


@functools.cache
def _times() -> tuple[np.ndarray, np.ndarray]:
    """(Times in the unit, from 0 on; ratio of each step to the one before)."""
    times = _END * np.expm1(_BEND * np.linspace(0.0, 1.0, _STEPS + 1)) / np.expm1(_BEND)
    length = np.diff(times)
    return times, np.append(0.0, length[1:] / length[:-1])


def run(k: Array, phi: Array, compliance: Array) -> Course:
    """One run for numbers: the amplitude of the unworn contact, and how the rig gives way in its displacement."""
    amplitude = jnp.where(phi > 0.0, phi, 0.5)
    at = numbers_of(k, amplitude)

    def ring_at(edges: Edges) -> tuple[Ring, Scales, StickArea]:
        ring, scales = one_in_units(edges, at)
        return ring, scales, stick_area_of(ring, at, amplitude, scales.unit)

    return run_of(ring_at, at.unworn, at.grown, amplitude, compliance / (at.s * at.inner))[0]


def run_of(
    ring_at: Callable[[Edges], tuple[Ring, Scales, StickArea]],
    unworn: Array,
    grown: Array,
    phi: Array,
    rig: Array,
) -> tuple[Course, Edges]:
    """(One run, the edges of its cells).

    Args:
        ring_at: Gives the ring in cells with these edges.
        unworn: Width of the unworn ring, in C.
        grown: By how much the final one of a held force is wider.
        phi: The amplitude of the unworn contact, positive.
        rig: How the rig gives way: its displacement by an amplitude of 1, in that of `StickArea`.
    """
    times, ratio = (jnp.asarray(x, phi.dtype) for x in _times())

    def march(middle: Array, width: Array) -> tuple[Array, tuple]:
        edges = _edges(unworn, grown, middle, width)
        ring, scales, area = ring_at(edges)
        held = Held(*(jnp.full_like(times[1:], x) for x in (1.0, rig, area.displacement + rig * phi)))
        record = march_of(ring, area, jnp.diff(times), ratio, held)
        stick = jax.lax.stop_gradient(record.stick[-1] / unworn)
        return jnp.maximum(stick, 1e-6 * middle), (ring, scales, record, edges)

    guess = jax.lax.stop_gradient(_GUESS * phi)
    told = jax.lax.scan(march, guess, jnp.asarray(_WINDOWS, phi.dtype))[1]
    ring, scales, record, edges = jax.tree.map(lambda x: x[-1], told)
    return course_from(ring, scales, record, times), edges


def course_from(ring: Ring, scales: Scales, record: Record, times: Array) -> Course:
    """What is kept of the march."""
    # When hardly anything wears any more, the errors of the steps are larger than that, of either sign.
    total, worn = jnp.sum(ring.steady), jax.lax.cummax(jnp.sum(record.worn, -1))
    last = worn[-1]

    def since(begin: Array, x: Array) -> Array:
        return jnp.concatenate([jnp.broadcast_to(begin, (1, *x.shape[1:])), x])

    zero = jnp.zeros_like(last)
    rate = since(total, jnp.sum(record.pressure * record.slip, -1))
    pressure = since(ring.first, jnp.maximum(record.pressure, 0.0))
    depth = since(zero, jnp.maximum(record.worn, 0.0))
    opening = pressure * since(ring.gap, record.slip) / (ring.gap + depth)
    edge = jax.lax.cummax(since(ring.edges[_INSIDE + _WINDOW + _UNWORN], record.edge))
    growth = jnp.append(jnp.diff(edge) / jnp.diff(times), 0.0)
    return Course(
        limited(Curve(times, since(zero, worn / last), rate / last)),
        limited(Curve(times, edge, growth)),
        limited(Curve(times, jnp.log1p(depth / ring.gap), opening)),
        jnp.zeros(2, times.dtype),
        ring.steady / ring.gap,
        ring.swept,
        ring.edges,
        scales._replace(volume=scales.volume * last / total),
        pressure,
        jax.lax.cummax(since(zero, record.stick)),
    )


@program(level=1)
def _compiled(k: Array, phi: Array, compliance: Array) -> Course:
    return runs(run, k, phi, compliance)


def check_control(control: str) -> None:
    """Refuse anything else than what can be held."""
    if control not in CONTROLS:
        raise ValueError(f"control = {control!r} is neither 'force' nor 'displacement'")


def check_digits(digits: int | None) -> None:
    """Refuse more digits than there are at a held displacement."""
    if digits is not None and digits > DIGITS:
        text = f"is outside the allowed range 1 <= digits <= {DIGITS} of wear at a held displacement"
        raise ValueError(f"digits = {digits} {text}")


def course_under(control: str, k: Array, phi: Array, compliance: Array, digits: int | None) -> tuple[Course, Array]:
    """(The runs for what is held; phi in the shape of the runs without k)."""
    check_control(control)
    if control == "force":
        return course_of(k, phi, digits), phi
    check_digits(digits)
    phi = jnp.broadcast_to(phi, jnp.broadcast_shapes(phi.shape, compliance.shape))
    return _compiled(k, phi, compliance), phi
