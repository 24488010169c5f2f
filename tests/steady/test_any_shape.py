"""Indenters of any shape: rigid on a power law against an oracle, and what they promise elsewhere."""

import dataclasses
from typing import Any
from unittest import mock

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from functions import by_numpy
from inputs import scene_of
from kinds import COEFFICIENT, FORCE, FRICTION, LAYERS, LIMIT, STEEL, contact_of, dome
from marks import compiled, compiled_case, long, long_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, data, is_told, refusal
from rigid_shapes import HEIGHTS, OWN, RADII, SHAPES, STEADY, Blend, R, contact_with, exact, steady

from plgwear_jax import (
    Cone,
    Elastic,
    FrettingContact,
    Layered,
    Parabola,
    PowerLawGraded,
    PowerShape,
    Profile,
    RoundedFlat,
    Shape,
    TruncatedSphere,
    loads,
    scene,
)
from plgwear_jax.special.quadrature import logistic
from plgwear_jax.surfaces.effort import EFFORTS, Effort

# To compile, and where exponents of a case that stays are others
SLOW = ("table", "rounded flat", "own rounded flat", "own second and fourth power", "flat power")
LAW = PowerLawGraded(110e9, 1e-4, 0.4, 0.3)
BODIES = {
    "a power law": (LAW, None),
    "a power law under steel": (LAW, STEEL),
    "layers": (LAYERS, None),
    "layers under steel": (LAYERS, STEEL),
}


def on(body, shape):
    material, indenter = BODIES[body]
    return contact_of(material, indenter, shape)


# --- against the oracle -----------------------------------------------------------------------------------------------


@parametrize(
    "name, k, phi",
    [
        *((compiled_case if name in SLOW else pytest.param)(name, 0.3, 0.4) for name in SHAPES | OWN),
        *(
            long_case(name, -0.7 if (name, k) == ("truncated sphere", -0.9) else k, phi)
            for name in SHAPES | OWN
            for k in (-0.9, -0.4, 0.0, 0.5, 0.9)
            for phi in (0.01, 0.5, 0.99)
        ),
    ],
)
def test_a_rigid_indenter_on_a_power_law_is_that_of_its_integrals(name, k, phi):
    shape, _, rtol = (SHAPES | OWN)[name]
    known = exact(name, k, phi)
    # Small amplitudes leave the volume fewer digits, and the cone at k = -0.9 a wide ring.
    rtol = rtol if phi == 0.4 else max(rtol, 2e-11)
    assert_allclose(steady(contact_with(shape, k), phi * LIMIT), known, rtol=rtol)


@parametrize("name", [name for name in SHAPES if name != "table"])
def test_heights_are_those_of_their_slopes(name):
    shape, (piece,), _ = SHAPES[name]
    r, begin = np.array([2e-5, 7e-5, 2e-4]), float(piece.begin)
    terms = [(float(x), float(n) + 1.0) for x, n in piece.terms]
    known = sum(x / n * (np.maximum(r, begin) ** n - begin**n) for x, n in terms)
    assert_allclose(shape.height(r, R), known, rtol=1e-9, atol=1e-18)


def test_beyond_a_table_its_slope_stays():
    r = np.array([0.0, 3e-5, 7e-5, 2e-4])
    beyond = np.array([0.0, 1e-5, 4e-4, np.inf])
    found = by_numpy(lambda at: Profile(r, r * r / (2.0 * R)).height(at, R))(r[-1] + beyond)
    assert_allclose(found, r[-1] * (0.5 * r[-1] + beyond) / R, rtol=1e-12)


@parametrize("digits", [compiled_case(2), 3])
def test_few_digits_next_to_a_corner(digits):
    """The stick area ends 1e-3 of its radius beyond the flat face."""
    found = dome(-0.36, STEEL, TruncatedSphere(8.812e-5)).steady(0.8 * LIMIT, digits=digits)
    assert_allclose(found.wear_volume, 5.6539336e-17, rtol=10.0**-digits / 5.0)  # by 5 digits


