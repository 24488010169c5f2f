"""What the command line imports for which command, what it keeps for the next one, and how it shows that it works."""

import io
import json
import os
import sys
import zlib
from pathlib import Path
from unittest import mock

import jax
import pytest
from marks import compiled, parametrize
from processes import python
from typer.testing import CliRunner

import plgwear_jax
from plgwear_jax import cli
from plgwear_jax._core.startup import programs
from plgwear_jax._core.units import text_cells
from plgwear_jax.cli import cache, terminal

HEAVY = {"dask", "jax", "jaxlib", "matplotlib", "numpy", "optax", "scipy", "xarray", "zarr"}
SCENE = """
material = { E0 = 110e9, z0 = 1e-4, k = 0.0, nu = 0.3 }
contact = { kind = "fretting", radius = 0.005, normal_force = 10.0, friction = 0.4 }
load = { tangential_force = 0.32 }
output = { quantities = ["contact_radius"] }
"""


@pytest.fixture(autouse=True)
def folder(here, monkeypatch):
    """A folder of one's own with a scene in it, and with a home that has a cache folder."""
    for name in [name for name in os.environ if name.startswith(("JAX_", "PLGWEAR_"))]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("XDG_CACHE_HOME", str(here / "cache"))
    Path("cache").mkdir()
    Path("contact.toml").write_text(SCENE)
    return here


# --- imports --------------------------------------------------------------------------------------------------------

# Runs in a process of its own; after each command it says what has been imported by then.
COMMANDS = """
import json, sys
from typer.testing import CliRunner
from plgwear_jax import cli
for line in sys.argv[1:]:
    result = CliRunner().invoke(cli.app, line.split())
    print(json.dumps([result.exit_code, sorted({name.partition(".")[0] for name in sys.modules})]))
"""


def test_commands_that_compute_nothing_import_nothing_that_computes():
    Path("wrong.toml").write_text(SCENE.replace("friction", "fricton"))
    lines = dict(
        text_cells("""
        --help                              0
        --version                           0
        design --help                       0
        new mine.toml                       0
        schema                              0
        solve wrong.toml                    2
        front missing.toml                  2
        design contact.toml                 2
        design contact.toml --jsn           2
        figures --out drawn --only table-2  2
        plot map.zarr --picture map.bmp     2
        bake                                2
        """)
    )
    done = python("-c", COMMANDS, *lines)
    found = [json.loads(line) for line in done.stdout.splitlines()]
    for (line, code), (ended, imported) in zip(lines.items(), found, strict=True):
        assert (ended, HEAVY & {*imported}) == (int(code), set()), line


def test_completion_imports_nothing_that_computes():
    code = (
        "import sys\n"
        "from plgwear_jax import __main__\n"
        "try:\n    __main__.main()\n"
        "finally:\n    print(sorted(sys.modules), file=sys.stderr)\n"
    )
    done = python("-c", code, _PLGWEAR_COMPLETE="complete_bash", COMP_WORDS="plgwear des", COMP_CWORD="1")
    assert done.stdout.split() == ["design"]
    assert "'plgwear_jax.cli'" in done.stderr and not any(f"'{name}'" in done.stderr for name in HEAVY)


def test_the_package_imports_its_modules_when_they_are_looked_at():
    code = (
        "import sys, pickle, plgwear_jax\n"
        f"heavy = {sorted(HEAVY)}\n"
        "assert not [name for name in heavy if name in sys.modules]\n"
        "assert set(plgwear_jax.__all__) <= set(dir(plgwear_jax))\n"
        "from plgwear_jax import PowerLawGraded, fretting\n"
        "assert 'matplotlib' not in sys.modules and 'xarray' not in sys.modules\n"
        "assert plgwear_jax.fretting is fretting is sys.modules['plgwear_jax.fretting']\n"
        "assert plgwear_jax.PowerLawGraded is PowerLawGraded is plgwear_jax.material.PowerLawGraded\n"
        "assert pickle.loads(pickle.dumps(PowerLawGraded)) is PowerLawGraded\n"
        "assert plgwear_jax.sweep.sweep and 'xarray' in sys.modules\n"
        "import jax\n"
        "assert not jax.config.jax_enable_x64 and jax.config.jax_compilation_cache_dir is None\n"
    )
    done = python("-c", code)
    assert done.returncode == 0, done.stderr
    with pytest.raises(AttributeError, match="has no attribute 'freting'"):
        plgwear_jax.freting


# --- the cache ------------------------------------------------------------------------------------------------------


@pytest.fixture
def settings(monkeypatch):
    """What is set of JAX, in place of setting it."""
    found = {}
    ours = jax.config.jax_compilation_cache_dir
    jax.config.update("jax_compilation_cache_dir", None)
    with monkeypatch.context() as patched:
        patched.setattr(jax.config, "update", found.__setitem__)
        yield found
    jax.config.update("jax_compilation_cache_dir", ours)


def start(one_question=False):
    with terminal.computing("starting", one_question):
        pass


def test_what_is_compiled_is_kept_within_bounds(folder, settings):
    start()
    assert settings == {
        "jax_enable_x64": True,
        "jax_compilation_cache_dir": str(folder / "cache" / "plgwear"),
        "jax_compilation_cache_max_size": cache.MOST,
        "jax_persistent_cache_min_compile_time_secs": 0.0,
        "jax_persistent_cache_min_entry_size_bytes": -1,
        "jax_persistent_cache_enable_xla_caches": "none",
    }
    assert Path("cache/plgwear").stat().st_mode & 0o777 == 0o700


