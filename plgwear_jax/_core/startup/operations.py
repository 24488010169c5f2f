"""The operations of JAX that the library's own programs consist of, as functions of NumPy; all others are left to XLA.

Each has JAX's name, and takes those of JAX's parameters that its keywords name. Programs within an operation, such as
the body of a loop, are functions of a list of numbers that return a list.
"""

import functools
import importlib
import inspect
import math
from collections.abc import Callable
from typing import Any

import numpy as np


class UnknownError(Exception):
    """The program has an operation that is left to XLA, or takes too many steps."""


def parameters_of(equation: Any) -> dict[str, Any]:
    """The parameters of an operation that its function here takes."""
    name, params = equation.primitive.name, equation.params
    if name not in FUNCTIONS or (name in _OF_FLOATS and not np.issubdtype(equation.outvars[0].aval.dtype, np.inexact)):
        raise UnknownError(name)
    if name == "scan":  # each JAX tells in its own way what stays and what is carried; rows have one axis less within
        inside = params["jaxpr"]
        same, carried = (
            sum(of.aval.ndim == x.ndim for of, x in zip(outer, inner, strict=True))
            for outer, inner in ((equation.invars, inside.in_avals), (equation.outvars, inside.out_avals))
        )
        params = params | {"num_consts": same - carried, "num_carry": carried}
    return {key: params[key] for key in _keywords(name)}


@functools.cache
def _keywords(name):
    function = FUNCTIONS[name]
    return [] if isinstance(function, np.ufunc) else inspect.getfullargspec(function).kwonlyargs


# --- elements and shapes ----------------------------------------------------------------------------------------------


def _converted(x, *, new_dtype):
    if new_dtype.kind != "i" or x.dtype.kind != "f":
        return x.astype(new_dtype)
    ends = np.iinfo(new_dtype)  # as XLA does: the nearest integer that there is, and 0 for NaN
    found = np.where(np.isnan(x), 0.0, np.maximum(x, ends.min)).astype(new_dtype)
    return np.where(x >= ends.max, new_dtype.type(ends.max), found)


def _rounded(x, *, rounding_method):
    if int(rounding_method) != 1:  # to the even one of two that are as near
        raise UnknownError("round")
    return np.rint(x)


def _complex(real, imaginary):
    made = np.empty(np.shape(real), np.result_type(real.dtype, np.complex64))
    made.real, made.imag = real, imaginary
    return made


def _broadcast(x, *, shape, broadcast_dimensions):
    between = [1] * len(shape)
    for size, axis in zip(x.shape, broadcast_dimensions, strict=True):
        between[axis] = size
    made = np.empty(shape, x.dtype)  # a copy of few numbers takes a fourth of the time of `np.broadcast_to`
    made[...] = x.reshape(between)
    return made


def _with_padding(x, value, *, padding_config):
    low, high, gap = np.transpose(padding_config)
    if np.min((low, high)) < 0:
        raise UnknownError("pad")
    end = low + x.shape + gap * np.maximum(np.subtract(x.shape, 1), 0)
    made = np.full(end + high, value, x.dtype)
    made[tuple(map(slice, low, end, gap + 1))] = x
    return made


def _accumulated(ufunc, x, *, axis, reverse):
    turned = (slice(None),) * axis + (slice(None, None, -1 if reverse else 1),)
    return ufunc.accumulate(x[turned], axis)[turned]


# --- places -----------------------------------------------------------------------------------------------------------


def _window_places(x, at, axes, beside, sizes, mode):
    """The indices of windows of some sizes in x: first the axes of the windows, then those of x.

    Along its last axis `at` has where a window begins, for these `axes` of x. Those of a batch are axes of x `beside`
    axes of the windows. The mode says what JAX does beyond x.
    """
    found = []
    for axis, (whole, size) in enumerate(zip(x.shape, sizes, strict=True)):
        place = np.arange(size).reshape([-1] + [1] * (x.ndim - axis - 1))
        if axis in beside:
            place = np.arange(whole).reshape([-1] + [1] * (at.ndim - 2 - beside[axis] + x.ndim))
        if axis in axes:
            begin = at[..., axes.index(axis)]
            inside = np.clip(begin, 0, whole - size)
            if "FILL" in str(mode) and np.any(inside != begin):
                raise UnknownError("places beyond an array")
            place = place + inside.reshape(inside.shape + (1,) * x.ndim)
        found.append(place)
    return tuple(found)


def _window(x, *at, slice_sizes):
    begin = np.clip(at, 0, np.subtract(x.shape, slice_sizes))
    return x[tuple(map(slice, begin, begin + slice_sizes))]