@long
@parametrize("phi", [0.01, 0.5])
def test_a_narrow_ring_of_a_truncated_sphere(phi):
    """At k = -0.9 its contact ends close to the flat face; at phi = 0.99 closer than floating-point numbers tell."""
    found = steady(contact_with(SHAPES["truncated sphere"][0], -0.9), phi * LIMIT)
    known = exact("truncated sphere", -0.9, phi)
    assert_allclose(found[:4], known[:4], rtol=1e-11)
    assert_allclose(found[4], known[4], rtol=1e-4)


def test_the_pressure_of_a_cone_is_that_of_textbooks():
    plane, steady = 110e9 / (1.0 - 0.3**2), contact_with(Cone(0.01), 0.0).steady(0.0)
    r = np.array([1e-4, 0.1, 0.5, 0.9])
    pressure = steady.initial_pressure(r * steady.contact_radius)
    assert_allclose(pressure, 0.5 * plane * 0.01 * np.arccosh(1.0 / r), rtol=1e-6)
    # Nearer to the tip it stays as it is, or integrals would be infinite.
    assert_allclose(
        steady.initial_pressure(1e-6 * steady.stick_radius), steady.initial_pressure(1e-7 * steady.stick_radius)
    )
    assert_allclose(steady.initial_pressure(1e-6 * steady.stick_radius), 0.5 * plane * 0.01 * np.arccosh(1e6), rtol=0.1)
    near = steady.stick_radius * np.array([0.0, 2.0**-53, 2.0**-51])  # a program may round c otherwise
    assert np.all(np.isinf(steady.initial_pressure(near)))
    assert np.all(np.isinf(steady.edge_pressure(steady.stick_radius - near)))


@parametrize("dtype, error", [(np.float64, 1e-9), (np.float32, 1e-5)])
def test_the_pressure_at_the_tip_of_a_cone(dtype, error):
    """For k > 0 it is finite: s (p + s)/(s + p - 1) times the mean, with s = (1+k)/2 and f like T^p."""
    contact = jax.tree.map(dtype, contact_with(Cone(0.01), 0.2))
    steady = contact.steady(dtype(0.0))
    mean = contact.normal_force / (np.pi * steady.contact_radius**2)
    assert_allclose(steady.initial_pressure(dtype(0.0)) / mean, 0.6 * 1.1 / 0.1, rtol=error)


# Numbers that `tools/contact_mechanics.py` prints with 512 cells a side.
@parametrize(
    "shape, force, radius, penetration, pressures, error",
    [
        (Cone(0.1), 0.15, 0.97785, 0.15350, [0.11451, 0.078303, 0.054888, 0.034589], 3e-3),
        # The pressure has a peak above the edge of the flat face, at 0.6, which the cells round off.
        compiled_case(RoundedFlat(0.6), 0.4, 0.99372, 0.23645, [0.093193, 0.10391, 0.14366, 0.16558], 6e-3),
    ],
    ids=["cone", "rounded flat"],
)
def test_a_program_by_others_finds_the_same_contact(shape, force, radius, penetration, pressures, error):
    """ContactMechanics 1.8.3: lengths in units of a length, forces in units of E* times its square."""
    one = FrettingContact(PowerLawGraded(1.0, 1.0, 0.0, 0.0), 1.0, force, 0.4, shape=shape).steady(0.0)
    assert_allclose(one.contact_radius, radius, rtol=1e-3)  # a cell is 6e-3 of it
    assert_allclose(one.penetration, penetration, rtol=3e-5)
    found = one.initial_pressure(one.contact_radius * np.array([0.2, 0.4, 0.6, 0.8]))
    assert_allclose(found, pressures, rtol=error)


def test_of_a_parabola_it_is_the_closed_form():
    closed = contact_with(Parabola(), -0.4)
    expected = steady(dataclasses.replace(closed, shape=None), 1.5)
    assert_array_equal(steady(closed, 1.5), expected)
    assert_allclose(steady(contact_with(Blend(), -0.4), 1.5), expected, rtol=2e-6)


class Third(Shape):
    """As `PowerShape(3)`, without its closed forms, and measured from elsewhere than its apex."""

    def height(self, r, radius):
        return r**3 / (3.0 * radius**2) - 1e-7


