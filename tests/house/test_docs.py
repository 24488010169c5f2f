"""What the documentation shows works as shown: Python of the README and the pages, command lines, docstrings, links."""

import doctest
import importlib
import inspect
import pkgutil
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import typer
from inputs import ROOT
from marks import compiled, compiled_case, long, parametrize
from numpy.testing import assert_allclose
from processes import module_at, output

import plgwear_jax
from plgwear_jax import (
    FrettingContact,
    GrossSlipContact,
    cli,
    fretting,
    gross_slip,
    loads,
    material,
    optimise,
    partial_slip,
    scene,
    shapes,
    steady,
    surfaces,
    wear,
    wear_laws,
)
from plgwear_jax.coating import fit_power_law
from plgwear_jax.contact import SteadyPunch, slip_regimes
from plgwear_jax.fitting import fit_wear_coefficient
from plgwear_jax.scene import keys

README = (ROOT / "README.md").read_text("utf-8")
PAGES = {path.relative_to(ROOT).as_posix(): path.read_text("utf-8") for path in (ROOT / "docs").rglob("*.md")}
BESIDE = "README.md", "CONTRIBUTING.md", "CHANGELOG.md"
TEXTS = {name: (ROOT / name).read_text("utf-8") for name in BESIDE} | PAGES
MODULES = [module.name for module in pkgutil.walk_packages(plgwear_jax.__path__, "plgwear_jax.")]
# What the files of these rooms offer, the room exports.
ROOMS = "contact|fretting|optimise|plots|scene|shapes|steady|stresses|surfaces|sweep|wear"
PUBLIC = [name for name in MODULES if not re.match(rf"plgwear_jax\.((.*\.)?(_|cli\b)|({ROOMS})\.)", name)]


TABLES = tomllib.loads(Path(__file__).with_name("pages.toml").read_text("utf-8"))
COMPILED_PAGES, COMPILED_MODULES, WORDS, SAID_TWICE = TABLES.values()
generated = module_at(ROOT / "docs" / "generated.py")
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
FENCED = re.compile(r"```.*?```", re.DOTALL)


@compiled
def test_the_readme_has_the_numbers_of_the_first_design():
    given = scene.load(ROOT / "design" / "steel_ball.toml")
    found, force = given.design(), 22.0
    table = README.partition("<!-- compared with design/steel_ball.toml -->")[2].strip().partition("\n\n")[0]
    told = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[2:]]
    assert found.certified and found.scan_found_nothing_better and len(told) == 5
    contacts = found.contact, found.reference
    runs = [contact.over_cycles(force, given.wear.archard) for contact in contacts]
    more = [run.volume(2e4) for run in runs], [contact.steady(force).edge_pressure(1e-5) for contact in contacts]
    computed = {
        "modulus at a depth of 1.6 µm": [contact.material.modulus(1.6e-6) for contact in contacts],
        "modulus at a depth of 490 µm": [contact.material.modulus(4.9e-4) for contact in contacts],
        "worn volume after 20,000 cycles": more[0],
        "worn volume after 1,000,000 cycles and in the steady state": [run.volume(1e6) for run in runs],
        "pressure 10 µm inside the stick-slip boundary": more[1],
    }
    units = {"GPa": 1e9, "µm³": 1e-18}
    for quantity, *values in told:
        for value, exact in zip(values, computed[quantity], strict=True):
            number, unit = value.split()
            digits = 2 if unit == "µm³" and "20,000" in quantity else 3
            assert float(number.replace(",", "")) == float(f"{float(exact) / units[unit]:.{digits}g}"), quantity
    assert f"cuts the wear by {100.0 * found.saving:.0f} %" in README
    later, edge = (100.0 * (float(one) / float(other) - 1.0) for one, other in more)
    assert f"has worn {later:.0f} % more on it" in README and f"falls by {-edge:.0f} %" in README
    deepest = found.contact.steady(force).deepest_wear
    assert f"is worn {1e6 * deepest:.2f} µm deep" in README and deepest > 5e-7  # ten times 50 nm
    hertz = 1.5 * 50.0 / (np.pi * found.reference.steady(0.0).contact_radius ** 2)
    assert f"Hertzian pressure {1e-9 * hertz:.2f} GPa" in README


