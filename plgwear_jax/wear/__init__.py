"""The wear of a contact over cycles, under any load."""

from .run import Run

__all__ = ["Run"]
