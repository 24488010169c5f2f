"""Functions that read their numbers, and so refuse traced ones."""

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from plgwear_jax._core.doubts import one_question
from plgwear_jax._core.startup.programs import holds_tracers, traced

_Given = ParamSpec("_Given")
_Found = TypeVar("_Found")


def concrete_only(instead: str) -> Callable[[Callable[_Given, _Found]], Callable[_Given, _Found]]:
    """Have a function that reads its numbers refuse to be a part of another program.

    Args:
        instead: What does work there, as the end of the line.
    """

    def refusing(function: Callable[_Given, _Found]) -> Callable[_Given, _Found]:
        @functools.wraps(function)
        def called(*args: _Given.args, **kwargs: _Given.kwargs) -> _Found:
            if traced((args, kwargs)):
                raise _for_numbers_alone(getattr(function, "__name__", ""), instead)
            with one_question():
                return function(*args, **kwargs)

        return called

    return refusing


def refuse_traced(name: str, given: Any, instead: str) -> None:
    """Refuse traced values among those given to what is for numbers alone, and say what does work."""
    if holds_tracers(given):
        raise _for_numbers_alone(name, instead)


def _for_numbers_alone(name: str, instead: str) -> TypeError:
    return TypeError(f"{name} is for numbers alone, not under jit, grad or vmap: {instead}")
