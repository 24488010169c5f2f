"""Stresses in the half-space against known numbers, point forces, and integrals over all wavenumbers by SciPy."""

import half_space_stress as reference
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose
from refusals import data

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded, PowerShape
from plgwear_jax._core.leaves import leaf_of, paths_of, with_leaf
from plgwear_jax.special.pchip import Piecewise
from plgwear_jax.stresses import Stress, peaks
from plgwear_jax.stresses.field import Pressed, samples
from plgwear_jax.stresses.images import transforms

RADIUS, FORCE, FRICTION = 5e-3, 10.0, 0.5
A = 7e-5  # about the radius of these contacts in m
STEEL = Elastic(210e9, 0.3)
LAYERS = Layered([0.1 * A, 0.5 * A], [800e9, 160e9, 320e9], 0.3)
FILM = Layered([0.2 * A], [400e9, 110e9], 0.3)
TABLE = DepthGraded([0.0, 0.2 * A, 0.5 * A, A], [400e9, 300e9, 250e9, 210e9], 0.25)


def steady_of(material, phi, **more):
    return FrettingContact(material, RADIUS, FORCE, FRICTION, **more).steady(phi * FRICTION * FORCE)


def graded(k, phi=0.3):
    return steady_of(PowerLawGraded(210e9, 1e-4, k, 0.3), phi)


# --- known numbers of homogeneous half-spaces -------------------------------------------------------------------------


def test_stresses_on_the_axis_are_those_of_huber():
    steady = steady_of(STEEL, 0.0)
    z, nu = np.array([0.0, 0.1, 0.48, 1.0, 3.0]), 0.3
    found = steady.stress(0.0, z * steady.contact_radius)
    turn = np.arctan2(1.0, z)
    along = -(1.0 + nu) * (1.0 - z * turn) + 0.5 / (1.0 + z**2)
    for got, want in zip(found, (along, along, -1.0 / (1.0 + z**2), 0.0 * z), strict=True):
        assert_allclose(got / steady.peak_initial_pressure, want, rtol=0, atol=1e-12)


@parametrize("nu", [0.0, 0.3, 0.49])
@parametrize("material", [Elastic, lambda E, nu: PowerLawGraded(E, 1e-4, 0.0, nu)])
def test_the_tension_at_the_edge_is_that_of_hamilton(material, nu):
    steady = steady_of(material(210e9, nu), 1.0 - 1e-9)
    a, p_0 = steady.contact_radius, steady.peak_initial_pressure
    want = (1.0 - 2.0 * nu) / 3.0 + FRICTION * np.pi * (4.0 + nu) / 8.0
    assert_allclose([steady.tension(-a, 0.0) / p_0, steady.peak_tension / p_0], want, rtol=1e-6)
    assert_allclose(steady.peak_tension_at[0] / a, -1.0, rtol=1e-12)
    assert steady.peak_tension_at[1] == 0.0


def test_first_yield_without_friction_is_below_the_surface():
    steady = steady_of(STEEL, 0.0)
    place = (at / steady.contact_radius for at in steady.peak_mises_at)
    found = steady.peak_initial_pressure / steady.peak_mises, *place
    assert_allclose(found, [1.61, 0.0, 0.48], rtol=0, atol=0.005)


# --- against integrals over all wavenumbers ---------------------------------------------------------------------------

X = np.array([-2.0, -1.05, -0.9, -0.5, 0.0, 0.6])


def rule(a):
    node, weight = np.polynomial.legendre.leggauss(100)
    u = 0.5 * (1.0 + node)
    return a * np.sin(0.5 * np.pi * u), a * 0.25 * np.pi * np.cos(0.5 * np.pi * u) * weight


