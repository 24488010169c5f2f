"""The operations of JAX as functions of NumPy."""

import functools
import importlib
import math
import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

__all__ = ["UnknownError", "operation"]


class UnknownError(Exception):
    """The program has an operation that is left to XLA, or a loop that does not end soon."""


# --- numbers and shapes -----------------------------------------------------------------------------------------------


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
        raise UnknownError
    return functools.partial(_viewed, dtype=np.dtype(out.dtype))


def _selected(which: Any, false: Any, true: Any) -> Any:
    return np.where(which, true, false)


def _chosen(which: Any, *cases: Any) -> Any:
    found = cases[0]
    for number, case in enumerate(cases[1:], 1):
        found = np.where(which == number, case, found)
    return found


def _select(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    return _selected if given[0].dtype == bool and len(given) == 3 else _chosen


def _broadcast_to(x: Any, shape: tuple[int, ...], between: tuple[int, ...]) -> Any:
    if math.prod(shape) > 1000:
        return np.broadcast_to(np.reshape(x, between), shape)
    made = np.empty(shape, x.dtype)  # a copy of few numbers takes a fourth of the time
    made[...] = np.reshape(x, between)
    return made


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


def _along(shape: tuple[int, ...], axis: int, dtype: Any = np.int64) -> Any:
    """The numbers of the places along an axis, which broadcast against the shape."""
    return np.arange(shape[axis], dtype=dtype).reshape([-1] + [1] * (len(shape) - axis - 1))


def _counted(shape: tuple[int, ...], axis: int, dtype: np.dtype) -> Any:
    return np.broadcast_to(_along(shape, axis, dtype), shape)


def _dot(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    (summed, summed_too), (beside, beside_too) = params["dimension_numbers"]
    free, free_too = (
        [axis for axis in range(len(x.shape)) if axis not in (*own, *batch)]
        for x, own, batch in zip(given, (summed, summed_too), (beside, beside_too), strict=True)
    )
    order, order_too = (*beside, *free, *summed), (*beside_too, *summed_too, *free_too)
    batch, count = [given[0].shape[axis] for axis in beside], math.prod(given[0].shape[axis] for axis in summed)
    rows, columns = (math.prod(x.shape[i] for i in axes) for x, axes in zip(given, (free, free_too), strict=True))
    shapes = (*batch, rows, count), (*batch, count, columns), out.shape
    return functools.partial(_product, order, order_too, *shapes)


# OpenBLAS begins threads for 262,144 products of two numbers, and on a busy machine these wait for each other.
_PRODUCTS = 250_000


def _product(order: Any, order_too: Any, shape: Any, shape_too: Any, out: Any, x: Any, y: Any) -> Any:
    made = np.empty((*shape[:-1], shape_too[-1]), x.dtype)
    _multiply(x.transpose(order).reshape(shape), y.transpose(order_too).reshape(shape_too), made)
    return made.reshape(out)


def _multiply(x: Any, y: Any, out: Any) -> None:
    (rows, count), columns = x.shape[-2:], y.shape[-1]
    if rows * count * columns <= _PRODUCTS or max(rows, columns) == 1:
        np.matmul(x, y, out=out)
        return
    half = max(rows, columns) // 2
    for part in (slice(half), slice(half, None)):
        if rows < columns:
            _multiply(x, y[..., part], out[..., part])
        else:
            _multiply(x[..., part, :], y, out[..., part, :])


def _start(starts: Sequence[Any], shape: Sequence[int], sizes: Sequence[int]) -> tuple[slice, ...]:
    begin = (min(max(int(at), 0), whole - size) for at, whole, size in zip(starts, shape, sizes, strict=True))
    return tuple(slice(at, at + size) for at, size in zip(begin, sizes, strict=True))


def _sliced(sizes: tuple[int, ...], x: Any, *starts: Any) -> Any:
    return x[_start(starts, x.shape, sizes)]


def _updated(x: Any, update: Any, *starts: Any) -> Any:
    x = x.copy()
    x[_start(starts, x.shape, update.shape)] = update
    return x


def _windows(
    shape: tuple[int, ...], of_windows: tuple[int, ...], sizes: Any, numbers: Any, batched: Any, left: Any
) -> Any:
    """What tells where the windows of an operand lie, for `_places`.

    Args:
        shape: That of the array of all windows.
        of_windows: Which of its axes are within a window, for the axes of the operand that have one there.
        sizes: Of a window, and of the operand, along each axis of the operand.
        numbers: Which axis of the operand each number of an index is for.
        batched: The axes of batches, of the operand and of the indices.
        left: The axes of the operand that windows have not.
    """
    size, whole = sizes
    batch = [axis for axis in range(len(shape)) if axis not in of_windows]
    own = [axis for axis in range(len(whole)) if axis not in (*left, *batched[0])]
    told = []
    for axis in range(len(whole)):
        number = numbers.index(axis) if axis in numbers else None
        of_batch = batch[batched[1][batched[0].index(axis)]] if axis in batched[0] else None
        within = of_windows[own.index(axis)] if axis in own else None
        told.append((number, of_batch, within, whole[axis] - size[axis]))
    return told, of_windows, shape


def _places(windows: Any, at: Any) -> tuple[Any, Any]:
    """(The indices of all windows in the operand, which of them lie inside)."""
    told, of_windows, shape = windows
    at = at.astype(np.int64)
    places, inside = [], np.True_
    for number, of_batch, within, last in told:
        place = 0 if of_batch is None else _along(shape, of_batch)
        if number is not None:
            begin = np.expand_dims(at[..., number], of_windows)
            inside = inside & (begin >= 0) & (begin <= last)
            place = place + np.clip(begin, 0, last)
        places.append(place if within is None else place + _along(shape, within))
    return tuple(places), inside


def _drops(params: Mapping[str, Any]) -> bool:
    return "FILL" in str(params["mode"])


def _gather(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    numbers, sizes, shape = params["dimension_numbers"], params["slice_sizes"], given[0].shape
    batched = numbers.operand_batching_dims, numbers.start_indices_batching_dims
    if len(given[1].shape) == 1 and not _drops(params):
        return functools.partial(_window, tuple(map(int, numbers.start_index_map)), tuple(sizes), out.shape)
    if _drops(params) and not np.issubdtype(out.dtype, np.floating):
        raise UnknownError("gather")
    if len(shape) == 1 and not numbers.offset_dims and not _drops(params):
        return _taken_at
    both = sizes, shape
    found = _windows(
        out.shape, numbers.offset_dims, both, numbers.start_index_map, batched, numbers.collapsed_slice_dims
    )
    return functools.partial(_gathered, found, _drops(params))


def _window(axes: tuple[int, ...], sizes: tuple[int, ...], shape: tuple[int, ...], x: Any, at: Any) -> Any:
    starts = np.zeros(len(sizes), int)
    starts[list(axes)] = at
    return _sliced(sizes, x, *starts).reshape(shape)


def _taken_at(x: Any, at: Any) -> Any:
    return np.take(x, at[..., 0], mode="clip")


def _gathered(windows: Any, drop: bool, x: Any, at: Any) -> Any:
    places, inside = _places(windows, at)
    found = np.broadcast_to(x[places], windows[-1])
    return np.where(inside, found, x.dtype.type(np.nan)) if drop else found


def _scatter(add: bool) -> Any:
    def made(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
        numbers, (operand, _, updates) = params["dimension_numbers"], given
        batched = tuple(numbers.operand_batching_dims), numbers.scatter_indices_batching_dims
        left = (*numbers.inserted_window_dims, *batched[0])
        sizes = iter([updates.shape[axis] for axis in numbers.update_window_dims])
        size = [1 if axis in left else next(sizes) for axis in range(len(operand.shape))]
        both = size, operand.shape
        order = tuple(numbers.scatter_dims_to_operand_dims)
        found = _windows(updates.shape, numbers.update_window_dims, both, order, batched, numbers.inserted_window_dims)
        return functools.partial(_scattered, found, _drops(params), add)

    return made


def _scattered(windows: Any, drop: bool, add: bool, x: Any, at: Any, updates: Any) -> Any:
    places, inside = _places(windows, at)
    places = np.broadcast_arrays(*places, updates)[:-1]
    inside = np.broadcast_to(inside if drop else np.True_, updates.shape)
    x, places = x.copy(), tuple(place[inside] for place in places)
    if add:
        np.add.at(x, places, updates[inside])
    else:
        x[places] = updates[inside]
    return x


def _pad(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    return functools.partial(_padded, params["padding_config"])


def _padded(config: Any, x: Any, value: Any) -> Any:
    wide = [n + max(n - 1, 0) * inner for n, (_, _, inner) in zip(x.shape, config, strict=True)]
    shape = [max(low, 0) + n + max(high, 0) for n, (low, high, _) in zip(wide, config, strict=True)]
    made = np.full(shape, value, x.dtype)
    each = list(zip(wide, shape, config, strict=True))
    made[tuple(slice(max(low, 0), max(low, 0) + n, inner + 1) for n, _, (low, _, inner) in each)] = x
    return made[tuple(slice(max(-low, 0), size - max(-high, 0)) for _, size, (low, high, _) in each)]


def _accumulated(ufunc: np.ufunc) -> Any:
    def made(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
        return functools.partial(_along_axis, ufunc, params["axis"], params["reverse"])

    return made


def _along_axis(ufunc: np.ufunc, axis: int, backwards: bool, x: Any) -> Any:
    turned = np.flip(x, axis) if backwards else x
    found = ufunc.accumulate(turned, axis)
    return np.flip(found, axis) if backwards else found


def _clamped(least: Any, x: Any, most: Any) -> Any:
    return np.minimum(np.maximum(x, least), most)


def _rsqrt(x: Any) -> Any:
    return 1 / np.sqrt(x)


def _argument(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    return functools.partial(_largest, params["axes"][0], np.dtype(params["index_dtype"]))


def _largest(axis: int, dtype: np.dtype, x: Any) -> Any:
    return np.argmax(x, axis).astype(dtype)


def _special(name: str) -> Any:
    def made(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
        return getattr(importlib.import_module("scipy.special"), name)

    return made


# --- matrices ---------------------------------------------------------------------------------------------------------


def _each_matrix(function: Callable[..., Any], *matrices: Any) -> Any:
    """The function of batches of matrices; NaN for those that it refuses."""
    try:
        return function(*matrices)
    except np.linalg.LinAlgError:
        if matrices[0].ndim == 2:
            return np.full_like(matrices[-1], np.nan)
        return np.stack([_each_matrix(function, *each) for each in zip(*matrices, strict=True)])


def _factor(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    return functools.partial(_each_matrix, np.linalg.cholesky)


def _triangular(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    if params["unit_diagonal"] or not np.issubdtype(out.dtype, np.floating):
        raise UnknownError("triangular_solve")
    return functools.partial(_substituted, params["left_side"], params["lower"], params["transpose_a"])


def _substituted(left: bool, lower: bool, transposed: bool, matrix: Any, right: Any) -> Any:
    matrix = np.tril(matrix) if lower else np.triu(matrix)
    if transposed == left:
        matrix = matrix.swapaxes(-1, -2)
    right = right if left else right.swapaxes(-1, -2)
    found = _each_matrix(np.linalg.solve, matrix, right)
    return found if left else found.swapaxes(-1, -2)


# --- by their names ---------------------------------------------------------------------------------------------------


def _rounded(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
    if int(params["rounding_method"]) != 1:  # to the even one of two that are as near
        raise UnknownError
    return np.rint


def _reduced(ufunc: np.ufunc) -> Any:
    def made(params: Mapping[str, Any], given: list[Any], out: Any) -> Any:
        if 0 in given[0].shape:
            raise UnknownError
        return functools.partial(ufunc.reduce, axis=tuple(params["axes"]))

    return made


def _power(exponent: int, x: Any) -> Any:
    return np.power(x, x.dtype.type(exponent))


# operations that NumPy has by the same name, and by another one
_ALIKE = (
    "abs",
    "ceil",
    "exp",
    "cos",
    "exp2",
    "expm1",
    "floor",
    "imag",
    "log",
    "log1p",
    "real",
    "sign",
    "sin",
    "sqrt",
    "square",
    "tanh",
)
_PLAIN = {name: getattr(np, name) for name in _ALIKE} | {
    "add": np.add,
    "add_any": np.add,
    "and": np.bitwise_and,
    "clamp": _clamped,
    "complex": _complex,
    "div": np.divide,
    "dynamic_update_slice": _updated,
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
    "rsqrt": _rsqrt,
    "shift_left": np.left_shift,
    "shift_right_arithmetic": np.right_shift,
    "sub": np.subtract,
    "xor": np.bitwise_xor,
}
_OF_FLOATS = {"div", "pow", "integer_pow"}  # integers have other rules
_MADE: dict[str, Callable[[Mapping[str, Any], list[Any], Any], Callable[..., Any]]] = {
    "argmax": _argument,
    "bitcast_convert_type": _view,
    "broadcast_in_dim": _broadcast,
    "concatenate": lambda params, given, out: functools.partial(_joined, np.concatenate, params["dimension"]),
    "cholesky": _factor,
    "convert_element_type": _convert,
    "cummax": _accumulated(np.maximum),
    "cumprod": _accumulated(np.multiply),
    "cumsum": _accumulated(np.add),
    "dot_general": _dot,
    "digamma": _special("psi"),
    "dynamic_slice": lambda params, given, out: functools.partial(_sliced, params["slice_sizes"]),
    "gather": _gather,
    "integer_pow": lambda params, given, out: functools.partial(_power, params["y"]),
    "iota": lambda params, given, out: functools.partial(_counted, out.shape, params["dimension"], np.dtype(out.dtype)),
    "lgamma": _special("gammaln"),
    "pad": _pad,
    "reduce_and": _reduced(np.bitwise_and),
    "reduce_max": _reduced(np.maximum),
    "reduce_min": _reduced(np.minimum),
    "reduce_or": _reduced(np.bitwise_or),
    "reduce_sum": _reduced(np.add),
    "reshape": _shaped,
    "rev": lambda params, given, out: functools.partial(np.flip, axis=params["dimensions"]),
    "round": _rounded,
    "scatter": _scatter(False),
    "scatter-add": _scatter(True),
    "select_n": _select,
    "slice": _slice,
    "squeeze": _shaped,
    "stack": lambda params, given, out: functools.partial(_joined, np.stack, params["axis"]),
    "triangular_solve": _triangular,
    "transpose": lambda params, given, out: functools.partial(np.transpose, axes=params["permutation"]),
}


def operation(name: str, params: Mapping[str, Any], given: list[Any], out: Any, number: int) -> Callable[..., Any]:
    """What makes one of the results of an operation."""
    if name == "split":
        return _split(params, number)
    if name == "unstack":
        return operator.itemgetter((slice(None),) * params["axis"] + (number,))
    if name in _OF_FLOATS and not np.issubdtype(out.dtype, np.inexact):
        raise UnknownError(name)
    if name in _PLAIN:
        return _PLAIN[name]
    if name in _MADE:
        return _MADE[name](params, given, out)
    raise UnknownError(name)
