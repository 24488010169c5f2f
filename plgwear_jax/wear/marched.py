"""The wear of any test on any contact, by `march`, on a grid that follows the contact."""

import functools
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._cells import NODES, mean_over, nodes_of
from plgwear_jax.shapes import Outline
from plgwear_jax.surfaces.compliance import Compliance
from plgwear_jax.surfaces.disc import disc_of
from plgwear_jax.surfaces.effort import Effort
from plgwear_jax.wear.march import Disc, Moments, Steps, march

# Cells inside the stick radius, in the unworn ring, and beyond; without a stick area all but the first go outwards.
_INSIDE, _RING, _OUTER = 24, 96, 24
_REACH = 16.0  # the largest scar of a test without an end, in contact radii before any wear
_PASSES = 3  # each has a grid by the radii that the pass before has found
_STEPS, _FEWEST, _TOTAL = 96, 16, 512  # steps: in a block; at least in a block; in all, unless each has the least


class Blocks(NamedTuple):
    """What is given in each block of cycles, each field of shape (blocks,); see `march.Steps` for the control."""

    cycles: Array  # NaN for a test without an end
    normal_force: Array
    friction: Array
    displacement_factor: Array
    force_factor: Array
    value: Array


class _Grid(NamedTuple):
    """What the grid of a pass follows."""

    stick: Array  # the smallest radius in m that sticks
    unworn: Array  # contact radius before any wear
    end: Array  # outer edge
    last: Array  # cycles of a test without an end; none in the first pass


class Course(NamedTuple):
    """A test: the state at increasing numbers of cycles, twice where a block ends."""

    cycles: Array  # (times,)
    edges: Array  # of the cells in m, (cells + 1,)
    moments: Moments


@functools.cache
def _shares() -> tuple[np.ndarray, ...]:
    place = np.linspace(0.0, 1.0, _RING + 1)
    begin, end = place**3, 0.4 * (1.0 - place) ** 2
    x = np.linspace(0.0, 1.0, _OUTER + 1)[1:]
    towards = np.expm1(-4.5 * x * x) / np.expm1(-4.5)
    return np.linspace(1.0, 0.0, _INSIDE + 1), begin / (begin + end), towards


def edges_of(grid: _Grid) -> Array:
    """Edges of the cells in T = (r/end)^2: they crowd at the stick radius and at the contact radius before any wear.

    Where nothing sticks, or the contact grows far, their size grows with the radius instead.
    """
    inside, ring, towards = (jnp.asarray(x, grid.end.dtype) for x in _shares())
    unworn = grid.unworn / grid.end
    stick = jnp.minimum(grid.stick / grid.end, (1.0 - 1e-6) * unworn)
    area = stick**2 + (unworn - stick) * (unworn + stick) * ring
    beyond = unworn**2 + (1.0 - unworn) * (1.0 + unworn) * towards
    first = jnp.sqrt(area[1]) - stick
    steep = jnp.log(jnp.maximum(2.0 / _INSIDE * stick / first, 1.0001))
    within = (stick * (1.0 - jnp.expm1(steep * inside) / jnp.expm1(steep))) ** 2
    around = jnp.concatenate([within, area[1:], beyond])
    middle = 0.5 * unworn
    outwards = middle ** jnp.linspace(1.0, 0.0, _RING + _OUTER + 1, dtype=grid.end.dtype)[1:]
    wide = jnp.concatenate([middle * (1.0 - inside), outwards]) ** 2
    return jnp.where(stick < 0.1 * unworn, wide, around)


def _disc(effort: Effort, compliance: Compliance, outline: Outline, grid: _Grid) -> Disc:
    edges, b = edges_of(grid), grid.end
    size = jnp.diff(edges)
    at = b * jnp.sqrt(jnp.maximum(nodes_of(edges, size), 0.0))
    unworn = mean_over(outline.height(at.ravel())) * size
    return Disc(edges, disc_of(compliance, b, edges, effort), unworn, jnp.pi * b * b)


def _steps(blocks: Blocks, grid: _Grid, tangential: Array, count: int) -> Steps:
    # Each block begins with a step of length zero, which finds the slip; the lengths of the others grow.
    total = jnp.where(jnp.isnan(blocks.cycles), grid.last, blocks.cycles)
    growth = np.exp(_BEND * np.linspace(0.0, 1.0, count + 1))
    shares = np.append(0.0, np.diff(growth) / (growth[-1] - 1.0))
    ratios = np.where(np.arange(count + 1) < 2, 0.0, np.exp(_BEND / count))
    given = blocks.normal_force, blocks.friction, blocks.friction * tangential, *blocks[3:]
    lengths = (total[:, None] * jnp.asarray(shares, total.dtype)).ravel()
    ratios = jnp.asarray(np.tile(ratios, total.size), total.dtype)
    return Steps(lengths, ratios, *(jnp.repeat(x, count + 1) for x in given))


