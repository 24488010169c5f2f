"""Power laws fitted to measured moduli, free gradients, and the commands that show them."""

import dataclasses
import math
import types
from pathlib import Path

import numpy as np
import pytest
from commands import plgwear, refused, told
from marks import long, parametrize
from numpy.testing import assert_allclose
from refusals import cases, data, is_told

from plgwear_jax import DepthGraded, FrettingContact, PowerLawGraded, coating, optimise, scene
from plgwear_jax._core.units import written
from plgwear_jax.cli.report import Report
from plgwear_jax.optimise import evaluation

RADIUS = 7e-5
SCENE = """# a connector
[material]     # today
E0 = 110e9
z0 = 1e-4
k = 0.0
nu = 0.3

# how it is pressed
[contact]
kind = "fretting"
radius = 5e-3
normal_force = 10.0
friction = 0.4
indenter = { E = 410e9, nu = 0.28 }

[load]
tangential_force = 0.4
"""
CSV = "depth (um),modulus (GPa)\n0,250\n2,240\n5,225\n10,190\n20,165\n40,140\n80,120\n200,110\n"


def power_law(depth, k):
    return 150e9 * (depth / 2e-5) ** k


# --- the fit --------------------------------------------------------------------------------------------------------


@parametrize("k", [-0.7, 0.0, 0.4])
def test_a_power_law_is_found_again(k):
    depth = RADIUS * np.array([0.004, 0.07, 0.2, 0.9, 1.5, 8.0])
    found = coating.fit_power_law(depth, power_law(depth, k), 0.3, RADIUS)
    assert_allclose(found.material.k, k, atol=1e-12)
    assert_allclose(found.material.E0, power_law(np.array(RADIUS), k), rtol=1e-12)
    assert_allclose(found.fitted, found.modulus, rtol=1e-12)
    assert found.material.z0 == RADIUS and found.scatter < 1e-10 and found.doubt is None
    assert_allclose([found.weight.sum(), found.covered], 1.0, rtol=1e-12)
    assert np.all(found.weight[[1, 2, 3, 4]] > 0.0) and found.weight[0] == 0.0


def test_the_confidence_is_that_of_a_linear_fit_whose_points_scatter_alike():
    from scipy import stats

    depth, noise = RADIUS * np.array([0.1, 0.25, 0.9, 1.5, 3.0]), np.array([0.1, -0.05, -0.08, 0.06, 0.02])

    def fitted(noise):
        found = coating.fit_power_law(depth, power_law(depth, 0.2) * np.exp(noise), 0.3, RADIUS)
        return found, np.array([found.material.k, math.log(found.material.E0)])

    (found, best), (_, without) = fitted(noise), fitted(0.0)
    slopes = np.stack([fitted(one)[1] - without for one in np.eye(5)], -1)
    assert_allclose(found.covariance, found.scatter**2 * slopes @ slopes.T, rtol=1e-6)
    left = np.eye(5) - np.vander(np.log(depth / RADIUS), 2) @ slopes  # of the scatter about the fit
    expected = (found.weight @ (left @ noise) ** 2) / (found.weight @ np.sum(left**2, -1))
    assert_allclose(found.scatter**2, expected, rtol=1e-6)
    reach = stats.t(3).ppf(0.975) * np.sqrt(np.diag(found.covariance))
    ends = np.stack([found.exponent_interval, np.log(found.modulus_interval)], -1)
    assert_allclose(ends, [best - reach, best + reach], rtol=1e-9)
    edges = np.concatenate([depth[:1], np.sqrt(depth[1:] * depth[:-1]), depth[-1:]]) / RADIUS
    shares = np.diff(coating.felt(edges, 0.3))  # of the stiffness
    assert_allclose(found.weight, shares / shares.sum(), rtol=1e-12)


