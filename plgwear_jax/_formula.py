"""The border of the library: what every public dimensionless function promises about its arguments.

Inside it nothing is checked: the decorated functions receive arrays of one floating dtype.
"""

import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, ParamSpec

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.core import Tracer
from jax.custom_derivatives import SymbolicZero
from jax.typing import ArrayLike

from plgwear_jax.special.xla import apart, stored

__all__ = [
    "AMPLITUDE",
    "EXPONENT",
    "POISSON_RATIO",
    "POSITIVE",
    "RADIUS",
    "Domain",
    "apart",
    "check",
    "check_all",
    "check_bounds",
    "check_digits",
    "check_real",
    "compiled",
    "formula",
    "guarded",
    "on_host",
    "real_dtype",
    "ruled",
    "stored",
]

Signature = ParamSpec("Signature")


class Domain(NamedTuple):
    """A range of allowed values: its text for people, and its test for numbers and arrays."""

    text: str
    contains: Callable[[Any], Any]


EXPONENT = Domain("-1 < k < 1", lambda k: (k > -1.0) & (k < 1.0))
AMPLITUDE = Domain("0 <= phi < 1", lambda phi: (phi >= 0.0) & (phi < 1.0))
RADIUS = Domain("r >= 0", lambda r: r >= 0.0)
POISSON_RATIO = Domain("-1 < nu <= 1/2", lambda nu: (nu > -1.0) & (nu <= 0.5))
POSITIVE = Domain("> 0 and finite", lambda x: (x > 0.0) & (x < float("inf")))


def check_real(name: str, value: ArrayLike) -> None:
    """Raise TypeError for what is no real number, traced or not."""
    if not isinstance(value, float):
        dtype = value.dtype if isinstance(value, Array) else np.asarray(value).dtype
        if not any(jnp.issubdtype(dtype, kind) for kind in (jnp.floating, jnp.integer, jnp.bool_)):
            raise TypeError(f"{name} takes real numbers, not {value if dtype.kind == 'O' else dtype}")


def check(name: str, value: ArrayLike, domain: Domain) -> None:
    """Raise for a concrete value outside its domain, and for what is no real number; a traced one becomes NaN later.

    Of an array on an accelerator nothing is copied but one truth value, and the first element outside if there is one.
    """
    check_all((name,), (value,), (domain,))


def check_all(names: tuple[str, ...], values: tuple[ArrayLike, ...], domains: tuple[Domain, ...]) -> None:
    """Check several values: those on the host first, then all on an accelerator by one program and one reading."""
    away = []
    for name, value, domain in zip(names, values, domains, strict=True):
        check_real(name, value)
        if on_host(value):
            value = value if isinstance(value, float) else np.asarray(value)
            inside = domain.contains(value)
            if inside is not True and not np.all(inside):
                _refuse(name, value, domain, np.argmin(np.asarray(inside)))
        elif not isinstance(value, Tracer):
            away.append((name, value, domain))
    if away:
        _, arrays, rules = zip(*away, strict=True)
        for inside, (name, value, domain) in zip(np.asarray(_all_inside(arrays, rules)), away, strict=True):
            if not inside:
                _refuse(name, value, domain, jnp.argmin(domain.contains(value)))


def on_host(value: ArrayLike) -> bool:
    """Whether a value can be read without waiting for another device; a traced one cannot be read at all."""
    if isinstance(value, Array):
        return not isinstance(value, Tracer) and all(device.platform == "cpu" for device in value.devices())
    return True


@functools.partial(jax.jit, static_argnums=1)
def _all_inside(values: tuple[Array, ...], domains: tuple[Domain, ...]) -> Array:
    return jnp.stack([jnp.all(domain.contains(value)) for value, domain in zip(values, domains, strict=True)])


def _refuse(name: str, value: Any, domain: Domain, first: Any) -> None:
    """Raise for the element of a value that is the `first` outside, counted row by row."""
    index = tuple(int(i) for i in np.unravel_index(int(first), np.shape(value)))
    where = f" at index {', '.join(map(str, index))}" if index else ""
    element = np.asarray(value[index] if index else value)[()]
    raise ValueError(f"{name} = {element}{where} is outside the allowed range {domain.text}")


def check_bounds(bounds: tuple[ArrayLike, ArrayLike], domain: Domain, dtype: Any) -> None:
    """Raise for concrete bounds of the exponent that are outside a domain, or not in order in the dtype."""
    for i, bound in enumerate(bounds):
        check(f"bounds[{i}]", bound, domain)
    if not any(isinstance(bound, Tracer) for bound in bounds) and not np.all(
        np.less(*(np.asarray(bound, dtype) for bound in bounds))
    ):
        raise ValueError(f"bounds = {bounds}: the lowest exponent must be below the highest")


def guarded(name: str, value: ArrayLike, domain: Domain) -> Array:
    """The value as an array: checked where it is concrete, NaN outside the domain where it is traced."""
    check(name, value, domain)
    return jnp.asarray(value) * _one_or_nan(domain.contains(jnp.asarray(value)))


