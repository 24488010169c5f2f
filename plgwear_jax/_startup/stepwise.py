"""A program run by NumPy, operation by operation: XLA needs seconds to compile what NumPy computes in milliseconds.

A traced program becomes a list of steps, each a function of NumPy with the places of its arguments. What is computed
twice is computed once, and what nothing depends on is left out. A loop is a step that repeats steps of its own. XLA
compiles programs with anything that is not among the `operations`, and those that would soon have taken half as long.
"""

import functools
import math
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import jax
import numpy as np

from plgwear_jax._startup.operations import UnknownError, operation

if TYPE_CHECKING:  # it imports Pallas, which takes as long as all of the closed forms
    from jax.extend.core import ClosedJaxpr


# In the time of so many steps XLA compiles about half an operation.
PATIENCE = 150
_AT_ONCE = 20_000  # XLA saves with so many numbers what it saves with a step, some 2 us
_FOLDED = 1000  # numbers at most of a result of constants, which is computed only once
_TURNS = 3  # of a loop whose end is not known beforehand, at least: what it takes is counted
_MOST_TURNS = 100


class _Block:
    """Steps one after the other. Each is a function, the places of its arguments, and the places not needed again."""

    def __init__(self, values: list[Any], steps: list[Any], results: list[int], cost: int):
        self.values, self.steps, self.results = values, steps, results
        self.cost, self.taken = cost, 0  # in steps, without those of loops: of a call, and of all calls so far

    def __call__(self, arguments: Iterable[Any]) -> list[Any]:
        self.taken += self.cost
        values = [*arguments, *self.values]
        for function, places, over in self.steps:
            values.append(function(*[values[place] for place in places]))
            for place in over:
                values[place] = None
        return [values[place] for place in self.results]


class Steps:
    """What computes the results of a program from its arguments; it can be pickled.

    Attributes:
        worthwhile: Whether XLA would not take less time by now, with the next call.
    """

    def __init__(self, blocks: list[_Block], dtypes: list[Any], tree: Any, estimate: int, patience: int):
        self._blocks, self._dtypes, self._tree = blocks, dtypes, tree
        self._next, self._patience = estimate, patience

    @property
    def worthwhile(self) -> bool:
        return sum(block.taken for block in self._blocks) + self._next <= self._patience

    def __call__(self, *numbers: Any) -> Any:
        """The result, as arrays of JAX.

        Raises:
            UnknownError: A loop does not end soon; from now on the steps are not worthwhile.
        """
        given = (np.asarray(x, dtype) for x, dtype in zip(jax.tree.leaves(numbers), self._dtypes, strict=True))
        try:
            with np.errstate(all="ignore"):
                found = self._blocks[-1](given)
        except UnknownError:
            self._patience = -1
            raise
        return jax.device_put(jax.tree.unflatten(self._tree, list(map(np.asarray, found))))


def stepwise(traced: Any, patience: int = PATIENCE) -> Steps | None:
    """The steps of what `jax.jit` has traced; None if XLA should compile it.

    Args:
        traced: The program.
        patience: How many steps may be taken, of all calls together, for each operation that XLA need not compile.
    """
    program: ClosedJaxpr = traced.jaxpr
    made = _Maker(program)
    try:
        made.block()
    except UnknownError:
        return None
    patience *= made.operations
    if made.estimate > patience:
        return None
    dtypes = [aval.dtype for aval in program.in_avals]
    return Steps(made.blocks, dtypes, jax.tree.structure(traced.out_info), made.estimate, patience)


_CALLS = {  # operations that are programs, and the parameter that holds these
    "jit": "jaxpr",
    "pjit": "jaxpr",
    "closed_call": "call_jaxpr",
    "custom_jvp_call": "call_jaxpr",
    "custom_vmap_call": "call",
    "remat2": "jaxpr",
}
_SAME = {"device_put", "stop_gradient", "copy", "copy_p", "optimization_barrier"}


