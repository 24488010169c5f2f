"""Which layers and which thickness wear least: one design, in Python and on the command line."""

import numpy as np
import pytest
from coated import on
from commands import told
from inputs import DESIGNS, scene_of
from marks import compiled
from numpy.testing import assert_allclose, assert_array_equal

from plgwear_jax import Elastic, FrettingContact, Layered, optimise, scene
from plgwear_jax.loads import Force

LAYERS = DESIGNS / "coatings" / "layers.toml"
FORCE, TUNGSTEN = 0.4, Elastic(410e9, 0.28)
CONTACT = FrettingContact(Layered([5e-6, 5e-6], [220e9, 55e9, 110e9], 0.3), 5e-3, 10.0, 0.4, TUNGSTEN)
VARY = {"material.thickness[0]": (1e-6, 1e-4), "material.thickness[1]": (1e-6, 1e-4)}
LIMITS = {"contact_radius": {"above": 7.334e-5}}


def test_an_input_file_asks_what_python_asks():
    given = scene.load(LAYERS).arguments()
    assert given["vary"] == VARY and given["load"] == Force(FORCE) and given["hold"] is None
    assert given["limits"] == {name: [one] for name, one in LIMITS.items()}
    material = given["contact"].material
    assert isinstance(material, Layered) and given["contact"].indenter == TUNGSTEN
    assert_array_equal(material.thickness, [5e-6, 5e-6])
    assert_array_equal(material.modulus, [220e9, 55e9, 110e9])


@compiled
@pytest.mark.usefixtures("here")
def test_the_command_line_finds_the_least_of_a_grid():
    found = told("design", str(LAYERS), "--sensitivities")
    best = found["best"]
    assert best["edge_exponent"] == -0.5
    assert_allclose(best["contact_radius"], 7.334e-5, rtol=1e-6)
    # A tenth around the best, and far from it.
    first, second = (best[name] * np.geomspace(0.5, 2.0, 15) for name in VARY)
    steady = on(CONTACT, thickness=np.stack(np.broadcast_arrays(first[:, None], second), -1)).steady(FORCE)
    volumes = np.where(steady.contact_radius >= 7.334e-5, steady.wear_volume, np.inf)
    assert 0.995 * np.min(volumes) <= best["wear_volume"] <= 1.0001 * np.min(volumes)
    of_element = found["sensitivities"]["variables"]["material.modulus[1]"]
    step, moved = 1e-2, []
    for side in (step, -step):
        other = on(CONTACT, modulus=CONTACT.material.modulus * np.exp([0.0, side, 0.0]))
        moved.append(optimise.design(other, FORCE, VARY, limits=LIMITS).variables)
    differences = {name: np.log(moved[0][name] / moved[1][name]) / (2.0 * step) for name in VARY}
    assert of_element == pytest.approx(differences, rel=2e-2, abs=2e-2)


@compiled
def test_a_thickness_may_be_uncertain(tmp_path):
    text = LAYERS.read_text("utf-8")
    text = text.replace(', "material.thickness[1]" = [1e-6, 1e-4] }', ' }\nscenarios = "scatter.csv"\nover = "worst"')
    found = scene_of(text, tmp_path, scatter="material.thickness[1]\n4e-6\n5e-6\n7e-6\n").design()
    thickness = np.stack(np.broadcast_arrays(found.variables["material.thickness[0]"], [4e-6, 5e-6, 7e-6]), -1)
    cases = on(CONTACT, thickness=thickness).steady(FORCE)
    assert_allclose(found.value, np.max(cases.wear_volume), rtol=1e-5)
    assert np.min(cases.contact_radius) >= 7.334e-5 * (1.0 - 1e-5)
