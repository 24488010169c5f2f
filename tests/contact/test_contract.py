"""What a contact promises whichever engine solves it, in closed form or numerically: one test for each promise.

The contacts are those of `kinds`, the loads `LOADS`. A tolerance belongs to an engine and to its digits, and stands at
the top of its section.
"""

import functools

import batches
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from dependence import PLACES
from functions import by_numpy
from kinds import COEFFICIENT, FRICTION, KINDS, LAYERS, LIMIT, STEEL, contact_of, dome
from marks import compiled, compiled_case, long_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import data

from plgwear_jax import DepthGraded, Elastic, PowerLawGraded, PowerShape
from plgwear_jax._core.catalogue import FRETTING, STRESSES
from plgwear_jax.contact import is_closed
from plgwear_jax.loads import Displacement, Force
from plgwear_jax.shapes import shape_of

F_X, RIG = 0.5 * LIMIT, 3e7
SHARES = np.array([0.003, 0.03, 0.1, 0.3, 0.5, 0.8, 0.95, 0.99])  # all ask for so many cycles, by one program
RIGS = {"displacement": None, "rig": RIG}


def load_of(one, load, force):
    """The force amplitude, or the displacement amplitude that it causes before any wear, in a rig or without."""
    if load == "force":
        return force
    return Displacement(one.steady(Force(force, RIGS[load])).displacement_amplitude, RIGS[load])


CONTACTS = KINDS | {
    "two homogeneous bodies": contact_of(Elastic(110e9, 0.25), STEEL),
    "a power law stiff at its surface under steel": dome(-0.4, STEEL),
}


# --- both engines agree where both answer ---------------------------------------------------------------------------

PHI = np.array([0.01, 0.3, 0.7, 0.98])
TANGENTIAL = "gross_slip_displacement", "displacement_amplitude", "worn_displacement_amplitude", "energy_per_cycle"


def nearly_rigid(k):
    return dome(k, Elastic(1e20, 0.3)), dome(k)


IN_SERIES = (1.0 - 0.25**2) / 110e9 + (1.0 - STEEL.nu**2) / STEEL.E
EXPONENTS = np.array([-0.6, -0.3, -0.02, 0.0, 0.02, 0.4, 0.8])[:, None]
PAIRS = {
    "a nearly rigid indenter": nearly_rigid(EXPONENTS),
    "one modulus": (
        contact_of(DepthGraded([1e-5, 2e-5, 5e-5, 1e-4], np.full(4, 110e9), 0.25), STEEL),
        CONTACTS["two homogeneous bodies"],
    ),
    "two homogeneous bodies": (
        CONTACTS["two homogeneous bodies"],
        contact_of(PowerLawGraded(1.0 / IN_SERIES, 1e-4, 0.0, 0.0)),
    ),
    "a parabola as a shape": (contact_of(LAYERS, STEEL, PowerShape(2.0)), KINDS["layers under steel"]),
}


def everything(steady, r, distance, but=()):
    """All of the catalogue but some, and what it does not have, by name."""
    at = PLACES | {"r": r, "distance": distance}
    asked = {name: [at[x] for x in law.arguments if x in at] for name, law in FRETTING.items() if name not in but}
    asked |= {name: [] for name in TANGENTIAL} | {"slip_amplitude": [r]}
    return {name: getattr(steady, name)(*given) if given else getattr(steady, name) for name, given in asked.items()}


def values(function, steady):
    return by_numpy(function)() if is_closed(steady.contact) else function()


def compared(pair, name):
    """Where the two have to agree."""
    if pair == "two homogeneous bodies" and name in (*TANGENTIAL, "slip_amplitude", "modulus_at"):
        return np.False_  # the tangential compliance and the modulus of the half-space itself are others
    if pair == "a nearly rigid indenter" and name == "edge_intensity":
        return EXPONENTS >= 0.0  # near enough to the edge a surface without compliance leaves it to any indenter
    return np.True_