def test_an_option_turns_it_off(settings, monkeypatch):
    monkeypatch.setattr(os, "environ", os.environ.copy())
    for line, variables in ((("--no-cache", "schema"), {}), (("schema",), {"PLGWEAR_NO_CACHE": "1"})):
        assert CliRunner().invoke(cli.app, line, env=variables).exit_code == 0
        start()
        assert settings == {"jax_enable_x64": True} and not os.listdir("cache")
        del os.environ["JAX_ENABLE_COMPILATION_CACHE"]
    assert CliRunner().invoke(cli.app, ["schema"]).exit_code == 0
    start()
    assert "jax_compilation_cache_dir" in settings


@parametrize(
    "variable",
    [
        "JAX_COMPILATION_CACHE_DIR=elsewhere",
        "JAX_ENABLE_COMPILATION_CACHE=false",
        "JAX_COMPILATION_CACHE_MAX_SIZE=1000",
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS=1",
    ],
)
def test_variables_of_jax_decide_instead(settings, monkeypatch, variable):
    monkeypatch.setenv(*variable.split("="))
    start()
    assert settings == {"jax_enable_x64": True} and not os.listdir("cache")


def no_home(place):
    place.parent.rmdir()
    os.environ["XDG_CACHE_HOME"] = str(Path("no/home/.cache").absolute())


def open_to_others(place):
    place.mkdir()
    place.chmod(0o777)


# Also a file in its place, and a lock that cannot be.
@parametrize(
    "make",
    [
        lambda place: place.write_text("mine"),
        no_home,
        open_to_others,
        lambda place: (place / ".lockfile").mkdir(parents=True),
    ],
)
def test_without_a_good_place_nothing_is_kept_and_nothing_said(settings, capsys, make):
    make(Path("cache/plgwear"))
    before = sorted(Path().rglob("*"))
    start()
    assert settings == {"jax_enable_x64": True} and capsys.readouterr() == ("", "")
    assert sorted(Path().rglob("*")) == before


@parametrize("error", [PermissionError(13, "Permission denied"), OSError(30, "Read-only file system")])
def test_a_place_that_cannot_be_written_to_is_left_alone(settings, monkeypatch, error):
    monkeypatch.setattr("filelock.FileLock.acquire", mock.Mock(side_effect=error))
    start()
    assert settings == {"jax_enable_x64": True}


def test_one_question_keeps_its_programs_without_jax(folder, settings, monkeypatch):
    seen = []
    monkeypatch.setattr(programs, "keep_in", lambda *given: seen.append(given))
    start(one_question=True)
    assert settings == {"jax_enable_x64": True} and seen == [
        (None,),
        (folder / "cache" / "plgwear" / "programs", cache.MOST),
    ]
    monkeypatch.setenv("JAX_ENABLE_COMPILATION_CACHE", "false")
    start(one_question=True)
    assert seen[2:] == [(None,)]


def test_halves_of_programs_are_dropped(settings):
    place = Path("cache/plgwear")
    place.mkdir(0o700)
    for name in ("whole-cache", "whole-atime", "half-cache"):
        (place / name).write_bytes(b"")
    start()
    assert {path.name for path in place.iterdir()} - {".lockfile"} == {"whole-cache", "whole-atime"}


@compiled
def test_a_damaged_cache_changes_nothing():
    solve = ("-m", "plgwear_jax", "solve", "contact.toml", "--json")
    first = python(*solve)
    programs = list(Path("cache/plgwear/programs").iterdir())
    assert len(programs) == 1
    whole = programs[0].read_bytes()
    programs[0].write_bytes(whole[:1000] + b"\x00" * 100 + whole[1100:])
    second = python("-W", "error", *solve)
    assert zlib.decompress(programs[0].read_bytes())  # mended
    third = python("-W", "error", *solve)
    for done in (first, second, third):
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout == first.stdout
    assert {path.name for path in Path("cache").iterdir()} == {"plgwear"}


@compiled
def test_a_kept_design_compiles_nothing_and_imports_nothing_that_traces():
    Path("wanted.toml").write_text(SCENE + 'design = { vary.k = [-0.9, 0.9], minimise = "wear_volume" }\n')
    code = (
        "import sys, matplotlib.artist\n"
        "from plgwear_jax import cli\n"
        "sys.argv = ['plgwear', 'design', 'wanted.toml']\n"
        "written = matplotlib.artist.kwdoc\n"
        "try:\n    cli.main()\n"
        "finally:\n"
        "    print(*(name for name in ('optax', 'jax.extend') if name in sys.modules))\n"
        "    assert matplotlib.artist.kwdoc is written\n"
    )
    first, again = (python("-c", code, JAX_LOG_COMPILES="1") for _ in range(2))
    assert (first.returncode, again.returncode) == (0, 0), again.stderr
    assert "Finished XLA compilation" in first.stderr
    assert "Finished XLA compilation" not in again.stderr
    assert first.stdout.splitlines()[:-1] == again.stdout.splitlines()[:-1]
    assert first.stdout.splitlines()[-1].split()[:1] == ["optax"] and again.stdout.splitlines()[-1] == ""


# --- signs of life --------------------------------------------------------------------------------------------------


class Terminal(io.StringIO):
    def isatty(self):
        return True


@parametrize("kind, seen", [(Terminal, True), (io.StringIO, False)])
def test_only_a_terminal_sees_what_is_being_done(monkeypatch, capsys, kind, seen):
    for name in ("NO_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", kind())
    with terminal.working("drawing the map"):
        pass
    written = sys.stderr.getvalue()
    assert ("drawing the map ..." in written) == seen == bool(written)
    assert capsys.readouterr().out == ""
