"""Arithmetic that is traced in a third of the time: operators that call `jax.lax` directly.

An operator of a traced array calls a compiled function of `jax.numpy`, which promotes and broadcasts: a third of a
millisecond, a thousand times in a function of this library. Inside the library all arrays have one floating dtype and
mostly one shape, so no promotion is needed. A function marked `lean` is written as usual and computes the same.
"""

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import jax
import jax.numpy as jnp
from jax import Array, lax

from plgwear_jax._startup import on

__all__ = ["Lean", "array_of", "lean", "maximum", "sqrt", "where"]

Signature = ParamSpec("Signature")
Result = TypeVar("Result")


def _operator(plain: Callable[..., Array], general: Callable[..., Array], turned: bool = False) -> Any:
    def apply(one: "Lean", other: Any) -> "Lean":
        array, second = one.array, array_of(other)
        if isinstance(second, float | int):
            second, alike = array.dtype.type(second), True
        else:
            alike = array.shape == second.shape
        return Lean((plain if alike else general)(*((second, array) if turned else (array, second))))

    return apply


def _comparison(plain: Callable[..., Array], general: Callable[..., Array]) -> Any:
    operator = _operator(plain, general)
    return lambda one, other: operator(one, other).array


class Lean:
    """An array with operators that do not promote; comparisons give an ordinary array of truth values."""

    __slots__ = ("array",)

    def __init__(self, array: Array) -> None:
        self.array = array

    dtype = property(lambda self: self.array.dtype)
    shape = property(lambda self: self.array.shape)

    __add__, __radd__ = _operator(lax.add, jnp.add), _operator(lax.add, jnp.add, True)
    __sub__, __rsub__ = _operator(lax.sub, jnp.subtract), _operator(lax.sub, jnp.subtract, True)
    __mul__, __rmul__ = _operator(lax.mul, jnp.multiply), _operator(lax.mul, jnp.multiply, True)
    __truediv__, __rtruediv__ = _operator(lax.div, jnp.divide), _operator(lax.div, jnp.divide, True)
    __lt__, __le__ = _comparison(lax.lt, jnp.less), _comparison(lax.le, jnp.less_equal)
    __gt__, __ge__ = _comparison(lax.gt, jnp.greater), _comparison(lax.ge, jnp.greater_equal)

    def __neg__(self) -> "Lean":
        return Lean(lax.neg(self.array))

    def __abs__(self) -> "Lean":
        return Lean(lax.abs(self.array))


jax.tree_util.register_pytree_node(Lean, lambda lean: ((lean.array,), None), lambda _, children: Lean(*children))


def array_of(value: Any) -> Any:
    """The array inside a lean array; anything else unchanged."""
    return value.array if isinstance(value, Lean) else value


def sqrt(value: Any) -> Any:
    """`jnp.sqrt` of a lean array."""
    return Lean(lax.sqrt(value.array)) if isinstance(value, Lean) else jnp.sqrt(value)


def maximum(value: Any, least: float) -> Any:
    """`jnp.maximum` of a lean array and a number."""
    plain = jnp.maximum(value, least) if not isinstance(value, Lean) else None
    return Lean(lax.max(value.array, value.dtype.type(least))) if plain is None else plain


def where(condition: Array, one: Any, other: Any) -> Any:
    """`jnp.where` of arrays and numbers, lean or not."""
    pair = array_of(one), array_of(other)
    if not isinstance(one, Lean) and not isinstance(other, Lean):
        return jnp.where(condition, *pair)
    shapes = {condition.shape} | {x.shape for x in pair if not isinstance(x, float | int)}
    if len(shapes) > 1:
        return Lean(jnp.where(condition, *pair))
    like = next(x for x in pair if not isinstance(x, float | int))
    pair = [lax.full_like(like, x) if isinstance(x, float | int) else x for x in pair]
    return Lean(lax.select(condition, *pair))


def lean(function: Callable[Signature, Result]) -> Callable[Signature, Result]:
    """The function of arrays, traced with lean ones. Another lean function calls it with lean arrays."""

    @functools.wraps(function)
    def traced(*args: Signature.args, **kwargs: Signature.kwargs) -> Result:
        leaves = jax.tree.leaves(args, is_leaf=_is_lean)
        if any(map(_is_lean, leaves)):
            return function(*args, **kwargs)
        result: Any = function(*(jax.tree.map(_lean, args) if on("lean") else args), **kwargs)
        return jax.tree.map(array_of, result, is_leaf=_is_lean)

    return traced


def _is_lean(value: Any) -> bool:
    return isinstance(value, Lean)


def _lean(value: Any) -> Any:
    return Lean(value) if isinstance(value, Array) and jnp.issubdtype(value.dtype, jnp.floating) else value
