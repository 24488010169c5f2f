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
OUT = {"--full": HERE.parent / "docs" / "benchmarks", "--quick": HERE.parent / "build" / "benchmarks"}
PROGRAMS = (
    "wear_volume",
    "kernels",
    "digits",
    "size",
    "first_call",
    "first_answer",
    "waits",
    "quantities",
    "extremes",
    "designs",
    "life_designs",
    "surfaces",
    "random_contacts",
    "transient",
    "rigs",
    "matrix",
    "sweep",
)


def main(
    names: Annotated[
        list[str] | None,
        typer.Argument(help=f"Which ones of {', '.join(PROGRAMS)}; by default all.", show_default=False),
    ] = None,
    full: Annotated[bool, typer.Option("--full", help="All points and rounds, as for numbers to be quoted.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Where tables and pictures go.", show_default="docs/benchmarks if full, else build/benchmarks"
        ),
    ] = None,
) -> None:
    """Run the benchmarks; each writes NAME.txt and most of them a picture, NAME.png."""
    for name in names or ():
        if name not in PROGRAMS:
            print(f"{name}: there is no such benchmark; there are {', '.join(PROGRAMS)}", file=sys.stderr)
            raise typer.Exit(2)
    options = ["--out", str(out or OUT["--full" if full else "--quick"]), *([] if full else ["--quick"])]
    failed, begin = [], time.perf_counter()
    for name in names or PROGRAMS:
        start, used = time.perf_counter(), _processor()
        print(f"\n=== {name} ===", flush=True)
        if subprocess.run([sys.executable, str(HERE / f"{name}.py"), *options], check=False).returncode:
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
