"""Plants errors in the mechanics, one at a time, and tells which of them the default tests notice.

    python tools/mutants.py                                               # 200 errors, drawn at random; hours
    python tools/mutants.py --count 40 --seed 2 --only surfaces
    python tools/mutants.py --plant shapes/powers.py '2.0 * p' '2.1 * p'  # this error, where the text stands first
    python tools/mutants.py --quick                                       # without files that cannot notice it
    python tools/mutants.py --again                                       # those once more that nothing noticed

An error is a wrong sign, a factor of 1.05, a product for a quotient, a term left out, or a comparison turned round. It
is planted in a copy of the repository in the temporary folder; nothing is written anywhere else. None is planted where
it would change nothing or the effort alone: in numbers of modules in capital letters (counts of cells, tolerances), in
factors of 0, in numbers below 0.01 or above 100, and in those that `where` puts in place of others. Files of tests run
until a test fails: first those that execute the function with the error, those of its room before others, then all that
are left, and quick ones before slow ones. Which functions a file executes is found once, by running it. What is known
stays in the temporary folder, so that a run that was interrupted goes on where it stopped.

`mutants.csv` has the errors that change nothing, each with its reason; all others that nothing notices show what the
tests lack. This is not mutmut or cosmic-ray: these plant no factors, draw no samples and write into the working tree.
"""

import argparse
import ast
import concurrent.futures
import csv
import hashlib
import itertools
import json
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = "plgwear_jax"

# The rooms in which errors are planted, and the folders of their tests.
ROOMS = {
    "fretting": ("fretting",),
    "gross_slip": ("fretting",),
    "material": ("fretting",),
    "partial_slip": ("fretting",),
    "special": ("fretting", "core", "contact"),
    "steady": ("steady", "contact"),
    "surfaces": ("steady", "contact"),
    "shapes": ("steady", "contact"),
    "wear": ("wear", "contact"),
    "optimise": ("optimise",),
    "fitting": ("fitting",),
    "coating": ("fitting",),
    "contact": ("contact",),
    "loads": ("wear", "contact"),
    "stresses": ("stresses",),
    "wear_laws": ("wear", "fitting"),
}

# --- which errors there are ------------------------------------------------------------------------------------------

