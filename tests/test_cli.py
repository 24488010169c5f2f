"""The script: what it prints where, with which exit code, and what it leaves behind."""

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

import jax
import numpy as np
import pytest
from matplotlib import image
from typer.testing import CliRunner

import plgwear_jax
from plgwear_jax import FrettingContact, cli, optimise, scene

CONTACT = Path(__file__).parents[1] / "design" / "electrical_contact.toml"
GROSS_SLIP = """
material = { E0 = 1e9, z0 = 1e-3, k = -0.5, nu = "holl" }
contact = { kind = "gross-slip", radius = 2e-3, depth = 1e-6 }
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of one's own, with the scene of the electrical contact in it."""
    monkeypatch.chdir(tmp_path)
    Path("contact.toml").write_text(CONTACT.read_text())
    rewrite(
        'quantities = ["contact_radius", "stick_radius", "worn_radius", "wear_volume", "edge_intensity", "profile", ',
        'quantities = ["contact_radius", "wear_volume", "steady_pressure", ',
    )
    return tmp_path


def plgwear(*arguments: str):
    return CliRunner().invoke(cli.app, arguments)


def refused(*arguments: str) -> str:
    """The one line with which bad input is refused."""
    before = sorted(os.listdir())
    result = plgwear(*arguments)
    assert result.exit_code == 2 and result.stdout == "" and sorted(os.listdir()) == before
    (line,) = result.stderr.splitlines()
    return line


def rewrite(old: str, new: str) -> None:
    text = Path("contact.toml").read_text()
    assert text.count(old) == 1
    Path("contact.toml").write_text(text.replace(old, new))


class Search:
    """In place of the search for the best coating: a known one, and what was asked for."""

    def __init__(self, converged: bool = True, certified: bool = True) -> None:
        self.ended = {"converged": converged, "certified": certified}
        self.asked: list = []

    def __call__(self, contact: FrettingContact, force: float, vary, *, hold) -> optimise.Design:
        self.asked.append((force, vary, hold))
        material = dataclasses.replace(contact.material, k=-0.816, E0=31.5e9)
        best = dataclasses.replace(contact, material=material)
        volumes = best.wear_volume(force), contact.wear_volume(force)
        at_bound: dict = dict.fromkeys(vary)
        return optimise.Design(best, contact, {"k": -0.816}, *volumes, at_bound, **self.ended)


@pytest.fixture
def search(monkeypatch: pytest.MonkeyPatch) -> Search:
    monkeypatch.setattr(optimise, "design", Search())
    return optimise.design  # pyright: ignore[reportReturnType]


# --- solve ----------------------------------------------------------------------------------------------------------


def test_solve_prints_a_table_that_an_engineer_can_read(folder):
    result = plgwear("solve", "contact.toml")
    assert result.exit_code == 0 and result.stderr == ""
    rows = {row.split()[1]: row.replace("│", " ").split() for row in result.stdout.splitlines() if "│ " in row}
    assert rows["contact_radius"][:3] == ["contact_radius", "67.7", "µm"]
    assert rows["wear_volume"][:3] == ["wear_volume", "2.961", "µm³"]
    assert rows["wear_depth"][:5] == ["wear_depth", "3.562", "nm", "66.94", "µm"]
    assert rows["steady_pressure"][3:5] == ["0", "m"] and "unbounded at the" in " ".join(result.stdout.split())


def test_solve_without_functions_of_the_radius_has_no_column_for_it(folder):
    Path("slip.toml").write_text(GROSS_SLIP)
    result = plgwear("solve", "slip.toml")
    assert result.exit_code == 0 and "at r" not in result.stdout and "force_ratio" in result.stdout


def test_solve_json_is_one_object_at_full_precision(folder):
    result = plgwear("solve", "contact.toml", "--json")
    assert result.exit_code == 0 and result.stderr == ""
    found = json.loads(result.stdout)
    assert found["scene"] == "contact.toml"
    for name, quantity in scene.load("contact.toml").solve().items():
        printed = found["quantities"][name]
        assert printed["unit"] == quantity.unit and printed["description"] == quantity.description
        if quantity.radii is None:
            assert printed["value"] == quantity.value and "radii" not in printed
        else:
            assert printed["value"] == np.asarray(quantity.value).tolist() and printed["radii"] == list(quantity.radii)


def test_solve_json_has_null_for_what_is_infinite(folder):
    text = f'{GROSS_SLIP}output = {{ quantities = ["initial_pressure"], points = 3 }}\n'
    Path("slip.toml").write_text(text)
    result = plgwear("solve", "slip.toml", "--json")
    first, at_the_edge, beside = json.loads(result.stdout)["quantities"]["initial_pressure"]["value"]
    assert first > 0 and at_the_edge is None and beside == 0


