"""The steady state of a contact: the paper's closed forms, or a numerical solution."""

from .closed import Steady

__all__ = ["Steady"]