@compiled
@parametrize("body", BODIES)
@parametrize(
    "own, known", [(Third(), PowerShape(3.0)), (Blend(flat=5e-5), RoundedFlat(5e-5))], ids=["power", "rounded flat"]
)
def test_a_shape_of_ones_own_is_that_of_its_closed_forms(own, known, body):
    one, other, forces = on(body, own), on(body, known), np.array([0.2, 2.0, 3.8])
    ours, theirs = one.steady(forces), other.steady(forces)
    for name in (*STEADY, "deepest_wear", "energy_per_cycle", "displacement_amplitude"):
        assert_allclose(getattr(ours, name), getattr(theirs, name), rtol=1e-5, err_msg=name)
    radii = np.linspace(0.0, 1.1, 7)[:, None] * ours.worn_radius
    for name in "initial_pressure", "initial_displacement":
        expected = getattr(theirs, name)(radii)
        assert_allclose(getattr(ours, name)(radii), expected, rtol=1e-4, atol=1e-6 * np.max(expected))
    if isinstance(own, Third):
        ours, theirs = (each.over_cycles(2.0, COEFFICIENT) for each in (one, other))
        assert_allclose(ours.volume(1e5), theirs.volume(1e5), rtol=1e-5)
        r = radii[:, 1]
        assert_allclose(ours.profile(r, 1e5), theirs.profile(r, 1e5), rtol=1e-5, atol=1e-15)


@compiled
def test_all_quantities_hold_together():
    contact, force = contact_with(TruncatedSphere(4e-5), -0.3), 1.5
    state = contact.steady(force)
    ring = np.linspace(state.stick_radius, state.worn_radius, 4001)
    depth = state.wear_depth(ring)
    assert_allclose(2.0 * np.pi * np.trapezoid(depth * ring, ring), state.wear_volume, rtol=1e-3)
    assert_allclose(np.max(depth), state.deepest_wear, rtol=1e-4)
    assert np.isinf(state.peak_initial_pressure)
    assert np.isfinite(contact_with(RoundedFlat(4e-5), -0.3).steady(0.0).peak_initial_pressure)


# --- kinks on numerical bodies, and narrow rings ----------------------------------------------------------------------

KINKED = (Cone(0.01), TruncatedSphere(5e-5), RoundedFlat(5e-5))


def work_of_friction(state):
    """4 mu times the integral of the pressure times the slip over the ring."""
    x, weights = np.polynomial.legendre.leggauss(24)
    x, weights = 0.5 * (x + 1.0), 0.5 * weights
    x, weights = x**3 * (10.0 - 15.0 * x + 6.0 * x * x), 30.0 * x * x * (1.0 - x) ** 2 * weights
    width = state.contact_radius - state.stick_radius
    r = state.stick_radius + width * x
    return 8.0 * np.pi * FRICTION * width * np.sum(state.initial_pressure(r) * state.slip_amplitude(r) * r * weights)


@parametrize(
    "shape",
    [KINKED[0], *map(compiled_case, KINKED[1:])],
    ids=type,
)
def test_layers_of_one_modulus_have_the_pressures_and_energies_of_a_power_law(shape):
    known = contact_with(shape, 0.0)
    layers = dataclasses.replace(known, material=Layered([1e-5, 3e-5], [110e9] * 3, 0.3))
    layered, known = (contact.steady(0.05 * LIMIT) for contact in (layers, known))
    r = np.array([0.05, 0.3, 0.6, 0.9, 0.99]) * known.contact_radius
    mean = FORCE / (np.pi * known.contact_radius**2)
    assert_allclose(layered.initial_pressure(r) / mean, known.initial_pressure(r) / mean, atol=1e-8)
    assert_allclose(layered.energy_per_cycle, work_of_friction(known), rtol=1e-5)
    assert_allclose(layered.gross_slip_energy_ratio, known.gross_slip_energy_ratio, rtol=1e-8)


def test_the_energy_of_a_kink_in_the_ring_is_the_area_of_its_loop():
    """4 F u less 8 times the integral of u over F, of the displacement amplitudes u of 192 forces F."""
    state = contact_with(OWN["own kink in the ring"][0]).steady(0.99 * LIMIT)
    assert_allclose(state.energy_per_cycle, 2.38003e-07, rtol=5e-5)


