"""A scene to start from, and what editors know about scenes."""

import json
import os
import re
import sys
import tomllib
from pathlib import Path

import jsonschema
import pytest
from commands import plgwear, printed, refused
from inputs import DESIGNS
from marks import parametrize
from processes import python

from plgwear_jax import scene
from plgwear_jax._core.units import text_cells
from plgwear_jax.cli.new import FRETTING

SCENES = sorted(DESIGNS.glob("*.toml"))


@pytest.fixture(scope="module")
def validator():
    document = json.loads(plgwear("schema").stdout)
    jsonschema.Draft202012Validator.check_schema(document)
    return jsonschema.Draft202012Validator(document)


@parametrize("kind", ["fretting", "gross-slip"])
def test_a_new_scene_is_complete(validator, kind):
    line = "mine.toml: written; next: plgwear solve mine.toml, then plgwear design mine.toml\n"
    assert printed(f"new mine.toml --kind {kind}") == line
    assert printed("new b&c.toml").endswith("next: plgwear solve 'b&c.toml', then plgwear design 'b&c.toml'\n")
    found = scene.load("mine.toml")
    assert found.contact.kind == kind and found.design_space is not None and found.output is not None
    assert not list(validator.iter_errors(tomllib.loads(Path("mine.toml").read_text())))
    assert sorted(os.listdir()) == ["b&c.toml", "mine.toml"]


# A line that is commented out: the lines in whose place it is offered, where it is read, and what is read there.
OFFERED = {
    name: (instead, place, value)
    for name, instead, place, value in text_cells("""
    table           E0|z0|k                   material.kind                   a table
    thickness       E0|z0|k|+modulus          material.thickness              (0.0005,)
    shape           indenter                  contact.shape.exponent          4.0
    displacement    tangential_force          load.displacement               1e-06
    table_of_loads  tangential_force|+over    design_space.level              0.9
    history         tangential_force          load.history                    cycles.csv
    rig_stiffness   tangential_force|+displacement  load.rig_stiffness        20000000.0
    cycles          -                         wear.cycles                     1000000.0
    edge_pressure   -                         design_space.limits.edge_pressure.distance  1e-05
    penetration     -                         design_space.limits.penetration.below  3e-06
    contact_radius  hold                      design_space.limits.contact_radius.above  0.0001
    distance        -                         output.distance                 1e-05
    """)
}


@parametrize("name", OFFERED)
def test_every_line_that_is_commented_out_would_be_right(name):
    plgwear("new mine.toml")
    instead, place, value = OFFERED[name]
    text = Path("mine.toml").read_text().replace('# table = "loads', '# table_of_loads = "loads')
    for key in filter(None, [f"+{name}", *instead.split("|")]):
        old, new = (rf"^# ({key[1:]} = )", r"\1") if key[0] == "+" else (rf"^({key} = )", r"# \1")
        text = re.sub(old, new, text, count=1, flags=re.MULTILINE)
    Path("mine.toml").write_text(text.replace("table_of_loads", "table"))
    Path("loads.csv").write_text("tangential_force,weight\n0.3,1\n")
    Path("cycles.csv").write_text("tangential_force\n0.3\n")
    Path("E_of_z.csv").write_text("depth,modulus\n0,1e11\n1e-5,2e11\n")
    found = scene.load("mine.toml")
    for part in place.split("."):
        found = found[part] if isinstance(found, dict) else getattr(found, part)
    assert str(found) == value


def test_every_line_that_is_commented_out_is_tried():
    plgwear("new mine.toml")
    offered = re.findall(r"^# (\w+) = ", Path("mine.toml").read_text(), flags=re.MULTILINE)
    tried = {
        key.lstrip("+").removesuffix("_of_loads") for name in OFFERED for key in (name, *OFFERED[name][0].split("|"))
    }
    assert {*offered} <= tried


def test_a_new_scene_fits_into_a_terminal():
    """`plgwear --help` shows it, on 80 columns and with a margin."""
    assert max(map(len, FRETTING.splitlines())) <= 76


def test_what_is_there_is_not_written_over():
    Path("mine.toml").write_text("mine")
    for file, why in text_cells("""
        mine.toml     exists already; name another file
        mine.txt      must end in .toml
        no/mine.toml  cannot be written: No such file or directory
    """):
        assert refused(f"new {file}") == f"{file}: {why}"
    assert Path("mine.toml").read_text() == "mine"


@parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_schema_knows_every_scene(validator, path):
    assert not list(validator.iter_errors(tomllib.loads(path.read_text())))


@parametrize(
    "old, new, said",
    [
        *text_cells("""
    radius = 0.0125           raduis = 0.0125     raduis
    k = 0.0                   k = 1.0             exclusive
    kind = "fretting"         kind = "rolling"    rolling
    minimise = "wear_volume"  minimise = "price"  price
    [output]                  [outputs]           outputs
    """)
    ],
)
def test_the_schema_finds_what_is_wrong(validator, old, new, said):
    plgwear("new mine.toml")
    text = Path("mine.toml").read_text()
    assert text.count(old) >= 1
    assert said in " ".join(str(error) for error in validator.iter_errors(tomllib.loads(text.replace(old, new))))


def test_the_module_is_the_script():
    script = Path(sys.executable).with_name("plgwear")
    outputs = [python(*command, "--help").stdout for command in (["-m", "plgwear_jax"], [str(script)])]
    assert outputs[0] == outputs[1]
    assert "plgwear new SCENE.toml" in outputs[0] and "--install-completion" in outputs[0]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_a_full_disk_is_told_in_one_line():
    begin = "import sys; from plgwear_jax.cli import main; sys.stdout = open('/dev/full', 'w')"
    done = python("-c", f"{begin}; sys.argv[1:] = ['schema']; main()")
    assert (done.returncode, done.stderr) == (2, "standard output: no space is left on the device\n")


def test_the_schema_leaves_the_reader_as_it_was():
    plgwear("schema")
    Path("mine.toml").write_text(FRETTING.replace('minimise = "wear_volume"', 'minimise = "depth"'))
    with pytest.raises(scene.SceneError, match="depth is no quantity of a fretting contact; did you mean wear_depth"):
        scene.load("mine.toml").asked()
