"""Designs for a number of cycles, and sweeps over cycles."""

import numpy as np
import pytest
from coated import COEFFICIENT
from coated import RIGID as CONTACT
from marks import compiled, long
from numpy.testing import assert_allclose, assert_array_equal
from reduced import Reduced

from plgwear_jax import material, optimise
from plgwear_jax.optimise.afterwards import overtaken_at

FORCE = 2.0
ASKED = {"vary": {"k": (-0.9, 0.9)}, "hold": "contact_radius", "law": COEFFICIENT}


@long  # to compile
def test_a_short_life_wants_a_stiff_surface_and_a_long_one_what_the_steady_state_wants():
    short = optimise.design(CONTACT, FORCE, **ASKED, cycles=5e5)
    assert short.variables["k"] == -0.9 and short.certified
    ever = optimise.in_steady_state(short)
    steady = optimise.design(CONTACT, FORCE, {"k": (-0.9, 0.9)}, hold="contact_radius")
    assert ever.best.variables == steady.variables
    assert ever.volume > ever.reference_volume > float(steady.value) and ever.best_by_then > 2.0 * float(short.value)
    # After so many lives both have worn the same.
    runs = (x.over_cycles(FORCE, COEFFICIENT) for x in (short.contact, steady.contact))
    one, other = (float(run.volume(ever.flips_at * 5e5)) for run in runs)
    assert_allclose(one, other, rtol=2e-3)

    long = optimise.design(CONTACT, FORCE, **ASKED, cycles=1e9)
    assert long.variables == steady.variables
    assert_allclose(long.value, steady.value, rtol=1e-3)
    assert optimise.in_steady_state(long).flips_at is None
    with pytest.raises(ValueError, match="in_steady_state takes a design for a number of cycles"):
        optimise.in_steady_state(steady)


@compiled
def test_the_best_exponent_for_a_life():
    """x stays when k changes: before the steady state the stiff surface is best, in the end what is best for ever."""
    phi, x = np.array([[0.1], [0.8]]), np.array([1.0, 6.0, 40.0, 1e6])
    found = optimise.optimal_exponent(phi, (-0.8, 0.8), life=x, nu=0.3, digits=2)
    assert found.k.shape == (2, 4) and np.all(found.certified)
    ever = optimise.optimal_exponent(phi[:, 0], (-0.8, 0.8))
    assert_allclose(found.k[:, -1], ever.k, atol=0.01)
    assert_allclose(found.wear_volume[:, -1], ever.wear_volume, rtol=1e-2)
    assert_array_equal(found.k[:, :2], -0.8)  # before the steady state
    assert found.k[1, 2] == 0.8 and np.all(found.at_bound[:, :2])
    # No exponent of a scan wears less.
    k = np.linspace(-0.8, 0.8, 33)[:, None, None]
    theta = np.asarray(material.tangential_ratio(k, 0.3))
    scan = Reduced(k, phi, digits=2).volume(x * theta)
    assert_allclose(np.min(scan, axis=0), found.wear_volume, rtol=1e-2)
    assert np.all(np.min(scan, axis=0) > 0.995 * np.asarray(found.wear_volume))


def test_a_saving_ends_where_it_last_changes_its_sign():
    lives = np.geomspace(1.0, 1e4, 9)
    more = 0.01 * np.log(lives / 3e2)
    assert_allclose(overtaken_at(lives, more), 3e2, rtol=1e-12)
    more[1] = 0.02  # once before
    assert_allclose(overtaken_at(lives, more), 3e2, rtol=1e-12)
    assert overtaken_at(lives, -more) is None and overtaken_at(lives, abs(more)) is None