def test_the_deepest_wear_of_a_wide_ring_is_in_closed_form():
    amplitudes = np.array([0.5, 0.98, 0.9999]) * LIMIT
    found, known = (contact_with(shape, 0.8).steady(amplitudes).deepest_wear for shape in (PowerShape(2.0), None))
    assert_allclose(found, known, rtol=1e-8)


NARROW = np.array([1e-3, 1e-6, 1e-9])


@parametrize(
    "k, indenter, known",
    [
        (-0.3, Elastic(1e22, 0.3), (None, None)),
        compiled_case(-0.3, STEEL, (STEEL, 5)),
        compiled_case(0.2, Elastic(1e22, 0.3), (None, None)),
        compiled_case(0.2, STEEL, (STEEL, 5)),
    ],
)
def test_narrow_rings_keep_their_digits(k, indenter, known):
    def of(indenter, digits):
        state = contact_with(Parabola(), k, indenter).steady(NARROW * LIMIT, digits=digits)
        return [getattr(state, name) for name in ("wear_volume", "deepest_wear", "energy_per_cycle", "energy_ratio")]

    assert_allclose(of(indenter, 4), of(*known), rtol=1e-4)


@compiled
def test_narrow_rings_beside_a_tip_keep_their_digits():
    """The gap next to the stick area goes over into the sum of modes further out."""
    contact = contact_with(Cone(0.01), 0.3, STEEL)
    coarse, fine = (contact.steady([0.01 * LIMIT], digits=digits).wear_volume for digits in (4, 5))
    assert_allclose(coarse, fine, rtol=1e-4)


def test_narrow_rings_beside_a_tip_keep_their_digits_on_a_thin_layer():
    """The volume is that of 160 pressures, which resolve the layer."""
    contact = contact_of(Layered([1e-7, 1e-5], [4e11, 1.1e11, 1.1e11], 0.3), None, Cone(0.01))
    assert_allclose(contact.steady(1e-3 * LIMIT).wear_volume, 5.75526e-23, rtol=1e-3)


@parametrize(
    "shape",
    [None, *map(compiled_case, (Cone(0.01), RoundedFlat(6.1e-5))), TruncatedSphere(3.4e-5)],
    ids=type,
)
def test_a_ring_within_a_thin_layer_knows_the_energy_at_the_edge_from_what_is_below(shape):
    """By which the intensity of the pressure there goes as E^(1/2), and the volume as E^(-1/2)."""
    volumes = [
        contact_of(Layered([6.8e-10], [modulus, 1.1e11], 0.3), None, shape).steady(1e-9 * LIMIT, digits=3).wear_volume
        for modulus in (4.4e11, 1.1e11)
    ]
    assert_allclose(volumes[0] / volumes[1], 0.5, rtol=1e-3)


def test_narrow_rings_of_layers_go_as_those_of_a_homogeneous_half_space():
    contact = contact_of(LAYERS)
    amplitudes = np.array([1e-9, 1e-12, 1e-20, 0.0])  # the last ones are below the roundings of 1
    state = contact.steady(amplitudes * LIMIT)
    wide, narrow, *none = state.wear_volume
    assert_allclose(narrow, wide * 1e-3**2.5, rtol=1e-4)
    assert none == [0.0, 0.0] and np.all(state.worn_radius[2:] == state.contact_radius[2:])


@compiled
@parametrize("shape", [TruncatedSphere, RoundedFlat, Cone])
def test_narrow_rings_beside_kinks_on_thin_layers_keep_their_promise(shape):
    """Of random layers, indenters and amplitudes, beside 160 pressures."""
    rng = np.random.default_rng(5)
    thickness, modulus, phi = 10.0 ** rng.uniform([-8.5], [-5.5], (60, 1)), 20.0 ** rng.random(60), rng.random(60)
    layers = Layered(thickness, np.stack([5e10 * modulus, 0.0 * modulus + 2e11], -1), 0.3)
    size = 1e-2 * 10.0 ** rng.uniform(-0.7, 0.7, 60) if shape is Cone else rng.uniform(2e-6, 1.2e-4, 60)
    contact = contact_of(layers, Elastic(np.where(rng.random(60) < 0.5, 2.1e11, 1e30), 0.3), shape(size))
    force = 10.0 ** (-6.0 + 4.0 * phi) * LIMIT
    with mock.patch.dict(EFFORTS, {5: Effort(5, 160, 0.12, 80)}):
        fine = contact.steady(force, digits=5).wear_volume
    error = abs(contact.steady(force).wear_volume / fine - 1.0)
    assert np.max(error) < 1e-1 and np.quantile(error, 0.95) < 1e-2


