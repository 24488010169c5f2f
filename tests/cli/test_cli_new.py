"""A scene to start from, and what editors know about scenes."""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import jsonschema
import pytest
from typer.testing import CliRunner

from plgwear_jax import cli, scene
from plgwear_jax.cli.new import FRETTING

SCENES = sorted((Path(__file__).parents[2] / "design").glob("*.toml"))


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def plgwear(*arguments: str):
    return CliRunner().invoke(cli.app, arguments)


@pytest.fixture(scope="module")
def validator():
    document = json.loads(plgwear("schema").stdout)
    jsonschema.Draft202012Validator.check_schema(document)
    return jsonschema.Draft202012Validator(document)


@pytest.mark.parametrize("kind", ["fretting", "gross-slip"])
def test_a_new_scene_is_complete(validator, kind):
    written = plgwear("new", "mine.toml", "--kind", kind)
    assert written.exit_code == 0 and written.stdout == (
        "mine.toml: written; next: plgwear solve mine.toml, then plgwear design mine.toml\n"
    )
    found = scene.load("mine.toml")
    assert found.contact.kind == kind and found.design_space is not None and found.output is not None
    assert not list(validator.iter_errors(tomllib.loads(Path("mine.toml").read_text())))
    assert os.listdir() == ["mine.toml"]


def test_every_line_that_is_commented_out_would_be_right():
    """What the new scene offers instead of a line is taken where that line stood."""
    plgwear("new", "mine.toml")
    lines = Path("mine.toml").read_text().splitlines()
    Path("loads.csv").write_text("tangential_force,weight\n0.3,1\n")
    Path("cycles.csv").write_text("tangential_force\n0.3\n")
    whole = "\n".join(lines)
    offers = [line[2:] for line in lines if line.startswith("# ") and " = " in line]
    (table, *layers), shape, offers = offers[:3], offers[3], offers[4:]
    loads, rig, cycles, over, limits, distance = offers[:3], offers[3], offers[4], offers[5], offers[6:-1], offers[-1]
    Path("E_of_z.csv").write_text("depth,modulus\n0,1e11\n1e-5,2e11\n")
    power_law, without = (
        [line for line in lines if line[:4] in ("E0 =", "z0 =", "k = ")],
        whole.partition("\n[design]\n")[0],
    )
    assert len(power_law) == 3
    for line in power_law:
        without = without.replace(f"{line}\n", "")
    for material in ([table], layers):
        changed = without
        for line in (*material, shape):
            changed = changed.replace(f"# {line}", line)
        Path("changed.toml").write_text(changed)
        given = scene.load("changed.toml").contact
        assert given.indenter.E == 210e9 and given.shape.exponent == 4.0
    assert [line.split()[0] for line in loads] == ["displacement", "table", "history"] and over.startswith("over = ")
    assert rig.startswith("rig_stiffness = ") and cycles.startswith("cycles = ")
    assert len(limits) == 3
    assert distance.startswith("distance = ")
    Path("changed.toml").write_text(whole.replace(f"# {distance}", distance))
    assert scene.load("changed.toml").output.distance == 1e-5
    (radius,) = (line for line in limits if line.startswith("contact_radius"))
    (hold,) = (line for line in lines if line.startswith("hold"))
    (amplitude,) = (line for line in lines if line.startswith("tangential_force"))
    (rigid,) = (line for line in lines if line.startswith("indenter"))
    assert scene.load("mine.toml").contact.indenter.E == 210e9
    Path("changed.toml").write_text(whole.replace(f"{rigid}\n", ""))
    assert scene.load("changed.toml").contact.indenter == "rigid"
    for load in (*loads, f"{loads[0]}\n{rig}"):
        Path("changed.toml").write_text(whole.replace(amplitude, load))
        assert scene.load("changed.toml").load.tangential_force is None
    assert scene.load("changed.toml").load.rig_stiffness == 2e7
    Path("changed.toml").write_text(whole.replace(f"# {cycles}", cycles))
    assert scene.load("changed.toml").wear.cycles == 1e6
    Path("changed.toml").write_text(whole.replace(amplitude, loads[1]).replace(f"# {over}", over))
    assert scene.load("changed.toml").design_space.level == 0.9
    for line in limits:
        whole = whole.replace(f"# {line}", line)
    Path("changed.toml").write_text(whole)
    with pytest.raises(scene.SceneError, match="cannot be limited while"):
        scene.load("changed.toml")
    for text, limited in (whole.replace(hold, ""), {"contact_radius"}), (whole.replace(radius, ""), set()):
        Path("changed.toml").write_text(text)
        allowed = scene.load("changed.toml").design_space.allowed
        assert allowed.keys() == {"edge_pressure", "penetration", "modulus"} | limited


def test_a_new_scene_fits_into_a_terminal():
    """`plgwear --help` shows it, on 80 columns and with a margin."""
    assert max(map(len, FRETTING.splitlines())) <= 76


def test_what_is_there_is_not_written_over():
    Path("mine.toml").write_text("mine")
    for arguments, line in (
        (["mine.toml"], "mine.toml: exists already; name another file"),
        (["mine.txt"], "mine.txt: must end in .toml"),
        (["no/mine.toml"], "no/mine.toml: cannot be written: No such file or directory"),
    ):
        result = plgwear("new", *arguments)
        assert (result.exit_code, result.stdout, result.stderr) == (2, "", f"{line}\n")
    assert os.listdir() == ["mine.toml"] and Path("mine.toml").read_text() == "mine"


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_schema_knows_every_scene(validator, path):
    assert not list(validator.iter_errors(tomllib.loads(path.read_text())))


@pytest.mark.parametrize(
    "old, new, said",
    [
        ("radius = 0.0125", "raduis = 0.0125", "raduis"),
        ("k = 0.0", "k = 1.0", "exclusive"),
        ('kind = "fretting"', 'kind = "rolling"', "rolling"),
        ('minimise = "wear_volume"', 'minimise = "price"', "price"),
        ("[output]", "[outputs]", "outputs"),
    ],
)
def test_the_schema_finds_what_is_wrong(validator, old, new, said):
    plgwear("new", "mine.toml")
    text = Path("mine.toml").read_text()
    assert text.count(old) >= 1
    document = tomllib.loads(text.replace(old, new))
    assert said in " ".join(str(error) for error in validator.iter_errors(document))


def test_the_module_is_the_script():
    outputs = [
        subprocess.run([*command, "--help"], capture_output=True, text=True, check=True).stdout
        for command in (
            [sys.executable, "-m", "plgwear_jax"],
            [str(Path(sys.executable).with_name("plgwear"))],
        )
    ]
    assert outputs[0] == outputs[1] and "plgwear new SCENE.toml" in outputs[0]
    assert "--install-completion" in outputs[0]
