"""The wear of a contact over cycles, on the way to its steady state or under displacement control."""

from plgwear_jax.wear.run import Run

__all__ = ["Run"]
