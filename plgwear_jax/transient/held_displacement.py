"""A run under displacement control: a constant displacement amplitude, of the contact or of a rig in series with it.

As wear takes load from the ring, the indenter sinks in and more of the contact sticks: the stick radius c grows. It
never decreases, because the contact does not wear where it sticks. So the ring that slips becomes narrower, and in the
end less is worn than under force control.
"""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._startup.programs import program, with_slopes
from plgwear_jax.transient.batch import runs
from plgwear_jax.transient.curves import Curve, RunCurves, curves_of, limited
from plgwear_jax.transient.grid import RingCells, Scales, one_in_units, ring_parameters
from plgwear_jax.transient.shapes import ControlEquation, StepStates, StickArea, march_of, stick_area_of

CONTROLS = ("force", "displacement")
DIGITS = 2  # correct digits of a march with fixed cells: docs/explanation/theory.md

# Numbers of cells: inside a window of fine cells around the final c, in this window, from there to a_0, beyond a_0.
_INSIDE, _WINDOW, _UNWORN, _OUTER = 8, 24, 24, 24
# The window reaches from its middle divided by this factor to its middle times the factor. The first march finds the
# final c in a wide window, the second one has a narrow window around it.
_WINDOWS = 8.0, 1.15
_GUESS = 0.05  # middle of the first window over phi: the growth of c^2 over the width of the unworn ring
_STEPS, _END, _BEND = 128, 8.0, 5.0  # number of steps, the last time in its unit, log of the last step over the first


Edges = tuple[Array, Array]  # T/C - 1 and (T - 1)/C at the edges of the cells


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
    """The edges of the cells, T/C - 1 and (T - 1)/C; `middle` is that of the window, as a share of the unworn ring."""
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
    """(Times in `Scales.unit`, from 0 on; ratio of each step to the step before)."""
    times = _END * np.expm1(_BEND * np.linspace(0.0, 1.0, _STEPS + 1)) / np.expm1(_BEND)
    length = np.diff(times)
    return times, np.append(0.0, length[1:] / length[:-1])


def run(k: Array, phi: Array, compliance: Array) -> RunCurves:
    """One run, for single numbers: k, the amplitude phi of the unworn contact, and the rig compliance X."""
    amplitude = jnp.where(phi > 0.0, phi, 0.5)
    at = ring_parameters(k, amplitude)

    def ring_at(edges: Edges) -> tuple[RingCells, Scales, StickArea]:
        ring, scales = one_in_units(edges, at)
        return ring, scales, stick_area_of(ring, at, amplitude, scales.unit)

    return run_of(ring_at, at.unworn, at.grown, amplitude, compliance / (at.s * at.inner))[0]


def run_of(
    ring_at: Callable[[Edges], tuple[RingCells, Scales, StickArea]],
    unworn: Array,
    grown: Array,
    phi: Array,
    rig: Array,
) -> tuple[RunCurves, Edges]:
    """(One run, the edges of its cells).

    Args:
        ring_at: Returns the ring in cells with given edges.
        unworn: Width of the unworn ring, in C.
        grown: Width of the final ring under force control less that of the unworn ring, in C.
        phi: The amplitude of the unworn contact, positive.
        rig: Displacement of the rig per amplitude of 1, in the unit of `StickArea.displacement`.
    """
    times, ratio = (jnp.asarray(x, phi.dtype) for x in _times())

    def march(middle: Array, width: Array) -> tuple[Array, tuple]:
        edges = _edges(unworn, grown, middle, width)
        ring, scales, area = ring_at(edges)
        equation = ControlEquation(*(jnp.full_like(times[1:], x) for x in (1.0, rig, area.displacement + rig * phi)))
        record = march_of(ring, area, jnp.diff(times), ratio, equation)
        stick = jax.lax.stop_gradient(record.stick[-1] / unworn)
        return jnp.maximum(stick, 1e-6 * middle), (ring, scales, record, edges)

    guess = jax.lax.stop_gradient(_GUESS * phi)
    marches = jax.lax.scan(march, guess, jnp.asarray(_WINDOWS, phi.dtype))[1]
    ring, scales, record, edges = jax.tree.map(lambda x: x[-1], marches)
    return curves_from(ring, scales, record, times), edges


def curves_from(ring: RingCells, scales: Scales, record: StepStates, times: Array) -> RunCurves:
    """The curves of a run, from the states at the end of its steps."""
    # Late in a run a step wears less than its own error, which has either sign: hence `cummax`.
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
    return RunCurves(
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
def _compiled(k: Array, phi: Array, compliance: Array) -> RunCurves:
    return runs(run, k, phi, compliance)


def check_control(control: str) -> None:
    """Raise ValueError unless the control is one of `CONTROLS`."""
    if control not in CONTROLS:
        raise ValueError(f"control = {control!r} is neither 'force' nor 'displacement'")


def check_digits(digits: int | None) -> None:
    """Raise ValueError for more digits than a run under displacement control has."""
    if digits is not None and digits > DIGITS:
        text = f"is outside the allowed range 1 <= digits <= {DIGITS} of wear under displacement control"
        raise ValueError(f"digits = {digits} {text}")


def curves_under(control: str, k: Array, phi: Array, compliance: Array, digits: int | None) -> tuple[RunCurves, Array]:
    """(The curves of the runs under this control; phi, broadcast against the compliance under displacement control)."""
    check_control(control)
    if control == "force":
        return curves_of(k, phi, digits), phi
    check_digits(digits)
    shape = jnp.broadcast_shapes(phi.shape, compliance.shape)
    phi = phi if phi.shape == shape else jnp.broadcast_to(phi, shape)
    return with_slopes(_compiled)(k, phi, compliance), phi
