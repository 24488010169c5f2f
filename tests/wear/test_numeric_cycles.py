"""Wear over cycles of contacts without a closed form in places of their own; rings and promises are in `contact`."""

import jax
import numpy as np
import pytest
from kinds import COEFFICIENT, FORCE, FRICTION, STEEL, contact_of

from plgwear_jax import DepthGraded, Layered, PowerLawGraded, TruncatedSphere, loads
from plgwear_jax.steady.state import states_of
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.wear.numeric_ring import cells_at, widths
from plgwear_jax.wear.ring_cells import RESOLUTIONS, edges_of


@pytest.mark.compiled
@pytest.mark.parametrize("phi", [0.3, 0.9])
def test_the_ring_answers_to_its_first_pressure_next_to_the_stick_edge(phi):
    """The cells of A p_0 = H: in too coarse cells inside c the ones next to c would have pressures of any size."""
    one = contact_of(PowerLawGraded(110e9, 1e-4, -0.8, 0.3), STEEL)
    steps, effort = RESOLUTIONS[5], effort_of(None)
    state = states_of(one, phi * FRICTION * FORCE, effort)

    @jax.jit
    def ring(state):
        from_c, from_1 = edges_of(*widths(state), steps)
        return cells_at(effort, state, (from_c[0], from_1[0]))

    cells, count = ring(state), steps.inner * steps.refinements[0]
    edges = np.asarray(edges_of(*widths(state), steps)[0])[0, : count // 2 + 1]
    middle = float(state.c) * np.sqrt(1.0 + 0.5 * (edges[1:] + edges[:-1]))
    pressure = one.steady(0.0).initial_pressure(middle)
    np.testing.assert_allclose(np.asarray(cells.first)[: count // 2] / pressure, 1.0, rtol=0.04)


@pytest.mark.compiled
@pytest.mark.parametrize("body", ["layers", "a power law"])
def test_narrow_rings_beside_a_flat_face_wear_to_their_steady_state(body):
    """The modes have no pressure beside a kink: where that gave no wear in the first cycle, all was NaN."""
    grid = np.meshgrid(np.array([3.0, 4.5, 6.0, 8.0, 10.0]) * 1e-5, [0.02, 0.035, 0.05], indexing="ij")
    flat, phi = (x.ravel() for x in grid)
    bodies = {
        "layers": Layered([2e-6, 3e-6], [400e9, 200e9, 110e9], 0.3),
        "a power law": PowerLawGraded(110e9, 1e-4, np.linspace(-0.4, 0.5, flat.size), 0.3),
    }
    force = FRICTION * FORCE * (phi if body == "layers" else 8.0 * phi)
    one = contact_of(bodies[body], STEEL, TruncatedSphere(flat))
    run, steady = one.over_cycles(force, COEFFICIENT), one.steady(force).wear_volume
    np.testing.assert_allclose(run.volume(np.full_like(flat, 1e15)), steady, rtol=1e-6)
    assert np.all(np.diff(run.volume(np.array([0.0, 1e4, 1e6, 1e8])[:, None]), axis=0) > 0.0)


@pytest.mark.compiled
def test_a_stiff_depth_between_compliant_ones():
    """The final depth at the outer edge is below zero by what the modes lose; two runs beside a march."""
    table = DepthGraded([1e-6, 2e-5, 2e-4], [[60e9, 180e9, 60e9], [60e9, 200e9, 60e9]], 0.3)
    stiff, cycles = contact_of(table, None), np.array([[1e3], [4e5], [1e7]])
    volume = stiff.over_cycles(1.0, COEFFICIENT).volume(cycles)
    marched = stiff.over_cycles([loads.Block(1.0, 2e7)], COEFFICIENT).volume(cycles)
    np.testing.assert_allclose(volume, marched, rtol=0.015)