def test_each_decade_counts_by_what_its_moduli_change(monkeypatch):
    # Each of three depths a step, six steps a decade, changes as much.
    monkeypatch.setattr(coating, "_slopes_by_depth", lambda contact, force, depth, hats: hats.sum(1) / 18.0)
    depth, counts = coating.where_it_counts(MEASURED, 0.4, RADIUS)
    assert_allclose(depth, RADIUS * np.geomspace(0.01, 10.0, 19), rtol=1e-12)
    assert_allclose(counts, 1.0, rtol=1e-12)


def test_it_does_not_matter_how_densely_the_table_is_written():
    def fitted(depth):
        return coating.fit_power_law(depth, 100e9 + 50e9 * depth / (depth + RADIUS), 0.3, RADIUS).material.k

    even = RADIUS * np.geomspace(0.05, 5.0, 400)
    denser = np.sort(np.concatenate([even, RADIUS * np.geomspace(0.2, 0.4, 4000)]))
    assert_allclose(fitted(denser), fitted(even), atol=1e-3)


@cases("fitting/refused.toml", "power_laws")
def test_doubts_and_refusals(case):
    depth, modulus = RADIUS * np.array(case["depth"]), 1e11 * np.array(case["modulus"])
    if "doubt" in case:
        assert case["doubt"] in coating.fit_power_law(depth, modulus, 0.3, RADIUS).doubt
    else:
        with pytest.raises(ValueError, match=case["line"]):
            coating.fit_power_law(depth, modulus, 0.3, RADIUS)


def test_what_is_felt_goes_from_none_to_all():
    shares = coating.felt(np.array([0.0, 1e-3, 0.5, 2.0, 1e4]), 0.3)
    assert shares[0] == 0.0 and np.all(np.diff(shares) > 0.0) and abs(shares[-1] - 1.0) < 1e-4


@cases("fitting/refused.toml", "numbers")
def test_numbers_outside_their_ranges_are_refused(case):
    named = {"CONTACT": CONTACT, "MEASURED": MEASURED, "LAW": CONTACT.material}
    with pytest.raises(ValueError, match=case["line"]):
        getattr(coating, case["ask"])(*(named.get(x, x) for x in case["given"]))


# --- free gradients -------------------------------------------------------------------------------------------------

AT = RADIUS * np.array([0.03, 0.1, 0.3, 1.0, 4.0])
PROFILE = optimise.ModulusProfile(AT, np.full(5, 50e9), np.full(5, 200e9))
CONTACT = FrettingContact(PowerLawGraded(100e9, 1e-4, 0.0, 0.3), 5e-3, 10.0, 0.4)
MEASURED = dataclasses.replace(CONTACT, material=DepthGraded([0.0, 1e-4], [1e11, 2e11], 0.3))


BY_RADIUS = -np.array([0.02, 0.05, 0.1, 0.1, 0.05])  # the slopes of log(contact radius) by those of the moduli


@pytest.fixture
def pretended(monkeypatch):
    """Wear and contact radius in closed form: stiff is good at the surface, and bad below it."""
    wear = np.array([-0.3, -0.1, 0.4, 0.1, 0.1])

    def solved(self, points, shared):
        x = np.log(points) - math.log(100e9)
        bent = 0.2 * (x[:, 1] + 0.2) ** 2
        slopes = np.stack([np.stack([wear, BY_RADIUS])] * len(x))
        slopes[:, 0, 1] += 0.4 * (x[:, 1] + 0.2)
        allowed = np.array([math.log(RADIUS / one.value) for one in self.question.limits])
        limits = [allowed + (BY_RADIUS @ one) for one in x]
        slopes = np.concatenate([slopes[:, :1], np.repeat(slopes[:, 1:], allowed.size, axis=1)], axis=1)
        values = np.concatenate([(x @ wear + bent - np.log(shared.scale))[:, None], limits], axis=1)
        return evaluation.Evaluation(np.concatenate([values[..., None], slopes], axis=-1), {}, (), ())

    monkeypatch.setattr(evaluation.Evaluator, "_solved", solved)
    read = types.SimpleNamespace(contact_radius=RADIUS, wear_volume=np.ones(1), deepest_wear=1e-6)
    monkeypatch.setattr(FrettingContact, "steady", lambda *args, **options: read)