@compiled
def test_narrow_rings_of_layers_have_slopes_that_go_on_to_no_amplitude():
    contact = contact_of(LAYERS)
    slope = jax.grad(lambda contact: jnp.log(contact.steady(1e-9 * LIMIT).wear_volume))(contact)
    assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(slope))
    at_rest, wide = (jax.grad(lambda force: contact.steady(force).worn_radius)(force) for force in (0.0, 1e-9))
    assert at_rest > 0.0
    assert_allclose(at_rest, wide, rtol=1e-3)


# --- derivatives and batches ------------------------------------------------------------------------------------------

ALONG = np.array([0.0, 1.0, -2.0, 1.5, 0.5, -1.0, 1.0, 0.0])
MOVED = [
    (Cone(0.01), {"slope": 1.0}, "a power law"),
    (RoundedFlat(5e-5), {"flat_radius": 1.0}, "a power law"),
    (TruncatedSphere(3e-5), {"flat_radius": 1.0}, "a power law"),
    (Profile(RADII, HEIGHTS), {"heights": ALONG}, "a power law"),
    *((Blend(flat=5e-5, cone=1e-3), {"flat": 1.0, "cone": -0.7}, body) for body in BODIES),
]


@compiled
@parametrize("shape, along, body", MOVED, ids=lambda x: x if isinstance(x, str) else type(x).__name__)
def test_derivatives_are_those_of_differences(shape, along, body):
    def of(x):
        moved = {name: getattr(shape, name) * (1.0 + way * x) for name, way in along.items()}
        return on(body, dataclasses.replace(shape, **moved))

    def volume(x):
        return of(x).steady(2.0).wear_volume

    def over_cycles(x):
        return of(x).over_cycles(2.0, COEFFICIENT).volume(1e5)

    step = 1e-4
    ends = [volume(n * step) for n in range(-2, 3)]
    slope = np.dot([1.0, -8.0, 0.0, 8.0, -1.0], ends) / (12.0 * step)
    assert_allclose(jax.jit(jax.grad(volume))(0.0), slope, rtol=1e-5 if isinstance(shape, Blend) else 1e-6)
    if not isinstance(shape, Blend | Profile):
        bend = np.dot([-1.0, 16.0, -30.0, 16.0, -1.0], ends) / (12.0 * step**2)
        assert_allclose(jax.jacfwd(jax.jacfwd(volume))(0.0), bend, rtol=1e-4, atol=1e-5 * abs(slope))
    if not isinstance(shape, Profile):
        slope = (over_cycles(1e-3) - over_cycles(-1e-3)) / 2e-3
        most = 1e-4 if isinstance(shape, Blend) else 2e-2
        assert_allclose(jax.grad(over_cycles)(0.0), slope, rtol=most)


def test_pressures_under_a_flat_face_have_slopes_and_single_precision():
    """Above its edge, of which all of them take a part, the slope of G is infinite."""

    def pressure(flat, dtype=None):
        contact = contact_with(TruncatedSphere(flat), -0.3)
        contact, force, r = jax.tree.map(lambda x: jnp.asarray(x, dtype), (contact, 2.0, np.array([0.0, 2e-5])))
        return contact.steady(force).initial_pressure(r)

    flat = 5e-5
    found, slope = by_numpy(lambda flat: jax.jvp(pressure, (flat,), (flat,)))(np.asarray(flat))
    assert_allclose(slope, (pressure(1.001 * flat) - pressure(0.999 * flat)) / 2e-3, rtol=1e-4)
    assert_allclose(pressure(np.float32(flat), jnp.float32), found, rtol=1e-4)


