"""What was solved last, for the next question about the same contact."""

import weakref
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import numpy as np
from jax.core import Tracer

__all__ = ["Last"]


class _Entry(NamedTuple):
    contact: weakref.ref[Any]
    leaves: list[tuple[Any, Any]]  # of the contact, with copies of those that may be changed in place
    key: Any
    given: list[tuple[Any, Any]]  # the arguments, likewise
    found: Any


class Last:
    """One solution in one immutable entry with the question that it answers: threads read and replace it as a whole.

    The entry ends with its contact. Traced solutions are kept only if they belong to the same trace as the contact, so
    that nothing outlives its trace.
    """

    def __init__(self) -> None:
        self._entry: _Entry | None = None

    def of(self, contact: Any, key: Any, given: Any, solve: Callable[[], Any]) -> Any:
        """What `solve` returns for this contact, key and arguments; it is not called if that is known."""
        known = self.any_of(contact, key, lambda leaves: _same(leaves, jax.tree.leaves(given)))
        if known is not None:
            return known
        found = solve()
        if _traces(found) <= _traces(contact):
            ref = weakref.ref(contact, self._forget)
            self._entry = _Entry(ref, _kept(contact), key, _kept(given), found)
        return found

    def any_of(self, contact: Any, key: Any, fits: Callable[[list[tuple[Any, Any]]], bool]) -> Any:
        """The solution that is known for this contact and key, if its arguments fit; otherwise None."""
        entry = self._entry
        if entry is None or entry.contact() is not contact or entry.key != key:
            return None
        return entry.found if _same(entry.leaves, jax.tree.leaves(contact)) and fits(entry.given) else None

    def _forget(self, ref: weakref.ref[Any]) -> None:
        entry = self._entry
        if entry is not None and entry.contact is ref:
            self._entry = None


def _traces(tree: Any) -> set[int]:
    return {id(getattr(leaf, "_trace", None)) for leaf in jax.tree.leaves(tree) if isinstance(leaf, Tracer)}


def _kept(tree: Any) -> list[tuple[Any, Any]]:
    return [(leaf, leaf.copy() if isinstance(leaf, np.ndarray) else None) for leaf in jax.tree.leaves(tree)]


def _same(kept: list[tuple[Any, Any]], leaves: list[Any]) -> bool:
    pairs = zip(kept, leaves, strict=False)
    unchanged = (a is b and (copy is None or np.array_equal(copy, b, equal_nan=True)) for (a, copy), b in pairs)
    return len(kept) == len(leaves) and all(unchanged)