def _gathered(x, at, *, dimension_numbers, slice_sizes, mode):
    numbers, count = dimension_numbers, at.ndim - 1
    beside = dict(zip(numbers.operand_batching_dims, numbers.start_indices_batching_dims, strict=True))
    found = x[_window_places(x, at, numbers.start_index_map, beside, slice_sizes, mode)]
    found = found.squeeze(tuple(count + axis for axis in (*numbers.collapsed_slice_dims, *beside)))
    return np.moveaxis(found, range(count, found.ndim), numbers.offset_dims)


def _scattering(put):
    def scattered(x, at, updates, *, dimension_numbers, mode):
        numbers, count = dimension_numbers, at.ndim - 1
        new = np.moveaxis(updates, numbers.update_window_dims, range(count, updates.ndim))
        beside = dict(zip(numbers.operand_batching_dims, numbers.scatter_indices_batching_dims, strict=True))
        new = np.expand_dims(new, tuple(count + axis for axis in sorted((*numbers.inserted_window_dims, *beside))))
        x = x.copy()
        put(x, _window_places(x, at, numbers.scatter_dims_to_operand_dims, beside, new.shape[count:], mode), new)
        return x

    return scattered


# --- matrices ---------------------------------------------------------------------------------------------------------

# OpenBLAS begins threads for 262,144 products of two numbers, and on a busy machine these wait for each other.
_PRODUCTS = 250_000


