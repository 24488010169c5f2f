"""Stresses in the half-space under a contact: `Steady.stress`."""

from .field import Stress

__all__ = ["Stress"]
