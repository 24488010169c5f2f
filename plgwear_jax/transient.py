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
import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting
from plgwear_jax._core.domains import AMPLITUDE, EXPONENT, RADIUS, Domain
from plgwear_jax._core.formula import ruled, stored
from plgwear_jax._punch import exponents
from plgwear_jax.fretting.ring import ring_edge
from plgwear_jax.fretting.stick import slip
from plgwear_jax.partial_slip import ring_work
from plgwear_jax.special.arcsine import arc, arcsine_tail, fold
from plgwear_jax.special.elementary import log_complement, sine_quotient

__all__ = ["contact_radius", "cycles", "pressure", "profile", "wear_depth", "wear_rate", "wear_volume"]

CYCLES = Domain("n >= 0 and finite", lambda n: (n >= 0.0) & (n < float("inf")))
SHARE = Domain("0 <= share < 1", lambda share: (share >= 0.0) & (share < 1.0))


# --- the grid -------------------------------------------------------------------------------------------------------


class _Effort(NamedTuple):
    """The cells of the ring and the steps in n of the coarsest march; both are halved to extrapolate."""

    cells: int
    steps: int
    levels: int  # of halved steps


_EFFORTS = {2: _Effort(16, 12, 3), 3: _Effort(24, 24, 3), 4: _Effort(64, 56, 3), 5: _Effort(96, 96, 3)}


def _effort(digits: int | None) -> _Effort:
    return _EFFORTS[min(max(digits or 3, 2), 5)]


def _edges(cells: int) -> np.ndarray:
    """Edges of the cells as shares of the ring in T: quadratically finer towards both of its ends."""
    u = np.linspace(0.0, 1.0, cells + 1)
    return u * u * (3.0 - 2.0 * u)


# Nodes of a cell from its outer edge, where the pressure of the cell is no smooth function below: v = x^4.
_X, _W = (0.5 + 0.5 * np.polynomial.legendre.leggauss(6)[0], 0.5 * np.polynomial.legendre.leggauss(6)[1])
_NODE, _WEIGHT = _X**4, 4.0 * _X**3 * _W

# The reduced cycles of the marches, in units of the final volume over the first rate: finer at first.
_END, _GROWTH = 6.0, 4.0


def _times(steps: int) -> np.ndarray:
    return _END * np.expm1(_GROWTH * np.linspace(0.0, 1.0, steps + 1)) / np.expm1(_GROWTH)


class _Ring(NamedTuple):
    """The worn ring in cells: what the march needs of it, in units in which the rate and time are of order one."""

    compliance: Array  # A over the unit of time, integrated over both cells
    gap: Array  # g integrated over each cell
    steady: Array  # H integrated over each cell
    first: Array  # p_0 times the unit of time, the mean over each cell
    swept: Array  # Q/s integrated over each cell


class _Scales(NamedTuple):
    volume: Array  # the final one
    rate: Array  # the first one
    unit: Array  # of n: volume over rate
    inner: Array  # C
    width: Array  # of the ring, in C


# Of the closed forms of a cell: differences of integrals over the ring.
_DIGITS = 12


def _closed_digits(x: Array) -> int:
    return min(_DIGITS, int(jnp.finfo(x.dtype).precision))


def _ring(k: Array, phi: Array, cells: int) -> tuple[_Ring, _Scales]:
    digits = _closed_digits(k)
    s, q = exponents(k)
    # Stored, or each of the many kernels that need them would compute them again.
    C = stored(jnp.exp(log_complement(phi) / (1.0 + s)), k)
    m = slip(s, phi)
    width = stored(ring_edge(s, q, phi, digits), k)
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
        jnp.diff(area, prepend=0.0),
    )
    return ring, _Scales(volume, rate, unit, C, width)


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
        values = [jax.tree.map(lambda a, b, f=factor: b + f * (b - a), *pair) for pair in itertools.pairwise(values)]
    return values[0]


# --- a run ----------------------------------------------------------------------------------------------------------


