"""A program run by NumPy, operation by operation: XLA needs seconds to compile what NumPy computes in milliseconds.

A traced program becomes a list of steps, each a function of NumPy with the places of its arguments. What is
computed twice is computed once, and what nothing depends on is left out. Programs with loops, branches or anything else
that is not among the operations below are refused, and XLA compiles them.
"""

import functools
import math
import operator
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import jax
import numpy as np

if TYPE_CHECKING:  # it imports Pallas, which takes as long as all of the closed forms
    from jax.extend.core import ClosedJaxpr, Jaxpr


class _UnknownError(Exception):
    """The program has an operation that is left to XLA."""


# So many numbers take NumPy some 50 ms; with more, XLA is faster by what it takes to compile.
_NUMBERS = 10_000_000
# So many steps, of all calls together, take NumPy about as long as XLA to compile a program.
_PATIENCE = 1_000_000
_AT_ONCE = 100  # numbers that take as long as a step


class Steps:
    """What computes the results of a program from its arguments; it can be pickled.

    Attributes:
        worthwhile: Whether XLA would not by now have taken less time.
    """

    def __init__(
        self, dtypes: list[Any], values: list[Any], steps: list[Any], results: list[int], tree: Any, size: int
    ):
        self._dtypes, self._values, self._steps, self._results, self._tree = dtypes, values, steps, results, tree
        self._left, self._taken = _PATIENCE, len(steps) + size // _AT_ONCE

    @property
    def worthwhile(self) -> bool:
        return self._left > 0

    def __call__(self, *numbers: Any) -> Any:
        """The result, as arrays of JAX."""
        self._left -= self._taken
        given = (np.asarray(x, dtype) for x, dtype in zip(jax.tree.leaves(numbers), self._dtypes, strict=True))
        values = [*given, *self._values]
        with np.errstate(all="ignore"):
            for function, places in self._steps:
                values.append(function(*[values[place] for place in places]))
        return jax.device_put(jax.tree.unflatten(self._tree, [np.asarray(values[place]) for place in self._results]))


def stepwise(traced: Any, most: int = _NUMBERS) -> Steps | None:
    """The steps of what `jax.jit` has traced; None if XLA should compile it, as for `most` numbers and more."""
    program: ClosedJaxpr = traced.jaxpr
    made = _Maker(len(program.jaxpr.invars))
    try:
        results = made.inlined(program, list(range(made.arguments)))
    except _UnknownError:
        return None
    if made.size >= most:
        return None
    dtypes = [aval.dtype for aval in program.in_avals]
    return made.finished(results, dtypes, jax.tree.structure(traced.out_info))


class _Maker:
    """Places below 0 are constants until all of these are known."""

    def __init__(self, arguments: int):
        self.arguments = arguments
        self.constants: list[Any] = []
        self.steps: list[tuple[Callable[..., Any], tuple[int, ...]]] = []
        self.size = 0  # how many numbers all steps make
        self.known: dict[Any, int] = {}  # the places of what has been computed already

    def constant(self, value: Any) -> int:
        value = np.asarray(value)
        key = value.dtype, value.shape, value.tobytes()
        if key not in self.known:
            self.constants.append(value[()])
            self.known[key] = -len(self.constants)
        return self.known[key]

    def inlined(self, program: "ClosedJaxpr", arguments: list[int]) -> list[int]:
        inner: Jaxpr = program.jaxpr
        if inner.effects:
            raise _UnknownError("effects")
        where: dict[Any, int] = dict(zip(inner.invars, arguments, strict=True))
        where |= {of: self.constant(value) for of, value in zip(inner.constvars, program.consts, strict=True)}

        def place(of: Any) -> int:
            aval: Any = of.aval
            return self.constant(np.asarray(of.val, aval.dtype)) if hasattr(of, "val") else where[of]  # a literal

        for equation in inner.eqns:
            name, params = equation.primitive.name, equation.params
            places = [place(of) for of in equation.invars]
            if name in _CALLS:
                found = self.inlined(params[_CALLS[name]], places)
            elif name in _SAME:
                found = places
            else:
                given, made = ([of.aval for of in side] for side in (equation.invars, equation.outvars))
                found = [
                    self.step((name, number), _operation(name, params, given, out, number), params, places, out)
                    for number, out in enumerate(made)
                ]
            where |= dict(zip(equation.outvars, found, strict=True))
        return [place(of) for of in inner.outvars]

    def step(self, name: Any, function: Any, params: Mapping[str, Any], places: list[int], out: Any) -> int:
        key = name, str(params) if params else "", out.dtype, out.shape, *places
        if key not in self.known:
            self.known[key] = self.arguments + len(self.steps)
            self.steps.append((function, tuple(places)))
            self.size += math.prod(out.shape)
        return self.known[key]

    def finished(self, results: list[int], dtypes: list[Any], tree: Any) -> Steps:
        first = self.arguments
        needed = set(results)
        for at in range(len(self.steps) - 1, -1, -1):
            if first + at in needed:
                needed.update(self.steps[at][1])
        kept = [at for at in range(len(self.steps)) if first + at in needed]
        new = {place: place for place in range(first)}
        new |= {-1 - at: first + at for at in range(len(self.constants))}
        new |= {first + at: first + len(self.constants) + i for i, at in enumerate(kept)}
        steps = [(self.steps[at][0], tuple(new[place] for place in self.steps[at][1])) for at in kept]
        return Steps(dtypes, self.constants, steps, [new[place] for place in results], tree, self.size)


