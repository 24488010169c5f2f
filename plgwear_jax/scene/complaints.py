"""Errors in an input file, each in one line: section, key, value, and what is allowed; the first one is told."""

import contextlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn

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
    """An input file while it is read: its sections as far as they are known.

    Args:
        file: The name of the file, for messages.
        document: What it holds.
        folder: Where names of other files begin.

    Attributes:
        material, contact, wear, load, design, output: What the sections hold; None where they are absent.
    """

    def __init__(self, file: str, document: dict[str, Any], folder: Path) -> None:
        super().__init__(**dict.fromkeys(NAMES), file=file, document=document, folder=folder)

    def refuse(self, path: Iterable[str], text: str) -> NoReturn:
        """Refuse the key of this path, or a section: what it must be."""
        value: Any = self.document
        for key in path:
            value = dict(zip(map(str, range(len(value))), value, strict=True)) if isinstance(value, list) else value
            value = value.get(key, _ABSENT) if isinstance(value, dict) else _ABSENT
        section, *keys = map(bare, path)
        told = f"[{section}] {'.'.join(keys)}".rstrip()
        if value is _ABSENT:
            text = f"missing; it {text}" if keys else text
        elif keys:
            told = f"{told} = {shown(value)}"
        elif not isinstance(value, dict):
            told = f"{section} = {shown(value)}"
        raise OtherFileError(f"{self.file}: {told}: {text}")

    def values_of(self, section: str) -> tuple[str, dict[str, Any]]:
        """What a section that is there means, as its name in `SECTIONS`, and the values of all its keys."""
        given = self.document[section]
        if section not in NAMES:
            wrong = f"there is no such section{near_or_all(section, NAMES)}"
            stray = f"stands outside the sections; allowed are {', '.join(NAMES)}"
            self.refuse((section,), wrong if isinstance(given, dict) else stray)
        with self.telling(section):
            if not isinstance(given, dict):
                raise WrongKeyError("", f"must be a section, written as [{section}]")
            name = definition_of(section, given)
        return name, dict.fromkeys(SECTIONS[name]["properties"]) | values_of(name, given, self.refuse, (section,))

    @contextlib.contextmanager
    def telling(self, section: str) -> Iterator[None]:
        """Tell what is raised within this context because of a section, or of a file that it names."""
        try:
            yield
        except WrongKeyError as error:
            self.refuse((section, *re.findall(r"material\.\w+\[\d+\]|[^.]+", error.key)), error.text)
        except GivenError as error:
            raise OtherFileError(str(error)) from None
