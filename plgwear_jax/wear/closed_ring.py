"""The worn ring of a rigid parabola on a power law, and of two homogeneous bodies: everything in closed form."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax import fretting
from plgwear_jax._core.domains import POSITIVE, guarded
from plgwear_jax._core.sequential import sequential_forward_mode
from plgwear_jax._core.startup.programs import program, with_slopes
from plgwear_jax._core.xla import materialised
from plgwear_jax.fretting.ring import ring_edge
from plgwear_jax.fretting.stick import slip
from plgwear_jax.special.arcsine import arc, arcsine_tail, fold
from plgwear_jax.special.elementary import log_complement, power_where, ratio_where, sine_quotient
from plgwear_jax.special.exponents import exponents
from plgwear_jax.steady.batch import each, in_turn
from plgwear_jax.steady.closed import Steady
from plgwear_jax.surfaces.cells import RingCells, images_of, products_of, sizes_of
from plgwear_jax.wear.ring_cells import MarchResolution, Scales, edges_of, in_unit, march_resolution_of
from plgwear_jax.wear.ring_curves import RunCurves, curves_by_parts, curves_from, volume_of
from plgwear_jax.wear.ring_run import Pressures, RingRun, RunSolution

# --- without units: radii in a_0, heights in a_0^2/R, pressures in F_N/(pi a_0^2), time as n of the theory ------------


def rings_of(resolution: MarchResolution, k: Array, phi: Array) -> tuple[RingCells, Scales]:
    """(The ring in the cells of each march, its units), for single numbers; for phi = 0 that of phi = 1/2."""
    phi = jnp.where(phi > 0.0, phi, 0.5)
    s, q = exponents(k)
    log_c = log_complement(phi) / (1.0 + s)
    digits = min(8, int(jnp.finfo(k.dtype).precision))
    unworn, width = jnp.expm1(-log_c), ring_edge(s, q, phi, digits, digits)
    grown = jnp.maximum(width - unworn, 16.0 * jnp.finfo(k.dtype).eps * unworn)
    # sigma/(s q) and sigma^2/(q^2 kappa) = sine^2/(2 (1+s)) are finite also as k -> -1 and k -> 1.
    numbers = s, q, jnp.exp(log_c), jnp.exp(s * log_c), unworn, grown, slip(s, phi), sine_quotient(s, q)
    s, q, inner, powered, unworn, grown, slips, sine = jnp.unstack(materialised(jnp.stack(numbers)))

    def cells(from_c: Array, from_1: Array) -> tuple[RingCells, Array]:
        """(The ring in cells, the frictional work of the first cycle over C^(s+2))."""
        size, (t, share, weight) = sizes_of(from_c, from_1), images_of(from_c, from_1, unworn, s, q)
        swept, gap = (share @ jnp.stack([weight, weight * t], -1)).T * sine
        of_ring = products_of(share, weight) * (sine * sine / (2.0 * (1.0 + s)))
        compliance = of_ring + (0.5 * s / (1.0 + s)) * swept[:, None] * swept[None, :]
        # The integral of T^(s-1) (1-T) (T-C) over the unworn ring, over C^(s+2).
        work = jnp.sum(weight * t * jnp.maximum(unworn - t, 0.0))
        load = jnp.maximum(-from_1, 0.0)
        load = power_where(load > 0.0, load, 1.0 + s)
        first = ratio_where(size > 0.0, -jnp.diff(load), size)
        # Depths over C/2, areas over C, pressures over C^s.
        return RingCells(2.0 * compliance, gap, slips * swept - gap, first, swept, from_c, from_1), work

    ring, work = jax.vmap(cells)(*edges_of(unworn, grown, resolution))
    total = jnp.sum(ring.steady[-1])
    unit = total / ((1.0 + s) * powered * work[-1])
    return in_unit(ring, powered * unit), Scales(0.5 * jnp.pi * inner * inner * total, unit, inner, unworn + grown)


def run(resolution: MarchResolution, k: Array, phi: Array) -> RunCurves:
    """The run of single numbers."""
    return curves_from(resolution, *rings_of(resolution, k, phi))


@program(static=1, level=1)
def curves_of(resolution: MarchResolution, k: Array, phi: Array) -> RunCurves:
    """The runs of all pairs of k and phi."""
    return each(sequential_forward_mode(functools.partial(run, resolution)), (k, phi))


@program(static=1, level=1)
def _rings(resolution: MarchResolution, k: Array, phi: Array) -> tuple[RingCells, Scales]:
    k, phi = jnp.broadcast_arrays(k, phi)
    return in_turn(functools.partial(rings_of, resolution), k.shape, k, phi)


def _by_parts(resolution: MarchResolution, k: Array, phi: Array) -> RunCurves:
    """The run of one pair of known numbers, whose derivatives XLA compiles sooner."""
    return curves_by_parts(resolution, *_rings(resolution, k, phi))


def wear_volume(k: Array, phi: Array, n: Array, digits: int | None) -> Array:
    """The worn volume after n reduced cycles, by runs to these digits."""
    k, phi = jnp.broadcast_arrays(k, phi)
    return volume_of(curves_of(march_resolution_of(digits), k, phi), phi, n)


# --- in SI units ------------------------------------------------------------------------------------------------------


class ClosedRing(NamedTuple):
    """A ring whose fields are closed forms."""

    k: Array
    phi: Array
    contact_radius: Array  # a_0 in m
    height: Array  # a_0^2/R
    mean_pressure: Array  # F_N/(pi a_0^2)

    def gap_and_depth(self, y: Array, r: Array) -> tuple[Array, Array]:
        """(The gap beside the unworn contact of the stick radius, the final depth), both in m, at y in the ring."""
        del r
        phi = jnp.where(self.phi > 0.0, self.phi, 0.5)
        s, q = exponents(self.k)
        c = fretting.stick_radius(self.k, phi)
        y, s, q, m = jnp.broadcast_arrays(y, s, q, slip(s, phi))
        at = arc(y, s, q, min(_DIGITS, int(jnp.finfo(y.dtype).precision)))
        height, unit = y * at.chord, 0.5 * self.height * c * c * at.share
        return unit * height, unit * jnp.maximum(m - height, 0.0)

    def pressures(self, run: RunSolution, r: Array) -> tuple[Pressures, tuple[Array, Pressures]]:
        """The pressures at radii, and a radius in m next to c with those there."""
        near = _NEAR * run.stick_radius
        return self._pressures_at(run, r), (near, self._pressures_at(run, near))

    def _pressures_at(self, run: RunSolution, r: Array) -> Pressures:
        s, q = (x[..., None] for x in exponents(self.k))
        c, relative = run.stick_radius, r / self.contact_radius
        inner = jnp.where(r < c, r, 0.5 * c)
        z = (((c - inner) / c) * ((c + inner) / c))[..., None]
        # A pressure in the ring causes one inside c by the shape that it gives the surface there, and takes its part of
        # the load, and of what the ring gives way, from the flat punch of the radius c.
        outer = run.curves.edges[..., 1:]
        y, s, q = jnp.broadcast_arrays(outer / z, s, q)
        tails, *_ = arcsine_tail(fold(y), s, q, 8 if z.dtype == jnp.float64 else None)
        taken = s * sine_quotient(s, q) * jnp.diff(jnp.exp(q * jnp.log(outer)), prepend=0.0) + s * s * run.curves.swept
        caused = jnp.diff(tails, prepend=0.0) - taken * jnp.exp(-q * jnp.log(z))
        unworn = fretting.initial_pressure(relative, self.k)
        steady = fretting.steady_pressure(relative, self.k, self.phi)
        return Pressures(self.mean_pressure * unworn, self.mean_pressure * steady, caused)


_NEAR = 1.0 - 1e-4  # of c; nearer to it the pressures of cells, which end in a step there, are not read
_DIGITS = 12  # digits of g and H, which are known in closed form


@program(static=1)
def _ring_of(digits: int | None, contact: Any, load: Any) -> tuple[ClosedRing, Array, Array]:
    """(The ring, the stick radius, the time of a cycle of a unit wear coefficient)."""
    steady = Steady(contact, load, digits=digits)
    mean = steady._mean_pressure
    found = steady._k, steady.amplitude, steady.contact_radius, steady._height, mean, steady.stick_radius
    *ring, stick = jnp.broadcast_arrays(*(jnp.asarray(x, mean.dtype) for x in found))
    return ClosedRing(*ring), stick, 4.0 * jnp.asarray(contact.friction) * steady._tangential_ratio + 0.0 * mean


@program()
def _in_units(
    ring: ClosedRing, stick: Array, per_cycle: Array, curves: RunCurves, wear_coefficient: Array
) -> RunSolution:
    a_0, scales = ring.contact_radius, curves.scales
    # Time is 4 K mu theta N for N cycles, in 1/Pa.
    unit, volume = scales.unit / ring.mean_pressure, a_0 * a_0 * ring.height * scales.volume
    curves = curves._replace(scales=scales._replace(volume=volume, unit=unit))
    per_cycle = per_cycle * guarded("wear_coefficient", wear_coefficient, POSITIVE)
    return RunSolution(curves, ring.phi, per_cycle, a_0, stick, ring)


class ClosedRun(RingRun):
    """A run of the closed forms, to 1 to 5 digits, by default 4."""

    def _solved(self, given: Any) -> RunSolution:
        contact, load, wear_coefficient = given
        resolution = march_resolution_of(self.digits)
        ring, *units = with_slopes(_ring_of)(self.digits, contact, load)
        curves = with_slopes(curves_of, _by_parts if ring.phi.size == 1 else None)(resolution, ring.k, ring.phi)
        return _in_units(ring, *units, curves, wear_coefficient)
