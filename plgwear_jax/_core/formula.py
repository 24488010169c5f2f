"""How kernels become public functions and methods, and how these are differentiated.

The functions inside receive arrays of one floating dtype and check nothing.
"""

import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.custom_derivatives import SymbolicZero

from .domains import Domain, as_argument, as_array, check_all, check_digits, nan_unless, real_dtype
from .startup.programs import Program, follows, moved_along, with_slopes
from .xla import materialised, one_kernel, separate_kernels

Signature = ParamSpec("Signature")
Kernel = Callable[..., Array]  # takes arrays of one floating dtype, and perhaps digits, and checks nothing


def formula(
    *,
    slopes: Mapping[str, Kernel] = {},
    pairs: Mapping[str, Callable[..., tuple[Array, Array]]] = {},
    joint: tuple[str, ...] = (),
    **domains: Domain,
) -> Callable[[Callable[Signature, Array]], Callable[Signature, Array]]:
    """Make a public function from a kernel: promotion, domain checks, compilation, NaN where a traced value is outside.

    `domains` names the array arguments of the kernel in their order; its only other argument is the keyword `digits`.
    `slopes` holds closed forms of the derivatives with respect to an argument, with the kernel's signature, where they
    are better than automatic differentiation. `pairs` returns the value and such a derivative, which one kernel then
    computes together. For the arguments in `joint`, automatic differentiation makes such a pair.
    """
    names = tuple(domains)

    def decorate(kernel: Callable[Signature, Array]) -> Callable[Signature, Array]:
        plain: Kernel = kernel

        def run(digits: int | None, *values: Array) -> Array:
            dtype = jnp.promote_types(real_dtype(kernel.__name__, values), jnp.float32)
            values = tuple(jnp.asarray(value, dtype) for value in values)

            def given(functions: Mapping[str, Callable[..., Any]]) -> dict[int, Any]:
                found = functions.items()
                return {names.index(name): functools.partial(function, digits=digits) for name, function in found}

            function, together = functools.partial(plain, digits=digits), given(pairs)
            alone = {i: lambda *at, pair=pair: pair(*at)[1] for i, pair in together.items()} | given(slopes)
            together |= {i: functools.partial(_value_and_slope, function, i) for i in map(names.index, joint)}
            result = _by_forward_mode(function, alone, together)(*values)
            inside = (domain.contains(value) for domain, value in zip(domains.values(), values, strict=True))
            return nan_unless(functools.reduce(jnp.logical_and, inside), result)

        program, signature = _program(run, kernel), inspect.signature(kernel)

        @functools.wraps(kernel)
        def public(*args: Signature.args, **kwargs: Signature.kwargs) -> Array:
            bound = signature.bind(*args, **kwargs)
            bound.apply_defaults()
            values = tuple(as_array(bound.arguments[name]) for name in names)
            check_all(names, values, tuple(domains.values()))
            dtype = real_dtype(kernel.__name__, values)
            digits = check_digits(bound.arguments["digits"], dtype)
            # Half precision is computed in single and handed back as it came.
            working = jnp.promote_types(dtype, jnp.float32)
            result = program(digits, *(as_argument(value, working) for value in values))
            return result if result.dtype == dtype else result.astype(dtype)

        return public

    return decorate


def compiled(method: Callable[Signature, Array]) -> Callable[Signature, Array]:
    """Make a public method of a record: the record checks concrete values, then one program does the rest.

    `_check` of the record receives the arguments by name, except `digits`.
    """

    def run(digits: int | None, itself: Any, numbers: dict[str, Any]) -> Array:
        return call(itself, **numbers) if digits is None else call(itself, **numbers, digits=digits)

    call: Kernel = method
    program, signature = _program(run, method), inspect.signature(method)

    @functools.wraps(method)
    def public(*args: Signature.args, **kwargs: Signature.kwargs) -> Array:
        given = signature.bind(*args, **kwargs).arguments
        itself, digits = given.pop("self"), given.pop("digits", None)
        bound = {name: as_array(x) for name, x in given.items()}
        itself._check(**bound)
        if digits is not None:
            # For JAX, True is the same static argument as 1.
            digits = check_digits(digits, real_dtype(method.__name__, tuple(jax.tree.leaves((itself, bound)))))
        return program(digits, itself, bound)

    return public


