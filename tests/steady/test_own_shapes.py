"""Indenters of any shape, each a class of this file, against formulas of one integral each on a power law.

With f(r), s = (1+k)/2, sigma = sin(pi s)/pi and the stiffness c_N of the half-space,

    g(x)  = x times the integral over t from 0 to pi/2 of f'(x sin t) cos^k t
    F(a)  = 2 c_N times the integral over x from 0 to a of x^k (g(a) - g(x)),     F(a_0) = F_N,  F(c) = (1-phi) F_N
    d_inf = g(c) + phi F_N (1+k)/(2 c_N c^(1+k))
    h(r)  = sigma times the integral over T from c^2 to r^2 of T^(s-1) (r^2-T)^(-s) (d_inf - g(sqrt T)),    h(a_inf) = 0
    V     = pi sigma/(1-s) times that of T^(s-1) (a_inf^2-T)^(1-s) (d_inf - g(sqrt T)) up to a_inf^2.
"""

import dataclasses
import gc
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq

from plgwear_jax import Elastic, FrettingContact, Layered, Parabola, PowerLawGraded, PowerShape, Shape
from plgwear_jax.loads import Displacement

R, FORCE, FRICTION = 5e-3, 10.0, 0.4
STEEL = Elastic(210e9, 0.3)
LAYERS = Layered([2e-5, 3e-5], [400e9, 200e9, 110e9], 0.3)
LAW = PowerLawGraded(110e9, 1e-4, 0.4, 0.3)
STEADY = "contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume"
COEFFICIENT = 1e-14


class Blend(Shape):
    """A sphere, rounded beyond a flat face, with a cone's slope from there on, and a fourth power."""

    flat: Any = 0.0
    cone: Any = 0.0
    fourth: Any = 0.0
    round: Any = 1.0

    def height(self, r, radius):
        beyond = jnp.maximum(r - self.flat, 0.0)
        return self.round * beyond**2 / (2.0 * radius) + self.cone * beyond + self.fourth * r**4

    @property
    def kinks(self):
        return (self.flat,)


class Third(Shape):
    """As `PowerShape(3)`, without its closed forms."""

    def height(self, r, radius):
        return r**3 / (3.0 * radius**2)


class Even(Shape):
    """A sum of even powers, whose coefficients are one array."""

    coefficients: Any
    tables = ("coefficients",)

    def height(self, r, radius):
        ratio = (r / 1e-4) ** 2
        return 1e-6 * sum(x * ratio ** (i + 1) for i, x in enumerate(self.coefficients))


BLENDS = {
    "parabola": Blend(),
    "cone": Blend(cone=0.01, round=0.0),
    "second and fourth power": Blend(fourth=3e7),
    "rounded flat": Blend(flat=5e-5),
    "kink in the ring": Blend(flat=1.1e-4, cone=0.003, fourth=3e8),
}


def contact_with(shape: Shape, material: Any = LAW, indenter: Any = None) -> FrettingContact:
    return FrettingContact(material, R, FORCE, FRICTION, indenter, shape)


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(120)
_T = 0.5 * (1.0 + _NODES)
_PLACES, _WEIGHTS = _T * _T * (3.0 - 2.0 * _T), 3.0 * _T * (1.0 - _T) * _WEIGHTS  # dense towards both ends


def integral(function, start, end, ends=()):
    """Of a function of arrays of shape (m, 1), in pieces, without the ends that are not between."""
    edges = np.array([start, *sorted(x for x in ends if start < x < end), end])
    parts = zip(edges[:-1], np.diff(edges), strict=True)
    return sum(length * (_WEIGHTS @ function((begin + length * _PLACES)[:, None])) for begin, length in parts)


def by_integrals(shape: Blend, k: float, phi: float) -> tuple[float, ...]:
    """STEADY on a power law under a rigid indenter."""
    b, s = shape.flat, 0.5 * (1.0 + k)
    closed = FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), R, FORCE, FRICTION)
    sphere = float(closed.steady(0.0).contact_radius)
    # Of the sphere: F = 4 c_N a^(3+k)/((1+k)^2 (3+k) R).
    c_n = FORCE * R * (1.0 + k) ** 2 * (3.0 + k) / (4.0 * sphere ** (3.0 + k))
    sigma = np.sin(np.pi * s) / np.pi

    def slope(r):
        return 4.0 * shape.fourth * r**3 + np.where(r > b, shape.round * (r - b) / R + shape.cone, 0.0)

    def g_at(x):
        # By v = (pi/2 - t)^(1+k), of which nothing is singular.
        def over(v):
            u = v ** (1.0 / (1.0 + k))
            return slope(x * np.cos(u)) * (np.sinc(u / np.pi)) ** k / (1.0 + k)

        ends = [np.arccos(b / x) ** (1.0 + k)] if b < x else []
        return x * integral(over, 0.0, (0.5 * np.pi) ** (1.0 + k), ends)[0]

    g = np.vectorize(g_at)

    def pressed(a):
        at, power = g(a), 1.0 / (1.0 + k)
        return 2.0 * c_n * power * integral(lambda y: at - g(y**power), 0.0, a ** (1.0 + k), [b ** (1.0 + k)])[0]

    def radius(force):
        return brentq(
            lambda a: pressed(a) - force, 1e-5 if shape.fourth else max(b, 1e-5), 3e-4, xtol=1e-18, rtol=1e-14
        )

    a, c = radius(FORCE), radius((1.0 - phi) * FORCE)
    d = g(c) + phi * FORCE * (1.0 + k) / (2.0 * c_n * c ** (1.0 + k))

    def beside(r, power):
        # By v = (r^2 - T)^power.
        def over(v):
            T = r * r - v ** (1.0 / power)
            return T ** (s - 1.0) * (d - g(np.sqrt(T))) / power

        return integral(over, 0.0, (r * r - c * c) ** power, [abs(r * r - b * b) ** power] if c < b < r else [])[0]

    end = brentq(lambda r: beside(r, 1.0 - s), 1.0001 * c, 2.0 * a, xtol=1e-14, rtol=1e-9)
    return a, c, end, d, np.pi * sigma / (1.0 - s) * beside(end, 2.0 - s)