@pytest.mark.usefixtures("pretended")
def test_a_free_gradient_lies_on_its_bounds():
    found = optimise.free_design(CONTACT, 0.4, PROFILE)
    assert found.at_bound == ("upper", None, "lower", "lower", "lower")
    assert_allclose(found.modulus[1], 100e9 * math.exp(0.25 - 0.2), rtol=1e-3)
    assert found.converged and found.certified and found.minima[0].starts == 20
    assert isinstance(found.contact.material, DepthGraded) and found.reference is CONTACT
    lines = repr(found).splitlines()
    assert lines[0] == "FreeDesign:" and lines[1].endswith(f"{100.0 * found.saving:.3g} % less than the reference")
    assert lines[2] == f"  modulus at {written(AT[0], 'm')} = 200 GPa, between 50 GPa and 200 GPa, at the upper bound"
    assert lines[3].endswith(f" = {1e-9 * found.modulus[1]:.4g} GPa, between 50 GPa and 200 GPa")
    assert lines[7].startswith(f"  best power law: k = {found.exponent:.3g}, wear_volume = ")
    assert lines[9:] == ["  20 of 20 descents ended here, minima: 1", "  converged, certified"]
    assert found.doubt is None
    CONTACT.steady(0.4).deepest_wear = 2e-9
    assert "  the wear is only 2 nm deep: the roughness of most surfaces is larger" in repr(found)
    none = dataclasses.replace(found, power_law_value=math.nan, converged=False)
    assert "best power law: none keeps the limits" in repr(none) and repr(none).endswith("not converged, not certified")


@pytest.mark.usefixtures("pretended")
def test_a_free_gradient_keeps_its_limits():
    held = optimise.free_design(CONTACT, 0.4, PROFILE, hold="contact_radius")
    assert abs(BY_RADIUS @ np.log(held.modulus / 100e9)) < 1e-5 and held.converged
    small = optimise.free_design(CONTACT, 0.4, PROFILE, limits={"contact_radius": {"below": 0.95 * RADIUS}})
    assert BY_RADIUS @ np.log(small.modulus / 100e9) <= math.log(0.95) + 1e-5
    for radius, modulus in zip(small.contact_radii, (small.modulus, small.power_law.material.modulus), strict=False):
        assert_allclose(radius, RADIUS * np.exp(BY_RADIUS @ np.log(modulus / 100e9)), rtol=1e-9)
    gentle = dataclasses.replace(PROFILE, steepness=0.2)
    steps = np.diff(np.log(optimise.free_design(CONTACT, 0.4, gentle).modulus)) / np.diff(np.log(AT))
    assert np.all(np.abs(steps) < 0.2 + 1e-5)
    # A free gradient contains the clipped power law.
    law = np.log(held.power_law.material.modulus / 100e9)
    inside = np.abs(law) < 0.693
    exponents = (np.diff(law) / np.diff(np.log(AT)))[inside[1:] & inside[:-1]]
    assert_allclose(exponents, held.exponent, rtol=1e-9)
    assert exponents.size > 1


@cases("fitting/refused.toml", "profiles")
def test_bad_profiles(case):
    with pytest.raises(ValueError, match=case["line"]):
        optimise.ModulusProfile(case["at"], case["lower"], case["upper"])


# --- the commands ---------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(here):
    bounds = ", ".join(["[55e9, 220e9]"] * 5)
    vary = f"vary = {{ modulus = {{ at = [2e-6, 7e-6, 2e-5, 7e-5, 3e-4], between = [{bounds}] }} }}"
    Path("scene.toml").write_text(f'{SCENE}\n[design]\n{vary}\nhold = "contact_radius"\nminimise = "wear_volume"\n')
    Path("E.csv").write_text(CSV)


