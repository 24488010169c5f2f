"""What lies in design/: the scenes are of believable sizes, show all that can be asked, and the studies run."""

import importlib
import re

import numpy as np
import pytest
from inputs import DESIGNS
from marks import compiled, long, parametrize
from numpy.testing import assert_array_equal

from plgwear_jax import scene

SCENES = {path.stem: scene.load(path) for path in sorted(DESIGNS.glob("*.toml"))}


@parametrize("name", SCENES)
def test_scenes_have_the_sizes_of_their_applications_and_can_be_made(name):
    given = SCENES[name]
    contact = given.build_contact()
    steady = contact.steady(given.load.largest)
    a_0 = steady.contact_radius
    assert 1e-5 < a_0 < 5e-3 and a_0 < 0.1 * contact.radius  # a shallow dome, as the paper's parabola is
    assert 50e6 < contact.normal_force / (np.pi * a_0**2) < 1e9  # Pa
    assert 0.02 < steady.amplitude < 0.9  # partial slip, and not by a hair
    assert 1e-9 < steady.deepest_wear < 2e-6  # m
    assert 1e-19 < steady.wear_volume < 1e-11  # m^3
    # The modulus is limited, or varies between limits, at 0.01 and 3 contact radii; a power law keeps them between.
    design = given.design_space
    window = design.variables.get("modulus") or design.limits["modulus"]
    shallow, deep = (z / a_0 for z in window["at"])
    assert 0.008 < shallow < 0.011 and 2.9 < deep < 3.3
    assert all(10e9 <= modulus <= 500e9 for ends in window["between"] for modulus in ends)


def test_scenes_together_show_what_can_be_asked():
    designs = [given.design_space for given in SCENES.values()]
    loads = [given.load for given in SCENES.values()]
    assert {name for design in designs for name in design.variables} == {"k", "E0", "z0", "modulus"}
    assert {design.hold for design in designs} == {None, "contact_radius"}
    assert {design.minimise for design in designs} == {"wear_volume", "worn_radius", "deepest_wear"}
    assert {design.level for design in designs} == {0.0, 0.9, 1.0}
    limits = {name for design in designs for name in design.allowed}
    assert limits == {"edge_pressure", "contact_radius", "penetration", "modulus_at", "peak_tension"}
    for kind in ("tangential_force", "table", "history"):
        assert any(getattr(load, kind) is not None for load in loads)


@pytest.fixture
def study(monkeypatch, tmp_path, capsys):
    """Run a study in this process; what it prints."""

    def run(name, **small):
        monkeypatch.syspath_prepend(DESIGNS)
        importlib.import_module(name).main(tmp_path, **small)
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        return capsys.readouterr().out

    return run


@compiled
def test_other_studies_run(study):
    for name in ("coating_window", "wear_against_edge_stress"):
        study(name, points=5)


@compiled
def test_the_overview_shows_that_the_amplitude_decides_which_gradient_wears_least(study):
    printed = study("overview", points=4)
    stiff, compliant = (
        [float(x) for x in re.findall(r"([-+][\d.]+) %", line)] for line in printed.splitlines() if "surface" in line
    )
    assert stiff[0] < 0.0 < compliant[0]  # at a small amplitude
    assert compliant[2] < 0.0 < stiff[2]


@long
def test_uncertain_load_is_best_by_its_own_measure(study):
    printed = study("uncertain_load", samples=5)
    assert "a global search found nothing better for any design: True" in printed
    excess = np.array(re.findall(r"\(([-+\d.e]+) %\)", printed), float).reshape(4, 3)
    assert_array_equal(np.diagonal(excess[1:]), 0.0)
    assert np.all(excess >= 0.0)
    assert np.all(excess[0] > 0.1)  # the mean amplitude is not what to design for


@long  # to compile; what it draws is tested in test_amplitudes.py and test_optimise.py
def test_amplitude_map_is_certified_and_marks_where_it_turns(study):
    printed = study("amplitude_map", points=40)
    assert printed.count("40 designs; nothing better found for 40") == 2
    leaves, reaches, falls_back = (
        [float(cell) for cell in line.split()[-3:]] for line in printed.splitlines() if "best k" in line
    )  # for abs(k) up to 0.95, 0.5 and 1
    assert leaves[2] < leaves[0] < leaves[1] < reaches[1] < reaches[0] < reaches[2]
    assert all(0.99 < phi < 1.0 for phi in falls_back)


@long
def test_the_rule_survives_in_thin_coatings_alone(study):
    printed = study("real_gradients", points=5, digits=3)
    assert "stiff beats compliant at phi = 0.01 in 6 of 12 pairs of coatings" in printed
    rows = [line.split() for line in printed.splitlines() if " layer " in line or " gradual " in line]
    assert len(rows) == 24
    assert {row[-1] == "never" for row in rows if row[0] == "3"} == {True}
    assert all(0.1 < float(row[-1]) < 0.4 for row in rows if row[0] == "0.3")


def test_all_pictures_begin_on_a_page_of_the_common_style():
    """The size in cm, the resolution and the colours are those of plots.style; nothing has its own."""
    root, own = DESIGNS.parent, re.compile(r"\bFigure\(figsize|rcParams\[|#D55E00|#0072B2|font\.family")
    places = [path for folder in ("plgwear_jax", "design", "benchmarks") for path in (root / folder).rglob("*.py")]
    found = {str(path.relative_to(root)) for path in places if own.search(path.read_text("utf-8"))}
    assert found <= {"plgwear_jax/plots/style.py"}