def steady(contact: FrettingContact, force: Any) -> np.ndarray:
    """STEADY of one contact, (names, forces)."""
    force = np.asarray(force)
    state = contact.steady(force)
    return np.array([np.broadcast_to(getattr(state, name), force.shape) for name in STEADY])


@pytest.mark.parametrize(
    "name, k, phi",
    [
        ("cone", -0.4, 0.2),
        ("rounded flat", 0.4, 0.6),
        ("second and fourth power", -0.4, 0.6),
        ("kink in the ring", 0.4, 0.9),
        *(
            pytest.param(name, k, phi, marks=pytest.mark.long)
            for name in BLENDS
            for k in (-0.7, 0.0, 0.6)
            for phi in (0.05, 0.5, 0.9)
        ),
    ],
)
def test_under_a_rigid_indenter_it_is_that_of_integrals(name, k, phi):
    contact = contact_with(BLENDS[name], PowerLawGraded(110e9, 1e-4, k, 0.3))
    exact = by_integrals(BLENDS[name], k, phi)
    np.testing.assert_allclose(steady(contact, phi * FRICTION * FORCE), exact, rtol=1e-5)
    if name == "kink in the ring":
        assert exact[1] < BLENDS[name].flat < exact[2]


def test_of_a_parabola_it_is_the_closed_form():
    law = PowerLawGraded(110e9, 1e-4, -0.4, 0.3)
    closed = contact_with(Parabola(), law)
    assert closed == dataclasses.replace(closed, shape=Parabola())
    force = 1.5
    expected = steady(dataclasses.replace(closed, shape=None), force)
    np.testing.assert_array_equal(steady(closed, force), expected)
    np.testing.assert_allclose(steady(contact_with(BLENDS["parabola"], law), force), expected, rtol=2e-6)


@pytest.mark.compiled
def test_it_is_differentiated_by_its_own_numbers():
    contact, force = contact_with(BLENDS["rounded flat"], PowerLawGraded(110e9, 1e-4, -0.4, 0.3)), 2.4

    def volume(flat):
        return dataclasses.replace(contact, shape=Blend(flat=flat)).steady(force).wear_volume

    flat, step = 5e-5, 1e-8
    slope = (volume(flat + step) - volume(flat - step)) / (2.0 * step)
    np.testing.assert_allclose(jax.grad(volume)(flat), slope, rtol=1e-5)


PAIRS = {
    "a power law": (LAW, None),
    "a power law under steel": (LAW, STEEL),
    "layers": (LAYERS, None),
    "layers under steel": (LAYERS, STEEL),
}


@pytest.mark.compiled
@pytest.mark.parametrize("pair", PAIRS)
def test_by_quadrature_it_is_that_of_its_closed_forms(pair):
    one, other = (contact_with(shape, *PAIRS[pair]) for shape in (Third(), PowerShape(3.0)))
    forces = np.array([0.2, 2.0, 3.8])
    np.testing.assert_allclose(steady(one, forces), steady(other, forces), rtol=1e-5)
    ours, theirs = one.steady(2.0), other.steady(2.0)
    for name in "deepest_wear", "energy_per_cycle":
        np.testing.assert_allclose(getattr(ours, name), getattr(theirs, name), rtol=1e-5)
    radii = np.linspace(0.0, 1.1, 7) * ours.worn_radius
    for name in "initial_pressure", "initial_displacement":
        expected = getattr(theirs, name)(radii)
        np.testing.assert_allclose(getattr(ours, name)(radii), expected, rtol=1e-4, atol=1e-6 * np.max(expected))
    ours, theirs = (each.over_cycles(2.0, COEFFICIENT) for each in (one, other))
    np.testing.assert_allclose(ours.volume(1e5), theirs.volume(1e5), rtol=1e-5)
    np.testing.assert_allclose(ours.profile(radii, 1e5), theirs.profile(radii, 1e5), rtol=1e-5, atol=1e-15)