_BEND = 8.0  # logarithm of the length of the last step of a block over that of its first


def _flat(outline: Outline, radius: Array) -> Array:
    """The volume in m^3 that a flat scar of this radius has taken off."""
    x, weight = (jnp.asarray(part, radius.dtype) for part in _legendre())
    inside = jnp.sum(weight * 2.0 * x * outline.height(radius * x))
    return jnp.pi * radius**2 * (outline.height(radius[None])[0] - inside)


@functools.cache
def _legendre() -> tuple[np.ndarray, np.ndarray]:
    x, weight = np.polynomial.legendre.leggauss(16)
    return 0.5 + 0.5 * x, 0.5 * weight


def course_of(
    effort: Effort, compliance: Compliance, outline: Outline, ratio: Any, blocks: Blocks, law: Any, linear: bool
) -> Course:
    """The course of a test.

    Args:
        effort: How finely the compliance of a graded body is divided.
        compliance: That of both bodies.
        outline: Of the unworn indenter.
        ratio: theta of a contact radius.
        blocks: The blocks of cycles.
        law: The wear law.
        linear: Whether the law is linear in the pressure.
    """
    number = blocks.cycles.size
    count = int(np.clip(_TOTAL // number, _FEWEST, _STEPS))
    begins = np.arange(number) * (count + 1)

    def one_pass(grid: _Grid, which: Array) -> tuple[_Grid, Course]:
        fixed = jax.lax.stop_gradient(grid)
        disc = _disc(effort, compliance, outline, fixed)
        tangential = ratio(fixed.unworn)
        steps = _steps(blocks, fixed, tangential, count)
        # With the rig in series: its compliance times F_x/(mu theta) is a compliance over theta times F_x/mu.
        steps = steps._replace(
            force_factor=jnp.where(steps.displacement_factor > 0.0, steps.force_factor / tangential, steps.force_factor),
            value=jnp.where(steps.displacement_factor > 0.0, steps.value / steps.tangential, steps.value),
        )
        found = march(disc, law.rate, 1 if linear else 3, steps)
        course = Course(jnp.cumsum(steps.length), fixed.end * jnp.sqrt(disc.edges), found)
        # --- the grid of the next pass
        radius, least = found.contact_radius, jnp.nanmin(found.stick_radius)
        unworn, widest = radius[0], jnp.nanmax(radius[begins])
        # --- the cycles of a test without an end: until the scar has grown, or for many times what it takes to wear
        slips, reach = found.rate[0] > 0.0, _REACH * widest
        rate = jnp.where(slips, found.rate[0], 1.0)
        path = 4.0 * blocks.friction[0] * tangential
        slipping = jnp.where(found.pressure[0] > 0.0, found.slip[0], 0.0) @ jnp.diff(disc.edges)
        gap, depth = disc.area * slipping / path * 4.0, outline.height(unworn[None])[0]
        area = jnp.pi * unworn**2
        # Rings narrower than the cells of the first pass have less pressure than the contact in the mean.
        narrow = 10.0 * depth / law.rate(blocks.normal_force[0] / area, path * depth)
        unit = jnp.where(slips, jnp.minimum(gap, area * depth) / rate, narrow)
        gross = least <= 0.0
        last = jnp.where(gross, 0.5 * _flat(outline, reach) / rate, _LONG * unit)
        room = jnp.where(gross, _REACH - 1.0, jnp.minimum(1.5, 0.02 + 4.0 * (1.0 - least / unworn)))
        first = _Grid(jnp.minimum(least, 0.98 * unworn), unworn, widest * (1.0 + room), last)
        most = jnp.nanmax(radius)
        after = _Grid(least, unworn, most + 0.25 * (most - least), grid.last)
        return jax.tree.map(lambda x, y: jnp.where(which == 0, x, y), first, after), course

    estimate = compliance.radius
    zero = jnp.zeros_like(estimate)
    start = _Grid(zero, estimate, _REACH * estimate, zero)
    _, courses = jax.lax.scan(one_pass, start, np.arange(_PASSES))
    return jax.tree.map(lambda x: x[-1], courses)


_LONG = 200.0  # units of time after which nothing wears any more where the contact sticks
