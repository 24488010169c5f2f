"""Functions that a batch evaluates for one element after the other."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array, lax
from jax.flatten_util import ravel_pytree

from .startup.programs import along_each, moved_along, parted, steps_of
from .xla import materialised

TOGETHER = 64  # elements at a time on devices other than a processor, to bound the memory


def sequential_vmap(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function of pytrees, which under `vmap` a processor evaluates for one element of the batch after the other.

    Evaluated at the same time, all elements would wait for the slowest one in every loop, and be in memory at once.
    Worse, LAPACK divides a batch of matrices among the threads that run the program itself, which can deadlock.
    Derivatives are computed for the whole batch at the same time.
    """
    implicit = jax.custom_jvp(_alone(function))

    def rule(primals: Any, tangents: Any) -> tuple[Any, Any]:
        found, moved = moved_along(function, primals, tangents)
        # Of a batch all results have the axis, in the rule as in `_alone`, also those that depend on no batched number.
        zero = materialised(jnp.asarray(sum(0.0 * (jnp.sum(x) if x.ndim else x) for x in jax.tree.leaves(primals))))
        return jax.tree.map(lambda x: x + zero, found), moved

    implicit.defjvp(rule, symbolic_zeros=True)
    return implicit


def _alone(function: Callable[..., Any]) -> Callable[..., Any]:
    single = jax.custom_batching.custom_vmap(function)

    @single.def_vmap
    def _rule(size: int, batched: list[Any], *given: Any) -> tuple[Any, Any]:
        moving, whole = parted(given, jax.tree.leaves(batched))

        def one(moving: list[Array]) -> Any:
            return single(*whole(moving))

        if size == 1:
            found = jax.tree.map(lambda x: x[None], one([x[0] for x in moving]))
        elif jax.default_backend() == "cpu":
            found = lax.map(one, moving)
        else:
            together = jax.vmap(function, jax.tree.map(lambda move: 0 if move else None, tuple(batched)))
            found = together(*given) if size <= TOGETHER else lax.map(one, moving, batch_size=TOGETHER)
        return found, jax.tree.map(lambda _: True, found)

    return single


def sequential_forward_mode(function: Callable[..., Any]) -> Callable[..., Any]:
    """`sequential_vmap`, with the value and its derivatives in forward mode computed for one element after the other.

    The results are trees of floating numbers. The rule computes the Jacobian matrix with respect to all numbers that
    are differentiated, so that reverse mode multiplies by this matrix instead of reversing the loops of the function.
    """
    implicit = jax.custom_jvp(_alone(function))

    def _rule(primals: tuple[Any, ...], tangents: tuple[Any, ...]) -> tuple[Any, Any]:
        moves, steps = steps_of(tangents)

        def with_jacobian(*given: Any) -> tuple[Any, Any]:
            moving, whole = parted(given, moves)
            flat, back = ravel_pytree(moving)
            return along_each(lambda at: function(*whole(back(at))), flat, jnp.eye(flat.size, dtype=flat.dtype))

        value, slopes = sequential_forward_mode(with_jacobian)(*primals)
        along = ravel_pytree(steps)[0]
        return value, jax.tree.map(lambda by: jnp.tensordot(along, by, 1), slopes)

    implicit.defjvp(_rule, symbolic_zeros=True)
    return implicit
