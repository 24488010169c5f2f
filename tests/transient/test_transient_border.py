"""What every function of wear over cycles makes of bad input, of edges, of other dtypes and of derivatives.

They share one march, so that its program for a batch of points, and that of its derivatives, is compiled once for all.
"""

import functools
import inspect
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from plgwear_jax import transient

NAMES = [name for name in transient.__all__ if name not in ("Blocks", "blocks")]
GOOD = {"r": 0.9, "k": 0.3, "phi": 0.4, "n": 1.5, "share": 0.3, "compliance": 0.5}
RANGE = {
    "r": "r >= 0",
    "k": "-1 < k < 1",
    "phi": "0 <= phi < 1",
    "n": "n >= 0 and finite",
    "share": "0 <= share < 1",
    "compliance": "compliance >= 0 and finite",
}
BAD = {
    "r": [-0.5, math.nan],
    "k": [-1.0, 1.0, math.nan],
    "phi": [1.0, -0.5, math.nan],
    "n": [-1.0, math.inf, math.nan],
    "share": [1.0, -0.5, math.nan],
    "compliance": [-0.5, math.inf, math.nan],
}
COUNT = 18  # points of every batch
ARGUMENTS = {
    name: tuple(key for key in GOOD if key in inspect.signature(getattr(transient, name)).parameters) for name in NAMES
}
PLACES = {name: tuple(key for key in keys if key != "compliance") for name, keys in ARGUMENTS.items()}


def call(name, at, **more):
    return getattr(transient, name)(*(at[key] for key in PLACES[name]), **more)


@pytest.mark.parametrize("name, key", [(name, key) for name in NAMES for key in ARGUMENTS[name]])
def test_a_value_outside_is_refused_by_name_value_and_range(name, key):
    for value in BAD[key]:
        for given in (value, np.asarray([value, GOOD[key]]), jnp.asarray([value])):
            with pytest.raises(ValueError) as caught:  # noqa: PT011 (the message is looked at below)
                call(name, {**GOOD, key: given}, **({"compliance": given} if key == "compliance" else {}))
            message = str(caught.value)
            assert message.startswith(f"{key} = {value}") and RANGE[key] in message


@pytest.mark.parametrize("name", NAMES)
def test_words_and_wrong_digits_are_refused(name):
    for key in PLACES[name]:
        for wrong in ("abc", None, 1j):
            with pytest.raises((TypeError, ValueError)):
                call(name, {**GOOD, key: wrong})
    for wrong in (0, 6, 2.5, True, "a"):
        with pytest.raises((TypeError, ValueError), match="digits"):
            call(name, GOOD, digits=wrong)
    with pytest.raises(ValueError, match="is neither 'force' nor 'displacement'"):
        call(name, GOOD, control="speed")


def batch(name):
    """Points inside, at all edges that belong to the range, and outside of it."""
    rows = [GOOD, {**GOOD, "n": 0.0, "share": 0.0}, {**GOOD, "phi": 0.0}, {**GOOD, "n": 1e300, "share": 1.0 - 1e-12}]
    rows += [{**GOOD, "r": r, "k": k, "phi": 0.6} for r, k in ((0.0, 0.0), (0.6, -0.6))]
    inside = len(rows)
    rows += [{**GOOD, key: value} for key in PLACES[name] for value in BAD[key]]
    assert len(rows) <= COUNT
    rows += [GOOD] * (COUNT - len(rows))
    return {key: np.array([row[key] for row in rows], float) for key in GOOD}, inside


@functools.cache
def evaluated(name):
    """(Values, gradients) of a batch. The program of the march is that of all other functions."""
    at, _ = batch(name)
    places = tuple(range(len(PLACES[name])))
    both = jax.vmap(jax.value_and_grad(functools.partial(getattr(transient, name), digits=2), places))
    value, slopes = both(*(jnp.asarray(at[key]) for key in PLACES[name]))
    return np.asarray(value), np.stack(slopes, -1)


# The derivatives of the march are in the programs of all of them.
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(x, marks=pytest.mark.compiled if x in ("wear_volume", "pressure") else pytest.mark.long)
        for x in NAMES
    ],
)
def test_traced_values_outside_give_nan_and_gradients_are_finite_inside(name):
    _, inside = batch(name)
    outside = slice(inside, inside + sum(len(BAD[key]) for key in PLACES[name]))
    value, slopes = evaluated(name)
    assert np.all(np.isnan(value[outside])) and np.all(np.isnan(slopes[outside]))
    finite = np.isfinite(value[:inside])
    # Nothing wears at phi = 0, so that no number of cycles wears a share of it.
    assert np.all(finite | ((name == "cycles") & (np.arange(inside) == 2)))
    assert np.all(np.isfinite(slopes[:inside][finite]))


@pytest.mark.compiled
@pytest.mark.parametrize("name", NAMES)
def test_empty_arrays_stay_empty_and_dtypes_are_kept(name):
    empty = call(name, {**GOOD, PLACES[name][-1]: np.zeros((0, 3))}, digits=2)
    assert empty.shape == (0, 3) and empty.dtype == jnp.float64
    for dtype in (jnp.float32, jnp.float64):
        at = {key: jax.ShapeDtypeStruct((2,), dtype) for key in GOOD}
        assert jax.eval_shape(lambda at: call(name, at, digits=2), at).dtype == dtype
    assert jax.eval_shape(lambda at: call(name, at, digits=2), dict.fromkeys(GOOD, 0)).dtype == jnp.float64