@cases("fitting/refused.toml", "commands")
def test_the_coating_command_refuses_in_a_line(folder, case):
    Path("bad.csv").write_text("depth,modulus\n0,1e11\n1e-6,x\n")
    assert is_told(refused("coating", *case["arguments"], "--scene", "scene.toml"), case)


def test_the_coating_command_takes_its_force_from_the_table(folder, monkeypatch):
    Path("E.csv").write_text("depth (um),modulus (GPa)\n10,100\n200,140\n")
    Path("scene.toml").write_text(SCENE.replace("tangential_force = 0.4", "displacement = 1e-7"))
    Path("of_table.toml").write_text(
        Path("scene.toml").read_text().replace("E0 = 110e9\nz0 = 1e-4\nk = 0.0", 'table = "E.csv"')
    )
    asked = []

    def studied(contact, force):
        asked.append(force)
        raise ValueError("enough")

    monkeypatch.setattr(coating, "studied", studied)
    for given in ("scene.toml", "of_table.toml"):
        assert refused("coating", "E.csv", "--scene", given) == "E.csv: enough"
    assert_allclose(asked, scene.load("of_table.toml").load.amplitudes[[0, 0]], rtol=1e-12)


@long
def test_the_coating_command(folder):
    found = told("coating E.csv --scene scene.toml --out fitted.toml --csv f.csv")
    assert abs(found["power_law"]["contact_radius"] / found["as_given"]["contact_radius"] - 1.0) < 0.02
    assert found["covered"] > 0.9 and found["k"] < 0.0 and Path("E-coating.png").stat().st_size > 10_000
    # Over all depths together the radius and the wear change as with E as a whole.
    assert max(found["where_it_counts"]["dlogV_dlogE_per_decade"]) < 0.05
    written = scene.load("fitted.toml")
    assert_allclose([written.material.k, written.material.E0], [found["k"], found["E0"]], rtol=1e-5)
    assert "# how it is pressed\n[contact]" in Path("fitted.toml").read_text()
    assert Path("f.csv").read_text().startswith("depth,modulus,fitted,weight\n0.0,250000000000.0,")


@long
def test_the_best_free_gradient_of_a_scene(folder):
    found = told("design scene.toml")
    assert found["certified"] and 15.0 < found["less_than_power_law_percent"] < 25.0
    assert found["at_bound"] == ["upper", None, "lower", "upper", "upper"]
    radii = found["contact_radius"]
    assert_allclose([*radii.values()], radii["reference"], rtol=1e-4)


def test_the_exit_code_of_a_free_gradient_says_what_the_line_says(folder, pretended, monkeypatch):
    free = optimise.free_design(CONTACT, 0.4, PROFILE)
    nothing = {"radii": [0.0], "wear_depth": [0.0], "stick_radius": 6e-5, "worn_radius": 8e-5}
    monkeypatch.setattr(coating, "worn", lambda contact, force: nothing)
    monkeypatch.setattr(coating, "where_it_counts", lambda contact, force: (np.array([1e-6]), np.array([0.0])))
    monkeypatch.setattr(Report, "draw", lambda report, name, *shown: None)
    for starts, converged, code, said in data("fitting/ends.toml")["ends"]:
        minima = (free.minima[0]._replace(starts=starts),)
        ended = dataclasses.replace(free, minima=minima, converged=converged, power_law_value=free.value * (1.0 + 1e-7))
        monkeypatch.setattr(scene.Scene, "free_design", lambda given, ended=ended: ended)
        result = plgwear("design scene.toml")
        assert result.exit_code == code and said in " ".join(result.stdout.split())
        assert "the free gradient wears no less than the best power law" in result.stdout
        assert "the wear is only 0 m deep" in result.stdout
        assert result.stderr == (f"scene.toml: {said}\n" if code else "")