@parametrize(
    "material, more",
    [
        pytest.param(STEEL, {}, id="one modulus"),
        pytest.param(LAYERS, {}, id="layers"),
        compiled_case(Layered([0.05 * A], [800e9, 210e9], 0.0), {"indenter": STEEL}, id="a thin layer under steel"),
        compiled_case(Layered([0.5 * A], [60e9, 210e9], 0.49), {"shape": PowerShape(4.0)}, id="a compliant layer"),
    ],
)
def test_stresses_in_layers(material, more):
    phi, mu = 0.6, FRICTION
    steady, inner = (
        steady_of(material, phi, **more),
        FrettingContact(material, RADIUS, 0.4 * FORCE, mu, **more).steady(0.0),
    )
    a, c, p_0 = (float(x) for x in (steady.contact_radius, steady.stick_radius, steady.initial_pressure(0.0)))
    (r, weight), (r_c, weight_c) = rule(1.0), rule(c / a)
    p = reference.transform(r, weight, np.asarray(steady.initial_pressure(r * a)) / p_0)
    p_c = reference.transform(r_c, weight_c, np.asarray(inner.initial_pressure(r_c * a)) / p_0)
    layers = Layered([], [1.0], material.nu) if material is STEEL else material
    tops, moduli = np.append(0.0, np.cumsum(layers.thickness)) / a, layers.modulus / layers.modulus[0]

    for z in (0.2, 1.0, 3.0):
        want = reference.stresses(
            p,
            lambda xi: mu * (p(xi) - p_c(xi)),
            lambda xi, z: reference.responses(xi, z, tops, moduli, material.nu),
            X,
            z,
            60.0 / z,
        )
        assert_allclose(np.array(steady.stress(X * a, z * a)) / p_0, want, rtol=0, atol=5e-4)


@parametrize("k", [0.4, compiled_case(-0.5)])
def test_stresses_in_power_laws_before_and_after_wear(k):
    phi, mu, nu = 0.6, FRICTION, 0.3
    steady = steady_of(PowerLawGraded(210e9, 1e-4, k, nu), phi)
    a, c, p_0 = (float(x) for x in (steady.contact_radius, steady.stick_radius, steady.peak_initial_pressure))
    s, c = 0.5 * (1.0 + k), c / a
    tops = np.append(0.0, np.geomspace(1e-6, 3e3, 420))
    moduli = np.append(tops[1] ** k / (1.0 + k), np.sqrt(tops[1:-1] * tops[2:]) ** k)
    moduli = np.append(moduli, tops[-1] ** k)

    def respond(xi, z):
        near = tops.copy()
        near[np.argmin(abs(near - z))] = z  # so that the depth is that of an edge, in the middle of two moduli
        return reference.responses(xi, z, near, moduli, nu, z**k)

    share, flat = (1.0 - phi) / c**2, phi / c**2 * s / (1.0 + s)
    p, p_c, punch = (reference.bowl(m, b) for m, b in ((s, 1.0), (s, c), (s - 1.0, c)))
    before = p, lambda xi: mu * (p(xi) - share * p_c(xi))
    after = lambda xi: share * p_c(xi) + flat * punch(xi), lambda xi: mu * flat * punch(xi)
    for worn, (pressure, traction) in ((False, before), (True, after)):
        for z in (0.2, 1.0):
            want = reference.stresses(pressure, traction, respond, X, z, 60.0 / z)
            found = np.array(steady.stress(X * a, z * a, worn=worn)) / p_0
            assert_allclose(found, want, rtol=0, atol=1e-3)


@parametrize("worn", [compiled_case(False), True])
def test_a_homogeneous_half_space_under_any_shape_is_that_of_layers_without_a_layer(worn):
    x, z = np.array([-1e-4, 0.0, 5e-5]), np.array([[1e-6], [5e-5]])
    found, expected = (
        FrettingContact(body, 5e-3, 10.0, 0.4, STEEL, PowerShape(4.0)).steady(2.0)
        for body in (STEEL, Layered([], [210e9], 0.3))
    )
    if not worn:  # a peak is that before any wear
        assert_allclose(found.peak_mises, expected.peak_mises, rtol=1e-9)
    stresses = np.array(expected.stress(x, z, worn=worn))
    assert_allclose(found.stress(x, z, worn=worn), stresses, rtol=0.0, atol=1e-9 * abs(stresses).max())


# --- powers, and digits -----------------------------------------------------------------------------------------------