def test_digits_are_handed_on(folder, monkeypatch):
    asked = []
    monkeypatch.setattr(scene.Scene, "solve", lambda self, *, digits: asked.append(digits) or {})
    for arguments in ([], ["--digits", "5"]):
        assert plgwear("solve", "contact.toml", "--json", *arguments).exit_code == 0
    assert asked == [None, 5]


# --- design ---------------------------------------------------------------------------------------------------------


def test_design_prints_a_table_and_draws_a_picture(folder, search):
    result = plgwear("design", "contact.toml")
    assert result.exit_code == 0 and result.stderr == ""
    assert search.asked == [(0.32, {"k": (-0.9, 0.9)}, "contact_radius")]
    rows = [row.replace("│", " ").split("  ") for row in result.stdout.splitlines() if row.startswith("│")]
    table = {cells[0]: cells[1:] for cells in ([cell.strip() for cell in row if cell.strip()] for row in rows)}
    assert table["exponent k"] == ["-0.816", "0"]
    assert table["modulus E0 ..."] == ["31.5 GPa", "110 GPa"]
    assert table["wear volume"][1] == "2.961 µm³"
    assert table["stress at the edge, exponent (k-1)/2"] == ["-0.908", "-0.5"]
    assert table["less wear than the reference"] == ["18.2 %"]
    assert table["k from -0.9 to 0.9"] == ["between"]
    assert table["the search converged"] == ["yes"] and table["a scan found nothing better"] == ["yes"]
    assert result.stdout.endswith("picture: contact-design.png\n")
    assert image.imread("contact-design.png").size and len(os.listdir()) == 2


def test_design_json_is_one_object_and_the_picture_is_drawn(folder, search):
    result = plgwear("design", "contact.toml", "--json", "--picture", "best.svg")
    assert result.exit_code == 0 and result.stderr == ""
    found = json.loads(result.stdout)
    assert list(found) == [
        "scene", "best", "reference", "units", "less_wear_percent", "vary", "hold", "converged", "certified", "picture",
    ]  # fmt: skip
    reference = scene.load("contact.toml").build_contact()
    assert isinstance(reference, FrettingContact)
    assert found["reference"]["wear_volume"] == float(reference.wear_volume(0.32))
    assert found["best"].keys() == found["reference"].keys() == found["units"].keys()
    assert found["vary"] == {"k": {"bounds": [-0.9, 0.9], "at_bound": None}}
    assert found["picture"] == "best.svg" and Path("best.svg").read_text().startswith("<?xml")


@pytest.mark.parametrize(
    "converged, line",
    [
        (False, "contact.toml: the search did not converge; this is the best found"),
        (True, "contact.toml: a scan found less wear elsewhere between the bounds"),
    ],
)
@pytest.mark.parametrize("as_json", [True, False])
def test_design_that_is_not_the_best_says_so(folder, monkeypatch, converged, line, as_json):
    monkeypatch.setattr(optimise, "design", Search(converged, certified=False))
    result = plgwear("design", "contact.toml", *(["--json"] if as_json else []))
    assert result.exit_code == 1 and result.stderr == f"{line}\n"
    if as_json:
        found = json.loads(result.stdout)
        assert found["converged"] is converged and found["certified"] is False
    else:
        assert result.stdout.count(" NO ") == 2 - converged


def test_design_refuses_what_it_cannot_do(folder, search):
    assert refused("design", "contact.toml", "--picture", "a.jpg") == "a.jpg: must end in .png, .pdf or .svg"
    line = refused("design", "contact.toml", "--picture", "missing/a.png")
    assert line == "missing/a.png: cannot be written: No such file or directory"
    Path("slip.toml").write_text(GROSS_SLIP)
    assert refused("design", "slip.toml") == "slip.toml: [design]: missing; it says what may vary"
    rewrite("tangential_force = 0.32", "tangential_force = 0")
    line = "contact.toml: [load] tangential_force = 0.0: nothing wears, so there is nothing to design"
    assert refused("design", "contact.toml") == line
    assert search.asked == []  # all of this is known before the search


def test_design_whose_picture_cannot_be_written_after_all(folder, search, monkeypatch):
    def disappears(*_, **__):
        raise cli.plots.PictureError("contact-design.png: cannot be written: No space left on device")

    monkeypatch.setattr(cli.plots, "save", disappears)
    for arguments in ([], ["--json"]):
        line = refused("design", "contact.toml", *arguments)
        assert line == "contact-design.png: cannot be written: No space left on device"


def test_numbers_beyond_double_precision_are_refused(folder, monkeypatch):
    rewrite("radius = 0.005", "radius = 1e308")
    rewrite("normal_force = 10.0", "normal_force = 1e308")
    extreme = "exceeds the range of numbers: some value in the scene is too extreme"
    assert refused("solve", "contact.toml").endswith(extreme)
    monkeypatch.setattr(optimise, "design", Search())
    assert refused("design", "contact.toml") == f"contact.toml: the wear {extreme}"

    def overflows(*_, **__):
        raise ValueError("E0 = inf is outside the allowed range > 0 and finite")

    monkeypatch.setattr(optimise, "design", overflows)
    line = "contact.toml: some value in the scene is too extreme: E0 = inf is outside the allowed range > 0 and finite"
    assert refused("design", "contact.toml") == line


