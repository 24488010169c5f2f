"""Contacts that would have to pull: shapes with a dimple, and stiff skins on soft layers.

On a homogeneous half-space f = A (r^4 - q r^2) has, by the image g = A (8/3 x^4 - 2 q x^2) of the method of
dimensionality reduction,

    p(0) = E*/pi int_0^a g'/x dx = E* A/pi (32/9 a^3 - 4 q a),      F = 2 E* int_0^a (g(a) - g) dx,

so that p(0) is negative below a^2 = 9/8 q, where F still grows with a. A groove f, whose image has g' = x h(x^2), has

    p(r) = E*/pi int_0^l h(r^2 + t^2) dt,      l^2 = a^2 - r^2.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kinds import STEEL, contact_of, dome
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from scipy import optimize

from plgwear_jax import FrettingContact, Layered, PowerLawGraded, Shape
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.optimise import design
from plgwear_jax.steady.state import solved_states
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.sweep import sweep
from plgwear_jax.wear_laws import PressurePower

E, NU, A, RADIUS = 110e9, 0.3, 1e7, 1e-4
LAW = PowerLawGraded(E, 1e-4, 0.0, NU)
BODIES = {
    "a power law": (LAW, None),
    "a power law under steel": (LAW, STEEL),
    "layers": (Layered([2e-5, 3e-5], [E, E, E], NU), None),
}
# A stiff skin on soft layers bends, and its middle lifts off the indenter as that is worn around it.
SKIN = FrettingContact(Layered([2e-5, 3e-5], [200e9, 4e9, 6e9], 0.3), 14e-3, 4.6, 0.6)
LIMIT = 0.6 * 4.6
LINE = "the pressure in the steady state would be negative at r = .* of the mean.*the contact would open there"


class Dimple(Shape):
    """An indenter that is lower around its middle."""

    q: Any

    def height(self, r, radius):
        return A * (r**4 - self.q * r**2)


def dimpled(body, q):
    """(A contact of the radius 1e-4 m, p(0) over its mean pressure), for q over its square."""
    material, indenter = BODIES[body]
    plane = 1.0 / ((1.0 - NU**2) * (1.0 / E + (1.0 / STEEL.E if indenter else 0.0)))
    force = 2.0 * plane * A * RADIUS**5 * (32.0 / 15.0 - 4.0 / 3.0 * q)
    share = (32.0 / 9.0 - 4.0 * q) / (2.0 * (32.0 / 15.0 - 4.0 / 3.0 * q))
    return FrettingContact(material, 5e-3, force, 0.4, indenter, Dimple(q * RADIUS**2)), share


@parametrize("body", ["a power law", compiled_case("a power law under steel"), "layers"])
def test_a_dimple_is_refused_once_its_middle_would_pull(body):
    presses, share = dimpled(body, 0.87)
    assert 0.0 < share < 0.1
    assert_allclose(presses.steady(0.0).contact_radius, RADIUS, rtol=1e-6)
    mean = presses.normal_force / (np.pi * RADIUS**2)
    assert float(presses.steady(0.0).initial_pressure(1e-9)) / mean == pytest.approx(share, abs=1e-3)
    pulls, share = dimpled(body, 0.97)
    assert -0.25 < share < -0.15
    with pytest.raises(ValueError, match=r"before any wear would be negative at r = .*the contact") as error:
        pulls.steady(0.0).contact_radius
    told = float(str(error.value).split("(")[1].split(" ")[0])
    assert told == pytest.approx(share, abs=0.02)


class Groove(Shape):
    """An indenter with h(u) = 1 - b u + d u^2, for u over the square of 1e-4 m."""

    b: Any
    d: Any

    def height(self, r, radius):
        u = (r / RADIUS) ** 2
        return A * RADIUS**4 * u * (0.25 + u * (5.0 / 96.0 * self.d * u - 3.0 / 32.0 * self.b))

    def pressure(self, r, a):
        """Of the contact radius a, in units of E*/pi A RADIUS^3; radii in those of 1e-4 m."""
        u, v = r * r, a * a - r * r
        return np.sqrt(v) * (1.0 - self.b * (u + v / 3.0) + self.d * (u * u + 2.0 * u * v / 3.0 + v * v / 5.0))

    def force(self, a):
        """That pressure times the area."""
        t, weight = np.polynomial.legendre.leggauss(40)
        turn = 0.25 * np.pi * (1.0 + t)
        return 0.5 * np.pi**2 * a * a * weight @ (np.sin(turn) * np.cos(turn) * self.pressure(a * np.sin(turn), a))


@parametrize(
    "groove, a, phi, stick, pulls, most",
    [
        (Groove(5.0, 5.0), 1.0, 0.3, (0.9, 1.0), 1, 0.03),  # within the stick area
        (Groove(4.4, 4.2), 0.95, 0.75, (0.2, 0.4), 0, 0.01),  # around it
    ],
)
def test_a_groove_would_pull_at_its_own_place(groove, a, phi, stick, pulls, most):
    """The tension is that before any wear under F_N, or under the force (1 - phi) F_N of the stick area."""
    unit = E / (1.0 - NU**2) * A * RADIUS**5 / np.pi
    contact = FrettingContact(LAW, 5e-3, unit * groove.force(a), 0.4, None, groove)
    c = optimize.brentq(lambda c: groove.force(c) - (1.0 - phi) * groove.force(a), *stick)
    share, place = [], np.linspace(0.0, 0.98, 400)
    for radius in (a, c):
        share.append(groove.pressure(place * radius, radius) * np.pi * radius**2 / groove.force(radius))
    scaled = share / np.sqrt(1.0 - place**2)
    least = np.argmin(scaled, -1)
    assert np.argmin(scaled.min(-1)) == pulls
    found = solved_states(effort_of(None), contact, jnp.asarray(phi * 0.4 * contact.normal_force)).least
    assert_allclose(found.share[0], share[pulls][least[pulls]], rtol=most)
    assert_allclose(found.r[0], (a, c)[pulls] * place[least[pulls]] * RADIUS, rtol=0.05)
    assert_array_equal(found.pulled, [1.0, pulls])


@parametrize("body", ["a power law", "layers"])
def test_where_less_force_would_pull_nothing_is_said_of_more(body):
    """(1 - phi) F_N, that presses the stick area, has less area than the dimple."""
    contact, _ = dimpled(body, 0.8)
    assert np.isfinite(contact.steady(0.0).contact_radius)
    with pytest.raises(ValueError, match="before any wear would be negative"):
        contact.steady(0.7 * 0.4 * contact.normal_force).wear_volume


@compiled
def test_a_traced_dimple_is_nan():
    contact, _ = dimpled("layers", 0.97)
    found = jax.jit(lambda force: (contact.steady(0.0).contact_radius, contact.steady(force).wear_volume))(0.1)
    assert np.all(np.isnan(found))


def test_tension_in_the_steady_state_is_said_with_its_place():
    steady = SKIN.steady(0.9 * LIMIT)
    for worn in ("wear_volume", "worn_radius", "penetration", "deepest_wear", "edge_intensity"):
        with pytest.raises(ValueError, match=LINE):
            getattr(steady, worn)
    for field in ("pressure", "wear_depth", "profile", "traction", "steady_displacement", "edge_pressure"):
        with pytest.raises(ValueError, match=LINE):
            getattr(steady, field)(1e-5)


def test_what_is_before_any_wear_stays():
    steady, little = SKIN.steady(0.9 * LIMIT), SKIN.steady(0.3 * LIMIT)
    assert little.wear_volume > 0.0
    assert_allclose(steady.contact_radius, little.contact_radius, rtol=1e-9)
    assert_allclose(steady.initial_pressure(1e-5), little.initial_pressure(1e-5), rtol=1e-9)
    assert 0.0 < steady.stick_radius < little.stick_radius
    assert steady.energy_per_cycle > little.energy_per_cycle > 0.0


def test_members_of_batches_are_nan():
    found = SKIN.steady(LIMIT * np.array([0.1, 0.3, 0.9])).wear_volume
    assert_array_equal(np.isnan(found), [False, False, True])


@compiled
def test_traced_tension_is_nan():
    def asked(force):
        steady = SKIN.steady(force)
        return steady.wear_volume, steady.pressure(1e-5), steady.energy_per_cycle

    volume, pressure, energy = jax.jit(asked)(0.9 * LIMIT)
    assert np.isnan(volume) and np.isnan(pressure) and energy > 0.0
    assert np.isnan(jax.jit(lambda force: SKIN.over_cycles(force, 1e-14).volume(1e5))(0.9 * LIMIT))


def test_runs_in_rings_are_refused():
    with pytest.raises(ValueError, match=LINE):
        SKIN.over_cycles(0.9 * LIMIT, 1e-14).volume(1e5)


@parametrize(
    "load",
    [
        Force(0.9 * LIMIT),
        compiled_case(Displacement(1.4e-6)),
        compiled_case([Block(0.9 * LIMIT, 1e7)]),
    ],
    ids=("force", "displacement", "block"),
)
def test_marches_find_the_tension_by_themselves(load, monkeypatch):
    monkeypatch.setenv("PLGWEAR_STARTUP", "")  # NumPy would give up, after half of the time that the compiler takes
    with pytest.raises(ValueError, match=r"the pressure after .* cycles would be negative at r = "):
        SKIN.over_cycles(load, PressurePower(1e-14, 1.0)).volume(1e4)


@compiled
def test_marches_of_the_stiffest_surfaces_are_followed():
    """Pressures of single cells swing there, next to the stick-slip boundary and in the middle."""
    contact = dome(-0.85)
    for phi in (0.5, 0.975):
        run = contact.over_cycles(phi * 4.0, PressurePower(1e-14, 1.0))
        assert_allclose(run.volume(run.lasting_cycles), contact.steady(phi * 4.0).wear_volume, rtol=0.05)


@compiled
def test_designs_say_that_no_candidate_is_left():
    with pytest.raises(ValueError, match="no candidate has a wear_volume: " + LINE):
        design(SKIN, 0.9 * LIMIT, {"material.thickness[0]": (1.8e-5, 2.2e-5)})


@compiled
def test_sweeps_mark_tension_and_go_on():
    found = sweep(("wear_volume", "energy_per_cycle"), contact=SKIN, tangential_force=LIMIT * np.array([0.1, 0.9, 0.3]))
    assert_array_equal(np.isnan(found["wear_volume"]), [False, True, False])
    assert np.all(found["energy_per_cycle"] > 0.0)


def test_derivatives_in_single_precision_can_be_traced():
    """Places and flags of the least pressures have the precision of the contact: the rule of derivatives needs it."""
    one = jax.tree.map(jnp.float32, contact_of(Layered([2e-5], [50e9, 100e9], 0.3)))
    found = jax.eval_shape(lambda one: jax.jvp(lambda x: x.steady(1.0).wear_volume, (one,), (one,)), one)
    assert {x.dtype for x in found} == {jnp.dtype("float32")}
