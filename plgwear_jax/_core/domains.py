"""Checks of arguments and of the fields of records: concrete ones outside their `ranges` raise, traced ones become NaN.

Records are frozen dataclasses that are pytrees, such as contacts and materials.
"""

import dataclasses
import functools
import operator
from collections.abc import Callable, Sequence
from types import UnionType
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar, Union, dataclass_transform, get_args, get_origin

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, typing
from jax.core import Tracer

from .doubts import one_question
from .ranges import (  # noqa: F401 - those who check ask here for what is allowed
    AMPLITUDE,
    EXPONENT,
    FINITE,
    NOT_NEGATIVE,
    NUMBER,
    POISSON_RATIO,
    POSITIVE,
    SHARE,
    Domain,
)
from .startup.programs import traced
from .words import GivenError

ArrayLike = typing.ArrayLike | Sequence[typing.ArrayLike] | Sequence[Sequence[typing.ArrayLike]]
"""Arguments: what JAX takes for an array, and lists and tuples of that."""

if TYPE_CHECKING:

    class Numbers:
        """A field of numbers: it is given as `ArrayLike`, and is what JAX takes for an array."""

        def __get__(self, instance: Any, owner: Any) -> typing.ArrayLike: ...
        def __set__(self, instance: Any, value: ArrayLike) -> None: ...

else:
    Numbers = typing.ArrayLike


def as_array(value: Any) -> Any:
    """A list, a tuple or a range of numbers as an array, and whole numbers as floats; everything else as it is.

    Integers overflow: JAX cuts them to 32 bits without `jax_enable_x64`, and 100 GPa in Pa would be 1.2 GPa.
    """
    if isinstance(value, list | tuple | range):
        try:
            found = np.asarray(value)
        except ValueError:  # rows of several lengths
            return value
        except jax.errors.TracerArrayConversionError:
            return as_array(jnp.asarray(value))
        value = found if found.dtype.kind in "fiub" else value
    dtype = np.result_type(value) if isinstance(value, int) else getattr(value, "dtype", None)
    return value * 1.0 if getattr(dtype, "kind", None) in ("i", "u") else value


class RefusedError(GivenError):
    """Numbers that are allowed one by one, but not together: the contact that they describe has no solution here."""

    names_file = False


def check_real(name: str, value: ArrayLike) -> None:
    """Raise TypeError for anything but real numbers, traced or not; whole ones are floats already, see `as_array`."""
    if not isinstance(value, float):
        try:
            dtype = value.dtype if isinstance(value, Array) else np.asarray(value).dtype
        except ValueError:
            raise ValueError(f"{name} takes numbers, in rows of one length, not {value!r}") from None
        if not jnp.issubdtype(dtype, jnp.floating):
            raise TypeError(f"{name} takes real numbers, not {value if dtype.kind == 'O' else dtype}")


def check(name: str, value: ArrayLike, domain: Domain) -> None:
    """Raise for a concrete value outside its domain and for anything but real numbers; traced values become NaN later.

    Of an array on an accelerator only one boolean is copied to the host, and the first element outside if there is one.
    """
    check_all((name,), (value,), (domain,))


def check_all(names: tuple[str, ...], values: tuple[ArrayLike, ...], domains: tuple[Domain, ...]) -> None:
    """Check several values: first those on the host, then all those on an accelerator with one program and one copy."""
    on_device = []
    for name, value, domain in zip(names, map(as_array, values), domains, strict=True):
        check_real(name, value)
        if isinstance(value, Tracer):
            continue
        if on_accelerator(value):
            on_device.append((name, value, domain))
        else:
            value = value if isinstance(value, float) else np.asarray(value)
            inside = domain.contains(value)
            if inside is not True and not np.all(inside):
                _refuse_element(name, value, domain, np.argmin(inside))
    if on_device:
        _, arrays, rules = zip(*on_device, strict=True)
        with jax.ensure_compile_time_eval():  # known numbers, also while a function of others is traced
            for inside, (name, value, domain) in zip(np.asarray(_all_inside(arrays, rules)), on_device, strict=True):
                if not inside:
                    _refuse_element(name, value, domain, jnp.argmin(domain.contains(value)))


def on_accelerator(value: ArrayLike) -> bool:
    """Whether a known value is elsewhere than in the memory of the processor."""
    return isinstance(value, Array) and any(device.platform != "cpu" for device in value.devices())


