"""Wear over cycles: how the fretting contact runs into its steady state, without units.

Archard's law with a wear coefficient K wears, in a cycle, K times the pressure times four slip amplitudes. At a held
normal force and a held amplitude of the tangential one the stick radius c stays, and besides k and phi one number
counts, the reduced cycles

    n = 4 K mu theta F_N N/(pi a_0^2)

for N cycles, with theta of `material.tangential_ratio`. Radii are in units of a_0, heights in a_0^2/R, volumes in
a_0^4/R and pressures in F_N/(pi a_0^2). `docs/theory.md` derives what is solved here: in T = r^2, with h the worn
depth, p the pressure, P its integral over n, g the gap beside the contact of radius c and H the steady depth,

    g (exp(P) - 1) + A p = H where p > 0,        g (exp(P) - 1) + A p >= H where p = 0,

A symmetric, positive, and p >= 0: the gradient flow of a convex function under a constraint.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike, DTypeLike

from plgwear_jax import fretting
from plgwear_jax._formula import AMPLITUDE, EXPONENT, Domain, ruled, stored
from plgwear_jax._punch import exponents
from plgwear_jax.partial_slip import ring_work
from plgwear_jax.special.arcsine import arc
from plgwear_jax.special.elementary import log_complement, sine_quotient

__all__ = ["cycles", "wear_rate", "wear_volume"]

CYCLES = Domain("n >= 0 and finite", lambda n: (n >= 0.0) & (n < float("inf")))
SHARE = Domain("0 <= share < 1", lambda share: (share >= 0.0) & (share < 1.0))


# --- the grid -------------------------------------------------------------------------------------------------------


class _Effort(NamedTuple):
    """The cells of the ring and the steps in n of the coarsest march; both are halved to extrapolate."""

    cells: int
    steps: int
    levels: int  # of halved steps


_EFFORTS = {2: _Effort(12, 12, 2), 3: _Effort(16, 12, 3), 4: _Effort(24, 20, 3), 5: _Effort(48, 40, 3)}


def _effort(digits: int | None) -> _Effort:
    return _EFFORTS[min(max(digits or 4, 2), 5)]


def _edges(cells: int) -> np.ndarray:
    """Edges of the cells as shares of the ring in T: quadratically finer towards both of its ends."""
    u = np.linspace(0.0, 1.0, cells + 1)
    return u * u * (3.0 - 2.0 * u)


# Nodes of a cell from its outer edge, where the pressure of the cell is no smooth function below: v = x^4.
_X, _W = (0.5 + 0.5 * np.polynomial.legendre.leggauss(6)[0], 0.5 * np.polynomial.legendre.leggauss(6)[1])
_NODE, _WEIGHT = _X**4, 4.0 * _X**3 * _W

# The reduced cycles of the marches, in units of the final volume over the first rate: finer at first.
_END, _GROWTH = 6.0, 3.0


def _times(steps: int) -> np.ndarray:
    return _END * np.expm1(_GROWTH * np.linspace(0.0, 1.0, steps + 1)) / np.expm1(_GROWTH)


class _Ring(NamedTuple):
    """The worn ring in cells: what the march needs of it, in units in which the rate and time are of order one."""

    compliance: Array  # A over the unit of time, integrated over both cells
    gap: Array  # g integrated over each cell
    steady: Array  # H integrated over each cell
    first: Array  # p_0 times the unit of time, the mean over each cell


class _Scales(NamedTuple):
    volume: Array  # the final one
    rate: Array  # the first one
    unit: Array  # of n: volume over rate


# Of the closed forms of a cell: differences of integrals over the ring.
_DIGITS = 12


def _ring(k: Array, phi: Array, cells: int) -> tuple[_Ring, _Scales]:
    digits = min(_DIGITS, int(jnp.finfo(k.dtype).precision))
    s, q = exponents(k)
    # Stored, or each of the many kernels that need them would compute them again.
    C = stored(jnp.exp(log_complement(phi) / (1.0 + s)), k)
    m = fretting._slip(s, phi)
    width = stored(fretting._ring(s, q, phi, digits), k)
    edges = _edges(cells)
    size = np.diff(edges)

    # What a cell's pressure adds to the one-dimensional picture at the nodes t of all cells, times q: (T-t)^q.
    distance = width * (edges[:, None, None] - edges[None, 1:, None] + size[None, :, None] * _NODE)
    beyond = distance > 0.0
    power = jnp.where(beyond, jnp.exp(q * jnp.log(jnp.where(beyond, distance, 1.0))), 0.0)
    share = jnp.diff(power, axis=0).reshape(cells, -1)
    t = (edges[1:, None] - size[:, None] * _NODE).ravel()
    weight = width * (size[:, None] * _WEIGHT).ravel() * jnp.exp((s - 1.0) * jnp.log1p(width * t))
    # sigma/q = s sine_quotient and sigma^2/(q^2 kappa) = sine_quotient^2/(2 (1+s)), regular at both ends.
    sine = sine_quotient(s, q)
    of_ring = (share * weight) @ share.T * (sine * sine / (2.0 * (1.0 + s)))
    swept = (share @ weight) * sine  # the integral of e(T), over s
    compliance = of_ring + (0.5 * s / (1.0 + s)) * swept[:, None] * swept[None, :]

    y = width * edges[1:]
    at = arc(y, jnp.full_like(y, s), jnp.full_like(y, q), digits)
    area, chord, low = stored(at.area, y), stored(at.chord, y), stored(at.below, y)
    height = y * chord
    below = low + (m - height) * area
    beside = height * area - low
    volume = stored(0.5 * jnp.pi * C * C * below[-1], k)
    rate = stored(0.5 * jnp.pi * (1.0 + s) * ring_work(s, phi, digits), k)
    unit = volume / rate
    T = jnp.clip(1.0 - C - C * width * edges, 0.0)
    load = jnp.where(T > 0.0, jnp.exp((1.0 + s) * jnp.log(jnp.where(T > 0.0, T, 1.0))), 0.0)
    # Depths over C/2, areas over C; A as a whole has C^(2-s).
    scale = 2.0 * jnp.exp(-(s + 1.0) * jnp.log(C)) * C / unit
    ring = _Ring(
        compliance * scale,
        jnp.diff(beside, prepend=0.0),
        jnp.diff(below, prepend=0.0),
        -jnp.diff(load) / (C * width * size) * unit,
    )
    return ring, _Scales(volume, rate, unit)


# --- a step ---------------------------------------------------------------------------------------------------------


class _Step(NamedTuple):
    """An implicit step of Euler's: g (exp(P + p) - 1) + A p = H for p >= 0, the integral of the pressure over it."""

    matrix: Array  # A over the step
    gap: Array
    steady: Array
    worn: Array  # P before the step