def _product(x, y, *, dimension_numbers):
    (x, shape), (y, columns) = map(_as_matrices, (x, y), *dimension_numbers)
    made = np.empty((*x.shape[:-1], y.shape[-2]), x.dtype)
    most = math.isqrt(_PRODUCTS // max(x.shape[-1], 1)) or 1
    for i in range(0, x.shape[-2], most):
        for j in range(0, y.shape[-2], most):
            rows, others = x[..., i : i + most, :], y[..., j : j + most, :].swapaxes(-1, -2)
            np.matmul(rows, others, out=made[..., i : i + most, j : j + most])
    return made.reshape(shape + columns[made.ndim - 2 :])


def _as_matrices(x, summed, beside):
    """(A batch of matrices with what is summed along the last axis, the shape of x without that)."""
    free = [axis for axis in range(x.ndim) if axis not in (*summed, *beside)]
    x = x.transpose(*beside, *free, *summed)
    shape, batch = x.shape[: x.ndim - len(summed)], len(beside)
    return x.reshape(*shape[:batch], math.prod(shape[batch:]), math.prod(x.shape[len(shape) :])), shape


def _each_matrix(function, *matrices):
    """The function of batches of matrices; NaN for those that it refuses."""
    try:
        return function(*matrices)
    except np.linalg.LinAlgError:
        if matrices[0].ndim == 2:
            return np.full_like(matrices[-1], np.nan)
        return np.stack([_each_matrix(function, *each) for each in zip(*matrices, strict=True)])


def _triangle_solved(matrix, right, *, left_side, lower, transpose_a, unit_diagonal):
    if unit_diagonal or not left_side:
        raise UnknownError("triangular_solve")
    matrix = np.tril(matrix) if lower else np.triu(matrix)
    return _each_matrix(np.linalg.solve, matrix.swapaxes(-1, -2) if transpose_a else matrix, right)


# --- loops and branches -----------------------------------------------------------------------------------------------


def _repeated(*values, cond_jaxpr, cond_nconsts, body_jaxpr, body_nconsts):
    first = cond_nconsts + body_nconsts
    tested, fixed, state = values[:cond_nconsts], values[cond_nconsts:first], values[first:]
    while np.any(open_ones := cond_jaxpr((*tested, *state))[0]):
        found = body_jaxpr((*fixed, *state))
        # Elements of a batch end at different times.
        axes = [tuple(range(np.ndim(open_ones), np.ndim(x))) for x in found]
        each = zip(axes, found, state, strict=True)
        state = [np.where(np.expand_dims(open_ones, more), new, old) for more, new, old in each]
    return list(state)


def _scanned(*values, jaxpr, num_consts, num_carry, length, reverse):
    if not length:
        raise UnknownError("no turn, and so no row that says how large one is")
    first, made = num_consts + num_carry, [()] * length
    fixed, state, rows = values[:num_consts], values[num_consts:first], values[first:]
    for turn in range(length)[:: -1 if reverse else 1]:
        found = jaxpr((*fixed, *state, *(x[turn] for x in rows)))
        state, made[turn] = found[:num_carry], found[num_carry:]
    return [*state, *map(np.stack, zip(*made, strict=True))]


# --- by their names ---------------------------------------------------------------------------------------------------

_OF_FLOATS = {"div", "pow", "integer_pow"}  # integers have other rules
FUNCTIONS: dict[str, Callable[..., Any]] = {
    **{name: ufunc for name, ufunc in vars(np).items() if isinstance(ufunc, np.ufunc)},  # such as sqrt
    "add_any": np.add,
    "and": np.bitwise_and,
    "argmax": lambda x, *, axes, index_dtype: np.argmax(x, axes[0]).astype(index_dtype),
    "argmin": lambda x, *, axes, index_dtype: np.argmin(x, axes[0]).astype(index_dtype),
    "bitcast_convert_type": lambda x, *, new_dtype: x.view(new_dtype),
    "broadcast_in_dim": _broadcast,
    "cholesky": functools.partial(_each_matrix, np.linalg.cholesky),
    "clamp": lambda least, x, most: np.minimum(np.maximum(x, least), most),
    "complex": _complex,
    "concatenate": lambda *parts, dimension: np.concatenate(parts, dimension),
    "cond": lambda which, *values, branches: branches[min(max(int(which), 0), len(branches) - 1)](values),
    "convert_element_type": _converted,
    "cummax": functools.partial(_accumulated, np.maximum),
    "cumprod": functools.partial(_accumulated, np.multiply),
    "cumsum": functools.partial(_accumulated, np.add),
    "digamma": lambda x: importlib.import_module("scipy.special").psi(x),
    "div": np.divide,
    "dot_general": _product,
    "dynamic_slice": _window,
    "eq": np.equal,
    "gather": _gathered,
    "ge": np.greater_equal,
    "gt": np.greater,
    "imag": lambda x: x.imag,
    "integer_pow": lambda x, *, y: np.power(x, x.dtype.type(y)),
    "iota": lambda *, shape, dimension, dtype: np.indices(shape, dtype)[dimension],
    "is_finite": np.isfinite,
    "le": np.less_equal,
    "le_to": lambda x, y: (x <= y) | np.isnan(y),  # as in a sorted array, in which NaN comes last
    "lgamma": lambda x: importlib.import_module("scipy.special").gammaln(x),
    "lt": np.less,
    "max": np.maximum,
    "min": np.minimum,
    "mul": np.multiply,
    "ne": np.not_equal,
    "neg": np.negative,
    "not": np.invert,
    "or": np.bitwise_or,
    "pad": _with_padding,
    "pow": lambda x, y: np.power(x, y.astype(x.dtype)),  # y may be integers
    "real": lambda x: x.real,
    "reduce_and": lambda x, *, axes: np.all(x, axes),
    "reduce_max": lambda x, *, axes: np.max(x, axes),
    "reduce_min": lambda x, *, axes: np.min(x, axes),
    "reduce_or": lambda x, *, axes: np.any(x, axes),
    "reduce_sum": lambda x, *, axes: np.sum(x, axes, x.dtype),
    "reshape": lambda x, *, new_sizes, dimensions: (x if dimensions is None else x.transpose(dimensions)).reshape(
        new_sizes
    ),
    "rev": lambda x, *, dimensions: np.flip(x, dimensions),
    "round": _rounded,
    "rsqrt": lambda x: 1 / np.sqrt(x),
    "scan": _scanned,
    "scatter": _scattering(np.ndarray.__setitem__),
    "scatter-add": _scattering(np.add.at),
    "select_n": lambda which, *cases: np.where(which, *cases[::-1]) if len(cases) == 2 else np.choose(which, cases),
    "shift_left": np.left_shift,
    "shift_right_arithmetic": np.right_shift,
    "slice": lambda x, *, start_indices, limit_indices, strides: x[
        tuple(map(slice, start_indices, limit_indices, strides or (None,) * x.ndim))
    ],
    "sort": lambda x, *, dimension: np.sort(x, dimension),
    "split": lambda x, *, sizes, axis: np.split(x, np.cumsum(sizes[:-1]), axis),
    "squeeze": lambda x, *, dimensions: x.squeeze(dimensions),
    "stack": lambda *parts, axis: np.stack(parts, axis),
    "sub": np.subtract,
    "tile": lambda x, *, reps: np.tile(x, reps),
    "transpose": lambda x, *, permutation: x.transpose(permutation),
    "triangular_solve": _triangle_solved,
    "unstack": lambda x, *, axis: list(np.moveaxis(x, axis, 0)),
    "while": _repeated,
}