@functools.partial(jax.jit, static_argnums=1)
def _all_inside(values: tuple[Array, ...], domains: tuple[Domain, ...]) -> Array:
    return jnp.stack([jnp.all(domain.contains(value)) for value, domain in zip(values, domains, strict=True)])


def _refuse_element(name: str, value: Any, domain: Domain, first: Any) -> None:
    """Raise for the first element outside; `first` is its index in the flattened array."""
    index = tuple(int(i) for i in np.unravel_index(int(first), np.shape(value)))
    where = f" at index {', '.join(map(str, index))}" if index else ""
    element = np.asarray(value[index] if index else value)[()]
    raise ValueError(f"{name} = {element}{where} is outside the allowed range {domain.text}")


def check_bounds(bounds: tuple[ArrayLike, ArrayLike], domain: Domain, *others: Any) -> Any:
    """The dtype of the bounds of an exponent and other arguments, in which concrete ones increase, or an error."""
    try:
        lower, upper = bounds
    except (TypeError, ValueError):
        raise TypeError(f"bounds takes a pair of exponents, not {bounds!r}") from None
    check_all(("bounds[0]", "bounds[1]"), (lower, upper), (domain, domain))
    dtype = real_dtype("bounds", (lower, upper, *others))
    known = [np.asarray(bound, dtype) for bound in bounds if not isinstance(bound, Tracer)]
    if len(known) == 2 and not np.all(np.less(*known)):
        raise ValueError(f"bounds = {bounds}: the lowest exponent must be below the highest")
    return dtype


def nan_outside(name: str, value: ArrayLike, domain: Domain) -> Array:
    """The value as an array: checked where it is concrete, NaN outside the domain where it is traced."""
    value = as_array(value)
    check(name, value, domain)
    if not isinstance(value, Tracer):
        return jnp.asarray(value)
    return nan_unless(domain.contains(value), value)


def nan_unless(inside: Array, value: ArrayLike) -> Array:
    """The value, or NaN."""
    # Multiplied by NaN, derivatives become NaN too; with `where` they would become zero. The factors have the dtype of
    # the value, or like a number of Python none, so that JAX traces no conversion.
    factors, value = (1.0, jnp.nan), jnp.asarray(value)
    return value * jnp.where(inside, *factors if value.weak_type else np.array(factors, jnp.result_type(value, 0.0)))


def real_dtype(name: str, values: tuple[ArrayLike, ...]) -> Any:
    """The floating dtype that the arguments of the function `name` promote to."""
    dtype = jnp.result_type(*map(as_array, values), 0.0)
    if not jnp.issubdtype(dtype, jnp.floating):
        raise TypeError(f"{name} takes real numbers, not {dtype}")
    return dtype


def as_argument(value: ArrayLike, dtype: Any) -> Array | np.ndarray:
    """The value in the dtype. NumPy converts Python numbers, in a tenth of the time that JAX takes.

    A traced value stays as it is; the surrounding program converts it.
    """
    if not isinstance(value, Array):
        return np.asarray(value, dtype)
    kept = isinstance(value, Tracer) or (value.dtype == dtype and not value.weak_type)
    return value if kept else jnp.asarray(value, dtype)


def whole(name: str, value: Any, least: int, most: float = float("inf"), more: str = "") -> int:
    """An integer of Python or NumPy within a range as one of Python, or an error with `more` after the range.

    JAX takes True for 1 where it keeps programs, so it is refused.
    """
    try:
        found = None if isinstance(value, bool | np.bool_) else operator.index(value)
    except TypeError:
        found = None
    if found is None or not least <= found <= most:
        allowed = f"{least} <= {name}" if most == float("inf") else f"{least} <= {name} <= {most}"
        kind = ", a whole number" if found is None else ""
        raise RefusedError(f"{name} = {value!r} is outside the allowed range {allowed}{more}{kind}")
    return found


def check_digits(digits: int | None, dtype: Any) -> int | None:
    """The digits as a number of Python, or a ValueError if the dtype cannot hold as many."""
    if digits is None:
        return None
    return whole("digits", digits, 1, int(jnp.finfo(dtype).precision), f" of {dtype}")


# --- numbers alone --------------------------------------------------------------------------------------------------

_Given = ParamSpec("_Given")
_Found = TypeVar("_Found")


