"""Input that is possible, but probably in another unit: one warning for each question, which is answered."""

import dataclasses
import warnings

import jax
import jax.numpy as jnp
import numpy as np
from kinds import COEFFICIENT, LAW, contact_of
from marks import compiled_case, parametrize
from refusals import cases

from plgwear_jax import (
    DepthGraded,
    DoubtfulInputWarning,
    FrettingContact,
    GrossSlipContact,
    PowerLawGraded,
    optimise,
    sweep,
)
from plgwear_jax._core.doubts import of_design
from plgwear_jax.contact import slip_regimes
from plgwear_jax.fitting import fit_wear_coefficient
from plgwear_jax.loads import Displacement

ONE = contact_of(LAW)
WIDE = dataclasses.replace(ONE, radius=2.0)
THICK = dataclasses.replace(ONE, material=DepthGraded([1e-2, 1e-2], [200e9, 100e9], 0.3))
SOFT = FrettingContact(PowerLawGraded(1e4, 1e-4, 0.2, 0.3), radius=0.5, normal_force=10.0, friction=0.4)
BROAD = "radius = 2: is the indenter wider than 1 m? radius is in m"


def ask_all(run):
    return run.volume(1.0), run.volume(2.0), run.contact_radius(1.0)


ASKED = {
    "the steady state": (lambda: WIDE.steady(2.0).wear_volume, BROAD),
    "several quantities": (
        lambda: (steady := WIDE.steady(2.0)).stick_radius + steady.worn_radius,
        BROAD,
    ),
    "a run with its steady state": (
        lambda: ask_all(run := WIDE.over_cycles(2.0, COEFFICIENT)) and run.steady,
        BROAD,
    ),
    "a punch": (lambda: GrossSlipContact(LAW, 2.0, 1e-6).steady().initial_force, BROAD),
    "a design": (lambda: optimise.design(WIDE, 2.0, {"k": (-0.1, 0.1)}), BROAD),
    "a sweep": (
        lambda: sweep.sweep("contact_radius", contact=WIDE, normal_force=[9.0, 10.0]),
        BROAD,
    ),
    "a fit": (
        lambda: fit_wear_coefficient(WIDE, 2.0, [1e4, 1e5], [1e-17, 1e-16]),
        BROAD,
    ),
    "a layer": (
        lambda: THICK.steady(2.0),
        "thickness: a layer of 10 mm, thicker than the radius of the indenter, 5 mm? thickness is in m",
    ),
    "the onset": (lambda: SOFT.steady(0.0).gross_slip_displacement, "gross slip begins at "),
    "regimes": (lambda: slip_regimes(SOFT, [1e-3, 1e-2], [9.0, 10.0]), "gross slip begins at "),
    "a scar": (lambda: ask_all(ONE.over_cycles(2.0, 1e-9)), "99 % is worn after "),
    "a scar of gross slip": (
        lambda: ask_all(ONE.over_cycles(Displacement(1e-5), 1e-8)),
        "the scar is ten times as wide as the contact after ",
    ),
}


SLOW = "a scar of gross slip", "a run with its steady state", "regimes"


@parametrize("name", [compiled_case(name) if name in SLOW else name for name in ASKED])
def test_a_question_is_doubted_once_and_answered(name):
    ask, line = ASKED[name]
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        assert ask() is not None
    assert [one.category for one in heard] == [DoubtfulInputWarning]
    assert str(heard[0].message).startswith(line) and "\n" not in str(heard[0].message)
    assert heard[0].filename == __file__


def test_what_is_not_known_is_not_doubted():
    """Nor what is within the limits, nor the coefficients with which a fit searches: a warning here is an error."""
    jax.jit(lambda radius: dataclasses.replace(ONE, radius=radius).steady(2.0).wear_volume)(2.0)
    known = dataclasses.replace(ONE, radius=jnp.asarray(5e-3))
    jax.eval_shape(lambda force: known.steady(force).wear_volume, 2.0)
    jax.eval_shape(lambda K: ONE.over_cycles(2.0, K).volume(1.0), 1e-9)
    dataclasses.replace(ONE, radius=1.0).steady(2.0).wear_volume
    dataclasses.replace(THICK, radius=1e-2).steady(2.0)
    assert ONE.steady(0.0).gross_slip_displacement < 1e-3
    ONE.over_cycles(2.0, COEFFICIENT).volume(1e5)
    dataclasses.replace(ONE, radius=np.zeros(0)).steady(2.0)


@cases("core/doubts.toml", "designs", "said")
def test_designs_that_nobody_can_make_or_measure_are_doubted(case):
    depth = np.array([1e-6, 1e-3])  # m, beyond 0.1 to 3 contact radii
    modulus = 2e11 * (depth / 5e-5) ** case["exponent"]
    assert (of_design(depth, modulus, 5e-5, case["wear_depth"]) or "") == case["said"]
    assert "modulus = ... }; the wear is only 1 nm deep" in of_design(depth, 1e-5 * modulus, 5e-5, 1e-9)
