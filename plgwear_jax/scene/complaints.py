"""Errors in an input file, each in one line: section, key, value, and what is allowed; the first one is told."""

import contextlib
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Self

from plgwear_jax._core.rules import WrongKeyError
from plgwear_jax._core.words import GivenError, bare, near_or_all, shown
from plgwear_jax.scene.keys import SECTIONS, definition_of, values_of

_ABSENT = object()
NAMES = "material", "contact", "load", "wear", "design", "output"


class SceneError(GivenError):
    """An error in a scene, in one line: file, section, key, value, and what is allowed."""

    names_file = False


class OtherFileError(SceneError):
    """An error in the file of a scene, or in another one that it names; its line begins with that file."""

    names_file = True


class Reading(SimpleNamespace):
    """An input file while it is read: its sections as far as they are known, and what is wrong.

    Args:
        file: The name of the file, for messages.
        document: What it holds.
        folder: Where names of other files begin.

    Attributes:
        wrong: The sections in which something is wrong.
        material, contact, wear, load, design, output: What the sections hold; None where they are absent or wrong.
    """

    def __init__(self, file: str, document: dict[str, Any], folder: Path) -> None:
        super().__init__(**dict.fromkeys(NAMES), file=file, document=document, folder=folder, wrong=set())
        self._lines: list[tuple[list[float], str]] = []
        for name, value in document.items():
            if name not in NAMES:
                wrong = f"there is no such section{near_or_all(name, NAMES)}"
                stray = f"stands outside the sections; allowed are {', '.join(NAMES)}"
                self.refuse((name,), wrong if isinstance(value, dict) else stray)

    def end(self) -> None:
        """Raise the first error in the order of the file, if there is any; what is absent comes last."""
        if self._lines:
            raise OtherFileError(min(self._lines, key=lambda found: found[0])[1])

    def refuse(self, path: tuple[str, ...], text: str) -> None:
        """Keep an error in the key of this path, or in a section: what it must be."""
        place, value = self._find(path)
        section, *keys = map(bare, path)
        told = f"[{section}] {'.'.join(keys)}".rstrip()
        if value is _ABSENT:
            text = f"missing; it {text}" if keys else text
        elif keys:
            told = f"{told} = {shown(value)}"
        elif not isinstance(value, dict):
            told = f"{section} = {shown(value)}"
        self._keep(path[0], place, f"{self.file}: {told}: {text}")

    def read(self, section: str, build: Callable[[Self, str, dict[str, Any]], Any]) -> None:
        """Read a section.

        Args:
            section: Its name.
            build: Makes it from what is read so far, its name in `SECTIONS`, and the values of all its keys.
        """
        given = self.document.get(section)
        if given is None:
            return
        with self.telling(section):
            if not isinstance(given, dict):
                raise WrongKeyError("", f"must be a section, written as [{section}]")
            name = definition_of(section, given)
            values = values_of(name, given, self.refuse, (section,))
            if section not in self.wrong:
                setattr(self, section, build(self, name, dict.fromkeys(SECTIONS[name]["properties"]) | values))

    @contextlib.contextmanager
    def telling(self, section: str) -> Iterator[None]:
        """Keep what is raised within this context because of a section."""
        try:
            yield
        except WrongKeyError as error:
            self.refuse((section, *re.findall(r"material\.\w+\[\d+\]|[^.]+", error.key)), error.text)
        except ValueError as error:  # of another file
            self._keep(section, self._find((section,))[0], str(error))

    def _keep(self, section: str, place: list[float], line: str) -> None:
        self.wrong.add(section)
        self._lines.append((place, line))

    def _find(self, path: tuple[str, ...]) -> tuple[list[float], Any]:
        """The place of a key in the file, section by section, and its value."""
        place, node = list[float](), self.document
        for key in path:
            node = {str(i): one for i, one in enumerate(node)} if isinstance(node, list) else node
            there = isinstance(node, dict) and key in node
            place.append(list(node).index(key) if there else math.inf)
            node: Any = node[key] if there else _ABSENT
        return place, node
