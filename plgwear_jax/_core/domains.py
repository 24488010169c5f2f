"""Checks of arguments: concrete ones outside their `ranges` raise an error, traced ones become NaN."""

import functools
import operator
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array, typing
from jax.core import Tracer

from plgwear_jax._core.ranges import (  # noqa: F401 - those who check ask here for what is allowed
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
from plgwear_jax._core.words import GivenError

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
    """A list, a tuple or a range of numbers as an array; everything else as it is."""
    if not isinstance(value, list | tuple | range):
        return value
    try:
        found = np.asarray(value)
    except ValueError:  # rows of several lengths
        return value
    except jax.errors.TracerArrayConversionError:
        return jnp.asarray(value)
    return found if found.dtype.kind in "fiub" else value


class RefusedError(GivenError):
    """Numbers that are allowed one by one, but not together: the contact that they describe has no solution here."""

    names_file = False


def check_real(name: str, value: ArrayLike) -> None:
    """Raise TypeError for anything but real numbers, traced or not."""
    if not isinstance(value, float):
        try:
            dtype = value.dtype if isinstance(value, Array) else np.asarray(value).dtype
        except ValueError:
            raise ValueError(f"{name} takes numbers, in rows of one length, not {value!r}") from None
        if not any(jnp.issubdtype(dtype, kind) for kind in (jnp.floating, jnp.integer, jnp.bool_)):
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
                _refuse_element(name, value, domain, np.argmin(np.asarray(inside)))
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
    return value * one_or_nan(domain.contains(value))


def one_or_nan(inside: Array) -> Array:
    # Multiplied by NaN, derivatives become NaN too; with `where` they would become zero.
    return jnp.where(inside, 1.0, jnp.nan)


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
