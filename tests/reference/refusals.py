"""Tables of tests from TOML files, among them cases of bad input, each with the line with which it is refused."""

import tomllib
from pathlib import Path

import pytest
from marks import compiled

TESTS = Path(__file__).parents[1]


def data(file):
    """What a file of tests holds."""
    return tomllib.loads((TESTS / file).read_text("utf-8"))


def cases(file, kind, called="line"):
    """A decorator that gives a test the cases of a kind in a file of tests, one by one, as the argument `case`.

    The default run leaves out those that say `compiled = true`.
    """
    found = data(file)[kind]
    marked = [pytest.param(case, marks=compiled if "compiled" in case else ()) for case in found]
    return pytest.mark.parametrize("case", marked, ids=[case[called][:60] for case in found])


def is_told(line, case, file=""):
    """Whether a line is that of the case, after the name of a file; "…" at its end stands for anything."""
    expected = f"{file}: {case['line']}" if file else case["line"]
    return line == expected or (expected.endswith("…") and line.startswith(expected[:-1]))


def refusal(error, ask, *given, **more):
    """The one line of the error with which a question is refused."""
    with pytest.raises(error) as caught:
        ask(*given, **more)
    assert "\n" not in str(caught.value)
    return str(caught.value)
