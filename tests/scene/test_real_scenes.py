"""Scenes of elastic indenters, measured moduli, layers and free gradients: what they mean, and what is refused."""

from pathlib import Path

import pytest
from inputs import scene_of
from marks import compiled, parametrize
from numpy.testing import assert_array_equal
from refusals import cases, is_told, refusal

from plgwear_jax import Layered, scene
from plgwear_jax._core.domains import RefusedError

POWER_LAW = "E0 = 110e9\nz0 = 1e-4\nk = 0.0"
LAYERS = "thickness = [2e-6, 3e-6]\nmodulus = [400e9, 200e9, 110e9]"
TABLE = 'table = "E.csv"'
CSV = "depth (um),modulus [GPa]\n0,400\n10,110\n"
STEEL = "indenter = { E = 210e9, nu = 0.3 }"
FREE = "vary = { modulus = { at = [1e-6, 1e-5, 1e-4], between = [[1e9, 2e9], [1e9, 2e9], [1e9, 2e9]] } }"


@pytest.fixture(autouse=True)
def _table(_folder):
    Path("E.csv").write_text(CSV)


def written(material=POWER_LAW, indenter="", design="", load="tangential_force = 0.32"):
    section = f"[design]\n{design}\n" if design else ""
    contact = f'kind = "fretting"\nradius = 5e-3\nnormal_force = 10.0\nfriction = 0.4\n{indenter}'
    return f"[material]\n{material}\nnu = 0.3\n[contact]\n{contact}\n[load]\n{load}\n{section}"


def loaded(more="", **given):
    return scene_of(written(**given) + more)


def complaint(**given):
    return refusal(scene.SceneError, lambda: loaded(**given).asked())


def test_the_contact_is_that_of_the_scene():
    contact = loaded(material=TABLE, indenter=STEEL).build_contact()
    assert_array_equal(contact.material.depth, [0.0, 1e-5])
    assert_array_equal(contact.material.modulus, [400e9, 110e9])
    assert (contact.material.nu, contact.indenter.E, contact.indenter.nu) == (0.3, 210e9, 0.3)
    layered = loaded(material=LAYERS).material.record()
    assert isinstance(layered, Layered) and layered.nu == 0.3
    assert_array_equal(layered.thickness, [2e-6, 3e-6])
    assert_array_equal(layered.modulus, [400e9, 200e9, 110e9])
    homogeneous = loaded(material="thickness = []\nmodulus = [110e9]").material.record()
    assert homogeneous.modulus_at(1e-5) == 110e9


@parametrize("indenter", ["", 'indenter = "rigid"'])
def test_a_rigid_indenter_is_none(indenter):
    assert loaded(indenter=indenter).build_contact().indenter is None


@compiled
def test_a_skin_that_would_be_pulled_is_told():
    skin = loaded('[output]\nquantities = ["wear_volume"]\n', material="thickness = [2e-6]\nmodulus = [400e9, 2e9]")
    with pytest.raises(ValueError, match="the pressure in the steady state would be negative"):
        skin.solve(digits=2)


@cases("scene/refused.toml", "bodies")
def test_what_is_refused(case):
    assert is_told(complaint(**case["given"]), case, "scene.toml")


@cases("scene/refused_tables.toml", "modulus")
def test_bad_tables_are_refused_in_a_line(case):
    Path("E.csv").write_text(case["content"])
    assert is_told(complaint(material=TABLE), case, "E.csv")


def test_a_punch_takes_a_power_law_alone():
    text = '[material]\ntable = "E.csv"\nnu = 0.3\n[contact]\nkind = "gross-slip"\nradius = 1e-3\ndepth = 1e-6\n'
    line = refusal(scene.SceneError, scene_of, text)
    assert line.endswith('kind = "gross-slip": needs a power law under [material], not a table')


def test_a_scene_has_the_digits_of_its_contact():
    given = loaded('[output]\nquantities = ["wear_volume"]\n', material=LAYERS)
    line = refusal(RefusedError, given.solve, digits=6)
    assert line == "digits = 6 is outside the allowed range 1 <= digits <= 5 of numeric contacts"


def test_a_free_gradient_has_no_other_commands():
    given = loaded(design=f'{FREE}\nminimise = "wear_volume"')
    for line in (refusal(scene.SceneError, given.design), refusal(scene.SceneError, given.front, distance=1e-6)):
        assert line.endswith("only plgwear design takes that")
