"""Programs that are compiled ahead and kept: the same numbers, fewer compilations, whatever happens to the files."""

import os
import shutil
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import plgwear_jax
from plgwear_jax._startup import programs


@pytest.fixture(autouse=True)
def afterwards(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(programs._Compiler, "begun_here", {})
    least = jax.config.jax_persistent_cache_min_compile_time_secs
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 1e9)  # what JAX's cache has read cannot be kept
    yield
    jax.config.update("jax_persistent_cache_min_compile_time_secs", least)


@programs.program(static=1)
def scaled(name: str, of: dict[str, jax.Array], by: jax.Array) -> jax.Array:
    return jnp.sin(of[name]) * by


@programs.program()
def factored(matrix: jax.Array) -> jax.Array:
    """By LAPACK, which a process that only loads programs has not looked for."""
    return jnp.linalg.cholesky(matrix)


GIVEN = ("x", {"x": np.linspace(0.0, 1.0, 5), "y": 2.0}, 3.0)


def test_the_same_numbers_with_and_without(tmp_path):
    plain = scaled(*GIVEN)
    for folder in (None, tmp_path / "kept", tmp_path / "kept"):
        programs._Compiler.begun_here.clear()
        programs.ahead(folder, 2**20)
        found = scaled(*GIVEN)
        programs.settle()
        assert found.dtype == plain.dtype and np.array_equal(found, plain)
    assert len(list((tmp_path / "kept").iterdir())) == 1


def test_what_has_begun_is_not_compiled_again(monkeypatch):
    compiled, compile_it = [], programs._Compiler._compiled

    def counted(compiler, key, lowered):
        compiled.append(key)
        return compile_it(compiler, key, lowered)

    monkeypatch.setattr(programs._Compiler, "_compiled", counted)
    scaled.begin(*GIVEN)
    assert not compiled  # nobody asked for it
    programs.ahead()
    scaled.begin(*GIVEN)
    programs.settle()
    assert len(compiled) == 1
    scaled(*GIVEN)
    scaled("x", {"x": np.ones(5), "y": 0.5}, -1.0)
    assert len(compiled) == 1
    scaled("y", *GIVEN[1:])
    scaled("x", {"x": np.ones(6), "y": 0.5}, 1.0)
    assert len(compiled) == len(set(compiled)) == 3


class Ending(ThreadPoolExecutor):
    """Threads that take no more work from each other, as when Python ends."""

    def submit(self, function, /, *given, **named):
        if threading.current_thread() is not threading.main_thread():
            raise RuntimeError("cannot schedule new futures after interpreter shutdown")
        return super().submit(function, *given, **named)


def test_what_has_begun_is_kept_though_python_ends(tmp_path, monkeypatch):
    monkeypatch.setattr(programs._Compiler, "threads", Ending(1))
    programs.ahead(tmp_path / "kept", 2**20)
    scaled.begin(*GIVEN)
    programs.settle()
    assert len(list((tmp_path / "kept").iterdir())) == 1


def test_a_file_that_another_process_removes_changes_nothing(tmp_path, monkeypatch):
    listed = Path.iterdir
    programs._house()
    with monkeypatch.context() as patched:
        patched.setattr(Path, "iterdir", lambda folder: iter([folder / "of another", *listed(folder)]))
        programs.ahead(tmp_path / "kept", 2**20)
        scaled(*GIVEN)
        programs.settle()
    assert len(list((tmp_path / "kept").iterdir())) == 1


IN_ANOTHER_PROCESS = """
import jax, sys, test_ahead as t
from pathlib import Path
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_log_compiles", True)
t.programs.ahead(Path(sys.argv[1]), 2**20)
print(t.scaled(*t.GIVEN).tolist())
print(t.factored(4.0 * t.np.eye(3)).tolist())
"""


@pytest.mark.compiled
def test_another_process_does_not_compile(tmp_path):
    variables = {name: value for name, value in os.environ.items() if not name.startswith("JAX_")}
    done = [
        subprocess.run(
            [sys.executable, "-c", IN_ANOTHER_PROCESS, str(tmp_path / "kept")],
            env=variables | {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])},
            capture_output=True,
            text=True,
            check=True,
        )
        for _ in range(2)
    ]
    assert done[0].stdout == done[1].stdout
    for name in ("scaled", "factored"):
        assert [f"Finished XLA compilation of jit({name})" in one.stderr for one in done] == [True, False]


def test_what_was_not_used_for_longest_makes_room(tmp_path):
    def kept():
        return {file.name for file in tmp_path.iterdir()}

    def ask(size: int) -> set[str]:
        before = kept()
        programs._Compiler.begun_here.clear()
        scaled("x", {"x": np.ones(size)}, 1.0)
        programs.settle()
        return kept() - before

    programs.ahead(tmp_path, 2**20)
    (first,) = ask(1)
    size = (tmp_path / first).stat().st_size
    (second,) = ask(2)
    for name, when in ((first, 1000), (second, 2000)):
        os.utime(tmp_path / name, (when, when))
    assert ask(1) == set() and (tmp_path / first).stat().st_mtime > 2000  # used now
    programs.ahead(tmp_path, int(2.5 * size))
    (third,) = ask(3)
    assert kept() == {first, third}
    programs.ahead(tmp_path, size // 2)
    ask(4)
    assert kept() == set()  # too large itself


@pytest.mark.parametrize("name", ["write_bytes", "mkdir", "read_bytes"])
def test_a_disk_that_refuses_changes_nothing(tmp_path, monkeypatch, name):
    def refuses(*_, **__):
        raise OSError(28, "No space left on device")

    plain = scaled(*GIVEN)
    programs._house()  # reads the source
    programs.ahead(tmp_path, 2**20)
    if name == "read_bytes":
        scaled(*GIVEN)
        programs.settle()
        programs._Compiler.begun_here.clear()
    with monkeypatch.context() as patched:
        patched.setattr(Path, name, refuses)
        assert np.array_equal(scaled(*GIVEN), plain)
        programs.settle()
    assert not [file for file in tmp_path.iterdir() if file.name.endswith(".part")]


def test_other_source_machines_and_settings_have_other_programs(tmp_path, monkeypatch):
    house = programs._house.__wrapped__
    first = house()
    assert house() == first
    with monkeypatch.context() as patched:
        patched.setenv("XLA_FLAGS", "--xla_cpu_enable_fast_math=true")
        assert house() != first
    with monkeypatch.context() as patched:
        patched.setattr(programs.platform, "node", lambda: "another")
        assert house() != first
    with monkeypatch.context() as patched:
        package = Path(plgwear_jax.__file__).parent
        shutil.copytree(package, tmp_path / "copy", ignore=shutil.ignore_patterns("__pycache__"))
        patched.setattr(programs, "__file__", str(tmp_path / "copy" / "_core" / "programs.py"))
        assert house() == first
        with (tmp_path / "copy" / "fretting" / "__init__.py").open("a") as file:
            file.write("#")
        assert house() != first