def test_a_power_among_other_pressures_is_that_power():
    stick, s, one = map(jnp.asarray, (0.6, 0.3, 1.0))
    for worn in (False, True):
        alone, among = (
            Pressed(
                4, one, one, stick, one, z ** (s + 0.5), z ** (s + 0.5), z ** (s - 0.5), s, one, 2.0 * s - 1.0, None
            ).tractions(worn)
            for z in (samples(4, s.dtype, alone=alone) for alone in (True, False))
        )
        assert_allclose(among.beside[1], alone.beside[1], rtol=1e-12)
        assert_allclose(transforms(among._replace(beside=None), one[None], one[None], 1)[0], 0.0, atol=1e-12)


PLACES = np.array([-1.5, -1.05, -0.95, -0.3, 0.0, 0.5]) * A, np.array([[0.02], [0.1], [0.5], [2.0]]) * A


@compiled
@parametrize("worn", [False, True])
def test_each_digit_is_worth_its_time(worn):
    for k in (0.3, -0.6):
        found = [graded(k).contact.steady(1.5, digits=digits) for digits in (5, 4, 3, 2)]
        best, *others = (np.array(one.stress(*PLACES, worn=worn)) for one in found)
        errors = [np.max(abs(one - best)) / found[0].peak_initial_pressure for one in others]
        assert errors[0] < errors[1] < errors[2]
        assert np.all(np.array(errors) < [2e-4, 1e-3, 1e-2])


@parametrize("worn", [False, compiled_case(True)])
def test_stresses_in_single_precision(worn):
    for known in map(graded, (0.3, -0.6)):
        found = (
            jax.tree.map(jnp.float32, known.contact)
            .steady(jnp.float32(1.5))
            .stress(*map(np.float32, PLACES), worn=worn)
        )
        assert found.xx.dtype == jnp.float32
        gap = (np.array(found) - np.array(known.stress(*PLACES, worn=worn))) / known.peak_initial_pressure
        assert_allclose(gap, 0.0, atol=2e-3)


# --- what is special at the surface -----------------------------------------------------------------------------------


@parametrize("material", [STEEL, LAYERS, PowerLawGraded(210e9, 1e-4, 0.4, 0.3)])
def test_the_surface_carries_the_pressure_and_the_traction(material):
    steady = steady_of(material, 0.6)
    a, p_0 = steady.contact_radius, float(steady.peak_initial_pressure)
    inner = FrettingContact(material, RADIUS, 0.4 * FORCE, FRICTION).steady(0.0)
    x = np.array([-1.5, -0.95, -0.3, 0.0, 0.5, 0.95]) * a  # as many as above, which share their program
    found = steady.stress(x, 0.0)
    pressure, stuck = steady.initial_pressure(abs(x)), inner.initial_pressure(abs(x))
    assert_allclose(found.zz / p_0, -pressure / p_0, rtol=0, atol=1e-3)
    assert_allclose(found.xz / p_0, -FRICTION * (pressure - stuck) / p_0, rtol=0, atol=1e-3)


@parametrize("material", [STEEL, LAYERS])
def test_the_worn_surface_carries_its_pressure_and_traction(material):
    steady = steady_of(material, 0.6)
    x = np.array([-1.5, -0.6, -0.3, 0.0, 0.2, 0.5]) * steady.contact_radius
    _, _, *found = steady.stress(x, 0.0, worn=True)
    known = steady.pressure(abs(x)), steady.traction(abs(x))
    assert_allclose(np.add(found, known) / steady.peak_initial_pressure, 0.0, atol=2e-3)


def test_a_surface_of_infinite_modulus_carries_the_traction():
    steady = graded(-0.9, 0.999)
    x = np.array([-1.5, -0.9, -0.3, 0.1, 0.5, 0.9]) * steady.contact_radius
    found = (steady.stress(x, 0.0).xz + FRICTION * steady.initial_pressure(abs(x))) / steady.peak_initial_pressure
    stuck = abs(x) < steady.stick_radius
    assert np.max(abs(found[~stuck])) < 2e-3


