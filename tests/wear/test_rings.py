"""A constant force over cycles: against rings and the Green's function alone, and in every limit with a closed form."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kinds import COEFFICIENT, LIMIT, STEEL, contact_of, dome
from march_oracle import worn_shares
from marks import compiled, compiled_case, long, long_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from reduced import MANY, Reduced, first_rate, unit_of
from refusals import data

from plgwear_jax import DepthGraded, Elastic, Layered, PowerLawGraded, TruncatedSphere, fretting, loads
from plgwear_jax.steady.state import states_of
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.surfaces.ring import cells_of
from plgwear_jax.wear.closed_ring import curves_of
from plgwear_jax.wear.ring_cells import RESOLUTIONS, MarchResolution, edges_of
from plgwear_jax.wear.ring_curves import share_at
from plgwear_jax.wear.ring_march import _solved, _Step

# The tests of closed forms ask for these shapes, so that they share their programs.
K = np.array([-0.95, -0.5, 0.0, 0.5, 0.95])[:, None]
PHI = np.array([0.01, 0.8, 0.5, 0.3, 0.97])[:, None]
CLOSE = np.array([0.9997, 0.9999, 1.0 - 1e-8, 0.99999, 1.0 - 1e-6])[:, None]  # to gross slip
ERROR = {digits: 10.0**-digits for digits in RESOLUTIONS}  # promised, of the final volume


@functools.cache
def of(amplitudes):
    """(The runs, their final volumes, first rates and units of time)."""
    phi = {"some": PHI, "close": CLOSE}[amplitudes]
    final, rate = fretting.wear_volume(K, phi), first_rate(K, phi)
    return Reduced(K, phi), final, rate, final / rate


def volumes(resolution, k, phi, n):
    """The volumes after n, a last axis, by marches that the library need not offer."""
    curves = curves_of(resolution, jnp.asarray(k), jnp.asarray(phi))
    return np.asarray(curves.final * share_at(curves, n / curves.unit))


@parametrize("amplitudes, early", [("some", 1e-9), ("close", 1e-13)])
def test_it_grows_from_the_closed_rate_to_the_closed_volume(amplitudes, early):
    run, final, first, unit = of(amplitudes)
    times = unit * np.concatenate([[0.0, early], np.geomspace(1e-4, 10.0, 13), [1e3]])
    volume = run.volume(times)
    assert_array_equal(volume[:, 0], 0.0)
    assert_allclose(volume[:, 1], (first * times)[:, 1], rtol=1e-5)
    assert_allclose(run.rate(times)[:, :1], first, rtol=1e-6)
    assert np.all(np.diff(volume, axis=1) >= 0.0) and np.all(volume <= volume[:, -1:])
    assert_allclose(volume[:, -1:], final, rtol=1e-6)  # it is an integral over nodes


def test_the_rate_is_the_slope_of_the_volume():
    run, _, _, unit = of("some")
    times = unit * np.linspace(0.05, 7.0, 16)
    ahead, behind = (run.volume(times * (1.0 + sign * 1e-4)) for sign in (1.0, -1.0))
    rate = run.rate(times)
    assert_allclose((ahead - behind) / (2e-4 * times), rate, rtol=1e-4, atol=1e-5 * rate.max())
    assert np.all(rate >= 0.0)


def test_a_step_of_a_march_has_the_derivatives_of_differences():
    cells = np.arange(5)
    compliance = np.exp(-0.5 * abs(cells[:, None] - cells))
    step = compliance, 0.1 + 0.2 * cells, 1.0 + 0.5 * cells, 0.02 * cells
    along = 0.1 * compliance**2, 0.1 * cells, np.cos(cells), 0.1 * np.sin(cells)

    @jax.jit
    def found(share):
        moved = jax.tree.map(lambda x, change: x + share * change, step, along)
        return _solved(_Step(*moved, jnp.int32(3)), jnp.ones(6))

    assert_allclose(jax.jvp(found, (0.0,), (1.0,))[1], (found(1e-4) - found(-1e-4)) / 2e-4, rtol=1e-5)


# k, phi, parts of the unit of time and the number of rings, which are off by 1e-4 of the final volume.
EARLY, LATER = (0.01, 0.03, 0.1), (0.25, 0.75, 1.5)


@parametrize(
    "k, phi, parts, rings",
    [
        (-0.5, 0.8, LATER, 120),
        # Close to gross slip most is worn early, in steps that at first are short.
        (0.5, float(CLOSE[1, 0]), EARLY, 120),
        *(long_case(k, phi, LATER, 240) for k in (-0.5, 0.0, 0.5) for phi in (0.2, 0.5, 0.8)),
    ],
)
def test_the_volume_is_that_of_rings_and_the_greens_function_alone(k, phi, parts, rings):
    at = np.array(parts) * float(unit_of(k, phi))
    mine = Reduced(np.full((5, 1), k), np.full((5, 1), phi)).volume(np.resize(at, (5, 16)))[0, :3]
    share = mine / fretting.wear_volume(k, phi)
    assert_allclose(share, worn_shares(k, phi, at, rings, 40), atol=2.0 * ERROR[4])
    assert parts is LATER or 0.1 < share[0] < 0.5


def test_closer_than_rounding_tells_it_is_refused():
    for phi in (1.0 - 2.0**-53, 1e-200):
        with pytest.raises(ValueError, match=rf"F_x/\(mu F_N\) = {phi} is so close to 0 or 1"):
            Reduced(K, np.full((5, 1), phi)).volume(np.ones((5, 16)))


@long
def test_digits_are_kept_over_the_whole_domain():
    close = [1.0 - 1e-4, 1.0 - 1e-8]
    k, phi = (x.reshape(-1, 1) for x in np.meshgrid([-0.97, -0.5, 0.2, 0.7, 0.97], [0.005, 0.3, 0.9, 0.98, *close]))
    final = fretting.wear_volume(k, phi)
    at = unit_of(k, phi) * np.append(np.geomspace(1e-3, 8.0, 60), 0.0)
    # Finer than anything that the library offers.
    finest, most = (
        volumes(MarchResolution(12, 32, 7.0, (3, 4, 5, 6)), k, phi, at),
        np.where(phi > 0.99, 2.5, 1.0) * final,
    )
    for digits, resolution in RESOLUTIONS.items():
        assert np.max(abs(volumes(resolution, k, phi, at) - finest) / most) < ERROR[digits], digits


def test_nothing_is_below_what_it_begins_with():
    """Rounding does not take cycles, rates and pressures below 0 either, nor radii below 1."""
    rows = (x.reshape(-1, 5, 1) for x in np.meshgrid([-0.97, -0.6, 0.0, 0.4, 0.97], [0.006, 0.05, 0.5, 0.98]))
    n = np.append(0.0, np.geomspace(1e-12, 1e3, 15))
    for k, phi in zip(*rows, strict=True):
        run = Reduced(k, phi)
        c, a = fretting.stick_radius(k, phi), fretting.worn_radius(k, phi)
        assert np.all(run.n_to(np.append(0.0, np.geomspace(1e-300, 0.5, 4))) >= 0.0)
        assert np.all(run.radius(n) >= 1.0) and np.all(run.rate(n) >= 0.0)
        # To where the contact ends before any wear, and after it.
        for r in (np.ones((5, 1)), np.full((5, 1), 1.0 - 2.0**-53), 0.5 * (1.0 + a), 0.5 * (1.0 + c)):
            assert np.all(run.pressure(r, n) >= 0.0)


def test_the_pressure_has_no_jump_beside_the_stick_radius():
    """Around c, and where what is known next to c begins, as long as all of the ring touches."""
    run, _, _, unit = of("some")
    times, c = unit * np.append(0.0, np.geomspace(1e-6, 0.1, 15)), np.asarray(fretting.stick_radius(K, PHI))
    for places in ([-5e-7, -1e-8, 1e-8, 5e-7], [-1.01e-4, -0.99e-4]):
        around = np.stack([run.pressure(c * (1.0 + y), times) for y in places])
        assert_allclose(around, np.broadcast_to(around[-1], around.shape), rtol=0.15)


def test_what_keeps_cycles_from_falling_below_zero_leaves_their_slopes():
    """After n = 0 the share grows by the first rate, 1/unit, also where rounding, on some processors, goes below 0."""
    pairs = np.array([[-0.97, 0.495], [-0.97, 0.535], [-0.808, 0.899], [-0.889, 0.98], [-0.647, 0.98]])
    k, phi = pairs[:, :1], pairs[:, 1:]
    share = np.zeros((5, 1))
    n, slope = jax.jvp(Reduced(k, phi).n_to, (share,), (np.ones_like(share),))
    assert np.all(n >= 0.0)
    assert_allclose(slope, unit_of(k, phi), rtol=1e-6)


def test_the_rate_goes_on_at_the_last_time_of_the_run():
    """From there on the volume is known by its decay."""
    curves = curves_of(RESOLUTIONS[4], jnp.asarray(0.0), jnp.asarray(0.8))
    beside = np.append(np.finfo(float).eps * np.arange(-3.0, 4.0), 1e-6)
    rate = Reduced(0.0, 0.8).rate(curves.volume.time[-1] * curves.unit * (1.0 + beside))
    assert_allclose(rate[:-1], rate[0], rtol=1e-9)
    assert_allclose(rate[-1], rate[0], rtol=1e-4)


@compiled
def test_float32_keeps_three_digits():
    run, final, _, unit = of("some")
    times = unit * np.concatenate([[0.0, 1e-9], np.linspace(0.05, 5.9, 12), [7.0, 1e3]])
    worn = Reduced(*(x.astype(np.float32) for x in (K, PHI)), digits=3).volume(times.astype(np.float32))
    assert worn.dtype == jnp.float32
    assert np.max(np.abs(np.asarray(worn, float) - run.volume(times)) / final) < 1e-3


INSIDE, BAD, READ, _ = data("wear/points.toml").values()


# The derivatives of the march are in the programs of all of them.
@parametrize("name", [compiled_case(x) if x in ("volume", "pressure") else long_case(x) for x in READ])
def test_traced_values_outside_give_nan_and_gradients_are_finite_inside(name):
    at = ["r", "n"] if READ[name] == "rn" else [READ[name]]
    names = ["k", "phi", *at]
    rows = INSIDE + [INSIDE[0] | {key: value} for key in names for value in BAD[key]]

    columns = [jnp.array([row[key] for row in rows]) for key in names]
    read = jax.value_and_grad(lambda k, phi, *at: getattr(Reduced(k, phi, 2), name)(*at), tuple(range(len(names))))
    value, slopes = jax.vmap(read)(*columns)
    slopes, inside = np.stack(slopes, -1), len(INSIDE)
    assert np.all(np.isnan(value[inside:])) and np.all(np.isnan(slopes[inside:]))
    finite = np.isfinite(value[:inside])
    # Nothing wears at phi = 0, so that no number of cycles wears a share of it.
    assert np.all(finite | ((name == "n_to") & (np.arange(inside) == 2)))
    assert np.all(np.isfinite(slopes[:inside][finite]))


@compiled
def test_slopes_at_the_stick_radius_are_finite():
    run = Reduced(0.3, 0.4, 2).run
    c = run.stick_radius(0.0)
    for read in (run.pressure, run.depth):
        assert np.isfinite(jax.jvp(lambda r: read(r, MANY), (c,), (1.0,))[1])  # noqa: B023
    assert_allclose(run.pressure(c, MANY), run.pressure(np.nextafter(c, 1.0), MANY), rtol=1e-6)


# --- without closed forms ---------------------------------------------------------------------------------------------


@compiled
@parametrize("phi", [0.3, 0.9])
def test_the_ring_answers_to_its_first_pressure_next_to_the_stick_edge(phi):
    """The cells of A p_0 = H: in too coarse cells inside c the ones next to c would have pressures of any size."""
    one = dome(-0.8, STEEL)
    steps, effort = RESOLUTIONS[5], effort_of(None)
    state = states_of(one, phi * LIMIT, effort)

    @jax.jit
    def ring(state):
        from_c, from_1 = edges_of(*state.widths, steps)
        return cells_of(state, from_c[0], from_1[0])

    cells, count = ring(state), steps.inner * steps.refinements[0]
    edges = edges_of(*state.widths, steps)[0][0, : count // 2 + 1]
    pressure = one.steady(0.0).initial_pressure(state.c * np.sqrt(1.0 + 0.5 * (edges[1:] + edges[:-1])))
    assert_allclose(cells.first[: count // 2] / pressure, 1.0, rtol=0.04)


@compiled
@parametrize("r", [3e-5, 6.7e-5])
def test_slopes_of_the_pressure_over_cycles_are_differences(r):
    def pressure(modulus):
        one = contact_of(Layered([2e-5], jnp.stack([modulus, jnp.asarray(110e9)]), 0.3), STEEL)
        return one.over_cycles(2.0, COEFFICIENT, digits=2).pressure(r, 1e5)

    assert_allclose(jax.grad(pressure)(200e9), (pressure(201e9) - pressure(199e9)) / 2e9, rtol=1e-4)


@compiled
@parametrize("body", ["layers", "a power law"])
def test_narrow_rings_beside_a_flat_face_wear_to_their_steady_state(body):
    """The modes have no pressure beside a kink: where that gave no wear in the first cycle, all was NaN."""
    grid = np.meshgrid(np.array([3.0, 4.5, 6.0, 8.0, 10.0]) * 1e-5, [0.02, 0.035, 0.05], indexing="ij")
    flat, phi = (x.ravel() for x in grid)
    bodies = {
        "layers": Layered([2e-6, 3e-6], [400e9, 200e9, 110e9], 0.3),
        "a power law": PowerLawGraded(110e9, 1e-4, np.linspace(-0.4, 0.5, flat.size), 0.3),
    }
    force = LIMIT * (phi if body == "layers" else 8.0 * phi)
    one = contact_of(bodies[body], STEEL, TruncatedSphere(flat))
    run, steady = one.over_cycles(force, COEFFICIENT), one.steady(force).wear_volume
    assert_allclose(run.volume(np.full_like(flat, 1e15)), steady, rtol=1e-6)
    assert np.all(np.diff(run.volume(np.array([0.0, 1e4, 1e6, 1e8])[:, None]), axis=0) > 0.0)


@compiled
def test_a_stiff_depth_between_compliant_ones():
    """The final depth at the outer edge is below zero by what the modes lose; two runs beside a march."""
    table = DepthGraded([1e-6, 2e-5, 2e-4], [[60e9, 180e9, 60e9], [60e9, 200e9, 60e9]], 0.3)
    stiff, cycles = contact_of(table, None), np.array([[1e3], [4e5], [1e7]])
    volume = stiff.over_cycles(1.0, COEFFICIENT).volume(cycles)
    marched = stiff.over_cycles([loads.Block(1.0, 2e7)], COEFFICIENT).volume(cycles)
    assert_allclose(volume, marched, rtol=0.015)


def test_a_layer_too_thin_to_matter_leaves_the_ring_as_it_was():
    """Its kernel is narrower than the distance of the nodes of any cell."""
    coated, bare = (contact_of(each, None) for each in (Layered([4e-9], [200e9, 110e9], 0.3), Elastic(110e9, 0.3)))
    cycles = np.array([1e5, 1e6, 1e7])
    volumes = [one.over_cycles(2.0, COEFFICIENT).volume(cycles) for one in (coated, bare)]
    assert_allclose(*volumes, rtol=2e-3)
