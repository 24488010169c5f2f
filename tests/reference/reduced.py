"""Runs of a rigid dome on a power law without units: n = 4 K mu theta F_N N/(pi a_0^2) for N cycles.

Radii are in units of a_0, depths in a_0^2/R, volumes in a_0^4/R, pressures in F_N/(pi a_0^2).
"""

import jax
import jax.numpy as jnp
from kinds import FORCE, LIMIT, RADIUS, dome

from plgwear_jax import fretting, partial_slip
from plgwear_jax.loads import Block, Displacement

MANY = 1e9  # cycles for n = 1, as many as make nobody doubt the wear coefficient


def first_rate(k, phi):
    """dV/dn at n = 0."""
    return 0.25 * jnp.pi * partial_slip.energy_per_cycle(k, phi)


def unit_of(k, phi):
    """The final volume over the first rate, by the closed forms: after some five of them it is over."""
    return fretting.wear_volume(k, phi) / first_rate(k, phi)


def coefficient_of(one):
    """The wear coefficient by which n = 1 after so many cycles."""
    mean = one.normal_force / (jnp.pi * one.steady(0.0).contact_radius ** 2)
    return 1.0 / (4.0 * one.friction * one.material.tangential_ratio() * mean * MANY)


class Reduced:
    """The run of a constant force, of the displacement that it needs before any wear, or of blocks of n of forces."""

    def __init__(self, k, phi, digits=None, held=False, blocks=None):
        one = dome(k)
        if jnp.result_type(k) == jnp.float32:
            one = jax.tree.map(jnp.float32, one)
        self.contact = one
        self.a = one.steady(0.0).contact_radius
        self.mean = FORCE / (jnp.pi * self.a**2)
        load = LIMIT * phi
        if held:
            load = Displacement(one.steady(load).displacement_amplitude)
        if blocks is not None:
            load = [Block(force, MANY * n) for force, n in zip(load, blocks, strict=True)]
        self.run = one.over_cycles(load, coefficient_of(one), digits=digits)

    def volume(self, n):
        return self.run.volume(MANY * n) * (RADIUS / self.a**4)

    def rate(self, n):
        return self.run.rate(MANY * n) * (MANY * RADIUS / self.a**4)

    def radius(self, n):
        return self.run.contact_radius(MANY * n) / self.a

    def stick_radius(self, n):
        return self.run.stick_radius(MANY * n) / self.a

    def n_to(self, share):
        return self.run.cycles_to(share) / MANY

    def depth(self, r, n):
        return self.run.depth(r * self.a, MANY * n) * (RADIUS / self.a**2)

    def pressure(self, r, n):
        return self.run.pressure(r * self.a, MANY * n) / self.mean