_TURNED = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_MIRROR = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_SIGNS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+")}
_FACTORS = {ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
_NO_MECHANICS = ast.Raise, ast.Assert, ast.JoinedStr, ast.Import, ast.ImportFrom
_TEXTS = ast.JoinedStr, ast.List, ast.Tuple, ast.Starred, ast.Dict


class Error(NamedTuple):
    """An error that can be planted."""

    path: str  # within the package
    function: str  # that it is in, by its qualified name
    kind: str
    begin: int  # where the text to be replaced is, in bytes
    end: int
    old: str
    new: str
    place: int  # among those that read the same in the function

    @property
    def key(self) -> str:
        """What tells it apart, also after the file has changed elsewhere."""
        return "|".join((self.path, self.function, self.kind, self.old, self.new, str(self.place)))

    @property
    def told(self) -> str:
        """For a table."""
        shown = (" ".join(text.split()) for text in (self.old, self.new))
        return f"{self.path} {self.function}: {self.kind}: {' -> '.join(shown)}"


class _Finder(ast.NodeVisitor):
    """All errors that a source can have."""

    def __init__(self, path: str, source: bytes):
        self.path, self.source, self.found = path, source, []
        lengths = [len(line) for line in source.splitlines(keepends=True)]
        self.lines = list(itertools.accumulate(lengths, initial=0))
        self.inside: list[str] = []
        self.functions: list[tuple[int, int, str]] = []

    def span(self, node: Any) -> tuple[int, int]:
        return (
            self.lines[node.lineno - 1] + node.col_offset,
            self.lines[node.end_lineno - 1] + node.end_col_offset,
        )

    def text(self, node: Any) -> str:
        begin, end = self.span(node)
        return self.source[begin:end].decode()

    def add(self, kind: str, node: Any, new: str) -> None:
        old, function = self.text(node), self.name
        same = sum((e.function, e.kind, e.old, e.new) == (function, kind, old, new) for e in self.found)
        self.found.append(Error(self.path, function, kind, *self.span(node), old, new, same))

    @property
    def name(self) -> str:
        """That of the innermost function."""
        return ".".join(self.inside).removesuffix(".<locals>")

    def visit(self, node: Any) -> None:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            before, self.inside = self.inside, [*self.inside, node.name]
            self.functions.append((*self.span(node), self.name))
            self.inside += ["<locals>"] * isinstance(node, ast.FunctionDef)
            for part in node.body:
                self.visit(part)
            self.inside = before
        elif not isinstance(node, _NO_MECHANICS):
            super().visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def with_sign(self, node: ast.expr, left: ast.expr, right: ast.expr, old: str, new: str) -> str:
        """The text with another sign between two operands, whose parentheses belong to the whole."""
        places = self.span(node)[0], self.span(left)[1], self.span(right)[0], self.span(node)[1]
        head, gap, tail = (self.source[begin:end].decode() for begin, end in itertools.pairwise(places))
        return f"({head}{gap.replace(old, new, 1)}{tail})"

    def visit_Call(self, node: ast.Call) -> None:
        if getattr(node.func, "attr", "") == "where":  # a number here stands in for what nobody reads
            for part in node.args:
                if not isinstance(part, ast.Constant):
                    self.visit(part)
        else:
            self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        self.generic_visit(node)
        sides = node.left, node.right
        found = _SIGNS.get(type(node.op)) or _FACTORS.get(type(node.op))
        if found is None or any(map(_is_text, sides)) or any(map(_is_effort, sides)):
            return
        left, right, whole = *map(self.text, sides), self.text(node)
        turned = self.with_sign(node, *sides, *found)
        if type(node.op) in _SIGNS:
            self.add("sign", node, turned)
            self.add("term", node, f"({left})")
            self.add("term", node, f"({right})" if found[0] == "+" else f"(-({right}))")
        else:
            self.add("quotient", node, turned)
            self.add("factor", node, f"(1.05 * ({whole}))")

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        self.generic_visit(node)
        if isinstance(node.op, ast.USub) and not _is_effort(node.operand):
            self.add("sign", node, f"({self.text(node.operand)})")

    def visit_Compare(self, node: ast.Compare) -> None:
        self.generic_visit(node)
        sign = _TURNED.get(type(node.ops[0]))
        if sign and len(node.ops) == 1:
            turned = self.with_sign(node, node.left, node.comparators[0], sign, _MIRROR[sign])
            self.add("comparison", node, turned)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, float) and 1e-2 <= node.value <= 1e2:
            self.add("factor", node, repr(float(f"{1.05 * node.value:.12g}")))


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, _TEXTS) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _is_effort(node: ast.expr) -> bool:
    """Whether it is 0 or infinity, or a number of a module in capital letters, or an attribute of such."""
    while isinstance(node, ast.Attribute | ast.Subscript | ast.Call):
        if isinstance(node, ast.Attribute) and node.attr == "inf":
            return True
        node = node.func if isinstance(node, ast.Call) else node.value
    if isinstance(node, ast.Constant):
        return node.value == 0.0
    return isinstance(node, ast.Name) and len(node.id) > 2 and node.id.isupper()


def errors_in(path: str, source: bytes) -> list[Error]:
    """All errors that a file can have."""
    finder = _Finder(path, source)
    finder.visit(ast.parse(source))
    return finder.found


def room_of(path: str) -> str:
    """The room of a file within the package."""
    return path.split("/")[0].removesuffix(".py")