@parametrize(
    "name",
    [
        compiled_case(name) if name in COMPILED_PAGES else name
        for name, text in sorted(TEXTS.items())
        if BLOCK.search(text)
    ],
)
def test_pages_run_from_top_to_bottom(name):
    names = {}
    for block in BLOCK.findall(TEXTS[name]):
        exec(compile(block, name, "exec"), names)


@parametrize(
    "name",
    [compiled_case(name) if name in COMPILED_MODULES else name for name in MODULES if not name.endswith("__main__")],
)
def test_examples_in_docstrings(name):
    failed, _ = doctest.testmod(importlib.import_module(name))
    assert failed == 0


# What a user calls: all of these rooms, and of others what is named.
SHOWN = fretting, gross_slip, partial_slip, material, shapes, loads, wear_laws, surfaces, steady, wear
NAMED = [
    *(FrettingContact, GrossSlipContact, SteadyPunch, slip_regimes, fit_wear_coefficient, fit_power_law),
    *(optimise.design, optimise.designs, optimise.minimise, optimise.front, optimise.conflict),
    *(optimise.optimal_exponent, optimise.critical_amplitudes),
]


def test_public_functions_have_examples_and_references():
    of_rooms = [getattr(room, name) for room in SHOWN for name in room.__all__]
    for one in (*of_rooms, *NAMED):
        if not callable(one) or one is loads.Control:  # a domain of numbers; three numbers, as `Load` shows them
            continue
        text = inspect.getdoc(one) or ""
        assert "Examples:" in text and ">>> " in text, one
        assert "References:" in text, one


def test_benchmarks_find_what_they_import():
    """Where they ask helpers of the tests for something, type checkers do not look."""
    pytest.importorskip("scipy.optimize.elementwise")  # with which they compare; SciPy has it since 1.15
    folder = ROOT / "benchmarks"
    names = ", ".join(path.stem for path in folder.glob("[a-z]*.py"))
    output("-c", f"import sys; sys.path.append({str(folder)!r}); import harness, {names}")


# --- links ----------------------------------------------------------------------------------------------------------


def test_every_page_is_reached_from_the_navigation():
    listed = re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text("utf-8"), re.MULTILINE)
    assert {f"docs/{name}" for name in listed} == PAGES.keys() | {"docs/contributing.md", "docs/changelog.md"}


def anchors(text):
    """The places of a page that links can lead to."""
    titles = re.findall(r"^#+ (.*)$", FENCED.sub("", text), re.MULTILINE)
    slugs = {re.sub(r"[\s-]+", "-", re.sub(r"[^\w\s-]", "", title.lower()).strip()) for title in titles}
    return slugs | set(re.findall(r'id="([^"]+)"', text)) | {f"eq-{n}" for n in re.findall(r"\\tag\{(\d+)\}", text)}


def test_links_lead_somewhere_on_a_forge_that_shows_raw_markdown():
    links = [
        (name, *link)
        for name, text in TEXTS.items()
        for link in re.findall(r"\]\(([^)#:]*)(?:#([^)]*))?\)", FENCED.sub("", text))
    ]
    assert len(links) > 100
    for name, link, anchor in links:
        target = ((ROOT / name).parent / link).resolve() if link else ROOT / name
        assert target.exists(), f"{name}: {link}"
        if anchor and target.suffix == ".md":
            assert anchor in anchors(target.read_text("utf-8")), f"{name}: {link}#{anchor}"


def test_pages_are_complete_without_the_site():
    for name, text in TEXTS.items():
        assert "--8<--" not in text and ", generated -->" not in text and "<!-- table of" not in text, name
        assert len(text.split()) > 50, name


def test_programs_fill_what_stands_in_the_pages():
    """Where this fails, `make numbers` writes it."""
    names = [name for name, text in PAGES.items() if generated.FILLED.search(text)]
    assert len(names) > 10
    for name in names:
        assert generated.filled(PAGES[name]) == PAGES[name], name


def test_words_are_counted():
    text = "# Two words\n\n5<!-- a: b: c --> of $x$\n\n$$a + b$$\n\n```sh\nplgwear new\n```\n\n"
    assert generated.words(f"{text}<!-- begin: x -->\none\n<!-- end -->\n")[1] == 6
    assert generated.words(README)[0] <= 900 and len(generated.pages()) == len(TEXTS)


