"""The stresses of steady states, each in one program with what it follows from."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._startup.programs import program
from plgwear_jax.steady.batch import each_state
from plgwear_jax.stresses.field import Half, Pressed, Stress, field
from plgwear_jax.stresses.peaks import Peak, peak
from plgwear_jax.surfaces.bodies import AnyModulus, Elastic


def stresses_of(steady: Any, x: Array, z: Array, worn: bool) -> Stress:
    """The stresses in Pa at x and z in m."""
    return _stress_program((_half_of(steady.contact.material), worn), steady, x, z)


def _half_of(material: Any) -> Half:
    if isinstance(material, AnyModulus):
        return type(material)
    return "homogeneous" if isinstance(material, Elastic) else None


@program(static=1, level=1)
def _stress_program(fixed: tuple[Half, bool], steady: Any, x: Array, z: Array) -> Stress:
    pressed = steady._pressed
    x, z = (jnp.asarray(at, pressed.force.dtype) for at in (x, z))

    def one(pressed: Pressed, x: Array, z: Array) -> Stress:
        return field(pressed, *fixed, x / pressed.radius, z / pressed.radius)

    if pressed.shape == ():
        return one(pressed, x, z)
    return each_state(one, pressed, (x, z))


@program(static=1, level=1)
def _peak_program(fixed: tuple[Half, str], steady: Any, least: Array, most: Array) -> Peak:
    kind, name = fixed
    pressed = steady._pressed
    ends = tuple(jnp.asarray(at, pressed.force.dtype) for at in (least, most))

    def one(pressed: Pressed, least: Array, most: Array) -> Peak:
        return peak(pressed, kind, lambda stress: getattr(stress, name), least, most)

    return each_state(one, pressed, ends)


def peak_stress_of(steady: Any, name: str, least: Array | float = 0.0, most: Array | float = np.inf) -> Peak:
    """The largest value of a property of `Stress` before any wear, between two depths in m."""
    return _peak_program((_half_of(steady.contact.material), name), steady, least, most)
