"""The wear of any test on any contact, by `march`, on a grid that follows the contact."""

import functools
from typing import Any, ClassVar, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import (
    POSITIVE,
    ArrayLike,
    Domain,
    RefusedError,
    field_nan_outside,
    nan_outside,
    nan_unless,
)
from plgwear_jax._core.doubts import SOON, of_contact, of_wear, one_question
from plgwear_jax._core.sequential import sequential_forward_mode
from plgwear_jax._core.startup.programs import holds_tracers, program, traced, with_slopes
from plgwear_jax.special.elementary import in_dtype, quotient, ratio_where
from plgwear_jax.special.root import first_at
from plgwear_jax.steady.batch import as_numbers, vmap_contacts
from plgwear_jax.steady.closed import Steady
from plgwear_jax.steady.state import bodies_of, opens, theta_of
from plgwear_jax.surfaces.cells import mean_heights
from plgwear_jax.surfaces.effort import Effort, effort_of
from plgwear_jax.surfaces.punch import Bodies
from plgwear_jax.surfaces.tension import MOST
from plgwear_jax.wear_laws import WearLaw

from .contact_march import Disc, Moments, StageNumbers, Steps, march, until
from .curves import ROUNDINGS, Curve, Moment, cells_around, limited, moment_at
from .run import Run

# Nearer to gross slip the scar of a test without an end outgrows the cells, which are larger than the stick area.
FOLLOWED = Domain(
    "0 <= F_x/(mu F_N) <= 0.995 under this wear law (from 1 on the slip is gross)",
    lambda phi: (phi >= 0.0) & (phi <= 0.995),
)
# Cells inside the stick radius, in the unworn ring, and beyond; without a stick area all but the first go outwards.
_INSIDE, _RING, _OUTER = 32, 96, 40
_RING_OF_BLOCKS = 128  # less crowded at the stick radius, since that of other blocks is somewhere in the ring
_REACH = 16.0  # the largest scar of a test without an end, in contact radii before any wear
# Each pass has a grid by the radii of the pass before, until these move by less than this share of the ring.
_PASSES, _SETTLED = (3, 7), 0.05
_NARROWEST = 3e-4  # slip ring, in contact radii
_STEPS, _FEWEST, _TOTAL = 128, 16, 512  # steps: in a block; at least in a block; in all, unless each has the least


class _Grid(NamedTuple):
    """What the grid of a pass follows."""

    stick: Array  # the smallest radius in m that sticks at the end of a block
    unworn: Array  # contact radius before any wear
    pressed: Array  # that at the beginning of the block with the largest normal force
    end: Array  # outer edge
    last: Array  # cycles of a test without an end; none in the first pass
    longer: Array  # logarithm of how many times as long it takes as by a law that is proportional to the pressure


class TestHistory(NamedTuple):
    """A test: the state at increasing numbers of cycles, twice where a block ends."""

    cycles: Array  # (times,)
    edges: Array  # of the cells in m, (cells + 1,)
    moments: Moments
    beyond: Array  # the last time: 0 if nothing wears there, 1 if there are no more blocks, 2 if the wear goes on

    def _moment(self, cycles: Array) -> Moment:
        """The moments, NaN beyond what is known."""
        moment = moment_at(self.cycles, cycles, within=True)
        late = moment.late > ROUNDINGS * jnp.finfo(cycles.dtype).eps * cycles
        return moment._replace(part=nan_unless(~late | (self.beyond <= 0.0), moment.part))

    def number(self, name: str, cycles: Array) -> Array:
        """One number of the history, such as its contact radius."""
        moment, moments = self._moment(cycles), self.moments
        if name == "deepest_wear":
            cells = np.arange(moments.depth.shape[-1]).reshape(-1, *(1,) * moment.part.ndim)
            return jnp.max(moment.between(moments.depth, cells), 0)
        if name == "volume":
            return moment.on(vmap_contacts(limited, (Curve(self.cycles, moments.volume, moments.rate),)))
        return moment.between(getattr(moments, name))

    def field(self, name: str, r: Array, cycles: Array) -> Array:
        """The worn depth or the pressure at radii."""
        moment, edges = self._moment(cycles), self.edges
        cell = cells_around(edges**2, r * r)
        found = cell.across(functools.partial(moment.between, getattr(self.moments, name)))
        inside = jnp.where(r < edges[..., -1], jnp.maximum(found, 0.0), 0.0)
        return inside + 0.0 * moment.part * edges[..., -1] * jnp.minimum(r, 1.0)  # NaN where they are

    def cycles_to(self, name: str, goal: Array) -> Array:
        """When so much is worn: a depth, a volume, or a share of the last volume."""
        number, last = "deepest_wear" if name == "depth" else "volume", self.moments.volume[..., -1]
        goal = goal * last if name == "share" else goal
        found = first_at(lambda history, cycles: history.number(number, cycles), self, goal, self.cycles[..., -1])
        unknown = last <= 0.0 if name == "share" else jnp.isinf(found) & (self.beyond > 1.0)
        return jnp.where(unknown, jnp.nan, found)

    def last(self) -> Array:
        """Cycles at the end of the history."""
        return self.cycles[..., -1] + 0.0 * self.moments.rate[..., 0]


