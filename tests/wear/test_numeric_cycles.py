"""Wear over cycles of contacts without a closed form, against rings; what else they promise is in `test_contract`."""

import json
from pathlib import Path

import jax
import numpy as np
import pytest
import surface_oracle
import transient_oracle
from half_spaces import A, layers_under_steel
from kinds import COEFFICIENT, FORCE, FRICTION, STEEL, contact_of
from typer.testing import CliRunner

from plgwear_jax import DepthGraded, FrettingContact, Layered, PowerLawGraded, TruncatedSphere, cli, loads, material
from plgwear_jax.loads import Displacement
from plgwear_jax.steady.state import states_of
from plgwear_jax.surfaces.effort import effort_of
from plgwear_jax.wear.numeric_ring import cells_at, widths
from plgwear_jax.wear.ring_cells import RESOLUTIONS, edges_of


def as_rings(compliance, coating, rings, most):
    """The library against rings at three times, which are known to an extrapolation of their steps."""
    share = 0.6
    steady = surface_oracle.steady(compliance, A, share * A)
    one = FrettingContact(coating, 1.0, steady.force, 0.5, STEEL)
    F_x = 0.5 * steady.force * steady.phi
    cycles = np.asarray(one.over_cycles(F_x, COEFFICIENT).cycles_to([0.15, 0.45, 0.75]))
    mu_theta = float(one.steady(0.0).gross_slip_displacement / one.steady(0.0).penetration)
    n = 4.0 * COEFFICIENT * mu_theta * steady.force / (np.pi * A**2) * cycles
    volumes = transient_oracle.volumes_at(surface_oracle.Wearing(compliance, A, share * A, steady, rings), n, 5)
    np.testing.assert_allclose(A**4 * volumes / steady.volume, [0.15, 0.45, 0.75], atol=most)


@pytest.mark.compiled
def test_layers_under_steel_wear_as_rings():
    coating, compliance = layers_under_steel()
    as_rings(compliance, coating, 40, 3e-4)


@pytest.mark.long
@pytest.mark.parametrize("k", [-0.8, -0.4, 0.4])
def test_a_power_law_under_steel_wears_as_rings(k):
    g = surface_oracle.power_compliance(110e9, 1e-4, k, float(material.h_N(k, 0.3)), 0.3)
    compliance = surface_oracle.Compliance([(g, k), (2.0 * (1.0 - 0.3**2) / 210e9, 0.0)])
    as_rings(compliance, PowerLawGraded(110e9, 1e-4, k, 0.3), 80, 5e-4)


@pytest.mark.long
def test_layers_wear_as_rings_at_a_held_displacement():
    layers, compliance = layers_under_steel()
    steady = surface_oracle.steady(compliance, A, 0.6 * A)
    one = FrettingContact(layers, 1.0, steady.force, 0.5, STEEL)
    F_x = 0.5 * steady.force * steady.phi
    mu_theta = float(one.steady(0.0).gross_slip_displacement / one.steady(0.0).penetration)
    last = float(one.over_cycles(F_x, COEFFICIENT).cycles_to(0.999))
    cycles = last * np.expm1(4.0 * np.linspace(0.0, 1.0, 161)) / np.expm1(4.0)
    n = 4.0 * COEFFICIENT * mu_theta * steady.force / (np.pi * A**2) * cycles
    moved = float(one.steady(F_x).displacement_amplitude) / mu_theta / A**2
    first = float(one.steady(0.0).penetration) / A**2
    rings = surface_oracle.Wearing(compliance, A, 0.6 * A, steady, 120)
    worn, _ = transient_oracle.rings_at_held_displacement(rings, first, moved, n)
    at = slice(20, None, 20)
    held = Displacement(one.steady(F_x).displacement_amplitude)
    found = np.asarray(one.over_cycles(held, COEFFICIENT).volume(cycles[at]))
    np.testing.assert_allclose(found / steady.volume, A**4 * worn[at] / steady.volume, atol=1.6e-2)
    assert found[-1] < 0.99 * steady.volume


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
    flat, phi = (
        x.ravel() for x in np.meshgrid(np.array([3.0, 4.5, 6.0, 8.0, 10.0]) * 1e-5, [0.02, 0.035, 0.05], indexing="ij")
    )
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


@pytest.mark.long
def test_the_command_wear_takes_layers_and_an_elastic_indenter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    text = """
material = { thickness = [2e-6, 3e-6], modulus = [400e9, 200e9, 110e9], nu = 0.3 }
contact = { kind = "fretting", radius = 0.005, normal_force = 10.0, friction = 0.4, indenter = { E = 210e9, nu = 0.3 } }
wear = { coefficient = 1e-14, cycles = 5e5 }
"""
    Path("mine.toml").write_text(text + "load = { tangential_force = 2.0 }\n")
    result = CliRunner().invoke(cli.app, ["wear", "mine.toml", "--json", "--picture", "course.png"])
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    layers = Layered([2e-6, 3e-6], [400e9, 200e9, 110e9], 0.3)
    one = contact_of(layers, STEEL)
    volume = one.over_cycles(2.0, COEFFICIENT).volume(told["life"])
    at = told["cycles"].index(told["life"])
    assert told["volume"][at] == pytest.approx(float(volume), rel=1e-6) and Path("course.png").exists()
    Path("mine.toml").write_text(text + "load = { displacement = 3e-7, rig_stiffness = 1e7 }\n")
    result = CliRunner().invoke(cli.app, ["wear", "mine.toml", "--json"])
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    held = Displacement(3e-7, 1e7)
    assert told["tangential_force"] == pytest.approx(float(one.steady(held).tangential_force), rel=1e-6)
    run = one.over_cycles(held, COEFFICIENT)
    whole = float(run.volume(told["life"]))
    assert told["volume"][told["cycles"].index(told["life"])] == pytest.approx(whole, rel=1e-4)
    N = float(run.cycles_to(volume=0.5 * whole))
    Path("measured.csv").write_text(f"cycles,volume\n{N},{0.5 * whole}\n{told['life']},{whole}\n")
    result = CliRunner().invoke(cli.app, ["wear", "mine.toml", "--fit", "measured.csv", "--json"])
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["wear_coefficient"] == pytest.approx(COEFFICIENT, rel=1e-2)
    Path("blocks.csv").write_text("tangential_force,cycles\n1.0,1e5\n2.0,1e5\n")
    Path("mine.toml").write_text(text + 'load = { history = "blocks.csv" }\n')
    result = CliRunner().invoke(cli.app, ["wear", "mine.toml", "--json"])
    assert result.exit_code == 0, result.stderr
    blocks = one.over_cycles([loads.Block(1.0, 1e5), loads.Block(2.0, 1e5)], COEFFICIENT)
    volume = blocks.volume(np.array([1e5, 2e5]))
    assert json.loads(result.stdout)["volume"] == pytest.approx(volume.tolist(), rel=1e-6)