def _excess(step: _Step, p: Array) -> Array:
    return step.gap * (jnp.exp(step.worn + p) - 1.0) + step.matrix @ p - step.steady


def _newton(step: _Step, p: Array, touches: Array, lack: Array) -> Array:
    """-lack over the slope of the excess, in the cells that touch."""
    slope = jnp.where(touches, step.gap * jnp.exp(step.worn + p), 1.0)
    matrix = jnp.where(touches[:, None] & touches[None, :], step.matrix, 0.0) + jnp.diag(slope)
    factor = jax.lax.linalg.cholesky(matrix, symmetrize_input=False)
    return jax.scipy.linalg.cho_solve((factor, True), -jnp.where(touches, lack, 0.0))


_MOST = 60  # of Newton's steps; a step takes three or four


@jax.custom_jvp
def _solved(step: _Step, start: Array) -> Array:
    """p of the step from a start that is positive in the first cells. They touch up to a last one, which is found."""
    number = np.arange(start.size)
    enough = 1e-5 if start.dtype == jnp.float64 else 1e-3  # of a step that squares what it leaves

    def body(state: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
        p, touches, count, _ = state
        change = _newton(step, p, touches, _excess(step, p))
        # Upwards like a diode's, or an exponential would overflow; and no pressure is negative.
        moved = p + jnp.where(change > 0.5, jnp.log1p(jnp.maximum(change, 0.0)), change)
        wanted = jnp.where(touches, moved > 0.0, _excess(step, moved) < 0.0)
        last = jnp.max(jnp.where(wanted, number, 0))
        now = (number <= last) & (touches | (count < 12))
        largest = jnp.max(jnp.abs(change))
        done = jnp.all(now == touches) & (largest < enough * (1.0 + jnp.max(moved)))
        return jnp.where(now, jnp.maximum(moved, 0.0), 0.0), now, count + 1, done

    begin = (start, (start > 0.0) | (number == 0), jnp.int32(0), jnp.bool_(False))
    p, _, _, done = jax.lax.while_loop(lambda state: ~state[3] & (state[2] < _MOST), body, begin)
    return jnp.where(done, p, jnp.nan)


@_solved.defjvp
def _solved_jvp(primals, tangents):
    (step, start), (dstep, _) = primals, tangents
    p = _solved(step, start)
    _, lack = jax.jvp(lambda step: _excess(step, p), (step,), (dstep,))
    return p, _newton(step, p, p > 0.0, lack)


class _March(NamedTuple):
    """P, its steps over time and whatever they give, at each end of a step."""

    worn: Array  # (steps, cells)
    pressure: Array


def _march(ring: _Ring, steps: np.ndarray, fresh: np.ndarray) -> _March:
    """All steps one after the other, those that are `fresh` from the unworn contact."""

    def advance(state: tuple[Array, Array], at: tuple[Array, Array]) -> tuple[tuple[Array, Array], _March]:
        length, begins = at
        worn = jnp.where(begins, 0.0, state[0])
        pressure = jnp.where(begins, ring.first, state[1])
        step = _Step(ring.compliance / length, ring.gap, ring.steady, worn)
        p = _solved(step, pressure * length)
        state = worn + p, p / length
        return state, _March(*state)

    zero = jnp.zeros_like(ring.gap)
    dtype = zero.dtype
    return jax.lax.scan(advance, (zero, zero), (jnp.asarray(steps, dtype), jnp.asarray(fresh)))[1]


def _marches(ring: _Ring, steps: int, levels: int) -> list[_March]:
    """The marches with steps halved once more each, at the times of the first."""
    lengths = [np.diff(_times(steps << level)) for level in range(levels)]
    fresh = [np.arange(x.size) == 0 for x in lengths]
    march = _march(ring, np.concatenate(lengths), np.concatenate(fresh))
    found, begin = [], 0
    for level, x in enumerate(lengths):
        part = slice(begin + (1 << level) - 1, begin + x.size, 1 << level)
        found.append(_March(march.worn[part], march.pressure[part]))
        begin += x.size
    return found


def _romberg(values: list[Any]) -> Any:
    """The limit of values whose error is a series in the step, halved from each to the next."""
    for order in range(1, len(values)):
        factor = 1.0 / (2.0**order - 1.0)
        values = [jax.tree.map(lambda a, b, f=factor: b + f * (b - a), *pair) for pair in zip(values, values[1:])]
    return values[0]


# --- the volume -----------------------------------------------------------------------------------------------------


class _Course(NamedTuple):
    """The volume over the cycles, at the times of the coarsest march; shares of the final one, in the unit of n."""

    worn: Array
    rate: Array


def _coarser(ring: _Ring) -> _Ring:
    """The ring with every two cells made one, which is exact for integrals over them."""
    gap, steady = (x.reshape(-1, 2).sum(-1) for x in (ring.gap, ring.steady))
    compliance = ring.compliance.reshape(gap.size, 2, gap.size, 2).sum((1, 3))
    return _Ring(compliance, gap, steady, ring.first.reshape(-1, 2).mean(-1))


def _courses(ring: _Ring, steps: int, levels: int) -> list[_Course]:
    total = jnp.sum(ring.steady)
    found = []
    for march in _marches(ring, steps, levels):
        grown = ring.gap * jnp.exp(march.worn)
        found.append(
            _Course(
                jnp.sum(ring.gap * jnp.expm1(march.worn), -1) / total, jnp.sum(grown * march.pressure, -1) / total
            )
        )
    return found


def _course_at(k: Array, phi: Array, digits: int | None) -> tuple[_Course, _Scales]:
    worn = phi > 0.0
    phi = jnp.where(worn, phi, 0.5)
    effort = _effort(digits)
    fine, scales = _ring(k, phi, 2 * effort.cells)
    coarse = _courses(_coarser(fine), effort.steps, effort.levels)
    (finer,) = _courses(fine, effort.steps, 1)
    # The error is as the square of the size of a cell, and hardly depends on the step.
    course = jax.tree.map(lambda x, a, b: x + 4.0 / 3.0 * (b - a), _romberg(coarse), coarse[0], finer)
    whole = _Course(
        jnp.concatenate([jnp.zeros((1,), k.dtype), course.worn]), jnp.concatenate([jnp.ones((1,), k.dtype), course.rate])
    )
    scales = _Scales(
        jnp.where(worn, scales.volume, 0.0), jnp.where(worn, scales.rate, 0.0), scales.unit
    )
    return whole, scales


# --- many at once, and their derivatives ----------------------------------------------------------------------------


def _with_slopes(function: Callable[..., Any]) -> Callable[..., Any]:
    """(function, its derivatives by all arguments) from one evaluation, the arguments being vectors of runs."""

    def both(*x: Array) -> Any:
        basis = [tuple(jnp.ones_like(a) if i == j else jnp.zeros_like(a) for j, a in enumerate(x)) for i in range(len(x))]
        directions = tuple(jnp.stack(column) for column in zip(*basis))
        return jax.vmap(lambda along: jax.jvp(function, x, along), out_axes=(None, 0))(directions)

    return both


def _by_one_pass(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function of vectors of runs, whose derivatives are taken forwards and together with the value."""

    @jax.custom_jvp
    def along(*x: Array) -> Any:
        return function(*x)

    @along.defjvp
    def _rule(primals, tangents):
        value, slopes = _by_one_pass(_with_slopes(function))(*primals)

        def total(slope: Array) -> Array:
            tail = (1,) * (slope.ndim - 2)
            return sum(slope[i] * t.reshape(t.shape + tail) for i, t in enumerate(tangents))

        return value, jax.tree.map(total, slopes)

    return along


_TOGETHER = 16  # runs in one program step; the slowest of them sets the pace


def _runs(one: Callable[[Array, Array], Any], k: Array, phi: Array) -> tuple[Any, Array]:
    """`one` for each pair of k and phi, along a first axis, and the number of the pair in the shape of both."""
    shape = jnp.broadcast_shapes(k.shape, phi.shape)
    count = int(np.prod(shape))
    pairs = tuple(jnp.broadcast_to(x, shape).ravel() for x in (k, phi))

    def all_of(k: Array, phi: Array) -> Any:
        if k.size <= _TOGETHER:
            return jax.vmap(one)(k, phi)
        chunks = -(-k.size // _TOGETHER)
        padded = [jnp.pad(x, (0, chunks * _TOGETHER - x.size), "edge").reshape(chunks, _TOGETHER) for x in (k, phi)]
        made = jax.lax.map(lambda pair: jax.vmap(one)(*pair), tuple(padded))
        return jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:])[: k.size], made)

    if not count:
        pairs = tuple(jnp.zeros((1,), k.dtype) for _ in pairs)
    return _by_one_pass(all_of)(*pairs), np.arange(count).reshape(shape)


class _Place(NamedTuple):
    """The interval of the course in which n lies, and the course there."""

    part: Array  # of the interval, from 0 to 1
    length: Array  # of the interval
    worn: tuple[Array, Array]
    rate: tuple[Array, Array]


_TAIL = 1.5  # by which the rest decays beyond the last step


def _worn_share(course: _Course, run: np.ndarray, time: Array) -> Array:
    """The share of the final volume at times in the unit of n, by monotone cubics through volume and rate."""
    steps = course.worn.shape[1] - 1
    times = np.asarray(_times(steps))
    # Neither rounding nor the extrapolation may make the volume fall or exceed the final one.
    worn = jnp.minimum(jax.lax.cummax(course.worn, axis=1), 1.0)
    chord = jnp.diff(worn, axis=1) / jnp.asarray(np.diff(times), worn.dtype)
    least = jnp.minimum(
        jnp.pad(chord, ((0, 0), (1, 0)), mode="edge"), jnp.pad(chord, ((0, 0), (0, 1)), mode="edge")
    )
    rate = jnp.clip(course.rate, 0.0, 3.0 * least)
    inside = jnp.minimum(time, _END)
    place = steps * jnp.log1p(jax.lax.stop_gradient(inside) * (np.expm1(_GROWTH) / _END)) / _GROWTH
    first = jnp.clip(place.astype(int), 0, steps - 1)
    nodes = jnp.asarray(times, time.dtype)
    length = nodes[first + 1] - nodes[first]
    x = (inside - nodes[first]) / length
    a, b = worn[run, first], worn[run, first + 1]
    u, v = length * rate[run, first], length * rate[run, first + 1]
    value = a + x * (u + x * (3.0 * (b - a) - 2.0 * u - v + x * (u + v - 2.0 * (b - a))))
    # Beyond the end the rest dies out as exp(-t), in value and slope continuous.
    late = jnp.maximum(time - _END, 0.0)
    rest = 1.0 - worn[run, -1]
    bend = jnp.maximum(_TAIL * rest - rate[run, -1], 0.0)
    after = 1.0 - (rest + bend * late) * jnp.exp(-_TAIL * late)
    return jnp.where(time < _END, value, after)


def _arguments(k: ArrayLike, phi: ArrayLike, n: ArrayLike) -> tuple[Array, Array, Array]:
    return jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)


def _volume(k: Array, phi: Array, n: Array, digits: int | None) -> Array:
    (course, scales), run = _runs(functools.partial(_course_at, digits=digits), k, phi)
    time = n / scales.unit[run]
    return scales.volume[run] * _worn_share(course, run, time)


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def wear_volume(k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Volume worn off the indenter in n reduced cycles."""
    return _volume(*_arguments(k, phi, n), digits)


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def wear_rate(k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Volume worn off in a reduced cycle after n of them, dV/dn."""
    k, phi, n = _arguments(k, phi, n)
    return jax.jvp(lambda n: _volume(k, phi, n, digits), (n,), (jnp.ones_like(n),))[1]


@ruled(k=EXPONENT, phi=AMPLITUDE, share=SHARE)
def cycles(k: ArrayLike, phi: ArrayLike, share: ArrayLike, *, digits: int | None = None) -> Array:
    """Reduced cycles after which a share of the final volume is worn."""
    k, phi, share = _arguments(k, phi, share)
    (course, scales), run = _runs(functools.partial(_course_at, digits=digits), k, phi)
    raise NotImplementedError