class _Maker:
    """Places below 0 are constants until all of these are known."""

    def __init__(self, program: "ClosedJaxpr"):
        self.program = program
        self.arguments = len(program.jaxpr.invars)
        self.constants: list[Any] = []
        self.steps: list[tuple[Callable[..., Any], tuple[int, ...]]] = []
        self.cost, self.estimate = 0, 0  # in steps, without loops and with them
        self.blocks: list[_Block] = []  # those of loops, and then the one of the program itself
        self.operations = 0  # also of loops
        self.known: dict[Any, int] = {}  # the places of what has been computed already

    def constant(self, value: Any) -> int:
        value = np.asarray(value)
        key = value.dtype, value.shape, value.tobytes()
        if key not in self.known:
            self.constants.append(value[()])
            self.known[key] = -len(self.constants)
        return self.known[key]

    def inlined(self, program: "ClosedJaxpr", arguments: list[int]) -> list[int]:
        inner: Any = getattr(program, "jaxpr", program)  # that of a checkpoint has no constants
        if inner.effects:
            raise UnknownError("effects")
        where: dict[Any, int] = dict(zip(inner.invars, arguments, strict=True))
        where |= {
            of: self.constant(value) for of, value in zip(inner.constvars, getattr(program, "consts", ()), strict=True)
        }

        def place(of: Any) -> int:
            aval: Any = of.aval
            return self.constant(np.asarray(of.val, aval.dtype)) if hasattr(of, "val") else where[of]  # a literal

        for equation in inner.eqns:
            name, params = equation.primitive.name, equation.params
            places = [place(of) for of in equation.invars]
            given, made = ([of.aval for of in side] for side in (equation.invars, equation.outvars))
            if name in _CALLS:
                found = self.inlined(params[_CALLS[name]], places)
            elif name in _SAME:
                found = places
            elif name == "custom_linear_solve":
                sizes = params["const_lengths"]
                first = sizes.matvec + sizes.vecmat
                own = places[first : first + sizes.solve] + places[sum(sizes) :]
                found = self.inlined(params["jaxprs"].solve, own)
            elif name == "platform_index":
                found = [self.constant(np.int32(_on_processor(params["platforms"])))]
            elif name == "cond" and places[0] < 0:
                found = self.inlined(params["branches"][int(self.constants[-1 - places[0]])], places[1:])
            elif name in _LOOPS:
                found = self.loop(name, params, places, made)
            else:
                found = [
                    self.step((name, number), operation(name, params, given, out, number), params, places, out)
                    for number, out in enumerate(made)
                ]
            where |= dict(zip(equation.outvars, found, strict=True))
        return [place(of) for of in inner.outvars]

    def loop(self, name: str, params: Mapping[str, Any], places: list[int], made: list[Any]) -> list[int]:
        inner = [_Maker(program) for program in _programs_of(params)]
        function, turns = _LOOPS[name]([one.block() for one in inner], params)
        for one in inner:
            self.estimate += turns * one.estimate
            self.operations += one.operations
            self.blocks += one.blocks
        all_results = self.added(function, tuple(places))
        return [self.added(operator.itemgetter(number), (all_results,)) for number in range(len(made))]

    def step(self, name: Any, function: Any, params: Mapping[str, Any], places: list[int], out: Any) -> int:
        key = name, str(params) if params else "", out.dtype, out.shape, *places
        if key not in self.known:
            self.operations += 1
            if math.prod(out.shape) <= _FOLDED and all(place < 0 for place in places):
                with np.errstate(all="ignore"):
                    self.known[key] = self.constant(function(*[self.constants[-1 - place] for place in places]))
            else:
                self.known[key] = self.added(function, tuple(places))
                self.cost += 1 + math.prod(out.shape) // _AT_ONCE
        return self.known[key]

    def added(self, function: Any, places: tuple[int, ...]) -> int:
        self.steps.append((function, places))
        return self.arguments + len(self.steps) - 1

    def block(self) -> _Block:
        """All steps that the results need."""
        results, first = self.inlined(self.program, list(range(self.arguments))), self.arguments
        needed = set(results)
        for at in range(len(self.steps) - 1, -1, -1):
            if first + at in needed:
                needed.update(self.steps[at][1])
        kept = [at for at in range(len(self.steps)) if first + at in needed]
        begin = first + len(self.constants)
        new = {place: place for place in range(first)}
        new |= {-1 - at: first + at for at in range(len(self.constants))}
        new |= {first + at: begin + i for i, at in enumerate(kept)}
        results = [new[place] for place in results]
        steps: list[tuple[Any, tuple[int, ...], tuple[int, ...]]] = []
        later = set(results)
        for at in reversed(kept):
            function, places = self.steps[at]
            places = tuple(new[place] for place in places)
            over = tuple({place for place in places if place >= begin} - later)
            later.update(places)
            steps.append((function, places, over))
        self.estimate += self.cost
        self.blocks.append(_Block(self.constants, steps[::-1], results, self.cost))
        return self.blocks[-1]


