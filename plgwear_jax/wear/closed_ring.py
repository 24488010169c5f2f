"""The worn ring of a rigid parabola on a power law, and of two homogeneous bodies: everything in closed form."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax import fretting
from plgwear_jax._core.domains import POSITIVE, nan_outside
from plgwear_jax._core.sequential import sequential_forward_mode
from plgwear_jax._core.startup.programs import program, with_slopes
from plgwear_jax._core.xla import materialised
from plgwear_jax.fretting.ring import ring_edge
from plgwear_jax.fretting.stick import slip
from plgwear_jax.special.arcsine import arc, arcsine_tail, fold
from plgwear_jax.special.elementary import exponents, in_dtype, log_complement, power_where, ratio_where, sine_quotient
from plgwear_jax.steady.batch import in_turn, vmap_contacts
from plgwear_jax.steady.closed import Steady
from plgwear_jax.surfaces.cells import RingCells, images_of, products_of

from .ring_cells import MarchResolution, Scales, edges_of, march_resolution_of
from .ring_curves import RunCurves, curves_by_parts, curves_from
from .ring_run import RingRun, RunSolution

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
        t, share, weight, size = images_of(from_c, from_1, unworn, s, q)
        flat_punch_gap, gap = (share @ jnp.stack([weight, weight * t], -1)).T * sine
        of_ring = products_of(share, weight) * (sine * sine / (2.0 * (1.0 + s)))
        compliance = of_ring + (0.5 * s / (1.0 + s)) * flat_punch_gap[:, None] * flat_punch_gap
        # The integral of T^(s-1) (1-T) (T-C) over the unworn ring, over C^(s+2).
        work = jnp.sum(weight * t * jnp.maximum(unworn - t, 0.0))
        load = jnp.maximum(-from_1, 0.0)
        load = power_where(load > 0.0, load, 1.0 + s)
        first = ratio_where(size > 0.0, -jnp.diff(load), size)
        # Depths over C/2, areas over C.
        ring = RingCells(
            2.0 * compliance / powered,
            gap,
            slips * flat_punch_gap - gap,
            powered * first,
            flat_punch_gap,
            from_c,
            from_1,
        )
        return ring, work

    ring, work = jax.vmap(cells)(*edges_of(unworn, grown, resolution))
    total = jnp.sum(ring.steady[-1])
    unit = total / ((1.0 + s) * powered * work[-1])
    return ring, Scales(0.5 * jnp.pi * inner * inner * total, unit, inner, unworn + grown)


def run(resolution: MarchResolution, k: Array, phi: Array) -> RunCurves:
    """The run of single numbers."""
    return curves_from(resolution, *rings_of(resolution, k, phi))


@program(static=1, level=1)
def curves_of(resolution: MarchResolution, k: Array, phi: Array) -> RunCurves:
    """The runs of all pairs of k and phi."""
    return vmap_contacts(sequential_forward_mode(functools.partial(run, resolution)), (k, phi))


@program(static=1, level=1)
def _rings(resolution: MarchResolution, k: Array, phi: Array) -> tuple[RingCells, Scales]:
    return in_turn(functools.partial(rings_of, resolution), k.shape, k, phi)


# --- in SI units ------------------------------------------------------------------------------------------------------


class ClosedRing(NamedTuple):
    """A ring whose fields are closed forms."""

    k: Array
    phi: Array
    a_0: Array  # contact radius before any wear in m
    c: Array  # stick radius in m
    height: Array  # a_0^2/R
    mean_pressure: Array  # F_N/(pi a_0^2)
    theta: Array  # the tangential compliance over the normal one
    friction: Array
    force: Array  # F_x in N

    def gap_and_depth(self, y: Array, r: Array) -> tuple[Array, Array]:
        """(The gap beside the unworn contact of the stick radius, the final depth), both in m, at y in the ring."""
        (s, q), c = exponents(self.k), self.c / self.a_0
        y, s, q, m = jnp.broadcast_arrays(y, s, q, slip(s, self.phi))
        at = arc(y, s, q, min(_DIGITS, int(jnp.finfo(y.dtype).precision)))
        height, unit = y * at.chord, 0.5 * self.height * c * c * at.share
        return unit * height, unit * jnp.maximum(m - height, 0.0)

    def pressures(self, r: Array) -> tuple[Array, Array]:
        """The pressures in Pa before any wear and in the end."""
        relative = r / self.a_0
        unworn = fretting.initial_pressure(relative, self.k)
        return self.mean_pressure * unworn, self.mean_pressure * fretting.steady_pressure(relative, self.k, self.phi)

    def caused(self, curves: RunCurves) -> tuple[Array, Callable[[Array], Array]]:
        """(The least known 1 - (r/c)^2 inside c; by it what pressures a unit of pressure in each cell causes there)."""
        s, q = (x[..., None] for x in exponents(self.k))

        def caused_at(z: Array) -> Array:
            # A pressure in the ring causes one inside c by the shape that it gives the surface there, and takes its
            # part of the load, and of what the ring gives way, from the flat punch of the radius c.
            outer, z = curves.edges[..., 1:], z[..., None]
            places = jnp.broadcast_arrays(outer / z, s, q)
            tails, *_ = arcsine_tail(fold(places[0]), *places[1:], 8 if z.dtype == jnp.float64 else None)
            taken = (
                s * sine_quotient(s, q) * jnp.diff(jnp.exp(q * jnp.log(outer)), prepend=0.0)
                + s * s * curves.flat_punch_gap
            )
            return jnp.diff(tails, prepend=0.0) - taken * jnp.exp(-q * jnp.log(z))

        return jnp.full_like(self.c, _NEAREST), caused_at


_NEAREST = 1.9999e-4  # nearer to c the pressures of cells, which end in a step there, are not read
_DIGITS = 12  # digits of g and H, which are known in closed form


@program(static=1)
def _ring_of(digits: int | None, contact: Any, load: Any) -> ClosedRing:
    steady = Steady(contact, load, digits=digits)
    mean, theta = steady._mean_pressure, steady._tangential_ratio
    scales = steady.contact_radius, steady.stick_radius, steady._height, mean, theta, contact.friction
    found = in_dtype(mean.dtype, steady._k, steady.amplitude, *scales, steady.tangential_force)
    return ClosedRing(*jnp.broadcast_arrays(*found))


@program()
def _in_units(ring: ClosedRing, curves: RunCurves, wear_coefficient: Array) -> RunSolution:
    # Time is 4 K mu theta N for N cycles, in 1/Pa.
    unit, final = curves.unit / ring.mean_pressure, ring.a_0 * ring.a_0 * ring.height * curves.final
    K, curves = nan_outside("wear_coefficient", wear_coefficient, POSITIVE), curves._replace(final=final, unit=unit)
    pace = 4.0 * ring.friction * ring.theta * K / unit
    return RunSolution(curves, ring.phi, pace, ring.a_0, ring.c, ring, ring.force, ring.friction / K)


class ClosedRun(RingRun):
    """A run of the closed forms, to 1 to 5 digits, by default 4."""

    def _solved(self, given: Any) -> RunSolution:
        contact, load, wear_coefficient = given
        ring = with_slopes(_ring_of)(self.digits, contact, load)
        # XLA compiles the derivatives of one run of known numbers sooner in parts.
        parts = None if ring.phi.size != 1 else lambda steps, *given: curves_by_parts(steps, *_rings(steps, *given))
        curves = with_slopes(curves_of, parts)(march_resolution_of(self.digits), ring.k, ring.phi)
        return _in_units(ring, curves, wear_coefficient)
