"""Cones, flat faces and tables of heights: rigid on a power law against an oracle, and what they promise elsewhere."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from rigid_shapes import FORCE, FRICTION, HEIGHTS, RADII, SHAPES, STEADY, R, contact_with, exact, steady

from plgwear_jax import (
    Cone,
    DepthGraded,
    Elastic,
    FrettingContact,
    Layered,
    PowerLawGraded,
    Profile,
    RoundedFlat,
    Shape,
    TruncatedSphere,
    optimise,
    scene,
)
from plgwear_jax.loads import Displacement
from plgwear_jax.special.quadrature import logistic

SLOW = ("table", "rounded flat")  # to compile


@pytest.mark.parametrize(
    "name, k, phi",
    [
        *((name, 0.3, 0.4) for name in SHAPES if name not in SLOW),
        *(pytest.param(name, 0.3, 0.4, marks=pytest.mark.compiled) for name in SLOW),
        *(
            pytest.param(name, k, phi, marks=pytest.mark.long)
            for name in SHAPES
            for k in (-0.9, -0.4, 0.0, 0.5, 0.9)
            for phi in (0.01, 0.5, 0.99)
            if (name, k) != ("truncated sphere", -0.9)
        ),
        *(pytest.param("truncated sphere", -0.7, phi, marks=pytest.mark.long) for phi in (0.01, 0.5, 0.99)),
    ],
)
def test_a_rigid_indenter_on_a_power_law_is_that_of_its_integrals(name, k, phi):
    shape, _, rtol = SHAPES[name]
    found = steady(contact_with(shape, k), phi * FRICTION * FORCE)
    # Small amplitudes leave the volume fewer digits, and the cone at k = -0.9 a wide ring.
    rtol = rtol if phi == 0.4 else max(rtol, 2e-11)
    np.testing.assert_allclose(found, exact(name, k, phi), rtol=rtol)


@pytest.mark.long
@pytest.mark.parametrize("phi", [0.01, 0.5])
def test_a_narrow_ring_of_a_truncated_sphere(phi):
    """At k = -0.9 its contact ends close to the flat face; at phi = 0.99 closer than floating-point numbers tell."""
    found = steady(contact_with(SHAPES["truncated sphere"][0], -0.9), phi * FRICTION * FORCE)
    known = exact("truncated sphere", -0.9, phi)
    np.testing.assert_allclose(found[:4], known[:4], rtol=1e-11)
    np.testing.assert_allclose(found[4], known[4], rtol=1e-4)


def test_on_a_homogeneous_half_space_they_are_those_of_textbooks():
    plane = 110e9 / (1.0 - 0.3**2)
    a = contact_with(Cone(0.01), 0.0).steady(0.0).contact_radius
    np.testing.assert_allclose(0.5 * np.pi * plane * a * a * 0.01, FORCE, rtol=1e-12)
    r = np.array([0.1, 0.5, 0.9]) * a
    pressure = contact_with(Cone(0.01), 0.0).steady(0.0).initial_pressure(r)
    np.testing.assert_allclose(pressure, 0.5 * plane * 0.01 * np.arccosh(a / r), rtol=1e-9)
    assert np.isinf(contact_with(Cone(0.01), 0.0).steady(0.0).initial_pressure(0.0))
    # A rounded flat with a = R = 1 and b = 0.6.
    one = FrettingContact(PowerLawGraded(1.0, 1.0, 0.0, 0.0), 1.0, 2.0 * 0.2071448, FRICTION, shape=RoundedFlat(0.6))
    np.testing.assert_allclose(one.steady(0.0).contact_radius, 1.0, rtol=1e-7)


class Rounded(Shape):
    """As `RoundedFlat`, by quadrature."""

    flat: Any

    def height(self, r, radius):
        return jnp.maximum(r - self.flat, 0.0) ** 2 / (2.0 * radius)

    @property
    def kinks(self):
        return (self.flat,)


@pytest.mark.compiled
def test_a_class_of_ones_own_is_as_exact():
    force = np.array([0.04, 2.0, 3.96])
    for k in (-0.6, 0.6):
        known, own = contact_with(RoundedFlat(5e-5), k).steady(force), contact_with(Rounded(5e-5), k).steady(force)
        for name in (*STEADY, "deepest_wear", "energy_per_cycle", "edge_intensity", "displacement_amplitude"):
            np.testing.assert_allclose(getattr(own, name), getattr(known, name), rtol=1e-8, err_msg=name)


@pytest.mark.compiled
def test_all_quantities_hold_together():
    contact, force = contact_with(TruncatedSphere(4e-5), -0.3), 1.5
    state = contact.steady(force)
    edges = np.sqrt(np.linspace(0.0, 1.0, 4001))
    r = 0.5 * (edges[1:] + edges[:-1])
    for name, end in (("initial_pressure", state.contact_radius), ("pressure", state.stick_radius)):
        pressed = np.mean(getattr(state, name)(r * end)) * np.pi * end**2
        np.testing.assert_allclose(pressed, FORCE, rtol=2e-2)
    assert state.wear_depth(state.worn_radius) < 1e-6 * state.deepest_wear
    ring = np.linspace(state.stick_radius, state.worn_radius, 4001)
    depth = np.asarray(state.wear_depth(ring))
    volume = 2.0 * np.pi * np.trapezoid(depth * ring, ring)
    np.testing.assert_allclose(volume, state.wear_volume, rtol=1e-3)
    np.testing.assert_allclose(np.max(depth), state.deepest_wear, rtol=1e-4)
    moved = contact.steady(force).displacement_amplitude
    np.testing.assert_allclose(contact.steady(Displacement(moved)).tangential_force, force, rtol=1e-8)
    assert np.isinf(state.peak_initial_pressure)
    assert np.isfinite(contact_with(RoundedFlat(4e-5), -0.3).steady(0.0).peak_initial_pressure)


# --- kinks on numerical bodies, and narrow rings ----------------------------------------------------------------------

KINKED = (Cone(0.01), TruncatedSphere(5e-5), RoundedFlat(5e-5))


def work_of_friction(state, friction):
    """4 mu times the integral of the pressure times the slip over the ring."""
    x, weights = np.polynomial.legendre.leggauss(24)
    x, weights = 0.5 * (x + 1.0), 0.5 * weights
    x, weights = x**3 * (10.0 - 15.0 * x + 6.0 * x * x), 30.0 * x * x * (1.0 - x) ** 2 * weights
    r = state.stick_radius + (state.contact_radius - state.stick_radius) * x
    work = state.initial_pressure(r) * state.slip_amplitude(r) * r
    return 8.0 * np.pi * friction * (state.contact_radius - state.stick_radius) * np.sum(work * weights)


@pytest.mark.parametrize(
    "shape",
    [*KINKED[:2], pytest.param(KINKED[2], marks=pytest.mark.compiled)],  # which is computed as the second one is
    ids=lambda shape: type(shape).__name__,
)
def test_layers_of_one_modulus_have_the_pressures_and_energies_of_a_power_law(shape):
    layers = FrettingContact(Layered([1e-5, 3e-5], [110e9] * 3, 0.3), 5e-3, FORCE, FRICTION, shape=shape)
    layered, known = (contact.steady(0.05 * FRICTION * FORCE) for contact in (layers, contact_with(shape, 0.0)))
    r = np.array([0.05, 0.3, 0.6, 0.9, 0.99]) * known.contact_radius
    mean = FORCE / (np.pi * known.contact_radius**2)
    np.testing.assert_allclose(layered.initial_pressure(r) / mean, known.initial_pressure(r) / mean, atol=1e-8)
    np.testing.assert_allclose(layered.energy_per_cycle, work_of_friction(known, FRICTION), rtol=1e-5)
    np.testing.assert_allclose(layered.gross_slip_energy_ratio, known.gross_slip_energy_ratio, rtol=1e-8)


@pytest.mark.compiled
@pytest.mark.parametrize("shape", KINKED, ids=lambda shape: type(shape).__name__)
def test_energies_of_kinks_are_the_work_of_friction(shape):
    layers = Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3)
    contact = FrettingContact(layers, 5e-3, FORCE, FRICTION, Elastic(210e9, 0.3), shape)
    for phi in (1e-4, 0.05):
        state = contact.steady(phi * FRICTION * FORCE)
        np.testing.assert_allclose(state.energy_per_cycle, work_of_friction(state, FRICTION), rtol=1e-4)
        around = 4.0 * phi * FRICTION * FORCE * state.displacement_amplitude
        np.testing.assert_allclose(state.energy_ratio, state.energy_per_cycle / around, rtol=1e-10)


NARROW = np.array([1e-3, 1e-6, 1e-9])


@pytest.mark.parametrize("k", [pytest.param(0.2, marks=pytest.mark.compiled), -0.3])
def test_narrow_rings_keep_their_digits(k):
    law, steel = PowerLawGraded(110e9, 1e-4, k, 0.3), Elastic(210e9, 0.3)

    def of(indenter, digits):
        contact = FrettingContact(law, 5e-3, FORCE, FRICTION, indenter)
        state = contact.steady(NARROW * FRICTION * FORCE, digits=digits)
        return [getattr(state, name) for name in ("wear_volume", "deepest_wear", "energy_per_cycle", "energy_ratio")]

    np.testing.assert_allclose(of(steel, 4), of(steel, 5), rtol=1e-4)
    np.testing.assert_allclose(of(Elastic(1e22, 0.3), 4), of(None, None), rtol=1e-4)


@pytest.mark.compiled
def test_narrow_rings_of_layers_go_as_those_of_a_homogeneous_half_space():
    contact = FrettingContact(Layered([2e-6, 3e-6], [4e11, 2e11, 1.1e11], 0.3), 5e-3, FORCE, FRICTION)
    volumes = contact.steady(NARROW * FRICTION * FORCE).wear_volume / NARROW**2.5
    np.testing.assert_allclose(volumes[2], volumes[1], rtol=1e-4)
    slope = jax.grad(lambda contact: jnp.log(contact.steady(1e-9 * FRICTION * FORCE).wear_volume))(contact)
    assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(slope))


# --- derivatives and batches ------------------------------------------------------------------------------------------

LEAVES = [(Cone(0.01), "slope"), (RoundedFlat(5e-5), "flat_radius"), (TruncatedSphere(3e-5), "flat_radius")]


@pytest.mark.compiled
@pytest.mark.parametrize("shape, name", LEAVES, ids=lambda x: type(x).__name__)
def test_derivatives_are_those_of_differences(shape, name):
    value = getattr(shape, name)

    def of(scale):
        return contact_with(dataclasses.replace(shape, **{name: value * scale}), -0.2)

    def volume(scale):
        return of(scale).steady(2.0).wear_volume

    def over_cycles(scale):
        return of(scale).over_cycles(2.0, 1e-14).volume(1e5)

    step = 1e-4
    ends = [volume(1.0 + n * step) for n in (-2, -1, 0, 1, 2)]
    slope = (ends[0] - 8.0 * ends[1] + 8.0 * ends[3] - ends[4]) / (12.0 * step)
    bend = (-ends[0] + 16.0 * ends[1] - 30.0 * ends[2] + 16.0 * ends[3] - ends[4]) / (12.0 * step**2)
    np.testing.assert_allclose(jax.jit(jax.grad(volume))(1.0), slope, rtol=1e-6)
    np.testing.assert_allclose(jax.jacfwd(jax.jacfwd(volume))(1.0), bend, rtol=1e-4, atol=1e-5 * abs(slope))
    slope = (over_cycles(1.001) - over_cycles(0.999)) / 2e-3
    np.testing.assert_allclose(jax.grad(over_cycles)(1.0), slope, rtol=2e-2)


def test_the_pressure_of_a_table_carries_the_normal_force():
    """Between its kinks, of which three are inside the contact."""
    steady = contact_with(Profile(RADII, HEIGHTS)).steady(0.0)
    edge = float(steady.contact_radius)
    ends = np.append(RADII[edge > RADII], edge)
    x, _, weight = (np.asarray(row) for row in logistic(60, 26.0))
    length = np.diff(ends)[:, None]
    r = ends[:-1, None] + length * x
    carried = 2.0 * np.pi * np.sum(length * weight * r * np.reshape(steady.initial_pressure(r.ravel()), r.shape))
    np.testing.assert_allclose(carried, FORCE, rtol=1e-6)


@pytest.mark.compiled
def test_derivatives_by_the_heights_of_a_table():
    def volume(heights):
        return contact_with(Profile(RADII, heights)).steady(2.0).wear_volume

    slopes, along = jax.grad(volume)(HEIGHTS), np.array([0.0, 1.0, -2.0, 1.5, 0.5, -1.0, 1.0, 0.0]) * HEIGHTS
    step = 1e-5
    ends = [volume(HEIGHTS + n * step * along) for n in (-1, 1)]
    np.testing.assert_allclose(slopes @ along, (ends[1] - ends[0]) / (2.0 * step), rtol=1e-6)


def ball(rows):
    """A table of the ball, whose contact on a power law has closed forms."""
    r = np.linspace(0.0, 1.2e-4, rows)
    return Profile(r, r**2 / (2.0 * R))


@pytest.mark.compiled
@pytest.mark.parametrize("rows", [120, 2000])
def test_tables_of_many_heights_are_the_ball_that_they_describe(rows):
    one, force = contact_with(ball(rows)), 1.6
    closed = dataclasses.replace(one, shape=None)
    mine, known = one.steady(force), closed.steady(force)
    for name in (*STEADY, "deepest_wear", "energy_per_cycle", "displacement_amplitude"):
        np.testing.assert_allclose(getattr(mine, name), getattr(known, name), rtol=1e-4, err_msg=name)
    r = np.array([0.3, 0.7, 0.9, 1.05]) * float(known.stick_radius)
    for name, error in (("profile", 1e-5), ("wear_depth", 1e-4), ("slip_amplitude", 1e-4), ("initial_pressure", 5e-3)):
        found, exact = getattr(mine, name)(r), np.asarray(getattr(known, name)(r))
        np.testing.assert_allclose(found, exact, rtol=0.0, atol=error * np.max(abs(exact)), err_msg=name)


@pytest.mark.compiled
def test_tables_of_many_heights_over_cycles_and_their_slopes():
    def worn(contact):
        return contact.over_cycles(1.6, 1e-14).volume(1e5)

    def of_heights(scale):
        shape = ball(500)
        return contact_with(Profile(shape.r, scale * shape.heights)).steady(1.6).wear_volume

    one = contact_with(ball(500))
    np.testing.assert_allclose(worn(one), worn(dataclasses.replace(one, shape=None)), rtol=2e-3)
    slopes = jax.grad(lambda contact: contact.steady(1.6).wear_volume)(one)
    known = jax.grad(lambda contact: contact.steady(1.6).wear_volume)(dataclasses.replace(one, shape=None))
    for name in ("normal_force", "friction"):
        np.testing.assert_allclose(getattr(slopes, name), getattr(known, name), rtol=1e-3)
    # The heights of a ball of another radius.
    np.testing.assert_allclose(jax.grad(of_heights)(1.0), -R * known.radius, rtol=1e-3)
    assert np.isfinite(slopes.shape.heights).all()
    single = jax.tree.map(lambda x: jnp.asarray(x, jnp.float32), one).steady(jnp.float32(1.6)).wear_volume
    np.testing.assert_allclose(single, one.steady(1.6).wear_volume, rtol=2e-3)


def largest(jaxpr):
    """The most numbers of an array in a traced program."""
    sizes = [np.prod(v.aval.shape, dtype=int) for eqn in jaxpr.eqns for v in eqn.outvars if hasattr(v.aval, "shape")]
    inner = [part for eqn in jaxpr.eqns for part in jax.tree.leaves(tuple(eqn.params.values()))]
    return max([*sizes, 0, *(largest(getattr(part, "jaxpr", part)) for part in inner if hasattr(part, "jaxpr"))])


@pytest.mark.parametrize("name", ["wear_volume", "deepest_wear", "energy_per_cycle"])
def test_the_memory_of_tables_does_not_grow_with_their_rows(name):
    """A table of 121 heights took 12 GB, one of 601 asked for 290 GB."""
    layers = Layered([2e-5], [50e9, 100e9], 0.3)
    for material in (contact_with(ball(2)).material, layers):
        one = dataclasses.replace(contact_with(ball(2000)), material=material)
        assert largest(jax.make_jaxpr(lambda one: getattr(one.steady(1.6), name))(one)) < 2**24


@pytest.mark.compiled
def test_batches_and_single_precision():
    slopes, force = np.array([0.008, 0.01, 0.02]), 2.0
    alone = [contact_with(Cone(slope)).steady(force).wear_volume for slope in slopes]
    np.testing.assert_allclose(contact_with(Cone(slopes)).steady(force).wear_volume, alone, rtol=1e-12)
    mapped = jax.jit(jax.vmap(lambda slope: contact_with(Cone(slope)).steady(force).wear_volume))
    np.testing.assert_allclose(mapped(slopes), alone, rtol=1e-12)
    tables = Profile(RADII, HEIGHTS * np.array([[1.0], [1.1]]))
    alone = [contact_with(Profile(RADII, heights)).steady(force).wear_volume for heights in tables.heights]
    np.testing.assert_allclose(contact_with(tables).steady(force).wear_volume, alone, rtol=1e-12)
    shapes = Cone(0.01), RoundedFlat(5e-5), Profile(RADII, HEIGHTS)
    layers = dataclasses.replace(contact_with(shapes[-1]), material=Layered([2e-5], [50e9, 100e9], 0.3))
    # The compliance of layers has some 1e-3 in single precision.
    for contact, error in (*((contact_with(shape), 2e-4) for shape in shapes), (layers, 5e-3)):
        single = jax.tree.map(lambda x: jnp.asarray(x, jnp.float32), contact).steady(jnp.float32(force)).wear_volume
        assert single.dtype == jnp.float32
        np.testing.assert_allclose(single, contact.steady(force).wear_volume, rtol=error)


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["cone", "rounded flat", "truncated sphere", "table", "flat power"])
def test_layers_of_one_modulus_are_a_homogeneous_half_space(name):
    half_space = DepthGraded([1e-6, 1e-3], [110e9, 110e9], 0.3)
    contact, force = contact_with(SHAPES[name][0], 0.0), np.array([0.2, 2.0, 3.6])
    other = dataclasses.replace(contact, material=half_space)
    for quantity in STEADY:
        known = getattr(contact.steady(force), quantity)
        np.testing.assert_allclose(getattr(other.steady(force), quantity), known, rtol=1e-6, err_msg=quantity)


# --- what is refused --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "make, told",
    [
        (lambda: Cone(0.0), "slope = 0.0 is outside the allowed range > 0"),
        (lambda: RoundedFlat(-1e-6), "flat_radius = -1e-06 is outside the allowed range >= 0"),
        (lambda: TruncatedSphere(np.nan), "flat_radius = nan is outside"),
        (lambda: Profile([0.0], [0.0]), "r and heights take two points or more"),
        (lambda: Profile([0.0, 1e-5], [0.0]), "r and heights take two points or more"),
        (lambda: Profile([0.0, 2e-5, 1e-5], [0.0, 1e-9, 2e-9]), r"r\[1\] = 2e-05 m is followed by 1e-05 m"),
        (lambda: Profile([0.0, 1e-5, 2e-5], [0.0, 2e-9, 1e-9]), r"heights\[1\] = 2e-09 m is followed by 1e-09 m"),
        (lambda: Profile([0.0, 1e-5], [0.0, np.nan]), "heights = nan at index 1 is outside"),
        (lambda: Profile([1e-6, 1e-5], [0.0, 1e-9]), r"r\[0\] = 1e-06 m: the table begins with r = 0"),
        (lambda: Profile([0.0, 1e-5], [0.0, 0.0]), r"heights\[1\] = 0.0 m: the last one must be > 0"),
    ],
)
def test_what_is_refused(make, told):
    with pytest.raises(ValueError, match=told):
        make()


def test_a_table_that_ends_too_early():
    short = contact_with(Profile(RADII[:4], HEIGHTS[:4]))
    with pytest.raises(ValueError, match="the table of heights ends at r = 7e-05 m, inside the worn radius"):
        _ = short.steady(0.0).contact_radius
    assert np.isnan(jax.jit(lambda force: short.steady(force).wear_volume)(2.0))
    falling = jax.jit(lambda heights: contact_with(Profile(RADII, heights)).steady(0.0).contact_radius)
    assert np.isnan(falling(HEIGHTS[::-1].copy())) and np.isfinite(falling(HEIGHTS))


# --- input files, designs ---------------------------------------------------------------------------------------------

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


@pytest.mark.compiled
def test_input_files_take_them(tmp_path):
    file, table = tmp_path / "scene.toml", tmp_path / "profile.csv"
    table.write_text("r (um),height (nm)\n0,0\n" + "\n".join(f"{x},{0.1 * x * x}" for x in range(10, 200, 10)))
    for text, shape in (
        ('{ kind = "cone", slope = 0.01 }', Cone(0.01)),
        ('{ kind = "rounded_flat", flat_radius = 1e-5 }', RoundedFlat(1e-5)),
        ('{ kind = "truncated_sphere", flat_radius = 1e-5 }', TruncatedSphere(1e-5)),
    ):
        file.write_text(SCENE.format(shape=text))
        assert scene.load(file).build_contact().shape == shape  # pyright: ignore[reportAttributeAccessIssue]
    file.write_text(SCENE.format(shape='{ table = "profile.csv" }'))
    found = scene.load(file).build_contact()
    assert isinstance(found, FrettingContact) and isinstance(found.shape, Profile)
    np.testing.assert_allclose(found.shape.heights, 0.1e-9 * (1e6 * np.asarray(found.shape.r)) ** 2, rtol=1e-14)
    table.write_text("r (um),height (nm)\n0,0\n20,40\n40,160\n")
    with pytest.raises(scene.OtherFileError, match=r"profile.csv: row 4: ends at r = 4e-05 m, inside the worn radius"):
        scene.load(file).solve()
    for content, told in (
        ("r,height\n0,0\n", "row 2: is the only one; a profile needs two radii or more"),
        (
            "r,height\n0,0\n1e-5,2e-9\n2e-5,1e-9\n",
            "row 4: height = 1e-09 m after 2e-09 m: radii and heights must increase",
        ),
        ("r,height\n1e-6,0\n2e-5,1e-9\n", "row 2: r = 1e-06 m: a profile begins with r = 0, height = 0"),
        ("r,height\n0,0\n2e-5,0\n", "row 3: height = 0 m: the last one must be > 0"),
    ):
        table.write_text(content)
        with pytest.raises(scene.SceneError, match=rf"profile.csv: {told}"):
            scene.load(file)
    file.write_text(SCENE.format(shape='{ kind = "cone" }'))
    with pytest.raises(scene.SceneError, match=r"\[contact\] shape = .*: must be .*slope = 0.01"):
        scene.load(file)


@pytest.mark.compiled
def test_designs_vary_their_leaves():
    contact = contact_with(RoundedFlat(3e-5))
    found = optimise.design(contact, 1.5, {"shape.flat_radius": (1e-5, 6e-5)}, minimise="wear_volume", limits={})
    flat = found.variables["shape.flat_radius"]
    volumes = [contact_with(RoundedFlat(b)).steady(1.5).wear_volume for b in np.linspace(1e-5, 6e-5, 11)]
    best = contact_with(RoundedFlat(float(flat))).steady(1.5).wear_volume
    assert best <= min(volumes) * (1.0 + 1e-6)