@parametrize("k, most", [(0.2, 3e-4), compiled_case("layers", 5e-3)])
def test_close_to_gross_slip_a_worn_flat_face_wears_as_it_does_there(k, most):
    """The stick radius is the edge of the face to all digits, where the slope of the force jumps."""
    shape = TruncatedSphere(1.24e-4)
    contact = on("layers", shape) if k == "layers" else contact_with(shape, k)

    def log_volume(share, lack):
        flat, force = share * shape.flat_radius, share * FORCE
        one = dataclasses.replace(contact, normal_force=force, shape=TruncatedSphere(flat))
        return jnp.log(one.steady((1.0 - lack) * FRICTION * force).wear_volume)

    read = by_numpy(lambda lack: jnp.stack(jax.jvp(lambda share: log_volume(share, lack), (1.0,), (1.0,))))
    known, *others = map(read, np.array([1e-5, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12]))
    assert_allclose(others, np.broadcast_to(known, (5, 2)), rtol=most)
    assert_allclose(contact.steady((1.0 - 1e-9) * LIMIT).stick_radius, shape.flat_radius, rtol=1e-9)


GROUND = np.linspace(0.0, 3e-4, 61)  # of a ball with a face, as a table of many rows


@parametrize(
    "shape, k, rtol",
    [
        compiled_case(Profile(RADII, HEIGHTS), 0.3, 1e-6),
        (TruncatedSphere(5e-5), -0.3, 1e-6),
        (Profile(GROUND, TruncatedSphere(5e-5).height(GROUND, R)), -0.3, 1e-3),
    ],
)
def test_pressures_between_kinks_carry_the_normal_force(shape, k, rtol):
    """Of the table three are inside the contact; at the edge of a face the pressure is infinite."""
    steady = contact_with(shape, k).steady(0.0)
    edge, kinks = steady.contact_radius, np.array(by_numpy(lambda: shape.corners)())
    ends = np.r_[0.0, kinks[kinks < edge], edge]
    x, _, weight = logistic(60, 26.0) if rtol < 1e-3 else logistic(30, 14.0)
    length = np.diff(ends)[:, None]
    r = ends[:-1, None] + length * x
    assert_allclose(2.0 * np.pi * np.sum(length * weight * r * steady.initial_pressure(r)), FORCE, rtol=rtol)


def ball(rows):
    """A table of the ball, whose contact on a power law has closed forms."""
    r = np.linspace(0.0, 1.2e-4, rows)
    return Profile(r, r**2 / (2.0 * R))


@parametrize("dtype", [np.float32, np.float64])
def test_only_a_tip_has_infinite_pressure_and_no_rounding_is_one(dtype):
    """The slope of a ball's table at r = 0 is a rounding, compiled another one than not."""
    r = (np.linspace(0.0, 3e-4, 60)).astype(dtype)

    def infinite(heights):
        return Profile(r, heights).unbounded(jnp.asarray(R, dtype), jnp.zeros((), dtype))[0]

    smooth, pointed = (r**2 / (2.0 * R)).astype(dtype), (r**2 / (2.0 * R) + 1e-4 * r).astype(dtype)
    for ask in (by_numpy(infinite), jax.jit(infinite)):
        assert ask(pointed) and not ask(smooth)


@compiled
@parametrize("rows", [120, 2000])
def test_tables_of_many_heights_are_the_ball_that_they_describe(rows):
    one, force = contact_with(ball(rows)), 1.6
    closed = dataclasses.replace(one, shape=None)
    mine, known = one.steady(force), closed.steady(force)
    for name in (*STEADY, "deepest_wear", "energy_per_cycle", "displacement_amplitude"):
        assert_allclose(getattr(mine, name), getattr(known, name), rtol=1e-4, err_msg=name)
    r = np.array([0.3, 0.7, 0.9, 1.05]) * known.stick_radius
    for name, error in data("steady/many_heights.toml").items():
        found, exact = getattr(mine, name)(r), getattr(known, name)(r)
        assert_allclose(found, exact, rtol=0.0, atol=error * np.max(abs(exact)), err_msg=name)


class Kinked(Profile):
    """A table whose pieces are summed one by one, also if they are many."""

    @property
    def kinks(self):
        return self.r[1:-1]


