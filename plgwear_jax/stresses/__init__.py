"""Stresses in the half-space under a contact: `Steady.stress`."""

from plgwear_jax.stresses.field import Stress

__all__ = ["Stress"]
