"""What is built from the repository can be installed where nothing else is, and needs nothing else."""

import json
import os
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest
from marks import parametrize

from plgwear_jax._core.units import text_cells

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
CORE = {"jax", "jaxlib", "numpy", "optax", "scipy"}
# What an import of the core packages themselves brings in, and nothing else may.
WHAT_THE_CORE_NEEDS = {
    "absl",
    "chex",
    "cython_runtime",
    "ml_dtypes",
    "opt_einsum",
    "toolz",
    "typing_extensions",
    "etils",
    "setuptools",
}


def run(*command, **keywords):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **keywords)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--outdir", folder, ROOT)
    (wheel,), (source,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return wheel, source


@pytest.fixture(scope="module", params=["wheel", "source"])
def python(request, built, tmp_path_factory):
    """A new environment with one of them and the core packages."""
    folder = tmp_path_factory.mktemp("clean")
    venv.create(folder, with_pip=True)
    python = folder / "bin" / "python"
    package = built[0] if request.param == "wheel" else built[1]
    run(python, "-m", "pip", "install", "--quiet", "-c", ROOT / "constraints.txt", package)
    return python


def test_the_wheel_holds_the_package_and_nothing_else(built):
    names = zipfile.ZipFile(built[0]).namelist()
    assert {name.split("/")[0].partition("-")[0] for name in names} == {"plgwear_jax"}
    assert "plgwear_jax/py.typed" in names and "plgwear_jax/special/lerch.py" in names


def test_the_source_can_be_tested(built):
    with tarfile.open(built[1]) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    tracked = run("git", "ls-files", cwd=ROOT).split()
    wanted = {name for name in tracked if name.startswith(("plgwear_jax/", "tests/", "design/", "benchmarks/"))}
    assert wanted <= names and {"README.md", "LICENSE", "CHANGELOG.md", "pyproject.toml", "Makefile"} <= names


def test_an_import_brings_in_the_core_and_nothing_else(python, tmp_path):
    code = (
        "import json, sys\n"
        "before = set(sys.modules)\n"
        "from plgwear_jax import contact, fretting, gross_slip, material, optimise\n"
        "found = {name.partition('.')[0] for name in set(sys.modules) - before}\n"
        "print(json.dumps(sorted(found - set(sys.stdlib_module_names))))\n"
    )
    found = json.loads(run(python, "-c", code, cwd=tmp_path))
    public = {name for name in found if not name.startswith("_")}
    assert "plgwear_jax" in public and public - {"plgwear_jax"} <= CORE | WHAT_THE_CORE_NEEDS


def test_it_computes_there(python, tmp_path):
    code = "from plgwear_jax import fretting, optimise; print(float(fretting.wear_volume(0.3, 0.5)))"
    assert 0.1 < float(run(python, "-c", code, cwd=tmp_path)) < 0.2


def test_the_script_says_what_it_lacks(python, tmp_path):
    for command in ([python.with_name("plgwear")], [python, "-m", "plgwear_jax"]):
        done = subprocess.run([*map(str, command), "--help"], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 2 and done.stdout == ""
        assert done.stderr.startswith("plgwear: needs the extra cli") and len(done.stderr.splitlines()) == 1


@parametrize(
    "code, extra",
    [
        *text_cells("""
    import plgwear_jax; plgwear_jax.sweep                                    sweep
    from plgwear_jax.sweep import sweep                                      sweep
    from plgwear_jax import plots                                            plots
    from plgwear_jax.plots import maps                                       plots
    from plgwear_jax.plots import figures                                    plots
    from plgwear_jax import scene; scene.scene_of({'material': {'k': 0.0}})  cli
    """)
    ],
)
def test_modules_say_which_extra_they_lack(python, tmp_path, code, extra):
    done = subprocess.run([str(python), "-c", code], capture_output=True, text=True, cwd=tmp_path)
    line = done.stderr.splitlines()[-1]
    assert f"need the extra {extra} (" in line and f"pip install 'plgwear-jax[{extra}]'" in line
    assert os.listdir(tmp_path) == []