class _Curve(NamedTuple):
    """A quantity that never falls and its rate, at the times of the coarsest march, in the unit of n."""

    value: Array
    rate: Array


class _Course(NamedTuple):
    """What a run leaves behind."""

    volume: _Curve  # as a share of the final one, (steps + 1,)
    worn: _Curve  # P, and the pressure times the unit of n, (steps + 1, cells)
    edge: Array  # (T - C)/C at the edge of the contact, (steps + 1,)
    ratio: Array  # H/g of the cells
    swept: Array
    scales: _Scales


def _coarser(ring: _Ring) -> _Ring:
    """The ring with every two cells made one, which is exact for integrals over them."""
    gap, steady, swept = (x.reshape(-1, 2).sum(-1) for x in (ring.gap, ring.steady, ring.swept))
    compliance = ring.compliance.reshape(gap.size, 2, gap.size, 2).sum((1, 3))
    size = np.diff(_edges(2 * gap.size)).reshape(-1, 2)
    part = (size / size.sum(-1, keepdims=True)).ravel()
    first = (ring.first * jnp.asarray(part, gap.dtype)).reshape(-1, 2).sum(-1)
    return _Ring(compliance, gap, steady, first, swept)


def _shares(ring: _Ring, march: _March) -> _Curve:
    total = jnp.sum(ring.steady)
    grown = ring.gap * jnp.exp(march.worn)
    worn = jnp.sum(ring.gap * jnp.expm1(march.worn), -1)
    return _Curve(worn / total, jnp.sum(grown * march.pressure, -1) / total)


def _contact_edge(pressure: Array, s: Array) -> Array:
    """The edge of the contact as a share of the ring, from the loads of its last two cells.

    The pressure falls as the power s of the distance from the edge, so the loads tell where it is in the last cell.
    """
    edges = jnp.asarray(_edges(pressure.shape[-1]), pressure.dtype)
    load = pressure * jnp.diff(edges)
    number = np.arange(load.shape[-1])
    last = jnp.maximum(jnp.max(jnp.where(pressure > 0.0, number, 1), -1), 1)

    def at(i: Array) -> Array:
        return jnp.take_along_axis(load, i[..., None], -1)[..., 0]

    ratio = at(last - 1) / jnp.maximum(at(last), jnp.finfo(load.dtype).tiny)
    before, begin, end = edges[last - 1], edges[last], edges[last + 1]
    within = (begin - before) / jnp.expm1(jnp.log1p(ratio) / (1.0 + s))
    return jnp.minimum(begin + within, end)


def _run(k: Array, phi: Array, effort: _Effort) -> _Course:
    phi = jnp.where(phi > 0.0, phi, 0.5)
    fine, scales = _ring(k, phi, 2 * effort.cells)
    rough = _coarser(fine)
    marches = _marches(rough, effort.steps, effort.levels)
    (finest,) = _marches(fine, effort.steps, 1)

    coarse = [_shares(rough, march) for march in marches]
    # The error is as the square of the size of a cell, and hardly depends on the step.
    volume = jax.tree.map(lambda x, a, b: x + 4.0 / 3.0 * (b - a), _romberg(coarse), coarse[0], _shares(fine, finest))
    # What halving the steps changes, from the rough cells: two fine ones each.
    better = jax.tree.map(
        lambda x, a, b: jnp.maximum(b + jnp.repeat(x - a, 2, -1), 0.0), _romberg(marches), marches[0], finest
    )
    s, _ = exponents(k)
    outer = [_contact_edge(march.pressure, s) for march in marches]
    edge = jnp.clip(_contact_edge(finest.pressure, s) + _romberg(outer) - outer[0], 0.0, 1.0) * scales.width

    def from_start(start: Any, x: Array) -> Array:
        return jnp.concatenate([jnp.broadcast_to(jnp.asarray(start, x.dtype), (1, *x.shape[1:])), x])

    return _Course(
        _Curve(from_start(0.0, volume.value), from_start(1.0, volume.rate)),
        _Curve(from_start(0.0, better.worn), from_start(fine.first, better.pressure)),
        from_start(1.0 / scales.inner - 1.0, edge),
        fine.steady / fine.gap,
        fine.swept,
        scales,
    )


