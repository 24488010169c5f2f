"""The stresses of steady states, each in one program with what it follows from."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, lax

from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._core.startup.programs import follows, program, read_with_slopes, traced, value_of
from plgwear_jax.special.pchip import Piecewise
from plgwear_jax.stresses.field import Pressed, Stress, body_of, field
from plgwear_jax.stresses.peaks import Peak, Wanted, highest, in_si, peak_at

from .batch import as_numbers, in_turn, vmap_contacts


def stresses_of(steady: Any, x: Array, z: Array, worn: bool) -> Stress:
    """The stresses in Pa at x and z in m."""
    return _read(functools.partial(_stress_program, worn), steady, (x, z))


def _read(read: Callable[[Any, Any], Any], steady: Any, more: Any) -> Any:
    """What a program reads of a pressed contact, with its derivatives at known numbers as a program of its own."""
    if not follows((steady.contact, steady.load, more)):
        return read(_pressed_of(steady), more)
    return read_with_slopes(
        lambda given: _pressed_program(steady._solved(given)), read, steady._given(), more, vars(steady)
    )


@program(level=1)
def _pressed_program(steady: Any) -> Pressed:
    return steady._pressed


def _pressed_of(steady: Any) -> Pressed:
    return steady._once("pressed", lambda: _pressed_program(as_numbers(steady)))


def half_space_of(material: Any, radius: Array) -> tuple[Array, Array | None, Piecewise | None]:
    """The last fields of `Pressed`, from `nu` on, for contacts of these radii."""
    return vmap_contacts(lambda material, radius: material.seen_by(radius), (material, radius))


@program(static=1, level=1)
def _stress_program(worn: bool, pressed: Pressed, places: tuple[Array, Array]) -> Stress:
    x, z = (jnp.asarray(at, pressed.force.dtype) for at in places)

    def one(pressed: Pressed, x: Array, z: Array) -> Stress:
        return field(pressed, body_of(pressed), worn, x / pressed.radius, z / pressed.radius)

    if pressed.shape == () and x.size and z.size:
        return one(pressed, x, z)
    return in_turn(one, pressed.shape, pressed, more=(x, z))


@program(level=2)
def _searched(pressed: Pressed, wanted: Wanted) -> tuple[Peak, Peak]:
    """The peaks, in SI units and with their places in units of a_0, without derivatives."""

    def one(pressed: Pressed, wanted: Wanted) -> tuple[Peak, Peak]:
        found = highest(pressed, wanted)
        return in_si(pressed, wanted, found), found

    return in_turn(one, pressed.shape, pressed, more=(wanted,))


@program(level=1)
def _at_known_place(pressed: Pressed, known: tuple[Wanted, Array, Array]) -> Peak:
    return in_turn(peak_at, pressed.shape, pressed, more=known)


def _wanted(name: str, least: ArrayLike = 0.0, most: ArrayLike = np.inf) -> Wanted:
    return Wanted(*as_numbers((float(name == "mises"), least, most)))


def peak_stress_of(steady: Any, name: str, *between: ArrayLike) -> Peak:
    """The largest value of a property of `Stress` before any wear, between two depths in m."""
    wanted = _wanted(name, *between)
    if not traced((steady.contact, steady.load, wanted)):
        return _searched(_pressed_of(steady), wanted)[0]
    return _read(_peak_there, steady, wanted)


def _peak_there(pressed: Any, wanted: Any) -> Any:
    """The peak by its search, and by a program for the derivatives at its place."""
    known = jax.tree.map(lambda x: lax.stop_gradient(value_of(x)), (pressed, wanted))
    _, place = _searched(*known)
    return _at_known_place(pressed, (wanted, place.x, place.z))


def peak_with_slopes(pressed: Any, name: str) -> Any:
    """The largest tension or von Mises stress of what is known with its slopes."""
    return _peak_there(pressed, _wanted(name.removeprefix("peak_"))).value