def _program(run: Kernel, named: Callable[..., Any]) -> Kernel:
    """The function as a program with the name of another one, which follows derivatives at known numbers.

    Its first argument is static, the others are trees of numbers.
    """
    run.__module__, run.__name__, run.__qualname__ = named.__module__, named.__name__, named.__qualname__
    program = Program(run, static=1)
    sloped = with_slopes(program)

    def call(static: Any, *given: Any) -> Array:
        if not follows(given):
            # By XLA from the first value on: at an edge such as c a rounding of the radius is a step of the depth.
            return program.part(static, *given)
        dtype = real_dtype(run.__name__, tuple(jax.tree.leaves(given)))
        # The type of a gradient by a Python number stays weak.
        strong = jax.tree.map(
            lambda x: jnp.asarray(x, x.dtype) if isinstance(x, Array) else np.asarray(x, dtype), given
        )
        return sloped(static, *strong)

    return call


# --- derivatives of programs ------------------------------------------------------------------------------------------


def _by_forward_mode(function: Kernel, slopes: Mapping[int, Any], pairs: Mapping[int, Any] = {}) -> Kernel:
    """The elementwise function of a few arrays, with the rule that its derivatives are taken in forward mode.

    Reverse mode then multiplies by finished partial derivatives, instead of going back through every term of a series;
    the same for each higher derivative. Only the partial derivatives that are needed are computed; those in `slopes`
    (by position of the argument) are taken from there. The first of `pairs`, a value and its slope together, that is
    needed gives the value as well.
    """

    @jax.custom_jvp
    def ruled(*values: Array) -> Array:
        return function(*values)

    def derivative(i: int) -> Kernel:
        # A mixed derivative differentiates a closed form, the last one available, whichever argument comes first.
        better = {j: _partial(slope, i) for j, slope in slopes.items() if i not in slopes or j > i}
        return _by_forward_mode(slopes.get(i) or _partial(function, i), better)

    def together(i: int) -> Callable[..., tuple[Array, Array]]:
        """The pair of value and slope, whose derivatives are those of both alone."""

        @jax.custom_jvp
        def ruled_pair(*values: Array) -> tuple[Array, Array]:
            value, slope = pairs[i](*values)
            return one_kernel(value, slope)

        def rule(primals, tangents):
            moved = moved_along(lambda *values: (ruled(*values), derivative(i)(*values)), primals, tangents)[1]
            return ruled_pair(*primals), moved

        ruled_pair.defjvp(rule, symbolic_zeros=True)
        return ruled_pair

    def rule(primals, tangents):
        values = tuple(map(jnp.asarray, primals))
        wanted = {i: tangent for i, tangent in enumerate(tangents) if not isinstance(tangent, SymbolicZero)}
        first = next((i for i in pairs if i in wanted), None)
        if first is None:
            result, found = ruled(*values), {}
        else:
            result, slope = together(first)(*values)
            found = {first: slope}
        for i in wanted:
            if i not in found:
                found[i] = derivative(i)(*values)
                if len(wanted) > 1:  # a Jacobian uses it once for every direction
                    found[i] = materialised(found[i])
        total = jnp.zeros_like(result)
        for i, tangent in wanted.items():
            total = total + found[i] * tangent
        return result, total

    ruled.defjvp(rule, symbolic_zeros=True)
    return ruled


def _value_and_slope(function: Kernel, i: int, *values: Array) -> tuple[Array, Array]:
    """The value of a function and its derivative with respect to one argument."""
    own = values[i]
    return jax.jvp(lambda value: function(*values[:i], value, *values[i + 1 :]), (own,), (jnp.ones_like(own),))


def _partial(function: Kernel, i: int) -> Kernel:
    return lambda *values: _value_and_slope(function, i, *separate_kernels(10 + i, *values))[1]