@compiled
def test_the_surface_of_a_steep_table_carries_the_pressure():
    steady = steady_of(DepthGraded([0.0, 0.05 * A, 0.12 * A, A], [150e9, 400e9, 120e9, 210e9], 0.3), 0.6)
    x = np.linspace(-1.2, 1.2, 48) * A
    found, known = (np.asarray(each) for each in (steady.stress(x, 0.0).zz, steady.initial_pressure(abs(x))))
    assert_allclose((found + known) / steady.peak_initial_pressure, 0.0, atol=5e-4)


def test_a_surface_without_a_modulus_has_no_tension_and_one_of_infinite_modulus_an_infinite_one():
    compliant, stiff = (graded(k, 0.6) for k in (0.4, -0.4))
    a, p_0 = compliant.contact_radius, compliant.peak_initial_pressure
    found = compliant.stress(np.array([-1.2, -0.9, -0.5, 0.0, 0.3, 0.8]) * a, 0.0)
    assert_allclose(found.xx / p_0, 3.0 / 7.0 * found.zz / p_0, rtol=0, atol=2e-3)
    assert np.isinf(stiff.peak_tension)


def test_von_mises_and_the_largest_principal_stress_are_those_of_eigenvalues(seed):
    xx, yy, zz, xz = np.random.default_rng(seed).normal(size=(4, 20))
    none = np.zeros(20)
    known = np.linalg.eigvalsh(np.moveaxis(np.array([[xx, none, xz], [none, yy, none], [xz, none, zz]]), -1, 0))
    found = Stress(xx, yy, zz, xz)
    assert_allclose(found.principal, known[:, 2], rtol=1e-12, atol=1e-12)
    assert_allclose(found.mises, np.sqrt(4.5 * np.var(known, axis=1)), rtol=1e-12)


# --- peaks and derivatives --------------------------------------------------------------------------------------------


@parametrize(
    "phi, material", [(0.6, STEEL), (0.25, STEEL), compiled_case(0.6, LAYERS), (0.02, FILM), compiled_case(0.6, TABLE)]
)
def test_no_place_of_a_fine_grid_is_above_the_peaks(phi, material):
    """With little friction von Mises' stress has its peak on the leading side, in a stiff film above its interface."""
    steady = steady_of(material, phi)
    a, p_0 = steady.contact_radius, steady.peak_initial_pressure
    z = np.concatenate([np.geomspace(1e-3, 2.0, 60) * a, [0.0, FILM.thickness[0] * (1.0 - 1e-12)]])
    x, z = np.linspace(-1.5, 1.5, 121) * a, z[:, None]
    stress = steady.stress(x, z)
    for name, peak in (("principal", steady.peak_tension), ("mises", steady.peak_mises)):
        highest = jnp.max(getattr(stress, name)) / p_0
        assert highest - 1e-6 <= peak / p_0 <= highest + 1e-4


@parametrize("k", [1e-5, 1e-4, 1e-3, 5e-3, 0.02, 0.1])
def test_the_tension_of_a_slight_grading_is_that_without_it_times_the_modulus_at_its_depth(k):
    known, steady = (graded(each, 0.6) for each in (0.0, k))
    depth = steady.peak_tension_at[1] / steady.contact_radius
    assert abs(steady.peak_tension / known.peak_tension - depth**k) < k
    assert 0.1 < depth / k**2 < 1.0


@compiled
def test_peaks_of_each_part_of_a_coating():
    steady = steady_of(LAYERS, 0.6)
    first, second = LAYERS.thickness[0], sum(LAYERS.thickness)
    parts = [steady.peak_mises_between(*ends) for ends in ((0.0, first), (first, second), (second, 1.0))]
    assert_allclose(max(parts), steady.peak_mises, rtol=1e-4)


@compiled
@parametrize("name", ["peak_tension", "peak_mises"])
@parametrize("material", [LAYERS, PowerLawGraded(210e9, 1e-4, 0.1, 0.3)])  # the latter's is at a kink
def test_derivatives_of_peaks_by_all_numbers(material, name):
    contact = steady_of(material, 0.3).contact

    def value(contact):
        return getattr(contact.steady(1.5), name)

    slopes = jax.grad(value)(contact)
    for leaf, number in paths_of(contact).items():
        ends = [float(value(with_leaf(contact, leaf, number * (1.0 + side)))) for side in (1e-4, -1e-4)]
        along = 1e-4 * float(np.sum(leaf_of(slopes, leaf) * number))
        assert along == pytest.approx((ends[0] - ends[1]) / 2.0, rel=2e-2, abs=2e-6 * ends[0])


