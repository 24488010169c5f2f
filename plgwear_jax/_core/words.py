"""Parts of one-line error messages: values as TOML writes them, similar names, files that cannot be read."""

import datetime
import difflib
import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

PathGiven = str | os.PathLike[str]
_LONGEST = 60


class GivenError(ValueError):
    """An error in what the user has given, in one line.

    Attributes:
        names_file: Whether the line begins with the file that is wrong.
        names_argument: Whether it begins with an argument of a function, which is an option of a command.
    """

    names_file = True
    names_argument = False


def read_text(path: PathGiven, wanted: str, error: type[ValueError]) -> str:
    """The text of a file in UTF-8, with or without a byte order mark.

    Args:
        path: The file.
        wanted: What the message for a folder adds, such as "an input file is a TOML file".
        error: The error that is raised, with one line that names the file, if it cannot be read.
    """
    name = one_line(os.fspath(path))
    try:
        return Path(path).read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise error(f"{name}: there is no such file") from None
    except IsADirectoryError:
        raise error(f"{name}: is a folder; {wanted}") from None
    except UnicodeDecodeError as problem:
        raise error(f"{name}: is not a text file in UTF-8 (byte {problem.start}); save it as UTF-8") from None
    except (OSError, ValueError) as problem:
        raise error(f"{name}: cannot be read: {getattr(problem, 'strerror', None) or problem}") from None


def near(wrong: Any, right: Iterable[str]) -> str:
    """A question that names the allowed name most similar to the wrong one; empty if none is similar."""
    match = difflib.get_close_matches(wrong, right, n=1) if isinstance(wrong, str) else []
    return f"; did you mean {match[0]}?" if match else ""


_LONGEST_LIST = 180  # characters


def near_or_all(wrong: str, right: Iterable[str]) -> str:
    """`near`, or a list of the allowed names if none is similar; a long list is shortened to fit in a line."""
    known = list(right)
    names = list(known)
    while len(", ".join(names)) > _LONGEST_LIST:
        names.pop()
    if len(names) < len(known):
        names.append(f"and {len(known) - len(names)} more")
    return near(wrong, known) or f"; allowed {'is' if len(known) == 1 else 'are'} {', '.join(names)}"


def one_line(text: str) -> str:
    """The text on one line, with characters that cannot be printed escaped."""
    return "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in text)


def cut(text: str) -> str:
    """The text, shortened to a maximum length."""
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def bare(key: str) -> str:
    """A key as TOML writes it, shortened to a maximum length."""
    plain = key.isascii() and key.replace("-", "").replace("_", "").isalnum()
    return cut(key if plain else shown(key))


def shown(value: Any) -> str:
    """A value as TOML writes it, on one line and shortened to a maximum length."""
    return cut(one_line(_toml(value, depth=0)))


def _toml(value: Any, depth: int) -> str:
    if isinstance(value, bool | str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, int):
        return str(value) if value.bit_length() < 200 else hex(value)
    if isinstance(value, (list, dict)) and depth > 3:
        return "..."
    if isinstance(value, list):
        return f"[{', '.join(_toml(item, depth + 1) for item in value)}]"
    if isinstance(value, dict):
        items = (f"{bare(key)} = {_toml(item, depth + 1)}" for key, item in value.items())
        return f"{{ {', '.join(items)} }}" if value else "{}"
    return value.isoformat() if isinstance(value, (datetime.date, datetime.time)) else str(value)
