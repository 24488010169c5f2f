"""Cones and rounded flats on a homogeneous half-space beside ContactMechanics, a program by others with a square grid.

The numbers are those that `tests/reference/contact_mechanics.py` prints with ContactMechanics 1.8.3. Lengths are in
units of a length, forces in units of E* times its square.
"""

import numpy as np
import pytest

from plgwear_jax import Cone, FrettingContact, PowerLawGraded, RoundedFlat

SHARES = np.array([0.2, 0.4, 0.6, 0.8])  # of the contact radius, where the pressure is known
RECORDED = [
    # shape, force, contact radius, penetration, pressures, error of the pressures; with 512 cells a side
    (Cone(0.1), 0.15, 0.97785, 0.15350, [0.11451, 0.078303, 0.054888, 0.034589], 3e-3),
    # The pressure has a peak above the edge of the flat face, at 0.6, which the cells round off.
    pytest.param(
        *(RoundedFlat(0.6), 0.4, 0.99372, 0.23645, [0.093193, 0.10391, 0.14366, 0.16558], 6e-3),
        marks=pytest.mark.compiled,
    ),
]


@pytest.mark.parametrize("shape, force, radius, penetration, pressures, error", RECORDED, ids=["cone", "rounded flat"])
def test_a_program_by_others_finds_the_same_contact(shape, force, radius, penetration, pressures, error):
    one = FrettingContact(PowerLawGraded(1.0, 1.0, 0.0, 0.0), 1.0, force, 0.4, shape=shape)
    a = np.asarray(one.steady(0.0).contact_radius)
    np.testing.assert_allclose(a, radius, rtol=1e-3)  # a cell is 6e-3 of it
    np.testing.assert_allclose(one.steady(0.0).penetration, penetration, rtol=3e-5)
    np.testing.assert_allclose(one.steady(0.0).initial_pressure(a * SHARES), pressures, rtol=error)
