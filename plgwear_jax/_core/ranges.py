"""The allowed ranges of numbers, with their texts for messages. Imports nothing that takes time."""

from collections.abc import Callable
from typing import Any, NamedTuple


class Domain(NamedTuple):
    """A range of allowed values: its text for messages, and its test for numbers and arrays."""

    text: str
    contains: Callable[[Any], Any]


EXPONENT = Domain("-1 < k < 1", lambda k: (k > -1.0) & (k < 1.0))
SHAPE_EXPONENT = Domain(">= 1 and finite", lambda n: (n >= 1.0) & (n < float("inf")))
AMPLITUDE = Domain("0 <= phi < 1", lambda phi: (phi >= 0.0) & (phi < 1.0))
POISSON_RATIO = Domain("-1 < nu <= 1/2", lambda nu: (nu > -1.0) & (nu <= 0.5))
SHARE = Domain("0 <= share < 1", lambda share: (share >= 0.0) & (share < 1.0))
POSITIVE = Domain("> 0 and finite", lambda x: (x > 0.0) & (x < float("inf")))
NOT_NEGATIVE = Domain(">= 0", lambda x: x >= 0.0)
NUMBER = Domain(">= 0 and finite", lambda x: (x >= 0.0) & (x < float("inf")))
FINITE = Domain("a finite number", lambda x: abs(x) < float("inf"))
