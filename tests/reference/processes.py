"""Programs in processes of their own."""

import os
import subprocess
import sys
from pathlib import Path

import plgwear_jax


def python(*arguments, without=(), limit=3000.0, **variables):
    """What Python does with these arguments and variables, and `without` those that begin so."""
    path = os.pathsep.join([str(Path(plgwear_jax.__file__).parents[1]), *sys.path])  # with the folders of the tests
    known = {name: value for name, value in os.environ.items() if not name.startswith(without)}
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env=known | {"PYTHONPATH": path} | variables,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=limit,
    )


def output(*arguments, **how):
    """What it prints if it succeeds."""
    done = python(*arguments, **how)
    assert done.returncode == 0, done.stderr
    return done.stdout
