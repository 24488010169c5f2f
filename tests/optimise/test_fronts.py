"""Trade-offs between any two quantities, against the contacts of a dense grid."""

import numpy as np
import pytest
from coated import HOLD, LIFE, PUNCH, RIGID, held, on
from commands import told, write
from marks import compiled, parametrize
from numpy.testing import assert_allclose
from refusals import data
from test_designs_of_any_quantity import SCENE

from plgwear_jax import optimise
from plgwear_jax._core import catalogue

FORCE = 1.0
BOUNDS = {"k": (-0.5, 0.5), "friction": (0.3, 0.8)}
K, FRICTION = np.linspace(-0.5, 0.5, 201), np.geomspace(0.3, 0.8, 41)


def is_the_envelope(curve, x, y, within, rounding=1e-9):
    """No contact of the grid has less y for as much x, and the best of them has hardly more. Larger is turned round."""
    assert np.all(curve.certified)
    sides = [-1.0 if one in curve.larger else 1.0 for one in "xy"]
    logs = [side * np.log(one) for side, one in zip(sides, (x, y), strict=True)]
    fronts = [side * np.log(one) for side, one in zip(sides, (curve.x, curve.y), strict=True)]
    assert np.all(np.diff(fronts[0]) > 0.0) and np.all(np.diff(fronts[1]) < rounding)
    for allowed, least in zip(*fronts, strict=True):
        kept = logs[0] <= allowed - rounding
        assert not np.any(kept) or least <= logs[1][kept].min() + rounding
    # Beyond the first end nothing is possible, and the last end has the best of all.
    assert logs[0].min() >= fronts[0][0] - rounding
    assert logs[1].min() - within < fronts[1][-1] < logs[1].min() + rounding


def test_the_front_lies_between_least_wear_and_least_pressure():
    force, weight = np.array([0.5, 1.0]), np.array([0.75, 0.25])
    limits = {"penetration": {"below": 8.5e-7}}  # which is reached where the wear is least
    asked = {"hold": HOLD, "weight": weight, "distance": 1e-6, "limits": limits}
    curve = optimise.front(RIGID, force, {"k": (-0.9, 0.9)}, points=5, **asked)
    assert curve.ends == ("k at its upper bound", "highest indentation depth allowed")

    # The grid, the contacts of the curve and the reference.
    k = np.concatenate([np.linspace(-0.9, 0.9, 401), curve.variables["k"], [0.0]])
    steady = held(k[:, None]).steady(force)
    kept = steady.penetration[:401, 1] <= 8.5e-7
    both = np.stack([steady.edge_pressure(1e-6)[:, 1], steady.wear_volume @ weight])
    assert not np.all(kept)
    is_the_envelope(curve, *both[:, :401][:, kept], within=0.01)
    assert_allclose([curve.x, curve.y], both[:, 401:-1], rtol=1e-9)
    assert_allclose([curve.reference_x, curve.reference_y], both[:, -1], rtol=1e-9)


@compiled
@parametrize("x, y, larger", data("optimise/numbers.toml")["fronts"])
def test_no_contact_of_a_grid_is_better(x, y, larger):
    curve = optimise.front(RIGID, FORCE, BOUNDS, x, y, larger=larger, points=5)
    contacts = on(RIGID, k=K[:, None], friction=FRICTION)
    both = []
    for asked in (x, y):
        ((name, places),) = ({asked: {}} if isinstance(asked, str) else asked).items()
        both.append(np.broadcast_to(catalogue.read(contacts, name, FORCE, places), (K.size, FRICTION.size)).ravel())
    is_the_envelope(curve, *both, within=0.02)
    assert curve.x_name in catalogue.FRETTING and curve.larger == larger


@compiled
@parametrize("x, rounding", [("wear_volume", 1e-6), ("transient.contact_radius", 1e-5)])
def test_wear_after_a_life(x, rounding):
    """Against the wear for ever, where one name means two quantities, and against the radius of the scar by then."""
    curve = optimise.front(RIGID, FORCE, {"k": (-0.5, 0.5)}, x, points=5, hold=HOLD, **LIFE)
    run = held(K).over_cycles(FORCE, LIFE["law"])
    against = run.steady.wear_volume if x == "wear_volume" else run.contact_radius(LIFE["cycles"])
    both = against, run.volume(LIFE["cycles"])
    is_the_envelope(curve, *both, within=0.01, rounding=rounding)


@compiled
def test_a_punch_trades_its_force_for_its_wear():
    curve = optimise.front(PUNCH, None, {"k": (-0.5, 0.5)}, "steady_force", larger="x", points=4)
    punches = on(PUNCH, k=K)
    is_the_envelope(curve, punches.steady().steady_force, punches.steady().volume_change, within=0.01)
    assert curve.best == ("largest steady force", "least effective volume worn off")


@compiled
@pytest.mark.usefixtures("here")
def test_the_command_line_trades_any_two_quantities():
    write(SCENE.partition("[design.limits]")[0])
    found = told("front mine.toml --x wear_volume --y stick_radius --larger y --points 3")
    assert found["units"] == {"wear_volume": "m^3", "stick_radius": "m", "friction": "1", "k": "1"}
    curve = optimise.front(RIGID, FORCE, BOUNDS, "wear_volume", "stick_radius", larger="y", points=3)
    assert_allclose([found["wear_volume"], found["stick_radius"]], [curve.x, curve.y], rtol=1e-9)
