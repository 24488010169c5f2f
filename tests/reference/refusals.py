"""Cases of bad input from TOML files: each has the line with which it is refused."""

import tomllib
from pathlib import Path
from typing import Any

import pytest


def cases(file: str | Path, kind: str, called: str = "line") -> Any:
    """A decorator that gives a test the cases of a kind, one by one, as the argument `case`."""
    found = tomllib.loads(Path(file).read_text("utf-8"))[kind]
    return pytest.mark.parametrize("case", found, ids=[case[called][:60] for case in found])


def is_told(line: str, case: dict[str, Any], file: str = "") -> bool:
    """Whether a line is that of the case, after the name of a file; "…" at its end stands for anything."""
    expected = f"{file}: {case['line']}" if file else case["line"]
    return line == expected or (expected.endswith("…") and line.startswith(expected[:-1]))


def refusal(error: type[ValueError], ask: Any, *given: Any, **more: Any) -> str:
    """The one line of the error with which a question is refused."""
    with pytest.raises(error) as caught:
        ask(*given, **more)
    assert "\n" not in str(caught.value)
    return str(caught.value)
