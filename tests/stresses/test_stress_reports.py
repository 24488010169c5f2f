"""What commands and pictures say of stresses."""

import json

from commands import printed
from marks import compiled
from numpy.testing import assert_allclose

from plgwear_jax import FrettingContact, Layered
from plgwear_jax._core.units import written
from plgwear_jax.plots import stress_picture

SCENE = """
[material]
E0 = 110e9
z0 = 1e-4
k = {k}
nu = 0.3
[contact]
kind = "fretting"
radius = 5e-3
normal_force = 10.0
friction = 0.6
[load]
tangential_force = 3.0
[output]
quantities = ["peak_tension", "peak_mises"]
"""


def solved(tmp_path, k, *options):
    (tmp_path / "scene.toml").write_text(SCENE.format(k=k))
    return printed("solve", str(tmp_path / "scene.toml"), *options)


@compiled
def test_solve_says_where_stresses_are_largest(tmp_path):
    found = json.loads(solved(tmp_path, 0.2, "--json"))["quantities"]
    assert found["peak_tension"]["value"] < found["peak_mises"]["value"]
    assert ", x = -" in found["peak_tension"]["description"]
    assert "inf" in solved(tmp_path, -0.2)


@compiled
def test_the_picture_has_both_peaks_in_its_title(tmp_path):
    steady = FrettingContact(Layered([15e-6], [400e9, 210e9], 0.3), 5e-3, 10.0, 0.6).steady(3.0)
    axes = stress_picture(steady).axes[0]
    tension, mises = (written(float(peak), "Pa") for peak in (steady.peak_tension, steady.peak_mises))
    assert axes.get_title() == f"largest tension {tension}; largest von Mises stress {mises}"
    assert_allclose([steady.peak_tension, steady.peak_mises], [1.8170e9, 1.8506e9], rtol=1e-3)
    assert axes.get_ylim()[1] == 0.0
    solved(tmp_path, 0.0, "--picture", str(tmp_path / "stress.png"))
    assert (tmp_path / "stress.png").stat().st_size > 1000