def concrete_only(
    instead: str, of: type | None = None
) -> Callable[[Callable[_Given, _Found]], Callable[_Given, _Found]]:
    """Have a function that reads its numbers refuse to be a part of another program.

    Args:
        instead: What does work there, as the end of the line.
        of: What has to be among the arguments, as the first one.
    """

    def refusing(function: Callable[_Given, _Found]) -> Callable[_Given, _Found]:
        name = getattr(function, "__name__", "")

        @functools.wraps(function)
        def called(*args: _Given.args, **kwargs: _Given.kwargs) -> _Found:
            refuse_traced(name, traced((args, kwargs)), instead)
            if of and of not in map(type, (*args, *kwargs.values())):
                raise TypeError(f"{name} takes a {of.__name__} as its first argument")
            with one_question():
                return function(*args, **kwargs)

        return called

    return refusing


def refuse_traced(name: str, are_traced: bool, instead: str) -> None:
    """Refuse traced values given to what is for numbers alone, and say what does work."""
    if are_traced:
        raise TypeError(f"{name} is for numbers alone, not under jit, grad or vmap: {instead}")


# --- records --------------------------------------------------------------------------------------------------------

_Record = TypeVar("_Record")
_STATIC, _WORD = "static", "word"


def static(**options: Any) -> Any:
    """A field that is part of the structure of a record, such as a choice between words: hashable, and not a number."""
    return dataclasses.field(metadata={_STATIC: True}, **options)


def number_or(word: str, **options: Any) -> Any:
    """A field of numbers that may hold this word instead, which is then part of the structure."""
    return dataclasses.field(metadata={_WORD: word}, **options)


def _takes_numbers(kind: Any) -> bool:
    options = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    return any(option in (Any, float, "float") for option in options)


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, static, number_or))
def record(cls: type[_Record]) -> type[_Record]:
    """A frozen dataclass that is a pytree of its fields, except for those declared by `static` or `number_or`.

    `__post_init__` makes arrays of lists and tuples in fields of numbers and checks the fields that have a `Domain` in
    the class variable `ranges`, if there is one. JAX rebuilds records without calling it, with traced values.
    """
    checked, ranges = getattr(cls, "__post_init__", None), getattr(cls, "ranges", {})

    def post_init(self: Any) -> None:
        for name in numbers:
            object.__setattr__(self, name, as_array(getattr(self, name)))
        for field in fields:
            value = getattr(self, field.name)
            if field.name in ranges and not (value is None is field.default):
                check(field.name, value, ranges[field.name])
        if checked is not None:
            checked(self)

    cls.__post_init__ = post_init  # pyright: ignore[reportAttributeAccessIssue]
    cls = dataclasses.dataclass(frozen=True)(cls)
    fields = dataclasses.fields(cls)  # pyright: ignore[reportArgumentType]
    about = {field.name: field.metadata for field in fields}
    numbers = [field.name for field in fields if _STATIC not in field.metadata and _takes_numbers(field.type)]

    def flatten(instance: _Record) -> tuple[list[tuple[Any, Any]], tuple[tuple[str, Any], ...]]:
        children, structure = [], []
        for name, known in about.items():
            value = getattr(instance, name)
            if _STATIC in known or (isinstance(value, str) and value == known.get(_WORD)):
                structure.append((name, value))
            else:
                children.append((jax.tree_util.GetAttrKey(name), value))
        return children, tuple(structure)

    def unflatten(structure: tuple[tuple[str, Any], ...], children: Any) -> _Record:
        instance = object.__new__(cls)
        words, numbers = dict(structure), iter(children)
        for name in about:
            object.__setattr__(instance, name, words[name] if name in words else next(numbers))
        return instance

    jax.tree_util.register_pytree_with_keys(cls, flatten, unflatten)
    return cls


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, static, number_or))
class RecordFamily:
    """A class of which all subclasses are records, without a decorator."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        record(cls)


def check_columns(of: Any) -> None:
    """Refuse a record whose two `tables` have not as many points, at least two."""
    one, other = (np.shape(getattr(of, name)) for name in of.tables)
    if not (one and other and one[-1] == other[-1] and one[-1] > 1):
        raise ValueError(f"{' and '.join(of.tables)} take two points or more, not shapes {one} and {other}")


def field_nan_outside(of: Any, name: str) -> Array:
    """A field of a record as an array, NaN where it is traced and outside its range."""
    return nan_outside(name, getattr(of, name), of.ranges[name])