def _one_or_nan(inside: Array) -> Array:
    # As a factor it makes derivatives NaN too; a `where` would make them zero.
    return jnp.where(inside, 1.0, jnp.nan)


def real_dtype(name: str, values: tuple[ArrayLike, ...]) -> Any:
    """The floating dtype that the arguments of the function `name` promote to."""
    dtype = jnp.result_type(*values, 0.0)
    if not jnp.issubdtype(dtype, jnp.floating):
        raise TypeError(f"{name} takes real numbers, not {dtype}")
    return dtype


def _as_argument(value: ArrayLike, dtype: Any) -> Array | np.ndarray:
    """The value in the dtype; numbers by way of NumPy, which takes a tenth of the time of a call of JAX.

    A traced value is left as it is: within the program its conversion costs no program of its own.
    """
    if not isinstance(value, Array):
        return np.asarray(value, dtype)
    return value if isinstance(value, Tracer) or _is_of(value, dtype) else jnp.asarray(value, dtype)


def _is_of(value: Array, dtype: Any) -> bool:
    return value.dtype == dtype and not value.weak_type


def check_digits(digits: int | None, dtype: Any) -> None:
    """Raise ValueError for a number of digits that the dtype cannot hold."""
    most = int(jnp.finfo(dtype).precision)
    if digits is not None and not (type(digits) is int and 1 <= digits <= most):
        raise ValueError(f"digits = {digits!r} is outside the allowed range 1 <= digits <= {most} of {dtype}")


def formula(
    slopes: Mapping[str, Callable[..., Array]] | None = None,
    pairs: Mapping[str, Callable[..., tuple[Array, Array]]] | None = None,
    /,
    **domains: Domain,
) -> Callable[[Callable[Signature, Array]], Callable[Signature, Array]]:
    """Make a public function of a kernel: promotion, domain checks, compilation, NaN where a traced value is outside.

    `domains` names the array arguments of the kernel in their order; its one keyword besides is `digits`. `slopes`
    holds closed forms of derivatives by argument, with the kernel's signature, where they are better than automatic
    differentiation; `pairs` the value and its slope by an argument from one evaluation, for where both are wanted.
    """
    names = tuple(domains)

    known = {names.index(name): slope for name, slope in (slopes or {}).items()}
    paired = {names.index(name): pair for name, pair in (pairs or {}).items()}

    def decorate(kernel: Callable[Signature, Array]) -> Callable[Signature, Array]:
        program = jax.jit(_masked(kernel, known, paired, tuple(domains.values())), static_argnames="digits")
        return _public(kernel, program, domains)

    return decorate


def ruled(**domains: Domain) -> Callable[[Callable[Signature, Array]], Callable[Signature, Array]]:
    """`formula` for a kernel of compiled programs that bring their own rules of differentiation.

    The kernel itself is not compiled, so that several kernels can share one of their programs.
    """

    def decorate(kernel: Callable[Signature, Array]) -> Callable[Signature, Array]:
        return _public(kernel, _masked_apart(kernel, tuple(domains.values())), domains)

    return decorate


def _public(
    kernel: Callable[Signature, Array], program: Callable[..., Array], domains: Mapping[str, Domain]
) -> Callable[Signature, Array]:
    """The kernel's program behind checks and promotion of its arguments."""
    names = tuple(domains)
    bind = inspect.signature(kernel).bind

    @functools.wraps(kernel)
    def public(*args: Signature.args, **kwargs: Signature.kwargs) -> Array:
        bound = bind(*args, **kwargs).arguments
        digits: Any = bound.pop("digits", None)
        values = tuple(bound.values())
        check_all(names, values, tuple(domains.values()))
        dtype = real_dtype(kernel.__name__, values)
        check_digits(digits, dtype)
        # Half precision is computed in single and handed back as it came.
        working = jnp.promote_types(dtype, jnp.float32)
        result = program(*(_as_argument(value, working) for value in values), digits=digits)
        return result if result.dtype == dtype else result.astype(dtype)

    return public


@functools.partial(jax.jit, static_argnums=2)
def _nan_outside(result: Array, values: tuple[Array, ...], domains: tuple[Domain, ...]) -> Array:
    inside = (domain.contains(value) for domain, value in zip(domains, values, strict=True))
    return result * _one_or_nan(functools.reduce(jnp.logical_and, inside)).astype(result.dtype)


def _masked_apart(kernel: Callable[..., Array], domains: tuple[Domain, ...]) -> Callable[..., Array]:
    def masked(*values: Array, digits: int | None) -> Array:
        dtype = jnp.promote_types(real_dtype(kernel.__name__, values), jnp.float32)
        values = tuple(
            value if isinstance(value, Array) and _is_of(value, dtype) else jnp.asarray(value, dtype)
            for value in values
        )
        return _nan_outside(kernel(*values, digits=digits), values, domains)

    return masked


