"""Programs in processes of their own, or as modules of this one."""

import importlib.util
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


def module_at(path):
    """A module that lies in no package."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