def all_errors() -> list[Error]:
    """Those of all rooms."""
    package = ROOT / PACKAGE
    files = (file for file in sorted(package.rglob("*.py")) if room_of(file.relative_to(package).as_posix()) in ROOMS)
    return [e for file in files for e in errors_in(file.relative_to(package).as_posix(), file.read_bytes())]


def drawn(errors: list[Error], seed: int) -> list[Error]:
    """In random order, which does not change where files change elsewhere."""
    return sorted(errors, key=lambda error: hashlib.sha256(f"{seed} {error.key}".encode()).digest())


def planted(error: Error, source: bytes) -> bytes:
    """The source with the error."""
    if source[error.begin : error.end].decode() != error.old:
        raise ValueError(f"{error.path} has changed: {error.told}")
    return source[: error.begin] + error.new.encode() + source[error.end :]


def given(path: str, old: str, new: str) -> Error:
    """The error that someone names: the first of these texts in a file, by another one."""
    source = (ROOT / PACKAGE / path).read_bytes()
    begin = source.find(old.encode())
    if begin < 0:
        raise SystemExit(f"{path} has no {old!r}")
    finder = _Finder(path, source)
    finder.visit(ast.parse(source))
    around = [name for first, last, name in finder.functions if first <= begin < last]
    return Error(path, around[-1] if around else "", "given", begin, begin + len(old.encode()), old, new, 0)


# --- within pytest: which functions a file executes, and the order of the tests --------------------------------------

_FOLDER = "JAX_COMPILATION_CACHE_DIR"


def pytest_configure(config: Any) -> None:
    """As a plugin: what is compiled serves all runs; functions are told to a file."""
    config.stash_of_mutants = os.environ[_FOLDER]
    os.environ[_FOLDER] = os.environ["MUTANTS_COMPILED"]
    if "MUTANTS_TRACE" in os.environ:
        seen: set[Any] = set()
        config.seen_of_mutants = seen
        sys.settrace(lambda frame, event, argument: seen.add(frame.f_code))


def pytest_sessionfinish(session: Any) -> None:
    """The folder of this run is what goes with it."""
    sys.settrace(None)
    os.environ[_FOLDER] = session.config.stash_of_mutants
    if "MUTANTS_TRACE" in os.environ:
        package = str(Path.cwd() / PACKAGE) + os.sep
        seen = {(c.co_filename, c.co_qualname) for c in session.config.seen_of_mutants}
        told = sorted({(f.removeprefix(package), q) for f, q in seen if f.startswith(package)})
        Path(os.environ["MUTANTS_TRACE"]).write_text(json.dumps(told))


# --- running tests ----------------------------------------------------------------------------------------------------


class File(NamedTuple):
    """A file of tests, in the state without errors."""

    digest: str
    passes: bool
    seconds: float
    functions: list[tuple[str, str]]  # (file within the package, qualified name)


