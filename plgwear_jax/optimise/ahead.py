"""What a search and a report on it will compile, begun while something else is done."""

from collections.abc import Mapping
from typing import Any

from plgwear_jax.optimise import asking, comparison, evaluation, lifetime

__all__ = ["begin"]


def begin(arguments: Mapping[str, Any], *, compared: bool) -> None:
    """Begin to compile what `design` with these arguments needs, and `compared`, if programs are compiled ahead."""
    question = asking.asked(**arguments)
    evaluation.begin(question)
    lifetime.begin(question)
    if compared:
        comparison.begin(question)
