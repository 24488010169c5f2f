"""A program run by NumPy, operation by operation: XLA needs seconds to compile what NumPy computes in milliseconds.

A traced program becomes a list of steps, each an operation with the places of its arguments. XLA compiles programs with
anything that is not among the `operations`, and those that would soon have taken half as long.
"""

import math
from collections.abc import Sequence
from typing import Any

import jax
import numpy as np

from .operations import FUNCTIONS, UnknownError, parameters_of

# In the time of so many steps XLA compiles about half an operation.
PATIENCE = 200
_AT_ONCE = 20_000  # XLA saves with so many numbers what it saves with a step, some 2 us
_TURNS = 3  # of a loop whose end is not known beforehand, at least: what it takes is counted

_CALLS = {  # operations that are programs, and the parameter that holds these
    "jit": "jaxpr",
    "pjit": "jaxpr",
    "closed_call": "call_jaxpr",
    "custom_jvp_call": "call_jaxpr",
    "custom_vmap_call": "call",
    "remat2": "jaxpr",
    "eval_jaxpr": "call_jaxpr",
}
_SAME = {"device_put", "stop_gradient", "copy", "copy_p", "optimization_barrier"}


class _Block:
    """A program as steps: the name of each, its parameters, the places of its arguments, and those of its results.

    Attributes:
        values: What is known of each place beforehand; the first ones are those of the arguments.
        cost: How many steps there are, in those of few numbers each, without those of loops.
        estimate: The same with those of loops.
        operations: How many XLA would compile.
    """

    def __init__(self, program: Any, left: list[int]):
        self.left = left  # how many steps all blocks together may take
        self.values: list[Any] = [None] * len(program.in_avals)
        self.steps: list[tuple[Any, ...]] = []
        self.constants: dict[Any, int] = {}  # their places
        self.cost, self.estimate, self.operations = 0, 0, 0
        self.results = self._inlined(program, range(len(self.values)))
        self.estimate += self.cost
        del self.constants
        needed, steps = set(self.results), []
        for *step, places, made in reversed(self.steps):
            if not needed.isdisjoint(made):
                steps.append((*step, places, made, set(places) - needed))  # the last ones are not needed again
                needed.update(places)
        self.steps = steps[::-1]

    def __call__(self, arguments: Sequence[Any]) -> list[Any]:
        self.left[0] -= self.cost
        if self.left[0] < 0:
            raise UnknownError("too many steps")
        values = self.values.copy()
        values[: len(arguments)] = arguments
        for name, params, places, made, over in self.steps:
            found = FUNCTIONS[name](*[values[place] for place in places], **params)
            if type(found) is list:
                for place, each in zip(made, found, strict=True):
                    values[place] = each
            else:
                values[made[0]] = found
            for place in over:
                values[place] = None
        return [values[place] for place in self.results]

    def _place(self, value: Any) -> int:
        self.values.append(value)
        return len(self.values) - 1

    def _inlined(self, whole: Any, places: Sequence[int]) -> list[int]:
        """Take in a program; the places of its results."""
        program, constants = getattr(whole, "jaxpr", whole), getattr(whole, "consts", ())  # of a checkpoint none
        where = dict(zip(program.invars, places, strict=True))
        for of, x in zip(program.constvars, constants, strict=True):  # the same one often
            value = np.asarray(x)[()]
            where[of] = self.constants.setdefault((value.dtype, value.shape, value.tobytes()), len(self.values))
            if where[of] == len(self.values):
                self._place(value)

        def place(of: Any) -> int:
            return self._place(np.asarray(of.val, of.aval.dtype)[()]) if hasattr(of, "val") else where[of]  # a literal

        for equation in program.eqns:
            name, params, results = equation.primitive.name, equation.params, equation.outvars
            given = [place(of) for of in equation.invars]
            if name in _CALLS:
                found = self._inlined(params[_CALLS[name]], given)
            elif name in _SAME:
                found = given
            elif name == "call_hi_primitive":  # as `jax.lax.custom_root` from JAX 0.11 on, whose program a method makes
                whole = params["_prim"]
                found = self._inlined(jax.make_jaxpr(whole.expand)(*whole.in_avals), given)
            elif name == "custom_linear_solve":
                sizes = params["const_lengths"]
                first = sizes.matvec + sizes.vecmat
                own = given[first : first + sizes.solve] + given[sum(sizes) :]
                found = self._inlined(params["jaxprs"].solve, own)
            elif name == "platform_index":
                here = [names is None or "cpu" in names for names in params["platforms"]]
                found = [self._place(np.int32(here.index(True)))]
            elif name == "cond" and self.values[given[0]] is not None:  # the platform
                found = self._inlined(params["branches"][int(self.values[given[0]])], given[1:])
            else:
                found = [self._place(None) for _ in results]
                wanted = parameters_of(equation)
                turns = params.get("length", _TURNS if name == "while" else 1)
                self.steps.append((name, {key: self._within(x, turns) for key, x in wanted.items()}, given, found))
                self.operations += 1
                self.cost += 1 + sum(math.prod(of.aval.shape) for of in results) // _AT_ONCE
            where |= dict(zip(results, found, strict=True))
        return [place(of) for of in program.outvars]

    def _within(self, value: Any, turns: int) -> Any:
        """A parameter; a program that is run some times as steps."""
        if type(value) is tuple:
            return tuple(self._within(x, turns) for x in value)
        if not hasattr(value, "eqns"):
            return value
        block = _Block(value, self.left)
        self.estimate += turns * block.estimate
        self.operations += block.operations
        return block


class SteppedProgram:
    """What computes the results of a program from its arguments; it can be pickled."""

    def __init__(self, traced: Any, patience: int):
        self._left = [0]
        self._block = _Block(traced.jaxpr, self._left)
        self._left[0] = patience * self._block.operations
        self._dtypes = [aval.dtype for aval in traced.jaxpr.in_avals]
        self._tree = jax.tree.structure(traced.out_info)

    @property
    def worthwhile(self) -> bool:
        """Whether XLA would not take less time by now, with the next call."""
        return self._block.estimate <= self._left[0]

    def __call__(self, *numbers: Any) -> Any:
        """The result, as arrays of JAX.

        Raises:
            UnknownError: It takes too many steps, or has something unknown; from now on they are not worthwhile.
        """
        given = [np.asarray(x, dtype) for x, dtype in zip(jax.tree.leaves(numbers), self._dtypes, strict=True)]
        try:
            with np.errstate(all="ignore"):
                found = self._block(given)
        except Exception as error:
            self._left[0] = -1
            raise UnknownError(error) from None
        return jax.device_put(jax.tree.unflatten(self._tree, list(map(np.asarray, found))))


def stepwise(traced: Any, patience: int = PATIENCE) -> SteppedProgram | None:
    """The steps of what `jax.jit` has traced; None if XLA should compile it.

    Args:
        traced: The program.
        patience: How many steps may be taken, of all calls together, for each operation that XLA need not compile.
    """
    try:
        steps = SteppedProgram(traced, patience)
    except Exception:  # another JAX may write programs in another way
        return None
    return steps if steps.worthwhile else None