class Place:
    """The temporary folder."""

    def __init__(self) -> None:
        name = hashlib.sha256(str(ROOT).encode()).hexdigest()[:8]
        self.folder = Path(tempfile.gettempdir()) / f"plgwear-mutants-{name}"
        self.compiled, self.traces, self.results = (self.folder / x for x in ("compiled", "traces", "results.jsonl"))
        for folder in (self.compiled, self.traces):
            folder.mkdir(parents=True, exist_ok=True)
        self.running: set[int] = set()

    def copy(self, number: int) -> Path:
        """A copy of the repository as it is now."""
        listed = subprocess.run(
            ["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True
        )
        target = self.folder / f"copy-{number}"
        wanted = {name for name in listed.stdout.splitlines() if (ROOT / name).is_file()}
        for old in target.rglob("*") if target.exists() else ():
            if old.is_file() and old.relative_to(target).as_posix() not in wanted and "__pycache__" not in old.parts:
                old.unlink()
        for name in wanted:
            source, copy = ROOT / name, target / name
            if not copy.exists() or copy.read_bytes() != source.read_bytes():
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, copy)
        return target

    def pytest(self, copy: Path, files: list[str], limit: float, **more: str) -> tuple[int | None, str]:
        """(How pytest ends on these files, None after so many seconds; the test that fails)."""
        path = os.pathsep.join([str(copy), str(copy / "tools")])
        own = {"PYTHONPATH": path, "MUTANTS_COMPILED": str(self.compiled), "PLGWEAR_SEED": "20240229"}
        options = ["-x", "-q", "-p", "mutants", "-p", "no:cacheprovider", "-p", "no:xdist", "--tb=no", "-rfE"]
        process = subprocess.Popen(
            [sys.executable, "-m", "pytest", *options, *files],
            cwd=copy,
            env=os.environ | own | more,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,  # what it has started ends with it
        )
        self.running.add(process.pid)
        try:
            said, _ = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return None, "takes too long"
        finally:
            self.running.discard(process.pid)
        lines = [line for line in said.splitlines() if line.startswith(("FAILED ", "ERROR "))]
        return process.returncode, lines[0].split(" - ")[0] if lines else said[-200:].strip()

    def known(self) -> dict[str, dict[str, Any]]:
        """The results so far, by the keys of the errors."""
        if not self.results.exists():
            return {}
        rows = [json.loads(line) for line in self.results.read_text().splitlines()]
        return {row["key"]: row for row in rows}

    def keep(self, row: dict[str, Any]) -> None:
        """Remember a result."""
        with self.results.open("a") as file:
            file.write(json.dumps(row) + "\n")


def traced(place: Place, copy: Path, test: str) -> File:
    """What a file of tests executes, by running it, unless that is known."""
    digest = hashlib.sha256((copy / test).read_bytes()).hexdigest()
    kept = place.traces / (test.replace("/", "-") + ".json")
    if kept.exists():
        found = json.loads(kept.read_text())
        if found["digest"] == digest:
            return File(**found)
    told = place.folder / f"seen-{test.replace('/', '-')}.json"
    told.unlink(missing_ok=True)
    start = time.perf_counter()
    code, said = place.pytest(copy, [test], 3600.0, MUTANTS_TRACE=str(told))
    functions = json.loads(told.read_text()) if told.exists() else []
    found = File(digest, code in (0, 5), time.perf_counter() - start, functions)
    print(
        f"{test}: {'passes' if found.passes else said}, {found.seconds:.0f} s, {len(functions)} functions", flush=True
    )
    kept.write_text(json.dumps(found._asdict()))
    told.unlink(missing_ok=True)
    return found


def stages(error: Error, files: dict[str, File], whole: bool) -> list[list[str]]:
    """The files of tests in the order in which they are run, some at a time; if not all, those that execute it."""

    # A constant of a module counts wherever anything of the module is executed.
    def executes(file: File) -> bool:
        own = [tuple(function) for function in file.functions]
        return (error.path, error.function) in own if error.function else any(path == error.path for path, _ in own)

    def order(test: str) -> tuple[bool, bool, float]:
        near = test.split("/")[1] in ROOMS.get(room_of(error.path), ())
        return not executes(files[test]), not near, files[test].seconds

    sorted_files = sorted(
        (test for test in files if files[test].passes and (whole or executes(files[test]))), key=order
    )
    groups = [list(group) for _, group in itertools.groupby(sorted_files, key=lambda test: order(test)[:2])]
    return [part for group in groups for part in _parts(group, files)]


def _parts(group: list[str], files: dict[str, File]) -> Iterator[list[str]]:
    """Files that together take a minute or so: to start a process takes three seconds."""
    part: list[str] = []
    for test in group:
        part.append(test)
        if sum(files[one].seconds for one in part) > 60.0:
            yield part
            part = []
    if part:
        yield part