def test_many_heights_have_the_image_of_all_their_cubics():
    r, given = np.linspace(0.0, 3e-4, 300), (jnp.asarray(1.3e-4), jnp.asarray(R), jnp.asarray(0.9))
    T = np.append(np.linspace(0.01, 4.0, 15), 1.0 + np.geomspace(1e-6, 1.0, 5))

    @jax.jit
    def both(heights):
        images = Profile(r, heights).image(*given), Shape.image(Kinked(r, heights), *given)
        return [(image.fallen(T - 1.0), image.rate(jnp.asarray(T), jnp.zeros((T.size, 0)))) for image in images]

    closed, summed = both(r**2 / (2.0 * R) * (1.0 + 0.2 * np.sin(r / 4e-5)))
    for found, known in zip(closed, summed, strict=True):
        assert_allclose(found, known, rtol=0, atol=1e-10 * np.max(abs(known)))


@compiled
def test_tables_of_many_heights_over_cycles_and_their_slopes():
    one, force = contact_with(ball(500)), 1.6
    closed = dataclasses.replace(one, shape=None)
    worn, expected = (each.over_cycles(force, COEFFICIENT).volume(1e5) for each in (one, closed))
    assert_allclose(worn, expected, rtol=2e-3)
    slopes, known = (jax.grad(lambda contact: contact.steady(force).wear_volume)(each) for each in (one, closed))
    # Heights that all grow make a ball of another radius.
    found = slopes.normal_force, slopes.friction, np.sum(slopes.shape.heights * one.shape.heights)
    assert_allclose(found, [known.normal_force, known.friction, -R * known.radius], rtol=1e-3)


def largest(jaxpr):
    """The most numbers of an array in a traced program."""
    sizes = [np.prod(v.aval.shape, dtype=int) for eqn in jaxpr.eqns for v in eqn.outvars if hasattr(v.aval, "shape")]
    inner = [part for eqn in jaxpr.eqns for part in jax.tree.leaves(tuple(eqn.params.values()))]
    return max([*sizes, 0, *(largest(getattr(part, "jaxpr", part)) for part in inner if hasattr(part, "jaxpr"))])


@parametrize("name", ["wear_volume", "deepest_wear", "energy_per_cycle"])
def test_the_memory_of_tables_does_not_grow_with_their_rows(name):
    """A table of 121 heights took 12 GB, one of 601 asked for 290 GB."""
    for body in ("a power law", "layers"):
        one = on(body, ball(2000))
        assert largest(jax.make_jaxpr(lambda one: getattr(one.steady(1.6), name))(one)) < 2**24


@compiled
def test_batches_of_tables_and_single_precision():
    force = 2.0
    tables = Profile(RADII, HEIGHTS * np.array([[1.0], [1.1]]))
    alone = [contact_with(Profile(RADII, heights)).steady(force).wear_volume for heights in tables.heights]
    assert_allclose(contact_with(tables).steady(force).wear_volume, alone, rtol=1e-12)
    shapes = Cone(0.01), RoundedFlat(5e-5), Profile(RADII, HEIGHTS)
    # The compliance of layers has some 1e-3 in single precision.
    for contact, error in (*((contact_with(shape), 2e-4) for shape in shapes), (on("layers", shapes[-1]), 5e-3)):
        single = jax.tree.map(lambda x: jnp.asarray(x, jnp.float32), contact).steady(jnp.float32(force)).wear_volume
        assert single.dtype == jnp.float32
        assert_allclose(single, contact.steady(force).wear_volume, rtol=error)


class Even(Shape):
    """A sum of even powers, whose coefficients are one array."""

    coefficients: Any
    tables = ("coefficients",)

    def height(self, r, radius):
        ratio = (r / 1e-4) ** 2
        return 1e-6 * sum(x * ratio ** (i + 1) for i, x in enumerate(self.coefficients))


@compiled
def test_a_shape_of_ones_own_may_hold_an_array():
    """1e-6 (r/1e-4)^2 is the sphere of the radius 5e-3."""
    whole, force = on("a power law under steel", Even(np.array([1.0, 0.0]))), np.array([1.0, 2.0])
    expected = dataclasses.replace(whole, shape=None).steady(force).wear_volume
    assert_allclose(whole.steady(force).wear_volume, expected, rtol=1e-5)
    slopes = jax.grad(lambda shape: dataclasses.replace(whole, shape=shape).steady(1.5).wear_volume)(whole.shape)
    assert slopes.coefficients.shape == (2,) and np.all(np.isfinite(slopes.coefficients))


