"""All benchmarks one after another, or those that are named, quick settings by default: `make bench`, or

    python benchmarks
    python benchmarks digits size --full

Each runs in a process of its own, which pins itself to one core where it takes times.
"""

import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Annotated

import typer

HERE = Path(__file__).resolve().parent
DOCS, BUILD = HERE.parent / "docs" / "benchmarks", HERE.parent / "build" / "benchmarks"
PROGRAMS = {  # with the tables of each
    "closed_forms": "digits kernels size",
    "waits": "first_answer waits matrix startup",
    "extremes": "extremes",
    "designs": "designs",
    "numeric": "surfaces random_contacts",
    "cycles": "transient rigs",
    "coatings": "rule pairs",
    "stresses": "stresses tamaas",
    "sweep": "sweep",
}
TABLES = {table: program for program, tables in PROGRAMS.items() for table in tables.split()}
SLOW = {"matrix", "startup", "tamaas"}  # by name alone; the last one needs a package of this name


def main(
    names: Annotated[list[str] | None, typer.Argument(help="Names of tables; by default all.")] = None,
    full: Annotated[bool, typer.Option("--full", help="All points and rounds, as for numbers to be quoted.")] = False,
) -> None:
    """Run the benchmarks; each table is NAME.txt, some with a picture, NAME.png, in docs/benchmarks if full."""
    failed, begin = [], time.perf_counter()
    options = ["--out", str(DOCS)] if full else ["--out", str(BUILD), "--quick"]
    for name in names or [table for table in TABLES if table not in SLOW]:
        if name not in TABLES:
            raise typer.BadParameter(f"{name}: there is no such table; there are {', '.join(TABLES)}")
        start, used = time.perf_counter(), _processor()
        print(f"\n=== {name} ===", flush=True)
        command = [sys.executable, str(HERE / f"{TABLES[name]}.py"), name, *options]
        if subprocess.run(command, check=False).returncode:
            failed.append(name)
        print(f"{name}: {time.perf_counter() - start:.0f} s, {_processor() - used:.0f} s of processor", flush=True)
    print(f"\nall: {time.perf_counter() - begin:.0f} s")
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
        raise typer.Exit(1)


def _processor() -> float:
    """Seconds that all processes together have used that were started here and have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return children.ru_utime + children.ru_stime


if __name__ == "__main__":
    typer.run(main)