# The relative error, of fields relative to a hundredth of their largest value where they are less.
@parametrize(
    "pair, digits, most",
    [
        ("two homogeneous bodies", None, 1e-12),
        compiled_case("a nearly rigid indenter", 4, 1e-4),
        compiled_case("one modulus", 5, 1e-5),
        compiled_case("a parabola as a shape", 4, 1e-7),
        long_case("a nearly rigid indenter", 5, 1e-5),
        long_case("one modulus", 4, 1e-4),
    ],
)
def test_steady_states_of_both_engines_agree(pair, digits, most):
    force = LIMIT * PHI
    one, other = (each.steady(force, digits=n) for each, n in zip(PAIRS[pair], (digits, None), strict=True))
    # NumPy computes the closed forms: XLA would need seconds to compile them.
    c, outer = values(lambda: (other.stick_radius, other.worn_radius), other)
    r = np.stack([0.0 * c, 0.5 * c, 0.9 * c, *(c + part * (outer - c) for part in (0.1, 0.5, 0.9, 1.2))])
    # Of other Poisson's ratios, stresses are others.
    but = STRESSES if pair == "two homogeneous bodies" else ()
    found, exact = (values(lambda each=each: everything(each, r, 0.1 * c, but), each) for each in (one, other))
    for name, expected in exact.items():
        scale = np.maximum(abs(expected), 1e-2 * np.max(abs(expected))) if np.ndim(expected) > c.ndim else abs(expected)
        good = abs(found[name] - expected) <= (1e-3 if name in STRESSES else most) * scale
        good |= np.isinf(expected) & (found[name] == expected)
        assert np.all(good | ~compared(pair, name)), name


def test_slopes_by_the_exponent_at_zero_are_those_beside_it_and_those_of_differences():
    """There the term of the compliance that leads at short waves changes."""

    def results(k):
        steady = contact_of(PowerLawGraded(200e9, 1e-4, k, 0.25), STEEL).steady(F_X)
        ring = steady.wear_depth(0.5 * (steady.stick_radius + steady.worn_radius))
        return jnp.log(jnp.stack([steady.stick_radius, steady.worn_radius, steady.wear_volume, ring]))

    both = by_numpy(lambda k: jnp.stack(jax.jvp(results, (k,), (1.0,))))
    (_, at), (low, below), (high, above) = map(both, np.array([0.0, -1e-3, 1e-3]))
    assert_allclose(at, 0.5 * (below + above), rtol=1e-4)
    assert_allclose(at, (high - low) / 2e-3, rtol=1e-4)


# --- both engines agree over cycles -----------------------------------------------------------------------------------

WEARING = {f"k = {k}": nearly_rigid(k) for k in (-0.6, -0.4, -0.3, 0.4, 0.7)}
WEARING |= {pair: PAIRS[pair] for pair in ("one modulus", "a parabola as a shape")}


@functools.cache
def runs(pair, load):
    """(The runs of both engines, cycles after which the shares are worn)."""
    numeric, closed = (each.over_cycles(load_of(each, load, F_X), COEFFICIENT) for each in WEARING[pair])
    return numeric, closed, closed.cycles_to(SHARES)


@compiled
@parametrize("pair, load, of_fields, most", data("contact/apart.toml")["runs"])
def test_runs_of_both_engines_agree(pair, load, of_fields, most):
    numeric, closed, cycles = runs(pair, load)
    r = np.linspace(0.0, closed.steady.worn_radius, 101)[:, None]
    for name in ("volume", "rate", "contact_radius", "stick_radius", "force_amplitude", "deepest_wear"):
        found, expected = (getattr(each, name)(cycles) for each in (numeric, closed))
        # Where the displacement is held, the stick radius moves by whole cells.
        bound = max(most, 2e-4) if name == "stick_radius" else most
        assert_allclose(found, expected, rtol=0.0, atol=bound * np.max(expected), err_msg=name)
    for name in ("depth", "profile"):
        found, expected = (getattr(each, name)(r, cycles) for each in (numeric, closed))
        assert_allclose(found, expected, rtol=0.0, atol=of_fields * np.max(expected), err_msg=name)
    assert_allclose(numeric.cycles_to(SHARES), cycles, rtol=most)


