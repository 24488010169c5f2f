"""What the documentation shows works as shown: Python of the README and the pages, command lines, docstrings, links."""

import doctest
import importlib
import pkgutil
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import plgwear_jax
from plgwear_jax import cli, optimise, scene

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md")}
TEXTS = {name: (ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "CONTRIBUTING.md")} | PAGES
MODULES = [module.name for module in pkgutil.walk_packages(plgwear_jax.__path__, "plgwear_jax.")]
# What the files of these rooms offer, the room exports.
ROOMS = "contact|figures|fretting|optimise|plots|scene|shapes|steady|surfaces|sweep|transient|wear"
PUBLIC = [name for name in MODULES if not re.match(rf"plgwear_jax\.((.*\.)?(_|cli\b)|({ROOMS})\.)", name)]

BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


def run(name: str) -> int:
    """Execute the Python of a page from top to bottom; how many blocks there were."""
    names: dict[str, object] = {}
    blocks = BLOCK.findall(TEXTS[name])
    for block in blocks:
        exec(compile(block, name, "exec"), names)
    return len(blocks)


def test_the_readme_runs_from_top_to_bottom():
    assert run("README.md") == 1


def test_the_readme_is_short():
    assert len(README.split()) <= 900


@pytest.mark.compiled
def test_the_readme_has_the_numbers_of_the_first_design():
    given = scene.load(ROOT / "design" / "steel_ball.toml")
    found, force = given.design(), 22.0
    table = README.partition("<!-- compared with design/steel_ball.toml -->")[2].strip().partition("\n\n")[0]
    told = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[2:]]
    assert found.certified and found.proven and len(told) == 6
    contacts = found.contact, found.reference
    runs = [contact.over_cycles(force, given.wear.archard(0.6)) for contact in contacts]
    computed = {
        "modulus at a depth of 1.6 µm": [contact.material.modulus(1.6e-6) for contact in contacts],
        "modulus at a depth of 490 µm": [contact.material.modulus(4.9e-4) for contact in contacts],
        "worn volume after 20,000 cycles": [run.volume(2e4) for run in runs],
        "worn volume after 1,000,000 cycles": [run.volume(1e6) for run in runs],
        "worn volume in the steady state": [contact.wear_volume(force) for contact in contacts],
        "pressure 10 µm inside the stick edge": [contact.edge_pressure(1e-5, force) for contact in contacts],
    }
    units = {"GPa": 1e9, "µm³": 1e-18}
    for quantity, *values in told:
        for value, exact in zip(values, computed.pop(quantity), strict=True):
            number, unit = value.split()
            digits = 2 if unit == "µm³" and "20,000" in quantity else 3
            assert float(number.replace(",", "")) == float(f"{float(exact) / units[unit]:.{digits}g}"), quantity
    assert not computed
    assert f"cuts the wear by {100.0 * found.saving:.0f} %" in README
    later, edge = (
        100.0 * (float(one) / float(other) - 1.0)
        for one, other in (
            [run.volume(2e4) for run in runs],
            [contact.edge_pressure(1e-5, force) for contact in contacts],
        )
    )
    assert f"has worn {later:.0f} % more on it" in README and f"falls by {-edge:.0f} %" in README
    assert f"is worn {1e6 * found.contact.deepest_wear(force):.2f} µm deep" in README
    hertz = 1.5 * 50.0 / (np.pi * found.reference.contact_radius() ** 2)
    assert f"Hertzian pressure {1e-9 * hertz:.2f} GPa" in README


# Pages whose Python designs, or has contacts without closed forms.
COMPILED = ("docs/designing.md", "docs/laboratory_test.md", "docs/python.md", "docs/real_coatings.md")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.compiled if name in COMPILED else ())
        for name in sorted(name for name, text in PAGES.items() if BLOCK.search(text))
    ],
)
def test_pages_run_from_top_to_bottom(name):
    assert run(name) > 0


def test_there_are_pages_that_run():
    running = {name for name, text in PAGES.items() if BLOCK.search(text)}
    assert running >= {f"docs/{page}.md" for page in ("index", "theory", "digits", "designing", "sweeping", "limits")}


# Examples of searches and of a march over cycles, each of which is compiled.
SLOW = tuple(f"plgwear_jax.optimise.{name}" for name in ("minimum", "many", "frontier", "scenarios"))
SLOW += ("plgwear_jax.transient.sequence", "plgwear_jax.fitting")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.compiled if name in SLOW else ())
        for name in MODULES
        if not name.endswith("__main__")
    ],
)
def test_examples_in_docstrings(name):
    failed, _ = doctest.testmod(importlib.import_module(name))
    assert failed == 0


def test_there_are_examples():
    finder = doctest.DocTestFinder()
    found = [test for name in MODULES if "__main__" not in name for test in finder.find(importlib.import_module(name))]
    assert sum(bool(test.examples) for test in found) >= 7


