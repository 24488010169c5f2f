"""The public dimensionless functions for the tests that hold of every one of them, always by the same programs.

Each shape of the arguments is traced and compiled anew, which takes a thousand times as long as the arithmetic. So
`fretting`, `gross_slip`, `partial_slip` and `material` of this module are those of the library, called with LENGTH
numbers whatever the shape of the arrays, and `derivatives` and `hessians` are one program for all tests of a function.

In the default run XLA compiles the values of COMPILED, and the derivatives of DIFFERENTIATED in float64, which take
longest; for all others NumPy runs the traced program. In the long run, where `XLA_FLAGS` is empty, everything is
compiled as users have it.
"""

import functools
import inspect
import os
import types

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from marks import compiled, long, parametrize

import plgwear_jax
from plgwear_jax._core.startup.operations import UnknownError
from plgwear_jax._core.startup.stepwise import stepwise

# The options of XLA that `conftest` changes, as users have them.
AS_USERS = {name: 3 if name.endswith("level") else True for name in plgwear_jax.compiler_options()}

# One of each kind: a root and a series, a series with a radius, the uniformly loaded disc, a power, gamma functions.
COMPILED = {
    "fretting.wear_volume",
    "fretting.steady_displacement",
    "gross_slip.steady_displacement",
    "fretting.stick_radius",
    "material.h_N",
}

# Of this XLA compiles the derivatives in float64 too; displacements take longest, and the long run has them.
DIFFERENTIATED = "fretting.wear_volume"

LENGTH = 1536  # no test has more points of a kind than that, but for dense ones, which take several rounds


def in_rounds(function, *at):
    """A compiled function of flat arrays, LENGTH points at a time; the last round is filled up."""
    count = max(len(x) for x in at)
    places = np.resize(np.arange(count), -(-count // LENGTH) * LENGTH).reshape(-1, LENGTH)
    rounds = [function(*(jnp.asarray(x[some]) for x in at)) for some in places]
    return jax.tree.map(lambda *parts: np.concatenate([np.asarray(part) for part in parts])[:count], *rounds)


def by_numpy(function):
    """As `jax.jit`, for arrays; in the default run NumPy computes what is traced, if its loops end soon."""
    jitted = jax.jit(function, compiler_options=AS_USERS)
    if not os.environ.get("XLA_FLAGS"):
        return jitted
    known = {}

    def called(*at):
        leaves, tree = jax.tree.flatten(at)
        kind = tree, tuple((x.shape, x.dtype) for x in leaves)
        if kind not in known:
            known[kind] = stepwise(jitted.trace(*at), patience=10**9) or jitted
        try:
            return known[kind](*at)
        except UnknownError:  # a loop that does not end soon
            known[kind] = jitted
            return jitted(*at)

    return called


def at_one_length(function):
    """The function for concrete arguments of any shape; scalars, which all have the same shape, go in as they are."""
    bind = inspect.signature(function).bind
    compiled = jax.jit(function, static_argnames="digits", compiler_options=AS_USERS)

    @functools.wraps(function)
    def called(*args, **kwargs):
        values = bind(*args, **kwargs).arguments
        digits = values.pop("digits", None)
        if any(isinstance(x, str | jax.core.Tracer) for x in values.values()):
            return function(*args, **kwargs)
        dtype = jnp.result_type(*values.values(), 0.0)
        at = np.broadcast_arrays(*(np.asarray(x, dtype) for x in values.values()))
        if at[0].shape == () or at[0].size == 0:
            return function(*args, **kwargs)
        result = in_rounds(functools.partial(compiled, digits=digits), *(x.ravel() for x in at))
        return result.reshape(at[0].shape)

    return called


def _at_one_length(module):
    names = (name for name in module.__all__ if inspect.isfunction(getattr(module, name)))
    return types.SimpleNamespace(**{name: at_one_length(getattr(module, name)) for name in names})


fretting, gross_slip, partial_slip, material = map(
    _at_one_length, (plgwear_jax.fretting, plgwear_jax.gross_slip, plgwear_jax.partial_slip, plgwear_jax.material)
)

FUNCTIONS = {
    f"{module.__name__.rpartition('.')[2]}.{name}": getattr(module, name)
    for module, names in (
        (plgwear_jax.gross_slip, plgwear_jax.gross_slip.__all__),
        (plgwear_jax.fretting, plgwear_jax.fretting.__all__),
        (plgwear_jax.material, ("h_N", "holl_ratio", "tangential_ratio")),
        (plgwear_jax.partial_slip, plgwear_jax.partial_slip.__all__),
    )
    for name in names
}


# In the default run, what XLA has to compile anew for every function.
of_each_kind = parametrize("name", [pytest.param(name, marks=() if name in COMPILED else long) for name in FUNCTIONS])

# What one rule in `plgwear_jax._core.formula` decides for all of them is asked of one of each kind.
by_one_rule = parametrize(
    "name", [pytest.param(name, marks=() if name in COMPILED else compiled) for name in FUNCTIONS]
)


def arguments(name: str) -> tuple[str, ...]:
    """The array arguments of a function, in their order."""
    return tuple(p for p in inspect.signature(FUNCTIONS[name]).parameters if p != "digits")


def values(name: str, *at):
    """The function at concrete arguments of any shape, by the program for LENGTH of them."""
    return at_one_length(FUNCTIONS[name])(*at) if name in COMPILED else in_rounds(_by_numpy(name), *at)


@functools.cache
def _by_numpy(name):
    return by_numpy(lambda *at: FUNCTIONS[name](*at))


def derivatives(name: str, *at):
    """The values (n,), those that come with a gradient, the gradients (n, arguments) by reverse and by forward mode."""
    return in_rounds(_derivatives(name), *at)


def hessians(name: str, *at):
    """The second derivatives (n, arguments, arguments), of another program, which takes much longer to compile."""
    return in_rounds(_hessians(name), *at)


@functools.cache
def _derivatives(name):
    function = FUNCTIONS[name]

    def point(*at):
        (beside, reverse), (_, along) = with_gradient(function, *at), jax.linearize(function, *at)
        return function(*at), beside, jnp.stack(reverse, -1), jnp.stack(_by_each(along, at), -1)

    compiled, by_steps = jax.jit(point, compiler_options=AS_USERS), by_numpy(point)
    # XLA compiles those of one dtype.
    return lambda *at: (compiled if name == DIFFERENTIATED and at[0].dtype == np.float64 else by_steps)(*at)


@functools.cache
def _hessians(name):
    function = FUNCTIONS[name]

    def point(*at):
        _, along = jax.linearize(lambda *at: jnp.stack(with_gradient(function, *at)[1], -1), *at)
        return jnp.stack(_by_each(along, at), -1)

    return by_numpy(point)


# All arguments are arrays of one shape, which `jax.vmap` of a derivative at numbers takes twice as long to trace.


def with_gradient(function, *at):
    """The values, and their derivatives by each argument in reverse mode."""
    value, back = jax.vjp(function, *at)
    return value, back(jnp.ones_like(value))


def _by_each(along, at):
    """What a linear function of the arguments takes each of them alone to."""
    none = [jnp.zeros_like(x) for x in at]
    return [along(*none[:i], jnp.ones_like(x), *none[i + 1 :]) for i, x in enumerate(at)]