def tried(place: Place, copy: Path, error: Error, files: dict[str, File], whole: bool) -> dict[str, Any]:
    """Plant an error and run tests until one fails."""
    target, start = copy / PACKAGE / error.path, time.perf_counter()
    source = target.read_bytes()
    noticed, run = None, 0
    try:
        target.write_bytes(planted(error, source))
        for part in stages(error, files, whole):
            run += len(part)
            limit = 120.0 + 5.0 * sum(files[test].seconds for test in part)
            code, said = place.pytest(copy, part, limit)
            if code not in (0, 5):
                noticed = said
                break
    finally:
        target.write_bytes(source)
    taken = round(time.perf_counter() - start)
    return {"key": error.key, "told": error.told, "noticed": noticed, "files": run, "seconds": taken, "whole": whole}


# --- the command ------------------------------------------------------------------------------------------------------


def reasons() -> dict[str, str]:
    """Why errors change nothing, by their keys."""
    with (ROOT / "tools" / "mutants.csv").open(newline="", encoding="utf-8") as file:
        return {row["error"]: row["reason"] for row in csv.DictReader(file)}


def main() -> None:
    """Plant errors and tell what happens."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=200, help="how many errors")
    parser.add_argument("--seed", type=int, default=1, help="which ones are drawn")
    parser.add_argument("--only", default="", help="only errors whose path contains this text")
    texts = "PATH", "OLD", "NEW"
    parser.add_argument("--plant", nargs=3, metavar=texts, action="append", default=[], help="this error, no others")
    parser.add_argument("--again", action="store_true", help="try those again that nothing noticed")
    parser.add_argument("--quick", action="store_true", help="run only the files that execute the function")
    parser.add_argument("--list", action="store_true", help="say which errors these are, and plant none")
    parser.add_argument("--jobs", type=int, default=2, help="how many errors at the same time")
    asked = parser.parse_args()

    if asked.plant:
        wanted = [given(*one) for one in asked.plant]
    else:
        wanted = drawn([error for error in all_errors() if asked.only in error.path], asked.seed)[: asked.count]
    if asked.list:
        print(*(error.told for error in wanted), sep="\n")
        return

    for ending in (signal.SIGINT, signal.SIGTERM):  # also in the background
        signal.signal(ending, signal.default_int_handler)
    place = Place()
    copies: queue.Queue[Path] = queue.Queue()
    for number in range(asked.jobs):
        copies.put(place.copy(number))
    tests = sorted(file.relative_to(ROOT).as_posix() for file in (ROOT / "tests").rglob("test_*.py"))

    def with_copy(function: Any, *arguments: Any) -> Any:
        copy = copies.get()
        try:
            return function(place, copy, *arguments)
        finally:
            copies.put(copy)

    known, why = place.known(), reasons()
    told = {error.key: known[error.key] for error in wanted if error.key in known}
    left = {
        key for key, row in told.items() if not row["noticed"] and (asked.again or row["whole"] < (not asked.quick))
    }
    told = {key: row for key, row in told.items() if key not in left}
    new = [error for error in wanted if error.key not in told]
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        try:
            files = dict(zip(tests, pool.map(lambda test: with_copy(traced, test), tests), strict=True))
            futures = [pool.submit(with_copy, tried, error, files, not asked.quick) for error in new]
            for number, future in enumerate(concurrent.futures.as_completed(futures), 1):
                row = future.result()
                place.keep(row)
                told[row["key"]] = row
                by = row["noticed"] or why.get(row["key"]) or "NOT NOTICED"
                took = f"{row['files']} files, {row['seconds']} s"
                print(f"{number}/{len(new)} {row['told']}\n      {by}, {took}", flush=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in list(place.running):
                os.killpg(process, signal.SIGKILL)
            raise
    missed = [row for row in told.values() if not row["noticed"]]
    print(f"\n{len(told) - len(missed)} of {len(told)} errors were noticed, {1.0 - len(missed) / len(told):.1%}")
    for row in sorted(missed, key=lambda row: row["told"]):
        print(f"- {row['told']}\n      {why.get(row['key'], 'no reason is known: a test lacks')}\n      {row['key']!r}")


if __name__ == "__main__":
    main()
