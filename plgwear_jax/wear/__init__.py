"""The wear of a contact over cycles, under any load."""

from plgwear_jax.wear.run import Run

__all__ = ["Run"]