def test_a_peak_moves_where_it_can_and_else_with_what_holds_it(monkeypatch):
    """That of mu^3 - u^2 - 3 w^2 - u w at (0.6, 0.36): it is held beside the stick area and at interfaces."""

    def stress(pressed, wanted, place):
        mu = pressed.friction
        u, w = place - jnp.stack([mu, mu**2])
        return mu**3 - u**2 - 3.0 * w**2 - u * w

    def value(given):
        (mu, stick, depth), one = given, jnp.ones(())
        body = Piecewise(jnp.append(0.0, depth), jnp.ones((1, 2)))
        pressed = Pressed(4, one, one, stick, mu, one, one, one, one, one, one, body)
        return peaks.peak_at(pressed, peaks.Wanted(one, 0.0 * one, one), 0.6 * one, 0.36 * one).value

    monkeypatch.setattr(peaks, "_stress_at", stress)
    of = jax.jit(lambda given: (jax.grad(value)(given), jax.hessian(value)(given)[0, 0]))
    for *at, by_mu, by_stick, by_depth, second in data("stresses/moving.toml")["peaks"]:
        slopes, bend = of(jnp.array(at))
        assert_allclose([*slopes, bend], [by_mu, by_stick, by_depth, second], rtol=1e-9, atol=1e-12)


@compiled
def test_second_derivatives_of_peaks_are_those_of_their_slopes():
    slope = jax.grad(lambda friction: FrettingContact(STEEL, RADIUS, FORCE, friction).steady(1.5).peak_mises)
    assert_allclose(jax.grad(slope)(0.4), (slope(0.404) - slope(0.396)) / 0.008, rtol=5e-3)


# --- the border -------------------------------------------------------------------------------------------------------


def test_a_traced_depth_below_zero_gives_nan():
    assert np.isnan(jax.jit(steady_of(STEEL, 0.3).mises)(0.0, -1e-6))


@compiled
def test_holl_ratio_is_that_of_the_exponent():
    named, given = (steady_of(PowerLawGraded(210e9, 1e-4, 0.4, nu), 0.6) for nu in ("holl", 1.0 / 2.4))
    assert_allclose(named.stress(X * A, 1e-6), given.stress(X * A, 1e-6), rtol=1e-9)


def test_many_contacts_answer_as_each_does():
    forces = np.array([5.0, 20.0])
    many = FrettingContact(STEEL, RADIUS, forces, FRICTION).steady(1.0)
    for i, force in enumerate(forces):
        one = FrettingContact(STEEL, RADIUS, force, FRICTION).steady(1.0)
        assert_allclose(many.peak_tension[i], one.peak_tension, rtol=1e-9)
        assert_allclose(many.stress(-A, 1e-6).xx[i], one.stress(-A, 1e-6).xx, rtol=1e-9)


@compiled
def test_peaks_in_single_precision():
    known = steady_of(LAYERS, 0.3)
    found = jax.tree.map(jnp.float32, known.contact).steady(jnp.float32(1.5))
    for name in ("peak_tension", "peak_mises"):
        assert getattr(found, name).dtype == jnp.float32
        assert_allclose(getattr(found, name), getattr(known, name), rtol=3e-3)


@compiled
def test_all_digits_have_the_tension_at_the_edge_of_a_stiff_layer():
    """There alone some spacings of the exponentials were wrong, and so was a spline that was linear beside the edge."""
    layers = Layered([5e-6, 5e-6], [220e9, 55e9, 110e9], 0.3)
    found = [FrettingContact(layers, 5e-3, 10.0, 0.4).steady(1.6, digits=digits) for digits in (4, 5)]
    assert_allclose(*(steady.peak_tension / steady.peak_initial_pressure for steady in found), atol=2e-4)
