"""What pages take from the library and from the tables of the benchmarks, so that it is written in one place.

    python docs/generated.py              refreshes the numbers and tables that pages take from elsewhere
    python docs/generated.py --printed    also runs the commands whose output pages show; some minutes
    python docs/generated.py --words      counts the words of each page

Pages are complete as they lie in the repository, so that a forge shows them without the site being built. What is
filled in stands between `<!-- begin: NAME -->` and `<!-- end -->`: a table of `GENERATED`, "file PATH" for the text
of a file, "table of PATH" for the Markdown table that a benchmark ends with, or "names of ROOM" for what a room
offers.

A quoted number stands before a comment that says where it comes from, such as `5<!-- surfaces: a table, steel: ms -->`:
the file without its ending, with `#2` for its second table alone; the row, a regular expression for its first cells
joined by ", "; and the column by the end of its title, with the place in the cell as in `errors[-1]`. Of several rows
the largest number is quoted. It is rounded to as many digits as the page shows.
"""

import decimal
import importlib
import importlib.metadata
import inspect
import itertools
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from plgwear_jax._core import catalogue
from plgwear_jax.scene import keys

DOCS = Path(__file__).parent
QUOTED = re.compile(
    r"(?P<shown>\d[\d,.]*(?:e-?\d+)?)(?: %)?"
    r"<!-- (?P<file>[a-z_]+(?:#\d+)?): (?P<row>[^\n>]+?): (?P<column>[^\n:>]+?) -->"
)


# --- tables of the benchmarks ---------------------------------------------------------------------------------------