# --- many at once, and their derivatives ----------------------------------------------------------------------------


def _with_slopes(function: Callable[..., Any]) -> Callable[..., Any]:
    """(function, its derivatives by all arguments) from one evaluation, the arguments being vectors of runs."""

    def both(*x: Array) -> Any:
        basis = [
            tuple(jnp.ones_like(a) if i == j else jnp.zeros_like(a) for j, a in enumerate(x)) for i in range(len(x))
        ]
        directions = tuple(jnp.stack(column) for column in zip(*basis, strict=True))
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


def _numbers(k: Array, phi: Array) -> np.ndarray:
    """The number of the run of each pair of k and phi, in the shape of both."""
    shape = jnp.broadcast_shapes(k.shape, phi.shape)
    return np.arange(int(np.prod(shape))).reshape(shape)


def _runs(one: Callable[[Array, Array], Any], k: Array, phi: Array) -> Any:
    """`one` for each pair of k and phi, along a first axis."""
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
    return _by_one_pass(all_of)(*pairs)


class _Moment(NamedTuple):
    """n as seen by the times of a march, whose last one it may be beyond."""

    first: Array  # number of the interval
    part: Array  # of it
    length: Array
    late: Array  # time since the last one, in the unit of n


_DECAY = 1.5  # by which the rest decays beyond the last time


def _moment(n: Array, unit: Array, steps: int) -> _Moment:
    time = n / unit
    inside = jnp.minimum(time, _END)
    place = steps * jnp.log1p(jax.lax.stop_gradient(inside) * (np.expm1(_GROWTH) / _END)) / _GROWTH
    first = jnp.clip(place.astype(int), 0, steps - 1)
    nodes = jnp.asarray(_times(steps), time.dtype)
    length = nodes[first + 1] - nodes[first]
    return _Moment(first, (inside - nodes[first]) / length, length, jnp.maximum(time - _END, 0.0))


def _limited(curve: _Curve) -> _Curve:
    """The curve without what the extrapolation may have left: falls, and rates that would make a cubic fall."""
    value = jax.lax.cummax(curve.value, axis=1)
    times = np.diff(_times(value.shape[1] - 1)).reshape(1, -1, *(1,) * (value.ndim - 2))
    chord = jnp.diff(value, axis=1) / jnp.asarray(times, value.dtype)
    before, after = jnp.concatenate([chord[:, :1], chord], 1), jnp.concatenate([chord, chord[:, -1:]], 1)
    return _Curve(value, jnp.clip(curve.rate, 0.0, 3.0 * jnp.minimum(before, after)))


def _interpolated(curve: _Curve, moment: _Moment, *at: Any) -> Array:
    """The cubic through two values and rates of a run, and of a cell of it."""
    run, *cell = at
    value, rate = curve
    i, j = (run, moment.first, *cell), (run, moment.first + 1, *cell)
    x, rise = moment.part, value[j] - value[i]
    u, v = moment.length * rate[i], moment.length * rate[j]
    return value[i] + x * (u + x * (3.0 * rise - 2.0 * u - v + x * (u + v - 2.0 * rise)))


def _share_at(course: _Course, run: np.ndarray, n: Array) -> Array:
    """The share of the final volume that is worn after n."""
    volume = course.volume
    curve = _limited(volume._replace(value=jnp.minimum(volume.value, 1.0)))
    moment = _moment(n, course.scales.unit[run], curve.value.shape[1] - 1)
    share = _interpolated(curve, moment, run)
    # Beyond the end the rest dies out as exp(-t), with no jump in value and rate.
    rest = 1.0 - curve.value[run, -1]
    bend = jnp.maximum(_DECAY * rest - curve.rate[run, -1], 0.0)
    after = 1.0 - (rest + bend * moment.late) * jnp.exp(-_DECAY * moment.late)
    return jnp.where(moment.late > 0.0, after, share)


