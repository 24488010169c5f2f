"""The command line, as tests call it."""

import itertools
import json
import re
from pathlib import Path

from typer.testing import CliRunner

from plgwear_jax import cli


def plgwear(*arguments):
    """The result of a command, whose arguments may be the words of one text."""
    return CliRunner().invoke(cli.app, [word for text in arguments for word in text.split(" ") if word])


def printed(*arguments):
    """What a command prints that succeeds and warns of nothing."""
    result = plgwear(*arguments)
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    return result.stdout


def told(*arguments):
    """What a command tells programs, if it succeeds and warns of nothing."""
    return json.loads(printed(*arguments, "--json"))


def write(text):
    """Write the input file that most tests of a command ask about."""
    Path("mine.toml").write_text(text)


def refused(*arguments):
    """The one line with which bad input is refused; nothing else is printed, and no file written."""
    before = sorted(Path().rglob("*"))
    result = plgwear(*arguments)
    assert result.exit_code == 2 and result.stdout == "" and sorted(Path().rglob("*")) == before
    (line,) = result.stderr.splitlines()
    return line


def table_rows(printed):
    """The lines of all tables that a command printed, as cells without their headings.

    Columns are told apart by three places or more that are empty in all lines. A line that only continues the cells
    above it is a row of its own.
    """
    found = []
    for inside, block in itertools.groupby(printed.splitlines(), lambda line: line.startswith(" ")):
        for table in re.split(r"\n *\n *\n", "\n".join(block)) if inside else ():
            headings, rows = re.split(r"^ ─+ *$", table, maxsplit=1, flags=re.MULTILINE)
            rows = re.sub(r"^ ─+ *$", "", rows, flags=re.MULTILINE)  # above a last row that stands apart
            every = itertools.zip_longest(*(headings + rows).splitlines(), fillvalue=" ")
            used = "".join(" " if set(place) == {" "} else "x" for place in every)
            columns = [slice(*part.span()) for part in re.finditer(r"x+(?:  ?x+)*", used)]
            found += [[line[column].strip() for column in columns] for line in rows.splitlines() if line.strip()]
    return found