def tables(name: str) -> Iterator[tuple[list[str], list[list[str]]]]:
    """The tables of a file: the titles of the columns, and the rows."""
    heads: list[str] = []
    rows: list[list[str]] = []
    for line in (DOCS / "benchmarks" / f"{name}.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("┏"):
            heads, rows = [], []
        elif line.startswith("┃"):
            parts = [part.strip() for part in line.strip("┃").split("┃")]
            heads = [f"{head} {part}".strip() for head, part in itertools.zip_longest(heads, parts, fillvalue="")]
        elif line.startswith("│"):
            cells = [cell.strip() for cell in line.strip("│").split("│")]
            if not cells[0] and rows and not any(cells[1:3]):  # a long cell goes on
                rows[-1] = [f"{one} {more}".strip() for one, more in zip(rows[-1], cells, strict=False)]
            else:
                rows.append(cells)
        elif line.startswith("└"):
            yield heads, rows


def number(name: str, row: str, column: str) -> float:
    """A number of a table; of several rows the largest."""
    (name, _, only), (column, _, place) = name.partition("#"), column.partition("[")
    found = []
    for count, (heads, rows) in enumerate(tables(name), 1):
        if only and count != int(only):
            continue
        columns = [
            index for index, head in enumerate(heads) if index and (head == column or head.endswith(f" {column}"))
        ]
        for cells in rows if columns else ():
            first = columns[0]
            if any(re.fullmatch(row, ", ".join(cells[:several])) for several in range(1, first + 1)):
                parts = cells[first].split(", ") if place else [cells[first]]
                found.append(float(parts[int(place[:-1] if place else 0)].replace(",", "")))
    if not found:
        raise LookupError(f"{name}.txt has no row {row!r} with a column {column!r}")
    return max(found)


def like(shown: str, value: float) -> str:
    """A number with as many digits as another one is shown with."""
    mantissa, power, _ = shown.partition("e")
    digits = max(1, len(re.sub(r"^0\.0*|[.,]", "", mantissa)))
    if power:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        return f"{mantissa}e{int(exponent)}"
    rounded = decimal.Decimal(f"{value:.{digits}g}")
    if rounded < 1:
        return f"{rounded:f}"
    return f"{rounded:,.{max(0, digits - len(str(int(rounded)))) if '.' in shown else 0}f}"


def quoted(text: str) -> str:
    """The text with the numbers that the tables have now."""

    def fresh(match: re.Match[str]) -> str:
        shown, value = match["shown"], number(match["file"], match["row"], match["column"])
        return like(shown, value) + match[0][len(shown) :]

    return QUOTED.sub(fresh, text)


def digits_of_functions() -> dict[str, dict[str, str]]:
    """The fewest correct digits in float64 of each function and order of derivative towards the edges of its domain."""
    found: dict[str, dict[str, str]] = {}
    for _, rows in tables("extremes"):
        for name, order, dtype, digits, *_ in rows:
            if dtype == "float64":
                found.setdefault(name, {})[order] = digits
    return found


def fewest_digits() -> str:
    """The functions that keep fewer than ten digits somewhere, and the worst of all others."""
    found = digits_of_functions()
    others = {name: by for name, by in found.items() if min(map(float, by.values())) > 10.0}
    rows = {f"`{name}`": by for name, by in found.items() if name not in others}
    rows["the worst of all others"] = {order: min((by[order] for by in others.values()), key=float) for order in "012"}
    lines = ["| function | value | first derivatives | second derivatives |", "| --- | ---: | ---: | ---: |"]
    return "\n".join(lines + [f"| {name} | {' | '.join(by[order] for order in '012')} |" for name, by in rows.items()])


def random_contacts() -> str:
    """The worst errors of some quantities of random contacts, by what makes these difficult."""
    *errors, (_, counts) = tables("random_contacts")
    kinds = "smooth", "kinks", "thin layers"
    shown = {  # what the page shows of the tables, in their order
        "5 digits": ("radii", "wear volume", "energy", "pressure before", "pressure worn", "derivatives"),
        "balance": ("force worn", "last of a march", "derivatives"),
        "float32, $\\varphi \\ge 0.1$": ("wear volume", "pressure worn"),
    }

    def is_of(kind: str, contacts: str) -> bool:
        return kind == ("thin layers" if contacts.startswith("thin") else contacts.rpartition(", ")[2])

    lines = [f"| quantity | against | {' | '.join(kinds)} |", "| --- | --- | ---: | ---: | ---: |"]
    for (title, names), (_, rows) in zip(shown.items(), errors, strict=True):
        for name in names:
            cells = (
                max((row[-1] for row in rows if row[1] == name and is_of(kind, row[0])), key=float, default="")
                for kind in kinds
            )
            words = name.replace("last of a march", "volume at the end of a run")
            lines.append(f"| {words} | {title} | {' | '.join(cells)} |")
    told = []
    for kind in kinds:
        numbers = [map(int, row[1:]) for row in counts if is_of(kind, row[0])]
        of, refused = map(sum, zip(*numbers, strict=True))
        told.append(f"{refused} of {of}")
    return "\n".join([*lines, f"| refused | | {' | '.join(told)} |"])


def rule_on_coatings() -> str:
    """The change of the worn volume on coatings of 1 and 3 contact radii, in %, from `benchmarks/coatings.py`."""
    ((heads, rows),) = tables("rule")
    shown = [heads.index(name) for name in ("phi 0.05", "phi 0.2", "phi 0.4", "phi 0.74")]
    lines = ["| gradient | contact radii | surface | $\\varphi = 0.05$ | 0.2 | 0.4 | 0.74 |"]
    lines += ["| --- | ---: | --- | ---: | ---: | ---: | ---: |"]
    for row in rows:
        if row[1] != "2":
            lines.append(f"| {' | '.join([*row[:3], *(row[n] for n in shown)])} |")
    return "\n".join(lines)


# --- keys of an input file ------------------------------------------------------------------------------------------

SECTIONS = (  # titles and the models that they describe
    ("`[material]`: a power law", ("Material",)),
    ("`[material]`: a table of the modulus", ("Tabulated",)),
    ("`[material]`: layers", ("Layers",)),
    ('`[contact]` with `kind = "fretting"`', ("Fretting", "Indenter")),
    ("`[contact] shape`", ("PowerShape", "Cone", "RoundedFlat", "TruncatedSphere", "Profile")),
    ('`[contact]` with `kind = "gross-slip"`', ("GrossSlip",)),
    ("`[load]`", ("Load",)),
    ("`[wear]`", ("Wear",)),
    ("`[design]`", ("Design", "Tail")),
    ("`[design] vary`", ("Vary", "VaryIndenter", "VaryShape", "Window")),
    ("`[design] limits`", ("Allowed", "TwoDepths")),
    ("`[output]`", ("Output",)),
)
HEADS = {  # what stands above a table that is not the first one of its section
    "Indenter": "An elastic `indenter` has",
    "PowerShape": "A power of the radius:",
    "Cone": "A cone:",
    "RoundedFlat": "A rounded flat:",
    "TruncatedSphere": "A truncated sphere:",
    "Profile": "A table of heights:",
    "Tail": "`over` as the mean of the worst amplitudes:",
    "Vary": 'Numbers of layers and tables, as `"material.thickness[0]"` and `"material.modulus[0]"`, and these keys:',
    "VaryIndenter": "`indenter` has",
    "VaryShape": "`shape` has",
    "Window": "`modulus` has",
    "Allowed": "Each limit has the name of a [quantity](quantities.md), in quotation marks of one after `cycles` under "
    '`[wear]`, as `"transient.wear_depth"`, or `modulus`. That of a quantity has',
    "TwoDepths": "`modulus` has",
}
UNIT = re.compile(r"\bin (1/Pa|m\^3/\(N m\)|mm\^3/\(N m\)|mm\^3/J|N/m|Pa|m|N)(?=\W|$)")


def input_keys() -> str:
    """Every key of an input file, as tables."""
    lines = list[str]()
    for title, names in SECTIONS:
        lines += [f"## {title}", ""]
        for name in names:
            if name in HEADS:
                lines += [HEADS[name], ""]
            lines += ["| key | what it is | unit | allowed | default |", "| --- | --- | --- | --- | --- |"]
            lines += [*_rows(keys.SECTIONS[name]), ""]
    return "\n".join(lines)


def _rows(section: dict[str, Any]) -> Iterator[str]:
    for name, key in section["properties"].items():
        unit = UNIT.search(key["title"])
        default = "required" if name in section["required"] else _default(key.get("default"))
        words = re.sub(r",? in [A-Zm/]\w*\.$", ".", key["title"])  # the unit has its column
        cells = f"`{name}`", words, unit[1].replace("^3", "³") if unit else "", _allowed(key), default
        yield f"| {' | '.join(cell.replace('|', '&#124;') for cell in cells)} |"


def _default(value: Any) -> str:
    return "" if value is None else f"`{value}`" if not isinstance(value, str) else f'`"{value}"`'


def _allowed(key: dict[str, Any]) -> str:
    """Which values a key takes, from what messages say or from its schema."""
    said = re.sub(r", finite(, in [A-Z]?[a-z]+)?$|, or left out$", "", key["description"])
    if any(mark in said for mark in ("[", "{", '"', "name of", "list of", "whole number")):
        return _as_code(said)
    return " or ".join(_range(one) for one in key.get("anyOf", [key]))


def _as_code(text: str) -> str:
    """Examples of TOML in a sentence, marked as code."""
    return re.sub(r'\{(?:[^{}]|\{[^{}]*\})*\}|\[\[?[^\[\]]*\]?(?:, \[[^\[\]]*\])*\]+|"[^"]*"', r"`\g<0>`", text)


def _range(one: dict[str, Any]) -> str:
    if "$ref" in one:
        one = keys.SECTIONS[one["$ref"].rpartition("/")[2]]
    if "enum" in one:
        return " or ".join(f'`"{value}"`' for value in one["enum"])
    low = f"> {one['exclusiveMinimum']:g}" if "exclusiveMinimum" in one else ""
    low = f"≥ {one['minimum']:g}" if "minimum" in one else low
    high = f"< {one['exclusiveMaximum']:g}" if "exclusiveMaximum" in one else ""
    high = f"≤ {one['maximum']:g}" if "maximum" in one else high
    return " and ".join(part for part in (low, high) if part) or "a finite number"


# --- quantities -----------------------------------------------------------------------------------------------------


def quantities() -> str:
    """Every quantity of the catalogue, and every number of a contact that can vary, as tables."""
    steady = {name: law for name, law in catalogue.FRETTING.items() if name not in catalogue.TANGENTIAL}
    over_cycles = {f"transient.{name}": law for name, law in catalogue.TRANSIENT.items()}
    parts = [
        "## Steady state of a fretting contact\n\n" + _laws(steady),
        "## A cycle before any wear\n\n" + _laws(catalogue.TANGENTIAL),
        "## Over cycles\n\n" + _laws(over_cycles),
        "## Gross slip of a flat punch\n\n" + _laws(catalogue.GROSS_SLIP),
        "## Functions of the material alone\n\n" + _laws(catalogue.MATERIAL),
        "## Numbers of a contact, and arguments\n\n" + _axes(),
    ]
    return "\n\n".join(parts)


def _laws(laws: dict[str, catalogue.Law]) -> str:
    lines = ["| name | symbol | meaning | unit | without a contact | depends on | equation |"]
    lines += ["| --- | --- | --- | --- | --- | --- | --- |"]
    for name, law in laws.items():
        symbol = f"${law.symbol}$" if law.symbol else ""
        words = law.description + (f"; infinite at {law.unbounded_at}" if law.unbounded_at else "")
        takes = ", ".join(f"`{one}`" for one in law.arguments)
        scale = f"`{law.scale}`" if law.scale else ""
        cells = f"`{name}`", symbol, words, law.unit.replace("^3", "³"), scale, takes, _equation(law.equation)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _equation(numbers: str) -> str:
    numbers = re.sub(r"^(\d+)-(\d+)$", r"(\1) to (\2)", numbers)
    return re.sub(r"(?<![\d(/])(\d+)(?=, |$)", r"(\1)", numbers) if re.fullmatch(r"[\d, ]+", numbers) else numbers


def _axes() -> str:
    lines = ["| name | symbol | meaning | unit | allowed |", "| --- | --- | --- | --- | --- |"]
    for name, axis in catalogue.AXES.items():
        path, place = (f"{name}[i]", "i") if axis.listed else (name, "")
        symbol, words = (text.replace("#", place) for text in (axis.symbol, axis.description))
        lines.append(f"| `{path}` | ${symbol}$ | {words} | {axis.unit} | {axis.domain.text} |")
    return "\n".join(lines)


# --- what commands print --------------------------------------------------------------------------------------------

PRINTED = re.compile(
    r"(?<=<!-- printed by: )plgwear (?P<words>[^\n]+)( -->\n```text\n)(?P<shown>.*?)(?=```)", re.DOTALL
)


def printed(text: str, folder: Path) -> str:
    """The text of a page with what its commands print now.

    Args:
        text: The page.
        folder: Where its input files lie.
    """

    def fresh(match: re.Match[str]) -> str:
        with tempfile.TemporaryDirectory() as work:
            for file in folder.glob("*.toml"):
                shutil.copy(file, work)
            command = [sys.executable, "-m", "plgwear_jax", *match["words"].split()]
            settings = {"COLUMNS": "80", "NO_COLOR": "1", "PLGWEAR_NO_CACHE": "1"}
            settings["PYTHONPATH"] = os.pathsep.join([str(DOCS.parent), os.environ.get("PYTHONPATH", "")])
            done = subprocess.run(
                command, cwd=work, env=os.environ | settings, capture_output=True, text=True, check=True
            )
        lines = [line.rstrip() for line in done.stdout.splitlines()]
        return match[0][: match.start("shown") - match.start()] + "\n".join(lines) + "\n"

    return PRINTED.sub(fresh, text)


# --- the command line -------------------------------------------------------------------------------------------------


def commands() -> str | None:
    """The help of every command as the pinned Typer writes it; None from another one, which writes it otherwise."""
    if f"typer=={importlib.metadata.version('typer')}\n" not in (DOCS.parent / "constraints.txt").read_text("utf-8"):
        return None
    command = [sys.executable, "-m", "typer", "plgwear_jax.cli", "utils", "docs", "--name", "plgwear"]
    settings = {"NO_COLOR": "1", "PYTHONPATH": os.pathsep.join([str(DOCS.parent), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | settings, check=True)
    text = re.sub(r"^Example: (.*)$", r"Example: `\1`", done.stdout, flags=re.MULTILINE)
    text = re.sub(r"^# .*\n+", "", text, count=1)
    return "\n".join(line.rstrip() for line in text.strip().splitlines())


def _constant(value: Any) -> str:
    """What a constant is: the columns of a form of tables, the keys of a dictionary, or its value."""
    if hasattr(value, "columns"):
        return f"Form of a table with the columns {', '.join(' or '.join(some) for some in value.columns)}."
    keys = len(str(value)) > 200 and [f"`{key}`" for key in value]
    return f"Records by the keys {keys[0]} to {keys[-1]}." if keys else f"`{value}`"


def names(room: str) -> str:
    """The public names of a room with the first sentence of each, as a table."""
    module = importlib.import_module(f"plgwear_jax.{room}" if room != "plgwear_jax" else room)
    lines = ["| name | what it is |", "| --- | --- |"]
    for name in module.__all__:
        value = getattr(module, name)
        said = inspect.getdoc(value) if inspect.isclass(value) or inspect.isroutine(value) else _constant(value)
        first = " ".join(str(said).partition("\n\n")[0].split()).replace("|", "&#124;")
        lines.append(f"| `{name}` | {first} |")
    return "\n".join(lines)


# --- what stands in the pages -----------------------------------------------------------------------------------------

GENERATED = {
    "keys of an input file": input_keys,
    "quantities": quantities,
    "fewest digits": fewest_digits,
    "random contacts": random_contacts,
    "rule on coatings": rule_on_coatings,
    "commands": commands,
}
FILLED = re.compile(r"(?P<head><!-- begin: (?P<name>[^\n]+?) -->\n).*?(?P<tail><!-- end -->)", re.DOTALL)


def filled(text: str) -> str:
    """The text with all that is generated, as it is now."""

    def fresh(match: re.Match[str]) -> str:
        kind, _, path = match["name"].rpartition(" ")
        if kind == "file":
            shown = (DOCS.parent / path).read_text(encoding="utf-8").rstrip()
            shown = f"```{'toml' if path.endswith('.toml') else 'text'}\n{shown}\n```"
        elif kind == "names of":
            shown = names(path)
        elif kind == "table of":
            rows = (DOCS / path).read_text(encoding="utf-8").splitlines()
            shown = "\n".join(row for row in rows if row.startswith("|"))
        else:
            shown = GENERATED[match["name"]]()
        if shown is None:
            return match[0]
        return f"{match['head']}\n{shown.strip()}\n\n{match['tail']}"

    return FILLED.sub(fresh, text)


def words(text: str) -> tuple[int, int]:
    """The words of a page: all, and those of the text without code, displayed formulas and what is generated."""
    text = re.sub(r"<!-- (?!begin|end).*?-->", "", text, flags=re.DOTALL)
    by_hand = re.sub(r"```.*?```|\$\$.*?\$\$|^\{ ?\.\w+ ?\}$", "", FILLED.sub("", text), flags=re.DOTALL | re.MULTILINE)
    return len(text.split()), len(by_hand.split())


def pages() -> list[Path]:
    """The README, what the site takes from beside it, and all pages."""
    beside = [DOCS.parent / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
    return [*beside, *sorted(DOCS.rglob("*.md"))]


def main() -> int:
    """Refresh what pages quote, and name those that have changed; or count their words."""
    told = []
    for page in pages():
        name, text = page.relative_to(DOCS.parent), page.read_text(encoding="utf-8")
        if "--words" in sys.argv:
            told.append((*words(text), name))
            print("{:6d} {:6d}  {}".format(*told[-1]))
            continue
        fresh = filled(quoted(text))
        if "--printed" in sys.argv:
            fresh = printed(fresh, page.parent)
        if fresh != text:
            page.write_text(fresh, encoding="utf-8")
            print(name)
    if told:
        print(
            "{:6d} {:6d}  all; the second column without code, displayed formulas and what is generated".format(
                *(sum(one[n] for one in told) for n in (0, 1))
            )
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