@pytest.mark.compiled
@pytest.mark.parametrize("pair", PAIRS)
def test_a_flat_face_wears_from_the_energy_of_friction_to_its_steady_state(pair):
    contact, force = contact_with(BLENDS["rounded flat"], *PAIRS[pair]), 1.5
    state, run = contact.steady(force), contact.over_cycles(force, COEFFICIENT)
    first = COEFFICIENT / FRICTION * state.energy_per_cycle
    np.testing.assert_allclose(run.volume(1e-2), 1e-2 * first, rtol=1e-3)
    np.testing.assert_allclose(run.volume(1e15), state.wear_volume, rtol=1e-4)
    held = contact.over_cycles(Displacement(state.displacement_amplitude), COEFFICIENT).volume(1e15)
    assert 0.8 * state.wear_volume < held < state.wear_volume


@pytest.mark.compiled
@pytest.mark.parametrize("pair", PAIRS)
def test_derivatives_are_those_of_differences(pair):
    contact, force = contact_with(BLENDS["rounded flat"], *PAIRS[pair]), 2.4

    def worn(shape):
        return dataclasses.replace(contact, shape=shape).steady(force).wear_volume

    def over_cycles(shape):
        return dataclasses.replace(contact, shape=shape).over_cycles(force, COEFFICIENT).volume(1e5)

    shape = Blend(flat=5e-5, cone=1e-3)
    for volume, rtol in ((worn, 1e-5), (over_cycles, 1e-4)):
        slopes = jax.grad(volume)(shape)
        for name, step in (("flat", 1e-8), ("cone", 1e-6)):
            moved = [dataclasses.replace(shape, **{name: getattr(shape, name) + x}) for x in (step, -step)]
            ends = [volume(one) for one in moved]
            np.testing.assert_allclose(getattr(slopes, name), (ends[0] - ends[1]) / (2.0 * step), rtol=rtol)


@pytest.mark.compiled
def test_several_at_once_and_tables():
    flats = np.array([0.0, 4e-5])
    contact = contact_with(Blend(flat=flats), LAW, STEEL)
    alone = [contact_with(Blend(flat=flat), LAW, STEEL).steady(1.5).wear_volume for flat in flats]
    np.testing.assert_allclose(contact.steady(1.5).wear_volume, alone, rtol=1e-9)
    mapped = jax.jit(jax.vmap(lambda flat: contact_with(Blend(flat=flat), LAW, STEEL).steady(1.5).wear_volume))
    np.testing.assert_allclose(mapped(flats), alone, rtol=1e-9)
    # 1e-6 (r/1e-4)^2 is the sphere of the radius 5e-3.
    whole = contact_with(Even(np.array([1.0, 0.0])), LAW, STEEL)
    expected, forces = dataclasses.replace(whole, shape=None), np.array([1.0, 2.0])
    np.testing.assert_allclose(whole.steady(forces).wear_volume, expected.steady(forces).wear_volume, rtol=1e-5)
    slopes = jax.grad(lambda shape: dataclasses.replace(whole, shape=shape).steady(1.5).wear_volume)(whole.shape)
    assert slopes.coefficients.shape == (2,) and np.all(np.isfinite(slopes.coefficients))


@pytest.mark.compiled
@pytest.mark.parametrize("pair", PAIRS)
def test_nothing_of_a_shape_leaks(pair):
    def ask(flat):
        contact = contact_with(Blend(flat=flat), *PAIRS[pair])
        steady, run = contact.steady(1.5), contact.over_cycles(1.5, COEFFICIENT)
        return steady.wear_volume + steady.deepest_wear + run.volume(1e4)

    several = np.array([2e-5, 3e-5])
    within = jax.jit(lambda flat: jax.jit(ask)(flat) + ask(flat))
    for function, given in ((jax.jit(ask), 2e-5), (jax.grad(ask), 2e-5), (jax.vmap(ask), several), (within, 2e-5)):
        gc.freeze()  # JAX looks for garbage at the end of every trace
        with jax.checking_leaks():
            jax.eval_shape(function, given)


def test_what_a_shape_is():
    shape = Blend(flat=1e-5)
    assert shape == Blend(1e-5) and dataclasses.is_dataclass(shape)
    assert jax.tree.leaves(shape) == [1e-5, 0.0, 0.0, 1.0]
    with pytest.raises(dataclasses.FrozenInstanceError):
        shape.flat = 2e-5  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(TypeError, match="shape takes a Shape such as PowerShape"):
        contact_with(4.0)  # pyright: ignore[reportArgumentType]

    class Nothing(Shape):
        pass

    with pytest.raises(NotImplementedError, match=r"Nothing has no height\(r, radius\)"):
        _ = contact_with(Nothing()).steady(0.0).contact_radius