@functools.partial(jax.jit, static_argnums=2)
def _compiled_course(k: Array, phi: Array, effort: _Effort) -> _Course:
    return _runs(functools.partial(_run, effort=effort), k, phi)


def _course(k: Array, phi: Array, digits: int | None) -> _Course:
    """The one program behind all functions here: what takes long to compile and to run."""
    return _compiled_course(k, phi, _effort(digits))


@jax.jit
def _volume(course: _Course, k: Array, phi: Array, n: Array) -> Array:
    run = _numbers(k, phi)
    return jnp.where(phi > 0.0, course.scales.volume[run] * _share_at(course, run, n), 0.0)


@jax.jit
def _rate(course: _Course, k: Array, phi: Array, n: Array) -> Array:
    n = jnp.broadcast_to(n, jnp.broadcast_shapes(k.shape, phi.shape, n.shape))
    return jax.jvp(lambda n: _volume(course, k, phi, n), (n,), (jnp.ones_like(n),))[1]


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def wear_volume(k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Volume worn off the indenter in n reduced cycles.

    One run of the transient answers all n of a call for each pair of k and phi.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        digits: Digits wanted, relative to the final volume: 2 to 5, by default 3; fewer count as 2, more as 5.

    Returns:
        The volume in units of a_0^4/R, broadcast over all arguments: it grows from 0 to `fretting.wear_volume`.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.

    Example:
        >>> from plgwear_jax import fretting, transient
        >>> print(f"{transient.wear_volume(0.0, 0.5, 5.0) / fretting.wear_volume(0.0, 0.5):.3f}")
        0.862
    """
    k, phi, n = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    return _volume(_course(k, phi, digits), k, phi, n)


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def wear_rate(k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Volume worn off in a reduced cycle after n of them, dV/dn: the slope of `wear_volume`.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        digits: As of `wear_volume`; the slope has one less.

    Returns:
        The rate in units of a_0^4/R, broadcast over all arguments.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    k, phi, n = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    return _rate(_course(k, phi, digits), k, phi, n)


@jax.jit
def _cycles(course: _Course, k: Array, phi: Array, share: Array) -> Array:
    run = _numbers(k, phi)
    unit, limits = course.scales.unit[run], jnp.finfo(share.dtype)
    fixed = jax.lax.stop_gradient(course)
    # Long before the upper bound the rest is less than a rounding.
    bounds = jnp.zeros_like(unit * share), unit * (_END - 2.0 * np.log(limits.eps)) + jnp.zeros_like(unit * share)

    def halve(_: int, bounds: tuple[Array, Array]) -> tuple[Array, Array]:
        middle = 0.5 * (bounds[0] + bounds[1])
        below = _share_at(fixed, run, middle) < share
        return jnp.where(below, middle, bounds[0]), jnp.where(below, bounds[1], middle)

    bounds = jax.lax.fori_loop(0, limits.nmant + 8, halve, jax.lax.stop_gradient(bounds))
    n = 0.5 * (bounds[0] + bounds[1])
    # Newton's steps carry the derivatives, the second one those of second order.
    for _ in range(2):
        reached, slope = jax.jvp(lambda n: _share_at(course, run, n), (n,), (jnp.ones_like(n),))
        n = n + jnp.where(slope > 0.0, (share - reached) / jnp.where(slope > 0.0, slope, 1.0), 0.0)
    return jnp.where(phi > 0.0, n, jnp.nan)


@ruled(k=EXPONENT, phi=AMPLITUDE, share=SHARE)
def cycles(k: ArrayLike, phi: ArrayLike, share: ArrayLike, *, digits: int | None = None) -> Array:
    """Reduced cycles after which a share of the final volume is worn: `wear_volume` turned.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        share: Share of the final volume, 0 <= share < 1.
        digits: As of `wear_volume`. Of a share whose rest is below that accuracy only the order of n is told.

    Returns:
        n, broadcast over all arguments; NaN at phi = 0, where nothing wears.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    k, phi, share = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(share)
    return _cycles(_course(k, phi, digits), k, phi, share)


# --- fields ---------------------------------------------------------------------------------------------------------


def _between(course: _Course, run: np.ndarray, y: Array) -> tuple[Array, Array, Array]:
    """(Number of a cell, number of the next, part of the way from the middle of one to that of the other)."""
    cells = course.worn.value.shape[-1]
    # Where u^2 (3 - 2u) = x.
    x = jnp.clip(y / course.scales.width[run], 1e-9, 1.0 - 1e-7)
    u = 0.5 - jnp.sin(jnp.arcsin(1.0 - 2.0 * x) / 3.0)
    place = jnp.clip(cells * u - 0.5, 0.0, cells - 1.0)
    first = jnp.clip(jax.lax.stop_gradient(place).astype(int), 0, cells - 2)
    return first, first + 1, place - first


def _outside(r: Array, c: Array, edge: Array) -> tuple[Array, Array]:
    """(Whether r lies between c and an outer edge, y there and something harmless elsewhere)."""
    inside = (r >= c) & (r < edge)
    near = jnp.where(inside, r, 0.5 * (c + edge))
    return inside, ((near - c) / c) * ((near + c) / c)


@jax.jit
def _depth(course: _Course, r: Array, k: Array, phi: Array, n: Array) -> Array:
    run = _numbers(k, phi)
    worn = phi > 0.0
    phi = jnp.where(worn, phi, 0.5)
    s, q = exponents(k)
    c = fretting.stick_radius(k, phi)
    inside, y = _outside(r, c, c * jnp.sqrt(1.0 + course.scales.width[run]))
    one, other, part = _between(course, run, y)
    moment = _moment(n, course.scales.unit[run], course.volume.value.shape[1] - 1)
    curve = _limited(course.worn)

    def level(cell: Array) -> Array:
        # h = g E/(1 + g E/H) with an E that grows without end: h ends at H itself.
        grown = jnp.expm1(_interpolated(curve, moment, run, cell))
        rest = jnp.maximum(1.0 - grown / course.ratio[run, cell], 1e-6)
        return jnp.log1p(grown / rest)

    grown = jnp.expm1((1.0 - part) * level(one) + part * level(other))
    grown = grown * jnp.exp(_DECAY * jnp.minimum(moment.late, 20.0))  # no more, or it would overflow
    y, s, q, m = jnp.broadcast_arrays(y, s, q, slip(s, phi))
    at = arc(y, s, q, _closed_digits(y))
    # H and g over (c^2/2) Q/s.
    height = y * at.chord
    steady = jnp.maximum(m - height, 0.0)
    depth = steady * (height * grown) / (steady + height * grown + jnp.finfo(y.dtype).tiny)
    return jnp.where(inside & worn, 0.5 * c * c * at.share * depth, 0.0)


@ruled(r=RADIUS, k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def wear_depth(r: ArrayLike, k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Depth worn off the indenter at a radius in n reduced cycles.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        digits: As of `wear_volume`; the depth at a radius has two less, of the deepest.

    Returns:
        The depth in units of a_0^2/R, broadcast over all arguments: it grows from 0 to `fretting.wear_depth`.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi, n = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    return _depth(_course(k, phi, digits), r, k, phi, n)


@ruled(r=RADIUS, k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def profile(r: ArrayLike, k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Shape of the indenter after n reduced cycles: r^2/2 and the worn depth.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        digits: As of `wear_depth`.

    Returns:
        The height above the apex in units of a_0^2/R, broadcast over all arguments.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi, n = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    return 0.5 * r * r + _depth(_course(k, phi, digits), r, k, phi, n)


@jax.jit
def _radius(course: _Course, k: Array, phi: Array, n: Array) -> Array:
    run = _numbers(k, phi)
    edge = jax.lax.cummax(course.edge, axis=1)
    moment = _moment(n, course.scales.unit[run], edge.shape[1] - 1)
    here, after = edge[run, moment.first], edge[run, moment.first + 1]
    y = here + moment.part * (after - here)
    y = y + (course.scales.width[run] - y) * -jnp.expm1(-_DECAY * moment.late)
    return jnp.where(phi > 0.0, jnp.sqrt(course.scales.inner[run] * (1.0 + y)), 1.0)


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def contact_radius(k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Radius of the contact after n reduced cycles.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        digits: As of `wear_volume`; the radius has two less, of the width of the ring.

    Returns:
        The radius in units of a_0, broadcast over all arguments: it grows from 1 to `fretting.worn_radius`.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    k, phi, n = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    return _radius(_course(k, phi, digits), k, phi, n)


@jax.jit
def _pressure(course: _Course, r: Array, k: Array, phi: Array, n: Array) -> Array:
    run = _numbers(k, phi)
    worn = phi > 0.0
    amplitude = jnp.where(worn, phi, 0.5)
    s, q = exponents(k)
    c = fretting.stick_radius(k, amplitude)
    C, width, unit = course.scales.inner[run], course.scales.width[run], course.scales.unit[run]
    values = course.worn.rate
    moment = _moment(n, unit, values.shape[1] - 1)
    decay = jnp.exp(-_DECAY * moment.late) / unit

    def at(cell: Any) -> Array:
        one, other = values[run, moment.first, cell], values[run, moment.first + 1, cell]
        return (one + moment.part * (other - one)) * decay

    slips, y = _outside(r, c, c * jnp.sqrt(1.0 + width))
    one, other, part = _between(course, run, y)
    ring = (1.0 - part) * at(one) + part * at(other)

    # Where it sticks: the parabola's share, what the ring's pressures leave inwards, and a flat punch with the rest.
    under = r < c
    inner = jnp.where(under, r, 0.5 * c)
    z = ((c - inner) / c) * ((c + inner) / c)
    shape = jnp.broadcast_shapes(z.shape, ring.shape)
    z, s, q, width = (jnp.broadcast_to(x, shape) for x in (z, s, q, width))
    ends = jnp.asarray(_edges(values.shape[-1]), z.dtype)
    density = s * sine_quotient(s, q)

    def add(i: Array, state: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
        tail, power, left, rest = state
        load, outer = at(i), width * ends[i + 1]
        next_tail, _ = arcsine_tail(fold(outer / z), s, q, 8 if z.dtype == jnp.float64 else None)
        next_power = jnp.exp(q * jnp.log(outer))
        taken = density * (next_power - power) + s * s * course.swept[run, i]
        return next_tail, next_power, left + load * (next_tail - tail), rest - load * taken

    zero = jnp.zeros_like(z)
    begin = zero, zero, zero, zero + s * amplitude / C
    _, _, left, rest = jax.lax.fori_loop(0, values.shape[-1], add, begin)
    log_z = jnp.log(z)
    smooth, singular = (1.0 + s) * (1.0 - amplitude) / C, jnp.maximum(rest, 0.0)
    punch = smooth * jnp.exp(s * log_z) + singular * jnp.exp(-q * log_z)
    under_indenter = jnp.where(under, punch + left, jnp.where(slips, ring, 0.0))
    return jnp.where(worn, under_indenter, fretting.initial_pressure(r, k))


@ruled(r=RADIUS, k=EXPONENT, phi=AMPLITUDE, n=CYCLES)
def pressure(r: ArrayLike, k: ArrayLike, phi: ArrayLike, n: ArrayLike, *, digits: int | None = None) -> Array:
    """Pressure at a radius after n reduced cycles, nowhere negative.

    Args:
        r: Radius in units of a_0, r >= 0.
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.98.
        n: Reduced cycles, n >= 0 and finite.
        digits: As of `wear_volume`; the pressure has two less, and less still next to both edges of the ring.

    Returns:
        The pressure in units of F_N/(pi a_0^2), broadcast over all arguments; it ends as `fretting.steady_pressure`.

    Raises:
        ValueError: A concrete argument is outside its range. Under `jit` the result is NaN there.
    """
    r, k, phi, n = jnp.asarray(r), jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    return _pressure(_course(k, phi, digits), r, k, phi, n)