# What the library uses and users do not.
INTERNAL = re.compile(r"plgwear_jax\.(catalogue|rules|special)\b")


def test_every_public_module_has_its_reference():
    described = {module for text in PAGES.values() for module in re.findall(r"^::: (\S+)$", text, re.MULTILINE)}
    # A function without a module of its own, and the figures of the paper, which `plots` does not export.
    own = {"plgwear_jax._core.startup.programs.compiler_options", "plgwear_jax.plots.figures"}
    assert described == {name for name in PUBLIC if not name.endswith("__main__") and not INTERNAL.match(name)} | own
    assert sum("\n::: " in text for text in PAGES.values()) == 8


def test_no_module_hides_what_its_package_exports():
    """The reference would show the module instead."""
    modules = {name.removeprefix("plgwear_jax.optimise.") for name in MODULES}
    assert not modules & set(optimise.__all__)


def test_every_equation_stands_in_the_theory():
    numbers = [int(number) for number in re.findall(r"\\tag\{(\d+)\}", PAGES["docs/explanation/theory.md"])]
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


def command_lines():
    """Every line that calls plgwear: in blocks of shell, in indented ones, and in the middle of a sentence."""
    found = []
    for name, text in TEXTS.items():
        if name == "docs/reference/command-line.md":  # their own help
            continue
        blocks = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
        rest = FENCED.sub("", text)
        lines = [line for block in blocks for line in block.splitlines()]
        lines += re.findall(r"^    (plgwear .*)$", rest, re.MULTILINE) + re.findall(r"`(plgwear [^`]+)`", rest)
        found += [(name, line.split("  #")[0]) for line in lines if line.startswith("plgwear ")]
    return found


def understood(line):
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


@parametrize("name, line", command_lines())
def test_command_lines_are_understood(name, line):
    understood(line)


def test_a_wrong_command_line_is_not():
    assert len(command_lines()) > 20
    with pytest.raises(KeyError):
        understood("plgwear resign SCENE.toml")
    with pytest.raises(Exception, match="No such option"):
        understood("plgwear design SCENE.toml --sensitivity-analysis")


@compiled
@parametrize("name", [name for name, text in PAGES.items() if "<!-- printed by: " in text])
def test_commands_print_what_the_pages_show(name):
    assert generated.printed(PAGES[name], (ROOT / name).parent) == PAGES[name]


# --- numbers come from one place --------------------------------------------------------------------------------------


@parametrize("name", [name for name, text in TEXTS.items() if generated.QUOTED.search(text)])
def test_quoted_numbers_are_those_of_the_tables(name):
    """Where this fails, `make numbers` writes them."""
    assert generated.quoted(TEXTS[name]) == TEXTS[name]


def test_a_number_is_quoted_with_the_digits_that_it_is_shown_with():
    assert [generated.like(shown, 0.00034) for shown in ("2e-4", "2.0e-4", "0.002", "0.0021")] == [
        "3e-4", "3.4e-4", "0.0003", "0.00034",
    ]  # fmt: skip
    assert [generated.like(shown, 1234.5) for shown in ("9", "98", "1,111")] == ["1,000", "1,200", "1,234"]
    with pytest.raises(LookupError, match="no row"):
        generated.quoted("5<!-- surfaces: no such contact, 4: ms -->")


@long
@parametrize("name", ["hip_taper", "blade_root", "steam_generator_tube", "railway_axle", "electrical_contact"])
def test_the_gallery_has_the_savings_of_the_designs(name):
    row = re.search(
        rf"^\| {name.replace('_', ' ')} \| .* \| (\S+) % \| (\S+) % \|.*$", PAGES["docs/gallery.md"], re.MULTILINE
    )
    found = [scene.load(ROOT / "design" / f"{stem}.toml").design() for stem in (name, f"{name}_pair")]
    assert [f"{100.0 * one.saving:.1f}" for one in found] == [row[1], row[2]]


