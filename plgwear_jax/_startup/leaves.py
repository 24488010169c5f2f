"""Some of the leaves of a tree: those that are batched, or differentiated by."""

from typing import Any

__all__ = ["merged", "selected"]


def selected(leaves: list[Any], moves: list[bool]) -> list[Any]:
    """The leaves that are batched, or differentiated by."""
    return [x for x, move in zip(leaves, moves, strict=True) if move]


def merged(leaves: list[Any], moves: list[bool], moving: list[Any]) -> list[Any]:
    """All leaves again, from those that were selected and the others."""
    rest = iter(moving)
    return [next(rest) if move else x for x, move in zip(leaves, moves, strict=True)]
