"""Objects that hold a question and its solution, which is computed when a result is first read."""

from collections.abc import Callable
from typing import Any, ClassVar, Self

import jax
import jax.numpy as jnp
from jax import Array
from jax.core import Tracer

from plgwear_jax._core.domains import ArrayLike, Domain, as_array, check, check_digits, nan_outside, real_dtype
from plgwear_jax._core.doubts import doubt, of_contact
from plgwear_jax.loads import PARTIAL_SLIP, Load
from plgwear_jax.shapes import shape_of

from .arguments import ARGUMENTS


class Solution:
    """A question asked of a contact, and its solution.

    A pytree of the question's numbers and of the solution: passing an object through `jit`, `vmap` or a pickle solves
    it, and it is not solved again on the other side. Instances are immutable.
    """

    numbers: ClassVar[tuple[str, ...]] = ("contact", "load")
    shares: ClassVar[Domain] = PARTIAL_SLIP  # of F_x/(mu F_N) that it takes

    contact: Any
    load: Load
    digits: int | None

    def __init_subclass__(cls) -> None:
        jax.tree_util.register_pytree_with_keys(cls, cls._flatten, cls._unflatten)

    def __init__(self, *question: Any, digits: int | None = None) -> None:
        vars(self).update(zip(self.numbers, map(as_array, question), strict=True), digits=digits)
        doubt(*of_contact(self.contact))
        self._check_question()

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__} cannot be changed")

    def __repr__(self) -> str:
        arguments = ", ".join(f"{name}={getattr(self, name)!r}" for name in (*self.numbers, "digits"))
        return f"{type(self).__name__}({arguments})"

    def _solve(self) -> Any:
        """The solution, a pytree; None for closed forms, which need no solution."""

    @property
    def _solution(self) -> Any:
        return self._once("solved", self._solve)

    def _once(self, name: str, solve: Callable[[], Any]) -> Any:
        """What is solved at the first time and then kept under a name."""
        if name in vars(self):
            return vars(self)[name]
        found = solve()
        if _traces(found) <= _traces([getattr(self, one) for one in self.numbers]):
            vars(self)[name] = found  # kept only if it belongs to no other trace, which would end before the object
        return found

    def _flatten(self) -> tuple[list[tuple[Any, Any]], int | None]:
        children = [(jax.tree_util.GetAttrKey(name), getattr(self, name)) for name in self.numbers]
        return [*children, (jax.tree_util.GetAttrKey("solution"), self._solution)], self.digits

    @classmethod
    def _unflatten(cls, digits: int | None, children: Any) -> Self:
        instance = object.__new__(cls)
        vars(instance).update(zip((*cls.numbers, "solved"), children, strict=True), digits=digits)
        return instance

    def _check_question(self) -> None:
        """Check the question itself."""
        self._check()
        if self.digits is not None:
            numbers = jax.tree.leaves([getattr(self, name) for name in self.numbers])
            vars(self)["digits"] = check_digits(self.digits, real_dtype("digits", tuple(numbers)))

    def _check(self, **given: ArrayLike | None) -> None:
        """Check concrete arguments of a method, and the question itself, since JAX rebuilds records without checks."""
        contact = self.contact
        records: list[Any] = [contact, contact.material, shape_of(contact), getattr(contact, "indenter", None)]
        for record in records:
            if record is not None:
                record.__post_init__()
        for name, value in given.items():
            if value is not None:
                check(name, value, ARGUMENTS[name])
        if "load" in self.numbers:
            self.load.check(self.contact.friction, self.contact.normal_force, self.shares)

    def _argument(self, name: str, value: ArrayLike) -> Any:
        """An argument of a method, checked where it is concrete; NaN where it is traced and outside its range."""
        self._check(**{name: value})
        return nan_outside(name, value, ARGUMENTS[name])

    def _relative(self, name: str, value: ArrayLike, unit: Array) -> Array:
        """A distance in a unit, on which what is infinitely far away does not depend."""
        value = nan_outside(name, value, ARGUMENTS[name])
        endless = value == jnp.inf
        return jnp.where(endless, value, jnp.where(endless, unit, value) / unit)


def _traces(tree: Any) -> set[int]:
    return {id(getattr(leaf, "_trace", None)) for leaf in jax.tree.leaves(tree) if isinstance(leaf, Tracer)}