# --- what is refused --------------------------------------------------------------------------------------------------


SHRUNK = 7e-5 / RADII[-1]
SHORT = Profile(SHRUNK * RADII, SHRUNK**2 * HEIGHTS)  # of as many rows as the table above, whose program it takes


class Nothing(Shape):
    """Without a height."""


@parametrize(
    "shape, told",
    [
        (Nothing(), r"Nothing has no height\(r, radius\)"),
        (SHORT, "ends at r = 7e-05 m, inside the contact radius before any wear at normal_force = 10"),
        (4, r"shape takes a Shape such as PowerShape.* not 4"),
    ],
)
def test_shapes_that_no_contact_can_have(shape, told):
    with pytest.raises((TypeError, ValueError, NotImplementedError), match=told):
        contact_with(shape).steady(0.0).contact_radius


@compiled
def test_traced_shapes_that_are_none_give_nan():
    short = contact_with(SHORT)
    assert np.isnan(jax.jit(lambda force: short.steady(force).wear_volume)(2.0))
    assert np.isnan(jax.jit(lambda u: short.over_cycles(loads.Displacement(u), COEFFICIENT).volume(1e3))(1e-5))
    falling = jax.jit(lambda heights: contact_with(Profile(RADII, heights)).steady(0.0).contact_radius)
    assert np.isnan(falling(HEIGHTS[::-1].copy())) and np.isfinite(falling(HEIGHTS))
    assert np.isnan(jax.jit(lambda n: contact_with(PowerShape(n)).steady(0.0).contact_radius)(0.5))


def test_a_shape_is_a_frozen_record():
    shape = Blend(flat=1e-5)
    assert shape == Blend(1e-5) and jax.tree.leaves(shape) == [1e-5, 0.0, 0.0, 1.0]
    with pytest.raises(dataclasses.FrozenInstanceError):
        shape.flat = 2e-5


# --- input files ------------------------------------------------------------------------------------------------------

SCENE = """
[material]
E0 = 110e9
z0 = 1e-4
k = 0.2
nu = 0.3
[contact]
kind = "fretting"
radius = 5e-3
normal_force = 10.0
friction = 0.4
shape = {shape}
[load]
tangential_force = 1.5
"""


def built(folder, shape, table=""):
    """The contact of an input file, beside which a table may stand."""
    return scene_of(SCENE.format(shape=shape), folder, profile=table).build_contact()


@parametrize(
    "words, shape",
    [
        ("kind = 'cone', slope = 0.01", Cone(0.01)),
        ("kind = 'power', exponent = 4", PowerShape(4.0)),
        ("kind = 'rounded_flat', flat_radius = 1e-5", RoundedFlat(1e-5)),
        ("kind = 'truncated_sphere', flat_radius = 1e-5", TruncatedSphere(1e-5)),
    ],
)
def test_input_files_take_them(words, shape, tmp_path):
    assert built(tmp_path, f"{{ {words} }}").shape == shape


PROFILE = "{ table = 'profile.csv' }"


def test_input_files_take_tables(tmp_path):
    rows = "\n".join(f"{x},{0.1 * x * x}" for x in range(10, 200, 10))
    found = built(tmp_path, PROFILE, "r (um),height (nm)\n0,0\n" + rows).shape
    assert_allclose(found.heights, 0.1e-9 * (1e6 * found.r) ** 2, rtol=1e-14)


@cases("steady/refused.toml", "scene")
def test_input_files_are_refused(case, tmp_path):
    line = refusal(scene.SceneError, built, tmp_path, case.get("shape", PROFILE), case.get("table", ""))
    assert is_told(line.replace(f"{tmp_path}/", ""), case)


@compiled
def test_a_profile_that_ends_too_early_is_told_with_its_row(tmp_path):
    built(tmp_path, PROFILE, "r (um),height (nm)\n0,0\n20,40\n40,160\n")
    with pytest.raises(scene.OtherFileError, match=r"profile.csv: row 4: ends at r = 4e-05 m, inside the worn radius"):
        scene.load(tmp_path / "scene.toml").solve()
