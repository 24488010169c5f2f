"""All benchmarks one after another, quick settings by default: `python benchmarks`, or `make bench`.

Each runs in a process of its own, which pins itself to one core where it takes times.
"""

import subprocess
import sys
import time
from pathlib import Path
from typing import Annotated

import typer

HERE = Path(__file__).resolve().parent
PROGRAMS = (
    "wear_volume",
    "kernels",
    "digits",
    "size",
    "first_call",
    "first_answer",
    "quantities",
    "extremes",
    "designs",
)


def main(
    full: Annotated[bool, typer.Option("--full", help="All points and rounds, as for numbers to be quoted.")] = False,
    out: Annotated[
        Path | None, typer.Option(help="Where tables and pictures go.", show_default="docs/benchmarks")
    ] = None,
    only: Annotated[str, typer.Option(help="Programs whose name contains this.")] = "",
) -> None:
    """Run the benchmarks; each writes NAME.txt and NAME.png."""
    options = [*([] if full else ["--quick"]), *(["--out", str(out)] if out else [])]
    failed = []
    for name in PROGRAMS:
        program = HERE / f"{name}.py"
        if only not in name or not program.exists():
            continue
        start = time.perf_counter()
        print(f"\n=== {name} ===", flush=True)
        if subprocess.run([sys.executable, str(program), *options], check=False).returncode:
            failed.append(name)
        print(f"{name}: {time.perf_counter() - start:.0f} s", flush=True)
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
        raise typer.Exit(1)


if __name__ == "__main__":
    typer.run(main)
