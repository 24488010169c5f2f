"""Any test over cycles: against the march of one force in closed form, rings that know the Green's function alone, and
what is known of energies, forces, volumes and ends; and what a run of it promises as an object. About two digits are
promised: 1 % of the last volume."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from balance import sums
from kinds import COEFFICIENT, FORCE, FRICTION, KINDS, LAW, LAYERS, LIMIT, RADIUS, STEEL, contact_of, dome
from march_oracle import HISTORIES, Given, edges_to, on_power_law
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from reduced import MANY, Reduced, coefficient_of, unit_of
from refusals import cases, data

from plgwear_jax import FrettingContact, Layered, fretting, loads
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.shapes import Cone
from plgwear_jax.wear_laws import Archard, PressurePower, WearLaw, law_of

ERROR = 1e-2  # promised, of the last volume
SHARES = np.array([0.003, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99])


class WithThreshold(WearLaw):
    coefficient: float
    threshold: float

    def rate(self, pressure, slip):
        return self.coefficient * jnp.maximum(pressure - self.threshold, 0.0) * slip


# Both laws share a program: of no threshold, and of twice the largest pressure.
SAME, HIGH = (WithThreshold(COEFFICIENT, threshold) for threshold in (0.0, 2e9))
THIN = Layered([2e-7], [200e9, 100e9], 0.3)  # than the cells


# --- against the march of one force -----------------------------------------------------------------------------------


def errors(one, force):
    """Of volume, last volume, contact radius and stick radius, at the times of the shares."""
    exact, run = one.over_cycles(force, COEFFICIENT), one.over_cycles(force, SAME)
    cycles = exact.cycles_to(SHARES)
    last = one.steady(force).wear_volume
    names = "volume", "contact_radius", "stick_radius"
    volume, radius, stick = (np.array([getattr(each, name)(cycles) for each in (run, exact)]) for name in names)
    end = run.volume(1e30) / last - 1.0
    return (volume[0] - volume[1]) / last, end, radius[0] / radius[1] - 1.0, stick[0] / stick[1] - 1.0


@parametrize(
    "k, phi",
    [
        *((-0.65, 0.9), (0.7, 0.8)),
        compiled_case(-0.94, 0.5),  # whose last radius the first passes miss
        *(
            compiled_case(k, phi)
            for k in (-0.8, -0.6, -0.3, 0.0, 0.3, 0.5, 0.6, 0.7, 0.8)
            for phi in (0.02, 0.3, 0.5, 0.8, 0.98)
        ),
    ],
)
def test_one_force_is_worn_as_in_closed_form(k, phi):
    volume, end, radius, stick = errors(dome(k), phi * LIMIT)
    assert max(np.max(abs(volume)), abs(end)) < ERROR
    # There the edge moves outwards under a pressure that is too small for its cells.
    shallow = (k < -0.7 and phi > 0.7) or k < -0.9
    assert np.all(abs(radius) < (0.16 if shallow else 0.02)) and np.max(abs(stick)) < 0.005


@compiled
@parametrize("one", [KINDS["layers under steel"], KINDS["a shape"], contact_of(THIN)], ids=["layers", "shape", "thin"])
def test_one_force_on_layers_is_worn_as_by_the_other_march(one):
    volume, end, radius, stick = errors(one, 2.0)
    assert max(np.max(abs(volume)), abs(end)) < ERROR
    assert np.max(abs(radius)) < 0.02 and np.max(abs(stick)) < 0.005


def test_a_block_ends_where_it_ends_whatever_its_cycles_round_to():
    cycles = [1e5 / 3.0, 1e5 / 7.0, 1e6 / 13.0]
    run = ONE.over_cycles([Block(x, n) for x, n in zip((3.0, 0.5, 2.0), cycles, strict=True)], COEFFICIENT)
    ends = np.cumsum(cycles)[:, None] * (1.0 + np.array([-4.0, -1.0, 0.0, 1.0, 4.0]) * 2.0**-52)
    stick = run.stick_radius(ends)
    assert_array_equal(stick, stick[:, 2:3] + 0.0 * ends)
    assert np.all(abs(run.stick_radius(ends[:-1, 2] * (1.0 + 1e-6)) / stick[:-1, 2] - 1.0) > 0.05)


@compiled
@parametrize("k, phi", [(0.6, 0.95), (-0.3, 0.8)])
def test_a_held_displacement_wears_as_rings_do_close_to_gross_slip(k, phi):
    """Of a fine ring around the radius that sticks at first nothing is left where it sticks in the end."""
    one = dome(k)
    run = one.over_cycles(Displacement(one.steady(phi * LIMIT).displacement_amplitude), coefficient_of(one))
    last, held = 2.0 * float(run.cycles_to(0.97)) / MANY, 1.0 - (1.0 - phi) ** (2.0 / (3.0 + k))
    n, worn, _, _, stick = on_power_law(k, edges_to(1.6, 240, 100)).march([Given(last, displacement=held)], 160)
    at, a_0 = slice(60, None, 20), float(one.steady(0.0).contact_radius)
    cycles = MANY * n[at]
    volume = run.volume(cycles) / (a_0**4 / RADIUS)
    assert_allclose(volume, worn[at], atol=(ERROR + 6e-3) * worn[-1])  # what these rings are off
    assert_allclose(volume[-1], worn[-1], rtol=ERROR)
    assert_allclose(run.stick_radius(cycles) / a_0, stick[at], rtol=0.02)


# --- against rings ----------------------------------------------------------------------------------------------------


@parametrize(
    "k, history",
    [
        (0.0, "from gross to partial slip"),
        *(compiled_case(k, history) for k in (-0.6, 0.0, 0.6) for history in HISTORIES),
    ],
)
def test_it_wears_as_rings_do(k, history):
    blocks, outer = HISTORIES[history]
    one = dome(k)
    a_0, onset = float(one.steady(0.0).contact_radius), float(one.steady(0.0).gross_slip_displacement)

    def load(given):
        if given.displacement is None:
            return given.force * LIMIT
        return Displacement(given.displacement * onset, LIMIT / (given.rig * onset) if given.rig else None)

    # Several blocks are always three, so that they share their program.
    more = [blocks[-1]._replace(n=0.0)] * (0 if len(blocks) == 1 else 3 - len(blocks))
    given = [Block(load(x), MANY * x.n, FORCE * x.normal_force, FRICTION * x.friction) for x in blocks + more]
    run = one.over_cycles(given, coefficient_of(one))
    n, m = (100, 200) if len(blocks) == 1 else (60, 100)
    sizes = (n, m), (2 * n, m), (n, 2 * m)
    rough, rings, steps = (on_power_law(k, edges_to(outer, n, n)).march(blocks, m) for n, m in sizes)
    # To no length of a step.
    n, volume = rough[0], rings[1] + 2.0 * (np.interp(rough[0], steps[0], steps[1]) - rough[1])
    found = run.volume(np.minimum(MANY * n, run.lasting_cycles)) / (a_0**4 / RADIUS)
    assert_allclose(found, volume, rtol=0.0, atol=ERROR * volume[-1])


def test_a_narrow_ring_of_a_heavier_block_wears_as_it_does_alone():
    """Where it slips nothing touched before."""
    one, force = dome(0.0), 2.0 * FORCE
    alone = contact_of(one.material, force=force).over_cycles(0.05 * FRICTION * force, COEFFICIENT)
    last = alone.cycles_to(0.3)
    run = one.over_cycles([Block(2.0, 1.0), Block(0.05 * FRICTION * force, last, force), Block(0.0, 5.0)], COEFFICIENT)
    volume = run.volume(last + np.array([1.0, 6.0]))
    assert_allclose(volume[0], alone.volume(last), rtol=ERROR)
    # Without an amplitude nothing wears.
    assert volume[1] == volume[0] and run.rate(last + 3.0) == 0.0


def test_less_is_worn_at_a_held_displacement_since_more_sticks():
    for k, phi, known in data("wear/points.toml")["less"]:
        run, final = Reduced(k, phi, held=True), fretting.wear_volume(k, phi)
        times = unit_of(k, phi) * np.array([0.1, 0.3, 0.6, 1.0, 3.0, 10.0, 20.0, 50.0, 200.0, 1e6])
        volume = run.volume(times)
        assert np.isnan(known) or abs(volume[-1] / final - known) < ERROR
        # Nothing is put back when hardly anything wears.
        assert np.all(np.diff(volume) >= 0.0) and np.all(run.rate(times) >= 0.0)
        radius = run.radius(times)
        assert np.all(np.diff(radius) >= 0.0) and np.all(radius < 1.001 * fretting.worn_radius(k, phi))
        assert np.all(run.stick_radius(times) > 0.995 * fretting.stick_radius(k, phi))


@parametrize("k", [compiled_case(-0.5), 0.6])
def test_the_largest_amplitude_decides(k):
    """Growing amplitudes end at the limit of the largest; a smaller one after a larger wears no more than that."""
    given, blocks = np.array([0.4, 0.8, 0.5]), [1e4, 1e4, 1e2]
    run, ends = Reduced(k, given, blocks=blocks), np.cumsum(blocks)
    final = fretting.wear_volume(k, np.maximum.accumulate(given))
    volume = run.volume(ends) / final[-1]
    assert_allclose(volume, final / final[-1], atol=ERROR)
    # After the steady state nothing is left for a smaller one.
    assert_allclose(volume[2], volume[1], rtol=0.0, atol=1e-6)
    assert_allclose(run.stick_radius(ends[:2] * (1.0 - 1e-6)), fretting.stick_radius(k, given[:2]), rtol=5e-3)
    assert_allclose(run.radius(ends[1]), fretting.worn_radius(k, 0.8), rtol=0.02)
    blocks = [2.0, 1.0, 1e4]
    mixed = Reduced(k, np.array([0.7, 0.3, 0.7]), blocks=blocks)
    volume, alone = mixed.volume(np.cumsum(blocks)), Reduced(k, 0.7).volume(np.array([2.0, 3.0, 1e6]))
    assert 0.0 < volume[1] - volume[0] < 0.5 * (alone[1] - alone[0])
    assert mixed.stick_radius(2.5) > mixed.stick_radius(1.5)
    assert_allclose(volume[2], alone[2], rtol=ERROR)


# --- what is known ----------------------------------------------------------------------------------------------------


@parametrize("k, exponent", [(-0.5, 1.0), (0.0, 1.0), (0.5, 1.0), compiled_case(0.2, 0.5)])
def test_gross_slip_wears_by_the_way_and_leaves_a_flat_scar(k, exponent):
    one = dome(k)
    onset = one.steady(0.0).gross_slip_displacement
    u, law = 3.0 * onset, law_of(coefficient_of(one) * 1e8 ** (1.0 - exponent), exponent)
    run = one.over_cycles(Displacement(u), law)
    cycles = run.lasting_cycles
    volume, area = run.volume(cycles), np.pi * run.contact_radius(cycles) ** 2
    # In the end the slip is the displacement less what the surface gives way.
    assert 0.9 < run.rate(cycles) / (area * law.rate(FORCE / area, 4.0 * u)) < 1.0
    # The area grows as the root of the volume, and a wide scar wears faster where the exponent is below 1.
    assert_allclose(run.volume(0.5 * cycles) / volume, 0.5 ** (2.0 / (1.0 + exponent)), atol=0.02)
    assert_allclose(run.contact_radius(cycles), (4.0 * volume * RADIUS / np.pi) ** 0.25, rtol=0.03)
    assert_array_equal(run.stick_radius(cycles), 0.0)
    assert_allclose(run.force_amplitude(cycles), LIMIT, rtol=1e-9)


@compiled
def test_a_power_of_the_pressure_ends_in_the_same_steady_state():
    one, exponent = dome(0.2), np.array([0.3, 0.8, 1.5, 3.0])  # the last one dies out slowly
    pressure = one.steady(0.0).peak_initial_pressure
    run = one.over_cycles(Force(2.0), PressurePower(COEFFICIENT * pressure ** (1.0 - exponent), exponent))
    assert_allclose(run.volume(run.lasting_cycles) / one.steady(2.0).wear_volume, 1.0, atol=ERROR)
    assert run.steady.wear_volume == one.steady(2.0).wear_volume
    early = run.volume(1e4)
    assert abs(early[2] / early[1] - 1.0) > 0.1  # but the way there is another


@compiled
def test_derivatives_are_finite_where_the_first_cell_begins_to_stick():
    """Gross slip turns into partial slip as the contact wears; there they are no better than half."""
    moved = Displacement(3.0 * dome(0.0).steady(0.0).gross_slip_displacement)

    def volume(k):
        return dome(k).over_cycles(moved, COEFFICIENT).volume(4e5)

    by = (volume(0.601) - volume(0.599)) / 2e-3
    assert 0.5 * by > jax.grad(volume)(0.6) > 2.0 * by


@parametrize(
    "k, load, law",
    [
        (-0.3, "rig", COEFFICIENT),
        compiled_case(0.6, "displacement", COEFFICIENT),
        compiled_case(-0.5, "force", COEFFICIENT),  # against rings
        compiled_case(0.6, "force", SAME),
    ],
)
def test_equal_blocks_are_one(k, load, law):
    one, force = dome(k), 0.7 * LIMIT
    if load != "force":
        stiffness = 3e7 if load == "rig" else None
        force = Displacement(one.steady(Force(force, stiffness)).displacement_amplitude, stiffness)
    blocks = one.over_cycles([Block(force, cycles) for cycles in (1e5, 0.0, 4e5)], law)
    whole, cycles = one.over_cycles(force, law), np.array([0.0, 5e4, 1e5, 3e5, 5e5])
    if load == "rig":  # its displacement and that of the contact add up
        moved = whole.displacement_amplitude(cycles) + whole.force_amplitude(cycles) / stiffness
        assert_allclose(moved, force.displacement_amplitude, rtol=1e-6)
    assert_allclose(blocks.volume(cycles), whole.volume(cycles), rtol=0.0, atol=ERROR * whole.volume(5e5))
    for name in ("force_amplitude", "contact_radius", "stick_radius"):
        assert_allclose(getattr(blocks, name)(cycles), getattr(whole, name)(cycles), rtol=ERROR)


@compiled
@parametrize("kind", ["a table under steel", "a cone"])
def test_any_contact_in_a_rig_carries_its_force(kind):
    one, stiffness = KINDS.get(kind) or contact_of(LAYERS, STEEL, Cone(0.01)), 1e7
    onset = one.steady(Force(0.0, stiffness)).gross_slip_displacement
    for times in (0.6, 2.0):
        run = one.over_cycles(Displacement(times * onset, stiffness), COEFFICIENT)
        for cycles in (0.0, 1e4, 1e5):
            # The displacements of rig and contact add up.
            moved = run.displacement_amplitude(cycles) + run.force_amplitude(cycles) / stiffness
            assert_allclose(moved, times * onset, rtol=1e-6)
        cycles = np.array([[1e4], [1e5]])
        force, volume = sums(run, cycles)
        assert_allclose(force, FORCE, rtol=2e-2)
        assert_allclose(volume, run.volume(cycles)[:, 0], rtol=2e-2)


ONE, LAYERED, CYCLES = contact_of(LAW), KINDS["layers under steel"], 1e5
ONSET = float(ONE.steady(0.0).gross_slip_displacement)
HELD, GROSS = Displacement(0.5 * ONSET), Displacement(3.0 * ONSET)
TWO = [Block(HELD, 1e5), Block(2.0, 1e5, normal_force=12.0, friction=0.5)]


# --- what is refused --------------------------------------------------------------------------------------------------


def worn(load, law=COEFFICIENT):
    return ONE.over_cycles(load, law)


NAMED = {"HELD": HELD, "GROSS": GROSS, "TWO": TWO, "MORE": [Block(2.0, 1.0), Block(4.5, 1.0)]}
NAMED |= {"LONG": [Block(HELD, 2e5)], "SAME": SAME, "ARCHARD": Archard}
ASKS = vars(loads) | {"run": worn, "steady": LAYERED.steady}


@cases("wear/refused.toml", "tests")
def test_what_is_no_test_is_refused_before_anything_is_solved(case):
    given = jax.tree.map(lambda x: NAMED.get(x, x), case["given"])
    with pytest.raises((TypeError, ValueError), match=case["line"]):
        getattr(ASKS[case["ask"]](*given), case["read"])(*case["at"])


@compiled
@parametrize(
    "ask, bad",
    [
        (lambda u: worn(Displacement(u)).volume(CYCLES), np.inf),
        (lambda K: worn(HELD, K).volume(CYCLES), -1e-14),
        (lambda F: worn([Block(2.0, 1e5), Block(F, 1e5)]).volume(1.5e5), 4.5),
        (lambda n: worn(TWO).volume(n), 2.1e5),
        (lambda F: worn([Block(2.0, 1e5, normal_force=F)]).volume(CYCLES), -1.0),
        (lambda F: worn(F, SAME).volume(CYCLES), 3.999),
        (lambda r: worn(HELD).pressure(r, CYCLES), np.nan),
        (lambda K: worn(HELD, K).stick_radius(CYCLES), -1e-14),
    ],
)
def test_traced_bad_input_gives_nan(ask, bad):
    assert np.isnan(jax.jit(ask)(bad))


# --- shapes and transforms --------------------------------------------------------------------------------------------


def test_a_power_of_the_pressure_is_that_power():
    assert_allclose(PressurePower(1e-23, 2.0).rate(2e9, 1e-6), 4e-11)


def test_nothing_wears_without_amplitude_or_cycles():
    still = worn(Displacement(0.0))
    assert still.volume(CYCLES) == 0.0 and np.isnan(still.cycles_to(0.5))
    assert_allclose(still.stick_radius(CYCLES), ONE.steady(0.0).contact_radius, rtol=1e-3)
    assert worn([Block(GROSS, 0.0)]).volume(0.0) == 0.0


def test_a_narrow_slip_ring_is_followed_or_refused():
    """Narrower ones would seem to stick, and nothing would wear."""
    force = 1e-3 * LIMIT
    assert_allclose(ONE.over_cycles(force, SAME).volume(1e30), ONE.steady(force).wear_volume, rtol=0.02)
    for load in (Displacement(3e-7 * ONSET), Force(0.1 * force)):
        with pytest.raises(ValueError, match=r"the slip ring is narrower than 0\.0003 contact radii"):
            ONE.over_cycles(load, SAME).volume(CYCLES)


@parametrize("load", [compiled_case(2.0), compiled_case(HELD), GROSS])
def test_nothing_wears_below_the_threshold_of_a_law(load):
    run = worn(load, HIGH)
    cycles = np.array([0.0, 1e5])
    for name in ("volume", "rate"):
        assert_array_equal(getattr(run, name)(cycles), 0.0)
    assert_array_equal(run.depth(0.5 * ONE.steady(0.0).contact_radius, cycles), 0.0)
    assert_allclose(run.contact_radius(cycles), ONE.steady(0.0).contact_radius, rtol=3e-3)
    assert run.lasting_cycles == 0.0 and np.isnan(run.cycles_to(0.5))


@compiled
@parametrize("load", [2.0, HELD, GROSS])
def test_where_nothing_wears_slopes_are_zero(load):
    slope = jax.grad(lambda K: worn(load, WithThreshold(K, HIGH.threshold)).volume(CYCLES))(COEFFICIENT)
    assert slope == 0.0


def test_a_threshold_inside_lets_less_wear():
    peak = ONE.steady(0.0).peak_initial_pressure
    free, some = (worn(GROSS, WithThreshold(COEFFICIENT, share * peak)) for share in (0.0, 0.5))
    # At first: of the ball's p_0 (1 - (r/a)^2)^((1+k)/2) the part above a half, about where all slips as far.
    k = 0.2
    inside = 1.0 - 0.5 ** (2.0 / (1.0 + k))  # of the area
    above = 1.0 - (1.0 - inside) ** ((3.0 + k) / 2.0) - 0.5 * (3.0 + k) / 2.0 * inside
    assert_allclose(some.rate(0.0) / free.rate(0.0), above, rtol=0.05)


def test_beyond_the_widest_scar():
    run = worn(GROSS)
    last = run.lasting_cycles
    assert np.isfinite(run.volume(last))
    for ask in (run.volume, lambda n: run.depth(0.0, n), lambda n: run.contact_radius(np.array([1.0, n]))):
        with pytest.raises(ValueError, match=r"cycles = .* outside .* after which the scar is ten times as wide"):
            ask(1.1 * last)


@compiled
def test_contacts_and_loads_are_batches():
    forces, moved = np.array([[8.0], [10.0]]), ONSET * np.array([0.3, 0.5, 3.0])
    many = contact_of(LAW, force=forces).over_cycles(Displacement(moved), np.array(COEFFICIENT))
    found = many.volume(CYCLES)
    assert found.shape == (2, 3) and many.depth(np.zeros((4, 1, 1)), CYCLES).shape == (4, 2, 3)
    for (i, j), volume in np.ndenumerate(found):
        single = contact_of(LAW, force=forces[i, 0]).over_cycles(Displacement(moved[j]), COEFFICIENT)
        assert_allclose(volume, single.volume(CYCLES), rtol=1e-5)
    mapped = jax.vmap(lambda u: worn(Displacement(u)).volume(CYCLES))(jnp.asarray(moved))
    assert_allclose(mapped, found[1], rtol=1e-5)


@compiled
def test_forty_blocks_are_one_history():
    rising = [Block(Displacement((0.3 + 0.05 * i) * ONSET), 1e4) for i in range(40)]
    run = worn(rising)
    at = 1e4 * np.arange(41)
    volume = run.volume(at)
    assert np.all(np.diff(volume) > 0.0) and np.all(np.isfinite(run.contact_radius(at)))
    # In two parts: what the first 20 blocks leave is what the others find.
    assert_allclose(worn(rising[:20]).volume(2e5), volume[20], rtol=1e-2)


# --- derivatives ------------------------------------------------------------------------------------------------------


def by_exponent(m):
    return worn(GROSS, PressurePower(COEFFICIENT * 1e9 ** (1.0 - m), m))


MOVED = [
    *((lambda u: worn(Displacement(u)), load.displacement_amplitude, 2e-2) for load in (HELD, GROSS)),
    (lambda F: contact_of(LAW, force=F).over_cycles(HELD, COEFFICIENT), FORCE, 2e-2),
    *((by_exponent, m, 6e-2) for m in (0.5, 0.8, 1.3, 1.5)),
    (lambda R: FrettingContact(LAW, R, FORCE, FRICTION).over_cycles(TWO, COEFFICIENT), RADIUS, 2e-2),
    (lambda mu: LAYERED.over_cycles([Block(GROSS, 5e4, friction=mu), Block(HELD, 5e4)], COEFFICIENT), 0.5, 2e-2),
    # The cells move, and the compliance in them changes: the edge of the contact follows both.
    (lambda k: dome(k).over_cycles(Displacement(0.55 * ONSET, 1e8), COEFFICIENT), 0.5, 2e-2),
]


@parametrize("run, at, most", [MOVED[0], *(compiled_case(*x) for x in MOVED[1:])], ids=range(len(MOVED)))
def test_derivatives_are_differences(run, at, most):
    def volume(x):
        return run(x).volume(CYCLES)

    step = at * np.array([0.02, 0.04])  # over which volumes change by far more than they jump when the grid does
    near, far = [(volume(at + h) - volume(at - h)) / (2.0 * h) for h in step]
    assert_allclose(jax.grad(volume)(at), (4.0 * near - far) / 3.0, rtol=most)


@compiled
@parametrize("load", [HELD, GROSS, Displacement(1.01 * ONSET, 1e7)], ids=["held", "gross", "in a rig"])
def test_derivatives_of_all_numbers_and_quantities_are_finite(load):
    """Also at pressures so small that their squares are nothing."""

    def everything(contact, load, law):
        run = contact.over_cycles(load, law)
        cycles = jnp.array([0.0, 1e3, 1e5, 1e7])
        names = "volume", "rate", "contact_radius", "stick_radius", "energy_per_cycle", "force_amplitude"
        return [getattr(run, name)(cycles) for name in names]

    slopes = jax.jit(jax.jacrev(everything, (0, 1, 2)))(ONE, load, Archard(COEFFICIENT))
    for path, slope in jax.tree.leaves_with_path(slopes):
        assert np.all(np.isfinite(slope)), jax.tree_util.keystr(path)


@compiled
@parametrize("load", [HELD, GROSS, Displacement(0.05 * ONSET)], ids=["held", "gross", "a narrow ring"])
def test_single_precision_keeps_three_digits(load):
    double, cycles = (ONE, load, COEFFICIENT), np.array([1e3, 1e5, 1e6])
    single = jax.tree.map(jnp.float32, double)
    one, other = (contact.over_cycles(load, law) for contact, load, law in (single, double))
    volume = one.volume(np.float32(cycles))
    assert volume.dtype == np.float32
    assert_allclose(volume, other.volume(cycles), rtol=1e-3)
    # Which cell touches last is decided by roundings.
    assert_allclose(one.contact_radius(np.float32(cycles)), other.contact_radius(cycles), rtol=1e-3)
    slope = jax.grad(lambda contact, load, law: contact.over_cycles(load, law).volume(1e5))
    for found, known in zip(*(jax.tree.leaves(slope(*each)) for each in (single, double)), strict=True):
        assert_allclose(found, known, rtol=1e-2)