# --- loops and branches -----------------------------------------------------------------------------------------------


def _programs_of(params: Mapping[str, Any]) -> list["ClosedJaxpr"]:
    names = [name for name in ("cond_jaxpr", "body_jaxpr", "jaxpr") if name in params]
    return [params[name] for name in names] or list(params["branches"])


def _while(blocks: list[_Block], params: Mapping[str, Any]) -> tuple[Any, int]:
    constants = params["cond_nconsts"], params["body_nconsts"]
    return functools.partial(_repeated, *blocks, *constants), _TURNS


def _repeated(goes_on: _Block, body: _Block, of_condition: int, of_body: int, *values: Any) -> list[Any]:
    tested, fixed = values[:of_condition], values[of_condition : of_condition + of_body]
    state = list(values[of_condition + of_body :])
    for _ in range(_MOST_TURNS):
        (open_ones,) = goes_on((*tested, *state))
        if not np.any(open_ones):
            return state
        found = body((*fixed, *state))
        if np.ndim(open_ones):  # a batch, whose elements end at different times
            shapes = [np.shape(open_ones) + (1,) * (np.ndim(x) - np.ndim(open_ones)) for x in found]
            each = zip(shapes, found, state, strict=True)
            found = [np.where(np.reshape(open_ones, shape), new, old) for shape, new, old in each]
        state = found
    raise UnknownError("a loop that does not end soon")


def _scan(blocks: list[_Block], params: Mapping[str, Any]) -> tuple[Any, int]:
    length, carried = params["length"], params["num_carry"]
    if not length:
        raise UnknownError("a loop without steps")
    given = params["num_consts"], carried, range(length)[:: -1 if params["reverse"] else 1]
    return functools.partial(_scanned, *blocks, *given), length


def _scanned(body: _Block, constants: int, carried: int, turns: range, *values: Any) -> list[Any]:
    fixed, rows = values[:constants], values[constants + carried :]
    state, made = list(values[constants : constants + carried]), []
    for turn in turns:
        found = body((*fixed, *state, *(x[turn] for x in rows)))
        state = found[:carried]
        made.append(found[carried:])
    return state + [np.stack(x) for x in zip(*made[:: turns.step], strict=True)]


def _cond(blocks: list[_Block], params: Mapping[str, Any]) -> tuple[Any, int]:
    return functools.partial(_branched, blocks), 1


def _branched(branches: list[_Block], which: Any, *values: Any) -> list[Any]:
    return branches[min(max(int(which), 0), len(branches) - 1)](values)


_LOOPS = {"while": _while, "scan": _scan, "cond": _cond}


def _on_processor(platforms: Sequence[Any]) -> int:
    return next(i for i, names in enumerate(platforms) if names is None or "cpu" in names)