def test_the_tables_keep_what_is_promised():
    page = PAGES["docs/explanation/accuracy.md"]
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| ") and "<!--" in line]
    compared = 0
    for _, contact, _, promised, measured, *_ in rows:
        limits = [float(x) for x in re.findall(r"\d+e-\d+", promised)]
        limits += [10.0 ** -float(x) for x in re.findall(r"(\d+) digits", promised)]
        errors = [float(match["shown"]) for match in generated.QUOTED.finditer(measured) if "%" not in measured]
        if "none" in promised or not errors:
            continue
        for limit, error in zip(limits, errors, strict=True):
            assert error <= limit, contact
            compared += 1
    assert compared > 10
    assert generated.number("rigs", "power laws|layers and tables", "95 of 100") <= 1.0


def test_values_and_first_derivatives_keep_eight_digits_everywhere():
    found = generated.digits_of_functions()
    assert len(found) > 15
    assert min(float(by[order]) for by in found.values() for order in "01") > 8.0


def test_the_promised_accuracy_is_that_of_the_tests():
    import accuracy

    page = PAGES["docs/explanation/accuracy.md"]
    assert f"In float64 values keep [{accuracy.PROMISED['float64', 'bulk'][0]:.0e}]" in README
    for row, words in enumerate(("values", "first derivatives", "second derivatives of the wear volume")):
        line = re.search(rf"^\| {words} \| (\S+) \| (\S+) \|$", page, re.MULTILINE)
        assert float(line[1]) == accuracy.PROMISED["float64", "bulk"][row]
        assert float(line[2]) == accuracy.PROMISED["float64", "edges"][row]


def test_a_trade_off_curve_has_as_many_points_everywhere():
    from plgwear_jax.cli import design

    functions = design.front, optimise.front, scene.Scene.front
    assert {inspect.signature(function).parameters["points"].default for function in functions} == {21}


def test_every_key_of_an_input_file_is_described():
    told = generated.input_keys()
    listed = {name for _, names in generated.SECTIONS for name in names}
    assert listed | {"Limits"} == {name for name, one in keys.SECTIONS.items() if "properties" in one}
    assert all(f"| `{key}` | " in told for name in listed for key in keys.SECTIONS[name]["properties"])
    assert "| `normal_force` | Normal force. | N | > 0 | required |" in told
    assert (
        "| `points` | Number of radii at which a function of the radius is given, half of them in the worn ring. |  |"
        in told
    )
    assert "behind the contact, at which stresses are given. | m | a finite number |" in told


def test_every_quantity_is_described():
    from plgwear_jax._core import catalogue

    told = generated.quantities()
    for laws in (catalogue.FRETTING, catalogue.GROSS_SLIP, catalogue.MATERIAL):
        assert all(f"| `{name}` | " in told for name in laws)
    assert all(f"| `transient.{name}` | " in told for name in catalogue.TRANSIENT)
    assert (
        "| `wear_volume` | $\\Delta V$ | volume worn off until the steady state | m³ | `a_0^4/R` | `F_x` | (28) |"
        in told
    )


def test_messages_that_the_pages_explain_are_printed_by_the_library():
    source = "".join(path.read_text("utf-8") for path in (ROOT / "plgwear_jax").rglob("*.py"))
    page = PAGES["docs/reference/troubleshooting.md"].partition("## Symptoms")[0]
    messages = re.findall(r"^\| `([^`]+)` \|", page, re.MULTILINE)
    assert len(messages) > 20
    for message in messages:
        for part in message.split("..."):
            assert part.strip() in source, message


READ = [path for folder in ("plgwear_jax", "design", "notebooks") for path in (ROOT / folder).rglob("*.*")]
READ = [path for path in READ if path.suffix in (".py", ".toml", ".ipynb")]


@pytest.fixture(scope="module")
def prose():
    """What is read, each in one line; pages without the names of Python, keys and files."""
    names = re.compile(r"\]\([^)]*\)|`[^`\n]*`|```.*?```", re.DOTALL)
    texts = {name: names.sub("", text) for name, text in TEXTS.items()}
    texts |= {str(path): path.read_text("utf-8") for path in READ}
    return {name: " ".join(text.split()) for name, text in texts.items()}


@parametrize("word", WORDS)
def test_words_are_those_of_tribologists_and_promise_no_more_than_is_kept(prose, word):
    said = [name for name, text in prose.items() if re.search(rf"\b(?:{word})\b", text)]
    assert not said, f"{WORDS[word]}, not {word}: {said}"


