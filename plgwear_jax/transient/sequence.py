"""Wear by blocks of cycles of different amplitudes, one after the other."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import (
    AMPLITUDE,
    CYCLES,
    EXPONENT,
    ArrayLike,
    as_argument,
    as_array,
    check_all,
    one_or_nan,
    real_dtype,
)
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import program
from plgwear_jax.partial_slip import SOFTNESS
from plgwear_jax.special.elementary import at_least, log_complement
from plgwear_jax.transient.grid import RingCells, one_in_units, ring_parameters
from plgwear_jax.transient.held_displacement import check_control
from plgwear_jax.transient.shapes import ControlEquation, StickArea, march_of, stick_area_of


@record
class Blocks:
    """The contact after each block; all attributes have the shape (blocks,).

    Attributes:
        n: Reduced cycles since the beginning.
        volume: Volume worn since the beginning, in units of a_0^4/R.
        wear_rate: Volume worn in the last reduced cycle of the block, in units of a_0^4/R.
        contact_radius: Contact radius in units of a_0.
        stick_radius: Radius inside which the contact sticks at the amplitude of the block, in units of a_0.
        amplitude: F_x/(mu F_N) at the end of the block; under displacement control it changes within the block.
    """

    n: Array
    volume: Array
    wear_rate: Array
    contact_radius: Array
    stick_radius: Array
    amplitude: Array


_UNWORN, _OUTER = 96, 32  # numbers of cells inside and beyond a_0
_MOST, _FEWEST, _TOTAL = 48, 8, 512  # steps: at most and at least in a block; in all blocks, unless each has the least
_OVER = 60.0  # units of time after which nothing wears any more in a block


@functools.cache
def _grid() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    place = np.linspace(0.0, 1.0, _UNWORN + 1)
    begin, end = place**3, 0.4 * (1.0 - place) ** 2
    x = np.linspace(0.0, 1.0, _OUTER + 1)[1:]
    return begin / (begin + end), end / (begin + end), np.expm1(-4.5 * x * x) / np.expm1(-4.5)


def edges_between(unworn: Array, grown: Array, narrower: Array) -> tuple[Array, Array]:
    """The edges of the cells, T/C - 1 and (T - 1)/C, one of them at the stick radius of each block before any wear.

    Args:
        unworn: Width of the unworn ring of the largest amplitude, in C.
        grown: Width of the final ring of this amplitude less that of the unworn ring, in C.
        narrower: The width of the unworn ring of each block, (1 - T)/C.
    """
    begin, end, growth = (jnp.asarray(x, narrower.dtype) for x in _grid())
    beyond = grown * growth
    from_c = jnp.concatenate([unworn * begin, unworn + beyond])
    from_1 = jnp.concatenate([-unworn * end, beyond])

    def snap(i: Any, edges: Array) -> Array:
        stick = jnp.stack([unworn - narrower[i], -narrower[i]])
        # The edges at both ends of the unworn ring are not moved.
        nearest = 1 + jnp.argmin(jnp.abs(edges[0, 1:_UNWORN] - stick[0]))
        inside = (stick[0] > edges[0, nearest - 1]) & (stick[1] < edges[1, nearest + 1])
        return jnp.where(inside, edges.at[:, nearest].set(stick), edges)

    return tuple(jax.lax.fori_loop(0, narrower.size, snap, jnp.stack([from_c, from_1])))  # pyright: ignore[reportReturnType]


class Ends(NamedTuple):
    """The contact at the end of each block, shape (blocks,)."""

    share: Array  # worn volume over the final volume at the largest amplitude
    rate: Array  # growth of this share per unit of time
    edge: Array  # T/C - 1 at the contact radius
    stick: Array  # T/C - 1 at the stick radius
    amplitude: Array  # force amplitude over mu F_N


def ends_of(
    control: str, ring: RingCells, area: StickArea, phi: Array, displacement: Array, rig: Array, n: Array
) -> Ends:
    """The march over all blocks.

    Args:
        control: One of `held_displacement.CONTROLS`.
        ring: The ring in cells with the edges of `edges_between`, in its unit of time.
        area: The stick area of the largest amplitude.
        phi: The force amplitude of each block.
        displacement: The displacement amplitude of the unworn contact at this force amplitude.
        rig: See `held_displacement.run_of`.
        n: Length of each block in the unit of time.
    """
    # Each block begins with a step of length zero, which finds the slip; the lengths of the others grow.
    steps = int(np.clip(_TOTAL // phi.size, _FEWEST, _MOST))
    length = jnp.minimum(n, _OVER)
    bend = jnp.log1p(20.0 * length)[:, None] + 0.1
    grid = length[:, None] * jnp.expm1(bend * jnp.linspace(0.0, 1.0, steps + 1, dtype=n.dtype)) / jnp.expm1(bend)
    zero = jnp.zeros_like(bend)
    lengths = jnp.concatenate([zero, jnp.diff(grid)], axis=1)
    ratios = jnp.broadcast_to(jnp.exp(bend / steps), lengths.shape)
    ratios = jnp.where(np.arange(steps + 1) < 2, 0.0, ratios)
    if control == "force":
        equation = ControlEquation(jnp.zeros_like(phi), jnp.ones_like(phi), phi)
    else:
        equation = ControlEquation(jnp.ones_like(phi), rig + zero[:, 0], displacement + rig * phi)
    equation = ControlEquation(*(jnp.repeat(x, steps + 1) for x in equation))
    found = march_of(ring, area, lengths.ravel(), ratios.ravel(), equation)
    # In the steady state the edge touches without pressure, so that the march may lose it; the edge never recedes.
    found = found._replace(edge=jax.lax.cummax(jnp.maximum(found.edge, area.unworn)))
    last = jax.tree.map(lambda x: x[steps :: steps + 1], found)
    total = jnp.sum(ring.steady)
    rate = jnp.maximum(jnp.sum(last.pressure * last.slip, -1) / total, 0.0)
    return Ends(jnp.sum(last.worn, -1) / total, rate, last.edge, last.stick, at_least(0.0, last.amplitude))


@program(static=1, level=1)
def _blocks(control: str, k: Array, phi: Array, n: Array, compliance: Array) -> Blocks:
    largest = jnp.max(phi)
    worn = largest > 0.0
    amplitude = jnp.where(worn, largest, 0.5)
    at = ring_parameters(k, amplitude)
    narrower = -jnp.expm1(log_complement(phi) / (1.0 + at.s)) / at.inner
    ring, scales = one_in_units(edges_between(at.unworn, at.grown, jax.lax.stop_gradient(narrower)), at)
    area = stick_area_of(ring, at, amplitude, scales.unit)
    last = ends_of(control, ring, area, phi, narrower / at.s, compliance / (at.s * at.inner), n / scales.unit)
    inner = jnp.where(worn, scales.inner, 1.0)
    nothing = jnp.where(worn, 1.0, 0.0)
    return Blocks(
        n=jnp.cumsum(n),
        volume=nothing * scales.volume * last.share,
        wear_rate=nothing * scales.volume * last.rate / scales.unit,
        contact_radius=at_least(1.0, jnp.where(worn, jnp.sqrt(inner * (1.0 + last.edge)), 1.0)),
        stick_radius=jnp.where(worn, jnp.sqrt(inner * (1.0 + last.stick)), 1.0),
        amplitude=nothing * last.amplitude,
    )


def blocks(
    k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, control: str = "force", compliance: ArrayLike = 0.0
) -> Blocks:
    """The wear over blocks of cycles of different amplitudes, in their order.

    Each block begins with the worn shape that the blocks before have left. At a larger amplitude the stick radius is
    smaller. At a smaller amplitude a narrower ring wears, as long as it still carries pressure.

    Args:
        k: Exponent of the modulus, a number, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N) of each block, shape (blocks,), 0 <= phi < 1; under displacement control that of
            the unworn contact.
        n: Reduced cycles of each block, shape (blocks,), n >= 0 and finite.
        control: Which amplitude is constant in a block, that of the "force" or of the "displacement".
        compliance: Rig compliance X of `partial_slip.displacement_amplitude`, a number, X >= 0.

    Returns:
        Volumes, rates and radii after each block. The error of the volume is below 1e-2 of the final volume at the
        largest amplitude, under displacement control below 2e-2.

    Raises:
        ValueError: A concrete argument is outside its range, or phi and n are not of one shape (blocks,). Under `jit`
            the result is NaN where a value is outside.

    Examples:
        >>> from plgwear_jax import transient
        >>> worn = transient.blocks(0.0, [0.3, 0.6, 0.3], [5.0, 5.0, 5.0])
        >>> print(worn.volume.round(3))
        [0.02  0.228 0.254]

    References:
        `docs/explanation/theory.md`, "Wear over cycles".
    """
    check_control(control)
    given = {"k": k, "phi": phi, "n": n, "compliance": compliance}
    names, values = tuple(given), tuple(map(as_array, given.values()))
    domains = EXPONENT, AMPLITUDE, CYCLES, SOFTNESS
    check_all(names, values, domains)
    for name, value in zip(names[::3], values[::3], strict=True):
        if np.ndim(value):
            raise ValueError(f"{name} takes one number for all blocks, not an array of shape {np.shape(value)}")
    phi, n = (x if isinstance(x, Array) else np.asarray(x) for x in values[1:3])
    if phi.ndim != 1 or phi.shape != n.shape or not phi.size:
        raise ValueError(f"phi and n take one number a block, not arrays of the shapes {phi.shape} and {n.shape}")
    dtype = jnp.promote_types(real_dtype("blocks", values), jnp.float32)
    numbers = [jnp.asarray(as_argument(value, dtype), dtype) for value in values]
    inside = jnp.stack([jnp.all(domain.contains(x)) for x, domain in zip(numbers, domains, strict=True)])
    return jax.tree.map(lambda x: x * one_or_nan(jnp.all(inside)).astype(dtype), _blocks(control, *numbers))