def compiled(method: Callable[Signature, Array]) -> Callable[Signature, Array]:
    """Make a public method of a record: the record checks what is concrete, then one compiled program does the rest.

    `_check` of the record is given the arguments by name, without the `digits`.
    """
    signature = inspect.signature(method)
    program = jax.jit(method, static_argnames=[name for name in signature.parameters if name == "digits"])

    @functools.wraps(method)
    def public(*args: Signature.args, **kwargs: Signature.kwargs) -> Array:
        bound: dict[str, Any] = signature.bind(*args, **kwargs).arguments
        itself, digits = bound.pop("self"), bound.pop("digits", None)
        itself._check(**bound)
        if digits is not None:
            # For JAX, True is the same static argument as 1.
            check_digits(digits, real_dtype(method.__name__, tuple(jax.tree.leaves((itself, bound)))))
            bound["digits"] = digits
        return program(itself, **bound)

    return public


def _masked(
    kernel: Callable[..., Array],
    slopes: Mapping[int, Callable[..., Array]],
    pairs: Mapping[int, Callable[..., tuple[Array, Array]]],
    domains: tuple[Domain, ...],
) -> Callable[..., Array]:
    @functools.wraps(kernel)
    def masked(*values: Array, digits: int | None) -> Array:
        dtype = jnp.promote_types(real_dtype(kernel.__name__, values), jnp.float32)
        values = tuple(value if _is_of(value, dtype) else jnp.asarray(value, dtype) for value in values)
        inside = (domain.contains(value) for domain, value in zip(domains, values, strict=True))
        known = {i: functools.partial(slope, digits=digits) for i, slope in slopes.items()}
        paired = {i: functools.partial(pair, digits=digits) for i, pair in pairs.items()}
        result = by_forward_mode(functools.partial(kernel, digits=digits), known, paired)(*values)
        return result * _one_or_nan(functools.reduce(jnp.logical_and, inside)).astype(result.dtype)

    return masked


def by_forward_mode(
    function: Callable[..., Array],
    slopes: Mapping[int, Callable[..., Array]] | None = None,
    pairs: Mapping[int, Callable[..., tuple[Array, Array]]] | None = None,
) -> Callable[..., Array]:
    """The elementwise `function` of a few arrays, with the rule that its derivatives are taken in forward mode.

    Reverse mode then multiplies by finished partial derivatives, instead of walking back through every term of a
    series; the same for each higher derivative. Partial derivatives that nobody asks for are not computed, and those
    that `slopes` gives by position are taken from there. The first of `pairs` that is asked for gives the value too.
    """
    slopes, pairs = slopes or {}, pairs or {}

    def derivative(i: int) -> Callable[..., Array]:
        # Mixed derivatives go by way of one closed form, the last that there is, whichever comes first.
        better = {j: _partial(slope, i) for j, slope in slopes.items() if i not in slopes or j > i}
        return by_forward_mode(slopes.get(i) or _partial(function, i), better)

    @jax.custom_jvp
    def ruled(*values: Array) -> Array:
        return function(*values)

    def rule(primals, tangents):
        values = tuple(jnp.asarray(primal) for primal in primals)
        wanted = {i: tangent for i, tangent in enumerate(tangents) if not isinstance(tangent, SymbolicZero)}
        first = next((i for i in pairs if i in wanted), None)
        if first is None:
            result, found = ruled(*values), {}
        else:
            result, slope = _ruled_pair(pairs[first], lambda *at: (ruled(*at), derivative(first)(*at)))(*values)
            found = {first: slope}
        total = jnp.zeros_like(result)
        for i, tangent in wanted.items():
            slope = found[i] if i in found else derivative(i)(*values)
            if len(wanted) > 1 and i not in found:  # a Jacobian takes it once for every direction
                slope = stored(slope, values[0])
            total = total + slope * tangent
        return result, total

    ruled.defjvp(rule, symbolic_zeros=True)
    return ruled


def _ruled_pair(
    pair: Callable[..., tuple[Array, Array]], single: Callable[..., tuple[Array, Array]]
) -> Callable[..., tuple[Array, Array]]:
    """Value and slope by `pair`, with the derivatives of the same two taken one by one."""

    @jax.custom_jvp
    def ruled(*values: Array) -> tuple[Array, Array]:
        return pair(*values)

    def rule(primals, tangents):
        wanted = [i for i, tangent in enumerate(tangents) if not isinstance(tangent, SymbolicZero)]

        def along(*moved: Array) -> tuple[Array, Array]:
            values = dict(enumerate(primals)) | dict(zip(wanted, moved, strict=True))
            return single(*values.values())

        slopes = jax.jvp(along, [primals[i] for i in wanted], [tangents[i] for i in wanted])[1]
        return ruled(*primals), slopes

    ruled.defjvp(rule, symbolic_zeros=True)
    return ruled


def _partial(function: Callable[..., Array], i: int) -> Callable[..., Array]:
    def partial(*values: Array) -> Array:
        values = apart(10 + i, *values)

        def along(value: Array) -> Array:
            return function(*values[:i], value, *values[i + 1 :])

        return jax.jvp(along, (values[i],), (jnp.ones_like(values[i]),))[1]

    return partial
