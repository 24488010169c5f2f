"""`digits=n` gives n digits of every value over the whole bulk domain, and as many of its first derivatives."""

import functools

import accuracy
import functions
import jax
import numpy as np
import pytest
from marks import compiled, long, parametrize

# What the full results themselves are promised to.
FULL = {"float64": (2e-14, 1e-13), "float32": (5e-6, 1e-5)}
MOST = {"float64": 15, "float32": 6}
BULK = [quantity for quantity in accuracy.QUANTITIES if "bulk" in quantity.regions]
BY_SERIES = ("wear_volume", "worn_radius", "deepest_wear", "fretting.initial_displacement", "steady_displacement")


def sample(quantity, dtype, count):
    rng = np.random.default_rng([7, *quantity.name.encode()])
    points = accuracy._representable(quantity, quantity.sampler(rng, 2 * count, "bulk"), dtype)
    return tuple(x[:count] for x in points)


@functools.cache
def values(quantity, dtype, digits):
    points = sample(quantity, dtype, 1500)
    if digits is None:
        return functions.values(quantity.name, *points).astype(float)
    program = functions.by_numpy(functools.partial(quantity.function, digits=digits))
    return functions.in_rounds(program, *points).astype(float)


@functools.cache
def slopes(quantity, dtype, digits):
    points = sample(quantity, dtype, 500)
    if digits is None:
        return functions.derivatives(quantity.name, *points)[2].astype(float)
    gradient = jax.grad(functools.partial(quantity.function, digits=digits), tuple(range(len(points))))
    return np.stack(functions.by_numpy(jax.vmap(gradient))(*points), -1).astype(float)


def in_series(quantity):
    return any(quantity.name.endswith(name) for name in BY_SERIES)


def when(quantity, dtype, digits):
    """Each number of digits is a program of its own.

    The default run has the lowest of float64, every third where a series of the quantity's own is cut short, and the
    highest of float32 for one of each kind; with what is compiled come the highest and the lowest of all.
    """
    by_its_series = in_series(quantity) and digits % 3 == 0
    if dtype == "float64" and (digits == 3 or by_its_series):
        return ()
    if digits == MOST[dtype] == 6 and quantity.name in functions.COMPILED:
        return ()
    return compiled if digits in (3, MOST[dtype]) or by_its_series else long


def each(marks):
    """All numbers of digits of all quantities, with these marks."""
    rows = [
        pytest.param(quantity, dtype, n, id=f"{quantity.name}-{dtype}-{n}", marks=marks(quantity, dtype, n))
        for quantity in BULK
        for dtype, most in MOST.items()
        for n in range(3, most + 1)
    ]
    return parametrize("quantity,dtype,digits", rows)


def when_slopes(quantity, dtype, digits):
    if (quantity.name, dtype) != ("fretting.wear_volume", "float64"):
        return long
    return {4: (), 13: (), 7: compiled, 10: compiled}.get(digits, long)


@each(when)
def test_values_have_the_digits_asked_for(quantity, dtype, digits):
    full = values(quantity, dtype, None)
    error = np.abs(values(quantity, dtype, digits) - full) / np.abs(full)
    assert np.max(error) <= 10.0**-digits + 2.0 * FULL[dtype][0]


@each(when_slopes)
def test_slopes_have_the_digits_asked_for(quantity, dtype, digits):
    full = slopes(quantity, dtype, None)
    # Relative to the value where that is larger, as everywhere.
    value = functions.values(quantity.name, *sample(quantity, dtype, 500)).astype(float)
    scale = np.maximum(np.abs(full), np.abs(value)[:, None])
    error = np.abs(slopes(quantity, dtype, digits) - full) / scale
    assert np.max(error) <= 10.0**-digits + 2.0 * FULL[dtype][1]


@parametrize("quantity", [q for q in BULK if in_series(q)], ids=lambda quantity: quantity.name)
def test_fewer_digits_are_really_fewer(quantity):
    full = values(quantity, "float64", None)
    errors = [np.max(np.abs(values(quantity, "float64", n) - full) / np.abs(full)) for n in (3, 6, 9, 12)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] > 0.0