@functools.cache
def _cell_shares(ring: int) -> tuple[np.ndarray, ...]:
    place = np.linspace(0.0, 1.0, ring + 1)
    begin, end = place**2, 0.4 * (1.0 - place) ** 2
    if ring == _RING_OF_BLOCKS:
        begin, end = place**1.2, (1.0 - place) ** 1.2
    x = np.linspace(0.0, 1.0, _OUTER + 1)[1:]
    towards = np.expm1(-2.0 * x * x) / np.expm1(-2.0)
    return np.linspace(1.0, 0.0, _INSIDE + 1), begin / (begin + end), towards


def _disc(bodies: Bodies, grid: _Grid, count: int) -> Disc:
    """Cells with edges in T = (r/end)^2: they crowd at the stick radius and at the contact radius before any wear.

    In blocks it is that under the largest normal force, whose ring can lie outside of the others. Where nothing sticks
    or slips, or the contact grows far, their size grows with the radius instead.
    """
    b = grid.end
    inside, ring, towards = in_dtype(b.dtype, *_cell_shares(count))
    pressed = grid.pressed / b
    stick = jnp.minimum(grid.stick / b, (1.0 - 1e-6) * pressed)
    area = stick**2 + (pressed - stick) * (pressed + stick) * ring
    beyond = pressed**2 + (1.0 - pressed) * (1.0 + pressed) * towards
    first = jnp.sqrt(area[1]) - stick
    steep = jnp.log(jnp.maximum(2.0 / _INSIDE * stick / first, 1.0001))
    within = (stick * (1.0 - jnp.expm1(steep * inside) / jnp.expm1(steep))) ** 2
    around = jnp.concatenate([within, area[1:], beyond])
    middle = 0.5 * grid.unworn / b
    outwards = middle ** jnp.linspace(1.0, 0.0, count + _OUTER + 1, dtype=b.dtype)[1:]
    wide = jnp.append(middle * (1.0 - inside), outwards) ** 2
    edges = jnp.where((grid.stick < grid.pressed) & (stick >= 0.1 * pressed), around, wide)
    radii = jnp.append(0.0, b * jnp.sqrt(edges[1:]))  # the root of 0 has no derivative
    unworn = mean_heights(bodies.outline, b, edges) * jnp.diff(edges)
    return Disc(edges, bodies.disc_compliance(b, edges), unworn, jnp.pi * b * b, radii)


def _in_steps(blocks: StageNumbers, grid: _Grid, count: int) -> tuple[Steps, Array]:
    """(The steps, the cycles since the beginning at the end of each)."""
    # Each block begins with a step of length zero, which finds the slip; the lengths of the others grow.
    endless = jnp.isnan(blocks.cycles)
    total = jnp.where(endless, grid.last, blocks.cycles)
    bend = _BENDS[0] + jnp.where(endless, grid.longer, 0.0)
    bend = jnp.where(endless & (grid.stick <= 0.0), _BENDS[1], bend)[:, None]
    growth = jnp.expm1(bend * jnp.asarray(np.linspace(0.0, 1.0, count + 1), bend.dtype)) / jnp.expm1(bend)
    lengths = (total[:, None] * jnp.diff(growth, prepend=0.0)).ravel()
    ratios = jnp.where(np.arange(count + 1) < 2, 0.0, jnp.exp(bend / count)).ravel()
    # Block after block, so that no roundings of steps add up.
    cycles = (jnp.append(0.0, jnp.cumsum(total)[:-1])[:, None] + total[:, None] * growth).ravel().astype(total.dtype)
    return Steps(lengths, ratios, jax.tree.map(lambda x: jnp.repeat(x, count + 1), blocks)), cycles