# --- the operations of JAX ------------------------------------------------------------------------------------------

_CALLS = {"jit": "jaxpr", "pjit": "jaxpr", "closed_call": "call_jaxpr", "custom_jvp_call": "call_jaxpr"}
_SAME = {"device_put", "stop_gradient", "copy", "copy_p", "optimization_barrier"}


def _to_integer(x: Any, dtype: np.dtype) -> Any:
    """As XLA does: the nearest integer that there is, and 0 for NaN."""
    ends = np.iinfo(dtype)
    found = np.where(np.isnan(x), 0.0, np.maximum(x, x.dtype.type(ends.min))).astype(dtype)
    return np.where(x >= x.dtype.type(ends.max), dtype.type(ends.max), found)


def _convert(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    integer = np.issubdtype(out.dtype, np.integer) and np.issubdtype(given[0].dtype, np.floating)
    dtype = np.dtype(out.dtype)
    return functools.partial(_to_integer, dtype=dtype) if integer else operator.methodcaller("astype", dtype)


def _viewed(x: Any, dtype: np.dtype) -> Any:
    return np.ascontiguousarray(x).reshape(x.shape).view(dtype) if x.ndim else x.view(dtype)


def _view(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    if given[0].dtype.itemsize != out.dtype.itemsize:
        raise _UnknownError
    return functools.partial(_viewed, dtype=np.dtype(out.dtype))


def _selected(which: Any, false: Any, true: Any) -> Any:
    return np.where(which, true, false)


def _select(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    if given[0].dtype != bool or len(given) != 3:
        raise _UnknownError
    return _selected


def _broadcast_to(x: Any, shape: tuple[int, ...], between: tuple[int, ...]) -> Any:
    return np.broadcast_to(np.reshape(x, between), shape)


def _broadcast(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    between = [1] * len(out.shape)
    for size, axis in zip(given[0].shape, params["broadcast_dimensions"], strict=True):
        between[axis] = size
    return functools.partial(_broadcast_to, shape=out.shape, between=tuple(between))


def _shaped(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    return operator.methodcaller("reshape", out.shape)


def _slice(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    steps = params["strides"] or (None,) * len(out.shape)
    return operator.itemgetter(tuple(map(slice, params["start_indices"], params["limit_indices"], steps)))


def _split(params: Mapping[str, Any], number: int) -> Any:
    sizes = params["sizes"]
    first = sum(sizes[:number])
    return operator.itemgetter((slice(None),) * params["axis"] + (slice(first, first + sizes[number]),))


def _joined(function: Callable[..., Any], axis: int, *parts: Any) -> Any:
    return function(parts, axis)


def _complex(real: Any, imaginary: Any) -> Any:
    made = np.empty(np.shape(real), np.result_type(real.dtype, np.complex64))
    made.real, made.imag = real, imaginary
    return made


def _counted(shape: tuple[int, ...], axis: int, dtype: np.dtype) -> Any:
    return np.broadcast_to(np.arange(shape[axis], dtype=dtype).reshape([-1] + [1] * (len(shape) - axis - 1)), shape)


def _dot(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    (summed, summed_too), (beside, beside_too) = params["dimension_numbers"]
    one, letters = list("abcdefgh"[: len(given[0].shape)]), iter("ijklmnop")
    other = [next(letters) for _ in given[1].shape]
    for mine, theirs in zip((*summed, *beside), (*summed_too, *beside_too), strict=True):
        other[theirs] = one[mine]
    batch = [one[axis] for axis in beside]
    free = [x for axis, x in enumerate(one) if axis not in (*summed, *beside)]
    free += [x for axis, x in enumerate(other) if axis not in (*summed_too, *beside_too)]
    return functools.partial(np.einsum, f"{''.join(one)},{''.join(other)}->{''.join(batch + free)}")


def _rounded(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    if int(params["rounding_method"]) != 1:  # to the even one of two that are as near
        raise _UnknownError
    return np.rint


def _reduced(ufunc: np.ufunc) -> Any:
    def made(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
        if 0 in given[0].shape:
            raise _UnknownError
        return functools.partial(ufunc.reduce, axis=tuple(params["axes"]))

    return made


def _power(exponent: int, x: Any) -> Any:
    return np.power(x, x.dtype.type(exponent))


# operations that NumPy has by the same name, and by another one
_ALIKE = ("abs", "ceil", "exp", "expm1", "floor", "imag", "log", "log1p", "real", "sign", "sqrt", "square")
_PLAIN = {name: getattr(np, name) for name in _ALIKE} | {
    "add": np.add,
    "add_any": np.add,
    "and": np.bitwise_and,
    "complex": _complex,
    "div": np.divide,
    "eq": np.equal,
    "ge": np.greater_equal,
    "gt": np.greater,
    "is_finite": np.isfinite,
    "le": np.less_equal,
    "lt": np.less,
    "max": np.maximum,
    "min": np.minimum,
    "mul": np.multiply,
    "ne": np.not_equal,
    "neg": np.negative,
    "not": np.invert,
    "or": np.bitwise_or,
    "pow": np.power,
    "shift_left": np.left_shift,
    "shift_right_arithmetic": np.right_shift,
    "sub": np.subtract,
    "xor": np.bitwise_xor,
}
_OF_FLOATS = {"div", "pow", "integer_pow"}  # integers have other rules
_MADE: dict[str, Callable[[Mapping[str, Any], list[Any], Any], Callable[..., Any]]] = {
    "bitcast_convert_type": _view,
    "broadcast_in_dim": _broadcast,
    "concatenate": lambda params, given, out: functools.partial(_joined, np.concatenate, params["dimension"]),
    "convert_element_type": _convert,
    "dot_general": _dot,
    "integer_pow": lambda params, given, out: functools.partial(_power, params["y"]),
    "iota": lambda params, given, out: functools.partial(_counted, out.shape, params["dimension"], np.dtype(out.dtype)),
    "reduce_max": _reduced(np.maximum),
    "reduce_min": _reduced(np.minimum),
    "reduce_sum": _reduced(np.add),
    "reshape": _shaped,
    "round": _rounded,
    "select_n": _select,
    "slice": _slice,
    "squeeze": _shaped,
    "stack": lambda params, given, out: functools.partial(_joined, np.stack, params["axis"]),
    "transpose": lambda params, given, out: functools.partial(np.transpose, axes=params["permutation"]),
}


def _operation(name: str, params: Mapping[str, Any], given: list[Any], out: Any, number: int) -> Callable[..., Any]:
    """What makes one of the results of an operation."""
    if name == "split":
        return _split(params, number)
    if name == "unstack":
        return operator.itemgetter((slice(None),) * params["axis"] + (number,))
    if name in _OF_FLOATS and not np.issubdtype(out.dtype, np.inexact):
        raise _UnknownError(name)
    if name in _PLAIN:
        return _PLAIN[name]
    if name in _MADE:
        return _MADE[name](params, given, out)
    raise _UnknownError(name)
