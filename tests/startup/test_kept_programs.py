"""Programs that are kept in files: the same numbers, fewer compilations, whatever happens to the files."""

import os
import shutil
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from marks import parametrize
from processes import python

import plgwear_jax
from plgwear_jax._core.startup import programs


@pytest.fixture(autouse=True)
def afterwards(monkeypatch):
    monkeypatch.setenv("PLGWEAR_STARTUP", "kept,levels,derivatives")  # or NumPy would run these small programs
    least = jax.config.jax_persistent_cache_min_compile_time_secs
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 1e9)  # what JAX's cache has read cannot be kept
    yield
    jax.config.update("jax_persistent_cache_min_compile_time_secs", least)


@programs.program(static=1)
def scaled(name, of, by):
    return jnp.sin(of[name]) * by


@programs.program()
def factored(matrix):
    """By LAPACK, which a process that only loads programs has not looked for."""
    return jnp.linalg.cholesky(matrix)


GIVEN = ("x", {"x": np.linspace(0.0, 1.0, 5), "y": 2.0}, 3.0)


def test_the_same_numbers_with_and_without(tmp_path):
    plain = scaled(*GIVEN)
    for _ in range(2):
        programs.keep_in(tmp_path / "kept", 2**20)
        found = scaled(*GIVEN)
        assert found.dtype == plain.dtype and np.array_equal(found, plain)
    assert len(list((tmp_path / "kept").iterdir())) == 1


def test_each_kind_of_arguments_has_one_program(tmp_path):
    programs.keep_in(tmp_path, 2**20)

    def made(*given):
        scaled(*given)
        return len(list(tmp_path.iterdir()))

    assert made(*GIVEN) == 1
    assert made("x", {"x": np.ones(5), "y": 0.5}, -1.0) == 1
    assert made("y", *GIVEN[1:]) == 2
    assert made("x", {"x": np.ones(6), "y": 0.5}, 1.0) == 3


def test_a_part_of_another_program_is_not_kept(tmp_path):
    programs.keep_in(tmp_path, 2**20)
    assert np.array_equal(jax.jit(scaled, static_argnums=0)(*GIVEN), jnp.sin(GIVEN[1]["x"]) * 3.0)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_another_process_removes_changes_nothing(tmp_path, monkeypatch):
    plain, listed = scaled(*GIVEN), Path.iterdir
    programs._house()
    monkeypatch.setattr(Path, "iterdir", lambda folder: iter([folder / "of another", *listed(folder)]))
    programs.keep_in(tmp_path / "kept", 2**20)
    assert np.array_equal(scaled(*GIVEN), plain)


IN_ANOTHER_PROCESS = """
import jax, sys, test_kept_programs as t
from pathlib import Path
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_log_compiles", True)
t.programs.keep_in(Path(sys.argv[1]), 2**20)
print(t.scaled(*t.GIVEN).tolist())
print(t.factored(4.0 * t.np.eye(3)).tolist())
"""


@pytest.mark.compiled
def test_another_process_does_not_compile(tmp_path):
    done = [python("-c", IN_ANOTHER_PROCESS, tmp_path / "kept", without=("JAX_",)) for _ in range(2)]
    assert done[0].stdout == done[1].stdout
    for name in ("scaled", "factored"):
        assert [f"Finished XLA compilation of jit({name})" in one.stderr for one in done] == [True, False]


def test_what_was_not_used_for_longest_makes_room(tmp_path):
    def kept():
        return {file.name for file in tmp_path.iterdir()}

    def ask(size):
        before = kept()
        programs.keep_in(tmp_path, most)
        scaled("x", {"x": np.ones(size)}, 1.0)
        return kept() - before

    most = 2**20
    (first,) = ask(1)
    size = (tmp_path / first).stat().st_size
    (second,) = ask(2)
    for name, when in ((first, 1000), (second, 2000)):
        os.utime(tmp_path / name, (when, when))
    assert ask(1) == set() and (tmp_path / first).stat().st_mtime > 2000  # used now
    most = int(2.5 * size)
    (third,) = ask(3)
    assert kept() == {first, third}
    most = size // 2
    ask(4)
    assert kept() == set()  # too large itself


@parametrize("name", ["write_bytes", "mkdir", "read_bytes"])
def test_a_disk_that_refuses_changes_nothing(tmp_path, monkeypatch, name):
    def refuses(*_, **__):
        raise OSError(28, "No space left on device")

    plain = scaled(*GIVEN)
    programs._house()  # reads the source
    programs.keep_in(tmp_path, 2**20)
    if name == "read_bytes":
        scaled(*GIVEN)
        programs.keep_in(tmp_path, 2**20)
    with monkeypatch.context() as patched:
        patched.setattr(Path, name, refuses)
        assert np.array_equal(scaled(*GIVEN), plain)
    assert not [file for file in tmp_path.iterdir() if file.name.endswith(".part")]


def test_other_source_machines_and_settings_have_other_programs(tmp_path, monkeypatch):
    house = programs._house.__wrapped__
    first = house()
    assert house() == first
    for name, value in {"XLA_FLAGS": "--xla_cpu_enable_fast_math=true", "PLGWEAR_STARTUP": "kept"}.items():
        with monkeypatch.context() as patched:
            patched.setenv(name, value)
            assert house() != first
    with monkeypatch.context() as patched:
        patched.setattr(programs.platform, "node", lambda: "another")
        assert house() != first
    shutil.copytree(Path(plgwear_jax.__file__).parent, tmp_path / "copy", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(programs, "__file__", str(tmp_path / "copy" / "_core" / "startup" / "programs.py"))
    assert house() == first
    with (tmp_path / "copy" / "fretting" / "__init__.py").open("a") as file:
        file.write("#")
    assert house() != first
