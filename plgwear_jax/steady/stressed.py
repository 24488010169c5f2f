"""The stresses of steady states, each in one program with what it follows from."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._startup.programs import follows, program, read_with_slopes, traced
from plgwear_jax.steady.batch import as_numbers, each_state
from plgwear_jax.stresses.field import Half, Pressed, Stress, body_of, field
from plgwear_jax.stresses.peaks import Peak, Wanted, highest, in_si, peak_at
from plgwear_jax.surfaces.bodies import AnyModulus, Elastic


def stresses_of(steady: Any, x: Array, z: Array, worn: bool) -> Stress:
    """The stresses in Pa at x and z in m."""
    read = functools.partial(_stress_program, (_half_of(steady.contact.material), worn))
    more = jnp.asarray(x), jnp.asarray(z)
    return _with_slopes(read, steady, more) if _follows(steady, more) else read(_pressed_of(steady), more)


def _follows(steady: Any, more: Any) -> bool:
    return follows((steady.contact, steady.load, more))


def _with_slopes(read: Callable[[Any, Any], Any], steady: Any, more: Any) -> Any:
    """What a program reads of a pressed contact, with its derivatives at known numbers as a program of its own."""

    def solve(given: Any) -> Pressed:
        return _pressed_program(steady._solved(given))

    return read_with_slopes(solve, read, steady._given(), more, vars(steady))


@program(level=1)
def _pressed_program(steady: Any) -> Pressed:
    return steady._pressed


def _pressed_of(steady: Any) -> Pressed:
    return steady._once("pressed", lambda: _pressed_program(steady._known))


def _half_of(material: Any) -> Half:
    if isinstance(material, AnyModulus):
        return type(material)
    return "homogeneous" if isinstance(material, Elastic) else None


@program(static=1, level=1)
def _stress_program(fixed: tuple[Half, bool], pressed: Pressed, places: tuple[Array, Array]) -> Stress:
    kind, worn = fixed
    x, z = (jnp.asarray(at, pressed.force.dtype) for at in places)

    def one(pressed: Pressed, x: Array, z: Array) -> Stress:
        return field(pressed, body_of(pressed, kind), worn, x / pressed.radius, z / pressed.radius)

    if pressed.shape == () and x.size and z.size:
        return one(pressed, x, z)
    return each_state(one, pressed, (x, z))


@program(static=1, level=1)
def _searched(kind: Half, pressed: Pressed, wanted: Wanted) -> tuple[Peak, Peak]:
    """The peaks, in SI units and with their places in units of a_0, without derivatives."""

    def one(pressed: Pressed, *wanted: Array) -> tuple[Peak, Peak]:
        found = highest(pressed, kind, Wanted(*wanted))
        return in_si(pressed, kind, Wanted(*wanted), found), found

    return each_state(one, pressed, wanted)


@program(static=1, level=1)
def _at_known_place(kind: Half, pressed: Pressed, known: tuple[Wanted, Array, Array]) -> Peak:
    def one(pressed: Pressed, mises: Array, least: Array, most: Array, *place: Array) -> Peak:
        return peak_at(pressed, kind, Wanted(mises, least, most), *place)

    wanted, *place = known
    return each_state(one, pressed, (*wanted, *place))


def peak_stress_of(steady: Any, name: str, least: ArrayLike = 0.0, most: ArrayLike = np.inf) -> Peak:
    """The largest value of a property of `Stress` before any wear, between two depths in m."""
    kind, wanted = _half_of(steady.contact.material), Wanted(*as_numbers((float(name == "mises"), least, most)))
    if not traced((steady.contact, steady.load, wanted)):
        return _searched(kind, _pressed_of(steady), wanted)[0]
    still, few = jax.lax.stop_gradient, _follows(steady, wanted)
    pressed = _pressed_program(steady._solved(still(steady._given()))) if few else _pressed_of(steady)
    _, place = _searched(kind, still(pressed), still(wanted))
    read, more = functools.partial(_at_known_place, kind), (wanted, place.x, place.z)
    return _with_slopes(read, steady, more) if few else read(pressed, more)
