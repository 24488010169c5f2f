"""What shortens the start changes no result: a sample of all questions with it, from kept files, and without it."""

import json

import pytest
from inputs import DESIGNS
from numpy.testing import assert_allclose
from processes import output

QUESTIONS = """
import json, sys
from pathlib import Path
import jax
import numpy as np
jax.config.update("jax_enable_x64", True)
from plgwear_jax import FrettingContact, PowerLawGraded, fretting, optimise, scene
from plgwear_jax._core.startup import on, programs
from plgwear_jax.surfaces import Layered

if on("kept"):
    programs.keep_in(Path(sys.argv[1]), 2**24)
rest = dict(radius=5e-3, normal_force=10.0, friction=0.4)
closed = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.2, 0.3), **rest)
layers = FrettingContact(Layered(np.array([2e-6]), np.array([400e9, 110e9]), 0.3), **rest)
asked = scene.load(Path(sys.argv[2]) / "electrical_contact.toml")
steady = layers.steady(0.32)
cycles = np.geomspace(1e3, 1e7, 5)
found = optimise.design(closed, 0.32, {"k": (-0.9, 0.9)}, hold="contact_radius")
told = {
    "solve": {name: quantity.value for name, quantity in asked.solve().items()},
    "solve, layers": [steady.wear_volume, steady.worn_radius, steady.edge_pressure(1e-6)],
    "wear": closed.over_cycles(0.32, 1e-14).volume(cycles),
    "wear, layers": layers.over_cycles(0.32, 1e-14).volume(cycles),
    "design": [found.value, found.reference_value, optimise.compared(found).quantities],
    "the best exponent": found.variables["k"],
    "derivatives": jax.value_and_grad(fretting.wear_depth, (0, 1, 2))(0.97, 0.3, 0.4),
    "derivatives, layers": jax.value_and_grad(lambda force: layers.steady(force).wear_volume)(0.32),
    "derivatives by the contact, layers": jax.tree.leaves(
        jax.grad(lambda contact: contact.steady(0.32).wear_volume)(layers)
    ),
    "derivatives over cycles, layers": jax.grad(lambda force: layers.over_cycles(force, 1e-14).volume(1e5))(0.32),
}
numbers = {name: np.concatenate([np.ravel(x) for x in jax.tree.leaves(values)]) for name, values in told.items()}
print(json.dumps({name: list(map(float, values)) for name, values in numbers.items()}))
"""

# Closed forms differ by rounding. The best exponent lies where the slope of the objective is zero, and so has half of
# their digits. On layers the roots end with a step below 1e-10 (`special.root`); one more or less may come first.
ROUNDING, HALF, ROOTS = 1e-12, 1e-8, 1e-9


def told(folder, **variables):
    return json.loads(output("-c", QUESTIONS, folder, DESIGNS, without=("JAX_", "PLGWEAR_", "XLA_"), **variables))


@pytest.mark.compiled
def test_results_are_the_same_without_it(tmp_path):
    plain = told(tmp_path, PLGWEAR_STARTUP="")
    assert list(tmp_path.iterdir()) == []
    first = told(tmp_path)
    kept = {file.name for file in tmp_path.iterdir()}
    assert len(kept) > 5
    again = told(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == kept
    assert again.keys() == first.keys()
    for name, values in again.items():  # on layers NumPy rounds by where its matrices lie in memory
        assert_allclose(values, first[name], rtol=1e-13 if name.endswith("layers") else 0.0, err_msg=name)
    assert first.keys() == plain.keys()
    for name, values in first.items():
        assert len(values) == len(plain[name])
        allowed = HALF if name == "the best exponent" else ROOTS if name.endswith("layers") else ROUNDING
        assert_allclose(values, plain[name], rtol=allowed, err_msg=name)
