"""What a run of any test promises as an object: shapes, derivatives, and what it refuses."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kinds import COEFFICIENT, FORCE, FRICTION, KINDS, LAW, RADIUS, contact_of

from plgwear_jax import FrettingContact
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.wear_laws import Archard, PressurePower, WearLaw

compiled = pytest.mark.compiled
ONE, CYCLES = contact_of(LAW), 1e5
ONSET = float(ONE.steady(0.0).gross_slip_displacement)
HELD, GROSS = Displacement(0.5 * ONSET), Displacement(3.0 * ONSET)
SAME = PressurePower(COEFFICIENT, 1.0)  # Archard's law, which only the march does not know
WIDEST = r"cycles = .* outside .* after which the scar is ten times as wide"
TWO = [Block(HELD, 1e5), Block(2.0, 1e5, normal_force=12.0, friction=0.5)]


# --- refusals ---------------------------------------------------------------------------------------------------------


def worn(load, law=COEFFICIENT):
    return ONE.over_cycles(load, law)


@pytest.mark.parametrize(
    "ask, told",
    [
        (lambda: worn(["2.0"]), r"a list of Block\(load, cycles\), not of '2.0'"),
        (lambda: worn("x"), "tangential_force takes real numbers"),
        (lambda: Block("x", 1e5), "tangential_force takes real numbers"),
        (lambda: Block(-1.0, 1e5), "tangential_force = -1.0 is outside"),
        (lambda: Block(HELD, -1.0), "cycles = -1.0 is outside"),
        (lambda: Block(HELD, 1e5, normal_force=-1.0), "normal_force = -1.0 is outside"),
        (lambda: Block(HELD, 1e5, friction=0.0), "friction = 0.0 is outside"),
        *(
            (lambda law=law: worn(HELD, law), "law takes a wear coefficient K in 1/Pa or an instance")
            for law in ("x", None, Archard, lambda p, s: p * s)
        ),
        (lambda: worn(HELD, -1.0), "wear_coefficient = -1.0 is outside"),
        (lambda: worn([Block(2.0, 1.0), Block(4.5, 1.0)]), "block 2: .* the slip is gross"),
        (lambda: worn([Block(2.0, 1.0, friction=0.1)]), "block 1: .* the slip is gross"),
        (lambda: worn(Force(4.5), SAME), "the slip is gross"),
        (lambda: worn(3.999, SAME), "= 0.99975 is outside .* <= 0.995 under"),
        (lambda: Displacement(np.inf), "displacement_amplitude = inf is outside .* >= 0 and finite"),
        (lambda: worn(TWO).volume(2.1e5), "cycles = 210000.0 is outside .* where the blocks end"),
        (lambda: worn(TWO).depth(0.0, 2.1e5), "where the blocks end"),
        (lambda: worn(HELD).volume(-1.0), "cycles = -1.0 is outside"),
        (lambda: worn(HELD).pressure(-1.0, 0.0), "r = -1.0 is outside"),
        (lambda: worn(HELD).cycles_to(1.0), "share = 1.0 is outside"),
        # The first question, before the run is solved.
        (lambda: worn(GROSS).deepest_wear(1e30), WIDEST),
    ],
)
def test_what_is_no_test_is_refused_before_anything_is_solved(ask, told):
    with pytest.raises((TypeError, ValueError), match=told):
        ask()


@compiled
@pytest.mark.parametrize(
    "ask, bad",
    [
        (lambda u: worn(Displacement(u)).volume(CYCLES), -1e-7),
        (lambda u: worn(Displacement(u)).volume(CYCLES), np.inf),
        (lambda K: worn(HELD, K).volume(CYCLES), -1e-14),
        (lambda F: worn([Block(2.0, 1e5), Block(F, 1e5)]).volume(1.5e5), 4.5),
        (lambda n: worn(TWO).volume(n), 2.1e5),
        (lambda F: worn([Block(2.0, 1e5, normal_force=F)]).volume(CYCLES), -1.0),
        (lambda F: worn(F, SAME).volume(CYCLES), 3.999),
        (lambda r: worn(HELD).depth(r, CYCLES), -1e-5),
        (lambda r: worn(HELD).pressure(r, CYCLES), np.nan),
    ],
)
def test_traced_bad_input_gives_nan(ask, bad):
    assert np.isnan(jax.jit(ask)(bad))


# --- shapes and transforms --------------------------------------------------------------------------------------------


def test_nothing_wears_without_amplitude_or_cycles():
    still = worn(Displacement(0.0))
    assert still.volume(CYCLES) == 0.0 and np.isnan(still.cycles_to(0.5))
    np.testing.assert_allclose(still.stick_radius(CYCLES), ONE.steady(0.0).contact_radius, rtol=1e-3)
    none = worn([Block(GROSS, 0.0)])
    assert none.volume(0.0) == 0.0


def test_a_ring_narrower_than_the_cells_is_refused():
    """It would seem to stick, and nothing would wear."""
    with pytest.raises(ValueError, match="the ring that slips is narrower than a cell"):
        worn(Displacement(3e-7 * ONSET)).volume(CYCLES)


class WithThreshold(WearLaw):
    coefficient: float
    threshold: float

    def rate(self, pressure, slip):
        return self.coefficient * jnp.maximum(pressure - self.threshold, 0.0) * slip


HIGH = WithThreshold(COEFFICIENT, 2e9)  # twice the largest pressure


@pytest.mark.parametrize("load", [pytest.param(2.0, marks=compiled), pytest.param(HELD, marks=compiled), GROSS])
def test_nothing_wears_below_the_threshold_of_a_law(load):
    run = worn(load, HIGH)
    cycles = np.array([0.0, 1e5])
    for name in ("volume", "rate"):
        np.testing.assert_array_equal(getattr(run, name)(cycles), 0.0)
    np.testing.assert_array_equal(run.depth(0.5 * ONE.steady(0.0).contact_radius, cycles), 0.0)
    np.testing.assert_allclose(run.contact_radius(cycles), ONE.steady(0.0).contact_radius, rtol=3e-3)
    assert run.lasting_cycles == 0.0 and np.isnan(run.cycles_to(0.5))


@compiled
@pytest.mark.parametrize("load", [2.0, HELD, GROSS])
def test_where_nothing_wears_slopes_are_zero(load):
    slope = jax.grad(lambda K: worn(load, WithThreshold(K, HIGH.threshold)).volume(CYCLES))(COEFFICIENT)
    assert slope == 0.0


def test_a_threshold_inside_lets_less_wear():
    peak = float(ONE.steady(0.0).peak_initial_pressure)
    free, some = (worn(GROSS, WithThreshold(COEFFICIENT, share * peak)) for share in (0.0, 0.5))
    # At first: of the ball's p_0 (1 - (r/a)^2)^((1+k)/2) the part above a half, about where all slips as far.
    k = 0.2
    inside = 1.0 - 0.5 ** (2.0 / (1.0 + k))  # of the area
    above = 1.0 - (1.0 - inside) ** ((3.0 + k) / 2.0) - 0.5 * (3.0 + k) / 2.0 * inside
    np.testing.assert_allclose(some.rate(0.0) / free.rate(0.0), above, rtol=0.05)


def test_beyond_the_widest_scar():
    run = worn(GROSS)
    last = run.lasting_cycles
    assert np.isfinite(run.volume(last))
    for ask in (run.volume, lambda n: run.depth(0.0, n), lambda n: run.contact_radius(np.array([1.0, n]))):
        with pytest.raises(ValueError, match=WIDEST):
            ask(1.1 * last)


@compiled
def test_contacts_and_loads_are_batches():
    forces, moved = np.array([[8.0], [10.0]]), ONSET * np.array([0.3, 0.5, 3.0])
    many = contact_of(LAW, force=forces).over_cycles(Displacement(moved), np.array(COEFFICIENT))
    found = many.volume(CYCLES)
    assert found.shape == (2, 3) and many.depth(np.zeros((4, 1, 1)), CYCLES).shape == (4, 2, 3)
    for (i, j), volume in np.ndenumerate(found):
        single = contact_of(LAW, force=forces[i, 0]).over_cycles(Displacement(moved[j]), COEFFICIENT)
        np.testing.assert_allclose(volume, single.volume(CYCLES), rtol=1e-5)
    mapped = jax.vmap(lambda u: worn(Displacement(u)).volume(CYCLES))(jnp.asarray(moved))
    np.testing.assert_allclose(mapped, found[1], rtol=1e-5)
    blocks = [Block(Displacement(moved), 1e5, normal_force=forces), Block(1.0, 1e4)]
    assert worn(blocks).volume(1.05e5).shape == (2, 3)


@compiled
def test_forty_blocks_are_one_history():
    rising = [Block(Displacement((0.3 + 0.05 * i) * ONSET), 1e4) for i in range(40)]
    run = worn(rising)
    at = 1e4 * np.arange(41)
    volume = np.asarray(run.volume(at))
    assert np.all(np.diff(volume) > 0.0) and np.all(np.isfinite(run.contact_radius(at)))
    # In two parts: what the first 20 blocks leave is what the others find.
    np.testing.assert_allclose(worn(rising[:20]).volume(2e5), volume[20], rtol=1e-2)
    same = worn([Block(HELD, 1e4) for _ in range(40)])
    np.testing.assert_allclose(same.volume(4e5), worn(HELD).volume(4e5), rtol=1e-2)


# --- derivatives ------------------------------------------------------------------------------------------------------


def by_exponent(m):
    return worn(GROSS, PressurePower(COEFFICIENT * 1e9 ** (1.0 - m), m))


def by_radius(R):
    return FrettingContact(LAW, R, FORCE, FRICTION).over_cycles(TWO, COEFFICIENT)


def by_friction(mu):
    return KINDS["layers under steel"].over_cycles([Block(GROSS, 5e4, friction=mu), Block(HELD, 5e4)], COEFFICIENT)


MOVED = [
    (lambda u: worn(Displacement(u)), HELD.displacement_amplitude, 2e-2),
    (lambda u: worn(Displacement(u)), GROSS.displacement_amplitude, 2e-2),
    (lambda F: contact_of(LAW, force=F).over_cycles(HELD, COEFFICIENT), FORCE, 2e-2),
    *((by_exponent, m, 6e-2) for m in (0.8, 1.3, 1.5)),
    (by_radius, RADIUS, 2e-2),
    (by_friction, 0.5, 2e-2),
]


@pytest.mark.parametrize(
    "run, at, most", [MOVED[0], *(pytest.param(*x, marks=compiled) for x in MOVED[1:])], ids=range(len(MOVED))
)
def test_derivatives_are_differences(run, at, most):
    def volume(x):
        return run(x).volume(CYCLES)

    step = at * np.array([0.02, 0.04])  # over which volumes change by far more than they jump when the grid does
    near, far = [(volume(at + h) - volume(at - h)) / (2.0 * h) for h in step]
    np.testing.assert_allclose(jax.grad(volume)(at), (4.0 * near - far) / 3.0, rtol=most)


@compiled
@pytest.mark.parametrize("load", [HELD, GROSS, Displacement(1.01 * ONSET, 1e7)], ids=["held", "gross", "in a rig"])
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
@pytest.mark.parametrize("load", [HELD, GROSS], ids=["held", "gross"])
def test_single_precision_keeps_two_digits(load):
    double, cycles = (ONE, load, COEFFICIENT), np.array([1e3, 1e5, 1e6])
    single = jax.tree.map(jnp.float32, double)
    one, other = (contact.over_cycles(load, law) for contact, load, law in (single, double))
    volume = one.volume(np.float32(cycles))
    assert volume.dtype == np.float32
    np.testing.assert_allclose(volume, other.volume(cycles), rtol=1.5e-2)
    np.testing.assert_allclose(one.contact_radius(np.float32(cycles)), other.contact_radius(cycles), rtol=2e-3)