# Logarithm of the length of the last step of a block over that of its first, and of a test without end in gross slip:
# that lasts ten thousand times as long as its beginning, in which it may turn into partial slip.
_BENDS = 8.0, 13.0


def history_of(effort: Effort, contact: Any, blocks: StageNumbers, law: WearLaw) -> TestHistory:
    """The history of a test."""
    bodies = bodies_of(effort, contact, field_nan_outside(contact, "normal_force"))
    outline = bodies.outline
    known = jnp.inf if outline.shape.known_radius is None else outline.shape.known_radius
    number = blocks.cycles.size
    count = int(np.clip(_TOTAL // number, _FEWEST, _STEPS))
    begins = np.arange(number) * (count + 1)
    most_pressed = jnp.argmax(blocks.normal_force) * (count + 1)

    def moved(found: Moments) -> Array:
        return found.force_amplitude[begins] > 1e-9 * blocks.friction * blocks.normal_force

    def one_pass(which: Array, grid: _Grid) -> tuple[Array, Array, _Grid, TestHistory]:
        disc = _disc(bodies, grid, _RING if number == 1 else _RING_OF_BLOCKS)
        theta = theta_of(contact, bodies, grid.unworn)
        steps, cycles = _in_steps(blocks, grid, count)
        found = march(disc, theta, law, steps)
        # In the steady state the edge touches without pressure, so that the march may lose it. While the normal force
        # does not fall the radius is the largest one so far, and where it falls this begins anew, one `end` higher.
        falls = jnp.append(0, jnp.diff(blocks.normal_force) < 0.0)
        level = grid.end * jnp.repeat(jnp.cumsum(falls), count + 1)
        found = found._replace(contact_radius=lax.cummax(found.contact_radius + level) - level)
        goes_on = (found.stick_radius[-1] <= 0.0) & (found.rate[-1] > 0.0)
        beyond = jnp.where(jnp.isnan(blocks.cycles[-1]), 2.0 * goes_on, 1.0)
        history = TestHistory(cycles, disc.radii, found, beyond.astype(cycles.dtype))
        # --- the grid of the next pass
        radius, sticks = found.contact_radius, found.stick_radius.reshape(number, -1)
        least = jnp.nanmin(sticks)
        # While a displacement is held more and more sticks: what is worn deepest ends where it sticks in the end, if
        # this is known.
        last = jnp.nanmin(sticks[:, -1])
        stick = jnp.where((least > 0.0) & (last > 0.0), last, least)
        unworn, widest, pressed = radius[0], jnp.nanmax(radius[begins]), radius[most_pressed]
        # --- the cycles of a test without an end: until the scar has grown, or for many times what it takes to wear
        slips, reach = found.rate[0] > 0.0, jnp.minimum(_REACH * widest, known)
        rate = jnp.where(slips, found.rate[0], 1.0)
        path = 4.0 * blocks.friction[0] * theta
        slipping = jnp.where(found.pressure[0] > 0.0, found.slip[0], 0.0) @ jnp.diff(disc.edges)
        gap, depth = disc.area * slipping / path * 4.0, outline.height(unworn[None])[0]
        area = jnp.pi * unworn**2
        # The rates under the mean pressure, under a hundredth of it, and under that of a scar of the largest radius.
        share = (unworn / reach) ** 2
        shares = jnp.append(jnp.asarray([1.0, 1e-2], share.dtype), share)
        mean, hundredth, wide = jnp.unstack(law.rate(blocks.normal_force[0] / area * shares, path * depth))
        # Rings narrower than the cells of the first pass have less pressure than the contact in the mean. If that wears
        # nothing, as below the threshold of a law, the test ends at once.
        narrow = jnp.where(mean > 0.0, quotient(10.0 * depth, jnp.where(mean > 0.0, mean, 1.0)), 0.0)
        unit = jnp.where(slips, quotient(jnp.minimum(gap, area * depth), rate), narrow)
        gross = (least <= 0.0) & slips
        # Where the rate falls faster than the pressure, as p^m, this dies out as the cycles to the power -1/(m-1).
        fall = ratio_where(hundredth > 0.0, mean, hundredth, 100.0)
        longer = lax.stop_gradient(jnp.clip(jnp.log(fall) - _LOG_HUNDRED, 0.0, 3.0 * _LOG_HUNDRED))
        # Where it falls slower, a wide scar wears faster than it does at first.
        faster = lax.stop_gradient(jnp.maximum(1.0, ratio_where(mean > 0.0, wide, share * mean, 1.0)))
        # What a flat scar of that radius has taken off
        taken = outline.height(reach[None]) - mean_heights(outline, reach, jnp.arange(2, dtype=reach.dtype))
        half = 0.5 * jnp.pi * reach**2 * taken[0]
        last = jnp.where(gross, quotient(half, rate * faster), _LONG * unit * jnp.exp(longer))
        # The cells of the first pass are so wide that both radii are some percent off: a ring narrower than one of them
        # seems to stick as a whole.
        room = jnp.where(gross, _REACH - 1.0, jnp.minimum(1.5, 0.1 + 4.0 * (1.0 - least / unworn)))
        first = _Grid(jnp.minimum(stick, 0.98 * unworn), unworn, pressed, widest * (1.0 + room), last, longer)
        most = jnp.nanmax(radius)
        moves = jnp.any(moved(found))
        end = jnp.where(moves, most + jnp.where(gross, 0.25, 0.12) * (most - stick), 1.1 * widest)
        # The largest radius of all times is known to a cell: derivatives of the grid are those of a similar contact.
        end = unworn * lax.stop_gradient(end / unworn)
        after = _Grid(jnp.where(moves, stick, unworn), unworn, pressed, end, grid.last, grid.longer)
        shift = jnp.maximum(abs(after.stick - grid.stick), abs(unworn - grid.unworn)) / (unworn - after.stick)
        # Where the scar has outgrown the cells; once the contact would open they need not follow it.
        pulls = jnp.any((found.least < -MOST) & ~jnp.isnan(found.rate))
        shift = jnp.where(jnp.isnan(found.rate[-1]) & ~pulls, jnp.inf, shift)
        shift = lax.stop_gradient(jnp.where(moves & (after.stick > 0.0), shift, 0.0))
        return which + 1, shift, jax.tree.map(lambda x, y: jnp.where(which == 0, x, y), first, after), history

    estimate = bodies.radius
    zero = 0.0 * estimate  # with derivatives from the start, or JAX would trace the passes twice for these
    start = _Grid(zero, estimate, estimate, _REACH * estimate, zero, zero)
    empty = jax.tree.map(lambda x: jnp.zeros(x.shape, x.dtype) + zero, jax.eval_shape(one_pass, 0, start)[3])
    _, shift, _, history = lax.while_loop(
        lambda state: (state[0] < _PASSES[0]) | ((state[1] > _SETTLED) & (state[0] < _PASSES[1])),
        lambda state: one_pass(state[0], state[2]),
        (jnp.int32(0), lax.stop_gradient(zero), start, empty),
    )
    # No grid follows a narrower ring: it would seem to stick, and nothing would ever wear.
    inner, outer = history.moments.stick_radius[0], history.moments.contact_radius[0]
    narrow = (outer - inner < _NARROWEST * outer) | (shift > _SETTLED)
    narrow &= jnp.isnan(blocks.cycles[-1]) & moved(history.moments)[0]
    # A number outside its range leaves some moments that look plausible, and so does what lies beyond a table.
    moments = history.moments
    unknown = jnp.isnan(moments.rate + moments.force_amplitude) | (moments.contact_radius > known)
    return history._replace(moments=until((moments.least < -MOST) | narrow | unknown, moments))


_LOG_HUNDRED = float(np.log(100.0))
_LONG = 200.0  # units of time after which nothing wears any more where the contact sticks


# --- the run ----------------------------------------------------------------------------------------------------------


@program(static=1, level=1, slopes=1)
def _histories(effort: Effort, contact: Any, blocks: StageNumbers, law: Any) -> TestHistory:
    """The histories of all contacts, as differentiable functions of the numbers of contacts, blocks and laws."""
    return vmap_contacts(sequential_forward_mode(functools.partial(history_of, effort)), (contact, blocks, law))


class MarchedRun(Run):
    """A run of any test, to about 2 digits of the volume.

    A test without an end is followed until nothing wears any more, or, in gross slip, until the scar has some ten times
    the radius of the contact before any wear. Under a force it takes amplitudes up to 0.995 mu F_N, and without an end
    slip rings of at least 3e-4 contact radii. Concrete amplitudes beyond that raise an error, and so do concrete
    numbers of cycles beyond the widest scar or the last block. Under `jit`, and in derivatives, results there are NaN.

    Under a constant force volumes are within 1 % of the last one, within 2 % in slip rings narrower than 1e-2 contact
    radii, and contact radii within 2 % for k >= -0.7. Below that and near gross slip radii are up to 15 % off, and
    above 0.99 mu F_N volumes up to 7 %. With layers thinner than a thirtieth of the contact radius, or a kink beside
    the stick area, volumes are up to 4 % off. After a displacement within some percent of the transition to gross
    slip, the last volume of a test without an end is up to 7 % off. In single precision volumes are 1.5 % further off
    or less, up to 12 % in slip rings narrower than 5e-3 contact radii; for k < -0.3 the same in rings narrower than
    0.1, of which some are refused. Derivatives have about two digits; those by the exponent of `PressurePower` in
    gross slip are up to 6 % off. Where gross slip turns into partial slip late in a test, those by k have only the
    right sign and size.
    """

    shares: ClassVar = FOLLOWED
    known: ClassVar = 2, " for this test"

    def _check(self, cycles: Any = None, **given: Any) -> None:
        """Refuse also concrete cycles beyond the last block, or beyond the widest scar."""
        super()._check(cycles=cycles, **given)
        if cycles is None or traced((self.contact, self.load, self.law, cycles)):
            return
        last = np.where(self._solution.beyond > 0.0, self.lasting_cycles, np.inf)
        wide = "after which the scar is ten times as wide as the unworn contact, or as wide as its table of heights"
        where = wide if self.load.lasts else "where the blocks end"
        # In the precision of the run, whose sum of blocks a caller may have taken from `lasting_cycles`.
        asked, end = np.broadcast_arrays(cycles, last)
        beyond = asked > end * (1.0 + 1e-5)
        if np.any(beyond):
            told = f"cycles <= {end[beyond][0]}, {where}"
            raise RefusedError(f"cycles = {asked[beyond][0]} is outside the allowed range {told}")

    def _rows(self) -> StageNumbers:
        rows = []
        for stage in self.load.stages():
            force, mu = (
                nan_outside(name, getattr(self.contact if getattr(stage, name) is None else stage, name), POSITIVE)
                for name in ("normal_force", "friction")
            )
            held = stage.load.control(mu * force)
            if stage.load.holds_force and self.load.lasts:
                held = held._replace(value=nan_unless(FOLLOWED.contains(held.value / (mu * force)), held.value))
            rows.append((stage.cycles, force, mu, *held))
        return StageNumbers(
            *(jnp.stack(jnp.broadcast_arrays(*map(jnp.asarray, column)), -1) for column in zip(*rows, strict=True))
        )

    def _given(self) -> Any:
        return as_numbers((self.contact, self._rows(), self.law))

    def _solve(self) -> TestHistory:
        found = super()._solve()
        volume = found.moments.volume
        # Of several runs those that are followed to their ends stay numbers beside others that are NaN.
        if not holds_tracers(volume) and volume.size and np.isnan(volume).any(-1).all():
            first = np.isnan(volume).argmax(-1)
            if volume.ndim == 1 and found.moments.least[first] < -MOST:
                when = f"after {found.cycles[first]:.3g} cycles"
                raise RefusedError(opens(when, found.moments.least[first], found.moments.opens[first]))
            told = "as near gross slip or with a wear coefficient that is not in 1/Pa^exponent"
            narrow = f"or beyond its table of heights, or the slip ring is narrower than {_NARROWEST}"
            raise RefusedError(f"the scar grows beyond the cells of the time stepping, {told}, {narrow} contact radii")
        return found

    def _solved(self, given: Any) -> TestHistory:
        return with_slopes(_histories)(effort_of(min(self.digits or 2, 2)), *given)

    def displacement_amplitude(self, cycles: ArrayLike) -> Array:
        """Amplitude in m of the tangential displacement of the contact, without that of a rig."""
        return self._at("displacement_amplitude", cycles)

    def _doubt(self) -> str | None:
        history = self._solution
        last = np.fmin.reduce(history.cycles[..., -1], axis=None, initial=np.inf)
        if not (self.load.lasts and last < _LONG * SOON):
            return None
        if np.any(history.beyond > 0.0):
            return of_wear(float(last), grows=True)
        return self._doubt_of_soon()

    @property
    def steady(self) -> Steady | None:
        known = not (self.load.holds_force or traced(self._solution.moments.stick_radius))
        ever_slips = known and np.any(self._solution.moments.stick_radius <= 0.0)
        if not self.load.lasts or ever_slips:
            return None
        with one_question(*of_contact(self.contact)):
            return self.contact.steady(self.load)