# --- what several pages say is the same -----------------------------------------------------------------------------

RULE = """At the same contact radius the compliant surface wears the indenter less at force amplitudes above 0.4 of the
friction force. Below 0.2 the stiff surface wears it less only where the modulus follows a power of the depth down to a
hundredth of the contact radius; on layers of 1 to 3 contact radii the compliant surface wears it less at every
amplitude."""


@parametrize("name", ["README.md", "docs/gallery.md"])
def test_the_rule_is_said_in_the_same_words(name):
    assert " ".join(RULE.split()) in " ".join(TEXTS[name].split())


def test_the_rule_is_that_of_its_table():
    ((heads, rows),) = generated.tables("rule")
    assert len(rows) == 18
    more = {tuple(row[:3]): dict(zip(heads[3:], map(float, row[3:]), strict=True)) for row in rows}
    for gradient, thickness, surface in more:
        for head, change in more[gradient, thickness, "compliant"].items() if surface == "compliant" else ():
            phi, stiff = float(head.split()[1]), more[gradient, thickness, "stiff"][head]
            if phi >= 0.4 or gradient == "layer":
                assert change < stiff, (gradient, thickness, phi)
            elif phi <= 0.2 and gradient == "power law":
                assert change > stiff, (gradient, thickness, phi)


@compiled
def test_the_table_of_the_rule_is_computed(tmp_path, monkeypatch):
    ((heads, rows),) = generated.tables("rule")
    output(ROOT / "benchmarks" / "coatings.py", "rule", "--out", tmp_path / "benchmarks")
    monkeypatch.setattr(generated, "DOCS", tmp_path)
    ((found, computed),) = generated.tables("rule")
    assert found == heads and [row[:3] for row in computed] == [row[:3] for row in rows]
    more, told = (np.array([row[3:] for row in table], float) for table in (computed, rows))
    assert_allclose(more, told, atol=0.06)


def number_in(name, pattern):
    """What a page says in its text, without its line breaks."""
    found = re.search(pattern, " ".join(TEXTS[name].split()))
    assert found is not None, f"{name}: {pattern}"
    return found[1]


@parametrize("what", SAID_TWICE)
def test_a_number_is_the_same_in_all_pages(what):
    assert len({number_in(*place) for place in SAID_TWICE[what]}) == 1


def test_the_computed_radius_on_alumina_is_that_of_the_pages():
    alumina, ball = material.PowerLawGraded(386e9, 1e-3, 0.0, nu=0.22), surfaces.Elastic(614e9, 0.22)
    contact = FrettingContact(alumina, 4.76e-3, 3000.0, friction=0.4, indenter=ball)
    told = number_in(*SAID_TWICE["the computed radius on pure alumina"][0])
    assert f"{1e3 * float(contact.steady(0.0).contact_radius):.3f}" == told


def test_the_tutorial_shows_each_command_and_says_where_displacements_are_measured():
    name = "docs/tutorial/rig_to_coating.md"
    for command in re.findall(r"<!-- printed by: (.*?) -->", PAGES[name]):
        assert f"```sh\n{command}\n```" in PAGES[name]
    at_contact = number_in(name, r"at the contact alone .*? is ([\d.]+) µm")
    at_actuator = number_in(name, r"gross slip begins at ([\d.]+) µm")
    assert abs(float(at_actuator) - float(at_contact) - 30.0 / 20.0) < 2e-3  # mu F_N over the stiffness, in µm


@parametrize("name", sorted(name for name, text in TEXTS.items() if BLOCK.search(text)))
def test_the_first_sample_computes_in_float64(name):
    assert "jax_enable_x64" in BLOCK.findall(TEXTS[name])[0]


# --- the site -------------------------------------------------------------------------------------------------------


@long
def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("mkdocs", reason="make docs has an environment of its own")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "explanation" / "theory.html").read_text("utf-8").count('class="equation" id="eq-') == 31
    assert 'href="../explanation/theory.html#eq-16"' in (tmp_path / "reference" / "closed_forms.html").read_text(
        encoding="utf-8"
    )
    for page in tmp_path.rglob("*.html"):
        assert "][plgwear_jax" not in page.read_text("utf-8"), f"{page.name}: a reference that leads nowhere"
