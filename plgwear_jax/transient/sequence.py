"""Wear by blocks of cycles of different amplitudes, one after the other."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax._core.domains import AMPLITUDE, CYCLES, EXPONENT, as_argument, check_all, one_or_nan, real_dtype
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import program
from plgwear_jax.partial_slip import SOFTNESS
from plgwear_jax.special.elementary import at_least, log_complement
from plgwear_jax.transient.grid import Ring, numbers_of, one_in_units
from plgwear_jax.transient.held_displacement import check_control
from plgwear_jax.transient.shapes import Held, StickArea, march_of, stick_area_of

__all__ = ["Blocks", "Ends", "blocks", "edges_between", "ends_of"]


@record
class Blocks:
    """The contact after each block, shape (blocks,).

    Attributes:
        n: Reduced cycles since the beginning.
        volume: Volume worn since then in units of a_0^4/R.
        wear_rate: What the last reduced cycle of the block wears, in the same unit.
        contact_radius: In units of a_0.
        stick_radius: The radius in which nothing slips at the amplitude of the block, in units of a_0.
        amplitude: F_x/(mu F_N) at the end of the block, other than at first where the displacement is held.
    """

    n: Array
    volume: Array
    wear_rate: Array
    contact_radius: Array
    stick_radius: Array
    amplitude: Array


_UNWORN, _OUTER = 96, 32  # cells inside and beyond a_0
_MOST, _FEWEST, _TOTAL = 48, 8, 512  # steps of a block, and of all as far as they do with the fewest
_OVER = 60.0  # units of time, by when every block is over


@functools.cache
def _grid() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    place = np.linspace(0.0, 1.0, _UNWORN + 1)
    begin, end = place**3, 0.4 * (1.0 - place) ** 2
    x = np.linspace(0.0, 1.0, _OUTER + 1)[1:]
    return begin / (begin + end), end / (begin + end), np.expm1(-4.5 * x * x) / np.expm1(-4.5)


def edges_between(unworn: Array, grown: Array, narrower: Array) -> tuple[Array, Array]:
    """The edges of the cells, T/C - 1 and (T - 1)/C, some of them where the blocks stick at first.

    Args:
        unworn: Width of the unworn ring of the largest amplitude, in C.
        grown: By how much the final one is wider.
        narrower: The width of the unworn ring of each block, (1 - T)/C.
    """
    begin, end, growth = (jnp.asarray(x, narrower.dtype) for x in _grid())
    beyond = grown * growth
    from_c = jnp.concatenate([unworn * begin, unworn + beyond])
    from_1 = jnp.concatenate([-unworn * end, beyond])

    def snap(i: Any, edges: Array) -> Array:
        stick = jnp.stack([unworn - narrower[i], -narrower[i]])
        # The edges at both ends of the unworn ring stay.
        nearest = 1 + jnp.argmin(jnp.abs(edges[0, 1:_UNWORN] - stick[0]))
        inside = (stick[0] > edges[0, nearest - 1]) & (stick[1] < edges[1, nearest + 1])
        return jnp.where(inside, edges.at[:, nearest].set(stick), edges)

    return tuple(jax.lax.fori_loop(0, narrower.size, snap, jnp.stack([from_c, from_1])))  # pyright: ignore[reportReturnType]


class Ends(NamedTuple):
    """The contact at the end of each block, shape (blocks,)."""

    share: Array  # of the final volume of the largest amplitude that is worn
    rate: Array  # of the share, by the unit of time
    edge: Array  # T/C - 1 of the contact
    stick: Array  # and of the area that sticks
    amplitude: Array  # of the force


def ends_of(control: str, ring: Ring, area: StickArea, phi: Array, displacement: Array, rig: Array, n: Array) -> Ends:
    """The march over all blocks.

    Args:
        control: What is held.
        ring: The ring in cells with the edges of `edges_between`, in its unit of time.
        area: The stick area of the largest amplitude.
        phi: The amplitude of each block.
        displacement: That of the unworn contact at this amplitude.
        rig: How the rig gives way, as of `held_displacement.run_of`.
        n: Length of each block in the unit of time.
    """
    # In each block first a step of no length, which finds its slip, and then steps that grow.
    steps = int(np.clip(_TOTAL // phi.size, _FEWEST, _MOST))
    length = jnp.minimum(n, _OVER)
    bend = jnp.log1p(20.0 * length)[:, None] + 0.1
    grid = length[:, None] * jnp.expm1(bend * jnp.linspace(0.0, 1.0, steps + 1, dtype=n.dtype)) / jnp.expm1(bend)
    zero = jnp.zeros_like(bend)
    lengths = jnp.concatenate([zero, jnp.diff(grid)], axis=1)
    ratios = jnp.broadcast_to(jnp.exp(bend / steps), lengths.shape)
    ratios = jnp.where(np.arange(steps + 1) < 2, 0.0, ratios)
    if control == "force":
        held = Held(jnp.zeros_like(phi), jnp.ones_like(phi), phi)
    else:
        held = Held(jnp.ones_like(phi), rig + zero[:, 0], displacement + rig * phi)
    held = Held(*(jnp.repeat(x, steps + 1) for x in held))
    found = march_of(ring, area, lengths.ravel(), ratios.ravel(), held)
    # In the end the edge touches without pressure.
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
    at = numbers_of(k, amplitude)
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
    """The wear of blocks of cycles of different amplitudes, in their order.

    Each block goes on from the shape that those before have left. A block of a larger amplitude sticks in a smaller
    radius. One of a smaller amplitude wears a narrower ring, if that still carries pressure.

    Args:
        k: Exponent of the modulus, a number, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude of each block, shape (blocks,), 0 <= phi < 1: F_x/(mu F_N), which at a held displacement is that
            of the unworn contact.
        n: Reduced cycles of each block, shape (blocks,), n >= 0 and finite.
        control: Whose amplitude is held in a block, that of the "force" or of the "displacement".
        compliance: X of `partial_slip.displacement_amplitude` if the displacement is that of a rig, a number, X >= 0.

    Returns:
        Volumes, rates and radii after each block. The error of the volume is below 1e-2 of the final one at the largest
        amplitude, at a held displacement below 2e-2.

    Raises:
        ValueError: A concrete argument is outside its range, or phi and n are not of one shape (blocks,). Under `jit`
            the result is NaN where a value is outside.

    Example:
        >>> from plgwear_jax import transient
        >>> worn = transient.blocks(0.0, [0.3, 0.6, 0.3], [5.0, 5.0, 5.0])
        >>> print(worn.volume.round(3))
        [0.02  0.228 0.254]
    """
    check_control(control)
    phi, n = (x if isinstance(x, Array) else np.asarray(x) for x in (phi, n))
    names = "k", "phi", "n", "compliance"
    values, domains = (k, phi, n, compliance), (EXPONENT, AMPLITUDE, CYCLES, SOFTNESS)
    check_all(names, values, domains)
    for name, value in (("k", k), ("compliance", compliance)):
        if np.ndim(value):
            raise ValueError(f"{name} takes one number for all blocks, not an array of shape {np.shape(value)}")
    if phi.ndim != 1 or phi.shape != n.shape or not phi.size:
        raise ValueError(f"phi and n take one number a block, not arrays of the shapes {phi.shape} and {n.shape}")
    dtype = jnp.promote_types(real_dtype("blocks", values), jnp.float32)
    given = [jnp.asarray(as_argument(value, dtype), dtype) for value in values]
    inside = jnp.stack([jnp.all(domain.contains(x)) for x, domain in zip(given, domains, strict=True)])
    return jax.tree.map(lambda x: x * one_or_nan(jnp.all(inside)).astype(dtype), _blocks(control, *given))