# --- links ----------------------------------------------------------------------------------------------------------


def test_links_in_the_readme_lead_somewhere():
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert links
    for link in links:
        assert link.startswith("https://doi.org/") or (ROOT / link).exists(), link


def test_every_page_is_reached_from_the_navigation():
    listed = re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
    assert {f"docs/{name}" for name in listed} >= PAGES.keys()


def test_pictures_and_tables_of_the_pages_are_there():
    links = [
        (name, link)
        for name, text in PAGES.items()
        for link in re.findall(r"\]\(([^)#]+\.(?:png|txt))\)", text) + re.findall(r"<!-- table of (\S+) -->", text)
    ]
    assert len(links) > 20
    for name, link in links:
        assert ((ROOT / name).parent / link).exists(), f"{name}: {link}"


def test_every_public_module_has_its_reference():
    described = {module for text in PAGES.values() for module in re.findall(r"^::: (\S+)$", text, re.MULTILINE)}
    assert described == {name for name in PUBLIC if not name.endswith("__main__")}


def test_no_module_hides_what_its_package_exports():
    """The reference would show the module instead."""
    modules = {name.removeprefix("plgwear_jax.optimise.") for name in MODULES}
    assert not modules & set(optimise.__all__)


def test_every_equation_stands_in_the_theory():
    numbers = [int(number) for number in re.findall(r"\\tag\{(\d+)\}", PAGES["docs/theory.md"])]
    assert sorted(numbers) == list(range(1, 32))


def test_functions_that_the_pages_refer_to_exist():
    names = {name for text in PAGES.values() for name in re.findall(r"\]\[(plgwear_jax[\w.]*)\]", text)}
    assert len(names) > 30
    for name in names:
        parts = name.split(".")
        depth = max(n for n in range(1, len(parts) + 1) if ".".join(parts[:n]) in {"plgwear_jax", *MODULES})
        found = importlib.import_module(".".join(parts[:depth]))
        assert depth < len(parts), f"{name}: a module has a page, and no anchor"
        for part in parts[depth:]:
            found = getattr(found, part)


# --- command lines --------------------------------------------------------------------------------------------------


def command_lines() -> list[tuple[str, str]]:
    """Every line that calls plgwear: in blocks of shell, in indented ones, and in the middle of a sentence."""
    found = []
    for name, text in TEXTS.items():
        blocks = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
        rest = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        lines = [line for block in blocks for line in block.splitlines()]
        lines += re.findall(r"^    (plgwear .*)$", rest, re.MULTILINE) + re.findall(r"`(plgwear [^`]+)`", rest)
        found += [(name, line.split("  #")[0]) for line in lines if line.startswith("plgwear ")]
    return found


def understood(line: str) -> None:
    """Parse a line as the script would, without running it."""
    group = typer.main.get_command(cli.app)
    assert hasattr(group, "commands")
    _, *words = shlex.split(line)
    if words[0].startswith("--"):
        assert words[0] in {"--help", *(option for parameter in group.params for option in parameter.opts)}, line
        return
    command = group.commands[words[0]]
    if words[1:]:
        command.make_context(words[0], words[1:])


@pytest.mark.parametrize("name, line", command_lines())
def test_command_lines_are_understood(name, line):
    understood(line)


def test_a_wrong_command_line_is_not():
    assert len(command_lines()) > 20
    with pytest.raises(KeyError):
        understood("plgwear resign SCENE.toml")
    with pytest.raises(Exception, match="No such option"):
        understood("plgwear design SCENE.toml --sensitivity-analysis")


def test_the_start_prints_what_it_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = PAGES["docs/index.md"]
    lines = [line for name, line in command_lines() if name == "docs/index.md" and line.endswith("contact.toml")]
    assert lines[:2] == ["plgwear new contact.toml", "plgwear design contact.toml"]
    shown = re.findall(r"<!-- printed by the lines above -->\n```text\n(.*?)```", text, re.DOTALL)
    for line, expected in zip(lines[:2], ["", *shown], strict=True):
        result = CliRunner().invoke(cli.app, shlex.split(line)[1:])
        assert result.exit_code == 0
        if expected:
            title, printed = result.stdout.split("\n", 1)
            assert title.strip() == "contact.toml" and printed == expected


# --- the site -------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("mkdocs", reason="make docs has an environment of its own")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "theory.html").read_text(encoding="utf-8").count('class="equation" id="eq-') == 31
    assert 'href="../theory.html#eq-16"' in (tmp_path / "reference" / "fretting.html").read_text(encoding="utf-8")
    for page in tmp_path.rglob("*.html"):
        assert "][plgwear_jax" not in page.read_text(encoding="utf-8"), f"{page.name}: a reference that leads nowhere"
