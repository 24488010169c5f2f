"""The stresses of steady states, each in one program with what it follows from."""

import functools
from typing import Any

import jax.numpy as jnp
from jax import Array

from plgwear_jax._startup.programs import program
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.steady.batch import each_state
from plgwear_jax.stresses.field import Pressed, Stress, field


def stresses_of(steady: Any, x: Array, z: Array, worn: bool) -> Stress:
    """The stresses in Pa at x and z in m."""
    return _fields((_kind_of(steady.contact.material), worn), steady, x, z)


def _kind_of(material: Any) -> type | None:
    """The class of a half-space with a table of moduli, None for others."""
    return type(material) if hasattr(material, "arrays") else None


@program(static=1, level=1)
def _fields(fixed: tuple[type | None, bool], steady: Any, x: Array, z: Array) -> Stress:
    pressed = steady.pressed
    x, z = (jnp.asarray(at, pressed.force.dtype) for at in (x, z))

    def one(pressed: Pressed, x: Array, z: Array) -> Stress:
        return field(pressed, *fixed, x / pressed.radius, z / pressed.radius)

    if pressed.shape == ():
        return one(pressed, x, z)
    return each_state(one, pressed, (x, z))