# --- both, and the script itself ------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["solve", "design"])
@pytest.mark.parametrize("as_json", [True, False])
def test_bad_scenes_are_refused_in_one_line(folder, command, as_json):
    arguments = [command, "contact.toml", *(["--json"] if as_json else [])]
    rewrite("friction = 0.4", "fricton = 0.4")
    assert refused(*arguments) == "contact.toml: [contact] fricton = 0.4: there is no such key; did you mean friction?"
    arguments[1] = "missing.toml"
    assert refused(*arguments) == "missing.toml: there is no such file"
    arguments[1] = "a\nb.toml"
    assert refused(*arguments) == "a\\nb.toml: there is no such file"
    arguments[1] = "."
    assert refused(*arguments) == ".: is a folder; a scene is a TOML file"


def test_version_and_help():
    assert plgwear("--version").stdout == f"plgwear {plgwear_jax.__version__}\n"
    assert "tangential_force = 0.32" in plgwear("--help").stdout
    for command in ("solve", "design"):
        assert "Example: plgwear" in plgwear(command, "--help").stdout


@pytest.mark.parametrize(
    "arguments", [["solve"], ["solve", "a", "b"], ["bake"], ["solve", "a", "--digits", "16"], ["design", "--jsn"]]
)
def test_usage_errors_exit_with_2(arguments):
    result = plgwear(*arguments)
    assert result.exit_code == 2 and "Traceback" not in result.output and result.stdout == ""


def test_example_in_the_help_is_a_scene(folder):
    lines = (cli.plgwear.__doc__ or "").splitlines()
    code = [line[8:] for line in lines if line.startswith(8 * " ")]
    Path("example.toml").write_text("\n".join(code))
    assert scene.load("example.toml").material == scene.load(CONTACT).material


def in_a_process(*arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(Path(plgwear_jax.__file__).parents[1])} | variables
    command = [sys.executable, "-m", "plgwear_jax", *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=environment, check=False, encoding="utf-8")


def test_process_refuses_without_a_traceback(folder):
    rewrite("tangential_force = 0.32", "tangential_force = 5.0")
    result = in_a_process("solve", "contact.toml")
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == (
        "contact.toml: [load] tangential_force = 5.0: this is gross slip, F_x = 5 N is not below mu F_N = 4 N; "
        'use a scene with contact kind = "gross-slip"\n'
    )


def test_process_prints_where_there_is_no_micro_sign(folder):
    rewrite('["contact_radius", "wear_volume", "steady_pressure", "wear_depth"]', '["contact_radius"]')
    result = in_a_process("solve", "contact.toml", PYTHONIOENCODING="ascii")
    assert result.returncode == 0 and result.stderr == "" and r"67.7 | \xb5m" in result.stdout


def test_process_designs_the_electrical_contact(folder):
    result = in_a_process("design", "contact.toml", "--json", "--picture", "best.png")
    assert result.returncode == 0 and result.stderr == ""
    found = json.loads(result.stdout)
    assert found["converged"] and found["certified"]
    best, reference = found["best"], found["reference"]
    # In double precision, though nobody asked for it: the radius is held to rounding.
    assert best["contact_radius"] == pytest.approx(reference["contact_radius"], rel=1e-13)
    assert best["k"] == pytest.approx(-0.81598, abs=1e-4) and found["vary"]["k"]["at_bound"] is None
    assert found["less_wear_percent"] == pytest.approx(18.449, abs=1e-3)
    # A contact of some tens of micrometres that loses some cubic micrometres.
    assert 1e-5 < best["stick_radius"] < best["contact_radius"] < best["worn_radius"] < 1e-3
    assert 1e-19 < best["wear_volume"] < reference["wear_volume"] < 1e-16
    assert image.imread("best.png").size and sorted(os.listdir()) == ["best.png", "contact.toml"]


def test_script_turns_double_precision_on(monkeypatch):
    settings = []
    monkeypatch.setattr(jax.config, "update", lambda *setting: settings.append(setting))
    monkeypatch.setattr(cli, "app", lambda: settings.append("run"))
    cli.main()
    assert settings == [("jax_enable_x64", True), "run"]


def test_without_its_extra_the_script_says_what_it_takes(monkeypatch, capsys):
    from plgwear_jax import __main__

    monkeypatch.setitem(sys.modules, "plgwear_jax.cli", None)
    monkeypatch.delattr("plgwear_jax.cli", raising=False)
    with pytest.raises(SystemExit) as ended:
        __main__.main()
    assert ended.value.code == 2
    assert "pip install 'plgwear-jax[cli]'" in capsys.readouterr().err