# --- the life of a contact --------------------------------------------------------------------------------------------


@parametrize(
    "kind, load",
    [
        ("layers under steel", "force"),
        *(compiled_case(*case) for case in (("closed forms", "force"), ("closed forms", "rig"), ("a shape", "force"))),
    ],
)
def test_it_wears_from_the_energy_of_friction_to_its_steady_state(kind, load):
    one = CONTACTS[kind]
    steady, run = one.steady(F_X), one.over_cycles(load_of(one, load, F_X), COEFFICIENT)
    first = steady.energy_per_cycle * COEFFICIENT / FRICTION
    begin, early, later, end = run.volume(np.resize([0.0, 1e-3, 0.1, 1e13], SHARES.shape))[:4]
    assert begin == 0.0
    assert_allclose([early, later], first * np.array([1e-3, 0.1]), rtol=1e-5 if load == "force" else 1e-2)
    assert_allclose(run.force_amplitude(0.0), F_X, rtol=1e-14 if load == "force" else 1e-2)
    if load == "force":
        assert_allclose(end, steady.wear_volume, rtol=1e-9)
    else:
        assert end < 0.99 * steady.wear_volume
    assert_allclose(run.volume(run.cycles_to(SHARES)), SHARES * end, rtol=1e-9)
    r = 0.5 * (steady.stick_radius + steady.worn_radius)
    assert_allclose(steady.profile(r), shape_of(one).height(r, one.radius) + steady.wear_depth(r), rtol=1e-12)


# --- what JAX is promised ---------------------------------------------------------------------------------------------


@compiled
@parametrize("kind, count", [("a table under steel", 1000), ("a shape", 3), ("closed forms", 1000)])
def test_a_batch_gives_what_its_members_give(kind, count):
    def volume(contact, force):
        return contact.steady(force).wear_volume

    given, at = batches.scattered(kind, count), count * 617 // 1000
    volumes = volume(*given)
    assert volumes.shape == (count,)
    assert_allclose(volumes[at], volume(*jax.tree.map(lambda x: x[at], given)), rtol=1e-9)


@compiled
@parametrize("kind", ["layers under steel", "a shape"])
def test_outside_of_partial_slip_it_is_nan_under_jit(kind):
    contact, r = CONTACTS[kind], 6e-5

    @jax.jit
    def fields(forces):
        steady = contact.steady(forces)
        return jnp.stack([steady.wear_volume, steady.wear_depth(r), steady.slip_amplitude(r), steady.pressure(r)])

    found = fields(jnp.array([F_X, 2.0 * LIMIT, 0.0]))
    assert_array_equal(np.isnan(found), [[False, True, False]] * 4)
    assert_allclose(found[:, 2], [0.0, 0.0, 0.0, contact.steady(0.0).initial_pressure(r)], rtol=1e-6)


# --- what is refused --------------------------------------------------------------------------------------------------

DIGITS = {
    "closed forms": ("1 <= digits <= 15", "1 <= digits <= 5 of wear over"),
    "layers under steel": ("1 <= digits <= 5", "1 <= digits <= 4 of wear over cycles of numeric contacts"),
}


@parametrize("kind", DIGITS)
def test_more_digits_than_there_are_are_refused(kind):
    contact, (steady, over_cycles) = CONTACTS[kind], DIGITS[kind]
    for digits, call, told in (
        (int(steady.split()[-1]) + 1, lambda n: contact.steady(F_X, digits=n), steady),
        (6, lambda n: contact.over_cycles(F_X, COEFFICIENT, digits=n).volume(1e4), over_cycles),
        (3, lambda n: contact.over_cycles(Displacement(1e-7), COEFFICIENT, digits=n), "1 <= digits <= 2 for this test"),
    ):
        with pytest.raises(ValueError, match=f"digits = {digits} is outside the allowed range {told}"):
            call(digits)
